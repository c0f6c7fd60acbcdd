//! Numbers at places of a file's bytes; nothing is read beyond their end.

use asperity::tables::ContentError;

/// The bytes of a file of some kind.
#[derive(Clone, Copy, Debug)]
pub(super) struct Binary<'a> {
    pub(super) kind: &'static str,
    pub(super) bytes: &'a [u8],
}

impl<'a> Binary<'a> {
    fn array<const N: usize>(&self, at: usize) -> Result<[u8; N], ContentError> {
        self.slice(at, N)?.try_into().map_err(|_| self.short())
    }

    /// `count` bytes from `at` on.
    pub(super) fn slice(&self, at: usize, count: usize) -> Result<&'a [u8], ContentError> {
        at.checked_add(count).and_then(|end| self.bytes.get(at..end)).ok_or_else(|| self.short())
    }

    fn short(&self) -> ContentError {
        ContentError::value(
            None,
            "",
            &format!("{} of {} bytes", self.kind, self.bytes.len()),
            "as many as its header says",
        )
    }

    pub(super) fn u16(&self, at: usize) -> Result<usize, ContentError> {
        self.array(at).map(|bytes| u16::from_le_bytes(bytes).into())
    }

    pub(super) fn u32(&self, at: usize) -> Result<usize, ContentError> {
        self.array(at).map(|bytes| u32::from_le_bytes(bytes) as usize)
    }

    pub(super) fn i32(&self, at: usize) -> Result<i32, ContentError> {
        self.array(at).map(i32::from_le_bytes)
    }

    pub(super) fn f32(&self, at: usize) -> Result<f64, ContentError> {
        self.array(at).map(|bytes| f32::from_le_bytes(bytes).into())
    }

    pub(super) fn f64(&self, at: usize) -> Result<f64, ContentError> {
        self.array(at).map(f64::from_le_bytes)
    }

    /// A text of fixed length, without what fills it up.
    pub(super) fn text(&self, at: usize, count: usize) -> Result<String, ContentError> {
        let bytes = self.slice(at, count)?;
        let end = bytes.iter().position(|&byte| byte == 0).unwrap_or(count);
        Ok(bytes[..end].iter().copied().map(char::from).collect::<String>().trim().to_owned())
    }
}
