//! The file format of a sweep's table, written and read here alone: a header of lines `# key = value`, the names of the
//! columns with their units, and one row for each operating point.
//!
//! The columns of numbers are those of [`Quantity`]; one is added there. Readers find columns by their names.

use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use super::basis::{Basis, one_line};
use super::grid::{Load, OperatingPoint, SweepGrid};
use super::point_status::PointStatus;
use super::quantity::{Need, Quantity, column_name};
use super::samples::{self, SampleHeader, SampleValues, Sampled};
use super::table_error::TableError;
use crate::scene::{SMALLEST, is_possible};
use crate::tables;

/// The first line of a table; its number grows when readers have to know of a change.
pub const FORMAT: &str = "# asperity sweep = 1";
/// The columns before those of [`Quantity`]; `{load}` and `{unit}` stand for those of the table's [`Load`].
const POINT_COLUMNS: [&str; 4] = ["speed [m/s]", "{load} [{unit}]", "temperature [K]", "status"];

/// The names of all columns, in their order in a file, with those of samples or without.
fn columns(load: Load, has_samples: bool) -> Vec<String> {
    let point = POINT_COLUMNS.iter().map(|name| column_name(name, load));
    let own = point.chain(Quantity::ALL.iter().map(|quantity| quantity.name(load)));
    own.chain(has_samples.then(samples::columns).into_iter().flatten()).collect()
}

/// What a table says before its rows.
#[derive(Clone, Debug, PartialEq)]
pub struct TableHeader {
    /// The name of the scene that was swept.
    pub scene: String,
    /// What tells this sweep from others.
    pub fingerprint: String,
    /// What the loads are.
    pub load: Load,
    /// Separation at w = 0, m.
    pub rest_separation: f64,
    /// What the numbers rest on.
    pub basis: Basis,
    /// The samples; `None` without.
    pub samples: Option<SampleHeader>,
    /// The points that the table is to have.
    pub grid: SweepGrid,
    /// How far the law reaches below the least load, in words; `None` while points are missing. It follows from the
    /// rows and is not read.
    pub low_end: Option<String>,
    /// The samples (from 1) by their mean friction over the table, the lowest first; empty while points are missing. It
    /// follows from the rows and is not read.
    pub ranking: Vec<usize>,
}

impl TableHeader {
    /// The lines of the header, the names of the columns included.
    pub fn text(&self) -> String {
        let grid = &self.grid;
        let mut lines = vec![
            FORMAT.to_owned(),
            format!("# scene = {}", one_line(&self.scene)),
            format!("# fingerprint = {}", self.fingerprint),
        ];
        if let Load::Pressure { area } = self.load {
            lines.push(format!("# nominal_area = {} m2", number(area)));
        }
        lines.push(format!("# rest_separation = {} m", number(self.rest_separation)));
        lines.extend(self.basis.lines());
        lines.extend(self.samples.map(|samples| format!("# samples = {}", samples.text())));
        lines.push(format!("# speeds = {} m/s", list(&grid.speeds)));
        lines.push(format!("# {}s = {} {}", self.load.name(), list(&grid.loads), self.load.unit()));
        if !grid.temperatures.is_empty() {
            lines.push(format!("# temperatures = {} K", list(&grid.temperatures)));
        }
        lines.extend(self.low_end.as_ref().map(|text| format!("# low_end = {}", one_line(text))));
        if !self.ranking.is_empty() {
            let ranking: Vec<String> = self.ranking.iter().map(usize::to_string).collect();
            lines.push(format!("# ranking = {}", ranking.join(",")));
        }
        lines.push(columns(self.load, self.samples.is_some()).join(","));
        lines.join("\n") + "\n"
    }
}

/// The row of a point.
#[derive(Clone, Debug, PartialEq)]
pub struct TableRow {
    /// The point.
    pub point: OperatingPoint,
    /// Whether its values can be relied on.
    pub status: PointStatus,
    values: [Option<f64>; Quantity::ALL.len()],
    /// The samples, in a table that has them.
    pub samples: Option<SampleValues>,
}

