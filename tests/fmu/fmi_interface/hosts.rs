//! What hosts do that the standard does not have, and what they are short of.

#[cfg(target_arch = "x86_64")]
use std::arch::asm;

use asperity_fmi::Kind;
use asperity_fmi::bindings::fmi2Status;

use crate::common::root;
use crate::fmu::fmi_interface::master::{DISCARD, ERROR, EVERYTHING, Fmu, OK, SCENE};

#[test]
fn a_tolerance_of_0_is_none_and_one_that_is_too_loose_is_the_loosest() {
    for (tolerance, expected) in [(0.0, 1e-6), (0.5, 0.1), (1e3, 0.1)] {
        let fmu = Fmu::new();
        assert_eq!((fmu.setup_all(Some(tolerance), 0.0, None), fmu.enter()), (OK, OK));
        assert_eq!(fmu.messages().len(), 1, "a warning");
        assert_eq!(fmu.real("solver.relative_tolerance"), expected);
    }
}

#[test]
fn derivatives_of_other_orders_are_left_out_and_warned_of_once() {
    let (fmu, plain) = (Fmu::running(), Fmu::running());
    let u = fmu.reference("u");
    assert_eq!(fmu.set_rates(&[u, u, u], &[0, 1, 2], &[7.0, 0.1, 9.0]), OK);
    assert!(fmu.message().contains("order 2"));
    assert_eq!(fmu.set_rates(&[u], &[3], &[9.0]), OK);
    assert_eq!(fmu.messages(), []);
    assert_eq!((plain.set_rate("u", 0.1), plain.step(0.0, 1e-6), fmu.step(0.0, 1e-6)), (OK, OK, OK));
    assert_eq!(fmu.bits(), plain.bits());
    assert_eq!(fmu.set_rates(&[fmu.reference("F_x")], &[2], &[1.0]), ERROR);
}

#[test]
fn a_clock_in_single_precision_is_followed() {
    let fmu = Fmu::running();
    let h = 1e-7_f32;
    for i in 0..1000_u16 {
        assert_eq!(fmu.step(f64::from(f32::from(i) * h), f64::from(h)), OK, "{i}");
    }
    // A point that is off by a part of the step is none.
    let time = fmu.last_successful_time();
    assert_eq!(fmu.step(time + 1e-9, 1e-7), ERROR);
}

#[test]
fn all_categories_have_a_name() {
    let fmu = Fmu::running();
    assert_eq!((fmu.set_debug_logging(true, &[c"logAll"]), fmu.step(0.0, 1e-6)), (OK, OK));
    assert!(fmu.messages().iter().any(|message| message.category == "logSolver"));
}

#[test]
fn outputs_that_are_whole_numbers_are_reals_on_request() {
    let fmu = Fmu::running_with(&SCENE.replace("[fmu]", "[fmu]\nintegers = \"real\""));
    let counts = fmu.variables.entries().filter(|(_, entry)| entry.name == "contact.count");
    assert!(counts.map(|(_, entry)| entry.kind).eq([Kind::Real]));
    assert_eq!((fmu.set_real("w", -1e-5), fmu.step(0.0, 1e-5)), (OK, OK));
    assert_eq!(fmu.real("contact.count"), 2.0);
    assert_eq!(fmu.get_integers(&[fmu.reference("contact.count")], &mut [0]), ERROR);
    let table = root().join("tests/reference/patch/block.table.csv");
    let patch = "name = \"pad\"\ntable = { path = \"block.table.csv\" }\n[patch]\nshape = \"flat\"\nlength = 0.01\n\
                 width = 0.01\nnx = 1\nny = 1\n[fmu]\noutputs = [\"contact\"]\nintegers = \"real\"";
    let fmu = Fmu::of_patch(patch, &table);
    assert_eq!((fmu.setup(0.0), fmu.enter(), fmu.exit()), (OK, OK, OK));
    assert_eq!(fmu.real("contact.count"), 0.0);
}

/// Where rounding is coarser than the profile, a step would have no end.
#[test]
fn a_displacement_beyond_rounding_is_discarded_at_once() {
    for name in ["u", "w"] {
        let fmu = Fmu::running();
        assert_eq!((fmu.set_real(name, 1e12), fmu.step(0.0, 1e-6)), (OK, DISCARD));
        assert!(fmu.message().contains(name));
        assert_eq!((fmu.set_real(name, 0.0), fmu.step(0.0, 1e-6)), (OK, OK));
    }
}

