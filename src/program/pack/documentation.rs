//! documentation/index.html: what the scene is, what is left out, its variables, its parameters, the equations.

use std::io;

use asperity::fmi::{Catalogue, Entry, Kind};
use asperity::scene::Scene;
use quick_xml::Writer;
use quick_xml::escape::escape;
use quick_xml::events::BytesText;

use super::model_description::{Xml, clean};
use super::parts::PAGE;
use super::{units, variables};
use crate::program::describe;

/// Fills the page in: `{{name}}`, `{{scene}}`, `{{variables}}` and the like stand for what they say.
pub(super) fn write(scene: &Scene, catalogue: &Catalogue) -> io::Result<Vec<u8>> {
    let description = clean(scene.description.as_deref().unwrap_or_default());
    let fields = [
        ("{{name}}", escape(clean(&scene.name)).into_owned()),
        ("{{description}}", escape(description).into_owned()),
        ("{{version}}", env!("CARGO_PKG_VERSION").to_owned()),
        ("{{scene}}", table(&["", "What is there"], &scene_rows(scene))?),
        ("{{variables}}", table(&["Name", "Causality", "Unit", "Description"], &variable_rows(catalogue))?),
        ("{{parameters}}", table(&["Name", "Start", "Unit", "Description"], &parameter_rows(scene, catalogue))?),
    ];
    Ok(fields.iter().fold(PAGE.to_owned(), |page, (field, text)| page.replace(field, text)).into_bytes())
}

fn scene_rows(scene: &Scene) -> Vec<[String; 2]> {
    describe::rows(scene).into_iter().map(|(name, text)| [name.into(), clean(&text)]).collect()
}

fn variable_rows(catalogue: &Catalogue) -> Vec<[String; 4]> {
    let entries = catalogue.entries().map(|(_, entry)| entry).filter(|entry| !is_parameter(entry));
    entries.map(|entry| row(&entry, variables::causality(&entry).into())).collect()
}

fn parameter_rows(scene: &Scene, catalogue: &Catalogue) -> Vec<[String; 4]> {
    let entries = catalogue.entries().map(|(_, entry)| entry).filter(is_parameter);
    entries.map(|entry| row(&entry, variables::start(scene, &entry).unwrap_or_default())).collect()
}

fn is_parameter(entry: &Entry<'_>) -> bool {
    matches!(entry, Entry::Parameter(..))
}

fn row(entry: &Entry<'_>, second: String) -> [String; 4] {
    let unit = if entry.kind() == Kind::Real { units::of(entry).name() } else { "" };
    [entry.name(), second, unit.into(), variables::description(entry)]
}

fn table<const N: usize>(head: &[&str; N], rows: &[[String; N]]) -> io::Result<String> {
    let mut html = Writer::new_with_indent(Vec::new(), b' ', 1);
    html.create_element("table").write_inner_content(|html| {
        table_row(html, "th", head.iter().copied())?;
        rows.iter().try_for_each(|cells| table_row(html, "td", cells.iter().map(String::as_str)))
    })?;
    String::from_utf8(html.into_inner()).map_err(io::Error::other)
}

fn table_row<'a>(html: &mut Xml, cell: &str, mut texts: impl Iterator<Item = &'a str>) -> io::Result<()> {
    html.create_element("tr").write_inner_content(|html| {
        texts.try_for_each(|text| html.create_element(cell).write_text_content(BytesText::new(text)).map(drop))
    })?;
    Ok(())
}
