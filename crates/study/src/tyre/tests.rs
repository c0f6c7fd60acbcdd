//! Brushes on springs against closed forms, and the formula against data that it made.
#![allow(clippy::unwrap_used, reason = "tests may fail")]

use std::fmt::Write as _;
use std::path::Path;

use asperity::patch::Patch;

use super::*;
use crate::progress::Stop;
use crate::values::Values;

/// Of a tyre of 4000 N: radius, width (m), what stands behind its elements (Pa/m), friction.
const RADIUS: f64 = 0.3;
const WIDTH: f64 = 0.16;
const NORMAL: f64 = 3.3e7;
const SHEAR: f64 = 5e7;
const FRICTION: f64 = 0.9;

/// A brush: contacts that do not give way, with one friction, on springs. `name` tells its table from others'.
fn brush(name: &str, rest: &str) -> Patch {
    let mut table = "# asperity sweep = 1\n# nominal_area = 1 m2\n# rest_separation = 0 m\nspeed [m/s],pressure [Pa],\
                     temperature [K],status,friction [1],separation [m],tangential_stiffness [N/m]\n"
        .to_owned();
    for pressure in (0..=24).map(|i| 10.0_f64.powf(f64::from(i) / 4.0)) {
        for speed in ["1e-4", "50"] {
            writeln!(table, "{speed},{pressure:e},,steady,{FRICTION},{:e},1e15", -pressure / 1e15).unwrap();
        }
    }
    let folder = std::env::temp_dir().join(format!("asperity-brush-{name}-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::write(folder.join("stiff.csv"), table).unwrap();
    let text = format!(
        "name = 'brush'\ntable = {{ path = 'stiff.csv' }}\n[patch]\nwidth = {WIDTH}\nny = 1\n\
         backing = {{ normal = {NORMAL:e}, shear = {SHEAR:e} }}\n{rest}"
    );
    let patch = Patch::parse(&text, &folder.join("patch.toml")).unwrap();
    std::fs::remove_dir_all(folder).unwrap();
    patch
}

fn cylinder(name: &str, length: f64) -> Patch {
    cylinder_of(200, name, length)
}

fn cylinder_of(cells: usize, name: &str, length: f64) -> Patch {
    let shape = format!("shape = 'cylinder'\nradius = {RADIUS}\nlength = {length}\n");
    brush(name, &format!("{shape}nx = {cells}\ntransport = true\n"))
}

fn curves(patch: &Patch, loads: &[f64], slips: &[f64], angles: &[f64]) -> SlipCurves {
    let [loads, slips, angles] = [loads, slips, angles].map(|values| Values::from(values.to_vec()));
    let options =
        SlipOptions { loads: Some(loads), slips: Some(slips), angles: Some(angles), ..SlipOptions::default() };
    SlipCurves::new(patch, &options, (&Stop::default(), &|| ())).unwrap()
}

/// Half the angle of contact θ under a load: F_z = 2 k_n B R² (sin θ - θ cos θ).
fn half_angle(load: f64) -> f64 {
    let off = |angle: f64| 2.0 * NORMAL * WIDTH * RADIUS.powi(2) * (angle.sin() - angle * angle.cos()) - load;
    asperity::math::bracketed_root(off, (1e-3, 1.0), 1e-12)
}

/// Where all sticks, an element that enters at θ is sheared by R ((V/v_c)(θ - ϑ) - (sin θ - sin ϑ)): v_c/V = θ/sin θ
/// rolls freely, F_x = 2 k_t B R² θ sin θ κ/(1 + κ), F_y as much times -α, and M_z = 2 k_t B R³ (sin θ/θ)(sin θ - θ cos θ) α.
#[test]
fn a_brush_rolls_freely_and_creeps_as_in_closed_form() {
    // With half the cells stiffnesses are off by twice as much.
    let (patch, small) = (cylinder_of(400, "creep", 0.25), 1e-5);
    for load in [2000.0, 6000.0] {
        let found = curves(&patch, &[load], &[-small, small], &[-small, small]);
        let angle = half_angle(load);
        let free = found.points[0].free.unwrap();
        assert!((RADIUS / free / (RADIUS * angle.sin() / angle) - 1.0).abs() < 1e-4, "{free}");
        // What it differs from 1 by is a hundredth, of which cells of a 400th of the arc are the less sure.
        assert!(((free - 1.0) / (angle / angle.sin() - 1.0) - 1.0).abs() < 1e-2, "{free}");
        let rolling: Vec<&Rolling> = found.steady().map(|(_, rolling)| rolling).collect();
        let [braked, driven, right, left] = rolling[..] else { panic!("{:?}", found.failures()) };
        assert!((braked.force[2] / load - 1.0).abs() < 1e-6 && braked.sliding < 0.05);
        // Of the depth, of which the contact's ends are a share of a cell's.
        let depth = RADIUS * (1.0 - angle.cos());
        assert!(((RADIUS - braked.height) / depth - 1.0).abs() < 1e-3, "{}", braked.height);
        let stiffness = 2.0 * SHEAR * WIDTH * RADIUS.powi(2) * angle * angle.sin();
        let per_slip = |to: f64, from: f64| (to - from) / (2.0 * small);
        // At the rear a part of the contact slips that is as small as κ: at 5e-5 it takes 2e-3 of the force.
        let along = per_slip(driven.force[0], braked.force[0]) / stiffness;
        let across = per_slip(left.force[1], right.force[1]) / -stiffness;
        let lever = RADIUS * (angle.sin() - angle * angle.cos()) / angle.powi(2);
        let aligning = per_slip(left.moment_z, right.moment_z) / (stiffness * lever);
        // The ends of a contact of 110 cells and more.
        assert!((along - 1.0).abs() < 1e-3 && (across - 1.0).abs() < 1e-3, "{load}: {along} {across}");
        // Its lever counts the ends more than the force does.
        assert!((aligning - 1.0).abs() < 3e-3, "{load}: {aligning}");
    }
}

/// All slides at a large slip: forces are μ F_z against it, and their power is what is lost.
#[test]
fn a_brush_that_slides_has_its_friction() {
    let found = curves(&cylinder("slide", 0.25), &[4000.0], &[-1.0, -0.9, 5.0], &[1.2]);
    for (point, rolling) in found.steady() {
        // Half a cell at the front is stretched before it slides.
        assert!((rolling.friction() / FRICTION - 1.0).abs() < 5e-3, "{point:?}");
        let [x, y] = [point.at.speed * point.angle.cos(), point.at.speed * point.angle.sin()];
        let slip = [x - rolling.transport_speed, y];
        // The arc's speed along the ground is the tread's times a cosine of 0.97 to 1.
        let power = FRICTION * 4000.0 * slip[0].hypot(slip[1]);
        assert!((rolling.power / power - 1.0).abs() < 2e-2 && rolling.sliding > 0.97, "{point:?}");
    }
    assert_eq!((found.steady().count(), found.failures()), (4, None));
}

#[test]
fn what_a_patch_cannot_do_is_said() {
    let short = curves(&cylinder("short", 0.05), &[4000.0], &[0.1], &[]);
    assert!(short.failures().unwrap().1.contains("both ends of the arc"), "{short:?}");
    let options =
        SlipOptions { loads: Some(vec![4e3].into()), slips: Some(vec![0.1].into()), ..SlipOptions::default() };
    let refused = |patch: &Patch, options: &SlipOptions| {
        SlipCurves::new(patch, options, (&Stop::default(), &|| ())).unwrap_err().to_string()
    };
    let flat = brush("still", "shape = 'flat'\nlength = 0.1\nnx = 10\n");
    assert!(refused(&flat, &options).contains("transport = true"));
    let patch = cylinder("refused", 0.25);
    for (options, part) in [
        (SlipOptions { slips: None, ..options.clone() }, "`slips`, `angles`"),
        (SlipOptions { loads: Some(vec![-1.0].into()), ..options.clone() }, "`loads`"),
        (SlipOptions { angles: Some(vec![1.6].into()), ..options.clone() }, "`angles`"),
        (SlipOptions { temperatures: Some(vec![293.0].into()), ..options.clone() }, "`temperatures`: expected none"),
    ] {
        let message = refused(&patch, &options);
        assert!(message.contains(part), "{message}");
    }
}

/// A locked wheel whose elements warm goes on to lose friction: it says so. A rolling one is renewed.
#[test]
fn a_locked_wheel_that_warms_is_not_steady() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/reference/patch");
    let text = "name = 'warm'\ntable = { path = 'block.table.csv' }\n[patch]\nshape = 'cylinder'\nradius = 0.3\n\
                length = 0.05\nwidth = 0.05\nnx = 20\nny = 1\ntransport = true\n\
                backing = { normal = 7.5e8, shear = 2.5e8 }\n\
                heat = { conductivity = 0.25, capacity = 1700.0, density = 1100.0, share = 0.3 }";
    let patch = Patch::parse(text, &folder.join("warm.toml")).unwrap();
    let found = curves(&patch, &[100.0], &[-1.0, -0.05], &[]);
    let [locked, rolling] = &found.points[..] else { panic!("{found:?}") };
    assert_eq!(locked.rolling, Err("not steady".to_owned()));
    assert!(rolling.rolling.as_ref().unwrap().warmest.unwrap() > patch.temperature());
    // The table says the same when it is read again, to the last bit.
    let path = std::env::temp_dir().join(format!("asperity-slip-{}.csv", std::process::id()));
    std::fs::write(&path, found.table().text()).unwrap();
    assert_eq!(SlipCurves::read(&path).unwrap(), found);
    std::fs::remove_file(path).unwrap();
}

/// Points that the formula makes at some loads.
fn made(loads: &[f64], slips: &[f64], force: impl Fn(f64, f64) -> [f64; 2]) -> SlipCurves {
    let mut points = Vec::new();
    for &load in loads {
        for &x in slips {
            let [along, across] = force(load, x);
            let at = SlipConditions { temperature: None, speed: 10.0, load };
            let mut point = |slip: f64, angle: f64, force: [f64; 3]| {
                let rolling = Ok(Rolling { force, ..Rolling::default() });
                points.push(SlipPoint { at, slip, angle, free: None, rolling });
            };
            point(x, 0.0, [along, 0.0, load]);
            point(0.0, x, [0.0, across, load]);
        }
    }
    SlipCurves { name: "made".into(), radius: None, points }
}

const NOMINAL: f64 = 4000.0;

/// Pacejka's formula as in the book, in numbers of its own.
fn book(load: f64, x: f64) -> [f64; 2] {
    let df = (load - NOMINAL) / NOMINAL;
    let force = |c: f64, d: f64, k: f64, e: f64| {
        let bx = k / (c * d) * x;
        d * (c * (bx - e * (bx - bx.atan())).atan()).sin()
    };
    let across = -21.0 * NOMINAL * (2.0 * (load / (1.8 * NOMINAL)).atan()).sin();
    [
        force(1.6, load * (1.1 - 0.12 * df), load * (20.0 + 3.0 * df) * (0.3 * df).exp(), -0.4),
        force(1.3, load * (0.95 - 0.1 * df), across, -0.9),
    ]
}

fn slips(largest: f64) -> Vec<f64> {
    (-20..=20).map(|i| largest * f64::from(i) / 20.0).collect()
}

fn numbers(fit: &MagicFit) -> Vec<f64> {
    fit.coefficients.iter().map(|(name, of)| of.numbers().0.unwrap_or_else(|| panic!("{name}: {of:?}"))).collect()
}

fn agree(found: &[f64], expected: &[f64]) {
    let near = |(found, expected): (&f64, &f64)| (found - expected).abs() < 1e-6 * expected.abs();
    assert!(found.len() == expected.len() && found.iter().zip(expected).all(near), "{found:?} {expected:?}");
}

#[test]
fn the_formula_returns_the_coefficients_of_its_data() {
    let fitted = MagicFormula::new(&made(&[2e3, 3e3, 4e3, 6e3, 8e3], &slips(0.4), book), None).unwrap();
    let [along, across]: [&MagicFit; 2] = [Direction::Along, Direction::Across]
        .map(|direction| fitted.fits.iter().find(|fit| !fit.is_curve && fit.direction == direction).unwrap());
    agree(&numbers(along), &[1.6, 1.1, -0.12, 20.0, 3.0, 0.3, -0.4]);
    agree(&numbers(across), &[1.3, 0.95, -0.1, -21.0, 1.8, -0.9]);
    assert_eq!((along.at.load, fitted.fits.len()), (NOMINAL, 12));
    let curve = &fitted.fits[2];
    let d = 4400.0;
    agree(&numbers(curve), &[8e4 / (1.6 * d), 1.6, d, -0.4]);
    assert!(curve.rms < 1e-9 && (curve.force(4e3, 0.1) / book(4e3, 0.1)[0] - 1.0).abs() < 1e-9);
}

/// Errors by the textbook: data off by ±δ in turn, whose standard deviation is δ, and errors that are linear in it.
#[test]
fn errors_are_those_of_the_data() {
    let off = |delta: f64| {
        let sign =
            |load: f64, x: f64| if ((x * 1e4).round() as i64 + load as i64 / 1000) % 2 == 0 { 1.0 } else { -1.0 };
        let data = made(&[2e3, 4e3, 6e3], &slips(0.4137), |load, x| {
            book(load, x).map(|force| force + delta * load * sign(load, x))
        });
        let fitted = MagicFormula::new(&data, None).unwrap();
        let fit = fitted.over_loads(Direction::Across, data.points[0].at).unwrap().clone();
        (fit.coefficients[1].1.numbers().1.unwrap(), fit.coefficients[1].1.numbers().0.unwrap(), fit.rms)
    };
    let ((error, value, rms), (twice, ..)) = (off(1e-3), off(2e-3));
    // 123 points: less than δ but for the six numbers, and PDY1 is known to about δ over the root of their number.
    assert!((0.9e-3..=1e-3).contains(&rms) && (twice / error - 2.0).abs() < 0.1, "{rms} {error} {twice}");
    assert!((1e-4..5e-4).contains(&error) && (value - 0.95).abs() < 4.0 * error, "{value} {error}");
}

#[test]
fn what_the_data_do_not_determine_is_not_given() {
    let of = |loads: &[f64], largest: f64| {
        let data = made(loads, &slips(largest), book);
        let fitted = MagicFormula::new(&data, None).unwrap();
        [Direction::Along, Direction::Across]
            .map(|direction| fitted.over_loads(direction, data.points[0].at).unwrap().coefficients.clone())
    };
    let [along, across] = of(&[NOMINAL], 0.4);
    assert!(matches!(along[1].1, Determined::Fitted(value, _) if (value / 1.1 - 1.0).abs() < 1e-6), "{along:?}");
    assert!([2, 4, 5].iter().all(|&i| along[i].1 == Determined::Taken(0.0)), "{along:?}");
    assert!([3, 4].iter().all(|&i| across[i].1 == Determined::Not), "{across:?}");
    // Two loads tell one number of how stiffness changes with them.
    let [along, _] = of(&[2e3, 4e3], 0.4);
    assert!(along[5].1 == Determined::Taken(0.0) && matches!(along[4].1, Determined::Fitted(..)), "{along:?}");
    // Far below the peak there is but a slope.
    let [along, _] = of(&[2e3, 4e3, 6e3], 1e-3);
    assert!(!matches!(along[0].1, Determined::Fitted(..)) && along[1].1 == Determined::Not, "{along:?}");
    assert!(matches!(along[3].1, Determined::Fitted(value, _) if (value / 20.0 - 1.0).abs() < 1e-3), "{along:?}");
    assert_eq!(along[1].1.words(), "not determined");
}
