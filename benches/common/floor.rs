//! The floor: what a stage of the free layer can't leave out, in bare loops.
//!
//! The Maxwell elements' history a* = a + Σ_j h a_ij ȧ_j and its force H = Σ c_j g_j a* on each link; the elimination
//! of one 2×2 block a mass from both ends towards the middle, and back; ȧ = g (ė - a*/τ), and a at the last stage.
//! Nothing of a stage's other work: no history of places and velocities, no assembly, no contact, no error estimate.
//! Stage i sums i earlier ones, as the method's does.

use asperity::internals::integrator::{ESDIRK5 as METHOD, MAX_STAGES as STAGES};
use asperity::model::{LinkKind, Model};

/// Masses whose Maxwell elements are worked on at a time, so that sums stay in the nearest cache.
const CHUNK: usize = 512;

/// The blocks of one mass.
#[derive(Clone, Copy)]
struct MassBlocks {
    lower: MassBlock,
    diagonal: MassBlock,
    upper: MassBlock,
}

/// A 2×2 block, row by row.
type MassBlock = [f64; 4];
type MassPair = [f64; 2];

/// One row of Maxwell elements: its link, g = τ/(τ + β), c g, 1/τ.
#[derive(Clone, Copy)]
struct ElementRow {
    kind: usize,
    g: f64,
    weight: f64,
    per_tau: f64,
}

pub struct Floor {
    masses: usize,
    /// Step, s.
    h: f64,
    rows: Vec<ElementRow>,
    /// a at the start of the step, at its end, a* of the stage: row by row, one row after another.
    start: Vec<f64>,
    end: Vec<f64>,
    star: Vec<f64>,
    /// ȧ at the stages.
    rates: Vec<Vec<f64>>,
    /// H by kind of link.
    history_force: [Vec<f64>; 4],
    blocks: Vec<MassBlocks>,
    /// What the right sides hold beside H.
    known: Vec<MassPair>,
    /// The block that an unknown's neighbour is multiplied with on the way back, and its right side.
    reduced: Vec<(MassBlock, MassPair)>,
    velocity_x: Vec<f64>,
    velocity_z: Vec<f64>,
}

impl Floor {
    pub fn new(model: &Model, h: f64) -> Self {
        let k = model.masses();
        let beta = METHOD.gamma() * h;
        let row = |row: &asperity::model::MaxwellRow| {
            let g = row.relaxation_time / (row.relaxation_time + beta);
            ElementRow { kind: row.kind as usize, g, weight: row.stiffness * g, per_tau: 1.0 / row.relaxation_time }
        };
        let rows: Vec<_> = model.rows.iter().map(row).collect();
        let noise = |i: usize| ((i * 7919) % 1000) as f64 * 1e-9;
        let variables: Vec<f64> = (0..rows.len() * k).map(noise).collect();
        Self {
            masses: k,
            h,
            start: variables.clone(),
            end: variables.clone(),
            star: variables.clone(),
            rates: vec![variables; STAGES],
            history_force: [const { Vec::new() }; 4].map(|_: Vec<f64>| vec![0.0; k]),
            blocks: blocks(model, &rows, beta),
            known: (0..k).map(|i| [noise(i), noise(i + 1)]).collect(),
            reduced: vec![([0.0; 4], [0.0; 2]); k],
            velocity_x: vec![0.0; k],
            velocity_z: vec![0.0; k],
            rows,
        }
    }

    /// As many stages as the method's implicit ones.
    pub fn stages(&mut self) {
        self.stage::<1>();
        self.stage::<2>();
        self.stage::<3>();
        self.stage::<4>();
        self.stage::<5>();
        self.stage::<6>();
    }

    /// One stage, with the elements' history from `EARLIER` stages.
    fn stage<const EARLIER: usize>(&mut self) {
        let weights = std::array::from_fn(|j| self.h * METHOD.a[EARLIER][j]);
        self.collect_history::<EARLIER>(&weights);
        self.eliminate();
        self.update(EARLIER);
    }

    fn collect_history<const EARLIER: usize>(&mut self, weights: &[f64; EARLIER]) {
        let k = self.masses;
        for first in (0..k).step_by(CHUNK) {
            let chunk = first..(first + CHUNK).min(k);
            self.history_force.iter_mut().for_each(|force| force[chunk.clone()].fill(0.0));
            for (r, row) in self.rows.iter().enumerate() {
                let range = r * k + chunk.start..r * k + chunk.end;
                let earlier: [&[f64]; EARLIER] = std::array::from_fn(|j| &self.rates[j][range.clone()]);
                let force = &mut self.history_force[row.kind][chunk.clone()];
                sum_history(&self.start[range.clone()], earlier, weights, &mut self.star[range], force, row.weight);
            }
        }
    }

