//! Local regions: steps of the masses near a mode change alone, within a step of the whole layer (multirate time
//! stepping).
//!
//! A mode change is felt by the masses near it alone: the carrier holds every mass, so the effect of a change falls by
//! a constant ratio from mass to mass. So the step of the whole layer is not cut there. The masses near it form a
//! [`LocalRegion`], which goes on from the change in steps of its own, under the forces that the whole layer's step has
//! in the links to the others. What these others then miss is far below the tolerance; where it is not, a wider region
//! takes the place of the first (docs/theory.md, section 13).
//!
//! All regions of a step move on together, in the order of time: so a wider one can be opened, or the step cut short,
//! at any time. At the end of the step their masses take the places of those in it.

mod region;
#[cfg(test)]
mod tests;

use std::ops::Range;

use super::context::RunContext;
use super::controller::{TrialStep, WorkLimit};
use super::event_driven::{EventDriven, MAX_CUTS, MAX_DEFECT, accept_motion, can_resume};
use super::motion::{ModeChange, SimulationError};
use super::settings::Settings;
use super::stepper::StepMethod;
use crate::integrator::{DenseWorkspace, LayerStep, Overlay, Scheme, TimeSpan};
use crate::model::{ByAxis, LinkKind, Model, State};
use crate::outputs::Energies;
use crate::scene::Method;
use region::LocalRegion;

/// How far off a mass is by the end of a step that knows nothing of its mode change, as a fraction of the scene's
/// height.
///
/// Recommended 0.03 to 1. More makes regions wider than need be, less has them widened more often.
const DISTURBANCE: f64 = 0.3;
/// A layer has regions only where it is at least this many narrowest regions wide.
const MIN_REGIONS: usize = 4;
/// Regions may hold at most the layer's masses divided by this: beyond that it is better to cut the step.
const OF_MASSES: usize = 2;
/// The most regions of the least width, of twice this width half as many, and so on: more are seldom open at once, and
/// each takes memory.
const MAX_REGIONS: usize = 16;
/// There are regions of the two least widths where so many of them would have room.
const ROOM: [usize; 2] = [2, 2];
/// There are wider ones where so many have room: the steps of the few widest cost about as much as to cut that of the
/// layer, and they take memory.
const ROOM_FOR_WIDE: usize = 4;
/// The force by which the links at a region's ends may be off, as a fraction of the error allowed in the force of one
/// mass.
///
/// Recommended 0.1 to 1.
const MISMATCH: f64 = 0.5;

/// The local regions of a layer. Its [`EventDriven`] steps plan the mode changes that they take.
#[derive(Clone, Debug)]
pub(super) struct LocalRegions {
    /// From narrow to wide.
    regions: Vec<LocalRegion>,
    /// Number of masses to each side of one that changes its mode that feel it.
    reach: usize,
    /// The most masses that open regions may have.
    max_masses: usize,
    /// Number of mode changes in regions so far in this step.
    counted: u64,
    /// What regions that others have absorbed have gained beyond the whole layer's step.
    gained: Energies,
    /// The step of the whole layer that they follow.
    span: TimeSpan,
    /// Workspace for that step.
    workspace: DenseWorkspace,
    /// Workspace for each of its stages.
    nodes: Vec<DenseWorkspace>,
}

/// Why and when, s after the start of the carrier's segment, a step has to end.
#[derive(Clone, Copy, Debug)]
enum Cut {
    /// Too many masses feel the mode changes.
    Crowded(f64),
    /// The step's dense output is too far off there for the run to go on from it.
    Unresolved(f64),
}

