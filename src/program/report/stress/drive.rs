//! A run of a stressed scene within a bound on its work.

use asperity::scene::{Phase, Scene};
use asperity::simulation::{Motion, Simulation, SimulationError};

use crate::program::excitation::{Rows, start};
use crate::program::report::communication::{Given, Master, StepError};
use crate::program::report::runs::{Counts, Recorder};

/// Communication steps of the whole run at the factor 1.
pub(in crate::program::report) const COMMUNICATION_STEPS: f64 = 1000.0;
/// A run that would take more of them is shortened: ...
pub(in crate::program::report) const MOST_COMMUNICATION_STEPS: f64 = 20_000.0;
/// ... in steps of the factor 1 up to its middle, then so many short ones.
pub(in crate::program::report) const SHORT_STEPS: u32 = 2000;

/// How the carrier is moved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Course {
    /// Along the excitation itself, with so many rows for each phase.
    Motion { points: u32 },
    /// By a master, with rates, in communication steps so many times as long as a thousandth of the run.
    Steps(f64),
}

/// A run that came to its end.
#[derive(Clone, Debug)]
pub(super) struct Ran {
    /// F_x and F_z (N) at the rows, E_diss (J).
    pub(super) rows: Vec<[f64; 3]>,
    /// The times of the rows, s.
    pub(super) times: Vec<f64>,
    /// What it took.
    pub(super) counts: Counts,
}

/// Why a run did not come to its end.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Stop {
    /// The bound on its work is used up at this time, s.
    TooMuchWork(f64),
    /// It gave up, or could not go on, for this reason.
    Failed(String),
}

/// The most work that a run may take.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Bound(pub(super) u64);

impl Bound {
    /// The scene with what is left of the bound as its limit, unless its own is lower.
    fn limit(self, scene: &Scene) -> Scene {
        let mut scene = scene.clone();
        scene.solver.max_steps = scene.solver.max_steps.min(self.0);
        scene
    }

    /// Whether the steps so far are within it.
    fn check(self, recorder: &Recorder, simulation: &Simulation) -> Result<(), Stop> {
        let used_up = recorder.counts().work() > self.0;
        if used_up { Err(Stop::TooMuchWork(simulation.time())) } else { Ok(()) }
    }

    /// What an error means under the bound, for a scene with limits of its own.
    fn stop(self, scene: &Scene, error: &SimulationError) -> Stop {
        match error {
            SimulationError::TooManySteps { time, .. } if self.0 <= scene.solver.max_steps => Stop::TooMuchWork(*time),
            error => Stop::Failed(error.to_string()),
        }
    }
}

impl Course {
    /// Runs `scene`, whose phases no force ends, from the carrier at `u` (m).
    pub(super) fn run(self, scene: &Scene, u: f64, bound: Bound) -> Result<Ran, Stop> {
        match self {
            Self::Motion { points } => follow(scene, Rows::PerPhase(points), u, bound),
            Self::Steps(factor) => drive(scene, &Plan::new(scene, factor), u, bound),
        }
    }

    /// Communication steps, each of which needs a step at least.
    pub(super) fn steps(self, scene: &Scene) -> u64 {
        match self {
            Self::Motion { .. } => 0,
            Self::Steps(factor) => Plan::new(scene, factor).count(scene),
        }
    }
}

fn follow(scene: &Scene, rows: Rows, u: f64, bound: Bound) -> Result<Ran, Stop> {
    let failed = |error: SimulationError| bound.stop(scene, &error);
    let mut recorder = Recorder::new(scene);
    let mut simulation = Simulation::new(&bound.limit(scene), &start(scene, u)).map_err(failed)?;
    recorder.row(&mut simulation);
    let mut at = vec![simulation.time()];
    for phase in scene.excitation.iter().filter(|phase| phase.duration > 0.0) {
        let motion = Motion { duration: phase.duration, u: phase.u, w: phase.w };
        let times: Vec<f64> = rows.times(phase.duration).collect();
        let observe = |_, simulation: &mut Simulation| {
            recorder.row(simulation);
            at.push(simulation.time());
        };
        simulation.advance_observed(&motion, &times, observe).map_err(failed)?;
        bound.check(&recorder, &simulation)?;
    }
    Ok(finish(recorder, at, &simulation))
}

fn drive(scene: &Scene, plan: &Plan, u: f64, bound: Bound) -> Result<Ran, Stop> {
    let failed = |error: StepError| match error {
        StepError::Run(error) => bound.stop(scene, &error),
        StepError::Input(error) => Stop::Failed(error.to_string()),
    };
    let limited = bound.limit(scene);
    let mut master = Master::new(&limited, Given::Rates, u).map_err(|error| failed(error.into()))?;
    let mut at = vec![master.simulation.time()];
    for (i, phase) in plan.phases(scene).enumerate() {
        let start = master.carrier;
        let mut from = 0.0;
        for to in plan.points(i, phase.duration) {
            master.step(phase, start, (from, to)).map_err(failed)?;
            bound.check(&master.recorder, &master.simulation)?;
            at.push(master.simulation.time());
            from = to;
        }
    }
    Ok(finish(master.recorder, at, &master.simulation))
}

