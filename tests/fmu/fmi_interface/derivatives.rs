//! Derivatives of outputs: by the inputs at constant states, and by time.

use std::ptr;

use asperity_fmi::{fmi2GetDirectionalDerivative, fmi2GetRealOutputDerivatives};

use crate::fmu::fmi_interface::master::{DISCARD, ERROR, EVERYTHING, Fmu, OK};

/// c + Σ c_j of the vertical and the horizontal links of [`EVERYTHING`], N/m.
const STIFFNESS: (f64, f64) = (3e3, 1.5e3);

fn derivative(fmu: &Fmu, unknown: &str, by: (f64, f64)) -> f64 {
    let mut value = [f64::NAN];
    let status = fmu.get_derivatives(&[fmu.reference(unknown)], &[0, 1], &[by.0, by.1], &mut value);
    assert_eq!(status, OK, "{unknown}");
    value[0]
}

#[test]
fn those_of_the_forces_are_the_stiffness_of_the_links() {
    let close = |found: f64, expected: f64| assert!((found / expected - 1.0).abs() < 1e-14, "{found} {expected}");
    let check = |fmu: &Fmu| {
        close(derivative(fmu, "F_x", (1.0, 0.5)), -3.0 * STIFFNESS.1);
        close(derivative(fmu, "F_z", (0.5, 2.0)), -6.0 * STIFFNESS.0);
        assert_eq!((derivative(fmu, "F_x", (0.0, 1.0)), derivative(fmu, "F_z", (1.0, 0.0))), (0.0, 0.0));
    };
    let fmu = Fmu::initialising_with(EVERYTHING);
    assert_eq!(fmu.set_real("w", -1e-6), OK);
    check(&fmu);
    assert_eq!((fmu.set_real("layer.horizontal.stiffness", 2e3), fmu.set_real("u", 1e-6)), (OK, OK));
    close(derivative(&fmu, "F_x", (1.0, 0.0)), -3.0 * 2.5e3);
    assert_eq!((fmu.set_real("layer.horizontal.stiffness", 1e3), fmu.exit()), (OK, OK));
    check(&fmu);
    assert_eq!((fmu.step(0.0, 1e-5), fmu.terminate()), (OK, OK));
    check(&fmu);
}

#[test]
fn knowns_are_inputs_and_unknowns_real_outputs_and_a_refused_call_writes_nothing() {
    let fmu = Fmu::running_with(EVERYTHING);
    let [force, mass, count, element] =
        ["F_x", "layer.mass", "contact.count", "element[1].F_N"].map(|name| fmu.reference(name));
    for (unknown, known, by, expected) in [
        (0, 0, 1.0, "u is not an output"),
        (mass, 0, 1.0, "layer.mass is not an output"),
        (element, 0, 1.0, "element[1].F_N is not an output"),
        (count, 0, 1.0, "contact.count (value reference"),
        (force, mass, 1.0, "layer.mass is not an input"),
        (force, force, 1.0, "F_x is not an input"),
        (force, 9999, 1.0, "9999"),
        (9999, 0, 1.0, "9999"),
        (force, 0, f64::NAN, "dvKnown is NaN"),
    ] {
        let mut values = [7.0, 7.0];
        assert_eq!(fmu.get_derivatives(&[force, unknown], &[known], &[by], &mut values), ERROR);
        let text = fmu.message();
        assert!(text.contains(expected), "{text}");
        assert_eq!(values, [7.0, 7.0]);
    }
    let mut values = [7.0];
    assert_eq!((fmu.get_derivatives(&[force], &[], &[], &mut values), values), (OK, [0.0]));
    assert_eq!((fmu.get_derivatives(&[force], &[0, 0], &[1.0, -1.0], &mut values), values[0]), (OK, 0.0));
    // SAFETY: NULL is what is tested.
    unsafe {
        let (c, null, value) = (fmu.c, ptr::null(), values.as_mut_ptr());
        assert_eq!(fmi2GetDirectionalDerivative(c, null, 1, &0, 1, &1.0, value), ERROR);
        assert_eq!(fmi2GetDirectionalDerivative(c, &force, 1, null, 1, &1.0, value), ERROR);
        assert_eq!(fmi2GetDirectionalDerivative(c, &force, 1, &0, 1, ptr::null(), value), ERROR);
        assert_eq!(fmi2GetDirectionalDerivative(c, &force, 1, &0, 1, &1.0, ptr::null_mut()), ERROR);
        assert_eq!(fmi2GetRealOutputDerivatives(c, null, 1, &1, value), ERROR);
        assert_eq!(fmi2GetRealOutputDerivatives(c, &force, 1, ptr::null(), value), ERROR);
        assert_eq!(fmi2GetRealOutputDerivatives(c, &force, 1, &1, ptr::null_mut()), ERROR);
    }
    let messages = fmu.messages();
    assert!(messages.len() == 7 && messages.iter().all(|message| message.text.ends_with(" is NULL")), "{messages:?}");
}

/// Ḟ_x and Ḟ_z.
fn rates(fmu: &Fmu) -> [f64; 2] {
    let mut values = [f64::NAN; 2];
    let forces = ["F_x", "F_z"].map(|name| fmu.reference(name));
    assert_eq!(fmu.get_rates(&forces, &[1, 1], &mut values), OK);
    values
}

#[test]
fn output_derivatives_before_the_first_step_are_those_of_the_starting_velocity() {
    let fmu = Fmu::initialising_with(EVERYTHING);
    assert_eq!((fmu.set_real("w", -1e-5), fmu.set_rate("w", -1.0), fmu.exit()), (OK, OK, OK));
    let found = rates(&fmu);
    let (h, before) = (1e-11, fmu.real("F_z"));
    assert_eq!((fmu.step(0.0, h), rates(&fmu)[1] > 0.0), (OK, true));
    let quotient = (fmu.real("F_z") - before) / h;
    assert!((found[1] / quotient - 1.0).abs() < 1e-3, "{} {quotient}", found[1]);
}

#[test]
fn only_first_derivatives_of_the_forces_exist() {
    let fmu = Fmu::running_with(EVERYTHING);
    let [force, power] = ["F_x", "P_diss"].map(|name| fmu.reference(name));
    for (reference, order, expected) in [
        (force, 2, "the derivative of F_x is of order 2"),
        (force, 0, "order 0"),
        (power, 1, "P_diss has no derivative by time"),
        (0, 1, "u has no derivative by time"),
        (9999, 1, "9999"),
    ] {
        let mut values = [7.0, 7.0];
        assert_eq!(fmu.get_rates(&[force, reference], &[1, order], &mut values), ERROR);
        let text = fmu.message();
        assert!(text.contains(expected), "{text}");
        assert_eq!(values, [7.0, 7.0]);
    }
}

/// After a discarded step they are those at the end of the step before.
#[test]
fn a_discarded_step_leaves_the_derivatives_as_they_were() {
    let fmu = Fmu::initialising_with(EVERYTHING);
    assert_eq!(fmu.set_integers(&[fmu.reference("solver.max_steps")], &[20]), OK);
    assert_eq!((fmu.set_real("w", -1e-6), fmu.set_rate("u", 0.1), fmu.exit(), fmu.step(0.0, 1e-7)), (OK, OK, OK, OK));
    let before = (rates(&fmu), derivative(&fmu, "P_diss", (1.0, 1.0)));
    assert_eq!((fmu.set_rate("u", 5.0), fmu.step(1e-7, 1.0)), (OK, DISCARD));
    assert_eq!((rates(&fmu), derivative(&fmu, "P_diss", (1.0, 1.0))), before);
}
