//! The maps of a patch's face in the plot of a run.

use std::fs;
use std::path::{Path, PathBuf};

use crate::common::{Table, asperity, root, run, scratch};

/// What free cells are filled with, and the swatch of the legend.
const FREE: &str = "#e1e1e1";
/// Rectangles that are no cells: the scale of the colours, that swatch and what is behind it.
const OTHERS: usize = 64 + 2;

fn reference() -> PathBuf {
    root().join("tests/reference/patch")
}

/// Draws a run and returns the picture's text and the result file.
fn drawn(patch: &Path, motion: &Path, folder: &Path) -> (String, Table) {
    let [output, plot] = ["out.csv", "out.svg"].map(|name| folder.join(name));
    let mut simulate = asperity();
    simulate.args(["simulate", "--patch"]).arg(patch).arg("--motion").arg(motion);
    run(simulate.arg("-o").arg(&output).arg("--plot").arg(&plot));
    (fs::read_to_string(plot).unwrap(), Table::read(&output))
}

/// The rectangles that are filled: colour, width and height.
fn rectangles(picture: &str) -> Vec<(&str, f64, f64)> {
    let rectangle = |line| {
        let (points, rest) = str::strip_prefix(line, "<polygon points=\"")?.split_once("\" fill=\"")?;
        let corners: Vec<f64> = points.split([' ', ',']).map(|number| number.parse().unwrap()).collect();
        let colour = rest.split('"').next()?;
        (corners.len() == 8 && colour != "none")
            .then(|| (colour, (corners[4] - corners[0]).abs(), (corners[5] - corners[1]).abs()))
    };
    picture.lines().filter_map(rectangle).collect()
}

/// Their colours.
fn filled(picture: &str) -> Vec<&str> {
    rectangles(picture).into_iter().map(|(colour, ..)| colour).collect()
}

/// A block that is lifted on one side at the end: every cell is drawn in each of six maps, those that bear in colour, and
/// the heading has the row of the largest force.
#[test]
fn a_map_has_each_cell_and_the_heading_the_largest_pressure() {
    let folder = scratch("patch-maps");
    let (picture, table) = drawn(&reference().join("block.toml"), &reference().join("block.motion.csv"), &folder);
    let forces = ["force.x", "force.y", "force.z"].map(|name| table.column(name));
    let force = |row: usize| forces.iter().map(|force| force[row].powi(2)).sum::<f64>().sqrt();
    let [times, counts, pressures] = ["time", "contact.count", "contact.pressure"].map(|name| table.column(name));
    let last = times.len() - 1;
    let largest = (0..=last).max_by(|a, b| force(*a).total_cmp(&force(*b))).unwrap();
    let colours = filled(&picture);
    assert_eq!(colours.len(), 6 * 24 + OTHERS);
    // The rows are even in time.
    let bearing: f64 = (1..=5).map(|part| part * last / 5).chain([largest]).map(|row| counts[row]).sum();
    assert!(counts[last] < 24.0);
    assert_eq!(colours.iter().filter(|&&colour| colour == FREE).count(), 6 * 24 - bearing as usize + 1);
    // The largest pressure of all is yellow.
    assert!(colours.contains(&"#fde725"), "{colours:?}");
    let [time, pressure] = [times[largest] * 1e3, pressures[largest] * 1e-3];
    let heading = format!(
        "At {time:.0} ms, when the force is largest, {:.0} N: pressure up to {pressure:.0} kPa",
        force(largest)
    );
    assert!(picture.contains(&heading), "{heading}");
    for text in ["traction of 100 kPa, slip", "pressure in kPa", "x in mm", "160 ms, "] {
        assert!(picture.contains(text), "{text}");
    }
}

/// An attribute of an element of the picture.
fn number(line: &str, key: &str) -> f64 {
    line.split(&format!(" {key}=\"")).nth(1).unwrap().split('"').next().unwrap().parse().unwrap()
}

