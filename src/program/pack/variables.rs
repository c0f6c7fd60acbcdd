//! ModelVariables: inputs, outputs and parameters. Value references count them from 0 in their order.

use std::io;

use asperity::outputs::{Kind, Variable};
use asperity::scene::{OutputGroup, Parameter, Scene, Unit, Value};
use quick_xml::writer::ElementWriter;

use super::model_description::{Xml, clean, real};

const INPUTS: [(&str, &str); 2] =
    [("u", "Displacement of the carrier along x"), ("w", "Displacement of the carrier along z, negative presses")];

/// Whether a variable is an output of the unit; the fields of the elements are local.
pub(super) fn is_output(variable: &Variable) -> bool {
    variable.group != OutputGroup::Elements
}

/// Writes `ModelVariables`.
pub(super) fn write(xml: &mut Xml, scene: &Scene, variables: &[Variable], parameters: &[Parameter]) -> io::Result<()> {
    xml.create_element("ModelVariables").write_inner_content(|xml| {
        let mut references = 0..;
        let mut next = || references.next().unwrap_or(u32::MAX);
        INPUTS.iter().try_for_each(|(name, description)| input(xml, next(), name, description))?;
        variables.iter().try_for_each(|variable| calculated(xml, next(), variable))?;
        parameters.iter().try_for_each(|parameter| fixed(xml, next(), scene, *parameter))
    })?;
    Ok(())
}

fn input(xml: &mut Xml, reference: u32, name: &str, description: &str) -> io::Result<()> {
    let element = scalar(xml, reference, name, description)
        .with_attributes([("causality", "input"), ("variability", "continuous")]);
    element.write_inner_content(|xml| real_type(xml, Unit::Meter, Some(0.0)))?;
    Ok(())
}

fn calculated(xml: &mut Xml, reference: u32, variable: &Variable) -> io::Result<()> {
    let element = scalar(xml, reference, &variable.name, &variable.description).with_attributes([
        ("causality", if is_output(variable) { "output" } else { "local" }),
        ("variability", if variable.kind == Kind::Real { "continuous" } else { "discrete" }),
        ("initial", "calculated"),
    ]);
    element.write_inner_content(|xml| match variable.kind {
        Kind::Real => real_type(xml, variable.unit, None),
        Kind::Integer => xml.create_element("Integer").write_empty().map(drop),
    })?;
    Ok(())
}

fn fixed(xml: &mut Xml, reference: u32, scene: &Scene, parameter: Parameter) -> io::Result<()> {
    let element = scalar(xml, reference, &parameter.name(), &parameter.description()).with_attributes([
        ("causality", "parameter"),
        ("variability", "fixed"),
        ("initial", "exact"),
    ]);
    element.write_inner_content(|xml| match scene.parameter(parameter) {
        Value::Real(value) => real_type(xml, parameter.unit(), Some(value)),
        Value::Integer(value) => start(xml, "Integer", &value.to_string()),
        Value::Text(value) => start(xml, "String", &value),
    })?;
    Ok(())
}

fn scalar<'a>(xml: &'a mut Xml, reference: u32, name: &str, description: &str) -> ElementWriter<'a, Vec<u8>> {
    xml.create_element("ScalarVariable")
        .with_attribute(("name", name))
        .with_attribute(("valueReference", reference.to_string().as_str()))
        .with_attribute(("description", clean(description).as_str()))
}

fn real_type(xml: &mut Xml, unit: Unit, start: Option<f64>) -> io::Result<()> {
    let start = start.map(real);
    xml.create_element("Real")
        .with_attribute(("unit", unit.name()))
        .with_attributes(start.as_deref().map(|start| ("start", start)))
        .write_empty()
        .map(drop)
}

fn start(xml: &mut Xml, kind: &str, value: &str) -> io::Result<()> {
    xml.create_element(kind).with_attribute(("start", value)).write_empty().map(drop)
}
