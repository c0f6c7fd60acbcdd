//! Steady sliding under a pressure at a speed: contact, friction of its points, and the heat that it makes.

use super::compliance::{Compliance, viscous_losses};
use super::contact::{Contact, ContactSolver};
use super::heat::HeatResponse;
use super::krylov::Gmres;
use super::linear::{gather, scatter};
use super::surface::SurfaceGrid;
use asperity::math::{dot, sum};
use asperity::model::{FrictionLaw, SlipHistory};
use asperity::scene::{ElasticBody, Material, Scene};

/// Rubber at a temperature: what slides. It serves every surface, speed and pressure.
#[derive(Clone, Debug)]
pub struct SlidingRubber {
    material: Material,
    body: ElasticBody,
    friction: FrictionLaw,
    /// The area that the law of friction is for, m².
    element_area: f64,
    heat: Option<HeatResponse>,
    /// Whether contacts have friction of their own.
    has_friction: bool,
    /// Whether there are waves that the profile lacks, and whether they rub.
    has_fine: bool,
    fine_rubs: bool,
}

/// A contact of a point, per area of the surface.
#[derive(Clone, Copy, Debug, Default)]
struct SlidingContact {
    /// T/A, Pa.
    friction: f64,
    /// The part of that by the waves that the surface lacks, Pa.
    hysteresis: f64,
    /// A_r/A, 1.
    share: f64,
    /// ∂(T/A)/∂ϑ, Pa/K.
    by_flash: f64,
}

/// Steady sliding at one speed and pressure. Forces are over the mean pressure times the area of the whole surface.
#[derive(Clone, Debug)]
pub struct SteadySlide {
    /// Which points touch, and their pressures.
    pub contact: Contact,
    /// Points in contact over all, 1.
    pub area: f64,
    /// Friction coefficient by the slopes of the surface itself, 1.
    pub profile_hysteresis: f64,
    /// Friction coefficient by the waves that the surface lacks, 1; `None` where it lacks none that rub.
    pub fine_hysteresis: Option<f64>,
    /// Friction coefficient by what acts in the contacts else, 1.
    pub adhesion: f64,
    /// Area that touches with those waves over the whole, 1; `None` without them.
    pub real_area: Option<f64>,
    /// Mean flash temperature over the contact, K; `None` where friction heats nothing.
    pub flash_mean: Option<f64>,
    /// The part of the surface's own hysteresis that the material's viscosity takes, 1; `None` where it has none.
    pub viscous_share: Option<f64>,
    /// |dp/dd| of the contact, Pa/m; `None` of full contact.
    pub normal_stiffness: Option<f64>,
    /// The same of displacements along the sliding, Pa/m.
    pub tangential_stiffness: Option<f64>,
    /// Whether contacts have friction of their own.
    pub has_friction: bool,
    /// Whether the flash temperature came to its fixed point.
    pub heat_converged: bool,
}

impl SteadySlide {
    /// Friction coefficient, 1.
    pub fn friction(&self) -> f64 {
        self.profile_hysteresis + self.fine_hysteresis.unwrap_or(0.0) + self.adhesion
    }

    /// Why not all of its values can be relied on; `None` where they can.
    pub fn problem(&self) -> Option<SlideProblem> {
        match self.contact.left_over {
            0 if !self.heat_converged => Some(SlideProblem::HeatNotConverged),
            0 if self.contact.is_full => Some(SlideProblem::FullContact),
            0 if self.tangential_stiffness.is_none() => Some(SlideProblem::SinglePoint),
            0 => None,
            left_over => Some(SlideProblem::ContactNotFound { left_over }),
        }
    }
}

/// Why not all values of a slide can be relied on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SlideProblem {
    /// No set of points in contact was found: `left_over` are on the wrong side.
    #[error("{left_over} points of the surface are pulled or lie below it")]
    ContactNotFound {
        /// [`Contact::left_over`].
        left_over: usize,
    },
    /// The flash temperature did not come to its fixed point.
    #[error("the flash temperature does not come to rest")]
    HeatNotConverged,
    /// All points touch, so the contact has no stiffness.
    #[error("full contact")]
    FullContact,
    /// One point touches, so the contact has no stiffness.
    #[error("no stiffness: a single point is in contact")]
    SinglePoint,
}

impl SlideProblem {
    /// Whether friction and area are a result all the same.
    pub fn is_result(self) -> bool {
        self == Self::FullContact
    }
}

/// Accuracy of ϑ over its largest.
const FLASH_ACCURACY: f64 = 1.0e-5;
/// The most steps for it, and the most iterations of one.
const MOST_STEPS: usize = 400;
const MOST_ITERATIONS: usize = 40;
/// The accuracy of a step over the residual.
const STEP_ACCURACY: f64 = 0.05;
/// Time steps are such that no contact changes by more than this in one, K.
const USUAL_STEP: f64 = 10.0;

