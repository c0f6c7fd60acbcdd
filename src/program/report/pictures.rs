//! The pictures: errors over run time and over the communication step.

use super::communication::{self, Given};
use super::ladder::{PROGRAM, Row};
use super::reference::Reference;
use super::trace::{Errors, QUANTITIES};
use crate::program::figure::{Ladder, LadderPanel, Ladders, Rung};

/// Errors over run time, one line for each program and method.
pub(super) fn errors(reference: &Reference, rows: &[Row]) -> Ladders {
    let mut names: Vec<(&str, &str)> = Vec::new();
    for row in rows {
        let name = (row.program.as_str(), row.method.as_str());
        if !names.contains(&name) {
            names.push(name);
        }
    }
    let ladder = |(look, &(program, method)): (usize, &(&str, &str)), quantity: usize| {
        let own = rows.iter().filter(|row| row.program == program && row.method == method);
        let rungs: Vec<Rung> = own.filter_map(|row| rung(row, quantity)).collect();
        let name = if program == PROGRAM { method.to_owned() } else { format!("{program} {method}") };
        let dashed = program != PROGRAM;
        Ladder { name, dashed, look, rungs: with_end_labels(rungs) }
    };
    let panels = panels(reference, |quantity| {
        names.iter().enumerate().map(|name| ladder(name, quantity)).filter(|ladder| !ladder.rungs.is_empty()).collect()
    });
    Ladders { x_title: "run time in s".into(), panels }
}

fn rung(row: &Row, quantity: usize) -> Option<Rung> {
    let figures = row.result.as_ref().ok()?;
    Some(Rung { x: figures.time?, y: figures.errors[quantity]?, label: format!("{:e}", row.tolerance) })
}

/// The tolerances of the first and the last rung alone: those between are powers of ten.
fn with_end_labels(mut rungs: Vec<Rung>) -> Vec<Rung> {
    let last = rungs.len().saturating_sub(1);
    rungs.iter_mut().enumerate().filter(|(i, _)| *i != 0 && *i != last).for_each(|(_, rung)| rung.label.clear());
    rungs
}

/// Errors over the communication step: the largest and, dashed, the root mean squares.
pub(super) fn communication(reference: &Reference, rows: &[communication::Row]) -> Ladders {
    let panels = panels(reference, |quantity| {
        let of = |given: Given, look: usize, mean_square: bool| {
            let pick = |row: &communication::Row| {
                let (figures, mean_squares) = row.result.as_ref().ok()?;
                let errors: Errors = if mean_square { (*mean_squares)? } else { figures.errors };
                Some(Rung { x: row.step?, y: errors[quantity]?, label: String::new() })
            };
            let kind = if mean_square { ", root mean square" } else { "" };
            Ladder {
                name: format!("{}{kind}", given.name()),
                dashed: mean_square,
                look,
                rungs: rows.iter().filter(|row| row.given == given).filter_map(pick).collect(),
            }
        };
        let lines =
            [(Given::Rates, 0, false), (Given::Rates, 0, true), (Given::Values, 1, false), (Given::Values, 1, true)];
        let ladders = lines.map(|(given, look, mean_square)| of(given, look, mean_square));
        ladders.into_iter().filter(|ladder| !ladder.rungs.is_empty()).collect()
    });
    Ladders { x_title: "communication step in s".into(), panels }
}

/// One panel for each quantity that the scene has; if it has none, an empty one of F_z.
fn panels(reference: &Reference, ladders: impl Fn(usize) -> Vec<Ladder>) -> Vec<LadderPanel> {
    let there = (0..QUANTITIES.len()).filter(|&quantity| reference.own[quantity].is_some());
    let mut shown: Vec<usize> = there.collect();
    if shown.is_empty() {
        shown.push(1);
    }
    let panel = |quantity: usize| LadderPanel {
        title: title(quantity, reference.comparison.is_of_means()),
        floor: reference.own[quantity].filter(|own| own.is_finite()),
        ladders: ladders(quantity),
    };
    shown.into_iter().map(panel).collect()
}

fn title(quantity: usize, of_means: bool) -> String {
    let name = QUANTITIES[quantity];
    if of_means && quantity < 2 { format!("error of {name}, means") } else { format!("error of {name}") }
}
