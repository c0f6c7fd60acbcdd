//! The ranking, from friction of all scenes at all points, their own and that of the samples.

use crate::csv;
use crate::decimals::real;
use crate::error::Error;
use crate::sweep::quantile;
use asperity::element::{Load, OperatingPoint, some_of};
use clap::ValueEnum;
use serde::{Deserialize, Serialize};

/// The quantiles of a band.
pub const QUANTILES: [f64; 5] = [0.05, 0.25, 0.5, 0.75, 0.95];
/// What two scenes are told apart with.
pub const SURE: f64 = 0.9;

/// [`QUANTILES`] of something.
pub type Band = [f64; 5];
/// Friction of the scenes, each at all points; `None` where there is no result.
pub(super) type Frictions = Vec<Vec<Option<f64>>>;

/// The mean by which scenes are ranked.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum Mean {
    /// Of friction μ
    #[default]
    Arithmetic,
    /// 1 over the mean of 1/μ: the braking way goes with 1/μ
    Harmonic,
}

impl Mean {
    /// The mean of values with their weights, of all 1 together.
    pub(super) fn of(self, weighted: impl Iterator<Item = (f64, f64)>) -> f64 {
        match self {
            Self::Arithmetic => weighted.map(|(value, weight)| weight * value).sum(),
            Self::Harmonic => 1.0 / weighted.map(|(value, weight)| weight / value).sum::<f64>(),
        }
    }

    /// Whether a value has a part in it.
    fn takes(self, value: f64) -> bool {
        self == Self::Arithmetic || value > 0.0
    }
}

/// Scenes in their order.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Ranking {
    /// What presses.
    #[serde(skip)]
    pub load: Load,
    /// The mean by which they are ranked.
    pub mean: Mean,
    /// The points that were asked for.
    pub points: Vec<RankedPoint>,
    /// The scenes in the order that they were given in.
    pub scenes: Vec<RankedScene>,
    /// The indices of the scenes, that with the largest friction first.
    pub order: Vec<usize>,
    /// Each scene with each that was given after it; none without samples.
    pub pairs: Vec<Pair>,
    /// How many samples count; 0 where none of the scenes says what is not known of it.
    pub samples: usize,
    /// How many samples had no result at some point and are left out.
    pub failed: usize,
    /// How many draws were no scene, and were drawn anew.
    pub redrawn: usize,
    /// Why samples have no result, the most frequent kinds; `None` where all have one.
    pub problems: Option<String>,
}

/// A point, and which scene has the largest friction there.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RankedPoint {
    /// The point.
    pub point: OperatingPoint,
    /// Its weight in the mean, of all 1 together; 0 also where not all scenes have a result.
    pub weight: f64,
    /// Friction of each scene as it stands.
    pub friction: Vec<Option<f64>>,
    /// The band of each scene's friction; `None` without samples.
    pub bands: Vec<Option<Band>>,
    /// With which probability each scene has the largest friction; without samples 1 of the one that has it, and parts of
    /// it where several do.
    pub largest: Vec<f64>,
}

/// A scene, by its weighted mean.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RankedScene {
    /// What it is called.
    pub label: String,
    /// The [mean](Ranking::mean) of its friction, ...
    pub friction: f64,
    /// ... and its band.
    pub friction_band: Option<Band>,
    /// That over the first scene's, times 100, ...
    pub index: f64,
    /// ... and its band: of the same sample of both.
    pub index_band: Option<Band>,
    /// The probability that it is the largest; parts of 1 where several are; without samples as it stands.
    pub largest: f64,
}

/// Two scenes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Pair {
    /// Their indices.
    pub scenes: [usize; 2],
    /// The probability that the first is above the other, ties counted by half.
    pub above: f64,
    /// The part of the samples in which they are equal.
    pub ties: f64,
}

