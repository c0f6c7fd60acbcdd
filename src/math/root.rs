//! A bracketing root finder.

/// The root of `f` in [`a`, `b`], where `f(a)` and `f(b)` differ in sign or one of them is 0.
///
/// T. R. Chandrupatla's method (Adv. Eng. Software 28, 1997): inverse quadratic interpolation where it is safe, else
/// bisection. The bracket only shrinks, so the result lies in it, whatever `f` is. Stops at a bracket of width
/// `tolerance` or at `f = 0`; the work is bounded.
pub fn bracketed_root(mut f: impl FnMut(f64) -> f64, (a, b): (f64, f64), tolerance: f64) -> f64 {
    let ends = [(a, f(a)), (b, f(b))];
    root_between(f, ends, tolerance)
}

/// The root of `f` in a bracket at whose `ends` it is known, as places and values; see [`bracketed_root`].
pub fn root_between(mut f: impl FnMut(f64) -> f64, ends: [(f64, f64); 2], tolerance: f64) -> f64 {
    let [mut newest, mut other] = ends;
    let chord = newest.1 / (newest.1 - other.1);
    let mut fraction = if (0.0..=1.0).contains(&chord) { chord } else { 0.5 };
    for _ in 0..MAX_STEPS {
        let x = newest.0 + fraction * (other.0 - newest.0);
        let point = (x, f(x));
        let dropped = if (point.1 > 0.0) == (newest.1 > 0.0) { newest } else { std::mem::replace(&mut other, newest) };
        newest = point;
        let best = if newest.1.abs() < other.1.abs() { newest } else { other };
        let resolution = tolerance / (other.0 - newest.0).abs();
        if best.1 == 0.0 || resolution >= 0.5 || resolution.is_nan() {
            return best.0;
        }
        fraction = interpolated_fraction(newest, other, dropped).clamp(resolution, 1.0 - resolution);
    }
    newest.0
}

/// Bisection alone would need some 60 steps from 1 to the last digit; interpolation never more than three times that.
const MAX_STEPS: usize = 180;

/// Where inverse quadratic interpolation through three points puts the root, as a fraction of the interval from a to b;
/// one half where the interpolation cannot be trusted.
fn interpolated_fraction((a, fa): (f64, f64), (b, fb): (f64, f64), (c, fc): (f64, f64)) -> f64 {
    let xi = (a - b) / (c - b);
    let phi = (fa - fb) / (fc - fb);
    if phi * phi < xi && (1.0 - phi) * (1.0 - phi) < 1.0 - xi {
        fa / (fb - fa) * fc / (fb - fc) + (c - a) / (b - a) * fa / (fc - fa) * fb / (fc - fb)
    } else {
        0.5
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_roots_of_known_functions() {
        type Case = (fn(f64) -> f64, (f64, f64), f64);
        let cases: [Case; 4] = [
            (|x| x * x - 2.0, (0.0, 2.0), std::f64::consts::SQRT_2),
            (|x| x.cos(), (3.0, 0.0), std::f64::consts::FRAC_PI_2),
            (|x| (x - 1.0).powi(9), (0.3, 1.9), 1.0),
            (|x| if x < 0.7 { -1.0 } else { 1e-9 }, (0.0, 1.0), 0.7),
        ];
        for (f, bracket, root) in cases {
            assert!((bracketed_root(f, bracket, 1e-12) - root).abs() < 2e-12, "{root}");
        }
    }

    #[test]
    fn takes_a_root_at_either_end() {
        assert_eq!(bracketed_root(|x| x, (0.0, 1.0), 1e-12), 0.0);
        assert_eq!(bracketed_root(|x| 1.0 - x, (0.0, 1.0), 1e-12), 1.0);
    }

    #[test]
    fn known_ends_are_not_evaluated_again() {
        let mut places = Vec::new();
        let f = |x: f64| {
            places.push(x);
            2.0 * x - 1.0
        };
        assert_eq!(root_between(f, [(0.0, -1.0), (2.0, 3.0)], 1e-12), 0.5);
        assert_eq!(places, [0.5]);
    }

    #[test]
    fn needs_few_evaluations_where_the_function_is_smooth() {
        let mut count = 0;
        bracketed_root(
            |x| {
                count += 1;
                x.exp() - 2.0
            },
            (0.0, 4.0),
            1e-13,
        );
        assert!(count <= 15, "{count}");
    }
}
