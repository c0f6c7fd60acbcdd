//! Runs held against what they promise: errors over the tolerance asked for, and their own estimates over the errors.

use crate::robustness::{KEPT, ScaledQuantity, TIGHTER};

use super::reference::Reference;
use super::run::Estimate;
use super::stress::Stress;
use super::tolerances::ToleranceRow;
use super::trace::Errors;

/// The reference's own error may be so many tolerances: errors of [`KEPT`] are far enough above it.
const MAX_FLOOR: f64 = 0.3 * KEPT;

/// A run with its error, the larger of those of F_x and F_z, each over its largest value.
#[derive(Clone, Debug, PartialEq)]
pub struct Judgement {
    /// What was scaled, by this power of ten; `None` for the scene as it is.
    pub scaled: Option<(ScaledQuantity, i32)>,
    /// The method, as in `solver.method`.
    pub method: String,
    /// The relative tolerance.
    pub tolerance: f64,
    /// Its error, over the largest value.
    pub error: f64,
    /// What it says of its own error.
    pub estimate: Estimate,
    /// The error below which the reference knows nothing.
    pub floor: f64,
    /// Whether it counts.
    pub standing: Standing,
}

/// Whether a run counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Standing {
    /// It does.
    Counts,
    /// Two runs as accurate as one likes part: there is no error.
    Sensitive,
    /// The reference is not accurate enough to tell errors within ten tolerances.
    BelowReference,
}

impl Standing {
    /// The word for it in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Counts => "",
            Self::Sensitive => "sensitive",
            Self::BelowReference => "reference not accurate enough",
        }
    }
}

impl Judgement {
    fn new(error: f64, estimate: Estimate, floor: f64, tolerance: f64, sensitive: bool) -> Self {
        let standing = match (sensitive, floor <= MAX_FLOOR * tolerance) {
            (true, _) => Standing::Sensitive,
            (false, true) => Standing::Counts,
            (false, false) => Standing::BelowReference,
        };
        Self { scaled: None, method: String::new(), tolerance, error, estimate, floor, standing }
    }

    /// Judgements of the runs of `rows`; none of a run that failed, or without forces.
    pub(super) fn from_tolerances<'a>(
        reference: &Reference,
        rows: &'a [ToleranceRow],
    ) -> impl Iterator<Item = Self> + use<'a> {
        let (floor, sensitive) = (force_error(&reference.own).unwrap_or_default(), reference.comparison.is_of_means());
        rows.iter().filter_map(move |row| {
            let figures = row.result.as_ref().ok()?;
            let error = force_error(&figures.errors)?;
            let judgement = Self::new(error, figures.estimate?, floor, row.tolerance, sensitive);
            Some(Self { method: row.method.into(), ..judgement })
        })
    }

    /// Judgements of the scaled runs that came to their ends. Their tight runs are taken to be as accurate as their
    /// tolerances.
    pub(super) fn from_stress(stress: &Stress) -> impl Iterator<Item = Self> {
        let tolerance = stress.tolerance;
        stress.scaled.iter().filter_map(move |trial| {
            let ended = trial.outcome.as_ref().ok()?;
            let error = force_error(ended.errors.as_ref()?)?;
            let sensitive = ended.accuracy.moved().is_some();
            let judgement = Self::new(error, ended.estimate, tolerance / TIGHTER, tolerance, sensitive);
            Some(Self { scaled: trial.scaled, method: stress.method.clone(), ..judgement })
        })
    }

    /// The runs of each method, those that are scaled by themselves, in their order.
    pub fn groups<'a>(runs: impl Iterator<Item = &'a Self>) -> Vec<(String, Vec<&'a Self>)> {
        let mut groups: Vec<(String, Vec<&Self>)> = Vec::new();
        for run in runs {
            let name = format!("{}{}", run.method, if run.scaled.is_some() { ", scaled" } else { "" });
            match groups.iter_mut().find(|(own, _)| *own == name) {
                Some((_, runs)) => runs.push(run),
                None => groups.push((name, vec![run])),
            }
        }
        groups
    }

    /// What the run warns of, as tables have it.
    pub fn warning(&self) -> &'static str {
        if self.estimate.warned { "does not converge" } else { "" }
    }

    /// Whether it counts.
    pub fn counts(&self) -> bool {
        self.standing == Standing::Counts
    }

    /// The error over the tolerance asked for.
    pub fn error_over_tolerance(&self) -> f64 {
        self.error / self.tolerance
    }

    /// Nothing is known of either below the floor.
    pub fn estimate_over_error(&self) -> f64 {
        let [estimate, error] = [self.estimate.error, self.error].map(|error| error.max(self.floor));
        if estimate == error { 1.0 } else { estimate / error }
    }
}

