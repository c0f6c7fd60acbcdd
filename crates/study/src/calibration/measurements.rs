//! Tables of measured friction: columns by their names and units.

use std::path::Path;

use asperity::element::{Load, OperatingPoint};
use asperity::tables::{
    ABOVE_ZERO, Choice, Column, ContentError, Dimension, FINITE, Format, Others, ReadingNote, Table, UnitRule, Wanted,
    Words, decode, words,
};

use super::curve_grid::left_out_in_words;
use super::models::NoSliding;
use crate::error::Error;
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
#[derive(Clone, Debug, Default, PartialEq)]
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
    /// F_T beside F_N.
    Tangential,
    Temperature,
    Way,
    Deviation,
}

const FRICTION: Format<Quantity, 7> = Format {
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
                "force load fz fn normalkraft last f+n f+z normal",
                "normal f z n vertical mean measured",
            ),
            Words::new(
                Quantity::Friction,
                Dimension::Number,
                "friction mu μ cof reibwert reibungszahl",
                "coefficient of friction mean the measured",
            ),
            Words::new(
                Quantity::Tangential,
                Dimension::Force,
                "ft fx fr friction tangential lateral traction reibkraft tangentialkraft f+T f+t f+x f+r",
                "force f T t x r mean measured",
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
                "way distance weg gleitweg",
                "sliding slid slip of the sample measured",
            ),
        ],
        [
            Wanted::new(&[Quantity::Speed], "speed", "speeds").within(ABOVE_ZERO),
            Wanted {
                choice: Choice::FirstQuantity,
                ..Wanted::new(&[Quantity::Pressure, Quantity::Force], "pressure", "loads").within(ABOVE_ZERO)
            },
            Wanted {
                choice: Choice::FirstQuantity,
                ..Wanted::new(&[Quantity::Friction, Quantity::Tangential], "friction", "friction").within(FINITE)
            },
            Wanted {
                unit: UnitRule::Named,
                ..Wanted::new(&[Quantity::Temperature], "temperature", "temperatures").optional().within(ABOVE_ZERO)
            },
            Wanted::new(&[Quantity::Deviation], "sigma", "standard deviations").optional().within(ABOVE_ZERO),
            Wanted::new(&[], "normal force", "normal forces").optional().within(ABOVE_ZERO),
            Wanted {
                unit: UnitRule::Named,
                ..Wanted::new(&[Quantity::Way], "way", "ways").optional().within(ABOVE_ZERO)
            },
        ],
        "columns by their names with units: speed [m/s], pressure [bar] or force [N], friction, or F_T [N] beside the force; \
         temperature [°C], the way slid [mm] and the standard deviation of friction where there are such",
    )
};

impl Measurements {
    /// Reads the table in the bytes of a file; forces are those on the whole layer, whose `area` (m²) makes pressures of
    /// them. Friction is a column of its own, or F_T over F_N.
    ///
    /// # Errors
    /// [`ContentError`] with the line, what was expected and what was found.
    pub fn parse(bytes: &[u8], area: f64) -> Result<Self, ContentError> {
        let text = decode(bytes)?;
        let table = read_columns(&text)?;
        let is_said = |note: &&ReadingNote| note.assumed || note.text.contains("left out");
        let mut notes: Vec<String> = table.notes.iter().filter(is_said).map(|note| note.text.clone()).collect();
        let has_forces = table.columns[1].as_ref().is_some_and(|column| column.quantity == Quantity::Force);
        let to_pressure = if has_forces { Load::Pressure { area }.at_force(1.0) } else { 1.0 };
        if has_forces {
            notes.push(format!("forces are those on the scene's whole layer, {area:.6e} m²"));
        }
        let forces = Forces::of(&table, area);
        notes.extend(forces.iter().map(Forces::note));
        let deviation = Deviation::of(&table, forces.is_some());
        notes.extend(deviation.note());
        let has_temperature = table.columns[3].is_some();
        let has_way = table.columns[6].is_some();
        let row = |(row, line): (&[f64; 7], usize)| {
            let &[speed, load, friction, kelvin, sigma, _, slid] = row;
            let friction = forces.as_ref().map_or(friction, |forces| forces.friction(row));
            let (load, temperature) = (to_pressure * load, has_temperature.then_some(kelvin));
            let point = OperatingPoint { speed, load, temperature, way: has_way.then_some(slid) };
            Measured { line, point, friction, sigma: deviation.sigma(sigma, friction) }
        };
        Ok(Self { rows: table.rows.iter().zip(table.lines.iter().copied()).map(row).collect(), notes })
    }

