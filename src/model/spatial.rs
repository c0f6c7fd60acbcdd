//! Links along z in spatial measure (docs/foundation.md, section 8): each stands for the width that its masses have now,
//! not at rest.
//!
//! With ℓ_i = x_{i+1} - x_i, or Δx beyond the ends, a vertical link exerts L_i times and a lateral one along z R_i times
//! the force of its law,
//!
//!   L_i = (ℓ_{i-1} + ℓ_i)/2Δx,   R_i = Δx/ℓ_i,
//!
//! so that a layer strained along x keeps its stiffness per present length, as an incompressible half-space does. The
//! energies are measured alike, and their gradient along x is a force between neighbours,
//!
//!   T_i = (V_i + V_{i+1})/4Δx - Δx V_l,i/2ℓ_i²,   V = Σ c (e - y)²,
//!
//! which pushes mass i along x and pulls mass i + 1 back.

use super::{LinkKind, LinkLaw, MaxwellRow, Model, State};
use crate::scene::ByLink;

/// The least ℓ over Δx. Closer masses are drawn together by what presses on them, without end: an incompressible surface
/// folds at 0.54 (M. A. Biot, Appl. Sci. Res. A 12, 1963, 168).
const LEAST_SPACING: f64 = 0.1;

/// The measure at one instant, and what it makes of the links.
#[derive(Clone, Debug, Default)]
pub struct SpatialMeasure {
    /// Δx, m.
    rest: f64,
    /// ℓ_i, m.
    spacing: Vec<f64>,
    /// The links along z, vertical and lateral.
    links: [MeasuredLinks; 2],
}

/// The links of one kind by their law alone, as at rest.
#[derive(Clone, Debug, Default)]
struct MeasuredLinks {
    /// F, N.
    force: Vec<f64>,
    /// V = Σ c (e - y)², twice the energy, J.
    energy: Vec<f64>,
    /// ∂V/∂e with the Maxwell elements held, N.
    by_elongation: Vec<f64>,
    /// ∂V/∂ė at a stage of a step, by its elements, N s; 0 elsewhere.
    by_rate: Vec<f64>,
}

/// Σ w a² of the Maxwell elements of a link at a stage, as a polynomial of its ė.
#[derive(Clone, Debug, Default)]
pub struct ElementSquares {
    /// Its value at ė = 0, by link.
    constant: Vec<f64>,
    /// Half its derivative there.
    linear: Vec<f64>,
    /// The factor of ė², the same of all links.
    square: f64,
}

impl ElementSquares {
    /// Of no elements of so many links.
    pub fn new(links: usize) -> Self {
        Self { constant: vec![0.0; links], linear: vec![0.0; links], square: 0.0 }
    }

    /// Takes all elements out.
    pub fn clear(&mut self) {
        self.constant.fill(0.0);
        self.linear.fill(0.0);
        self.square = 0.0;
    }

    /// Adds an element of each link with the elongation `known` + `gain` ė by its `weight`.
    pub fn add(&mut self, weight: f64, known: &[f64], gain: f64) {
        for ((constant, linear), known) in self.constant.iter_mut().zip(&mut self.linear).zip(known) {
            *constant += weight * known * known;
            *linear += weight * known * gain;
        }
        self.square += weight * gain * gain;
    }

    /// The value at the `rate` of a link, m/s.
    pub fn at(&self, link: usize, rate: f64) -> f64 {
        self.constant[link] + rate * (2.0 * self.linear[link] + rate * self.square)
    }

    /// The derivative there.
    pub fn slope(&self, link: usize, rate: f64) -> f64 {
        2.0 * (self.linear[link] + rate * self.square)
    }
}

/// A variation of a mass: of its position along x, of its elongation along z and of the rate of that.
#[derive(Clone, Copy, Debug, Default)]
pub struct MeasuredMotion {
    /// δx.
    pub x: f64,
    /// δe_z.
    pub z: f64,
    /// δė_z.
    pub rate_z: f64,
}

/// The variation of the forces on a mass along x, but those of the links along x, and along z.
pub type Varied = [f64; 2];

