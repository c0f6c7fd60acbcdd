//! The section on the scene under stress.

use std::io;

use asperity::scene::{Parameter, Scene};
use quick_xml::escape::escape;

use super::head;
use crate::program::html::{Cell, fill, table};
use crate::program::report::stress::{
    self, COMMUNICATION_STEPS, MOST_COMMUNICATION_STEPS, NOTABLE, Place, Quantity, SHORT_STEPS, Status, Stress,
    TIGHTER, TOO_EXPENSIVE, WITHIN, WRONG,
};

const TEMPLATE: &str = include_str!("stress.html");
const PAIRS: &str = include_str!("stress-pairs.html");
/// Rows of the table of the worst cells.
const WORST: usize = 20;
/// Steps over those of the scene as it is that a user hardly feels.
const CHEAP: f64 = 2.0;
/// Bounds of the steps over those of the scene as it is, and what such cells are called in the style sheet.
const WORK: [(f64, &str); 5] = [(1.0, "less"), (CHEAP, "twice"), (5.0, "five"), (10.0, "ten"), (f64::INFINITY, "more")];

/// The section.
pub(in crate::program::report) fn section(scene: &Scene, stress: &Stress) -> io::Result<String> {
    let names: Vec<&str> = stress.quantities.iter().map(|quantity| quantity.name()).collect();
    let steps = stress.unstressed().counts().map_or(0, stress::Counts::work);
    let fields = [
        ("quantities", in_a_row(&names)),
        ("most", factor(stress.powers)),
        ("tolerance", format!("{:e}", stress.tolerance)),
        ("method", scene.parameter(Parameter::Method).to_string().replace('"', "")),
        ("tighter", TIGHTER.to_string()),
        ("legend", legend(STATUSES.map(|status| (class(status), meaning(status))))),
        ("lines", lines(stress)?),
        ("steps", steps.to_string()),
        ("count", COMMUNICATION_STEPS.to_string()),
        ("shortened", shortened(stress)),
        ("ranges", ranges(stress)?),
        ("pairs", pairs(stress)?),
        ("worst", worst(stress)?),
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

/// In the order of the legend.
const STATUSES: [Status; 9] = [
    Status::Within,
    Status::Above,
    Status::FarAbove,
    Status::Wrong,
    Status::Sensitive,
    Status::Unknown,
    Status::Stopped,
    Status::TooExpensive,
    Status::LeftOut,
];

fn class(status: Status) -> &'static str {
    match status {
        Status::Within => "within",
        Status::Above => "above",
        Status::FarAbove => "far",
        Status::Wrong => "wrong",
        Status::Sensitive => "sensitive",
        Status::Unknown => "unknown",
        Status::Stopped => "stopped",
        Status::TooExpensive => "dear",
        Status::LeftOut => "untried",
    }
}

fn meaning(status: Status) -> String {
    match status {
        Status::Within => format!("kept: error at most {WITHIN} times the tolerance"),
        Status::Above => format!("at most {NOTABLE} times"),
        Status::FarAbove => format!("at most {WRONG} times"),
        Status::Wrong => "wrong: more than that".into(),
        Status::Sensitive => "sensitive: a moved start changes as much".into(),
        Status::Unknown => "kept, but no tight run to compare with".into(),
        Status::Stopped => "stopped with an error".into(),
        Status::TooExpensive => format!("too expensive: more than {TOO_EXPENSIVE} times the steps"),
        Status::LeftOut => "not tried".into(),
    }
}

fn legend(entries: impl IntoIterator<Item = (&'static str, String)>) -> String {
    let entry = |(class, text): (&str, String)| format!("<li><b class=\"{class}\"></b>{}</li>", escape(&*text));
    format!("<ul class=\"legend\">{}</ul>", entries.into_iter().map(entry).collect::<String>())
}

/// Each quantity by itself, with the figures in the cells.
fn lines(stress: &Stress) -> io::Result<String> {
    let mut names = vec![Cell::from("")];
    names.extend(stress.powers(1).map(|power| Cell::from(factor(power))));
    let rows = stress.quantities.iter().map(|&quantity| {
        let cell = |power: i32| {
            let place = Place::default().with(quantity, power);
            let text = figures(stress, stress.cell(place));
            Cell { text, ..coloured(stress, place, class(stress.status(stress.cell(place))), power == 0) }
        };
        std::iter::once(Cell::from(quantity.name())).chain(stress.powers(1).map(cell)).collect()
    });
    table(&names, &rows.collect::<Vec<_>>())
}

/// The error, and how many times the steps.
fn figures(stress: &Stress, cell: &stress::Cell) -> String {
    let times = stress
        .times_the_steps(cell)
        .map(|times| if times < 1.0 { format!("{times:.2} ×") } else { format!("{times:.1} ×") });
    match stress.status(cell) {
        Status::Stopped => "stops".into(),
        Status::TooExpensive => format!("> {TOO_EXPENSIVE} ×"),
        Status::LeftOut => String::new(),
        _ => {
            let error = cell
                .check()
                .and_then(stress::Check::error)
                .map_or_else(|| "?".into(), |error| format!("{:.0e}", error.share));
            format!("{error}\n{}", times.unwrap_or_default())
        }
    }
}

/// A cell of a colour that tells all where it is pointed at.
fn coloured(stress: &Stress, place: Place, class: &str, centre: bool) -> Cell {
    let centre = if centre { " centre" } else { "" };
    Cell { class: format!("cell {class}{centre}"), title: told(stress, place), ..Cell::from("") }
}

fn told(stress: &Stress, place: Place) -> String {
    let cell = stress.cell(place);
    let mut text = format!("{}: {}", factors(place), stress.reason(cell));
    if let Some(counts) = cell.counts() {
        let times = stress.times_the_steps(cell).map_or_else(String::new, |times| format!(" ({times:.2} times)"));
        text += &format!("; {} steps{times}, {} events", counts.steps, counts.events);
        text += &format!("; energy residual {:.0e}", counts.residual);
    }
    text
}

/// "stiffness × 10³, speed × 10⁻²".
fn factors(place: Place) -> String {
    let scaled = Quantity::ALL.into_iter().filter_map(|quantity| Some((quantity, place.power(quantity)?)));
    let scaled = scaled.filter(|&(quantity, power)| power != 0 || quantity == Quantity::CommunicationStep);
    let texts: Vec<String> =
        scaled.map(|(quantity, power)| format!("{} × {}", quantity.name(), factor(power))).collect();
    if texts.is_empty() { "as it is".into() } else { texts.join(", ") }
}

fn shortened(stress: &Stress) -> String {
    let many = |power: i32| COMMUNICATION_STEPS * 10_f64.powi(-power) > MOST_COMMUNICATION_STEPS;
    stress.powers(1).filter(|&power| many(power)).last().map_or_else(String::new, |power| {
        format!(
            " From {} down the run is shortened: steps of the factor 1 to the middle of the longest phase, then {SHORT_STEPS} short ones.",
            factor(power)
        )
    })
}

/// From where to where each quantity may go.
fn ranges(stress: &Stress) -> io::Result<String> {
    let within = format!("error at most {WITHIN} times the tolerance");
    let cheap = format!("at most {CHEAP} times the steps");
    let names = head(&["", &within, &cheap, "comes to its end", "beyond that"], &[]);
    let rows = stress.quantities.iter().map(|&quantity| {
        let cell = |power: i32| stress.cell(Place::default().with(quantity, power));
        let ended = |power: i32| cell(power).counts().is_some();
        let range = |holds: &dyn Fn(i32) -> bool| -> Cell { in_words(reach(stress.powers, holds)).into() };
        let ends = reach(stress.powers, &ended);
        vec![
            quantity.name().into(),
            range(&|power| stress.status(cell(power)) == Status::Within),
            range(&|power| stress.times_the_steps(cell(power)).is_some_and(|times| times <= CHEAP)),
            in_words(ends).into(),
            beyond(stress, quantity, ends).into(),
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

/// What becomes of the runs next to those that come to their end.
fn beyond(stress: &Stress, quantity: Quantity, ends: Option<(i32, i32)>) -> String {
    let (low, high) = ends.map_or((0, 0), |(low, high)| (low - 1, high + 1));
    let mut next = vec![low, high];
    next.dedup();
    let told = next.into_iter().filter(|power| power.abs() <= stress.powers).map(|power| {
        let cell = stress.cell(Place::default().with(quantity, power));
        format!("{}: {}", factor(power), stress.reason(cell))
    });
    let told: Vec<String> = told.collect();
    if told.is_empty() { super::NOTHING.into() } else { told.join("; ") }
}

/// The maps of all pairs, if there are any.
fn pairs(stress: &Stress) -> io::Result<String> {
    if stress.quantities.len() < 2 {
        return Ok(String::new());
    }
    let mut maps = String::new();
    for (i, &row) in stress.quantities.iter().enumerate() {
        for (j, &column) in stress.quantities.iter().enumerate() {
            maps += &if i == j {
                let span = format!("{} to {}", factor(-stress.powers), factor(stress.powers));
                format!("<div class=\"name\"><span>{}<small>{span}</small></span></div>\n", row.name())
            } else {
                format!("<div>{}</div>\n", map(stress, column, row, i > j)?)
            };
        }
    }
    let fields = [
        ("columns", stress.quantities.len().to_string()),
        ("least", factor(-stress.powers)),
        ("most", factor(stress.powers)),
        ("stride", ordinal(stress.stride)),
        ("work", legend(WORK.map(|(bound, class)| (class, at_most(bound))))),
        ("left_out", left_out(stress)),
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

/// One pair, errors or work.
fn map(stress: &Stress, x: Quantity, y: Quantity, of_work: bool) -> io::Result<String> {
    let rows: Vec<Vec<Cell>> = stress
        .powers(stress.stride)
        .map(|up| {
            let cell = |right: i32| {
                let place = Place::default().with(x, right).with(y, -up);
                let class = if of_work { work_class(stress, place) } else { class(stress.status(stress.cell(place))) };
                coloured(stress, place, class, right == 0 && up == 0)
            };
            stress.powers(stress.stride).map(cell).collect()
        })
        .collect();
    table(&[], &rows)
}

fn work_class(stress: &Stress, place: Place) -> &'static str {
    let cell = stress.cell(place);
    let class_of = |times: f64| WORK.iter().find(|(bound, _)| times <= *bound).map_or("more", |(_, class)| *class);
    stress.times_the_steps(cell).map_or_else(|| class(stress.status(cell)), class_of)
}

fn left_out(stress: &Stress) -> String {
    let count = stress.cells().filter(|(_, cell)| stress.status(cell) == Status::LeftOut).count();
    if count == 0 {
        return String::new();
    }
    format!(
        " {count} of the cells, likely to be the dearest, were not tried: <code>--stress-time</code> gives more time."
    )
}

/// The cells that stop or are wrong, the nearest to the scene first.
fn worst(stress: &Stress) -> io::Result<String> {
    let bad = |status: Status| matches!(status, Status::Stopped | Status::Wrong | Status::FarAbove);
    let mut places: Vec<Place> =
        stress.cells().filter(|(_, cell)| bad(stress.status(cell))).map(|(place, _)| *place).collect();
    if places.is_empty() {
        return Ok(String::new());
    }
    let distance = |place: &Place| -> i32 {
        Quantity::ALL.into_iter().filter_map(|quantity| place.power(quantity)).map(i32::abs).sum()
    };
    places.sort_by_key(distance);
    let more = places.len().saturating_sub(WORST);
    let rows: Vec<Vec<Cell>> = places.into_iter().take(WORST).map(|place| worst_row(stress, place)).collect();
    let names = head(&["", "", "what became of it"], &["energy residual"]);
    let rest = if more > 0 {
        format!("<p class=\"note\">And {more} more in the table beside the page.</p>\n")
    } else {
        String::new()
    };
    let table = table(&names, &rows)?;
    Ok(format!(
        "<h3>What stops or is wrong</h3>\n<p>The nearest to the scene as it is first.</p>\n<div class=\"scroll\">\n{table}\n</div>\n{rest}"
    ))
}

fn worst_row(stress: &Stress, place: Place) -> Vec<Cell> {
    let cell = stress.cell(place);
    vec![
        factors(place).into(),
        stress.status(cell).name().into(),
        Cell { class: "reason".into(), ..Cell::from(stress.reason(cell)) },
        super::short(cell.counts().map(|counts| counts.residual)),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn factors_are_written_as_by_hand() {
        assert_eq!([-12, -1, 0, 1, 6].map(factor), ["10⁻¹²", "10⁻¹", "1", "10", "10⁶"]);
        let place = Place::default().with(Quantity::Stiffness, 3).with(Quantity::Speed, -2);
        assert_eq!(factors(place), "stiffness × 10³, speed × 10⁻²");
        assert_eq!(factors(Place::default()), "as it is");
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
