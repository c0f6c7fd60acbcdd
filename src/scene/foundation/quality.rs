//! How well the links meet the stiffness of the surface that they stand for.

use std::f64::consts::TAU;

use super::{ElasticBody, Stiffness, Waves};
use crate::scene::{LinkKind, Scene};

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
    fn new(waves: &Waves, stiffness: Stiffness, body: ElasticBody, kind: LinkKind) -> Option<Self> {
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

impl Scene {
    /// How well the links along the direction of `kind` meet the surface of a half-plane or of a layer of their
    /// thickness; `None` in the direct form.
    pub fn quality(&self, kind: LinkKind) -> Option<Quality> {
        let (layer, material) = (&self.layer, self.material.as_ref()?);
        let body = layer.body(material)?;
        match &self.foundation {
            Some(fit) => Quality::new(&fit.waves, fit.stiffness(kind), body, kind),
            None => {
                let waves = Waves::new(layer, &self.surface);
                Quality::new(&waves, layer.springs(material, kind)?, body, kind)
            }
        }
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
