//! `solver.reduce`: Maxwell elements replaced by springs and dampers, and what that changes.

use std::f64::consts::TAU;

use asperity::model::{LinkKind, Model, Reduction, Replacement};
use asperity::outputs::variables;
use asperity::scene::{Path, Scene};
use asperity::simulation::{Motion, Simulation, Start};

use crate::common::runs;
use crate::common::scenes::{Law, SceneText};
use crate::common::{Table, difference, largest};

/// A measured compound: E_j (MPa) at τ_j = 1e-13 s, 1e-12 s and so on to 100 s, and E_∞.
const COMPOUND: [f64; 16] =
    [1538.0, 888.0, 824.0, 495.0, 201.0, 76.3, 31.9, 14.8, 8.12, 4.65, 3.16, 2.26, 1.67, 1.42, 0.969, 1.26];
const EQUILIBRIUM: f64 = 4.44;

/// The compound's link with this modulus times geometry, m.
fn link(geometry: f64) -> Law {
    let element = |(j, modulus): (usize, &f64)| (1e6 * geometry * modulus, 10_f64.powi(j as i32 - 13));
    Law::with_maxwell(1e6 * geometry * EQUILIBRIUM, 0.0, &COMPOUND.iter().enumerate().map(element).collect::<Vec<_>>())
}

/// The compound's layer.
fn layer() -> SceneText {
    SceneText::new(10, 1e-4, 1.1e-6)
        .vertical(link(1e-3))
        .horizontal(link(3.4e-4))
        .lateral_x(link(2e-4))
        .lateral_z(link(1e-4))
        .tolerances(1e-8, 1e-14)
        .outputs(&["forces", "dissipation", "contact", "energy"])
}

/// On a wave; the test moves the carrier by itself.
fn waves() -> SceneText {
    layer().sinusoid(1e-5, 9.3e-4)
}

fn sliding() -> SceneText {
    waves().coulomb(0.3).phase("duration = 2e-3, u_rate = 0.5")
}

fn undeformed(scene: SceneText) -> SceneText {
    scene.set("layer.initial", "undeformed")
}

fn reduced(scene: &SceneText, share: f64) -> Scene {
    scene.clone().set("solver.reduce", share).scene()
}

/// The outputs after each of `parts` even parts of a motion; at the start itself the damper of a replaced element meets
/// the jump of the speed, which the element does not.
fn along(scene: &Scene, start: &Start, motion: Motion, parts: u32) -> Table {
    runs::along(scene, start, &[motion], parts).skip(1)
}

/// The largest difference of an output of two runs.
fn apart(a: &Table, b: &Table, name: &str) -> f64 {
    difference(&a.column(name), &b.column(name))
}

const SLIDE_START: Start =
    Start { time: 0.0, u: 0.0, w: -2e-6, u_rate: 0.5, w_rate: 0.0, load: 0.0, pull: 0.0, temperature: None };

fn slide() -> Motion {
    Motion { duration: 2e-3, u: Path { rate: 0.5, ..Path::default() }, w: Path::default(), ..Motion::default() }
}

#[test]
fn without_reduce_and_with_none_the_runs_are_the_same_to_the_last_bit() {
    let (without, none) = (sliding().scene(), reduced(&sliding(), 0.0));
    let [a, b] = [&without, &none].map(|scene| along(scene, &SLIDE_START, slide(), 20));
    assert_eq!(a, b);
    assert_eq!((Reduction::new(&without), without), (None, none));
}

#[test]
fn few_of_sixteen_elements_stay() {
    let (whole, reduced) = (sliding().scene(), reduced(&sliding(), 1e-3));
    let [before, after] = [&whole, &reduced].map(|scene| Model::new(scene).rows.len());
    assert_eq!(before, 64);
    assert!(after <= 32, "{after} of {before} rows stay");
    // The long ones become springs, the short ones dampers; those on the run's time scales stay.
    for one in Reduction::new(&reduced).unwrap().replaced {
        let tau = one.element.relaxation_time;
        let expected = if tau > 1e-2 { Replacement::Spring } else { Replacement::Damper };
        assert!(!(1e-7..1e-2).contains(&tau) && one.by == expected, "{one:?}");
    }
}

