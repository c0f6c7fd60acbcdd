//! What a run of a scene comes to, in a few lines: forces, friction, contact, energy and what it took; what made it
//! expensive, where that is asked for.

use std::time::Instant;

use asperity::model::Model;
use asperity::outputs::{Accounts, Output, Snapshot, variable};
use asperity::scene::{Method, Scene};
use asperity::simulation::Simulation;

use crate::decimals::{rounded, with_prefix};
use crate::implausible::{FoundFriction, implausible, misfitted, strained};
use crate::summary::{LabelledLine, labelled};

/// Forces and friction over the rows of a run.
#[derive(Clone, Copy, Debug)]
pub struct RunFigures {
    began: Instant,
    /// u (m) and F_x, F_z (N) of the last row.
    last: Option<[f64; 3]>,
    /// Lowest and highest F_x and F_z of the rows, N.
    ranges: [(f64, f64); 2],
    /// Way along x from row to row, m.
    way: f64,
    /// ∫ F_x du by the trapezoidal rule from row to row, J.
    work: f64,
    /// ∫ F_z |du| likewise, N m.
    load: f64,
}

impl Default for RunFigures {
    fn default() -> Self {
        const NONE: (f64, f64) = (f64::INFINITY, f64::NEG_INFINITY);
        Self { began: Instant::now(), last: None, ranges: [NONE; 2], way: 0.0, work: 0.0, load: 0.0 }
    }
}

impl RunFigures {
    /// Takes in a row.
    pub fn add(&mut self, snapshot: &Snapshot<'_>) {
        let now @ [u, f_x, f_z] = [snapshot.displacement.x, snapshot.on_carrier.x, snapshot.on_carrier.z];
        if let Some([last_u, last_x, last_z]) = self.last {
            let way = u - last_u;
            self.way += way.abs();
            self.work += 0.5 * (f_x + last_x) * way;
            self.load += 0.5 * (f_z + last_z) * way.abs();
        }
        for ((low, high), force) in self.ranges.iter_mut().zip([f_x, f_z]) {
            (*low, *high) = (low.min(force), high.max(force));
        }
        self.last = Some(now);
    }

    /// Mean friction coefficient: the work along the way over that of the load, 1; `None` without a load on the way.
    pub fn friction(&self) -> Option<f64> {
        (self.load > 0.0).then(|| self.work.abs() / self.load)
    }

