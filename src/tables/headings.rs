//! Headings of columns: from `Storage Modulus (E') [MPa]` to a quantity and its unit.
//!
//! What a table may hold is a vocabulary: the words by which each quantity is known. A heading names a quantity if it
//! has one of its key words and no word beside its key and other words. It may also say what holds for all of its column:
//! `E' [MPa] @ 20 °C`.

use std::borrow::Cow;
use std::ops::Range;

use super::numbers::number;
use super::units::{Dimension, Unit};

/// The words of a quantity's names, in lower case, with blanks between them.
#[derive(Clone, Copy, Debug)]
pub struct Words<Q: 'static> {
    /// What they name.
    pub quantity: Q,
    /// What its unit measures.
    pub dimension: Dimension,
    /// One of these must be there; those of `s+mu` both.
    pub key_words: &'static str,
    /// These may stand beside it.
    pub other_words: &'static str,
}

impl<Q: Copy> Words<Q> {
    /// The words of a quantity: one of the `key_words` must be in a name, the `other_words` may be.
    pub const fn new(quantity: Q, dimension: Dimension, key_words: &'static str, other_words: &'static str) -> Self {
        Self { quantity, dimension, key_words, other_words }
    }
}

/// A heading whose quantity is known.
#[derive(Clone, Debug, PartialEq)]
pub struct Heading<Q> {
    /// What the column holds.
    pub quantity: Q,
    /// What its unit measures.
    pub dimension: Dimension,
    /// The unit beside the name.
    pub unit: HeadingUnit,
    /// The column holds the logarithm to this base of its numbers.
    pub logarithm: Option<f64>,
}

/// The unit in a heading.
#[derive(Clone, Debug, PartialEq)]
pub enum HeadingUnit {
    /// None is named.
    None,
    /// One that is known.
    Known(Unit),
    /// Something stands where a unit would.
    Unknown(String),
}

impl HeadingUnit {
    /// The unit, where one is named.
    ///
    /// # Errors
    /// The text of one that is not known.
    pub fn known(&self) -> Result<Option<Unit>, &str> {
        match self {
            Self::None => Ok(None),
            Self::Known(unit) => Ok(Some(*unit)),
            Self::Unknown(text) => Err(text),
        }
    }

    /// The unit of a dimension beside a name, whatever that is, or in a line of units below it.
    pub fn beside(name: &str, below: &str, dimension: Dimension) -> Self {
        let text = plain(&with_unit_below(name, below));
        let all = || splits(&text).filter_map(|(_, place)| unit_of(place, dimension));
        let is_known = |unit: &Self| matches!(unit, Self::Known(_));
        all().find(is_known).or_else(|| all().next()).unwrap_or(Self::None)
    }
}

impl<Q: Copy + PartialEq> Heading<Q> {
    /// What `text` names, if that is in the vocabulary.
    pub fn parse(text: &str, vocabulary: &[Words<Q>]) -> Option<Self> {
        let text = plain(text);
        let (text, logarithm) = without_logarithm(&text);
        let all = || splits(text).flat_map(|(name, place)| readings(name, place, vocabulary));
        // A symbol in parentheses is part of the name: tan(d), Storage modulus (E'). And one letter may name several
        // quantities: t [s], t [°C].
        let is_known = |(_, unit): &(&Words<Q>, HeadingUnit)| !matches!(unit, HeadingUnit::Unknown(_));
        let (words, unit) = all().find(is_known).or_else(|| all().next())?;
        Some(Self { quantity: words.quantity, dimension: words.dimension, unit, logarithm })
    }

    /// The heading with a unit from a line below it.
    pub fn with_unit(text: &str, unit: &str, vocabulary: &[Words<Q>]) -> Option<Self> {
        Self::parse(&with_unit_below(text, unit), vocabulary)
    }
}

/// A name with the unit that stands in the line below it, if any does.
fn with_unit_below<'t>(name: &'t str, unit: &str) -> Cow<'t, str> {
    let bare = unit.trim().trim_start_matches(['[', '(', '<']).trim_end_matches([']', ')', '>']);
    if bare.is_empty() { Cow::Borrowed(name) } else { Cow::Owned(format!("{name} [{bare}]")) }
}

/// What a name and the text at the place of its unit may mean.
fn readings<'v, Q: Copy>(
    name: &str,
    place: Place<'_>,
    vocabulary: &'v [Words<Q>],
) -> impl Iterator<Item = (&'v Words<Q>, HeadingUnit)> {
    let found = words(name);
    vocabulary.iter().filter_map(move |words| {
        let is_there = |part: &str| found.iter().any(|word| word == part);
        let mut keys = words.key_words.split(' ').filter(|key| key.split('+').all(is_there)).peekable();
        let has_key = keys.peek().is_some();
        let keys: Vec<&str> = keys.flat_map(|key| key.split('+')).collect();
        let is_known =
            |word: &String| keys.contains(&word.as_str()) || words.other_words.split(' ').any(|known| known == word);
        let is_named = has_key && found.iter().all(is_known);
        if is_named { unit_of(place, words.dimension).map(|unit| (words, unit)) } else { None }
    })
}

