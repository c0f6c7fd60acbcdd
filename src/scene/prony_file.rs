//! The file of a Prony series: relaxation times and moduli, absolute or relative to E_0, of tension or of shear.

use super::PronyTerm;
use super::error::ContentError;
use super::keys;
use super::profile::ReadingNote;
use super::text_table::{
    Block, Dimension, Heading, HeadingUnit, Line, NumberStyle, Unit, Words, decode, number, plain, words,
};

/// What relates the moduli of a file to those of the scene.
#[derive(Clone, Copy, Debug)]
pub(super) struct ElasticConstants {
    pub(super) poisson_ratio: f64,
    /// E_∞, Pa.
    pub(super) equilibrium_modulus: f64,
}

/// A series, and how it was read.
#[derive(Debug)]
pub(super) struct PronySeries {
    pub(super) terms: Vec<PronyTerm>,
    pub(super) notes: Vec<ReadingNote>,
}

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

const fn quantity(
    quantity: Quantity,
    dimension: Dimension,
    key_words: &'static [&'static str],
    other_words: &'static [&'static str],
) -> Words<Quantity> {
    Words { quantity, dimension, key_words, other_words }
}

const VOCABULARY: [Words<Quantity>; 6] = [
    quantity(
        Quantity::Time,
        Dimension::Time,
        &["relaxation", "tau", "τ", "time", "t", "zeit", "relaxationszeit", "tau1", "taui", "tau_i", "τi"],
        &["relaxation", "time", "times", "rel", "i", "j", "k", "n", "relative", "constant"],
    ),
    quantity(
        Quantity::Relative,
        Dimension::Number,
        &["relative", "rel", "normalised", "normalized", "g", "gi", "gp", "alpha", "α", "alphai"],
        &["modulus", "moduli", "mod", "shear", "i", "j", "k", "n", "p", "prony", "ratio", "coefficient", "g", "e"],
    ),
    quantity(
        Quantity::Bulk,
        Dimension::Number,
        &["k", "ki", "kp", "bulk"],
        &["i", "j", "n", "p", "prony", "ratio", "modulus", "relative", "rel", "k"],
    ),
    quantity(
        Quantity::ShearModulus,
        Dimension::Pressure,
        &["shear", "g", "gi", "gj", "gk"],
        &["modulus", "moduli", "i", "j", "k", "n", "shear", "maxwell", "relaxation"],
    ),
    quantity(
        Quantity::Modulus,
        Dimension::Pressure,
        &["modulus", "moduli", "e", "ei", "ej", "ek", "stiffness", "modul", "strength"],
        &["i", "j", "k", "n", "young's", "young", "youngs", "tensile", "maxwell", "relaxation", "spring", "e"],
    ),
    quantity(Quantity::Modulus, Dimension::Pressure, &["e1", "e_i"], &[]),
];

const EXPECTED: &str = "a relaxation time and a modulus: relaxation_time [s], modulus [Pa]; tau_i, E_i, G_i, or relative to \
                        E_0: e_i, g_i, rel_mod";

impl PronySeries {
    /// Reads a series from the bytes of a file: columns found by their names, with units; without names a relaxation time
    /// in s and a modulus in Pa.
    pub(super) fn parse(bytes: &[u8], elastic: ElasticConstants) -> Result<Self, ContentError> {
        let text = decode(bytes).map_err(|error| ContentError::new(Some(1), "", error))?;
        let blocks = Block::all(&text, false);
        let Some(block) = blocks.iter().max_by_key(|block| block.rows) else {
            let last = text.lines().count().max(1);
            return Err(ContentError::value(Some(last), "terms", "0", "at least one term"));
        };
        if let Some(other) = blocks.iter().find(|other| other.first != block.first && other.columns > 1) {
            let given = format!("from line {} and from line {}", other.first, block.first);
            return Err(ContentError::value(Some(other.first), "tables", &given, "one series"));
        }
        let columns = Columns::find(block)?;
        let mut rows = Rows { columns: &columns, style: NumberStyle::default() };
        let written: Vec<Written> = block.lines(&text).map(|line| rows.read(line, block)).collect::<Result<_, _>>()?;
        columns.convert(block, &written, elastic)
    }
}

