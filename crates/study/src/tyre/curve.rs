//! Force over slip as a curve: its peak, and its stiffness at zero slip.

/// Force over slip at a load, by rising slip.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ForceCurve(Vec<(f64, f64)>);

/// The sign of the slips of one side of a curve: driving or braking, left or right.
pub(super) type Side = f64;

/// Both sides.
const SIDES: [Side; 2] = [1.0, -1.0];
/// Slips nearer to zero than this are none.
pub(super) const NO_SLIP: f64 = 1e-9;
/// Rows of a side, zero slip among them: those of the cubic whose slope is the stiffness.
const ROWS: usize = 4;
/// A curve that rises by less than this part of it over its last step has come to its plateau.
const PLATEAU: f64 = 1e-3;

impl ForceCurve {
    /// The curve of points (slip, force), in any order.
    pub(super) fn new(mut points: Vec<(f64, f64)>) -> Self {
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        Self(points)
    }

    /// The sides that have slips enough for a peak and a stiffness.
    pub(super) fn sides(&self) -> impl Iterator<Item = Side> {
        SIDES.into_iter().filter(|&side| self.side(side).len() >= ROWS)
    }

    /// Whether it has a side.
    pub(super) fn has(&self, side: Side) -> bool {
        self.sides().any(|other| other == side)
    }

    /// Sizes of slips and forces on a side, from zero slip on; none without zero slip.
    fn side(&self, side: Side) -> Vec<(f64, f64)> {
        let sized = |&(slip, force): &(f64, f64)| (side * slip, force);
        let mut points: Vec<(f64, f64)> = self.0.iter().map(sized).filter(|(slip, _)| *slip > -NO_SLIP).collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        if points.first().is_none_or(|(slip, _)| *slip > NO_SLIP) { Vec::new() } else { points }
    }

    /// The largest size of the force on a side, on the parabola through the three points about it; `None` where the force
    /// still rises at the last slip.
    pub(super) fn peak(&self, side: Side) -> Option<f64> {
        let points: Vec<(f64, f64)> = self.side(side).into_iter().map(|(slip, force)| (slip, force.abs())).collect();
        let last = points.len().checked_sub(1)?;
        let at = (0..=last).max_by(|&a, &b| points[a].1.total_cmp(&points[b].1)).filter(|&at| at > 0)?;
        let (x, y) = points[at];
        if at == last {
            return (y - points[at - 1].1 < PLATEAU * y).then_some(y);
        }
        let [before, behind] = [at - 1, at + 1].map(|other| (points[other].0 - x, points[other].1 - y));
        // y + b (s - x) + a (s - x)² through all three.
        let a = (before.1 / before.0 - behind.1 / behind.0) / (before.0 - behind.0);
        let b = before.1 / before.0 - a * before.0;
        Some(if a < 0.0 { y - b * b / (4.0 * a) } else { y })
    }

    /// The size of the force's slope at zero slip, of the cubic through the first four points of a side: a brush's curve under a
    /// parabola of pressure is one, and that of the Magic Formula has no second derivative there.
    pub(super) fn stiffness(&self, side: Side) -> Option<f64> {
        let points = self.side(side);
        let (first, others) = points.get(..ROWS)?.split_first()?;
        let x = |i: usize| others[i].0 - first.0;
        let weight = |j: usize| (0..ROWS - 1).filter(|&m| m != j).map(|m| x(m) / (x(m) - x(j))).product::<f64>() / x(j);
        let slope: f64 = (0..ROWS - 1).map(|j| weight(j) * (others[j].1 - first.1)).sum();
        Some(slope.abs())
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests may fail")]
mod tests {
    use super::*;

    fn curve(step: f64, count: i32, force: impl Fn(f64) -> f64) -> ForceCurve {
        ForceCurve::new((-count..=count).map(|i| f64::from(i) * step).map(|slip| (slip, force(slip))).collect())
    }

    #[test]
    fn a_brush_has_its_stiffness_and_its_plateau() {
        let (limit, stiffness) = (2000.0, 4e4);
        let brush = |slip: f64| {
            let part = (stiffness * slip / (3.0 * limit)).clamp(-1.0, 1.0);
            3.0 * limit * part * (1.0 - part.abs() + part * part / 3.0)
        };
        let whole = curve(0.02, 10, brush);
        for side in whole.sides() {
            // The cubic is the brush's own.
            assert!((whole.stiffness(side).unwrap() / stiffness - 1.0).abs() < 1e-12);
            assert_eq!(whole.peak(side), Some(limit));
        }
        assert_eq!(whole.sides().count(), 2);
        // It slides from a slip of 0.15 on.
        assert_eq!(curve(0.02, 5, brush).peak(1.0), None);
    }

    #[test]
    fn sides_begin_at_zero_slip() {
        let shifted = ForceCurve::new((1..9).map(|i| (f64::from(i), 1.0)).collect());
        assert_eq!((shifted.sides().count(), shifted.stiffness(1.0), shifted.peak(1.0)), (0, None, None));
        let driving = ForceCurve::new((0..9).map(|i| (f64::from(i), f64::from(i))).collect());
        assert_eq!(driving.sides().collect::<Vec<_>>(), [1.0]);
    }
}
