//! FMU states: kept, gone back to, freed.

use std::ptr;

use crate::master::{ERROR, Fmu, OK};

/// Three steps with values and rates, and what came out.
pub fn three_steps(fmu: &Fmu, start: f64) -> Vec<Vec<u64>> {
    let step = |i: i32| {
        let time = start + f64::from(i) * 1e-5;
        assert_eq!(fmu.set_real("w", -2e-6 - f64::from(i) * 1e-6), OK);
        assert_eq!(fmu.step(time, 1e-5), OK);
        [fmu.bits(), vec![fmu.last_successful_time().to_bits()]].concat()
    };
    (0..3).map(step).collect()
}

#[test]
fn the_same_steps_from_a_restored_state_give_the_same() {
    let fmu = Fmu::running();
    assert_eq!((fmu.set_rate("u", 0.1), fmu.step(0.0, 1e-5)), (OK, OK));
    assert_eq!(fmu.set_rate("u", 0.2), OK);
    let state = fmu.state();
    let first = three_steps(&fmu, 1e-5);
    for _ in 0..2 {
        assert_eq!(fmu.set_state(state), OK);
        assert_eq!(three_steps(&fmu, 1e-5), first);
    }
}

#[test]
fn a_state_holds_parameters_inputs_and_lifecycle() {
    let fmu = Fmu::initialising();
    assert_eq!((fmu.set_real("layer.mass", 2e-7), fmu.set_real("u", 3e-6)), (OK, OK));
    let state = fmu.state();
    assert_eq!((fmu.set_real("layer.mass", 1e-7), fmu.set_real("u", 0.0), fmu.exit()), (OK, OK, OK));
    assert_eq!((fmu.step(0.0, 1e-7), fmu.terminate()), (OK, OK));
    assert_eq!(fmu.set_state(state), OK);
    assert_eq!((fmu.real("layer.mass"), fmu.real("u"), fmu.exit()), (2e-7, 3e-6, OK));
}

#[test]
fn a_state_may_be_written_anew_and_survives_a_reset() {
    let fmu = Fmu::running();
    let mut state = fmu.state();
    let address = state;
    assert_eq!((fmu.step(0.0, 1e-7), fmu.get_state(&mut state)), (OK, OK));
    assert_eq!(state, address);
    assert_eq!((fmu.reset(), fmu.set_state(state)), (OK, OK));
    assert_eq!(fmu.last_successful_time(), 1e-7);
}

#[test]
fn freed_and_foreign_states_are_refused() {
    let (fmu, other) = (Fmu::running(), Fmu::running());
    let mut state = fmu.state();
    let freed = state;
    assert_eq!(fmu.free_state(&mut state), OK);
    assert!(state.is_null());
    let mut foreign = other.state();
    for bad in [freed, ptr::null_mut(), foreign, ptr::without_provenance_mut(8)] {
        assert_eq!(fmu.set_state(bad), ERROR);
        assert!(fmu.message().contains("no FMU state of this instance"));
    }
    assert_eq!((fmu.free_state(&mut foreign), fmu.get_state(&mut foreign)), (ERROR, ERROR));
    assert_eq!(other.set_state(foreign), OK);
    assert_eq!(fmu.step(0.0, 1e-7), OK);
}

#[test]
fn any_number_of_states_are_alive() {
    let fmu = Fmu::running();
    let keep = |i: i32| {
        assert_eq!(fmu.step(f64::from(i) * 1e-7, 1e-7), OK);
        (fmu.state(), fmu.last_successful_time())
    };
    let states: Vec<_> = (0..100).map(keep).collect();
    for (mut state, time) in states.into_iter().rev() {
        assert_eq!(fmu.set_state(state), OK);
        assert_eq!(fmu.last_successful_time(), time);
        assert_eq!(fmu.free_state(&mut state), OK);
    }
}
