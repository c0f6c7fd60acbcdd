//! Units as headers of tables name them.

use std::f64::consts::{PI, TAU};
use std::fmt;

/// What a unit measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dimension {
    /// m.
    Length,
    /// m².
    Area,
    /// Pa.
    Pressure,
    /// s.
    Time,
    /// rad/s.
    Frequency,
    /// 1/s: of a frequency or of an angular one, as the name beside it says.
    Rate,
    /// K.
    Temperature,
    /// rad.
    Angle,
    /// m/s.
    Speed,
    /// N.
    Force,
    /// kg.
    Mass,
    /// kg/m³.
    Density,
    /// N/m.
    Stiffness,
    /// rad/m.
    WaveNumber,
    /// m³: of the power spectrum of lines.
    LineSpectrum,
    /// m⁴: of the power spectrum of a surface.
    SurfaceSpectrum,
    /// 1.
    Number,
}

/// A unit: a number in it is `factor`/`divisor` times as much in SI units, plus `offset`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unit {
    /// As messages have it.
    pub name: &'static str,
    /// What it measures.
    pub dimension: Dimension,
    factor: f64,
    divisor: f64,
    offset: f64,
}

/// The unit of a spatial frequency, of which 2π rad/m are one.
pub const CYCLES: &str = "cycles/m";

impl Unit {
    /// No unit: of numbers that are plain, or in SI units.
    pub const ONE: Self = Self::new("1", Dimension::Number, 1.0);

    const fn new(name: &'static str, dimension: Dimension, factor: f64) -> Self {
        Self { name, dimension, factor, divisor: 1.0, offset: 0.0 }
    }

    /// A part of the SI unit. A number is divided, as 2.5 mm are then exactly the number 0.0025.
    const fn part(name: &'static str, dimension: Dimension, divisor: f64) -> Self {
        Self { name, dimension, factor: 1.0, divisor, offset: 0.0 }
    }

    /// The SI unit of a dimension; rad/s of frequencies.
    pub const fn si(dimension: Dimension) -> Self {
        Self::new(dimension.si_name(), dimension, 1.0)
    }

    /// A number in this unit, in SI units: m, Pa, s, rad/s, K, rad.
    pub fn to_si(&self, written: f64) -> f64 {
        let scaled = written * self.factor / self.divisor;
        if self.offset == 0.0 { scaled } else { scaled + self.offset }
    }

    /// Whether numbers stay what they are.
    pub fn is_si(&self) -> bool {
        (self.factor, self.divisor, self.offset) == (1.0, 1.0, 0.0)
    }

    /// The unit that `text` names, in one of the usual spellings; of 1/s the rate.
    ///
    /// Upper and lower case count where m may mean milli: mPa is none of the units, Mpa and mpa are MPa.
    pub fn parse(text: &str) -> Option<Self> {
        let text = plain(text);
        let named = |exact: bool| {
            UNITS
                .iter()
                .find(|(_, spellings)| spellings.iter().any(|name| same(name, &text, exact)))
                .map(|(unit, _)| *unit)
        };
        named(true).or_else(|| named(false))
    }
}

/// In any case where that cannot be mistaken: of words, and not where m may mean milli or M mega.
fn same(name: &str, text: &str, exact: bool) -> bool {
    if exact {
        return name == text;
    }
    // m and M are milli and mega, but in words and where one of them makes no sense.
    let starts_alike = text.chars().next() == name.chars().next() || !text.starts_with(['m', 'M']);
    let is_word = text.len() > 4 || ["mpa", "MM", "MIL", "Mil", "MIN", "Min"].contains(&text);
    text.chars().count() > 1 && text != "mhz" && (starts_alike || is_word) && name.eq_ignore_ascii_case(text)
}

/// One spelling of powers, micro and degrees; no blanks, no brackets around it.
fn plain(text: &str) -> String {
    let bare = text.trim().trim_start_matches(['[', '(', '<']).trim_end_matches([']', ')', '>']);
    let mut plain = String::with_capacity(bare.len());
    for letter in bare.chars() {
        match letter {
            // The sign of the unit and the Greek letter.
            '\u{b5}' | '\u{3bc}' => plain.push('u'),
            '\u{212b}' => plain.push('\u{c5}'),
            '\u{ba}' | '\u{2da}' => plain.push('°'),
            '\u{b2}' => plain.push('2'),
            '\u{b3}' => plain.push('3'),
            '\u{2074}' => plain.push('4'),
            '\u{b9}' => plain.push('1'),
            '\u{207b}' | '\u{2212}' => plain.push('-'),
            '^' | '·' | '\u{22c5}' | '*' | '.' => (),
            letter if letter.is_whitespace() => (),
            letter => plain.push(letter),
        }
    }
    plain
}

