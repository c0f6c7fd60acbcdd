//! Getting and setting variables.

use std::ptr;

use asperity_fmi::*;

use crate::common::assert_names;
use crate::fmu::fmi_interface::master::{ERROR, Fmu, OK};

#[test]
fn value_references_count_inputs_outputs_parameters() {
    let fmu = Fmu::new();
    let names: Vec<_> = fmu.variables.entries().map(|(_, entry)| entry.name.clone()).collect();
    assert_eq!(names[..4], ["u", "w", "F_x", "F_z"]);
    let references: Vec<_> = fmu.variables.entries().map(|(reference, _)| reference).collect();
    assert_eq!(references, (0..names.len() as u32).collect::<Vec<_>>());
    let first_parameter = fmu.variables.entries().filter(|(_, entry)| entry.is_calculated()).count() + 2;
    assert!(fmu.variables.entries().all(|(reference, entry)| {
        matches!(entry.role, Role::Parameter(_)) == (reference as usize >= first_parameter)
    }));
    assert_eq!(fmu.variables.entry(names.len() as u32), None);
    assert_eq!(fmu.variables.entry(u32::MAX), None);
}

#[test]
fn parameters_start_with_the_scenes_values_and_can_be_set_until_the_run() {
    let fmu = Fmu::new();
    let (mass, steps) = ("layer.mass", fmu.reference("solver.max_steps"));
    let rule = fmu.reference("input.extrapolation");
    assert_eq!(fmu.set_real(mass, 2e-7), OK);
    assert_eq!(fmu.enter(), OK);
    assert_eq!((fmu.real(mass), fmu.get_text(rule)), (2e-7, Ok("linear".into())));
    assert_eq!((fmu.set_integers(&[steps], &[99]), fmu.set_text(rule, "hold")), (OK, OK));
    assert_eq!(fmu.exit(), OK);
    assert_eq!(
        (fmu.set_real(mass, 3e-7), fmu.set_integers(&[steps], &[7]), fmu.set_text(rule, "linear")),
        (ERROR, ERROR, ERROR)
    );
    assert!(fmu.messages().iter().all(|message| message.text.contains("fixed parameter")));
    let mut value = [0];
    assert_eq!(fmu.get_integers(&[steps], &mut value), OK);
    assert_eq!((fmu.real(mass), value, fmu.get_text(rule)), (2e-7, [99], Ok("hold".into())));
    assert_eq!(fmu.step(0.0, 1e-7), OK);
}

#[test]
fn a_call_with_one_bad_value_sets_none() {
    let fmu = Fmu::initialising();
    let [u, mass, force] = ["u", "layer.mass", "F_x"].map(|name| fmu.reference(name));
    for (reference, value) in [(mass, -1.0), (mass, f64::NAN), (force, 1.0), (9999, 1.0)] {
        assert_eq!(fmu.set_reals(&[u, reference], &[5e-6, value]), ERROR, "{reference}");
        fmu.message();
        assert_eq!(fmu.real("u"), 0.0);
    }
    assert_eq!(fmu.set_reals(&[u, mass], &[5e-6, 2e-7]), OK);
    assert_eq!((fmu.real("u"), fmu.real("layer.mass")), (5e-6, 2e-7));
}

#[test]
fn types_are_kept_apart() {
    let fmu = Fmu::initialising();
    let [u, count, rule] = ["u", "contact.count", "input.extrapolation"].map(|name| fmu.reference(name));
    assert_eq!(fmu.get_integers(&[u], &mut [0]), ERROR);
    assert_names(fmu.message(), "reference 0 | Real | Integer");
    assert_eq!(fmu.get_reals(&[count], &mut [0.0]), ERROR);
    assert_eq!(fmu.get_integers(&[count], &mut [0]), OK);
    assert_eq!(
        (fmu.set_integers(&[u], &[1]), fmu.set_reals(&[rule], &[1.0]), fmu.set_text(u, "1")),
        (ERROR, ERROR, ERROR)
    );
    assert_eq!(fmu.get_text(u), Err(ERROR));
    // SAFETY: the instance and the values live.
    unsafe {
        assert_eq!(fmi2GetBoolean(fmu.c, &u, 1, &mut 0), ERROR);
        assert_eq!(fmi2SetBoolean(fmu.c, &u, 1, &0), ERROR);
    }
}

