//! A feature that a scene does not have costs nothing and changes nothing: pairs of scenes, one without the feature,
//! one with it at zero. `cargo bench --bench leaving_out` compares their times.
#[allow(dead_code, unreachable_pub, reason = "shared with the benchmark and with tests/allocation.rs")]
mod pairs;

use std::collections::BTreeSet;

use asperity::outputs::{Snapshot, Variable, variables};
use asperity::scene::Scene;
use asperity_fmi::Definition;
use pairs::{PIECES, Pair, pairs, piece, started};

const MASSES: usize = 12;

/// The variables that both scenes of a pair have, but for the processor time.
fn common_variables(pair: &Pair) -> [Vec<Variable>; 2] {
    let names = [&pair.without, &pair.with]
        .map(|scene| variables(scene).into_iter().map(|variable| variable.name).collect::<BTreeSet<_>>());
    [&pair.without, &pair.with].map(|scene| {
        let both = |variable: &Variable| names.iter().all(|names| names.contains(&variable.name));
        variables(scene).into_iter().filter(|variable| both(variable) && variable.name != "solver.run_time").collect()
    })
}

fn row(snapshot: &Snapshot<'_>, variables: &[Variable]) -> Vec<f64> {
    let mut values = vec![f64::NAN; variables.len()];
    snapshot.evaluate(variables, &mut values);
    values
}

/// The rows of a run of `scene`, piece by piece.
fn rows(scene: &Scene, variables: &[Variable]) -> Vec<Vec<f64>> {
    let mut simulation = started(scene);
    let mut next = |i: usize| {
        if i > 0 {
            simulation.advance(&piece()).unwrap();
        }
        row(&simulation.snapshot(), variables)
    };
    (0..=PIECES).map(&mut next).collect()
}

/// The sums of a stage have more terms that are zero, which changes at most the last digit; the events of a run amplify
/// that, but not to more than this.
const ROUNDING: f64 = 1e-9;
/// With tangents steps end at their events, without they may continue from within; energies take part in the error test
/// where they are asked for: equal up to the tolerance of a step, 1e-6, times the number of steps.
const OTHER_STEPS: f64 = 1e-4;

#[test]
fn a_feature_at_zero_gives_what_the_scene_without_it_gives() {
    for pair in pairs(MASSES) {
        let [without, with] = common_variables(&pair);
        assert!(!without.is_empty(), "{}: something to compare", pair.feature);
        let (a, b) = (rows(&pair.without, &without), rows(&pair.with, &with));
        let takes_other_steps = pair.feature == "tangent" || pair.feature.contains("energy accounting");
        let allowed = if takes_other_steps { OTHER_STEPS } else { ROUNDING };
        for (j, variable) in without.iter().enumerate() {
            let size = a.iter().map(|row| row[j].abs()).fold(0.0, f64::max);
            for (a, b) in a.iter().zip(&b) {
                let difference = (a[j] - b[j]).abs();
                assert!(difference <= allowed * size, "{}, {}: {} and {}", pair.feature, variable.name, a[j], b[j]);
            }
        }
    }
}

/// The comparison is sensitive: masses change their modes.
#[test]
fn the_runs_are_lively() {
    for pair in pairs(MASSES) {
        let mut simulation = started(&pair.without);
        simulation.record_mode_changes(true);
        for _ in 0..PIECES {
            simulation.advance(&piece()).unwrap();
        }
        let changes = simulation.take_mode_changes().len();
        assert!(2 * changes >= MASSES, "{}: {changes} mode changes", pair.feature);
    }
}

#[test]
fn a_feature_left_out_has_no_variables() {
    let names = |scene: &Scene| -> BTreeSet<String> {
        Definition::from(scene.clone()).variables().entries().map(|(_, entry)| entry.name.clone()).collect()
    };
    for pair in pairs(MASSES) {
        let (without, with) = (names(&pair.without), names(&pair.with));
        assert!(without.is_subset(&with), "{}", pair.feature);
        let its = |name: &String| pair.variables.iter().any(|part| name.starts_with(part) || name.ends_with(part));
        assert!(with.difference(&without).all(its), "{}: {:?}", pair.feature, with.difference(&without));
        assert_eq!(with.len() > without.len(), !pair.variables.is_empty(), "{}", pair.feature);
    }
}
