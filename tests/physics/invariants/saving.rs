//! A run taken up elsewhere, or watched, is the same run.

use asperity::scene::OutputGroup;
use asperity::simulation::{Motion, Simulation, SimulationError, SimulationState};
use proptest::prelude::*;

use crate::physics::invariants::case::{Case, Record};
use crate::physics::invariants::check::check;
use crate::physics::invariants::random::{cases, cases_with_bodies};
use crate::physics::invariants::trust::{Compared, Trusted};

/// How a run is interrupted.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Interruption {
    None,
    Clone,
    /// SimulationState, and restored at once.
    Restore,
    /// SimulationState as bytes, as the FMU's serialised state holds them.
    Bytes,
    /// Tried with another motion first, and taken back to where it was.
    Rollback,
}

const INTERRUPTIONS: [Interruption; 4] =
    [Interruption::Clone, Interruption::Restore, Interruption::Bytes, Interruption::Rollback];

/// Bits of all outputs after each piece, and what is saved in the end: motion `at` is cut at `share` of its duration.
fn run(
    case: &Case,
    (at, share): (usize, f64),
    interruption: Interruption,
) -> Result<(Record, SimulationState), TestCaseError> {
    let fail = |error| TestCaseError::fail(format!("{error}"));
    let mut record = Record::new(case.variables());
    let mut simulation = case.started();
    for (index, motion) in case.motions.iter().enumerate() {
        let pieces = if index == at % case.motions.len() { vec![share, 1.0 - share] } else { vec![1.0] };
        for piece in pieces {
            simulation = interrupted(case, simulation, interruption)?;
            simulation.advance(&Motion { duration: motion.duration * piece, ..*motion }).map_err(fail)?;
            record.note(&simulation.snapshot());
        }
    }
    Ok((record, simulation.state()))
}

fn interrupted(case: &Case, simulation: Simulation, interruption: Interruption) -> Result<Simulation, TestCaseError> {
    let restored = |saved: &SimulationState| Simulation::restore(&case.scene, saved);
    let restored = |saved: &SimulationState| restored(saved).map_err(|error| TestCaseError::fail(format!("{error}")));
    match interruption {
        Interruption::None => Ok(simulation),
        Interruption::Clone => Ok(simulation.clone()),
        Interruption::Restore => restored(&simulation.state()),
        Interruption::Bytes => {
            let bytes = postcard::to_stdvec(&simulation.state()).unwrap();
            restored(&postcard::from_bytes(&bytes).unwrap())
        }
        Interruption::Rollback => {
            let saved = simulation.state();
            let mut tried = simulation;
            let Motion { duration, u, w, .. } = case.motions[0];
            tried
                .advance(&Motion { duration, u: w, w: u, ..Motion::default() })
                .map_err(|error| TestCaseError::fail(format!("{error}")))?;
            restored(&saved)
        }
    }
}

/// Everything that a run has become is in what is saved and in a clone, so what follows is the same to the last bit,
/// wherever in a motion that is.
#[test]
fn save_and_restore_anywhere_change_no_bit() {
    let place = (0_usize..4, 0.01..0.99_f64);
    check("save and restore", 40, (cases(), place, any::<bool>()), saves_and_restores);
}

/// The same under a carrier that is a body, with its forces.
#[test]
fn save_and_restore_change_no_bit_under_a_body() {
    let place = (0_usize..4, 0.01..0.99_f64);
    check("save and restore a body", 40, (cases_with_bodies(), place, any::<bool>()), saves_and_restores);
}

fn saves_and_restores((mut case, place, all): (Case, (usize, f64), bool)) -> Result<(), TestCaseError> {
    if all {
        case = case.with_group(OutputGroup::Tangent).with_group(OutputGroup::Solver);
    }
    let (plain, saved) = run(&case, place, Interruption::None)?;
    for interruption in INTERRUPTIONS {
        let (other, other_saved) = run(&case, place, interruption)?;
        prop_assert!(plain.bits() == other.bits() && saved == other_saved, "{interruption:?}");
    }
    Ok(())
}

/// The rows at the ends of the motions of a run that is asked for `rows` rows in each.
fn watched(case: &Case, rows: usize) -> Result<Record, SimulationError> {
    let mut record = case.run(rows)?;
    record.rows = record.rows.into_iter().step_by(rows).collect();
    record.carrier = record.carrier.into_iter().step_by(rows).collect();
    Ok(record)
}

/// Rows within a motion are read from its steps. A step may be cut at a row that it is no good for, so the steps are
/// others: the same within the tolerance.
#[test]
fn a_run_that_is_watched_is_the_same_within_the_tolerance() {
    let compared = Compared::default();
    check("watched runs", 40, (cases(), 2_usize..30), |(case, rows)| {
        let trusted = |rows: usize| {
            let run = Trusted::where_a_perturbed_run_agrees(&case, |case| watched(case, rows));
            run.map_err(|error| TestCaseError::fail(format!("{error}")))
        };
        compared.same(&trusted(1)?, &trusted(rows)?)
    });
    compared.report("watched runs", 0.5);
}
