//! A contact in series with a backing: how much of the approach of a face is that of its contact.
//!
//! The approach of the face is that of the contact plus p/k_n. Where the contact is x beyond the start of an interval of
//! its law, in which ln p is a cubic of x and p is p_i at x = 0, the face is d = x + (p(x) - p_i)/k_n beyond its own.
//! That is solved for x, for many elements at once. Below the least pressure of the law p is a parabola and above the
//! largest a straight line: closed forms.

use super::law_points::{Intervals, LOG_PRESSURE, START};
use crate::math::Number;
use crate::scene::Backing;

/// Steps of Halley's method at most. Of an exponential p one takes an error e of ln p to e³/12, and the step of Newton's
/// method that follows squares what is left.
const STEPS: usize = 3;
/// How far from the root the last of them may begin, at most, by Newton's step there, as a share of the interval. Elements that are
/// farther off are solved for one by one: hardly any where p grows fourfold over an interval, one in a hundred where it
/// grows tenfold.
const LAST_STEP: f64 = 1e-3;

/// Steps of Newton's method or halvings: either alone would need fewer.
const MAX_SAFE_STEPS: usize = 100;
/// The last of them, likewise; the step of Newton's method that follows squares it.
const LAST_SAFE_STEP: f64 = 1e-7;

/// Rounding may lead out of an interval by this share of it.
const BEYOND_END: f64 = 1e-2;

/// A backing of a law with given pressures.
#[derive(Clone, Debug)]
pub(super) struct SeriesBacking {
    /// p/k_n at the pressures, m.
    pub(super) indentations: Vec<f64>,
    /// 1/k_t, m/Pa.
    shear_compliance: f64,
}

impl SeriesBacking {
    /// Of a law with these ln p, p in Pa.
    pub(super) fn new(backing: Backing, log_pressures: &[f64]) -> Self {
        let indentations = log_pressures.iter().map(|y| y.exp() / backing.normal).collect();
        Self { indentations, shear_compliance: 1.0 / backing.shear }
    }

    /// The tangential stiffness per area of a contact of stiffness κ and the backing.
    #[inline(always)]
    pub(super) fn in_series<T: Number>(&self, stiffness: T) -> T {
        stiffness / (T::constant(1.0) + stiffness.times(self.shear_compliance))
    }
}

/// The intervals of the law in which elements are, and what the backing adds to them.
#[derive(Clone, Copy, Debug)]
pub(super) struct SeriesIntervals<'a, T, const N: usize> {
    laws: &'a Intervals<T, N>,
    /// p_i/k_n, m.
    indentation: [f64; N],
    /// By how much x grows over them, m: 0 above the largest pressure.
    width: [f64; N],
    /// By how much p/k_n grows over them, m.
    rise: [f64; N],
    /// 1 where they are the first, below which the law goes on as a parabola, else 0.
    is_first: [f64; N],
}

impl<'a, T: Number, const N: usize> SeriesIntervals<'a, T, N> {
    #[inline(always)]
    pub(super) fn new(laws: &'a Intervals<T, N>) -> Self {
        let zero = [0.0; N];
        Self { laws, indentation: zero, width: zero, rise: zero, is_first: zero }
    }

    /// Sets those of element `i`, which is in interval `interval`. `next` is the interval that follows, or the same one if
    /// it is the last; its contact begins at `end` (m).
    #[inline(always)]
    pub(super) fn set(&mut self, i: usize, backing: &SeriesBacking, (interval, next): (usize, usize), end: f64) {
        self.indentation[i] = backing.indentations[interval];
        self.width[i] = end - self.laws.coefficients[START][i].value();
        self.rise[i] = backing.indentations[next] - backing.indentations[interval];
        self.is_first[i] = if interval == 0 { 1.0 } else { 0.0 };
    }

    /// How far the contacts are beyond the starts of their intervals where the approaches of the faces are these, m.
    #[inline(always)]
    pub(super) fn contacts_beyond_start(&self, approaches: &[T; N]) -> [T; N] {
        let (count, mut contacts) = (self.laws.count.min(N), self.laws.beyond_start(approaches));
        // How far the faces are beyond the starts; 0 for elements with a closed form: 0 is then the root.
        let mut target = [0.0; N];
        let mut x = [0.0; N];
        for i in 0..count {
            let d = contacts[i].value() - self.indentation[i];
            target[i] = if d > 0.0 && self.width[i] > 0.0 { d } else { 0.0 };
            x[i] = self.guess(i, target[i]);
        }
        // By how much the last step began too far from the root. Each element takes its own steps: what it comes to does not
        // depend on those beside it.
        let mut excess = [1.0; N];
        for _ in 0..STEPS {
            for i in 0..count {
                let (next, left) = self.halley_step(i, x[i], target[i]);
                (x[i], excess[i]) = if excess[i] > 0.0 { (next, left) } else { (x[i], excess[i]) };
            }
            if excess[..count].iter().fold(0.0, |most: f64, excess| most.larger(*excess)) <= 0.0 {
                break;
            }
        }
        for i in 0..count {
            if excess[i] > 0.0 {
                x[i] = self.solve_safely(i, target[i]);
            }
        }
        for i in 0..count {
            contacts[i] = self.contact_beyond_start(i, x[i], contacts[i]);
        }
        contacts
    }

