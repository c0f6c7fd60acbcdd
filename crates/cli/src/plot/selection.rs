//! The rows of a result file that are drawn: which, their columns and the units of these.

use std::fmt::{self, Display, Formatter};
use std::path::Path;
use std::path::PathBuf;

use asperity::outputs;
use asperity::patch;
use asperity::seal;
use asperity::tables::ContentError;
use asperity_formats::text::Row;
use asperity_study::Error;
use asperity_study::csv::{self, Csv};
use asperity_study::picture::{Mark, Point};
use clap::Args;

use crate::cli::values::{example, picture};
use crate::terminal::warn;

#[derive(Debug, Args)]
#[command(after_help = example!("asperity plot block.csv --y F_x --y F_z -o forces.svg"))]
pub(crate) struct Plot {
    /// Result files, or tables of asperity sweep or converge; each gives one curve for every --y.
    #[arg(value_name = "FILE.csv", required = true)]
    pub(crate) files: Vec<PathBuf>,
    /// The column for the horizontal axis. Units in a header are not a part of a column's name.
    #[arg(long, value_name = "COLUMN", default_value = "time")]
    pub(crate) x: String,
    /// A column for the vertical axis. May be repeated; columns of another unit have a chart of their own below.
    #[arg(long, value_name = "COLUMN", required_unless_present = "compare")]
    pub(crate) y: Vec<String>,
    /// Compares two files: draws the second less the first below the curves, and says how large that gets, and where.
    /// Rows of the second are interpolated to those of the first. Without --y all columns are compared, and that which
    /// differs most is drawn.
    #[arg(long, conflicts_with = "from_motion")]
    pub(crate) compare: bool,
    /// Draws the rows alone in which a column has this value, a number or a text: pressure=2e5, status=steady. May be
    /// repeated.
    #[arg(long = "where", value_name = "COLUMN=VALUE", value_parser = Condition::parse)]
    pub(crate) conditions: Vec<Condition>,
    /// Logarithmic axes: x, y or both.
    #[arg(long, value_name = "x,y", value_delimiter = ',')]
    pub(crate) log: Vec<PlotAxis>,
    /// Marks every row; curves of few rows are marked in any case.
    #[arg(long)]
    pub(crate) markers: bool,
    /// The plot to write, as SVG or PNG according to the file name.
    #[arg(short, long, value_name = "OUT.svg", value_parser = picture())]
    pub(crate) output: PathBuf,
    /// Names of the curves, one for each file. Default: the file names.
    #[arg(long, value_name = "A,B,...", value_delimiter = ',')]
    pub(crate) labels: Vec<String>,
    /// A title above the plot.
    #[arg(long)]
    pub(crate) title: Option<String>,
    /// Plots -y instead of y: F_x, the force on the carrier, is negative where the carrier slides towards +x.
    #[arg(long)]
    pub(crate) negate: bool,
    /// Starts each curve where x begins to change: with x = u this omits a phase that only presses.
    #[arg(long)]
    pub(crate) from_motion: bool,
}

/// Which rows `--where` chooses.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Condition {
    pub(crate) column: String,
    value: String,
}

impl Condition {
    fn parse(text: &str) -> Result<Self, String> {
        match text.split_once('=') {
            Some((column, value)) if !column.trim().is_empty() => {
                Ok(Self { column: column.trim().into(), value: value.trim().into() })
            }
            _ => Err("expected COLUMN=VALUE, such as pressure=2e5".into()),
        }
    }

    /// Whether a field is the value: the same text, or the same number however it is written.
    pub(crate) fn holds_for(&self, field: &str) -> bool {
        /// Relative difference of numbers that count as the same: values are rounded in tables.
        const ROUNDING: f64 = 1e-9;
        let (field, value) = (field.trim(), self.value.as_str());
        let numbers = || Some((field.parse::<f64>().ok()?, value.parse::<f64>().ok()?));
        field == value || numbers().is_some_and(|(a, b)| (a - b).abs() <= ROUNDING * b.abs())
    }
}

impl Display for Condition {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write!(f, "{} = {}", self.column, self.value)
    }
}

/// An axis of a plot.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum PlotAxis {
    /// The horizontal one.
    X,
    /// The vertical ones.
    Y,
}

