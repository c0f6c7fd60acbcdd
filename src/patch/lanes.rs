//! Elements that a step is done for together, in structure of arrays.

/// Elements of a block.
pub(super) const BLOCK: usize = 64;

/// Values of the elements of a block.
pub(super) type Lanes<T> = [T; BLOCK];

/// The lanes that `count` elements take: up to whole vectors, which hold eight numbers at most.
#[inline(always)]
pub(super) fn lanes_of(count: usize) -> usize {
    count.next_multiple_of(8).min(BLOCK)
}