impl Ranking {
    /// Of `labels` with their `own` friction at `points` with some weights, and that of the `samples`.
    pub(super) fn new(
        labels: Vec<String>,
        (load, points, kind): (Load, &[(OperatingPoint, f64)], Mean),
        own: &Frictions,
        samples: &[Frictions],
    ) -> Result<Self, Error> {
        let weights = weights(load, points, own)?;
        let mean = |friction: &Vec<Option<f64>>| mean(kind, friction, &weights);
        let means: Vec<f64> = own.iter().filter_map(mean).collect();
        if let Some((label, _)) = labels.iter().zip(own).find(|(_, friction)| mean(friction).is_none()) {
            let expected = "expected friction above 0 at each point for `mean` harmonic, as 1 over it is averaged";
            return Err(Error::value(format!("{label}: {expected}")));
        }
        if means.first().is_none_or(|first| *first <= 0.0) {
            let first = labels.into_iter().next().unwrap_or_default();
            let problem = "its friction in the mean is not above 0, so that nothing can be compared with it: name another scene \
                           first";
            return Err(Error::value(format!("{first}: {problem}")));
        }
        let sampled = |sample: &Frictions| sample.iter().map(mean).collect::<Option<Vec<f64>>>();
        let kept: Vec<Vec<f64>> = samples.iter().filter_map(sampled).filter(|means| means[0] > 0.0).collect();
        if !samples.is_empty() && kept.len() < 2 {
            let (failed, count) = (samples.len() - kept.len(), samples.len());
            let left = kept.len();
            let problem = format!("{failed} of {count} samples have no result: {left} are too few to rank by");
            return Err(Error::value(problem));
        }
        let alone = [means.clone()];
        let counted: &[Vec<f64>] = if kept.is_empty() { &alone } else { &kept };
        let index = |means: &[f64], scene: usize| 100.0 * (means[scene] / means[0]);
        let largest = largest(counted.iter().map(Vec::as_slice), labels.len());
        let scene = |(scene, label): (usize, String)| RankedScene {
            label,
            friction: means[scene],
            friction_band: band(kept.iter().map(|means| means[scene])),
            index: index(&means, scene),
            index_band: band(kept.iter().map(|means| index(means, scene))),
            largest: largest[scene],
        };
        let scenes: Vec<RankedScene> = labels.into_iter().enumerate().map(scene).collect();
        let ranked_point = |at: usize| point(at, (points[at].0, weights[at]), own, samples);
        Ok(Self {
            load,
            mean: kind,
            points: (0..points.len()).map(ranked_point).collect(),
            order: order(&scenes),
            pairs: pairs(&kept, scenes.len()),
            scenes,
            samples: kept.len(),
            failed: samples.len() - kept.len(),
            redrawn: 0,
            problems: None,
        })
    }

    /// The first two in the order, and with which probability the first is above the second; `None` without samples.
    pub fn first_two(&self) -> Option<([&RankedScene; 2], f64)> {
        let [first, second, ..] = self.order[..] else { return None };
        let above = self.above(first, second)?;
        Some(([&self.scenes[first], &self.scenes[second]], above))
    }

    /// The probability that a scene is above another one, ties counted by half; `None` without samples.
    pub fn above(&self, one: usize, other: usize) -> Option<f64> {
        self.pairs.iter().find_map(|pair| match pair.scenes {
            scenes if scenes == [one, other] => Some(pair.above),
            scenes if scenes == [other, one] => Some(1.0 - pair.above),
            _ => None,
        })
    }

    /// Whether the first two are told apart.
    pub fn is_sure(&self) -> bool {
        self.first_two().is_some_and(|(_, above)| above >= SURE)
    }

