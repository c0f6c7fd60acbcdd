//! The summary of a contact patch, and of an element's table.

use asperity::element::{FrictionTable, LeftOut, Load, OperatingPoint, left_out};
use asperity::patch::{MotionError, Patch, PatchRun, PatchStart, Pose};
use asperity::scene::{Backing, FaceHeat, Parameter, TableExtrapolation, Value};

use super::words::{DRY, LabelledLine, labelled};
use crate::decimals::rounded;
use crate::error::Error;

/// Tangential stiffness per area, Pa/m, above which a contact is stiffer than what can stand behind it.
const STIFF: f64 = 3e9;

/// Halvings of an interval of heights.
const HALVINGS: u32 = 50;

/// The summary of a patch.
pub fn described_patch(patch: &Patch) -> Vec<LabelledLine> {
    [vec![("Name", patch.name().to_owned())], patch_rows(patch)].concat()
}

/// The summary without the name.
pub fn patch_rows(patch: &Patch) -> Vec<LabelledLine> {
    let groups: Vec<&str> = patch.groups().iter().map(|group| group.word()).collect();
    let variables = patch.variables().len();
    let mut rows = vec![("Patch", patch.description())];
    rows.push(("Tread", if patch.has_tread() { "runs through the contact" } else { "none" }.to_owned()));
    rows.push(("Table", format!("{}, {} points", named(patch.table()), patch.table().grid.count())));
    if patch.has_temperatures() {
        rows.push(("Temperature", format!("an input, {} K at the start", patch.temperature())));
    }
    if let Some(Backing { normal, shear }) = patch.backing() {
        rows.push(("Backing", format!("{normal:e} Pa/m along the normal and {shear:e} Pa/m in shear, in series")));
    }
    rows.push(("Damping", damping(patch)));
    rows.push(("Fluid", DRY.to_owned()));
    if let Some(FaceHeat { conductivity, capacity, density, share }) = patch.heat() {
        let rubber = format!("{conductivity} W/(m K), {capacity} J/(kg K), {density} kg/m³");
        rows.push(("Heat", format!("{share} of what slip loses warms the elements, of {rubber}")));
    }
    rows.push(("Clear at", format!("z = {} m and above, level", patch.clear_height())));
    rows.push(("Low end", low_end(patch)));
    rows.push(("Outputs", format!("{}: {variables} variables", groups.join(", "))));
    rows
}

fn damping(patch: &Patch) -> String {
    match (patch.damping(), patch.table().header.text_of("damping")) {
        (0.0, Some(suggested)) => format!("none, so that what sticks swings without loss; {suggested}"),
        (0.0, None) => "none, so that what sticks swings without loss".to_owned(),
        (damping, _) => format!("{damping:e} s, of the springs along the plane and of the backing"),
    }
}

/// A warning where the contacts of the table are stiffer than anything of rubber that could stand behind them: a
/// millimetre of it at G = 3 MPa.
pub fn missing_backing(patch: &Patch) -> Option<String> {
    let stiffness = patch.contact_stiffness();
    (patch.backing().is_none() && stiffness > STIFF).then(|| {
        format!(
            "contacts have a tangential stiffness of {stiffness:.1e} Pa/m at the table's largest pressure, and what stands \
             behind them is left out: in rolling and where motion begins the patch is too stiff; see [patch] backing"
        )
    })
}

/// How much of the load lies below the table's least pressure where the largest is that of the table.
fn low_end(patch: &Patch) -> String {
    let load = patch.table().load;
    let least = patch.table().grid.loads.first().copied().unwrap_or_default();
    match share_below_table(patch) {
        Ok(share) => format!(
            "{} % of the load is borne below {least} {}, where {}, when the face stands level and its largest pressure is the \
             table's",
            rounded(100.0 * share, 2),
            load.unit(),
            if patch.table().is_measured() { "friction is that at it" } else { "the law is a parabola" }
        ),
        Err(error) => error.to_string(),
    }
}

fn share_below_table(patch: &Patch) -> Result<f64, Error> {
    // The search presses the face a little beyond the table.
    let mut patch = patch.clone();
    patch.set_parameter(Parameter::TABLE_EXTRAPOLATION, Value::Text(TableExtrapolation::Hold.word().into()))?;
    Ok(at_rest(&patch, height_of_largest_pressure(&patch)?)?.share_below_table())
}