impl Unit {
    /// Whether it is one of a quantity; a frequency may be in 1/s.
    pub fn is_of(&self, dimension: Dimension) -> bool {
        self.dimension == dimension || (dimension == Dimension::Frequency && self.dimension == Dimension::Rate)
    }
}

impl Dimension {
    const fn si_name(self) -> &'static str {
        match self {
            Self::Length => "m",
            Self::Area => "m²",
            Self::Pressure => "Pa",
            Self::Time => "s",
            Self::Frequency => "rad/s",
            Self::Rate => "1/s",
            Self::Temperature => "K",
            Self::Angle => "rad",
            Self::Speed => "m/s",
            Self::Force => "N",
            Self::Mass => "kg",
            Self::Density => "kg/m³",
            Self::Stiffness => "N/m",
            Self::WaveNumber => "1/m",
            Self::LineSpectrum => "m³",
            Self::SurfaceSpectrum => "m⁴",
            Self::Number => "1",
        }
    }

    /// Its units, for messages.
    pub fn units(self) -> String {
        let mut names: Vec<&str> = Vec::new();
        for (unit, _) in UNITS.iter().filter(|(unit, _)| unit.dimension == self) {
            if !names.contains(&unit.name) {
                names.push(unit.name);
            }
        }
        names.join(", ")
    }
}

/// The number of a text that has a number and, behind it, a unit; in SI units, and `None` beside it where there is no
/// unit. `None` where the text is anything else, or the unit is one of another quantity.
pub fn quantity(text: &str, dimension: Dimension) -> Option<(f64, Option<Unit>)> {
    let (number, unit) = number_and_unit(text)?;
    let unit = match unit {
        "" => None,
        unit => Some(Unit::parse(unit).filter(|unit| unit.is_of(dimension))?),
    };
    let number = unit.unwrap_or(Unit::si(dimension)).to_si(number);
    number.is_finite().then_some((number, unit))
}

/// The number in SI units of a text that has a number and, behind it, a unit of whatever quantity.
pub fn quantity_with_unit(text: &str) -> Option<f64> {
    let (number, unit) = number_and_unit(text)?;
    Some(Unit::parse(unit)?.to_si(number)).filter(|number| number.is_finite())
}

/// What is left of a number and a unit begins with the unit, but for exponents: 1e3 and 5 eV.
fn number_and_unit(text: &str) -> Option<(f64, &str)> {
    let text = text.trim();
    let end = (1..=text.len()).rev().find(|&end| text.is_char_boundary(end) && text[..end].parse::<f64>().is_ok())?;
    Some((text[..end].parse().ok()?, text[end..].trim()))
}

impl fmt::Display for Unit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name)
    }
}

const METRES_PER_INCH: f64 = 0.0254;
const NEWTONS_PER_POUND: f64 = 4.448_221_615_260_5;
const PASCALS_PER_PSI: f64 = 6_894.757_293_168_361;
/// 0 °C in K.
const FREEZING: f64 = 273.15;
/// 0 °F in K.
const FAHRENHEIT: f64 = 459.67 * 5.0 / 9.0;

