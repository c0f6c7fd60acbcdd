//! A table of moduli in a file: which columns make its curves - one, or one for each temperature or frequency -, and what its
//! rows say.

use std::f64::consts::{FRAC_PI_2, TAU};

use asperity::scene::Wlf;
use asperity::tables::{ABOVE_ZERO, ContentError, Dimension, POSITIVE, ReadColumn, shortened};
use asperity_formats::text::{Block, Decimal, Line, Row, UsedColumn, assumed_unit, decimal_of, plain, told};

use super::columns::{self, Column, Columns, with_unit};
use super::compound::{Sample, Test};
use super::conditions::{Condition, Setting, conditions_above, setting};
use super::options::FitOptions;

/// What a row of a table says of one curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct MeasuredPoint {
    /// Line number in the file.
    pub(super) line: usize,
    pub(super) sample: Sample,
    /// K.
    pub(super) temperature: Option<f64>,
    /// a_T as the table has it.
    pub(super) shift: Option<f64>,
    /// b_T as the table has it.
    pub(super) vertical: Option<f64>,
    /// The measurement that it belongs to, where the table numbers them.
    pub(super) set: Option<f64>,
}

/// One curve of a table: its columns. A table has one, or one for each temperature or frequency.
#[derive(Clone, Debug)]
struct Curve {
    /// Frequency or time; `None` where there is no such column.
    at: Option<Column>,
    modulus: Column,
    loss: Option<Column>,
    /// K.
    temperature: Option<f64>,
    /// rad/s.
    frequency: Option<f64>,
}

impl Curve {
    /// Its columns.
    fn columns(&self) -> impl Iterator<Item = &Column> {
        [self.at.as_ref(), Some(&self.modulus), self.loss.as_ref()].into_iter().flatten()
    }

    /// With what holds for all of it.
    fn under(self, condition: Option<Condition>) -> Self {
        let of = |dimension| condition.filter(|found| found.dimension == dimension).map(|found| found.value);
        Self { temperature: of(Dimension::Temperature), frequency: of(Dimension::Frequency), ..self }
    }
}

/// The columns by what they are for: frequencies or times, moduli, losses.
#[derive(Debug)]
struct Chosen {
    at: Vec<Column>,
    moduli: Vec<Column>,
    losses: Vec<Column>,
}

impl Chosen {
    /// `None` where there are no moduli.
    fn of(columns: &Columns) -> Result<Option<Self>, ContentError> {
        let (at, times) = (columns.first(&["frequency"]), columns.first(&["time"]));
        let relaxed = columns.first(&["relaxation_modulus", "shear_relaxation_modulus"]);
        if at.is_empty() && !times.is_empty() && !relaxed.is_empty() {
            return Ok(Some(Self { at: times, moduli: relaxed, losses: Vec::new() }));
        }
        let moduli =
            columns.first(&["storage_modulus", "shear_storage_modulus", "complex_modulus", "complex_shear_modulus"]);
        let kind = moduli.first().map(|column| column.key);
        let losses = columns.first(match kind {
            Some("storage_modulus") => &["loss_modulus", "loss_tangent", "phase_angle"],
            Some("shear_storage_modulus") => &["shear_loss_modulus", "loss_modulus", "loss_tangent", "phase_angle"],
            Some(_) => &["phase_angle", "loss_tangent"],
            None => &["loss_modulus", "shear_loss_modulus", "loss_tangent", "phase_angle"],
        });
        let missing = |expected: &str| Err(ContentError::value(Some(columns.line), "", "", expected));
        match (kind, losses.is_empty()) {
            (None, true) => Ok(None),
            (None, false) => missing("a column of the storage modulus: E' [MPa]"),
            (Some("complex_modulus" | "complex_shear_modulus"), true) => {
                missing("a column of the phase beside |E*|: delta [°] or tan delta")
            }
            (Some(_), true) => missing("a column of the loss: E'' [MPa] or tan delta"),
            _ => Ok(Some(Self { at, moduli, losses })),
        }
    }

