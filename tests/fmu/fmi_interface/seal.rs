//! A lip with a film through the same interface as a layer.

use asperity::scene::CanonicalFiles;
use asperity::seal::{Seal, SealMotion, SealRun, SealStart};

use crate::common::{assert_names, root};
use crate::fmu::fmi_interface::lifecycle::try_all;
use crate::fmu::fmi_interface::master::{DISCARD, ERROR, Fmu, OK};

const LIP: &str = r#"
name = "lip"
[table]
path = "film-strokes.table.csv"
[seal]
pressure = "film-strokes.lip.csv"
length = 0.157
rough = "moving"
stiffness = 2e6
cells = 32
[fluid]
viscosity = 0.08
[fmu]
outputs = ["forces", "dissipation", "film", "contact", "tangent", "cells"]
"#;

const SPEED: f64 = 0.01;
const SEALED: f64 = 2e6;
const H: f64 = 2e-3;

fn fmu(text: &str) -> Fmu {
    Fmu::of_seal(text, &root().join("tests/reference/film"))
}

/// u (m) after so many steps out and, from the twentieth on, in.
fn u(step: u32) -> f64 {
    SPEED * H * f64::from(if step > 20 { 40_u32.saturating_sub(step) } else { step })
}

fn give(fmu: &Fmu, step: u32, with_rates: bool) {
    assert_eq!((fmu.set_real("u", u(step)), fmu.set_real("sealed_pressure", SEALED)), (OK, OK));
    if with_rates {
        assert_eq!(fmu.set_rate("u", (u(step + 1) - u(step)) / H), OK);
        assert_eq!(fmu.set_rate("sealed_pressure", 0.0), OK);
    }
}

/// An instance that has done some steps.
fn moving_of(text: &str, steps: u32, with_rates: bool) -> Fmu {
    let fmu = fmu(text);
    assert_eq!((fmu.setup(0.0), fmu.enter()), (OK, OK));
    give(&fmu, 0, with_rates);
    assert_eq!(fmu.exit(), OK);
    (0..steps).for_each(|step| {
        give(&fmu, step, with_rates);
        assert_eq!(fmu.step(H * f64::from(step), H), OK);
    });
    fmu
}

fn moving(steps: u32) -> Fmu {
    moving_of(LIP, steps, true)
}

/// So much pressure so fast that the step is discarded.
fn failed() -> Fmu {
    let fmu = moving(0);
    assert_eq!((fmu.set_rate("sealed_pressure", 1e12), fmu.step(0.0, H)), (OK, DISCARD));
    fmu
}

fn in_error() -> Fmu {
    let fmu = moving(1);
    assert_eq!((fmu.set_real("sealed_pressure", f64::NAN), fmu.step(H, H)), (OK, ERROR));
    fmu
}

#[test]
fn every_function_in_every_state() {
    try_all([
        ('I', || fmu(LIP)),
        ('M', || {
            let fmu = fmu(LIP);
            assert_eq!((fmu.setup(0.0), fmu.enter()), (OK, OK));
            fmu
        }),
        ('C', || moving(0)),
        ('F', failed),
        ('T', || {
            let fmu = moving(1);
            assert_eq!(fmu.terminate(), OK);
            fmu
        }),
        ('E', in_error),
    ]);
}

