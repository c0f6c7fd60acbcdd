//! Runs of scenes by the library.

use asperity::outputs::{Snapshot, variables};
use asperity::scene::{Path, Phase, Scene};
use asperity::simulation::{Motion, Simulation, Start};

use super::Table;

/// A motion at constant rates, m/s.
pub fn straight(duration: f64, u: f64, w: f64) -> Motion {
    let path = |rate| Path { rate, ..Path::default() };
    Motion { duration, u: path(u), w: path(w), ..Motion::default() }
}

/// Every output but the processor time, by its name.
pub fn values(scene: &Scene, snapshot: &Snapshot<'_>) -> Vec<(String, f64)> {
    let variables = variables(scene);
    let mut values = vec![0.0; variables.len()];
    snapshot.evaluate(&variables, &mut values);
    let named = variables.into_iter().map(|variable| variable.name).zip(values);
    named.filter(|(name, _)| name != "solver.run_time").collect()
}

/// The output with this name.
pub fn value(scene: &Scene, snapshot: &Snapshot<'_>, name: &str) -> f64 {
    let found = values(scene, snapshot).into_iter().find(|(other, _)| other == name);
    found.unwrap_or_else(|| panic!("no output {name}")).1
}

/// The same as [`values`], to the last bit.
pub fn bits(scene: &Scene, snapshot: &Snapshot<'_>) -> Vec<u64> {
    values(scene, snapshot).into_iter().map(|(_, value)| value.to_bits()).collect()
}

/// The ends of `count` even parts of a duration, the last to the last bit.
pub fn even_times(duration: f64, count: u32) -> Vec<f64> {
    let time = |i| if i == count { duration } else { duration * f64::from(i) / f64::from(count) };
    (1..=count).map(time).collect()
}

/// The outputs at the start and at the ends of `parts` even parts of each motion.
pub fn along(scene: &Scene, start: &Start, motions: &[Motion], parts: u32) -> Table {
    let mut simulation = Simulation::new(scene, start).unwrap();
    let first = values(scene, &simulation.snapshot());
    let (names, first): (Vec<_>, Vec<_>) = first.into_iter().unzip();
    let mut rows = vec![first];
    for motion in motions {
        let row =
            |_: f64, now: &Snapshot<'_>| rows.push(values(scene, now).into_iter().map(|(_, value)| value).collect());
        simulation.advance_observed(motion, None, &even_times(motion.duration, parts), row).unwrap();
    }
    Table::new(names, rows)
}

/// As [`along`], along the scene's own excitation.
pub fn along_excitation(scene: &Scene, parts: u32) -> Table {
    let motion = |phase: &Phase| Motion { duration: phase.duration, u: phase.u, w: phase.w, ..Motion::default() };
    let motions: Vec<Motion> = scene.excitation.iter().map(motion).collect();
    let start = Start { u_rate: motions[0].u.at(0.0).speed, w_rate: motions[0].w.at(0.0).speed, ..Start::default() };
    along(scene, &start, &motions, parts)
}
