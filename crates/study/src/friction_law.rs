//! Friction laws of other programs fitted to friction in steady motion: the five numbers of a cylinder's friction, and those
//! of LuGre that steady motion has.
//!
//! Both are F = F_C (1 + (K - 1) exp(-(v/v_s)^δ)) + f v with F_C = F_0 + f_C p over a speed v and a pressure p: of a cylinder
//! (Simscape, Cylinder Friction: preload force F_0, Coulomb friction coefficient f_C, breakaway friction increase K,
//! transition coefficient 1/v_s, viscous friction coefficient f) with δ = 1, of LuGre (C. Canudas de Wit et al., IEEE Trans.
//! Autom. Control 40, 1995, 419) with δ = 2, F_s = K F_C and σ_2 = f.

use std::path::Path;

use asperity::element::SWEEP;
use asperity::table::{Cell, Column, Header, Table, TableError};

use crate::decimals::{short, temperature_as_given};
use crate::error::Error;
use crate::files;
use crate::least_squares::{LeastSquares, Parameter};
use crate::stribeck::STRIBECK;

/// What the header of a table of numbers begins with.
const LAW: (&str, u64) = ("asperity friction law", 1);

/// A friction law.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FrictionLaw {
    /// Of a cylinder: δ = 1.
    Stribeck,
    /// δ = 2.
    LuGre,
}

/// Friction in steady motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SteadyFriction {
    /// K; `None` where the table has none.
    pub temperature: Option<f64>,
    /// Sealed pressure, or pressure on the nominal area, Pa.
    pub pressure: f64,
    /// m/s.
    pub speed: f64,
    /// Its size: N, or Pa of the nominal area.
    pub friction: f64,
}

/// A table of friction in steady motion.
#[derive(Clone, Debug)]
pub struct FrictionTable {
    file: String,
    /// The unit of friction: N of a lip's table, Pa of a sweep's.
    pub unit: &'static str,
    /// Its rows with friction.
    pub rows: Vec<SteadyFriction>,
    /// How many rows have none, or none that is steady.
    pub left_out: usize,
}

impl FrictionTable {
    /// Reads a table of `asperity sweep`, also of a lip (`sweep --seal`).
    ///
    /// # Errors
    /// Where it cannot be read, or is another table.
    pub fn read(path: &Path) -> Result<Self, Error> {
        let table = Table::parse(&files::text(path)?, path)?;
        let is_lip = table.header.check_kind(STRIBECK).is_ok();
        if !is_lip && table.header.check_kind(SWEEP).is_err() {
            return Err(table
                .error("expected a table of `asperity sweep`, or of a lip by `asperity sweep --seal`")
                .into());
        }
        let (pressure, unit) = if is_lip { ("sealed_pressure", "N") } else { ("pressure", "Pa") };
        let row = |row: usize| -> Result<Option<SteadyFriction>, TableError> {
            let temperature =
                table.has("temperature", "K").then(|| table.number(row, "temperature", "K")).transpose()?;
            let speed = table.number(row, "speed", "m/s")?;
            let pressure = table.number(row, pressure, "Pa")?;
            let friction = match is_lip {
                true if table.word(row, "status", "")? != "steady" => None,
                true => table.number(row, "F_x", "N")?,
                false => {
                    table.number(row, "friction", "1")?.zip(pressure).map(|(friction, pressure)| friction * pressure)
                }
            };
            let found = speed.zip(pressure).zip(friction);
            Ok(found.map(|((speed, pressure), friction)| SteadyFriction {
                temperature: temperature.flatten(),
                pressure,
                speed,
                friction: friction.abs(),
            }))
        };
        let rows = (0..table.len()).filter_map(|at| row(at).transpose()).collect::<Result<Vec<_>, _>>()?;
        Ok(Self { file: files::name_of(path), unit, left_out: table.len() - rows.len(), rows })
    }

    /// The law fitted at each temperature of the table.
    ///
    /// # Errors
    /// Where a temperature has too few rows, or none of them friction.
    pub fn fit(&self, law: FrictionLaw) -> Result<Vec<FittedFriction>, Error> {
        let mut temperatures: Vec<Option<f64>> = self.rows.iter().map(|row| row.temperature).collect();
        temperatures.sort_by(|a, b| a.unwrap_or(0.0).total_cmp(&b.unwrap_or(0.0)));
        temperatures.dedup();
        let at = |temperature: Option<f64>| {
            let rows = self.rows.iter().filter(|row| row.temperature == temperature).copied().collect();
            FittedFriction::new(law, self.unit, rows)
                .map_err(|error| {
                    temperature.map_or(error.clone(), |kelvin| error.context(temperature_as_given(kelvin)))
                })
                .map_err(|error| error.context(&self.file))
        };
        temperatures.into_iter().map(at).collect()
    }
}

