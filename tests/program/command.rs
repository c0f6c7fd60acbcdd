//! The program on its command line: result files, messages, exit codes, pictures.

use std::fs;
use std::path::{Path, PathBuf};

use crate::common::scenes::SceneText;
use crate::common::{Table, asperity, assert_names, root, run, scratch, simulate};

fn reference(name: &str) -> PathBuf {
    root().join(format!("tests/reference/{name}.toml"))
}

/// The scene of tests/reference/sinusoid.toml, changed.
fn changed(folder: &Path, from: &str, to: &str) -> PathBuf {
    let text = fs::read_to_string(reference("sinusoid")).unwrap();
    assert!(text.contains(from), "{from}");
    let scene = folder.join("scene.toml");
    fs::write(&scene, text.replacen(from, to, 1)).unwrap();
    scene
}

/// What the program says on standard error as it fails.
fn failure(arguments: &[&str]) -> String {
    let output = asperity().args(arguments).output().unwrap();
    assert_eq!(output.status.code(), Some(1), "{arguments:?}");
    assert!(output.stdout.is_empty(), "{arguments:?}");
    String::from_utf8(output.stderr).unwrap()
}

fn warnings(scene: &Path, folder: &Path) -> String {
    let output = asperity().arg("simulate").arg(scene).arg("-o").arg(folder.join("out.csv")).output().unwrap();
    assert!(output.status.success());
    String::from_utf8(output.stderr).unwrap()
}

#[test]
fn a_result_file_has_the_variables_in_their_order_and_even_rows() {
    let table = simulate(&reference("sinusoid"), &scratch("program-rows"), &["--rows", "4"]);
    assert_eq!(table.names()[..7], ["time", "u", "w", "F_x", "F_z", "P_diss", "E_diss"]);
    assert!(table.get("dissipation.E_friction").is_none(), "no friction in the scene");
    let wanted = [0.0, 0.000125, 0.00025, 0.000375, 0.0005, 0.0015, 0.0025, 0.0035, 0.0045];
    assert!(crate::common::difference(&table.column("time"), &wanted) < 1e-17);
    assert!((table.column("u")[8] - 0.5 * 4e-3).abs() < 1e-17);
}

/// What was expected, what was found, where.
#[test]
fn errors_on_the_command_line_say_what_was_expected() {
    let folder = scratch("program-wrong");
    let scene = changed(&folder, "", "").to_str().unwrap().to_owned();
    let result = folder.join("ok.csv").to_str().unwrap().to_owned();
    fs::write(&result, "time,u\n0,1\n1,2\n").unwrap();
    let ragged = folder.join("ragged.csv").to_str().unwrap().to_owned();
    fs::write(&ragged, "time,u\n0,1\n1,2,3\n").unwrap();
    let nowhere = folder.join("nowhere/out.csv").to_str().unwrap().to_owned();
    let refused = |arguments: &[&str]| {
        let output = asperity().args(arguments).output().unwrap();
        assert!(!output.status.success() && output.stdout.is_empty(), "{arguments:?}");
        String::from_utf8(output.stderr).unwrap()
    };
    let expected: [(&[&str], &str); 9] = [
        (&["plot", &result, "--y", "u", "-o", "out.pdf"], ".svg | .png"),
        (&["plot", &result, "--y", "u", "-o", "out.svg", "--labels", "a,b"], "--labels | expected 1 | found 2"),
        (&["plot", &ragged, "--y", "u", "-o", "out.svg"], "3: fields = 3: expected 2 | line 1"),
        (&["simulate", &scene, "-o", &nowhere], "nowhere/out.csv: | folder"),
        (&["simulate", &scene, "-o", "x.csv", "--rows", "0"], "--rows | 1 or more"),
        (&["material", &scene, "-o", "out.pdf"], ".svg | .png | .csv"),
        (&["material", &scene, "--temperature", "-5"], "--temperature | 0 K"),
        (&["pack", "-o", "x.fmu"], "<SCENE.toml|--table <TABLE.csv>|--patch <PATCH.toml>| | --seal <SEAL.toml>>"),
        (&["report", &scene, "-o", "x", "--stress", "13"], "--stress | 0 to 12"),
    ];
    for (arguments, text) in expected {
        assert_names(refused(arguments), text);
    }
}