    /// What to look at: points and samples that are left out.
    pub fn warnings(&self) -> Vec<String> {
        /// From this part of the samples on it is said.
        const MANY: f64 = 0.05;
        let without = |point: &&RankedPoint| point.friction.contains(&None);
        let without: Vec<String> =
            self.points.iter().filter(without).map(|point| point.point.describe(self.load)).collect();
        let points = (!without.is_empty()).then(|| {
            format!(
                "{} of {} points are left out of the mean, for not all scenes have a result there: {}",
                without.len(),
                self.points.len(),
                some_of(&without)
            )
        });
        let count = self.samples + self.failed;
        let why = self.problems.as_ref().map(|why| format!("; most often: {why}")).unwrap_or_default();
        let samples = (self.failed as f64 > MANY * count as f64)
            .then(|| format!("{} of {count} samples have no result at some point and are left out{why}", self.failed));
        points.into_iter().chain(samples).collect()
    }
}

/// The weights of the points at which all scenes have a result, of all 1 together; 0 of the others.
fn weights(load: Load, points: &[(OperatingPoint, f64)], own: &Frictions) -> Result<Vec<f64>, Error> {
    let counts = |at: usize| own.iter().all(|friction| friction[at].is_some());
    let sum: f64 = points.iter().enumerate().filter(|(at, _)| counts(*at)).map(|(_, (_, weight))| weight).sum();
    if sum <= 0.0 {
        let all: Vec<String> = points.iter().map(|(point, _)| point.describe(load)).collect();
        return Err(Error::value(format!("there is no point at which all scenes have a result: {}", some_of(&all))));
    }
    Ok(points.iter().enumerate().map(|(at, (_, weight))| if counts(at) { weight / sum } else { 0.0 }).collect())
}

/// The weighted mean; `None` where a point that counts has no result, or none that the mean takes.
fn mean(kind: Mean, friction: &[Option<f64>], weights: &[f64]) -> Option<f64> {
    let counted = friction.iter().zip(weights).filter(|(_, weight)| **weight > 0.0);
    let counted = counted.map(|(friction, weight)| Some((friction.filter(|value| kind.takes(*value))?, *weight)));
    counted.collect::<Option<Vec<_>>>().map(|counted| kind.of(counted.into_iter()))
}

fn point(at: usize, (point, weight): (OperatingPoint, f64), own: &Frictions, samples: &[Frictions]) -> RankedPoint {
    let at_point = |frictions: &Frictions| frictions.iter().map(|friction| friction[at]).collect::<Option<Vec<f64>>>();
    let sampled: Vec<Vec<f64>> = samples.iter().filter_map(at_point).collect();
    let alone: Vec<Vec<f64>> = at_point(own).into_iter().collect();
    let counted = if samples.is_empty() { &alone } else { &sampled };
    RankedPoint {
        point,
        weight,
        friction: own.iter().map(|friction| friction[at]).collect(),
        bands: (0..own.len()).map(|scene| band(sampled.iter().map(|frictions| frictions[scene]))).collect(),
        largest: largest(counted.iter().map(Vec::as_slice), own.len()),
    }
}

/// In which part of the samples each scene is the largest, of those that are equal each a part; 0 of none.
fn largest<'a>(samples: impl Iterator<Item = &'a [f64]>, scenes: usize) -> Vec<f64> {
    let (mut parts, mut count) = (vec![0.0; scenes], 0.0);
    for sample in samples {
        let top = sample.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let ties = sample.iter().filter(|value| **value == top).count() as f64;
        parts.iter_mut().zip(sample).filter(|(_, value)| **value == top).for_each(|(part, _)| *part += 1.0 / ties);
        count += 1.0;
    }
    parts.iter().map(|part| if count > 0.0 { part / count } else { 0.0 }).collect()
}

/// The scenes by the median of their index or, without samples, by that; equal ones as they were given.
fn order(scenes: &[RankedScene]) -> Vec<usize> {
    let by = |scene: &RankedScene| scene.index_band.map_or(scene.index, |band| band[2]);
    let mut order: Vec<usize> = (0..scenes.len()).collect();
    order.sort_by(|a, b| by(&scenes[*b]).total_cmp(&by(&scenes[*a])));
    order
}

