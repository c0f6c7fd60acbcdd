//! The mode changes within a step, or the first of them: touch, lift, stop or break.

use super::gap::first_touch;
use crate::integrator::{DenseOutput, DenseWorkspace, Polynomials, StageValues, Tolerance};
use crate::math::{Spline, root_between, with_widest_vectors};
use crate::model::{CarrierPosition, LinkKind, Mode, Model, State};

/// How far a quantity may pass its limit before the mode changes: as far as a step may err, velocities less. An event
/// is located where the quantity is half as far past it, so that the limit has been passed for certain, and other
/// changes that are about to come are made at the same instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EventTolerance {
    /// Of the gap, m.
    pub gap: f64,
    /// Of the velocity of a slipping mass, m/s.
    pub velocity: f64,
    /// Of the normal force, and of the tangential force of a sticking mass, N.
    pub force: f64,
    /// The least of that, by rounding, N.
    rounding: f64,
    /// The velocity that such a force makes in a horizontal link, by its damper and against the mass, m/(N s).
    mobility: f64,
}

/// The velocity tolerance of stops as a share of that of steps.
///
/// Recommended 0.001 to 0.1. Until a slip that has reversed is stopped, friction drives it on; where the reversal is
/// slow, it goes far in the meantime.
const OF_STOPS: f64 = 0.01;

/// The gap tolerance as a share of the position tolerance, over the relative tolerance.
///
/// A mass that grazes the profile less deep than the gap tolerance is not seen to touch. It touches later, by a time
/// that goes with the root of that depth, and friction and impact come later by as much. Coarse steps know dips only to
/// the position tolerance.
const SHARE_OF_DIPS: f64 = 1e3;
/// The least such share.
///
/// Recommended 1e-5 to 0.1. The less, the more grazing touches are found, and the more steps are cut at them.
const MIN_SHARE_OF_DIPS: f64 = 1e-4;
/// The least gap tolerance as a share of the scene's height, up to the position tolerance.
///
/// Recommended 1e-13 to 1e-12. Less comes near to roundings, by which masses touch and lift without end.
const MIN_DIP: f64 = 1e-12;

/// The rounding error of a force or of a gap, as a number of roundings of a position.
const ROUNDINGS: f64 = 4.0;

impl EventTolerance {
    /// The event tolerances that belong to the step tolerances.
    pub fn new(model: &Model, tolerance: &Tolerance) -> Self {
        let stiffness = model.long_term_stiffness().unwrap_or_else(|| model.effective_stiffness());
        // The rounding of a position, at most of the layer's height (the absolute tolerance over the relative one), is
        // a force in a rod.
        let height = tolerance.position / tolerance.relative;
        let rounding = ROUNDINGS * f64::EPSILON * height * model.rounding_stiffness();
        let link = LinkKind::Horizontal;
        let impedance = model.links[link].damping + (model.glassy[link] * model.mass).sqrt();
        let share_of_dips = (SHARE_OF_DIPS * tolerance.relative).clamp(MIN_SHARE_OF_DIPS, 1.0);
        let min_gap = (MIN_DIP * height).max(rounding_of_gap(model, height));
        Self {
            gap: (share_of_dips * tolerance.position).max(min_gap.min(tolerance.position)),
            velocity: OF_STOPS * tolerance.velocity,
            force: (tolerance.position * stiffness).max(rounding),
            rounding,
            mobility: if impedance > 0.0 { 1.0 / impedance } else { f64::MAX },
        }
    }

    /// These tolerances, tightened so that the force of one mass errs by no more than `force` (N).
    #[must_use]
    pub fn within(&self, force: f64) -> Self {
        let force = self.force.min(force).max(self.rounding);
        Self { velocity: self.velocity.min(OF_STOPS * force * self.mobility), force, ..*self }
    }

    /// The tolerance of [`StageValues::margin`] in `mode`.
    fn margin(&self, mode: Mode) -> f64 {
        if mode == Mode::Stick { self.force } else { self.velocity }
    }
}

/// The rounding error of a mass's gap to the profile in a scene of this `height`, m: the height at a position along x
/// is as far off as that position, times the slope.
fn rounding_of_gap(model: &Model, height: f64) -> f64 {
    let reach = model.rest_x.iter().fold(0.0, |most: f64, x| most.max(x.abs())) + model.profile.reach();
    ROUNDINGS * f64::EPSILON * (height + model.profile.bounds().slope_max_abs * reach)
}

