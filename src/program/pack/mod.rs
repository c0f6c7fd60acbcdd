//! `asperity pack`: a scene, or a table, and the shared library as one FMU.

mod archive;
mod check;
mod documentation;
mod element;
mod libraries;
mod model_description;
mod parts;
mod picture;
mod units;
mod variables;

use std::fs;
use std::path::{Component, Path, PathBuf};

use asperity::element::{PointContact, Table};
use asperity::fmi::{Catalogue, Sources, Subject, guid};

use super::arguments::Pack;
use super::describe;
use super::error::ProgramError;
use super::text::Row;
use archive::Entry;
use parts::PARTS;

/// Writes the FMU.
pub(crate) fn pack(command: &Pack) -> Result<(), ProgramError> {
    let (subject, path) = load(command)?;
    super::check_output(&command.output, &subject.sources(&path))?;
    let mut entries = libraries::binaries(&subject.model_identifier(), &command.library)?;
    entries.extend(resources(&subject, &path)?);
    let said = said(command, &subject)?;
    entries.extend(documents(&subject, &path, &said)?);
    let bytes = archive::zip(entries)?;
    fs::write(&command.output, bytes).map_err(ProgramError::file("write", &command.output))?;
    if matches!(subject, Subject::Element(_)) { element::tell(&said) } else { Ok(()) }
}

/// What the page says of the scene or of the table, and of how well that is interpolated.
fn said(command: &Pack, subject: &Subject) -> Result<Vec<Row>, ProgramError> {
    let contact = match subject {
        Subject::Layer(scene) => return Ok(describe::rows(scene)),
        Subject::Element(contact) => contact,
    };
    let mut rows = element::rows(contact.table());
    if let Some(scene) = &command.check {
        rows.extend(check::check(command, contact, scene)?);
    }
    Ok(rows)
}

/// What is packed, and the file that it is read from.
fn load(command: &Pack) -> Result<(Subject, PathBuf), ProgramError> {
    match (&command.table, &command.scene) {
        (Some(table), _) => Ok((PointContact::new(Table::load(table)?).into(), table.clone())),
        (None, scene) => {
            let path = scene.clone().unwrap_or_default();
            Ok((super::load(&path)?.into(), path))
        }
    }
}

/// The scene or the table, under a fixed name, and what a scene reads.
fn resources(subject: &Subject, path: &Path) -> Result<Vec<Entry>, ProgramError> {
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut entries = vec![Entry::new(format!("resources/{}", subject.file_name()), read(path)?)];
    for file in subject.files() {
        let bytes = subject.carried(folder, file).map_err(ProgramError::file("read", &folder.join(file)))?;
        entries.push(Entry::new(format!("resources/{}", archive_path(file)?), bytes));
    }
    Ok(entries)
}

/// `file` with forward slashes; an FMU is unpacked anywhere, so nothing outside the scene's folder can go with it.
fn archive_path(file: &Path) -> Result<String, ProgramError> {
    let parts = file.components().filter(|part| *part != Component::CurDir).map(|part| match part {
        Component::Normal(name) => Ok(name.to_string_lossy()),
        _ => Err(ProgramError::Outside { path: file.to_owned() }),
    });
    Ok(parts.collect::<Result<Vec<_>, _>>()?.join("/"))
}

fn documents(subject: &Subject, path: &Path, said: &[Row]) -> Result<Vec<Entry>, ProgramError> {
    let document = |document, source| ProgramError::Document { document, source };
    let catalogue = Catalogue::of(subject);
    let guid = guid(&Sources::of(path, subject).map_err(ProgramError::file("read", path))?, &catalogue);
    let description = model_description::write(subject, &catalogue, &guid);
    let description = description.map_err(|error| document("modelDescription.xml", error))?;
    let index = documentation::write(subject, &catalogue, said);
    let index = index.map_err(|error| document("documentation/index.html", error))?;
    let picture = match subject {
        Subject::Layer(scene) => picture::png(scene),
        Subject::Element(contact) => picture::element_png(contact.table()),
    };
    let picture = picture.map_err(|error| ProgramError::picture(Path::new("model.png"), &*error))?;
    let parts = PARTS.iter().map(|(name, text)| Entry::new((*name).into(), text.as_bytes().to_vec()));
    let written = [("modelDescription.xml", description), ("documentation/index.html", index), ("model.png", picture)];
    Ok(written.into_iter().map(|(name, bytes)| Entry::new(name.into(), bytes)).chain(parts).collect())
}

fn read(path: &Path) -> Result<Vec<u8>, ProgramError> {
    fs::read(path).map_err(ProgramError::file("read", path))
}
