//! Linear systems ẋ = A x, and the layer without contact as one.

use nalgebra::{DMatrix, DVector};

use crate::run::Law;

/// e^A by scaling and squaring: Taylor's series of A/2^s, whose norm is at most ½, squared s times.
pub(crate) fn exponential(a: &DMatrix<f64>) -> DMatrix<f64> {
    // ½^n/n! is below the last digit at n = 14.
    const TERMS: i32 = 14;
    let norm = a.row_iter().map(|row| row.iter().map(|value| value.abs()).sum::<f64>()).fold(0.0, f64::max);
    let squarings = (2.0 * norm).log2().ceil().max(0.0) as i32;
    let scaled = a / 2.0_f64.powi(squarings);
    let one = DMatrix::identity(a.nrows(), a.nrows());
    // Horner's scheme: 1 + A (1 + A/2 (1 + A/3 …)).
    let series = (1..=TERMS).rev().fold(one.clone(), |sum, n| &one + &scaled * sum / f64::from(n));
    (0..squarings).fold(series, |power, _| &power * &power)
}

/// The four kinds of link.
#[derive(Clone, Debug)]
pub(crate) struct Links {
    pub(crate) vertical: Law,
    pub(crate) horizontal: Law,
    pub(crate) lateral_x: Law,
    pub(crate) lateral_z: Law,
}

/// One direction of the free layer under a carrier that moves by a t + b sin Ωt. The state: displacements d_i from
/// rest, velocities (times `unit`), the dashpots' y_j of the links to the carrier and of the lateral ones, and last, of
/// the carrier, its displacement, its swing b sin Ωt, b cos Ωt and 1.
pub(crate) struct Direction<'a> {
    pub(crate) masses: usize,
    pub(crate) mass: f64,
    pub(crate) to_carrier: &'a Law,
    pub(crate) lateral: &'a Law,
    /// The carrier's constant rate a, m/s.
    pub(crate) rate: f64,
    /// The carrier's swing b, m.
    pub(crate) amplitude: f64,
    /// Ω, rad/s.
    pub(crate) omega: f64,
    /// The unit of time, s: velocities are counted in m a unit, so that the numbers of a state are alike.
    pub(crate) unit: f64,
}

