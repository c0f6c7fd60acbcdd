//! `asperity sweep`: tables against exact results, continued, in shards, and what is refused.

use std::f64::consts::TAU;
use std::fs;
use std::path::{Path, PathBuf};

use asperity::model::FineFriction;
use asperity::scene::Scene;

use crate::common::scenes::SceneText;
use crate::common::{Table, asperity, assert_names, ended, run, scratch};

/// Four masses on a plane: full slip after some tenths of a millimetre.
pub(super) fn flat() -> SceneText {
    SceneText::new(4, 1e-4, 1e-7)
        .set("name", "plane")
        .vertical((2e3, 3e-2, [(4e3, 50.0)]))
        .horizontal((5e3, 3e-2))
        .with("friction = { coulomb = 0.3, shear_force = 1e-3 }")
        .method("step")
        .relative(1e-4)
}

/// Writes a scene and returns its path and that of its table.
fn scene(folder: &Path, scene: &SceneText) -> (PathBuf, PathBuf) {
    (scene.write(folder), folder.join("table.csv"))
}

fn sweep(scene: &Path, table: &Path, options: &[&str]) {
    run(asperity().arg("sweep").arg(scene).arg("-o").arg(table).args(options));
}

/// The message of a sweep that fails.
fn refused(arguments: &[&Path], options: &[&str]) -> String {
    let (status, _, message) = ended(asperity().arg("sweep").args(arguments).args(options));
    assert_ne!(status, 0, "{arguments:?} {options:?} should fail");
    message
}

/// On a plane at full slip |F_x| = μ F_z + k A τ_0, all of it adhesion, lost as friction; and at rest, all masses
/// stuck, a motion of the carrier stretches the horizontal springs and dampers alone.
#[test]
fn full_slip_on_a_plane() {
    let folder = scratch("sweep-plane");
    let (scene, table) = scene(&folder, &flat());
    sweep(&scene, &table, &["--speeds", "0.01,1", "--forces", "0.5,2"]);
    let rows = Table::read(&table);
    for row in 0..4 {
        assert_eq!(rows.text(row, "status"), "steady");
        let [speed, force, friction] = ["speed", "mean_force", "friction"].map(|name| rows.number(row, name));
        assert!((force / rows.number(row, "force") - 1.0).abs() <= 1e-3, "{force} N");
        // The masses are at rest in the carrier's frame, so only rounding and the sampling of F_z are left.
        let expected = 0.3 + 4e-3 / force;
        assert!((friction - expected).abs() <= 1e-6 * expected, "{friction}, expected {expected}");
        assert_eq!((rows.number(row, "friction_hysteresis"), rows.number(row, "friction_adhesion")), (0.0, friction));
        let power = rows.number(row, "P_friction");
        assert!((power - friction * force * speed).abs() <= 1e-5 * power, "{power} W");
        assert_eq!(rows.number(row, "contact_ratio"), 1.0);
        // In steady motion the Maxwell elements bear nothing, though they would take minutes.
        assert!((rows.number(row, "w") + force / (4.0 * 2e3)).abs() <= 1e-9);
        assert_eq!(rows.number(row, "separation"), rows.number(row, "w"));
        // F_x = k (c u + d v): the damper's constant share at once, then the spring; least squares through the origin
        // of c u + d v over even u up to u_1 give k (c + d v Σu/Σu²), Σu/Σu² = 3/(2 n + 1) n/u_1, n = 16.
        let way = 4e-7;
        let expected = 4.0 * (5e3 + 3e-2 * speed * 3.0 * 16.0 / 33.0 / way);
        let found = rows.number(row, "tangential_stiffness");
        assert!((found - expected).abs() <= 1e-3 * expected, "{found} N/m, expected {expected}");
    }
}

