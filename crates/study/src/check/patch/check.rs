//! A patch, the layer of its elements, and where both are dragged.

use asperity::element::{OperatingPoint, PointContact, SweepGrid};
use asperity::patch::Patch;
use asperity::scene::{Parameter, Scene, TableExtrapolation, Value};
use asperity::simulation::Start;

use super::tilt::TiltedFace;
use crate::check::drag::ToAndFro;
use crate::check::element_at::element_at;
use crate::error::{Context as _, Error};
use crate::check::scene::swept_scene;
use crate::sweep::Swept;

/// Most speeds of the table at which the patch is dragged.
const SPEEDS: usize = 3;

/// A patch, the layer of its elements, and where both are dragged.
#[derive(Debug)]
pub struct PatchCheck {
    pub(super) patch: Patch,
    pub(super) scene: Scene,
    pub(super) swept: Swept,
    /// At the speeds, the least first.
    pub(super) faces: Vec<TiltedFace>,
    /// In the pose of the middle one of the faces.
    pub(super) motion: ToAndFro,
    /// The longest arm of a moment, m.
    pub(super) lever: f64,
}

impl PatchCheck {
    /// The check of a patch by the scene that its table was swept of, with `count` elements at a speed or fewer.
    ///
    /// # Errors
    /// Where the table was swept of another scene, or no element stands where its table has values.
    pub fn new(patch: &Patch, scene: Scene, count: usize) -> Result<Self, Error> {
        let scene = swept_scene(patch.table(), scene)?;
        let temperature = point(patch, 0.0).temperature;
        let swept = Swept::of_table(&scene, patch.table(), temperature.as_slice()).context("`check`")?;
        // At rest, and at the middles of smaller elements, pressures are a little beyond those of the table.
        let hold = Value::Text(TableExtrapolation::Hold.word().into());
        // Layers stand on what does not give way, and at one temperature.
        let mut patch = patch.contacts_alone();
        patch.set_parameter(Parameter::TABLE_EXTRAPOLATION, hold.clone())?;
        let speeds = speeds(&patch.table().grid);
        let faces: Vec<_> = speeds.map(|speed| TiltedFace::new(&patch, speed, count)).collect();
        if faces.iter().any(|face| face.tilted_elements.is_empty()) {
            return Err(Error::scene(
                "`check`: no element of the tilted face stands at a separation of the table: its places are too large to \
                 tell them",
            ));
        }
        let middle = &faces[faces.len() / 2];
        let mut contact = PointContact::new(patch.table().clone());
        contact.set_parameter(Parameter::TABLE_EXTRAPOLATION, hold)?;
        let motion = ToAndFro { speed: middle.speed, length: stick_length(&contact, &patch, middle) };
        let lever = faces.iter().map(TiltedFace::lever).fold(0.0, f64::max);
        Ok(Self { patch, scene, swept, faces, motion, lever })
    }

    /// The speeds at which it is dragged, m/s, the least first.
    pub fn speeds(&self) -> impl Iterator<Item = f64> {
        self.faces.iter().map(|face| face.speed)
    }

    /// What was swept, in a word.
    pub fn swept(&self) -> &'static str {
        self.swept.name()
    }

    /// The face at the middle speed.
    pub(super) fn middle(&self) -> &TiltedFace {
        &self.faces[self.faces.len() / 2]
    }
}

/// The least, the middle and the largest speed of a table, by their numbers.
fn speeds(grid: &SweepGrid) -> impl Iterator<Item = usize> + use<> {
    let last = grid.speeds.len() - 1;
    let count = SPEEDS.min(grid.speeds.len());
    (0..count).map(move |i| i * last / (count - 1).max(1))
}

/// The longest length over which one of the elements sticks, m.
fn stick_length(contact: &PointContact, patch: &Patch, face: &TiltedFace) -> f64 {
    let length = |separation: f64| {
        let start = Start { w: separation - patch.table().rest_separation, ..Start::default() };
        element_at(contact, &point(patch, face.speed), &start).map_or(0.0, |element| element.stick_length())
    };
    face.tilted_elements.iter().map(|tilted| length(tilted.separation)).fold(0.0, f64::max)
}

/// A speed at the temperature of a patch.
pub(super) fn point(patch: &Patch, speed: f64) -> OperatingPoint {
    let has_temperature = !patch.table().grid.temperatures.is_empty();
    OperatingPoint { speed, load: 0.0, temperature: has_temperature.then_some(patch.temperature()), way: None }
}