/// The larger of the errors of F_x and F_z.
fn force_error(errors: &Errors) -> Option<f64> {
    errors[..2].iter().copied().flatten().reduce(f64::max)
}

/// A ratio of many runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ratios<'a> {
    /// The middle one.
    pub median: f64,
    /// The share of the runs that keep within ten times.
    pub within: f64,
    /// The farthest from what is asked for.
    pub worst: f64,
    /// Whose that is.
    pub of: &'a Judgement,
}

impl<'a> Ratios<'a> {
    /// Errors over tolerances, asked to be at most ten; `None` where no run counts.
    pub fn from_errors(runs: &[&'a Judgement]) -> Option<Self> {
        Self::new(runs, Judgement::error_over_tolerance, |ratio| ratio)
    }

    /// Estimates over errors, asked to be a tenth to ten; `None` where no run counts.
    pub fn from_estimates(runs: &[&'a Judgement]) -> Option<Self> {
        Self::new(runs, Judgement::estimate_over_error, |ratio| ratio.max(1.0 / ratio))
    }

    /// `distance` is how far a ratio is from what is asked for.
    fn new(runs: &[&'a Judgement], ratio: impl Fn(&Judgement) -> f64, distance: impl Fn(f64) -> f64) -> Option<Self> {
        let mut runs: Vec<(f64, &Judgement)> =
            runs.iter().filter(|run| run.counts()).map(|&run| (ratio(run), run)).collect();
        runs.sort_by(|(a, _), (b, _)| a.total_cmp(b));
        let within = runs.iter().filter(|(ratio, _)| distance(*ratio) <= KEPT).count() as f64 / runs.len() as f64;
        let &(worst, of) = runs.iter().max_by(|(a, _), (b, _)| distance(*a).total_cmp(&distance(*b)))?;
        Some(Self { median: median(&runs.iter().map(|(ratio, _)| *ratio).collect::<Vec<_>>()), within, worst, of })
    }
}

/// The middle one of values in order, of an even number of them the geometric mean of the two in the middle; there is
/// one at least.
pub(super) fn median(ordered: &[f64]) -> f64 {
    let n = ordered.len();
    (ordered[(n - 1) / 2] * ordered[n / 2]).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_median_is_the_middle_one() {
        assert_eq!(median(&[1.0, 2.0, 3.0]), 2.0);
        assert_eq!(median(&[1.0, 2.0, 8.0, 100.0]), 4.0);
    }

    #[test]
    fn sensitive_runs_and_those_below_the_reference_do_not_count() {
        let new = |error: f64, estimate: f64, floor: f64, sensitive: bool| {
            Judgement::new(error, Estimate { error: estimate, warned: false }, floor, 1e-3, sensitive)
        };
        let counts = [(0.01, 20.0, 0.0), (0.02, 0.02, 0.0), (1e-9, 1e-4, 1e-5)];
        let mut runs: Vec<Judgement> = counts.map(|(error, estimate, floor)| new(error, estimate, floor, false)).into();
        runs.push(new(7.0, 0.0, 0.0, true));
        runs.push(new(7.0, 0.0, 1e-2, false));
        assert_eq!(
            runs[3..].iter().map(|run| run.standing.name()).collect::<Vec<_>>(),
            ["sensitive", "reference not accurate enough"]
        );
        let runs: Vec<&Judgement> = runs.iter().collect();
        let errors = Ratios::from_errors(&runs).unwrap();
        assert_eq!((errors.median, errors.worst, errors.of), (10.0, 20.0, runs[1]));
        assert!((errors.within - 2.0 / 3.0).abs() < 1e-15, "{errors:?}");
        // Of the third, whose error the reference does not know, it is known to be no more than that reference's.
        let estimates = Ratios::from_estimates(&runs).unwrap();
        assert!((estimates.median - 10.0).abs() < 1e-12 && (estimates.worst - 2000.0).abs() < 1e-9, "{estimates:?}");
        assert_eq!(Ratios::from_errors(&runs[3..]), None);
    }
}
