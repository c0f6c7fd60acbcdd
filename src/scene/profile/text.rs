//! From bytes to text, whatever the instrument's computer wrote.

use std::borrow::Cow;

use crate::scene::Problem;

/// The text in `bytes`: UTF-8, UTF-16 (by its mark, or by its zeros) or else Latin-1, without a byte order mark.
pub(in crate::scene) fn text_of(bytes: &[u8]) -> Result<Cow<'_, str>, Problem> {
    let text = match bytes {
        [0xff, 0xfe, rest @ ..] => Cow::Owned(utf_16(rest, u16::from_le_bytes)),
        [0xfe, 0xff, rest @ ..] => Cow::Owned(utf_16(rest, u16::from_be_bytes)),
        [1..=255, 0, 1..=255, 0, ..] => Cow::Owned(utf_16(bytes, u16::from_le_bytes)),
        [0, 1..=255, 0, 1..=255, ..] => Cow::Owned(utf_16(bytes, u16::from_be_bytes)),
        _ => match std::str::from_utf8(bytes) {
            Ok(text) => Cow::Borrowed(text.strip_prefix('\u{feff}').unwrap_or(text)),
            // Of Latin-1 every byte is the number of its letter: µ is 0xb5.
            Err(_) => Cow::Owned(bytes.iter().copied().map(char::from).collect()),
        },
    };
    if text.contains('\0') {
        let (given, expected) = ("bytes that are zero".into(), "text in UTF-8, UTF-16 or Latin-1".into());
        return Err(Problem::Value { given, expected });
    }
    // Lines of an old Macintosh.
    if text.contains('\r') && !text.contains('\n') { Ok(Cow::Owned(text.replace('\r', "\n"))) } else { Ok(text) }
}

fn utf_16(bytes: &[u8], unit: fn([u8; 2]) -> u16) -> String {
    let units: Vec<u16> = bytes.chunks_exact(2).map(|pair| unit([pair[0], pair[1]])).collect();
    String::from_utf16_lossy(&units)
}
