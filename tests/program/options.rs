//! Options of the commands: which go together, `--set`, standard output, `plot`.

use std::fs;
use std::path::Path;

use crate::common::{Table, asperity, assert_names, root, run, scratch};
use crate::program::output_files::{FLAT, MODULI, RUBBER};

fn sinusoid() -> String {
    root().join("tests/reference/sinusoid.toml").to_str().unwrap().to_owned()
}

/// The message of a command line that is refused.
fn refused(arguments: &[&str]) -> String {
    let output = asperity().args(arguments).output().unwrap();
    assert!(!output.status.success() && output.stdout.is_empty(), "{arguments:?}");
    String::from_utf8(output.stderr).unwrap()
}

/// Options that would be ignored are refused, also where what they name is not there.
#[test]
fn options_that_do_not_go_together_are_refused() {
    let lines = [
        "simulate a.toml -o x.csv --motion none.csv",
        "simulate a.toml -o x.csv --patch p.toml --motion m.csv",
        "simulate --patch p.toml --motion m.csv -o x.csv --rows 3",
        "simulate --patch p.toml --motion m.csv -o x.csv --animate a.html",
        "simulate --patch p.toml --motion m.csv -o x.csv --contact 1=a.png",
        "simulate --patch p.toml --motion m.csv -o x.csv --elements a.npz",
        "describe a.toml --patch p.toml",
        "describe --patch p.toml --json",
        "describe --patch p.toml --plot x.svg",
        "pack a.toml -o x.fmu --check-points 3",
        "pack a.toml -o x.fmu --check a.toml",
        "surface a.csv --mirror --taper",
        "surface a.csv --mirror --periodic",
        "surface a.csv --taper --periodic",
        "sweep a.toml --speeds 1 --forces 1 --pressures 1",
        "sweep a.toml --speeds 1 --forces 1 --shard 1/2 --plot x.svg",
        "sweep --merge a.csv -o x.csv --friction-error 0.1",
        "sweep --merge a.csv -o x.csv --set a=1",
        "sweep --merge a.csv -o x.csv --speeds 1",
        "sweep --merge a.csv -o x.csv --temperatures 300",
        "sweep --merge a.csv -o x.csv --distance 1",
        "sweep --merge a.csv -o x.csv --shard 1/2",
        "sweep a.toml --merge a.csv -o x.csv --speeds 1",
    ];
    for line in lines {
        let message = refused(&line.split(' ').collect::<Vec<_>>());
        assert!(message.contains("cannot be used with"), "{line}: {message}");
    }
    for line in
        ["simulate --patch p.toml -o x.csv", "pack --table t.csv -o x.fmu --check-points 3", "sweep --merge a.csv"]
    {
        let message = refused(&line.split(' ').collect::<Vec<_>>());
        assert!(message.contains("required arguments were not provided"), "{line}: {message}");
    }
    let message = refused(&["pack", "a.toml", "-o", "x.fmu", "--table", "t.csv"]);
    assert_names(&message, "--quantile");
    let message = refused(&["surface", &sinusoid(), "--mirror"]);
    assert_names(&message, "periodic");
}

/// Two files are compared where their rows can be: at the same places, or along an axis that increases in both.
#[test]
fn a_plot_compares_two_files_in_words() {
    let folder = scratch("options-compare");
    let [first, second, picture] = ["first.csv", "second.csv", "out.svg"].map(|name| folder.join(name));
    fs::write(&first, "time,u,F_x,mode\n0,0,0,free\n1,1,-10,stick\n2,0,-20,slip\n").unwrap();
    fs::write(&second, "time,u,F_x,mode\n0,0,0,free\n0.5,1,-5,stick\n1.5,1,-16,stick\n2,0,-20,slip\n").unwrap();
    let compared = |files: &[&Path], options: &[&str]| {
        let mut command = asperity();
        command.arg("plot").args(files).arg("--compare").args(options).arg("-o").arg(&picture);
        command
    };
    let text = run(&mut compared(&[&first, &second], &["--y", "F_x"]));
    // Straight from -5 to -16 N: -10.5 N at 1 s.
    assert_names(&text, "F_x: -0.5 N | time = 1 s | 2.5 % | -20 to 0 N");
    let drawn = fs::read_to_string(&picture).unwrap();
    assert!(drawn.contains("second less first in mN\n") && drawn.contains("difference of F_x\n"), "{drawn}");
    // All columns of numbers, and of them the one that differs most.
    let text = run(&mut compared(&[&first, &first], &[]));
    assert_names(&text, "2 columns are the same");
    let refused = |files: &[&Path], options: &[&str]| {
        String::from_utf8(compared(files, options).output().unwrap().stderr).unwrap()
    };
    let message = refused(&[&first, &second], &["--x", "u", "--y", "F_x"]);
    assert_names(&message, "expected u to increase");
    assert_names(refused(&[&first], &["--y", "F_x"]), "--compare | found 1");
}