/// `asperity plot` failed.
#[derive(Debug, thiserror::Error)]
pub(crate) enum PlotError {
    #[error(transparent)]
    File(#[from] Error),
    #[error("--labels: expected {files}, one name for each file, found {labels}")]
    Labels { labels: usize, files: usize },
    #[error("--where: {file} has no row with {condition}; its {column} has the values {values}")]
    NoSuchRow { file: String, condition: String, column: String, values: String },
    #[error("--where: {file} has no row with all of {conditions}")]
    NoRow { file: String, conditions: String },
    #[error("--compare: expected two files, found {found}")]
    NotTwo { found: usize },
    #[error("--compare: expected {x} to increase from row to row in both files, or to have the same values in both")]
    NotPaired { x: String },
    #[error("--compare: expected columns of numbers besides {x} in both of {} and {}, found none", .names[0], .names[1])]
    NothingInCommon { names: [String; 2], x: String },
}

/// Curves of up to so many rows have their markers without being asked for.
const FEW_ROWS: usize = 40;
/// The rows of a file that are drawn.
#[derive(Debug)]
pub(super) struct Selection<'a> {
    path: &'a Path,
    file: Csv,
    rows: Vec<usize>,
}

impl<'a> Selection<'a> {
    /// The rows of the file at `path` for which all conditions of the command hold.
    pub(super) fn read(path: &'a Path, command: &Plot) -> Result<Self, PlotError> {
        let file = csv::read(path)?;
        let mut rows: Vec<usize> = (0..file.rows.len()).collect();
        if rows.is_empty() {
            let expected = "a line with the columns' names and rows of numbers below it";
            return Err(Error::content(path)(ContentError::value(None, "rows", "0", expected)).into());
        }
        for condition in &command.conditions {
            let column = file.column(&condition.column).map_err(Error::content(path))?;
            let holds = |row: usize| condition.holds_for(&file.rows[row].fields[column]);
            if !(0..file.rows.len()).any(holds) {
                return Err(no_such_row(&file, path, condition, column));
            }
            rows.retain(|&row| holds(row));
        }
        if rows.is_empty() {
            let conditions = command.conditions.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ");
            return Err(PlotError::NoRow { file: path.display().to_string(), conditions });
        }
        Ok(Self { path, file, rows })
    }

    fn refuse(&self, error: ContentError) -> PlotError {
        Error::content(self.path)(error).into()
    }

    fn column(&self, name: &str) -> Result<usize, PlotError> {
        self.file.column(name).map_err(|error| self.refuse(error))
    }

    /// The unit of a column, from its header or by its name; empty for a plain number or an unknown column.
    pub(super) fn unit(&self, column: &str) -> Result<String, PlotError> {
        let header = &self.file.names[self.column(column)?];
        let unit = match header.rsplit_once('[').and_then(|(name, rest)| Some((name, rest.strip_suffix(']')?))) {
            Some((name, unit)) if name.ends_with(' ') => unit,
            _ => unit_of_name(header),
        };
        Ok(if unit == "1" { String::new() } else { symbol(unit) })
    }

    /// The names of all columns, without their units.
    pub(super) fn columns(&self) -> impl Iterator<Item = &str> {
        self.file.names.iter().map(|name| name.split_once(" [").map_or(name.as_str(), |(name, _)| name))
    }

    /// The numbers of a column; where a field is empty, none is.
    pub(super) fn numbers(&self, column: &str) -> Result<Vec<f64>, PlotError> {
        let index = self.column(column)?;
        let number = |row: &Row<'_>| match row.fields[index].trim() {
            "" => Ok(f64::NAN),
            text => text.parse().map_err(|_| {
                let expected = format!("a number; rows are chosen by --where {column}={text}");
                self.refuse(ContentError::value(Some(row.line), column, &format!("{text:?}"), &expected))
            }),
        };
        self.rows.iter().map(|&row| number(&self.file.rows[row])).collect()
    }

    /// A column as a line, with symbols where there are few points.
    pub(super) fn curve(&self, command: &Plot, column: &str, name: &str, look: usize) -> Result<Vec<Mark>, PlotError> {
        let (x, y) = (self.numbers(&command.x)?, self.numbers(column)?);
        let first = if command.from_motion { last_before_motion(&x) } else { 0 };
        let sign = if command.negate { -1.0 } else { 1.0 };
        let points: Vec<Point> = x.iter().zip(&y).skip(first).map(|(&x, &y)| [x, sign * y]).collect();
        let is_drawn = |value: f64, axis| value.is_finite() && (value > 0.0 || !command.log.contains(&axis));
        if !points.iter().any(|&[x, y]| is_drawn(x, PlotAxis::X) && is_drawn(y, PlotAxis::Y)) {
            let path = self.path.display();
            warn(&format!("{path}: nothing to draw of {column}: it has no finite numbers that its axes can show"));
        }
        let is_marked = command.markers || points.len() <= FEW_ROWS;
        Ok(if is_marked { Mark::marked(name, look, points).into() } else { vec![Mark::line(name, look, points)] })
    }
}

