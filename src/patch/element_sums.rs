//! The elements of a run at its present instant: the contact of each, and sums over all.

use super::definition::ElementSite;
use super::face::Face;
use super::motion::{BodyKinematics, PoseMotion};
use super::run::PatchRun;
use super::segments::size;
use super::state::{PatchRestoreError, PatchState, Totals};
use crate::element::{ElementLaw, LawPlace, ROUNDING};
use crate::math::Number;

/// An element at an instant, and its law there.
#[derive(Clone, Copy, Debug)]
pub(super) struct ElementContact<T> {
    /// The area that is inside the contact, m².
    pub(super) area: f64,
    /// Along the plane, m/s.
    pub(super) velocity: [T; 2],
    /// How far it is below the plane z = 0, m.
    pub(super) approach: T,
    /// Where its speed and its temperature lie in the law.
    pub(super) place: LawPlace<T>,
    /// The law there, at its approach.
    pub(super) law: ElementLaw<T>,
    /// The pressure on it, Pa.
    pub(super) pressure: T,
}

/// Sums over all elements.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ElementSums {
    /// How many bear.
    pub(super) count: usize,
    /// How many stick.
    pub(super) sticking: usize,
    /// The area of those that bear, m².
    pub(super) nominal_area: f64,
    /// The real area of contact, m².
    pub(super) real_area: f64,
    /// The largest pressure, Pa.
    pub(super) pressure: f64,
    /// The normal force, N.
    pub(super) normal: f64,
    /// Of that, on elements beyond the table, N.
    pub(super) beyond: f64,
    /// Of the normal force, on elements below the least pressure of the table, N.
    pub(super) below: f64,
    /// Σ|G|, N.
    pub(super) tangential: f64,
    /// Σ|G|η with the share η of hysteresis in the friction coefficient, N.
    pub(super) hysteresis: f64,
    /// The energy stored in the springs, J.
    pub(super) elastic: f64,
    /// By how much the warmest of those that bear is warmer than the temperature given, K.
    pub(super) warmest: f64,
    /// Of those that bear, Σ Aϑ with the rise ϑ of the temperature, m² K.
    pub(super) warmth: f64,
}

impl Totals {
    /// The body now, moving as at the end of the last step.
    pub(super) fn instant(&self) -> BodyKinematics<f64> {
        PoseMotion { start: self.pose.coordinates(), change: self.rates, duration: 1.0 }.at(0.0)
    }
}

impl PatchRun {
    /// Element `i` at an instant with the tread where `totals` say, its law warmer by `rise` (K).
    pub(super) fn element_contact<T: Number>(
        &mut self,
        i: usize,
        totals: &Totals,
        now: &BodyKinematics<T>,
        rise: f64,
    ) -> ElementContact<T> {
        let ElementSite { place, area, direction } = self.patch.element(i, totals.place);
        let arm = now.turned(place);
        let mut velocity = now.velocity(arm);
        if matches!(*self.patch.face, Face::Tread(_)) {
            let along = now.turned([direction[0], 0.0, direction[1]]);
            velocity = [0, 1].map(|axis| velocity[axis] - along[axis].times(totals.tread_speed));
        }
        let approach = -(now.height + arm[2]);
        let place = self.law.place(size(velocity), T::constant(rise));
        let law = self.law.at_place(&place, approach);
        ElementContact { area, velocity, approach, place, law, pressure: law.pressure }
    }

    /// Whether the pressure on an element is above the largest of the table.
    pub fn pressure_is_beyond(&mut self) -> bool {
        self.element_sums().pressure > self.law.limits().pressure
    }

    /// The share of the normal force that is borne below the least pressure of the table; 0 without contact.
    pub fn share_below_table(&mut self) -> f64 {
        let sums = self.element_sums();
        if sums.normal > 0.0 { sums.below / sums.normal } else { 0.0 }
    }