#[test]
fn a_refused_get_writes_nothing() {
    let fmu = Fmu::running();
    let mut values = [7.0, 7.0];
    assert_eq!(fmu.get_reals(&[0, 9999], &mut values), ERROR);
    assert!(fmu.message().contains("9999"));
    assert_eq!(values, [7.0, 7.0]);
}

#[test]
fn null_with_elements_is_an_error() {
    let fmu = Fmu::running();
    // SAFETY: NULL is what is tested.
    unsafe {
        assert_eq!(fmi2GetReal(fmu.c, ptr::null(), 1, &mut 0.0), ERROR);
        assert_eq!(fmi2GetReal(fmu.c, &0, 1, ptr::null_mut()), ERROR);
        assert_eq!(fmi2SetReal(fmu.c, &0, 1, ptr::null()), ERROR);
        assert_eq!(fmi2SetString(fmu.c, &fmu.reference("input.extrapolation"), 1, &ptr::null()), ERROR);
        assert_eq!(fmi2SetRealInputDerivatives(fmu.c, &0, 1, ptr::null(), &1.0), ERROR);
        assert_eq!(fmi2GetFMUstate(fmu.c, ptr::null_mut()), ERROR);
        assert_eq!(fmi2SetDebugLogging(fmu.c, 1, 1, ptr::null()), ERROR);
    }
    let messages = fmu.messages();
    assert_eq!(messages.len(), 7);
    assert!(messages.iter().all(|message| message.text.ends_with(" is NULL")), "{messages:?}");
}

#[test]
fn get_after_set_gives_inputs_as_set_and_outputs_as_they_were() {
    let fmu = Fmu::running();
    assert_eq!(fmu.step(0.0, 1e-7), OK);
    let before = [fmu.real("F_x"), fmu.real("F_z")];
    assert_eq!((fmu.set_real("u", 1e-6), fmu.set_real("w", -1e-6)), (OK, OK));
    assert_eq!((fmu.real("u"), fmu.real("w")), (1e-6, -1e-6));
    assert_eq!([fmu.real("F_x"), fmu.real("F_z")], before);
}

#[test]
fn reset_brings_back_what_instantiate_gave() {
    let fmu = Fmu::running();
    assert_eq!((fmu.set_real("u", 1e-6), fmu.set_rate("u", 1.0), fmu.step(0.0, 1e-7)), (OK, OK, OK));
    assert_eq!((fmu.reset(), fmu.set_real("layer.mass", 5e-7), fmu.reset()), (OK, OK, OK));
    assert_eq!((fmu.enter(), fmu.real("u"), fmu.real("layer.mass")), (OK, 0.0, 1e-7));
    assert_eq!((fmu.exit(), fmu.last_successful_time()), (OK, 0.0));
}

#[test]
fn in_initialisation_mode_outputs_follow_what_is_set() {
    let fmu = Fmu::initialising();
    let force = |w: f64, w_rate: f64| {
        assert_eq!((fmu.set_real("w", w), fmu.set_rate("w", w_rate)), (OK, OK));
        fmu.real("F_z")
    };
    // Masses over the valley and the crest of the wave, 1e-6 m high: 2e3 N/m for each one pressed, relaxed.
    for (w, expected) in [(1e-5, 0.0), (-1e-6, 2e3 * (1e-6 + 2e-6)), (-5e-6, 2e3 * (5e-6 + 6e-6))] {
        assert!((force(w, 0.0) - expected).abs() < 1e-15, "{w}");
    }
    // A carrier that comes down on masses that stand: two dampers more.
    assert!((force(-5e-6, -0.5) - 2e3 * 11e-6 - 2.0 * 8e-3 * 0.5).abs() < 1e-9);
    assert_eq!((fmu.set_real("layer.vertical.stiffness", 4e3), fmu.set_rate("w", 0.0)), (OK, OK));
    assert!((fmu.real("F_z") - 4e3 * 11e-6).abs() < 1e-15);
    assert_eq!(fmu.exit(), OK);
    assert!((fmu.real("F_z") - 4e3 * 11e-6).abs() < 1e-15);
}
