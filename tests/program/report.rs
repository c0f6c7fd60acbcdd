//! `asperity report`: its files, what is in them, and what it says where there is nothing to report.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use crate::common::scenes::SceneText;
use crate::common::{asperity, root, run, scratch};

/// A row of a table by the names of its columns.
type Row = BTreeMap<String, String>;

const SINUSOID: &str = "tests/reference/sinusoid.toml";

fn rows(path: &Path) -> Vec<Row> {
    let mut file = csv::ReaderBuilder::new().comment(Some(b'#')).from_path(path).unwrap();
    let without_units = file.headers().unwrap().iter().map(|name| name.split(" [").next().unwrap().to_owned());
    let names: Vec<String> = without_units.collect();
    let row = |record: csv::StringRecord| names.iter().cloned().zip(record.iter().map(str::to_owned)).collect();
    file.records().map(|record| row(record.unwrap())).collect()
}

fn number(row: &Row, column: &str) -> f64 {
    row[column].parse().unwrap_or_else(|_| panic!("{column}: {row:?}"))
}

fn of_method<'a>(rows: &'a [Row], method: &str) -> Vec<&'a Row> {
    rows.iter().filter(|row| row["method"] == method).collect()
}

/// What the program says as it writes the report of `scene` into `folder`, its summary and its warnings, without stress
/// unless that is asked for.
fn report(scene: &Path, folder: &Path, options: &[&str]) -> String {
    let stress = if options.contains(&"--stress") { [].as_slice() } else { &["--stress", "0"] };
    let output = asperity().arg("report").arg(scene).arg("-o").arg(folder).args(options).args(stress).output().unwrap();
    let text = [output.stdout, output.stderr].map(|text| String::from_utf8(text).unwrap()).concat();
    assert!(output.status.success(), "{text}");
    text
}

/// What the program says as it refuses to.
fn refusal(scene: &Path, folder: &Path, options: &[&str]) -> String {
    let output = asperity().arg("report").arg(scene).arg("-o").arg(folder).args(options).output().unwrap();
    assert_eq!(output.status.code(), Some(1));
    let text = String::from_utf8(output.stderr).unwrap();
    let (warnings, refusals): (Vec<_>, Vec<_>) = text.lines().partition(|line| line.contains(" warning: "));
    assert_eq!(refusals.len(), 1, "{warnings:?} {refusals:?}");
    text
}

/// The sinusoid's scene, changed.
fn changed(folder: &Path, from: &str, to: &str) -> PathBuf {
    let text = fs::read_to_string(root().join(SINUSOID)).unwrap();
    assert!(text.contains(from), "{from}");
    let scene = folder.join("scene.toml");
    fs::write(&scene, text.replacen(from, to, 1)).unwrap();
    scene
}

fn errors(folder: &Path) -> Vec<Row> {
    rows(&folder.join("error-run-time.csv"))
}

fn judgements(folder: &Path) -> Vec<Row> {
    rows(&folder.join("tolerance-estimate.csv"))
}

/// The larger of the errors of F_x and F_z over the tolerance, and the run's own estimate over that error.
#[test]
fn runs_are_held_against_tolerance_and_estimate() {
    let folder = scratch("report-judgements");
    let text = report(&root().join(SINUSOID), &folder, &["--repeat", "1", "--tolerances", "1e-3..1e-6"]);
    let (runs, judged) = (errors(&folder), judgements(&folder));
    assert_eq!(judged.len(), 8);
    let worse = |run: &Row| number(run, "error_F_x").max(number(run, "error_F_z"));
    let own = worse(of_method(&runs, "reference")[0]);
    for row in &judged {
        let same = |run: &&&Row| run["tolerance"] == row["tolerance"];
        let of = of_method(&runs, &row["method"]);
        let run = of.iter().find(same).unwrap();
        let error = worse(run);
        assert_eq!((number(row, "error"), &row["estimate"]), (error, &run["estimate"]), "{row:?}");
        // Nothing is known below the reference's own error.
        let known = |error: f64| error.max(own);
        let ratios = [error / number(row, "tolerance"), known(number(row, "estimate")) / known(error)];
        for (column, ratio) in ["error_over_tolerance", "estimate_over_error"].into_iter().zip(ratios) {
            // One rounding each.
            assert!((number(row, column) / ratio - 1.0).abs() < 1e-15, "{column}: {row:?}");
        }
        // A smooth scene, whose errors fall with the tolerance as the estimate takes them to.
        assert!((0.1..10.0).contains(&ratios[1]) && row["left_out"].is_empty(), "{row:?}");
    }
    assert!(text.contains("event: 4 runs") && text.contains("100 % within 10 times"), "{text}");
}

