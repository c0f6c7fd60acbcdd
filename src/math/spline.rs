//! Cubic splines: the rigid profile z_r(x) with its slope z_r', curvature z_r'' and z_r''' (5), (9).

mod bounds;
mod grid;
mod solve;
#[cfg(test)]
mod tests;

pub use bounds::Bounds;
use bounds::Extent;
use grid::Grid;

/// A cubic spline through data points: C², and C^∞ between the points.
///
/// *Natural*: z'' = 0 at both ends and continued outside along the end tangents. *Periodic*: repeated for ever.
///
/// ```
/// use asperity::math::Spline;
///
/// let line = Spline::natural(&[0.0, 1.0], &[0.0, 0.5]);
/// assert_eq!(line.evaluate(4.0), (2.0, 0.5, 0.0, 0.0));
/// ```
#[derive(Clone, Debug)]
pub struct Spline {
    pieces: Vec<Piece>,
    grid: Grid,
    ends: Ends,
    inside: Extent,
}

/// What lies outside the data points.
#[derive(Clone, Debug)]
enum Ends {
    Periodic { period: f64 },
    Tangents { left: Piece, right: Piece },
}

/// One interval as a polynomial in t = x - start. Aligned so that a look-up touches one cache line.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
struct Piece {
    start: f64,
    end: f64,
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
        let pieces = pieces(x, z, &solve::natural_curvatures(x, z));
        let (first, last) = (pieces[0], pieces[pieces.len() - 1]);
        let (z_end, slope_end, ..) = last.evaluate(last.end);
        let left = Piece::line(first.start, first.z, first.slope);
        let right = Piece::line(last.end, z_end, slope_end);
        Self::assemble(pieces, Ends::Tangents { left, right })
    }

    /// The periodic spline through the points (x, z), m: as for [`natural`](Self::natural), with the last height equal
    /// to the first. The period is the distance of the last point from the first.
    ///
    /// # Panics
    /// With fewer than two points.
    pub fn periodic(x: &[f64], z: &[f64]) -> Self {
        let pieces = pieces(x, z, &solve::periodic_curvatures(x, z));
        let period = pieces[pieces.len() - 1].end - pieces[0].start;
        Self::assemble(pieces, Ends::Periodic { period })
    }

    fn assemble(pieces: Vec<Piece>, ends: Ends) -> Self {
        let grid = Grid::new(&pieces);
        let inside = pieces.iter().map(|piece| piece.extent(piece.start, piece.end)).fold(Extent::EMPTY, Extent::and);
        Self { pieces, grid, ends, inside }
    }

    /// Height z (m), slope z' (1), curvature z'' (1/m) and z''' (1/m², constant between two points) at `x`.
    ///
    /// At a data point z''' is that of the interval to the right.
    #[inline]
    pub fn evaluate(&self, x: f64) -> (f64, f64, f64, f64) {
        let x = self.reduce(x);
        self.piece_at(x).evaluate(x)
    }

    /// The period, m; `None` for a natural spline.
    pub fn period(&self) -> Option<f64> {
        match self.ends {
            Ends::Periodic { period } => Some(period),
            Ends::Tangents { .. } => None,
        }
    }

    /// The place within the data points where a periodic spline is the same as at `x`; `x` itself for a natural one.
    #[inline]
    pub fn reduce(&self, x: f64) -> f64 {
        match self.ends {
            Ends::Periodic { period } if x < self.first() || x >= self.last() => self.wrap(x, period),
            _ => x,
        }
    }

    /// Rounding may leave the place a digit outside of the period; it is put back, so that far places stay legal too.
    fn wrap(&self, x: f64, period: f64) -> f64 {
        let first = self.first();
        let place = x - period * floor((x - first) / period);
        let place = if place >= self.last() { place - period } else { place };
        // Below the first by a rounding; or so far away that the rounding is more than a period, and any place as
        // right.
        if (first..self.last()).contains(&place) { place } else { first }
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
    #[inline]
    fn piece_at(&self, x: f64) -> &Piece {
        match &self.ends {
            Ends::Tangents { left, .. } if x < self.first() => left,
            Ends::Tangents { right, .. } if x >= self.last() => right,
            _ => &self.pieces[self.grid.interval(&self.pieces, x)],
        }
    }
}

/// `f64::floor`, which on plain x86-64 is a call of the C library's; every mass beyond the first period asks for it.
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
    fn line(start: f64, z: f64, slope: f64) -> Self {
        Self { start, end: start, z, slope, curvature: 0.0, third: 0.0 }
    }

    #[inline]
    fn evaluate(&self, x: f64) -> (f64, f64, f64, f64) {
        let t = x - self.start;
        let z = self.z + t * (self.slope + t * (0.5 * self.curvature + t * (self.third * (1.0 / 6.0))));
        let slope = self.slope + t * (self.curvature + t * (0.5 * self.third));
        (z, slope, self.curvature + t * self.third, self.third)
    }
}

/// The polynomials between the points, from the curvatures at the points.
fn pieces(x: &[f64], z: &[f64], curvatures: &[f64]) -> Vec<Piece> {
    debug_assert!(
        x.len() >= 2 && x.len() == z.len(),
        "a spline needs two points or more, and as many heights as places"
    );
    debug_assert!(x.windows(2).all(|pair| pair[0] < pair[1]), "the places of a spline rise strictly");
    (0..x.len() - 1)
        .map(|i| {
            let h = x[i + 1] - x[i];
            let third = (curvatures[i + 1] - curvatures[i]) / h;
            let slope = (z[i + 1] - z[i]) / h - h * (2.0 * curvatures[i] + curvatures[i + 1]) / 6.0;
            Piece { start: x[i], end: x[i + 1], z: z[i], slope, curvature: curvatures[i], third }
        })
        .collect()
}
