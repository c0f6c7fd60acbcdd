//! Rubber that slides, and what its contacts do on the slopes of a surface.
//!
//! A point on the slopes h_x, h_y with q1 = √(1 + h_x²), q2 = √(1 + h_x² + h_y²) bears the pressure p per horizontal area. Its
//! friction acts along the surface, so that it carries
//!
//!   N/A = q2 (p + τ h_x/q1),   τ = T(N, q1 v)/A
//!
//! up a slope the least N ≥ q2 p, since what friction pulls down presses it the harder. Down a slope N may come to 0: then shear
//! holds what p asks for, τ = p q1/|h_x|.

use super::heat::HeatResponse;
use super::surface::SurfaceGrid;
use super::transform::Convolution;
use asperity::model::{FrictionLaw, SlipHistory};
use asperity::scene::{ElasticBody, Material, Scene};

/// Rubber at a temperature: what slides. It serves every surface, speed and pressure.
#[derive(Clone, Debug)]
pub struct SlidingRubber {
    pub(super) material: Material,
    pub(super) body: ElasticBody,
    friction: FrictionLaw,
    /// The area that the law of friction is for, m².
    element_area: f64,
    pub(super) heat: Option<HeatResponse>,
    /// Whether contacts have friction of their own.
    pub(super) has_friction: bool,
    /// Whether there are waves that the profile lacks, and whether they rub.
    pub(super) has_fine: bool,
    pub(super) fine_rubs: bool,
}

/// A point of the surface as what slides over it has it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slope {
    /// h_x and h_y, 1.
    pub(super) along: f64,
    across: f64,
    /// q1 and q2, 1.
    way: f64,
    area: f64,
}

/// A contact of a point, per horizontal area.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SlidingContact {
    /// τ q1, which takes the power v τ q1, Pa.
    pub(super) friction: f64,
    /// The part of that by the waves that the surface lacks, Pa.
    pub(super) hysteresis: f64,
    /// A_r/A, 1.
    pub(super) share: f64,
    /// ∂(τ q1)/∂ϑ, Pa/K.
    pub(super) by_flash: f64,
}

/// From this Poisson ratio on the coupling is not counted: it would take up to some 0.7 % of a friction coefficient near one.
const NEARLY_INCOMPRESSIBLE: f64 = 0.48;
/// Accuracy of N over itself, and the most evaluations of the law for it.
const ACCURACY: f64 = 1.0e-12;
const MOST_EVALUATIONS: usize = 100;
/// ∂N/∂(N that is too much) is at most the inverse of it: only the way to ϑ depends on that.
const LEAST_FEEDBACK: f64 = 1.0e-6;

impl SlidingRubber {
    /// The rubber of a scene in the material form, on a half-space or a layer; `None` of any other.
    pub fn new(scene: &Scene) -> Option<Self> {
        Self::with_friction(scene, FrictionLaw::new(scene))
    }

    /// [`new`](Self::new) of a scene whose law of friction is known.
    pub fn with_friction(scene: &Scene, friction: FrictionLaw) -> Option<Self> {
        let material = scene.material.clone()?;
        Some(Self {
            body: scene.layer.body(&material)?,
            friction,
            element_area: scene.layer.element_area()?,
            heat: HeatResponse::new(scene),
            has_friction: scene.has_friction(),
            has_fine: scene.fine.is_some(),
            fine_rubs: scene.has_fine_hysteresis(),
            material,
        })
    }

    /// E''/E' at an angular frequency, 1/s.
    pub(crate) fn loss_factor(&self, omega: f64) -> f64 {
        let (storage, loss) = self.material.complex_modulus(omega);
        loss / storage
    }

    /// Whether a contact on this slope jams: Coulomb's friction presses it by more than it takes.
    pub(super) fn jams(&self, slope: &Slope) -> bool {
        self.friction.coulomb * slope.pressing() >= 1.0
    }

