//! `solver.reduce`: Maxwell elements replaced by springs and dampers, and what that changes.
use std::f64::consts::TAU;
use std::path::Path as FilePath;

use asperity::model::{LinkKind, Model, Reduction, Replacement};
use asperity::outputs::{Snapshot, variables};
use asperity::scene::{Path, Scene};
use asperity::simulation::{Motion, Simulation, Start};

/// A measured compound: E_j (MPa) at τ_j = 1e-13 s, 1e-12 s and so on to 100 s, and E_∞.
const COMPOUND: [f64; 16] =
    [1538.0, 888.0, 824.0, 495.0, 201.0, 76.3, 31.9, 14.8, 8.12, 4.65, 3.16, 2.26, 1.67, 1.42, 0.969, 1.26];
const EQUILIBRIUM: f64 = 4.44;

/// The compound's link with this modulus times geometry, m.
fn link(name: &str, geometry: f64) -> String {
    let element = |(j, modulus): (usize, &f64)| {
        let relaxation_time = 10_f64.powi(j as i32 - 13);
        format!("{{ stiffness = {:?}, relaxation_time = {relaxation_time:?} }}", 1e6 * geometry * modulus)
    };
    let elements: Vec<_> = COMPOUND.iter().enumerate().map(element).collect();
    format!("{name} = {{ stiffness = {:?}, maxwell = [{}] }}\n", 1e6 * geometry * EQUILIBRIUM, elements.join(", "))
}

/// The parts of a scene besides the compound.
#[derive(Clone, Copy)]
struct Case {
    initial: &'static str,
    surface: &'static str,
    friction: &'static str,
    /// Phases of the scene; the test moves the carrier by itself.
    excitation: &'static str,
}

const WAVE: &str = "kind = 'sinusoid', amplitude = 1e-5, wavelength = 9.3e-4";
const SLIDE: &str = "[[excitation]]\nduration = 2e-3\nu_rate = 0.5\n";

const SLIDING: Case = Case { initial: "relaxed", surface: WAVE, friction: "coulomb = 0.3", excitation: SLIDE };

fn scene(case: &Case, reduce: &str) -> Scene {
    let links = [("vertical", 1e-3), ("horizontal", 3.4e-4), ("lateral_x", 2e-4), ("lateral_z", 1e-4)];
    let text = format!(
        "name = 'compound'\nsurface = {{ {} }}\nfriction = {{ {} }}\nsolver = {{ relative_tolerance = 1e-8, absolute_tolerance = 1e-14{reduce} }}\n\
         fmu = {{ outputs = ['forces', 'dissipation', 'contact', 'energy'] }}\n\
         [layer]\nmasses = 10\nspacing = 1e-4\nmass = 1.1e-6\ninitial = '{}'\n{}{}",
        case.surface,
        case.friction,
        case.initial,
        links.map(|(name, geometry)| link(name, geometry)).concat(),
        case.excitation
    );
    Scene::parse(&text, FilePath::new("compound.toml")).unwrap()
}

/// The outputs after each of `pieces` even pieces of a motion.
fn rows(scene: &Scene, start: &Start, motion: &Motion, pieces: u32) -> Vec<Vec<f64>> {
    let times: Vec<f64> = (1..=pieces).map(|i| motion.duration * f64::from(i) / f64::from(pieces)).collect();
    let variables = variables(scene);
    let mut simulation = Simulation::new(scene, start).unwrap();
    let mut rows = Vec::new();
    let row = |_: f64, now: &Snapshot<'_>| {
        let mut values = vec![0.0; variables.len()];
        now.evaluate(&variables, &mut values);
        rows.push(values);
    };
    simulation.advance_observed(motion, None, &times, row).unwrap();
    rows
}

fn column(scene: &Scene, rows: &[Vec<f64>], name: &str) -> Vec<f64> {
    let index = variables(scene).iter().position(|variable| variable.name == name).unwrap();
    rows.iter().map(|row| row[index]).collect()
}

fn largest(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().fold(0.0, |largest, value| largest.max(value.abs()))
}

/// The largest difference of an output of two scenes' rows.
fn difference(scenes: [&Scene; 2], both: [&[Vec<f64>]; 2], name: &str) -> f64 {
    let [a, b] = [0, 1].map(|i| column(scenes[i], both[i], name));
    largest(a.iter().zip(&b).map(|(a, b)| a - b))
}

