//! Where the rows, panels, axes and scales of a picture stand.

use asperity_study::picture::{Colour, ColourScale, Frame, Panel, Picture, Point, Row, Tick};

use super::drawing::{Drawing, Item, LABEL_SIZE, Paint, Pen, Side, TEXT_SIZE, TICK_SIZE, TITLE_SIZE};
use super::font;
use super::legend::{LINE, Legend};
use super::marks::{Placed, at};

/// The height of a title.
const TITLE: f64 = 36.0;
/// Between the edges of a picture and what is in it; more at the right, where half of a tick's name stands.
const MARGIN: f64 = 8.0;
const RIGHT: f64 = 28.0;
/// Space for names and title of the vertical axis, and of the horizontal one.
const LEFT: f64 = 78.0;
const BELOW: f64 = 50.0;
const TICK: f64 = 5.0;
/// Space for the name of a tick along a horizontal and along a vertical axis.
const NAME: [f64; 2] = [46.0, 28.0];
/// The width of a scale's bar, and how many colours it has.
const BAR: f64 = 16.0;
const COLOURS: u32 = 64;

/// A panel, the space on its left and right, and whether the bar of its scale stands there.
#[derive(Debug)]
struct Cell<'a> {
    panel: &'a Panel,
    left: f64,
    right: f64,
    has_bar: bool,
}

/// Lays a picture out.
pub(super) fn drawing(picture: &Picture) -> Drawing {
    let mut shown = Vec::new();
    let rows: Vec<Vec<Cell<'_>>> = picture.rows.iter().map(|row| cells(row, &mut shown)).collect();
    let width_of = |cells: &Vec<Cell<'_>>| cells.iter().map(Cell::width).sum::<f64>();
    let width = rows.iter().map(width_of).fold(0.0, f64::max);
    let mut layout = Layout { items: Vec::new(), legend: Legend::default(), width, y: 0.0 };
    layout.title(&picture.title);
    picture.rows.iter().zip(&rows).for_each(|(row, cells)| layout.row(row, cells));
    Drawing { size: [width.ceil(), layout.y.ceil()], items: layout.items }
}

/// The panels of a row. A scale that was not shown has its bar beside the last of them that it belongs to.
fn cells<'a>(row: &'a Row, shown: &mut Vec<&'a ColourScale>) -> Vec<Cell<'a>> {
    let mut cells: Vec<Cell<'_>> = row.panels.iter().map(Cell::new).collect();
    let before = shown.len();
    for cell in cells.iter_mut().rev() {
        let Some(scale) = cell.panel.scale.as_ref().filter(|scale| !shown.contains(scale)) else { continue };
        shown.push(scale);
        cell.has_bar = true;
        cell.right += MARGIN + font::width(&scale.axis.title(), TEXT_SIZE).max(BAR + 56.0);
    }
    shown[before..].reverse();
    cells
}

impl<'a> Cell<'a> {
    fn new(panel: &'a Panel) -> Self {
        let widest =
            |ticks: &[Tick], size: f64| ticks.iter().map(|tick| font::width(&tick.name, size)).fold(0.0, f64::max);
        let beside = if panel.beside.is_empty() { 0.0 } else { MARGIN + widest(&panel.beside, TEXT_SIZE) };
        let (left, right) = match panel.frame {
            Frame::Axes => (LEFT.max(widest(&panel.y.named, TEXT_SIZE) + 3.0 * MARGIN), RIGHT),
            Frame::Line => (MARGIN, MARGIN),
            Frame::None => (0.0, 0.0),
        };
        Self { panel, left, right: right.max(if beside > 0.0 { beside + MARGIN } else { 0.0 }), has_bar: false }
    }

    fn width(&self) -> f64 {
        self.left + self.panel.size[0] + self.right
    }
}

/// What is laid out so far.
struct Layout {
    items: Vec<Item>,
    legend: Legend,
    width: f64,
    /// From where on there is space.
    y: f64,
}

