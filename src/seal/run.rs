//! A run of a seal: its film in time, the spring of its lip, what leaks and what it loses.

use serde::{Deserialize, Serialize};

use super::definition::Seal;
use super::film::{Ends, Film};
use super::law::GapLaw;
use super::rod::RodFilm;
use super::step::{Drive, Limit, Rubbing, Stepped, Stepper};
use crate::math::{not_finite, root_between};
use crate::scene::{Air, SealGroup, TableExtrapolation, is_possible};

/// Why a motion of a seal is refused; the seal is then as it was.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FilmError {
    /// A number is not one, or out of range.
    #[error("{what} is {value:?} at t = {time} s, which is out of range; the step was not done")]
    OutOfRange {
        /// Which number.
        what: &'static str,
        /// Its value.
        value: f64,
        /// The time, s.
        time: f64,
    },
    /// The sealed pressure opens the lip.
    #[error(
        "the seal is blown open at t = {time} s: the sealed pressure {sealed} Pa is above the {total} Pa that press the lip \
         at its sealed side"
    )]
    BlownOpen {
        /// The time, s.
        time: f64,
        /// Pa.
        sealed: f64,
        /// Pa.
        total: f64,
        /// Whether a shorter step may end before.
        within: bool,
    },
    /// The sealed pressure or the temperature is beyond what is known.
    #[error("{what} {value} is beyond {least} to {largest} at t = {time} s")]
    Beyond {
        /// Which of them, with its unit.
        what: &'static str,
        /// Its value.
        value: f64,
        /// The time, s.
        time: f64,
        /// The least that is known.
        least: f64,
        /// The largest.
        largest: f64,
        /// Whether a shorter step may end before.
        within: bool,
    },
    /// The steps of the film become too many.
    #[error("gave up the step at t = {time} s: its film takes too many steps; do shorter ones")]
    TooMuchWork {
        /// The time reached, s.
        time: f64,
    },
}

/// Why a run cannot be continued from a saved state.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FilmRestoreError {
    /// A number that is not valid in any run.
    #[error("invalid state: {what} = {value}")]
    Invalid {
        /// Which number.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// The state is of another number of cells.
    #[error("invalid state: {found} cells, expected {expected}")]
    Count {
        /// In the state.
        found: usize,
        /// In the seal.
        expected: usize,
    },
}

/// Where a run begins: the inputs.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SealStart {
    /// The time, s.
    pub time: f64,
    /// Displacement of the rod to the air, m.
    pub u: f64,
    /// How far the lip is lifted, m.
    pub w: f64,
    /// The sealed pressure, Pa.
    pub sealed_pressure: f64,
    /// The temperature, K; 0 where nothing depends on it.
    pub temperature: f64,
    /// The speed of the rod, m/s.
    pub u_rate: f64,
}

/// How inputs move over a step: straight from where they stand.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SealMotion {
    /// How long the step takes, s.
    pub duration: f64,
    /// The speed of the rod, m/s.
    pub u_rate: f64,
    /// The rate of w, m/s.
    pub w_rate: f64,
    /// The rate of the sealed pressure, Pa/s.
    pub pressure_rate: f64,
    /// The temperature over the step, K.
    pub temperature: f64,
}

/// All that changes in a run, SI units.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SealState {
    pub(super) totals: Totals,
    contents: Vec<f64>,
    rod: RodFilm,
}

/// The numbers of a state.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Totals {
    pub(super) time: f64,
    pub(super) u: f64,
    pub(super) w: f64,
    pub(super) sealed: f64,
    pub(super) temperature: f64,
    /// The rates of the last step.
    pub(super) u_rate: f64,
    pub(super) w_rate: f64,
    pub(super) pressure_rate: f64,
    /// The force of the lip's spring on the rod, against the motion, N.
    pub(super) spring: f64,
    /// The direction of slip, 0 where the lip sticks.
    pub(super) slips: f64,
    /// The speed of slip, m/s.
    pub(super) speed: f64,
    /// What leaked, net, by length along the lip, m².
    leaked: f64,
    /// What came in from the sealed side, net, likewise, m².
    drawn: f64,
    /// Energy lost, J.
    pub(super) lost: f64,
    /// Its mean rate over the last step, W.
    pub(super) power: f64,
    /// The length of the step that comes next within one, s; 0: not known.
    next_step: f64,
}

