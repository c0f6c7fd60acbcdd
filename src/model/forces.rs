//! Forces of the links and of the contacts at one instant.

use super::{CarrierPoint, LinkKind, MaxwellRow, Mode, Model, State, SurfacePoint};
use crate::math::sum_of;

/// Forces at one instant, and workspace for them.
#[derive(Clone, Debug, Default)]
pub struct Forces {
    /// Forces of the links by kind, N; empty where the scene has no such link.
    pub link: [Vec<f64>; 4],
    /// Elongation rates ė of the links by kind, m/s; empty where the scene has no such link.
    pub rate: [Vec<f64>; 4],
    /// f_x,i of all links on mass i, N (3).
    pub on_mass_x: Vec<f64>,
    /// f_z,i of all links on mass i, N (4).
    pub on_mass_z: Vec<f64>,
}

impl Forces {
    /// Room for the forces of `model`.
    pub fn new(model: &Model) -> Self {
        let k = model.masses();
        let workspace = |kind: LinkKind| if model.links[kind as usize].present { kind.count(k) } else { 0 };
        let by_kind = || LinkKind::ALL.map(|kind| vec![0.0; workspace(kind)]);
        Self { link: by_kind(), rate: by_kind(), on_mass_x: vec![0.0; k], on_mass_z: vec![0.0; k] }
    }

    /// The forces in `state` under the carrier's rates.
    pub fn evaluate(&mut self, model: &Model, state: &State, carrier: &CarrierPoint) {
        let motion = LinkMotion::of(state, carrier);
        for kind in LinkKind::ALL {
            let law = &model.links[kind as usize];
            self.spring_and_damper(kind, (law.stiffness, law.damping), &motion, &[]);
            model.subtract_frozen(kind, &mut self.link[kind as usize]);
        }
        for row in &model.rows {
            let elongations = &state.maxwell[row.range.clone()];
            for (force, a) in self.link[row.kind as usize].iter_mut().zip(elongations) {
                *force += row.stiffness * a;
            }
        }
        self.sum_on_masses();
    }

    /// ė and F = c e + d ė of every link of a kind, for (c, d), and with the forces `known` added, if any.
    pub fn spring_and_damper(&mut self, kind: LinkKind, law: (f64, f64), motion: &LinkMotion<'_>, known: &[f64]) {
        let (rate, force) = (&mut self.rate[kind as usize][..], &mut self.link[kind as usize][..]);
        if kind.is_lateral() {
            motion.pull_on_neighbours(kind, rate, force, law);
        } else {
            motion.pull_on_carrier(kind, rate, force, law);
        }
        for (force, known) in force.iter_mut().zip(known) {
            *force += known;
        }
    }

    /// f_x,i = -F_x,i + F_lx,i - F_lx,i-1, and alike along z (3), (4).
    pub fn sum_on_masses(&mut self) {
        let [vertical, horizontal, lateral_x, lateral_z] = &self.link;
        sum_on_masses(&mut self.on_mass_x, horizontal, lateral_x);
        sum_on_masses(&mut self.on_mass_z, vertical, lateral_z);
    }

    /// Computes the forces of the links of mass `i` afresh, and those on it and on its neighbours.
    pub fn refresh(&mut self, model: &Model, state: &State, carrier: &CarrierPoint, i: usize) {
        let k = model.masses();
        let motion = LinkMotion::of(state, carrier);
        for kind in LinkKind::ALL {
            let links = if kind.is_lateral() { i.saturating_sub(1)..(i + 1).min(k - 1) } else { i..i + 1 };
            for link in links.filter(|_| model.links[kind as usize].present) {
                self.refresh_link(model, state, &motion, kind, link);
            }
        }
        for i in i.saturating_sub(1)..(i + 2).min(k) {
            let [vertical, horizontal, lateral_x, lateral_z] = &self.link;
            self.on_mass_x[i] = sum_on_mass(i, horizontal, lateral_x);
            self.on_mass_z[i] = sum_on_mass(i, vertical, lateral_z);
        }
    }

