//! A run of a patch: steps over all its elements.

use std::sync::Arc;

use super::block::ElementBlock;
use super::block_contacts::{BeyondTable, FaceMotion, StepSums, TooWarm, WorkCounter};
use super::definition::Patch;
use super::face::Face;
use super::heat::{ElementHeat, StepHeat};
use super::motion::{PoseMotion, SlipCourse, Substeps, TreadMotion};
use super::state::{
    MAX_SUBSTEPS, MAX_WORK, MotionError, PatchMotion, PatchRestoreError, PatchStart, PatchState, Pose, Springs, Totals,
    check_duration,
};

use super::worker_pool::{WorkerPool, threads};
use crate::element::ResampledLaw;
use crate::math::Dual;
use crate::model::{FlashTerm, SURFACE_TERMS, surface_kernel};
use crate::scene::{FaceHeat, TableExtrapolation};

/// What `table.extrapolation = "hold"` does.
const HELD: &str =
    "pressures go on along their tangent, coefficients stay those of the table's end; this is said once a run";

/// A run of a patch. A clone continues as the original does, bit for bit.
#[derive(Clone, Debug)]
pub struct PatchRun {
    pub(super) patch: Patch,
    pub(super) law: ResampledLaw,
    pub(super) totals: Totals,
    pub(super) springs: Springs,
    /// The springs at the end of the step under way.
    next: Springs,
    /// Changes of the wrench with the targets of the last step, where they are asked for.
    pub(super) tangents: Option<Box<[[f64; 6]; 6]>>,
    workers: Workers,
    /// How losses by slip warm the elements, where they do.
    kernel: Option<[FlashTerm; SURFACE_TERMS]>,
    /// By [`Excess`], whether it has warned of it: no part of a state, so that a step that is repeated does not warn
    /// again.
    warned: [bool; 3],
    /// Those not taken yet.
    warnings: Vec<String>,
    /// What is left of the work of a call: see [`limit_work`](Self::limit_work).
    work_left: Option<f64>,
}

/// What is known of the work of motions before they are followed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ReckonedWork {
    /// Their substeps, at least.
    substeps: f64,
    /// What these cost, by the elements, if none of them has to be done in parts.
    work: f64,
}

impl ReckonedWork {
    /// With that of a motion that follows.
    pub fn with(self, next: Self) -> Self {
        Self { substeps: self.substeps + next.substeps, work: self.work + next.work }
    }
}

/// What is beyond the table.
#[derive(Clone, Copy, Debug)]
enum Excess {
    Temperature,
    Element,
    ElementTemperature,
}

/// Who does the steps, with derivatives where tangents are asked for.
#[derive(Clone, Debug)]
enum Workers {
    Plain(WorkerPool<f64>),
    Tangent(WorkerPool<Dual<6>>),
}

impl Patch {
    /// Memory in bytes that a run takes at most: its law, one more for each thread that helps, and springs.
    pub fn run_memory(&self) -> usize {
        /// Two springs.
        const ELEMENT: usize = 64;
        /// Of a thread's block, and of all sums.
        const BLOCK: usize = 1 << 19;
        let laws = threads(self.work()).max(1);
        let is_warm = self.heat().is_some();
        let element = ELEMENT + if is_warm { 2 * size_of::<ElementHeat>() } else { 0 };
        BLOCK + laws * (BLOCK + self.law_memory()) + element * self.count()
    }

    /// Elements times parts of a step, at least.
    fn work(&self) -> f64 {
        self.count() as f64 * f64::from(self.refine)
    }
}

impl PatchRun {
    /// A patch at its start, its springs relaxed.
    ///
    /// # Errors
    /// [`MotionError`] where a number is out of range, or an element is beyond the table and that is refused.
    pub fn new(patch: &Patch, start: &PatchStart) -> Result<Self, MotionError> {
        start.check()?;
        let mut run = Self::at(patch, start.temperature);
        run.totals = Totals {
            time: start.time,
            pose: start.pose,
            rates: start.rates,
            transport_speed: start.transport_speed,
            tread_speed: start.transport_speed,
            temperature: start.temperature,
            ..Totals::default()
        };
        run.initialize_springs()?;
        Ok(run)
    }

