//! What a calibration writes: the scene, which is the file that was read, its comments kept and its numbers replaced; beside
//! it the covariance of what was fitted, by which the numbers are off together in the samples of a sweep; and the points
//! that were found, so that nothing is found twice.

use std::cmp::Ordering;
use std::ops::ControlFlow;

use asperity::element::{OperatingPoint, PointStatus};
use asperity::scene::{Scene, Setting};
use asperity::table::{Cell, Column, Header, Table, TableError};
use toml_edit::{DocumentMut, TableLike};

use super::calibrator::{Calibration, Calibrator};
use super::free_scene::{CalibrationOptions, FreeScene};
use super::models::{FrictionParts, NoSliding, Outcome, Task};
use super::problem::FreeParameter;
use super::refit::stored;
use super::statistics::Misfit;
use crate::csv;
use crate::decimals::{plain, real, short};
use crate::error::Error;
use crate::files::name_of;
use crate::settings::edited;
use crate::uncertainty::{DEGREES_OF_FREEDOM, FittedNumber, Scale};

/// Fits numbers of a scene, of which this is the `text` with keys set, to measured friction: what it found, and the text of the scene
/// with the numbers, and their covariance. `found` is called for every point that was found, and says whether to go on.
///
/// # Errors
/// Where the scene, the parameters or the measurements are refused, and where `found` says to stop.
pub fn calibrate_scene(
    scene: Scene,
    text: String,
    options: &CalibrationOptions,
    found: impl Fn() -> ControlFlow<()> + Sync,
) -> Result<(Calibration, String, FitCovariance), Error> {
    let free = FreeScene::new(options, text, scene)?;
    let measurements = free.measurements()?;
    let calibrate = |calibrator: Calibrator<'_>| calibrator.calibrate(&measurements);
    let calibration = free.with_models(Vec::new(), &|_, _| found(), &|_| (), calibrate)?;
    let (text, covariance) = (calibrated_text(&free, &calibration), FitCovariance::new(&free, &calibration));
    Ok((calibration, text, covariance))
}

/// What the lines of the header begin with; those of a calibration before are replaced.
const MARK: &str = "# asperity calibrate: ";

/// The text of the scene.
pub fn calibrated_text(free: &FreeScene<'_>, calibration: &Calibration) -> String {
    let values = calibration.values();
    let setting = |(parameter, value): (&FreeParameter, &f64)| Setting::parse(&parameter.key, &plain(*value));
    let settings: Vec<Setting> = free.parameters.iter().zip(&values).map(setting).collect();
    let edited = edited(&free.text, &settings);
    let kept = edited.trim_start_matches('\u{feff}').lines().skip_while(|line| line.starts_with(MARK));
    let body: String = kept.map(|line| format!("{line}\n")).collect();
    let header: String = header(free, calibration).iter().map(|line| format!("{MARK}{line}\n")).collect();
    header + &body
}

