//! Friction near one on slopes, beside finite elements of finite strain.

use std::f64::consts::TAU;

use asperity_study::steady::SteadySlide;

use super::row::{Claim, Comparison, Entry, Row};
use super::scenes::{parse, sine, slide};

pub const FRICTION_NEAR_ONE: Entry = Entry {
    title: "Friction near one on a wave",
    reference: "finite elements of finite strain",
    source: "a program of its own: incompressible neo-Hookean rubber, periodic, quadratic displacements and linear pressures",
    file: "examples/validation/suite/strain.rs",
    quick: true,
    compare,
};

/// E, Pa.
const MODULUS: f64 = 3e6;

/// Elastic rubber of a Poisson ratio under Coulomb's friction on a wave of 1 mm and a peak slope, at a fifth of the pressure
/// that closes it.
fn slid(poisson: f64, coulomb: f64, slope: f64) -> SteadySlide {
    let scene = parse(&format!(
        "name = 'rubber'\nlayer = {{ foundation = 'half_space', masses = 100, spacing = 1e-5, width = 1e-2 }}\n\
         material = {{ density = 1100.0, poisson_ratio = {poisson}, equilibrium_modulus = {MODULUS:e}, \
         prony = [] }}\n\
         friction = {{ coulomb = {coulomb} }}\nsurface = {{ kind = 'sinusoid', amplitude = 1e-5, wavelength = 1e-3 }}"
    ));
    let full = 0.5 * slope * MODULUS / (1.0 - poisson * poisson);
    slide(&scene, sine(4096, slope * 1e-3 / TAU), 1e-3, 0.2 * full)
}

fn compare() -> Comparison {
    let cases = [
        (0.499, 0.5, 0.1, 0.50114, 1e-3),
        (0.499, 1.0, 0.1, 1.00348, 1e-3),
        (0.499, 1.0, 0.2, 1.01314, 2e-3),
        (0.499, 0.5, 0.3, 0.5102, 1e-3),
        (0.499, 1.0, 0.3, 1.02806, 6e-3),
        (0.499, 0.5, 0.6, 0.54076, 3e-3),
        (0.3, 0.5, 0.1, 0.4917, 1e-3),
    ];
    let row = |(poisson, coulomb, slope, expected, claim): (f64, f64, f64, f64, f64)| {
        let found = slid(poisson, coulomb, slope).friction().unwrap();
        let name = format!("friction, Coulomb {coulomb}, peak slope {slope}, ν {poisson}");
        Row::new(name, [expected, found], "", Claim::Share(claim))
    };
    Comparison {
        about: "Elastic rubber slides under Coulomb's friction on one wave of 4096 points, pressed by a fifth of what closes it."
            .into(),
        rows: cases.map(row).into(),
        remark: "Friction strains the surface along the slopes in their second order; elasticity adds terms of that order that \
                 cancel it in the mean friction. The solver has neither. Linear rubber touched at x + u_x has the strain alone: \
                 1.0702 in the fifth row. In the last tractions along the compressible surface lift it: without that friction is \
                 0.5011."
            .into(),
        ..Comparison::default()
    }
}
