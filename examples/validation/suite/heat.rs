//! The temperature of contacts: Carslaw and Jaeger's half-space, Jaeger's moving strip.

use std::f64::consts::PI;

use asperity::model::FlashKernel;
use asperity::scene::Scene;
use asperity_study::decimals::percent;
use asperity_study::steady::{SlidingRubber, SteadySolver};

use super::row::{Claim, Comparison, Entry, Row};
use super::scenes::{cylinder, parse, sine, slide};

const FILE: &str = "examples/validation/suite/heat.rs";
/// W/(m K), J/(m³ K), and the rubber's part.
const CONDUCTIVITY: f64 = 0.25;
const HEAT_CAPACITY: f64 = 1700.0 * 1100.0;
const SHARE: f64 = 0.5;

fn effusivity() -> f64 {
    (CONDUCTIVITY * HEAT_CAPACITY).sqrt()
}

/// Rubber that friction heats at its surface: waves that it lacks are there, and too flat to do anything.
fn rubber(friction: &str) -> Scene {
    parse(&format!(
        "name = 'h'\nlayer = {{ foundation = 'half_space', masses = 8, spacing = 1e-4, width = 1e-2 }}\n\
         material = {{ density = 1100.0, poisson_ratio = 0.49, equilibrium_modulus = 5e6, prony = [], \
         wlf = {{ c1 = 7.0, c2 = 120.0, reference_temperature = 293.0, temperature = 293.0 }}, \
         heat = {{ conductivity = {CONDUCTIVITY}, capacity = 1700.0, share = {SHARE} }} }}\n\
         friction = {{ {friction} }}\nsurface = {{ kind = 'sinusoid', amplitude = 1e-5, wavelength = 1e-3, \
         fine = {{ hurst = 0.8, rms_slope = 1e-9, longest = 1e-3, shortest = 1e-4, hysteresis = false }} }}"
    ))
}

pub const HALF_SPACE: Entry = Entry {
    title: "A surface that rubs evenly warms",
    reference: "Carslaw and Jaeger 1959",
    source: "H. S. Carslaw, J. C. Jaeger, Conduction of Heat in Solids, 1959, 2.9: 2Q√(t/π)/√(λρc)",
    file: FILE,
    quick: true,
    compare: half_space,
};

fn half_space() -> Comparison {
    let scene = rubber("coulomb = 0.5");
    let kernel = FlashKernel::new(&scene).unwrap();
    let rise = |flux: f64, time: f64| SHARE * 2.0 * flux * (time / PI).sqrt() / effusivity();
    let row = |what: String, values: [f64; 2]| Row::new(what, values, "K", Claim::Share(1e-3));
    let mut rows: Vec<Row> = [1e-5, 1e-3, 0.1, 10.0]
        .map(|time| row(format!("a mass of a layer, {time} s at 1 MW/m²"), [rise(1e6, time), 1e6 * kernel.rise(time)]))
        .into();
    let sliding = SlidingRubber::new(&scene).unwrap();
    let mut solver = SteadySolver::new(sine(64, 1e-5));
    for (way, speed) in [(1e-3, 1.0), (0.2, 1.0), (1.0, 0.01), (0.05, 30.0)] {
        let found = solver.slide_over(&sliding, speed, 1e6, Some(way));
        assert!(found.contact.is_full && found.heat_converged);
        let exact = rise(speed * 1e6 * found.friction().unwrap(), way / speed);
        rows.push(row(format!("the solver, after {way} m at {speed} m/s"), [exact, found.surface_rise.unwrap()]));
    }
    Comparison {
        about: "A constant power at the surface, μ = 0.5 in full contact, half of it the rubber's: λ = 0.25 W/(m K), \
                ρc = 1.87 MJ/(m³ K)."
            .into(),
        rows,
        ..Comparison::default()
    }
}

pub const STRIP: Entry = Entry {
    title: "The flash temperature of a moving contact",
    reference: "Jaeger 1942",
    source: "J. C. Jaeger, Proc. R. Soc. N.S.W. 76, 1942, 203: strip of heat on a half-space",
    file: FILE,
    quick: true,
    compare: strip,
};

/// ζ(-½, a) and ζ(-3/2, a), by Euler and Maclaurin's sum from the twentieth term.
fn hurwitz(s: f64, a: f64) -> f64 {
    let (count, n) = (20, 20.0 + a);
    let sum: f64 = (0..count).map(|i| (a + f64::from(i)).powf(-s)).sum();
    let tail = n.powf(1.0 - s) / (s - 1.0) + 0.5 * n.powf(-s) + s / 12.0 * n.powf(-s - 1.0);
    sum + tail - s * (s + 1.0) * (s + 2.0) / 720.0 * n.powf(-s - 3.0)
}

