//! The section on errors and communication steps.

use std::io;

use asperity::scene::{Extrapolation, Parameter, Scene};

use super::{begin_group, count, errors, head, number, reason, seconds, short};
use crate::program::html::{Cell, fill, table};
use crate::program::report::Parts;
use crate::program::report::communication::Row;
use crate::program::report::reference::Reference;

const TEMPLATE: &str = include_str!("communication.html");

const FIGURES: [&str; 9] =
    ["error of F_x", "F_z", "E_diss", "root mean square, F_x", "F_z", "E_diss", "run time in s", "steps", "events"];

/// The section, with the text of its picture.
pub(in crate::program::report) fn section(scene: &Scene, parts: &Parts, picture: &str) -> io::Result<String> {
    let extrapolation = match scene.extrapolation {
        Extrapolation::Linear => "on as it came",
        Extrapolation::Hold => "to the value given, reached at the end of the step",
    };
    let kinds = if parts.reference.comparison.is_of_means() {
        ""
    } else {
        " Solid: the largest difference over the largest value, which at a kink that a master's values tell of too late does \
         not fall; dashed: the root mean square."
    };
    let method = scene.parameter(Parameter::Method).to_string().replace('"', "");
    let fields = [
        ("extrapolation", extrapolation.into()),
        ("tolerance", format!("{:e}", scene.solver.relative_tolerance)),
        ("method", method),
        ("picture", picture.into()),
        ("kinds", kinds.into()),
        ("table", rows(parts)?),
    ];
    Ok(fill(TEMPLATE, &fields))
}

fn rows(parts: &Parts) -> io::Result<String> {
    let rows = &parts.communication;
    let cells = rows.iter().enumerate().map(|(i, row)| {
        let mut cells = row_cells(row, &parts.reference);
        if i > 0 && row.given != rows[i - 1].given {
            begin_group(&mut cells);
        }
        cells
    });
    table(&head(&["a master gives"], &[&["step in s"], &FIGURES[..]].concat()), &cells.collect::<Vec<_>>())
}

fn row_cells(row: &Row, reference: &Reference) -> Vec<Cell> {
    let step = row.step.map_or_else(|| super::NOTHING.into(), |step| format!("{step:.3e}"));
    let mut cells = vec![row.given.name().into(), number(step)];
    match &row.result {
        Ok((figures, mean_square)) => {
            cells.extend(errors(&figures.errors, reference.below(&figures.errors)));
            cells.extend(mean_square.unwrap_or_default().map(short));
            cells.extend([seconds(figures.time), count(figures.steps), count(figures.events)]);
        }
        Err(why) => cells.push(reason(why, FIGURES.len())),
    }
    cells
}
