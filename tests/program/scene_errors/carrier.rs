//! `[carrier]`, and phases with loads: each refused with its key and why.

use asperity::scene::Scene;

/// A layer on a plane, then what a case adds.
const BASE: &str = "name = 'base'
layer = { masses = 2, spacing = 1e-4, mass = 1e-7, vertical = { stiffness = 1e3 } }
surface = { kind = 'flat' }
";
/// The same of a material.
const MATERIAL: &str = "name = 'base'
layer = { masses = 2, spacing = 1e-4, thickness = 1e-3, width = 1e-2 }
material = { density = 1e3, poisson_ratio = 0.49, equilibrium_modulus = 1e6, prony = [], WLF }
surface = { kind = 'flat' }
";
const WLF: &str = "wlf = { c1 = 7, c2 = 119, reference_temperature = 293, temperature = 293 }";

fn refusal(base: &str, text: &str) -> String {
    Scene::parse(&format!("{base}{text}"), "scene.toml".as_ref()).map(|_| ()).unwrap_err().to_string()
}

fn check(base: &str, cases: &[(&str, &str)]) {
    let lines = base.lines().count();
    for (text, expected) in cases {
        let (line, message) = expected.split_once(' ').unwrap();
        let line: usize = line.parse().unwrap();
        assert_eq!(refusal(base, text), format!("scene.toml:{}: {message}", lines + line), "{text}");
    }
}

const POSITIVE: &str = "a number from 1e-30 to 1e30";
const NOT_NEGATIVE: &str = "0 or a number from 1e-30 to 1e30";
const UNMOVED: &str = "the displacement is prescribed";

#[test]
fn bodies() {
    check(
        BASE,
        &[
            ("[carrier.z]\nmass = 0", &format!("2 carrier.z.mass = 0: expected {POSITIVE}")),
            ("[carrier.z]\nload = 1", &format!("1 carrier.z.mass: missing; expected {POSITIVE}")),
            ("[carrier.x]\nmass = 1\nstiffness = -1", &format!("3 carrier.x.stiffness = -1: expected {NOT_NEGATIVE}")),
            ("[carrier.x]\nmass = 1\ndamping = -2.0", &format!("3 carrier.x.damping = -2.0: expected {NOT_NEGATIVE}")),
            (
                "[carrier.z]\nmass = 1\npull = 1",
                "3 carrier.z.pull: unknown; allowed: mass, stiffness, damping, load, start, start_rate, initial; did you mean \
                 carrier.x.pull, excitation[1].pull?",
            ),
            (
                "[carrier.x]\nmass = 1\ninitial = 'equilibrium'",
                "3 carrier.x.initial: unknown; allowed: mass, stiffness, damping, pull, start, start_rate; did you mean \
                 layer.initial, carrier.z.initial?",
            ),
            ("[carrier.y]\nmass = 1", "1 carrier.y: unknown; allowed: x, z"),
            (
                "[carrier.z]\nmass = 1\nstart = 1\ninitial = 'equilibrium'",
                "3 carrier.z.start = 1: expected no such key beside initial",
            ),
            (
                "[carrier.z]\nmass = 1\ninitial = 'rest'",
                "3 carrier.z.initial = 'rest': expected one of \"start\", \"equilibrium\"",
            ),
            (
                "[fmu]\noutputs = ['carrier']",
                "2 fmu.outputs = ['carrier']: expected no group \"carrier\" without [carrier.x] or [carrier.z]: the carrier is no body",
            ),
            (
                "[carrier.z]\nmass = 1\nload = -1\ninitial = 'equilibrium'",
                "1 carrier.z.initial = \"equilibrium\" under a load of -1.0 N: expected a load of 0 or more on vertical springs, or \
                 carrier.z.stiffness > 0: otherwise nothing is at rest",
            ),
        ],
    );
}

#[test]
fn phases() {
    check(
        BASE,
        &[
            (
                "[[excitation]]\nduration = 1\nload = 1",
                &format!("3 excitation[1].load = 1: expected no such key without [carrier.z]: {UNMOVED}"),
            ),
            (
                "[[excitation]]\nduration = 1\npull_rate = 1",
                &format!("3 excitation[1].pull_rate = 1: expected no such key without [carrier.x]: {UNMOVED}"),
            ),
            (
                "carrier.z = { mass = 1 }\n[[excitation]]\nduration = 1\nw_rate = 1",
                "4 excitation[1].w_rate = 1: expected no such key with [carrier.z] without stiffness and damping: it has no drive",
            ),
            (
                "carrier.z = { mass = 1 }\n[[excitation]]\nduration = 1\npressure = 1",
                "4 excitation[1].pressure = 1: expected no such key without [material]; instead: until_force",
            ),
            (
                "carrier.z = { mass = 1 }\n[[excitation]]\nduration = 1\nload_sine = { amplitude = 1 }",
                &format!("4 excitation[1].load_sine.frequency: missing; expected {NOT_NEGATIVE}"),
            ),
        ],
    );
}

#[test]
fn pressures_and_temperatures() {
    let material = MATERIAL.replace("WLF", WLF);
    check(
        &material,
        &[
            (
                "carrier.z = { mass = 1 }\n[[excitation]]\nduration = 1\nload = 1\npressure_rate = 1",
                "4 excitation[1].load = 1: expected no such key beside pressure, pressure_rate and pressure_sine",
            ),
            (
                "[[excitation]]\nduration = 1\ntemperature = 300",
                "3 excitation[1].temperature = 300: expected no such key without temperature = true in [input]",
            ),
            (
                "[input]\ntemperature = true\n[solver]\nreduce = 0.01",
                "2 input.temperature = true: expected false beside solver.reduce > 0, which leaves elements out for one temperature",
            ),
        ],
    );
    let cold = refusal(&material, "input.temperature = true\n[[excitation]]\nduration = 1\ntemperature = 150");
    assert!(cold.starts_with("scene.toml:8: excitation[1].temperature = 150.0: expected more than"), "{cold}");
    let without = MATERIAL.replace(", WLF", "");
    let refused = refusal(&without, "input.temperature = true");
    assert!(
        refused.ends_with("expected false without [material.wlf], which says what a temperature does"),
        "{refused}"
    );
}
