//! The contact of a sliding surface of rubber: which points touch, and under what pressure (docs/steady.md, "The problem"
//! and "The method").
//!
//! For a set of points the pressures follow [linearly](super::linear). Points that would be pulled leave the set, points
//! that would lie below the surface come to it, until there are neither; the first set is that of a grid twice as coarse.

use std::collections::HashSet;
use std::hash::{DefaultHasher, Hash, Hasher};

use super::linear::{Compliance, LinearSolver, gather, scatter};
use super::surface::SurfaceGrid;
use super::transform::{Convolution, GridSize};
use asperity::math::{SplitMix64, sum};
use asperity::scene::Material;

/// The residual (root mean square over the contact) of the last set over the rms height.
const ACCURACY: f64 = 1.0e-6;
/// That of the first set of the finest grid, of ridges and of maps, where more of the points lie at edges and are wrong at
/// first; each set after it has a tenth.
const FIRST_ACCURACIES: (f64, f64) = (1.0e-3, 3.0e-2);
/// Those of the first and of the last set of a grid from which a finer one starts, ...
const COARSE_ACCURACIES: (f64, f64) = (1.0e-3, 1.0e-4);
/// ... and the part of the points of its set that may still be wrong.
const COARSE_WRONG: f64 = 0.2;
/// Points this part of the peak to valley below the surface come to the contact.
const BELOW: f64 = 1.0e-7;
/// The pressure that a point begins with as it comes to the contact, over the mean.
const NEXT_TO_NOTHING: f64 = 1.0e-6;
/// The most sets of a grid.
const MOST_SETS: usize = 20;
/// Where the real part of the compliance of each wave is more than this part of it, sets do not swing.
const SWINGS: f64 = 0.35;
/// What is added to the compliance becomes smaller by this factor from rung to rung, where that fails by a smaller one, ...
const LADDER_STEP: f64 = 4.0;
const LEAST_LADDER_STEP: f64 = 1.5;
/// ... until it is this part of the least compliance; then nothing is added.
const LEAST_PROXIMAL: f64 = 0.02;
/// The most rungs, and the sets of each.
const MOST_RUNGS: usize = 120;
const SETS_OF_RUNG: usize = 8;
/// The most sets of a grid from which a finer one starts.
const MOST_COARSE_SETS: usize = 6;
/// The accuracy of the derivative by the separation.
const DERIVATIVE_ACCURACY: f64 = 1.0e-3;

/// What a contact is in.
#[derive(Clone, Debug)]
pub struct Contact {
    /// The points in contact, ascending.
    pub points: Vec<u32>,
    /// Their pressures, Pa.
    pub pressures: Vec<f64>,
    /// The gaps of all points of the surface, m: 0 of those in contact.
    pub gaps: Vec<f64>,
    /// Separation d of the mean planes, m.
    pub separation: f64,
    /// Whether all points are in contact.
    pub is_full: bool,
    /// Points that are pulled or lie below the surface: 0 but where no set was found.
    pub left_over: usize,
    /// How many sets were tried on the grid itself.
    pub sets: usize,
    /// To which the last one was solved.
    accuracy: f64,
}

/// The solver of contacts on a surface and the coarser grids of it, with its memory.
#[derive(Debug)]
pub(super) struct ContactSolver {
    /// From the finest.
    levels: Vec<Level>,
}

#[derive(Debug)]
struct Level {
    surface: SurfaceGrid,
    linear: LinearSolver,
    rms: f64,
    peak_to_valley: f64,
}

/// A linear complementarity problem: pressures p ≥ 0 of a mean (Pa), under which the surface lies on or above the heights (m);
/// and the rms height and the peak to valley of its surface (m), over which it is solved.
#[derive(Clone, Copy, Debug)]
struct Obstacle<'a> {
    compliance: &'a Compliance,
    heights: &'a [f64],
    pressure: f64,
    rms: f64,
    peak_to_valley: f64,
}

/// How far a grid is solved.
#[derive(Clone, Copy, Debug)]
struct Goal {
    first_accuracy: f64,
    accuracy: f64,
    /// Points that may be wrong, as a part of the set.
    wrong: f64,
    sets: usize,
}

