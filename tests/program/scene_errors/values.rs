//! Values of the wrong type or out of range.

use asperity::scene::Scene;

use crate::scene_errors::{NAME, PATH, assert_refusals};

#[test]
fn wrong_types() {
    let outputs =
        r#""forces", "carrier", "dissipation", "friction", "contact", "energy", "tangent", "solver", "elements""#;
    assert_refusals(
        "types",
        &[
            (1, "name = 1", 1, &format!("name = 1: expected {NAME}")),
            (
                2,
                "description = true",
                2,
                "description = true: expected a text without control characters but line breaks and tabs",
            ),
            (4, "masses = 3.0", 4, "layer.masses = 3.0: expected a whole number from 1 to 10000000"),
            (5, "spacing = \"small\"", 5, "layer.spacing = \"small\": expected a number from 1e-30 to 1e30"),
            (6, "mass = [1.0]", 6, "layer.mass = [1.0]: expected a number from 1e-30 to 1e30"),
            (6, "mass = 2020-01-01", 6, "layer.mass = 2020-01-01: expected a number from 1e-30 to 1e30"),
            (7, "initial = 1", 7, r#"layer.initial = 1: expected one of "relaxed", "undeformed""#),
            (7, "horizontal = 3", 7, "layer.horizontal = 3: expected a table"),
            (12, "maxwell = 3", 12, "layer.vertical.maxwell = 3: expected an array of tables"),
            (12, "maxwell = [3]", 12, "layer.vertical.maxwell[1] = 3: expected a table"),
            (
                15,
                "kind = 'points'\nx = [0, 1]\nz = [0, 1]\nperiodic = 'no'",
                18,
                "surface.periodic = 'no': expected true or false",
            ),
            (
                15,
                "kind = 'points'\nx = 0\nz = [0, 1]",
                16,
                "surface.x = 0: expected an array, each a number from -1e30 to 1e30",
            ),
            (
                15,
                "kind = 'points'\nx = [0,\n1]\nz = [\n0,\n'high']",
                20,
                "surface.z[2] = 'high': expected a number from -1e30 to 1e30",
            ),
            (15, "kind = 'file'\npath = 1", 16, &format!("surface.path = 1: expected {PATH}")),
            (
                27,
                "outputs = 'forces'",
                27,
                &format!("fmu.outputs = 'forces': expected an array, each one of {outputs}"),
            ),
            (27, "outputs = [1]", 27, &format!("fmu.outputs[1] = 1: expected one of {outputs}")),
            (31, "u_sine = 1.0", 31, "excitation[1].u_sine = 1.0: expected a table"),
        ],
    );
    let excitation =
        "name = 'a'\nexcitation = 1\nlayer = { masses = 1, spacing = 1, mass = 1 }\nsurface = { kind = 'flat' }";
    let excitation = Scene::parse(excitation, "a.toml".as_ref()).unwrap_err();
    assert_eq!(excitation.to_string(), "a.toml:2: excitation = 1: expected an array of tables");
}

#[test]
fn values_out_of_range() {
    let outputs =
        r#""forces", "carrier", "dissipation", "friction", "contact", "energy", "tangent", "solver", "elements""#;
    let kinds = r#"one of "flat", "sinusoid", "self_affine", "points", "file""#;
    let steps = "a whole number from 1 to 2147483647";
    // Too long for the name of a file in the archive.
    let long = format!("name = '{}'", "a".repeat(201));
    assert_refusals(
        "range",
        &[
            (1, "name = ' '", 1, &format!("name = ' ': expected {NAME}")),
            (1, &long, 1, &format!("name = '{}...: expected {NAME}", "a".repeat(59))),
            (4, "masses = 0", 4, "layer.masses = 0: expected a whole number from 1 to 10000000"),
            (4, "masses = 10000001", 4, "layer.masses = 10000001: expected a whole number from 1 to 10000000"),
            (
                4,
                "masses = 99999999999999999999",
                4,
                "layer.masses = 99999999999999999999: expected a whole number from 1 to 10000000",
            ),
            (5, "spacing = 0.0", 5, "layer.spacing = 0.0: expected a number from 1e-30 to 1e30"),
            (6, "mass = 0", 6, "layer.mass = 0: expected a number from 1e-30 to 1e30"),
            (6, "mass = -1.0", 6, "layer.mass = -1.0: expected a number from 1e-30 to 1e30"),
            (6, "mass = 1e-31", 6, "layer.mass = 1e-31: expected a number from 1e-30 to 1e30"),
            (6, "mass = 1e31", 6, "layer.mass = 1e31: expected a number from 1e-30 to 1e30"),
            (6, "mass = nan", 6, "layer.mass = nan: expected a number from 1e-30 to 1e30"),
            (6, "mass = inf", 6, "layer.mass = inf: expected a number from 1e-30 to 1e30"),
            (6, "mass = 1e999", 6, "layer.mass = 1e999: expected a number from 1e-30 to 1e30"),
            (7, "clearance = -inf", 7, "layer.clearance = -inf: expected a number from -1e30 to 1e30"),
            (7, "origin = nan", 7, "layer.origin = nan: expected a number from -1e30 to 1e30"),
            (7, "initial = 'cold'", 7, r#"layer.initial = 'cold': expected one of "relaxed", "undeformed""#),
            (
                10,
                "stiffness = 1e-300",
                10,
                "layer.vertical.stiffness = 1e-300: expected 0 or a number from 1e-30 to 1e30",
            ),
            (
                12,
                "maxwell = [{ stiffness = 1, relaxation_time = 1e-300 }]",
                12,
                "layer.vertical.maxwell[1].relaxation_time = 1e-300: expected a number from 1e-30 to 1e30",
            ),
            (10, "stiffness = -1", 10, "layer.vertical.stiffness = -1: expected 0 or a number from 1e-30 to 1e30"),
            (11, "damping = -0.1", 11, "layer.vertical.damping = -0.1: expected 0 or a number from 1e-30 to 1e30"),
            (
                12,
                "maxwell = [{ stiffness = -1, relaxation_time = 1 }]",
                12,
                "layer.vertical.maxwell[1].stiffness = -1: expected 0 or a number from 1e-30 to 1e30",
            ),
            (
                12,
                "maxwell = [{ stiffness = 1, relaxation_time = 0 }]",
                12,
                "layer.vertical.maxwell[1].relaxation_time = 0: expected a number from 1e-30 to 1e30",
            ),
            (15, "kind = 'rough'", 15, &format!("surface.kind = 'rough': expected {kinds}")),
            (
                15,
                "kind = 'sinusoid'\namplitude = nan\nwavelength = 1",
                16,
                "surface.amplitude = nan: expected a number from -1e30 to 1e30",
            ),
            (
                15,
                "kind = 'sinusoid'\namplitude = 1\nwavelength = 0",
                17,
                "surface.wavelength = 0: expected a number from 1e-30 to 1e30",
            ),
            (
                15,
                "kind = 'sinusoid'\namplitude = 1\nwavelength = 1\npoints_per_wavelength = 3",
                18,
                "surface.points_per_wavelength = 3: expected a whole number from 4 to 10000000",
            ),
            (18, "coulomb = -0.3", 18, "friction.coulomb = -0.3: expected 0 or a number from 1e-30 to 1e30"),
            (18, "shear_force = -1", 18, "friction.shear_force = -1: expected 0 or a number from 1e-30 to 1e30"),
            (18, "rate_shear = 1", 18, "friction.rate_shear = 1: expected a table"),
            (
                18,
                "rate_shear = { force = -1, reference_speed = 1, sharpness = 1 }",
                18,
                "friction.rate_shear.force = -1: expected 0 or a number from 1e-30 to 1e30",
            ),
            (
                18,
                "rate_shear = { force = 1, reference_speed = 0, sharpness = 1 }",
                18,
                "friction.rate_shear.reference_speed = 0: expected a number from 1e-30 to 1e30",
            ),
            (
                18,
                "rate_shear = { force = 1, reference_speed = 1, sharpness = -0.1 }",
                18,
                "friction.rate_shear.sharpness = -0.1: expected 0 or a number from 1e-30 to 1e30",
            ),
            (
                18,
                "rate_shear = { force = 1, reference_speed = 1, sharpness = 1, creep_speed = 'slow' }",
                18,
                "friction.rate_shear.creep_speed = 'slow': expected a number from 1e-30 to 1e30",
            ),
            (21, "relative_tolerance = 0", 21, "solver.relative_tolerance = 0: expected a number from 1e-30 to 0.1"),
            (
                21,
                "relative_tolerance = 0.2",
                21,
                "solver.relative_tolerance = 0.2: expected a number from 1e-30 to 0.1",
            ),
            (21, "absolute_tolerance = 0", 21, "solver.absolute_tolerance = 0: expected a number from 1e-30 to 1e30"),
            (21, "reduce = 0.2", 21, "solver.reduce = 0.2: expected 0 or a number from 1e-30 to 0.1"),
            (21, "max_steps = 0", 21, &format!("solver.max_steps = 0: expected {steps}")),
            (21, "max_steps = 2147483648", 21, &format!("solver.max_steps = 2147483648: expected {steps}")),
            (21, "method = 'fast'", 21, r#"solver.method = 'fast': expected one of "event", "step", "auto""#),
            (24, "extrapolation = 'no'", 24, r#"input.extrapolation = 'no': expected one of "linear", "hold""#),
            (27, "outputs = ['force']", 27, &format!("fmu.outputs[1] = 'force': expected one of {outputs}")),
            (27, "outputs = ['forces', 'forces']", 27, "fmu.outputs[2] = 'forces': expected each group once"),
            (30, "duration = 0", 30, "excitation[1].duration = 0: expected a number from 1e-30 to 1e30"),
            (31, "u_rate = inf", 31, "excitation[1].u_rate = inf: expected a number from -1e30 to 1e30"),
            (31, "until_force = nan", 31, "excitation[1].until_force = nan: expected a number from -1e30 to 1e30"),
            (
                31,
                "w_sine = { amplitude = 1, frequency = -1 }",
                31,
                "excitation[1].w_sine.frequency = -1: expected 0 or a number from 1e-30 to 1e30",
            ),
        ],
    );
}
