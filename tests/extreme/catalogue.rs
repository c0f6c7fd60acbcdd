//! The catalogue: families of scenes from the tables in `data`, and a scene with the perturbations of
//! [`asperity_study::robustness`].
//!
//! A family has a base scene, values set in all of its scenes, and a list of variations, each one scene: tables that
//! override each other. The key `run` is not part of the scene: it says how the scene is driven and judged.

use std::fs;
use std::path::Path;

use asperity::math::SplitMix64;
use asperity::simulation::Start;
use asperity_study::robustness::{Perturbation, ScaledQuantity};
use toml::{Table, Value};

use crate::common;

/// How a scene is driven through the C interface.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Script {
    pub steps: Vec<Steps>,
}

/// Communication steps that are alike.
#[derive(Clone, Debug, PartialEq)]
pub struct Steps {
    pub count: usize,
    /// Lengths, s, one after another and round again.
    pub h: Vec<f64>,
    /// Where u and w jump to before the first of the steps, m.
    pub jump: [Option<f64>; 2],
    /// Rates that are given with each step, m/s.
    pub rate: [Option<f64>; 2],
    /// What every one of these steps has to answer.
    pub expect: Answer,
}

/// What a step through the C interface answers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Answer {
    Ok,
    Discard,
    Error,
}

/// One scene and how it is run.
#[derive(Clone, Debug)]
pub struct Case {
    pub name: String,
    /// The phrase of the specification that it stands for, and the item in it.
    pub phrase: String,
    pub item: String,
    /// The scene without method, tolerance and outputs.
    pub scene: Table,
    /// Applied to the scene; runs through the C interface are without it.
    pub perturbation: Perturbation,
    pub start: Start,
    /// Even rows of a phase.
    pub rows: u32,
    /// The tight run's tolerance over the scene's.
    pub tight: f64,
    /// Why the motion is sensitive, so that only means and losses can be compared.
    pub sensitive: Option<String>,
    /// Steps of each phase when it is run through the C interface too.
    pub fmu_steps: Option<usize>,
    /// The steps where it is run through the C interface alone.
    pub script: Option<Script>,
    /// The errors that it has to end with.
    pub ends: Ends,
    /// Whether nothing forgets an error, so that every step may make its own.
    pub undamped: bool,
    /// Whether, beside that, nothing is lost or gained once the first phase is over: T + V never grows, and what each
    /// step loses adds up.
    pub free_of_work: bool,
}

/// How a case ends before its end, by method: the name of the error, one of [`Stop`](crate::run::Stop)'s.
#[derive(Clone, Debug, Default)]
pub struct Ends {
    pub event: Option<String>,
    pub step: Option<String>,
    /// Why that is right.
    pub reason: String,
}

/// All scenes, in the order of the tables.
pub fn read() -> Vec<Case> {
    let folder = common::root().join("tests/extreme/data");
    let bases = table(&folder.join("bases.toml"));
    let mut files: Vec<_> = fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    files.retain(|file| !file.ends_with("bases.toml"));
    let mut cases: Vec<Case> = files.iter().flat_map(|file| families(&table(file), &bases)).collect();
    cases.extend(perturbed(&bases));
    let mut names: Vec<&str> = cases.iter().map(|case| case.name.as_str()).collect();
    names.sort_unstable();
    names.windows(2).for_each(|pair| assert_ne!(pair[0], pair[1], "two scenes of one name"));
    cases
}

/// The block with each of its quantities scaled. Stiffer by 10⁶ it swings for 10⁵ periods.
fn perturbed(bases: &Table) -> Vec<Case> {
    const POWERS: [i32; 3] = [-6, -3, 3];
    const PHRASE: &str = "quantities scaled by powers of ten";
    // The first are those of every layer, the others those of a carrier that is a body and of a master.
    let quantities = ScaledQuantity::ALL.into_iter().take(4);
    let scaled = |(quantity, power): (ScaledQuantity, i32)| {
        let name = format!("scaled: {} × 1e{power}", quantity.name());
        let block = case(&name, [PHRASE, quantity.name()], bases["block"].as_table().unwrap().clone());
        Case { perturbation: Perturbation::default().with(quantity, power), ..block }
    };
    quantities.flat_map(|quantity| POWERS.map(|power| (quantity, power))).map(scaled).collect()
}

fn table(file: &Path) -> Table {
    let text = fs::read_to_string(file).unwrap();
    text.parse().unwrap_or_else(|error| panic!("{}: {error}", file.display()))
}

fn families(file: &Table, bases: &Table) -> Vec<Case> {
    file["family"].as_array().unwrap().iter().flat_map(|family| scenes(family.as_table().unwrap(), bases)).collect()
}

fn scenes(family: &Table, bases: &Table) -> Vec<Case> {
    let text = |key: &str| family[key].as_str().unwrap();
    let mut common = bases[text("base")].as_table().unwrap().clone();
    if let Some(set) = family.get("set") {
        override_by(&mut common, set.as_table().unwrap());
    }
    let entries = family["scenes"].as_array().unwrap();
    entries
        .iter()
        .map(|entry| {
            let entry = entry.as_table().unwrap();
            let mut scene = common.clone();
            override_by(&mut scene, entry);
            case(&format!("{}: {}", text("name"), label(entry)), [text("phrase"), text("item")], scene)
        })
        .collect()
}

