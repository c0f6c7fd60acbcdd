//! A Prony series as a table: columns found by their names.

use super::{ModulusKind, WrittenSeries, WrittenTerm, note};
use crate::scene::column_file::check_stated;
use crate::scene::error::ContentError;
use crate::scene::keys;
use crate::scene::profile::ReadingNote;
use crate::tables::{Block, Dimension, Heading, HeadingUnit, Line, NumberStyle, Unit, Words};

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

const VOCABULARY: [Words<Quantity>; 6] = [
    Words::new(
        Quantity::Time,
        Dimension::Time,
        &["relaxation", "tau", "τ", "time", "t", "zeit", "relaxationszeit", "tau1", "taui", "tau_i", "τi"],
        &["relaxation", "time", "times", "rel", "i", "j", "k", "n", "relative", "constant"],
    ),
    Words::new(
        Quantity::Relative,
        Dimension::Number,
        &["relative", "rel", "normalised", "normalized", "g", "gi", "gp", "alpha", "α", "alphai", "e0", "g0"],
        &["modulus", "moduli", "mod", "shear", "i", "j", "k", "n", "p", "prony", "ratio", "coefficient", "g", "e"],
    ),
    Words::new(
        Quantity::Bulk,
        Dimension::Number,
        &["k", "ki", "kp", "bulk"],
        &["i", "j", "n", "p", "prony", "ratio", "modulus", "relative", "rel", "k"],
    ),
    Words::new(
        Quantity::ShearModulus,
        Dimension::Pressure,
        &["shear", "g", "gi", "gj", "gk"],
        &["modulus", "moduli", "i", "j", "k", "n", "shear", "maxwell", "relaxation"],
    ),
    Words::new(
        Quantity::Modulus,
        Dimension::Pressure,
        &["modulus", "moduli", "e", "ei", "ej", "ek", "stiffness", "modul", "strength"],
        &["i", "j", "k", "n", "young's", "young", "youngs", "tensile", "maxwell", "relaxation", "spring", "e"],
    ),
    Words::new(Quantity::Modulus, Dimension::Pressure, &["e1", "e_i"], &[]),
];

const EXPECTED: &str = "a relaxation time and a modulus: relaxation_time [s], modulus [Pa]; tau_i, E_i, G_i, or \
                        relative to E_0: g_i, rel_mod";

/// Reads the only table of a text.
pub(super) fn read(text: &str) -> Result<WrittenSeries<'_>, ContentError> {
    let blocks = Block::all(text, false);
    let Some(block) = blocks.iter().max_by_key(|block| block.rows) else {
        let last = text.lines().count().max(1);
        return Err(ContentError::value(Some(last), "terms", "0", "at least one term"));
    };
    if let Some(other) = blocks.iter().find(|other| other.first != block.first && other.columns > 1) {
        let given = format!("from line {} and from line {}", other.first, block.first);
        return Err(ContentError::value(Some(other.first), "tables", &given, "one series"));
    }
    let columns = Columns::find(block)?;
    let mut rows = Rows { columns: &columns, style: NumberStyle::of(block) };
    let terms = block.lines(text).map(|line| rows.read(line, block)).collect::<Result<_, _>>()?;
    let kind = match columns.kind {
        Quantity::Relative => ModulusKind::Relative,
        Quantity::ShearModulus => ModulusKind::Shear,
        _ => ModulusKind::Tension,
    };
    Ok(WrittenSeries {
        terms,
        kind,
        modulus_note: columns.modulus_note,
        line: columns.line,
        header: block.above.clone(),
        comment: "#",
        notes: vec![columns.time_note],
    })
}

/// Places, counted from 0, and units of the columns.
#[derive(Debug)]
struct Columns {
    time: (usize, Unit),
    modulus: (usize, Unit),
    kind: Quantity,
    bulk: Option<usize>,
    line: Option<usize>,
    time_note: ReadingNote,
    modulus_note: ReadingNote,
}

