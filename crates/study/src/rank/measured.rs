//! The ranking beside measured friction of the scenes: a table with a column of their names.

use std::collections::BTreeMap;
use std::path::Path;

use asperity::element::{Load, OperatingPoint};
use asperity::tables::GivenColumns;
use serde::Serialize;

use super::plan::{RankFound, RankPlan};
use super::ranking::Mean;
use crate::calibration::{Measured, Measurements, left_out_in_words};
use crate::comparison::{NoFriction, swept_friction};
use crate::csv;
use crate::error::Error;
use crate::files::name_of;

/// The column of the scenes' names.
const SCENE: &str = "scene";

/// Measured friction beside that of the scenes.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MeasuredRanking {
    /// The scenes that were measured, in the order that they were given in.
    pub scenes: Vec<MeasuredScene>,
    /// At how many points all of these were measured: the means are over them.
    pub points: usize,
    /// Kendall's rank correlation of the means, tau-b; `None` where either are all the same.
    pub tau: Option<f64>,
    /// How the table was read, and what of it is left out.
    pub notes: Vec<String>,
}

/// A scene that was measured: means over the points at which all were.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MeasuredScene {
    /// What it is called.
    pub label: String,
    /// Measured friction.
    pub measured: f64,
    /// Friction of the scene there.
    pub computed: f64,
}

/// A measurement, and friction of its scene there.
type Compared = (Measured, f64);

/// Compares what was found with the measurements in a file.
///
/// # Errors
/// Where the file is no such table, names scenes that are not ranked, or has no point at which two of them were measured.
pub fn measured_ranking(
    plan: &RankPlan,
    found: &RankFound,
    path: &Path,
    columns: &GivenColumns,
) -> Result<MeasuredRanking, Error> {
    let refused = |problem: String| Error::in_file(path, None, problem);
    let csv = csv::read(path)?;
    let (of_scenes, columns): (Vec<_>, Vec<_>) = columns.iter().cloned().partition(|(key, _)| key == SCENE);
    let name = of_scenes.first().map_or(SCENE, |(_, name)| name);
    let column = csv.column(name).map_err(Error::content(path))?;
    let labels = plan.labels();
    let mut lines: BTreeMap<usize, usize> = BTreeMap::new();
    for row in &csv.rows {
        let scene = named(plan, row.fields[column].trim()).ok_or_else(|| {
            let known = labels.join(", ");
            refused(format!(
                "line {}: scene = \"{}\": expected one of {known}, or its file",
                row.line, row.fields[column]
            ))
        })?;
        lines.insert(row.line, scene);
    }
    let (mut compared, mut notes, mut left_out) = (vec![Vec::new(); labels.len()], Vec::new(), Vec::new());
    for scene in 0..labels.len() {
        if !lines.values().any(|other| *other == scene) {
            continue;
        }
        let table = &found.tables[scene];
        let Load::Pressure { area } = table.header.load else {
            return Err(refused("the ranking is over forces: expected one over pressures".to_owned()));
        };
        let measurements = Measurements::read(path, area, &columns)?;
        notes.extend(measurements.notes.iter().filter(|note| !notes.contains(*note)).cloned().collect::<Vec<_>>());
        for mut row in measurements.rows.into_iter().filter(|row| lines.get(&row.line) == Some(&scene)) {
            if let (None, [only]) = (row.point.temperature, &table.header.grid.temperatures[..]) {
                row.point.temperature = Some(*only);
            }
            match swept_friction(table, &row.point) {
                Ok(friction) => compared[scene].push((row, friction)),
                Err(why) => left_out.push((row, why)),
            }
        }
    }
    let words = left_out.iter().map(|(row, why): &(Measured, NoFriction)| (vec![row.line], row.point, why.to_string()));
    notes.extend(left_out_in_words(words, lines.len()));
    let (scenes, points) = means(plan.mean(), &labels, &compared);
    if scenes.len() < 2 || points == 0 {
        return Err(refused(
            "expected a point of the ranking at which at least two of its scenes were measured".to_owned(),
        ));
    }
    let of = |value: fn(&MeasuredScene) -> f64| scenes.iter().map(value).collect::<Vec<f64>>();
    let tau = kendall(&of(|scene| scene.computed), &of(|scene| scene.measured));
    Ok(MeasuredRanking { scenes, points, tau, notes })
}

/// The scene of a name, of a file or of a file's stem.
fn named(plan: &RankPlan, name: &str) -> Option<usize> {
    let (labels, files) = (plan.labels(), plan.files());
    let file = |file: &Path| [name_of(file), file.display().to_string()].iter().any(|other| other == name);
    let stem = |file: &Path| file.file_stem().is_some_and(|stem| stem.to_string_lossy() == name);
    let by_file = || {
        let mut all = (0..files.len()).filter(|&i| file(files[i]) || stem(files[i]));
        all.next().filter(|_| all.next().is_none())
    };
    labels.iter().position(|label| label == name).or_else(by_file)
}

