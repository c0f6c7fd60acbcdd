//! Nothing is lost: outputs take their places whole, no input is overwritten, tables have one writer at a time and are
//! continued, whatever ends a command.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use crate::common::{asperity, assert_names, run, scratch};

/// Four masses on a plane: a point of a sweep takes some milliseconds.
pub(super) const FLAT: &str = "name = 'plane'
layer = { masses = 4, spacing = 1e-4, mass = 1e-7, vertical = { stiffness = 2e3, damping = 3e-2 }, \
          horizontal = { stiffness = 5e3, damping = 3e-2 } }
surface = { kind = 'flat' }
friction = { coulomb = 0.3 }
solver = { method = 'step', relative_tolerance = 1e-4 }
[[excitation]]
duration = 1e-3
w_rate = -1e-3
";

/// Rubber on a sinusoid, for studies of convergence.
pub(super) const RUBBER: &str = "name = 'rubber'
layer = { foundation = 'springs', masses = 8, spacing = 2.5e-5, thickness = 1e-3, width = 1e-2 }
material = { density = 1100, poisson_ratio = 0.49, equilibrium_modulus = 2e6, prony = [] }
surface = { kind = 'sinusoid', amplitude = 1e-6, wavelength = 2e-4 }
friction = { coulomb = 0.2 }
solver = { method = 'step', relative_tolerance = 1e-3 }
[[excitation]]
duration = 1e-5
w_rate = -1e-3
";

fn written(path: PathBuf, text: &str) -> PathBuf {
    fs::write(&path, text).unwrap();
    path
}

fn text(path: &Path) -> &str {
    path.to_str().unwrap()
}

/// What the program says as it fails.
fn refused(arguments: &[&str]) -> String {
    let output = asperity().args(arguments).output().unwrap();
    assert_eq!(output.status.code(), Some(1), "{arguments:?}: {output:?}");
    String::from_utf8(output.stderr).unwrap()
}

pub(super) const MODULI: &str =
    "frequency [Hz],E' [Pa],E'' [Pa]\n0.1,1.1e6,2e5\n1,1.3e6,3e5\n10,1.6e6,4e5\n100,2e6,4e5\n1000,2.4e6,3e5\n";

/// Every command that writes a file: its arguments before `-o`, and others that make it write another file.
fn commands(folder: &Path) -> Vec<(&'static str, Vec<String>, Vec<String>)> {
    let scene = written(folder.join("scene.toml"), RUBBER);
    let library = written(folder.join("any.so"), &"a library".repeat(20_000));
    let moduli = written(folder.join("dma.csv"), MODULI);
    let heights: String =
        (0..2000).map(|i| format!("{:e},{:e}\n", 1e-6 * f64::from(i), 1e-6 * f64::from(i * 37 % 101))).collect();
    let profile = written(folder.join("road.csv"), &format!("x [m],z [m]\n{heights}"));
    let result = written(folder.join("result.csv"), "time,u,F_x\n0,0,1\n1,1,2\n2,3,1\n");
    let owned = |arguments: &[&str]| arguments.iter().map(|&argument| argument.to_owned()).collect::<Vec<_>>();
    let (scene, library, moduli, profile, result) =
        (text(&scene), text(&library), text(&moduli), text(&profile), text(&result));
    vec![
        ("simulated.csv", owned(&["simulate", scene]), owned(&["--rows", "20000"])),
        ("packed.fmu", owned(&["pack", scene, "--library", library]), owned(&["--library", "win64=any.so"])),
        ("plotted.svg", owned(&["plot", result, "--y", "F_x"]), owned(&["--title", "another"])),
        ("plotted.png", owned(&["plot", result, "--y", "F_x"]), owned(&["--title", "another"])),
        ("material.csv", owned(&["material", scene]), owned(&["--frequencies", "1..1e9"])),
        ("fitted.csv", owned(&["fit", moduli, "--fit-error", "0.1"]), owned(&["--viscosity"])),
        ("surface.svg", owned(&["surface", profile]), owned(&["--smooth", "1e-5"])),
    ]
}

fn program(arguments: &[String], output: &Path, folder: &Path) -> Command {
    let mut command = asperity();
    command.args(arguments).arg("-o").arg(output).current_dir(folder).stdout(Stdio::null()).stderr(Stdio::null());
    command
}

