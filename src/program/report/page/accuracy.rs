//! The section on errors and run times.

use std::io;

use quick_xml::escape::escape;

use super::{begin_group, count, errors, head, number, reason, seconds, short};
use crate::program::arguments::Report;
use crate::program::html::{Cell, fill, table};
use crate::program::report::Parts;
use crate::program::report::ladder::{Figures, PATIENCE, PROGRAM, Row};
use crate::program::report::reference::{DISPLACEMENT, Reference};
use crate::program::report::trace::{Errors, QUANTITIES, WINDOWS};

const TEMPLATE: &str = include_str!("accuracy.html");
/// The errors that a user may settle for.
const BOUNDS: [f64; 6] = [1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6];

/// The section, with the text of its picture.
pub(in crate::program::report) fn section(command: &Report, parts: &Parts, picture: &str) -> io::Result<String> {
    let tolerances = &command.tolerances.0;
    let tolerance = |place: Option<&f64>| place.map_or_else(String::new, |tolerance| format!("{tolerance:e}"));
    let fields = [
        ("loosest", tolerance(tolerances.first())),
        ("tightest", tolerance(tolerances.last())),
        ("comparison", comparison(&parts.reference)),
        ("repeat", if command.repeat == 1 { "one run".into() } else { format!("{} runs", command.repeat) }),
        ("build", build().into()),
        ("picture", picture.into()),
        ("peers", peers(command)),
        ("patience", PATIENCE.to_string()),
        ("choices", choices(&parts.rows)?),
        ("table", runs(parts)?),
        ("reference", reference(&parts.reference)),
        ("sensitivity", sensitivity(&parts.reference)),
    ];
    Ok(fill(TEMPLATE, &fields))
}

fn comparison(reference: &Reference) -> String {
    if reference.comparison.is_of_means() {
        return format!(
            "The motion is sensitive, see below: compared are the means of F_x and F_z over {WINDOWS} windows of each phase, \
             by the largest difference over the largest mean, and E_diss, by the largest difference over the largest value."
        );
    }
    "An error is the largest difference from the reference at the rows of a result file, over the largest value.".into()
}

/// Times of a build that is not optimised would mislead.
fn build() -> &'static str {
    if cfg!(debug_assertions) {
        " <strong>This program was built without optimisation (no <code>--release</code>): the times mean little.</strong>"
    } else {
        ""
    }
}

fn peers(command: &Report) -> String {
    let text = |path: &std::path::PathBuf| {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        format!(
            " Dashed: other programs, whose errors and times, of whole processes, are those in <code>{}</code>.",
            escape(&*name)
        )
    };
    command.peers.as_ref().map_or_else(String::new, text)
}

/// For each bound the quickest run within it: of this program, and of the peers if there are any.
fn choices(rows: &[Row]) -> io::Result<String> {
    let with_peers = rows.iter().any(|row| row.program != PROGRAM);
    let mut names = head(&["all errors at most", "setting"], &["largest error", "run time in s", "steps"]);
    if with_peers {
        names.extend(head(&["quickest peer"], &["run time in s", "times as long"]));
    }
    let cells = BOUNDS.map(|bound| {
        let mut cells = vec![Cell::from(format!("{bound:e}"))];
        let own = quickest(rows, bound, true);
        cells.extend(setting(own));
        if with_peers {
            let peer = quickest(rows, bound, false);
            cells.extend(peer_cells(own, peer));
        }
        cells
    });
    table(&names, &cells)
}

fn quickest(rows: &[Row], bound: f64, own: bool) -> Option<(&Row, Figures)> {
    let within = |figures: &Figures| figures.time.is_some() && figures.error().is_some_and(|error| error <= bound);
    let rows = rows.iter().filter(|row| (row.program == PROGRAM) == own);
    let rows = rows.filter_map(|row| Some((row, *row.result.as_ref().ok().filter(|figures| within(figures))?)));
    rows.min_by(|(_, a), (_, b)| a.time.unwrap_or(f64::MAX).total_cmp(&b.time.unwrap_or(f64::MAX)))
}

