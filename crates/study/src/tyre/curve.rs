//! Force over slip as a curve: its peak, and its stiffness at zero slip.

/// Slips nearer to zero than this are none.
pub(super) const NO_SLIP: f64 = 1e-9;
/// Points of a side, zero slip among them, of the polynomial whose slope is the stiffness: the fewest ...
const FEWEST: usize = 3;
/// ... and the most, since each makes more of what scatters.
const MOST: usize = 5;
/// They are those before this part of the peak.
const BEFORE_PEAK: f64 = 0.9;
/// A curve that rises by less than this part of it over its last step has come to its plateau.
const PLATEAU: f64 = 1e-3;

/// Sizes of slip and force at a load, of a side from zero slip on: driving or braking, left or right.
type Side = Vec<(f64, f64)>;

/// Force over slip at a load.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ForceCurve(Vec<Side>);

impl ForceCurve {
    /// The curve of points (slip, force), in any order; without the sides that have fewer than three, zero slip among them.
    pub(super) fn new(points: &[(f64, f64)]) -> Self {
        let side = |sign: f64| {
            let sized = points.iter().map(|&(slip, force)| (sign * slip, force.abs()));
            let mut side: Side = sized.filter(|(slip, _)| *slip > -NO_SLIP).collect();
            side.sort_by(|a, b| a.0.total_cmp(&b.0));
            side.dedup_by(|b, a| b.0 - a.0 < NO_SLIP);
            Some(side).filter(|side| side.len() >= FEWEST && side[0].0 < NO_SLIP)
        };
        Self([1.0, -1.0].into_iter().filter_map(side).collect())
    }

    /// Whether it has no side.
    pub(super) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The largest force in the mean of the sides; `None` where it still rises at the last slip.
    pub(super) fn peak(&self) -> Option<f64> {
        self.mean(peak)
    }

    /// The slope at zero slip in the mean of the sides; `None` with fewer than three points before the peak.
    pub(super) fn stiffness(&self) -> Option<f64> {
        self.mean(stiffness)
    }

    fn mean(&self, of: fn(&[(f64, f64)]) -> Option<f64>) -> Option<f64> {
        let sum: Option<f64> = self.0.iter().map(|side| of(side)).sum();
        sum.map(|sum| sum / self.0.len() as f64)
    }
}

/// The largest force, on the parabola through the three points about it.
fn peak(points: &[(f64, f64)]) -> Option<f64> {
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

/// The slope at zero slip of the polynomial through up to five points: a brush's curve under a parabola of pressure is one.
fn stiffness(points: &[(f64, f64)]) -> Option<f64> {
    let largest = points.iter().map(|point| point.1).fold(0.0, f64::max);
    let near = points.iter().take(MOST).take_while(|point| point.1 < BEFORE_PEAK * largest).count();
    let (first, others) = points.get(..near).filter(|_| near >= FEWEST)?.split_first()?;
    let x = |i: usize| others[i].0 - first.0;
    let weight = |j: usize| (0..others.len()).filter(|&m| m != j).map(|m| x(m) / (x(m) - x(j))).product::<f64>() / x(j);
    Some((0..others.len()).map(|j| weight(j) * (others[j].1 - first.1)).sum())
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests may fail")]
mod tests {
    use super::*;

    fn curve(step: f64, count: i32, force: impl Fn(f64) -> f64) -> ForceCurve {
        let points: Vec<_> = (-count..=count).map(|i| f64::from(i) * step).map(|slip| (slip, force(slip))).collect();
        ForceCurve::new(&points)
    }

    #[test]
    fn a_brush_has_its_stiffness_and_its_plateau() {
        let (limit, slope) = (2000.0, 4e4);
        let brush = |slip: f64| {
            let part = (slope * slip / (3.0 * limit)).clamp(-1.0, 1.0);
            3.0 * limit * part * (1.0 - part.abs() + part * part / 3.0)
        };
        let whole = curve(0.02, 10, brush);
        assert_eq!((whole.0.len(), whole.peak()), (2, Some(limit)));
        // The polynomial is the brush's own.
        assert!((whole.stiffness().unwrap() / slope - 1.0).abs() < 1e-12);
        // It slides from a slip of 0.15 on.
        assert_eq!(curve(0.02, 5, brush).peak(), None);
        assert_eq!(curve(0.1, 5, brush).stiffness(), None);
    }

    #[test]
    fn sides_begin_at_zero_slip() {
        let points = |from: i32| (from..9).map(|i| (f64::from(i), f64::from(i * (10 - i)))).collect::<Vec<_>>();
        assert!(ForceCurve::new(&points(1)).is_empty());
        let driving = ForceCurve::new(&points(0));
        assert_eq!((driving.0.len(), driving.peak()), (1, Some(25.0)));
    }
}
