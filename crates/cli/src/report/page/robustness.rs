//! The section on robustness: each quantity scaled, all pairs as maps, ranges, failures.

use std::io;

use asperity::scene::Scene;
use asperity_study::robustness::{KEPT, NOTABLE, Perturbation, ScaledQuantity, TIGHTER, Verdict, WRONG};
use quick_xml::escape::escape;

use super::{NOTHING, head, short};
use asperity_study::html::{Cell, fill, table};
use asperity_study::report::{
    BUDGET, COMMUNICATION_STEPS, Counts, MAX_COMMUNICATION_STEPS, Robustness, SHORT_STEPS, Trial, method,
};

const TEMPLATE: &str = include_str!("robustness.html");
const PAIRS: &str = include_str!("robustness-pairs.html");
/// Rows of the table of failures.
const FAILURES: usize = 20;
/// Steps over those of the scene as it is that a user hardly notices.
const CHEAP: f64 = 2.0;
/// Bounds of the steps over those of the scene as it is, with their classes in the style sheet.
const WORK: [(f64, &str); 5] = [(1.0, "less"), (CHEAP, "twice"), (5.0, "five"), (10.0, "ten"), (f64::INFINITY, "more")];

pub(in crate::report) fn robustness(scene: &Scene, robustness: &Robustness) -> io::Result<String> {
    let names: Vec<&str> = robustness.quantities.iter().map(|quantity| quantity.name()).collect();
    let steps = robustness.unperturbed().counts().map_or(0, Counts::work);
    let fields = [
        ("quantities", in_a_row(&names)),
        ("most", factor(robustness.powers)),
        ("tolerance", format!("{:e}", robustness.tolerance)),
        ("method", method(scene)),
        ("tighter", TIGHTER.to_string()),
        ("legend", legend(Verdict::ALL.map(|verdict| (class(verdict), meaning(verdict))))),
        ("lines", lines(robustness)?),
        ("steps", steps.to_string()),
        ("count", COMMUNICATION_STEPS.to_string()),
        ("shortened", shortened(robustness)),
        ("ranges", ranges(robustness)?),
        ("pairs", pairs(robustness)?),
        ("failures", failures(robustness)?),
    ];
    Ok(fill(TEMPLATE, &fields))
}

/// "a, b and c".
fn in_a_row(names: &[&str]) -> String {
    match names {
        [] => String::new(),
        [only] => (*only).into(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    }
}

/// A power of ten as it is written by hand.
fn factor(power: i32) -> String {
    const RAISED: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let digits = power.unsigned_abs().to_string();
    let digits: String = digits.bytes().map(|digit| RAISED[usize::from(digit - b'0')]).collect();
    match power {
        0 => "1".into(),
        1 => "10".into(),
        2.. => format!("10{digits}"),
        _ => format!("10⁻{digits}"),
    }
}

fn class(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Kept => "within",
        Verdict::Above => "above",
        Verdict::FarAbove => "far",
        Verdict::Wrong => "wrong",
        Verdict::Sensitive => "sensitive",
        Verdict::Unknown => "unknown",
        Verdict::Stopped => "stopped",
        Verdict::OverBudget => "budget",
        Verdict::NotTried => "untried",
    }
}

fn meaning(verdict: Verdict) -> String {
    match verdict {
        Verdict::Kept => format!("kept: error at most {KEPT} times the tolerance"),
        Verdict::Above => format!("at most {NOTABLE} times"),
        Verdict::FarAbove => format!("at most {WRONG} times"),
        Verdict::Wrong => "wrong: more than that".into(),
        Verdict::Sensitive => "not comparable: sensitive to the start".into(),
        Verdict::Unknown => "not comparable: no tight run".into(),
        Verdict::Stopped => "fails: stops with an error".into(),
        Verdict::OverBudget => format!("over budget: more than {BUDGET} times the steps"),
        Verdict::NotTried => "not tried".into(),
    }
}