fn pairs(samples: &[Vec<f64>], scenes: usize) -> Vec<Pair> {
    if samples.is_empty() {
        return Vec::new();
    }
    let count = samples.len() as f64;
    let pair = |one: usize, other: usize| {
        let part =
            |holds: fn(f64, f64) -> bool| samples.iter().filter(|means| holds(means[one], means[other])).count() as f64;
        let ties = part(|a, b| a == b);
        Pair { scenes: [one, other], above: (part(|a, b| a > b) + 0.5 * ties) / count, ties: ties / count }
    };
    (0..scenes).flat_map(|one| (one + 1..scenes).map(move |other| (one, other))).map(|(a, b)| pair(a, b)).collect()
}

/// The quantiles of some values; `None` of fewer than two.
fn band(values: impl Iterator<Item = f64>) -> Option<Band> {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    let band = QUANTILES.map(|probability| quantile(&values, probability).unwrap_or_default());
    (values.len() > 1).then_some(band)
}

/// The table of a ranking, a row for each point and scene; fields of what there is no result of are empty.
pub fn table(ranking: &Ranking) -> String {
    let load = match ranking.load {
        Load::Pressure { .. } => "pressure [Pa]",
        Load::Force => "force [N]",
    };
    let quantiles = QUANTILES.map(|quantile| format!("friction_{quantile}"));
    let head = ["scene", "speed [m/s]", load, "temperature [K]", "weight", "friction"];
    let head = head.into_iter().chain(quantiles.iter().map(String::as_str)).chain(["largest"]);
    let text = |value: Option<f64>| value.map_or_else(String::new, real);
    let rows = ranking.points.iter().flat_map(|ranked| {
        ranking.scenes.iter().enumerate().map(move |(i, scene)| {
            let at = &ranked.point;
            let own = [Some(at.speed), Some(at.load), at.temperature, Some(ranked.weight), ranked.friction[i]];
            let band = (0..QUANTILES.len()).map(|quantile| ranked.bands[i].map(|band| band[quantile]));
            let numbers = own.into_iter().chain(band).chain([Some(ranked.largest[i])]).map(text);
            std::iter::once(csv::given_name(&scene.label)).chain(numbers).collect()
        })
    });
    csv::text(head, rows)
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn points(weights: &[f64]) -> Vec<(OperatingPoint, f64)> {
        let point = |i: usize| OperatingPoint { speed: 1.0 + i as f64, load: 1e5, temperature: None, way: None };
        weights.iter().enumerate().map(|(i, weight)| (point(i), *weight)).collect()
    }

    fn ranked(points: &[(OperatingPoint, f64)], own: &Frictions, samples: &[Frictions]) -> Result<Ranking, Error> {
        let labels = (0..own.len()).map(|i| format!("scene {i}")).collect();
        Ranking::new(labels, (Load::Force, points, Mean::Arithmetic), own, samples)
    }

    fn frictions(scenes: &[&[f64]]) -> Frictions {
        scenes.iter().map(|friction| friction.iter().map(|value| Some(*value)).collect()).collect()
    }

    #[test]
    fn scenes_are_ranked_by_their_weighted_means() {
        let own = frictions(&[&[1.0, 0.5], &[0.8, 1.0]]);
        let ranking = ranked(&points(&[1.0, 3.0]), &own, &[]).unwrap();
        // (1 + 1.5)/4 and (0.8 + 3)/4.
        assert_eq!((ranking.order.clone(), ranking.scenes[1].index), (vec![1, 0], 100.0 * (0.95 / 0.625)));
        assert_eq!((ranking.first_two(), ranking.is_sure(), ranking.scenes[1].largest), (None, false, 1.0));
        assert_eq!(ranking.points[0].largest, [1.0, 0.0]);
    }

    /// Braking over the first half of a way on 1.0 and over the other on 0.25 takes as long a way as on 0.4 throughout.
    #[test]
    fn the_harmonic_mean_ranks_by_the_braking_way() {
        let own = frictions(&[&[1.0, 0.25], &[0.5, 0.5]]);
        let of =
            |kind| Ranking::new(vec!["a".into(), "b".into()], (Load::Force, &points(&[1.0, 1.0]), kind), &own, &[]);
        let orders = [Mean::Arithmetic, Mean::Harmonic].map(|kind| of(kind).unwrap().order);
        assert_eq!(orders, [vec![0, 1], vec![1, 0]]);
        assert_eq!(of(Mean::Harmonic).unwrap().scenes[0].friction, 0.4);
        let none = frictions(&[&[1.0, 0.0], &[0.5, 0.5]]);
        let labels = vec!["a".into(), "b".into()];
        let error = Ranking::new(labels, (Load::Force, &points(&[1.0, 1.0]), Mean::Harmonic), &none, &[]).unwrap_err();
        assert!(error.to_string().contains("a: expected friction above 0"), "{error}");
    }

    /// What all samples share drops out: the band of the index is that of the ratio.
    #[test]
    fn common_factors_drop_out() {
        let own = frictions(&[&[1.0], &[1.01]]);
        let samples: Vec<Frictions> = (0..64)
            .map(|i| 0.7 + 0.01 * f64::from(i))
            .map(|factor| frictions(&[&[factor], &[1.01 * factor]]))
            .collect();
        let ranking = ranked(&points(&[1.0]), &own, &samples).unwrap();
        assert!(ranking.is_sure() && ranking.first_two().unwrap().1 == 1.0);
        let band = ranking.scenes[1].index_band.unwrap();
        assert!(band.iter().all(|index| (index - 101.0).abs() < 1e-12), "{band:?}");
        let absolute = ranking.scenes[1].friction_band.unwrap();
        assert!(absolute[4] / absolute[0] > 1.5, "{absolute:?}");
    }

    #[test]
    fn equal_scenes_are_above_each_other_with_a_half() {
        let samples: Vec<Frictions> = (1..4).map(|i| frictions(&[&[f64::from(i)], &[f64::from(i)]])).collect();
        let ranking = ranked(&points(&[1.0]), &frictions(&[&[1.0], &[1.0]]), &samples).unwrap();
        assert_eq!(ranking.pairs, [Pair { scenes: [0, 1], above: 0.5, ties: 1.0 }]);
        assert_eq!((ranking.order.clone(), ranking.is_sure()), (vec![0, 1], false));
        assert_eq!([ranking.scenes[0].largest, ranking.scenes[1].largest], [0.5, 0.5]);
    }

    /// A point counts where all scenes have a result, a sample where all have one at all points that count.
    #[test]
    fn what_has_no_result_is_left_out_of_all_scenes() {
        let mut own = frictions(&[&[1.0, 2.0], &[3.0, 1.0]]);
        own[1][1] = None;
        let mut failed = frictions(&[&[1.0, 1.0], &[1.0, 1.0]]);
        failed[0][0] = None;
        let other = || frictions(&[&[1.0, 9.0], &[2.0, 9.0]]);
        let ranking = ranked(&points(&[1.0, 1.0]), &own, &[other(), failed, other()]).unwrap();
        assert_eq!((ranking.samples, ranking.failed, ranking.scenes[1].index), (2, 1, 300.0));
        let warnings = ranking.warnings();
        assert!(warnings[0].starts_with("1 of 2 points are left out of the mean") && warnings[0].contains("2 m/s"));
        assert!(warnings[1].starts_with("1 of 3 samples"), "{warnings:?}");
        own[0][0] = None;
        assert!(ranked(&points(&[1.0, 1.0]), &own, &[]).is_err());
    }

    /// Number 8 of Hyndman and Fan, as a table of a sweep has them.
    #[test]
    fn a_band_has_the_quantiles_of_a_table() {
        assert_eq!(band([2.0, 1.0].into_iter()), Some([1.0, 1.0, 1.5, 2.0, 2.0]));
        assert_eq!(band((0..=100).rev().map(f64::from)).map(|band| band[2]), Some(50.0));
        assert_eq!(band([1.0].into_iter()), None);
    }
}
