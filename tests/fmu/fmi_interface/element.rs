//! A point-contact element through the same interface as a layer.

use asperity_fmi::Kind;

use crate::common::assert_names;
use crate::common::near::assert_relative;
use crate::common::sweeps::{AREA, Grid, REST, WARM, friction, separation, stiffness};
use crate::fmu::fmi_interface::master::{DISCARD, ERROR, Fmu, OK};
use crate::fmu::fmi_interface::states::{self};

/// w at a speed (m/s) and a pressure (Pa), m.
fn w(speed: f64, pressure: f64) -> f64 {
    separation(speed, pressure, WARM) - REST
}

/// An element pressed at rest to `pressure` (Pa).
fn pressed(pressure: f64) -> Fmu {
    let fmu = Fmu::of_table(&Grid::plain().text(), false);
    assert_eq!((fmu.setup(0.0), fmu.enter(), fmu.set_real("w", w(1e-4, pressure)), fmu.exit()), (OK, OK, OK, OK));
    fmu
}

/// A step of `h` from `time` at the rates u̇ and ẇ, the carrier being at u and w.
fn step(fmu: &Fmu, (time, h): (f64, f64), (u, w): (f64, f64), (u_rate, w_rate): (f64, f64)) -> i32 {
    assert_eq!((fmu.set_real("u", u), fmu.set_real("w", w)), (OK, OK));
    assert_eq!((fmu.set_rate("u", u_rate), fmu.set_rate("w", w_rate)), (OK, OK));
    i32::try_from(fmu.step(time, h)).unwrap()
}

#[test]
fn its_variables_have_the_names_of_a_layers() {
    let fmu = pressed(2e5);
    let names: Vec<String> = fmu.variables.entries().map(|(_, entry)| entry.name.clone()).collect();
    let expected = [
        "u",
        "w",
        "F_x",
        "F_z",
        "P_diss",
        "E_diss",
        "dissipation.E_damper",
        "dissipation.E_maxwell",
        "dissipation.E_friction",
        "friction.F_hysteresis",
        "friction.F_adhesion",
        "friction.coefficient",
        "contact.ratio",
        "table.extrapolation",
        "input.extrapolation",
        "input.interval",
        "patch.damping",
    ];
    assert_eq!(names, expected);
    let warm = Grid { temperatures: vec![290.0, 300.0, 310.0], ..Grid::plain() };
    let fmu = Fmu::of_table(&warm.text(), false);
    assert_eq!((fmu.enter(), fmu.real("material.wlf.temperature")), (OK, 300.0));
    assert_eq!(fmu.set_real("material.wlf.temperature", 305.0), OK);
    assert_eq!(fmu.set_real("material.wlf.temperature", 320.0), ERROR);
    assert_names(fmu.message(), "from 290.0 to 310.0");
}

#[test]
fn motions_beyond_the_table_are_refused_and_leave_it_unchanged() {
    let fmu = pressed(4e5);
    let here = w(1e-4, 4e5);
    assert_eq!(step(&fmu, (0.0, 1e-3), (0.0, here), (0.01, 0.0)), 0);
    let bits = fmu.bits();
    // Too deep at its end: a shorter step may end before.
    assert_eq!(step(&fmu, (1e-3, 1.0), (1e-5, here), (0.01, -1e-4)), DISCARD as i32);
    let text = fmu.message();
    assert!(text.contains("separation") && text.contains("800000 Pa") && text.contains("0.01 m/s"), "{text}");
    assert_eq!((fmu.bits(), fmu.last_successful_time()), (bits, 1e-3));
    assert_eq!(step(&fmu, (1e-3, 1e-3), (1e-5, here), (0.01, -1e-4)), 0);
    // Too fast, however short the step.
    assert_eq!(step(&fmu, (2e-3, 1e-3), (2e-5, here), (-20.0, 0.0)), ERROR as i32);
    let text = fmu.message();
    assert_names(&text, "20 m/s | t = 0.002 s | 0.0001 to 10 m/s");
}

