//! From measured moduli to a compound and back: `asperity fit`, and `asperity material` on the scene that it is for.

use std::f64::consts::TAU;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Output;

use crate::common::random::Random;
use crate::common::scenes::SceneText;
use crate::common::{Table, asperity, root, run, scratch};
use asperity::scene::{Material, PronyTerm, Scene};

/// A tread-like rubber, one term a decade from 1e-13 s on.
const SIXTEEN: [f64; 16] =
    [1538.0, 888.0, 824.0, 495.0, 201.0, 76.3, 31.9, 14.8, 8.12, 4.65, 3.16, 2.26, 1.67, 1.42, 0.969, 1.26];
const WLF: [f64; 3] = [7.52, 119.75, 293.15];

fn compound(equilibrium_modulus: f64, terms: impl IntoIterator<Item = (f64, f64)>) -> Material {
    let term = |(relaxation_time, modulus)| PronyTerm { relaxation_time, modulus };
    let prony = terms.into_iter().map(term).collect();
    Material {
        density: 1100.0,
        poisson_ratio: 0.49,
        equilibrium_modulus,
        viscosity: None,
        prony,
        wlf: None,
        heat: None,
    }
}

fn sixteen() -> Material {
    compound(4.44e6, (-13..).map(|exponent| 10.0_f64.powi(exponent)).zip(SIXTEEN.map(|modulus| 1e6 * modulus)))
}

fn three() -> Material {
    compound(2e6, [(1.3e-5, 5e6), (3.1e-3, 3e6), (0.7, 1e6)])
}

/// Frequencies in Hz from 10^low to 10^high, five a decade.
fn frequencies(low: i32, high: i32) -> Vec<f64> {
    (5 * low..=5 * high).map(|i| 10.0_f64.powf(f64::from(i) / 5.0)).collect()
}

/// A table of moduli; each of them times what `factor` gives.
fn write_moduli(path: &Path, compound: &Material, frequencies: &[f64], mut factor: impl FnMut() -> f64) {
    let mut text = String::from("frequency [Hz],E' [MPa],E'' (Pa)\n");
    for frequency in frequencies {
        let (storage, loss) = compound.complex_modulus(TAU * frequency);
        text += &format!("{frequency:e},{:e},{:e}\n", factor() * storage / 1e6, factor() * loss);
    }
    fs::write(path, text).unwrap();
}

/// 1 + sigma times a normal deviate, the same each time: G. Box's and M. Muller's transformation.
fn noise(sigma: f64) -> impl FnMut() -> f64 {
    let mut random = Random::new(1);
    move || 1.0 + sigma * (-2.0 * (1.0 - random.unit()).ln()).sqrt() * (TAU * random.unit()).cos()
}

fn fit(data: &Path, options: &[&str]) -> (PathBuf, Output) {
    let output = data.with_extension("fitted.csv");
    let result = asperity().arg("fit").arg(data).arg("-o").arg(&output).args(options).output().unwrap();
    (output, result)
}

/// A fit that has to succeed: its file and what it printed.
fn fitted(data: &Path, options: &[&str]) -> (PathBuf, String) {
    let (output, result) = fit(data, options);
    assert!(result.status.success(), "{}", String::from_utf8_lossy(&result.stderr));
    (output, String::from_utf8(result.stdout).unwrap())
}

/// A scene with the lines that a fit has printed.
fn scene_of(folder: &Path, printed: &str) -> PathBuf {
    let (_, material) = printed.split_once("[material]").unwrap();
    let scene = folder.join("fitted.toml");
    let layer = SceneText::new(1, 1e-4, 0.0).without("layer.mass").with("layer.thickness = 1e-3\nlayer.width = 1e-2");
    let text = format!("{}[material]\ndensity = 1100\npoisson_ratio = 0.49{material}", layer.text());
    fs::write(&scene, text).unwrap();
    scene
}

/// The compound that a fit has found, read as a scene reads it.
fn found(data: &Path, options: &[&str]) -> Material {
    let (_, printed) = fitted(data, options);
    Scene::load(&scene_of(data.parent().unwrap(), &printed)).unwrap().material.unwrap()
}

/// The largest relative difference of E' and E'' at some frequencies (Hz).
fn largest(found: &Material, known: &Material, frequencies: &[f64]) -> f64 {
    let differences = frequencies.iter().flat_map(|frequency| {
        let ((a, b), (c, d)) = (found.complex_modulus(TAU * frequency), known.complex_modulus(TAU * frequency));
        [(a / c - 1.0).abs(), (b / d - 1.0).abs()]
    });
    differences.fold(0.0, f64::max)
}

