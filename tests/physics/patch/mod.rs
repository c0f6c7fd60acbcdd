//! The contact patch: exact results, given cases, what must hold of random patches, and extreme ones.

mod backing;
mod exact;
mod extreme;
mod full_contact;
mod heat;
mod invariants;
mod reference;
