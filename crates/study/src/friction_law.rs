//! Friction laws of other programs fitted to friction in steady motion: the numbers of a cylinder's friction, and those of
//! LuGre that steady motion has.
//!
//! Both are F = F_C (1 + (K - 1) exp(-(v/v_s)^δ)) + f v with F_C = F_pr + f_C p over a speed v and a pressure p: of a cylinder
//! δ = 1 (Simscape, Cylinder Friction: preload force F_pr, Coulomb friction coefficient f_C, breakaway friction increase
//! coefficient K, transition coefficient 1/v_s, viscous friction coefficient f), of LuGre δ = 2, F_s = K F_C and σ_2 = f
//! (C. Canudas de Wit et al., IEEE Trans. Autom. Control 40, 1995, 419, (4)).

use std::path::Path;

use asperity::element::SWEEP;
use asperity::table::{Cell, Column, Header, Table, TableError};

use crate::decimals::temperature_as_given;
use crate::error::Error;
use crate::files;
use crate::least_squares::{Determined, Parameter, least_squares};
use crate::stribeck::STRIBECK;

/// What the header of a table of numbers begins with.
const LAW: (&str, u64) = ("asperity friction law", 1);
/// Starts of v_s to a decade of speeds.
const STARTS: f64 = 2.0;

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
pub struct FrictionData {
    file: String,
    /// The unit of friction: N of a lip, Pa of a sweep.
    pub unit: &'static str,
    /// Its rows with friction.
    pub rows: Vec<SteadyFriction>,
    /// How many rows have none, or none that is steady.
    pub left_out: usize,
}

/// A law fitted at a temperature.
#[derive(Clone, Debug)]
pub struct FrictionFit {
    /// K; `None` where the table has none.
    pub temperature: Option<f64>,
    /// Its numbers: names, units, and what the table says of them.
    pub numbers: Vec<(&'static str, String, Determined)>,
    /// Root mean square of what it is off by, in the unit of friction.
    pub rms: f64,
    /// The largest friction, in that unit.
    pub largest: f64,
}

impl FrictionData {
    /// Reads a table of `asperity sweep`, also of a lip (`sweep --seal`).
    ///
    /// # Errors
    /// Where it cannot be read, or is another table.
    pub fn read(path: &Path) -> Result<Self, Error> {
        let table = Table::parse(&files::text(path)?, path)?;
        let is_lip = table.header.check_kind(STRIBECK).is_ok();
        if !is_lip && table.header.check_kind(SWEEP).is_err() {
            return Err(table.error("expected a table of `asperity sweep`, also of a lip (--seal)").into());
        }
        let row = |row: usize| -> Result<Option<SteadyFriction>, TableError> {
            let temperature = if table.has("temperature", "K") { table.number(row, "temperature", "K")? } else { None };
            let pressure = table.number(row, if is_lip { "sealed_pressure" } else { "pressure" }, "Pa")?;
            let friction = match is_lip {
                true if table.word(row, "status", "")? != "steady" => None,
                true => table.number(row, "F_x", "N")?,
                false => {
                    table.number(row, "friction", "1")?.zip(pressure).map(|(friction, pressure)| friction * pressure)
                }
            };
            let speed = table.number(row, "speed", "m/s")?.filter(|speed| *speed > 0.0);
            let found = speed.zip(pressure).zip(friction.map(f64::abs));
            Ok(found.map(|((speed, pressure), friction)| SteadyFriction { temperature, pressure, speed, friction }))
        };
        let rows = (0..table.len()).filter_map(|at| row(at).transpose()).collect::<Result<Vec<_>, _>>()?;
        let unit = if is_lip { "N" } else { "Pa" };
        Ok(Self { file: files::name_of(path), unit, left_out: table.len() - rows.len(), rows })
    }

