//! Judges the runs of a case: method against method, and both against a tight run.

use asperity::scene::Axis;
use asperity_study::robustness::{Accuracy, KEPT, Perturbation, ScaledQuantity, Verdict};

use crate::catalogue::{Case, number};
use crate::fmu::by_fmu;
use crate::rules::{ENERGY, Finding, energy_scale};
use crate::run::{Outcome, Stop, by_library, by_library_scaled};

/// Which run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Way {
    Event,
    Step,
    EventFmu,
    StepFmu,
}

impl Way {
    pub fn name(self) -> &'static str {
        match self {
            Self::Event => "event",
            Self::Step => "step",
            Self::EventFmu => "event, FMU",
            Self::StepFmu => "step, FMU",
        }
    }

    fn method(self) -> &'static str {
        if matches!(self, Self::Event | Self::EventFmu) { "event" } else { "step" }
    }

    pub fn is_fmu(self) -> bool {
        matches!(self, Self::EventFmu | Self::StepFmu)
    }

    fn run(self, case: &Case, tight: f64) -> Outcome {
        if self.is_fmu() { by_fmu(case, self.method(), tight) } else { by_library(case, self.method(), tight) }
    }
}

/// A run, judged.
#[derive(Clone, Debug)]
pub struct Judged {
    pub case: String,
    pub phrase: String,
    pub item: String,
    pub way: Way,
    pub error: Option<Stop>,
    /// Why the error is right, where it is.
    pub reason: String,
    pub findings: Vec<Finding>,
    pub steps: f64,
    pub events: f64,
    pub rejected: f64,
    /// The largest residual of the energies over the largest energy.
    pub residual: f64,
    /// As `asperity report` gives it; `None` where there is no tight run.
    pub verdict: Option<Verdict>,
    /// Of the worse of F_x and F_z, each over its largest value: `solver.error`.
    pub forces: Estimate,
    /// The relative tolerance.
    pub tolerance: f64,
    /// The largest change of F_x or F_z, each over its largest value, where the scene's numbers change by the tolerance; 0 where
    /// the error of the forces is kept and the change not known.
    pub conditioning: f64,
    /// Of E_diss: `solver.error_E_diss`.
    pub losses: Estimate,
    /// Processor time, s.
    pub time: f64,
}

/// A run's own estimate of an error beside the true one.
#[derive(Clone, Copy, Debug)]
pub struct Estimate {
    /// The variable of the estimate.
    pub name: &'static str,
    /// Against the tight run, over the largest value; NaN where there is no tight run.
    pub true_error: f64,
    /// At the end.
    pub estimate: f64,
    /// The error below which nothing is known of it: roundings, and the absolute tolerance as a force over the largest
    /// value.
    pub floor: f64,
}

impl Estimate {
    /// Estimated over true error. Below the floor nothing is known of either: forces are sums with roundings, and the
    /// positions of the tight run too are right within an absolute tolerance, which is a force.
    pub fn ratio(&self) -> f64 {
        let [estimate, right] = [self.estimate, self.true_error].map(|error| error.max(self.floor));
        if estimate == right { 1.0 } else { estimate / right }
    }

    /// The estimate is below the true error by more than it may ever be.
    fn underestimate(&self) -> Option<Finding> {
        let text = format!("{} is {:.1e}, the error {:.1e}", self.name, self.estimate, self.true_error);
        (self.ratio() < 1.0 / BELOW).then_some(Finding { rule: "estimate", text })
    }
}

impl Judged {
    /// Whether the errors of its forces over the tolerance are to be counted: a run of the library that has a tight one beside
    /// it and is not sensitive.
    pub fn has_force_error(&self) -> bool {
        !self.way.is_fmu() && self.forces.true_error.is_finite() && self.verdict != Some(Verdict::Sensitive)
    }

    /// Whether the forces are known within ten times the tolerance.
    pub fn keeps_forces(&self) -> bool {
        self.forces.true_error <= KEPT * self.tolerance
    }

    /// A run that panicked.
    pub fn panicked(case: &Case, text: String) -> Self {
        let stop = Stop { name: "panic", text: text.clone() };
        let run = Outcome { error: Some(stop), ..Outcome::default() };
        let mut judged = judge_run(case, Way::Event, run, Way::Event, &Outcome::default());
        judged.findings = vec![Finding { rule: "panic", text }];
        judged
    }
}

