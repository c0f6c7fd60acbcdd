//! Runs a scene along its excitation, phase by phase, with rows at even intervals of each phase.

use std::ops::ControlFlow;

use asperity::math::{NotEnoughMemory, check_memory};
use asperity::outputs::{Snapshot, variables};
use asperity::scene::{Force, Input, Phase, Scene};
use asperity::simulation::{MethodSwitch, Motion, Simulation, SimulationError, Start, passed_phase};
use clap::Args;
use serde::{Deserialize, Serialize};

use crate::progress::Stop;
use crate::values::count;

// Which rows a run along the excitation has. Not a doc comment: that would be the description of the command.
#[expect(missing_docs, reason = "clap would print it")]
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Args)]
pub struct RunOptions {
    /// Number of result rows for each phase of the excitation.
    #[arg(long, value_name = "N", default_value_t = 50, value_parser = count)]
    pub rows: u32,
    // Times of rows besides these, s.
    #[arg(skip)]
    #[serde(default)]
    pub times: Vec<f64>,
}

/// Time and inputs at a row: displacements of the carrier or of a body's drive, forces on a body.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct InputSample {
    /// Time, s.
    pub time: f64,
    /// Displacement along x, m.
    pub u: f64,
    /// Displacement along z, m.
    pub w: f64,
    /// Load on a body without its constant part, N.
    pub load: f64,
    /// Tangential force on a body without its constant part, N.
    pub pull: f64,
    /// Temperature of the layer where it is an input, K; else 0.
    pub temperature: f64,
}

impl InputSample {
    /// The sample a time `s` (s) after this one, at which `motion` starts.
    pub fn after(self, motion: &Motion, s: f64) -> Self {
        let force = |force: Force, reached: f64| force.start.unwrap_or(reached) + force.change.at(s).position;
        Self {
            time: self.time + s,
            u: self.u + motion.u.at(s).position,
            w: self.w + motion.w.at(s).position,
            load: force(motion.load, self.load),
            pull: force(motion.pull, self.pull),
            temperature: motion.temperature.unwrap_or(self.temperature),
        }
    }

    /// The value of an input.
    pub fn input(&self, input: Input) -> f64 {
        match input {
            Input::U => self.u,
            Input::W => self.w,
            Input::Load => self.load,
            Input::Pull => self.pull,
            Input::Temperature => self.temperature,
        }
    }
}

/// Number of even intervals that a phase is divided into.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rows {
    /// This number for every phase.
    PerPhase(u32),
    /// The fewest intervals of at most `longest`, each divided into `parts`.
    Within {
        /// Longest interval, s.
        longest: f64,
        /// Parts of each, 1 or more.
        parts: u32,
    },
}

impl Rows {
    /// Number of intervals of a phase of `duration` (s); 0 for a phase without duration.
    pub fn intervals(self, duration: f64) -> u32 {
        /// Relative rounding error of a duration that is a multiple of the interval.
        const ROUNDING: f64 = 1e-9;
        match self {
            _ if duration <= 0.0 => 0,
            Self::PerPhase(points) => points,
            Self::Within { longest, parts } => (duration / longest * (1.0 - ROUNDING)).ceil() as u32 * parts,
        }
    }

    /// Rows of a run of `scene`.
    pub fn count(self, scene: &Scene) -> u64 {
        let of_phase = |phase: &Phase| if phase.is_row { 1 } else { u64::from(self.intervals(phase.duration)) };
        1 + scene.excitation.iter().map(of_phase).sum::<u64>()
    }

    /// Checks that the result, with `more` numbers a row than the scene's variables, is no larger than the memory of the
    /// machine: whoever reads it needs that.
    ///
    /// # Errors
    /// [`NotEnoughMemory`].
    pub fn check(self, scene: &Scene, more: usize) -> Result<(), NotEnoughMemory> {
        /// Of a number, with those of pictures.
        const BYTES: u64 = 24;
        let columns = (1 + scene.inputs().len() + variables(scene).len() + more) as u64;
        let rows = self.count(scene);
        check_memory(rows.saturating_mul(columns).saturating_mul(BYTES), || {
            format!("`rows`: {rows} rows of {columns} numbers")
        })
    }

    /// Ends of the intervals of a phase of `duration` (s), in s from its start. The last is the duration itself: a row
    /// later by a rounding error would never be reached.
    pub fn times(self, duration: f64) -> impl Iterator<Item = f64> {
        let count = self.intervals(duration);
        (1..=count).map(move |i| if i == count { duration } else { duration * f64::from(i) / f64::from(count) })
    }
}

/// The start with the carrier at `u` (m), moving as the first phase of the excitation begins.
pub fn start(scene: &Scene, u: f64) -> Start {
    Start { u, ..Start::of(scene) }
}