#[test]
fn run_times_have_their_spread_and_the_machine() {
    let folder = scratch("report-timings");
    report(&root().join(SINUSOID), &folder, &["--repeat", "4", "--tolerances", "1e-3..1e-4"]);
    let rows = errors(&folder);
    for row in of_method(&rows, "event").into_iter().chain(of_method(&rows, "step")) {
        // Runs of milliseconds: as many timings as are allowed.
        assert!(number(row, "runs") == 4.0 && number(row, "most_above_least") >= 0.0, "{row:?}");
    }
    let table = fs::read_to_string(folder.join("error-run-time.csv")).unwrap();
    for line in [&format!("# build = asperity {}", env!("CARGO_PKG_VERSION")), "# cpu = ", "# cores = ", "# system = "]
    {
        assert!(table.contains(line), "{line}");
    }
}

/// Each scene has its own folder; the table of all has the runs of all.
#[test]
fn several_scenes_have_one_table_of_all() {
    let folder = scratch("report-several");
    let absent = changed(&folder, "u_rate = 0.5", "u_rate = 0.4");
    let scenes = [root().join(SINUSOID), absent];
    let command = |scenes: &[PathBuf], to: &str| {
        let options = ["--repeat", "1", "--tolerances", "1e-3..1e-5", "--stress", "0"];
        asperity().arg("report").args(scenes).arg("-o").arg(folder.join(to)).args(options).output().unwrap()
    };
    let output = command(&scenes, "all");
    assert!(output.status.success(), "{output:?}");
    let all = judgements(&folder.join("all"));
    for name in ["sinusoid", "scene"] {
        let own = judgements(&folder.join("all").join(name));
        let of_all: Vec<&Row> = all.iter().filter(|row| row["scene"] == name).collect();
        let errors = |rows: &[&Row]| rows.iter().map(|row| row["error"].clone()).collect::<Vec<_>>();
        assert_eq!(errors(&of_all), errors(&own.iter().collect::<Vec<_>>()), "{name}");
        assert!(!own.is_empty() && folder.join("all").join(name).join("error-run-time.svg").exists(), "{name}");
    }
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(text.contains("All scenes") && text.contains("event: 6 runs"), "{text}");
    assert!(folder.join("all/tolerance-estimate.svg").exists());
    let output = command(&[scenes[0].clone(), scenes[0].clone()], "twice");
    let text = String::from_utf8(output.stderr).unwrap();
    assert!(!output.status.success() && text.contains("two scenes have the same folder"), "{text}");
    assert!(!folder.join("twice").exists());
}

#[test]
fn every_file_is_there_and_named() {
    let folder = scratch("report-files").join("made/if/need/be");
    let text = report(&root().join(SINUSOID), &folder, &["--repeat", "1", "--stress", "1"]);
    for (name, title) in [
        ("error-run-time", "error of F_z"),
        ("error-communication-step", "error of F_z"),
        ("tolerance-estimate", "error over tolerance"),
        ("stress", "error over tolerance"),
    ] {
        let svg = fs::read_to_string(folder.join(name).with_extension("svg")).unwrap();
        assert!(svg.starts_with("<svg") && svg.contains(title), "{name}");
        let png = fs::read(folder.join(name).with_extension("png")).unwrap();
        assert_eq!(&png[..8], b"\x89PNG\r\n\x1a\n");
        // Lines end behind hyphens, too.
        let told: String = text.split_whitespace().collect();
        assert!(told.contains(name) && !rows(&folder.join(name).with_extension("csv")).is_empty(), "{name}: {text}");
    }
    // The quickest run with all errors at most 1e-3 is one of the table.
    let runs = errors(&folder);
    let good = |row: &&Row| {
        let all = ["error_F_x", "error_F_z", "error_E_diss"];
        row["method"] != "reference" && row["failure"].is_empty() && all.iter().all(|error| number(row, error) <= 1e-3)
    };
    let quickest =
        runs.iter().filter(good).min_by(|a, b| number(a, "run_time").total_cmp(&number(b, "run_time"))).unwrap();
    let line = text.lines().find(|line| line.contains("at most 1e-3")).unwrap();
    let setting = format!("{} at {:e}", quickest["method"], number(quickest, "tolerance"));
    assert!(line.contains(&setting) && line.contains(&format!("{} steps", quickest["steps"])), "{line}, {quickest:?}");
}

