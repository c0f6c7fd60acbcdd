//! The maps of a table: friction over two of speed, load and temperature, one for each value of the third.

use std::fmt;
use std::path::{Path, PathBuf};

use asperity::element::{Load, Quantity, SweepGrid, some_of};
use asperity_study::Error;
use asperity_study::calibration::{Measured, left_out_in_words};
use asperity_study::comparison::measured_beside;
use asperity_study::sweep::{SweepHeader, SweepTable, is_converged, way_of};

use crate::cli::sweep_values::{Over, SweptQuantity};
use crate::figure::{FieldGrid, FieldPanel, GridAxis, MeasuredPlace};
use crate::terminal::{note, warn};

/// The maps that are asked for, and what was measured.
#[derive(Debug)]
pub(super) struct Maps {
    over: Over,
    third: SweptQuantity,
    measured: Vec<Measured>,
}

impl Maps {
    /// Of a table at `path` with this header, with the measurements in the file `data`.
    pub(super) fn new(over: Over, header: &SweepHeader, path: &Path, data: Option<&PathBuf>) -> Result<Self, Error> {
        let load = match header.load {
            Load::Pressure { .. } => SweptQuantity::Pressure,
            Load::Force => SweptQuantity::Force,
        };
        if let Some(asked) = over.0.into_iter().find(|quantity| quantity.is_load() && *quantity != load) {
            let instead = Over(over.0.map(|quantity| if quantity == asked { load } else { quantity }));
            let (asked, found) = (asked.word(), load.word());
            return Err(Error::value(format!(
                "--over {over}: the table is over {found}, not over {asked}: --over {instead}"
            )));
        }
        for quantity in over.0 {
            let values = quantity.values(&header.grid);
            if values.is_empty() {
                return Err(Error::value(format!(
                    "--over {over}: the scene has no material.wlf, so that there is one temperature alone: expected speed and \
                     load"
                )));
            }
            if values.len() < 2 {
                return Err(Error::value(format!(
                    "--over {over}: expected at least 2 values along each side of a map, of the {} there is one: give more, \
                     as --{}",
                    quantity.word(),
                    example(quantity)
                )));
            }
        }
        let all = [SweptQuantity::Speed, load, SweptQuantity::Temperature];
        let third = all.into_iter().find(|quantity| !over.0.contains(quantity)).unwrap_or(load);
        let mut measured = Vec::new();
        if let Some(data) = data {
            let found = measured_beside(header, path, data)?;
            found.notes.iter().for_each(|text| note(text));
            measured = found.rows;
        }
        Ok(Self { over, third, measured })
    }

    /// The picture; warns of what it has no place for.
    pub(super) fn picture(&self, table: &SweepTable) -> FieldGrid {
        let [x, y] = self.over.0.map(|quantity| GridAxis::of(quantity, &table.header.grid));
        let (places, left_out) = self.placed(table, [&x, &y]);
        let unseen = left_out.iter().map(|(row, why)| (vec![row.line], row.point, why));
        left_out_in_words(unseen, self.measured.len()).iter().for_each(|text| warn(text));
        let panel = |(index, third): (usize, Option<f64>)| {
            let values = self.values(table, third);
            FieldPanel {
                title: third.map(|value| self.third.named(value)).unwrap_or_default(),
                ridges: ridges(&x, &y, &values),
                values,
                measured: places.iter().filter(|(panel, _)| *panel == index).map(|(_, place)| *place).collect(),
            }
        };
        let is_open = is_converged(&table.header.keys) == Some(false);
        let open = is_open.then_some("not converged: see the table");
        let own =
            table.header.samples.is_some().then_some("the scene's own numbers: bands of the samples are in the table");
        let remark: Vec<&str> = open.into_iter().chain(own).collect();
        FieldGrid {
            title: table.header.scene().to_owned(),
            remark: remark.join("; "),
            quantity: "friction",
            ridge: format!("largest over the {}", x.quantity),
            panels: self.thirds(&table.header.grid).into_iter().enumerate().map(panel).collect(),
            x,
            y,
        }
    }

