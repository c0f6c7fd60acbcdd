//! Keys that are unknown, missing, or of features still to come.

use asperity::scene::Scene;

use crate::program::scene_errors::{BASE, assert_refusals};

#[test]
fn unknown_keys() {
    assert_refusals("unknown keys", &BASE);
}

#[test]
fn missing_keys() {
    assert_refusals("missing keys", &BASE);
    let no_tables = Scene::parse("name = 'a'", "a.toml".as_ref()).unwrap_err();
    assert_eq!(no_tables.to_string(), "a.toml:1: layer: missing; expected a table");
    let no_surface = "name = 'a'\nlayer = { masses = 1, spacing = 1, mass = 1 }";
    let no_surface = Scene::parse(no_surface, "a.toml".as_ref()).unwrap_err();
    assert_eq!(no_surface.to_string(), "a.toml:1: surface: missing; expected a table");
}