#[test]
fn moduli_of_known_terms_come_back() {
    let folder = scratch("fit-known");
    for (known, low, high) in [(three(), -4, 6), (sixteen(), -5, 15), (sixteen(), -2, 7)] {
        let (data, frequencies) = (folder.join("dma.csv"), frequencies(low, high));
        write_moduli(&data, &known, &frequencies, || 1.0);
        let found = found(&data, &["--fit-error", "1e-4"]);
        let difference = largest(&found, &known, &frequencies);
        assert!(difference < 1e-3, "{difference:e}");
        assert!(found.prony.len() <= known.prony.len());
    }
}

#[test]
fn a_compound_of_three_terms_is_fitted_by_three() {
    let folder = scratch("fit-three");
    let data = folder.join("dma.csv");
    write_moduli(&data, &three(), &frequencies(-4, 6), || 1.0);
    assert_eq!(found(&data, &[]).prony.len(), 3);
}

#[test]
fn noise_is_reported_and_its_mean_is_met() {
    let folder = scratch("fit-noise");
    let (data, frequencies) = (folder.join("dma.csv"), frequencies(-5, 15));
    write_moduli(&data, &sixteen(), &frequencies, noise(0.05));
    let (output, result) = fit(&data, &["--fit-error", "0.02"]);
    assert_eq!(result.status.code(), Some(3), "written, but to be looked at");
    let message = String::from_utf8(result.stderr).unwrap();
    assert!(
        message.contains("the error asked for, 2 %, cannot be reached") && message.contains("fitted.csv"),
        "{message}"
    );
    assert!(message.contains("the data scatter too much"), "{message}");
    assert!(output.exists() && output.with_extension("svg").exists(), "what was found is there all the same");
    let scene = scene_of(&folder, &String::from_utf8(result.stdout).unwrap());
    let best = Scene::load(&scene).unwrap().material.unwrap();
    // Some 33 unknowns for 202 figures: their own share of the noise is 5 % √(33/202) = 2 %, at the worst some times as
    // much.
    assert!(largest(&best, &sixteen(), &frequencies) < 0.1, "{}", largest(&best, &sixteen(), &frequencies));
    let enough = found(&data, &["--fit-error", "0.06"]);
    assert!(enough.prony.len() <= 16, "{}", enough.prony.len());
}

/// Two decades at each of thirteen temperatures, in degrees, with decimal commas and in Latin-1, make one curve.
#[test]
fn temperatures_make_one_curve() {
    let folder = scratch("fit-temperatures");
    let data = folder.join("dma.csv");
    let mut text = String::from("f [Hz];E' [MPa];tan(d);Temperature [°C]\r\n");
    for celsius in (-40..=80).step_by(10) {
        let above = f64::from(celsius) + 273.15 - WLF[2];
        let shift = 10.0_f64.powf(-WLF[0] * above / (WLF[1] + above));
        for frequency in frequencies(-1, 1) {
            let (storage, loss) = sixteen().complex_modulus(TAU * shift * frequency);
            let row = format!("{frequency:e};{:e};{:e};{celsius}\r\n", storage / 1e6, loss / storage);
            text += &row.replace('.', ",");
        }
    }
    let latin: Vec<u8> = text.chars().map(|letter| u8::try_from(u32::from(letter)).unwrap()).collect();
    fs::write(&data, latin).unwrap();
    let (_, printed) = fitted(&data, &["--wlf", "7.52,119.75,293.15", "--fit-error", "1e-4"]);
    assert!(printed.contains("233.15 to 353.15 K, shifted to 293.15 K"), "{printed}");
    let scene = Scene::load(&scene_of(&folder, &printed)).unwrap();
    let found = scene.material.unwrap();
    assert_eq!(found.wlf.unwrap().temperature, WLF[2]);
    let difference = largest(&found, &sixteen(), &frequencies(-3, 8));
    assert!(difference < 1e-3, "{difference:e}");
    // Wrong constants are told from scatter.
    let (_, wrong) = fit(&data, &["--wlf", "12,119.75,293.15"]);
    let message = String::from_utf8(wrong.stderr).unwrap();
    assert_eq!(wrong.status.code(), Some(3));
    assert!(message.contains("the WLF constants do not put the temperatures together"), "{message}");
}