impl SpatialMeasure {
    /// The links that are measured, those along z.
    pub const LINKS: [LinkKind; 2] = [LinkKind::Vertical, LinkKind::LateralZ];

    /// Workspace for `model`, whose links along z are in spatial measure.
    pub(super) fn new(model: &Model, rest: f64) -> Self {
        let links = Self::LINKS.map(|kind| MeasuredLinks::zeros(kind.count(model.masses())));
        Self { rest, spacing: vec![rest; model.masses() - 1], links }
    }

    /// Copies `other`, that of the same model, without allocating.
    pub(crate) fn copy_from(&mut self, other: &Self) {
        self.spacing.copy_from_slice(&other.spacing);
        for (mine, theirs) in self.links.iter_mut().zip(&other.links) {
            mine.force.copy_from_slice(&theirs.force);
            mine.energy.copy_from_slice(&theirs.energy);
            mine.by_elongation.copy_from_slice(&theirs.by_elongation);
            mine.by_rate.copy_from_slice(&theirs.by_rate);
        }
    }

    /// ℓ_i, or Δx beyond the ends.
    fn length(&self, i: Option<usize>) -> f64 {
        i.and_then(|i| self.spacing.get(i)).copied().unwrap_or(self.rest)
    }

    /// L_i or R_i of a link along z.
    pub fn factor(&self, kind: LinkKind, link: usize) -> f64 {
        match kind {
            LinkKind::Vertical => (self.length(link.checked_sub(1)) + self.length(Some(link))) / (2.0 * self.rest),
            _ => self.rest / self.spacing[link],
        }
    }

    /// Whether all masses are as far apart as links in spatial measure bear.
    pub fn is_borne(&self) -> bool {
        self.spacing.iter().all(|&spacing| spacing > LEAST_SPACING * self.rest)
    }

    /// T_i, N.
    fn tension(&self, i: usize) -> f64 {
        let [vertical, lateral] = &self.links;
        (vertical.energy[i] + vertical.energy[i + 1]) / (4.0 * self.rest)
            - 0.5 * self.rest * lateral.energy[i] / (self.spacing[i] * self.spacing[i])
    }

    pub(super) fn set_spacing(&mut self, elongation_x: &[f64]) {
        let pairs = elongation_x.iter().zip(&elongation_x[1..]);
        self.spacing.iter_mut().zip(pairs).for_each(|(spacing, (e, next))| *spacing = self.rest + (next - e));
    }

    /// Sets the energies of the links in `state`.
    pub(super) fn set_energies(&mut self, model: &Model, state: &State) {
        for (kind, links) in Self::LINKS.into_iter().zip(&mut self.links) {
            for link in 0..links.energy.len() {
                let e = kind.difference(&state.elongation_z, 0.0, link);
                links.set_spring(model, kind, link, e);
                links.energy[link] += model.element_force(kind, |row| state.maxwell[row.range.start + link].powi(2));
            }
        }
    }

    /// Sets the energies of the links at a stage with these elongations along z (m) and velocities of the masses and of
    /// the carrier (m/s).
    pub(super) fn set_energies_at_stage(
        &mut self,
        model: &Model,
        (elongation, velocity, carrier): (&[f64], &[f64], f64),
        squares: &[ElementSquares; 2],
    ) {
        for ((kind, links), squares) in Self::LINKS.into_iter().zip(&mut self.links).zip(squares) {
            for link in 0..links.energy.len() {
                links.set_spring(model, kind, link, kind.difference(elongation, 0.0, link));
                let rate = kind.difference(velocity, carrier, link);
                links.energy[link] += squares.at(link, rate);
                links.by_rate[link] = squares.slope(link, rate);
            }
        }
    }

    /// Takes over the forces of the links by their laws and makes those in spatial measure of them.
    pub(super) fn measure(&mut self, forces: &mut ByLink<Vec<f64>>) {
        for (n, kind) in Self::LINKS.into_iter().enumerate() {
            // A layer may have no such links.
            self.links[n].force.iter_mut().zip(&forces[kind]).for_each(|(mine, force)| *mine = *force);
            forces[kind].iter_mut().enumerate().for_each(|(link, force)| *force *= self.factor(kind, link));
        }
    }

