//! Which of several things is chosen, over two quantities: a cell about each point, pale where it is not sure.

use plotters::prelude::*;

use super::chart::{Legend, Symbol, draw_cross};
use super::grid_frame::{GridAxis, GridFrame, width};
use super::raster::Raster;
use super::{Backend, Canvas, DrawResult, FINE, Figure, GRID, INK, colour};

/// Subpixels of a pixel of the image.
const PIXEL: u32 = 2 * FINE;
/// How much of its colour a pale cell has.
const PALE: f64 = 0.35;

/// Maps of choices.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ChoiceGrid {
    pub(crate) title: String,
    /// Below the title; empty for none.
    pub(crate) remark: String,
    pub(crate) x: GridAxis,
    pub(crate) y: GridAxis,
    /// What is chosen from: each has its colour by its number.
    pub(crate) names: Vec<String>,
    pub(crate) panels: Vec<ChoicePanel>,
}

/// One of the maps.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ChoicePanel {
    pub(crate) title: String,
    /// Rows along x, from the lowest y on.
    pub(crate) choices: Vec<Choice>,
}

/// What is chosen at a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Choice {
    /// One of them, by its number.
    One { which: usize, is_sure: bool },
    /// Several as well as each other.
    Equal,
    /// There is no result.
    Nothing,
}

impl Choice {
    fn shade(self) -> RGBColor {
        match self {
            Self::One { which, is_sure: true } => colour(which),
            Self::One { which, is_sure: false } => {
                let RGBColor(red, green, blue) = colour(which);
                let paled = |part: u8| (255.0 - PALE * (255.0 - f64::from(part))).round() as u8;
                RGBColor(paled(red), paled(green), paled(blue))
            }
            Self::Equal => GRID,
            Self::Nothing => WHITE,
        }
    }
}

impl ChoiceGrid {
    fn frame(&self) -> GridFrame<'_> {
        let has = |choice: Choice| self.panels.iter().any(|panel| panel.choices.contains(&choice));
        let names = self.names.iter().enumerate().map(|(i, name)| (name.as_str(), Symbol::Area(colour(i))));
        let equal = has(Choice::Equal).then_some(("equal", Symbol::Area(GRID)));
        let nothing = has(Choice::Nothing).then_some(("no result", Symbol::Cross(INK)));
        GridFrame {
            title: &self.title,
            remark: &self.remark,
            axes: [&self.x, &self.y],
            titles: self.panels.iter().map(|panel| panel.title.as_str()).collect(),
            legend: Legend::new(names.chain(equal).chain(nothing), width(self.panels.len())),
            beside: 0,
        }
    }
}

/// The line that is nearest to a place.
fn nearest(lines: &[f64], place: f64) -> usize {
    lines.windows(2).take_while(|pair| f64::midpoint(pair[0], pair[1]) <= place).count()
}

impl Figure for ChoiceGrid {
    fn size(&self) -> (u32, u32) {
        self.frame().size()
    }

    fn images(&self) -> Vec<Raster> {
        let frame = self.frame();
        let size = frame.map();
        let (columns, rows) = ((size.0 / PIXEL) as usize, (size.1 / PIXEL) as usize);
        let (x, y) = (self.x.shares(), self.y.shares());
        let image = |(index, panel): (usize, &ChoicePanel)| {
            let colour = |place: (f64, f64)| {
                let at = nearest(&y, place.1) * x.len() + nearest(&x, place.0);
                panel.choices.get(at).map_or(WHITE, |choice| choice.shade())
            };
            let colours: Vec<RGBColor> = GridFrame::places((columns, rows)).map(colour).collect();
            Raster::new(frame.corner(index), size, columns, &colours)
        };
        self.panels.iter().enumerate().map(image).collect()
    }

    fn draw<B: Backend>(&self, canvas: &Canvas<B>) -> DrawResult {
        let frame = self.frame();
        frame.draw(canvas)?;
        let (x, y) = (self.x.shares(), self.y.shares());
        for (index, panel) in self.panels.iter().enumerate() {
            let places = y.iter().flat_map(|y| x.iter().map(move |x| (*x, *y)));
            for (place, choice) in places.zip(&panel.choices) {
                let place = frame.place(index, place);
                match choice {
                    Choice::Nothing => draw_cross(canvas, place, INK)?,
                    _ => canvas.draw(&Circle::new(place, FINE as i32, INK.mix(0.4).filled()))?,
                }
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cell_reaches_half_way_to_its_neighbours() {
        let lines = [0.0, 0.2, 1.0];
        assert_eq!([0.0, 0.09, 0.11, 0.59, 0.61, 1.0].map(|place| nearest(&lines, place)), [0, 0, 1, 1, 2, 2]);
    }
}
