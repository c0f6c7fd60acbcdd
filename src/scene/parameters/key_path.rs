//! The path of a key, kept in place, so that it can be copied and nothing has to be kept for it.

use std::fmt;

/// More bytes than the longest path of a key has.
const LONGEST: usize = 63;

/// The path of a key, `[]` behind a list.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub(super) struct KeyPath {
    bytes: [u8; LONGEST],
    length: u8,
}

impl KeyPath {
    /// That of a path of at most [`LONGEST`] bytes; of a longer one its beginning, which is that of no key.
    pub(super) const fn new(path: &str) -> Self {
        let (path, mut bytes, mut length) = (path.as_bytes(), [0; LONGEST], 0);
        while length < path.len() && length < LONGEST {
            bytes[length] = path[length];
            length += 1;
        }
        Self { bytes, length: length as u8 }
    }

    pub(super) fn as_str(&self) -> &str {
        std::str::from_utf8(&self.bytes[..usize::from(self.length)]).unwrap_or_default()
    }
}

impl fmt::Debug for KeyPath {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Debug::fmt(self.as_str(), f)
    }
}
