//! Steps of the whole layer with mode changes in windows.
//!
//! A mode change is felt by the masses near it alone: the carrier holds every mass, so the effect of a change falls by a
//! constant ratio from mass to mass. So the step of the whole layer is not cut there. The masses near it form a [`Window`], which
//! goes on from the change in steps of its own, under the forces that the whole layer's step has in the links to the others.
//! What these others then miss is far below the tolerance; where it is not, a wider window takes the place of the first
//! (docs/theory.md, section 13).
//!
//! All windows of a step move on together, in the order of time: so a wider one can be opened, or the step cut short, at any
//! time. At the end of the step their masses take the places of those in it.

use std::ops::Range;

use super::driver::{TrialStep, WorkLimit};
use super::event::MAX_CUTS;
use super::motion::{ModeChange, SimulationError};
use super::run::{Run, RunState, Settings, Workspace};
use super::snapshot::MAX_DEFECT;
use super::window::Window;
use crate::contact::mode_changes;
use crate::integrator::{DenseWorkspace, Integrator, LayerStep, Overlay, Scheme, StepSpan};
use crate::model::{LinkKind, Model, State};
use crate::outputs::Energies;
use crate::scene::Method;

/// How far off a mass is by the end of a step that knows nothing of its mode change, as a share of the scene's height.
///
/// Recommended 0.03 to 1. More makes windows wider than need be, less has them widened more often.
const DISTURBANCE: f64 = 0.3;
/// A layer has windows only where it is at least this many narrowest windows wide.
const MIN_WINDOWS: usize = 4;
/// Windows may hold at most the layer's masses divided by this: beyond that it is better to cut the step.
const OF_MASSES: usize = 2;
/// The most windows of the least width, of twice this width half as many, and so on: more are seldom open at once, and each
/// takes memory.
const MAX_WINDOWS: usize = 16;
/// There are windows of the two least widths where so many of them would have room.
const ROOM: [usize; 2] = [2, 2];
/// The same of wider ones: the steps of the few widest cost about as much as to cut that of the layer, and they take memory.
const ROOM_FOR_WIDE: usize = 4;
/// The force by which the links at a window's ends may be off, as a share of the error allowed in the force of one mass.
///
/// Recommended 0.1 to 1.
const MISMATCH: f64 = 0.5;

/// The windows of a layer, and the mode changes of the step tried last.
#[derive(Clone, Debug)]
pub(super) struct Windows {
    /// From narrow to wide.
    windows: Vec<Window>,
    /// Number of masses to each side of one that changes its mode that feel it.
    reach: usize,
    /// The most masses that open windows may have.
    most_masses: usize,
    /// The first mode change of each mass in the step tried last, as fraction of the step and mass, in the order of time.
    changes: Vec<(f64, usize)>,
    /// Number of them that have been passed.
    passed: usize,
    /// Whether they are to be taken by windows.
    planned: bool,
    /// Number of mode changes in windows so far in this step.
    counted: u64,
    /// What windows that others have absorbed have gained beyond the whole layer's step.
    gained: Energies,
    /// The step of the whole layer that they follow.
    span: StepSpan,
    /// Workspace for that step.
    workspace: DenseWorkspace,
    /// The same for each of its stages.
    nodes: Vec<DenseWorkspace>,
}

/// Why and when, s after the start of the carrier's piece, a step has to end.
#[derive(Clone, Copy, Debug)]
enum Cut {
    /// Too many masses feel the mode changes.
    Crowded(f64),
    /// The step's dense output is too far off there for the run to go on from it.
    Unresolved(f64),
}

