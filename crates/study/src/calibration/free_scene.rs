//! What is asked of a calibration, and the scene that is calibrated: its text, its free numbers, and the measurements that
//! go with it.

use std::path::{Path, PathBuf};

use asperity::scene::{Scene, Setting, did_you_mean, similar_keys};
use asperity::tables::Dimension;
use clap::Args;
use serde::Deserialize;

use super::measurements::Measurements;
use super::problem::FreeParameter;
use crate::error::Error;
use crate::files::ColumnOptions;
use crate::sweep::{Method, SlidingOptions, fingerprint, relevant};
use crate::values::Values;

/// Most free parameters.
const MOST_FREE: usize = 12;

// What is fitted, and to what. Not a doc comment: that would be the description of the command.
#[expect(missing_docs, reason = "clap would print it")]
#[derive(Clone, Debug, PartialEq, Deserialize, Args)]
pub struct CalibrationOptions {
    /// The measured friction: columns, by their names and units, of speed, pressure (or force on the whole layer) and
    /// friction; of temperature and of the standard deviation of friction if it has them. Rows of one point are repeats.
    #[arg(long, value_name = "MEASURED.csv")]
    pub data: PathBuf,
    #[command(flatten)]
    #[serde(flatten)]
    pub columns: ColumnOptions,
    /// A number of the scene to fit, by its key as for --set, within bounds; its logarithm where they are positive and a
    /// decade apart. May be repeated, up to 12 times.
    #[arg(long, value_name = "KEY=LOW..HIGH", value_parser = FreeParameter::parse, required = true)]
    pub free: Vec<FreeParameter>,
    #[command(flatten)]
    #[serde(flatten)]
    pub sliding: SlidingOptions,
    #[command(flatten)]
    #[serde(flatten)]
    pub next: PlanOptions,
}

// Among which points those to measure next are chosen.
#[expect(missing_docs, reason = "clap would print it")]
#[derive(Clone, Debug, Default, PartialEq, Deserialize, Args)]
#[serde(default)]
pub struct PlanOptions {
    /// Also proposes three points to measure that would tell most (D-optimal among a grid).
    #[arg(long)]
    pub plan: bool,
    /// Speeds of that grid in m/s, in the format of asperity sweep. Default: a decade beyond the data's.
    #[arg(long, value_name = "VALUES", value_parser = Values::of(Dimension::Speed), requires = "plan")]
    pub speeds: Option<Values>,
    /// Pressures of that grid in Pa. Default: a factor of two beyond the data's.
    #[arg(long, value_name = "VALUES", value_parser = Values::of(Dimension::Pressure), requires = "plan")]
    pub pressures: Option<Values>,
    /// Temperatures of that grid in K. Default: 20 K beyond the data's.
    #[arg(long, value_name = "VALUES", value_parser = Values::of(Dimension::Temperature), requires = "plan")]
    #[arg(allow_hyphen_values = true)]
    pub temperatures: Option<Values>,
}

/// A scene whose numbers are free.
#[derive(Debug)]
pub struct FreeScene<'a> {
    pub(super) options: &'a CalibrationOptions,
    pub(super) text: String,
    scene: Scene,
    /// The area of the layer, m².
    pub(super) area: f64,
    pub(super) parameters: Vec<FreeParameter>,
    /// The values that the file has.
    pub(super) own: Vec<f64>,
    pub(super) method: Method,
    of_method: String,
}

impl<'a> FreeScene<'a> {
    /// Of the `text` of the scene file with keys set, which is that of `scene`.
    ///
    /// # Errors
    /// Where the scene or the parameters are refused.
    pub fn new(options: &'a CalibrationOptions, text: String, scene: Scene) -> Result<Self, Error> {
        if scene.carrier.x.is_some() {
            return Err(Error::value("the scene has [carrier.x]; expected none, since the speed is prescribed"));
        }
        let no_area =
            "the scene has no material or layer.width, so nothing in it has a pressure: expected the material form";
        let area = scene.layer.area().filter(|_| scene.material.is_some()).ok_or_else(|| Error::value(no_area))?;
        let (method, of_method) = options.sliding.choose(&scene)?;
        method.check(&scene)?;
        let mut free =
            Self { options, text, scene, area, parameters: options.free.clone(), own: Vec::new(), method, of_method };
        free.check_parameters()?;
        Ok(free)
    }

