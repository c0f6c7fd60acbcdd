//! The motion of a patch as a file: the pose at times, which it goes through straight from row to row.

use std::path::Path;

use asperity::patch::{COORDINATES, Patch, PatchMotion, PatchStart, Pose};
use asperity::scene;
use asperity::tables::{Dimension, Heading, Unit, Words};

use crate::csv::{CsvError, CsvFile, Record};

const TIME: &str = "time";
const TRANSPORT: &str = "transport.speed";
const TEMPERATURE: &str = "temperature";

/// The names of columns; a unit may stand behind them.
const COLUMNS: [Words<&str>; 9] = [
    Words::new(TIME, Dimension::Time, &["time"], &["time"]),
    Words::new("x", Dimension::Length, &["x"], &["x"]),
    Words::new("y", Dimension::Length, &["y"], &["y"]),
    Words::new("z", Dimension::Length, &["z"], &["z"]),
    Words::new("roll", Dimension::Angle, &["roll"], &["roll"]),
    Words::new("pitch", Dimension::Angle, &["pitch"], &["pitch"]),
    Words::new("yaw", Dimension::Angle, &["yaw"], &["yaw"]),
    Words::new(TRANSPORT, Dimension::Speed, &["transport", "speed"], &["transport", "speed"]),
    Words::new(TEMPERATURE, Dimension::Temperature, &["temperature"], &["temperature"]),
];

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
    pub fn read(path: &Path, patch: &Patch) -> Result<Self, CsvError> {
        let file = CsvFile::read(path)?;
        let headings: Vec<Option<Heading<&str>>> =
            file.names().iter().map(|name| Heading::parse(name, &COLUMNS)).collect();
        let place = |name: &str| {
            headings.iter().position(|heading| heading.as_ref().is_some_and(|heading| heading.quantity == name))
        };
        let has = |name: &str| place(name).is_some();
        let (has_transport, has_temperature) = (patch.has_tread(), patch.has_temperatures() && has(TEMPERATURE));
        let optional = [(TRANSPORT, has_transport), (TEMPERATURE, has_temperature)];
        let wanted: Vec<&str> = std::iter::once(TIME)
            .chain(COORDINATES)
            .chain(optional.iter().filter(|(_, is_there)| *is_there).map(|(name, _)| *name))
            .collect();
        let indices = wanted
            .iter()
            .map(|name| place(name).map_or_else(|| file.column(name), Ok))
            .collect::<Result<Vec<_>, _>>()?;
        if let Some((_, name)) = file.names().iter().enumerate().find(|(i, _)| !indices.contains(i)) {
            return Err(file.header_error(format!("column {name}: expected {} alone", wanted.join(", "))));
        }
        let with_unit = |i: usize| {
            let unit = headings[i].as_ref().map_or(Ok(Unit::ONE), unit_of);
            Ok((i, unit.map_err(|message| file.header_error(message))?))
        };
        let columns = indices.into_iter().map(with_unit).collect::<Result<Vec<_>, CsvError>>()?;
        let motion = Self { rows: rows(&file, &columns, patch, has_transport)?, has_transport, has_temperature };
        if motion.rows.is_empty() { Err(CsvError::NoRows { path: path.to_owned() }) } else { Ok(motion) }
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

/// The unit of a column; in SI units where none is named.
fn unit_of(heading: &Heading<&str>) -> Result<Unit, String> {
    let unknown =
        |unit| format!("column {} in \"{unit}\": expected one of {}", heading.quantity, heading.dimension.units());
    heading.unit.known().map(|unit| unit.unwrap_or(Unit::ONE)).map_err(unknown)
}

fn rows(
    file: &CsvFile,
    columns: &[(usize, Unit)],
    patch: &Patch,
    has_transport: bool,
) -> Result<Vec<MotionRow>, CsvError> {
    let mut rows: Vec<MotionRow> = Vec::new();
    for record in file.records() {
        let value = |&(i, unit): &(usize, Unit)| number(file, record, i).map(|written| unit.to_si(written));
        let values = columns.iter().map(value).collect::<Result<Vec<_>, _>>()?;
        let mut optional = values.iter().skip(1 + COORDINATES.len()).copied();
        let row = MotionRow {
            time: values[0],
            pose: std::array::from_fn(|i| values[1 + i]),
            transport_speed: if has_transport { optional.next().unwrap_or_default() } else { 0.0 },
            temperature: optional.next().unwrap_or(patch.temperature()),
        };
        if let Some(before) = rows.last().filter(|before| row.time <= before.time) {
            return Err(file.error(record, format!("time = {}: expected one after {} s", row.time, before.time)));
        }
        rows.push(row);
    }
    Ok(rows)
}

fn number(file: &CsvFile, record: &Record, column: usize) -> Result<f64, CsvError> {
    let text = &record.fields[column];
    let finite = text.parse().ok().filter(|number: &f64| number.is_finite());
    finite.ok_or_else(|| file.error(record, format!("{} = {text:?}: expected a number", file.names()[column])))
}
