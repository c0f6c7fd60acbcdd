//! The elements of a tilted face as a patch of their own, and along the motion to and fro beside their layers.

use std::path::Path;

use asperity::outputs::{Output, Variable, variable};
use asperity::patch::{MotionError, Patch, PatchMotion, PatchOutput, PatchRun, PatchStart, PatchVariable};
use asperity::scene::PatchGroup;
use rayon::prelude::*;

use super::tilt::{TiltedElement, TiltedFace};
use super::wrench::{COMPONENTS, Wrench, WrenchSeries, wrench};
use super::{CheckSetting, point};
use crate::figure::{Curve, Figure as _, LinearPanel, LinearStack, Stroke};
use crate::files::FileError;
use crate::pack::check::drag::ToAndFro;
use crate::result_file::CsvWriter;
use crate::terminal;
use asperity_study::decimals::real;

/// What is taken of a layer.
const LAYER: [Output; 2] = [Output::ForceX, Output::ForceZ];

/// A run of a patch in the pose of a tilted face, along x.
pub(super) struct Drag {
    pub(super) run: PatchRun,
    /// The speed of the tread, m/s.
    transport_speed: f64,
    temperature: f64,
}

impl Drag {
    /// At a speed along x (m/s), the tread standing still.
    pub(super) fn new(patch: &Patch, face: &TiltedFace, speed: f64) -> Result<Self, MotionError> {
        Self::rolling(patch, face, speed, 0.0)
    }

    /// At a speed along x (m/s), the tread running at `transport_speed` (m/s).
    pub(super) fn rolling(
        patch: &Patch,
        face: &TiltedFace,
        speed: f64,
        transport_speed: f64,
    ) -> Result<Self, MotionError> {
        let (rates, temperature) = (along_x(speed), patch.temperature());
        let start = PatchStart { pose: face.pose, rates, transport_speed, temperature, ..PatchStart::default() };
        Ok(Self { run: PatchRun::new(patch, &start)?, transport_speed, temperature })
    }

    /// For a duration (s) at a speed (m/s).
    pub(super) fn advance(&mut self, (duration, speed): (f64, f64)) -> Result<(), MotionError> {
        let Self { transport_speed, temperature, .. } = *self;
        self.run.advance(&PatchMotion { duration, rates: along_x(speed), transport_speed, temperature })
    }
}

fn along_x(speed: f64) -> [f64; 6] {
    [speed, 0.0, 0.0, 0.0, 0.0, 0.0]
}

/// The elements of a face alone, dragged.
pub(super) struct Elements<'a> {
    tilted_elements: &'a [TiltedElement],
    drag: Drag,
    variables: Vec<PatchVariable>,
    values: Vec<f64>,
}

impl<'a> Elements<'a> {
    pub(super) fn new(patch: &Patch, face: &'a TiltedFace, speed: f64) -> Result<Self, MotionError> {
        let patch = patch.with_elements(face.tilted_elements.iter().map(|tilted| tilted.element));
        let patch = patch.with_groups(vec![PatchGroup::Elements]);
        let (variables, drag) = (patch.variables(), Drag::new(&patch, face, speed)?);
        Ok(Self { tilted_elements: &face.tilted_elements, values: vec![0.0; variables.len()], variables, drag })
    }

    pub(super) fn advance(&mut self, step: (f64, f64)) -> Result<(), MotionError> {
        self.drag.advance(step)
    }

    /// The ground's forces on them, N.
    pub(super) fn forces(&mut self) -> Vec<[f64; 3]> {
        self.drag.run.evaluate(&self.variables, &mut self.values);
        let mut forces = vec![[0.0; 3]; self.tilted_elements.len()];
        for (variable, value) in self.variables.iter().zip(&self.values) {
            match variable.output {
                PatchOutput::ElementTraction(i, axis) => forces[i][axis] = value * self.tilted_elements[i].element.area,
                PatchOutput::ElementPressure(i) => forces[i][2] = value * self.tilted_elements[i].element.area,
                _ => (),
            }
        }
        forces
    }
}

/// The elements and their layers along the motion to and fro.
pub(super) struct Dragged {
    motion: ToAndFro,
    /// Layers, elements.
    pair: WrenchSeries,
}

