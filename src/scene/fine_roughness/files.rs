//! The files of `surface.fine`: the spectrum of a surface, and how strain softens rubber.

use std::f64::consts::PI;

use super::{ModulusFactors, RoughnessSpectrum, Softening, SofteningRow};
use crate::scene::values::Word;
use crate::tables::{ContentError, Dimension, Format, POSITIVE, ReadingNote, Table, UnitRule, Wanted, Words, decode};

/// How the file of a spectrum is normalised.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(in crate::scene) enum Convention {
    /// ⟨h²⟩ = 2π ∫ q C dq of a surface, ⟨h²⟩ = ∫ C1 dq of lines, from 0 on.
    #[default]
    Persson,
    /// ⟨h²⟩ = (1/2π) ∫ q C dq, ⟨h²⟩ = (1/π) ∫ C1 dq: C is |h_q|² over area or length.
    ContactEngineering,
}

impl Word for Convention {
    const WORDS: &'static [(&'static str, Self)] =
        &[("persson", Self::Persson), ("contact.engineering", Self::ContactEngineering)];
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum OfSpectrum {
    WaveNumber,
    /// C of an isotropic surface.
    Surface,
    /// C1 of lines.
    Lines,
}

/// A spectrum of a surface falls below all other numbers of scenes: at 1 nm to some 1e-48 m⁴.
const LEAST_DENSITY: f64 = 1e-90;

const SPECTRUM: Format<OfSpectrum, 2> = Format {
    least: 2,
    rises: true,
    ..Format::new(
        &[
            Words::new(
                OfSpectrum::WaveNumber,
                Dimension::WaveNumber,
                "q k qx kx wavevector wavevectors wavenumber wavenumbers wave",
                "vector vectors number numbers angular q k x",
            ),
            Words::new(
                OfSpectrum::Surface,
                Dimension::SurfaceSpectrum,
                "c cq psd ciso c2d spectrum spectral power",
                "q c power density spectral psd spectrum isotropic iso 2d areal radial radially averaged average surface \
                 of",
            ),
            Words::new(
                OfSpectrum::Lines,
                Dimension::LineSpectrum,
                "c c1 c1d cq psd spectrum spectral power",
                "q c power density spectral psd spectrum 1d line lines profile profiles averaged average of",
            ),
        ],
        [
            Wanted::new(&[OfSpectrum::WaveNumber], "q", "wave numbers").within(POSITIVE),
            Wanted {
                unit: UnitRule::AssumedOfFirst,
                ..Wanted::new(&[OfSpectrum::Surface, OfSpectrum::Lines], "C", "power spectrum")
                    .within(POSITIVE.down_to(LEAST_DENSITY))
            },
        ],
        "a wave number and a power spectrum: q [1/m], C [m^4] of an isotropic surface or C1 [m^3] of lines",
    )
};

