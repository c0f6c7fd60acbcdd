//! Tables of measured friction: columns by their names and units.

use std::fmt::Display;
use std::path::Path;

use asperity::element::{FRICTION_COEFFICIENT, Load, OperatingPoint, PRESSURE, SPEED, TEMPERATURE, some_of};
use asperity::scene::FileFormats as _;
use asperity::tables::{
    ABOVE_ZERO, ANY, ContentError, Dimension, FileKind, GivenColumns, NOT_NEGATIVE, NumberRange, Others, POSITIVE,
    ReadColumn, ReadTable, Role,
};
use asperity_formats::Instruments;

use super::models::NoSliding;
use crate::decimals::rounded;
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

const ROLES: [Role; 8] = [
    SPEED,
    PRESSURE.optional(),
    Role::new(
        "normal_force",
        "force, load, normal load, F_N, F_n, F_z, Fz, Fn, vertical force, vertical load, mean normal force, measured normal \
         force, normalkraft, last",
        Dimension::Force,
    )
    .within(ABOVE_ZERO)
    .optional(),
    FRICTION_COEFFICIENT.within(ANY).optional(),
    Role::new(
        "tangential_force",
        "F_T, F_t, F_x, F_r, F_f, friction, friction force, lateral force, traction, traction force, tangential, mean \
         friction force, measured friction force, reibkraft, tangentialkraft",
        Dimension::Force,
    )
    .within(ANY)
    .optional(),
    TEMPERATURE,
    Role::new(
        "sigma",
        "σ, std, std dev, sd, stdev, stddev, deviation, standard deviation, standard deviation of friction, standard \
         deviation of mu, uncertainty, err, error, errors, se, sem, stderr, std err, standard error, mu_err, mu error, \
         error of mu, err mu, mu_std, std mu, mu_sd, sd mu, mu_sigma, sigma mu, s_mu, s(mu), u_mu, u(mu), uncertainty of mu, \
         σ_μ, s_μ, u_μ, μ_err, μ_std, cof_err, cof_std, std cof, s_cof, u_cof, friction_err, friction error, friction_std, \
         std friction, s_friction, u_friction, friction uncertainty, error of friction, standardabweichung, unsicherheit, \
         fehler",
        Dimension::Number,
    )
    .within(POSITIVE)
    .optional(),
    Role::new(
        "way",
        "way slid, sliding way, sliding distance, slid distance, distance, distance slid, slip distance, weg, gleitweg",
        Dimension::Length,
    )
    .within(ABOVE_ZERO)
    .with_unit()
    .optional(),
];
/// The file of measured friction.
pub const FRICTION: FileKind = FileKind {
    by_position: false,
    others: Others::Tables,
    one_of: &[&["friction", "tangential_force"]],
    ..FileKind::new(
        "measured friction",
        &ROLES,
        "columns by their names with units: speed [m/s], pressure [bar] or force [N], friction, or F_T [N] beside the force; \
         temperature [°C], the way slid [mm] and the standard deviation of friction where there are such",
    )
};

impl Measurements {
    /// Reads the table in the bytes of a file, text or a workbook; forces are those on the whole layer, whose `area` (m²)
    /// makes pressures of them. Friction is a column of its own, or F_T over F_N. Columns may be said to be those of roles.
    ///
    /// # Errors
    /// [`ContentError`] with the line, what was expected and what was found.
    pub fn parse(bytes: &[u8], area: f64, columns: &GivenColumns) -> Result<Self, ContentError> {
        Self::of_table(&Instruments.table(bytes, &FRICTION, columns)?, area)
    }

    fn of_table(table: &ReadTable, area: f64) -> Result<Self, ContentError> {
        let mut notes: Vec<String> = table.notes.iter().map(|note| note.text.clone()).collect();
        let (pressure, force) = (table.column("pressure"), table.column("normal_force"));
        let loads: Vec<f64> = match (pressure, force) {
            (Some(pressure), force) => {
                force.map_or(Ok(()), |force| check_loads(table, pressure, force, area))?;
                pressure.values.clone()
            }
            (None, Some(force)) => {
                notes.push(format!("forces are those on the scene's whole layer, {area:.6e} m²"));
                let to_pressure = Load::Pressure { area }.at_force(1.0);
                force.values.iter().map(|force| to_pressure * force).collect()
            }
            (None, None) => {
                let way = "or columns = { pressure = \"NAME\" }, { normal_force = \"NAME\" } (--column pressure=NAME)";
                let expected = format!("{}; {way}", FRICTION.expected);
                return Err(ContentError::value(table.line, "columns", "neither pressure nor force", &expected));
            }
        };
        let frictions = match (table.column("friction"), table.column("tangential_force")) {
            (None, Some(tangential)) => {
                let forces = Forces::of(tangential, &loads, force, area);
                notes.push(forces.note());
                forces.friction()
            }
            (friction, _) => friction.map_or(&[][..], |friction| &friction.values).to_vec(),
        };
        let deviation = Deviation::of(table);
        deviation.check(table, &frictions)?;
        notes.extend(deviation.note());
        check_ranges(table, &frictions, &deviation)?;
        let value = |key: &str, row: usize| table.values(key).get(row).copied();
        let row = |i: usize| {
            let (temperature, way) = (value("temperature", i), value("way", i));
            let point = OperatingPoint { speed: table.values("speed")[i], load: loads[i], temperature, way };
            let sigma = value("sigma", i).and_then(|sigma| deviation.sigma(sigma, frictions[i]));
            Measured { line: table.lines[i], point, friction: frictions[i], sigma }
        };
        Ok(Self { rows: (0..frictions.len()).map(row).collect(), notes })
    }

