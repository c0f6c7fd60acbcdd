//! How a surface of rubber moves under waves of pressure that stand still in the frame of what it slides over.

use rustfft::num_complex::Complex;

use super::surface::SurfaceGrid;
use asperity::scene::Material;

/// The factors of the waves of a grid, each with the 1/N of the transforms.
#[derive(Clone, Debug)]
pub(super) struct Compliance {
    /// 1/(M(q_x v) K(q)), m/Pa; 0 of the mean.
    pub(super) compliance: Vec<Complex<f64>>,
    /// M K, Pa/m; 0 for the mean. For waves of two points per period, which have no phase, 1/Re(1/M) stands for M.
    pub(super) stiffness: Vec<Complex<f64>>,
}

impl Compliance {
    /// That of `material` sliding at `speed` (m/s) on the grid of `surface`, where a wave of the wave number q moves it by
    /// the pressure over M K(q), `wave_stiffness` K in 1/m.
    pub(super) fn new(
        surface: &SurfaceGrid,
        material: &Material,
        wave_stiffness: impl Fn(f64) -> f64,
        speed: f64,
    ) -> Self {
        let (size, share) = (surface.size, surface.share_of_point());
        let zero = Complex::from(0.0);
        let count = size.columns() * size.ny;
        let mut found = Self { compliance: vec![zero; count], stiffness: vec![zero; count] };
        for column in 0..size.columns() {
            let (storage, loss) = material.complex_plane_modulus(surface.wave_number(column) * speed);
            let modulus = Complex::new(storage, loss);
            let flexibility = 1.0 / modulus;
            let flexibility = if size.is_shortest(column) { Complex::from(flexibility.re) } else { flexibility };
            let modulus = 1.0 / flexibility;
            for row in 0..size.ny {
                if (column, row) == (0, 0) {
                    continue;
                }
                let (stiffness, at) = (wave_stiffness(surface.magnitude(column, row)), column * size.ny + row);
                found.compliance[at] = flexibility * (share / stiffness);
                found.stiffness[at] = modulus * (share * stiffness);
            }
        }
        found
    }
}

/// The kernels of the power that the viscosity of the material loses, and of all that it loses, q_x |û_q|² K Im M over
/// |p_q|², but for a constant.
pub(super) fn viscous_losses(
    surface: &SurfaceGrid,
    material: &Material,
    compliance: &Compliance,
    speed: f64,
) -> [Vec<f64>; 2] {
    let (size, viscosity) = (surface.size, material.viscosity.unwrap_or(0.0) * material.shift_factor());
    let losses = |column: usize, of_viscosity: bool| {
        let omega = surface.wave_number(column) * speed;
        let (storage, loss) = material.complex_modulus(omega);
        // Two points a wave have no phase, and lose nothing.
        let lost = if of_viscosity { omega * viscosity } else { loss };
        if size.is_shortest(column) { 0.0 } else { omega * lost / storage.hypot(loss) }
    };
    [true, false].map(|of_viscosity| {
        let waves = compliance.compliance.chunks_exact(size.ny).zip(compliance.stiffness.chunks_exact(size.ny));
        let columns = waves.enumerate().map(|(column, waves)| (losses(column, of_viscosity), waves));
        // |1/(M K)|² K = |1/(M K)|² |M K|/|M|
        let kernel = columns.flat_map(|(loss, (compliance, stiffness))| {
            let size = |(c, s): (&Complex<f64>, &Complex<f64>)| c.norm_sqr() * s.norm();
            compliance.iter().zip(stiffness).map(size).map(move |size| loss * size).collect::<Vec<_>>()
        });
        kernel.collect()
    })
}
