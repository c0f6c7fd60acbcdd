//! modelDescription.xml of FMI 2.0 for co-simulation.

use std::collections::BTreeSet;
use std::io;

use asperity::fmi::{CAPABILITIES, Catalogue, Category, Definition, Entry, Input, Kind};
use asperity::outputs::Dependencies;
use asperity::scene::{Unit, Value};
use quick_xml::Writer;
use quick_xml::events::{BytesDecl, Event};

use crate::program::terminal::decimal;

type Xml = Writer<Vec<u8>>;

/// Communication steps that the default experiment takes, roughly.
const DEFAULT_STEPS: f64 = 500.0;

/// Writes the description of a layer or an element, whose variables are in `catalogue`.
pub(super) fn write(definition: &Definition, catalogue: &Catalogue, guid: &str) -> io::Result<Vec<u8>> {
    let mut xml = Writer::new_with_indent(Vec::new(), b' ', 2);
    xml.write_event(Event::Decl(BytesDecl::new("1.0", Some("UTF-8"), None)))?;
    let description = clean(&definition.description());
    let root = xml
        .create_element("fmiModelDescription")
        .with_attribute(("fmiVersion", "2.0"))
        .with_attribute(("modelName", clean(&definition.name()).as_str()))
        .with_attribute(("guid", guid))
        .with_attributes(Some(("description", description.as_str())).filter(|_| !description.is_empty()))
        .with_attribute(("generationTool", concat!("asperity ", env!("CARGO_PKG_VERSION"))))
        .with_attribute(("variableNamingConvention", "structured"))
        .with_attribute(("numberOfEventIndicators", "0"));
    root.write_inner_content(|xml| content(xml, definition, catalogue))?;
    let mut bytes = xml.into_inner();
    bytes.push(b'\n');
    Ok(bytes)
}

/// Text for an attribute: XML does not allow control characters.
pub(super) fn clean(text: &str) -> String {
    text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect()
}

fn content(xml: &mut Xml, definition: &Definition, catalogue: &Catalogue) -> io::Result<()> {
    co_simulation(xml, definition)?;
    unit_definitions(xml, catalogue)?;
    log_categories(xml)?;
    default_experiment(xml, definition)?;
    model_variables(xml, definition, catalogue)?;
    model_structure(xml, definition, catalogue)
}

