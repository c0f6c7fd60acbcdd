//! `asperity plot`: columns of result files in one chart.

use std::path::Path;

use asperity::outputs::unit_of;

use super::axis::{Axis, Fit};
use super::chart::{Chart, Curve, Stroke};
use super::{Backend, Canvas, DrawResult, Figure};
use crate::program::cli::Plot;
use crate::program::files::{FileError, check_output};
use crate::program::result_file::{ResultFile, ResultFileError};
use crate::program::terminal::warn;

/// `asperity plot` failed.
#[derive(Debug, thiserror::Error)]
pub(crate) enum PlotError {
    #[error(transparent)]
    File(#[from] FileError),
    #[error(transparent)]
    ResultFile(#[from] ResultFileError),
    #[error("--labels: expected {files}, one name for each file, found {labels}")]
    Labels { labels: usize, files: usize },
}

/// A chart with a title above.
#[derive(Debug)]
struct TitledChart {
    title: String,
    chart: Chart,
}

impl Figure for TitledChart {
    fn size(&self) -> (u32, u32) {
        (1000, 620)
    }

    fn title(&self) -> &str {
        &self.title
    }

    fn draw<B: Backend>(&self, canvas: &Canvas<B>) -> DrawResult {
        self.chart.draw_with_legend(canvas)
    }
}

/// Draws one line for each file and y.
pub(crate) fn plot_files(command: &Plot) -> Result<(), PlotError> {
    if !command.labels.is_empty() && command.labels.len() != command.files.len() {
        return Err(PlotError::Labels { labels: command.labels.len(), files: command.files.len() });
    }
    check_output(&command.output, &command.files)?;
    let mut curves = Vec::new();
    for (i, path) in command.files.iter().enumerate() {
        add_curves(&mut curves, command, i, path)?;
    }
    let title = command.title.clone().unwrap_or_default();
    TitledChart { title, chart: chart(command, curves) }.write(&command.output)?;
    Ok(())
}

fn add_curves(curves: &mut Vec<Curve>, command: &Plot, index: usize, path: &Path) -> Result<(), PlotError> {
    let file = ResultFile::read(path)?;
    let x = file.column(&command.x)?;
    let first = if command.from_motion { last_before_motion(&x) } else { 0 };
    let sign = if command.negate { -1.0 } else { 1.0 };
    for column in &command.y {
        let y = file.column(column)?;
        let points: Vec<_> = x.iter().zip(&y).skip(first).map(|(&x, &y)| (x, sign * y)).collect();
        let name = curve_name(command, index, path, column);
        if !points.iter().any(|(x, y)| x.is_finite() && y.is_finite()) {
            warn(&format!("{}: nothing to draw of {column}: it has no finite numbers", path.display()));
        }
        curves.push(Curve { name, look: curves.len(), stroke: Stroke::Line, points });
    }
    Ok(())
}

/// The last row before x changes for the first time.
fn last_before_motion(x: &[f64]) -> usize {
    x.iter().position(|value| *value != x[0]).map_or(0, |moved| moved - 1)
}

fn curve_name(command: &Plot, index: usize, path: &Path, column: &str) -> String {
    let stem = || path.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
    let file = command.labels.get(index).cloned().unwrap_or_else(stem);
    match (command.y.len(), command.files.len()) {
        (1, _) => file,
        (_, 1) => column.to_owned(),
        _ => format!("{file}: {column}"),
    }
}

fn chart(command: &Plot, curves: Vec<Curve>) -> Chart {
    let points = || curves.iter().flat_map(|curve| &curve.points);
    let quantity = format!("{}{}", if command.negate { "-" } else { "" }, command.y.join(", "));
    Chart {
        title: String::new(),
        x: Axis::linear(&command.x, unit(&command.x), points().map(|point| point.0), Fit::Tight),
        y: Axis::linear(&quantity, unit(&command.y[0]), points().map(|point| point.1), Fit::Round),
        curves,
    }
}

/// The unit of a column; empty for a plain number or an unknown column.
fn unit(column: &str) -> &'static str {
    match column {
        "time" => "s",
        "u" | "w" => "m",
        "load" | "pull" => "N",
        "temperature" => "K",
        _ => unit_of(column).map(|unit| unit.name()).filter(|&name| name != "1").unwrap_or_default(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_starts_where_its_x_begins_to_change() {
        assert_eq!(last_before_motion(&[0.0, 0.0, 0.0, 1.0]), 2);
        assert_eq!(last_before_motion(&[0.0, 1.0]), 0);
        assert_eq!(last_before_motion(&[0.0, 0.0]), 0);
    }

    #[test]
    fn columns_have_the_units_of_their_variables() {
        assert_eq!(
            [unit("u"), unit("F_x"), unit("element[12].z"), unit("contact.count"), unit("?")],
            ["m", "N", "m", "", ""]
        );
    }
}
