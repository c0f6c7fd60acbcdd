//! F_x and F_z within a step, from sums over the layer that are taken once a step.
//!
//! All that the forces on the carrier consist of is linear in the values at the stages and at both ends of the step. So
//! is the height of a mass in contact, as far as the step's dense output goes; where a tolerance asks for more these
//! masses are put on the profile one by one, see [`ContactHeights`].

use std::ops::Range;

use super::maxwell::ElementWeights;
use super::scheme::ContactHeights;
use super::stage_values::StageValues;
use super::tableau::StageWeights;
use crate::math::{BLOCK, dot, sum};
use crate::model::{ByAxis, Carrier, CarrierPoint, LinkKind, MaxwellRow, Mode, Model, State, SurfacePoint};

/// Elongations of links (m) and velocities of masses (m/s), along x and z: of one mass, of one relative to another or
/// to the carrier, or summed.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct LinkState {
    pub elongation: ByAxis<f64>,
    pub velocity: ByAxis<f64>,
}

impl LinkState {
    #[inline(always)]
    pub(super) fn add(&mut self, other: &Self) {
        (self.elongation, self.velocity) = (self.elongation + other.elongation, self.velocity + other.velocity);
    }

    /// The links from a mass to its neighbour at the right (`sign` 1) or at the left (-1).
    pub(super) fn between(here: &Self, there: &Self, sign: f64) -> Self {
        let signed = |difference: ByAxis<f64>| difference.map(|difference| sign * difference);
        Self {
            elongation: signed(there.elongation - here.elongation),
            velocity: signed(there.velocity - here.velocity),
        }
    }

    /// Adds up to [`BLOCK`] masses, one after another from mass `first` on, that slip with the elongations `x` (m) and
    /// velocities `v_x` (m/s), on the profile. For use with vector instructions.
    #[inline(always)]
    pub(super) fn add_slips(&mut self, model: &Model, first: usize, (x, v_x): (&[f64], &[f64]), placement: &Placement) {
        let masses = first..first + x.len();
        let (rest_x, rest_z) = (&model.rest_x[masses.clone()], &model.rest_z[masses]);
        let (mut places, mut surface) = ([0.0; BLOCK], [SurfacePoint::default(); BLOCK]);
        let (places, surface) = (&mut places[..x.len()], &mut surface[..x.len()]);
        for (place, (rest_x, x)) in places.iter_mut().zip(rest_x.iter().zip(x)) {
            *place = placement.position(*rest_x, *x);
        }
        model.profile.evaluate_block(places, surface);
        for ((x, v_x), (rest_z, surface)) in x.iter().zip(v_x).zip(rest_z.iter().zip(surface)) {
            let elongation = ByAxis { x: *x, z: surface.height - rest_z - placement.w };
            self.add(&Self { elongation, velocity: ByAxis { x: *v_x, z: surface.slope * v_x } });
        }
    }
}

/// Where the carrier is at one instant, as masses that slip are put on the profile.
#[derive(Clone, Copy, Debug)]
pub(super) struct Placement {
    /// u as a position on the profile at the start of the carrier's segment, m.
    profile_position: f64,
    /// Its displacement along x since then, m.
    du: f64,
    /// w, m.
    pub w: f64,
}

impl Placement {
    /// Under the `carrier`, which is at `now`.
    pub(super) fn new(carrier: &Carrier, now: &CarrierPoint) -> Self {
        Self { profile_position: carrier.profile_position, du: now.x.position, w: carrier.start.z + now.z.position }
    }

    /// The position on the profile of a mass with the rest position `rest_x` and the elongation `x`, m.
    #[inline(always)]
    pub(super) fn position(&self, rest_x: f64, x: f64) -> f64 {
        rest_x + (self.profile_position + (self.du + x))
    }
}

/// Sums over the masses, or some of them, and their links to the carrier of the last attempted step.
#[derive(Clone, Debug)]
pub(super) struct CarrierSums {
    /// Whether they are those of the last attempted step.
    known: bool,
    /// 1 for a mass that is summed up, 0 for one that is not but put on the profile.
    is_summed: Vec<f64>,
    /// Number of these masses.
    pub summed: f64,
    /// Number of those of them that do not stick.
    pub moving: f64,
    /// Number of those of them that are free.
    pub free: f64,
    pub x: AxisSums,
    pub z: AxisSums,
}

/// The sums along one axis.
#[derive(Clone, Debug)]
pub(super) struct AxisSums {
    kind: LinkKind,
    /// Σ e of the masses that are summed up at the start and at the end, m.
    pub elongation: [f64; 2],
    /// Σ v of these masses at the stages, m/s.
    pub velocity: StageWeights,
    /// Σ ė of all links at the stages, m/s; 0 without Maxwell elements.
    rate: StageWeights,
    /// Σ a of all links at the start and at the end, m, by row of elements of this kind.
    elements: Vec<[f64; 2]>,
}

