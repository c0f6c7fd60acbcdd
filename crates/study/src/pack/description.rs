//! What describes an FMU: modelDescription.xml of FMI 2.0 for co-simulation; documentation/, which is the page index.html,
//! its style sheet and the licences.

use std::collections::{BTreeMap, BTreeSet};
use std::io;

use asperity::scene::{DependencyList, Unit, Value};
use asperity_fmi::{CAPABILITIES, Category, Definition, Experiment, FmuModel, Kind, Role, VariableRef, VariableTable};
use quick_xml::Writer;
use quick_xml::escape::escape;
use quick_xml::events::{BytesDecl, Event};

use crate::decimals::decimal;
use crate::html::{self, Cell};
use crate::summary::LabelledLine;

pub(super) type Xml = Writer<Vec<u8>>;

/// Nominal values of variables by their names in the FMU.
pub(super) type Nominals = BTreeMap<String, f64>;

/// Writes the description of a model with these variables and what they are by size, its GUID and the convention of their
/// names. Without a date: the same FMU has the same bytes.
pub(super) fn description(
    model: &dyn FmuModel,
    (variables, nominals): (&VariableTable, &Nominals),
    (guid, naming): (&str, &str),
) -> io::Result<Vec<u8>> {
    let description = clean(&model.description());
    document(|xml| {
        xml.create_element("fmiModelDescription")
            .with_attribute(("fmiVersion", "2.0"))
            .with_attribute(("modelName", clean(&model.name()).as_str()))
            .with_attribute(("guid", guid))
            .with_attributes(Some(("description", description.as_str())).filter(|_| !description.is_empty()))
            .with_attribute(("author", "The asperity developers"))
            .with_attribute(("version", env!("CARGO_PKG_VERSION")))
            .with_attribute(("license", "MIT OR Apache-2.0: the library; see documentation/licenses"))
            .with_attribute(("generationTool", concat!("asperity ", env!("CARGO_PKG_VERSION"))))
            .with_attribute(("variableNamingConvention", naming))
            .with_attribute(("numberOfEventIndicators", "0"))
            .write_inner_content(|xml| content(xml, model, variables, nominals))
            .map(drop)
    })
}

/// A document of XML, whose root `write` writes.
pub(super) fn document(write: impl FnOnce(&mut Xml) -> io::Result<()>) -> io::Result<Vec<u8>> {
    let mut xml = Writer::new_with_indent(Vec::new(), b' ', 2);
    xml.write_event(Event::Decl(BytesDecl::new("1.0", Some("UTF-8"), None)))?;
    write(&mut xml)?;
    let mut bytes = xml.into_inner();
    bytes.push(b'\n');
    Ok(bytes)
}

/// Text for an attribute: XML does not allow control characters.
pub(super) fn clean(text: &str) -> String {
    text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect()
}

fn content(xml: &mut Xml, model: &dyn FmuModel, variables: &VariableTable, nominals: &Nominals) -> io::Result<()> {
    co_simulation(xml, model)?;
    unit_definitions(xml, variables)?;
    log_categories(xml)?;
    default_experiment(xml, model)?;
    model_variables(xml, variables, nominals)?;
    model_structure(xml, variables, lists_dependencies(model))
}

fn lists_dependencies(model: &dyn FmuModel) -> bool {
    model.options().dependencies == DependencyList::Direct
}