impl Columns {
    fn find(block: &Block<'_>) -> Result<Self, ContentError> {
        let head = block.head(&|name| Heading::parse(name, &VOCABULARY).is_some());
        if head.names.is_empty() {
            return Self::unnamed(block);
        }
        let headings: Vec<(usize, Heading<Quantity>)> =
            head.headings(&VOCABULARY).into_iter().enumerate().filter_map(|(i, heading)| Some((i, heading?))).collect();
        let all = |wanted: &[Quantity]| -> Vec<&(usize, Heading<Quantity>)> {
            headings.iter().filter(|(_, heading)| wanted.contains(&heading.quantity)).collect()
        };
        let given = format!("`{}`", head.names.join(", ").chars().take(60).collect::<String>());
        let refuse = |expected: &str| ContentError::value(head.line, "columns", &given, expected);
        let moduli = all(&[Quantity::Modulus, Quantity::ShearModulus, Quantity::Relative]);
        let (&[time], &[modulus]) = (&all(&[Quantity::Time])[..], &moduli[..]) else { return Err(refuse(EXPECTED)) };
        if time.1.logarithm.or(modulus.1.logarithm).is_some() {
            return Err(refuse("numbers, not their logarithms"));
        }
        let unit = |(i, heading): &(usize, Heading<Quantity>), what: &str| {
            let name = format!("column {} ({})", i + 1, head.names[*i].trim());
            let (unit, said) = match &heading.unit {
                HeadingUnit::Known(unit) => (*unit, format!(" in {unit}")),
                HeadingUnit::None if heading.dimension == Dimension::Number => (Unit::ONE, String::new()),
                HeadingUnit::None => {
                    check_stated(block, heading.dimension, example(heading.dimension), head.line)?;
                    let unit = Unit::si(heading.dimension);
                    (unit, format!(", which names no unit: {unit} is assumed"))
                }
                HeadingUnit::Unknown(unit) => {
                    let expected = format!("one of {}", heading.dimension.units());
                    return Err(ContentError::value(head.line, "unit", &format!("\"{unit}\" of {name}"), &expected));
                }
            };
            let assumed = heading.unit == HeadingUnit::None && heading.dimension != Dimension::Number;
            Ok(((*i, unit), note(format!("{what} from {name}{said}"), assumed)))
        };
        let kind = modulus.1.quantity;
        let (time, time_note) = unit(time, "relaxation times")?;
        let (modulus, modulus_note) = unit(modulus, "moduli")?;
        Ok(Self {
            time,
            modulus,
            kind,
            bulk: all(&[Quantity::Bulk]).first().map(|(i, _)| *i),
            line: head.line,
            time_note,
            modulus_note,
        })
    }

    /// Without names: two columns.
    fn unnamed(block: &Block<'_>) -> Result<Self, ContentError> {
        if block.columns != 2 {
            let expected = format!("{EXPECTED}; without names two columns, relaxation_time in s and modulus in Pa");
            return Err(ContentError::value(Some(block.first), "columns", &block.columns.to_string(), &expected));
        }
        check_stated(block, Dimension::Time, example(Dimension::Time), None)?;
        check_stated(block, Dimension::Pressure, example(Dimension::Pressure), None)?;
        Ok(Self {
            time: (0, Unit::si(Dimension::Time)),
            modulus: (1, Unit::si(Dimension::Pressure)),
            kind: Quantity::Modulus,
            bulk: None,
            line: None,
            time_note: note("no names: relaxation times in s, from the first column, are assumed", true),
            modulus_note: note("no names: moduli in Pa, from the second column, are assumed", true),
        })
    }
}

/// The name of a column, as an example.
fn example(dimension: Dimension) -> &'static str {
    if dimension == Dimension::Time { "tau" } else { "E" }
}

/// Reads rows.
struct Rows<'c> {
    columns: &'c Columns,
    style: NumberStyle,
}

impl Rows<'_> {
    fn read(&mut self, (line, row): Line<'_>, block: &Block<'_>) -> Result<WrittenTerm, ContentError> {
        let fields = block.separator.split(row);
        let mut value = |(column, unit): (usize, Unit), name: &str| {
            let field = fields.get(column).map_or("", |field| field);
            let given = || format!("\"{}\"", field.chars().take(60).collect::<String>());
            let refuse = |expected: &str| ContentError::value(Some(line), name, &given(), expected);
            let written = self.style.read(field).map_err(|_| refuse(NumberStyle::EXPECTED))?;
            let range = keys::range_of(&format!("material.prony.{name}"));
            let value = written.map(|written| unit.to_si(written)).filter(|value| range.holds(*value));
            value.ok_or_else(|| refuse(&range.to_string()))
        };
        Ok(WrittenTerm {
            line,
            time: value(self.columns.time, "relaxation_time")?,
            modulus: value(self.columns.modulus, "modulus")?,
            bulk: self.columns.bulk.map(|column| value((column, Unit::ONE), "modulus")).transpose()?,
        })
    }
}
