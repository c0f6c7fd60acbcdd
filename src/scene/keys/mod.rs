//! The keys of a scene file and of a patch file: one table of their names, of what they may hold, of what they mean and
//! of where their values are in a scene. The reader checks files against it and fills scenes by it; parameters, the
//! pages of reference and messages are made from it. A new key of a number or a word is a row.

mod definition;
mod field;
mod list;
mod patch;
mod scene_file;
mod seal;
mod surface;

pub use definition::Absent;
pub(super) use definition::{Allowed, Form, Key, Kinds, NONE, PATH, TABLE};
pub(super) use field::{At, Field};
pub use list::{KeyEntry, patch_keys, scene_keys, seal_keys, similar_keys};
pub(super) use list::{KeyRow, elsewhere, fields, find, range_of};
pub(super) use patch::{PATCH_ROOT, ShapeKind};
pub(super) use scene_file::ROOT;
pub(super) use seal::SEAL_ROOT;
pub(super) use surface::SurfaceKind;