impl Windows {
    /// The windows for a layer of `model`; `None` where they would not be much smaller than the layer, under a carrier that is a
    /// body, through which every mass feels every other, and where tangents are asked for, which windows do not have.
    pub(super) fn new(model: &Model, settings: &Settings) -> Option<Box<Self>> {
        let event_driven = settings.method != Method::Step && !settings.is_of_window;
        if !event_driven || settings.accounts.tangents || model.has_bodies() {
            return None;
        }
        let (reach, most_masses) = (reach(model, settings.tolerance.relative)?, model.masses() / OF_MASSES);
        let width = 2 * reach + 1;
        if MIN_WINDOWS * width > model.masses() {
            return None;
        }
        let levels: Vec<_> = levels(width, most_masses).collect();
        let mut windows = Vec::with_capacity(levels.iter().map(|&(_, count)| count).sum());
        for (width, count) in levels {
            let part = model.part(width);
            windows.extend((0..count).map(|_| Window::new(part.clone(), settings)));
        }
        Some(Box::new(Self {
            windows,
            reach,
            most_masses,
            changes: Vec::with_capacity(model.masses()),
            passed: 0,
            planned: false,
            counted: 0,
            gained: Energies::default(),
            span: StepSpan { start: 0.0, length: 0.0 },
            workspace: DenseWorkspace::new(model),
            nodes: vec![
                DenseWorkspace::for_single_masses(model);
                Scheme::event_driven_at(model, settings.tolerance.relative).tableau().stages
            ],
        }))
    }

    /// Changes to another temperature: `model` and `settings` are those of the layer there.
    pub(super) fn heat(&mut self, model: &Model, settings: &Settings) {
        self.windows.iter_mut().for_each(|window| window.heat(model, settings));
        self.workspace = DenseWorkspace::new(model);
        self.nodes.fill(DenseWorkspace::for_single_masses(model));
    }

    /// Memory in bytes, without what each window takes whatever its masses: some thousand.
    pub(super) fn bytes(&self) -> usize {
        self.windows.iter().map(Window::bytes).sum::<usize>() + self.workspace.bytes()
    }

    pub(super) fn newton_iterations(&self) -> u64 {
        self.windows.iter().map(|window| window.run.newton_iterations()).sum()
    }

    fn open(&self) -> impl Iterator<Item = &Window> {
        self.windows.iter().filter(|window| window.open)
    }

    fn open_mut(&mut self) -> impl Iterator<Item = &mut Window> {
        self.windows.iter_mut().filter(|window| window.open)
    }

    /// The open windows, and the step that they follow: `integrator` has tried it from `state`.
    fn open_in_step<'a>(
        &'a mut self,
        model: &'a Model,
        state: &'a RunState,
        integrator: &'a Integrator,
    ) -> (impl Iterator<Item = &'a mut Window>, LayerStep<'a>) {
        let Self { windows, span, workspace, .. } = self;
        let step = layer_step((model, state, integrator), *span, workspace);
        (windows.iter_mut().filter(|window| window.open), step)
    }

    /// Closes all windows.
    fn forget(&mut self) {
        self.open_mut().for_each(|window| window.open = false);
        (self.planned, self.passed, self.counted, self.gained) = (false, 0, 0, Energies::default());
        self.changes.clear();
    }

    /// The open window whose step ends first, and when, s.
    fn first_to_end(&self) -> Option<(usize, f64)> {
        let open = self.windows.iter().enumerate().filter(|(_, window)| window.open);
        open.map(|(index, window)| (index, window.trial_end())).min_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// The next mode change of a mass that is in no open window.
    fn next_change(&mut self) -> Option<(f64, usize)> {
        while let Some(&(theta, mass)) = self.changes.get(self.passed) {
            if !self.open().any(|window| window.masses().contains(&mass)) {
                return Some((theta, mass));
            }
            self.passed += 1;
        }
        None
    }

    /// The masses that feel a mode change of those in `changed`, in a layer of `masses`.
    fn around(&self, changed: Range<usize>, masses: usize) -> Range<usize> {
        changed.start.saturating_sub(self.reach)..(changed.end + self.reach).min(masses)
    }

    /// Opens a window over `masses`, and over those of open windows among them, at the time `s` of the step that `run` has
    /// tried, which has its `end`. Says how the step has to be cut where that cannot be.
    fn open_over(
        &mut self,
        masses: Range<usize>,
        run: &Run,
        (s, end): (f64, f64),
        work: &mut WorkLimit,
    ) -> Result<Option<Cut>, SimulationError> {
        let Some((index, range)) = self.fitting(masses, run.model.masses()) else { return Ok(Some(Cut::Crowded(s))) };
        let is_absorbed = |window: &Window| range.start <= window.masses().start && window.masses().end <= range.end;
        let kept: usize = self.open().filter(|window| !is_absorbed(window)).map(Window::len).sum();
        if kept + range.len() > self.most_masses {
            return Ok(Some(Cut::Crowded(s)));
        }
        let absorbs = self.open().any(is_absorbed);
        let Self { windows, span, workspace, nodes, gained, .. } = self;
        let mut step = layer_step((&run.model, &run.state, &run.workspace.integrator), *span, workspace);
        let (others, rest) = windows.split_at_mut(index);
        let Some((window, more)) = rest.split_first_mut() else { return Ok(Some(Cut::Crowded(s))) };
        window.open_at(run, (&mut step, s), range.start, nodes);
        // One that absorbs others does not go on from the whole layer's step alone.
        if !absorbs && !window.is_resolved(&mut step, MAX_DEFECT) {
            return Ok(Some(Cut::Unresolved(s)));
        }
        for other in others.iter_mut().chain(more).filter(|other| other.open && is_absorbed(other)) {
            gained.gain(&window.absorb(other, (&step, s)));
        }
        window.start(end, work)?;
        Ok(None)
    }

    /// A window that is not open and can have `masses`, of `k`, and with them those of all open windows that it overlaps; and
    /// the masses that it has then.
    fn fitting(&self, masses: Range<usize>, k: usize) -> Option<(usize, Range<usize>)> {
        let mut range = masses;
        loop {
            let index = self.windows.iter().position(|window| !window.open && window.len() >= range.len())?;
            let width = self.windows[index].len();
            let first = range.start.saturating_sub((width - range.len()) / 2).min(k - width);
            let all = first..first + width;
            let overlapping =
                self.open().map(Window::masses).filter(|other| other.start < all.end && all.start < other.end);
            let union = overlapping.fold(all.clone(), |all, other| all.start.min(other.start)..all.end.max(other.end));
            if union == all {
                return Some((index, all));
            }
            range = union;
        }
    }
}

