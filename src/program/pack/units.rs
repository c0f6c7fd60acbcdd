//! The units of a model description.

use std::collections::BTreeSet;
use std::io;

use asperity::outputs::Variable;
use asperity::scene::{Parameter, Unit};

use super::model_description::Xml;

/// Writes `UnitDefinitions`: each unit that a variable has, by its exponents of the SI's base units.
pub(super) fn write(xml: &mut Xml, variables: &[Variable], parameters: &[Parameter]) -> io::Result<()> {
    let used: BTreeSet<Unit> = (variables.iter().map(|variable| variable.unit))
        .chain(parameters.iter().map(|parameter| parameter.unit()))
        .chain([Unit::Meter])
        .collect();
    xml.create_element("UnitDefinitions")
        .write_inner_content(|xml| used.into_iter().try_for_each(|unit| one(xml, unit)))?;
    Ok(())
}

fn one(xml: &mut Xml, unit: Unit) -> io::Result<()> {
    let exponents = ["kg", "m", "s"].into_iter().zip(unit.exponents()).filter(|(_, exponent)| *exponent != 0);
    let texts: Vec<_> = exponents.map(|(base, exponent)| (base, exponent.to_string())).collect();
    xml.create_element("Unit").with_attribute(("name", unit.name())).write_inner_content(|xml| {
        let attributes = texts.iter().map(|(base, exponent)| (*base, exponent.as_str()));
        xml.create_element("BaseUnit").with_attributes(attributes).write_empty()?;
        Ok(())
    })?;
    Ok(())
}
