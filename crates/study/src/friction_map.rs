//! The maps of a table: friction, or another column, over two of speed, load and temperature, one for each value of the
//! third.

use std::fmt;
use std::path::Path;

use asperity::element::{Quantity, SweepGrid, some_of};
use asperity::tables::GivenColumns;

use crate::Error;
use crate::calibration::{Measured, left_out_in_words};
use crate::comparison::measured_beside;
use crate::picture::{
    Axis, Colour, ColourScale, Colours, ContourLine, Fill, Fit, GridField, Mark, Panel, Picture, Point, Row, Shape,
    Stroke, Symbol, Tick,
};
use crate::sweep::{Over, SweepColumn, SweepHeader, SweepRow, SweepTable, SweptQuantity, is_converged, way_of};

/// The maps that are asked for, and what was measured.
#[derive(Debug)]
pub struct Maps {
    over: Over,
    third: SweptQuantity,
    column: Option<SweepColumn>,
    measured: Vec<Measured>,
    /// How the measurements were read.
    pub notes: Vec<String>,
}

impl Maps {
    /// Of a table at `path` with this header, with the measurements in the file `data`.
    ///
    /// # Errors
    /// Where the table is not over these quantities, or the measurements cannot be read.
    pub fn new(
        over: Over,
        header: &SweepHeader,
        path: &Path,
        data: Option<(&Path, &GivenColumns)>,
    ) -> Result<Self, Error> {
        let load = SweptQuantity::of_load(header.load);
        if let Some(asked) = over.0.into_iter().find(|quantity| quantity.is_load() && *quantity != load) {
            let instead = Over(over.0.map(|quantity| if quantity == asked { load } else { quantity }));
            let (asked, found) = (asked.word(), load.word());
            return Err(Error::value(format!(
                "`over` {over}: the table is over {found}, not over {asked}: `over` {instead}"
            )));
        }
        for quantity in over.0 {
            let values = quantity.values(&header.grid);
            if values.is_empty() {
                return Err(Error::value(format!(
                    "`over` {over}: the scene has no material.wlf, so that there is one temperature alone: expected speed and \
                     load"
                )));
            }
            if values.len() < 2 {
                return Err(Error::value(format!(
                    "`over` {over}: expected at least 2 values along each side of a map, of the {} there is one: give more, \
                     as {}",
                    quantity.word(),
                    example(quantity)
                )));
            }
        }
        let all = [SweptQuantity::Speed, load, SweptQuantity::Temperature];
        let third = all.into_iter().find(|quantity| !over.0.contains(quantity)).unwrap_or(load);
        let found =
            data.map(|(data, columns)| measured_beside(header, path, data, columns)).transpose()?.unwrap_or_default();
        Ok(Self { over, third, column: None, measured: found.rows, notes: found.notes })
    }

    /// The same maps of another column than friction, if there is one.
    #[must_use]
    pub fn of_column(self, column: Option<SweepColumn>) -> Self {
        Self { column, ..self }
    }

    /// The picture, and in words which measurements it has no place for.
    pub fn picture(&self, table: &SweepTable) -> (Picture, Option<String>) {
        let grid = &table.header.grid;
        let [x, y] = self.over.0.map(|quantity| quantity.axis(grid));
        let (places, left_out) = self.placed(table, [&x, &y]);
        let unseen = left_out.iter().map(|(row, why)| (vec![row.line], row.point, why));
        let thirds = self.thirds(grid);
        let values: Vec<_> = thirds.iter().map(|third| self.values(table, *third)).collect();
        let all = values.iter().flatten().copied().flatten().chain(places.iter().map(|(_, place)| place.value));
        let of = self.column.as_ref().map_or(("friction", ""), SweepColumn::of);
        let scale = Axis::linear(of, all, Fit::Tight);
        let frame =
            Frame { x, y, lines: self.over.0.map(|quantity| quantity.values(grid)), scale, count: thirds.len() };
        let panel = |((index, third), values): ((usize, &Option<f64>), &Vec<Option<f64>>)| {
            let measured: Vec<&Place> =
                places.iter().filter(|(panel, _)| *panel == index).map(|(_, place)| place).collect();
            Panel {
                title: third.map(|value| self.third.named(value)).unwrap_or_default(),
                ..frame.panel(values, &measured)
            }
        };
        let panels: Vec<Panel> = thirds.iter().enumerate().zip(&values).map(panel).collect();
        let mut rows: Vec<Row> =
            panels.chunks(BESIDE).map(|panels| Row { panels: panels.to_vec(), ..Row::default() }).collect();
        rows[0].note = remark(&table.header);
        let picture = Picture::of(rows).titled(table.header.scene());
        (picture, left_out_in_words(unseen, self.measured.len()))
    }

