//! The excitation of a scene, followed phase by phase.

use asperity::scene::{Phase, Scene};
use asperity::simulation::{Motion, Simulation, SimulationError, Start};

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

/// A run of a scene along its excitation.
#[derive(Debug)]
pub(crate) struct Run {
    simulation: Simulation,
    carrier: Carrier,
    points: u32,
}

impl Run {
    /// The layer under the carrier at time 0, moving as the first phase begins.
    pub(crate) fn new(scene: &Scene, points: u32) -> Result<Self, SimulationError> {
        let first = scene.excitation.first();
        let start = Start {
            u_rate: first.map_or(0.0, |phase| phase.u.velocity(0.0)),
            w_rate: first.map_or(0.0, |phase| phase.w.velocity(0.0)),
            ..Start::default()
        };
        let carrier = Carrier { time: start.time, u: start.u, w: start.w };
        Ok(Self { simulation: Simulation::new(scene, &start)?, carrier, points })
    }

    /// Calls `observe` at the start and then at `points` even intervals of the time that each phase really takes.
    pub(crate) fn follow(
        &mut self,
        phases: &[Phase],
        mut observe: impl FnMut(Carrier, &mut Simulation),
    ) -> Result<(), SimulationError> {
        observe(self.carrier, &mut self.simulation);
        phases.iter().enumerate().try_for_each(|(i, phase)| self.follow_phase(i, phase, &mut observe))
    }

    fn follow_phase(
        &mut self,
        index: usize,
        phase: &Phase,
        observe: &mut impl FnMut(Carrier, &mut Simulation),
    ) -> Result<(), SimulationError> {
        let motion = Motion { duration: phase.duration, u: phase.u, w: phase.w };
        let reached = self.time_of_force(&motion, phase.until_force)?;
        if phase.until_force.is_some() && reached.is_none() {
            warn_of_force(index, phase);
        }
        let duration = reached.unwrap_or(phase.duration);
        if duration <= 0.0 {
            return Ok(());
        }
        let times = even_times(duration, self.points);
        let start = self.carrier;
        let at = |s: f64| start.moved(phase, s);
        let show = |s: f64, simulation: &mut Simulation| observe(at(s), simulation);
        match phase.until_force.filter(|_| reached.is_some()) {
            Some(force) => self.simulation.advance_until_force(&motion, force, &times, show).map(|_| ())?,
            None => self.simulation.advance_observed(&motion, &times, show)?,
        }
        self.carrier = Carrier { time: self.simulation.time(), ..at(duration) };
        Ok(())
    }

    /// When F_z rises to `force`. Found on a copy, which takes the very same steps, so that the rows can divide the phase
    /// evenly.
    fn time_of_force(&self, motion: &Motion, force: Option<f64>) -> Result<Option<f64>, SimulationError> {
        force.map_or(Ok(None), |force| self.simulation.clone().advance_until_force(motion, force, &[], |_, _| ()))
    }
}

fn warn_of_force(index: usize, phase: &Phase) {
    let force = phase.until_force.unwrap_or_default();
    warn(&format!(
        "phase {} of the excitation: F_z did not rise to until_force = {force} N within {} s",
        index + 1,
        phase.duration
    ));
}

/// The ends of `points` even intervals of `duration` (s). The last is the duration itself: a rounding above it would be a
/// row that the run never comes to.
fn even_times(duration: f64, points: u32) -> Vec<f64> {
    let time = |i| if i == points { duration } else { duration * f64::from(i) / f64::from(points) };
    (1..=points).map(time).collect()
}

impl Carrier {
    /// The carrier a time `s` after the start of `phase`, which began here.
    fn moved(self, phase: &Phase, s: f64) -> Self {
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
            let times = even_times(duration, POINTS);
            assert_eq!((times.len(), times.last()), (POINTS as usize, Some(&duration)));
        }
        assert!(above > 0, "no duration is rounded up");
    }
}
