//! How a surface of rubber moves under waves of pressure that stand still in the frame of what it slides over.

use rustfft::num_complex::Complex;

use super::surface::SurfaceGrid;
use crate::scene::Material;

/// The factors of the waves of a grid, each with the 1/N of the transforms.
#[derive(Clone, Debug)]
pub struct Compliance {
    /// 1/(M(q_x v) K(q)), m/Pa; 0 of the mean.
    pub compliance: Vec<Complex<f64>>,
    /// M K, Pa/m; 0 of the mean. Its real part, which stands for its inverse's, of two points a wave.
    pub stiffness: Vec<Complex<f64>>,
    /// |M K|, Pa/m.
    pub size: Vec<f64>,
}

impl Compliance {
    /// That of `material` sliding at `speed` (m/s) on the grid of `surface`, where a wave of the wave number q moves it by
    /// the pressure over M K(q), `wave_stiffness` K in 1/m.
    pub fn new(
        surface: &SurfaceGrid,
        material: &Material,
        wave_stiffness: impl Fn(f64) -> f64,
        speed: f64,
    ) -> Self {
        let (size, share) = (surface.size, surface.share_of_point());
        let zero = Complex::from(0.0);
        let count = size.columns() * size.ny;
        let mut found = Self { compliance: vec![zero; count], stiffness: vec![zero; count], size: vec![0.0; count] };
        for column in 0..size.columns() {
            let modulus = plane_modulus(material, surface.wave_number(column) * speed);
            let flexibility = 1.0 / modulus;
            let flexibility = if size.is_shortest(column) { Complex::from(flexibility.re) } else { flexibility };
            let modulus = 1.0 / flexibility;
            let norm = modulus.norm();
            for row in 0..size.ny {
                if (column, row) == (0, 0) {
                    continue;
                }
                let (stiffness, at) = (wave_stiffness(surface.magnitude(column, row)), column * size.ny + row);
                found.compliance[at] = flexibility * (share / stiffness);
                found.stiffness[at] = modulus * (share * stiffness);
                found.size[at] = share * stiffness * norm;
            }
        }
        found
    }
}

/// M = E*/(1 - ν²) at the angular frequency ω, Pa.
fn plane_modulus(material: &Material, omega: f64) -> Complex<f64> {
    let (storage, loss) = material.complex_modulus(omega);
    Complex::new(material.plane_modulus(storage), material.plane_modulus(loss))
}