    /// Adds T to the forces on the masses along x, N.
    pub(super) fn add_tensions(&self, on_mass_x: &mut [f64]) {
        for i in 0..self.spacing.len() {
            let tension = self.tension(i);
            on_mass_x[i] += tension;
            on_mass_x[i + 1] -= tension;
        }
    }
}

/// Variations, from which Jacobian and tangents follow.
impl SpatialMeasure {
    /// ∂L_i/∂ℓ F_i, N/m.
    fn force_by_length(&self, i: usize) -> f64 {
        self.links[0].force[i] / (2.0 * self.rest)
    }

    /// What `motion` of mass i or i + 1 makes of T_i by V_i or V_{i+1}.
    fn by_vertical(&self, mass: usize, motion: &MeasuredMotion) -> f64 {
        self.links[0].energy_change(mass, motion) / (4.0 * self.rest)
    }

    /// What mass i + 1 makes of T_i by its lateral link: -Δx V_l,i/2ℓ_i² varied. Mass i makes the opposite.
    fn by_lateral(&self, i: usize, motion: &MeasuredMotion) -> f64 {
        self.lateral_tension_change(i, motion.x, self.links[1].energy_change(i, motion))
    }

    /// δ(-Δx V_l,i/2ℓ_i²), N, where ℓ_i changes by `length` (m) and V_l,i by `energy` (J).
    fn lateral_tension_change(&self, i: usize, length: f64, energy: f64) -> f64 {
        let spacing = self.spacing[i];
        self.rest / (spacing * spacing) * (self.links[1].energy[i] / spacing * length - 0.5 * energy)
    }

    /// δ(R_i F_i), N, where ℓ_i changes by `length` (m) and F_i by `force` (N).
    fn lateral_force_change(&self, i: usize, length: f64, force: f64) -> f64 {
        self.factor(LinkKind::LateralZ, i) * (force - self.links[1].force[i] / self.spacing[i] * length)
    }

    /// What mass i + 1 makes of the force of its lateral link to mass i by the `law`: R_i F_i varied. Mass i makes the
    /// opposite.
    fn of_lateral(&self, law: &LinkLaw, i: usize, motion: &MeasuredMotion) -> f64 {
        self.lateral_force_change(i, motion.x, law.force(motion.z, motion.rate_z))
    }

    /// How the forces on mass `i` follow its own `motion` under the laws of the links.
    pub fn on_itself(&self, laws: &ByLink<LinkLaw>, i: usize, motion: &MeasuredMotion) -> Varied {
        let last = self.spacing.len();
        let (left, right) = (i.checked_sub(1), (i < last).then_some(i));
        let lengthens = f64::from(i8::from(left.is_some()) - i8::from(right.is_some()));
        let own = self.factor(LinkKind::Vertical, i) * laws[LinkKind::Vertical].force(motion.z, motion.rate_z);
        let mut on_mass = [0.0, -own - lengthens * self.force_by_length(i) * motion.x];
        if let Some(right) = right {
            on_mass[0] += self.by_vertical(i, motion) - self.by_lateral(right, motion);
            on_mass[1] -= self.of_lateral(&laws[LinkKind::LateralZ], right, motion);
        }
        if let Some(left) = left {
            on_mass[0] -= self.by_vertical(i, motion) + self.by_lateral(left, motion);
            on_mass[1] -= self.of_lateral(&laws[LinkKind::LateralZ], left, motion);
        }
        on_mass
    }

    /// How the forces on mass `i` follow the `motion` of the next one.
    pub fn by_next(&self, laws: &ByLink<LinkLaw>, i: usize, motion: &MeasuredMotion) -> Varied {
        let along_z = self.of_lateral(&laws[LinkKind::LateralZ], i, motion) - self.force_by_length(i) * motion.x;
        [self.by_vertical(i + 1, motion) + self.by_lateral(i, motion), along_z]
    }

    /// How the forces on mass `i` follow the `motion` of the one before.
    pub fn by_previous(&self, laws: &ByLink<LinkLaw>, i: usize, motion: &MeasuredMotion) -> Varied {
        let along_z = self.of_lateral(&laws[LinkKind::LateralZ], i - 1, motion) + self.force_by_length(i) * motion.x;
        [-self.by_vertical(i - 1, motion) + self.by_lateral(i - 1, motion), along_z]
    }