#[test]
fn errors_fall_with_the_tolerance_down_to_what_the_reference_knows() {
    let folder = scratch("report-errors");
    report(&root().join(SINUSOID), &folder, &["--repeat", "2", "--rows", "20"]);
    let rows = errors(&folder);
    let (reference, event) = (of_method(&rows, "reference"), of_method(&rows, "event"));
    assert_eq!((reference.len(), event.len()), (1, 9));
    assert_eq!(number(reference[0], "tolerance"), 1e-11);
    for (i, row) in event.iter().enumerate() {
        assert_eq!(number(row, "tolerance"), format!("1e-{}", i + 2).parse::<f64>().unwrap());
        assert!(number(row, "run_time") > 0.0 && row["failure"].is_empty());
        // Each step has three or six implicit stages, of which each is solved by one iteration at least.
        assert!(number(row, "newton_iterations") >= 3.0 * number(row, "steps") && number(row, "steps") > 0.0);
    }
    for column in ["error_F_x", "error_F_z", "error_E_diss"] {
        // Eight powers of ten of the tolerance; half of them at least in the error, whatever the scene's constant.
        let [loosest, tightest] = [event[0], event[8]].map(|row| number(row, column));
        assert!(tightest < 1e-4 * loosest, "{column}: {loosest:e} to {tightest:e}");
        // The reference is ten times as tight as the tightest rung: its own error is no larger than that rung's.
        assert!(number(reference[0], column) <= tightest, "{column}");
    }
    let step = of_method(&rows, "step");
    assert_eq!(step.len(), 9);
    for (looser, tighter) in step.iter().zip(&step[1..]).filter(|(_, tighter)| tighter["failure"].is_empty()) {
        // Of second order, with an error estimate that fits: it falls with the tolerance, on each rung by a half at
        // least.
        assert!(number(tighter, "error_F_z") < 0.5 * number(looser, "error_F_z"), "{looser:?}, {tighter:?}");
    }
    // The tightest would take a hundred times the reference's work.
    assert!(step[8]["failure"].contains("left out: a looser one took"), "{step:?}");
    assert!(number(event[8], "energy_residual") < 1e-3 * number(event[0], "energy_residual"));
}

/// With rates the FMU follows straight phases exactly; with values alone it learns of each kink one step late, so that
/// E_diss, which does not jump, comes closer as the step gets shorter.
#[test]
fn communication_steps_have_their_ladder() {
    let folder = scratch("report-communication");
    report(&root().join(SINUSOID), &folder, &["--repeat", "1", "--tolerances", "1e-6..1e-8"]);
    let rows = rows(&folder.join("error-communication-step.csv"));
    let of = |given: &str| rows.iter().filter(|row| row["given"] == given).collect::<Vec<_>>();
    let (rates, values, alone) = (of("values and rates"), of("values alone"), of("no master"));
    assert_eq!((rates.len(), values.len(), alone.len()), (7, 7, 1));
    for (longer, shorter) in values.iter().zip(&values[1..]) {
        let ratio = number(longer, "communication_step") / number(shorter, "communication_step");
        assert!((ratio - 2.0).abs() < 1e-12, "{ratio}");
    }
    // First order: a sixty-fourth of the step, and at most a sixteenth of the error.
    let [longest, shortest] = [values[0], values[6]].map(|row| number(row, "error_E_diss"));
    assert!(shortest < longest / 16.0, "{longest:e} to {shortest:e}");
    // At the scene's tolerance of 1e-6, of which the steps between communication points make no more than ten times.
    assert!(rates.iter().all(|row| number(row, "error_E_diss") < 1e-5), "{rates:?}");
    assert!(number(values[6], "mean_square_error_F_z") < number(values[6], "error_F_z"));
}

