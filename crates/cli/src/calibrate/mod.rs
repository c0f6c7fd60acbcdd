//! `asperity calibrate`: fits numbers of a scene to measured friction.

mod kept;
mod layer_model;
mod summary;
mod written;

use std::path::{Path, PathBuf};
use std::time::Duration;

use asperity::element::OperatingPoint;
use asperity::scene::{Scene, read_text, similar_keys};
use asperity_study::calibration::{
    CalibrationError, Fitted, FreeParameter, FrictionModel, FrictionParts, Linearised, Measured, Measurements, Memo,
    NewOutcome, Outcome, Plan, Problem, Statistics, SteadyModel, Task, TheoryModel, Tolerance, chi_square_per_degree,
    map_space, minimise, plan, starts_by_theory,
};
use indicatif::ProgressBar;

use super::cli::Calibrate;
use super::figure::{Figure as _, Stroke};
use super::files::{
    self, FileError, check_outputs, is_standard_output, load_without_run, picture_beside, print_beside,
};
use super::interrupt::Farewell;
use super::measured_friction::{self, CurveGrid, MeasuredFrictionError, ModelCurves};
use super::terminal::{self, note, warn};
use super::{NOT_REACHED, SUCCESS};
use asperity_study::decimals::{real, rounded};
use asperity_study::settings::{self, OverrideError, Setting};
use asperity_study::sweep::{Method, MethodError, NeverSteady, SlidingOptions, fingerprint, relevant};
use kept::KeptPoints;
use layer_model::LayerModel;

/// `asperity calibrate` refused the scene, the data or the parameters.
#[derive(Debug, thiserror::Error)]
#[expect(missing_docs, reason = "the messages say what they are")]
pub enum CalibrateError {
    #[error(transparent)]
    File(#[from] FileError),
    #[error(transparent)]
    Measured(#[from] MeasuredFrictionError),
    #[error(transparent)]
    Calibration(#[from] CalibrationError),
    #[error(transparent)]
    Method(#[from] MethodError),
    #[error(transparent)]
    NeverSteady(#[from] NeverSteady),
    #[error("cannot be written as JSON: {0}")]
    Json(#[from] serde_json::Error),
    #[error("the scene has no material or layer.width, so nothing in it has a pressure: expected the material form")]
    NoArea,
    #[error("the scene has [carrier.x]; expected none, since the speed is prescribed")]
    BodyAlongX,
    #[error(
        "--free {key}: expected a number in the scene file, to start from; the file has none there{}",
        similar_in_words(key)
    )]
    NoNumber { key: String },
    #[error("--free {key}: expected it once")]
    Twice { key: String },
    #[error("--free: expected a parameter to fit, found none")]
    None,
    #[error("--free: expected at most {most} parameters, found {found}")]
    Many { most: usize, found: usize },
    #[error("--free {key}: expected a scene whose steady sliding is solved for: the layer has no heat in it")]
    HeatOfLayer { key: String },
    #[error("--free {key}: {problem}")]
    Bound { key: String, problem: String },
    #[error("{}: the scene has no material.wlf, so nothing in it depends on the temperature of the data", .0.display())]
    NoWlf(PathBuf),
    #[error("{}:{line}: {problem}", .path.display())]
    Temperature { path: PathBuf, line: usize, problem: String },
    #[error(
        "{} is of another calibration: of another scene, other parameters, method or version; name another -o, or give --force \
         to replace it",
        .path.display()
    )]
    OtherCalibration { path: PathBuf },
    #[error(
        "-o {}: the scene names files relative to its folder ({}): expected an output there",
        .output.display(), .file.display()
    )]
    OtherFolder { output: PathBuf, file: PathBuf },
}

fn similar_in_words(key: &str) -> String {
    let similar = similar_keys(key);
    if similar.is_empty() { String::new() } else { format!("; did you mean {}?", similar.join(", ")) }
}

/// Most free parameters.
const MOST_FREE: usize = 12;
/// Points of a curve.
const CURVE: u32 = 25;
/// How many measurements a plan proposes.
const PLANNED: usize = 3;

/// What is calibrated, and by what.
#[derive(Clone, Debug)]
pub struct CalibrationOptions {
    /// The scene file: files that the scene names are looked for beside it.
    pub scene: PathBuf,
    /// Keys of it that are set, none of them free.
    pub set: Vec<Setting>,
    /// The numbers to fit.
    pub free: Vec<FreeParameter>,
    /// The table of measured friction.
    pub data: PathBuf,
    /// How steady sliding is found.
    pub sliding: SlidingOptions,
}