fn header(free: &FreeScene<'_>, calibration: &Calibration) -> Vec<String> {
    let statistics = &calibration.statistics;
    let data = name_of(&free.options.data);
    let rows = match calibration.measurements.rows.len() - calibration.problem.rows.len() {
        0 => format!("{} measurements", calibration.problem.rows.len()),
        left_out => {
            format!("{} of {} measurements", calibration.problem.rows.len(), left_out + calibration.problem.rows.len())
        }
    };
    let mut lines = vec![format!("fitted to {rows} of {data}")];
    if !calibration.fitted.has_converged {
        lines.push("NOT CONVERGED: the numbers below are where the fit was given up".to_owned());
    }
    lines.extend(statistics.misfit.map(|misfit| format!("NO FIT: {misfit}")));
    if !statistics.tell_all() {
        lines.push("NOT IDENTIFIABLE: the data do not tell all of the numbers below".to_owned());
    }
    lines.extend(free.parameters.iter().zip(calibration.values()).enumerate().map(|(index, (parameter, value))| {
        let range = match (statistics.intervals[index], statistics.at_bound[index]) {
            _ if !statistics.is_identifiable(index) => "not identifiable".to_owned(),
            (Some((low, high)), _) => {
                format!("95 % interval {} to {}", short(low, 3), short(high, 3))
            }
            (None, _) => "at its bound".to_owned(),
        };
        format!("{} = {}, {range}", parameter.key, plain(value))
    }));
    lines
}

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
    /// What was fitted to, in words, ...
    fitted_to: String,
    /// ... and in numbers, by which they are fitted anew in samples.
    stored: Header,
    /// Where the scene cannot say that.
    misfit: Option<Misfit>,
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
                scale: if parameter.is_logarithmic() { Scale::Log } else { Scale::Linear },
            }
        };
        // Given deviations are known, those of the residuals estimated.
        let estimated = (!problem.has_sigma && statistics.degrees > 0).then_some(statistics.degrees);
        // The statistics' coordinate of a value is that over the distance of its bounds.
        let unit = |index: usize| problem.parameters[index].error_of_coordinate(1.0);
        let entry = |a: usize, b: usize| statistics.covariance[(a, b)] * unit(a) * unit(b);
        Self {
            numbers: told.iter().map(number).collect(),
            entries: told.iter().map(|&a| told.iter().map(|&b| entry(a, b)).collect()).collect(),
            left_out,
            fitted_to: format!("{} measurements of {}", problem.rows.len(), name_of(free.data())),
            stored: stored(free, problem, &told).with_some(DEGREES_OF_FREEDOM, estimated.map(|n| n.to_string())),
            misfit: statistics.misfit,
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
        if let Some(misfit) = self.misfit {
            text += &format!("# {misfit}\n");
        }
        for (key, why) in &self.left_out {
            text += &format!("# left out, so that samples do not vary it: {key}, {why}\n");
        }
        text += &self.stored.text();
        let keys = || self.numbers.iter().map(|number| number.key.as_str());
        let rows = self.numbers.iter().zip(&self.entries).map(|(number, entries)| {
            let own = [number.key.clone(), plain(number.value), number.scale.word().to_owned()];
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

/// The kind of the table of points; its number grows when readers have to know of a change.
const POINTS: (&str, u64) = ("asperity calibrate", 3);

/// The table beside a calibration's output: the points that were found, so that nothing is found twice.
#[derive(Clone, Debug)]
pub struct PointsTable {
    /// Without rows.
    table: Table,
    parameters: usize,
}

impl PointsTable {
    /// That of these parameters in the calibration of a fingerprint.
    pub fn new(fingerprint: &str, parameters: &[FreeParameter]) -> Self {
        let keys = parameters.iter().map(|parameter| Column::numbers(&parameter.key, ""));
        let point = [("speed", "m/s"), ("pressure", "Pa"), ("temperature", "K"), ("way", "m")];
        let parts = ["profile", "fine", "shear", "area"].map(|name| Column::numbers(name, "1"));
        let point = point.map(|(name, unit)| Column::numbers(name, unit));
        let columns = keys.chain(point).chain([Column::words("status", "")]).chain(parts);
        let table = Table::new(Header::new(POINTS).with("fingerprint", fingerprint), columns);
        Self { table, parameters: parameters.len() }
    }

    /// The table without rows.
    pub fn empty(&self) -> &Table {
        &self.table
    }

    /// The cells of a point.
    pub fn cells(task: &Task, outcome: &Outcome) -> Vec<Cell> {
        let OperatingPoint { speed, load, temperature, way } = task.point;
        let values = task.parameters.iter().copied().map(Cell::from);
        let point = [Some(speed), Some(load), temperature, way].map(Cell::from);
        let status = Cell::from(PointStatus::new(outcome.as_ref().err()).text());
        let parts =
            outcome.as_ref().map_or([None; 4], |parts| [parts.profile, parts.fine, parts.shear, parts.area].map(Some));
        values.chain(point).chain([status]).chain(parts.map(Cell::from)).collect()
    }

    /// The points of such a table; the error of a row that is damaged.
    pub fn points(&self, table: &Table) -> Vec<Result<(Task, Outcome), TableError>> {
        let point = |row| self.point(table, row).ok_or_else(|| table.error_in(row, "expected a whole point"));
        (0..table.len()).map(point).collect()
    }

    /// The points of such a table by their parameters, loads, temperatures, ways and speeds: the same whichever was found first.
    pub fn in_order(&self, table: &Table) -> Table {
        let numbers = |(Task { parameters, point }, _): &(Task, Outcome)| {
            let optional = [Some(point.load), point.temperature, point.way, Some(point.speed)];
            parameters.iter().copied().chain(optional.map(|number| number.unwrap_or(0.0))).collect::<Vec<f64>>()
        };
        let mut points: Vec<(Task, Outcome)> = self.points(table).into_iter().flatten().collect();
        points.sort_by(|one, other| {
            let orders = std::iter::zip(numbers(one), numbers(other)).map(|(a, b)| a.total_cmp(&b));
            orders.fold(Ordering::Equal, Ordering::then)
        });
        let mut ordered = self.table.clone();
        points.iter().for_each(|(task, outcome)| ordered.push(Self::cells(task, outcome)));
        ordered
    }

    fn point(&self, table: &Table, row: usize) -> Option<(Task, Outcome)> {
        let optional = |name: &str, unit: &str| table.number(row, name, unit).ok();
        let part = |name: &str| optional(name, "1")?;
        let keys = table.columns().iter().take(self.parameters);
        let parameters = keys.map(|column| optional(&column.name, "")?).collect::<Option<Vec<f64>>>()?;
        let point = OperatingPoint {
            speed: optional("speed", "m/s")??,
            load: optional("pressure", "Pa")??,
            temperature: optional("temperature", "K")?,
            way: optional("way", "m")?,
        };
        let outcome = match PointStatus::read(&table.word(row, "status", "").ok()?) {
            PointStatus::Steady | PointStatus::FullContact => Ok(FrictionParts {
                profile: part("profile")?,
                fine: part("fine")?,
                shear: part("shear")?,
                area: part("area")?,
            }),
            PointStatus::Problem(why) => Err(NoSliding::new(why)),
        };
        Some((Task { parameters, point }, outcome))
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

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
        let number = |key: &str, value: f64, scale| FittedNumber { key: key.into(), value, scale };
        let mut covariance = FitCovariance {
            numbers: vec![number("a.b", 2e6, Scale::Log), number("c[1].d", 0.5, Scale::Linear)],
            entries: vec![vec![0.04, -0.01], vec![-0.01, 0.25]],
            left_out: vec![("e".into(), NotInCovariance::AtBound(3.0)), ("f".into(), NotInCovariance::NotIdentifiable)],
            fitted_to: "5 measurements of data.csv".into(),
            stored: Header::default(),
            misfit: Some(Misfit::Large(0.5)),
        };
        let text = covariance.text().unwrap();
        let (comments, table): (Vec<&str>, Vec<&str>) = text.lines().partition(|line| line.starts_with('#'));
        assert_eq!(table, ["key,value,scale,a.b,c[1].d", "a.b,2e6,log,0.04,-0.01", "c[1].d,0.5,linear,-0.01,0.25"]);
        assert!(comments[2].starts_with("# the scene cannot say this data: friction is off by 50 %"), "{text}");
        assert!(comments[3].ends_with("e, at its bound 3, which holds it: it has no error"), "{text}");
        assert!(comments[4].contains("f, not identifiable"), "{text}");
        covariance.numbers.clear();
        assert_eq!(covariance.text(), None);
    }

    #[test]
    fn a_row_is_read_as_it_was_written() {
        let task = |temperature| Task {
            parameters: vec![1.0 / 3.0, 2e-7],
            point: OperatingPoint { speed: 0.1, load: 1e5, temperature, way: temperature.map(|_| 0.02) },
        };
        let parts = FrictionParts { profile: 0.1 + 0.2, fine: 1e-9, shear: -0.5, area: 0.1 };
        let parameter = |key: &str| FreeParameter::new(key.into(), 0.0, 1.0).unwrap();
        let table = PointsTable::new("f", &[parameter("a.b"), parameter("c[1].d")]);
        for (task, outcome) in
            [(task(Some(293.15)), Ok(parts)), (task(None), Err(NoSliding::new("no, \"never\" steady")))]
        {
            let line = Table::line(&PointsTable::cells(&task, &outcome));
            let text = table.empty().head() + &line + &line[1 + line.find(',').unwrap_or_default()..];
            let (begun, damaged) = table.empty().begun(&text, Path::new("points.csv")).unwrap();
            assert_eq!((table.points(&begun), damaged.len()), (vec![Ok((task, outcome))], 1));
            let other = PointsTable::new("g", &[parameter("a.b"), parameter("c[1].d")]);
            assert!(other.empty().begun(&text, Path::new("")).is_err());
        }
    }

    #[test]
    fn points_have_one_order() {
        let parameter = FreeParameter::new("a.b".into(), 0.0, 1.0).unwrap();
        let table = PointsTable::new("f", &[parameter]);
        let row = |value: f64, speed: f64| {
            let point = OperatingPoint { speed, load: 1e5, temperature: None, way: None };
            PointsTable::cells(&Task { parameters: vec![value], point }, &Ok(FrictionParts::default()))
        };
        let of = |rows: [[f64; 2]; 3]| {
            let mut found = table.empty().clone();
            rows.iter().for_each(|[value, speed]| found.push(row(*value, *speed)));
            table.in_order(&found).text()
        };
        assert_eq!(of([[0.5, 1.0], [0.2, 2.0], [0.2, 1.0]]), of([[0.2, 1.0], [0.2, 2.0], [0.5, 1.0]]));
    }
}
