//! The covariance of what was fitted, as a table beside the calibrated scene: by it the numbers are off together in the
//! samples of a sweep.

use asperity::scene::Setting;
use toml_edit::{DocumentMut, TableLike};

use super::calibrated::Calibration;
use super::free_scene::FreeScene;
use crate::csv;
use crate::decimals::{plain, real};
use crate::files::name_of;
use crate::settings::edited;

/// The section of a scene that says what is not known.
const SECTION: &str = "uncertainty";
/// Its keys of a table of a covariance, and of all moduli of the Prony series.
const COVARIANCE: &str = "covariance";
const PRONY: &str = "material.prony";

/// What is written of a fit's covariance.
#[derive(Clone, Debug, PartialEq)]
pub struct FitCovariance {
    /// What varies.
    pub numbers: Vec<FittedNumber>,
    /// The covariance of their coordinates, a row for each number.
    pub entries: Vec<Vec<f64>>,
    /// What does not, and why.
    pub left_out: Vec<(String, NotInCovariance)>,
    /// What was fitted to, in words.
    fitted_to: String,
}

/// A number that was fitted.
#[derive(Clone, Debug, PartialEq)]
pub struct FittedNumber {
    /// The path of its key.
    pub key: String,
    /// Its value.
    pub value: f64,
    /// Whether its coordinate is the natural logarithm; else it is the value.
    pub is_logarithmic: bool,
}

/// Why a number is in no covariance.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum NotInCovariance {
    /// A bound holds it.
    #[error("at its bound {}, which holds it: it has no error", plain(*.0))]
    AtBound(f64),
    /// Its error would be any.
    #[error("not identifiable: the data do not tell its error")]
    NotIdentifiable,
    /// The scene says how far all moduli may be off.
    #[error("\"material.prony\" in [uncertainty] has it")]
    Prony,
}

impl FitCovariance {
    /// That of a `calibration` of a scene.
    pub fn new(free: &FreeScene<'_>, calibration: &Calibration) -> Self {
        let (statistics, problem) = (&calibration.statistics, &calibration.problem);
        let has_prony = spreads(&free.text).iter().any(|key| key == PRONY);
        let why_not = |index: usize| match statistics.at_bound[index] {
            Some(bound) => Some(NotInCovariance::AtBound(bound)),
            None if !statistics.is_identifiable(index) => Some(NotInCovariance::NotIdentifiable),
            None if !statistics.errors[index].is_some_and(f64::is_finite) => Some(NotInCovariance::NotIdentifiable),
            None if has_prony && is_modulus(&problem.parameters[index].key) => Some(NotInCovariance::Prony),
            None => None,
        };
        let (mut told, mut left_out) = (Vec::new(), Vec::new());
        for (index, parameter) in problem.parameters.iter().enumerate() {
            match why_not(index) {
                None => told.push(index),
                Some(why) => left_out.push((parameter.key.clone(), why)),
            }
        }
        let values = calibration.values();
        let number = |&index: &usize| {
            let parameter = &problem.parameters[index];
            FittedNumber {
                key: parameter.key.clone(),
                value: values[index],
                is_logarithmic: parameter.is_logarithmic(),
            }
        };
        // The statistics' coordinate of a value is that over the distance of its bounds.
        let unit = |index: usize| problem.parameters[index].error_of_coordinate(1.0);
        let entry = |a: usize, b: usize| statistics.covariance[(a, b)] * unit(a) * unit(b);
        Self {
            numbers: told.iter().map(number).collect(),
            entries: told.iter().map(|&a| told.iter().map(|&b| entry(a, b)).collect()).collect(),
            left_out,
            fitted_to: format!("{} measurements of {}", problem.rows.len(), name_of(free.data())),
        }
    }

    /// The table; `None` where nothing is told.
    pub fn text(&self) -> Option<String> {
        if self.numbers.is_empty() {
            return None;
        }
        let mut text = format!(
            "# asperity calibrate: covariance of numbers fitted to {}\n\
             # of their natural logarithms where the scale is log, else of the numbers in the units of their keys\n",
            self.fitted_to
        );
        for (key, why) in &self.left_out {
            text += &format!("# left out, so that samples do not vary it: {key}, {why}\n");
        }
        let keys = || self.numbers.iter().map(|number| number.key.as_str());
        let rows = self.numbers.iter().zip(&self.entries).map(|(number, entries)| {
            let scale = if number.is_logarithmic { "log" } else { "linear" };
            let own = [number.key.clone(), plain(number.value), scale.to_owned()];
            own.into_iter().chain(entries.iter().map(|entry| real(*entry))).collect()
        });
        Some(text + &csv::text(["key", "value", "scale"].into_iter().chain(keys()), rows))
    }

