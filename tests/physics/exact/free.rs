//! No contact: the layer is a linear system ẋ = A x, and the matrix exponential solves it.

use std::f64::consts::TAU;

use asperity::scene::Path;
use asperity::simulation::{Motion, Start};
use nalgebra::{DMatrix, DVector};

use crate::common::random::Random;
use crate::common::runs::even_times;
use crate::common::scenes::{Law, SceneText};
use crate::common::{difference, largest};
use crate::physics::exact::run::Run;

const MASS: f64 = 1.0e-7;
const SPACING: f64 = 1.0e-4;
const DURATION: f64 = 4.0e-4;
const ROWS: u32 = 40;
/// High above the profile.
const CLEARANCE: f64 = 1.0e-2;

/// A chain of its own for each seed.
struct Chain {
    masses: usize,
    links: Links,
    /// Of u and w: each ends in a kink of the carrier's motion.
    motions: [(Path, Path); 2],
    start: Start,
}

fn random_law(random: &mut Random, elements: usize) -> Law {
    let element = |random: &mut Random| (random.between(100.0, 2e3), 10.0_f64.powf(random.between(-6.0, -3.0)));
    let (stiffness, damping) = (random.between(200.0, 2e3), random.between(0.0, 5e-3));
    Law { stiffness, damping, maxwell: (0..elements).map(|_| element(random)).collect() }
}

fn random_path(random: &mut Random) -> Path {
    let rate = random.between(-0.1, 0.1);
    Path { rate, amplitude: random.between(1e-6, 1e-5), frequency: random.between(1e3, 1e4) }
}

impl Chain {
    /// `elements`: how many Maxwell elements the vertical, horizontal, lateral x and lateral z links have.
    fn random(seed: u64, masses: usize, elements: [usize; 4]) -> Self {
        let mut random = Random::new(seed);
        let [vertical, horizontal, lateral_x, lateral_z] = elements.map(|n| random_law(&mut random, n));
        let links = Links { vertical, horizontal, lateral_x, lateral_z };
        let motions = [(); 2].map(|()| (random_path(&mut random), random_path(&mut random)));
        // Rates at the start that differ from those of the motion: a kink at t = 0.
        let start = Start { u_rate: random.between(-0.2, 0.2), w_rate: random.between(-0.2, 0.2), ..Start::default() };
        Self { masses, links, motions, start }
    }

    /// The columns of a run: F_x, F_z, then x and z of every mass.
    fn run(&self, tolerance: f64) -> Vec<Vec<f64>> {
        let Links { vertical, horizontal, lateral_x, lateral_z } = &self.links;
        let k = self.masses;
        let scene = SceneText::new(k, SPACING, MASS)
            .set("layer.clearance", CLEARANCE)
            .vertical(vertical)
            .horizontal(horizontal)
            .lateral_x(lateral_x)
            .lateral_z(lateral_z)
            .tolerances(tolerance, tolerance * 1e-5);
        let mut run = Run::new(&scene, self.start);
        let element = |axis: &'static str| (1..=k).map(move |i| format!("element[{i}].{axis}"));
        let mut names: Vec<String> = vec!["F_x".into(), "F_z".into()];
        names.extend(element("x").chain(element("z")));
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        // Within a motion, without its start: there the run still shows the rates before the kink.
        let times = even_times(DURATION, ROWS);
        let pieces = self
            .motions
            .map(|(u, w)| run.sample(&Motion { duration: DURATION, u, w, ..Motion::default() }, &times, &names));
        let [first, second] = pieces;
        first.into_iter().zip(second).map(|(first, second)| [first, second].concat()).collect()
    }

    /// The same columns by the matrix exponential.
    fn exact(&self) -> Vec<Vec<f64>> {
        let Links { vertical, horizontal, lateral_x, lateral_z } = &self.links;
        let (force_x, x) = self.along(horizontal, lateral_x, self.motions.map(|(u, _)| u), self.start.u_rate);
        let (force_z, z) = self.along(vertical, lateral_z, self.motions.map(|(_, w)| w), self.start.w_rate);
        let mut columns = vec![force_x, force_z];
        for (i, x) in x.iter().enumerate() {
            columns.push(x.iter().map(|x| x + i as f64 * SPACING).collect());
        }
        columns.extend(z.iter().map(|z| z.iter().map(|z| z + CLEARANCE).collect()));
        columns
    }

