//! Masters that give values alone: a step on extrapolated values is done again once the values at its end are known.

use std::f64::consts::PI;

use asperity::element::{FrictionTable, Node, Quantity};
use asperity::patch::COORDINATES;

use crate::common::sweeps::{Grid, REST, WARM, separation};
use crate::common::{assert_names, root};
use crate::fmu::fmi_interface::master::{DISCARD, EVERYTHING, Fmu, OK};

/// Twenty masses on a plane.
const FLAT: &str = r#"
name = "stop"
[layer]
masses = 20
spacing = 1.0e-4
mass = 1.0e-6
vertical = { stiffness = 1e3, damping = 1e-2 }
horizontal = { stiffness = 1e3, damping = 1e-2 }
[surface]
kind = "flat"
[friction]
coulomb = 0.5
[fmu]
outputs = ["forces", "dissipation", "solver"]
"#;

/// The inputs at a time, and their rates just after it.
type Motion = fn(f64) -> ([f64; 2], [f64; 2]);

#[derive(Clone, Copy, PartialEq)]
enum Given {
    Rates,
    Values,
}

/// A path along x, pressed by 10 µm within 5 ms.
fn pressed(time: f64, (u, u_rate): (f64, f64)) -> ([f64; 2], [f64; 2]) {
    let down = time < 5e-3 * (1.0 - 1e-9);
    ([u, -1e-5 * (time / 5e-3).min(1.0)], [u_rate, if down { -2e-3 } else { 0.0 }])
}

/// A way at straight legs, from corner to corner (s, m).
fn legs(time: f64, corners: &[(f64, f64)]) -> (f64, f64) {
    let late = time + 1e-9;
    match corners.windows(2).find(|leg| late < leg[1].0) {
        Some(leg) => {
            let rate = (leg[1].1 - leg[0].1) / (leg[1].0 - leg[0].0);
            (leg[0].1 + rate * (time - leg[0].0), rate)
        }
        None => (corners[corners.len() - 1].1, 0.0),
    }
}

fn slid_and_held(time: f64) -> ([f64; 2], [f64; 2]) {
    pressed(time, legs(time, &[(0.0, 0.0), (0.01, 0.0), (0.04, 3e-4)]))
}

fn to_and_fro_with_stops(time: f64) -> ([f64; 2], [f64; 2]) {
    let corners = [
        (0.0, 0.0),
        (0.01, 0.0),
        (0.02, 1e-4),
        (0.025, 1e-4),
        (0.04, -2e-4),
        (0.045, -2e-4),
        (0.047, -1.7e-4),
        (0.055, -1.7e-4),
    ];
    pressed(time, legs(time, &corners))
}

fn ramped(time: f64) -> ([f64; 2], [f64; 2]) {
    let ramp = (time - 0.01).clamp(0.0, 0.02);
    let over = (time - 0.03).clamp(0.0, 0.01);
    let u = 0.25 * ramp * ramp + 0.01 * over - 0.5 * over * over;
    let u_rate = 0.5 * ramp - over;
    pressed(time, (u, if time > 0.04 - 1e-9 { 0.0 } else { u_rate }))
}

/// Sets u and w as they are at a time.
fn give(fmu: &Fmu, motion: Motion, time: f64, given: Given) {
    let (values, rates) = motion(time);
    let names = ["u", "w"].map(|name| fmu.reference(name));
    assert_eq!(fmu.set_reals(&names, &values), OK);
    if given == Given::Rates {
        assert_eq!(fmu.set_rates(&names, &[1, 1], &rates), OK);
    }
}

/// Drives an instance to the time `end` (s) and returns it.
fn driven(text: &str, motion: Motion, (h, end): (f64, f64), given: Given) -> Fmu {
    let fmu = Fmu::initialising_with(text);
    give(&fmu, motion, 0.0, given);
    assert_eq!(fmu.exit(), OK);
    let steps = (end / h).round() as u32;
    for step in 0..steps {
        let time = h * f64::from(step);
        give(&fmu, motion, time, given);
        assert_eq!(fmu.step(time, h), OK, "{:?}", fmu.messages());
    }
    assert_eq!(fmu.messages(), []);
    fmu
}

fn repeated(fmu: &Fmu) -> i32 {
    let mut count = [-1];
    assert_eq!(fmu.get_integers(&[fmu.reference("solver.repeated")], &mut count), OK);
    count[0]
}

