//! The law of many elements at once, each in its interval of the pressure.
//!
//! In structure of arrays, and in loops over the elements one after the other: each then runs in vectors, where one loop
//! over all would not.

use crate::math::Number;

/// The law of an element, of numbers or of numbers with their derivatives.
#[derive(Clone, Copy, Debug)]
pub struct ElementLaw<T> {
    /// p, Pa.
    pub pressure: T,
    /// Friction coefficient, 1.
    pub friction: T,
    /// Tangential stiffness per area, N/m³.
    pub stiffness: T,
}

/// The law of elements, per unit area, of numbers or of numbers with their derivatives.
#[derive(Clone, Copy, Debug)]
pub struct LawPoints<T, const N: usize> {
    /// ln p limited to the pressures of the table, p in Pa.
    pub log_pressure: [T; N],
    /// What e to that power is multiplied with: other than 1 beyond the pressures of the table, 0 without contact.
    pub factor: [T; N],
    /// Friction coefficient, 1.
    pub friction: [T; N],
    /// Tangential stiffness per area, N/m³.
    pub stiffness: [T; N],
}

/// How many coefficients the law has in an interval of the pressure.
pub(super) const COEFFICIENTS: usize = 12;
/// The place among them of the approach where the interval begins, m.
pub(super) const START: usize = 0;
/// Those of ln p over the approach from there: of x, x² and x³. Above the last pressure: the slope, and zeros.
pub(super) const LOG_PRESSURE: [usize; 3] = [1, 2, 3];
/// The first of four of μ over t, which ln p has grown by from there: of 1, t, t² and t³. Above the last pressure a constant.
pub(super) const FRICTION: usize = 4;
/// The first of four of κ, likewise.
pub(super) const STIFFNESS: usize = 8;

/// The intervals of the pressure in which elements are, and the law there at the elements' speeds.
#[derive(Clone, Copy, Debug)]
pub(super) struct Intervals<T, const N: usize> {
    /// How many of the N there are.
    pub(super) count: usize,
    /// The law in the interval: [`START`], [`LOG_PRESSURE`], [`FRICTION`] and [`STIFFNESS`].
    pub(super) coefficients: [[T; N]; COEFFICIENTS],
    /// ln p where it begins.
    log_pressure: [f64; N],
    /// 1 above the last pressure, else 0: vectors hold no flags.
    is_last: [f64; N],
}

impl<T: Number, const N: usize> Intervals<T, N> {
    #[inline(always)]
    pub(super) fn new(count: usize) -> Self {
        let coefficients = [[T::constant(0.0); N]; COEFFICIENTS];
        Self { count: count.min(N), coefficients, log_pressure: [0.0; N], is_last: [0.0; N] }
    }

    /// Puts element `i` into an interval.
    #[inline(always)]
    pub(super) fn set(&mut self, i: usize, coefficients: [T; COEFFICIENTS], log_pressure: f64, is_last: bool) {
        for k in 0..COEFFICIENTS {
            self.coefficients[k][i] = coefficients[k];
        }
        (self.log_pressure[i], self.is_last[i]) = (log_pressure, if is_last { 1.0 } else { 0.0 });
    }

    /// How far approaches are beyond the starts of the intervals, m.
    #[inline(always)]
    pub(super) fn beyond_start(&self, approaches: &[T; N]) -> [T; N] {
        let mut beyond = *approaches;
        for i in 0..self.count {
            beyond[i] = approaches[i] - self.coefficients[START][i];
        }
        beyond
    }

    /// The law of contacts that are `beyond` the starts of their intervals, m.
    #[inline(always)]
    pub(super) fn points(&self, beyond: &[T; N]) -> LawPoints<T, N> {
        let c = &self.coefficients;
        let [slope, square, cube] = LOG_PRESSURE;
        let (zero, one) = (T::constant(0.0), T::constant(1.0));
        let mut points =
            LawPoints { log_pressure: [zero; N], factor: [zero; N], friction: [zero; N], stiffness: [zero; N] };
        for i in 0..self.count {
            let x = beyond[i];
            let (is_above, is_below) = (self.is_last[i] > 0.0, x.value() < 0.0);
            // Below the least pressure p_0 of the table p is root² p_0; likewise over the little by which rounding may
            // lead below the start of an interval.
            let root = (one + (x * c[slope][i]).times(0.5)).larger(zero);
            let parabola = root * root;
            let t = (x * (c[slope][i] + x * (c[square][i] + x * c[cube][i]))).or(!is_above & !is_below, zero);
            // The cubic whose coefficients begin at place k.
            let along = |k: usize| c[k][i] + t * (c[k + 1][i] + t * (c[k + 2][i] + t * c[k + 3][i]));
            points.log_pressure[i] = T::constant(self.log_pressure[i]) + t;
            points.factor[i] = (one + x * c[slope][i]).or(is_above, parabola.or(is_below, one));
            points.friction[i] = along(FRICTION);
            points.stiffness[i] = along(STIFFNESS) * parabola.or(is_below & !is_above, one);
        }
        points
    }
}
