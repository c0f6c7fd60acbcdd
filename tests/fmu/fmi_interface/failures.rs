//! Steps that fail: the status, the message and the state after it.

use asperity_fmi::{Kind, Role, VariableRef};

use crate::common::assert_names;
use crate::fmu::fmi_interface::master::{DISCARD, ERROR, EVERYTHING, Fmu, Message, OK};

/// The outputs and the time, which a failed step must not change.
fn seen(fmu: &Fmu) -> (Vec<u64>, f64) {
    (fmu.bits(), fmu.last_successful_time())
}

fn one_message(fmu: &Fmu, category: &str, parts: &[&str]) {
    let messages = fmu.messages();
    let [Message { category: found, text, .. }] = &messages[..] else { panic!("{messages:?}") };
    assert_eq!(found, category);
    assert!(text.starts_with("fmi2DoStep: ") && parts.iter().all(|part| text.contains(part)), "{text}");
}

/// An instance with `solver.max_steps` = `work`, after a first short step.
fn started(work: i32) -> Fmu {
    let fmu = Fmu::initialising_with(EVERYTHING);
    assert_eq!(fmu.set_integers(&[fmu.reference("solver.max_steps")], &[work]), OK);
    assert_eq!((fmu.set_real("w", -1.5e-6), fmu.exit(), fmu.step(0.0, 1e-10)), (OK, OK, OK));
    fmu
}

/// Both continue alike.
fn continue_alike(fmu: &Fmu, other: &Fmu) {
    for i in 1..10 {
        let step = |fmu: &Fmu| (fmu.set_rate("u", 0.1), fmu.step(f64::from(i) * 1e-10, 1e-10));
        assert_eq!((step(fmu), step(other)), ((OK, OK), (OK, OK)));
        assert_eq!(seen(fmu), seen(other));
    }
}

#[test]
fn a_step_with_too_much_work_is_discarded_and_a_smaller_one_is_done() {
    let (fmu, untried) = (started(1), started(1));
    let before = seen(&fmu);
    for _ in 0..3 {
        assert_eq!((fmu.set_rate("u", 0.1), fmu.step(1e-10, 1e-3)), (OK, DISCARD));
        one_message(&fmu, "logStatusDiscard", &["gave up at t = ", "after 1 steps, the limit solver.max_steps"]);
        assert_eq!((seen(&fmu), fmu.last_step()), (before.clone(), (OK, DISCARD)));
    }
    continue_alike(&fmu, &untried);
}

#[test]
fn an_input_that_is_not_a_number_is_an_error_until_a_state_is_restored() {
    let (fmu, untried) = (started(100), started(100));
    let (state, before) = (fmu.state(), fmu.bits());
    assert_eq!((fmu.set_real("u", f64::NAN), fmu.step(1e-10, 1e-10)), (OK, ERROR));
    one_message(
        &fmu,
        "logStatusError",
        &["the input u is NaN at t = 0.0000000001 s, which is out of range; the step was not done"],
    );
    assert_eq!(fmu.bits(), before);
    assert_eq!(fmu.step(1e-10, 1e-10), ERROR);
    one_message(&fmu, "logStatusError", &["not allowed in the state error"]);
    assert_eq!(fmu.set_state(state), OK);
    continue_alike(&fmu, &untried);
}

#[test]
fn a_rate_that_is_not_a_number_is_an_error() {
    let fmu = started(100);
    assert_eq!((fmu.set_rate("w", f64::INFINITY), fmu.step(1e-10, 1e-10)), (OK, ERROR));
    one_message(&fmu, "logStatusError", &["the input w is inf"]);
}

#[test]
fn a_huge_step_is_done_or_discarded_with_limited_work() {
    for (h, rate) in [(1e3, 1e-2), (1e3, 0.0), (1e30, 0.0), (1e-4, 1e9), (1e9, -1e3)] {
        let (fmu, untried) = (started(300), started(300));
        let before = seen(&fmu);
        assert_eq!(fmu.set_rate("u", rate), OK);
        match fmu.step(1e-10, h) {
            OK => assert!(fmu.bits().iter().all(|&bits| f64::from_bits(bits).is_finite())),
            DISCARD => {
                one_message(&fmu, "logStatusDiscard", &[]);
                assert_eq!(seen(&fmu), before);
                continue_alike(&fmu, &untried);
            }
            status => panic!("{status} for a step of {h} s at {rate} m/s"),
        }
    }
}