    /// What a contact under a pressure (Pa) does on a slope at a speed (m/s) and a flash temperature, K.
    pub(super) fn sliding(&self, pressure: f64, slope: &Slope, speed: f64, flash: f64) -> SlidingContact {
        let (pressing, least) = (slope.pressing(), slope.area * pressure);
        let at = |normal: f64| self.at(normal, slope.way * speed, flash);
        let mut found = at(least);
        if least + pressing * found.friction <= 0.0 {
            let unloaded = at(0.0);
            if least + pressing * unloaded.friction <= 0.0 {
                return slope.unloaded(pressure, &unloaded);
            }
        }
        let mut normal = least;
        let (mut low, mut high) = if pressing > 0.0 { (least, f64::INFINITY) } else { (0.0, least) };
        for _ in 0..MOST_EVALUATIONS {
            // N that is too much, and its derivative.
            let excess = normal - least - pressing * found.friction;
            if excess.abs() <= ACCURACY * normal {
                break;
            }
            if excess < 0.0 {
                low = normal
            } else {
                high = normal
            };
            normal = next((low, high), normal - excess / (1.0 - pressing * found.by_normal));
            found = at(normal);
        }
        let feedback = (1.0 - pressing * found.by_normal).max(LEAST_FEEDBACK);
        SlidingContact {
            friction: slope.way * found.friction,
            hysteresis: slope.way * found.hysteresis,
            share: found.share,
            by_flash: slope.way * found.by_flash / feedback,
        }
    }

    /// The law under N/A (Pa) at the speed along the surface (m/s) and a flash temperature (K).
    fn at(&self, normal: f64, speed: f64, flash: f64) -> LawAt {
        let slip = self.friction.slip(normal * self.element_area, speed, &SlipHistory::even(flash));
        let per_area = 1.0 / self.element_area;
        LawAt {
            friction: per_area * slip.force(),
            hysteresis: per_area * slip.hysteresis,
            share: slip.share,
            by_normal: slip.by_normal,
            by_flash: per_area * slip.by_flash,
        }
    }

    /// By how much tangential traction moves the surface of a half-space along the normal: κ'; `None` where that is next to
    /// nothing, or not known.
    pub(super) fn coupling(&self) -> Option<f64> {
        let nu = self.material.poisson_ratio;
        (nu < NEARLY_INCOMPRESSIBLE && !self.is_bonded()).then(|| (1.0 - 2.0 * nu) / (2.0 * (1.0 - nu)))
    }

    /// Whether that is not known: of a layer of compressible rubber.
    pub(super) fn lacks_coupling(&self) -> bool {
        self.material.poisson_ratio < NEARLY_INCOMPRESSIBLE && self.is_bonded()
    }

    /// Whether it is a layer on a rigid base.
    pub(super) fn is_bonded(&self) -> bool {
        matches!(self.body, ElasticBody::Bonded { .. })
    }

    /// The factor of the normal stiffness of a contact that gives the tangential one: R. D. Mindlin's of a half-space; of
    /// ridges, which move along without shearing, 1.
    pub(super) fn tangential_factor(&self, surface: &SurfaceGrid) -> f64 {
        let nu = self.material.poisson_ratio;
        if surface.size.ny > 1 { 2.0 * (1.0 - nu) / (2.0 - nu) } else { 1.0 }
    }
}

/// The law of friction at a contact, per area.
#[derive(Clone, Copy, Debug)]
struct LawAt {
    /// τ, Pa.
    friction: f64,
    hysteresis: f64,
    share: f64,
    /// ∂τ/∂(N/A), 1.
    by_normal: f64,
    by_flash: f64,
}

/// The `step` of Newton's method, or half of what is left where that leads out of it; what has no end is doubled.
fn next((low, high): (f64, f64), step: f64) -> f64 {
    match (step > low && step < high, high.is_finite()) {
        (true, _) => step,
        (false, true) => 0.5 * (low + high),
        (false, false) => 2.0 * low,
    }
}

impl Slope {
    /// All points of a surface.
    pub(super) fn all(surface: &SurfaceGrid, convolution: &mut Convolution) -> Vec<Self> {
        let (along, across) = (surface.slopes(convolution), surface.slopes_across(convolution));
        along.into_iter().zip(across).map(|(along, across)| Self::new(along, across)).collect()
    }

    fn new(along: f64, across: f64) -> Self {
        Self { along, across, way: along.hypot(1.0), area: (1.0 + along * along + across * across).sqrt() }
    }

    /// ∂(N/A)/∂τ, 1.
    fn pressing(&self) -> f64 {
        self.along * self.area / self.way
    }

    /// The traction on the rubber along and across the sliding, Pa, under a pressure and τ q1 (Pa).
    pub(super) fn traction(&self, pressure: f64, friction: f64) -> [f64; 2] {
        let across = self.across * (pressure + friction * self.along / (self.way * self.way));
        [-(pressure * self.along + friction), -across]
    }

    /// What shear does that holds the `pressure` (Pa) alone, by the law at N = 0.
    fn unloaded(&self, pressure: f64, at: &LawAt) -> SlidingContact {
        let friction = pressure * self.way * self.way / self.along.abs();
        SlidingContact { friction, share: at.share, ..SlidingContact::default() }
    }
}
