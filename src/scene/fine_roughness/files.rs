//! The files of `surface.fine`: the spectrum of a surface, and how strain softens rubber.

use super::{ModulusFactors, RoughnessSpectrum, Softening, SofteningRow};
use crate::scene::values::Word;
use crate::tables::{Dimension, FileKind, POSITIVE, ReadTable, Role};

/// How the file of a spectrum is normalised.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Convention {
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

/// A spectrum of a surface falls below all other numbers of scenes: at 1 nm to some 1e-48 m⁴.
pub const LEAST_DENSITY: f64 = 1e-90;

const SPECTRUM_ROLES: [Role; 2] = [
    Role::new("q", "", Dimension::WaveNumber).within(POSITIVE),
    Role::new("C", "", Dimension::SurfaceSpectrum).within(POSITIVE.down_to(LEAST_DENSITY)),
];
/// The file of a spectrum in its canonical form: that of an isotropic surface, as Persson normalises it.
pub const SPECTRUM: FileKind = FileKind {
    least: 2,
    rises: true,
    ..FileKind::new("a spectrum", &SPECTRUM_ROLES, "a wave number and a power spectrum: q [1/m], C [m⁴]")
};

impl RoughnessSpectrum {
    /// That of a file.
    pub(in crate::scene) fn of_table(table: &ReadTable) -> Self {
        Self::new(table.values("q").iter().zip(table.values("C")).map(|(&q, &density)| [q, density]).collect())
    }
}

const STRAIN_ROLES: [Role; 3] = [
    Role::new(
        "strain",
        "strains, strain amplitude, shear strain, dynamic strain, peak strain, oscillation strain, gamma, γ, epsilon, ε, \
         dehnung",
        Dimension::Number,
    )
    .within(POSITIVE),
    Role::new(
        "storage",
        "storage factor, storage ratio, storage modulus ratio, relative storage modulus, E'/E'0, G'/G'0, E' ratio, G' \
         ratio",
        Dimension::Number,
    )
    .within(POSITIVE.up_to(1.0)),
    Role::new(
        "loss",
        "loss factor, loss ratio, loss modulus ratio, relative loss modulus, E''/E''0, G''/G''0, E'' ratio, G'' ratio",
        Dimension::Number,
    )
    .within(POSITIVE),
];
/// The file of a softening.
pub const SOFTENING: FileKind = FileKind {
    least: 2,
    rises: true,
    ..FileKind::new("a softening", &STRAIN_ROLES, "strain [1] or [%], and the factors on both moduli: storage, loss")
};

impl Softening {
    /// That of a file.
    pub(in crate::scene) fn of_table(table: &ReadTable) -> Self {
        let [strains, storage, loss] = ["strain", "storage", "loss"].map(|key| table.values(key));
        let row = |i: usize| SofteningRow {
            strain: strains[i],
            factors: ModulusFactors { storage: storage[i], loss: loss[i] },
        };
        Self::Table((0..strains.len()).map(row).collect())
    }
}