    /// The points without a result, in words; `None` where there are none.
    pub(super) fn empty(table: &SweepTable) -> Option<String> {
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

    /// Friction on the grid of a panel.
    fn values(&self, table: &SweepTable, third: Option<f64>) -> Vec<Option<f64>> {
        let grid = &table.header.grid;
        let mut found = vec![None; grid.count()];
        for row in table.rows.iter().filter(|row| row.is_result()) {
            if let Some(index) = grid.index(&row.point) {
                found[index] = row.value(Quantity::Friction);
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
    fn placed(&self, table: &SweepTable, axes: [&GridAxis; 2]) -> (Vec<PlaceInPanel>, Vec<LeftOut>) {
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
                    places.push((panel, MeasuredPlace { x, y, value: row.friction }));
                }
                (None, ..) => left_out.push((*row, NoPlace::OtherPanel(self.third.word()))),
                _ => left_out.push((*row, NoPlace::Beyond)),
            }
        }
        (places, left_out)
    }
}

/// A panel's index, and a measured place in it.
type PlaceInPanel = (usize, MeasuredPlace);
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
        SweptQuantity::Speed => "speeds 1e-4..10/11",
        SweptQuantity::Pressure => "pressures 1bar..10bar/5",
        SweptQuantity::Force => "forces 10..100/5",
        SweptQuantity::Temperature => "temperatures 0°C..40°C/5",
    }
}

/// Lines of x and y through the largest value of each row that has it inside: at the vertex of the parabola through the
/// points beside it.
fn ridges(x: &GridAxis, y: &GridAxis, values: &[Option<f64>]) -> Vec<Vec<(f64, f64)>> {
    let rows = values.chunks(x.values.len()).zip(&y.values);
    let tops: Vec<Option<(f64, f64)>> = rows.map(|(row, &y)| Some((top(x, row)?, y))).collect();
    tops.split(Option::is_none)
        .filter(|part| !part.is_empty())
        .map(|part| part.iter().flatten().copied().collect())
        .collect()
}

/// Where a row is largest; `None` where it is at an end or beside a point without a value.
fn top(x: &GridAxis, row: &[Option<f64>]) -> Option<f64> {
    let found = row.iter().enumerate().filter_map(|(i, value)| Some((i, (*value)?)));
    let (i, largest) = found.max_by(|a, b| a.1.total_cmp(&b.1))?;
    let (before, after) = (i.checked_sub(1)?, i + 1);
    let (low, high) = ((*row.get(before)?)?, (*row.get(after)?)?);
    let [left, middle, right] = [before, i, after].map(|i| x.coordinate(x.values[i]));
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

    fn speeds(count: i32) -> GridAxis {
        let values = (0..count).map(|i| 10_f64.powf(f64::from(i) / 2.0 - 3.0)).collect();
        GridAxis { quantity: "speed", unit: "m/s", values, is_logarithmic: true }
    }

    /// Of a parabola in the logarithm of the speed the ridge is exact wherever it lies between the points.
    #[test]
    fn the_ridge_is_where_a_parabola_is_largest() {
        let x = speeds(8);
        let y =
            GridAxis { quantity: "temperature", unit: "K", values: vec![1.0, 2.0, 3.0, 4.0], is_logarithmic: false };
        let tops: [f64; 4] = [0.013, 0.1, 2e-4, 0.05];
        let at = |x: f64, top: f64| Some(1.0 - 0.1 * (x / top).ln().powi(2));
        let values: Vec<_> = tops.iter().flat_map(|top| x.values.iter().map(|x| at(*x, *top))).collect();
        // The third is beyond the slowest speed.
        let found = ridges(&x, &y, &values);
        assert_eq!(found.iter().map(Vec::len).collect::<Vec<_>>(), [2, 1]);
        let expected = [(0.013, 1.0), (0.1, 2.0), (0.05, 4.0)];
        for (found, expected) in found.concat().iter().zip(expected) {
            assert!((found.0 / expected.0 - 1.0).abs() < 1e-12 && found.1 == expected.1, "{found:?}");
        }
    }

    #[test]
    fn what_may_be_larger_where_nothing_is_known_is_no_ridge() {
        let x = speeds(4);
        assert_eq!(top(&x, &[Some(1.0), Some(2.0), None, Some(0.0)]), None);
        assert_eq!(top(&x, &[Some(1.0), Some(2.0), Some(3.0), Some(4.0)]), None);
        assert_eq!(top(&x, &[None; 4]), None);
        let even = top(&x, &[Some(0.0), Some(1.0), Some(0.0), None]).unwrap();
        assert!((even / x.values[1] - 1.0).abs() < 1e-12, "{even}");
    }
}