/// The means of the scenes that were measured over the points at which all of them were, and how many these are.
fn means(kind: Mean, labels: &[String], compared: &[Vec<Compared>]) -> (Vec<MeasuredScene>, usize) {
    let measured: Vec<usize> = (0..labels.len()).filter(|&scene| !compared[scene].is_empty()).collect();
    let mut points: Vec<OperatingPoint> = Vec::new();
    for (row, _) in measured.first().iter().flat_map(|&&scene| &compared[scene]) {
        let is_new = !points.iter().any(|point| is_same(point, &row.point));
        let has = |scene: &usize| compared[*scene].iter().any(|(other, _)| is_same(&other.point, &row.point));
        if is_new && measured.iter().all(has) {
            points.push(row.point);
        }
    }
    let scene = |&scene: &usize| {
        let mean = |of: fn(&Compared) -> f64| {
            let at = |point: &OperatingPoint| {
                let all = compared[scene].iter().filter(|(row, _)| is_same(&row.point, point));
                let (sum, count) = all.fold((0.0, 0.0), |(sum, count), one| (sum + of(one), count + 1.0));
                sum / count
            };
            kind.of(points.iter().map(at).map(|value| (value, 1.0 / points.len() as f64)))
        };
        MeasuredScene {
            label: labels[scene].clone(),
            measured: mean(|one| one.0.friction),
            computed: mean(|one| one.1),
        }
    };
    let scenes = if points.is_empty() { Vec::new() } else { measured.iter().map(scene).collect() };
    (scenes, points.len())
}

/// Whether scenes were measured at one point: speeds and pressures within a tenth, temperatures within 3 K, as the curves of a
/// calibration are told apart.
fn is_same(one: &OperatingPoint, other: &OperatingPoint) -> bool {
    let is_near = |a: f64, b: f64| a <= 1.1 * b && b <= 1.1 * a;
    let is_as_warm = match (one.temperature, other.temperature) {
        (Some(a), Some(b)) => (a - b).abs() <= 3.0,
        (one, other) => one == other,
    };
    is_near(one.speed, other.speed) && is_near(one.load, other.load) && is_as_warm
}

/// Kendall's rank correlation of pairs, tau-b: pairs in the same order less those in the other one, over the root of the
/// products of those that are not tied in either (M. G. Kendall, Biometrika 33, 239 (1945)). `None` where all of one are
/// tied.
pub fn kendall(a: &[f64], b: &[f64]) -> Option<f64> {
    let (mut sum, mut of_a, mut of_b) = (0.0, 0.0, 0.0);
    let order = |x: f64, y: f64| f64::from(i8::from(x > y) - i8::from(x < y));
    for (i, j) in (0..a.len().min(b.len())).flat_map(|i| (0..i).map(move |j| (i, j))) {
        let (x, y) = (order(a[i], a[j]), order(b[i], b[j]));
        sum += x * y;
        of_a += x * x;
        of_b += y * y;
    }
    (of_a > 0.0 && of_b > 0.0).then(|| sum / f64::sqrt(of_a * of_b))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand, and with ties as scipy.stats.kendalltau has it: 8 pairs of 10 alike, one not, one tied in a.
    #[test]
    fn kendalls_correlation_is_that_of_the_book() {
        assert_eq!(kendall(&[1.0, 2.0, 3.0], &[10.0, 20.0, 30.0]), Some(1.0));
        assert_eq!(kendall(&[1.0, 2.0, 3.0], &[3.0, 2.0, 1.0]), Some(-1.0));
        assert_eq!(kendall(&[1.0, 2.0, 3.0, 4.0], &[1.0, 2.0, 4.0, 3.0]), Some(4.0 / 6.0));
        let tied = kendall(&[1.0, 2.0, 2.0, 3.0, 4.0], &[1.0, 2.0, 3.0, 5.0, 4.0]).unwrap_or_default();
        assert!((tied - 7.0 / f64::sqrt(90.0)).abs() < 1e-15, "{tied}");
        assert_eq!(kendall(&[1.0, 1.0], &[1.0, 2.0]), None);
    }

    fn compared(speed: f64, measured: f64, computed: f64) -> Compared {
        let point = OperatingPoint { speed, load: 1e5, temperature: Some(293.15), way: None };
        (Measured { line: 2, point, friction: measured, sigma: None }, computed)
    }

    /// Repeats of a point are one, and what only one of them has does not count.
    #[test]
    fn scenes_are_compared_where_all_were_measured() {
        let labels = ["a", "b", "c"].map(str::to_owned);
        let a =
            vec![compared(0.1, 0.5, 0.6), compared(0.105, 0.7, 0.8), compared(1.0, 1.0, 1.2), compared(10.0, 9.0, 9.0)];
        let b = vec![compared(1.0, 0.4, 0.4), compared(0.1, 0.2, 0.2)];
        let (scenes, points) = means(Mean::Arithmetic, &labels, &[a, b, Vec::new()]);
        assert_eq!((points, scenes.len(), scenes[1].label.as_str()), (2, 2, "b"));
        assert!((scenes[0].measured - 0.8).abs() < 1e-12 && (scenes[0].computed - 0.95).abs() < 1e-12, "{scenes:?}");
        assert!((scenes[1].measured - 0.3).abs() < 1e-12, "{scenes:?}");
    }
}