/// The kind of a picture is that of its name.
#[test]
fn a_picture_is_png_where_its_name_says_so() {
    let folder = scratch("program-png");
    let (result, picture) = (folder.join("ok.csv"), folder.join("out.PNG"));
    fs::write(&result, "time,u\n0,1\n1,2\n").unwrap();
    run(asperity().arg("plot").arg(&result).args(["--y", "u", "-o"]).arg(&picture));
    assert!(fs::read(&picture).unwrap().starts_with(b"\x89PNG"));
}

#[test]
fn elements_are_columns() {
    let folder = scratch("program-elements");
    let scene = changed(&folder, "[\"forces\",", "[\"elements\", \"forces\",");
    let table = simulate(&scene, &folder, &["--rows", "1"]);
    let names = table.names();
    assert_eq!(names[names.len() - 5..], ["x", "z", "F_N", "F_T", "mode"].map(|field| format!("element[1].{field}")));
}

#[test]
fn a_bad_scene_is_refused_in_one_line_with_its_place() {
    let folder = scratch("program-bad");
    let scene = changed(&folder, "masses = 1", "masses = 0");
    let text = failure(&["describe", scene.to_str().unwrap()]);
    assert_eq!(text.lines().count(), 1, "{text}");
    assert!(text.starts_with("asperity: ") && text.contains("scene.toml:5: layer.masses = 0"), "{text}");
}

#[test]
fn a_run_that_fails_keeps_its_rows_and_says_so() {
    let folder = scratch("program-gives-up");
    let output = folder.join("out.csv");
    let scene = reference("rough-coulomb");
    let arguments = ["simulate", scene.to_str().unwrap(), "-o", output.to_str().unwrap()];
    let text = failure(&[&arguments[..], &["--set", "solver.max_steps=60"]].concat());
    assert!(text.contains("solver.max_steps") && text.contains("out.csv"), "{text}");
    let times = Table::read(&output).column("time");
    assert!(!times.is_empty() && times[times.len() - 1] < 2.6e-3, "{times:?}");
}

#[test]
fn a_phase_that_a_force_ends_takes_the_time_that_it_takes() {
    let folder = scratch("program-force");
    let scene = changed(&folder, "w_rate = -0.12", "w_rate = -0.12\nuntil_force = 0.02");
    let table = simulate(&scene, &folder, &["--rows", "10"]);
    assert_eq!(table.column("time").len(), 21);
    assert!((table.column("F_z")[10] - 0.02).abs() < 1e-6, "{}", table.column("F_z")[10]);
    assert!(table.column("time")[10] < 5e-4);
}

#[test]
fn a_phase_that_ends_at_once_adds_no_rows() {
    let folder = scratch("program-at-once");
    let scene = changed(&folder, "u_rate = 0.5", "until_force = 0.0\nu_rate = 0.5");
    assert_eq!(simulate(&scene, &folder, &["--rows", "10"]).column("time").len(), 11);
}

#[test]
fn a_force_that_is_not_reached_is_a_warning() {
    let folder = scratch("program-not-reached");
    let scene = changed(&folder, "w_rate = -0.12", "w_rate = -0.12\nuntil_force = 1e6");
    let text = warnings(&scene, &folder);
    assert!(text.contains("warning: phase 1") && text.contains("until_force"), "{text}");
    assert_eq!(Table::read(&folder.join("out.csv")).column("time").len(), 101);
}

/// A layer without dampers that is pressed onto the profile, let go and swings freely: what it loses is the error of the run,
/// hundreds of relative tolerances with large steps and some with small ones.
#[test]
fn a_run_whose_energy_balance_is_open_is_warned_of() {
    let folder = scratch("program-energy");
    let scene = folder.join("scene.toml");
    let layer = SceneText::new(2, 1e-4, 1e-6).set("layer.clearance", 1e-5).vertical(2e3).horizontal(1e3).coulomb(0.3);
    let presses = ["duration = 1e-4, w_rate = -0.5", "duration = 1e-4, w_rate = 0.5", "duration = 0.3"];
    let text = presses.iter().fold(layer, |scene, phase| scene.phase(phase)).outputs(&["forces", "energy"]);
    for (method, tolerance, is_open) in [("event", 1e-4, true), ("step", 1e-5, false)] {
        fs::write(&scene, text.clone().method(method).relative(tolerance).text()).unwrap();
        let said = warnings(&scene, &folder);
        assert_eq!(said.contains("the energy balance is off by"), is_open, "{method}: {said}");
    }
}