#[test]
fn an_extrapolated_table_allows_motions_beyond_it() {
    let fmu = Fmu::of_table(&Grid::plain().text(), false);
    let reference = fmu.reference("table.extrapolation");
    assert_eq!((fmu.set_text(reference, "stop"), fmu.set_text(reference, "hold")), (ERROR, OK));
    assert!(fmu.message().contains(r#"table.extrapolation = "stop": expected one of "refuse", "hold""#));
    assert_eq!((fmu.setup(0.0), fmu.enter(), fmu.set_real("w", -6e-5), fmu.exit()), (OK, OK, OK, OK));
    assert_eq!(step(&fmu, (0.0, 1e-2), (0.0, -6e-5), (20.0, 0.0)), 0);
    assert_relative("friction", fmu.real("friction.coefficient"), friction(10.0, 8e5, WARM), 1e-8);
    assert!(fmu.real("F_z") > 8e5 * AREA);
}

#[test]
fn a_start_beyond_the_table_is_an_error() {
    let fmu = Fmu::of_table(&Grid::plain().text(), false);
    assert_eq!((fmu.setup(0.0), fmu.enter(), fmu.set_real("w", -9e-5)), (OK, OK, OK));
    assert_eq!(fmu.get_reals(&[fmu.reference("F_z")], &mut [0.0]), ERROR);
    assert_eq!((fmu.exit(), fmu.reset(), fmu.enter(), fmu.exit()), (ERROR, OK, OK, OK));
}

#[test]
fn a_tolerance_is_accepted_and_ignored() {
    let fmu = Fmu::of_table(&Grid::plain().text(), false);
    assert_eq!((fmu.setup_all(Some(1e-5), 0.0, None), fmu.enter(), fmu.exit()), (OK, OK, OK));
}

#[test]
fn states_are_restored_and_serialised_bit_for_bit() {
    let (fmu, other) = (pressed(2e5), Fmu::of_table(&Grid::plain().text(), false));
    assert_eq!(step(&fmu, (0.0, 1e-5), (0.0, w(1e-4, 2e5)), (0.1, -0.01)), 0);
    let (state, bytes) = (fmu.state(), fmu.frozen());
    // These steps lift the carrier far above the profile.
    let first = states::three_steps(&fmu, 1e-5);
    assert_eq!(fmu.set_state(state), OK);
    assert_eq!(states::three_steps(&fmu, 1e-5), first);
    other.thaw(&bytes);
    assert_eq!(other.frozen(), bytes);
    assert_eq!(states::three_steps(&other, 1e-5), first);
    let layer = Fmu::running();
    assert_eq!(layer.deserialise(&bytes, &mut std::ptr::null_mut()), ERROR);
    for place in (0..bytes.len()).step_by(3) {
        let mut changed = bytes.clone();
        changed[place] ^= 1;
        assert_eq!(fmu.deserialise(&changed, &mut std::ptr::null_mut()), ERROR, "{place}");
    }
}

/// Sticking, F_x follows u with the stiffness; slipping, it does not. Every Real output has a derivative.
#[test]
fn directional_and_output_derivatives() {
    let fmu = pressed(2e5);
    let here = w(1e-4, 2e5);
    let derivative = |unknown: &str, by: (f64, f64)| {
        let mut value = [f64::NAN];
        assert_eq!(fmu.get_derivatives(&[fmu.reference(unknown)], &[0, 1], &[by.0, by.1], &mut value), OK);
        value[0]
    };
    assert_eq!(step(&fmu, (0.0, 1e-4), (0.0, here), (1e-4, 0.0)), 0);
    assert_relative("derivative", derivative("F_x", (2.0, 0.0)), -2.0 * stiffness(2e5), 1e-8);
    assert_eq!(derivative("F_z", (1.0, 0.0)), 0.0);
    let mut rates = [0.0; 2];
    assert_eq!(fmu.get_rates(&[fmu.reference("F_x"), fmu.reference("F_z")], &[1, 1], &mut rates), OK);
    assert_relative("rate", rates[0], -1e-4 * stiffness(2e5), 1e-8);
    assert_eq!(rates[1], 0.0);
    assert_eq!(step(&fmu, (1e-4, 10.0), (1e-8, here), (1e-4, 0.0)), 0);
    assert_eq!(derivative("F_x", (1.0, 0.0)), 0.0);
    let (coefficient, stiffness) = (fmu.real("friction.coefficient"), derivative("F_z", (0.0, 1.0)));
    assert!(stiffness < 0.0 && coefficient > 0.0);
    let outputs = fmu.variables.entries().filter(|(_, entry)| entry.is_calculated());
    for (_, entry) in outputs.filter(|(_, entry)| entry.kind == Kind::Real) {
        assert!(derivative(&entry.name, (1.0, 1.0)).is_finite());
    }
}

#[test]
fn its_mode_changes_are_logged() {
    let fmu = Fmu::of_table(&Grid::plain().text(), true);
    assert_eq!((fmu.setup(0.0), fmu.enter(), fmu.set_real("w", w(1e-4, 2e5)), fmu.exit()), (OK, OK, OK, OK));
    fmu.messages();
    assert_eq!(step(&fmu, (0.0, 100.0), (0.0, w(1e-4, 2e5)), (1e-4, 0.0)), 0);
    let messages = fmu.messages();
    assert_eq!((messages.len(), messages[0].category.as_str()), (1, "logEvents"), "{messages:?}");
    assert!(messages[0].text.ends_with("s: the contact from sticking to slipping forwards"), "{messages:?}");
}

/// Values alone: the first step stays at 0, the second, from where the first ends done again, comes to 2e-5 m, the third to
/// 3e-5 m.
#[test]
fn values_without_rates_are_extrapolated() {
    let fmu = pressed(2e5);
    let (here, h) = (w(1e-4, 2e5), 1e-3);
    let mut force = 0.0;
    let moved: [f64; 3] = [0.0, 2e-5, 1e-5];
    for (i, moved) in moved.into_iter().enumerate() {
        let at = 1e-5 * i as f64;
        assert_eq!((fmu.set_real("u", at), fmu.set_real("w", here), fmu.step(h * i as f64, h)), (OK, OK, OK));
        let stuck = fmu.real("F_x") - force;
        // At 0.02 m/s the stiffness is that of a higher pressure: the carrier is closer than where this one is borne.
        assert!((1.0..=2.5).contains(&(-stuck / (stiffness(2e5) * moved))) || (moved, stuck) == (0.0, 0.0), "{stuck}");
        force = fmu.real("F_x");
    }
}