/// The library's own run, to rounding of what the master gives; with a state of it in between, bit for bit.
#[test]
fn its_results_are_those_of_the_library_and_states_restore_it() {
    let path = root().join("tests/reference/film/of-a-test.toml");
    let seal = Seal::parse_with(LIP, &path, &CanonicalFiles, &[]).unwrap();
    let start = SealStart { sealed_pressure: SEALED, u_rate: SPEED, ..SealStart::default() };
    let mut run = SealRun::new(&seal, &start).unwrap();
    for step in 0..30 {
        let u_rate = (u(step + 1) - u(step)) / H;
        run.advance(&SealMotion { duration: H, u_rate, ..SealMotion::default() }).unwrap();
    }
    let fmu = moving(25);
    let mut state = fmu.state();
    let on = |fmu: &Fmu| {
        (25..30).for_each(|step| {
            give(fmu, step, true);
            assert_eq!(fmu.step(H * f64::from(step), H), OK);
        });
        fmu.bits()
    };
    let first = on(&fmu);
    for name in ["F_x", "E_diss", "film.leak", "film.thickness"] {
        let variables = seal.variables();
        let expected = run.value(variables.iter().find(|variable| variable.name == name).unwrap().output);
        let found = fmu.real(name);
        // Changes of stick and slip are located to 1e-9 of a step.
        assert!((found - expected).abs() <= 1e-6 * expected.abs(), "{name}: {found} {expected}");
    }
    assert!(fmu.real("F_x") > 5.0 && fmu.real("film.on_rod") > 0.0);
    assert_eq!((fmu.set_state(state), on(&fmu)), (OK, first.clone()));
    // A copy as bytes, too.
    assert_eq!(fmu.set_state(state), OK);
    let (bytes, mut copy) = (fmu.serialised(state), std::ptr::null_mut());
    assert_eq!(fmu.deserialise(&bytes, &mut copy), OK);
    assert_eq!((fmu.set_state(copy), on(&fmu)), (OK, first.clone()));
    assert_eq!((fmu.free_state(&mut copy), fmu.free_state(&mut state)), (OK, OK));
}

/// Values alone: a prediction that does not come true is done again, so that the run is that with rates, a step behind.
#[test]
fn values_alone_come_to_the_same() {
    let (rates, values) = (moving_of(LIP, 30, true), moving_of(LIP, 30, false));
    // The value at the end of the last step is not known to it.
    give(&values, 30, false);
    assert_eq!(values.step(30.0 * H, 1e-9), OK);
    give(&rates, 30, true);
    assert_eq!(rates.step(30.0 * H, 1e-9), OK);
    let [found, expected] = [&values, &rates].map(|fmu| fmu.real("E_diss"));
    assert!((found - expected).abs() <= 1e-3 * expected, "{found} {expected}");
}

/// By a target a little farther.
#[test]
fn tangents_are_changes_with_the_target() {
    let end = |shift: f64| {
        let fmu = moving(10);
        give(&fmu, 10, true);
        assert_eq!(fmu.set_rate("u", SPEED + shift / H), OK);
        assert_eq!(fmu.step(10.0 * H, H), OK);
        (
            ["F_x", "film.leak"].map(|name| fmu.real(name)),
            ["tangent.F_x.u", "tangent.film.leak.u"].map(|name| fmu.real(name)),
        )
    };
    let by = 1e-3 * SPEED * H;
    let ((before, _), (_, tangents), (after, _)) = (end(-by), end(0.0), end(by));
    for i in 0..2 {
        let quotient = (after[i] - before[i]) / (2.0 * by);
        // Both are differences, of steps whose error is controlled to 1e-3.
        assert!((quotient - tangents[i]).abs() <= 2e-2 * quotient.abs(), "{i}: {quotient:e} {:e}", tangents[i]);
    }
}

/// Blown open: the step is discarded, nothing has changed, and a shorter one is done.
#[test]
fn a_seal_that_is_blown_open_is_as_before() {
    let fmu = moving(3);
    let before = fmu.bits();
    give(&fmu, 3, true);
    assert_eq!(fmu.set_rate("sealed_pressure", 1e10), OK);
    assert_eq!(fmu.step(3.0 * H, H), DISCARD);
    assert_names(fmu.message(), "blown open | Pa that press the lip");
    assert_eq!(fmu.bits(), before);
    assert_eq!(fmu.set_rate("sealed_pressure", 0.0), OK);
    assert_eq!(fmu.step(3.0 * H, H), OK);
}

#[test]
fn what_is_wrong_in_its_parameters_is_named() {
    let fmu = fmu(LIP);
    assert_eq!(fmu.set_real("solver.relative_tolerance", 0.0), ERROR);
    assert_names(fmu.message(), "solver.relative_tolerance");
    assert_eq!(fmu.set_text(fmu.reference("table.extrapolation"), "guess"), ERROR);
    for (name, value) in [("seal.stiffness", 1e6), ("seal.length", 0.2), ("fluid.supply", 2e-4)] {
        assert_eq!((fmu.set_real(name, value), fmu.set_real(name, -1.0)), (OK, ERROR), "{name}");
    }
}
