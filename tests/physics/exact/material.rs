//! The material form: links by model.md section 7, hysteresis by its moduli, the shift with temperature.

use std::f64::consts::TAU;

use asperity::scene::{Link, LinkKind, Material, Scene};
use asperity::simulation::{Motion, Start};

use crate::common::near::assert_near;
use crate::common::scenes::{Law, SceneText};
use crate::common::{difference, largest};
use crate::physics::exact::run::{REST, Run, mean, rate, steps};

/// The reference temperature is 300 K; at 400 K log10 a_T = -2·100/200 = -1.
const WLF: [f64; 3] = [2.0, 100.0, 300.0];

fn waves(layer: SceneText) -> SceneText {
    layer.sinusoid(5e-6, 1e-3).coulomb(0.3).outputs(&["forces", "contact", "energy"])
}

/// H = 5 mm, B = 10 mm, Δx = 0.1 mm: A/H = 2e-4 m and H B/Δx = 0.5 m; G = E/2.5.
fn elastic() -> SceneText {
    let layer = waves(SceneText::rubber(5, 1e-4, 5e-3, 1e-2)).set("material.poisson_ratio", 0.25);
    layer.set("material.equilibrium_modulus", 2e6).prony(&[(5e6, 1e-3), (3e6, 1e-5)])
}

fn rubber() -> Scene {
    let warm = elastic().set("material.viscosity", 100.0).wlf(WLF, 400.0);
    warm.set("friction.shear_strength", 1e4).scene()
}

/// The same by hand.
fn springs() -> Scene {
    let layer = SceneText::new(5, 1e-4, 5.5e-6)
        .vertical((400.0, 2e-3, [(1000.0, 1e-4), (600.0, 1e-6)]))
        .horizontal((160.0, 8e-4, [(400.0, 1e-4), (240.0, 1e-6)]))
        .lateral_x((1e6, 5.0, [(2.5e6, 1e-4), (1.5e6, 1e-6)]))
        .lateral_z((4e5, 2.0, [(1e6, 1e-4), (6e5, 1e-6)]));
    waves(layer).set("friction.shear_force", 1e-2).scene()
}

/// All numbers of a link.
fn numbers(link: &Link) -> Vec<f64> {
    let elements = link.maxwell.iter().flat_map(|element| [element.stiffness, element.relaxation_time]);
    [link.stiffness, link.damping].into_iter().flatten().chain(elements).collect()
}

/// A handful of products, each rounded once.
const ROUNDING: f64 = 2e-15;

#[test]
fn links_follow_from_the_material() {
    let (rubber, springs) = (rubber(), springs());
    for kind in LinkKind::ALL {
        let [found, expected] = [&rubber, &springs].map(|scene| numbers(&scene.link(kind).unwrap()));
        assert_eq!(found.len(), 6);
        for (found, expected) in found.iter().zip(expected) {
            assert_near(kind.name(), *found, expected, ROUNDING * expected);
        }
    }
    assert_near("mass", rubber.mass(), springs.mass(), ROUNDING * springs.mass());
    let [force, expected] = [&rubber, &springs].map(|scene| scene.shear_force().unwrap());
    assert_near("shear force", force, expected, ROUNDING * expected);
}

/// Without a viscosity there are no dampers, without a temperature no shift.
#[test]
fn what_a_material_does_not_name_is_not_there() {
    let link = elastic().scene().link(LinkKind::Vertical).unwrap();
    assert_eq!((link.damping, link.maxwell[0].relaxation_time), (None, 1e-3));
}

/// A run of the material is bit for bit one of the constants that follow from it, and one by hand but for their
/// roundings.
#[test]
fn a_run_of_the_material_is_that_of_its_links() {
    let columns = |scene: &Scene| {
        let mut run = Run::of(scene, Start { w: -2e-6, u_rate: 0.1, ..Start::default() });
        let times = steps((1e-4, 5e-3), 50);
        run.sample(
            &Motion { duration: 5e-3, u: rate(0.1), w: rate(-1e-3), ..Motion::default() },
            &times,
            &["F_x", "F_z"],
        )
    };
    let material = columns(&rubber());
    assert_eq!(material, columns(&rubber().direct_form()));
    for (found, expected) in material.iter().zip(columns(&springs())) {
        // Roundings of 1e-16 and an error test that they may tip over now and then, at a tolerance of 1e-6 a step.
        assert!(difference(found, &expected) < 1e-6 * largest(&expected), "{}", difference(found, &expected));
    }
}

#[test]
fn the_contact_area_is_that_of_the_masses_in_contact() {
    let mut run = Run::of(&rubber(), Start { w: -2e-5, ..Start::default() });
    let count = run.get("contact.count");
    assert!(count > 0.0);
    assert_near("area", run.get("contact.area"), count * 1e-6, ROUNDING * count * 1e-6);
}