#[test]
fn peers_have_their_lines_and_those_of_other_scenes_none() {
    let folder = scratch("report-peers");
    let peers = folder.join("peers.csv");
    let head = "scene,program,method,tolerance,error_F_x,error_F_z,error_E_diss,run_time,steps,events";
    let lines = [
        "sinusoid,CVODE,klu,1e-3,2e-3,3e-4,4e-4,0.25,1234567,1",
        "sinusoid,CVODE,klu,1e-6,2e-6,3e-7,4e-7,0.5,3575,1",
        "sinusoid,scipy,Radau,1e-6,,,,,,",
        "sinusoid,asperity,event,1e-6,2e-6,3e-7,4e-7,0.2,2345678,1",
        "another,CVODE,cond,1e-6,2e-6,3e-7,4e-7,0.5,7654321,1",
    ];
    fs::write(&peers, format!("{head}\n{}\n", lines.join("\n"))).unwrap();
    let peers = peers.to_str().unwrap();
    let options = ["--repeat", "1", "--tolerances", "1e-3..1e-6", "--peers", peers];
    assert!(!report(&root().join(SINUSOID), &folder, &options).contains("no lines"));
    let svg = fs::read_to_string(folder.join("error-run-time.svg")).unwrap();
    // Whole processes, asperity's among them, beside the runs alone; none that did not come to its end.
    for (name, is_there) in [("CVODE klu", true), ("asperity event", true), ("Radau", false), ("cond", false)] {
        assert_eq!(svg.contains(name), is_there, "{name}");
    }
    assert!(errors(&folder).iter().all(|row| row["method"] != "klu"));
    let none = changed(&folder, "name = \"sinusoid\"", "name = \"unheard-of\"");
    let text = report(&none, &folder, &options);
    assert!(text.contains("no lines of the scene unheard-of; there are sinusoid, another"), "{text}");
}

#[test]
fn peers_that_cannot_be_read_are_named_before_anything_is_run() {
    let folder = scratch("report-no-peers");
    let peers = folder.join("peers.csv");
    let output = folder.join("out");
    let refused = || refusal(&root().join(SINUSOID), &output, &["--peers", peers.to_str().unwrap()]);
    let text = refused();
    assert!(text.contains("cannot read") && text.contains("peers.csv"), "{text}");
    fs::write(&peers, "scene,program\nsinusoid,CVODE\n").unwrap();
    let text = refused();
    assert!(text.contains("columns = scene, program: expected method among them"), "{text}");
    let head = "scene,program,method,tolerance,error_F_x,error_F_z,error_E_diss,run_time,steps,events";
    fs::write(&peers, format!("{head}\nsinusoid,CVODE,klu,1e-3,soon,1,1,1,1,1\n")).unwrap();
    let text = refused();
    assert!(text.contains("peers.csv:2: error_F_x = \"soon\": expected a number"), "{text}");
    assert!(!output.exists());
}

