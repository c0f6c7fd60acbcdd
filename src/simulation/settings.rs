//! What of a scene a run needs beside the model.

use crate::contact::EventTolerance;
use crate::integrator::{Integrator, Scheme, Tolerance, Tracked};
use crate::model::Model;
use crate::outputs::Accounts;
use crate::scene::{Method, Scene};

/// What of a scene a run needs beside the model.
#[derive(Clone, Debug)]
pub(super) struct Settings {
    pub tolerance: Tolerance,
    pub events: EventTolerance,
    pub max_steps: u64,
    pub accounts: Accounts,
    pub method: Method,
    /// Whether these are the settings of a local region.
    pub is_local: bool,
}

impl Settings {
    pub(super) fn new(scene: &Scene, model: &Model) -> Self {
        let tolerance = Tolerance::new(model, scene.solver.relative_tolerance, scene.absolute_tolerance());
        Self {
            events: EventTolerance::new(model, &tolerance),
            tolerance,
            max_steps: scene.solver.max_steps(),
            accounts: Accounts::new(scene),
            method: scene.solver.method,
            is_local: false,
        }
    }

    /// The settings of a local region of a layer with these.
    pub(super) fn for_local_region(&self) -> Self {
        let accounts = Accounts { energy: self.accounts.energy, ..Accounts::default() };
        Self { accounts, method: Method::Event, is_local: true, ..self.clone() }
    }

    /// An integrator for `model`.
    pub(super) fn integrator(&self, model: &Model) -> Integrator {
        let event_driven = Scheme::event_driven_at(model, self.tolerance.relative);
        let schemes: &[Scheme] = match self.method {
            Method::Event => &[event_driven],
            Method::Step => &[Scheme::Sdirk2],
            Method::Auto => &[event_driven, Scheme::Sdirk2],
        };
        let tracked = Tracked { energy: self.accounts.energy, tangents: self.accounts.tangents };
        Integrator::new(model, tracked, schemes)
    }
}