#[test]
fn a_scene_without_excitation_gives_the_start_and_a_warning() {
    let folder = scratch("program-no-excitation");
    let text = fs::read_to_string(reference("sinusoid")).unwrap();
    let scene = folder.join("scene.toml");
    fs::write(&scene, text.split("[[excitation]]").next().unwrap()).unwrap();
    assert!(warnings(&scene, &folder).contains("no [[excitation]]"));
    assert_eq!(Table::read(&folder.join("out.csv")).column("time"), [0.0]);
}

#[test]
fn drawing_a_picture_changes_no_column() {
    let folder = scratch("program-drawn");
    let scene = changed(&folder, "outputs = [", "outputs = [\"tangent\", ");
    let picture = folder.join("out.svg");
    let plain = simulate(&scene, &folder, &["--rows", "3"]);
    let drawn = simulate(&scene, &folder, &["--rows", "3", "--plot", picture.to_str().unwrap()]);
    for name in plain.names().iter().filter(|name| *name != "solver.run_time") {
        assert_eq!(plain.column(name), drawn.column(name), "{name}");
    }
    assert!(plain.column("tangent.dF_z_dw").iter().any(|&tangent| tangent != 0.0));
}

#[test]
fn a_picture_shows_more_than_the_scene_names() {
    let folder = scratch("program-picture");
    let scene = changed(&folder, "outputs = [", "outputs = [] # ");
    let picture = folder.join("out.svg");
    let table = simulate(&scene, &folder, &["--plot", picture.to_str().unwrap()]);
    assert_eq!(table.names(), ["time", "u", "w"]);
    let text = fs::read_to_string(picture).unwrap();
    for word in ["F_x", "F_z", "sticking", "E_diss", "E_impact", "time in ms"] {
        assert!(text.contains(word), "{word}");
    }
}

#[test]
fn result_files_are_drawn_over_each_other() {
    let folder = scratch("program-plot");
    let scene = reference("figure-7-low");
    simulate(&scene, &folder, &[]);
    let (result, picture) = (folder.join("figure-7-low.csv"), folder.join("out.svg"));
    let plot = |options: &[&str]| {
        let mut command = asperity();
        command.arg("plot").arg(&result).arg(&result).args(["--x", "u"]).args(options).arg("-o").arg(&picture);
        command
    };
    run(&mut plot(&["--y", "F_x", "--negate", "--from-motion", "--labels", "one,two", "--title", "a <title>"]));
    let text = fs::read_to_string(&picture).unwrap();
    assert!(text.contains("one") && text.contains("two") && text.contains("a &lt;title&gt;"), "{text}");
    let refused = plot(&["--y", "nothing"]).output().unwrap();
    assert_eq!(refused.status.code(), Some(1));
    assert_names(String::from_utf8(refused.stderr).unwrap(), "columns = time, u, w,");
}

#[test]
fn a_description_summarises_what_is_there_and_what_is_left_out() {
    let text = run(asperity().args(["describe", "-v"]).arg(reference("free-chain")));
    let left_out = "Friction    left out | elements     left out | Reduce      left out";
    assert_names(&text, &format!("5 masses | = 46 | k = 5, n = 2 | 56: | 36 Maxwell | MiB | {left_out}"));
}

