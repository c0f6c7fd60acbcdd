//! A carrier that is a body through the FMU: its inputs and their order, forces that jump, derivatives, states, errors; and
//! the layer's temperature as an input.

use asperity_fmi::{Role, VariableRef};

use crate::common::scenes::SceneText;
use crate::fmu::fmi_interface::master::{ERROR, Fmu, OK};

/// Bodies along both axes, pulled by a spring along x, pressed by a load along z.
fn bodies() -> SceneText {
    SceneText::new(4, 1e-4, 1e-7)
        .vertical((2e3, 8e-3, [(1e3, 1e-4)]))
        .horizontal((1e3, 8e-3))
        .sinusoid(1e-6, 2.3e-4)
        .coulomb(0.3)
        .with("carrier.x = { mass = 1e-4, stiffness = 500.0, damping = 0.02 }")
        .with(
            "carrier.z.mass = 1e-4\ncarrier.z.damping = 0.2\ncarrier.z.load = 0.04\ncarrier.z.initial = 'equilibrium'",
        )
        .relative(1e-8)
        .outputs(&["forces", "carrier", "energy", "dissipation", "tangent", "elements"])
}

fn names(fmu: &Fmu, is: fn(&VariableRef) -> bool) -> Vec<String> {
    fmu.variables.entries().filter(|(_, entry)| is(entry)).map(|(_, entry)| entry.name.clone()).collect()
}

/// Does `count` steps of `h`, the drive at 20 mm/s.
fn pull(fmu: &Fmu, from: &mut f64, count: u32, h: f64) {
    for _ in 0..count {
        assert_eq!((fmu.set_real("u", 0.02 * *from), fmu.set_rate("u", 0.02)), (OK, OK));
        assert_eq!(fmu.step(*from, h), OK, "{:?}", fmu.messages());
        *from += h;
    }
}

#[test]
fn inputs_are_those_that_act_in_their_order() {
    let of = |scene: SceneText| names(&Fmu::of(&scene.text(), false), |entry| matches!(entry.role, Role::Input(_)));
    // A damper is a drive; without one w is no input.
    assert_eq!(of(bodies()), ["u", "w", "load", "pull"]);
    assert_eq!(of(bodies().without("carrier.z.damping")), ["u", "load", "pull"]);
    assert_eq!(of(bodies().without("carrier.x")), ["u", "w", "load"]);
}

#[test]
fn parameters_are_the_numbers_given() {
    let fmu = Fmu::of(&bodies().text(), false);
    let of_carrier = names(&fmu, |entry| matches!(entry.role, Role::Parameter(_)));
    let of_carrier: Vec<_> = of_carrier.into_iter().filter(|name| name.starts_with("carrier.")).collect();
    let expected = ["x.mass", "x.stiffness", "x.damping", "z.mass", "z.damping", "z.load", "z.initial"];
    assert_eq!(of_carrier, expected.map(|name| format!("carrier.{name}")));
    let fmu = Fmu::initialising_with(&bodies().text());
    assert_eq!((fmu.set_real("carrier.z.load", 0.08), fmu.exit()), (OK, OK));
    assert!((fmu.real("F_z") - 0.08).abs() < 1e-4, "{}", fmu.real("F_z"));
}

/// At rest F_z is the load; a force that is set acts from the next step on, without delay.
#[test]
fn a_load_acts_from_its_step_on() {
    let fmu = Fmu::running_with(&bodies().text());
    let mut time = 0.0;
    pull(&fmu, &mut time, 20, 5e-5);
    let before = fmu.real("F_z");
    assert_eq!(fmu.set_real("load", 0.03), OK);
    assert_eq!(fmu.real("F_z"), before, "outputs stay until the step");
    for step in 0..200 {
        assert_eq!((fmu.set_rate("load", 0.0), fmu.set_rate("u", 0.0)), (OK, OK));
        assert_eq!(fmu.step(time, 1e-4), OK, "{step}");
        time += 1e-4;
    }
    // The body has come to rest on the layer: the load and the damper's pull that is left.
    let (force, rate) = (fmu.real("F_z"), fmu.real("carrier.w_rate"));
    assert!((force - 0.07 - 0.2 * rate).abs() < 1e-3 * 0.07, "{force} {rate}");
}