/// Six temperatures 15 K apart, three decades of frequency each, without constants: the law that made them comes back,
/// and so does the compound.
#[test]
fn constants_are_found_where_curves_overlap() {
    let folder = scratch("fit-superposition");
    let data = folder.join("dma.csv");
    const CELSIUS: [i32; 6] = [-25, -10, 5, 20, 35, 50];
    let log_factor = |celsius: i32| {
        let above = f64::from(celsius) + 273.15 - WLF[2];
        -WLF[0] * above / (WLF[1] + above)
    };
    let write = |scatter: f64| {
        let (mut factor, mut text) =
            (noise(scatter), String::from("Temperature (°C),Frequency (Hz),E' (MPa),E'' (MPa)\n"));
        for celsius in CELSIUS {
            for frequency in frequencies(-1, 2) {
                let (storage, loss) = sixteen().complex_modulus(TAU * 10.0_f64.powf(log_factor(celsius)) * frequency);
                let [storage, loss] = [storage, loss].map(|modulus| 1e-6 * factor() * modulus);
                text += &format!("{celsius},{frequency:e},{storage:e},{loss:e}\n");
            }
        }
        fs::write(&data, text).unwrap();
    };
    // The reduced frequencies of the rows, Hz.
    let range = frequencies(-2, 6);
    // A factor is known as well as moduli that rise by a fifth a decade of frequency tell it: of one per cent of
    // scatter in 32 figures a temperature, five steps from the coldest to the hottest, some per cent are left.
    for (scatter, error, most) in [(0.01, "0.0105", 0.08), (0.0, "1e-3", 0.03)] {
        write(scatter);
        let (_, result) = fit(&data, &["--fit-error", error]);
        let printed = String::from_utf8(result.stdout).unwrap();
        let found = Scene::load(&scene_of(&folder, &printed)).unwrap().material.unwrap();
        let wlf = found.wlf.unwrap();
        assert_eq!(wlf.reference_temperature, 293.15);
        for celsius in CELSIUS {
            let known = 10.0_f64.powf(log_factor(celsius));
            let temperature = f64::from(celsius) + 273.15;
            let factor = asperity::scene::Wlf { temperature, ..wlf }.shift_factor();
            assert!((factor / known - 1.0).abs() < most, "{scatter}, {celsius} °C: {factor} for {known}");
        }
        let difference = largest(&found, &sixteen(), &range);
        assert!(difference < 0.03, "{scatter}: {difference:e}");
    }
    let picture = fs::read_to_string(data.with_extension("fitted.svg")).unwrap();
    assert!(picture.contains("shifted to 293.15 K"));
    // The same by a table of factors.
    let shifts = folder.join("shifts.csv");
    let table = CELSIUS.map(|celsius| format!("{celsius};{}\n", log_factor(celsius))).concat();
    fs::write(&shifts, format!("T [°C];log a_T\n{table}")).unwrap();
    let (_, printed) = fitted(&data, &["--shifts", shifts.to_str().unwrap(), "--fit-error", "1e-3"]);
    assert!(printed.contains("wlf = { c1 = 7.52, c2 = 119.75, reference_temperature = 293.15"), "{printed}");
}

