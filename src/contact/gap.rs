//! The first touch of a free mass within a step.

use crate::math::{Quintic, Spline, SplineBounds};

/// A part over which the gap bends by less than this share of the tolerance is decided by its ends: a deeper dip
/// between them does not matter. So the search ends even where a mass moves along the limit.
const NEGLIGIBLE_BEND: f64 = 0.01;
/// Parts of a step after which a part is also decided by its ends where the gap bends by no more than rounding. Metres
/// away from the origin, the rounding of a position exceeds the tolerance.
const FEW_PARTS: u32 = 200;
/// Rounding errors of a position that a bound on its second derivative may contain: 20 times a second difference.
const ROUNDINGS: f64 = 64.0;
/// Halvings of a step after which a part is decided by its ends: a step over 2⁴⁰ is below the resolution of time.
const MAX_HALVINGS: u32 = 40;

/// Largest number of parts of a step that are examined. A few are usual; where numbers are so large that no bounds
/// hold, the search would not end.
const MAX_PARTS: u32 = 10_000;

/// The first fraction of a step at which the gap between a mass and the profile falls below -`tolerance` (m), located
/// where it is -`tolerance`/2; `None` if it does not. `position` (along x) and `height`
/// are the mass's motion through the step, m. What comes after the fraction `latest` does not matter.
///
/// Nothing is sampled: a part of the step is skipped only if bounds of the motion and of the profile there show that
/// the gap stays above the limit. So no dip is missed, however short. Other parts are halved. Where that would not end,
/// the fraction up to which there is no touch is returned: the step is to be cut there, too.
pub fn first_touch(
    profile: &Spline,
    (position, height): (Quintic, Quintic),
    tolerance: f64,
    latest: f64,
) -> Option<f64> {
    let mut search = GapSearch { profile, tolerance, latest, parts: 0 };
    let whole = StepPart { position, height, start: 0.0, length: 1.0 };
    search.first_touch(&whole, 0)
}

struct GapSearch<'a> {
    profile: &'a Spline,
    tolerance: f64,
    latest: f64,
    parts: u32,
}

/// The motion through a part of the step.
struct StepPart {
    position: Quintic,
    height: Quintic,
    start: f64,
    length: f64,
}

/// The gap over a part, m.
struct GapAtEnds {
    start: f64,
    end: f64,
    /// The largest |g''| with respect to the fraction.
    bend: f64,
}