fn co_simulation(xml: &mut Xml, model: &dyn FmuModel) -> io::Result<()> {
    let without = if lists_dependencies(model) { "" } else { "providesDirectionalDerivative" };
    xml.create_element("CoSimulation")
        .with_attribute(("modelIdentifier", model.identifier().as_str()))
        .with_attributes(CAPABILITIES.into_iter().filter(|(name, _)| *name != without))
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

/// Where no end is the model's own it is that of so many steps: importers do steps for a second else.
const STEPS: f64 = 500.0;

fn default_experiment(xml: &mut Xml, model: &dyn FmuModel) -> io::Result<()> {
    let Some(Experiment { stop, tolerance, step }) = model.default_experiment() else { return Ok(()) };
    let step = round_down(step);
    let numbers = [
        ("startTime", Some("0".to_owned())),
        ("stopTime", Some(real(stop.unwrap_or(STEPS * step)))),
        ("tolerance", tolerance.map(real)),
        ("stepSize", Some(real(step))),
    ];
    let given = numbers.iter().filter_map(|(name, number)| Some((*name, number.as_deref()?)));
    xml.create_element("DefaultExperiment").with_attributes(given).write_empty().map(drop)
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
fn unit_definitions(xml: &mut Xml, variables: &VariableTable) -> io::Result<()> {
    let reals = variables.entries().filter(|(_, variable)| variable.kind == Kind::Real);
    let used: BTreeSet<Unit> = reals.map(|(_, variable)| variable.unit).collect();
    xml.create_element("UnitDefinitions")
        .write_inner_content(|xml| used.into_iter().try_for_each(|unit| unit_definition(xml, unit)))?;
    Ok(())
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

/// The causality as the standard calls it.
pub(super) fn causality(variable: &VariableRef) -> &'static str {
    match variable.role {
        Role::Input(_) => "input",
        Role::Output { .. } => "output",
        Role::Local(_) => "local",
        Role::Parameter(_) => "parameter",
    }
}

/// The start value; calculated variables have none.
pub(super) fn start(variable: &VariableRef) -> Option<String> {
    variable.start.as_ref().map(|value| match value {
        Value::Real(value) => real(*value),
        Value::Integer(value) => value.to_string(),
        Value::Text(value) => value.clone(),
    })
}

/// Writes `ModelVariables`: inputs, outputs and parameters in the order of their value references.
fn model_variables(xml: &mut Xml, variables: &VariableTable, nominals: &Nominals) -> io::Result<()> {
    xml.create_element("ModelVariables").write_inner_content(|xml| {
        variables.entries().try_for_each(|(reference, variable)| {
            scalar_variable(xml, (reference, variable), nominals.get(&variable.name).copied())
        })
    })?;
    Ok(())
}

fn scalar_variable(xml: &mut Xml, (reference, variable): (u32, &VariableRef), nominal: Option<f64>) -> io::Result<()> {
    xml.create_element("ScalarVariable")
        .with_attribute(("name", variable.name.as_str()))
        .with_attribute(("valueReference", reference.to_string().as_str()))
        .with_attribute(("description", clean(&variable.description).as_str()))
        .with_attribute(("causality", causality(variable)))
        .with_attribute(("variability", variability(variable)))
        .with_attributes(initial(variable).map(|initial| ("initial", initial)))
        .write_inner_content(|xml| typed(xml, variable, nominal))?;
    Ok(())
}

fn variability(variable: &VariableRef) -> &'static str {
    match variable.role {
        Role::Parameter(_) => "fixed",
        _ if variable.kind == Kind::Real => "continuous",
        _ => "discrete",
    }
}

/// Inputs must not have it.
fn initial(variable: &VariableRef) -> Option<&'static str> {
    match variable.role {
        Role::Input(_) => None,
        Role::Output { .. } | Role::Local(_) => Some("calculated"),
        Role::Parameter(_) => Some("exact"),
    }
}

fn typed(xml: &mut Xml, variable: &VariableRef, nominal: Option<f64>) -> io::Result<()> {
    let is_real = variable.kind == Kind::Real;
    let unit = Some(variable.unit.name()).filter(|_| is_real);
    let nominal = nominal.filter(|_| is_real).map(real);
    xml.create_element(variable.kind.to_string())
        .with_attributes(unit.map(|unit| ("unit", unit)))
        .with_attributes(nominal.as_deref().map(|nominal| ("nominal", nominal)))
        .with_attributes(start(variable).as_deref().map(|start| ("start", start)))
        .write_empty()
        .map(drop)
}