/// A run of a seal. A clone continues as the original does, bit for bit.
#[derive(Clone, Debug)]
pub struct SealRun {
    pub(super) seal: Seal,
    law: GapLaw,
    pub(super) film: Film,
    stepper: Stepper,
    pub(super) state: SealState,
    /// The state at the start of the step under way.
    before: SealState,
    /// The limit of friction now.
    pub(super) limit: Limit,
    /// d F_x/d u and d film.leak/d u of the last step, where asked for.
    pub(super) tangents: [f64; 2],
    warned: bool,
    warnings: Vec<String>,
    /// Up to which number of iterations the call under way may go: see [`limit_work`](Self::limit_work).
    last_iteration: Option<usize>,
}

/// The most work of a step, or of all steps of a call: iterations times cells, a second of a processor.
const MOST_WORK: usize = 10_000_000;
/// Shares by which steps may shrink and grow.
const SHRINKS_TO: f64 = 0.2;
const GROWS_BY: f64 = 4.0;
/// What is left of the tolerance.
const SAFETY: f64 = 0.8;
/// A force this part below the limit is at it; a change between stick and slip is located to this part of a step.
const LOCATED: f64 = 1e-9;
/// A step this part of that of a master, which is still too long, is given up.
const SHORTEST: f64 = 1e-12;
/// The length of the first step over the time that the film takes through a cell.
const FIRST_STEP: f64 = 0.1;

impl SealRun {
    /// A seal at its start: its film as given, or as after a long rest.
    ///
    /// # Errors
    /// [`FilmError`] where a number is out of range, or the seal is open.
    pub fn new(seal: &Seal, start: &SealStart) -> Result<Self, FilmError> {
        let SealStart { time, u, w, sealed_pressure, temperature, u_rate } = *start;
        let numbers = [("time", time), ("u", u), ("w", w), ("sealed_pressure", sealed_pressure), ("u's rate", u_rate)];
        if let Some((what, value)) = numbers.into_iter().find(|(_, value)| !is_possible(*value)) {
            return Err(FilmError::OutOfRange { what, value, time });
        }
        let totals =
            Totals { time, u, w, sealed: sealed_pressure, temperature, u_rate, speed: 0.0, ..Totals::default() };
        let mut run = Self::at(seal, totals);
        run.check(sealed_pressure, w, temperature, false)?;
        run.set_conditions();
        match seal.file.start.filter(|_| !run.law.is_closed()) {
            Some(content) => run.state.contents.fill(content),
            None => run.rest()?,
        }
        run.settle();
        Ok(run)
    }

    /// A run with these numbers, its film dry.
    fn at(seal: &Seal, totals: Totals) -> Self {
        let count = seal.cells();
        let width = seal.lip.width / count as f64;
        let law = seal.law(totals.temperature, totals.u_rate);
        let state = SealState { totals, contents: vec![0.0; count], rod: RodFilm::default() };
        Self {
            law,
            film: Film::new(count, width, seal.is_rough_side_moving()),
            stepper: Stepper::new(count),
            before: state.clone(),
            state,
            limit: Limit::default(),
            tangents: [0.0; 2],
            warned: false,
            warnings: Vec::new(),
            last_iteration: None,
            seal: seal.clone(),
        }
    }

    /// The time reached, s.
    pub fn time(&self) -> f64 {
        self.state.totals.time
    }

    /// The inputs: u and w (m), the sealed pressure (Pa).
    pub fn inputs(&self) -> [f64; 3] {
        let Totals { u, w, sealed, .. } = self.state.totals;
        [u, w, sealed]
    }

    /// The temperature, K.
    pub fn temperature(&self) -> f64 {
        self.state.totals.temperature
    }

    /// The contents of the cells, m, from the sealed side.
    pub fn contents(&self) -> &[f64] {
        &self.state.contents
    }

