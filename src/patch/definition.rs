//! The definition of a patch: its table, its face and the parameters that a master may set.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::block_contacts::Damping;
use super::face::{Face, FixedPoints, Section, Tread};
use crate::element::{Clearance, FrictionTable, Load, Node, Quantity, ResampledLaw};
use crate::scene::{
    Backing, CanonicalFiles, FaceHeat, FaceShape, FileFormats, FmuOptions, Grid, InputRule, NotDoubled, POINTS,
    Parameter, ParameterError, PatchFile, PatchGroup, Problem, SceneError, Setting, TableExtrapolation, Value,
    read_file,
};
use crate::table::TableError;
use crate::tables::{ReadingNote, canonical};

/// Why a patch is refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PatchError {
    /// The patch file or the file of points.
    #[error(transparent)]
    File(#[from] SceneError),
    /// The table.
    #[error(transparent)]
    Table(#[from] TableError),
}

/// An element of a patch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PatchElement {
    /// Its number, from 0.
    pub index: usize,
    /// Where it sits in the body's axes, m.
    pub place: [f64; 3],
    /// Its area, m².
    pub area: f64,
}

/// Where an element sits on the face at an instant.
#[derive(Clone, Copy, Debug)]
pub(super) struct ElementSite {
    /// In the body's axes, m.
    pub(super) place: [f64; 3],
    /// The area of the element that is inside the contact, m².
    pub(super) area: f64,
    /// The direction of the arc there, in x and z.
    pub(super) direction: [f64; 2],
}

/// The definition of a patch.
#[derive(Clone, Debug)]
pub struct Patch {
    file: Arc<PatchFile>,
    files: Arc<[PathBuf]>,
    table: Arc<FrictionTable>,
    clearance: Clearance,
    pub(super) face: Arc<Face>,
    pub(super) nominal_area: f64,
    temperature: f64,
    pub(super) table_extrapolation: TableExtrapolation,
    pub(super) refine: u32,
    backing: Option<Backing>,
    damping: f64,
    heat: Option<FaceHeat>,
    /// How the body moves on when a master gives no rates.
    pub input_rule: InputRule,
}

/// Where a number of a backing or of heat is.
type Real = for<'a> fn(&'a mut Option<Backing>, &'a mut Option<FaceHeat>) -> Option<&'a mut f64>;

/// Parameters that are numbers, of a backing and of heat.
const REALS: [(Parameter, Real); 6] = [
    (Parameter::new("patch.backing.normal"), |backing, _| Some(&mut backing.as_mut()?.normal)),
    (Parameter::new("patch.backing.shear"), |backing, _| Some(&mut backing.as_mut()?.shear)),
    (Parameter::new("patch.heat.conductivity"), |_, heat| Some(&mut heat.as_mut()?.conductivity)),
    (Parameter::new("patch.heat.capacity"), |_, heat| Some(&mut heat.as_mut()?.capacity)),
    (Parameter::new("patch.heat.density"), |_, heat| Some(&mut heat.as_mut()?.density)),
    (Parameter::new("patch.heat.share"), |_, heat| Some(&mut heat.as_mut()?.share)),
];

/// Where the number of a parameter is; `None` of one that is none.
fn real_of(parameter: Parameter) -> Option<Real> {
    REALS.iter().find(|(own, _)| *own == parameter).map(|(_, real)| *real)
}

impl Patch {
    /// Reads the patch file at `path` and the files that it names.
    ///
    /// # Errors
    /// [`PatchError`] with the file, the line, the key, what was given and what is allowed.
    pub fn load(path: &Path) -> Result<Self, PatchError> {
        Self::new(PatchFile::load(path)?, path)
    }

    /// Reads a patch from `text` as if it were the content of the file at `path`.
    ///
    /// # Errors
    /// As for [`load`](Self::load).
    pub fn parse(text: &str, path: &Path) -> Result<Self, PatchError> {
        Self::parse_with(text, path, &CanonicalFiles, &[])
    }

    /// As [`parse`](Self::parse), with the file of points in one of `formats`, and with keys set to other values.
    ///
    /// # Errors
    /// As for [`load`](Self::load); without file and line where it is the value of a key that is set.
    pub fn parse_with(
        text: &str,
        path: &Path,
        formats: &'static dyn FileFormats,
        settings: &[Setting],
    ) -> Result<Self, PatchError> {
        Self::new(PatchFile::parse_with(text, path, formats, settings)?, path)
    }

