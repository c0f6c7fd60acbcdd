//! How moduli of several temperatures become those of one: shifted in frequency by known constants, by given factors or by
//! superposition, and scaled by the factor b_T, by which all moduli of a temperature are those of the reference.

use std::f64::consts::LN_10;
use std::path::Path;

use asperity::tables::{ABOVE_ZERO, ContentError, Dimension, FileKind, ReadTable, Role};

use super::compound::{Compound, FitErrors, Sample};
use super::measured::MeasuredModuli;
use super::options::{FitOptions, Vertical, WlfConstants};
use super::shift::{Factor, Isotherm, Superposition, law_of, rms_with, superpose};
use super::table::MeasuredPoint;
use crate::decimals::{percent, plain, rounded, short};
use crate::error::Error;
use crate::files;

/// The rows of one temperature in a master curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShiftedCurve {
    /// Their mean temperature, K.
    pub temperature: f64,
    /// How many there are.
    pub rows: usize,
    /// ln a_T.
    pub ln_factor: f64,
    /// The standard error of that; 0 where it was given.
    pub ln_factor_error: f64,
    /// Root mean square of the relative errors of the fit at them.
    pub rms: f64,
}

/// What is done about temperatures.
#[derive(Debug)]
pub(super) enum Shift {
    /// Nothing: there is one temperature, or none is known, or rows are shifted already.
    None,
    /// By constants that were given.
    Known(WlfConstants, Vec<Isotherm>),
    /// By factors that were given, and the constants that have them.
    Given { factors: Vec<Factor>, isotherms: Vec<Isotherm>, law: Option<WlfConstants> },
    /// By factors that were found.
    Found { found: Superposition, isotherms: Vec<Isotherm> },
}

/// Temperatures that are nearer belong to one curve, K.
const NEAR: f64 = 1.0;
/// The widest curve, K.
const WIDEST: f64 = 3.0;
/// 20 °C, K.
const ROOM: f64 = 293.15;

impl Shift {
    /// What the options and the table say.
    pub(super) fn of(data: &Path, options: &FitOptions, measured: &MeasuredModuli) -> Result<Self, Error> {
        let in_data = |error: ContentError| Error::content(data)(error);
        let is_known = |point: &MeasuredPoint| point.temperature.is_some();
        let all = measured.points.iter().all(is_known);
        if measured.reduced || !measured.points.iter().any(is_known) {
            return match options.shifts {
                Some(_) if !measured.reduced => Err(in_data(refused("no temperatures", "some to shift by `shifts`"))),
                _ => Ok(Self::None),
            };
        }
        if !all {
            return Err(in_data(refused("rows without a temperature", "one in each row, or in none")));
        }
        let isotherms = isotherms(measured);
        if let Some(wlf) = options.wlf {
            return Ok(Self::Known(wlf, isotherms));
        }
        if let Some(path) = &options.shifts {
            return given(path, data, options, isotherms);
        }
        if measured.points.iter().all(|point| point.shift.is_some()) {
            let factors = factors_of(measured, &isotherms).map_err(in_data)?;
            return Ok(Self::with_factors(factors, isotherms, options.reference));
        }
        let [first, .., last] = &isotherms[..] else { return Ok(Self::None) };
        check(measured, &isotherms, (first.temperature, last.temperature)).map_err(in_data)?;
        let found = superpose(&isotherms, measured.test, options.reference.unwrap_or(ROOM));
        Ok(Self::Found { found, isotherms })
    }

    fn with_factors(factors: Vec<Factor>, isotherms: Vec<Isotherm>, reference: Option<f64>) -> Self {
        let wanted = reference.unwrap_or(ROOM);
        // The reference is where a_T is 1, or as wanted.
        let key = |factor: &Factor| factor.ln.abs() + 1e-9 * (factor.temperature - wanted).abs();
        let reference = (0..factors.len()).min_by(|&a, &b| key(&factors[a]).total_cmp(&key(&factors[b]))).unwrap_or(0);
        let law = if factors.len() > 2 { law_of(&factors, reference) } else { None };
        Self::Given { factors, isotherms, law }
    }

