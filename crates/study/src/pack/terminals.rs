//! terminalsAndIcons/ of FMI 3.0, which FMI 2.0.4 takes over: the inputs and outputs that belong together, as a terminal that
//! importers connect as one, and the picture as an icon.

use std::io;

use asperity::patch::COORDINATES;
use asperity_fmi::{Definition, VariableTable};

use super::archive::ArchiveEntry;
use super::description::{Xml, document};
use super::icon::{HEIGHT, WIDTH};

/// A terminal: its name, kind and description, and the variables that are its members, by their own names.
struct Terminal {
    name: &'static str,
    kind: &'static str,
    description: &'static str,
    members: &'static [&'static str],
}

/// Of a layer and of an element.
const CARRIER: Terminal = Terminal {
    name: "carrier",
    kind: "org.asperity.carrier",
    description: "Displacement of the carrier, or of its drive, and the force of the layer on it, in the plane",
    members: &["u", "w", "F_x", "F_z"],
};

/// Of a seal.
const ROD: Terminal = Terminal {
    name: "rod",
    kind: "org.asperity.rod",
    description: "Displacement of the rod, the pressure before the lip, and the force on the rod",
    members: &["u", "w", "sealed_pressure", "F_x", "F_z"],
};

/// Of a patch.
const BODY: Terminal = Terminal {
    name: "body",
    kind: "org.asperity.body",
    description: "Pose of the body, and force and moment on it about the pose's point",
    members: &[
        COORDINATES[0],
        COORDINATES[1],
        COORDINATES[2],
        COORDINATES[3],
        COORDINATES[4],
        COORDINATES[5],
        "force.x",
        "force.y",
        "force.z",
        "moment.x",
        "moment.y",
        "moment.z",
    ],
};

/// The files of the folder. `variables` have the names that the FMU's have.
///
/// # Errors
/// Where the document cannot be written.
pub(super) fn entries(
    definition: &Definition,
    variables: &VariableTable,
    picture: Option<&[u8]>,
) -> io::Result<Vec<ArchiveEntry>> {
    let terminal = match definition {
        Definition::Layer(_) | Definition::Element(_) => &CARRIER,
        Definition::Patch(_) => &BODY,
        Definition::Seal(_) => &ROD,
    };
    let own = definition.variables();
    let named: Vec<(&str, &str)> =
        own.entries().zip(variables.entries()).map(|((_, own), (_, named))| (&*own.name, &*named.name)).collect();
    let members: Vec<_> = named.into_iter().filter(|(own, _)| terminal.members.contains(own)).collect();
    let document = document(|xml| {
        let root = xml.create_element("fmiTerminalsAndIcons").with_attribute(("fmiVersion", "3.0"));
        root.write_inner_content(|xml| {
            if picture.is_some() {
                graphics(xml)?;
            }
            xml.create_element("Terminals").write_inner_content(|xml| write(xml, terminal, &members))?;
            Ok(())
        })?;
        Ok(())
    })?;
    let icon = picture.map(|picture| ArchiveEntry::new("terminalsAndIcons/icon.png", picture));
    Ok(icon.into_iter().chain([ArchiveEntry::new("terminalsAndIcons/terminalsAndIcons.xml", document)]).collect())
}

/// The place of the icon, 20 mm wide.
fn graphics(xml: &mut Xml) -> io::Result<()> {
    let (right, top) = (100.0.to_string(), (100.0 * HEIGHT / WIDTH).round().to_string());
    let (left, bottom) = (format!("-{right}"), format!("-{top}"));
    let box_of = [("x1", &*left), ("y1", &*bottom), ("x2", &*right), ("y2", &*top)];
    xml.create_element("GraphicalRepresentation").write_inner_content(|xml| {
        xml.create_element("CoordinateSystem")
            .with_attributes(box_of)
            .with_attribute(("suggestedScalingFactorTo_mm", "0.1"))
            .write_empty()?;
        xml.create_element("Icon").with_attributes(box_of).write_empty()?;
        Ok(())
    })?;
    Ok(())
}

/// Writes a terminal with these members, by their own names and those in the FMU.
fn write(xml: &mut Xml, terminal: &Terminal, members: &[(&str, &str)]) -> io::Result<()> {
    xml.create_element("Terminal")
        .with_attribute(("name", terminal.name))
        .with_attribute(("matchingRule", "plug"))
        .with_attribute(("terminalKind", terminal.kind))
        .with_attribute(("description", terminal.description))
        .write_inner_content(|xml| {
            members.iter().try_for_each(|(own, named)| {
                let member = xml.create_element("TerminalMemberVariable").with_attribute(("variableName", *named));
                member.with_attribute(("memberName", *own)).with_attribute(("variableKind", "signal")).write_empty()?;
                Ok(())
            })
        })?;
    Ok(())
}