    /// Refuses inputs under which there is no seal, at the start of a step or within.
    fn check(&mut self, sealed: f64, w: f64, temperature: f64, within: bool) -> Result<(), FilmError> {
        let time = self.state.totals.time;
        let lip = &self.seal.lip;
        let beyond = |what, value: f64, (least, largest): (f64, f64)| {
            let is_beyond = value < least || value > largest;
            is_beyond.then_some(FilmError::Beyond { what, value, time, least, largest, within })
        };
        let of_sealed = beyond("the sealed pressure in Pa", sealed, lip.range());
        let of_temperature =
            self.seal.temperatures().and_then(|range| beyond("the temperature in K", temperature, range));
        if let Some(error) = of_sealed.or(of_temperature) {
            if self.seal.table_extrapolation == TableExtrapolation::Refuse {
                return Err(error);
            }
            if !std::mem::replace(&mut self.warned, true) {
                self.warnings.push(format!(
                    "{error}: pressures go on straight, coefficients stay those of the table's end; this \
                                            is said once a run"
                ));
            }
        }
        let total = self.seal.pressure_at_sealed_side(sealed, w);
        // Equal but for rounding is closed.
        if sealed > total * (1.0 + 1e-9) {
            return Err(FilmError::BlownOpen { time, sealed, total, within });
        }
        Ok(())
    }

    /// Sets temperature, speed and pressures of the state.
    fn set_conditions(&mut self) {
        let Totals { temperature, u_rate, sealed, w, .. } = self.state.totals;
        self.seal.set_temperature(&mut self.law, &mut self.film, temperature, u_rate);
        self.set_totals(sealed, w);
    }

    pub(super) fn set_totals(&mut self, sealed: f64, w: f64) {
        self.seal.press(&self.law, &mut self.film, sealed, w);
    }

    fn rubbing(&self) -> Rubbing {
        let Totals { temperature, u_rate, .. } = self.state.totals;
        Rubbing { area: self.seal.cell_area(), shear: self.seal.file.viscosity.at(temperature) * u_rate.abs() }
    }

    fn ends(&self, sealed: f64) -> Ends {
        let supply = self.seal.file.supply;
        let carried_in = match self.seal.air() {
            Air::Returns => self.state.rod.nearest().map_or(0.0, |(_, thickness)| thickness),
            Air::Dry => 0.0,
            Air::Flooded => supply,
        };
        Ends { sealed, supply, carried_in }
    }

    /// Evaluates the film of the state, and its limit of friction.
    fn settle(&mut self) {
        self.settle_under(self.state.totals.sealed);
    }

    pub(super) fn settle_under(&mut self, sealed: f64) {
        let ends = self.ends(sealed);
        self.film.evaluate(&self.law, &self.state.contents, self.state.totals.speed, &ends);
        let rubbing = self.rubbing();
        self.limit = self.stepper.limit(&self.film, &self.law, &self.state.contents, rubbing);
    }

    /// The film after a long rest: contacts bear all that the sealed pressure does not.
    fn rest(&mut self) -> Result<(), FilmError> {
        /// Steps grow from the first (s) by this factor to the last, in which nothing flows any more.
        const FIRST: f64 = 1e-9;
        const GROWTH: f64 = 3.0;
        const LAST: f64 = 1e12;
        const MOST: usize = 1000;
        const TOLERANCE: f64 = 1e-6;
        self.state.contents.copy_from_slice(self.film.bearing());
        let (mut h, mut budget) = (FIRST, MOST);
        while h < LAST {
            budget = budget.checked_sub(1).ok_or(FilmError::TooMuchWork { time: self.state.totals.time })?;
            match self.try_step(h, Drive::Given(0.0), &SealMotion::default(), TOLERANCE) {
                Some(_) => {
                    self.state.contents.copy_from_slice(&self.stepper.contents);
                    h *= GROWTH;
                }
                None => h /= GROWTH,
            }
        }
        Ok(())
    }

    /// A step of `h` (s) from the state, with pressures that move; `None` where it is not solved.
    fn try_step(&mut self, h: f64, drive: Drive, motion: &SealMotion, tolerance: f64) -> Option<Stepped> {
        let Totals { sealed, w, .. } = self.state.totals;
        let (ends, rubbing, moves) =
            (self.ends(sealed), self.rubbing(), motion.pressure_rate != 0.0 || motion.w_rate != 0.0);
        let (seal, law) = (&self.seal, &self.law);
        let at = |film: &mut Film, place: f64| {
            let passed = place * h;
            let now = sealed + motion.pressure_rate * passed;
            if moves {
                seal.press(law, film, now, w + motion.w_rate * passed);
            }
            Ends { sealed: now, ..ends }
        };
        self.stepper.step(&mut self.film, law, &self.state.contents, (h, tolerance), (drive, rubbing), at).ok()
    }

