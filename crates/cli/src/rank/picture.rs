//! The picture of a ranking: indices with their bands, and which scene has the largest friction over two quantities.

use std::path::Path;

use asperity::element::{Load, SweepGrid};
use asperity_study::decimals::short;
use asperity_study::rank::{RankFound, RankedPoint, Ranking, SURE};

use crate::cli::sweep_values::SweptQuantity;
use crate::figure::{BandRow, Bands, Below, Choice, ChoiceGrid, ChoicePanel, Figure as _, GridAxis};
use crate::files::FileError;

/// Draws the ranking: the map where there are two quantities of several values.
pub(super) fn draw(path: &Path, found: &RankFound) -> Result<(), FileError> {
    let bands = bands(&found.ranking);
    match found.tables.first().and_then(|table| map(&found.ranking, &table.header.grid)) {
        Some(map) => Below(bands, map).write(path),
        None => bands.write(path),
    }
}

fn bands(ranking: &Ranking) -> Bands {
    let row = |&scene: &usize| {
        let ranked = &ranking.scenes[scene];
        let remark = match ranking.samples {
            0 => format!("{:.1}", ranked.index),
            _ => format!("largest with probability {}", short(ranked.largest, 2)),
        };
        BandRow { name: ranked.label.clone(), remark, look: scene, value: ranked.index, band: ranked.index_band }
    };
    let first = ranking.scenes.first().map(|scene| scene.label.as_str()).unwrap_or_default();
    let quantity = match ranking.samples {
        0 => format!("mean friction, {first} = 100"),
        _ => format!("mean friction, {first} = 100: bands of 50 and 90 %, line: median, ring: own numbers"),
    };
    Bands { title: "Ranking".into(), quantity, rows: ranking.order.iter().map(row).collect() }
}

/// The map over speed and temperature or, where one of these has one value alone, with the load in its place.
fn map(ranking: &Ranking, grid: &SweepGrid) -> Option<ChoiceGrid> {
    let load = match ranking.load {
        Load::Pressure { .. } => SweptQuantity::Pressure,
        Load::Force => SweptQuantity::Force,
    };
    let (speed, temperature) = (SweptQuantity::Speed, SweptQuantity::Temperature);
    let all = [[speed, temperature, load], [speed, load, temperature], [load, temperature, speed]];
    let has_two = |quantity: SweptQuantity| quantity.values(grid).len() > 1;
    let [x, y, third] = all.into_iter().find(|[x, y, _]| has_two(*x) && has_two(*y))?;
    let thirds: Vec<Option<f64>> = match third.values(grid) {
        [] => vec![None],
        values => values.iter().copied().map(Some).collect(),
    };
    let panel = |value: Option<f64>| {
        let at = |x_value: f64, y_value: f64| {
            let mut point = grid.point(0);
            x.set(&mut point, x_value);
            y.set(&mut point, y_value);
            value.iter().for_each(|value| third.set(&mut point, *value));
            grid.index(&point).and_then(|index| ranking.points.get(index)).map_or(Choice::Nothing, choice)
        };
        let places = y.values(grid).iter().flat_map(|&y| x.values(grid).iter().map(move |&x| (x, y)));
        let title = value.map(|value| third.named(value)).unwrap_or_default();
        ChoicePanel { title, choices: places.map(|(x, y)| at(x, y)).collect() }
    };
    let remark = match ranking.samples {
        0 => "no probabilities, for no scene has [uncertainty]".to_owned(),
        _ => format!("pale where its probability is below {SURE}"),
    };
    Some(ChoiceGrid {
        title: "Which has the largest friction".into(),
        remark,
        x: GridAxis::of(x, grid),
        y: GridAxis::of(y, grid),
        names: ranking.scenes.iter().map(|scene| scene.label.clone()).collect(),
        panels: thirds.into_iter().map(panel).collect(),
    })
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
