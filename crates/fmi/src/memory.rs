//! Memory that the system would refuse: what a call needs is reckoned and asked for before it is used, since Rust ends
//! the process where an allocation fails.

use super::error::Error;
use asperity::math::can_allocate;

/// What stays free for all that is not reckoned, such as messages.
const SPARE: usize = 1 << 18;

/// Whether the system has so many bytes for `what` at once.
///
/// # Errors
/// [`Error::Memory`].
pub(super) fn check(what: &'static str, bytes: usize) -> Result<(), Error> {
    if can_allocate(bytes.saturating_add(SPARE)) {
        return Ok(());
    }
    Err(Error::Memory { what, mebibytes: bytes.div_ceil(1 << 20) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_no_system_has_is_refused() {
        assert!(check("a run", 1 << 20).is_ok());
        let error = check("a run", 1 << 60).unwrap_err().to_string();
        assert_eq!(error, "a run needs 1099511627776 MiB of memory, more than the system has for it");
        assert!(check("a run", usize::MAX).is_err());
    }
}
