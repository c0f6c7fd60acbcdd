//! ModelVariables: inputs, outputs and parameters, in the order of their value references.

use std::io;

use asperity::fmi::{Catalogue, Entry, Input, Kind, Subject};
use asperity::scene::{Unit, Value};

use super::model_description::{Xml, clean, real};
use super::units;

/// What a variable is, in a few words.
pub(super) fn description(entry: &Entry<'_>) -> String {
    match entry {
        Entry::Input(Input::U) => "Displacement of the carrier along x".into(),
        Entry::Input(Input::W) => "Displacement of the carrier along z, negative presses".into(),
        Entry::Output(_, variable) => variable.description.clone(),
        Entry::Parameter(parameter, _) => parameter.description(),
    }
}

/// The causality as the standard calls it.
pub(super) fn causality(entry: &Entry<'_>) -> &'static str {
    match entry {
        Entry::Input(_) => "input",
        Entry::Output(_, variable) if variable.is_output() => "output",
        Entry::Output(..) => "local",
        Entry::Parameter(..) => "parameter",
    }
}

/// Where a variable starts; what is calculated has no start.
pub(super) fn start(subject: &Subject, entry: &Entry<'_>) -> Option<String> {
    match entry {
        Entry::Input(_) => Some(real(0.0)),
        Entry::Output(..) => None,
        Entry::Parameter(parameter, _) => Some(match subject.parameter(*parameter) {
            Value::Real(value) => real(value),
            Value::Integer(value) => value.to_string(),
            Value::Text(value) => value,
        }),
    }
}

/// Writes `ModelVariables`.
pub(super) fn write(xml: &mut Xml, subject: &Subject, catalogue: &Catalogue) -> io::Result<()> {
    xml.create_element("ModelVariables").write_inner_content(|xml| {
        catalogue.entries().try_for_each(|(reference, entry)| scalar_variable(xml, subject, reference, &entry))
    })?;
    Ok(())
}

fn scalar_variable(xml: &mut Xml, subject: &Subject, reference: u32, entry: &Entry<'_>) -> io::Result<()> {
    xml.create_element("ScalarVariable")
        .with_attribute(("name", entry.name().as_str()))
        .with_attribute(("valueReference", reference.to_string().as_str()))
        .with_attribute(("description", clean(&description(entry)).as_str()))
        .with_attribute(("causality", causality(entry)))
        .with_attribute(("variability", variability(entry)))
        .with_attributes(initial(entry).map(|initial| ("initial", initial)))
        .write_inner_content(|xml| kind(xml, entry, start(subject, entry)))?;
    Ok(())
}

fn variability(entry: &Entry<'_>) -> &'static str {
    match entry {
        Entry::Parameter(..) => "fixed",
        _ if entry.kind() == Kind::Real => "continuous",
        _ => "discrete",
    }
}

/// The standard forbids it for inputs.
fn initial(entry: &Entry<'_>) -> Option<&'static str> {
    match entry {
        Entry::Input(_) => None,
        Entry::Output(..) => Some("calculated"),
        Entry::Parameter(..) => Some("exact"),
    }
}

fn kind(xml: &mut Xml, entry: &Entry<'_>, start: Option<String>) -> io::Result<()> {
    let unit = Some(units::of(entry)).filter(|_| entry.kind() == Kind::Real).map(Unit::name);
    xml.create_element(entry.kind().to_string())
        .with_attributes(unit.map(|unit| ("unit", unit)))
        .with_attributes(start.as_deref().map(|start| ("start", start)))
        .write_empty()
        .map(drop)
}