#[test]
fn a_state_is_restored_bit_for_bit() {
    let fmu = Fmu::running_with(&bodies().text());
    let mut time = 0.0;
    pull(&fmu, &mut time, 30, 5e-5);
    assert_eq!((fmu.set_real("load", 0.01), fmu.set_real("pull", 0.002)), (OK, OK));
    pull(&fmu, &mut time, 1, 5e-5);
    let (bytes, from) = (fmu.frozen(), time);
    pull(&fmu, &mut time, 10, 5e-5);
    let expected = fmu.bits();
    let other = Fmu::running_with(&bodies().text());
    for fmu in [&fmu, &other] {
        fmu.thaw(&bytes);
        let mut time = from;
        pull(fmu, &mut time, 10, 5e-5);
        assert_eq!(fmu.bits(), expected);
    }
    // Not into a scene whose carrier is prescribed.
    let unlike = Fmu::running_with(&bodies().set("name", "other").text());
    let mut state = std::ptr::null_mut();
    assert_eq!(unlike.deserialise(&bytes, &mut state), ERROR);
}

/// The states, u and w among them, held: the drive's spring alone follows the drive.
#[test]
fn directional_derivatives_are_those_of_the_drive() {
    let fmu = Fmu::running_with(&bodies().text());
    let mut time = 0.0;
    pull(&fmu, &mut time, 30, 5e-5);
    let by = |unknown: &str, known: &str| {
        let mut value = [f64::NAN];
        let (unknown, known) = (fmu.reference(unknown), fmu.reference(known));
        assert_eq!(fmu.get_derivatives(&[unknown], &[known], &[1.0], &mut value), OK);
        value[0]
    };
    assert_eq!((by("carrier.drive_x", "u"), by("carrier.drive_z", "w")), (500.0, 0.0));
    for known in ["u", "w", "load", "pull"] {
        assert_eq!([by("F_x", known), by("F_z", known), by("carrier.u", known)], [0.0; 3], "{known}");
    }
    let stretch = fmu.real("carrier.u") - 0.02 * time;
    let change = by("energy.carrier_elastic", "u");
    assert!((change + 500.0 * stretch).abs() < 1e-9 * (500.0 * stretch).abs(), "{change} {stretch}");
}

/// Speeds, accelerations by the equation of motion, and the drive's rate.
#[test]
fn output_derivatives_are_those_of_the_motion() {
    let fmu = Fmu::running_with(&bodies().text());
    let mut time = 0.0;
    pull(&fmu, &mut time, 37, 5e-5);
    let rate = |name: &str| {
        let mut value = [f64::NAN];
        assert_eq!(fmu.get_rates(&[fmu.reference(name)], &[1], &mut value), OK, "{name}");
        value[0]
    };
    let (u_rate, w_rate) = (fmu.real("carrier.u_rate"), fmu.real("carrier.w_rate"));
    assert_eq!((rate("carrier.u"), rate("carrier.w")), (u_rate, w_rate));
    let acceleration = (fmu.real("F_x") + fmu.real("carrier.drive_x")) / 1e-4;
    // The step's last stage is the end: its equation is solved to its tolerance.
    let size = fmu.real("carrier.drive_x").abs() / 1e-4;
    assert!((rate("carrier.u_rate") - acceleration).abs() < 1e-5 * size, "{} {acceleration}", rate("carrier.u_rate"));
    let drive = -500.0 * (u_rate - 0.02) - 0.02 * rate("carrier.u_rate");
    assert!((rate("carrier.drive_x") - drive).abs() < 1e-9 * drive.abs(), "{} {drive}", rate("carrier.drive_x"));
    let mut value = [f64::NAN];
    assert_eq!(fmu.get_rates(&[fmu.reference("carrier.u")], &[2], &mut value), ERROR);
}

