//! `asperity rank`: who is above whom, how surely, and what the exit status says.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Output;

use crate::common::{Table, asperity, root, scratch};

/// The road, of which strength and cut-off are not known, with another strength.
fn road(folder: &Path, name: &str, strength: f64) -> PathBuf {
    let text = fs::read_to_string(root().join("scenes/road/road.toml")).unwrap();
    fs::copy(root().join("scenes/road/compound.csv"), folder.join("compound.csv")).unwrap();
    let is_named = |line: &&str| line.starts_with("name = ");
    let own = text.lines().find(is_named).unwrap();
    let text = text.replacen(own, &format!("name = \"{name}\""), 1);
    let (before, after) = text.split_once("strength = ").unwrap();
    let end = after.find([',', '\n', ' ']).unwrap();
    let text = format!("{before}strength = {strength:e}{}", &after[end..]);
    let unknown = "\n[uncertainty]\n\"friction.rate_shear.strength\" = { relative = 0.1 }\n\
                   \"surface.fine.shortest\" = { factor = 2.0 }\n";
    let path = folder.join(format!("{name}.toml"));
    fs::write(&path, text + unknown).unwrap();
    path
}

const POINTS: [&str; 6] = ["--speeds", "0.01,0.1,1", "--pressures", "1bar,3bar", "--temperatures", "0°C,20°C,40°C"];

fn rank(folder: &Path, scenes: &[&PathBuf], more: &[&str]) -> Output {
    let mut command = asperity();
    command.current_dir(folder).arg("rank").args(scenes).args(POINTS).args(["--samples", "16"]).args(more);
    command.output().unwrap()
}

fn said(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

#[test]
fn what_is_told_apart_ends_with_0_and_what_is_not_with_3() {
    let folder = scratch("rank");
    let [one, other, same] =
        [("one", 5e6), ("other", 5.05e6), ("same", 5e6)].map(|(name, strength)| road(&folder, name, strength));
    let data = folder.join("measured.csv");
    fs::write(
        &data,
        "scene,speed [m/s],pressure [bar],temperature [°C],mu\none,0.1,1,20,0.8\nother.toml,0.1,1,20,0.7\none,30,1,20,1\n",
    )
    .unwrap();
    let done = rank(&folder, &[&one, &other], &["--data", "measured.csv"]);
    let text = said(&done.stdout);
    assert_eq!(done.status.code(), Some(0), "{text}{}", said(&done.stderr));
    for part in [
        "Samples     16 with common numbers",
        "Pairs       other above one with 1\n",
        "Told apart  yes: other is above one with 1, at least 0.9",
        "one: 0.8 measured",
        "Kendall's rank correlation (tau-b) -1",
        "Written     rank.csv, rank.svg",
    ] {
        assert!(text.contains(part), "{part}: {text}");
    }
    assert!(said(&done.stderr).contains("1 of 3 measurements are left out: line 4"), "{}", said(&done.stderr));
    let table = Table::read(&folder.join("rank.csv"));
    assert_eq!(table.len(), 2 * 18);
    assert!((table.number(0, "weight") - 1.0 / 18.0).abs() < 1e-12);
    assert!(table.number(0, "friction_0.05") < table.number(0, "friction_0.95"));
    let svg = fs::read_to_string(folder.join("rank.svg")).unwrap();
    let count = |text: &str| svg.lines().filter(|line| line.trim() == text).count();
    assert_eq!((count("100 kPa"), count("300 kPa")), (1, 1));
    assert_eq!((count("largest with probability 1"), count("Which has the largest friction")), (1, 1));
    // Equal ones: 0.5, whatever the numbers.
    let done = rank(&folder, &[&one, &same], &["-o", "equal.csv", "--seed", "7"]);
    let text = said(&done.stdout);
    assert_eq!(done.status.code(), Some(3), "{text}{}", said(&done.stderr));
    assert!(text.contains("one above same with 0.5 (equal in 1 of the samples, which counts by half)"), "{text}");
    assert!(text.contains("Told apart  no: one is above same with 0.5, less than 0.9"), "{text}");
    assert!(fs::read_to_string(folder.join("equal.svg")).unwrap().contains("\nequal\n"));
}

#[test]
fn without_uncertainty_there_is_an_order_alone() {
    let folder = scratch("rank-known");
    let road = root().join("scenes/road/road.toml");
    let weights = folder.join("weights.csv");
    fs::write(&weights, "temperature [°C],weight\n0,1\n20,2\n40,1\n").unwrap();
    let set = ["--set", "friction.rate_shear.strength=4e6", "--weights", "weights.csv"];
    let done = rank(&folder, &[&road, &road], &set);
    let text = said(&done.stdout);
    assert_eq!(done.status.code(), Some(3), "{text}{}", said(&done.stderr));
    assert!(
        text.contains("road (1)") && text.contains("weighted") && text.contains("no scene says in [uncertainty]"),
        "{text}"
    );
    assert!(text.contains("Told apart  not known, without samples"), "{text}");
    fs::write(&weights, "temperature [°C],weight\n0,1\n20,2\n").unwrap();
    let done = rank(&folder, &[&road, &road], &set);
    assert_eq!(done.status.code(), Some(1));
    assert!(
        said(&done.stderr).contains("weights.csv: no weight of 0.01 m/s, 100000 Pa, 313.15 K"),
        "{}",
        said(&done.stderr)
    );
}