/// All runs of a case.
pub fn judge(case: &Case) -> Vec<Judged> {
    let mut ways = Vec::new();
    if case.script.is_none() {
        ways.extend([Way::Event, Way::Step]);
    }
    if case.script.is_some() || case.fmu_steps.is_some() {
        ways.extend([Way::EventFmu, Way::StepFmu]);
    }
    let mut outcomes: Vec<(Way, Outcome)> = ways.into_iter().map(|way| (way, way.run(case, 1.0))).collect();
    for pair in outcomes.chunks_mut(2) {
        let found = disagreement(case, &pair[0].1, &pair[1].1);
        pair[1].1.findings.extend(found.map(|text| Finding { rule: "agreement", text }));
    }
    let (straight, first) = &outcomes[0];
    let straight = *straight;
    // Where the run stops, a tight one does.
    let tight = if first.error.is_some() { Outcome::default() } else { straight.run(case, case.tight) };
    let mut judged: Vec<Judged> =
        outcomes.into_iter().map(|(way, outcome)| judge_run(case, way, outcome, straight, &tight)).collect();
    if judged.iter().any(|run| run.has_force_error() && !run.keeps_forces()) {
        let conditioning = conditioning(case, &tight);
        judged.iter_mut().for_each(|run| run.conditioning = conditioning);
    }
    judged
}

/// The change of the worse of F_x and F_z, each over its largest value, where all stiffnesses and masses, or the speed, change
/// by the relative tolerance. No run on numbers that are known within the tolerance is known better.
fn conditioning(case: &Case, tight: &Outcome) -> f64 {
    let factor = 1.0 + relative_tolerance(case);
    let changed = [&[ScaledQuantity::Stiffness, ScaledQuantity::Mass][..], &[ScaledQuantity::Speed]];
    let change = |quantities: &[ScaledQuantity]| {
        let run = by_library_scaled(case, Way::Event.method(), case.tight, (quantities, factor));
        if run.error.is_some() { 0.0 } else { worse_force(&run, Some(tight)).true_error }
    };
    changed.into_iter().map(change).fold(0.0, f64::max)
}

/// Judges one run by the tight one, which was run the way `straight`.
fn judge_run(case: &Case, way: Way, mut outcome: Outcome, straight: Way, tight: &Outcome) -> Judged {
    let expected = if way.method() == "event" { &case.ends.event } else { &case.ends.step };
    match (&outcome.error, expected) {
        (Some(error), Some(expected)) if error.name == expected => {}
        (Some(error), _) => outcome.findings.push(Finding { rule: "ends", text: error.text.clone() }),
        (None, Some(expected)) => {
            outcome.findings.push(Finding { rule: "error", text: format!("runs to its end without {expected}") });
        }
        (None, None) => {}
    }
    if case.free_of_work && !outcome.rows.is_empty() {
        outcome.findings.extend(energy_grows(case, &outcome));
    }
    let stopped = outcome.error.is_some() || tight.error.is_some() || tight.rows.is_empty();
    let comparable = way.is_fmu() == straight.is_fmu() && !stopped;
    let tight_run = comparable.then_some(tight);
    let (forces, losses) = (worse_force(&outcome, tight_run), losses(&outcome, tight_run));
    outcome.findings.extend(false_alarm(case, outcome.warns, &forces));
    if way == straight && tight.error.is_some() && outcome.error.is_none() {
        let text = tight.error.as_ref().map_or("", |error| error.text.as_str());
        outcome.findings.push(Finding { rule: "tight", text: format!("the tight run: {text}") });
    }
    let accuracy = comparable.then(|| accuracy(case, &outcome, tight));
    outcome.findings.extend(accuracy.as_ref().and_then(|accuracy| wrong(case, accuracy)));
    let scale = energy_scale(&outcome).max(f64::MIN_POSITIVE);
    let mut judged = Judged {
        case: case.name.clone(),
        phrase: case.phrase.clone(),
        item: case.item.clone(),
        way,
        verdict: accuracy.map(|accuracy| accuracy.verdict(relative_tolerance(case))),
        forces,
        tolerance: relative_tolerance(case),
        conditioning: 0.0,
        losses,
        steps: outcome.last("solver.steps"),
        events: outcome.last("solver.events"),
        rejected: outcome.last("solver.rejected"),
        residual: outcome.largest("energy.residual") / scale,
        time: outcome.last("solver.run_time"),
        reason: outcome.error.as_ref().map_or_else(String::new, |_| case.ends.reason.clone()),
        error: outcome.error,
        findings: outcome.findings,
    };
    if !way.is_fmu() {
        judged.findings.extend([judged.forces, judged.losses].iter().filter_map(Estimate::underestimate));
    }
    judged
}

