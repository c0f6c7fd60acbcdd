//! What a calibration says.

use std::path::Path;

use asperity_study::calibration::{
    Calibration, Direction, FitCovariance, FreeParameter, FreeScene, FrictionParts, Measured, Plan,
    chi_square_per_degree, in_words,
};
use asperity_study::comparison::off_in_words;
use asperity_study::decimals::short;

use crate::files::{name_of, named};
use crate::terminal::{LabelledLine, labelled, lines};

/// From this on a correlation is said.
const CORRELATED: f64 = 0.9;
/// Points that are far off are named up to this many.
const MOST_NAMED: usize = 10;

/// Points off by more than this times their standard deviation are named.
const FAR_OFF: f64 = 3.0;

/// The summary.
pub(super) fn text(
    free: &FreeScene<'_>,
    (calibration, covariance): (&Calibration, &FitCovariance),
    plan: Option<&Plan>,
    files: &[&Path],
) -> String {
    let mut rows = vec![
        ("Scene", free.scene().name.clone()),
        ("Data", data(free, calibration)),
        ("Method", free.of_method().to_owned()),
        ("Fit", calibration.way.clone()),
    ];
    let logarithms: Vec<&str> =
        free.parameters().iter().filter(|one| one.is_logarithmic()).map(|one| one.key.as_str()).collect();
    if !logarithms.is_empty() {
        rows.push(("Logarithm", format!("fitted of {}", logarithms.join(", "))));
    }
    rows.extend(parameters(free, calibration));
    rows.extend(correlations(calibration));
    rows.extend(labelled("Not told", not_told(calibration)));
    rows.push(("Chi square", chi_square(calibration)));
    rows.extend(labelled("Covariance", covariance_lines(covariance)));
    rows.extend(rests_on(calibration));
    rows.extend(labelled("Far off", far_off(calibration)));
    rows.extend(plan.map(|plan| planned(plan, &calibration.problem.parameters)).unwrap_or_default());
    rows.push(("Written", files.iter().map(|path| named(path)).collect::<Vec<_>>().join(", ")));
    lines(&rows)
}

fn data(free: &FreeScene<'_>, calibration: &Calibration) -> String {
    let problem = &calibration.problem;
    let deviations = if problem.has_sigma {
        "their standard deviations"
    } else {
        "standard deviations assumed: 5 % and 0.01; errors scaled by what is left"
    };
    format!(
        "{}: {} measurements at {} points, {deviations}",
        name_of(free.data()),
        calibration.measurements.rows.len(),
        problem.points.len()
    )
}

/// A table of the parameters.
fn parameters(free: &FreeScene<'_>, calibration: &Calibration) -> Vec<LabelledLine> {
    let width = free.parameters().iter().map(|parameter| parameter.key.len()).max().unwrap_or(0) + 2;
    let row = |cells: [&str; 5]| {
        let [key, before, value, error, interval] = cells;
        format!("{key:<width$}{before:<12}{value:<12}{error:<12}{interval}")
    };
    let statistics = &calibration.statistics;
    let values = calibration.values();
    let of = |(index, parameter): (usize, &FreeParameter)| {
        let error = statistics.errors[index].map(|error| parameter.error_of_value(values[index], error));
        let (error, interval) = match (error, statistics.intervals[index], statistics.at_bound[index]) {
            _ if !statistics.is_identifiable(index) => ("-".to_owned(), "not identifiable".to_owned()),
            (Some(error), Some((low, high)), _) => {
                (short(error, 2), format!("{} to {}", short(low, 4), short(high, 4)))
            }
            (_, _, Some(bound)) => ("-".to_owned(), format!("at its bound {}", short(bound, 4))),
            _ => ("-".to_owned(), String::new()),
        };
        row([&parameter.key, &short(calibration.own[index], 4), &short(values[index], 5), &error, &interval])
    };
    let head = row(["", "before", "value", "std. error", "95 % interval"]);
    labelled("Parameters", std::iter::once(head).chain(free.parameters().iter().enumerate().map(of)))
}

/// The correlation matrix, where one of its entries is large.
fn correlations(calibration: &Calibration) -> Vec<LabelledLine> {
    let matrix = &calibration.statistics.correlation;
    let count = matrix.nrows();
    let is_large = |a: usize, b: usize| matrix[(a, b)].abs() > CORRELATED;
    if !(0..count).any(|a| (0..a).any(|b| is_large(a, b))) {
        return Vec::new();
    }
    let width = calibration.problem.parameters.iter().map(|parameter| parameter.key.len()).max().unwrap_or(0) + 2;
    let row = |a: usize| {
        let entries: String = (0..=a).map(|b| format!("{:<8.3}", matrix[(a, b)])).collect();
        format!("{:<width$}{entries}", calibration.problem.parameters[a].key)
    };
    labelled("Correlation", (0..count).map(row))
}

/// What the data do not tell.
fn not_told(calibration: &Calibration) -> Vec<String> {
    let (statistics, parameters) = (&calibration.statistics, &calibration.problem.parameters);
    let directions = statistics.not_identifiable.iter().map(|direction| not_identifiable(direction, parameters));
    let covered = parameters.iter().zip(&statistics.covers_bounds).filter(|(_, covers)| **covers);
    let covered = covered
        .map(|(parameter, _)| format!("not identifiable: the 95 % interval of {} covers its bounds", parameter.key));
    directions.chain(covered).collect()
}

