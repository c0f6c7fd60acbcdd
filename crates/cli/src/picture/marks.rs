//! The marks of a panel.

use asperity_study::picture::{
    Colour, ColourScale, Colours, ContourLine, Fill, Mark, Panel, Point, Shape, Stroke, Symbol,
};

use super::drawing::{Item, LABEL_SIZE, Paint, Pen, Side, TICK_SIZE};
use super::font;
use super::labels::Room;

/// Behind areas that are white themselves.
pub(super) const BACK: Colour = Colour([160, 160, 160]);
/// Points of a line within so many pixels along the horizontal axis are one column.
const COLUMN: f64 = 0.5;
/// Boxes that are larger have an edge.
const EDGED: f64 = 11.0;
/// The least size of a box.
const LEAST: f64 = 0.5;
/// More cells than these along an edge would not be seen.
const MOST: usize = 720;

/// A panel whose upper left corner is at a place of the picture.
#[derive(Clone, Copy, Debug)]
pub(super) struct Placed<'a> {
    pub(super) panel: &'a Panel,
    pub(super) corner: Point,
}

impl Placed<'_> {
    /// Where a point is drawn; `None` where an axis cannot show it.
    pub(super) fn place(&self, [x, y]: Point) -> Option<Point> {
        let shares = [self.panel.x.share(x)?, 1.0 - self.panel.y.share(y)?];
        Some([0, 1].map(|axis| self.corner[axis] + shares[axis] * self.panel.size[axis]))
    }

    fn places(&self, points: &[Point]) -> Vec<Point> {
        points.iter().filter_map(|point| self.place(*point)).collect()
    }

    /// The other corner.
    pub(super) fn end(&self) -> Point {
        [0, 1].map(|axis| self.corner[axis] + self.panel.size[axis])
    }

    /// All marks, and the labels of points and contours over them.
    pub(super) fn marks(&self) -> Vec<Item> {
        let (mut items, mut room) = (Vec::new(), self.room());
        for mark in &self.panel.marks {
            items.extend(self.mark(mark, &mut room));
        }
        items.extend(self.panel.marks.iter().flat_map(|mark| self.labels(mark, &mut room)));
        items
    }

    fn mark(&self, mark: &Mark, room: &mut Room) -> Vec<Item> {
        let colour = |values: &[f64], i: usize| match (values.get(i), &self.panel.scale) {
            (Some(value), Some(scale)) => shade(scale, *value),
            _ => mark.colour,
        };
        match &mark.shape {
            Shape::Line { points, stroke, width } => {
                let points = outline(&self.places(points));
                vec![Item::line(points, Pen { dashes: dashes(*stroke), ..Pen::new(mark.colour, *width) })]
            }
            Shape::Area { outline, opacity } => {
                vec![Item::area(self.places(outline), Paint { colour: mark.colour, opacity: *opacity })]
            }
            Shape::Points { points, symbol: kind, fill, radius, values, .. } => {
                let each = points.iter().enumerate().filter_map(|(i, point)| Some((i, self.place(*point)?)));
                each.flat_map(|(i, at)| symbol(at, (*kind, *fill, *radius), colour(values, i), mark.colour)).collect()
            }
            Shape::Boxes { boxes, values } => {
                let each = boxes.iter().enumerate();
                each.filter_map(|(i, corners)| self.rectangle(corners, colour(values, i))).collect()
            }
            Shape::Heat { columns, values } => vec![self.heat(*columns, values, mark.colour)],
            Shape::Contours(lines) => lines.iter().flat_map(|line| self.contour(line, room)).collect(),
            Shape::Arrows { arrows, .. } => {
                let ends = |&[x, y, to_x, to_y]: &[f64; 4]| Some((self.place([x, y])?, self.place([to_x, to_y])?));
                arrows.iter().filter_map(ends).flat_map(|(from, to)| arrow(from, to, mark.colour)).collect()
            }
        }
    }

    fn rectangle(&self, &[x, y, to_x, to_y]: &[f64; 4], colour: Colour) -> Option<Item> {
        let (from, to) = (self.place([x, y])?, self.place([to_x, to_y])?);
        let [low, high] = [f64::min, f64::max].map(|pick| [0, 1].map(|axis| pick(from[axis], to[axis])));
        let edge = if (high[0] - low[0]).min(high[1] - low[1]) >= EDGED { 0.5 } else { 0.0 };
        let high = [0, 1].map(|axis| high[axis].max(low[axis] + LEAST) - edge);
        Some(Item::rectangle(low.map(|side| side + edge), high, Paint::full(colour)))
    }

    fn heat(&self, columns: usize, values: &[Option<f64>], without: Colour) -> Item {
        let of = |value: &Option<f64>| match (value, &self.panel.scale) {
            (Some(value), Some(scale)) => shade(scale, *value),
            _ => without,
        };
        let colours: Vec<Colour> = values.chunks(columns).rev().flatten().map(of).collect();
        let by = columns.max(values.len() / columns).div_ceil(MOST);
        let (columns, colours) = if by > 1 { averaged(&colours, columns, by) } else { (columns, colours) };
        Item::Image { corner: self.corner, size: self.panel.size, columns, colours }
    }

    /// A contour, with its number in a gap where there is room.
    fn contour(&self, line: &ContourLine, room: &mut Room) -> Vec<Item> {
        let places = self.places(&line.points);
        let shade = self.panel.scale.as_ref().map_or(Colour::INK, |scale| on(shade(scale, line.value)));
        let gap = room.along(&places, [font::width(&line.label, TICK_SIZE) + 6.0, TICK_SIZE + 2.0]);
        let is_in_gap = |[x, y]: &Point| gap.is_some_and(|[l, t, r, b]| (l..=r).contains(x) && (t..=b).contains(y));
        let parts = places.split(is_in_gap).filter(|part| part.len() > 1);
        let mut items: Vec<Item> = parts.map(|part| Item::line(part.to_vec(), Pen::new(shade, 1.25))).collect();
        items.extend(gap.map(|[left, top, right, bottom]| Item::Text {
            text: line.label.clone(),
            at: [f64::midpoint(left, right), f64::midpoint(top, bottom)],
            side: Side::Middle,
            size: TICK_SIZE,
            colour: shade,
            is_upright: false,
        }));
        items
    }

    /// Where labels may stand: off lines, and off symbols that are not many.
    fn room(&self) -> Room {
        let ([left, top], [right, bottom]) = (self.corner, self.end());
        let mut room = Room::new([left, top, right, bottom]);
        for mark in &self.panel.marks {
            match &mark.shape {
                Shape::Line { points, .. } if points.len() < MOST => room.take_line(&self.places(points)),
                Shape::Points { points, radius, .. } if *radius > 2.0 => {
                    self.places(points).into_iter().for_each(|place| room.take(place, *radius));
                }
                _ => {}
            }
        }
        room
    }

    fn labels(&self, mark: &Mark, room: &mut Room) -> Vec<Item> {
        let Shape::Points { points, labels, radius, .. } = &mark.shape else { return Vec::new() };
        let label = |(text, point): (&String, &Point)| {
            let size = [font::width(text, LABEL_SIZE), LABEL_SIZE + 1.0];
            let at = room.beside(self.place(*point)?, radius + 1.0, size)?;
            let (text, colour) = (text.clone(), mark.colour);
            Some(Item::Text { text, at, side: Side::Middle, size: LABEL_SIZE, colour, is_upright: false })
        };
        labels.iter().zip(points).filter(|(text, _)| !text.is_empty()).filter_map(label).collect()
    }
}

