//! A patch file and the points that it names: an error with a position and a reason, or a patch that moves.

use std::fs;
use std::path::PathBuf;
use std::sync::OnceLock;

use asperity::patch::{Patch, PatchError, PatchMotion, PatchRun, PatchStart, Pose};
use asperity::scene::{FaceShape, PatchFile};

use super::patches::{self, Judged, POINTS};

/// Elements that there is time for.
const MAX_ELEMENTS: usize = 70;
/// Length of a text, bytes; longer ones test nothing new.
const MAX_BYTES: usize = 4096;
/// The line between the patch file and the points.
const BREAK: &str = "\n%\n";

fn folder() -> &'static PathBuf {
    static FOLDER: OnceLock<PathBuf> = OnceLock::new();
    FOLDER.get_or_init(|| patches::folder("patch"))
}

/// Reads a patch and, after a line with a percent sign, its points, and moves it about where it touches.
pub fn run(bytes: &[u8]) {
    let Some(text) = std::str::from_utf8(bytes).ok().filter(|text| text.len() <= MAX_BYTES) else { return };
    let (text, points) = text.split_once(BREAK).unwrap_or((text, POINTS));
    let path = folder().join("patch.toml");
    fs::write(folder().join("points.csv"), points).unwrap();
    let file = match PatchFile::parse(text, &path) {
        Ok(file) => file,
        Err(error) => return check_message(&error.to_string()),
    };
    // A fuzzer finds the large numbers of elements that are allowed.
    let (count, cell) = match &file.shape {
        FaceShape::Flat(grid) | FaceShape::Cylinder { grid, .. } => {
            ((grid.nx + 1).saturating_mul(grid.ny), grid.length / grid.nx as f64)
        }
        FaceShape::Points { points, .. } => (points.len(), 1.0),
    };
    if count > MAX_ELEMENTS || file.refine > 4 {
        return;
    }
    match Patch::parse(text, &path) {
        Ok(patch) => move_about(&patch, cell, f64::from(file.refine)),
        Err(error @ (PatchError::File(_) | PatchError::Table(_))) => check_message(&error.to_string()),
    }
}

fn check_message(message: &str) {
    assert!(message.starts_with(folder().to_str().unwrap()) && !message.contains('\n'), "{message}");
}

/// From where nothing touches down to where all may, sliding, turning and rolling.
fn move_about(patch: &Patch, cell: f64, refine: f64) {
    let height = patch.clear_height();
    let temperature = patch.temperature();
    let start =
        PatchStart { pose: Pose { place: [0.0, 0.0, height], angles: [0.0; 3] }, temperature, ..PatchStart::default() };
    let Ok(run) = PatchRun::new(patch, &start) else { return };
    let mut judged = Judged::new(patch, run);
    let (down, h) = (-(height.abs() * 1e-9 + 8e-6) / 1e-3, 1e-3);
    let speed = if patch.has_tread() { cell.min(1.0) / h } else { 0.0 };
    for (rates, transport_speed) in [
        ([0.0, 0.0, down, 0.0, 0.0, 0.0], 0.0),
        ([0.02, 0.01, 0.0, 0.0, 0.0, 3.0], speed),
        ([-0.3, 0.0, 0.1 * down, 0.5, 0.2, 0.0], speed),
        ([0.0, 2.0, -0.4 * down, 0.0, 0.0, -9.0], -0.3 * speed),
        ([0.0, 0.0, -2.0 * down, 0.0, 0.0, 0.0], -0.3 * speed),
    ] {
        let motion = PatchMotion { duration: h, rates, transport_speed, temperature };
        if judged.has_time_for(&motion, cell, refine) {
            // Refused or not: the rules of a step are checked.
            let _ = judged.advance(&motion);
        }
    }
}
