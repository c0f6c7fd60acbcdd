//! Finding a place's interval without a search: a grid of equal cells over the data points.

use super::Piece;

/// As many equal cells as there are intervals.
#[derive(Clone, Debug)]
pub(super) struct Grid {
    pub(super) first: f64,
    pub(super) last: f64,
    cells_per_meter: f64,
    last_cell: usize,
    /// For each cell the number of intervals that start in an earlier cell, and at the end the number of all intervals;
    /// empty where the points are spaced evenly enough for a cell to be its interval or a neighbour of it.
    pub(super) starts_before: Vec<u32>,
}

impl Grid {
    pub(super) fn new(pieces: &[Piece]) -> Self {
        let (first, last) = (pieces[0].start, pieces[pieces.len() - 1].end);
        let cells_per_meter = pieces.len() as f64 / (last - first);
        let mut grid = Self { first, last, cells_per_meter, last_cell: pieces.len() - 1, starts_before: Vec::new() };
        if !grid.is_even(pieces) {
            grid.starts_before = grid.count_starts(pieces);
        }
        grid
    }

    fn is_even(&self, pieces: &[Piece]) -> bool {
        let off_grid = |i: usize| ((pieces[i].start - self.first) * self.cells_per_meter - i as f64).abs();
        (0..pieces.len()).all(|i| off_grid(i) < 0.25)
    }

    fn count_starts(&self, pieces: &[Piece]) -> Vec<u32> {
        let mut counts = vec![0; pieces.len() + 1];
        pieces.iter().for_each(|piece| counts[self.cell(piece.start) + 1] += 1);
        (1..counts.len()).for_each(|cell| counts[cell] += counts[cell - 1]);
        counts
    }

    /// Rises with `x` even in rounded arithmetic, which is why counting starts by cells is exact.
    #[inline]
    fn cell(&self, x: f64) -> usize {
        (((x - self.first) * self.cells_per_meter) as usize).min(self.last_cell)
    }

    /// The interval of `x`, or the nearest one where `x` is outside.
    #[inline]
    pub(super) fn interval(&self, pieces: &[Piece], x: f64) -> usize {
        let cell = self.cell(x);
        if self.starts_before.is_empty() { self.neighbour(pieces, cell, x) } else { self.search(pieces, cell, x) }
    }

    #[inline]
    fn neighbour(&self, pieces: &[Piece], cell: usize, x: f64) -> usize {
        if x < pieces[cell].start {
            cell.saturating_sub(1)
        } else if x >= pieces[cell].end {
            (cell + 1).min(self.last_cell)
        } else {
            cell
        }
    }

    /// The last interval that starts at or before `x`: one of those that start in the cell, or the last before it.
    #[inline]
    fn search(&self, pieces: &[Piece], cell: usize, x: f64) -> usize {
        let (from, to) = (self.starts_before[cell] as usize, self.starts_before[cell + 1] as usize);
        let started = pieces[from..to].partition_point(|piece| piece.start <= x);
        (from + started).saturating_sub(1)
    }
}