/// An output without dependencies depends on nothing, which the standard has an empty list for.
fn model_structure(xml: &mut Xml, variables: &VariableTable, lists_dependencies: bool) -> io::Result<()> {
    let unknowns: Vec<_> = variables
        .entries()
        .filter_map(|(reference, variable)| match &variable.role {
            Role::Output { dependencies, .. } => {
                Some((reference, indices(variables, if lists_dependencies { dependencies } else { &[] })))
            }
            _ => None,
        })
        .collect();
    let structure = xml.create_element("ModelStructure");
    if unknowns.is_empty() {
        return structure.write_empty().map(drop);
    }
    structure.write_inner_content(|xml| {
        xml.create_element("Outputs").write_inner_content(|xml| {
            unknowns.iter().try_for_each(|(reference, inputs)| unknown(xml, *reference, Some(inputs.as_str())))
        })?;
        // Without dependencies: at the start everything may depend on all inputs and parameters.
        xml.create_element("InitialUnknowns")
            .write_inner_content(|xml| unknowns.iter().try_for_each(|(reference, _)| unknown(xml, *reference, None)))?;
        Ok(())
    })?;
    Ok(())
}

/// The indices of the inputs in these slots.
fn indices(variables: &VariableTable, slots: &[usize]) -> String {
    let is_among = |variable: &VariableRef| matches!(variable.role, Role::Input(slot) if slots.contains(&slot));
    let inputs = variables.entries().filter(|(_, variable)| is_among(variable));
    inputs.map(|(reference, _)| index(reference)).collect::<Vec<_>>().join(" ")
}

/// The standard counts the variables from 1 here; value references count them from 0.
fn index(reference: u32) -> String {
    (reference + 1).to_string()
}

fn unknown(xml: &mut Xml, reference: u32, dependencies: Option<&str>) -> io::Result<()> {
    let unknown = xml.create_element("Unknown").with_attribute(("index", index(reference).as_str()));
    unknown.with_attributes(dependencies.map(|inputs| ("dependencies", inputs))).write_empty().map(drop)
}

const LAYER_PAGE: &str = include_str!("../../../../modelDescription/documentation/index.html");
const PATCH_PAGE: &str = include_str!("../../../../modelDescription/documentation/patch.html");
const SEAL_PAGE: &str = include_str!("../../../../modelDescription/documentation/seal.html");
const ELEMENT_PAGE: &str = include_str!("../../../../modelDescription/documentation/element.html");

