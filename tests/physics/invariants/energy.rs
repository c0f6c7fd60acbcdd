//! The energy balance, and no work from nothing.

use asperity::outputs::Output;
use asperity::scene::{Method, OutputGroup, Path};
use asperity::simulation::Motion;
use proptest::prelude::*;

use crate::physics::invariants::case::{Case, Record};
use crate::physics::invariants::check::check;
use crate::physics::invariants::random::{cases, cases_by, cases_with_bodies};
use crate::physics::invariants::trust::{Units, largest_energy};

/// What the balance may miss, in units of the error that one step may make of the largest energy.
const ALLOWED: f64 = 10.0;

/// Of what a unit is for each step, that adds up where nothing damps it.
const OF_EACH_STEP: f64 = 0.1;

fn run(case: &Case) -> Result<Record, TestCaseError> {
    let case = case.clone().with_group(OutputGroup::Solver);
    case.run(6).map_err(|error| TestCaseError::fail(format!("{error}")))
}

/// The error of energies that a run may have, J.
fn allowed(case: &Case, record: &Record) -> f64 {
    let steps = record.largest(Output::Steps);
    ALLOWED.max(OF_EACH_STEP * steps) * Units::of(case).energy(largest_energy(case, record))
}

fn balance(case: Case) -> Result<(), TestCaseError> {
    prop_assume!(case.has_a_time_of_its_own());
    let record = run(&case)?;
    let (missed, allowed) = (record.largest(Output::EnergyResidual), allowed(&case, &record));
    prop_assert!(missed <= allowed, "missed: {missed:e} J, allowed {allowed:e} J");
    Ok(())
}

/// Of layer, body, loads and drives together.
#[test]
fn the_energy_balance_holds_under_a_body() {
    check("the energy balance under a body", 150, cases_with_bodies(), balance);
}

#[test]
fn the_energy_balance_holds_by_every_method() {
    for (method, cases) in [(Method::Event, 200), (Method::Step, 60), (Method::Auto, 100)] {
        check(&format!("the energy balance by {method:?}"), cases, cases_by(method), balance);
    }
}

/// Energy that is lost stays lost: no channel falls.
#[test]
fn no_channel_of_dissipation_falls() {
    let channels = [
        Output::DamperEnergy,
        Output::MaxwellEnergy,
        Output::FrictionEnergy,
        Output::ImpactEnergy,
        Output::DissipatedEnergy,
    ];
    check("channels of dissipation", 100, cases(), |case| {
        prop_assume!(case.has_a_time_of_its_own());
        let record = run(&case)?;
        let allowed = allowed(&case, &record);
        for channel in channels {
            let Some(column) = record.get(channel) else { continue };
            for (row, pair) in column.windows(2).enumerate() {
                prop_assert!(
                    pair[1] - pair[0] >= -allowed,
                    "{channel:?} after row {row}: {:e} to {:e}",
                    pair[0],
                    pair[1]
                );
            }
        }
        Ok(())
    });
}

/// A carrier at rest gives no energy: what the layer has, from its start undeformed or in motion, only falls.
#[test]
fn under_a_carrier_at_rest_energy_only_falls() {
    check("a carrier at rest", 150, cases(), |mut case| {
        for motion in &mut case.motions {
            *motion = Motion { duration: motion.duration, u: Path::default(), w: Path::default(), ..Motion::default() };
        }
        prop_assume!(case.has_a_time_of_its_own());
        let record = run(&case)?;
        let allowed = allowed(&case, &record);
        let energy: Vec<f64> = record
            .column(Output::KineticEnergy)
            .iter()
            .zip(record.column(Output::ElasticEnergy))
            .map(|(kinetic, elastic)| kinetic + elastic)
            .collect();
        for (row, pair) in energy.windows(2).enumerate() {
            prop_assert!(pair[1] <= pair[0] + allowed, "after row {row}: {:e} to {:e}", pair[0], pair[1]);
        }
        prop_assert_eq!(record.largest(Output::InputEnergy), 0.0);
        Ok(())
    });
}
