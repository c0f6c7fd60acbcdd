//! The difference of two files, column by column: where it is largest, in words and as a panel.

use super::selection::{Plot, PlotError, Selection};
use crate::terminal::{LabelledLine, labelled};
use asperity_study::decimals::{decimal, rounded};
use asperity_study::picture::{Axis, Fit, Mark, Panel, ys};

/// The second of two files less the first, at the rows of the first.
#[derive(Debug)]
pub(super) struct Comparison {
    /// The names of both files.
    names: [String; 2],
    x: Column,
    pairing: Pairing,
    /// Of columns, those first that differ most.
    differences: Vec<Difference>,
}

/// A column and its unit.
#[derive(Clone, Debug)]
struct Column {
    name: String,
    unit: String,
}

#[derive(Debug)]
struct Difference {
    column: Column,
    /// The horizontal axis and the difference.
    points: Vec<(f64, f64)>,
    /// The least and the largest value in the first file.
    range: (f64, f64),
}

/// Which rows belong together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Pairing {
    RowByRow,
    /// The horizontal axis increases in both files: rows of the second lie on straight lines between its own.
    Interpolated,
}

/// Columns that are named in words; the others differ by less.
const NAMED: usize = 12;
/// What rows of the same place may lie apart, as a share of the whole: numbers that were written and read.
const ROUNDING: f64 = 1e-9;

impl Comparison {
    /// Compares the `columns`, or all columns of numbers that both files have.
    pub(super) fn new(command: &Plot, files: &[Selection<'_>], names: [String; 2]) -> Result<Self, PlotError> {
        let [first, second] = files else { return Err(PlotError::NotTwo { found: files.len() }) };
        let x = Column { name: command.x.clone(), unit: first.unit(&command.x)? };
        let places = [first.numbers(&x.name)?, second.numbers(&x.name)?];
        let pairing = Pairing::of(&places).ok_or_else(|| PlotError::NotPaired { x: x.name.clone() })?;
        let sign = if command.negate { -1.0 } else { 1.0 };
        let difference = |name: &str| -> Result<Difference, PlotError> {
            let [own, other] = [first.numbers(name)?, second.numbers(name)?];
            let at = |row: usize| pairing.value(row, &places, &other);
            let difference = |row: usize| Some((places[0][row], sign * (at(row)? - own[row])));
            Ok(Difference {
                column: Column { name: name.to_owned(), unit: first.unit(name)? },
                points: (0..own.len()).filter_map(difference).filter(|point| point.1.is_finite()).collect(),
                range: own
                    .iter()
                    .filter(|value| value.is_finite())
                    .fold((f64::MAX, f64::MIN), |(low, high), value| (low.min(*value), high.max(*value))),
            })
        };
        let mut differences = match &command.y[..] {
            [] => first.columns().filter(|name| *name != x.name).filter_map(|name| difference(name).ok()).collect(),
            columns => columns.iter().map(|name| difference(name)).collect::<Result<Vec<_>, _>>()?,
        };
        differences.retain(|difference| !difference.points.is_empty());
        differences.sort_by(|a, b| b.share().total_cmp(&a.share()));
        if differences.is_empty() {
            return Err(PlotError::NothingInCommon { names, x: x.name });
        }
        Ok(Self { names, x, pairing, differences })
    }

    /// The column that differs most.
    pub(super) fn worst(&self) -> &str {
        &self.differences[0].column.name
    }

    /// The differences of some columns, which have the same unit, over the axis of their curves.
    pub(super) fn panel(&self, columns: &[&str], x: &Axis) -> Panel {
        let find = |name: &&str| self.differences.iter().find(|difference| difference.column.name == *name);
        let shown: Vec<&Difference> = columns.iter().filter_map(find).collect();
        let curve = |(look, difference): (usize, &Difference)| {
            let name = difference.column.name.clone();
            let [of_one, of_several] = ["largest".to_owned(), format!("largest of {name}")];
            let largest = if columns.len() > 1 { of_several } else { of_one };
            let points = difference.points.iter().map(|&(x, value)| [x, value]).collect();
            let (place, value) = difference.largest();
            [
                Mark::line(format!("difference of {name}"), look, points),
                Mark::rings(largest, look, vec![[place, value]]),
            ]
        };
        let unit = shown.first().map_or("", |difference| &difference.column.unit);
        let marks: Vec<Mark> = shown.iter().copied().enumerate().flat_map(curve).collect();
        let quantity = format!("{} less {}", self.names[1], self.names[0]);
        let y = Axis::linear((&quantity, unit), ys(&marks), Fit::Round);
        Panel::new(x.clone(), y, marks)
    }

    /// What was compared, and where and by how much columns differ.
    pub(super) fn text(&self) -> Vec<LabelledLine> {
        let [first, second] = &self.names;
        let how = match self.pairing {
            Pairing::RowByRow => "row by row".to_owned(),
            Pairing::Interpolated => format!("at the rows of {first}, {second} straight between its own"),
        };
        let mut rows = vec![("Compared", format!("{second} less {first} over {}, {how}", self.x.name))];
        let (differing, alike): (Vec<_>, Vec<_>) =
            self.differences.iter().partition(|difference| difference.largest().1 != 0.0);
        let mut texts: Vec<String> =
            differing.iter().take(NAMED).map(|difference| difference.text(&self.x, first)).collect();
        texts
            .extend((differing.len() > NAMED).then(|| format!("and {} more columns by less", differing.len() - NAMED)));
        texts.extend((!alike.is_empty()).then(|| format!("{} columns are the same to the last digit", alike.len())));
        rows.extend(labelled("Largest", texts));
        rows
    }
}

impl Difference {
    /// Where the difference is largest; of several such places the first.
    fn largest(&self) -> (f64, f64) {
        self.points.iter().fold((f64::NAN, 0.0), |largest: (f64, f64), &point| {
            if largest.0.is_nan() || point.1.abs() > largest.1.abs() { point } else { largest }
        })
    }