impl GapSearch<'_> {
    fn first_touch(&mut self, part: &StepPart, halvings: u32) -> Option<f64> {
        if part.start >= self.latest {
            return None;
        }
        self.parts += 1;
        let (x_low, x_high) = part.position.range();
        if self.parts > MAX_PARTS || !(x_low.is_finite() && x_high.is_finite()) {
            return Some(part.start);
        }
        let profile = self.profile.local_bounds(x_low, x_high);
        if part.height.range().0 - profile.z_max > -self.tolerance {
            return None;
        }
        let GapAtEnds { start, end, bend } = self.ends(part, &profile);
        if self.stays_above(start, end, bend) {
            return None;
        }
        let monotone = self.gap_rate(part, 0.5).abs() > 0.5 * bend;
        let negligible = (NEGLIGIBLE_BEND * self.tolerance).max(self.rounding(part, &profile));
        if monotone || bend <= negligible || halvings == MAX_HALVINGS {
            let crosses = start >= -self.tolerance && end < -self.tolerance;
            return (crosses && !self.is_late(part)).then(|| self.locate(part));
        }
        let (first, second) = part.halves();
        self.first_touch(&first, halvings + 1).or_else(|| self.first_touch(&second, halvings + 1))
    }

    /// The gap at the ends of a part, and its largest bend between them with the bounds `profile`.
    fn ends(&self, part: &StepPart, profile: &SplineBounds) -> GapAtEnds {
        // |g''| over the part: g = z - z_r(x), g'' = z̈ - s ẍ - κ ẋ².
        let (speed_x, bend_x) = part.position.derivative_bounds();
        let bend = part.height.derivative_bounds().1
            + profile.slope_max_abs * bend_x
            + profile.curvature_max_abs * speed_x * speed_x;
        let gap = |(x, z): (f64, f64)| z - self.profile.evaluate(x).0;
        let (x, z) = (part.position.ends(), part.height.ends());
        GapAtEnds { start: gap((x.0, z.0)), end: gap((x.1, z.1)), bend }
    }

    /// The part of the bend that rounding of the position can make, m; 0 as long as the search is short.
    fn rounding(&self, part: &StepPart, profile: &SplineBounds) -> f64 {
        if self.parts <= FEW_PARTS {
            return 0.0;
        }
        let (x_low, x_high) = part.position.range();
        ROUNDINGS * f64::EPSILON * x_low.abs().max(x_high.abs()) * profile.slope_max_abs
    }

    /// Whether the gap of a part, which closes through it, is still open at the latest fraction that matters.
    fn is_late(&self, part: &StepPart) -> bool {
        let latest = (self.latest - part.start) / part.length;
        latest < 1.0 && self.gap(part, latest) > -0.5 * self.tolerance
    }

    fn stays_above(&self, start: f64, end: f64, bend: f64) -> bool {
        start.min(end) - bend / 8.0 > -self.tolerance
    }

    fn locate(&self, part: &StepPart) -> f64 {
        let aim = 0.5 * self.tolerance;
        if self.gap(part, 0.0) <= -aim {
            return part.start;
        }
        part.start + part.length * crate::math::bracketed_root(|theta| self.gap(part, theta) + aim, (0.0, 1.0), 1e-15)
    }

    fn gap(&self, part: &StepPart, theta: f64) -> f64 {
        part.height.evaluate(theta).position - self.profile.evaluate(part.position.evaluate(theta).position).0
    }

    fn gap_rate(&self, part: &StepPart, theta: f64) -> f64 {
        let position = part.position.evaluate(theta);
        part.height.evaluate(theta).speed - self.profile.evaluate(position.position).1 * position.speed
    }
}

