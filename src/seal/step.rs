//! Steps of a film in time, with the spring of its lip: the trapezoidal rule and the backward formula of second order in one
//! step, TR-BDF2 (R. E. Bank et al., IEEE Trans. Electron Devices 32, 1985; M. E. Hosea, L. F. Shampine, Appl. Numer. Math.
//! 20, 1996), whose error is told by its embedded formula of third order.
//!
//! In a stage y = r + a f(y) of Newton's method the matrix has five bands. A lip that slips on a spring of the stiffness K
//! has the speed V beside the contents, and the condition that the spring's force is the limit of friction L.

use super::film::{BANDS, Ends, Film};
use super::law::GapLaw;

/// The place of the inner stage.
pub(super) const INNER: f64 = 2.0 - std::f64::consts::SQRT_2;
/// What the stages count of themselves, and of the rates before in the last.
const OWN: f64 = 0.5 * INNER;
const BEFORE: f64 = 0.25 * std::f64::consts::SQRT_2;

/// The most iterations of a stage, and halvings of its step.
const MOST_ITERATIONS: usize = 25;
const MOST_HALVINGS: usize = 6;
/// Newton's last change over the tolerance of a step.
const NEWTON_SHARE: f64 = 0.01;
/// A content falls by an iteration to this part of it at least.
const LEAST_SHARE: f64 = 0.1;
/// Contents below this count as this in errors, m.
const FLOOR: f64 = 1e-9;

/// What a lip stands on and how it is driven over a step, at the speed u̇ (m/s) of the rod.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Drive {
    /// The film moves at this speed, m/s: that of a rigid lip, or none of one that sticks.
    Given(f64),
    /// The lip slips on its spring in this direction.
    Slips {
        /// 1 or -1.
        sign: f64,
        /// Where the step begins: the slip speed, m/s, and the force of the spring, N.
        speed: f64,
        force: f64,
        /// The stiffness of the spring, N/m.
        stiffness: f64,
        /// The speed of the rod, m/s.
        rod_speed: f64,
    },
}

/// What a lip rubs with: the limit of friction by contacts and fluid.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rubbing {
    /// The area of a cell, m².
    pub(super) area: f64,
    /// η times the speed whose shear it is, Pa m.
    pub(super) shear: f64,
}

/// The limit of friction, N.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Limit {
    /// By contacts.
    pub(super) solid: f64,
    /// By the fluid's shear.
    pub(super) viscous: f64,
}

impl Limit {
    /// Both.
    pub(super) fn whole(self) -> f64 {
        self.solid + self.viscous
    }
}

/// What a step comes to; flows by length along the lip.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Stepped {
    /// ∫ V dt, m.
    pub(super) travel: f64,
    /// What flowed out to the air, net, m².
    pub(super) out: f64,
    /// What flowed in from the sealed side, net, m².
    pub(super) into: f64,
    /// ∫ L |V| dt, J.
    pub(super) loss: f64,
    /// The speed at its end, m/s.
    pub(super) speed: f64,
    /// The error over the tolerance.
    pub(super) error: f64,
}

/// A stage was not solved.
#[derive(Clone, Copy, Debug)]
pub(super) struct NotSolved;

/// A matrix of five bands, eliminated without exchanges of rows: those of an implicit step are strictly dominant but for the
/// limiters' slopes.
#[derive(Clone, Debug)]
struct Banded {
    rows: Vec<[f64; BANDS]>,
}

impl Banded {
    /// Eliminates below the diagonal; the multipliers take the places of what they remove.
    fn factor(&mut self) {
        let count = self.rows.len();
        for i in 0..count {
            let pivot = self.rows[i];
            for below in 1..=2 {
                let Some(row) = self.rows.get_mut(i + below) else { break };
                let share = row[2 - below] / pivot[2];
                row[2 - below] = share;
                row[3 - below] -= share * pivot[3];
                row[4 - below] -= share * pivot[4];
            }
        }
    }

    fn solve(&self, right: &mut [f64]) {
        let count = right.len();
        for i in 1..count {
            let row = &self.rows[i];
            let far = if i > 1 { row[0] * right[i - 2] } else { 0.0 };
            right[i] -= row[1] * right[i - 1] + far;
        }
        for i in (0..count).rev() {
            let row = &self.rows[i];
            let near = if i + 1 < count { row[3] * right[i + 1] } else { 0.0 };
            let far = if i + 2 < count { row[4] * right[i + 2] } else { 0.0 };
            right[i] = (right[i] - near - far) / row[2];
        }
    }
}

