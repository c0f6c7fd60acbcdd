//! The element and its layer along a motion to and fro.

use asperity::element::{Element, OperatingPoint, PointContact};
use asperity::outputs::{Output, Variable, variable};
use asperity::scene::Scene;
use asperity::simulation::Start;

use super::drag::ToAndFro;
use super::element_at::element_at;
use crate::error::Error;
use super::measure::deviation;
use crate::csv::{Field, text};
use crate::labelled::LabelledLine;
use crate::runner::InputSample;

/// What is compared along the motion to and fro.
pub(super) const LOOP_OUTPUTS: [Output; 4] =
    [Output::ForceX, Output::ForceZ, Output::DissipatedPower, Output::DissipatedEnergy];

/// The values of the [`LOOP_OUTPUTS`].
type LoopRow = [f64; LOOP_OUTPUTS.len()];

/// The layer and the element along the motion to and fro, row by row.
#[derive(Debug)]
pub struct Loop {
    motion: ToAndFro,
    carriers: Vec<InputSample>,
    layer: Vec<LoopRow>,
    element: Vec<LoopRow>,
    /// Whether the layer is what was swept; else it is another model, and the friction under the same load is compared.
    is_of_layer: bool,
}

/// Nothing can be dragged to and fro.
pub(super) fn nothing_sticks() -> Error {
    Error::run("no contact, or no friction")
}

fn variables() -> Vec<Variable> {
    LOOP_OUTPUTS.into_iter().filter_map(variable).collect()
}

impl Loop {
    /// The element and the layer with their carriers held at these w, m.
    pub(super) fn run(
        contact: &PointContact,
        scene: &Scene,
        point: &OperatingPoint,
        [w, of_layer]: [f64; 2],
        is_of_layer: bool,
    ) -> Result<Self, Error> {
        let variables = variables();
        let mut element = element_at(contact, point, &Start { w, ..Start::default() })?;
        let motion = ToAndFro { speed: point.speed, length: element.stick_length() };
        if motion.length <= 0.0 {
            return Err(nothing_sticks());
        }
        let values = |element: &Element| {
            let mut values = LoopRow::default();
            element.evaluate(&variables, &mut values);
            values
        };
        let mut rows = vec![values(&element)];
        for (duration, rate) in motion.steps() {
            element.advance(duration, rate, 0.0)?;
            rows.push(values(&element));
        }
        let layer = motion.layer(scene, point.temperature, of_layer, &variables)?;
        Ok(Self { motion, carriers: motion.carriers(w), layer, element: rows, is_of_layer })
    }

    /// u (m) and -F_x (N), row by row, of the layer and of the element.
    pub fn friction(&self) -> [Vec<(f64, f64)>; 2] {
        [&self.layer, &self.element]
            .map(|rows| self.carriers.iter().zip(rows).map(|(carrier, row)| (carrier.u, -row[0])).collect())
    }

    /// The result files of the layer and of the element.
    pub fn tables(&self) -> [String; 2] {
        let variables = variables();
        let head = || ["time", "u", "w"].into_iter().chain(variables.iter().map(|variable| variable.name.as_str()));
        [&self.layer, &self.element].map(|rows| {
            let fields = |(carrier, row): (&InputSample, &LoopRow)| {
                let inputs = [carrier.time, carrier.u, carrier.w].map(Field::real);
                let values = variables.iter().zip(row).map(|(variable, &value)| Field { kind: variable.kind, value });
                inputs.into_iter().chain(values).map(|field| field.to_string()).collect()
            };
            text(head(), self.carriers.iter().zip(rows).map(fields))
        })
    }

    /// The largest and the root mean square differences over the largest value of the layer, and after the motion what
    /// they are; of another model those of friction alone.
    pub fn lines(&self) -> Vec<LabelledLine> {
        let (what, compared) = match self.is_of_layer {
            true => ("over the layer's largest value", LOOP_OUTPUTS.len()),
            false => (
                "friction alone, beside the layer under the same load, which is another model; over its largest value",
                1,
            ),
        };
        let head = format!("{}, {what}", self.motion.describe());
        let of = |(i, variable): (usize, &Variable)| {
            let largest = self.layer.iter().fold(f64::MIN_POSITIVE, |largest, row| largest.max(row[i].abs()));
            let errors = self.layer.iter().zip(&self.element).map(|(a, b)| (a[i] - b[i]).abs() / largest);
            ("", deviation(&variable.name, errors))
        };
        std::iter::once(("", head)).chain(variables()[..compared].iter().enumerate().map(of)).collect()
    }
}
