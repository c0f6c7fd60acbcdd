//! Experiments and communication steps.

use asperity_fmi::bindings::fmi2StatusKind_fmi2LastSuccessfulTime;

use asperity::outputs::{Output, variables};
use asperity::scene::{Path, Scene};
use asperity::simulation::{Motion, Simulation, Start};

use crate::fmu::fmi_interface::master::{DISCARD, ERROR, EVERYTHING, Fmu, Folder, OK};

#[test]
fn the_start_may_be_any_time_and_the_stop_time_holds() {
    let fmu = Fmu::new();
    assert_eq!(fmu.setup_all(None, -3.0, Some(-3.0 + 2e-6)), OK);
    assert_eq!((fmu.enter(), fmu.exit()), (OK, OK));
    assert_eq!(fmu.last_successful_time(), -3.0);
    assert_eq!(fmu.step(-3.0, 1e-6), OK);
    assert_eq!(fmu.step(-3.0 + 1e-6, 2e-6), ERROR);
    assert!(fmu.message().contains("stop time"));
    assert_eq!(fmu.step(-3.0 + 1e-6, 1e-6), OK);
}

#[test]
fn invalid_experiments_are_refused() {
    let fmu = Fmu::new();
    for (tolerance, start, stop) in [
        (None, f64::NAN, None),
        (None, f64::INFINITY, None),
        (None, 0.0, Some(f64::NAN)),
        (None, 1.0, Some(0.0)),
        (Some(f64::NAN), 0.0, None),
        (Some(-1e-6), 0.0, None),
    ] {
        assert_eq!(fmu.setup_all(tolerance, start, stop), ERROR, "{tolerance:?} {start} {stop:?}");
        fmu.message();
    }
    assert_eq!(fmu.enter(), OK);
    assert_eq!(fmu.real("solver.relative_tolerance"), 1e-6);
}

#[test]
fn a_tolerance_is_the_parameter_unless_that_is_set_later() {
    let fmu = Fmu::new();
    assert_eq!(fmu.set_real("solver.relative_tolerance", 1e-4), OK);
    assert_eq!((fmu.setup_all(Some(1e-7), 0.0, None), fmu.enter()), (OK, OK));
    assert_eq!(fmu.real("solver.relative_tolerance"), 1e-7);
    assert_eq!(fmu.set_real("solver.relative_tolerance", 1e-5), OK);
    assert_eq!(fmu.real("solver.relative_tolerance"), 1e-5);
}

#[test]
fn a_step_ends_at_the_masters_time() {
    let fmu = Fmu::running();
    assert_eq!(fmu.step(0.0, 0.1e-6), OK);
    let point = 0.1e-6 * (1.0 + 1e-11);
    assert_eq!(fmu.step(point, 0.2e-6), OK);
    assert_eq!(fmu.last_successful_time(), point + 0.2e-6);
    assert_eq!(fmu.last_step(), (OK, OK));
}

#[test]
fn a_step_of_size_0_changes_nothing() {
    let fmu = Fmu::running();
    assert_eq!((fmu.set_rate("u", 1.0), fmu.set_real("u", f64::NAN)), (OK, OK));
    assert_eq!(fmu.step(0.0, 0.0), OK);
    assert_eq!(fmu.last_successful_time(), 0.0);
    assert_eq!(fmu.messages(), []);
}

#[test]
fn a_start_that_is_not_a_number_is_an_error() {
    let fmu = Fmu::initialising();
    assert_eq!(fmu.set_real("u", f64::NAN), OK);
    assert_eq!(fmu.get_reals(&[fmu.reference("F_x")], &mut [0.0]), ERROR);
    assert_eq!((fmu.exit(), fmu.step(0.0, 1e-6)), (ERROR, ERROR));
    assert_eq!(fmu.reset(), OK);
}

#[test]
fn a_status_that_does_not_exist_is_discarded() {
    let (fmu, mut value) = (Fmu::running(), 0);
    let kind = fmi2StatusKind_fmi2LastSuccessfulTime;
    // SAFETY: the instance and the value live.
    assert_eq!(unsafe { asperity_fmi::fmi2GetStatus(fmu.c, kind, &mut value) }, DISCARD);
    assert!(fmu.message().contains("asynchronous"));
}

#[test]
fn derivatives_are_of_order_one_and_of_inputs() {
    let fmu = Fmu::running();
    let (u, force) = (fmu.reference("u"), fmu.reference("F_x"));
    assert_eq!(fmu.set_rates(&[u], &[-1], &[1.0]), ERROR);
    assert!(fmu.message().contains("order -1"));
    assert_eq!(fmu.set_rates(&[u, force], &[1, 1], &[f64::NAN, 1.0]), ERROR);
    assert!(fmu.message().contains("F_x"));
    // The rate that came with the refused one was not taken.
    assert_eq!(fmu.step(0.0, 1e-6), OK);
}

#[test]
fn the_stop_time_may_be_overshot_by_rounding() {
    let fmu = Fmu::new();
    assert_eq!(fmu.setup_all(None, 0.0, Some(1e-6)), OK);
    assert_eq!((fmu.enter(), fmu.exit()), (OK, OK));
    // Ten tenths are more than one.
    let times: Vec<f64> = (0..10).scan(0.0, |time, _| Some(std::mem::replace(time, *time + 1e-7))).collect();
    assert!(times[9] + 1e-7 > 1e-6 || times[9] + 1.00000000001e-7 > 1e-6);
    times[..9].iter().for_each(|&time| assert_eq!(fmu.step(time, 1e-7), OK));
    let state = fmu.state();
    assert_eq!(fmu.step(times[9], 1.001e-7), ERROR);
    assert!(fmu.message().contains("stop time"));
    assert_eq!((fmu.step(times[9], 1e-7 + 5e-18), fmu.set_state(state), fmu.step(times[9], 1e-7)), (OK, OK, OK));
}

