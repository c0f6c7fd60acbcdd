//! Rough surfaces as a user meets them: `asperity surface`, and X3P files on their way into an FMU.

use std::f64::consts::{PI, TAU};
use std::fs;
use std::io::{Cursor, Read as _, Write as _};
use std::path::Path;

use crate::common::near::assert_relative;
use crate::common::scenes::SceneText;
use crate::common::{asperity, assert_names, root, run, scratch};
use asperity::scene::Scene;
use asperity_fmi::{Definition, Sources, guid};
use asperity_study::files::load_scene;
use serde_json::Value;
use zip::write::SimpleFileOptions;
use zip::{ZipArchive, ZipWriter};

const LENGTH: f64 = 0.1;
const RMS: f64 = 2e-5;
const ROLL_OFF: f64 = 5e-3;
const CUT_OFF: f64 = 1e-4;

/// A scene on the surface whose keys are given.
fn scene(surface: &str) -> String {
    let layer = SceneText::new(2, 1e-4, 1e-7).vertical(1e3).phase("duration = 1e-5");
    layer.with(&format!("surface = {{ {surface} }}")).text()
}

/// A self-affine one with `points` points.
fn rough(hurst: f64, points: usize) -> String {
    scene(&format!(
        "kind = 'self_affine', length = {LENGTH}, points = {points}, hurst = {hurst}, rms = {RMS}, \
         roll_off_wavelength = {ROLL_OFF}, cut_off_wavelength = {CUT_OFF}, seed = 3"
    ))
}

/// The root mean square slope, q² times the spectrum summed over its modes.
fn rms_slope(hurst: f64) -> f64 {
    let modes = (1..=(LENGTH / CUT_OFF).round() as usize).map(|m| m as f64);
    let powers = modes.map(|m| (m, (m * ROLL_OFF / LENGTH).max(1.0).powf(-1.0 - 2.0 * hurst)));
    let (heights, slopes) = powers.fold((0.0, 0.0), |(heights, slopes), (m, power)| {
        (heights + power, slopes + power * (TAU * m / LENGTH).powi(2))
    });
    RMS * (slopes / heights).sqrt()
}

/// What `asperity surface --json` says.
fn findings(file: &Path, options: &[&str]) -> Value {
    serde_json::from_str(&run(asperity().arg("surface").arg(file).arg("--json").args(options))).unwrap()
}

fn near(found: &Value, expected: f64, tolerance: f64) {
    assert_relative("surface", found.as_f64().unwrap(), expected, tolerance);
}

fn failure(arguments: &[&str]) -> String {
    let output = asperity().args(arguments).output().unwrap();
    assert!(!output.status.success(), "{arguments:?}");
    String::from_utf8(output.stderr).unwrap()
}

#[test]
fn a_self_affine_surface_is_found_as_it_was_asked_for() {
    let folder = scratch("surface-self-affine");
    let file = folder.join("scene.toml");
    for hurst in [0.4, 0.8, 1.0] {
        fs::write(&file, rough(hurst, 8000)).unwrap();
        let found = findings(&file, &[]);
        assert_eq!((&found["points"], &found["periodic"]), (&8001.into(), &true.into()));
        near(&found["rms_height"], RMS, 1e-9);
        // The spline through eight points a shortest wavelength has less of its slope.
        near(&found["rms_slope"], rms_slope(hurst), 0.005);
        // The bands are a fifth wide; the exponent hangs little on where they end.
        let law = &found["law"];
        assert!((law["hurst"].as_f64().unwrap() - hurst).abs() < 0.01, "{law}");
        near(&law["roll_off_wavelength"], ROLL_OFF, 0.1);
        near(&law["wavelengths"][0], CUT_OFF, 0.25);
        assert_eq!(law["ends"], true);
    }
}

