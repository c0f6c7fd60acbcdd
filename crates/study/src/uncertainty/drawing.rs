//! Scenes drawn from what is not known of one.
//!
//! What is not known, in groups: each key, and each file of a covariance; and the axes that each is drawn along.

use std::fmt;
use std::sync::Arc;

use asperity::scene::{ParameterError, Scene, SceneError, Setting, SpectrumFactors};
use rayon::prelude::*;

use super::covariance::{Covariance, Scale};
use super::sampler::Sampler;
use super::section::{Distribution, Spread, UncertainKey, Uncertainty};
use crate::error::Error;

/// A scene of which something is not known, as it was read.
#[derive(Clone, Debug)]
pub struct UncertainScene {
    scene: Scene,
    uncertainty: Uncertainty,
    groups: Vec<Group>,
    refit: Option<Arc<dyn Refit>>,
}

/// The scene that was drawn, with these numbers of the covariance.
pub type DrawnAt<'a> = dyn Fn(&[f64]) -> Result<Scene, Refused> + Sync + 'a;

/// What fits the numbers of the covariance anew in a scene that was drawn.
pub trait Refit: fmt::Debug + Send + Sync {
    /// What tells it from others.
    fn identity(&self) -> &str;

    /// The numbers, in their order.
    ///
    /// # Errors
    /// Where there are none.
    fn refit(&self, drawn: &DrawnAt<'_>) -> Result<Vec<f64>, Refused>;
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
        Ok(Self { scene, uncertainty, groups, refit: None })
    }

    /// The same, its covariance's numbers fitted anew in each scene that is drawn: they are off from there.
    #[must_use]
    pub fn refitted(self, refit: Arc<dyn Refit>) -> Self {
        Self { refit: Some(refit), ..self }
    }

    /// Whether the covariance's numbers are fitted anew.
    pub fn is_refitted(&self) -> bool {
        self.refit.is_some()
    }

    /// What tells its samples from those of others.
    pub(crate) fn identity(&self) -> String {
        let refit = self.refit.as_ref().map(|refit| refit.identity()).unwrap_or_default();
        format!("{:?}{refit}", self.uncertainty)
    }