/// Kills a command after a time; whether that found it still running makes no difference.
fn killed_after(mut command: Command, time: Duration) {
    let mut child = command.spawn().unwrap();
    sleep(time);
    child.kill().unwrap();
    child.wait().unwrap();
}

/// Moments of a command at which it is killed.
const MOMENTS: u32 = 6;

/// Whenever a command is killed, its output is the one of before or the new one, to the last byte.
#[test]
fn a_command_that_is_killed_leaves_the_old_file_or_the_new_one() {
    let folder = scratch("output-files-killed");
    for (name, arguments, others) in commands(&folder) {
        let output = folder.join(name);
        let changed = [arguments.clone(), others].concat();
        assert!(program(&changed, &output, &folder).status().unwrap().success(), "{changed:?}");
        let new = fs::read(&output).unwrap();
        let begin = Instant::now();
        assert!(program(&arguments, &output, &folder).status().unwrap().success(), "{arguments:?}");
        let time = begin.elapsed();
        let old = fs::read(&output).unwrap();
        assert!(old != new, "{name} is the same with other arguments");
        for moment in 1..=MOMENTS {
            fs::write(&output, &old).unwrap();
            killed_after(program(&changed, &output, &folder), time * moment / MOMENTS);
            let found = fs::read(&output).unwrap();
            assert!(found == old || found == new, "{name} has {} bytes", found.len());
        }
    }
}

/// A table that is continued keeps the rows that it had, and is completed to the same bytes.
#[test]
fn a_table_whose_command_is_killed_keeps_its_rows() {
    let folder = scratch("output-files-killed-table");
    let scene = written(folder.join("scene.toml"), FLAT);
    let table = folder.join("table.csv");
    let arguments = |speeds: &str| ["sweep", text(&scene), "--forces", "0.5,1,2", "--speeds", speeds].map(String::from);
    let (few, many) = (arguments("0.1..1/4"), arguments("0.1..1/4,2..8/8"));
    assert!(program(&many, &table, &folder).status().unwrap().success());
    let new = fs::read(&table).unwrap();
    fs::remove_file(&table).unwrap();
    let begin = Instant::now();
    assert!(program(&few, &table, &folder).status().unwrap().success());
    let time = 2 * begin.elapsed();
    let old = fs::read_to_string(&table).unwrap();
    let rows =
        |text: &str| -> Vec<String> { text.lines().filter(|line| !line.starts_with('#')).map(String::from).collect() };
    for moment in 1..=MOMENTS {
        fs::write(&table, &old).unwrap();
        killed_after(program(&many, &table, &folder), time * moment / MOMENTS);
        let found = rows(&fs::read_to_string(&table).unwrap());
        assert!(rows(&old).iter().all(|row| found.contains(row)), "{found:?}");
        assert!(program(&many, &table, &folder).status().unwrap().success());
        assert!(fs::read(&table).unwrap() == new);
    }
}

/// A report, killed, has whole files alone.
#[test]
fn a_report_that_is_killed_has_whole_files() {
    let folder = scratch("output-files-killed-report");
    let scene = written(folder.join("scene.toml"), FLAT);
    let arguments =
        ["report", text(&scene), "--tolerances", "1e-2..1e-4", "--repeat", "1", "--stress", "0"].map(String::from);
    let report = folder.join("report");
    let begin = Instant::now();
    assert!(program(&arguments, &report, &folder).status().unwrap().success());
    let time = begin.elapsed();
    for moment in 1..=MOMENTS {
        killed_after(program(&arguments, &report, &folder), time * moment / MOMENTS);
        for entry in fs::read_dir(&report).unwrap().map(|entry| entry.unwrap().path()) {
            let bytes = fs::read(&entry).unwrap();
            let end: &[u8] = match entry.extension().and_then(|ending| ending.to_str()) {
                Some("html") => b"</html>\n",
                Some("svg") => b"</svg>\n",
                Some("png") => b"IEND\xaeB`\x82",
                Some("csv") => b"\n",
                _ => continue,
            };
            assert!(bytes.ends_with(end), "{} has {} bytes", entry.display(), bytes.len());
        }
    }
}