    /// The samples at the reference temperature.
    pub(super) fn samples(&self, measured: &MeasuredModuli) -> Result<Vec<Sample>, ContentError> {
        match self {
            Self::None => Ok(measured.samples()),
            Self::Known(wlf, _) => measured.at_reference(|temperature| wlf.at(temperature)),
            Self::Given { factors, isotherms, .. } => {
                Ok(measured.shifted(|point| factor_of(point, factors, isotherms)))
            }
            Self::Found { found, isotherms } => match found.law.filter(|_| found.law_holds()) {
                Some((law, _)) => measured.at_reference(|temperature| law.at(temperature)),
                None => Ok(measured.shifted(|point| factor_of(point, &found.factors, isotherms))),
            },
        }
    }

    /// The temperature of the master curve, K.
    pub(super) fn reference(&self) -> Option<f64> {
        let nearest = |factors: &[Factor]| {
            factors.iter().min_by(|a, b| a.ln.abs().total_cmp(&b.ln.abs())).map(|factor| factor.temperature)
        };
        match self {
            Self::None => None,
            Self::Known(wlf, _) => Some(wlf.reference_temperature),
            Self::Given { factors, .. } => nearest(factors),
            Self::Found { found, .. } => nearest(&found.factors),
        }
    }

    /// The constants for a scene.
    pub(super) fn constants(&self) -> Option<WlfConstants> {
        let law = match self {
            Self::None => None,
            Self::Known(wlf, _) => return Some(*wlf),
            Self::Given { law, .. } => *law,
            Self::Found { found, .. } => found.law.map(|(law, _)| law),
        };
        // As many digits as such constants have.
        law.map(|law| WlfConstants {
            c1: rounded(law.c1, 5),
            c2: rounded(law.c2, 5),
            reference_temperature: rounded(law.reference_temperature, 6),
        })
    }

    /// What the factors leave open.
    pub(super) fn warnings(&self) -> Vec<String> {
        let Self::Found { found, .. } = self else { return Vec::new() };
        /// A factor that is less certain than this is hardly known.
        const UNCERTAIN: f64 = 0.3;
        let mut warnings: Vec<String> = found
            .factors
            .iter()
            .filter(|factor| factor.error > UNCERTAIN)
            .map(|factor| {
                let share = (factor.error / LN_10 * 100.0).round() / 100.0;
                format!(
                    "log10 a_T at {:.2} K is known to ± {share} alone: its curve overlaps too little",
                    factor.temperature
                )
            })
            .collect();
        match found.law {
            None => warnings.push("fewer than three temperatures: no constants for other ones follow from them".into()),
            Some((_, rms)) if !found.law_holds() => warnings.push(format!(
                "no WLF constants have these shift factors: with the nearest {} are left of one curve, {} with the \
                 factors, by which rows are shifted; do not use the constants far from the reference temperature",
                percent(rms, 3),
                percent(found.rms, 3)
            )),
            Some(_) => (),
        }
        warnings
    }

    /// What is to blame for what is left, other than scatter: temperatures that are not given, or known constants,
    /// where with factors of their own the curves fit.
    pub(super) fn blame(&self, measured: &MeasuredModuli) -> Option<String> {
        if matches!(self, Self::None) && !measured.reduced {
            let [first, second] = measured.contradiction()?;
            return Some(format!(
                "lines {first} and {second} have other moduli at the same place, as those of several temperatures \
                 have, and no temperatures are given"
            ));
        }
        let Self::Known(wlf, isotherms) = self else { return None };
        let [first, .., last] = &isotherms[..] else { return None };
        check(measured, isotherms, (first.temperature, last.temperature)).ok()?;
        let with = rms_with(isotherms, measured.test, wlf);
        let found = superpose(isotherms, measured.test, wlf.reference_temperature);
        /// By so much factors of their own must be better.
        const BETTER: f64 = 0.7;
        if found.rms > BETTER * with {
            return None;
        }
        let constants = found.law.map_or_else(String::new, |(law, _)| {
            format!(
                ": `wlf` {},{},{}",
                short(law.c1, 4),
                short(law.c2, 4),
                plain(rounded(law.reference_temperature, 6))
            )
        });
        Some(format!(
            "the WLF constants do not put the temperatures together: they leave {} of one curve, factors of their own \
             {} (leave `wlf` out){constants}",
            percent(with, 3),
            percent(found.rms, 3)
        ))
    }

