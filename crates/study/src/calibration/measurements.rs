//! Tables of measured friction: columns by their names and units.

use std::path::Path;

use asperity::element::{Load, OperatingPoint};
use asperity::tables::{
    ABOVE_ZERO, Choice, Column, ContentError, Dimension, FINITE, Format, Others, ReadingNote, Table, UnitRule, Wanted,
    Words, decode,
};

use super::curve_grid::left_out_in_words;
use super::error::{MeasuredFrictionError, NoSliding};
use crate::files;

/// A measured friction coefficient.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// Its line in the file, from 1.
    pub line: usize,
    /// Speed (m/s), pressure (Pa), temperature (K).
    pub point: OperatingPoint,
    /// The friction coefficient.
    pub friction: f64,
    /// Its standard deviation, where it was measured.
    pub sigma: Option<f64>,
}

impl Measured {
    /// The standard deviation, or what it is assumed to be.
    pub fn sigma_or_assumed(&self) -> f64 {
        self.sigma.unwrap_or_else(|| assumed_sigma(self.friction))
    }
}

/// The standard deviation of a friction coefficient that none is given for: 5 % of it and 0.01.
pub(super) fn assumed_sigma(friction: f64) -> f64 {
    (0.05 * friction).hypot(0.01)
}

/// A table of measured friction.
#[derive(Clone, Debug, PartialEq)]
pub struct Measurements {
    /// The rows; several of a point are repeats.
    pub rows: Vec<Measured>,
    /// How the columns were read.
    pub notes: Vec<String>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Quantity {
    Speed,
    Pressure,
    Force,
    Friction,
    Temperature,
    Way,
    Deviation,
}

const FRICTION: Format<Quantity, 6> = Format {
    needs_names: true,
    others: Others::Tables,
    ..Format::new(
        &[
            Words::new(
                Quantity::Deviation,
                Dimension::Number,
                "sigma σ std sd stdev stddev deviation uncertainty standardabweichung err error errors fehler se sem \
                 stderr stdunc unsicherheit s+mu u+mu s+μ u+μ s+cof u+cof s+friction u+friction",
                "standard of friction coefficient mu μ cof the in mean dev 1 reibwert",
            ),
            Words::new(
                Quantity::Speed,
                Dimension::Speed,
                "speed velocity v geschwindigkeit gleitgeschwindigkeit",
                "sliding slip slide relative mean v",
            ),
            Words::new(
                Quantity::Pressure,
                Dimension::Pressure,
                "pressure p druck flächenpressung",
                "mean nominal contact normal average p",
            ),
            Words::new(
                Quantity::Force,
                Dimension::Force,
                "force load fz fn normalkraft last",
                "normal f z vertical mean",
            ),
            Words::new(
                Quantity::Friction,
                Dimension::Number,
                "friction mu μ cof reibwert reibungszahl",
                "coefficient of friction mean the measured",
            ),
            Words::new(
                Quantity::Temperature,
                Dimension::Temperature,
                "T temp temperature temperatur t",
                "sample mean rubber surface ambient track measured",
            ),
            Words::new(
                Quantity::Way,
                Dimension::Length,
                "way distance s weg gleitweg",
                "sliding slid slip of the sample measured",
            ),
        ],
        [
            Wanted::new(&[Quantity::Speed], "speed", "speeds").within(ABOVE_ZERO),
            Wanted {
                choice: Choice::FirstQuantity,
                ..Wanted::new(&[Quantity::Pressure, Quantity::Force], "pressure", "loads").within(ABOVE_ZERO)
            },
            Wanted::new(&[Quantity::Friction], "friction", "friction").within(FINITE),
            Wanted {
                unit: UnitRule::Named,
                ..Wanted::new(&[Quantity::Temperature], "temperature", "temperatures").optional().within(ABOVE_ZERO)
            },
            Wanted {
                unit: UnitRule::Named,
                ..Wanted::new(&[Quantity::Way], "way", "ways").optional().within(ABOVE_ZERO)
            },
            Wanted::new(&[Quantity::Deviation], "sigma", "standard deviations").optional().within(ABOVE_ZERO),
        ],
        "columns by their names with units: speed [m/s], pressure [bar] or force [N], friction; temperature [°C], the way \
         slid [mm] and the standard deviation of friction where there are such",
    )
};

impl Measurements {
    /// Reads the table in the bytes of a file; forces are those on the whole layer, whose `area` (m²) makes pressures of
    /// them.
    ///
    /// # Errors
    /// [`ContentError`] with the line, what was expected and what was found.
    pub fn parse(bytes: &[u8], area: f64) -> Result<Self, ContentError> {
        let text = decode(bytes)?;
        let Table { columns, rows, lines, notes, .. } = FRICTION.read(&text)?;
        let [_, load, friction_column, temperature, way, deviation] = &columns;
        let is_said = |note: &ReadingNote| note.assumed || note.text.contains("left out");
        let mut notes: Vec<String> = notes.into_iter().filter(is_said).map(|note| note.text).collect();
        let is_force = load.as_ref().is_some_and(|column| column.quantity == Quantity::Force);
        let to_pressure = if is_force { Load::Pressure { area }.at_force(1.0) } else { 1.0 };
        if is_force {
            notes.push(format!("forces are those on the scene's whole layer, {area:.6e} m²"));
        }
        let is_in = |column: Option<&Column<Quantity>>, unit| column.is_some_and(|column| column.unit.name == unit);
        let is_relative = is_in(deviation.as_ref(), "%") && !is_in(friction_column.as_ref(), "%");
        if is_relative {
            notes.push("standard deviations in % are taken as parts of the friction".to_owned());
        }
        let row = |(&[speed, load, friction, kelvin, slid, sigma], line): (&[f64; 6], usize)| {
            let sigma = if is_relative { sigma * friction.abs() } else { sigma };
            let (load, temperature) = (to_pressure * load, temperature.as_ref().map(|_| kelvin));
            let point = OperatingPoint { speed, load, temperature, way: way.as_ref().map(|_| slid) };
            Measured { line, point, friction, sigma: deviation.as_ref().map(|_| sigma) }
        };
        Ok(Self { rows: rows.iter().zip(lines).map(row).collect(), notes })
    }

