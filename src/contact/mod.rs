//! Contact: the rules of mode changes and the impact (`laws`); when modes change within a step (`events`, and `gap` for
//! the touch of a free mass); the end-of-step correction of the time-stepping driver (`correction`, and
//! `touch_correction` for a single mass); the longest step
//! where a contact is unstable (`stability`).

mod correction;
mod events;
mod gap;
mod laws;
mod stability;
mod touch_correction;

pub use correction::EndCorrection;
pub use events::{EventTolerance, first_event, is_due, mode_changes};
pub use gap::first_touch;
pub use laws::{decide_modes, free_unloaded, impacts_due, place_layer, stop_reversed};
pub use stability::{longest_unstable, longest_weakening};
pub use touch_correction::{CorrectionEnergies, FixedModeStep};