fn finish(recorder: Recorder, times: Vec<f64>, simulation: &Simulation) -> Ran {
    let (rows, counts) = recorder.finish(simulation);
    Ran { rows, times, counts }
}

/// Where a master has its communication points.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Plan {
    /// The communication step, s.
    step: f64,
    /// Where all are not alike: how long those before the short ones are, s, and the phase in whose middle these begin.
    shortened: Option<(f64, usize)>,
}

impl Plan {
    fn new(scene: &Scene, factor: f64) -> Self {
        let base = scene.duration() / COMMUNICATION_STEPS;
        let phases = scene.excitation.iter().enumerate();
        let longest = phases.max_by(|(_, a), (_, b)| a.duration.total_cmp(&b.duration)).map_or(0, |(i, _)| i);
        let many = COMMUNICATION_STEPS / factor > MOST_COMMUNICATION_STEPS;
        Self { step: base * factor, shortened: many.then_some((base, longest)) }
    }

    /// The phases that are run.
    fn phases<'a>(&self, scene: &'a Scene) -> impl Iterator<Item = &'a Phase> + use<'a> {
        let last = self.shortened.map_or(usize::MAX, |(_, last)| last);
        scene.excitation.iter().take(last.saturating_add(1))
    }

    /// The communication points of phase `i`, s after it begins; its end is one of them, unless the run ends before it.
    fn points(&self, i: usize, duration: f64) -> Vec<f64> {
        let even = |longest: f64, duration: f64| Rows::Within { longest, parts: 1 }.times(duration);
        match self.shortened {
            None => even(self.step, duration).collect(),
            Some((base, last)) if i < last => even(base, duration).collect(),
            Some((base, _)) => {
                let middle = 0.5 * duration;
                let short = (1..=SHORT_STEPS).map(|j| middle + f64::from(j) * self.step);
                even(base, middle).chain(short.take_while(|&point| point <= duration)).collect()
            }
        }
    }

    fn count(&self, scene: &Scene) -> u64 {
        self.phases(scene).enumerate().map(|(i, phase)| self.points(i, phase.duration).len() as u64).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plan(step: f64, shortened: Option<(f64, usize)>) -> Plan {
        Plan { step, shortened }
    }

    #[test]
    fn a_master_steps_evenly_through_each_phase() {
        assert_eq!(plan(0.25, None).points(0, 1.0), [0.25, 0.5, 0.75, 1.0]);
        assert_eq!(plan(1e6, None).points(0, 1.0), [1.0]);
    }

    #[test]
    fn many_steps_are_short_ones_from_the_middle_on() {
        let shortened = plan(1e-6, Some((0.125, 1)));
        assert_eq!(shortened.points(0, 0.25), [0.125, 0.25]);
        let points = shortened.points(1, 0.5);
        assert_eq!(points[..3], [0.125, 0.25, 0.25 + 1e-6]);
        assert_eq!(points.len(), 2 + SHORT_STEPS as usize);
        // There is no room for all of them in a short phase.
        let points = shortened.points(1, 1e-3);
        assert!(points.len() == 501 && points.iter().all(|&point| point <= 1e-3), "{}", points.len());
    }

    const TEXT: &str = "
name = 'pressed'
[layer]
masses = 2
spacing = 1e-4
mass = 1e-7
[layer.vertical]
stiffness = 1e3
[surface]
kind = 'flat'
[fmu]
outputs = ['forces', 'dissipation', 'energy', 'solver']
[[excitation]]
duration = 1e-3
w_rate = -0.01
[[excitation]]
duration = 1e-3
u_rate = 0.01
";

    #[test]
    fn a_run_ends_at_its_bound_or_gives_up_at_the_scenes_own_limit() {
        let mut scene = Scene::parse(TEXT, "scene.toml".as_ref()).unwrap();
        for course in [Course::Motion { points: 4 }, Course::Steps(100.0)] {
            let ran = course.run(&scene, 0.0, Bound(10_000)).unwrap();
            assert_eq!(ran.rows.len(), ran.times.len());
            assert!((ran.times.last().unwrap() - 2e-3).abs() < 1e-15, "{:?}", ran.times);
            // In the second phase, or after a few of the communication steps.
            let stop = course.run(&scene, 0.0, Bound(ran.counts.work() - 1)).unwrap_err();
            assert!(matches!(stop, Stop::TooMuchWork(time) if time > 1e-3), "{stop:?}");
        }
        scene.solver.max_steps = 2;
        let stop = Course::Motion { points: 4 }.run(&scene, 0.0, Bound(10_000)).unwrap_err();
        assert!(matches!(&stop, Stop::Failed(reason) if reason.contains("solver.max_steps")), "{stop:?}");
    }
}
