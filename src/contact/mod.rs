//! Contact: when modes change (`events`, `gap`), and what follows (`rules`).

mod events;
mod gap;
mod rules;

pub use events::{EventTolerance, first_event, is_due};
pub use gap::first_touch;
pub use rules::{CarrierPlace, decide_modes, free_unloaded, impacts_due, place_layer, stop_reversed};