/// Where a unit stands in a heading.
#[derive(Clone, Copy, Debug)]
enum Place<'a> {
    /// There is none.
    Nowhere,
    /// In brackets: it is a unit whatever it says.
    Brackets(&'a str),
    /// Behind a sign or the last word: a unit if it is known.
    Behind(&'a str),
}

/// The ways to part a heading into name and unit, the likeliest first.
fn splits(heading: &str) -> impl Iterator<Item = (&str, Place<'_>)> {
    let bracketed = [('[', ']'), ('(', ')'), ('<', '>')].into_iter().filter_map(move |(open, close)| {
        let (name, unit) = heading.strip_suffix(close)?.rsplit_once(open)?;
        Some((name, Place::Brackets(unit)))
    });
    // A unit in the middle: E' (MPa) 20 °C.
    let within = [('[', ']'), ('(', ')')].into_iter().filter_map(move |(open, close)| {
        let (name, rest) = heading.split_once(open)?;
        let (unit, rest) = rest.split_once(close)?;
        if rest.trim().is_empty() || Unit::parse(unit).is_none() { None } else { Some((name, Place::Behind(unit))) }
    });
    let parted = [" in ", ",", "/", ":"].into_iter().filter_map(move |sign| {
        let (name, unit) = heading.split_once(sign)?;
        Some((name, Place::Behind(unit)))
    });
    let last_word = heading.rsplit_once([' ', '_']).map(|(name, unit)| (name, Place::Behind(unit)));
    bracketed.chain(within).chain(parted).chain(last_word).chain([(heading, Place::Nowhere)])
}

/// The unit at a place, `None` where the heading must be parted in another way.
fn unit_of(place: Place<'_>, dimension: Dimension) -> Option<HeadingUnit> {
    match place {
        Place::Nowhere => Some(HeadingUnit::None),
        Place::Behind(text) => {
            let unit = Unit::parse(text).filter(|unit| unit.is_of(dimension))?;
            Some(HeadingUnit::Known(unit))
        }
        Place::Brackets(text) if text.trim().is_empty() => Some(HeadingUnit::None),
        Place::Brackets(text) => Some(match Unit::parse(text).filter(|unit| unit.is_of(dimension)) {
            Some(unit) => HeadingUnit::Known(unit),
            None => HeadingUnit::Unknown(text.trim().to_owned()),
        }),
    }
}

impl Unit {
    /// Whether it is one of a quantity; a frequency may be in 1/s.
    pub fn is_of(&self, dimension: Dimension) -> bool {
        self.dimension == dimension || (dimension == Dimension::Frequency && self.dimension == Dimension::Rate)
    }
}

/// What a heading says of all numbers of its column.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Condition {
    /// Which quantity it is.
    pub dimension: Dimension,
    /// What that is, in SI units.
    pub value: f64,
}

/// A heading without what it says of all its column, as in `E' (MPa) @ 20 °C` and `E'' (f = 1 Hz)`, and that; `None` where
/// it says nothing of this dimension.
pub(super) fn without_condition(text: &str, dimension: Dimension) -> Option<(String, Condition)> {
    /// What may stand before it: `E' at 20 °C`, `E', T = 20 °C`.
    const WORDS: [&str; 10] = ["at", "bei", "T", "temp", "temperature", "f", "freq", "frequency", "ω", "omega"];
    let (place, value) = find_quantity(text, dimension)?;
    let trimmed = |text: &'_ str| text.trim_end_matches(['@', ',', ';', '_', '-', ' ']).len();
    let mut before = &text[..place.start];
    before = &before[..trimmed(before)];
    let (named, is_set) = before.strip_suffix(['=', ':']).map_or((before, false), |named| (named.trim_end(), true));
    let start = named.rfind([' ', ',', ';', '_', '(', '[', '@']).map_or(0, |last| last + 1);
    if WORDS.iter().any(|word| *word == &named[start..]) && (is_set || ["at", "bei"].contains(&&named[start..])) {
        before = &named[..start];
        before = &before[..trimmed(before)];
    }
    let mut behind = text[place.end..].trim_start_matches(['@', ',', ';', '_', ':', ' ']);
    for (open, close) in [('(', ')'), ('[', ']')] {
        if let (Some(outer), Some(rest)) = (before.strip_suffix(open), behind.strip_prefix(close)) {
            (before, behind) = (outer.trim_end(), rest.trim_start());
        }
    }
    let parted = if behind.starts_with([')', ']']) { "" } else { " " };
    let name =
        format!("{before}{parted}{behind}").trim().trim_end_matches(['@', ',', ';', '_', '-', '(', ' ']).to_owned();
    Some((name, Condition { dimension, value }))
}