/// A row as it stands in the file, the time in s.
#[derive(Clone, Copy, Debug)]
struct Written {
    line: usize,
    time: f64,
    modulus: f64,
    bulk: Option<f64>,
}

#[derive(Debug)]
struct Columns {
    time: (usize, Unit),
    modulus: (usize, Unit),
    kind: Quantity,
    bulk: Option<usize>,
    header: Option<usize>,
    notes: Vec<ReadingNote>,
}

impl Columns {
    fn find(block: &Block<'_>) -> Result<Self, ContentError> {
        let head = block.head(&|name| Heading::parse(name, &VOCABULARY).is_some());
        if head.names.is_empty() {
            return Self::unnamed(block);
        }
        let unit_below = |i: usize| head.units.get(i).map_or("", |unit| unit);
        let read = |i: usize| Heading::with_unit(&head.names[i], unit_below(i), &VOCABULARY);
        let headings: Vec<Option<Heading<Quantity>>> = (0..head.names.len()).map(read).collect();
        let all = |wanted: &[Quantity]| -> Vec<usize> {
            let is_it = |i: &usize| headings[*i].as_ref().is_some_and(|heading| wanted.contains(&heading.quantity));
            (0..headings.len()).filter(is_it).collect()
        };
        let given = format!("`{}`", head.names.join(", ").chars().take(60).collect::<String>());
        let refuse = |expected: &str| ContentError::value(head.line, "columns", &given, expected);
        let [time] = all(&[Quantity::Time])[..] else { return Err(refuse(EXPECTED)) };
        let moduli = all(&[Quantity::Modulus, Quantity::ShearModulus, Quantity::Relative]);
        let [modulus] = moduli[..] else { return Err(refuse(EXPECTED)) };
        let heading = |i: usize| {
            headings[i]
                .as_ref()
                .map_or((Quantity::Time, HeadingUnit::None), |heading| (heading.quantity, heading.unit.clone()))
        };
        if [time, modulus].iter().any(|&i| headings[i].as_ref().is_some_and(|heading| heading.logarithm.is_some())) {
            return Err(refuse("numbers, not their logarithms"));
        }
        let kind = heading(modulus).0;
        let mut notes = Vec::new();
        let mut unit = |i: usize, dimension: Dimension, what: &str| {
            let name = format!("column {} ({})", i + 1, head.names[i].trim());
            match heading(i).1 {
                HeadingUnit::Known(unit) => {
                    notes.push(ReadingNote { text: format!("{what} from {name} in {unit}"), assumed: false });
                    Ok(unit)
                }
                HeadingUnit::None => {
                    let unit = Unit::si(dimension);
                    let assumed = dimension != Dimension::Number;
                    let why = if assumed { format!(", which names no unit: {unit} is assumed") } else { String::new() };
                    notes.push(ReadingNote { text: format!("{what} from {name}{why}"), assumed });
                    Ok(unit)
                }
                HeadingUnit::Unknown(unit) => {
                    let expected = format!("one of {}", dimension.units());
                    Err(ContentError::value(head.line, "unit", &format!("\"{unit}\" of {name}"), &expected))
                }
            }
        };
        let time = (time, unit(time, Dimension::Time, "relaxation times")?);
        let dimension = if kind == Quantity::Relative { Dimension::Number } else { Dimension::Pressure };
        let modulus = (modulus, unit(modulus, dimension, "moduli")?);
        let bulk = all(&[Quantity::Bulk]).first().copied();
        Ok(Self { time, modulus, kind, bulk, header: head.line, notes })
    }

