//! What must not matter: which way is forwards, and over which period of the profile the carrier stands.

use asperity::outputs::Output;
use asperity::scene::{Path, Surface};
use asperity::simulation::{Motion, Start};
use proptest::prelude::*;

use crate::physics::invariants::case::Case;
use crate::physics::invariants::check::check;
use crate::physics::invariants::random::{cases, cases_with_bodies};
use crate::physics::invariants::trust::{Compared, Series, Trusted};

/// The case seen in a mirror, x → -x.
fn mirrored(case: &Case) -> Case {
    let mut mirror = case.clone();
    let layer = &mut mirror.scene.layer;
    layer.origin = 0.0 - layer.rest_position(layer.masses - 1);
    layer.roughness.reverse();
    let surface = &case.scene.surface;
    let x = surface.x().iter().rev().map(|x| 0.0 - x).collect();
    mirror.scene.surface = Surface::new(x, surface.z().iter().rev().copied().collect(), surface.is_periodic());
    mirror.start = Start { u: 0.0 - case.start.u, u_rate: 0.0 - case.start.u_rate, ..case.start };
    for motion in &mut mirror.motions {
        motion.u = Path { rate: 0.0 - motion.u.rate, amplitude: 0.0 - motion.u.amplitude, ..motion.u };
        motion.pull = motion.pull.times(-1.0);
    }
    let body = mirror.scene.carrier.x.iter_mut().flat_map(|body| &mut body.start_rate);
    body.for_each(|rate| *rate = 0.0 - *rate);
    mirror
}

/// What a run shows seen in the mirror.
fn seen_in_the_mirror(series: &Series) -> Series {
    let negative = |column: &Vec<f64>| column.iter().map(|value| -value).collect::<Vec<f64>>();
    Series {
        forces: vec![negative(&series.forces[0]), series.forces[1].clone()],
        along_x: series.along_x.iter().rev().map(negative).collect(),
        along_z: series.along_z.iter().rev().cloned().collect(),
        ..series.clone()
    }
}

/// Forces along x have the other sign, all else is the same: the sums are the same in another order, so the runs differ
/// by roundings and by what these make of the steps' lengths.
#[test]
fn a_mirrored_scene_gives_mirrored_forces() {
    mirrored_forces("a mirrored scene", cases());
}

/// The same of a carrier that is a body.
#[test]
fn a_mirrored_body_has_mirrored_forces() {
    mirrored_forces("a mirrored body", cases_with_bodies());
}

fn mirrored_forces(name: &str, cases: impl Strategy<Value = Case>) {
    let compared = Compared::default();
    check(name, 30, cases, |case| {
        let fail = |error| TestCaseError::fail(format!("{error}"));
        let one = Trusted::where_a_perturbed_run_agrees(&case, |case| case.run(6)).map_err(fail)?;
        let mut other = Trusted::where_a_perturbed_run_agrees(&mirrored(&case), |case| case.run(6)).map_err(fail)?;
        other.series = seen_in_the_mirror(&other.series);
        compared.same(&one, &other)
    });
    compared.report(name, 0.5);
}

/// One mass over a flat surface has no sums whose order could change: bit for bit.
#[test]
fn one_mass_over_a_plane_is_mirrored_to_the_last_bit() {
    check("one mass mirrored", 150, cases(), |mut case| {
        case.scene.layer.masses = 1;
        case.scene.layer.roughness.truncate(1);
        case.scene.surface = Surface::new(vec![0.0, 1.0], vec![0.0, 0.0], false);
        let run = |case: &Case| case.run(4).map_err(|error| TestCaseError::fail(format!("{error}")));
        let (one, other) = (run(&case)?, run(&mirrored(&case))?);
        let turns = [
            Output::ForceX,
            Output::Hysteresis,
            Output::Adhesion,
            Output::CoulombForce,
            Output::ShearForce,
            Output::ContactForceX,
            Output::ElementX(0),
        ];
        for (column, variable) in one.variables.iter().enumerate() {
            for (row, (a, b)) in one.rows.iter().zip(&other.rows).enumerate() {
                let slips = matches!(variable.output, Output::ElementMode(_)) && a[column].abs() == 1.0;
                // A contact at rest without friction slips neither way.
                let either = slips && case.scene.friction.is_none();
                let turned =
                    turns.contains(&variable.output) || slips || variable.output == Output::ElementFrictionForce(0);
                let expected = if turned { -a[column] } else { a[column] };
                prop_assert!(
                    expected == b[column] || either,
                    "{} in row {row}: {} {}",
                    variable.name,
                    a[column],
                    b[column]
                );
            }
        }
        Ok(())
    });
}