    /// A second column of frequencies beside one of moduli.
    fn take_other_frequency(&mut self) -> Option<Column> {
        let has_two = self.at.len() == 2 && self.moduli.len() == 1 && self.at[0].is(&["frequency"]);
        if has_two { self.at.pop() } else { None }
    }

    /// One curve, or a pair of columns for each temperature, or for each frequency where there is no column of these.
    fn curves(&self, block: &Block<'_>, columns: &Columns, options: &FitOptions) -> Result<Vec<Curve>, ContentError> {
        let Self { at, moduli, losses } = self;
        let curves = if let [modulus] = &moduli[..] {
            match twin(columns.line, at).or_else(|| twin(columns.line, losses)) {
                Some(error) => Err(error),
                None => {
                    let (at, modulus, loss) = (at.first().cloned(), modulus.clone(), losses.first().cloned());
                    let condition = modulus.condition;
                    Ok(vec![Curve { at, modulus, loss, temperature: None, frequency: None }.under(condition)])
                }
            }
        } else {
            self.check_counts(columns.line)?;
            self.pairs(block, columns, options)
        }?;
        let has_none = |curve: &Curve| curve.at.is_none() && curve.frequency.or(options.frequency).is_none();
        if curves.iter().any(has_none) {
            let expected = "a frequency column, f [Hz] or omega [rad/s]; or `frequency` 10Hz for all rows";
            return Err(ContentError::value(Some(columns.line), "", "", expected));
        }
        Ok(curves)
    }

    /// Of several columns of moduli there are as many of losses, and one of frequencies or as many.
    fn check_counts(&self, line: usize) -> Result<(), ContentError> {
        let Self { at, moduli, losses } = self;
        let fits = |count: usize| count == moduli.len();
        if (losses.is_empty() || fits(losses.len())) && (at.len() <= 1 || fits(at.len())) {
            return Ok(());
        }
        let given =
            format!("{} columns of moduli, {} of losses, {} of frequencies", moduli.len(), losses.len(), at.len());
        let expected = "a pair of moduli a temperature or frequency, and one frequency or one for each";
        Err(ContentError::value(Some(line), "", &given, expected))
    }

    fn pairs(&self, block: &Block<'_>, columns: &Columns, options: &FitOptions) -> Result<Vec<Curve>, ContentError> {
        let Self { at, moduli, losses } = self;
        let of_frequency = |column: &Column| column.condition.is_some_and(|it| it.dimension == Dimension::Frequency);
        let has_temperatures = !columns.first(&["temperature", "set_temperature"]).is_empty();
        let by_frequency = at.is_empty() && (has_temperatures || moduli.iter().all(of_frequency));
        let dimension = if by_frequency { Dimension::Frequency } else { Dimension::Temperature };
        let above = conditions_above(block, columns.line, &options.units, dimension)?;
        let pairs = Pairs { above: &above, line: columns.line, dimension };
        let curve = |(i, modulus): (usize, &Column)| {
            let value = pairs.condition(modulus).ok_or_else(|| {
                let expected = match dimension {
                    Dimension::Frequency => {
                        "its frequency, in its name (E' [MPa] 1 Hz) or in the line above; or one column of a kind: \
                         `ignore` NAME"
                    }
                    _ => {
                        "its temperature, in its name (E' [MPa] 20 °C) or in the line above; or one column of a kind: \
                         `ignore` NAME"
                    }
                };
                modulus.refuse(columns.line, "", expected)
            })?;
            let at = if at.len() == 1 { at.first().cloned() } else { pairs.partner(at, i, value)? };
            let loss = pairs.partner(losses, i, value)?;
            let curve = Curve { at, modulus: modulus.clone(), loss, temperature: None, frequency: None };
            Ok(curve.under(Some(Condition { dimension, value })))
        };
        moduli.iter().enumerate().map(curve).collect()
    }
}

/// Finds which columns belong together.
struct Pairs<'c> {
    /// What the line above the names says, in SI units.
    above: &'c [Option<f64>],
    line: usize,
    /// Of what tells them apart.
    dimension: Dimension,
}