impl TableRow {
    /// A row without values.
    pub fn new(point: OperatingPoint, status: PointStatus) -> Self {
        Self { point, status, values: [None; Quantity::ALL.len()], samples: None }
    }

    /// A value; `None` where the point has none.
    pub fn value(&self, quantity: Quantity) -> Option<f64> {
        self.values[quantity as usize]
    }

    /// Sets a value.
    pub fn set(&mut self, quantity: Quantity, value: Option<f64>) {
        self.values[quantity as usize] = value;
    }

    /// Whether friction and area are a result.
    pub fn is_result(&self) -> bool {
        self.status.is_result()
    }

    /// Whether all values can be relied on.
    pub fn is_steady(&self) -> bool {
        self.status == PointStatus::Steady
    }

    /// The row's line, its end included.
    pub fn line(&self) -> String {
        let text = |value: &Option<f64>| value.map(number).unwrap_or_default();
        let point = [Some(self.point.speed), Some(self.point.load), self.point.temperature];
        let fields =
            point.iter().map(text).chain([tables::quoted(self.status.text())]).chain(self.values.iter().map(text));
        let fields = fields.chain(self.samples.iter().flat_map(|samples| samples.fields(number)));
        fields.collect::<Vec<_>>().join(",") + "\n"
    }
}

/// The shortest decimal that reads back as the same number; far from 1 with an exponent.
fn number(value: f64) -> String {
    if value == 0.0 || (1e-4..1e16).contains(&value.abs()) { format!("{value}") } else { format!("{value:e}") }
}

fn list(values: &[f64]) -> String {
    values.iter().map(|&value| number(value)).collect::<Vec<_>>().join(",")
}

/// A table's text, divided into its fields.
#[derive(Debug)]
pub struct TableText {
    file: PathBuf,
    /// The values of the header by key.
    header: BTreeMap<String, String>,
    columns: Vec<String>,
    /// The rows, none of them checked.
    pub lines: Vec<TableLine>,
}

/// The line of a row.
#[derive(Debug)]
pub struct TableLine {
    /// Its number in the file, from 1.
    number: usize,
    /// Its text without its end.
    pub text: String,
    fields: Vec<String>,
}

impl TableText {
    /// Divides `text` into its fields; `file` is where it comes from.
    ///
    /// # Errors
    /// [`TableError`] where it is not the table of a sweep, or a row has more or fewer fields than there are columns.
    pub fn parse(text: &str, file: &Path) -> Result<Self, TableError> {
        let table = Self::divided(text, file)?;
        (0..table.lines.len()).try_for_each(|row| table.check_fields(row))?;
        Ok(table)
    }

    /// [`parse`](Self::parse) without the rows that no sweep has written so, which are returned as errors.
    ///
    /// # Errors
    /// [`TableError`] where it is not the table of a sweep, or its header is not as a sweep writes it.
    pub fn parse_sound(text: &str, file: &Path) -> Result<(Self, Vec<TableError>), TableError> {
        let mut table = Self::divided(text, file)?;
        let TableHeader { load, grid, .. } = table.header()?;
        let (mut corrupt, mut found) = (Vec::new(), BTreeSet::new());
        for row in 0..table.lines.len() {
            let index = table.check_row(row, load, &grid);
            let repeated = || table.error_in(row, "the same point as in a row above".into());
            let new = index.and_then(|index| if found.insert(index) { Ok(()) } else { Err(repeated()) });
            corrupt.extend(new.err());
        }
        let is_sound = |line: &TableLine| !corrupt.iter().any(|error| error.line == Some(line.number));
        table.lines.retain(is_sound);
        Ok((table, corrupt))
    }

    fn divided(text: &str, file: &Path) -> Result<Self, TableError> {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let header = tables::comments(text).filter_map(|(_, comment)| key_and_value(comment)).collect();
        let mut lines = text.lines().zip(1..).filter(|(line, _)| !line.starts_with('#') && !line.trim().is_empty());
        let columns = lines.next().map_or_else(Vec::new, |(line, _)| fields(line));
        let lines = lines.map(|(line, number)| TableLine { number, text: line.to_owned(), fields: fields(line) });
        let table = Self { file: file.to_owned(), header, columns, lines: lines.collect() };
        // Key and value of `FORMAT`.
        match table.header.get("asperity sweep").map(String::as_str) {
            Some("1") => Ok(table),
            found => {
                let found = found.unwrap_or("none");
                Err(table.error(format!("not the table of a sweep: expected the line `{FORMAT}`, found {found}")))
            }
        }
    }

