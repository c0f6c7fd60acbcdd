//! Tables of measured friction: speeds, pressures and friction coefficients, of several temperatures where it depends on
//! that.
//!
//! What is measured on a tester says nothing of how contacts give way. So it is as the table of a sweep all of whose points
//! are in full contact: it serves behind a backing, which alone gives way, and a lip whose pressures are given.

use std::path::Path;

use super::friction_table::{FrictionTable, SWEEP};
use super::grid::{Load, OperatingPoint};
use super::point_status::PointStatus;
use super::quantity::Quantity;
use crate::scene::{FileFormats, read_file};
use crate::table::{Header, Table, TableError};
use crate::tables::{
    ABOVE_ZERO, ContentError, Dimension, FileKind, GivenColumns, NOT_NEGATIVE, Others, ReadTable, ReadingNote, Role,
    canonical,
};

/// Speed of sliding.
pub const SPEED: Role = Role::new(
    "speed",
    "v, velocity, sliding speed, sliding velocity, slip speed, slip velocity, slide speed, mean speed, relative speed, \
     relative velocity, geschwindigkeit, gleitgeschwindigkeit",
    Dimension::Speed,
)
.within(ABOVE_ZERO);
/// Mean pressure on the nominal area.
pub const PRESSURE: Role = Role::new(
    "pressure",
    "p, nominal pressure, contact pressure, mean pressure, average pressure, normal pressure, nominal contact \
     pressure, mean contact pressure, druck, flächenpressung",
    Dimension::Pressure,
)
.within(ABOVE_ZERO);
/// Friction coefficient.
pub const FRICTION_COEFFICIENT: Role = Role::new(
    "friction",
    "mu, μ, cof, mu_k, friction coefficient, coefficient of friction, coefficient, mean friction, mean friction \
     coefficient, measured friction, friction coefficient measured, kinetic friction coefficient, dynamic friction \
     coefficient, sliding friction coefficient, reibwert, reibungszahl",
    Dimension::Number,
)
.within(NOT_NEGATIVE);
/// Temperature of the rubber.
pub const TEMPERATURE: Role = Role::new(
    "temperature",
    "T, t, temp, sample temperature, rubber temperature, surface temperature, track temperature, ambient temperature, \
     mean temperature, measured temperature, temperatur",
    Dimension::Temperature,
)
.within(ABOVE_ZERO)
.with_unit()
.optional();

/// A table of measured friction.
pub const MEASURED_TABLE: FileKind = FileKind {
    others: Others::Refused,
    by_position: false,
    ..FileKind::new(
        "measured friction",
        &[SPEED, PRESSURE, FRICTION_COEFFICIENT, TEMPERATURE],
        "speed [m/s], pressure [Pa], friction and, where it depends on it, temperature [K], nothing else",
    )
};

/// The key of a header and its value that tell measured friction.
const METHOD: (&str, &str) = ("method", "measured");

impl FrictionTable {
    /// Reads the table at `path`, that of a sweep or one of measured friction in one of `formats`, and how that was read.
    /// It may have points in full contact.
    ///
    /// # Errors
    /// [`TableError`] where it is neither, or its grid is not full.
    pub fn read(
        path: &Path,
        formats: &dyn FileFormats,
        columns: &GivenColumns,
    ) -> Result<(Self, Vec<ReadingNote>), TableError> {
        let refused = |line, problem| TableError { file: path.to_owned(), line, problem };
        let bytes = read_file(path).map_err(|error| refused(None, format!("cannot be read: {error}")))?;
        if let Some(text) = sweep_text(&bytes) {
            let table = Table::parse(text, path)?;
            return if columns.is_empty() {
                Ok((Self::of_sweep(&table)?, Vec::new()))
            } else {
                Err(table.error("`columns` is of a table of measured friction, and this is that of a sweep"))
            };
        }
        let read = formats.table(&bytes, &MEASURED_TABLE, columns);
        let or_sweep = |error: ContentError| match &error.key[..] {
            "columns" => error.or("the table of a sweep, with its line `# asperity sweep = 1`"),
            _ => error,
        };
        let mut read = read.map_err(or_sweep).map_err(|error| refused(error.line, error.to_string()))?;
        let notes = std::mem::take(&mut read.notes);
        Ok((Self::of_sweep(&swept(&read, path))?, notes))
    }

    /// Whether its friction was measured.
    pub fn is_measured(&self) -> bool {
        self.header.text_of(METHOD.0) == Some(METHOD.1)
    }

    /// Where it comes from: `swept of block`, `measured (tester.csv)`.
    pub fn origin(&self) -> String {
        if self.is_measured() { format!("measured ({})", self.scene()) } else { format!("swept of {}", self.scene()) }
    }

    /// A table of measured friction in its canonical form; `None` of a sweep's.
    pub fn canonical(&self) -> Option<String> {
        if !self.is_measured() {
            return None;
        }
        let points: Vec<OperatingPoint> = self.grid.points().collect();
        let column = |of: fn(&OperatingPoint) -> Option<f64>| points.iter().filter_map(of).collect::<Vec<f64>>();
        let friction = self.nodes().map(|node| self.value(Quantity::Friction, node)).collect();
        let columns = [
            (SPEED, column(|point| Some(point.speed))),
            (PRESSURE, column(|point| Some(point.load))),
            (FRICTION_COEFFICIENT, friction),
            (TEMPERATURE, column(|point| point.temperature)),
        ];
        let there = columns.iter().filter(|(_, values)| !values.is_empty());
        Some(canonical(&there.map(|(role, values)| (role.key, role.dimension, &values[..])).collect::<Vec<_>>()))
    }
}

/// The text of a sweep's table, by what its header begins with.
fn sweep_text(bytes: &[u8]) -> Option<&str> {
    let text = std::str::from_utf8(bytes).ok()?;
    text.lines().any(|line| line.starts_with('#') && line.contains(SWEEP.0)).then_some(text)
}

/// Measured friction as the table of a sweep whose points all are in full contact.
fn swept(read: &ReadTable, path: &Path) -> Table {
    let load = Load::Pressure { area: 1.0 };
    let name = path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    let header = Header::new(SWEEP)
        .of_file(path)
        .with("scene", &name)
        .with(METHOD.0, METHOD.1)
        .with_number("nominal_area", load.area(), "m2")
        .with_number("rest_separation", 0.0, "m");
    let quantities = [Quantity::Friction, Quantity::Separation].map(|quantity| quantity.column(load));
    let mut table =
        Table::new(header, OperatingPoint::columns(load).into_iter().chain([PointStatus::column()]).chain(quantities));
    let number = |key: &str, row: usize| read.values(key).get(row).copied();
    for (row, &line) in read.lines.iter().enumerate() {
        let point = [SPEED, PRESSURE, TEMPERATURE].map(|role| number(role.key, row).into());
        let values = [PointStatus::FullContact.text().into(), number(FRICTION_COEFFICIENT.key, row).into(), 0.0.into()];
        table.push_read(line, point.into_iter().chain(values));
    }
    table
}
