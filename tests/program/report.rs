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
    csv::Reader::from_path(path).unwrap().deserialize().collect::<Result<_, _>>().unwrap()
}

fn number(row: &Row, column: &str) -> f64 {
    row[column].parse().unwrap_or_else(|_| panic!("{column}: {row:?}"))
}

fn of_method<'a>(rows: &'a [Row], method: &str) -> Vec<&'a Row> {
    rows.iter().filter(|row| row["timed"] == "run alone" && row["method"] == method).collect()
}

/// What the program says while it writes the report of `scene` into `folder`, without stress unless that is asked for.
fn report(scene: &Path, folder: &Path, options: &[&str]) -> String {
    let stress = if options.contains(&"--stress") { [].as_slice() } else { &["--stress", "0"] };
    let output = asperity().arg("report").arg(scene).arg("-o").arg(folder).args(options).args(stress).output().unwrap();
    let text = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success() && output.stdout.is_empty(), "{text}");
    text
}

/// What the program says as it refuses to.
fn refusal(scene: &Path, folder: &Path, options: &[&str]) -> String {
    let output = asperity().arg("report").arg(scene).arg("-o").arg(folder).args(options).output().unwrap();
    assert_eq!(output.status.code(), Some(1));
    let text = String::from_utf8(output.stderr).unwrap();
    assert_eq!(text.lines().count(), 1, "{text}");
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
    report(&root().join(SINUSOID), &folder, &["--repeat", "1", "--tolerances", "1e-3..1e-6"]);
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
    let page = fs::read_to_string(folder.join("index.html")).unwrap();
    assert!(page.contains("<h2>Tolerance and estimate</h2>") && page.contains("100 %"));
}

#[test]
fn run_times_have_their_spread_and_the_machine() {
    let folder = scratch("report-timings");
    report(&root().join(SINUSOID), &folder, &["--repeat", "4", "--tolerances", "1e-3..1e-4"]);
    let (rows, page) = (errors(&folder), fs::read_to_string(folder.join("index.html")).unwrap());
    for row in of_method(&rows, "event").into_iter().chain(of_method(&rows, "step")) {
        // Runs of milliseconds: as many timings as are allowed.
        assert!(number(row, "runs") == 4.0 && number(row, "most_above_least") >= 0.0, "{row:?}");
        assert!(row["build"].starts_with(&format!("asperity {}", env!("CARGO_PKG_VERSION"))), "{row:?}");
        assert!(page.contains(&row["cpu"]) && page.contains(&row["system"]) && number(row, "cores") >= 1.0, "{row:?}");
    }
}

/// Each scene has its own folder; the page of all has the runs of all.
#[test]
fn several_scenes_have_one_page_of_all() {
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
        assert!(!own.is_empty() && folder.join("all").join(name).join("index.html").exists(), "{name}");
    }
    let page = fs::read_to_string(folder.join("all/index.html")).unwrap();
    for part in ["<a href=\"scene/index.html\">scene</a>", "<td>all</td>", "<td>sinusoid</td>", "<svg"] {
        assert!(page.contains(part), "{part}");
    }
    let output = command(&[scenes[0].clone(), scenes[0].clone()], "twice");
    let text = String::from_utf8(output.stderr).unwrap();
    assert!(!output.status.success() && text.contains("two scenes have the same folder"), "{text}");
    assert!(!folder.join("twice").exists());
}