    fn check_fields(&self, row: usize) -> Result<(), TableError> {
        match (self.lines[row].fields.len(), self.columns.len()) {
            (found, expected) if found != expected => {
                Err(self.error_in(row, format!("{found} fields, expected {expected}")))
            }
            _ => Ok(()),
        }
    }

    /// Checks that a sweep could have written a row: its fields, its point, which is one of the `grid`, and its values.
    /// Returns the index of the point.
    fn check_row(&self, row: usize, load: Load, grid: &SweepGrid) -> Result<usize, TableError> {
        self.check_fields(row)?;
        let index = grid.index(&self.point(row, load)?);
        let index = index.ok_or_else(|| self.error_in(row, "a point that the header does not have".into()))?;
        let fields = &self.lines[row].fields;
        let is_result = PointStatus::read(&fields[self.column(POINT_COLUMNS[3])?]).is_result();
        for quantity in Quantity::ALL {
            let column = self.column(&quantity.name(load))?;
            let allowed = match fields[column].as_str() {
                "" => !(is_result && quantity == Quantity::Friction),
                text => text.parse().is_ok_and(is_possible),
            };
            if !allowed {
                return Err(self.field_error(row, column, "a number"));
            }
        }
        self.samples_of(row, self.samples())?;
        Ok(index)
    }

    /// The samples that the header names; `None` where there are none.
    fn samples(&self) -> Option<SampleHeader> {
        SampleHeader::read(self.header.get("samples")?)
    }

    /// The samples of a row.
    fn samples_of(&self, row: usize, samples: Option<SampleHeader>) -> Result<Option<SampleValues>, TableError> {
        let Some(SampleHeader { count, .. }) = samples else { return Ok(None) };
        let [friction, hysteresis, contact] = Sampled::ALL.map(|sampled| self.column(&sampled.column()));
        let columns = [friction?, hysteresis?, contact?];
        let fields = columns.map(|column| self.lines[row].fields[column].as_str());
        let expected = || self.field_error(row, columns[0], &format!("{count} numbers in each column of all samples"));
        SampleValues::read(fields, count).ok_or_else(expected).map(Some)
    }

    pub(super) fn error(&self, problem: String) -> TableError {
        TableError::new(&self.file, None, problem)
    }

    pub(super) fn error_in(&self, row: usize, problem: String) -> TableError {
        TableError::new(&self.file, Some(self.lines[row].number), problem)
    }

    pub(super) fn scene(&self) -> String {
        self.header.get("scene").cloned().unwrap_or_else(|| "contact".into())
    }

    /// What the loads are: pressures need the area of the header.
    pub(super) fn load(&self) -> Result<Load, TableError> {
        if self.column(&column_name(POINT_COLUMNS[1], Load::Force)).is_ok() {
            return Ok(Load::Force);
        }
        let area = |text: &str| quantity(text, "m2").filter(|&area| area > 0.0);
        Ok(Load::Pressure { area: self.header_value("nominal_area", "an area above 0 in m2", area)? })
    }

    /// Separation at w = 0, m.
    pub(super) fn rest_separation(&self) -> Result<f64, TableError> {
        self.header_value("rest_separation", "a length in m", |text| quantity(text, "m"))
    }

    /// What the numbers rest on, as far as the table says.
    pub(super) fn basis(&self) -> Basis {
        Basis::read(|key| self.header.get(key).cloned())
    }