    /// The points without a result, in words; `None` where there are none.
    pub fn empty(table: &SweepTable) -> Option<String> {
        let header = &table.header;
        let without = header.grid.points().filter_map(|point| {
            let row = table.rows.iter().find(|row| row.point == point);
            let why = match row {
                Some(row) if row.is_result() => return None,
                Some(row) => row.status.text(),
                None => "not computed",
            };
            Some(format!("{}: {why}", point.describe(header.load)))
        });
        let without: Vec<String> = without.collect();
        (!without.is_empty()).then(|| some_of(&without))
    }

    /// The values of the third quantity: a panel each; of a scene without temperatures one without a name.
    fn thirds(&self, grid: &SweepGrid) -> Vec<Option<f64>> {
        let values = self.third.values(grid);
        if values.is_empty() { vec![None] } else { values.iter().copied().map(Some).collect() }
    }

    /// Friction, or what else is drawn, on the grid of a panel.
    fn values(&self, table: &SweepTable, third: Option<f64>) -> Vec<Option<f64>> {
        let grid = &table.header.grid;
        let value = |row: &SweepRow| match &self.column {
            Some(column) => column.value(row),
            None => row.value(Quantity::Friction),
        };
        let mut found = vec![None; grid.count()];
        for row in table.rows.iter().filter(|row| row.is_result()) {
            if let Some(index) = grid.index(&row.point) {
                found[index] = value(row);
            }
        }
        let [x, y] = self.over.0.map(|quantity| quantity.values(grid));
        let at = |x: f64, y: f64| {
            let mut point = grid.point(0);
            self.over.0.iter().zip([x, y]).for_each(|(quantity, value)| quantity.set(&mut point, value));
            third.iter().for_each(|value| self.third.set(&mut point, *value));
            found[grid.index(&point)?]
        };
        y.iter().flat_map(|&y| x.iter().map(move |&x| (x, y))).map(|(x, y)| at(x, y)).collect()
    }

    /// The panel and place of each measurement, and the measurements without one.
    fn placed(&self, table: &SweepTable, axes: [&Axis; 2]) -> (Vec<PlaceInPanel>, Vec<LeftOut>) {
        let thirds = self.thirds(&table.header.grid);
        let (mut places, mut left_out) = (Vec::new(), Vec::new());
        for row in &self.measured {
            if row.point.way.is_some() && row.point.way != way_of(&table.header.keys) {
                left_out.push((*row, NoPlace::OtherWay));
                continue;
            }
            let [x, y] = self.over.0.map(|quantity| quantity.of(&row.point));
            let own = self.third.of(&row.point);
            let panel = thirds.iter().position(|third| match (third, own) {
                (Some(third), Some(own)) => is_like(self.third, *third, own),
                _ => true,
            });
            match (panel, x.filter(|x| axes[0].has(*x)), y.filter(|y| axes[1].has(*y))) {
                (Some(panel), Some(x), Some(y)) => {
                    places.push((panel, Place { at: [x, y], value: row.friction }));
                }
                (None, ..) => left_out.push((*row, NoPlace::OtherPanel(self.third.word()))),
                _ => left_out.push((*row, NoPlace::Beyond)),
            }
        }
        (places, left_out)
    }
}

/// What the table is, where one has to know.
fn remark(header: &SweepHeader) -> String {
    let is_open = is_converged(&header.keys) == Some(false);
    let open = is_open.then_some("not converged: see the table");
    let own = header.samples.is_some().then_some("the scene's own numbers: bands of the samples are in the table");
    open.into_iter().chain(own).collect::<Vec<_>>().join("; ")
}

/// A measured value and where it is.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Place {
    at: Point,
    value: f64,
}

/// Most maps side by side.
const BESIDE: usize = 3;
/// Cells of a map's colours along its longer side, about so many, and of the grid on which contours are drawn.
const CELLS: usize = 280;
const CONTOUR_CELLS: usize = 96;
/// More computed points than these are not marked.
const MOST_MARKED: usize = 900;
/// The colour of the lines along which friction is largest.
const RIDGE: usize = 1;

/// What all maps of a picture have in common.
#[derive(Debug)]
struct Frame<'a> {
    x: Axis,
    y: Axis,
    /// The values of both axes.
    lines: [&'a [f64]; 2],
    scale: Axis,
    count: usize,
}

