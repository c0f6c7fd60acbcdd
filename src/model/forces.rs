//! The links (springs, dampers and Maxwell elements in parallel) and their forces at one instant.

use super::spatial::{ElementSquares, SpatialMeasure};
use super::{CarrierPoint, LinkLaw, Model, State};
use crate::math::{add_weighted_sum, sum};
use crate::scene::{Axis, ByAxis, ByLink, LinkKind};

/// Forces of the links at one instant.
#[derive(Clone, Debug, Default)]
pub struct Forces {
    /// Forces of the links by kind, N; empty where the scene has no such link.
    pub link: ByLink<Vec<f64>>,
    /// Elongation rates ė of the links by kind, m/s; empty where the scene has no such link.
    pub rate: ByLink<Vec<f64>>,
    /// f_x,i of all links on mass i, N (3).
    pub on_mass_x: Vec<f64>,
    /// f_z,i of all links on mass i, N (4).
    pub on_mass_z: Vec<f64>,
    /// What the links along z are measured by where that is their present spacing.
    pub spatial: Option<Box<SpatialMeasure>>,
}

impl Forces {
    /// Workspace for the forces of `model`.
    pub fn new(model: &Model) -> Self {
        let of_masses = || vec![0.0; model.masses()];
        let (link, rate) = (Self::zeros_by_link(model), Self::zeros_by_link(model));
        let spatial = model.spatial.map(|rest| Box::new(SpatialMeasure::new(model, rest)));
        Self { link, rate, on_mass_x: of_masses(), on_mass_z: of_masses(), spatial }
    }

    /// A zero for each link of `model` by kind; none of a kind that it has not.
    pub fn zeros_by_link(model: &Model) -> ByLink<Vec<f64>> {
        ByLink::from_fn(|kind| vec![0.0; if model.has_link[kind] { kind.count(model.masses()) } else { 0 }])
    }

    /// f_x and f_z on mass `i`, N.
    #[inline(always)]
    pub fn on_mass(&self, i: usize) -> ByAxis<f64> {
        ByAxis { x: self.on_mass_x[i], z: self.on_mass_z[i] }
    }

    /// Evaluates the forces in `state` with the carrier's rates.
    pub fn evaluate(&mut self, model: &Model, state: &State, carrier: &CarrierPoint) {
        let motion = LinkMotion::new(state, carrier);
        for kind in LinkKind::ALL {
            self.spring_and_damper(kind, &model.links[kind], &motion);
            model.subtract_frozen(kind, &mut self.link[kind]);
        }
        for kind in LinkKind::ALL {
            let elements = model.rows_of(kind).map(|row| (row.stiffness, &state.maxwell[row.range.clone()]));
            add_weighted_sum(&mut self.link[kind], elements);
        }
        self.measure_state(model, state);
        self.sum_on_masses();
        add_ends(&mut self.on_mass_x, carrier.ends.map(|end| end.x));
        add_ends(&mut self.on_mass_z, carrier.ends.map(|end| end.z));
    }

    /// Brings the links along z, evaluated by their laws, into spatial measure in `state`.
    fn measure_state(&mut self, model: &Model, state: &State) {
        let Some(measure) = &mut self.spatial else { return };
        measure.set_spacing(&state.elongation_x);
        measure.set_energies(model, state);
        measure.measure(&mut self.link);
    }

    /// The same where they were evaluated by a stage's laws; `squares` are those of their elements.
    pub fn measure_stage(
        &mut self,
        model: &Model,
        state: &State,
        carrier: &CarrierPoint,
        squares: &[ElementSquares; 2],
    ) {
        let Some(measure) = &mut self.spatial else { return };
        measure.set_spacing(&state.elongation_x);
        let motion = (&state.elongation_z[..], &state.velocity_z[..], carrier.z.speed);
        measure.set_energies_at_stage(model, motion, squares);
        measure.measure(&mut self.link);
        self.sum_on_masses();
    }

    /// Brings variations of the links' forces, evaluated by their laws, into the spatial `measure`, and sums them up: `x`
    /// (m) are the variations of positions, `energies` (J) those of twice the energies by the laws.
    pub fn vary_measure(&mut self, measure: &SpatialMeasure, x: &[f64], energies: &[Vec<f64>; 2]) {
        measure.vary_links(x, &mut self.link);
        self.sum_on_masses();
        measure.add_varied_tensions(x, energies, &mut self.on_mass_x);
    }