impl Direction<'_> {
    fn size(&self) -> usize {
        2 * self.masses
            + self.masses * self.to_carrier.maxwell.len()
            + (self.masses - 1) * self.lateral.maxwell.len()
            + 4
    }

    /// Row of the carrier's displacement; then come its swing, b cos Ωt and 1.
    fn carrier(&self) -> usize {
        self.size() - 4
    }

    /// The start: displaced and as fast as the carrier, dashpots relaxed at e = 0.
    pub(crate) fn start(&self, velocity: f64) -> DVector<f64> {
        let mut x = DVector::zeros(self.size());
        x.rows_mut(self.masses, self.masses).fill(velocity * self.unit);
        x[self.size() - 2] = self.amplitude;
        x[self.size() - 1] = 1.0;
        x
    }

    /// The start of this motion of the carrier where another ended in `state`.
    pub(crate) fn taken_over(&self, state: &DVector<f64>) -> DVector<f64> {
        let mut x = state.clone();
        (x[self.size() - 3], x[self.size() - 2]) = (0.0, self.amplitude);
        x
    }

    /// The carrier's rate, in m a unit of time, as a row on the state.
    fn carrier_rate(&self) -> DVector<f64> {
        let mut row = DVector::zeros(self.size());
        row[self.size() - 2] = self.omega * self.unit;
        row[self.size() - 1] = self.rate * self.unit;
        row
    }

    /// e and ė (m a unit of time) of the link of mass `i` to the carrier, or of the lateral link from mass `i` to the
    /// next, as rows on the state.
    fn elongation(&self, lateral: bool, i: usize) -> (DVector<f64>, DVector<f64>) {
        let k = self.masses;
        let (mut e, mut rate) = (DVector::zeros(self.size()), DVector::zeros(self.size()));
        if lateral {
            (e[i], e[i + 1], rate[k + i], rate[k + i + 1]) = (-1.0, 1.0, -1.0, 1.0);
        } else {
            (e[i], e[self.carrier()], rate[k + i]) = (1.0, -1.0, 1.0);
            rate -= self.carrier_rate();
        }
        (e, rate)
    }

    /// All links: kind, first mass, row of the first of the dashpots.
    fn links(&self) -> Vec<(bool, usize, usize)> {
        let mut row = 2 * self.masses;
        let mut links = Vec::new();
        for (lateral, count, law) in [(false, self.masses, self.to_carrier), (true, self.masses - 1, self.lateral)] {
            for i in 0..count {
                links.push((lateral, i, row));
                row += law.maxwell.len();
            }
        }
        links
    }

    fn law(&self, lateral: bool) -> &Law {
        if lateral { self.lateral } else { self.to_carrier }
    }

    /// F = c e + d ė + Σ_j c_j (e - y_j) as a row on the state.
    fn force(&self, (lateral, i, dashpot): (bool, usize, usize)) -> DVector<f64> {
        let law = self.law(lateral);
        let (e, rate) = self.elongation(lateral, i);
        let mut force = &e * law.stiffness + rate * (law.damping / self.unit);
        for (j, (c, _)) in law.maxwell.iter().enumerate() {
            force += &e * *c;
            force[dashpot + j] -= c;
        }
        force
    }

    /// A of ẋ = A x, time in `unit`s.
    pub(crate) fn matrix(&self) -> DMatrix<f64> {
        let (n, k) = (self.size(), self.masses);
        let mut a = DMatrix::zeros(n, n);
        for i in 0..k {
            a[(i, k + i)] = 1.0;
        }
        for link in self.links() {
            let (lateral, i, dashpot) = link;
            let force = self.force(link);
            let per_mass = self.unit * self.unit / self.mass;
            add_to_row(&mut a, k + i, if lateral { per_mass } else { -per_mass }, &force);
            if lateral {
                add_to_row(&mut a, k + i + 1, -per_mass, &force);
            }
            let e = self.elongation(lateral, i).0;
            for (j, (_, tau)) in self.law(lateral).maxwell.iter().enumerate() {
                add_to_row(&mut a, dashpot + j, self.unit / tau, &e);
                a[(dashpot + j, dashpot + j)] -= self.unit / tau;
            }
        }
        let carrier = self.carrier_rate();
        a.set_row(self.carrier(), &carrier.transpose());
        a[(n - 3, n - 2)] = self.omega * self.unit;
        a[(n - 2, n - 3)] = -self.omega * self.unit;
        a
    }

    /// Σ F_i of the links to the carrier as a row on the state.
    pub(crate) fn on_carrier(&self) -> DVector<f64> {
        let links = self.links().into_iter().filter(|(lateral, ..)| !lateral);
        links.fold(DVector::zeros(self.size()), |sum, link| sum + self.force(link))
    }
}

/// Adds `factor` times `other` to a row of `a`.
fn add_to_row(a: &mut DMatrix<f64>, row: usize, factor: f64, other: &DVector<f64>) {
    let sum = a.row(row) + other.transpose() * factor;
    a.set_row(row, &sum);
}

#[test]
fn the_exponential_of_known_matrices() {
    // A turn by 100 rad, and e^t t of a defective matrix.
    let turn = exponential(&DMatrix::from_row_slice(2, 2, &[0.0, 100.0, -100.0, 0.0]));
    assert!((turn[(0, 1)] - 100.0_f64.sin()).abs() < 1e-12, "{}", turn[(0, 1)]);
    let defective = exponential(&DMatrix::from_row_slice(2, 2, &[2.0, 1.0, 0.0, 2.0]));
    assert!((defective[(0, 1)] - 2.0_f64.exp()).abs() < 1e-13, "{}", defective[(0, 1)]);
}