/// The bytes of a text from a number to the end of its unit of this dimension, and the number in SI units.
pub fn find_quantity(text: &str, dimension: Dimension) -> Option<(Range<usize>, f64)> {
    let is_digit = |letter: char| letter.is_ascii_digit() || "+-.,\u{2212}".contains(letter);
    let mut from = 0;
    while let Some(offset) = text[from..].find(|letter: char| letter.is_ascii_digit()) {
        let mut start = from + offset;
        while let Some(before) = text[..start].chars().next_back().filter(|letter| "+-\u{2212}".contains(*letter)) {
            start -= before.len_utf8();
        }
        let end =
            text[from + offset..].find(|letter: char| !is_digit(letter)).map_or(text.len(), |end| from + offset + end);
        let behind = text[end..].trim_start();
        let stop =
            behind.find(|letter: char| letter.is_whitespace() || ")],;:_@".contains(letter)).unwrap_or(behind.len());
        let spaced = plain(&behind[..stop]);
        // One word of a unit, or the sign of degrees and its letter.
        let unit = Unit::parse(&spaced).filter(|unit| unit.dimension == dimension);
        if let (Some(unit), Some(number)) = (unit, number(text[start..end].trim_matches(','), true)) {
            return Some((start..text.len() - behind.len() + stop, unit.to_si(number)));
        }
        from = end.max(from + offset + 1);
    }
    None
}

/// The text with one spelling of primes, degrees and powers.
pub fn plain(text: &str) -> String {
    const SIGNS: [(&str, &str); 23] = [
        ("″", "''"),
        ("”", "''"),
        ("\"", "''"),
        ("\u{94}", "''"),
        ("ʺ", "''"),
        ("′", "'"),
        ("’", "'"),
        ("´", "'"),
        ("`", "'"),
        ("\u{92}", "'"),
        ("ʹ", "'"),
        ("º", "°"),
        ("˚", "°"),
        ("⁻¹", "-1"),
        ("−1", "-1"),
        ("²", "2"),
        ("^", ""),
        ("·", " "),
        ("⋅", " "),
        ("\u{a0}", " "),
        ("deg ", "deg"),
        ("° ", "°"),
        ("−", "-"),
    ];
    SIGNS.iter().fold(text.trim().to_owned(), |text, (sign, plain)| text.replace(sign, plain))
}

/// Of `log10(f / Hz)` and `lg f [Hz]` the inner part, and the base.
fn without_logarithm(text: &str) -> (&str, Option<f64>) {
    const BASES: [(&str, f64); 6] = [
        ("log10", 10.0),
        ("log_10", 10.0),
        ("log", 10.0),
        ("lg", 10.0),
        ("ln", std::f64::consts::E),
        ("loge", std::f64::consts::E),
    ];
    let found = BASES.iter().find_map(|(name, base)| {
        let head = text.get(..name.len())?;
        let rest = &text[name.len()..];
        let parts = rest.starts_with([' ', '(', '_', '[', '|']);
        (parts && head.eq_ignore_ascii_case(name)).then_some((rest.trim_start_matches([' ', '_']), *base))
    });
    let Some((rest, base)) = found else { return (text, None) };
    let inner = rest.strip_prefix('(').and_then(|inner| inner.strip_suffix(')')).unwrap_or(rest);
    (inner, Some(base))
}

