//! The weights of the points in the mean.

use std::path::{Path, PathBuf};

use asperity::element::{Load, OperatingPoint, some_of};
use asperity::tables::{ABOVE_ZERO, Dimension, FileKind, NOT_NEGATIVE, Others, ReadTable, Role};

use crate::error::Error;
use crate::files::{name_of, read_table};

const ROLES: [Role; 5] = [
    Role::new("weight", "weights, w, share, part, gewicht", Dimension::Number).within(NOT_NEGATIVE),
    Role::new("speed", "v, velocity, sliding speed, geschwindigkeit", Dimension::Speed).within(ABOVE_ZERO).optional(),
    Role::new("pressure", "p, mean pressure, nominal pressure, contact pressure, druck", Dimension::Pressure)
        .within(ABOVE_ZERO)
        .optional(),
    Role::new("force", "load, F, Fz, Fn, normal force, normal load, normalkraft, last", Dimension::Force)
        .within(ABOVE_ZERO)
        .optional(),
    Role::new("temperature", "T, t, temp, rubber temperature, temperatur", Dimension::Temperature)
        .within(ABOVE_ZERO)
        .with_unit()
        .optional(),
];
/// The file of weights.
pub const WEIGHTS: FileKind = FileKind {
    by_position: false,
    others: Others::Refused,
    ..FileKind::new(
        "weights",
        &ROLES,
        "columns by their names with units: weight and, as far as it depends on them, speed [m/s], pressure [bar] or force \
         [N], temperature [°C]",
    )
};

/// The weights of points.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Weights {
    /// The file; none where all points weigh the same.
    path: Option<PathBuf>,
    rows: Vec<Weight>,
    /// How it was read.
    pub notes: Vec<String>,
}

/// A weight of all points that have what it says.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Weight {
    line: usize,
    weight: f64,
    speed: Option<f64>,
    load: Option<f64>,
    is_force: bool,
    temperature: Option<f64>,
}

impl Weights {
    /// Reads the table in a file: a column of weights, and of what they depend on.
    ///
    /// # Errors
    /// Where it is no such table.
    pub fn read(path: &Path) -> Result<Self, Error> {
        let table = read_table(path, &WEIGHTS, &[])?;
        let notes = table.notes.iter().map(|note| note.clone().of(Path::new(&name_of(path))).text).collect();
        Ok(Self { path: Some(path.to_owned()), rows: rows(&table), notes })
    }

    /// The weights of `points`, 1 of each without a table.
    pub(super) fn of(&self, points: &[OperatingPoint], load: Load) -> Result<Vec<f64>, Error> {
        let Some(path) = &self.path else { return Ok(vec![1.0; points.len()]) };
        let mut found: Vec<Option<&Weight>> = vec![None; points.len()];
        for row in &self.rows {
            let mut is_asked = false;
            for (place, point) in found.iter_mut().zip(points).filter(|(_, point)| row.is_of(point, load)) {
                is_asked = true;
                if let Some(other) = place.replace(row) {
                    let (other, point) = (other.line, point.describe(load));
                    let problem = format!("{point} has a weight in line {other} already");
                    return Err(Error::in_file(path, Some(row.line), problem));
                }
            }
            if !is_asked {
                let problem = format!("a weight of a point that is not asked for: {}", row.describe());
                return Err(Error::in_file(path, Some(row.line), problem));
            }
        }
        let without = points.iter().zip(&found).filter(|(_, row)| row.is_none());
        let without: Vec<String> = without.map(|(point, _)| point.describe(load)).collect();
        if !without.is_empty() {
            return Err(Error::in_file(path, None, format!("no weight of {}", some_of(&without))));
        }
        let weights: Vec<f64> = found.iter().flatten().map(|row| row.weight).collect();
        match weights.iter().sum::<f64>() > 0.0 {
            true => Ok(weights),
            false => Err(Error::in_file(path, None, "expected a weight above 0")),
        }
    }
}

