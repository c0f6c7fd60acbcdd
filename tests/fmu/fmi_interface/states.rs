//! FMU states: kept, restored, freed, and as byte strings.

use std::path::PathBuf;
use std::{env, fs, ptr};

use asperity_fmi::*;

use crate::common::{assert_names, scratch};
use crate::fmu::fmi_interface::lifecycle::STATES;
use crate::fmu::fmi_interface::many::{FOLDER, run_alone};
use crate::fmu::fmi_interface::master::{ERROR, EVERYTHING, Fmu, OK, SCENE};

/// Three steps with values and rates; the outputs after each.
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
fn a_state_can_be_overwritten_and_survives_a_reset() {
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
        assert!(fmu.message().contains("not an FMU state of this instance"));
    }
    assert_eq!((fmu.free_state(&mut foreign), fmu.get_state(&mut foreign)), (ERROR, ERROR));
    assert_eq!(other.set_state(foreign), OK);
    assert_eq!(fmu.step(0.0, 1e-7), OK);
}

/// Memory that is free again is used again, handles are not.
#[test]
fn the_handle_of_a_freed_state_is_refused_when_others_have_been_made() {
    let fmu = Fmu::running();
    let mut freed = Vec::new();
    for _ in 0..100 {
        let mut state = fmu.state();
        freed.push(state);
        assert_eq!(fmu.free_state(&mut state), OK);
    }
    let kept = fmu.state();
    for state in freed {
        assert_eq!(fmu.set_state(state), ERROR);
    }
    assert_eq!(fmu.set_state(kept), OK);
}

