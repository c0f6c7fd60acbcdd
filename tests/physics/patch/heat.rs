//! Elements that slip warms: closed forms, orders, states, and where it is refused.

use std::f64::consts::PI;
use std::fmt::Write as _;
use std::fs;

use super::exact::{folder, go, run_at, value, wrench};
use asperity::patch::{MotionError, Patch, PatchMotion, PatchOutput, PatchRun};

const ONE: &str = "shape = \"flat\"\nlength = 0.01\nwidth = 0.01\nnx = 1\nny = 1";
const FLAT: &str = "shape = \"flat\"\nlength = 0.02\nwidth = 0.01\nnx = 5\nny = 3";
const CONDUCTIVITY: f64 = 0.25;
const CAPACITY: f64 = 1700.0;
const DENSITY: f64 = 1100.0;
const TEMPERATURE: f64 = 293.15;
/// Pa/m of approach, and of stiffness along the plane: so stiff that slip begins at once.
const BED: f64 = 5e9;

/// The table of a bed of springs whose friction coefficient depends on the temperature (K).
fn table(temperatures: &[f64], shear: f64, friction: impl Fn(f64) -> f64) -> String {
    let mut text = "# asperity sweep = 1\n# nominal_area = 1 m2\n# rest_separation = 0 m\nspeed [m/s],pressure [Pa],\
                    temperature [K],status,friction [1],separation [m],tangential_stiffness [N/m]\n"
        .to_owned();
    for &kelvin in temperatures {
        for pressure in (0..=16).map(|i| 1e2 * 10.0_f64.powf(f64::from(i) / 4.0)) {
            for speed in ["1e-4", "1e-1", "50"] {
                let (separation, friction) = (-pressure / BED, friction(kelvin));
                writeln!(text, "{speed},{pressure:e},{kelvin},steady,{friction},{separation:e},{shear:e}").unwrap();
            }
        }
    }
    text
}

/// From 273.15 to 373.15 K.
fn temperatures() -> Vec<f64> {
    (0..=10).map(|i| 273.15 + 10.0 * f64::from(i)).collect()
}

/// Friction that falls by a hundredth with each kelvin.
fn falling(kelvin: f64) -> f64 {
    (-0.01 * (kelvin - TEMPERATURE)).exp()
}

fn heat(share: f64) -> String {
    format!(
        "heat = {{ conductivity = {CONDUCTIVITY}, capacity = {CAPACITY:.1}, density = {DENSITY:.1}, share = {share:?} }}"
    )
}

fn text(table: &str, face: &str, refine: u32) -> String {
    format!(
        "name = \"heat\"\n[table]\npath = \"{table}\"\ntemperature = {TEMPERATURE}\n[patch]\n{face}\n[solver]\nrefine = \
         {refine}\n[fmu]\noutputs = [\"forces\", \"dissipation\", \"contact\", \"tangent\", \"elements\"]\n"
    )
}

/// A patch on the table `content`, or on one of this folder's.
fn parse(name: &str, content: Option<&str>, face: &str, refine: u32) -> Patch {
    let folder = folder(&format!("heat-{name}"));
    let table = if content.is_some() { "own.csv" } else { "block.table.csv" };
    content.iter().for_each(|content| fs::write(folder.join(table), content).unwrap());
    Patch::parse(&text(table, face, refine), &folder.join("patch.toml")).unwrap()
}

fn largest_rise(run: &mut PatchRun, patch: &Patch) -> f64 {
    value(run, patch, PatchOutput::LargestTemperature) - TEMPERATURE
}

/// 2χQ√t/√(πkρc), K.
fn rise(share: f64, flux: f64, time: f64) -> f64 {
    2.0 * share * flux * (time / (PI * CONDUCTIVITY * DENSITY * CAPACITY)).sqrt()
}