    /// A run of a patch at a temperature (K), nothing else of its state set.
    fn at(patch: &Patch, temperature: f64) -> Self {
        let tangents = patch.has_tangents();
        let mut law = patch.law();
        set_temperature(patch, &mut law, temperature);
        let work = patch.work();
        let workers = if tangents {
            Workers::Tangent(WorkerPool::new(work, &law))
        } else {
            Workers::Plain(WorkerPool::new(work, &law))
        };
        let springs = Springs::new(patch.count(), patch.heat().is_some());
        let kernel = patch.heat().map(|FaceHeat { conductivity, capacity, density, share }| {
            surface_kernel(share, conductivity, density * capacity)
        });
        Self {
            law,
            totals: Totals::default(),
            next: springs.clone(),
            springs,
            tangents: tangents.then(|| Box::new([[0.0; 6]; 6])),
            workers,
            kernel,
            warned: [false; 3],
            warnings: Vec::new(),
            work_left: None,
            patch: patch.clone(),
        }
    }

    /// Gives relaxed springs the stiffness of their contacts.
    fn initialize_springs(&mut self) -> Result<(), MotionError> {
        let Totals { time, rates, tread_speed, place, .. } = self.totals;
        let tread = TreadMotion { start: place, mean_speed: tread_speed, ..TreadMotion::default() };
        // The springs are evaluated at the start alone: of the motion only its rates count.
        let body = PoseMotion { start: self.totals.pose.coordinates(), change: rates, duration: 1.0 };
        let face = &self.patch.face;
        let (substeps, work) = (Substeps::new(tread, 0.0, None, 1), WorkCounter::new(f64::MAX));
        let step = FaceMotion { face, body, tread, substeps, heat: None, damping: self.patch.dampers(), work: &work };
        let springs = (&self.springs, &mut self.next);
        let sums = WorkerPool::with_threads(1, &self.law).work(&step, &mut self.law, springs, |block, law, sums| {
            block.initialize(&step, law, sums);
        });
        let mut reached = self.totals;
        reached.add(&sums, 0.0);
        reached.check(None)?;
        self.check_table(reached.temperature, &sums, |_| time)?;
        self.springs.clone_from(&self.next);
        self.totals = reached;
        Ok(())
    }

    /// The time reached, s.
    pub fn time(&self) -> f64 {
        self.totals.time
    }

    /// The pose reached.
    pub fn pose(&self) -> Pose {
        self.totals.pose
    }

    /// The speed of the tread, m/s.
    pub fn transport_speed(&self) -> f64 {
        self.totals.transport_speed
    }

    /// The temperature, K; 0 where the table has no temperatures.
    pub fn temperature(&self) -> f64 {
        self.totals.temperature
    }

    /// The warnings since the last call: of the first temperature and of the first element beyond the table.
    pub fn take_warnings(&mut self) -> Vec<String> {
        std::mem::take(&mut self.warnings)
    }

    /// Allows the motions that follow, together, the work of a call of a master: a second at most. Without it each of them may
    /// take as much, and 200 substeps of however many elements.
    pub fn limit_work(&mut self) {
        self.work_left = Some(MAX_WORK);
    }

    /// What a motion that begins with the pose at these coordinates (m, rad), at a speed of the tread (m/s), takes at least.
    pub fn reckon(&self, start: [f64; 6], transport_speed: f64, motion: &PatchMotion) -> ReckonedWork {
        let duration = motion.duration;
        let body = PoseMotion { start, change: motion.rates.map(|rate| rate * duration), duration };
        self.reckon_substeps(self.tread_motion([transport_speed, motion.transport_speed], duration), &body).1
    }

    /// Refuses motions from now on that take more work than is allowed.
    ///
    /// # Errors
    /// [`MotionError::TooManySubsteps`].
    pub fn check_work(&self, ReckonedWork { substeps, work }: ReckonedWork) -> Result<(), MotionError> {
        let allowed = self.allowed_work();
        if work <= allowed && substeps <= MAX_SUBSTEPS {
            return Ok(());
        }
        let most = (allowed / work * substeps).min(MAX_SUBSTEPS);
        Err(MotionError::TooManySubsteps { time: self.totals.time, substeps, most })
    }

    fn allowed_work(&self) -> f64 {
        self.work_left.unwrap_or_else(|| self.patch.work_of_step())
    }