/// The first line of a command's help says what the command does, not what its options share.
#[test]
fn help_begins_with_what_the_command_does() {
    let help = run(asperity().arg("--help"));
    let commands = help.lines().filter_map(|line| line.strip_prefix("  ")?.split_once("  "));
    let commands: Vec<_> =
        commands.filter(|(name, _)| !name.is_empty() && !name.starts_with(['-', ' ']) && *name != "help").collect();
    assert_eq!(commands.len(), 19, "{help}");
    for (name, summary) in commands {
        let first = run(asperity().args([name, "--help"]));
        let first = first.lines().next().unwrap();
        assert!(summary.trim().starts_with(first) || first.starts_with(summary.trim()), "{name}: {first}, {summary}");
    }
}

/// Every command's help ends with an example, and in this order they run: of a checkout with nothing else.
#[test]
fn examples_run() {
    let folder = scratch("options-examples");
    for path in ["scenes/tread-block", "scenes/road", "scenes/stiff", "scenes/two-maxima", "docs/guide"] {
        fs::create_dir_all(folder.join(path)).unwrap();
        for file in fs::read_dir(root().join(path)).unwrap().map(|entry| entry.unwrap()) {
            if file.file_type().unwrap().is_file() {
                fs::copy(file.path(), folder.join(path).join(file.file_name())).unwrap();
            }
        }
    }
    let commands = ["simulate", "plot", "describe", "pack", "fit", "material", "surface", "sweep", "converge"];
    let commands = [&commands[..], &["calibrate", "compare", "contact", "completions", "manual", "report"]].concat();
    for name in commands {
        let help = run(asperity().args([name, "--help"]));
        let (_, example) = help.split_once("Example, in a checkout of the repository:\n").unwrap();
        let example = example.replace("\\\n", " ");
        let mut words: Vec<&str> = example.split_whitespace().collect();
        assert_eq!(words[..2], ["asperity", name], "{example}");
        match name {
            // Packing needs a library, which the FMU's tests build, and a report takes its time.
            "pack" | "report" => assert!(folder.join(words[2]).is_file(), "{example}"),
            _ => drop(run(asperity().current_dir(&folder).args(words.split_off(1)))),
        }
    }
}

/// Help is as wide as the terminal.
#[test]
fn help_fits_the_terminal() {
    let widest = |columns: &str| {
        let help = run(asperity().args(["sweep", "--help"]).env("COLUMNS", columns));
        let (options, _) = help.split_once("Example").unwrap();
        options
            .lines()
            .filter(|line| !line.contains("asperity sweep ["))
            .map(|line| line.chars().count())
            .max()
            .unwrap()
    };
    assert!(widest("60") <= 60 && (80..=100).contains(&widest("100")) && widest("200") > 100);
}

/// All keys of a scene can be set, words without quotation marks, lists whole or by their elements; a run is that of the
/// file so changed.
#[test]
fn every_key_can_be_set() {
    let folder = scratch("options-set");
    let out = folder.join("out.csv");
    let run_with = |scene: &str, settings: &[&str]| {
        let settings = settings.iter().flat_map(|setting| ["--set", setting]);
        run(asperity().args(["simulate", scene, "--rows", "3", "-o"]).arg(&out).args(settings));
        fs::read_to_string(&out).unwrap()
    };
    let text = fs::read_to_string(sinusoid()).unwrap();
    let changes = [
        ("masses = 1", "masses = 2", "layer.masses=2"),
        ("amplitude = ", "amplitude = 2e-6 # ", "surface.amplitude=2e-6"),
        ("u_rate = 0.5", "u_rate = 0.25", "excitation[2].u_rate = 0.25"),
        ("outputs = [", "outputs = [\"contact\"] # ", "fmu.outputs=['contact']"),
    ];
    let mut changed = text.clone();
    for (from, to, _) in changes {
        assert!(changed.contains(from), "{from}");
        changed = changed.replacen(from, to, 1);
    }
    let scene = folder.join("changed.toml");
    fs::write(&scene, changed).unwrap();
    let by_file = run_with(scene.to_str().unwrap(), &[]);
    assert_eq!(run_with(&sinusoid(), &changes.map(|(_, _, setting)| setting)), by_file);
    assert!(by_file.starts_with("time,u,w,contact"), "{by_file}");
    // What the file does not have is added.
    let flat =
        run_with(&sinusoid(), &["surface={ kind = 'flat' }", "excitation=[{ duration = 1e-3, w_rate = -0.12 }]"]);
    assert_eq!(flat.lines().count(), 5);
    assert!(run_with(&sinusoid(), &["friction.coulomb=0.5", "fmu.outputs=['dissipation']"]).contains("E_friction"));
}