/// The units and their spellings, without blanks, dots and multiplication signs.
const UNITS: &[(Unit, &[&str])] = &{
    use Dimension::{
        Angle, Area, Density, Force, Frequency, Length, LineSpectrum, Mass, Number, Pressure, Rate, Speed, Stiffness,
        SurfaceSpectrum, Temperature, Time, WaveNumber,
    };
    [
        (Unit::si(Length), &["m", "meter", "meters", "metre", "metres"] as &[&str]),
        (Unit::part("mm", Length, 1e3), &["mm", "millimeter", "millimeters", "millimetre", "millimetres"]),
        (
            Unit::part("µm", Length, 1e6),
            &["um", "micron", "microns", "micrometer", "micrometers", "micrometre", "micrometres"],
        ),
        (Unit::part("nm", Length, 1e9), &["nm", "nanometer", "nanometers", "nanometre", "nanometres"]),
        (Unit::part("cm", Length, 1e2), &["cm", "centimeter", "centimeters", "centimetre", "centimetres"]),
        (Unit::part("Å", Length, 1e10), &["\u{c5}", "angstrom", "angstroms", "\u{c5}ngstr\u{f6}m"]),
        (Unit::new("km", Length, 1e3), &["km", "kilometer", "kilometers", "kilometre", "kilometres"]),
        (Unit::new("in", Length, METRES_PER_INCH), &["in", "inch", "inches"]),
        (Unit::new("mil", Length, 1e-3 * METRES_PER_INCH), &["mil", "mils", "thou"]),
        (Unit::new("µin", Length, 1e-6 * METRES_PER_INCH), &["uin", "microinch", "microinches"]),
        (Unit::new("ft", Length, 12.0 * METRES_PER_INCH), &["ft", "foot", "feet"]),
        (Unit::new("yd", Length, 36.0 * METRES_PER_INCH), &["yd", "yard", "yards"]),
        (Unit::new("mile", Length, 63_360.0 * METRES_PER_INCH), &["mile", "miles"]),
        (Unit::si(Area), &["m2"]),
        (Unit::part("mm²", Area, 1e6), &["mm2"]),
        (Unit::part("cm²", Area, 1e4), &["cm2"]),
        (Unit::si(Pressure), &["Pa", "N/m2", "pascal", "pascals"]),
        (Unit::new("kPa", Pressure, 1e3), &["kPa", "kN/m2"]),
        (Unit::new("MPa", Pressure, 1e6), &["MPa", "MN/m2"]),
        (Unit::new("GPa", Pressure, 1e9), &["GPa", "kN/mm2"]),
        (Unit::new("N/mm²", Pressure, 1e6), &["N/mm2"]),
        (Unit::new("psi", Pressure, PASCALS_PER_PSI), &["psi", "lbf/in2"]),
        (Unit::new("ksi", Pressure, 1e3 * PASCALS_PER_PSI), &["ksi"]),
        (Unit::new("bar", Pressure, 1e5), &["bar"]),
        (Unit::new("mbar", Pressure, 1e2), &["mbar", "hPa"]),
        (Unit::new("atm", Pressure, 101_325.0), &["atm"]),
        (Unit::new("kgf/mm²", Pressure, 9_806_650.0), &["kgf/mm2", "kg/mm2", "kp/mm2"]),
        (Unit::new("N/cm²", Pressure, 1e4), &["N/cm2"]),
        (Unit::new("kgf/cm²", Pressure, 98_066.5), &["kgf/cm2", "kg/cm2", "kp/cm2"]),
        (Unit::part("dyn/cm²", Pressure, 10.0), &["dyn/cm2", "dyne/cm2", "dynes/cm2"]),
        (Unit::si(Time), &["s", "sec", "secs", "second", "seconds", "sek", "sekunde", "sekunden"]),
        (Unit::part("ms", Time, 1e3), &["ms", "msec", "millisecond", "milliseconds"]),
        (Unit::part("µs", Time, 1e6), &["us", "usec", "microsecond", "microseconds"]),
        (Unit::part("ns", Time, 1e9), &["ns", "nanosecond", "nanoseconds"]),
        (Unit::new("min", Time, 60.0), &["min", "mins", "minute", "minutes"]),
        (Unit::new("h", Time, 3600.0), &["h", "hr", "hrs", "hour", "hours"]),
        (Unit::new("d", Time, 86_400.0), &["d", "day", "days"]),
        (Unit::new("Hz", Frequency, TAU), &["Hz", "hertz", "cps"]),
        (Unit::si(Frequency), &["rad/s", "rads-1", "rad/sec", "radian/s"]),
        (Unit::new("mHz", Frequency, 1e-3 * TAU), &["mHz"]),
        (Unit::new("kHz", Frequency, 1e3 * TAU), &["kHz"]),
        (Unit::new("MHz", Frequency, 1e6 * TAU), &["MHz"]),
        (Unit::new("GHz", Frequency, 1e9 * TAU), &["GHz"]),
        (Unit::new("rpm", Frequency, TAU / 60.0), &["rpm"]),
        (Unit::si(Rate), &["1/s", "s-1", "/s", "1/sec"]),
        (Unit::si(Temperature), &["K", "kelvin", "°K", "degK"]),
        (Unit { offset: FREEZING, ..Unit::new("°C", Temperature, 1.0) }, &["°C", "C", "degC", "℃", "celsius", "gradC"]),
        (
            Unit { offset: FAHRENHEIT, divisor: 9.0, ..Unit::new("°F", Temperature, 5.0) },
            &["°F", "F", "degF", "℉", "fahrenheit"],
        ),
        (Unit::new("°", Angle, PI / 180.0), &["°", "deg", "degree", "degrees"]),
        (Unit::si(Angle), &["rad", "radian", "radians"]),
        (Unit::part("mrad", Angle, 1e3), &["mrad"]),
        (Unit::si(Speed), &["m/s", "ms-1"]),
        (Unit::part("mm/s", Speed, 1e3), &["mm/s"]),
        (Unit::part("km/h", Speed, 3.6), &["km/h", "kph"]),
        (Unit::part("cm/s", Speed, 1e2), &["cm/s"]),
        (Unit::part("µm/s", Speed, 1e6), &["um/s"]),
        (Unit::part("m/min", Speed, 60.0), &["m/min"]),
        (Unit::part("mm/min", Speed, 6e4), &["mm/min"]),
        (Unit::part("nm/s", Speed, 1e9), &["nm/s"]),
        (Unit::part("µm/min", Speed, 6e7), &["um/min"]),
        (Unit::part("cm/min", Speed, 6e3), &["cm/min"]),
        (Unit { divisor: 60.0, ..Unit::new("in/min", Speed, METRES_PER_INCH) }, &["in/min", "ipm"]),
        (Unit { divisor: 60.0, ..Unit::new("ft/min", Speed, 12.0 * METRES_PER_INCH) }, &["ft/min", "fpm"]),
        (Unit::new("mph", Speed, 0.44704), &["mph"]),
        (Unit::new("in/s", Speed, METRES_PER_INCH), &["in/s", "in/sec", "inch/s", "ips"]),
        (Unit::new("ft/s", Speed, 12.0 * METRES_PER_INCH), &["ft/s", "ft/sec", "fps"]),
        (Unit::si(Force), &["N", "newton", "newtons"]),
        (Unit::new("kN", Force, 1e3), &["kN"]),
        (Unit::new("daN", Force, 1e1), &["daN"]),
        (Unit::part("mN", Force, 1e3), &["mN"]),
        (Unit::part("µN", Force, 1e6), &["uN"]),
        (Unit::new("kgf", Force, 9.80665), &["kgf", "kp"]),
        (Unit { divisor: 1e3, ..Unit::new("gf", Force, 9.80665) }, &["gf"]),
        (Unit::new("lbf", Force, NEWTONS_PER_POUND), &["lbf", "lbs-force"]),
        (Unit::si(Mass), &["kg"]),
        (Unit::part("g", Mass, 1e3), &["g"]),
        (Unit::si(Density), &["kg/m3"]),
        (Unit::new("g/cm³", Density, 1e3), &["g/cm3", "g/ml"]),
        (Unit::si(Stiffness), &["N/m"]),
        (Unit::new("N/mm", Stiffness, 1e3), &["N/mm", "kN/m"]),
        (Unit::new("kN/mm", Stiffness, 1e6), &["kN/mm"]),
        (Unit::new("N/cm", Stiffness, 1e2), &["N/cm"]),
        (Unit::new("N/µm", Stiffness, 1e6), &["N/um"]),
        (Unit::si(WaveNumber), &["1/m", "m-1", "rad/m", "radm-1"]),
        (Unit::new(CYCLES, WaveNumber, TAU), &["cycles/m", "cycle/m", "cyc/m", "c/m"]),
        (Unit::new("1/cm", WaveNumber, 1e2), &["1/cm", "cm-1", "rad/cm", "radcm-1"]),
        (Unit::new("1/mm", WaveNumber, 1e3), &["1/mm", "mm-1", "rad/mm", "radmm-1"]),
        (Unit::new("1/µm", WaveNumber, 1e6), &["1/um", "um-1", "rad/um", "radum-1"]),
        (Unit::new("1/nm", WaveNumber, 1e9), &["1/nm", "nm-1", "rad/nm", "radnm-1"]),
        (Unit::si(LineSpectrum), &["m3"]),
        (Unit::part("mm³", LineSpectrum, 1e9), &["mm3"]),
        (Unit::part("µm³", LineSpectrum, 1e18), &["um3"]),
        (Unit::part("nm³", LineSpectrum, 1e27), &["nm3"]),
        (Unit::si(SurfaceSpectrum), &["m4"]),
        (Unit::part("mm⁴", SurfaceSpectrum, 1e12), &["mm4"]),
        (Unit::part("µm⁴", SurfaceSpectrum, 1e24), &["um4"]),
        (Unit::part("nm⁴", SurfaceSpectrum, 1e36), &["nm4"]),
        (Unit::ONE, &["1", "-", "--", "–", "none"]),
        (Unit::part("%", Number, 1e2), &["%", "percent"]),
    ]
};

