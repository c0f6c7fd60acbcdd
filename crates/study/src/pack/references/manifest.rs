//! fmi-ls-manifest.xml of FMI-LS-REF, 1.0.0-alpha.1.

use std::io;
use std::path::Path;

use percent_encoding::{AsciiSet, NON_ALPHANUMERIC, utf8_percent_encode};
use quick_xml::Writer;
use quick_xml::events::{BytesDecl, Event};

use crate::pack::description::clean;

/// Characters of a path that stand for themselves in a URI (RFC 3986, section 3.3).
const OF_PATH: &AsciiSet = &NON_ALPHANUMERIC.remove(b'/').remove(b'.').remove(b'-').remove(b'_').remove(b'~');

/// What a file is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Role {
    Model,
    Document,
    SmokeTest,
    Result,
    Parameter,
}

impl Role {
    /// As the standard calls it.
    fn name(self) -> &'static str {
        match self {
            Self::Model => "model",
            Self::Document => "document",
            Self::SmokeTest => "experiment/smoke-test",
            Self::Result => "result",
            Self::Parameter => "parameter",
        }
    }
}

/// A file that comes with an FMU.
#[derive(Debug)]
pub(super) struct Related {
    /// Its place, from the manifest's folder.
    source: String,
    role: Role,
    description: String,
}

impl Related {
    pub(super) fn new(source: &str, role: Role, description: &str) -> Self {
        Self { source: source.into(), role, description: description.into() }
    }

    /// A file in resources/.
    pub(super) fn resource(name: &str) -> Self {
        Self::new(&format!("../../{name}"), Role::Model, "What the FMU simulates, as it was packed")
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

/// Writes the manifest of these files.
pub(super) fn write(files: &[Related]) -> io::Result<Vec<u8>> {
    let mut xml = Writer::new_with_indent(Vec::new(), b' ', 2);
    xml.write_event(Event::Decl(BytesDecl::new("1.0", Some("UTF-8"), None)))?;
    xml.create_element("fmiReferences")
        .with_attribute(("xmlns:fmi-ls", "http://fmi-standard.org/fmi-ls-manifest"))
        .with_attribute(("fmi-ls:fmi-ls-name", "org.fmi-standard.fmi-ls-ref"))
        .with_attribute(("fmi-ls:fmi-ls-version", "1.0.0-alpha.1"))
        // The standard fixes these words.
        .with_attribute((
            "fmi-ls:fmi-ls-description",
            "Layered Standard providing information on related files included in an FMU.",
        ))
        .write_inner_content(|xml| {
            files.iter().try_for_each(|file| {
                xml.create_element("Related")
                    .with_attribute(("type", file.media_type()))
                    .with_attribute(("source", utf8_percent_encode(&file.source, OF_PATH).to_string().as_str()))
                    .with_attribute(("role", file.role.name()))
                    .with_attribute(("description", clean(&file.description).as_str()))
                    .write_empty()
                    .map(drop)
            })
        })?;
    let mut bytes = xml.into_inner();
    bytes.push(b'\n');
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_becomes_a_uri() {
        let text = String::from_utf8(write(&[Related::resource("resources/my road #2.csv")]).unwrap()).unwrap();
        assert!(text.contains("source=\"../../resources/my%20road%20%232.csv\""), "{text}");
        assert!(text.contains("type=\"text/csv\"") && text.contains("role=\"model\""), "{text}");
    }
}
