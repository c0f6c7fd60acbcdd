//! The Magic Formula of Pacejka fitted to slip curves, for pure slip.
//!
//! F = D sin(C atan(Bx - E(Bx - atan Bx))) with x = κ or α (H. B. Pacejka, *Tire and Vehicle Dynamics*, 3rd ed. 2012,
//! (4.E9), (4.E19)). Over all loads, with df = F_z/FNOMIN - 1, the coefficients of MF 5.2, which MF 6.1 shares at the
//! pressure of the test:
//!
//! - C = PCX1, D = F_z (PDX1 + PDX2 df), BCD = F_z (PKX1 + PKX2 df) exp(PKX3 df), E = PEX1 (4.E11 to 4.E15);
//! - C = PCY1, D = F_z (PDY1 + PDY2 df), BCD = PKY1 FNOMIN sin(2 atan(F_z/(PKY2 FNOMIN))), E = PEY1 (4.E21 to 4.E25).
//!
//! There are no shifts: free rolling is where F_x is 0, and a tread has no side. Each load counts as much as each other.

use asperity::table::{Cell, Column, Header, Table};
use asperity::tables::POSITIVE;

use super::slip::{SlipConditions, SlipCurves};
use crate::decimals::{percent, temperature_as_given};
use crate::error::Error;
use crate::least_squares::{Determined, Parameter, least_squares};
use crate::values::Values;

/// What the header of the table begins with.
const MAGIC: (&str, u64) = ("asperity magic formula", 1);
/// Fewest points of a curve: one more than B, C, D and E.
const FEWEST: usize = 5;

/// The direction of a force, and of its slip.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// F_x over κ.
    Along,
    /// F_y over α, rad.
    Across,
}

