//! Cubic splines: the rigid profile z_r(x) with its slope z_r', curvature z_r'' and z_r''' (5), (9).

mod block;
mod bounds;
mod curvatures;
#[cfg(test)]
mod tests;

pub use block::BLOCK;
pub use bounds::Bounds;
use curvatures::{natural_curvatures, periodic_curvatures};

/// A cubic spline through data points: C², and C^∞ between the points.
///
/// *Natural*: z'' = 0 at both ends and continued outside along the end tangents. *Periodic*: repeated without end.
///
/// ```
/// use asperity::math::Spline;
///
/// let line = Spline::natural(&[0.0, 1.0], &[0.0, 0.5]);
/// assert_eq!(line.evaluate(4.0), (2.0, 0.5, 0.0, 0.0));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Spline {
    pieces: Vec<Piece>,
    grid: IntervalGrid,
    ends: Ends,
    /// The bounds between the data points.
    inside: Bounds,
}

#[derive(Clone, Debug, PartialEq)]
enum Ends {
    Periodic { period: f64 },
    Tangents { left: Piece, right: Piece },
}

/// One interval. Aligned so that a look-up touches one cache line.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(64))]
struct Piece {
    start: f64,
    end: f64,
    cubic: Cubic,
    /// The highest z and the largest |z'| in it.
    z_max: f64,
    slope_max_abs: f64,
}

/// A polynomial in t by its value and derivatives at t = 0.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Cubic {
    z: f64,
    slope: f64,
    curvature: f64,
    third: f64,
}

impl Spline {
    /// The natural spline through the points (x, z), m: `x` finite and strictly rising, `z` finite and as long; two
    /// points give a straight line.
    ///
    /// # Panics
    /// With fewer than two points.
    pub fn natural(x: &[f64], z: &[f64]) -> Self {
        let pieces = pieces(x, z, &natural_curvatures(x, z));
        let (first, last) = (pieces[0], pieces[pieces.len() - 1]);
        let (z_end, slope_end, ..) = last.evaluate(last.end);
        let left = Piece::line(first.start, first.cubic.z, first.cubic.slope);
        let right = Piece::line(last.end, z_end, slope_end);
        Self::assemble(pieces, Ends::Tangents { left, right })
    }

    /// The periodic spline through the points (x, z), m: as for [`natural`](Self::natural), with the last height equal
    /// to the first. The period is the distance of the last point from the first.
    ///
    /// # Panics
    /// With fewer than two points.
    pub fn periodic(x: &[f64], z: &[f64]) -> Self {
        let pieces = pieces(x, z, &periodic_curvatures(x, z));
        let period = pieces[pieces.len() - 1].end - pieces[0].start;
        Self::assemble(pieces, Ends::Periodic { period })
    }

    fn assemble(pieces: Vec<Piece>, ends: Ends) -> Self {
        let grid = IntervalGrid::new(&pieces);
        let inside = Bounds::over(&pieces);
        Self { pieces, grid, ends, inside }
    }

    /// Height z (m), slope z' (1), curvature z'' (1/m) and z''' (1/m², constant between two points) at `x`.
    ///
    /// At a data point z''' is that of the interval to the right.
    // Four numbers returned through memory would cost more than their computation.
    #[inline(always)]
    pub fn evaluate(&self, x: f64) -> (f64, f64, f64, f64) {
        let x = self.reduce(x);
        self.piece_at(x).evaluate(x)
    }

    /// Whether it has a finite curvature everywhere: heights and widths that differ too much overflow.
    pub fn is_finite(&self) -> bool {
        self.pieces.iter().all(|piece| piece.cubic.curvature.is_finite() && piece.cubic.third.is_finite())
    }

    /// The period, m; `None` for a natural spline.
    pub fn period(&self) -> Option<f64> {
        match self.ends {
            Ends::Periodic { period } => Some(period),
            Ends::Tangents { .. } => None,
        }
    }

    /// The largest |x| of its data points, m.
    pub fn reach(&self) -> f64 {
        self.first().abs().max(self.last().abs())
    }

    /// The x within the data points at which a periodic spline is the same as at `x`; `x` itself for a natural one.
    #[inline(always)]
    pub fn reduce(&self, x: f64) -> f64 {
        match self.ends {
            Ends::Periodic { period } if x < self.first() || x >= self.last() => self.wrap(x, period),
            _ => x,
        }
    }

    /// Rounding may leave the result a digit outside of the period; it is put back, so that distant x stay legal too.
    #[inline]
    fn wrap(&self, x: f64, period: f64) -> f64 {
        let next = x - period;
        if (self.first()..self.last()).contains(&next) { next } else { self.wrap_far(x, period) }
    }

