//! The mechanical model: the layer, its links, the profile and friction as numbers to compute with (`Model`), the
//! layer's state (`State`), the carrier's motion (`Carrier`), the forces of the links (`Forces`) and in the contacts
//! (`ContactForces`), and the energies.

mod carrier;
mod constants;
mod contact;
mod energy;
mod even_sliding;
mod fine_friction;
mod forces;
mod friction;
mod reduction;
mod scales;
mod slip_curve;
mod slip_history;
mod spatial;
mod state;

pub use carrier::{BodyEnergy, BodyInterpolant, BodyStart, Carrier, CarrierPosition, Outside};
pub use constants::{DrivenBody, LinkLaw, MaxwellRow, SurfacePoint};
pub use contact::ContactForces;
pub use contact::FrictionPower;
pub use energy::{BoundaryPowers, ChannelEnergies, Powers, elastic_energy, kinetic_energy, vertical_spring_energy_at};
pub use even_sliding::EvenSliding;
pub use fine_friction::{ContactQuantity, FineContact, FineFriction, PressedContact};
pub use forces::{Forces, LinkMotion};
pub use friction::{FrictionLaw, FrictionShares, LinearFriction, RateShearLaw, SlipFriction};
pub use reduction::{Reduction, Replaced, Replacement};
pub use slip_curve::SlipCurve;
pub use slip_history::{Flash, FlashKernel, FlashTerm, HeatParts, SURFACE_TERMS, SpeedShift, surface_kernel};
pub use slip_history::{RememberedSpeed, SlipHistory, SpeedMemory, aged, memory_rate};
pub use spatial::{ElementSquares, MeasuredMotion, SpatialMeasure, Varied};
pub use state::EndForces;
pub use state::{CarrierPoint, Mode, State, Tangents, TangentsOf};

use std::sync::Arc;

use crate::math::Spline;
pub use crate::scene::{Axis, ByAxis, ByLink, Input, LinkKind};
use crate::scene::{Initial, Kinematics, Scene};

/// A scene as numbers to compute with. It does not change through a run.
#[derive(Clone, Debug)]
pub struct Model {
    /// Mass m of one point mass, kg.
    pub mass: f64,
    /// Area A that one mass stands for, m²; 0 in the direct form, which gives none.
    pub element_area: f64,
    /// Positions X_i of the masses at rest, m.
    pub rest_x: Vec<f64>,
    /// Heights Z_i of the masses at rest, m.
    pub rest_z: Vec<f64>,
    /// Which kinds of link the scene has at all; an absent one has no forces and no energies.
    pub has_link: ByLink<bool>,
    /// The laws of the links, 0 of absent ones.
    pub links: ByLink<LinkLaw>,
    /// Part of the stiffness that belongs to replaced Maxwell elements whose dashpots are frozen at the elongation of
    /// the start, N/m.
    pub frozen_stiffness: ByLink<f64>,
    /// The Maxwell elements: one row for each element of each kind of link.
    pub rows: Vec<MaxwellRow>,
    /// The relaxation times of the Maxwell elements, each once, s.
    pub relaxation_times: Vec<f64>,
    /// Glassy stiffness c + Σ c_j of each kind of link, N/m, as the scene has it: tolerances are derived from it,
    /// whatever `solver.reduce` replaces.
    pub glassy: ByLink<f64>,
    /// The rigid profile z_r(x).
    pub profile: Arc<Spline>,
    /// The carrier as a body along x and z; `None` where its displacement is prescribed.
    pub bodies: ByAxis<Option<DrivenBody>>,
    /// Friction in the contacts.
    pub friction: FrictionLaw,
    /// How friction heats the contacts; `None`: they stay at the layer's temperature.
    pub flash: Option<FlashKernel>,
    /// How the dashpots start.
    pub initial: Initial,
    /// Elongations of the vertical links at the start, m: those of the frozen dashpots, see
    /// [`frozen_stiffness`](Self::frozen_stiffness). Empty where there are none.
    pub frozen: Vec<f64>,
    /// Δx of links along z that are in spatial measure, m; `None` where they are in material measure.
    pub spatial: Option<f64>,
}

impl Model {
    /// The model of a scene.
    pub fn new(scene: &Scene) -> Self {
        let layer = &scene.layer;
        let k = layer.masses;
        let roughness = |i| layer.roughness.get(i).copied().unwrap_or(0.0);
        let reduction = Reduction::new(scene);
        let (links, frozen_stiffness) = constants::link_laws(scene, reduction.as_ref());
        let (rows, relaxation_times) = constants::maxwell_rows(scene, reduction.as_ref());
        Self {
            mass: scene.mass(),
            element_area: layer.element_area().unwrap_or(0.0),
            rest_x: (0..k).map(|i| layer.rest_position(i)).collect(),
            rest_z: (0..k).map(|i| layer.clearance + roughness(i)).collect(),
            frozen: if frozen_stiffness.iter().any(|&frozen| frozen > 0.0) { vec![0.0; k] } else { Vec::new() },
            has_link: ByLink::from_fn(|kind| scene.link(kind).is_some()),
            links,
            frozen_stiffness,
            rows,
            relaxation_times,
            glassy: ByLink::from_fn(|kind| scene.link(kind).as_ref().map_or(0.0, constants::glassy)),
            profile: Arc::clone(scene.surface.spline()),
            bodies: DrivenBody::along_axes(scene),
            friction: FrictionLaw::new(scene),
            flash: FlashKernel::new(scene),
            initial: layer.initial,
            spatial: (layer.kinematics() == Kinematics::Spatial && k > 1 && Self::strains(scene))
                .then_some(layer.spacing),
        }
    }

