//! Steady sliding under a pressure at a speed: contact, friction of its points, and the heat that it makes.

use super::contact::{Contact, ContactSolver};
use super::coupling::Coupling;
use super::flash::{MOST_STEPS, RubbingContact, SurfaceRise, WarmingContact, march};
use super::linear::{Compliance, scatter, viscous_losses};
use super::rubber::{SlidingContact, SlidingRubber, Slope};
use super::surface::SurfaceGrid;
use asperity::math::sum;

/// Steady sliding at one speed and pressure. Forces are over the mean pressure times the area of the whole surface.
#[derive(Clone, Debug)]
pub struct SteadySlide {
    /// Which points touch, and their pressures.
    pub contact: Contact,
    /// Points in contact over all, 1.
    pub area: f64,
    /// Friction coefficient by the slopes of the surface itself, 1.
    pub profile_hysteresis: f64,
    /// Friction coefficient by the waves that the surface lacks, 1; `None` where it lacks none that rub, it jams, or no
    /// contact was found.
    pub fine_hysteresis: Option<f64>,
    /// Friction coefficient by what acts in the contacts else, 1; `None` where it jams, or no contact was found.
    pub adhesion: Option<f64>,
    /// Friction coefficient by both kinds of slopes, 1; `None` where those that the surface lacks rub, and it jams, or no
    /// contact was found.
    pub hysteresis: Option<f64>,
    /// Area that touches with those waves over the whole, 1; `None` without them.
    pub real_area: Option<f64>,
    /// Mean flash temperature over the contact above that of the surface, K; `None` where friction heats nothing.
    pub flash_mean: Option<f64>,
    /// How much warmer the surface is than the rubber was before it slid, K; `None` where no way is given.
    pub surface_rise: Option<f64>,
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
    /// Points that touch on slopes so steep that Coulomb's friction presses them by more than it takes.
    pub jammed: usize,
    /// Whether tangential traction moves the surface along the normal by what is not known: on a layer of compressible rubber.
    pub lacks_coupling: bool,
}

/// The change of how traction moves the surface at the fixed point, over the rms height, and the most steps to it.
const COUPLING_ACCURACY: f64 = 1e-7;
const MOST_COUPLINGS: usize = 60;

impl SteadySlide {
    /// Whether the points that touch were found: else nothing of it can be relied on.
    pub fn is_found(&self) -> bool {
        self.contact.left_over == 0
    }

    /// Friction coefficient, 1; `None` where it jams, or no contact was found.
    pub fn friction(&self) -> Option<f64> {
        Some(self.profile_hysteresis + self.of_contacts()?)
    }

    /// The part of it by the contacts themselves, 1.
    pub fn of_contacts(&self) -> Option<f64> {
        Some(self.fine_hysteresis.unwrap_or(0.0) + self.adhesion?)
    }

