//! The equation of motion of a slipping mass: its residual, its derivative in Newton's method, and its variations for the
//! tangents (docs/theory.md, sections 3, 4 and 8).

use nalgebra::{Matrix2, Vector2};

use crate::model::{
    ByAxis, ContactForces, Forces, LinearFriction, LinkLaw, Model, SlipFriction, SlipHistory, State, SurfacePoint,
};

/// How the height of a slipping mass on the profile follows its ẋ.
#[derive(Clone, Copy, Debug)]
pub(super) struct ContactJacobian {
    /// ∂e_z/∂ẋ = βs.
    pub(super) height: f64,
    /// ∂ż/∂ẋ = s + βκẋ.
    pub(super) rate: f64,
}

impl ContactJacobian {
    /// -∂F/∂ẋ of a link along z by this `law` to the mass.
    #[inline(always)]
    pub(super) fn force(self, law: &LinkLaw) -> f64 {
        law.force(self.height, self.rate)
    }
}

/// The motion of a slipping mass along x.
#[derive(Clone, Copy, Debug)]
pub(super) struct SlipMotion {
    /// ẋ, m/s.
    pub(super) velocity: f64,
    /// ẍ, m/s².
    pub(super) acceleration: f64,
}

/// A variation of a slipping mass: its motion along x, and the forces of the links on it.
#[derive(Clone, Copy, Debug)]
pub(in crate::integrator) struct SlipVariation {
    /// δx.
    pub(in crate::integrator) x: f64,
    /// δẋ.
    pub(in crate::integrator) velocity: f64,
    /// δf_x and δf_z.
    pub(in crate::integrator) forces: ByAxis<f64>,
}

/// What a [`SlipVariation`] makes of a contact.
#[derive(Clone, Copy, Debug)]
pub(in crate::integrator) struct ContactVariation {
    /// δF_N.
    pub(in crate::integrator) normal: f64,
    /// δv_t.
    pub(in crate::integrator) speed: f64,
}

/// The equation of motion of a slipping mass, (6)-(9), at given velocity and acceleration: its residual and
/// derivatives.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::integrator) struct SlippingMass {
    s: f64,
    kappa: f64,
    third: f64,
    velocity: f64,
    acceleration: f64,
    sigma: f64,
    /// σμ; with a real area σ ∂T/∂F_N.
    sigma_mu: f64,
    /// σ (A τ_0 + A τ_f(v_c)); with a real area what σ ∂T/∂F_N F_N leaves of it.
    sigma_shear: f64,
    /// 1 - σμs, the factor of f_x.
    share_x: f64,
    /// S = s + σμ, the factor of f_z.
    share_z: f64,
    q: f64,
    q2: f64,
}

impl SlippingMass {
    /// A mass that slips in the direction `sigma` over `surface`, under this law of friction.
    #[inline(always)]
    pub(super) fn under(law: LinearFriction, sigma: f64, surface: &SurfacePoint, motion: SlipMotion) -> Self {
        let LinearFriction { coulomb, shear, .. } = law;
        let s = surface.slope;
        let q2 = 1.0 + s * s;
        // F_T = σ (μ F_N + A τ_0) with F_N from (9): a share σμ of the forces along n enters the motion along t.
        let sigma_mu = sigma * coulomb;
        Self {
            s,
            kappa: surface.curvature,
            third: surface.third,
            velocity: motion.velocity,
            acceleration: motion.acceleration,
            sigma,
            sigma_mu,
            sigma_shear: sigma * shear,
            share_x: 1.0 - sigma_mu * s,
            share_z: s + sigma_mu,
            q: q2.sqrt(),
            q2,
        }
    }

    /// Mass `i` of `state`, which slips, with ẍ = `acceleration` under the `forces` of the links, and its friction.
    ///
    /// A law that is not linear is taken along its tangent at F_N: the value and the derivatives there are the law's.
    #[inline(always)]
    pub(in crate::integrator) fn from_state(
        model: &Model,
        state: &State,
        forces: &Forces,
        i: usize,
        acceleration: f64,
        history: &SlipHistory,
    ) -> (Self, SlipFriction) {
        let (velocity, surface, sigma) = (state.velocity_x[i], &state.surface[i], state.mode[i].direction());
        // F_N from (9) needs no ẍ. A law that is linear in it is its own tangent at F_N = 0.
        let contact = ContactForces::without_limit(model.mass, forces.on_mass(i), velocity, surface);
        let normal = if model.friction.is_linear_in_normal() { 0.0 } else { contact.normal };
        let friction = model.friction.slip(normal, sigma * (contact.q * velocity), history);
        (Self::under(friction.tangent(), sigma, surface, SlipMotion { velocity, acceleration }), friction)
    }

