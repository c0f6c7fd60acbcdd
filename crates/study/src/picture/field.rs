//! A field on a grid of uneven lines: its values between them, and the lines along which it has one value.

use std::collections::BTreeMap;

/// Values at the crossings of lines, some of them missing; between these it is bilinear.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct GridField {
    /// Where the lines are, rising.
    x: Vec<f64>,
    y: Vec<f64>,
    /// Rows along x, from the lowest y on.
    values: Vec<Option<f64>>,
}

/// Points of a line, in their order along it; of a closed one the first is also the last.
pub(crate) type Line = Vec<(f64, f64)>;

/// An edge between two neighbours: of which point it goes out, and whether along y.
type Edge = (usize, bool);

/// A part of a line within a cell, from one of its edges to another one.
type Part = [(Edge, (f64, f64)); 2];

impl GridField {
    /// The field of `values`, rows along `x` from the lowest `y` on.
    pub(crate) fn new(x: Vec<f64>, y: Vec<f64>, values: Vec<Option<f64>>) -> Self {
        Self { x, y, values }
    }

    fn value(&self, i: usize, j: usize) -> Option<f64> {
        self.values.get(j * self.x.len() + i).copied().flatten()
    }

    /// The value at a place. Within a cell without one of its corners it is linear on the half of the others; there is
    /// none on the other half, in a cell without two, and beyond the grid.
    pub(crate) fn at(&self, x: f64, y: f64) -> Option<f64> {
        let ((i, s), (j, t)) = (within(&self.x, x)?, within(&self.y, y)?);
        let corners = [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(di, dj)| self.value(i + di, j + dj));
        match corners {
            [Some(a), Some(b), Some(c), Some(d)] => {
                Some((1.0 - t) * ((1.0 - s) * a + s * b) + t * ((1.0 - s) * c + s * d))
            }
            [Some(a), Some(b), Some(c), None] => linear([a, b, c], s, t),
            [Some(a), Some(b), None, Some(d)] => linear([b, a, d], 1.0 - s, t),
            [Some(a), None, Some(c), Some(d)] => linear([c, d, a], s, 1.0 - t),
            [None, Some(b), Some(c), Some(d)] => linear([d, c, b], 1.0 - s, 1.0 - t),
            _ => None,
        }
    }

    /// The values at the middles of so many columns and rows, from the lowest row on.
    pub(crate) fn sampled(&self, columns: usize, rows: usize) -> Vec<Option<f64>> {
        let middle = |i: usize, count: usize| (i as f64 + 0.5) / count as f64;
        (0..rows).flat_map(|j| (0..columns).map(move |i| self.at(middle(i, columns), middle(j, rows)))).collect()
    }

    /// The same field on a grid with `by` cells for each along either axis.
    pub(crate) fn refined(&self, by: usize) -> Self {
        let [x, y] = [&self.x, &self.y].map(|lines| {
            let between = lines.windows(2).flat_map(|pair| {
                (0..by).map(move |part| pair[0] + (pair[1] - pair[0]) * part as f64 / by as f64).collect::<Vec<_>>()
            });
            between.chain(lines.last().copied()).collect::<Vec<f64>>()
        });
        let values = y.iter().flat_map(|&y| x.iter().map(move |&x| self.at(x, y))).collect();
        Self { x, y, values }
    }

    /// The lines on which the field has the value `level`, by marching squares: straight within each cell, and between
    /// the two pairs of a saddle on the side of the bilinear field.
    pub(crate) fn contours(&self, level: f64) -> Vec<Line> {
        let (nx, ny) = (self.x.len(), self.y.len());
        let cells = (0..ny.saturating_sub(1)).flat_map(|j| (0..nx.saturating_sub(1)).map(move |i| (i, j)));
        joined(cells.flat_map(|(i, j)| self.parts(level, i, j)).collect())
    }

