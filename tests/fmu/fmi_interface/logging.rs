//! Messages to the master's logger.

use std::ffi::CStr;

use crate::fmu::fmi_interface::master::{ERROR, Fmu, Message, OK, SCENE};

#[test]
fn messages_escape_format_characters() {
    let fmu = Fmu::new();
    let reference = fmu.reference("layer.initial");
    assert_eq!(fmu.set_text(reference, "100%s"), ERROR);
    let text = fmu.message();
    assert!(text.contains("100%%s"), "{text}");
}

#[test]
fn a_message_has_its_instance_status_and_category() {
    let fmu = Fmu::new();
    assert_eq!(fmu.exit(), ERROR);
    let expected = Message {
        instance: "a name".into(),
        status: ERROR,
        category: "logStatusError".into(),
        text: "fmi2ExitInitializationMode: not allowed in the state instantiated".into(),
    };
    assert_eq!(fmu.messages(), [expected]);
}

#[test]
fn work_is_logged_only_when_selected() {
    let fmu = Fmu::running();
    assert_eq!(fmu.step(0.0, 1e-7), OK);
    assert_eq!(fmu.messages(), []);
    assert_eq!(fmu.set_debug_logging(true, &[c"logSolver"]), OK);
    assert_eq!(fmu.step(1e-7, 1e-7), OK);
    let messages = fmu.messages();
    assert_eq!((messages.len(), messages[0].status, messages[0].category.as_str()), (1, OK, "logSolver"));
    assert_eq!(fmu.set_debug_logging(false, &[]), OK);
    assert_eq!(fmu.step(2e-7, 1e-7), OK);
    assert_eq!(fmu.messages(), []);
}

#[test]
fn an_unknown_category_is_refused() {
    let fmu = Fmu::new();
    assert_eq!(fmu.set_debug_logging(true, &[c"logEvents", c"logNone"]), ERROR);
    assert!(fmu.message().contains("logNone"));
}

#[test]
fn a_reset_restores_the_logging_of_the_instantiation() {
    let fmu = Fmu::of(SCENE, true);
    assert_eq!(fmu.set_debug_logging(false, &[]), OK);
    assert_eq!(fmu.reset(), OK);
    fmu.messages();
    assert_eq!((fmu.enter(), fmu.exit(), fmu.step(0.0, 1e-7)), (OK, OK, OK));
    assert!(fmu.messages().iter().any(|message| message.category == "logSolver"));
}

#[test]
fn mode_changes_are_logged_only_when_selected() {
    let lift = |categories: &[&CStr]| {
        let fmu = Fmu::initialising();
        assert_eq!((fmu.set_real("w", -5e-6), fmu.exit()), (OK, OK));
        assert_eq!(fmu.set_debug_logging(!categories.is_empty(), categories), OK);
        assert_eq!((fmu.set_real("w", 5e-5), fmu.step(0.0, 1e-3)), (OK, OK));
        fmu.messages()
    };
    assert_eq!(lift(&[]), []);
    let messages = lift(&[c"logEvents"]);
    assert!(messages.iter().all(|message| message.category == "logEvents" && message.status == OK));
    assert!(messages.iter().any(|message| message.text.ends_with(" to free")), "{messages:?}");
}

/// The carrier drags the rough layer fast: there are many mode changes per step, and the method auto logs its switch to
/// time-stepping.
#[test]
fn a_method_switch_of_auto_is_logged_with_the_work() {
    let drag = |method: &str| {
        let fmu = Fmu::of(&SCENE.replace("masses = 2", "masses = 60"), false);
        let reference = fmu.reference("solver.method");
        assert_eq!(fmu.set_text(reference, method), OK);
        assert_eq!(fmu.set_real("solver.relative_tolerance", 1e-2), OK);
        assert_eq!((fmu.enter(), fmu.set_real("w", -3e-7), fmu.set_rate("u", 5.0), fmu.exit()), (OK, OK, OK, OK));
        assert_eq!(fmu.set_debug_logging(true, &[c"logSolver"]), OK);
        for i in 0..40 {
            let point = 1e-5 * f64::from(i);
            assert_eq!((fmu.set_real("u", 5.0 * (point + 1e-5)), fmu.set_rate("u", 5.0)), (OK, OK));
            assert_eq!(fmu.step(point, 1e-5), OK);
        }
        let switched = |message: &Message| message.text.contains("time-stepping from here on");
        fmu.messages().iter().filter(|message| switched(message)).count()
    };
    assert_eq!((drag("event"), drag("step")), (0, 0));
    assert!(drag("auto") > 0);
}