/// A simulation that follows phases of motion.
#[derive(Debug)]
pub struct Runner {
    simulation: Simulation,
    carrier: InputSample,
    rows: Rows,
    /// Times of rows besides those, s.
    also_at: Vec<f64>,
    /// Number of phases followed so far.
    phases: usize,
    scene: Scene,
    /// Of phases that ended before their force was reached, or as they began.
    warnings: Vec<String>,
    stop: Stop,
}

impl Runner {
    /// Starts a run of `scene` with the carrier at `u` (m), moving as the first phase begins.
    ///
    /// # Errors
    /// As for [`Simulation::new`].
    pub fn new(scene: &Scene, rows: Rows, u: f64) -> Result<Self, SimulationError> {
        rows.check(scene, 0)?;
        let start = start(scene, u);
        let temperature = start.temperature.unwrap_or(scene.input_start(Input::Temperature));
        let carrier =
            InputSample { time: start.time, u: start.u, w: start.w, load: start.load, pull: start.pull, temperature };
        let mut simulation = Simulation::new(scene, &start)?;
        simulation.record_method_switches(true);
        let stop = Stop::default();
        simulation.set_interrupt(Some(stop.interrupt()));
        Ok(Self {
            simulation,
            carrier,
            rows,
            also_at: Vec::new(),
            phases: 0,
            scene: scene.clone(),
            warnings: Vec::new(),
            stop,
        })
    }

    /// The run with rows at `times` (s) too.
    pub fn with_rows_at(self, times: Vec<f64>) -> Self {
        Self { also_at: times, ..self }
    }

    /// The run, which `stop` ends between two steps.
    pub fn stopped_by(mut self, stop: &Stop) -> Self {
        self.stop = stop.clone();
        self.simulation.set_interrupt(Some(stop.interrupt()));
        self
    }

    /// The simulation as it stands.
    pub fn simulation(&mut self) -> &mut Simulation {
        &mut self.simulation
    }

    /// The changes between event-driven and time-stepping driver since the last call; only method *auto* has any.
    pub fn take_method_switches(&mut self) -> Vec<MethodSwitch> {
        self.simulation.take_method_switches()
    }

    /// The warnings since the last call, without those of the scene: of phases that ended before their force was reached, or
    /// as they began.
    pub fn take_warnings(&mut self) -> Vec<String> {
        std::mem::take(&mut self.warnings)
    }