/// The words of a name, in lower case but for a single T, which is a temperature where t is a time. Primes belong to
/// the letter before them, and E* is `estar`.
pub fn words(name: &str) -> Vec<String> {
    let lower =
        plain(name).replace('_', " ").replace("double prime", "''").replace("doubleprime", "''").replace("prime", "'");
    let marked = lower.split(' ').map(|word| if word == "T" { word.to_owned() } else { word.to_lowercase() });
    let lower = marked.collect::<Vec<_>>().join(" ").replace("e*", "estar").replace("g*", "gstar");
    let lower = ["e", "g"].iter().fold(lower, |text, letter| {
        let text = text.replace(&format!("{letter} ''"), &format!("{letter}''"));
        text.replace(&format!("{letter} '"), &format!("{letter}'"))
    });
    let ends = |letter: char| letter.is_whitespace() || "-.()[]{}<>:;,|\\/=#*×@".contains(letter);
    lower.split(ends).filter(|word| !word.is_empty()).map(str::to_owned).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Clone, Copy, Debug, PartialEq)]
    enum Found {
        X,
        Storage,
        Tangent,
        Frequency,
    }

    const VOCABULARY: [Words<Found>; 4] = [
        Words::new(Found::X, Dimension::Length, "x", "axis"),
        Words::new(Found::Storage, Dimension::Pressure, "e' storage", "modulus"),
        Words::new(Found::Tangent, Dimension::Number, "tan", "d delta"),
        Words::new(Found::Frequency, Dimension::Frequency, "f frequency", ""),
    ];

    fn read(text: &str) -> Option<(Found, Option<&'static str>, bool)> {
        let heading = Heading::parse(text, &VOCABULARY)?;
        let unit = match heading.unit {
            HeadingUnit::None => None,
            HeadingUnit::Known(unit) => Some(unit.name),
            HeadingUnit::Unknown(_) => Some("?"),
        };
        Some((heading.quantity, unit, heading.logarithm.is_some()))
    }

    #[test]
    fn headings_are_parted_into_name_and_unit() {
        let cases = [
            ("x [mm]", Found::X, Some("mm"), false),
            ("x", Found::X, None, false),
            ("X_mm", Found::X, Some("mm"), false),
            ("x in in", Found::X, Some("in"), false),
            ("x / µm", Found::X, Some("µm"), false),
            ("X-axis (inches)", Found::X, Some("in"), false),
            ("X (pixels)", Found::X, Some("?"), false),
            ("x [Hz]", Found::X, Some("?"), false),
            ("Storage modulus (E') [MPa]", Found::Storage, Some("MPa"), false),
            ("Storage modulus (E')", Found::Storage, None, false),
            ("E' (MPa) @ 20 °C", Found::Storage, Some("MPa"), false),
            ("E' [psi]", Found::Storage, Some("psi"), false),
            ("tan(d)", Found::Tangent, None, false),
            ("Tan(Delta) (-)", Found::Tangent, Some("1"), false),
            ("log10(f / Hz)", Found::Frequency, Some("Hz"), true),
            ("log f [Hz]", Found::Frequency, Some("Hz"), true),
            ("lg(frequency)", Found::Frequency, None, true),
        ];
        for (text, quantity, unit, logarithm) in cases {
            assert_eq!(read(text), Some((quantity, unit, logarithm)), "{text}");
        }
        for text in ["y [mm]", "", "[mm]", "loss [MPa]", "x y"] {
            assert_eq!(read(text), None, "{text}");
        }
    }

    #[test]
    fn a_unit_belongs_to_its_column_whatever_that_is_called() {
        let read = |name: &str, below: &str| match HeadingUnit::beside(name, below, Dimension::Length) {
            HeadingUnit::None => None,
            HeadingUnit::Known(unit) => Some(unit.name),
            HeadingUnit::Unknown(_) => Some("?"),
        };
        let cases = [
            ("Texture [µm]", "", Some("µm")),
            ("Sensor 3 (mm)", "", Some("mm")),
            ("Signal in nm", "", Some("nm")),
            ("Raw_um", "", Some("µm")),
            ("Laser [µm] left", "", Some("µm")),
            ("Relief", "[mm]", Some("mm")),
            ("Data", "", None),
            ("Value of sensor", "", None),
            ("Signal [V]", "", Some("?")),
            ("Signal", "counts", Some("?")),
        ];
        for (name, below, unit) in cases {
            assert_eq!(read(name, below), unit, "{name} {below}");
        }
    }

    #[test]
    fn headings_may_say_what_holds_for_their_column() {
        let read =
            |text: &str, dimension| without_condition(text, dimension).map(|(name, condition)| (name, condition.value));
        for (text, name, kelvin) in [
            ("E' (MPa) @ 20 °C", "E' (MPa)", 293.15),
            ("E'' 313.15 K", "E''", 313.15),
            ("40C E' (MPa)", "E' (MPa)", 313.15),
            ("E' at -10°C [MPa]", "E' [MPa]", 263.15),
            ("E' (MPa, 20 °C)", "E' (MPa)", 293.15),
            ("E' [MPa], T = 20 °C", "E' [MPa]", 293.15),
        ] {
            assert_eq!(read(text, Dimension::Temperature), Some((name.to_owned(), kelvin)), "{text}");
        }
        for (text, name, hertz) in [
            ("E' 1 Hz", "E'", 1.0),
            ("E'' (10 Hz) [MPa]", "E'' [MPa]", 10.0),
            ("E'_0.5Hz_MPa", "E' MPa", 0.5),
            ("tan(d) (f = 2 Hz)", "tan(d)", 2.0),
            ("E' [MPa] @ 1 kHz", "E' [MPa]", 1e3),
            ("1Hz E' [MPa]", "E' [MPa]", 1.0),
        ] {
            let omega = hertz * std::f64::consts::TAU;
            assert_eq!(read(text, Dimension::Frequency), Some((name.to_owned(), omega)), "{text}");
        }
        assert_eq!((read("E' (MPa)", Dimension::Temperature), read("N/mm2", Dimension::Frequency)), (None, None));
    }
}
