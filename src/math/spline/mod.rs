//! Cubic splines: the rigid profile z_r(x) with its slope z_r', curvature z_r'' and z_r''' (5), (9).

use std::hint::select_unpredictable;

#[cfg(test)]
mod tests;

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
    inside: SplineBounds,
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
        let inside = SplineBounds::over(&pieces);
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
        let SplineBounds { z_max, slope_max_abs, .. } = piece.extent(start, end);
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

// The curvatures M_i = z''(x_i) that make a spline C²: with h_i = x_{i+1} - x_i, μ_i = h_{i-1}/(h_{i-1} + h_i),
// λ_i = 1 - μ_i and the second divided difference of the heights,
//
//     μ_i M_{i-1} + 2 M_i + λ_i M_{i+1} = 6 z[x_{i-1}, x_i, x_{i+1}]
//
// (Stoer & Bulirsch, Introduction to Numerical Analysis, 2.4.2). The equations are diagonally dominant: no pivoting.

/// One equation of a tridiagonal system with `N` right sides.
#[derive(Clone, Copy, Debug)]
struct Equation<const N: usize> {
    lower: f64,
    diagonal: f64,
    upper: f64,
    right: [f64; N],
}

/// The curvatures at the points of a natural spline: 0 at both ends.
fn natural_curvatures(x: &[f64], z: &[f64]) -> Vec<f64> {
    let inner = (1..x.len() - 1).map(|i| equation(x[i] - x[i - 1], x[i + 1] - x[i], z[i] - z[i - 1], z[i + 1] - z[i]));
    let mut curvatures = Vec::with_capacity(x.len());
    curvatures.push(0.0);
    curvatures.extend(solve_tridiagonal(inner).into_iter().flatten());
    curvatures.push(0.0);
    curvatures
}

/// The curvatures at the points of a periodic spline: the last equal to the first.
fn periodic_curvatures(x: &[f64], z: &[f64]) -> Vec<f64> {
    let intervals = x.len() - 1;
    let before = |i: usize| if i == 0 { intervals - 1 } else { i - 1 };
    let width = |i: usize| x[i + 1] - x[i];
    let rise = |i: usize| z[i + 1] - z[i];
    let row = |i: usize| equation(width(before(i)), width(i), rise(before(i)), rise(i));
    // With fewer than three unknowns the entries that wrap around the matrix fall onto others.
    match intervals {
        // One interval from a height to the same height: flat.
        0 | 1 => vec![0.0; intervals + 1],
        // lower + upper = 1 and the right sides are opposite: 2 M_0 + M_1 = r, M_0 + 2 M_1 = -r.
        2 => {
            let [right] = row(0).right;
            vec![right, -right, right]
        }
        _ => solve_cyclic(intervals, row),
    }
}

fn equation(h_left: f64, h_right: f64, rise_left: f64, rise_right: f64) -> Equation<1> {
    let span = h_left + h_right;
    let right = 6.0 * (rise_right / h_right - rise_left / h_left) / span;
    Equation { lower: h_left / span, diagonal: 2.0, upper: h_right / span, right: [right] }
}

/// Gauss's elimination of a tridiagonal system.
fn solve_tridiagonal<const N: usize>(rows: impl ExactSizeIterator<Item = Equation<N>>) -> Vec<[f64; N]> {
    let mut uppers = Vec::with_capacity(rows.len());
    let mut solution = Vec::with_capacity(rows.len());
    let (mut upper_before, mut before) = (0.0, [0.0; N]);
    for row in rows {
        let pivot = row.diagonal - row.lower * upper_before;
        upper_before = row.upper / pivot;
        before = std::array::from_fn(|k| (row.right[k] - row.lower * before[k]) / pivot);
        uppers.push(upper_before);
        solution.push(before);
    }
    for i in (1..solution.len()).rev() {
        let behind = solution[i];
        (0..N).for_each(|k| solution[i - 1][k] -= uppers[i - 1] * behind[k]);
    }
    solution
}

/// The curvatures from the `n` ≥ 3 equations of a periodic spline; the first row's `lower` and the last row's `upper`
/// wrap around the matrix.
///
/// Sherman and Morrison: the cyclic matrix is a tridiagonal one plus the dyad (γ, 0, …, α)ᵀ (1, 0, …, β/γ).
fn solve_cyclic(n: usize, row: impl Fn(usize) -> Equation<1>) -> Vec<f64> {
    let (first, last) = (row(0), row(n - 1));
    let (alpha, beta, gamma) = (last.upper, first.lower, -first.diagonal);
    let with_dyad = |i: usize| {
        let Equation { lower, diagonal, upper, right: [right] } = row(i);
        let (diagonal, dyad) = match i {
            0 => (diagonal - gamma, gamma),
            _ if i == n - 1 => (diagonal - alpha * beta / gamma, alpha),
            _ => (diagonal, 0.0),
        };
        Equation { lower, diagonal, upper, right: [right, dyad] }
    };
    let solution = solve_tridiagonal((0..n).map(with_dyad));
    let along = |k: usize| solution[0][k] + beta / gamma * solution[n - 1][k];
    let factor = along(0) / (1.0 + along(1));
    let mut curvatures: Vec<f64> =
        solution.into_iter().map(|[plain, correction]| plain - factor * correction).collect();
    // The point behind the last interval is the first one again.
    curvatures.push(curvatures[0]);
    curvatures
}

