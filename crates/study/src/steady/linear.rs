//! The linear problem of a contact whose points are known: pressures on them under which the surface moves as it must.
//!
//! Pressures p on a set of n of the N points move the surface by C p. With the separation d and the mean pressure P,
//!
//!   C p + d = r on the set,   mean p = P.
//!
//! Subtracting the mean over the set eliminates d. The part of p with zero sum is found by [GMRES](super::krylov),
//! preconditioned by M K restricted to the set, in about ten iterations on any grid. Keeping the phase of M K saves an
//! eighth of them over |M K|.
//!
//! The surface moves under waves of pressure that stand still in the frame of what it slides over: [`Compliance`].

use asperity::math::sum;
use asperity::scene::Material;
use rustfft::num_complex::Complex;

use super::krylov::Gmres;
use super::surface::SurfaceGrid;
use super::transform::{Convolution, GridSize};

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

impl Compliance {
    /// The same with something added to each wave's, as those are stored: with the `share` of a point. That of the mean stays 0.
    pub(super) fn with(&self, added: impl Fn(usize) -> Complex<f64>, share: f64) -> Self {
        let whole = |(i, c): (usize, &Complex<f64>)| if c.norm_sqr() > 0.0 { c + added(i) } else { *c };
        let compliance: Vec<_> = self.compliance.iter().enumerate().map(whole).collect();
        let inverse = |c: &Complex<f64>| if c.norm_sqr() > 0.0 { share * share / c } else { *c };
        let stiffness = compliance.iter().map(inverse).collect();
        Self { compliance, stiffness }
    }

    /// The least real part of a wave's compliance over its size.
    pub(super) fn least_storage(&self) -> f64 {
        let waves = self.compliance.iter().filter(|wave| wave.norm_sqr() > 0.0);
        waves.map(|wave| wave.re / wave.norm()).fold(1.0, f64::min)
    }

    /// The size of the compliance of the wave of eight points along the sliding, and the least of all.
    pub(super) fn sizes(&self, size: GridSize) -> [f64; 2] {
        let waves = self.compliance.iter().map(|wave| wave.norm()).filter(|&norm| norm > 0.0);
        let least = waves.fold(f64::INFINITY, f64::min);
        let eight = self.compliance[(size.nx / 8).max(1) * size.ny].norm();
        [eight.max(least), least]
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

/// The most iterations.
const MOST_ITERATIONS: usize = 400;

/// The solver of linear problems on one grid, with its memory.
#[derive(Debug)]
pub(super) struct LinearSolver {
    pub(super) convolution: Convolution,
    /// A field of the grid.
    field: Vec<f64>,
    gmres: Gmres,
}

impl LinearSolver {
    pub(super) fn new(convolution: Convolution) -> Self {
        let field = vec![0.0; convolution.size().points()];
        Self { convolution, field, gmres: Gmres::default() }
    }

    /// How the pressures `p` on the points of the set, 0 elsewhere, move the surface: C p at all points.
    pub(super) fn moved(&mut self, compliance: &Compliance, set: &[u32], p: &[f64]) -> &[f64] {
        scatter(set, p, &mut self.field);
        self.convolution.apply(&mut self.field, &compliance.compliance);
        &self.field
    }

    /// Changes the pressures `p` (Pa) on the points of the set, their sum held, until C p + d = r within `tolerance` (m, root
    /// mean square over the set), where `residual` is r - C p at first but for a constant, and that of the new p at last.
    pub(super) fn solve(
        &mut self,
        compliance: &Compliance,
        set: &[u32],
        p: &mut [f64],
        residual: &mut [f64],
        tolerance: f64,
    ) {
        let tolerance = tolerance * (set.len() as f64).sqrt();
        let Self { convolution, field, gmres } = self;
        let mut convolve = |from: &[f64], kernel: &[Complex<f64>], to: &mut [f64]| {
            scatter(set, from, field);
            convolution.apply(field, kernel);
            gather(set, field, to);
            remove_mean(to);
        };
        remove_mean(residual);
        gmres.solve(p, residual, tolerance, MOST_ITERATIONS, |from, direction, image| {
            convolve(from, &compliance.stiffness, direction);
            convolve(direction, &compliance.compliance, image);
        });
    }
}

/// The values on the points of a set as a field that is 0 elsewhere.
pub(super) fn scatter(set: &[u32], values: &[f64], field: &mut [f64]) {
    field.fill(0.0);
    set.iter().zip(values).for_each(|(&point, value)| field[point as usize] = *value);
}

/// The values of a field on the points of a set.
pub(super) fn gather(set: &[u32], field: &[f64], values: &mut [f64]) {
    set.iter().zip(values).for_each(|(&point, value)| *value = field[point as usize]);
}

/// Subtracts the mean.
fn remove_mean(values: &mut [f64]) {
    let mean = sum(values) / values.len() as f64;
    values.iter_mut().for_each(|value| *value -= mean);
}