/// A number of a law.
#[derive(Clone, Debug, PartialEq)]
pub struct FittedNumber {
    /// Its name in tables.
    pub name: &'static str,
    /// Its unit.
    pub unit: String,
    /// Its value, and its standard error; why the table does not determine it.
    pub value: Result<(f64, f64), &'static str>,
}

/// A law fitted at a temperature.
#[derive(Clone, Debug)]
pub struct FittedFriction {
    /// The law.
    pub law: FrictionLaw,
    /// What it is fitted to, of one temperature.
    pub rows: Vec<SteadyFriction>,
    /// Its numbers, also those that are not determined.
    pub numbers: Vec<FittedNumber>,
    /// Root mean square of what it misses, in the unit of friction.
    pub misfit: f64,
    /// The largest friction of the rows.
    pub largest: f64,
}

/// The parameters of the formula, each over the largest of its kind in the table: preload, coefficient of the pressure, K - 1,
/// logarithm of 1/v_s, viscosity.
const PRELOAD: usize = 0;
const COULOMB: usize = 1;
const INCREASE: usize = 2;
const TRANSITION: usize = 3;
const VISCOUS: usize = 4;

/// Beyond any friction in these units.
const LARGEST: f64 = 1e6;
/// A number is told from 0 where it is so many standard errors away from it.
const TOLD: f64 = 2.0;
/// Less than this part of the largest friction is none.
const NOTHING: f64 = 1e-9;
/// Starts of 1/v_s to a decade of speeds.
const STARTS: f64 = 2.0;

const ONE_PRESSURE: &str = "the table has one pressure, which does not tell preload from what rises with the pressure";
const NOT_TOLD: &str = "not told from 0 by the table";
const NO_FALL: &str = "friction does not fall over the table's speeds as it does after a breakaway";
const NOT_STEADY: &str = "nothing of it is in steady motion; of a test of the way before sliding, or of its damping";

/// The table's rows, each quantity over its largest.
struct Scaled {
    law: FrictionLaw,
    /// Pressure, speed, friction.
    rows: Vec<[f64; 3]>,
    largest: [f64; 3],
    slowest: f64,
}

impl Scaled {
    fn new(law: FrictionLaw, rows: &[SteadyFriction]) -> Result<Self, Error> {
        let rows: Vec<[f64; 3]> = rows.iter().map(|row| [row.pressure, row.speed, row.friction]).collect();
        let largest = [0, 1, 2].map(|of| rows.iter().map(|row| row[of]).fold(0.0, f64::max));
        if !(largest[1] > 0.0 && largest[2] > 0.0) {
            return Err(Error::value("expected friction at speeds above 0, found none"));
        }
        // Without pressure there is preload alone.
        let largest = [if largest[0] > 0.0 { largest[0] } else { 1.0 }, largest[1], largest[2]];
        let over = |row: [f64; 3]| [row[0] / largest[0], row[1] / largest[1], row[2] / largest[2]];
        let rows: Vec<[f64; 3]> = rows.into_iter().map(over).collect();
        let slowest = rows.iter().map(|row| row[1]).filter(|speed| *speed > 0.0).fold(1.0, f64::min);
        Ok(Self { law, rows, largest, slowest })
    }

    fn friction(&self, values: &[f64], pressure: f64, speed: f64) -> f64 {
        let coulomb = values[PRELOAD] + values[COULOMB] * pressure;
        let part = values[TRANSITION].exp() * speed;
        let part = if self.law == FrictionLaw::LuGre { part * part } else { part };
        coulomb * (1.0 + values[INCREASE] * (-part).exp()) + values[VISCOUS] * speed
    }