impl Pairs<'_> {
    fn condition(&self, column: &Column) -> Option<f64> {
        let own = column.condition.filter(|condition| condition.dimension == self.dimension);
        own.map(|condition| condition.value).or_else(|| self.above.get(column.index).copied().flatten())
    }

    /// The column for place `i`, where its condition is this `value` or none is named; else the only one of that value.
    fn partner(&self, columns: &[Column], i: usize, value: f64) -> Result<Option<Column>, ContentError> {
        let Some(own) = columns.get(i) else { return Ok(None) };
        if self.condition(own).is_none_or(|other| other == value) {
            return Ok(Some(own.clone()));
        }
        let mut alike = columns.iter().filter(|column| self.condition(column) == Some(value));
        match (alike.next(), alike.next()) {
            (Some(found), None) => Ok(Some(found.clone())),
            _ => {
                let expected = match self.dimension {
                    Dimension::Frequency => format!("one column of its kind at {:.4} Hz", value / TAU),
                    _ => format!("one column of its kind at {value:.2} K"),
                };
                Err(own.refuse(self.line, "", &expected))
            }
        }
    }
}

/// Two columns of one kind, where one is used, are one too many.
fn twin(line: usize, columns: &[Column]) -> Option<ContentError> {
    let [first, second, ..] = columns else { return None };
    let expected = format!("one column of a kind: {} is there already; ignore one by `ignore` NAME", first.text);
    Some(second.refuse(line, "", &expected))
}

/// E' of any rubber is above it, Pa: without a unit, a modulus below it is in another one.
const SOFTEST: f64 = 1e3;

/// A table of moduli in a file.
#[derive(Debug)]
pub(super) struct ModuliTable<'a> {
    block: Block<'a>,
    /// The line of its names.
    pub(super) line: usize,
    curves: Vec<Curve>,
    temperature: Option<Column>,
    /// A temperature above it that has no unit, and its line.
    bare_temperature: Option<(usize, String)>,
    /// The line above it whose temperature holds, and its text.
    temperature_line: Option<(usize, String)>,
    shift: Option<Column>,
    vertical: Option<Column>,
    set: Option<Column>,
    /// A second column of frequencies, to compare.
    other_frequency: Option<Column>,
    /// tan δ beside E'', to compare.
    tangent: Option<Column>,
    columns: Columns,
}

impl<'a> ModuliTable<'a> {
    /// The table in a block, with the header of the one before it where it has none of its own; `None` where its
    /// columns are none of moduli.
    pub(super) fn read(
        block: &Block<'a>,
        before: Option<&Self>,
        options: &FitOptions,
    ) -> Result<Option<Self>, ContentError> {
        let found = Self::with_own_header(block, options)?;
        let alike = |table: &&Self| (table.block.separator, table.block.columns) == (block.separator, block.columns);
        match before.filter(alike).filter(|_| found.is_none()) {
            Some(before) => {
                let header: Vec<Line<'a>> =
                    before.block.above.iter().copied().filter(|(line, _)| *line >= before.line).collect();
                Self::with_own_header(&block.with_header(&header), options)
            }
            None => Ok(found),
        }
    }

    fn with_own_header(block: &Block<'a>, options: &FitOptions) -> Result<Option<Self>, ContentError> {
        let Some(columns) = Columns::read(block, options)? else { return Ok(None) };
        let Some(mut chosen) = Chosen::of(&columns)? else { return Ok(None) };
        let other_frequency = chosen.take_other_frequency();
        let curves = chosen.curves(block, &columns, options)?;
        let is_loss = |loss: &Column| loss.is(&["loss_modulus", "shear_loss_modulus"]);
        let tangent = columns.first(&["loss_tangent"]).into_iter().next().filter(|_| chosen.losses.iter().any(is_loss));
        let one = |keys: &[&str]| columns.first(keys).into_iter().next();
        let mut table = Self {
            block: block.clone(),
            line: columns.line,
            curves,
            temperature: one(&["temperature", "set_temperature"]),
            bare_temperature: None,
            temperature_line: None,
            shift: one(&["shift_factor"]),
            vertical: one(&["vertical_factor"]),
            set: one(&["set"]),
            other_frequency,
            tangent,
            columns,
        };
        table.check_columns()?;
        table.read_temperature_above(options);
        Ok(Some(table))
    }