/// A spectrum from the bytes of a file, and how it was read.
pub(in crate::scene) fn read_spectrum(
    bytes: &[u8],
    convention: Convention,
) -> Result<(RoughnessSpectrum, Vec<ReadingNote>), ContentError> {
    let text = decode(bytes)?;
    let Table { columns, mut rows, notes, .. } = SPECTRUM.read(&text)?;
    let is_of_lines = columns[1].as_ref().is_some_and(|column| column.quantity == OfSpectrum::Lines);
    let divisor = match (convention, is_of_lines) {
        (Convention::Persson, _) => 1.0,
        (Convention::ContactEngineering, true) => PI,
        (Convention::ContactEngineering, false) => 4.0 * PI * PI,
    };
    rows.iter_mut().for_each(|row| row[1] /= divisor);
    let spectrum = if is_of_lines { RoughnessSpectrum::of_lines(&rows) } else { RoughnessSpectrum::new(rows) };
    Ok((spectrum, notes))
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum OfStrain {
    Strain,
    Storage,
    Loss,
}

const STRAIN_SWEEP: Format<OfStrain, 3> = Format {
    least: 2,
    rises: true,
    ..Format::new(
        &[
            Words::new(
                OfStrain::Strain,
                Dimension::Number,
                "strain gamma γ epsilon ε dehnung",
                "amplitude shear dynamic peak oscillation",
            ),
            Words::new(
                OfStrain::Storage,
                Dimension::Number,
                "storage e' g'",
                "factor modulus ratio relative e' g' e'0 g'0",
            ),
            Words::new(
                OfStrain::Loss,
                Dimension::Number,
                "loss e'' g''",
                "factor modulus ratio relative e'' g'' e''0 g''0",
            ),
        ],
        [
            Wanted::new(&[OfStrain::Strain], "strain", "strains").within(POSITIVE),
            Wanted::new(&[OfStrain::Storage], "storage", "factors on the storage modulus").within(POSITIVE.up_to(1.0)),
            Wanted::new(&[OfStrain::Loss], "loss", "factors on the loss modulus").within(POSITIVE),
        ],
        "strain [1] or [%], and the factors on both moduli: storage, loss",
    )
};

/// A table of softening from the bytes of a file, and how it was read.
pub(in crate::scene) fn read_softening(bytes: &[u8]) -> Result<(Softening, Vec<ReadingNote>), ContentError> {
    let text = decode(bytes)?;
    let Table { rows, notes, .. } = STRAIN_SWEEP.read(&text)?;
    let row = |[strain, storage, loss]: [f64; 3]| SofteningRow { strain, factors: ModulusFactors { storage, loss } };
    Ok((Softening::Table(rows.into_iter().map(row).collect()), notes))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The points, and how many notes say what is assumed; else the line and the message.
    type PointsRead = Result<(Vec<[f64; 2]>, usize), (Option<usize>, String)>;

    fn spectrum(text: &str) -> PointsRead {
        read_with(text, Convention::Persson)
    }

    fn read_with(text: &str, convention: Convention) -> PointsRead {
        let found = read_spectrum(text.as_bytes(), convention);
        let found = found.map_err(|error| (error.line, error.to_string()));
        found.map(|(spectrum, notes)| (spectrum.points().to_vec(), notes.iter().filter(|note| note.assumed).count()))
    }

    fn near(found: &[[f64; 2]], wanted: &[[f64; 2]]) -> bool {
        // Rounding of the conversions.
        let close = |(a, b): (&f64, &f64)| (a / b - 1.0).abs() < 1e-14;
        found.len() == wanted.len() && found.iter().flatten().zip(wanted.iter().flatten()).all(close)
    }

    #[test]
    fn names_and_units_of_a_spectrum_are_those_of_the_header() {
        let texts = [
            "q [1/m],C [m^4]\n1e3,1e-18\n1e5,1e-25\n",
            "q [1/mm]; C(q) [mm^4]\n1;1e-6\n100;1e-13\n",
            "Wavevector (µm⁻¹)\tPSD (µm⁴)\n0.001\t1e6\n0.1\t0.1\n",
            "wave number in rad/m, power spectral density in m^4\n1e3,1e-18\n1e5,1e-25\n",
            "q,C\nrad/mm,mm4\n1,1e-6\n100,1e-13\n",
            "q,C\n1e3,1e-18\n1e5,1e-25\n",
            "1e3,1e-18\n1e5,1e-25\n",
        ];
        for (text, assumed) in texts.into_iter().zip([0, 0, 0, 0, 0, 2, 2]) {
            let (points, found) = spectrum(text).unwrap_or_else(|error| unreachable!("{text:?}: {error:?}"));
            assert!(near(&points, &[[1e3, 1e-18], [1e5, 1e-25]]) && found == assumed, "{text:?}: {points:?} {found}");
        }
    }

    #[test]
    fn a_spectrum_of_lines_is_told_by_its_unit() {
        let wanted = RoughnessSpectrum::of_lines(&[[1e3, 1e-12], [1e5, 1e-17]]);
        for text in [
            "q [1/m],C [m^3]\n1e3,1e-12\n1e5,1e-17\n",
            "Wavevector (1/µm),PSD 1D (µm³)\n1e-3,1e6\n0.1,10\n",
            "q [1/mm],C1 [mm^3]\n1,1e-3\n100,1e-8\n",
        ] {
            let (points, assumed) = spectrum(text).unwrap_or_else(|error| unreachable!("{text:?}: {error:?}"));
            assert!(near(&points, wanted.points()) && assumed == 0, "{text:?}: {points:?}");
        }
    }

    /// A surface of the same heights, as both conventions have it.
    #[test]
    fn conventions_differ_by_their_factors() {
        for (unit, factor) in [("m^4", 4.0 * PI * PI), ("m^3", PI)] {
            let of = |value: f64| format!("q [1/m],C [{unit}]\n1,{value:e}\n10,{:e}\n", 1e-3 * value);
            let (own, _) = read_with(&of(1e-9), Convention::Persson).unwrap_or_default();
            let (other, _) = read_with(&of(1e-9 * factor), Convention::ContactEngineering).unwrap_or_default();
            assert!(near(&other, &own) && own.len() == 2, "{unit}");
        }
    }

    #[test]
    fn what_is_no_spectrum_is_refused() {
        let cases = [
            ("", 1, "rows = 0: expected at least two rows"),
            ("q [1/m],C [m^4]\n1,1\n", 2, "rows = 1: expected at least two rows"),
            (
                "q [1/m],C [m^4]\n2,1\n1,1\n",
                3,
                "column 1 (q [1/m]) = 1.0 1/m: expected more than 2.0 1/m, that of the row before",
            ),
            (
                "q [1/m],C [m^4]\n1,1\n1,1\n",
                3,
                "column 1 (q [1/m]) = 1.0 1/m: expected more than 1.0 1/m, that of the row before",
            ),
            ("q [1/m],C [m^4]\n1,1\n2,0\n", 3, "column 2 (C [m^4]) = \"0\": expected a number from 1e-90 to 1e30"),
            ("q [1/m],C [m^4]\n1,1\n2,-1\n", 3, "column 2 (C [m^4]) = \"-1\": expected a number from 1e-90 to 1e30"),
            ("q [1/m],C [m^4]\n0,1\n2,1\n", 2, "column 1 (q [1/m]) = \"0\": expected a number from 1e-30 to 1e30"),
            ("q [1/m],C [m^2]\n1,1\n2,1\n", 1, "unit of column 2 (C [m^2]) = \"m2\": expected one of m⁴, mm⁴"),
            (
                "q [1/furlong],C [m^4]\n1,1\n2,1\n",
                1,
                "unit of column 1 (q [1/furlong]) = \"1/furlong\": expected one of 1/m",
            ),
            ("q [1/m],C1\n1,1\n2,1\n", 1, "unit of column 2 (C1): expected it beside the name: one of m³, mm³"),
            ("x,y\n1,1\n2,1\n", 1, "columns = \"x, y\": expected a wave number and a power spectrum"),
            ("1,2,3\n2,3,4\n", 1, "columns = 3: expected a wave number and a power spectrum"),
            ("log q [1/m],C [m^4]\n1,1\n2,1\n", 1, "column 1 (log q [1/m]): expected numbers, not their logarithms"),
            (
                "# all lengths in 1/mm\n1,1\n2,1\n",
                1,
                "unit = \"all lengths in 1/mm\": expected the unit beside the name",
            ),
        ];
        for (text, line, message) in cases {
            let (found, error) = spectrum(text).err().unwrap_or_default();
            assert!(found == Some(line) && error.starts_with(message), "{text:?}: {found:?} {error}");
        }
    }

    #[test]
    fn strains_are_numbers_or_per_cent() {
        let texts = [
            "strain,storage,loss\n0.001,1,1\n0.2,0.5,1.25\n",
            "strain [%]; storage; loss\n0,1; 1; 1\n20; 0,5; 1,25\n",
            "# a sweep\nShear strain (%)\tG'/G'0\tG''/G''0\n0.1\t1\t1\n20\t.5\t1.25\n",
            "0.001 1 1\n0.2 0.5 1.25\n",
        ];
        let factors = |storage, loss| ModulusFactors { storage, loss };
        let row = |strain, factors| SofteningRow { strain, factors };
        let wanted = Softening::Table(vec![row(0.001, factors(1.0, 1.0)), row(0.2, factors(0.5, 1.25))]);
        for text in texts {
            let (found, _) =
                read_softening(text.as_bytes()).unwrap_or_else(|error| unreachable!("{text:?}: {error:?}"));
            assert_eq!(found, wanted, "{text:?}");
        }
        for (text, line, message) in [
            ("strain,storage,loss\n1,1,1\n", 2, "rows = 1: expected at least two rows"),
            (
                "strain,storage,loss\n1,1.1,1\n2,1,1\n",
                2,
                "column 2 (storage) = \"1.1\": expected a number from 1e-30 to 1.0",
            ),
            ("strain,storage,loss\n1,1,0\n2,1,1\n", 2, "column 3 (loss) = \"0\": expected a number from 1e-30 to 1e30"),
            ("strain,storage,loss\n2,1,1\n1,1,1\n", 3, "column 1 (strain) = 1.0: expected more than 2.0"),
            (
                "strain,storage [MPa],loss\n1,1,1\n2,1,1\n",
                1,
                "unit of column 2 (storage [MPa]) = \"MPa\": expected one of",
            ),
            ("strain,storage\n1,1\n2,1\n", 1, "columns = \"strain, storage\": expected strain [1] or [%]"),
        ] {
            let error = read_softening(text.as_bytes()).err();
            let (found, error) = error.map(|error| (error.line, error.to_string())).unwrap_or_default();
            assert!(found == Some(line) && error.starts_with(message), "{text:?}: {found:?} {error}");
        }
    }
}