impl CarrierSums {
    /// Workspace for all masses of `model`.
    pub(super) fn new(model: &Model) -> Self {
        let (x, z) = (AxisSums::new(model, LinkKind::Horizontal), AxisSums::new(model, LinkKind::Vertical));
        Self { known: false, is_summed: vec![0.0; model.masses()], summed: 0.0, moving: 0.0, free: 0.0, x, z }
    }

    /// A new step is attempted.
    pub(super) fn invalidate(&mut self) {
        self.known = false;
    }

    /// Whether all masses are summed up, those in contact too.
    pub(super) fn has_all(&self) -> bool {
        self.summed == self.is_summed.len() as f64
    }

    /// Takes the sums over `masses` of a layer of `model`, of its step from `start` to `end` with these `stages`,
    /// unless they are known.
    pub(super) fn collect(
        &mut self,
        model: &Model,
        masses: &Range<usize>,
        (start, end): (&State, &State),
        stages: &[StageValues],
        heights: ContactHeights,
    ) {
        if self.known {
            return;
        }
        self.known = true;
        // Which masses are summed: of others the dense output has each one's motion.
        (self.summed, self.moving, self.free) = (0.0, 0.0, 0.0);
        for (is_summed, mode) in self.is_summed.iter_mut().zip(&start.mode[masses.clone()]) {
            let is_free = !mode.in_contact();
            *is_summed = one_if(is_free || heights == ContactHeights::Interpolated);
            self.summed += *is_summed;
            self.moving += one_if(*mode != Mode::Stick) * *is_summed;
            self.free += one_if(is_free);
        }
        // Their elongations at the ends of the step and velocities at the stages, then what the links need.
        let of_summed = |values: &[f64]| dot(&self.is_summed, &values[masses.start..]);
        self.x.elongation = [of_summed(&start.elongation_x), of_summed(&end.elongation_x)];
        self.z.elongation = [of_summed(&start.elongation_z), of_summed(&end.elongation_z)];
        for (j, stage) in stages.iter().enumerate() {
            (self.x.velocity[j], self.z.velocity[j]) = (of_summed(&stage.velocity_x), of_summed(&stage.velocity_z));
        }
        self.x.collect_links(model, masses, [start, end], stages);
        self.z.collect_links(model, masses, [start, end], stages);
    }

    /// F_x and F_z (N) where the masses, of `model`, together move as `motion` says, under the `carrier`, with these
    /// weights of the Maxwell elements.
    pub(super) fn forces(
        &self,
        model: &Model,
        motion: &LinkState,
        carrier: &CarrierPoint,
        weights: impl Fn(&MaxwellRow) -> ElementWeights,
    ) -> ByAxis<f64> {
        let masses = model.masses() as f64;
        let rate = motion.velocity - carrier.rates().map(|rate| masses * rate);
        ByAxis {
            x: self.x.force(model, (motion.elongation.x, rate.x), &weights),
            z: self.z.force(model, (motion.elongation.z, rate.z), &weights),
        }
    }
}

fn one_if(condition: bool) -> f64 {
    f64::from(u8::from(condition))
}

impl AxisSums {
    fn new(model: &Model, kind: LinkKind) -> Self {
        let none = StageWeights::default();
        let elements = vec![[0.0; 2]; model.rows_of(kind).count()];
        Self { kind, elongation: [0.0; 2], velocity: none, rate: none, elements }
    }

    fn collect_links(&mut self, model: &Model, masses: &Range<usize>, ends: [&State; 2], stages: &[StageValues]) {
        for (row, sums) in model.rows_of(self.kind).zip(&mut self.elements) {
            *sums = ends.map(|state| sum(&state.maxwell[row.range.clone()][masses.clone()]));
        }
        if !self.elements.is_empty() {
            for (rate, stage) in self.rate.iter_mut().zip(stages) {
                *rate = sum(&stage.elongation_rate[self.kind][masses.clone()]);
            }
        }
    }

    /// The force of all links with these sums of elongations (m) and of their rates (m/s), N.
    fn force(
        &self,
        model: &Model,
        (elongation, rate): (f64, f64),
        weights: impl Fn(&MaxwellRow) -> ElementWeights,
    ) -> f64 {
        let mut force = model.links[self.kind].force(elongation, rate) - model.frozen_force_sum(self.kind);
        for (row, [start, end]) in model.rows_of(self.kind).zip(&self.elements) {
            let ElementWeights { ends, rates } = weights(row);
            let driven: f64 = rates.iter().zip(&self.rate).map(|(weight, rate)| weight * rate).sum();
            force += row.stiffness * (ends[0] * start + ends[1] * end + driven);
        }
        force
    }
}
