//! The robustness of a scene: its quantities scaled by powers of ten, one by one and in pairs, and every run judged.

use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicU64, Ordering};

use crate::robustness::{
    Accuracy, Budget, DISPLACEMENT, Difference, Perturbation, RunFailure, ScaledQuantity, TIGHTER, Verdict,
    at_tolerance, exact,
};
use asperity::scene::Scene;
use cpu_time::ThreadTime;
use rayon::prelude::*;

use super::figures::{CompletedRun, Counts, Estimate};
use super::master::{MasterInputs, drive};
use super::reference::Reference;
use super::run::follow;
use super::scenes::estimated;
use super::trace::Errors;
use crate::progress::{Counter, Stopped, Watch};
use crate::runner::Rows;

/// A run is over budget where it takes so many times the steps of the scene as it is, ...
pub const BUDGET: u64 = 20;
/// ... but not with fewer steps than this.
const CHEAP: u64 = 1000;
/// The tight runs of what is scaled by itself may take so many times what those of the pairs may.
const PATIENCE: u64 = 3;
/// The powers of ten of the pairs are so many that this share of the runs is likely to be done.
const MAX_OF_THEM: f64 = 0.8;
/// What a run over budget would have taken is not known; likely so many times its budget.
const BEYOND: f64 = 2.0;
/// Communication steps of the whole run at the factor 1.
pub const COMMUNICATION_STEPS: f64 = 1000.0;
/// A run that would take more of them is shortened: ...
pub const MAX_COMMUNICATION_STEPS: f64 = 20_000.0;
/// ... in steps of the factor 1 up to its middle, then so many short ones.
pub const SHORT_STEPS: u32 = 2000;

/// All perturbed runs of a scene.
#[derive(Debug)]
pub struct Robustness {
    /// What the scene has of what is scaled.
    pub quantities: Vec<ScaledQuantity>,
    /// Powers of ten each way.
    pub powers: i32,
    /// Every so many of them in pairs.
    pub stride: i32,
    /// The relative tolerance of the runs.
    pub tolerance: f64,
    /// The most steps of a run.
    budget: u64,
    /// The largest power of the communication step that makes a difference: one step for each phase.
    longest: i32,
    trials: BTreeMap<Perturbation, Trial>,
}

/// One perturbed run.
#[derive(Clone, Debug, PartialEq)]
pub struct Trial {
    outcome: TrialOutcome,
    /// Processor time, its tight runs included, s.
    cost: f64,
}

#[derive(Clone, Debug, PartialEq)]
enum TrialOutcome {
    Ended(Box<EndedTrial>),
    Failed(RunFailure),
    NotTried,
}

/// A perturbed run that came to its end.
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

impl Trial {
    const NOT_TRIED: Self = Self { outcome: TrialOutcome::NotTried, cost: 0.0 };

    /// `None` where it did not come to its end.
    pub fn ended(&self) -> Option<&EndedTrial> {
        match &self.outcome {
            TrialOutcome::Ended(ended) => Some(ended),
            _ => None,
        }
    }

    /// What it took; `None` where it did not come to its end.
    pub fn counts(&self) -> Option<&Counts> {
        self.ended().map(|ended| &ended.counts)
    }
}

impl Robustness {
    /// Runs the scene of `reference` scaled by so many powers of ten each way; the pairs may take about `seconds`.
    pub(super) fn run(
        reference: &Reference,
        powers: u32,
        points: u32,
        seconds: f64,
        watch: &Watch<'_>,
    ) -> Result<Self, Stopped> {
        let scene = &reference.scene;
        let unlimited = PerturbedRunner { scene, points, budget: scene.solver.max_steps(), patience: PATIENCE };
        let unperturbed = unlimited.run(Perturbation::default());
        let work = unperturbed.counts().unwrap_or(&reference.measured.counts).work();
        let budget = BUDGET * work.max(CHEAP / BUDGET);
        let mut all = Self {
            quantities: ScaledQuantity::all_of(scene),
            powers: powers as i32,
            stride: 0,
            tolerance: scene.solver.relative_tolerance,
            budget,
            longest: longest(scene),
            trials: BTreeMap::from([(Perturbation::default(), unperturbed)]),
        };
        let runner = PerturbedRunner { budget, ..unlimited };
        let singles = all.missing(all.quantities.iter().flat_map(|&quantity| all.line(quantity)));
        all.run_all(runner, singles, f64::INFINITY, "robustness, one by one", watch)?;
        all.run_pairs(PerturbedRunner { patience: 1, ..runner }, seconds, watch)?;
        Ok(all)
    }