/// What counts only together.
fn not_identifiable(direction: &Direction, parameters: &[FreeParameter]) -> String {
    let parts: Vec<(usize, f64)> = direction.parameters().map(|index| (index, direction.components[index])).collect();
    let key = |index: usize| parameters[index].key.as_str();
    let all_logarithmic = parts.iter().all(|(index, _)| parameters[*index].is_logarithmic());
    /// Components that differ by less are alike.
    const ALIKE: f64 = 0.05;
    match parts[..] {
        [(only, _)] => format!("not identifiable: friction does not depend on {}", key(only)),
        [(a, x), (b, y)] if all_logarithmic && (x.abs() - y.abs()).abs() < ALIKE => {
            let (sign, word) = if x * y > 0.0 { ("/", "quotient") } else { ("*", "product") };
            format!("not identifiable: {} and {} count by their {word} alone, {0} {sign} {1}", key(a), key(b))
        }
        _ => {
            let part = |(index, component): &(usize, f64)| {
                let coordinate = if parameters[*index].is_logarithmic() { "ln " } else { "" };
                format!("{component:+.2} {coordinate}{}", key(*index))
            };
            let parts: Vec<String> = parts.iter().map(part).collect();
            format!(
                "not identifiable: along {} friction changes by {:.1e} of what it does along others",
                parts.join(", "),
                direction.share
            )
        }
    }
}

fn chi_square(calibration: &Calibration) -> String {
    let statistics = &calibration.statistics;
    let per_degree = chi_square_per_degree(statistics.chi_square, statistics.degrees);
    let end = match (calibration.fitted.has_converged, statistics.misfit) {
        (false, _) => "NOT CONVERGED",
        (true, Some(_)) => "converged, but NO FIT",
        (true, None) => "converged",
    };
    format!("{} per degree of freedom, of which there are {}; {end}", short(per_degree, 4), statistics.degrees)
}

/// What the covariance has, and what not.
fn covariance_lines(covariance: &FitCovariance) -> Vec<String> {
    let keys: Vec<&str> = covariance.numbers.iter().map(|number| number.key.as_str()).collect();
    let told = match keys[..] {
        [] => "none: no number has an error".to_owned(),
        _ => format!("of {}, for the samples of a sweep", keys.join(", ")),
    };
    let left_out = covariance.left_out.iter().map(|(key, why)| format!("left out: {key}, {why}"));
    std::iter::once(told).chain(left_out).collect()
}

/// A part of friction.
type PartOf = fn(&FrictionParts) -> f64;

/// On what the data rest: shares of friction in the mean, and the points that rest most on each.
fn rests_on(calibration: &Calibration) -> Vec<LabelledLine> {
    let kinds: [(&str, PartOf); 3] =
        [("profile", |parts| parts.profile), ("fine", |parts| parts.fine), ("shear", |parts| parts.shear)];
    let points = || calibration.problem.points.iter().zip(&calibration.frictions);
    let row = |(name, part): (&str, PartOf)| {
        let shares: Vec<(f64, String)> =
            points().map(|(point, parts)| (100.0 * part(parts) / parts.friction(), in_words(point))).collect();
        let mean = shares.iter().map(|(share, _)| share).sum::<f64>() / shares.len().max(1) as f64;
        let least = shares.iter().min_by(|a, b| a.0.total_cmp(&b.0));
        let most = shares.iter().max_by(|a, b| a.0.total_cmp(&b.0));
        let end =
            |end: Option<&(f64, String)>| end.map(|(share, at)| format!("{share:.0} % at {at}")).unwrap_or_default();
        format!("{name:<9}{mean:>3.0} % of friction in the mean, from {} to {}", end(least), end(most))
    };
    labelled("Rests on", kinds.into_iter().map(row))
}

/// The measurements that are off by more than three standard deviations, as given or assumed, the worst first.
fn far_off(calibration: &Calibration) -> Vec<String> {
    let deviation = |measured: &Measured| {
        let model = calibration.friction_at(&measured.point)?;
        let deviations = (model - measured.friction) / measured.sigma_or_assumed();
        (deviations.abs() > FAR_OFF).then(|| (deviations, off_in_words(measured, model, deviations)))
    };
    let mut found: Vec<(f64, String)> = calibration.measurements.rows.iter().filter_map(deviation).collect();
    found.sort_by(|a, b| b.0.abs().total_cmp(&a.0.abs()));
    found.into_iter().take(MOST_NAMED).map(|(_, text)| text).collect()
}

/// What to measure next, and what it would bring.
fn planned(plan: &Plan, parameters: &[FreeParameter]) -> Vec<LabelledLine> {
    let error = |parameter: &FreeParameter, error: f64| match parameter.is_logarithmic() {
        true => format!("{} of ln {}", short(error, 2), parameter.key),
        false => format!("{} of {}", short(parameter.error_of_value(0.0, error), 2), parameter.key),
    };
    let worst = plan.before.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1)).map_or(0, |(index, _)| index);
    let bring = |(index, parameter): (usize, &FreeParameter)| {
        let worst = if index == worst { " (the worst)" } else { "" };
        format!(
            "standard error {}: {} with them{worst}",
            error(parameter, plan.before[index]),
            short(
                if parameter.is_logarithmic() {
                    plan.after[index]
                } else {
                    parameter.error_of_value(0.0, plan.after[index])
                },
                2
            )
        )
    };
    let points = labelled("To measure", plan.points.iter().map(in_words));
    points.into_iter().chain(labelled("", parameters.iter().enumerate().map(bring))).collect()
}