fn legend(entries: impl IntoIterator<Item = (&'static str, String)>) -> String {
    let entry = |(class, text): (&str, String)| format!("<li><b class=\"{class}\"></b>{}</li>", escape(&*text));
    format!("<ul class=\"legend\">{}</ul>", entries.into_iter().map(entry).collect::<String>())
}

/// Each quantity by itself, with the figures in the cells.
fn lines(robustness: &Robustness) -> io::Result<String> {
    let names = robustness.powers(1).map(|power| Cell::from(factor(power)));
    let names: Vec<Cell> = std::iter::once("".into()).chain(names).collect();
    let rows = robustness.quantities.iter().map(|&quantity| {
        let cell = |power: i32| {
            let perturbation = Perturbation::default().with(quantity, power);
            let trial = robustness.trial(perturbation);
            let class = verdict_class(robustness, trial);
            Cell { text: figures(robustness, trial), ..coloured(robustness, perturbation, class) }
        };
        std::iter::once(Cell::from(quantity.name())).chain(robustness.powers(1).map(cell)).collect()
    });
    table(&names, &rows.collect::<Vec<_>>())
}

/// The error, and how many times the steps.
fn figures(robustness: &Robustness, trial: &Trial) -> String {
    match robustness.verdict(trial) {
        Verdict::Stopped => "fails".into(),
        Verdict::OverBudget => format!("> {BUDGET} ×"),
        Verdict::NotTried => String::new(),
        _ => {
            let error = trial.ended().and_then(|ended| ended.accuracy.error());
            let error = error.map_or_else(|| "?".into(), |error| format!("{:.0e}", error.share));
            let times = robustness.times_the_steps(trial).map_or_else(String::new, |times| {
                if times < 1.0 { format!("{times:.2} ×") } else { format!("{times:.1} ×") }
            });
            format!("{error}\n{times}")
        }
    }
}

/// A cell of a colour; its title has the whole outcome.
fn coloured(robustness: &Robustness, perturbation: Perturbation, class: &str) -> Cell {
    let unscaled = ScaledQuantity::ALL.iter().all(|&quantity| perturbation.power(quantity).unwrap_or(0) == 0);
    let centre = if unscaled { " centre" } else { "" };
    Cell { class: format!("cell {class}{centre}"), title: outcome(robustness, perturbation), ..Cell::from("") }
}

fn outcome(robustness: &Robustness, perturbation: Perturbation) -> String {
    let trial = robustness.trial(perturbation);
    let mut text = format!("{}: {}", factors(perturbation), robustness.reason(trial));
    if let Some(counts) = trial.counts() {
        let times = robustness.times_the_steps(trial).map_or_else(String::new, |times| format!(" ({times:.2} times)"));
        text += &format!("; {} steps{times}, {} events", counts.steps, counts.events);
        text += &format!("; energy residual {:.0e}", counts.residual);
    }
    text
}

/// "stiffness × 10³, speed × 10⁻²".
pub(super) fn factors(perturbation: Perturbation) -> String {
    let scaled = ScaledQuantity::ALL.into_iter().filter_map(|quantity| Some((quantity, perturbation.power(quantity)?)));
    let scaled = scaled.filter(|&(quantity, power)| power != 0 || quantity == ScaledQuantity::CommunicationStep);
    let texts: Vec<String> =
        scaled.map(|(quantity, power)| format!("{} × {}", quantity.name(), factor(power))).collect();
    if texts.is_empty() { "as it is".into() } else { texts.join(", ") }
}

fn shortened(robustness: &Robustness) -> String {
    let many = |power: i32| COMMUNICATION_STEPS * 10_f64.powi(-power) > MAX_COMMUNICATION_STEPS;
    robustness.powers(1).filter(|&power| many(power)).last().map_or_else(String::new, |power| {
        format!(
            " From {} down the run is shortened: steps of the factor 1 to the middle of the longest phase, then {SHORT_STEPS} short ones.",
            factor(power)
        )
    })
}

fn ranges(robustness: &Robustness) -> io::Result<String> {
    let kept = format!("error at most {KEPT} times the tolerance");
    let cheap = format!("at most {CHEAP} times the steps");
    let names = head(&["", &kept, &cheap, "comes to its end", "beyond that"], &[]);
    let rows = robustness.quantities.iter().map(|&quantity| {
        let trial = |power: i32| robustness.trial(Perturbation::default().with(quantity, power));
        let ended = |power: i32| trial(power).counts().is_some();
        let range = |holds: &dyn Fn(i32) -> bool| -> Cell { in_words(reach(robustness.powers, holds)).into() };
        let ends = reach(robustness.powers, &ended);
        vec![
            quantity.name().into(),
            range(&|power| robustness.verdict(trial(power)) == Verdict::Kept),
            range(&|power| robustness.times_the_steps(trial(power)).is_some_and(|times| times <= CHEAP)),
            in_words(ends).into(),
            beyond(robustness, quantity, ends).into(),
        ]
    });
    table(&names, &rows.collect::<Vec<_>>())
}

/// The powers of ten, from the least to the greatest without a gap, for which something holds: those around the one
/// next to 0.
fn reach(most: i32, holds: &dyn Fn(i32) -> bool) -> Option<(i32, i32)> {
    let nearest = (0..=most).flat_map(|power| [power, -power]).find(|&power| holds(power))?;
    let low = (-most..=nearest).rev().take_while(|&power| holds(power)).last()?;
    let high = (nearest..=most).take_while(|&power| holds(power)).last()?;
    Some((low, high))
}

fn in_words(reach: Option<(i32, i32)>) -> String {
    reach.map_or_else(|| "nowhere".into(), |(low, high)| format!("{} to {}", factor(low), factor(high)))
}

/// The outcome of the runs next to those that come to their end.
fn beyond(robustness: &Robustness, quantity: ScaledQuantity, ends: Option<(i32, i32)>) -> String {
    let (low, high) = ends.map_or((0, 0), |(low, high)| (low - 1, high + 1));
    let mut next = vec![low, high];
    next.dedup();
    let texts = next.into_iter().filter(|power| power.abs() <= robustness.powers).map(|power| {
        let trial = robustness.trial(Perturbation::default().with(quantity, power));
        format!("{}: {}", factor(power), robustness.reason(trial))
    });
    let texts: Vec<String> = texts.collect();
    if texts.is_empty() { NOTHING.into() } else { texts.join("; ") }
}

/// The maps of all pairs, if there are any.
fn pairs(robustness: &Robustness) -> io::Result<String> {
    if robustness.quantities.len() < 2 {
        return Ok(String::new());
    }
    let mut maps = String::new();
    for (i, &row) in robustness.quantities.iter().enumerate() {
        for (j, &column) in robustness.quantities.iter().enumerate() {
            maps += &if i == j {
                let span = format!("{} to {}", factor(-robustness.powers), factor(robustness.powers));
                format!("<div class=\"name\"><span>{}<small>{span}</small></span></div>\n", row.name())
            } else {
                let class: fn(&Robustness, &Trial) -> &'static str = if i > j { work_class } else { verdict_class };
                format!("<div>{}</div>\n", map(robustness, column, row, class)?)
            };
        }
    }
    let fields = [
        ("columns", robustness.quantities.len().to_string()),
        ("least", factor(-robustness.powers)),
        ("most", factor(robustness.powers)),
        ("stride", ordinal(robustness.stride)),
        ("work", legend(WORK.map(|(bound, class)| (class, at_most(bound))))),
        ("left_out", left_out(robustness)),
        ("maps", maps),
    ];
    Ok(fill(PAIRS, &fields))
}

fn ordinal(stride: i32) -> String {
    match stride {
        1 => String::new(),
        2 => "second ".into(),
        3 => "third ".into(),
        n => format!("{n}th "),
    }
}

fn at_most(bound: f64) -> String {
    match bound {
        1.0 => "no more".into(),
        bound if bound.is_finite() => format!("at most {bound} times"),
        _ => "more".into(),
    }
}

/// The runs with two quantities scaled, in the colours of `class`.
fn map(
    robustness: &Robustness,
    x: ScaledQuantity,
    y: ScaledQuantity,
    class: fn(&Robustness, &Trial) -> &'static str,
) -> io::Result<String> {
    let row = |up: i32| {
        let cell = |right: i32| {
            let perturbation = Perturbation::default().with(x, right).with(y, -up);
            coloured(robustness, perturbation, class(robustness, robustness.trial(perturbation)))
        };
        robustness.powers(robustness.stride).map(cell).collect()
    };
    let rows: Vec<Vec<Cell>> = robustness.powers(robustness.stride).map(row).collect();
    table(&[], &rows)
}

fn verdict_class(robustness: &Robustness, trial: &Trial) -> &'static str {
    class(robustness.verdict(trial))
}

