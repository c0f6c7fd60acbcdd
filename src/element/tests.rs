//! Elements of a known law.

#[path = "../../tests/common/sweeps.rs"]
#[allow(unreachable_pub, dead_code, reason = "shared with the tests of the program")]
mod sweeps;

use std::path::Path;

use super::*;
use crate::in_tests::assert_relative;
use crate::model::Mode;
use crate::outputs::{Output, variable};
use crate::scene::{Parameter, Value};
use crate::simulation::Start;
use sweeps::{AREA, Grid, REST, WARM, friction, logarithmic, separation, stiffness};

fn table(grid: &Grid) -> FrictionTable {
    FrictionTable::parse(&grid.text(), Path::new("table.csv")).unwrap()
}

fn contact() -> PointContact {
    PointContact::new(table(&Grid::plain()))
}

/// An element pressed at rest to `pressure` (Pa).
fn pressed(pressure: f64) -> Element {
    at_w(&contact(), separation(1e-4, pressure, WARM) - REST)
}

fn at_w(contact: &PointContact, w: f64) -> Element {
    Element::new(contact, &Start { w, ..Start::default() }).unwrap()
}

fn get(element: &Element, output: Output) -> f64 {
    let mut value = [f64::NAN];
    element.evaluate(&[variable(output).unwrap()], &mut value);
    value[0]
}

fn forces(element: &Element) -> (f64, f64) {
    (get(element, Output::ForceX), get(element, Output::ForceZ))
}

/// V = G²/(2K).
fn stored(element: &Element) -> f64 {
    let spring = &element.spring;
    if spring.stiffness > 0.0 { spring.force * spring.force / (2.0 * spring.stiffness) } else { 0.0 }
}

#[test]
fn at_the_points_of_the_table_it_is_the_table() {
    for p in Grid::plain().pressures {
        for v in Grid::plain().speeds {
            let w = separation(v, p, WARM) - REST;
            let mut element = Element::new(&contact(), &Start { w, u_rate: v, ..Start::default() }).unwrap();
            element.advance(1e-2 / v, v, 0.0).unwrap();
            let (x, z) = forces(&element);
            // The separations are summed up from differences, 1e-16 m of a fall of 6e-6 m.
            assert_relative(z, p * AREA, 1e-9);
            assert_relative(x, -friction(v, p, WARM) * p * AREA, 1e-9);
            assert_relative(element.spring.stiffness, stiffness(p), 1e-9);
            assert_relative(get(&element, Output::DissipatedPower), -x * v, 1e-12);
            assert_relative(get(&element, Output::Hysteresis), 0.4 * x, 1e-9);
            assert_relative(get(&element, Output::Adhesion), 0.6 * x, 1e-9);
            assert_relative(get(&element, Output::ContactRatio), 0.1 * (p / 1e5).powf(0.8), 1e-9);
        }
    }
}

/// A grid twice as fine has errors four times smaller at least: the friction coefficient has a hump.
#[test]
fn between_the_points_the_error_falls_as_the_grid_gets_finer() {
    let error = |parts: usize| {
        let (speeds, pressures) = (logarithmic(1e-3, 10.0, 4 * parts + 1), logarithmic(1e5, 8e5, 2 * parts + 1));
        let grid = Grid { speeds, pressures, temperatures: Vec::new() };
        let contact = PointContact::new(table(&grid));
        let mut largest = [0.0_f64; 2];
        for v in logarithmic(1.1e-3, 9.0, 61) {
            for p in logarithmic(1.1e5, 7.3e5, 23) {
                let w = separation(v, p, WARM) - REST;
                let mut element = Element::new(&contact, &Start { w, u_rate: v, ..Start::default() }).unwrap();
                element.advance(1.0, v, 0.0).unwrap();
                let (x, z) = forces(&element);
                largest[0] = largest[0].max((z / (p * AREA) - 1.0).abs());
                largest[1] = largest[1].max((-x / z / friction(v, p, WARM) - 1.0).abs());
            }
        }
        largest
    };
    let (coarse, fine) = (error(3), error(6));
    assert!(coarse[0] < 0.01 && coarse[1] < 0.05, "{coarse:?}");
    assert!(fine[0] < coarse[0] / 3.9 && fine[1] < coarse[1] / 3.9, "{coarse:?} {fine:?}");
}