/// A number that is fitted, by its name, and what the data say of it.
pub type Coefficient = (&'static str, Determined);

/// A formula that was fitted to curves in one direction.
#[derive(Clone, Debug)]
pub struct MagicFit {
    /// Which.
    pub direction: Direction,
    /// What it holds at: of one curve its load too, of coefficients over loads that is FNOMIN.
    pub at: SlipConditions,
    /// Whether it is of one curve: B, C, D, E.
    pub is_curve: bool,
    /// Its numbers.
    pub coefficients: Vec<Coefficient>,
    /// All of them, determined or not: together they are the formula that is nearest to the data.
    values: Vec<f64>,
    /// The root mean square of what it is off by, over the load.
    pub rms: f64,
}

/// All fits to slip curves.
#[derive(Clone, Debug)]
pub struct MagicFormula {
    name: String,
    /// B, C, D, E of each curve, and behind those of a direction, a speed and a temperature the coefficients over loads.
    pub fits: Vec<MagicFit>,
}

/// A label and what stands behind it.
type LabelledLine = (&'static str, String);
/// A point of a curve: load (N), slip (1 or rad), force (N).
type Row = (f64, f64, f64);

/// F = D sin(C atan(Bx - E(Bx - atan Bx))).
pub fn magic([b, c, d, e]: [f64; 4], x: f64) -> f64 {
    let bx = b * x;
    d * (c * (bx - e * (bx - bx.atan())).atan()).sin()
}

impl Direction {
    fn word(self) -> &'static str {
        match self {
            Self::Along => "F_x",
            Self::Across => "F_y",
        }
    }

    /// B, C, D, E at a load (N) by the coefficients.
    fn at_load(self, coefficients: &[f64], nominal: f64, load: f64) -> [f64; 4] {
        let df = load / nominal - 1.0;
        let (c, d, stiffness, e) = match (self, coefficients) {
            (Self::Along, &[c, d1, d2, k1, k2, k3, e]) => {
                (c, load * (d1 + d2 * df), load * (k1 + k2 * df) * (k3 * df).exp(), e)
            }
            (Self::Across, &[c, d1, d2, k1, k2, e]) => {
                (c, load * (d1 + d2 * df), k1 * nominal * (2.0 * (load / (k2 * nominal)).atan()).sin(), e)
            }
            _ => return [f64::NAN; 4],
        };
        [stiffness / (c * d), c, d, e]
    }

    /// The coefficients, by the scales of friction and of stiffness over the load.
    fn parameters(self, friction: f64, stiffness: f64) -> Vec<Parameter> {
        let number = |name, bounds, scale, neutral| Parameter { name, bounds, scale, neutral };
        let of_stiffness = if stiffness < 0.0 { (-1e3, 0.0) } else { (0.0, 1e3) };
        let size = stiffness.abs();
        match self {
            Self::Along => vec![
                number("PCX1", SHAPES, 1.0, None),
                number("PDX1", (0.0, 10.0), friction, None),
                number("PDX2", (-10.0, 10.0), friction, Some(0.0)),
                number("PKX1", of_stiffness, size, None),
                number("PKX2", (-1e3, 1e3), size, Some(0.0)),
                number("PKX3", (-10.0, 10.0), 1.0, Some(0.0)),
                number("PEX1", CURVATURES, 1.0, Some(0.0)),
            ],
            Self::Across => vec![
                number("PCY1", SHAPES, 1.0, None),
                number("PDY1", (0.0, 10.0), friction, None),
                number("PDY2", (-10.0, 10.0), friction, Some(0.0)),
                number("PKY1", of_stiffness, size, None),
                number("PKY2", (0.1, 100.0), 1.0, None),
                number("PEY1", CURVATURES, 1.0, Some(0.0)),
            ],
        }
    }
}

/// What C and E may be.
const SHAPES: (f64, f64) = (0.1, 3.0);
const CURVATURES: (f64, f64) = (-50.0, 1.0);
/// Starts of C and E.
const STARTS: [(f64, f64); 4] = [(1.2, 0.0), (1.6, 0.0), (1.9, 0.9), (1.3, -3.0)];

impl MagicFit {
    /// The force (N) at a load (N) and a slip (1 or rad).
    pub fn force(&self, load: f64, slip: f64) -> f64 {
        match (self.is_curve, self.values.as_slice()) {
            (true, &[b, c, d, e]) => magic([b, c, d, e], slip),
            (_, coefficients) => magic(self.direction.at_load(coefficients, self.at.load, load), slip),
        }
    }

    /// B, C, D, E of a curve.
    fn of_curve(direction: Direction, at: SlipConditions, rows: &[Row]) -> Result<Self, Error> {
        let (friction, stiffness) = sizes(rows);
        let (d, k) = (friction * at.load, stiffness * at.load);
        let number = |name, bounds, scale, neutral| Parameter { name, bounds, scale, neutral };
        let (b, most) = (k / d, 100.0 * (k / d).abs());
        let parameters = [
            number("B", if b < 0.0 { (-most, 0.0) } else { (0.0, most) }, b.abs(), None),
            number("C", SHAPES, 1.0, None),
            number("D", (0.0, 10.0 * d), d, None),
            number("E", CURVATURES, 1.0, Some(0.0)),
        ];
        let starts = STARTS.map(|(c, e)| vec![b / c, c, d, e]);
        let residual = |values: &[f64]| match *values {
            [b, c, d, e] => rows.iter().map(|&(load, x, force)| (magic([b, c, d, e], x) - force) / load).collect(),
            _ => Vec::new(),
        };
        Self::fitted((direction, at, true), &parameters, &starts, &residual, rows.len())
    }

    /// The coefficients over loads.
    fn of_loads(direction: Direction, at: SlipConditions, rows: &[Row]) -> Result<Self, Error> {
        let (friction, stiffness) = sizes(rows);
        let parameters = direction.parameters(friction, stiffness);
        let start = |(c, e): (f64, f64)| match direction {
            Direction::Along => vec![c, friction, 0.0, stiffness, 0.0, 0.0, e],
            // sin(2 atan(1/2)) is 0.8.
            Direction::Across => vec![c, friction, 0.0, stiffness / 0.8, 2.0, e],
        };
        let residual = |values: &[f64]| {
            let off = |&(load, x, force): &Row| (magic(direction.at_load(values, at.load, load), x) - force) / load;
            rows.iter().map(off).collect()
        };
        Self::fitted((direction, at, false), &parameters, &STARTS.map(start), &residual, rows.len())
    }

    fn fitted(
        (direction, at, is_curve): (Direction, SlipConditions, bool),
        parameters: &[Parameter],
        starts: &[Vec<f64>],
        residuals: &dyn Fn(&[f64]) -> Vec<f64>,
        count: usize,
    ) -> Result<Self, Error> {
        let found = least_squares(parameters, starts, residuals)?;
        let rms = found.rms(count);
        let coefficients = parameters.iter().map(|parameter| parameter.name).zip(found.determined).collect();
        Ok(Self { direction, at, is_curve, coefficients, values: found.values, rms })
    }
}

/// The largest friction, and the slope at no slip over the load.
fn sizes(rows: &[Row]) -> (f64, f64) {
    let friction = rows.iter().map(|(load, _, force)| (force / load).abs()).fold(0.0, f64::max);
    let least = rows.iter().map(|row| row.1.abs()).filter(|slip| *slip > 0.0).fold(f64::INFINITY, f64::min);
    let near = rows.iter().filter(|row| row.1.abs() <= 2.0 * least);
    let (products, squares) = near.fold((0.0, 0.0), |(products, squares), (load, slip, force)| {
        (products + slip * force / load, squares + slip * slip)
    });
    (friction.max(f64::MIN_POSITIVE), products / squares)
}

impl MagicFormula {
    /// Fits the formula to the curves straight ahead and in free rolling; FNOMIN is `nominal` (N), or the middle load.
    ///
    /// # Errors
    /// Where there is no curve of five points.
    pub fn new(curves: &SlipCurves, nominal: Option<f64>) -> Result<Self, Error> {
        let mut fits = Vec::new();
        let loads = Values::from(curves.points.iter().map(|point| point.at.load).collect::<Vec<_>>()).0;
        let load = nominal.or_else(|| loads.get(loads.len().saturating_sub(1) / 2).copied()).unwrap_or(f64::NAN);
        if !POSITIVE.holds(load) {
            return Err(Error::value(format!("`nominal`: expected {POSITIVE}, in N, found {load:?}")));
        }
        for direction in [Direction::Along, Direction::Across] {
            for group in groups(curves, direction) {
                let Some((at, _)) = group.first() else { continue };
                for (at, rows) in &group {
                    fits.push(MagicFit::of_curve(direction, *at, rows)?);
                }
                let rows: Vec<Row> = group.iter().flat_map(|(_, rows)| rows).copied().collect();
                fits.push(MagicFit::of_loads(direction, SlipConditions { load, ..*at }, &rows)?);
            }
        }
        if fits.is_empty() {
            let expected = format!("{FEWEST} points or more straight ahead, or in free rolling over slip angles");
            return Err(Error::value(format!("the Magic Formula is not fitted: expected a curve of {expected}")));
        }
        Ok(Self { name: curves.name.clone(), fits })
    }

    /// The coefficients over loads of a direction at a speed and a temperature.
    pub fn over_loads(&self, direction: Direction, at: SlipConditions) -> Option<&MagicFit> {
        let is_of = |fit: &&MagicFit| {
            !fit.is_curve
                && fit.direction == direction
                && (fit.at.temperature, fit.at.speed) == (at.temperature, at.speed)
        };
        self.fits.iter().find(is_of)
    }

    /// What the fits are, in lines with labels.
    pub fn lines(&self) -> Vec<LabelledLine> {
        let several = |of: fn(&MagicFit) -> Option<f64>| self.fits.iter().any(|fit| of(fit) != of(&self.fits[0]));
        let (speeds, temperatures) = (several(|fit| Some(fit.at.speed)), several(|fit| fit.at.temperature));
        let line = |fit: &MagicFit| {
            let SlipConditions { temperature, speed, load } = fit.at;
            let mut parts = vec![format!("{}{load} N", if fit.is_curve { "" } else { "FNOMIN " })];
            parts.extend(speeds.then(|| format!("{speed} m/s")));
            parts.extend(temperature.filter(|_| temperatures).map(temperature_as_given));
            let numbers = fit.coefficients.iter().map(|&(name, determined)| format!("{name} {determined}"));
            let off = format!("off by {} of the load", percent(fit.rms, 2));
            (fit.direction.word(), format!("{}: {}; {off}", parts.join(", "), numbers.collect::<Vec<_>>().join(", ")))
        };
        self.fits.iter().map(line).collect()
    }

    /// A row for each number; one that the data do not determine has none, and a status that says so.
    pub fn table(&self) -> Table {
        let numbers = |of: [(&'static str, &'static str); 3]| of.map(|(name, unit)| Column::numbers(name, unit));
        let columns = numbers([("temperature", "K"), ("speed", "m/s"), ("load", "N")]).into_iter();
        let columns = columns.chain(["force", "coefficient"].map(|name| Column::words(name, "")));
        let columns =
            columns.chain(numbers([("value", ""), ("error", ""), ("rms", "")])).chain([Column::words("status", "")]);
        let header = Header::new(MAGIC).with("patch", &self.name);
        let mut table =
            Table::new(header.with("units", "SI: slip 1, slip angle rad, force N; rms over the load"), columns);
        for fit in &self.fits {
            for &(name, determined) in &fit.coefficients {
                let (value, error) = determined.numbers();
                table.push([
                    fit.at.temperature.into(),
                    fit.at.speed.into(),
                    fit.at.load.into(),
                    Cell::from(fit.direction.word()),
                    name.into(),
                    value.into(),
                    error.into(),
                    fit.rms.into(),
                    determined.words().into(),
                ]);
            }
        }
        table
    }
}

/// Curves of one direction by speeds and temperatures, each by its loads.
fn groups(curves: &SlipCurves, direction: Direction) -> Vec<Vec<(SlipConditions, Vec<Row>)>> {
    let mut groups: Vec<Vec<(SlipConditions, Vec<Row>)>> = Vec::new();
    for (point, rolling) in curves.steady() {
        let (x, other, force) = match direction {
            Direction::Along => (point.slip, point.angle, rolling.force[0]),
            Direction::Across => (point.angle, point.slip, rolling.force[1]),
        };
        if other != 0.0 {
            continue;
        }
        let row = (point.at.load, x, force);
        let is_of = |at: &SlipConditions| (at.temperature, at.speed) == (point.at.temperature, point.at.speed);
        match groups.iter_mut().find(|group| group.first().is_some_and(|(at, _)| is_of(at))) {
            None => groups.push(vec![(point.at, vec![row])]),
            Some(group) => match group.iter_mut().find(|(at, _)| *at == point.at) {
                None => group.push((point.at, vec![row])),
                Some((_, rows)) => rows.push(row),
            },
        }
    }
    groups.iter_mut().for_each(|group| group.retain(|(_, rows)| rows.len() >= FEWEST));
    groups
}
