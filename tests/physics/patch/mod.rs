//! The contact patch: exact results, given cases.

mod exact;
mod reference;
