//! The sections on errors against run time and against the communication step, and their pictures.

use std::io;

use asperity::scene::{Extrapolation, Scene};
use asperity_study::robustness::DISPLACEMENT;
use quick_xml::escape::escape;

use super::{NOTHING, count, errors, grouped, head, number, per_cent, reason, seconds, short};
use crate::cli::Report;
use asperity_study::html::{Cell, fill, table};
use asperity_study::report::{
    CommunicationRow, Errors, PATIENCE, PROGRAM, QUANTITIES, Reference, RunFigures, Timed, ToleranceRow, WINDOWS,
    method,
};

const TOLERANCES: &str = include_str!("tolerances.html");
/// The errors that a user may settle for.
const BOUNDS: [f64; 6] = [1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6];

/// The section on tolerances, with its picture as SVG.
pub(in crate::report) fn tolerances(
    command: &Report,
    reference: &Reference,
    rows: &[ToleranceRow],
    picture: &str,
) -> io::Result<String> {
    let tolerances = &command.tolerances.0;
    let tolerance = |place: Option<&f64>| place.map_or_else(String::new, |tolerance| format!("{tolerance:e}"));
    let fields = [
        ("loosest", tolerance(tolerances.first())),
        ("tightest", tolerance(tolerances.last())),
        ("comparison", comparison(reference)),
        ("repeat", repeat(command.repeat)),
        ("warning", warning().into()),
        ("picture", picture.into()),
        ("peers", peers(command)),
        ("patience", PATIENCE.to_string()),
        ("choices", choices(rows)?),
        ("table", runs(reference, rows)?),
        ("reference", reference_text(reference)),
        ("sensitivity", sensitivity(reference)),
    ];
    Ok(fill(TOLERANCES, &fields))
}

fn comparison(reference: &Reference) -> String {
    if reference.comparison.is_of_means() {
        return format!(
            "The motion is sensitive, see below: what is compared are means of F_x and F_z over {WINDOWS} windows of each phase \
             (the largest difference over the largest mean) and E_diss (the largest difference over the largest value)."
        );
    }
    "An error is the largest difference from the reference at the rows of a result file, over the largest value.".into()
}

fn repeat(most: u32) -> String {
    match most {
        1 => "one timing".into(),
        most => {
            format!("the least of up to {most} timings, of short runs more than of long ones, in rounds over all runs")
        }
    }
}

/// Times of a build that is not optimised would mislead.
fn warning() -> &'static str {
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
            " Dashed: whole processes, of other programs and of asperity beside them, with errors and times from \
             <code>{}</code>; solid: the run alone.",
            escape(&*name)
        )
    };
    command.peers.as_ref().map_or_else(String::new, text)
}

/// For each bound the quickest run within it; and of whole processes, if there are any, this program's and the peers'.
fn choices(rows: &[ToleranceRow]) -> io::Result<String> {
    let with_peers = rows.iter().any(|row| row.timed == Timed::WholeProcess);
    let mut names = head(&["all errors at most", "setting"], &["largest error", "run time in s", "steps"]);
    if with_peers {
        names.extend(head(&["quickest peer"], &["whole process in s"]));
        names.extend(head(&["asperity beside it"], &["whole process in s", "the peer takes times as long"]));
    }
    let cells = BOUNDS.map(|bound| {
        let mut cells = vec![Cell::from(format!("{bound:e}"))];
        cells.extend(setting(quickest(rows, bound, |row| row.timed == Timed::RunAlone)));
        if with_peers {
            cells.extend(process_cells(rows, bound));
        }
        cells
    });
    table(&names, &cells)
}

fn quickest(
    rows: &[ToleranceRow],
    bound: f64,
    counts: impl Fn(&ToleranceRow) -> bool,
) -> Option<(&ToleranceRow, RunFigures)> {
    let within = |figures: &RunFigures| figures.time.is_some() && figures.error().is_some_and(|error| error <= bound);
    let rows = rows.iter().filter(|row| counts(row));
    let rows = rows.filter_map(|row| Some((row, *row.result.as_ref().ok().filter(|figures| within(figures))?)));
    rows.min_by(|(_, a), (_, b)| a.time.unwrap_or(f64::MAX).total_cmp(&b.time.unwrap_or(f64::MAX)))
}

fn setting(choice: Option<(&ToleranceRow, RunFigures)>) -> Vec<Cell> {
    let Some((row, figures)) = choice else { return vec![reason("no run", 4)] };
    let setting = format!("{}, tolerance {:e}", row.method, row.tolerance);
    vec![setting.into(), short(figures.error()), seconds(figures.time), count(figures.steps)]
}

/// The quickest peer and this program, whole process beside whole process.
fn process_cells(rows: &[ToleranceRow], bound: f64) -> Vec<Cell> {
    let quickest =
        |own: bool| quickest(rows, bound, |row| row.timed == Timed::WholeProcess && (row.program == PROGRAM) == own);
    let (peer, own) = (quickest(false), quickest(true));
    let ratio = peer.zip(own).and_then(|((_, peer), (_, own))| Some(peer.time? / own.time?));
    let ratio = ratio.map_or_else(|| NOTHING.into(), |ratio| format!("{ratio:.1}"));
    let cells = [peer, own].into_iter().flat_map(|choice| match choice {
        Some((row, figures)) => {
            vec![format!("{}, tolerance {:e}", row.name(), row.tolerance).into(), seconds(figures.time)]
        }
        None => vec![reason("no run", 2)],
    });
    cells.chain([number(ratio)]).collect()
}

