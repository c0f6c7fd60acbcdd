//! Free parameters and their scale.

/// From this ratio of its bounds on the logarithm of a parameter is fitted.
const DECADE: f64 = 10.0;

/// A number of the scene that is fitted, by its key, within bounds.
#[derive(Clone, Debug, PartialEq)]
pub struct FreeParameter {
    /// The path of its key, as in `friction.rate_shear.strength`.
    pub key: String,
    low: f64,
    high: f64,
}

impl FreeParameter {
    /// The parameter of a key within bounds; `None` where these are not finite and in their order.
    pub fn new(key: String, low: f64, high: f64) -> Option<Self> {
        (low.is_finite() && high.is_finite() && low < high).then_some(Self { key, low, high })
    }

    /// The bounds.
    pub fn bounds(&self) -> (f64, f64) {
        (self.low, self.high)
    }

    /// Whether the logarithm is fitted: where the bounds are positive and a decade apart or more.
    pub fn is_logarithmic(&self) -> bool {
        // Of bounds that are a decade apart but for rounding.
        self.low > 0.0 && self.high >= DECADE * self.low * (1.0 - 1e-12)
    }

    /// The value at a place between the bounds, 0 to 1: even in the logarithm or in the value. The ends are the bounds
    /// to the last bit.
    pub fn value(&self, place: f64) -> f64 {
        if place <= 0.0 {
            return self.low;
        }
        if place >= 1.0 {
            return self.high;
        }
        let between = if self.is_logarithmic() {
            (self.low.ln() + place * (self.high / self.low).ln()).exp()
        } else {
            self.low + place * (self.high - self.low)
        };
        between.clamp(self.low, self.high)
    }

    /// The place of a value.
    pub fn place(&self, value: f64) -> f64 {
        if self.is_logarithmic() {
            (value / self.low).ln() / (self.high / self.low).ln()
        } else {
            (value - self.low) / (self.high - self.low)
        }
    }

    /// How much the coordinate of the statistics changes from one bound to the other: the logarithm, or the value over
    /// the distance of the bounds.
    pub fn span(&self) -> f64 {
        if self.is_logarithmic() { (self.high / self.low).ln() } else { 1.0 }
    }

    /// The standard error in the parameter's own unit of one in the coordinate of the statistics, at a value.
    pub fn error_of_value(&self, value: f64, error: f64) -> f64 {
        let error = self.error_of_coordinate(error);
        if self.is_logarithmic() { value * error } else { error }
    }

    /// An error in the coordinate of the statistics as one of the logarithm or, where that is not fitted, of the value.
    pub fn error_of_coordinate(&self, error: f64) -> f64 {
        if self.is_logarithmic() { error } else { (self.high - self.low) * error }
    }

    /// The value that is `by` away from another in the coordinate of the statistics; it may lie beyond the bounds.
    pub fn moved(&self, value: f64, by: f64) -> f64 {
        if self.is_logarithmic() { value * by.exp() } else { value + (self.high - self.low) * by }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_logarithm_is_fitted_from_a_decade_on() {
        let is_logarithmic = |low, high| FreeParameter::new("a".into(), low, high).unwrap().is_logarithmic();
        assert!(is_logarithmic(1e-6, 1e-5) && is_logarithmic(0.3, 40.0));
        assert!(!is_logarithmic(0.1, 0.9) && !is_logarithmic(0.0, 10.0) && !is_logarithmic(-1.0, 1.0));
        for (low, high) in [(1.0, 1.0), (2.0, 1.0), (f64::NAN, 1.0), (0.0, f64::INFINITY)] {
            assert_eq!(FreeParameter::new("a".into(), low, high), None);
        }
    }

    #[test]
    fn a_place_and_its_value_go_back_and_forth() {
        for (low, high) in [(1e-6, 1e-4), (0.2, 0.9), (-3.0, 5.0)] {
            let parameter = FreeParameter::new("a".into(), low, high).unwrap();
            assert_eq!((parameter.value(0.0), parameter.value(1.0)), (low, high));
            for place in [0.1, 0.5, 0.93] {
                assert!((parameter.place(parameter.value(place)) - place).abs() < 1e-14);
            }
            let moved = parameter.moved(parameter.value(0.25), 0.5 * parameter.span());
            assert!((moved / parameter.value(0.75) - 1.0).abs() < 1e-14);
        }
    }
}