    /// The header of a table as a sweep writes it.
    ///
    /// # Errors
    /// [`TableError`] where a line of it is missing, or the columns are not those of this version in their order.
    pub fn header(&self) -> Result<TableHeader, TableError> {
        let load = self.load()?;
        let samples = self.samples();
        let expected = columns(load, samples.is_some());
        if self.columns != expected {
            return Err(self.error(format!("expected the columns {}", expected.join(","))));
        }
        let has_temperatures = self.header.contains_key("temperatures");
        Ok(TableHeader {
            scene: self.scene(),
            fingerprint: self.header_value("fingerprint", "such a line", |text| Some(text.to_owned()))?,
            load,
            rest_separation: self.rest_separation()?,
            basis: self.basis(),
            samples,
            grid: SweepGrid {
                speeds: self.header_numbers("speeds", "m/s")?,
                loads: self.header_numbers(&format!("{}s", load.name()), load.unit())?,
                temperatures: if has_temperatures { self.header_numbers("temperatures", "K")? } else { Vec::new() },
            },
            low_end: None,
            ranking: Vec::new(),
        })
    }

    fn header_value<T>(
        &self,
        key: &str,
        expected: &str,
        read: impl FnOnce(&str) -> Option<T>,
    ) -> Result<T, TableError> {
        let found = self.header.get(key).map(String::as_str);
        found
            .and_then(read)
            .ok_or_else(|| self.error(format!("`# {key} = {}`: expected {expected}", found.unwrap_or_default())))
    }

    fn header_numbers(&self, key: &str, unit: &str) -> Result<Vec<f64>, TableError> {
        let numbers =
            |text: &str| text.strip_suffix(unit)?.split(',').map(|number| number.trim().parse().ok()).collect();
        self.header_value(key, &format!("numbers in {unit}"), numbers)
    }

    /// The rows, their points checked; fields that are no numbers have no value.
    ///
    /// # Errors
    /// [`TableError`] where a column is missing or a point is not given by positive numbers.
    pub fn rows(&self, load: Load) -> Result<Vec<TableRow>, TableError> {
        let points = self.points(load)?;
        let status = self.column(POINT_COLUMNS[3])?;
        let columns = Quantity::ALL.map(|quantity| self.column(&quantity.name(load)).ok());
        let samples = self.samples();
        let row = |(index, point): (usize, OperatingPoint)| {
            let fields = &self.lines[index].fields;
            let status = PointStatus::read(&fields[status]);
            let values = columns.map(|column| fields[column?].parse().ok());
            Ok(TableRow { point, status, values, samples: self.samples_of(index, samples)? })
        };
        points.into_iter().enumerate().map(row).collect()
    }

    /// The point of a row.
    fn point(&self, row: usize, load: Load) -> Result<OperatingPoint, TableError> {
        let fields = &self.lines[row].fields;
        let column = |i: usize| self.column(&column_name(POINT_COLUMNS[i], load));
        let positive = |column: usize| {
            let number = fields[column].parse().ok();
            let number = number.filter(|&number: &f64| number >= SMALLEST && is_possible(number));
            number.ok_or_else(|| self.field_error(row, column, "a number above 0"))
        };
        let temperature = column(2)?;
        Ok(OperatingPoint {
            speed: positive(column(0)?)?,
            load: positive(column(1)?)?,
            temperature: if fields[temperature].is_empty() { None } else { Some(positive(temperature)?) },
            way: None,
        })
    }

    fn points(&self, load: Load) -> Result<Vec<OperatingPoint>, TableError> {
        let points = (0..self.lines.len()).map(|row| self.point(row, load)).collect::<Result<Vec<_>, _>>()?;
        let temperature = self.column(POINT_COLUMNS[2])?;
        match points.iter().position(|point| point.temperature.is_none()) {
            Some(row) if points.iter().any(|point| point.temperature.is_some()) => {
                Err(self.field_error(row, temperature, "a number, as in other rows"))
            }
            _ => Ok(points),
        }
    }

    /// The values of a quantity that an element reads, in the order of `rows`; `None` where the column is ignored, or
    /// is missing or empty and need not be there.
    pub(super) fn values(
        &self,
        load: Load,
        quantity: Quantity,
        rows: &[usize],
    ) -> Result<Option<Vec<f64>>, TableError> {
        let need = quantity.column().need;
        let column = self.column(&quantity.name(load));
        let column = match (need, column) {
            (Need::Ignored, _) | (Need::Optional, Err(_)) => return Ok(None),
            (_, column) => column?,
        };
        if need == Need::Optional && rows.iter().all(|&row| self.lines[row].fields[column].is_empty()) {
            return Ok(None);
        }
        let value = |&row: &usize| {
            let number = self.lines[row].fields[column].parse().ok().filter(|&number| quantity.allows(number));
            number.ok_or_else(|| self.field_error(row, column, quantity.expected()))
        };
        rows.iter().map(value).collect::<Result<_, _>>().map(Some)
    }

