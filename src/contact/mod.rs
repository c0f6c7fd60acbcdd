//! Contact: when modes change (`events`, `gap`), what follows (`rules`), both at once at the end of a step (`step_end`,
//! `settling`), and how long a step may be where a contact is unstable (`growth`).

mod events;
mod gap;
mod laws;
mod settling;
mod stability;
mod step_end;

pub use events::{EventTolerance, first_event, is_due};
pub use gap::first_touch;
pub use laws::{CarrierPosition, decide_modes, free_unloaded, impacts_due, place_layer, stop_reversed};
pub use settling::{CorrectionEnergies, End, FixedModeStep};
pub use stability::{longest_unstable, longest_weakening};
pub use step_end::EndCorrection;