    /// Whether what the masses touch strains the layer along x: on slopes of the profile or of its own roughness.
    fn strains(scene: &Scene) -> bool {
        !(scene.surface.is_level() && scene.layer.roughness.is_empty())
    }

    /// Takes over what depends on the temperature from `scene`, this model's at another one: relaxation times,
    /// viscosity, the speeds of the friction law and the modulus of the fine roughness. Stiffnesses stay.
    pub fn set_temperature(&mut self, scene: &Scene) {
        let Self { links, frozen_stiffness, rows, relaxation_times, friction, .. } = Self::new(scene);
        (self.links, self.frozen_stiffness, self.rows) = (links, frozen_stiffness, rows);
        (self.relaxation_times, self.friction) = (relaxation_times, friction);
    }

    /// The model of the scene with this text.
    #[cfg(test)]
    pub(crate) fn from_text(text: &str) -> Self {
        Self::new(&Scene::parse(text, "test.toml".as_ref()).unwrap_or_else(|error| panic!("{error}")))
    }

    /// Freezes the dashpots that have [frozen springs](Self::frozen_stiffness) at their links' elongations at the
    /// start, m: `carrier` is u and w there, m. A mass that would lie under the profile is lifted onto it.
    pub fn freeze_dashpots(&mut self, carrier: ByAxis<f64>) {
        let profile_position = self.profile.reduce(carrier.x);
        for i in 0..self.frozen.len() {
            let surface = self.surface_at(self.rest_x[i] + profile_position);
            let gap = self.rest_z[i] + carrier.z - surface.height;
            self.frozen[i] = if gap < 0.0 { surface.height - self.rest_z[i] - carrier.z } else { 0.0 };
        }
    }

    /// Subtracts c_j y_j of the frozen dashpots from the `forces` of the links of `kind`, N.
    pub fn subtract_frozen(&self, kind: LinkKind, forces: &mut [f64]) {
        let stiffness = self.frozen_stiffness[kind];
        if stiffness > 0.0 {
            forces.iter_mut().zip(self.frozen_dashpots(kind)).for_each(|(force, y)| *force -= stiffness * y);
        }
    }

    /// y of the frozen dashpots, link by link of a kind that has some, m.
    pub fn frozen_dashpots(&self, kind: LinkKind) -> impl Iterator<Item = f64> {
        (0..kind.count(self.frozen.len())).map(move |link| self.frozen_dashpot(kind, link))
    }

    /// y of the frozen dashpots of one link of a kind that has some, m.
    pub fn frozen_dashpot(&self, kind: LinkKind, link: usize) -> f64 {
        kind.difference(&self.frozen, 0.0, link)
    }

    /// c_j y_j of the frozen dashpots of one link of a kind, N; 0 where it has none.
    pub fn frozen_force(&self, kind: LinkKind, link: usize) -> f64 {
        let stiffness = self.frozen_stiffness[kind];
        if stiffness > 0.0 { stiffness * self.frozen_dashpot(kind, link) } else { 0.0 }
    }

    /// The sum of the [forces](Self::frozen_force) of the frozen dashpots of all links of a kind, N.
    pub fn frozen_force_sum(&self, kind: LinkKind) -> f64 {
        let stiffness = self.frozen_stiffness[kind];
        if stiffness > 0.0 { stiffness * self.frozen_dashpots(kind).sum::<f64>() } else { 0.0 }
    }

    /// Σ c_j a_j of the Maxwell elements of links of a kind, N, for the elongations `a` of their springs, m.
    pub fn element_force(&self, kind: LinkKind, a: impl Fn(&MaxwellRow) -> f64) -> f64 {
        self.rows_of(kind).map(|row| row.stiffness * a(row)).sum()
    }

    /// The inputs that move the carrier.
    pub fn inputs(&self) -> Vec<Input> {
        let body = |input: &Input| input.axis().map(|axis| &self.bodies[axis]);
        let acts = |input: &Input| match (body(input).unwrap_or(&None), input.is_displacement()) {
            (None, is_displacement) => is_displacement,
            (Some(body), true) => body.stiffness > 0.0 || body.damping > 0.0,
            (Some(_), false) => true,
        };
        Input::MECHANICAL.into_iter().filter(acts).collect()
    }

    /// Whether the carrier is a body along an axis.
    pub fn has_bodies(&self) -> bool {
        self.bodies.any()
    }

    /// Number of masses k.
    pub fn masses(&self) -> usize {
        self.rest_x.len()
    }

    /// What a step that is tried takes, as a number of masses without heat: with heat the weights of its terms, and shorter
    /// and shorter steps where friction feeds itself.
    pub fn work_of_step(&self) -> usize {
        /// Measured on two masses, whose steps take 15 µs more than without.
        const OF_HEAT: usize = 8;
        self.masses() + if self.flash.is_some() { OF_HEAT } else { 0 }
    }

    /// The profile at the position `x`, m.
    #[inline(always)]
    pub fn surface_at(&self, x: f64) -> SurfacePoint {
        SurfacePoint::on(&self.profile, x)
    }

    /// The Maxwell elements of the links of `kind`.
    pub fn rows_of(&self, kind: LinkKind) -> impl Iterator<Item = &MaxwellRow> {
        self.rows.iter().filter(move |row| row.kind == kind)
    }

    /// Number of the parts of the flash temperatures of the whole layer.
    pub fn flash_variables(&self) -> usize {
        self.flash.as_ref().map_or(0, |kernel| kernel.terms.len() * self.masses())
    }

    /// Number of the remembered speeds: one a mass, or none.
    pub fn memory_variables(&self) -> usize {
        if self.friction.memory.is_some() { self.masses() } else { 0 }
    }

    /// Number of Maxwell elements of the whole layer.
    pub fn maxwell_variables(&self) -> usize {
        self.rows.last().map_or(0, |row| row.range.end)
    }
}