fn co_simulation(xml: &mut Xml, definition: &Definition) -> io::Result<()> {
    xml.create_element("CoSimulation")
        .with_attribute(("modelIdentifier", definition.model_identifier().as_str()))
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

/// The excitation's duration as the time to simulate; a scene without one, and an element, have no default.
fn default_experiment(xml: &mut Xml, definition: &Definition) -> io::Result<()> {
    let Definition::Layer(scene) = definition else { return Ok(()) };
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

/// A sum of decimals without its rounding error: 0.014 for 0.01 + 0.001 + 0.003, which is 0.013999999999999999.
fn as_written(sum: f64) -> f64 {
    format!("{sum:.14e}").parse().unwrap_or(sum)
}

/// The largest of 1, 2 and 5 times a power of ten that is at most `step`.
fn round_down(step: f64) -> f64 {
    let exponent = step.log10().floor();
    let mantissa = step / 10_f64.powf(exponent);
    let digit = [5.0, 2.0].into_iter().find(|digit| mantissa >= *digit).unwrap_or(1.0);
    // Through a decimal: a product with a power of ten would be rounded.
    format!("{digit}e{exponent}").parse().unwrap_or(step)
}

/// A Real: the shortest decimal that reads back as the same.
fn real(value: f64) -> String {
    decimal(value, 1e-3..1e9)
}

/// Writes `UnitDefinitions`: the units of the variables, by their exponents of SI base units.
fn unit_definitions(xml: &mut Xml, catalogue: &Catalogue) -> io::Result<()> {
    let reals = catalogue.entries().map(|(_, entry)| entry).filter(|entry| entry.kind() == Kind::Real);
    let used: BTreeSet<Unit> = reals.map(|entry| unit(&entry)).collect();
    xml.create_element("UnitDefinitions")
        .write_inner_content(|xml| used.into_iter().try_for_each(|unit| unit_definition(xml, unit)))?;
    Ok(())
}

pub(super) fn unit(entry: &Entry<'_>) -> Unit {
    match entry {
        Entry::Input(input) => input.unit(),
        Entry::Output(_, variable) => variable.unit,
        Entry::PatchInput(input) => input.unit(),
        Entry::PatchOutput(_, variable) => variable.unit,
        Entry::Parameter(parameter, _) => parameter.unit(),
    }
}

fn unit_definition(xml: &mut Xml, unit: Unit) -> io::Result<()> {
    let radian = [("rad", unit.exponent_of_radian())];
    let exponents = ["kg", "m", "s", "K"].into_iter().zip(unit.exponents()).chain(radian);
    let exponents = exponents.filter(|(_, exponent)| *exponent != 0);
    let texts: Vec<_> = exponents.map(|(base, exponent)| (base, exponent.to_string())).collect();
    xml.create_element("Unit").with_attribute(("name", unit.name())).write_inner_content(|xml| {
        let attributes = texts.iter().map(|(base, exponent)| (*base, exponent.as_str()));
        xml.create_element("BaseUnit").with_attributes(attributes).write_empty()?;
        Ok(())
    })?;
    Ok(())
}

fn input_description(definition: &Definition, input: Input) -> &'static str {
    let has_body = |axis| matches!(definition, Definition::Layer(scene) if scene.carrier[axis].as_ref().is_some());
    match (input, input.axis().is_some_and(has_body)) {
        (Input::U, false) => "Displacement of the carrier along x",
        (Input::W, false) => "Displacement of the carrier along z, negative presses",
        (Input::U, true) => "Displacement along x of the drive of the carrier",
        (Input::W, true) => "Displacement along z of the drive of the carrier",
        (Input::Load, _) => "Normal load on the carrier, without its constant part; positive presses",
        (Input::Temperature, _) => "Bulk temperature of the layer, held over each communication step",
        (Input::Pull, _) => "Tangential force on the carrier along x, without its constant part",
    }
}

pub(super) fn description(definition: &Definition, entry: &Entry<'_>) -> String {
    match entry {
        Entry::Input(input) => input_description(definition, *input).into(),
        Entry::Output(_, variable) => variable.description.clone(),
        Entry::PatchInput(input) => input.description().into(),
        Entry::PatchOutput(_, variable) => variable.description.clone(),
        Entry::Parameter(parameter, _) => parameter.description(),
    }
}

/// The causality as the standard calls it.
pub(super) fn causality(entry: &Entry<'_>) -> &'static str {
    match entry {
        Entry::Input(_) | Entry::PatchInput(_) => "input",
        Entry::Output(_, variable) if variable.is_output() => "output",
        Entry::PatchOutput(_, variable) if variable.is_output() => "output",
        Entry::Output(..) | Entry::PatchOutput(..) => "local",
        Entry::Parameter(..) => "parameter",
    }
}

/// The start value; calculated variables have none.
pub(super) fn start(definition: &Definition, entry: &Entry<'_>) -> Option<String> {
    match entry {
        Entry::Input(input) => Some(real(definition.input_start(*input))),
        Entry::PatchInput(input) => {
            let Definition::Patch(patch) = definition else { return None };
            Some(real(input.start(patch)))
        }
        Entry::Output(..) | Entry::PatchOutput(..) => None,
        Entry::Parameter(parameter, _) => Some(match definition.parameter(*parameter) {
            Value::Real(value) => real(value),
            Value::Integer(value) => value.to_string(),
            Value::Text(value) => value,
        }),
    }
}

/// Writes `ModelVariables`: inputs, outputs and parameters in the order of their value references.
fn model_variables(xml: &mut Xml, definition: &Definition, catalogue: &Catalogue) -> io::Result<()> {
    xml.create_element("ModelVariables").write_inner_content(|xml| {
        catalogue.entries().try_for_each(|(reference, entry)| scalar_variable(xml, definition, reference, &entry))
    })?;
    Ok(())
}

fn scalar_variable(xml: &mut Xml, definition: &Definition, reference: u32, entry: &Entry<'_>) -> io::Result<()> {
    xml.create_element("ScalarVariable")
        .with_attribute(("name", entry.name().as_str()))
        .with_attribute(("valueReference", reference.to_string().as_str()))
        .with_attribute(("description", clean(&description(definition, entry)).as_str()))
        .with_attribute(("causality", causality(entry)))
        .with_attribute(("variability", variability(entry)))
        .with_attributes(initial(entry).map(|initial| ("initial", initial)))
        .write_inner_content(|xml| typed(xml, entry, start(definition, entry)))?;
    Ok(())
}

fn variability(entry: &Entry<'_>) -> &'static str {
    match entry {
        Entry::Parameter(..) => "fixed",
        _ if entry.kind() == Kind::Real => "continuous",
        _ => "discrete",
    }
}

/// Inputs must not have it.
fn initial(entry: &Entry<'_>) -> Option<&'static str> {
    match entry {
        Entry::Input(_) | Entry::PatchInput(_) => None,
        Entry::Output(..) | Entry::PatchOutput(..) => Some("calculated"),
        Entry::Parameter(..) => Some("exact"),
    }
}

fn typed(xml: &mut Xml, entry: &Entry<'_>, start: Option<String>) -> io::Result<()> {
    let unit = Some(unit(entry)).filter(|_| entry.kind() == Kind::Real).map(Unit::name);
    xml.create_element(entry.kind().to_string())
        .with_attributes(unit.map(|unit| ("unit", unit)))
        .with_attributes(start.as_deref().map(|start| ("start", start)))
        .write_empty()
        .map(drop)
}

fn model_structure(xml: &mut Xml, definition: &Definition, catalogue: &Catalogue) -> io::Result<()> {
    let outputs = |(reference, entry)| match entry {
        Entry::Output(_, variable) if variable.is_output() => {
            Some((reference, dependencies(catalogue, definition.dependencies(variable.output))))
        }
        Entry::PatchOutput(_, variable) if variable.is_output() => {
            // On the six coordinates of the pose, which come first.
            Some((reference, if variable.output.follows_pose() { "1 2 3 4 5 6" } else { "" }.to_owned()))
        }
        _ => None,
    };
    let unknowns = || catalogue.entries().filter_map(outputs);
    let structure = xml.create_element("ModelStructure");
    if unknowns().next().is_none() {
        return structure.write_empty().map(drop);
    }
    structure.write_inner_content(|xml| {
        xml.create_element("Outputs").write_inner_content(|xml| {
            unknowns().try_for_each(|(reference, names)| unknown(xml, reference, Some(&names)))
        })?;
        // Without dependencies: at the start everything may depend on all inputs and parameters.
        xml.create_element("InitialUnknowns")
            .write_inner_content(|xml| unknowns().try_for_each(|(reference, _)| unknown(xml, reference, None)))?;
        Ok(())
    })?;
    Ok(())
}

/// The inputs that an output depends on, counted from 1.
fn dependencies(catalogue: &Catalogue, dependencies: Dependencies) -> String {
    let depends = |input: Input| match input {
        Input::U => dependencies.on_u,
        Input::W => dependencies.on_w,
        Input::Load | Input::Pull | Input::Temperature => false,
    };
    let inputs = catalogue.inputs().iter().enumerate().filter(|(_, input)| depends(**input));
    let names: Vec<_> = inputs.map(|(index, _)| (index + 1).to_string()).collect();
    names.join(" ")
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

    /// The description of the default scene is kept in the repository, so that a change is seen. To accept an
    /// intended one: `BLESS=1 cargo test --bin asperity golden`.
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