/// The fraction of the step at which the first mode change is due; `None` if none is.
pub fn first_event(step: &DenseOutput<'_>, tolerance: &EventTolerance, workspace: &mut DenseWorkspace) -> Option<f64> {
    let mut first = Contacts { step, tolerance, workspace }.first_change();
    let (motions, profile) = (Polynomials::new(step), &step.model.profile);
    for i in 0..step.model.masses() {
        if step.start.mode[i] == Mode::Free && may_touch(&motions, i, profile, tolerance.gap) {
            let motion = (motions.position(i), motions.height(i));
            first = earlier(first, first_touch(profile, motion, tolerance.gap, first.unwrap_or(1.0)));
        }
    }
    first
}

/// The first mode change of each mass within the step, as its fraction and the mass, into `changes`.
pub fn mode_changes(
    step: &DenseOutput<'_>,
    tolerance: &EventTolerance,
    workspace: &mut DenseWorkspace,
    changes: &mut Vec<(f64, usize)>,
) {
    changes.clear();
    let mut contacts = Contacts { step, tolerance, workspace };
    contacts.all_changes(changes);
    let (motions, profile) = (Polynomials::new(step), &step.model.profile);
    for i in 0..step.model.masses() {
        if step.start.mode[i] == Mode::Free && may_touch(&motions, i, profile, tolerance.gap) {
            let motion = (motions.position(i), motions.height(i));
            changes.extend(first_touch(profile, motion, tolerance.gap, 1.0).map(|theta| (theta, i)));
        }
    }
}

/// Whether mass `i` may come below -`tolerance` (m) above the profile. Bounds that are nearly free are enough for most.
fn may_touch(motions: &Polynomials<'_>, i: usize, profile: &Spline, tolerance: f64) -> bool {
    let least = motions.min_height(i);
    let clear = |top: f64| least - top > -tolerance;
    let clear_near = || {
        let (low, high) = motions.position_bounds(i);
        clear(profile.top_near(low, high))
    };
    !(clear(profile.bounds().z_max) || clear_near())
}

fn earlier(a: Option<f64>, b: Option<f64>) -> Option<f64> {
    match (a, b) {
        (Some(a), Some(b)) => Some(a.min(b)),
        (a, b) => a.or(b),
    }
}

/// The contacts through a step. Where a stage shows that a limit is passed, the dense output decides: it is more
/// accurate than the stages, and the run continues from it.
struct Contacts<'a> {
    step: &'a DenseOutput<'a>,
    tolerance: &'a EventTolerance,
    workspace: &'a mut DenseWorkspace,
}

/// A quantity of a contact with a limit.
#[derive(Clone, Copy, PartialEq)]
enum EventFunction {
    /// F_N ≥ 0.
    Normal,
    /// [`StageValues::margin`] ≥ 0.
    Margin,
}

impl EventFunction {
    /// The quantity of all masses at one stage.
    fn values(self, stage: &StageValues) -> &[f64] {
        if self == Self::Normal { &stage.normal } else { &stage.margin }
    }
}

/// Masses taken together in the search for contacts that may change.
const BLOCK: usize = 64;

