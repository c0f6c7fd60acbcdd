//! The picture of a ranking: indices with their bands, and which scene has the largest friction over two quantities.

use asperity::element::SweepGrid;

use super::{RankFound, RankedPoint, Ranking, SURE};
use crate::decimals::short;
use crate::picture::{Axis, Colour, Fill, Fit, Mark, Panel, Picture, Point, Row, Shape, Symbol, Tick};
use crate::sweep::SweptQuantity;

/// The bands, and the map where there are two quantities of several values.
pub fn picture(found: &RankFound) -> Picture {
    let map = found.tables.first().and_then(|table| map(&found.ranking, &table.header.grid));
    Picture::of([bands(&found.ranking)].into_iter().chain(map.into_iter().flatten()).collect()).titled("Ranking")
}

/// A line from the first to the last quantile, a box between the quartiles, a line at the median, and the scene's own
/// number.
fn bands(ranking: &Ranking) -> Row {
    /// The space at either end of the axis, as a share of what is drawn.
    const ROOM: f64 = 0.06;
    let scenes = || ranking.order.iter().zip(0..).map(|(&scene, row)| (scene, &ranking.scenes[scene], -f64::from(row)));
    let marks = scenes().flat_map(|(look, scene, at)| {
        let line = |from: f64, to: f64, half: f64| Mark::line("", look, vec![[from, at - half], [to, at + half]]);
        let own = |radius, fill| Shape::points(vec![[scene.index, at]], Symbol::Disc, fill, radius);
        let band = scene.index_band.map(|[low, quarter, median, three_quarters, high]| {
            let middle = line(median, median, 0.2).coloured(Colour::WHITE);
            let between = Mark::boxes("", look, vec![[quarter, at - 0.2, three_quarters, at + 0.2]]);
            vec![line(low, high, 0.0), line(low, low, 0.1), line(high, high, 0.1), between, middle]
        });
        let fill = if band.is_some() { Fill::Hollow } else { Fill::Full };
        let number = Mark::new("", look, own(5.0, fill));
        let number = if band.is_some() { number.coloured(Colour::INK) } else { number };
        band.into_iter().flatten().chain([number]).collect::<Vec<_>>()
    });
    let marks: Vec<Mark> = marks.collect();
    let values = || scenes().flat_map(|(_, scene, _)| scene.index_band.into_iter().flatten().chain([scene.index]));
    let (low, high) = (values().fold(f64::MAX, f64::min), values().fold(f64::MIN, f64::max));
    let room = (ROOM * (high - low)).max(0.01 * high.abs());
    let first = ranking.scenes.first().map(|scene| scene.label.as_str()).unwrap_or_default();
    let quantity = format!("mean friction, {first} = 100");
    let note = if ranking.samples == 0 { "" } else { "bands of 50 and 90 %, line: median, ring: own numbers" };
    let x = Axis::linear((&quantity, ""), [low - room, high + room], Fit::Tight);
    let y = Axis::names(scenes().map(|(_, scene, _)| scene.label.clone()));
    let beside = scenes().map(|(_, scene, at)| {
        let name = match ranking.samples {
            0 => format!("{:.1}", scene.index),
            _ => format!("largest with probability {}", short(scene.largest, 2)),
        };
        Tick { at, name }
    });
    let beside = beside.collect();
    let panel = Panel { beside, ..Panel::new(x, y, marks) }.sized(440.0, 40.0 * ranking.order.len() as f64);
    Row { note: note.to_owned(), ..panel.into() }
}

/// The map over speed and temperature or, where one of these has one value alone, with the load in its place.
fn map(ranking: &Ranking, grid: &SweepGrid) -> Option<Vec<Row>> {
    /// Most maps side by side.
    const BESIDE: usize = 3;
    let load = SweptQuantity::of_load(ranking.load);
    let (speed, temperature) = (SweptQuantity::Speed, SweptQuantity::Temperature);
    let all = [[speed, temperature, load], [speed, load, temperature], [load, temperature, speed]];
    let has_two = |quantity: SweptQuantity| quantity.values(grid).len() > 1;
    let [x, y, third] = all.into_iter().find(|[x, y, _]| has_two(*x) && has_two(*y))?;
    let thirds: Vec<Option<f64>> = match third.values(grid) {
        [] => vec![None],
        values => values.iter().copied().map(Some).collect(),
    };
    let size = if thirds.len() == 1 { [560.0, 420.0] } else { [330.0, 270.0] };
    let panel = |value: &Option<f64>| {
        let at = |x_value: f64, y_value: f64| {
            let mut point = grid.point(0);
            x.set(&mut point, x_value);
            y.set(&mut point, y_value);
            value.iter().for_each(|value| third.set(&mut point, *value));
            grid.index(&point).and_then(|index| ranking.points.get(index)).map_or(Choice::Nothing, choice)
        };
        let (across, up) = (x.axis(grid), y.axis(grid));
        let marks = cells(ranking, [(&across, x.values(grid)), (&up, y.values(grid))], at);
        let title = value.map(|value| third.named(value)).unwrap_or_default();
        Panel { title, ..Panel::new(across, up, marks) }.sized(size[0], size[1])
    };
    let panels: Vec<Panel> = thirds.iter().map(panel).collect();
    let mut rows: Vec<Row> =
        panels.chunks(BESIDE).map(|panels| Row { panels: panels.to_vec(), ..Row::default() }).collect();
    rows[0].title = "Which has the largest friction".into();
    rows[0].note = match ranking.samples {
        0 => "no probabilities, for no scene has [uncertainty]".to_owned(),
        _ => format!("pale where its probability is below {SURE}"),
    };
    Some(rows)
}

