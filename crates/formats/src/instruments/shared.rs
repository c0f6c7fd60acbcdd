//! What the readers of instruments' files share: checks of what a file says of itself, and numbers at places of its bytes,
//! of which nothing is read beyond their end.

use asperity::tables::{ContentError, Dimension, Unit};

/// The most heights of a file.
const MOST: usize = 1 << 28;

/// Refuses a size that no file can have, before memory is taken for it.
pub(super) fn check_size(kind: &str, size: [usize; 2]) -> Result<(), ContentError> {
    let count = size[0].checked_mul(size[1]).filter(|&count| count > 0 && count <= MOST);
    let error = || {
        ContentError::value(
            None,
            "size",
            &format!("{} × {}", size[0], size[1]),
            &format!("{kind} of up to {MOST} heights"),
        )
    };
    count.map(|_| ()).ok_or_else(error)
}

/// Refuses a step that is none.
pub(super) fn check_step(kind: &str, step: f64) -> Result<f64, ContentError> {
    let expected = format!("a distance of points above 0 in {kind}");
    if step > 0.0 && step.is_finite() {
        Ok(step)
    } else {
        Err(ContentError::value(None, "spacing", &format!("{step:?}"), &expected))
    }
}

/// The unit of length that a file names at `key`.
pub(super) fn length_unit(key: &str, text: &str) -> Result<Unit, ContentError> {
    let unit = Unit::parse(text).filter(|unit| unit.dimension == Dimension::Length);
    let expected = format!("a unit of length: {}", Dimension::Length.units());
    unit.ok_or_else(|| ContentError::value(None, key, &format!("\"{text}\""), &expected))
}

/// The error of a file that is known but cannot be read.
pub(super) fn refuse(kind: &str, what: &str) -> ContentError {
    ContentError::value(None, "", kind, what)
}

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