impl LocalRegions {
    /// The regions for a layer of `model`. There are none where they would not be much smaller than the layer, under a
    /// carrier that is a body, through which every mass feels every other, with links whose forces follow the spacing of
    /// their neighbours, and where tangents are asked for, which
    /// regions do not have.
    pub(super) fn new(model: &Model, settings: &Settings) -> Self {
        let Settings { method, tolerance, accounts, .. } = settings;
        let have_none = *method == Method::Step
            || accounts.tangents
            || model.has_bodies()
            || model.spatial.is_some()
            || model.flash.is_some()
            || model.friction.memory.is_some();
        let reach = if have_none { None } else { reach(model, tolerance.relative) };
        let least = reach.map(|reach| 2 * reach + 1).filter(|width| MIN_REGIONS * width <= model.masses());
        let max_masses = model.masses() / OF_MASSES;
        let levels = least.into_iter().flat_map(|least| levels(least, max_masses));
        let regions: Vec<_> = levels
            // Each has a model of its own: one that they share would be copied when they first open.
            .flat_map(|(width, count)| (0..count).map(move |_| LocalRegion::new(model, width, settings)))
            .collect();
        let stages =
            if regions.is_empty() { 0 } else { Scheme::event_driven_at(model, tolerance.relative).tableau().stages };
        Self {
            workspace: workspace(model, regions.is_empty()),
            regions,
            reach: reach.unwrap_or(0),
            max_masses,
            counted: 0,
            gained: Energies::default(),
            span: TimeSpan { start: 0.0, length: 0.0 },
            nodes: vec![DenseWorkspace::for_single_masses(model); stages],
        }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.regions.is_empty()
    }

    /// Changes to another temperature: `model` and `settings` are those of the layer there.
    pub(super) fn set_temperature(&mut self, model: &Model, settings: &Settings) {
        self.regions.iter_mut().for_each(|region| region.set_temperature(model, settings));
        self.workspace = workspace(model, self.is_empty());
        self.nodes.fill(DenseWorkspace::for_single_masses(model));
    }

    pub(super) fn newton_iterations(&self) -> u64 {
        self.regions.iter().map(|region| region.context.integrator.iterations()).sum()
    }

    /// Number of mode changes in the regions of the step under way.
    pub(super) fn mode_changes(&self) -> u64 {
        self.counted
    }

    fn open(&self) -> impl Iterator<Item = &LocalRegion> {
        self.regions.iter().filter(|region| region.open)
    }

    fn open_mut(&mut self) -> impl Iterator<Item = &mut LocalRegion> {
        self.regions.iter_mut().filter(|region| region.open)
    }