/// Moduli that change with temperature beside their shift: `--vertical` takes that out, by a column, by the density, or by
/// the table of shifts.
#[test]
fn vertical_shifts_are_taken_out() {
    let folder = scratch("fit-vertical");
    let [data, shifts] = ["dma.csv", "shifts.csv"].map(|name| folder.join(name));
    let kelvins = [273.15, 293.15, 313.15, 333.15];
    let shift = |kelvin: f64| 10.0_f64.powf(-WLF[0] * (kelvin - WLF[2]) / (WLF[1] + kelvin - WLF[2]));
    // Of natural rubber, from 0.94 to 1.11.
    let b = |kelvin: f64| kelvin / WLF[2] / (1.0 + 6.6e-4 * (kelvin - WLF[2]));
    let write = |name: &str, column: fn(f64) -> f64| {
        let mut text = format!("T [K],f [Hz],E' [Pa],E'' [Pa]{name}\n");
        for kelvin in kelvins {
            for frequency in frequencies(-1, 2) {
                let (storage, loss) = sixteen().complex_modulus(TAU * shift(kelvin) * frequency);
                let column = if name.is_empty() { String::new() } else { format!(",{:e}", column(b(kelvin))) };
                text += &format!("{kelvin},{frequency:e},{:e},{:e}{column}\n", b(kelvin) * storage, b(kelvin) * loss);
            }
        }
        fs::write(&data, text).unwrap();
    };
    let row = |kelvin: f64| format!("{kelvin},{:e},{:e}\n", shift(kelvin), b(kelvin));
    fs::write(&shifts, format!("T [K],a_T,b_T\n{}", kelvins.map(row).concat())).unwrap();
    let difference = |options: &[&str]| {
        let (_, result) = fit(&data, &[options, &["--fit-error", "1e-3"]].concat());
        let printed = String::from_utf8(result.stdout).unwrap();
        let found = Scene::load(&scene_of(&folder, &printed)).unwrap().material.unwrap();
        (largest(&found, &sixteen(), &frequencies(-1, 2)), String::from_utf8(result.stderr).unwrap())
    };
    let wlf = ["--wlf", "7.52,119.75,293.15"];
    let by_table = ["--shifts", shifts.to_str().unwrap()];
    for (name, column, options) in [
        ("", (|b| b) as fn(f64) -> f64, &[wlf[0], wlf[1], "--vertical", "density"][..]),
        (",b_T", |b| b, &wlf),
        (",b_T", |b| 1.0 / b, &[wlf[0], wlf[1], "--vertical", "multiply"]),
        ("", |b| b, &by_table),
    ] {
        write(name, column);
        let (off, notes) = difference(options);
        assert!(off < 5e-3 && notes.contains("moduli of other temperatures are"), "{options:?}: {off:e} {notes}");
    }
    write("", |b| b);
    let (off, _) = difference(&wlf);
    assert!(off > 0.02, "{off:e}");
}

/// Files as instruments write them, of this project's own making: what is read is on the picture, what is missing is
/// said.
#[test]
fn files_of_instruments_are_read_or_refused_with_what_is_missing() {
    let folder = root().join("tests/program/data/fit");
    let output = scratch("fit-instruments").join("out.csv");
    let run = |file: &str, options: &[&str]| {
        asperity().arg("fit").arg(folder.join(file)).arg("-o").arg(&output).args(options).output().unwrap()
    };
    let read = [
        ("comment-header.txt", &[][..], "3 rows, 0.1 Hz to 10 Hz"),
        ("extra-columns.csv", &[], "4 rows, 0.1 Hz to 100 Hz"),
        ("pyvisco-style.csv", &[], "6 rows, 0.1 Hz to 10 Hz, 293.15 to 313.25 K"),
        ("relaxation.csv", &[], "4 rows, 0.01 s to 10 s"),
        ("reptate-style.tts", &[], "3 rows, 0.1 rad/s to 10 rad/s"),
        ("rheocompass-style.csv", &[], "3 rows, 1 rad/s to 100 rad/s"),
        ("trios-lims-style.txt", &[], "6 rows, 1 rad/s to 100 rad/s, 293.15 to 313.15 K"),
        ("wide.csv", &["--unit", "temperature=°C"], "6 rows, 0.1 Hz to 10 Hz, 293.15 to 313.15 K"),
        ("workbook.xlsx", &[], "3 rows, 0.1 Hz to 10 Hz"),
    ];
    for (file, options, expected) in read {
        let result = run(file, options);
        let printed = String::from_utf8_lossy(&result.stdout).into_owned();
        assert!(printed.contains(expected), "{file}: {printed}{}", String::from_utf8_lossy(&result.stderr));
    }
    let message = String::from_utf8(run("wide.csv", &[]).stderr).unwrap();
    assert!(message.contains("expected a unit of temperature"), "{message}");
}

#[test]
fn the_picture_holds_data_and_fit() {
    let folder = scratch("fit-picture");
    let data = folder.join("dma.csv");
    write_moduli(&data, &three(), &frequencies(-4, 6), || 1.0);
    let (output, printed) = fitted(&data, &[]);
    let picture = fs::read_to_string(output.with_extension("svg")).unwrap().replace("&apos;", "'");
    for name in
        ["E' measured", "E' fitted", "E'' measured", "E'' fitted", "tan δ measured", "tan δ fitted", "frequency in Hz"]
    {
        assert!(picture.contains(name), "{name}");
    }
    // 51 rows of three quantities, and a ring for each in the legend.
    assert_eq!(picture.matches("<circle").count(), 3 * 51 + 3);
    assert!(
        printed.contains("E''") && printed.contains("tan delta") && printed.contains("Terms       3, from"),
        "{printed}"
    );
    fitted(&data, &["--plot", folder.join("dma.png").to_str().unwrap()]);
    assert!(fs::read(folder.join("dma.png")).unwrap().starts_with(b"\x89PNG"));
}