impl StepPart {
    fn halves(&self) -> (Self, Self) {
        let (position_first, position_second) = self.position.halves();
        let (height_first, height_second) = self.height.halves();
        let length = 0.5 * self.length;
        (
            Self { position: position_first, height: height_first, start: self.start, length },
            Self { position: position_second, height: height_second, start: self.start + length, length },
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Jet;

    fn straight(from: f64, to: f64) -> Quintic {
        let at = |position| Jet { position, speed: to - from, acceleration: 0.0 };
        Quintic::hermite(at(from), at(to), 1.0)
    }

    /// A fall and rise: height h0 at both ends, `depth` lower in the middle.
    fn dip(top: f64, depth: f64) -> Quintic {
        let end = |position, speed| Jet { position, speed, acceleration: 8.0 * depth };
        Quintic::hermite(end(top, -4.0 * depth), end(top, 4.0 * depth), 1.0)
    }

    #[test]
    fn finds_the_root_of_a_known_fall() {
        let flat = Spline::natural(&[0.0, 1.0], &[0.0, 0.0]);
        let theta = first_touch(&flat, (straight(0.0, 0.5), straight(0.3, -0.7)), 1e-12, 1.0).unwrap();
        // Located half a tolerance below the surface.
        assert!((theta - 0.3).abs() < 1e-12, "{theta}");
    }

    /// A dip a thousandth of the step long and 1e-9 m deep: the mass enters and leaves again within the step.
    #[test]
    fn finds_a_dip_a_thousandth_of_the_step_long() {
        let flat = Spline::natural(&[0.0, 1.0], &[0.0, 0.0]);
        // A parabola whose part below 0 is a thousandth of the step: depth_below = depth (1/1000)².
        let depth = 1e-9 * 1e6;
        let motion = dip(depth - 1e-9, depth);
        let theta = first_touch(&flat, (straight(0.0, 0.5), motion), 1e-12, 1.0).unwrap();
        assert!((theta - 0.4995).abs() < 1e-6, "{theta}");
        assert_eq!(first_touch(&flat, (straight(0.0, 0.5), dip(depth + 1e-9, depth)), 1e-12, 1.0), None);
    }

    /// The profile as the dip: a spike a thousandth of the way wide that reaches 1e-9 m into the mass's straight path.
    #[test]
    fn finds_a_spike_a_thousandth_of_the_way_wide() {
        // Level but for the spike: the points beside it keep the spline from swinging.
        let x = [0.0, 0.4975, 0.498, 0.4985, 0.499, 0.4995, 0.5, 0.5005, 0.501, 0.5015, 0.502, 0.5025, 1.0];
        let z = x.map(|x| if x == 0.5 { 1e-6 } else { 0.0 });
        let profile = Spline::periodic(&x, &z);
        let top = profile.local_bounds(0.499, 0.501).z_max;
        let over = |height: f64| first_touch(&profile, (straight(0.0, 1.0), straight(height, height)), 1e-12, 1.0);
        let theta = over(top - 1e-9).unwrap();
        assert!((0.4995..0.5).contains(&theta), "{theta}");
        assert_eq!(over(top + 1e-9), None);
    }

    /// A mass that glides along the very limit does not keep the search busy.
    #[test]
    fn a_mass_may_glide_along_the_limit() {
        let flat = Spline::natural(&[0.0, 1.0], &[0.0, 0.0]);
        let gliding = dip(-1e-12 + 1e-16, 1e-16);
        assert_eq!(first_touch(&flat, (straight(0.0, 0.5), gliding), 1e-12, 1.0), None);
    }

    /// Over a million waves the first one is found; where no bounds hold, the search ends where it got to.
    #[test]
    fn a_search_ends_however_far_the_mass_goes() {
        let wave = Spline::periodic(&[0.0, 1e-4, 2e-4], &[0.0, 1e-6, 0.0]);
        let over = |far: f64| first_touch(&wave, (straight(0.0, far), straight(0.5e-6, 0.5e-6)), 1e-12, 1.0);
        let theta = over(2e2).unwrap();
        assert!((2e-7..3e-7).contains(&theta), "{theta}");
        let known = over(f64::MAX).unwrap();
        assert!(known < 1e-6, "{known}");
    }

    /// Metres away from the origin, where the rounding of a position exceeds the tolerance, the search still ends.
    #[test]
    fn a_mass_may_glide_far_away() {
        let wave = Spline::periodic(&[0.0, 1e-4, 2e-4], &[0.0, 1e-6, 0.0]);
        let at = |x: f64, dx: f64| Jet { position: x, speed: dx, acceleration: 0.0 };
        for i in 0..100 {
            let (x, dx) = (50.0 + 1.7e-6 * f64::from(i), 1e-8);
            let (z, slope, ..) = wave.evaluate(x);
            let (end, end_slope, ..) = wave.evaluate(x + dx);
            let position = Quintic::hermite(at(x, dx), at(x + dx, dx), 1.0);
            let height = Quintic::hermite(at(z - 1e-14, slope * dx), at(end - 1e-14, end_slope * dx), 1.0);
            let mut search = GapSearch { profile: &wave, tolerance: 3e-16, latest: 1.0, parts: 0 };
            search.first_touch(&StepPart { position, height, start: 0.0, length: 1.0 }, 0);
            assert!(search.parts < 2 * FEW_PARTS, "{} parts at {x}", search.parts);
        }
    }

    #[test]
    fn a_mass_that_leaves_the_surface_does_not_touch() {
        let flat = Spline::natural(&[0.0, 1.0], &[0.0, 0.0]);
        // A lift: the gap opens with the third power of time.
        let still = Jet::default();
        let lifted = Jet { position: 1e-9, speed: 3e-9, acceleration: 6e-9 };
        assert_eq!(first_touch(&flat, (straight(0.0, 0.1), Quintic::hermite(still, lifted, 1.0)), 1e-13, 1.0), None);
    }
}