/// What sticks after a stop is what the carrier left there, not what the extrapolation overran.
#[test]
fn values_alone_give_the_forces_and_losses_of_rates() {
    for (name, motion) in [("held", slid_and_held as Motion), ("to and fro", to_and_fro_with_stops), ("ramped", ramped)]
    {
        for h in [1e-3, 5e-4, 1e-4] {
            // Where rates vary within steps, those of long steps are no better than the values.
            let fine = if name == "ramped" { 1e-5 } else { h };
            let rates = driven(FLAT, motion, (fine, 0.06), Given::Rates);
            let values = driven(FLAT, motion, (h, 0.06), Given::Values);
            for output in ["F_x", "F_z", "E_diss", "dissipation.E_friction"] {
                let (right, found) = (rates.real(output), values.real(output));
                assert!((found - right).abs() <= 0.02 * right.abs(), "{name}, {h}: {output} {found} for {right}");
            }
            assert_eq!(repeated(&rates), 0);
            assert!(name == "ramped" || repeated(&values) <= 10, "{name}, {h}: {}", repeated(&values));
        }
    }
    assert!((driven(FLAT, slid_and_held, (1e-3, 0.06), Given::Values).real("F_x") + 0.0949553).abs() < 1e-6);
}

#[test]
fn an_element_stops_where_its_carrier_does() {
    for h in [1e-3, 5e-4, 1e-4] {
        let force = |given| {
            let fmu = Fmu::of_table(&Grid::plain().text(), false);
            let w = separation(1e-4, 2e5, WARM) - REST;
            assert_eq!((fmu.setup(0.0), fmu.enter(), fmu.set_real("w", w), fmu.exit()), (OK, OK, OK, OK));
            for step in 0..(0.05 / h) as u32 {
                let time = h * f64::from(step);
                let (u, u_rate) = legs(time, &[(0.0, 0.0), (0.01, 0.0), (0.03, 2e-4)]);
                assert_eq!((fmu.set_real("u", u), fmu.set_real("w", w)), (OK, OK));
                if given == Given::Rates {
                    assert_eq!((fmu.set_rate("u", u_rate), fmu.set_rate("w", 0.0)), (OK, OK));
                }
                assert_eq!(fmu.step(time, h), OK);
            }
            (fmu.real("F_x"), fmu.real("E_diss"))
        };
        let (right, found) = (force(Given::Rates), force(Given::Values));
        assert!(right.0 < 0.0 && (found.0 - right.0).abs() < 1e-6 * right.0.abs(), "{h}: {found:?} for {right:?}");
        assert!((found.1 - right.1).abs() < 1e-6 * right.1, "{h}: {found:?} for {right:?}");
    }
}

const PAD: &str = "
name = 'pad'
table = { path = 'block.table.csv' }
patch = { shape = 'flat', length = 0.01, width = 0.01, nx = 5, ny = 4 }
fmu = { outputs = ['forces', 'dissipation'] }
";

fn pad() -> Fmu {
    Fmu::of_patch(PAD, &root().join("tests/reference/patch/block.table.csv"))
}

/// The pose of a pad that is pressed, dragged, turned and stopped, and its rates.
fn pose(fmu: &Fmu, time: f64) -> [(f64, f64); 6] {
    let still = (0.0, 0.0);
    let top = fmu.variables.entries().find(|(_, entry)| entry.name == "z").unwrap().1.start.clone();
    let Some(asperity::scene::Value::Real(top)) = top else { panic!("z has a start") };
    let down = legs(time, &[(0.0, top), (0.005, -1e-5)]);
    let x = legs(time, &[(0.0, 0.0), (0.01, 0.0), (0.03, 4e-4), (0.035, 4e-4), (0.045, 2e-4)]);
    [x, still, down, still, still, legs(time, &[(0.0, 0.0), (0.02, 0.0), (0.04, 0.01)])]
}

fn move_pad(fmu: &Fmu, time: f64, given: Given) {
    for (name, (value, rate)) in COORDINATES.into_iter().zip(pose(fmu, time)) {
        assert_eq!(fmu.set_real(name, value), OK);
        if given == Given::Rates {
            assert_eq!(fmu.set_rate(name, rate), OK);
        }
    }
}