    /// The open regions, and the step that they follow: that of `context` tried last.
    fn open_in_step<'a>(
        &'a mut self,
        context: &'a RunContext,
    ) -> (impl Iterator<Item = &'a mut LocalRegion>, LayerStep<'a>) {
        let Self { regions, span, workspace, .. } = self;
        (regions.iter_mut().filter(|region| region.open), whole_layer(context, *span, workspace))
    }

    /// Closes the regions of a step that was accepted, or of a motion that has ended.
    pub(super) fn close(&mut self) {
        self.open_mut().for_each(|region| region.open = false);
        (self.counted, self.gained) = (0, Energies::default());
    }

    /// Closes the regions of a step of `context` that is tried again: their mode changes are taken back.
    pub(super) fn discard(&mut self, context: &mut RunContext) {
        context.state.counters.events -= self.counted;
        if let Some(record) = &mut context.mode_changes {
            record.truncate(record.len() - self.counted as usize);
        }
        self.close();
    }

    /// Lets the regions of `step`, which `stepper` has tried and which ends at `end`, follow it up to the time `s`;
    /// both s after the start of the carrier's segment. Where they cannot, it is cut short. Returns its end.
    pub(super) fn advance(
        &mut self,
        (context, stepper): (&mut RunContext, &mut EventDriven),
        step: &mut TrialStep,
        (s, mut end): (f64, f64),
        work: &mut WorkLimit,
    ) -> Result<f64, SimulationError> {
        let mut cuts = 0;
        loop {
            self.span = context.state.span(step.h);
            let cut = self.follow((context, stepper), (s.min(end), end), work);
            // Once it is cut, the regions stay where they are.
            stepper.planned &= matches!(cut, Ok(None));
            let time = match cut? {
                None => return Ok(end),
                Some(Cut::Crowded(time)) => {
                    let fraction = context.state.fraction_at(time, step.h);
                    if self.open().next().is_some() || can_resume(context, step.h, fraction) {
                        step.fraction = fraction;
                        return Ok(time);
                    }
                    time
                }
                Some(Cut::Unresolved(time)) => time,
            };
            // The step is tried again up to there, and without its regions.
            work.count(context.state.time(), context.model.work_of_step())?;
            cuts += 1;
            let start = context.state.s;
            let h = if cuts > MAX_CUTS { 0.5 * (time - start) } else { time - start };
            self.discard(context);
            (*step, end) = stepper.cut_step_at(context, (start + h, f64::INFINITY), work)?;
        }
    }

    /// Lets the regions follow the step of `context` to the time `s` and take the mode changes in it; it has its `end`.
    /// Returns where it has to be cut, if it has.
    fn follow(
        &mut self,
        (context, stepper): (&mut RunContext, &mut EventDriven),
        (s, end): (f64, f64),
        work: &mut WorkLimit,
    ) -> Result<Option<Cut>, SimulationError> {
        let mut cut = None;
        while stepper.planned && cut.is_none() {
            // What comes first: the end of a region's step, or a mode change of a mass that is in none.
            let region = self.first_to_end().filter(|(_, time)| *time <= s);
            let change = stepper.next_change(|mass| self.open().any(|region| region.masses().contains(&mass)));
            let change = change.map(|(theta, mass)| (self.span.at(theta), mass));
            let change = change.filter(|(time, _)| *time < s && region.is_none_or(|(_, first)| *time < first));
            let next = match (change, region) {
                (Some((time, mass)), _) => {
                    let masses = self.around(mass..mass + 1, context.model.masses());
                    self.open_over(masses, context, (time, end), work)
                }
                (None, Some((index, _))) => self.accept_in(index, context, end, work),
                (None, None) => return Ok(None),
            };
            self.record_mode_changes(context);
            cut = next?;
        }
        Ok(cut)
    }

    /// The open region whose step ends first, and when, s.
    fn first_to_end(&self) -> Option<(usize, f64)> {
        let open = self.regions.iter().enumerate().filter(|(_, region)| region.open);
        open.map(|(index, region)| (index, region.trial_end)).min_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// The masses that feel a mode change of those in `changed`, in a layer of `masses`.
    fn around(&self, changed: Range<usize>, masses: usize) -> Range<usize> {
        changed.start.saturating_sub(self.reach)..(changed.end + self.reach).min(masses)
    }

    /// Opens a region over `masses`, and over those of open regions among them, at the time `s` of the step of
    /// `context`, which has its `end`. Says how the step has to be cut where that cannot be.
    fn open_over(
        &mut self,
        masses: Range<usize>,
        context: &RunContext,
        (s, end): (f64, f64),
        work: &mut WorkLimit,
    ) -> Result<Option<Cut>, SimulationError> {
        // There is room for it.
        let Some((index, range)) = self.fitting(masses, context.model.masses()) else {
            return Ok(Some(Cut::Crowded(s)));
        };
        let is_absorbed =
            |region: &LocalRegion| range.start <= region.masses().start && region.masses().end <= range.end;
        let kept: usize = self.open().filter(|region| !is_absorbed(region)).map(LocalRegion::len).sum();
        if kept + range.len() > self.max_masses {
            return Ok(Some(Cut::Crowded(s)));
        }
        // It starts from the layer's step. One that absorbs others does not go on from that alone.
        let absorbs = self.open().any(is_absorbed);
        let Self { regions, span, workspace, nodes, gained, .. } = self;
        let mut step = whole_layer(context, *span, workspace);
        let (others, rest) = regions.split_at_mut(index);
        let Some((region, more)) = rest.split_first_mut() else { return Ok(Some(Cut::Crowded(s))) };
        region.open_at(context, (&mut step, s), range.start, nodes);
        if !absorbs && !region.is_resolved(&mut step, MAX_DEFECT) {
            return Ok(Some(Cut::Unresolved(s)));
        }
        for other in others.iter_mut().chain(more).filter(|other| other.open && is_absorbed(other)) {
            gained.gain(&region.absorb(other, (&step.dense, s)));
        }
        region.start(end, work)?;
        Ok(None)
    }

    /// A region that is not open and can have `masses`, of `k`, and with them those of all open regions that it
    /// overlaps; and the masses that it has then.
    fn fitting(&self, masses: Range<usize>, k: usize) -> Option<(usize, Range<usize>)> {
        let mut range = masses;
        loop {
            let index = self.regions.iter().position(|region| !region.open && region.len() >= range.len())?;
            let width = self.regions[index].len();
            let first = range.start.saturating_sub((width - range.len()) / 2).min(k - width);
            let all = first..first + width;
            let overlapping =
                self.open().map(LocalRegion::masses).filter(|other| other.start < all.end && all.start < other.end);
            let union = overlapping.fold(all.clone(), |all, other| all.start.min(other.start)..all.end.max(other.end));
            if union == all {
                return Some((index, all));
            }
            range = union;
        }
    }

    /// Accepts the step that a region has tried, and lets it try the next one: wider where its ends are off. Returns
    /// where the step of the whole layer, which has its `end`, has to be cut if that cannot be.
    fn accept_in(
        &mut self,
        index: usize,
        context: &mut RunContext,
        end: f64,
        work: &mut WorkLimit,
    ) -> Result<Option<Cut>, SimulationError> {
        let k = context.model.masses();
        let allowed =
            MISMATCH * context.state.layer.largest.allowed_of_mass(&context.model, &context.settings.tolerance);
        let (region, mut step) = (&mut self.regions[index], whole_layer(context, self.span, &mut self.workspace));
        let is_near = region.accept() && region.has_changed_near_end(self.reach / 2, k);
        let is_wide_enough = !is_near && region.mismatch(&mut step) <= allowed;
        context.state.controller.step_after_event = region.context.state.controller.step_after_event;
        if is_wide_enough {
            region.try_next(end, work)?;
            return Ok(None);
        }
        let (s, masses) = (region.reached(), region.masses());
        self.open_over(self.around(masses, k), context, (s, end), work)
    }

    /// Counts and records in `context` the mode changes in regions since the last call.
    fn record_mode_changes(&mut self, context: &mut RunContext) {
        for region in &mut self.regions {
            let first = region.masses().start;
            let events = std::mem::take(&mut region.context.state.counters.events);
            self.counted += events;
            context.state.counters.events += events;
            if let (Some(record), Some(of_region)) = (&mut context.mode_changes, &mut region.context.mode_changes) {
                let of_layer = |change: ModeChange| ModeChange { mass: change.mass + first, ..change };
                record.extend(of_region.drain(..).map(of_layer));
            }
        }
    }

    /// Accepts `step`, which ends at the time `end`, with the masses of the regions in place of those in it.
    pub(super) fn accept(
        &mut self,
        (context, stepper): (&mut RunContext, &mut EventDriven),
        step: &TrialStep,
        end: f64,
    ) {
        let mut energies = stepper.energies(context, step.h, step.fraction);
        energies.gain(&self.energies(context, end));
        context.state.energies = energies;
        let is_open = self.open().next().is_some();
        accept_motion(context, step, end, if is_open { Some(&mut *self) } else { None });
        stepper.clear_changes();
        self.close();
    }

    /// The energies in regions up to the time `s` beyond those of the whole layer's step, J.
    pub(super) fn energies(&mut self, context: &RunContext, s: f64) -> Energies {
        let mut sum = self.gained;
        let (open, step) = self.open_in_step(context);
        open.for_each(|region| sum.gain(&region.energies(&step.dense, s)));
        sum
    }

    /// F_x and F_z of the regions at the time `s` beyond those in the whole layer's step, N.
    pub(super) fn forces(&mut self, context: &RunContext, s: f64) -> ByAxis<f64> {
        let (open, mut step) = self.open_in_step(context);
        let forces = open.map(|region| region.forces(&mut step, s));
        forces.fold(ByAxis::default(), |sum, force| sum + force)
    }

    /// P_diss of the regions at the time `s` beyond that in the whole layer's step, W, where the powers at the stages
    /// say it.
    pub(super) fn dissipated_power(&mut self, context: &RunContext, s: f64) -> f64 {
        let (open, step) = self.open_in_step(context);
        open.fold(0.0, |sum, region| sum + region.dissipated_power(&step.dense, s))
    }
}