/// Overrides `table` by `over`: tables are merged, anything else is replaced, also a table that changes its kind.
fn override_by(table: &mut Table, over: &Table) {
    for (key, value) in over {
        let replaced = value.get("kind").is_some() || value.get("make").is_some();
        match (table.get_mut(key), value) {
            (Some(Value::Table(below)), Value::Table(above)) if !replaced => override_by(below, above),
            _ => drop(table.insert(key.clone(), value.clone())),
        }
    }
}

/// The name given, or what is varied.
fn label(entry: &Table) -> String {
    let given = entry.get("run").and_then(|run| run.get("name")).and_then(Value::as_str);
    given.map_or_else(|| leaves(entry, "").join(", "), str::to_owned)
}

/// Every value with its key, after that of its table where that is a link.
fn leaves(entry: &Table, within: &str) -> Vec<String> {
    let leaf = |(key, value): (&String, &Value)| match value {
        Value::Table(run) if key == "run" => {
            run.get("start").map_or_else(Vec::new, |start| leaves(start.as_table().unwrap(), ""))
        }
        Value::Table(inner) if within == "layer" => leaves(inner, &format!("{key} ")),
        Value::Table(inner) => leaves(inner, if key == "layer" { key } else { "" }),
        value => {
            let link = within.trim_start_matches("layer");
            let text = value.as_float().map_or_else(|| inline(value), |number| format!("{number:e}"));
            vec![format!("{link}{key} {text}").replace('"', "")]
        }
    };
    entry.iter().flat_map(leaf).collect()
}

fn case(name: &str, [phrase, item]: [&str; 2], mut scene: Table) -> Case {
    let run = scene.remove("run").map_or_else(Table::new, |run| run.as_table().unwrap().clone());
    let text = |key: &str| run.get(key).map(|value| value.as_str().unwrap().to_owned());
    let flag = |key: &str| run.get(key).is_some_and(|flag| flag.as_bool().unwrap());
    let start = |key: &str| run.get("start").and_then(|start| start.get(key)).map_or(0.0, number);
    let known = [
        "name",
        "item",
        "start",
        "rows",
        "tight",
        "sensitive",
        "fmu",
        "script",
        "error",
        "reason",
        "undamped",
        "free_of_work",
    ];
    run.keys().for_each(|key| assert!(known.contains(&key.as_str()), "{name}: run.{key}"));
    expand(&mut scene);
    Case {
        name: name.to_owned(),
        phrase: phrase.to_owned(),
        perturbation: Perturbation::default(),
        item: text("item").unwrap_or_else(|| item.to_owned()),
        start: Start {
            time: start("time"),
            u: start("u"),
            w: start("w"),
            u_rate: start("u_rate"),
            w_rate: start("w_rate"),
            ..Start::default()
        },
        rows: run.get("rows").map_or(24, |rows| rows.as_integer().unwrap().try_into().unwrap()),
        tight: run.get("tight").map_or(1e-3, number),
        sensitive: text("sensitive"),
        fmu_steps: run.get("fmu").map(|steps| steps.as_integer().unwrap().try_into().unwrap()),
        script: run
            .get("script")
            .map(|steps| Script { steps: steps.as_array().unwrap().iter().map(steps_of).collect() }),
        ends: run.get("error").map_or_else(Ends::default, |error| Ends {
            event: error.get("event").map(|name| name.as_str().unwrap().to_owned()),
            step: error.get("step").map(|name| name.as_str().unwrap().to_owned()),
            reason: text("reason").expect("an error has its reason"),
        }),
        undamped: flag("undamped") || flag("free_of_work"),
        free_of_work: flag("free_of_work"),
        scene,
    }
}

pub fn number(value: &Value) -> f64 {
    value
        .as_float()
        .or_else(|| value.as_integer().map(|whole| whole as f64))
        .unwrap_or_else(|| panic!("no number: {value:?}"))
}

fn steps_of(value: &Value) -> Steps {
    let optional = |key: &str| value.get(key).map(number);
    let h = match &value["h"] {
        Value::Array(lengths) => lengths.iter().map(number).collect(),
        length => vec![number(length)],
    };
    let expect = match value.get("expect").map(|answer| answer.as_str().unwrap()) {
        None => Answer::Ok,
        Some("discard") => Answer::Discard,
        Some("error") => Answer::Error,
        Some(other) => panic!("no answer is called {other}"),
    };
    Steps {
        count: value.get("count").map_or(1, |count| count.as_integer().unwrap().try_into().unwrap()),
        h,
        jump: [optional("u"), optional("w")],
        rate: [optional("u_rate"), optional("w_rate")],
        expect,
    }
}

