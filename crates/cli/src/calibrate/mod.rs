//! `asperity calibrate`: fits numbers of a scene to measured friction.

mod summary;

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use asperity::scene::{Scene, read_text};
use asperity_study::Error;
use asperity_study::calibration::{
    self, Calibration, CalibrationOptions, CalibrationStage, Calibrator, CurveGrid, FitCovariance, FreeScene,
    ModelCurves, Outcome, PointsTable, Task, calibrated_text, named_covariance,
};
use asperity_study::decimals::rounded;
use asperity_study::picture::Stroke;
use asperity_study::settings::edited;
use clap::Args;
use indicatif::ProgressBar;

use super::cli::values::{self, Set, example};
use super::files::{self, check_outputs, is_standard_output, load_without_run, name_of, picture_beside, print_beside};
use super::interrupt::Farewell;
use super::output::{NOT_REACHED, SUCCESS};
use super::picture;
use super::table_file::TableFile;
use super::terminal::{self, warn};

#[derive(Debug, Args)]
#[command(
    override_usage = "asperity calibrate [OPTIONS] --data <MEASURED.csv>\n       --free <KEY=LOW..HIGH> <SCENE.toml>"
)]
#[command(after_help = example!(
    "asperity calibrate docs/guide/measured.toml --data docs/guide/measured.csv \\\n\
    \x20     --free friction.rate_shear.strength=1e6..2e7 -o docs/guide/fitted.toml"
))]
pub(crate) struct Calibrate {
    /// The scene file, in the material form; its excitation and outputs are not used.
    #[arg(value_name = "SCENE.toml")]
    pub(crate) scene: PathBuf,
    #[command(flatten)]
    pub(crate) options: CalibrationOptions,
    /// The scene to write with the numbers found, its comments kept; - for standard output. The points found are kept in
    /// a table beside it, from which an interrupted fit goes on. Default: the scene's file with .calibrated.toml.
    #[arg(short, long, value_name = "OUT.toml")]
    pub(crate) output: Option<PathBuf>,
    /// The plot to write, as SVG or PNG according to the file name. Default: the output's name with .svg.
    #[arg(long, value_name = "OUT.svg", value_parser = values::picture())]
    pub(crate) plot: Option<PathBuf>,
    /// Replaces an existing table of points instead of going on from it.
    #[arg(long)]
    pub(crate) force: bool,
    #[command(flatten)]
    pub(crate) set: Set,
}

/// Points of a curve.
const CURVE: u32 = 25;

/// The files that are written.
struct Outputs {
    scene: PathBuf,
    picture: Option<PathBuf>,
    /// The points that were found.
    table: Option<PathBuf>,
    /// The covariance of what is fitted.
    covariance: Option<PathBuf>,
}

impl Outputs {
    /// Those of a command, which overwrite nothing that is read.
    fn new(command: &Calibrate, scene: &Scene) -> Result<Self, Error> {
        let output = command.output.clone().unwrap_or_else(|| command.scene.with_extension("calibrated.toml"));
        let picture = picture_beside(&output, command.plot.as_ref());
        let beside = |extension| (!is_standard_output(&output)).then(|| output.with_extension(extension));
        let (table, covariance) = (beside("points.csv"), beside("covariance.csv"));
        let taken = scene.sources(&command.scene).into_iter().chain([command.options.data.clone()]).collect();
        check_outputs([&output].into_iter().chain(&picture).chain(&table).chain(&covariance), taken)?;
        check_folder(&output, command, scene)?;
        Ok(Self { scene: output, picture, table, covariance })
    }

    /// All but the covariance that is not there.
    fn all(&self, has_covariance: bool) -> Vec<&Path> {
        let covariance = self.covariance.as_ref().filter(|_| has_covariance);
        let all = [Some(&self.scene), self.picture.as_ref(), self.table.as_ref(), covariance];
        all.into_iter().flatten().map(PathBuf::as_path).collect()
    }
}

