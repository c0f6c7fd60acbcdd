//! Keys of a file set in its text, so that its comments stay: for what a person goes on to read.

use asperity::scene::Setting;
use toml_edit::{DocumentMut, Item, TableLike, Value};

/// The text of a TOML file with keys set, those that it does not have added. A text that is not TOML stays as it is, and so
/// do keys in files that it names.
pub fn edited(text: &str, settings: &[Setting]) -> String {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let Some(mut document) =
        Some(settings).filter(|set| !set.is_empty()).and_then(|_| text.parse::<DocumentMut>().ok())
    else {
        return text.to_owned();
    };
    for Setting { key, value } in settings {
        if let Ok(value) = value.to_string().parse::<Value>() {
            set(document.as_table_mut(), key, value);
        }
    }
    document.to_string()
}

/// Sets what is at the path of a key below a table; `None` where there is no place for it.
fn set(table: &mut dyn TableLike, path: &str, value: Value) -> Option<()> {
    let (part, rest) = path.split_once('.').map_or((path, None), |(part, rest)| (part, Some(rest)));
    let Some((name, element)) = part.split_once('[') else {
        match rest {
            None => drop(table.insert(part, value.into())),
            Some(rest) => {
                let below = table.entry(part).or_insert_with(|| toml_edit::Table::new().into());
                set(below.as_table_like_mut()?, rest, value)?;
            }
        }
        return Some(());
    };
    let element = element.strip_suffix(']')?.parse::<usize>().ok()?.checked_sub(1)?;
    match (table.get_mut(name)?, rest) {
        (Item::ArrayOfTables(tables), Some(rest)) => set(tables.get_mut(element)?, rest, value),
        (Item::Value(Value::Array(list)), Some(rest)) => {
            set(list.get_mut(element)?.as_inline_table_mut()?, rest, value)
        }
        (Item::Value(Value::Array(list)), None) if element < list.len() => {
            list.replace(element, value);
            Some(())
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "name = 'a' # its name\n[layer]\nmasses = 2\n[layer.vertical]\nmaxwell = [{ stiffness = 1.0 }, \
                        { stiffness = 2.0 }]\n[fmu]\noutputs = ['forces']\n[material]\nprony = 'compound.csv'\n\
                        [[excitation]]\nduration = 1.0\n[[excitation]]\nduration = 2.0\nu_sine = { amplitude = 1.0 }\n";

    #[test]
    fn every_key_can_be_set_and_the_rest_of_the_text_stays() {
        assert_eq!(edited(TEXT, &[]), TEXT);
        let changed = |key: &str, value: &str, from: &str, to: &str| {
            assert!(TEXT.contains(from), "{from}");
            assert_eq!(edited(TEXT, &[Setting::parse(key, value)]), TEXT.replacen(from, to, 1), "{key}");
        };
        changed("layer.masses", "4", "masses = 2", "masses = 4");
        changed("layer.vertical.maxwell[2].stiffness", "1e3", "stiffness = 2.0", "stiffness = 1000.0");
        changed("excitation[2].u_sine.amplitude", ".5", "amplitude = 1.0", "amplitude = 0.5");
        changed("excitation[1].duration", "5", "duration = 1.0", "duration = 5");
        changed("fmu.outputs", "['contact', 'energy']", "['forces']", "[\"contact\", \"energy\"]");
        changed("fmu.outputs[1]", "contact", "'forces'", "\"contact\"");
        changed("material.prony[2].modulus", "1e6", "name", "name");
        assert!(edited(TEXT, &[Setting::new("solver.method", "step")]).contains("[solver]\nmethod = \"step\""));
    }
}
