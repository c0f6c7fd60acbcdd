//! modelDescription.xml of FMI 2.0 for co-simulation.

use std::io;

use asperity::fmi::{CAPABILITIES, Catalogue, Category, Entry, Subject};
use asperity::outputs::Dependencies;
use quick_xml::Writer;
use quick_xml::events::{BytesDecl, Event};

use super::{units, variables as scalar_variables};
use crate::program::text::decimal;

/// A document in the making.
pub(super) type Xml = Writer<Vec<u8>>;

/// Communication steps that the default experiment takes, roughly.
const DEFAULT_STEPS: f64 = 500.0;

/// Writes the description of `subject`, whose variables are in `catalogue`.
pub(super) fn write(subject: &Subject, catalogue: &Catalogue, guid: &str) -> io::Result<Vec<u8>> {
    let mut xml = Writer::new_with_indent(Vec::new(), b' ', 2);
    xml.write_event(Event::Decl(BytesDecl::new("1.0", Some("UTF-8"), None)))?;
    let description = clean(&subject.description());
    let root = xml
        .create_element("fmiModelDescription")
        .with_attribute(("fmiVersion", "2.0"))
        .with_attribute(("modelName", clean(&subject.name()).as_str()))
        .with_attribute(("guid", guid))
        .with_attributes(Some(("description", description.as_str())).filter(|_| !description.is_empty()))
        .with_attribute(("generationTool", concat!("asperity ", env!("CARGO_PKG_VERSION"))))
        .with_attribute(("variableNamingConvention", "structured"))
        .with_attribute(("numberOfEventIndicators", "0"));
    root.write_inner_content(|xml| content(xml, subject, catalogue))?;
    let mut bytes = xml.into_inner();
    bytes.push(b'\n');
    Ok(bytes)
}

/// Text as an attribute can hold it: XML has no place for control characters.
pub(super) fn clean(text: &str) -> String {
    text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect()
}

fn content(xml: &mut Xml, subject: &Subject, catalogue: &Catalogue) -> io::Result<()> {
    co_simulation(xml, subject)?;
    units::write(xml, catalogue)?;
    log_categories(xml)?;
    default_experiment(xml, subject)?;
    scalar_variables::write(xml, subject, catalogue)?;
    model_structure(xml, subject, catalogue)
}

fn co_simulation(xml: &mut Xml, subject: &Subject) -> io::Result<()> {
    xml.create_element("CoSimulation")
        .with_attribute(("modelIdentifier", subject.model_identifier().as_str()))
        .with_attributes(CAPABILITIES)
        .write_empty()?;
    Ok(())
}

fn log_categories(xml: &mut Xml) -> io::Result<()> {
    xml.create_element("LogCategories").write_inner_content(|xml| {
        Category::ALL.into_iter().try_for_each(|category| {
            let element = xml.create_element("Category").with_attribute(("name", category.name()));
            element.with_attribute(("description", category.description())).write_empty().map(drop)
        })
    })?;
    Ok(())
}

/// The excitation's duration as the time to simulate; a scene without one, and an element, leave that to the master.
fn default_experiment(xml: &mut Xml, subject: &Subject) -> io::Result<()> {
    let Subject::Layer(scene) = subject else { return Ok(()) };
    let stop = as_written(scene.duration());
    if stop <= 0.0 {
        return Ok(());
    }
    xml.create_element("DefaultExperiment")
        .with_attribute(("startTime", "0"))
        .with_attribute(("stopTime", real(stop).as_str()))
        .with_attribute(("tolerance", real(scene.solver.relative_tolerance).as_str()))
        .with_attribute(("stepSize", real(round_down(stop / DEFAULT_STEPS)).as_str()))
        .write_empty()?;
    Ok(())
}

/// A sum of decimals without its roundings: 0.014 for 0.01 + 0.001 + 0.003, which is 0.013999999999999999.
fn as_written(sum: f64) -> f64 {
    format!("{sum:.14e}").parse().unwrap_or(sum)
}