/// Points that look like all of `points`: of those that follow each other within a column the first, the lowest, the
/// highest and the last. What swings within a column keeps its height, however many there are.
fn outline(points: &[Point]) -> Vec<Point> {
    let mut kept = Vec::new();
    for part in points.chunk_by(|a, b| (a[0] / COLUMN).floor() == (b[0] / COLUMN).floor()) {
        let by_height = |a: &usize, b: &usize| part[*a][1].total_cmp(&part[*b][1]);
        let low = (0..part.len()).min_by(by_height).unwrap_or_default();
        let high = (0..part.len()).max_by(by_height).unwrap_or_default();
        let mut seen = [0, low, high, part.len() - 1];
        seen.sort_unstable();
        kept.extend(seen.chunk_by(|a, b| a == b).map(|same| part[same[0]]));
    }
    kept
}

/// Neighbours as one: the mean colours of so many columns and rows.
fn averaged(colours: &[Colour], columns: usize, by: usize) -> (usize, Vec<Colour>) {
    let rows: Vec<&[Colour]> = colours.chunks(columns).collect();
    let mean = |rows: &[&[Colour]], column: usize| {
        let cells = || rows.iter().flat_map(|row| &row[column..(column + by).min(columns)]);
        let count = cells().count() as u32;
        Colour([0, 1, 2].map(|part| (cells().map(|cell| u32::from(cell.0[part])).sum::<u32>() / count) as u8))
    };
    let means = rows.chunks(by).flat_map(|rows| (0..columns).step_by(by).map(move |column| mean(rows, column)));
    (columns.div_ceil(by), means.collect())
}

/// Lengths of a dash and the gap after it, pixels.
pub(super) fn dashes(stroke: Stroke) -> Option<[f64; 2]> {
    match stroke {
        Stroke::Solid => None,
        Stroke::Dashed => Some([6.0, 4.0]),
        Stroke::Dotted => Some([2.0, 4.0]),
    }
}