impl From<&Calibrate> for CalibrationOptions {
    fn from(command: &Calibrate) -> Self {
        Self {
            scene: command.scene.clone(),
            set: command.set.to_vec(),
            free: command.free.clone(),
            data: command.data.clone(),
            sliding: command.sliding.options(),
        }
    }
}

/// A scene whose numbers are free.
#[derive(Debug)]
pub(super) struct FreeScene<'a> {
    options: &'a CalibrationOptions,
    text: String,
    scene: Scene,
    /// The area of the layer, m².
    area: f64,
    parameters: Vec<FreeParameter>,
    /// The values that the file has.
    own: Vec<f64>,
    method: Method,
    of_method: String,
}

impl<'a> FreeScene<'a> {
    /// Of the `text` of the scene file, which was read as `scene` with its keys set.
    fn new(options: &'a CalibrationOptions, text: &str, scene: Scene) -> Result<Self, CalibrateError> {
        if scene.carrier.x.is_some() {
            return Err(CalibrateError::BodyAlongX);
        }
        let area = scene.layer.area().filter(|_| scene.material.is_some()).ok_or(CalibrateError::NoArea)?;
        let text = settings::overridden(text, &options.set).map_err(FileError::from)?.text;
        let (method, of_method) = options.sliding.choose(&scene)?;
        method.check(&scene)?;
        let mut free =
            Self { options, text, scene, area, parameters: options.free.clone(), own: Vec::new(), method, of_method };
        free.check_parameters()?;
        Ok(free)
    }

    /// The parameters are numbers of the file, each once, and the scene is possible at each of their bounds.
    fn check_parameters(&mut self) -> Result<(), CalibrateError> {
        let keys: Vec<String> = self.parameters.iter().map(|parameter| parameter.key.clone()).collect();
        if keys.is_empty() {
            return Err(CalibrateError::None);
        }
        if keys.len() > MOST_FREE {
            return Err(CalibrateError::Many { most: MOST_FREE, found: keys.len() });
        }
        for (index, key) in keys.iter().enumerate() {
            if keys[..index].contains(key) {
                return Err(CalibrateError::Twice { key: key.clone() });
            }
            if matches!(self.method, Method::Layer) && key.starts_with("material.heat") {
                return Err(CalibrateError::HeatOfLayer { key: key.clone() });
            }
            let own = settings::number(&self.text, key);
            self.own.push(own.ok_or_else(|| CalibrateError::NoNumber { key: key.clone() })?);
        }
        for (index, parameter) in self.parameters.iter().enumerate() {
            let (low, high) = parameter.bounds();
            for bound in [low, high] {
                let mut values = self.own.clone();
                values[index] = bound;
                let refused = |problem| CalibrateError::Bound { key: parameter.key.clone(), problem };
                self.at(&values).map_err(|error| refused(error.to_string()))?;
            }
        }
        Ok(())
    }

    /// The free keys with their values.
    fn settings(&self, values: &[f64]) -> Vec<Setting> {
        self.parameters.iter().zip(values).map(|(parameter, value)| (parameter.key.clone(), real(*value))).collect()
    }

    /// The scene at some values.
    fn at(&self, values: &[f64]) -> Result<Scene, CalibrationError> {
        let settings = self.settings(values);
        settings::scene(&self.text, &self.options.scene, &settings).map_err(|refusal| {
            let named: Vec<String> = settings.iter().map(|(key, value)| format!("{key} = {value}")).collect();
            let problem = FileError::from(refusal).to_string();
            CalibrationError::Scene { parameters: named.join(", "), problem }
        })
    }

    /// The measurements at temperatures that the scene can have: its own where they have none.
    fn measurements(&self) -> Result<Measurements, CalibrateError> {
        let path = &self.options.data;
        let mut measurements = measured_friction::read(path, self.area)?;
        let wlf = self.scene.material.as_ref().and_then(|material| material.wlf.as_ref());
        let Some(own) = wlf.map(|wlf| wlf.temperature) else {
            return match measurements.has_temperature() {
                true => Err(CalibrateError::NoWlf(path.clone())),
                false => Ok(measurements),
            };
        };
        for row in &mut measurements.rows {
            let temperature = *row.point.temperature.get_or_insert(own);
            self.scene.with_temperature(temperature).check().map_err(|error| CalibrateError::Temperature {
                path: path.clone(),
                line: row.line,
                problem: error.to_string(),
            })?;
        }
        Ok(measurements)
    }

