//! Tables of measured moduli, as people and instruments write them: what each row says, in SI units.

use std::f64::consts::{FRAC_PI_2, TAU};
use std::fmt;

use asperity::scene::Wlf;
use asperity::scene::text_table::{self, Block, NumberStyle, Unit, is_missing, number};

use super::columns::{Column, Columns, EXPECTED, GivenUnits, Quantity, find_temperature};
use super::search::{Sample, Test};

/// Measured moduli of tension, in SI units.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct MeasuredModuli {
    pub(super) points: Vec<MeasuredPoint>,
    pub(super) test: Test,
    /// Whether the file gives frequencies in Hz, not in rad/s.
    pub(super) in_hertz: bool,
    /// Whether the frequencies were multiplied by a_T already.
    pub(super) reduced: bool,
    /// How the table was read, and what was assumed.
    pub(super) notes: Vec<String>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct MeasuredPoint {
    /// Line number in the file.
    pub(super) line: usize,
    pub(super) sample: Sample,
    /// K.
    pub(super) temperature: Option<f64>,
    /// a_T as the table has it.
    pub(super) shift: Option<f64>,
    /// The measurement that it belongs to, where the table numbers them.
    pub(super) set: Option<f64>,
}

/// How a table is read beside what it says.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reading<'a> {
    pub(super) ignored: &'a [String],
    pub(super) units: &'a GivenUnits,
    /// The frequency of a table without one, rad/s.
    pub(super) frequency: Option<f64>,
    /// Of moduli of shear.
    pub(super) poisson_ratio: f64,
    /// "Storage modulus" without a letter is G'.
    pub(super) shear: bool,
}

/// A table cannot be used: where, what was found and what was expected.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub(crate) struct ModuliError {
    line: usize,
    /// Its number from 1, and its heading.
    column: Option<(usize, String)>,
    /// As written in the file; empty where something is missing.
    found: String,
    expected: String,
}

impl fmt::Display for ModuliError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let found: String = self.found.chars().take(60).collect();
        write!(f, "{}: ", self.line)?;
        match &self.column {
            Some((number, header)) if header.is_empty() || *header == self.found => write!(f, "column {number}")?,
            Some((number, header)) => write!(f, "column {number} ({header})")?,
            None => {}
        }
        match (&self.column, found.as_str()) {
            (Some(_), "") => write!(f, ": ")?,
            (Some(_), found) => write!(f, " = \"{found}\": ")?,
            (None, "") => {}
            (None, found) => write!(f, "{found}: ")?,
        }
        write!(f, "expected {}", self.expected)
    }
}

impl ModuliError {
    pub(super) fn in_line(line: usize, found: impl Into<String>, expected: impl Into<String>) -> Self {
        Self { line, column: None, found: found.into(), expected: expected.into() }
    }

    /// Of a column, counted from 0, by its heading.
    pub(super) fn in_column(line: usize, index: usize, text: &str, found: &str, expected: impl Into<String>) -> Self {
        let column = Some((index + 1, text.trim().to_owned()));
        Self { line, column, found: found.into(), expected: expected.into() }
    }

    fn of(column: &Column, line: usize, found: &str, expected: impl Into<String>) -> Self {
        Self::in_column(line, column.index, &column.text, found, expected)
    }
}

/// The size that a number in SI units may have in a scene.
const POSITIVE: &str = "a number above 0 (from 1e-30 to 1e30 in SI units)";

impl MeasuredModuli {
    /// Reads all tables of moduli in the bytes of a file.
    pub(super) fn parse(bytes: &[u8], reading: &Reading<'_>) -> Result<Self, ModuliError> {
        let text = text_table::decode(bytes)
            .map_err(|_| ModuliError::in_line(1, text_table::NotText::FOUND, text_table::NotText::EXPECTED))?;
        Self::parse_text(&text, reading)
    }

    /// The same from text.
    pub(super) fn parse_text(text: &str, reading: &Reading<'_>) -> Result<Self, ModuliError> {
        let blocks = Block::all(text, true);
        let mut tables: Vec<Table<'_>> = Vec::new();
        let (mut notes, mut errors) = (Vec::new(), Vec::new());
        for block in &blocks {
            // A block without a header of its own has that of the one before it.
            let read = Table::read(block, reading).and_then(|table| match inherited(block, &tables) {
                Some(block) if table.is_none() => Table::read(&block, reading),
                _ => Ok(table),
            });
            match read {
                Ok(Some(table)) => tables.push(table),
                Ok(None) if block.rows > 1 => notes.push(format!(
                    "lines {} to {}: numbers without names of moduli above them are left out",
                    block.first, block.last
                )),
                Ok(None) => (),
                Err(error) => errors.push((block.rows, error)),
            }
        }
        // A line or two with a name in a preamble are no table that is missed.
        let is_preamble = |rows: usize| rows <= 2 && !tables.is_empty();
        if let Some((_, error)) = errors.into_iter().find(|(rows, _)| !is_preamble(*rows)) {
            return Err(error);
        }
        let Some(first) = tables.first() else { return Err(no_table(text, &blocks)) };
        if let Some(name) = reading.ignored.iter().find(|name| !first.has(name, text)) {
            return Err(ModuliError::in_line(first.line, format!("--ignore {name}"), "one of the headings"));
        }
        let (test, in_hertz, reduced) = (first.test(), first.in_hertz(), first.is_reduced());
        let mut points = Vec::new();
        for table in &tables {
            if (table.test(), table.is_reduced()) != (test, reduced) {
                let expected = "tables of one kind in a file: all of oscillation, or all of relaxation";
                return Err(ModuliError::in_line(table.line, "another kind of table", expected));
            }
            let zeros = table.add_points(text, reading, &mut points)?;
            if zeros > 0 {
                notes.push(format!("{zeros} rows whose loss is 0, below what was measured, are left out"));
            }
        }
        notes.splice(0..0, first.notes(reading, tables.len()));
        if points.is_empty() {
            return Err(ModuliError::in_line(first.line + 1, "", "a row of numbers"));
        }
        Ok(Self { points, test, in_hertz, reduced, notes })
    }