/// The height (m) at which the lowest element of a level face bears the largest pressure of the table.
fn height_of_largest_pressure(patch: &Patch) -> Result<f64, MotionError> {
    let inside = patch.elements().filter(|element| element.area > 0.0);
    let lowest = patch.with_elements(inside.min_by(|a, b| a.place[2].total_cmp(&b.place[2])));
    let (mut high, mut step) = (patch.clear_height(), 1e-7);
    let mut low = high - step;
    while !at_rest(&lowest, low)?.pressure_is_beyond() && step < 1.0 {
        step *= 2.0;
        low = high - step;
    }
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if at_rest(&lowest, middle)?.pressure_is_beyond() { low = middle } else { high = middle }
    }
    Ok(high)
}

/// The patch at rest, level, at a height (m).
fn at_rest(patch: &Patch, z: f64) -> Result<PatchRun, MotionError> {
    let pose = Pose { place: [0.0, 0.0, z], angles: [0.0; 3] };
    PatchRun::new(patch, &PatchStart { pose, temperature: patch.temperature(), ..PatchStart::default() })
}

/// The summary of an element: its table, and the errors where points of it are left out and interpolated.
pub fn table_rows(table: &FrictionTable) -> Vec<LabelledLine> {
    let mut rows = vec![
        (if table.is_measured() { "Measured" } else { "Swept" }, table.scene().to_owned()),
        ("Speeds", range(&table.grid.speeds, "m/s")),
        ("Loads", range(&table.grid.loads, table.load.unit())),
    ];
    if !table.grid.temperatures.is_empty() {
        rows.push(("Temperature", range(&table.grid.temperatures, "K")));
    }
    if let Some((full, all)) = full_contact(table) {
        rows.push(("Full contact", format!("at {full} of {all} points, where the backing alone gives way")));
    }
    if table.is_measured() {
        rows.push(("Contacts", "give way in their backing alone: how they do was not measured".to_owned()));
    } else if let Load::Pressure { area } = table.load {
        rows.push(("Area", format!("{area:e} m²")));
    }
    let stated = [
        ("Foundation", "foundation"),
        ("Fine waves", "fine"),
        ("Sample", "sample"),
        ("Converged", "convergence"),
        ("Damping", "damping"),
    ];
    rows.extend(stated.into_iter().filter_map(|(label, key)| Some((label, table.header.text_of(key)?.to_owned()))));
    if !table.is_measured() {
        rows.push(("w = 0", format!("a separation of {:e} m", table.rest_separation)));
    }
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

/// A table by its scene, or by its file where it was measured.
pub(super) fn named(table: &FrictionTable) -> String {
    if table.is_measured() { table.origin() } else { table.scene().to_owned() }
}

/// How many points of a sweep's table are in full contact, where some are, and how many it has.
fn full_contact(table: &FrictionTable) -> Option<(usize, usize)> {
    let all = table.grid.count();
    let full = table.nodes().filter(|node| table.is_full_contact(*node)).count();
    (full > 0 && !table.is_measured()).then_some((full, all))
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

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use std::path::Path;

    use super::*;

    #[test]
    fn the_low_end_is_the_same_where_elements_beyond_the_table_are_refused() {
        let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join("tests/reference/patch");
        let with = |extrapolation: &str| {
            let text = format!(
                "name = 'p'\n[table]\npath = 'winkler.table.csv'\nextrapolation = '{extrapolation}'\n[patch]\nshape = \
                 'cylinder'\nradius = 0.3\nlength = 0.03\nwidth = 0.02\nnx = 40\nny = 3\ntransport = true\noffset = \
                 [0.0, 0.0, 0.1]\n"
            );
            Patch::parse(&text, &folder.join("p.toml")).unwrap()
        };
        let patch = with("hold");
        // Of all elements at that height none is beyond the table, and 1 nm lower one is.
        let height = height_of_largest_pressure(&patch).unwrap();
        let is_beyond = |z: f64| at_rest(&patch, z).unwrap().pressure_is_beyond();
        assert!(!is_beyond(height) && is_beyond(height - 1e-9));
        let held = low_end(&patch);
        assert!(held.contains(" % of the load is borne below "), "{held}");
        assert_eq!(low_end(&with("refuse")), held);
    }
}
