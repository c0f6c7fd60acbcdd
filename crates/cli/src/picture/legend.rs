//! The legend of a row: the names of its marks, each once, with what is drawn.

use asperity_study::picture::{Colour, Fill, Mark, Panel, Point, Shape, Stroke, Symbol};

use super::drawing::{Item, Paint, Pen, Side, TEXT_SIZE};
use super::font;
use super::marks::{BACK, arrow, dashes, symbol};

/// The height of a line.
pub(super) const LINE: f64 = 30.0;
const SYMBOL: f64 = 26.0;
/// Between a symbol and its name; three times that before the next symbol.
const GAP: f64 = 7.0;

/// A name, with the looks of the marks that have it.
#[derive(Clone, Debug, PartialEq)]
struct Entry {
    name: String,
    looks: Vec<Look>,
    has_one_colour: bool,
}

/// How a mark is drawn beside its name.
#[derive(Clone, Debug, PartialEq)]
struct Look {
    colour: Colour,
    shape: Shape,
}

/// All names of a picture so far: those of one row are not repeated in the next.
#[derive(Debug, Default)]
pub(super) struct Legend(Vec<Entry>);

impl Legend {
    /// The items of the names that are new in a row of panels, in lines no longer than `width` where there are several
    /// names, and their height.
    pub(super) fn items(&mut self, panels: &[Panel], [left, top]: Point, width: f64) -> (Vec<Item>, f64) {
        let mut entries: Vec<Entry> = Vec::new();
        for mark in panels.iter().flat_map(|panel| &panel.marks).filter(|mark| !mark.name.is_empty()) {
            let look = Look { colour: mark.colour, shape: of(mark) };
            match entries.iter_mut().find(|entry| entry.name == mark.name) {
                Some(entry) => entry.add(look),
                None => entries.push(Entry { name: mark.name.clone(), looks: vec![look], has_one_colour: true }),
            }
        }
        entries.retain(|entry| !self.0.contains(entry));
        self.0.extend(entries.iter().cloned());
        // What stands for a colour comes before what has several.
        entries.sort_by_key(|entry| !entry.has_one_colour);
        let (mut items, mut place) = (Vec::new(), [left, top + LINE / 2.0]);
        for entry in &entries {
            let wide = SYMBOL + GAP + font::width(&entry.name, TEXT_SIZE);
            if place[0] + wide > width && place[0] > left {
                place = [left, place[1] + LINE];
            }
            items.extend(entry.looks.iter().flat_map(|look| look.items(place)));
            items.push(Item::text(&entry.name, [place[0] + SYMBOL + GAP, place[1]], Side::Start, TEXT_SIZE));
            place[0] += wide + 3.0 * GAP;
        }
        let height = if entries.is_empty() { 0.0 } else { place[1] + LINE / 2.0 - top };
        (items, height)
    }
}

/// The shape of a mark without its places.
fn of(mark: &Mark) -> Shape {
    match &mark.shape {
        Shape::Line { stroke, width, .. } => Shape::Line { points: Vec::new(), stroke: *stroke, width: *width },
        Shape::Area { opacity, .. } => Shape::Area { outline: Vec::new(), opacity: *opacity },
        Shape::Points { symbol, fill, radius, .. } => Shape::points(Vec::new(), *symbol, *fill, *radius),
        Shape::Boxes { .. } | Shape::Heat { .. } => Shape::Boxes { boxes: Vec::new(), values: Vec::new() },
        Shape::Contours(_) => Shape::Contours(Vec::new()),
        Shape::Arrows { key, .. } => Shape::Arrows { arrows: Vec::new(), key: *key },
    }
}

impl Entry {
    /// Adds a look; of several colours there is ink alone, and of several symbols a disc.
    fn add(&mut self, look: Look) {
        let is_like = |own: &&mut Look| std::mem::discriminant(&own.shape) == std::mem::discriminant(&look.shape);
        let Some(own) = self.looks.iter_mut().find(is_like) else {
            self.looks.push(look);
            return;
        };
        if own.colour != look.colour {
            self.has_one_colour = false;
            own.colour = Colour::INK;
            if let Shape::Points { symbol, .. } = &mut own.shape {
                *symbol = Symbol::Disc;
            }
        }
    }
}