    /// Why not all of its values can be relied on; `None` where they can.
    pub fn problem(&self) -> Option<SlideProblem> {
        match self.contact.left_over {
            0 if self.lacks_coupling => Some(SlideProblem::CompressibleLayer),
            0 if self.jammed > 0 => Some(SlideProblem::Jams { points: self.jammed }),
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
    /// Coulomb's friction presses contacts on steep slopes by more than it takes: there is no sliding.
    #[error("jams at {points} of the points in contact: Coulomb's friction on such slopes has no steady sliding")]
    Jams {
        /// [`SteadySlide::jammed`].
        points: usize,
    },
    /// The rubber is a bonded layer and compressible.
    #[error(
        "tangential traction lifts a bonded layer of a Poisson ratio below 0.48 by what is not known: take foundation = \
         \"half_space\", or a Poisson ratio from 0.48 on"
    )]
    CompressibleLayer,
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

/// The solver of steady sliding on a surface, with its memory. What it finds does not depend on what it found before.
#[derive(Debug)]
pub struct SteadySolver {
    solver: ContactSolver,
    /// Those of all points.
    slopes: Vec<Slope>,
}

/// Friction of the contacts of a surface.
#[derive(Clone, Debug, Default)]
struct Rubbed {
    /// At each point in contact; none where it is not known.
    points: Vec<SlidingContact>,
    /// Over all of them.
    sums: SlidingContact,
    flash_mean: Option<f64>,
    surface_rise: Option<f64>,
    heat_converged: bool,
    jammed: usize,
}

impl SteadySolver {
    /// The solver on a surface.
    pub fn new(surface: SurfaceGrid) -> Self {
        let mut solver = ContactSolver::new(surface.clone());
        let slopes = Slope::all(&surface, solver.convolution());
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

    /// Steady sliding to +x at `speed` (m/s) under the mean `pressure`, Pa, on a surface as warm as the scene.
    pub fn slide(&mut self, rubber: &SlidingRubber, speed: f64, pressure: f64) -> SteadySlide {
        self.slide_over(rubber, speed, pressure, None)
    }

    /// [`slide`](Self::slide) of rubber that was as warm as the scene before it slid over a `way` (m); `None`: whose surface is.
    pub fn slide_over(&mut self, rubber: &SlidingRubber, speed: f64, pressure: f64, way: Option<f64>) -> SteadySlide {
        let (contact, compliance) = self.solver.solve(&rubber.material, |q| rubber.body.normal(q), speed, pressure);
        let rubbed = self.rub(rubber, speed, &contact, way);
        let (contact, rubbed) = match rubber.coupling() {
            Some(factor) => self.coupled(rubber, (speed, pressure, way), (contact, rubbed), &compliance, factor),
            None => (contact, rubbed),
        };
        let normal_stiffness = self.solver.stiffness(&compliance, &contact);
        let tangential_stiffness = self.tangential_stiffness(rubber, speed, &contact, normal_stiffness);
        let viscous_share = self.viscous_share(rubber, speed, &contact, &compliance);

        // Means over the surface, of which contacts are `share` each.
        let surface = self.solver.surface();
        let share = surface.share_of_point();
        let points = || contact.points.iter().zip(&contact.pressures);
        let drag: f64 = points().map(|(&point, p)| p * self.slopes[point as usize].along).sum();
        let coefficient = |sum: f64| share * sum / pressure;
        let is_found = contact.left_over == 0;
        let slides = is_found && rubbed.jammed == 0 && !rubber.lacks_coupling();
        let profile_hysteresis = coefficient(drag);
        let fine_hysteresis = (slides && rubber.fine_rubs).then_some(coefficient(rubbed.sums.hysteresis));
        SteadySlide {
            area: contact.area(surface),
            profile_hysteresis,
            fine_hysteresis,
            adhesion: slides.then_some(coefficient(rubbed.sums.friction - rubbed.sums.hysteresis)),
            hysteresis: (slides || is_found && !rubber.fine_rubs)
                .then_some(profile_hysteresis + fine_hysteresis.unwrap_or(0.0)),
            real_area: (slides && rubber.has_fine).then_some(share * rubbed.sums.share),
            flash_mean: rubbed.flash_mean,
            surface_rise: rubbed.surface_rise,
            viscous_share,
            normal_stiffness,
            tangential_stiffness,
            has_friction: rubber.has_friction,
            heat_converged: rubbed.heat_converged,
            jammed: rubbed.jammed,
            lacks_coupling: rubber.lacks_coupling(),
            contact,
        }
    }

    /// The contact that was found without it, with what tangential traction does along the normal: a fixed point.
    fn coupled(
        &mut self,
        rubber: &SlidingRubber,
        (speed, pressure, way): (f64, f64, Option<f64>),
        (mut contact, mut rubbed): (Contact, Rubbed),
        compliance: &Compliance,
        factor: f64,
    ) -> (Contact, Rubbed) {
        let surface = self.solver.surface().clone();
        let accuracy = COUPLING_ACCURACY * surface.rms_height() * (surface.size.points() as f64).sqrt();
        let mut coupling: Option<(Coupling, Compliance)> = None;
        let mut before = vec![0.0; self.slopes.len()];
        for _ in 0..MOST_COUPLINGS {
            if contact.left_over > 0 || rubbed.jammed > 0 {
                return (contact, rubbed);
            }
            let friction = rubbed.points.iter().map(|at| at.friction).chain(std::iter::repeat(0.0));
            let points = contact.points.iter().zip(&contact.pressures).zip(friction);
            let tractions: Vec<[f64; 2]> =
                points.map(|((&point, p), friction)| self.slopes[point as usize].traction(*p, friction)).collect();
            // The part of it that is as the pressure belongs to the linear problem.
            let (coupling, whole) = coupling.get_or_insert_with(|| {
                let mean = -tractions.iter().map(|traction| traction[0]).sum::<f64>() / sum(&contact.pressures);
                let coupling = Coupling::new(&surface, compliance, factor, mean);
                let whole = coupling.compliance(compliance, surface.share_of_point());
                (coupling, whole)
            });
            let moved = coupling.moved(&contact, &tractions, self.solver.convolution());
            let change: f64 = moved.iter().zip(&before).map(|(moved, before)| (moved - before).powi(2)).sum();
            let heights: Vec<f64> = surface.heights.iter().zip(&moved).map(|(height, moved)| height - moved).collect();
            contact = self.solver.solve_again(whole, &heights, &contact, pressure);
            rubbed = self.rub(rubber, speed, &contact, way);
            if change.sqrt() <= accuracy {
                return (contact, rubbed);
            }
            before = moved;
        }
        contact.left_over = contact.left_over.max(1);
        (contact, rubbed)
    }

    /// What friction does in a contact, and how warm that becomes.
    fn rub(&mut self, rubber: &SlidingRubber, speed: f64, contact: &Contact, way: Option<f64>) -> Rubbed {
        let slope = |point: &u32| &self.slopes[*point as usize];
        let jammed = contact.points.iter().filter(|point| rubber.jams(slope(point))).count();
        let mut rubbed = Rubbed { jammed, heat_converged: true, ..Rubbed::default() };
        if jammed > 0 || contact.left_over > 0 || !(rubber.has_friction || rubber.has_fine) {
            return rubbed;
        }
        let rises = self.warm(rubber, speed, contact, way, &mut rubbed);
        for (i, (point, &pressure)) in contact.points.iter().zip(&contact.pressures).enumerate() {
            let rise = rises.as_ref().map_or(0.0, |rises| rises[i]);
            let at = rubber.sliding(pressure, &self.slopes[*point as usize], speed, rise);
            rubbed.sums.friction += at.friction;
            rubbed.sums.hysteresis += at.hysteresis;
            rubbed.sums.share += at.share;
            rubbed.points.push(at);
        }
        rubbed
    }

    /// How warm the points in contact are above the scene, K; `None` where friction heats nothing.
    fn warm(
        &mut self,
        rubber: &SlidingRubber,
        speed: f64,
        contact: &Contact,
        way: Option<f64>,
        rubbed: &mut Rubbed,
    ) -> Option<Vec<f64>> {
        let heat = rubber.heat.as_ref()?;
        let surface = self.solver.surface().clone();
        let rubbing = RubbingContact { rubber, contact, slopes: &self.slopes, speed };
        let mut warming = WarmingContact::new(rubbing, heat, &surface, self.solver.convolution());
        let (warmth, rise) = match way {
            Some(way) => march(&mut warming, heat, speed, way),
            None => (warming.solve(SurfaceRise::default(), warming.cold(), MOST_STEPS), 0.0),
        };
        rubbed.heat_converged = warmth.is_solved;
        rubbed.flash_mean = Some(sum(&warmth.rises) / warmth.rises.len() as f64 - rise);
        rubbed.surface_rise = way.map(|_| rise);
        Some(warmth.rises)
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
        if surface.size.ny == 1 && rubber.is_bonded() {
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
}