/// The largest of 1, 2 and 5 times a power of ten that is at most `step`.
fn round_down(step: f64) -> f64 {
    let exponent = step.log10().floor();
    let mantissa = step / 10_f64.powf(exponent);
    let digit = [5.0, 2.0].into_iter().find(|digit| mantissa >= *digit).unwrap_or(1.0);
    // By way of a decimal: a product of powers of ten would carry their rounding into the text.
    format!("{digit}e{exponent}").parse().unwrap_or(step)
}

/// A Real for the description: the shortest decimal that reads back as the same.
pub(super) fn real(value: f64) -> String {
    decimal(value, 1e-3..1e9)
}

fn model_structure(xml: &mut Xml, subject: &Subject, catalogue: &Catalogue) -> io::Result<()> {
    let outputs = |(reference, entry)| match entry {
        Entry::Output(_, variable) if variable.is_output() => Some((reference, variable)),
        _ => None,
    };
    let unknowns = || catalogue.entries().filter_map(outputs);
    let structure = xml.create_element("ModelStructure");
    if unknowns().next().is_none() {
        return structure.write_empty().map(drop);
    }
    structure.write_inner_content(|xml| {
        xml.create_element("Outputs").write_inner_content(|xml| {
            unknowns()
                .try_for_each(|(reference, variable)| output(xml, reference, subject.dependencies(variable.output)))
        })?;
        // Without dependencies named: at the start everything may depend on inputs and parameters alike.
        xml.create_element("InitialUnknowns")
            .write_inner_content(|xml| unknowns().try_for_each(|(reference, _)| unknown(xml, reference, None)))?;
        Ok(())
    })?;
    Ok(())
}

fn output(xml: &mut Xml, reference: u32, dependencies: Dependencies) -> io::Result<()> {
    let names = [("1", dependencies.on_u), ("2", dependencies.on_w)];
    let names: Vec<_> = names.into_iter().filter(|(_, depends)| *depends).map(|(name, _)| name).collect();
    unknown(xml, reference, Some(&names.join(" ")))
}

/// The standard counts the variables from 1 here; value references count them from 0.
fn unknown(xml: &mut Xml, reference: u32, dependencies: Option<&str>) -> io::Result<()> {
    let index = reference + 1;
    let unknown = xml.create_element("Unknown").with_attribute(("index", index.to_string().as_str()));
    unknown.with_attributes(dependencies.map(|names| ("dependencies", names))).write_empty().map(drop)
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use asperity::fmi::{Sources, guid};
    use asperity::scene::Scene;

    use super::*;

    /// The description of the default scene is kept in the repository, so that a change to it is seen. After one that
    /// is meant: `BLESS=1 cargo test --bin asperity golden`.
    #[test]
    fn the_default_scene_has_the_golden_description() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR"));
        let path = root.join("scenes/tread-block/tread-block.toml");
        let scene = Scene::load(&path).unwrap();
        let catalogue = Catalogue::new(&scene);
        let guid = guid(&Sources::read(&path, &scene).unwrap(), &catalogue);
        let written = String::from_utf8(write(&scene.into(), &catalogue, &guid).unwrap()).unwrap();
        let golden = root.join("modelDescription/modelDescription.xml");
        if std::env::var_os("BLESS").is_some() {
            std::fs::write(&golden, &written).unwrap();
        }
        assert!(written == std::fs::read_to_string(&golden).unwrap(), "BLESS=1 accepts the new description");
    }

    #[test]
    fn the_default_step_is_a_round_number() {
        assert_eq!([round_down(5.2e-6), round_down(2.6e-6), round_down(1.0)], [5e-6, 2e-6, 1.0]);
        assert_eq!(real(round_down(5.2e-6)), "5e-6");
    }

    #[test]
    fn a_sum_of_decimals_is_written_without_its_roundings() {
        assert_eq!(real(as_written(1e-2 + 1e-3 + 3e-3)), "0.014");
        assert_eq!([as_written(0.0), as_written(1e30 + 1e-30)], [0.0, 1e30]);
    }
}