    /// The least squares with only these numbers other than 0, the best of starts over the speeds.
    fn fit(&self, has: &[bool; 5]) -> Result<LeastSquares, Error> {
        let residuals = |values: &[f64]| {
            self.rows.iter().map(|row| self.friction(values, row[0], row[1]) - row[2]).collect::<Vec<f64>>()
        };
        let decades = -self.slowest.log10();
        let count = if has[TRANSITION] { (STARTS * decades).ceil() as usize + 1 } else { 1 };
        let fit = |start: usize| {
            let transition = start as f64 / STARTS * std::f64::consts::LN_10;
            let starts = [0.5, 0.5, 0.5, transition, 0.1];
            let parameter = |of: usize| Parameter {
                start: if has[of] { starts[of] } else { 0.0 },
                // Slower than that, and faster, a law with another number would be as good.
                bounds: if of == TRANSITION { (-1.0, 1.0 - self.slowest.ln()) } else { (0.0, LARGEST) },
                is_fixed: !has[of],
            };
            LeastSquares::new(&[0, 1, 2, 3, 4].map(parameter), self.rows.len(), residuals)
        };
        let fits = (0..count).map(fit).collect::<Result<Vec<_>, _>>()?;
        let best = fits.into_iter().min_by(|a, b| a.chi_square().total_cmp(&b.chi_square()));
        best.ok_or_else(|| Error::value("no fit"))
    }

    /// Whether a number is told from 0.
    fn is_told(fit: &LeastSquares, of: usize) -> bool {
        let value = fit.values[of];
        value > NOTHING && fit.errors[of].is_some_and(|error| TOLD * error < value)
    }
}

impl FittedFriction {
    fn new(law: FrictionLaw, unit: &str, rows: Vec<SteadyFriction>) -> Result<Self, Error> {
        let scaled = Scaled::new(law, &rows)?;
        let one_pressure = rows.iter().all(|row| row.pressure == rows[0].pressure);
        // With one pressure its whole Coulomb friction is at the place of the preload.
        let mut has = [true, !one_pressure, true, true, true];
        let mut fit = scaled.fit(&has)?;
        let falls = |fit: &LeastSquares| {
            let transition = fit.errors[TRANSITION].is_some_and(|error| TOLD * error < 1.0);
            transition && Scaled::is_told(fit, INCREASE)
        };
        if !falls(&fit) {
            (has[INCREASE], has[TRANSITION]) = (false, false);
            fit = scaled.fit(&has)?;
        }
        for of in [VISCOUS, PRELOAD, COULOMB] {
            if has[of] && !Scaled::is_told(&fit, of) {
                has[of] = false;
                fit = scaled.fit(&has)?;
            }
        }
        let misfit = (fit.chi_square() / rows.len() as f64).sqrt() * scaled.largest[2];
        let numbers = numbers(&scaled, &fit, has, unit, one_pressure);
        Ok(Self { law, numbers, misfit, largest: scaled.largest[2], rows })
    }

    /// A row for each number.
    pub fn table(fits: &[Self], file: &Path) -> Table {
        let columns = [
            Column::numbers("temperature", "K"),
            Column::words("number", ""),
            Column::numbers("value", ""),
            Column::numbers("standard_error", ""),
            Column::words("unit", ""),
            Column::words("why_not", ""),
        ];
        let mut table = Table::new(Header::new(LAW).with("of", &files::name_of(file)), columns);
        for (fit, number) in fits.iter().flat_map(|fit| fit.numbers.iter().map(move |number| (fit, number))) {
            let temperature = fit.rows.first().and_then(|row| row.temperature);
            let [value, error] = [number.value.ok().map(|of| of.0), number.value.ok().map(|of| of.1)];
            let why_not = number.value.err().unwrap_or_default();
            let words = [number.name, &number.unit, why_not].map(Cell::from);
            let [name, unit, why_not] = words;
            table.push([temperature.into(), name, value.into(), error.into(), unit, why_not]);
        }
        table
    }

    /// The numbers in lines, each with its error or why there is none.
    pub fn lines(&self) -> Vec<String> {
        let line = |number: &FittedNumber| match number.value {
            Ok((value, error)) => {
                format!("{:<24}{} ± {} {}", number.name, short(value, 5), short(error, 2), number.unit)
            }
            Err(why) => format!("{:<24}not given: {why}", number.name),
        };
        self.numbers.iter().map(line).collect()
    }
}