/// What it is, what is computed and what is left out of every scene; what follows from that with -v alone.
#[test]
fn a_description_is_a_screen() {
    let folders = ["scenes", "tests/reference"].map(|folder| root().join(folder));
    let within = |folder: &Path| fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect::<Vec<_>>();
    let all = folders.iter().flat_map(|folder| within(folder));
    let files = all.flat_map(|path| if path.is_dir() { within(&path) } else { vec![path] });
    let mut described = 0;
    for file in files.filter(|file| file.extension().is_some_and(|extension| extension == "toml")) {
        let output = asperity().arg("describe").arg(&file).output().unwrap();
        // A patch is described by --patch.
        if !output.status.success() {
            continue;
        }
        described += 1;
        let text = String::from_utf8(output.stdout).unwrap();
        let widest = text.lines().map(|line| line.chars().count()).max().unwrap();
        assert!(text.lines().count() <= 40 && widest <= 100, "{file:?}, {widest} characters:\n{text}");
        for label in ["Scene  ", "Layer  ", "Profile  ", "Solver  ", "Outputs  ", "Left out  ", "More  "] {
            assert!(text.contains(label), "{file:?}: {label} in {text}");
        }
        assert!(!text.contains("Links  "), "{text}");
    }
    assert!(described > 30, "{described}");
    let text = run(asperity().arg("describe").arg(reference("free-chain")));
    assert!(text.contains("layer.vertical") || text.contains("friction"), "{text}");
}

#[test]
fn a_scene_as_json_is_all_of_it() {
    let json = |name: &str| -> serde_json::Value {
        serde_json::from_str(&run(asperity().arg("describe").arg(reference(name)).arg("--json"))).unwrap()
    };
    let chain = json("free-chain");
    assert_eq!(chain["name"], "free-chain");
    assert_eq!(chain["layer"]["masses"], 5);
    assert_eq!(chain["layer"]["roughness"][2], -2e-6);
    assert_eq!(chain["layer"]["lateral_x"]["maxwell"][1]["relaxation_time"], 1e-5);
    assert_eq!(
        (&chain["friction"], &chain["surface"]["z"]),
        (&serde_json::Value::Null, &serde_json::json!([0.0, 0.0]))
    );
    assert_eq!(chain["excitation"][0]["w"], serde_json::json!({ "rate": 0.0, "amplitude": 5e-6, "frequency": 3500.0 }));
    let rough = json("rough-coulomb");
    assert_eq!(rough["friction"]["coulomb"], 0.3);
    assert_eq!((&rough["solver"]["method"], &rough["outputs"][1]), (&"event".into(), &"dissipation".into()));
    let file = Table::read(&root().join("tests/reference/rough-coulomb.profile.csv"));
    let heights: Vec<f64> = rough["surface"]["z"].as_array().unwrap().iter().map(|z| z.as_f64().unwrap()).collect();
    // The numbers are written in full; the reader here may miss the last digit of one.
    assert!(crate::common::difference(&heights, &file.column("z")) < 1e-15 * crate::common::largest(&heights));
}

/// Two masses of rubber, A = 1e-6 m², pressed at 20 mm/s; at 400 K times are a tenth of those at 300 K.
fn rubber(folder: &Path, until_pressure: f64) -> PathBuf {
    fs::write(folder.join("compound.csv"), "relaxation_time,modulus\n1e-3,5e6\n").unwrap();
    let scene = SceneText::rubber(2, 1e-4, 1e-3, 1e-2)
        .set("name", "rubber")
        .with("material.density = 1000\nmaterial.poisson_ratio = 0.25\nmaterial.equilibrium_modulus = 2e6")
        .with("material.viscosity = 10\nmaterial.prony = 'compound.csv'")
        .wlf([2.0, 100.0, 300.0], 400.0)
        .set("friction.shear_strength", 1e4)
        .phase(&format!("duration = 1e-3, w_rate = -0.02, until_pressure = {until_pressure:?}"));
    let path = folder.join("rubber.toml");
    fs::write(&path, scene.text()).unwrap();
    path
}

#[test]
fn a_phase_ends_at_a_pressure_on_the_whole_layer() {
    let folder = scratch("program-pressure");
    let scene = rubber(&folder, 1e4);
    let table = simulate(&scene, &folder, &["--rows", "10"]);
    let force = table.column("F_z")[10];
    assert!((force / (2.0 * 1e-6) - 1e4).abs() < 0.1, "{force}");
    assert!(table.column("time")[10] < 1e-3);
    let text = warnings(&rubber(&folder, 1e9), &folder);
    assert!(text.contains("warning: phase 1") && text.contains("until_pressure = 1000000000 Pa"), "{text}");
}

