//! What of a scene a run needs beside the model: its settings, its memory, where the bodies of the carrier start.

use super::motion::Start;
use crate::contact::EventTolerance;
use crate::integrator::{Integrator, Scheme, Tolerance, Tracked};
use crate::math::{NotEnoughMemory, check_memory};
use crate::model::{BodyStart, FlashKernel, Model};
use crate::outputs::Accounts;
use crate::scene::{Axis, ByAxis, CarrierInitial, LinkKind, Method, OutputGroup, Scene};

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

/// Where and how fast the bodies of `scene` start, along x and z; `None` where the displacement is prescribed.
pub(super) fn body_starts(scene: &Scene, model: &Model, start: &Start) -> ByAxis<Option<BodyStart>> {
    let at_start = |axis: Axis, drive: f64, force: f64| {
        let body = scene.carrier[axis].as_ref()?;
        // Without a drive there is none to follow.
        let drive = if body.has_drive() { drive } else { 0.0 };
        let displacement = body.start.unwrap_or(drive);
        Some(BodyStart { displacement, rate: body.start_rate.unwrap_or(0.0), drive, force })
    };
    let x = at_start(Axis::X, start.u, start.pull);
    let mut z = at_start(Axis::Z, start.w, start.load);
    let equilibrium = scene.carrier.z.is_some_and(|body| body.initial == CarrierInitial::Equilibrium);
    if let (true, Some(z)) = (equilibrium, &mut z) {
        let u = x.map_or(start.u, |x| x.displacement);
        z.displacement = equilibrium_of(model, scene.bearing_stiffness(), u, z);
    }
    ByAxis { x, z }
}

/// The displacement w at which the springs of the masses that it lifts, of stiffness `bearing` (N/m) each, and the
/// drive's bear the load of a carrier at `u` (m), m: Σ C max(0, h_i - w) = N + K (w - w_d), h_i = z_r(X_i + u) - Z_i.
/// The left side falls with w and the right one does not, so there is one solution, linear between two heights.
fn equilibrium_of(model: &Model, bearing: f64, u: f64, start: &BodyStart) -> f64 {
    let Some(body) = &model.bodies[Axis::Z] else { return start.displacement };
    let position = model.profile.reduce(u);
    let height = |i: usize| model.surface_at(model.rest_x[i] + position).height - model.rest_z[i];
    let mut heights: Vec<f64> = (0..model.masses()).map(height).collect();
    heights.sort_by(|a, b| b.total_cmp(a));
    let highest = heights[0];
    let load = body.force + start.force;
    if load == 0.0 && body.stiffness == 0.0 {
        return highest;
    }
    let mut borne = 0.0;
    for count in 0..=heights.len() {
        // Relative to the highest, so that a carrier far away loses no digits.
        let stiffness = bearing * count as f64 + body.stiffness;
        let w = (bearing * borne - load + body.stiffness * (start.drive - highest)) / stiffness;
        let next = heights.get(count).map_or(f64::NEG_INFINITY, |height| height - highest);
        if stiffness > 0.0 && w >= next {
            return highest + w;
        }
        borne += next;
    }
    highest
}

#[cfg(test)]
mod tests {
    use super::*;

    fn start_of(carrier: &str) -> f64 {
        let text = format!(
            "name = 'a'
             layer = {{ masses = 3, spacing = 1.0, mass = 1.0, vertical = {{ stiffness = 2.0 }},
                        roughness = {{ kind = 'points', z = [0.1, -0.2, 0.3] }} }}
             surface = {{ kind = 'flat' }}
             carrier.z = {{ mass = 1.0, initial = 'equilibrium', {carrier} }}"
        );
        let scene = Scene::parse(&text, "a.toml".as_ref()).unwrap();
        let model = Model::new(&scene);
        body_starts(&scene, &model, &Start { w: 0.5, ..Start::default() }).z.unwrap().displacement
    }

    /// Heights under which masses touch: 0.2, -0.1, -0.3. Two springs bear 2 (0.2 - w) + 2 (-0.1 - w).
    #[test]
    fn springs_bear_the_load() {
        for (carrier, expected) in [
            ("load = 0.0", 0.2),
            ("load = 0.2", 0.1),
            ("load = 1.0", -0.2),
            ("load = 6.0", (0.2 - 0.1 - 0.3 - 3.0) / 3.0),
            // Hung on the drive, clear of the surface.
            ("load = 0.4, stiffness = 2.0", 0.3),
            // 2 (0.2 - w) = 2 + 2 (w - 0.5)
            ("load = 0.8, stiffness = 2.0", (0.4 - 0.8 + 1.0) / 4.0),
            ("load = -1.0, stiffness = 1.0", 1.5),
        ] {
            assert!((start_of(carrier) - expected).abs() < 1e-14, "{carrier}: {} {expected}", start_of(carrier));
        }
    }
}
