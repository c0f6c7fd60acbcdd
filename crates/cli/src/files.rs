//! Scenes and other files that commands read and write.

use std::io::{self, Write as _};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use asperity::model::EvenSliding;
use asperity::patch::Patch;
use asperity::scene::{Scene, Setting};
use asperity::seal::Seal;
use asperity::simulation::passed_phases;

use super::draft::Draft;
pub(crate) use super::draft::{print, write};
use super::output::of_set;
pub(crate) use super::output::{is_standard_output, is_stream, named, not_drawn, overwrites};
use super::terminal::{LabelledLine, labelled, note, warn};
use asperity_study::Error;
use asperity_study::files;
pub(crate) use asperity_study::files::name_of;

/// The picture beside a table: the one named, else one with the table's name; none of a table on standard output or another
/// stream.
pub(crate) fn picture_beside(table: &Path, named: Option<&PathBuf>) -> Option<PathBuf> {
    named.cloned().or_else(|| (!is_stream(table)).then(|| table.with_extension("svg")))
}

/// Reads a scene, its keys overridden by `--set`, and prints its warnings and how the files were read that it names.
pub(crate) fn load(path: &Path, set: &[Setting]) -> Result<Scene, Error> {
    let scene = files::load_scene(path, set).map_err(of_set)?;
    scene.warnings.iter().for_each(|warning| warn(warning));
    tell(scene.notes.iter().map(|read| &read.text));
    Ok(scene)
}

/// Where a table of a `scene` goes that is given no place: beside where the program runs, with this extension.
pub(crate) fn default_output(scene: &Path, extension: &str) -> PathBuf {
    // Not by `with_extension`, which would cut "run-0.5" at its dot.
    let mut name = scene.file_stem().unwrap_or(scene.as_os_str()).to_owned();
    name.push(format!(".{extension}"));
    name.into()
}

/// Reads a scene that is not run: [`load`] without the warnings about its excitation and, unless the layer slides all the
/// same, about the layer's masses and links.
pub(crate) fn load_without_run(
    path: &Path,
    set: &[Setting],
    layer_slides: impl FnOnce(&Scene) -> bool,
) -> Result<Scene, Error> {
    let scene = files::load_scene(path, set).map_err(of_set)?;
    let mut unused = Vec::from_iter(scene.short_profile());
    unused.extend(passed_phases(&scene));
    if !layer_slides(&scene) {
        unused.extend(scene.link_warnings());
        unused.extend(EvenSliding::warning(&scene));
    }
    scene.warnings.iter().filter(|warning| !unused.contains(warning)).for_each(|text| warn(text));
    tell(scene.notes.iter().map(|read| &read.text));
    Ok(scene)
}

/// Prints how files were read, of each once.
pub(crate) fn tell<T: AsRef<str>>(notes: impl IntoIterator<Item = T>) {
    static TOLD: Mutex<Vec<String>> = Mutex::new(Vec::new());
    let mut told = TOLD.lock().unwrap_or_else(PoisonError::into_inner);
    for text in notes {
        if !told.iter().any(|other| other == text.as_ref()) {
            note(text.as_ref());
            told.push(text.as_ref().to_owned());
        }
    }
}

/// How the tables of a scene were read, as lines of a summary.
pub(crate) fn table_lines(scene: &Scene) -> Vec<LabelledLine> {
    labelled("Tables", scene.notes.iter().map(|read| read.text.clone()))
}

/// Reads a patch, its keys overridden by `--set`, and prints how the file of its points was read.
pub(crate) fn load_patch(path: &Path, set: &[Setting]) -> Result<Patch, Error> {
    let patch = files::load_patch(path, set).map_err(of_set)?;
    tell(patch.notes().iter().map(|read| &read.text));
    Ok(patch)
}

/// Reads a seal, its keys overridden by `--set`, and prints how the file of its pressures was read.
pub(crate) fn load_seal(path: &Path, set: &[Setting]) -> Result<Seal, Error> {
    let seal = files::load_seal(path, set).map_err(of_set)?;
    tell(seal.notes().iter().map(|read| &read.text));
    Ok(seal)
}

/// Refuses an output that would overwrite one of `others`, by whatever name.
pub(crate) fn check_output(output: &Path, others: &[PathBuf]) -> Result<(), Error> {
    let same = |other: &PathBuf| {
        // To open a pipe is to wait for who is at its other end.
        let is_there =
            || !is_stream(output) && !is_stream(other) && same_file::is_same_file(output, other).unwrap_or(false);
        other == output || is_there() || (place(output).is_some() && place(output) == place(other))
    };
    if others.iter().any(same) { Err(overwrites(output)) } else { Ok(()) }
}

/// Where a file is, or will be, by the one name of its folder; `None` where that is not there.
fn place(path: &Path) -> Option<PathBuf> {
    let folder = path.parent().filter(|folder| *folder != Path::new("")).unwrap_or(Path::new("."));
    Some(folder.canonicalize().ok()?.join(path.file_name()?))
}

/// Refuses outputs that would overwrite one of `taken` or one another, and those that cannot be written: before
/// anything is computed.
pub(crate) fn check_outputs<'a>(
    outputs: impl IntoIterator<Item = &'a PathBuf>,
    mut taken: Vec<PathBuf>,
) -> Result<(), Error> {
    outputs.into_iter().try_for_each(|output| {
        check_output(output, &taken)?;
        Draft::check(output)?;
        taken.push(output.clone());
        Ok(())
    })
}

pub(crate) fn read(path: &Path) -> Result<Vec<u8>, Error> {
    files::bytes(path)
}

/// Prints what is said of `outputs`: to standard error where one of them has standard output for itself.
pub(crate) fn print_beside<'a>(outputs: impl IntoIterator<Item = &'a PathBuf>, text: &str) -> Result<(), Error> {
    if outputs.into_iter().any(|output| is_standard_output(output)) {
        return io::stderr().write_all(text.as_bytes()).map_err(Error::io("write", Path::new("standard error")));
    }
    print(text)
}

/// Whether the file has the extension `ending`, in either case.
pub(crate) fn ends_in(path: &Path, ending: &str) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(ending))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_usual_table_of_a_scene_keeps_the_dots_of_its_name() {
        assert_eq!(default_output(Path::new("scenes/run-0.5.toml"), "csv"), Path::new("run-0.5.csv"));
    }
}