/// A patch with a reference's table in a folder, and its motion.
fn written(folder: &Path, table: &str, text: &str, motion: &str) -> [PathBuf; 2] {
    fs::copy(reference().join(table), folder.join(table)).unwrap();
    let paths = ["patch.toml", "motion.csv"].map(|name| folder.join(name));
    fs::write(&paths[0], text).unwrap();
    fs::write(&paths[1], motion).unwrap();
    paths
}

#[test]
fn partly_entered_cells_are_drawn_as_wide_as_they_are() {
    let folder = scratch("patch-maps-tread");
    let text = fs::read_to_string(reference().join("wheel.toml")).unwrap();
    // 3.25 cells of 0.6 mm enter.
    let motion =
        "time,x,y,z,roll,pitch,yaw,transport.speed\n0,0,0,0.29997,0,0,0,2\n0.000975,0.00195,0,0.29996,0,0,0,2\n";
    let [patch, motion] = written(&folder, "winkler.table.csv", &text, motion);
    let (picture, _) = drawn(&patch, &motion, &folder);
    // Of the large map, whose cells are the highest rectangles.
    let cells = rectangles(&picture).into_iter().filter(|(.., height)| (150.0..650.0).contains(height));
    let mut widths: Vec<f64> = cells.map(|(_, width, _)| width).collect();
    widths.sort_unstable_by(f64::total_cmp);
    // Edges take a pixel of a cell that is not too narrow for them.
    let whole = widths[25] + 1.0;
    let expected = [whole / 4.0, whole / 4.0, 3.0 * whole / 4.0 - 1.0, 3.0 * whole / 4.0 - 1.0];
    assert_eq!(widths.len(), 50);
    assert!(widths.iter().zip(expected).all(|(width, expected)| (width - expected).abs() <= 0.3), "{widths:?}");
    assert!(widths[4..].iter().all(|width| (width - widths[25]).abs() <= 0.2), "{widths:?}");
}

#[test]
fn points_are_drawn_as_discs_of_their_area() {
    let folder = scratch("patch-maps-points");
    fs::write(folder.join("points.csv"), "x,y,z,area\n0,0,0,4e-6\n0.01,0,0,1e-6\n0,0.01,0,1e-6\n").unwrap();
    let text = "name = 'p'\n[table]\npath = 'winkler.table.csv'\n[patch]\nshape = 'points'\npath = 'points.csv'\n";
    let motion = "time,x,y,z,roll,pitch,yaw\n0,0,0,-2e-5,0,0,0\n0.1,0,0,-3e-5,0,0,0\n";
    let [patch, motion] = written(&folder, "winkler.table.csv", text, motion);
    let (picture, _) = drawn(&patch, &motion, &folder);
    let radii: Vec<f64> =
        picture.lines().filter(|line| line.starts_with("<circle")).map(|line| number(line, "r")).collect();
    // The large map comes first; both rows are in the strip.
    assert_eq!(radii.len(), 9, "{radii:?}");
    assert!(radii[1] == radii[2] && (radii[0] - 2.0 * radii[1]).abs() <= 0.2, "{radii:?}");
}

/// A picture of many elements has no more tiles than can be told apart.
#[test]
fn many_elements_are_drawn_together() {
    let folder = scratch("patch-maps-many");
    let text = fs::read_to_string(reference().join("block.toml")).unwrap();
    let text = text.replace("nx = 6", "nx = 300").replace("ny = 4", "ny = 299");
    let motion = "time,x,y,z,roll,pitch,yaw\n0,0,0,-2e-5,1e-3,0,0\n0.1,1e-4,0,-3e-5,1e-3,0,0\n";
    let [patch, motion] = written(&folder, "block.table.csv", &text, motion);
    let (picture, _) = drawn(&patch, &motion, &folder);
    // One large map, two rows in the strip.
    assert_eq!(filled(&picture).len(), 60 * 60 + 2 * 30 * 30 + OTHERS);
}
