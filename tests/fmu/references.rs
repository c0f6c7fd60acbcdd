//! What an FMU carries by FMI-LS-REF, and its terminal: a manifest that is valid, and an experiment whose result a master gets again.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::common::{
    Table, asperity, assert_names, difference, drive, ended, largest, library, pack, python, root, run, scratch,
};

const FOLDER: &str = "extra/org.fmi-standard.fmi-ls-ref";
/// The terminal of a layer and of an element, as it is printed.
const CARRIER: &str = "terminal carrier u:input w:input F_x:output F_z:output";
/// All files of the folder, bytes.
const MOST: u64 = 100_000;

/// A file of an FMU, in a folder of its own beside it.
fn unpacked(fmu: &Path, name: &str) -> PathBuf {
    let text = "import sys, zipfile; zipfile.ZipFile(sys.argv[1]).extract(sys.argv[2], sys.argv[3])";
    let folder = fmu.with_extension("unpacked");
    run(Command::new(python()).args(["-c", text]).arg(fmu).arg(format!("{FOLDER}/{name}")).arg(&folder));
    folder.join(FOLDER).join(name)
}

/// The roles of the files that an FMU names, after their check; the first line that it prints has the terminal and its
/// members.
fn roles(fmu: &Path, terminal: &str) -> Vec<String> {
    let found = run(Command::new(python()).arg(root().join("tests/python/references.py")).arg(fmu));
    let (first, found) = found.split_once('\n').unwrap();
    assert_eq!(first.trim(), terminal);
    let lines: Vec<Vec<&str>> = found.lines().map(|line| line.split(' ').collect()).collect();
    let own = lines.iter().filter(|line| line[2].starts_with(FOLDER));
    let size: u64 = own.map(|line| line[3].parse::<u64>().unwrap()).sum();
    assert!(size <= MOST, "{found}");
    lines.iter().map(|line| line[0].to_owned()).collect()
}

/// The terminal of a patch, as it is printed, with what is between the parts of names.
fn body(point: &str) -> String {
    let inputs = ["x", "y", "z", "roll", "pitch", "yaw"].map(|name| format!("{name}:input")).join(" ");
    let wrench =
        ["force", "moment"].map(|load| ["x", "y", "z"].map(|axis| format!("{load}{point}{axis}:output")).join(" "));
    format!("terminal body {inputs} {}", wrench.join(" "))
}

/// Drives an FMU along its experiment and compares it with its result, each column over its largest value.
fn assert_reproduces(fmu: &Path, tolerance: f64) {
    let result = Table::read(&unpacked(fmu, "result.csv"));
    let found = drive(fmu, &unpacked(fmu, "experiment.csv"), &[]);
    for name in result.names().iter().filter(|name| *name != "time") {
        let (expected, found) = (result.column(name), found.column(name));
        let error = difference(&expected, &found) / largest(&expected).max(f64::MIN_POSITIVE);
        assert!(error <= tolerance || largest(&found) == 0.0, "{name}: {error:e}");
    }
}

/// The default scene: its tolerance is 1e-6, that of its result a tenth of it; forces are known to some of it.
#[test]
fn the_default_scene_proves_itself() {
    let folder = scratch("references-default");
    let fmu = pack(&root().join("scenes/tread-block/tread-block.toml"), &folder);
    let expected = ["model", "model", "document", "document", "experiment/smoke-test", "other", "result", "parameter"];
    assert_eq!(roles(&fmu, CARRIER), expected);
    assert_reproduces(&fmu, 1e-5);
    let manifest = fs::read_to_string(unpacked(&fmu, "fmi-ls-manifest.xml")).unwrap();
    let (_, error) = manifest.split_once("estimated error is ").unwrap();
    let error: f64 = error.split(' ').next().unwrap().parse().unwrap();
    assert!(error > 0.0 && error < 1e-5, "{error:e}");
}