impl Dragged {
    /// Drags both; the status where a layer cannot be dragged.
    pub(super) fn run(setting: &CheckSetting<'_>) -> Result<Result<Self, String>, MotionError> {
        let (face, motion) = (setting.middle(), setting.motion);
        if motion.length <= 0.0 {
            return Ok(Err("no contact, or no friction".into()));
        }
        let mut elements = Elements::new(setting.patch, face, 0.0)?;
        let sum = |forces: Vec<[f64; 3]>| wrench(face.tilted_elements.iter().map(|tilted| tilted.arm).zip(forces)).0;
        let mut other = vec![sum(elements.forces())];
        for step in motion.steps() {
            elements.advance(step)?;
            other.push(sum(elements.forces()));
        }
        let layers = layers(setting, face);
        Ok(layers.map(|layers| {
            let (reference, sizes): (Vec<_>, Vec<_>) = layers.into_iter().unzip();
            Self { motion, pair: WrenchSeries::new(reference, other, &sizes, setting.lever) }
        }))
    }

    pub(super) fn pair(&self) -> &WrenchSeries {
        &self.pair
    }

    /// Writes both as files and draws them.
    pub(super) fn write(&self, folder: &Path) -> Result<(), FileError> {
        write_rows(&folder.join("loop-layers.csv"), self.motion, &self.pair.reference)?;
        write_rows(&folder.join("loop-elements.csv"), self.motion, &self.pair.other)?;
        self.plot().write(&folder.join("loop.svg"))
    }

    fn plot(&self) -> LinearStack {
        let carriers = self.motion.carriers(0.0);
        let curve = |look: usize, name: &str, stroke: Stroke, rows: &[Wrench], i: usize| Curve {
            name: name.to_owned(),
            look,
            stroke,
            points: carriers.iter().zip(rows).map(|(carrier, row)| (carrier.time, row[i])).collect(),
        };
        let panel = |(i, &(quantity, unit)): (usize, &(&'static str, &'static str))| {
            let layers = curve(0, "layers", Stroke::Line, &self.pair.reference, i);
            let elements = curve(1, "elements", Stroke::Dashed, &self.pair.other, i);
            LinearPanel { quantity, unit, curves: vec![layers, elements] }
        };
        LinearStack { x: ("time", "s"), panels: COMPONENTS.iter().enumerate().map(panel).collect() }
    }
}

/// The wrench of the layers and the sums of magnitudes, row by row.
fn layers(setting: &CheckSetting<'_>, face: &TiltedFace) -> Result<Vec<(Wrench, Wrench)>, String> {
    let variables: Vec<Variable> = LAYER.into_iter().filter_map(variable).collect();
    let (table, temperature) = (setting.patch.table(), point(setting.patch, face.speed).temperature);
    let bar = terminal::bar(face.tilted_elements.len() as u64);
    bar.set_message("of the layers to and fro");
    let drag = |tilted: &TiltedElement| {
        let w = tilted.separation - table.rest_separation;
        let rows = setting.motion.layer::<{ LAYER.len() }>(setting.scene, temperature, w, &variables);
        bar.inc(1);
        rows.map_err(|status| format!("the layer of element {}: {status}", tilted.element.index + 1))
    };
    let rows: Result<Vec<_>, String> = face.tilted_elements.par_iter().with_max_len(1).map(drag).collect();
    bar.finish_and_clear();
    let rows = rows?;
    let sum = |row: usize| {
        let force = |(tilted, rows): (&TiltedElement, &Vec<[f64; 2]>)| {
            let ([along, up], share) = (rows[row], tilted.element.area / setting.patch.nominal_area());
            (tilted.arm, [share * along, 0.0, share * up])
        };
        wrench(face.tilted_elements.iter().zip(&rows).map(force))
    };
    Ok((0..rows.first().map_or(0, Vec::len)).map(sum).collect())
}

/// Writes a series along the motion to and fro.
pub(super) fn write_rows(path: &Path, motion: ToAndFro, rows: &[Wrench]) -> Result<(), FileError> {
    let names = ["time", "x"].into_iter().chain(COMPONENTS.iter().map(|(name, _)| *name));
    let mut writer = CsvWriter::create(path, names)?;
    for (carrier, row) in motion.carriers(0.0).iter().zip(rows) {
        writer.write([carrier.time, carrier.u].iter().chain(row).map(|&value| real(value)))?;
    }
    writer.finish()
}