/// The step over `span` that the `integrator` of a layer has tried from `state`.
fn layer_step<'a>(
    (model, state, integrator): (&'a Model, &'a RunState, &'a Integrator),
    span: StepSpan,
    workspace: &'a mut DenseWorkspace,
) -> LayerStep<'a> {
    LayerStep { dense: integrator.dense(model, &state.carrier, &state.layer.state, span), workspace }
}

/// The widths of windows, from the `least` one on, and the number of windows of each: all of one width have at most
/// `most_masses`, and there is [`ROOM`] for some.
fn levels(least: usize, most_masses: usize) -> impl Iterator<Item = (usize, usize)> {
    let wider = |&(width, most): &(usize, usize)| Some((2 * width, (most / 2).max(1)));
    std::iter::successors(Some((least, MAX_WINDOWS)), wider)
        .zip(ROOM.into_iter().chain(std::iter::repeat(ROOM_FOR_WIDE)))
        .take_while(move |((width, _), room)| room * width <= most_masses)
        .map(move |((width, most), _)| (width, most.min(most_masses / width)))
}

/// The number of masses over which the effect of a mode change falls below the tolerance; `None` where it does not within the
/// layer of `model`.
///
/// A chain of links of stiffness c_l between masses on links of stiffness c to the carrier bends by the ratio r from mass to
/// mass, r + 1/r = 2 + c/c_l.
fn reach(model: &Model, relative: f64) -> Option<usize> {
    let ratio = |own: LinkKind, lateral: LinkKind| {
        let of = |own: f64, lateral: f64| {
            let half = 0.5 * own / lateral;
            if lateral > 0.0 { 1.0 / (1.0 + half + (half * (half + 2.0)).sqrt()) } else { 0.0 }
        };
        let long_term = |kind: LinkKind| model.links[kind as usize].stiffness;
        let glassy = |kind: LinkKind| model.glassy[kind as usize];
        // Within a time t a mass is held by m/t + d + ct, at least by d + 2√(mc), and a damper passes d_l on.
        let damping = |kind: LinkKind| model.links[kind as usize].damping;
        let held = damping(own) + 2.0 * (model.mass * glassy(own)).sqrt();
        of(long_term(own), long_term(lateral)).max(of(glassy(own), glassy(lateral))).max(of(held, damping(lateral)))
    };
    let along_x = ratio(LinkKind::Horizontal, LinkKind::LateralX);
    let largest = along_x.max(ratio(LinkKind::Vertical, LinkKind::LateralZ));
    let masses = (DISTURBANCE / relative).ln().max(0.0) / -largest.ln();
    // Without links to the carrier nothing falls: r = 1.
    (largest < 1.0 && masses < model.masses() as f64).then(|| masses.ceil() as usize + 1)
}