    /// Follows a motion; over no time it stays as it is.
    ///
    /// # Errors
    /// [`MotionError`]; the patch is then as it was.
    pub fn advance(&mut self, motion: &PatchMotion) -> Result<(), MotionError> {
        let PatchMotion { duration, rates, transport_speed, temperature } = *motion;
        let start = self.totals.pose.coordinates();
        let change = rates.map(|rate| rate * duration);
        let end = self.checked_end(motion, change)?;
        if duration == 0.0 {
            return Ok(());
        }
        check_duration(duration, self.totals.time)?;
        let tread = self.tread_motion([self.totals.transport_speed, transport_speed], duration);
        let body = PoseMotion { start, change, duration };
        let (substeps, reckoned) = self.reckon_substeps(tread, &body);
        self.check_work(reckoned)?;

        let before = self.totals;
        self.set_temperature(temperature);
        let heat = self.step_heat(temperature);
        let face = Arc::clone(&self.patch.face);
        let cost = self.patch.cost_of_element();
        let work = WorkCounter::new(self.allowed_work() / cost);
        let step = FaceMotion { face: &face, body, tread, substeps, heat, damping: self.patch.dampers(), work: &work };
        let (sums, tangents) = self.advance_springs(&step);
        self.work_left = self.work_left.map(|left| left - work.done() as f64 * cost);

        // Refuse the step or take it over.
        let mut reached = before;
        reached.add(&sums, duration);
        (reached.time, reached.pose, reached.rates) = (before.time + duration, end, rates);
        (reached.transport_speed, reached.tread_speed, reached.temperature) =
            (transport_speed, tread.speed_at(1.0), temperature);
        // Just below a whole number, rounding may give 1.
        reached.place = (tread.entered_at(1.0) - tread.whole_cells()).min(1.0_f64.next_down());
        let counted = if work.is_exceeded() { Err(MotionError::TooMuchWork { time: before.time }) } else { Ok(()) };
        let checked = counted.and_then(|()| reached.check(tangents.as_ref()));
        if let Err(error) =
            checked.and_then(|()| self.check_table(temperature, &sums, |fraction| before.time + fraction * duration))
        {
            self.set_temperature(before.temperature);
            return Err(error);
        }
        std::mem::swap(&mut self.springs, &mut self.next);
        if let (Some(kept), Some(found)) = (&mut self.tangents, tangents) {
            **kept = found;
        }
        self.totals = reached;
        Ok(())
    }

    /// The pose that a motion leads to, by so much of its coordinates.
    fn checked_end(&self, motion: &PatchMotion, change: [f64; 6]) -> Result<Pose, MotionError> {
        let PatchMotion { duration, rates, transport_speed, temperature } = *motion;
        let start = self.totals.pose.coordinates();
        let pose = Pose::from_coordinates(std::array::from_fn(|i| start[i] + change[i]));
        PatchStart { time: self.totals.time + duration, pose, rates, transport_speed, temperature }.check()?;
        Ok(pose)
    }

    /// The substeps of a step in which the tread goes on and the body moves, and what they take at least.
    fn reckon_substeps(&self, tread: TreadMotion, body: &PoseMotion<f64>) -> (Substeps, ReckonedWork) {
        let slip = (tread.speed_change != 0.0).then(|| self.slip_course(tread, body));
        let steps = Substeps::new(tread, body.turn(), slip, self.patch.refine);
        let substeps = steps.count(MAX_SUBSTEPS);
        let work = substeps * self.patch.work_of_substep(self.patch.face.count_in(tread));
        (steps, ReckonedWork { substeps, work })
    }

    /// The slip where the body is nearest to the ground, along its heading.
    fn slip_course(&self, tread: TreadMotion, body: &PoseMotion<f64>) -> SlipCourse {
        let now = body.at(0.0);
        let [ahead_x, ahead_y] = [now.rotation[0][0], now.rotation[1][0]];
        let length = ahead_x.hypot(ahead_y).max(f64::MIN_POSITIVE);
        let [x, y] = now.velocity([0.0, 0.0, -now.height]);
        let along = (x * ahead_x + y * ahead_y) / length;
        let across = (y * ahead_x - x * ahead_y) / length;
        let slowest = self.patch.table().grid.speeds.first().copied().unwrap_or(f64::MIN_POSITIVE);
        let speeds = [0.0, 1.0].map(|fraction| along - tread.speed_at(fraction));
        SlipCourse { speeds, least: across.abs().max(slowest) }
    }