    fn fingerprint(&self) -> Result<String, CalibrateError> {
        let settings = self.method.settings(|| format!("{:?}", self.options.sliding.bounds()));
        Ok(fingerprint(&relevant(self.scene.clone()), &format!("calibrate {settings}"))?)
    }
}

/// What a calibration found.
#[derive(Debug)]
pub(super) struct Calibrated {
    problem: Problem,
    fitted: Fitted,
    linearised: Linearised,
    statistics: Statistics,
    /// Friction of the problem's points.
    frictions: Vec<FrictionParts>,
    /// The points that cannot be simulated, and why.
    left_out: Vec<(OperatingPoint, String)>,
    /// How it was fitted.
    way: String,
}

impl Calibrated {
    fn values(&self) -> Vec<f64> {
        self.problem.values(&self.fitted.places).iter().map(|value| rounded(*value, DIGITS)).collect()
    }

    /// Friction at a point that was measured; `None` where it was left out.
    fn friction_at(&self, point: &OperatingPoint) -> Option<f64> {
        let index = self.problem.points.iter().position(|other| other == point)?;
        Some(self.frictions[index].friction())
    }

    fn is_whole(&self) -> bool {
        self.fitted.has_converged && self.statistics.tell_all()
    }
}

/// Digits of a fitted number.
const DIGITS: usize = 7;

/// Fits, writes the scene and the picture, and says what the data tell.
pub(crate) fn calibrate(command: &Calibrate) -> Result<u8, CalibrateError> {
    let scene = load_without_run(&command.scene, &command.set, |scene| !command.sliding.options().solves(scene))?;
    let text = read_text(&command.scene).map_err(FileError::io("read", &command.scene))?;
    let options = command.into();
    let free = FreeScene::new(&options, &text, scene)?;
    let measurements = free.measurements()?;
    measurements.notes.iter().for_each(|text| note(text));
    let output = command.output.clone().unwrap_or_else(|| command.scene.with_extension("calibrated.toml"));
    let picture = picture_beside(&output, command.plot.as_ref());
    let table = (!is_standard_output(&output)).then(|| output.with_extension("points.csv"));
    let taken = free.scene.sources(&command.scene).into_iter().chain([command.data.clone()]).collect();
    check_outputs([&output].into_iter().chain(&picture).chain(&table), taken)?;
    written::check_folder(&output, command, &free.scene)?;
    let (kept, known) = match &table {
        Some(table) => {
            let opened = KeptPoints::open(table, &free.fingerprint()?, &free.parameters, command.force)?;
            (Some(opened.0), opened.1)
        }
        None => (None, Vec::new()),
    };
    let bar = progress_bar();
    let _farewell = table.as_ref().map(|table| farewell(table, &bar));
    let add = |task: &Task, outcome: &Outcome| {
        bar.inc(1);
        let added = kept.as_ref().map_or(Ok(()), |kept| kept.add(task, outcome));
        added.map_err(|error| CalibrationError::NotKept(error.to_string()))
    };
    with_models(&free, known, &add, &|text| bar.set_message(text), |work| {
        let calibrated = work.calibrate(&measurements)?;
        let planned = if command.plan { Some(work.plan(&calibrated, command)?) } else { None };
        bar.finish_and_clear();
        files::write(&output, written::text(&free, &calibrated, &measurements)?)?;
        if let Some(picture) = &picture {
            let grid = CurveGrid::new(calibrated.problem.points.iter());
            let curves = work.curves(&grid, &calibrated)?;
            measured_friction::picture(&free.scene.name, &grid, &measurements.rows, &curves).write(picture)?;
        }
        let files: Vec<&Path> =
            [Some(&output), picture.as_ref(), table.as_ref()].into_iter().flatten().map(PathBuf::as_path).collect();
        print_beside([&output], &summary::text(&free, &calibrated, &measurements, planned.as_ref(), &files))?;
        summary::warnings(&calibrated, &measurements).iter().for_each(|warning| warn(warning));
        Ok(if calibrated.is_whole() { SUCCESS } else { NOT_REACHED })
    })
}

/// A number that was fitted.
#[derive(Clone, Debug, PartialEq)]
pub struct CalibratedParameter {
    /// The path of its key.
    pub key: String,
    /// Its value in the scene.
    pub before: f64,
    /// Its value now.
    pub value: f64,
    /// Its standard error; `None` at a bound, and where the data do not tell it.
    pub standard_error: Option<f64>,
    /// Its 95 % interval; `None` as for the error.
    pub interval: Option<(f64, f64)>,
    /// Whether the data tell it.
    pub is_identifiable: bool,
}

