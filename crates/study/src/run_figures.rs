//! What a run of a scene comes to: forces, friction, what it cost, and what would make it cheaper.

use asperity::model::Model;
use asperity::outputs::{Accounts, Output, Snapshot, variable};
use asperity::scene::{Method, Scene};
use asperity::simulation::Simulation;

use crate::implausible::{FoundFriction, implausible};

/// Forces and friction over the rows of a run.
#[derive(Clone, Copy, Debug)]
pub struct RunFigures {
    /// u (m) and F_x, F_z (N) of the last row.
    last: Option<[f64; 3]>,
    /// Lowest and highest F_x and F_z of the rows, N.
    pub ranges: [(f64, f64); 2],
    /// Way along x from row to row, m.
    pub way: f64,
    /// ∫ F_x du by the trapezoidal rule from row to row, J.
    work: f64,
    /// ∫ F_z |du| likewise, N m.
    load: f64,
}

impl Default for RunFigures {
    fn default() -> Self {
        const NONE: (f64, f64) = (f64::INFINITY, f64::NEG_INFINITY);
        Self { last: None, ranges: [NONE; 2], way: 0.0, work: 0.0, load: 0.0 }
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
}

/// What of a run of `scene` that has come to its end no rubber has, and why.
pub fn implausible_run(scene: &Scene, figures: &RunFigures, simulation: &mut Simulation) -> Vec<String> {
    let Some(friction) = figures.friction() else { return Vec::new() };
    let snapshot = simulation.snapshot();
    let value = |output: Output| {
        let mut value = [0.0];
        snapshot.evaluate(&[variable(output)?], &mut value);
        Some(value[0])
    };
    let area = match (&scene.fine, scene.layer.area()) {
        (Some(_), Some(nominal)) => value(Output::RealArea).map(|area| area / nominal),
        _ => value(Output::ContactCount).map(|count| count / scene.layer.masses as f64),
    };
    let place = "over the run".to_owned();
    implausible(scene, [FoundFriction { place, friction, area, rise: None }])
}

/// What a run cost.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RunCost {
    /// Number of unknowns.
    pub unknowns: usize,
    /// Number of those that are of Maxwell elements.
    pub maxwell_variables: usize,
    /// Number of steps, those rejected included, at least 1.
    pub tried: f64,
    /// Newton iterations a step.
    pub iterations: f64,
    /// Events a step.
    pub events: f64,
    /// Events a mass.
    pub events_per_mass: f64,
    /// Steps that were rejected over all.
    pub rejected: f64,
}

impl RunCost {
    /// That of a run of `scene` so far.
    pub fn new(scene: &Scene, simulation: &mut Simulation) -> Self {
        let masses = scene.layer.masses;
        let (newton, counters) = (simulation.newton_iterations(), simulation.snapshot().counters);
        let maxwell_variables = Model::new(scene).maxwell_variables();
        let tried = (counters.steps + counters.rejected).max(1) as f64;
        Self {
            unknowns: 4 * masses + maxwell_variables,
            maxwell_variables,
            tried,
            iterations: newton as f64 / tried,
            events: counters.events as f64 / tried,
            events_per_mass: counters.events as f64 / masses as f64,
            rejected: counters.rejected as f64 / tried,
        }
    }

    /// What would make the run of `scene` cheaper, the largest first.
    pub fn savings(&self, scene: &Scene) -> Vec<Saving> {
        let all = [
            Accounts::new(scene).solver.then_some(Saving::NoErrorEstimate),
            self.time_stepping(scene),
            self.tolerance(scene),
            self.reduction(scene),
            (scene.layer.masses > 1 && !scene.has_coarse_spacing()).then_some(Saving::FewerMasses),
        ];
        all.into_iter().flatten().collect()
    }

    fn time_stepping(&self, scene: &Scene) -> Option<Saving> {
        /// An event ends a step; with fewer than this share of them the events are not what costs.
        const FEW_EVENTS: f64 = 0.3;
        (scene.solver.method == Method::Event && self.events > FEW_EVENTS).then_some(Saving::TimeStepping)
    }

    fn tolerance(&self, scene: &Scene) -> Option<Saving> {
        /// Tolerances above do not gain much by a looser one, with events and without.
        const LOOSE: f64 = 1e-4;
        const LOOSE_WITHOUT_EVENTS: f64 = 1e-2;
        /// So many rejected steps are a part of the cost that a reader should know.
        const MANY_REJECTED: f64 = 0.2;
        let loose = if scene.solver.method == Method::Event { LOOSE } else { LOOSE_WITHOUT_EVENTS };
        let rejected = Some(self.rejected).filter(|rejected| *rejected > MANY_REJECTED);
        (scene.solver.relative_tolerance < loose).then_some(Saving::Tolerance { loose, rejected })
    }

    fn reduction(&self, scene: &Scene) -> Option<Saving> {
        /// Relative change of a link's force that most uses stand.
        const REDUCE: f64 = 1e-3;
        /// A reduction to be worth a line leaves less than this share of the variables.
        const WORTH: f64 = 0.9;
        let mut reduced = scene.clone();
        reduced.solver.reduce = REDUCE;
        let left = Model::new(&reduced).maxwell_variables();
        let is_worth = scene.solver.reduce < REDUCE && (left as f64) < WORTH * self.maxwell_variables as f64;
        is_worth.then_some(Saving::Reduction { reduce: REDUCE, left })
    }
}

/// What would make a run cheaper.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Saving {
    /// No estimate of the error, which is a second run.
    NoErrorEstimate,
    /// Time steps, which do not end at events.
    TimeStepping,
    /// A looser tolerance.
    Tolerance {
        /// The loosest that gains much, 1.
        loose: f64,
        /// The share of rejected steps, 1; `None` where it is small.
        rejected: Option<f64>,
    },
    /// Fewer Maxwell variables.
    Reduction {
        /// `solver.reduce`, 1.
        reduce: f64,
        /// Maxwell variables that are left.
        left: usize,
    },
    /// Fewer masses.
    FewerMasses,
}
