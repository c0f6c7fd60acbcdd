//! Monotone interpolation: it rises where its data rise and falls where they fall.
//!
//! Between two neighbouring points lies the cubic with given slopes at both. The slopes are those of F. N. Fritsch and
//! J. Butland (SIAM J. Sci. Stat. Comput. 5, 1984): a harmonic mean of the two secants, 0 where these differ in sign,
//! so that the cubics are monotone wherever the data are and never leave the range of their two points (F. N. Fritsch
//! and R. E. Carlson, SIAM J. Numer. Anal. 17, 1980). On smooth monotone data with even steps h the error is O(h³).

/// The slopes at the points (`x`, `y`), `x` strictly rising; one point alone has none.
pub fn monotone_slopes(x: &[f64], y: &[f64], slopes: &mut [f64]) {
    let last = x.len().saturating_sub(1);
    let secant = |i: usize| (y[i + 1] - y[i]) / (x[i + 1] - x[i]);
    for (i, slope) in slopes.iter_mut().enumerate() {
        *slope = match (i, last) {
            (_, 0) => 0.0,
            (_, 1) => secant(0),
            (0, _) => end_slope(x[1] - x[0], x[2] - x[1], secant(0), secant(1)),
            (i, last) if i == last => {
                let (near, far) = (last - 1, last - 2);
                end_slope(x[last] - x[near], x[near] - x[far], secant(near), secant(far))
            }
            (i, _) => inner_slope(x[i] - x[i - 1], x[i + 1] - x[i], secant(i - 1), secant(i)),
        };
    }
}

/// The harmonic mean of the secants d0 and d1 of two intervals of widths h0 and h1; the secant of the narrower interval
/// weighs more (Fritsch and Butland's (5)).
fn inner_slope(h0: f64, h1: f64, d0: f64, d1: f64) -> f64 {
    if d0 * d1 <= 0.0 {
        return 0.0;
    }
    let (w0, w1) = (2.0 * h1 + h0, h1 + 2.0 * h0);
    (w0 + w1) / (w0 / d0 + w1 / d1)
}

/// The slope of the parabola through the last three points, limited so that the cubic stays monotone; h0 and d0 are
/// those of the interval at the end.
fn end_slope(h0: f64, h1: f64, d0: f64, d1: f64) -> f64 {
    let slope = ((2.0 * h0 + h1) * d0 - h0 * d1) / (h0 + h1);
    if slope * d0 <= 0.0 {
        0.0
    } else if d0 * d1 < 0.0 && slope.abs() > 3.0 * d0.abs() {
        3.0 * d0
    } else {
        slope
    }
}

/// A function's value and first two derivatives at one x.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Expansion {
    /// f
    pub value: f64,
    /// f'
    pub slope: f64,
    /// f''
    pub curvature: f64,
}

impl Expansion {
    /// A constant.
    pub fn constant(value: f64) -> Self {
        Self { value, ..Self::default() }
    }

    /// f g
    pub fn times(self, g: Self) -> Self {
        Self {
            value: self.value * g.value,
            slope: self.slope * g.value + self.value * g.slope,
            curvature: self.curvature * g.value + 2.0 * self.slope * g.slope + self.value * g.curvature,
        }
    }

    /// f(g), where this one is f at the value of g.
    pub fn compose(self, g: Self) -> Self {
        Self {
            value: self.value,
            slope: self.slope * g.slope,
            curvature: self.curvature * g.slope * g.slope + self.slope * g.curvature,
        }
    }

    /// exp f
    pub fn exp(self) -> Self {
        let value = self.value.exp();
        Self { value, slope: value, curvature: value }.compose(self)
    }
}

/// The interval of `x`, strictly rising, that `at` lies in: the first or the last where it lies outside.
pub fn interval_of(x: &[f64], at: f64) -> usize {
    x.partition_point(|&x| x <= at).clamp(1, x.len().max(2) - 1) - 1
}