/// What a calibration found, as data.
#[derive(Clone, Debug)]
pub struct Calibration {
    /// The fitted numbers.
    pub parameters: Vec<CalibratedParameter>,
    /// Their correlations, a row for each.
    pub correlation: Vec<Vec<f64>>,
    /// χ² per degree of freedom.
    pub chi_square: f64,
    /// Whether the fit has converged, and all numbers are identifiable.
    pub is_whole: bool,
    /// The measurements, each with the friction that the scene has there; `None` of a point that was left out.
    pub measurements: Vec<(Measured, Option<f64>)>,
    /// What to look at.
    pub warnings: Vec<String>,
    /// How the table was read.
    pub notes: Vec<String>,
    /// The text of the scene with the numbers found.
    pub text: String,
}

/// Fits numbers of a scene, of which this is the `text`, to measured friction. `found` is called for every point that was
/// found, and says whether to go on.
///
/// # Errors
/// Where the scene, the parameters or the measurements are refused, and where `found` says to stop.
pub fn calibrate_scene(
    text: &str,
    options: &CalibrationOptions,
    found: impl Fn() -> bool + Sync,
) -> Result<Calibration, CalibrateError> {
    let scene = settings::scene(text, &options.scene, &options.set).map_err(FileError::from)?;
    let free = FreeScene::new(options, text, scene)?;
    let measurements = free.measurements()?;
    let add = |_: &Task, _: &Outcome| match found() {
        true => Ok(()),
        false => Err(CalibrationError::NotKept("stopped".to_owned())),
    };
    let calibrated = with_models(&free, Vec::new(), &add, &|_| (), |work| work.calibrate(&measurements))?;
    let (statistics, values) = (&calibrated.statistics, calibrated.values());
    let parameter = |(index, parameter): (usize, &FreeParameter)| {
        let is_identifiable = statistics.is_identifiable(index);
        let error = statistics.errors[index].map(|error| parameter.error_of_value(values[index], error));
        CalibratedParameter {
            key: parameter.key.clone(),
            before: free.own[index],
            value: values[index],
            standard_error: error.filter(|_| is_identifiable),
            interval: statistics.intervals[index].filter(|_| is_identifiable),
            is_identifiable,
        }
    };
    Ok(Calibration {
        parameters: free.parameters.iter().enumerate().map(parameter).collect(),
        correlation: statistics.correlation.row_iter().map(|row| row.iter().copied().collect()).collect(),
        chi_square: chi_square_per_degree(statistics.chi_square, statistics.degrees),
        is_whole: calibrated.is_whole(),
        measurements: measurements.rows.iter().map(|row| (*row, calibrated.friction_at(&row.point))).collect(),
        warnings: summary::warnings(&calibrated, &measurements),
        notes: measurements.notes.clone(),
        text: written::text(&free, &calibrated, &measurements)?,
    })
}

