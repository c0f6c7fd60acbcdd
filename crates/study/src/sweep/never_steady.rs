//! Scenes of which no slide could become steady.

use asperity::scene::Scene;

use super::search::MIN_BLOCKS;
use super::slide::Blocks;

/// No slide of the layer could become steady.
#[derive(Debug, thiserror::Error)]
#[expect(missing_docs, reason = "the messages say what they are")]
pub enum NeverSteady {
    /// The profile, which reaches `longest` (m) from where the layer starts, is too short for the `needed` way (m) of a
    /// point.
    #[error(
        "the profile ends {longest:.4e} m from where the layer starts, and steady sliding takes {needed:.4e} m or more: make it \
         periodic, as `asperity surface --mirror --write` does, or `taper`, and give periodic = true in [surface]"
    )]
    ProfileEnds { longest: f64, needed: f64 },
    #[error(
        "material.heat: expected none for steady sliding of the layer, since contacts that slide on warm without end; leave it \
         out and vary material.wlf.temperature, or give `method` steady, which has the temperature above the surface's mean"
    )]
    Heats,
}

/// Refuses a scene of which no slide could become steady.
pub(super) fn check_can_be_steady(scene: &Scene) -> Result<(), NeverSteady> {
    if scene.material.as_ref().is_some_and(|material| material.heat.is_some()) {
        return Err(NeverSteady::Heats);
    }
    let blocks = Blocks::new(scene, 1.0);
    if blocks.has_room(MIN_BLOCKS) {
        return Ok(());
    }
    Err(NeverSteady::ProfileEnds { longest: blocks.longest, needed: MIN_BLOCKS * blocks.length })
}
