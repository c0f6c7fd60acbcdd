//! Scenes drawn from what is not known of one.

use asperity::scene::{ParameterError, Scene, SceneError, Setting, SpectrumFactors};
use rayon::prelude::*;

use super::covariance::{Covariance, Scale};
use super::groups::{Group, decade_name, fitted_axis, groups, process};
use super::sampler::Sampler;
use super::section::{Distribution, Spread, UncertainKey, Uncertainty};
use crate::error::Error;

/// A scene of which something is not known, as it was read.
#[derive(Clone, Debug)]
pub struct UncertainScene {
    scene: Scene,
    uncertainty: Uncertainty,
    groups: Vec<Group>,
}

/// A scene that was drawn.
#[derive(Clone, Debug)]
pub struct Drawn {
    /// The scene; nothing is unknown of it.
    pub scene: Scene,
    /// What was drawn, by names: numbers in SI units, moduli of the series in Pa, factors of the spectrum's density, the
    /// seed.
    pub values: Vec<(String, f64)>,
    /// The standard normal number along each axis, in the order of the groups.
    pub normals: Vec<f64>,
}

/// No such scene was there.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Refused {
    /// The key whose value is refused, as far as one is to blame.
    pub key: String,
    /// Why.
    pub problem: String,
}

/// What was made of the samples.
#[derive(Clone, Debug)]
pub struct Draws<T> {
    /// Of each sample.
    pub made: Vec<T>,
    /// How many draws were no scene, and were drawn anew.
    pub redrawn: usize,
}

/// A sample that is no scene so many times has no chance.
const MOST_ATTEMPTS: u32 = 32;

impl UncertainScene {
    /// Of a `scene`.
    ///
    /// # Errors
    /// Where everything is known of it.
    pub fn new(scene: Scene) -> Result<Self, Error> {
        let (uncertainty, _) = Uncertainty::of(&scene)?;
        if uncertainty.is_empty() {
            let expected = "expected a scene with a section [uncertainty], which says how far its numbers may be off";
            return Err(Error::scene(format!("`samples`: {expected}")));
        }
        let groups = groups(&uncertainty);
        Ok(Self { scene, uncertainty, groups })
    }

    /// The scene as it was read.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// What is not known of it.
    pub fn uncertainty(&self) -> &Uncertainty {
        &self.uncertainty
    }

    /// That in groups.
    pub fn groups(&self) -> &[Group] {
        &self.groups
    }

    /// How much warmer a scene that was drawn is, K: the points of its sweep are, too.
    pub fn warmer(&self, drawn: &Scene) -> f64 {
        drawn.temperature().zip(self.scene.temperature()).map_or(0.0, |(drawn, own)| drawn - own)
    }

    /// The axes of all groups.
    pub fn axes(&self) -> Vec<String> {
        self.groups.iter().flat_map(|group| group.axes.iter().cloned()).collect()
    }

    /// The draw of a sample for the `attempt`th time, from 0.
    ///
    /// # Errors
    /// Where what was drawn is no scene.
    pub fn draw(&self, sampler: &Sampler, index: usize, attempt: u32) -> Result<Drawn, Refused> {
        let normal = |axis: &str| sampler.normal(index, attempt, axis);
        let unit = |axis: &str| sampler.unit(index, attempt, axis);
        let Uncertainty { keys, covariance } = &self.uncertainty;
        let (mut values, mut set) = (Vec::new(), Vec::new());
        for UncertainKey { key, spread } in keys {
            match spread {
                Spread::Number { value, distribution } => {
                    values.push((key.clone(), drawn(*value, *distribution, unit(key), normal(key))));
                }
                Spread::Seed => {
                    let seed = sampler.surface_seed(index, attempt);
                    set.push(Setting::new("surface.seed", seed));
                    values.push((key.clone(), seed.into()));
                }
                Spread::Prony { .. } | Spread::Spectrum { .. } => (),
            }
        }
        values.extend(covariance.iter().flat_map(|covariance| fitted(covariance, normal)));
        let numbers = values.iter().filter(|(key, _)| key != Uncertainty::SURFACE);
        set.extend(numbers.map(|(key, value)| Setting::new(key, *value)));
        let mut scene = self.scene.with_all(&set).map_err(Refused::from)?;
        for UncertainKey { key, spread } in keys {
            scene = transformed(scene, key, spread, normal, &mut values)?;
        }
        let normals = self.groups.iter().flat_map(|group| &group.axes).map(|axis| normal(axis)).collect();
        Ok(Drawn { scene, values, normals })
    }

    /// What `make` makes of each sample, on all cores; one that it refuses is drawn anew, as one that is no scene.
    ///
    /// # Errors
    /// Where more than one of ten draws is refused.
    pub fn draw_all<T: Send>(
        &self,
        sampler: &Sampler,
        make: impl Fn(Drawn) -> Result<T, Refused> + Sync,
    ) -> Result<Draws<T>, Error> {
        Self::draw_together(&[self], sampler, |drawn| drawn.into_iter().map(&make).collect::<Result<Vec<T>, _>>())
            .map(|Draws { made, redrawn }| Draws { made: made.into_iter().flatten().collect(), redrawn })
    }