/// One mass held down on a sinusoid: mean F_x = -½ q â² Im K*(qv), model.md section 8 case 2, at the speed of the
/// largest loss and a decade on either side; F_z is the spring's alone.
#[test]
fn hysteresis_on_a_sinusoid() {
    let (c, c_1, tau_1) = (2e3, 1.5e3, 1e-4);
    let (amplitude, wavelength): (f64, f64) = (1e-5, 1e-3);
    let q = TAU / wavelength;
    let text = SceneText::new(1, 1e-4, 1e-9)
        .vertical((c, 0.0, [(c_1, tau_1), (3e3, 500.0)]))
        .horizontal((2e7, 0.28))
        .sinusoid(amplitude, wavelength)
        .set("surface.points_per_wavelength", 256);
    let folder = scratch("sweep-sinusoid");
    let (scene, table) = scene(&folder, &text);
    let best = 1.0 / (q * tau_1);
    let speeds = [0.1 * best, best, 10.0 * best].map(|speed| format!("{speed:e}")).join(",");
    sweep(&scene, &table, &["--speeds", &speeds, "--forces", "0.2"]);
    let rows = Table::read(&table);
    for row in 0..3 {
        let x = rows.number(row, "speed") * q * tau_1;
        let slow = 3e3 / (rows.number(row, "speed") * q * 500.0);
        let expected = 0.5 * q * amplitude * amplitude * (c_1 * x / (1.0 + x * x) + slow);
        let found = rows.number(row, "friction") * rows.number(row, "mean_force");
        // The time that the transient has until its trend is below 5e-3 of the friction coefficient.
        assert!((found / expected - 1.0).abs() <= 2e-3, "qvτ = {x}: {found} N, expected {expected} N");
        assert_eq!(rows.number(row, "friction_hysteresis"), rows.number(row, "friction"));
        assert!((rows.number(row, "w") / (-0.2 / c) - 1.0).abs() <= 2e-3);
        // Frictionless: no stick to start from, no such channel, no temperature.
        let absent = ["tangential_stiffness", "P_friction", "P_damper", "temperature"];
        assert_eq!(absent.map(|name| rows.text(row, name).is_empty()), [true, true, false, true]);
    }
}

const POINTS: [&str; 4] = ["--speeds", "0.1..1/3", "--forces", "0.5,2"];

/// A layer as long as the profile's period bears the same at every place, so w stands still under a load that is held: no
/// search, and the same friction at the same w, within the errors that the tables give. Dashpots of minutes come to rest too.
#[test]
fn a_load_held_is_that_of_a_displacement_found() {
    let layer = SceneText::rubber(50, 1e-4, 1e-3, 1e-2)
        .set("material.equilibrium_modulus", 2e6)
        .prony(&[(5e6, 1e-4), (1e6, 60.0)])
        .with(
            "surface = { kind = 'self_affine', length = 5e-3, points = 512, hurst = 0.8, rms = 2e-5, seed = 3, \
             roll_off_wavelength = 2e-3, cut_off_wavelength = 4e-4 }",
        )
        .coulomb(0.2)
        .method("step")
        .relative(1e-3);
    let options = ["--speeds", "0.03,0.1", "--pressures", "3e5"];
    let tables =
        [("displacement", ""), ("load", "carrier.z = { mass = 1e-2, damping = 20.0 }")].map(|(held, carrier)| {
            let (scene, table) = scene(&scratch(&format!("sweep-held-{held}")), &layer.clone().with(carrier));
            sweep(&scene, &table, &options);
            assert_eq!(
                fs::read_to_string(&table).unwrap().contains("# held = load, on a carrier of 0.01 kg"),
                held == "load"
            );
            Table::read(&table)
        });
    let [searched, held] = &tables;
    for row in 0..2 {
        assert_eq!((held.text(row, "status"), held.number(row, "runs")), ("steady", 1.0));
        let of = |name: &str| [searched.number(row, name), held.number(row, name)];
        let ([a, b], errors) = (of("friction"), of("friction_standard_error"));
        // The load found is within 1e-3; three standard errors.
        assert!((a - b).abs() < 1e-3 * a + 3.0 * (errors[0] + errors[1]), "friction {a} {b}");
        let [a, b] = of("w");
        assert!((a - b).abs() < 5e-3 * a.abs(), "w {a} {b}");
    }
    let (scene, _) = scene(&scratch("sweep-held-x"), &layer.with("carrier.x = { mass = 1.0 }"));
    assert!(refused(&[&scene], &options).contains("[carrier.x]"));
}