impl ContactSolver {
    /// The solver on a surface.
    pub(super) fn new(surface: SurfaceGrid) -> Self {
        let coarser = |surface: &SurfaceGrid| surface.coarser();
        let levels = std::iter::successors(Some(surface), coarser).map(Level::new).collect();
        Self { levels }
    }

    /// The surface.
    pub(super) fn surface(&self) -> &SurfaceGrid {
        &self.levels[0].surface
    }

    /// The transforms of the surface's grid.
    pub(super) fn convolution(&mut self) -> &mut Convolution {
        &mut self.levels[0].linear.convolution
    }

    /// The pairs of transforms so far, those of a coarser grid by its part of the points.
    pub(super) fn pairs(&self) -> f64 {
        let points = |level: &Level| level.surface.size.points() as f64;
        let whole = points(&self.levels[0]);
        self.levels.iter().map(|level| level.linear.convolution.pairs() as f64 * points(level) / whole).sum()
    }

    /// The contact of `material` under the mean `pressure` (Pa), sliding at `speed` (m/s); and its compliance.
    pub(super) fn solve(
        &mut self,
        material: &Material,
        wave_stiffness: impl Fn(f64) -> f64,
        speed: f64,
        pressure: f64,
    ) -> (Contact, Compliance) {
        let compliance = |level: &Level| Compliance::new(&level.surface, material, &wave_stiffness, speed);
        // Step 1: full contact, where p = P + M K h is nowhere a pull.
        let finest = compliance(&self.levels[0]);
        if let Some(full) = self.levels[0].full_contact(&finest, None, pressure) {
            return (full, finest);
        }
        // Step 3: from the coarsest grid up, each solved from the pressures of the one before; the coarsest of all from P
        // at all points.
        let mut start: Option<(Contact, usize)> = None;
        for index in (0..self.levels.len()).rev() {
            let level = &mut self.levels[index];
            let first = match &start {
                None => vec![pressure; level.surface.size.points()],
                Some((coarse, nx)) => level.interpolated(coarse, *nx),
            };
            if index == 0 {
                return (level.solve(&finest, None, first, pressure), finest);
            }
            let compliance = compliance(level);
            let found = level.solve_to(Goal::COARSE, &compliance, None, first, pressure);
            start = Some((found, level.surface.size.nx));
        }
        // There is always a finest level, which returns.
        (Contact::nothing(), finest)
    }

    /// The contact with other `heights` (m) and under another compliance than one that was found.
    pub(super) fn solve_again(
        &mut self,
        compliance: &Compliance,
        heights: &[f64],
        found: &Contact,
        pressure: f64,
    ) -> Contact {
        let level = &mut self.levels[0];
        if let Some(full) = level.full_contact(compliance, Some(heights), pressure) {
            return full;
        }
        let mut first = vec![0.0; heights.len()];
        scatter(&found.points, &found.pressures, &mut first);
        level.solve(compliance, Some(heights), first, pressure)
    }

    /// The change of the mean pressure with the separation at a contact whose points stay, Pa/m, under a compliance; `None`
    /// of full contact.
    pub(super) fn stiffness(&mut self, compliance: &Compliance, contact: &Contact) -> Option<f64> {
        if contact.is_full || contact.points.len() < 2 {
            return None;
        }
        let level = &mut self.levels[0];
        // p' with C p' + d' = 0 on the set and mean p' = 1: the derivatives by the mean pressure, as the points stay.
        let n = contact.points.len() as f64;
        // Of the mean 1 over the grid; the pressures themselves are a good start.
        let scale = level.surface.size.points() as f64 / sum(&contact.pressures);
        let mut p: Vec<f64> = contact.pressures.iter().map(|pressure| scale * pressure).collect();
        // The residual -C p' there; its mean over the set is d'.
        let mut residual = vec![0.0; p.len()];
        let moved = level.linear.moved(compliance, &contact.points, &p);
        gather(&contact.points, moved, &mut residual);
        residual.iter_mut().for_each(|value| *value = -*value);
        let separation = |residual: &[f64]| (sum(residual) / n).abs();
        let accuracy = DERIVATIVE_ACCURACY * separation(&residual);
        level.linear.solve(compliance, &contact.points, &mut p, &mut residual, accuracy);
        let moved = level.linear.moved(compliance, &contact.points, &p);
        gather(&contact.points, moved, &mut residual);
        // dp/dd = 1/d', with d' = -C p' in the mean over the set.
        Some(1.0 / separation(&residual))
    }
}

