//! Headers of columns with measured moduli: quantities and units as people and instruments write them.

use std::f64::consts::TAU;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Quantity {
    /// Frequency or angular frequency.
    Frequency,
    /// E'.
    Storage,
    /// E''.
    Loss,
    /// tan δ = E''/E'.
    LossTangent,
    /// T.
    Temperature,
}

/// Conversion to SI units (rad/s, Pa, 1, K): `factor` times the number plus `offset`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Scale {
    pub(super) factor: f64,
    pub(super) offset: f64,
}

/// A header that could be parsed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Header {
    pub(super) quantity: Quantity,
    /// `None` where the header names no unit.
    pub(super) scale: Option<Scale>,
    /// Whether a frequency without a unit is in rad/s.
    angular: bool,
}

/// The headers and units that can be parsed, for messages.
pub(super) const EXPECTED_HEADER: &str = "a quantity and its unit, such as frequency [Hz], f (Hz), omega [rad/s], E' [MPa], \
     E'' (Pa), storage modulus [MPa], loss modulus [MPa], tan delta, tan(d), temperature [°C], T [K]; units Hz, kHz, MHz, \
     mHz, rad/s, Pa, kPa, MPa, GPa, °C, K; --ignore NAME skips a column";

/// Words of a quantity's names: a header names the quantity if it has a key word and no word outside both lists.
struct Words {
    quantity: Quantity,
    angular: bool,
    key_words: &'static [&'static str],
    other_words: &'static [&'static str],
}

const fn words(quantity: Quantity, key_words: &'static [&'static str], other_words: &'static [&'static str]) -> Words {
    Words { quantity, angular: false, key_words, other_words }
}

const NAMES: [Words; 6] = [
    words(Quantity::Frequency, &["f", "freq", "frequency", "frequenz"], &["reduced", "test", "at"]),
    Words {
        angular: true,
        ..words(
            Quantity::Frequency,
            &["omega", "ω", "angular", "circular", "kreisfrequenz"],
            &["f", "freq", "frequency", "reduced", "test", "at"],
        )
    },
    words(Quantity::Storage, &["e'", "storage", "speichermodul"], &["e'", "e", "modulus", "dynamic", "tensile"]),
    words(Quantity::Loss, &["e''", "loss", "verlustmodul"], &["e''", "e", "modulus", "dynamic", "tensile"]),
    words(
        Quantity::LossTangent,
        &["tan", "tandelta", "tanδ", "tand", "factor", "tangent", "verlustfaktor"],
        &["delta", "δ", "d", "loss", "damping"],
    ),
    words(Quantity::Temperature, &["t", "temp", "temperature", "temperatur"], &["sample"]),
];

/// Units, without blanks and multiplication signs.
const FREQUENCIES: [(&str, f64); 5] =
    [("Hz", TAU), ("mHz", 1e-3 * TAU), ("kHz", 1e3 * TAU), ("MHz", 1e6 * TAU), ("GHz", 1e9 * TAU)];
const ANGULAR_FREQUENCIES: [(&str, f64); 3] = [("rad/s", 1.0), ("rads-1", 1.0), ("rad/sec", 1.0)];
/// Means cycles per second for a frequency, radians per second for an angular one.
const PER_SECOND: [(&str, f64); 2] = [("1/s", 1.0), ("s-1", 1.0)];
const MODULI: [(&str, f64); 6] = [("Pa", 1.0), ("kPa", 1e3), ("MPa", 1e6), ("GPa", 1e9), ("N/mm2", 1e6), ("N/m2", 1.0)];
const NUMBERS: [(&str, f64); 3] = [("-", 1.0), ("1", 1.0), ("", 1.0)];
const KELVIN: [(&str, f64); 1] = [("K", 1.0)];
const CELSIUS: [(&str, f64); 6] =
    [("°C", 1.0), ("C", 1.0), ("degC", 1.0), ("deg.C", 1.0), ("℃", 1.0), ("Celsius", 1.0)];
/// 0 °C in K.
const FREEZING: f64 = 273.15;

impl Header {
    /// `None` if the text is no known quantity and unit.
    pub(super) fn parse(header: &str) -> Option<Self> {
        let header = plain(header);
        splits(&header).find_map(|(name, unit)| {
            let words = named(name)?;
            let scale = match unit {
                Some(unit) => Some(scale(words.quantity, words.angular, unit)?),
                None => None,
            };
            Some(Self { quantity: words.quantity, scale, angular: words.angular })
        })
    }