    /// m q² ẍ + m s κ ẋ² - f_x - s f_z + F_T q with F_T = σ (μ F_N + A τ_0), from (6)-(9), where A τ_0 stands for the
    /// shear force at rest (for the rate-dependent part see [`StageFriction`](super::newton::StageFriction)):
    ///
    ///   m q² ẍ + m κ ẋ² (s + σμ) - (1 - σμs) f_x - (s + σμ) f_z + σ A τ_0 q = 0
    #[inline(always)]
    pub(super) fn residual(&self, mass: f64, forces: ByAxis<f64>) -> f64 {
        // R of [6], term by term; it vanishes at the solution of the stage.
        let centripetal = self.kappa * self.velocity * self.velocity * self.share_z;
        mass * (self.q2 * self.acceleration + centripetal) - self.share_x * forces.x - self.share_z * forces.z
            + self.sigma_shear * self.q
    }

    /// The derivative of the residual by the stage's ẋ; those of f_x and f_z are minus the `weights`.
    #[inline(always)]
    pub(super) fn derivative(&self, model: &Model, beta: f64, forces: ByAxis<f64>, weights: ByAxis<f64>) -> f64 {
        let Self { s, kappa, velocity: v, share_z, .. } = *self;
        // [7]: ∂x/∂ẋ = β, so ∂s/∂ẋ = βκ and ∂κ/∂ẋ = βz'''.
        let ds = beta * kappa;
        // [8], its first line: the inertia, with ẍ = (ẋ - ẋ*)/β, along a profile that bends.
        let inertia = self.q2 / beta
            + 2.0 * s * ds * self.acceleration
            + v * (beta * self.third * v * share_z + 2.0 * kappa * share_z + kappa * v * ds);
        // Its second line: the links, how their forces are shared out as s changes, and the constant shear force by q.
        model.mass * inertia
            + self.share_x * weights.x
            + share_z * weights.z
            + ds * (self.sigma_mu * forces.x - forces.z)
            + self.sigma_shear * s * ds / self.q
    }

    /// m q² δẍ for a variation `by` of its motion and of the links' `forces` on it: from
    ///
    ///   m q² ẍ = (1 - σμs) f_x + (s + σμ) f_z - m κ ẋ² (s + σμ) - σ A τ_0 q - σ q B(σ q ẋ),
    ///
    /// with B the rate-dependent friction in excess of that at rest. This is the residual's derivative again, by
    /// direction and with ẍ as the unknown. Friction itself changes by `of_past` (N) with what the past has left.
    pub(in crate::integrator) fn variation(
        &self,
        model: &Model,
        forces: ByAxis<f64>,
        by: &SlipVariation,
        friction: &SlipFriction,
        of_past: f64,
    ) -> f64 {
        let Self { s, kappa, velocity: v, share_x, share_z, .. } = *self;
        // The mass moves along the profile: δs = κ δx and δκ = z''' δx.
        let (ds, dkappa) = (kappa * by.x, self.third * by.x);
        // δ[κ ẋ² S], and B by [9] for δẋ and s δs.
        let centripetal = dkappa * v * v * share_z + 2.0 * kappa * v * by.velocity * share_z + kappa * v * v * ds;
        let of_rate =
            if model.friction.depends_on_speed() { self.rate_variation(friction, by.velocity, s * ds) } else { 0.0 };
        // -δR of [16]: the terms of [6] one by one, with ẍ held.
        share_x * by.forces.x + share_z * by.forces.z + ds * (forces.z - self.sigma_mu * forces.x)
            - model.mass * (centripetal + 2.0 * s * ds * self.acceleration)
            - self.sigma_shear * s * ds / self.q
            - of_rate
            - self.sigma * self.q * of_past
    }

    /// δF_N (N) and δv_t (m/s) for a variation `by` of its motion and of the links' `forces` on it, from
    /// F_N = (m κ ẋ² - f_z + s f_x)/q and v_t = q ẋ.
    pub(in crate::integrator) fn contact_variation(
        &self,
        mass: f64,
        forces: ByAxis<f64>,
        by: &SlipVariation,
    ) -> ContactVariation {
        let Self { s, kappa, third, velocity: v, q, .. } = *self;
        // δs = κ δx, and q δq = s δs.
        let (ds, dq) = (kappa * by.x, s * kappa * by.x / q);
        // F_N of (9), and the variation of its numerator less F_N δq, over q.
        let normal = (mass * kappa * v * v - forces.z + s * forces.x) / q;
        let centripetal = mass * (third * by.x * v * v + 2.0 * kappa * v * by.velocity);
        ContactVariation {
            normal: (centripetal - by.forces.z + s * by.forces.x + ds * forces.x - normal * dq) / q,
            speed: q * by.velocity + dq * v,
        }
    }