    /// Follows a change of the velocity of mass `i` by (`dx`, `dz`), m/s: the dampers' forces on it and on its
    /// neighbours.
    pub fn add_velocity(&mut self, model: &Model, i: usize, (dx, dz): (f64, f64)) {
        for kind in LinkKind::ALL.into_iter().filter(|&kind| model.links[kind as usize].present) {
            let change = if kind.is_along_x() { dx } else { dz };
            let by = model.links[kind as usize].damping * change;
            let force = &mut self.link[kind as usize];
            let on_mass = if kind.is_along_x() { &mut self.on_mass_x } else { &mut self.on_mass_z };
            if i < force.len() {
                let sign = if kind.is_lateral() { -1.0 } else { 1.0 };
                force[i] += sign * by;
                on_mass[i] -= by;
            }
            if kind.is_lateral() && i < force.len() {
                on_mass[i + 1] += by;
            }
            if kind.is_lateral() && i > 0 {
                force[i - 1] += by;
                on_mass[i - 1] += by;
                on_mass[i] -= by;
            }
        }
    }

    fn refresh_link(&mut self, model: &Model, state: &State, motion: &LinkMotion<'_>, kind: LinkKind, link: usize) {
        let law = &model.links[kind as usize];
        let (place, velocity, carrier_rate) = motion.along(kind);
        let (e, rate) = if kind.is_lateral() {
            (place[link + 1] - place[link], velocity[link + 1] - velocity[link])
        } else {
            (place[link], velocity[link] - carrier_rate)
        };
        let element = |row: &MaxwellRow| row.stiffness * state.maxwell[row.range.start + link];
        let maxwell: f64 = model.rows_of(kind).map(element).sum();
        self.link[kind as usize][link] = law.stiffness * e + law.damping * rate + maxwell;
    }

    /// F_x of the layer on the carrier, N.
    pub fn on_carrier_x(&self) -> f64 {
        sum(&self.link[LinkKind::Horizontal as usize])
    }

    /// F_z of the layer on the carrier, N: positive when the layer is compressed.
    ///
    /// A compressed vertical link (e > 0: the mass is pushed up towards the carrier) pushes the carrier up.
    pub fn on_carrier_z(&self) -> f64 {
        sum(&self.link[LinkKind::Vertical as usize])
    }

    /// Bytes that the forces hold.
    pub fn bytes(&self) -> usize {
        let by_link: usize = self.link.iter().chain(&self.rate).map(Vec::len).sum();
        (by_link + self.on_mass_x.len() + self.on_mass_z.len()) * size_of::<f64>()
    }

    /// What the surface and the links do to mass `i`, which is in contact over `surface`.
    pub fn contact(&self, model: &Model, i: usize, velocity_x: f64, surface: &SurfacePoint) -> ContactForces {
        ContactForces::new(model, (self.on_mass_x[i], self.on_mass_z[i]), velocity_x, surface)
    }
}

/// Elongations and rates from which those of all links follow.
#[derive(Clone, Copy, Debug)]
pub struct LinkMotion<'a> {
    /// Elongations of the horizontal links, m.
    pub elongation_x: &'a [f64],
    /// Elongations of the vertical links, m.
    pub elongation_z: &'a [f64],
    /// Velocities of the masses along x, m/s.
    pub velocity_x: &'a [f64],
    /// Velocities of the masses along z, m/s.
    pub velocity_z: &'a [f64],
    /// u̇ and ẇ, m/s.
    pub carrier_rates: (f64, f64),
}

impl<'a> LinkMotion<'a> {
    /// The motion in `state` under a carrier with these rates.
    pub fn of(state: &'a State, carrier: &CarrierPoint) -> Self {
        Self {
            elongation_x: &state.elongation_x,
            elongation_z: &state.elongation_z,
            velocity_x: &state.velocity_x,
            velocity_z: &state.velocity_z,
            carrier_rates: (carrier.u_rate, carrier.w_rate),
        }
    }

    fn pull_on_carrier(&self, kind: LinkKind, rate: &mut [f64], force: &mut [f64], (stiffness, damping): (f64, f64)) {
        let (place, velocity, carrier_rate) = self.along(kind);
        for ((force, rate), (e, v)) in force.iter_mut().zip(rate).zip(place.iter().zip(velocity)) {
            *rate = v - carrier_rate;
            *force = stiffness * e + damping * *rate;
        }
    }

