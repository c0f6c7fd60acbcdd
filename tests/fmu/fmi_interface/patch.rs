//! A contact patch through the same interface as a layer.

use std::fs;

use asperity::patch::{COORDINATES, Patch, PatchMotion, PatchRun, PatchStart, Pose};
use asperity_fmi::bindings::fmi2Status;

use crate::common::{assert_names, root};
use crate::fmu::fmi_interface::lifecycle::try_all;
use crate::fmu::fmi_interface::master::{DISCARD, ERROR, Fmu, OK};

const WHEEL: &str = r#"
name = "wheel"
[table]
path = "block.table.csv"
[patch]
shape = "cylinder"
radius = 0.3
length = 0.0144
width = 0.01
nx = 6
ny = 2
transport = true
[fmu]
outputs = ["forces", "dissipation", "contact", "friction", "energy", "tangent", "elements"]
"#;

/// Pressed, slipping ahead and to the side, rolling.
const POSE: [f64; 6] = [0.0, 0.0, 0.29999, 1e-3, 2e-3, 0.1];
const RATES: [f64; 6] = [0.12, 0.02, -2e-4, 0.01, -0.02, 0.3];
const SPEED: f64 = 0.1;
const H: f64 = 1e-3;

fn fmu(text: &str) -> Fmu {
    Fmu::of_patch(text, &root().join("tests/reference/patch/block.table.csv"))
}

fn give(fmu: &Fmu, pose: [f64; 6], rates: [f64; 6]) {
    for (i, name) in COORDINATES.into_iter().enumerate() {
        assert_eq!((fmu.set_real(name, pose[i]), fmu.set_rate(name, rates[i])), (OK, OK));
    }
    assert_eq!(fmu.set_real("transport.speed", SPEED), OK);
    assert_eq!(fmu.set_rate("transport.speed", 0.0), OK);
}

fn pose_after(steps: u32) -> [f64; 6] {
    std::array::from_fn(|i| POSE[i] + RATES[i] * H * f64::from(steps))
}

/// The wheel, warmed by slip.
fn warm_wheel() -> String {
    let heat = "heat = { conductivity = 0.25, capacity = 1700.0, density = 1100.0, share = 0.3 }";
    WHEEL.replace("transport = true", &format!("transport = true\n{heat}"))
}

/// An instance that has done some steps.
fn rolling(steps: u32) -> Fmu {
    rolling_of(WHEEL, steps)
}

fn rolling_of(text: &str, steps: u32) -> Fmu {
    let fmu = fmu(text);
    assert_eq!((fmu.setup(0.0), fmu.enter()), (OK, OK));
    give(&fmu, POSE, RATES);
    assert_eq!(fmu.exit(), OK);
    for step in 0..steps {
        give(&fmu, pose_after(step), RATES);
        assert_eq!(fmu.step(H * f64::from(step), H), OK);
    }
    fmu
}

/// Turns so far in a step that it is discarded.
fn failed() -> Fmu {
    let fmu = rolling(0);
    assert_eq!((fmu.set_rate("roll", 1e9), fmu.step(0.0, H)), (OK, DISCARD));
    fmu
}

fn in_error() -> Fmu {
    let fmu = rolling(1);
    assert_eq!((fmu.set_real("z", f64::NAN), fmu.step(H, H)), (OK, ERROR));
    fmu
}

#[test]
fn every_function_in_every_state() {
    try_all([
        ('I', || fmu(WHEEL)),
        ('M', || {
            let fmu = fmu(WHEEL);
            assert_eq!((fmu.setup(0.0), fmu.enter()), (OK, OK));
            fmu
        }),
        ('C', || rolling(0)),
        ('F', failed),
        ('T', || {
            let fmu = rolling(1);
            assert_eq!(fmu.terminate(), OK);
            fmu
        }),
        ('E', in_error),
    ]);
}