/// The columns of errors, those that a scene has.
fn error_names(first: &'static str, reference: &Reference) -> Vec<&'static str> {
    std::iter::once(first).chain(QUANTITIES.into_iter().skip(1)).take(reference.shown()).collect()
}

const TOLERANCE_FIGURES: [&str; 8] = [
    "run time in s",
    "longest, above it",
    "timings",
    "steps",
    "rejected",
    "events",
    "Newton iterations",
    "energy residual",
];

fn runs(reference: &Reference, rows: &[ToleranceRow]) -> io::Result<String> {
    let figures = [&error_names("error of F_x", reference)[..], &TOLERANCE_FIGURES].concat();
    let own = ToleranceRow::from_reference(reference);
    let rows: Vec<&ToleranceRow> = rows.iter().chain([&own]).collect();
    let cells = |row: &&ToleranceRow| {
        let mut cells = vec![row.name().into(), number(format!("{:e}", row.tolerance))];
        match &row.result {
            Ok(figures) => cells.extend(figure_cells(figures, reference)),
            Err(why) => cells.push(reason(&why.to_string(), figures.len())),
        }
        cells
    };
    let names = head(&["method"], &[&["tolerance"], &figures[..]].concat());
    table(&names, &grouped(&rows, |row| row.name(), cells))
}

fn figure_cells(figures: &RunFigures, reference: &Reference) -> Vec<Cell> {
    let counts = [figures.steps, figures.rejected, figures.events, figures.iterations].map(count);
    let times = [seconds(figures.time), per_cent(figures.spread), count(figures.timings)];
    let cells = errors(&figures.errors, reference).chain(times).chain(counts);
    cells.chain([short(figures.residual)]).collect()
}

fn reference_text(reference: &Reference) -> String {
    let reduced = if reference.scene.solver.reduce > 0.0 { ", with all Maxwell elements" } else { "" };
    let run =
        format!("A run by the method <code>event</code> at the relative tolerance {:e}{reduced}.", reference.tolerance);
    match reference.check {
        Some(check) => {
            let own = in_words(&reference.own);
            format!(
                "{run} Its own error, the difference from a run at {check:e}, is {own}: the shaded area in the picture."
            )
        }
        None => format!("{run} No other run came to its end, so its own error is not known."),
    }
}

fn sensitivity(reference: &Reference) -> String {
    let found = &reference.sensitivity;
    let test = format!(
        "With the start of the carrier moved by {DISPLACEMENT:e} m along x, a run at the same tolerance differs from the \
         reference by {}",
        in_words(&found.differences)
    );
    let limit = found.limit;
    if reference.comparison.is_of_means() {
        format!(
            "<strong>The motion is sensitive.</strong> {test} of the largest value, more than {limit:.0e}: two runs as accurate \
             as these diverge, and single rows cannot be predicted. So means over windows are compared; what the moved start \
             changes in them counts as the reference's own error too."
        )
    } else {
        format!("{test}, less than {limit:.0e}: runs do not diverge and are compared row by row.")
    }
}

/// "2e-8 (F_x), 1e-9 (F_z)".
fn in_words(errors: &Errors) -> String {
    let named = QUANTITIES.iter().zip(errors).filter_map(|(name, error)| Some(format!("{:.0e} ({name})", (*error)?)));
    let named: Vec<String> = named.collect();
    if named.is_empty() { "nothing".into() } else { named.join(", ") }
}

const COMMUNICATION: &str = include_str!("communication.html");

/// The columns of a row of the table of communication steps.
fn communication_figures(reference: &Reference) -> Vec<&'static str> {
    let errors = ["error of F_x", "root mean square, F_x"].map(|first| error_names(first, reference));
    [errors.concat(), vec!["run time in s", "steps", "events"]].concat()
}

/// The section on communication steps, with its picture as SVG.
pub(in crate::report) fn communication(
    scene: &Scene,
    reference: &Reference,
    rows: &[CommunicationRow],
    picture: &str,
) -> io::Result<String> {
    let extrapolation = match scene.extrapolation {
        Extrapolation::Linear => {
            "with the rate of the step before, a prediction: where another value comes the step is done again, straight to it"
        }
        Extrapolation::Hold => {
            "to the value given, which it reaches at the end of the step, so that every kink is known one step late"
        }
    };
    let kinds = if reference.comparison.is_of_means() {
        ""
    } else {
        " Solid: the largest difference over the largest value; it does not fall where values alone show a kink too late. \
         Dashed: the root mean square."
    };
    let fields = [
        ("extrapolation", extrapolation.into()),
        ("tolerance", format!("{:e}", scene.solver.relative_tolerance)),
        ("method", method(scene)),
        ("picture", picture.into()),
        ("kinds", kinds.into()),
        ("table", communication_table(reference, rows)?),
    ];
    Ok(fill(COMMUNICATION, &fields))
}

fn communication_table(reference: &Reference, rows: &[CommunicationRow]) -> io::Result<String> {
    let names = head(&["a master gives"], &[&["step in s"], &communication_figures(reference)[..]].concat());
    table(&names, &grouped(rows, |row| row.given, |row| communication_cells(row, reference)))
}

fn communication_cells(row: &CommunicationRow, reference: &Reference) -> Vec<Cell> {
    let step = row.step.map_or_else(|| NOTHING.into(), |step| format!("{step:.3e}"));
    let mut cells = vec![row.given.name().into(), number(step)];
    match &row.result {
        Ok((figures, mean_squares)) => {
            cells.extend(errors(&figures.errors, reference));
            cells.extend(mean_squares.unwrap_or_default().into_iter().take(reference.shown()).map(short));
            cells.extend([seconds(figures.time), count(figures.steps), count(figures.events)]);
        }
        Err(why) => cells.push(reason(&why.to_string(), communication_figures(reference).len())),
    }
    cells
}
