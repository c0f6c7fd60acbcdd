//! Elements beside their layers in steady sliding, at several speeds.

use std::path::Path;

use asperity::element::OperatingPoint;
use asperity::patch::MotionError;
use indicatif::ProgressBar;
use rayon::prelude::*;

use super::elements::Elements;
use super::tilt::{TiltedElement, TiltedFace};
use super::wrench::{Wrench, WrenchSeries, text, wrench};
use super::{CheckSetting, point};
use crate::figure::{Ladder, LadderPanel, Ladders, Rung, Stroke};
use crate::files::FileError;
use crate::pack::check::{ERROR, SLIDING_DISTANCE};
use crate::result_file::CsvWriter;
use crate::terminal;
use asperity_study::decimals::real;
use asperity_study::sweep::StopBounds;

/// What is compared of an element: along and across the plane.
const COMPARED: [(&str, usize); 2] = [("force.x", 0), ("force.z", 2)];
/// Columns before those of what is compared.
const HEAD: [&str; 9] =
    ["speed [m/s]", "element", "x [m]", "y [m]", "z [m]", "area [m2]", "separation [m]", "pressure [Pa]", "status"];

/// Steady sliding at all speeds.
pub(super) struct Sliding<'a> {
    setting: &'a CheckSetting<'a>,
    speeds: Vec<SlidingAtSpeed<'a>>,
}

/// Steady sliding at a speed.
struct SlidingAtSpeed<'a> {
    face: &'a TiltedFace,
    /// Forces on the elements, N.
    elements: Vec<[f64; 3]>,
    /// Forces on their layers, N; the status of one that was not steady.
    layers: Vec<Result<[f64; 3], String>>,
}

impl<'a> Sliding<'a> {
    pub(super) fn run(setting: &'a CheckSetting<'a>) -> Result<Self, MotionError> {
        let bar = terminal::bar(setting.faces.iter().map(|face| face.tilted_elements.len() as u64).sum());
        bar.set_message("of the layers in steady sliding");
        let speeds: Result<_, _> = setting.faces.iter().map(|face| SlidingAtSpeed::run(setting, face, &bar)).collect();
        bar.finish_and_clear();
        Ok(Self { setting, speeds: speeds? })
    }

    /// The wrenches of the layers and of the elements, by speed.
    pub(super) fn pair(&self) -> WrenchSeries {
        let (layers, other): (Vec<_>, Vec<_>) = self.speeds.iter().map(SlidingAtSpeed::wrenches).unzip();
        let (reference, sizes): (Vec<_>, Vec<_>) = layers.into_iter().unzip();
        WrenchSeries::new(reference, other, &sizes, self.setting.lever)
    }

    /// Differences by speed, and what could not be compared.
    pub(super) fn summary(&self) -> Vec<String> {
        let pressures: Vec<f64> = self.speeds.iter().flat_map(SlidingAtSpeed::pressures).collect();
        let (least, largest) = pressures.iter().fold((f64::INFINITY, 0.0), |(low, high), p| (p.min(low), p.max(high)));
        let all: usize = self.speeds.iter().map(|sliding| sliding.elements.len()).sum();
        let range =
            if pressures.is_empty() { String::new() } else { format!(" from {least:.3e} to {largest:.3e} Pa,") };
        let (compared, name) = (pressures.len(), self.setting.swept.name());
        let mut texts =
            vec![format!("{compared} of {all} elements beside their {name}s,{range} over the {name}s' largest values")];
        let shares = self.pair().shares();
        texts.extend(self.speeds.iter().zip(shares).map(|(sliding, share)| sliding.line(share)));
        texts.extend(self.speeds.iter().flat_map(|sliding| sliding.failed(name)));
        texts
    }

    pub(super) fn write(&self, path: &Path) -> Result<(), FileError> {
        let swept = self.setting.swept.name();
        let of_each =
            COMPARED.iter().flat_map(|(name, _)| [swept, "element", "error"].map(|of| format!("{name} {of}")));
        let head: Vec<String> = HEAD.map(String::from).into_iter().chain(of_each).collect();
        let mut writer = CsvWriter::create(path, head.iter().map(String::as_str))?;
        let rows = self.speeds.iter().flat_map(|sliding| sliding.rows(swept));
        rows.into_iter().try_for_each(|row| writer.write(row))?;
        writer.finish()
    }