#[test]
fn its_variables_stand_in_their_order() {
    let names: Vec<String> = fmu(WHEEL).variables.entries().map(|(_, entry)| entry.name.clone()).collect();
    let start =
        ["x", "y", "z", "roll", "pitch", "yaw", "transport.speed", "temperature", "force.x", "force.y", "force.z"];
    assert_eq!(names[..11], start);
    for (index, name) in [
        (14, "transport.force"),
        (15, "P_diss"),
        (19, "contact.count"),
        (25, "friction.coefficient"),
        (27, "energy.elastic"),
        (28, "tangent.force.x.x"),
        (63, "tangent.moment.z.yaw"),
        (64, "element[1,1].pressure"),
        (68, "element[1,2].pressure"),
    ] {
        assert_eq!(names[index], name);
    }
    assert_eq!(names[names.len() - 4..], ["input.extrapolation", "input.interval", "solver.refine", "patch.damping"]);
}

/// The library's own run, to rounding of the poses that the master gives.
#[test]
fn its_results_are_those_of_the_library() {
    let folder = root().join("tests/reference/patch");
    let patch = Patch::parse(WHEEL, &folder.join("wheel-of-a-test.toml")).unwrap();
    let temperature = patch.temperature();
    let start =
        PatchStart { time: 0.0, pose: Pose::from_coordinates(POSE), rates: RATES, transport_speed: SPEED, temperature };
    let mut run = PatchRun::new(&patch, &start).unwrap();
    let motion = PatchMotion { duration: H, rates: RATES, transport_speed: SPEED, temperature };
    (0..20).for_each(|_| run.advance(&motion).unwrap());
    let variables = patch.variables();
    let mut values = vec![0.0; variables.len()];
    run.evaluate(&variables, &mut values);
    let fmu = rolling(20);
    for (variable, value) in variables.iter().zip(values).filter(|(variable, _)| variable.name.starts_with("force.")) {
        let found = fmu.real(&variable.name);
        assert!((found - value).abs() <= 1e-8 * value.abs().max(1e-3), "{}: {found} {value}", variable.name);
    }
    assert!(fmu.real("force.x") < -0.1 && fmu.real("E_diss") > 0.0);
}

/// The first derivative of an output by time.
fn rate_of(fmu: &Fmu, name: &str) -> (fmi2Status, f64) {
    let mut rate = [f64::NAN];
    (fmu.get_rates(&[fmu.reference(name)], &[1], &mut rate), rate[0])
}

/// What a small step on adds.
#[test]
fn output_derivatives_are_rates() {
    let fmu = rolling(7);
    for name in ["force.x", "force.y", "force.z", "moment.x", "moment.z"] {
        let (status, rate) = rate_of(&fmu, name);
        assert_eq!(status, OK);
        let (mut state, before, h) = (fmu.state(), fmu.real(name), 1e-8);
        give(&fmu, pose_after(7), RATES);
        assert_eq!(fmu.step(7.0 * H, h), OK);
        let quotient = (fmu.real(name) - before) / h;
        assert!((quotient - rate).abs() <= 2e-2 * rate.abs().max(1.0), "{name}: {rate} {quotient}");
        assert_eq!((fmu.set_state(state), fmu.free_state(&mut state)), (OK, OK));
    }
    assert_eq!(rate_of(&fmu, "E_diss").0, ERROR);
}

/// Beyond the table: one warning a run, or a discard after which a shorter step is done.
#[test]
fn the_end_of_the_table_is_held_or_refused() {
    let down = [0.0, 0.0, -0.1, 0.0, 0.0, 0.0];
    let pressed = |extrapolation: &str| {
        let fmu = fmu(WHEEL);
        assert_eq!((fmu.setup(0.0), fmu.set_text(fmu.reference("table.extrapolation"), extrapolation)), (OK, OK));
        assert_eq!(fmu.enter(), OK);
        give(&fmu, POSE, [0.0; 6]);
        assert_eq!(fmu.exit(), OK);
        fmu
    };
    let held = pressed("hold");
    for step in 0..3 {
        let mut pose = POSE;
        pose[2] += down[2] * H * f64::from(step);
        give(&held, pose, down);
        assert_eq!(held.step(H * f64::from(step), H), OK);
    }
    // The first of the two columns in the middle, where the wheel is lowest.
    let warning = held.message();
    assert!(warning.contains("element[3,1] is beyond the table at t = 0") && warning.contains("Pa at"), "{warning}");
    assert!(held.real("contact.beyond") > 0.5);
    let refused = pressed("refuse");
    let before = refused.bits();
    give(&refused, POSE, down);
    assert_eq!(refused.step(0.0, H), DISCARD);
    assert!(refused.message().contains("element[3,1] is beyond the table at t = 0"), "{}", refused.message());
    assert_eq!(refused.bits(), before);
    assert_eq!(refused.step(0.0, 1e-5), OK);
}

