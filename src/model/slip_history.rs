//! What the past of a contact says of its friction: the temperature that it has left, and the speed that it remembers.
//!
//! Contacts are renewed over a way D, and age at rest. Where a scene has such a memory, friction follows not the speed of
//! slip v_t but the state v_s of each mass (A. Perrin, J. R. Rice, G. Zheng, J. Mech. Phys. Solids 43, 1995, 1461,
//! written as a speed; docs/foundation.md, section 7):
//!
//!   dv_s/dt = (v_t² - v_s²)/(2D)

use super::Flash;

/// What is known of the flash temperature and of the remembered speed of a contact before its friction is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SlipHistory {
    /// The flash temperature as friction makes it.
    pub flash: Flash,
    /// The remembered speed as v_t makes it; `None`: that of slip itself, as in even sliding.
    pub memory: Option<SpeedMemory>,
}

impl SlipHistory {
    /// Even sliding at this flash temperature, K.
    pub fn even(flash: f64) -> Self {
        Self { flash: Flash::held(flash), memory: None }
    }
}

/// The speed v_s that a contact remembers, as its speed v_t makes it: v_s = `base` + `weight` (v_t² - v_s²).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SpeedMemory {
    /// What the past has left, m/s.
    pub base: f64,
    /// β/(2D) of the time β in which v_s follows, s/m.
    pub weight: f64,
}

/// v_s at one v_t.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RememberedSpeed {
    /// v_s, m/s.
    pub value: f64,
    /// ∂v_s/∂v_t.
    pub by_speed: f64,
    /// ∂v_s by the base.
    pub by_base: f64,
}

impl SpeedMemory {
    /// A speed that is held, m/s.
    pub fn held(speed: f64) -> Self {
        Self { base: speed, weight: 0.0 }
    }

    /// v_s at `speed`, v_t in m/s of either sign; 0 where a step is so long that there is none.
    #[inline]
    pub fn at(&self, speed: f64) -> RememberedSpeed {
        let known = self.base + self.weight * (speed * speed);
        if known <= 0.0 {
            return RememberedSpeed { value: 0.0, by_speed: 0.0, by_base: 0.0 };
        }
        let value = 2.0 * known / (1.0 + (1.0 + 4.0 * self.weight * known).sqrt());
        let by_base = 1.0 / (1.0 + 2.0 * self.weight * value);
        RememberedSpeed { value, by_speed: 2.0 * self.weight * speed * by_base, by_base }
    }
}

/// dv_s/dt, m/s², of a contact that slips at `speed`, remembers `remembered` (m/s) and renews over the way D = `way`, m.
#[inline]
pub fn memory_rate(way: f64, speed: f64, remembered: f64) -> f64 {
    // (v_t² - v_s²)/(2D) without cancellation.
    (speed.abs() - remembered) * (speed.abs() + remembered) / (2.0 * way)
}

/// v_s, m/s, of a contact that remembers `remembered` and then sticks for a `time` (s): 1/v_s grows by t/(2D).
#[inline]
pub fn aged(way: f64, remembered: f64, time: f64) -> f64 {
    remembered / (1.0 + remembered * time / (2.0 * way))
}

#[cfg(test)]
mod tests {
    use super::*;

    const WAY: f64 = 5e-5;

    /// v_s = v tanh(vt/2D + artanh(v_s0/v)) at a constant v, by implicit Euler steps: of order 1.
    #[test]
    fn a_constant_speed_is_followed_as_the_equation_says() {
        let (speed, from, time) = (0.3_f64, 0.05_f64, 2e-4);
        let exact = speed * (speed * time / (2.0 * WAY) + (from / speed).atanh()).tanh();
        let error = |steps: u32| {
            let weight = time / f64::from(steps) / (2.0 * WAY);
            let end = (0..steps).fold(from, |base, _| SpeedMemory { base, weight }.at(speed).value);
            (end - exact).abs()
        };
        let ratio = error(200) / error(400);
        assert!((ratio - 2.0).abs() < 0.05, "{ratio}");
        assert!(error(400) < 1e-3 * exact);
    }

    /// Whatever the speed its solution is positive and satisfies v_s + a v_s² = b + a v_t²; its derivatives are quotients'.
    #[test]
    fn the_remembered_speed_solves_its_equation() {
        for (base, weight) in [(0.1, 0.0), (0.1, 5.0), (1e-9, 1e6), (-1e-3, 10.0), (-1.0, 10.0)] {
            let memory = SpeedMemory { base, weight };
            for speed in [-3.0, -1e-6, 0.0, 1e-3, 0.3, 20.0] {
                let found = memory.at(speed);
                let known = base + weight * speed * speed;
                if known <= 0.0 {
                    assert_eq!(found.value, 0.0);
                    continue;
                }
                let left = found.value + weight * found.value * found.value;
                assert!(found.value > 0.0 && (left - known).abs() < 1e-14 * known, "{memory:?} {speed}");
                let quotient =
                    |up: RememberedSpeed, down: RememberedSpeed, step: f64| (up.value - down.value) / (2.0 * step);
                let (of_speed, of_base) = (1e-6 * speed.abs().max(1e-3), 1e-6 * known);
                let by_speed = quotient(memory.at(speed + of_speed), memory.at(speed - of_speed), of_speed);
                let moved = |by: f64| SpeedMemory { base: base + by, ..memory }.at(speed);
                let by_base = quotient(moved(of_base), moved(-of_base), of_base);
                // The third derivatives times the step squared, and roundings over the step.
                let near = |found: f64, quotient: f64| (found - quotient).abs() < 1e-5 * (1.0 + quotient.abs());
                assert!(near(found.by_speed, by_speed), "{memory:?} {speed}: {found:?} {by_speed}");
                assert!(near(found.by_base, by_base), "{memory:?} {speed}: {found:?} {by_base}");
            }
        }
    }

    /// 1/v_s grows by t/2D at rest, in one step as in two.
    #[test]
    fn what_rests_ages() {
        let (speed, time) = (2.0, 3e-3);
        let whole = aged(WAY, speed, time);
        assert!((1.0 / whole - (1.0 / speed + time / (2.0 * WAY))).abs() < 1e-12);
        assert!((aged(WAY, aged(WAY, speed, 0.4 * time), 0.6 * time) / whole - 1.0).abs() < 1e-14);
        assert_eq!(aged(WAY, 0.0, time), 0.0);
    }
}
