//! The contact model: layer, links, profile and friction, as numbers ready to compute with (`Model`), the layer's state
//! (`State`), the carrier's motion (`Carrier`) and the forces that follow from them (`Forces`).

mod carrier;
mod energy;
mod forces;
mod friction;
mod link;
mod reduction;
mod state;

pub use carrier::{Carrier, CarrierPoint};
pub use energy::{ChannelEnergies, Exchange, Powers, elastic_energy, kinetic_energy};
pub use forces::{ContactForces, Forces, LinkMotion};
pub use friction::RateShear;
pub use link::{LinkLaw, MaxwellRow};
pub use reduction::{Reduction, Replaced, Replacement};
pub use state::{Mode, State};

use serde::{Deserialize, Serialize};

use crate::math::{Numbers, Spline, visit_all};
pub use crate::scene::LinkKind;
use crate::scene::{Initial, Scene};

/// The profile at one position.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SurfacePoint {
    /// z_r, m.
    pub height: f64,
    /// s = z_r', 1.
    pub slope: f64,
    /// κ = z_r'', 1/m.
    pub curvature: f64,
    /// z_r''', 1/m²: constant between two data points.
    pub third: f64,
}

impl Numbers for SurfacePoint {
    fn visit(&mut self, visit: &mut dyn FnMut(&mut f64)) {
        let Self { height, slope, curvature, third } = self;
        visit_all([height, slope, curvature, third], visit);
    }
}

/// A scene as numbers: what stays the same through a run.
#[derive(Clone, Debug)]
pub struct Model {
    /// Mass m of one point mass, kg.
    pub mass: f64,
    /// Area A that one mass stands for, m²; 0 in the direct form, which gives none.
    pub element_area: f64,
    /// Places X_i of the masses at rest, m.
    pub rest_x: Vec<f64>,
    /// Heights Z_i of the masses at rest, m.
    pub rest_z: Vec<f64>,
    /// Springs and dampers of the four kinds of link, in the order of [`LinkKind::ALL`].
    pub links: [LinkLaw; 4],
    /// The Maxwell elements: one row for each element of each kind of link.
    pub rows: Vec<MaxwellRow>,
    /// The relaxation times of the Maxwell elements, each once, s.
    pub relaxation_times: Vec<f64>,
    /// c + Σ c_j of each kind of link, N/m, as the scene has it: tolerances go by the whole, whatever is replaced.
    pub glassy: [f64; 4],
    /// The rigid profile z_r(x).
    pub profile: Spline,
    /// Coulomb's coefficient μ.
    pub friction_coefficient: f64,
    /// Shear force A τ_0 + A τ_f(v_c) of a mass in contact, at rest or slower than it can creep, N.
    pub shear_force: f64,
    /// What a mass that slips has beyond that; `None` where the shear force does not depend on the speed.
    pub rate_shear: Option<RateShear>,
    /// Whether contacts can stick: a part of the friction law is not zero.
    pub has_friction: bool,
    /// How the dashpots start.
    pub initial: Initial,
    /// Elongations of the vertical links at the start, m: where the dashpots of [`LinkLaw::still`] stand. Empty where
    /// there are none.
    pub frozen: Vec<f64>,
}