    /// Allows the steps that follow, together, the work of a call of a master: a second. Without it each may take as much.
    pub fn limit_work(&mut self) {
        self.last_iteration = Some(self.iterations_allowed());
    }

    fn iterations_allowed(&self) -> usize {
        self.stepper.iterations + MOST_WORK / self.seal.cells()
    }

    /// Follows the inputs straight on.
    ///
    /// # Errors
    /// [`FilmError`] where there is no seal any more; it is then as it was.
    pub fn advance(&mut self, motion: &SealMotion) -> Result<(), FilmError> {
        if self.seal.groups().contains(&SealGroup::Tangent) {
            self.find_tangents(motion)?;
        }
        self.step(motion)
    }

    /// How force and leak at the end of a step change with the target of u: by a step to one a little farther.
    fn find_tangents(&mut self, motion: &SealMotion) -> Result<(), FilmError> {
        /// Of the way, and of a way that is this part of a cell at least: far beyond what the error of steps makes of the leak.
        const FARTHER: f64 = 1e-2;
        let cell = self.seal.lip.width / self.seal.cells() as f64;
        let by = FARTHER * (motion.u_rate * motion.duration).abs().max(FARTHER * cell);
        let start = self.state.clone();
        let mut ends = [[0.0; 2]; 2];
        for (end, side) in ends.iter_mut().zip([-0.5, 0.5]) {
            let u_rate = motion.u_rate + side * by / motion.duration;
            self.step(&SealMotion { u_rate, ..*motion })?;
            *end = [self.force(), self.leak()];
            self.continue_from(&start);
        }
        self.tangents = [0, 1].map(|i| (ends[1][i] - ends[0][i]) / by);
        Ok(())
    }

    fn step(&mut self, motion: &SealMotion) -> Result<(), FilmError> {
        self.before.clone_from(&self.state);
        let warnings = self.warnings.len();
        let done = self.follow(motion);
        if done.is_err() {
            std::mem::swap(&mut self.state, &mut self.before);
            if self.warnings.len() > warnings {
                (self.warned, _) = (false, self.warnings.pop());
            }
            self.set_conditions();
            self.settle();
        }
        done
    }

    fn follow(&mut self, motion: &SealMotion) -> Result<(), FilmError> {
        let Totals { time, u, w, sealed, lost, .. } = self.state.totals;
        let end = [
            ("u", u + motion.u_rate * motion.duration),
            ("w", w + motion.w_rate * motion.duration),
            ("sealed_pressure", sealed + motion.pressure_rate * motion.duration),
            ("temperature", motion.temperature),
            ("u's rate", motion.u_rate),
            ("time", time + motion.duration),
        ];
        if let Some(&(what, value)) = end.iter().find(|(_, value)| !is_possible(*value)) {
            return Err(FilmError::OutOfRange { what, value, time });
        }
        let [(_, u), (_, w), (_, sealed), ..] = end;
        self.check(sealed, w, motion.temperature, true)?;
        let totals = &mut self.state.totals;
        (totals.u_rate, totals.temperature) = (motion.u_rate, motion.temperature);
        (totals.w_rate, totals.pressure_rate) = (motion.w_rate, motion.pressure_rate);
        self.set_conditions();
        self.begin(motion);
        let mut left = motion.duration;
        let most = self.last_iteration.unwrap_or_else(|| self.iterations_allowed());
        while left > 0.0 {
            left -= self.substep(left, motion, most)?;
        }
        let totals = &mut self.state.totals;
        (totals.time, totals.u, totals.w, totals.sealed) = (time + motion.duration, u, w, sealed);
        totals.power = (totals.lost - lost) / motion.duration;
        self.set_conditions();
        self.settle();
        Ok(())
    }