/// The files that are the same in every archive: path, content.
pub(super) const FIXED_FILES: [(&str, &str); 5] = [
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
pub(super) fn documentation(
    definition: &Definition,
    variables: &VariableTable,
    summary: &[LabelledLine],
) -> io::Result<Vec<u8>> {
    let page = match definition {
        Definition::Layer(_) => LAYER_PAGE,
        Definition::Element(_) => ELEMENT_PAGE,
        Definition::Patch(_) => PATCH_PAGE,
        Definition::Seal(_) => SEAL_PAGE,
    };
    let summary: Vec<_> = summary.iter().map(|(name, text)| [(*name).into(), clean(text)]).collect();
    let is_parameter = |variable: &&VariableRef| matches!(variable.role, Role::Parameter(_));
    let (parameters, others): (Vec<_>, Vec<_>) =
        variables.entries().map(|(_, variable)| variable).partition(is_parameter);
    let others: Vec<_> = others.iter().map(|variable| row(variable, causality(variable).into())).collect();
    let start = |variable| start(variable).unwrap_or_default();
    let parameters: Vec<_> = parameters.iter().map(|variable| row(variable, start(variable))).collect();
    let fields = [
        ("name", escape(clean(&definition.name())).into_owned()),
        ("description", escape(clean(&definition.description())).into_owned()),
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
mod tests_of_description {
    use std::path::Path;

    use asperity::element::{FrictionTable, PointContact};
    use asperity::patch::Patch;
    use asperity::scene::Scene;
    use asperity_fmi::{Definition, Sources, guid};

    use super::super::experiment;
    use super::*;

    /// The description of the default scene is kept in the repository, so that a change is seen. To accept an
    /// intended one: `BLESS=1 cargo test -p asperity-study golden`.
    #[test]
    fn the_default_scene_has_the_golden_description() {
        let root = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."));
        let path = root.join("scenes/tread-block/tread-block.toml");
        let model = Definition::from(Scene::load(&path).unwrap());
        let variables = model.variables();
        let guid = guid(&Sources::new(&path, &*model).unwrap(), &variables);
        let nominals = experiment::tables(&model, &variables).unwrap().nominals;
        let written =
            String::from_utf8(description(&*model, (&variables, &nominals), (&guid, "structured")).unwrap()).unwrap();
        let golden = root.join("modelDescription/modelDescription.xml");
        if std::env::var_os("BLESS").is_some() {
            std::fs::write(&golden, &written).unwrap();
        }
        assert!(written == std::fs::read_to_string(&golden).unwrap(), "BLESS=1 accepts the new description");
    }

    fn description_of(model: &Definition) -> String {
        let described = description(&**model, (&model.variables(), &Nominals::new()), ("{}", "structured"));
        String::from_utf8(described.unwrap()).unwrap()
    }

    #[test]
    fn dependencies_are_left_out_on_request() {
        let scene = "name = 'a'\nlayer = { masses = 1, spacing = 1.0, mass = 1.0, vertical = { stiffness = 1.0 } }\n\
                     surface = { kind = 'flat' }\n[fmu]\n";
        let of = |fmu: &str| {
            description_of(&Scene::parse(&format!("{scene}{fmu}"), Path::new("scene.toml")).unwrap().into())
        };
        let (listed, none) = (of(""), of("dependencies = 'none'"));
        assert!(listed.contains("dependencies=\"2\"") && listed.contains("providesDirectionalDerivative"));
        assert!(!none.contains("dependencies=\"2\"") && !none.contains("providesDirectionalDerivative"));
        assert_eq!(none.matches("dependencies=\"\"").count(), listed.matches("dependencies=").count());
    }

    #[test]
    fn elements_and_patches_have_a_default_experiment() {
        let end_after_500_steps = |described: String| {
            let number = |name: &str| -> f64 {
                let (_, rest) = described.split_once(&format!(" {name}=\"")).unwrap();
                rest.split('"').next().unwrap().parse().unwrap()
            };
            assert!((number("stopTime") / number("stepSize") - 500.0).abs() < 1e-9, "{described}");
            number("stopTime")
        };
        let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join("tests/reference/patch");
        let table = FrictionTable::load(&folder.join("block.table.csv")).unwrap();
        end_after_500_steps(description_of(&PointContact::new(table).into()));
        let text = "name = 'pad'\ntable = { path = 'block.table.csv' }\n[patch]\nshape = 'flat'\nlength = 0.01\n\
                    width = 0.01\nnx = 1\nny = 1";
        let end_of = |text: &str| {
            let patch = Patch::parse(text, &folder.join("patch.toml")).unwrap();
            end_after_500_steps(description_of(&patch.into()))
        };
        end_of(text);
        // A tread runs through its 10 mm ten times at the table's 10 m/s, in steps that are rounded down from 20 to 20 µs.
        let end = end_of(&format!("{text}\ntransport = true"));
        assert!((end - 0.01).abs() < 1e-12, "{end}");
    }

    #[test]
    fn the_default_step_is_a_round_number() {
        assert_eq!([round_down(5.2e-6), round_down(2.6e-6), round_down(1.0)], [5e-6, 2e-6, 1.0]);
        assert_eq!(real(round_down(5.2e-6)), "5e-6");
    }

    #[test]
    fn a_sum_of_decimals_is_written_without_its_roundings() {
        let scene = "name = 'sum'\nlayer = { masses = 1, spacing = 1.0, mass = 1.0 }\nsurface = { kind = 'flat' }\n\
                     excitation = [{ duration = 1e-2 }, { duration = 1e-3 }, { duration = 3e-3 }]";
        let model = Definition::from(Scene::parse(scene, Path::new("scene.toml")).unwrap());
        assert_eq!(model.default_experiment().unwrap().stop.map(real).as_deref(), Some("0.014"));
    }
}

#[cfg(test)]
mod tests_of_documentation {
    use super::*;

    #[test]
    fn the_licences_have_an_entry_point_that_names_the_others() {
        let licences: Vec<_> = FIXED_FILES
            .iter()
            .filter_map(|(path, text)| Some((path.strip_prefix("documentation/licenses/")?, text)))
            .collect();
        let (_, entry_point) = licences.iter().find(|(name, _)| *name == "license.txt").unwrap();
        let others = licences.iter().map(|(name, _)| *name).filter(|name| *name != "license.txt");
        assert!(others.clone().count() > 0 && others.clone().all(|name| entry_point.contains(name)), "{entry_point}");
    }
}