impl Model {
    /// The model of a scene.
    pub fn new(scene: &Scene) -> Self {
        let layer = &scene.layer;
        let k = layer.masses;
        let friction = scene.friction.as_ref();
        let roughness = |i| layer.roughness.get(i).copied().unwrap_or(0.0);
        let rate_shear = scene.rate_shear().and_then(|law| RateShear::new(&law));
        let shear_force = scene.shear_force().unwrap_or(0.0);
        let coulomb = friction.and_then(|f| f.coulomb).unwrap_or(0.0);
        let reduction = Reduction::new(scene);
        let links = LinkKind::ALL.map(|kind| LinkLaw::new(scene, kind, reduction.as_ref()));
        let (rows, relaxation_times) = link::maxwell_rows(scene, reduction.as_ref());
        Self {
            mass: scene.mass(),
            element_area: layer.element_area().unwrap_or(0.0),
            rest_x: (0..k).map(|i| layer.place(i)).collect(),
            rest_z: (0..k).map(|i| layer.clearance + roughness(i)).collect(),
            frozen: if links.iter().any(|link| link.frozen > 0.0) { vec![0.0; k] } else { Vec::new() },
            links,
            rows,
            relaxation_times,
            glassy: LinkKind::ALL.map(|kind| scene.link(kind).as_ref().map_or(0.0, link::glassy_stiffness)),
            profile: scene.surface.spline(),
            friction_coefficient: coulomb,
            shear_force: shear_force + rate_shear.map_or(0.0, |rate_shear| rate_shear.plateau()),
            rate_shear,
            has_friction: coulomb > 0.0 || shear_force > 0.0 || rate_shear.is_some(),
            initial: layer.initial,
        }
    }

    /// The model of the scene with this text.
    #[cfg(test)]
    pub(crate) fn of_text(text: &str) -> Self {
        Self::new(&Scene::parse(text, "test.toml".as_ref()).unwrap_or_else(|error| panic!("{error}")))
    }

    /// Puts the dashpots that stand still where the masses' places at the start have them: `place` is u there as a
    /// place on the profile, `w` is w, m. A mass that would lie under the profile is lifted onto it.
    pub fn freeze_dashpots(&mut self, place: f64, w: f64) {
        for i in 0..self.frozen.len() {
            let surface = self.surface_at(self.rest_x[i] + place);
            let gap = self.rest_z[i] + w - surface.height;
            self.frozen[i] = if gap < 0.0 { surface.height - self.rest_z[i] - w } else { 0.0 };
        }
    }

    /// Takes from the forces of a kind of link what its springs lack whose dashpots stand frozen: F = … - c_j y_j.
    pub fn subtract_frozen(&self, kind: LinkKind, forces: &mut [f64]) {
        let stiffness = self.links[kind as usize].frozen;
        if stiffness > 0.0 {
            forces.iter_mut().zip(self.frozen_dashpots(kind)).for_each(|(force, y)| *force -= stiffness * y);
        }
    }

    /// y of the dashpots that stand still, link by link of a kind that has some, m.
    pub fn frozen_dashpots(&self, kind: LinkKind) -> impl Iterator<Item = f64> {
        (0..kind.count(self.frozen.len())).map(move |link| self.frozen_dashpot(kind, link))
    }

    /// y of the dashpots that stand still in one link of a kind that has some, m.
    pub fn frozen_dashpot(&self, kind: LinkKind, link: usize) -> f64 {
        if kind.is_lateral() { self.frozen[link + 1] - self.frozen[link] } else { self.frozen[link] }
    }

    /// Number of masses k.
    pub fn masses(&self) -> usize {
        self.rest_x.len()
    }

    /// The profile at the place `x`, m.
    #[inline]
    pub fn surface_at(&self, x: f64) -> SurfacePoint {
        let (height, slope, curvature, third) = self.profile.evaluate(x);
        SurfacePoint { height, slope, curvature, third }
    }

    /// The Maxwell elements of the links of `kind`.
    pub fn rows_of(&self, kind: LinkKind) -> impl Iterator<Item = &MaxwellRow> {
        self.rows.iter().filter(move |row| row.kind == kind)
    }

    /// Number of Maxwell variables of the whole layer.
    pub fn maxwell_variables(&self) -> usize {
        self.rows.last().map_or(0, |row| row.range.end)
    }

    /// Largest stiffness that holds one mass, all springs at once, N/m: Σ (c + Σ c_j), lateral links twice.
    pub fn glassy_stiffness(&self) -> f64 {
        holding(self.glassy)
    }

