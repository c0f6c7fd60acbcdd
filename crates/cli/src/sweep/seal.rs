//! `asperity sweep --seal`: the Stribeck curve of a seal.

use std::path::{Path, PathBuf};

use asperity::scene::Setting;
use asperity_study::Error;
use asperity_study::progress::Stop;
use asperity_study::stribeck::{Stribeck, StribeckOptions};
use asperity_study::values::Values;

use crate::files::{check_outputs, default_output, load_seal, named, picture_beside, print_beside, write};
use crate::picture;
use crate::terminal::{self, lines, warn};

/// What is asked of the curve of a seal.
pub(super) struct SealSweep<'a> {
    /// The seal file.
    pub(super) path: &'a Path,
    /// Keys set to other values.
    pub(super) set: &'a [Setting],
    /// The table and the picture to write, where they are named.
    pub(super) output: Option<&'a PathBuf>,
    pub(super) plot: Option<&'a PathBuf>,
    /// Whether an existing table is replaced.
    pub(super) force: bool,
    pub(super) speeds: Option<&'a Values>,
    pub(super) temperatures: Option<&'a Values>,
    pub(super) options: &'a StribeckOptions,
}

/// Computes the curve, writes table and picture.
pub(super) fn sweep(command: &SealSweep<'_>) -> Result<(), Error> {
    let path = command.path;
    let seal = load_seal(path, command.set)?;
    let output = command.output.cloned().unwrap_or_else(|| default_output(path, "stribeck.csv"));
    let picture = picture_beside(&output, command.plot);
    check_outputs([&output].into_iter().chain(&picture), seal.sources(path))?;
    if output.exists() && !command.force {
        return Err(Error::value(format!(
            "{}: is there, and the table of a seal is not continued: name another -o, or give --force to replace it",
            output.display()
        )));
    }
    let (speeds, temperatures) = (command.speeds, command.temperatures);
    let bar = terminal::bar(Stribeck::count(&seal, speeds, temperatures, command.options) as u64);
    let found = Stribeck::new(&seal, speeds, temperatures, command.options, (&Stop::default(), &|| bar.inc(1)));
    bar.finish_and_clear();
    let found = found?;
    write(&output, found.table().text())?;
    picture.as_ref().map_or(Ok(()), |path| picture::write(&found.picture(), path))?;
    let [failed, unsteady] = found.failures();
    if unsteady > 0 {
        warn(&format!("{unsteady} strokes do not become steady within some widths of the lip: their rows say so"));
    }
    let problem = found.points.iter().find_map(|point| point.strokes.as_ref().err());
    let files = [output.as_path()].into_iter().chain(picture.as_deref()).map(named).collect::<Vec<_>>().join(", ");
    print_beside([&output], &lines(&[("Points", format!("{}", found.points.len())), ("Written", files)]))?;
    match problem {
        Some(problem) => {
            Err(Error::run(format!("{failed} of {} points have no result: {problem}", found.points.len())))
        }
        None => Ok(()),
    }
}