/// From 1 ms to 1000 s, whether in steps of one decade's tenth or in one.
#[test]
fn one_cell_under_a_constant_loss_warms_as_the_root_of_time() {
    let (share, pressure, speed) = (0.3, 1e4, 0.1);
    let content = table(&temperatures(), 1e13, |_| 0.9);
    let patch = parse("root", Some(&content), &format!("{ONE}\n{}", heat(share)), 1);
    let rates = [speed, 0.0, 0.0, 0.0, 0.0, 0.0];
    let start = || run_at(&patch, [0.0, 0.0, -pressure / BED, 0.0, 0.0, 0.0], rates, 0.0);
    let mut run = start();
    for i in 0..=60 {
        let time = 1e-3 * 10.0_f64.powf(f64::from(i) / 10.0);
        let before = run.time();
        go(&mut run, &patch, time - before, rates, 0.0);
        let flux = 0.9 * wrench(&mut run, &patch)[2] / 1e-4 * speed;
        let expected = rise(share, flux, time);
        for found in
            [largest_rise(&mut run, &patch), value(&mut run, &patch, PatchOutput::ElementTemperature(0)) - TEMPERATURE]
        {
            assert!((found / expected - 1.0).abs() < 1e-2, "{time}: {found} {expected}");
        }
        let mut at_once = start();
        go(&mut at_once, &patch, time, rates, 0.0);
        assert!((largest_rise(&mut at_once, &patch) / expected - 1.0).abs() < 1e-2, "{time}");
        assert!(run.take_warnings().is_empty());
    }
}

/// A cell that has lifted cools by its own states: after a pulse as the kernel falls.
#[test]
fn what_lifts_cools() {
    let content = table(&temperatures(), 1e13, |_| 0.9);
    let patch = parse("cools", Some(&content), &format!("{ONE}\n{}", heat(0.3)), 1);
    let rates = [0.1, 0.0, 0.0, 0.0, 0.0, 0.0];
    let mut run = run_at(&patch, [0.0, 0.0, -2e-6, 0.0, 0.0, 0.0], rates, 0.0);
    go(&mut run, &patch, 1.0, rates, 0.0);
    let flux = 0.9 * wrench(&mut run, &patch)[2] / 1e-4 * 0.1;
    go(&mut run, &patch, 1e-9, [0.0, 0.0, 1e6, 0.0, 0.0, 0.0], 0.0);
    go(&mut run, &patch, 3.0, [0.0; 6], 0.0);
    let found = value(&mut run, &patch, PatchOutput::ElementTemperature(0)) - TEMPERATURE;
    let expected = rise(0.3, flux, 4.0) - rise(0.3, flux, 3.0);
    // A difference of two numbers that are right within 1 %.
    assert!((found / expected - 1.0).abs() < 5e-2, "{found} {expected}");
    assert_eq!(value(&mut run, &patch, PatchOutput::LargestTemperature), TEMPERATURE);
}

/// Friction that falls as the cell warms: the error of a part is of first order.
#[test]
fn half_the_part_halves_the_difference() {
    let content = table(&temperatures(), 1e13, falling);
    let force_after = |refine: u32, pieces: u32| {
        let patch =
            parse(&format!("half-{refine}-{pieces}"), Some(&content), &format!("{FLAT}\n{}", heat(0.3)), refine);
        let rates = [1.5, 0.1, 0.0, 0.0, 0.0, 0.2];
        let mut run = run_at(&patch, [0.0, 0.0, -1.2e-5, 2e-4, 0.0, 0.0], rates, 0.0);
        (0..20 * pieces).for_each(|_| go(&mut run, &patch, 5e-3 / f64::from(pieces), rates, 0.0));
        let [x, y, ..] = wrench(&mut run, &patch);
        assert!(largest_rise(&mut run, &patch) > 10.0);
        x.hypot(y)
    };
    let exact = force_after(256, 1);
    let differences = [1, 2, 4].map(|refine| force_after(refine, 1) - exact);
    for pair in differences.windows(2) {
        assert!((1.7..2.4).contains(&(pair[0] / pair[1])), "{differences:?}");
    }
    // Shorter steps and finer parts are the same.
    assert!((force_after(1, 2) / force_after(2, 1) - 1.0).abs() < 1e-6);
}