impl Contacts<'_> {
    /// Whether the carrier may turn between the stages without the error test noticing.
    fn carrier_swings(&self) -> bool {
        self.step.carrier.shortest_period() < f64::INFINITY
    }

    /// As a bit each, the masses in contact of which a quantity may pass its limit within the step, of the [`BLOCK`]
    /// from mass `first` on: those of which one does at a stage or on a parabola through its values there.
    fn suspects(&self, first: usize) -> u64 {
        let modes = &self.step.start.mode[first..];
        let overshoot = if self.carrier_swings() { self.step.interpolation().overshoot() } else { 0.0 };
        let least = |function: EventFunction| {
            let stages = self.step.stages().iter().map(|stage| &function.values(stage)[first..]);
            min_within(stages, overshoot)
        };
        let (normal, margin) = (least(EventFunction::Normal), least(EventFunction::Margin));
        let mut falls = [false; BLOCK];
        for ((falls, mode), (normal, margin)) in falls.iter_mut().zip(modes).zip(normal.iter().zip(&margin)) {
            let beyond = (*normal < -self.tolerance.force) | (*margin < -self.tolerance.margin(*mode));
            *falls = mode.in_contact() & beyond;
        }
        if !falls.contains(&true) {
            return 0;
        }
        falls.iter().rev().fold(0, |suspects, &falls| suspects << 1 | u64::from(falls))
    }

    /// The masses in contact that may change their modes within the step, from `first` on in a block.
    fn suspects_from(&self, first: usize) -> impl Iterator<Item = usize> + use<> {
        let suspects = self.suspects(first);
        (0..BLOCK).filter(move |bit| suspects >> bit & 1 == 1).map(move |bit| first + bit)
    }

    /// Whether no contact of the block from mass `first` on that is not suspected changes its mode.
    fn others_hold(&mut self, first: usize) -> bool {
        let (suspects, modes) = (self.suspects(first), &self.step.start.mode);
        let mut others = (first..modes.len().min(first + BLOCK)).filter(|i| suspects >> (i - first) & 1 == 0);
        others.all(|i| !modes[i].in_contact() || self.change_of(i, None).is_none())
    }

    /// The masses that slip no faster than v_c at the start of the step, where friction changes with the speed beyond.
    ///
    /// Their modes stay as they pass v_c. But where friction falls from there on, slip grows faster than a step is long that
    /// takes it for creep: the step has to end there.
    fn creeping(&self) -> impl Iterator<Item = usize> {
        let start = &self.step.start;
        let creeps = move |i: &usize| {
            let passes = |creep: f64| self.slip_speed(*i, start.velocity_x[*i]) < creep;
            start.mode[*i].slips() && self.creep_speed(*i).is_some_and(passes)
        };
        let masses = if self.step.model.friction.creep_end(0.0).is_some() { self.step.model.masses() } else { 0 };
        (0..masses).filter(creeps)
    }

    /// v_c of mass `i`, m/s, at its flash temperature at the start of the step; not so slow that no step could end there.
    fn creep_speed(&self, i: usize) -> Option<f64> {
        let creep_speed = self.step.model.friction.creep_end(self.step.start.flash(i))?;
        Some(creep_speed.max(CREEP_RESOLVED * self.tolerance.velocity))
    }

    /// v_t of mass `i` with this ẋ, m/s, over the slope at the start of the step.
    fn slip_speed(&self, i: usize, velocity_x: f64) -> f64 {
        let slope = self.step.start.surface[i].slope;
        velocity_x.abs() * (1.0 + slope * slope).sqrt()
    }

    /// The fraction at which mass `i`, which creeps, passes v_c; `first` if it does not before that.
    fn creep_end(&self, i: usize, first: Option<f64>) -> Option<f64> {
        let Some(creep_speed) = self.creep_speed(i) else { return first };
        let beyond = |velocity_x: f64| (1.0 + CREEP_PASSED) * creep_speed - self.slip_speed(i, velocity_x);
        let stages = self.step.stages();
        let in_time = |rank: usize| &stages[self.step.interpolation().in_time()[rank]];
        let rank = (1..stages.len()).find(|&rank| beyond(in_time(rank).velocity_x[i]) < 0.0);
        let Some(rank) = rank.filter(|&rank| self.node(rank - 1) < first.unwrap_or(1.0)) else { return first };
        let at = |theta: f64| beyond(self.step.velocity_x(i, theta));
        let (before, after) = (self.node(rank - 1), self.node(rank));
        let ends = [(before, at(before)), (after, at(after))];
        let passes = ends[0].1 > 0.0 && ends[1].1 < 0.0;
        if passes { earlier(first, Some(root_between(at, ends, LOCATED))) } else { first }
    }

    fn all_changes(&mut self, changes: &mut Vec<(f64, usize)>) {
        for block in (0..self.step.model.masses()).step_by(BLOCK) {
            debug_assert!(self.others_hold(block), "a mode change of a mass from {block} on would be missed");
            for i in self.suspects_from(block) {
                changes.extend(self.change_of(i, None).map(|theta| (theta, i)));
            }
        }
        for i in self.creeping() {
            match (self.creep_end(i, None), changes.iter_mut().find(|change| change.1 == i)) {
                (Some(theta), Some(change)) => change.0 = change.0.min(theta),
                (Some(theta), None) => changes.push((theta, i)),
                (None, _) => (),
            }
        }
    }

    fn first_change(&mut self) -> Option<f64> {
        let mut first = None;
        for block in (0..self.step.model.masses()).step_by(BLOCK) {
            for i in self.suspects_from(block) {
                first = self.change_of(i, first);
            }
        }
        self.creeping().fold(first, |first, i| self.creep_end(i, first))
    }

    /// The fraction at which mass `i`, in contact, first changes its mode; `first` if it does not before that.
    fn change_of(&mut self, i: usize, first: Option<f64>) -> Option<f64> {
        let (force, of_margin) = (self.tolerance.force, self.tolerance.margin(self.step.start.mode[i]));
        let first = self.fall(i, EventFunction::Normal, force, first);
        let first = self.fall(i, EventFunction::Margin, of_margin, first);
        if !self.carrier_swings() {
            return first;
        }
        let first = self.dip(i, EventFunction::Normal, force, first);
        self.dip(i, EventFunction::Margin, of_margin, first)
    }

    /// The first fraction at which a quantity of mass `i` falls below its tolerance between the stages alone: at the
    /// vertex of the parabola through its least value at a stage and those before and after.
    fn dip(&mut self, i: usize, function: EventFunction, tolerance: f64, first: Option<f64>) -> Option<f64> {
        let inner = 1..self.step.stages().len() - 1;
        let least =
            inner.min_by(|&a, &b| f64::total_cmp(&self.at_stage(a, i, function), &self.at_stage(b, i, function)));
        let Some(rank) = least else { return first };
        let [before, here, after] =
            [rank - 1, rank, rank + 1].map(|rank| (self.node(rank), self.at_stage(rank, i, function)));
        let Some((theta, value)) = vertex(before, here, after) else { return first };
        if value >= -tolerance || theta >= first.unwrap_or(1.0) {
            return first;
        }
        let value = self.value(i, function, theta);
        if value < -tolerance { Some(self.locate(i, function, tolerance, before.0, (theta, value))) } else { first }
    }

    /// The fraction at which a quantity of mass `i` first falls below -`tolerance`, located where it is -`tolerance`/2;
    /// `first` if it does not before that.
    fn fall(&mut self, i: usize, function: EventFunction, tolerance: f64, first: Option<f64>) -> Option<f64> {
        if !self.step.stages()[1..].iter().any(|stage| function.values(stage)[i] < -tolerance) {
            return first;
        }
        let latest = first.unwrap_or(1.0);
        let ranks = self.step.stages().len();
        let rank = (1..ranks).find(|&rank| self.at_stage(rank, i, function) < -tolerance);
        let Some(rank) = rank.filter(|&rank| self.node(rank - 1) < latest) else { return first };
        for rank in rank..ranks {
            if self.at_stage(rank, i, function) >= -tolerance {
                continue;
            }
            let (before, below) = (self.node(rank - 1).min(latest), self.node(rank).min(latest));
            let value = self.value(i, function, below);
            if value < -tolerance {
                return Some(self.locate(i, function, tolerance, before, (below, value)));
            }
        }
        first
    }

    /// Where a quantity of mass `i` is -`tolerance`/2, between a fraction `before` and one `below` which it has passed:
    /// that one and the value there, less than -`tolerance`. `before` itself if the quantity is that far below there.
    fn locate(&mut self, i: usize, function: EventFunction, tolerance: f64, before: f64, below: (f64, f64)) -> f64 {
        let aim = 0.5 * tolerance;
        let value = self.value(i, function, before);
        if value <= -aim {
            return before;
        }
        let beyond = |value: f64| if (value + aim).abs() < NEAR * tolerance { 0.0 } else { value + aim };
        let ends = [(before, beyond(value)), (below.0, beyond(below.1))];
        root_between(|theta| beyond(self.value(i, function, theta)), ends, LOCATED)
    }

    /// The fraction of the step at which the stage lies that is `rank`-th in time.
    fn node(&self, rank: usize) -> f64 {
        self.step.interpolation().node(self.step.interpolation().in_time()[rank])
    }

    /// The quantity at the stage that is `rank`-th in time.
    fn at_stage(&self, rank: usize, i: usize, function: EventFunction) -> f64 {
        function.values(&self.step.stages()[self.step.interpolation().in_time()[rank]])[i]
    }

    /// The quantity at the fraction `theta` of the step.
    fn value(&mut self, i: usize, function: EventFunction, theta: f64) -> f64 {
        let mode = self.step.start.mode[i];
        if function == EventFunction::Margin && mode.slips() {
            return mode.direction() * self.step.velocity_x(i, theta);
        }
        let contact = self.step.contact(i, theta, self.workspace);
        if function == EventFunction::Normal { contact.normal } else { contact.limit - contact.tangential.abs() }
    }
}