#[test]
fn between_temperatures_it_is_the_law_in_between() {
    let temperatures = [280.0, 290.0, 300.0, 310.0, 320.0].to_vec();
    let mut contact = PointContact::new(table(&Grid { temperatures, ..Grid::plain() }));
    assert_eq!(contact.parameter(Parameter::TEMPERATURE), Value::Real(300.0));
    for t in [283.0, 305.0, 320.0] {
        contact.set_parameter(Parameter::TEMPERATURE, Value::Real(t)).unwrap();
        let (v, p) = (0.1, 3e5);
        let w = separation(v, p, t) - REST;
        let mut element = Element::new(&contact, &Start { w, u_rate: v, ..Start::default() }).unwrap();
        element.advance(1.0, v, 0.0).unwrap();
        let (x, z) = forces(&element);
        // Steps of 10 K are half a decade of speed, and the hump is a decade and a half wide.
        assert_relative(-x / z, friction(v, p, t), 0.02);
        assert_relative(z, p * AREA, 0.01);
    }
    let refused = contact.set_parameter(Parameter::TEMPERATURE, Value::Real(279.0)).unwrap_err().to_string();
    let expected =
        "material.wlf.temperature = 279.0: expected a number from 280.0 to 320.0, the temperatures of the table";
    assert_eq!(refused, expected);
}

/// At every speed the force rises as the carrier comes down, from nothing on, without a jump.
#[test]
fn the_force_rises_as_the_carrier_comes_down() {
    for v in logarithmic(1e-5, 10.0, 37) {
        let curve_of = |w: f64| {
            Element::new(&contact(), &Start { w, u_rate: v, ..Start::default() }).map(|element| forces(&element).1)
        };
        let (mut before, mut w) = (0.0, 2e-5);
        let mut steps = 0;
        while let Ok(force) = curve_of(w) {
            assert!(force >= before && force - before < 0.03 * 8e5 * AREA, "{v} {w}: {force} after {before}");
            (before, w, steps) = (force, w - 1e-7, steps + 1);
        }
        assert!(before > 0.97 * 8e5 * AREA && steps > 200, "{v}: {before}");
    }
}

/// Dragged to and fro at a constant height: slope K after each reversal, plateaus at ±μF_z, the area lost.
#[test]
fn a_hysteresis_loop_is_that_of_a_jenkins_element() {
    let (v, amplitude, p) = (1e-3, 2e-3, 2e5);
    let mut element = at_w(&contact(), separation(v, p, WARM) - REST);
    let (k, limit) = (stiffness(p), friction(v, p, WARM) * p * AREA);
    let go = |element: &mut Element, distance: f64| {
        element.advance(distance.abs() / v, distance.signum() * v, 0.0).unwrap();
        -forces(element).0
    };
    // At rest the law is that of the least speed; at v the spring starts afresh, as it holds nothing.
    assert_relative(go(&mut element, 1e-5), k * 1e-5, 1e-9);
    assert_relative(go(&mut element, amplitude), limit, 1e-9);
    let start = get(&element, Output::DissipatedEnergy);
    assert_relative(go(&mut element, -1e-5), limit - k * 1e-5, 1e-9);
    assert_relative(go(&mut element, 1e-5 - amplitude), -limit, 1e-9);
    assert_relative(go(&mut element, amplitude), limit, 1e-9);
    let lost = get(&element, Output::DissipatedEnergy) - start;
    assert_relative(lost, 2.0 * limit * (amplitude - 2.0 * limit / k), 1e-9);
    let channels = [Output::DamperEnergy, Output::MaxwellEnergy, Output::FrictionEnergy].map(|of| get(&element, of));
    channels
        .iter()
        .zip([0.1, 0.3, 0.6])
        .for_each(|(found, share)| assert_relative(*found, share * (start + lost), 1e-9));
}

/// Straight motions that press, lift, reverse, rest, leave the contact and come back.
const MOTIONS: [(f64, f64, f64); 11] = [
    (2e-2, 0.05, 0.0),
    (1e-2, 0.02, -2e-4),
    (5e-2, -0.05, -2e-5),
    (1e-2, 0.0, 2e-4),
    (2e-2, -0.01, 1e-4),
    (1e-2, 0.3, 6e-4),
    (4e-2, 0.01, 1e-3),
    (3e-2, -0.02, -1.5e-3),
    (1e-2, 3e-5, -2e-4),
    (1e-2, 0.1, -1e-4),
    (1e-2, 0.0, 0.0),
];