impl Goal {
    const COARSE: Self = Self {
        first_accuracy: COARSE_ACCURACIES.0,
        accuracy: COARSE_ACCURACIES.1,
        wrong: COARSE_WRONG,
        sets: MOST_COARSE_SETS,
    };

    fn finest(size: GridSize) -> Self {
        let first_accuracy = if size.ny == 1 { FIRST_ACCURACIES.0 } else { FIRST_ACCURACIES.1 };
        Self { first_accuracy, accuracy: ACCURACY, wrong: 0.0, sets: MOST_SETS }
    }

    /// That of a rung of the ladder.
    fn of_rung(self) -> Self {
        Self { first_accuracy: COARSE_ACCURACIES.0, sets: SETS_OF_RUNG, ..self }
    }

    /// Whether a contact is solved as far.
    fn is_met(self, contact: &Contact) -> bool {
        contact.left_over as f64 <= self.wrong * contact.points.len() as f64 && contact.accuracy <= self.accuracy
    }

    /// The accuracy of the set after one.
    fn next(self, accuracy: f64) -> f64 {
        let tenth = 0.1 * accuracy;
        // No set for what rounding leaves of the last power of ten.
        if tenth < 1.5 * self.accuracy { self.accuracy } else { tenth }
    }
}

impl Contact {
    fn nothing() -> Self {
        Self {
            points: Vec::new(),
            pressures: Vec::new(),
            gaps: Vec::new(),
            separation: 0.0,
            is_full: false,
            left_over: 0,
            sets: 0,
            accuracy: 0.0,
        }
    }

    /// Points in contact over all, 1.
    pub fn area(&self, surface: &SurfaceGrid) -> f64 {
        self.points.len() as f64 / surface.size.points() as f64
    }
}

impl Level {
    fn new(surface: SurfaceGrid) -> Self {
        let linear = LinearSolver::new(Convolution::new(surface.size));
        let (rms, peak_to_valley) = (surface.rms_height(), surface.peak_to_valley());
        Self { surface, linear, rms, peak_to_valley }
    }

    /// p = P + M K h, where that is nowhere a pull.
    fn full_contact(&mut self, compliance: &Compliance, heights: Option<&[f64]>, pressure: f64) -> Option<Contact> {
        // The surface would lie on h everywhere: û = h, less its mean, needs p_q = M K h_q.
        let mut p = heights.unwrap_or(&self.surface.heights).to_vec();
        self.linear.convolution.apply(&mut p, &compliance.stiffness);
        p.iter_mut().for_each(|p| *p += pressure);
        p.iter().all(|&p| p > 0.0).then(|| Contact {
            points: (0..p.len() as u32).collect(),
            gaps: vec![0.0; p.len()],
            pressures: p,
            is_full: true,
            ..Contact::nothing()
        })
    }

    /// The pressures of a coarser grid, of rows of `coarse_nx`, between its points.
    fn interpolated(&self, coarse: &Contact, coarse_nx: usize) -> Vec<f64> {
        let (nx, ny) = (self.surface.size.nx, self.surface.size.ny);
        // Ridges have one row, which is not divided.
        let coarse_ny = if ny == 1 { 1 } else { ny / 2 };
        let mut values = vec![0.0; coarse_nx * coarse_ny];
        coarse.points.iter().zip(&coarse.pressures).for_each(|(&point, p)| values[point as usize] = *p);
        let mut fine = vec![0.0; nx * ny];
        let step_y = if ny == 1 { 1 } else { 2 };
        for (j, row) in fine.chunks_exact_mut(nx).enumerate() {
            // The coarse rows around this one, the same twice where it is one of them; periodic.
            let (here, next) = (j / step_y, (j + 1) / step_y % coarse_ny);
            let next = if step_y == 1 { here } else { next };
            for (i, value) in row.iter_mut().enumerate() {
                // Alike the points; so the mean of the four is the bilinear interpolation.
                let (left, right) = (i / 2, i.div_ceil(2) % coarse_nx);
                let at = |i: usize, j: usize| values[j * coarse_nx + i];
                *value = 0.25 * (at(left, here) + at(right, here) + at(left, next) + at(right, next));
            }
        }
        fine
    }

