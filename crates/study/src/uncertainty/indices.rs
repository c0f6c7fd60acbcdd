//! What matters: the part of friction's variance that each group explains.
//!
//! Ranks of friction, as normal scores, are regressed on the standard normal numbers of all axes; as these are
//! independent, the square of each coefficient is the part of the variance that its axis explains, if friction adds up
//! over the axes and rises or falls along each (A. Saltelli, K. Chan, E. M. Scott (eds.), *Sensitivity Analysis*, 2000).
//! The square of a coefficient is too large by its variance on average, which is taken off. A group has the sum over its
//! axes. What they leave is not additive or not monotone, or due to a surface's seed.

use nalgebra::{DMatrix, DVector};

use super::drawing::Group;
use super::sampler::inverse_normal;

/// What a group explains.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Index {
    /// The part of the variance, from 0 to about 1.
    pub share: f64,
    /// Its standard error.
    pub error: f64,
}

/// What each group explains.
#[derive(Clone, Debug, PartialEq)]
pub struct Indices {
    /// In the order of the groups.
    pub groups: Vec<Index>,
    /// What none of them explains.
    pub rest: f64,
}

/// What each of the `groups` explains of the `results`, from the normal numbers of each sample along all of their axes;
/// samples without a result are left out. `None` where there are too few samples for the axes, or all results are the
/// same.
pub fn indices(groups: &[Group], normals: &[&[f64]], results: &[Option<f64>]) -> Option<Indices> {
    let kept: Vec<(&[f64], f64)> = normals.iter().zip(results).filter_map(|(x, y)| Some((*x, (*y)?))).collect();
    let axes: usize = groups.iter().map(|group| group.axes.len()).sum();
    let degrees = kept.len().checked_sub(axes + 1).filter(|degrees| *degrees > 0)? as f64;
    let y = standardised(&scores(&kept.iter().map(|(_, y)| *y).collect::<Vec<_>>()))?;
    let columns: Option<Vec<DVector<f64>>> =
        (0..axes).map(|axis| standardised(&kept.iter().map(|(x, _)| x[axis]).collect::<Vec<_>>())).collect();
    let columns = columns?;
    let (explained, coefficients) = if axes == 0 { (0.0, Vec::new()) } else { regressed(&columns, &y, degrees)? };
    let mut left = coefficients.into_iter();
    let groups = groups.iter().map(|group| {
        let parts = left.by_ref().take(group.axes.len());
        // E[b²] = β² + s², Var[b²] = 4 β² s² + 2 s⁴.
        let (share, variance) = parts.fold((0.0, 0.0), |(share, variance), (b, square)| {
            let unbiased = b * b - square;
            (share + unbiased, variance + 4.0 * unbiased.max(0.0) * square + 2.0 * square * square)
        });
        Index { share: share.max(0.0), error: f64::sqrt(variance) }
    });
    Some(Indices { groups: groups.collect(), rest: (1.0 - explained).max(0.0) })
}

/// The part of the variance that a regression on standardised columns explains, corrected for its degrees of freedom; and
/// each coefficient with the square of its standard error.
fn regressed(columns: &[DVector<f64>], y: &DVector<f64>, degrees: f64) -> Option<(f64, Vec<(f64, f64)>)> {
    let x = DMatrix::from_columns(columns);
    let inverse = (x.transpose() * &x).cholesky()?.inverse();
    let coefficients = &inverse * (x.transpose() * y);
    let residual = (y - &x * &coefficients).norm_squared();
    let variance = residual / degrees;
    let found = coefficients.iter().enumerate().map(|(k, b)| (*b, variance * inverse[(k, k)])).collect();
    let whole = y.norm_squared();
    let unexplained = residual / degrees * (y.len() as f64 - 1.0) / whole;
    Some((1.0 - unexplained, found))
}

/// Normal scores of the ranks; equal values share the mean of their ranks.
fn scores(values: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|one, other| values[*one].total_cmp(&values[*other]));
    let mut scores = vec![0.0; values.len()];
    for same in order.chunk_by(|one, other| values[*one] == values[*other]) {
        let first = order.partition_point(|at| values[*at].total_cmp(&values[same[0]]).is_lt());
        let rank = first as f64 + 0.5 * (same.len() as f64 - 1.0);
        let score = inverse_normal((rank + 0.5) / values.len() as f64);
        same.iter().for_each(|at| scores[*at] = score);
    }
    scores
}