#[test]
fn parameters_out_of_range_are_refused() {
    let fmu = fmu(WHEEL);
    for refine in [0, 1001] {
        assert_eq!(fmu.set_integers(&[fmu.reference("solver.refine")], &[refine]), ERROR);
        assert_names(fmu.message(), "1 to 1000");
    }
    assert_eq!(fmu.set_text(fmu.reference("table.extrapolation"), "guess"), ERROR);
}

/// A softer backing, set before the start, bears less.
#[test]
fn the_stiffnesses_of_a_backing_are_parameters() {
    let backed = WHEEL.replace("transport = true", "transport = true\nbacking = { height = 8e-3, modulus = 6e6 }");
    let force = |normal: f64| {
        let fmu = fmu(&backed);
        assert_eq!(fmu.set_real("patch.backing.normal", normal), OK);
        assert_eq!((fmu.setup(0.0), fmu.enter()), (OK, OK));
        give(&fmu, POSE, RATES);
        assert_eq!(fmu.exit(), OK);
        fmu.real("force.z")
    };
    let (soft, stiff) = (force(1e8), force(1e15));
    assert!(0.0 < soft && soft < 0.9 * stiff, "{soft} {stiff}");
    assert_eq!(fmu(&backed).set_real("patch.backing.shear", -1.0), ERROR);
}

/// Of what heats it a wheel has variables and parameters; the temperatures rise with the share.
#[test]
fn a_warm_wheel_has_temperatures() {
    let text = warm_wheel();
    let rise_at = |share: f64| {
        let fmu = fmu(&text);
        assert_eq!(fmu.set_real("patch.heat.share", share), OK);
        assert_eq!((fmu.setup(0.0), fmu.enter()), (OK, OK));
        give(&fmu, POSE, RATES);
        assert_eq!(fmu.exit(), OK);
        give(&fmu, POSE, RATES);
        assert_eq!(fmu.step(0.0, 1e-2), OK);
        let [largest, mean, cell] =
            ["contact.temperature_largest", "contact.temperature_mean", "element[4,1].temperature"]
                .map(|name| fmu.real(name));
        assert!(largest >= mean && largest >= cell && mean > 293.15, "{largest} {mean} {cell}");
        largest - 293.15
    };
    let (little, much) = (rise_at(0.01), rise_at(0.02));
    assert!((much / little - 2.0).abs() < 0.01, "{little} {much}");
    let names: Vec<String> = fmu(&text).variables.entries().map(|(_, entry)| entry.name.clone()).collect();
    assert_eq!(names[24..27], ["contact.beyond", "contact.temperature_largest", "contact.temperature_mean"]);
    let parameters = ["conductivity", "capacity", "density", "share"].map(|name| format!("patch.heat.{name}"));
    assert_eq!(names[names.len() - 4..], parameters);
    assert_eq!(fmu(&text).set_real("patch.heat.share", 1.5), ERROR);
    assert_eq!(fmu(&text).set_real("patch.heat.density", 0.0), ERROR);
}