    /// x at d by the cubic that has the values and slopes of x at both ends of the interval.
    #[inline(always)]
    fn guess(&self, i: usize, d: f64) -> f64 {
        let (width, [before, after]) = (self.width[i], self.slopes_at_ends(i));
        let length = width + self.rise[i];
        let t = if length > 0.0 { d / length } else { 0.0 };
        let rest = 1.0 - t;
        let x = width * t * t * (3.0 - 2.0 * t) + length * t * rest * (rest / before - t / after);
        x.larger(0.0).smaller(width)
    }

    /// dd/dx at both ends of the interval.
    #[inline(always)]
    fn slopes_at_ends(&self, i: usize) -> [f64; 2] {
        let ([a, b, c], width) = (self.values(i), self.width[i]);
        let end = a + width * (2.0 * b + 3.0 * width * c);
        [1.0 + self.indentation[i] * a, 1.0 + (self.indentation[i] + self.rise[i]) * end]
    }

    /// A step of Halley's method for d(x) = `target`, within the interval; and by how much |d - `target`| is more than
    /// the last step may begin with.
    #[inline(always)]
    fn halley_step(&self, i: usize, x: f64, target: f64) -> (f64, f64) {
        let [d, slope, bend] = expansion(self.values(i), x, self.indentation[i]);
        let distance = d - target;
        let next = x - distance * slope / (slope * slope - 0.5 * distance * bend);
        let next = next.larger(0.0).smaller((1.0 + BEYOND_END) * self.width[i]);
        (next, distance.larger(-distance) - LAST_STEP * self.width[i] * slope)
    }

    /// x where d(x) is `target`: by Newton's method, by halves where that would leave the bracket.
    #[cold]
    fn solve_safely(&self, i: usize, target: f64) -> f64 {
        let width = self.width[i];
        let (mut low, mut high) = (0.0, (1.0 + BEYOND_END) * width);
        let mut x = target * width / (width + self.rise[i]);
        for _ in 0..MAX_SAFE_STEPS {
            let [distance, slope, _] = expansion(self.values(i), x, self.indentation[i]);
            if distance < target {
                low = x;
            } else {
                high = x;
            }
            let next = x - (distance - target) / slope;
            let next = if (low..=high).contains(&next) { next } else { 0.5 * (low + high) };
            let step = (next - x).abs();
            x = next;
            if step <= LAST_SAFE_STEP * width {
                break;
            }
        }
        x
    }

    /// How far a contact is beyond the start of its interval where the approach of the face is `approach` beyond that, m,
    /// with its derivatives; `x` is the solution within the interval but for a step of Newton's method.
    #[inline(always)]
    fn contact_beyond_start(&self, i: usize, x: f64, approach: T) -> T {
        let (cubic, indentation) = (LOG_PRESSURE.map(|k| self.laws.coefficients[k][i]), self.indentation[i]);
        let (one, slope) = (T::constant(1.0), cubic[0]);
        let from = approach - T::constant(indentation);
        // Within the interval.
        let [distance, along, _] = expansion(cubic, T::constant(x), indentation);
        let within = T::constant(x) - (distance - from) / along;
        // A straight p above the largest pressure; also over the little by which rounding may lead below an interval.
        let straight = from / (one + slope.times(indentation));
        // p = p_0 r², with r = 1 + x s/2 and the slope s of ln p at p_0: from the touch the face is 2r/s + r² p_0/k_n on.
        let from_touch = approach + T::constant(2.0) / slope;
        let touches = from_touch.value() > 0.0;
        let root = (one + (slope * slope * from_touch).times(indentation)).or(touches, one).sqrt();
        let below = ((slope * from_touch / (one + root) - one).times(2.0) / slope).or(touches, approach);
        let is_below = from.value() < 0.0;
        let others = straight.or(is_below | (self.width[i] <= 0.0), within);
        below.or(is_below & (self.is_first[i] > 0.0), others)
    }

    #[inline(always)]
    fn values(&self, i: usize) -> [f64; 3] {
        LOG_PRESSURE.map(|k| self.laws.coefficients[k][i].value())
    }
}

