//! The motion of a patch as a file: the pose at times, which it goes through straight from row to row.

use std::path::Path;

use asperity::patch::{COORDINATES, Patch, PatchMotion, PatchStart, Pose};
use asperity::scene;
use asperity::tables::{ContentError, Dimension, FINITE, FileKind, Others, ReadColumn, Role};

use crate::error::Error;
use crate::files::read_table;

const TIME: &str = "time";
const TRANSPORT: &str = "transport.speed";
const TEMPERATURE: &str = "temperature";

const ROLES: [Role; 9] = [
    Role::new(TIME, "t, times, zeit", Dimension::Time).within(FINITE),
    Role::new("x", "position x", Dimension::Length).within(FINITE),
    Role::new("y", "position y", Dimension::Length).within(FINITE),
    Role::new("z", "position z", Dimension::Length).within(FINITE),
    Role::new("roll", "angle of roll", Dimension::Angle).within(FINITE),
    Role::new("pitch", "angle of pitch", Dimension::Angle).within(FINITE),
    Role::new("yaw", "angle of yaw", Dimension::Angle).within(FINITE),
    Role::new(TRANSPORT, "transport, speed", Dimension::Speed).within(FINITE).optional(),
    Role::new(TEMPERATURE, "T, temp, temperatur", Dimension::Temperature).within(FINITE).optional(),
];
/// The file of a patch's motion.
pub const PATCH_MOTION: FileKind = FileKind {
    by_position: false,
    rises: true,
    others: Others::Refused,
    ..FileKind::new(
        "a motion of a patch",
        &ROLES,
        "time, x, y, z, roll, pitch, yaw, of a tread transport.speed, and temperature where it is an input",
    )
};

/// A motion, row by row.
#[derive(Debug)]
pub struct MotionFile {
    rows: Vec<MotionRow>,
    has_transport: bool,
    has_temperature: bool,
    /// How it was read.
    pub notes: Vec<String>,
}

/// A row of a motion.
#[derive(Clone, Copy, Debug)]
pub struct MotionRow {
    /// The time of the row, s.
    pub time: f64,
    pose: [f64; 6],
    /// The speed at which the tread runs, m/s; 0 without one.
    transport_speed: f64,
    /// Temperature of the face, K.
    temperature: f64,
}

impl MotionFile {
    /// Reads the motion of a patch: the columns `time` and those of the pose, `transport.speed` with a tread, and
    /// `temperature` where it is an input and is to change.
    ///
    /// # Errors
    /// Where the file cannot be read, a column is missing or is none of these, or a field is not what its column holds.
    pub fn read(path: &Path, patch: &Patch) -> Result<Self, Error> {
        let (has_transport, may_have_temperature) = (patch.has_tread(), patch.has_temperatures());
        let mut table = read_table(path, &PATCH_MOTION, &[])?;
        let refuse = |column: &ReadColumn, expected: &str| {
            Error::content(path)(ContentError::value(table.line, "columns", &column.label(), expected))
        };
        if let Some(column) = table.column(TRANSPORT).filter(|_| !has_transport) {
            return Err(refuse(column, "no such column of a patch without a tread"));
        }
        if has_transport && table.column(TRANSPORT).is_none() {
            let error = ContentError::value(table.line, "columns", "no transport.speed", PATCH_MOTION.expected);
            return Err(Error::content(path)(error));
        }
        if let Some(column) = table.column(TEMPERATURE).filter(|_| !may_have_temperature) {
            return Err(refuse(column, "no such column of a patch whose temperature is no input"));
        }
        let has_temperature = table.column(TEMPERATURE).is_some();
        let value = |key: &str, row: usize| table.values(key).get(row).copied();
        let row = |i: usize| MotionRow {
            time: value(TIME, i).unwrap_or(0.0),
            pose: COORDINATES.map(|key| value(key, i).unwrap_or(0.0)),
            transport_speed: value(TRANSPORT, i).unwrap_or(0.0),
            temperature: value(TEMPERATURE, i).unwrap_or_else(|| patch.temperature()),
        };
        let rows = (0..table.lines.len()).map(row).collect();
        let notes =
            std::mem::take(&mut table.notes).into_iter().map(|note| format!("{}: {}", path.display(), note.text));
        Ok(Self { rows, has_transport, has_temperature, notes: notes.collect() })
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
    pub fn columns(&self) -> Vec<(&'static str, scene::Unit)> {
        use scene::Unit::{Kelvin, Meter, MeterPerSecond, Radian, Second};
        let mut columns = vec![(TIME, Second)];
        columns.extend(COORDINATES.into_iter().zip([Meter, Meter, Meter, Radian, Radian, Radian]));
        columns.extend(self.has_transport.then_some((TRANSPORT, MeterPerSecond)));
        columns.extend(self.has_temperature.then_some((TEMPERATURE, Kelvin)));
        columns
    }

    /// The values of its columns.
    pub fn values(&self, row: &MotionRow) -> Vec<f64> {
        let mut values = vec![row.time];
        values.extend(row.pose);
        values.extend(self.has_transport.then_some(row.transport_speed));
        values.extend(self.has_temperature.then_some(row.temperature));
        values
    }

    /// The start, at the rates of the first interval.
    pub fn start(&self) -> PatchStart {
        let first = &self.rows[0];
        let rates = self.rows.get(1).map_or([0.0; 6], |next| first.rates_to(next));
        PatchStart {
            time: first.time,
            pose: Pose::from_coordinates(first.pose),
            rates,
            transport_speed: first.transport_speed,
            temperature: first.temperature,
        }
    }

    /// The motions from row to row.
    pub fn motions(&self) -> impl Iterator<Item = (PatchMotion, &MotionRow)> {
        self.rows.windows(2).map(|pair| {
            let motion = PatchMotion {
                duration: pair[1].time - pair[0].time,
                rates: pair[0].rates_to(&pair[1]),
                transport_speed: pair[1].transport_speed,
                temperature: pair[0].temperature,
            };
            (motion, &pair[1])
        })
    }
}

impl MotionRow {
    fn rates_to(&self, next: &Self) -> [f64; 6] {
        std::array::from_fn(|i| (next.pose[i] - self.pose[i]) / (next.time - self.time))
    }
}
