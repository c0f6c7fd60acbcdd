//! documentation/index.html: what the scene is, its variables, its parameters, the equations.

use std::io;

use asperity::outputs::variables;
use asperity::scene::{Scene, Unit, Value};
use quick_xml::Writer;
use quick_xml::escape::escape;
use quick_xml::events::BytesText;

use super::model_description::{Xml, clean, real};
use super::parts::PAGE;

/// Fills the page in: `{{name}}`, `{{description}}`, `{{variables}}` and `{{parameters}}` stand for what they say.
pub(super) fn write(scene: &Scene) -> io::Result<Vec<u8>> {
    let description = clean(scene.description.as_deref().unwrap_or_default());
    let fields = [
        ("{{name}}", escape(clean(&scene.name)).into_owned()),
        ("{{description}}", escape(description).into_owned()),
        ("{{version}}", env!("CARGO_PKG_VERSION").to_owned()),
        ("{{variables}}", table(&["Name", "Causality", "Unit", "Description"], &variable_rows(scene))?),
        ("{{parameters}}", table(&["Name", "Start", "Unit", "Description"], &parameter_rows(scene))?),
    ];
    Ok(fields.iter().fold(PAGE.to_owned(), |page, (field, text)| page.replace(field, text)).into_bytes())
}

fn variable_rows(scene: &Scene) -> Vec<[String; 4]> {
    let inputs = [("u", "Displacement of the carrier along x"), ("w", "Displacement of the carrier along z")];
    let inputs = inputs.map(|(name, text)| [name.into(), "input".into(), "m".into(), text.into()]);
    let outputs = variables(scene).into_iter().map(|variable| {
        let causality = if super::variables::is_output(&variable) { "output" } else { "local" };
        [variable.name, causality.into(), unit(variable.unit), variable.description]
    });
    inputs.into_iter().chain(outputs).collect()
}

fn parameter_rows(scene: &Scene) -> Vec<[String; 4]> {
    let row = |parameter: asperity::scene::Parameter| {
        let (start, unit) = match scene.parameter(parameter) {
            Value::Real(value) => (real(value), unit(parameter.unit())),
            Value::Integer(value) => (value.to_string(), String::new()),
            Value::Text(value) => (value, String::new()),
        };
        [parameter.name(), start, unit, parameter.description()]
    };
    scene.parameters().into_iter().map(row).collect()
}

fn unit(unit: Unit) -> String {
    unit.name().to_owned()
}

fn table(head: &[&str], rows: &[[String; 4]]) -> io::Result<String> {
    let mut html = Writer::new_with_indent(Vec::new(), b' ', 1);
    html.create_element("table").write_inner_content(|html| {
        row(html, "th", head.iter().copied())?;
        rows.iter().try_for_each(|cells| row(html, "td", cells.iter().map(String::as_str)))
    })?;
    String::from_utf8(html.into_inner()).map_err(io::Error::other)
}

fn row<'a>(html: &mut Xml, cell: &str, mut texts: impl Iterator<Item = &'a str>) -> io::Result<()> {
    html.create_element("tr").write_inner_content(|html| {
        texts.try_for_each(|text| html.create_element(cell).write_text_content(BytesText::new(text)).map(drop))
    })?;
    Ok(())
}