    /// Takes the springs of all elements through a step, block by block, to those in `next`; returns the sums and, where
    /// they are asked for, the tangents.
    fn advance_springs(&mut self, step: &FaceMotion<'_, f64>) -> (StepSums<f64>, Option<[[f64; 6]; 6]>) {
        let Self { law, springs, next, workers, .. } = self;
        match workers {
            Workers::Plain(pool) => {
                let widest = pulp::Arch::new();
                let sums = pool.work(step, law, (springs, next), |block, law, sums| {
                    widest.dispatch(Advance { block, step, law, sums });
                });
                (sums, None)
            }
            Workers::Tangent(pool) => {
                let step = step.with_tangents();
                let advance = |block: &mut ElementBlock<_>, law: &mut _, sums: &mut _| block.advance(&step, law, sums);
                let sums = pool.work(&step, law, (springs, next), advance);
                (sums.values(), Some(sums.wrench.map(|load| load.slopes)))
            }
        }
    }

    fn set_temperature(&mut self, kelvin: f64) {
        set_temperature(&self.patch, &mut self.law, kelvin);
    }

    /// What a step at a temperature (K) has to know of heat.
    fn step_heat(&self, kelvin: f64) -> Option<StepHeat> {
        let (low, high) = self.patch.temperatures()?;
        self.kernel.map(|kernel| StepHeat { kernel, range: ((low - kelvin).max(0.0), (high - kelvin).max(0.0)) })
    }

    /// The tread's motion over a time (s), to another speed (m/s).
    fn tread_motion(&self, speeds: [f64; 2], duration: f64) -> TreadMotion {
        match &*self.patch.face {
            Face::Tread(tread) => TreadMotion::new(self.totals.place, speeds, duration, tread.cell),
            Face::Points(_) => TreadMotion::default(),
        }
    }

    /// Refuses a temperature (K) or an element beyond the table, or warns of the first; `time_at` is the time (s) after
    /// a fraction of the step.
    fn check_table(
        &mut self,
        kelvin: f64,
        sums: &StepSums<f64>,
        time_at: impl Fn(f64) -> f64,
    ) -> Result<(), MotionError> {
        if self.patch.held_temperature(kelvin).is_some_and(|held| held != kelvin) {
            let error = |_: &Patch| MotionError::TemperatureBeyondTable { time: time_at(0.0), kelvin };
            self.refuse_or_warn(Excess::Temperature, error)?;
        } else if let Some(TooWarm { element, fraction, rise }) = sums.too_warm {
            self.refuse_or_warn(Excess::ElementTemperature, |patch| {
                let (element, time) = (patch.element_name(element), time_at(fraction));
                MotionError::ElementTooWarm { element, time, kelvin: kelvin + rise, within: fraction > 0.0 }
            })?;
        }
        let Some(BeyondTable { element, fraction, pressure, speed }) = sums.beyond else { return Ok(()) };
        self.refuse_or_warn(Excess::Element, |patch| {
            let (element, time) = (patch.element_name(element), time_at(fraction));
            MotionError::BeyondTable { element, time, pressure, speed, within: fraction > 0.0 }
        })
    }

    /// Refuses what is beyond the table, or warns of this kind of it once a run.
    fn refuse_or_warn(&mut self, excess: Excess, error: impl Fn(&Patch) -> MotionError) -> Result<(), MotionError> {
        if self.patch.table_extrapolation == TableExtrapolation::Refuse {
            return Err(error(&self.patch));
        }
        if !std::mem::replace(&mut self.warned[excess as usize], true) {
            self.warnings.push(format!("{}; {HELD}", error(&self.patch)));
        }
        Ok(())
    }

    /// All that changes in the run.
    pub fn save(&self) -> PatchState {
        PatchState { totals: self.totals, springs: self.springs.clone(), tangents: self.tangents.clone() }
    }

    /// As [`save`](Self::save), into a state that there is; allocates nothing where that is of the same patch.
    pub fn save_into(&self, saved: &mut PatchState) {
        saved.totals = self.totals;
        saved.springs.clone_from(&self.springs);
        saved.tangents.clone_from(&self.tangents);
    }

    /// A run that continues from `saved`, bit for bit as the run that was saved.
    ///
    /// # Errors
    /// [`PatchRestoreError`] where `saved` is no valid state of a run of this patch.
    pub fn restore(patch: &Patch, saved: &PatchState) -> Result<Self, PatchRestoreError> {
        let mut run = Self::at(patch, saved.totals.temperature);
        run.set_state(saved)?;
        Ok(run)
    }