    /// How the forces on mass `i` follow a `motion` that all links to the carrier have.
    pub fn by_carrier(&self, laws: &ByLink<LinkLaw>, i: usize, motion: &MeasuredMotion) -> Varied {
        let last = self.spacing.len();
        let tension = |i: usize| self.by_vertical(i, motion) + self.by_vertical(i + 1, motion);
        let along_x = if i < last { tension(i) } else { 0.0 } - if i > 0 { tension(i - 1) } else { 0.0 };
        let own = self.factor(LinkKind::Vertical, i) * laws[LinkKind::Vertical].force(motion.z, motion.rate_z);
        [along_x, -own]
    }

    /// How F_z on the carrier follows the `motion` of mass `i`.
    pub fn on_carrier(&self, laws: &ByLink<LinkLaw>, i: usize, motion: &MeasuredMotion) -> f64 {
        let last = self.spacing.len();
        let own = self.factor(LinkKind::Vertical, i) * laws[LinkKind::Vertical].force(motion.z, motion.rate_z);
        // L of a link grows with the spacings on both sides of it.
        let of = |link: usize| self.force_by_length(link) + self.force_by_length(link + 1);
        let left = if i > 0 { of(i - 1) } else { 0.0 };
        let right = if i < last { of(i) } else { 0.0 };
        own + (left - right) * motion.x
    }

    /// Makes of the variations of the links' forces by their laws those in spatial measure: `x` (m) are the variations of
    /// positions.
    pub(super) fn vary_links(&self, x: &[f64], forces: &mut ByLink<Vec<f64>>) {
        let varied = |i: usize| x[i + 1] - x[i];
        let beside = |i: Option<usize>| i.filter(|&i| i + 1 < x.len()).map_or(0.0, varied);
        let [vertical, .., lateral] = &mut forces.0;
        for (i, force) in vertical.iter_mut().enumerate() {
            *force = self.factor(LinkKind::Vertical, i) * *force
                + self.force_by_length(i) * (beside(i.checked_sub(1)) + beside(Some(i)));
        }
        for (i, force) in lateral.iter_mut().enumerate() {
            *force = self.lateral_force_change(i, varied(i), *force);
        }
    }

    /// Adds what T changes by to the forces on the masses along x: `energies` (J) are the variations of V.
    pub(super) fn add_varied_tensions(&self, x: &[f64], energies: &[Vec<f64>; 2], on_mass_x: &mut [f64]) {
        for i in 0..self.spacing.len() {
            let vertical = (energies[0][i] + energies[0][i + 1]) / (4.0 * self.rest);
            let tension = vertical + self.lateral_tension_change(i, x[i + 1] - x[i], energies[1][i]);
            on_mass_x[i] += tension;
            on_mass_x[i + 1] -= tension;
        }
    }

    /// Writes the variations of V, J: by those of the links' elongations (m) and rates (m/s), which are `None` where the
    /// elements' elongations are varied in whole, and by `of_element`, the variation of an element's elongation at its index
    /// in the state (m).
    pub(crate) fn vary_energies(
        &self,
        model: &Model,
        (elongation, rates): (&[f64], Option<&ByLink<Vec<f64>>>),
        state: &State,
        of_element: impl Fn(&MaxwellRow, usize) -> f64,
        energies: &mut [Vec<f64>; 2],
    ) {
        for ((kind, links), energies) in Self::LINKS.into_iter().zip(&self.links).zip(energies) {
            for (link, energy) in energies.iter_mut().enumerate() {
                let rate_z = rates.and_then(|rates| rates[kind].get(link).copied()).unwrap_or(0.0);
                let motion = MeasuredMotion { x: 0.0, z: kind.difference(elongation, 0.0, link), rate_z };
                let of_row = |row: &MaxwellRow| {
                    2.0 * state.maxwell[row.range.start + link] * of_element(row, row.range.start + link)
                };
                *energy = links.energy_change(link, &motion) + model.element_force(kind, of_row);
            }
        }
    }
}

