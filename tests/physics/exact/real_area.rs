//! The real area of contact: A_r = A erf(√π F_N/(A M_c h'_s)) in T = μ F_N + A_r (τ_0 + τ_f(v)).

use asperity::simulation::Start;

use crate::common::near::assert_near;
use crate::common::scenes::SceneText;
use crate::physics::exact::run::{REST, Run, rate};

const MASSES: f64 = 4.0;
/// m²
const AREA: f64 = 1e-4 * 1e-2;
const COULOMB: f64 = 0.2;
/// τ_0, Pa.
const SHEAR: f64 = 3e3;
/// τ_f0 (Pa), v_0 (m/s), sharpness, v_c (m/s).
const RATE: (f64, f64, f64, f64) = (6e3, 1e-3, 0.1, 1e-6);
const SLOPE: f64 = 0.02;
const WAVELENGTH: f64 = 2e-5;
/// E_∞ (Pa), and one term (Pa, s).
const RUBBER: (f64, f64, f64) = (3e6, 2e7, 1e-4);
/// Pa s: enough for no swings to grow where friction falls with the speed.
const VISCOSITY: f64 = 2e3;

/// The layer with the law of the whole area and what `lines` add.
fn scene(lines: &str, method: &str) -> SceneText {
    let (rest, modulus, time) = RUBBER;
    let (strength, reference, sharpness, creep) = RATE;
    SceneText::rubber(4, 1e-4, 0.0, 1e-2)
        .without("layer.thickness")
        .set("layer.foundation", "half_space")
        .set("surface.kind", "flat")
        .set("material.poisson_ratio", 0.5)
        .set("material.equilibrium_modulus", rest)
        .set("material.viscosity", VISCOSITY)
        .prony(&[(modulus, time)])
        .coulomb(COULOMB)
        .set("friction.shear_strength", SHEAR)
        .set("friction.rate_shear.strength", strength)
        .set("friction.rate_shear.reference_speed", reference)
        .set("friction.rate_shear.sharpness", sharpness)
        .set("friction.rate_shear.creep_speed", creep)
        .method(method)
        .relative(1e-7)
        .with(lines)
}

fn band() -> String {
    band_of(SLOPE)
}

/// One band with this gradient: half an eighth of a decade on either side of [`WAVELENGTH`], without hysteresis.
fn band_of(slope: f64) -> String {
    let [longest, shortest] = [1.0, -1.0].map(|side: f64| WAVELENGTH * 10_f64.powf(side / 16.0));
    format!(
        "surface.fine = {{ hurst = 1.0, rms_slope = {slope:?}, longest = {longest:?}, shortest = {shortest:?}, \
         hysteresis = false }}"
    )
}

/// τ_0 + τ_f(v), Pa.
fn strength(speed: f64) -> f64 {
    let (strength, reference, sharpness, creep) = RATE;
    SHEAR + strength * (-sharpness * (speed.max(creep) / reference).log10().powi(2)).exp()
}

/// A_r/A of a mass under `normal`, N.
fn share(normal: f64, speed: f64) -> f64 {
    let (rest, modulus, time) = RUBBER;
    let square = |direction: i32| {
        let cosine = (std::f64::consts::FRAC_PI_2 * (f64::from(direction) + 0.5) / 32.0).cos();
        let omega = std::f64::consts::TAU / WAVELENGTH * speed.max(RATE.3) * cosine;
        let x = omega * time;
        let storage = rest + modulus * x * x / (1.0 + x * x);
        let loss = modulus * x / (1.0 + x * x) + VISCOSITY * omega;
        storage * storage + loss * loss
    };
    // The mean over the directions of the waves.
    let modulus = ((0..32).map(square).sum::<f64>() / 32.0).sqrt();
    let stress = modulus / 0.75 * SLOPE;
    libm::erf(std::f64::consts::PI.sqrt() * normal / (AREA * stress))
}