/// The share of the velocity tolerance of stops below which no step ends where a creeping mass becomes faster.
const CREEP_RESOLVED: f64 = 1e-2;

/// By which part of v_c a mass has passed it where a step ends that it creeps in.
const CREEP_PASSED: f64 = 1e-3;
/// How near to half its tolerance a quantity is where an event is located, as a share of the tolerance: any place where
/// the limit has been passed for certain serves, and each evaluation costs.
const NEAR: f64 = 0.1;
/// Accuracy of an event's instant as a fraction of the step: far below the resolution of the tolerances.
const LOCATED: f64 = 1e-12;

/// The vertex of the parabola through three points, place and value, if it is a minimum between the outer ones.
fn vertex(before: (f64, f64), here: (f64, f64), after: (f64, f64)) -> Option<(f64, f64)> {
    let slope = |a: (f64, f64), b: (f64, f64)| (b.1 - a.1) / (b.0 - a.0);
    let (left, right) = (slope(before, here), slope(here, after));
    let bend = (right - left) / (after.0 - before.0);
    let place = 0.5 * (before.0 + here.0 - left / bend);
    let value = before.1 + (place - before.0) * (left + bend * (place - here.0));
    (bend > 0.0 && place > before.0 && place < after.0 && value.is_finite()).then_some((place, value))
}

