//! extra/org.fmi-standard.fmi-ls-ref/: what comes with an FMU that tells what it is and shows that it runs as it should,
//! listed in a manifest by FMI-LS-REF, the layered standard of the Modelica Association for references.

mod experiment;
mod manifest;
mod motion;
mod parameter_set;

use std::io;

use asperity_fmi::{Definition, VariableTable};

use super::archive::ArchiveEntry;
use experiment::{ExperimentTables, tables};
use manifest::{Related, Role};

/// The folder of the layered standard.
const FOLDER: &str = "extra/org.fmi-standard.fmi-ls-ref";
/// More than this is left out, the parameter set first: bytes.
const MOST_BYTES: usize = 100_000;

/// The files of the folder. `resources` are the paths of the files in resources/; `variables` have the names that the
/// FMU's have.
///
/// # Errors
/// Where a document cannot be written.
pub(super) fn entries(
    definition: &Definition,
    variables: &VariableTable,
    (resources, has_picture): (&[&str], bool),
) -> io::Result<Vec<ArchiveEntry>> {
    let mut related: Vec<Related> = resources.iter().map(|name| Related::resource(name)).collect();
    related.push(Related::new("../../documentation/index.html", Role::Document, "What it computes, its variables"));
    related.extend(has_picture.then(|| Related::new("../../model.png", Role::Document, "A picture of it")));
    let mut files = Vec::new();
    if let Some(ExperimentTables { inputs, result, description }) = tables(definition, variables) {
        related.push(Related::new("experiment.csv", Role::SmokeTest, "Inputs at times, straight from row to row"));
        related.push(Related::new("result.csv", Role::Result, &description));
        files.extend([("experiment.csv", inputs.into_bytes()), ("result.csv", result.into_bytes())]);
    }
    let parameters = parameter_set::write(&definition.name(), variables)?;
    let size: usize = files.iter().map(|(_, bytes)| bytes.len()).sum();
    if parameter_set::has_parameters(variables) && size + parameters.len() <= MOST_BYTES {
        related.push(Related::new("parameters.ssv", Role::Parameter, "The start values of all parameters"));
        files.push(("parameters.ssv", parameters));
    }
    files.push(("fmi-ls-manifest.xml", manifest::write(&related)?));
    Ok(files.into_iter().map(|(name, bytes)| ArchiveEntry::new(format!("{FOLDER}/{name}"), bytes)).collect())
}
