//! The scene that is calibrated: its text, its free numbers, and the measurements that go with it.

use std::path::Path;

use asperity::scene::{Scene, Setting};

use super::error::{CalibrationError, FreeParameterError, MeasuredFrictionError, ModelError};
use super::measurements::Measurements;
use super::options::CalibrationOptions;
use super::parameter::FreeParameter;
use crate::error::Error;
use crate::settings::edited;
use crate::sweep::{Method, fingerprint, relevant};

/// Most free parameters.
const MOST_FREE: usize = 12;

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
    /// Of the `text` of the scene file, which was read as `scene` with its keys set.
    ///
    /// # Errors
    /// Where the scene or the parameters are refused.
    pub fn new(options: &'a CalibrationOptions, text: &str, scene: Scene) -> Result<Self, CalibrationError> {
        if scene.carrier.x.is_some() {
            return Err(CalibrationError::BodyAlongX);
        }
        let area = scene.layer.area().filter(|_| scene.material.is_some()).ok_or(CalibrationError::NoArea)?;
        let text = edited(text, &options.set);
        let (method, of_method) = options.sliding.choose(&scene)?;
        method.check(&scene)?;
        let mut free =
            Self { options, text, scene, area, parameters: options.free.clone(), own: Vec::new(), method, of_method };
        free.check_parameters()?;
        Ok(free)
    }

    /// The parameters are numbers of the file, each once, and the scene is possible at each of their bounds.
    fn check_parameters(&mut self) -> Result<(), FreeParameterError> {
        let keys: Vec<String> = self.parameters.iter().map(|parameter| parameter.key.clone()).collect();
        if keys.is_empty() {
            return Err(FreeParameterError::None);
        }
        if keys.len() > MOST_FREE {
            return Err(FreeParameterError::Many { most: MOST_FREE, found: keys.len() });
        }
        for (index, key) in keys.iter().enumerate() {
            if keys[..index].contains(key) {
                return Err(FreeParameterError::Twice { key: key.clone() });
            }
            if matches!(self.method, Method::Layer) && key.starts_with("material.heat") {
                return Err(FreeParameterError::HeatOfLayer { key: key.clone() });
            }
            let own = self.scene.number(key);
            self.own.push(own.ok_or_else(|| FreeParameterError::NoNumber { key: key.clone() })?);
        }
        for (index, parameter) in self.parameters.iter().enumerate() {
            let (low, high) = parameter.bounds();
            for bound in [low, high] {
                let mut values = self.own.clone();
                values[index] = bound;
                let refused = |problem| FreeParameterError::Bound { key: parameter.key.clone(), problem };
                self.at(&values).map_err(refused)?;
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
    pub(super) fn at(&self, values: &[f64]) -> Result<Scene, ModelError> {
        let settings = self.settings(values);
        self.scene.with_all(&settings).map_err(|problem| {
            let named: Vec<String> = settings.iter().map(Setting::to_string).collect();
            ModelError::Scene { parameters: named.join(", "), problem: Box::new(problem.into()) }
        })
    }

    /// The measurements at temperatures that the scene can have: its own where they have none.
    ///
    /// # Errors
    /// Where the table cannot be read, or its temperatures do not go with the scene.
    pub fn measurements(&self) -> Result<Measurements, MeasuredFrictionError> {
        let path = &self.options.data;
        let mut measurements = Measurements::read(path, self.area)?;
        for row in &mut measurements.rows {
            row.point.way = row.point.way.or(self.options.sliding.way);
            let checked = self.options.sliding.check_way(&self.scene, row.point.way);
            checked.map_err(|problem| MeasuredFrictionError::Way { path: path.clone(), line: row.line, problem })?;
        }
        let Some(own) = self.scene.temperature() else {
            return match measurements.has_temperature() {
                true => Err(MeasuredFrictionError::NoWlf(path.clone())),
                false => Ok(measurements),
            };
        };
        for row in &mut measurements.rows {
            let temperature = *row.point.temperature.get_or_insert(own);
            self.scene.with_temperature(temperature).check().map_err(|problem| MeasuredFrictionError::Temperature {
                path: path.clone(),
                line: row.line,
                problem,
            })?;
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