/// The case with all of u exact: the data points of the profile, and where the carrier starts and stops, are whole
/// multiples of a power of two, few enough of them for sums to have digits to spare. Over a wave where the profile is
/// not periodic.
fn with_exact_u(case: &Case) -> Case {
    let mut case = case.clone();
    if !case.scene.surface.is_periodic() {
        let x: Vec<f64> = (0..=8).map(|i| 0.4 * f64::from(i) * case.scene.layer.spacing).collect();
        let height = 0.1 * case.scene.layer.spacing;
        let z = [0.0, 0.7, 0.2, -0.3, 0.5, 0.1, -0.9, -0.4, 0.0].map(|z| z * height).to_vec();
        case.scene.surface = Surface::new(x, z, true);
    }
    let surface = &case.scene.surface;
    let width = surface.x().windows(2).map(|pair| pair[1] - pair[0]).fold(f64::INFINITY, f64::min);
    let quantum = (width.log2().floor() - 6.0).exp2();
    let whole = |x: f64| (x / quantum).round() * quantum;
    let x = surface.x().iter().map(|&x| whole(x)).collect();
    case.scene.surface = Surface::new(x, surface.z().to_vec(), true);
    case.start.u = whole(case.start.u);
    for motion in &mut case.motions {
        let duration = motion.duration.log2().floor().exp2();
        let rate = whole(motion.u.rate * duration) / duration;
        *motion = Motion { duration, u: Path { rate, ..Path::default() }, w: motion.w, ..Motion::default() };
    }
    case
}

/// A carrier that starts any number of periods further on sees the same profile. Where its places are exact, nothing is
/// lost, as all is computed from the place within the period: bit for bit, but for the places of the masses as outputs.
#[test]
fn a_shift_by_periods_of_the_profile_changes_no_bit() {
    check("a shift by periods", 150, (cases(), -1000_i32..1000), |(case, periods)| {
        let case = with_exact_u(&case);
        let mut far = case.clone();
        let x = case.scene.surface.x();
        far.start.u += f64::from(periods) * (x[x.len() - 1] - x[0]);
        let run = |case: &Case| case.run(4).map_err(|error| TestCaseError::fail(format!("{error}")));
        let (one, other) = (run(&case)?, run(&far)?);
        for (column, variable) in one.variables.iter().enumerate() {
            if matches!(variable.output, Output::ElementX(_)) {
                continue;
            }
            for (row, (a, b)) in one.rows.iter().zip(&other.rows).enumerate() {
                prop_assert!(a[column] == b[column], "{} in row {row}: {} {}", variable.name, a[column], b[column]);
            }
        }
        Ok(())
    });
}

/// The same profile given from another of its data points on: the spline's curvatures are solved for in another order,
/// so within the tolerance.
#[test]
fn a_periodic_profile_may_be_cut_anywhere() {
    let compared = Compared::default();
    check("a profile cut elsewhere", 20, (cases(), 0.0..1.0_f64), |(case, share)| {
        let case = with_exact_u(&case);
        let mut cut = case.clone();
        let (x, z) = (case.scene.surface.x(), case.scene.surface.z());
        let (n, period) = (x.len() - 1, x[x.len() - 1] - x[0]);
        let from = (share * n as f64) as usize;
        let cut_x = x[from..n].iter().copied().chain(x[..=from].iter().map(|x| x + period)).collect();
        let cut_z = z[from..n].iter().chain(&z[..=from]).copied().collect();
        cut.scene.surface = Surface::new(cut_x, cut_z, true);
        let trusted = |case: &Case| {
            let run = Trusted::where_a_perturbed_run_agrees(case, |case| case.run(6));
            run.map_err(|error| TestCaseError::fail(format!("{error}")))
        };
        compared.same(&trusted(&case)?, &trusted(&cut)?)
    });
    compared.report("a profile cut elsewhere", 0.5);
}
