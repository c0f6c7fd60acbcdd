//! Elements that a step is done for together, in structure of arrays.

/// Elements of a block.
pub(super) const BLOCK: usize = 64;

/// Values of the elements of a block.
pub(super) type Lanes<T> = [T; BLOCK];
