//! The file of a power spectrum: of a surface or of lines, over the wave number or the spatial frequency.

use std::f64::consts::{PI, TAU};

use asperity::scene::{self, Convention, LEAST_DENSITY, RoughnessSpectrum};
use asperity::tables::{
    CYCLES, ContentError, Dimension, FileKind, GivenColumns, POSITIVE, ReadColumn, ReadTable, ReadingNote, Role, Unit,
};

use crate::text::{decode, read};

const DENSITY: asperity::tables::NumberRange = POSITIVE.down_to(LEAST_DENSITY);
const ROLES: [Role; 5] = [
    Role::new(
        "q",
        "k, qx, kx, q x, k x, wavevector, wavevectors, wave vector, wave vectors, wavenumber, wavenumbers, wave number, wave \
         numbers, angular wave number, angular wavenumber, angular spatial frequency, omega, Ω",
        Dimension::WaveNumber,
    )
    .within(POSITIVE)
    .optional(),
    Role::new("n", "spatial frequency, spatial frequencies, cycles per metre", Dimension::WaveNumber)
        .within(POSITIVE)
        .optional(),
    Role::new(
        "C",
        "Cq, C(q), C2D, C iso, Ciso, psd, power spectrum, power spectral density, spectral density, spectrum, isotropic psd, \
         psd iso, psd 2d, areal psd, radial psd, radially averaged psd, isotropic power spectrum",
        Dimension::SurfaceSpectrum,
    )
    .within(DENSITY)
    .optional(),
    Role {
        unit: asperity::tables::UnitRule::Named,
        ..Role::new(
            "C1",
            "C, Cq, C(q), C1(q), C1D, psd, psd 1d, power spectrum, power spectral density, spectral density, spectrum, 1d \
             psd, line psd, profile psd, psd of lines, averaged psd, 1d power spectrum",
            Dimension::LineSpectrum,
        )
        .within(DENSITY)
        .optional()
    },
    Role {
        unit: asperity::tables::UnitRule::Named,
        ..Role::new("Gd", "G_d, Gd(n), G_d(n), displacement psd, displacement power spectral density", Dimension::LineSpectrum)
            .within(DENSITY)
            .optional()
    },
];
/// What people write of a spectrum.
pub const SPECTRUM: FileKind = FileKind {
    one_of: &[&["q", "n"], &["C", "C1", "Gd"]],
    least: 2,
    ..FileKind::new(
        "a spectrum",
        &ROLES,
        "a wave number and a power spectrum: q [1/m], C [m^4] of an isotropic surface or C1 [m^3] of lines; or the spatial \
         frequency n [1/m] and G_d [m^3] of ISO 8608",
    )
};

/// The isotropic spectrum in the bytes of a file, as Persson normalises it: q in rad/m, C in m⁴.
pub(crate) fn read_spectrum(
    bytes: &[u8],
    convention: Convention,
    given: &GivenColumns,
) -> Result<ReadTable, ContentError> {
    let text = decode(bytes)?;
    let (table, _) = read(&text, &SPECTRUM, given)?;
    let column = |keys: &[&str]| keys.iter().find_map(|key| table.column(key));
    let (Some(place), Some(density)) = (column(&["q", "n"]), column(&["C", "C1", "Gd"])) else { return Ok(table) };
    let is_of_lines = density.key != "C";
    // Of 1 cycle/m the wave number is 2π rad/m; a density over cycles is 2π times that over rad.
    let (is_cycles, is_iso) = (place.key == "n" || place.unit.name == CYCLES, density.key == "Gd");
    if is_iso != is_cycles && is_iso || is_cycles && !is_of_lines {
        let expected = "G_d [m^3] over the spatial frequency n [1/m], or C over the wave number q [rad/m] = 2π n";
        let given = format!("{} over {}", density.label(), place.label());
        return Err(ContentError::value(table.line, "columns", &given, expected));
    }
    let per_cycle = if is_cycles { TAU } else { 1.0 };
    let to_wave_number = if place.key == "n" && place.unit.name != CYCLES { TAU } else { 1.0 };
    let divisor = match (convention, is_of_lines) {
        (Convention::Persson, _) => 1.0,
        (Convention::ContactEngineering, true) => PI,
        (Convention::ContactEngineering, false) => 4.0 * PI * PI,
    };
    let rows = place.values.iter().zip(&density.values);
    let mut rows: Vec<[f64; 2]> =
        rows.map(|(&q, &density)| [to_wave_number * q, density / (divisor * per_cycle)]).collect();
    check_rises(&table, place, &rows)?;
    if is_of_lines {
        rows = RoughnessSpectrum::of_lines(&rows).points().to_vec();
    }
    let mut columns: Vec<ReadColumn> = Vec::new();
    for (index, role) in scene::SPECTRUM.roles.iter().enumerate() {
        let values = rows.iter().map(|row| row[index]).collect();
        columns.push(ReadColumn { values, ..ReadColumn::new(role, index, Unit::si(role.dimension)) });
    }
    let mut notes = table.notes.clone();
    let cycles = "spatial frequencies are cycles: q = 2π n, and C1(q) = G_d(n)/2π".to_owned();
    notes.extend(is_cycles.then_some(ReadingNote { text: cycles, assumed: false }));
    Ok(ReadTable { columns, notes, ..table })
}