    fn column(&self, name: &str) -> Result<usize, TableError> {
        let index = self.columns.iter().position(|column| column == name);
        index.ok_or_else(|| self.error(format!("no column `{name}`")))
    }

    fn field_error(&self, row: usize, column: usize, expected: &str) -> TableError {
        let (name, found) = (&self.columns[column], &self.lines[row].fields[column]);
        self.error_in(row, format!("{name} = \"{found}\": expected {expected}"))
    }
}

fn quantity(text: &str, unit: &str) -> Option<f64> {
    text.strip_suffix(unit)?.trim().parse().ok().filter(|&number| is_possible(number))
}

fn key_and_value(comment: &str) -> Option<(String, String)> {
    let (key, value) = comment.split_once('=')?;
    Some((key.trim().to_owned(), value.trim().to_owned()))
}

fn fields(line: &str) -> Vec<String> {
    tables::fields(line, ',').map(Cow::into_owned).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_has_as_many_fields_as_there_are_columns() {
        let parse = |text: &str| TableText::parse(text, Path::new("t.csv"));
        let error = parse("# asperity sweep = 1\nx [m],y [1]\n\n1,2\n1\n").unwrap_err();
        assert_eq!(error.to_string(), "t.csv:5: 1 fields, expected 2");
        let text = parse("# asperity sweep = 1\n# a = 1 = 2\nx [m],y [1]\n1,2\n").unwrap();
        assert_eq!((text.header["a"].as_str(), text.column("y [1]").unwrap()), ("1 = 2", 1));
        assert_eq!(text.column("y [m]").unwrap_err().to_string(), "t.csv: no column `y [m]`");
    }

    /// What is written is read back as the same, whatever the loads are.
    #[test]
    fn tables_are_read_as_they_were_written() {
        for (load, temperatures) in [(Load::Force, vec![]), (Load::Pressure { area: 2e-5 }, vec![273.15, 293.15])] {
            let grid = SweepGrid { speeds: vec![1e-5, 0.1 + 0.2], loads: vec![2e5, 1e30], temperatures };
            let (scene, fingerprint) = ("a = b, c".to_owned(), "00ff".to_owned());
            let basis = Basis { foundation: Some("half_space".into()), ..Basis::default() };
            let rest_separation = -1.5e-5;
            let samples = Some(SampleHeader { count: 2, seed: 1, redrawn: 0 }).filter(|_| load != Load::Force);
            let (low_end, ranking) = (None, Vec::new());
            let mut header =
                TableHeader { scene, fingerprint, load, rest_separation, basis, samples, grid, low_end, ranking };
            let row = |(i, point): (usize, OperatingPoint)| {
                let mut row = TableRow::new(point, PointStatus::new((i > 0).then_some("not steady, \"by far\"")));
                let values = Quantity::ALL.iter().zip(1..).filter(|(_, number)| number % 3 != 0);
                values.for_each(|(&quantity, number)| row.set(quantity, Some(f64::from(number) / 7.0)));
                row.samples = samples.map(|_| SampleValues::new(&[[Some(0.3), None, Some(0.1)], [None; 3]]));
                row
            };
            let rows: Vec<TableRow> = header.grid.points().enumerate().map(row).collect();
            header.low_end = Some("below 1 Pa".into());
            header.ranking = if samples.is_some() { vec![2, 1] } else { Vec::new() };
            let written = header.text() + &rows.iter().map(TableRow::line).collect::<String>();
            let text = TableText::parse(&written, Path::new("t.csv")).unwrap();
            (header.low_end, header.ranking) = (None, Vec::new());
            assert_eq!((text.header().unwrap(), text.rows(load).unwrap()), (header, rows));
        }
    }
}
