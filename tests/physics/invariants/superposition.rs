//! Without contact the layer is linear.

use asperity::scene::Path;
use asperity::simulation::{Motion, Start};
use proptest::prelude::*;

use crate::physics::invariants::case::{Case, Record};
use crate::physics::invariants::check::check;
use crate::physics::invariants::random::cases;
use crate::physics::invariants::trust::Series;

/// By how many units of one step a free chain may be off in the end: the errors of some thousand steps, of both signs.
const ALLOWED: f64 = 30.0;

/// The case high above the profile.
fn lifted(case: &Case) -> Case {
    let mut case = case.clone();
    // As far as a million heights: further than any motion goes.
    case.scene.layer.clearance = 1e6 * case.scene.height();
    case
}

/// Two motions whose sum is that of the case: part of the rates, and of the sines' amplitudes, to the first.
fn parts(case: &Case, (rates, sines): (f64, f64)) -> [Case; 2] {
    [(rates, sines), (1.0 - rates, 1.0 - sines)].map(|(rates, sines)| {
        let path = |path: Path| Path { rate: rates * path.rate, amplitude: sines * path.amplitude, ..path };
        let mut part = case.clone();
        let Start { u_rate, w_rate, .. } = case.start;
        part.start = Start { u_rate: rates * u_rate, w_rate: rates * w_rate, ..case.start };
        for motion in &mut part.motions {
            *motion = Motion { duration: motion.duration, u: path(motion.u), w: path(motion.w), ..Motion::default() };
        }
        part
    })
}

#[test]
fn a_free_chain_obeys_superposition() {
    let shares = (-1.0..2.0_f64, -1.0..2.0_f64);
    check("superposition", 100, (cases(), shares), |(case, shares)| {
        let case = lifted(&case);
        let run = |case: &Case| -> Result<(Series, Record), TestCaseError> {
            let record = case.run(6).map_err(|error| TestCaseError::fail(format!("{error}")))?;
            Ok((Series::of(case, &record), record))
        };
        let [first, second] = parts(&case, shares);
        let ((whole, record), (one, _), (other, _)) = (run(&case)?, run(&first)?, run(&second)?);
        prop_assert_eq!(record.largest(asperity::outputs::Output::ContactCount), 0.0);
        let length = whole.length_unit + one.length_unit + other.length_unit;
        let force = whole.force_unit + one.force_unit + other.force_unit;
        let columns =
            |series: &Series| [series.forces.clone(), series.along_x.clone(), series.along_z.clone()].concat();
        let (whole, one, other) = (columns(&whole), columns(&one), columns(&other));
        for column in 0..whole.len() {
            let unit = if column < 2 { force } else { length };
            for row in 0..whole[column].len() {
                let error = whole[column][row] - one[column][row] - other[column][row];
                prop_assert!(error.abs() <= ALLOWED * unit, "column {column}, row {row}: {} units", error / unit);
            }
        }
        Ok(())
    });
}
