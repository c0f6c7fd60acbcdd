//! A scene under stress: its quantities scaled by powers of ten, one by one, and every run judged.

use std::ops::ControlFlow;

use asperity::scene::{Parameter, Scene};
use rayon::prelude::*;

use super::communication::{MasterInputs, drive};
use super::reference::Reference;
use super::run::{CompletedRun, Counts, Estimate, estimated, follow};
use super::trace::Errors;
use crate::progress::{Counter, Stopped, Watch};
use crate::robustness::{
    Accuracy, Budget, DISPLACEMENT, Difference, Perturbation, RunFailure, ScaledQuantity, TIGHTER, Verdict,
    at_tolerance, exact,
};
use crate::runner::Rows;

/// A run is over budget where it takes so many times the steps of the scene as it is, ...
const BUDGET: u64 = 20;
/// ... but not with fewer steps than this.
const CHEAP: u64 = 1000;
/// The tight runs may take so many times what the runs may.
const PATIENCE: u64 = 3;
/// Communication steps of the whole run at the factor 1.
const COMMUNICATION_STEPS: f64 = 1000.0;
/// A run that would take more of them is shortened: ...
const MAX_COMMUNICATION_STEPS: f64 = 20_000.0;
/// ... in steps of the factor 1 up to its middle, then so many short ones.
const SHORT_STEPS: u32 = 2000;

/// All runs of a scene whose quantities are scaled one by one, each all else as it is. Stiffness is that of every spring,
/// those of Maxwell elements too; at another speed the carrier follows the same path in another time; the communication
/// step is that of a master who gives values and rates, and there is none otherwise.
#[derive(Debug)]
pub struct Stress {
    /// The method of the runs.
    pub method: String,
    /// Their relative tolerance.
    pub tolerance: f64,
    /// The most steps of a run.
    budget: u64,
    /// The run of the scene as it is.
    pub unscaled: Trial,
    /// The others, by quantity and power.
    pub scaled: Vec<Trial>,
}

/// A run of the scene, perhaps with a quantity scaled.
#[derive(Clone, Debug, PartialEq)]
pub struct Trial {
    /// What is scaled, by this power of ten.
    pub scaled: Option<(ScaledQuantity, i32)>,
    /// What became of it.
    pub outcome: Result<EndedTrial, RunFailure>,
}

/// A run that came to its end.
#[derive(Clone, Debug, PartialEq)]
pub struct EndedTrial {
    /// What it took.
    pub counts: Counts,
    /// Each takes a step at least.
    communication_steps: u64,
    /// How accurate it is.
    pub accuracy: Accuracy,
    /// Each over the largest value of its quantity, against the tight run, if there is one.
    pub errors: Option<Errors>,
    /// What the run says of its own error.
    pub estimate: Estimate,
}

impl Stress {
    /// Runs the scene of `reference` scaled by so many powers of ten each way.
    pub(super) fn run(reference: &Reference, powers: u32, points: u32, watch: &Watch<'_>) -> Result<Self, Stopped> {
        let scene = &reference.scene;
        let method = scene.parameter(Parameter::METHOD).to_string().replace('"', "");
        let unlimited = TrialRunner { scene, points, budget: scene.solver.max_steps() };
        let unscaled = unlimited.run(None);
        let work = unscaled.outcome.as_ref().map_or(&reference.measured.counts, |ended| &ended.counts).work();
        let budget = BUDGET * work.max(CHEAP / BUDGET);
        let runner = TrialRunner { budget, ..unlimited };
        let planned = planned(scene, powers as i32);
        let counter = Counter::new(watch, "stress", planned.len());
        let run = |scaled| {
            let trial = runner.run(Some(scaled));
            counter.step().map(|()| trial)
        };
        let scaled = planned.into_par_iter().map(run).collect::<Result<_, _>>()?;
        Ok(Self { method, tolerance: scene.solver.relative_tolerance, budget, unscaled, scaled })
    }

    /// The quantities that are scaled.
    pub fn quantities(&self) -> Vec<ScaledQuantity> {
        let mut all: Vec<ScaledQuantity> = self.scaled.iter().filter_map(|trial| Some(trial.scaled?.0)).collect();
        all.dedup();
        all
    }

