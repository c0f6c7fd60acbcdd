//! The start values of an FMU's parameters as a parameter set of SSP 1.0 (SSV).

use std::io;

use asperity_fmi::{Kind, Role, VariableRef, VariableTable};
use quick_xml::Writer;
use quick_xml::events::{BytesDecl, Event};

use crate::pack::description::{clean, start};

fn parameters(variables: &VariableTable) -> impl Iterator<Item = &VariableRef> {
    let is_parameter = |variable: &&VariableRef| matches!(variable.role, Role::Parameter(_));
    variables.entries().map(|(_, variable)| variable).filter(is_parameter)
}

/// Whether there are any.
pub(super) fn has_parameters(variables: &VariableTable) -> bool {
    parameters(variables).next().is_some()
}

/// Writes the set of the model called `name`.
pub(super) fn write(name: &str, variables: &VariableTable) -> io::Result<Vec<u8>> {
    let mut xml = Writer::new_with_indent(Vec::new(), b' ', 2);
    xml.write_event(Event::Decl(BytesDecl::new("1.0", Some("UTF-8"), None)))?;
    xml.create_element("ssv:ParameterSet")
        .with_attribute(("xmlns:ssv", "http://ssp-standard.org/SSP1/SystemStructureParameterValues"))
        .with_attribute(("version", "1.0"))
        .with_attribute(("name", format!("{} as packed", clean(name)).as_str()))
        .write_inner_content(|xml| {
            xml.create_element("ssv:Parameters")
                .write_inner_content(|xml| parameters(variables).try_for_each(|variable| parameter(xml, variable)))?;
            Ok(())
        })?;
    let mut bytes = xml.into_inner();
    bytes.push(b'\n');
    Ok(bytes)
}

fn parameter(xml: &mut Writer<Vec<u8>>, variable: &VariableRef) -> io::Result<()> {
    let kind = match variable.kind {
        Kind::Real => "ssv:Real",
        Kind::Integer => "ssv:Integer",
        Kind::Boolean => "ssv:Boolean",
        Kind::Text => "ssv:String",
    };
    let value = start(variable).unwrap_or_default();
    xml.create_element("ssv:Parameter").with_attribute(("name", variable.name.as_str())).write_inner_content(
        |xml| xml.create_element(kind).with_attribute(("value", value.as_str())).write_empty().map(drop),
    )?;
    Ok(())
}
