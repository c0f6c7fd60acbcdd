//! The motion to and fro of a check, and the element and its layer along it.

use asperity::element::{Element, OperatingPoint, PointContact};
use asperity::outputs::{Output, Variable, variable};
use asperity::scene::{Initial, OutputGroup, Parameter, Path, Scene, Value};
use asperity::simulation::{Motion, Simulation, Start};

use super::measure::deviation;
use crate::csv::{Field, text};
use crate::error::Error;
use crate::runner::InputSample;
use crate::summary::LabelledLine;

/// Displacements of the motion to and fro, over the length over which the element sticks.
const LEGS: [f64; 3] = [10.0, -20.0, 20.0];
/// Rows of a leg.
const ROWS: u32 = 200;

/// A motion to and fro along x from rest, at constant height.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ToAndFro {
    /// The speed, m/s.
    pub(super) speed: f64,
    /// The length over which the element sticks, m.
    pub(super) length: f64,
}

impl ToAndFro {
    /// Durations (s) and rates (m/s) from row to row; none where the element does not stick.
    pub(super) fn steps(self) -> impl Iterator<Item = (f64, f64)> {
        let rows = if self.length > 0.0 { ROWS } else { 0 };
        LEGS.into_iter().flat_map(move |leg| {
            let (duration, rate) = ((leg * self.length).abs() / self.speed, leg.signum() * self.speed);
            (0..rows).map(move |_| (duration / f64::from(ROWS), rate))
        })
    }

    /// The rows, the start included, with the carrier held at `w` (m).
    pub(super) fn carriers(self, w: f64) -> Vec<InputSample> {
        let mut carrier = InputSample { w, ..InputSample::default() };
        let mut carriers = vec![carrier];
        carriers.extend(self.steps().map(|(duration, rate)| {
            carrier.time += duration;
            carrier.u += duration * rate;
            carrier
        }));
        carriers
    }

    /// What it says of itself.
    pub(super) fn describe(self) -> String {
        let distance = LEGS.iter().fold(0.0_f64, |distance, leg| distance.max(leg.abs())) / 2.0 * self.length;
        format!("to and fro by {distance:.3e} m at {:.3e} m/s, from rest", self.speed)
    }

    /// `variables` of the layer of `scene` at w (m), relaxed at the start, row by row.
    pub(super) fn layer<const N: usize>(
        self,
        scene: &Scene,
        temperature: Option<f64>,
        w: f64,
        variables: &[Variable],
    ) -> Result<Vec<[f64; N]>, Error> {
        let start = Start { w, ..Start::default() };
        let mut layer = Simulation::new(&relaxed(scene, temperature)?, &start)?;
        let values = |layer: &mut Simulation| {
            let mut values = [0.0; N];
            layer.evaluate(variables, &mut values);
            values
        };
        let mut rows = vec![values(&mut layer)];
        for (duration, rate) in self.steps() {
            let u = Path { rate, ..Path::default() };
            let motion = Motion { duration, u, w: Path::default(), ..Motion::default() };
            layer.advance(&motion)?;
            rows.push(values(&mut layer));
        }
        Ok(rows)
    }
}

/// The scene relaxed at the start and with the outputs that are compared.
fn relaxed(scene: &Scene, temperature: Option<f64>) -> Result<Scene, Error> {
    let outputs = vec![OutputGroup::Forces, OutputGroup::Dissipation];
    let mut scene = Scene { outputs, excitation: Vec::new(), ..scene.clone() };
    scene.layer.initial = Initial::Relaxed;
    if let Some(kelvin) = temperature {
        scene.set_parameter(Parameter::TEMPERATURE, Value::Real(kelvin))?;
    }
    Ok(scene)
}

/// The element at the temperature of a point.
pub(super) fn element_at(contact: &PointContact, point: &OperatingPoint, start: &Start) -> Result<Element, Error> {
    let mut contact = contact.clone();
    if let (Some(kelvin), true) = (point.temperature, contact.table().grid.temperatures.len() > 1) {
        contact.set_parameter(Parameter::TEMPERATURE, Value::Real(kelvin))?;
    }
    Ok(Element::new(&contact, start)?)
}

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