/// The numbers of a law in SI units, the breakaway at the largest pressure.
fn numbers(scaled: &Scaled, fit: &LeastSquares, has: [bool; 5], unit: &str, one_pressure: bool) -> Vec<FittedNumber> {
    let [most_pressure, most_speed, most_friction] = scaled.largest;
    let (preload, rise, increase) = (fit.values[PRELOAD], fit.values[COULOMB], fit.values[INCREASE]);
    // At the largest pressure.
    let gradient = [1.0 + increase, 1.0 + increase, preload + rise, 0.0, 0.0];
    let breakaway = ((preload + rise) * (1.0 + increase) * most_friction, fit.error_of(&gradient) * most_friction);
    let breakaway = if has[INCREASE] { Ok(breakaway) } else { Err(NO_FALL) };
    let value = |of: usize, scale: f64, why: &'static str| match has[of] {
        true => Ok((fit.values[of] * scale, fit.errors[of].unwrap_or(0.0) * scale)),
        false => Err(why),
    };
    let number = |name, unit: String, value| FittedNumber { name, unit, value };
    let increase = value(INCREASE, 1.0, NO_FALL).map(|(value, error)| (1.0 + value, error));
    let rate =
        value(TRANSITION, 1.0, NO_FALL).map(|(ln, error)| (ln.exp() / most_speed, error * ln.exp() / most_speed));
    let per_pascal = if unit == "N" { "N/Pa" } else { "" };
    let coulomb = value(PRELOAD, most_friction, NOT_TOLD);
    let mut found = match one_pressure {
        true => vec![
            number("coulomb_friction", unit.into(), coulomb),
            number("preload", unit.into(), Err(ONE_PRESSURE)),
            number("coulomb_coefficient", per_pascal.into(), Err(ONE_PRESSURE)),
        ],
        false => vec![
            number("preload", unit.into(), coulomb),
            number("coulomb_coefficient", per_pascal.into(), value(COULOMB, most_friction / most_pressure, NOT_TOLD)),
        ],
    };
    found.push(number("breakaway_increase", String::new(), increase));
    found.push(number("breakaway_friction", unit.into(), breakaway));
    let speed = |(rate, error): (f64, f64)| (1.0 / rate, error / (rate * rate));
    found.push(match scaled.law {
        FrictionLaw::Stribeck => number("transition_coefficient", "s/m".into(), rate),
        FrictionLaw::LuGre => number("stribeck_speed", "m/s".into(), rate.map(speed)),
    });
    let viscous = value(VISCOUS, most_friction / most_speed, NOT_TOLD);
    let viscous_name = if scaled.law == FrictionLaw::LuGre { "sigma_2" } else { "viscous_coefficient" };
    found.push(number(viscous_name, format!("{unit} s/m"), viscous));
    if scaled.law == FrictionLaw::LuGre {
        found.push(number("sigma_0", format!("{unit}/m"), Err(NOT_STEADY)));
        found.push(number("sigma_1", format!("{unit} s/m"), Err(NOT_STEADY)));
    }
    found
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests may fail")]
mod tests {
    use super::*;

    /// Preload (N), coefficient (N/Pa), K, 1/v_s (s/m), viscosity (N s/m).
    const NUMBERS: [f64; 5] = [30.0, 2e-5, 1.4, 25.0, 60.0];

    fn rows(
        pressures: &[f64],
        power: i32,
        [preload, coulomb, increase, rate, viscous]: [f64; 5],
    ) -> Vec<SteadyFriction> {
        let speeds: Vec<f64> = (0..13).map(|i| 1e-4 * 10.0_f64.powf(f64::from(i) / 3.0)).collect();
        let at = |(pressure, speed): (f64, f64)| {
            let part = (-(rate * speed).powi(power)).exp();
            let friction = (preload + coulomb * pressure) * (1.0 + (increase - 1.0) * part) + viscous * speed;
            SteadyFriction { temperature: None, pressure, speed, friction }
        };
        pressures.iter().flat_map(|&pressure| speeds.iter().map(move |&speed| (pressure, speed))).map(at).collect()
    }

    fn fitted(law: FrictionLaw, rows: Vec<SteadyFriction>) -> FittedFriction {
        let table = FrictionTable { file: "t.csv".into(), unit: "N", rows, left_out: 0 };
        table.fit(law).unwrap().remove(0)
    }