#[test]
fn a_patch_stops_where_its_body_does() {
    for h in [1e-3, 5e-4, 1e-4] {
        let wrench = |given| {
            let fmu = pad();
            assert_eq!((fmu.setup(0.0), fmu.enter(), fmu.exit()), (OK, OK, OK));
            for step in 0..(0.055 / h) as u32 {
                let time = h * f64::from(step);
                move_pad(&fmu, time, given);
                assert_eq!(fmu.step(time, h), OK, "{:?}", fmu.messages());
            }
            ["force.x", "force.z", "moment.z", "E_diss"].map(|name| fmu.real(name))
        };
        let (right, found) = (wrench(Given::Rates), wrench(Given::Values));
        for (right, found) in right.into_iter().zip(found) {
            assert!(right != 0.0 && (found - right).abs() < 1e-6 * right.abs(), "{h}: {found} for {right}");
        }
    }
}

/// From the second step of a leg on what is extrapolated is what comes; at rest nothing is.
#[test]
fn a_constant_rate_is_never_repeated() {
    fn straight(time: f64) -> ([f64; 2], [f64; 2]) {
        ([0.01 * time, -1e-5 - 1e-4 * time], [0.01, -1e-4])
    }
    fn still(_: f64) -> ([f64; 2], [f64; 2]) {
        ([3e-4, -1e-5], [0.0, 0.0])
    }
    // The first step goes to the values at the start.
    assert_eq!(repeated(&driven(FLAT, straight, (1e-4, 0.02), Given::Values)), 1);
    assert_eq!(repeated(&driven(FLAT, still, (1e-4, 0.01), Given::Values)), 0);
    // Where it starts, stops and comes down.
    assert_eq!(repeated(&driven(FLAT, slid_and_held, (1e-3, 0.06), Given::Values)), 4);
}

/// Rates make a step final, for their own input alone.
#[test]
fn inputs_with_rates_are_not_repeated() {
    let fmu = Fmu::running_with(FLAT);
    let mut time = 0.0;
    let mut step = |u: f64, w: (f64, f64)| {
        assert_eq!((fmu.set_real("u", u), fmu.set_real("w", w.0), fmu.set_rate("w", w.1)), (OK, OK, OK));
        assert_eq!(fmu.step(time, 1e-3), OK);
        time += 1e-3;
        repeated(&fmu)
    };
    assert_eq!(step(0.0, (0.0, -2e-3)), 0);
    // Another place than the rate led to is a jump, as ever.
    assert_eq!(step(0.0, (-3e-6, -1e-3)), 0);
    assert_eq!(step(0.0, (-4e-6, 0.0)), 0);
    // Of u there is none.
    assert_eq!(step(1e-6, (-4e-6, 0.0)), 1);
    assert_eq!(step(2e-6, (-4e-6, 0.0)), 1);
    assert_eq!(step(2e-6, (-4e-6, 0.0)), 2);
}

#[test]
fn what_is_held_is_not_repeated() {
    let fmu = Fmu::initialising_with(FLAT);
    assert_eq!((fmu.set_text(fmu.reference("input.extrapolation"), "hold"), fmu.exit()), (OK, OK));
    for step in 0..20 {
        let time = 1e-3 * f64::from(step);
        give(&fmu, to_and_fro_with_stops, time, Given::Values);
        assert_eq!(fmu.step(time, 1e-3), OK);
    }
    assert_eq!(repeated(&fmu), 0);
}

/// Every mass sticks: springs, dampers and elements in place of contacts, so that orders are clean.
const STUCK: &str = r#"
name = "stuck"
[layer]
masses = 2
spacing = 1.0e-4
mass = 1.0e-7
clearance = -5e-6
vertical = { stiffness = 1e3, damping = 1e-2 }
horizontal = { stiffness = 1e3, damping = 30.0, maxwell = [{ stiffness = 2e3, relaxation_time = 2e-2 }] }
[surface]
kind = "flat"
[friction]
coulomb = 50.0
[solver]
relative_tolerance = 1e-10
[fmu]
outputs = ["forces", "solver"]
"#;

/// To and fro by a sine, then held.
fn waved(time: f64) -> ([f64; 2], [f64; 2]) {
    let phase = (2.0 * PI * 50.0 * time).min(2.4 * PI);
    let rate = if phase < 2.4 * PI { 1e-6 * 2.0 * PI * 50.0 * phase.cos() } else { 0.0 };
    ([1e-6 * phase.sin(), 0.0], [rate, 0.0])
}