    /// Sums over all elements now.
    pub(super) fn element_sums(&mut self) -> ElementSums {
        let (totals, now) = (self.totals, self.totals.instant());
        let (limits, least) = (self.law.limits(), self.law.least_pressure());
        let mut sums = ElementSums::default();
        for i in 0..self.patch.count() {
            let here = self.element_contact(i, &totals, &now, self.springs.rise_of_law(i));
            let normal = here.pressure * here.area;
            if normal <= 0.0 {
                continue;
            }
            let (hysteresis, ratio) = self.law.shares(&here.place, here.approach);
            let tangential = self.springs.x[i].hypot(self.springs.y[i]);
            let is_beyond = limits.is_beyond(here.pressure, here.velocity[0].hypot(here.velocity[1]));
            sums.count += 1;
            sums.sticking += usize::from(self.springs.sticks(i));
            sums.nominal_area += here.area;
            sums.real_area += here.area * ratio;
            sums.pressure = sums.pressure.max(here.pressure);
            sums.normal += normal;
            sums.beyond += if is_beyond { normal } else { 0.0 };
            sums.below += if here.pressure < least { normal } else { 0.0 };
            sums.tangential += tangential;
            sums.hysteresis += tangential * hysteresis;
            sums.elastic += 0.5 * tangential * tangential / self.springs.stiffness[i];
            sums.warmest = sums.warmest.max(self.springs.rise(i));
            sums.warmth += here.area * self.springs.rise(i);
        }
        sums
    }

    /// The pressure on element `i` now, Pa.
    pub(super) fn pressure_on(&mut self, i: usize) -> f64 {
        let (totals, now) = (self.totals, self.totals.instant());
        let here = self.element_contact(i, &totals, &now, self.springs.rise_of_law(i));
        if here.area > 0.0 { here.pressure } else { 0.0 }
    }

    /// The traction of the ground on element `i` along x or y, Pa.
    pub(super) fn traction_on(&self, i: usize, axis: usize) -> f64 {
        let area = self.patch.element(i, self.totals.place).area;
        let force = if axis == 0 { self.springs.x[i] } else { self.springs.y[i] };
        if area > 0.0 { -force / area } else { 0.0 }
    }

    /// Refuses springs that no contact of a state can hold.
    pub(super) fn check_limits(&mut self, saved: &PatchState) -> Result<(), PatchRestoreError> {
        let now = saved.totals.instant();
        for i in 0..self.patch.count() {
            let here = self.element_contact(i, &saved.totals, &now, saved.springs.rise_of_law(i));
            let limit = here.area * here.pressure * here.law.friction;
            let force = saved.springs.x[i].hypot(saved.springs.y[i]);
            let is_held = force == 0.0 || saved.springs.stiffness[i] > 0.0;
            if force.is_nan() || force > limit * (1.0 + ROUNDING) || !is_held {
                return Err(PatchRestoreError::Invalid { what: "the force of a spring", value: force });
            }
        }
        Ok(())
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use std::path::Path;

    use super::super::definition::Patch;
    use super::super::state::{PatchStart, Pose};
    use super::*;

    /// The share beyond the table and the warning follow one criterion: what exceeds the table by rounding is within.
    #[test]
    fn elements_count_as_beyond_the_table_where_it_is_said() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/reference/patch");
        let text = "name = \"one\"\ntable = { path = \"winkler.table.csv\" }\n\
                    patch = { shape = \"flat\", length = 0.01, width = 0.01, nx = 1, ny = 1 }";
        let patch = Patch::parse(text, &folder.join("patch.toml")).unwrap();
        let at = |z: f64| {
            let pose = Pose { place: [0.0, 0.0, z], angles: [0.0; 3] };
            PatchRun::new(&patch, &PatchStart { pose, ..PatchStart::default() }).unwrap()
        };
        let largest = at(0.0).law.limits().pressure / (1.0 + ROUNDING);
        for (excess, is_beyond) in [(0.5, false), (2.0, true)] {
            let (mut low, mut high) = (-1e-2, 1e-2);
            for _ in 0..100 {
                let middle = 0.5 * (low + high);
                let is_above = at(middle).element_sums().pressure > largest * (1.0 + excess * ROUNDING);
                if is_above { low = middle } else { high = middle }
            }
            let mut run = at(low);
            let sums = run.element_sums();
            assert!(sums.pressure > largest && sums.normal > 0.0);
            assert_eq!((sums.beyond > 0.0, !run.take_warnings().is_empty()), (is_beyond, is_beyond), "{excess}");
        }
    }
}
