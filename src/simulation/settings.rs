//! What of a scene a run needs beside the model.

use crate::contact::EventTolerance;
use crate::integrator::{Integrator, Scheme, Tolerance, Tracked};
use crate::math::{NotEnoughMemory, check_memory};
use crate::model::{FlashKernel, Model};
use crate::outputs::Accounts;
use crate::scene::{LinkKind, Method, OutputGroup, Scene};

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

/// Bytes that a run takes at most.
pub(super) fn of_run(scene: &Scene) -> usize {
    /// Of a mass; of each of its elements.
    const MASS: usize = 2048;
    const ELEMENT: usize = 512;
    /// For each input that derivatives are taken by, this part more.
    const TANGENT: f64 = 0.5;
    let asks = |group| scene.outputs.contains(&group);
    let tangents = if asks(OutputGroup::Tangent) { scene.inputs().len() } else { 0 };
    let run = (MASS + ELEMENT * elements(scene)) as f64 * (1.0 + TANGENT * tangents as f64);
    // With the more accurate one beside it.
    let runs = if asks(OutputGroup::Solver) { 2 } else { 1 };
    scene.layer.masses.saturating_mul(runs * run as usize)
}

/// Maxwell elements of a mass, and its parts of the flash temperature.
fn elements(scene: &Scene) -> usize {
    let links = LinkKind::ALL.into_iter().filter_map(|kind| scene.link(kind));
    let maxwell: usize = links.map(|link| link.maxwell.len()).sum();
    maxwell + if scene.has_heat() { FlashKernel::TERMS } else { 0 }
}

/// Checks that there is as much.
pub(super) fn check(scene: &Scene) -> Result<(), NotEnoughMemory> {
    check_memory(of_run(scene) as u64, || format!("layer.masses = {}", scene.layer.masses))
}