/// Where the carrier would leave the range of displacements, no smaller step would help.
#[test]
fn a_step_out_of_range_is_an_error() {
    let fmu = started(300);
    assert_eq!((fmu.set_rate("u", 1e200), fmu.step(1e-10, 1e-3)), (OK, ERROR));
    one_message(&fmu, "logStatusError", &["the input u is 1e197 at t = "]);
    let fmu = started(300);
    let w = fmu.real("w");
    // Beyond what rounding leaves of the profile, where the step before would be done again to it; within it a rate is too
    // large.
    assert_eq!((fmu.set_real("w", 1e20), fmu.step(1e-10, 1e-12)), (OK, DISCARD));
    one_message(
        &fmu,
        "logStatusDiscard",
        &[
            "cannot be done again to the values that came: the input w goes to 1e20 m, where rounding is coarser than the profile",
        ],
    );
    assert_eq!((fmu.set_real("w", w), fmu.set_rate("w", 1e31), fmu.step(1e-10, 1e-24)), (OK, OK, ERROR));
    one_message(&fmu, "logStatusError", &["the carrier's motion is out of range: rate of w = "]);
}

#[test]
fn times_and_steps_out_of_range_are_refused_and_change_nothing() {
    let fmu = started(300);
    let before = seen(&fmu);
    for h in [1e31, 1e300, -1e-9, f64::NAN, f64::INFINITY] {
        assert_eq!(fmu.step(1e-10, h), ERROR);
        one_message(
            &fmu,
            "logStatusError",
            &["the communication step size is ", "expected 0 or a number from 1e-30 to 1e30"],
        );
        assert_eq!((seen(&fmu), fmu.last_step()), (before.clone(), (OK, OK)));
    }
    // Over so short a step the stiffness of a damper overflows: the tangents would be infinite.
    let fmu = Fmu::running_with(EVERYTHING);
    assert_eq!(fmu.step(0.0, f64::MIN_POSITIVE), ERROR);
    one_message(&fmu, "logStatusError", &["the communication step size is 2.2250738585072014e-308 s"]);
    assert_eq!(fmu.step(0.0, 1e-30), OK);
    fmu.bits();
    let fmu = Fmu::new();
    assert_eq!(fmu.setup(1e300), ERROR);
    assert_names(fmu.message(), "start | 1e300 | ±1e30");
}

/// Every number at both ends of its range, steps of all sizes: done with finite outputs, or refused without a change.
#[test]
fn at_the_limits_of_all_ranges_a_step_has_finite_outputs_or_changes_nothing() {
    let is_real = |entry: &VariableRef| matches!(entry.role, Role::Parameter(_)) && entry.kind == Kind::Real;
    let fmu = Fmu::of(EVERYTHING, false);
    let parameters: Vec<u32> =
        fmu.variables.entries().filter(|(_, entry)| is_real(entry)).map(|(reference, _)| reference).collect();
    let mut done = 0;
    for (&parameter, end) in parameters.iter().flat_map(|parameter| [1e-30, 1e30].map(|end| (parameter, end))) {
        for value in [0.0, -1e-6, 1e30, -1e30] {
            let fmu = Fmu::initialising_with(EVERYTHING);
            assert_eq!(fmu.set_integers(&[fmu.reference("solver.max_steps")], &[20]), OK);
            fmu.set_reals(&[parameter], &[end]);
            assert_eq!((fmu.set_real("u", value), fmu.set_real("w", value), fmu.exit()), (OK, OK, OK));
            for h in [1e-30, 1e-9, 1e-3, 1e30] {
                done += usize::from(finite_or_unchanged(&fmu, h));
            }
        }
    }
    // Most need more than twenty steps; those that are done show that the others are not refused for another reason.
    assert!(done > parameters.len(), "{done} steps done with {} parameters", parameters.len());
}

/// Whether a step is done; `bits` fails where an output is no finite number.
fn finite_or_unchanged(fmu: &Fmu, h: f64) -> bool {
    let before = seen(fmu);
    let status = fmu.step(fmu.last_successful_time(), h);
    match status {
        OK => drop(fmu.bits()),
        _ => assert_eq!(fmu.bits(), before.0, "{:?}", fmu.messages()),
    }
    status == OK
}