#[cfg(test)]
mod tests {
    use super::*;

    fn si(text: &str) -> Option<(Dimension, f64)> {
        Unit::parse(text).map(|unit| (unit.dimension, unit.to_si(1.0)))
    }

    #[test]
    fn a_text_with_any_unit_is_a_number_in_si_units() {
        let found = ["5 MPa", "0.5mm", "20 °C", "5", "MPa", "5 parsnips"].map(quantity_with_unit);
        assert_eq!(found, [Some(5e6), Some(5e-4), Some(293.15), None, None, None]);
    }

    #[test]
    fn units_as_people_write_them() {
        use Dimension::{
            Frequency, Length, LineSpectrum, Pressure, Rate, Speed, SurfaceSpectrum, Temperature, Time, WaveNumber,
        };
        let cases = [
            ("mm", Length, 1e-3),
            ("MM", Length, 1e-3),
            ("µm", Length, 1e-6),
            ("\u{3bc}m", Length, 1e-6),
            ("Microns", Length, 1e-6),
            ("(Millimeters)", Length, 1e-3),
            ("Å", Length, 1e-10),
            ("in.", Length, 0.0254),
            ("Inch", Length, 0.0254),
            ("mil", Length, 2.54e-5),
            ("ft", Length, 0.3048),
            ("Mpa", Pressure, 1e6),
            ("mpa", Pressure, 1e6),
            ("N/mm²", Pressure, 1e6),
            ("N / mm^2", Pressure, 1e6),
            ("psi", Pressure, 6894.757293168361),
            ("ksi", Pressure, 6894757.293168361),
            ("min", Time, 60.0),
            ("cm/s", Speed, 1e-2),
            ("µm/s", Speed, 1e-6),
            ("mph", Speed, 0.44704),
            ("µs", Time, 1e-6),
            ("hz", Frequency, TAU),
            ("MHZ", Frequency, 1e6 * TAU),
            ("rad·s⁻¹", Frequency, 1.0),
            ("rad s^-1", Frequency, 1.0),
            ("1/s", Rate, 1.0),
            ("rad/mm", WaveNumber, 1e3),
            ("µm⁻¹", WaveNumber, 1e6),
            ("µm³", LineSpectrum, 1e-18),
            ("mm^4", SurfaceSpectrum, 1e-12),
            ("m⁴", SurfaceSpectrum, 1.0),
            ("° C", Temperature, 274.15),
            ("deg. C", Temperature, 274.15),
            ("K", Temperature, 1.0),
        ];
        for (text, dimension, value) in cases {
            let (found, number) = si(text).unwrap_or((Dimension::Number, f64::NAN));
            assert!(found == dimension && (number / value - 1.0).abs() < 1e-15, "{text}: {found:?} {number}");
        }
        // 68 °F are 20 °C, but for rounding.
        assert!(Unit::parse("°F").is_some_and(|unit| (unit.to_si(68.0) - 293.15).abs() < 1e-12));
        assert!(Unit::parse("mm").is_some_and(|unit| unit.to_si(2.5) == 0.0025));
    }