fn go(element: &mut Element, (duration, u_rate, w_rate): (f64, f64, f64), parts: &[f64]) {
    let sum: f64 = parts.iter().sum();
    parts.iter().for_each(|part| element.advance(duration * part / sum, u_rate, w_rate).unwrap());
}

/// The end of a motion does not depend on its division into steps.
#[test]
fn steps_may_be_split() {
    let (mut whole, mut split) = (pressed(2e5), pressed(2e5));
    for motion in MOTIONS {
        go(&mut whole, motion, &[1.0]);
        go(&mut split, motion, &[0.13, 0.4, 0.01, 0.29, 1.0, 0.07]);
        let scale = (whole.contact().limit.value, 1e-5);
        let (a, b) = (forces(&whole), forces(&split));
        // Rounding, and what of the limit over half a segment is no polynomial.
        assert!(
            (a.0 - b.0).abs() <= 1e-9 * (scale.0 + 1.0) && (a.1 - b.1).abs() <= 1e-9 * a.1,
            "{motion:?} {a:?} {b:?}"
        );
        let lost = |element: &Element| get(element, Output::DissipatedEnergy);
        assert!((lost(&whole) - lost(&split)).abs() <= 1e-9 * scale.1, "{motion:?} {} {}", lost(&whole), lost(&split));
        assert_eq!(whole.spring.mode, split.spring.mode, "{motion:?}");
    }
}

/// ∫ -F_x du = V + E_diss, with the work summed up from the forces in many small steps.
#[test]
fn the_work_along_x_is_stored_or_lost() {
    const PARTS: usize = 4000;
    let mut element = pressed(2e5);
    let mut modes = Vec::new();
    for motion in MOTIONS {
        let (before, lost) = (stored(&element), get(&element, Output::DissipatedEnergy));
        // The law changes with the speed at once; after that the force has no jump.
        go(&mut element, (0.0, motion.1, motion.2), &[1.0]);
        let mut work = 0.0;
        for _ in 0..PARTS {
            let start = forces(&element).0;
            let power = get(&element, Output::DissipatedPower);
            assert!(power >= -1e-12, "{motion:?}: {power}");
            go(&mut element, (motion.0 / PARTS as f64, motion.1, motion.2), &[1.0]);
            work -= (start + forces(&element).0) / 2.0 * motion.0 * motion.1 / PARTS as f64;
            modes.push(element.spring.mode);
        }
        let gained = stored(&element) - before + get(&element, Output::DissipatedEnergy) - lost;
        // The trapezium rule's error, most of it in the parts in which stick turns to slip.
        assert!((work - gained).abs() <= 1e-6 * work.abs() + 1e-12, "{motion:?}: {work} {gained}");
    }
    for mode in [Mode::Free, Mode::Stick, Mode::Forward, Mode::Backward] {
        assert!(modes.contains(&mode), "{mode:?}");
    }
}

/// Powers, rates of the forces and of the power against difference quotients along every motion.
#[test]
fn derivatives_are_those_of_difference_quotients() {
    let outputs =
        [Output::ForceX, Output::ForceZ, Output::DissipatedPower, Output::Hysteresis, Output::FrictionCoefficient];
    let variables = outputs.map(|output| variable(output).unwrap());
    let mut element = pressed(2e5);
    let mut compared = 0;
    for motion in MOTIONS {
        for _ in 0..7 {
            go(&mut element, (motion.0 / 7.0, motion.1, motion.2), &[1.0]);
            let h = 1e-7;
            let mut after = element.clone();
            go(&mut after, (h, motion.1, motion.2), &[1.0]);
            let mut later = after.clone();
            go(&mut later, (h, motion.1, motion.2), &[1.0]);
            if element.spring.mode != later.spring.mode {
                continue;
            }
            compared += 1;
            let mut found = [0.0; 5];
            after.directional_derivative(&variables, (motion.1, motion.2), &mut found);
            assert_eq!(after.force_rates(), (found[0], found[1]));
            let lost = get(&later, Output::DissipatedEnergy) - get(&element, Output::DissipatedEnergy);
            let power = get(&after, Output::DissipatedPower);
            assert!((power - lost / (2.0 * h)).abs() <= 1e-6 * power.abs() + 1e-9, "{motion:?}: {power} {lost}");
            for (i, output) in outputs.into_iter().enumerate() {
                let (from, to) = (get(&element, output), get(&later, output));
                let quotient = (to - from) / (2.0 * h);
                // The curvature of y leaps at the points of the table; roundings over 2h.
                let allowed = 1e-3 * quotient.abs() + 1e-13 * (from.abs() + 1.0) / h;
                assert!((found[i] - quotient).abs() <= allowed, "{motion:?} {output:?}: {} {quotient}", found[i]);
            }
        }
    }
    assert!(compared > 60, "{compared}");
}