/// An element and a patch press and slide within their table; their result is exact to the digits that it has.
#[test]
fn elements_and_patches_press_and_slide() {
    let folder = scratch("references-patch");
    let source = root().join("tests/reference/patch");
    for (option, file, terminal) in [("--table", "block.table.csv", CARRIER), ("--patch", "wheel.toml", &body(".")[..])]
    {
        let fmu = folder.join(file).with_extension("fmu");
        let mut pack = asperity();
        pack.args(["pack", option]).arg(source.join(file)).arg("-o").arg(&fmu);
        run(pack.arg("--library").arg(library()));
        assert!(roles(&fmu, terminal).iter().any(|role| role == "experiment/smoke-test"));
        assert_reproduces(&fmu, 1e-7);
        let result = Table::read(&unpacked(&fmu, "result.csv"));
        let force = if option == "--table" { "F_x" } else { "force.x" };
        let force = result.column(force);
        let (low, high) = force.iter().fold((0.0_f64, 0.0_f64), |(low, high), f| (low.min(*f), high.max(*f)));
        assert!(low < 0.0 && high > 0.0, "it slides to and fro: {low} N to {high} N");
    }
}

/// A seal makes a stroke; its result is that of a tenth of its tolerance.
#[test]
fn a_seal_makes_a_stroke() {
    let fmu = scratch("references-seal").join("seal.fmu");
    let mut pack = asperity();
    pack.args(["pack", "--seal"]).arg(root().join("tests/reference/film/film-strokes.toml")).arg("-o").arg(&fmu);
    run(pack.arg("--library").arg(library()));
    let rod = "terminal rod u:input sealed_pressure:input F_x:output F_z:output";
    assert!(roles(&fmu, rod).iter().any(|role| role == "experiment/smoke-test"));
    // The flow to the air is sharp where the stroke turns.
    assert_reproduces(&fmu, 3e-2);
    let verified = run(asperity().arg("verify").arg(&fmu));
    assert!(verified.contains("gets 201 rows"), "{verified}");
}

/// Names are those of the FMU; without references there is no folder.
#[test]
fn names_follow_and_references_are_left_out_on_request() {
    let folder = scratch("references-options");
    let pack = |options: &[&str]| {
        let fmu = folder.join("wheel.fmu");
        let mut pack = asperity();
        pack.args(["pack", "--patch"]).arg(root().join("tests/reference/patch/wheel.toml")).arg("-o").arg(&fmu);
        run(pack.arg("--library").arg(library()).args(options));
        fmu
    };
    let flat = pack(&["--flat-names"]);
    roles(&flat, &body("_"));
    let head = fs::read_to_string(unpacked(&flat, "result.csv")).unwrap();
    assert!(head.starts_with("\"time\",\"force_x\","), "{}", head.lines().next().unwrap());
    let names = "import sys, zipfile; print(*sorted(zipfile.ZipFile(sys.argv[1]).namelist()))";
    let without = run(Command::new(python()).args(["-c", names]).arg(pack(&["--no-references"])));
    assert!(without.contains("resources/patch.toml") && !without.contains("extra/"), "{without}");
}

/// An FMU with one of its files changed, by Python: `edit` makes new bytes of `b`.
fn forged(fmu: &Path, file: &str, edit: &str) -> PathBuf {
    let text = "import sys, zipfile\nz = zipfile.ZipFile(sys.argv[1]); o = zipfile.ZipFile(sys.argv[2], 'w')\n\
                for n in z.namelist():\n    b = z.read(n); o.writestr(n, eval(sys.argv[4]) if n.endswith(sys.argv[3]) else b)\n\
                o.close()";
    let other = fmu.with_file_name("forged.fmu");
    run(Command::new(python()).args(["-c", text]).arg(fmu).arg(&other).args([file, edit]));
    other
}

