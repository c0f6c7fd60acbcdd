//! The displacement for a load, by secants.

/// A change of the load smaller than this share of it is no slope to go by: dashpots and scatter make as much.
const VISIBLE: f64 = 2e-2;
/// How far a slope may lie from the one that is known at first: factors.
const SLOPES: (f64, f64) = (0.3, 30.0);

/// Where w has to be for F_z to be a load.
#[derive(Clone, Copy, Debug)]
pub(super) struct Secant {
    /// F_z, N.
    pub(super) load: f64,
    /// Where w is, m.
    pub(super) w: f64,
    /// -∂F_z/∂w at first and by the last two loads, N/m.
    first: f64,
    stiffness: f64,
    last: Option<(f64, f64)>,
}

impl Secant {
    /// From w, where F_z grows by about `stiffness` (N/m) as w falls.
    pub(super) fn new(load: f64, (w, stiffness): (f64, f64)) -> Self {
        Self { load, w, first: stiffness, stiffness, last: None }
    }

    /// Moves w, where F_z was `force` (N). Returns by how much, m.
    pub(super) fn change(&mut self, force: f64) -> f64 {
        if let Some((w, before)) = self.last.filter(|(_, before)| (force - before).abs() > VISIBLE * self.load) {
            let slope = (before - force) / (self.w - w);
            if slope.is_finite() && slope > 0.0 {
                self.stiffness = slope.clamp(SLOPES.0 * self.first, SLOPES.1 * self.first);
            }
        }
        self.last = Some((self.w, force));
        let change = (force - self.load) / self.stiffness;
        self.w += change;
        change
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A load that grows with the pressed depth's square, from a slope that is wrong by a factor of two.
    #[test]
    fn a_smooth_load_is_found_in_a_few_runs() {
        let force = |w: f64| 1e9 * w * w;
        let mut secant = Secant::new(10.0, (-5e-5, 4e5));
        let mut runs = 0;
        while (force(secant.w) / secant.load - 1.0).abs() > 1e-3 {
            let _ = secant.change(force(secant.w));
            runs += 1;
            assert!(runs < 8, "w = {} m", secant.w);
        }
    }
}