    /// The constants that follow from the data, and whether they shift the rows: else they are fitted to the factors that
    /// do.
    pub(super) fn found_law(&self) -> Option<(WlfConstants, bool)> {
        let shifts = match self {
            Self::None | Self::Known(..) => return None,
            Self::Given { .. } => false,
            Self::Found { found, .. } => found.law_holds(),
        };
        Some((self.constants()?, shifts))
    }

    /// Factors and residuals by temperature.
    pub(super) fn curves(
        &self,
        measured: &MeasuredModuli,
        samples: &[Sample],
        compound: &Compound,
    ) -> Vec<ShiftedCurve> {
        let (isotherms, factors): (&[Isotherm], Vec<Factor>) = match self {
            Self::None => return Vec::new(),
            Self::Known(wlf, isotherms) => (isotherms, isotherms.iter().map(|isotherm| known(wlf, isotherm)).collect()),
            Self::Given { factors, isotherms, .. } => (isotherms, factors.clone()),
            Self::Found { found, isotherms } => (isotherms, found.factors.clone()),
        };
        let curve = |(i, (isotherm, factor)): (usize, (&Isotherm, &Factor))| {
            let of_isotherm = measured.points.iter().zip(samples);
            let own: Vec<Sample> = of_isotherm
                .filter(|(point, _)| isotherm_of(point, isotherms) == i)
                .map(|(_, sample)| *sample)
                .collect();
            ShiftedCurve {
                temperature: isotherm.temperature,
                rows: own.len(),
                ln_factor: factor.ln,
                ln_factor_error: factor.error,
                rms: FitErrors::of(compound, &own, measured.test).both.rms,
            }
        };
        isotherms.iter().zip(&factors).enumerate().map(curve).collect()
    }
}

fn known(wlf: &WlfConstants, isotherm: &Isotherm) -> Factor {
    let ln = wlf.at(isotherm.temperature).shift_factor().ln();
    Factor { temperature: isotherm.temperature, ln, error: 0.0 }
}

/// The curves of the temperatures, from cold to hot: by the numbers of their measurements, or rows whose temperatures
/// are near.
fn isotherms(measured: &MeasuredModuli) -> Vec<Isotherm> {
    let points = &measured.points;
    let by_set = points.iter().all(|point| point.set.is_some());
    let key = |point: &MeasuredPoint| if by_set { point.set.unwrap_or(0.0) } else { point.temperature.unwrap_or(0.0) };
    let mut sorted: Vec<&MeasuredPoint> = points.iter().collect();
    sorted.sort_by(|a, b| key(a).total_cmp(&key(b)));
    let width = if by_set { 0.0 } else { NEAR };
    let groups = sorted.chunk_by(|a, b| key(b) - key(a) <= width);
    let mut isotherms: Vec<Isotherm> = groups
        .map(|group| {
            let sum: f64 = group.iter().filter_map(|point| point.temperature).sum();
            let samples = group.iter().map(|point| point.sample).collect();
            Isotherm { temperature: sum / group.len() as f64, samples }
        })
        .collect();
    isotherms.sort_by(|a, b| a.temperature.total_cmp(&b.temperature));
    isotherms
}

