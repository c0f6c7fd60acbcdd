//! A Prony series as a table: columns found by their names.

use super::{ModulusKind, WrittenSeries, WrittenTerm};
use crate::tables::{Choice, ContentError, Dimension, Format, NOT_NEGATIVE, POSITIVE, Table, UnitRule, Wanted, Words};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Quantity {
    Time,
    /// E_j.
    Modulus,
    /// G_j.
    ShearModulus,
    /// e_j = E_j/E_0, g_j = G_j/G_0.
    Relative,
    /// k_j = K_j/K_0.
    Bulk,
}

const SERIES: Format<Quantity, 3> = Format::new(
    &[
        Words::new(
            Quantity::Time,
            Dimension::Time,
            "relaxation tau τ time t zeit relaxationszeit tau1 taui tau_i τi",
            "relaxation time times rel i j k n relative constant",
        ),
        Words::new(
            Quantity::Relative,
            Dimension::Number,
            "relative rel normalised normalized g gi gp alpha α alphai e0 g0",
            "modulus moduli mod shear i j k n p prony ratio coefficient g e",
        ),
        Words::new(Quantity::Bulk, Dimension::Number, "k ki kp bulk", "i j n p prony ratio modulus relative rel k"),
        Words::new(
            Quantity::ShearModulus,
            Dimension::Pressure,
            "shear g gi gj gk",
            "modulus moduli i j k n shear maxwell relaxation",
        ),
        Words::new(
            Quantity::Modulus,
            Dimension::Pressure,
            "modulus moduli e ei ej ek stiffness modul strength",
            "i j k n young's young youngs tensile maxwell relaxation spring e",
        ),
        Words::new(Quantity::Modulus, Dimension::Pressure, "e1 e_i", ""),
    ],
    [
        Wanted::new(&[Quantity::Time], "relaxation_time", "relaxation times").within(POSITIVE),
        Wanted::new(&[Quantity::Modulus, Quantity::ShearModulus, Quantity::Relative], "modulus", "moduli")
            .within(NOT_NEGATIVE),
        Wanted {
            choice: Choice::First,
            unit: UnitRule::Ignored,
            ..Wanted::new(&[Quantity::Bulk], "bulk modulus", "bulk moduli").optional().within(NOT_NEGATIVE)
        },
    ],
    "a relaxation time and a modulus: relaxation_time [s], modulus [Pa]; tau_i, E_i, G_i, or relative to E_0: g_i, rel_mod",
);

/// Reads the only table of a text.
pub(super) fn read(text: &str) -> Result<WrittenSeries<'_>, ContentError> {
    let Table { columns, rows, lines, mut notes, line, above } = SERIES.read(text)?;
    let [_, modulus, bulk] = &columns;
    let term = |(&[time, modulus, share], line): (&[f64; 3], usize)| WrittenTerm {
        line,
        time,
        modulus,
        bulk: bulk.as_ref().map(|_| share),
    };
    let kind = match modulus.as_ref().map(|column| column.quantity) {
        Some(Quantity::Relative) => ModulusKind::Relative,
        Some(Quantity::ShearModulus) => ModulusKind::Shear,
        _ => ModulusKind::Tension,
    };
    // The notes of the first two columns, which a file must have, come first.
    let modulus_note = notes.remove(1);
    Ok(WrittenSeries {
        terms: rows.iter().zip(lines).map(term).collect(),
        kind,
        modulus_note,
        line,
        header: above,
        comment: "#",
        notes,
    })
}
