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

/// The decimal that `text` begins with, and its bytes. A sign `+` and long exponents are left to the general reader.
fn decimal(text: &str) -> Option<(f64, usize)> {
    let bytes = text.as_bytes();
    let sign = usize::from(bytes.first() == Some(&b'-'));
    let (digits, end) = Digits::read(bytes, sign);
    let (exponent, end) = match bytes.get(end) {
        Some(b'e' | b'E') => exponent(bytes, end + 1)?,
        _ => (0, end),
    };
    let size = digits.exact(exponent).or_else(|| text[sign..end].parse().ok())?;
    Some((if sign == 1 { -size } else { size }, end))
}

/// The longest exponent, its sign included.
const MAX_OF_EXPONENT: usize = 4;

/// The exponent in `bytes` from `from` on, and where it ends.
fn exponent(bytes: &[u8], from: usize) -> Option<(i32, usize)> {
    let signs = usize::from(matches!(bytes.get(from), Some(b'+' | b'-')));
    let (digits, end) = Digits::read(bytes, from + signs);
    let is_exponent = digits.count > 0 && !digits.has_point && end - from <= MAX_OF_EXPONENT;
    let sign = if bytes.get(from) == Some(&b'-') { -1 } else { 1 };
    is_exponent.then_some((sign * i32::try_from(digits.whole).ok()?, end))
}

/// A run of digits with or without a point.
#[derive(Clone, Copy, Debug, Default)]
struct Digits {
    /// The digits without the point as a number, where there are at most [`MAX_DIGITS`](Self::MAX_DIGITS).
    whole: u64,
    /// Number of digits.
    count: usize,
    /// Number of digits behind the point.
    behind: i32,
    has_point: bool,
}

impl Digits {
    /// As many digits always fit.
    const MAX_DIGITS: usize = 19;

    /// The digits in `bytes` from `from` on, and where they end.
    fn read(bytes: &[u8], from: usize) -> (Self, usize) {
        let mut digits = Self::default();
        let point = digits.add(bytes, from);
        if bytes.get(point) != Some(&b'.') {
            return (digits, point);
        }
        let before = digits.count;
        let end = digits.add(bytes, point + 1);
        (Self { has_point: true, behind: (digits.count - before) as i32, ..digits }, end)
    }

    /// Adds the digits in `bytes` from `from` on, and returns where they end.
    fn add(&mut self, bytes: &[u8], from: usize) -> usize {
        let mut end = from;
        while let Some(byte @ b'0'..=b'9') = bytes.get(end) {
            self.whole = self.whole.wrapping_mul(10).wrapping_add(u64::from(byte - b'0'));
            end += 1;
        }
        self.count += end - from;
        end
    }

    /// The number times ten to the `exponent`, where one division or product of exact numbers gives it, which rounds as
    /// the standard library does (W. D. Clinger, How to read floating point numbers accurately, 1990); `None`
    /// elsewhere.
    fn exact(self, exponent: i32) -> Option<f64> {
        const MOST: u64 = 1 << f64::MANTISSA_DIGITS;
        let exponent = exponent - self.behind;
        let power = POWERS.get(exponent.unsigned_abs() as usize)?;
        let is_exact = (1..=Self::MAX_DIGITS).contains(&self.count) && self.whole <= MOST;
        let whole = self.whole as f64;
        is_exact.then_some(if exponent < 0 { whole / power } else { whole * power })
    }
}

/// The powers of ten that are exact.
const POWERS: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20,
    1e21, 1e22,
];

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