/// A rung that gives up is a row with its reason; the reference is then the tightest that does not.
#[test]
fn a_rung_that_gives_up_says_why() {
    let folder = scratch("report-gives-up");
    let scene = root().join(SINUSOID);
    report(&scene, &folder, &["--repeat", "1"]);
    let work: f64 = {
        let rows = errors(&folder);
        let tightest = of_method(&rows, "event")[8];
        number(tightest, "steps") + number(tightest, "rejected")
    };
    // A third of what the tightest takes in its two phases: less than the longer of them takes.
    let limit = format!("solver.max_steps={}", (work / 3.0) as u64);
    report(&scene, &folder, &["--repeat", "1", "--set", &limit]);
    let rows = errors(&folder);
    let (failed, done): (Vec<&Row>, Vec<&Row>) =
        of_method(&rows, "event").into_iter().partition(|row| !row["failure"].is_empty());
    assert!(!failed.is_empty() && !done.is_empty(), "{rows:?}");
    assert!(failed.iter().all(|row| row["failure"].contains("solver.max_steps") && row["run_time"].is_empty()));
    let reference = of_method(&rows, "reference")[0];
    assert!(number(reference, "tolerance") < number(done[0], "tolerance"));
    let text = refusal(&scene, &folder, &["--set", "solver.max_steps=1"]);
    assert!(text.contains("no reference: not even the loosest tolerance"), "{text}");
}

#[test]
fn a_scene_without_a_run_is_refused() {
    let folder = scratch("report-no-run");
    let text = fs::read_to_string(root().join(SINUSOID)).unwrap();
    let scene = folder.join("scene.toml");
    fs::write(&scene, text.split("[[excitation]]").next().unwrap()).unwrap();
    let output = folder.join("out");
    assert!(refusal(&scene, &output, &[]).contains("no [[excitation]]: the carrier rests"));
    let at_once = text.replace("[[excitation]]", "[[excitation]]\nuntil_force = 0.0");
    fs::write(&scene, at_once).unwrap();
    assert!(refusal(&scene, &output, &[]).contains("takes no time"));
    assert!(!output.exists());
}

#[test]
fn what_is_read_is_not_written_over() {
    let folder = scratch("report-overwrites");
    let peers = folder.join("error-run-time.csv");
    fs::write(&peers, "a table of peers").unwrap();
    let text = refusal(&root().join(SINUSOID), &folder, &["--peers", peers.to_str().unwrap()]);
    assert!(text.contains("will not write"), "{text}");
}

/// A phase that a force ends takes the same time in all runs: the errors are those of one motion.
#[test]
fn a_phase_that_a_force_ends_is_the_same_in_all_runs() {
    let folder = scratch("report-force");
    let scene = changed(&folder, "w_rate = -0.12", "w_rate = -0.12\nuntil_force = 0.02");
    report(&scene, &folder, &["--repeat", "1", "--tolerances", "1e-5..1e-8"]);
    let rows = errors(&folder);
    assert!(of_method(&rows, "event").iter().all(|row| number(row, "error_F_z") < 1e-3), "{rows:?}");
}

/// Six hard masses, tied firmly to each other and softly to the carrier, hop over a wavy profile without losses but by
/// impacts: where each lands depends on the last digit.
#[test]
fn where_runs_part_means_are_compared() {
    let folder = scratch("report-sensitive");
    let scene = hopping().write(&folder);
    let text = report(&scene, &folder, &["--repeat", "1", "--tolerances", "1e-4..1e-7"]);
    let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(text.contains("sensitive") && text.contains("1e-12 m") && text.contains("means over 20 windows"), "{text}");
    let svg = fs::read_to_string(folder.join("error-run-time.svg")).unwrap();
    assert!(svg.contains("error of F_z, means"));
    let judged = judgements(&folder);
    assert!(!judged.is_empty() && judged.iter().all(|row| row["left_out"] == "sensitive"), "{judged:?}");
    // Runs that stay together say nothing of it.
    let text = report(&root().join(SINUSOID), &folder, &["--repeat", "1", "--tolerances", "1e-4..1e-7"]);
    // The folder's name is another matter.
    let text = text.split("Written").next().unwrap();
    assert!(!text.contains("sensitive") && text.contains("row by row"), "{text}");
}

fn hopping() -> SceneText {
    SceneText::new(6, 1.37e-4, 2e-7)
        .vertical(10.0)
        .horizontal(10.0)
        .lateral_x(3e4)
        .lateral_z(3e4)
        .points(
            &[0.0, 1.1e-4, 2.3e-4, 3.2e-4, 4.5e-4, 5.3e-4, 6.4e-4],
            &[0.0, -6e-6, 5e-6, -9e-6, 1e-6, -4e-6, 0.0],
            true,
        )
        .phase("duration = 5e-4, w_rate = -0.02")
        .phase("duration = 1e-2, u_rate = 1.0")
}

