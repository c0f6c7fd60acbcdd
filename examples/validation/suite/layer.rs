//! Runs of a layer along motions, by the library.

use asperity::outputs::variables;
use asperity::scene::{Force, Path, Scene};
use asperity::simulation::{Motion, Simulation, Start};

/// A motion at constant rates, m/s.
pub fn straight(duration: f64, u: f64, w: f64) -> Motion {
    let path = |rate| Path { rate, ..Path::default() };
    Motion { duration, u: path(u), w: path(w), ..Motion::default() }
}

/// The same at rest, under a load (N) along z that jumps to this as it begins.
pub fn loaded(duration: f64, load: f64) -> Motion {
    Motion { load: Force { start: Some(load), ..Force::default() }, ..straight(duration, 0.0, 0.0) }
}

/// Outputs by their names at some times (s) within a motion: a row each.
pub fn sample(
    simulation: &mut Simulation,
    scene: &Scene,
    motion: &Motion,
    times: &[f64],
    names: &[&str],
) -> Vec<Vec<f64>> {
    let all = variables(scene);
    let place = |name: &&str| all.iter().position(|variable| variable.name == *name).expect("an output of the scene");
    let places: Vec<usize> = names.iter().map(place).collect();
    let (mut rows, mut values) = (Vec::new(), vec![0.0; all.len()]);
    let row = |_: f64, now: &asperity::outputs::Snapshot<'_>| {
        now.evaluate(&all, &mut values);
        rows.push(places.iter().map(|&i| values[i]).collect());
    };
    simulation.advance_observed(motion, None, times, row).unwrap();
    rows
}

/// A run that begins at this.
pub fn begin(scene: &Scene, start: &Start) -> Simulation {
    Simulation::new(scene, start).unwrap()
}

/// The ends of so many even parts of a duration.
pub fn even_times(duration: f64, count: usize) -> Vec<f64> {
    (1..=count).map(|i| if i == count { duration } else { duration * i as f64 / count as f64 }).collect()
}
