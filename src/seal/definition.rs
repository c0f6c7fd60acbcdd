//! The definition of a seal: its table, the pressures on its lip, its fluid.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::film::Film;
use super::law::GapLaw;
use crate::element::{FrictionTable, Load, Quantity};
use crate::math::interval_of;
use crate::scene::{
    Air, FileFormats, FmuOptions, InputRule, LIP_PRESSURES, LipSet, Parameter, ParameterError, Problem, RoughSide,
    SceneError, SealFile, SealGroup, Setting, TableExtrapolation, Value, read_file,
};
use crate::table::TableError;
use crate::tables::{ReadingNote, canonical};

/// Why a seal is refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SealError {
    /// The seal file or the file of pressures.
    #[error(transparent)]
    File(#[from] SceneError),
    /// The table.
    #[error(transparent)]
    Table(#[from] TableError),
}

/// The definition of a seal.
#[derive(Clone, Debug)]
pub struct Seal {
    pub(super) file: Arc<SealFile>,
    pub(super) table: Arc<FrictionTable>,
    /// The pressures on the cells.
    pub(super) lip: Arc<LipPressures>,
    temperature: f64,
    /// How inputs go on when a master gives no rates.
    pub input_rule: InputRule,
    /// Admissible error of a step, over the contents.
    pub relative_tolerance: f64,
    /// What happens where the table, or the sets of pressures, end.
    pub table_extrapolation: TableExtrapolation,
}

/// The total pressure on the cells of a lip over the sealed pressure: between sets it is straight.
#[derive(Clone, Debug)]
pub(super) struct LipPressures {
    /// The sealed pressures of the sets, Pa, rising.
    pub(super) sealed: Vec<f64>,
    /// For each set the pressures in the middle of the cells, Pa, and behind them that at the sealed side.
    cells: Vec<Vec<f64>>,
    /// The width of the lip, m.
    pub(super) width: f64,
}

impl LipPressures {
    fn new(sets: &[LipSet], count: usize) -> Self {
        let width = sets[0].x.last().copied().unwrap_or_default();
        let of_set = |set: &LipSet| {
            let middle = |i: usize| set.pressure_at((i as f64 + 0.5) / count as f64 * width);
            (0..count).map(middle).chain([set.pressures[0]]).collect()
        };
        Self { sealed: sets.iter().map(|set| set.sealed).collect(), cells: sets.iter().map(of_set).collect(), width }
    }

    /// The sealed pressures that sets reach over, Pa; of one set any.
    pub(super) fn range(&self) -> (f64, f64) {
        match *self.sealed.as_slice() {
            [first, .., last] => (first, last),
            _ => (0.0, f64::INFINITY),
        }
    }

    /// The set before a sealed pressure (Pa), and how far it is on the way to the next; beyond the sets straight on.
    fn place(&self, sealed: f64) -> (usize, f64) {
        if self.sealed.len() < 2 {
            return (0, 0.0);
        }
        let i = interval_of(&self.sealed, sealed);
        (i, (sealed - self.sealed[i]) / (self.sealed[i + 1] - self.sealed[i]))
    }

    /// The pressure on a cell, or behind the last at the sealed side, at a [place](Self::place), lifted by so much, Pa.
    fn at(&self, (set, share): (usize, f64), cell: usize, lifted: f64) -> f64 {
        let here = self.cells[set][cell];
        let next = self.cells.get(set + 1).map_or(here, |next| next[cell]);
        (here + share * (next - here) - lifted).max(0.0)
    }
}

impl LipSet {
    /// The pressure at a place (m) of the width, straight between those given, Pa.
    fn pressure_at(&self, x: f64) -> f64 {
        let i = interval_of(&self.x, x);
        let share = (x - self.x[i]) / (self.x[i + 1] - self.x[i]);
        self.pressures[i] + share * (self.pressures[i + 1] - self.pressures[i])
    }
}

/// A parameter that is a number of a seal file: its value, and where that is.
type Real = (Parameter, fn(&SealFile) -> Option<f64>, fn(&mut SealFile) -> Option<&mut f64>);

const REALS: [Real; 4] = [
    (Parameter::new("seal.length"), |file| Some(file.length), |file| Some(&mut file.length)),
    (Parameter::new("seal.stiffness"), |file| file.stiffness, |file| file.stiffness.as_mut()),
    (
        Parameter::new("seal.approach_stiffness"),
        |file| file.approach_stiffness,
        |file| file.approach_stiffness.as_mut(),
    ),
    (Parameter::new("fluid.supply"), |file| Some(file.supply), |file| Some(&mut file.supply)),
];

impl Seal {
    /// Reads the seal file at `path` and the files that it names.
    ///
    /// # Errors
    /// [`SealError`] with the file, the line, the key, what was given and what is allowed.
    pub fn load(path: &Path) -> Result<Self, SealError> {
        Self::new(SealFile::load(path)?, path)
    }

    /// Reads a seal from `text` as if it were the content of the file at `path`, with the file of pressures in one of
    /// `formats`, and with keys set to other values.
    ///
    /// # Errors
    /// As for [`load`](Self::load); without file and line where it is the value of a key that is set.
    pub fn parse_with(
        text: &str,
        path: &Path,
        formats: &'static dyn FileFormats,
        settings: &[Setting],
    ) -> Result<Self, SealError> {
        Self::new(SealFile::parse_with(text, path, formats, settings)?, path)
    }

    fn new(mut file: SealFile, path: &Path) -> Result<Self, SealError> {
        let table_path = path.parent().unwrap_or(Path::new("")).join(&file.table);
        let (table, notes) = FrictionTable::read(&table_path, file.values.formats(), &file.table_columns)?;
        check_table(&table)?;
        file.notes.extend(notes.into_iter().map(|note| note.of(&file.table)));
        Ok(Self {
            temperature: temperature(&file, &table)?,
            lip: Arc::new(LipPressures::new(&file.sets, file.cells)),
            input_rule: file.input_rule,
            relative_tolerance: file.relative_tolerance,
            table_extrapolation: file.table_extrapolation,
            table: Arc::new(table),
            file: Arc::new(file),
        })
    }

    /// The same with a lip that does not give way along the motion.
    #[must_use]
    pub fn rigid(&self) -> Self {
        Self { file: Arc::new(SealFile { stiffness: None, ..(*self.file).clone() }), ..self.clone() }
    }

    /// The seal's name.
    pub fn name(&self) -> &str {
        &self.file.name
    }

    /// What it is, in a sentence.
    pub fn description(&self) -> String {
        let (cells, origin) = (self.file.cells, self.table.origin());
        let film = if self.table.is_measured() { "without" } else { "with" };
        format!("Lip {film} a film, of {cells} cells over its width, its contact {origin}")
    }

    /// What its file says.
    pub fn file(&self) -> &SealFile {
        &self.file
    }

    /// The table of its contact.
    pub fn table(&self) -> &FrictionTable {
        &self.table
    }

    /// How the files were read.
    pub fn notes(&self) -> &[ReadingNote] {
        &self.file.notes
    }

    /// The groups of variables, in their order.
    pub fn groups(&self) -> &[SealGroup] {
        &self.file.outputs
    }

    /// What its FMU's description says for simple importers.
    pub fn fmu_options(&self) -> FmuOptions {
        self.file.fmu
    }

    /// The cells over the width.
    pub fn cells(&self) -> usize {
        self.file.cells
    }

    /// The sealed pressures that the sets of pressures reach over, Pa; of one set any.
    pub fn sealed_pressures(&self) -> (f64, f64) {
        self.lip.range()
    }

    /// The width of the lip, m.
    pub fn width(&self) -> f64 {
        self.lip.width
    }

    /// The middle one of the table's speeds, m/s.
    pub fn middle_speed(&self) -> f64 {
        let speeds = &self.table.grid.speeds;
        speeds[speeds.len() / 2]
    }

    /// The area of a cell, m².
    pub(super) fn cell_area(&self) -> f64 {
        self.file.length * self.lip.width / self.file.cells as f64
    }

    /// The temperature at the start, K; 0 where the table has none and the fluid does not depend on it.
    pub fn temperature(&self) -> f64 {
        self.temperature
    }

    /// The sealed pressure at the start, Pa: the least of the sets.
    pub fn sealed_pressure(&self) -> f64 {
        self.lip.sealed[0]
    }

    /// Whether the temperature is an input.
    pub fn has_temperatures(&self) -> bool {
        self.table.grid.temperatures.len() > 1 || self.file.viscosity.depends_on_temperature()
    }

    /// The first and the last temperature of the table, K, of several.
    pub(super) fn temperatures(&self) -> Option<(f64, f64)> {
        match *self.table.grid.temperatures.as_slice() {
            [low, .., high] => Some((low, high)),
            _ => None,
        }
    }

    /// The temperature (K) of the contact's law where `kelvin` is given: that of the table's end beyond it.
    fn held_temperature(&self, kelvin: f64) -> f64 {
        self.temperatures().map_or(kelvin, |(low, high)| kelvin.max(low).min(high))
    }

    /// Whether the lip can be lifted.
    pub fn can_be_lifted(&self) -> bool {
        self.file.approach_stiffness.is_some()
    }

    /// The law of its contact at a temperature (K) and a speed (m/s).
    pub(super) fn law(&self, temperature: f64, speed: f64) -> GapLaw {
        GapLaw::new(&self.table, self.held_temperature(temperature), speed)
    }

    /// Takes the law of its contact and the fluid's viscosity to a temperature (K) and a speed (m/s).
    pub(super) fn set_temperature(&self, law: &mut GapLaw, film: &mut Film, temperature: f64, speed: f64) {
        law.set(self.held_temperature(temperature), speed);
        film.set_viscosity(self.file.viscosity.at(temperature));
    }

    /// Presses the lip under a sealed pressure (Pa), lifted by w (m).
    pub(super) fn press(&self, law: &GapLaw, film: &mut Film, sealed: f64, w: f64) {
        let (place, lifted) = (self.lip.place(sealed), self.lifted(w));
        film.set_totals(law, |i| self.lip.at(place, i, lifted));
    }

    /// The pressure at the sealed side under a sealed pressure (Pa), lifted by w (m), Pa.
    pub(super) fn pressure_at_sealed_side(&self, sealed: f64, w: f64) -> f64 {
        self.lip.at(self.lip.place(sealed), self.cells(), self.lifted(w))
    }

    /// How much a lip that is lifted by w (m) is pressed less, Pa.
    fn lifted(&self, w: f64) -> f64 {
        self.file.approach_stiffness.map_or(0.0, |stiffness| stiffness * w)
    }

    pub(super) fn is_rough_side_moving(&self) -> bool {
        self.file.rough == RoughSide::Moving
    }

    pub(super) fn air(&self) -> Air {
        self.file.air
    }

    /// The parameters, in the order of their variables.
    pub fn parameters(&self) -> Vec<Parameter> {
        let others = [
            Parameter::TABLE_EXTRAPOLATION,
            Parameter::EXTRAPOLATION,
            Parameter::INTERVAL,
            Parameter::RELATIVE_TOLERANCE,
        ];
        let reals =
            REALS.map(|(parameter, ..)| parameter).into_iter().filter(|&parameter| self.real(parameter).is_some());
        others.into_iter().chain(reals).collect()
    }

    /// The value of a number of its file, if it has it.
    fn real(&self, parameter: Parameter) -> Option<f64> {
        let (_, value, _) = REALS.iter().find(|(own, ..)| *own == parameter)?;
        value(&self.file)
    }

    /// The value of a parameter.
    pub fn parameter(&self, parameter: Parameter) -> Value {
        match parameter {
            Parameter::TABLE_EXTRAPOLATION => Value::Text(self.table_extrapolation.word().into()),
            Parameter::RELATIVE_TOLERANCE => Value::Real(self.relative_tolerance),
            _ => {
                let real = || Value::Real(self.real(parameter).unwrap_or(0.0));
                self.input_rule.parameter(parameter).unwrap_or_else(real)
            }
        }
    }

    /// Gives a parameter a value.
    ///
    /// # Errors
    /// [`ParameterError`] where the value is none of those allowed; the seal is then as it was.
    pub fn set_parameter(&mut self, parameter: Parameter, value: Value) -> Result<(), ParameterError> {
        if self.input_rule.set_parameter(parameter, &value)?
            || self.table_extrapolation.set_parameter(parameter, &value)?
        {
            return Ok(());
        }
        let problem = Problem::Value { given: value.to_string(), expected: parameter.allowed() };
        let refused = ParameterError::new(parameter.name(), problem);
        let Value::Real(number) = value else { return Err(refused) };
        if parameter == Parameter::RELATIVE_TOLERANCE {
            self.relative_tolerance = parameter.check_number(number)?;
            return Ok(());
        }
        let (.., real) = REALS.iter().find(|(own, ..)| *own == parameter).ok_or_else(|| refused.clone())?;
        *real(Arc::make_mut(&mut self.file)).ok_or(refused)? = parameter.check_number(number)?;
        Ok(())
    }

    /// Paths of the files that it reads besides its own, relative to that one's folder.
    pub fn files(&self) -> [&PathBuf; 2] {
        self.file.files()
    }

    /// What an FMU carries of one of the [`files`](Self::files): pressures and measured friction in their canonical form, the
    /// table of a sweep as it is.
    ///
    /// # Errors
    /// Where it cannot be read.
    pub fn carried(&self, folder: &Path, file: &Path) -> std::io::Result<Vec<u8>> {
        if file != self.file.pressure {
            return match self.table.canonical() {
                Some(text) => Ok(text.into_bytes()),
                None => read_file(&folder.join(file)),
            };
        }
        let mut columns = [const { Vec::new() }; 3];
        for set in &self.file.sets {
            for (x, pressure) in set.x.iter().zip(&set.pressures) {
                columns.iter_mut().zip([set.sealed, *x, *pressure]).for_each(|(column, value)| column.push(value));
            }
        }
        let roles = LIP_PRESSURES.roles.iter().zip(&columns);
        let columns: Vec<_> = roles.map(|(role, values)| (role.key, role.dimension, &values[..])).collect();
        Ok(canonical(&columns).into_bytes())
    }

    /// Paths of the files that it was read from; `path` is that of its own.
    pub fn sources(&self, path: &Path) -> Vec<PathBuf> {
        let folder = path.parent().unwrap_or(Path::new(""));
        std::iter::once(path.to_owned()).chain(self.files().map(|file| folder.join(file))).collect()
    }
}

/// A film needs gaps, under pressures; friction that was measured is without one.
fn check_table(table: &FrictionTable) -> Result<(), TableError> {
    if table.is_measured() {
        return Ok(());
    }
    let problem = if !matches!(table.load, Load::Pressure { .. }) {
        "a table of forces; a seal needs one of pressures, asperity sweep --pressures"
    } else if !table.has(Quantity::LeakGap) || !table.has(Quantity::DragGap) {
        "no columns leak_gap and drag_gap, which a film needs: sweep the scene again with --gaps"
    } else if table.needs_backing() {
        "has points in full contact, where no film is between: leave their pressures out"
    } else {
        return Ok(());
    };
    Err(table.header.error(problem))
}

/// The temperature at the start: given, or the middle one of the table's.
fn temperature(file: &SealFile, table: &FrictionTable) -> Result<f64, SceneError> {
    let temperatures = &table.grid.temperatures;
    let of_fluid = file.viscosity.depends_on_temperature();
    match file.temperature {
        None => {
            let own = temperatures.get(temperatures.len().saturating_sub(1) / 2).copied();
            Ok(own.or_else(|| file.viscosity.temperatures().next()).unwrap_or(0.0))
        }
        Some(kelvin) => {
            let refused = |expected: String| Err(file.refuse("table.temperature", format!("{kelvin:?}"), expected));
            match *temperatures.as_slice() {
                [] if of_fluid => Ok(kelvin),
                [] => refused("no such key with a table without temperatures and one viscosity".to_owned()),
                [only] if !of_fluid && kelvin != only => refused(format!("{only:?}, that of the table")),
                [low, .., high] if !(low..=high).contains(&kelvin) => {
                    refused(format!("a number from {low:?} to {high:?}"))
                }
                _ => Ok(kelvin),
            }
        }
    }
}
