//! The summary of an element's table.

use asperity::element::{LeftOut, Load, OperatingPoint, Table, left_out};

use crate::labelled::{LabelledLine, labelled};

/// The summary of an element: its table, and the errors where points of it are left out and interpolated.
pub fn table_rows(table: &Table) -> Vec<LabelledLine> {
    let mut rows = vec![
        ("Swept", table.scene.clone()),
        ("Speeds", range(&table.grid.speeds, "m/s")),
        ("Loads", range(&table.grid.loads, table.load.unit())),
    ];
    if !table.grid.temperatures.is_empty() {
        rows.push(("Temperature", range(&table.grid.temperatures, "K")));
    }
    if let Load::Pressure { area } = table.load {
        rows.push(("Area", format!("{area:e} m²")));
    }
    let basis = &table.basis;
    let stated = [
        ("Foundation", &basis.foundation),
        ("Fine waves", &basis.fine),
        ("Sample", &basis.sample),
        ("Converged", &basis.convergence),
    ];
    rows.extend(stated.into_iter().filter_map(|(label, text)| Some((label, text.clone()?))));
    rows.push(("w = 0", format!("a separation of {:e} m", table.rest_separation)));
    let mut errors: Vec<_> = left_out(table).iter().filter_map(|axis| errors(axis, table.load)).collect();
    if errors.is_empty() {
        errors.push("no axis has a point between two others".to_owned());
    }
    rows.extend(labelled("Left out", errors));
    rows
}

fn range(values: &[f64], unit: &str) -> String {
    match values {
        [] => "none".into(),
        [one] => format!("{one} {unit}"),
        [first, .., last] => format!("{} from {first} to {last} {unit}", values.len()),
    }
}

/// The errors at the points of an axis, each left out in turn.
fn errors(errors: &LeftOut, load: Load) -> Option<String> {
    let of = |name: &str, error: Option<(f64, OperatingPoint)>| {
        error.map(|(error, point)| {
            format!("{name} is off by at most {:.2} %, at {}", 100.0 * error, point.describe(load))
        })
    };
    let texts = [of("the friction coefficient", errors.friction), of("F_z", errors.force_z)];
    let texts: Vec<String> = texts.into_iter().flatten().collect();
    let axis = errors.axis;
    (!texts.is_empty()).then(|| format!("one {axis} and looked up over the gap: {}", texts.join("; ")))
}
