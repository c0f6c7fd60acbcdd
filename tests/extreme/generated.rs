//! What the tables name in a word and a scene spells out: profiles made by a rule, lists of Maxwell elements.

use toml::{Table, Value};

use crate::catalogue::number;

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

/// Spells out what is named in a word.
pub fn expand(scene: &mut Table) {
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

/// Between 0 and 1, the same for the same place: Steele's splitmix64.
fn noise(seed: u64, place: usize) -> f64 {
    let mut x = (seed << 32).wrapping_add(place as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((x ^ (x >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
}

/// A table as one line of TOML, the scene file of a case line by line.
pub fn text(scene: &Table) -> String {
    scene.iter().map(|(key, value)| format!("{key} = {}\n", inline(value))).collect()
}

pub fn inline(value: &Value) -> String {
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