    /// Reads the table in the file at `path`, as [`Self::parse`] does.
    ///
    /// # Errors
    /// Where the file cannot be read, or the table in it is refused.
    pub fn read(path: &Path, area: f64, columns: &GivenColumns) -> Result<Self, Error> {
        let mut read = Self::parse(&files::bytes(path)?, area, columns).map_err(Error::content(path))?;
        if let Some(told) = read.notes.first_mut() {
            *told = format!("{}: {told}", files::name_of(path));
        }
        Ok(read)
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

    /// Whether the table has temperatures.
    pub fn has_temperature(&self) -> bool {
        self.rows.iter().any(|row| row.point.temperature.is_some())
    }
}

/// What friction of a slide may be, and its standard deviation.
const FRICTIONS: NumberRange = NOT_NEGATIVE.down_to(0.0).up_to(1e3);
const SIGMAS: NumberRange = POSITIVE.down_to(1e-9).up_to(1e3);

/// Refuses friction that no slide has, and deviations that no measurement of it has, by their rows.
fn check_ranges(table: &ReadTable, frictions: &[f64], deviation: &Deviation) -> Result<(), ContentError> {
    let refused = |row: usize, key: &str, given: f64, expected: String| {
        Err(ContentError::value(table.lines.get(row).copied(), key, &rounded(given, 6).to_string(), &expected))
    };
    for (row, &friction) in frictions.iter().enumerate() {
        if !FRICTIONS.holds(friction) {
            let expected = "without the sign of its direction; a row whose sign is noise is to be left out";
            return refused(row, "friction", friction, format!("{FRICTIONS}: friction of a slide, {expected}"));
        }
        let written = table.values("sigma").get(row);
        if let Some(sigma) = written.and_then(|written| deviation.sigma(*written, friction))
            && !SIGMAS.holds(sigma)
        {
            let label = table.column("sigma").map(ReadColumn::label).unwrap_or_default();
            return refused(row, &label, sigma, format!("{SIGMAS}, the standard deviation of friction"));
        }
    }
    Ok(())
}

/// Refuses pressures and forces that are not the same on the layer.
fn check_loads(table: &ReadTable, pressure: &ReadColumn, force: &ReadColumn, area: f64) -> Result<(), ContentError> {
    /// Of columns that are rounded.
    const ROUNDING: f64 = 0.05;
    let per_area = Load::Pressure { area }.at_force(1.0);
    let differs = |(pressure, force): (&f64, &f64)| (per_area * force / pressure - 1.0).abs() > ROUNDING;
    let Some(row) = pressure.values.iter().zip(&force.values).position(differs) else { return Ok(()) };
    let given = format!("{} Pa beside {} N", rounded(pressure.values[row], 6), rounded(force.values[row], 6));
    let expected = format!(
        "{} Pa, that of this force on the scene's whole layer, {area:.6e} m²; or one of both columns",
        rounded(per_area * force.values[row], 6)
    );
    Err(ContentError::value(table.lines.get(row).copied(), &pressure.label(), &given, &expected))
}

/// How forces make friction.
#[derive(Debug)]
struct Forces<'t> {
    tangential: &'t ReadColumn,
    /// F_N, N.
    normal: Vec<f64>,
    /// What that is, in words.
    over: String,
    /// -1 where F_T points backwards in all rows.
    sign: f64,
}

impl<'t> Forces<'t> {
    fn of(tangential: &'t ReadColumn, pressures: &[f64], force: Option<&ReadColumn>, area: f64) -> Self {
        let (normal, over) = match force {
            Some(force) => (force.values.clone(), force.label()),
            None => {
                let forces = pressures.iter().map(|pressure| pressure * area).collect();
                (forces, format!("the pressure on the scene's whole layer, {area:.6e} m²"))
            }
        };
        let backwards = tangential.values.iter().all(|force| *force <= 0.0);
        Self { tangential, normal, over, sign: if backwards { -1.0 } else { 1.0 } }
    }

