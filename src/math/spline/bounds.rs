//! The extremes of a spline: over all of it, or over a range.

use super::{Ends, Piece, Spline};

/// More intervals than this in a range, and the bounds of all intervals are taken instead.
const INTERVALS_SCANNED: usize = 16;

/// Bounds of a spline over a range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// The highest z, m: no place of the range lies above. Infinite where a natural spline rises outwards for ever.
    pub z_max: f64,
    /// The largest |z'|, 1.
    pub slope_max_abs: f64,
    /// The largest |z''|, 1/m.
    pub curvature_max_abs: f64,
}

/// [`Bounds`] that can be joined, and of nothing at first.
pub(super) type Extent = Bounds;

impl Extent {
    pub(super) const EMPTY: Self = Self { z_max: f64::NEG_INFINITY, slope_max_abs: 0.0, curvature_max_abs: 0.0 };

    /// The bounds over two ranges together.
    pub(super) fn and(self, other: Self) -> Self {
        Self {
            z_max: self.z_max.max(other.z_max),
            slope_max_abs: self.slope_max_abs.max(other.slope_max_abs),
            curvature_max_abs: self.curvature_max_abs.max(other.curvature_max_abs),
        }
    }
}

impl Spline {
    /// The bounds over all x.
    pub fn bounds(&self) -> Bounds {
        match &self.ends {
            Ends::Periodic { .. } => self.inside,
            Ends::Tangents { left, right } if left.slope < 0.0 || right.slope > 0.0 => {
                Bounds { z_max: f64::INFINITY, ..self.inside }
            }
            Ends::Tangents { .. } => self.inside,
        }
    }

    /// Bounds over the range from `x_low` to `x_high`, m: the true extremes over a few intervals, those of all
    /// intervals where the range spans many. `x_low` ≤ `x_high`.
    pub fn local_bounds(&self, x_low: f64, x_high: f64) -> Bounds {
        match &self.ends {
            Ends::Periodic { period } => self.periodic_bounds(x_low, x_high - x_low, *period),
            Ends::Tangents { left, right } => self.natural_bounds(x_low, x_high, left, right),
        }
    }

    fn periodic_bounds(&self, x_low: f64, width: f64, period: f64) -> Bounds {
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

    fn natural_bounds(&self, x_low: f64, x_high: f64, left: &Piece, right: &Piece) -> Bounds {
        let (first, last) = (self.first(), self.last());
        let mut bounds = Bounds::EMPTY;
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
    fn bounds_inside(&self, low: f64, high: f64) -> Bounds {
        let (from, to) = (self.grid.interval(&self.pieces, low), self.grid.interval(&self.pieces, high));
        if to.saturating_sub(from) >= INTERVALS_SCANNED {
            return self.inside;
        }
        let within = |piece: &Piece| piece.extent(low.max(piece.start), high.min(piece.end));
        self.pieces[from..=to.max(from)].iter().map(within).fold(Bounds::EMPTY, Bounds::and)
    }
}

impl Piece {
    /// The extremes of this polynomial from `low` to `high`.
    pub(super) fn extent(&self, low: f64, high: f64) -> Extent {
        let ((z_low, slope_low, curvature_low, _), (z_high, slope_high, curvature_high, _)) =
            (self.evaluate(low), self.evaluate(high));
        let steepest = self.steepest(low, high);
        let mut z_max = z_low.max(z_high);
        for x in self.level(low, high, [slope_low, slope_high, steepest]) {
            z_max = z_max.max(self.evaluate(x).0);
        }
        Extent {
            z_max,
            slope_max_abs: slope_low.abs().max(slope_high.abs()).max(steepest.abs()),
            curvature_max_abs: curvature_low.abs().max(curvature_high.abs()),
        }
    }

    /// The slope where z'' = 0, if that is between `low` and `high`; else 0, which is steeper than nothing.
    fn steepest(&self, low: f64, high: f64) -> f64 {
        let inflection = self.start - self.curvature / self.third;
        if low < inflection && inflection < high { self.evaluate(inflection).1 } else { 0.0 }
    }

    /// The places between `low` and `high` where z' = 0, clamped to the range; none where the slopes there
    /// have one sign.
    fn level(&self, low: f64, high: f64, slopes: [f64; 3]) -> impl Iterator<Item = f64> {
        let one_sign = slopes.iter().all(|&slope| slope >= 0.0) || slopes.iter().all(|&slope| slope <= 0.0);
        let discriminant = self.curvature * self.curvature - 2.0 * self.third * self.slope;
        // Both roots of ½ z''' t² + z'' t + z' = 0 without cancellation.
        let sum = -(self.curvature + discriminant.max(0.0).sqrt().copysign(self.curvature));
        let roots = [sum / self.third, 2.0 * self.slope / sum];
        let real = move |t: &f64| !one_sign && t.is_finite();
        roots.into_iter().filter(real).map(move |t| (self.start + t).clamp(low, high))
    }
}