    /// The run with this perturbation; `NOT_TRIED` where it was not planned.
    pub fn trial(&self, perturbation: Perturbation) -> &Trial {
        self.trials.get(&self.same(perturbation)).unwrap_or(&Trial::NOT_TRIED)
    }

    /// The run of the scene as it is.
    pub fn unperturbed(&self) -> &Trial {
        self.trial(Perturbation::default())
    }

    /// All runs.
    pub fn trials(&self) -> impl Iterator<Item = (&Perturbation, &Trial)> {
        self.trials.iter()
    }

    /// What became of a run.
    pub fn verdict(&self, trial: &Trial) -> Verdict {
        match &trial.outcome {
            TrialOutcome::Ended(ended) => ended.accuracy.verdict(self.tolerance),
            TrialOutcome::Failed(failure) => failure.into(),
            TrialOutcome::NotTried => Verdict::NotTried,
        }
    }

    /// The steps of a run, rejected ones included, over those of the scene as it is and one for each communication
    /// step.
    pub fn times_the_steps(&self, trial: &Trial) -> Option<f64> {
        let ended = trial.ended()?;
        let due = self.unperturbed().counts()?.work() + ended.communication_steps;
        Some(ended.counts.work() as f64 / due as f64)
    }

    /// The outcome of a run in words.
    pub fn reason(&self, trial: &Trial) -> String {
        match &trial.outcome {
            TrialOutcome::Ended(ended) => match &ended.accuracy {
                Accuracy::Error(error) => self.error(error),
                Accuracy::Sensitive { error, moved } => {
                    let error = self.error(error);
                    format!("sensitive: {error}, but a start moved by {DISPLACEMENT:e} m changes {moved:.1e}")
                }
                Accuracy::Unknown(reason) => format!("no tight run to compare with: {reason}"),
            },
            TrialOutcome::Failed(RunFailure::Stopped(reason)) => reason.clone(),
            TrialOutcome::Failed(RunFailure::OverBudget { time }) => {
                format!("more than {} steps, used up at t = {time:.3e} s", self.budget)
            }
            TrialOutcome::NotTried => "not tried: not enough time".into(),
        }
    }

    fn error(&self, error: &Difference) -> String {
        let Difference { share, of, time } = error;
        let times = two_digits(share / self.tolerance);
        format!("error {share:.1e} of {} at t = {time:.3e} s, {times} times the tolerance", of.force_name())
    }

    /// The powers of ten, every so many.
    pub fn powers(&self, stride: i32) -> impl Iterator<Item = i32> + use<> {
        let most = self.powers / stride;
        (-most..=most).map(move |step| step * stride)
    }

    /// The perturbation that has the same run: a communication step longer than every phase is as long as the phases.
    fn same(&self, perturbation: Perturbation) -> Perturbation {
        match perturbation.power(ScaledQuantity::CommunicationStep) {
            Some(power) if power > self.longest => perturbation.with(ScaledQuantity::CommunicationStep, self.longest),
            _ => perturbation,
        }
    }

    /// One quantity scaled by all powers.
    fn line(&self, quantity: ScaledQuantity) -> impl Iterator<Item = Perturbation> {
        self.powers(1).map(move |power| Perturbation::default().with(quantity, power))
    }

    /// All pairs at every so many powers.
    fn pairs(&self, stride: i32) -> Vec<Perturbation> {
        let pairs = self.quantities.iter().enumerate();
        let pairs = pairs.flat_map(|(i, &a)| self.quantities[i + 1..].iter().map(move |&b| (a, b)));
        let grid = pairs.flat_map(|(a, b)| {
            let row = move |power| {
                self.powers(stride).map(move |other| Perturbation::default().with(a, power).with(b, other))
            };
            self.powers(stride).flat_map(row)
        });
        self.missing(grid)
    }

    /// Those that are not run yet, each once.
    fn missing(&self, perturbations: impl Iterator<Item = Perturbation>) -> Vec<Perturbation> {
        let mut missing: Vec<Perturbation> = perturbations.map(|perturbation| self.same(perturbation)).collect();
        missing.sort_unstable();
        missing.dedup();
        missing.retain(|perturbation| !self.trials.contains_key(perturbation));
        missing
    }

    /// Runs the pairs, the cheap ones first, at as many powers as there is time for.
    fn run_pairs(&mut self, runner: PerturbedRunner<'_>, seconds: f64, watch: &Watch<'_>) -> Result<(), Stopped> {
        let time = seconds * rayon::current_num_threads() as f64;
        let strides: Vec<i32> = (1..=self.powers).filter(|stride| self.powers % stride == 0).collect();
        let fits = |stride: i32| {
            let pairs = self.cheap_first(stride);
            let spent = pairs.iter().scan(0.0, |spent, &pair| {
                *spent += self.expected_cost(pair);
                Some(*spent)
            });
            spent.filter(|&spent| spent <= time).count() as f64 >= MAX_OF_THEM * pairs.len() as f64
        };
        self.stride = strides.iter().copied().find(|&stride| fits(stride)).unwrap_or(self.powers);
        self.run_all(runner, self.cheap_first(self.stride), time, "robustness, in pairs", watch)
    }

