//! The vector instructions of the processor at hand.

/// Does `work` with the widest vectors of the processor (SSE2, AVX2, AVX-512); numbers are the same with all.
///
/// Only what is inlined into `work` takes part: it and the functions that it calls are to be `#[inline(always)]`.
#[inline]
pub fn with_widest_vectors<R>(work: impl FnOnce() -> R) -> R {
    pulp::Arch::new().dispatch(work)
}