    /// The largest difference over the range of values; of a constant over its value.
    fn share(&self) -> f64 {
        let (low, high) = self.range;
        let whole = if high > low { high - low } else { low.abs() };
        match self.largest().1.abs() {
            0.0 => 0.0,
            largest => largest / whole,
        }
    }

    fn text(&self, x: &Column, first: &str) -> String {
        let number = |value: f64| decimal(rounded(value, 4), 1e-3..1e6);
        let quantity = |value: f64, unit: &str| format!("{} {unit}", number(value)).trim_end().to_owned();
        let ((place, largest), (low, high)) = (self.largest(), self.range);
        let Column { name, unit } = &self.column;
        let of = match high > low {
            true => format!("its range in {first}, {} to {}", number(low), quantity(high, unit)),
            false => format!("its value in {first}, {}", quantity(low, unit)),
        };
        format!(
            "{name}: {} at {} = {}, {} % of {of}",
            quantity(largest, unit),
            x.name,
            quantity(place, &x.unit),
            rounded(100.0 * self.share(), 3)
        )
    }
}

impl Pairing {
    /// How the rows at two lists of places belong together; `None` where that is not clear.
    fn of([first, second]: &[Vec<f64>; 2]) -> Option<Self> {
        let whole = first.iter().fold(0.0, |largest: f64, place| largest.max(place.abs()));
        let is_same = |(a, b): (&f64, &f64)| (a - b).abs() <= ROUNDING * whole;
        let increases = |places: &[f64]| places.windows(2).all(|pair| pair[0] < pair[1]);
        if first.len() == second.len() && first.iter().zip(second).all(is_same) {
            Some(Self::RowByRow)
        } else {
            (increases(first) && increases(second)).then_some(Self::Interpolated)
        }
    }

    /// What the second file has at a row of the first; `None` beyond its ends.
    fn value(self, row: usize, [first, second]: &[Vec<f64>; 2], values: &[f64]) -> Option<f64> {
        if self == Self::RowByRow {
            return Some(values[row]);
        }
        let place = first[row];
        let after = second.partition_point(|other| *other < place);
        match (after.checked_sub(1), second.get(after)) {
            (_, Some(at)) if *at == place => Some(values[after]),
            (Some(before), Some(at)) => {
                let part = (place - second[before]) / (at - second[before]);
                Some(values[before] + part * (values[after] - values[before]))
            }
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_belong_together_by_their_places() {
        let pairing = |first: &[f64], second: &[f64]| Pairing::of(&[first.to_vec(), second.to_vec()]);
        // A path to and fro has to be the same one.
        assert_eq!(pairing(&[0.0, 1.0, 0.0], &[0.0, 1.0 + 1e-12, 0.0]), Some(Pairing::RowByRow));
        assert_eq!(pairing(&[0.0, 1.0, 0.0], &[0.0, 0.9, 0.0]), None);
        assert_eq!(pairing(&[0.0, 1.0], &[0.0, 0.5, 2.0]), Some(Pairing::Interpolated));
        let (places, values) = ([vec![0.0, 1.0, 2.0, 3.0], vec![1.0, 3.0]], [10.0, 30.0]);
        let found: Vec<_> = (0..4).map(|row| Pairing::Interpolated.value(row, &places, &values)).collect();
        assert_eq!(found, [None, Some(10.0), Some(20.0), Some(30.0)]);
    }

    #[test]
    fn the_largest_difference_is_said_with_its_place_and_its_share() {
        let column = |name: &str, unit: &str| Column { name: name.into(), unit: unit.into() };
        let points = vec![(0.0, 0.1), (0.5, -0.25), (1.0, 0.25)];
        let difference = Difference { column: column("F_x", "N"), points, range: (-4.0, 1.0) };
        assert_eq!(
            difference.text(&column("time", "s"), "a"),
            "F_x: -0.25 N at time = 0.5 s, 5 % of its range in a, -4 to 1 N"
        );
        let constant = Difference { range: (5.0, 5.0), ..difference };
        assert!(constant.text(&column("speed", "m/s"), "a").ends_with("= 0.5 m/s, 5 % of its value in a, 5 N"));
    }
}