impl Look {
    /// What is drawn before a name, from a place at the left and half-way up.
    fn items(&self, [left, middle]: Point) -> Vec<Item> {
        let (right, centre) = (left + SYMBOL, [left + SYMBOL / 2.0, middle]);
        let half = TEXT_SIZE / 2.0;
        let area = |paint: Paint| Item::rectangle([left, middle - half], [right, middle + half], paint);
        match &self.shape {
            Shape::Line { stroke, width, .. } => {
                let pen = Pen { dashes: dashes(*stroke), ..Pen::new(self.colour, width.max(2.0)) };
                // Ends with a whole dash.
                let end = if *stroke == Stroke::Solid {
                    right
                } else {
                    right - dashes(*stroke).map_or(0.0, |[_, gap]| gap / 2.0)
                };
                vec![Item::line(vec![[left, middle], [end, middle]], pen)]
            }
            Shape::Area { opacity, .. } => vec![area(Paint { colour: self.colour, opacity: *opacity })],
            Shape::Points { symbol: kind, fill, radius, .. } if *radius < 2.0 && *fill == Fill::Full => {
                let places = (0..5).map(|i| [left + f64::from(i) * SYMBOL / 4.0, middle]);
                places.flat_map(|place| symbol(place, (*kind, *fill, *radius), self.colour, self.colour)).collect()
            }
            Shape::Points { symbol: kind, fill, radius, .. } => {
                symbol(centre, (*kind, *fill, radius.max(4.0)), self.colour, self.colour)
            }
            Shape::Boxes { .. } | Shape::Heat { .. } => {
                vec![area(Paint::full(BACK)), area(Paint::full(self.colour))]
            }
            Shape::Contours(_) => vec![Item::line(vec![[left, middle], [right, middle]], Pen::new(self.colour, 1.2))],
            Shape::Arrows { key, .. } => {
                arrow([centre[0] - key / 2.0, middle], [centre[0] + key / 2.0, middle], self.colour)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use asperity_study::picture::{Axis, Fit};

    use super::*;

    fn panel(marks: Vec<Mark>) -> Panel {
        let axis = Axis::linear(("", ""), [0.0, 1.0], Fit::Tight);
        Panel::new(axis.clone(), axis, marks)
    }

    fn texts(items: &[Item]) -> Vec<(&str, f64)> {
        let text = |item| match item {
            &Item::Text { ref text, at, .. } => Some((text.as_str(), at[0] + font::width(text, TEXT_SIZE))),
            _ => None,
        };
        items.iter().filter_map(text).collect()
    }

    #[test]
    fn a_legend_has_each_name_once_and_no_line_too_long() {
        let marks = (0..12).map(|i| Mark::line(format!("ladder number {}", i % 6), i % 6, vec![[0.0, 0.0]]));
        let panels = [panel(marks.collect())];
        let mut legend = Legend::default();
        let (items, height) = legend.items(&panels, [0.0, 0.0], 400.0);
        assert_eq!((texts(&items).len(), height), (6, 3.0 * LINE));
        assert!(texts(&items).iter().all(|(_, end)| *end <= 400.0), "{items:?}");
        assert_eq!(legend.items(&panels, [0.0, 0.0], 400.0), (Vec::new(), 0.0));
    }

    #[test]
    fn a_name_of_several_colours_is_in_ink_behind_those_of_one() {
        let of = |look: usize, name: &str| Mark::symbols(name, look, vec![[0.0, 0.0]], Fill::Hollow);
        let panels = [panel(vec![of(0, "hollow"), of(0, "first"), of(1, "hollow"), of(1, "second")])];
        let (items, _) = Legend::default().items(&panels, [0.0, 0.0], 1000.0);
        assert_eq!(texts(&items).iter().map(|(text, _)| *text).collect::<Vec<_>>(), ["first", "second", "hollow"]);
    }
}