    fn value(fit: &FittedFriction, name: &str) -> Result<f64, &'static str> {
        fit.numbers.iter().find(|number| number.name == name).unwrap().value.map(|found| found.0)
    }

    #[track_caller]
    fn assert_values(fit: &FittedFriction, expected: &[(&str, f64)]) {
        for &(name, expected) in expected {
            let found = value(fit, name).unwrap();
            // Data of the formula itself: what the fit's tolerance leaves.
            assert!((found / expected - 1.0).abs() < 1e-6, "{name}: {found}, expected {expected}");
        }
    }

    #[test]
    fn data_of_the_formula_return_its_numbers() {
        let pressures = [0.0, 5e6, 10e6];
        let cylinder = fitted(FrictionLaw::Stribeck, rows(&pressures, 1, NUMBERS));
        assert_values(
            &cylinder,
            &[
                ("preload", 30.0),
                ("coulomb_coefficient", 2e-5),
                ("breakaway_increase", 1.4),
                ("breakaway_friction", 1.4 * 230.0),
                ("transition_coefficient", 25.0),
                ("viscous_coefficient", 60.0),
            ],
        );
        assert!(cylinder.misfit < 1e-6 * cylinder.largest, "{}", cylinder.misfit);
        let lugre = fitted(FrictionLaw::LuGre, rows(&pressures[1..2], 2, NUMBERS));
        assert_values(
            &lugre,
            &[("coulomb_friction", 130.0), ("breakaway_friction", 182.0), ("stribeck_speed", 0.04), ("sigma_2", 60.0)],
        );
        assert_eq!(["sigma_0", "sigma_1"].map(|name| value(&lugre, name)), [Err(NOT_STEADY); 2]);
        assert_eq!(value(&lugre, "preload"), Err(ONE_PRESSURE));
        // The other law misses these data by more than the fit does.
        assert!(fitted(FrictionLaw::Stribeck, lugre.rows.clone()).misfit > 1.0);
    }

    /// Deviations of a hundredth, the same each time.
    #[test]
    fn standard_errors_are_those_of_repeated_data() {
        let mut random = asperity::math::SplitMix64::new(7);
        let mut found = Vec::new();
        for _ in 0..40 {
            let mut rows = rows(&[0.0, 5e6, 10e6], 1, NUMBERS);
            rows.iter_mut().for_each(|row| row.friction += 4.0 * (random.unit() - 0.5));
            let fit = fitted(FrictionLaw::Stribeck, rows);
            found.push(fit.numbers.iter().find(|of| of.name == "breakaway_friction").unwrap().value.unwrap());
        }
        let mean = found.iter().map(|one| one.0).sum::<f64>() / 40.0;
        let scatter = (found.iter().map(|one| (one.0 - mean).powi(2)).sum::<f64>() / 39.0).sqrt();
        let said = found.iter().map(|one| one.1).sum::<f64>() / 40.0;
        // A standard deviation of 40 numbers is known to 11 %, thrice that is rare.
        assert!((said / scatter - 1.0).abs() < 0.33 && (mean - 322.0).abs() < 3.0 * scatter, "{said} {scatter} {mean}");
    }

    #[test]
    fn what_the_table_does_not_determine_is_not_given() {
        // Coulomb's friction alone, that of the pressure.
        let alone = fitted(FrictionLaw::Stribeck, rows(&[1e6, 2e6], 1, [0.0, 2e-5, 1.0, 25.0, 0.0]));
        assert_values(&alone, &[("coulomb_coefficient", 2e-5)]);
        let others =
            ["preload", "breakaway_increase", "breakaway_friction", "transition_coefficient", "viscous_coefficient"];
        assert_eq!(
            others.map(|name| value(&alone, name)),
            [Err(NOT_TOLD), Err(NO_FALL), Err(NO_FALL), Err(NO_FALL), Err(NOT_TOLD)]
        );
        // A fall before the slowest of the speeds.
        let early = fitted(FrictionLaw::Stribeck, rows(&[1e6, 2e6], 1, [30.0, 2e-5, 1.4, 1e6, 60.0]));
        assert_values(&early, &[("preload", 30.0), ("viscous_coefficient", 60.0)]);
        assert_eq!(value(&early, "breakaway_friction"), Err(NO_FALL));
        let table = FrictionTable { file: "t.csv".into(), unit: "N", rows: early.rows[..3].to_vec(), left_out: 0 };
        let told = table.fit(FrictionLaw::LuGre).unwrap_err().to_string();
        assert_eq!(told, "t.csv: expected 4 rows or more for as many numbers, found 3");
    }
}