/// d (m) at x (m) in an interval with this cubic and p_i/k_n (m), dd/dx and d²d/dx² (1/m).
#[inline(always)]
fn expansion<T: Number>([a, b, c]: [T; 3], x: T, indentation: f64) -> [T; 3] {
    let growth = (x * (a + x * (b + x * c))).exp();
    let slope = a + x * (b.times(2.0) + (x * c).times(3.0));
    let bend = slope * slope + b.times(2.0) + (x * c).times(6.0);
    let one = T::constant(1.0);
    [
        x + (growth - one).times(indentation),
        one + (growth * slope).times(indentation),
        (growth * bend).times(indentation),
    ]
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::element::law_points::COEFFICIENTS;
    use crate::math::Dual;

    /// Cubics of ln p over an interval of 1 µm, ln p's growth over it, and p_i/k_n (m): of slopes at both ends from almost
    /// none to the steepest of a monotone cubic, with backings from far stiffer than the contact to far softer.
    fn cases() -> Vec<([f64; 3], f64, f64)> {
        let mut cases = Vec::new();
        for growth in [1e-3, 0.3, 1.4, 4.0, 9.0] {
            for (begin, end) in [0.01, 1.0, 2.9].into_iter().flat_map(|begin| [0.01, 1.0, 2.9].map(|end| (begin, end)))
            {
                let cubic = [1e6 * begin, 1e12 * (3.0 - 2.0 * begin - end), 1e18 * (begin + end - 2.0)];
                let cubic = cubic.map(|power| growth * power);
                cases.extend([1e-6, 0.1, 1.0, 30.0, 1e5].map(|share| (cubic, growth, 1e-6 * share)));
            }
        }
        // Where steps of Halley's method lead away from the root.
        cases.push(([17.034e6, -18.66e12, 7.626e18], 6.0, 12.9e-6));
        cases
    }

    /// The contact of a face that is a fraction of its interval on, for all cases at once.
    fn contacts<T: Number, const N: usize>(cases: &[([f64; 3], f64, f64)], faces: &[T; N]) -> [T; N] {
        let width = 1e-6;
        let mut laws = Intervals::new(N);
        for (i, ([a, b, c], ..)) in cases.iter().enumerate() {
            let mut coefficients = [T::constant(0.0); COEFFICIENTS];
            (coefficients[1], coefficients[2], coefficients[3]) = (T::constant(*a), T::constant(*b), T::constant(*c));
            laws.set(i, coefficients, 0.0, false);
        }
        let mut series = SeriesIntervals::new(&laws);
        for (i, (_, growth, indentation)) in cases.iter().enumerate() {
            let backing =
                SeriesBacking { indentations: vec![*indentation, indentation * growth.exp()], shear_compliance: 0.0 };
            series.set(i, &backing, (0, 1), width);
        }
        series.contacts_beyond_start(faces)
    }

    /// x of the face at x + p_i/k_n (e^y(x) - 1) and beyond, all over the interval; with the derivative of the inverse.
    #[test]
    fn contact_and_backing_make_up_the_approach_of_the_face() {
        let cases: [_; 226] = cases().try_into().unwrap();
        for step in 0..=40 {
            let x = 1e-6 * f64::from(step) / 40.0;
            let solved = cases.map(|(cubic, _, indentation)| expansion(cubic, x, indentation));
            let faces: [f64; 226] = std::array::from_fn(|i| solved[i][0] + cases[i].2);
            let found = contacts(&cases, &faces.map(|face| Dual { value: face, slopes: [1.0] }));
            let plain = contacts(&cases, &faces);
            for i in 0..226 {
                let (cubic, growth, indentation) = cases[i];
                // What rounding of the approach leaves of it, and Halley's method 1e-11 of the interval.
                let (rounding, slope) = (1e-15 * faces[i] / solved[i][1], 1.0 / solved[i][1]);
                assert!((found[i].value - x).abs() <= 8.0 * rounding + 1e-17, "{:?}: {} {x}", cases[i], found[i].value);
                // Of first order in what Halley's method leaves: 4e-6 where ln p is nearly level at one end, else 1e-8.
                let error = (found[i].slopes[0] / slope - 1.0).abs();
                assert!(error < 1e-5, "{cubic:?} {growth} {indentation}: {error:e}");
                // The same bits with derivatives, without and alone.
                assert_eq!(found[i].value, plain[i]);
                assert_eq!(plain[i], contacts(&cases[i..=i], &[faces[i]])[0]);
            }
        }
    }

    /// Below the least pressure, by its closed form: p = p_0 r² where the face is 2r/s + r² p_0/k_n on from the touch.
    #[test]
    fn below_the_least_pressure_it_is_a_parabola() {
        let (slope, indentation) = (3e6, 2e-6);
        let case = [([slope, 0.0, 0.0], 3.0, indentation)];
        for step in 0..20 {
            let root = f64::from(step) / 20.0;
            let from_touch = 2.0 * root / slope + root * root * indentation;
            let [found] = contacts(&case, &[from_touch - 2.0 / slope]);
            assert!((1.0 + 0.5 * slope * found - root).abs() < 1e-14, "{root}");
        }
        // A face that does not touch does not press its backing.
        assert_eq!(contacts(&case, &[-1e-6]), [-1e-6]);
    }
}
