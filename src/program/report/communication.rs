//! What a user of the FMU meets: a carrier that follows the excitation through a master's values, with rates and
//! without, at ever shorter communication steps. The rules are the FMU's own.

use asperity::fmi::{Carrier as Inputs, Input, InputOutOfRange};
use asperity::scene::{Phase, Scene};
use asperity::simulation::{Simulation, SimulationError};
use cpu_time::ThreadTime;

use super::ladder::Figures;
use super::progress::{Progress, weight};
use super::reference::{Comparison, Reference};
use super::runs::{Measured, Recorder, at_tolerance, exact, run};
use super::trace::{Errors, Trace};
use crate::program::excitation::{Carrier, Rows};

/// The longest communication step is about this part of the excitation.
const LONGEST: f64 = 1.0 / 64.0;
/// Each rung halves the one before.
const RUNGS: u32 = 7;

/// What a master gives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Given {
    /// Values and rates at the communication point.
    Rates,
    /// Values alone.
    Values,
    /// No master: the program follows the excitation itself.
    Motion,
}

/// A row of the table of errors and communication steps.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Row {
    /// What the master gives.
    pub(super) given: Given,
    /// The communication step, s; `None` without a master.
    pub(super) step: Option<f64>,
    /// What came of it, or why nothing did.
    pub(super) result: Result<(Figures, Option<Errors>), String>,
}

impl Given {
    /// In the words of the table.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Rates => "values and rates",
            Self::Values => "values alone",
            Self::Motion => "no master",
        }
    }
}

/// What the ladder weighs, for a reference and a scene at these tolerances.
pub(super) fn ladder_weight(reference: f64, scene: f64) -> f64 {
    weight(reference) + f64::from(2 * RUNGS + 1) * weight(scene)
}

/// Runs the ladder at the scene's own tolerance and method.
pub(super) fn climb(reference: &Reference, progress: &Progress) -> Vec<Row> {
    let scene = &reference.scene;
    let longest = round_down(LONGEST * scene.duration());
    let finest = 1 << (RUNGS - 1);
    let rows = Rows::Within { longest, parts: finest };
    let tight = exact(&at_tolerance(scene, reference.tolerance));
    let message = "reference at the communication points";
    let tight = progress.during(message, weight(reference.tolerance), |tick| run(&tight, rows, 0.0, tick));
    let Ok(tight) = tight.map(|measured| measured.trace) else { return Vec::new() };
    let compare = |given, step, measured: Result<Measured, String>, parts: u32| {
        let compared = measured.map(|measured| compared(&measured, &tight.every((finest / parts) as usize), reference));
        Row { given, step, result: compared }
    };
    let own = progress.during("no master", weight(scene.solver.relative_tolerance), |tick| run(scene, rows, 0.0, tick));
    let mut table = Vec::new();
    for given in [Given::Rates, Given::Values] {
        for parts in (0..RUNGS).map(|rung| 1 << rung) {
            let step = longest / f64::from(parts);
            let message = format!("{}, communication step {step:.3e} s", given.name());
            let weight = weight(scene.solver.relative_tolerance);
            let rows = Rows::Within { longest, parts };
            let measured = progress.during(&message, weight, |tick| drive(scene, given, rows, tick));
            table.push(compare(given, Some(step), measured, parts));
        }
    }
    let mut own = compare(Given::Motion, None, own.map_err(|error| error.to_string()), finest);
    if let Ok((figures, _)) = &mut own.result {
        // It was spent on the rows: there are as many as communication points at the finest.
        figures.time = None;
    }
    table.push(own);
    table
}

/// The figures of a run and, where runs can be compared row by row, the root mean squares of its errors.
fn compared(measured: &Measured, tight: &Trace, reference: &Reference) -> (Figures, Option<Errors>) {
    let (counts, trace) = (&measured.counts, &measured.trace);
    let (errors, mean_square) = match reference.comparison {
        Comparison::Pointwise(_) => (trace.largest(tight), Some(trace.mean_square(tight))),
        Comparison::Means(_) => (trace.means(tight), None),
    };
    let figures = Figures {
        errors,
        time: Some(measured.time),
        steps: Some(counts.steps),
        rejected: Some(counts.rejected),
        events: Some(counts.events),
        iterations: Some(counts.iterations),
        residual: Some(counts.residual),
    };
    (figures, mean_square)
}

