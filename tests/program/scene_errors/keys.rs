//! Keys that are unknown, missing, or of features still to come.

use asperity::patch::Patch;
use asperity::scene::Scene;

use crate::program::scene_errors::{BASE, assert_refusals, with_line};

#[test]
fn unknown_keys() {
    assert_refusals("unknown keys", &BASE);
}

/// Keys misspelt or in another table, and words misspelt, of scenes and patches.
#[test]
fn what_is_probably_meant_is_said() {
    let said = |line: usize, text: &str| {
        Scene::parse(&with_line(line, text), "a.toml".as_ref()).map(|_| ()).unwrap_err().to_string()
    };
    let meant = [
        (4, "mases = 3", "did you mean layer.mass, layer.masses?"),
        (7, "coulomb = 0.3", "layer.coulomb: unknown"),
        (7, "coulomb = 0.3", "did you mean friction.coulomb?"),
        (21, "relative_tolerence = 1e-6", "did you mean solver.relative_tolerance?"),
        (15, "kind = 'Self-Affine'", "did you mean \"self_affine\"?"),
        (24, "extrapolation = 'liner'", "did you mean \"linear\"?"),
    ];
    for (line, text, expected) in meant {
        assert!(said(line, text).contains(expected), "{text}: {}", said(line, text));
    }
    // Nothing is like it, or too much; a key of another kind of the table is where it belongs.
    for (line, text) in [(7, "colour = 1"), (15, "kind = 'cube'"), (15, "kind = 'flat'\nperiodic = true"), (7, "z = 1")]
    {
        assert!(!said(line, text).contains("did you mean"), "{text}: {}", said(line, text));
    }
    let patch = |text: &str| Patch::parse(text, "p.toml".as_ref()).map(|_| ()).unwrap_err().to_string();
    let refused = patch("name = 'p'\ntable = { path = 't.csv', extrapolaton = 'hold' }\n[patch]\nshape = 'flat'\n");
    assert!(refused.contains("did you mean table.extrapolation?"), "{refused}");
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
