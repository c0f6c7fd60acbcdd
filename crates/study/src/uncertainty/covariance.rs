//! The file of a covariance, as `asperity calibrate` writes it: numbers of a scene that were fitted together.
//!
//! Lines of comments begin with `#`. The columns are key, value, scale and one for each key, in the order of the rows:
//! the covariance of the numbers or, where the scale is `log`, of their logarithms.

use std::path::PathBuf;

use asperity::table::{Header, Table, TableError};
use asperity::tables::LARGEST;
use nalgebra::{DMatrix, SymmetricEigen};

use super::sampler::inverse_normal;
use crate::error::Error;

/// Numbers of a scene that move together.
#[derive(Clone, Debug, PartialEq)]
pub struct Covariance {
    /// The file, relative to the scene's folder.
    pub file: PathBuf,
    /// The numbers.
    pub numbers: Vec<FittedNumber>,
    /// A root R of the covariance R Rᵀ, row by row: what independent normal numbers do to each.
    pub root: Vec<Vec<f64>>,
    /// Degrees of freedom of the variance of the measurements, where their residuals are what told it: the numbers then have
    /// Student's distribution.
    pub degrees: Option<u64>,
}

/// A number of the scene that was fitted.
#[derive(Clone, Debug, PartialEq)]
pub struct FittedNumber {
    /// The path of its key.
    pub key: String,
    /// What the scene says; what was fitted but for rounding, or else a warning says so.
    pub value: f64,
    /// In which coordinate it is normal.
    pub scale: Scale,
}

/// The coordinate in which a number is normal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// Its natural logarithm.
    Log,
    /// The number.
    Linear,
}

impl Scale {
    /// The word for it in a file.
    pub fn word(self) -> &'static str {
        match self {
            Self::Log => "log",
            Self::Linear => "linear",
        }
    }
}

/// How a comment of a file begins whose numbers do not describe what they were fitted to, and what those say who use it.
pub const CANNOT_SAY: &str = "the scene cannot say this data";

/// The key of a header that has the degrees of freedom.
pub const DEGREES_OF_FREEDOM: &str = "degrees_of_freedom";

/// The columns before those of the keys.
const COLUMNS: [&str; 3] = ["key", "value", "scale"];
/// How many numbers one may have: its root takes time as their third power.
const MOST: usize = 100;
/// How large its file may be (bytes): as many numbers take a quarter of it.
pub(super) const LARGEST_FILE: usize = 1 << 20;
/// What is written with some digits is symmetric and positive but for this part.
const ROUNDING: f64 = 1e-6;

impl Covariance {
    /// That of a table, each number about the one that is fitted in the table.
    ///
    /// # Errors
    /// Where it is no such table.
    pub(super) fn of(table: &Table, file: PathBuf) -> Result<Self, Error> {
        let names: Vec<&str> = table.columns().iter().map(|column| column.name.as_str()).collect();
        let Some(keys) = names.strip_prefix(&COLUMNS[..]).filter(|keys| !keys.is_empty()) else {
            let expected = "expected key, value, scale and a column for each key, as calibrate writes them";
            return Err(table.error(format!("the columns {}: {expected}", names.join(", "))).into());
        };
        if keys.len() > MOST {
            let expected = format!("expected at most {MOST}, as calibrate frees a dozen at most");
            return Err(table.error(format!("{} numbers: {expected}", keys.len())).into());
        }
        if table.len() != keys.len() {
            let (found, expected) = (table.len(), keys.len());
            return Err(table.error(format!("{found} rows: expected {expected}, one for each column of a key")).into());
        }
        let number = |row: usize, name: &str| -> Result<f64, TableError> {
            let found = table.number(row, name, "")?.filter(|number| number.abs() <= LARGEST);
            found.ok_or_else(|| table.cell_error(row, name, "", "a number"))
        };
        let (mut numbers, mut rows) = (Vec::new(), Vec::new());
        for (row, key) in keys.iter().copied().enumerate() {
            if table.word(row, "key", "")? != key {
                return Err(table.cell_error(row, "key", "", "the keys of the columns, in their order").into());
            }
            if keys[..row].contains(&key) {
                return Err(table.cell_error(row, "key", "", "each key once").into());
            }
            let scale = match table.word(row, "scale", "")?.as_str() {
                "log" => Scale::Log,
                "linear" => Scale::Linear,
                _ => return Err(table.cell_error(row, "scale", "", "one of \"log\", \"linear\"").into()),
            };
            let value = number(row, "value")?;
            if scale == Scale::Log && value <= 0.0 {
                return Err(table.cell_error(row, "value", "", "a number above 0, whose logarithm was fitted").into());
            }
            numbers.push(FittedNumber { key: key.to_owned(), value, scale });
            rows.push(keys.iter().map(|key| number(row, key)).collect::<Result<Vec<f64>, _>>()?);
        }
        let root = root(&rows).map_err(|expected| table.error(format!("covariance: expected {expected}")))?;
        let degrees = table.header.optional(DEGREES_OF_FREEDOM, Header::whole)?;
        if degrees == Some(0) {
            return Err(table.error(format!("`# {DEGREES_OF_FREEDOM} = 0`: expected a whole number from 1")).into());
        }
        Ok(Self { file, numbers, root, degrees })
    }