    /// The runs with one quantity scaled, by rising powers of ten; that of the scene as it is among them.
    pub fn of(&self, quantity: ScaledQuantity) -> Vec<(i32, &Trial)> {
        let power = |trial: &Trial| trial.scaled.filter(|(own, _)| *own == quantity).map(|(_, power)| power);
        let mut all: Vec<(i32, &Trial)> = self.scaled.iter().filter_map(|trial| Some((power(trial)?, trial))).collect();
        if all.iter().all(|(power, _)| *power != 0) {
            all.push((0, &self.unscaled));
            all.sort_by_key(|(power, _)| *power);
        }
        all
    }

    /// What became of a run.
    pub fn verdict(&self, trial: &Trial) -> Verdict {
        trial.outcome.as_ref().map_or_else(Verdict::from, |ended| ended.accuracy.verdict(self.tolerance))
    }

    /// The steps of a run, rejected ones included, over those of the scene as it is and one for each communication
    /// step.
    pub fn times_the_steps(&self, trial: &Trial) -> Option<f64> {
        let ended = trial.outcome.as_ref().ok()?;
        let due = self.unscaled.outcome.as_ref().ok()?.counts.work() + ended.communication_steps;
        Some(ended.counts.work() as f64 / due as f64)
    }

    /// The outcome of a run in words.
    pub fn reason(&self, trial: &Trial) -> String {
        match &trial.outcome {
            Ok(ended) => match &ended.accuracy {
                Accuracy::Error(error) => self.error(error),
                Accuracy::Sensitive { error, moved } => {
                    let error = self.error(error);
                    format!("sensitive: {error}, but a start moved by {DISPLACEMENT:e} m changes {moved:.1e}")
                }
                Accuracy::Unknown(reason) => format!("no tight run to compare with: {reason}"),
            },
            Err(RunFailure::Stopped(reason)) => reason.clone(),
            Err(RunFailure::OverBudget { time }) => {
                format!("more than {} steps, used up at t = {time:.3e} s", self.budget)
            }
        }
    }

    fn error(&self, error: &Difference) -> String {
        let Difference { share, of, time } = error;
        let times = two_digits(share / self.tolerance);
        format!("error {share:.1e} of {} at t = {time:.3e} s, {times} times the tolerance", of.force_name())
    }
}

/// What is scaled and by which powers of ten. A communication step longer than every phase is as long as the phases: a
/// longer one makes no difference.
fn planned(scene: &Scene, powers: i32) -> Vec<(ScaledQuantity, i32)> {
    let phase = scene.excitation.iter().map(|phase| phase.duration).fold(0.0, f64::max);
    let longest = (phase * COMMUNICATION_STEPS / scene.duration()).log10().ceil() as i32;
    let is_run = |(quantity, power): &(ScaledQuantity, i32)| match quantity {
        ScaledQuantity::CommunicationStep => *power <= longest,
        _ => *power != 0,
    };
    let quantities = ScaledQuantity::all_of(scene).into_iter();
    quantities.flat_map(|quantity| (-powers..=powers).map(move |power| (quantity, power))).filter(is_run).collect()
}

/// Two digits, as far as the number has so few.
fn two_digits(value: f64) -> String {
    match value {
        value if value >= 1e4 => format!("{value:.1e}"),
        value if value >= 9.95 => format!("{value:.0}"),
        value if value >= 0.095 || value == 0.0 => format!("{value:.1}"),
        _ => format!("{value:.0e}"),
    }
}

#[derive(Clone, Copy, Debug)]
struct TrialRunner<'a> {
    /// As it is; no force ends its phases.
    scene: &'a Scene,
    /// Rows of a phase.
    points: u32,
    /// The most steps of a run, beside those that a master's communication steps need.
    budget: u64,
}

