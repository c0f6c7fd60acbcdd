//! `asperity pack --check SCENE.toml`: writes beside the FMU how an element or a patch differs from what was swept, and
//! draws it.

use std::fs;
use std::path::{Path, PathBuf};

use asperity::element::PointContact;
use asperity::patch::Patch;
use asperity_study::Error;
use asperity_study::check::{
    COMPARED_OF_ELEMENTS, COMPARED_OF_PATCHES, COMPONENTS, Doubled, Dragged, ElementCheck, ElementErrors, Loop,
    PatchCheck, PointChecks, Sliding, Wrench, WrenchSeries,
};
use asperity_study::decimals::real;

use crate::cli::Pack;
use crate::figure::{Curve, Figure as _, Ladder, LadderPanel, Ladders, LinearPanel, LinearStack, Rung, Stroke};
use crate::files::{load_without_run, write};
use crate::terminal::{Bars, LabelledLine, labelled};

/// Compares the layer and the element, writes the results beside the FMU and summarises them.
pub(super) fn check_element(command: &Pack, contact: &PointContact, scene: &Path) -> Result<Vec<LabelledLine>, Error> {
    let check = ElementCheck::new(contact, load_without_run(scene, &[], |_| true)?)?;
    let folder = folder_beside(&command.output)?;
    let points = check.points(command.check_points as usize, &Bars::new().watch())?;
    write(&folder.join("points.csv"), points.table())?;
    errors_of_points(&points).write(&folder.join("errors.svg"))?;
    let mut lines = points.lines();
    match check.to_and_fro(&points) {
        Some((_, Ok(rows))) => {
            write_pair(&folder, ["loop-layer", "loop-element"], rows.tables())?;
            loop_picture(&rows).write(&folder.join("loop.svg"))?;
            lines.extend(rows.lines());
        }
        Some((point, Err(status))) => lines.push(("", format!("to and fro at {:.3e} m/s: {status}", point.speed))),
        None => (),
    }
    lines.push(("", format!("in {}", folder.display())));
    Ok(lines)
}

/// Compares elements with their layers and the patch with a finer one, writes the results beside the FMU and summarises
/// them.
pub(super) fn check_patch(command: &Pack, patch: &Patch, scene: &Path) -> Result<Vec<LabelledLine>, Error> {
    let check = PatchCheck::new(patch, load_without_run(scene, &[], |_| true)?, command.check_points as usize)?;
    let folder = folder_beside(&command.output)?;
    let bars = Bars::new();
    let sliding = Sliding::run(&check, &bars.watch())?;
    write(&folder.join("points.csv"), sliding.table())?;
    errors_of_elements(&sliding).write(&folder.join("elements.svg"))?;
    let mut texts = sliding.summary();
    match Dragged::run(&check, &bars.watch())? {
        Ok(dragged) => {
            write_pair(&folder, ["loop-layers", "loop-elements"], dragged.tables())?;
            dragged_picture(&dragged).write(&folder.join("loop.svg"))?;
            texts.extend(dragged.summary());
        }
        Err(status) => texts.push(format!("to and fro: {status}")),
    }
    let steady = sliding.pair();
    let name = format!("elements beside their {}s", check.swept());
    let mut pairs = vec![(name.as_str(), &steady)];
    let doubled = Doubled::run(&check, &bars.watch())?;
    match &doubled {
        Ok(doubled) => {
            write_pair(&folder, ["loop-doubled", "loop-patch"], doubled.tables(&check))?;
            texts.extend(doubled.summary(&check));
            pairs.push(("nx, ny doubled", &doubled.steady));
        }
        Err(reason) => texts.push(format!("nx, ny doubled: not done, {reason}")),
    }
    differences(&check, &pairs).write(&folder.join("errors.svg"))?;
    texts.push(format!("in {}", folder.display()));
    Ok(labelled("Checked", texts))
}

fn folder_beside(output: &Path) -> Result<PathBuf, Error> {
    let stem = output.file_stem().map_or_else(|| "element".into(), |stem| stem.to_string_lossy());
    let path = output.with_file_name(format!("{stem}-check"));
    fs::create_dir_all(&path).map_err(Error::io("create", &path))?;
    Ok(path)
}

fn write_pair(folder: &Path, names: [&str; 2], tables: [String; 2]) -> Result<(), Error> {
    names.iter().zip(tables).try_for_each(|(name, table)| write(&folder.join(format!("{name}.csv")), table))
}

