//! The equations of motion assembled densely, as the paper writes them (10)-(15), from the table of links alone:
//!
//! ```text
//! M q̈ + D q̇ + C q = B y + F + contact forces,   q = (ξ_1 … ξ_k, ζ_1 … ζ_k)
//! ẏ_j = (e - y_j)/τ_j
//! ```
//!
//! A link with the elongation e = gᵀ q - (the carrier's displacement, if it ends there) and the force
//! F = c e + d ė + Σ c_j (e - y_j) adds -g F to the right side, so (c + Σ c_j) g gᵀ to C, d g gᵀ to D, c_j g to B.

use asperity::model::{Mode, SurfacePoint};
use asperity::scene::RateShear;
use nalgebra::{DMatrix, DVector, Vector2};

use crate::common::scenes::Law;
use crate::physics::kernels::layer::{Layer, strength};

/// M = m 1 and the other matrices.
#[derive(Clone, Debug)]
pub struct Matrices {
    pub mass: f64,
    pub masses: usize,
    pub friction: Option<(f64, f64)>,
    pub rate_shear: Option<RateShear>,
    pub stiffness: DMatrix<f64>,
    pub damping: DMatrix<f64>,
    /// B: what a y_j does to the coordinates.
    pub internal: DMatrix<f64>,
    /// F = (this) (u, w) + (that) (u̇, ẇ).
    pub carrier_position: DMatrix<f64>,
    pub carrier_rate: DMatrix<f64>,
    /// The elongations of the links with Maxwell elements, e = (this) q - (that) (u, w): a row for each element.
    pub elongation: DMatrix<f64>,
    pub elongation_carrier: DMatrix<f64>,
    pub relaxation_times: Vec<f64>,
}

/// The ends of link `i` of a kind: the coordinates that lengthen and shorten it, or which of (u, w) shortens it.
enum Ends {
    Carrier { mass: usize, displacement: usize },
    Masses { lengthens: usize, shortens: usize },
}

/// The links of a kind in the order of `LinkKind::ALL`: vertical, horizontal, lateral x, lateral z.
fn ends(kind: usize, k: usize) -> Vec<Ends> {
    let lateral =
        |first: usize| (0..k - 1).map(move |i| Ends::Masses { lengthens: first + i + 1, shortens: first + i });
    match kind {
        0 => (0..k).map(|i| Ends::Carrier { mass: k + i, displacement: 1 }).collect(),
        1 => (0..k).map(|i| Ends::Carrier { mass: i, displacement: 0 }).collect(),
        2 => lateral(0).collect(),
        _ => lateral(k).collect(),
    }
}

impl Matrices {
    pub fn new(layer: &Layer) -> Self {
        let k = layer.masses;
        let of = |kind: usize| layer.links[kind].iter().flat_map(|link| &link.maxwell).count() * ends(kind, k).len();
        let internals = (0..4).map(of).sum();
        let zeros = DMatrix::zeros;
        let mut matrices = Self {
            mass: layer.mass,
            masses: k,
            friction: layer.friction,
            rate_shear: layer.rate_shear,
            stiffness: zeros(2 * k, 2 * k),
            damping: zeros(2 * k, 2 * k),
            internal: zeros(2 * k, internals),
            carrier_position: zeros(2 * k, 2),
            carrier_rate: zeros(2 * k, 2),
            elongation: zeros(internals, 2 * k),
            elongation_carrier: zeros(internals, 2),
            relaxation_times: Vec::new(),
        };
        for (kind, link) in layer.links.iter().enumerate() {
            if let Some(link) = link {
                matrices.add(link, &ends(kind, k));
            }
        }
        matrices
    }

    fn add(&mut self, link: &Law, ends: &[Ends]) {
        let vectors: Vec<_> = ends.iter().map(|ends| self.vectors(ends)).collect();
        let glassy = link.stiffness + link.maxwell.iter().map(|element| element.0).sum::<f64>();
        for (g, carrier) in &vectors {
            self.stiffness += glassy * g * g.transpose();
            self.damping += link.damping * g * g.transpose();
            self.carrier_position += glassy * g * carrier.transpose();
            self.carrier_rate += link.damping * g * carrier.transpose();
        }
        for &(stiffness, relaxation_time) in &link.maxwell {
            for (g, carrier) in &vectors {
                let j = self.relaxation_times.len();
                self.internal.set_column(j, &(stiffness * g));
                self.elongation.set_row(j, &g.transpose());
                self.elongation_carrier.set_row(j, &carrier.transpose());
                self.relaxation_times.push(relaxation_time);
            }
        }
    }

