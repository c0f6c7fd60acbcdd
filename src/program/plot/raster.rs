//! A picture's SVG as PNG. The font is this program's own, so that the pixels are the same on every machine.

use std::error::Error;
use std::sync::Arc;

use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::fontdb::Database;
use resvg::usvg::{Options, Tree};

/// DejaVu Sans, reduced to the letters and signs that pictures need; its licence lies beside it.
const FONT: &[u8] = include_bytes!("font/DejaVuSans.ttf");
const FAMILY: &str = "DejaVu Sans";
/// Pixels for one of the SVG's: sharp on a fine screen and in print.
pub(crate) const SHARP: f32 = 2.0;

/// The PNG file of the picture `svg`, with `scale` pixels for one of its.
pub(crate) fn png(svg: &str, scale: f32) -> Result<Vec<u8>, Box<dyn Error>> {
    let mut fonts = Database::new();
    fonts.load_font_data(FONT.to_vec());
    fonts.set_sans_serif_family(FAMILY);
    let options = Options { fontdb: Arc::new(fonts), font_family: FAMILY.into(), ..Options::default() };
    let tree = Tree::from_str(svg, &options)?;
    let [width, height] = [tree.size().width(), tree.size().height()].map(|length| (scale * length).ceil() as u32);
    let mut pixels = Pixmap::new(width, height).ok_or("a picture needs a size")?;
    resvg::render(&tree, Transform::from_scale(scale, scale), &mut pixels.as_mut());
    Ok(pixels.encode_png()?)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Text leaves ink: the font is found under the name that pictures use.
    #[test]
    fn letters_are_drawn() {
        let picture = |text: &str| {
            let svg = format!(
                "<svg width=\"80\" height=\"20\" xmlns=\"http://www.w3.org/2000/svg\">\
                 <text x=\"2\" y=\"15\" font-family=\"sans-serif\" font-size=\"12\">{text}</text></svg>"
            );
            Pixmap::decode_png(&png(&svg, SHARP).unwrap()).unwrap()
        };
        let ink = |text: &str| picture(text).pixels().iter().filter(|pixel| pixel.alpha() > 0).count();
        assert_eq!((picture("").width(), ink("")), (160, 0));
        // Every letter of a tick and of a legend has its own outline, not the box of a missing one.
        let box_ink = ink("\u{4e00}");
        for letter in ["1", "⁻", "⁰", "¹", "⁹", "F", "µ", "τ"] {
            assert!(ink(letter) > 0 && ink(letter) != box_ink, "{letter}");
        }
    }
}
