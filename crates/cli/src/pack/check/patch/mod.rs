//! `asperity pack --patch PATCH.toml --check SCENE.toml`: elements of a tilted patch, each beside its layer, dragged
//! along x at speeds of the table and to and fro; and the patch beside one of twice as many elements along and across. Of a
//! table that was solved for, what is solved for stands for the layers.

mod doubled;
mod elements;
mod sliding;
mod tilt;
mod wrench;

use std::path::Path;

use asperity::element::{OperatingPoint, PointContact, SweepGrid};
use asperity::patch::Patch;
use asperity::scene::{Parameter, Scene, TableExtrapolation, Value};
use asperity::simulation::Start;

use super::drag::ToAndFro;
use super::element::element_at;
use super::{CheckError, folder_beside, scene_of};
use crate::cli::Pack;
use crate::figure::{Figure as _, Ladder, LadderPanel, Ladders, Rung, Stroke};
use crate::terminal::{LabelledLine, labelled};
use asperity_study::sweep::Swept;
use doubled::Doubled;
use elements::Dragged;
use sliding::Sliding;
use tilt::TiltedFace;
use wrench::{COMPONENTS, Wrench, WrenchSeries, text};

/// Most speeds of the table at which the patch is dragged.
const SPEEDS: usize = 3;

/// A patch, the layer of its elements, and where both are dragged.
struct CheckSetting<'a> {
    patch: &'a Patch,
    scene: &'a Scene,
    swept: &'a Swept,
    /// At the speeds, the least first.
    faces: &'a [TiltedFace],
    /// In the pose of the middle one of the faces.
    motion: ToAndFro,
    /// The longest arm of a moment, m.
    lever: f64,
}

/// Compares elements with their layers and the patch with a finer one, writes the results beside the FMU and summarises
/// them.
pub(in crate::pack) fn check(command: &Pack, patch: &Patch, scene: &Path) -> Result<Vec<LabelledLine>, CheckError> {
    let scene = scene_of(patch.table(), scene)?;
    let temperature = point(patch, 0.0).temperature;
    let swept = Swept::of_table(&scene, patch.table(), temperature.as_slice())?;
    let folder = folder_beside(&command.output)?;
    // At rest, and at the middles of smaller elements, pressures are a little beyond those of the table.
    let hold = Value::Text(TableExtrapolation::Hold.word().into());
    // Layers stand on what does not give way, and at one temperature.
    let mut patch = patch.contacts_alone();
    patch.set_parameter(Parameter::TableExtrapolation, hold.clone())?;
    let speeds = speeds(&patch.table().grid);
    let faces: Vec<_> = speeds.map(|speed| TiltedFace::new(&patch, speed, command.points as usize)).collect();
    if faces.iter().any(|face| face.tilted_elements.is_empty()) {
        return Err(CheckError::NoElements);
    }
    let middle = &faces[faces.len() / 2];
    let mut contact = PointContact::new(patch.table().clone());
    contact.set_parameter(Parameter::TableExtrapolation, hold)?;
    let motion = ToAndFro { speed: middle.speed, length: stick_length(&contact, &patch, middle) };
    let lever = faces.iter().map(TiltedFace::lever).fold(0.0, f64::max);
    let setting = CheckSetting { patch: &patch, scene: &scene, swept: &swept, faces: &faces, motion, lever };
    setting.compare(&folder)
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
fn point(patch: &Patch, speed: f64) -> OperatingPoint {
    let has_temperature = !patch.table().grid.temperatures.is_empty();
    OperatingPoint { speed, load: 0.0, temperature: has_temperature.then_some(patch.temperature()) }
}

/// The largest and the root mean square differences along a motion.
fn extent(motion: &str, pair: &WrenchSeries) -> [String; 2] {
    let (largest, root) = pair.extent();
    [format!("{motion}, at most: {}", text(largest)), format!("  in root mean square: {}", text(root))]
}

impl CheckSetting<'_> {
    /// The face at the middle speed.
    fn middle(&self) -> &TiltedFace {
        &self.faces[self.faces.len() / 2]
    }

    fn compare(&self, folder: &Path) -> Result<Vec<LabelledLine>, CheckError> {
        let sliding = Sliding::run(self)?;
        sliding.write(&folder.join("points.csv"))?;
        sliding.plot().write(&folder.join("elements.svg"))?;
        let mut texts = sliding.summary();
        let dragged = match self.swept {
            Swept::Layer => Dragged::run(self)?,
            Swept::Solved { .. } => Err("not done, the layer is another model than what was swept".to_owned()),
        };
        match dragged {
            Ok(dragged) => {
                dragged.write(folder)?;
                texts.extend(extent(&self.motion.describe(), dragged.pair()));
            }
            Err(status) => texts.push(format!("to and fro: {status}")),
        }
        let steady = sliding.pair();
        let name = format!("elements beside their {}s", self.swept.name());
        let mut pairs = vec![(name.as_str(), &steady)];
        let doubled = Doubled::run(self)?;
        match &doubled {
            Ok(doubled) => {
                doubled.write(folder, self.motion)?;
                texts.extend(doubled.summary(self));
                pairs.push(("nx, ny doubled", &doubled.steady));
            }
            Err(reason) => texts.push(format!("nx, ny doubled: not done, {reason}")),
        }
        self.plot(&pairs).write(&folder.join("errors.svg"))?;
        texts.push(format!("in {}", folder.display()));
        Ok(labelled("Checked", texts))
    }

    /// Differences in steady sliding over the speed.
    fn plot(&self, pairs: &[(&str, &WrenchSeries)]) -> Ladders {
        let ladder = |look: usize, name: &str, shares: &[Wrench], component: usize| {
            let rung = |(face, share): (&TiltedFace, &Wrench)| Rung {
                x: face.speed,
                y: share[component],
                label: String::new(),
            };
            let rungs = self.faces.iter().zip(shares).map(rung).collect();
            Ladder { name: name.to_owned(), stroke: Stroke::Line, look, rungs }
        };
        let shares: Vec<_> = pairs.iter().map(|(name, pair)| (*name, pair.shares())).collect();
        let panel = |(i, (component, _)): (usize, &(&str, &str))| LadderPanel {
            title: format!("difference of {component}, as a share of the largest"),
            floor: None,
            lines: Vec::new(),
            ladders: shares.iter().enumerate().map(|(look, (name, shares))| ladder(look, name, shares, i)).collect(),
        };
        Ladders { x_title: "speed in m/s".into(), panels: COMPONENTS.iter().enumerate().map(panel).collect() }
    }
}
