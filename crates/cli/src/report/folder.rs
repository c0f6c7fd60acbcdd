//! The folder that a report is written to.

use std::io;
use std::path::{Path, PathBuf};

use asperity_study::Error;
use asperity_study::picture::Picture;

use crate::files::{check_output, not_drawn, write};
use crate::picture;

/// The page.
pub(super) const INDEX: &str = "index.html";
/// The table and the pictures of errors and run times, without their endings.
pub(super) const ERRORS: &str = "error-run-time";
/// The table and the pictures of errors over the tolerance and estimates over errors.
pub(super) const JUDGEMENTS: &str = "tolerance-estimate";
/// The table and the pictures of errors and communication steps.
pub(super) const COMMUNICATION: &str = "error-communication-step";
/// The table of the perturbed runs.
pub(super) const STRESS: &str = "stress";

#[derive(Debug)]
pub(super) struct ReportFolder {
    path: PathBuf,
}

impl ReportFolder {
    /// Checks that no file written, with a table and pictures of each of `names`, takes the place of one of `taken`.
    pub(super) fn new(path: &Path, names: &[&str], taken: &[PathBuf]) -> Result<Self, Error> {
        let folder = Self { path: path.to_owned() };
        let drawn = names.iter().flat_map(|name| ["csv", "svg", "png"].map(|ending| folder.file(name, ending)));
        let mut files = drawn.chain([folder.file(STRESS, "csv"), folder.path.join(INDEX)]);
        files.try_for_each(|file| check_output(&file, taken))?;
        Ok(folder)
    }

    /// Creates the folder if it does not exist.
    pub(super) fn create(&self) -> Result<(), Error> {
        std::fs::create_dir_all(&self.path).map_err(Error::io("create", &self.path))
    }

    pub(super) fn file(&self, name: &str, ending: &str) -> PathBuf {
        self.path.join(format!("{name}.{ending}"))
    }

    pub(super) fn write(&self, file: &str, text: String) -> Result<(), Error> {
        write(&self.path.join(file), text)
    }

    /// For `map_err`: the page cannot be written.
    pub(super) fn error(&self) -> impl FnOnce(io::Error) -> Error + use<> {
        Error::io("write", &self.path.join(INDEX))
    }

    /// Draws a picture as SVG and PNG. Returns the text of the SVG.
    pub(super) fn draw(&self, name: &str, drawn: &Picture) -> Result<String, Error> {
        let [svg_file, png_file] = ["svg", "png"].map(|ending| self.file(name, ending));
        let svg = picture::svg(drawn).map_err(|error| not_drawn(&svg_file, error))?;
        write(&svg_file, &svg)?;
        picture::write(drawn, &png_file)?;
        Ok(svg)
    }
}