/// An angle that is no number, a turn beyond the parts of a step.
#[test]
fn impossible_steps_leave_the_patch_as_it_was() {
    let fmu = rolling(3);
    let before = fmu.bits();
    let mut rates = RATES;
    rates[5] = 1e9;
    give(&fmu, pose_after(3), rates);
    assert_eq!(fmu.step(3.0 * H, H), DISCARD);
    assert_eq!(fmu.bits(), before);
    give(&fmu, pose_after(3), RATES);
    assert_eq!(fmu.step(3.0 * H, H), OK);
    assert_eq!(fmu.set_real("roll", f64::NAN), OK);
    assert_eq!(fmu.step(4.0 * H, H), ERROR);
}

#[test]
fn a_patch_file_names_what_is_wrong() {
    let folder = root().join("tests/reference/patch");
    let error = |text: &str| Patch::parse(text, &folder.join("p.toml")).unwrap_err().to_string();
    let cases = [
        ("radius = 0.3", "radius = -1.0", "p.toml:7: patch.radius = -1.0:"),
        ("length = 0.0144", "length = 1.0", "p.toml:8: patch.length = 1.0: | 0.94"),
        ("nx = 6", "nx = 1000000", "p.toml:11: patch.ny = 2: | 1000000"),
        ("nx = 6", "nx = 6\nbacking = { normal = 1e9 }", "p.toml:11: patch.backing.shear: missing"),
        (
            "nx = 6",
            "nx = 6\nbacking = { height = 1e-3, modulus = 6e6, shear = 1e9 }",
            "p.toml:11: patch.backing.shear: unknown | height, modulus",
        ),
        ("nx = 6", "nx = 6\nheat = { share = 0.3 }", "p.toml:11: patch.heat.conductivity: missing"),
        ("nx = 6", "nz = 6", "p.toml:10: patch.nz: unknown | shape, radius"),
        ("path = \"block", "temperature = 400.0\npath = \"block", "p.toml:4: table.temperature = 400.0: | 283.15"),
        ("path = \"block", "nominal_area = 1.0\npath = \"block", "p.toml:4: table.nominal_area = 1.0: expected none"),
        ("\"tangent\"", "\"tangents\"", "p.toml:14: fmu.outputs[6] = \"tangents\": | \"forces\""),
        ("shape = \"cylinder\"\nradius = 0.3", "shape = \"flat\"\nradius = 0.3", "p.toml:7: patch.radius: unknown"),
    ];
    for (from, to, named) in cases {
        let text = WHEEL.replace(from, to);
        assert_ne!(text, WHEEL);
        assert_names(error(&text), named);
    }
    let points = "name = \"p\"\ntable = { path = \"block.table.csv\" }\npatch = { shape = \"points\", path = \"ring.points.csv\", transport = true }";
    assert!(error(points).contains("patch.transport: unknown"), "{}", error(points));
    let scratch = crate::common::scratch("patch-points");
    fs::copy(folder.join("block.table.csv"), scratch.join("block.table.csv")).unwrap();
    for (row, expected) in
        [("1,2,3", "points.csv:3: columns = 3: expected 4"), ("1,2,3,-4", "points.csv:3: area = \"-4\"")]
    {
        fs::write(scratch.join("points.csv"), format!("x,y,z,area\n0,0,0,1e-6\n{row}\n")).unwrap();
        let text = points.replace("ring.points.csv", "points.csv").replace(", transport = true", "");
        let found = Patch::parse(&text, &scratch.join("p.toml")).unwrap_err().to_string();
        assert!(found.contains(expected), "{found}");
    }
}

/// As for a layer, 64 KiB; with tangents every number of a block of elements carries six derivatives.
#[test]
fn small_stacks_are_enough() {
    let full = warm_wheel().replace("transport = true", "transport = true\nbacking = { height = 5e-3, modulus = 6e6 }");
    for (outputs, kibibytes) in [("forces", 64), ("tangent", 256)] {
        let text = full.replace("\"forces\", ", "").replace("\"tangent\"", &format!("\"{outputs}\""));
        let run = move || {
            let fmu = rolling_of(&text, 2);
            let state = fmu.state();
            assert_eq!(fmu.set_state(state), OK);
        };
        let thread = std::thread::Builder::new().stack_size(kibibytes << 10).spawn(run).unwrap();
        thread.join().unwrap();
    }
}