#[test]
fn every_file_is_there_and_the_page_is_whole() {
    let folder = scratch("report-files").join("made/if/need/be");
    report(&root().join(SINUSOID), &folder, &["--repeat", "1", "--stress", "1"]);
    for (name, title) in [
        ("error-run-time", "error of F_z"),
        ("error-communication-step", "error of F_z"),
        ("tolerance-estimate", "error over tolerance"),
    ] {
        let svg = fs::read_to_string(folder.join(name).with_extension("svg")).unwrap();
        assert!(svg.starts_with("<svg") && svg.contains(title), "{name}");
        let png = fs::read(folder.join(name).with_extension("png")).unwrap();
        assert_eq!(&png[..8], b"\x89PNG\r\n\x1a\n");
    }
    let page = fs::read_to_string(folder.join("index.html")).unwrap();
    assert_eq!(page.matches("<svg").count(), 3);
    // Nothing from elsewhere: the name of SVG's own language is no address to fetch.
    let elsewhere = page.replace("http://www.w3.org/2000/svg", "");
    for sign in ["http", "<link", "<script", "src=", "@import", "url(", "{{"] {
        assert!(!elsewhere.contains(sign), "{sign}");
    }
    for head in ["run time in s", "steps", "rejected", "events", "Newton iterations", "energy residual", "step in s"] {
        assert!(page.contains(&format!("<th class=\"number\">{head}</th>")), "{head}");
    }
    // Each run's figures are in the page as in the table.
    for row in errors(&folder).iter().filter(|row| row["failure"].is_empty()) {
        let cells = ["steps", "events", "newton_iterations"].map(|column| format!(">{}</td>", row[column]));
        assert!(cells.iter().all(|cell| page.contains(cell)), "{row:?}");
        let error = format!(">{:.1e}", number(row, "error_F_x"));
        assert!(page.contains(&error), "{error}");
    }
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
    let page = fs::read_to_string(folder.join("index.html")).unwrap();
    assert!(page.contains("CVODE klu") && page.contains("1234567") && page.contains("quickest peer"));
    assert!(!page.contains("7654321") && !page.contains("cond"));
    // Whole process by whole process: 0.5 s over the 0.2 s of asperity in the same file, whatever it takes here.
    assert!(page.contains("CVODE klu, tolerance 1e-6") && page.contains("asperity event, tolerance 1e-6"));
    assert_eq!(page.matches("<td class=\"number\">2.5</td>").count(), 3, "bounds 1e-3 to 1e-5");
    let rows = errors(&folder);
    let klu: Vec<&Row> = rows.iter().filter(|row| row["method"] == "klu").collect();
    assert_eq!(klu.iter().map(|row| number(row, "run_time")).collect::<Vec<_>>(), [0.25, 0.5]);
    assert!(rows.iter().any(|row| row["method"] == "Radau" && row["failure"] == "no run time"));
    // A table written here has whole processes beside its own runs, and gives those alone as peers.
    let processes = |rows: &[Row]| rows.iter().filter(|row| row["timed"] == "whole process").count();
    assert_eq!(processes(&rows), 4);
    let written = folder.join("written.csv");
    fs::copy(folder.join("error-run-time.csv"), &written).unwrap();
    let again = ["--repeat", "1", "--tolerances", "1e-3..1e-6", "--peers", written.to_str().unwrap()];
    assert!(!report(&root().join(SINUSOID), &folder, &again).contains("no lines"));
    assert_eq!((processes(&errors(&folder)), errors(&folder).len()), (4, rows.len()));
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
    let page = fs::read_to_string(folder.join("index.html")).unwrap();
    assert!(page.contains("class=\"reason\"") && page.contains("solver.max_steps"));
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
    report(&scene, &folder, &["--repeat", "1", "--tolerances", "1e-4..1e-7"]);
    let page = fs::read_to_string(folder.join("index.html")).unwrap();
    assert!(page.contains("The motion is sensitive") && page.contains("1e-12 m"), "{page}");
    assert!(page.contains("means of F_x and F_z over 20 windows"));
    let svg = fs::read_to_string(folder.join("error-run-time.svg")).unwrap();
    assert!(svg.contains("error of F_z, means"));
    let judged = judgements(&folder);
    assert!(!judged.is_empty() && judged.iter().all(|row| row["left_out"] == "sensitive"), "{judged:?}");
    // Runs that stay together say nothing of it.
    report(&root().join(SINUSOID), &folder, &["--repeat", "1", "--tolerances", "1e-4..1e-7"]);
    let page = fs::read_to_string(folder.join("index.html")).unwrap();
    assert!(!page.contains("The motion is sensitive") && page.contains("compared row by row"));
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

/// The factors of a cell, the last empty without a master.
const FACTORS: [&str; 5] = ["stiffness", "mass", "relaxation_times", "speed", "communication_step"];

/// The cells of the scene under stress, without the ladders' runs; and the page.
fn stressed(scene: &Path, folder: &Path, options: &[&str]) -> (Vec<Row>, String) {
    let quick = ["--repeat", "1", "--rows", "10", "--tolerances", "1e-6..1e-6", "--stress", "1"];
    report(scene, folder, &[&quick, options].concat());
    (rows(&folder.join("stress.csv")), fs::read_to_string(folder.join("index.html")).unwrap())
}

/// The cell where these are scaled and nothing else.
fn cell<'a>(cells: &'a [Row], scaled: &[(&str, &str)]) -> &'a Row {
    let factor = |name: &str| {
        let unscaled = if name == "communication_step" { "" } else { "1" };
        scaled.iter().find(|(scaled, _)| *scaled == name).map_or(unscaled, |(_, factor)| *factor)
    };
    cells.iter().find(|row| FACTORS.iter().all(|name| row[*name] == factor(name))).expect("a cell")
}