/// The solver of steady sliding on a surface, with its memory. What it finds does not depend on what it found before.
#[derive(Debug)]
pub struct SteadySolver {
    solver: ContactSolver,
    /// ∂h/∂x at all points.
    slopes: Vec<f64>,
}

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

    /// What a contact under a pressure (Pa) does at a speed (m/s) and a flash temperature, K.
    fn sliding(&self, pressure: f64, speed: f64, flash: f64) -> SlidingContact {
        let at = self.friction.slip(pressure * self.element_area, speed, &SlipHistory::even(flash));
        let per_area = 1.0 / self.element_area;
        SlidingContact {
            friction: per_area * at.force(),
            hysteresis: per_area * at.hysteresis,
            share: at.share,
            by_flash: per_area * at.by_flash,
        }
    }

    /// The factor of the normal stiffness of a contact that gives the tangential one: R. D. Mindlin's of a half-space; of
    /// ridges, which move along without shearing, 1.
    fn tangential_factor(&self, surface: &SurfaceGrid) -> f64 {
        let nu = self.material.poisson_ratio;
        if surface.size.ny > 1 { 2.0 * (1.0 - nu) / (2.0 - nu) } else { 1.0 }
    }
}

impl SteadySolver {
    /// The solver on a surface.
    pub fn new(surface: SurfaceGrid) -> Self {
        let mut solver = ContactSolver::new(surface.clone());
        let slopes = surface.slopes(solver.convolution());
        Self { solver, slopes }
    }

    /// The surface.
    pub fn surface(&self) -> &SurfaceGrid {
        self.solver.surface()
    }

    /// The pairs of transforms so far, those of a coarser grid by its part of the points.
    pub fn pairs(&self) -> f64 {
        self.solver.pairs()
    }

    /// Steady sliding to +x at `speed` (m/s) under the mean `pressure`, Pa.
    pub fn slide(&mut self, rubber: &SlidingRubber, speed: f64, pressure: f64) -> SteadySlide {
        let (contact, compliance) = self.solver.solve(&rubber.material, |q| rubber.body.normal(q), speed, pressure);
        let normal_stiffness = self.solver.stiffness(&compliance, &contact);
        let tangential_stiffness = self.tangential_stiffness(rubber, speed, &contact, normal_stiffness);
        let viscous_share = self.viscous_share(rubber, speed, &contact, &compliance);
        let (flash, heat_converged) = self.flash(rubber, speed, &contact);

        // Means over the surface, of which contacts are `share` each.
        let surface = self.solver.surface();
        let share = surface.share_of_point();
        let points = || contact.points.iter().zip(&contact.pressures);
        let drag: f64 = points().map(|(&point, p)| p * self.slopes[point as usize]).sum();
        let mut sums = SlidingContact::default();
        if rubber.has_friction || rubber.has_fine {
            for (i, &p) in contact.pressures.iter().enumerate() {
                let at = rubber.sliding(p, speed, flash.as_ref().map_or(0.0, |flash| flash[i]));
                sums.friction += at.friction;
                sums.hysteresis += at.hysteresis;
                sums.share += at.share;
            }
        }
        let coefficient = |sum: f64| share * sum / pressure;
        SteadySlide {
            area: contact.area(surface),
            profile_hysteresis: coefficient(drag),
            fine_hysteresis: rubber.fine_rubs.then_some(coefficient(sums.hysteresis)),
            adhesion: coefficient(sums.friction - sums.hysteresis),
            real_area: rubber.has_fine.then_some(share * sums.share),
            flash_mean: flash.map(|flash| sum(&flash) / flash.len() as f64),
            viscous_share,
            normal_stiffness,
            tangential_stiffness,
            has_friction: rubber.has_friction,
            heat_converged,
            contact,
        }
    }

    /// Of a profile on a layer by the layer's stiffness against tangential waves, else by the normal one.
    fn tangential_stiffness(
        &mut self,
        rubber: &SlidingRubber,
        speed: f64,
        contact: &Contact,
        normal: Option<f64>,
    ) -> Option<f64> {
        let surface = self.solver.surface();
        if surface.size.ny == 1 && matches!(rubber.body, ElasticBody::Bonded { .. }) {
            let compliance = Compliance::new(surface, &rubber.material, |q| rubber.body.tangential(q), speed);
            return self.solver.stiffness(&compliance, contact);
        }
        Some(rubber.tangential_factor(surface) * normal?)
    }

    /// The part of the losses that the viscosity of the material takes.
    fn viscous_share(
        &mut self,
        rubber: &SlidingRubber,
        speed: f64,
        contact: &Contact,
        compliance: &Compliance,
    ) -> Option<f64> {
        rubber.material.viscosity?;
        let [of_viscosity, of_all] = viscous_losses(self.solver.surface(), &rubber.material, compliance, speed)
            .map(|kernel| self.quadratic(contact, &kernel));
        Some(if of_all > 0.0 { of_viscosity / of_all } else { 0.0 })
    }