    /// There is one column of temperatures, and columns in use have a unit or may be taken in SI units.
    fn check_columns(&self) -> Result<(), ContentError> {
        if let Some(error) = twin(self.line, &self.columns.first(&["temperature"])) {
            return Err(error);
        }
        for curve in &self.curves {
            let moduli: Vec<&Column> = [Some(&curve.modulus), curve.loss.as_ref()].into_iter().flatten().collect();
            for modulus in &moduli {
                modulus.check_beside(moduli.iter().copied(), self.line)?;
            }
        }
        let mut used = self.curves.iter().flat_map(Curve::columns).chain(&self.temperature);
        used.try_for_each(|column| columns::check_unit(column, &self.block, self.line))
    }

    /// The temperature of a table whose rows have none: in its heading lines, `Temperature: 20 °C`.
    fn read_temperature_above(&mut self, options: &FitOptions) {
        if self.temperature.is_some() || self.curves.iter().any(|curve| curve.temperature.is_some()) {
            return;
        }
        let mut lines = self.block.above.iter().rev();
        match lines.find_map(|(line, text)| Some((*line, *text, setting(text, &options.units)?))) {
            Some((line, text, Setting::Kelvin(kelvin))) => {
                self.curves.iter_mut().for_each(|curve| curve.temperature = Some(kelvin));
                self.temperature_line = Some((line, shortened(text)));
            }
            Some((line, _, Setting::Bare(text))) => self.bare_temperature = Some((line, text)),
            None => (),
        }
    }

    /// Of several tables each temperature must be known.
    pub(super) fn check_temperature(&self) -> Result<(), ContentError> {
        let Some((line, text)) = &self.bare_temperature else { return Ok(()) };
        let name = text.split(['=', ':']).next().unwrap_or_default().trim();
        let expected = format!("a unit of temperature, as in 20 °C; or `unit` '{name}=°C'");
        Err(ContentError::value(Some(*line), "", text, &expected))
    }

    pub(super) fn has(&self, name: &str, text: &str) -> bool {
        let line = text.lines().nth(self.line.saturating_sub(1)).unwrap_or_default();
        let line = line.trim_start_matches(['#', '%', '!', ' ']);
        self.block.fields(line).is_some_and(|fields| fields.iter().any(|field| field.trim() == name.trim()))
    }

    pub(super) fn test(&self) -> Test {
        let relaxed = ["relaxation_modulus", "shear_relaxation_modulus"];
        let is_relaxation = self.curves.iter().any(|curve| curve.modulus.is(&relaxed));
        if is_relaxation { Test::Relaxation } else { Test::Oscillation }
    }

    pub(super) fn in_hertz(&self) -> bool {
        self.curves[0].at.as_ref().is_none_or(columns::counts_cycles)
    }

    pub(super) fn is_reduced(&self) -> bool {
        self.columns.reduced
    }

    /// What was found and assumed.
    pub(super) fn notes(&self, options: &FitOptions, tables: usize) -> Vec<String> {
        let curve = &self.curves[0];
        let used = [curve.at.as_ref(), Some(&curve.modulus), curve.loss.as_ref(), self.temperature.as_ref()];
        let used: Vec<ReadColumn> = used.into_iter().flatten().map(|column| (**column).clone()).collect();
        let mut notes = vec![told(&used, self.block.rows, &self.columns.left_out).text];
        if tables > 1 {
            notes.push(format!("{tables} tables are read, the first with these columns"));
        }
        if self.curves.len() > 1 {
            let kind = if curve.frequency.is_some() { "frequencies" } else { "temperatures" };
            notes.push(format!("there are columns for {} {kind}", self.curves.len()));
        }
        if let Some((line, text)) = &self.temperature_line {
            notes.push(format!("all rows are at the temperature of line {line}, \"{text}\""));
        }
        if let Some((line, text)) = &self.bare_temperature {
            notes.push(format!("line {line} ({text}) names no unit of temperature and is left out"));
        }
        let shear = self.is_shear(&curve.modulus, options);
        if shear {
            let nu = options.poisson_ratio;
            let text = format!("moduli of shear: E = 2(1 + ν) G, with ν = {nu} (`poisson_ratio`)");
            notes.push(text);
        } else if !names_letter(&curve.modulus.text) {
            let text = format!(
                "{} does not say whether of tension or shear: E is assumed, `shear` says G",
                curve.modulus.label()
            );
            notes.push(text);
        }
        if self.tangent.is_some() {
            notes.push("both E'' and tan delta are given: E'' is used".into());
        }
        if self.is_reduced() {
            notes.push("the frequencies are multiplied by a_T already: no row is shifted".into());
        }
        notes
    }

