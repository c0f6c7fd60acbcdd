//! `asperity plot`: columns of result files and tables over another one, a panel for each unit.

mod difference;
mod selection;

use asperity_study::picture::{Axis, Fit, Mark, Panel, Picture, xs, ys};

use super::files::{check_outputs, named, print_beside};
use super::picture;
use super::terminal::{lines, note};
use difference::Comparison;
pub(crate) use selection::{Plot, PlotError};
use selection::{PlotAxis, Selection};

/// Width of what the axes enclose and its height, and that of each of several, pixels.
const WIDTH: f64 = 894.0;
const HEIGHT: f64 = 520.0;
const HEIGHT_OF_SEVERAL: f64 = 290.0;

/// The columns of one unit, with the points of each file.
#[derive(Debug)]
struct UnitPanel<'a> {
    unit: String,
    columns: Vec<&'a str>,
    marks: Vec<Mark>,
}

/// Draws one line for each file and y, and a chart for each unit; of two files that are compared their difference too.
pub(crate) fn plot_files(command: &Plot) -> Result<(), PlotError> {
    if !command.labels.is_empty() && command.labels.len() != command.files.len() {
        return Err(PlotError::Labels { labels: command.labels.len(), files: command.files.len() });
    }
    check_outputs([&command.output], command.files.clone())?;
    let files = command.files.iter().map(|path| Selection::read(path, command)).collect::<Result<Vec<_>, _>>()?;
    let comparison = match command.compare {
        true => Some(Comparison::new(command, &files, [0, 1].map(|i| file_name(command, i)))?),
        false => None,
    };
    let worst = comparison.as_ref().map(|comparison| comparison.worst().to_owned());
    let drawn = if command.y.is_empty() { worst.as_slice() } else { &command.y };
    let panels = panels(command, &files, drawn)?;
    let title = command.title.clone().unwrap_or_default();
    let panels = drawn_panels(command, &files[0].unit(&command.x)?, panels, comparison.as_ref());
    let height = if let [_] = panels[..] { HEIGHT } else { HEIGHT_OF_SEVERAL };
    let rows = panels.into_iter().map(|panel| panel.sized(WIDTH, height).into()).collect();
    picture::write(&Picture::of(rows).titled(title), &command.output)?;
    if let Some(comparison) = comparison {
        let mut text = comparison.text();
        text.push(("Written", named(&command.output)));
        print_beside([&command.output], &lines(&text))?;
    } else {
        note(&format!("{} is written", named(&command.output)));
    }
    Ok(())
}

/// The curves of the columns `drawn`, those of a unit together.
fn panels<'a>(command: &Plot, files: &[Selection<'_>], drawn: &'a [String]) -> Result<Vec<UnitPanel<'a>>, PlotError> {
    let mut panels: Vec<UnitPanel<'_>> = Vec::new();
    for column in drawn {
        let unit = files[0].unit(column)?;
        match panels.iter_mut().find(|panel| panel.unit == unit) {
            Some(panel) => panel.columns.push(column),
            None => panels.push(UnitPanel { unit, columns: vec![column], marks: Vec::new() }),
        }
    }
    for panel in &mut panels {
        let curves =
            files.iter().enumerate().flat_map(|(i, file)| panel.columns.iter().map(move |column| (i, file, column)));
        for (look, (i, file, column)) in curves.collect::<Vec<_>>().into_iter().enumerate() {
            let name = curve_name(command, i, column, &panel.columns);
            panel.marks.extend(file.curve(command, column, &name, look)?);
        }
    }
    Ok(panels)
}

/// What a file is called: its label or its name.
fn file_name(command: &Plot, index: usize) -> String {
    let stem = || command.files.get(index)?.file_stem().map(|stem| stem.to_string_lossy().into_owned());
    command.labels.get(index).cloned().or_else(stem).unwrap_or_default()
}

/// The name of a curve among those of the `columns` of its chart.
fn curve_name(command: &Plot, index: usize, column: &str, columns: &[&str]) -> String {
    let file = file_name(command, index);
    match (columns.len(), command.files.len()) {
        (_, 1) if command.y.len() > 1 => column.to_owned(),
        (1, _) => file,
        _ => format!("{file}: {column}"),
    }
}

/// Each panel and below it one of the differences, all over the same axis.
fn drawn_panels(
    command: &Plot,
    x_unit: &str,
    panels: Vec<UnitPanel<'_>>,
    comparison: Option<&Comparison>,
) -> Vec<Panel> {
    let x = panels.iter().flat_map(|panel| xs(&panel.marks)).collect::<Vec<_>>();
    let x = axis(command, PlotAxis::X, (&command.x, x_unit), x);
    let drawn = |panel: UnitPanel<'_>| {
        let quantity = format!("{}{}", if command.negate { "-" } else { "" }, panel.columns.join(", "));
        let y = axis(command, PlotAxis::Y, (&quantity, &panel.unit), ys(&panel.marks).collect());
        let difference = comparison.map(|comparison| comparison.panel(&panel.columns, &x));
        std::iter::once(Panel::new(x.clone(), y, panel.marks)).chain(difference)
    };
    panels.into_iter().flat_map(drawn).collect()
}

fn axis(command: &Plot, which: PlotAxis, of: (&str, &str), values: Vec<f64>) -> Axis {
    if command.log.contains(&which) {
        return Axis::logarithmic(of, values);
    }
    Axis::linear(of, values, if which == PlotAxis::X { Fit::Tight } else { Fit::Round })
}
