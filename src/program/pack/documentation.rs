//! documentation/index.html: what is packed, what is left out, its variables, its parameters, the equations.

use std::io;

use asperity::fmi::{Catalogue, Entry, Kind, Subject};
use quick_xml::escape::escape;

use super::model_description::clean;
use super::parts::{ELEMENT_PAGE, PAGE};
use super::{units, variables};
use crate::program::html::{self, Cell};
use crate::program::text::Row;

/// The page, filled in.
pub(super) fn write(subject: &Subject, catalogue: &Catalogue, said: &[Row]) -> io::Result<Vec<u8>> {
    let page = if matches!(subject, Subject::Element(_)) { ELEMENT_PAGE } else { PAGE };
    let rows: Vec<_> = said.iter().map(|(name, text)| [(*name).into(), clean(text)]).collect();
    let fields = [
        ("name", escape(clean(&subject.name())).into_owned()),
        ("description", escape(clean(&subject.description())).into_owned()),
        ("version", env!("CARGO_PKG_VERSION").to_owned()),
        ("scene", table(["", "What is there"], &rows)?),
        ("variables", table(["Name", "Causality", "Unit", "Description"], &variable_rows(catalogue))?),
        ("parameters", table(["Name", "Start", "Unit", "Description"], &parameter_rows(subject, catalogue))?),
    ];
    Ok(html::fill(page, &fields).into_bytes())
}

fn variable_rows(catalogue: &Catalogue) -> Vec<[String; 4]> {
    let entries = catalogue.entries().map(|(_, entry)| entry).filter(|entry| !is_parameter(entry));
    entries.map(|entry| row(&entry, variables::causality(&entry).into())).collect()
}

fn parameter_rows(subject: &Subject, catalogue: &Catalogue) -> Vec<[String; 4]> {
    let entries = catalogue.entries().map(|(_, entry)| entry).filter(is_parameter);
    entries.map(|entry| row(&entry, variables::start(subject, &entry).unwrap_or_default())).collect()
}

fn is_parameter(entry: &Entry<'_>) -> bool {
    matches!(entry, Entry::Parameter(..))
}

fn row(entry: &Entry<'_>, second: String) -> [String; 4] {
    let unit = if entry.kind() == Kind::Real { units::of(entry).name() } else { "" };
    [entry.name(), second, unit.into(), variables::description(entry)]
}

fn table<const N: usize>(head: [&str; N], rows: &[[String; N]]) -> io::Result<String> {
    let rows: Vec<Vec<Cell>> = rows.iter().map(|cells| cells.iter().map(Cell::from).collect()).collect();
    html::table(&head.map(Cell::from), &rows)
}