#[test]
fn a_scene_under_stress_has_a_cell_for_each_pair_of_factors() {
    let folder = scratch("report-stress");
    let (cells, page) = stressed(&root().join(SINUSOID), &folder, &[]);
    // The scene itself; four of its quantities by themselves and in six pairs; and with each of them a master, in
    // communication steps of three lengths.
    assert_eq!(cells.len(), 1 + 4 * 2 + 6 * 4 + 3 * (1 + 4 * 2));
    for (i, row) in cells.iter().enumerate() {
        assert!(cells[..i].iter().all(|other| FACTORS.iter().any(|name| other[*name] != row[*name])), "twice: {row:?}");
        assert!(!row["status"].is_empty() && !row["reason"].is_empty(), "{row:?}");
        let times = number(row, "times_the_steps");
        assert!(times > 0.0 && times <= 20.0 && number(row, "energy_residual") < 1e-4, "{row:?}");
    }
    let unstressed = cell(&cells, &[]);
    assert_eq!((unstressed["status"].as_str(), number(unstressed, "times_the_steps")), ("kept", 1.0));
    assert!(number(unstressed, "error") < 1e-5 && number(unstressed, "error") > 0.0);
    // A master that gives rates follows straight phases exactly: the same run, but for its communication points.
    let driven = cell(&cells, &[("communication_step", "1")]);
    assert!(number(driven, "steps") >= 1000.0 && driven["status"] == "kept", "{driven:?}");
    // Each outcome is in the page as in the table.
    for row in &cells {
        assert!(page.contains(&row["reason"]), "{row:?}");
    }
    // All of them came to their ends, and are held against their tolerance and estimate.
    let judged = judgements(&folder);
    let is_scaled = |row: &&Row| {
        FACTORS.iter().any(|name| !["", "1"].contains(&row[*name].as_str())) || row["communication_step"] == "1"
    };
    assert_eq!(judged.iter().filter(is_scaled).count(), cells.len() - 1);
    assert!(page.contains("<td>event, scaled</td>"));
    assert!(page.contains("<h2>Robustness</h2>") && page.contains("<h3>In pairs</h3>"));
    assert!(page.contains("title=\"stiffness × 10, mass × 10⁻¹: error "));
    assert!(page.contains("stiffness, mass, relaxation times, speed and communication step scaled"));
}

/// A cell is the run of the scene with these values.
#[test]
fn a_stressed_scene_is_the_scene_with_other_values() {
    let folder = scratch("report-stress-values");
    let (cells, _) = stressed(&root().join(SINUSOID), &folder, &[]);
    let same = |cell: &Row, scene: &Path, options: &[&str]| {
        let (others, _) = stressed(scene, &folder, options);
        let other = others.iter().find(|row| FACTORS[..4].iter().all(|name| row[*name] == "1")).unwrap();
        for column in ["steps", "rejected", "events", "newton_iterations", "error", "energy_residual"] {
            assert_eq!(cell[column], other[column], "{column}: {cell:?}, {other:?}");
        }
    };
    let scene = root().join(SINUSOID);
    same(cell(&cells, &[("mass", "10")]), &scene, &["--set", "layer.mass=1e-6"]);
    let stiff =
        ["layer.vertical.stiffness=2e4", "layer.vertical.maxwell[1].stiffness=3e4", "layer.horizontal.stiffness=5e4"];
    let both = [stiff.as_slice(), &["layer.vertical.maxwell[1].relaxation_time=2e-3"]].concat();
    let set: Vec<&str> = both.iter().flat_map(|pair| ["--set", pair]).collect();
    same(cell(&cells, &[("stiffness", "10"), ("relaxation_times", "10")]), &scene, &set);
    let text = fs::read_to_string(&scene).unwrap();
    let fast = text
        .replace("0.0005", "0.00005")
        .replace("-0.12", "-1.2")
        .replace("0.004\nu_rate = 0.5", "0.0004\nu_rate = 5.0");
    let scene = folder.join("fast.toml");
    fs::write(&scene, fast).unwrap();
    same(cell(&cells, &[("speed", "10")]), &scene, &[]);
}

#[test]
fn what_a_scene_does_not_have_is_not_stressed() {
    let folder = scratch("report-stress-absent");
    let scene = changed(&folder, "maxwell = [{ stiffness = 3000.0, relaxation_time = 0.0002 }]", "");
    let (cells, page) = stressed(&scene, &folder, &[]);
    assert_eq!(cells.len(), 1 + 3 * 2 + 3 * 4 + 3 * (1 + 3 * 2));
    assert!(cells.iter().all(|row| row["relaxation_times"] == "1"));
    assert!(page.contains("stiffness, mass, speed and communication step scaled"));
    report(&scene, &folder.join("none"), &["--repeat", "1", "--tolerances", "1e-6..1e-6"]);
    assert!(!folder.join("none/stress.csv").exists());
    assert!(!fs::read_to_string(folder.join("none/index.html")).unwrap().contains("Robustness"));
}

/// Ten times the largest number that a scene may have is none.
#[test]
fn a_cell_that_cannot_be_run_says_why() {
    let folder = scratch("report-stress-refused");
    let longest = ["--set", "layer.vertical.maxwell[1].relaxation_time=1e30", "--stress-time", "0"];
    let (cells, page) = stressed(&root().join(SINUSOID), &folder, &longest);
    let refused = cell(&cells, &[("relaxation_times", "10")]);
    assert_eq!((refused["status"].as_str(), refused["steps"].as_str()), ("stopped", ""));
    assert!(refused["reason"].contains("layer.vertical.maxwell[1].relaxation_time = 1e31: expected"), "{refused:?}");
    assert!(page.contains("<h3>Failures and wrong results</h3>") && page.contains("relaxation times × 10</td>"));
    // Without time, no pair is tried, and it says so.
    let pair = cell(&cells, &[("stiffness", "10"), ("mass", "10")]);
    assert!(pair["status"] == "left out" && page.contains("were not tried: <code>--stress-time</code>"), "{pair:?}");
}