    /// The samples as they stand in the file.
    pub(super) fn samples(&self) -> Vec<Sample> {
        self.points.iter().map(|point| point.sample).collect()
    }

    /// The samples at a_T ω, or t/a_T, for the factor of each point.
    pub(super) fn shifted(&self, factor: impl Fn(&MeasuredPoint) -> f64) -> Vec<Sample> {
        self.points.iter().map(|point| point.sample.shifted(factor(point), self.test)).collect()
    }

    /// The points at the reference temperature by known constants: their moduli unchanged.
    pub(super) fn at_reference(&self, wlf: impl Fn(f64) -> Wlf) -> Result<Vec<Sample>, ModuliError> {
        /// Far above the shift of any rubber: closer to the pole, a fit would depend on the constants alone.
        const LARGEST: f64 = 1e60;
        let factor = |point: &MeasuredPoint| {
            let Some(temperature) = point.temperature else { return Ok(1.0) };
            let wlf = wlf(temperature);
            let factor = wlf.shift_factor();
            if temperature > wlf.lowest_temperature() && (1.0 / LARGEST..=LARGEST).contains(&factor) {
                return Ok(factor);
            }
            let expected = format!(
                "more than TREF - C2 = {:.2} K, and not close to it: there the shift has its pole",
                wlf.lowest_temperature()
            );
            Err(ModuliError::in_line(point.line, format!("a temperature of {temperature} K"), expected))
        };
        let shifted = |point: &MeasuredPoint| Ok(point.sample.shifted(factor(point)?, self.test));
        self.points.iter().map(shifted).collect()
    }
}