/// Does `work` with the models of a scene, of which the expensive one has `known` points and hands new ones to `add`.
fn with_models<T>(
    free: &FreeScene<'_>,
    known: Vec<(Task, Outcome)>,
    add: &NewOutcome<'_>,
    progress: &dyn Fn(String),
    work: impl FnOnce(Work<'_>) -> Result<T, CalibrateError>,
) -> Result<T, CalibrateError> {
    let sliding = free.options.sliding;
    let scene_at = |values: &[f64]| free.at(values);
    let grid_of = |scene: &Scene| match sliding.choose(scene) {
        Ok((Method::Steady(grid), _)) => Ok(grid),
        Ok((Method::Layer, of_method)) => Err(CalibrationError::Model(of_method)),
        Err(error) => Err(CalibrationError::Model(error.to_string())),
    };
    let theory = TheoryModel::new(&scene_at);
    let steady = SteadyModel::new(&scene_at, &grid_of);
    let layer = LayerModel { scene_at: &scene_at, area: free.area, bounds: sliding.bounds() };
    let is_solved = matches!(free.method, Method::Steady(_));
    let model: &dyn FrictionModel = if is_solved { &steady } else { &layer };
    let model = Memo::new(model, known, add);
    work(Work { free, theory: &theory, model: &model, progress })
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

/// What a calibration is made with.
#[derive(Clone, Copy)]
struct Work<'a> {
    free: &'a FreeScene<'a>,
    theory: &'a TheoryModel<'a>,
    model: &'a Memo<'a>,
    /// Told what is done now.
    progress: &'a dyn Fn(String),
}

/// How many of the fits by the theory are tried as starts.
const TRIED: usize = 4;
/// The layer's friction is known to some 0.5 %.
const OF_LAYER: Tolerance = Tolerance { chi_square: 1e-3, places: 3e-3, steps: 12 };

impl Work<'_> {
    /// The fit, without the points that do not slide steadily where it leads.
    fn calibrate(&self, measurements: &Measurements) -> Result<Calibrated, CalibrateError> {
        let whole = Problem::new(self.free.parameters.clone(), measurements);
        let (mut problem, mut left_out) = (whole, Vec::new());
        loop {
            match self.fit(&problem) {
                Ok((fitted, linearised, way)) => {
                    let statistics = Statistics::new(&problem, &fitted.places, &linearised);
                    let frictions = problem.frictions(self.model, std::slice::from_ref(&fitted.places))?.remove(0);
                    return Ok(Calibrated { problem, fitted, linearised, statistics, frictions, left_out, way });
                }
                Err(CalibrationError::NotSteady(failed)) => {
                    let points: Vec<OperatingPoint> = failed.iter().map(|(point, _)| *point).collect();
                    problem = problem.without(&points);
                    left_out.extend(failed);
                }
                Err(error) => return Err(error.into()),
            }
        }
    }

    /// A fit of all points: where it ended, what friction does there, and how it came there.
    fn fit(&self, problem: &Problem) -> Result<(Fitted, Linearised, String), CalibrationError> {
        let start = self.start(problem)?;
        let progress = |chi_square: f64| {
            let degrees = problem.rows.len().saturating_sub(problem.parameters.len());
            let cost = rounded(chi_square_per_degree(chi_square, degrees), 4);
            (self.progress)(format!("χ² per degree of freedom now {cost}"));
        };
        if matches!(self.free.method, Method::Steady(_)) {
            let fitted = minimise(problem, self.model, &start, Tolerance::USUAL, &progress)?;
            let linearised = problem.linearised_to_both_sides(self.model, &fitted.places)?;
            return Ok((fitted, linearised, "steady sliding itself, from a first fit by Persson's theory".to_owned()));
        }
        let mapped = map_space(problem, self.theory, self.model, &start, &progress)?;
        if let Some(mapped) = mapped.as_ref().filter(|mapped| mapped.fitted.has_converged) {
            let way = format!("space mapping: Persson's theory corrected by the layer in {} rounds", mapped.rounds);
            return Ok((mapped.fitted.clone(), mapped.linearised.clone(), way));
        }
        let start = mapped.map_or(start, |mapped| mapped.fitted.places);
        let fitted = minimise(problem, self.model, &start, OF_LAYER, &progress)?;
        let linearised = problem.linearised(self.model, &fitted.places)?;
        Ok((fitted, linearised, "differences of the layer itself: its friction and the theory's part".to_owned()))
    }

    /// The best start of the expensive model among the fits by the theory and the scene's own values; of the layer, which is
    /// too expensive to be tried at several, the best fit by the theory.
    fn start(&self, problem: &Problem) -> Result<Vec<f64>, CalibrationError> {
        let own = problem.places(&self.free.own);
        let fits = starts_by_theory(problem, self.theory, &own, Tolerance::ROUGH)?;
        if let (Method::Layer, Some(best)) = (&self.free.method, fits.first()) {
            return Ok(best.places.clone());
        }
        let mut starts = vec![own];
        starts.extend(fits.into_iter().take(TRIED).map(|fit| fit.places));
        let outcomes = problem.outcomes(self.model, &starts)?;
        // Those at which most points slide steadily, and of these the one with the least square.
        let worth = |outcomes: &Vec<Outcome>| {
            let residual = |row: &asperity_study::calibration::Row| {
                let friction = outcomes[row.point].as_ref().ok()?.friction();
                Some(((friction - row.friction) / row.sigma).powi(2))
            };
            let failed = outcomes.iter().filter(|outcome| outcome.is_err()).count();
            (failed, problem.rows.iter().filter_map(residual).sum::<f64>())
        };
        let order = |a: &(usize, f64), b: &(usize, f64)| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1));
        let best = outcomes.iter().map(worth).zip(&starts).min_by(|a, b| order(&a.0, &b.0));
        Ok(best.map(|(_, places)| places.clone()).unwrap_or_default())
    }

    /// Friction before and after over the speed: of a layer at the measured points alone.
    fn curves(&self, grid: &CurveGrid, calibrated: &Calibrated) -> Result<Vec<ModelCurves>, CalibrateError> {
        let is_solved = matches!(self.free.method, Method::Steady(_));
        let points = if is_solved { grid.points(CURVE) } else { calibrated.problem.points.clone() };
        let after = calibrated.problem.values(&calibrated.fitted.places);
        let of = |values: &[f64], name, stroke| {
            let task = |&point: &OperatingPoint| Task { parameters: values.to_vec(), point };
            let tasks: Vec<Task> = points.iter().map(task).collect();
            let found = std::sync::Mutex::new(Vec::new());
            self.model.evaluate(&tasks, &|index, outcome| {
                let point = outcome.ok().map(|parts| (tasks[index].point, parts.friction()));
                found.lock().unwrap_or_else(std::sync::PoisonError::into_inner).extend(point);
                Ok(())
            })?;
            let points = found.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
            Ok::<_, CalibrationError>(ModelCurves { name, stroke, points })
        };
        Ok(vec![of(&self.free.own, "before", Stroke::Dashed)?, of(&after, "after", Stroke::Line)?])
    }

    /// What to measure next.
    fn plan(&self, calibrated: &Calibrated, command: &Calibrate) -> Result<Plan, CalibrateError> {
        (self.progress)("what to measure next".to_owned());
        let Calibrated { problem, fitted, linearised, statistics, .. } = calibrated;
        let candidates = self.candidates(&problem.points, command);
        // The layer is too expensive for a grid.
        let is_solved = matches!(self.free.method, Method::Steady(_));
        let model: &dyn FrictionModel = if is_solved { self.model } else { self.theory };
        Ok(plan(problem, model, (&fitted.places, linearised, statistics), &candidates, PLANNED)?)
    }

    /// The grid that is asked for; else one that reaches a decade of speed, a factor of two of pressure and 20 K beyond
    /// the measurements.
    fn candidates(&self, measured: &[OperatingPoint], command: &Calibrate) -> Vec<OperatingPoint> {
        let range = |value: &dyn Fn(&OperatingPoint) -> Option<f64>| {
            let values = measured.iter().filter_map(value);
            values.fold(None, |range: Option<(f64, f64)>, value| {
                Some(range.map_or((value, value), |(low, high)| (low.min(value), high.max(value))))
            })
        };
        let even = |count: u32, (low, high): (f64, f64)| {
            (0..count).map(move |i| low + (high - low) * f64::from(i) / f64::from(count - 1)).collect::<Vec<f64>>()
        };
        let in_logarithm = |count: u32, range: Option<(f64, f64)>, factor: f64| {
            let range = range.map(|(low, high)| ((low / factor).ln(), (high * factor).ln()));
            let values = range.map_or_else(Vec::new, |range| even(count, range));
            values.into_iter().map(|value| rounded(value.exp(), 3)).collect::<Vec<f64>>()
        };
        let speeds = command.speeds.clone().map(|values| values.0);
        let speeds = speeds.unwrap_or_else(|| in_logarithm(9, range(&|point| Some(point.speed)), 10.0));
        let pressures = command.pressures.clone().map(|values| values.0);
        let pressures = pressures.unwrap_or_else(|| in_logarithm(3, range(&|point| Some(point.load)), 2.0));
        let own = range(&|point| point.temperature).map(|(low, high)| even(5, (low - 20.0, high + 20.0)));
        let kelvin = command.temperatures.clone().map(|values| values.0).or(own);
        let is_possible = |kelvin: &f64| self.free.scene.with_temperature(*kelvin).check().is_ok();
        let temperatures: Vec<Option<f64>> = match kelvin {
            Some(kelvin) if measured.iter().any(|point| point.temperature.is_some()) => {
                kelvin.into_iter().filter(is_possible).map(|kelvin| Some(rounded(kelvin, 5))).collect()
            }
            _ => vec![None],
        };
        let mut points = Vec::new();
        for &temperature in &temperatures {
            for &load in &pressures {
                points.extend(speeds.iter().map(|&speed| OperatingPoint { speed, load, temperature }));
            }
        }
        points
    }
}

impl From<OverrideError> for CalibrateError {
    fn from(error: OverrideError) -> Self {
        FileError::from(error).into()
    }
}