/// The reference leaves no Maxwell element out: what `solver.reduce` costs is in the errors, whatever the tolerance.
#[test]
fn what_a_reduced_scene_is_wrong_by_shows() {
    let folder = scratch("report-reduced");
    // Long against the run of 4.5 ms: for the asking, a spring.
    let whole = changed(&folder, "relaxation_time = 0.0002", "relaxation_time = 1.0");
    let text = fs::read_to_string(&whole).unwrap();
    let reduced = folder.join("reduced.toml");
    fs::write(&reduced, text.replace("[fmu]", "[solver]\nreduce = 0.02\n[fmu]")).unwrap();
    let tightest = |scene: &Path| {
        report(scene, &folder, &["--repeat", "1", "--tolerances", "1e-6..1e-8"]);
        let rows = errors(&folder);
        (number(of_method(&rows, "event")[2], "error_F_z"), number(of_method(&rows, "reference")[0], "error_F_z"))
    };
    let ((reduced, own), (whole, _)) = (tightest(&reduced), tightest(&whole));
    assert!(reduced > 1e3 * whole && own < 1e-3 * reduced, "{reduced:e}, {own:e}, {whole:e}");
}

#[test]
fn what_a_scene_does_not_have_has_no_error() {
    let folder = scratch("report-absent");
    let scene = SceneText::new(2, 1e-4, 1e-7).vertical(1e3).phase("duration = 1e-3, w_rate = -0.01").write(&folder);
    report(&scene, &folder, &["--repeat", "1", "--tolerances", "1e-4..1e-6"]);
    let rows = errors(&folder);
    // By time-stepping a tolerance may be left out: the event-driven reference takes six steps.
    let mut ran = rows.iter().filter(|row| row["failure"].is_empty());
    assert!(ran.all(|row| row["error_F_x"].is_empty() && !row["error_F_z"].is_empty()), "{rows:?}");
    let svg = fs::read_to_string(folder.join("error-run-time.svg")).unwrap();
    assert!(!svg.contains("error of F_x") && svg.contains("error of F_z"));
}

#[test]
fn tolerances_are_a_range() {
    let output = asperity().args(["report", SINUSOID, "-o", "x", "--tolerances", "1e-10..1e-2"]).output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8(output.stderr).unwrap().contains("expected LOOSEST..TIGHTEST"));
    assert!(run(asperity().args(["report", "--help"])).contains("[default: 1e-2..1e-10]"));
}

/// The runs of the scene under stress, and what is said of them, without the ladders' runs.
fn stressed(scene: &Path, folder: &Path, options: &[&str]) -> (Vec<Row>, String) {
    let quick = ["--repeat", "1", "--rows", "10", "--tolerances", "1e-6..1e-6", "--stress", "1"];
    let text = report(scene, folder, &[&quick, options].concat());
    (rows(&folder.join("stress.csv")), text.split_whitespace().collect::<Vec<_>>().join(" "))
}

/// The run where this is scaled; the empty name for the scene as it is.
fn trial<'a>(trials: &'a [Row], scaled: &str, factor: f64) -> &'a Row {
    trials.iter().find(|row| row["scaled"] == scaled && number(row, "factor") == factor).expect("a run")
}