    /// Reads the table in the file at `path`, text or a workbook, as [`Self::parse`] does.
    ///
    /// # Errors
    /// Where the file cannot be read, or the table in it is refused.
    pub fn read(path: &Path, area: f64) -> Result<Self, Error> {
        let read = files::read_table(&files::bytes(path)?, |bytes| Self::parse(bytes, area));
        let (mut measurements, sheet) = read.map_err(Error::content(path))?;
        measurements.notes.splice(0..0, sheet);
        Ok(measurements)
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

/// The columns of a text; where F_T stands beside a pressure, with F_N if there is such.
fn read_columns(text: &str) -> Result<Table<'_, Quantity, 7>, ContentError> {
    let table = FRICTION.read(text)?;
    let holds = |place: usize, quantity| {
        table.columns[place].as_ref().is_some_and(|column: &Column<Quantity>| column.quantity == quantity)
    };
    if !(holds(1, Quantity::Pressure) && holds(2, Quantity::Tangential)) {
        return Ok(table);
    }
    let mut with_force = FRICTION;
    with_force.columns[5].quantities = &[Quantity::Force];
    with_force.read(text)
}

/// How forces make friction.
#[derive(Debug)]
struct Forces {
    /// The place of F_N among the columns; `None` where the pressure makes it, with the area.
    normal: Option<usize>,
    area: f64,
    /// -1 where F_T points backwards in all rows.
    sign: f64,
    names: [String; 2],
}

impl Forces {
    /// `None` where friction is a column of its own.
    fn of(table: &Table<'_, Quantity, 7>, area: f64) -> Option<Self> {
        let label = |place: usize| table.columns[place].as_ref().map(Column::label);
        let is_tangential = table.columns[2].as_ref()?.quantity == Quantity::Tangential;
        let is_force =
            |place: &usize| table.columns[*place].as_ref().is_some_and(|column| column.quantity == Quantity::Force);
        let normal = [1, 5].into_iter().find(is_force);
        let backwards = table.rows.iter().all(|row| row[2] <= 0.0);
        let names = [label(2)?, label(normal.unwrap_or(1))?];
        is_tangential.then_some(Self { normal, area, sign: if backwards { -1.0 } else { 1.0 }, names })
    }

    fn friction(&self, row: &[f64; 7]) -> f64 {
        let normal = self.normal.map_or_else(|| row[1] * self.area, |place| row[place]);
        self.sign * row[2] / normal
    }

    fn note(&self) -> String {
        let [tangential, normal] = &self.names;
        let over = match self.normal {
            Some(_) => normal.clone(),
            None => format!("{normal} on the scene's whole layer, {:.6e} m²", self.area),
        };
        let turned = if self.sign < 0.0 { ", which is below 0 throughout and is turned over" } else { "" };
        format!("friction is {tangential} over {over}{turned}")
    }
}

/// What is done with the column of standard deviations.
#[derive(Debug)]
enum Deviation {
    None,
    Absolute,
    /// Parts of the friction.
    Relative,
    /// It may be that of a force: it is not used. Its name.
    OfForce(String),
}

impl Deviation {
    fn of(table: &Table<'_, Quantity, 7>, of_forces: bool) -> Self {
        const FRICTION: [&str; 7] = ["friction", "mu", "μ", "cof", "reibwert", "coefficient", "reibungszahl"];
        let Some(column) = &table.columns[4] else { return Self::None };
        let in_percent = |column: &Column<Quantity>| column.unit.name == "%";
        if in_percent(column) && !table.columns[2].as_ref().is_some_and(in_percent) {
            return Self::Relative;
        }
        let names_friction = words(&column.text).iter().any(|word| FRICTION.contains(&word.as_str()));
        if of_forces && !names_friction { Self::OfForce(column.label()) } else { Self::Absolute }
    }

    fn note(&self) -> Option<String> {
        match self {
            Self::Relative => Some("standard deviations in % are taken as parts of the friction".to_owned()),
            Self::OfForce(label) => {
                Some(format!("{label} is left out: it may be that of a force; that of friction is called std mu"))
            }
            Self::None | Self::Absolute => None,
        }
    }

    fn sigma(&self, written: f64, friction: f64) -> Option<f64> {
        match self {
            Self::Absolute => Some(written),
            Self::Relative => Some(written * friction.abs()),
            Self::None | Self::OfForce(_) => None,
        }
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

    /// 12 N over 40 N are 0.3; over 20 kPa on 2e-3 m², which are 40 N too.
    #[test]
    fn friction_is_f_t_over_f_n() {
        let is_it = |measured: &Measurements| {
            let Measured { point, friction, .. } = measured.rows[0];
            (friction - 0.3).abs() < 1e-15 && (point.load / 2e4 - 1.0).abs() < 1e-12
        };
        for (names, numbers) in [
            ("v [mm/s],F_N [N],F_T [N]", "1,40,12"),
            ("v [mm/s],Fz [N],Fx [N]", "1,40,-12"),
            ("v [mm/s],Normal force [kN],Friction force [N]", "1,0.04,12"),
            ("v [mm/s],F_n [N],F_t [N],std [N]", "1,40,12,0.5"),
            ("v [mm/s],p [kPa],F_N [N],Tangential force [N]", "1,20,40,12"),
            ("v [mm/s],p [kPa],F_T [N]", "1,20,12"),
        ] {
            let text = format!("{names}\n{numbers}\n");
            if names.contains("std") {
                assert!(read(&text).unwrap_err().contains("unit of column 4 (std [N])"));
                continue;
            }
            let measured = read(&text).unwrap();
            assert!(is_it(&measured), "{names}: {:?}", measured.rows);
            assert!(measured.notes.iter().any(|note| note.starts_with("friction is column ")), "{:?}", measured.notes);
        }
        let measured = read("v [mm/s],F_N [N],F_T [N],std\n1,40,12,0.5\n").unwrap();
        assert!(measured.rows[0].sigma.is_none() && measured.notes.iter().any(|note| note.contains("may be that of")));
        let both = read("v [mm/s],F_N [N],F_T [N],mu\n1,40,12,0.5\n").unwrap();
        assert_eq!((both.rows[0].friction, &both.notes[0][..]), (0.5, "columns left out: F_T [N]"));
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