    /// All pairs, those first that are likely to be cheap.
    fn cheap_first(&self, stride: i32) -> Vec<Perturbation> {
        let mut pairs = self.pairs(stride);
        pairs.sort_by(|&a, &b| self.expected_cost(a).total_cmp(&self.expected_cost(b)));
        pairs
    }

    /// Does the runs until they have taken `time` (s).
    fn run_all(
        &mut self,
        runner: PerturbedRunner<'_>,
        runs: Vec<Perturbation>,
        time: f64,
        part: &str,
        watch: &Watch<'_>,
    ) -> Result<(), Stopped> {
        let counter = Counter::new(watch, part, runs.len());
        // Of all threads together, ns.
        let spent = AtomicU64::new(0);
        let run = |perturbation: Perturbation| {
            let in_time = 1e-9 * (spent.load(Ordering::Relaxed) as f64) < time;
            let trial = if in_time { runner.run(perturbation) } else { Trial::NOT_TRIED };
            spent.fetch_add((1e9 * trial.cost) as u64, Ordering::Relaxed);
            counter.step().map(|()| (perturbation, trial))
        };
        // In their order: the first are to be run before time is up.
        let trials: Vec<(Perturbation, Trial)> = runs.into_iter().par_bridge().map(run).collect::<Result<_, _>>()?;
        self.trials.extend(trials);
        Ok(())
    }

    /// What a run is likely to take, s: what the quantities do one by one, together.
    fn expected_cost(&self, perturbation: Perturbation) -> f64 {
        let base = self.unperturbed().cost;
        let alone = |quantity: ScaledQuantity| {
            let power = perturbation.power(quantity)?;
            let trial = self.trials.get(&self.same(Perturbation::default().with(quantity, power)))?;
            let over = matches!(trial.outcome, TrialOutcome::Failed(RunFailure::OverBudget { .. }));
            Some(if over { BEYOND } else { 1.0 } * trial.cost / base)
        };
        base * self.quantities.iter().filter_map(|&quantity| alone(quantity)).product::<f64>()
    }
}

/// The power of ten from which on a communication step takes a whole phase.
fn longest(scene: &Scene) -> i32 {
    let phase = scene.excitation.iter().map(|phase| phase.duration).fold(0.0, f64::max);
    (phase * COMMUNICATION_STEPS / scene.duration()).log10().ceil() as i32
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
struct PerturbedRunner<'a> {
    /// Without perturbation; no force ends its phases.
    scene: &'a Scene,
    /// Rows of a phase.
    points: u32,
    /// The most steps of a run, beside those that a master's communication steps need.
    budget: u64,
    /// How many times the budget the tight run may take.
    patience: u64,
}

impl PerturbedRunner<'_> {
    fn run(&self, perturbation: Perturbation) -> Trial {
        let clock = ThreadTime::now();
        let outcome = match perturbation.apply(self.scene) {
            Ok(scene) => self.outcome(&scene, perturbation.factor(ScaledQuantity::CommunicationStep)),
            Err(refused) => TrialOutcome::Failed(RunFailure::Stopped(refused.to_string())),
        };
        Trial { outcome, cost: clock.elapsed().as_secs_f64() }
    }

    /// The run of a perturbed scene, by a master where there is a factor of the communication step.
    fn outcome(&self, scene: &Scene, communication: Option<f64>) -> TrialOutcome {
        let points = communication.map(|factor| communication_points(scene, factor));
        let communication_steps = points.iter().flatten().map(|points| points.len() as u64).sum();
        let along = |scene: &Scene, u: f64, budget: Budget| match &points {
            None => follow(scene, Rows::PerPhase(self.points), u, budget, &|_| ControlFlow::Continue(())),
            Some(points) => drive(scene, MasterInputs::Rates, points, u, budget, &|_| ControlFlow::Continue(())),
        };
        let budget = self.budget.saturating_add(2 * communication_steps);
        match along(&estimated(scene), 0.0, Budget(budget)) {
            Err(failure) => TrialOutcome::Failed(failure),
            Ok(run) => {
                let (accuracy, errors) = accuracy(scene, &run, Budget(self.patience.saturating_mul(budget)), along);
                let (counts, estimate) = (run.counts, run.estimate);
                TrialOutcome::Ended(Box::new(EndedTrial { counts, communication_steps, accuracy, errors, estimate }))
            }
        }
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
