//! The motion of a patch or of a seal as a file: its inputs at times, straight from row to row.

use std::path::Path;

use asperity::patch::{COORDINATES, Patch, PatchMotion, PatchStart, Pose};
use asperity::scene::{self, Unit};
use asperity::seal::{Seal, SealMotion, SealStart};
use asperity::tables::{ContentError, Dimension, FINITE, FileKind, Others, ReadColumn, ReadTable, Role};

use crate::error::Error;
use crate::files::read_table;

const TIME: &str = "time";
const TRANSPORT: &str = "transport.speed";
const TEMPERATURE: &str = "temperature";
const U: &str = "u";
const W: &str = "w";
const SEALED: &str = "sealed_pressure";

const TIME_ROLE: Role = Role::new(TIME, "t, times, zeit", Dimension::Time).within(FINITE);
const TEMPERATURE_ROLE: Role =
    Role::new(TEMPERATURE, "T, temp, temperatur", Dimension::Temperature).within(FINITE).optional();

const PATCH_ROLES: [Role; 9] = [
    TIME_ROLE,
    Role::new("x", "position x", Dimension::Length).within(FINITE),
    Role::new("y", "position y", Dimension::Length).within(FINITE),
    Role::new("z", "position z", Dimension::Length).within(FINITE),
    Role::new("roll", "angle of roll", Dimension::Angle).within(FINITE),
    Role::new("pitch", "angle of pitch", Dimension::Angle).within(FINITE),
    Role::new("yaw", "angle of yaw", Dimension::Angle).within(FINITE),
    Role::new(TRANSPORT, "transport, speed", Dimension::Speed).within(FINITE).optional(),
    TEMPERATURE_ROLE,
];
/// The file of a patch's motion.
pub const PATCH_MOTION: FileKind = FileKind {
    by_position: false,
    rises: true,
    others: Others::Refused,
    ..FileKind::new(
        "a motion of a patch",
        &PATCH_ROLES,
        "time, x, y, z, roll, pitch, yaw, of a tread transport.speed, and temperature where it is an input",
    )
};

const SEAL_ROLES: [Role; 5] = [
    TIME_ROLE,
    Role::new(U, "displacement, stroke, x", Dimension::Length).within(FINITE),
    Role::new(SEALED, "sealed pressure, pressure, p_s", Dimension::Pressure).within(FINITE).optional(),
    Role::new(W, "lift", Dimension::Length).within(FINITE).optional(),
    TEMPERATURE_ROLE,
];
/// The file of a seal's motion.
pub const SEAL_MOTION: FileKind = FileKind {
    by_position: false,
    rises: true,
    others: Others::Refused,
    ..FileKind::new(
        "a motion of a seal",
        &SEAL_ROLES,
        "time, u of the rod, and sealed_pressure, w and temperature where they are inputs and change",
    )
};

/// A motion, row by row.
#[derive(Debug)]
pub struct MotionFile {
    /// The names of the columns after the time, and their units.
    columns: Vec<(&'static str, Unit)>,
    rows: Vec<MotionRow>,
    /// How it was read.
    pub notes: Vec<String>,
}

/// A row of a motion.
#[derive(Clone, Debug)]
pub struct MotionRow {
    /// The time of the row, s.
    pub time: f64,
    /// The values of the columns, SI units.
    values: Vec<f64>,
}

/// What of a motion is an input: its key and unit, and why a column of it is refused where it is none.
type Column = (&'static str, Unit, Result<(), &'static str>);

impl MotionFile {
    /// Reads the motion of a patch: the columns `time` and those of the pose, `transport.speed` with a tread, and
    /// `temperature` where it is an input and is to change.
    ///
    /// # Errors
    /// Where the file cannot be read, a column is missing or is none of these, or a field is not what its column holds.
    pub fn of_patch(path: &Path, patch: &Patch) -> Result<Self, Error> {
        use scene::Unit::{Kelvin, Meter, MeterPerSecond, Radian};
        let table = read_table(path, &PATCH_MOTION, &[])?;
        if patch.has_tread() && table.column(TRANSPORT).is_none() {
            let error = ContentError::value(table.line, "columns", "no transport.speed", PATCH_MOTION.expected);
            return Err(Error::content(path)(error));
        }
        let pose = COORDINATES.into_iter().zip([Meter, Meter, Meter, Radian, Radian, Radian]);
        let columns = pose.map(|(key, unit)| (key, unit, Ok(()))).chain([
            (
                TRANSPORT,
                MeterPerSecond,
                patch.has_tread().then_some(()).ok_or("no such column of a patch without a tread"),
            ),
            (
                TEMPERATURE,
                Kelvin,
                patch.has_temperatures().then_some(()).ok_or("no such column of a patch whose temperature is no input"),
            ),
        ]);
        Self::new(path, table, columns)
    }

    /// Reads the motion of a seal: the columns `time` and `u`, and `sealed_pressure`, `w` and `temperature` where these are
    /// inputs and are to change.
    ///
    /// # Errors
    /// As for [`of_patch`](Self::of_patch).
    pub fn of_seal(path: &Path, seal: &Seal) -> Result<Self, Error> {
        use scene::Unit::{Kelvin, Meter, Pascal};
        let lifts = seal.can_be_lifted().then_some(()).ok_or("no such column of a seal without an approach_stiffness");
        let columns = [
            (U, Meter, Ok(())),
            (SEALED, Pascal, Ok(())),
            (W, Meter, lifts),
            (
                TEMPERATURE,
                Kelvin,
                seal.has_temperatures().then_some(()).ok_or("no such column of a seal whose temperature is no input"),
            ),
        ];
        Self::new(path, read_table(path, &SEAL_MOTION, &[])?, columns.into_iter())
    }