impl Overlay for LocalRegions {
    fn write(&mut self, model: &Model, state: &mut State, s: f64) {
        self.open_mut().for_each(|region| region.write_state((model, 0), state, s));
    }
}

/// Workspace for the steps of the layer, if there are regions in it.
fn workspace(model: &Model, is_empty: bool) -> DenseWorkspace {
    if is_empty { DenseWorkspace::for_single_masses(model) } else { DenseWorkspace::new(model) }
}

/// The step of `context` over `span` that was tried last.
fn whole_layer<'a>(context: &'a RunContext, span: TimeSpan, workspace: &'a mut DenseWorkspace) -> LayerStep<'a> {
    let RunContext { model, state, integrator, .. } = context;
    LayerStep { dense: integrator.dense(model, &state.carrier, &state.layer.state, span), workspace }
}

/// The widths of regions, from the `least` one on, and the number of regions of each: all of one width have at most
/// `max_masses`, and there is [`ROOM`] for some.
fn levels(least: usize, max_masses: usize) -> impl Iterator<Item = (usize, usize)> {
    let wider = |&(width, most): &(usize, usize)| Some((2 * width, (most / 2).max(1)));
    std::iter::successors(Some((least, MAX_REGIONS)), wider)
        .zip(ROOM.into_iter().chain(std::iter::repeat(ROOM_FOR_WIDE)))
        .take_while(move |((width, _), room)| room * width <= max_masses)
        .map(move |((width, most), _)| (width, most.min(max_masses / width)))
}