    #[test]
    fn quantities_are_numbers_with_their_units() {
        let si = |text, dimension| quantity(text, dimension).map(|(number, unit)| (number, unit.is_some()));
        assert_eq!(si("2 bar", Dimension::Pressure), Some((2e5, true)));
        assert_eq!(si("25µm", Dimension::Length), Some((2.5e-5, true)));
        assert_eq!(si("1e-3", Dimension::Length), Some((1e-3, false)));
        assert_eq!(si("60 °C", Dimension::Temperature), Some((333.15, true)));
        assert_eq!(si("-5.5e1 N/mm", Dimension::Stiffness), Some((-5.5e4, true)));
        for (text, dimension) in [("2 bar", Dimension::Length), ("bar", Dimension::Pressure), ("", Dimension::Number)] {
            assert_eq!(si(text, dimension), None, "{text}");
        }
        assert_eq!([si("inf m", Dimension::Length), si("2 2 m", Dimension::Length)], [None, None]);
    }

    #[test]
    fn what_may_be_something_else_is_no_unit() {
        for text in ["mPa", "mhz", "MS", "M", "Mm", "pixels", "S", "k", "", "e", "counts", "V"] {
            assert_eq!(si(text), None, "{text}");
        }
        assert_eq!(Dimension::Temperature.units(), "K, °C, °F");
    }
}
