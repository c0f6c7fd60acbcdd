//! `asperity pack`: packs a scene, or the table of a sweep, and the shared library as one FMU.

mod archive;
mod check;
mod description;
mod documentation;
mod picture;

use std::ffi::OsString;
use std::io;
use std::path::{Component, Path, PathBuf};

use asperity::element::{Basis, PointContact, Table, TableError};
use asperity_fmi::{Definition, Sources, guid};
use asperity_study::summary::{missing_backing, patch_rows, scene_rows, table_rows};

use super::cli::Pack;
use super::files::{self, FileError, check_outputs, print, read, write};
use super::terminal::{LabelledLine, labelled, lines, warn};
use archive::{ArchiveEntry, ArchiveError};
use check::CheckError;

/// `asperity pack` failed.
#[derive(Debug, thiserror::Error)]
#[expect(missing_docs, reason = "the messages say what they are")]
pub enum PackError {
    #[error(transparent)]
    File(#[from] FileError),
    #[error(transparent)]
    Table(#[from] TableError),
    #[error(transparent)]
    Check(#[from] CheckError),
    #[error(transparent)]
    Archive(#[from] ArchiveError),
    #[error("the scene reads {}, which is not below the scene's folder: an FMU carries only what is", .path.display())]
    Outside { path: PathBuf },
    #[error("cannot write {document}: {source}")]
    Document { document: &'static str, source: io::Error },
}

/// Writes the FMU; prints what its libraries need and, of an element or a patch, its table and errors.
pub(crate) fn pack(command: &Pack) -> Result<(), PackError> {
    let (definition, path) = load(command)?;
    let mut taken = files_read(&definition, &path, &command.library);
    taken.extend(command.check.clone());
    check_outputs([&command.output], taken)?;
    let binaries = archive::binaries(&definition.identifier(), &command.library)?;
    let needs = labelled("Needs", binaries.iter().filter_map(archive::needs));
    let summary = summary(command, &definition)?;
    write(&command.output, archive(&definition, &path, binaries, &summary)?)?;
    let shown = if matches!(definition, Definition::Layer(_)) { needs } else { [summary, needs].concat() };
    Ok(print(&lines(&shown))?)
}

/// Writes the FMU of a `definition`, which was read from the file at `path`, with these shared libraries, each as
/// `asperity pack --library` takes it, at once: what is at `output` is what was there before, or the whole FMU.
///
/// # Errors
/// Where a library or a file cannot be read, or does not lie where an FMU can carry it; where `output` cannot be written,
/// or is one of the files read.
pub fn write_fmu(
    definition: &Definition,
    path: &Path,
    libraries: &[OsString],
    output: &PathBuf,
) -> Result<(), PackError> {
    check_outputs([output], files_read(definition, path, libraries))?;
    let binaries = archive::binaries(&definition.identifier(), libraries)?;
    Ok(write(output, archive(definition, path, binaries, &what_is_there(definition))?)?)
}

/// The files that go into the FMU.
fn files_read(definition: &Definition, path: &Path, libraries: &[OsString]) -> Vec<PathBuf> {
    [definition.sources(path), archive::libraries(libraries)].concat()
}

fn archive(
    definition: &Definition,
    path: &Path,
    binaries: Vec<ArchiveEntry>,
    summary: &[LabelledLine],
) -> Result<Vec<u8>, PackError> {
    let entries = [binaries, resources(definition, path)?, documents(definition, path, summary)?].concat();
    Ok(archive::zip(entries).map_err(ArchiveError::from)?)
}

/// What is packed, and the file that it is read from.
fn load(command: &Pack) -> Result<(Definition, PathBuf), PackError> {
    match (&command.patch, &command.table) {
        (Some(path), _) => {
            let patch = files::load_patch(path, &[])?;
            warn_of(&patch.table().basis);
            missing_backing(&patch).iter().for_each(|warning| warn(warning));
            Ok((patch.into(), path.clone()))
        }
        (None, Some(path)) => {
            let table = Table::load(path)?;
            warn_of(&table.basis);
            Ok((PointContact::new(table).into(), path.clone()))
        }
        (None, None) => {
            let path = command.scene.clone().unwrap_or_default();
            Ok((files::load(&path, &[])?.into(), path))
        }
    }
}

/// A table of links that stand for a material says whether its numbers still depend on the spacing.
fn warn_of(basis: &Basis) {
    if let Some(foundation) = basis.foundation.as_ref().filter(|_| !basis.is_converged()) {
        let found = basis.convergence.as_deref().unwrap_or("no study of it: see asperity converge");
        warn(&format!("the table (foundation {foundation}) is not known to be converged: {found}"));
    }
}

/// What there is in the scene or in the table, and the errors of an element or a patch.
fn summary(command: &Pack, definition: &Definition) -> Result<Vec<LabelledLine>, PackError> {
    let mut rows = what_is_there(definition);
    match (definition, &command.check) {
        (Definition::Element(contact), Some(scene)) => rows.extend(check::check_element(command, contact, scene)?),
        (Definition::Patch(patch), Some(scene)) => rows.extend(check::check_patch(command, patch, scene)?),
        _ => (),
    }
    Ok(rows)
}

/// What there is in the scene or in the table.
fn what_is_there(definition: &Definition) -> Vec<LabelledLine> {
    match definition {
        Definition::Layer(scene) => scene_rows(scene),
        Definition::Element(contact) => table_rows(contact.table()),
        Definition::Patch(patch) => [patch_rows(patch), table_rows(patch.table())].concat(),
    }
}

/// The scene or the table, under a fixed name, and the files that a scene reads.
fn resources(definition: &Definition, path: &Path) -> Result<Vec<ArchiveEntry>, PackError> {
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut entries = vec![ArchiveEntry::new(format!("resources/{}", definition.file_name()), read(path)?)];
    for file in definition.files() {
        let bytes = definition.carried(folder, file).map_err(FileError::io("read", &folder.join(file)))?;
        entries.push(ArchiveEntry::new(format!("resources/{}", archive_path(file)?), bytes));
    }
    Ok(entries)
}

/// `file` with forward slashes. It must lie below the scene's folder: the FMU is unpacked elsewhere.
fn archive_path(file: &Path) -> Result<String, PackError> {
    let parts = file.components().filter(|part| *part != Component::CurDir).map(|part| match part {
        Component::Normal(name) => Ok(name.to_string_lossy()),
        _ => Err(PackError::Outside { path: file.to_owned() }),
    });
    Ok(parts.collect::<Result<Vec<_>, _>>()?.join("/"))
}

fn documents(definition: &Definition, path: &Path, summary: &[LabelledLine]) -> Result<Vec<ArchiveEntry>, PackError> {
    let document = |document, source| PackError::Document { document, source };
    let variables = definition.variables();
    let guid = guid(&Sources::new(path, &**definition).map_err(FileError::io("read", path))?, &variables);
    let description = description::write(&**definition, &variables, &guid);
    let description = description.map_err(|error| document("modelDescription.xml", error))?;
    let index = documentation::write(definition, &variables, summary);
    let index = index.map_err(|error| document("documentation/index.html", error))?;
    let picture = match definition {
        Definition::Layer(scene) => picture::layer_png(scene),
        Definition::Element(contact) => picture::element_png(contact.table()),
        Definition::Patch(patch) => picture::element_png(patch.table()),
    };
    let picture = picture.map_err(|error| FileError::picture(Path::new("model.png"), &*error))?;
    let written = [("modelDescription.xml", description), ("documentation/index.html", index), ("model.png", picture)];
    let fixed = documentation::FILES.iter().map(|&(name, text)| ArchiveEntry::new(name, text));
    Ok(written.into_iter().map(|(name, bytes)| ArchiveEntry::new(name, bytes)).chain(fixed).collect())
}