/// Relaxation time, s, and modulus, MPa, of a tread-like compound: a generalised Maxwell model of 16 terms,
/// non-negative least squares on measured storage and loss moduli over some 20 decades of frequency.
const COMPOUND: [(f64, f64); 16] = [
    (1e-13, 1538.0),
    (1e-12, 888.0),
    (1e-11, 824.0),
    (1e-10, 495.0),
    (1e-9, 201.0),
    (1e-8, 76.3),
    (1e-7, 31.9),
    (1e-6, 14.8),
    (1e-5, 8.12),
    (1e-4, 4.65),
    (1e-3, 3.16),
    (1e-2, 2.26),
    (0.1, 1.67),
    (1.0, 1.42),
    (10.0, 0.969),
    (100.0, 1.26),
];

/// Spells out profiles made by a rule and lists of Maxwell elements.
fn expand(scene: &mut Table) {
    if let Some(surface) = scene.get_mut("surface").and_then(Value::as_table_mut)
        && let Some(make) = surface.get("make").cloned()
    {
        *surface = profile(make.as_str().unwrap(), surface);
    }
    let layer = scene["layer"].as_table_mut().unwrap();
    for kind in ["vertical", "horizontal", "lateral_x", "lateral_z"] {
        if let Some(maxwell) = layer.get_mut(kind).and_then(|link| link.get_mut("maxwell"))
            && maxwell.is_table()
        {
            *maxwell = elements(maxwell.as_table().unwrap());
        }
    }
}

/// `{ compound = N/m per MPa }`, or `{ count, from, to, stiffness }`: relaxation times in even ratios.
fn elements(rule: &Table) -> Value {
    let list: Vec<(f64, f64)> = match rule.get("compound") {
        Some(scale) => COMPOUND.iter().map(|(tau, modulus)| (number(scale) * modulus, *tau)).collect(),
        None => {
            let [count, from, to, stiffness] = ["count", "from", "to", "stiffness"].map(|key| number(&rule[key]));
            let tau = |i: usize| from * (to / from).powf(i as f64 / (count - 1.0).max(1.0));
            (0..count as usize).map(|i| (stiffness, tau(i))).collect()
        }
    };
    let element = |(stiffness, tau)| {
        Value::Table(Table::from_iter([
            ("stiffness".into(), Value::Float(stiffness)),
            ("relaxation_time".into(), Value::Float(tau)),
        ]))
    };
    Value::Array(list.into_iter().map(element).collect())
}

/// A profile through points by a rule.
fn profile(make: &str, rule: &Table) -> Table {
    let of = |key: &str| number(rule.get(key).unwrap_or_else(|| panic!("{make} needs {key}")));
    let (count, spacing) = (of("points") as usize, of("spacing"));
    let height = |i: usize| match make {
        "noise" => of("height") * noise(of("seed") as u64, i % count),
        // Half the points low, half high.
        "step" => of("height") * f64::from(u8::from(2 * i >= count)),
        // Teeth whose flanks rise and fall at an angle, so many points each.
        "teeth" => {
            let flank = of("flank") as usize;
            let along = i % (2 * flank);
            let up = along.min(2 * flank - along);
            up as f64 * spacing * of("degrees").to_radians().tan()
        }
        // One sharp crest in the middle.
        "spike" => of("height") * f64::from(u8::from(2 * i == count)),
        other => panic!("no profile is made by {other}"),
    };
    let periodic = rule.get("periodic").is_some_and(|flag| flag.as_bool().unwrap());
    let floats = |values: Vec<f64>| Value::Array(values.into_iter().map(Value::Float).collect());
    let origin = rule.get("from").map_or(0.0, number);
    Table::from_iter([
        ("kind".into(), Value::String("points".into())),
        ("x".into(), floats((0..=count).map(|i| origin + spacing * i as f64).collect())),
        ("z".into(), floats((0..=count).map(height).collect())),
        ("periodic".into(), Value::Boolean(periodic)),
    ])
}

/// Between 0 and 1, the same for the same index.
fn noise(seed: u64, index: usize) -> f64 {
    SplitMix64::new(((seed << 32).wrapping_add(index as u64)).wrapping_mul(0x9e37_79b9_7f4a_7c15)).unit()
}

/// A table as one line of TOML, the scene file of a case line by line.
pub fn text(scene: &Table) -> String {
    scene.iter().map(|(key, value)| format!("{key} = {}\n", inline(value))).collect()
}

fn inline(value: &Value) -> String {
    match value {
        Value::Table(table) => {
            let fields: Vec<String> = table.iter().map(|(key, value)| format!("{key} = {}", inline(value))).collect();
            format!("{{ {} }}", fields.join(", "))
        }
        Value::Array(values) => format!("[{}]", values.iter().map(inline).collect::<Vec<_>>().join(", ")),
        Value::Float(number) => format!("{number:?}"),
        Value::String(text) => format!("{text:?}"),
        Value::Integer(number) => number.to_string(),
        Value::Boolean(flag) => flag.to_string(),
        Value::Datetime(_) => panic!("no scene has a date"),
    }
}
