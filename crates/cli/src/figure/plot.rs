//! `asperity plot`: columns of result files and tables over another one, a chart for each unit.

use super::axis::{Axis, Fit};
use super::chart::{Chart, Curve};
use super::difference::Comparison;
use super::selection::{PlotError, Selection};
use super::{Backend, Canvas, DrawResult, Figure};
use crate::cli::{Plot, PlotAxis};
use crate::files::{check_outputs, named, print_beside};
use crate::terminal::{lines, note};

/// Width of the figure and height of one chart, and of each of several, pixels.
const WIDTH: u32 = 1000;
const HEIGHT: u32 = 620;
const HEIGHT_OF_SEVERAL: u32 = 380;

/// Charts below each other over the same horizontal axis, with a title above.
#[derive(Debug)]
struct Charts {
    title: String,
    charts: Vec<Chart>,
}

impl Figure for Charts {
    fn size(&self) -> (u32, u32) {
        let height = if let [_] = self.charts[..] { HEIGHT } else { HEIGHT_OF_SEVERAL * self.charts.len() as u32 };
        (WIDTH, height)
    }

    fn title(&self) -> &str {
        &self.title
    }

    fn draw<B: Backend>(&self, canvas: &Canvas<B>) -> DrawResult {
        let canvases = canvas.split_evenly((self.charts.len(), 1));
        self.charts.iter().zip(&canvases).try_for_each(|(chart, canvas)| chart.draw_with_legend(canvas))
    }
}

/// The columns of one unit, with the points of each file.
#[derive(Debug)]
struct UnitPanel<'a> {
    unit: String,
    columns: Vec<&'a str>,
    curves: Vec<Curve>,
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
    let charts = charts(command, &files[0].unit(&command.x)?, panels, comparison.as_ref());
    Charts { title, charts }.write(&command.output)?;
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
            None => panels.push(UnitPanel { unit, columns: vec![column], curves: Vec::new() }),
        }
    }
    for panel in &mut panels {
        for (i, file) in files.iter().enumerate() {
            for column in &panel.columns {
                let (name, look) = (curve_name(command, i, column, &panel.columns), panel.curves.len());
                panel.curves.push(file.curve(command, column, name, look)?);
            }
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

/// A chart for each panel and below it one of the differences.
fn charts(command: &Plot, x_unit: &str, panels: Vec<UnitPanel<'_>>, comparison: Option<&Comparison>) -> Vec<Chart> {
    let x = panels.iter().flat_map(|panel| &panel.curves).flat_map(|curve| &curve.points).map(|point| point.0);
    let x = axis(command, PlotAxis::X, &command.x, x_unit, x);
    let chart = |panel: UnitPanel<'_>| {
        let quantity = format!("{}{}", if command.negate { "-" } else { "" }, panel.columns.join(", "));
        let y = panel.curves.iter().flat_map(|curve| &curve.points).map(|point| point.1);
        let y = axis(command, PlotAxis::Y, &quantity, &panel.unit, y);
        let difference = comparison.map(|comparison| comparison.chart(&panel.columns, &x));
        let chart = Chart { title: String::new(), x: x.clone(), y, curves: panel.curves };
        std::iter::once(chart).chain(difference)
    };
    panels.into_iter().flat_map(chart).collect()
}

fn axis(command: &Plot, which: PlotAxis, quantity: &str, unit: &str, values: impl Iterator<Item = f64>) -> Axis {
    if command.log.contains(&which) {
        let title = if unit.is_empty() { quantity.to_owned() } else { format!("{quantity} in {unit}") };
        return Axis::logarithmic(&title, values);
    }
    Axis::linear(quantity, unit, values, if which == PlotAxis::X { Fit::Tight } else { Fit::Round })
}