    /// The `text` of a scene which names `file`, with its table, in `[uncertainty]`: without the spreads there of numbers that
    /// it has.
    pub fn named_in(&self, text: &str, file: &str) -> String {
        let keys: Vec<&str> = self.numbers.iter().map(|number| number.key.as_str()).collect();
        with_covariance(text, file, &keys)
    }
}

/// The `text` of a scene which names `file`, the table of a covariance of some `keys`, in `[uncertainty]`: without the
/// spreads of these.
pub fn with_covariance(text: &str, file: &str, keys: &[&str]) -> String {
    let text = edited(text, &[Setting::new(format!("{SECTION}.{COVARIANCE}"), file)]);
    let Ok(mut document) = text.parse::<DocumentMut>() else { return text };
    if let Some(section) = document.get_mut(SECTION).and_then(|section| section.as_table_like_mut()) {
        keys.iter().for_each(|key| remove(section, key));
    }
    document.to_string()
}

fn remove(section: &mut dyn TableLike, key: &str) {
    section.remove(key);
}

/// The table of a covariance that a scene of this `text` names.
pub fn named_covariance(text: &str) -> Option<String> {
    let document: DocumentMut = text.parse().ok()?;
    document.get(SECTION)?.as_table_like()?.get(COVARIANCE)?.as_str().map(str::to_owned)
}

/// The keys in `[uncertainty]`.
fn spreads(text: &str) -> Vec<String> {
    let document: Option<DocumentMut> = text.parse().ok();
    let section = document.as_ref().and_then(|document| document.get(SECTION)?.as_table_like());
    section.into_iter().flat_map(TableLike::iter).map(|(key, _)| key.to_owned()).collect()
}

fn is_modulus(key: &str) -> bool {
    key.strip_prefix(PRONY).is_some_and(|rest| rest.starts_with('[')) && key.ends_with(".modulus")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_section_is_kept_but_for_what_was_fitted() {
        let text = "name = 'a'\n[uncertainty]\n'a.b' = { relative = 0.1 } # guessed\n'layer.width' = { factor = 2.0 } # known\n";
        let found = with_covariance(text, "fit \"1\".csv", &["a.b", "c.d"]);
        assert!(found.contains("'layer.width' = { factor = 2.0 } # known") && !found.contains("a.b"), "{found}");
        assert_eq!(named_covariance(&found).as_deref(), Some("fit \"1\".csv"));
        // Once more, under another name.
        let again = with_covariance(&found, "2.csv", &["a.b"]);
        assert_eq!((named_covariance(&again).as_deref(), again.matches("covariance").count()), (Some("2.csv"), 1));
        let added = with_covariance("name = 'a'\n[layer]\nmasses = 2\n", "x.csv", &[]);
        assert!(added.starts_with("name = 'a'\n[layer]\nmasses = 2\n"), "{added}");
        assert_eq!(named_covariance(&added).as_deref(), Some("x.csv"));
    }

    #[test]
    fn a_table_says_what_is_left_out() {
        let number = |key: &str, value: f64, is_logarithmic| FittedNumber { key: key.into(), value, is_logarithmic };
        let mut covariance = FitCovariance {
            numbers: vec![number("a.b", 2e6, true), number("c[1].d", 0.5, false)],
            entries: vec![vec![0.04, -0.01], vec![-0.01, 0.25]],
            left_out: vec![("e".into(), NotInCovariance::AtBound(3.0)), ("f".into(), NotInCovariance::NotIdentifiable)],
            fitted_to: "5 measurements of data.csv".into(),
        };
        let text = covariance.text().unwrap();
        let (comments, table): (Vec<&str>, Vec<&str>) = text.lines().partition(|line| line.starts_with('#'));
        assert_eq!(table, ["key,value,scale,a.b,c[1].d", "a.b,2e6,log,0.04,-0.01", "c[1].d,0.5,linear,-0.01,0.25"]);
        assert!(comments[2].ends_with("e, at its bound 3, which holds it: it has no error"), "{text}");
        assert!(comments[3].contains("f, not identifiable"), "{text}");
        covariance.numbers.clear();
        assert_eq!(covariance.text(), None);
    }
}
