//! No contact: the layer is linear, and the matrix exponential solves it.

use std::f64::consts::TAU;

use asperity::scene::Path;
use asperity::simulation::{Motion, Start};
use nalgebra::DVector;

use crate::linear::{Direction, Links, exponential};
use crate::run::{Law, Random, Run, difference, largest, link, solver};

const MASS: f64 = 1.0e-7;
const SPACING: f64 = 1.0e-4;
const DURATION: f64 = 4.0e-4;
const ROWS: usize = 40;
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
        let mut random = Random(seed);
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
        let links = [("vertical", vertical), ("horizontal", horizontal), ("lateral_x", lateral_x)];
        let mut tables: String = links.iter().map(|(kind, law)| link(kind, law)).collect();
        tables += &link("lateral_z", lateral_z);
        let (k, solver) = (self.masses, solver(tolerance, tolerance * 1e-5));
        let text = format!(
            "[layer]\nmasses = {k}\nspacing = {SPACING:?}\nmass = {MASS:?}\nclearance = {CLEARANCE:?}\n{tables}\
             [surface]\nkind = \"flat\"\n{solver}"
        );
        let mut run = Run::new(&text, self.start);
        let element = |axis: &'static str| (1..=k).map(move |i| format!("element[{i}].{axis}"));
        let mut names: Vec<String> = vec!["F_x".into(), "F_z".into()];
        names.extend(element("x").chain(element("z")));
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        let pieces = self.motions.map(|(u, w)| run.sample(&Motion { duration: DURATION, u, w }, &times(), &names));
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
            let step = exponential(&(direction.matrix() * (DURATION / ROWS as f64 / unit)));
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

    /// The largest errors of F_x and F_z over the largest force, and of the places over the way that masses go.
    fn errors(&self, tolerance: f64) -> [f64; 2] {
        let (found, exact) = (self.run(tolerance), self.exact());
        let error = |column: usize| difference(&found[column], &exact[column]);
        let force = largest(&exact[0]).max(largest(&exact[1]));
        let places = (2..found.len()).map(error).fold(0.0, f64::max);
        [error(0).max(error(1)) / force, places / WAY]
    }
}

/// How far the masses go, about: 0.1 m/s for 0.4 ms.
const WAY: f64 = 4.0e-5;

/// Within a motion, without its start: there the run still shows the rates before the kink.
fn times() -> Vec<f64> {
    // The last is the duration itself, whatever rounding says.
    (1..=ROWS).map(|row| if row == ROWS { DURATION } else { DURATION * row as f64 / ROWS as f64 }).collect()
}

/// x and z of every mass and F_x and F_z on the carrier, against the exact solution: some dozens to hundreds of steps
/// with an error of the tolerance each stay below a hundred tolerances, and a thousandth of the tolerance takes at
/// least a hundredth of the error.
fn follows_the_exponential(seed: u64, masses: usize, elements: [usize; 4]) {
    let chain = Chain::random(seed, masses, elements);
    let (coarse, fine) = (chain.errors(1e-6), chain.errors(1e-9));
    for (what, coarse, fine) in [("forces", coarse[0], fine[0]), ("places", coarse[1], fine[1])] {
        assert!(coarse <= 1e-4, "{what} at 1e-6 are off by {coarse:e}");
        assert!(fine <= 1e-7, "{what} at 1e-9 are off by {fine:e}");
        assert!(fine <= 0.01 * coarse, "{what}: from {coarse:e} only to {fine:e}");
    }
}

#[test]
fn one_mass() {
    follows_the_exponential(1, 1, [2, 1, 0, 0]);
}

#[test]
fn two_masses_without_maxwell_elements() {
    follows_the_exponential(2, 2, [0, 0, 0, 0]);
}

#[test]
fn three_masses_with_elements_in_some_links() {
    follows_the_exponential(3, 3, [1, 0, 3, 2]);
}

#[test]
fn five_masses_with_elements_in_all_links() {
    follows_the_exponential(4, 5, [3, 2, 1, 2]);
}

#[test]
fn nine_masses_with_elements_in_the_lateral_links() {
    follows_the_exponential(5, 9, [0, 0, 2, 1]);
}