/// No table has what is needed: the nearest that was found, or what is expected.
fn no_table(text: &str, blocks: &[Block<'_>]) -> ModuliError {
    match blocks.iter().max_by_key(|block| block.rows) {
        None if text.trim().is_empty() => ModuliError::in_line(1, "", "a header line, then rows"),
        None => ModuliError::in_line(text.lines().count() + 1, "", "a row of numbers"),
        Some(block) => {
            let (line, header) = block.above.last().copied().unwrap_or((block.first, ""));
            ModuliError::in_line(line, header, EXPECTED)
        }
    }
}

/// The block with the header of the table before it, if that has as many columns.
fn inherited<'a>(block: &Block<'a>, tables: &[Table<'a>]) -> Option<Block<'a>> {
    let alike = |table: &&Table<'a>| (table.block.separator, table.block.columns) == (block.separator, block.columns);
    let before = tables.last().filter(alike)?;
    Some(block.below(&before.head_lines))
}

/// One curve of a table: its columns. A table has one, or one for each temperature.
#[derive(Clone, Debug)]
struct Curve {
    /// Frequency or time; `None` where it is given on the command line.
    at: Option<Column>,
    modulus: Column,
    loss: Option<Column>,
    temperature: Option<f64>,
}

#[derive(Debug)]
struct Table<'a> {
    block: Block<'a>,
    /// The lines above its first row.
    head_lines: Vec<text_table::Line<'a>>,
    line: usize,
    curves: Vec<Curve>,
    temperature: Option<Column>,
    shift: Option<Column>,
    set: Option<Column>,
    /// A second column of frequencies, to compare.
    other_frequency: Option<Column>,
    /// tan δ beside E'', to compare.
    tangent: Option<Column>,
    columns: Columns,
}

impl<'a> Table<'a> {
    /// The columns of a block; `None` where they are none of moduli.
    fn read(block: &Block<'a>, reading: &Reading<'_>) -> Result<Option<Self>, ModuliError> {
        use Quantity::{
            Complex, Frequency, Loss, LossTangent, Phase, Relaxation, Set, SetTemperature, ShearComplex, ShearLoss,
            ShearRelaxation, ShearStorage, ShiftFactor, Storage, Temperature, Time,
        };
        let Some(columns) = Columns::read(block, reading.ignored, reading.units)? else { return Ok(None) };
        let missing = |expected: &str| ModuliError::in_line(columns.line, "", expected);
        let first = |quantities: &[&[Quantity]]| -> Vec<Column> {
            let found = quantities.iter().map(|quantities| columns.all(quantities)).find(|found| !found.is_empty());
            found.unwrap_or_default().into_iter().cloned().collect()
        };
        let times = columns.all(&[Time]);
        let mut rates = first(&[&[Frequency]]);
        let relaxed = first(&[&[Relaxation], &[ShearRelaxation]]);
        let is_relaxation = rates.is_empty() && !times.is_empty() && !relaxed.is_empty();
        let (at, moduli, losses) = if is_relaxation {
            (times.into_iter().cloned().collect(), relaxed, Vec::new())
        } else {
            let moduli = first(&[&[Storage], &[ShearStorage], &[Complex], &[ShearComplex]]);
            let has_complex = moduli.iter().any(|column| matches!(column.quantity, Complex | ShearComplex));
            let losses = match moduli.first().map(|column| column.quantity) {
                Some(Storage) => first(&[&[Loss], &[LossTangent], &[Phase]]),
                Some(ShearStorage) => first(&[&[ShearLoss], &[Loss], &[LossTangent], &[Phase]]),
                Some(_) => first(&[&[Phase], &[LossTangent]]),
                None => first(&[&[Loss], &[ShearLoss], &[LossTangent], &[Phase]]),
            };
            if moduli.is_empty() && losses.is_empty() {
                return Ok(None);
            }
            if moduli.is_empty() {
                return Err(missing("a column of the storage modulus: E' [MPa]"));
            }
            if losses.is_empty() {
                return Err(missing(if has_complex {
                    "a column of the phase beside |E*|: delta [°] or tan delta"
                } else {
                    "a column of the loss: E'' [MPa] or tan delta"
                }));
            }
            if rates.is_empty() && reading.frequency.is_none() {
                return Err(missing("a frequency column, f [Hz] or omega [rad/s]; or --frequency 10Hz for all rows"));
            }
            (rates.clone(), moduli, losses)
        };
        let other_frequency = if at.len() == 2 && moduli.len() == 1 && !is_relaxation { rates.pop() } else { None };
        let at = if other_frequency.is_some() { vec![at[0].clone()] } else { at };
        let curves = curves(block, &columns, &at, &moduli, &losses, reading)?;
        let one = |quantities: &[&[Quantity]]| first(quantities).into_iter().next();
        let temperature = one(&[&[Temperature], &[SetTemperature]]);
        let tangent = if losses.iter().any(|loss| matches!(loss.quantity, Loss | ShearLoss)) {
            columns.all(&[LossTangent]).first().map(|column| (*column).clone())
        } else {
            None
        };
        let mut table = Self {
            block: block.clone(),
            head_lines: block.above.iter().copied().filter(|(line, _)| *line >= columns.line).collect(),
            line: columns.line,
            curves,
            temperature,
            shift: one(&[&[ShiftFactor]]),
            set: one(&[&[Set]]),
            other_frequency,
            tangent,
            columns,
        };
        table.check_twins(&[Temperature])?;
        table.read_temperature_above(reading)?;
        Ok(Some(table))
    }

    /// Two columns of one kind, where one is used, are one too many.
    fn check_twins(&self, quantities: &[Quantity]) -> Result<(), ModuliError> {
        for quantity in quantities {
            if let [first, second, ..] = self.columns.all(&[*quantity])[..] {
                let expected =
                    format!("one column of a kind: {} is there already; ignore one by --ignore NAME", first.text);
                return Err(ModuliError::of(second, self.line, &second.text, expected));
            }
        }
        Ok(())
    }

    /// The temperature of a table whose rows have none: in its heading lines, `Temperature: 20 °C`.
    fn read_temperature_above(&mut self, reading: &Reading<'_>) -> Result<(), ModuliError> {
        if self.temperature.is_some() || self.curves.iter().any(|curve| curve.temperature.is_some()) {
            return Ok(());
        }
        let found = self.block.above.iter().rev().find_map(|(line, text)| Some((*line, setting(text, reading)?)));
        let Some((line, setting)) = found else { return Ok(()) };
        match setting {
            Ok(kelvin) => self.curves.iter_mut().for_each(|curve| curve.temperature = Some(kelvin)),
            Err(text) => {
                let note = format!("line {line} ({text}) names no unit of temperature and is left out");
                self.columns.notes.push(note);
            }
        }
        Ok(())
    }

    fn has(&self, name: &str, text: &str) -> bool {
        let line = text.lines().nth(self.line.saturating_sub(1)).unwrap_or_default();
        let line = line.trim_start_matches(['#', '%', '!', ' ']);
        self.block.fields(line).is_some_and(|fields| fields.iter().any(|field| field.trim() == name.trim()))
    }

    fn test(&self) -> Test {
        let is_relaxation = self
            .curves
            .iter()
            .any(|curve| matches!(curve.modulus.quantity, Quantity::Relaxation | Quantity::ShearRelaxation));
        if is_relaxation { Test::Relaxation } else { Test::Oscillation }
    }

    fn in_hertz(&self) -> bool {
        self.curves[0].at.as_ref().is_none_or(Column::counts_cycles)
    }

    fn is_reduced(&self) -> bool {
        self.curves[0].at.as_ref().is_some_and(|column| column.reduced)
    }

    /// What was found and assumed.
    fn notes(&self, reading: &Reading<'_>, tables: usize) -> Vec<String> {
        let curve = &self.curves[0];
        let name = |column: &Column| format!("column {} ({})", column.index + 1, column.text);
        let columns = [curve.at.as_ref(), Some(&curve.modulus), curve.loss.as_ref(), self.temperature.as_ref()];
        let read: Vec<String> = columns.into_iter().flatten().map(name).collect();
        let many = if tables > 1 { format!("{tables} tables, the first with ") } else { String::new() };
        let temperatures = if self.curves.len() > 1 {
            format!(", and so on for {} temperatures", self.curves.len())
        } else {
            String::new()
        };
        let mut notes = vec![format!("read {many}{}{temperatures}", read.join(", "))];
        notes.extend(self.columns.notes.iter().cloned());
        let shear = self.is_shear(&curve.modulus, reading);
        if shear {
            let nu = reading.poisson_ratio;
            let text = format!("moduli of shear: E = 2(1 + ν) G, with ν = {nu} (--poisson-ratio)");
            notes.push(text);
        } else if !names_letter(&curve.modulus.text) {
            let text = format!(
                "{} does not say whether of tension or shear: E is assumed, --shear says G",
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
        let left_out = &self.columns.left_out;
        if !left_out.is_empty() {
            let names: Vec<&str> = left_out.iter().take(4).map(String::as_str).collect();
            let more = if left_out.len() > 4 { format!(" and {} more", left_out.len() - 4) } else { String::new() };
            notes.push(format!("columns left out: {}{more}", names.join(", ")));
        }
        notes
    }

    fn is_shear(&self, modulus: &Column, reading: &Reading<'_>) -> bool {
        use Quantity::{ShearComplex, ShearRelaxation, ShearStorage};
        let named = matches!(modulus.quantity, ShearStorage | ShearComplex | ShearRelaxation);
        named || (reading.shear && !names_letter(&modulus.text))
    }

    /// Adds the points of all rows; how many are left out because their loss is 0.
    fn add_points(
        &self,
        text: &str,
        reading: &Reading<'_>,
        points: &mut Vec<MeasuredPoint>,
    ) -> Result<usize, ModuliError> {
        let mut zeros = 0;
        let mut row = Row {
            fields: Vec::new(),
            line: 0,
            decimal_comma: self.block.separator.allows_decimal_comma(),
            style: NumberStyle::default(),
        };
        for (line, content) in self.block.lines(text) {
            row.line = line;
            row.fields = self.block.separator.split(content).into_iter().map(|field| field.into_owned()).collect();
            for curve in &self.curves {
                match self.point(curve, &mut row, reading)? {
                    Some(point) => points.push(point),
                    None if row.is_empty(&curve.modulus) => (),
                    None => zeros += 1,
                }
            }
        }
        Ok(zeros)
    }

    /// The point of a curve in a row; `None` where the curve has none there, or no loss.
    fn point(&self, curve: &Curve, row: &mut Row, reading: &Reading<'_>) -> Result<Option<MeasuredPoint>, ModuliError> {
        let has_many = self.curves.len() > 1;
        if has_many && row.is_empty(&curve.modulus) && curve.loss.as_ref().is_none_or(|loss| row.is_empty(loss)) {
            return Ok(None);
        }
        let at = match &curve.at {
            Some(column) => row.positive(column)?,
            None => reading.frequency.unwrap_or(TAU),
        };
        self.check_other_frequency(at, row)?;
        let modulus = row.positive(&curve.modulus)?;
        let Some((storage, loss)) = response(modulus, curve, row)? else { return Ok(None) };
        self.check_tangent(storage, loss, curve, row)?;
        let to_tension = if self.is_shear(&curve.modulus, reading) { 2.0 * (1.0 + reading.poisson_ratio) } else { 1.0 };
        let sample = Sample { at, storage: to_tension * storage, loss: to_tension * loss };
        let temperature = match (&self.temperature, curve.temperature) {
            (Some(column), _) => Some(row.temperature(column)?),
            (None, temperature) => temperature,
        };
        let shift = self.shift.as_ref().map(|column| row.positive(column)).transpose()?;
        let set = self.set.as_ref().map(|column| row.number(column)).transpose()?.flatten();
        Ok(Some(MeasuredPoint { line: row.line, sample, temperature, shift, set }))
    }

    /// A frequency in Hz and an angular one must be the same.
    fn check_other_frequency(&self, at: f64, row: &mut Row) -> Result<(), ModuliError> {
        let Some(column) = &self.other_frequency else { return Ok(()) };
        /// Share by which rounded columns may differ.
        const ROUNDING: f64 = 0.02;
        match row.number(column)? {
            Some(other) if (other / at - 1.0).abs() > ROUNDING => {
                let expected =
                    format!("the same as the other column of frequencies, {at:.4e} rad/s; --ignore leaves one out");
                Err(ModuliError::of(column, row.line, &format!("{other:.4e} rad/s"), expected))
            }
            _ => Ok(()),
        }
    }

    /// tan δ must be E''/E': if not, a unit is wrong or columns are mixed up.
    fn check_tangent(&self, storage: f64, loss: f64, curve: &Curve, row: &mut Row) -> Result<(), ModuliError> {
        let Some(column) = self.tangent.as_ref().filter(|_| self.curves.len() == 1) else { return Ok(()) };
        let Some(tangent) = row.number(column)?.filter(|tangent| *tangent > 0.0) else { return Ok(()) };
        let ratio = loss / storage / tangent;
        // Rows may be rounded to a few digits; wrong units differ by a thousand.
        if (0.1..=10.0).contains(&ratio) {
            return Ok(());
        }
        let names = (curve.loss.as_ref().map_or("", |loss| loss.text.as_str()), curve.modulus.text.as_str());
        let expected = format!(
            "{:.4}, which {} over {} are: are their units right? --ignore leaves a column out",
            loss / storage,
            names.0,
            names.1
        );
        Err(ModuliError::of(column, row.line, &tangent.to_string(), expected))
    }
}

/// Whether a heading says E or G.
fn names_letter(text: &str) -> bool {
    let words = text_table::words(text);
    let marks = [
        "e", "e'", "e''", "estar", "g", "g'", "g''", "gstar", "tensile", "young's", "shear", "estor", "eloss",
        "erelax", "gstor", "gloss",
    ];
    words.iter().any(|word| marks.contains(&word.as_str()))
}

/// Storage and loss modulus of a row; `None` where the loss is 0.
fn response(modulus: f64, curve: &Curve, row: &mut Row) -> Result<Option<(f64, f64)>, ModuliError> {
    let Some(column) = &curve.loss else { return Ok(Some((modulus, 0.0))) };
    if row.number(column)? == Some(0.0) {
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
        return Err(ModuliError::of(column, row.line, &angle.to_degrees().to_string(), "a phase below 90°"));
    }
    Ok(Some(if is_complex {
        (modulus * angle.cos(), modulus * angle.sin())
    } else if column.quantity == Quantity::LossTangent {
        (modulus, modulus * loss)
    } else {
        (modulus, modulus * angle.tan())
    }))
}

/// The fields of a row.
struct Row {
    line: usize,
    fields: Vec<String>,
    decimal_comma: bool,
    style: NumberStyle,
}

impl Row {
    fn field(&self, column: &Column) -> &str {
        self.fields.get(column.index).map_or("", String::as_str)
    }

    fn is_empty(&self, column: &Column) -> bool {
        let field = self.field(column);
        field.is_empty() || is_missing(field)
    }

    /// The number in SI units, if the field is one.
    fn number(&mut self, column: &Column) -> Result<Option<f64>, ModuliError> {
        let field = self.fields.get(column.index).map_or("", String::as_str);
        let written = number(field, self.decimal_comma);
        if written.is_some() && !self.style.add(field) {
            let expected = "numbers with decimal points or with decimal commas, not both in one file";
            return Err(ModuliError::of(column, self.line, field, expected));
        }
        Ok(written.map(|written| column.to_si(written)).filter(|value| value.is_finite()))
    }

    fn positive(&mut self, column: &Column) -> Result<f64, ModuliError> {
        let value = self.number(column)?.filter(|value| (1e-30..=1e30).contains(value));
        value.ok_or_else(|| ModuliError::of(column, self.line, self.field(column), POSITIVE))
    }

    fn temperature(&mut self, column: &Column) -> Result<f64, ModuliError> {
        let value = self.number(column)?;
        if column.names_no_temperature_unit() && value.is_some_and(|value| value < Wlf::COLDEST) {
            let expected = format!(
                "a unit: without one it is taken in K, which is too cold for rubber; {} [°C] in the header, or --unit '{}=°C'",
                column.text, column.text
            );
            return Err(ModuliError::of(column, self.line, self.field(column), expected));
        }
        let value = value.filter(|value| *value > 0.0);
        value.ok_or_else(|| ModuliError::of(column, self.line, self.field(column), "a temperature above 0 K"))
    }
}

/// The curves of a table: one, or a pair of columns for each temperature.
fn curves(
    block: &Block<'_>,
    columns: &Columns,
    at: &[Column],
    moduli: &[Column],
    losses: &[Column],
    reading: &Reading<'_>,
) -> Result<Vec<Curve>, ModuliError> {
    let twin = |columns_of: &[Column]| {
        let [first, second, ..] = columns_of else { return None };
        let expected = format!("one column of a kind: {} is there already; ignore one by --ignore NAME", first.text);
        Some(ModuliError::of(second, columns.line, &second.text, expected))
    };
    if moduli.len() == 1 {
        return match twin(at).or_else(|| twin(losses)) {
            Some(error) => Err(error),
            None => Ok(vec![Curve {
                at: at.first().cloned(),
                modulus: moduli[0].clone(),
                loss: losses.first().cloned(),
                temperature: moduli[0].temperature,
            }]),
        };
    }
    let fits = |count: usize| count == moduli.len();
    if !(losses.is_empty() || fits(losses.len())) || !(at.len() <= 1 || fits(at.len())) {
        let given =
            format!("{} columns of moduli, {} of losses, {} of frequencies", moduli.len(), losses.len(), at.len());
        return Err(ModuliError::in_line(
            columns.line,
            given,
            "a pair of moduli a temperature, and one frequency or one for each",
        ));
    }
    let above = temperatures_above(block, columns.line, reading)?;
    let curve = |(i, modulus): (usize, &Column)| {
        let temperature = modulus.temperature.or_else(|| above.get(modulus.index).copied().flatten());
        let temperature = temperature.ok_or_else(|| {
            let expected = "its temperature, in its name (E' [MPa] 20 °C) or in the line above; or one column of a kind: \
                            --ignore NAME";
            ModuliError::of(modulus, columns.line, &modulus.text, expected)
        })?;
        let at = if at.len() > 1 { at.get(i) } else { at.first() };
        Ok(Curve {
            at: at.cloned(),
            modulus: modulus.clone(),
            loss: losses.get(i).cloned(),
            temperature: Some(temperature),
        })
    };
    moduli.iter().enumerate().map(curve).collect()
}

/// The temperatures in the line above the names: each holds to the next one.
fn temperatures_above(block: &Block<'_>, names: usize, reading: &Reading<'_>) -> Result<Vec<Option<f64>>, ModuliError> {
    let Some(&(line, text)) = block.above.iter().rev().find(|(line, _)| *line < names) else { return Ok(Vec::new()) };
    let Some(fields) = block.fields(text) else { return Ok(Vec::new()) };
    let is_kelvin = |unit: &Unit| unit.dimension == text_table::Dimension::Temperature;
    let given = reading.units.iter().map(|(_, unit)| *unit).find(is_kelvin);
    let of_line = given.or_else(|| Heading::unit_of(text));
    let (mut found, mut last) = (Vec::new(), None);
    for (index, field) in fields.iter().enumerate() {
        let named = find_temperature(field).map(|(_, _, kelvin)| kelvin);
        let bare = number(field, block.separator.allows_decimal_comma());
        match (named, bare, of_line) {
            (Some(kelvin), _, _) => last = Some(kelvin),
            (None, Some(value), Some(unit)) => last = Some(unit.to_si(value)),
            (None, Some(value), None) if value >= Wlf::COLDEST => last = Some(value),
            (None, Some(_), None) => {
                let expected =
                    "a unit of temperature, as in 20 °C, above each pair of columns; or --unit temperature=°C";
                return Err(ModuliError::in_column(line, index, "", field, expected));
            }
            (None, None, _) if field.is_empty() => (),
            (None, None, _) => last = None,
        }
        found.push(last);
    }
    Ok(found)
}

/// A line above a table.
struct Heading;

impl Heading {
    /// The unit of temperature that a line names by itself, as in `T [°C],20,,40,`.
    fn unit_of(line: &str) -> Option<Unit> {
        let parts = line.split(|letter: char| letter.is_whitespace() || "[](),;:=/\t".contains(letter));
        let mut units = parts.filter_map(Unit::parse);
        units.find(|unit| unit.dimension == text_table::Dimension::Temperature)
    }
}

/// Of a line such as `Temperature: 20 °C` or `T=20;Mw=90`: the temperature in K, or the text where it names no unit.
fn setting(line: &str, reading: &Reading<'_>) -> Option<Result<f64, String>> {
    line.split([';', '\t', ',']).find_map(|part| {
        let (name, value) = part.split_once(['=', ':']).or_else(|| part.split_once(char::is_whitespace))?;
        let words = text_table::words(name);
        let is_temperature =
            words.iter().any(|word| ["T", "temp", "temperature", "temperatur"].contains(&word.as_str()));
        let digits = value.trim();
        if !is_temperature
            || words.len() > 2
            || !digits.starts_with(|letter: char| letter.is_ascii_digit() || letter == '-')
        {
            return None;
        }
        if let Some((_, _, kelvin)) = find_temperature(digits) {
            return Some(Ok(kelvin));
        }
        let given = reading.units.iter().find(|(name, _)| text_table::words(name) == words).map(|(_, unit)| *unit);
        let unit = given.or_else(|| Heading::unit_of(name));
        let number = number(digits, true);
        Some(match (unit, number) {
            (Some(unit), Some(number)) => Ok(unit.to_si(number)),
            _ => Err(part.trim().to_owned()),
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const READING: Reading<'_> =
        Reading { ignored: &[], units: &[], frequency: None, poisson_ratio: 0.5, shear: false };

    fn read_with(text: &str, reading: &Reading<'_>) -> MeasuredModuli {
        MeasuredModuli::parse(text.as_bytes(), reading).unwrap_or_else(|error| panic!("{text}: {error}"))
    }

    fn read(text: &str) -> MeasuredModuli {
        read_with(text, &READING)
    }

    fn refusal(text: &str) -> String {
        MeasuredModuli::parse(text.as_bytes(), &READING).unwrap_err().to_string()
    }

    /// 2 Hz, E' = 3 MPa, E'' = 0.6 MPa, 20 °C, however they are written.
    #[test]
    fn tables_as_people_and_instruments_write_them() {
        let texts = [
            "frequency [Hz],E' [MPa],E'' [MPa],T [K]\n2,3,0.6,293.15\n",
            "\u{feff}f (Hz);E' (kPa);E'' (Pa);temperature [°C]\r\n2;3000;6e5;20\r\n",
            "# by hand\n\ntan delta\ttemperature (C)\tstorage modulus [GPa]\tf [kHz]\n0,2\t20,0\t0,003\t0,002\n",
            "Frequency,Storage modulus,Loss modulus,Temperature\nHz,MPa,MPa,°C\n2,3,0.6,20",
            "\"Frequency, Hz\",\"E\"\" [MPa]\",\"E' [MPa]\",\"T (K)\"\n\"2\",\"0.6\",\"3\",\"293.15\"\n",
            "omega [rad/s];E' [MPa];loss modulus;T [K];;\n;MPa;MPa;;;\n12.566370614359172;3;0.6;293.15;;\n",
            "# T = 20 °C\n# Frequency (Hz)\tE' (MPa)\tE'' (MPa)\n2\t3\t0.6\n",
            "T=20 °C;Mw=90;\nFreq\tG'\tG\"\tStrain\nrad/s\tMPa\tMPa\t%\n12.566370614359172\t1\t0.2\t1\n",
            "Point,Time [s],f [Hz],E' [MPa],E'' [MPa],Strain [%],T [°F]\na,1,2,3,0.6,9,68\n",
            "log f [Hz];log E' [Pa];tan(d);T [°C]\n0,30102999566398120;6,47712125471966244;0,2;20",
            "f [Hz];|E*| [MPa];delta [°];T [°C]\n2;3.0594117081556709;11.309932474020213;20",
            "Oscillation frequency\tDyn. Storage Modulus\tDyn. Loss Modulus\tTemperature\nHz\tksi\tpsi\t°C\n\
             2\t0.43511321319\t87.022642638\t20\n",
            ",20 °C,,30 °C,\nf [Hz],E' [MPa],E'' [MPa],E' [MPa],E'' [MPa]\n2,3,0.6,2,0.2\n",
            "f [Hz],E' [MPa] 20 °C,E'' [MPa] 20 °C,E' [MPa] 30 °C,E'' [MPa] 30 °C\n2,3,0.6,2,0.2\n",
            "[Step]\nNumber of points\t1\nVariables\tTemperature\tFrequency\tStorage modulus\tLoss modulus\n\
             Units\t°C\tHz\tMPa\tMPa\nData point\t20\t2\t3\t0.6\n[Step]\nNumber of points\t1\n\
             Variables\tTemperature\tFrequency\tStorage modulus\tLoss modulus\nUnits\t°C\tHz\tMPa\tMPa\n\
             Data point\t30\t2\t2\t0.2\n",
        ];
        for text in texts {
            let row = read(text).points[0];
            // Ten digits are written.
            let close = |value: f64, wanted: f64| (value / wanted - 1.0).abs() < 1e-9;
            let Sample { at, storage, loss } = row.sample;
            assert!(close(at, 2.0 * TAU) && close(storage, 3e6) && close(loss, 6e5), "{text}: {row:?}");
            assert!(close(row.temperature.unwrap(), 293.15), "{text}: {row:?}");
        }
        let last = texts[texts.len() - 3..].iter().map(|text| read(text).points);
        assert!(
            last.map(|points| points[1]).all(|point| point.temperature == Some(303.15) && point.sample.storage == 2e6)
        );
    }

    #[test]
    fn every_encoding_gives_the_same() {
        let bytes = b"f [Hz];E' [N/mm\xb2];tan d;Temp. [\xb0C]\r\n1;2;0,1;-10\r\n";
        let measured = MeasuredModuli::parse(bytes, &READING).unwrap();
        assert_eq!((measured.points[0].temperature, measured.points[0].sample.storage), (Some(263.15), 2e6));
        let text: String = bytes.iter().copied().map(char::from).collect();
        let utf_16: Vec<u8> = [0xfeff].into_iter().chain(text.encode_utf16()).flat_map(u16::to_le_bytes).collect();
        assert_eq!(MeasuredModuli::parse(&utf_16, &READING), Ok(measured));
    }

    #[test]
    fn relaxation_has_times() {
        let measured = read("t,E_relax\ns,MPa\n0.01,20\n10,11\n");
        assert_eq!(measured.test, Test::Relaxation);
        assert_eq!(measured.samples()[1], Sample { at: 10.0, storage: 11e6, loss: 0.0 });
        assert_eq!(read("Time (min),G(t) (MPa)\n1,2\n").samples()[0], Sample { at: 60.0, storage: 6e6, loss: 0.0 });
    }

    #[test]
    fn frequencies_may_be_reduced_or_given() {
        assert!(read("a_T f [Hz],E' [MPa],E'' [MPa],T [°C]\n1,2,3,20\n").reduced);
        assert!(!read("f [Hz],E' [MPa],E'' [MPa],T [°C]\n1,2,3,20\n").reduced);
        let at = Reading { frequency: Some(5.0), ..READING };
        assert_eq!(read_with("T [°C],E' [MPa],E'' [MPa]\n20,2,3\n", &at).points[0].sample.at, 5.0);
        let factors = read("f [Hz],E' [MPa],E'' [MPa],T [°C],log aT\n1,2,3,20,2\n");
        assert_eq!(factors.points[0].shift, Some(100.0));
    }

    #[test]
    fn shear_is_converted_and_assumptions_are_noted() {
        let notes = |text: &str| read(text).notes.join("; ");
        let shear = read_with("f [Hz],G' [MPa],G'' [MPa]\n1,2,3\n", &Reading { poisson_ratio: 0.25, ..READING });
        assert_eq!(shear.points[0].sample.storage, 5e6);
        assert!(shear.notes.join("; ").contains("moduli of shear: E = 2(1 + ν) G, with ν = 0.25"));
        let named = "f [Hz],Storage modulus [MPa],Loss modulus [MPa]\n1,2,3\n";
        assert!(notes(named).contains("does not say whether of tension or shear: E is assumed"));
        assert_eq!(read_with(named, &Reading { shear: true, ..READING }).points[0].sample.loss, 9e6);
        assert!(notes("f,E' [MPa],E'' [MPa]\n1,2,3").contains("column 1 (f) names no unit: Hz is assumed"));
        assert!(notes("omega,E',tan(d)\n1,2,3").contains("column 1 (omega) names no unit: rad/s is assumed"));
        assert!(notes("omega,E',tan(d)\n1,2,3").contains("column 2 (E') names no unit: Pa is assumed"));
        let both = "f [Hz],E' [Pa],E'' [Pa],tan(d)\n1,2,3,1.5";
        assert!(notes(both).contains("both E'' and tan delta are given: E'' is used"));
        assert!(notes("Point,f [Hz],E' [Pa],E'' [Pa],F [N]\n1,1,2,3,9").contains("columns left out: Point, F [N]"));
        assert!(notes("f [Hz],E' [Pa],E'' [Pa]\n1,2,3\n2,2,0\n").contains("1 rows whose loss is 0"));
    }

    #[test]
    fn a_unit_may_be_given_and_a_column_ignored() {
        let text = "f [Hz],E' [MPa],E'' [MPa],Temperature\n1,2,3,20";
        let celsius = [("temperature".to_owned(), Unit::parse("°C").unwrap())];
        let given = Reading { units: &celsius, ..READING };
        assert_eq!(read_with(text, &given).points[0].temperature, Some(293.15));
        let wide = ",20,,40,\nf [Hz],E' [MPa],E'' [MPa],E' [MPa],E'' [MPa]\n1,2,3,4,5\n";
        assert_eq!(read_with(wide, &given).points[1].temperature, Some(313.15));
        let ignored = |name: &str| {
            let ignored = [name.to_owned()];
            MeasuredModuli::parse(text.as_bytes(), &Reading { ignored: &ignored, ..READING })
        };
        assert_eq!(ignored("Temperature").unwrap().points[0].temperature, None);
        assert_eq!(ignored("temp").unwrap_err().to_string(), "1: --ignore temp: expected one of the headings");
    }

    #[test]
    fn what_is_wrong_is_refused_with_line_and_column() {
        let head = "f [Hz],E' [MPa],E'' [MPa]";
        let cases = [
            (format!("{head}\n1,2,3\n\n2,x,3\n3,2,1"), "4: column 2 (E' [MPa]) = \"x\": expected a number above 0"),
            (format!("{head}\n1,2,-3"), "2: column 3 (E'' [MPa]) = \"-3\": expected a number above 0"),
            (format!("{head}\n0,2,3"), "2: column 1 (f [Hz]) = \"0\": expected a number above 0"),
            (format!("{head}\n1,,3"), "2: column 2 (E' [MPa]): expected a number above 0"),
            (format!("{head}\n1,1e-40,3"), "2: column 2 (E' [MPa]) = \"1e-40\": expected a number above 0"),
            (head.into(), "2: expected a row of numbers"),
            (String::new(), "1: expected a header line, then rows"),
            ("f [Hz],E'' [Pa]\n1,2".into(), "1: expected a column of the storage modulus: E' [MPa]"),
            ("f [Hz],E' [Pa]\n1,2".into(), "1: expected a column of the loss: E'' [MPa] or tan delta"),
            (
                "T [°C],E' [Pa],E'' [Pa]\n1,2,3".into(),
                "1: expected a frequency column, f [Hz] or omega [rad/s]; or --frequency",
            ),
            ("f [Hz],|E*| [Pa]\n1,2".into(), "1: expected a column of the phase beside |E*|"),
            (
                "f [Hz],omega [rad/s],E' [Pa],E'' [Pa]\n1,2,3,4".into(),
                "2: column 2 (omega [rad/s]) = \"2.0000e0 rad/s\"",
            ),
            (
                "f [Hz],E' [Pa],E' [Pa],E'' [Pa]\n1,2,3,4".into(),
                "1: 2 columns of moduli, 1 of losses, 1 of frequencies: expected a pair",
            ),
            (
                "f [Hz],E' [Pa],E'' [Pa],temperature\n1,2,3,4".into(),
                "2: column 4 (temperature) = \"4\": expected a unit: without one it is taken in K",
            ),
            (
                "f [Hz],E' [Pa],E'' [Pa],T [°C]\n1,2,3,-300".into(),
                "2: column 4 (T [°C]) = \"-300\": expected a temperature above 0 K",
            ),
            (
                "f [Hz],E' [furlong],E'' [Pa]\n1,2,3".into(),
                "1: column 2 (E' [furlong]) = \"furlong\": expected a unit: one of Pa",
            ),
            (
                "f [Hz],E' [MPa],E'' [kPa],tan d\n1,2,0.2,0.1".into(),
                "2: column 4 (tan d) = \"0.1\": expected 0.0001, which",
            ),
            ("omega [Hz],E' [Pa],E'' [Pa]\n1,2,3".into(), "1: column 1 = \"omega [Hz]\": expected rad/s or 1/s"),
            (
                "f [Hz];E' [Pa];E'' [Pa]\n1,5;2;3\n2.5;2;3".into(),
                "3: column 1 (f [Hz]) = \"2.5\": expected numbers with",
            ),
            ("1,2,3\n4,5,6".into(), "1: expected columns by their names with units"),
            (
                ",20,,40,\nf [Hz],E' [Pa],E'' [Pa],E' [Pa],E'' [Pa]\n1,2,3,4,5\n".into(),
                "1: column 2 = \"20\": expected a unit of temperature",
            ),
            ("a\0".into(), "1: bytes that are zero: expected text in UTF-8, UTF-16 or Latin-1"),
        ];
        for (text, message) in cases {
            assert!(refusal(&text).starts_with(message), "{text}\n{}\n{message}", refusal(&text));
        }
    }

    fn at(temperature: f64) -> MeasuredModuli {
        let sample = Sample { at: 3.0, storage: 2.0, loss: 1.0 };
        let point = MeasuredPoint { line: 7, sample, temperature: Some(temperature), shift: None, set: None };
        MeasuredModuli {
            points: vec![point],
            test: Test::Oscillation,
            in_hertz: true,
            reduced: false,
            notes: Vec::new(),
        }
    }

    fn law(temperature: f64) -> Wlf {
        Wlf { c1: 8.0, c2: 100.0, reference_temperature: 293.15, temperature }
    }

    /// log10 a_T = -8·10/110 ten kelvin above, 8·10/90 ten below: heat acts as slower motion.
    #[test]
    fn points_are_shifted_by_wlf() {
        let omega = |temperature: f64| at(temperature).at_reference(law).unwrap()[0].at;
        assert_eq!(omega(293.15), 3.0);
        assert!((omega(303.15) / 3.0 / 10.0_f64.powf(-80.0 / 110.0) - 1.0).abs() < 1e-12);
        assert!((omega(283.15) / 3.0 / 10.0_f64.powf(80.0 / 90.0) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn temperatures_at_and_near_the_pole_are_refused() {
        for temperature in [193.15, 150.0, 194.0] {
            let refusal = at(temperature).at_reference(law).unwrap_err().to_string();
            let wanted = format!("7: a temperature of {temperature} K: expected more than TREF - C2 = 193.15");
            assert!(refusal.starts_with(&wanted), "{refusal}");
        }
    }
}