    /// By how much more the numbers are off than normal ones: √(ν/χ²), at a uniform number from 0 to 1.
    pub(super) fn widened(&self, unit: f64) -> f64 {
        self.degrees.map_or(1.0, |degrees| (degrees as f64 / chi_square(degrees, unit)).sqrt())
    }
}

/// χ² of so many degrees of freedom below which a sample is with this probability: of one and two in closed form, of more by E.
/// B. Wilson's and M. M. Hilferty's cube (1931), within 4 % from the fiftieth part up of three and 1 % of five.
fn chi_square(degrees: u64, probability: f64) -> f64 {
    match degrees {
        1 => inverse_normal(0.5 * (1.0 + probability)).powi(2),
        2 => -2.0 * (-probability).ln_1p(),
        _ => {
            let variance = 2.0 / (9.0 * degrees as f64);
            degrees as f64 * (1.0 - variance + variance.sqrt() * inverse_normal(probability)).max(1e-3).powi(3)
        }
    }
}

/// A root of a covariance by its eigenvectors: one that is only semidefinite has one, too.
fn root(rows: &[Vec<f64>]) -> Result<Vec<Vec<f64>>, String> {
    let count = rows.len();
    // Each number by its own deviation: they may have any units.
    let deviations: Vec<f64> = (0..count).map(|i| rows[i][i].max(0.0).sqrt()).collect();
    if let Some(i) = (0..count).find(|&i| rows[i][i] < 0.0) {
        return Err(format!("variances of 0 or more, not {:?}", rows[i][i]));
    }
    let unit = |i: usize| if deviations[i] > 0.0 { deviations[i] } else { 1.0 };
    let scaled = DMatrix::from_fn(count, count, |i, j| rows[i][j] / unit(i) / unit(j));
    if (0..count).any(|i| (0..i).any(|j| (scaled[(i, j)] - scaled[(j, i)]).abs() > ROUNDING)) {
        return Err("a symmetric matrix".into());
    }
    let symmetric = (&scaled + scaled.transpose()) * 0.5;
    let eigen = SymmetricEigen::new(symmetric);
    let least = eigen.eigenvalues.iter().copied().fold(0.0, f64::min);
    if least.is_nan() || least < -ROUNDING * count as f64 {
        return Err("a matrix that is positive semidefinite".into());
    }
    let part = |i: usize, k: usize| unit(i) * eigen.eigenvectors[(i, k)] * eigen.eigenvalues[k].max(0.0).sqrt();
    Ok((0..count).map(|i| (0..count).map(|k| part(i, k)).collect()).collect())
}