/// The most places at once.
pub const BLOCK: usize = 16;

impl Spline {
    /// Writes z, z', z'' and z''' at each of up to [`BLOCK`] places `x` (m) to as many `values`: those of
    /// [`evaluate`](Self::evaluate), to the last bit. For use with [vector
    /// instructions](crate::math::with_widest_vectors).
    #[inline(always)]
    pub fn evaluate_block<P>(&self, x: &[f64], values: &mut [P])
    where
        P: Copy + From<[f64; 4]> + Into<[f64; 4]>,
    {
        let (mut near, mut cells) = ([0.0; BLOCK], [0; BLOCK]);
        self.reduce_near(x, &mut near);
        self.grid.cells(&near, &mut cells[..x.len()]);
        let places = x.iter().zip(near.iter_mut().zip(&cells));
        for ((x, (t, cell)), value) in places.zip(&mut *values) {
            let piece = match self.pieces.get(*cell as usize) {
                Some(piece) if piece.start <= *t && *t < piece.end => piece,
                _ => {
                    *t = self.reduce(*x);
                    self.piece_at_any(*t)
                }
            };
            let Cubic { z, slope, curvature, third } = piece.cubic;
            *value = [z, slope, curvature, third].into();
            *t -= piece.start;
        }
        evaluate_pieces(&near[..x.len()], values);
    }

    /// [Reduces](Self::reduce) each `x` that is less than a period behind the last point.
    #[inline(always)]
    fn reduce_near(&self, x: &[f64], reduced: &mut [f64]) {
        let period = if let Ends::Periodic { period } = self.ends { period } else { 0.0 };
        let last = self.last();
        for (x, reduced) in x.iter().zip(reduced) {
            *reduced = select_unpredictable(*x < last, *x, x - period);
        }
    }

    /// [`piece_at`](Self::piece_at), out of the way of the usual place.
    #[inline(never)]
    fn piece_at_any(&self, x: f64) -> &Piece {
        self.piece_at(x)
    }
}

/// Puts the values at the distances `t` from the start of the intervals in the place of the coefficients there.
#[inline(always)]
fn evaluate_pieces<P>(t: &[f64], values: &mut [P])
where
    P: Copy + From<[f64; 4]> + Into<[f64; 4]>,
{
    for (t, value) in t.iter().zip(values) {
        let [z, slope, curvature, third] = (*value).into();
        let (z, slope, curvature, third) = Cubic { z, slope, curvature, third }.evaluate(*t);
        *value = [z, slope, curvature, third].into();
    }
}

/// More intervals than this in a range, and the bounds of all intervals are taken instead.
const INTERVALS_SCANNED: usize = 16;

/// Bounds of a spline over a range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SplineBounds {
    /// The highest z, m. Infinite where a natural spline rises outwards without end.
    pub z_max: f64,
    /// The largest |z'|, 1.
    pub slope_max_abs: f64,
    /// The largest |z''|, 1/m.
    pub curvature_max_abs: f64,
}

impl SplineBounds {
    const EMPTY: Self = Self { z_max: f64::NEG_INFINITY, slope_max_abs: 0.0, curvature_max_abs: 0.0 };

    /// The bounds over all these intervals together.
    fn over(pieces: &[Piece]) -> Self {
        pieces.iter().fold(Self::EMPTY, |all, piece| all.and(piece.bounds()))
    }

    /// The bounds over two ranges together.
    fn and(self, other: Self) -> Self {
        Self {
            z_max: self.z_max.max(other.z_max),
            slope_max_abs: self.slope_max_abs.max(other.slope_max_abs),
            curvature_max_abs: self.curvature_max_abs.max(other.curvature_max_abs),
        }
    }
}

impl Spline {
    /// The bounds over all x.
    pub fn bounds(&self) -> SplineBounds {
        match &self.ends {
            Ends::Periodic { .. } => self.inside,
            Ends::Tangents { left, right } if left.cubic.slope < 0.0 || right.cubic.slope > 0.0 => {
                SplineBounds { z_max: f64::INFINITY, ..self.inside }
            }
            Ends::Tangents { .. } => self.inside,
        }
    }

    /// The highest z over all of the intervals that the range from `x_low` to `x_high` (m) meets: nearly free, and no
    /// lower than that of the [`local_bounds`](Self::local_bounds). The highest of all where the range spans many
    /// intervals or the end of a period.
    pub fn top_near(&self, x_low: f64, x_high: f64) -> f64 {
        let low = self.reduce(x_low);
        let high = low + (x_high - x_low);
        if !(low >= self.first() && high < self.last()) {
            return self.bounds().z_max;
        }
        let (from, to) = (self.grid.interval(&self.pieces, low), self.grid.interval(&self.pieces, high));
        match self.pieces.get(from..=to) {
            Some(pieces) if pieces.len() <= INTERVALS_SCANNED => {
                pieces.iter().fold(f64::NEG_INFINITY, |top, piece| top.max(piece.z_max))
            }
            _ => self.bounds().z_max,
        }
    }

