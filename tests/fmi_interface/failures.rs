//! Runs that fail on purpose: the status, the message and the state after it.

use crate::master::{DISCARD, ERROR, EVERYTHING, Fmu, Message, OK};

/// What a failed step may not change: outputs and time.
fn seen(fmu: &Fmu) -> (Vec<u64>, f64) {
    (fmu.bits(), fmu.last_successful_time())
}

fn one_message(fmu: &Fmu, category: &str, parts: &[&str]) {
    let messages = fmu.messages();
    let [Message { category: found, text, .. }] = &messages[..] else { panic!("{messages:?}") };
    assert_eq!(found, category);
    assert!(text.starts_with("fmi2DoStep: ") && parts.iter().all(|part| text.contains(part)), "{text}");
}

/// An instance whose steps may do `work`, after a first short one.
fn started(work: i32) -> Fmu {
    let fmu = Fmu::initialising_with(EVERYTHING);
    assert_eq!(fmu.set_integers(&[fmu.reference("solver.max_steps")], &[work]), OK);
    assert_eq!((fmu.set_real("w", -1.5e-6), fmu.exit(), fmu.step(0.0, 1e-10)), (OK, OK, OK));
    fmu
}

/// Both go on alike.
fn go_on_alike(fmu: &Fmu, other: &Fmu) {
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
    go_on_alike(&fmu, &untried);
}

#[test]
fn an_input_that_is_no_number_is_an_error_and_a_state_leads_out_of_it() {
    let (fmu, untried) = (started(100), started(100));
    let (state, before) = (fmu.state(), fmu.bits());
    assert_eq!((fmu.set_real("u", f64::NAN), fmu.step(1e-10, 1e-10)), (OK, ERROR));
    one_message(&fmu, "logStatusError", &["the input u is NaN at t = 0.0000000001 s: no step can be done"]);
    assert_eq!(fmu.bits(), before);
    assert_eq!(fmu.step(1e-10, 1e-10), ERROR);
    one_message(&fmu, "logStatusError", &["not allowed in the state error"]);
    assert_eq!(fmu.set_state(state), OK);
    go_on_alike(&fmu, &untried);
}

#[test]
fn a_rate_that_is_no_number_is_an_error_too() {
    let fmu = started(100);
    assert_eq!((fmu.set_rate("w", f64::INFINITY), fmu.step(1e-10, 1e-10)), (OK, ERROR));
    one_message(&fmu, "logStatusError", &["the input w is inf"]);
}

/// Huge steps end, with numbers or with a reason.
#[test]
fn a_huge_step_is_done_or_discarded_and_never_endless() {
    for (h, rate) in [(1e3, 1e-2), (1e3, 0.0), (1e300, 0.0), (1e-4, 1e9), (1e9, -1e3)] {
        let (fmu, untried) = (started(300), started(300));
        let before = seen(&fmu);
        assert_eq!(fmu.set_rate("u", rate), OK);
        match fmu.step(1e-10, h) {
            OK => assert!(fmu.bits().iter().all(|&bits| f64::from_bits(bits).is_finite())),
            DISCARD => {
                one_message(&fmu, "logStatusDiscard", &[" s"]);
                assert_eq!(seen(&fmu), before);
                go_on_alike(&fmu, &untried);
            }
            status => panic!("{status} for a step of {h} s at {rate} m/s"),
        }
    }
}

/// Where the carrier would go beyond what numbers hold, no smaller step of any use can help.
#[test]
fn a_step_beyond_all_numbers_is_an_error() {
    let fmu = started(300);
    assert_eq!((fmu.set_rate("u", 1e200), fmu.step(1e-10, 1e200)), (OK, ERROR));
    one_message(&fmu, "logStatusError", &["the input u is inf"]);
}
