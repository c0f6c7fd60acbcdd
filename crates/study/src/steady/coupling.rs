//! How tangential traction moves the surface of compressible rubber along the normal.
//!
//! The traction t on a half-space of a Poisson ratio ν below ½ moves it by
//!
//!   û_z = -iκ' (q·t)/|q| 2/(M |q|),   κ' = (1 - 2ν)/(2(1 - ν))
//!
//! positive into the rubber, so that what lies ahead of a traction gives way (K. L. Johnson, Contact Mechanics, 1985, section
//! 2.3). Of a contact t = -(p h_x + τ q1) along the sliding and -h_y (p + τ h_x/q1) across it, Pa per horizontal area.

use asperity::math::add_weighted_sum;
use rustfft::num_complex::Complex;

use super::contact::Contact;
use super::linear::{Compliance, scatter};
use super::surface::SurfaceGrid;
use super::transform::Convolution;

/// The factors of the waves by which traction moves the surface, m/Pa.
pub(super) struct Coupling {
    along: Vec<Complex<f64>>,
    across: Vec<Complex<f64>>,
    /// What is told by the compliance itself: the part of the traction along the sliding that is so much of the pressure.
    mean: f64,
}

impl Coupling {
    /// That of a compliance where traction is about `mean` times the pressure, against the sliding.
    pub(super) fn new(surface: &SurfaceGrid, compliance: &Compliance, factor: f64, mean: f64) -> Self {
        let waves = |axis: usize| -> Vec<Complex<f64>> {
            let wave = |(at, compliance): (usize, &Complex<f64>)| {
                let (column, row) = (at / surface.size.ny, at % surface.size.ny);
                let magnitude = surface.magnitude(column, row);
                let share = if magnitude > 0.0 { surface.wave_vector(column, row)[axis] / magnitude } else { 0.0 };
                compliance * Complex::new(0.0, -factor * share)
            };
            compliance.compliance.iter().enumerate().map(wave).collect()
        };
        Self { along: waves(0), across: waves(1), mean }
    }

    /// The compliance with the traction that is proportional to the pressure.
    pub(super) fn compliance(&self, compliance: &Compliance, share: f64) -> Compliance {
        compliance.with(|at| -self.mean * self.along[at], share)
    }

    /// How the rest of the `tractions` of a contact moves the surface, at all points, m.
    pub(super) fn moved(&self, contact: &Contact, tractions: &[[f64; 2]], convolution: &mut Convolution) -> Vec<f64> {
        let mut moves = |values: Vec<f64>, kernel: &[Complex<f64>]| {
            let mut field = vec![0.0; convolution.size().points()];
            scatter(&contact.points, &values, &mut field);
            convolution.apply(&mut field, kernel);
            field
        };
        let along = tractions.iter().zip(&contact.pressures).map(|(traction, p)| traction[0] + self.mean * p).collect();
        let mut moved = moves(along, &self.along);
        if tractions.iter().any(|traction| traction[1] != 0.0) {
            let across = moves(tractions.iter().map(|traction| traction[1]).collect(), &self.across);
            add_weighted_sum(&mut moved, [(1.0, &across[..])]);
        }
        moved
    }
}

#[cfg(test)]
mod tests {
    use super::super::{GridSize, SlideProblem, SlidingRubber, SteadySlide, SteadySolver, SurfaceGrid};
    use asperity::scene::Scene;
    use std::f64::consts::TAU;

    /// An elastic body of the modulus M = 1 MPa on a cosine along x of 1 mm, at a fifth of the pressure of full contact.
    fn slide(layer: &str, [nu, slope, coulomb]: [f64; 3], size: GridSize, points: f64) -> SteadySlide {
        let text = format!(
            "name = 'c'\nlayer = {{ {layer}, masses = 8, spacing = 1e-4, width = 1e-2 }}\nfriction = {{ coulomb = {coulomb} }}\n\
             material = {{ density = 1100.0, poisson_ratio = {nu}, equilibrium_modulus = {}, prony = [] }}\n\
             surface = {{ kind = 'sinusoid', amplitude = 1e-5, wavelength = 1e-3 }}",
            1e6 * (1.0 - nu * nu)
        );
        let scene = Scene::parse(&text, "coupling.toml".as_ref()).unwrap_or_else(|error| panic!("{error}"));
        let rubber = SlidingRubber::new(&scene).unwrap();
        let crest = |i: usize| 1e-3 * slope / TAU * (TAU * (i % size.nx) as f64 / size.nx as f64).cos();
        let heights = (0..size.points()).map(crest).collect();
        SteadySolver::new(SurfaceGrid::new(size, 1e-3, 1e-3, heights)).slide(&rubber, 0.1, points * slope)
    }

    /// Friction and the centre of pressure over the wave, of an independent program on the same points.
    #[test]
    fn traction_moves_the_contact_of_a_compressible_half_space() {
        for (case, friction, centre) in [
            ([0.3, 0.1, 0.5], 0.491545767, 0.0135624348),
            ([0.3, 0.1, 1.0], 0.97376376, 0.0267304983),
            ([0.3, 0.2, 0.5], 0.485367541, 0.0134466593),
            ([0.45, 0.1, 0.5], 0.498035751, 0.00436199675),
            ([0.45, 0.1, 1.0], 0.993755473, 0.00868821184),
            ([0.45, 0.2, 0.5], 0.498275794, 0.004364126),
        ] {
            let found = slide("foundation = 'half_space'", case, GridSize { nx: 128, ny: 1 }, 1e5);
            // Both programs come to rest at 1e-7 of the rms height and below.
            assert!((found.friction().unwrap() / friction - 1.0).abs() < 1e-6, "{case:?}: {:?}", found.friction());
            let contact = &found.contact;
            let wave = |part: fn(f64) -> f64| -> f64 {
                let at = |(point, p): (&u32, &f64)| p * part(TAU * f64::from(*point) / 128.0);
                contact.points.iter().zip(&contact.pressures).map(at).sum()
            };
            let found = wave(f64::sin).atan2(wave(f64::cos)) / TAU;
            assert!((found / centre - 1.0).abs() < 1e-5, "{case:?}: {found}");
        }
    }

    /// A map of ridges has what a profile of them has; nearly incompressible rubber has none; of a layer it is not known.
    #[test]
    fn maps_of_ridges_are_as_profiles_and_layers_are_refused() {
        let (profile, map) = (GridSize { nx: 128, ny: 1 }, GridSize { nx: 128, ny: 4 });
        let of = |layer: &str, nu: f64, size: GridSize| slide(layer, [nu, 0.2, 0.8], size, 1e5);
        let half_space = "foundation = 'half_space'";
        let [ridges, rows] = [profile, map].map(|size| of(half_space, 0.35, size).friction().unwrap());
        assert!((rows / ridges - 1.0).abs() < 1e-6, "{rows} {ridges}");
        let [none, some] = [0.48, 0.47].map(|nu| of(half_space, nu, profile).friction().unwrap());
        assert!(none > some && (none / some - 1.0) < 2e-2, "{none} {some}");
        let layer = of("foundation = 'layer', thickness = 1e-3", 0.4, profile);
        assert_eq!((layer.problem(), layer.friction()), (Some(SlideProblem::CompressibleLayer), None));
    }
}
