//! The motion to and fro of a check, and the layer along it.

use asperity::outputs::Variable;
use asperity::scene::{Initial, OutputGroup, Parameter, Path, Scene, Value};
use asperity::simulation::{Motion, Simulation, Start};

use crate::error::Error;
use crate::runner::InputSample;

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
