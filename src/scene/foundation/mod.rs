//! What the links of a layer stand for: the stiffness of the rubber's surface below the masses, whatever their spacing.

mod body;
mod fit;
mod quality;
mod warnings;
mod waves;

use serde::Serialize;

pub use body::ElasticBody;
pub use fit::Stiffness;
pub use quality::Quality;
pub use waves::{Wave, Waves};

use super::values::Word;
use super::{Layer, LinkKind, Material, Surface};

/// How the links follow from the material.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum FoundationKind {
    /// By the layer's thickness and the spacing alone (docs/model.md, section 7): off by factors but near one wavelength.
    Springs,
    /// Fitted to a half-space.
    HalfSpace,
    /// Fitted to a layer of a thickness, bonded to a rigid base.
    #[default]
    Layer,
}

impl Word for FoundationKind {
    const WORDS: &'static [(&'static str, Self)] =
        &[("springs", Self::Springs), ("half_space", Self::HalfSpace), ("layer", Self::Layer)];
}

impl FoundationKind {
    /// The word for it in a scene file.
    pub fn word(self) -> &'static str {
        self.as_word()
    }
}

/// The links of a layer fitted to the surface of a body, weighted by the waves of the profile and of the roughness.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Foundation {
    /// What moves along z: α of the vertical links, β of the lateral ones.
    pub normal: Stiffness,
    /// What moves along x: α of the horizontal links, β of the lateral ones.
    pub tangential: Stiffness,
    /// ℓ, m: the depth of the material whose mass a point mass has.
    pub depth: f64,
    /// What the fit was made over.
    #[serde(skip)]
    pub waves: Waves,
}

impl Foundation {
    /// The foundation of a layer of `material` on `surface`; `None` for springs, which are not fitted.
    pub(super) fn new(layer: &Layer, material: &Material, surface: &Surface) -> Option<Self> {
        if layer.foundation == Some(FoundationKind::Springs) {
            return None;
        }
        Some(Self::fitted(Waves::new(layer, surface), layer.body(material)?, material.poisson_ratio))
    }

    /// A foundation fitted anew to these waves.
    pub(super) fn refitted(&self, layer: &Layer, material: &Material) -> Option<Self> {
        Some(Self::fitted(self.waves.clone(), layer.body(material)?, material.poisson_ratio))
    }

    fn fitted(waves: Waves, body: ElasticBody, poisson_ratio: f64) -> Self {
        let normal = Stiffness::fitted(&waves, |q| body.normal(q));
        let tangential = match body {
            ElasticBody::HalfPlane => normal,
            ElasticBody::Bonded { .. } => Stiffness::fitted(&waves, |q| body.tangential(q)),
        };
        let depth = waves.depth(poisson_ratio);
        let depth = if let ElasticBody::Bonded { thickness, .. } = body { depth.min(thickness) } else { depth };
        Self { normal, tangential, depth, waves }
    }

    /// What moves along the direction of `kind`.
    fn stiffness(&self, kind: LinkKind) -> Stiffness {
        if kind.is_along_x() { self.tangential } else { self.normal }
    }

    /// What turns the plane modulus M into the stiffness of a link, m; `width` is that of the layer, m.
    pub(super) fn link_size(&self, kind: LinkKind, layer: &Layer, width: f64) -> f64 {
        let stiffness = self.stiffness(kind);
        if kind.is_lateral() { stiffness.beta * width / layer.spacing } else { stiffness.alpha * width * layer.spacing }
    }
}

impl Waves {
    /// ℓ = c_m ΣWq/ΣWq², m: the least squares of the inertia c_m ρ/q of a half-plane's wave, to the second order in the
    /// speed (J. Cole and J. Huth, J. Appl. Mech. 25, 1958, 433).
    fn depth(&self, poisson_ratio: f64) -> f64 {
        let coupling = (1.0 - 2.0 * poisson_ratio) / (2.0 * (1.0 - poisson_ratio));
        let inertia = 1.5 - 2.0 * coupling + 1.5 * coupling * coupling;
        let sums = self
            .weighted()
            .fold((0.0, 0.0), |(first, second), (q, weight)| (first + weight * q, second + weight * q * q));
        inertia * sums.0 / sums.1
    }
}

impl Layer {
    /// The body that the links stand for: springs are held against a layer of their thickness. `None` in the direct
    /// form.
    pub fn body(&self, material: &Material) -> Option<ElasticBody> {
        match self.foundation? {
            FoundationKind::HalfSpace => Some(ElasticBody::HalfPlane),
            FoundationKind::Springs | FoundationKind::Layer => {
                Some(ElasticBody::Bonded { thickness: self.thickness?, poisson_ratio: material.poisson_ratio })
            }
        }
    }

    /// What springs are along the direction of `kind`, over the plane modulus (docs/model.md, section 7).
    fn springs(&self, material: &Material, kind: LinkKind) -> Option<Stiffness> {
        let (thickness, nu) = (self.thickness?, material.poisson_ratio);
        // E/M and G/M
        let (modulus, shear) = (1.0 - nu * nu, 0.5 * (1.0 - nu));
        Some(if kind.is_along_x() {
            Stiffness { alpha: shear / thickness, beta: modulus * thickness }
        } else {
            Stiffness { alpha: modulus / thickness, beta: shear * thickness }
        })
    }
}