impl TrialRunner<'_> {
    fn run(&self, scaled: Option<(ScaledQuantity, i32)>) -> Trial {
        let perturbation = Perturbation::default();
        let perturbation = scaled.map_or(perturbation, |(quantity, power)| perturbation.with(quantity, power));
        let outcome = match perturbation.apply(self.scene) {
            Ok(scene) => self.outcome(&scene, perturbation.factor(ScaledQuantity::CommunicationStep)),
            Err(refused) => Err(RunFailure::Stopped(refused.to_string())),
        };
        Trial { scaled, outcome }
    }

    /// The run of a scaled scene, by a master where there is a factor of the communication step.
    fn outcome(&self, scene: &Scene, communication: Option<f64>) -> Result<EndedTrial, RunFailure> {
        let points = communication.map(|factor| communication_points(scene, factor));
        let communication_steps = points.iter().flatten().map(|points| points.len() as u64).sum();
        let along = |scene: &Scene, u: f64, budget: Budget| match &points {
            None => follow(scene, Rows::PerPhase(self.points), u, budget, &|_| ControlFlow::Continue(())),
            Some(points) => drive(scene, MasterInputs::Rates, points, u, budget, &|_| ControlFlow::Continue(())),
        };
        let budget = self.budget.saturating_add(2 * communication_steps);
        let run = along(&estimated(scene), 0.0, Budget(budget))?;
        let (accuracy, errors) = accuracy(scene, &run, Budget(PATIENCE.saturating_mul(budget)), along);
        Ok(EndedTrial { counts: run.counts, communication_steps, accuracy, errors, estimate: run.estimate })
    }
}

/// Compares a run with a tight one; with the errors, if that comes to its end.
fn accuracy(
    scene: &Scene,
    run: &CompletedRun,
    budget: Budget,
    along: impl Fn(&Scene, f64, Budget) -> Result<CompletedRun, RunFailure>,
) -> (Accuracy, Option<Errors>) {
    let tight_scene = exact(&at_tolerance(scene, scene.solver.relative_tolerance / TIGHTER));
    let tight = match along(&tight_scene, 0.0, budget) {
        Ok(tight) => tight.trace,
        Err(RunFailure::Stopped(reason)) => return (Accuracy::Unknown(reason), None),
        Err(RunFailure::OverBudget { .. }) => {
            return (Accuracy::Unknown(format!("more than {} steps", budget.0)), None);
        }
    };
    let moved = || along(&tight_scene, DISPLACEMENT, budget).ok().map(|moved| moved.trace.forces());
    let accuracy = Accuracy::judge(scene, &run.trace.forces(), &tight.forces(), moved);
    (accuracy, Some(run.trace.largest(&tight)))
}

/// The communication points of a master in the phases that are run, s after each begins; `factor` scales the
/// communication step. The end of a phase is one of them, unless the run ends before it.
fn communication_points(scene: &Scene, factor: f64) -> Vec<Vec<f64>> {
    let base = scene.duration() / COMMUNICATION_STEPS;
    if COMMUNICATION_STEPS / factor <= MAX_COMMUNICATION_STEPS {
        return scene.excitation.iter().map(|phase| even_points(base * factor, phase.duration)).collect();
    }
    let phases = scene.excitation.iter().enumerate();
    let longest = phases.clone().max_by(|(_, a), (_, b)| a.duration.total_cmp(&b.duration)).map_or(0, |(i, _)| i);
    let short = |duration: f64| short_points(base, base * factor, duration);
    let points = |i: usize, duration: f64| if i < longest { even_points(base, duration) } else { short(duration) };
    phases.take(longest + 1).map(|(i, phase)| points(i, phase.duration)).collect()
}

fn even_points(longest: f64, duration: f64) -> Vec<f64> {
    Rows::Within { longest, parts: 1 }.times(duration).collect()
}

/// Steps of `base` up to the middle of a phase, then short ones, s.
fn short_points(base: f64, short: f64, duration: f64) -> Vec<f64> {
    let middle = 0.5 * duration;
    let short = (1..=SHORT_STEPS).map(|j| middle + f64::from(j) * short);
    even_points(base, middle).into_iter().chain(short.take_while(|&point| point <= duration)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_master_steps_evenly_through_each_phase() {
        assert_eq!(even_points(0.25, 1.0), [0.25, 0.5, 0.75, 1.0]);
        assert_eq!(even_points(1e6, 1.0), [1.0]);
    }

    #[test]
    fn many_steps_are_short_ones_from_the_middle_on() {
        let points = short_points(0.125, 1e-6, 0.5);
        assert_eq!(points[..3], [0.125, 0.25, 0.25 + 1e-6]);
        assert_eq!(points.len(), 2 + SHORT_STEPS as usize);
        // A short phase ends before all of them.
        let points = short_points(0.125, 1e-6, 1e-3);
        assert!(points.len() == 501 && points.iter().all(|&point| point <= 1e-3), "{}", points.len());
    }
}