#[test]
fn the_file_says_what_it_was_fitted_to() {
    let folder = scratch("fit-file");
    let data = folder.join("dma.csv");
    write_moduli(&data, &three(), &frequencies(-4, 6), || 1.0);
    let (output, _) = fitted(&data, &["--viscosity", "--fit-error", "0.01"]);
    let text = fs::read_to_string(output).unwrap();
    for line in
        ["# equilibrium_modulus = ", "# viscosity = 0 Pa s", "# source = dma.csv", "# data = 51 rows", "# error = "]
    {
        assert!(text.contains(line), "{line}: {text}");
    }
    assert!(text.contains("# options = --fit-error 0.01 --viscosity\n"), "{text}");
    assert_eq!(text.lines().find(|line| !line.starts_with('#')), Some("relaxation_time [s],modulus [Pa]"));
}

#[test]
fn what_is_read_is_not_written_over_and_what_is_wrong_is_refused() {
    let folder = scratch("fit-wrong");
    let data = folder.join("dma.csv");
    write_moduli(&data, &three(), &[1.0, 10.0], || 1.0);
    let refused = |output: &Path, options: &[&str]| {
        let result = asperity().arg("fit").arg(&data).arg("-o").arg(output).args(options).output().unwrap();
        assert!(!result.status.success() && result.stdout.is_empty());
        String::from_utf8(result.stderr).unwrap()
    };
    assert!(refused(&data, &[]).contains("will not write"));
    let picture = folder.join("out.svg");
    assert!(refused(&picture, &["--plot", picture.to_str().unwrap()]).contains("will not write"));
    let output = folder.join("out.csv");
    assert!(refused(&output, &["--fit-error", "0"]).contains("a number from 1e-12 to 0.5"));
    assert!(refused(&output, &["--wlf", "1,2"]).contains("expected C1,C2,TREF"));
    fs::write(&data, "f [Hz],E' [MPa],E'' [MPa]\n1,2,-3\n").unwrap();
    let message = refused(&output, &[]);
    assert!(
        message.contains("dma.csv:2: column 3 \"E'' [MPa]\" = \"-3\": expected a number from 1e-30 to 1e30 in Pa"),
        "{message}"
    );
    assert!(!output.exists());
}

/// What `material` writes, `fit` reads: the terms are those of the scene, moved as its temperature says.
#[test]
fn the_moduli_of_a_scene_are_those_of_its_terms() {
    let folder = scratch("fit-material");
    let layer = "name = 'a'\nlayer = { masses = 1, spacing = 1e-4, thickness = 1e-3, width = 1e-2 }\n";
    let wlf = "wlf = { c1 = 7.52, c2 = 119.75, reference_temperature = 293.15, temperature = 313.15 }";
    let prony = "prony = [{ modulus = 6e6, relaxation_time = 1e-2 }]";
    let material =
        format!("[material]\ndensity = 1100\npoisson_ratio = 0.49\nequilibrium_modulus = 2e6\n{prony}\n{wlf}\n");
    let scene = folder.join("a.toml");
    fs::write(&scene, format!("{layer}surface = {{ kind = 'flat' }}\n{material}")).unwrap();
    let (table, picture) = (folder.join("moduli.csv"), folder.join("moduli.svg"));
    let printed = run(asperity().arg("material").arg(&scene).arg("-o").arg(&table).arg("-o").arg(&picture));
    // a_T = 10^(-7.52·20/139.75) = 0.083906; tan δ at most 3/4 at ωτ = 1/2: ω = 50/a_T = 595.9 rad/s.
    for part in ["313.15 K", "a_T = 0.083906", "equilibrium E 2e6 Pa", "glassy E 8e6 Pa", "tan δ at most 0.75 at 595.9"]
    {
        assert!(printed.contains(part), "{part}: {printed}");
    }
    let drawn = fs::read_to_string(&picture).unwrap().replace("&apos;", "'");
    assert!(drawn.contains("angular frequency in rad/s") && drawn.contains("E''") && drawn.contains("tan δ"));
    let (_, fit) = fitted(&table, &[]);
    let found = Scene::load(&scene_of(&folder, &fit)).unwrap().material.unwrap();
    let shift = 10.0_f64.powf(-7.52 * 20.0 / 139.75);
    assert_eq!(found.prony.len(), 1);
    // Digits that the fit's file has, some more than its error.
    assert!((found.prony[0].relaxation_time / (1e-2 * shift) - 1.0).abs() < 1e-9, "{found:?}");
    let cold = run(asperity().arg("material").arg(&scene).args(["--temperature", "293.15", "-o"]).arg(&table));
    assert!(cold.contains("a_T = 1 ") && cold.contains("at most 0.75 at 50 rad/s"), "{cold}");
}

