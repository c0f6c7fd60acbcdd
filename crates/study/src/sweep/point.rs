//! One point of a sweep: pressed to its load, slid until its means are steady, averaged.
//!
//! A point starts relaxed and at full speed, at the w at which the layer's vertical springs alone would bear the load.
//! It is then searched block by block: after each block, w moves by the [`LoadSearch`], and the dashpots along z move
//! to where the block's means say that they will be ([`Simulation::relax_dashpots`]), as a compound has elements that
//! would take minutes. Once a block bears the load and its dashpots nothing, w is held and nothing is changed any more:
//! these blocks are the window, judged as in [`search`](super::search). Where the mean of F_z differs from the load, w
//! moves again, and a new window begins.
//!
//! Where the carrier is a body along z, its load is constant in place of w: it starts at equilibrium, nothing is
//! searched, and after each block the dashpots move as before and the carrier with them. A window counts once the
//! carrier's inertia bears next to nothing of the load in its mean.
//!
//! A point is independent of the others, so a table is the same in whatever order and on however many machines it is
//! computed.
//!
//! [`Simulation::relax_dashpots`]: asperity::simulation::Simulation::relax_dashpots

use asperity::element::{Load, OperatingPoint, PointStatus, Quantity};
use asperity::model::{LinkKind, Model};
use asperity::scene::{CarrierBodies, CarrierBody, CarrierInitial, Scene};
use asperity::simulation::{Interrupt, SimulationError};

use super::layer::{Blocks, Layer, relevant, scene_at, tangential_stiffness};
use super::load_search::LoadSearch;
use super::search::{Held, NotSteady, Search, Slid, SteadySliding, StopBounds};
use super::table::{SweepHeader, SweepRow};

/// Steady sliding at one point, known to `bounds`.
///
/// # Errors
/// Where the layer does not become steady.
pub fn steady_sliding(
    scene: &Scene,
    point: &OperatingPoint,
    load: Load,
    bounds: StopBounds,
) -> Result<SteadySliding, NotSteady> {
    let scene = scene_at(&relevant(scene.clone()), point, load);
    slid(&scene, point.speed, load.force(point.load), bounds, None)?.steady()
}

/// Steady sliding at one point with the carrier held at `w` (m), where the load is near that of the point.
pub(super) fn steady_sliding_at(
    scene: &Scene,
    point: &OperatingPoint,
    w: f64,
    load: Load,
    bounds: StopBounds,
) -> Result<SteadySliding, NotSteady> {
    let scene = &without_carriers(&scene_at(&relevant(scene.clone()), point, load));
    let mut load = LoadSearch::estimated(load.force(point.load), scene, &Model::new(scene));
    load.w = w;
    let layer = Layer { scene, blocks: Blocks::new(scene, point.speed), interrupt: None };
    Search::new(layer, bounds, load, Held::Given)?.finish()?.steady()
}

/// The row of a point of a table, `scene` being [that of the point](scene_at).
pub(super) fn row(
    scene: &Scene,
    point: OperatingPoint,
    header: &SweepHeader,
    bounds: StopBounds,
    interrupt: &Interrupt,
) -> SweepRow {
    let force = header.load.force(point.load);
    match slid(scene, point.speed, force, bounds, Some(interrupt)) {
        Ok(Slid { sliding, problem }) => {
            let (stiffness, falls) =
                start_of_motion(stiffness(scene, point.speed, force, interrupt), problem.is_some());
            let mut row = SweepRow::new(point, PointStatus::new(problem.or(falls)));
            row.set(Quantity::Stiffness, stiffness);
            sliding.fill(&mut row, header);
            row
        }
        Err(problem) => SweepRow::new(point, PointStatus::new(Some(problem))),
    }
}

/// The tangential stiffness that counts, and what is wrong with it. A force that falls as motion starts is none: the masses
/// at rest do not hold what the load asks of them, and an element could not use the point, unless that `is_marked` already.
fn start_of_motion(
    stiffness: Result<Option<f64>, SimulationError>,
    is_marked: bool,
) -> (Option<f64>, Option<NotSteady>) {
    match stiffness {
        Ok(Some(falling)) if falling <= 0.0 => {
            let problem = NotSteady(format!(
                "tangential stiffness: {falling:.4e} N/m, expected a number above 0: refine the layer"
            ));
            (is_marked.then_some(falling), Some(problem))
        }
        Ok(stiffness) => (stiffness, None),
        Err(error) => (None, Some(NotSteady(format!("tangential stiffness: {error}")))),
    }
}

/// What the layer of `scene` does at `speed` (m/s) under the force `load` (N).
fn slid(
    scene: &Scene,
    speed: f64,
    load: f64,
    bounds: StopBounds,
    interrupt: Option<&Interrupt>,
) -> Result<Slid, NotSteady> {
    let scene = &under_load(scene, load);
    let load = LoadSearch::estimated(load, scene, &Model::new(scene));
    let held = scene.carrier.z.map_or(Held::Searched, |body| Held::Load(body.mass));
    Search::new(Layer { scene, blocks: Blocks::new(scene, speed), interrupt }, bounds, load, held)?.finish()
}

/// The scene with the force `load` (N) as the constant load of a carrier that is a body, from equilibrium.
fn under_load(scene: &Scene, load: f64) -> Scene {
    let mut scene = scene.clone();
    if let Some(body) = &mut scene.carrier.z {
        *body = CarrierBody { load: Some(load), start: None, initial: CarrierInitial::Equilibrium, ..*body };
    }
    scene
}

fn without_carriers(scene: &Scene) -> Scene {
    Scene { carrier: CarrierBodies::default(), ..scene.clone() }
}

/// The tangential stiffness of the layer at its start under the force `load` (N), w held, N/m.
fn stiffness(scene: &Scene, speed: f64, load: f64, interrupt: &Interrupt) -> Result<Option<f64>, SimulationError> {
    let scene = &without_carriers(scene);
    let model = Model::new(scene);
    let stiffness = model.links[LinkKind::Vertical].stiffness;
    let frequency = if stiffness > 0.0 { (stiffness / model.mass).sqrt() } else { model.stiffest_frequency() };
    let layer = Layer { scene, blocks: Blocks::new(scene, speed), interrupt: Some(interrupt) };
    tangential_stiffness(layer, LoadSearch::estimated(load, scene, &model), frequency)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_force_that_falls_as_motion_starts_is_no_stiffness() {
        assert_eq!(start_of_motion(Ok(Some(2e4)), false), (Some(2e4), None));
        let (stiffness, problem) = start_of_motion(Ok(Some(-2.8e4)), false);
        let problem = problem.map(|problem| problem.to_string()).unwrap_or_default();
        assert!(stiffness.is_none() && problem.starts_with("tangential stiffness: -2.8000e4 N/m"), "{problem}");
    }
}