#[test]
fn a_scene_under_stress_has_a_run_for_each_factor() {
    let folder = scratch("report-stress");
    let (trials, text) = stressed(&root().join(SINUSOID), &folder, &[]);
    // The scene itself; four of its quantities; a master's communication step of three lengths.
    assert_eq!(trials.len(), 1 + 4 * 2 + 3);
    for row in &trials {
        assert!(!row["status"].is_empty() && !row["reason"].is_empty(), "{row:?}");
        let times = number(row, "times_the_steps");
        assert!(times > 0.0 && times <= 20.0 && number(row, "energy_residual") < 1e-4, "{row:?}");
    }
    let unscaled = trial(&trials, "", 1.0);
    assert_eq!((unscaled["status"].as_str(), number(unscaled, "times_the_steps")), ("kept", 1.0));
    assert!(number(unscaled, "error") < 1e-5 && number(unscaled, "error") > 0.0);
    // A master that gives rates follows straight phases exactly: the same run, but for its communication points.
    let driven = trial(&trials, "communication step", 1.0);
    assert!(number(driven, "steps") >= 1000.0 && driven["status"] == "kept", "{driven:?}");
    for quantity in ["stiffness", "mass", "relaxation times", "speed", "communication step"] {
        assert!(text.contains(&format!("{quantity}: kept from")), "{quantity}: {text}");
    }
    // All of them came to their ends, and are held against their tolerance and estimate.
    let judged = judgements(&folder);
    assert_eq!(judged.iter().filter(|row| !row["scaled"].is_empty()).count(), trials.len() - 1);
    assert!(text.contains("event, scaled: 11 runs"), "{text}");
}

/// A run under stress is that of the scene with these values.
#[test]
fn a_stressed_scene_is_the_scene_with_other_values() {
    let folder = scratch("report-stress-values");
    let (trials, _) = stressed(&root().join(SINUSOID), &folder, &[]);
    let same = |cell: &Row, scene: &Path, options: &[&str]| {
        let (others, _) = stressed(scene, &folder, options);
        let other = trial(&others, "", 1.0);
        for column in ["steps", "rejected", "events", "newton_iterations", "error", "energy_residual"] {
            assert_eq!(cell[column], other[column], "{column}: {cell:?}, {other:?}");
        }
    };
    let scene = root().join(SINUSOID);
    same(trial(&trials, "mass", 10.0), &scene, &["--set", "layer.mass=1e-6"]);
    let stiff =
        ["layer.vertical.stiffness=2e4", "layer.vertical.maxwell[1].stiffness=3e4", "layer.horizontal.stiffness=5e4"];
    let set: Vec<&str> = stiff.iter().flat_map(|pair| ["--set", pair]).collect();
    same(trial(&trials, "stiffness", 10.0), &scene, &set);
    same(
        trial(&trials, "relaxation times", 10.0),
        &scene,
        &["--set", "layer.vertical.maxwell[1].relaxation_time=2e-3"],
    );
    let text = fs::read_to_string(&scene).unwrap();
    let fast = text
        .replace("0.0005", "0.00005")
        .replace("-0.12", "-1.2")
        .replace("0.004\nu_rate = 0.5", "0.0004\nu_rate = 5.0");
    let scene = folder.join("fast.toml");
    fs::write(&scene, fast).unwrap();
    same(trial(&trials, "speed", 10.0), &scene, &[]);
}

#[test]
fn what_a_scene_does_not_have_is_not_stressed() {
    let folder = scratch("report-stress-absent");
    let scene = changed(&folder, "maxwell = [{ stiffness = 3000.0, relaxation_time = 0.0002 }]", "");
    let (trials, _) = stressed(&scene, &folder, &[]);
    assert_eq!(trials.len(), 1 + 3 * 2 + 3);
    assert!(trials.iter().all(|row| row["scaled"] != "relaxation times"));
    let text = report(&scene, &folder.join("none"), &["--repeat", "1", "--tolerances", "1e-6..1e-6"]);
    assert!(!folder.join("none/stress.csv").exists() && !text.contains("Stress"), "{text}");
}

/// Ten times the largest number that a scene may have is none.
#[test]
fn a_run_that_is_refused_says_why() {
    let folder = scratch("report-stress-refused");
    let longest = ["--set", "layer.vertical.maxwell[1].relaxation_time=1e30"];
    let (trials, text) = stressed(&root().join(SINUSOID), &folder, &longest);
    let refused = trial(&trials, "relaxation times", 10.0);
    assert_eq!((refused["status"].as_str(), refused["steps"].as_str()), ("stopped", ""));
    assert!(refused["reason"].contains("layer.vertical.maxwell[1].relaxation_time = 1e31: expected"), "{refused:?}");
    assert!(text.contains(&refused["reason"]), "{text}");
}