    /// The parts of the lines of a level in the cell above and to the right of a point.
    fn parts(&self, level: f64, i: usize, j: usize) -> Vec<Part> {
        let corners = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)].map(|(i, j)| self.value(i, j));
        let [Some(a), Some(b), Some(c), Some(d)] = corners else { return Vec::new() };
        let nx = self.x.len();
        // Around the cell: below, on the right, above, on the left.
        let edges: [Edge; 4] =
            [(j * nx + i, false), (j * nx + i + 1, true), ((j + 1) * nx + i, false), (j * nx + i, true)];
        let ([left, right], [low, high]) = ([self.x[i], self.x[i + 1]], [self.y[j], self.y[j + 1]]);
        let between = |from: f64, to: f64, of: [f64; 2]| of[0] + (of[1] - of[0]) * (level - from) / (to - from);
        let crossing = |edge: usize| {
            let place = match edge {
                0 => (between(a, b, [left, right]), low),
                1 => (right, between(b, c, [low, high])),
                2 => (between(d, c, [left, right]), high),
                _ => (left, between(a, d, [low, high])),
            };
            (edges[edge], place)
        };
        let is_above = [a, b, c, d].map(|value| value >= level);
        let crossed: Vec<usize> = (0..4).filter(|&edge| is_above[edge] != is_above[(edge + 1) % 4]).collect();
        match crossed[..] {
            [one, other] => vec![[crossing(one), crossing(other)]],
            [_, _, _, _] => {
                // The bilinear field's value at its saddle joins the corners that are as high or low as it.
                let joins_first = ((a * c - b * d) / (a - b + c - d) >= level) == is_above[0];
                let pairs = if joins_first { [[0, 1], [2, 3]] } else { [[3, 0], [1, 2]] };
                pairs.map(|pair| pair.map(crossing)).to_vec()
            }
            _ => Vec::new(),
        }
    }
}

/// The cell of an axis that a place is in, and how far it is through it.
fn within(lines: &[f64], place: f64) -> Option<(usize, f64)> {
    let (first, last) = (*lines.first()?, *lines.last()?);
    if !(first..=last).contains(&place) || lines.len() < 2 {
        return None;
    }
    let cell = lines.partition_point(|line| *line <= place).clamp(1, lines.len() - 1) - 1;
    Some((cell, (place - lines[cell]) / (lines[cell + 1] - lines[cell])))
}

/// The value within a triangle of three corners, the second and third of which are a step along s and t off the first.
fn linear([corner, along_s, along_t]: [f64; 3], s: f64, t: f64) -> Option<f64> {
    /// A place on the triangle's long side but for rounding is in it.
    const ROUNDING: f64 = 1e-12;
    (s + t <= 1.0 + ROUNDING).then_some(corner + s * (along_s - corner) + t * (along_t - corner))
}

