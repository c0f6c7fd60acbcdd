//! A property file for another road, temperature or compound: LMUX, LMUY, LKX and LKY by the ratios of two tables of slip
//! curves at its nominal load.

use std::fmt;
use std::path::{Path, PathBuf};

use asperity::tables::{FINITE, POSITIVE};

use super::curve::{ForceCurve, NO_SLIP, Side};
use super::property::PropertyFile;
use super::slip::{SlipConditions, SlipCurves};
use crate::decimals::{rounded, short, temperature_as_given};
use crate::error::Error;
use crate::files::name_of;

/// The section of what is scaled.
const SECTION: &str = "SCALING_COEFFICIENTS";
/// Digits of the numbers that are written.
const DIGITS: usize = 9;

/// A direction of forces: the names of its numbers in property files, and of what is in tables.
struct Direction {
    axis: usize,
    force: &'static str,
    slip: &'static str,
    friction: &'static str,
    stiffness: &'static str,
    /// The section and the number without which the Magic Formula has no such force.
    formula: (&'static str, &'static str),
}

const DIRECTIONS: [Direction; 2] = [
    Direction {
        axis: 0,
        force: "F_x",
        slip: "slip",
        friction: "LMUX",
        stiffness: "LKX",
        formula: ("LONGITUDINAL_COEFFICIENTS", "PDX1"),
    },
    Direction {
        axis: 1,
        force: "F_y",
        slip: "slip angle",
        friction: "LMUY",
        stiffness: "LKY",
        formula: ("LATERAL_COEFFICIENTS", "PDY1"),
    },
];

/// A number that is scaled.
#[derive(Clone, Debug, PartialEq)]
pub struct Scaling {
    /// Its name.
    pub key: &'static str,
    /// What the file has; 1 where it has none.
    pub before: f64,
    /// Peaks (N) or stiffnesses (N a slip of 1, or a radian), of the one table and of the other.
    pub figures: [f64; 2],
    /// What that is of, in words.
    pub of: String,
}

impl Scaling {
    /// What `before` is multiplied by.
    pub fn ratio(&self) -> f64 {
        self.figures[1] / self.figures[0]
    }

    /// What the scaled file has.
    pub fn after(&self) -> f64 {
        rounded(self.before * self.ratio(), DIGITS)
    }
}

impl fmt::Display for Scaling {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { key, before, of, figures: [from, to] } = self;
        let [from, to, ratio] = [*from, *to, self.ratio()].map(|number| short(number, 5));
        write!(f, "{key} {before} -> {}: {of} {from} N -> {to} N, times {ratio}", self.after())
    }
}

/// A property file and what is scaled in it.
#[derive(Clone, Debug)]
pub struct ScaledTyre {
    file: PropertyFile,
    /// What is scaled.
    pub scalings: Vec<Scaling>,
    /// From what to what: tables, load, conditions.
    pub conditions: Vec<String>,
    /// What stays as it is, and why.
    pub notes: Vec<String>,
}

impl ScaledTyre {
    /// Scales the property file at `base` by the ratios of the table `to` to the table `from` at its nominal load; `carcass` is
    /// what yields beside the tread within the contact, N/m along x and, where that is another, along y.
    ///
    /// # Errors
    /// Where a file is refused, a table has several speeds or temperatures, not the load, or no peak, and both have neither F_x
    /// over slip nor F_y over slip angle.
    pub fn new(base: &Path, from: &Path, to: &Path, carcass: &[f64]) -> Result<Self, Error> {
        if carcass.len() > 2 || carcass.iter().any(|stiffness| !POSITIVE.holds(*stiffness)) {
            let expected = "one or two stiffnesses above 0, in N/m, along x and along y";
            return Err(Error::value(format!("`carcass`: expected {expected}, found {carcass:?}")));
        }
        let file = PropertyFile::read(base)?;
        let load = file.nominal_load()?;
        let tables = [SlipTable::read(from)?, SlipTable::read(to)?];
        let (mut scalings, mut notes) = (Vec::new(), Vec::new());
        for (direction, carcass) in DIRECTIONS.iter().zip([carcass.first(), carcass.last()]) {
            let Direction { force, slip, friction, stiffness, formula: (section, key), .. } = direction;
            if let Some(table) = tables.iter().find(|table| table.loads(direction).is_empty()) {
                let table = name_of(&table.path);
                notes.push(format!("{friction} and {stiffness} stay: {table} has no {force} from zero {slip} on"));
                continue;
            }
            if file.number(section, key, FINITE)?.is_none() {
                return Err(file.error(None, format!("[{section}]: expected the Magic Formula with {key}, found none")));
            }
            let [a, b] =
                [(0, 1), (1, 0)].map(|(of, other)| tables[of].at(direction, load, &tables[other], carcass.copied()));
            let [a, b] = [a?, b?];
            let mut scale = |key, figures, of| -> Result<(), Error> {
                let before = file.number(SECTION, key, POSITIVE)?.unwrap_or(1.0);
                scalings.push(Scaling { key, before, figures, of });
                Ok(())
            };
            let with = carcass.map_or(String::new(), |carcass| format!(" with a carcass of {carcass} N/m"));
            scale(friction, [a.peak, b.peak], format!("peak of {force}"))?;
            scale(stiffness, [a.stiffness, b.stiffness], format!("slope of {force} at zero {slip}{with}"))?;
        }
        if scalings.is_empty() {
            return Err(Error::value(notes.join("; ")));
        }
        let [from, to] = tables.map(|table| table.condition);
        let conditions = vec![format!("from {from} to {to}"), format!("at FNOMIN, {} N", short(load, 6))];
        Ok(Self { file, scalings, conditions, notes })
    }

