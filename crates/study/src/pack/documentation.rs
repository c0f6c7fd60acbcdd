//! documentation/: the page index.html, its style sheet and the licences.

use std::io;

use asperity_fmi::{Definition, Kind, Role, VariableRef, VariableTable};
use quick_xml::escape::escape;

use super::description;
use crate::html::{self, Cell};
use crate::labelled::LabelledLine;

const LAYER_PAGE: &str = include_str!("../../../../modelDescription/documentation/index.html");
const PATCH_PAGE: &str = include_str!("../../../../modelDescription/documentation/patch.html");
const ELEMENT_PAGE: &str = include_str!("../../../../modelDescription/documentation/element.html");

/// The files that are the same in every archive: path, content.
pub(super) const FILES: [(&str, &str); 5] = [
    ("documentation/style.css", include_str!("../../../../modelDescription/documentation/style.css")),
    // The entry point that FMI 2.0 asks for: it names the others.
    (
        "documentation/licenses/license.txt",
        include_str!("../../../../modelDescription/documentation/licenses/license.txt"),
    ),
    ("documentation/licenses/LICENSE-APACHE", include_str!("../../../../LICENSE-APACHE")),
    ("documentation/licenses/LICENSE-MIT", include_str!("../../../../LICENSE-MIT")),
    (
        "documentation/licenses/third-party.txt",
        include_str!("../../../../modelDescription/documentation/licenses/third-party.txt"),
    ),
];

/// index.html: a summary of the scene or the table, the variables, the parameters, the equations.
pub(super) fn write(
    definition: &Definition,
    variables: &VariableTable,
    summary: &[LabelledLine],
) -> io::Result<Vec<u8>> {
    let page = match definition {
        Definition::Layer(_) => LAYER_PAGE,
        Definition::Element(_) => ELEMENT_PAGE,
        Definition::Patch(_) => PATCH_PAGE,
    };
    let summary: Vec<_> = summary.iter().map(|(name, text)| [(*name).into(), description::clean(text)]).collect();
    let is_parameter = |variable: &&VariableRef| matches!(variable.role, Role::Parameter(_));
    let (parameters, others): (Vec<_>, Vec<_>) =
        variables.entries().map(|(_, variable)| variable).partition(is_parameter);
    let others: Vec<_> = others.iter().map(|variable| row(variable, description::causality(variable).into())).collect();
    let start = |variable| description::start(variable).unwrap_or_default();
    let parameters: Vec<_> = parameters.iter().map(|variable| row(variable, start(variable))).collect();
    let fields = [
        ("name", escape(description::clean(&definition.name())).into_owned()),
        ("description", escape(description::clean(&definition.description())).into_owned()),
        ("version", env!("CARGO_PKG_VERSION").to_owned()),
        ("scene", table(["", "What is there"], &summary)?),
        ("variables", table(["Name", "Causality", "Unit", "Description"], &others)?),
        ("parameters", table(["Name", "Start", "Unit", "Description"], &parameters)?),
    ];
    Ok(html::fill(page, &fields).into_bytes())
}

fn row(variable: &VariableRef, second: String) -> [String; 4] {
    let unit = if variable.kind == Kind::Real { variable.unit.name() } else { "" };
    [variable.name.clone(), second, unit.into(), variable.description.clone()]
}

fn table<const N: usize>(head: [&str; N], rows: &[[String; N]]) -> io::Result<String> {
    let rows: Vec<Vec<Cell>> = rows.iter().map(|cells| cells.iter().map(Cell::from).collect()).collect();
    html::table(&head.map(Cell::from), &rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_licences_have_an_entry_point_that_names_the_others() {
        let licences: Vec<_> = FILES
            .iter()
            .filter_map(|(path, text)| Some((path.strip_prefix("documentation/licenses/")?, text)))
            .collect();
        let (_, entry_point) = licences.iter().find(|(name, _)| *name == "license.txt").unwrap();
        let others = licences.iter().map(|(name, _)| *name).filter(|name| *name != "license.txt");
        assert!(others.clone().count() > 0 && others.clone().all(|name| entry_point.contains(name)), "{entry_point}");
    }
}