impl Frame<'_> {
    fn panel(&self, values: &[Option<f64>], measured: &[&Place]) -> Panel {
        let size = if self.count == 1 { [560.0, 420.0] } else { [330.0, 270.0] };
        let shares = |axis: &Axis, lines: &[f64]| lines.iter().filter_map(|at| axis.share(*at)).collect::<Vec<f64>>();
        let field = GridField::new(shares(&self.x, self.lines[0]), shares(&self.y, self.lines[1]), values.to_vec());
        let columns = CELLS;
        let cells = field.sampled(columns, (columns as f64 * size[1] / size[0]) as usize);
        let heat = Mark::new("", 0, Shape::Heat { columns, values: cells }).coloured(Colour::WHITE);
        let marks = [heat].into_iter().chain(self.points(values)).chain([self.contours(&field)]);
        let marks =
            marks.chain(self.ridges(values)).chain(Some(measurements(measured)).filter(|_| !measured.is_empty()));
        let scale = Some(ColourScale { axis: self.scale.clone(), colours: Colours::Viridis });
        Panel { scale, ..Panel::new(self.x.clone(), self.y.clone(), marks.collect()).sized(size[0], size[1]) }
    }

    /// The points that were computed, where they are not many, and those of them without a result.
    fn points(&self, values: &[Option<f64>]) -> Vec<Mark> {
        let [x, y] = self.lines;
        let places = || y.iter().flat_map(|&y| x.iter().map(move |&x| [x, y])).zip(values);
        let computed = places().filter(|(_, value)| value.is_some() && values.len() <= MOST_MARKED);
        let empty: Vec<Point> = places().filter(|(_, value)| value.is_none()).map(|(place, _)| place).collect();
        let dots = Shape::points(computed.map(|(place, _)| place).collect(), Symbol::Disc, Fill::Full, 1.0);
        let crosses = Shape::points(empty.clone(), Symbol::Cross, Fill::Full, 5.0);
        let crosses = Some(Mark::new("no result", 0, crosses).coloured(Colour::INK)).filter(|_| !empty.is_empty());
        [Mark::new("", 0, dots).coloured(Colour([150, 150, 150]))].into_iter().chain(crosses).collect()
    }

    fn contours(&self, field: &GridField) -> Mark {
        let refined = field.refined(CONTOUR_CELLS.div_ceil(self.lines[0].len().min(self.lines[1].len())).max(1));
        let lines = self.scale.ticks(0).into_iter().flat_map(|Tick { at, name }| {
            let place = |&(x, y): &(f64, f64)| [self.x.value(x), self.y.value(y)];
            let line = move |points: Vec<Point>| ContourLine { value: at, label: name.clone(), points };
            refined
                .contours(at)
                .into_iter()
                .map(|places| places.iter().map(place).collect())
                .map(line)
                .collect::<Vec<_>>()
        });
        Mark::new("", 0, Shape::Contours(lines.collect()))
    }

    /// Lines along which friction is largest, white behind.
    fn ridges(&self, values: &[Option<f64>]) -> Vec<Mark> {
        let name = format!("largest over the {}", self.x.quantity);
        let all = ridges(&self.x, self.lines, values);
        let marks = all.into_iter().flat_map(|ridge| {
            let line = |width: f64| Shape::Line { points: ridge.clone(), stroke: Stroke::Solid, width };
            let dots = |radius: f64| Shape::points(ridge.clone(), Symbol::Disc, Fill::Full, radius);
            let behind = [line(4.0), dots(4.0)].map(|shape| Mark::new("", 0, shape).coloured(Colour::WHITE));
            let named = [line(2.0), dots(2.9)].map(|shape| Mark::new(&name, RIDGE, shape));
            behind.into_iter().chain(named).collect::<Vec<_>>()
        });
        marks.collect()
    }
}

/// Discs with the colours of what was measured.
fn measurements(measured: &[&Place]) -> Mark {
    let shape = Shape::Points {
        points: measured.iter().map(|place| place.at).collect(),
        symbol: Symbol::Disc,
        fill: Fill::Full,
        radius: 5.0,
        labels: Vec::new(),
        values: measured.iter().map(|place| place.value).collect(),
    };
    Mark::new("measured", 0, shape).coloured(Colour::INK)
}

/// A panel's index, and a measured place in it.
type PlaceInPanel = (usize, Place);
/// A measurement in no map, and why.
type LeftOut = (Measured, NoPlace);

/// Why a measurement is in no map.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum NoPlace {
    Beyond,
    OtherPanel(&'static str),
    OtherWay,
}

impl fmt::Display for NoPlace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Beyond => f.write_str("beyond the map"),
            Self::OtherPanel(quantity) => write!(f, "there is no map of this {quantity}"),
            Self::OtherWay => f.write_str("the table is of another way, or of none"),
        }
    }
}