/// F_x at the last point is a prediction whose speed is off by a share of h; what is kept of the history by one of h².
#[test]
fn the_last_step_is_of_first_order_and_the_history_of_second() {
    let moving = |h| driven(STUCK, waved, (h, 0.016), Given::Values).real("F_x");
    let held = |h| driven(STUCK, waved, (h, 0.032), Given::Values).real("F_x");
    let (right_moving, right_held) = (
        driven(STUCK, waved, (1e-5, 0.016), Given::Rates).real("F_x"),
        driven(STUCK, waved, (6.25e-6, 0.032), Given::Values).real("F_x"),
    );
    let errors = |force: &dyn Fn(f64) -> f64, right: f64| [1e-3, 5e-4, 2.5e-4].map(|h| (force(h) - right).abs());
    let (last, history) = (errors(&moving, right_moving), errors(&held, right_held));
    let order = |errors: [f64; 3]| (errors[0] / errors[2]).log2() / 2.0;
    assert!((0.7..1.5).contains(&order(last)), "{last:?}: order {}", order(last));
    assert!((1.7..2.5).contains(&order(history)), "{history:?}: order {}", order(history));
}

/// The values of an uneven motion at a step, and the steps' sizes.
fn uneven(step: u32) -> (f64, f64, f64) {
    let k = f64::from(step);
    (1e-6 * (0.9 * k).sin(), -2e-6 - 1e-6 * (0.5 * k).cos(), 1e-5 * (1.0 + 0.4 * (1.7 * k).sin()))
}

/// Does steps of different sizes from `from` on; the outputs after each.
fn uneven_steps(fmu: &Fmu, from: u32, to: u32) -> Vec<Vec<u64>> {
    let mut rows = Vec::new();
    for step in from..to {
        let (u, w, h) = uneven(step);
        assert_eq!((fmu.set_real("u", u), fmu.set_real("w", w)), (OK, OK));
        if step % 4 == 3 {
            assert_eq!(fmu.set_rate("w", 0.01), OK);
        }
        assert_eq!(fmu.step(fmu.last_successful_time(), h), OK, "{:?}", fmu.messages());
        rows.push(fmu.bits());
    }
    rows
}

/// A step that is discarded after the last one was done again leaves the prediction and what it was made from.
#[test]
fn a_discarded_step_leaves_the_prediction() {
    let text = EVERYTHING.replace("[fmu]", "[solver]\nmax_steps = 400\n[fmu]");
    let fmu = Fmu::running_with(&text);
    uneven_steps(&fmu, 0, 7);
    let (before, count) = (fmu.bits(), repeated(&fmu));
    let (u, w, _) = uneven(7);
    assert_eq!((fmu.set_real("u", u), fmu.set_real("w", w)), (OK, OK));
    // With rates there is nothing to hold in place of a prediction.
    assert_eq!((fmu.set_rate("u", 1e-2), fmu.set_rate("w", 0.0)), (OK, OK));
    assert_eq!(fmu.step(fmu.last_successful_time(), 10.0), DISCARD);
    assert_eq!((fmu.bits(), repeated(&fmu)), (before, count));
    let frozen = fmu.frozen();
    fmu.messages();
    let after = uneven_steps(&fmu, 7, 14);
    assert!(repeated(&fmu) > count);
    fmu.thaw(&frozen);
    assert_eq!(uneven_steps(&fmu, 7, 14), after);
}

/// The step from which it cannot be done again is named, the FMU stays, and other values go on.
#[test]
fn a_repetition_that_cannot_be_done_discards_the_step() {
    let fmu = pressed_element();
    assert_eq!(fmu.step(0.0, 1e-3), OK);
    let before = (fmu.bits(), fmu.frozen());
    let w = fmu.real("w");
    // Beyond the table at the end of the first step.
    assert_eq!((fmu.set_real("w", w - 1e-3), fmu.step(1e-3, 1e-3)), (OK, DISCARD));
    let text = fmu.message();
    assert!(text.contains("the step of 0.001 s from t = 0 s") && text.contains("cannot be done again"), "{text}");
    assert_eq!(fmu.bits(), before.0);
    assert_eq!((fmu.set_real("w", w + 1e-6), fmu.step(1e-3, 1e-3)), (OK, OK));
    let bits = fmu.bits();
    fmu.thaw(&before.1);
    assert_eq!((fmu.set_real("w", w + 1e-6), fmu.step(1e-3, 1e-3)), (OK, OK));
    assert_eq!(fmu.bits(), bits);
}