/// The curve nearest to the temperature of a point.
fn isotherm_of(point: &MeasuredPoint, isotherms: &[Isotherm]) -> usize {
    let distance = |i: &usize| (isotherms[*i].temperature - point.temperature.unwrap_or(0.0)).abs();
    (0..isotherms.len()).min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(0)
}

fn factor_of(point: &MeasuredPoint, factors: &[Factor], isotherms: &[Isotherm]) -> f64 {
    factors.get(isotherm_of(point, isotherms)).map_or(1.0, |factor| factor.ln.exp())
}

/// What shifts rows where no factors can be found.
const CONSTANTS_OR_FACTORS: &str = "`wlf` C1,C2,TREF or `shifts` SHIFTS.csv";

/// The error of what was `found` in the whole table.
fn refused(found: &str, expected: &str) -> ContentError {
    ContentError::value(None, "", found, expected)
}

/// Curves that can be laid over each other.
fn check(measured: &MeasuredModuli, isotherms: &[Isotherm], ends: (f64, f64)) -> Result<(), ContentError> {
    for isotherm in isotherms {
        let place = isotherm.samples[0].at;
        if isotherm.samples.iter().all(|sample| (sample.at / place - 1.0).abs() < 1e-6) {
            let what = if measured.in_hertz { "frequency" } else { "place" };
            let found = format!("{:.2} K at one {what} alone", isotherm.temperature);
            let expected = format!("curves that overlap; or {CONSTANTS_OR_FACTORS}");
            return Err(refused(&found, &expected));
        }
    }
    let widest = widest(measured, isotherms);
    if widest <= WIDEST {
        return Ok(());
    }
    let found = format!("temperatures that run through from {:.2} to {:.2} K", ends.0, ends.1);
    let expected = format!("rows at a few temperatures, which have a range in common; or {CONSTANTS_OR_FACTORS}");
    Err(refused(&found, &expected))
}

/// The largest distance of a row's temperature from that of its curve, twice, K.
fn widest(measured: &MeasuredModuli, isotherms: &[Isotherm]) -> f64 {
    let distance = |point: &MeasuredPoint| {
        let own = isotherm_of(point, isotherms);
        2.0 * (isotherms[own].temperature - point.temperature.unwrap_or(0.0)).abs()
    };
    measured.points.iter().map(distance).fold(0.0, f64::max)
}

/// The factors in the rows of the table, one for each curve.
fn factors_of(measured: &MeasuredModuli, isotherms: &[Isotherm]) -> Result<Vec<Factor>, ContentError> {
    let mut factors: Vec<Option<f64>> = vec![None; isotherms.len()];
    for point in &measured.points {
        let i = isotherm_of(point, isotherms);
        let (temperature, here) = (isotherms[i].temperature, point.shift.unwrap_or(1.0));
        match factors[i] {
            Some(before) if (here / before - 1.0_f64).abs() > 0.01 => {
                let found = format!("a_T at {temperature:.2} K of {before} and {here}");
                return Err(refused(&found, "one for all rows of a temperature"));
            }
            Some(_) => (),
            None => factors[i] = Some(here),
        }
    }
    let factor = |(isotherm, factor): (&Isotherm, Option<f64>)| Factor {
        temperature: isotherm.temperature,
        ln: factor.unwrap_or(1.0).ln(),
        error: 0.0,
    };
    Ok(isotherms.iter().zip(factors).map(factor).collect())
}

/// Reads factors from a table: columns temperature and a_T.
fn given(path: &Path, data: &Path, options: &FitOptions, isotherms: Vec<Isotherm>) -> Result<Shift, Error> {
    let table = shift_table(path)?;
    if table.column("shift_factor").is_none() {
        let error = ContentError::value(table.line, "columns", "no a_T", SHIFTS.expected);
        return Err(Error::content(path)(error));
    }
    let table = factors_in(&table, "shift_factor");
    let factor = |isotherm: &Isotherm| {
        let temperature = isotherm.temperature;
        let found = nearest(&table, temperature).filter(|(kelvin, _)| (kelvin - temperature).abs() <= NEAR);
        let missing = || {
            let found = format!("{temperature:.2} K");
            refused(&found, &format!("a factor for it in {}, within {NEAR} K", path.display()))
        };
        Ok(Factor { temperature, ln: found.ok_or_else(missing)?.1.ln(), error: 0.0 })
    };
    let factors: Result<Vec<Factor>, ContentError> = isotherms.iter().map(factor).collect();
    Ok(Shift::with_factors(factors.map_err(Error::content(data))?, isotherms, options.reference))
}