/// The mean over the strip of the temperature that a heat Q leaves, over Q√(L/v)/(√π √(λρc)), of strips of a `width`
/// over the period L, without the mean of all: ∫ ζ(½, (x - s)/L) ds, since Σ (x + nL)^-½ is ζ(½, x/L)/√L but for its
/// mean.
fn mean_over_strip(width: f64) -> f64 {
    // ∫∫ over 0 < s, x < w: the images before, and its own part where x > s; with primitives 2ζ(-½) and 4/3 ζ(-3/2).
    let twice = |a: f64| 4.0 / 3.0 * hurwitz(-1.5, a);
    // ∫_0^w ∫_0^x ζ(½, x - s) + ∫_0^w ∫_x^w ζ(½, 1 + x - s).
    let own = twice(width) - twice(0.0) - 2.0 * hurwitz(-0.5, 0.0) * width;
    let before = 2.0 * hurwitz(-0.5, 1.0) * width - twice(1.0) + twice(1.0 - width);
    (own + before) / width
}

/// Jaeger's mean temperature of a strip over that of conduction along the depth alone, at vb/2D of half its width b.
fn jaeger(peclet: f64) -> f64 {
    // θ(X) = (2QD/πλv) ∫_(X-P)^(X+P) e^-u K_0(|u|) du over |X| < P, of which the mean is taken; along the depth alone
    // it is 2/3 · 2Q √(2b/πv)/√(λρc).
    let kernel = |u: f64| {
        // K_0(|u|) e^-u = ∫_0^∞ e^(-|u| cosh θ - u) dθ.
        let parts = 400;
        let end = (1.0 + 50.0 / u.abs()).acosh();
        (0..parts)
            .map(|i| end * (f64::from(i) + 0.5) / f64::from(parts))
            .map(|t| (-u.abs() * t.cosh() - u).exp())
            .sum::<f64>()
            * end
            / f64::from(parts)
    };
    // ∫∫ over the strip in X and s is ∫ (2P - |u|) K du.
    let parts = 4000;
    let both = |t: f64| {
        // u = 2P t², finer near 0.
        let u = 2.0 * peclet * t * t;
        4.0 * peclet * t * (2.0 * peclet - u) * (kernel(u) + kernel(-u))
    };
    let double = (0..parts).map(|i| both((f64::from(i) + 0.5) / f64::from(parts))).sum::<f64>() / f64::from(parts);
    // In units of QD/(λv): b = 2DP/v.
    let mean = 2.0 / PI * double / (2.0 * peclet);
    let deep = 2.0 / 3.0 * 2.0 * (4.0 * peclet / PI).sqrt();
    mean / deep
}

fn strip() -> Comparison {
    // Shear that is the same all over the contact, which a cylinder makes.
    let (shear, half_width, radius) = (1e5, 1e-4, 5e-3);
    let modulus = 5e6 / (1.0 - 0.49 * 0.49);
    let force = PI * modulus * half_width * half_width / (4.0 * radius);
    let length = 32.0 * half_width;
    let scene = rubber(&format!("shear_strength = {shear:e}"));
    let mut rows = Vec::new();
    for speed in [0.1, 1.0, 10.0] {
        let found = slide(&scene, cylinder(8192, length, radius, half_width), speed, force / length);
        let flux = SHARE * shear * speed;
        let exact = flux * (length / speed).sqrt() / (PI.sqrt() * effusivity()) * mean_over_strip(found.area);
        let what = format!("mean over the contact at {speed} m/s");
        rows.push(Row::new(what, [exact, found.flash_mean.unwrap()], "K", Claim::Share(2e-2)));
    }
    let diffusivity = CONDUCTIVITY / HEAT_CAPACITY;
    let part = |speed: f64| percent(1.0 - jaeger(speed * half_width / (2.0 * diffusivity)), 2);
    Comparison {
        about: "A cylinder whose contact of 0.2 mm shears at 0.1 MPa all over: Jaeger's strip at speeds at which \
                heat flows along the depth alone, with the strips of the period before it, and less the mean of the \
                surface, from which the flash temperature counts."
            .into(),
        rows,
        remark: format!(
            "Conduction along the sliding is left out. Beside Jaeger's whole integral that changes the mean over a \
             strip of 0.2 mm by {} at 1 mm/s, {} at 10 mm/s and {} at 0.1 m/s; over one of 10 µm by as much at \
             speeds twenty times as high.",
            part(1e-3),
            part(1e-2),
            part(0.1)
        ),
        ..Comparison::default()
    }
}