    fn friction(&self) -> Vec<f64> {
        self.tangential.values.iter().zip(&self.normal).map(|(force, normal)| self.sign * force / normal).collect()
    }

    fn note(&self) -> String {
        let turned = if self.sign < 0.0 { ", which is below 0 throughout and is turned over" } else { "" };
        format!("friction is {} over {}{turned}", self.tangential.label(), self.over)
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
    fn of(table: &ReadTable) -> Self {
        let Some(column) = table.column("sigma") else { return Self::None };
        let in_percent = |column: &ReadColumn| column.unit.name == "%";
        if in_percent(column) && !table.column("friction").is_some_and(in_percent) {
            return Self::Relative;
        }
        let text = column.text.to_lowercase();
        let names_friction = ["friction", "mu", "μ", "\u{b5}", "cof"].iter().any(|name| text.contains(name));
        let is_of_force = table.column("friction").is_none() && !names_friction;
        if is_of_force { Self::OfForce(column.label()) } else { Self::Absolute }
    }

    /// Refuses deviations that are all as large as the friction itself.
    fn check(&self, table: &ReadTable, frictions: &[f64]) -> Result<(), ContentError> {
        let sigmas = table.values("sigma");
        let is_large = |(sigma, friction): (&f64, &f64)| *sigma >= friction.abs();
        let all_large = !sigmas.is_empty() && sigmas.iter().zip(frictions).all(is_large);
        if !(matches!(self, Self::Absolute) && all_large) {
            return Ok(());
        }
        let label = table.column("sigma").map(ReadColumn::label).unwrap_or_default();
        let expected = "a standard deviation below the friction itself, or another name of the column";
        Err(ContentError::value(table.lines.first().copied(), &label, &sigmas[0].to_string(), expected))
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

/// A point by its pressure, for reading.
pub fn in_words(point: &OperatingPoint) -> String {
    let point = OperatingPoint {
        speed: rounded(point.speed, 4),
        load: rounded(point.load, 4),
        temperature: point.temperature.map(|temperature| rounded(temperature, 5)),
        way: point.way.map(|way| rounded(way, 4)),
    };
    point.describe(Load::Pressure { area: 1.0 })
}

/// How many of some measurements are left out, the lines of each with its point and why; `None` where none is.
pub fn left_out_in_words<W: Display>(
    left_out: impl IntoIterator<Item = (Vec<usize>, OperatingPoint, W)>,
    all: usize,
) -> Option<String> {
    let mut count = 0;
    let named = |(lines, point, why): (Vec<usize>, OperatingPoint, W)| {
        count += lines.len();
        let lines: Vec<String> = lines.iter().map(usize::to_string).collect();
        format!("line {} ({}): {why}", lines.join(", "), in_words(&point))
    };
    let named: Vec<String> = left_out.into_iter().map(named).collect();
    (count > 0).then(|| format!("{count} of {all} measurements are left out: {}", some_of(&named)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Measurements, (Option<usize>, String)> {
        Measurements::parse(text.as_bytes(), 2e-3, &[]).map_err(|error| (error.line, error.key))
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
        assert!(measured.notes[0].ends_with("2 rows; left out: sample"), "{:?}", measured.notes);
        for mu in ["μ", "\u{b5}", "MU", "Friction_Coefficient"] {
            assert_eq!(read(&format!("speed_mm_s,p [bar],{mu}\n1,3,0.8\n")).map(|read| read.rows[0].friction), Ok(0.8));
        }
        // A time is no temperature.
        for time in ["t [s]", "T (sec)"] {
            let measured = read(&format!("{time},v [mm/s],p [bar],mu\n1,10,2.5,0.8\n")).unwrap();
            assert!(!measured.has_temperature() && measured.notes[0].contains(time), "{:?}", measured.notes);
        }
    }

    #[test]
    fn ways_are_read_with_their_unit() {
        let measured = read("v [m/s],p [bar],way [mm],mu\n1,2,20,0.8\n1,2,200,0.7\n").unwrap();
        assert_eq!(measured.rows.iter().map(|row| row.point.way).collect::<Vec<_>>(), [Some(0.02), Some(0.2)]);
        assert_eq!(read("v [m/s],p [bar],way,mu\n1,2,20,0.8\n"), Err((Some(1), "unit of column 3 \"way\"".to_owned())));
    }

    /// 40 N on 2e-3 m² are 20 kPa; 5 % of 0.8 and 0.01 together are 0.0412.
    #[test]
    fn forces_make_pressures_and_deviations_are_assumed() {
        let measured = read("speed,normal force [N],friction coefficient\n0.1,40,0.8\n0.1,40,0.9\n").unwrap();
        assert_eq!(measured.rows[0].point.load, 40.0 / 2e-3);
        assert!((measured.rows[0].sigma_or_assumed() - 0.0412).abs() < 1e-4 && !measured.has_sigma());
        assert!(measured.notes[0].contains("in m/s, assumed"), "{:?}", measured.notes);
        let both = |pressure: f64| read(&format!("v [m/s],p [Pa],F_N [N],mu\n1,{pressure},40,0.8\n"));
        assert!(both(2e4).is_ok());
        assert_eq!(both(3e4).map_err(|(line, _)| line), Err(Some(2)));
    }

    /// Errors by the names that they have in tables; what is no standard deviation is named as left out.
    #[test]
    fn errors_are_standard_deviations_or_are_named() {
        let table = |name: &str| read(&format!("v [mm/s],p [kPa],mu,{name}\n1,10,0.5,0.02\n")).unwrap();
        for name in ["std", "mu_err", "err", "error", "Error of mu", "s_mu", "u(mu)", "σ_μ", "std. dev.", "sd mu"] {
            assert_eq!(table(name).rows[0].sigma, Some(0.02), "{name}");
        }
        for name in ["mu_min", "mu_max", "CI95", "s", "u", "n", "mu_s"] {
            let found = table(name);
            assert!(found.rows[0].sigma.is_none() && found.notes[0].ends_with(&format!("left out: {name}")), "{name}");
        }
        let relative = read("v [mm/s],p [kPa],mu,error [%]\n1,10,0.5,2\n").unwrap();
        assert!((relative.rows[0].sigma.unwrap() - 0.01).abs() < 1e-15);
        assert_eq!(read("v [mm/s],p [kPa],mu,std\n1,10,0.5,0.6\n").map_err(|(line, _)| line), Err(Some(2)));
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
            ("v [mm/s],p [kPa],F_N [N],Tangential force [N]", "1,20,40,12"),
            ("v [mm/s],p [kPa],F_T [N]", "1,20,12"),
        ] {
            let measured = read(&format!("{names}\n{numbers}\n")).unwrap();
            assert!(is_it(&measured), "{names}: {:?}", measured.rows);
        }
        let of_force = read("v [mm/s],F_N [N],F_T [N],std\n1,40,12,0.5\n").unwrap();
        assert!(of_force.rows[0].sigma.is_none());
        let both = read("v [mm/s],F_N [N],F_T [N],mu\n1,40,12,0.5\n").unwrap();
        assert_eq!(both.rows[0].friction, 0.5);
    }

    #[test]
    fn what_is_missing_or_wrong_is_refused_at_its_line() {
        for (text, line, key) in [
            ("speed [m/s],friction\n1,2\n2,3\n", 1, "columns"),
            ("speed [m/s],p [Pa],mu\n1,2,3\n2,-3,1\n", 3, "column 2 \"p [Pa]\""),
            ("speed [m/s],p [bar],mu\n1,x,3\n", 2, "column 2 \"p [bar]\""),
            ("speed [m/s],p [furlong],mu\n1,2,3\n", 1, "unit of column 2 \"p [furlong]\""),
            ("speed [m/s],p [Pa],mu,temperature\n1,2,3,4\n", 1, "unit of column 4 \"temperature\""),
            ("speed [m/s],v [m/s],p [Pa],mu\n1,2,3,4\n", 1, "columns"),
            ("speed [m/s],p [Pa],mu\n1,2,-3\n", 2, "friction"),
            ("speed [m/s],p [Pa],mu,std\n1,2,3,1e-300\n", 2, "column 4 \"std\""),
            ("speed [m/s],p [Pa],mu\n1,2,0.5\n2,2,-5\n", 3, "friction"),
            ("speed [m/s],p [Pa],mu\n1,2,0.5\n2,2,1e308\n", 3, "column 3 \"mu\""),
            ("speed [m/s],p [Pa],F_T [N]\n1,2,0.5e-3\n2,2,-5e-3\n", 3, "friction"),
            ("speed [m/s],p [Pa],mu,std\n1,2,3,0.1\n1,2,3,1e-12\n", 3, "column 4 \"std\""),
            ("speed [m/s],p [Pa],mu,std [%]\n1,2,3,5\n1,2,0,5\n", 3, "column 4 \"std [%]\""),
            ("1,2,3\n", 1, "columns"),
            ("only words\n", 1, "rows"),
        ] {
            assert_eq!(read(text), Err((Some(line), key.to_owned())), "{text}");
        }
    }
}