/// The row of factors that is nearest to a temperature, K.
fn nearest(factors: &[(f64, f64)], temperature: f64) -> Option<&(f64, f64)> {
    let distance = |(kelvin, _): &&(f64, f64)| (kelvin - temperature).abs();
    factors.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)))
}

const SHIFT_ROLES: [Role; 5] = [
    Role::new("temperature", "T, t, temp, temperatures, temperatur", Dimension::Temperature)
        .within(ABOVE_ZERO)
        .with_unit(),
    Role::new(
        "shift_factor",
        "a_T, shift factors, horizontal shift factor, shift, horizontal shift",
        Dimension::Number,
    )
    .within(ABOVE_ZERO)
    .optional(),
    Role::new(
        "log_shift_factor",
        "log a_T, log10 a_T, lg a_T, log10(a_T), log(a_T), log shift factor",
        Dimension::Number,
    )
    .optional(),
    Role::new("vertical_factor", "b_T, vertical shift factor, vertical shift, vertical", Dimension::Number)
        .within(ABOVE_ZERO)
        .optional(),
    Role::new("log_vertical_factor", "log b_T, log10 b_T, lg b_T, log10(b_T), log(b_T)", Dimension::Number).optional(),
];
/// The file of shift factors.
pub const SHIFTS: FileKind = FileKind {
    by_position: false,
    one_of: &[&["shift_factor", "log_shift_factor", "vertical_factor", "log_vertical_factor"]],
    ..FileKind::new(
        "shift factors",
        &SHIFT_ROLES,
        "columns temperature [°C] and a_T, or log a_T; b_T where it has them",
    )
};

/// The table of shift factors in a file, its logarithms taken back.
fn shift_table(path: &Path) -> Result<ReadTable, Error> {
    let mut table = files::read_table(path, &FileKind { one_of: &[], ..SHIFTS }, &[])?;
    for column in &mut table.columns {
        let plain = match column.key {
            "log_shift_factor" => "shift_factor",
            "log_vertical_factor" => "vertical_factor",
            _ => continue,
        };
        column.key = plain;
        column.values.iter_mut().for_each(|value| *value = 10.0_f64.powf(*value));
    }
    Ok(table)
}

/// Temperatures in K and their factors of a kind; none where there is no column of these.
fn factors_in(table: &ReadTable, key: &str) -> Vec<(f64, f64)> {
    table.values("temperature").iter().copied().zip(table.values(key).iter().copied()).collect()
}

/// What is done about the moduli of other temperatures.
#[derive(Debug)]
pub(super) struct VerticalShift {
    kind: Vertical,
    /// The least and the largest b_T.
    range: Option<[f64; 2]>,
}

impl VerticalShift {
    /// Divides the moduli of all points by their b_T, up to what is the same for all.
    pub(super) fn apply(data: &Path, options: &FitOptions, measured: &mut MeasuredModuli) -> Result<Self, Error> {
        let factors = match options.vertical {
            Vertical::Density => Some(densities(measured, options.expansion()).map_err(Error::content(data))?),
            Vertical::None => None,
            Vertical::Divide | Vertical::Multiply => of_columns(options, measured)?,
        };
        let has_column = measured.points.iter().any(|point| point.vertical.is_some());
        if options.vertical == Vertical::None && has_column {
            measured.notes.push("the column b_T is left out".into());
        }
        if options.vertical == Vertical::Multiply && factors.is_none() {
            let expected = "a column b_T in the table, or in that of `shifts`";
            return Err(Error::content(data)(ContentError::value(None, "`vertical`", "multiply", expected)));
        }
        let Some(factors) = factors else { return Ok(Self { kind: Vertical::None, range: None }) };
        measured.points.iter_mut().zip(&factors).for_each(|(point, b)| point.sample = point.sample.scaled(1.0 / b));
        let least = factors.iter().copied().fold(f64::INFINITY, f64::min);
        let most = factors.iter().copied().fold(0.0, f64::max);
        Ok(Self { kind: options.vertical, range: Some([least, most]) })
    }