/// MXCSR with INVALID, DIVBYZERO and OVERFLOW unmasked; rounding up, down and to zero; with subnormals flushed to zero.
#[cfg(target_arch = "x86_64")]
const ENVIRONMENTS: [u32; 5] = [0x1900, 0x5f80, 0x3f80, 0x7f80, 0x9fc0];

/// Sets MXCSR; returns what it was.
#[cfg(target_arch = "x86_64")]
fn exchange(environment: u32) -> u32 {
    let mut before = 0_u32;
    // SAFETY: the caller puts back what it was, and computes no floating-point numbers before.
    unsafe {
        asm!("stmxcsr [{}]", in(reg) &mut before, options(nostack));
        asm!("ldmxcsr [{}]", in(reg) &environment, options(nostack));
    }
    before
}

/// A run with impacts and all outputs; each call in the host's `environment`, which it must leave as it is.
#[cfg(target_arch = "x86_64")]
fn bits_in(environment: u32) -> Vec<u64> {
    let fmu = Fmu::initialising_with(EVERYTHING);
    let call = |call: &dyn Fn() -> fmi2Status| {
        let before = exchange(environment);
        let status = call();
        let after = exchange(before);
        assert_eq!((status, after), (OK, environment));
    };
    call(&|| fmu.set_real("w", -3e-6));
    call(&|| fmu.exit());
    for time in [0.0, 1e-5, 2e-5] {
        call(&|| fmu.set_rate("u", 0.3));
        call(&|| fmu.step(time, 1e-5));
    }
    let mut values = [0.0; 4];
    let references: Vec<u32> = (2..6).collect();
    let before = exchange(environment);
    let status = fmu.get_reals(&references, &mut values);
    let after = exchange(before);
    assert_eq!((status, after), (OK, environment));
    values.map(f64::to_bits).to_vec()
}

#[cfg(target_arch = "x86_64")]
#[test]
fn the_hosts_floating_point_environment_changes_nothing_and_stays() {
    let usual = bits_in(0x1f80);
    for environment in ENVIRONMENTS {
        assert_eq!(bits_in(environment), usual, "{environment:x}");
    }
}

/// A thread of a host may have a stack of 64 KiB, as small as any system's.
#[test]
fn a_stack_of_64_kib_is_enough() {
    let run = || {
        let fmu = Fmu::running_with(EVERYTHING);
        assert_eq!((fmu.set_real("w", -3e-6), fmu.step(0.0, 1e-5)), (OK, OK));
        let state = fmu.state();
        assert_eq!(fmu.set_state(state), OK);
    };
    let thread = std::thread::Builder::new().stack_size(64 << 10).spawn(run).unwrap();
    thread.join().unwrap();
}

#[cfg(target_os = "linux")]
mod memory {
    use std::process::Command;

    use crate::fmu::fmi_interface::instantiation::asked;
    use crate::fmu::fmi_interface::master::{Folder, SCENE};

    /// What each of the tests below runs in a process of its own.
    const LIMITED: &str = "ASPERITY_TEST_LIMITED";

    /// Runs the test `name` again where the process may have so much more memory, MiB.
    fn limited(name: &str, mebibytes: usize) {
        let program = std::env::current_exe().unwrap();
        let script = format!("ulimit -v {}; exec \"$0\" --exact {name}", mebibytes << 10);
        let output = Command::new("sh").args(["-c", &script]).arg(program).env(LIMITED, "1").output().unwrap();
        let text = String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success() && text.contains("1 passed"), "{:?}: {text}", output.status);
    }

    /// A layer of 10 000 000 masses takes some 20 GB; instantiation says so, and the process lives on.
    #[test]
    fn an_instance_that_the_system_has_no_memory_for_is_refused() {
        const NAME: &str =
            "fmu::fmi_interface::hosts::memory::an_instance_that_the_system_has_no_memory_for_is_refused";
        if std::env::var_os(LIMITED).is_none() {
            return limited(NAME, 2048);
        }
        let folder = Folder::with_scene("", &SCENE.replace("masses = 2", "masses = 10000000"));
        let (is_made, messages) = asked(&folder, "{}", |_| ());
        assert!(!is_made);
        assert!(messages.len() == 1 && messages[0].text.contains("MiB of memory"), "{messages:?}");
    }
}
