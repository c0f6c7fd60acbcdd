//! What a run of a scene comes to, in a few lines: forces, friction, contact, energy and what it took; what made it
//! expensive, where that is asked for.

use std::time::Instant;

use asperity::model::Model;
use asperity::outputs::{Accounts, Output, Snapshot, Variable, variable};
use asperity::scene::{Method, Scene};
use asperity::simulation::Simulation;

use super::terminal::{LabelledLine, labelled};
use asperity_study::decimals::rounded;
use asperity_study::decimals::with_prefix;

/// Follows the rows of a run.
#[derive(Debug)]
pub(super) struct RunSummary {
    began: Instant,
    /// u (m) and F_x, F_z (N) of the last row.
    last: Option<[f64; 3]>,
    /// Lowest and highest F_x and F_z of the rows, N.
    ranges: [(f64, f64); 2],
    slide: Slide,
}

/// Sums over the way along x, by the trapezoidal rule from row to row.
#[derive(Clone, Copy, Debug, Default)]
struct Slide {
    /// m.
    way: f64,
    /// ∫ F_x du, J.
    work: f64,
    /// ∫ F_z |du|, N m.
    load: f64,
}

impl RunSummary {
    pub(super) fn new() -> Self {
        const NONE: (f64, f64) = (f64::INFINITY, f64::NEG_INFINITY);
        Self { began: Instant::now(), last: None, ranges: [NONE; 2], slide: Slide::default() }
    }

    /// Takes in a row.
    pub(super) fn add(&mut self, snapshot: &Snapshot<'_>) {
        let now @ [u, f_x, f_z] = [snapshot.displacement.x, snapshot.on_carrier.x, snapshot.on_carrier.z];
        if let Some([last_u, last_x, last_z]) = self.last {
            let way = u - last_u;
            self.slide.way += way.abs();
            self.slide.work += 0.5 * (f_x + last_x) * way;
            self.slide.load += 0.5 * (f_z + last_z) * way.abs();
        }
        for ((low, high), force) in self.ranges.iter_mut().zip([f_x, f_z]) {
            (*low, *high) = (low.min(force), high.max(force));
        }
        self.last = Some(now);
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
        let [x, z] = self.ranges;
        format!("{}; {}", force("F_x", snapshot.on_carrier.x, x), force("F_z", snapshot.on_carrier.z, z))
    }

    /// Friction as the work along the way over that of the load.
    fn friction(&self) -> Option<String> {
        let Slide { way, work, load } = self.slide;
        let coefficient = (load > 0.0).then(|| rounded(work.abs() / load, 4))?;
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
    pub(super) fn statistics(&self, scene: &Scene, simulation: &mut Simulation) -> Vec<LabelledLine> {
        let (masses, time) = (scene.layer.masses, self.began.elapsed().as_secs_f64());
        let (newton, counters) = (simulation.newton_iterations(), simulation.snapshot().counters);
        let variables = Model::new(scene).maxwell_variables();
        let tried = (counters.steps + counters.rejected).max(1) as f64;
        let cost = [
            format!("{masses} masses, {} unknowns, {variables} of them of Maxwell elements", 4 * masses + variables),
            format!("{} a step, {:.1} Newton iterations a step", seconds(time / tried), newton as f64 / tried),
            format!(
                "{:.3} events a step, {:.2} events a mass",
                counters.events as f64 / tried,
                counters.events as f64 / masses as f64
            ),
        ];
        let [events, rejected] = [counters.events, counters.rejected].map(|count| count as f64 / tried);
        let mut advice = cheaper(scene, events, rejected, variables);
        if advice.is_empty() {
            advice.push("nothing that stands out".to_owned());
        }
        labelled("Cost", cost).into_iter().chain(labelled("Cheaper by", advice)).collect()
    }
}

/// What would make a run of the scene with so many events and rejected steps a step and Maxwell variables cheaper, the
/// largest first.
fn cheaper(scene: &Scene, events: f64, rejected: f64, variables: usize) -> Vec<String> {
    /// An event ends a step; with fewer than this share of them the events are not what costs.
    const FEW_EVENTS: f64 = 0.3;
    /// Relative change of a link's force that most uses stand.
    const REDUCE: f64 = 1e-3;
    /// A reduction to be worth a line leaves less than this share of the variables.
    const WORTH: f64 = 0.9;
    /// Tolerances above do not gain much by a looser one, with events and without.
    const LOOSE: f64 = 1e-4;
    const LOOSE_WITHOUT_EVENTS: f64 = 1e-2;
    /// So many rejected steps are a part of the cost that a reader should know.
    const MANY_REJECTED: f64 = 0.2;
    let solver = &scene.solver;
    let mut advice = Vec::new();
    if Accounts::new(scene).solver {
        advice
            .push("leaving the output group \"solver\" out: its error estimate is a second, more accurate run".into());
    }
    if solver.method == Method::Event && events > FEW_EVENTS {
        advice.push("solver.method = \"step\" with relative_tolerance = 1e-3: its steps do not end at events".into());
    }
    let loose = if solver.method == Method::Event { LOOSE } else { LOOSE_WITHOUT_EVENTS };
    if solver.relative_tolerance < loose {
        let rejected = match rejected > MANY_REJECTED {
            true => format!("; {:.0} % of the steps were rejected", 100.0 * rejected),
            false => String::new(),
        };
        advice
            .push(format!("solver.relative_tolerance up to {loose:e}, from {:e}{rejected}", solver.relative_tolerance));
    }
    let mut reduced = scene.clone();
    reduced.solver.reduce = REDUCE;
    let left = Model::new(&reduced).maxwell_variables();
    if solver.reduce < REDUCE && (left as f64) < WORTH * variables as f64 {
        advice.push(format!("solver.reduce = {REDUCE}: {left} of {variables} Maxwell variables are left"));
    }
    if scene.layer.masses > 1 && !scene.has_coarse_spacing() {
        advice
            .push("fewer masses: `asperity converge --method layer` tells how friction depends on the spacing".into());
    }
    advice
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