    /// Without names: two columns.
    fn unnamed(block: &Block<'_>) -> Result<Self, ContentError> {
        if block.columns != 2 {
            let expected = format!("{EXPECTED}; without names two columns, relaxation_time in s and modulus in Pa");
            return Err(ContentError::value(Some(block.first), "columns", &block.columns.to_string(), &expected));
        }
        let text = "no names: relaxation times in s and moduli in Pa are assumed".to_owned();
        Ok(Self {
            time: (0, Unit::si(Dimension::Time)),
            modulus: (1, Unit::si(Dimension::Pressure)),
            kind: Quantity::Modulus,
            bulk: None,
            header: None,
            notes: vec![ReadingNote { text, assumed: true }],
        })
    }

    /// The terms: moduli of tension in Pa.
    fn convert(
        &self,
        block: &Block<'_>,
        written: &[Written],
        elastic: ElasticConstants,
    ) -> Result<PronySeries, ContentError> {
        let mut notes = self.notes.clone();
        let shear = 2.0 * (1.0 + elastic.poisson_ratio);
        let factor = match self.kind {
            Quantity::Relative => self.instantaneous_modulus(block, written, elastic, &mut notes)?,
            Quantity::ShearModulus => {
                let text = format!("moduli of shear: E = 2(1 + ν) G with the scene's ν = {}", elastic.poisson_ratio);
                notes.push(ReadingNote { text, assumed: false });
                shear
            }
            _ => 1.0,
        };
        self.check_absolute(written)?;
        let differs = |row: &Written| row.bulk.is_some_and(|bulk| bulk != row.modulus);
        if self.kind == Quantity::Relative && written.iter().any(differs) {
            let text = "bulk moduli (k_i) are not used: the model's Poisson's ratio does not relax".to_owned();
            notes.push(ReadingNote { text, assumed: true });
        }
        let range = keys::range_of("material.prony.modulus");
        let term = |row: &Written| {
            let modulus = self.modulus.1.to_si(row.modulus) * factor;
            let given = format!("\"{}\"", row.modulus);
            let error = || ContentError::value(Some(row.line), "modulus", &given, &range.to_string());
            if range.holds(modulus) { Ok(PronyTerm { relaxation_time: row.time, modulus }) } else { Err(error()) }
        };
        Ok(PronySeries { terms: written.iter().map(term).collect::<Result<_, _>>()?, notes })
    }

    /// E_0 of relative moduli, from the header: nothing else says it well enough.
    fn instantaneous_modulus(
        &self,
        block: &Block<'_>,
        written: &[Written],
        elastic: ElasticConstants,
        notes: &mut Vec<ReadingNote>,
    ) -> Result<f64, ContentError> {
        let sum: f64 = written.iter().map(|row| self.modulus.1.to_si(row.modulus)).sum();
        let relaxed = elastic.equilibrium_modulus;
        if !(0.0..=1.0).contains(&sum) {
            let expected = "relative moduli whose sum is at most 1: what relaxes of E_0";
            return Err(ContentError::value(self.header, "relative moduli", &format!("a sum of {sum}"), expected));
        }
        let setting = block.above.iter().find_map(|&line| instantaneous(line));
        let Some((line, name, is_shear, value, unit)) = setting else {
            let follows = if sum < 1.0 {
                format!(
                    "; equilibrium_modulus/(1 - Σ) would be {:.3e} Pa, as exact as the digits of 1 - {sum:.6}",
                    relaxed / (1.0 - sum)
                )
            } else {
                String::new()
            };
            let expected = format!("E_0, to which relative moduli refer, in the header: # E0 = 64 MPa{follows}");
            return Err(ContentError::value(self.header, "E0", "not given", &expected));
        };
        let Some(unit) = unit else {
            return Err(ContentError::value(
                Some(line),
                &name,
                &value.to_string(),
                &format!("a unit: one of {}", Dimension::Pressure.units()),
            ));
        };
        let modulus = unit.to_si(value) * if is_shear { 2.0 * (1.0 + elastic.poisson_ratio) } else { 1.0 };
        notes.push(ReadingNote {
            text: format!("moduli are relative to {name} = {value} {unit} of line {line}"),
            assumed: false,
        });
        let left = modulus * (1.0 - sum);
        /// Share of E_0 that rounded relative moduli leave open.
        const ROUNDING: f64 = 0.01;
        if (left - relaxed).abs() > ROUNDING * modulus {
            let text =
                format!("{name} and the relative moduli leave E_inf = {left:.4e} Pa, the scene has {relaxed:.4e} Pa");
            notes.push(ReadingNote { text, assumed: true });
        }
        Ok(modulus)
    }