/// The solver of steps, with its memory.
#[derive(Clone, Debug)]
pub(super) struct Stepper {
    matrix: Banded,
    /// The contents of the stage under way, and where a line search began.
    pub(super) contents: Vec<f64>,
    trial: Vec<f64>,
    right: Vec<f64>,
    residual: Vec<f64>,
    change: Vec<f64>,
    by_speed: Vec<f64>,
    /// Rates of the contents at the start, the inner stage and the end.
    rates: [Vec<f64>; 3],
    /// How L changes with each content, N/m.
    limit_slopes: Vec<f64>,
    /// Iterations so far.
    pub(super) iterations: usize,
}

/// A stage: y = r + a f(y).
struct Stage<'a> {
    law: &'a GapLaw,
    ends: &'a Ends,
    rubbing: Rubbing,
    factor: f64,
    tolerance: f64,
    /// In slip: the force where V is 0, how it falls with V, and the direction.
    slip: Option<[f64; 3]>,
}

impl Stepper {
    pub(super) fn new(count: usize) -> Self {
        let zeros = || vec![0.0; count];
        Self {
            matrix: Banded { rows: vec![[0.0; BANDS]; count] },
            contents: zeros(),
            trial: zeros(),
            right: zeros(),
            residual: zeros(),
            change: zeros(),
            by_speed: zeros(),
            rates: [zeros(), zeros(), zeros()],
            limit_slopes: zeros(),
            iterations: 0,
        }
    }

    /// The limit of friction of what a film was evaluated at last, with its slopes by the contents.
    pub(super) fn limit(&mut self, film: &Film, law: &GapLaw, contents: &[f64], rubbing: Rubbing) -> Limit {
        let mut limit = Limit::default();
        for (i, &content) in contents.iter().enumerate() {
            let (gap, total) = (film.gap(i), film.totals[i]);
            let borne = total - film.pressure(i);
            let (open, friction) = film.open_and_friction(law, i);
            let mut slope = -friction * film.stiffness(i);
            limit.solid += rubbing.area * friction * borne;
            // η|V| (1 - A) m/u²; with u as m where there is fluid enough.
            if content < gap {
                limit.viscous += rubbing.area * rubbing.shear * open.value * content / gap;
                slope += rubbing.shear * open.value / gap;
            } else {
                limit.viscous += rubbing.area * rubbing.shear * open.value;
                slope += rubbing.shear * open.slope;
            }
            self.limit_slopes[i] = rubbing.area * slope;
        }
        limit
    }

    /// L |V| of what a film was evaluated at last, W.
    fn power(&mut self, film: &Film, law: &GapLaw, contents: &[f64], rubbing: Rubbing, speed: f64) -> f64 {
        if speed == 0.0 { 0.0 } else { self.limit(film, law, contents, rubbing).whole() * speed.abs() }
    }

    /// How fast L changes at what a film was evaluated at last, at no slip, N/s, and by the speed of slip, N/m.
    pub(super) fn limit_rate(&self, film: &Film, speed: f64) -> [f64; 2] {
        let mut found = [0.0; 2];
        for (i, slope) in self.limit_slopes.iter().enumerate() {
            let by_speed = film.rate_by_speed(i);
            found[0] += slope * (film.rate(i) - speed * by_speed);
            found[1] += slope * by_speed;
        }
        found
    }

    /// A step of `h` (s) from `start` (m): its end stands in `contents`. `at` sets the pressures of an instant of the step,
    /// from 0 to 1, and says what is beyond the ends.
    pub(super) fn step(
        &mut self,
        film: &mut Film,
        law: &GapLaw,
        start: &[f64],
        (h, tolerance): (f64, f64),
        (drive, rubbing): (Drive, Rubbing),
        mut at: impl FnMut(&mut Film, f64) -> Ends,
    ) -> Result<Stepped, NotSolved> {
        let first_speed = match drive {
            Drive::Given(speed) | Drive::Slips { speed, .. } => speed,
        };
        let weights = [BEFORE * h, BEFORE * h, OWN * h];
        // The start.
        let ends = at(film, 0.0);
        film.evaluate(law, start, first_speed, &ends);
        let mut stepped = Stepped::default();
        let mut power = [self.power(film, law, start, rubbing, first_speed), 0.0, 0.0];
        let mut speeds = [first_speed, 0.0, 0.0];
        let out = |film: &Film| film.flows[film.flows.len() - 1];
        stepped.out += weights[0] * out(film);
        (0..start.len()).for_each(|i| self.rates[0][i] = film.rate(i));
        // The inner stage by the trapezoidal rule, then the end by all three rates.
        self.contents.copy_from_slice(start);
        for stage in 1..3 {
            let place = if stage == 1 { INNER } else { 1.0 };
            let ends = at(film, place);
            for i in 0..start.len() {
                let known = if stage == 1 {
                    OWN * h * self.rates[0][i]
                } else {
                    weights[0] * self.rates[0][i] + weights[1] * self.rates[1][i]
                };
                self.right[i] = start[i] + known;
            }
            let slipped =
                if stage == 1 { OWN * h * speeds[0] } else { weights[0] * speeds[0] + weights[1] * speeds[1] };
            let slip = drive.slip(place * h, slipped, OWN * h);
            let of = Stage { law, ends: &ends, rubbing, factor: OWN * h, tolerance: NEWTON_SHARE * tolerance, slip };
            speeds[stage] = self.solve(film, &of, if slip.is_some() { speeds[stage - 1] } else { first_speed })?;
            // By what they made of the contents: those of the fluxes are off by what is left of a stiff residual.
            let (rates, made) = (&mut self.rates[stage], self.contents.iter().zip(&self.right));
            rates.iter_mut().zip(made).for_each(|(rate, (content, right))| *rate = (content - right) / (OWN * h));
            stepped.out += weights[stage] * out(film);
            let contents = std::mem::take(&mut self.contents);
            power[stage] = self.power(film, law, &contents, rubbing, speeds[stage]);
            self.contents = contents;
        }
        stepped.travel = speeds.iter().zip(weights).map(|(speed, weight)| speed * weight).sum();
        stepped.loss = power.iter().zip(weights).map(|(power, weight)| power * weight).sum();
        stepped.speed = speeds[2];
        stepped.error = self.error(start, h, tolerance);
        // The fluid is kept: what flows in is what flows out and stays.
        let stays: f64 = self.contents.iter().zip(start).map(|(end, start)| end - start).sum();
        stepped.into = stepped.out + film.width() * stays;
        Ok(stepped)
    }

