//! The numbers of a covariance fitted anew in scenes that are drawn, by the measurements that they were fitted to: these
//! stand in the header of the covariance's table.

use std::path::Path;

use asperity::element::OperatingPoint;
use asperity::scene::Scene;
use asperity::table::{Header, Table, TableError};

use super::fit::{Tolerance, minimise};
use super::free_scene::FreeScene;
use super::models::{Memo, ModelError, Outcome, SteadyModel, Task};
use super::problem::{FreeParameter, FrictionMeasurement, Problem};
use crate::error::Error;
use crate::files::text;
use crate::progress::Stop;
use crate::sweep::{Method, SlidingOptions};
use crate::uncertainty::{DrawnAt, Refit, Refused, UncertainScene, covariance_file};

/// The key of what is stored, and its version.
const STORED: (&str, u64) = ("refit", 1);
/// Its keys: two bounds for each number, and what was measured.
const BOUNDS: &str = "bounds";
const SPEED: (&str, &str) = ("measured.speed", "m/s");
const PRESSURE: (&str, &str) = ("measured.pressure", "Pa");
const TEMPERATURE: (&str, &str) = ("measured.temperature", "K");
const WAY: (&str, &str) = ("measured.way", "m");
const FRICTION: (&str, &str) = ("measured.friction", "");
const SIGMA: (&str, &str) = ("measured.sigma", "");
/// The numbers are known to some hundredths of their errors, which is what one sample asks for.
const OF_A_SAMPLE: Tolerance = Tolerance { chi_square: 1e-4, ..Tolerance::ROUGH };

/// What the header of a covariance's table stores of a fit: the measurements of a `problem`, and the bounds of those of its
/// parameters that the covariance has.
pub(super) fn stored(free: &FreeScene<'_>, problem: &Problem, told: &[usize]) -> Header {
    type OfPoint = fn(&OperatingPoint) -> Option<f64>;
    let bounds = told.iter().map(|&index| problem.parameters[index].bounds());
    let bounds: Vec<f64> = bounds.flat_map(|(low, high)| [low, high]).collect();
    let mut header = free.options.sliding.settled(free.method.surface()).in_header(Header::new(STORED));
    header = header.with_numbers(BOUNDS, &bounds, "");
    let of_points: [(_, OfPoint); 4] = [
        (SPEED, |point| Some(point.speed)),
        (PRESSURE, |point| Some(point.load)),
        (TEMPERATURE, |point| point.temperature),
        (WAY, |point| point.way),
    ];
    for ((key, unit), value) in of_points {
        let values = problem.rows.iter().map(|row| value(&problem.points[row.point]));
        if let Some(values) = values.collect::<Option<Vec<f64>>>() {
            header = header.with_numbers(key, &values, unit);
        }
    }
    let of_rows = |value: fn(&FrictionMeasurement) -> f64| problem.rows.iter().map(value).collect::<Vec<f64>>();
    header = header.with_numbers(FRICTION.0, &of_rows(|row| row.friction), FRICTION.1);
    header.with_numbers(SIGMA.0, &of_rows(|row| row.sigma), SIGMA.1)
}

/// A scene of which something is not known; with `refit` one whose covariance's numbers are fitted anew in each sample, until
/// `stop` says so.
///
/// # Errors
/// Where everything is known, there is no covariance, or it has no measurements that can be fitted.
pub fn uncertain_scene(scene: Scene, refit: bool, stop: &Stop) -> Result<UncertainScene, Error> {
    let uncertain = UncertainScene::new(scene)?;
    if !refit {
        return Ok(uncertain);
    }
    let fit = StoredFit::of(&uncertain, stop)?;
    Ok(uncertain.refitted(std::sync::Arc::new(fit)))
}

/// The fit of a covariance's numbers.
#[derive(Debug)]
struct StoredFit {
    problem: Problem,
    start: Vec<f64>,
    sliding: SlidingOptions,
    identity: String,
    stop: Stop,
}