    /// What `make` makes of each sample of several scenes, drawn with common numbers: a sample that one of them refuses is
    /// drawn anew for all.
    ///
    /// # Errors
    /// As for [`draw_all`](Self::draw_all).
    pub fn draw_together<T: Send>(
        scenes: &[&Self],
        sampler: &Sampler,
        make: impl Fn(Vec<Drawn>) -> Result<T, Refused> + Sync,
    ) -> Result<Draws<T>, Error> {
        let attempt = |index: usize, attempt: u32| {
            let drawn = scenes.iter().map(|scene| scene.draw(sampler, index, attempt));
            drawn.collect::<Result<Vec<_>, _>>().and_then(&make)
        };
        let made = |index: usize| {
            let mut first = None;
            for count in 0..MOST_ATTEMPTS {
                match attempt(index, count) {
                    Ok(made) => return (Some(made), count as usize, first),
                    Err(refused) => first = first.or(Some(refused)),
                }
            }
            (None, MOST_ATTEMPTS as usize, first)
        };
        let all: Vec<_> = (0..sampler.options().count).into_par_iter().map(made).collect();
        let redrawn = all.iter().map(|(_, refused, _)| refused).sum();
        let first = all.iter().find_map(|(_, _, refused)| refused.clone());
        let count = all.len();
        let made: Vec<T> = all.into_iter().filter_map(|(made, ..)| made).collect();
        match first {
            Some(Refused { key, problem }) if made.len() < count || is_too_many(redrawn, count) => {
                let drawn = count + redrawn;
                Err(Error::scene(format!(
                    "{redrawn} of {drawn} draws are no scene, expected one of ten at most; the first: {problem}; give {key} \
                     less in [uncertainty]"
                )))
            }
            _ => Ok(Draws { made, redrawn }),
        }
    }
}

/// Whether more than one of ten draws was refused; a single one is none too many.
fn is_too_many(refused: usize, count: usize) -> bool {
    refused > 1 && 10 * refused > refused + count
}

/// A number drawn about a value by a uniform and by a normal number of the same probability.
fn drawn(value: f64, distribution: Distribution, unit: f64, normal: f64) -> f64 {
    match distribution {
        Distribution::Relative(deviation) => value * (deviation * normal).exp(),
        Distribution::Factor(factor) => value * factor.powf(2.0 * unit - 1.0),
        Distribution::Absolute(deviation) => value + deviation * normal,
    }
}

/// Numbers that were fitted together.
fn fitted(covariance: &Covariance, normal: impl Fn(&str) -> f64) -> Vec<(String, f64)> {
    let file = covariance.file.to_string_lossy();
    let normals: Vec<f64> = (0..covariance.numbers.len()).map(|i| normal(&fitted_axis(&file, i))).collect();
    let moved = |row: &[f64]| row.iter().zip(&normals).map(|(part, normal)| part * normal).sum::<f64>();
    let numbers = covariance.numbers.iter().zip(&covariance.root).map(|(number, row)| {
        let value = match number.scale {
            Scale::Log => number.value * moved(row).exp(),
            Scale::Linear => number.value + moved(row),
        };
        (number.key.clone(), value)
    });
    numbers.collect()
}

/// The scene with what is not a number of its own: moduli, or the spectrum.
fn transformed(
    mut scene: Scene,
    key: &str,
    spread: &Spread,
    normal: impl Fn(&str) -> f64,
    values: &mut Vec<(String, f64)>,
) -> Result<Scene, Refused> {
    match spread {
        Spread::Number { .. } | Spread::Seed => Ok(scene),
        Spread::Prony { relative, decades } => {
            let factors = process(decades, normal).into_iter().map(|number| (relative * number).exp());
            let terms = scene.material.iter_mut().flat_map(|material| &mut material.prony);
            for (number, (term, factor)) in (1..).zip(terms.zip(factors)) {
                term.modulus *= factor;
                values.push((format!("{key}[{number}].modulus"), term.modulus));
            }
            scene.check().map_err(Refused::from)?;
            Ok(scene)
        }
        Spread::Spectrum { relative, decades: None } => {
            let factor = (relative * normal(key)).exp();
            values.push((key.to_owned(), factor));
            scene.with_spectrum(SpectrumFactors::Whole(factor)).map_err(Refused::from)
        }
        Spread::Spectrum { relative, decades: Some(decades) } => {
            let factor = |decade: &i32| (*decade, (relative * normal(&decade_name(*decade))).exp());
            let factors: Vec<(i32, f64)> = decades.iter().map(factor).collect();
            values.extend(factors.iter().map(|(decade, factor)| (decade_name(*decade), *factor)));
            scene.with_spectrum(SpectrumFactors::Decades(factors)).map_err(Refused::from)
        }
    }
}

impl From<SceneError> for Refused {
    fn from(error: SceneError) -> Self {
        Self { key: error.key().to_owned(), problem: error.to_string() }
    }
}

impl From<ParameterError> for Refused {
    fn from(error: ParameterError) -> Self {
        Self { key: error.name().to_owned(), problem: error.to_string() }
    }
}
