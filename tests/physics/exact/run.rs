//! A run of a scene, read by the variables' names.

use asperity::outputs::{self, Snapshot, Variable};
use asperity::scene::{Path, Scene};
use asperity::simulation::{ModeChange, Motion, Simulation, Start};

use crate::common::scenes::SceneText;

/// Those of a carrier that is a body, too.
const WITH_CARRIER: [&str; 5] = ["forces", "carrier", "dissipation", "energy", "solver"];
const OUTPUTS: [&str; 7] = ["forces", "dissipation", "friction", "contact", "energy", "solver", "elements"];

/// A run that records its mode changes.
#[derive(Clone)]
pub(crate) struct Run {
    simulation: Simulation,
    variables: Vec<Variable>,
    values: Vec<f64>,
}

impl Run {
    /// Starts a scene, with its outputs added.
    pub(crate) fn new(scene: &SceneText, start: Start) -> Self {
        let outputs = if scene.has("carrier") { &WITH_CARRIER[..] } else { &OUTPUTS };
        Self::of(&scene.clone().outputs(outputs).scene(), start)
    }

    /// Starts a scene.
    pub(crate) fn of(scene: &Scene, start: Start) -> Self {
        let variables = outputs::variables(scene);
        let mut simulation = Simulation::new(scene, &start).unwrap();
        simulation.record_mode_changes(true);
        Self { simulation, values: vec![0.0; variables.len()], variables }
    }

    /// The variable called `name` now.
    pub(crate) fn get(&mut self, name: &str) -> f64 {
        let index = self.index(name);
        self.simulation.evaluate(&self.variables, &mut self.values);
        self.values[index]
    }

    /// The mode of mass `i`, from 1.
    pub(crate) fn mode(&mut self, i: usize) -> f64 {
        self.get(&format!("element[{i}].mode"))
    }

    /// Mode changes since the last call.
    pub(crate) fn events(&mut self) -> Vec<ModeChange> {
        self.simulation.take_mode_changes()
    }

    /// Moves the carrier by `u` and `w` for `duration` seconds.
    pub(crate) fn drive(&mut self, duration: f64, u: Path, w: Path) {
        self.simulation.advance(&Motion { duration, u, w, ..Motion::default() }).unwrap();
    }

    /// Follows `motion`.
    pub(crate) fn follow(&mut self, motion: &Motion) {
        self.simulation.advance(motion).unwrap();
    }

    /// As [`drive`](Self::drive); the variables called `names` at each of `times` (s, since the start of the motion): a
    /// column for each name.
    pub(crate) fn sample(&mut self, motion: &Motion, times: &[f64], names: &[&str]) -> Vec<Vec<f64>> {
        let indices: Vec<usize> = names.iter().map(|name| self.index(name)).collect();
        let mut columns = vec![Vec::with_capacity(times.len()); names.len()];
        let (variables, values) = (&self.variables, &mut self.values);
        let observe = |_: f64, snapshot: &Snapshot<'_>| {
            snapshot.evaluate(variables, values);
            for (column, &index) in columns.iter_mut().zip(&indices) {
                column.push(values[index]);
            }
        };
        self.simulation.advance_observed(motion, None, times, observe).unwrap();
        columns
    }

    fn index(&self, name: &str) -> usize {
        let position = self.variables.iter().position(|variable| variable.name == name);
        position.unwrap_or_else(|| panic!("no variable {name}"))
    }
}

/// Five masses of different heights, so pressed with different forces, all links with damping.
pub(crate) fn uneven_layer() -> SceneText {
    SceneText::new(5, 1e-4, 1e-7)
        .roughness(&[0.0, -2e-6, 1e-6, 3e-6, -4e-6])
        .vertical((2.0e3, 4.0e-3, [(1.0e3, 1.0e-4)]))
        .horizontal((1.0e3, 8.0e-3, [(600.0, 2.0e-5)]))
        .lateral_x((500.0, 2.0e-3, [(400.0, 3.0e-5)]))
        .lateral_z((300.0, 1.0e-3))
}

/// A constant rate, m/s.
pub(crate) fn rate(rate: f64) -> Path {
    Path { rate, ..Path::default() }
}

/// A sine of an amplitude (m) and a frequency (Hz).
pub(crate) fn sine(amplitude: f64, frequency: f64) -> Path {
    Path { rate: 0.0, amplitude, frequency }
}

/// At rest.
pub(crate) const REST: Path = Path { rate: 0.0, amplitude: 0.0, frequency: 0.0 };

/// `n` even steps of [from, to), without the end.
pub(crate) fn steps((from, to): (f64, f64), n: usize) -> Vec<f64> {
    (0..n).map(|i| from + (to - from) * i as f64 / n as f64).collect()
}

/// The mean.
pub(crate) fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// The root of `f` between `a` and `b`, where `f` differs in sign, by bisection.
pub(crate) fn root(f: impl Fn(f64) -> f64, (mut a, mut b): (f64, f64)) -> f64 {
    let rises = f(a) < 0.0;
    assert!(rises != (f(b) < 0.0), "no change of sign");
    for _ in 0..200 {
        let middle = 0.5 * (a + b);
        if (f(middle) < 0.0) == rises {
            a = middle;
        } else {
            b = middle;
        }
    }
    0.5 * (a + b)
}
