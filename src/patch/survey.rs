//! The elements of a run at its present instant, one by one.

use super::contact_times::size;
use super::face::Face;
use super::motion::{Instant, Path};
use super::run::PatchRun;
use super::state::{PatchState, RestoreError, Totals};
use crate::element::{LawPoint, Spot};
use crate::math::Number;

/// Share of a limit by which a restored force may exceed it: rounding.
const ROUNDING: f64 = 1e-9;

/// An element at an instant.
#[derive(Clone, Copy, Debug)]
pub(super) struct Present<T> {
    /// m².
    pub(super) area: f64,
    /// Along the plane, m/s.
    pub(super) velocity: [T; 2],
    pub(super) approach: T,
    pub(super) log_speed: T,
    pub(super) spot: Spot,
    pub(super) point: LawPoint<T>,
    /// Pa.
    pub(super) pressure: T,
}

/// Sums over all elements.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Survey {
    pub(super) count: usize,
    pub(super) sticking: usize,
    /// m².
    pub(super) nominal_area: f64,
    pub(super) real_area: f64,
    /// The largest, Pa.
    pub(super) pressure: f64,
    /// N, and of that beyond the table and below its least pressure.
    pub(super) normal: f64,
    pub(super) beyond: f64,
    pub(super) below: f64,
    /// Σ|G| and Σ|G|η, N.
    pub(super) tangential: f64,
    pub(super) hysteresis: f64,
    /// J.
    pub(super) elastic: f64,
}

impl Totals {
    /// The body now, moving as at the end of the last step.
    pub(super) fn instant(&self) -> Instant<f64> {
        Path { start: self.pose.coordinates(), change: self.rates, duration: 1.0 }.at(0.0)
    }
}

impl PatchRun {
    /// Element `i` at an instant with the tread where `totals` say.
    pub(super) fn present<T: Number>(&mut self, i: usize, totals: &Totals, now: &Instant<T>) -> Present<T> {
        let (place, area, direction) = self.patch.element(i, totals.place);
        let arm = now.turned(place);
        let mut velocity = now.velocity(arm);
        if matches!(*self.patch.face, Face::Tread(_)) {
            let along = now.turned([direction[0], 0.0, direction[1]]);
            velocity = [0, 1].map(|axis| velocity[axis] - along[axis].times(totals.tread_speed));
        }
        let approach = -(now.height + arm[2]);
        let log_speed = self.law.range().logarithm(size(velocity));
        let spot = self.law.spot(log_speed.value());
        let point = self.law.at(&spot, log_speed, approach);
        Present { area, velocity, approach, log_speed, spot, point, pressure: point.pressure() }
    }

    /// Whether the pressure on an element is above the largest of the table.
    pub fn pressure_is_beyond(&mut self) -> bool {
        self.survey().pressure > self.law.largest_pressure()
    }

    /// The share of the normal force that is borne below the least pressure of the table; 0 without contact.
    pub fn share_below_table(&mut self) -> f64 {
        let survey = self.survey();
        if survey.normal > 0.0 { survey.below / survey.normal } else { 0.0 }
    }

    /// Sums over all elements now.
    pub(super) fn survey(&mut self) -> Survey {
        let (totals, now) = (self.totals, self.totals.instant());
        let (pressure, speed) = (self.law.largest_pressure(), self.law.largest_speed());
        let mut survey = Survey::default();
        for i in 0..self.patch.count() {
            let here = self.present(i, &totals, &now);
            let normal = here.pressure * here.area;
            if normal <= 0.0 {
                continue;
            }
            let (hysteresis, ratio) = self.law.shares(&here.spot, here.log_speed, here.approach);
            let tangential = self.springs.x[i].hypot(self.springs.y[i]);
            let is_beyond = here.pressure > pressure || here.velocity[0].hypot(here.velocity[1]) > speed;
            survey.count += 1;
            survey.sticking += usize::from(self.springs.mode[i] == 2);
            survey.nominal_area += here.area;
            survey.real_area += here.area * ratio;
            survey.pressure = survey.pressure.max(here.pressure);
            survey.normal += normal;
            survey.beyond += if is_beyond { normal } else { 0.0 };
            survey.below += if here.point.factor < 1.0 { normal } else { 0.0 };
            survey.tangential += tangential;
            survey.hysteresis += tangential * hysteresis;
            survey.elastic += 0.5 * tangential * tangential / self.springs.stiffness[i];
        }
        survey
    }

    pub(super) fn pressure_on(&mut self, i: usize) -> f64 {
        let (totals, now) = (self.totals, self.totals.instant());
        let here = self.present(i, &totals, &now);
        if here.area > 0.0 { here.pressure } else { 0.0 }
    }

    pub(super) fn traction_on(&self, i: usize, axis: usize) -> f64 {
        let area = self.patch.element(i, self.totals.place).1;
        let force = if axis == 0 { self.springs.x[i] } else { self.springs.y[i] };
        if area > 0.0 { -force / area } else { 0.0 }
    }

    /// Refuses springs that no contact of a state can hold.
    pub(super) fn check_limits(&mut self, saved: &PatchState) -> Result<(), RestoreError> {
        let now = saved.totals.instant();
        for i in 0..self.patch.count() {
            let here = self.present(i, &saved.totals, &now);
            let limit = here.area * here.pressure * here.point.friction;
            let force = saved.springs.x[i].hypot(saved.springs.y[i]);
            let is_held = force == 0.0 || saved.springs.stiffness[i] > 0.0;
            if force.is_nan() || force > limit * (1.0 + ROUNDING) || !is_held {
                return Err(RestoreError::Invalid { what: "the force of a spring", value: force });
            }
        }
        Ok(())
    }
}