    /// The law has changed with the speed: a spring beyond the new limit is cut to it, and slips where it goes on to.
    fn begin(&mut self, motion: &SealMotion) {
        let Some(stiffness) = self.seal.file.stiffness else {
            self.state.totals.speed = motion.u_rate;
            return;
        };
        self.settle();
        let limit = self.limit.whole();
        let totals = &mut self.state.totals;
        let force = totals.spring.abs();
        if force >= limit * (1.0 - LOCATED) && force > 0.0 {
            totals.lost += (0.5 * (force * force - limit * limit) / stiffness).max(0.0);
            totals.spring = limit.min(force) * totals.spring.signum();
            self.slip_or_stick(direction_of(self.state.totals.spring), motion);
        } else {
            (totals.slips, totals.speed) = (0.0, 0.0);
        }
    }

    /// At the limit of friction in a direction the lip slips, if its speed is in that direction: K (u̇ - s) is how fast the
    /// limit changes.
    fn slip_or_stick(&mut self, sign: f64, motion: &SealMotion) {
        let Some(stiffness) = self.seal.file.stiffness else { return };
        let ends = self.ends(self.state.totals.sealed);
        let probe = sign * f64::MIN_POSITIVE;
        self.film.evaluate(&self.law, &self.state.contents, probe, &ends);
        let rubbing = self.rubbing();
        self.limit = self.stepper.limit(&self.film, &self.law, &self.state.contents, rubbing);
        let [at_rest, by_speed] = self.stepper.limit_rate(&self.film, probe);
        let speed = (stiffness * motion.u_rate - sign * at_rest) / (stiffness + sign * by_speed);
        let totals = &mut self.state.totals;
        (totals.slips, totals.speed) = if speed * sign > 0.0 { (sign, speed) } else { (0.0, 0.0) };
    }

    /// One step within a step, of which `left` (s) are left, with iterations up to `most`; returns how long it was.
    fn substep(&mut self, left: f64, motion: &SealMotion, most: usize) -> Result<f64, FilmError> {
        let first = self.first_length(left, motion);
        let mut h = first;
        loop {
            if self.stepper.iterations > most || (h < first && h < SHORTEST * motion.duration) {
                return Err(FilmError::TooMuchWork { time: self.state.totals.time });
            }
            let found = self.try_step(h, self.drive(motion), motion, self.seal.relative_tolerance);
            let Some(stepped) = found.filter(|stepped| stepped.error.is_finite()) else {
                h *= SHRINKS_TO;
                continue;
            };
            if stepped.error > 1.0 {
                h *= (SAFETY / stepped.error.cbrt()).max(SHRINKS_TO);
                continue;
            }
            let grown = h * (SAFETY / stepped.error.max(1e-6).cbrt()).min(GROWS_BY);
            // Ends of a master's step and of what comes back are no reasons for shorter ones.
            let next = &mut self.state.totals.next_step;
            *next = if h < first { grown } else { next.max(grown) };
            return Ok(match self.event(h, &stepped, motion) {
                Some((passed, stepped)) => self.accept(passed, &stepped, motion, true),
                None => self.accept(h, &stepped, motion, false),
            });
        }
    }

    /// The length of the next step, s, by that of the last, up to what comes back from the rod.
    fn first_length(&self, left: f64, motion: &SealMotion) -> f64 {
        let Totals { next_step, speed, slips, .. } = self.state.totals;
        let fastest = speed.abs().max(motion.u_rate.abs()).max(f64::MIN_POSITIVE);
        let first = FIRST_STEP * self.seal.lip.width / self.seal.cells() as f64 / fastest;
        let mut h = if next_step > 0.0 { next_step } else { first }.min(left);
        let returns =
            speed < 0.0 && self.seal.air() == Air::Returns && (slips != 0.0 || self.seal.file.stiffness.is_none());
        if returns && let Some((length, _)) = self.state.rod.nearest() {
            h = h.min(length / -speed);
        }
        h
    }

    fn drive(&self, motion: &SealMotion) -> Drive {
        let Totals { slips, speed, spring, .. } = self.state.totals;
        match self.seal.file.stiffness {
            None => Drive::Given(motion.u_rate),
            Some(_) if slips == 0.0 => Drive::Given(0.0),
            Some(stiffness) => Drive::Slips { sign: slips, speed, force: spring, stiffness, rod_speed: motion.u_rate },
        }
    }