impl FittedNumber {
    /// Whether what the scene says differs from what was fitted by more than the rounding of either.
    pub(super) fn is_moved(&self, value: f64) -> bool {
        /// Both are written with so many digits at least.
        const DIGITS: f64 = 1e-5;
        (self.value - value).abs() > DIGITS * self.value.abs().max(value.abs())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::in_tests::assert_within;

    fn read(text: &str) -> Result<Covariance, String> {
        let table = Table::parse(text, "fit.csv".as_ref()).map_err(|error| error.to_string())?;
        Covariance::of(&table, PathBuf::from("fit.csv")).map_err(|error| error.to_string())
    }

    #[test]
    fn a_root_of_the_matrix_is_found() {
        let found = read("# fitted\nkey,value,scale,a.b,\"c[1].d\"\na.b,1e6,log,0.04,-0.6\nc[1].d,3,linear,-0.6,9.0\n");
        let found = found.unwrap();
        assert_eq!(found.numbers[1], FittedNumber { key: "c[1].d".into(), value: 3.0, scale: Scale::Linear });
        let product = |i: usize, j: usize| (0..2).map(|k| found.root[i][k] * found.root[j][k]).sum::<f64>();
        for (i, j, wanted) in [(0, 0, 0.04), (0, 1, -0.6), (1, 1, 9.0)] {
            assert_within(product(i, j), wanted, 1e-12);
        }
        // Two numbers that only move together.
        let found = read("key,value,scale,a,b\na,1,log,1,2\nb,1,log,2,4\n").unwrap();
        let product = |i: usize, j: usize| (0..2).map(|k| found.root[i][k] * found.root[j][k]).sum::<f64>();
        assert_within(product(0, 1), 2.0, 1e-12);
    }

    /// Quantiles of χ² from tables, and Student's two-sided 10 % of five degrees, 2.015, by even numbers.
    #[test]
    fn an_estimated_variance_widens_as_students_tables_say() {
        for (degrees, probability, quantile, within) in
            [(1, 0.05, 0.003932, 1e-3), (2, 0.5, 1.386294, 1e-6), (3, 0.05, 0.352, 0.08), (5, 0.95, 11.070, 0.01)]
        {
            assert_within(chi_square(degrees, probability), quantile, within * quantile);
        }
        let covariance = read("# degrees_of_freedom = 5\nkey,value,scale,a\na,1,linear,1\n").unwrap();
        let even = |i: u32| (f64::from(i) + 0.5) / 400.0;
        let within = |(i, j): (u32, u32)| (inverse_normal(even(i)) * covariance.widened(even(j))).abs() < 2.015;
        let count = (0..400).flat_map(|i| (0..400).map(move |j| (i, j))).filter(|pair| within(*pair)).count();
        // 90 % but for the cube.
        assert_within(count as f64 / 160_000.0, 0.9, 2e-3);
        assert_eq!(read("key,value,scale,a\na,1,linear,1\n").unwrap().widened(0.01), 1.0);
    }

    #[test]
    fn what_is_no_covariance_is_refused() {
        for (text, message) in [
            ("", "the columns : expected key, value, scale"),
            ("# degrees_of_freedom = 0\nkey,value,scale,a\na,1,log,1\n", "expected a whole number from 1"),
            ("key,value,scale\n", "the columns key, value, scale: expected key, value"),
            ("key,value,scale,a\n", "0 rows: expected 1, one for each"),
            ("key,value,scale,a\nb,1,log,1\n", "key = \"b\": expected the keys of the columns"),
            ("key,value,scale,a\na,1,ln,1\n", "scale = \"ln\": expected one of \"log\", \"linear\""),
            ("key,value,scale,a\na,-1,log,1\n", "value = \"-1\": expected a number above 0, whose logarithm"),
            ("key,value,scale,a\na,x,log,1\n", "value = \"x\": expected a number"),
            ("key,value,scale,a\na,1,log,-1\n", "covariance: expected variances"),
            ("key,value,scale,a,b\na,1,log,1,0\nb,1,log,0.1,1\n", "covariance: expected a symmetric"),
            ("key,value,scale,a,b\na,1,log,1,2\nb,1,log,2,1\n", "covariance: expected a matrix that is"),
        ] {
            let error = read(text).unwrap_err();
            assert!(error.starts_with("fit.csv") && error.contains(message), "{text:?}: {error}");
        }
        let many: String = (0..1000).map(|i| format!(",k{i}")).collect();
        let error = read(&format!("key,value,scale{many}\n")).unwrap_err();
        assert!(error.contains("1000 numbers: expected at most 100"), "{error}");
    }
}
