//! A table of moduli in a file: which columns make its curves, and what its rows say.

use std::f64::consts::{FRAC_PI_2, TAU};

use asperity::scene::Wlf;
use asperity::tables::{ABOVE_ZERO, ContentError, POSITIVE, shortened};
use asperity_formats::text::{Block, Decimal, Line, Row, UsedColumn, decimal_of, left_out_words, plain};

use super::columns::{self, Column, Columns, Quantity, with_unit};
use super::curves::{Chosen, Curve, twin};
use super::reading::{MeasuredPoint, Reading};
use super::sample::{Sample, Test};
use super::stated_temperature::{Setting, setting};

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
        reading: &Reading<'_>,
    ) -> Result<Option<Self>, ContentError> {
        let found = Self::with_own_header(block, reading)?;
        let alike = |table: &&Self| (table.block.separator, table.block.columns) == (block.separator, block.columns);
        match before.filter(alike).filter(|_| found.is_none()) {
            Some(before) => {
                let header: Vec<Line<'a>> =
                    before.block.above.iter().copied().filter(|(line, _)| *line >= before.line).collect();
                Self::with_own_header(&block.with_header(&header), reading)
            }
            None => Ok(found),
        }
    }

    fn with_own_header(block: &Block<'a>, reading: &Reading<'_>) -> Result<Option<Self>, ContentError> {
        use Quantity::{Loss, LossTangent, Set, SetTemperature, ShearLoss, ShiftFactor, Temperature, VerticalFactor};
        let Some(columns) = Columns::read(block, reading)? else { return Ok(None) };
        let Some(mut chosen) = Chosen::of(&columns)? else { return Ok(None) };
        let other_frequency = chosen.take_other_frequency();
        let curves = chosen.curves(block, &columns, reading)?;
        let is_loss = |loss: &Column| matches!(loss.quantity, Loss | ShearLoss);
        let tangent = columns.first(&[&[LossTangent]]).into_iter().next().filter(|_| chosen.losses.iter().any(is_loss));
        let one = |quantities: &[&[Quantity]]| columns.first(quantities).into_iter().next();
        let mut table = Self {
            block: block.clone(),
            line: columns.line,
            curves,
            temperature: one(&[&[Temperature], &[SetTemperature]]),
            bare_temperature: None,
            temperature_line: None,
            shift: one(&[&[ShiftFactor]]),
            vertical: one(&[&[VerticalFactor]]),
            set: one(&[&[Set]]),
            other_frequency,
            tangent,
            columns,
        };
        table.check_columns()?;
        table.read_temperature_above(reading);
        Ok(Some(table))
    }

    /// There is one column of temperatures, and columns in use have a unit or may be taken in SI units.
    fn check_columns(&self) -> Result<(), ContentError> {
        if let Some(error) = twin(self.line, &self.columns.first(&[&[Quantity::Temperature]])) {
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
    fn read_temperature_above(&mut self, reading: &Reading<'_>) {
        if self.temperature.is_some() || self.curves.iter().any(|curve| curve.temperature.is_some()) {
            return;
        }
        let mut lines = self.block.above.iter().rev();
        match lines.find_map(|(line, text)| Some((*line, *text, setting(text, reading.units)?))) {
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
        let is_relaxation = self
            .curves
            .iter()
            .any(|curve| matches!(curve.modulus.quantity, Quantity::Relaxation | Quantity::ShearRelaxation));
        if is_relaxation { Test::Relaxation } else { Test::Oscillation }
    }

    pub(super) fn in_hertz(&self) -> bool {
        self.curves[0].at.as_ref().is_none_or(columns::counts_cycles)
    }

    pub(super) fn is_reduced(&self) -> bool {
        self.columns.reduced
    }

    /// What was found and assumed.
    pub(super) fn notes(&self, reading: &Reading<'_>, tables: usize) -> Vec<String> {
        let curve = &self.curves[0];
        let name = Column::label;
        let used = [curve.at.as_ref(), Some(&curve.modulus), curve.loss.as_ref(), self.temperature.as_ref()];
        let many = if tables > 1 { format!("{tables} tables, the first with ") } else { String::new() };
        let kind = if curve.frequency.is_some() { "frequencies" } else { "temperatures" };
        let more =
            if self.curves.len() > 1 { format!(", and so on for {} {kind}", self.curves.len()) } else { String::new() };
        let read = used.into_iter().flatten().map(|column| {
            let said = column.assumed_unit().map_or_else(String::new, |unit| format!(" in {unit}, assumed"));
            format!("{} = {}{said}", key_of(column), name(column))
        });
        let read = read.collect::<Vec<_>>().join(", ");
        let left_out = left_out_words(&self.columns.left_out);
        let mut notes = vec![format!("{many}{read}{more}; {} rows{left_out}", self.block.rows)];
        if let Some((line, text)) = &self.temperature_line {
            notes.push(format!("all rows are at the temperature of line {line}, \"{text}\""));
        }
        if let Some((line, text)) = &self.bare_temperature {
            notes.push(format!("line {line} ({text}) names no unit of temperature and is left out"));
        }
        let shear = self.is_shear(&curve.modulus, reading);
        if shear {
            let nu = reading.poisson_ratio;
            let text = format!("moduli of shear: E = 2(1 + ν) G, with ν = {nu} (`poisson_ratio`)");
            notes.push(text);
        } else if !names_letter(&curve.modulus.text) {
            let text = format!(
                "{} does not say whether of tension or shear: E is assumed, `shear` says G",
                name(&curve.modulus)
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

    fn is_shear(&self, modulus: &Column, reading: &Reading<'_>) -> bool {
        use Quantity::{ShearComplex, ShearRelaxation, ShearStorage};
        let named = matches!(modulus.quantity, ShearStorage | ShearComplex | ShearRelaxation);
        named || (reading.shear && !names_letter(&modulus.text))
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
        reading: &Reading<'_>,
        points: &mut Vec<MeasuredPoint>,
    ) -> Result<usize, ContentError> {
        let mut zeros = 0;
        for row in self.block.rows(text) {
            for curve in &self.curves {
                match self.point(curve, Numbers { row: &row, decimal }, reading)? {
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
        reading: &Reading<'_>,
    ) -> Result<Option<MeasuredPoint>, ContentError> {
        let has_many = self.curves.len() > 1;
        if has_many && curve.modulus.is_empty(row.row) && curve.loss.as_ref().is_none_or(|loss| loss.is_empty(row.row))
        {
            return Ok(None);
        }
        let at = match &curve.at {
            Some(column) => row.positive(column)?,
            None => curve.frequency.or(reading.frequency).unwrap_or(TAU),
        };
        self.check_other_frequency(at, row)?;
        let modulus = row.positive(&curve.modulus)?;
        if modulus < SOFTEST && curve.modulus.assumed_unit().is_some() {
            let expected = format!("{}: in Pa it is too soft for rubber", with_unit(&curve.modulus, "MPa"));
            return Err(row.refuse(&curve.modulus, &expected));
        }
        let Some((storage, loss)) = response(modulus, curve, row)? else { return Ok(None) };
        self.check_tangent(storage, loss, curve, row)?;
        let to_tension = if self.is_shear(&curve.modulus, reading) { 2.0 * (1.0 + reading.poisson_ratio) } else { 1.0 };
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

/// The key of a column's role.
fn key_of(column: &Column) -> &'static str {
    use Quantity::{
        Complex, Frequency, Loss, LossTangent, Phase, Relaxation, SetTemperature, ShearComplex, ShearLoss,
        ShearRelaxation, ShearStorage, Storage, Temperature, Time,
    };
    match column.quantity {
        Frequency => "frequency",
        Time => "time",
        Storage | ShearStorage => "storage modulus",
        Loss | ShearLoss => "loss modulus",
        Complex | ShearComplex => "complex modulus",
        LossTangent => "tan delta",
        Phase => "phase angle",
        Temperature | SetTemperature => "temperature",
        Relaxation | ShearRelaxation => "relaxation modulus",
        _ => "column",
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
    let is_complex = matches!(curve.modulus.quantity, Quantity::Complex | Quantity::ShearComplex);
    let angle = match column.quantity {
        Quantity::Phase => loss,
        Quantity::LossTangent => loss.atan(),
        _ => return Ok(Some((modulus, loss))),
    };
    if angle >= FRAC_PI_2 {
        return Err(column.refuse(row.row.line, &angle.to_degrees().to_string(), "a phase below 90°"));
    }
    Ok(Some(if is_complex {
        (modulus * angle.cos(), modulus * angle.sin())
    } else if column.quantity == Quantity::LossTangent {
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
