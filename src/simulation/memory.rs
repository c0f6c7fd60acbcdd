//! The memory of a run.

use crate::math::{NotEnoughMemory, check_memory};
use crate::model::FlashKernel;
use crate::scene::{LinkKind, OutputGroup, Scene};

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