impl MeasuredLinks {
    fn zeros(count: usize) -> Self {
        let zeros = || vec![0.0; count];
        Self { force: zeros(), energy: zeros(), by_elongation: zeros(), by_rate: zeros() }
    }

    /// Sets V of the spring of a link with the elongation `e`, m.
    fn set_spring(&mut self, model: &Model, kind: LinkKind, link: usize, e: f64) {
        let frozen = model.frozen_force(kind, link);
        let stretched = model.links[kind].stiffness * e - frozen;
        self.by_elongation[link] = 2.0 * stretched;
        self.by_rate[link] = 0.0;
        self.energy[link] = (stretched - frozen) * e;
        if frozen != 0.0 {
            self.energy[link] += frozen * model.frozen_dashpot(kind, link);
        }
    }

    fn energy_change(&self, link: usize, motion: &MeasuredMotion) -> f64 {
        self.by_elongation[link] * motion.z + self.by_rate[link] * motion.rate_z
    }
}

impl Model {
    /// The factor of a link's force and energies by its measure, for the elongations of the horizontal links (m): L_i or
    /// R_i along z in spatial measure, 1 elsewhere.
    pub fn measure(&self, kind: LinkKind, link: usize, elongation_x: &[f64]) -> f64 {
        let Some(rest) = self.spatial else { return 1.0 };
        let longer = |i: usize| elongation_x[i + 1] - elongation_x[i];
        let beside = |i: Option<usize>| i.filter(|&i| i + 1 < elongation_x.len()).map_or(0.0, longer);
        match kind {
            LinkKind::Vertical => 1.0 + 0.5 * (beside(link.checked_sub(1)) + beside(Some(link))) / rest,
            LinkKind::LateralZ => rest / (rest + longer(link)),
            _ => 1.0,
        }
    }

    /// The first of two neighbours in `state` that links in spatial measure hardly keep apart, if there are any.
    pub fn folded(&self, state: &State) -> Option<usize> {
        let rest = self.spatial?;
        let pairs = state.elongation_x.windows(2);
        pairs.into_iter().position(|pair| rest + (pair[1] - pair[0]) < 2.0 * LEAST_SPACING * rest)
    }