    /// Continues from `saved`, of the same patch; allocates nothing.
    ///
    /// # Errors
    /// As for [`restore`](Self::restore); the run is then as it was.
    pub fn set_state(&mut self, saved: &PatchState) -> Result<(), PatchRestoreError> {
        saved.check(&self.patch)?;
        let before = self.totals.temperature;
        self.set_temperature(saved.totals.temperature);
        if let Err(error) = self.check_limits(saved) {
            self.set_temperature(before);
            return Err(error);
        }
        self.continue_from(saved);
        Ok(())
    }

    /// Continues from `saved`, a state of the same patch that a run has saved or that was checked when it was read;
    /// allocates nothing.
    pub fn continue_from(&mut self, saved: &PatchState) {
        self.set_temperature(saved.totals.temperature);
        self.totals = saved.totals;
        self.springs.clone_from(&saved.springs);
        if let (Some(own), Some(saved)) = (&mut self.tangents, &saved.tangents) {
            **own = **saved;
        }
    }
}

/// Gives a law of a table of several temperatures this one, K.
fn set_temperature(patch: &Patch, law: &mut ResampledLaw, kelvin: f64) {
    if let Some(held) = patch.held_temperature(kelvin) {
        // Of warm elements the sum of it and their rise is held.
        law.set_temperature(if law.has_planes() { kelvin } else { held });
    }
}

/// A step of a block, to be done with the widest vectors of the processor; numbers are the same with all.
struct Advance<'a, 'b> {
    block: &'a mut ElementBlock<f64>,
    step: &'a FaceMotion<'b, f64>,
    law: &'a mut ResampledLaw,
    sums: &'a mut StepSums<f64>,
}