/// Drives `scene` as a master drives the FMU: communication points at the `rows`, the ends of phases among them.
fn drive(scene: &Scene, given: Given, rows: Rows, tick: &dyn Fn(f64)) -> Result<Measured, String> {
    let whole = scene.duration();
    let mut master = Master::new(scene, given, 0.0).map_err(|error| error.to_string())?;
    let clock = ThreadTime::now();
    for phase in &scene.excitation {
        let start = master.carrier;
        let mut from = 0.0;
        for to in rows.times(phase.duration) {
            master.step(phase, start, (from, to)).map_err(|error| error.to_string())?;
            from = to;
            tick(master.carrier.time / whole);
        }
    }
    let durations: Vec<f64> = scene.excitation.iter().map(|phase| phase.duration).collect();
    let time = clock.elapsed().as_secs_f64();
    let (values, counts) = master.recorder.finish(&master.simulation);
    Ok(Measured { trace: Trace::new(values, &durations, rows), counts, time, durations })
}

/// Why a communication step is not done.
#[derive(Debug, thiserror::Error)]
#[error(transparent)]
pub(super) enum StepError {
    /// What the master gave.
    Input(#[from] InputOutOfRange),
    /// What the run met.
    Run(#[from] SimulationError),
}

/// A master with the unit that it drives.
#[derive(Debug)]
pub(super) struct Master<'a> {
    scene: &'a Scene,
    given: Given,
    inputs: Inputs,
    pub(super) simulation: Simulation,
    pub(super) recorder: Recorder,
    /// Where the excitation stands at the communication point.
    pub(super) carrier: Carrier,
}

impl<'a> Master<'a> {
    /// The carrier at `u` (m) at time 0.
    pub(super) fn new(scene: &'a Scene, given: Given, u: f64) -> Result<Self, SimulationError> {
        let mut inputs = Inputs::default();
        inputs.set_input(Input::U, u);
        if let Some(phase) = scene.excitation.first().filter(|_| given == Given::Rates) {
            set_rates(&mut inputs, phase, 0.0);
        }
        let mut simulation = Simulation::new(scene, &inputs.start(0.0))?;
        let mut recorder = Recorder::new(scene);
        recorder.row(&mut simulation);
        let carrier = Carrier { time: 0.0, u, w: 0.0 };
        Ok(Self { scene, given, inputs, simulation, recorder, carrier })
    }

    /// Gives what there is to give at the communication point and does the step between two times of the phase, s after
    /// it began at `start`.
    pub(super) fn step(&mut self, phase: &Phase, start: Carrier, (from, to): (f64, f64)) -> Result<(), StepError> {
        self.inputs.set_input(Input::U, self.carrier.u);
        self.inputs.set_input(Input::W, self.carrier.w);
        if self.given == Given::Rates {
            set_rates(&mut self.inputs, phase, from);
        }
        let (stands, h) = (self.simulation.carrier(), to - from);
        let motion = self.inputs.motion(stands, self.carrier.time, h, self.scene.extrapolation)?;
        self.simulation.advance(&motion)?;
        self.inputs.count_step(h);
        self.recorder.row(&mut self.simulation);
        self.carrier = start.moved(phase, to);
        Ok(())
    }
}

fn set_rates(inputs: &mut Inputs, phase: &Phase, s: f64) {
    inputs.set_rate(Input::U, phase.u.velocity(s));
    inputs.set_rate(Input::W, phase.w.velocity(s));
}

/// The largest of 1, 2 and 5 times a power of ten that is not above `value`.
fn round_down(value: f64) -> f64 {
    let decade = value.log10().floor();
    let factor = [5.0, 2.0, 1.0].into_iter().find(|factor| factor * 10_f64.powf(decade) <= value * 1.001);
    // Written and read, so that it is the number nearest to what is written.
    let written = format!("{}e{decade}", factor.unwrap_or(1.0));
    written.parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_longest_step_is_a_round_one() {
        assert_eq!([8.6e-5, 1e-3, 4.9e-2, 3.0].map(round_down), [5e-5, 1e-3, 2e-2, 2.0]);
    }
}
