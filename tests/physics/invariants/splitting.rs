//! Communication steps are the master's choice, not a part of the motion.

use asperity::scene::Path;
use asperity::simulation::{Motion, SimulationError};
use proptest::collection::vec;
use proptest::prelude::*;

use crate::physics::invariants::case::{Case, Record};
use crate::physics::invariants::check::check;
use crate::physics::invariants::random::cases;
use crate::physics::invariants::trust::{Compared, Trusted};

/// The case with straight motions alone: these can be taken up in the middle.
pub(crate) fn straight(case: &Case) -> Case {
    let mut case = case.clone();
    for motion in &mut case.motions {
        let straight = |path: Path| Path { rate: path.rate, ..Path::default() };
        *motion =
            Motion { duration: motion.duration, u: straight(motion.u), w: straight(motion.w), ..Motion::default() };
    }
    case
}

/// The rows at the ends of the motions, each cut into pieces with these shares of its duration.
fn in_pieces(case: &Case, shares: &[f64]) -> Result<Record, SimulationError> {
    let mut record = Record::new(case.variables());
    let mut simulation = case.started();
    record.note(&simulation.snapshot());
    let sum: f64 = shares.iter().sum();
    for motion in &case.motions {
        for share in shares {
            simulation.advance(&Motion { duration: motion.duration * share / sum, ..*motion })?;
        }
        record.note(&simulation.snapshot());
    }
    Ok(record)
}

/// One advance into several: the steps end elsewhere, so the errors are others, of the same size. A piece without a
/// kink before it decides no mode anew.
#[test]
fn a_motion_in_pieces_is_the_same_within_the_tolerance() {
    let compared = Compared::default();
    check("a motion in pieces", 50, (cases(), vec(0.01..1.0_f64, 2..8)), |(case, shares)| {
        let case = straight(&case);
        let trusted = |shares: &[f64]| {
            let run = Trusted::where_a_perturbed_run_agrees(&case, |case| in_pieces(case, shares));
            run.map_err(|error| TestCaseError::fail(format!("{error}")))
        };
        compared.same(&trusted(&[1.0])?, &trusted(&shares)?)
    });
    compared.report("a motion in pieces", 0.5);
}
