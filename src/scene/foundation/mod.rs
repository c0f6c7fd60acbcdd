//! What the links of a layer stand for: the stiffness of the rubber's surface below the masses, whatever their spacing.

use std::f64::consts::TAU;

use serde::Serialize;

use super::layer::{FoundationKind, Layer};
use super::{LinkKind, Material, Surface};

mod contacts;
mod fit;
mod warnings;
mod waves;

pub use contacts::ContactFit;
pub use fit::{ElasticBody, Stiffness};
pub use waves::{Wave, Waves};

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
    pub(super) fn stiffness(&self, kind: LinkKind) -> Stiffness {
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
    pub(super) fn springs(&self, material: &Material, kind: LinkKind) -> Option<Stiffness> {
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

/// The stiffness of the links over that of the surface, r(q), over the waves of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Quality {
    /// r at five wavelengths (m) that are even in their logarithms, from the longest to the shortest of the waves that
    /// carry 5 to 95 % of the weight.
    pub ratios: [(f64, f64); 5],
    /// The least r of these waves.
    pub least: f64,
    /// The largest r of these waves.
    pub largest: f64,
    /// Root mean square of r - 1 over the weights of all waves.
    pub rms: f64,
    /// r at every wave: wavelength (m) and r.
    pub curve: Vec<(f64, f64)>,
}

impl Quality {
    /// How the `stiffness` of the links lies to that of the `body` along the direction of `kind`.
    pub(super) fn new(waves: &Waves, stiffness: Stiffness, body: ElasticBody, kind: LinkKind) -> Option<Self> {
        let ratio = |q: f64| stiffness.at_wave_number(waves, q) / body.stiffness_along(kind, q);
        let carrying = waves.carrying();
        let (first, last) = (carrying.first()?.wave_number, carrying.last()?.wave_number);
        let at = |part: f64| first * (last / first).powf(part);
        let of_carrying = || carrying.iter().map(|wave| ratio(wave.wave_number));
        let whole: f64 = waves.resolved.iter().map(|wave| wave.weight).sum();
        let missed = |q: f64| (ratio(q) - 1.0).powi(2);
        let square: f64 = waves.resolved.iter().map(|wave| wave.weight * missed(wave.wave_number)).sum();
        Some(Self {
            ratios: [0.0, 0.25, 0.5, 0.75, 1.0].map(|part| (TAU / at(part), ratio(at(part)))),
            least: of_carrying().fold(f64::INFINITY, f64::min),
            largest: of_carrying().fold(0.0, f64::max),
            rms: (square / whole).sqrt(),
            curve: waves.resolved.iter().map(|wave| (TAU / wave.wave_number, ratio(wave.wave_number))).collect(),
        })
    }
}

impl Stiffness {
    /// α + βD², 1/m.
    fn at_wave_number(&self, waves: &Waves, wave_number: f64) -> f64 {
        self.alpha + self.beta * waves.difference_square(wave_number)
    }
}

impl ElasticBody {
    fn stiffness_along(self, kind: LinkKind, wave_number: f64) -> f64 {
        if kind.is_along_x() { self.tangential(wave_number) } else { self.normal(wave_number) }
    }
}
