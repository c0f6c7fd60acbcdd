//! The file of a covariance, as `asperity calibrate` writes it: numbers of a scene that were fitted together.
//!
//! Lines of comments begin with `#`. The columns are key, value, scale and one for each key, in the order of the rows:
//! the covariance of the numbers or, where the scale is `log`, of their logarithms.

use std::path::PathBuf;

use asperity::tables::{ContentError, LARGEST, fields};
use asperity_formats::text::decode;
use nalgebra::{DMatrix, SymmetricEigen};

/// Numbers of a scene that move together.
#[derive(Clone, Debug, PartialEq)]
pub struct Covariance {
    /// The file, relative to the scene's folder.
    pub file: PathBuf,
    /// The numbers.
    pub numbers: Vec<FittedNumber>,
    /// A root R of the covariance R Rᵀ, row by row: what independent normal numbers do to each.
    pub root: Vec<Vec<f64>>,
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

/// The columns before those of the keys.
const COLUMNS: [&str; 3] = ["key", "value", "scale"];
/// What is written with some digits is symmetric and positive but for this part.
const ROUNDING: f64 = 1e-6;

/// The covariance in a file, as yet of no name, and the line of each number.
type Read = (Covariance, Vec<usize>);

/// The covariance in the bytes of a file.
pub(super) fn read_covariance(bytes: &[u8]) -> Result<Read, ContentError> {
    let text = decode(bytes)?;
    let is_data = |line: &&str| !line.trim().is_empty() && !line.starts_with('#');
    let mut lines = (1..).zip(text.lines()).filter(|(_, line)| is_data(line));
    let (first, head) = lines.next().unwrap_or((1, ""));
    let head: Vec<String> = fields(head, ',').map(|name| name.into_owned()).collect();
    if head.len() <= COLUMNS.len() || head[..COLUMNS.len()] != COLUMNS {
        let expected = "key, value, scale and a column for each key, as calibrate writes them";
        return Err(ContentError::value(Some(first), "columns", &format!("\"{}\"", head.join(", ")), expected));
    }
    let keys = &head[COLUMNS.len()..];
    let (mut numbers, mut rows, mut at) = (Vec::new(), Vec::new(), Vec::new());
    for (line, text) in lines {
        let (number, row) = read_row(line, text, keys, numbers.len())?;
        numbers.push(number);
        rows.push(row);
        at.push(line);
    }
    if numbers.len() != keys.len() {
        let expected = format!("{}, one for each column of a key", keys.len());
        return Err(ContentError::value(None, "rows", &numbers.len().to_string(), &expected));
    }
    let root = root(&rows).map_err(|expected| ContentError::value(Some(first), "covariance", "", &expected))?;
    Ok((Covariance { file: PathBuf::new(), numbers, root }, at))
}

/// Row `index` of a file with columns for these keys.
fn read_row(line: usize, text: &str, keys: &[String], index: usize) -> Result<(FittedNumber, Vec<f64>), ContentError> {
    let found: Vec<String> = fields(text, ',').map(|field| field.into_owned()).collect();
    let error = |key: &str, given: &str, expected: &str| {
        ContentError::value(Some(line), key, &format!("\"{given}\""), expected)
    };
    if found.len() != COLUMNS.len() + keys.len() {
        let expected = format!("{}, as many as columns", COLUMNS.len() + keys.len());
        return Err(ContentError::value(Some(line), "fields", &found.len().to_string(), &expected));
    }
    let Some(key) = keys.get(index).filter(|key| **key == found[0]) else {
        return Err(error("key", &found[0], "the keys of the columns, in their order"));
    };
    if keys[..index].contains(key) {
        return Err(error("key", key, "each key once"));
    }
    let number = |name: &str, text: &str| {
        let number = text.parse().ok().filter(|number: &f64| number.abs() <= LARGEST);
        number.ok_or_else(|| error(name, text, "a number"))
    };
    let scale = match &*found[2] {
        "log" => Scale::Log,
        "linear" => Scale::Linear,
        other => return Err(error("scale", other, "one of \"log\", \"linear\"")),
    };
    let value = number("value", &found[1])?;
    let row = found[COLUMNS.len()..].iter().zip(keys).map(|(text, name)| number(name, text));
    Ok((FittedNumber { key: key.clone(), value, scale }, row.collect::<Result<_, _>>()?))
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
        read_covariance(text.as_bytes()).map(|(covariance, _)| covariance).map_err(|error| error.to_string())
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

    #[test]
    fn what_is_no_covariance_is_refused() {
        for (text, message) in [
            ("", "columns = \"\": expected key, value, scale"),
            ("key,value,scale\n", "columns = \"key, value, scale\": expected key, value"),
            ("key,value,scale,a\n", "rows = 0: expected 1, one for each"),
            ("key,value,scale,a\nb,1,log,1\n", "key = \"b\": expected the keys of the columns"),
            ("key,value,scale,a\na,1,ln,1\n", "scale = \"ln\": expected one of \"log\", \"linear\""),
            ("key,value,scale,a\na,x,log,1\n", "value = \"x\": expected a number"),
            ("key,value,scale,a\na,1,log,-1\n", "covariance: expected variances"),
            ("key,value,scale,a,b\na,1,log,1,0\nb,1,log,0.1,1\n", "covariance: expected a symmetric"),
            ("key,value,scale,a,b\na,1,log,1,2\nb,1,log,2,1\n", "covariance: expected a matrix that is"),
        ] {
            let error = read(text).unwrap_err();
            assert!(error.starts_with(message), "{text:?}: {error}");
        }
    }
}