/// An undeformed element has a force at the start; a damper has none.
#[test]
fn no_undeformed_element_becomes_a_damper() {
    let replaced = Reduction::new(&reduced(&undeformed(sliding()), 1e-3)).unwrap().replaced;
    assert!(!replaced.is_empty() && replaced.iter().all(|one| one.by == Replacement::Spring), "{replaced:?}");
}

#[test]
fn the_bounds_of_a_link_add_up_to_no_more_than_its_share() {
    for reduce in [1e-6, 1e-4, 1e-2] {
        let scene = reduced(&sliding(), reduce);
        let reduction = Reduction::new(&scene).unwrap();
        for kind in LinkKind::ALL {
            let of_kind = reduction.replaced.iter().filter(|one| one.kind == kind);
            let sum: f64 = of_kind.map(|one| one.bound).sum();
            let allowed = reduce * reduction.stiffness[kind];
            assert!(sum <= allowed, "{kind:?}: {sum} N/m, {allowed} N/m allowed");
            assert!(reduction.stiffness[kind] > scene.layer.links[kind].as_ref().unwrap().stiffness.unwrap());
        }
    }
}

/// The scene is all that is known of an FMU's run.
#[test]
fn without_an_excitation_no_element_is_long() {
    let reduction = Reduction::new(&reduced(&waves().coulomb(0.3), 1e-3)).unwrap();
    assert!(reduction.run.is_infinite() && !reduction.replaced.is_empty());
    assert!(reduction.replaced.iter().all(|one| one.by == Replacement::Damper), "{:?}", reduction.replaced);
}

/// The frequency is that of the profile's wave, of the carrier's sine, or the layer's own.
#[test]
fn the_frequency_is_the_largest_of_three() {
    let frequency = |mass: f64, excitation: &str| {
        let layer = SceneText::new(3, 1e-4, mass).vertical((4.0, 0.0, [(1.0, 1e-9)])).lateral_z(3.0);
        let scene = layer.sinusoid(1e-5, 1e-3).set("solver.reduce", 1e-3);
        let scene = if excitation.is_empty() { scene } else { scene.phase(excitation) };
        Reduction::new(&scene.scene()).unwrap().frequency
    };
    let close = |found: f64, expected: f64, share: f64| {
        assert!((found / expected - 1.0).abs() < share, "{found} {expected}");
    };
    // m ω² = 4 + 4·3, up to the element's part in it, (ωτ)².
    close(frequency(1e-2, ""), 40.0, 1e-9);
    close(frequency(1e-2, "duration = 1.0, w_sine = { amplitude = 1e-6, frequency = 50.0 }"), TAU * 50.0, 1e-15);
    // The spline through 64 points a wave: its third derivative is off by some (qΔx)²/12.
    close(frequency(1e-2, "duration = 1.0, u_rate = -0.5"), TAU * 0.5 / 1e-3, 2e-3);
}

/// Every mass sticks on a flat profile from the start on, so that the links' motion is the carrier's, and the bound is
/// one of the force itself. The layer is pressed from the start, so that relaxed dashpots are elongated.
#[test]
fn the_force_of_a_known_motion_is_within_the_bound() {
    const DURATION: f64 = 4e-3;
    const AMPLITUDE: f64 = 5e-8;
    const FREQUENCY: f64 = 2000.0;
    const PRESSED: f64 = 2e-6;
    for initial in ["relaxed", "undeformed"] {
        let pressed = layer().set("layer.initial", initial).coulomb(0.3);
        let pressed = pressed.phase("duration = 4e-3, w_sine = { amplitude = 5e-8, frequency = 2000.0 }");
        let w = Path { amplitude: AMPLITUDE, frequency: FREQUENCY, ..Path::default() };
        let start = Start { w: -PRESSED, w_rate: TAU * FREQUENCY * AMPLITUDE, ..Start::default() };
        let motion = Motion { duration: DURATION, u: Path::default(), w, ..Motion::default() };
        let exact = along(&pressed.scene(), &start, motion, 200);
        for reduce in [1e-4, 1e-3, 1e-2] {
            let reduced = reduced(&pressed, reduce);
            let reduction = Reduction::new(&reduced).unwrap();
            let vertical = reduction.replaced.iter().filter(|one| one.kind == LinkKind::Vertical);
            let bound: f64 = vertical.map(|one| one.bound).sum();
            // From the start's elongation where the dashpots are relaxed, else from none.
            let elongation = if initial == "relaxed" { AMPLITUDE } else { PRESSED + AMPLITUDE };
            let error = apart(&along(&reduced, &start, motion, 200), &exact, "F_z");
            let size = largest(&exact.column("F_z"));
            // And the tolerance of the runs.
            let allowed = 10.0 * bound * elongation + 1e-7 * size;
            assert!(error <= allowed, "{initial}, {reduce}: {error} N, {allowed} N allowed");
            // The test is sensitive: elements are replaced, and the force changes.
            assert!(bound > 0.0 && error > 0.0, "{initial}, {reduce}: {error} N");
            assert!(exact.column("contact.sticking").iter().all(|&count| count == 10.0));
        }
    }
}