    /// Evaluates ė and the force by its `law` of every link of a kind.
    pub fn spring_and_damper(&mut self, kind: LinkKind, law: &LinkLaw, motion: &LinkMotion<'_>) {
        motion.elongation_rates(kind, &mut self.rate[kind]);
        let (elongation, _, _) = motion.along(kind);
        let links = self.link[kind].iter_mut().zip(&self.rate[kind]);
        if kind.is_lateral() {
            let elongations = elongation.iter().zip(&elongation[1..]);
            links.zip(elongations).for_each(|((force, rate), (e, e_next))| *force = law.force(e_next - e, *rate));
        } else {
            links.zip(elongation).for_each(|((force, rate), e)| *force = law.force(*e, *rate));
        }
    }

    /// Evaluates the forces of all links by these `laws`, with the forces `known` added, and their sums on the masses,
    /// but not ė. Only links that the scene does not have are without `known` forces (N).
    #[inline(always)]
    pub fn evaluate_with(&mut self, laws: &ByLink<LinkLaw>, motion: &LinkMotion<'_>, known: &ByLink<Vec<f64>>) {
        let [vertical, horizontal, lateral_x, lateral_z] = &mut self.link.0;
        let axis = |carrier: LinkKind, lateral: LinkKind| AxisForces {
            motion: motion.along(carrier),
            ends: motion.ends.map(|end| end[carrier.axis()]),
            to_carrier: (laws[carrier], &known[carrier]),
            lateral: (laws[lateral], &known[lateral]),
        };
        axis(LinkKind::Horizontal, LinkKind::LateralX).evaluate(horizontal, lateral_x, &mut self.on_mass_x);
        axis(LinkKind::Vertical, LinkKind::LateralZ).evaluate(vertical, lateral_z, &mut self.on_mass_z);
    }

    /// f_x,i = -F_x,i + F_lx,i - F_lx,i-1, and alike along z (3), (4).
    pub fn sum_on_masses(&mut self) {
        let [vertical, horizontal, lateral_x, lateral_z] = &self.link.0;
        sum_on_masses(&mut self.on_mass_x, horizontal, lateral_x);
        sum_on_masses(&mut self.on_mass_z, vertical, lateral_z);
        if let Some(measure) = &self.spatial {
            measure.add_tensions(&mut self.on_mass_x);
        }
    }

    /// Evaluates the forces of the links of mass `i`, and the sums on it and on its neighbours, anew.
    pub fn refresh(&mut self, model: &Model, state: &State, carrier: &CarrierPoint, i: usize) {
        // Its position measures the links of its neighbours.
        if self.spatial.is_some() {
            return self.evaluate(model, state, carrier);
        }
        let k = model.masses();
        let motion = LinkMotion::new(state, carrier);
        for kind in LinkKind::ALL {
            for link in kind.links_on(i, k).filter(|_| model.has_link[kind]) {
                self.refresh_link(model, state, &motion, kind, link);
            }
        }
        for i in i.saturating_sub(1)..(i + 2).min(k) {
            let [vertical, horizontal, lateral_x, lateral_z] = &self.link.0;
            let of_end = carrier.on_end(i, k);
            self.on_mass_x[i] = sum_on_mass(i, horizontal, lateral_x) + of_end.x;
            self.on_mass_z[i] = sum_on_mass(i, vertical, lateral_z) + of_end.z;
        }
    }

    /// Updates the dampers' forces on mass `i` and on its neighbours for a change of its velocity by `change`, m/s.
    pub fn add_velocity(&mut self, model: &Model, i: usize, change: ByAxis<f64>) {
        for kind in LinkKind::ALL.into_iter().filter(|&kind| model.has_link[kind]) {
            let by = model.links[kind].damping * change[kind.axis()];
            let measure = self.spatial.as_deref().filter(|_| !kind.is_along_x());
            let measured = |link: usize| measure.map_or(by, |measure| by * measure.factor(kind, link));
            let force = &mut self.link[kind];
            let on_mass = if kind.is_along_x() { &mut self.on_mass_x } else { &mut self.on_mass_z };
            if i < force.len() {
                let (by, sign) = (measured(i), if kind.is_lateral() { -1.0 } else { 1.0 });
                force[i] += sign * by;
                on_mass[i] -= by;
            }
            if kind.is_lateral() && i < force.len() {
                on_mass[i + 1] += measured(i);
            }
            if kind.is_lateral() && i > 0 {
                let by = measured(i - 1);
                force[i - 1] += by;
                on_mass[i - 1] += by;
                on_mass[i] -= by;
            }
        }
    }

