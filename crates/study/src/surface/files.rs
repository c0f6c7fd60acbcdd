//! Surfaces and spectra as text, as scenes read them.

use asperity::scene::{HeightMap, Surface};

use crate::decimals::real;

/// A map: a matrix of heights, m, each row a line along x.
pub fn matrix(map: &HeightMap) -> String {
    let row = |j: usize| map.line(j).iter().map(|z| real(*z)).collect::<Vec<_>>().join(",") + "\n";
    (0..map.ny()).map(row).collect()
}

/// A spectrum: wave numbers q, rad/m, and C, m⁴.
pub fn spectrum_columns(points: &[[f64; 2]]) -> String {
    let rows: String = points.iter().map(|[q, density]| format!("{},{}\n", real(*q), real(*density))).collect();
    format!("q [1/m],C [m^4]\n{rows}")
}

/// A profile: positions and heights, m.
pub fn profile_columns(surface: &Surface) -> String {
    let row = |(x, z): (&f64, &f64)| format!("{},{}\n", real(*x), real(*z));
    let rows: String = surface.x().iter().zip(surface.z()).map(row).collect();
    format!("x [m],z [m]\n{rows}")
}
