//! What there is to say of an element: its table, and how well that is interpolated.

use asperity::element::{LeftOut, Load, Place, Table, left_out};

use crate::program::error::ProgramError;
use crate::program::text::{Row, lines, print};

/// What the table holds and what leaving its points out tells.
pub(super) fn rows(table: &Table) -> Vec<Row> {
    let mut rows = vec![
        ("Swept", table.scene.clone()),
        ("Speeds", axis(&table.speeds, "m/s")),
        ("Loads", axis(&table.pressures, table.load.unit())),
    ];
    if !table.temperatures.is_empty() {
        rows.push(("Temperature", axis(&table.temperatures, "K")));
    }
    if table.load == Load::Pressure {
        rows.push(("Area", format!("{:e} m²", table.nominal_area)));
    }
    rows.push(("w = 0", format!("a separation of {:e} m", table.rest_separation)));
    let texts = left_out(table).iter().filter_map(text).collect::<Vec<_>>();
    let none = "no axis has a point between two others".to_owned();
    let texts = if texts.is_empty() { vec![none] } else { texts };
    let named = texts.into_iter().enumerate().map(|(i, text)| (if i == 0 { "Left out" } else { "" }, text));
    rows.extend(named);
    rows
}

/// Prints rows.
pub(super) fn tell(rows: &[Row]) -> Result<(), ProgramError> {
    print(&lines(rows))
}

fn axis(values: &[f64], unit: &str) -> String {
    match values {
        [] => "none".into(),
        [one] => format!("{one} {unit}"),
        [first, .., last] => format!("{} from {first} to {last} {unit}", values.len()),
    }
}

/// The errors at the points of an axis that were left out one by one.
fn text(errors: &LeftOut) -> Option<String> {
    let of = |name: &str, error: Option<(f64, Place)>| {
        error.map(|(error, place)| format!("{name} is off by at most {:.2} %, at {place}", 100.0 * error))
    };
    let texts = [of("the friction coefficient", errors.friction), of("F_z", errors.force_z)];
    let texts: Vec<String> = texts.into_iter().flatten().collect();
    let axis = errors.axis;
    (!texts.is_empty()).then(|| format!("one {axis} and looked up over the gap: {}", texts.join("; ")))
}