    fn refresh_link(&mut self, model: &Model, state: &State, motion: &LinkMotion<'_>, kind: LinkKind, link: usize) {
        let (elongation, velocity, carrier_rate) = motion.along(kind);
        let (e, rate) = (kind.difference(elongation, 0.0, link), kind.difference(velocity, carrier_rate, link));
        let elements = model.element_force(kind, |row| state.maxwell[row.range.start + link]);
        self.link[kind][link] = model.links[kind].force(e, rate) + elements - model.frozen_force(kind, link);
    }

    /// F_x or F_z of the layer on the carrier, N. F_z is positive when the layer is compressed (e > 0, the masses are
    /// nearer to the carrier than at rest).
    pub fn on_carrier(&self, axis: Axis) -> f64 {
        sum(&self.link[axis.link()])
    }
}

/// Elongations of the carrier links and velocities, from which the elongations of all links and their rates follow.
#[derive(Clone, Copy, Debug)]
pub struct LinkMotion<'a> {
    /// Elongations of the links to the carrier, m.
    pub elongation: ByAxis<&'a [f64]>,
    /// Velocities of the masses, m/s.
    pub velocity: ByAxis<&'a [f64]>,
    /// u̇ and ẇ, m/s.
    pub carrier_rate: ByAxis<f64>,
    /// [`CarrierPoint::ends`], N.
    pub ends: [ByAxis<f64>; 2],
}

impl<'a> LinkMotion<'a> {
    /// The motion in `state` under a carrier with these rates.
    pub fn new(state: &'a State, carrier: &CarrierPoint) -> Self {
        Self {
            elongation: ByAxis { x: &state.elongation_x, z: &state.elongation_z },
            velocity: ByAxis { x: &state.velocity_x, z: &state.velocity_z },
            carrier_rate: carrier.rates(),
            ends: carrier.ends,
        }
    }

    /// Writes ė of the links of a kind, m/s; `rate` is empty where the scene has no such link.
    #[inline(always)]
    pub fn elongation_rates(&self, kind: LinkKind, rate: &mut [f64]) {
        let (_, velocity, carrier_rate) = self.along(kind);
        if kind.is_lateral() {
            let pairs = velocity.iter().zip(&velocity[1..]);
            rate.iter_mut().zip(pairs).for_each(|(rate, (v, v_next))| *rate = v_next - v);
        } else {
            rate.iter_mut().zip(velocity).for_each(|(rate, v)| *rate = v - carrier_rate);
        }
    }

    #[inline(always)]
    fn along(&self, kind: LinkKind) -> (&'a [f64], &'a [f64], f64) {
        let axis = kind.axis();
        (self.elongation[axis], self.velocity[axis], self.carrier_rate[axis])
    }
}