impl Run {
    /// Finds the mode changes, if any, of the step of length `h` tried last, for windows to take. `false` where these cannot, since
    /// the first comes before the fraction `least` of the step or there are no windows.
    pub(super) fn plan_windows(&mut self, h: f64, least: f64) -> bool {
        let events = self.event_tolerance();
        let Self { model, state, workspace, .. } = self;
        let Some(windows) = workspace.windows.as_mut().filter(|_| workspace.may_open_windows) else { return false };
        let step = workspace.integrator.dense(model, &state.carrier, &state.layer.state, state.span(h));
        mode_changes(&step, &events, &mut workspace.dense, &mut windows.changes);
        windows.changes.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        windows.planned = windows.changes.first().is_none_or(|(theta, _)| *theta >= least);
        windows.planned
    }

    /// Closes the windows of a step that is accepted.
    pub(super) fn forget_windows(&mut self) {
        if let Some(windows) = &mut self.workspace.windows {
            windows.forget();
        }
    }

    /// Closes the windows of a step that is tried again: their mode changes are taken back.
    pub(super) fn discard_windows(&mut self) {
        let Some(windows) = &mut self.workspace.windows else { return };
        self.state.counters.events -= windows.counted;
        if let Some(record) = &mut self.mode_changes {
            record.truncate(record.len() - windows.counted as usize);
        }
        windows.forget();
    }

    /// Lets the windows of `step`, which ends at `end`, follow it up to the time `s`; both s after the start of the carrier's
    /// piece. Where they cannot, it is cut short. Returns its end.
    ///
    /// # Errors
    /// [`SimulationError`] where a window cannot go on.
    pub(super) fn advance_windows(
        &mut self,
        step: &mut TrialStep,
        (s, end): (f64, f64),
        work: &mut WorkLimit,
    ) -> Result<f64, SimulationError> {
        let (mut end, mut cuts) = (end, 0);
        while let Some(mut windows) = self.workspace.windows.take() {
            windows.span = self.state.span(step.h);
            let cut = self.follow_in(&mut windows, (s.min(end), end), work);
            // Once it is cut, the windows stay where they are.
            windows.planned &= matches!(cut, Ok(None));
            self.workspace.windows = Some(windows);
            let time = match cut? {
                None => return Ok(end),
                Some(Cut::Crowded(time)) => {
                    let share = (time - self.state.s) / step.h;
                    if self.has_windows() || self.can_resume_within(step.h, share) {
                        step.share = share;
                        return Ok(time);
                    }
                    time
                }
                Some(Cut::Unresolved(time)) => time,
            };
            self.count_work(work)?;
            cuts += 1;
            let h = if cuts > MAX_CUTS { 0.5 * (time - self.state.s) } else { time - self.state.s };
            (*step, end) = self.cut_step_at(self.state.s + h, f64::INFINITY, work)?;
        }
        Ok(end)
    }

    /// Lets `windows` follow the step to the time `s`; it has its `end`. Returns where it has to be cut, if it has.
    fn follow_in(
        &mut self,
        windows: &mut Windows,
        (s, end): (f64, f64),
        work: &mut WorkLimit,
    ) -> Result<Option<Cut>, SimulationError> {
        let mut cut = None;
        while windows.planned && cut.is_none() {
            let window = windows.first_to_end().filter(|(_, time)| *time <= s);
            let change = windows.next_change().map(|(theta, mass)| (windows.span.at(theta), mass));
            let change = change.filter(|(time, _)| *time < s && window.is_none_or(|(_, first)| *time < first));
            let next = match (change, window) {
                (Some((time, mass)), _) => {
                    let masses = windows.around(mass..mass + 1, self.model.masses());
                    windows.open_over(masses, self, (time, end), work)
                }
                (None, Some((index, _))) => self.accept_in_window(windows, index, end, work),
                (None, None) => return Ok(None),
            };
            self.count_in_windows(windows);
            cut = next?;
        }
        Ok(cut)
    }