    /// The bytes of the scaled file.
    ///
    /// # Errors
    /// Where a number stands twice in the file, or in another section.
    pub fn bytes(&self) -> Result<Vec<u8>, Error> {
        let numbers: Vec<(&str, f64)> = self.scalings.iter().map(|of| (of.key, of.after())).collect();
        let scaled = format!("Scaled by asperity tir {}", self.conditions.join(" "));
        let comment: Vec<String> =
            std::iter::once(scaled).chain(self.scalings.iter().map(ToString::to_string)).collect();
        self.file.with(SECTION, &numbers, &comment)
    }
}

/// What a tyre model has of a curve.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Figures {
    /// N.
    peak: f64,
    /// N a slip of 1.
    stiffness: f64,
}

/// Slip curves at one speed and temperature.
struct SlipTable {
    path: PathBuf,
    curves: SlipCurves,
    /// Its name, speed and temperature.
    condition: String,
}

impl SlipTable {
    fn read(path: &Path) -> Result<Self, Error> {
        let curves = SlipCurves::read(path)?;
        let refuse = |problem: &str| Error::in_file(path, None, problem);
        let first = curves.points.first().ok_or_else(|| refuse("expected rows, found none"))?.at;
        if curves.points.iter().any(|point| SlipConditions { load: first.load, ..point.at } != first) {
            return Err(refuse("expected one speed and one temperature, found several"));
        }
        let temperature =
            first.temperature.map_or(String::new(), |kelvin| format!(", {}", temperature_as_given(kelvin)));
        let condition = format!("{} ({}, {} m/s{temperature})", name_of(path), curves.name, short(first.speed, 4));
        Ok(Self { path: path.to_owned(), curves, condition })
    }

    /// The loads (N) with force over the slip of a direction, rising.
    fn loads(&self, direction: &Direction) -> Vec<f64> {
        let mut loads: Vec<f64> = self.curves.points.iter().map(|point| point.at.load).collect();
        loads.sort_by(f64::total_cmp);
        loads.dedup();
        loads.retain(|&load| self.curve(direction, load).sides().next().is_some());
        loads
    }

    /// The curve of a load: the points without the other slip.
    fn curve(&self, direction: &Direction, load: f64) -> ForceCurve {
        let at_load = self.curves.steady().filter(|(point, _)| point.at.load == load);
        let slips = at_load.map(|(point, rolling)| ([point.slip, point.angle], rolling.force[direction.axis]));
        let pure = slips.filter(|(slips, _)| slips[1 - direction.axis].abs() < NO_SLIP);
        ForceCurve::new(pure.map(|(slips, force)| (slips[direction.axis], force)).collect())
    }

    /// Peak and stiffness at a load (N): over the load straight between those of the table.
    fn at(&self, direction: &Direction, load: f64, other: &Self, carcass: Option<f64>) -> Result<Figures, Error> {
        let loads = self.loads(direction);
        let below = loads.iter().copied().rfind(|&of| of <= load);
        let Some((below, above)) = below.zip(loads.iter().copied().find(|&of| of >= load)) else {
            let found = loads.iter().map(|&of| short(of, 6)).collect::<Vec<_>>().join(", ");
            return Err(self.error(format!("expected loads about the nominal one, {load} N, found {found} N")));
        };
        let low = self.figures(direction, below, other, carcass)?;
        let high = self.figures(direction, above, other, carcass)?;
        let part = if above > below { (load - below) / (above - below) } else { 0.0 };
        let between = |low: f64, high: f64| load * (low / below + part * (high / above - low / below));
        Ok(Figures { peak: between(low.peak, high.peak), stiffness: between(low.stiffness, high.stiffness) })
    }

    /// Those of a load of the table, in the mean of the sides that both tables have.
    fn figures(&self, direction: &Direction, load: f64, other: &Self, carcass: Option<f64>) -> Result<Figures, Error> {
        let Direction { force, slip, .. } = direction;
        let curve = self.curve(direction, load);
        let has = |side: &Side| other.loads(direction).iter().any(|&load| other.curve(direction, load).has(*side));
        let sides: Vec<Side> = curve.sides().filter(has).collect();
        let mean = |of: &dyn Fn(Side) -> Option<f64>| {
            let found: Option<Vec<f64>> = sides.iter().map(|&side| of(side)).collect();
            found.filter(|found| !found.is_empty()).map(|found| found.iter().sum::<f64>() / found.len() as f64)
        };
        let refuse = |problem: String| self.error(format!("{force} at {load} N {problem}"));
        let peak = mean(&|side| curve.peak(side)).ok_or_else(|| {
            refuse(format!("still rises at the last {slip}, which is no peak: expected a wider range"))
        })?;
        let tread = mean(&|side| curve.stiffness(side)).filter(|stiffness| *stiffness > 0.0);
        let tread = tread.ok_or_else(|| refuse(format!("has no slope at zero {slip}")))?;
        let length = self.curves.steady().find(|(point, _)| point.at.load == load).map(|found| found.1.contact_length);
        let softer = carcass.zip(length).map(|(carcass, length)| 1.0 / (1.0 / tread + 2.0 / (carcass * length)));
        Ok(Figures { peak, stiffness: softer.unwrap_or(tread) })
    }

    fn error(&self, problem: String) -> Error {
        Error::in_file(&self.path, None, problem)
    }
}
