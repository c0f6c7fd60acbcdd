//! The material form through the FMU: its complex modulus as measured, and its temperature as a parameter.

use std::f64::consts::TAU;
use std::fs;

use nalgebra::{DMatrix, DVector};

use crate::common::scenes::SceneText;
use crate::fmu::fmi_interface::master::*;

/// Two masses over the wave.
fn rubber() -> SceneText {
    SceneText::rubber(2, 1.0e-4, 1.0e-3, 1.0e-2)
        .with("material.equilibrium_modulus = 2e6\nmaterial.viscosity = 10.0")
        .prony(&[(5.0e6, 1.0e-4)])
        .with("surface = { kind = 'file', path = 'profile.csv', periodic = true }")
        .with("friction = { coulomb = 0.3, shear_strength = 1e4 }")
        .outputs(&["forces", "dissipation", "contact", "elements"])
}

fn scene(temperature: f64) -> String {
    rubber().wlf([7.52, 119.75, 293.15], temperature).text()
}

/// Presses and slides for some steps and returns all outputs after each.
fn slide(fmu: &Fmu) -> Vec<Vec<u64>> {
    const H: f64 = 2e-5;
    let step = |i: u32| {
        let (w, u) = (-1e-7 * f64::from(i), 2e-6 * f64::from(i));
        assert_eq!((fmu.set_real("w", w), fmu.set_real("u", u)), (OK, OK));
        assert_eq!((fmu.set_rate("w", -5e-3), fmu.set_rate("u", 0.1)), (OK, OK));
        assert_eq!(fmu.step(H * f64::from(i), H), OK, "{:?}", fmu.messages());
        fmu.bits()
    };
    (0..20).map(step).collect()
}

#[test]
fn a_temperature_set_is_the_same_as_one_in_the_scene() {
    let given = slide(&Fmu::running_with(&scene(330.0)));
    let fmu = Fmu::initialising_with(&scene(293.15));
    let cold = fmu.real("material.wlf.temperature");
    assert_eq!((fmu.set_real("material.wlf.temperature", 330.0), fmu.exit()), (OK, OK));
    assert_eq!((cold, fmu.real("material.wlf.temperature")), (293.15, 330.0));
    assert_eq!(slide(&fmu), given);
    assert_ne!(slide(&Fmu::running_with(&scene(293.15))), given);
    assert_eq!(fmu.set_real("material.wlf.temperature", 300.0), ERROR);
    // The run saved is that of the temperature set, in an instance that starts from the scene's.
    let other = Fmu::initialising_with(&scene(293.15));
    other.thaw(&fmu.frozen());
    assert_eq!((other.bits(), other.real("material.wlf.temperature")), (fmu.bits(), 330.0));
}

#[test]
fn a_temperature_without_a_shift_is_an_error_at_the_end_of_the_initialisation() {
    let fmu = Fmu::initialising_with(&scene(293.15));
    // Of its springs.
    assert!(fmu.message().starts_with("foundation = \"springs\": "));
    assert_eq!(fmu.set_real("material.wlf.temperature", 170.0), OK);
    assert_eq!(fmu.exit(), ERROR);
    let message = fmu.message();
    let expected = "fmi2ExitInitializationMode: material.wlf.temperature = 170.0: expected more than ";
    assert!(message.starts_with(expected), "{message}");
    assert_eq!((fmu.reset(), fmu.setup(0.0), fmu.enter()), (OK, OK, OK));
    // In between anything goes: only what is left in the end counts.
    assert_eq!(fmu.set_real("material.wlf.temperature", 170.0), OK);
    assert_eq!(fmu.set_real("material.wlf.reference_temperature", 200.0), OK);
    assert_eq!(fmu.exit(), OK);
    assert_eq!(fmu.set_real("material.wlf.c2", -1.0), ERROR);
}

#[test]
fn the_links_of_a_material_are_no_parameters() {
    let fmu = Fmu::of(&scene(293.15), false);
    let names: Vec<String> = fmu.variables.entries().map(|(_, entry)| entry.name.clone()).collect();
    let is_there = |name: &str| names.iter().any(|other| other == name);
    assert!(["layer.mass", "layer.vertical.stiffness", "friction.shear_force"].iter().all(|name| !is_there(name)));
    assert!(["material.prony[1].modulus", "friction.shear_strength", "contact.area"].iter().all(|name| is_there(name)));
}

#[test]
fn another_compound_beside_the_scene_is_another_fmu() {
    let text = rubber().wlf([7.52, 119.75, 293.15], 293.15).set("material.prony", "compound.csv").text();
    let folder = Folder::with_scene("compound", &text);
    let guid = |compound: &str| {
        let series = format!("relaxation_time [s],modulus [Pa]\n{compound}\n");
        fs::write(folder.path().join("compound.csv"), series).unwrap();
        folder.description().0
    };
    assert_ne!(guid("1e-4,5e6"), guid("1e-4,5.1e6"));
}

/// A term in the middle of the frequencies and one beyond each end.
const SMALL: [(f64, f64); 3] = [(1e-6, 9e6), (1e-3, 6e6), (1.0, 3e6)];

/// (τ, E) of the compound shipped.
fn compound() -> Vec<(f64, f64)> {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/tread-block-rubber/compound.csv");
    let text = fs::read_to_string(path).unwrap();
    let row = |line: &str| line.split_once(", ").and_then(|(a, b)| Some((a.parse().ok()?, b.parse().ok()?)));
    text.lines().filter_map(row).collect()
}

