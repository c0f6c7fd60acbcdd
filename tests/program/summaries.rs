//! What a command says at its end: a run in a few lines, what it cost, a sweep's table; and less or more of it.

use std::path::{Path, PathBuf};
use std::process::Output;

use crate::common::{Table, asperity, root, scratch};

fn ended(arguments: &[&str], folder: &Path) -> Output {
    let output = asperity().args(arguments).current_dir(folder).output().unwrap();
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    output
}

fn text(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes).unwrap()
}

/// The line with this label.
fn line<'a>(summary: &'a str, label: &str) -> &'a str {
    let found = summary.lines().find(|line| line.starts_with(label));
    found.unwrap_or_else(|| panic!("no {label} in {summary}"))
}

fn scene(name: &str) -> PathBuf {
    root().join("scenes").join(name)
}

/// The mean friction is the work along the way over that of the load, as the rows of the file have it.
#[test]
fn a_run_ends_with_its_result_in_a_few_lines() {
    let folder = scratch("summaries-run");
    let block = scene("tread-block/tread-block.toml");
    let output = ended(&["simulate", block.to_str().unwrap(), "-o", "out.csv", "--stats"], &folder);
    let summary = text(&output.stdout);
    let table = Table::read(&folder.join("out.csv"));
    let [u, f_x, f_z] = ["u", "F_x", "F_z"].map(|name| table.column(name));
    let (mut work, mut load) = (0.0, 0.0);
    for i in 1..u.len() {
        work += 0.5 * (f_x[i] + f_x[i - 1]) * (u[i] - u[i - 1]);
        load += 0.5 * (f_z[i] + f_z[i - 1]) * (u[i] - u[i - 1]).abs();
    }
    let friction: f64 = line(summary, "Friction").split_whitespace().nth(1).unwrap().parse().unwrap();
    // Four digits are printed.
    assert!((friction / (work.abs() / load) - 1.0).abs() < 1e-3, "{friction} for {}", work.abs() / load);
    let last = |name: &str| *table.column(name).last().unwrap() as u64;
    let contact = format!("{} of 100 masses at the end, {} of them", last("contact.count"), last("contact.sticking"));
    assert!(line(summary, "Contact").contains(&contact), "{summary}");
    assert!(line(summary, "Dissipated").contains("friction ") && line(summary, "Written").ends_with("out.csv"));
    assert!(line(summary, "Run").contains("error not estimated"), "{summary}");
    // Events end most of its steps.
    assert!(summary.contains("events a step") && line(summary, "Cheaper by").contains("\"step\""), "{summary}");
    assert!(summary.lines().all(|line| line.chars().count() <= 120), "{summary}");
}

#[test]
fn the_group_solver_adds_the_estimated_error() {
    let folder = scratch("summaries-error");
    let block = scene("figure-7/high.toml").to_str().unwrap().to_owned();
    let outputs = "fmu.outputs=['forces', 'solver']";
    let output = ended(&["simulate", &block, "-o", "out.csv", "--set", outputs], &folder);
    assert!(line(text(&output.stdout), "Run").contains("estimated error"), "{}", text(&output.stdout));
}

#[test]
fn quiet_runs_say_their_results_alone_and_results_on_standard_output_stay_alone() {
    let folder = scratch("summaries-quiet");
    let block = scene("tread-block/tread-block.toml").to_str().unwrap().to_owned();
    let quiet = ended(&["-q", "simulate", &block, "-o", "out.csv"], &folder);
    assert!(text(&quiet.stdout).contains("Friction") && !text(&quiet.stdout).contains("Written"));
    assert_eq!(text(&quiet.stderr), "");
    let quiet = ended(&["-q", "material", &block, "-o", "moduli.csv"], &folder);
    assert!(text(&quiet.stdout).contains("equilibrium") && !text(&quiet.stdout).contains("Written"));
    let piped = ended(&["simulate", &block, "-o", "-"], &folder);
    assert_eq!(text(&piped.stdout), std::fs::read_to_string(folder.join("out.csv")).unwrap());
    assert!(text(&piped.stderr).contains("Friction"), "{}", text(&piped.stderr));
}

/// The tester's carriage sticks and slips, so that the method goes to and fro.
#[test]
fn switches_of_the_method_are_one_line_unless_all_are_asked_for() {
    let folder = scratch("summaries-switches");
    let tester = scene("tester/tester.toml").to_str().unwrap().to_owned();
    let brief = ended(&["simulate", &tester, "-o", "out.csv"], &folder);
    let notes: Vec<&str> = text(&brief.stderr).lines().filter(|line| line.contains("time-stepping")).collect();
    assert!(matches!(notes[..], [note] if note.contains("more switches (-v prints all)")), "{notes:?}");
    let all = ended(&["-v", "simulate", &tester, "-o", "out.csv"], &folder);
    let switches = text(&all.stderr).lines().filter(|line| line.contains("time-stepping from here on")).count();
    assert!(switches > 30, "{switches}");
}

#[test]
fn a_sweep_ends_with_its_table() {
    let folder = scratch("summaries-sweep");
    let road = scene("road/road.toml").to_str().unwrap().to_owned();
    let loads = ["--speeds", "1 mm/s,1 m/s", "--pressures", "1 bar,3 bar"];
    let output = ended(&[&["sweep", &road, "-o", "table.csv"][..], &loads].concat(), &folder);
    let table = Table::read(&folder.join("table.csv"));
    let printed: Vec<Vec<&str>> = text(&output.stdout).lines().map(|line| line.split_whitespace().collect()).collect();
    assert_eq!(printed[0], ["Friction", "293.15", "K", "100", "kPa", "300", "kPa"]);
    for (line, speed, words) in [(1, 1e-3, ["1", "mm/s"]), (2, 1.0, ["1", "m/s"])] {
        assert_eq!(printed[line][..2], words);
        for (column, pressure) in [(2, 1e5), (3, 3e5)] {
            let is_it =
                |row: &usize| table.column("speed")[*row] == speed && table.column("pressure")[*row] == pressure;
            let friction = table.column("friction")[(0..4).find(is_it).unwrap()];
            let found: f64 = printed[line][column].parse().unwrap();
            // Four digits are printed.
            assert!((found / friction - 1.0).abs() < 1e-3, "{:?}", printed[line]);
        }
    }
}

#[test]
fn columns_have_their_units_if_asked_for() {
    let folder = scratch("summaries-units");
    let block = scene("figure-7/high.toml").to_str().unwrap().to_owned();
    ended(&["simulate", &block, "-o", "plain.csv"], &folder);
    ended(&["simulate", &block, "-o", "units.csv", "--units"], &folder);
    let [plain, units] = ["plain.csv", "units.csv"].map(|name| std::fs::read_to_string(folder.join(name)).unwrap());
    let ((plain_head, plain_rows), (head, rows)) = (plain.split_once('\n').unwrap(), units.split_once('\n').unwrap());
    assert!(plain_head.starts_with("time,u,w,F_x,F_z"), "{plain_head}");
    assert!(head.starts_with("time [s],u [m],w [m],F_x [N],F_z [N]"), "{head}");
    assert_eq!(rows, plain_rows);
    ended(&["plot", "units.csv", "plain.csv", "--y", "F_x", "-o", "x.svg"], &folder);
}