    /// One direction: the force on the carrier and the masses' displacements at all times.
    fn along(&self, to_carrier: &Law, lateral: &Law, paths: [Path; 2], velocity: f64) -> (Vec<f64>, Vec<Vec<f64>>) {
        let (masses, mass, unit) = (self.masses, MASS, 1e-5);
        let (mut forces, mut states) = (Vec::new(), Vec::<DVector<f64>>::new());
        for Path { rate, amplitude, frequency } in paths {
            let omega = TAU * frequency;
            let direction = Direction { masses, mass, to_carrier, lateral, rate, amplitude, omega, unit };
            let step = (direction.matrix() * (DURATION / f64::from(ROWS) / unit)).exp();
            let force = direction.on_carrier();
            let last = states.last().map(|last| direction.taken_over(last));
            let mut state = last.unwrap_or_else(|| direction.start(velocity));
            for _ in 0..ROWS {
                state = &step * state;
                forces.push(force.dot(&state));
                states.push(state.clone());
            }
        }
        let column = |i: usize| states.iter().map(|state| state[i]).collect();
        (forces, (0..masses).map(column).collect())
    }

    /// The largest errors of F_x and F_z over the largest force, and of the positions over the way that masses go.
    fn errors(&self, tolerance: f64) -> [f64; 2] {
        let (found, exact) = (self.run(tolerance), self.exact());
        let error = |column: usize| difference(&found[column], &exact[column]);
        let force = largest(&exact[0]).max(largest(&exact[1]));
        let positions = (2..found.len()).map(error).fold(0.0, f64::max);
        [error(0).max(error(1)) / force, positions / WAY]
    }
}

/// How far the masses go, about: 0.1 m/s for 0.4 ms.
const WAY: f64 = 4.0e-5;

/// x and z of every mass and F_x and F_z on the carrier, against the exact solution: some dozens to hundreds of steps
/// with an error of the tolerance each stay below a hundred tolerances, and a thousandth of the tolerance takes at
/// least a hundredth of the error.
#[test]
fn a_free_layer_follows_the_matrix_exponential() {
    let elements = [[2, 1, 0, 0], [0, 0, 0, 0], [1, 0, 3, 2], [3, 2, 1, 2], [0, 0, 2, 1]];
    for (seed, (masses, elements)) in (1..).zip([1, 2, 3, 5, 9].into_iter().zip(elements)) {
        let chain = Chain::random(seed, masses, elements);
        let (coarse, fine) = (chain.errors(1e-6), chain.errors(1e-9));
        for (what, coarse, fine) in [("forces", coarse[0], fine[0]), ("positions", coarse[1], fine[1])] {
            assert!(coarse <= 1e-4, "{masses} masses: {what} at 1e-6 are off by {coarse:e}");
            assert!(fine <= 1e-7, "{masses} masses: {what} at 1e-9 are off by {fine:e}");
            assert!(fine <= 0.01 * coarse, "{masses} masses: {what} from {coarse:e} only to {fine:e}");
        }
    }
}

/// The four kinds of link.
#[derive(Clone, Debug)]
struct Links {
    vertical: Law,
    horizontal: Law,
    lateral_x: Law,
    lateral_z: Law,
}

/// One direction of the free layer under a carrier that moves by a t + b sin Ωt. The state: displacements d_i from
/// rest, velocities (times `unit`), the dashpots' y_j of the links to the carrier and of the lateral ones, and last, of
/// the carrier, its displacement, its swing b sin Ωt, b cos Ωt and 1.
struct Direction<'a> {
    masses: usize,
    mass: f64,
    to_carrier: &'a Law,
    lateral: &'a Law,
    /// The carrier's constant rate a, m/s.
    rate: f64,
    /// The carrier's swing b, m.
    amplitude: f64,
    /// Ω, rad/s.
    omega: f64,
    /// The unit of time, s: velocities are counted in m a unit, so that the numbers of a state are alike.
    unit: f64,
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
    fn start(&self, velocity: f64) -> DVector<f64> {
        let mut x = DVector::zeros(self.size());
        x.rows_mut(self.masses, self.masses).fill(velocity * self.unit);
        x[self.size() - 2] = self.amplitude;
        x[self.size() - 1] = 1.0;
        x
    }

    /// The start of this motion of the carrier where another ended in `state`.
    fn taken_over(&self, state: &DVector<f64>) -> DVector<f64> {
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
    fn matrix(&self) -> DMatrix<f64> {
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
    fn on_carrier(&self) -> DVector<f64> {
        let links = self.links().into_iter().filter(|(lateral, ..)| !lateral);
        links.fold(DVector::zeros(self.size()), |sum, link| sum + self.force(link))
    }
}

/// Adds `factor` times `other` to a row of `a`.
fn add_to_row(a: &mut DMatrix<f64>, row: usize, factor: f64, other: &DVector<f64>) {
    let sum = a.row(row) + other.transpose() * factor;
    a.set_row(row, &sum);
}