#[test]
fn a_description_of_a_material_has_the_derived_links_and_the_shift() {
    let folder = scratch("program-rubber");
    let scene = rubber(&folder, 1e4);
    let text = run(asperity().args(["describe", "-v"]).arg(&scene));
    assert_names(
        &text,
        "2 masses of 1e-6 kg | 0.001 m thick | 0.01 m wide | 1000 kg/m³ | ratio 0.25 | 400 K | 300 K | a_T = 1.0000e-1 | \
         vertical    2 of c 2000 N/m, d 0.001 N s/m, n = 1: 5000 N/m at 1e-4 s | lateral_z   1 of c 80000 N/m | \
         10000 Pa: 0.01 N | until F_z = 10000 Pa",
    );
    let json = run(asperity().arg("describe").arg(&scene).arg("--json"));
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!(json["material"]["prony"][0]["modulus"], 5e6);
    let number = |value: &serde_json::Value, expected: f64| {
        let found = value.as_f64().unwrap();
        assert!((found / expected - 1.0).abs() < 1e-14, "{found}, not {expected}");
    };
    number(&json["shift_factor"], 0.1);
    number(&json["layer"]["mass"], 1e-6);
    number(&json["layer"]["horizontal"]["stiffness"], 800.0);
    number(&json["layer"]["vertical"]["maxwell"][0]["relaxation_time"], 1e-4);
    number(&json["friction"]["shear_force"], 0.01);
    number(&json["excitation"][0]["until_force"], 0.02);
}

#[test]
fn parameters_that_do_not_go_together_are_refused_once_all_are_set() {
    let folder = scratch("program-cold");
    let scene = rubber(&folder, 1e4);
    let output = folder.join("out.csv");
    let arguments = ["simulate", scene.to_str().unwrap(), "-o", output.to_str().unwrap()];
    let cold = ["--set", "material.wlf.temperature=190"];
    let text = failure(&[&arguments[..], &cold].concat());
    assert!(text.contains("material.wlf.temperature = 190.0: expected more than "), "{text}");
    let both = [&arguments[..], &cold, &["--set", "material.wlf.reference_temperature=200"]].concat();
    run(asperity().args(both));
}

#[test]
fn the_archive_holds_the_compound() {
    let folder = scratch("program-compound");
    let (scene, library, fmu) = (rubber(&folder, 1e4), folder.join("any.so"), folder.join("rubber.fmu"));
    fs::write(&library, "a library").unwrap();
    run(asperity().arg("pack").arg(&scene).arg("-o").arg(&fmu).arg("--library").arg(&library));
    let bytes = fs::read(&fmu).unwrap();
    let name = b"resources/compound.csv";
    assert!(bytes.windows(name.len()).any(|window| window == name));
}

/// One mass on a stiff, a long and a short element: K' = 3, m ω² = 3 + 2, T = 0.1 s.
#[test]
fn a_description_says_which_maxwell_elements_are_replaced_and_why() {
    let layer = "layer = { masses = 2, spacing = 1.0, mass = 5e-4, vertical = { stiffness = 3.0, maxwell = [\
                 { stiffness = 2.0, relaxation_time = 1e-1 }, { stiffness = 1e-1, relaxation_time = 1e2 },\
                 { stiffness = 1e-1, relaxation_time = 1e-4 }] } }";
    let rest = "surface = { kind = 'flat' }\nsolver = { reduce = 1e-2 }";
    let folder = scratch("reduce");
    let describe = |excitation: &str| {
        let scene = folder.join("reduce.toml");
        fs::write(&scene, format!("name = 'a'\n{layer}\n{rest}\n{excitation}")).unwrap();
        run(asperity().args(["describe", "-v"]).arg(&scene))
    };
    let text = describe("[[excitation]]\nduration = 1e-1");
    assert_names(
        &text,
        "Reduce      0.01: | vertical    1 of 3 elements | K' = 4.1000e0 N/m | [2] 0.1 N/m at 100 s | spring, bound 2.44e-5 | \
         [3] 0.1 N/m at 1e-4 s | damper, bound 2.48e-6 | 10: | 2 Maxwell",
    );
    assert_names(describe(""), "no element becomes a spring | 2 of 3 elements | [3] 0.1 N/m at 1e-4 s is short");
}