impl pulp::NullaryFnOnce for Advance<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        self.block.advance(self.step, self.law, self.sums);
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use std::path::Path;

    use super::*;

    /// A tread that rolls and turns, with and without derivatives: the same bits by one thread and by several.
    #[test]
    fn threads_change_nothing() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/reference/patch");
        for outputs in ["forces", "tangent"] {
            let text = format!(
                "name = \"many\"\ntable = {{ path = \"winkler.table.csv\" }}\n[patch]\nshape = \"cylinder\"\nradius = 0.3\n\
                 length = 0.03\nwidth = 0.02\nnx = 90\nny = 40\ntransport = true\n[solver]\nrefine = 12\n[fmu]\n\
                 outputs = [\"{outputs}\"]"
            );
            let patch = Patch::parse(&text, &folder.join("patch.toml")).unwrap();
            let state_after = |threads: usize| {
                let pose = Pose { place: [0.0, 0.0, 0.2999], angles: [0.0; 3] };
                let start = PatchStart { pose, transport_speed: 1.0, ..PatchStart::default() };
                let mut run = PatchRun::new(&patch, &start).unwrap();
                match &mut run.workers {
                    Workers::Plain(pool) => *pool = WorkerPool::with_threads(threads, &run.law),
                    Workers::Tangent(pool) => *pool = WorkerPool::with_threads(threads, &run.law),
                }
                let rates = [0.9, 0.1, -0.01, 0.2, 0.0, 0.3];
                let motion = PatchMotion { duration: 1e-3, rates, transport_speed: 1.1, temperature: 0.0 };
                (0..3).for_each(|_| run.advance(&motion).unwrap());
                run.save()
            };
            let one = state_after(1);
            assert!(one.totals.wrench[2] > 0.0 && one.totals.slip_energy > 0.0);
            assert!([2, 5].into_iter().all(|threads| state_after(threads) == one), "{outputs}");
        }
    }

    /// A wheel at 2 m/s whose tread comes up to that speed, or passes it, within a step: one step is as many, and finer
    /// parts are nearer. Friction rises with the slip, so that the slow end counts.
    #[test]
    fn a_tread_whose_speed_changes_much_in_a_step_is_followed() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/reference/patch");
        let force_after = |speeds: [f64; 2], steps: u32, refine: u32| {
            let text = format!(
                "name = \"tread\"\ntable = {{ path = \"block.table.csv\" }}\n[patch]\nshape = \"cylinder\"\nradius = 0.3\n\
                 length = 0.015\nwidth = 0.01\nnx = 24\nny = 2\ntransport = true\nbacking = {{ normal = 7.5e8, shear = 2.5e8 }}\n\
                 [solver]\nrefine = {refine}"
            );
            let patch = Patch::parse(&text, &folder.join("patch.toml")).unwrap();
            let pose = Pose { place: [0.0, 0.0, 0.2999], angles: [0.0; 3] };
            let temperature = patch.temperature();
            let start = PatchStart { pose, transport_speed: speeds[0], temperature, ..PatchStart::default() };
            let mut run = PatchRun::new(&patch, &start).unwrap();
            let mut go = |duration: f64, transport_speed: f64| {
                let rates = [2.0, 0.0, 0.0, 0.0, 0.0, 0.0];
                run.advance(&PatchMotion { duration, rates, transport_speed, temperature }).unwrap();
            };
            (0..20).for_each(|_| go(1e-3, speeds[0]));
            for i in 1..=steps {
                let share = f64::from(i) / f64::from(steps);
                go(1e-3 / f64::from(steps), speeds[0] + (speeds[1] - speeds[0]) * share);
            }
            run.save().totals.wrench[0]
        };
        for speeds in [[1.4, 2.0], [1.8, 2.2], [2.0, 1.4]] {
            let wanted = force_after(speeds, 1024, 1);
            let error = |found: f64| (found / wanted - 1.0).abs();
            let (one, fine) = (error(force_after(speeds, 1, 1)), error(force_after(speeds, 1, 64)));
            // Of friction between parts, which changes by some per cent from one to the next.
            assert!(one < 1e-2 && fine < 2e-3, "{speeds:?}: {wanted} N, off by {one:e}, {fine:e}");
        }
    }

    /// A wheel that rolls on and on within a microsecond goes through the plane again and again. By 300 rad, or by as much as
    /// the number of substeps allows, no more work is done than a step may take; steps that would take more, some of these,
    /// are refused, and the run stays.
    #[test]
    fn a_step_that_rolls_on_and_on_is_given_up_by_its_work() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/reference/patch");
        let heat = "heat = { conductivity = 0.25, capacity = 1700.0, density = 1100.0, share = 0.5 }";
        let mut refusals = 0;
        for (nx, ny, outputs, rest) in
            [(12, 4, "forces", ""), (24, 4, "tangent", ""), (24, 4, "forces", heat), (90, 40, "forces", "")]
        {
            let text = format!(
                "name = \"rolled\"\ntable = {{ path = \"block.table.csv\" }}\n[patch]\nshape = \"cylinder\"\nradius = 0.3\n\
                 length = 0.015\nwidth = 0.01\nnx = {nx}\nny = {ny}\ntransport = true\n{rest}\n[fmu]\n\
                 outputs = [\"{outputs}\"]"
            );
            let patch = Patch::parse(&text, &folder.join("patch.toml")).unwrap();
            let (temperature, most) = (patch.temperature(), patch.work_of_step() / patch.cost_of_element());
            let pose = Pose { place: [0.0, 0.0, 0.29999], angles: [0.0; 3] };
            let mut run = PatchRun::new(&patch, &PatchStart { pose, temperature, ..PatchStart::default() }).unwrap();
            let of_substep = patch.work_of_substep(patch.count());
            let allowed = 0.099 * (patch.work_of_step() / of_substep).min(MAX_SUBSTEPS);
            for turn in [300.0_f64.min(allowed), allowed] {
                let change = [0.0, 0.0, 0.0, -turn, 0.0, 0.0];
                let body = PoseMotion { start: pose.coordinates(), change, duration: 1e-6 };
                let (tread, work) = (run.tread_motion([0.0; 2], 1e-6), WorkCounter::new(most));
                let (substeps, heat) = (run.reckon_substeps(tread, &body).0, run.step_heat(temperature));
                let face = Arc::clone(&run.patch.face);
                let step =
                    FaceMotion { face: &face, body, tread, substeps, heat, damping: run.patch.dampers(), work: &work };
                run.advance_springs(&step);
                // A little more than that: a block of elements finds out after a part.
                assert!(work.done() as f64 <= 1.05 * most, "{nx} x {ny} by {turn}: {} of {most}", work.done());
                let before = run.save();
                let rates = change.map(|change| change / 1e-6);
                let outcome = run.advance(&PatchMotion { duration: 1e-6, rates, transport_speed: 0.0, temperature });
                let given_up = matches!(outcome, Err(MotionError::TooMuchWork { .. }));
                assert_eq!(given_up, work.is_exceeded(), "{nx} x {ny} by {turn}: {outcome:?}");
                assert!(!given_up || run.save() == before, "{nx} x {ny} by {turn}");
                refusals += usize::from(given_up);
            }
        }
        assert!(refusals > 0);
    }
}
