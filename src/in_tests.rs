//! What the unit tests compare numbers by.

/// Fails where `found` differs from `expected` by more than the part `share` of it, or is NaN.
#[track_caller]
pub(crate) fn assert_relative(found: f64, expected: f64, share: f64) {
    assert_within(found, expected, share * expected.abs());
}

/// Fails where `found` differs from `expected` by more than `allowed`, or is NaN.
#[track_caller]
pub(crate) fn assert_within(found: f64, expected: f64, allowed: f64) {
    assert!((found - expected).abs() <= allowed, "found {found:e}, expected {expected:e} within {allowed:e}");
}