    #[cold]
    fn wrap_far(&self, x: f64, period: f64) -> f64 {
        let first = self.first();
        let reduced = x - period * floor((x - first) / period);
        let reduced = if reduced >= self.last() { reduced - period } else { reduced };
        // Below the first by a rounding; or so far away that the rounding exceeds a period, and any result is as right.
        if (first..self.last()).contains(&reduced) { reduced } else { first }
    }

    #[inline]
    fn first(&self) -> f64 {
        self.grid.first
    }

    #[inline]
    fn last(&self) -> f64 {
        self.grid.last
    }

    /// The polynomial that holds at `x`, which is already reduced.
    #[inline(always)]
    fn piece_at(&self, x: f64) -> &Piece {
        match &self.ends {
            Ends::Tangents { left, .. } if x < self.first() => left,
            Ends::Tangents { right, .. } if x >= self.last() => right,
            _ => self.grid.piece(&self.pieces, x),
        }
    }
}

/// As `f64::floor`, which on plain x86-64 is a call into the C library; every mass beyond the first period needs it.
#[inline]
fn floor(x: f64) -> f64 {
    const WHOLE: f64 = (1_u64 << 52) as f64;
    if x.abs() >= WHOLE || x.is_nan() {
        return x;
    }
    let towards_zero = x as i64 as f64;
    if towards_zero > x { towards_zero - 1.0 } else { towards_zero }
}

impl Piece {
    fn new(start: f64, end: f64, cubic: Cubic) -> Self {
        let piece = Self { start, end, cubic, z_max: f64::NAN, slope_max_abs: f64::NAN };
        let Bounds { z_max, slope_max_abs, .. } = piece.extent(start, end);
        Self { z_max, slope_max_abs, ..piece }
    }

    /// The line through the height `z` at `start`, without an end.
    fn line(start: f64, z: f64, slope: f64) -> Self {
        Self::new(start, start, Cubic { z, slope, curvature: 0.0, third: 0.0 })
    }

    #[inline]
    fn evaluate(&self, x: f64) -> (f64, f64, f64, f64) {
        self.cubic.evaluate(x - self.start)
    }
}

impl Cubic {
    #[inline(always)]
    fn evaluate(&self, t: f64) -> (f64, f64, f64, f64) {
        let z = self.z + t * (self.slope + t * (0.5 * self.curvature + t * (self.third * (1.0 / 6.0))));
        let slope = self.slope + t * (self.curvature + t * (0.5 * self.third));
        (z, slope, self.curvature + t * self.third, self.third)
    }
}

/// The polynomials between the points, from the curvatures at the points.
fn pieces(x: &[f64], z: &[f64], curvatures: &[f64]) -> Vec<Piece> {
    debug_assert!(x.len() >= 2 && x.len() == z.len(), "a spline needs two points or more, and as many heights as x");
    debug_assert!(x.windows(2).all(|pair| pair[0] < pair[1]), "the x of a spline rise strictly");
    (0..x.len() - 1)
        .map(|i| {
            let h = x[i + 1] - x[i];
            let third = (curvatures[i + 1] - curvatures[i]) / h;
            let slope = (z[i + 1] - z[i]) / h - h * (2.0 * curvatures[i] + curvatures[i + 1]) / 6.0;
            Piece::new(x[i], x[i + 1], Cubic { z: z[i], slope, curvature: curvatures[i], third })
        })
        .collect()
}

/// Finds the interval of an x without a search: a grid of equal cells over the data points, as many as there are
/// intervals.
#[derive(Clone, Debug, PartialEq)]
struct IntervalGrid {
    first: f64,
    last: f64,
    cells_per_meter: f64,
    last_cell: usize,
    /// For each cell the number of intervals that start in an earlier cell, and at the end the number of all intervals;
    /// empty where the points are spaced evenly enough for a cell to be its interval or a neighbour of it.
    starts_before: Vec<u32>,
}

impl IntervalGrid {
    fn new(pieces: &[Piece]) -> Self {
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
        (((x - self.first) * self.cells_per_meter) as u32 as usize).min(self.last_cell)
    }

    /// Writes the number of the cell of each `x`, or of some cell where `x` is outside.
    #[inline(always)]
    fn cells(&self, x: &[f64], cells: &mut [u32]) {
        let (first, cells_per_meter) = (self.first, self.cells_per_meter);
        for (x, cell) in x.iter().zip(cells) {
            *cell = ((x - first) * cells_per_meter) as i32 as u32;
        }
    }

    /// The polynomial of the interval of `x`: nearly always that of the cell.
    #[inline]
    fn piece<'a>(&self, pieces: &'a [Piece], x: f64) -> &'a Piece {
        let piece = &pieces[self.cell(x)];
        if piece.start <= x && x < piece.end { piece } else { &pieces[self.interval(pieces, x)] }
    }

    /// The interval of `x`, or the nearest one where `x` is outside.
    fn interval(&self, pieces: &[Piece], x: f64) -> usize {
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