    /// Bounds over the range from `x_low` to `x_high`, m: the true extremes over a few intervals, those of all
    /// intervals where the range spans many. `x_low` ≤ `x_high`.
    pub fn local_bounds(&self, x_low: f64, x_high: f64) -> SplineBounds {
        match &self.ends {
            Ends::Periodic { period } => self.periodic_bounds(x_low, x_high - x_low, *period),
            Ends::Tangents { left, right } => self.natural_bounds(x_low, x_high, left, right),
        }
    }

    fn periodic_bounds(&self, x_low: f64, width: f64, period: f64) -> SplineBounds {
        if width.is_nan() || width >= period {
            return self.inside;
        }
        let low = self.reduce(x_low);
        let beyond = low + width - self.last();
        if beyond > 0.0 {
            self.bounds_inside(low, self.last()).and(self.bounds_inside(self.first(), self.first() + beyond))
        } else {
            self.bounds_inside(low, low + width)
        }
    }

    fn natural_bounds(&self, x_low: f64, x_high: f64, left: &Piece, right: &Piece) -> SplineBounds {
        let (first, last) = (self.first(), self.last());
        let mut bounds = SplineBounds::EMPTY;
        if x_low < first {
            bounds = bounds.and(left.extent(x_low, x_high.min(first)));
        }
        if x_high > last {
            bounds = bounds.and(right.extent(x_low.max(last), x_high));
        }
        if x_low <= last && x_high >= first {
            bounds = bounds.and(self.bounds_inside(x_low.max(first), x_high.min(last)));
        }
        bounds
    }

    /// Bounds over a range within the data points.
    fn bounds_inside(&self, low: f64, high: f64) -> SplineBounds {
        let (from, to) = (self.grid.interval(&self.pieces, low), self.grid.interval(&self.pieces, high));
        if to.saturating_sub(from) >= INTERVALS_SCANNED {
            return self.inside;
        }
        let within = |piece: &Piece| piece.extent(low.max(piece.start), high.min(piece.end));
        let ends = within(&self.pieces[from]).and(within(&self.pieces[to.max(from)]));
        ends.and(SplineBounds::over(self.pieces.get(from + 1..to).unwrap_or_default()))
    }
}

impl Piece {
    /// The bounds over the interval.
    fn bounds(&self) -> SplineBounds {
        let Self { start, end, cubic, z_max, slope_max_abs } = *self;
        let curvature_max_abs = cubic.curvature.abs().max((cubic.curvature + (end - start) * cubic.third).abs());
        SplineBounds { z_max, slope_max_abs, curvature_max_abs }
    }

    /// The extremes of this polynomial from `low` to `high`.
    fn extent(&self, low: f64, high: f64) -> SplineBounds {
        let ((z_low, slope_low, curvature_low, _), (z_high, slope_high, curvature_high, _)) =
            (self.evaluate(low), self.evaluate(high));
        let steepest = self.steepest(low, high);
        let mut z_max = z_low.max(z_high);
        for x in self.level(low, high, [slope_low, slope_high, steepest]) {
            z_max = z_max.max(self.evaluate(x).0);
        }
        SplineBounds {
            z_max,
            slope_max_abs: slope_low.abs().max(slope_high.abs()).max(steepest.abs()),
            curvature_max_abs: curvature_low.abs().max(curvature_high.abs()),
        }
    }

    /// The slope where z'' = 0, if that is between `low` and `high`; else 0.
    fn steepest(&self, low: f64, high: f64) -> f64 {
        let inflection = self.start - self.cubic.curvature / self.cubic.third;
        if low < inflection && inflection < high { self.evaluate(inflection).1 } else { 0.0 }
    }

    /// The x between `low` and `high` where z' = 0, clamped to the range; none where the slopes there have one sign.
    fn level(&self, low: f64, high: f64, slopes: [f64; 3]) -> impl Iterator<Item = f64> {
        let one_sign = slopes.iter().all(|&slope| slope >= 0.0) || slopes.iter().all(|&slope| slope <= 0.0);
        let roots = if one_sign { [f64::NAN; 2] } else { self.slope_roots() };
        roots.into_iter().filter(|t| t.is_finite()).map(move |t| (self.start + t).clamp(low, high))
    }

    /// Both roots of ½ z''' t² + z'' t + z' = 0, without cancellation; not finite where there are fewer.
    fn slope_roots(&self) -> [f64; 2] {
        let Cubic { slope, curvature, third, .. } = self.cubic;
        let discriminant = curvature * curvature - 2.0 * third * slope;
        let sum = -(curvature + discriminant.max(0.0).sqrt().copysign(curvature));
        [sum / third, 2.0 * slope / sum]
    }
}
