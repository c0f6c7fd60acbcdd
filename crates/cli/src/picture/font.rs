//! The font: how wide a text is, and its outlines.

use std::sync::OnceLock;

use ab_glyph::{Font as _, FontRef, OutlineCurve, Point, ScaleFont as _};

/// DejaVu Sans, reduced to the characters that pictures need: PNGs are the same on every machine.
const FONT: &[u8] = include_bytes!("font/DejaVuSans.ttf");

fn font() -> Option<&'static FontRef<'static>> {
    static READ: OnceLock<Option<FontRef<'static>>> = OnceLock::new();
    READ.get_or_init(|| FontRef::try_from_slice(FONT).ok()).as_ref()
}

/// The width of a text of `size`, pixels.
pub(super) fn width(text: &str, size: f64) -> f64 {
    glyphs(text, size).last().map_or(0.0, |(_, end, _)| end)
}

/// Each letter's outline in units of the font, where it ends and begins, pixels from the text's start.
fn glyphs(text: &str, size: f64) -> impl Iterator<Item = (Vec<OutlineCurve>, f64, f64)> {
    let scaled = font().map(|font| font.as_scaled(scale(font, size)));
    let (mut end, mut last) = (0.0, None);
    text.chars().filter_map(move |letter| {
        let scaled = scaled.as_ref()?;
        let id = scaled.glyph_id(letter);
        let start = end + last.map_or(0.0, |last| f64::from(scaled.kern(last, id)));
        end = start + f64::from(scaled.h_advance(id));
        last = Some(id);
        Some((scaled.font.outline(id).map(|outline| outline.curves).unwrap_or_default(), end, start))
    })
}

/// The height of the font of which an em has `size` pixels.
fn scale(font: &FontRef<'_>, size: f64) -> f32 {
    let em = font.units_per_em().unwrap_or(1.0);
    size as f32 * font.height_unscaled() / em
}

/// The curves of a text's letters, from the start of its base line, up being negative, pixels.
pub(super) fn outlines(text: &str, size: f64) -> Vec<OutlineCurve> {
    let em = font().and_then(|font| font.units_per_em()).unwrap_or(1.0);
    let letters = glyphs(text, size).flat_map(|(curves, _, start)| {
        let place = move |Point { x, y }: Point| {
            let scale = size as f32 / em;
            Point { x: start as f32 + scale * x, y: -scale * y }
        };
        curves.into_iter().map(move |curve| match curve {
            OutlineCurve::Line(a, b) => OutlineCurve::Line(place(a), place(b)),
            OutlineCurve::Quad(a, b, c) => OutlineCurve::Quad(place(a), place(b), place(c)),
            OutlineCurve::Cubic(a, b, c, d) => OutlineCurve::Cubic(place(a), place(b), place(c), place(d)),
        })
    });
    letters.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each character of a tick and of a legend has its own outline, not the box of a missing one.
    #[test]
    fn letters_are_drawn() {
        let missing = outlines("\u{4e00}", 24.0);
        for letter in ["1", "⁻", "⁰", "¹", "⁹", "F", "µ", "τ", "→", "←", "½", "²"] {
            let drawn = outlines(letter, 24.0);
            assert!(!drawn.is_empty() && format!("{drawn:?}") != format!("{missing:?}"), "{letter}");
        }
        assert!(width("mm", 20.0) > 1.9 * width("m", 20.0));
    }
}
