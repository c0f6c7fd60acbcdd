//! The run of a scene along its own excitation, as rows of results.

use std::collections::VecDeque;
use std::vec;

use super::Simulation;
use super::motion::{SimulationError, Start};
use crate::outputs::{Variable, variables};
use crate::scene::{Phase, Scene};

/// Rows of each phase, where no other number is asked for.
const ROWS: u32 = 50;

/// Runs `scene` along its own excitation: one row of results at the start and 50 in each phase, each computed as it is
/// asked for, with those of its phase.
///
/// ```
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// # let text = "name = 'one'\nlayer = { masses = 1, spacing = 1e-4, mass = 1e-7, vertical = { stiffness = 2e3, damping = 8e-3 } }\n\
/// #     surface = { kind = 'flat' }\nexcitation = [{ duration = 1e-3, w_rate = -0.01 }]";
/// let scene = asperity::Scene::parse(text, "scene.toml".as_ref())?;
/// let rows = asperity::run(&scene)?;
/// let normal = rows.variables().iter().position(|variable| variable.name == "F_z").ok_or("no F_z")?;
/// for row in rows {
///     let row = row?;
///     println!("{} s: {} N", row.time, row.values[normal]);
/// }
/// # Ok(())
/// # }
/// ```
///
/// # Errors
/// As for [`Simulation::new`].
pub fn run(scene: &Scene) -> Result<ResultRows, SimulationError> {
    let mut rows = ResultRows {
        simulation: Simulation::new(scene, &Start::of(scene))?,
        variables: variables(scene),
        phases: scene.excitation.clone().into_iter(),
        area: scene.layer.area(),
        of_phase: ROWS,
        ready: VecDeque::new(),
    };
    rows.push_now();
    Ok(rows)
}

/// The rows of a run that are still to come; see [`run`].
#[derive(Debug)]
pub struct ResultRows {
    simulation: Simulation,
    variables: Vec<Variable>,
    phases: vec::IntoIter<Phase>,
    /// Area of the layer, m², if the scene gives it.
    area: Option<f64>,
    of_phase: u32,
    ready: VecDeque<ResultRow>,
}

/// The results at one time.
#[derive(Clone, Debug, PartialEq)]
pub struct ResultRow {
    /// The time, s.
    pub time: f64,
    /// The values of the [variables](ResultRows::variables), in their order.
    pub values: Vec<f64>,
}

impl ResultRows {
    /// With so many rows in each phase, at even times.
    #[must_use]
    pub fn per_phase(self, rows: u32) -> Self {
        Self { of_phase: rows, ..self }
    }

    /// What the values of a row are, in their order.
    pub fn variables(&self) -> &[Variable] {
        &self.variables
    }

    /// Makes the present instant a row.
    fn push_now(&mut self) {
        let (time, mut values) = (self.simulation.time(), vec![0.0; self.variables.len()]);
        self.simulation.evaluate(&self.variables, &mut values);
        self.ready.push_back(ResultRow { time, values });
    }

    /// Follows a phase and makes its rows; where a force ends it, with one there.
    fn follow(&mut self, phase: &Phase) -> Result<(), SimulationError> {
        let count = if phase.is_row { 1 } else { self.of_phase };
        // The last is the end itself: a row later by a rounding would never be reached.
        let share = |i: u32| if i == count { 1.0 } else { f64::from(i) / f64::from(count) };
        let times: Vec<f64> = (1..=count).map(|i| phase.duration * share(i)).collect();
        let (start, motion, force) = (self.simulation.time(), phase.motion(self.area), phase.end_force(self.area));
        let Self { simulation, variables, ready, .. } = self;
        let reached = simulation.advance_observed(&motion, force, &times, |s, snapshot| {
            let mut values = vec![0.0; variables.len()];
            snapshot.evaluate(variables, &mut values);
            ready.push_back(ResultRow { time: start + s, values });
        })?;
        if reached.is_some() {
            self.push_now();
        }
        Ok(())
    }
}

/// An error ends the rows.
impl Iterator for ResultRows {
    type Item = Result<ResultRow, SimulationError>;

    fn next(&mut self) -> Option<Self::Item> {
        while self.ready.is_empty() {
            let phase = self.phases.next()?;
            if let Err(error) = self.follow(&phase) {
                self.phases = Vec::new().into_iter();
                self.ready.clear();
                return Some(Err(error));
            }
        }
        self.ready.pop_front().map(Ok)
    }
}