/// About the mean, with a mean square of 1; `None` where all are the same.
fn standardised(values: &[f64]) -> Option<DVector<f64>> {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let deviation = (values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / count).sqrt();
    (deviation > 0.0)
        .then(|| DVector::from_iterator(values.len(), values.iter().map(|value| (value - mean) / deviation)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::uncertainty::{SampleOptions, Sampler};

    fn group(axes: &[&str]) -> Group {
        Group { name: axes[0].to_owned(), axes: axes.iter().map(|axis| axis.to_string()).collect() }
    }

    fn of(count: usize, seed: u64, groups: &[Group], result: impl Fn(&[f64]) -> f64) -> Indices {
        let names = groups.iter().flat_map(|group| group.axes.clone()).collect::<Vec<_>>();
        let sampler = Sampler::new(names.clone(), SampleOptions { count, seed }).unwrap();
        let normals: Vec<Vec<f64>> =
            (0..count).map(|i| names.iter().map(|name| sampler.normal(i, 0, name)).collect()).collect();
        let rows: Vec<&[f64]> = normals.iter().map(Vec::as_slice).collect();
        let results: Vec<Option<f64>> = normals.iter().map(|x| Some(result(x))).collect();
        indices(groups, &rows, &results).unwrap()
    }

    /// Of a product of powers of log-normal numbers: the squares of elasticity times deviation over their sum.
    #[test]
    fn known_elasticities_are_found() {
        let groups = [group(&["a"]), group(&["b"]), group(&["c", "d"]), group(&["dead"])];
        for seed in 1..=10 {
            let found = of(256, seed, &groups, |x| (0.3 * x[0] - 0.2 * x[1] + 0.1 * x[2] + 0.1 * x[3]).exp());
            for (index, wanted) in found.groups.iter().zip([0.6, 0.4 * 2.0 / 3.0, 0.4 / 3.0, 0.0]) {
                assert!((index.share - wanted).abs() < 0.05, "{seed}: {found:?}");
            }
            assert!(found.rest < 0.02, "{found:?}");
        }
    }

    /// A parabola is seen by no regression: it is what is left.
    #[test]
    fn what_is_not_monotone_is_left() {
        let groups = [group(&["a"]), group(&["b"])];
        let found = of(256, 1, &groups, |x| x[0] * x[0]);
        assert!(found.groups.iter().all(|index| index.share < 0.05) && found.rest > 0.9, "{found:?}");
    }

    /// With noise the error is what repeated draws scatter by.
    #[test]
    fn errors_are_those_of_repeated_draws() {
        let groups = [group(&["a"]), group(&["b"])];
        let noise = |seed: u64, x: &[f64]| {
            let mut random = asperity::math::SplitMix64::new(seed ^ x[1].to_bits());
            inverse_normal(random.unit().max(1e-9))
        };
        let found: Vec<Index> =
            (1..=40).map(|seed| of(128, seed, &groups, |x| x[0] + noise(seed, x)).groups[0]).collect();
        let mean = found.iter().map(|index| index.share).sum::<f64>() / 40.0;
        let scatter = (found.iter().map(|index| (index.share - mean).powi(2)).sum::<f64>() / 39.0).sqrt();
        let error = found.iter().map(|index| index.error).sum::<f64>() / 40.0;
        assert!((mean - 0.5).abs() < 0.05, "{mean}");
        assert!((0.5..2.0).contains(&(error / scatter)), "{error} {scatter}");
    }

    #[test]
    fn few_samples_and_equal_results_have_none() {
        let groups = [group(&["a", "b"])];
        let rows: [&[f64]; 3] = [&[0.0, 1.0], &[1.0, 0.5], &[2.0, -1.0]];
        assert!(indices(&groups, &rows, &[Some(1.0), Some(2.0), Some(3.0)]).is_none());
        let rows: [&[f64]; 4] = [&[0.0, 1.0], &[1.0, 0.5], &[2.0, -1.0], &[1.5, 0.2]];
        assert!(indices(&groups, &rows, &[Some(1.0); 4]).is_none());
    }
}