    /// Blocks and right sides from both ends to the middle, velocities back.
    fn eliminate(&mut self) {
        let last = self.masses - 1;
        let middle = self.masses / 2;
        let mut left = ([0.0; 4], [0.0; 2]);
        let mut right = left;
        for step in 0..middle {
            left = self.reduce(step, &left, |blocks| (&blocks.lower, &blocks.upper));
            if last - step > middle {
                right = self.reduce(last - step, &right, |blocks| (&blocks.upper, &blocks.lower));
            }
        }
        let MassBlocks { lower, diagonal, upper } = &self.blocks[middle];
        let inverse = inverse(&minus(&minus(diagonal, &times(lower, &left.0)), &times(upper, &right.0)));
        let side = self.right_side(middle);
        let (from_left, from_right) = (apply(lower, &left.1), apply(upper, &right.1));
        let side = [side[0] - from_left[0] - from_right[0], side[1] - from_left[1] - from_right[1]];
        let found = apply(&inverse, &side);
        self.set(middle, found);
        let (mut left, mut right) = (found, found);
        for step in 1..=middle {
            left = self.substitute(middle - step, &left);
            if middle + step <= last {
                right = self.substitute(middle + step, &right);
            }
        }
    }

    #[inline(always)]
    fn reduce(
        &mut self,
        i: usize,
        before: &(MassBlock, MassPair),
        parts: impl Fn(&MassBlocks) -> (&MassBlock, &MassBlock),
    ) -> (MassBlock, MassPair) {
        let (behind, ahead) = parts(&self.blocks[i]);
        let inverse = inverse(&minus(&self.blocks[i].diagonal, &times(behind, &before.0)));
        let (side, carried) = (self.right_side(i), apply(behind, &before.1));
        let reduced = (times(&inverse, ahead), apply(&inverse, &[side[0] - carried[0], side[1] - carried[1]]));
        self.reduced[i] = reduced;
        reduced
    }

    #[inline(always)]
    fn right_side(&self, i: usize) -> MassPair {
        let [vertical, horizontal, lateral_x, lateral_z] = &self.history_force;
        let before = i.wrapping_sub(1);
        let lateral = |force: &[f64]| force[i] - force.get(before).copied().unwrap_or(0.0);
        [self.known[i][0] - horizontal[i] + lateral(lateral_x), self.known[i][1] - vertical[i] + lateral(lateral_z)]
    }

    #[inline(always)]
    fn substitute(&mut self, i: usize, neighbour: &MassPair) -> MassPair {
        let (block, side) = &self.reduced[i];
        let carried = apply(block, neighbour);
        let found = [side[0] - carried[0], side[1] - carried[1]];
        self.set(i, found);
        found
    }

    #[inline(always)]
    fn set(&mut self, i: usize, [x, z]: MassPair) {
        (self.velocity_x[i], self.velocity_z[i]) = (x, z);
    }

    fn update(&mut self, stage: usize) {
        let k = self.masses;
        let beta = METHOD.gamma() * self.h;
        let mut elongation_rates = [0.0; CHUNK];
        for first in (0..k).step_by(CHUNK) {
            let chunk = first..(first + CHUNK).min(k);
            let mut kind = usize::MAX;
            for (r, row) in self.rows.iter().enumerate() {
                if row.kind != kind {
                    kind = row.kind;
                    self.elongation_rates(kind, first, &mut elongation_rates[..chunk.len()]);
                }
                let range = r * k + chunk.start..r * k + chunk.end;
                let star = &self.star[range.clone()];
                let rates = &mut self.rates[stage][range.clone()];
                update_rates(star, &elongation_rates[..chunk.len()], rates, row);
                if stage + 1 == STAGES {
                    for ((end, star), rate) in self.end[range].iter_mut().zip(star).zip(&*rates) {
                        *end = star + beta * rate;
                    }
                }
            }
        }
    }

