//! Numbers compared with what is expected.

/// Fails where `found` differs from `expected` by more than the part `share` of it, or is NaN.
#[track_caller]
pub fn assert_relative(what: &str, found: f64, expected: f64, share: f64) {
    assert_near(what, found, expected, share * expected.abs());
}

/// Fails where `found` differs from `expected` by more than `allowed`, or is NaN.
#[track_caller]
pub fn assert_near(what: &str, found: f64, expected: f64, allowed: f64) {
    let error = (found - expected).abs();
    assert!(error <= allowed, "{what}: {found:e}, not {expected:e}: off by {error:e}, allowed {allowed:e}");
}
