//! `asperity describe --patch`: summarises a contact patch; the same lines go into an FMU's documentation.

use std::path::Path;

use asperity::patch::{MotionError, Patch, PatchError, PatchRun, PatchStart, Pose};

use crate::program::files::{FileError, print};
use crate::program::terminal::{LabelledLine, lines, rounded};

/// `asperity describe --patch` failed.
#[derive(Debug, thiserror::Error)]
pub(crate) enum PatchDescribeError {
    #[error(transparent)]
    File(#[from] FileError),
    #[error(transparent)]
    Patch(#[from] PatchError),
}

/// Halvings of an interval of heights.
const HALVINGS: u32 = 50;

/// Prints the summary.
pub(crate) fn describe(path: &Path) -> Result<(), PatchDescribeError> {
    let patch = Patch::load(path)?;
    let title = ("Name", patch.name().to_owned());
    Ok(print(&lines(&[vec![title], rows(&patch)].concat()))?)
}

/// The summary without the name.
pub(crate) fn rows(patch: &Patch) -> Vec<LabelledLine> {
    let groups: Vec<&str> = patch.groups().iter().map(|group| group.word()).collect();
    let variables = patch.variables().len();
    let mut rows = vec![("Patch", patch.description())];
    rows.push(("Tread", if patch.has_tread() { "runs through the contact" } else { "none" }.to_owned()));
    rows.push(("Table", format!("{}, {} points", patch.table().scene, patch.table().grid.count())));
    if patch.has_temperatures() {
        rows.push(("Temperature", format!("an input, {} K at the start", patch.temperature())));
    }
    rows.push(("Clear at", format!("z = {} m and above, level", patch.clear_height())));
    rows.push(("Low end", low_end(patch)));
    rows.push(("Outputs", format!("{}: {variables} variables", groups.join(", "))));
    rows
}

/// How much of the load lies below the table's least pressure where the largest is that of the table.
fn low_end(patch: &Patch) -> String {
    let load = patch.table().load;
    let least = patch.table().grid.loads.first().copied().unwrap_or_default();
    match share_below_table(patch) {
        Ok(share) => format!(
            "{} % of the load is borne below {least} {}, where the law is a parabola, when the face stands level and its \
             largest pressure is the table's",
            rounded(100.0 * share, 2),
            load.unit()
        ),
        Err(error) => error.to_string(),
    }
}

fn share_below_table(patch: &Patch) -> Result<f64, MotionError> {
    let at = |z: f64| {
        let pose = Pose { place: [0.0, 0.0, z], angles: [0.0; 3] };
        PatchRun::new(patch, &PatchStart { pose, temperature: patch.temperature(), ..PatchStart::default() })
    };
    let (mut high, mut step) = (patch.clear_height(), 1e-7);
    let mut low = high - step;
    while !at(low)?.pressure_is_beyond() && step < 1.0 {
        step *= 2.0;
        low = high - step;
    }
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if at(middle)?.pressure_is_beyond() { low = middle } else { high = middle }
    }
    Ok(at(high)?.share_below_table())
}