    /// Makes b_T 1 at the reference temperature (K) where the factors are not relative to one already, and says what was
    /// done.
    pub(super) fn finish(&mut self, options: &FitOptions, measured: &mut MeasuredModuli, reference: Option<f64>) {
        if self.kind == Vertical::Density {
            let at_reference = density(reference.unwrap_or(ROOM), options.expansion());
            measured.points.iter_mut().for_each(|point| point.sample = point.sample.scaled(at_reference));
            self.range = self.range.map(|range| range.map(|b| b / at_reference));
        }
        let Some([least, most]) = self.range else { return };
        let how = match self.kind {
            Vertical::Multiply => "multiplied by the column's b_T, that is divided by",
            Vertical::Density => "divided by b_T = ρT/(ρ0 T0),",
            Vertical::Divide | Vertical::None => "divided by the column's b_T (`vertical` multiply: multiplied),",
        };
        let [least, most] = [least, most].map(|b| plain(rounded(b, 4)));
        measured.notes.push(format!("moduli of other temperatures are {how} {least} to {most}"));
    }

    /// A scene shifts times alone.
    pub(super) fn warning(&self) -> Option<String> {
        /// Of the moduli.
        const NEGLIGIBLE: f64 = 0.01;
        let [least, most] = self.range?;
        let largest = (1.0 - least).max(most - 1.0);
        let text = format!(
            "a scene shifts relaxation times with temperature, not moduli: at the temperatures measured it is up to {} off \
             for want of b_T",
            percent(largest, 2)
        );
        (largest > NEGLIGIBLE).then_some(text)
    }
}

/// ρT/(ρ_room T_room): of a volume that grows by `expansion` (1/K).
fn density(temperature: f64, expansion: f64) -> f64 {
    temperature / ROOM / (1.0 + expansion * (temperature - ROOM))
}

fn densities(measured: &MeasuredModuli, expansion: f64) -> Result<Vec<f64>, ContentError> {
    let of_point = |temperature: Option<f64>| Some(density(temperature?, expansion)).filter(|b| *b > 0.0);
    let factors = measured.points.iter().map(|point| of_point(point.temperature));
    let factors: Option<Vec<f64>> = factors.collect();
    let expected = "a temperature of each row, and frequencies that are not reduced";
    factors.filter(|_| !measured.reduced).ok_or_else(|| ContentError::value(None, "`vertical`", "density", expected))
}

/// The b_T of all points, by which moduli are divided: of their own rows, or of the table of shift factors.
fn of_columns(options: &FitOptions, measured: &MeasuredModuli) -> Result<Option<Vec<f64>>, Error> {
    let own: Option<Vec<f64>> = measured.points.iter().map(|point| point.vertical).collect();
    let found = match (own, &options.shifts) {
        (Some(own), _) => Some(own),
        (None, Some(path)) => {
            let table = factors_in(&shift_table(path)?, "vertical_factor");
            let of_point = |point: &MeasuredPoint| Some(nearest(&table, point.temperature.unwrap_or(0.0))?.1);
            measured.points.iter().map(of_point).collect()
        }
        (None, None) => None,
    };
    let multiplies = options.vertical == Vertical::Multiply;
    Ok(found.map(|found| found.into_iter().map(|b| if multiplies { 1.0 / b } else { b }).collect()))
}