    /// Solves a stage from the contents that there are; returns the speed.
    fn solve(&mut self, film: &mut Film, stage: &Stage<'_>, mut speed: f64) -> Result<f64, NotSolved> {
        let count = self.contents.len();
        let (mut norm, mut lack) = self.residual(film, stage, speed, false);
        let mut before = f64::INFINITY;
        for _ in 0..MOST_ITERATIONS {
            self.iterations += 1;
            self.assemble(film, stage.factor);
            self.matrix.factor();
            self.change.iter_mut().zip(&self.residual).for_each(|(change, residual)| *change = -residual);
            self.matrix.solve(&mut self.change);
            let mut speed_change = 0.0;
            if let Some([_, falls, sign]) = stage.slip {
                (0..count).for_each(|i| self.by_speed[i] = stage.factor * film.rate_by_speed(i));
                self.matrix.solve(&mut self.by_speed);
                let along = |with: &[f64]| self.limit_slopes.iter().zip(with).map(|(a, b)| a * b).sum::<f64>();
                speed_change = (lack - sign * along(&self.change)) / (falls + sign * along(&self.by_speed));
                let by_speed = &self.by_speed;
                self.change.iter_mut().zip(by_speed).for_each(|(change, by)| *change += by * speed_change);
            }
            let contents = &self.contents;
            let largest = self.change.iter().zip(contents).map(|(change, content)| (change / (content + FLOOR)).abs());
            let largest = largest.fold((speed_change / (speed.abs() + LEAST_SPEED)).abs(), f64::max);
            if !largest.is_finite() {
                return Err(NotSolved);
            }
            self.trial.copy_from_slice(&self.contents);
            let mut share = 1.0;
            for halving in 0..=MOST_HALVINGS {
                for i in 0..count {
                    let from = self.trial[i];
                    self.contents[i] = (from + share * self.change[i]).max(LEAST_SHARE * from);
                }
                let found = self.residual(film, stage, speed + share * speed_change, true);
                if found.0 < (1.0 - 0.1 * share) * norm || largest <= stage.tolerance || halving == MOST_HALVINGS {
                    (norm, lack) = found;
                    speed += share * speed_change;
                    break;
                }
                share *= 0.5;
            }
            // What is left is the change times the rate of convergence, of whole steps (E. Hairer, G. Wanner, Solving Ordinary
            // Differential Equations II, IV.8.10).
            let rate = if share == 1.0 { largest / before } else { 1.0 };
            if largest <= stage.tolerance || (rate < 1.0 && largest * rate / (1.0 - rate) <= stage.tolerance) {
                return Ok(speed);
            }
            before = largest;
        }
        Err(NotSolved)
    }

    /// y - r - a f(y) over the contents, the largest of it, and by how much the spring's force exceeds the limit, N.
    fn residual(&mut self, film: &mut Film, stage: &Stage<'_>, speed: f64, is_trial: bool) -> (f64, f64) {
        film.evaluate(stage.law, &self.contents, speed, stage.ends);
        let weights = if is_trial { &self.trial } else { &self.contents };
        let mut norm = 0.0_f64;
        for i in 0..self.contents.len() {
            self.residual[i] = self.contents[i] - self.right[i] - stage.factor * film.rate(i);
            norm = norm.max((self.residual[i] / (weights[i] + FLOOR)).abs());
        }
        let Some([force, falls, sign]) = stage.slip else { return (norm, 0.0) };
        let contents = std::mem::take(&mut self.contents);
        let limit = self.limit(film, stage.law, &contents, stage.rubbing).whole();
        self.contents = contents;
        let lack = force - falls * speed - sign * limit;
        (norm.max((lack / (limit + f64::MIN_POSITIVE)).abs()), lack)
    }