    /// The parameters are numbers of the file, each once, and the scene is possible at each of their bounds.
    fn check_parameters(&mut self) -> Result<(), Error> {
        let refused = |key: &str, problem: String| Error::value(format!("`free` {key}: {problem}"));
        let keys: Vec<String> = self.parameters.iter().map(|parameter| parameter.key.clone()).collect();
        if keys.is_empty() {
            return Err(Error::value("`free`: expected a parameter to fit, found none"));
        }
        if keys.len() > MOST_FREE {
            let found = keys.len();
            return Err(Error::value(format!("`free`: expected at most {MOST_FREE} parameters, found {found}")));
        }
        for (index, key) in keys.iter().enumerate() {
            if keys[..index].contains(key) {
                return Err(refused(key, "expected it once".to_owned()));
            }
            if matches!(self.method, Method::Layer) && key.starts_with("material.heat") {
                let expected = "expected a scene whose steady sliding is solved for: the layer has no heat in it";
                return Err(refused(key, expected.to_owned()));
            }
            let own = self.scene.number(key);
            self.own.push(own.ok_or_else(|| {
                let similar = did_you_mean(&similar_keys(key));
                let expected = "expected a number in the scene file, to start from; the file has none there";
                refused(key, format!("{expected}{similar}"))
            })?);
        }
        for (index, parameter) in self.parameters.iter().enumerate() {
            let (low, high) = parameter.bounds();
            for bound in [low, high] {
                let mut values = self.own.clone();
                values[index] = bound;
                self.at(&values).map_err(|error| refused(&parameter.key, error.to_string()))?;
            }
        }
        Ok(())
    }

    /// The scene as the file has it.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The table of measured friction.
    pub fn data(&self) -> &Path {
        &self.options.data
    }

    /// The free parameters.
    pub fn parameters(&self) -> &[FreeParameter] {
        &self.parameters
    }

    /// How friction is found, in words.
    pub fn of_method(&self) -> &str {
        &self.of_method
    }

    /// Whether steady sliding is solved for, not found by a layer that slides.
    pub fn is_solved(&self) -> bool {
        matches!(self.method, Method::Steady(_))
    }

    /// The free keys with their values.
    fn settings(&self, values: &[f64]) -> Vec<Setting> {
        self.parameters.iter().zip(values).map(|(parameter, value)| Setting::new(&parameter.key, *value)).collect()
    }

    /// The scene at some values.
    pub(super) fn at(&self, values: &[f64]) -> Result<Scene, Error> {
        let settings = self.settings(values);
        self.scene.with_all(&settings).map_err(|problem| {
            let named: Vec<String> = settings.iter().map(Setting::to_string).collect();
            Error::value(format!("{}: {problem}", named.join(", ")))
        })
    }

    /// The measurements at temperatures that the scene can have: its own where they have none.
    ///
    /// # Errors
    /// Where the table cannot be read, or its temperatures do not go with the scene.
    pub fn measurements(&self) -> Result<Measurements, Error> {
        let path = &self.options.data;
        let mut measurements = Measurements::read(path, self.area, &self.options.columns.columns)?;
        for row in &mut measurements.rows {
            row.point.way = row.point.way.or(self.options.sliding.way);
            let checked = self.options.sliding.check_way(&self.scene, row.point.way);
            checked.map_err(|problem| Error::in_file(path, Some(row.line), problem))?;
        }
        let Some(own) = self.scene.temperature() else {
            return match measurements.has_temperature() {
                true => {
                    let problem =
                        "the scene has no material.wlf, so nothing in it depends on the temperature of the data";
                    Err(Error::in_file(path, None, problem))
                }
                false => Ok(measurements),
            };
        };
        for row in &mut measurements.rows {
            let temperature = *row.point.temperature.get_or_insert(own);
            let checked = self.scene.with_temperature(temperature).check();
            checked.map_err(|problem| Error::in_file(path, Some(row.line), problem))?;
        }
        Ok(measurements)
    }

    /// What tells the points of this calibration from those of another.
    ///
    /// # Errors
    /// Where the scene cannot be written as JSON.
    pub fn fingerprint(&self) -> Result<String, Error> {
        fingerprint(&relevant(self.scene.clone()), self.options.sliding, self.method.surface(), "calibrate")
    }
}
