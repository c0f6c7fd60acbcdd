//! `asperity pack --check SCENE.toml`: writes beside the FMU how an element or a patch differs from what was swept, and
//! draws it.

use std::fs;
use std::path::{Path, PathBuf};

use asperity::element::PointContact;
use asperity::patch::Patch;
use asperity_study::Error;
use asperity_study::check::{Doubled, Dragged, ElementCheck, PatchCheck, Sliding};

use crate::cli::Pack;
use crate::files::{load_without_run, write};
use crate::picture;
use crate::terminal::{Bars, LabelledLine, labelled};

/// Compares the layer and the element, writes the results beside the FMU and summarises them.
pub(super) fn check_element(command: &Pack, contact: &PointContact, scene: &Path) -> Result<Vec<LabelledLine>, Error> {
    let check = ElementCheck::new(contact, load_without_run(scene, &[], |_| true)?)?;
    let folder = folder_beside(&command.output)?;
    let points = check.points(command.check_points as usize, &Bars::new().watch())?;
    write(&folder.join("points.csv"), points.table())?;
    picture::write(&points.picture(), &folder.join("errors.svg"))?;
    let mut lines = points.lines();
    match check.to_and_fro(&points) {
        Some((_, Ok(rows))) => {
            write_pair(&folder, ["loop-layer", "loop-element"], rows.tables())?;
            picture::write(&rows.picture(), &folder.join("loop.svg"))?;
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
    picture::write(&sliding.errors_of_elements(), &folder.join("elements.svg"))?;
    let mut texts = sliding.summary();
    match Dragged::run(&check, &bars.watch())? {
        Ok(dragged) => {
            write_pair(&folder, ["loop-layers", "loop-elements"], dragged.tables())?;
            picture::write(&dragged.picture(), &folder.join("loop.svg"))?;
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
    picture::write(&check.differences(&pairs), &folder.join("errors.svg"))?;
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