    /// Reads the table in the file at `path`, as [`Self::parse`] does.
    ///
    /// # Errors
    /// Where the file cannot be read, or the table in it is refused.
    pub fn read(path: &Path, area: f64) -> Result<Self, MeasuredFrictionError> {
        let refused = |error| MeasuredFrictionError::Content { path: path.to_owned(), error };
        Self::parse(&files::bytes(path)?, area).map_err(refused)
    }

    /// How many rows are left out with the points that have no result, which, and why; `None` where none is.
    pub(super) fn left_out_in_words(&self, points: &[(OperatingPoint, NoSliding)]) -> Option<String> {
        let lines = |point: &OperatingPoint| {
            self.rows.iter().filter(|row| row.point == *point).map(|row| row.line).collect::<Vec<_>>()
        };
        left_out_in_words(points.iter().map(|(point, why)| (lines(point), *point, why)), self.rows.len())
    }

    /// Whether the standard deviations were measured.
    pub fn has_sigma(&self) -> bool {
        self.rows.iter().all(|row| row.sigma.is_some())
    }

    /// Whether the table has ways.
    pub fn has_way(&self) -> bool {
        self.rows.iter().any(|row| row.point.way.is_some())
    }

    /// Whether the table has temperatures.
    pub fn has_temperature(&self) -> bool {
        self.rows.iter().any(|row| row.point.temperature.is_some())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Measurements, String> {
        Measurements::parse(text.as_bytes(), 2e-3).map_err(|error| error.within("t.csv".as_ref()))
    }

    #[test]
    fn columns_are_found_by_name_and_unit() {
        let measured =
            read("sample;v [mm/s];p [bar];T [°C];mu;std\n1;10;2,5;20;0,8;0,02\n1;100;2,5;40;0,7;0,03\n").unwrap();
        let first = measured.rows[0];
        assert_eq!(first.line, 2);
        assert_eq!(first.point, OperatingPoint { speed: 0.01, load: 2.5e5, temperature: Some(293.15), way: None });
        assert_eq!((first.friction, first.sigma), (0.8, Some(0.02)));
        assert!(measured.has_sigma() && measured.has_temperature());
        assert_eq!(measured.notes, ["columns left out: sample"]);
    }

    #[test]
    fn ways_are_read_with_their_unit() {
        let measured = read("v [m/s],p [bar],way [mm],mu\n1,2,20,0.8\n1,2,200,0.7\n").unwrap();
        assert_eq!(measured.rows.iter().map(|row| row.point.way).collect::<Vec<_>>(), [Some(0.02), Some(0.2)]);
        assert!(measured.has_way() && measured.notes.is_empty(), "{:?}", measured.notes);
        let refusal = read("v [m/s],p [bar],way,mu\n1,2,20,0.8\n").unwrap_err();
        assert!(refusal.starts_with("t.csv:1: unit of column 3 (way): expected it"), "{refusal}");
    }

    /// 40 N on 2e-3 m² are 20 kPa; 5 % of 0.8 and 0.01 together are 0.0412.
    #[test]
    fn forces_make_pressures_and_deviations_are_assumed() {
        let measured = read("speed,normal force [N],friction coefficient\n0.1,40,0.8\n0.1,40,0.9\n").unwrap();
        assert_eq!(measured.rows[0].point.load, 40.0 / 2e-3);
        assert!((measured.rows[0].sigma_or_assumed() - 0.0412).abs() < 1e-4 && !measured.has_sigma());
        assert_eq!(measured.notes.len(), 2, "{:?}", measured.notes);
        assert!(measured.notes[0].contains("m/s is assumed"), "{:?}", measured.notes);
    }

    /// Errors by the names that they have in tables; what is no standard deviation is named as left out.
    #[test]
    fn errors_are_standard_deviations_or_are_named() {
        let table = |name: &str| read(&format!("v [mm/s],p [kPa],mu,{name}\n1,10,0.5,0.02\n")).unwrap();
        for name in ["std", "mu_err", "err", "error", "Error of mu", "s_mu", "u(mu)", "σ_μ", "std. dev.", "sd mu"] {
            assert_eq!(table(name).rows[0].sigma, Some(0.02), "{name}");
        }
        for name in ["mu_min", "mu_max", "CI95", "s", "u", "n"] {
            let found = table(name);
            assert_eq!((found.rows[0].sigma, found.notes), (None, vec![format!("columns left out: {name}")]));
        }
        let relative = read("v [mm/s],p [kPa],mu,error [%]\n1,10,0.5,2\n").unwrap();
        assert!((relative.rows[0].sigma.unwrap() - 0.01).abs() < 1e-15 && relative.notes[0].contains("in %"));
    }

    #[test]
    fn what_is_missing_or_wrong_is_said_with_its_line() {
        for (text, message) in [
            ("speed [m/s],friction\n1,2\n2,3\n", "t.csv:1: columns = \"speed [m/s], friction\": expected columns by"),
            (
                "speed [m/s],p [Pa],mu\n1,2,3\n2,-3,1\n",
                "t.csv:3: column 2 (p [Pa]) = \"-3\": expected a number above 0",
            ),
            ("speed [m/s],p [bar],mu\n1,x,3\n", "t.csv:2: column 2 (p [bar]) = \"x\": expected a number above 0 in Pa"),
            (
                "speed [m/s],p [furlong],mu\n1,2,3\n",
                "t.csv:1: unit of column 2 (p [furlong]) = \"furlong\": expected one of",
            ),
            ("speed [m/s],p [Pa],mu,temperature\n1,2,3,4\n", "t.csv:1: unit of column 4 (temperature): expected it"),
            (
                "speed [m/s],v [m/s],p [Pa],mu\n1,2,3,4\n",
                "t.csv:1: columns = \"speed [m/s]\" and \"v [m/s]\": expected one of",
            ),
            ("1,2,3\n", "t.csv:1: columns = no names: expected columns by their names"),
            ("only words\n", "t.csv:1: rows = 0: expected at least one row of numbers: columns by their names"),
        ] {
            let refusal = read(text).unwrap_err();
            assert!(refusal.starts_with(message), "{text}\n{refusal}");
        }
    }
}