    /// Refuses moduli that name no unit and look relative.
    fn check_absolute(&self, written: &[Written]) -> Result<(), ContentError> {
        let is_assumed = self.kind != Quantity::Relative && self.notes.iter().any(|note| note.assumed);
        let sum: f64 = written.iter().map(|row| row.modulus).sum();
        let small = written.iter().all(|row| row.modulus < 1.0) && sum <= 1.0 && sum > 0.0;
        let has_unit = self.notes.iter().any(|note| !note.assumed && note.text.starts_with("moduli"));
        if is_assumed && small && !has_unit {
            let expected = "moduli in Pa with a header that says so, modulus [Pa]; relative ones are named rel_mod, beside # E0 = … MPa";
            return Err(ContentError::value(
                self.header.or(written.first().map(|row| row.line)),
                "modulus",
                &format!("at most 1, {sum} in all"),
                expected,
            ));
        }
        Ok(())
    }
}

/// Reads rows.
struct Rows<'c> {
    columns: &'c Columns,
    style: NumberStyle,
}

impl Rows<'_> {
    fn read(&mut self, (line, row): Line<'_>, block: &Block<'_>) -> Result<Written, ContentError> {
        let fields = block.separator.split(row);
        let mut value = |column: usize, name: &str| {
            let field = fields.get(column).map_or("", |field| field);
            let value = number(field, block.separator.allows_decimal_comma());
            if value.is_some() && !self.style.add(field) {
                let expected = "numbers with decimal points or with decimal commas, not both in one file";
                return Err(ContentError::value(Some(line), name, &format!("\"{field}\""), expected));
            }
            let range = keys::range_of(&format!("material.prony.{name}"));
            let given = || format!("\"{}\"", field.chars().take(60).collect::<String>());
            let error = || ContentError::value(Some(line), name, &given(), &range.to_string());
            value.filter(|value| range.holds(*value)).ok_or_else(error)
        };
        let time = value(self.columns.time.0, "relaxation_time")?;
        let modulus = value(self.columns.modulus.0, "modulus")?;
        let bulk = self.columns.bulk.map(|column| value(column, "modulus")).transpose()?;
        let seconds = self.columns.time.1.to_si(time);
        let range = keys::range_of("material.prony.relaxation_time");
        if !range.holds(seconds) {
            return Err(ContentError::value(
                Some(line),
                "relaxation_time",
                &format!("{seconds:?} s"),
                &range.to_string(),
            ));
        }
        Ok(Written { line, time: seconds, modulus, bulk })
    }
}

/// Of a line such as `E0 = 64 MPa`, `E_0: 64 MPa`, `G0 [MPa] = 21`: its number and name, whether it is of shear, the value.
fn instantaneous((line, text): Line<'_>) -> Option<(usize, String, bool, f64, Option<Unit>)> {
    let text = plain(text);
    let (name, value) = text.split_once(['=', ':', ';', ',', '\t'])?;
    let heads = words(name);
    const NAMES: [&str; 10] = [
        "e0",
        "e 0",
        "g0",
        "g 0",
        "instantaneous modulus",
        "glassy modulus",
        "instantaneous shear modulus",
        "einst",
        "e inst",
        "e glassy",
    ];
    let (bare, bracketed) = match name.rsplit_once(['[', '(']) {
        Some((bare, unit)) => (words(bare).join(" "), Unit::parse(unit)),
        None => (heads.join(" "), None),
    };
    let found = NAMES.iter().find(|known| **known == bare)?;
    let value = value.trim();
    let end = value.find(|letter: char| letter.is_whitespace() || letter.is_alphabetic() && !"eE".contains(letter));
    let (digits, unit) = value.split_at(end.unwrap_or(value.len()));
    let unit = Unit::parse(unit.trim()).or(bracketed).filter(|unit| unit.dimension == Dimension::Pressure);
    let is_shear = found.starts_with('g') && *found != "glassy modulus" || found.contains("shear");
    Some((line, name.trim().to_owned(), is_shear, number(digits.trim(), true)?, unit))
}

