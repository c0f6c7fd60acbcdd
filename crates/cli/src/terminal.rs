//! Text for the terminal: aligned lines, warnings, the progress bar.

use std::fmt;
use std::io::{self, IsTerminal as _, Write as _};
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use asperity_study::progress::Progress;
pub(crate) use asperity_study::summary::{LabelledLine, labelled};
use indicatif::{HumanDuration, ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle, TermLike};

/// The lines as text, aligned after their labels, and broken between words where they are long.
pub(crate) fn lines(lines: &[LabelledLine]) -> String {
    lines_within(lines, LINE_LENGTH)
}

/// As [`lines`], no longer than those of a screen.
pub(crate) fn screen_lines(lines: &[LabelledLine]) -> String {
    lines_within(lines, SCREEN)
}

fn lines_within(lines: &[LabelledLine], length: usize) -> String {
    let options = textwrap::Options::new(length).subsequent_indent(CONTINUED).break_words(false);
    // Which files were written is a note.
    let is_said = |(label, _): &&LabelledLine| !(is_quiet() && *label == WRITTEN);
    lines
        .iter()
        .filter(is_said)
        .map(|(label, text)| textwrap::fill(&format!("{label:<12}{text}"), &options) + "\n")
        .collect()
}

/// The label of the files that were written.
const WRITTEN: &str = "Written";
/// Characters of a line.
const LINE_LENGTH: usize = 120;
/// Characters of a line of a summary on a screen.
const SCREEN: usize = 100;
/// What is before the continuation of a line.
const CONTINUED: &str = "              ";

/// Prints a line to standard error, where somebody reads that; nobody is left to be told where nobody does. Options that
/// the study names in backquotes are named as the command line has them.
pub(crate) fn say(message: &str) {
    drop(writeln!(io::stderr(), "asperity: {}", with_flags(message)));
}

/// The text with `--pressures` for each `` `pressures` ``; what else stands in backquotes stays.
pub(crate) fn with_flags(text: &str) -> String {
    let is_option = |part: &str| part.starts_with(|c: char| c.is_ascii_lowercase()) && part.bytes().all(is_of_option);
    let quoted = |(i, part): (usize, &str)| match i % 2 {
        0 => part.to_owned(),
        _ if is_option(part) => format!("--{}", part.replace('_', "-")),
        _ => format!("`{part}`"),
    };
    // A backquote without another is none.
    if text.matches('`').count() % 2 == 1 { text.to_owned() } else { text.split('`').enumerate().map(quoted).collect() }
}

fn is_of_option(byte: u8) -> bool {
    byte.is_ascii_lowercase() || byte == b'_'
}

/// Prints a warning to standard error.
pub(crate) fn warn(message: &str) {
    say(&format!("warning: {message}"));
}

/// Prints a note to standard error.
pub(crate) fn note(message: &str) {
    if !is_quiet() {
        say(message);
    }
}

/// Whether notes and progress are left out: `--quiet`.
static QUIET: AtomicBool = AtomicBool::new(false);
/// Whether every note is printed: `--verbose`.
static VERBOSE: AtomicBool = AtomicBool::new(false);

/// From now on leaves notes and progress out where `quiet`, and prints every note where `verbose`; warnings stay.
pub(crate) fn set_verbosity(quiet: bool, verbose: bool) {
    QUIET.store(quiet, Ordering::Relaxed);
    VERBOSE.store(verbose, Ordering::Relaxed);
}

/// Whether notes and progress are left out.
pub(crate) fn is_quiet() -> bool {
    QUIET.load(Ordering::Relaxed)
}

/// Whether every note is to be printed.
pub(crate) fn is_verbose() -> bool {
    VERBOSE.load(Ordering::Relaxed)
}

/// A progress bar of `length` positions; where standard error is no terminal a line every ten seconds.
pub(crate) fn bar(length: u64) -> ProgressBar {
    progress(Some(length), "{bar:40} {percent:>3} %  {msg}{left}", "{percent} % done{left}  {msg}")
}

/// A count of `what` is done, where nobody knows of how many; shown as [`bar`] is.
pub(crate) fn counter(what: &str) -> ProgressBar {
    progress(
        None,
        &format!("{{spinner}} {{pos}} {what}  {{msg}}  {{elapsed}}"),
        &format!("{{pos}} {what}, {{elapsed}}  {{msg}}"),
    )
}

/// Bars of a computation of the study, one after the other for its parts.
#[derive(Debug, Default)]
pub(crate) struct Bars(Mutex<Option<(String, ProgressBar)>>);

impl Bars {
    /// Positions of a bar.
    const POSITIONS: f64 = 1000.0;

    pub(crate) fn new() -> Self {
        Self::default()
    }

    /// What the computation calls.
    pub(crate) fn watch(&self) -> impl Fn(Progress<'_>) -> ControlFlow<()> + Sync {
        |progress| {
            self.show(progress);
            ControlFlow::Continue(())
        }
    }

    fn show(&self, Progress { part, doing, share }: Progress<'_>) {
        let mut current = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if current.as_ref().is_none_or(|(shown, _)| shown != part) {
            Self::finish(current.take());
            *current = Some((part.to_owned(), bar(Self::POSITIONS as u64)));
        }
        if let Some((_, bar)) = &*current {
            if bar.message() != doing {
                bar.set_message(doing.to_owned());
            }
            bar.set_position((Self::POSITIONS * share) as u64);
        }
    }

