//! `asperity pack --table TABLE.csv --check SCENE.toml`: the element against the layer that was swept, where the table
//! has no points, and along a motion to and fro.

mod cells;
mod trajectory;

use std::fs;
use std::path::{Path, PathBuf};

use asperity::element::PointContact;
use asperity::scene::Scene;

use crate::program::arguments::Pack;
use crate::program::error::ProgramError;
use crate::program::figure::{Figure as _, plot_files};
use crate::program::text::Row;

/// Runs the layer and the element, writes what they do and says how far they are apart.
pub(super) fn check(command: &Pack, contact: &PointContact, scene: &Path) -> Result<Vec<Row>, ProgramError> {
    let scene = crate::program::load(scene)?;
    if scene.name != contact.table().scene {
        crate::program::warn(&format!(
            "--check: the table is of {}, the scene is {}",
            contact.table().scene,
            scene.name
        ));
    }
    let folder = Folder::beside(&command.output)?;
    let checks = cells::run(contact, &scene, command.points as usize);
    cells::write(&folder.file("points.csv"), contact.table().load, &checks)?;
    cells::picture(&checks, contact.table().load).write(&folder.file("errors.svg"))?;
    let mut rows = cells::rows(&checks);
    let compared: Vec<_> = checks.iter().filter(|check| check.errors().is_some()).collect();
    if let Some(middle) = compared.get(compared.len() / 2) {
        rows.extend(to_and_fro(contact, &scene, middle, &folder)?);
    }
    rows.push(("", format!("in {}", folder.path.display())));
    Ok(rows)
}

/// The motion from stick to slip and back, drawn as a loop.
fn to_and_fro(
    contact: &PointContact,
    scene: &Scene,
    check: &cells::Check,
    folder: &Folder,
) -> Result<Vec<Row>, ProgramError> {
    let files = ["loop-layer.csv", "loop-element.csv"].map(|name| folder.file(name));
    let rows = trajectory::run(contact, scene, check, &files)?;
    plot_files(&crate::program::arguments::Plot {
        files: files.to_vec(),
        x: "u".into(),
        y: vec!["F_x".into()],
        output: folder.file("loop.svg"),
        labels: vec!["layer".into(), "element".into()],
        title: None,
        negate: true,
        from_motion: false,
    })?;
    Ok(rows)
}

/// Where the check's files go: beside the FMU.
struct Folder {
    path: PathBuf,
}

impl Folder {
    fn beside(output: &Path) -> Result<Self, ProgramError> {
        let stem = output.file_stem().map_or_else(|| "element".into(), |stem| stem.to_string_lossy());
        let path = output.with_file_name(format!("{stem}-check"));
        fs::create_dir_all(&path).map_err(ProgramError::file("create", &path))?;
        Ok(Self { path })
    }

    fn file(&self, name: &str) -> PathBuf {
        self.path.join(name)
    }
}