const MASSES: usize = 3;
const EQUILIBRIUM: f64 = 4.44e6;

/// Every mass sticks on a flat profile: no force along x, and friction.
fn clamped(terms: &[(f64, f64)]) -> String {
    let terms: Vec<_> = terms.iter().map(|&(tau, modulus)| (modulus, tau)).collect();
    SceneText::rubber(MASSES, 1e-4, 1e-3, 1e-2)
        .set("material.equilibrium_modulus", EQUILIBRIUM)
        .prony(&terms)
        .coulomb(0.5)
        .relative(1e-8)
        .outputs(&["forces", "contact"])
        .text()
}

/// Steps a period. A straight line between them instead of the sine leaves at the points 2 Σ_m (1/(N m))² [K*(mNω) -
/// K*] ≈ 3.3 (|K*(Nω)| - |K*|)/N², 1e-5 of |K*| for a modulus that trebles on the way.
const STEPS: u32 = 1000;
/// Periods before the fit, by which every element with τ up to a period has settled, ...
const SETTLING: u32 = 16;
/// ... and for the fit.
const FITTED: u32 = 4;

/// E' and E'' as F_z over w shows them at a frequency: w = -w_0 + â sin ωt, so F_z = F_0 - k A/H â |E*| sin(ωt + arg
/// E*) (model.md, section 8 case 1). What elements slower than the run leave of the transient is a cubic within the
/// fit.
fn measured(terms: &[(f64, f64)], frequency: f64) -> (f64, f64) {
    const PRESSED: f64 = 2e-5;
    /// Small enough for the masses to stay down: â |E*| < w_0 E_∞.
    const SWING: f64 = 1e-6;
    let h = 1.0 / (frequency * f64::from(STEPS));
    let w = |i: u32| -PRESSED + SWING * (TAU * f64::from(i % STEPS) / f64::from(STEPS)).sin();
    let rate = |i: u32| (w(i + 1) - w(i)) / h;
    let fmu = Fmu::initialising_with(&clamped(terms));
    assert_eq!((fmu.set_real("w", w(0)), fmu.set_rate("w", rate(0)), fmu.exit()), (OK, OK, OK));
    let (input, output) = (fmu.reference("w"), fmu.reference("F_z"));
    let count = ((SETTLING + FITTED) * STEPS) as usize;
    let mut forces = Vec::with_capacity(count);
    for i in 0..(SETTLING + FITTED) * STEPS {
        assert_eq!(fmu.set_reals(&[input], &[w(i)]), OK);
        assert_eq!(fmu.set_rates(&[input], &[1], &[rate(i)]), OK);
        assert_eq!(fmu.step(f64::from(i) * h, h), OK, "{:?}", fmu.messages());
        let mut force = [0.0];
        assert_eq!(fmu.get_reals(&[output], &mut force), OK);
        forces.push(force[0]);
    }
    let mut sticking = [0];
    assert_eq!(fmu.get_integers(&[fmu.reference("contact.sticking")], &mut sticking), OK);
    assert_eq!(sticking[0] as usize, MASSES);
    let fitted = &forces[(SETTLING * STEPS) as usize..];
    let [sine, cosine] = swing(fitted);
    let per_modulus = -(MASSES as f64) * (1e-4 * 1e-2 / 1e-3) * SWING;
    (sine / per_modulus, cosine / per_modulus)
}

/// The parts along sin and cos of values at the ends of the steps from the start of a period, beside a cubic.
fn swing(values: &[f64]) -> [f64; 2] {
    let basis = |row: usize, column: usize| {
        let (x, phase) = (row as f64 / values.len() as f64 - 0.5, TAU * (row + 1) as f64 / f64::from(STEPS));
        match column {
            0 => phase.sin(),
            1 => phase.cos(),
            power => x.powi(power as i32 - 2),
        }
    };
    let matrix = DMatrix::from_fn(values.len(), 6, basis);
    let right = matrix.transpose() * DVector::from_column_slice(values);
    let solved = (matrix.transpose() * &matrix).lu().solve(&right).unwrap();
    [solved[0], solved[1]]
}

/// E* = E_∞ + Σ E_j iωτ_j/(1 + iωτ_j) (2).
fn formula(terms: &[(f64, f64)], omega: f64) -> (f64, f64) {
    terms.iter().fold((EQUILIBRIUM, 0.0), |(storage, loss), &(tau, modulus)| {
        let x = omega * tau;
        (storage + modulus * x * x / (1.0 + x * x), loss + modulus * x / (1.0 + x * x))
    })
}

fn assert_modulus(terms: &[(f64, f64)]) {
    for frequency in [1.0, 10.0, 100.0, 1e3, 1e4] {
        let (storage, loss) = measured(terms, frequency);
        let expected = formula(terms, TAU * frequency);
        let error = (storage - expected.0).hypot(loss - expected.1) / expected.0.hypot(expected.1);
        assert!(error < 1e-4, "at {frequency} Hz {storage:e} + {loss:e} i, not {expected:?}: off by {error:e}");
    }
}

#[test]
fn the_complex_modulus_of_a_small_compound_as_measured() {
    assert_modulus(&SMALL);
}

#[test]
fn the_complex_modulus_of_the_compound_shipped_as_measured() {
    let compound = compound();
    assert_eq!(compound.len(), 16);
    assert_modulus(&compound);
}