/// Cut off after any byte, a table is completed, the same to the last byte; points done are kept to the letter.
#[test]
fn a_table_cut_off_anywhere_is_completed() {
    let folder = scratch("sweep-resume");
    let (scene, table) = scene(&folder, &flat());
    sweep(&scene, &table, &POINTS);
    let whole = fs::read(&table).unwrap();
    for cut in (0..whole.len()).step_by(131).chain([whole.len() - 1]) {
        fs::write(&table, &whole[..cut]).unwrap();
        sweep(&scene, &table, &POINTS);
        assert!(fs::read(&table).unwrap() == whole, "cut off after {cut} bytes");
    }
    // Points done are not computed again: what is changed by hand stays.
    let text = String::from_utf8(whole.clone()).unwrap().replace(",steady,", ",by hand,");
    // Nothing is said of the law of points that are not steady.
    let low_end = text.lines().find(|line| line.starts_with("# low_end")).unwrap();
    let text = text.replace(&format!("{low_end}\n"), "");
    fs::write(&table, &text).unwrap();
    let message = refused(&[&scene, Path::new("-o"), &table], &POINTS);
    assert_names(&message, "6 of 6 points");
    assert_eq!(fs::read_to_string(&table).unwrap(), text);
    // More points: those done are kept, the others added in their places.
    sweep(&scene, &table, &["--speeds", "0.1..1/3", "--forces", "0.5,2", "--force"]);
    assert!(fs::read(&table).unwrap() == whole);
    sweep(&scene, &table, &["--speeds", "0.1..1/3,2", "--forces", "0.5,2"]);
    assert_eq!(Table::read(&table).len(), 8);
    assert!(table.with_extension("svg").exists());
}

/// The end of a sweep, and the header of its table, say how far the law reaches below the least load; a table with that
/// line is read.
#[test]
fn the_low_end_is_named() {
    let folder = scratch("sweep-low-end");
    let (scene, table) = scene(&folder, &flat());
    let mut sweep = asperity();
    sweep.arg("sweep").arg(&scene).arg("-o").arg(&table).args(["--speeds", "0.1,1", "--forces", "0.5,1,2"]);
    // Long lines are broken between words.
    let printed = run(&mut sweep).split_whitespace().collect::<Vec<_>>().join(" ");
    // Springs of 8 kN/m: 62.5 µm to the first force, as much to the second, twice that to the third. ln F rises by ln 2 from
    // each to the next; the parabola through the three has the slope (1 + 1/2 · 1/3) ln 2/62.5 µm at the first, and the law
    // touches 2/slope farther.
    let reach = 2.0 / ((1.0 + 1.0 / 6.0) * 2.0_f64.ln() / 62.5);
    let line = format!(
        "below 0.5 N the law is a parabola that reaches {:.0} µm farther at 0.1 m/s",
        10.0 * (reach / 10.0).round()
    );
    assert!(printed.contains("Low end ") && printed.contains(&line), "{line}: {printed}");
    let header = fs::read_to_string(&table).unwrap();
    let header = header.lines().find_map(|line| line.strip_prefix("# low_end = ")).unwrap();
    assert!(printed.contains(header), "{header}");
    let patch = folder.join("patch.toml");
    let shape = "shape = 'flat'\nlength = 0.01\nwidth = 0.01\nnx = 1\nny = 1";
    fs::write(&patch, format!("name = 'p'\n[table]\npath = 'table.csv'\nnominal_area = 1e-6\n[patch]\n{shape}\n"))
        .unwrap();
    assert!(run(asperity().args(["describe", "--patch"]).arg(&patch)).contains("6 points"));
    // One force has no slope, so nothing is known below it.
    let one = folder.join("one.csv");
    let printed =
        run(asperity().args(["-q", "sweep"]).arg(&scene).arg("-o").arg(one).args(["--speeds", "1", "--forces", "1"]));
    assert!(printed.contains("Friction") && !printed.contains("Low end"), "{printed}");
}

