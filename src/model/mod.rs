//! The contact model: layer, links, profile and friction, as numbers ready to compute with (`Model`), the layer's state
//! (`State`), the carrier's motion (`Carrier`) and the forces that follow from them (`Forces`).

mod carrier;
mod forces;
mod link;
mod power;
mod state;

pub use carrier::{Carrier, CarrierPoint};
pub use forces::{ContactForces, Forces, LinkMotion};
pub use link::{LinkLaw, MaxwellRow};
pub use power::{Exchange, Power, elastic_energy, kinetic_energy};
pub use state::{Mode, State};

use crate::math::{Numbers, Spline, visit_all};
pub use crate::scene::LinkKind;
use crate::scene::{Initial, Scene};

/// The profile at one place.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
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
    /// The rigid profile z_r(x).
    pub profile: Spline,
    /// Coulomb's coefficient μ.
    pub friction_coefficient: f64,
    /// Adhesive shear force A τ_0 of a mass in contact, N.
    pub shear_force: f64,
    /// Whether contacts can stick: a part of the friction law is not zero.
    pub has_friction: bool,
    /// How the dashpots start.
    pub initial: Initial,
}

impl Model {
    /// The model of a scene.
    pub fn new(scene: &Scene) -> Self {
        let layer = &scene.layer;
        let k = layer.masses;
        let friction = scene.friction.as_ref();
        let (rows, relaxation_times) = link::maxwell_rows(layer);
        let roughness = |i| layer.roughness.get(i).copied().unwrap_or(0.0);
        Self {
            mass: layer.mass,
            rest_x: (0..k).map(|i| layer.place(i)).collect(),
            rest_z: (0..k).map(|i| layer.clearance + roughness(i)).collect(),
            links: LinkKind::ALL.map(|kind| LinkLaw::new(layer.link(kind))),
            rows,
            relaxation_times,
            profile: scene.surface.spline(),
            friction_coefficient: friction.and_then(|f| f.coulomb).unwrap_or(0.0),
            shear_force: friction.and_then(|f| f.shear_force).unwrap_or(0.0),
            has_friction: friction.is_some_and(|f| [f.coulomb, f.shear_force].iter().flatten().any(|&part| part > 0.0)),
            initial: layer.initial,
        }
    }

    /// The model of the scene with this text.
    #[cfg(test)]
    pub(crate) fn of_text(text: &str) -> Self {
        Self::new(&Scene::parse(text, "test.toml".as_ref()).unwrap_or_else(|error| panic!("{error}")))
    }

    /// Number of masses k.
    pub fn masses(&self) -> usize {
        self.rest_x.len()
    }

    /// The profile at the place `x`, m.
    #[inline]
    pub fn ground(&self, x: f64) -> SurfacePoint {
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
        let of = |kind: LinkKind| {
            let maxwell: f64 = self.rows.iter().filter(|row| row.kind == kind).map(|row| row.stiffness).sum();
            self.links[kind as usize].stiffness + maxwell
        };
        let along_x = of(LinkKind::Horizontal) + 2.0 * of(LinkKind::LateralX);
        let along_z = of(LinkKind::Vertical) + 2.0 * of(LinkKind::LateralZ);
        along_x.max(along_z)
    }

    /// The stiffest frequency of one mass, rad/s; where the layer has no springs, its fastest damping rate, 1/s, and
    /// where it has nothing, 1.
    pub fn stiffest_frequency(&self) -> f64 {
        let frequency = (self.glassy_stiffness() / self.mass).sqrt();
        let damping = self.links.iter().map(|link| link.damping).fold(0.0, f64::max) / self.mass;
        [frequency, damping].into_iter().find(|&rate| rate > 0.0).unwrap_or(1.0)
    }
}