    fn new(mut file: PatchFile, path: &Path) -> Result<Self, PatchError> {
        let table_path = path.parent().unwrap_or(Path::new("")).join(&file.table);
        let (table, notes) = FrictionTable::read(&table_path, file.values.formats(), &file.table_columns)?;
        if file.backing.is_none() {
            table.check_alone()?;
        }
        file.notes.extend(notes.into_iter().map(|note| note.of(&file.table)));
        Ok(Self {
            nominal_area: nominal_area(&file, &table)?,
            temperature: temperature(&file, &table)?,
            heat: heat(&file, &table)?,
            face: Arc::new(face(&file)),
            table_extrapolation: file.table_extrapolation,
            refine: file.refine,
            backing: file.backing,
            damping: file.damping,
            input_rule: file.input_rule,
            files: file.files().into(),
            clearance: Clearance::new(&table),
            table: Arc::new(table),
            file: Arc::new(file),
        })
    }

    /// The patch's name.
    pub fn name(&self) -> &str {
        &self.file.name
    }

    /// How the files were read.
    pub fn notes(&self) -> &[ReadingNote] {
        &self.file.notes
    }

    /// What it is, in a sentence.
    pub fn description(&self) -> String {
        let (count, origin) = (self.face.count(), self.table.origin());
        format!("Contact patch of {count} elements from {} points {origin}", self.table.grid.count())
    }

    /// The table.
    pub fn table(&self) -> &FrictionTable {
        &self.table
    }

    /// The number of elements; of a tread with those that are partly inside.
    pub fn count(&self) -> usize {
        self.face.count()
    }

    /// Whether a tread runs through.
    pub fn has_tread(&self) -> bool {
        matches!(*self.face, Face::Tread(_))
    }

    /// Whether the temperature is an input.
    pub fn has_temperatures(&self) -> bool {
        self.table.grid.temperatures.len() > 1
    }

    /// The temperature at the start, K; 0 where the table has none.
    pub fn temperature(&self) -> f64 {
        self.temperature
    }

    /// The temperature (K) of the law where `kelvin` is given: that of the table's end beyond it. `None` where the
    /// table has one temperature at most.
    pub(super) fn held_temperature(&self, kelvin: f64) -> Option<f64> {
        self.temperatures().map(|(low, high)| kelvin.max(low).min(high))
    }

    /// The first and the last temperature of the table, K, of several.
    pub(super) fn temperatures(&self) -> Option<(f64, f64)> {
        match *self.table.grid.temperatures.as_slice() {
            [low, .., high] => Some((low, high)),
            _ => None,
        }
    }

    /// Whether the changes of the wrench with the targets of a step are asked for.
    pub(super) fn has_tangents(&self) -> bool {
        self.groups().contains(&PatchGroup::Tangent)
    }

    /// The groups of variables, in their order.
    pub fn groups(&self) -> &[PatchGroup] {
        &self.file.outputs
    }

    /// What its FMU's description says for simple importers.
    pub fn fmu_options(&self) -> FmuOptions {
        self.file.fmu
    }

    /// What stands behind every element, if that gives way.
    pub fn backing(&self) -> Option<Backing> {
        self.backing
    }

    /// τ of the dampers beside the springs along the plane and beside the backing, s.
    pub fn damping(&self) -> f64 {
        self.damping
    }

    /// Its dampers: along the normal only a backing has one.
    pub(super) fn dampers(&self) -> Damping {
        Damping { shear: self.damping, normal: if self.backing.is_some() { self.damping } else { 0.0 } }
    }

    /// How slip warms the elements, if it does.
    pub fn heat(&self) -> Option<FaceHeat> {
        self.heat
    }

    /// The same contacts on a rigid backing, without heating and damping.
    pub fn contacts_alone(&self) -> Self {
        Self { backing: None, heat: None, damping: 0.0, ..self.clone() }
    }

    /// The time (s) in which a face that is pressed the hardest passes the way to slip, at the largest speed of the table;
    /// `None` where nothing sticks.
    pub fn stick_time(&self) -> Option<f64> {
        self.table.stick_time(self.backing)
    }

    /// The time (s) in which a tread runs through its face at the largest speed of the table; `None` without one.
    pub fn passage_time(&self) -> Option<f64> {
        let Face::Tread(tread) = &*self.face else { return None };
        Some(tread.length / self.table.grid.speeds.last()?)
    }