    fn is_shear(&self, modulus: &Column, options: &FitOptions) -> bool {
        let named = modulus.is(&["shear_storage_modulus", "complex_shear_modulus", "shear_relaxation_modulus"]);
        named || (options.shear && !names_letter(&modulus.text))
    }

    /// The sign before the decimals of a text with these tables.
    pub(super) fn decimal(tables: &[Self], text: &'a str) -> Result<Decimal, ContentError> {
        let blocks: Vec<&Block<'a>> = tables.iter().map(|table| &table.block).collect();
        let used = tables.iter().flat_map(|table| {
            let others = [&table.temperature, &table.shift, &table.vertical, &table.other_frequency, &table.tangent];
            table.curves.iter().flat_map(Curve::columns).chain(others.into_iter().flatten()).map(Column::used)
        });
        decimal_of(&blocks, text, &used.collect::<Vec<UsedColumn>>())
    }

    /// Adds the points of all rows; how many are left out because their loss is 0.
    pub(super) fn add_points(
        &self,
        text: &'a str,
        decimal: Decimal,
        options: &FitOptions,
        points: &mut Vec<MeasuredPoint>,
    ) -> Result<usize, ContentError> {
        let mut zeros = 0;
        for row in self.block.rows(text) {
            for curve in &self.curves {
                match self.point(curve, Numbers { row: &row, decimal }, options)? {
                    Some(point) => points.push(point),
                    None if curve.modulus.is_empty(&row) => (),
                    None => zeros += 1,
                }
            }
        }
        Ok(zeros)
    }

    /// The point of a curve in a row; `None` where the curve has none there, or no loss.
    fn point(
        &self,
        curve: &Curve,
        row: Numbers<'_>,
        options: &FitOptions,
    ) -> Result<Option<MeasuredPoint>, ContentError> {
        let has_many = self.curves.len() > 1;
        if has_many && curve.modulus.is_empty(row.row) && curve.loss.as_ref().is_none_or(|loss| loss.is_empty(row.row))
        {
            return Ok(None);
        }
        let at = match &curve.at {
            Some(column) => row.positive(column)?,
            None => curve.frequency.or(options.frequency).unwrap_or(TAU),
        };
        self.check_other_frequency(at, row)?;
        let modulus = row.positive(&curve.modulus)?;
        if modulus < SOFTEST && assumed_unit(&curve.modulus).is_some() {
            let expected = format!("{}: in Pa it is too soft for rubber", with_unit(&curve.modulus, "MPa"));
            return Err(row.refuse(&curve.modulus, &expected));
        }
        let Some((storage, loss)) = response(modulus, curve, row)? else { return Ok(None) };
        self.check_tangent(storage, loss, curve, row)?;
        let to_tension = if self.is_shear(&curve.modulus, options) { 2.0 * (1.0 + options.poisson_ratio) } else { 1.0 };
        let sample = Sample { at, storage: to_tension * storage, loss: to_tension * loss };
        let temperature = match (&self.temperature, curve.temperature) {
            (Some(column), _) => Some(row.temperature(column)?),
            (None, temperature) => temperature,
        };
        let shift = self.shift.as_ref().map(|column| row.positive(column)).transpose()?;
        let vertical = self.vertical.as_ref().map(|column| row.positive(column)).transpose()?;
        let set = self.set.as_ref().and_then(|column| row.number(column));
        Ok(Some(MeasuredPoint { line: row.row.line, sample, temperature, shift, vertical, set }))
    }

