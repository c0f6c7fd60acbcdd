//! What a run of a scene comes to, in a few lines: forces, friction, contact, energy and what it took; what made it
//! expensive, where that is asked for.

use std::time::Instant;

use asperity::outputs::{Accounts, Output, Snapshot, Variable, variable};
use asperity::scene::Scene;
use asperity::simulation::Simulation;

use super::terminal::{LabelledLine, labelled};
use asperity_study::decimals::{rounded, with_prefix};
use asperity_study::run_figures::{RunCost, RunFigures, Saving, implausible_run};

/// Follows the rows of a run.
#[derive(Debug)]
pub(super) struct RunSummary {
    began: Instant,
    figures: RunFigures,
}

impl RunSummary {
    pub(super) fn new() -> Self {
        Self { began: Instant::now(), figures: RunFigures::default() }
    }

    /// Takes in a row.
    pub(super) fn add(&mut self, snapshot: &Snapshot<'_>) {
        self.figures.add(snapshot);
    }

    /// The lines of a run of `scene` that is over.
    pub(super) fn lines(&self, scene: &Scene, simulation: &mut Simulation) -> Vec<LabelledLine> {
        let snapshot = simulation.snapshot();
        let accounts = Accounts::new(scene);
        let energy = accounts.energy.then(|| energy(&snapshot));
        let results = [
            ("Forces", Some(self.forces(&snapshot))),
            ("Friction", self.friction()),
            ("Contact", Some(contact(&snapshot))),
            ("Dissipated", energy),
            ("Run", Some(self.run(&snapshot, accounts))),
        ];
        results.into_iter().filter_map(|(label, text)| text.map(|text| (label, text))).collect()
    }

    fn forces(&self, snapshot: &Snapshot<'_>) -> String {
        let force = |name: &str, now: f64, (low, high): (f64, f64)| {
            /// Forces below this share of the largest are roundings to a reader.
            const ROUNDING: f64 = 1e-4;
            let largest = low.abs().max(high.abs());
            let newtons =
                |force: f64| with_prefix(if force.abs() < ROUNDING * largest { 0.0 } else { force }, largest, "N");
            format!("{name} {} at the end, {} to {} on the way", newtons(now), newtons(low), newtons(high))
        };
        let [x, z] = self.figures.ranges;
        format!("{}; {}", force("F_x", snapshot.on_carrier.x, x), force("F_z", snapshot.on_carrier.z, z))
    }

    fn friction(&self) -> Option<String> {
        let (coefficient, way) = (rounded(self.figures.friction()?, 4), self.figures.way);
        Some(format!("{coefficient} in the mean over {} along x, from row to row", with_prefix(way, way, "m")))
    }

    fn run(&self, snapshot: &Snapshot<'_>, accounts: Accounts) -> String {
        let counters = &snapshot.counters;
        let error = if accounts.solver {
            format!("estimated error {:.1e}", counters.force_error())
        } else {
            "error not estimated (output group \"solver\")".to_owned()
        };
        format!(
            "{} steps, {} rejected, {} events, {}; {error}",
            counters.steps,
            counters.rejected,
            counters.events,
            seconds(self.began.elapsed().as_secs_f64())
        )
    }

    /// What of the run of `scene` no rubber has, and why.
    pub(super) fn warnings(&self, scene: &Scene, simulation: &mut Simulation) -> Vec<String> {
        implausible_run(scene, &self.figures, simulation)
    }

    /// What the run cost and what would make it cheaper.
    pub(super) fn statistics(&self, scene: &Scene, simulation: &mut Simulation) -> Vec<LabelledLine> {
        let (masses, time) = (scene.layer.masses, self.began.elapsed().as_secs_f64());
        let found = RunCost::new(scene, simulation);
        let (unknowns, variables) = (found.unknowns, found.maxwell_variables);
        let cost = [
            format!("{masses} masses, {unknowns} unknowns, {variables} of them of Maxwell elements"),
            format!("{} a step, {:.1} Newton iterations a step", seconds(time / found.tried), found.iterations),
            format!("{:.3} events a step, {:.2} events a mass", found.events, found.events_per_mass),
        ];
        let savings = found.savings(scene);
        let mut advice: Vec<String> = savings.iter().map(|saving| in_words(saving, scene, variables)).collect();
        if advice.is_empty() {
            advice.push("nothing that stands out".to_owned());
        }
        labelled("Cost", cost).into_iter().chain(labelled("Cheaper by", advice)).collect()
    }
}

/// What would make a run of the scene, which has so many Maxwell variables, cheaper.
fn in_words(saving: &Saving, scene: &Scene, variables: usize) -> String {
    match saving {
        Saving::NoErrorEstimate => {
            "leaving the output group \"solver\" out: its error estimate is a second, more accurate run".into()
        }
        Saving::TimeStepping => {
            "solver.method = \"step\" with relative_tolerance = 1e-3: its steps do not end at events".into()
        }
        Saving::Tolerance { loose, rejected } => {
            let rejected = rejected.map(|share| format!("; {:.0} % of the steps were rejected", 100.0 * share));
            let (now, rejected) = (scene.solver.relative_tolerance, rejected.unwrap_or_default());
            format!("solver.relative_tolerance up to {loose:e}, from {now:e}{rejected}")
        }
        Saving::Reduction { reduce, left } => {
            format!("solver.reduce = {reduce}: {left} of {variables} Maxwell variables are left")
        }
        Saving::FewerMasses => {
            "fewer masses: `asperity converge --method layer` tells how friction depends on the spacing".into()
        }
    }
}

fn contact(snapshot: &Snapshot<'_>) -> String {
    let outputs = [Output::ContactCount, Output::StickingCount];
    let variables: Vec<Variable> = outputs.into_iter().filter_map(variable).collect();
    let mut counts = vec![0.0; variables.len()];
    snapshot.evaluate(&variables, &mut counts);
    let [count, sticking] = [0, 1].map(|i| counts.get(i).copied().unwrap_or_default());
    format!("{count} of {} masses at the end, {sticking} of them sticking", snapshot.model.masses())
}

fn energy(snapshot: &Snapshot<'_>) -> String {
    let (energies, all) = (&snapshot.energies, snapshot.energies.dissipated());
    let channels = &energies.channels;
    let parts = [
        ("friction", channels.friction),
        ("Maxwell elements", channels.maxwell),
        ("dampers", channels.damper),
        ("impacts", energies.impact),
    ];
    /// Parts below this share are left out.
    const SMALL: f64 = 1e-4;
    let share = |(name, part): (&str, f64)| format!("{name} {} %", rounded(100.0 * part / all, 3));
    let shares: Vec<String> = parts.into_iter().filter(|(_, part)| *part > SMALL * all).map(share).collect();
    let whole = with_prefix(all, all, "J");
    if shares.is_empty() { whole } else { format!("{whole}: {}", shares.join(", ")) }
}

/// A time in two digits.
fn seconds(time: f64) -> String {
    let time = rounded(time, 2);
    with_prefix(time, time, "s")
}