    /// [`solve_to`](Self::solve_to) the last digits.
    fn solve(&mut self, compliance: &Compliance, heights: Option<&[f64]>, field: Vec<f64>, pressure: f64) -> Contact {
        self.solve_to(Goal::finest(self.surface.size), compliance, heights, field, pressure)
    }

    /// The contact from the pressures `field` (Pa) at all points, of any mean: the first set is where they are positive. With
    /// other heights (m) than those of the surface, where some are given.
    fn solve_to(
        &mut self,
        goal: Goal,
        compliance: &Compliance,
        heights: Option<&[f64]>,
        field: Vec<f64>,
        pressure: f64,
    ) -> Contact {
        let Self { surface, linear, rms, peak_to_valley } = self;
        let (rms, peak_to_valley) = (*rms, *peak_to_valley);
        let heights = heights.unwrap_or(&surface.heights);
        let obstacle = Obstacle { compliance, heights, pressure, rms, peak_to_valley };
        if compliance.least_storage() <= SWINGS {
            return obstacle.by_ladder(linear, surface, field, goal);
        }
        let found = obstacle.by_sets(linear, field.clone(), goal);
        // A grid from which a finer one starts is good enough.
        if goal.is_met(&found) || goal.wrong > 0.0 {
            return found;
        }
        let ladder = obstacle.by_ladder(linear, surface, field, goal);
        Contact { sets: found.sets + ladder.sets, ..ladder }
    }
}

