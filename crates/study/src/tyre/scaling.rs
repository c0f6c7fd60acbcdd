//! A property file for another road, temperature or compound: LMUX, LMUY, LKX and LKY by the ratios of two tables of slip
//! curves at its nominal load.

use std::fmt;
use std::path::{Path, PathBuf};

use asperity::tables::{FINITE, POSITIVE};

use super::curve::{ForceCurve, NO_SLIP};
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
    /// From what to what: tables, conditions, load.
    pub conditions: String,
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
            let [from, to] = [&tables[0], &tables[1]].map(|table| table.at(direction, load, carcass.copied()));
            let ([from_peak, from_slope], [to_peak, to_slope]) = (from?, to?);
            let with = carcass.map_or(String::new(), |carcass| format!(" with a carcass of {carcass} N/m"));
            for (key, figures, of) in [
                (friction, [from_peak, to_peak], format!("peak of {force}")),
                (stiffness, [from_slope, to_slope], format!("slope of {force} at zero {slip}{with}")),
            ] {
                let before = file.number(SECTION, key, POSITIVE)?.unwrap_or(1.0);
                scalings.push(Scaling { key, before, figures, of });
            }
        }
        if scalings.is_empty() {
            return Err(Error::value(notes.join("; ")));
        }
        let [from, to] = tables.map(|table| table.condition);
        let conditions = format!("from {from} to {to} at FNOMIN, {} N", short(load, 6));
        Ok(Self { file, scalings, conditions, notes })
    }

    /// The bytes of the scaled file.
    ///
    /// # Errors
    /// Where a number stands twice in the file, or in another section.
    pub fn bytes(&self) -> Result<Vec<u8>, Error> {
        let numbers: Vec<(&str, f64)> = self.scalings.iter().map(|of| (of.key, of.after())).collect();
        let scaled = format!("Scaled by asperity tir {}", self.conditions);
        let comment: Vec<String> =
            std::iter::once(scaled).chain(self.scalings.iter().map(ToString::to_string)).collect();
        self.file.with(SECTION, &numbers, &comment)
    }
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
        loads.retain(|&load| !self.curve(direction, load).is_empty());
        loads
    }

    /// The curve of a load: the points without the other slip.
    fn curve(&self, direction: &Direction, load: f64) -> ForceCurve {
        let at_load = self.curves.steady().filter(|(point, _)| point.at.load == load);
        let slips = at_load.map(|(point, rolling)| ([point.slip, point.angle], rolling.force[direction.axis]));
        let pure = slips.filter(|(slips, _)| slips[1 - direction.axis].abs() < NO_SLIP);
        ForceCurve::new(&pure.map(|(slips, force)| (slips[direction.axis], force)).collect::<Vec<_>>())
    }

    /// Peak (N) and stiffness (N a slip of 1) at a load (N): over the load straight between those of the table.
    fn at(&self, direction: &Direction, load: f64, carcass: Option<f64>) -> Result<[f64; 2], Error> {
        let loads = self.loads(direction);
        let below = loads.iter().copied().rfind(|&of| of <= load);
        let Some((below, above)) = below.zip(loads.iter().copied().find(|&of| of >= load)) else {
            let found = loads.iter().map(|&of| short(of, 6)).collect::<Vec<_>>().join(", ");
            return Err(self.error(format!("expected loads about the nominal one, {load} N, found {found} N")));
        };
        let low = self.figures(direction, below, carcass)?;
        let high = self.figures(direction, above, carcass)?;
        let part = if above > below { (load - below) / (above - below) } else { 0.0 };
        Ok([0, 1].map(|of| load * (low[of] / below + part * (high[of] / above - low[of] / below))))
    }

    /// Peak and stiffness at a load of the table, the carcass in series.
    fn figures(&self, direction: &Direction, load: f64, carcass: Option<f64>) -> Result<[f64; 2], Error> {
        let Direction { force, slip, .. } = direction;
        let curve = self.curve(direction, load);
        let refuse = |problem: String| self.error(format!("{force} at {load} N {problem}"));
        let rises = || refuse(format!("still rises at the last {slip}, which is no peak: expected a wider range"));
        let peak = curve.peak().ok_or_else(rises)?;
        let length = self.curves.steady().find(|(point, _)| point.at.load == load).map(|found| found.1.contact_length);
        let yielding = carcass.zip(length).map_or(0.0, |(carcass, length)| 2.0 / (carcass * length));
        let stiffness = curve.stiffness().map(|tread| 1.0 / (1.0 / tread + yielding)).filter(|slope| *slope > 0.0);
        let coarse = || refuse(format!("has too few values of {slip} below its peak for a slope at zero"));
        Ok([peak, stiffness.ok_or_else(coarse)?])
    }

    fn error(&self, problem: String) -> Error {
        Error::in_file(&self.path, None, problem)
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests may fail")]
mod tests {
    use std::fs;

    use super::super::{Rolling, SlipPoint};
    use super::*;

    const BASE: &str = "[UNITS]\nFORCE = 'newton'\n[VERTICAL]\nFNOMIN = 2750\n[SCALING_COEFFICIENTS]\nLMUX = 1\n\
                        LMUY = 0.5\n[LONGITUDINAL_COEFFICIENTS]\nPCX1 = 1.5\nPDX1 = 1.1004\nPKX1 = 16.405\n\
                        [LATERAL_COEFFICIENTS]\nPDY1 = 1.0\n";
    /// m.
    const LENGTH: f64 = 0.1;

    /// The Magic Formula with C 1.5, PDX1 1.1004, PKX1 16.405, E 0.
    fn formula(slip: f64, load: f64, friction: f64, stiffness: f64) -> f64 {
        let (c, d, k) = (1.5, 1.1004 * friction * load, 16.405 * stiffness * load);
        d * (c * (k / (c * d) * slip).atan()).sin()
    }

    /// Slip curves of the formula, of F_y three quarters as stiff, over slips up to 0.3.
    fn curves(loads: &[f64], steps: i32, [friction, stiffness]: [f64; 2]) -> SlipCurves {
        let mut points = Vec::new();
        for &load in loads {
            let at = SlipConditions { temperature: Some(283.15), speed: 10.0, load };
            for slip in (-steps..=steps).map(|i| 0.3 * f64::from(i) / f64::from(steps)) {
                let rolling = |force| Ok(Rolling { force, contact_length: LENGTH, ..Rolling::default() });
                let x = rolling([formula(slip, load, friction, stiffness), 0.0, load]);
                let y = rolling([0.0, -formula(slip, load, friction, 0.75 * stiffness), load]);
                points.push(SlipPoint { at, slip, angle: 0.0, free: Some(1.0), rolling: x });
                points.push(SlipPoint { at, slip: 0.0, angle: slip, free: Some(1.0), rolling: y });
            }
        }
        SlipCurves { name: "tread".into(), radius: None, points }
    }

    fn scaled(tables: [&SlipCurves; 2], base: &str, carcass: &[f64]) -> Result<ScaledTyre, Error> {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        fs::write(path("base.tir"), base).unwrap();
        for (name, curves) in ["a.csv", "b.csv"].into_iter().zip(tables) {
            fs::write(path(name), curves.table().text()).unwrap();
        }
        ScaledTyre::new(&path("base.tir"), &path("a.csv"), &path("b.csv"), carcass)
    }

    const LOADS: [f64; 2] = [2000.0, 4000.0];

    #[test]
    fn the_scaled_file_has_the_forces_of_the_formula() {
        let tables = [&curves(&LOADS, 60, [1.0, 1.0]), &curves(&LOADS, 60, [0.8, 1.0])];
        let scaled = scaled(tables, BASE, &[]).unwrap();
        let found: Vec<(&str, f64)> = scaled.scalings.iter().map(|of| (of.key, of.after())).collect();
        for ((key, after), expected) in
            found.into_iter().zip([("LMUX", 0.8), ("LKX", 1.0), ("LMUY", 0.4), ("LKY", 1.0)])
        {
            assert_eq!(key, expected.0);
            // Slips 0.005 apart: the parabola misses a peak by 1e-6, the polynomial a slope by 1e-4.
            let tolerance = if key.starts_with("LM") { 2e-6 } else { 1.5e-4 };
            assert!((after / expected.1 - 1.0).abs() < tolerance, "{key} {after}");
        }
        let bytes = scaled.bytes().unwrap();
        let text = String::from_utf8(bytes.clone()).unwrap();
        let said = "$ Scaled by asperity tir from a.csv (tread, 10 m/s, 10 degC) to b.csv (tread, 10 m/s, 10 degC) at FNOMIN, 2750 N\n\
                    $ LMUX 1 -> 0.";
        assert!(text.contains(said), "{text}");
        let file = PropertyFile::parse(&bytes, Path::new("out.tir")).unwrap();
        let factor = |key: &str| file.number(SECTION, key, POSITIVE).unwrap().unwrap();
        for ([friction, stiffness], [peak, at, force]) in
            [([1.0, 1.0], [3026.1, 0.17428, 1930.4]), ([factor("LMUX"), factor("LKX")], [2420.9, 0.13942, 1792.6])]
        {
            let of = |slip: f64| formula(slip, 2750.0, friction, stiffness);
            // Half of the last digit, and of F(0.05) what LKX misses by; the peak is flat.
            assert!((of(at) - peak).abs() < 0.05 && (of(0.05) - force).abs() < 0.25, "{} {}", of(at), of(0.05));
            assert!(of(at) > of(at + 2e-3).max(of(at - 2e-3)));
        }
    }

    #[test]
    fn a_carcass_is_in_series_with_the_tread() {
        let tables = [&curves(&LOADS, 60, [1.0, 1.0]), &curves(&LOADS, 60, [1.0, 2.0])];
        let scaled = scaled(tables, BASE, &[4e5, 2e5]).unwrap();
        for (key, tread, carcass) in [("LKX", 16.405, 4e5), ("LKY", 0.75 * 16.405, 2e5)] {
            let series =
                |load: f64, factor: f64| 1.0 / (1.0 / (tread * load * factor) + 2.0 / (carcass * LENGTH)) / load;
            // Over the load straight between those of the table.
            let at = |factor: f64| 0.625 * series(2000.0, factor) + 0.375 * series(4000.0, factor);
            let ratio = scaled.scalings.iter().find(|of| of.key == key).unwrap().ratio();
            assert!((ratio / (at(2.0) / at(1.0)) - 1.0).abs() < 1e-3, "{key} {ratio}");
        }
    }

    #[test]
    fn what_cannot_be_scaled_is_refused_in_words() {
        let usual = curves(&LOADS, 60, [1.0, 1.0]);
        let told = |other: &SlipCurves, base: &str| scaled([&usual, other], base, &[]).unwrap_err().to_string();
        let mut short = usual.clone();
        short.points.retain(|point| point.slip.abs() < 0.15);
        assert!(
            told(&short, BASE).ends_with(
                "b.csv: F_x at 2000 N still rises at the last slip, which is no peak: expected a wider range"
            )
        );
        assert!(
            told(&curves(&[4000.0, 6000.0], 60, [1.0; 2]), BASE)
                .ends_with("expected loads about the nominal one, 2750 N, found 4000, 6000 N")
        );
        assert!(told(&curves(&LOADS, 2, [1.0; 2]), BASE).contains("too few values of slip below its peak"));
        let mut warm = usual.clone();
        warm.points[0].at.temperature = Some(300.0);
        assert!(told(&warm, BASE).ends_with("expected one speed and one temperature, found several"));
        assert!(told(&usual, &BASE.replace("PDX1", "LX")).contains("expected the Magic Formula with PDX1, found none"));
        let mut ahead = usual.clone();
        ahead.points.retain(|point| point.angle == 0.0);
        let without = scaled([&usual, &ahead], BASE, &[]).unwrap();
        assert_eq!(without.scalings.len(), 2);
        assert_eq!(without.notes, ["LMUY and LKY stay: b.csv has no F_y from zero slip angle on"]);
    }
}
