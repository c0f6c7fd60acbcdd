//! The maps of `asperity sweep --over`: what is in them, what is named, and what is refused.

use std::fs;
use std::path::{Path, PathBuf};

use crate::common::{asperity, assert_names, ended, root, run, scratch};
use crate::program::sweep::flat;

const SPEEDS: &str = "1e-4..10/6";
const TEMPERATURES: &str = "0°C,20°C,40°C";

fn sweep(scene: &Path, table: &Path, options: &[&str]) -> (i32, String, String) {
    ended(asperity().arg("sweep").arg(scene).arg("-o").arg(table).args(options))
}

/// The road, which a sweep solves for in no time.
fn road() -> PathBuf {
    root().join("scenes/road/road.toml")
}

/// How often an SVG has a text of its own.
fn texts(svg: &str, text: &str) -> usize {
    svg.lines().filter(|line| line.trim() == text).count()
}

/// Two maps with one scale and measured points; the same of the shards' tables that are merged.
#[test]
fn friction_is_drawn_over_speed_and_temperature() {
    let folder = scratch("sweep-maps");
    let (table, picture, data) = (folder.join("t.csv"), folder.join("t.svg"), folder.join("measured.csv"));
    fs::write(
        &data,
        "speed [m/s],pressure [bar],temperature [°C],mu\n0.01,1,20,0.95\n0.1,2.9,30,3\n0.1,2,20,0.9\n20,1,20,0.7\n0.1,1,60,0.9\n",
    )
    .unwrap();
    let points = ["--speeds", SPEEDS, "--pressures", "1bar,3bar", "--temperatures", TEMPERATURES];
    let maps = ["--over", "speed,temperature", "--data", data.to_str().unwrap()];
    let done = sweep(&road(), &table, &[&points[..], &maps].concat());
    assert_eq!(done.0, 0, "{}", done.2);
    let svg = fs::read_to_string(&picture).unwrap();
    for text in ["100 kPa", "300 kPa", "friction", "measured", "largest over the speed"] {
        assert_eq!(texts(&svg, text), 1, "{text}");
    }
    assert_eq!((texts(&svg, "speed in m/s"), texts(&svg, "temperature in K")), (2, 2));
    assert_eq!((svg.matches("<image").count(), texts(&svg, "no result")), (2, 0));
    // The scale reaches to the largest measured value, and its ticks are the numbers of the lines.
    assert_eq!(texts(&svg, "2.5"), 1, "the tick alone");
    assert!(texts(&svg, "0.5") + texts(&svg, "1.0") > 2, "the ticks and lines");
    let reasons = "no map of this pressure | beyond the map";
    assert_names(done.2, &format!("3 of 5 measurements | line 4 (0.1 m/s, 200000 Pa, 293.15 K) | line 6 | {reasons}"));
    let shards = ["1/2", "2/2"].map(|shard| {
        let table = folder.join(format!("{}.csv", &shard[..1]));
        let done = sweep(&road(), &table, &[&points[..], &["--shard", shard]].concat());
        assert_eq!(done.0, 0, "{}", done.2);
        table
    });
    let merged = folder.join("m.csv");
    run(asperity().arg("sweep").arg("-o").arg(&merged).arg("--merge").args(&shards).args(maps));
    assert_eq!(fs::read_to_string(folder.join("m.svg")).unwrap(), svg);
}

#[test]
fn what_is_no_map_is_refused() {
    let folder = scratch("sweep-map-refused");
    let table = folder.join("t.csv");
    let refused = |scene: &Path, options: &[&str], named: &str| {
        let done = sweep(scene, &table, options);
        assert_names(done.2, named);
        assert_ne!(done.0, 0, "{options:?}");
        assert!(!table.exists(), "nothing is computed");
    };
    let points = |over: &'static str, temperatures: &'static str| {
        ["--speeds", SPEEDS, "--pressures", "1bar", "--temperatures", temperatures, "--over", over]
    };
    refused(&road(), &points("speed,pressure", TEMPERATURES), "pressure there is one | --pressures");
    refused(&road(), &points("temperature,speed", "20°C"), "temperature there is one");
    refused(&road(), &points("speed,speed", "20°C"), "two of speed, pressure (or force) and temperature");
    refused(&road(), &points("speed,force", TEMPERATURES), "--over speed,pressure");
    let plane = flat().write(&folder);
    let forces = ["--speeds", "0.1,1", "--forces", "1,2", "--over"];
    refused(&plane, &[&forces[..], &["speed,temperature"]].concat(), "no material.wlf");
    let data = folder.join("measured.csv");
    fs::write(&data, "speed [m/s],pressure [bar],mu\n0.01,1,0.9\n").unwrap();
    let data = ["--data", data.to_str().unwrap()];
    refused(&plane, &[&forces[..], &["speed,force"], &data].concat(), "a table over forces");
    refused(&road(), &[&points("speed,temperature", TEMPERATURES)[..], &data].concat(), "temperatures | column");
    refused(&road(), &[&["--speeds", SPEEDS, "--pressures", "1bar"][..], &data].concat(), "--over");
    let done = sweep(&road(), Path::new("-"), &points("speed,temperature", TEMPERATURES));
    assert_names(done.2, "--plot");
}
