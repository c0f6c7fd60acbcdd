//! Bounds of a spline over ranges of x: for searches that may miss nothing.

use super::{Cubic, Ends, Piece, Spline};

/// More intervals than this in a range, and the bounds of all intervals are taken instead.
const INTERVALS_SCANNED: usize = 16;

/// Bounds of a spline over a range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// The highest z, m. Infinite where a natural spline rises outwards without end.
    pub z_max: f64,
    /// The largest |z'|, 1.
    pub slope_max_abs: f64,
    /// The largest |z''|, 1/m.
    pub curvature_max_abs: f64,
}

impl Bounds {
    const EMPTY: Self = Self { z_max: f64::NEG_INFINITY, slope_max_abs: 0.0, curvature_max_abs: 0.0 };

    /// The bounds over all these intervals together.
    pub(super) fn over(pieces: &[Piece]) -> Self {
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
    pub fn bounds(&self) -> Bounds {
        match &self.ends {
            Ends::Periodic { .. } => self.inside,
            Ends::Tangents { left, right } if left.cubic.slope < 0.0 || right.cubic.slope > 0.0 => {
                Bounds { z_max: f64::INFINITY, ..self.inside }
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
        let ends = within(&self.pieces[from]).and(within(&self.pieces[to.max(from)]));
        ends.and(Bounds::over(self.pieces.get(from + 1..to).unwrap_or_default()))
    }
}

impl Piece {
    /// The bounds over the interval.
    fn bounds(&self) -> Bounds {
        let Self { start, end, cubic, z_max, slope_max_abs } = *self;
        let curvature_max_abs = cubic.curvature.abs().max((cubic.curvature + (end - start) * cubic.third).abs());
        Bounds { z_max, slope_max_abs, curvature_max_abs }
    }

    /// The extremes of this polynomial from `low` to `high`.
    pub(super) fn extent(&self, low: f64, high: f64) -> Bounds {
        let ((z_low, slope_low, curvature_low, _), (z_high, slope_high, curvature_high, _)) =
            (self.evaluate(low), self.evaluate(high));
        let steepest = self.steepest(low, high);
        let mut z_max = z_low.max(z_high);
        for x in self.level(low, high, [slope_low, slope_high, steepest]) {
            z_max = z_max.max(self.evaluate(x).0);
        }
        Bounds {
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