/// A run that cannot start, or is refused, touches nothing.
#[test]
fn a_run_that_does_not_start_leaves_what_was_there() {
    let folder = scratch("output-files-start");
    let scene = written(folder.join("scene.toml"), FLAT);
    let output = written(folder.join("out.csv"), "precious\n");
    let arguments = ["simulate", text(&scene), "-o", text(&output)];
    refused(&[&arguments[..], &["--set", "layer.masses=0"]].concat());
    refused(&["simulate", text(&scene), "-o", text(&folder.join("new.csv")), "--plot", "nowhere/out.svg"]);
    let names: Vec<_> = fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert_eq!((names.len(), fs::read_to_string(&output).unwrap().as_str()), (2, "precious\n"), "{names:?}");
    run(asperity().args(arguments));
    assert!(fs::read_to_string(&output).unwrap().starts_with("time,u,w"));
}

#[cfg(unix)]
mod unix {
    use std::os::unix::fs::symlink;

    use super::*;

    /// By another name too: a link of either kind.
    #[test]
    fn no_output_takes_the_place_of_an_input_by_whatever_name() {
        let folder = scratch("output-files-inputs");
        let flat = written(folder.join("flat.toml"), FLAT);
        let study = written(folder.join("study.csv"), "");
        for (name, arguments, _) in commands(&folder) {
            let ending = name.rsplit('.').next().unwrap();
            // The last file that is read: a library for an FMU.
            let input = arguments.iter().rev().find(|argument| Path::new(argument).exists()).unwrap();
            for kind in ["hard", "soft"] {
                let output = folder.join(format!("{kind}-{name}.{ending}"));
                if kind == "hard" { fs::hard_link(input, &output) } else { symlink(input, &output) }.unwrap();
                let before = fs::read(input).unwrap();
                let arguments: Vec<&str> = arguments.iter().map(String::as_str).chain(["-o", text(&output)]).collect();
                let message = refused(&arguments);
                assert!(message.contains("will not write"), "{arguments:?}: {message}");
                assert!(fs::read(input).unwrap() == before);
            }
        }
        let sweep = ["sweep", text(&flat), "--speeds", "1", "--forces", "1", "--converged", text(&study)];
        let link = folder.join("link.csv");
        fs::hard_link(&study, &link).unwrap();
        for others in [["-o", text(&link)], ["--plot", "../output-files-inputs/flat.svg"]] {
            symlink(&flat, folder.join("flat.svg")).ok();
            let output = asperity().args(sweep).args(others).current_dir(&folder).output().unwrap();
            let message = String::from_utf8(output.stderr).unwrap();
            assert!(message.contains("will not write"), "{others:?}: {message}");
        }
        // Two outputs that are one file, which is not there yet.
        let message = refused(&[
            "simulate",
            text(&flat),
            "-o",
            text(&folder.join("a.svg")),
            "--plot",
            text(&folder.join("../output-files-inputs/a.svg")),
        ]);
        assert!(message.contains("will not write"), "{message}");
    }

    /// A pipe waits for its writer, and a device has no end: neither is read.
    #[test]
    fn regular_files_alone_are_read() {
        let folder = scratch("output-files-regular");
        let pipe = folder.join("pipe.csv");
        run(Command::new("mkfifo").arg(&pipe));
        let scene = written(
            folder.join("scene.toml"),
            &FLAT.replace("{ kind = 'flat' }", "{ kind = 'file', path = 'pipe.csv' }"),
        );
        let compound = written(folder.join("compound.toml"), &RUBBER.replace("prony = []", "prony = 'pipe.csv'"));
        let (pipe, out) = (text(&pipe), text(&folder.join("out.csv")).to_owned());
        for arguments in [
            &["describe", pipe][..],
            &["describe", text(&scene)],
            &["describe", text(&compound)],
            &["describe", "/dev/zero"],
            &["describe", "--patch", "/dev/zero"],
            &["surface", pipe],
            &["fit", "/dev/zero", "-o", &out],
            &["plot", pipe, "--y", "u", "-o", "out.svg"],
            &["pack", "--table", "/dev/zero", "-o", "out.fmu"],
            &["sweep", "--merge", "/dev/zero", "-o", &out],
        ] {
            let message = refused(arguments);
            assert_names(&message, "regular file");
        }
    }

    /// A pipe that somebody reads is an output; to look into it would be to wait for its end.
    #[test]
    #[cfg(unix)]
    fn a_named_pipe_is_written() {
        let folder = scratch("output-files-pipe");
        let (pipe, scene) = (folder.join("pipe"), written(folder.join("scene.toml"), FLAT));
        run(Command::new("mkfifo").arg(&pipe));
        let reader = std::thread::spawn({
            let pipe = pipe.clone();
            move || fs::read_to_string(pipe).unwrap()
        });
        run(asperity().args(["simulate", text(&scene), "-o", text(&pipe), "--rows", "3", "-q"]));
        assert!(reader.join().unwrap().starts_with("time"));
    }