impl StoredFit {
    fn of(uncertain: &UncertainScene, stop: &Stop) -> Result<Self, Error> {
        let scene = uncertain.scene();
        let named = covariance_file(scene).zip(uncertain.uncertainty().covariance.as_ref());
        let (file, covariance) = named.ok_or_else(|| {
            Error::scene("`refit`: expected covariance = \"...\" in [uncertainty], whose numbers are fitted anew")
        })?;
        let place = scene.values.file().parent().unwrap_or(Path::new("")).join(file);
        let header = Table::parse(&text(&place)?, &place)?.header;
        if !header.has(STORED.0) {
            let expected = "expected the measurements that it was fitted to, which asperity calibrate stores in it";
            return Err(Error::in_file(&place, None, format!("`refit`: {expected}: calibrate once more")));
        }
        header.check_kind(STORED)?;
        let bounds = header.numbers(BOUNDS, "")?;
        let pairs = covariance.numbers.iter().zip(bounds.chunks_exact(2));
        let parameters = pairs.filter_map(|(number, pair)| FreeParameter::new(number.key.clone(), pair[0], pair[1]));
        let parameters: Vec<FreeParameter> = parameters.collect();
        if parameters.len() != covariance.numbers.len() {
            let expected = "expected a lower and an upper bound of each number";
            return Err(Error::in_file(&place, None, format!("{BOUNDS}: {expected}")));
        }
        let sliding = SlidingOptions::of_table(&header)?;
        if matches!(sliding.choose(scene)?.0, Method::Layer) {
            let expected =
                "expected numbers that were fitted by solving for steady sliding, not by a layer that slides";
            return Err(Error::in_file(&place, None, format!("`refit`: {expected}")));
        }
        Ok(Self {
            problem: problem(&header, parameters)?,
            start: covariance.numbers.iter().map(|number| number.value).collect(),
            sliding,
            identity: header.text(),
            stop: stop.clone(),
        })
    }
}

/// The measurements of a header, to be met by some parameters.
fn problem(header: &Header, parameters: Vec<FreeParameter>) -> Result<Problem, TableError> {
    let numbers = |(key, unit): (&str, &str)| header.numbers(key, unit);
    let optional = |(key, unit): (&str, &str)| header.optional(key, |header, key| header.numbers(key, unit));
    let (speeds, loads) = (numbers(SPEED)?, numbers(PRESSURE)?);
    let (temperatures, ways) = (optional(TEMPERATURE)?, optional(WAY)?);
    let (frictions, sigmas) = (numbers(FRICTION)?, numbers(SIGMA)?);
    let mut problem = Problem { parameters, points: Vec::new(), rows: Vec::new(), has_sigma: true };
    let of = |values: &Option<Vec<f64>>, row: usize| values.as_ref().and_then(|values| values.get(row).copied());
    for (row, (((&speed, &load), &friction), &sigma)) in
        speeds.iter().zip(&loads).zip(&frictions).zip(&sigmas).enumerate()
    {
        let point = OperatingPoint { speed, load, temperature: of(&temperatures, row), way: of(&ways, row) };
        problem.add(point, friction, sigma);
    }
    Ok(problem)
}

impl Refit for StoredFit {
    fn identity(&self) -> &str {
        &self.identity
    }

