//! Panics stop at the interface, and say so to the master alone.

use std::any::Any;
use std::cell::Cell;
use std::panic::{self, AssertUnwindSafe, PanicHookInfo};
use std::sync::OnceLock;

type Hook = Box<dyn Fn(&PanicHookInfo<'_>) + Send + Sync>;

thread_local! {
    /// Whether this thread is inside a guarded call.
    static GUARDED: Cell<bool> = const { Cell::new(false) };
}

/// Calls `body`; a panic in it becomes its message, and nothing is written to stderr.
pub(super) fn guard<T>(body: impl FnOnce() -> T) -> Result<T, String> {
    USUAL.get_or_init(silence_guarded_calls);
    let before = GUARDED.replace(true);
    let result = panic::catch_unwind(AssertUnwindSafe(body));
    GUARDED.set(before);
    result.map_err(|payload| message(payload.as_ref()))
}

/// The hook of panics outside of guarded calls, those of the program's other threads. It stands here and not in the new
/// hook, which takes no memory that way: it would be lost when the library is unloaded.
static USUAL: OnceLock<Hook> = OnceLock::new();

/// Returns the hook that was there.
fn silence_guarded_calls() -> Hook {
    let usual = panic::take_hook();
    panic::set_hook(Box::new(|panic| match USUAL.get() {
        Some(usual) if !GUARDED.get() => usual(panic),
        _ => (),
    }));
    usual
}

fn message(payload: &(dyn Any + Send)) -> String {
    let text = payload.downcast_ref::<String>().map(String::as_str);
    text.or_else(|| payload.downcast_ref::<&str>().copied()).unwrap_or("a panic without a message").to_owned()
}

#[cfg(test)]
#[allow(clippy::panic)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_becomes_its_message() {
        assert_eq!(guard(|| 1), Ok(1));
        assert_eq!(guard(|| panic!("plain")), Err::<(), _>("plain".into()));
        assert_eq!(guard(|| panic!("number {}", 7)), Err::<(), _>("number 7".into()));
    }
}