/// `rq` is `rms` by its name on drawings: of a profile and of a map.
#[test]
fn a_self_affine_surface_has_the_rq_that_it_was_given() {
    let file = scratch("surface-rq").join("scene.toml");
    let refused = |from: &str, to: &str| {
        fs::write(&file, rough(0.8, 2000).replace(from, to)).unwrap();
        Scene::load(&file).unwrap_err().to_string()
    };
    assert!(refused("rms = 0.00002", "rms = 2e-5, rq = 2e-5").contains("rms: both are the root mean square height"));
    assert!(refused("rms = 0.00002, ", "").contains("or rq in its place"));
    let isotropic = rough(0.8, 400).replace("= 0.0001, seed = 3", "= 0.001, seed = 3, isotropic = true");
    for text in [rough(0.8, 2000), rough(0.8, 3001), isotropic] {
        fs::write(&file, &text).unwrap();
        let by_rms = Scene::load(&file).unwrap().surface;
        fs::write(&file, text.replace("rms = ", "rq = ")).unwrap();
        let by_rq = Scene::load(&file).unwrap().surface;
        assert_eq!(by_rq, by_rms);
        // The points themselves are scaled to it, whatever waves they leave out: roundings of sums of some thousand.
        let found = findings(&file, &[]);
        near(if by_rq.map().is_some() { &found["map"]["rms_height"] } else { &found["rms_height"] }, RMS, 1e-12);
    }
}

/// What drawings say of a line of waves of 50 µm well below λc = 0.8 mm, printed and as JSON.
#[test]
fn a_line_of_waves_has_the_roughness_of_drawings() {
    let line = scratch("surface-drawing").join("line.csv");
    let rows =
        (0..=10_000).map(|i| format!("{},{}\n", 0.5e-6 * f64::from(i), 2e-6 * (TAU * f64::from(i) / 100.0).sin()));
    fs::write(&line, format!("x [m],z [m]\n{}", rows.collect::<String>())).unwrap();
    let found = &findings(&line, &[])["roughness"];
    // λs = 2.5 µm takes 1.7e-3 of waves of 50 µm, and the line ends where its tilt is not quite 0.
    near(&found["ra"], 4e-6 / PI, 5e-3);
    near(&found["rq"], 2e-6 / f64::sqrt(2.0), 5e-3);
    near(&found["rz"], 4e-6, 5e-3);
    near(&found["rmr"], ((0.05 * PI).cos() - 0.5).acos() / PI, 1e-2);
    assert_eq!((&found["cut_off"], &found["chosen"]), (&8e-4.into(), &"default".into()));
    let text = run(asperity().arg("surface").arg(&line));
    assert_names(&text, "Ra | Rq | Rz | ISO 21920 | Rmr 33. | λc 8e-4 m, the default | λs 2.5e-6 m | 4.0000e-3 m");
    let short = run(asperity().arg("surface").arg(&line).args(["--smooth", "1e-6", "--taper"]));
    assert_names(&short, "Ra | λc 8e-4 m");
}

/// The same profile as a measurement: not known to be periodic, in µm and with decimal commas, and tilted.
#[test]
fn a_measured_surface_is_found_as_it_was_made() {
    let folder = scratch("surface-measured");
    let [source, written, measured] = ["scene.toml", "plain.csv", "measured.txt"].map(|name| folder.join(name));
    fs::write(&source, rough(0.8, 8000)).unwrap();
    run(asperity().arg("surface").arg(&source).arg("--write").arg(&written));
    let surface = Scene::load(&source).unwrap().surface;
    fs::write(&source, scene("kind = 'file', path = 'plain.csv', periodic = true")).unwrap();
    let read = Scene::load(&source).unwrap().surface;
    assert_eq!((read.x(), read.z()), (surface.x(), surface.z()), "what is written is the same to the last bit");

    let mut text = "Profile 1\r\nx [mm];z [µm]\r\n".to_owned();
    for (i, (x, z)) in surface.x().iter().zip(surface.z()).enumerate() {
        let height = if i == 4000 { "***".into() } else { format!("{}", (z + 2e-3 * x) * 1e6).replace('.', ",") };
        text += &format!("{};{height}\r\n", format!("{}", x * 1e3).replace('.', ","));
    }
    fs::write(&measured, text.chars().map(|letter| letter as u8).collect::<Vec<_>>()).unwrap();
    assert!(failure(&["surface", measured.to_str().unwrap()]).contains("measured.txt:4003: z = \"***\""));
    let found = findings(&measured, &["--missing", "fill"]);
    near(&found["length"], LENGTH, 1e-9);
    near(&found["tilt"], 2e-3, 0.02);
    near(&found["rms_height_without_tilt"], RMS, 0.02);
    let level = findings(&measured, &["--missing", "fill", "--tilt", "remove"]);
    near(&level["rms_height"], RMS, 0.02);
    near(&level["rms_slope"], rms_slope(0.8), 0.02);
    // Of 8 bands on the plateau each holds a few modes under a window: some hundredths.
    let hurst = level["law"]["hurst"].as_f64().unwrap();
    assert!((hurst - 0.8).abs() < 0.04, "{}", level["law"]);
    let part = findings(&measured, &["--missing", "fill", "--wavelengths", "2e-4..2e-3"]);
    assert!((part["law"]["hurst"].as_f64().unwrap() - 0.8).abs() < 0.08, "{}", part["law"]);
    assert_eq!(part["law"]["roll_off_wavelength"], Value::Null);
}