fn pressed_element() -> Fmu {
    let fmu = Fmu::of_table(&Grid::plain().text(), false);
    let w = separation(1e-4, 2e5, WARM) - REST;
    assert_eq!((fmu.setup(0.0), fmu.enter(), fmu.set_real("w", w), fmu.exit()), (OK, OK, OK, OK));
    fmu
}

#[test]
fn a_value_that_is_no_number_is_an_error_of_its_own_step() {
    let fmu = Fmu::running_with(FLAT);
    assert_eq!(fmu.step(0.0, 1e-3), OK);
    assert_eq!((fmu.set_real("u", 1e-6), fmu.set_real("w", f64::NAN)), (OK, OK));
    let before = fmu.bits();
    assert_ne!(fmu.step(1e-3, 1e-3), OK);
    assert_names(fmu.message(), "input w | NaN | t = 0.001 s");
    assert_eq!(fmu.bits(), before);
}

/// Mode changes of the step that is done again are told of again, after a word that it is.
#[test]
fn a_repetition_is_logged() {
    let fmu = Fmu::of(FLAT, true);
    assert_eq!((fmu.setup(0.0), fmu.enter(), fmu.exit()), (OK, OK, OK));
    for step in 0..13 {
        let time = 1e-3 * f64::from(step);
        give(&fmu, slid_and_held, time, Given::Values);
        assert_eq!(fmu.step(time, 1e-3), OK);
    }
    let said = |message: &&super::master::Message| {
        message.text.starts_with("t = 0.01") && message.text.contains("the step from here is done again")
    };
    let messages = fmu.messages();
    let categories: Vec<_> = messages.iter().filter(said).map(|message| message.category.as_str()).collect();
    assert_eq!(categories, ["logEvents", "logSolver"]);
}

/// A step that takes too much work with the one before, which would be done again, is discarded before that is done. Above the
/// ground little is to be done.
#[test]
fn the_work_of_a_call_is_that_of_both_steps() {
    let wheel = "
name = 'wheel'
table = { path = 'block.table.csv' }
patch = { shape = 'flat', length = 0.064, width = 0.064, nx = 64, ny = 64, transport = true }
fmu = { outputs = ['forces', 'tangent'] }
";
    let fmu = Fmu::of_patch(wheel, &root().join("tests/reference/patch/block.table.csv"));
    assert_eq!((fmu.setup(0.0), fmu.enter(), fmu.set_real("transport.speed", 1.0), fmu.exit()), (OK, OK, OK, OK));
    // A hundred cells of a millimetre: a substep each, of some 160 that a call may take.
    assert_eq!(fmu.step(0.0, 0.1), OK, "{:?}", fmu.messages());
    assert_eq!((fmu.set_real("x", 0.1), fmu.step(0.1, 0.1)), (OK, DISCARD));
    assert_names(fmu.message(), "the step from t = 0.1 s takes 20 | substeps or more: more than 1");
    assert_eq!((fmu.step(0.1, 0.02), fmu.messages().len()), (OK, 0));
}

/// An element whose prediction leaves its table is held where it is: masters that do a discarded step again would do so for
/// ever. The history is that of rates.
#[test]
fn a_prediction_that_cannot_be_done_is_held_and_said_once() {
    let [low, high] = [2e5, 5e5].map(|pressure| separation(1e-4, pressure, WARM) - REST);
    // Down within a step, as a signal that jumps; twice as far is beyond the table's 8e5 Pa.
    assert!(2.0 * high - low < separation(1e-4, 8e5, WARM) - REST);
    let course = [low, low, high, high, high, low, low, high, high];
    let pressed = |given| {
        let fmu = Fmu::of_table(&Grid::plain().text(), false);
        assert_eq!(fmu.set_text(fmu.reference("table.extrapolation"), "refuse"), OK);
        assert_eq!((fmu.setup(0.0), fmu.enter(), fmu.set_real("w", low), fmu.exit()), (OK, OK, OK, OK));
        for (step, w) in (0..).zip(course.windows(2)) {
            assert_eq!(fmu.set_real("w", w[0]), OK);
            if given == Given::Rates {
                assert_eq!((fmu.set_rate("u", 0.0), fmu.set_rate("w", (w[1] - w[0]) / 1e-3)), (OK, OK));
            }
            assert_eq!(fmu.step(1e-3 * f64::from(step), 1e-3), OK);
        }
        fmu
    };
    let (rates, values) = (pressed(Given::Rates), pressed(Given::Values));
    for output in ["F_z", "E_diss"] {
        let (right, found) = (rates.real(output), values.real(output));
        assert!((found - right).abs() <= 1e-9 * right.abs(), "{output} {found} for {right}");
    }
    assert_eq!(rates.messages(), []);
    assert_names(values.message(), "t = 0.003 s: the inputs were held over the step | said once a run");
}