/// What is chosen at a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Choice {
    /// One of the scenes, by its number.
    One { which: usize, is_sure: bool },
    /// Several as well as each other.
    Equal,
    /// There is no result.
    Nothing,
}

fn choice(point: &RankedPoint) -> Choice {
    let top = point.largest.iter().copied().fold(0.0, f64::max);
    let mut of_top = point.largest.iter().enumerate().filter(|(_, part)| **part == top);
    match (top > 0.0, of_top.next(), of_top.next()) {
        (true, Some((which, _)), None) => Choice::One { which, is_sure: top >= SURE },
        (true, Some(_), Some(_)) => Choice::Equal,
        _ => Choice::Nothing,
    }
}

/// A cell about each point, pale where the choice is not sure.
fn cells(
    ranking: &Ranking,
    [(x, xs), (y, ys)]: [(&Axis, &[f64]); 2],
    choice: impl Fn(f64, f64) -> Choice,
) -> Vec<Mark> {
    /// How much of its colour a pale cell has.
    const PALE: f64 = 0.35;
    let (columns, rows) = (cell_edges(x, xs), cell_edges(y, ys));
    let places = || (0..ys.len()).flat_map(|j| (0..xs.len()).map(move |i| (i, j)));
    let found: Vec<(Choice, [f64; 4], Point)> = places()
        .map(|(i, j)| (choice(xs[i], ys[j]), [columns[i], rows[j], columns[i + 1], rows[j + 1]], [xs[i], ys[j]]))
        .collect();
    let of = |wanted: Choice| found.iter().filter(move |(choice, ..)| *choice == wanted);
    let boxes = |wanted: Choice| of(wanted).map(|(_, corners, _)| *corners).collect::<Vec<_>>();
    let scenes = ranking.scenes.iter().enumerate().flat_map(|(which, scene)| {
        let [sure, pale] = [true, false].map(|is_sure| boxes(Choice::One { which, is_sure }));
        let colour = Colour::WHITE.towards(Colour::nth(which), PALE);
        [Mark::boxes(&scene.label, which, sure), Mark::boxes("", which, pale).coloured(colour)]
    });
    let equal = Some(boxes(Choice::Equal)).filter(|boxes| !boxes.is_empty());
    let equal = equal.map(|boxes| Mark::boxes("equal", 0, boxes).coloured(Colour::GRID));
    let points = |nothing: bool| -> Vec<Point> {
        found.iter().filter(|found| (found.0 == Choice::Nothing) == nothing).map(|found| found.2).collect()
    };
    let dots = Shape::points(points(false), Symbol::Disc, Fill::Full, 1.0);
    let crosses = Some(points(true)).filter(|points| !points.is_empty());
    let crosses =
        crosses.map(|points| Mark::new("no result", 0, Shape::points(points, Symbol::Cross, Fill::Full, 5.0)));
    let marks = scenes.chain(equal).chain([Mark::new("", 0, dots)]);
    let ink = |mark: Mark| if matches!(mark.shape, Shape::Points { .. }) { mark.coloured(Colour::INK) } else { mark };
    marks.chain(crosses).map(ink).collect()
}

/// The edges of cells about values of an axis: they reach half way to their neighbours.
fn cell_edges(axis: &Axis, values: &[f64]) -> Vec<f64> {
    let shares: Vec<f64> = values.iter().filter_map(|value| axis.share(*value)).collect();
    let between = shares.windows(2).map(|pair| axis.value(f64::midpoint(pair[0], pair[1])));
    [axis.low].into_iter().chain(between).chain([axis.high]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cell_reaches_half_way_to_its_neighbours() {
        let values = [0.0, 0.2, 1.0];
        let axis = Axis::linear(("", ""), values, Fit::Tight);
        assert_eq!(cell_edges(&axis, &values), [0.0, 0.1, 0.6, 1.0]);
    }
}
