//! Rates of change at one stage.

use crate::math::{Numbers, visit_all};
use crate::model::{CarrierPoint, ContactForces, Forces, LinkKind, MaxwellRow, Mode, Model, State, SurfacePoint};

/// What a stage leaves for the later ones, for the error estimate and for the events.
#[derive(Clone, Debug)]
pub struct Rates {
    /// ẋ_i, m/s.
    pub velocity_x: Vec<f64>,
    /// ż_i, m/s.
    pub velocity_z: Vec<f64>,
    /// ẍ_i, m/s²; 0 for a sticking mass.
    pub acceleration_x: Vec<f64>,
    /// z̈_i, m/s²; in contact along the surface, s ẍ + κ ẋ².
    pub acceleration_z: Vec<f64>,
    /// ȧ of all Maxwell elements, m/s.
    pub maxwell: Vec<f64>,
    /// Σ_j c_j ȧ_j by link, N/s; empty where a link has no Maxwell elements.
    pub maxwell_force: [Vec<f64>; 4],
    /// F_N of the masses in contact, N.
    pub normal: Vec<f64>,
    /// What is left before a contact changes its mode: σẋ (m/s) of a slipping mass, T - |f·t| (N) of a sticking one.
    pub margin: Vec<f64>,
}

impl Rates {
    /// Room for the rates of `model`.
    pub fn new(model: &Model) -> Self {
        let k = model.masses();
        let zero = vec![0.0; k];
        let room = |kind: LinkKind| {
            if model.rows.iter().any(|row| row.kind == kind) { vec![0.0; kind.count(k)] } else { Vec::new() }
        };
        Self {
            velocity_x: zero.clone(),
            velocity_z: zero.clone(),
            acceleration_x: zero.clone(),
            acceleration_z: zero.clone(),
            maxwell: vec![0.0; model.maxwell_variables()],
            maxwell_force: LinkKind::ALL.map(room),
            normal: zero.clone(),
            margin: zero,
        }
    }

    /// Takes over `other`, rates of the same model, without allocating.
    pub fn copy_from(&mut self, other: &Self) {
        let pairs = [
            (&mut self.velocity_x, &other.velocity_x),
            (&mut self.velocity_z, &other.velocity_z),
            (&mut self.acceleration_x, &other.acceleration_x),
            (&mut self.acceleration_z, &other.acceleration_z),
            (&mut self.maxwell, &other.maxwell),
            (&mut self.normal, &other.normal),
            (&mut self.margin, &other.margin),
        ];
        for (mine, theirs) in pairs {
            mine.copy_from_slice(theirs);
        }
        for (mine, theirs) in self.maxwell_force.iter_mut().zip(&other.maxwell_force) {
            mine.copy_from_slice(theirs);
        }
    }

    /// The rates that the forces give in `state`: the explicit first stage.
    pub fn evaluate(&mut self, model: &Model, state: &State, forces: &Forces) {
        for i in 0..model.masses() {
            let v = state.velocity_x[i];
            self.velocity_x[i] = v;
            self.velocity_z[i] = state.velocity_z[i];
            let (f_x, f_z) = (forces.on_mass_x[i], forces.on_mass_z[i]);
            let mode = state.mode[i];
            if mode == Mode::Free {
                self.acceleration_x[i] = f_x / model.mass;
                self.acceleration_z[i] = f_z / model.mass;
            } else {
                let ground = &state.ground[i];
                let contact = ContactForces::new(model, (f_x, f_z), v, ground);
                self.acceleration_x[i] = contact.acceleration(model, mode, v, ground);
                self.contact(i, mode, v, ground, &contact);
            }
        }
        self.evaluate_maxwell(model, state, forces);
    }

    /// What a contact at mass `i` leaves: its z̈ along the surface, F_N and the margin of its mode.
    #[inline]
    pub fn contact(&mut self, i: usize, mode: Mode, velocity_x: f64, ground: &SurfacePoint, contact: &ContactForces) {
        self.acceleration_z[i] = ground.slope * self.acceleration_x[i] + ground.curvature * velocity_x * velocity_x;
        self.normal[i] = contact.normal;
        self.margin[i] = match mode {
            Mode::Stick => contact.limit - contact.tangential.abs(),
            _ => mode.direction() * velocity_x,
        };
    }

    /// ȧ = ė - a/τ.
    fn evaluate_maxwell(&mut self, model: &Model, state: &State, forces: &Forces) {
        self.clear_maxwell_force();
        for row in &model.rows {
            let known = state.maxwell[row.range.clone()].iter().zip(&forces.rate[row.kind as usize]);
            let (rate, force_rate) = self.maxwell_row(row);
            for ((a, elongation_rate), (rate, force_rate)) in known.zip(rate.iter_mut().zip(force_rate)) {
                *rate = elongation_rate - a / row.relaxation_time;
                *force_rate += row.stiffness * *rate;
            }
        }
    }

    /// Begins the sums of [`maxwell_force`](Self::maxwell_force) anew.
    pub fn clear_maxwell_force(&mut self) {
        for force in &mut self.maxwell_force {
            force.fill(0.0);
        }
    }

    /// ȧ of one row of elements and the sum of its kind that they add to.
    pub fn maxwell_row(&mut self, row: &MaxwellRow) -> (&mut [f64], &mut [f64]) {
        (&mut self.maxwell[row.range.clone()], &mut self.maxwell_force[row.kind as usize])
    }

    /// Ḟ_x and Ḟ_z of the layer on the carrier, N/s: Ḟ = Σ c ė + d ë + Σ_j c_j ȧ_j over the links to it.
    pub fn on_carrier(&self, model: &Model, carrier: &CarrierPoint) -> (f64, f64) {
        let of = |kind: LinkKind, (velocity, rate): (&[f64], f64), (acceleration, rate_change): (&[f64], f64)| {
            let law = &model.links[kind as usize];
            let spring: f64 = velocity.iter().map(|v| law.stiffness * (v - rate)).sum();
            let damper: f64 = acceleration.iter().map(|a| law.damping * (a - rate_change)).sum();
            spring + damper + self.maxwell_force[kind as usize].iter().sum::<f64>()
        };
        let along_x = (&self.velocity_x[..], carrier.u_rate);
        let along_z = (&self.velocity_z[..], carrier.w_rate);
        (
            of(LinkKind::Horizontal, along_x, (&self.acceleration_x, carrier.u_acceleration)),
            of(LinkKind::Vertical, along_z, (&self.acceleration_z, carrier.w_acceleration)),
        )
    }
}

impl Numbers for Rates {
    fn visit(&mut self, visit: &mut dyn FnMut(&mut f64)) {
        let Self { velocity_x, velocity_z, acceleration_x, acceleration_z, maxwell, maxwell_force, normal, margin } =
            self;
        visit_all([velocity_x, velocity_z, acceleration_x, acceleration_z], visit);
        visit_all([maxwell, maxwell_force, normal, margin], visit);
    }
}