    /// Where within a step of `h` (s) stick ends or slip does, the step up to there.
    fn event(&mut self, h: f64, stepped: &Stepped, motion: &SealMotion) -> Option<(f64, Stepped)> {
        self.seal.file.stiffness?;
        let end = self.excess(h, stepped, motion);
        if end <= 0.0 {
            return None;
        }
        let (drive, tolerance) = (self.drive(motion), self.seal.relative_tolerance);
        let begin = self.excess_at_start().min(-f64::MIN_POSITIVE);
        let excess = |passed: f64| match self.try_step(passed, drive, motion, tolerance) {
            Some(stepped) => self.excess(passed, &stepped, motion),
            None => end,
        };
        let passed = root_between(excess, [(0.0, begin), (h, end)], LOCATED * h).max(LOCATED * h);
        Some((passed, self.try_step(passed, drive, motion, tolerance)?))
    }

    /// By how much stick exceeds its limit, over the limit, at the end of a step of `h` (s); in slip how much its speed is
    /// behind, over that of the rod.
    fn excess(&mut self, h: f64, stepped: &Stepped, motion: &SealMotion) -> f64 {
        let Totals { slips, spring, speed, .. } = self.state.totals;
        if slips != 0.0 {
            return -slips * stepped.speed / (speed.abs() + motion.u_rate.abs()).max(f64::MIN_POSITIVE);
        }
        let force = spring + self.seal.file.stiffness.unwrap_or(0.0) * motion.u_rate * h;
        let contents = std::mem::take(&mut self.stepper.contents);
        let rubbing = self.rubbing();
        let limit = self.stepper.limit(&self.film, &self.law, &contents, rubbing).whole();
        self.stepper.contents = contents;
        force.abs() / limit.max(f64::MIN_POSITIVE) - 1.0
    }

    fn excess_at_start(&self) -> f64 {
        let Totals { slips, spring, .. } = self.state.totals;
        if slips != 0.0 { -1.0 } else { spring.abs() / self.limit.whole().max(f64::MIN_POSITIVE) - 1.0 }
    }

    /// Takes a step of `h` (s) over, whose end is an event or not; returns its length.
    fn accept(&mut self, h: f64, stepped: &Stepped, motion: &SealMotion, is_event: bool) -> f64 {
        let stiffness = self.seal.file.stiffness;
        self.state.contents.copy_from_slice(&self.stepper.contents);
        // In slip the spring is at the limit of the contents found: what their last iteration left would have to slip at once.
        let rubbing = self.rubbing();
        let limit = match stiffness {
            Some(_) if self.state.totals.slips != 0.0 => {
                self.stepper.limit(&self.film, &self.law, &self.state.contents, rubbing).whole()
            }
            _ => 0.0,
        };
        let totals = &mut self.state.totals;
        let was_slip = totals.slips;
        totals.time += h;
        totals.sealed += motion.pressure_rate * h;
        totals.w += motion.w_rate * h;
        totals.leaked += stepped.out;
        totals.drawn += stepped.into;
        totals.lost += stepped.loss;
        match stiffness {
            Some(_) if was_slip != 0.0 => (totals.spring, totals.speed) = (was_slip * limit, stepped.speed),
            Some(stiffness) => totals.spring += stiffness * motion.u_rate * h,
            None => totals.speed = motion.u_rate,
        }
        match self.seal.air() {
            Air::Returns if stepped.travel > 0.0 => self.state.rod.lay(stepped.travel, stepped.out),
            Air::Returns if stepped.travel < 0.0 => {
                let volume = self.state.rod.nearest().map_or(0.0, |(_, thickness)| -stepped.travel * thickness);
                self.state.rod.take(-stepped.travel, volume);
            }
            _ => {}
        }
        if is_event {
            if motion.pressure_rate != 0.0 || motion.w_rate != 0.0 {
                self.set_conditions();
            }
            if was_slip != 0.0 {
                (self.state.totals.slips, self.state.totals.speed) = (0.0, 0.0);
            } else {
                let sign = direction_of(self.state.totals.spring);
                self.slip_or_stick(sign, motion);
            }
        }
        h
    }

    /// All that changes in the run.
    pub fn save(&self) -> SealState {
        self.state.clone()
    }