/// Whether a motion is sensitive, the catalogue says.
fn accuracy(case: &Case, outcome: &Outcome, tight: &Outcome) -> Accuracy {
    let error = outcome.forces().difference(&tight.forces(), &Axis::ALL);
    if case.sensitive.is_some() { Accuracy::Sensitive { error, moved: error.share } } else { Accuracy::Error(error) }
}

/// Perturbed runs keep their tolerance; other extremes are accepted where their estimate shows the error.
fn wrong(case: &Case, accuracy: &Accuracy) -> Option<Finding> {
    let kept = accuracy.verdict(relative_tolerance(case)) == Verdict::Kept;
    let found = case.perturbation != Perturbation::default() && !kept;
    found.then(|| Finding { rule: "accuracy", text: format!("{accuracy:?}") })
}

/// A run that keeps its tolerance converges.
fn false_alarm(case: &Case, warns: bool, forces: &Estimate) -> Option<Finding> {
    let found = warns && forces.true_error <= KEPT * relative_tolerance(case);
    let text = format!("warns that it does not converge, with an error of {:.1e}", forces.true_error);
    found.then_some(Finding { rule: "warning", text })
}

/// Of the force with the larger error over its largest value, as `solver.error` means it.
fn worse_force(outcome: &Outcome, tight: Option<&Outcome>) -> Estimate {
    let largest = |force: Axis| tight.map_or(0.0, |tight| tight.largest(force.force_name()));
    let rounding = ROUNDING * largest(Axis::X).max(largest(Axis::Z));
    let of = |force: Axis| Estimate {
        name: "solver.error",
        true_error: tight.map_or(f64::NAN, |tight| relative_error(outcome, tight, force.force_name(), rounding)),
        estimate: outcome.last("solver.error"),
        floor: floor(outcome.known, largest(force)),
    };
    let [x, z] = Axis::ALL.map(of);
    if x.true_error > z.true_error { x } else { z }
}

/// Of E_diss. What the absolute tolerance allows is a force on every mass along the carrier's path; roundings are those
/// of the largest energy.
fn losses(outcome: &Outcome, tight: Option<&Outcome>) -> Estimate {
    let largest = tight.map_or(0.0, |tight| tight.largest("E_diss"));
    let rounding = tight.map_or(0.0, |tight| FLOOR * energy_scale(tight));
    Estimate {
        name: "solver.error_E_diss",
        true_error: tight.map_or(f64::NAN, |tight| relative_error(outcome, tight, "E_diss", 0.0)),
        estimate: outcome.last("solver.error_E_diss"),
        floor: floor(outcome.known * outcome.masses * outcome.path + rounding, largest),
    }
}

/// The largest difference over the largest value, 0 up to `rounding`; the difference itself where there is no value.
fn relative_error(outcome: &Outcome, tight: &Outcome, name: &str, rounding: f64) -> f64 {
    let (largest, difference) = (tight.largest(name), largest_difference(outcome, tight, name));
    match (difference > rounding, largest > 0.0) {
        (false, _) => 0.0,
        (true, false) => difference,
        (true, true) => difference / largest,
    }
}

/// Below this share of the larger force, differences of the other one are roundings.
const ROUNDING: f64 = 1e-13;
/// No estimate is below the true error by more than this factor: the worst was 63.
const BELOW: f64 = 100.0;
/// How many times their estimates two methods may differ: each is to be within a factor of ten of the truth.
const OF_ESTIMATES: f64 = 10.0;
/// Below this share of the largest force, differences are roundings.
const FLOOR: f64 = 1e-9;
/// The means and losses of a sensitive motion may differ by this share of the largest.
const SENSITIVE: f64 = 0.1;