/// The rows of a table; of a pressure beside a force, the pressure.
fn rows(table: &ReadTable) -> Vec<Weight> {
    let is_force = table.column("pressure").is_none();
    let value = |key: &str, row: usize| table.values(key).get(row).copied();
    let row = |i: usize| Weight {
        line: table.lines[i],
        weight: table.values("weight")[i],
        speed: value("speed", i),
        load: value(if is_force { "force" } else { "pressure" }, i),
        is_force,
        temperature: value("temperature", i),
    };
    (0..table.lines.len()).map(row).collect()
}

impl Weight {
    fn is_of(&self, point: &OperatingPoint, load: Load) -> bool {
        /// Values of a sweep are rounded to six digits.
        const ROUNDING: f64 = 2e-6;
        let is = |asked: Option<f64>, value: Option<f64>| match (asked, value) {
            (None, _) => true,
            (Some(asked), Some(value)) => (asked - value).abs() <= ROUNDING * value.abs(),
            (Some(_), None) => false,
        };
        let is_same_load = self.load.is_none() || self.is_force == matches!(load, Load::Force);
        is(self.speed, Some(point.speed))
            && is_same_load
            && is(self.load, Some(point.load))
            && is(self.temperature, point.temperature)
    }

    fn describe(&self) -> String {
        let unit = if self.is_force { "N" } else { "Pa" };
        let parts = [(self.speed, "m/s"), (self.load, unit), (self.temperature, "K")];
        let named = parts.iter().filter_map(|(value, unit)| Some(format!("{} {unit}", (*value)?)));
        named.collect::<Vec<_>>().join(", ")
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use asperity::scene::FileFormats as _;
    use asperity_formats::Instruments;

    use super::*;

    const PASCAL: Load = Load::Pressure { area: 1.0 };

    fn points() -> Vec<OperatingPoint> {
        let at = |speed, kelvin| OperatingPoint { speed, load: 1e5, temperature: Some(kelvin), way: None };
        vec![at(0.1, 273.15), at(1.0, 273.15), at(0.1, 293.15), at(1.0, 293.15)]
    }

    fn weights(text: &str) -> Result<Vec<f64>, String> {
        let table = Instruments.table(text.as_bytes(), &WEIGHTS, &[]).map_err(|error| error.to_string())?;
        let weights = Weights { path: Some("w.csv".into()), rows: rows(&table), notes: Vec::new() };
        weights.of(&points(), PASCAL).map_err(|error| error.to_string())
    }

    #[test]
    fn a_table_may_leave_out_what_does_not_matter() {
        assert_eq!(Weights::default().of(&points(), PASCAL).unwrap(), [1.0; 4]);
        assert_eq!(weights("temperature [°C];weight\n0;1\n20;3\n").unwrap(), [1.0, 1.0, 3.0, 3.0]);
        let all =
            "speed [mm/s],pressure [bar],temperature [°C],weight\n100,1,0,1\n1000,1,0,2\n100,1,20,3\n1000,1,20,0\n";
        assert_eq!(weights(all).unwrap(), [1.0, 2.0, 3.0, 0.0]);
    }

    #[test]
    fn weights_that_do_not_fit_the_points_are_refused() {
        for (text, message) in [
            (
                "temperature [°C];weight\n0;1\n20;3\n40;1\n",
                "w.csv:4: a weight of a point that is not asked for: 313.15 K",
            ),
            ("temperature [°C];weight\n0;1\n", "w.csv: no weight of 0.1 m/s, 100000 Pa, 293.15 K; 1 m/s"),
            (
                "temperature [°C];weight\n0;1\n0;2\n20;1\n",
                "w.csv:3: 0.1 m/s, 100000 Pa, 273.15 K has a weight in line 2",
            ),
            ("temperature [°C];weight\n0;0\n20;0\n", "w.csv: expected a weight above 0"),
            ("force [N];weight\n100000;1\n1;1\n", "a weight of a point that is not asked for: 100000 N"),
            ("temperature [°C];weight\n0;-1\n20;0\n", "weight"),
            ("speed [m/s];friction\n0.1;1\n1;1\n", "weight"),
        ] {
            let error = weights(text).unwrap_err();
            assert!(error.contains(message), "{text:?}: {error}");
        }
    }
}
