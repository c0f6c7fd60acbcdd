//! What is left to do where the program is stopped, by Ctrl-C or by a signal to end.

use std::fs;
use std::path::{Path, PathBuf};
use std::process;
use std::sync::{Mutex, MutexGuard, Once, PoisonError};

use super::output::is_standard_output;
use super::terminal::note;

/// Exit status of a program that was stopped: 128 and the number of SIGINT.
const STOPPED: i32 = 130;

/// What is unfinished now.
struct Unfinished {
    /// Files and folders that are of no use to anybody.
    leftovers: Vec<PathBuf>,
    /// What a long command says as it is stopped.
    farewell: Option<Box<dyn Fn() -> String + Send>>,
}

static UNFINISHED: Mutex<Unfinished> = Mutex::new(Unfinished { leftovers: Vec::new(), farewell: None });

fn unfinished() -> MutexGuard<'static, Unfinished> {
    static HANDLED: Once = Once::new();
    // Without a handler the program is stopped as any other is.
    HANDLED.call_once(|| drop(ctrlc::set_handler(stopped)));
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Ends the program as it is stopped. Nothing begins or ends any more: the lock is never released.
fn stopped() {
    let unfinished = UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(farewell) = &unfinished.farewell {
        note(&farewell());
    }
    for path in &unfinished.leftovers {
        drop(if path.is_dir() { fs::remove_dir_all(path) } else { fs::remove_file(path) });
    }
    process::exit(STOPPED)
}

/// A file or a folder that is of no use once the program has been stopped, and removed then.
#[derive(Debug)]
pub(crate) struct Leftover {
    path: PathBuf,
}

impl Leftover {
    pub(crate) fn new(path: &Path) -> Self {
        unfinished().leftovers.push(path.to_owned());
        Self { path: path.to_owned() }
    }

    /// Does what makes the file something of use, or removes it; the program is not stopped meanwhile.
    pub(crate) fn keep_while<T>(self, finish: impl FnOnce() -> T) -> T {
        let mut unfinished = unfinished();
        unfinished.leftovers.retain(|path| *path != self.path);
        finish()
    }
}

impl Drop for Leftover {
    fn drop(&mut self) {
        unfinished().leftovers.retain(|path| *path != self.path);
    }
}

/// While it lives, a program that is stopped says what it has done and how to go on.
#[derive(Debug)]
pub(crate) struct Farewell;

impl Farewell {
    /// Of a command that adds to the table at `path`; `done` says how much of it there is.
    pub(crate) fn new(path: &Path, done: impl Fn() -> String + Send + 'static) -> Self {
        let go_on = match is_standard_output(path) {
            true => "a table for standard output is written once it is whole".to_owned(),
            false => format!("they are in {}; to go on: {}", path.display(), command_to_continue()),
        };
        unfinished().farewell = Some(Box::new(move || format!("stopped: {}; {go_on}", done())));
        Self
    }
}

impl Drop for Farewell {
    fn drop(&mut self) {
        unfinished().farewell = None;
    }
}

/// The command line as a shell takes it.
pub(crate) fn command_line() -> String {
    command_without(|_| false)
}

/// The command line without `--force`, which would begin anew what is to be continued.
fn command_to_continue() -> String {
    command_without(|word| word == "--force")
}

fn command_without(left_out: impl Fn(&str) -> bool) -> String {
    let words = std::env::args_os().map(|word| word.to_string_lossy().into_owned());
    words.filter(|word| !left_out(word)).map(|word| quoted(&word)).collect::<Vec<_>>().join(" ")
}

fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_alphanumeric() || "-_./=,:+@%".contains(c);
    if !word.is_empty() && word.chars().all(is_plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', r"'\''"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_word_is_quoted_where_a_shell_would_read_it_otherwise() {
        let words = ["a.toml", "--speeds", "1e-3..10/6", "a b", "it's", ""];
        assert_eq!(words.map(quoted), ["a.toml", "--speeds", "1e-3..10/6", "'a b'", r"'it'\''s'", "''"]);
    }
}