    /// As [`save`](Self::save), into one that there is.
    pub fn save_into(&self, saved: &mut SealState) {
        saved.clone_from(&self.state);
    }

    /// A run that continues from `saved`, bit for bit as the run that was saved.
    ///
    /// # Errors
    /// [`FilmRestoreError`] where it is none of this seal's.
    pub fn restore(seal: &Seal, saved: &SealState) -> Result<Self, FilmRestoreError> {
        let (found, expected) = (saved.contents.len(), seal.cells());
        if found != expected {
            return Err(FilmRestoreError::Count { found, expected });
        }
        if let Some((what, value)) = not_finite(&saved.totals) {
            return Err(FilmRestoreError::Invalid { what, value });
        }
        if ![-1.0, 0.0, 1.0].contains(&saved.totals.slips) {
            return Err(FilmRestoreError::Invalid { what: "direction of slip", value: saved.totals.slips });
        }
        let negative = saved.contents.iter().copied().find(|content| !(content.is_finite() && *content >= 0.0));
        if let Some(value) = negative {
            return Err(FilmRestoreError::Invalid { what: "content", value });
        }
        if !saved.rod.is_valid() {
            return Err(FilmRestoreError::Invalid { what: "film on the rod", value: saved.rod.volume() });
        }
        let mut run = Self::at(seal, saved.totals);
        run.continue_from(saved);
        Ok(run)
    }

    /// Continues from `saved`, a state of this seal.
    pub fn continue_from(&mut self, saved: &SealState) {
        self.state.clone_from(saved);
        self.set_conditions();
        self.settle();
    }

    /// The warnings since the last call.
    pub fn take_warnings(&mut self) -> Vec<String> {
        std::mem::take(&mut self.warnings)
    }

    /// F_x on the rod, N.
    pub fn force(&self) -> f64 {
        let Totals { u_rate, spring, .. } = self.state.totals;
        match self.seal.file.stiffness {
            Some(_) => -spring,
            None if u_rate == 0.0 => 0.0,
            None => -self.limit.whole() * u_rate.signum(),
        }
    }

    /// What leaked to the air, net, m³.
    pub fn leak(&self) -> f64 {
        self.seal.file.length * self.state.totals.leaked
    }

    /// What came from the sealed side, net, m³.
    pub fn drawn(&self) -> f64 {
        self.seal.file.length * self.state.totals.drawn
    }

    /// Iterations of Newton's method so far.
    pub fn iterations(&self) -> usize {
        self.stepper.iterations
    }

    /// What leaks now, net, m³/s.
    pub fn leak_rate(&self) -> f64 {
        self.seal.file.length * self.film.flows[self.film.flows.len() - 1]
    }

    /// The sums over the cells of the total pressure times what each has, over that of the total pressure.
    fn mean_by_load(&self, of: impl Fn(usize) -> f64) -> f64 {
        let (sum, whole) = self
            .film
            .totals
            .iter()
            .enumerate()
            .fold((0.0, 0.0), |(sum, whole), (i, total)| (sum + total * of(i), whole + total));
        if whole > 0.0 { sum / whole } else { 0.0 }
    }

    /// The mean content, weighted with the total pressure, m.
    pub fn thickness(&self) -> f64 {
        self.mean_by_load(|i| self.state.contents[i])
    }

    /// The largest pressure of the fluid, Pa.
    pub fn largest_pressure(&self) -> f64 {
        (0..self.seal.cells()).map(|i| self.film.pressure(i)).fold(0.0, f64::max)
    }

    /// The share of the load that contacts bear.
    pub fn contact_share(&self) -> f64 {
        let borne = |i: usize| 1.0 - self.film.pressure(i) / self.film.totals[i].max(f64::MIN_POSITIVE);
        self.mean_by_load(borne)
    }

    /// The load on the lip, N.
    pub fn load(&self) -> f64 {
        self.seal.cell_area() * self.film.totals.iter().sum::<f64>()
    }

    /// The volume of the film on the rod, m³.
    pub fn on_rod(&self) -> f64 {
        self.seal.file.length * self.state.rod.volume()
    }
}

/// The direction of a force.
fn direction_of(force: f64) -> f64 {
    if force < 0.0 { -1.0 } else { 1.0 }
}