/// One long step is cut until the temperature changes by 5 K in a part, so that friction is off by 5 % at most.
#[test]
fn a_long_step_is_cut() {
    let content = table(&temperatures(), 1e13, falling);
    let patch = parse("long", Some(&content), &format!("{ONE}\n{}", heat(0.3)), 1);
    let rates = [2.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    let ends = |pieces: u32| {
        let mut run = run_at(&patch, [0.0, 0.0, -1.6e-5, 0.0, 0.0, 0.0], rates, 0.0);
        (0..pieces).for_each(|_| go(&mut run, &patch, 1.0 / f64::from(pieces), rates, 0.0));
        (wrench(&mut run, &patch)[0], largest_rise(&mut run, &patch), value(&mut run, &patch, PatchOutput::Energy))
    };
    let (coarse, fine) = (ends(1), ends(20_000));
    assert!(fine.1 > 40.0, "{fine:?}");
    for (found, expected) in [(coarse.0, fine.0), (coarse.1, fine.1), (coarse.2, fine.2)] {
        assert!((found / expected - 1.0).abs() < 0.05, "{coarse:?} {fine:?}");
    }
}

/// Without heat, or with none of it, friction is that of the temperature given.
#[test]
fn a_share_of_nearly_nothing_is_no_heat() {
    let rates = [0.02, -0.01, -1e-3, 0.0, 0.0, 0.5];
    let ends = |name: &str, face: &str| {
        let patch = parse(name, None, face, 1);
        let mut run = run_at(&patch, [0.0, 0.0, 2e-6, 0.0, 0.0, 0.0], [0.0; 6], 0.0);
        (0..5).for_each(|_| go(&mut run, &patch, 1e-3, rates, 0.0));
        wrench(&mut run, &patch)
    };
    let (cold, warm) = (ends("none", FLAT), ends("little", &format!("{FLAT}\n{}", heat(1e-12))));
    for (cold, warm) in cold.iter().zip(warm) {
        // Between planes of the table, in p and μp, of forces of 10 N and moments of 0.1 N m.
        assert!((cold - warm).abs() < 1e-3 * cold.abs().max(1e-2), "{cold} {warm}");
    }
}

/// Tangents go through the heat of the step: of a tilted face that slides and turns, in several parts, against
/// difference quotients.
#[test]
fn tangents_are_difference_quotients() {
    let content = table(&temperatures(), 1.5e9, falling);
    let patch = parse("tangents", Some(&content), &format!("{FLAT}\n{}", heat(0.3)), 4);
    let pose = [0.0, 0.0, -1.5e-5, 1e-3, 5e-4, 0.3];
    let rates = [2.0, -1.0, -1e-3, 0.02, -0.01, 0.5];
    let start = || {
        let mut run = run_at(&patch, pose, [0.0; 6], 0.0);
        (0..5).for_each(|_| go(&mut run, &patch, 1e-3, [2.0, 0.0, 0.0, 0.0, 0.0, 0.0], 0.0));
        run
    };
    let (duration, steps) = (2e-3, [1e-8, 1e-8, 1e-9, 1e-7, 1e-7, 1e-7]);
    let ends = |shift: [f64; 6]| {
        let mut run = start();
        let rates = std::array::from_fn(|i| rates[i] + shift[i] / duration);
        go(&mut run, &patch, duration, rates, 0.0);
        assert!(largest_rise(&mut run, &patch) > 5.0);
        wrench(&mut run, &patch)
    };
    let mut run = start();
    go(&mut run, &patch, duration, rates, 0.0);
    for column in 0..6 {
        let shift = |sign: f64| std::array::from_fn(|i| if i == column { sign * steps[i] } else { 0.0 });
        let (after, before) = (ends(shift(1.0)), ends(shift(-1.0)));
        let tangent = |row: usize, run: &mut PatchRun| value(run, &patch, PatchOutput::Tangent(row, column));
        for rows in [0..3, 3..6] {
            let largest = rows.clone().map(|row| tangent(row, &mut run).abs()).fold(0.0, f64::max);
            for row in rows {
                let quotient = (after[row] - before[row]) / (2.0 * steps[column]);
                let found = tangent(row, &mut run);
                assert!((found - quotient).abs() < 1e-5 * largest, "{row} {column}: {found} {quotient}");
            }
        }
    }
    // By x the force changes by heat alone: all slide.
    assert!(value(&mut run, &patch, PatchOutput::Tangent(0, 0)).abs() > 1.0);
}

/// A run that is restored goes on as it would have; a state of another patch, or that no run reaches, is refused.
#[test]
fn a_state_holds_the_heat() {
    let content = table(&temperatures(), 1.5e9, falling);
    let tread = format!(
        "shape = \"cylinder\"\nradius = 0.3\nlength = 0.02\nwidth = 0.01\nnx = 8\nny = 2\ntransport = true\noffset = [0.0, 0.0, 0.3]\n{}",
        heat(0.3)
    );
    for (name, face) in [("state-flat", format!("{FLAT}\n{}", heat(0.3))), ("state-tread", tread)] {
        let patch = parse(name, Some(&content), &face, 1);
        let rates = [1.0, -0.3, 0.0, 0.0, 0.0, 0.5];
        let mut run = run_at(&patch, [0.0, 0.0, -4e-5, 0.0, 0.0, 0.0], [0.0; 6], 0.7);
        (0..7).for_each(|_| go(&mut run, &patch, 1e-3, rates, 0.7));
        let saved = run.save();
        let mut restored = PatchRun::restore(&patch, &saved).unwrap();
        for _ in 0..3 {
            go(&mut run, &patch, 1.1e-3, rates, 0.6);
            go(&mut restored, &patch, 1.1e-3, rates, 0.6);
        }
        assert!(largest_rise(&mut run, &patch) > 1.0);
        assert_eq!(restored.save(), run.save());
        // Back again.
        let end = run.save();
        run.set_state(&saved).unwrap();
        (0..3).for_each(|_| go(&mut run, &patch, 1.1e-3, rates, 0.6));
        assert_eq!(run.save(), end);
        let cold = parse(
            &format!("{name}-cold"),
            Some(&content),
            face.lines().filter(|line| !line.starts_with("heat")).collect::<Vec<_>>().join("\n").as_str(),
            1,
        );
        assert!(PatchRun::restore(&cold, &saved).is_err());
    }
}

/// Cells of a tread that runs through come in cold and leave warm; those of a locked wheel stay and warm on.
#[test]
fn cells_of_a_tread_enter_at_the_temperature_given() {
    let content = table(&temperatures(), 1.5e9, |_| 0.9);
    let face =
        format!("shape = \"flat\"\nlength = 0.1\nwidth = 0.01\nnx = 20\nny = 1\ntransport = true\n{}", heat(0.3));
    let patch = parse("tread", Some(&content), &face, 1);
    let (speed, slip) = (5.0, 0.5);
    let rates = [speed, 0.0, 0.0, 0.0, 0.0, 0.0];
    let mut run = run_at(&patch, [0.0, 0.0, -2e-5, 0.0, 0.0, 0.0], rates, speed - slip);
    // Three passages; after each millisecond the first cell is where it was.
    let step = 0.1 / 20.0 / (speed - slip);
    (0..60).for_each(|_| go(&mut run, &patch, step, rates, speed - slip));
    let mut rise_of = |i: usize| value(&mut run, &patch, PatchOutput::ElementTemperature(i)) - TEMPERATURE;
    let rises: Vec<f64> = (0..21).map(&mut rise_of).collect();
    assert!(rises[0] == 0.0 && rises[1] > 0.0 && rises[2..20].windows(2).all(|pair| pair[1] > pair[0]), "{rises:?}");
    // A cell that has slipped from 1 mm/κμp behind the front on has been warmed for its passage.
    let flux = 0.9 * 1e5 * slip;
    let time = 0.5 * step * 39.0;
    assert!((rises[20] / rise(0.3, flux, time) - 1.0).abs() < 2e-2, "{} {}", rises[20], rise(0.3, flux, time));
    let passed = largest_rise(&mut run, &patch);
    // Locked.
    (0..60).for_each(|_| go(&mut run, &patch, step, rates, 0.0));
    assert!(largest_rise(&mut run, &patch) > 5.0 * passed);
}

/// Beyond the last temperature of the table the law is held, said once; or the step is refused and nothing has changed.
#[test]
fn beyond_the_table_s_temperatures_the_law_is_held() {
    let content = table(&[293.15, 303.15], 1e13, falling);
    let face = format!("{ONE}\n{}", heat(1.0));
    let patch = parse("beyond", Some(&content), &face, 1);
    let rates = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    let mut run = run_at(&patch, [0.0, 0.0, -1e-5, 0.0, 0.0, 0.0], rates, 0.0);
    (0..10).for_each(|_| go(&mut run, &patch, 1e-2, rates, 0.0));
    assert!(largest_rise(&mut run, &patch) > 15.0);
    let [x, _, z, ..] = wrench(&mut run, &patch);
    assert!((-x / z / falling(303.15) - 1.0).abs() < 1e-9, "{x} {z}");
    let warnings = run.take_warnings();
    let [warning] = warnings.as_slice() else { panic!("{warnings:?}") };
    assert!(warning.starts_with("element[1,1] is warmer than the table at t = 0.0"), "{warning}");
    assert!(run.take_warnings().is_empty());
    // One step beyond two ends of the table says both.
    let mut run = run_at(&patch, [0.0, 0.0, -1e-5, 0.0, 0.0, 0.0], rates, 0.0);
    let deep = [1.0, 0.0, -1.0, 0.0, 0.0, 0.0];
    run.advance(&PatchMotion { duration: 1e-2, rates: deep, transport_speed: 0.0, temperature: 313.15 }).unwrap();
    let warnings = run.take_warnings();
    let [temperature, element] = warnings.as_slice() else { panic!("{warnings:?}") };
    assert!(temperature.starts_with("the temperature 313.15 K is beyond the table"), "{temperature}");
    assert!(element.starts_with("element[1,1] is beyond the table"), "{element}");
    // Refused.
    let folder = folder("heat-beyond-refused");
    fs::write(folder.join("own.csv"), content).unwrap();
    let refusing = text("own.csv", &face, 1).replace("[patch]", "extrapolation = \"refuse\"\n[patch]");
    let patch = Patch::parse(&refusing, &folder.join("patch.toml")).unwrap();
    let mut run = run_at(&patch, [0.0, 0.0, -1e-5, 0.0, 0.0, 0.0], rates, 0.0);
    let before = run.save();
    let motion = PatchMotion { duration: 0.1, rates, transport_speed: 0.0, temperature: TEMPERATURE };
    let error = run.advance(&motion).unwrap_err();
    assert!(matches!(error, MotionError::ElementTooWarm { within: true, .. }), "{error}");
    assert_eq!(run.save(), before);
}

/// With a table of one temperature or none there is nothing to look up.
#[test]
fn a_table_of_one_temperature_is_refused() {
    let folder = folder("heat-refused");
    fs::write(folder.join("one.csv"), table(&[TEMPERATURE], 1e9, |_| 0.9)).unwrap();
    for (table, found) in [("one.csv", "a table of 1"), ("winkler.table.csv", "a table without temperatures")] {
        let text = text(table, &format!("{ONE}\n{}", heat(0.3)), 1);
        // Bare springs have no temperature to begin with either.
        let text = if table == "one.csv" { text } else { text.replace("temperature = 293.15", "") };
        let error = Patch::parse(&text, &folder.join("p.toml")).unwrap_err().to_string();
        let expected = format!("p.toml:11: patch.heat = {found}: expected a table of two temperatures or more");
        assert!(error.contains(&expected), "{error}");
    }
}