/// The least value of each mass at the `stages`, less the share `overshoot` of the range of its values there.
fn min_within<'a>(stages: impl Iterator<Item = &'a [f64]>, overshoot: f64) -> [f64; BLOCK] {
    with_widest_vectors(
        #[inline(always)]
        || {
            let (mut least, mut most) = ([f64::MAX; BLOCK], [f64::MIN; BLOCK]);
            for values in stages {
                for ((least, most), &value) in least.iter_mut().zip(&mut most).zip(values) {
                    *least = if value < *least { value } else { *least };
                    *most = if value > *most { value } else { *most };
                }
            }
            least.iter_mut().zip(&most).for_each(|(least, most)| *least -= overshoot * (most - *least));
            least
        },
    )
}

/// Share of an event tolerance by which a limit must be passed at the end of a step for an event to be due.
const PASSED: f64 = 0.05;

/// Whether an event is due at the end of a step: `state`, `rates` and the carrier's position `at` are those there.
pub fn is_due(
    model: &Model,
    state: &State,
    rates: &StageValues,
    at: CarrierPosition,
    tolerance: &EventTolerance,
) -> bool {
    let limits = rates.normal.iter().zip(&rates.margin);
    // Without a branch, so that the loop becomes vector instructions. Those of free masses are beyond no limit.
    let of_contacts = state.mode.iter().zip(limits).fold(false, |due, (mode, (normal, margin))| {
        due | (*normal < -PASSED * tolerance.force) | (*margin < -PASSED * tolerance.margin(*mode))
    });
    let touches = |i: usize| {
        let surface = model.surface_at(model.rest_x[i] + (at.profile_position + state.elongation_x[i]));
        let gap = model.rest_z[i] + (at.w + state.elongation_z[i]) - surface.height;
        gap < -PASSED * tolerance.gap && state.velocity_z[i] < surface.slope * state.velocity_x[i]
    };
    of_contacts || (0..model.masses()).any(|i| state.mode[i] == Mode::Free && touches(i))
}

#[cfg(test)]
mod tests {
    use super::vertex;

    #[test]
    fn a_parabola_has_its_vertex() {
        let at = |x: f64| (x, 3.0 * (x - 0.4) * (x - 0.4) - 0.25);
        let (place, value) = vertex(at(0.1), at(0.3), at(0.9)).unwrap();
        assert!((place - 0.4).abs() < 1e-15 && (value + 0.25).abs() < 1e-15, "{place} {value}");
        assert_eq!(vertex(at(0.5), at(0.6), at(0.9)), None);
        assert_eq!(vertex((0.0, f64::MAX), (0.1, f64::MAX), (0.2, f64::MAX)), None);
    }
}
