//! Set-valued friction: stops and breaks found together with the motion of a stage (docs/theory.md, section 10).

use super::super::scheme::ContactModes;
use super::{StagePoint, StageSolver};
use crate::model::{ContactForces, Mode, Model};

impl StageSolver {
    /// Stops the slips that have reversed and breaks the sticks that hold more than T(0), by the velocities and forces
    /// evaluated last. Returns whether a mode has changed.
    pub(super) fn change_modes(&mut self, model: &Model, point: &StagePoint) -> bool {
        if self.modes == ContactModes::Held || !model.friction.present {
            return false;
        }
        let mut changed = false;
        for contact in 0..self.contacts.len() {
            let i = self.contacts[contact];
            let mode = self.mode_by_residual(model, i, point.beta);
            if mode == self.state.mode[i] {
                continue;
            }
            changed = true;
            self.state.mode[i] = mode;
            if mode == Mode::Stick {
                self.stop(model, i, point);
            }
        }
        if changed {
            self.hold_modes(model, point.beta);
            self.evaluate(model, point);
        }
        changed
    }

    /// Puts mass `i` where the stages before have brought it, at rest.
    fn stop(&mut self, model: &Model, i: usize, point: &StagePoint) {
        (self.state.velocity_x[i], self.state.velocity_z[i]) = (0.0, 0.0);
        let elongation = self.history.elongation_x[i] - point.moved;
        self.state.surface[i] = model.surface_at(model.rest_x[i] + (point.profile_position() + elongation));
    }

    /// The mode in which the residual of contact `i` can vanish: a slip goes on in its direction, and a mass at rest
    /// may need at most T(0) to be held, its momentum m v*/β included.
    fn mode_by_residual(&self, model: &Model, i: usize, beta: f64) -> Mode {
        let (mode, v) = (self.state.mode[i], self.state.velocity_x[i]);
        if mode.slips() {
            return if mode.direction() * v < 0.0 { Mode::Stick } else { mode };
        }
        let (surface, history) = (&self.state.surface[i], self.slip_history(i));
        let contact = ContactForces::new(model, self.forces.on_mass(i), 0.0, surface, &history);
        let held = contact.tangential + model.mass * contact.q * self.history.velocity_x[i] / beta;
        if held.abs() > contact.limit.max(0.0) { Mode::along(held) } else { Mode::Stick }
    }

    /// A mass that stuck at the stage before goes on from rest: friction has taken up its momentum.
    pub(super) fn start_sticks_from_rest(&mut self) {
        for &i in &self.sticks {
            self.history.velocity_x[i] = 0.0;
        }
    }
}
