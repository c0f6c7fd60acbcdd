//! The catalogue: families of scenes from the tables in `data`.
//!
//! A family has a base scene, what is set in all of its scenes, and a list of what is varied, each entry one scene:
//! tables laid over each other. The key `run` is not the scene's: how it is driven and judged.

use std::fs;
use std::path::Path;

use asperity::simulation::Start;
use toml::{Table, Value};

use crate::{common, generated};

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
    /// The scene, but for method, tolerance and outputs.
    pub scene: Table,
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
    let others = ["bases.toml", "known.toml", "phrases.toml"];
    let is_family = |path: &&std::path::PathBuf| !others.iter().any(|other| path.ends_with(other));
    let cases: Vec<Case> = files.iter().filter(is_family).flat_map(|file| families(&table(file), &bases)).collect();
    let mut names: Vec<&str> = cases.iter().map(|case| case.name.as_str()).collect();
    names.sort_unstable();
    names.windows(2).for_each(|pair| assert_ne!(pair[0], pair[1], "two scenes of one name"));
    cases
}

pub fn table(file: &Path) -> Table {
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
        lay_over(&mut common, set.as_table().unwrap());
    }
    let entries = family["scenes"].as_array().unwrap();
    entries
        .iter()
        .map(|entry| {
            let entry = entry.as_table().unwrap();
            let mut scene = common.clone();
            lay_over(&mut scene, entry);
            case(&format!("{}: {}", text("name"), label(entry)), [text("phrase"), text("item")], scene)
        })
        .collect()
}

/// Lays `over` upon `table`: tables are joined, anything else is replaced. A table that changes its kind is replaced
/// whole.
fn lay_over(table: &mut Table, over: &Table) {
    for (key, value) in over {
        let replaced = value.get("kind").is_some() || value.get("make").is_some();
        match (table.get_mut(key), value) {
            (Some(Value::Table(below)), Value::Table(above)) if !replaced => lay_over(below, above),
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
            let text = value.as_float().map_or_else(|| generated::inline(value), |number| format!("{number:e}"));
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
    generated::expand(&mut scene);
    Case {
        name: name.to_owned(),
        phrase: phrase.to_owned(),
        item: text("item").unwrap_or_else(|| item.to_owned()),
        start: Start {
            time: start("time"),
            u: start("u"),
            w: start("w"),
            u_rate: start("u_rate"),
            w_rate: start("w_rate"),
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