    /// The matrix of a stage, 1 - a ∂f/∂m, at what was evaluated last.
    fn assemble(&mut self, film: &Film, factor: f64) {
        for (i, row) in self.matrix.rows.iter_mut().enumerate() {
            *row = film.rate_slopes(i).map(|slope| -factor * slope);
            row[2] += 1.0;
        }
    }

    /// The error over the tolerance: the difference of the formula of third order, through the matrix of the last stage so
    /// that what is stiff does not count.
    fn error(&mut self, start: &[f64], h: f64, tolerance: f64) -> f64 {
        let weights = [(1.0 - BEFORE) / 3.0 - BEFORE, (3.0 * BEFORE + 1.0) / 3.0 - BEFORE, OWN / 3.0 - OWN];
        for i in 0..start.len() {
            self.change[i] = h * (0..3).map(|k| weights[k] * self.rates[k][i]).sum::<f64>();
        }
        self.matrix.solve(&mut self.change);
        let scaled = (0..start.len()).map(|i| self.change[i].abs() / (start[i].max(self.contents[i]) + FLOOR));
        scaled.fold(0.0, f64::max) / tolerance
    }
}

/// Speeds below this count as this where a change of them is judged, m/s.
const LEAST_SPEED: f64 = 1e-9;

impl Drive {
    /// The force of the spring once V counts `own` (s) and the slip before it `slipped` (m) at `time` (s) of the step: where V
    /// is 0, and how it falls with V.
    fn slip(self, time: f64, slipped: f64, own: f64) -> Option<[f64; 3]> {
        let Self::Slips { sign, force, stiffness, rod_speed, .. } = self else { return None };
        Some([force + stiffness * (rod_speed * time - slipped), stiffness * own, sign])
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{law, pressed};
    use super::*;

    #[test]
    fn five_bands_are_solved() {
        let count = 7;
        let entry = |i: usize, k: usize| if k == 2 { 4.0 + i as f64 } else { ((3 * i + k) as f64).sin() };
        let mut matrix = Banded { rows: (0..count).map(|i| std::array::from_fn(|k| entry(i, k))).collect() };
        let exact: Vec<f64> = (0..count).map(|i| 1.0 + i as f64).collect();
        let mut right: Vec<f64> = (0..count)
            .map(|i| (0..BANDS).filter_map(|k| Some(entry(i, k) * exact.get((i + k).checked_sub(2)?)?)).sum())
            .collect();
        matrix.factor();
        matrix.solve(&mut right);
        right.iter().zip(&exact).for_each(|(found, exact)| assert!((found - exact).abs() < 1e-12));
    }

    /// Of second order; what is there is what flowed in less what flowed out.
    #[test]
    fn steps_are_of_second_order_and_keep_the_fluid() {
        let (law, count) = (law(0.02), 16);
        let mut film = Film::new(count, 2e-5, true);
        film.set_viscosity(0.05);
        let (rubbing, duration) = (Rubbing { area: 1e-6, shear: 1e-3 }, 2e-4);
        let mut run = |steps: usize| -> (Vec<f64>, f64) {
            let mut stepper = Stepper::new(count);
            film.set_totals(&law, |i| pressed(i, count));
            let mut contents: Vec<f64> = film.bearing().iter().map(|gap| 1.3 * gap).collect();
            let volume = |contents: &[f64]| 2e-5 * contents.iter().sum::<f64>();
            let (begun, mut flowed) = (volume(&contents), 0.0);
            for _ in 0..steps {
                let ends = Ends { sealed: 0.0, supply: 1e-6, carried_in: 0.0 };
                let stepped = stepper
                    .step(
                        &mut film,
                        &law,
                        &contents,
                        (duration / steps as f64, 1e-8),
                        (Drive::Given(0.02), rubbing),
                        |_, _| ends,
                    )
                    .unwrap();
                flowed += stepped.into - stepped.out;
                contents.copy_from_slice(&stepper.contents);
            }
            let kept = (volume(&contents) - begun - flowed).abs() / begun;
            (contents, kept)
        };
        let (exact, _) = run(2048);
        let errors = [16, 32, 64].map(|steps| {
            let (found, kept) = run(steps);
            assert!(kept < 1e-12, "{kept}");
            found.iter().zip(&exact).map(|(a, b)| (a / b - 1.0).abs()).fold(0.0, f64::max)
        });
        // Limiters and the law's rows have kinks: about 4.
        assert!(errors[0] / errors[2] > 9.0, "{errors:?}");
    }
}
