//! The two forms of a scene, of which it has exactly one: by the constants of its links, or by its material.

use super::SceneError;
use super::allowed::Range;
use super::table::TableReader;

/// How a scene gives its layer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Form {
    /// Mass and link constants.
    Direct,
    /// `[material]`, thickness and width.
    Material,
}

/// The keys of a table that belong to one form alone.
#[derive(Clone, Copy, Debug)]
pub(super) struct FormKeys {
    pub(super) direct: &'static [&'static str],
    pub(super) material: &'static [&'static str],
}

impl Form {
    /// Refuses keys of the other form, then any key that is neither of this one nor `common`.
    pub(super) fn allow(
        self,
        table: &mut TableReader<'_>,
        common: &[&'static str],
        keys: &FormKeys,
    ) -> Result<(), SceneError> {
        let (own, other, why) = match self {
            Self::Direct => (keys.direct, keys.material, "no such key without [material]"),
            Self::Material => (keys.material, keys.direct, "no such key beside [material]"),
        };
        if let Some(entry) = other.iter().find_map(|&key| table.entry(key)) {
            let instead = if own.is_empty() { String::new() } else { format!("; instead: {}", own.join(", ")) };
            return Err(entry.refuse(format_args!("{why}{instead}")));
        }
        table.allow(&[common, own].concat())
    }

    /// The number of a key that a scene of the form `of` must have, and no other has.
    pub(super) fn number(
        self,
        of: Self,
        table: &mut TableReader<'_>,
        key: &'static str,
        range: &Range,
    ) -> Result<Option<f64>, SceneError> {
        if self == of { table.number(key, range).map(Some) } else { Ok(None) }
    }
}
