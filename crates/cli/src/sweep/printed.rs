//! The friction of a table as lines of text: a line for each speed, a column for each load, a block for each
//! temperature.

use asperity::element::{PointStatus, Quantity};

use crate::terminal::{LabelledLine, labelled};
use asperity_study::decimals::{as_given, rounded, with_prefix};
use asperity_study::sweep::{SweepRow, SweepTable};

/// Most speeds and most loads that are printed: a terminal's worth.
const MOST: (usize, usize) = (60, 7);
/// Characters of a column.
const WIDTH: usize = 12;
/// Behind friction that cannot be relied on, ...
const NOT_STEADY: char = '*';
/// ... and behind that of full contact.
const FULL_CONTACT: char = '+';

/// Friction over speed and load; none of a table too large to be read in a terminal.
pub(super) fn lines(table: &SweepTable) -> Vec<LabelledLine> {
    let (grid, unit) = (&table.header.grid, table.header.load.unit());
    if grid.speeds.len() > MOST.0 || grid.loads.len() > MOST.1 {
        return Vec::new();
    }
    let temperatures: Vec<Option<f64>> = match grid.temperatures.as_slice() {
        [] => vec![None],
        values => values.iter().copied().map(Some).collect(),
    };
    let mut texts: Vec<String> = Vec::new();
    for temperature in temperatures {
        let of_block = || table.rows.iter().filter(move |row| row.point.temperature == temperature);
        let title = temperature.map_or_else(|| "speed".to_owned(), |kelvin| format!("{kelvin} K"));
        texts.push(columns(title, grid.loads.iter().map(|&load| as_given(load, unit))));
        for &speed in &grid.speeds {
            let friction = |&load: &f64| {
                let found = of_block().find(|row| row.point.speed == speed && row.point.load == load);
                found.map_or_else(String::new, friction)
            };
            texts.push(columns(with_prefix(speed, speed, "m/s"), grid.loads.iter().map(friction)));
        }
    }
    let has = |status: fn(&PointStatus) -> bool| table.rows.iter().any(|row| status(&row.status));
    if has(|status| !status.is_result()) {
        texts.push(format!("{NOT_STEADY} not steady"));
    }
    if has(|status| *status == PointStatus::FullContact) {
        texts.push(format!("{FULL_CONTACT} full contact: friction and area, but no stiffness, so no element"));
    }
    labelled("Friction", texts)
}

fn friction(row: &SweepRow) -> String {
    let value = row.value(Quantity::Friction).map_or_else(|| "-".to_owned(), |value| rounded(value, 4).to_string());
    match row.status {
        PointStatus::Steady => value,
        PointStatus::FullContact => format!("{value}{FULL_CONTACT}"),
        PointStatus::Problem(_) => format!("{value}{NOT_STEADY}"),
    }
}

fn columns(first: String, others: impl Iterator<Item = String>) -> String {
    let columns: String = others.map(|text| format!("{text:<WIDTH$}")).collect();
    format!("{first:<WIDTH$}{columns}").trim_end().to_owned()
}
