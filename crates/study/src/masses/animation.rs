//! The animation of a run as a page for a browser: one file, its numbers in it.

use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;
use serde::Serialize;

use super::history::{Element, ElementHistory, Span, Touch};
use crate::html::fill;

const TEMPLATE: &str = include_str!("animation.html");

/// Bytes of the frames, and points of the profile and of the forces over time, that leave the page below 5 MB.
const FRAME_BYTES: usize = 2_800_000;
const PROFILE_POINTS: usize = 250_000;
const FORCE_POINTS: usize = 10_000;
/// Points of the profile along the layer: two a pixel of a large screen.
const POINTS_IN_VIEW: f64 = 4000.0;

/// What the page is told, in SI units.
#[derive(Debug, Serialize)]
struct Page<'a> {
    name: &'a str,
    masses: usize,
    spacing: f64,
    /// What is seen along x while u = 0.
    ends: (f64, f64),
    heights: (f64, f64),
    /// What `load` is, its unit, and its largest value.
    load_name: &'a str,
    load_unit: &'a str,
    largest_load: f64,
    largest_flash: f64,
    profile: Profile,
    frames: Frames,
    forces: Forces,
}

/// Heights at even distances.
#[derive(Debug, Serialize)]
struct Profile {
    start: f64,
    step: f64,
    /// After which it repeats itself, if the layer comes that far.
    period: Option<f64>,
    z: Quantised,
}

/// Arrays with a line of masses for each frame.
#[derive(Debug, Serialize)]
struct Frames {
    /// 64-bit.
    time: String,
    u: String,
    /// x - u.
    x: Quantised,
    z: Quantised,
    load: Quantised,
    flash: Option<Quantised>,
    /// A byte each: 0 free, 1 slips, 2 sticks.
    touch: String,
}

/// 64-bit.
#[derive(Debug, Serialize)]
struct Forces {
    time: String,
    x: String,
    z: String,
}

/// Numbers as parts of the way from `low` to `high`, which is divided into 65535.
#[derive(Debug, Serialize)]
struct Quantised {
    low: f64,
    high: f64,
    data: String,
}

impl Quantised {
    fn new(values: &[f64]) -> Self {
        let (low, high) =
            values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &z| (low.min(z), high.max(z)));
        let (low, high) = if low <= high { (low, high) } else { (0.0, 0.0) };
        let scale = if high > low { f64::from(u16::MAX) / (high - low) } else { 0.0 };
        let parts = values.iter().flat_map(|value| (((value - low) * scale).round() as u16).to_le_bytes());
        Self { low, high, data: BASE64_STANDARD.encode(parts.collect::<Vec<_>>()) }
    }
}

fn reals(values: impl Iterator<Item = f64>) -> String {
    BASE64_STANDARD.encode(values.flat_map(f64::to_le_bytes).collect::<Vec<_>>())
}

/// The page as text.
///
/// # Errors
/// Where its numbers cannot be written as JSON, which does not happen in memory.
pub fn animation(history: &ElementHistory) -> serde_json::Result<String> {
    let json = serde_json::to_string(&page(history))?;
    // In a script, `</script>` in the scene's name would end it.
    Ok(fill(TEMPLATE, &[("run", json.replace('<', "\\u003c"))]))
}

fn page(history: &ElementHistory) -> Page<'_> {
    let masses = history.rest().len();
    // Time and u, and of each mass x, z, load, touch and flash temperature.
    let bytes = 16 + masses * if history.has_flash() { 9 } else { 7 };
    let rows = history.spread(FRAME_BYTES / bytes);
    let span = Span::over(history, &rows);
    let (load_name, load_unit) = history.load_unit();
    Page {
        name: history.name(),
        masses,
        spacing: history.spacing(),
        ends: history.ends(),
        heights: span.heights,
        load_name,
        load_unit,
        largest_load: span.load,
        largest_flash: span.flash,
        profile: profile(history, &rows),
        frames: frames(history, &rows),
        forces: forces(history),
    }
}