/// A key that is refused is told in one line with the keys that there are.
#[test]
fn a_setting_that_is_refused_says_which_keys_there_are() {
    let refused = |setting: &str| refused(&["simulate", &sinusoid(), "-o", "x.csv", "--set", setting]);
    for (setting, wanted) in [
        ("layer.massses=2", "--set: layer.massses: unknown | masses, spacing,"),
        ("relative_tolerance=1e-3", "solver.relative_tolerance?"),
        ("fmu.outputs=['force']", "--set: fmu.outputs[1] = \"force\": | \"forces\""),
        ("solver.method=steps", "--set: solver.method = \"steps\":"),
        ("layer.mass=-1", "--set: layer.mass = -1"),
        ("layer.masses=1.5", "--set: layer.masses = 1.5: | whole number"),
        ("excitation[9].duration=1", "--set: excitation[9].duration = 1: | 2 elements"),
        ("surface.kind=flat", "--set: surface.amplitude: unknown | kind"),
    ] {
        let message = refused(setting);
        assert_names(&message, wanted);
        assert_eq!(message.lines().count(), 1, "{message}");
        assert!(message.matches("did you mean").count() <= 1, "{setting}: {message}");
    }
}

/// A patch is set like a scene.
#[test]
fn a_patch_is_set_by_its_keys() {
    let folder = scratch("options-patch");
    let patch = root().join("tests/reference/patch/block.toml");
    let [motion, out] = ["motion.csv", "out.csv"].map(|name| folder.join(name));
    fs::write(&motion, "time,x,y,z,roll,pitch,yaw\n0,0,0,0,0,0,0\n1e-3,0,0,0,0,0,0\n").unwrap();
    let simulate = |settings: &[&str]| {
        let mut command = asperity();
        command.args(["simulate", "--patch"]).arg(&patch).arg("--motion").arg(&motion).arg("-o").arg(&out);
        command.args(settings.iter().flat_map(|setting| ["--set", setting]));
        command
    };
    run(&mut simulate(&["solver.refine=4", "fmu.outputs=[\"contact\"]", "patch.offset=[0.0, 0.0, 1.0]"]));
    let table = Table::read(&out);
    // A metre above the ground nothing bears.
    assert!(table.names().contains(&"contact.count".to_owned()));
    assert!(table.column("contact.count").iter().all(|&count| count == 0.0));
    let refused = simulate(&["patch.radiuss=1"]).output().unwrap();
    let message = String::from_utf8(refused.stderr).unwrap();
    assert_names(&message, "--set: patch.radiuss: unknown | shape");
}

/// `-o -` writes what the file would hold, and the summary goes elsewhere.
#[test]
fn tables_go_to_standard_output() {
    let folder = scratch("options-stdout");
    let out = folder.join("out.csv");
    let profile = "x [m],z [m]\n0,0\n1e-4,1e-5\n2e-4,0\n3e-4,-1e-5\n4e-4,1e-5\n";
    let files = [("rubber.toml", RUBBER), ("flat.toml", FLAT), ("dma.csv", MODULI), ("road.csv", profile)];
    let files = files.map(|(name, text)| {
        fs::write(folder.join(name), text).unwrap();
        folder.join(name).display().to_string()
    });
    let [rubber, flat, moduli, profile] = files.each_ref().map(String::as_str);
    let scene = sinusoid();
    for (arguments, option) in [
        (&["simulate", &scene, "--rows", "3", "--set", "fmu.outputs=['forces']"][..], "-o"),
        (&["material", rubber], "-o"),
        (&["sweep", flat, "--speeds", "0.1,1", "--forces", "0.5,1"], "-o"),
        (&["fit", moduli, "--fit-error", "0.2", "--plot", "fit.svg"], "-o"),
        (&["surface", profile], "--write"),
        (&["surface", profile, "--mirror"], "--write"),
    ] {
        let command = |output: &Path| {
            let mut command = asperity();
            command.args(arguments).arg(option).arg(output).current_dir(&folder);
            command
        };
        run(&mut command(&out));
        assert_eq!(run(&mut command(Path::new("-"))), fs::read_to_string(&out).unwrap(), "{arguments:?}");
        fs::remove_file(&out).unwrap();
    }
    assert!(!folder.join("-").exists() && !folder.join("-.svg").exists());
    // Of a study all but the run times is the same.
    let study = ["converge", rubber, "--pressure", "1e4", "--speed", "0.1", "--error", "1", "--most-masses", "16"];
    let output = asperity().args(study).args(["-o", "-"]).output().unwrap();
    assert!(output.stdout.starts_with(b"# asperity converge = 3\n") && output.stdout.ends_with(b"\n"));
    assert!(String::from_utf8(output.stderr).unwrap().contains("Verdict"));
}

