//! The progress bar, one look for all commands.

use indicatif::{ProgressBar, ProgressStyle};

/// A bar of `length` positions, on a terminal alone: elsewhere it stays hidden.
pub(crate) fn bar(length: u64) -> ProgressBar {
    let bar = ProgressBar::new(length);
    match ProgressStyle::with_template("{bar:40} {percent:>3} %  {msg}  {eta} left") {
        Ok(style) => bar.with_style(style),
        Err(_) => bar,
    }
}