#[cfg(test)]
mod tests {
    use super::*;

    const ELASTIC: ElasticConstants = ElasticConstants { poisson_ratio: 0.5, equilibrium_modulus: 4e6 };

    fn read(text: &str) -> Result<Vec<PronyTerm>, (Option<usize>, String)> {
        let series = PronySeries::parse(text.as_bytes(), ELASTIC);
        series.map(|series| series.terms).map_err(|error| (error.line, error.problem.about(&error.key)))
    }

    fn assumptions(text: &str) -> usize {
        let series = PronySeries::parse(text.as_bytes(), ELASTIC);
        series.map_or(99, |series| series.notes.iter().filter(|note| note.assumed).count())
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
            "E_0 [MPa]: 10\ng_i,k_i,tau_i\n0.2,0,1e-3\n0.05,0,10\n",
        ];
        for text in texts {
            let found = read(text).unwrap_or_else(|error| unreachable!("{text:?}: {error:?}"));
            assert_eq!(found.len(), 2, "{text:?}");
            for (term, (time, modulus)) in found.iter().zip([(1e-3, 2e6), (10.0, 5e5)]) {
                // Rounding of the conversions.
                let close = |value: f64, wanted: f64| (value / wanted - 1.0).abs() < 1e-15;
                assert!(close(term.relaxation_time, time) && close(term.modulus, modulus), "{text:?}: {found:?}");
            }
        }
        assert_eq!(texts.map(assumptions), [1, 2, 0, 2, 0, 0, 0, 0, 2, 3]);
    }

    #[test]
    fn refuses_what_is_no_series() {
        let cases = [
            ("", 1, "terms = 0: expected at least one term"),
            ("tau,E\n", 1, "terms = 0: expected at least one term"),
            ("tau,E\n1,2\n0,3\n", 3, "relaxation_time = \"0\": expected a number from 1e-30 to 1e30"),
            ("1,2\n2,-3\n", 2, "modulus = \"-3\": expected 0 or a number from 1e-30 to 1e30"),
            ("1,2,3\n", 1, "columns = 3: expected a relaxation time and a modulus"),
            (
                "tau [fortnights],E [Pa]\n1,2\n",
                1,
                "unit = \"fortnights\" of column 1 (tau [fortnights]): expected one of s, ms",
            ),
            ("tau [s],E [mPa]\n1,2\n", 1, "unit = \"mPa\" of column 2 (E [mPa]): expected one of Pa, kPa"),
            ("a,b\n1,2\n", 1, "columns = `a, b`: expected a relaxation time and a modulus"),
            ("g_i,k_i,tau_i\n0.5,0,1\n", 1, "E0 = not given: expected E_0, to which relative moduli refer"),
            ("# E0 = 64\n# rel_mod, rel_time\n0.5,1\n", 1, "E0 = 64: expected a unit: one of Pa"),
            ("g,tau\n0.5,1\n0.6,2\n", 1, "relative moduli = a sum of 1.1: expected relative moduli"),
            ("1e-3,0.4\n1,0.5\n", 1, "modulus = at most 1, 0.9 in all: expected moduli in Pa"),
            ("tau;E\n1,5;2e6\n2.5;1e6\n", 3, "relaxation_time = \"2.5\": expected numbers with decimal points or"),
            ("1\0,2\n", 1, "bytes that are zero: expected text in UTF-8, UTF-16 or Latin-1"),
        ];
        for (text, line, message) in cases {
            let (found, error) = read(text).err().unwrap_or_default();
            assert!(found == Some(line) && error.starts_with(message), "{text:?}: {found:?} {error}");
        }
    }
}