fn rung((x, y): (f64, f64)) -> Rung {
    Rung { x, y, label: String::new() }
}

fn panel(title: String, ladders: Vec<Ladder>) -> LadderPanel {
    LadderPanel { title, floor: None, lines: Vec::new(), ladders }
}

/// Errors of points over speed, one line for each load.
fn errors_of_points(points: &PointChecks) -> Ladders {
    let mut loads: Vec<f64> = points.points.iter().map(|check| check.point.load).collect();
    loads.sort_by(f64::total_cmp);
    loads.dedup();
    let ladder = |(look, &of): (usize, &f64), i: usize| {
        let own = points.points.iter().filter(|check| check.point.load == of);
        let rungs = own.filter_map(|check| Some(rung((check.point.speed, check.errors()?[i].abs())))).collect();
        Ladder { name: format!("{of:.3e} {}", points.load.unit()), stroke: Stroke::Line, look, rungs }
    };
    let panel = |(i, name): (usize, &&str)| {
        panel(
            format!("error of {name}, as a share of it"),
            loads.iter().enumerate().map(|load| ladder(load, i)).collect(),
        )
    };
    Ladders { x_title: "speed in m/s".into(), panels: COMPARED_OF_ELEMENTS.iter().enumerate().map(panel).collect() }
}

/// -F_x over u.
fn loop_picture(rows: &Loop) -> LinearStack {
    let [layer, element] = rows.friction();
    let curve =
        |look, name: &str, points: Vec<(f64, f64)>| Curve { name: name.to_owned(), look, stroke: Stroke::Line, points };
    let curves = vec![curve(0, "layer", layer), curve(1, "element", element)];
    LinearStack { x: ("u", "m"), panels: vec![LinearPanel { quantity: "-F_x", unit: "N", curves }] }
}

/// Errors of elements over their pressure, one line for each speed.
fn errors_of_elements(sliding: &Sliding<'_>) -> Ladders {
    let speeds = sliding.errors();
    let panel = |(i, (name, _)): (usize, &(&str, usize))| {
        let ladder = |(look, ElementErrors { speed, errors }): (usize, &ElementErrors)| {
            let rungs = errors.iter().map(|(pressure, errors)| rung((*pressure, errors[i].abs()))).collect();
            Ladder { name: format!("{} m/s", real(*speed)), stroke: Stroke::Line, look, rungs }
        };
        panel(format!("error of {name}, as a share of it"), speeds.iter().enumerate().map(ladder).collect())
    };
    Ladders { x_title: "pressure in Pa".into(), panels: COMPARED_OF_PATCHES.iter().enumerate().map(panel).collect() }
}

/// The wrenches of layers and elements over time.
fn dragged_picture(dragged: &Dragged) -> LinearStack {
    let (times, pair) = dragged.rows();
    let curve = |look: usize, name: &str, stroke: Stroke, rows: &[Wrench], i: usize| Curve {
        name: name.to_owned(),
        look,
        stroke,
        points: times.iter().zip(rows).map(|(&time, row)| (time, row[i])).collect(),
    };
    let panel = |(i, &(quantity, unit)): (usize, &(&'static str, &'static str))| {
        let layers = curve(0, "layers", Stroke::Line, &pair.reference, i);
        let elements = curve(1, "elements", Stroke::Dashed, &pair.other, i);
        LinearPanel { quantity, unit, curves: vec![layers, elements] }
    };
    LinearStack { x: ("time", "s"), panels: COMPONENTS.iter().enumerate().map(panel).collect() }
}

/// Differences in steady sliding over the speed.
fn differences(check: &PatchCheck, pairs: &[(&str, &WrenchSeries)]) -> Ladders {
    let shares: Vec<_> = pairs.iter().map(|(name, pair)| (*name, pair.shares())).collect();
    let panel = |(i, (component, _)): (usize, &(&str, &str))| {
        let ladder = |(look, (name, shares)): (usize, &(&str, Vec<Wrench>))| {
            let rungs = check.speeds().zip(shares).map(|(speed, share)| rung((speed, share[i]))).collect();
            Ladder { name: (*name).to_owned(), stroke: Stroke::Line, look, rungs }
        };
        let title = format!("difference of {component}, as a share of the largest");
        panel(title, shares.iter().enumerate().map(ladder).collect())
    };
    Ladders { x_title: "speed in m/s".into(), panels: COMPONENTS.iter().enumerate().map(panel).collect() }
}
