//! The text of a scene: an error with a position and a reason, or a run.

use std::path::Path;

use asperity::outputs::{Snapshot, Variable, variables};
use asperity::scene::{OutputGroup, Phase, Scene, identifier};
use asperity::simulation::{Motion, Simulation, Start};

/// Maximum size of a scene here: a fuzzer finds the large numbers that are allowed, but use of memory and time is not an
/// error.
const MAX_MASSES: usize = 4;
const MAX_STEPS: u64 = 30;
const MAX_DIGITS: usize = 4;

/// Reads a scene and runs it for a few steps.
pub fn run(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    if longest_integer(bytes) > MAX_DIGITS {
        return;
    }
    // No file lies beside it.
    let file = Path::new("/dev/null/scene.toml");
    match Scene::parse(text, file) {
        Ok(scene) => run_scene(scene),
        Err(error) => {
            let message = error.to_string();
            assert!(message.starts_with("/dev/null/scene.toml"), "{message}");
            assert!(!message.contains('\n'), "{message}");
            let lines = text.split('\n').count();
            assert!(error.line().is_none_or(|line| (1..=lines).contains(&line)), "{message}");
        }
    }
}

/// Digits of the longest integer, decimal or not; those after a point do not count.
fn longest_integer(bytes: &[u8]) -> usize {
    let (mut longest, mut run, mut after_point) = (0, 0, false);
    for &byte in bytes {
        match byte {
            b'_' if run > 0 => (),
            b'0'..=b'9' | b'a'..=b'f' | b'A'..=b'F' if run > 0 || byte.is_ascii_digit() => {
                run += usize::from(!after_point);
                longest = longest.max(run);
            }
            // Counted on: 0x10000.
            b'x' | b'o' if run == 1 => (),
            _ => (run, after_point) = (0, byte == b'.'),
        }
    }
    longest
}

/// Checks that a motion that succeeds has finite outputs and that one that fails changes nothing.
pub fn run_scene(mut scene: Scene) {
    assert!(!identifier(&scene.name).is_empty());
    if scene.layer.masses > MAX_MASSES {
        return;
    }
    scene.solver.max_steps = Some(scene.solver.max_steps().min(MAX_STEPS));
    scene.outputs = OutputGroup::ALL.to_vec();
    let variables = variables(&scene);
    let start = Start { load: scene.first_load(), pull: scene.first_pull(), ..Start::default() };
    let mut simulation = Simulation::new(&scene, &start).unwrap();
    let mut before = values(&simulation.snapshot(), &variables);
    assert_finite(&variables, &before);
    for (motion, until) in motions(&scene) {
        let times = [0.0, 0.3 * motion.duration, motion.duration];
        let result = simulation.advance_observed(&motion, until, &times, |_, _| ());
        let after = values(&simulation.snapshot(), &variables);
        match result {
            Ok(_) => assert_finite(&variables, &after),
            Err(error) => {
                assert_eq!(bits(&after), bits(&before), "{error}");
                assert!(!error.to_string().is_empty());
                return;
            }
        }
        before = after;
    }
}

/// The first phases of the scene, and a motion that presses, which makes contact in many scenes.
fn motions(scene: &Scene) -> Vec<(Motion, Option<f64>)> {
    let press = Motion {
        duration: 1e-5,
        u: asperity::scene::Path { rate: 0.1, ..Default::default() },
        w: asperity::scene::Path { rate: -1.0, ..Default::default() },
        ..Motion::default()
    };
    let phases = scene.excitation.iter().take(2);
    let motion = |phase: &Phase| Motion {
        duration: phase.duration,
        u: phase.u,
        w: phase.w,
        load: phase.load(scene.layer.area()),
        pull: phase.pull(),
        temperature: phase.temperature,
    };
    let phases = phases.map(|phase| (motion(phase), phase.end_force(scene.layer.area())));
    phases.chain([(press, None)]).collect()
}

fn values(snapshot: &Snapshot<'_>, variables: &[Variable]) -> Vec<f64> {
    let mut values = vec![0.0; variables.len()];
    snapshot.evaluate(variables, &mut values);
    values
}

fn bits(values: &[f64]) -> Vec<u64> {
    values.iter().map(|value| value.to_bits()).collect()
}

fn assert_finite(variables: &[Variable], values: &[f64]) {
    for (variable, value) in variables.iter().zip(values) {
        assert!(value.is_finite(), "{} = {value}", variable.name);
    }
}