/// Merged shards are the whole, byte for byte; points that are missing or differ are named.
#[test]
fn merged_shards_are_the_whole() {
    let folder = scratch("sweep-shards");
    let (scene, table) = scene(&folder, &flat());
    sweep(&scene, &table, &POINTS);
    let shards = ["1/3", "2/3", "3/3"].map(|shard| {
        let path = folder.join(format!("shard-{}.csv", &shard[..1]));
        sweep(&scene, &path, &[&POINTS[..], &["--shard", shard]].concat());
        path
    });
    let joined = folder.join("joined.csv");
    let join =
        |paths: &[&PathBuf]| asperity().args(["sweep", "--merge"]).args(paths).arg("-o").arg(&joined).output().unwrap();
    assert!(join(&shards.each_ref()).status.success());
    assert!(fs::read(&joined).unwrap() == fs::read(&table).unwrap());
    fs::remove_file(&joined).unwrap();
    let output = join(&[&shards[0], &shards[2]]);
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_names(&message, "2 of 6 points | 0.316228 m/s, 0.5 N; 0.316228 m/s, 2 N");
    // The sweep then completes it.
    sweep(&scene, &joined, &POINTS);
    assert!(fs::read(&joined).unwrap() == fs::read(&table).unwrap());
    let other = folder.join("other.csv");
    fs::write(&other, fs::read_to_string(&shards[0]).unwrap().replace("steady", "other")).unwrap();
    let message = String::from_utf8_lossy(&join(&[&shards[0], &other]).stderr).into_owned();
    assert_names(&message, "0.1 m/s, 0.5 N");
    sweep(&scene, &other, &[&POINTS[..], &["--shard", "2/3", "--force", "--set", "friction.coulomb=0.2"]].concat());
    let message = String::from_utf8_lossy(&join(&[&shards[0], &other]).stderr).into_owned();
    assert_names(&message, "fingerprint");
}

#[test]
fn invalid_commands_are_refused() {
    let folder = scratch("sweep-refused");
    let (scene, table) = scene(&folder, &flat());
    let asked = |options: &[&str]| refused(&[&scene, Path::new("-o"), &table], options);
    assert_names(asked(&["--speeds", "1", "--pressures", "1e5"]), "--forces");
    assert_names(asked(&["--speeds", "1"]), "--pressures | --forces");
    assert!(asked(&["--speeds", "1", "--forces", "1", "--temperatures", "300"]).contains("no material.wlf"));
    assert!(asked(&["--speeds", "1", "--forces", "1", "--master", "master.svg"]).contains("no material.wlf"));
    assert!(asked(&["--speeds", "2..1/3", "--forces", "1"]).contains("a < b"));
    assert_names(asked(&["--speeds", "1", "--forces", "1", "--shard", "3/2"]), "--shard | 3/2");
    assert!(!table.exists());
    // Another file, another sweep, a table of more points: none is replaced without --force.
    fs::write(&table, "time,u,w\n0,0,0\n").unwrap();
    assert_names(asked(&["--speeds", "1", "--forces", "1"]), "# asperity sweep = 1");
    sweep(&scene, &table, &["--speeds", "1,2", "--forces", "1", "--force"]);
    let whole = fs::read(&table).unwrap();
    assert_names(asked(&["--speeds", "1", "--forces", "1"]), "2 m/s, 1 N");
    let set = ["--speeds", "1,2", "--forces", "1", "--set", "friction.coulomb=0.5"];
    assert!(asked(&set).contains("is the table of another sweep"));
    assert!(
        asked(&["--speeds", "1,2", "--forces", "1", "--friction-error", "0.1"])
            .contains("is the table of another sweep")
    );
    assert!(fs::read(&table).unwrap() == whole);
    assert!(
        refused(&[&scene, Path::new("-o"), &scene], &["--speeds", "1", "--forces", "1"]).contains("will not write")
    );
}

