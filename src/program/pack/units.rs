//! The units of a model description.

use std::collections::BTreeSet;
use std::io;

use asperity::fmi::{Catalogue, Entry, Kind};
use asperity::scene::Unit;

use super::model_description::Xml;

/// Writes `UnitDefinitions`: each unit that a variable has, by its exponents of the SI's base units.
pub(super) fn write(xml: &mut Xml, catalogue: &Catalogue) -> io::Result<()> {
    let reals = catalogue.entries().map(|(_, entry)| entry).filter(|entry| entry.kind() == Kind::Real);
    let used: BTreeSet<Unit> = reals.map(|entry| of(&entry)).collect();
    xml.create_element("UnitDefinitions")
        .write_inner_content(|xml| used.into_iter().try_for_each(|unit| one(xml, unit)))?;
    Ok(())
}

/// The unit of a variable.
pub(super) fn of(entry: &Entry<'_>) -> Unit {
    match entry {
        Entry::Input(_) => Unit::Meter,
        Entry::Output(_, variable) => variable.unit,
        Entry::Parameter(parameter, _) => parameter.unit(),
    }
}

fn one(xml: &mut Xml, unit: Unit) -> io::Result<()> {
    let exponents = ["kg", "m", "s", "K"].into_iter().zip(unit.exponents()).filter(|(_, exponent)| *exponent != 0);
    let texts: Vec<_> = exponents.map(|(base, exponent)| (base, exponent.to_string())).collect();
    xml.create_element("Unit").with_attribute(("name", unit.name())).write_inner_content(|xml| {
        let attributes = texts.iter().map(|(base, exponent)| (*base, exponent.as_str()));
        xml.create_element("BaseUnit").with_attributes(attributes).write_empty()?;
        Ok(())
    })?;
    Ok(())
}