    /// The largest tangential stiffness per area (Pa/m) of a contact at the largest pressure of the table, whatever its
    /// speed and temperature.
    pub fn contact_stiffness(&self) -> f64 {
        let load = self.table.grid.loads.len() - 1;
        let (temperatures, speeds) = (self.table.grid.temperatures.len().max(1), self.table.grid.speeds.len());
        let nodes =
            (0..temperatures).flat_map(|temperature| (0..speeds).map(move |speed| Node { temperature, load, speed }));
        let largest = nodes.map(|node| self.table.value(Quantity::Stiffness, node)).fold(0.0, f64::max);
        largest / self.nominal_area
    }

    /// The area that a layer of the table stands for, m².
    pub fn nominal_area(&self) -> f64 {
        self.nominal_area
    }

    /// The elements at the start of a run; a cell of a tread that is not in the contact yet has no area.
    pub fn elements(&self) -> impl Iterator<Item = PatchElement> {
        (0..self.count()).map(|index| {
            let ElementSite { place, area, .. } = self.element(index, 0.0);
            PatchElement { index, place, area }
        })
    }

    /// The patch of these elements alone, which stand on its face, with the same law.
    pub fn with_elements(&self, elements: impl IntoIterator<Item = PatchElement>) -> Self {
        let point = |PatchElement { place: [x, y, z], area, .. }| [x, y, z, area];
        let points = elements.into_iter().map(point).collect();
        let mut file = PatchFile::clone(&self.file);
        file.shape = FaceShape::Points { path: PathBuf::new(), points };
        (file.transport, file.offset) = (false, [0.0; 3]);
        self.with_file(file)
    }

    /// The patch with twice as many elements along x and along y.
    ///
    /// # Errors
    /// [`NotDoubled`] where the face is no grid or there would be too many elements.
    pub fn doubled(&self) -> Result<Self, NotDoubled> {
        Ok(self.with_file(self.file.doubled()?))
    }

    /// The patch with these groups of variables in place of its own.
    pub fn with_groups(&self, outputs: Vec<PatchGroup>) -> Self {
        let mut file = PatchFile::clone(&self.file);
        file.outputs = outputs;
        self.with_file(file)
    }

    /// The patch with another face or other groups of variables.
    fn with_file(&self, file: PatchFile) -> Self {
        Self { face: Arc::new(face(&file)), file: Arc::new(file), ..self.clone() }
    }

    /// The face as its file has it.
    pub fn shape(&self) -> &FaceShape {
        &self.file.shape
    }

    /// Elements along and across the face, of a grid.
    pub fn grid(&self) -> Option<(usize, usize)> {
        match &self.file.shape {
            FaceShape::Flat(grid) | FaceShape::Cylinder { grid, .. } => Some((grid.nx, grid.ny)),
            FaceShape::Points { .. } => None,
        }
    }

    /// Elements across the face, of a grid.
    pub fn rows(&self) -> Option<usize> {
        self.grid().map(|(_, across)| across)
    }

    /// Paths of the files that it reads besides its own, relative to that one's folder.
    pub fn files(&self) -> &[PathBuf] {
        &self.files
    }

    /// What an FMU carries of one of the [`files`](Self::files): points and measured friction in their canonical form, the
    /// table of a sweep as it is.
    ///
    /// # Errors
    /// Where it cannot be read.
    pub fn carried(&self, folder: &Path, file: &Path) -> std::io::Result<Vec<u8>> {
        match &self.file.shape {
            FaceShape::Points { path, points } if path == file => {
                let columns = [0, 1, 2, 3].map(|i| points.iter().map(|point| point[i]).collect::<Vec<f64>>());
                let roles = POINTS.roles.iter().zip(&columns);
                let columns: Vec<_> = roles.map(|(role, values)| (role.key, role.dimension, &values[..])).collect();
                Ok(canonical(&columns).into_bytes())
            }
            _ => match self.table.canonical() {
                Some(text) => Ok(text.into_bytes()),
                None => read_file(&folder.join(file)),
            },
        }
    }

    /// The file of the table, relative to the patch's folder; it is one of the [`files`](Self::files).
    pub fn table_file(&self) -> &Path {
        &self.file.table
    }