fn work_class(robustness: &Robustness, trial: &Trial) -> &'static str {
    let class_of = |times: f64| WORK.iter().find(|(bound, _)| times <= *bound).map_or("more", |(_, class)| *class);
    robustness.times_the_steps(trial).map_or_else(|| verdict_class(robustness, trial), class_of)
}

fn left_out(robustness: &Robustness) -> String {
    let count = robustness.trials().filter(|(_, trial)| robustness.verdict(trial) == Verdict::NotTried).count();
    if count == 0 {
        return String::new();
    }
    format!(" {count} runs, likely the most expensive, were not tried: <code>--stress-time</code> gives more time.")
}

/// The runs that fail or are wrong, the nearest to the scene first.
fn failures(robustness: &Robustness) -> io::Result<String> {
    let bad = |verdict: Verdict| matches!(verdict, Verdict::Stopped | Verdict::Wrong | Verdict::FarAbove);
    let all = robustness.trials().filter(|(_, trial)| bad(robustness.verdict(trial)));
    let mut failures: Vec<Perturbation> = all.map(|(perturbation, _)| *perturbation).collect();
    if failures.is_empty() {
        return Ok(String::new());
    }
    let distance = |perturbation: &Perturbation| -> i32 {
        ScaledQuantity::ALL.into_iter().filter_map(|quantity| perturbation.power(quantity)).map(i32::abs).sum()
    };
    failures.sort_by_key(distance);
    let more = failures.len().saturating_sub(FAILURES);
    failures.truncate(FAILURES);
    let rows: Vec<Vec<Cell>> = failures.into_iter().map(|failure| failure_row(robustness, failure)).collect();
    let table = table(&head(&["", "", "outcome"], &["energy residual"]), &rows)?;
    let more = match more {
        0 => String::new(),
        more => format!("<p class=\"note\">{more} more are in the table beside the page.</p>\n"),
    };
    Ok(format!(
        "<h3>Failures and wrong results</h3>\n<p>The nearest to the scene as it is first.</p>\n<div class=\"scroll\">\n{table}\n</div>\n{more}"
    ))
}