/// The cubic in interval `i` of the points (`x`, `y`) with these `slopes`, at `at`.
pub fn cubic(x: &[f64], y: &[f64], slopes: &[f64], i: usize, at: f64) -> Expansion {
    let (x0, y0, d0) = (x[i], y[i], slopes[i]);
    let (x1, y1, d1) = (x[i + 1], y[i + 1], slopes[i + 1]);
    let h = x1 - x0;
    let secant = (y1 - y0) / h;
    let (quadratic, cubic) = ((3.0 * secant - 2.0 * d0 - d1) / h, (d0 + d1 - 2.0 * secant) / (h * h));
    let t = at - x0;
    // From the nearer end: at the points the value is theirs to the last bit.
    let value = if 2.0 * t <= h {
        y0 + t * (d0 + t * (quadratic + t * cubic))
    } else {
        let (t, end) = (at - x1, (3.0 * secant - 2.0 * d1 - d0) / h);
        y1 + t * (d1 + t * (-end + t * cubic))
    };
    Expansion {
        value,
        slope: d0 + t * (2.0 * quadratic + 3.0 * t * cubic),
        curvature: 2.0 * quadratic + 6.0 * t * cubic,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn interpolate(x: &[f64], y: &[f64], at: f64) -> Expansion {
        let mut slopes = vec![0.0; x.len()];
        monotone_slopes(x, y, &mut slopes);
        let i = interval_of(x, at);
        cubic(x, y, &slopes, i, at)
    }

    #[test]
    fn the_points_are_met_to_the_last_bit() {
        let (x, y) = ([0.1, 0.7, 0.9, 3.3, 3.4], [2.0, -1.0, -1.0, 0.3, 77.7]);
        for (x_i, y_i) in x.iter().zip(y) {
            assert_eq!(interpolate(&x, &y, *x_i).value, y_i);
        }
    }

    /// Data that rise, some steeply, some not at all: between two points the interpolant rises from one to the other.
    #[test]
    fn monotone_data_give_a_monotone_interpolant() {
        let x = [0.0, 1.0, 1.1, 4.0, 5.0, 5.5, 9.0];
        let y = [0.0, 1e-3, 7.0, 7.0, 7.1, 90.0, 90.5];
        let mut before = f64::NEG_INFINITY;
        for i in 0..=90_000 {
            let at = 1e-4 * f64::from(i);
            let found = interpolate(&x, &y, at);
            let here = interval_of(&x, at);
            // Rounding of values up to 90.
            assert!(found.value >= before - 3e-14 && found.slope > -1e-10, "{at}: {found:?}");
            assert!((y[here]..=y[here + 1]).contains(&(found.value.clamp(y[here], y[here + 1]))));
            before = found.value;
        }
    }

    #[test]
    fn the_turning_points_of_data_are_those_of_the_interpolant() {
        let (x, y) = ([0.0, 1.0, 2.0, 3.0], [0.0, 1.0, 1.0, -2.0]);
        assert!((0..=300).all(|i| interpolate(&x, &y, 0.01 * f64::from(i)).value <= 1.0));
    }

    /// Halving the steps divides the error by 8, on data of one turn by more than 4.
    #[test]
    fn the_order_on_smooth_data_is_three() {
        let error = |n: usize, f: fn(f64) -> f64| {
            let x: Vec<f64> = (0..=n).map(|i| i as f64 / n as f64).collect();
            let y: Vec<f64> = x.iter().map(|&x| f(x)).collect();
            (0..=1000).fold(0.0_f64, |most, i| {
                let at = f64::from(i) / 1000.0;
                most.max((interpolate(&x, &y, at).value - f(at)).abs())
            })
        };
        let order = |f: fn(f64) -> f64| (error(40, f) / error(80, f)).log2();
        assert!(order(f64::exp) > 2.7, "{}", order(f64::exp));
        assert!(order(|x| -(x - 0.513).powi(2)) > 1.8, "{}", order(|x| -(x - 0.513).powi(2)));
    }

    #[test]
    fn derivatives_are_those_of_difference_quotients() {
        let (x, y) = ([0.0, 1.0, 2.5], [1.0, 1.3, 4.0]);
        let h = 1e-5;
        for at in [0.2, 0.8, 1.3, 2.2] {
            let f = |by: f64| interpolate(&x, &y, at + by * h).exp();
            let (slope, curvature) =
                ((f(1.0).value - f(-1.0).value) / (2.0 * h), (f(1.0).slope - f(-1.0).slope) / (2.0 * h));
            // h² times a third derivative of some hundred, and rounding over h.
            assert!((f(0.0).slope - slope).abs() < 1e-7 && (f(0.0).curvature - curvature).abs() < 1e-6);
        }
    }
}
