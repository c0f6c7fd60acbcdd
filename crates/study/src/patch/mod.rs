//! Contact patches: the motion that one is moved along.

mod motion;

pub use motion::{MotionFile, MotionRow};