/// The table of a sweep: units in its header, a text for its status, points that are not steady.
const SWEPT: &str = "# asperity sweep = 1\nspeed [m/s],pressure [Pa],temperature [K],status,friction [1],P_friction [W],w [m]\n\
                     0.1,100000,,steady,0.3,1e-3,-1e-5\n1,100000,,steady,0.4,1e-2,-2e-5\n10,100000,,\"not steady, yet\",,,\n\
                     0.1,200000,,steady,0.5,2e-3,-3e-5\n1,200000,,steady,0.6,3e-2,-4e-5\n";

#[test]
fn a_plot_has_a_chart_a_unit_and_draws_the_rows_asked_for() {
    let folder = scratch("options-plot");
    let [table, picture] = ["swept.csv", "out.svg"].map(|name| folder.join(name));
    fs::write(&table, SWEPT).unwrap();
    let plot = |options: &[&str]| {
        let mut command = asperity();
        command.arg("plot").arg(&table).args(["--x", "speed"]).args(options).arg("-o").arg(&picture);
        command
    };
    let drawn = |options: &[&str]| {
        run(&mut plot(options));
        fs::read_to_string(&picture).unwrap()
    };
    let text = drawn(&["--y", "friction", "--y", "P_friction [W]", "--log", "x", "--where", "pressure=1e5"]);
    // Each quantity at its own axis: a coefficient has no unit, and none of the other's.
    for title in ["friction\n", "P_friction [W] in mW\n", "speed in m/s\n"] {
        assert!(text.contains(title), "{title}: {text}");
    }
    // The title of a chart's axis stands upright. A disc for each of two rows in two charts, and in two legends.
    let counted = |text: &str| ["rotate(-90", "<circle"].map(|found| text.matches(found).count());
    assert_eq!(counted(&text), [2, 2 * 2 + 2]);
    let of_two = drawn(&["--y", "friction", "--where", "status=steady", "--where", "pressure=200000"]);
    assert_eq!(counted(&of_two), [1, 3]);
    assert_eq!(counted(&drawn(&["--y", "friction", "--log", "x,y"])), [1, 5]);
    let refused = |options: &[&str]| String::from_utf8(plot(options).output().unwrap().stderr).unwrap();
    let message = refused(&["--y", "friction", "--where", "pressure=3e5"]);
    assert_names(&message, "pressure = 3e5 | 100000, 200000");
    let message = refused(&["--y", "status"]);
    assert_names(&message, "3: status = | --where");
    assert_names(refused(&["--y", "friction", "--log", "z"]), "--log | x, y");
    let message = refused(&["--y", "friction", "--where", "pressure=1e5", "--where", "speed=5"]);
    assert_names(&message, "speed = 5");
}

/// More rows of results, or of each run of a report, than any machine has memory for.
#[test]
fn counts_beyond_the_memory_are_refused() {
    let folder = scratch("options-memory");
    let block = root().join("scenes/tread-block/tread-block.toml");
    for command in ["simulate", "report"] {
        let output = folder.join(format!("{command}.csv"));
        let arguments = [command, block.to_str().unwrap(), "-o", output.to_str().unwrap(), "--rows", "4294967295"];
        let message = refused(&arguments);
        assert!(message.contains("--rows: ") && message.contains("MB of memory"), "{command}: {message}");
        assert!(!output.exists(), "{command}");
    }
}

/// What cannot be written is no success, and no system bears a million threads.
#[test]
#[cfg(target_os = "linux")]
fn help_that_is_lost_fails_and_threads_are_bounded() {
    for arguments in [&["--help"][..], &["rank", "--help"], &["--version"]] {
        let full = fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
        let output = asperity().args(arguments).stdout(full).output().unwrap();
        assert!(!output.status.success() && !output.stderr.is_empty(), "{arguments:?}");
    }
    let output = asperity().args(["describe", &sinusoid()]).env("RAYON_NUM_THREADS", "1000000").output().unwrap();
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success(), "{said}");
    assert_names(&said, "RAYON_NUM_THREADS");
}