    /// The header with a unit from the line below; `None` if the quantity has no such unit.
    pub(super) fn with_unit(self, unit: &str) -> Option<Self> {
        let unit = plain(unit);
        let bare = unit.trim().trim_start_matches(['[', '(']).trim_end_matches([']', ')']);
        Some(Self { scale: Some(scale(self.quantity, self.angular, bare)?), ..self })
    }

    /// The unit of a header that names none: Hz or rad/s for a frequency, 1 for tan δ; none for other quantities.
    pub(super) fn default_scale(&self) -> Option<Scale> {
        match self.quantity {
            Quantity::Frequency => Some(Scale { factor: if self.angular { 1.0 } else { TAU }, offset: 0.0 }),
            Quantity::LossTangent => Some(Scale::ONE),
            Quantity::Storage | Quantity::Loss | Quantity::Temperature => None,
        }
    }
}

impl Scale {
    /// Of numbers in SI units.
    pub(super) const ONE: Self = Self { factor: 1.0, offset: 0.0 };

    pub(super) fn apply(self, written: f64) -> f64 {
        self.factor * written + self.offset
    }
}

/// The text with one spelling of primes, degrees and powers.
fn plain(text: &str) -> String {
    const SIGNS: [(&str, &str); 24] = [
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
        ("*", " "),
        ("\u{a0}", " "),
        ("deg ", "deg"),
        ("° ", "°"),
        ("−", "-"),
    ];
    SIGNS.iter().fold(text.trim().to_owned(), |text, (sign, plain)| text.replace(sign, plain))
}

/// The candidate splits of a header into name and unit.
fn splits(header: &str) -> impl Iterator<Item = (&str, Option<&str>)> {
    let bracketed = [('[', ']'), ('(', ')')].into_iter().filter_map(move |(open, close)| {
        let (name, unit) = header.strip_suffix(close)?.rsplit_once(open)?;
        Some((name, Some(unit)))
    });
    let parted = [" in ", ",", "/"].into_iter().filter_map(move |sign| {
        let (name, unit) = header.split_once(sign)?;
        Some((name, Some(unit)))
    });
    let last_word = header.rsplit_once([' ', '_']).map(|(name, unit)| (name, Some(unit)));
    bracketed.chain(parted).chain([(header, None)]).chain(last_word)
}

fn named(name: &str) -> Option<&'static Words> {
    let lower = name.to_lowercase().replace('_', " ").replace("double prime", "''").replace("prime", "'");
    let lower = lower.replace("e ''", "e''").replace("e '", "e'");
    let found: Vec<&str> = lower.split([' ', '-', '.', '(', ')']).filter(|word| !word.is_empty()).collect();
    NAMES.iter().find(|words| {
        let known = |word: &&str| words.key_words.contains(word) || words.other_words.contains(word);
        found.iter().any(|word| words.key_words.contains(word)) && found.iter().all(known)
    })
}

fn scale(quantity: Quantity, angular: bool, unit: &str) -> Option<Scale> {
    let unit: String = unit.chars().filter(|letter| !letter.is_whitespace()).collect();
    let factor = |units: &[(&str, f64)]| factor(units, &unit);
    let factor = match quantity {
        Quantity::Frequency if angular => factor(&ANGULAR_FREQUENCIES).or_else(|| factor(&PER_SECOND)),
        Quantity::Frequency => factor(&FREQUENCIES)
            .or_else(|| factor(&ANGULAR_FREQUENCIES))
            .or_else(|| factor(&PER_SECOND).map(|factor| TAU * factor)),
        Quantity::Storage | Quantity::Loss => factor(&MODULI),
        Quantity::LossTangent => factor(&NUMBERS),
        Quantity::Temperature => match factor(&CELSIUS) {
            Some(factor) => return Some(Scale { factor, offset: FREEZING }),
            None => factor(&KELVIN),
        },
    };
    factor.map(|factor| Scale { factor, offset: 0.0 })
}