/// E* = E_∞ + iω a_T η + Σ E_j iω a_T τ_j/(1 + iω a_T τ_j), at frequencies from far below to far above all of them.
#[test]
fn the_complex_modulus_is_that_of_the_equation() {
    let material = rubber().material.unwrap();
    let law = Law::with_maxwell(2e6, 10.0, &[(5e6, 1e-4), (3e6, 1e-6)]);
    for omega in [1e-3, 1.0, 1e3, 1e5, 1e9] {
        let (storage, loss) = material.complex_modulus(omega);
        let expected = law.complex_stiffness(omega);
        assert_near("E'", storage, expected.0, ROUNDING * expected.0);
        // τ = 0.1 · 1e-3 s is not the number nearest to 1e-4.
        assert_near("E''", loss, expected.1, ROUNDING * expected.1);
    }
    assert_eq!(material.complex_modulus(0.0), (2e6, 0.0));
}

const WAVELENGTH: f64 = 1e-3;
/// A sinusoid under twenty masses that touch it in part, slid at `v`: mean |F_x|/F_z over the fourth wavelength, with
/// these parts of the friction law. Inertia is negligible: the stiffest frequency is far above that of the passage, and
/// damped.
fn friction(law: &str, temperature: f64, v: f64) -> f64 {
    let scene = SceneText::rubber(20, 5e-5, 2e-4, 1e-2)
        .with("material.density = 1\nmaterial.equilibrium_modulus = 2e6\nmaterial.viscosity = 10")
        .prony(&[(3e6, 1e-3), (2e6, 1e-4)])
        .wlf(WLF, temperature)
        .sinusoid(2e-5, 1e-3)
        .with(law);
    let mut run = Run::new(&scene, Start { w: -2e-5, u_rate: v, ..Start::default() });
    // The second wave; not yet steady, but what shifts does so from the start.
    let times = steps((WAVELENGTH / v, 2.0 * WAVELENGTH / v), 64);
    let motion = Motion { duration: 2.0 * WAVELENGTH / v, u: rate(v), w: REST, ..Motion::default() };
    let columns = run.sample(&motion, &times, &["F_x", "F_z", "contact.ratio"]);
    let ratio = mean(&columns[2]);
    assert!(0.1 < ratio && ratio < 0.99, "{ratio} in contact");
    -mean(&columns[0]) / mean(&columns[1])
}

/// a_T of the materials here.
fn shift(temperature: f64) -> f64 {
    10.0_f64.powf(-2.0 * (temperature - 300.0) / (temperature - 200.0))
}

/// Heat does what slowness does: all times shrink by a_T, so the layer at T and v is the one at T_ref and a_T v.
/// Returns μ.
fn assert_shifted(law: &str, temperature: f64, v: f64) -> f64 {
    let reference = friction(law, 300.0, shift(temperature) * v);
    let what = format!("μ at {temperature} K, {v} m/s");
    assert_near(&what, friction(law, temperature, v), reference, 0.01 * reference);
    reference
}

#[test]
fn friction_at_a_temperature_is_that_at_the_shifted_speed() {
    let cases = [(400.0, 0.3), (400.0, 3.0), (350.0, 0.5), (280.0, 0.05)];
    let seen = cases
        .map(|(temperature, v)| assert_shifted("friction = { coulomb = 0.2, shear_strength = 2e4 }", temperature, v));
    // The shift is seen at all: μ is not the same at all speeds.
    assert!(largest(&seen) > 1.02 * seen.iter().copied().fold(f64::INFINITY, f64::min), "{seen:?}");
}

/// v_0 and v_c move with the material's times, so what depends on the speed itself does as well: below v_0, where it
/// rises and no contact creeps and leaps.
#[test]
fn friction_that_depends_on_the_speed_shifts_too() {
    let law =
        "friction.coulomb = 0.1\nfriction.rate_shear = { strength = 1e5, reference_speed = 10.0, sharpness = 0.3 }";
    let hot = assert_shifted(law, 350.0, 0.5);
    let unshifted = friction(law, 300.0, 0.5);
    // Five times what is allowed above: the shift is seen.
    assert!(unshifted > 1.05 * hot, "{unshifted}, {hot}");
}

/// The compound of the scene beside its file: 16 terms, from the glassy range to the rubbery one.
#[test]
fn the_compound_shipped_is_read_from_its_file() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/tread-block-rubber/tread-block-rubber.toml");
    let mut scene = Scene::load(path.as_ref()).unwrap();
    scene.set_by_name("material.wlf.temperature", "293.15").unwrap();
    let Material { prony, equilibrium_modulus, .. } = scene.material.clone().unwrap();
    assert_eq!((prony.len(), equilibrium_modulus), (16, 4.44e6));
    let loss_factor = |omega: f64| {
        let (storage, loss) = scene.material.as_ref().unwrap().complex_modulus(omega);
        loss / storage
    };
    // A rubber at 20 °C: tan δ some 0.2 at 10 Hz, and above 0.5 in the transition at some 100 MHz.
    assert!((0.1..0.4).contains(&loss_factor(TAU * 10.0)), "{}", loss_factor(TAU * 10.0));
    assert!(loss_factor(TAU * 1e8) > 0.5, "{}", loss_factor(TAU * 1e8));
    assert!(scene.files.iter().any(|file| file.path == std::path::Path::new("compound.csv")));
}