    /// The lines of a run of `scene` that is over.
    pub fn lines(&self, scene: &Scene, simulation: &mut Simulation) -> Vec<LabelledLine> {
        let snapshot = simulation.snapshot();
        let accounts = Accounts::new(scene);
        let energy = accounts.energy.then(|| energy(&snapshot));
        let results = [
            ("Forces", Some(self.forces(&snapshot))),
            ("Friction", self.friction_in_words()),
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
        let [x, z] = self.ranges;
        format!("{}; {}", force("F_x", snapshot.on_carrier.x, x), force("F_z", snapshot.on_carrier.z, z))
    }

    fn friction_in_words(&self) -> Option<String> {
        let (coefficient, way) = (rounded(self.friction()?, 4), self.way);
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

    /// What the run cost and what would make it cheaper.
    pub fn statistics(&self, scene: &Scene, simulation: &mut Simulation) -> Vec<LabelledLine> {
        let (masses, time) = (scene.layer.masses, self.began.elapsed().as_secs_f64());
        let found = RunCost::new(scene, simulation);
        let variables = found.maxwell_variables;
        let unknowns = 4 * masses + variables;
        let cost = [
            format!("{masses} masses, {unknowns} unknowns, {variables} of them of Maxwell elements"),
            format!("{} a step, {:.1} Newton iterations a step", seconds(time / found.tried), found.iterations),
            format!("{:.3} events a step, {:.2} events a mass", found.events, found.events_per_mass),
        ];
        let mut advice = found.savings(scene);
        if advice.is_empty() {
            advice.push("nothing that stands out".to_owned());
        }
        labelled("Cost", cost).into_iter().chain(labelled("Cheaper by", advice)).collect()
    }
}

/// What of a run of `scene` that has come to its end no rubber has, and why.
pub fn implausible_run(scene: &Scene, figures: &RunFigures, simulation: &mut Simulation) -> Vec<String> {
    let snapshot = simulation.snapshot();
    let value = |output: Output| {
        let mut value = [0.0];
        snapshot.evaluate(&[variable(output)?], &mut value);
        Some(value[0])
    };
    let touching = value(Output::ContactCount).map(|count| count / scene.layer.masses as f64);
    let area = match (&scene.fine, scene.layer.area()) {
        (Some(_), Some(nominal)) => value(Output::RealArea).map(|area| area / nominal),
        _ => touching,
    };
    let found = figures.friction().map(|friction| {
        let place = "over the run".to_owned();
        FoundFriction { place, friction, area, rise: None }
    });
    implausible(scene, found.clone())
        .into_iter()
        .chain(strained(scene, found))
        .chain(misfitted(scene, touching.map(|share| ("at the end".to_owned(), share))))
        .collect()
}

/// What a run cost.
#[derive(Clone, Copy, Debug)]
struct RunCost {
    /// Number of unknowns that are of Maxwell elements.
    maxwell_variables: usize,
    /// Number of steps, those rejected included, at least 1.
    tried: f64,
    /// Newton iterations a step.
    iterations: f64,
    /// Events a step.
    events: f64,
    /// Events a mass.
    events_per_mass: f64,
    /// Steps that were rejected over all.
    rejected: f64,
}

impl RunCost {
    /// That of a run of `scene` so far.
    fn new(scene: &Scene, simulation: &mut Simulation) -> Self {
        let (newton, counters) = (simulation.newton_iterations(), simulation.snapshot().counters);
        let tried = (counters.steps + counters.rejected).max(1) as f64;
        Self {
            maxwell_variables: Model::new(scene).maxwell_variables(),
            tried,
            iterations: newton as f64 / tried,
            events: counters.events as f64 / tried,
            events_per_mass: counters.events as f64 / scene.layer.masses as f64,
            rejected: counters.rejected as f64 / tried,
        }
    }

    /// What would make the run of `scene` cheaper, the largest first.
    fn savings(&self, scene: &Scene) -> Vec<String> {
        let error = Accounts::new(scene).solver.then(|| {
            "leaving the output group \"solver\" out: its error estimate is a second, more accurate run".to_owned()
        });
        // The masses of a scene in the direct form do not follow the spacing, so there is no such study of it.
        let may_be_fewer = scene.layer.masses > 1 && scene.material.is_some() && !scene.has_coarse_spacing();
        let fewer = may_be_fewer.then(|| {
            "fewer masses: `asperity converge --method layer` tells how friction depends on the spacing".to_owned()
        });
        let all = [error, self.time_stepping(scene), self.tolerance(scene), self.reduction(scene), fewer];
        all.into_iter().flatten().collect()
    }

    fn time_stepping(&self, scene: &Scene) -> Option<String> {
        /// An event ends a step; with fewer than this share of them the events are not what costs.
        const FEW_EVENTS: f64 = 0.3;
        (scene.solver.method == Method::Event && self.events > FEW_EVENTS).then(|| {
            "solver.method = \"step\" with relative_tolerance = 1e-3: its steps do not end at events".to_owned()
        })
    }

    fn tolerance(&self, scene: &Scene) -> Option<String> {
        /// Tolerances above do not gain much by a looser one, with events and without.
        const LOOSE: f64 = 1e-4;
        const LOOSE_WITHOUT_EVENTS: f64 = 1e-2;
        /// So many rejected steps are a part of the cost that a reader should know.
        const MANY_REJECTED: f64 = 0.2;
        let loose = if scene.solver.method == Method::Event { LOOSE } else { LOOSE_WITHOUT_EVENTS };
        let now = scene.solver.relative_tolerance;
        let rejected = match self.rejected {
            share if share > MANY_REJECTED => format!("; {:.0} % of the steps were rejected", 100.0 * share),
            _ => String::new(),
        };
        (now < loose).then(|| format!("solver.relative_tolerance up to {loose:e}, from {now:e}{rejected}"))
    }

    fn reduction(&self, scene: &Scene) -> Option<String> {
        /// Relative change of a link's force that most uses stand.
        const REDUCE: f64 = 1e-3;
        /// A reduction to be worth a line leaves less than this share of the variables.
        const WORTH: f64 = 0.9;
        // A scene whose temperature is an input has to keep what counts at others.
        if scene.temperature_input {
            return None;
        }
        let mut reduced = scene.clone();
        reduced.solver.reduce = REDUCE;
        let (variables, left) = (self.maxwell_variables, Model::new(&reduced).maxwell_variables());
        let is_worth = scene.solver.reduce < REDUCE && (left as f64) < WORTH * variables as f64;
        is_worth.then(|| format!("solver.reduce = {REDUCE}: {left} of {variables} Maxwell variables are left"))
    }
}

fn contact(snapshot: &Snapshot<'_>) -> String {
    let outputs = [Output::ContactCount, Output::StickingCount];
    let variables: Vec<_> = outputs.into_iter().filter_map(variable).collect();
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

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    /// What would be cheaper but is refused beside another key is no advice.
    #[test]
    fn advice_is_what_the_scene_may_have() {
        let advice = |input: &str| {
            let text = format!(
                "name = 's'\nlayer = {{ foundation = 'half_space', masses = 8, spacing = 4e-5, width = 1e-2 }}\n[material]\n\
                 density = 1e3\npoisson_ratio = 0.5\nequilibrium_modulus = 1e6\nwlf = {{ c1 = 7.5, c2 = 120, \
                 reference_temperature = 293, temperature = 293 }}\nprony = [{{ modulus = 1e6, relaxation_time = 1e-9 }}, \
                 {{ modulus = 1e6, relaxation_time = 1e9 }}]\n[surface]\nkind = 'sinusoid'\namplitude = 1e-5\n\
                 wavelength = 3.2e-4\n[input]\ntemperature = {input}\n[[excitation]]\nduration = 1e-4\nw_rate = -0.01"
            );
            let scene = Scene::parse(&text, "s.toml".as_ref()).unwrap();
            let mut simulation = Simulation::new(&scene, &crate::runner::start(&scene, 0.0)).unwrap();
            let lines = RunFigures::default().statistics(&scene, &mut simulation);
            lines.iter().any(|(_, text)| text.starts_with("solver.reduce"))
        };
        assert!(advice("false") && !advice("true"));
    }
}
