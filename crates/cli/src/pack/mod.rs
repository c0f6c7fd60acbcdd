//! `asperity pack`: packs a scene, or the table of a sweep, and the shared library as one FMU.

mod check;
mod quantile;

use std::path::{Path, PathBuf};

use asperity::element::{FrictionTable, PointContact};
use asperity_fmi::Definition;
use asperity_study::Error;
use asperity_study::pack::{
    self, Fmu, Library, LibraryFile, element_icon, flat_names, layer_icon, no_start, not_converged,
};
use asperity_study::summary::missing_backing;

use super::cli::Pack;
use super::files::{self, check_outputs, named, print, write};
use super::picture::icon;
use super::terminal::{LabelledLine, labelled, lines, note, warn};
use quantile::Sample;

/// Writes the FMU; prints what its libraries need and, of an element or a patch, its table and errors.
pub(crate) fn pack(command: &Pack) -> Result<(), Error> {
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
    let libraries = Library::read_all(&libraries).map_err(|error| with_way_to_build(error, &libraries))?;
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
fn check_inputs(command: &Pack) -> Result<(), Error> {
    let has_table = command.table.is_some() || command.patch.is_some();
    match (command.scene.is_some() && has_table, command.quantile.is_some()) {
        (true, false) => {
            Err(Error::value("expected a scene, --table or --patch; a scene beside one of these only with --quantile"))
        }
        (false, true) => Err(Error::value("--quantile: expected --table or --patch, whose table has the samples")),
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

/// The error of libraries; where one is missing, with how it is made.
fn with_way_to_build(error: Error, libraries: &[LibraryFile]) -> Error {
    if libraries.iter().all(|library| library.path().is_file()) {
        return error;
    }
    Error::value(format!(
        "{error}: build it with `cargo build --release -p asperity-fmu` and name it with --library, or use build-fmu.sh, \
         which does both"
    ))
}

/// What is packed, and the file that it is read from.
fn load(command: &Pack, table: Option<&PathBuf>, patch: Option<&PathBuf>) -> Result<(Definition, PathBuf), Error> {
    match (patch, table) {
        (Some(path), _) => {
            let patch = files::load_patch(path, &[])?;
            let warnings = not_converged(&patch.table().header).into_iter().chain(missing_backing(&patch));
            warnings.for_each(|warning| warn(&warning));
            Ok((patch.into(), path.clone()))
        }
        (None, Some(path)) => {
            let table = FrictionTable::load(path)?;
            not_converged(&table.header).iter().for_each(|warning| warn(warning));
            Ok((PointContact::new(table).into(), path.clone()))
        }
        (None, None) => {
            let path = command.scene.clone().unwrap_or_default();
            Ok((files::load(&path, &[])?.into(), path))
        }
    }
}

/// What there is in the scene or in the table, and the errors of an element or a patch.
fn summary(command: &Pack, definition: &Definition) -> Result<Vec<LabelledLine>, Error> {
    let mut rows = pack::summary(definition);
    match (definition, &command.check) {
        (Definition::Element(contact), Some(scene)) => rows.extend(check::check_element(command, contact, scene)?),
        (Definition::Patch(patch), Some(scene)) => rows.extend(check::check_patch(command, patch, scene)?),
        _ => (),
    }
    Ok(rows)
}

/// model.png.
fn picture(definition: &Definition) -> Result<Vec<u8>, Error> {
    let picture = match definition {
        Definition::Layer(scene) => layer_icon(scene),
        Definition::Element(contact) => element_icon(contact.table()),
        Definition::Patch(patch) => element_icon(patch.table()),
    };
    icon(&picture).map_err(|error| files::not_drawn(Path::new("model.png"), error))
}