/// The number of masses over which the effect of a mode change falls below the tolerance; `None` where it does not
/// within the layer of `model`.
///
/// A chain of links of stiffness c_l between masses on links of stiffness c to the carrier bends by the ratio r from
/// mass to mass, r + 1/r = 2 + c/c_l.
fn reach(model: &Model, relative: f64) -> Option<usize> {
    let ratio = |own: LinkKind, lateral: LinkKind| {
        let of = |own: f64, lateral: f64| {
            let half = 0.5 * own / lateral;
            if lateral > 0.0 { 1.0 / (1.0 + half + (half * (half + 2.0)).sqrt()) } else { 0.0 }
        };
        let long_term = |kind: LinkKind| model.links[kind].stiffness;
        let glassy = |kind: LinkKind| model.glassy[kind];
        // Within a time t a mass is held by m/t + d + ct, at least by d + 2√(mc), and a damper passes d_l on.
        let damping = |kind: LinkKind| model.links[kind].damping;
        let held = damping(own) + 2.0 * (model.mass * glassy(own)).sqrt();
        of(long_term(own), long_term(lateral)).max(of(glassy(own), glassy(lateral))).max(of(held, damping(lateral)))
    };
    let along_x = ratio(LinkKind::Horizontal, LinkKind::LateralX);
    let largest = along_x.max(ratio(LinkKind::Vertical, LinkKind::LateralZ));
    let masses = (DISTURBANCE / relative).ln().max(0.0) / -largest.ln();
    // Without links to the carrier nothing falls: r = 1.
    (largest < 1.0 && masses < model.masses() as f64).then(|| masses.ceil() as usize + 1)
}
