//! Values of the wrong type or out of range.

use asperity::scene::Scene;

use crate::program::scene_errors::{BASE, assert_refusals};

#[test]
fn wrong_types() {
    assert_refusals("wrong types", &BASE);
    let excitation =
        "name = 'a'\nexcitation = 1\nlayer = { masses = 1, spacing = 1, mass = 1 }\nsurface = { kind = 'flat' }";
    let excitation = Scene::parse(excitation, "a.toml".as_ref()).unwrap_err();
    assert_eq!(excitation.to_string(), "a.toml:2: excitation = 1: expected an array of tables");
}

#[test]
fn values_out_of_range() {
    assert_refusals("out of range", &BASE);
}