/// A point that fails has a row with its reason, and the exit code is an error.
#[test]
fn points_that_fail_are_rows() {
    let folder = scratch("sweep-failed");
    let (scene, table) = scene(&folder, &flat());
    let path = [&scene, Path::new("-o"), &table];
    let message = refused(&path, &["--speeds", "1", "--forces", "1", "--set", "solver.max_steps=3"]);
    assert_names(&message, "1 of 1 points");
    // The status holds a comma, so it is quoted.
    assert!(fs::read_to_string(&table).unwrap().contains(",\"gave up at t = "));
    // Too short a way for three blocks.
    let message = refused(&path, &["--speeds", "1", "--forces", "1", "--distance", "5e-4", "--force"]);
    assert_names(&message, "1 of 1 points");
    let status = Table::read(&table).text(0, "status").to_owned();
    assert_names(&status, "3 blocks");
}

/// The scene two-maxima: adhesion's maximum at low speed, hysteresis' at high speed, and both move with the
/// temperature as the shift says, μ(v, T) = μ(a_T v, T_ref), the shear strength and the real area included. Between 1 mm/s and
/// 0.2 m/s the adhesion falls so steeply that masses stick and slip, which does not shift, for the inertia stays: points
/// on both sides of it are compared.
#[test]
fn two_maxima_move_with_the_temperature() {
    let folder = scratch("sweep-two-maxima");
    let scene = crate::common::root().join("scenes/two-maxima/two-maxima.toml");
    let friction = |temperature: &str, speeds: &[f64]| {
        let table = folder.join(format!("{temperature}.csv"));
        let list = speeds.iter().map(|speed| format!("{speed:e}")).collect::<Vec<_>>().join(",");
        let options = [
            "--speeds",
            &list,
            "--pressures",
            "4e5",
            "--temperatures",
            temperature,
            "--method",
            "layer",
            "--friction-error",
            "5e-3",
            "--distance",
            "0.5",
        ];
        sweep(&scene, &table, &options);
        let rows = Table::read(&table);
        let parts = ["friction", "friction_hysteresis", "friction_adhesion"];
        (0..speeds.len()).map(|row| parts.map(|name| rows.number(row, name))).collect::<Vec<_>>()
    };
    let speeds = [1e-5, 1e-4, 8e-4, 1e-2, 3e-1, 1.0, 3.0, 8.0];
    let reference = friction("293.15", &speeds);
    let peaks = |part: usize| -> Vec<usize> {
        let of = |i: usize| reference[i][part];
        (1..speeds.len() - 1).filter(|&i| of(i) > of(i - 1) && of(i) > of(i + 1)).collect()
    };
    // Hysteresis has a lower one where adhesion has its own, whose shear tilts what the rubber presses on.
    let (whole, hysteresis, adhesion) = (peaks(0), peaks(1), peaks(2));
    assert_eq!((whole, hysteresis, adhesion), (vec![2, 6], vec![2, 6], vec![2]), "{reference:?}");
    // a_T at 10 K above; below adhesion's maximum, behind the fall, and hysteresis' maximum.
    let shift = 10_f64.powf(-7.52 * 10.0 / (119.75 + 10.0));
    let shifted = friction("303.15", &[1e-4, 1.0, 3.0].map(|speed| speed / shift));
    // The sweep's own error of 0.5 % in either; at 11 m/s the inertia adds 3 %.
    for (here, (i, bound)) in shifted.iter().zip([(1, 0.01), (5, 0.01), (6, 0.04)]) {
        let there = reference[i];
        assert!((here[0] - there[0]).abs() <= bound * there[0], "{} m/s: {here:?}, {there:?}", speeds[i]);
    }
}

