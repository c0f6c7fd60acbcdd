//! Lines of two plain decimals, as nearly all of a profile's are: read in one pass, as the general reader would.

/// A line with two decimals, one of comma, semicolon, tab and blank between them and nothing else.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PlainLine {
    pub(super) x: f64,
    pub(super) z: f64,
    /// Its bytes, the line feed included.
    pub(super) length: usize,
}

impl PlainLine {
    /// The first line of `text`, if it is plain.
    pub(super) fn read(text: &str) -> Option<Self> {
        let (x, width) = decimal(text)?;
        if !matches!(text.as_bytes().get(width), Some(b',' | b';' | b'\t' | b' ')) {
            return None;
        }
        let rest = &text[width + 1..];
        let (z, end) = decimal(rest)?;
        let line_end = match &rest.as_bytes()[end..] {
            [] => 0,
            [b'\n', ..] => 1,
            [b'\r', b'\n', ..] => 2,
            _ => return None,
        };
        Some(Self { x, z, length: width + 1 + end + line_end })
    }
}

/// The powers of ten that are doubles.
const POWERS: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20,
    1e21, 1e22,
];

/// Whole numbers up to this are doubles.
const LARGEST_EXACT: u64 = 1 << 53;

/// So many digits fit into 64 bits.
const MOST_DIGITS: usize = 19;

/// The decimal that `text` begins with, and its bytes.
///
/// Few digits and a small power of ten are both exact, and so one operation on them rounds as it should (Clinger 1990, How
/// to read floating point numbers accurately); other numbers are left to the standard library.
fn decimal(text: &str) -> Option<(f64, usize)> {
    let bytes = text.as_bytes();
    let sign = usize::from(bytes.first() == Some(&b'-'));
    let (whole, count) = digits(&bytes[sign..], 0);
    let mut end = sign + count;
    let (mut mantissa, mut decimals) = (whole, 0);
    if bytes.get(end) == Some(&b'.') {
        (mantissa, decimals) = digits(&bytes[end + 1..], whole);
        end += 1 + decimals;
    }
    if count + decimals == 0 {
        return None;
    }
    let (exponent, length) = exponent(&bytes[end..])?;
    end += length;
    let places = exponent - decimals as i64;
    let exact = count + decimals <= MOST_DIGITS && mantissa <= LARGEST_EXACT;
    let value = match (exact, POWERS.get(places.unsigned_abs() as usize)) {
        (true, Some(power)) if places < 0 => mantissa as f64 / power,
        (true, Some(power)) => mantissa as f64 * power,
        _ => return Some((text[..end].parse().ok()?, end)),
    };
    Some((if sign == 1 { -value } else { value }, end))
}

/// The exponent that `bytes` begin with and its length: 0 where there is none; `None` for an `e` without digits or with
/// many.
fn exponent(bytes: &[u8]) -> Option<(i64, usize)> {
    let negative = match bytes {
        [b'e' | b'E', b'-', ..] => Some(true),
        [b'e' | b'E', b'+', ..] => Some(false),
        [b'e' | b'E', ..] => None,
        _ => return Some((0, 0)),
    };
    let before = 1 + usize::from(negative.is_some());
    let (size, count) = digits(&bytes[before..], 0);
    let size = i64::try_from(size).ok().filter(|_| (1..=4).contains(&count))?;
    Some((if negative == Some(true) { -size } else { size }, before + count))
}

/// The digits that `bytes` begin with put behind `value`, and their number; more than fit wrap around.
fn digits(bytes: &[u8], mut value: u64) -> (u64, usize) {
    let mut count = 0;
    for byte in bytes {
        let digit = byte.wrapping_sub(b'0');
        if digit > 9 {
            break;
        }
        value = value.wrapping_mul(10).wrapping_add(digit.into());
        count += 1;
    }
    (value, count)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::SplitMix64;

    /// The same bits as from the standard library, whose parser rounds correctly.
    #[test]
    fn decimals_are_rounded_as_by_the_standard_library() {
        let mut random = SplitMix64::new(5);
        let mut texts: Vec<String> = (0..20_000)
            .map(|i| {
                let value = (random.unit() - 0.5) * 10_f64.powi(i % 60 - 30);
                let digits = (i / 60) as usize % 19;
                if i % 3 == 0 { format!("{value:.digits$}") } else { format!("{value:.digits$e}") }
            })
            .collect();
        let chosen =
            ["0", "-0", "-0.0", "1.", ".5", "-.5E1", "1e-05", "9007199254740993", "1e22", "1e23", "1e-23", "5e-324"];
        texts.extend(chosen.map(String::from));
        texts.extend(
            ["00012345678901234567890", "0.1234567890123456789012", "1e400", "1e-400", "1E+05"].map(String::from),
        );
        for text in texts {
            let found = decimal(&text).map(|(value, length)| (value.to_bits(), length));
            assert_eq!(found, text.parse().ok().map(|value: f64| (value.to_bits(), text.len())), "{text}");
        }
    }

    #[test]
    fn what_is_not_plain_is_left_alone() {
        for text in ["", "-", ".", "e5", "1e", "1e-", "+1", "inf", "nan", "x", "1e12345", " 1"] {
            assert_eq!(decimal(text), None, "{text:?}");
        }
        let plain = |length| Some(PlainLine { x: 0.5, z: -2.0, length });
        for (text, length) in [("0.5,-2", 6), ("0.5;-2\n1;1\n", 7), ("0.5\t-2\r\n", 8), ("0.5 -2\n\n", 7)] {
            assert_eq!(PlainLine::read(text), plain(length), "{text:?}");
        }
        let others =
            ["", "\n", "0.5", "0.5,", "0.5, -2", "0.5,-2 \n", "0.5;-2,5\n", "0.5,-2,1\n", "0,5 -2\n", "# 0.5,-2"];
        for text in others.into_iter().chain(["0.5,-2\r", "0.5|-2", "0.5\u{a0}-2", "x,1", "\"0.5\",-2"]) {
            assert_eq!(PlainLine::read(text), None, "{text:?}");
        }
    }
}