/// What the forces of the links along x or z follow from.
struct AxisForces<'a> {
    /// Elongations of the links to the carrier (m), velocities of the masses and of the carrier (m/s).
    motion: (&'a [f64], &'a [f64], f64),
    /// What acts on the first and on the last mass from beyond a part of a layer, N.
    ends: [f64; 2],
    /// The law of the links to the carrier, and their known forces, N.
    to_carrier: (LinkLaw, &'a [f64]),
    /// The law of the lateral links, and their known forces, N.
    lateral: (LinkLaw, &'a [f64]),
}

impl AxisForces<'_> {
    /// Writes the forces of the links to the carrier, of the lateral links, and the sums on the masses, N.
    #[inline(always)]
    fn evaluate(&self, to_carrier: &mut [f64], lateral: &mut [f64], on_mass: &mut [f64]) {
        self.set_lateral(lateral);
        let k = on_mass.len();
        if to_carrier.is_empty() || lateral.is_empty() {
            self.set_to_carrier(to_carrier);
            sum_on_masses(on_mass, to_carrier, lateral);
            return add_ends(on_mass, self.ends);
        }
        self.set_to_carrier(&mut to_carrier[..1]);
        (on_mass[0], on_mass[k - 1]) = (lateral[0] - to_carrier[0], -lateral[k - 2]);
        let (elongation, velocity, carrier_rate) = self.motion;
        let (law, known) = self.to_carrier;
        let between = lateral.iter().zip(&lateral[1..]);
        let masses = elongation[1..].iter().zip(&velocity[1..]).zip(&known[1..]);
        let inner = on_mass[1..].iter_mut().zip(&mut to_carrier[1..]).zip(masses.zip(between));
        for ((sum, force), (((e, v), known), (left, right))) in inner {
            *force = law.force(*e, v - carrier_rate) + known;
            *sum = (right - left) - *force;
        }
        let last = law.force(elongation[k - 1], velocity[k - 1] - carrier_rate) + known[k - 1];
        to_carrier[k - 1] = last;
        on_mass[k - 1] -= last;
        add_ends(on_mass, self.ends);
    }

    #[inline(always)]
    fn set_to_carrier(&self, force: &mut [f64]) {
        let ((elongation, velocity, carrier_rate), (law, known)) = (self.motion, self.to_carrier);
        for ((force, (e, v)), known) in force.iter_mut().zip(elongation.iter().zip(velocity)).zip(known) {
            *force = law.force(*e, v - carrier_rate) + known;
        }
    }

    #[inline(always)]
    fn set_lateral(&self, force: &mut [f64]) {
        let ((elongation, velocity, _), (law, known)) = (self.motion, self.lateral);
        let elongations = elongation.iter().zip(&elongation[1..]);
        let pairs = elongations.zip(velocity.iter().zip(&velocity[1..]));
        for ((force, ((e, e_next), (v, v_next))), known) in force.iter_mut().zip(pairs).zip(known) {
            *force = law.force(e_next - e, v_next - v) + known;
        }
    }
}

#[inline(always)]
fn sum_on_masses(sum: &mut [f64], to_carrier: &[f64], lateral: &[f64]) {
    let Some((last, first)) = lateral.last().zip(lateral.first()) else {
        return negate(sum, to_carrier);
    };
    let between = lateral.iter().zip(&lateral[1..]);
    let inner = sum[1..].iter_mut();
    if to_carrier.is_empty() {
        inner.zip(between).for_each(|(sum, (left, right))| *sum = right - left);
    } else {
        let links = between.zip(&to_carrier[1..]);
        inner.zip(links).for_each(|(sum, ((left, right), force))| *sum = (right - left) - force);
    }
    let of_carrier = |i: usize| to_carrier.get(i).copied().unwrap_or(0.0);
    sum[0] = first - of_carrier(0);
    sum[lateral.len()] = -of_carrier(lateral.len()) - last;
}

/// Adds the forces on the first and on the last mass, N.
#[inline(always)]
fn add_ends(on_mass: &mut [f64], ends: [f64; 2]) {
    if let [first, ..] = on_mass {
        *first += ends[0];
    }
    if let [.., last] = on_mass {
        *last += ends[1];
    }
}

/// sum = -forces, or 0 where there are none.
#[inline(always)]
fn negate(sum: &mut [f64], forces: &[f64]) {
    if forces.is_empty() {
        sum.fill(0.0);
    } else {
        sum.iter_mut().zip(forces).for_each(|(sum, force)| *sum = -force);
    }
}