    /// δ[σ q B(σ q ẋ)] for δẋ and s δs, with B the excess of the `friction` over that at rest.
    fn rate_variation(&self, friction: &SlipFriction, v_x: f64, s_ds: f64) -> f64 {
        // [9]: q δq = s δs, and δv_t = σ (q δẋ + ẋ δq).
        self.sigma * friction.excess * s_ds / self.q + friction.by_speed * (self.q2 * v_x + self.velocity * s_ds)
    }

    /// [9]: what the rate-dependent `friction` adds to the [derivative](Self::derivative) at a stage with this β.
    pub(super) fn rate_derivative(&self, friction: &SlipFriction, beta: f64) -> f64 {
        // δẋ = 1, so s δs = s βκ.
        self.rate_variation(friction, 1.0, self.s * beta * self.kappa)
    }

    /// The factors with which the forces on the mass enter its equation: 1 - σμs and S = s + σμ.
    #[inline(always)]
    pub(super) fn shares(&self) -> ByAxis<f64> {
        ByAxis { x: self.share_x, z: self.share_z }
    }

    /// σ q, by which a change of ẋ is one of the speed in the direction of slip.
    #[inline(always)]
    pub(super) fn speed_by_velocity(&self) -> f64 {
        self.sigma * self.q
    }

    /// σ v_t, m/s: the speed in the direction of slip.
    #[inline(always)]
    pub(super) fn slip_speed(&self) -> f64 {
        self.sigma * self.speed()
    }

    /// v_t = q ẋ, m/s.
    pub(in crate::integrator) fn speed(&self) -> f64 {
        self.q * self.velocity
    }

    /// q² = 1 + s².
    pub(in crate::integrator) fn q2(&self) -> f64 {
        self.q2
    }

    /// How its height follows its ẋ at a stage with this β.
    #[inline(always)]
    pub(super) fn climb(&self, beta: f64) -> ContactJacobian {
        // [7]
        ContactJacobian { height: beta * self.s, rate: self.s + beta * self.kappa * self.velocity }
    }
}

/// The factors with which the forces f_x, f_z on a mass enter its two equations.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct RowShares {
    /// f_x in the first equation.
    pub x_by_x: f64,
    /// f_z in the first equation: of a contact, by its slope.
    pub x_by_z: f64,
    /// f_z in the second equation.
    pub z_by_z: f64,
}

/// The derivatives of the lateral forces on a neighbour by a mass's two unknowns.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct NeighbourWeights {
    /// ∂f_x/∂ẋ.
    pub x: f64,
    /// ∂f_z/∂ẋ: of a mass that slips up a slope.
    pub z_by_x: f64,
    /// ∂f_z/∂ż.
    pub z: f64,
}

impl RowShares {
    /// The block beside the diagonal: the derivative of this row by the neighbour's unknowns.
    #[inline(always)]
    pub(super) fn coupling(&self, column: &NeighbourWeights) -> Matrix2<f64> {
        // How this row takes up forces, times how they follow the neighbour's unknowns; no link couples f_x to ż.
        Matrix2::new(
            -(self.x_by_x * column.x + self.x_by_z * column.z_by_x),
            -(self.x_by_z * column.z),
            -(self.z_by_z * column.z_by_x),
            -(self.z_by_z * column.z),
        )
    }
}

/// The friction of a slipping mass at the velocities of the last residuals, where the law is not linear. Its value at rest
/// belongs to the equation of [`SlippingMass`] already.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct StageFriction {
    pub friction: SlipFriction,
    /// The derivative of the equation by ẋ without its excess over that at rest, kg/s.
    pub derivative_without: f64,
}

/// The largest of all numbers; NaN where one is not finite. For use with vector instructions.
#[inline(always)]
pub(super) fn largest_of(values: &[Vector2<f64>]) -> f64 {
    // A comparison ignores NaN, the sum does not.
    let greater = |a: f64, b: f64| if a > b { a } else { b };
    let (mut largest, mut sum) = ([Vector2::zeros(); LANES], [Vector2::zeros(); LANES]);
    let mut take = |lane: usize, value: &Vector2<f64>| {
        largest[lane] = value.abs().zip_map(&largest[lane], greater);
        sum[lane] += value;
    };
    let (chunks, rest) = values.as_chunks::<LANES>();
    for chunk in chunks {
        (0..LANES).for_each(|lane| take(lane, &chunk[lane]));
    }
    rest.iter().for_each(|value| take(0, value));
    let largest = largest.iter().fold(0.0, |most, of_lane| greater(of_lane.x, greater(of_lane.y, most)));
    if sum.iter().sum::<Vector2<f64>>().sum().is_finite() { largest } else { f64::NAN }
}

/// Masses taken together, so that the operations on one do not wait for those on the one before.
const LANES: usize = 4;