fn setting(choice: Option<(&Row, Figures)>) -> Vec<Cell> {
    let Some((row, figures)) = choice else { return vec![reason("no run", 4)] };
    let setting = format!("{}, tolerance {:e}", row.method, row.tolerance);
    vec![setting.into(), short(figures.error()), seconds(figures.time), count(figures.steps)]
}

fn peer_cells(own: Option<(&Row, Figures)>, peer: Option<(&Row, Figures)>) -> Vec<Cell> {
    let Some((row, figures)) = peer else { return vec![reason("no run", 3)] };
    let name = format!("{} {}, tolerance {:e}", row.program, row.method, row.tolerance);
    let ratio = own.and_then(|(_, own)| Some(figures.time? / own.time?));
    let ratio = ratio.map_or_else(|| super::NOTHING.into(), |ratio| format!("{ratio:.1}"));
    vec![name.into(), seconds(figures.time), number(ratio)]
}

const FIGURES: [&str; 9] = [
    "error of F_x",
    "F_z",
    "E_diss",
    "run time in s",
    "steps",
    "rejected",
    "events",
    "Newton iterations",
    "energy residual",
];

/// All rows, the reference last.
fn runs(parts: &Parts) -> io::Result<String> {
    let reference = parts.reference.row();
    let rows: Vec<&Row> = parts.rows.iter().chain([&reference]).collect();
    let same = |a: &Row, b: &Row| a.program == b.program && a.method == b.method;
    let cells = rows.iter().enumerate().map(|(i, row)| {
        let below = |figures: &Figures| parts.reference.below(&figures.errors);
        let name = if row.program == PROGRAM { row.method.clone() } else { format!("{} {}", row.program, row.method) };
        let mut cells = vec![name.into(), number(format!("{:e}", row.tolerance))];
        match &row.result {
            Ok(figures) => cells.extend(figure_cells(figures, below(figures))),
            Err(why) => cells.push(reason(why, FIGURES.len())),
        }
        if i > 0 && !same(row, rows[i - 1]) {
            begin_group(&mut cells);
        }
        cells
    });
    table(&head(&["method"], &[&["tolerance"], &FIGURES[..]].concat()), &cells.collect::<Vec<_>>())
}

fn figure_cells(figures: &Figures, below: [bool; 3]) -> Vec<Cell> {
    let counts = [figures.steps, figures.rejected, figures.events, figures.iterations].map(count);
    let cells = errors(&figures.errors, below).chain([seconds(figures.time)]).chain(counts);
    cells.chain([short(figures.residual)]).collect()
}

fn reference(reference: &Reference) -> String {
    let reduced = if reference.scene.solver.reduce > 0.0 { ", with all Maxwell elements" } else { "" };
    let run =
        format!("A run by the method <code>event</code> at the relative tolerance {:e}{reduced}.", reference.tolerance);
    match reference.check {
        Some(check) => {
            let own = in_words(&reference.own);
            format!(
                "{run} Its own error, the difference from a run at {check:e}, is {own}: the shaded ground in the picture."
            )
        }
        None => format!("{run} No other run came to its end, so nothing is known of its own error."),
    }
}

fn sensitivity(reference: &Reference) -> String {
    let found = &reference.sensitivity;
    let test = format!(
        "With the carrier's start moved by {DISPLACEMENT:e} m along x, a run at the same tolerance differs from the reference \
         by {}",
        in_words(&found.differences)
    );
    let limit = found.limit;
    if reference.comparison.is_of_means() {
        format!(
            "<strong>The motion is sensitive.</strong> {test} of the largest value, row by row, more than {limit:.0e}: two runs \
             as tight as these part, and no row can be foretold. So means over windows are compared; what the moved start \
             changes in them counts as the reference's own error, too."
        )
    } else {
        format!("{test}, less than {limit:.0e}: runs stay together and can be compared row by row.")
    }
}

/// "2e-8 (F_x), 1e-9 (F_z)".
fn in_words(errors: &Errors) -> String {
    let named = QUANTITIES.iter().zip(errors).filter_map(|(name, error)| Some(format!("{:.0e} ({name})", (*error)?)));
    let named: Vec<String> = named.collect();
    if named.is_empty() { "nothing".into() } else { named.join(", ") }
}