    /// Takes a bar off the terminal.
    fn finish(bar: Option<(String, ProgressBar)>) {
        bar.iter().for_each(|(_, bar)| bar.finish_and_clear());
    }
}

impl Drop for Bars {
    fn drop(&mut self) {
        Self::finish(self.0.lock().unwrap_or_else(PoisonError::into_inner).take());
    }
}

fn progress(length: Option<u64>, for_terminals: &str, as_lines: &str) -> ProgressBar {
    let (target, template) = match is_quiet() {
        true => (ProgressDrawTarget::hidden(), for_terminals),
        false if io::stderr().is_terminal() => (ProgressDrawTarget::stderr(), for_terminals),
        false => (ProgressDrawTarget::term_like(Box::new(ProgressLines::new())), as_lines),
    };
    let bar = ProgressBar::with_draw_target(length, target);
    match ProgressStyle::with_template(template) {
        Ok(style) => bar.with_style(style.with_key("left", time_left)),
        Err(_) => bar,
    }
}

/// The time left, once a tenth is done from which it can be told.
fn time_left(state: &ProgressState, text: &mut dyn fmt::Write) {
    if state.len().is_some_and(|all| is_told(state.pos(), all)) && !state.eta().is_zero() {
        // A text that cannot be written is not shown.
        let _ = write!(text, ", {:#} left", HumanDuration(state.eta()));
    }
}

/// Whether the time left can be told: the first steps are of other lengths than the rest.
fn is_told(done: u64, all: u64) -> bool {
    10 * done >= all
}

/// Draws a progress bar as lines, the first one late enough for short runs to have none.
#[derive(Debug)]
struct ProgressLines(Mutex<ProgressLine>);

#[derive(Debug)]
struct ProgressLine {
    text: String,
    printed: Instant,
}

impl ProgressLines {
    const INTERVAL: Duration = Duration::from_secs(10);
    /// Characters of a line.
    const WIDTH: u16 = 120;

    fn new() -> Self {
        Self(Mutex::new(ProgressLine { text: String::new(), printed: Instant::now() }))
    }

    fn with_line(&self, change: impl FnOnce(&mut ProgressLine)) -> io::Result<()> {
        change(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner));
        Ok(())
    }
}

impl TermLike for ProgressLines {
    fn width(&self) -> u16 {
        Self::WIDTH
    }

    fn move_cursor_up(&self, _: usize) -> io::Result<()> {
        Ok(())
    }

    fn move_cursor_down(&self, _: usize) -> io::Result<()> {
        Ok(())
    }

    fn move_cursor_right(&self, _: usize) -> io::Result<()> {
        Ok(())
    }

    fn move_cursor_left(&self, _: usize) -> io::Result<()> {
        Ok(())
    }

    fn write_line(&self, text: &str) -> io::Result<()> {
        self.write_str(text)
    }

    fn write_str(&self, text: &str) -> io::Result<()> {
        self.with_line(|line| line.text += text)
    }

    fn clear_line(&self) -> io::Result<()> {
        self.with_line(|line| line.text.clear())
    }

    fn flush(&self) -> io::Result<()> {
        self.with_line(|line| {
            let text = std::mem::take(&mut line.text);
            if !text.trim().is_empty() && line.printed.elapsed() >= Self::INTERVAL {
                note(text.trim());
                line.printed = Instant::now();
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_time_left_is_told_from_a_tenth_on() {
        assert_eq!([0, 1, 9, 10, 100].map(|done| is_told(done, 100)), [false, false, false, true, true]);
    }

    #[test]
    fn long_lines_are_broken_between_words() {
        let text = lines(&[("Label", "word ".repeat(60))]);
        let rows: Vec<&str> = text.lines().collect();
        assert!(rows.len() == 3 && rows.iter().all(|row| row.chars().count() <= LINE_LENGTH), "{text}");
        assert!(rows[1].starts_with("              word") && text.matches("word").count() == 60, "{text}");
        // A long word stays whole.
        let word = "x".repeat(300);
        assert!(lines(&[("Label", word.clone())]).contains(&word));
    }

    /// Nothing is known before the first step.
    #[test]
    fn the_time_left_is_not_guessed() {
        let bar = ProgressBar::hidden();
        bar.set_length(10);
        let shown = |bar: &ProgressBar| {
            let mut text = String::new();
            bar.update(|state| time_left(state, &mut text));
            text
        };
        assert_eq!(shown(&bar), "");
        std::thread::sleep(Duration::from_millis(20));
        bar.inc(1);
        let text = shown(&bar);
        assert!(text.is_empty() || text.ends_with(" left"), "{text}");
    }

    #[test]
    fn lines_are_aligned() {
        assert_eq!(lines(&labelled("Scene", ["a".into(), "b".into()])), "Scene       a\n            b\n");
    }

    #[test]
    fn options_alone_have_dashes() {
        let text = "`most_points`: as `asperity surface --mirror` does, or `points`";
        assert_eq!(with_flags(text), "--most-points: as `asperity surface --mirror` does, or --points");
        assert_eq!(with_flags("a`b: expected `free`"), "a`b: expected `free`");
    }
}