/// With sliding, sticking, lifting and touching the error of the layer is of the size of the links' error.
#[test]
fn the_forces_of_runs_in_contact_change_by_the_share_allowed() {
    let cases = [
        sliding(),
        undeformed(sliding()),
        sliding().without("friction"),
        sliding().without("surface").with("friction = { shear_force = 1e-4 }"),
    ];
    for (i, case) in cases.iter().enumerate() {
        let exact = along(&case.scene(), &SLIDE_START, slide(), 100);
        for share in [1e-4, 1e-3, 1e-2] {
            let found = along(&reduced(case, share), &SLIDE_START, slide(), 100);
            for name in ["F_x", "F_z", "E_diss"] {
                let error = apart(&found, &exact, name);
                let size = largest(&exact.column(name));
                // And the tolerance of the runs.
                assert!(error <= (share + 1e-6) * size, "{i}, {share}, {name}: {error} of {size}");
            }
        }
    }
}

/// The springs with frozen dashpots have their energy: the balance holds as without them.
#[test]
fn the_energy_balance_holds() {
    let reduced = reduced(&sliding(), 1e-2);
    let model = Model::new(&reduced);
    assert!(model.frozen_stiffness.iter().any(|&frozen| frozen > 0.0));
    let start = Start { w: -8e-6, ..SLIDE_START };
    let found = along(&reduced, &start, slide(), 50);
    let [residual, size] = ["energy.residual", "energy.input"].map(|name| largest(&found.column(name)));
    // Of the size of the tolerance, 1e-8, times the steps' number.
    assert!(residual < 1e-6 * size, "{residual} J of {size} J");
}

/// At rest F_z is a force of springs alone, and moving the carrier with frozen states takes its work.
#[test]
fn the_energys_derivative_is_the_force() {
    let reduced = reduced(&sliding(), 1e-2);
    let mut simulation = Simulation::new(&reduced, &Start { w: -8e-6, ..Start::default() }).unwrap();
    let variables = variables(&reduced);
    let mut values = vec![0.0; variables.len()];
    simulation.evaluate(&variables, &mut values);
    let of = |name: &str, values: &[f64]| values[variables.iter().position(|one| one.name == name).unwrap()];
    let force = of("F_z", &values);
    simulation.directional_derivative(&variables, (0.0, 1.0), &mut values);
    let change = of("energy.elastic", &values);
    // Sums of a few terms of one size.
    assert!((change + force).abs() < 1e-12 * force.abs() && force > 0.0, "{change} {force}");
}

/// A saved run contains the elongations of the frozen dashpots.
#[test]
fn a_saved_run_goes_on_bit_for_bit() {
    let reduced = reduced(&sliding(), 1e-2);
    let mut first = Simulation::new(&reduced, &Start { u: 1.3e-4, w: -8e-6, ..SLIDE_START }).unwrap();
    let half = Motion { duration: 2e-4, ..slide() };
    first.advance(&half).unwrap();
    let mut second = Simulation::restore(&reduced, &first.state()).unwrap();
    assert_eq!((first.advance(&half), second.advance(&half)), (Ok(()), Ok(())));
    let variables = variables(&reduced);
    let bits = [&mut first, &mut second].map(|simulation| {
        let mut values = vec![0.0; variables.len()];
        simulation.evaluate(&variables, &mut values);
        values.into_iter().map(f64::to_bits).collect::<Vec<_>>()
    });
    assert_eq!(bits[0], bits[1]);
}