/// Matches exactly or else in any case, except where m may mean milli: in mPa and mhz, but not in mpa.
fn factor(units: &[(&str, f64)], unit: &str) -> Option<f64> {
    let exact = units.iter().find(|(name, _)| *name == unit);
    let milli = unit.starts_with('m') && unit != "mpa";
    let similar = || units.iter().find(|(name, _)| !milli && name.eq_ignore_ascii_case(unit));
    exact.or_else(similar).map(|(_, factor)| *factor)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(header: &str) -> Option<(Quantity, Option<f64>)> {
        Header::parse(header).map(|header| (header.quantity, header.scale.map(|scale| scale.apply(1.0))))
    }

    #[test]
    fn headers_as_people_write_them() {
        use Quantity::{Frequency, Loss, LossTangent, Storage, Temperature};
        let cases = [
            ("frequency [Hz]", Frequency, Some(TAU)),
            ("f (Hz)", Frequency, Some(TAU)),
            ("f / Hz", Frequency, Some(TAU)),
            ("Freq_Hz", Frequency, Some(TAU)),
            ("Frequency in kHz", Frequency, Some(1e3 * TAU)),
            ("frequency [1/s]", Frequency, Some(TAU)),
            ("frequency (rad/s)", Frequency, Some(1.0)),
            ("Frequency", Frequency, None),
            ("omega [rad/s]", Frequency, Some(1.0)),
            ("ω / rad/s", Frequency, Some(1.0)),
            ("Angular frequency (rad s^-1)", Frequency, Some(1.0)),
            ("angular frequency [1/s]", Frequency, Some(1.0)),
            ("aT*ω [rad·s⁻¹]", Frequency, Some(1.0)),
            ("E' [MPa]", Storage, Some(1e6)),
            ("E′ (GPa)", Storage, Some(1e9)),
            ("E’ in Mpa", Storage, Some(1e6)),
            ("E_prime_Pa", Storage, Some(1.0)),
            ("storage modulus [MPa]", Storage, Some(1e6)),
            ("Storage Modulus E' [kPa]", Storage, Some(1e3)),
            ("Speichermodul [N/mm²]", Storage, Some(1e6)),
            ("E'' (Pa)", Loss, Some(1.0)),
            ("E\" [MPa]", Loss, Some(1e6)),
            ("E″/MPa", Loss, Some(1e6)),
            ("E double prime (MPa)", Loss, Some(1e6)),
            ("loss modulus", Loss, None),
            ("Loss Modulus, MPa", Loss, Some(1e6)),
            ("tan delta", LossTangent, None),
            ("tan(d)", LossTangent, None),
            ("tan(d) [-]", LossTangent, Some(1.0)),
            ("Tan(Delta) (-)", LossTangent, Some(1.0)),
            ("tan δ", LossTangent, None),
            ("tan_delta", LossTangent, None),
            ("loss factor", LossTangent, None),
            ("temperature [°C]", Temperature, Some(274.15)),
            ("Temperature (C)", Temperature, Some(274.15)),
            ("Temp. / ° C", Temperature, Some(274.15)),
            ("T [degC]", Temperature, Some(274.15)),
            ("T [K]", Temperature, Some(1.0)),
            ("temperature", Temperature, None),
        ];
        for (header, quantity, si) in cases {
            assert_eq!(read(header), Some((quantity, si)), "{header}");
        }
    }

    /// Other quantities, other units, and milli instead of mega.
    #[test]
    fn headers_that_cannot_be_read() {
        let wrong = [
            "E [MPa]",
            "E' [psi]",
            "E'' [mPa]",
            "omega [Hz]",
            "t [s]",
            "T [F]",
            "G' [MPa]",
            "E* [MPa]",
            "",
            "[MPa]",
            "tan delta [%]",
            "f [mhz]",
            "1.0",
        ];
        for header in wrong {
            assert_eq!(read(header), None, "{header}");
        }
    }

    #[test]
    fn a_line_of_units_stands_for_units_in_the_headers() {
        let unit = |header: &str, unit: &str| Header::parse(header)?.with_unit(unit)?.scale;
        assert_eq!(unit("E'", "MPa"), Some(Scale { factor: 1e6, offset: 0.0 }));
        assert_eq!(unit("Temperature", "(°C)"), Some(Scale { factor: 1.0, offset: FREEZING }));
        assert_eq!(unit("tan(d)", ""), Some(Scale::ONE));
        assert_eq!(unit("E'", "1e6"), None);
    }
}
