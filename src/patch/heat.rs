//! Elements that slip warms: the temperature of an element's surface rises by ϑ = ∫ κ(t-t') χ q dt' with what slip
//! loses per area, q, and κ(t) = 1/√(πkρc t), a sum of exponentials of which each element has a state.
//!
//! In a part ϑ follows exactly from the mean loss in it. The law is looked up at ϑ where the part begins, so that it
//! follows the temperature one part late and goes on without a leap; a part is cut until ϑ changes by little in it.

use serde::{Deserialize, Serialize};

use super::face::{BLOCK, Lanes};
use crate::math::Number;
use crate::model::{FlashTerm, SURFACE_TERMS};

/// Largest change of ϑ in a part, K.
pub(super) const MAX_CHANGE: f64 = 5.0;

/// What a step has to know of heat.
#[derive(Clone, Copy, Debug)]
pub(super) struct StepHeat {
    /// χκ.
    pub(super) kernel: [FlashTerm; SURFACE_TERMS],
    /// The least and the largest ϑ at which the law changes, K: those of the table's first and last temperature.
    pub(super) range: (f64, f64),
}

/// The heat of an element.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct ElementHeat {
    /// The ϑ of its law, K: that where the last part began.
    pub(super) of_law: f64,
    /// The parts of ϑ by the terms of the kernel, K.
    pub(super) parts: [f64; SURFACE_TERMS],
}

impl ElementHeat {
    /// ϑ, K.
    pub(super) fn rise(&self) -> f64 {
        self.parts.iter().sum()
    }

    /// What is no temperature that a surface can have warmed up by.
    pub(super) fn invalid(&self) -> Option<f64> {
        self.parts.iter().chain([&self.of_law]).copied().find(|part| !(0.0..f64::INFINITY).contains(part))
    }
}

/// The parts of ϑ of a block, K, by the terms of the kernel.
pub(super) type Rises<T> = [Lanes<T>; SURFACE_TERMS];

/// The heat of a block's elements.
#[derive(Clone, Debug)]
pub(super) struct BlockHeat<T> {
    /// The ϑ of their laws, K.
    pub(super) of_law: Lanes<T>,
    pub(super) parts: Rises<T>,
    /// Whether some may be warm.
    is_warm: bool,
    response: HeatResponse,
}

/// How the terms of a kernel go on over a duration.
#[derive(Clone, Copy, Debug, Default)]
struct HeatResponse {
    /// s.
    duration: f64,
    /// What is left of a part.
    kept: [f64; SURFACE_TERMS],
    /// What a loss per area of 1 J/m² adds, K m²/J.
    gain: [f64; SURFACE_TERMS],
}

impl HeatResponse {
    fn new(kernel: &[FlashTerm; SURFACE_TERMS], duration: f64) -> Self {
        let per = if duration > 0.0 { 1.0 / duration } else { 0.0 };
        Self {
            duration,
            kept: kernel.map(|term| (-duration / term.time).exp()),
            gain: kernel.map(|term| term.rise(duration) * per),
        }
    }
}

impl<T: Number> BlockHeat<T> {
    pub(super) fn new() -> Self {
        let zero = [T::constant(0.0); BLOCK];
        Self { of_law: zero, parts: [zero; SURFACE_TERMS], is_warm: false, response: HeatResponse::default() }
    }

    /// All at the temperature of the ground.
    pub(super) fn reset(&mut self) {
        if !std::mem::take(&mut self.is_warm) {
            return;
        }
        let zero = [T::constant(0.0); BLOCK];
        (self.of_law, self.parts) = (zero, [zero; SURFACE_TERMS]);
    }

    pub(super) fn load(&mut self, lane: usize, heat: &ElementHeat) {
        self.is_warm = true;
        self.of_law[lane] = T::constant(heat.of_law);
        for (lanes, part) in self.parts.iter_mut().zip(heat.parts) {
            lanes[lane] = T::constant(part);
        }
    }

    pub(super) fn element(&self, lane: usize) -> ElementHeat {
        let parts = std::array::from_fn(|term| self.parts[term][lane].value());
        ElementHeat { of_law: self.of_law[lane].value(), parts }
    }

    /// The parts after a duration (s) in which slip loses `loss` (J) on areas (m²).
    #[inline(always)]
    pub(super) fn after(&mut self, heat: &StepHeat, duration: f64, loss: &Lanes<T>, area: &Lanes<f64>) -> Rises<T> {
        self.is_warm = true;
        if duration != self.response.duration {
            self.response = HeatResponse::new(&heat.kernel, duration);
        }
        let mut parts = self.parts;
        let mut per_area = *loss;
        for i in 0..BLOCK {
            per_area[i] = loss[i].times(if area[i] > 0.0 { 1.0 / area[i] } else { 0.0 });
        }
        for (lanes, (kept, gain)) in parts.iter_mut().zip(self.response.kept.iter().zip(&self.response.gain)) {
            for i in 0..BLOCK {
                lanes[i] = lanes[i].times(*kept) + per_area[i].times(*gain);
            }
        }
        parts
    }
}

/// ϑ, K.
#[inline(always)]
pub(super) fn total<T: Number>(parts: &Rises<T>) -> Lanes<T> {
    let mut sum = [T::constant(0.0); BLOCK];
    for lanes in parts {
        for i in 0..BLOCK {
            sum[i] = sum[i] + lanes[i];
        }
    }
    sum
}