/// New values every millisecond, five steps each: with the interval the course is that of straight lines through them, a
/// millisecond later; without it each is a jump, which is warned of.
#[test]
fn an_interval_has_seldom_values_gone_to_over_it() {
    let driven_by = |interval: f64| {
        let fmu = Fmu::initialising_with(FLAT);
        assert_eq!((fmu.set_real("input.interval", interval), fmu.exit()), (OK, OK));
        for step in 0..5 * 65 {
            give(&fmu, slid_and_held, 1e-3 * f64::from(step / 5), Given::Values);
            assert_eq!(fmu.step(2e-4 * f64::from(step), 2e-4), OK);
        }
        fmu
    };
    let (right, found, jumped) =
        (driven(FLAT, slid_and_held, (1e-3, 0.06), Given::Rates), driven_by(1e-3), driven_by(0.0));
    for output in ["F_x", "F_z", "E_diss"] {
        let (right, found) = (right.real(output), found.real(output));
        // Of the solver's tolerance, 1e-6 a step.
        assert!((found - right).abs() <= 1e-4 * right.abs(), "{output} {found} for {right}");
    }
    assert_eq!((found.messages(), repeated(&found)), (vec![], 0));
    // Five times the speed within a fifth of the time: the dampers lose more.
    assert!(jumped.real("E_diss") > 1.02 * right.real("E_diss"), "{}", jumped.real("E_diss"));
    assert_names(jumped.message(), "new values of | input.interval = 0.001 has it gone to over that time");
}

/// Masters that set nothing: the FMU initialises at its start values and touches nothing.
#[test]
fn start_values_initialise() {
    let warm = Grid { temperatures: vec![290.0, 300.0, 310.0], ..Grid::plain() };
    let elements = [Grid::plain().text(), warm.text()].map(|table| (Fmu::of_table(&table, false), "F_x", "F_z"));
    for (fmu, along, across) in elements.into_iter().chain([(pad(), "force.x", "force.z")]) {
        assert_eq!((fmu.setup(0.0), fmu.enter(), fmu.exit()), (OK, OK, OK), "{:?}", fmu.messages());
        assert_eq!((fmu.real(along), fmu.real(across)), (0.0, 0.0));
        for step in 0..10 {
            assert_eq!(fmu.step(1e-3 * f64::from(step), 1e-3), OK);
        }
        assert_eq!(fmu.real(across), 0.0);
    }
    // So does a patch, which starts no higher above its table than the table goes.
    let table = FrictionTable::load(&root().join("tests/reference/patch/block.table.csv")).unwrap();
    let (shape, count) = (table.grid.clone(), table.grid.count());
    let (speeds, loads) = (shape.speeds.len(), shape.loads.len());
    let node = |i: usize| Node { temperature: i / (speeds * loads), load: i / speeds % loads, speed: i % speeds };
    let separations = (0..count).map(|i| table.value(Quantity::Separation, node(i)));
    let (closest, farthest) =
        separations.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), s| (s.min(low), s.max(high)));
    let fmu = pad();
    assert_eq!((fmu.setup(0.0), fmu.enter()), (OK, OK));
    let z = fmu.real("z");
    assert!(z > farthest && z < 2.0 * farthest - closest, "{z}: {farthest} to {closest}");
    assert_eq!((fmu.set_real("z", closest), fmu.exit()), (OK, OK));
    assert!(fmu.real("force.z") > 0.0);
    // A little lower it bears.
    let fmu = Fmu::of_table(&Grid::plain().text(), false);
    assert_eq!(fmu.enter(), OK);
    let w = fmu.real("w");
    let range = separation(1e-4, 1e5, WARM) - separation(1e-4, 8e5, WARM);
    assert_eq!((fmu.set_real("w", w - 1.2 * range), fmu.exit()), (OK, OK), "{:?}", fmu.messages());
    assert!(fmu.real("F_z") > 0.0);
}