fn no_such_row(file: &Csv, path: &Path, condition: &Condition, column: usize) -> PlotError {
    const SHOWN: usize = 12;
    let mut values: Vec<&str> = Vec::new();
    for record in &file.rows {
        let value = &*record.fields[column];
        if !values.contains(&value) {
            values.push(value);
        }
    }
    let more = if values.len() > SHOWN { ", ..." } else { "" };
    values.truncate(SHOWN);
    PlotError::NoSuchRow {
        file: path.display().to_string(),
        condition: condition.to_string(),
        column: condition.column.clone(),
        values: values.join(", ") + more,
    }
}

/// The last row before x changes for the first time.
fn last_before_motion(x: &[f64]) -> usize {
    x.iter().position(|value| *value != x[0]).map_or(0, |moved| moved - 1)
}

/// A unit as it is printed: `N m` for `N.m`, `m²` for `m2`, which takes no prefixes.
fn symbol(unit: &str) -> String {
    unit.replace('.', " ").replace("m2", "m²").replace("m3", "m³")
}

/// The unit of a column of a result file by its name; empty for a plain number or an unknown column.
fn unit_of_name(column: &str) -> &'static str {
    match column {
        "time" => "s",
        "u" | "w" | "x" | "y" | "z" => "m",
        "roll" | "pitch" | "yaw" => "rad",
        "load" | "pull" => "N",
        "temperature" => "K",
        "pressure" => "Pa",
        "speed" | "transport.speed" => "m/s",
        "area" => "m2",
        _ => outputs::unit_of(column)
            .or_else(|| patch::unit_of(column))
            .or_else(|| seal::unit_of(column))
            .map(|unit| unit.name())
            .unwrap_or_default(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_starts_where_its_x_begins_to_change() {
        assert_eq!(last_before_motion(&[0.0, 0.0, 0.0, 1.0]), 2);
        assert_eq!(last_before_motion(&[0.0, 1.0]), 0);
        assert_eq!(last_before_motion(&[0.0, 0.0]), 0);
    }

    #[test]
    fn columns_have_the_units_of_their_variables() {
        let names = [
            ("u", "m"),
            ("F_x", "N"),
            ("element[12].z", "m"),
            ("contact.count", "1"),
            ("?", ""),
            ("moment.z", "N.m"),
            ("contact.area", "m2"),
            ("element[3].traction.x", "Pa"),
            ("element[3,2].temperature", "K"),
            ("contact.temperature_largest", "K"),
            ("dissipation.E_slip", "J"),
            ("tangent.force.x.yaw", "N/rad"),
            ("transport.force", "N"),
            ("transport.speed", "m/s"),
        ];
        for (name, unit) in names {
            assert_eq!(unit_of_name(name), unit, "{name}");
        }
        assert_eq!(["N.m/rad", "m2", "kg/m3", "Pa"].map(symbol), ["N m/rad", "m²", "kg/m³", "Pa"]);
    }

    #[test]
    fn a_condition_holds_for_a_text_and_for_a_number_however_it_is_written() {
        let pressure = Condition::parse("pressure = 2e5").unwrap();
        assert_eq!(
            ["200000", "2e5", "2.0e5", "2e4", "steady", ""].map(|field| pressure.holds_for(field)),
            [true, true, true, false, false, false]
        );
        assert!(Condition::parse("status=steady").unwrap().holds_for("steady"));
        assert!(Condition::parse("pressure").is_err() && Condition::parse("=1").is_err());
    }
}