#[test]
fn many_states_can_be_kept() {
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

/// An instance in contact, with parameters set, past steps and rates for the next one.
fn in_contact() -> Fmu {
    let fmu = Fmu::initialising_with(EVERYTHING);
    assert_eq!((fmu.set_real("layer.mass", 1.5e-7), fmu.set_real("w", -1.5e-6)), (OK, OK));
    assert_eq!((fmu.set_rate("u", 0.1), fmu.exit(), fmu.step(0.0, 1e-5)), (OK, OK, OK));
    assert_eq!((fmu.set_real("u", 1e-6), fmu.set_rate("u", 0.2)), (OK, OK));
    fmu
}

fn refused(fmu: &Fmu, bytes: &[u8]) -> String {
    let untouched = ptr::without_provenance_mut(8);
    let mut state = untouched;
    assert_eq!(fmu.deserialise(bytes, &mut state), ERROR);
    assert_eq!(state, untouched);
    fmu.message()
}

#[test]
fn another_process_continues_bit_for_bit() {
    let (fmu, folder) = (in_contact(), scratch("serialised"));
    fs::write(folder.join("state"), fmu.frozen()).unwrap();
    run_alone("fmu::fmi_interface::states::the_other_process", &folder);
    let there = fs::read_to_string(folder.join("steps")).unwrap();
    assert_eq!(there, format!("{:x?}", three_steps(&fmu, 1e-5)));
}

#[test]
#[ignore = "run by another test, in a process of its own"]
fn the_other_process() {
    let Some(folder) = env::var_os(FOLDER).map(PathBuf::from) else { return };
    let fmu = Fmu::of(EVERYTHING, false);
    fmu.thaw(&fs::read(folder.join("state")).unwrap());
    fs::write(folder.join("steps"), format!("{:x?}", three_steps(&fmu, 1e-5))).unwrap();
}

#[test]
fn states_from_every_state_of_the_life_cycle() {
    for (letter, reach) in STATES {
        let (fmu, other) = (reach(), Fmu::new());
        let bytes = fmu.frozen();
        other.thaw(&bytes);
        assert_eq!(other.frozen(), bytes, "{letter}");
        let state_name = |fmu: &Fmu| {
            fmu.messages();
            // Never allowed: the message names the state.
            // SAFETY: the instance lives.
            assert_eq!(unsafe { fmi2CancelStep(fmu.c) }, ERROR);
            fmu.message()
        };
        assert_eq!(state_name(&other), state_name(&fmu));
    }
}

#[test]
fn before_the_run_a_state_holds_parameters_and_inputs() {
    let (first, second) = (Fmu::initialising(), Fmu::new());
    // The absolute tolerance follows the relative one until it is set itself.
    assert_eq!((first.set_real("solver.relative_tolerance", 1e-4), first.set_real("u", f64::NAN)), (OK, OK));
    assert_eq!((first.set_rate("w", -0.5), first.set_text(first.reference("input.extrapolation"), "hold")), (OK, OK));
    second.thaw(&first.frozen());
    assert!(second.real("u").is_nan());
    assert_eq!((first.set_real("u", 1e-6), second.set_real("u", 1e-6)), (OK, OK));
    assert_eq!(second.set_real("solver.relative_tolerance", 1e-5), OK);
    let fresh = Fmu::initialising();
    assert_eq!(fresh.set_real("solver.relative_tolerance", 1e-5), OK);
    let absolute = "solver.absolute_tolerance";
    assert_eq!(second.real(absolute), fresh.real(absolute));
    assert_eq!(first.set_real("solver.relative_tolerance", 1e-5), OK);
    assert_eq!((first.exit(), second.exit()), (OK, OK));
    assert_eq!((first.set_real("w", -2e-6), second.set_real("w", -2e-6)), (OK, OK));
    assert_eq!((first.step(0.0, 1e-5), second.step(0.0, 1e-5)), (OK, OK));
    assert_eq!(second.bits(), first.bits());
}

#[test]
fn a_string_of_another_length_is_refused() {
    let fmu = in_contact();
    let bytes = fmu.frozen();
    for length in (0..bytes.len()).step_by(7).chain([bytes.len() - 1]) {
        assert!(refused(&fmu, &bytes[..length]).contains("not an FMU state"), "{length}");
    }
    refused(&fmu, &[&bytes[..], &[0]].concat());
    assert_eq!(fmu.frozen(), bytes);
}

#[test]
fn a_string_changed_in_any_byte_is_refused() {
    let fmu = in_contact();
    let bytes = fmu.frozen();
    for index in 0..bytes.len() {
        let mut changed = bytes.clone();
        changed[index] ^= 1 << (index % 8);
        refused(&fmu, &changed);
    }
    assert_eq!(fmu.frozen(), bytes);
    let other = Fmu::of(EVERYTHING, false);
    other.thaw(&bytes);
    assert_eq!(three_steps(&fmu, 1e-5), three_steps(&other, 1e-5));
}

#[test]
fn another_scene_or_format_is_refused_and_named() {
    let fmu = Fmu::running();
    let other = Fmu::running_with(&SCENE.replace("coulomb = 0.3", "coulomb = 0.4"));
    assert_names(refused(&fmu, &other.frozen()), "another scene");
    let mut later = fmu.frozen();
    later[8] += 1;
    assert_names(refused(&fmu, &later), "14 | 13");
    assert!(refused(&fmu, b"PK").contains("does not begin like one"));
}

#[test]
fn wrong_pointers_and_sizes_are_refused() {
    let fmu = Fmu::running();
    let state = fmu.state();
    let size = fmu.serialised(state).len();
    for wrong in [0, size - 1, size + 1] {
        assert_eq!(fmu.serialise(state, &mut vec![0; wrong]), ERROR);
        let text = fmu.message();
        assert!(text.contains(&size.to_string()) && text.contains(&wrong.to_string()), "{text}");
    }
    assert_eq!(fmu.serialise(ptr::null_mut(), &mut [0]), ERROR);
    assert!(fmu.message().contains("not an FMU state of this instance"));
    // SAFETY: NULL is what is tested.
    unsafe {
        assert_eq!(fmi2SerializedFMUstateSize(fmu.c, state, ptr::null_mut()), ERROR);
        assert_eq!(fmi2SerializeFMUstate(fmu.c, state, ptr::null_mut(), size), ERROR);
        assert_eq!(fmi2DeSerializeFMUstate(fmu.c, ptr::null(), size, &mut ptr::null_mut()), ERROR);
        let bytes = fmu.serialised(state);
        assert_eq!(fmi2DeSerializeFMUstate(fmu.c, bytes.as_ptr().cast(), size, ptr::null_mut()), ERROR);
    }
    let messages = fmu.messages();
    assert!(messages.len() == 4 && messages.iter().all(|message| message.text.ends_with(" is NULL")), "{messages:?}");
}

#[test]
fn the_processor_time_is_not_part_of_the_state() {
    let fmu = Fmu::running_with(EVERYTHING);
    let state = fmu.state();
    assert_eq!((fmu.set_real("w", -1e-6), fmu.step(0.0, 1e-5)), (OK, OK));
    let spent = fmu.real("solver.run_time");
    assert!(spent > 0.0);
    assert_eq!((fmu.set_state(state), fmu.real("solver.run_time")), (OK, spent));
}