#[test]
fn beyond_the_table_motions_are_refused_or_extrapolated() {
    let mut contact = contact();
    let mut element = at_w(&contact, separation(1e-4, 1e5, WARM) - REST);
    let before = element.save();
    let fast = element.advance(1e-6, -10.1, 0.0).unwrap_err();
    assert!(fast.to_string().contains("10.1 m/s") && fast.to_string().contains("from 0.0001 to 10 m/s"), "{fast}");
    let deep = element.advance(1.0, 0.0, -2e-5).unwrap_err();
    assert!(matches!(deep, ElementError::Pressure { within: true, .. }));
    assert!(deep.to_string().contains("800000 Pa") && deep.to_string().contains("table.extrapolation"), "{deep}");
    assert_eq!((element.save(), element.advance(1e-3, 10.0, 0.0)), (before, Ok(())));
    // At the same height as slow, faster is closer to the layer: its pressure is beyond at once.
    let mut low = at_w(&contact, separation(1e-4, 7.9e5, WARM) - REST);
    assert!(matches!(low.advance(1e-3, 10.0, 0.0), Err(ElementError::Pressure { within: false, .. })));

    contact.set_parameter(Parameter::TABLE_EXTRAPOLATION, Value::Text("hold".into())).unwrap();
    let far = Element::new(&contact, &Start { w: 1e31, ..Start::default() }).unwrap_err();
    assert_eq!(far.to_string(), "the carrier's motion is out of range: w = 1e31, expected a number up to ±1e30");
    for (duration, rates) in [(1e30, (2.0, 0.0)), (1e-3, (0.0, f64::NAN)), (f64::INFINITY, (0.0, 0.0))] {
        assert!(matches!(element.advance(duration, rates.0, rates.1), Err(ElementError::OutOfRange(_))));
    }
    let w = separation(10.0, 8e5, WARM) - REST;
    let mut held = Element::new(&contact, &Start { w, u_rate: 10.0, ..Start::default() }).unwrap();
    let slope = held.contact().normal.slope;
    held.advance(1.0, 100.0, -1e-5).unwrap();
    let (x, z) = forces(&held);
    assert_relative(z, 8e5 * AREA + slope * 1e-5, 1e-12);
    assert_relative(-x, friction(10.0, 8e5, WARM) * z, 1e-9);
    assert_relative(held.spring.stiffness, stiffness(8e5), 1e-9);
}

/// Through standstill the law is that of the least speed, without a jump.
#[test]
fn below_the_least_speed_the_law_is_that_of_the_least() {
    let element = |v: f64| {
        let w = separation(1e-4, 3e5, WARM) - REST;
        let mut element = Element::new(&contact(), &Start { w, u_rate: v, ..Start::default() }).unwrap();
        element.advance(1e-1, 0.1, 0.0).unwrap();
        element.advance(1e-3, v, 0.0).unwrap();
        forces(&element)
    };
    assert_eq!(element(0.0), element(1e-4));
    assert_eq!(element(1e-7).1, element(1e-4).1);
}

#[test]
fn a_lifted_element_has_no_forces() {
    let mut element = pressed(1e5);
    element.advance(1e-3, 0.1, 0.0).unwrap();
    element.advance(1.0, 0.0, 3e-5).unwrap();
    assert_eq!((forces(&element), element.spring.mode), ((0.0, 0.0), Mode::Free));
    assert_eq!(get(&element, Output::FrictionCoefficient), 0.0);
    element.advance(1.0, 1.0, 0.0).unwrap();
    assert_eq!((forces(&element), stored(&element)), ((0.0, 0.0), 0.0));
}