    fn refit(&self, drawn: &DrawnAt<'_>) -> Result<Vec<f64>, Refused> {
        let scene_at = |values: &[f64]| drawn(values).map_err(|refused| Error::scene(refused.problem));
        let grid_of = |scene: &Scene| self.sliding.grid(scene);
        let steady = SteadyModel::new(&scene_at, &grid_of);
        let go_on = |_: &Task, _: &Outcome| self.stop.go_on();
        let model = Memo::new(&steady, [], &go_on);
        let mut problem = self.problem.clone();
        loop {
            match minimise(&problem, &model, &problem.places(&self.start), OF_A_SAMPLE, &|_| ()) {
                Ok(fitted) => return Ok(problem.values(&fitted.places)),
                Err(ModelError::NotSteady(failed)) => {
                    problem = problem.without(&failed.into_iter().map(|(point, _)| point).collect::<Vec<_>>());
                }
                Err(error) => {
                    let problem = format!("the covariance's numbers cannot be fitted anew: {error}");
                    return Err(Refused { key: "what varies beside the covariance".to_owned(), problem });
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::calibration::{CalibrationOptions, PlanOptions, calibrate_scene};
    use crate::files::{ColumnOptions, parse_scene};
    use crate::uncertainty::{Drawn, SampleOptions, Sampler};

    /// An elastic sine on which all friction is a shear strength over the modulus of the waves below: the measurements tell
    /// the quotient alone.
    const SCENE: &str = "name = 'a'
layer = { foundation = 'half_space', masses = 16, spacing = 6.25e-5, width = 1e-2 }
material = { density = 1e3, poisson_ratio = 0.5, equilibrium_modulus = 3e6, prony = [] }
friction = { shear_strength = 6.5e6 }
[surface]
kind = 'sinusoid'
amplitude = 1e-5
wavelength = 1e-3
points_per_wavelength = 64
fine = { rms_slope = 1.0, modulus = 4e7 }
";

    /// The standard deviation of the logarithm of strength over modulus.
    fn spread(uncertain: &UncertainScene) -> f64 {
        let sampler = Sampler::new(uncertain.axes(), SampleOptions { count: 64, seed: 1 }).unwrap();
        let drawn = uncertain.draw_all(&sampler, Ok).unwrap().made;
        let of = |drawn: &Drawn, key: &str| drawn.values.iter().find(|(name, _)| name == key).unwrap().1;
        let quotient = |drawn: &Drawn| of(drawn, "friction.shear_strength") / of(drawn, "surface.fine.modulus");
        let all: Vec<f64> = drawn.iter().map(|drawn| quotient(drawn).ln()).collect();
        let mean = all.iter().sum::<f64>() / all.len() as f64;
        (all.iter().map(|one| (one - mean).powi(2)).sum::<f64>() / all.len() as f64).sqrt()
    }

    #[test]
    fn what_was_measured_is_not_counted_twice() {
        let folder = std::env::temp_dir().join(format!("asperity-refit-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let (data, file) = (folder.join("measured.csv"), folder.join("a.toml"));
        let rows = "speed [m/s],pressure [Pa],mu,sigma\n0.1,2e4,0.30,0.01\n0.3,2e4,0.29,0.01\n1,2e4,0.31,0.01\n";
        std::fs::write(&data, rows).unwrap();
        let options = CalibrationOptions {
            data,
            columns: ColumnOptions::default(),
            free: vec![FreeParameter::parse("friction.shear_strength=1e6..1e8").unwrap()],
            sliding: SlidingOptions::default(),
            next: PlanOptions::default(),
        };
        let scene = parse_scene(SCENE, &file, &[]).unwrap();
        let (found, text, covariance) =
            calibrate_scene(scene, SCENE.into(), &options, || std::ops::ControlFlow::Continue(())).unwrap();
        std::fs::write(folder.join("c.csv"), covariance.text().unwrap()).unwrap();
        let beside = "[uncertainty]\ncovariance = 'c.csv'\n'surface.fine.modulus' = { relative = 0.2 }\n";
        let scene = parse_scene(&(text + beside), &file, &[]).unwrap();
        let of = |refit| uncertain_scene(scene.clone(), refit, &Stop::default()).unwrap();
        let warning = of(false).counted_twice().unwrap();
        assert!(warning.contains("surface.fine.modulus beside friction.shear_strength"), "{warning}");
        assert_eq!(of(true).counted_twice(), None);
        // 2 % of three measurements of 0.30 ± 0.01, and 20 % of the modulus: a band of 64 points of a net is good to 10 %.
        let error = found.parameters()[0].standard_error.unwrap() / found.parameters()[0].value;
        let (with, without) = (spread(&of(true)), spread(&of(false)));
        assert!((with / error - 1.0).abs() < 0.1 && error < 0.03, "{with}: {error}");
        assert!((without / error.hypot(0.2) - 1.0).abs() < 0.1, "{without}");
        // Without the measurements, or a covariance, there is nothing to fit by.
        let bare = covariance.text().unwrap().replace("# refit = 1\n", "");
        std::fs::write(folder.join("c.csv"), bare).unwrap();
        let error = uncertain_scene(scene, true, &Stop::default()).unwrap_err().to_string();
        assert!(error.contains("c.csv") && error.contains("calibrate once more"), "{error}");
        let alone = format!("{SCENE}[uncertainty]\n'surface.fine.modulus' = {{ relative = 0.2 }}\n");
        let error = uncertain_scene(parse_scene(&alone, &file, &[]).unwrap(), true, &Stop::default()).unwrap_err();
        assert!(error.to_string().contains("covariance"), "{error}");
        std::fs::remove_dir_all(folder).unwrap();
    }
}