/// The layer pressed into the flat and drawn along it until all is steady.
fn slide(scene: &SceneText, depth: f64, speed: f64) -> Run {
    let mut run = Run::new(scene, Start { w: -depth, u_rate: speed, ..Start::default() });
    // Ten times the relaxation time, and several times the way on which the links come to the friction.
    run.drive(2e-2_f64.max(1e-3 / speed), rate(speed), REST);
    run
}

#[test]
fn steady_slip_has_the_shear_of_the_area_that_touches() {
    for method in ["event", "step"] {
        for depth in [1e-6, 3e-5] {
            for speed in [1e-5, 1e-3, 0.1, 10.0] {
                let mut run = slide(&scene(&band(), method), depth, speed);
                let normal = run.get("F_z") / MASSES;
                let shear = AREA * share(normal, speed) * strength(speed);
                let drag = MASSES * (COULOMB * normal + shear);
                // The table of moduli is right to some 1e-6, the runs to less.
                assert_near("F_x", run.get("F_x"), -drag, 1e-5 * drag);
                assert_near("F_shear", run.get("friction.F_shear"), -MASSES * shear, 1e-5 * drag);
                assert_near("F_coulomb", run.get("friction.F_coulomb"), -MASSES * COULOMB * normal, 1e-6 * drag);
                assert_near(
                    "area",
                    run.get("contact.area_real"),
                    MASSES * AREA * share(normal, speed),
                    1e-5 * AREA * MASSES,
                );
                let before = ["dissipation.E_shear", "dissipation.E_friction"].map(|name| run.get(name));
                run.drive(1e-3 / speed, rate(speed), REST);
                let after = ["dissipation.E_shear", "dissipation.E_friction"].map(|name| run.get(name));
                let part = (after[0] - before[0]) / (after[1] - before[1]);
                assert_near("share of E_shear", part, MASSES * shear / drag, 1e-4);
                let split = run.get("dissipation.E_coulomb") + run.get("dissipation.E_shear");
                assert_near("E_friction", split, run.get("dissipation.E_friction"), 1e-12 * split);
            }
        }
    }
}

/// A layer drawn so slowly that it sticks: it breaks at T(F_N, v_c), and not before.
#[test]
fn a_stuck_layer_breaks_at_the_limit_of_the_creep_speed() {
    let mut run = Run::new(&scene(&band(), "event"), Start { w: -1e-5, ..Start::default() });
    let normal = run.get("F_z") / MASSES;
    let limit = COULOMB * normal + AREA * share(normal, 0.0) * strength(0.0);
    let mut largest: f64 = 0.0;
    while run.events().is_empty() {
        largest = run.get("F_x").abs() / MASSES;
        assert!(largest <= limit * (1.0 + 1e-3));
        // 0.1 µm at a time.
        run.drive(1e-2, rate(1e-5), REST);
    }
    // Within the way of one motion; the table is right to 1e-5.
    assert!(largest > 0.97 * limit, "{largest} {limit}");
}

#[test]
fn without_slopes_below_the_profile_it_is_the_law_of_the_whole_area() {
    for speed in [1e-5, 1e-4] {
        let [whole, flat] =
            [String::new(), band_of(1e-9)].map(|fine| slide(&scene(&fine, "event"), 1e-5, speed).get("F_x"));
        assert_near("F_x", flat, whole, 1e-9 * whole.abs());
    }
}

/// μ(v, T) = μ(a_T v, T_ref).
#[test]
fn temperature_shifts_the_speeds() {
    let at = |temperature: f64, speed: f64| {
        let scene = scene(&band(), "event").wlf([8.0, 120.0, 293.15], temperature);
        slide(&scene, 1e-5, speed).get("friction.coefficient")
    };
    let shift = 10.0_f64.powf(-8.0 * 10.0 / 130.0);
    for speed in [1e-3, 0.3] {
        let friction = at(293.15, shift * speed);
        // Both tables have their entries elsewhere.
        assert_near("μ", at(303.15, speed), friction, 5e-5 * friction);
    }
}