/// What a quantity that is known within `known` is at least in error, over the largest.
fn floor(known: f64, largest: f64) -> f64 {
    if known > 0.0 { FLOOR + known / largest } else { FLOOR }
}

/// Where event-driven and time-stepping runs differ by more than their estimates allow.
fn disagreement(case: &Case, event: &Outcome, step: &Outcome) -> Option<String> {
    if event.error.is_some() || step.error.is_some() {
        return None;
    }
    if case.sensitive.is_some() {
        return sensitive_disagreement(event, step);
    }
    let [one, other] = [event, step].map(|outcome| outcome.last("solver.error"));
    // The force of every mass is known within the tolerance alone, the absolute one or that of the larger force.
    let larger = event.largest("F_x").max(event.largest("F_z"));
    let known = event.known * event.masses + relative_tolerance(case) * larger;
    let of = |force: Axis| {
        let largest = event.largest(force.force_name()).max(step.largest(force.force_name()));
        let difference = largest_difference(step, event, force.force_name());
        let allowed = (OF_ESTIMATES * (one + other) + FLOOR) * largest + known;
        (difference > allowed).then(|| {
            let (name, share) = (force.force_name(), difference / largest);
            format!("{name} differs by {share:.1e} of {largest:.1e} N, estimates {one:.1e} and {other:.1e}")
        })
    };
    of(Axis::Z).or_else(|| of(Axis::X))
}

/// The largest difference of a column between two runs.
fn largest_difference(one: &Outcome, other: &Outcome, name: &str) -> f64 {
    let (one, other) = (one.column(name), other.column(name));
    one.iter().zip(&other).map(|(one, other)| (one - other).abs()).fold(0.0, f64::max)
}

/// Means are of the rows: where these show instants alone, what is a mean of one draw of a sensitive motion is known as
/// that draw is, within the estimates.
fn sensitive_disagreement(event: &Outcome, step: &Outcome) -> Option<String> {
    let mean = |outcome: &Outcome, name: &str| {
        let column = outcome.column(name);
        column.iter().sum::<f64>() / column.len() as f64
    };
    let of = |name: &str, allowed: f64| {
        let off = (mean(event, name) - mean(step, name)).abs() / event.largest(name).max(f64::MIN_POSITIVE);
        (off > allowed).then(|| format!("mean {name} differs by {off:.1e} of the largest"))
    };
    let [one, other] = [event, step].map(|outcome| outcome.last("solver.error"));
    let of_z = if shows_instants(event) { SENSITIVE.max(one + other) } else { SENSITIVE };
    let scale = energy_scale(event).max(f64::MIN_POSITIVE);
    let lost = (event.last("E_diss") - step.last("E_diss")).abs() / scale;
    let lost = (lost > SENSITIVE).then(|| format!("E_diss differs by {lost:.1e} of the largest energy"));
    of("F_x", SENSITIVE).or_else(|| of("F_z", of_z)).or(lost)
}

/// Whether most of the motion lies between two rows.
fn shows_instants(outcome: &Outcome) -> bool {
    let times: Vec<f64> = outcome.rows.iter().map(|(time, _)| *time).collect();
    let longest = times.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max);
    longest > 0.5 * (times[times.len() - 1] - times[0])
}

fn relative_tolerance(case: &Case) -> f64 {
    let solver = case.scene.get("solver").and_then(|solver| solver.get("relative_tolerance"));
    solver.map_or(1e-6, number)
}

/// Once the carrier rests T + V never grows, but for the tolerance within which a row between two steps is known.
fn energy_grows(case: &Case, outcome: &Outcome) -> Option<Finding> {
    let (kinetic, elastic) = (outcome.column("energy.kinetic"), outcome.column("energy.elastic"));
    let stored: Vec<f64> = kinetic.iter().zip(&elastic).map(|(kinetic, elastic)| kinetic + elastic).collect();
    let scale = stored.iter().fold(0.0, |a: f64, b| a.max(*b));
    let growth = stored[(case.rows as usize).min(stored.len() - 1)..]
        .windows(2)
        .map(|pair| pair[1] - pair[0])
        .fold(0.0, f64::max);
    let relative = relative_tolerance(case);
    let text = format!("T + V grows by {growth:.1e} of {scale:.1e} J between two rows");
    (growth > ENERGY * relative * scale).then_some(Finding { rule: "grows", text })
}
