//! A drawing as SVG.

use std::fmt::Write as _;

use asperity_study::picture::{Colour, Point};
use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;
use quick_xml::escape::escape;

use super::drawing::{Drawing, Item, Paint, Pen, Side, TO_BASE_LINE};
use super::png::encode;

/// The text of the file.
pub(super) fn svg(drawing: &Drawing) -> Result<String, png::EncodingError> {
    let [width, height] = drawing.size;
    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\" \
         font-family=\"sans-serif\" stroke-linejoin=\"round\">\n<rect width=\"{width}\" height=\"{height}\" fill=\"#ffffff\"/>\n"
    );
    for item in &drawing.items {
        text += &element(item)?;
    }
    Ok(text + "</svg>\n")
}

fn element(item: &Item) -> Result<String, png::EncodingError> {
    Ok(match item {
        Item::Path { points, is_closed, fill, pen } => {
            let name = if *is_closed { "polygon" } else { "polyline" };
            format!("<{name} points=\"{}\"{}/>\n", listed(points), style(*fill, *pen))
        }
        Item::Circle { at: [x, y], radius, fill, pen } => {
            format!("<circle cx=\"{}\" cy=\"{}\" r=\"{radius}\"{}/>\n", short(*x), short(*y), style(*fill, *pen))
        }
        Item::Text { text, at: [x, y], side, size, colour, is_upright } => {
            let anchor = match side {
                Side::Start => "start",
                Side::Middle => "middle",
                Side::End => "end",
            };
            let down = TO_BASE_LINE * size;
            let (place, turned) = match is_upright {
                true => ([x + down, *y], format!(" transform=\"rotate(-90 {} {})\"", short(x + down), short(*y))),
                false => ([*x, y + down], String::new()),
            };
            format!(
                "<text x=\"{}\" y=\"{}\" text-anchor=\"{anchor}\" font-size=\"{size}\" fill=\"{}\"{turned}>\n{}\n</text>\n",
                short(place[0]),
                short(place[1]),
                hexadecimal(*colour),
                escape(text.as_str())
            )
        }
        Item::Image { corner: [x, y], size: [width, height], columns, colours } => {
            let rgb: Vec<u8> = colours.iter().flat_map(|colour| colour.0).collect();
            let data = BASE64_STANDARD.encode(encode(&rgb, *columns)?);
            format!(
                "<image x=\"{}\" y=\"{}\" width=\"{width}\" height=\"{height}\" preserveAspectRatio=\"none\" \
                 image-rendering=\"pixelated\" href=\"data:image/png;base64,{data}\"/>\n",
                short(*x),
                short(*y)
            )
        }
    })
}

fn listed(points: &[Point]) -> String {
    let mut text = String::with_capacity(12 * points.len());
    for [x, y] in points {
        // Writing to a text does not fail.
        let _ = write!(text, "{}{},{}", if text.is_empty() { "" } else { " " }, short(*x), short(*y));
    }
    text
}

fn style(fill: Option<Paint>, pen: Option<Pen>) -> String {
    let opacity = |of: &str, paint: Paint| match paint.opacity {
        1.0 => String::new(),
        opacity => format!(" {of}-opacity=\"{opacity}\""),
    };
    let mut text = match fill {
        Some(paint) => format!(" fill=\"{}\"{}", hexadecimal(paint.colour), opacity("fill", paint)),
        None => " fill=\"none\"".into(),
    };
    if let Some(Pen { paint, width, dashes }) = pen {
        let colour = hexadecimal(paint.colour);
        text += &format!(" stroke=\"{colour}\" stroke-width=\"{width}\"{}", opacity("stroke", paint));
        text += &dashes.map_or_else(String::new, |[dash, gap]| format!(" stroke-dasharray=\"{dash},{gap}\""));
    }
    text
}

fn hexadecimal(Colour([red, green, blue]): Colour) -> String {
    format!("#{red:02x}{green:02x}{blue:02x}")
}

/// To a tenth of a pixel.
fn short(value: f64) -> f64 {
    (10.0 * value).round() / 10.0
}