/// A symbol with an edge of one colour and full of another one.
pub(super) fn symbol([x, y]: Point, (symbol, fill, r): (Symbol, Fill, f64), inside: Colour, edge: Colour) -> Vec<Item> {
    let paint = match fill {
        Fill::Full => Some(Paint::full(inside)),
        Fill::Hollow => Some(Paint::full(Colour::WHITE)),
        Fill::Ring => None,
    };
    let opacity = if fill == Fill::Ring { 0.6 } else { 1.0 };
    let width = if r < 3.0 { 0.0 } else { 1.5 };
    let pen = Pen { paint: Paint { colour: edge, opacity }, width, dashes: None };
    let pen = Some(pen).filter(|pen| pen.width > 0.0 || paint.is_none());
    let around = |corners: &[Point]| {
        let points = corners.iter().map(|[dx, dy]| [x + r * dx, y + r * dy]).collect();
        vec![Item::Path { points, is_closed: true, fill: paint, pen }]
    };
    match symbol {
        Symbol::Disc => vec![Item::Circle { at: [x, y], radius: r, fill: paint, pen }],
        Symbol::Square => around(&[[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]),
        Symbol::Triangle => around(&[[0.0, -1.25], [1.25, 1.0], [-1.25, 1.0]]),
        Symbol::Diamond => around(&[[0.0, -1.35], [1.35, 0.0], [0.0, 1.35], [-1.35, 0.0]]),
        Symbol::Cross => {
            let line = |[dx, dy]: Point| vec![[x - r * dx, y - r * dy], [x + r * dx, y + r * dy]];
            [[0.75, 0.75], [0.75, -0.75]].map(|ends| Item::line(line(ends), Pen::new(edge, 2.0))).into()
        }
    }
}

/// An arrow that is seen on every colour: with an edge that is as light as it is dark.
pub(super) fn arrow(from: Point, to: Point, colour: Colour) -> Vec<Item> {
    let edge = on(colour);
    let [dx, dy] = [to[0] - from[0], to[1] - from[1]];
    let length = dx.hypot(dy);
    let head = (0.5 * length).min(9.0) / length;
    let at = |back: f64, aside: f64| [to[0] - head * (back * dx + aside * dy), to[1] - head * (back * dy - aside * dx)];
    let tip = vec![to, at(1.0, 0.4), at(1.0, -0.4)];
    let outline = Item::Path { points: tip.clone(), is_closed: true, fill: None, pen: Some(Pen::new(edge, 2.0)) };
    vec![
        Item::line(vec![from, at(1.0, 0.0)], Pen::new(edge, 3.5)),
        outline,
        Item::line(vec![from, at(0.9, 0.0)], Pen::new(colour, 1.5)),
        Item::area(tip, Paint::full(colour)),
    ]
}

/// The colour of a value.
fn shade(scale: &ColourScale, value: f64) -> Colour {
    at(scale.colours, scale.axis.share(value).unwrap_or_default().clamp(0.0, 1.0))
}

/// What is seen on a colour: ink or white.
fn on(Colour([red, green, blue]): Colour) -> Colour {
    let light = 0.299 * f64::from(red) + 0.587 * f64::from(green) + 0.114 * f64::from(blue);
    if light > 140.0 { Colour::INK } else { Colour::WHITE }
}

/// The colour a share of the way along a scale.
pub(super) fn at(colours: Colours, share: f64) -> Colour {
    /// Nine of matplotlib's, evenly apart.
    const VIRIDIS: [[u8; 3]; 9] = [
        [68, 1, 84],
        [71, 44, 122],
        [59, 81, 139],
        [44, 113, 142],
        [33, 144, 141],
        [39, 173, 129],
        [92, 200, 99],
        [170, 220, 50],
        [253, 231, 37],
    ];
    match colours {
        Colours::Viridis => {
            let along = share * (VIRIDIS.len() - 1) as f64;
            let i = (along as usize).min(VIRIDIS.len() - 2);
            Colour(VIRIDIS[i]).towards(Colour(VIRIDIS[i + 1]), along - i as f64)
        }
        Colours::Blues => Colour::WHITE.towards(Colour::nth(0), share),
        Colours::Greys => Colour([90, 90, 90]).towards(Colour::WHITE, share),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A thousand points a column: those of each that show, and no others, in their order.
    #[test]
    fn an_outline_keeps_the_extremes_and_the_order() {
        let point = |i: u32| [COLUMN * f64::from(i) / 1000.0, f64::from(i * 7919 % 100_003)];
        let points: Vec<Point> = (0..100_000).map(point).collect();
        let drawn = outline(&points);
        assert!(drawn.len() <= 408 && drawn.windows(2).all(|pair| pair[0][0] < pair[1][0]), "{}", drawn.len());
        let ends = |points: &[Point]| {
            points.iter().fold((f64::MAX, f64::MIN), |(low, high), [_, y]| (low.min(*y), high.max(*y)))
        };
        assert_eq!(ends(&drawn), ends(&points));
        assert_eq!(outline(&points[..2]), points[..2]);
    }

    #[test]
    fn neighbours_of_a_large_grid_are_averaged() {
        let colours = [0, 100, 7, 50, 150, 9].map(|red| Colour([red, 0, 0]));
        assert_eq!(averaged(&colours, 3, 2), (2, vec![Colour([75, 0, 0]), Colour([8, 0, 0])]));
    }

    #[test]
    fn colours_go_from_end_to_end() {
        assert_eq!([0.0, 1.0].map(|share| at(Colours::Viridis, share)), [[68, 1, 84], [253, 231, 37]].map(Colour));
        assert_eq!([0.0, 1.0].map(|share| at(Colours::Greys, share)), [Colour([90; 3]), Colour::WHITE]);
    }
}
