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
