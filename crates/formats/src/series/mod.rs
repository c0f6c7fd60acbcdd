//! The file of a Prony series: relaxation times and moduli, absolute or relative to E_0, of tension or of shear; as a
//! table, or as cards of Abaqus and Ansys.

mod cards;
mod written;

use asperity::scene::ElasticConstants;
use asperity::tables::{
    ContentError, Dimension, FileKind, GivenColumns, NOT_NEGATIVE, POSITIVE, ReadTable, Role, UnitRule,
};

use crate::text::{decode, read};
use written::{ModulusKind, WrittenSeries, WrittenTerm};

const ROLES: [Role; 5] = [
    Role::new(
        "relaxation_time",
        "relaxation times, relaxation, time, times, t, tau, τ, tau i, tau j, tau k, tau n, τi, τj, t i, tau1, tau 1, rel \
         time, time constant, relaxationszeit, zeit",
        Dimension::Time,
    )
    .within(POSITIVE),
    Role::new(
        "modulus",
        "moduli, E, E_i, E_j, E_k, E_n, E1, young's modulus, youngs modulus, tensile modulus, maxwell modulus, relaxation \
         modulus, stiffness, spring stiffness, relaxation strength, modul",
        Dimension::Pressure,
    )
    .within(NOT_NEGATIVE)
    .optional(),
    Role::new(
        "shear_modulus",
        "shear moduli, G, G_i, G_j, G_k, G_n, shear relaxation modulus",
        Dimension::Pressure,
    )
    .within(NOT_NEGATIVE)
    .optional(),
    Role::new(
        "relative_modulus",
        "relative moduli, rel mod, rel modulus, normalised modulus, normalized modulus, relative shear modulus, prony \
         ratio, shear prony ratio, g, g_i, g_j, g_k, g_n, g_p, g_i prony, g i p, e_i/e_0, E/E0, g/g0, G/G0, alpha, alpha i, α, α_i",
        Dimension::Number,
    )
    .within(NOT_NEGATIVE)
    .optional(),
    Role {
        unit: UnitRule::Ignored,
        ..Role::new("bulk_modulus", "k, k_i, k_j, k_n, k_p, k i prony, bulk, bulk moduli, relative bulk modulus, bulk prony ratio", Dimension::Number)
            .within(NOT_NEGATIVE)
            .optional()
    },
];
/// What people write of a series.
pub const SERIES: FileKind = FileKind {
    one_of: &[&["modulus", "shear_modulus", "relative_modulus"]],
    ..FileKind::new(
        "a Prony series",
        &ROLES,
        "a relaxation time and a modulus: relaxation_time [s], modulus [Pa]; tau_i, E_i, G_i, or relative to E_0: g_i, \
         rel_mod",
    )
};

/// Reads a series from the bytes of a file: cards, or columns found by their names, with units; without names a
/// relaxation time in s and a modulus in Pa. The table has moduli of tension, in Pa.
pub(crate) fn read_series(
    bytes: &[u8],
    elastic: ElasticConstants,
    given: &GivenColumns,
) -> Result<ReadTable, ContentError> {
    let text = decode(bytes)?;
    let written = match cards::read(&text) {
        Some(written) => written?,
        None => table(&text, given)?,
    };
    written.convert(elastic)
}