const SLIDE_START: Start =
    Start { time: 0.0, u: 0.0, w: -2e-6, u_rate: 0.5, w_rate: 0.0, load: 0.0, pull: 0.0, temperature: None };

fn slide() -> Motion {
    Motion { duration: 2e-3, u: Path { rate: 0.5, ..Path::default() }, w: Path::default(), ..Motion::default() }
}

#[test]
fn without_reduce_and_with_none_the_runs_are_the_same_to_the_last_bit() {
    let (without, none) = (scene(&SLIDING, ""), scene(&SLIDING, ", reduce = 0.0"));
    assert_eq!(rows(&without, &SLIDE_START, &slide(), 20), rows(&none, &SLIDE_START, &slide(), 20));
    assert_eq!((Reduction::new(&without), without), (None, none));
}

#[test]
fn few_of_sixteen_elements_stay() {
    let (whole, reduced) = (scene(&SLIDING, ""), scene(&SLIDING, ", reduce = 1e-3"));
    let [before, after] = [&whole, &reduced].map(|scene| Model::new(scene).rows.len());
    assert_eq!(before, 64);
    assert!(after <= 32, "{after} of {before} rows stay");
    let bytes = [&whole, &reduced].map(|scene| Simulation::new(scene, &SLIDE_START).unwrap().bytes());
    // Ten of sixteen elements less in each of four states; the rest does not depend on their number.
    assert!(4 * bytes[1] < 3 * bytes[0], "{bytes:?}");
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
    let case = Case { initial: "undeformed", ..SLIDING };
    let replaced = Reduction::new(&scene(&case, ", reduce = 1e-3")).unwrap().replaced;
    assert!(!replaced.is_empty() && replaced.iter().all(|one| one.by == Replacement::Spring), "{replaced:?}");
}