#[test]
fn a_saved_run_continues_bit_for_bit() {
    let mut first = pressed(2e5);
    first.record_mode_changes(true);
    for motion in MOTIONS {
        let bytes = postcard::to_stdvec(&first.save()).unwrap();
        let mut second = Element::restore(&contact(), &postcard::from_bytes(&bytes).unwrap()).unwrap();
        go(&mut first, motion, &[1.0]);
        go(&mut second, motion, &[1.0]);
        assert_eq!(first.save(), second.save());
    }
    let changes = first.take_mode_changes();
    assert!(changes.len() > 8 && changes.windows(2).all(|pair| pair[0].time <= pair[1].time), "{changes:?}");
    assert!(changes.windows(2).all(|pair| pair[0].to == pair[1].from && pair[0].to != pair[0].from), "{changes:?}");
}

/// Eight bytes a number in the order of the fields, one for the mode.
#[test]
fn invalid_states_are_refused() {
    let mut element = pressed(2e5);
    element.advance(1e-2, 0.1, 0.0).unwrap();
    let bytes = postcard::to_stdvec(&element.save()).unwrap();
    let refused = |at: usize, new: &[u8]| {
        let mut bytes = bytes.clone();
        bytes[at..at + new.len()].copy_from_slice(new);
        Element::restore(&contact(), &postcard::from_bytes(&bytes).unwrap()).unwrap_err().to_string()
    };
    let [w, u_rate, force, mode] = [16, 24, 40, 48];
    assert!(refused(w, &(-1.0_f64).to_le_bytes()).contains("table.extrapolation"));
    assert!(refused(u_rate, &20.0_f64.to_le_bytes()).contains("the speed is 20 m/s"));
    assert!(refused(w, &f64::NAN.to_le_bytes()).contains("invalid state: w = NaN"));
    assert!(refused(force, &1e3_f64.to_le_bytes()).contains("the force in the spring = 1000"));
    assert!(refused(mode, &[7]).contains("the mode = 7"));
    assert!(refused(mode, &[0]).contains("the mode = 0"));
}

#[test]
fn left_out_points_show_the_interpolation_error() {
    let [speed, pressure, temperature] = left_out(&table(&Grid::plain()));
    let (error, point) = speed.friction.unwrap();
    // The worst is at the hump's top, at 0.1 m/s: the cubic does not rise above its points.
    assert!((0.03..0.2).contains(&error) && (0.03..0.4).contains(&point.speed), "{error} at {point:?}");
    assert!((1e-6..0.05).contains(&pressure.force_z.unwrap().0), "{pressure:?}");
    assert_eq!((temperature.friction, temperature.force_z), (None, None));
}

#[test]
fn an_incomplete_table_is_refused_with_what_is_missing() {
    let text = Grid::plain().text();
    let refused = |text: &str| FrictionTable::parse(text, Path::new("t.csv")).unwrap_err().to_string();
    let lines: Vec<&str> = text.lines().collect();
    let without = |skip: usize| {
        let kept: Vec<&str> = lines.iter().enumerate().filter(|(i, _)| *i != skip).map(|(_, line)| *line).collect();
        kept.join("\n")
    };
    assert!(refused(&without(0)).contains("expected the line `# asperity sweep = 1`"));
    assert!(refused(&without(3)).contains("nominal_area"));
    let missing = refused(&without(8));
    assert!(missing.starts_with("t.csv: no row of ") && missing.contains("m/s, 100000 Pa"), "{missing}");
    let failed = refused(&text.replacen("steady", "\"not steady, after 9 runs\"", 2));
    assert!(failed.contains("0.0001 m/s, 100000 Pa is not steady: not steady, after 9 runs"), "{failed}");
    assert!(refused(&text.replace("separation [m]", "separation [mm]")).contains("no column `separation [m]`"));
    assert!(refused(&format!("{text}{}\n", lines[9])).contains("a second row of "));
    let one = Grid { pressures: vec![1e5], ..Grid::plain() };
    assert!(refused(&one.text()).contains("1 values of the pressure, expected at least two"));
    let mut fields: Vec<&str> = lines[6].split(',').collect();
    fields[4] = "fast";
    let wrong = refused(&text.replace(lines[6], &fields.join(",")));
    assert_eq!(wrong, "t.csv:7: friction [1] = \"fast\": expected a number, 0 or more");
}
