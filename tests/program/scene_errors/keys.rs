//! Keys that are unknown, missing, or of features still to come.

use asperity::scene::Scene;

use crate::scene_errors::{PATH, assert_refusals};

const FILE_KEYS: &str = "surface.x: unknown; allowed: kind, path, periodic, unit, x_unit, z_unit, missing, tilt, \
                         third_column, columns, spacing, line";

#[test]
fn unknown_keys() {
    let layer =
        "masses, spacing, origin, clearance, initial, roughness, mass, vertical, horizontal, lateral_x, lateral_z";
    let root = "name, description, layer, material, surface, carrier, friction, solver, input, fmu, excitation";
    let phase =
        "duration, u_rate, w_rate, u_sine, w_sine, load, load_rate, load_sine, pull, pull_rate, pull_sine, until_force";
    assert_refusals(
        "unknown",
        &[
            (2, "nmae = 1", 2, &format!("nmae: unknown; allowed: {root}")),
            (6, "mas = 1.0e-7", 6, &format!("layer.mas: unknown; allowed: {layer}")),
            (9, "[layer.lateral_y]", 9, &format!("layer.lateral_y: unknown; allowed: {layer}")),
            (10, "stifness = 1", 10, "layer.vertical.stifness: unknown; allowed: stiffness, damping, maxwell"),
            (
                12,
                "maxwell = [\n{ stiffness = 1, relaxation_time = 1 },\n{ stiffness = 1, tau = 1 }]",
                14,
                "layer.vertical.maxwell[2].tau: unknown; allowed: stiffness, relaxation_time",
            ),
            (15, "kind = 'flat'\nperiodic = true", 16, "surface.periodic: unknown; allowed: kind"),
            (
                15,
                "kind = 'sinusoid'\nperiodic = true",
                16,
                "surface.periodic: unknown; allowed: kind, amplitude, wavelength, points_per_wavelength",
            ),
            (15, "kind = 'file'\nx = []", 16, FILE_KEYS),
            (15, "kind = 'points'\npath = 'a'", 16, "surface.path: unknown; allowed: kind, x, z, periodic"),
            (18, "mu = 0.3", 18, "friction.mu: unknown; allowed: coulomb, rate_shear, shear_force"),
            (
                18,
                "rate_shear = { force = 1, reference_speed = 1, sharpness = 1, speed = 1 }",
                18,
                "friction.rate_shear.speed: unknown; allowed: reference_speed, sharpness, creep_speed, force",
            ),
            (
                21,
                "tolerance = 1",
                21,
                "solver.tolerance: unknown; allowed: method, relative_tolerance, absolute_tolerance, max_steps, reduce",
            ),
            (24, "hold = true", 24, "input.hold: unknown; allowed: extrapolation"),
            (27, "groups = []", 27, "fmu.groups: unknown; allowed: outputs"),
            (31, "v_rate = 1.0", 31, &format!("excitation[1].v_rate: unknown; allowed: {phase}")),
            (
                31,
                "w_sine = { amplitude = 1, frequency = 1, phase = 0 }",
                31,
                "excitation[1].w_sine.phase: unknown; allowed: amplitude, frequency",
            ),
        ],
    );
}

#[test]
fn missing_keys() {
    let kinds = r#"one of "flat", "sinusoid", "self_affine", "points", "file""#;
    assert_refusals(
        "missing",
        &[
            (1, "", 1, "name: missing; expected a text"),
            (4, "", 3, "layer.masses: missing; expected a whole number from 1 to 10000000"),
            (5, "", 3, "layer.spacing: missing; expected a number from 1e-30 to 1e30"),
            (6, "", 3, "layer.mass: missing; expected a number from 1e-30 to 1e30"),
            (
                12,
                "maxwell = [{ relaxation_time = 1.0 }]",
                12,
                "layer.vertical.maxwell[1].stiffness: missing; expected 0 or a number from 1e-30 to 1e30",
            ),
            (
                12,
                "maxwell = [{ stiffness = 1.0 }]",
                12,
                "layer.vertical.maxwell[1].relaxation_time: missing; expected a number from 1e-30 to 1e30",
            ),
            (15, "", 14, &format!("surface.kind: missing; expected {kinds}")),
            (
                15,
                "kind = 'sinusoid'\nwavelength = 1",
                14,
                "surface.amplitude: missing; expected a number from -1e30 to 1e30",
            ),
            (
                15,
                "kind = 'sinusoid'\namplitude = 1",
                14,
                "surface.wavelength: missing; expected a number from 1e-30 to 1e30",
            ),
            (
                15,
                "kind = 'points'\nz = [1, 2]",
                14,
                "surface.x: missing; expected an array, each a number from -1e30 to 1e30",
            ),
            (
                15,
                "kind = 'points'\nx = [1, 2]",
                14,
                "surface.z: missing; expected an array, each a number from -1e30 to 1e30",
            ),
            (15, "kind = 'file'", 14, &format!("surface.path: missing; expected {PATH}")),
            (
                18,
                "rate_shear = { reference_speed = 1, sharpness = 1 }",
                18,
                "friction.rate_shear.force: missing; expected 0 or a number from 1e-30 to 1e30",
            ),
            (
                18,
                "rate_shear = { force = 1, sharpness = 1 }",
                18,
                "friction.rate_shear.reference_speed: missing; expected a number from 1e-30 to 1e30",
            ),
            (
                18,
                "rate_shear = { force = 1, reference_speed = 1 }",
                18,
                "friction.rate_shear.sharpness: missing; expected 0 or a number from 1e-30 to 1e30",
            ),
            (30, "", 29, "excitation[1].duration: missing; expected a number from 1e-30 to 1e30"),
            (
                31,
                "u_sine = { frequency = 1 }",
                31,
                "excitation[1].u_sine.amplitude: missing; expected a number from -1e30 to 1e30",
            ),
            (
                31,
                "u_sine = { amplitude = 1 }",
                31,
                "excitation[1].u_sine.frequency: missing; expected 0 or a number from 1e-30 to 1e30",
            ),
        ],
    );
    let no_tables = Scene::parse("name = 'a'", "a.toml".as_ref()).unwrap_err();
    assert_eq!(no_tables.to_string(), "a.toml:1: layer: missing; expected a table");
    let no_surface = "name = 'a'\nlayer = { masses = 1, spacing = 1, mass = 1 }";
    let no_surface = Scene::parse(no_surface, "a.toml".as_ref()).unwrap_err();
    assert_eq!(no_surface.to_string(), "a.toml:1: surface: missing; expected a table");
}
