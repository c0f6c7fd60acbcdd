//! Which outputs depend directly on the inputs: with the states held.
//!
//! The states are the places and velocities of the masses, the dashpots' y_j and the contact modes, all in the inertial
//! frame. What is left of u is then the elongation ξ_i - u of the horizontal links, and of w that of the vertical ones,
//! ζ_i - w; rates of the inputs are no inputs. So:
//!
//! - F = c e + d ė + Σ c_j (e - y_j) of a carrier link, and with it F_x or F_z, follows its input where the link has a
//!   spring or Maxwell elements. A damper alone gives none: ė is a rate.
//! - F_N = (m κ ẋ² - f_z + s f_x)/q of a mass in contact follows w through f_z and, on a slope, u through f_x; F_T
//!   follows μ F_N while it slips and f·t = (f_x + s f_z)/q while it sticks. So do the sums of the contact forces.
//! - P_maxwell = Σ c_j τ_j ẏ_j² with ẏ_j = (e - y_j)/τ_j follows each input whose link has Maxwell elements;
//!   P_friction = Σ F_T v_t follows F_N where there is Coulomb friction (a shear force is constant while it slips, and
//!   where it sticks v_t = 0); P_damper none.
//! - V follows each input whose link has a spring or Maxwell elements, and with V `energy.residual`.
//! - T, everything integrated, and everything counted are states or follow from states alone.

use super::Output;
use crate::scene::{Link, LinkKind, Scene};

/// Whether something depends directly on u and on w.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Dependencies {
    /// On u.
    pub on_u: bool,
    /// On w.
    pub on_w: bool,
}

impl Dependencies {
    /// The parts of a direction (of u, of w) that count.
    pub fn part_of(self, (du, dw): (f64, f64)) -> (f64, f64) {
        (if self.on_u { du } else { 0.0 }, if self.on_w { dw } else { 0.0 })
    }

    fn or(self, other: Self) -> Self {
        Self { on_u: self.on_u || other.on_u, on_w: self.on_w || other.on_w }
    }

    fn only_if(self, condition: bool) -> Self {
        if condition { self } else { Self::default() }
    }
}

/// What `output` depends on directly in `scene`.
pub fn dependencies(scene: &Scene, output: Output) -> Dependencies {
    let elastic = links(scene, |link| link.stiffness.is_some() || !link.maxwell.is_empty());
    match output {
        Output::ForceX => Dependencies { on_w: false, ..elastic },
        Output::ForceZ => Dependencies { on_u: false, ..elastic },
        Output::DissipatedPower => dissipated_power(scene, elastic),
        Output::Hysteresis | Output::ContactForceX | Output::ContactForceZ => elastic,
        Output::ElementNormalForce(_) => elastic,
        Output::Adhesion | Output::ElementFrictionForce(_) => elastic.only_if(scene.friction.is_some()),
        Output::FrictionCoefficient | Output::ElasticEnergy | Output::EnergyResidual => elastic,
        Output::DissipatedEnergy
        | Output::DamperEnergy
        | Output::MaxwellEnergy
        | Output::FrictionEnergy
        | Output::ImpactEnergy
        | Output::ContactCount
        | Output::StickingCount
        | Output::ContactRatio
        | Output::ContactArea
        | Output::InputEnergy
        | Output::KineticEnergy
        | Output::TangentXU
        | Output::TangentXW
        | Output::TangentZU
        | Output::TangentZW
        | Output::Steps
        | Output::Events
        | Output::Rejected
        | Output::EstimatedError
        | Output::RunTime
        | Output::ElementX(_)
        | Output::ElementZ(_)
        | Output::ElementMode(_) => Dependencies::default(),
    }
}

fn dissipated_power(scene: &Scene, elastic: Dependencies) -> Dependencies {
    let coulomb = scene.friction.as_ref().is_some_and(|friction| friction.coulomb.is_some());
    links(scene, |link| !link.maxwell.is_empty()).or(elastic.only_if(coulomb))
}

/// Which carrier links have what `test` asks for: the horizontal ones stretch with u, the vertical ones with w.
fn links(scene: &Scene, test: fn(&Link) -> bool) -> Dependencies {
    Dependencies {
        on_u: scene.link(LinkKind::Horizontal).as_ref().is_some_and(test),
        on_w: scene.link(LinkKind::Vertical).as_ref().is_some_and(test),
    }
}