    fn new(path: &Path, mut table: ReadTable, columns: impl Iterator<Item = Column>) -> Result<Self, Error> {
        let refuse = |column: &ReadColumn, expected: &str| {
            Error::content(path)(ContentError::value(table.line, "columns", &column.label(), expected))
        };
        let mut present = Vec::new();
        for (key, unit, is_input) in columns {
            let Some(column) = table.column(key) else { continue };
            is_input.map_err(|expected| refuse(column, expected))?;
            present.push((key, unit));
        }
        let row = |i: usize| MotionRow {
            time: table.values(TIME).get(i).copied().unwrap_or(0.0),
            values: present.iter().map(|(key, _)| table.values(key).get(i).copied().unwrap_or(0.0)).collect(),
        };
        let rows = (0..table.lines.len()).map(row).collect();
        let notes =
            std::mem::take(&mut table.notes).into_iter().map(|note| format!("{}: {}", path.display(), note.text));
        Ok(Self { columns: present, rows, notes: notes.collect() })
    }

    /// Its rows, one at least.
    pub fn rows(&self) -> &[MotionRow] {
        &self.rows
    }

    /// The times of its rows, s.
    pub fn times(&self) -> Vec<f64> {
        self.rows.iter().map(|row| row.time).collect()
    }

    /// The names of its columns, and their units.
    pub fn columns(&self) -> Vec<(&'static str, Unit)> {
        [(TIME, Unit::Second)].into_iter().chain(self.columns.iter().copied()).collect()
    }

    /// The values of its columns.
    pub fn values(&self, row: &MotionRow) -> Vec<f64> {
        [row.time].into_iter().chain(row.values.iter().copied()).collect()
    }

    /// The value of a column in a row; `None` without that column.
    fn value(&self, row: &MotionRow, key: &str) -> Option<f64> {
        let i = self.columns.iter().position(|(name, _)| *name == key)?;
        Some(row.values[i])
    }

    /// How fast a column changes from a row to the next; 0 without that column.
    fn rate(&self, [from, to]: [&MotionRow; 2], key: &str) -> f64 {
        let (before, after) = (self.value(from, key).unwrap_or(0.0), self.value(to, key).unwrap_or(0.0));
        (after - before) / (to.time - from.time)
    }

    /// How fast a column changes at the start.
    fn first_rate(&self, key: &str) -> f64 {
        self.rows.get(1).map_or(0.0, |next| self.rate([&self.rows[0], next], key))
    }

    /// The start of a patch, at the rates of the first interval.
    pub fn start_of_patch(&self, patch: &Patch) -> PatchStart {
        let first = &self.rows[0];
        PatchStart {
            time: first.time,
            pose: Pose::from_coordinates(COORDINATES.map(|key| self.value(first, key).unwrap_or(0.0))),
            rates: COORDINATES.map(|key| self.first_rate(key)),
            transport_speed: self.value(first, TRANSPORT).unwrap_or(0.0),
            temperature: self.value(first, TEMPERATURE).unwrap_or_else(|| patch.temperature()),
        }
    }

    /// The motions of a patch from row to row.
    pub fn motions_of_patch(&self, patch: &Patch) -> impl Iterator<Item = (PatchMotion, &MotionRow)> {
        self.pairs().map(|pair| {
            let motion = PatchMotion {
                duration: pair[1].time - pair[0].time,
                rates: COORDINATES.map(|key| self.rate(pair, key)),
                transport_speed: self.value(pair[1], TRANSPORT).unwrap_or(0.0),
                temperature: self.value(pair[0], TEMPERATURE).unwrap_or_else(|| patch.temperature()),
            };
            (motion, pair[1])
        })
    }

    /// The start of a seal, at the speed of the first interval.
    pub fn start_of_seal(&self, seal: &Seal) -> SealStart {
        let first = &self.rows[0];
        SealStart {
            time: first.time,
            u: self.value(first, U).unwrap_or(0.0),
            w: self.value(first, W).unwrap_or(0.0),
            sealed_pressure: self.value(first, SEALED).unwrap_or_else(|| seal.sealed_pressure()),
            temperature: self.value(first, TEMPERATURE).unwrap_or_else(|| seal.temperature()),
            u_rate: self.first_rate(U),
        }
    }

    /// The motions of a seal from row to row.
    pub fn motions_of_seal(&self, seal: &Seal) -> impl Iterator<Item = (SealMotion, &MotionRow)> {
        self.pairs().map(|pair| {
            let motion = SealMotion {
                duration: pair[1].time - pair[0].time,
                u_rate: self.rate(pair, U),
                w_rate: self.rate(pair, W),
                pressure_rate: self.rate(pair, SEALED),
                temperature: self.value(pair[0], TEMPERATURE).unwrap_or_else(|| seal.temperature()),
            };
            (motion, pair[1])
        })
    }

    fn pairs(&self) -> impl Iterator<Item = [&MotionRow; 2]> {
        self.rows.windows(2).map(|pair| [&pair[0], &pair[1]])
    }
}
