//! extra/org.fmi-standard.fmi-ls-ref/: what comes with an FMU that tells what it is and shows that it runs as it should,
//! listed in a manifest by FMI-LS-REF, the layered standard of the Modelica Association for references.

use std::io;
use std::path::Path;

use asperity_fmi::{Definition, Kind, Role, VariableRef, VariableTable};
use percent_encoding::{AsciiSet, NON_ALPHANUMERIC, utf8_percent_encode};

use super::archive::ArchiveEntry;
use super::description::{Xml, clean, document, start};
use super::experiment::{ExperimentTables, tables};

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
    related.push(Related::new("../../documentation/index.html", "document", "What it computes, its variables"));
    related.extend(has_picture.then(|| Related::new("../../model.png", "document", "A picture of it")));
    let mut files = Vec::new();
    if let Some(ExperimentTables { inputs, result, description }) = tables(definition, variables) {
        related.push(Related::new(
            "experiment.csv",
            "experiment/smoke-test",
            "Inputs at times, straight from row to row",
        ));
        related.push(Related::new("result.csv", "result", &description));
        files.extend([("experiment.csv", inputs.into_bytes()), ("result.csv", result.into_bytes())]);
    }
    let size: usize = files.iter().map(|(_, bytes)| bytes.len()).sum();
    let parameters = parameter_set(&definition.name(), variables)?;
    if let Some(parameters) = parameters.filter(|parameters| size + parameters.len() <= MOST_BYTES) {
        related.push(Related::new("parameters.ssv", "parameter", "The start values of all parameters"));
        files.push(("parameters.ssv", parameters));
    }
    files.push(("fmi-ls-manifest.xml", manifest(&related)?));
    Ok(files.into_iter().map(|(name, bytes)| ArchiveEntry::new(format!("{FOLDER}/{name}"), bytes)).collect())
}

/// Characters of a path that stand for themselves in a URI (RFC 3986, section 3.3).
const OF_PATH: &AsciiSet = &NON_ALPHANUMERIC.remove(b'/').remove(b'.').remove(b'-').remove(b'_').remove(b'~');

/// A file that comes with an FMU.
#[derive(Debug)]
struct Related {
    /// Its place, from the manifest's folder.
    source: String,
    /// What it is for, as the standard calls it.
    role: &'static str,
    description: String,
}

impl Related {
    fn new(source: &str, role: &'static str, description: &str) -> Self {
        Self { source: source.into(), role, description: description.into() }
    }

    /// A file in resources/.
    fn resource(name: &str) -> Self {
        Self::new(&format!("../../{name}"), "model", "What the FMU simulates, as it was packed")
    }

    /// The media type.
    fn media_type(&self) -> &'static str {
        match Path::new(&self.source).extension().and_then(|extension| extension.to_str()) {
            Some("toml") => "application/toml",
            Some("csv") => "text/csv",
            Some("txt") => "text/plain",
            Some("html") => "text/html",
            Some("png") => "image/png",
            Some("ssv") => "application/x-ssp-parameter-set",
            _ => "application/octet-stream",
        }
    }
}

/// The manifest of these files, fmi-ls-manifest.xml of FMI-LS-REF, 1.0.0-alpha.1.
fn manifest(files: &[Related]) -> io::Result<Vec<u8>> {
    let related = |xml: &mut Xml, file: &Related| {
        xml.create_element("Related")
            .with_attribute(("type", file.media_type()))
            .with_attribute(("source", utf8_percent_encode(&file.source, OF_PATH).to_string().as_str()))
            .with_attribute(("role", file.role))
            .with_attribute(("description", clean(&file.description).as_str()))
            .write_empty()
            .map(drop)
    };
    document(|xml| {
        xml.create_element("fmiReferences")
            .with_attribute(("xmlns:fmi-ls", "http://fmi-standard.org/fmi-ls-manifest"))
            .with_attribute(("fmi-ls:fmi-ls-name", "org.fmi-standard.fmi-ls-ref"))
            .with_attribute(("fmi-ls:fmi-ls-version", "1.0.0-alpha.1"))
            // The standard fixes these words.
            .with_attribute((
                "fmi-ls:fmi-ls-description",
                "Layered Standard providing information on related files included in an FMU.",
            ))
            .write_inner_content(|xml| files.iter().try_for_each(|file| related(xml, file)))
            .map(drop)
    })
}

fn parameters(variables: &VariableTable) -> impl Iterator<Item = &VariableRef> {
    let is_parameter = |variable: &&VariableRef| matches!(variable.role, Role::Parameter(_));
    variables.entries().map(|(_, variable)| variable).filter(is_parameter)
}

/// The start values of the parameters of the model called `name`, as a parameter set of SSP 1.0 (SSV); `None` where it has
/// none.
fn parameter_set(name: &str, variables: &VariableTable) -> io::Result<Option<Vec<u8>>> {
    if parameters(variables).next().is_none() {
        return Ok(None);
    }
    let written = document(|xml| {
        xml.create_element("ssv:ParameterSet")
            .with_attribute(("xmlns:ssv", "http://ssp-standard.org/SSP1/SystemStructureParameterValues"))
            .with_attribute(("version", "1.0"))
            .with_attribute(("name", format!("{} as packed", clean(name)).as_str()))
            .write_inner_content(|xml| {
                let all = |xml: &mut Xml| parameters(variables).try_for_each(|variable| parameter(xml, variable));
                xml.create_element("ssv:Parameters").write_inner_content(all).map(drop)
            })
            .map(drop)
    });
    written.map(Some)
}

fn parameter(xml: &mut Xml, variable: &VariableRef) -> io::Result<()> {
    let kind = match variable.kind {
        Kind::Real => "ssv:Real",
        Kind::Integer => "ssv:Integer",
        Kind::Boolean => "ssv:Boolean",
        Kind::Text => "ssv:String",
    };
    let value = start(variable).unwrap_or_default();
    let write =
        |xml: &mut Xml| xml.create_element(kind).with_attribute(("value", value.as_str())).write_empty().map(drop);
    xml.create_element("ssv:Parameter")
        .with_attribute(("name", variable.name.as_str()))
        .write_inner_content(write)
        .map(drop)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_becomes_a_uri() {
        let text = String::from_utf8(manifest(&[Related::resource("resources/my road #2.csv")]).unwrap()).unwrap();
        assert!(text.contains("source=\"../../resources/my%20road%20%232.csv\""), "{text}");
        assert!(text.contains("type=\"text/csv\"") && text.contains("role=\"model\""), "{text}");
    }
}