    /// Paths of the files that it was read from; `path` is that of its own.
    pub fn sources(&self, path: &Path) -> Vec<PathBuf> {
        let folder = path.parent().unwrap_or(Path::new(""));
        std::iter::once(path.to_owned()).chain(self.files.iter().map(|file| folder.join(file))).collect()
    }

    /// A height (m) just above the touch, where nothing touches at any temperature of the table when the body is level.
    pub fn clear_height(&self) -> f64 {
        self.clearance.displacement(self.face.lowest())
    }

    pub(super) fn law(&self) -> ResampledLaw {
        let law = if self.heat.is_some() { ResampledLaw::of_warm_elements } else { ResampledLaw::new };
        law(&self.table, self.nominal_area, self.temperature, self.backing)
    }

    /// Memory in bytes that its law takes.
    pub(super) fn law_memory(&self) -> usize {
        ResampledLaw::memory(&self.table, self.nominal_area, self.backing, self.heat.is_some())
    }

    /// An element where `entered` cells of the tread have entered.
    pub(super) fn element(&self, i: usize, entered: f64) -> ElementSite {
        match &*self.face {
            Face::Points(points) => {
                let place = [points.x[i], points.y[i], points.z[i]];
                ElementSite { place, area: points.area[i], direction: [1.0, 0.0] }
            }
            Face::Tread(tread) => {
                let rows = tread.rows.len();
                let column = tread.column((i / rows) as f64, entered);
                let place = [column.place[0], tread.rows[i % rows], column.place[1]];
                ElementSite { place, area: tread.area * column.share, direction: column.direction }
            }
        }
    }

    /// The parameters.
    pub fn parameters(&self) -> Vec<Parameter> {
        let others = [
            Parameter::TABLE_EXTRAPOLATION,
            Parameter::EXTRAPOLATION,
            Parameter::INTERVAL,
            Parameter::REFINE,
            Parameter::DAMPING,
        ];
        let reals =
            REALS.map(|(parameter, _)| parameter).into_iter().filter(|&parameter| self.real(parameter).is_some());
        others.into_iter().chain(reals).collect()
    }

    /// The value of a Real parameter, if the patch has it.
    fn real(&self, parameter: Parameter) -> Option<f64> {
        let (mut backing, mut heat) = (self.backing, self.heat);
        real_of(parameter)?(&mut backing, &mut heat).copied()
    }

    /// The value of a parameter.
    pub fn parameter(&self, parameter: Parameter) -> Value {
        match parameter {
            Parameter::TABLE_EXTRAPOLATION => Value::Text(self.table_extrapolation.word().into()),
            Parameter::DAMPING => Value::Real(self.damping),
            Parameter::REFINE => Value::Integer(i32::try_from(self.refine).unwrap_or(i32::MAX)),
            _ => {
                let real = || Value::Real(self.real(parameter).unwrap_or(0.0));
                self.input_rule.parameter(parameter).unwrap_or_else(real)
            }
        }
    }

    /// Gives the parameter called `name` the value that `text` stands for.
    ///
    /// # Errors
    /// [`ParameterError`] as for [`set_parameter`](Self::set_parameter), and for an unknown name.
    pub fn set_by_name(&mut self, name: &str, text: &str) -> Result<(), ParameterError> {
        let names = || self.parameters().into_iter().map(Parameter::name).collect();
        let parameter = self.parameters().into_iter().find(|parameter| parameter.name() == name);
        let unknown = || Problem::Unknown { allowed: names(), similar: Vec::new() };
        let parameter = parameter.ok_or_else(|| ParameterError::new(name, unknown()))?;
        let text = text.trim();
        let value = match parameter {
            Parameter::REFINE => text.parse().ok().map(Value::Integer),
            Parameter::INTERVAL | Parameter::DAMPING => text.parse().ok().map(Value::Real),
            _ if real_of(parameter).is_some() => text.parse().ok().map(Value::Real),
            _ => None,
        };
        self.set_parameter(parameter, value.unwrap_or_else(|| Value::Text(text.to_owned())))
    }

