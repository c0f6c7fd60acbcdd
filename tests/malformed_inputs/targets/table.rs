//! The table of a sweep: an error with a position and a reason, or an element that moves over it.

use std::path::Path;

use asperity::element::{Element, FrictionTable, Node, PointContact, Quantity};
use asperity::outputs::Variable;
use asperity::scene::{Parameter, Value};
use asperity::simulation::Start;

/// Reads all bytes but the first as a table and moves an element over it, beyond its ends if the first is odd.
pub fn run(bytes: &[u8]) {
    let Some((first, text)) = bytes.split_first() else { return };
    let Ok(text) = std::str::from_utf8(text) else { return };
    match FrictionTable::parse(text, Path::new("table.csv")) {
        Ok(table) => run_table(table, first % 2 == 1),
        Err(error) => {
            let message = error.to_string();
            assert!(message.starts_with("table.csv:"), "{message}");
        }
    }
}

/// From the middle of the table to its ends and past them, along both axes.
fn run_table(table: FrictionTable, goes_beyond: bool) {
    let (slow, fast) = (table.grid.speeds[0], table.grid.speeds[table.grid.speeds.len() - 1]);
    let separations =
        [0, table.grid.loads.len() - 1].map(|load| table.value(Quantity::Separation, Node { load, ..Node::default() }));
    let height = separations[0] - separations[1];
    let w = 0.5 * (separations[0] + separations[1]) - table.rest_separation;
    let mut contact = PointContact::new(table);
    if goes_beyond {
        contact.set_parameter(Parameter::TABLE_EXTRAPOLATION, Value::Text("hold".into())).unwrap();
    }
    let variables = contact.variables();
    let Ok(mut element) = Element::new(&contact, &Start { w, ..Start::default() }) else { return };
    check(&element, &variables);
    let way = element.stick_length().max(height);
    for (u_rate, moved) in
        [(slow, 0.0), (fast, -0.3 * height), (-fast, 0.3 * height), (2.0 * fast, -height), (0.0, way)]
    {
        let duration = way / fast;
        let before = element.save();
        match element.advance(duration, u_rate, moved / duration) {
            Ok(()) => check(&element, &variables),
            Err(error) => {
                assert!(!error.to_string().is_empty());
                assert_eq!(element.save(), before);
            }
        }
        // A run that was saved goes on as it was.
        let restored = Element::restore(&contact, &element.save()).unwrap();
        assert_eq!(restored.save(), element.save());
    }
}

/// Checks for finite outputs and a contact that only presses.
fn check(element: &Element, variables: &[Variable]) {
    let mut values = vec![f64::NAN; variables.len()];
    element.evaluate(variables, &mut values);
    for (variable, value) in variables.iter().zip(&values) {
        assert!(value.is_finite(), "{} = {value}", variable.name);
        assert!(variable.name != "F_z" || *value >= 0.0, "F_z = {value}");
    }
}