/// The picture of a sweep has the scene's name, markers at its points and a chart for each part of friction; that of the
/// master curve has the speed at the reference temperature.
#[test]
fn a_sweep_is_drawn_over_speed_and_over_the_shifted_speed() {
    let folder = scratch("sweep-drawn");
    let scene = crate::common::root().join("scenes/road/road.toml");
    let pictures = ["speed.svg", "master.svg"].map(|name| folder.join(name));
    let [plot, master] = pictures.each_ref().map(|path| path.to_str().unwrap());
    let points = ["--speeds", "1e-3..1/3", "--pressures", "3e5", "--temperatures", "283.15,303.15"];
    sweep(&scene, &folder.join("table.csv"), &[&points[..], &["--plot", plot, "--master", master]].concat());
    let texts = pictures.map(|path| fs::read_to_string(path).unwrap());
    for (text, x) in texts.iter().zip(["speed in m/s", "a_T v in m/s, at 20 °C"]) {
        for part in ["road", "friction coefficient", "hysteresis", "adhesion", "10 °C", "30 °C", x] {
            assert!(text.contains(&format!("\n{part}\n")), "{part}: {text}");
        }
        // Discs of the first temperature at three points of three charts and in the legend.
        assert_eq!(text.matches("<circle").count(), 3 * 3 + 1, "{text}");
    }
}

/// A profile that ends before steady sliding could be judged is refused with what to do, and nothing is said of an excitation
/// that is not used.
#[test]
fn a_profile_that_ends_is_to_be_made_periodic() {
    let folder = scratch("sweep-ends");
    let text = |periodic| {
        let profile = flat().points(&[0.0, 5e-4, 1e-3], &[0.0, 1e-6, 0.0], periodic);
        profile.phase("duration = 1.0, u_rate = 1.0")
    };
    let (ends, table) = scene(&folder, &text(false));
    let message = refused(&[&ends, Path::new("-o"), &table], &["--speeds", "1", "--forces", "1"]);
    assert_names(&message, "periodic | --mirror --write");
    assert!(message.lines().count() == 1 && !table.exists(), "{message}");
    let (periodic, table) = scene(&folder, &text(true));
    sweep(&periodic, &table, &["--speeds", "1", "--forces", "1"]);
}

/// One mass on a plane with waves that it lacks: all hysteresis is theirs, and the area that touches is the law's. At 0.1 m/s,
/// where its friction falls steeply, it would stick and slip.
#[test]
fn waves_below_the_profile_have_columns_of_their_own() {
    let folder = scratch("sweep-fine");
    let reference = |name: &str| crate::common::root().join(format!("tests/reference/fine/{name}.toml"));
    let (path, table) = (reference("fine-flat"), folder.join("table.csv"));
    sweep(&path, &table, &["--speeds", "1,10", "--pressures", "3e5"]);
    let rows = Table::read(&table);
    let scene = Scene::load(&path).unwrap();
    let (law, area) = (FineFriction::new(&scene).unwrap(), scene.layer.element_area().unwrap());
    for (i, speed) in [1.0, 10.0].into_iter().enumerate() {
        let contact = law.contact(3e5 * area, speed);
        let expected = [contact.hysteresis.value / (3e5 * area), contact.share.value];
        let found = ["friction_fine", "area_real"].map(|name| rows.column(name)[i]);
        for (found, expected) in found.into_iter().zip(expected) {
            // The mass swings as it slides, and its samples with it.
            assert!((found / expected - 1.0).abs() < 1e-2, "{found} for {expected} at {speed} m/s");
        }
        let hysteresis = rows.column("friction_hysteresis")[i];
        assert!((hysteresis / found[0] - 1.0).abs() < 1e-9, "{hysteresis} and {found:?}");
    }
    assert!(rows.texts("flash_mean").iter().all(|text| text.is_empty()));
    let table = folder.join("heat.csv");
    let refused =
        refused(&[&reference("fine-heat"), Path::new("-o"), &table], &["--speeds", "1", "--pressures", "1e5"]);
    assert_names(&refused, "material.heat: expected none");
}
