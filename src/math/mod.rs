//! Numerical methods, independent of the model.

mod finite;
mod fourier;
mod memory;
mod monotone;
mod number;
mod quintic;
mod random;
mod relaxation;
mod root;
mod spline;
mod sums;
mod tridiagonal;

pub use finite::not_finite;
pub use fourier::{FourierDirection, fourier, fourier_2d};
pub use memory::{NotEnoughMemory, can_allocate, check_memory};
pub use monotone::{Expansion, cubic, interval_of, monotone_slopes};
pub use number::{Dual, Number};
pub use quintic::{Jet, Quintic};
pub use random::SplitMix64;
pub use relaxation::Relaxation;
pub use root::{bracketed_root, root_between};
pub use spline::{BLOCK, Spline, SplineBounds};
pub use sums::with_widest_vectors;
pub use sums::{add_weighted_sum, dot, dots, square_and_dots, sum, sum_of, sum_of_pairs, sum_of_triples, weighted_sum};
pub use tridiagonal::BlockTridiagonal;