impl Obstacle<'_> {
    /// The contact by the proximal point algorithm, from the pressures `field` (Pa) at all points of a surface.
    ///
    /// Loss far above storage lets sets swing. The operator is strictly monotone all the same, so that this finds the one
    /// solution (R. T. Rockafellar, SIAM J. Control Optim. 14, 1976): (C + ε) p + d = h + ε x on the set, where x is the solution
    /// before, whose sets swing the less the larger ε is.
    fn by_ladder(&self, linear: &mut LinearSolver, surface: &SurfaceGrid, field: Vec<f64>, goal: Goal) -> Contact {
        let (share, goal) = (surface.share_of_point(), goal.of_rung());
        let [eight, least] = self.compliance.sizes(surface.size);
        let (mut epsilon, mut factor, mut x) = (eight, LADDER_STEP, field);
        let (mut found, mut sets) = (Contact::nothing(), 0);
        for _ in 0..MOST_RUNGS {
            if epsilon < LEAST_PROXIMAL * least {
                epsilon = 0.0;
            }
            let by = epsilon / share;
            let heights: Vec<f64> = self.heights.iter().zip(&x).map(|(height, x)| height + by * x).collect();
            let proximal = (epsilon > 0.0).then(|| self.compliance.with(|_| epsilon.into(), share));
            let compliance = proximal.as_ref().unwrap_or(self.compliance);
            let rung = Obstacle { compliance, heights: &heights, ..*self };
            found = rung.by_sets(linear, x.clone(), goal);
            sets += found.sets;
            found.sets = sets;
            match (goal.is_met(&found), epsilon == 0.0) {
                (true, true) => return found,
                (true, false) => {
                    x.fill(0.0);
                    let least = NEXT_TO_NOTHING * self.pressure;
                    found.points.iter().zip(&found.pressures).for_each(|(&point, p)| x[point as usize] = p.max(least));
                    epsilon /= factor;
                    factor = LADDER_STEP;
                }
                (false, true) => {
                    factor = smaller(factor);
                    epsilon = LEAST_PROXIMAL * least * factor * factor;
                }
                (false, false) => {
                    epsilon *= factor;
                    factor = smaller(factor);
                }
            }
        }
        found.left_over = found.left_over.max(1);
        found
    }

    /// The contact by sets alone, from the pressures `field` (Pa) at all points.
    fn by_sets(&self, linear: &mut LinearSolver, mut field: Vec<f64>, goal: Goal) -> Contact {
        let (count, pressure) = (self.heights.len(), self.pressure);
        let (mut seen, mut accuracy) = (HashSet::new(), goal.first_accuracy);
        let mut gaps = vec![0.0; count];
        let mut found = Contact::nothing();
        for sets in 1..=goal.sets {
            // The set, and its pressures scaled to mean p = P; the linear problem holds their sum.
            let points: Vec<u32> = (0..count as u32).filter(|&point| field[point as usize] > 0.0).collect();
            let mut pressures: Vec<f64> = points.iter().map(|&point| field[point as usize]).collect();
            let scale = pressure * count as f64 / sum(&pressures);
            pressures.iter_mut().for_each(|p| *p *= scale);
            let separation = self.solve_set(linear, &points, &mut pressures, accuracy * self.rms, &mut gaps);

            // Step 2, who is wrong: p < 0 on the set is a pull, g < 0 beside it lies below. Gaps are known as well as they
            // were solved for.
            let known = if accuracy > goal.accuracy { accuracy * self.rms } else { 0.0 };
            let below = -known.max(BELOW * self.peak_to_valley);
            let leave = pressures.iter().filter(|&&p| p < 0.0).count();
            let come = gaps.iter().filter(|&&gap| gap < below).count();
            let left_over = leave + come;
            let is_full = points.len() == count;
            found = Contact { points, pressures, separation, is_full, left_over, sets, accuracy, ..Contact::nothing() };
            // p ≥ 0 on the set and g ≥ 0 beside it, as far as this grid is to be solved.
            if goal.is_met(&found) {
                break;
            }

            // The next set, step 4: half of the wrong ones change where this one has been before, so that sets do not
            // go round. Those that come begin with next to nothing, which makes them part of it.
            let is_new = left_over == 0 || seen.insert((fingerprint(&found.points), accuracy.to_bits()));
            let mut random = SplitMix64::new(sets as u64);
            let mut changes = || is_new || random.unit() < 0.5;
            let least = NEXT_TO_NOTHING * pressure;
            field.fill(0.0);
            for (&point, &p) in found.points.iter().zip(&found.pressures) {
                field[point as usize] = if p >= 0.0 {
                    p.max(least)
                } else if changes() {
                    0.0
                } else {
                    least
                };
            }
            for (value, gap) in field.iter_mut().zip(&gaps) {
                if *gap < below && changes() {
                    *value = least;
                }
            }
            accuracy = goal.next(accuracy);
        }
        Contact { gaps, ..found }
    }

    /// Solves for the pressures on a set, and writes the gaps of all points, 0 on the set; returns the separation, m.
    fn solve_set(
        &self,
        linear: &mut LinearSolver,
        set: &[u32],
        pressures: &mut [f64],
        tolerance: f64,
        gaps: &mut [f64],
    ) -> f64 {
        // C p + d = h on the set: u = C p is how the surface moves, g = u + d - h.
        let Self { compliance, heights, .. } = *self;
        let mut residual = vec![0.0; set.len()];
        let off = |moved: &[f64], residual: &mut [f64]| {
            set.iter().zip(residual).for_each(|(&point, off)| *off = heights[point as usize] - moved[point as usize]);
        };
        off(linear.moved(compliance, set, pressures), &mut residual);
        linear.solve(compliance, set, pressures, &mut residual, tolerance);
        let moved = linear.moved(compliance, set, pressures);
        off(moved, &mut residual);
        // d is the mean of h - C p over the set; what is left of the differences from it is within the tolerance.
        let separation = sum(&residual) / residual.len() as f64;
        let gap = |(moved, height): (&f64, &f64)| moved + separation - height;
        gaps.iter_mut().zip(moved.iter().zip(heights).map(gap)).for_each(|(gap, found)| *gap = found);
        set.iter().for_each(|&point| gaps[point as usize] = 0.0);
        separation
    }
}

/// The factor of the ladder after a rung that failed.
fn smaller(factor: f64) -> f64 {
    factor.powf(0.7).max(LEAST_LADDER_STEP)
}

fn fingerprint(points: &[u32]) -> u64 {
    let mut hasher = DefaultHasher::new();
    points.hash(&mut hasher);
    hasher.finish()
}