impl Layout {
    fn title(&mut self, title: &str) {
        if !title.is_empty() {
            let at = [self.width / 2.0, self.y + 4.0 + TITLE / 2.0];
            self.items.push(Item::text(title, at, Side::Middle, TITLE_SIZE));
            self.y += TITLE + 4.0;
        }
    }

    fn row(&mut self, row: &Row, cells: &[Cell<'_>]) {
        self.title(&row.title);
        let left = cells.first().map_or(0.0, |cell| cell.left.min(LEFT));
        if !row.note.is_empty() {
            self.items.push(Item::text(&row.note, [left, self.y + LINE / 2.0], Side::Start, TEXT_SIZE));
            self.y += LINE;
        }
        let (items, height) = self.legend.items(&row.panels, [left, self.y], self.width);
        self.items.extend(items);
        self.y += height;
        let has = |of: fn(&Cell<'_>) -> bool| cells.iter().any(of);
        // Of panels in a line alone, the picture's edges are theirs.
        let margin = if has(|cell| cell.panel.frame != Frame::None) { MARGIN } else { 0.0 };
        self.y += margin + if has(|cell| !cell.panel.title.is_empty() || cell.has_bar) { LINE - MARGIN } else { 0.0 };
        let mut x = 0.0;
        for cell in cells {
            let placed = Placed { panel: cell.panel, corner: [x + cell.left, self.y] };
            self.panel(cell, placed);
            x += cell.width();
        }
        let tallest = cells.iter().map(|cell| cell.panel.size[1]).fold(0.0, f64::max);
        self.y += tallest + margin + if has(|cell| cell.panel.frame == Frame::Axes) { BELOW } else { 0.0 };
    }

    fn panel(&mut self, cell: &Cell<'_>, placed: Placed<'_>) {
        let (panel, [left, top], [right, bottom]) = (cell.panel, placed.corner, placed.end());
        let title = Item::text(&panel.title, [(left + right) / 2.0, top - LINE / 2.0], Side::Middle, TEXT_SIZE);
        self.items.extend(Some(title).filter(|_| !panel.title.is_empty()));
        if panel.frame == Frame::Axes {
            self.grid(placed);
        }
        self.items.extend(placed.marks());
        match panel.frame {
            Frame::Axes => self.axes(cell, placed),
            Frame::Line => {
                let points = vec![[left, top], [right, top], [right, bottom], [left, bottom]];
                let pen = Some(Pen::new(Colour::INK, 1.0));
                self.items.push(Item::Path { points, is_closed: true, fill: None, pen });
            }
            Frame::None => {}
        }
        for Tick { at, name } in &panel.beside {
            let place = panel.y.share(*at).map(|share| [right + MARGIN, bottom - share * panel.size[1]]);
            let size = if panel.y.named.is_empty() { LABEL_SIZE } else { TEXT_SIZE };
            self.items.extend(place.map(|place| Item::text(name, place, Side::Start, size)));
        }
        if let Some(scale) = panel.scale.as_ref().filter(|_| cell.has_bar) {
            self.bar(scale, [right + 2.0 * MARGIN, top], panel.size[1]);
        }
    }

    /// Lines across and along at the ticks, thin ones between them on a logarithmic axis.
    fn grid(&mut self, placed: Placed<'_>) {
        let (panel, [left, top], [right, bottom]) = (placed.panel, placed.corner, placed.end());
        let along = |at: f64| Some(left + panel.x.share(at)? * panel.size[0]);
        let down = |at: f64| Some(bottom - panel.y.share(at)? * panel.size[1]);
        let fine = Pen { paint: Paint { colour: Colour::GRID, opacity: 0.45 }, width: 0.6, dashes: None };
        let bold = Pen::new(Colour::GRID, 1.0);
        let places = |ticks: Vec<Tick>| ticks.into_iter().map(|tick| tick.at).collect::<Vec<_>>();
        let [columns, rows] = most(panel);
        for (pen, x, y) in [
            (fine, panel.x.fine_ticks(), panel.y.fine_ticks()),
            (bold, places(panel.x.ticks(columns)), places(panel.y.ticks(rows))),
        ] {
            let upright = x.into_iter().filter_map(along).map(|x| vec![[x, top], [x, bottom]]);
            let level = y.into_iter().filter(|_| panel.y.named.is_empty()).filter_map(down);
            let lines = upright.chain(level.map(|y| vec![[left, y], [right, y]]));
            self.items.extend(lines.map(|line| Item::line(line, pen)));
        }
    }

    fn axes(&mut self, cell: &Cell<'_>, placed: Placed<'_>) {
        let (panel, [left, top], [right, bottom]) = (placed.panel, placed.corner, placed.end());
        let pen = Pen::new(Colour::INK, 1.0);
        self.items.push(Item::line(vec![[left, top], [left, bottom], [right, bottom]], pen));
        let [columns, rows] = most(panel);
        for Tick { at, name } in panel.x.ticks(columns) {
            let Some(x) = panel.x.share(at).map(|share| left + share * panel.size[0]) else { continue };
            self.items.push(Item::line(vec![[x, bottom], [x, bottom + TICK]], pen));
            self.items.push(Item::text(name, [x, bottom + TICK + 10.0], Side::Middle, TICK_SIZE));
        }
        let size = if panel.y.named.is_empty() { TICK_SIZE } else { TEXT_SIZE };
        for Tick { at, name } in panel.y.ticks(rows) {
            let Some(y) = panel.y.share(at).map(|share| bottom - share * panel.size[1]) else { continue };
            self.items.push(Item::line(vec![[left - TICK, y], [left, y]], pen));
            self.items.push(Item::text(name, [left - TICK - 3.0, y], Side::End, size));
        }
        let middle = [(left + right) / 2.0, bottom + BELOW - TEXT_SIZE / 2.0];
        self.items.push(Item::text(panel.x.title(), middle, Side::Middle, TEXT_SIZE));
        self.items.push(Item::Text {
            text: panel.y.title(),
            at: [left - cell.left + MARGIN + TEXT_SIZE / 2.0, (top + bottom) / 2.0],
            side: Side::Middle,
            size: TEXT_SIZE,
            colour: Colour::INK,
            is_upright: true,
        });
    }

    /// The colours of a scale from its low end, below, to its high one, and its title above.
    fn bar(&mut self, scale: &ColourScale, [left, top]: Point, height: f64) {
        let (right, bottom) = (left + BAR, top + height);
        let shares = |i: u32| [0.0, 0.5, 1.0].map(|part| (f64::from(i) + part) / f64::from(COLOURS));
        self.items.extend((0..COLOURS).map(shares).map(|[low, middle, high]| {
            let [low, high] = [low, high].map(|share| bottom - share * height);
            // Half a pixel further than the next begins, so that nothing shows between them.
            Item::rectangle([left, low], [right, (high - 0.5).max(top)], Paint::full(at(scale.colours, middle)))
        }));
        let pen = Pen::new(Colour::INK, 1.0);
        let points = vec![[left, top], [right, top], [right, bottom], [left, bottom]];
        self.items.push(Item::Path { points, is_closed: true, fill: None, pen: Some(pen) });
        for Tick { at, name } in scale.axis.ticks(8) {
            let Some(y) = scale.axis.share(at).map(|share| bottom - share * height) else { continue };
            self.items.push(Item::line(vec![[right, y], [right + TICK, y]], pen));
            self.items.push(Item::text(name, [right + TICK + 3.0, y], Side::Start, TICK_SIZE));
        }
        self.items.push(Item::text(scale.axis.title(), [left, top - LINE / 2.0], Side::Start, TEXT_SIZE));
    }
}

/// For how many names of ticks there is space along the axes of a panel.
fn most(panel: &Panel) -> [usize; 2] {
    [0, 1].map(|axis| (panel.size[axis] / NAME[axis]) as usize)
}