/// Whether a measurement belongs to the map of a value: temperatures within 3 K and other values within a tenth are one, as
/// in the curves of a calibration.
fn is_like(quantity: SweptQuantity, value: f64, measured: f64) -> bool {
    match quantity {
        SweptQuantity::Temperature => (measured - value).abs() <= 3.0,
        _ => measured <= 1.1 * value && value <= 1.1 * measured,
    }
}

fn example(quantity: SweptQuantity) -> &'static str {
    match quantity {
        SweptQuantity::Speed => "`speeds` 1e-4..10/11",
        SweptQuantity::Pressure => "`pressures` 1bar..10bar/5",
        SweptQuantity::Force => "`forces` 10..100/5",
        SweptQuantity::Temperature => "`temperatures` 0°C..40°C/5",
    }
}

/// Lines of x and y through the largest value of each row that has it inside: at the vertex of the parabola through the
/// points beside it.
fn ridges(x: &Axis, lines: [&[f64]; 2], values: &[Option<f64>]) -> Vec<Vec<Point>> {
    let rows = values.chunks(lines[0].len()).zip(lines[1]);
    let tops: Vec<Option<Point>> = rows.map(|(row, &y)| Some([top(x, lines[0], row)?, y])).collect();
    tops.split(Option::is_none)
        .filter(|part| !part.is_empty())
        .map(|part| part.iter().flatten().copied().collect())
        .collect()
}

/// Where a row is largest; `None` where it is at an end or beside a point without a value.
fn top(x: &Axis, places: &[f64], row: &[Option<f64>]) -> Option<f64> {
    let found = row.iter().enumerate().filter_map(|(i, value)| Some((i, (*value)?)));
    let (i, largest) = found.max_by(|a, b| a.1.total_cmp(&b.1))?;
    let (before, after) = (i.checked_sub(1)?, i + 1);
    let (low, high) = ((*row.get(before)?)?, (*row.get(after)?)?);
    let share = |i: usize| x.share(places[i]);
    let (left, middle, right) = (share(before)?, share(i)?, share(after)?);
    let (rise, fall) = ((largest - low) / (middle - left), (largest - high) / (right - middle));
    // Of three that are equal the middle.
    let vertex = if rise + fall > 0.0 {
        // The slope goes from `rise` half way before the middle to -`fall` half way after it.
        (left + middle) / 2.0 + rise / (rise + fall) * (right - left) / 2.0
    } else {
        middle
    };
    Some(x.value(vertex.clamp(left, right)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn speeds(count: i32) -> (Axis, Vec<f64>) {
        let values: Vec<f64> = (0..count).map(|i| 10_f64.powf(f64::from(i) / 2.0 - 3.0)).collect();
        (Axis::logarithmic_tight(("speed", "m/s"), values.iter().copied()), values)
    }

    /// Of a parabola in the logarithm of the speed the ridge is exact wherever it lies between the points.
    #[test]
    fn the_ridge_is_where_a_parabola_is_largest() {
        let (x, places) = speeds(8);
        let tops: [f64; 4] = [0.013, 0.1, 2e-4, 0.05];
        let at = |x: f64, top: f64| Some(1.0 - 0.1 * (x / top).ln().powi(2));
        let values: Vec<_> = tops.iter().flat_map(|top| places.iter().map(|x| at(*x, *top))).collect();
        // The third is beyond the slowest speed.
        let found = ridges(&x, [&places, &[1.0, 2.0, 3.0, 4.0]], &values);
        assert_eq!(found.iter().map(Vec::len).collect::<Vec<_>>(), [2, 1]);
        let expected = [[0.013, 1.0], [0.1, 2.0], [0.05, 4.0]];
        for (found, expected) in found.concat().iter().zip(expected) {
            assert!((found[0] / expected[0] - 1.0).abs() < 1e-12 && found[1] == expected[1], "{found:?}");
        }
    }

    #[test]
    fn what_may_be_larger_where_nothing_is_known_is_no_ridge() {
        let (x, places) = speeds(4);
        let top = |row: &[Option<f64>]| top(&x, &places, row);
        assert_eq!(top(&[Some(1.0), Some(2.0), None, Some(0.0)]), None);
        assert_eq!(top(&[Some(1.0), Some(2.0), Some(3.0), Some(4.0)]), None);
        assert_eq!(top(&[None; 4]), None);
        let even = top(&[Some(0.0), Some(1.0), Some(0.0), None]).unwrap();
        assert!((even / places[1] - 1.0).abs() < 1e-12, "{even}");
    }
}