/// Fits, writes the scene and the picture, and says what the data tell.
pub(crate) fn calibrate(command: &Calibrate) -> Result<u8, Error> {
    let scene = load_without_run(&command.scene, &command.set, |scene| !command.options.sliding.solves(scene))?;
    let text = read_text(&command.scene).map_err(Error::io("read", &command.scene))?;
    let free = FreeScene::new(&command.options, edited(&text, &command.set), scene)?;
    let measurements = free.measurements()?;
    files::tell(&measurements.notes);
    let outputs = Outputs::new(command, free.scene())?;
    let points = PointsTable::new(&free.fingerprint()?, free.parameters());
    let (kept, known) = match &outputs.table {
        Some(table) => {
            let read = |table: &_| Ok(points.points(table));
            let (file, known) = TableFile::open(table, points.empty(), command.force, read)?;
            (Some(file), known)
        }
        None => (None, Vec::new()),
    };
    let bar = progress_bar();
    let _farewell = outputs.table.as_ref().map(|table| farewell(table, &bar));
    // What a point could not be kept for.
    let failed = Mutex::new(None);
    let found = |task: &Task, outcome: &Outcome| {
        bar.inc(1);
        match kept.as_ref().map_or(Ok(()), |kept| kept.add(&PointsTable::cells(task, outcome))) {
            Ok(()) => ControlFlow::Continue(()),
            Err(error) => {
                failed.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(error);
                ControlFlow::Break(())
            }
        }
    };
    let done = free.with_models(known, &found, &|stage| bar.set_message(in_words(stage)), |calibrator| {
        let calibration = calibrator.calibrate(&measurements)?;
        let planned = calibrator.plan(&calibration)?;
        bar.finish_and_clear();
        let covariance = FitCovariance::new(&free, &calibration);
        let has_covariance = written(&outputs, calibrated_text(&free, &calibration), &covariance)?;
        if let Some(picture) = &outputs.picture {
            drawn(&free, &calibration, &calibrator, picture)?;
        }
        let files = outputs.all(has_covariance);
        let summary = summary::text(&free, (&calibration, &covariance), planned.as_ref(), &files);
        print_beside([&outputs.scene], &summary)?;
        calibration.warnings().iter().for_each(|warning| warn(warning));
        Ok(if calibration.is_whole() { SUCCESS } else { NOT_REACHED })
    });
    match failed.into_inner().unwrap_or_else(PoisonError::into_inner) {
        Some(error) => Err(error),
        None => done.and_then(|status| {
            kept.map_or(Ok(()), |kept| kept.finish_with(|table| points.in_order(table)))?;
            Ok(status)
        }),
    }
}

/// Writes the scene and, where it is told and has a place, the covariance, which the scene then names; whether it did.
fn written(outputs: &Outputs, scene: String, covariance: &FitCovariance) -> Result<bool, Error> {
    let (Some(path), Some(table)) = (&outputs.covariance, covariance.text()) else {
        files::write(&outputs.scene, scene)?;
        return Ok(false);
    };
    let file = name_of(path);
    if let Some(former) = named_covariance(&scene).filter(|former| *former != file) {
        warn(&format!(
            "[uncertainty] of the scene named {former}: it names {file} now, and what else is in that varies no more"
        ));
    }
    // First what the scene needs.
    files::write(path, table)?;
    files::write(&outputs.scene, covariance.named_in(&scene, &file))?;
    Ok(true)
}

/// Refuses an output from whose folder the files that the scene names could not be found.
fn check_folder(output: &Path, command: &Calibrate, scene: &Scene) -> Result<(), Error> {
    let mut named = scene.files.iter().map(|file| &file.path);
    let Some(file) = named.find(|file| file.is_relative()) else { return Ok(()) };
    let folder = |path: &Path| {
        let folder = path.parent().filter(|folder| *folder != Path::new("")).unwrap_or(Path::new("."));
        folder.canonicalize().ok()
    };
    if is_standard_output(output) || folder(output) == folder(&command.scene) {
        return Ok(());
    }
    let (output, file) = (output.display(), file.display());
    let problem = "the scene names files relative to its folder";
    Err(Error::value(format!("-o {output}: {problem} ({file}): expected an output there")))
}

/// Draws friction before and after over the speed.
fn drawn(
    free: &FreeScene<'_>,
    calibration: &Calibration,
    calibrator: &Calibrator<'_>,
    path: &Path,
) -> Result<(), Error> {
    let grid = CurveGrid::new(calibration.problem.points.iter());
    let [before, after] = calibrator.curves(calibration, grid.points(CURVE))?;
    let curves = [
        ModelCurves { name: "before", stroke: Stroke::Dashed, points: before },
        ModelCurves { name: "after", stroke: Stroke::Solid, points: after },
    ];
    let rows = &calibration.measurements.rows;
    picture::write(&calibration::picture(&free.scene().name, &grid, rows, &curves), path)
}

fn in_words(stage: CalibrationStage) -> String {
    match stage {
        CalibrationStage::Fitting(cost) => format!("χ² per degree of freedom now {}", rounded(cost, 4)),
        CalibrationStage::Planning => "what to measure next".to_owned(),
    }
}

fn progress_bar() -> ProgressBar {
    let bar = terminal::counter("points");
    bar.set_message("first fit by the theory");
    bar.enable_steady_tick(Duration::from_secs(1));
    bar
}

fn farewell(table: &Path, bar: &ProgressBar) -> Farewell {
    let done = bar.clone();
    Farewell::new(table, move || {
        let points = done.position();
        done.finish_and_clear();
        format!("{points} more points are done")
    })
}