fn failure_row(robustness: &Robustness, perturbation: Perturbation) -> Vec<Cell> {
    let trial = robustness.trial(perturbation);
    vec![
        factors(perturbation).into(),
        robustness.verdict(trial).name().into(),
        Cell { class: "reason".into(), ..Cell::from(robustness.reason(trial)) },
        short(trial.counts().map(|counts| counts.residual)),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn factors_are_written_as_by_hand() {
        assert_eq!([-12, -1, 0, 1, 6].map(factor), ["10⁻¹²", "10⁻¹", "1", "10", "10⁶"]);
        let perturbation = Perturbation::default().with(ScaledQuantity::Stiffness, 3).with(ScaledQuantity::Speed, -2);
        assert_eq!(factors(perturbation), "stiffness × 10³, speed × 10⁻²");
        assert_eq!(factors(Perturbation::default()), "as it is");
    }

    #[test]
    fn a_range_ends_at_the_first_that_fails() {
        assert_eq!(reach(6, &|power| power != 3), Some((-6, 2)));
        assert_eq!(reach(2, &|_| true), Some((-2, 2)));
        assert_eq!(reach(3, &|power| power != 0), Some((1, 3)));
        assert_eq!(reach(3, &|power| power < 0), Some((-3, -1)));
        assert_eq!(reach(2, &|_| false), None);
    }
}