    /// Whether links of this kind are in spatial measure.
    pub fn is_measured(&self, kind: LinkKind) -> bool {
        self.spatial.is_some() && !kind.is_along_x()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::in_tests::assert_within;
    use crate::math::Jet;
    use crate::model::{CarrierPoint, Forces, elastic_energy};
    use crate::scene::{Axis, ByAxis};

    const SCENE: &str = "name = 'a'
        layer = { kinematics = 'spatial', masses = 4, spacing = 1.0, mass = 1.0,
                  vertical = { stiffness = 2.0, damping = 0.7, maxwell = [{ stiffness = 3.0, relaxation_time = 0.2 }] },
                  horizontal = { stiffness = 1.5 }, lateral_x = { stiffness = 1.0, damping = 0.3 },
                  lateral_z = { stiffness = 1.0, damping = 0.4, maxwell = [{ stiffness = 1.5, relaxation_time = 1.0 }] } }
        surface = { kind = 'sinusoid', amplitude = 0.1, wavelength = 3.0 }";
    /// Central differences over this err by its square, some 1e-8 of forces of 1, and by rounding over it.
    const STEP: f64 = 1e-4;
    const ALLOWED: f64 = 1e-7;

    fn strained(model: &Model) -> State {
        let mut state = State::new(model);
        for i in 0..model.masses() {
            let x = i as f64;
            (state.elongation_x[i], state.elongation_z[i]) = (0.1 * x - 0.06 * x * x, 0.3 - 0.05 * x * x);
            (state.velocity_x[i], state.velocity_z[i]) = (0.3 - x, 0.2 * x * x);
        }
        state.maxwell.iter_mut().enumerate().for_each(|(n, a)| *a = 0.1 - 0.03 * n as f64);
        state
    }

    fn forces(model: &Model, state: &State, carrier: &CarrierPoint) -> Forces {
        let mut forces = Forces::new(model);
        forces.evaluate(model, state, carrier);
        forces
    }

    /// With dampers at rest, and dashpots that stand still: a moves with e.
    #[test]
    fn forces_are_the_gradient_of_the_energy() {
        let model = Model::from_text(SCENE);
        let mut state = strained(&model);
        state.velocity_x.fill(0.0);
        state.velocity_z.fill(0.0);
        let forces = forces(&model, &state, &CarrierPoint::default());
        let energy = |i: usize, by: ByAxis<f64>| {
            let mut moved = state.clone();
            // No time for the dashpots to follow.
            moved.displace(&model, i, by, 0.0);
            elastic_energy(&model, &moved)
        };
        for i in 0..model.masses() {
            for axis in Axis::ALL {
                let by = |h: f64| ByAxis::from_fn(|along| if along == axis { h } else { 0.0 });
                let slope = (energy(i, by(STEP)) - energy(i, by(-STEP))) / (2.0 * STEP);
                assert_within(forces.on_mass(i)[axis], -slope, ALLOWED);
            }
        }
    }

    /// By each mass's position, height and its rate, and by the carrier's, with the elements held.
    #[test]
    fn variations_are_those_of_a_difference_quotient() {
        let model = Model::from_text(SCENE);
        let (state, carrier) = (strained(&model), CarrierPoint::default());
        let here = forces(&model, &state, &carrier);
        let measure = here.spatial.as_ref().unwrap();
        let along_x = |i: usize, forces: &Forces| {
            let [_, horizontal, lateral, _] = &forces.link.0;
            let of = |link: Option<usize>| link.and_then(|link| lateral.get(link)).unwrap_or(&0.0);
            forces.on_mass_x[i] - (of(Some(i)) - of(i.checked_sub(1)) - horizontal[i])
        };
        for j in 0..model.masses() {
            for n in 0..3 {
                let unit = |m: usize| f64::from(u8::from(n == m));
                let motion = MeasuredMotion { x: unit(0), z: unit(1), rate_z: unit(2) };
                let moved = |h: f64| {
                    let mut moved = state.clone();
                    moved.elongation_x[j] += h * motion.x;
                    moved.elongation_z[j] += h * motion.z;
                    moved.velocity_z[j] += h * motion.rate_z;
                    forces(&model, &moved, &carrier)
                };
                let (up, down) = (moved(STEP), moved(-STEP));
                let quotient = |of: &dyn Fn(&Forces) -> f64| (of(&up) - of(&down)) / (2.0 * STEP);
                for i in j.saturating_sub(1)..(j + 2).min(model.masses()) {
                    let found = match i.cmp(&j) {
                        std::cmp::Ordering::Less => measure.by_next(&model.links, i, &motion),
                        std::cmp::Ordering::Equal => measure.on_itself(&model.links, i, &motion),
                        std::cmp::Ordering::Greater => measure.by_previous(&model.links, i, &motion),
                    };
                    assert_within(found[0], quotient(&|forces| along_x(i, forces)), ALLOWED);
                    assert_within(found[1], quotient(&|forces| forces.on_mass_z[i]), ALLOWED);
                }
                let found = measure.on_carrier(&model.links, j, &motion);
                assert_within(found, quotient(&|forces| forces.on_carrier(Axis::Z)), ALLOWED);
            }
        }
        let lowered = |h: f64| {
            let mut moved = state.clone();
            moved.elongation_z.iter_mut().for_each(|e| *e -= h);
            let carrier = CarrierPoint { z: Jet { speed: h, ..Jet::default() }, ..carrier };
            forces(&model, &moved, &carrier)
        };
        let (up, down) = (lowered(STEP), lowered(-STEP));
        for i in 0..model.masses() {
            let found = measure.by_carrier(&model.links, i, &MeasuredMotion { x: 0.0, z: -1.0, rate_z: -1.0 });
            for (found, of) in
                found.iter().zip([&up.on_mass_x, &up.on_mass_z].iter().zip([&down.on_mass_x, &down.on_mass_z]))
            {
                assert_within(*found, (of.0[i] - of.1[i]) / (2.0 * STEP), ALLOWED);
            }
        }
    }
}