    /// A warning of what varies beside a covariance that was fitted with it as it stands.
    pub fn counted_twice(&self) -> Option<String> {
        /// Measurements have temperatures of their own.
        const OF_CONDITIONS: &str = "material.wlf.temperature";
        let Covariance { file, numbers, .. } = self.uncertainty.covariance.as_ref().filter(|_| self.refit.is_none())?;
        let keys = self.uncertainty.keys.iter().map(|key| key.key.as_str()).filter(|key| *key != OF_CONDITIONS);
        let (keys, numbers): (Vec<&str>, Vec<&str>) = (keys.collect(), numbers.iter().map(|one| &*one.key).collect());
        let (beside, fitted) = (keys.join(", "), numbers.join(", "));
        (!keys.is_empty()).then(|| {
            format!(
                "[uncertainty] varies {beside} beside {fitted}, fitted with these as they are ({}): what the measurements say \
                 of all together is counted twice; `refit` fits {fitted} anew in each sample",
                file.display()
            )
        })
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
        let numbers = values.iter().filter(|(key, _)| key != Uncertainty::SURFACE);
        set.extend(numbers.map(|(key, value)| Setting::new(key, *value)));
        let scene_with = |fitted: &[(String, f64)]| -> Result<(Scene, Vec<(String, f64)>), Refused> {
            let fitted = fitted.iter().map(|(key, value)| Setting::new(key, *value));
            let set: Vec<Setting> = set.iter().cloned().chain(fitted).collect();
            let (mut scene, mut values) = (self.scene.with_all(&set).map_err(Refused::from)?, Vec::new());
            for UncertainKey { key, spread } in keys {
                scene = transformed(scene, key, spread, normal, &mut values)?;
            }
            Ok((scene, values))
        };
        let mut off = Vec::new();
        if let Some(covariance) = covariance {
            let key = |index: usize| covariance.numbers[index].key.clone();
            let named = |found: &[f64]| found.iter().enumerate().map(|(i, found)| (key(i), *found)).collect::<Vec<_>>();
            let about = match &self.refit {
                Some(refit) => refit.refit(&|found: &[f64]| scene_with(&named(found)).map(|(scene, _)| scene))?,
                None => covariance.numbers.iter().map(|number| number.value).collect(),
            };
            off = fitted(covariance, &about, normal, unit);
        }
        let (scene, transformed) = scene_with(&off)?;
        values.extend(off.into_iter().chain(transformed));
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

/// Numbers that were fitted together, off from these.
fn fitted(
    covariance: &Covariance,
    about: &[f64],
    normal: impl Fn(&str) -> f64,
    unit: impl Fn(&str) -> f64,
) -> Vec<(String, f64)> {
    let file = covariance.file.to_string_lossy();
    let widened = covariance.widened(unit(&variance_axis(&file)));
    let normals: Vec<f64> = (0..covariance.numbers.len()).map(|i| normal(&fitted_axis(&file, i))).collect();
    // One χ² for all: they are off together by a multivariate t.
    let moved = |row: &[f64]| widened * row.iter().zip(&normals).map(|(part, normal)| part * normal).sum::<f64>();
    let numbers = covariance.numbers.iter().zip(about).zip(&covariance.root).map(|((number, about), row)| {
        let value = match number.scale {
            Scale::Log => about * moved(row).exp(),
            Scale::Linear => about + moved(row),
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

/// A key or a file of a covariance.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Group {
    /// The path of the key, or the name of the file.
    pub name: String,
    /// Its axes; none of a surface's seed, whose effect has no direction.
    pub axes: Vec<String>,
}

/// Distance of the nodes of the process over the relaxation times, in decades: its length.
const LENGTH: f64 = 2.0;

/// What is not known of a scene, in the order of the keys; the covariance last.
pub(super) fn groups(uncertainty: &Uncertainty) -> Vec<Group> {
    let Uncertainty { keys, covariance } = uncertainty;
    let of_key = |key: &UncertainKey| Group { name: key.key.clone(), axes: axes(key) };
    let fitted = covariance.iter().map(|covariance| {
        let name = covariance.file.to_string_lossy().into_owned();
        let numbers = (0..covariance.numbers.len()).map(|i| fitted_axis(&name, i));
        Group { axes: numbers.chain(covariance.degrees.map(|_| variance_axis(&name))).collect(), name }
    });
    keys.iter().map(of_key).chain(fitted).collect()
}

fn axes(key: &UncertainKey) -> Vec<String> {
    match &key.spread {
        Spread::Number { .. } => vec![key.key.clone()],
        Spread::Prony { decades, .. } => nodes(decades).map(node_axis).collect(),
        Spread::Spectrum { decades: None, .. } => vec![Uncertainty::SPECTRUM.to_owned()],
        Spread::Spectrum { decades: Some(decades), .. } => decades.iter().map(|decade| decade_name(*decade)).collect(),
        Spread::Seed => Vec::new(),
    }
}

/// The axis of a decade of wavelengths of the spectrum.
pub fn decade_name(decade: i32) -> String {
    format!("{} 1e{decade} m", Uncertainty::SPECTRUM)
}

/// Axis `index` of a file.
pub(super) fn fitted_axis(file: &str, index: usize) -> String {
    format!("{file} {}", index + 1)
}

/// The axis of the variance of what a file was fitted to.
fn variance_axis(file: &str) -> String {
    format!("{file} variance")
}

/// Nodes about these decades of relaxation times: even decades, the same in every scene.
fn nodes(decades: &[f64]) -> std::ops::RangeInclusive<i32> {
    let [first, last] = [f64::min, f64::max].map(|of| decades.iter().copied().reduce(of).unwrap_or_default() / LENGTH);
    first.floor() as i32 - 1..=last.ceil() as i32 + 1
}

fn node_axis(node: i32) -> String {
    format!("{} 1e{} s", Uncertainty::PRONY, LENGTH as i32 * node)
}

/// A normal process over the decades of relaxation times: standard at each, with a correlation that falls as a Gaussian
/// of the length of two decades; a moving mean of independent normal numbers at the nodes.
pub(super) fn process(decades: &[f64], normal: impl Fn(&str) -> f64) -> Vec<f64> {
    let drawn: Vec<(f64, f64)> =
        nodes(decades).map(|node| (LENGTH * f64::from(node), normal(&node_axis(node)))).collect();
    let at = |decade: &f64| {
        // exp(-(d/L)²) for correlations of exp(-(d/L)²/2).
        let weight = |node: f64| (-((decade - node) / LENGTH).powi(2)).exp();
        let (sum, squares) = drawn.iter().fold((0.0, 0.0), |(sum, squares), (node, number)| {
            let weight = weight(*node);
            (sum + weight * number, squares + weight * weight)
        });
        sum / f64::sqrt(squares)
    };
    decades.iter().map(at).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::in_tests::assert_within;

    /// From the weights: one at each time, exp(-½ (d/2)²) between two; nodes two decades apart leave 2 %.
    #[test]
    fn the_process_is_as_long_as_two_decades() {
        let decades: Vec<f64> = (-24..=8).map(|i| 0.25 * f64::from(i)).collect();
        let axes: Vec<String> = nodes(&decades).map(node_axis).collect();
        let responses: Vec<Vec<f64>> =
            axes.iter().map(|axis| process(&decades, |other| if other == axis { 1.0 } else { 0.0 })).collect();
        for (i, one) in decades.iter().enumerate() {
            for (j, other) in decades.iter().enumerate() {
                let found: f64 = responses.iter().map(|response| response[i] * response[j]).sum();
                let wanted = (-0.125 * (one - other).powi(2)).exp();
                assert_within(found, wanted, if i == j { 1e-14 } else { 0.03 });
            }
        }
    }
}