#[test]
fn links_have_stiffnesses_instead() {
    let folder = scratch("fit-links");
    let scene = root().join("tests/reference/sinusoid.toml");
    let table = folder.join("links.csv");
    let material =
        |options: &[&str]| asperity().arg("material").arg(&scene).arg("-o").arg(&table).args(options).output().unwrap();
    let printed = String::from_utf8(material(&["--frequencies", "10..1000"]).stdout).unwrap();
    let known = Scene::load(&scene).unwrap();
    let link = known.layer.links[asperity::scene::LinkKind::Vertical].as_ref().unwrap();
    assert!(printed.contains("vertical") && printed.contains("equilibrium K"), "{printed}");
    let table = Table::read(&table);
    let [frequency, storage, loss] = ["omega", "vertical K'", "vertical K''"].map(|name| table.number(0, name));
    let of = |j: &asperity::scene::MaxwellElement| {
        let x = frequency * j.relaxation_time;
        (j.stiffness * x * x / (1.0 + x * x), j.stiffness * x / (1.0 + x * x))
    };
    let (real, imaginary) = link.maxwell.iter().map(of).fold((0.0, 0.0), |a, b| (a.0 + b.0, a.1 + b.1));
    let real = real + link.stiffness.unwrap_or(0.0);
    let imaginary = imaginary + frequency * link.damping.unwrap_or(0.0);
    // The same sums in another order of rounding.
    assert!((frequency - 10.0).abs() < 1e-14 && (storage / real - 1.0).abs() < 1e-14);
    assert!((loss / imaginary - 1.0).abs() < 1e-13);
    let refused = material(&["--temperature", "300"]);
    let message = String::from_utf8(refused.stderr).unwrap();
    assert!(message.contains("the scene has no material.wlf"), "{message}");
}

/// E'' of a factor 1.3 contradicts E': said by decades; one of both alone is fitted; b_T of a table divides its moduli.
#[test]
fn moduli_that_contradict_each_other_are_named() {
    let folder = scratch("fit-contradiction");
    let terms: Vec<(f64, f64)> = (-4..10).map(|i| (10_f64.powi(-i), 1e6 * 10_f64.powf(f64::from(i) / 5.0))).collect();
    let mut table = String::from("omega [rad/s],E' [Pa],E'' [Pa],T [K],b_T\n");
    for (kelvin, b) in [(293.15, 1.0), (313.15, 1.25)] {
        for i in -16..=48 {
            let omega = 10_f64.powf(f64::from(i) / 8.0);
            let (mut storage, mut loss) = (1e6, 0.0);
            for (tau, modulus) in &terms {
                let x = omega * tau;
                (storage, loss) = (storage + modulus * x * x / (1.0 + x * x), loss + modulus * x / (1.0 + x * x));
            }
            table += &format!("{omega:e},{:e},{:e},{kelvin},{b}\n", b * storage, 1.3 * b * loss);
        }
    }
    let data = folder.join("both.csv");
    fs::write(&data, table).unwrap();
    let fit = |options: &[&str]| {
        asperity().arg("fit").arg(&data).arg("-o").arg(folder.join("out.csv")).args(options).output().unwrap()
    };
    // The same curve at both temperatures, once moduli are divided: a_T = 1.
    let wlf = ["--wlf", "1e-9,100,293.15"];
    let output = fit(&wlf);
    let (found, said) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert_eq!(output.status.code(), Some(3), "{said}");
    assert!(found.contains("10 rad/s      16     1.30"), "{found}");
    assert!(said.contains("E' and E'' contradict each other") && said.contains("b_T"), "{said}");
    let alone = fit(&[&wlf[..], &["--weight", "loss"]].concat());
    assert_eq!(alone.status.code(), Some(0), "{}", String::from_utf8_lossy(&alone.stderr));
    let whole = fit(&[&wlf[..], &["--weight", "loss", "--vertical", "none"]].concat());
    assert_eq!(whole.status.code(), Some(3), "25 % between the temperatures remain");
}