    /// Accepts the step that a window has tried, and lets it try the next one: wider where its ends are off. Returns where the
    /// step of the whole layer, which has its `end`, has to be cut if that cannot be.
    fn accept_in_window(
        &mut self,
        windows: &mut Windows,
        index: usize,
        end: f64,
        work: &mut WorkLimit,
    ) -> Result<Option<Cut>, SimulationError> {
        let k = self.model.masses();
        let allowed = MISMATCH * self.state.layer.largest.allowed_of_mass(&self.model, &self.settings.tolerance);
        let near = windows.reach / 2;
        let Windows { windows: all, span, workspace, .. } = &mut *windows;
        let mut step = layer_step((&self.model, &self.state, &self.workspace.integrator), *span, workspace);
        let window = &mut all[index];
        let changed = window.accept();
        let is_near = changed && window.has_changed_near_end(near, k);
        let is_wide_enough = !is_near && window.mismatch(&mut step) <= allowed;
        self.state.step_after_event = window.run.state.step_after_event;
        if is_wide_enough {
            window.try_next(end, work)?;
            return Ok(None);
        }
        let (s, masses) = (window.reached(), window.masses());
        windows.open_over(windows.around(masses, k), self, (s, end), work)
    }

    /// Counts and records the mode changes in windows since the last call.
    fn count_in_windows(&mut self, windows: &mut Windows) {
        for window in &mut windows.windows {
            let first = window.masses().start;
            let events = std::mem::take(&mut window.run.state.counters.events);
            windows.counted += events;
            self.state.counters.events += events;
            if let (Some(record), Some(of_window)) = (&mut self.mode_changes, &mut window.run.mode_changes) {
                let of_layer = |change: ModeChange| ModeChange { mass: change.mass + first, ..change };
                record.extend(of_window.drain(..).map(of_layer));
            }
        }
    }

    /// Number of mode changes in the windows of the step under way.
    pub(super) fn changes_in_windows(&self) -> u64 {
        self.workspace.windows.as_ref().map_or(0, |windows| windows.counted)
    }

    /// Whether windows are open in the step under way.
    pub(super) fn has_windows(&self) -> bool {
        self.workspace.windows.as_ref().is_some_and(|windows| windows.open().next().is_some())
    }

    /// The energies in windows up to the time `s` beyond those of the whole layer's step, J.
    pub(super) fn energies_of_windows(&mut self, s: f64) -> Energies {
        let Self { model, state, workspace: Workspace { integrator, windows, .. }, .. } = self;
        let Some(windows) = windows else { return Energies::default() };
        let mut sum = windows.gained;
        let (open, step) = windows.open_in_step(model, state, integrator);
        open.for_each(|window| sum.gain(&window.energies(&step, s)));
        sum
    }

    /// F_x and F_z of the windows at the time `s` beyond those in the whole layer's step, N.
    pub(super) fn forces_of_windows(&mut self, s: f64) -> (f64, f64) {
        let Self { model, state, workspace: Workspace { integrator, windows, .. }, .. } = self;
        let Some(windows) = windows else { return (0.0, 0.0) };
        let (open, mut step) = windows.open_in_step(model, state, integrator);
        let forces = open.map(|window| window.forces(&mut step, s));
        forces.fold((0.0, 0.0), |sum, force| (sum.0 + force.0, sum.1 + force.1))
    }

    /// P_diss of the windows at the time `s` beyond that in the whole layer's step, W, where the powers at the stages say it.
    pub(super) fn dissipated_power_of_windows(&mut self, s: f64) -> f64 {
        let Self { model, state, workspace: Workspace { integrator, windows, .. }, .. } = self;
        let Some(windows) = windows else { return 0.0 };
        let (open, step) = windows.open_in_step(model, state, integrator);
        open.map(|window| window.dissipated_power(&step, s)).sum()
    }

    /// Puts the masses of the windows at the time `s` into the run's state.
    pub(super) fn overlay_windows(&mut self, s: f64) {
        let Self { model, state, workspace, .. } = self;
        if let Some(windows) = &mut workspace.windows {
            windows.write(model, &mut state.layer.state, s);
        }
    }
}

impl Overlay for Windows {
    fn write(&mut self, model: &Model, state: &mut State, s: f64) {
        self.open_mut().for_each(|window| window.write_state((model, 0), state, s));
    }
}

#[cfg(test)]
mod tests;
