//! A patch, the layer of its elements, and where both are dragged.

use asperity::element::{OperatingPoint, PointContact, SweepGrid};
use asperity::outputs::{Output, Variable, variable};
use asperity::patch::{Patch, PatchMotion, PatchOutput, PatchRun, PatchStart, PatchVariable};
use asperity::scene::{Parameter, PatchGroup, Scene, TableExtrapolation, Value};
use asperity::simulation::Start;
use rayon::prelude::*;

use super::drag::{ToAndFro, element_at, nothing_sticks};
use super::measure::{COMPONENTS, Wrench, WrenchSeries, along, swept_scene, wrench};
use super::tilt::{TiltedElement, TiltedFace};
use crate::csv::text;
use crate::decimals::real;
use crate::error::{Context as _, Error, ErrorKind};
use crate::progress::{Counter, Watch};
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
    /// Where the table was swept of another scene, no element stands where its table has values, or contacts need their
    /// backing.
    pub fn new(patch: &Patch, scene: Scene, count: usize) -> Result<Self, Error> {
        // Layers stand on what does not give way.
        patch.table().check_alone().context("`check`")?;
        let scene = swept_scene(patch.table(), scene)?;
        let temperature = point(patch, 0.0).temperature;
        let swept = Swept::of_table(&scene, patch.table(), temperature.as_slice()).context("`check`")?;
        // At rest, and at the middles of smaller elements, pressures are a little beyond those of the table.
        let hold = Value::Text(TableExtrapolation::Hold.word().into());
        // And at one temperature.
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

/// What is taken of a layer.
const LAYER: [Output; 2] = [Output::ForceX, Output::ForceZ];

/// Before what a motion is refused for.
const NOT_DRAGGED: &str = "`check`: the patch cannot be dragged";

/// A run of a patch in the pose of a tilted face, along x.
pub(super) struct Drag {
    pub(super) run: PatchRun,
    /// The speed of the tread, m/s.
    transport_speed: f64,
    temperature: f64,
}

impl Drag {
    /// At a speed along x (m/s), the tread standing still.
    pub(super) fn new(patch: &Patch, face: &TiltedFace, speed: f64) -> Result<Self, Error> {
        Self::rolling(patch, face, speed, 0.0)
    }

    /// At a speed along x (m/s), the tread running at `transport_speed` (m/s).
    pub(super) fn rolling(patch: &Patch, face: &TiltedFace, speed: f64, transport_speed: f64) -> Result<Self, Error> {
        let (rates, temperature) = (along_x(speed), patch.temperature());
        let start = PatchStart { pose: face.pose, rates, transport_speed, temperature, ..PatchStart::default() };
        Ok(Self { run: PatchRun::new(patch, &start).context(NOT_DRAGGED)?, transport_speed, temperature })
    }

    /// For a duration (s) at a speed (m/s).
    pub(super) fn advance(&mut self, (duration, speed): (f64, f64)) -> Result<(), Error> {
        let Self { transport_speed, temperature, .. } = *self;
        let motion = PatchMotion { duration, rates: along_x(speed), transport_speed, temperature };
        self.run.advance(&motion).context(NOT_DRAGGED)
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
    pub(super) fn new(patch: &Patch, face: &'a TiltedFace, speed: f64) -> Result<Self, Error> {
        let patch = patch.with_elements(face.tilted_elements.iter().map(|tilted| tilted.element));
        let patch = patch.with_groups(vec![PatchGroup::Elements]);
        let (variables, drag) = (patch.variables(), Drag::new(&patch, face, speed)?);
        Ok(Self { tilted_elements: &face.tilted_elements, values: vec![0.0; variables.len()], variables, drag })
    }

    pub(super) fn advance(&mut self, step: (f64, f64)) -> Result<(), Error> {
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
#[derive(Debug)]
pub struct Dragged {
    motion: ToAndFro,
    /// Layers, elements.
    pair: WrenchSeries,
}

impl Dragged {
    /// Drags both; says why they are not compared where a layer cannot be dragged.
    ///
    /// # Errors
    /// Where the patch cannot be moved, or `watch` stops it.
    pub fn run(check: &PatchCheck, watch: &Watch<'_>) -> Result<Result<Self, Error>, Error> {
        let (face, motion) = (check.middle(), check.motion);
        if matches!(check.swept, Swept::Solved { .. }) {
            return Ok(Err(Error::run("not done, the layer is another model than what was swept")));
        }
        if motion.length <= 0.0 {
            return Ok(Err(nothing_sticks()));
        }
        let mut elements = Elements::new(&check.patch, face, 0.0)?;
        let sum = |forces: Vec<[f64; 3]>| wrench(face.tilted_elements.iter().map(|tilted| tilted.arm).zip(forces)).0;
        let mut other = vec![sum(elements.forces())];
        for step in motion.steps() {
            elements.advance(step)?;
            other.push(sum(elements.forces()));
        }
        let layers = match layers(check, face, watch) {
            Ok(layers) => layers,
            Err(stopped) if stopped.kind() == ErrorKind::Stopped => return Err(stopped),
            Err(why) => return Ok(Err(why)),
        };
        let (reference, sizes): (Vec<_>, Vec<_>) = layers.into_iter().unzip();
        Ok(Ok(Self { motion, pair: WrenchSeries::new(reference, other, &sizes, check.lever) }))
    }

    /// Layers and elements, row by row, at these times, s.
    pub fn rows(&self) -> (Vec<f64>, &WrenchSeries) {
        (self.motion.carriers(0.0).iter().map(|carrier| carrier.time).collect(), &self.pair)
    }

    /// The tables of the layers and of the elements.
    pub fn tables(&self) -> [String; 2] {
        [&self.pair.reference, &self.pair.other].map(|rows| table(self.motion, rows))
    }

    /// The largest and the root mean square differences.
    pub fn summary(&self) -> [String; 2] {
        along(&self.motion.describe(), &self.pair)
    }
}

/// The wrench of the layers and the sums of magnitudes, row by row.
fn layers(check: &PatchCheck, face: &TiltedFace, watch: &Watch<'_>) -> Result<Vec<(Wrench, Wrench)>, Error> {
    let variables: Vec<Variable> = LAYER.into_iter().filter_map(variable).collect();
    let (table, temperature) = (check.patch.table(), point(&check.patch, face.speed).temperature);
    let counter = Counter::new(watch, "of the layers to and fro", face.tilted_elements.len());
    let drag = |tilted: &TiltedElement| {
        let w = tilted.separation - table.rest_separation;
        let rows = check.motion.layer::<{ LAYER.len() }>(&check.scene, temperature, w, &variables);
        counter.step()?;
        rows.context(format!("the layer of element {}", tilted.element.index + 1))
    };
    let rows: Vec<_> = face.tilted_elements.par_iter().with_max_len(1).map(drag).collect::<Result<_, Error>>()?;
    let sum = |row: usize| {
        let force = |(tilted, rows): (&TiltedElement, &Vec<[f64; 2]>)| {
            let ([along, up], share) = (rows[row], tilted.element.area / check.patch.nominal_area());
            (tilted.arm, [share * along, 0.0, share * up])
        };
        wrench(face.tilted_elements.iter().zip(&rows).map(force))
    };
    Ok((0..rows.first().map_or(0, Vec::len)).map(sum).collect())
}

/// The table of a series along the motion to and fro.
pub(super) fn table(motion: ToAndFro, rows: &[Wrench]) -> String {
    let names = ["time", "x"].into_iter().chain(COMPONENTS.iter().map(|(name, _)| *name));
    let carriers = motion.carriers(0.0);
    let fields = carriers
        .iter()
        .zip(rows)
        .map(|(carrier, row)| [carrier.time, carrier.u].iter().chain(row).map(|&value| real(value)).collect());
    text(names, fields)
}