    /// Where the disk is full the command ends with the reason.
    #[test]
    #[cfg(target_os = "linux")]
    fn a_write_error_ends_the_run_with_the_reason() {
        let folder = scratch("output-files-full");
        for (_, arguments, _) in commands(&folder).into_iter().filter(|(name, ..)| name.ends_with("csv")) {
            // A picture needs its ending, so tables alone go to the device.
            let mut arguments: Vec<&str> = arguments.iter().map(String::as_str).chain(["-o"]).collect();
            let link = folder.join(format!("{}.csv", arguments[0]));
            symlink("/dev/full", &link).unwrap();
            arguments.push(text(&link));
            let plot = folder.join("plot.svg");
            if arguments[0] == "fit" {
                arguments.extend(["--plot", text(&plot)]);
            }
            let message = refused(&arguments);
            assert!(message.contains("cannot write") && message.contains("No space left"), "{arguments:?}: {message}");
        }
    }

    /// A sweep that is interrupted says how to go on, and goes on.
    #[test]
    fn an_interrupted_sweep_says_how_to_go_on() {
        let folder = scratch("output-files-interrupted");
        let scene = written(folder.join("scene.toml"), FLAT);
        let table = folder.join("table.csv");
        let mut sweep = asperity();
        sweep.args([
            "sweep",
            text(&scene),
            "-o",
            text(&table),
            "--force",
            "--speeds",
            "0.1..1/3000",
            "--forces",
            "0.5,1,2",
        ]);
        let child = sweep.stderr(Stdio::piped()).stdout(Stdio::null()).spawn().unwrap();
        // It has thousands of points to go when the first ones are done.
        let rows =
            || fs::read_to_string(&table).map_or(0, |text| text.lines().filter(|line| line.contains("steady")).count());
        while rows() < 3 {
            sleep(Duration::from_millis(5));
        }
        run(Command::new("kill").args(["-INT", &child.id().to_string()]));
        let output = child.wait_with_output().unwrap();
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(130), "{message}");
        let go_on =
            message.lines().find_map(|line| line.split_once("to go on: ")).unwrap_or_else(|| panic!("{message}")).1;
        assert!(go_on.contains("sweep") && !go_on.contains("--force "), "{message}");
        assert!(message.contains(" of 9000 points are done"), "{message}");
        let left: Vec<_> = fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().file_name()).collect();
        assert_eq!(left.len(), 2, "{left:?}");
        assert!(rows() >= 3);
    }
}

/// A second command on the same table is told who writes it.
#[test]
fn a_table_has_one_writer_at_a_time() {
    let folder = scratch("output-files-lock");
    let scene = written(folder.join("scene.toml"), FLAT);
    let table = folder.join("table.csv");
    let sweep = ["sweep", text(&scene), "-o", text(&table), "--speeds", "1", "--forces", "1"];
    let held = written(folder.join("table.csv.lock"), "process 4711 (asperity sweep other.toml)\n");
    let lock = fs::File::open(&held).unwrap();
    lock.try_lock().unwrap();
    let message = refused(&sweep);
    assert_names(&message, "process 4711 (asperity sweep other.toml)");
    assert!(!table.exists());
    // A holder that has ended, however, holds it no more.
    drop(lock);
    run(asperity().args(sweep));
    assert!(table.exists() && !held.exists());
}