fn sum_on_mass(i: usize, to_carrier: &[f64], lateral: &[f64]) -> f64 {
    let of = |link: Option<&f64>| link.copied().unwrap_or(0.0);
    of(lateral.get(i)) - of(to_carrier.get(i)) - if i > 0 { of(lateral.get(i - 1)) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Jet;

    const SCENE: &str = "name = 'a'
        layer = { masses = 4, spacing = 1.0, mass = 1.0,
                  vertical = { stiffness = 2.0, damping = 0.7, maxwell = [{ stiffness = 3.0, relaxation_time = 0.2 },
                                                                        { stiffness = 5.0, relaxation_time = 1e9 }] },
                  lateral_x = { stiffness = 1.0, damping = 0.3 },
                  lateral_z = { stiffness = 1.0, maxwell = [{ stiffness = 1.5, relaxation_time = 1e9 }] } }
        surface = { kind = 'sinusoid', amplitude = 0.1, wavelength = 3.0 }
        solver = { reduce = 1e-3 }
        excitation = [{ duration = 1.0 }]";

    /// A carrier that moves with these rates (m/s).
    fn moving(x: f64, z: f64) -> CarrierPoint {
        let at = |speed| Jet { speed, ..Jet::default() };
        CarrierPoint { x: at(x), z: at(z), ..CarrierPoint::default() }
    }

    /// With dashpots that are frozen where the profile has lifted the masses to.
    #[test]
    fn refreshed_forces_are_those_evaluated_anew() {
        let mut model = Model::from_text(SCENE);
        model.freeze_dashpots(ByAxis { x: 0.0, z: -0.3 });
        assert!(model.frozen_stiffness.0 == [5.0, 0.0, 0.0, 1.5] && model.frozen[1] > 0.1);
        let mut state = State::new(&model);
        let carrier = moving(0.2, -0.1);
        let mut refreshed = Forces::new(&model);
        refreshed.evaluate(&model, &state, &carrier);
        for i in 0..model.masses() {
            let x = i as f64;
            (state.elongation_x[i], state.elongation_z[i]) = (0.1 * x, 0.3 - 0.05 * x * x);
            (state.velocity_x[i], state.velocity_z[i]) = (0.3 - x, x * x);
            state.maxwell[i] = 0.02 * x;
            refreshed.refresh(&model, &state, &carrier, i);
        }
        let mut evaluated = Forces::new(&model);
        evaluated.evaluate(&model, &state, &carrier);
        let all =
            |forces: &Forces| [forces.on_mass_x.clone(), forces.on_mass_z.clone(), forces.link.0.concat()].concat();
        for (found, expected) in all(&refreshed).iter().zip(all(&evaluated)) {
            assert!((found - expected).abs() < 1e-13, "{refreshed:?} {evaluated:?}");
        }
    }

    /// Layers of one mass to four, with the forces of the Maxwell elements and of the frozen dashpots as the known
    /// ones.
    #[test]
    fn forces_with_given_laws_are_those_evaluated() {
        let horizontal = SCENE.replace("lateral_x =", "horizontal = { stiffness = 4.0, damping = 0.2 },\n lateral_x =");
        for text in [1, 2, 4]
            .into_iter()
            .flat_map(|k| [SCENE, &horizontal].map(|scene| scene.replace("masses = 4", &format!("masses = {k}"))))
        {
            let mut model = Model::from_text(&text);
            model.freeze_dashpots(ByAxis { x: 0.0, z: -0.3 });
            let mut state = State::new(&model);
            let number = |i: usize| (i as f64).sin();
            for i in 0..model.masses() {
                (state.elongation_x[i], state.elongation_z[i]) = (number(i), number(i + 10));
                (state.velocity_x[i], state.velocity_z[i]) = (number(i + 20), number(i + 30));
            }
            (0..state.maxwell.len()).for_each(|i| state.maxwell[i] = number(i + 40));
            let carrier = moving(0.2, -0.1);
            let (mut expected, mut found) = (Forces::new(&model), Forces::new(&model));
            expected.evaluate(&model, &state, &carrier);

            let mut known = Forces::new(&model).link;
            for kind in LinkKind::ALL {
                let elements = model.rows_of(kind).map(|row| (row.stiffness, &state.maxwell[row.range.clone()]));
                add_weighted_sum(&mut known[kind], elements);
                model.subtract_frozen(kind, &mut known[kind]);
            }
            let motion = LinkMotion::new(&state, &carrier);
            found.evaluate_with(&model.links, &motion, &known);
            for kind in LinkKind::ALL {
                motion.elongation_rates(kind, &mut found.rate[kind]);
            }
            assert_eq!(found.rate, expected.rate);
            let all =
                |forces: &Forces| [forces.on_mass_x.clone(), forces.on_mass_z.clone(), forces.link.0.concat()].concat();
            for (a, b) in all(&found).iter().zip(all(&expected)) {
                // A few roundings of numbers of some tens.
                assert!((a - b).abs() < 1e-13, "{text}: {found:?} {expected:?}");
            }
        }
    }
}