    fn elongation_rates(&self, kind: usize, first: usize, rates: &mut [f64]) {
        let kind = LinkKind::ALL[kind];
        let velocity = if kind.is_along_x() { &self.velocity_x } else { &self.velocity_z };
        let velocity = &velocity[first..];
        if kind.is_lateral() {
            for (rate, pair) in rates.iter_mut().zip(velocity.windows(2)) {
                *rate = pair[1] - pair[0];
            }
        } else {
            rates.copy_from_slice(&velocity[..rates.len()]);
        }
    }

    /// The largest that a row of the system misses, over the largest right side: a test of the floor itself.
    pub fn residual(&self) -> f64 {
        let velocity = |i: usize| [self.velocity_x[i], self.velocity_z[i]];
        let (mut missed, mut largest) = (0.0_f64, 0.0_f64);
        for i in 0..self.masses {
            let MassBlocks { lower, diagonal, upper } = &self.blocks[i];
            let mut terms = vec![apply(diagonal, &velocity(i))];
            if i > 0 {
                terms.push(apply(lower, &velocity(i - 1)));
            }
            if i + 1 < self.masses {
                terms.push(apply(upper, &velocity(i + 1)));
            }
            let side = self.right_side(i);
            for axis in 0..2 {
                missed = missed.max((terms.iter().map(|term| term[axis]).sum::<f64>() - side[axis]).abs());
                largest = largest.max(side[axis].abs());
            }
        }
        missed / largest
    }
}

/// m/β and the links' weights βc + D; the coupling to the neighbours is full, as it is in contact.
fn blocks(model: &Model, rows: &[ElementRow], beta: f64) -> Vec<MassBlocks> {
    let weight = |kind: LinkKind| {
        let law = &model.links[kind];
        let maxwell: f64 = rows.iter().filter(|row| row.kind == kind as usize).map(|row| beta * row.weight).sum();
        beta * law.stiffness + law.damping + maxwell
    };
    let [vertical, horizontal, lateral_x, lateral_z] = LinkKind::ALL.map(weight);
    let inertia = model.mass / beta;
    let beside = [-lateral_x, -0.1 * lateral_x, -0.1 * lateral_z, -lateral_z];
    let along = |to_carrier: f64, lateral: f64| inertia + to_carrier + 2.0 * lateral;
    let diagonal = [along(horizontal, lateral_x), 0.0, 0.0, along(vertical, lateral_z)];
    vec![MassBlocks { lower: beside, diagonal, upper: beside }; model.masses()]
}

/// a* = a + Σ w_j ȧ_j and H += c g a*.
#[inline(never)]
fn sum_history<const EARLIER: usize>(
    start: &[f64],
    earlier: [&[f64]; EARLIER],
    weights: &[f64; EARLIER],
    star: &mut [f64],
    force: &mut [f64],
    weight: f64,
) {
    let count = star.len();
    let (start, force) = (&start[..count], &mut force[..count]);
    let earlier = earlier.map(|rates| &rates[..count]);
    for i in 0..count {
        let mut sum = start[i];
        for j in 0..EARLIER {
            sum += weights[j] * earlier[j][i];
        }
        star[i] = sum;
        force[i] += weight * sum;
    }
}

/// ȧ = g (ė - a*/τ).
#[inline(never)]
fn update_rates(star: &[f64], elongation_rates: &[f64], rates: &mut [f64], row: &ElementRow) {
    for ((rate, star), elongation_rate) in rates.iter_mut().zip(star).zip(elongation_rates) {
        *rate = row.g * (elongation_rate - star * row.per_tau);
    }
}

#[inline(always)]
fn times(a: &MassBlock, b: &MassBlock) -> MassBlock {
    [a[0] * b[0] + a[1] * b[2], a[0] * b[1] + a[1] * b[3], a[2] * b[0] + a[3] * b[2], a[2] * b[1] + a[3] * b[3]]
}

#[inline(always)]
fn minus(a: &MassBlock, b: &MassBlock) -> MassBlock {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2], a[3] - b[3]]
}

#[inline(always)]
fn apply(a: &MassBlock, v: &MassPair) -> MassPair {
    [a[0] * v[0] + a[1] * v[1], a[2] * v[0] + a[3] * v[1]]
}

#[inline(always)]
fn inverse(a: &MassBlock) -> MassBlock {
    let factor = 1.0 / (a[0] * a[3] - a[1] * a[2]);
    [a[3] * factor, -a[1] * factor, -a[2] * factor, a[0] * factor]
}