/// NaN and infinity stop the step as those of u do, a carrier that leaves the range as an error.
#[test]
fn impossible_forces_are_refused() {
    for bad in [f64::NAN, f64::INFINITY, 1e31] {
        for force in ["load", "pull"] {
            let fmu = Fmu::running_with(&bodies().text());
            assert_eq!(fmu.set_real(force, bad), OK);
            let before = fmu.bits();
            assert_ne!(fmu.step(0.0, 1e-5), OK);
            assert!(fmu.message().contains(&format!("the input {force} is ")), "{}", fmu.message());
            assert_eq!(fmu.bits(), before);
        }
    }
    // A load so large that the carrier leaves all range.
    let flung = bodies().without("carrier.z.initial").set("carrier.z.load", -1e30).set("carrier.z.start", 1.0);
    let fmu = Fmu::running_with(&flung.text());
    assert_eq!(fmu.step(0.0, 1e-3), ERROR, "{:?}", fmu.messages());
}

/// A thermal model's temperature: what a parameter would have been, from the start on or later.
#[test]
fn a_temperature_is_an_input() {
    let scene = |kelvin: f64| {
        SceneText::rubber(3, 1e-4, 1e-3, 1e-2)
            .with("material.equilibrium_modulus = 2e6\nmaterial.viscosity = 10")
            .prony(&[(5e6, 1e-4)])
            .wlf([7.52, 119.75, 293.15], kelvin)
            .sinusoid(1e-6, 2.3e-4)
            .coulomb(0.3)
            .outputs(&["forces", "dissipation", "energy"])
    };
    let with = |kelvin: f64| scene(kelvin).set("input.temperature", true).text();
    let press = |fmu: &Fmu, from: u32, to: u32| {
        for i in from..to {
            let (w, u) = (-1e-7 * f64::from(i), 2e-6 * f64::from(i));
            assert_eq!((fmu.set_real("w", w), fmu.set_real("u", u)), (OK, OK));
            assert_eq!((fmu.set_rate("w", -5e-3), fmu.set_rate("u", 0.1)), (OK, OK));
            assert_eq!(fmu.step(2e-5 * f64::from(i), 2e-5), OK, "{:?}", fmu.messages());
        }
        fmu.bits()
    };
    let fmu = Fmu::running_with(&with(293.15));
    let inputs = names(&fmu, |entry| matches!(entry.role, Role::Input(_)));
    assert_eq!(inputs.last().map(String::as_str), Some("temperature"));
    assert_eq!(fmu.real("temperature"), 293.15);
    let cold = press(&fmu, 0, 20);
    assert_eq!(cold, press(&Fmu::running_with(&scene(293.15).text()), 0, 20), "as if it were no input");
    let warm = Fmu::initialising_with(&with(293.15));
    assert_eq!((warm.set_real("temperature", 320.0), warm.exit()), (OK, OK));
    let warm_bits = press(&warm, 0, 20);
    assert_eq!(warm_bits, press(&Fmu::running_with(&scene(320.0).text()), 0, 20), "set before the start");
    // Later: other forces, and a ledger that closes.
    assert_eq!(fmu.set_real("temperature", 320.0), OK);
    let bytes = fmu.frozen();
    let heated = press(&fmu, 20, 40);
    let (residual, input) = (fmu.real("energy.residual"), fmu.real("energy.input"));
    assert!(residual.abs() < 1e-5 * input.abs(), "{residual} {input}");
    let other = Fmu::running_with(&with(293.15));
    other.thaw(&bytes);
    assert_eq!(press(&other, 20, 40), heated);
    // Back to the state before the first heating, after it.
    fmu.thaw(&bytes);
    assert_eq!(press(&fmu, 20, 40), heated);
    for bad in [0.0, -3.0, f64::NAN, 170.0] {
        let fmu = Fmu::running_with(&with(293.15));
        press(&fmu, 0, 2);
        let before = fmu.bits();
        assert_eq!((fmu.set_real("temperature", bad), fmu.step(4e-5, 2e-5)), (OK, ERROR), "{bad}");
        assert_eq!(fmu.bits(), before);
    }
}