    /// Errors of elements over their pressure, one line for each speed.
    pub(super) fn plot(&self) -> Ladders {
        let ladder = |(look, sliding): (usize, &SlidingAtSpeed<'_>), axis: usize| {
            let rung = |(tilted, layer, element): (&TiltedElement, [f64; 3], [f64; 3])| Rung {
                x: element[2] / tilted.element.area,
                y: (element[axis] / layer[axis] - 1.0).abs(),
                label: String::new(),
            };
            let rungs = sliding.compared().map(rung).collect();
            Ladder { name: format!("{} m/s", real(sliding.face.speed)), stroke: Stroke::Line, look, rungs }
        };
        let panel = |&(name, axis): &(&str, usize)| LadderPanel {
            title: format!("error of {name}, as a share of it"),
            floor: None,
            lines: Vec::new(),
            ladders: self.speeds.iter().enumerate().map(|sliding| ladder(sliding, axis)).collect(),
        };
        Ladders { x_title: "pressure in Pa".into(), panels: COMPARED.iter().map(panel).collect() }
    }
}

impl<'a> SlidingAtSpeed<'a> {
    fn run(setting: &CheckSetting<'_>, face: &'a TiltedFace, bar: &ProgressBar) -> Result<Self, MotionError> {
        let mut run = Elements::new(setting.patch, face, face.speed)?;
        run.advance((SLIDING_DISTANCE / face.speed, face.speed))?;
        let elements = run.forces();
        let pairs: Vec<_> = face.tilted_elements.iter().zip(&elements).collect();
        let layer = |(tilted, force): &(&TiltedElement, &[f64; 3])| {
            let found = layer_force(setting, face.speed, tilted, force[2]);
            bar.inc(1);
            found
        };
        Ok(Self { face, layers: pairs.par_iter().with_max_len(1).map(layer).collect(), elements })
    }

    /// The elements whose layers were steady, with the forces on layer and element, N.
    fn compared(&self) -> impl Iterator<Item = (&TiltedElement, [f64; 3], [f64; 3])> {
        let all = self.face.tilted_elements.iter().zip(&self.layers).zip(&self.elements);
        all.filter_map(|((tilted, layer), element)| Some((tilted, *layer.as_ref().ok()?, *element)))
    }

    /// The pressures on the elements, Pa.
    fn pressures(&self) -> impl Iterator<Item = f64> {
        self.compared().map(|(tilted, _, element)| element[2] / tilted.element.area)
    }

    /// The wrench of the layers with the sums of magnitudes, and that of the elements.
    fn wrenches(&self) -> ((Wrench, Wrench), Wrench) {
        let of = |which: fn([f64; 3], [f64; 3]) -> [f64; 3]| {
            wrench(self.compared().map(|(tilted, layer, element)| (tilted.arm, which(layer, element))))
        };
        (of(|layer, _| layer), of(|_, element| element).0)
    }

    fn line(&self, share: Wrench) -> String {
        format!("at {} m/s: {}", real(self.face.speed), text(share))
    }

    fn failed(&self, swept: &'static str) -> impl Iterator<Item = String> {
        let all = self.face.tilted_elements.iter().zip(&self.layers);
        let failed = all.filter_map(|(tilted, layer)| Some((tilted, layer.as_ref().err()?)));
        failed.map(move |(tilted, status)| {
            format!("element {} at {} m/s: {swept} {status}", tilted.element.index + 1, real(self.face.speed))
        })
    }

    fn rows(&self, swept: &'static str) -> impl Iterator<Item = Vec<String>> {
        let all = self.face.tilted_elements.iter().zip(&self.layers).zip(&self.elements);
        all.map(move |((tilted, layer), element)| {
            let status = layer.as_ref().map_or_else(|status| format!("{swept} {status}"), |_| "compared".into());
            let mut row = vec![real(self.face.speed), (tilted.element.index + 1).to_string()];
            row.extend(
                tilted
                    .element
                    .place
                    .into_iter()
                    .chain([tilted.element.area, tilted.separation, element[2] / tilted.element.area])
                    .map(real),
            );
            row.push(status);
            for (_, axis) in COMPARED {
                let of = |value: &dyn Fn(&[f64; 3]) -> f64| {
                    layer.as_ref().map(|layer| real(value(layer))).unwrap_or_default()
                };
                row.extend([
                    of(&|layer| layer[axis]),
                    real(element[axis]),
                    of(&|layer| element[axis] / layer[axis] - 1.0),
                ]);
            }
            row
        })
    }
}

/// The force on a layer of the area of an element in its place, N, where it is near `force_z`.
fn layer_force(
    setting: &CheckSetting<'_>,
    speed: f64,
    tilted: &TiltedElement,
    force_z: f64,
) -> Result<[f64; 3], String> {
    let CheckSetting { patch, scene, swept, .. } = setting;
    let (load, share) = (patch.table().load, tilted.element.area / patch.nominal_area());
    let at = OperatingPoint { load: load.at_force(force_z / share), ..point(patch, speed) };
    let w = tilted.separation - patch.table().rest_separation;
    let found = swept.sliding_at(scene, &at, w, load, StopBounds { error: ERROR, distance: None })?;
    Ok([-share * found.drag, 0.0, share * found.force_z])
}
