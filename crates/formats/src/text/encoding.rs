//! From bytes to text.

use std::borrow::Cow;

use asperity::tables::ContentError;

/// The bytes are no text: some are zero.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}: expected {}", Self::FOUND, Self::EXPECTED)]
pub struct NotText;

impl NotText {
    /// What was found.
    pub const FOUND: &str = "bytes that are zero";
    /// What was expected.
    pub const EXPECTED: &str = "text in UTF-8, UTF-16 or Latin-1";
}

impl From<NotText> for ContentError {
    fn from(_: NotText) -> Self {
        Self::value(Some(1), "", NotText::FOUND, NotText::EXPECTED)
    }
}

/// The text in `bytes`: UTF-8, UTF-16 (by its mark, or by its zeros) or else Latin-1, without a byte order mark, its
/// lines ended by line feeds.
///
/// # Errors
/// [`NotText`] where a character is U+0000.
pub fn decode(bytes: &[u8]) -> Result<Cow<'_, str>, NotText> {
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
        return Err(NotText);
    }
    // Lines of an old Macintosh.
    if text.contains('\r') && !text.contains('\n') { Ok(Cow::Owned(text.replace('\r', "\n"))) } else { Ok(text) }
}

fn utf_16(bytes: &[u8], unit: fn([u8; 2]) -> u16) -> String {
    let units: Vec<u16> = bytes.chunks_exact(2).map(|pair| unit([pair[0], pair[1]])).collect();
    String::from_utf16_lossy(&units)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zeros_are_no_text() {
        let message = "bytes that are zero: expected text in UTF-8, UTF-16 or Latin-1";
        assert_eq!(decode(b"a\0").map_err(|error| error.to_string()), Err(message.into()));
        assert_eq!(decode(b"\xb5m").as_deref(), Ok("\u{b5}m"));
    }
}
