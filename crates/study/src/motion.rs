//! The motion of a patch as a file: the pose at times, which it goes through straight from row to row.

use std::path::Path;

use asperity::patch::{COORDINATES, Patch, PatchMotion, PatchStart, Pose};
use asperity::scene;
use asperity::tables::{Dimension, FINITE, Format, Others, Table, Wanted, Words, decode};

use crate::error::Error;
use crate::files::{bytes, read_table};

const TIME: &str = "time";
const TRANSPORT: &str = "transport.speed";
const TEMPERATURE: &str = "temperature";

const fn words(name: &'static str, dimension: Dimension) -> Words<&'static str> {
    Words::new(name, dimension, name, "")
}

const fn wanted(name: &'static [&'static str], meaning: &'static str) -> Wanted<&'static str> {
    Wanted::new(name, name[0], meaning).within(FINITE)
}

/// The columns of a patch with a tread whose temperature is an input.
const MOTION: Format<&str, 9> = Format {
    needs_names: true,
    rises: true,
    others: Others::Refused,
    ..Format::new(
        &[
            Words::new(TIME, Dimension::Time, "time t zeit", ""),
            words("x", Dimension::Length),
            words("y", Dimension::Length),
            words("z", Dimension::Length),
            words("roll", Dimension::Angle),
            words("pitch", Dimension::Angle),
            words("yaw", Dimension::Angle),
            Words::new(TRANSPORT, Dimension::Speed, "transport speed", ""),
            Words::new(TEMPERATURE, Dimension::Temperature, "temperature temp temperatur", ""),
        ],
        [
            wanted(&[TIME], "times"),
            wanted(&["x"], "positions x"),
            wanted(&["y"], "positions y"),
            wanted(&["z"], "positions z"),
            wanted(&["roll"], "angles of roll"),
            wanted(&["pitch"], "angles of pitch"),
            wanted(&["yaw"], "angles of yaw"),
            wanted(&[TRANSPORT], "speeds of the tread"),
            wanted(&[TEMPERATURE], "temperatures").optional(),
        ],
        "time, x, y, z, roll, pitch, yaw, of a tread transport.speed, and temperature where it is an input",
    )
};

/// A motion, row by row.
#[derive(Debug)]
pub struct MotionFile {
    rows: Vec<MotionRow>,
    has_transport: bool,
    has_temperature: bool,
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
        let mut format = MOTION;
        if !has_transport {
            format.columns[7] = format.columns[7].absent();
        }
        if !may_have_temperature {
            format.columns[8] = format.columns[8].absent();
        }
        let bytes = bytes(path)?;
        let read = |bytes: &[u8]| {
            let text = decode(bytes)?;
            let Table { columns, rows, .. } = format.read(&text)?;
            Ok((rows, columns[8].is_some()))
        };
        let ((rows, has_temperature), _) = read_table(&bytes, read).map_err(Error::content(path))?;
        let row = |&[time, x, y, z, roll, pitch, yaw, transport_speed, temperature]: &[f64; 9]| MotionRow {
            time,
            pose: [x, y, z, roll, pitch, yaw],
            transport_speed,
            temperature: if has_temperature { temperature } else { patch.temperature() },
        };
        Ok(Self { rows: rows.iter().map(row).collect(), has_transport, has_temperature })
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