    /// Gives a parameter a value.
    ///
    /// # Errors
    /// [`ParameterError`] where the value is none of those allowed; the patch is then as it was.
    pub fn set_parameter(&mut self, parameter: Parameter, value: Value) -> Result<(), ParameterError> {
        let refused = || {
            let expected = match parameter {
                _ if real_of(parameter).is_some() => {
                    "a number above 0, of a patch with a backing, or with heat".to_owned()
                }
                _ => parameter.allowed(),
            };
            let problem = Problem::Value { given: value.to_string(), expected };
            ParameterError::new(parameter.name(), problem)
        };
        if self.input_rule.set_parameter(parameter, &value)?
            || self.table_extrapolation.set_parameter(parameter, &value)?
        {
            return Ok(());
        }
        match (parameter, &value) {
            (Parameter::REFINE, &Value::Integer(refine)) => {
                let allowed = u32::try_from(refine).ok().filter(|refine| (1..=1000).contains(refine));
                self.refine = allowed.ok_or_else(refused)?;
            }
            (Parameter::DAMPING, &Value::Real(damping)) => self.damping = parameter.check_number(damping)?,
            (_, &Value::Real(number)) => {
                let real = real_of(parameter).ok_or_else(refused)?;
                let number = parameter.check_number(number)?;
                *real(&mut self.backing, &mut self.heat).ok_or_else(refused)? = number;
            }
            _ => return Err(refused()),
        }
        Ok(())
    }
}

/// Slip that warms the elements takes a table that says what their temperature does.
fn heat(file: &PatchFile, table: &FrictionTable) -> Result<Option<FaceHeat>, PatchError> {
    let temperatures = table.grid.temperatures.len();
    if file.heat.is_some() && temperatures < 2 { Err(file.refuse_heat(temperatures).into()) } else { Ok(file.heat) }
}

/// A table of pressures says the area itself, one of forces does not.
fn nominal_area(file: &PatchFile, table: &FrictionTable) -> Result<f64, PatchError> {
    match (table.load, file.nominal_area) {
        (Load::Pressure { area }, None) => Ok(area),
        (Load::Force, Some(area)) => Ok(area),
        (Load::Pressure { .. }, Some(_)) => Err(file.refuse_nominal_area("none: the table says its area").into()),
        (Load::Force, None) => Err(file.refuse_nominal_area("the area of a layer: the table is one of forces").into()),
    }
}

fn temperature(file: &PatchFile, table: &FrictionTable) -> Result<f64, PatchError> {
    let all = &table.grid.temperatures;
    let (Some(low), Some(high)) = (all.first(), all.last()) else {
        let refused = || file.refuse_temperature("none: the table has no temperatures".into());
        return if file.temperature.is_some() { Err(refused().into()) } else { Ok(0.0) };
    };
    let kelvin = file.temperature.unwrap_or(all[all.len() / 2]);
    if (low..=high).contains(&&kelvin) {
        return Ok(kelvin);
    }
    Err(file.refuse_temperature(format!("a number from {low:?} to {high:?}, the temperatures of the table")).into())
}

/// The middles of `count` even parts of a length about its middle, the last one first.
fn middles(length: f64, count: usize) -> impl Iterator<Item = f64> {
    (0..count).map(move |i| length * (0.5 - (i as f64 + 0.5) / count as f64))
}

fn face(file: &PatchFile) -> Face {
    let (radius, grid) = match &file.shape {
        FaceShape::Flat(grid) => (None, grid),
        FaceShape::Cylinder { radius, grid } => (Some(*radius), grid),
        FaceShape::Points { points, .. } => return Face::Points(single_points(points, file.offset)),
    };
    let Grid { length, width, nx, ny } = *grid;
    let tread = Tread {
        section: Section { radius },
        length,
        cell: length / nx as f64,
        columns: nx,
        rows: middles(width, ny).map(|y| file.offset[1] - y).collect(),
        area: length / nx as f64 * (width / ny as f64),
        offset: file.offset,
    };
    if file.transport { Face::Tread(tread) } else { Face::Points(standing(tread)) }
}

fn single_points(points: &[[f64; 4]], offset: [f64; 3]) -> FixedPoints {
    let axis = |i: usize| points.iter().map(|point| point[i] + offset[i]).collect();
    let area = points.iter().map(|point| point[3]).collect();
    FixedPoints { x: axis(0), y: axis(1), z: axis(2), area, grid: None }
}

/// The cells of a tread that does not run.
fn standing(tread: Tread) -> FixedPoints {
    let mut points = FixedPoints::default();
    for column in (1..=tread.columns).map(|i| tread.column(i as f64, 0.0)) {
        for &y in &tread.rows {
            points.x.push(column.place[0]);
            points.y.push(y);
            points.z.push(column.place[1]);
            points.area.push(tread.area);
        }
    }
    FixedPoints { grid: Some(tread), ..points }
}