#[test]
fn the_bounds_of_a_link_add_up_to_no_more_than_its_share() {
    for reduce in [1e-6, 1e-4, 1e-2] {
        let scene = scene(&SLIDING, &format!(", reduce = {reduce:?}"));
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
    let case = Case { excitation: "", ..SLIDING };
    let reduction = Reduction::new(&scene(&case, ", reduce = 1e-3")).unwrap();
    assert!(reduction.run.is_infinite() && !reduction.replaced.is_empty());
    assert!(reduction.replaced.iter().all(|one| one.by == Replacement::Damper), "{:?}", reduction.replaced);
}

/// The frequency is that of the profile's wave, of the carrier's sine, or the layer's own.
#[test]
fn the_frequency_is_the_largest_of_three() {
    let frequency = |mass: &str, excitation: &str| {
        let surface = "kind = 'sinusoid', amplitude = 1e-5, wavelength = 1e-3";
        let text = format!(
            "name = 'a'\nlayer = {{ masses = 3, spacing = 1e-4, mass = {mass}, vertical = {{ stiffness = 4.0, maxwell = [\
             {{ stiffness = 1.0, relaxation_time = 1e-9 }}] }}, lateral_z = {{ stiffness = 3.0 }} }}\n\
             surface = {{ {surface} }}\nsolver = {{ reduce = 1e-3 }}\n{excitation}"
        );
        Reduction::new(&Scene::parse(&text, FilePath::new("a.toml")).unwrap()).unwrap().frequency
    };
    let close = |found: f64, expected: f64, share: f64| {
        assert!((found / expected - 1.0).abs() < share, "{found} {expected}");
    };
    // m ω² = 4 + 4·3, up to the element's part in it, (ωτ)².
    close(frequency("1e-2", ""), 40.0, 1e-9);
    close(
        frequency("1e-2", "[[excitation]]\nduration = 1.0\nw_sine = { amplitude = 1e-6, frequency = 50.0 }"),
        TAU * 50.0,
        1e-15,
    );
    // The spline through 64 points a wave: its third derivative is off by some (qΔx)²/12.
    close(frequency("1e-2", "[[excitation]]\nduration = 1.0\nu_rate = -0.5"), TAU * 0.5 / 1e-3, 2e-3);
}

/// Every mass sticks on a flat profile from the start on, so that the links' motion is the carrier's, and the bound is one
/// of the force itself. The layer is pressed from the start, so that relaxed dashpots are elongated.
#[test]
fn the_force_of_a_known_motion_is_within_the_bound() {
    const DURATION: f64 = 4e-3;
    const AMPLITUDE: f64 = 5e-8;
    const FREQUENCY: f64 = 2000.0;
    const PRESSED: f64 = 2e-6;
    for initial in ["relaxed", "undeformed"] {
        let case = Case {
            initial,
            surface: "kind = 'flat'",
            friction: "coulomb = 0.3",
            excitation: "[[excitation]]\nduration = 4e-3\nw_sine = { amplitude = 5e-8, frequency = 2000.0 }\n",
        };
        let w = Path { amplitude: AMPLITUDE, frequency: FREQUENCY, ..Path::default() };
        let start = Start { w: -PRESSED, w_rate: TAU * FREQUENCY * AMPLITUDE, ..Start::default() };
        let motion = Motion { duration: DURATION, u: Path::default(), w, ..Motion::default() };
        let whole = scene(&case, "");
        let exact = rows(&whole, &start, &motion, 200);
        for reduce in ["1e-4", "1e-3", "1e-2"] {
            let reduced = scene(&case, &format!(", reduce = {reduce}"));
            let reduction = Reduction::new(&reduced).unwrap();
            let vertical = reduction.replaced.iter().filter(|one| one.kind == LinkKind::Vertical);
            let bound: f64 = vertical.map(|one| one.bound).sum();
            // From the start's elongation where the dashpots are relaxed, else from none.
            let elongation = if initial == "relaxed" { AMPLITUDE } else { PRESSED + AMPLITUDE };
            let found = rows(&reduced, &start, &motion, 200);
            let error = difference([&reduced, &whole], [&found, &exact], "F_z");
            let size = largest(column(&whole, &exact, "F_z"));
            // And the tolerance of the runs.
            let allowed = 10.0 * bound * elongation + 1e-7 * size;
            assert!(error <= allowed, "{initial}, {reduce}: {error} N, {allowed} N allowed");
            // The test is sensitive: elements are replaced, and the force changes.
            assert!(bound > 0.0 && error > 0.0, "{initial}, {reduce}: {error} N");
            assert!(largest(column(&whole, &exact, "contact.sticking").into_iter().map(|count| count - 10.0)) == 0.0);
        }
    }
}

/// With sliding, sticking, lifting and touching the error of the layer is of the size of the links' error.
#[test]
fn the_forces_of_runs_in_contact_change_by_the_share_allowed() {
    let cases = [
        SLIDING,
        Case { initial: "undeformed", ..SLIDING },
        Case { friction: "", ..SLIDING },
        Case { friction: "shear_force = 1e-4", surface: "kind = 'flat'", ..SLIDING },
    ];
    for (i, case) in cases.iter().enumerate() {
        let whole = scene(case, "");
        let exact = rows(&whole, &SLIDE_START, &slide(), 100);
        for share in [1e-4, 1e-3, 1e-2] {
            let reduced = scene(case, &format!(", reduce = {share:?}"));
            let found = rows(&reduced, &SLIDE_START, &slide(), 100);
            for name in ["F_x", "F_z", "E_diss"] {
                let error = difference([&reduced, &whole], [&found, &exact], name);
                let size = largest(column(&whole, &exact, name));
                // And the tolerance of the runs.
                assert!(error <= (share + 1e-6) * size, "{i}, {share}, {name}: {error} of {size}");
            }
        }
    }
}

/// The springs with frozen dashpots have their energy: the balance holds as without them.
#[test]
fn the_energy_balance_holds() {
    let reduced = scene(&SLIDING, ", reduce = 1e-2");
    let model = Model::new(&reduced);
    assert!(model.frozen_stiffness.iter().any(|&frozen| frozen > 0.0));
    let start = Start { w: -8e-6, ..SLIDE_START };
    let found = rows(&reduced, &start, &slide(), 50);
    let residual = largest(column(&reduced, &found, "energy.residual"));
    let size = largest(column(&reduced, &found, "energy.input"));
    // Of the size of the tolerance, 1e-8, times the steps' number.
    assert!(residual < 1e-6 * size, "{residual} J of {size} J");
}

/// At rest F_z is a force of springs alone, and moving the carrier with frozen states takes its work.
#[test]
fn the_energys_derivative_is_the_force() {
    let reduced = scene(&SLIDING, ", reduce = 1e-2");
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
    let reduced = scene(&SLIDING, ", reduce = 1e-2");
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