/// Equal: within 1e-10 max(|t|, h), 1e-6 h or, up to a thousandth of h, the rounding of a clock in single precision; and less than
/// half a step away.
#[test]
fn points_equal_but_for_rounding_are_accepted() {
    let at = |time: f64| {
        let fmu = Fmu::new();
        assert_eq!((fmu.setup(time), fmu.enter(), fmu.exit()), (OK, OK, OK));
        fmu
    };
    for (time, h, point, expected) in [
        (1.0, 1e-6, 1.0 + 0.99e-10, OK),
        (1.0, 1e-6, 1.0 - 0.99e-10, OK),
        (1.0, 1e-6, 1.0 + 0.9e-9, OK),
        (1.0, 1e-6, 1.0 + 1.1e-9, ERROR),
        (1.0, 1e-6, 1.0 + 1e-6, ERROR),
        (1.0, 1e-6, f64::NAN, ERROR),
        (-5.0, 1e-6, -5.0 + 4.9e-10, OK),
        (0.0, 1e-6, 0.9e-12, OK),
        (0.0, 1e-6, 1.1e-12, ERROR),
        // Within the rounding of t, but half a step away.
        (1.0, 1e-10, 1.0 + 0.6e-10, ERROR),
        (1.0, 1e-10, 1.0 + 0.4e-10, OK),
    ] {
        assert_eq!(at(time).step(point, h), expected, "{time} {h} {point}");
    }
}

/// By every method a step has the results of the library for the same motion, and a serialised state continues bit for
/// bit.
#[test]
fn every_method_agrees_with_the_library() {
    for method in ["event", "step", "auto"] {
        let solver = format!("[solver]\nmethod = \"{method}\"\nrelative_tolerance = 1e-3\n[fmu]");
        let text = EVERYTHING.replace("[fmu]", &solver);
        let fmu = Fmu::initialising_with(&text);
        assert_eq!((fmu.set_real("w", -4e-6), fmu.set_rate("u", 1.0), fmu.exit()), (OK, OK, OK));
        let folder = Folder::with_scene(method, &text);
        let scene = Scene::load(&folder.scene_file()).unwrap();
        let start = Start { w: -4e-6, u_rate: 1.0, ..Start::default() };
        let mut simulation = Simulation::new(&scene, &start).unwrap();
        let variables = variables(&scene);
        let mut values = vec![0.0; variables.len()];
        let (h, u) = (1e-6, Path { rate: 1.0, ..Path::default() });
        for i in 0..60 {
            let point = h * f64::from(i);
            assert_eq!((fmu.set_real("u", point), fmu.set_rate("u", 1.0), fmu.step(point, h)), (OK, OK, OK));
            simulation.advance(&Motion { duration: h, u, w: Path::default(), ..Motion::default() }).unwrap();
            simulation.evaluate(&variables, &mut values);
            for name in ["F_x", "F_z", "E_diss"] {
                let at = variables.iter().position(|variable| variable.name == name).unwrap();
                let (found, wanted) = (fmu.real(name), values[at]);
                // The carrier goes to the same place by rates that roundings tell apart.
                assert!((found - wanted).abs() <= 1e-9 * wanted.abs() + 1e-12, "{method} {i}: {name} {found} {wanted}");
            }
            let bits = fmu.bits();
            fmu.thaw(&fmu.frozen());
            assert_eq!(fmu.bits(), bits);
        }
    }
}

/// A number from 0 to 1 by the generator whose sequences the seeds below were chosen of (Marsaglia, Xorshift RNGs, 2003).
fn random(state: &mut u64) -> f64 {
    *state ^= *state << 13;
    *state ^= *state >> 7;
    *state ^= *state << 17;
    (*state >> 11) as f64 / (1u64 << 53) as f64
}

/// Inputs that jump at up to 3e6 m/s leave masses so fast that the rounding of their velocities and positions exceeds the
/// tolerances of events. The number of steps tried in one communication step is limited all the same.
#[test]
fn inputs_that_jump_wildly_cost_limited_work() {
    let mut scene = Scene::load(&crate::common::root().join("tests/reference/rough-coulomb.toml")).unwrap();
    scene.solver.relative_tolerance = 1e-9;
    let wanted = [Output::Steps, Output::Rejected];
    let counts: Vec<_> = variables(&scene).into_iter().filter(|one| wanted.contains(&one.output)).collect();
    for seed in [5_u64, 15, 21, 39, 82] {
        let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1;
        let mut simulation = Simulation::new(&scene, &Start::default()).unwrap();
        let mut before = 0.0;
        for _ in 0..50 {
            let duration = 1e-8 * 3e3_f64.powf(random(&mut state));
            let fastest = 3e6 * 1e-6_f64.powf(random(&mut state));
            let mut path =
                |share: f64| Path { rate: fastest * share * (2.0 * random(&mut state) - 1.0), ..Path::default() };
            let motion = Motion { duration, u: path(1.0), w: path(1e-4), ..Motion::default() };
            simulation.advance(&motion).unwrap();
            let mut values = [0.0; 2];
            simulation.evaluate(&counts, &mut values);
            let tried = values[0] + values[1];
            assert!(tried - before < 2_000.0, "{} steps tried in {motion:?} of seed {seed}", tried - before);
            before = tried;
        }
    }
}
