//! A run of a scene given as text, read by the variables' names.

use std::path::Path as FilePath;

use asperity::outputs::{self, Snapshot, Variable};
use asperity::scene::{Path, Scene};
use asperity::simulation::{ModeChange, Motion, Simulation, Start};

/// Those of a carrier that is a body, too.
const WITH_CARRIER: &str = r#"outputs = ["forces", "carrier", "dissipation", "energy", "solver"]"#;
const OUTPUTS: &str = r#"outputs = ["forces", "dissipation", "friction", "contact", "energy", "solver", "elements"]"#;

/// A run that records its mode changes.
#[derive(Clone)]
pub(crate) struct Run {
    simulation: Simulation,
    variables: Vec<Variable>,
    values: Vec<f64>,
}

impl Run {
    /// Starts the scene whose tables, but for name and outputs, are `text`.
    pub(crate) fn new(text: &str, start: Start) -> Self {
        let outputs = if text.contains("[carrier.") { WITH_CARRIER } else { OUTPUTS };
        let text = format!("name = \"exact\"\n{text}\n[fmu]\n{outputs}\n");
        let scene = Scene::parse(&text, FilePath::new("exact.toml")).unwrap_or_else(|error| panic!("{error}\n{text}"));
        Self::of(&scene, start)
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

/// The table `[solver]` with these tolerances, relative and absolute (m).
pub(crate) fn solver(relative: f64, absolute: f64) -> String {
    format!("[solver]\nrelative_tolerance = {relative:?}\nabsolute_tolerance = {absolute:?}\n")
}

/// A link's table: stiffness c, damping d, Maxwell elements (c_j, τ_j).
pub(crate) fn link(kind: &str, law: &Law) -> String {
    let element = |(c, tau): &(f64, f64)| format!("{{ stiffness = {c:?}, relaxation_time = {tau:?} }}");
    let maxwell: Vec<String> = law.maxwell.iter().map(element).collect();
    let (c, d) = (law.stiffness, law.damping);
    format!("[layer.{kind}]\nstiffness = {c:?}\ndamping = {d:?}\nmaxwell = [{}]\n", maxwell.join(", "))
}

/// The constants of a link.
#[derive(Clone, Debug, Default)]
pub(crate) struct Law {
    pub(crate) stiffness: f64,
    pub(crate) damping: f64,
    pub(crate) maxwell: Vec<(f64, f64)>,
}

impl Law {
    /// A spring and a damper.
    pub(crate) fn new(stiffness: f64, damping: f64) -> Self {
        Self { stiffness, damping, maxwell: Vec::new() }
    }

    /// With Maxwell elements (c_j, τ_j).
    pub(crate) fn with_maxwell(stiffness: f64, damping: f64, maxwell: &[(f64, f64)]) -> Self {
        Self { stiffness, damping, maxwell: maxwell.to_vec() }
    }

    /// K*(ω) = c + iωd + Σ_j c_j iωτ_j/(1 + iωτ_j): its real and its imaginary part.
    pub(crate) fn complex_stiffness(&self, omega: f64) -> (f64, f64) {
        let element = |&(c, tau): &(f64, f64)| {
            let x = omega * tau;
            (c * x * x / (1.0 + x * x), c * x / (1.0 + x * x))
        };
        let add = |sum: (f64, f64), part: (f64, f64)| (sum.0 + part.0, sum.1 + part.1);
        self.maxwell.iter().map(element).fold((self.stiffness, omega * self.damping), add)
    }
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

/// The largest absolute value; NaN counts as infinite.
pub(crate) fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |largest, value| if value.is_nan() { f64::INFINITY } else { largest.max(value.abs()) })
}

/// The largest difference of two columns of equal length.
pub(crate) fn difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len(), "as many values");
    largest(&a.iter().zip(b).map(|(a, b)| a - b).collect::<Vec<_>>())
}

/// Fails where `found` is not within `tolerance` times `scale` of `expected`.
#[track_caller]
pub(crate) fn assert_near(what: &str, found: f64, expected: f64, allowed: f64) {
    let error = (found - expected).abs();
    assert!(error <= allowed, "{what}: {found:e}, not {expected:e}: off by {error:e}, allowed {allowed:e}");
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

/// Numbers in [0, 1) that are the same in every run: Knuth's linear congruential generator.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Between `low` and `high`.
    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }
}