#[test]
fn the_analysis_is_printed_and_plotted() {
    let folder = scratch("surface-analysis");
    let [source, svg, png] = ["scene.toml", "rough.svg", "rough.png"].map(|name| folder.join(name));
    fs::write(&source, rough(0.8, 4000)).unwrap();
    let text = run(asperity().arg("surface").arg(&source).arg("-o").arg(&svg));
    for part in
        ["4001, even steps of 2.5000e-5 m", "rms 2.0000e-5 m about the mean", "Hurst exponent 0.799", "roll-off"]
    {
        assert!(text.contains(part), "{part} in\n{text}");
    }
    let drawn = fs::read_to_string(&svg).unwrap();
    assert!(
        drawn.starts_with("<svg") && ["power spectrum", "Hurst exponent 0.80"].iter().all(|part| drawn.contains(part))
    );
    run(asperity().arg("surface").arg(&source).arg("-o").arg(&png));
    assert!(fs::read(&png).unwrap().starts_with(b"\x89PNG"));
    fs::write(&source, scene("kind = 'flat'")).unwrap();
    assert!(run(asperity().arg("surface").arg(&source)).contains("no power law"));
}

#[test]
fn what_cannot_be_analysed_is_refused() {
    let line = scratch("surface-smooth").join("line.csv");
    write_line(line.parent().unwrap());
    let refusal = failure(&["surface", line.to_str().unwrap(), "--smooth", "25"]);
    assert!(refusal.contains("--smooth 25.0: expected at most") && refusal.contains("lengths are in m"), "{refusal}");
    let folder = scratch("surface-refused");
    let [source, profile] = ["scene.toml", "profile.csv"].map(|name| folder.join(name));
    fs::write(&source, scene("kind = 'file', path = 'profile.csv'")).unwrap();
    fs::write(&profile, "0 1\n1 2\n2 1\n").unwrap();
    let [source, profile] = [&source, &profile].map(|path| path.to_str().unwrap());
    assert!(failure(&["surface", source, "--unit", "mm"]).contains("a scene defines how its surface is read"));
    assert!(failure(&["surface", source, "--write", profile]).contains("will not write"));
    assert!(failure(&["surface", source, "-o", profile]).contains("expected a name that ends in .svg or .png"));
    assert!(failure(&["surface", profile, "--unit", "km"]).contains(r#"expected one of "m", "mm", "um", "µm", "nm""#));
    assert!(failure(&["surface", profile, "--wavelengths", "2..1"]).contains("SHORTEST..LONGEST"));
    assert!(failure(&["surface", "none.csv"]).contains("none.csv: cannot be read"));
}

/// An areal measurement of 3 lines with 5 heights that are no round numbers, one of them missing.
fn x3p() -> Vec<u8> {
    let document = "<p:ISO5436_2 xmlns:p='a'><Record1><FeatureType>SUR</FeatureType><Axes>\
                    <CX><AxisType>I</AxisType><Increment>3.3e-7</Increment></CX>\
                    <CY><AxisType>I</AxisType><Increment>1e-6</Increment></CY>\
                    <CZ><AxisType>A</AxisType><DataType>D</DataType></CZ></Axes></Record1>\
                    <Record3><MatrixDimension><SizeX>5</SizeX><SizeY>3</SizeY><SizeZ>1</SizeZ></MatrixDimension>\
                    <DataLink><PointDataLink>bindata/data.bin</PointDataLink></DataLink></Record3></p:ISO5436_2>";
    let height = |i: u32| if i == 12 { f64::NAN } else { 1e-7 * f64::from(i * i).sqrt().sin() };
    let data: Vec<u8> = (0..15).flat_map(|i| height(i).to_le_bytes()).collect();
    let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, bytes) in [("road/main.xml", document.as_bytes()), ("road/bindata/data.bin", &data)] {
        writer.start_file(name, SimpleFileOptions::default()).unwrap();
        writer.write_all(bytes).unwrap();
    }
    writer.finish().unwrap().into_inner()
}

/// An FMU carries the lines that its scene takes, as text; unpacked it is the same scene, under the same GUID.
#[test]
fn lines_of_an_areal_measurement_go_into_the_archive_as_text() {
    let folder = scratch("surface-x3p");
    let [source, fmu, unpacked] = ["scene.toml", "scene.fmu", "unpacked"].map(|name| folder.join(name));
    fs::write(folder.join("road.x3p"), x3p()).unwrap();
    let file = "kind = 'file', path = 'road.x3p'";
    let text = scene("kind = 'file', path = 'road.x3p', line = 3, missing = 'fill', tilt = 'remove'");
    let roughness = format!("layer.mass = 1e-7\nlayer.roughness = {{ {file}, line = 1, unit = 'mm' }}");
    fs::write(&source, text.replace("layer.mass = 1e-7", &roughness)).unwrap();
    let scene = load_scene(&source, &[]).unwrap();
    let carried: Vec<String> = scene.files.iter().map(|file| file.carried_name.display().to_string()).collect();
    assert!(carried[0].starts_with("road.x3p.line-1.") && carried[1].starts_with("road.x3p.line-3."), "{carried:?}");
    // Any file serves as the library here.
    run(asperity().arg("pack").arg(&source).arg("-o").arg(&fmu).arg("--library").arg(&source));

    let mut archive = ZipArchive::new(Cursor::new(fs::read(&fmu).unwrap())).unwrap();
    archive.extract(&unpacked).unwrap();
    assert!(!unpacked.join("resources/road.x3p").exists());
    let carried = Scene::load(&unpacked.join("resources/scene.toml")).unwrap();
    // What is said of the reading differs: it is text now.
    let expected = Scene { notes: carried.notes.clone(), ..scene.clone() };
    assert_eq!(carried, expected);
    let mut description = String::new();
    archive.by_name("modelDescription.xml").unwrap().read_to_string(&mut description).unwrap();
    let carried = Definition::from(carried);
    let sources = Sources::new(&unpacked.join("resources/scene.toml"), &*carried).unwrap();
    assert!(description.contains(&guid(&sources, &carried.variables())));

    let middle = asperity().arg("surface").arg(folder.join("road.x3p")).output().unwrap();
    let said = String::from_utf8(middle.stderr).unwrap();
    assert!(said.contains("an X3P file: line 2 of 3 along x, the middle one"), "{said}");
    assert!(
        failure(&["surface", source.to_str().unwrap(), "--write", folder.join("road.x3p").to_str().unwrap()])
            .contains("will not write")
    );
}

/// Half of the wave of the cut-off is left, 2^-16 of one of a quarter of it: what was taken away has the rest of the
/// slopes.
#[test]
fn a_profile_is_smoothed() {
    let folder = scratch("surface-smoothed");
    let [source, written] = ["waves.csv", "smooth.csv"].map(|name| folder.join(name));
    let waves = |x: f64| 1e-6 * (TAU * x).sin() + 1e-7 * (4.0 * TAU * x).sin();
    let rows = (0..=400).map(|i| format!("{},{}\n", f64::from(i) * 2.5e-6, waves(f64::from(i % 400) / 400.0)));
    fs::write(&source, format!("x [m],z [m]\n{}", rows.collect::<String>())).unwrap();
    let options = ["--periodic", "--smooth", "1e-3", "--write", written.to_str().unwrap()];
    let found = findings(&source, &options);
    let slope =
        |of_long: f64, of_short: f64| 1e-6 * TAU / 1e-3 * ((of_long.powi(2) + (0.4 * of_short).powi(2)) / 2.0).sqrt();
    // 100 points a wave, and the filter's weights end at 7e-7.
    near(&found["rms_slope"], slope(0.5, 0.5_f64.powi(16)), 1e-4);
    near(&found["removed"]["rms_slope"], slope(0.5, 1.0 - 0.5_f64.powi(16)), 1e-4);
    let picture = folder.join("smooth.svg");
    findings(&source, &[&options[..3], &["-o", picture.to_str().unwrap()]].concat());
    let drawn = fs::read_to_string(picture).unwrap();
    assert!(drawn.contains("as read\n") && drawn.contains("smoothed\n"), "both are drawn: {drawn}");
    near(&findings(&written, &["--periodic"])["rms_slope"], slope(0.5, 0.5_f64.powi(16)), 1e-4);
    assert!(failure(&["surface", source.to_str().unwrap(), "--smooth", "0"]).contains("--smooth"));
}

/// A profile that ends, made periodic: by its mirror image, of twice the length, or by a taper, of nine tenths. A scene
/// takes what is written.
#[test]
fn a_profile_is_made_periodic() {
    let folder = scratch("surface-periodic");
    let [road, written, source] = ["road.csv", "periodic.csv", "scene.toml"].map(|name| folder.join(name));
    let rows = (0..=400)
        .map(|i| format!("{},{}\n", f64::from(i) * 2.5e-6, 1e-6 * (0.1 * f64::from(i)).sin() + 1e-8 * f64::from(i)));
    fs::write(&road, format!("x [m],z [m]\n{}", rows.collect::<String>())).unwrap();
    fs::write(&source, scene("kind = 'file', path = 'periodic.csv', periodic = true")).unwrap();
    for (option, points, length) in [("--mirror", 801, 2e-3), ("--taper", 361, 0.9e-3)] {
        let found = findings(&road, &[option, "--write", written.to_str().unwrap()]);
        assert_eq!((&found["points"], &found["periodic"]), (&points.into(), &true.into()), "{option}");
        near(&found["length"], length, 1e-9);
        assert!(Scene::load(&source).unwrap().surface.is_periodic());
        // The heights of before: the taper mixes a tenth of them, of which none is changed by more than the ramp of 3.6
        // µm.
        let (z, before) =
            (crate::common::Table::read(&written).column("z [m]"), crate::common::Table::read(&road).column("z [m]"));
        let same = (0..=360).filter(|&i| z[i] == before[i]).count();
        assert!(same >= 320, "{option}: {same}");
    }
}

/// Files as instruments and people write them, of this project's own making: a sine of 0.3 mm or teeth, scaled by their
/// units, or refused by name.
#[test]
fn files_of_instruments_are_read_or_refused() {
    let folder = root().join("tests/program/data/surface");
    let heights = [
        ("inches.csv", &[][..], 7.0 * 254e-6, 5.08e-6),
        ("feet.csv", &[], 7.0 * 0.3048, 0.2 * 0.0254),
        ("centimetres.csv", &[], 0.07, 2e-3),
        ("two-row.csv", &[], 0.15e-3, 1.361971e-4),
        ("index-first.csv", &[], 0.15e-3, 1.362e-4),
        ("x-y-z.txt", &[], 0.15e-3, 1.362e-4),
        ("footer.csv", &[], 0.15e-3, 1.362e-4),
        ("single.txt", &["--spacing", "0.05mm"], 0.15e-3, 0.1362),
        ("straight.crg", &[], 0.03, 1.362e-3),
        ("gwy-matrix.txt", &[], 0.15e-3, 1.362e-4),
        ("ascii.sdf", &[], 0.15e-3, 1.361971e-4),
    ];
    for (file, options, length, height) in heights {
        let found = findings(&folder.join(file), options);
        // Written with four digits.
        near(&found["length"], length, 1e-3);
        near(&found["peak_to_valley"], height, 1e-3);
    }
    let refused = [
        ("road.erd", "a file of ERD, which is not read"),
        ("single.txt", "spacing = not given: expected the distance of the points in m"),
        ("tiny-x.csv", "points = steps along x down to"),
    ];
    for (file, message) in refused {
        let error = failure(&["surface", folder.join(file).to_str().unwrap()]);
        assert!(error.contains(message), "{file}: {error}");
    }
}

/// A scene takes columns by name, a line of a map and a column with a spacing; an FMU carries text of x and z.
#[test]
fn scenes_choose_columns_and_spacing() {
    let folder = scratch("surface-columns");
    let source = folder.join("scene.toml");
    fs::write(folder.join("road.csv"), "left [mm];x [mm];right [mm]\n1;0;5\n2;1;6\n1;2;5\n").unwrap();
    fs::write(folder.join("column.txt"), "1\n2\n1\n").unwrap();
    let load = |surface: &str| {
        fs::write(&source, scene(surface)).unwrap();
        load_scene(&source, &[])
    };
    let chosen = load("kind = 'file', path = 'road.csv', columns = ['x', 'right']").unwrap();
    assert_eq!((chosen.surface.x(), chosen.surface.z()), (&[0.0, 1e-3, 2e-3][..], &[5e-3, 6e-3, 5e-3][..]));
    let column = load("kind = 'file', path = 'column.txt', spacing = 1e-3, unit = 'um'").unwrap();
    assert_eq!((column.surface.x(), column.surface.z()[1]), (&[0.0, 1e-3, 2e-3][..], 2e-6));
    let refused = load("kind = 'file', path = 'road.csv', columns = ['x', 'y', 'z']").unwrap_err().to_string();
    assert_names(&refused, "surface.columns = ['x', 'y', 'z'] | [\"x\", \"z\"]");
    load("kind = 'file', path = 'road.csv'").unwrap_err();
    load("kind = 'file', path = 'column.txt', spacing = 1e-3").unwrap();
    let described = run(asperity().arg("describe").arg(&source));
    assert_names(&described, "column.txt | column 1 | m, assumed");
}

/// The rubber of a scene on the surface whose keys are given.
fn on_rubber(surface: &str) -> String {
    format!(
        "name = 'r'\nlayer = {{ masses = 4, spacing = 1e-4, thickness = 1e-3, width = 1e-2, clearance = 1e-4 }}\n\
         [material]\ndensity = 1100\npoisson_ratio = 0.49\nequilibrium_modulus = 1e6\n\
         prony = [{{ modulus = 5e6, relaxation_time = 1e-5 }}]\n\
         wlf = {{ c1 = 7.52, c2 = 119.75, reference_temperature = 293.15, temperature = 313.15 }}\n\
         heat = {{ conductivity = 0.25, capacity = 1700.0 }}\n\
         [surface]\n{surface}\n[[excitation]]\nduration = 1e-5\n"
    )
}

/// A line of its own surface, as a file without periods.
fn write_line(folder: &Path) {
    fs::write(folder.join("rough.toml"), rough(0.8, 8000)).unwrap();
    run(asperity().arg("surface").arg(folder.join("rough.toml")).arg("--write").arg(folder.join("line.csv")));
}

#[test]
fn a_line_split_beforehand_is_the_line_split_in_the_scene() {
    let folder = scratch("surface-split");
    write_line(&folder);
    let [line, profile, psd] = ["line.csv", "profile.csv", "psd.csv"].map(|name| folder.join(name));
    let found = {
        let mut command = asperity();
        command.arg("surface").arg(&line).args(["--split", "5e-4", "--json", "--write"]).arg(&profile);
        serde_json::from_str::<Value>(&run(command.arg("--spectrum").arg(&psd))).unwrap()
    };
    let [longest, shortest] = [0, 1].map(|i| found["finer"]["wavelengths"][i].as_f64().unwrap());
    // Where the filter takes 5 %, and twice the step of 12.5 µm.
    assert!((longest / (5e-4 * 5.19873) - 1.0).abs() < 1e-5 && (shortest / 2.5e-5 - 1.0).abs() < 1e-9);
    let read = |surface: &str| {
        fs::write(folder.join("scene.toml"), on_rubber(surface)).unwrap();
        load_scene(&folder.join("scene.toml"), &[]).unwrap()
    };
    let whole = read("kind = 'file'\npath = 'line.csv'\nfine = { split = 5e-4, shortest = 2.5e-5 }");
    let parts = read(&format!(
        "kind = 'file'\npath = 'profile.csv'\n\
         fine = {{ spectrum = 'psd.csv', longest = {longest:.6e}, shortest = {shortest:.6e} }}"
    ));
    assert_eq!(whole.surface, parts.surface);
    let (whole, parts) = (whole.fine_bands(), parts.fine_bands());
    assert!(whole.len() == parts.len() && whole.len() > 16);
    for (one, other) in whole.iter().zip(&parts) {
        // The wavelengths have seven digits.
        assert!((one.gradient_square / other.gradient_square - 1.0).abs() < 1e-5, "{one:?} {other:?}");
    }
    // The gradient of an isotropic surface is √2 times the slope of its lines, but for the ratio at H = 0.8 (1.90 in
    // place of 2), means over bands, and what lies between twice the step and the cut-off of 0.1 mm, nothing.
    let gradient: f64 = whole.iter().map(|band| band.gradient_square).sum::<f64>().sqrt();
    let of_line = found["removed"]["rms_slope"].as_f64().unwrap();
    assert!((1.2..1.6).contains(&(gradient / of_line)), "{gradient} {of_line}");
}

#[test]
fn a_split_that_cannot_be_is_refused() {
    let folder = scratch("surface-no-split");
    write_line(&folder);
    let line = folder.join("line.csv").display().to_string();
    let refused = failure(&["surface", &line, "--split", "0.03"]);
    assert!(refused.contains("--split 0.03: expected at most 0.025 m, a quarter of the line"), "{refused}");
    assert!(failure(&["surface", &line, "--split", "1e-3", "--smooth", "1e-3"]).contains("cannot be used with"));
    assert!(failure(&["surface", &line, "--spectrum", "psd.csv"]).contains("--split"));
}

/// The law of the line goes on below its resolution, and that is said; a table without units, too.
#[test]
fn what_is_assumed_of_the_finer_waves_is_said() {
    let folder = scratch("surface-finer-said");
    write_line(&folder);
    let said = |surface: &str, settings: &[&str]| {
        fs::write(folder.join("scene.toml"), on_rubber(surface)).unwrap();
        let mut command = asperity();
        command.arg("simulate").arg(folder.join("scene.toml")).arg("-o").arg(folder.join("out.csv"));
        settings.iter().for_each(|setting| _ = command.args(["--set", setting]));
        let output = command.output().unwrap();
        assert!(output.status.success(), "{output:?}");
        String::from_utf8(output.stderr).unwrap()
    };
    let split = "kind = 'file'\npath = 'line.csv'\nfine = { split = 5e-4, shortest = 1e-5 }";
    let text = said(split, &["surface.fine.shortest=1.25e-5", "material.heat.share=0.5", "surface.fine.softening=0.5"]);
    let warning =
        "the line resolves waves down to 2.500e-5 m; from there to 1.250e-5 m the law of its last decade goes on";
    assert!(text.contains(warning), "{text}");
    fs::write(folder.join("psd.csv"), "1e3,1e-18\n1e6,1e-28\n").unwrap();
    let table = "kind = 'flat'\nfine = { spectrum = 'psd.csv', longest = 1e-3, shortest = 1e-5 }";
    let text = said(table, &["surface.fine.longest=2e-3"]);
    assert_names(&text, "psd.csv | column 1 | 1/m, assumed | column 2 | m⁴, assumed");
}

/// An FMU carries the files of the roughness below the profile, and has its numbers and those of heat as parameters.
#[test]
fn an_fmu_has_the_spectrum_and_the_softening() {
    let folder = scratch("surface-fine-fmu");
    let [source, fmu, unpacked] = ["scene.toml", "scene.fmu", "unpacked"].map(|name| folder.join(name));
    fs::write(folder.join("psd.csv"), "q [1/mm],C [mm^4]\n1,1e-6\n1000,1e-16\n").unwrap();
    fs::write(folder.join("strain.csv"), "strain [%],storage,loss\n0.1,1,1\n50,0.3,0.6\n").unwrap();
    let fine = "spectrum = 'psd.csv', longest = 1e-3, shortest = 1e-5, softening = 'strain.csv'";
    fs::write(&source, on_rubber(&format!("kind = 'flat'\nfine = {{ {fine} }}"))).unwrap();
    let scene = load_scene(&source, &[]).unwrap();
    assert_eq!(scene.files.iter().map(|file| &file.path).collect::<Vec<_>>(), ["psd.csv", "strain.csv"].map(Path::new));
    // Any file serves as the library here.
    run(asperity().arg("pack").arg(&source).arg("-o").arg(&fmu).arg("--library").arg(&source));
    let mut archive = ZipArchive::new(Cursor::new(fs::read(&fmu).unwrap())).unwrap();
    archive.extract(&unpacked).unwrap();
    let carried = Scene::load(&unpacked.join("resources/scene.toml")).unwrap();
    assert_eq!(carried, Scene { notes: carried.notes.clone(), warnings: carried.warnings.clone(), ..scene });
    let mut description = String::new();
    archive.by_name("modelDescription.xml").unwrap().read_to_string(&mut description).unwrap();
    for name in ["surface.fine.longest", "surface.fine.shortest", "surface.fine.creep_speed", "material.heat.share"] {
        assert!(description.contains(&format!("name=\"{name}\"")), "{name}");
    }
    assert!(!description.contains("surface.fine.softening") && description.contains("J/(kg.K)"));
}

/// Heights, gradient, spectrum and exponents of an isotropic map of the program's own; its matrix, mirrored, is a scene's
/// periodic map.
#[test]
fn a_map_is_analysed_and_made_periodic() {
    let folder = scratch("surface-map");
    let [source, psd, matrix] = ["scene.toml", "psd.csv", "map.csv"].map(|name| folder.join(name));
    let law = "kind = 'self_affine', isotropic = true, length = 4e-3, size_y = 2e-3, points = 256, hurst = 0.7, \
               rms = 2e-5, roll_off_wavelength = 1e-3, cut_off_wavelength = 6.25e-5, seed = 5";
    fs::write(&source, scene(law)).unwrap();
    let found = findings(&source, &["--spectrum", psd.to_str().unwrap(), "--wavelengths", "1.25e-4..1e-3"]);
    let map = &found["map"];
    assert_eq!((&map["points"][0], &map["points"][1], &map["lengths"][1]), (&256.into(), &128.into(), &2e-3.into()));
    near(&map["rms_height"], 2e-5, 1e-9);
    // Rings hold hundreds of modes, each with the power asked for: C falls by q^-3.4.
    let table = crate::common::Table::read(&psd);
    let (q, density) = (table.column("q [1/m]"), table.column("C [m^4]"));
    let at = |wavelength: f64| q.iter().position(|q| *q > TAU / wavelength).unwrap();
    let (i, j) = (at(5e-4), at(1e-4));
    let slope = (density[j] / density[i]).ln() / (q[j] / q[i]).ln();
    assert!((slope + 3.4).abs() < 0.1, "{slope}");
    // Σ q² C of the law, over all modes: 4 points of the shortest wave, whose slope a spline has to 5 %.
    let (mut heights, mut gradients) = (0.0, 0.0);
    for (m, n) in (-64..=64).flat_map(|m| (-32..=32).map(move |n| (m, n))).filter(|modes| *modes != (0, 0)) {
        let waves = (f64::from(m) / 4e-3).hypot(f64::from(n) / 2e-3);
        let power = if waves < 1.6001e4 { (waves * 1e-3).max(1.0).powf(-3.4) } else { 0.0 };
        heights += power;
        gradients += power * (TAU * waves).powi(2);
    }
    let modes = f64::sqrt(gradients / heights);
    near(&map["rms_gradient"], 2e-5 * modes, 5e-2);
    // Waves across a line end at the cut-off too, so that its spectrum lacks 20 % at 0.125 mm; C itself in place of the
    // lines' spectrum would give half more.
    for law in map["laws"].as_array().unwrap() {
        assert!((law["hurst"].as_f64().unwrap() - 0.7).abs() < 0.2, "{law}");
    }

    fs::write(&matrix, "1e-6,2e-6,4e-6\n0,1e-6,1e-6\n3e-6,3e-6,0\n").unwrap();
    let mirrored = folder.join("mirrored.csv");
    let options = ["--spacing", "1e-5,2e-5", "--mirror", "--write", mirrored.to_str().unwrap()];
    let found = findings(&matrix, &options);
    assert_eq!((&found["map"]["points"], &found["periodic"]), (&serde_json::json!([4, 4]), &true.into()));
    fs::write(&source, scene("kind = 'file', path = 'mirrored.csv', spacing = [1e-5, 2e-5], periodic = true")).unwrap();
    let loaded = load_scene(&source, &[]).unwrap();
    let map = loaded.surface.map().unwrap();
    assert_eq!((map.nx(), map.ny()), (4, 4));
    // The plane is out, and the mirror image goes back.
    assert!(map.mean().abs() < 1e-6 && (map.line(1)[1] - map.line(1)[3]).abs() < 1e-18);
    assert!(map.line(1).iter().zip(map.line(3)).all(|(a, b)| a == b));
    let profile = ["--spacing", "1e-5,2e-5", "--line", "1", "--mirror"];
    assert_eq!(findings(&matrix, &profile)["points"], 5);
}