    /// The same without the links that are [rods](Self::is_rod): what an error of a place is felt with, N/m.
    pub fn felt_stiffness(&self) -> f64 {
        let beyond = BEYOND * BEYOND * self.usual_stiffness();
        holding(self.glassy.map(|stiffness| if stiffness > beyond { 0.0 } else { stiffness }))
    }

    /// Whether the links of `kind` are so stiff, or their dampers so strong, beside the other springs that they work as
    /// rods: their forces are what the other forces leave to them, and no place or velocity within its own tolerance
    /// says what they are.
    pub fn is_rod(&self, kind: LinkKind) -> bool {
        let usual = self.usual_stiffness();
        let (stiffness, damping) = (self.glassy[kind as usize], self.links[kind as usize].damping);
        usual > 0.0 && (stiffness > BEYOND * BEYOND * usual || damping > BEYOND * (usual * self.mass).sqrt())
    }

    /// What lasts of the links that press a mass on, N/m, where their Maxwell elements are far stiffer than that and
    /// than the softest of the other links: once these have relaxed, no place within its tolerance says what a mass is
    /// pressed with.
    pub fn long_term_stiffness(&self) -> Option<f64> {
        let elements: f64 = self.rows_of(LinkKind::Vertical).map(|row| row.stiffness).sum();
        let [_, others @ ..] = self.glassy;
        let softest = others.into_iter().filter(|&stiffness| stiffness > 0.0).reduce(f64::min);
        let lasting = self.links[LinkKind::Vertical as usize].stiffness.max(softest.unwrap_or(0.0));
        (lasting > 0.0 && elements > BEYOND * BEYOND * lasting).then_some(lasting)
    }

    /// The largest stiffness that makes a force of the rounding of a place, N/m. Maxwell elements that press by far more
    /// than lasts do not: each keeps its own elongation.
    pub fn rounded_stiffness(&self) -> f64 {
        let [vertical, others @ ..] = self.glassy;
        let link = &self.links[LinkKind::Vertical as usize];
        let vertical = if self.long_term_stiffness().is_some() { link.stiffness } else { vertical };
        holding([vertical, others[0], others[1], others[2]])
    }

    /// What springs are judged by: the vertical ones, whose elongation is forced on them, or the softest of the others
    /// where those are stiffer, N/m.
    fn usual_stiffness(&self) -> f64 {
        let [vertical, others @ ..] = self.glassy;
        let softest = others.into_iter().filter(|&stiffness| stiffness > 0.0).reduce(f64::min);
        vertical.max(softest.unwrap_or(0.0))
    }

    /// The stiffest frequency of one mass, rad/s; where the layer has no springs, its fastest damping rate, 1/s, and
    /// where it has nothing, 1.
    pub fn stiffest_frequency(&self) -> f64 {
        self.frequency_of(self.glassy_stiffness())
    }

    /// The same without the springs of [rods](Self::is_rod).
    pub fn felt_frequency(&self) -> f64 {
        self.frequency_of(self.felt_stiffness())
    }

    fn frequency_of(&self, stiffness: f64) -> f64 {
        let frequency = (stiffness / self.mass).sqrt();
        let damping = self.links.iter().map(|link| link.damping).fold(0.0, f64::max) / self.mass;
        [frequency, damping].into_iter().find(|&rate| rate > 0.0).unwrap_or(1.0)
    }
}

/// What springs of these stiffnesses hold one mass with, N/m.
fn holding([vertical, horizontal, lateral_x, lateral_z]: [f64; 4]) -> f64 {
    (horizontal + 2.0 * lateral_x).max(vertical + 2.0 * lateral_z)
}

/// A rod's own motion is this many times as fast as the masses swing on the other springs.
///
/// Recommended 30 to 1000. A layer of a material has (H/Δx)², some thousands at most, between the stiffness of its
/// lateral links and that of those to the carrier; its dampers are critical or weaker.
const BEYOND: f64 = 100.0;