    /// Calls `observe` at the current time, then follows `phases` and calls it at their rows. Returns the actual
    /// durations of the phases, s: a phase that a force ends may be shorter than its nominal duration.
    ///
    /// # Errors
    /// As for [`Simulation::advance`], and [`SimulationError::Interrupted`] where `observe` breaks off; the simulation then
    /// stands at the start of the phase that failed.
    pub fn run(
        &mut self,
        phases: &[Phase],
        mut observe: impl FnMut(InputSample, &Snapshot<'_>) -> ControlFlow<()>,
    ) -> Result<Vec<f64>, SimulationError> {
        let stop = self.stop.clone();
        self.observe_now(|carrier, snapshot| {
            let _ = stop.heed(observe(carrier, snapshot));
        });
        phases.iter().map(|phase| self.run_phase(phase, &mut observe)).collect()
    }

    /// Calls `observe` at the current time.
    pub fn observe_now(&mut self, mut observe: impl FnMut(InputSample, &Snapshot<'_>)) {
        observe(self.carrier, &self.simulation.snapshot());
    }

    /// Follows one phase and calls `observe` at its rows. Returns the actual duration, s.
    ///
    /// # Errors
    /// As for [`run`](Self::run).
    pub fn run_phase(
        &mut self,
        phase: &Phase,
        mut observe: impl FnMut(InputSample, &Snapshot<'_>) -> ControlFlow<()>,
    ) -> Result<f64, SimulationError> {
        let area = self.scene.layer.area();
        let (motion, force) = (phase.motion(area), phase.end_force(area));
        let reached = self.time_of_force(&motion, force)?;
        self.phases += 1;
        self.warn_of_end(phase, force, reached);
        let duration = reached.unwrap_or(phase.duration);
        if duration <= 0.0 {
            return Ok(0.0);
        }
        let rows = if phase.is_row { Rows::PerPhase(1) } else { self.rows };
        let times = self.times(rows, duration);
        let start = self.carrier;
        let stop = &self.stop;
        let observe = |s: f64, snapshot: &Snapshot<'_>| {
            // There may be other rows within the step.
            if stop.go_on().is_continue() {
                let _ = stop.heed(observe(start.after(&motion, s), snapshot));
            }
        };
        self.simulation.advance_observed(&Motion { duration, ..motion }, None, &times, observe)?;
        self.carrier = InputSample { time: self.simulation.time(), ..start.after(&motion, duration) };
        Ok(duration)
    }

    /// Warns where the phase that begins now never reaches its force, or has passed it, unless the scene's warnings have that.
    fn warn_of_end(&mut self, phase: &Phase, force: Option<f64>, reached: Option<f64>) {
        let warning = match (force, reached) {
            (Some(_), None) => missed_force(self.phases, phase),
            (Some(_), Some(s)) if s <= 0.0 => {
                let force = self.simulation.snapshot().on_carrier.z;
                passed_phase(&self.scene, phase, self.phases - 1, force)
            }
            _ => return,
        };
        if !self.scene.warnings.contains(&warning) {
            self.warnings.push(warning);
        }
    }

    /// Times of the rows of a phase of `duration` (s) that begins now, in s from its start.
    fn times(&self, rows: Rows, duration: f64) -> Vec<f64> {
        /// Share of the duration by which a time differs from that of a row by rounding.
        const ROUNDING: f64 = 1e-9;
        let mut times: Vec<f64> = rows.times(duration).collect();
        for s in self.also_at.iter().map(|time| time - self.carrier.time) {
            let is_there = |other: &f64| (other - s).abs() <= ROUNDING * duration;
            if ROUNDING * duration < s && s < duration && !times.iter().any(is_there) {
                times.push(s);
            }
        }
        times.sort_by(f64::total_cmp);
        times
    }

    /// The time at which F_z rises to `force` (N), in s from the start of the motion. A copy of the simulation finds
    /// it, so that rows can divide the phase evenly.
    fn time_of_force(&self, motion: &Motion, force: Option<f64>) -> Result<Option<f64>, SimulationError> {
        force.map_or(Ok(None), |force| self.simulation.clone().advance_observed(motion, Some(force), &[], |_, _| ()))
    }
}

/// The warning that phase `number`, counted from 1, ended before its force was reached.
fn missed_force(number: usize, phase: &Phase) -> String {
    let end = match (phase.until_force, phase.until_pressure) {
        (None, Some(pressure)) => format!("F_z over the layer's area did not rise to until_pressure = {pressure} Pa"),
        (force, _) => format!("F_z did not rise to until_force = {} N", force.unwrap_or_default()),
    };
    format!("phase {number} of the excitation: {end} within {} s", phase.duration)
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn the_last_row_is_the_end_despite_rounding() {
        const POINTS: u32 = 50;
        let mut above = 0;
        for duration in (1..200).map(|i| 1e-6 * f64::from(i)) {
            above += usize::from(duration * f64::from(POINTS) / f64::from(POINTS) > duration);
            let times: Vec<f64> = Rows::PerPhase(POINTS).times(duration).collect();
            assert_eq!((times.len(), times.last()), (POINTS as usize, Some(&duration)));
        }
        assert!(above > 0, "no duration is rounded up");
    }

    /// Half of the sine stands in the rubber, and the second phase presses no further than the first.
    #[test]
    fn phases_that_end_as_they_begin_are_told_once() {
        let text = |clearance: f64, end: f64| {
            format!(
                "name = 's'\nlayer = {{ masses = 8, spacing = 4e-5, width = 1e-2, foundation = 'half_space', clearance = {clearance} }}\n\
                 material = {{ density = 1.1e3, poisson_ratio = 0.49, equilibrium_modulus = 6e6, prony = [] }}\n\
                 surface = {{ kind = 'sinusoid', amplitude = 2e-5, wavelength = 3.2e-4 }}\n\
                 excitation = [{{ duration = 5e-3, w_rate = -0.01, until_pressure = 5e4 }}, {{ duration = 1e-5 }}, \
                 {{ duration = 1e-3, w_rate = -0.01, until_pressure = {end} }}]"
            )
        };
        let found = |clearance: f64, end: f64| {
            let scene = crate::files::parse_scene(&text(clearance, end), "s.toml".as_ref(), &[]).unwrap();
            let mut runner = Runner::new(&scene, Rows::PerPhase(1), 0.0).unwrap();
            runner.run(&scene.excitation, |_, _| ControlFlow::Continue(())).unwrap();
            let of_scene = scene.warnings.iter().filter(|text| text.starts_with("phase 1 ")).count();
            (of_scene, runner.take_warnings())
        };
        assert_eq!(found(0.0, 1e9).0, 1);
        assert!(!found(0.0, 1e9).1.iter().any(|text| text.starts_with("phase 1 of the excitation ends as it begins")));
        let (of_scene, of_run) = found(3e-5, 1e4);
        assert_eq!((of_scene, of_run.len()), (0, 1), "{of_run:?}");
        assert!(of_run[0].starts_with("phase 3 of the excitation ends as it begins"), "{of_run:?}");
    }

    #[test]
    fn intervals_are_no_longer_than_asked_for_and_divide_evenly() {
        let rows = |parts| Rows::Within { longest: 1e-5, parts };
        assert_eq!([0.0, 1e-5, 3.0 * 1e-5, 3.1e-5, 1e-9].map(|duration| rows(1).intervals(duration)), [0, 1, 3, 4, 1]);
        let (coarse, fine): (Vec<_>, Vec<_>) = (rows(1).times(7.7e-5).collect(), rows(4).times(7.7e-5).collect());
        assert_eq!(coarse, fine.chunks(4).map(|part| part[3]).collect::<Vec<_>>());
    }
}
