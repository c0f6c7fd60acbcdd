//! The keys of what is not known of a scene.

use super::{Allowed, Key, PATH, key, number, table, word};
use crate::scene::Unit;
use crate::scene::uncertainty::Each;
use crate::scene::values::POSITIVE;

/// Beside any number of the scene by its path, which is a table of [`SPREAD`].
pub(super) const UNCERTAINTY: &[Key] =
    &[key("covariance", Allowed::Text(PATH), "File of numbers that were fitted together, as calibrate writes it")];

/// How far something may be off.
pub(in crate::scene) const SPREAD: Key = table("", SPREADS);

const SPREADS: &[Key] = &[
    number("relative", POSITIVE, Unit::One, "Log-normal: standard deviation of the logarithm"),
    number("factor", POSITIVE.down_to(1.0), Unit::One, "Log-uniform from 1/factor to factor times"),
    key(
        "absolute",
        Allowed::Text("a number above 0, in SI units or as a text with its unit"),
        "Normal: standard deviation, in the unit of the number",
    ),
    word::<Each>("each", "Of surface.spectrum: what varies by itself").follows("the whole spectrum by one factor"),
];