    /// Σ_q |p_q|² times the kernel, but for a constant.
    fn quadratic(&mut self, contact: &Contact, kernel: &[f64]) -> f64 {
        let mut field = vec![0.0; self.slopes.len()];
        scatter(&contact.points, &contact.pressures, &mut field);
        self.solver.convolution().apply(&mut field, kernel);
        contact.points.iter().zip(&contact.pressures).map(|(&point, p)| p * field[point as usize]).sum()
    }

    /// The flash temperatures of the points in contact, K, and whether they are at their fixed point; `None` where friction
    /// heats nothing.
    ///
    /// Solves ϑ = κ * χ T(ϑ) v/A by pseudo-transient continuation: implicit steps of dϑ/dt = κ * χ T(ϑ) v/A - ϑ from
    /// ϑ = 0, each by Newton's method, with a time step δ that grows. Where a contact is so cold that friction rises with
    /// its temperature there are several solutions, and neither fixed-point iteration nor Newton's method alone converges.
    fn flash(&mut self, rubber: &SlidingRubber, speed: f64, contact: &Contact) -> (Option<Vec<f64>>, bool) {
        let Some(heat) = &rubber.heat else { return (None, true) };
        let kernel = heat.kernel(self.solver.surface(), speed);
        let mut field = vec![0.0; self.slopes.len()];
        let convolution = self.solver.convolution();
        let mut warmed = |power: &[f64], warmed: &mut [f64]| {
            scatter(&contact.points, power, &mut field);
            convolution.apply(&mut field, &kernel);
            gather(&contact.points, &field, warmed);
        };
        let count = contact.points.len();
        let mut now = FlashState::new(count);
        now.evaluate(rubber, speed, contact, &mut warmed);
        let (mut step, mut left, mut power) = (vec![0.0; count], vec![0.0; count], vec![0.0; count]);
        let (mut gmres, mut time_step) = (Gmres::default(), 1.0);
        for _ in 0..MOST_STEPS {
            if now.is_solved() {
                return (Some(now.flash), true);
            }
            // The step by how much is left: (1/δ + 1 - κ * χ T'(ϑ) v/A) step = residual.
            step.fill(0.0);
            left.copy_from_slice(&now.residual);
            let tolerance = STEP_ACCURACY * now.norm;
            gmres.solve(&mut step, &mut left, tolerance, MOST_ITERATIONS, |from, direction, image| {
                direction.copy_from_slice(from);
                power.iter_mut().zip(from.iter().zip(&now.by_flash)).for_each(|(power, (from, by))| *power = by * from);
                warmed(&power, image);
                image.iter_mut().zip(from).for_each(|(image, from)| *image = (1.0 + 1.0 / time_step) * from - *image);
            });
            now.flash.iter_mut().zip(&step).for_each(|(flash, step)| *flash += step);
            now.evaluate(rubber, speed, contact, &mut warmed);
            time_step *= (USUAL_STEP / largest(&step)).clamp(0.3, 3.0);
        }
        (Some(now.flash), false)
    }
}

/// Flash temperatures and what they lack of their fixed point.
#[derive(Debug)]
struct FlashState {
    /// ϑ, K.
    flash: Vec<f64>,
    /// κ * χ T(ϑ) v/A - ϑ, K.
    residual: Vec<f64>,
    /// Its Euclidean norm.
    norm: f64,
    /// T v/A, W/m², and its derivative by ϑ.
    power: Vec<f64>,
    by_flash: Vec<f64>,
}

impl FlashState {
    fn new(count: usize) -> Self {
        let zeros = || vec![0.0; count];
        Self { flash: zeros(), residual: zeros(), norm: 0.0, power: zeros(), by_flash: zeros() }
    }

    fn evaluate(
        &mut self,
        rubber: &SlidingRubber,
        speed: f64,
        contact: &Contact,
        warmed: &mut impl FnMut(&[f64], &mut [f64]),
    ) {
        for (i, (&p, &flash)) in contact.pressures.iter().zip(&self.flash).enumerate() {
            let at = rubber.sliding(p, speed, flash);
            (self.power[i], self.by_flash[i]) = (speed * at.friction, speed * at.by_flash);
        }
        warmed(&self.power, &mut self.residual);
        self.residual.iter_mut().zip(&self.flash).for_each(|(residual, flash)| *residual -= flash);
        self.norm = dot(&self.residual, &self.residual).sqrt();
    }

    /// Whether every ϑ is known to a part of the largest.
    fn is_solved(&self) -> bool {
        largest(&self.residual) <= FLASH_ACCURACY * largest(&self.flash)
    }
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |largest, value| value.abs().max(largest))
}