/// What was packed is as packed; start values, units, tables and libraries that are others are seen, by what they are.
#[test]
fn an_fmu_is_verified_without_loading_it() {
    let folder = scratch("references-verify");
    let fmu = pack(&root().join("scenes/tread-block/tread-block.toml"), &folder);
    let verify = |fmu: &Path| ended(asperity().arg("verify").arg(fmu));
    let (status, said, _) = verify(&fmu);
    assert_eq!(status, 0, "{said}");
    assert_names(&said, "modelDescription.xml | whole library | to the last digit | Verdict");
    for (file, edit, status, names) in [
        (
            "modelDescription.xml",
            "b.replace(b'unit=\"N\"', b'unit=\"m\"', 1)",
            3,
            "modelDescription.xml, line | NOT as",
        ),
        ("modelDescription.xml", "b.replace(b'start=\"', b'start=\"1', 1)", 3, "packed was"),
        ("scene.toml", "b.replace(b'name', b'# \\nname', 1)", 3, "guid"),
        ("experiment.csv", "b.replace(b'\\n0.0,', b'\\n0.00,', 1)", 3, "experiment.csv, line 2"),
        ("result.csv", "b.replace(b'time', b'tame')", 1, "row 1"),
        (".so", "b[:len(b) // 2]", 1, "whole shared library"),
        (".so", "b + bytes(8)", 0, "another one"),
    ] {
        let (found, said, error) = verify(&forged(&fmu, file, edit));
        assert_eq!(found, status, "{file} {edit}: {said}{error}");
        assert_names(said + &error, names);
    }
    // Other values in three rows.
    let noise = "b''.join(l + b'\\n' if i < 99 or i > 101 else b','.join([l.split(b',')[0]] + [b'1e3' for f in l.split(b',')[1:]]) \
                 + b'\\n' for i, l in enumerate(b.split(b'\\n')) if l)";
    let (status, said, _) = verify(&forged(&fmu, "result.csv", noise));
    assert_eq!(status, 3, "{said}");
    assert_names(&said, "result.csv: | off | tolerance");
}

/// docs/compatibility has the experiment of the default scene as its FMU carries it. To accept an intended change:
/// `BLESS=1 cargo test fmu::references`.
#[test]
fn the_compatibility_folder_has_what_the_fmu_carries() {
    let fmu = pack(&root().join("scenes/tread-block/tread-block.toml"), &scratch("references-compatibility"));
    let folder = root().join("docs/compatibility/tread-block");
    for (own, carried) in [("tread-block_in.csv", "experiment.csv"), ("tread-block_ref.csv", "result.csv")] {
        let (path, carried) = (folder.join(own), fs::read_to_string(unpacked(&fmu, carried)).unwrap());
        if std::env::var_os("BLESS").is_some() {
            fs::write(&path, &carried).unwrap();
        }
        let (own, carried) = (Table::read(&path), Table::parse(&carried));
        assert!(own.names() == carried.names() && own.len() == carried.len(), "BLESS=1 accepts the new one");
        for name in own.names() {
            // Machines sum in lanes of their own width.
            let (expected, found) = (own.column(name), carried.column(name));
            assert!(difference(&expected, &found) <= 1e-6 * largest(&expected), "{name}: BLESS=1 accepts the new one");
        }
    }
}

/// The page of compatibility names the versions that the tests install.
#[test]
fn the_compatibility_page_has_the_versions_tried() {
    let page = fs::read_to_string(root().join("docs/compatibility.md")).unwrap();
    for (list, packages) in [
        ("tests/python/requirements.txt", &["fmpy"][..]),
        ("tests/python/masters.txt", &["libcosimpy", "ecospy", "fmu-manipulation-toolbox"]),
    ] {
        let list = fs::read_to_string(root().join(list)).unwrap();
        for package in packages {
            let pinned = list.lines().find_map(|line| line.strip_prefix(package)?.strip_prefix("==")).unwrap();
            assert!(page.contains(&format!("| {pinned} |")), "{package} {pinned}");
        }
    }
}
