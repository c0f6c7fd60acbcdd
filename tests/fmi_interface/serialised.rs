//! FMU states as byte strings.

use std::path::PathBuf;
use std::{env, fs, ptr};

use asperity::fmi::*;

use crate::alone;
use crate::common::scratch;
use crate::lifecycle::STATES;
use crate::master::{ERROR, EVERYTHING, Fmu, OK, SCENE};
use crate::states::three_steps;

/// An instance in contact, with parameters set, a history and rates that wait for the next step.
fn lively() -> Fmu {
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
fn another_instance_goes_on_bit_for_bit() {
    let (first, second) = (lively(), Fmu::of(EVERYTHING, false));
    second.thaw(&first.frozen());
    assert_eq!((second.real("layer.mass"), second.real("u"), second.bits()), (1.5e-7, 1e-6, first.bits()));
    assert_eq!(three_steps(&second, 1e-5), three_steps(&first, 1e-5));
    assert_eq!(second.frozen(), first.frozen());
}

#[test]
fn another_process_goes_on_bit_for_bit() {
    let (fmu, folder) = (lively(), scratch("serialised"));
    fs::write(folder.join("state"), fmu.frozen()).unwrap();
    alone::run("serialised::the_other_process", &folder);
    let there = fs::read_to_string(folder.join("steps")).unwrap();
    assert_eq!(there, format!("{:x?}", three_steps(&fmu, 1e-5)));
}

#[test]
#[ignore = "run by another test, in a process of its own"]
fn the_other_process() {
    let Some(folder) = env::var_os(alone::FOLDER).map(PathBuf::from) else { return };
    let fmu = Fmu::of(EVERYTHING, false);
    fmu.thaw(&fs::read(folder.join("state")).unwrap());
    fs::write(folder.join("steps"), format!("{:x?}", three_steps(&fmu, 1e-5))).unwrap();
}

#[test]
fn a_state_of_any_place_in_the_lifecycle() {
    for (letter, reach) in STATES {
        let (fmu, other) = (reach(), Fmu::new());
        let bytes = fmu.frozen();
        other.thaw(&bytes);
        assert_eq!(other.frozen(), bytes, "{letter}");
        let name_of_state = |fmu: &Fmu| {
            fmu.messages();
            // Never allowed: the message names the state.
            // SAFETY: the instance lives.
            assert_eq!(unsafe { fmi2CancelStep(fmu.c) }, ERROR);
            fmu.message()
        };
        assert_eq!(name_of_state(&other), name_of_state(&fmu));
    }
}

#[test]
fn before_the_run_it_holds_what_was_set() {
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
fn cut_short_or_longer_it_is_refused() {
    let fmu = lively();
    let bytes = fmu.frozen();
    for length in (0..bytes.len()).step_by(7).chain([bytes.len() - 1]) {
        assert!(refused(&fmu, &bytes[..length]).contains("no FMU state"), "{length}");
    }
    refused(&fmu, &[&bytes[..], &[0]].concat());
    assert_eq!(fmu.frozen(), bytes);
}

#[test]
fn changed_in_any_byte_it_is_refused() {
    let fmu = lively();
    let bytes = fmu.frozen();
    for place in 0..bytes.len() {
        let mut changed = bytes.clone();
        changed[place] ^= 1 << (place % 8);
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
    assert!(refused(&fmu, &other.frozen()).contains("its scene or version is another one"));
    let mut later = fmu.frozen();
    later[8] += 1;
    assert!(refused(&fmu, &later).contains("its format is 5, expected 4"));
    assert!(refused(&fmu, b"PK").contains("does not begin like one"));
}

#[test]
fn places_and_sizes_that_do_not_fit_are_refused() {
    let fmu = Fmu::running();
    let state = fmu.state();
    let size = fmu.serialised(state).len();
    for wrong in [0, size - 1, size + 1] {
        assert_eq!(fmu.serialise(state, &mut vec![0; wrong]), ERROR);
        let text = fmu.message();
        assert!(text.contains(&size.to_string()) && text.contains(&wrong.to_string()), "{text}");
    }
    assert_eq!(fmu.serialise(ptr::null_mut(), &mut [0]), ERROR);
    assert!(fmu.message().contains("no FMU state of this instance"));
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
fn the_processor_time_is_no_part_of_the_state() {
    let fmu = Fmu::running_with(EVERYTHING);
    let state = fmu.state();
    assert_eq!((fmu.set_real("w", -1e-6), fmu.step(0.0, 1e-5)), (OK, OK));
    let spent = fmu.real("solver.run_time");
    assert!(spent > 0.0);
    assert_eq!((fmu.set_state(state), fmu.real("solver.run_time")), (OK, spent));
}