fn frames(history: &ElementHistory, rows: &[usize]) -> Frames {
    let of_masses = |value: fn(&Element) -> f64| {
        rows.iter().flat_map(|&row| history.elements(row)).map(|element| value(&element)).collect::<Vec<_>>()
    };
    let x = rows.iter().flat_map(|&row| history.elements(row).map(move |element| element.x - history.rows()[row].u));
    let touch = rows.iter().flat_map(|&row| history.elements(row)).map(|element| match element.touch {
        Touch::Free => 0,
        Touch::Slips => 1,
        Touch::Sticks => 2,
    });
    Frames {
        time: reals(rows.iter().map(|&row| history.rows()[row].time)),
        u: reals(rows.iter().map(|&row| history.rows()[row].u)),
        x: Quantised::new(&x.collect::<Vec<_>>()),
        z: Quantised::new(&of_masses(|element| element.z)),
        load: Quantised::new(&of_masses(|element| element.load)),
        flash: history.has_flash().then(|| Quantised::new(&of_masses(|element| element.flash))),
        touch: BASE64_STANDARD.encode(touch.collect::<Vec<u8>>()),
    }
}

fn forces(history: &ElementHistory) -> Forces {
    let rows = history.spread(FORCE_POINTS);
    let rows = || rows.iter().map(|&row| &history.rows()[row]);
    Forces {
        time: reals(rows().map(|row| row.time)),
        x: reals(rows().map(|row| row.force_x)),
        z: reals(rows().map(|row| row.force_z)),
    }
}

/// The profile where the layer comes, or one period of it.
fn profile(history: &ElementHistory, rows: &[usize]) -> Profile {
    let (left, right) = history.ends();
    let ways = || rows.iter().map(|&row| history.rows()[row].u);
    let start = left + ways().fold(f64::INFINITY, f64::min);
    let reached = right + ways().fold(f64::NEG_INFINITY, f64::max) - start;
    let spline = history.surface().spline();
    let period = spline.period().filter(|period| *period < reached);
    let length = period.unwrap_or(reached);
    let wanted = (length / (right - left) * POINTS_IN_VIEW).ceil();
    let steps = (wanted as usize).clamp(1, PROFILE_POINTS);
    let step = length / steps as f64;
    let heights: Vec<f64> = (0..=steps).map(|i| spline.evaluate(start + i as f64 * step).0).collect();
    Profile { start, step, period, z: Quantised::new(&heights) }
}

#[cfg(test)]
mod tests {
    use asperity::scene::Scene;

    use super::super::history::Instant;
    use super::*;

    #[test]
    fn quantised_numbers_are_within_half_a_part() {
        let values: Vec<f64> = (0..100).map(|i| -3.0 + 0.07 * f64::from(i * i % 89)).collect();
        let Quantised { low, high, data } = Quantised::new(&values);
        let part = (high - low) / 65535.0;
        let bytes = BASE64_STANDARD.decode(data).unwrap();
        let read = bytes.chunks(2).map(|pair| low + f64::from(u16::from_le_bytes([pair[0], pair[1]])) * part);
        assert!(read.zip(&values).all(|(read, value)| (read - value).abs() <= 0.51 * part));
    }

    /// Of many masses or many rows.
    #[test]
    fn a_page_stays_below_5_mb() {
        for (masses, rows) in [(2, 300_000), (1000, 1000)] {
            let text = format!(
                "name = 'long'\n[layer]\nmasses = {masses}\nspacing = 1e-6\nmass = 1e-7\n[layer.vertical]\n\
                 stiffness = 2e3\n[surface]\nkind = 'sinusoid'\namplitude = 1e-6\nwavelength = 1.0\n"
            );
            let mut history = ElementHistory::new(&Scene::parse(&text, "long.toml".as_ref()).unwrap());
            // As far as a period, and numbers of as many digits as there may be.
            for i in 0..rows {
                let u = i as f64 / 7e4;
                let mass = |mass: usize| [u + 1e-6 * mass as f64, 0.0, 0.0, 0.0, 0.0];
                let values: Vec<f64> = (0..masses).flat_map(mass).collect();
                history.add_values(Instant { time: i as f64 / 3e5, u, w: 0.0, force_x: 1.0, force_z: 2.0 }, &values);
            }
            let length = serde_json::to_string(&page(&history)).unwrap().len() + TEMPLATE.len();
            assert!((2_000_000..5_000_000).contains(&length), "{masses} masses, {rows} rows: {length}");
        }
    }

    #[test]
    fn equal_numbers_and_none_are_read_back_as_they_are() {
        let flat = Quantised::new(&[2.0, 2.0]);
        assert_eq!((flat.low, flat.high, flat.data.as_str()), (2.0, 2.0, "AAAAAA=="));
        assert_eq!(Quantised::new(&[]).data, "");
    }
}
