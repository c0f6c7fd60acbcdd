//! What a scene says, not how it says it.

use asperity::scene::{Link, Scene};
use proptest::prelude::*;

use crate::physics::invariants::case::{Case, Record};
use crate::physics::invariants::check::check;
use crate::physics::invariants::random::cases;

/// A scene written as TOML reads back as itself, in whichever order its keys stand.
#[test]
fn the_order_of_the_keys_is_free() {
    // More than any scene has.
    let keys: Vec<usize> = (0..100).collect();
    check("the order of keys", 300, (cases(), Just(keys).prop_shuffle()), |(case, order)| {
        let read = |text: &str| {
            let scene = Scene::parse(text, std::path::Path::new("case.toml"));
            scene.map_err(|error| TestCaseError::fail(format!("{error}\n{text}")))
        };
        let plain = read(&case.text().text())?;
        prop_assert_eq!(&read(&case.text().shuffled(&order).text())?, &plain);
        let expected = Scene { excitation: plain.excitation.clone(), warnings: plain.warnings.clone(), ..case.scene };
        prop_assert_eq!(plain, expected);
        Ok(())
    });
}

fn run(case: &Case) -> Result<Record, TestCaseError> {
    case.run(4).map_err(|error| TestCaseError::fail(format!("{error}")))
}

/// A link without spring, damper and elements is no link.
#[test]
fn an_empty_link_changes_no_bit() {
    check("an empty link", 100, cases(), |case| {
        let mut with = case.clone();
        let layer = &mut with.scene.layer;
        for link in &mut layer.links {
            link.get_or_insert(Link { stiffness: Some(0.0), damping: None, maxwell: Vec::new() });
        }
        let (one, other) = (run(&case)?, run(&with)?);
        for (column, variable) in one.variables.iter().enumerate() {
            let of = |record: &Record| record.get(variable.output);
            // -0 is 0.
            prop_assert!(of(&one) == of(&other), "{} ({column})", variable.name);
        }
        Ok(())
    });
}