    /// A frequency in Hz and an angular one must be the same.
    fn check_other_frequency(&self, at: f64, row: Numbers<'_>) -> Result<(), ContentError> {
        let Some(column) = &self.other_frequency else { return Ok(()) };
        /// Share by which rounded columns may differ.
        const ROUNDING: f64 = 0.02;
        match row.number(column) {
            Some(other) if (other / at - 1.0).abs() > ROUNDING => {
                let expected =
                    format!("the same as the other column of frequencies, {at:.4e} rad/s; `ignore` leaves one out");
                Err(column.refuse(row.row.line, &format!("{other:.4e} rad/s"), &expected))
            }
            _ => Ok(()),
        }
    }

    /// tan δ must be E''/E': if not, a unit is wrong or columns are mixed up.
    fn check_tangent(&self, storage: f64, loss: f64, curve: &Curve, row: Numbers<'_>) -> Result<(), ContentError> {
        let Some(column) = self.tangent.as_ref().filter(|_| self.curves.len() == 1) else { return Ok(()) };
        let Some(tangent) = row.number(column).filter(|tangent| *tangent > 0.0) else { return Ok(()) };
        let ratio = loss / storage / tangent;
        // Rows may be rounded to a few digits; wrong units differ by a thousand.
        if (0.1..=10.0).contains(&ratio) {
            return Ok(());
        }
        let names = (curve.loss.as_ref().map_or("", |loss| loss.text.as_str()), curve.modulus.text.as_str());
        let expected = format!(
            "{:.4}, which {} over {} are: are their units right? `ignore` leaves a column out",
            loss / storage,
            names.0,
            names.1
        );
        Err(column.refuse(row.row.line, &tangent.to_string(), &expected))
    }
}

/// Whether a heading says E or G.
fn names_letter(text: &str) -> bool {
    const MARKS: [&str; 16] = [
        "e", "e'", "e''", "e*", "g", "g'", "g''", "g*", "tensile", "young's", "shear", "estor", "eloss", "erelax",
        "gstor", "gloss",
    ];
    let text = plain(text).to_lowercase();
    text.split([' ', '_', '(', ')', '[', ']', '|', ',', '/']).any(|word| MARKS.contains(&word))
}

/// Storage and loss modulus of a row; `None` where the loss is 0.
fn response(modulus: f64, curve: &Curve, row: Numbers<'_>) -> Result<Option<(f64, f64)>, ContentError> {
    let Some(column) = &curve.loss else { return Ok(Some((modulus, 0.0))) };
    if row.number(column) == Some(0.0) {
        return Ok(None);
    }
    let loss = row.positive(column)?;
    let is_complex = curve.modulus.is(&["complex_modulus", "complex_shear_modulus"]);
    let angle = match column.key {
        "phase_angle" => loss,
        "loss_tangent" => loss.atan(),
        _ => return Ok(Some((modulus, loss))),
    };
    if angle >= FRAC_PI_2 {
        return Err(column.refuse(row.row.line, &angle.to_degrees().to_string(), "a phase below 90°"));
    }
    Ok(Some(if is_complex {
        (modulus * angle.cos(), modulus * angle.sin())
    } else if column.is(&["loss_tangent"]) {
        (modulus, modulus * loss)
    } else {
        (modulus, modulus * angle.tan())
    }))
}

/// Reads the numbers of a row.
#[derive(Clone, Copy)]
struct Numbers<'r> {
    row: &'r Row<'r>,
    decimal: Decimal,
}

impl Numbers<'_> {
    /// The number in SI units, if the field is one.
    fn number(self, column: &Column) -> Option<f64> {
        column.number(self.row, self.decimal)
    }

    fn positive(self, column: &Column) -> Result<f64, ContentError> {
        column.read(self.row, self.decimal, POSITIVE)
    }

    fn temperature(self, column: &Column) -> Result<f64, ContentError> {
        if !column.names_unit && self.number(column).is_some_and(|value| value < Wlf::COLDEST) {
            return Err(self.refuse(column, &format!("{}: in K it is too cold for rubber", with_unit(column, "°C"))));
        }
        column.read(self.row, self.decimal, ABOVE_ZERO)
    }

    fn refuse(self, column: &Column, expected: &str) -> ContentError {
        column.refuse(self.row.line, column.field(self.row), expected)
    }
}
