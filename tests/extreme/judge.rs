//! The runs of a case, held against each other: method against method, and both against a tight run.

use crate::catalogue::{Case, number};
use crate::device::by_device;
use crate::holds::{ENERGY, Finding, energy_scale};
use crate::run::{Outcome, by_library};

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
        if self.is_fmu() { by_device(case, self.method(), tight) } else { by_library(case, self.method(), tight) }
    }
}

/// What the table says of one run.
#[derive(Clone, Debug)]
pub struct Verdict {
    pub case: String,
    pub phrase: String,
    pub way: Way,
    pub error: Option<String>,
    pub findings: Vec<Finding>,
    pub steps: f64,
    pub events: f64,
    pub rejected: f64,
    /// The largest residual of the energies over the largest energy.
    pub residual: f64,
    /// The largest error of F_z against the tight run, over the largest |F_z| so far; NaN where there is no tight run.
    pub true_error: f64,
    /// `solver.error` at the end.
    pub estimate: f64,
    /// Processor time, s.
    pub time: f64,
}

impl Verdict {
    /// A run that panicked.
    pub fn panicked(case: &Case, text: String) -> Self {
        Self {
            case: case.name.clone(),
            phrase: case.phrase.clone(),
            way: Way::Event,
            error: None,
            findings: vec![Finding { rule: "panic", text }],
            steps: 0.0,
            events: 0.0,
            rejected: 0.0,
            residual: 0.0,
            true_error: f64::NAN,
            estimate: 0.0,
            time: 0.0,
        }
    }
}

/// All runs of a case.
pub fn judge(case: &Case) -> Vec<Verdict> {
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
    let straight = outcomes.first().map_or(Way::Event, |(way, _)| *way);
    let tight = straight.run(case, case.tight);
    outcomes.into_iter().map(|(way, outcome)| verdict(case, way, outcome, (straight, &tight))).collect()
}

fn verdict(case: &Case, way: Way, mut outcome: Outcome, (straight, tight): (Way, &Outcome)) -> Verdict {
    match (&outcome.error, &case.error) {
        (Some(error), Some((expected, _))) if error.contains(expected) => {}
        (Some(error), _) => outcome.findings.push(Finding { rule: "ends", text: error.clone() }),
        (None, Some((expected, _))) => {
            outcome.findings.push(Finding { rule: "error", text: format!("no error with {expected:?}") });
        }
        (None, None) => {}
    }
    if case.free_of_work {
        outcome.findings.extend(energy_grows(case, &outcome));
    }
    let comparable = way.is_fmu() == straight.is_fmu() && outcome.error.is_none() && tight.error.is_none();
    let true_error = if comparable { error_against(&outcome, tight) } else { f64::NAN };
    if way == straight && tight.error.is_some() && outcome.error.is_none() {
        let text = format!("the tight run: {}", tight.error.as_deref().unwrap_or_default());
        outcome.findings.push(Finding { rule: "tight", text });
    }
    let scale = energy_scale(&outcome).max(f64::MIN_POSITIVE);
    Verdict {
        case: case.name.clone(),
        phrase: case.phrase.clone(),
        way,
        steps: outcome.last("solver.steps"),
        events: outcome.last("solver.events"),
        rejected: outcome.last("solver.rejected"),
        residual: outcome.largest("energy.residual") / scale,
        true_error,
        estimate: outcome.last("solver.error"),
        time: outcome.last("solver.run_time"),
        error: outcome.error,
        findings: outcome.findings,
    }
}

/// The largest difference of F_z, over the largest |F_z| so far.
fn error_against(outcome: &Outcome, tight: &Outcome) -> f64 {
    let (found, right) = (outcome.column("F_z"), tight.column("F_z"));
    // Before there is a force, everything is large against it.
    let mut largest = EARLY * right.iter().fold(0.0, |largest: f64, force| largest.max(force.abs()));
    let errors = found.iter().zip(&right).map(|(found, right)| {
        largest = largest.max(right.abs());
        if largest > 0.0 { (found - right).abs() / largest } else { (found - right).abs() }
    });
    errors.fold(0.0, f64::max)
}

/// A force below this share of the largest to come is not yet one that an error can be held against.
const EARLY: f64 = 1e-6;
/// How many times their estimates two methods may differ: each is to be within a factor of ten of the truth.
const OF_ESTIMATES: f64 = 10.0;
/// Below this share of the largest force, differences are roundings.
pub const FLOOR: f64 = 1e-9;
/// The means and losses of a sensitive motion may differ by this share of the largest.
const SENSITIVE: f64 = 0.1;

/// Where event-driven and time-stepping runs differ by more than their estimates allow.
fn disagreement(case: &Case, event: &Outcome, step: &Outcome) -> Option<String> {
    if event.error.is_some() || step.error.is_some() {
        return None;
    }
    if case.sensitive.is_some() {
        return sensitive_disagreement(event, step);
    }
    let difference = error_against(step, event);
    let estimates = event.last("solver.error") + step.last("solver.error");
    let allowed = OF_ESTIMATES * estimates + FLOOR;
    (difference > allowed).then(|| {
        format!(
            "F_z differs by {difference:.1e}, estimates {:.1e} and {:.1e}",
            event.last("solver.error"),
            step.last("solver.error")
        )
    })
}

fn sensitive_disagreement(event: &Outcome, step: &Outcome) -> Option<String> {
    let mean = |outcome: &Outcome, name: &str| {
        let column = outcome.column(name);
        column.iter().sum::<f64>() / column.len() as f64
    };
    let of = |name: &str| {
        let off = (mean(event, name) - mean(step, name)).abs() / event.largest(name).max(f64::MIN_POSITIVE);
        (off > SENSITIVE).then(|| format!("mean {name} differs by {off:.1e} of the largest"))
    };
    let scale = energy_scale(event).max(f64::MIN_POSITIVE);
    let lost = (event.last("E_diss") - step.last("E_diss")).abs() / scale;
    let lost = (lost > SENSITIVE).then(|| format!("E_diss differs by {lost:.1e} of the largest energy"));
    of("F_x").or_else(|| of("F_z")).or(lost)
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
    let solver = case.scene.get("solver").and_then(|solver| solver.get("relative_tolerance"));
    let relative = solver.map_or(1e-6, number);
    let text = format!("T + V grows by {growth:e} of {scale:e} J between two rows");
    (growth > ENERGY * relative * scale).then_some(Finding { rule: "grows", text })
}