    fn pull_on_neighbours(
        &self,
        kind: LinkKind,
        rate: &mut [f64],
        force: &mut [f64],
        (stiffness, damping): (f64, f64),
    ) {
        let (place, velocity, _) = self.along(kind);
        let elongations = place.iter().zip(place.iter().skip(1));
        let rates = velocity.iter().zip(velocity.iter().skip(1));
        for ((force, rate), ((e, e_next), (v, v_next))) in force.iter_mut().zip(rate).zip(elongations.zip(rates)) {
            *rate = v_next - v;
            *force = stiffness * (e_next - e) + damping * *rate;
        }
    }

    fn along(&self, kind: LinkKind) -> (&'a [f64], &'a [f64], f64) {
        if kind.is_along_x() {
            (self.elongation_x, self.velocity_x, self.carrier_rates.0)
        } else {
            (self.elongation_z, self.velocity_z, self.carrier_rates.1)
        }
    }
}

fn sum(forces: &[f64]) -> f64 {
    sum_of(forces.len(), |i| forces[i])
}

fn sum_on_masses(sum: &mut [f64], to_carrier: &[f64], lateral: &[f64]) {
    if to_carrier.is_empty() {
        sum.fill(0.0);
    } else {
        for (sum, force) in sum.iter_mut().zip(to_carrier) {
            *sum = -force;
        }
    }
    if let (Some(first), Some(last)) = (lateral.first(), lateral.last()) {
        sum[0] += first;
        sum[lateral.len()] -= last;
    }
    for (sum, force) in sum.iter_mut().skip(1).zip(lateral.windows(2)) {
        *sum += force[1] - force[0];
    }
}

fn sum_on_mass(i: usize, to_carrier: &[f64], lateral: &[f64]) -> f64 {
    let of = |link: Option<&f64>| link.copied().unwrap_or(0.0);
    of(lateral.get(i)) - of(to_carrier.get(i)) - if i > 0 { of(lateral.get(i - 1)) } else { 0.0 }
}

/// The forces in one contact, from (6)-(9).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactForces {
    /// F_N of the surface on the mass, N.
    pub normal: f64,
    /// f·t = (f_x + s f_z)/q of the links, N.
    pub tangential: f64,
    /// T(0) = μ F_N + A τ_0 + A τ_f(v_c): the largest friction force at rest, N.
    pub limit: f64,
    /// q = √(1 + s²).
    pub q: f64,
}

impl ContactForces {
    /// Forces from those of the links on the mass, (f_x, f_z), its velocity ẋ and the surface under it.
    #[inline]
    pub fn new(model: &Model, (f_x, f_z): (f64, f64), velocity_x: f64, surface: &SurfacePoint) -> Self {
        let s = surface.slope;
        let q = (1.0 + s * s).sqrt();
        // From (6)-(9): the normal force needs no acceleration.
        let normal = (model.mass * surface.curvature * velocity_x * velocity_x - f_z + s * f_x) / q;
        let limit = model.friction_coefficient * normal + model.shear_force;
        Self { normal, tangential: (f_x + s * f_z) / q, limit, q }
    }

    /// F_T on a mass in `mode` at the velocity ẋ, N, counted against v_t: what holds a sticking mass, T(v_t) sign(v_t)
    /// of a slipping one.
    #[inline]
    pub fn friction(&self, model: &Model, mode: Mode, velocity_x: f64) -> f64 {
        match mode {
            Mode::Free => 0.0,
            Mode::Stick => self.tangential,
            Mode::Forward | Mode::Backward => {
                let sigma = mode.direction();
                let beyond = model.rate_shear.map_or(0.0, |shear| shear.excess(sigma * velocity_x * self.q));
                sigma * (self.limit + beyond)
            }
        }
    }

    /// ẍ of a mass in contact in `mode`: m q² ẍ + m s κ ẋ² = f_x + s f_z - F_T q.
    pub fn acceleration(&self, model: &Model, mode: Mode, velocity_x: f64, surface: &SurfacePoint) -> f64 {
        if mode == Mode::Stick {
            return 0.0;
        }
        let centripetal = surface.slope * surface.curvature * velocity_x * velocity_x;
        ((self.tangential - self.friction(model, mode, velocity_x)) / model.mass - centripetal / self.q) / self.q
    }
}