    /// The law fitted at each temperature of the table.
    ///
    /// # Errors
    /// Where a temperature has fewer rows than the law has numbers, or no friction.
    pub fn fit(&self, law: FrictionLaw) -> Result<Vec<FrictionFit>, Error> {
        let mut temperatures: Vec<Option<f64>> = self.rows.iter().map(|row| row.temperature).collect();
        temperatures.sort_by(|a, b| a.partial_cmp(b).unwrap_or(std::cmp::Ordering::Equal));
        temperatures.dedup();
        let at = |temperature: Option<f64>| {
            let rows: Vec<_> = self.rows.iter().filter(|row| row.temperature == temperature).copied().collect();
            let place = temperature.map_or(String::new(), |kelvin| format!(" at {}", temperature_as_given(kelvin)));
            fit(law, self.unit, &rows).map_err(|error| error.context(format!("{}{place}", self.file)))
        };
        temperatures.into_iter().map(at).collect()
    }
}

/// The law fitted to rows of one temperature, the least squares of friction itself.
fn fit(law: FrictionLaw, unit: &str, rows: &[SteadyFriction]) -> Result<FrictionFit, Error> {
    let most = |of: fn(&SteadyFriction) -> f64| rows.iter().map(of).fold(0.0, f64::max);
    let (pressure, fastest, largest) = (most(|row| row.pressure), most(|row| row.speed), most(|row| row.friction));
    let slowest = rows.iter().map(|row| row.speed).fold(f64::INFINITY, f64::min);
    let has_one_pressure = rows.iter().all(|row| row.pressure == rows[0].pressure);
    let number = |name, bounds, scale, neutral| Parameter { name, bounds, scale, neutral };
    let not_negative = |name, scale| number(name, (0.0, 10.0 * scale), scale, Some(0.0));
    let mut parameters = vec![
        number("breakaway_increase", (1.0, 100.0), 1.0, Some(1.0)),
        number("ln_speed", (slowest.ln() - 1.0, fastest.ln() + 1.0), 1.0, None),
        not_negative("viscous_coefficient", largest / fastest),
    ];
    match has_one_pressure {
        true => parameters.push(not_negative("coulomb_friction", largest)),
        false => parameters
            .extend([not_negative("preload", largest), not_negative("coulomb_coefficient", largest / pressure)]),
    }
    if rows.len() < parameters.len() || largest == 0.0 {
        let expected = format!("expected friction above 0 in {} rows or more", parameters.len());
        return Err(Error::value(format!("{expected}, found {} rows up to {largest} {unit}", rows.len())));
    }
    let friction = |values: &[f64], row: &SteadyFriction| {
        let coulomb = values[3] + values.get(4).map_or(0.0, |coefficient| coefficient * row.pressure);
        let part = row.speed / values[1].exp();
        let part = if law == FrictionLaw::LuGre { part * part } else { part };
        coulomb * (1.0 + (values[0] - 1.0) * (-part).exp()) + values[2] * row.speed
    };
    let residuals = |values: &[f64]| rows.iter().map(|row| (friction(values, row) - row.friction) / largest).collect();
    let count = (STARTS * (fastest / slowest).log10()).ceil() as usize;
    let start = |i: usize| {
        let speed = slowest.ln() + i as f64 / STARTS * std::f64::consts::LN_10;
        let mut start = vec![1.5, speed, 0.1 * largest / fastest, 0.5 * largest];
        start.extend((!has_one_pressure).then(|| 0.5 * largest / pressure));
        start
    };
    let found = least_squares(&parameters, &(0..=count).map(start).collect::<Vec<_>>(), &residuals)?;
    let numbers = numbers(law, unit, &found.determined);
    Ok(FrictionFit { temperature: rows[0].temperature, numbers, rms: largest * found.rms(rows.len()), largest })
}

/// The numbers of a law as its programs have them.
fn numbers(law: FrictionLaw, unit: &str, found: &[Determined]) -> Vec<(&'static str, String, Determined)> {
    let (rate, speed) = match found[1] {
        Determined::Fitted(ln, error) => {
            (Determined::Fitted((-ln).exp(), (-ln).exp() * error), Determined::Fitted(ln.exp(), ln.exp() * error))
        }
        _ => (Determined::Not, Determined::Not),
    };
    // Where friction falls at no speed of the table nobody knows how far it does.
    let increase = if matches!(rate, Determined::Not) { Determined::Not } else { found[0] };
    let of = |name, unit: String, number| (name, unit, number);
    let mut numbers = match found {
        [_, _, _, coulomb] => vec![of("coulomb_friction", unit.into(), *coulomb)],
        _ => vec![
            of("preload", unit.into(), found[3]),
            of("coulomb_coefficient", if unit == "Pa" { String::new() } else { format!("{unit}/Pa") }, found[4]),
        ],
    };
    numbers.push(of("breakaway_increase", String::new(), increase));
    match law {
        FrictionLaw::Stribeck => numbers.extend([
            of("transition_coefficient", "s/m".into(), rate),
            of("viscous_coefficient", format!("{unit} s/m"), found[2]),
        ]),
        FrictionLaw::LuGre => numbers.extend([
            of("stribeck_speed", "m/s".into(), speed),
            of("sigma_2", format!("{unit} s/m"), found[2]),
            // Steady motion is the same with any of these.
            of("sigma_0", format!("{unit}/m"), Determined::Not),
            of("sigma_1", format!("{unit} s/m"), Determined::Not),
        ]),
    }
    numbers
}

/// A table with a row for each number of fits to a file.
pub fn friction_table(fits: &[FrictionFit], file: &Path) -> Table {
    let words = |name| Column::words(name, "");
    let [temperature, value, error] =
        [("temperature", "K"), ("value", ""), ("error", "")].map(|(name, unit)| Column::numbers(name, unit));
    let columns = [temperature, words("number"), value, error, words("unit"), words("status")];
    let mut table = Table::new(Header::new(LAW).with("of", &files::name_of(file)), columns);
    for (fit, (name, unit, number)) in fits.iter().flat_map(|fit| fit.numbers.iter().map(move |number| (fit, number))) {
        let ((value, error), status) = (number.numbers(), number.words());
        table.push([
            fit.temperature.into(),
            Cell::from(*name),
            value.into(),
            error.into(),
            Cell::from(unit.as_str()),
            Cell::from(status),
        ]);
    }
    table
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

    fn fitted(law: FrictionLaw, rows: &[SteadyFriction]) -> FrictionFit {
        fit(law, "N", rows).unwrap()
    }

    fn found(fit: &FrictionFit, name: &str) -> Determined {
        fit.numbers.iter().find(|number| number.0 == name).unwrap().2
    }

    #[track_caller]
    fn assert_values(fit: &FrictionFit, expected: &[(&str, f64)]) {
        for &(name, expected) in expected {
            let Determined::Fitted(found, error) = found(fit, name) else { panic!("{name}: {:?}", found(fit, name)) };
            // Data of the formula itself: what the fit's tolerance leaves.
            assert!((found / expected - 1.0).abs() < 1e-6, "{name}: {found}, expected {expected}");
            assert!(error < 1e-6 * expected, "{name}: {error}");
        }
    }

    #[test]
    fn data_of_the_formula_return_its_numbers() {
        let pressures = [0.0, 5e6, 10e6];
        let cylinder = fitted(FrictionLaw::Stribeck, &rows(&pressures, 1, NUMBERS));
        let names =
            ["preload", "coulomb_coefficient", "breakaway_increase", "transition_coefficient", "viscous_coefficient"];
        assert_values(&cylinder, &names.into_iter().zip(NUMBERS).collect::<Vec<_>>());
        assert!(cylinder.rms < 1e-6 * cylinder.largest, "{}", cylinder.rms);
        let at_one_pressure = rows(&pressures[1..2], 2, NUMBERS);
        let lugre = fitted(FrictionLaw::LuGre, &at_one_pressure);
        let numbers =
            [("coulomb_friction", 130.0), ("breakaway_increase", 1.4), ("stribeck_speed", 0.04), ("sigma_2", 60.0)];
        assert_values(&lugre, &numbers);
        assert_eq!(["sigma_0", "sigma_1"].map(|name| found(&lugre, name)), [Determined::Not; 2]);
        // The other law is off these data.
        assert!(fitted(FrictionLaw::Stribeck, &at_one_pressure).rms > 1.0);
    }

    #[test]
    fn standard_errors_are_those_of_repeated_data() {
        let mut random = asperity::math::SplitMix64::new(7);
        let mut said = Vec::new();
        for _ in 0..40 {
            let mut rows = rows(&[0.0, 5e6, 10e6], 1, NUMBERS);
            rows.iter_mut().for_each(|row| row.friction += 4.0 * (random.unit() - 0.5));
            match found(&fitted(FrictionLaw::Stribeck, &rows), "breakaway_increase") {
                Determined::Fitted(value, error) => said.push([value, error]),
                other => panic!("{other:?}"),
            }
        }
        let [mean, error] = [0, 1].map(|of| said.iter().map(|one| one[of]).sum::<f64>() / 40.0);
        let scatter = (said.iter().map(|one| (one[0] - mean).powi(2)).sum::<f64>() / 39.0).sqrt();
        // A standard deviation of 40 numbers is known to 11 %: three times that.
        assert!((error / scatter - 1.0).abs() < 0.33, "{error} {scatter}");
        assert!((mean - 1.4).abs() < 3.0 * scatter / 40.0_f64.sqrt(), "{mean} {scatter}");
    }

    #[test]
    fn what_the_table_does_not_determine_is_not_given() {
        let alone = fitted(FrictionLaw::Stribeck, &rows(&[1e6, 2e6], 1, [0.0, 2e-5, 1.0, 25.0, 0.0]));
        assert_values(&alone, &[("coulomb_coefficient", 2e-5)]);
        let breakaway = ["breakaway_increase", "transition_coefficient"];
        assert_eq!(breakaway.map(|name| found(&alone, name)), [Determined::Not; 2]);
        // A fall before the slowest of the speeds.
        let early = fitted(FrictionLaw::Stribeck, &rows(&[1e6, 2e6], 1, [30.0, 2e-5, 1.4, 1e6, 60.0]));
        assert_values(&early, &[("preload", 30.0), ("coulomb_coefficient", 2e-5), ("viscous_coefficient", 60.0)]);
        assert_eq!(breakaway.map(|name| found(&early, name)), [Determined::Not; 2]);
        let few = &rows(&[1e6], 1, NUMBERS)[..3];
        let data = FrictionData { file: "t.csv".into(), unit: "N", rows: few.to_vec(), left_out: 0 };
        let told = data.fit(FrictionLaw::LuGre).unwrap_err().to_string();
        assert!(told.starts_with("t.csv: expected friction above 0 in 4 rows or more, found 3 rows"), "{told}");
    }
}
