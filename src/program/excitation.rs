//! The excitation of a scene, followed phase by phase.

use asperity::scene::{Phase, Scene};
use asperity::simulation::{Handover, Motion, Simulation, SimulationError, Start};

use super::warn;

/// The carrier at one row of a result file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Carrier {
    /// Time, s.
    pub(crate) time: f64,
    /// Displacement along x, m.
    pub(crate) u: f64,
    /// Displacement along z, m.
    pub(crate) w: f64,
}

/// How many even intervals a phase is divided into.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Rows {
    /// So many, however long the phase is.
    PerPhase(u32),
    /// The fewest of at most `longest` (s), each divided once more into `parts`.
    Within {
        /// s.
        longest: f64,
        /// How many each is divided into.
        parts: u32,
    },
}

impl Rows {
    /// The intervals of a phase of `duration` (s); of one that takes no time, none.
    pub(crate) fn of(self, duration: f64) -> u32 {
        /// A duration that is a multiple of the interval but for rounding is divided without a rest.
        const ROUNDING: f64 = 1e-9;
        match self {
            _ if duration <= 0.0 => 0,
            Self::PerPhase(points) => points,
            Self::Within { longest, parts } => (duration / longest * (1.0 - ROUNDING)).ceil() as u32 * parts,
        }
    }

    /// The ends of the intervals of a phase of `duration` (s). The last is the duration itself: a rounding above it
    /// would be a row that the run never comes to.
    pub(crate) fn times(self, duration: f64) -> impl Iterator<Item = f64> {
        let count = self.of(duration);
        (1..=count).map(move |i| if i == count { duration } else { duration * f64::from(i) / f64::from(count) })
    }
}

/// The carrier at `u` (m) at time 0, moving as the first phase begins.
pub(crate) fn start(scene: &Scene, u: f64) -> Start {
    let first = scene.excitation.first();
    Start {
        u_rate: first.map_or(0.0, |phase| phase.u.velocity(0.0)),
        w_rate: first.map_or(0.0, |phase| phase.w.velocity(0.0)),
        u,
        ..Start::default()
    }
}

/// A run of a scene along its excitation.
#[derive(Debug)]
pub(crate) struct Run {
    simulation: Simulation,
    carrier: Carrier,
    rows: Rows,
    /// Of the layer, m², if the scene gives it.
    area: Option<f64>,
}

impl Run {
    /// The layer under the carrier at time 0, moving as the first phase begins.
    pub(crate) fn new(scene: &Scene, rows: Rows) -> Result<Self, SimulationError> {
        Self::displaced(scene, rows, 0.0)
    }

    /// The same with the carrier at `u` (m) instead of 0.
    pub(crate) fn displaced(scene: &Scene, rows: Rows, u: f64) -> Result<Self, SimulationError> {
        let start = start(scene, u);
        let carrier = Carrier { time: start.time, u: start.u, w: start.w };
        let mut simulation = Simulation::new(scene, &start)?;
        simulation.record_handovers(true);
        Ok(Self { simulation, carrier, rows, area: scene.layer.area() })
    }

    /// Between which drivers the run went to and fro since the last call: of the method *auto* alone.
    pub(crate) fn take_handovers(&mut self) -> Vec<Handover> {
        self.simulation.take_handovers()
    }

    /// The simulation where the run stands.
    pub(crate) fn simulation(&self) -> &Simulation {
        &self.simulation
    }

    /// Calls `observe` at the start and then at even intervals of the time that each phase really takes. Returns these
    /// times, s.
    pub(crate) fn follow(
        &mut self,
        phases: &[Phase],
        mut observe: impl FnMut(Carrier, &mut Simulation),
    ) -> Result<Vec<f64>, SimulationError> {
        observe(self.carrier, &mut self.simulation);
        phases.iter().enumerate().map(|(i, phase)| self.follow_phase(i, phase, &mut observe)).collect()
    }

    fn follow_phase(
        &mut self,
        index: usize,
        phase: &Phase,
        observe: &mut impl FnMut(Carrier, &mut Simulation),
    ) -> Result<f64, SimulationError> {
        let motion = Motion { duration: phase.duration, u: phase.u, w: phase.w };
        let force = phase.end_force(self.area);
        let reached = self.time_of_force(&motion, force)?;
        if force.is_some() && reached.is_none() {
            warn_of_force(index, phase);
        }
        let duration = reached.unwrap_or(phase.duration);
        if duration <= 0.0 {
            return Ok(0.0);
        }
        let times: Vec<f64> = self.rows.times(duration).collect();
        let start = self.carrier;
        let at = |s: f64| start.moved(phase, s);
        let show = |s: f64, simulation: &mut Simulation| observe(at(s), simulation);
        self.simulation.advance_observed(&Motion { duration, ..motion }, &times, show)?;
        self.carrier = Carrier { time: self.simulation.time(), ..at(duration) };
        Ok(duration)
    }

    /// When F_z rises to `force`. Found on a copy, so that the rows can divide the phase evenly.
    fn time_of_force(&self, motion: &Motion, force: Option<f64>) -> Result<Option<f64>, SimulationError> {
        force.map_or(Ok(None), |force| self.simulation.clone().advance_until_force(motion, force, &[], |_, _| ()))
    }
}

fn warn_of_force(index: usize, phase: &Phase) {
    let end = match (phase.until_force, phase.until_pressure) {
        (None, Some(pressure)) => format!("F_z over the layer's area did not rise to until_pressure = {pressure} Pa"),
        (force, _) => format!("F_z did not rise to until_force = {} N", force.unwrap_or_default()),
    };
    warn(&format!("phase {} of the excitation: {end} within {} s", index + 1, phase.duration));
}

impl Carrier {
    /// The carrier a time `s` after the start of `phase`, which began here.
    pub(crate) fn moved(self, phase: &Phase, s: f64) -> Self {
        Self { time: self.time + s, u: self.u + phase.u.at(s), w: self.w + phase.w.at(s) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_row_is_the_end_whatever_rounding_makes_of_it() {
        const POINTS: u32 = 50;
        let mut above = 0;
        for duration in (1..200).map(|i| 1e-6 * f64::from(i)) {
            above += usize::from(duration * f64::from(POINTS) / f64::from(POINTS) > duration);
            let times: Vec<f64> = Rows::PerPhase(POINTS).times(duration).collect();
            assert_eq!((times.len(), times.last()), (POINTS as usize, Some(&duration)));
        }
        assert!(above > 0, "no duration is rounded up");
    }

    #[test]
    fn intervals_of_a_length_are_no_longer_and_divide_without_a_rest() {
        let rows = |parts| Rows::Within { longest: 1e-5, parts };
        assert_eq!([0.0, 1e-5, 3.0 * 1e-5, 3.1e-5, 1e-9].map(|duration| rows(1).of(duration)), [0, 1, 3, 4, 1]);
        let (coarse, fine): (Vec<_>, Vec<_>) = (rows(1).times(7.7e-5).collect(), rows(4).times(7.7e-5).collect());
        assert_eq!(coarse, fine.chunks(4).map(|part| part[3]).collect::<Vec<_>>());
    }
}
