//! Text for terminal and files: numbers, aligned lines, warnings, the progress bar.

use std::fmt::{self, Display, Formatter, LowerExp};
use std::io::{self, IsTerminal as _};
use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle, TermLike};

/// A line with a label; without one it continues the line above.
pub(crate) type LabelledLine = (&'static str, String);

/// The lines as text, aligned after their labels, and broken between words where they are long.
pub(crate) fn lines(lines: &[LabelledLine]) -> String {
    let options = textwrap::Options::new(LINE_LENGTH).subsequent_indent(CONTINUED).break_words(false);
    lines.iter().map(|(label, text)| textwrap::fill(&format!("{label:<12}{text}"), &options) + "\n").collect()
}

/// Characters of a line.
const LINE_LENGTH: usize = 120;
/// What is before the continuation of a line.
const CONTINUED: &str = "              ";

/// Lines of which the first has the label.
pub(crate) fn labelled(label: &'static str, texts: impl IntoIterator<Item = String>) -> Vec<LabelledLine> {
    texts.into_iter().enumerate().map(|(i, text)| (if i == 0 { label } else { "" }, text)).collect()
}

/// The shortest decimal that reads back as the same number; with an exponent outside the magnitudes `plain`.
pub(crate) fn decimal(value: f64, plain: Range<f64>) -> String {
    Decimal { value, plain }.to_string()
}

/// A number as files have it: the shortest decimal that reads back as the same number.
pub(crate) fn real(value: f64) -> String {
    file_decimal(value).to_string()
}

/// [`real`], to be written without a text of its own.
pub(crate) fn file_decimal(value: f64) -> Decimal {
    Decimal { value, plain: 1e-4..1e16 }
}

/// The shortest decimal that reads back as the same number; with an exponent outside the magnitudes `plain`.
#[derive(Debug)]
pub(crate) struct Decimal {
    value: f64,
    plain: Range<f64>,
}

impl Display for Decimal {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let Self { value, plain } = self;
        let is_plain = *value == 0.0 || plain.contains(&value.abs());
        // Of the same digits, in fewer instructions; exponents begin elsewhere, and have a sign.
        let mut buffer = zmij::Buffer::new();
        let shortest = buffer.format(*value);
        let is_as_asked = if is_plain { !shortest.contains('e') } else { shortest.contains("e-") };
        if is_as_asked {
            f.write_str(shortest.strip_suffix(".0").unwrap_or(shortest))
        } else if is_plain {
            Display::fmt(value, f)
        } else {
            LowerExp::fmt(value, f)
        }
    }
}

/// The number rounded to `digits` significant digits.
pub(crate) fn rounded(value: f64, digits: usize) -> f64 {
    format!("{value:.*e}", digits - 1).parse().unwrap_or(value)
}

/// Prints a warning to standard error.
#[expect(clippy::print_stderr, reason = "standard output holds results only")]
pub(crate) fn warn(message: &str) {
    eprintln!("asperity: warning: {message}");
}

/// Prints a note to standard error.
#[expect(clippy::print_stderr, reason = "standard output holds results only")]
pub(crate) fn note(message: &str) {
    if !is_quiet() {
        eprintln!("asperity: {message}");
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
    progress(Some(length), "{bar:40} {percent:>3} %  {msg}  {eta} left", "{percent} % done, {eta} left  {msg}")
}

/// A count of `what` is done, where nobody knows of how many; shown as [`bar`] is.
pub(crate) fn counter(what: &str) -> ProgressBar {
    progress(
        None,
        &format!("{{spinner}} {{pos}} {what}  {{msg}}  {{elapsed}}"),
        &format!("{{pos}} {what}, {{elapsed}}  {{msg}}"),
    )
}

fn progress(length: Option<u64>, for_terminals: &str, as_lines: &str) -> ProgressBar {
    let (target, template) = match is_quiet() {
        true => (ProgressDrawTarget::hidden(), for_terminals),
        false if io::stderr().is_terminal() => (ProgressDrawTarget::stderr(), for_terminals),
        false => (ProgressDrawTarget::term_like(Box::new(ProgressLines::new())), as_lines),
    };
    let bar = ProgressBar::with_draw_target(length, target);
    match ProgressStyle::with_template(template) {
        Ok(style) => bar.with_style(style),
        Err(_) => bar,
    }
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
    fn numbers_far_from_one_have_an_exponent_and_few_digits_if_asked_for() {
        assert_eq!([0.0, 1e-3, -12.5, 1e5].map(|value| decimal(value, 1e-3..1e5)), ["0", "0.001", "-12.5", "1e5"]);
        assert_eq!(
            [rounded(0.1 + 0.2, 12), rounded(-1234.5, 2), rounded(f64::INFINITY, 3)],
            [0.3, -1200.0, f64::INFINITY]
        );
    }

    #[test]
    fn numbers_in_files_are_short_and_read_back_as_the_same() {
        for (value, text) in [(0.0, "0"), (1e-5, "1e-5"), (0.1 + 0.2, "0.30000000000000004"), (-2.5, "-2.5")] {
            assert_eq!(real(value), text);
            assert_eq!(real(value).parse::<f64>().unwrap().to_bits(), value.to_bits());
        }
    }

    /// The text of the standard library, bit for bit of the number and letter for letter.
    #[test]
    fn numbers_in_files_are_those_of_the_standard_library() {
        let edges =
            [-0.0, 5e-324, f64::MIN_POSITIVE, f64::MAX, 1e-4, 9.999e-5, 1e15, 1e16, 1e22, 123_456_789_012_345_680.0];
        let others = (-330..310).map(|power| 1.234_567_890_123_4 * 10_f64.powi(power));
        for value in edges.into_iter().chain(others).chain([f64::INFINITY, f64::NEG_INFINITY, f64::NAN]) {
            let is_plain = value == 0.0 || (1e-4..1e16).contains(&value.abs());
            assert_eq!(real(value), if is_plain { format!("{value}") } else { format!("{value:e}") });
        }
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

    #[test]
    fn lines_are_aligned() {
        assert_eq!(lines(&labelled("Scene", ["a".into(), "b".into()])), "Scene       a\n            b\n");
    }
}