    /// g, and which of (u, w) the elongation counts from.
    fn vectors(&self, ends: &Ends) -> (DVector<f64>, Vector2<f64>) {
        let mut g = DVector::zeros(2 * self.masses);
        let mut carrier = Vector2::zeros();
        match *ends {
            Ends::Carrier { mass, displacement } => {
                g[mass] = 1.0;
                carrier[displacement] = 1.0;
            }
            Ends::Masses { lengthens, shortens } => {
                g[lengthens] = 1.0;
                g[shortens] = -1.0;
            }
        }
        (g, carrier)
    }

    /// f = B y + F - D q̇ - C q: the forces of the links on the masses.
    pub fn forces(
        &self,
        (q, v): (&DVector<f64>, &DVector<f64>),
        y: &DVector<f64>,
        (position, rate): (Vector2<f64>, Vector2<f64>),
    ) -> DVector<f64> {
        &self.internal * y + &self.carrier_position * position + &self.carrier_rate * rate
            - &self.damping * v
            - &self.stiffness * q
    }

    /// The elongations e of the links of the Maxwell elements.
    pub fn elongations(&self, q: &DVector<f64>, carrier: Vector2<f64>) -> DVector<f64> {
        &self.elongation * q - &self.elongation_carrier * carrier
    }

    /// ẏ.
    pub fn internal_rates(&self, q: &DVector<f64>, y: &DVector<f64>, carrier: Vector2<f64>) -> DVector<f64> {
        let tau = DVector::from_column_slice(&self.relaxation_times);
        (self.elongations(q, carrier) - y).component_div(&tau)
    }

    /// A (τ_0 + τ_f(v)) at the speed in the direction of slip, N.
    pub fn shear(&self, speed: f64) -> f64 {
        self.friction.map_or(0.0, |(_, shear)| shear) + self.rate_shear.map_or(0.0, |law| strength(&law, speed))
    }

    /// q̈ and the contact forces (F_N, F_T) of each mass under the forces `f`, from one dense system in all of them:
    ///
    /// ```text
    /// m q̈_i - F_N n + F_T t = f_i,   n = (-s, 1)/q,  t = (1, s)/q                       (6), (7)
    /// free: F_N = F_T = 0;   stick: q̈_i = 0;   slip: z̈ - s ẍ = κ ẋ²,  F_T - σ μ F_N = σ A (τ_0 + τ_f)
    /// ```
    pub fn accelerations(
        &self,
        f: &DVector<f64>,
        v: &DVector<f64>,
        modes: &[Mode],
        surfaces: &[SurfacePoint],
    ) -> (DVector<f64>, Vec<(f64, f64)>) {
        let k = self.masses;
        let (mu, _) = self.friction.unwrap_or_default();
        let mut matrix = DMatrix::zeros(4 * k, 4 * k);
        let mut right = DVector::zeros(4 * k);
        for (i, (mode, surface)) in modes.iter().zip(surfaces).enumerate() {
            let (x, z, normal, tangential) = (i, k + i, 2 * k + i, 3 * k + i);
            let (s, q) = (surface.slope, surface.slope.hypot(1.0));
            (matrix[(x, x)], matrix[(z, z)]) = (self.mass, self.mass);
            (right[x], right[z]) = (f[x], f[z]);
            (matrix[(x, normal)], matrix[(z, normal)]) = (s / q, -1.0 / q);
            (matrix[(x, tangential)], matrix[(z, tangential)]) = (1.0 / q, s / q);
            let sigma = match mode {
                Mode::Free => {
                    (matrix[(normal, normal)], matrix[(tangential, tangential)]) = (1.0, 1.0);
                    continue;
                }
                Mode::Stick => {
                    (matrix[(normal, z)], matrix[(tangential, x)]) = (1.0, 1.0);
                    continue;
                }
                Mode::Forward => 1.0,
                Mode::Backward => -1.0,
            };
            (matrix[(normal, z)], matrix[(normal, x)]) = (1.0, -s);
            right[normal] = surface.curvature * v[x] * v[x];
            (matrix[(tangential, tangential)], matrix[(tangential, normal)]) = (1.0, -sigma * mu);
            right[tangential] = sigma * self.shear(sigma * v[x] * q);
        }
        let solution = matrix.lu().solve(&right).expect("friction makes the problem never insoluble");
        let contacts = (0..k).map(|i| (solution[2 * k + i], solution[3 * k + i])).collect();
        (solution.rows(0, 2 * k).into_owned(), contacts)
    }
}
