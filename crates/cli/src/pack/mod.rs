//! `asperity pack`: packs a scene, or the table of a sweep, and the shared library as one FMU.

mod check;
mod picture;
mod quantile;

use std::path::{Path, PathBuf};

use asperity::element::{PointContact, Table, TableError};
use asperity_fmi::Definition;
use asperity_study::check::CheckError;
use asperity_study::pack::{self, Fmu, Library, LibraryFile, flat_names, no_start, not_converged};
use asperity_study::summary::missing_backing;
use asperity_study::sweep::{SweepError, SweepTableError};
use asperity_study::uncertainty::UncertaintyError;

use super::cli::Pack;
use super::files::{self, FileError, check_outputs, named, print, write};
use super::terminal::{LabelledLine, labelled, lines, note, warn};
use quantile::Sample;

/// `asperity pack` failed.
#[derive(Debug, thiserror::Error)]
pub(crate) enum PackError {
    #[error(transparent)]
    File(#[from] FileError),
    #[error(transparent)]
    Table(#[from] TableError),
    #[error(transparent)]
    Check(#[from] CheckError),
    #[error("expected a scene, --table or --patch; a scene beside one of these only with --quantile")]
    SceneBeside,
    #[error("--quantile: expected --table or --patch, whose table has the samples")]
    NoTable,
    #[error(transparent)]
    Sweep(#[from] SweepError),
    #[error("{}: {problem}", .path.display())]
    Swept { path: PathBuf, problem: SweepTableError },
    #[error(transparent)]
    Uncertainty(#[from] UncertaintyError),
    #[error("{source}{}", way_to_build(.source))]
    Pack {
        #[from]
        source: pack::PackError,
    },
}

fn way_to_build(error: &pack::PackError) -> &'static str {
    match error {
        pack::PackError::NoLibrary { .. } => {
            ": build it with `cargo build --release -p asperity-fmu` and name it with --library, or use build-fmu.sh, which \
             does both"
        }
        _ => "",
    }
}

/// Writes the FMU; prints what its libraries need and, of an element or a patch, its table and errors.
pub(crate) fn pack(command: &Pack) -> Result<(), PackError> {
    check_inputs(command)?;
    let sample = command.quantile.map(|share| Sample::new(command, share)).transpose()?;
    let (table, patch) =
        sample.as_ref().map_or((&command.table, &command.patch), |sample| (&sample.table, &sample.patch));
    let (definition, path) = load(command, table.as_ref(), patch.as_ref())?;
    let libraries = libraries(command);
    let mut taken = definition.sources(&path);
    taken.extend(libraries.iter().map(|library| library.path().to_owned()));
    taken.extend([&command.check, &command.scene, &command.table, &command.patch].into_iter().flatten().cloned());
    check_outputs([&command.output], taken)?;
    let libraries = Library::read_all(&libraries)?;
    no_start(&definition).iter().for_each(|warning| warn(warning));
    let names = command.flat_names.then(|| flat_names(&definition)).flatten();
    let needs = labelled("Needs", libraries.iter().filter_map(Library::needs));
    let summary = summary(command, &definition)?;
    let picture = Some(picture(&definition)?);
    let fmu = Fmu {
        definition: &definition,
        path: &path,
        libraries: &libraries,
        summary: &summary,
        picture,
        flat_names: command.flat_names,
        references: !command.no_references,
    };
    write(&command.output, fmu.pack()?)?;
    let needs = [names.into_iter().collect(), needs].concat();
    let shown = if matches!(definition, Definition::Layer(_)) { needs } else { [summary, needs].concat() };
    print(&lines(&shown))?;
    note(&format!("{} is written", named(&command.output)));
    Ok(())
}

/// A scene beside a table or a patch is there for `--quantile`, which needs one of them.
fn check_inputs(command: &Pack) -> Result<(), PackError> {
    let has_table = command.table.is_some() || command.patch.is_some();
    match (command.scene.is_some() && has_table, command.quantile.is_some()) {
        (true, false) => Err(PackError::SceneBeside),
        (false, true) => Err(PackError::NoTable),
        _ => Ok(()),
    }
}

/// The libraries that `--library` names; by default the one beside this program.
fn libraries(command: &Pack) -> Vec<LibraryFile> {
    if command.library.is_empty() {
        return vec![LibraryFile::beside(&std::env::current_exe().unwrap_or_default())];
    }
    command.library.iter().map(|text| LibraryFile::named(text)).collect()
}

/// What is packed, and the file that it is read from.
fn load(command: &Pack, table: Option<&PathBuf>, patch: Option<&PathBuf>) -> Result<(Definition, PathBuf), PackError> {
    match (patch, table) {
        (Some(path), _) => {
            let patch = files::load_patch(path, &[])?;
            let warnings = not_converged(&patch.table().basis).into_iter().chain(missing_backing(&patch));
            warnings.for_each(|warning| warn(&warning));
            Ok((patch.into(), path.clone()))
        }
        (None, Some(path)) => {
            let table = Table::load(path)?;
            not_converged(&table.basis).iter().for_each(|warning| warn(warning));
            Ok((PointContact::new(table).into(), path.clone()))
        }
        (None, None) => {
            let path = command.scene.clone().unwrap_or_default();
            Ok((files::load(&path, &[])?.into(), path))
        }
    }
}

/// What there is in the scene or in the table, and the errors of an element or a patch.
fn summary(command: &Pack, definition: &Definition) -> Result<Vec<LabelledLine>, PackError> {
    let mut rows = pack::summary(definition);
    match (definition, &command.check) {
        (Definition::Element(contact), Some(scene)) => rows.extend(check::check_element(command, contact, scene)?),
        (Definition::Patch(patch), Some(scene)) => rows.extend(check::check_patch(command, patch, scene)?),
        _ => (),
    }
    Ok(rows)
}

/// model.png.
fn picture(definition: &Definition) -> Result<Vec<u8>, FileError> {
    let picture = match definition {
        Definition::Layer(scene) => picture::layer_png(scene),
        Definition::Element(contact) => picture::element_png(contact.table()),
        Definition::Patch(patch) => picture::element_png(patch.table()),
    };
    picture.map_err(|error| FileError::picture(Path::new("model.png"), &*error))
}