fn check_rises(table: &ReadTable, column: &ReadColumn, rows: &[[f64; 2]]) -> Result<(), ContentError> {
    let Some(row) = rows.windows(2).position(|pair| pair[1][0] <= pair[0][0]) else { return Ok(()) };
    let [before, found] = [row, row + 1].map(|row| column.in_si_units(column.values[row]));
    let expected = format!("more than {before}, that of the row before: they must rise");
    Err(ContentError::value(table.lines.get(row + 1).copied(), &column.label(), &found, &expected))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(text: &str, convention: Convention) -> Result<Vec<[f64; 2]>, (Option<usize>, String)> {
        let table = read_spectrum(text.as_bytes(), convention, &[]).map_err(|error| (error.line, error.key))?;
        Ok(table.values("q").iter().zip(table.values("C")).map(|(&q, &density)| [q, density]).collect())
    }

    fn near(found: &[[f64; 2]], wanted: &[[f64; 2]]) -> bool {
        // Rounding of the conversions.
        let close = |(a, b): (&f64, &f64)| (a / b - 1.0).abs() < 1e-14;
        found.len() == wanted.len() && found.iter().flatten().zip(wanted.iter().flatten()).all(close)
    }

    #[test]
    fn names_and_units_are_those_of_the_header() {
        for text in [
            "q [1/m],C [m^4]\n1e3,1e-18\n1e5,1e-25\n",
            "q [1/mm]; C(q) [mm^4]\n1;1e-6\n100;1e-13\n",
            "Wavevector (µm⁻¹)\tPSD (µm⁴)\n0.001\t1e6\n0.1\t0.1\n",
            "q,C\nrad/mm,mm4\n1,1e-6\n100,1e-13\n",
            "q,C\n1e3,1e-18\n1e5,1e-25\n",
            "1e3,1e-18\n1e5,1e-25\n",
        ] {
            let found = points(text, Convention::Persson).unwrap_or_else(|error| unreachable!("{text}: {error:?}"));
            assert!(near(&found, &[[1e3, 1e-18], [1e5, 1e-25]]), "{text}: {found:?}");
        }
    }

    /// A spectrum of lines is told by its unit; one over cycles is 2π times that over radians.
    #[test]
    fn lines_become_those_of_a_surface() {
        let wanted = RoughnessSpectrum::of_lines(&[[TAU * 1e3, 1e-12 / TAU], [TAU * 1e5, 1e-17 / TAU]]);
        for text in [
            "n [1/m],G_d [m^3]\n1e3,1e-12\n1e5,1e-17\n",
            "n [cycles/m],Gd(n) [m^3]\n1e3,1e-12\n1e5,1e-17\n",
            "spatial frequency [1/m],psd [m^3]\n1e3,1e-12\n1e5,1e-17\n",
        ] {
            let found = points(text, Convention::Persson).unwrap_or_else(|error| unreachable!("{text}: {error:?}"));
            assert!(near(&found, wanted.points()), "{text}: {found:?}");
        }
        let wanted = RoughnessSpectrum::of_lines(&[[1e3, 1e-12], [1e5, 1e-17]]);
        for text in ["q [1/m],C [m^3]\n1e3,1e-12\n1e5,1e-17\n", "q [1/mm],C1 [mm^3]\n1,1e-3\n100,1e-8\n"] {
            assert!(points(text, Convention::Persson).is_ok_and(|found| near(&found, wanted.points())), "{text}");
        }
    }

    /// A surface of the same heights, as both conventions have it.
    #[test]
    fn conventions_differ_by_their_factors() {
        for (unit, factor) in [("m^4", 4.0 * PI * PI), ("m^3", PI)] {
            let of = |value: f64| format!("q [1/m],C [{unit}]\n1,{value:e}\n10,{:e}\n", 1e-3 * value);
            let own = points(&of(1e-9), Convention::Persson).unwrap_or_default();
            let other = points(&of(1e-9 * factor), Convention::ContactEngineering).unwrap_or_default();
            assert!(near(&other, &own) && own.len() == 2, "{unit}");
        }
    }

    #[test]
    fn what_is_no_spectrum_is_refused() {
        for (text, line, key) in [
            ("", 1, "rows"),
            ("q [1/m],C [m^4]\n2,1\n1,1\n", 3, "column 1 \"q [1/m]\""),
            ("q [1/m],C [m^4]\n1,1\n2,0\n", 3, "column 2 \"C [m^4]\""),
            ("q [1/m],C [m^2]\n1,1\n2,1\n", 1, "columns"),
            ("q [1/furlong],C [m^4]\n1,1\n2,1\n", 1, "unit of column 1 \"q [1/furlong]\""),
            ("q [1/m],C1\n1,1\n2,1\n", 1, "unit of column 2 \"C1\""),
            ("n [1/m],C [m^4]\n1,1\n2,1\n", 1, "columns"),
            ("q [1/m],G_d [m^3]\n1,1\n2,1\n", 1, "columns"),
            ("x,y\n1,1\n2,1\n", 1, "columns"),
            ("1,2,3\n2,3,4\n", 1, "columns"),
            ("log q [1/m],C [m^4]\n1,1\n2,1\n", 1, "columns"),
            ("# all lengths in 1/mm\n1,1\n2,1\n", 1, "unit"),
        ] {
            assert_eq!(points(text, Convention::Persson), Err((Some(line), key.to_owned())), "{text}");
        }
    }
}