/// Joins the parts of lines where they meet.
fn joined(parts: Vec<Part>) -> Vec<Line> {
    let mut at: BTreeMap<Edge, Vec<usize>> = BTreeMap::new();
    for (index, part) in parts.iter().enumerate() {
        part.iter().for_each(|(edge, _)| at.entry(*edge).or_default().push(index));
    }
    let is_end = |edge: &Edge| at.get(edge).is_some_and(|parts| parts.len() == 1);
    // Open lines from their ends on, then what is left, which is closed.
    let (open, closed): (Vec<usize>, Vec<usize>) =
        (0..parts.len()).partition(|&index| parts[index].iter().any(|(edge, _)| is_end(edge)));
    let mut is_used = vec![false; parts.len()];
    let mut lines = Vec::new();
    for first in open.into_iter().chain(closed) {
        if is_used[first] {
            continue;
        }
        let [start, other] = parts[first];
        let (start, mut next) = if is_end(&other.0) && !is_end(&start.0) { (other, start) } else { (start, other) };
        is_used[first] = true;
        let mut line = vec![start.1, next.1];
        while let Some(&part) = at.get(&next.0).and_then(|parts| parts.iter().find(|&&part| !is_used[part])) {
            is_used[part] = true;
            let [one, other] = parts[part];
            next = if one.0 == next.0 { other } else { one };
            line.push(next.1);
        }
        lines.push(line);
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The field of a formula on even lines from -1 to 1.
    fn field(count: usize, formula: impl Fn(f64, f64) -> f64) -> GridField {
        let lines: Vec<f64> = (0..count).map(|i| -1.0 + 2.0 * i as f64 / (count - 1) as f64).collect();
        let values = lines.iter().flat_map(|&y| lines.iter().map(move |&x| (x, y))).map(|(x, y)| Some(formula(x, y)));
        let values = values.collect();
        GridField::new(lines.clone(), lines, values)
    }

    fn length(line: &Line) -> f64 {
        line.windows(2).map(|ends| (ends[1].0 - ends[0].0).hypot(ends[1].1 - ends[0].1)).sum()
    }

    /// x² + y² = 0.49: one closed line, whose points are off by h²/8 of the second derivative over the slope at most,
    /// and which is as long as the circle but for the square of the spacing.
    #[test]
    fn the_contour_of_a_paraboloid_is_a_circle() {
        let h: f64 = 2.0 / 40.0;
        let lines = field(41, |x, y| x * x + y * y).contours(0.49);
        let [circle] = &lines[..] else { panic!("{} lines", lines.len()) };
        assert_eq!(circle.first(), circle.last());
        let off = circle.iter().map(|point| (point.0.hypot(point.1) - 0.7).abs()).fold(0.0, f64::max);
        assert!(off <= 2.0 * h * h / 8.0 * 2.0 / 1.4 * 2.0, "{off}");
        assert!((length(circle) / (0.7 * std::f64::consts::TAU) - 1.0).abs() < h * h, "{}", length(circle));
    }

    /// Of a plane, whatever the grid, the line is exact and goes from edge to edge.
    #[test]
    fn the_contour_of_a_plane_is_straight() {
        let (x, y) = (vec![0.0, 0.1, 0.7, 1.0], vec![-2.0, 0.0, 0.5]);
        let values = y.iter().flat_map(|y| x.iter().map(move |x| Some(3.0 * x + y))).collect();
        let lines = GridField::new(x, y, values).contours(1.0);
        let [line] = &lines[..] else { panic!("{lines:?}") };
        assert!(line.iter().all(|(x, y)| (3.0 * x + y - 1.0).abs() < 1e-12), "{line:?}");
        let (top, bottom) = (0.5 / 3.0, 1.0);
        assert!((length(line) - f64::hypot(bottom - top, 2.5)).abs() < 1e-12, "{line:?}");
    }

    /// x y in one cell: its saddle is at 0, so that levels above it part the corners below it from those above, and the
    /// refined field follows the hyperbola.
    #[test]
    fn a_saddle_is_joined_as_the_bilinear_field_is() {
        let cell = field(2, |x, y| x * y);
        for level in [0.25, -0.25] {
            let lines = cell.contours(level);
            assert_eq!(lines.len(), 2);
            let sign = level.signum();
            assert!(lines.iter().all(|line| line[0].0 * line[1].1 * sign > 0.0 || line[0].1 * line[1].0 * sign > 0.0));
            for line in cell.refined(32).contours(level) {
                assert!(line.iter().all(|(x, y)| (x * y - level).abs() < 1e-2 && x * y * sign > 0.0), "{line:?}");
            }
        }
    }

    #[test]
    fn there_is_nothing_where_values_are_missing() {
        let mut missing = field(5, |x, _| x);
        // The corner at the upper right: the half of its cell that is next to it is empty.
        missing.values[24] = None;
        assert_eq!(missing.at(0.9, 0.9), None);
        let [below, on] = [(0.6, 0.7), (0.5, 1.0)].map(|(x, y)| missing.at(x, y).unwrap());
        assert!((below - 0.6).abs() < 1e-12 && (on - 0.5).abs() < 1e-12);
        assert_eq!((missing.at(1.1, 0.0), missing.at(0.0, -1.1)), (None, None));
        let lines = missing.refined(8).contours(0.9);
        let [line] = &lines[..] else { panic!("{lines:?}") };
        let top = line.iter().map(|point| point.1).fold(f64::MIN, f64::max);
        assert!(top < 0.65 && top > 0.45, "{top}");
        assert!(field(3, |_, _| 1.0).contours(0.5).is_empty());
    }
}
