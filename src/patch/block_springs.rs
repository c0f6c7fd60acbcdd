//! The springs of a block's elements, side by side: how they follow a jump of their law, and a segment of a motion.

use super::block_contacts::BlockContacts;
use super::face::{BLOCK, Lanes, lanes_of};
use super::motion::half_turn;
use crate::element::{Segment, advance, apply_jump};
use crate::math::Number;

/// The springs of a block's elements.
#[derive(Clone, Copy, Debug)]
pub(super) struct BlockSprings<T> {
    /// G, their forces on the ground, N.
    pub(super) force: [Lanes<T>; 2],
    /// K, their stiffnesses, N/m.
    pub(super) stiffness: Lanes<T>,
    /// 1 for those that slip, else 0.
    pub(super) slips: Lanes<f64>,
    /// Energy lost in the step by slip, J.
    pub(super) slip: Lanes<f64>,
    /// Energy lost in the step with contacts that were released, J.
    pub(super) release: Lanes<f64>,
    /// Energy lost in the step by dampers, J.
    pub(super) damper: Lanes<f64>,
}

impl<T: Number> BlockSprings<T> {
    /// Relaxed springs without stiffness, that have lost nothing.
    pub(super) fn none() -> Self {
        let zero = T::constant(0.0);
        Self {
            force: [[zero; BLOCK]; 2],
            stiffness: [zero; BLOCK],
            slips: [0.0; BLOCK],
            slip: [0.0; BLOCK],
            release: [0.0; BLOCK],
            damper: [0.0; BLOCK],
        }
    }
}

/// Lets all springs of a block follow a jump of their law to that of `contacts`.
#[inline(always)]
pub(super) fn apply_jumps<T: Number>(springs: &mut BlockSprings<T>, contacts: &BlockContacts<T>) {
    let BlockSprings { force, stiffness, release, .. } = springs;
    for i in 0..lanes_of::<T>(contacts.count) {
        let (jumped, lost) = apply_jump([force[0][i], force[1][i]], stiffness[i], &contacts.law(i));
        (force[0][i], force[1][i]) = (jumped[0], jumped[1]);
        release[i] += lost;
    }
}

/// Takes all springs of a block from `begin` to `end` in one segment each; the losses of those that need segments of
/// their own are left out, of slip (J) they are written to `part_slip`.
#[inline(always)]
pub(super) fn advance_all<T: Number>(
    springs: &mut BlockSprings<T>,
    part_slip: &mut Lanes<T>,
    (begin, end): (&BlockContacts<T>, &BlockContacts<T>),
    displacement: &[Lanes<T>; 2],
    in_segments: &Lanes<bool>,
) {
    let BlockSprings { force, slips, release, .. } = springs;
    for i in 0..lanes_of::<T>(end.count) {
        let (before, after) = (begin.velocity_of(i), end.velocity_of(i));
        let segment = Segment {
            begin: begin.law(i),
            end: end.law(i),
            displacement: [displacement[0][i], displacement[1][i]],
            half_turn: half_turn(before, after),
        };
        let advanced = advance([force[0][i], force[1][i]], &segment);
        // A factor in place of a branch, so that the loop runs in vectors.
        let kept = if in_segments[i] { 0.0 } else { 1.0 };
        (force[0][i], force[1][i]) = (advanced.force[0], advanced.force[1]);
        slips[i] = if advanced.slips { 1.0 } else { 0.0 };
        part_slip[i] = advanced.slip.times(kept);
        release[i] += kept * advanced.release;
    }
}
