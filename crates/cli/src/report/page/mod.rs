//! The page: one file that loads nothing from elsewhere, a section for each part of the report.

mod convergence;
mod judgement;
mod robustness;

use std::io;

use asperity::scene::Scene;
use asperity_study::summary::scene_rows;
use quick_xml::escape::escape;

use asperity_study::html::{Cell, fill, table};
use asperity_study::report::{Errors, Machine, Reference, build};

pub(super) use convergence::{communication, tolerances};
pub(super) use judgement::{SceneJudgements, judgements};
pub(super) use robustness::robustness;

const TEMPLATE: &str = include_str!("page.html");
const SCENE: &str = include_str!("scene.html");
/// Stands where there is no number.
const NOTHING: &str = "–";

/// The page of a scene.
pub(super) fn page(scene: &Scene, sections: &[String]) -> io::Result<String> {
    let rows = scene_rows(scene).into_iter().map(|(name, text)| vec![name.into(), text.into()]);
    let rows = table(&["", "What is there"].map(Cell::from), &rows.collect::<Vec<_>>())?;
    let sections = sections.concat() + &fill(SCENE, &[("scene", rows)]);
    let description = escape(scene.description.as_deref().unwrap_or_default());
    Ok(whole(&escape(&scene.name), &description, sections))
}

/// The page of several scenes: their names, each that of the folder with its page, and what they have in common.
pub(super) fn overview(scenes: &[String], sections: String) -> String {
    let link = |name: &String| {
        let name = escape(name.as_str());
        format!("<a href=\"{name}/index.html\">{name}</a>")
    };
    let links: Vec<String> = scenes.iter().map(link).collect();
    whole(&format!("{} scenes", scenes.len()), &links.join(", "), sections)
}

fn whole(name: &str, description: &str, sections: String) -> String {
    let fields = [
        ("name", name.to_owned()),
        ("description", description.to_owned()),
        ("build", build()),
        ("machine", escape(Machine::here().in_words()).into_owned()),
        ("sections", sections),
    ];
    fill(TEMPLATE, &fields)
}

/// The head of a table: names of text columns, then of columns of numbers.
fn head(texts: &[&str], numbers: &[&str]) -> Vec<Cell> {
    let texts = texts.iter().map(|&name| Cell::from(name));
    texts.chain(numbers.iter().map(|&name| number(name))).collect()
}

fn number(text: impl Into<String>) -> Cell {
    Cell { class: "number".into(), ..Cell::from(text) }
}

/// The cells of rows; those of the same `group` follow one another.
fn grouped<T, G: PartialEq>(rows: &[T], group: impl Fn(&T) -> G, cells: impl Fn(&T) -> Vec<Cell>) -> Vec<Vec<Cell>> {
    let groups = rows.chunk_by(|a, b| group(a) == group(b)).enumerate();
    let rows = groups.flat_map(|(i, rows)| rows.iter().enumerate().map(move |(j, row)| (i > 0 && j == 0, row)));
    let mark = |(begins, row): (bool, &T)| {
        let mut cells = cells(row);
        if begins {
            cells.iter_mut().for_each(|cell| cell.class.push_str(" group"));
        }
        cells
    };
    rows.map(mark).collect()
}

/// A number with two digits, or nothing.
fn short(value: Option<f64>) -> Cell {
    number(value.map_or_else(|| NOTHING.into(), |value| format!("{value:.1e}")))
}

fn count(value: Option<u64>) -> Cell {
    number(value.map_or_else(|| NOTHING.into(), |count| count.to_string()))
}

/// A time with three digits, or nothing.
fn seconds(value: Option<f64>) -> Cell {
    number(value.map_or_else(|| NOTHING.into(), three_digits))
}

/// A share in per cent, or nothing.
fn per_cent(value: Option<f64>) -> Cell {
    number(value.map_or_else(|| NOTHING.into(), |share| format!("{:.0} %", 100.0 * share)))
}

/// Errors; those below the reference's own are marked.
fn errors(errors: &Errors, reference: &Reference) -> impl Iterator<Item = Cell> {
    errors.iter().zip(reference.below(errors)).take(reference.shown()).map(|(&error, below)| {
        let cell = short(error);
        if below { Cell { text: format!("{} *", cell.text), class: "number below".into(), ..cell } } else { cell }
    })
}

/// Why there are no figures, over the `span` columns that they would fill.
fn reason(text: &str, span: usize) -> Cell {
    Cell { class: "reason".into(), span, ..Cell::from(text) }
}

/// Three digits, with an exponent where the number is far from 1.
fn three_digits(value: f64) -> String {
    if value == 0.0 || !(1e-3..1e4).contains(&value) {
        return format!("{value:.2e}");
    }
    let digits = (2.0 - value.log10().floor()).max(0.0) as usize;
    format!("{value:.digits$}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_have_three_digits() {
        let written = [0.01234, 3.0, 123.4, 5678.0, 4.5e-7].map(three_digits);
        assert_eq!(written, ["0.0123", "3.00", "123", "5678", "4.50e-7"]);
    }
}
