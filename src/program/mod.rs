//! The commands of the program, one module each, and what they share.

mod arguments;
mod describe;
mod error;
mod excitation;
mod fit;
mod html;
mod material;
mod pack;
mod plot;
mod progress;
mod report;
mod result_file;
mod simulate;
mod surface;
mod sweep;
mod text;

use std::path::{Path, PathBuf};

use asperity::scene::Scene;

pub(crate) use arguments::Arguments;
use arguments::Command;
use error::ProgramError;

/// Does what the command line asks for.
pub(crate) fn run(arguments: Arguments) -> Result<(), ProgramError> {
    match arguments.command {
        Command::Simulate(command) => simulate::simulate(&command),
        Command::Plot(command) => plot::plot_files(&command),
        Command::Describe(command) => describe::describe(&command),
        Command::Pack(command) => pack::pack(&command),
        Command::Fit(command) => fit::fit(&command),
        Command::Material(command) => material::material(&command),
        Command::Report(command) => report::report(&command),
        Command::Surface(command) => surface::surface(&command),
        Command::Sweep(command) => sweep::sweep(&command),
    }
}

/// Reads a scene and passes its warnings on.
fn load(path: &Path) -> Result<Scene, ProgramError> {
    let scene = Scene::load(path)?;
    scene.warnings.iter().for_each(|warning| warn(warning));
    Ok(scene)
}

/// Overrides parameters, as `--set` gives them.
fn set_parameters(scene: &mut Scene, set: &[(String, String)]) -> Result<(), ProgramError> {
    set.iter().try_for_each(|(key, value)| scene.set_by_name(key, value))?;
    Ok(scene.check()?)
}

/// The files that a scene is read from.
fn sources(path: &Path, scene: &Scene) -> Vec<PathBuf> {
    let folder = path.parent().unwrap_or(Path::new(""));
    let files = scene.files.iter().chain(scene.extracts.iter().map(|extract| &extract.source));
    std::iter::once(path.to_owned()).chain(files.map(|file| folder.join(file))).collect()
}

/// Refuses an output that would take the place of one of `others`; a file that is not there yet takes no one's.
fn check_output(output: &Path, others: &[PathBuf]) -> Result<(), ProgramError> {
    let place = |path: &Path| path.canonicalize().ok();
    let same = |other: &PathBuf| other == output || (place(output).is_some() && place(other) == place(output));
    if others.iter().any(same) { Err(ProgramError::Overwrites { path: output.to_owned() }) } else { Ok(()) }
}

/// Whether a file's name ends in `ending`.
fn ends_in(path: &Path, ending: &str) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(ending))
}

/// Tells the user what is worth knowing though the program goes on.
fn warn(message: &str) {
    note(&format!("warning: {message}"));
}

/// Tells the user how the program goes on.
#[expect(clippy::print_stderr, reason = "what is no result is for the terminal")]
fn note(message: &str) {
    eprintln!("asperity: {message}");
}