/// Rows that no sweep has written so are named and computed again; those that are whole are kept.
#[test]
fn corrupt_rows_are_named_and_computed_again() {
    let folder = scratch("output-files-corrupt");
    let scene = written(folder.join("scene.toml"), FLAT);
    let table = folder.join("table.csv");
    let sweep = || {
        asperity()
            .args(["sweep", text(&scene), "-o", text(&table), "--speeds", "0.1,1", "--forces", "1,2"])
            .output()
            .unwrap()
    };
    assert!(sweep().status.success());
    let whole = fs::read_to_string(&table).unwrap();
    let row = whole.lines().position(|line| line.contains("steady")).unwrap() + 1;
    let line = whole.lines().nth(row).unwrap();
    let fields: Vec<&str> = line.split(',').collect();
    let with = |column: usize, value: &str| {
        let mut fields = fields.clone();
        fields[column] = value;
        fields.join(",")
    };
    for (corrupt, why) in [
        (line[..line.len() / 2].to_owned(), "fields, expected"),
        ("\0".repeat(line.len()), "fields, expected"),
        (with(4, "0.3x"), "friction [1] = \"0.3x\": expected a number"),
        (with(4, ""), "friction [1] = \"\": expected a number"),
        (with(4, "inf"), "friction [1] = \"inf\": expected a number"),
        (with(0, "0.7"), "a point that the header does not have"),
        (with(0, "fast"), "speed [m/s] = \"fast\": expected a number"),
    ] {
        fs::write(&table, whole.replacen(line, &corrupt, 1)).unwrap();
        let output = sweep();
        let message = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.success(), "{corrupt:?}: {message}");
        let place = format!("table.csv:{}: ", row + 1);
        assert!(
            message.contains(&place) && message.contains(why) && message.contains("computed again"),
            "{why}: {message}"
        );
        assert_eq!(fs::read_to_string(&table).unwrap(), whole);
    }
    // The same point twice.
    fs::write(&table, format!("{whole}{line}\n")).unwrap();
    assert_names(String::from_utf8(sweep().stderr).unwrap(), "the same point");
    assert_eq!(fs::read_to_string(&table).unwrap(), whole);
}

/// `--merge` adds to a table of the same sweep and takes the place of no other file.
#[test]
fn merged_tables_take_the_place_of_no_other_file() {
    let folder = scratch("output-files-merge");
    let scene = written(folder.join("scene.toml"), FLAT);
    let [table, shard, joined, other] =
        ["table.csv", "shard.csv", "joined.csv", "other.csv"].map(|name| folder.join(name));
    let sweep = |output: &Path, options: &[&str]| {
        let points = ["--speeds", "0.1,1", "--forces", "1,2"];
        run(asperity().args(["sweep", text(&scene), "-o", text(output)]).args(points).args(options))
    };
    sweep(&table, &[]);
    sweep(&shard, &["--shard", "1/2"]);
    sweep(&joined, &["--shard", "2/2"]);
    sweep(&other, &["--set", "friction.coulomb=0.5"]);
    let notes = written(folder.join("notes.csv"), "time,u\n0,0\n");
    let merge = |output: &Path| ["sweep", "--merge", text(&shard), "-o", text(output)].map(String::from);
    let refused = |output: &Path| refused(&merge(output).iter().map(String::as_str).collect::<Vec<_>>());
    let before = [&notes, &other].map(|path| fs::read(path).unwrap());
    assert_names(refused(&notes), "# asperity sweep = 1");
    assert_names(refused(&other), "another sweep");
    assert!(before == [&notes, &other].map(|path| fs::read(path).unwrap()));
    // What is there of the same sweep is kept.
    run(asperity().args(merge(&joined)));
    assert!(fs::read(&joined).unwrap() == fs::read(&table).unwrap());
    let forced = asperity().args(merge(&notes)).arg("--force").output().unwrap();
    assert_names(String::from_utf8(forced.stderr).unwrap(), "2 of 4 points");
    assert!(fs::read_to_string(&notes).unwrap().starts_with("# asperity sweep"));
}

/// Rows of a study that are corrupt are made again.
#[test]
fn corrupt_rows_of_a_study_are_made_again() {
    let folder = scratch("output-files-study");
    let scene = written(folder.join("scene.toml"), RUBBER);
    let table = folder.join("study.csv");
    let study = || {
        let options = ["--pressure", "1e5", "--speed", "0.1", "--most-masses", "16", "--error", "1"];
        asperity().args(["converge", text(&scene), "-o", text(&table)]).args(options).output().unwrap()
    };
    let first = study();
    assert!(matches!(first.status.code(), Some(0 | 3)), "{first:?}");
    let numbers = |text: &str| -> Vec<String> {
        // All but the run time, which is the last.
        text.lines().filter_map(|line| Some(line.rsplit_once(',')?.0.to_owned())).collect()
    };
    let whole = fs::read_to_string(&table).unwrap();
    let last = whole.lines().last().unwrap();
    fs::write(&table, whole.replacen(last, &last[..last.len() - 30], 1)).unwrap();
    let message = String::from_utf8(study().stderr).unwrap();
    let place = format!("study.csv:{}: ", whole.lines().count());
    assert!(message.contains(&place) && message.contains("fields, expected 25"), "{message}");
    assert_eq!(numbers(&fs::read_to_string(&table).unwrap()), numbers(&whole));
}