/// Reads the only table of a text.
fn table<'a>(text: &'a str, given: &GivenColumns) -> Result<WrittenSeries<'a>, ContentError> {
    let (mut table, header) = read(text, &SERIES, given)?;
    let keys = [
        ("modulus", ModulusKind::Tension),
        ("shear_modulus", ModulusKind::Shear),
        ("relative_modulus", ModulusKind::Relative),
    ];
    let (column, kind) = keys
        .iter()
        .find_map(|(key, kind)| Some((table.column(key)?, *kind)))
        .unwrap_or((&table.columns[0], ModulusKind::Tension));
    let (times, bulk) = (table.values("relaxation_time"), table.column("bulk_modulus"));
    let term = |i: usize| WrittenTerm {
        line: table.lines[i],
        time: times[i],
        modulus: column.values[i],
        bulk: bulk.map(|bulk| bulk.values[i]),
    };
    let names_unit = column.names_unit;
    Ok(WrittenSeries {
        terms: (0..times.len()).map(term).collect(),
        kind,
        names_unit,
        line: table.line,
        header,
        comment: "#",
        notes: std::mem::take(&mut table.notes),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const ELASTIC: ElasticConstants = ElasticConstants { poisson_ratio: 0.5, equilibrium_modulus: 4e6 };

    fn read(text: &str) -> Result<Vec<[f64; 2]>, (Option<usize>, String)> {
        let series = read_series(text.as_bytes(), ELASTIC, &[]);
        let rows = |table: ReadTable| {
            let rows = table.values("relaxation_time").iter().zip(table.values("modulus"));
            rows.map(|(&time, &modulus)| [time, modulus]).collect()
        };
        series.map(rows).map_err(|error| (error.line, error.key))
    }

    #[test]
    fn columns_and_units_are_those_of_the_header() {
        let texts = [
            "1e-3,2e6\n10,5e5\n",
            "relaxation_time,modulus\n1e-3,2e6\n10,5e5\n",
            "relaxation_time [s]; modulus [Pa]\r\n0,001;2000000\r\n1e1;5e5\r\n",
            "# a compound\n\ntau E\n1e-3 2e6\n# long\n10\t5e5",
            "relaxation_time (ms), modulus (MPa)\n1,2\n10000,0.5\n",
            "E_i (Pa),tau_i (s)\n2e6,1e-3\n5e5,10\n",
            "i;τ_i [s];E_i [MPa]\n1;0,001;2\n2;10;0,5\n",
            "tau,G_i\ns,MPa\n1e-3,0.66666666666666666667\n10,0.16666666666666666667\n",
            "# E0 = 10 MPa\n# rel_mod, rel_time\n0.2,1e-3\n0.05,10\n",
            "# E0 = 10 MPa, relative\ntau_i [ms];e_i\n1;0,2\n10000;0,05\n",
            "# E0 = 10 MPa\n1e-3 0.2\n10 0.05\n",
            "# E0 = 10 MPa\ntau,E/E0\n1e-3,0.2\n10,0.05\n",
            "E_0 [MPa]: 10\ng_i,k_i,tau_i\n0.2,0,1e-3\n0.05,0,10\n",
        ];
        for text in texts {
            let found = read(text).unwrap_or_else(|error| unreachable!("{text:?}: {error:?}"));
            assert_eq!(found.len(), 2, "{text:?}");
            for (term, (time, modulus)) in found.iter().zip([(1e-3, 2e6), (10.0, 5e5)]) {
                // Rounding of the conversions.
                let close = |value: f64, wanted: f64| (value / wanted - 1.0).abs() < 1e-15;
                assert!(close(term[0], time) && close(term[1], modulus), "{text:?}: {found:?}");
            }
        }
    }

    /// A compound of E_0 = 10 MPa, as Abaqus' and Ansys' cards have it.
    #[test]
    fn cards_are_converted() {
        let texts = [
            "** E0 = 10 MPa\n*ELASTIC, MODULI=INSTANTANEOUS\n 10., 0.5\n*VISCOELASTIC, TIME=PRONY\n 0.2, 0., 0.001\n\
             0.05,, 10.\n*DENSITY\n1.1e-9,\n",
            "! E0 = 10 MPa\nMP,EX,1,10\nTB,PRONY,1,1,2,SHEAR\nTBDATA,1,0.2,1e-3\nTBDATA,3,0.05,10 ! slow\n",
            "! E0: 10 MPa\nTB,PRONY,1,,2,SHEAR\nTBDATA,,0.2,1e-3,0.05,10\nTB,PRONY,1,,1,BULK\nTBDATA,1,0.1,1\n",
        ];
        for text in texts {
            let found = read(text).unwrap_or_else(|error| unreachable!("{text:?}: {error:?}"));
            let expected = [(1e-3, 2e6), (10.0, 5e5)].map(|(time, modulus)| [time, modulus]);
            assert_eq!(found, expected, "{text:?}");
        }
        for (text, line, key) in [
            ("*Viscoelastic, time=PRONY\n0.2,0,1\n", 1, "E0"),
            ("*Viscoelastic, time=CREEP TEST DATA\n0.2,0,1\n", 1, "card"),
            ("**E0=1MPa\n*Viscoelastic, time=PRONY\n0.2,1\n", 3, "columns"),
            ("**E0=1MPa\n*Viscoelastic, time=PRONY\n2,0,1\n", 3, "modulus"),
            ("!E0=1MPa\nTB,PRONY,1,1,2,SHEAR\nTBDATA,1,0.2\n", 3, "constants"),
            ("!E0=1MPa\nTB,PRONY,1,1,2,SHEAR\nTBDATA,3,0.2,1\n", 3, "TBDATA"),
            (
                "**E0=1MPa\n*Material, name=A\n*Viscoelastic, time=PRONY\n0.2,0,1\n*Material, name=B\n\
                 *Viscoelastic, time=PRONY\n0.3,0,1\n",
                6,
                "card",
            ),
            ("!E0=1MPa\nTB,PRONY,1,1,1,SHEAR\nTBDATA,1,0.2,1\nTB,PRONY,2,1,1,SHEAR\nTBDATA,1,0.3,1\n", 4, "card"),
        ] {
            assert_eq!(read(text), Err((Some(line), key.to_owned())), "{text}");
        }
    }

    /// The shift is that of the scene; bulk moduli do not relax.
    #[test]
    fn what_of_cards_is_not_taken_is_said() {
        let said = |text: &str| {
            let series = read_series(text.as_bytes(), ELASTIC, &[]).unwrap_or_else(|error| unreachable!("{error}"));
            let notes = series.notes.into_iter().filter(|note| note.assumed).map(|note| note.text);
            notes.filter(|text| text.contains("not taken")).collect::<Vec<_>>()
        };
        let abaqus =
            said("** E0 = 5 MPa\n*Viscoelastic, time=PRONY\n0.2,0.2,1.\n* TRS, definition=WLF\n20., 8.86, 101.6\n");
        assert!(abaqus.len() == 1 && abaqus[0].starts_with("line 4 (* TRS, definition=WLF), the shift"), "{abaqus:?}");
        assert!(
            abaqus[0].ends_with("write material.wlf = { c1, c2, reference_temperature, temperature }"),
            "{abaqus:?}"
        );
        let ansys = said(
            "! E0 = 5 MPa\nTB,PRONY,1,1,1,SHEAR\nTBDATA,1,0.2,1\ntb, prony,1,1,1,bulk\nTBDATA,1,0.3,5.0\n\
             TB,SHIFT,1,1,3,WLF\nTBDATA,1,293.15,8.86,101.6\n",
        );
        assert!(ansys.len() == 2 && ansys[0].contains("TB,SHIFT") && ansys[1].contains("bulk"), "{ansys:?}");
    }

    #[test]
    fn refuses_what_is_no_series() {
        for (text, line, key) in [
            ("", 1, "rows"),
            ("tau,E\n", 1, "rows"),
            ("tau,E\n1,2\n0,3\n", 3, "column 1 \"tau\""),
            ("1,2\n2,-3\n", 2, "column 2"),
            ("1,2,3\n", 1, "columns"),
            ("tau [fortnights],E [Pa]\n1,2\n", 1, "unit of column 1 \"tau [fortnights]\""),
            ("tau [s],E [mPa]\n1,2\n", 1, "unit of column 2 \"E [mPa]\""),
            ("a,b\n1,2\n", 1, "columns"),
            ("g_i,k_i,tau_i\n0.5,0,1\n", 1, "E0"),
            ("# E0 = 64\n# rel_mod, rel_time\n0.5,1\n", 1, "E0"),
            ("g,tau\n0.5,1\n0.6,2\n", 1, "relative moduli"),
            ("1e-3,0.4\n1,0.5\n", 1, "modulus"),
            ("tau,E\n1e-3,30\n1,20\n", 1, "modulus"),
            ("# times in ms\ntau,E [MPa]\n1,2\n", 1, "unit"),
            ("tau;E\n1,5;2e6\n2.5;1e6\n", 3, "column 1 \"tau\""),
            ("\"tau [s]\",\"E [Pa]\"\n\"1\",0,2e6\n\"2\",1,1e6\n", 1, "columns"),
            ("1\0,2\n", 1, ""),
        ] {
            assert_eq!(read(text), Err((Some(line), key.to_owned())), "{text}");
        }
    }
}
