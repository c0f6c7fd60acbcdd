//! Tyre property files (`.tir`): numbers read, and set with all else as it was.
//!
//! The TeimOrbit format: sections `[NAME]`, lines `KEY = value`, comments behind `$` or `!`, names in any case.

use std::ops::Range;
use std::path::{Path, PathBuf};

use asperity::tables::{NumberRange, POSITIVE, Unit};

use crate::error::Error;
use crate::files::bytes;

/// A property file.
#[derive(Clone, Debug)]
pub struct PropertyFile {
    file: PathBuf,
    /// A character for each byte: what is not read stays as it is, in whatever encoding.
    text: String,
    sections: Vec<Section>,
    entries: Vec<Entry>,
}

#[derive(Clone, Debug)]
struct Section {
    name: String,
    line: usize,
    /// Where the line behind its header begins.
    end: usize,
}

#[derive(Clone, Debug)]
struct Entry {
    section: String,
    key: String,
    line: usize,
    /// Where its value is, without what surrounds it.
    value: Range<usize>,
}

impl PropertyFile {
    /// Reads the file at `path`.
    ///
    /// # Errors
    /// Where it cannot be read, is no text of one byte a character, or a section has no end or comes twice.
    pub fn read(path: &Path) -> Result<Self, Error> {
        Self::parse(&bytes(path)?, path)
    }

    /// The file of these bytes, said to be at `path`; see [`read`](Self::read).
    ///
    /// # Errors
    /// As for [`read`](Self::read).
    pub fn parse(bytes: &[u8], path: &Path) -> Result<Self, Error> {
        let text = bytes.iter().map(|&byte| char::from(byte)).collect();
        let mut read = Self { file: path.to_owned(), text, sections: Vec::new(), entries: Vec::new() };
        if bytes.contains(&0) {
            return Err(read.error(None, "expected a text of one byte a character, found one with zeros (UTF-16?)"));
        }
        let lengths: Vec<usize> = read.text.split_inclusive('\n').map(str::len).collect();
        let mut start = 0;
        for (line, length) in (1..).zip(lengths) {
            read.add_line(start..start + length, line)?;
            start += length;
        }
        Ok(read)
    }

    fn add_line(&mut self, place: Range<usize>, line: usize) -> Result<(), Error> {
        let content = trimmed(&self.text, place.start..place.start + without_comment(&self.text[place.clone()]));
        let written = &self.text[content.clone()];
        if let Some(name) = written.strip_prefix('[') {
            let name = name.strip_suffix(']').map(|name| name.trim().to_ascii_uppercase());
            let name = name.ok_or_else(|| self.error(Some(line), format!("{written}: expected a section, [NAME]")))?;
            if let Some(first) = self.sections.iter().find(|section| section.name == name) {
                return Err(
                    self.error(Some(line), format!("[{name}]: expected once, found in line {} too", first.line))
                );
            }
            self.sections.push(Section { name, line, end: place.end });
        } else if let Some((key, _)) = written.split_once('=') {
            let value = trimmed(&self.text, content.start + key.len() + 1..content.end);
            let section = self.sections.last().map(|section| section.name.clone()).unwrap_or_default();
            self.entries.push(Entry { section, key: key.trim().to_ascii_uppercase(), line, value });
        }
        Ok(())
    }

    /// The entry of a key, which stands in no section but its own, and once.
    fn entry(&self, section: &str, key: &str) -> Result<Option<&Entry>, Error> {
        let mut found = self.entries.iter().filter(|entry| entry.key == key);
        let first = found.next();
        if let (Some(first), Some(again)) = (first, found.next()) {
            return Err(self.error(Some(again.line), format!("{key}: expected once, found in line {} too", first.line)));
        }
        match first {
            Some(entry) if entry.section != section => {
                let problem = format!("{key}: expected in [{section}], found in [{}]", entry.section);
                Err(self.error(Some(entry.line), problem))
            }
            found => Ok(found),
        }
    }

    /// The number of a key of a section; `None` where the file does not have it.
    ///
    /// # Errors
    /// Where it stands twice or in another section, or is no number of the range.
    pub fn number(&self, section: &str, key: &str, range: NumberRange) -> Result<Option<f64>, Error> {
        let read = |entry: &Entry| {
            let text = &self.text[entry.value.clone()];
            let number = text.parse().ok().filter(|number| range.holds(*number));
            number.ok_or_else(|| self.error(Some(entry.line), format!("{key} = {text}: expected {range}")))
        };
        self.entry(section, key)?.map(read).transpose()
    }

    /// FNOMIN, the load (N) that the coefficients are about, in the file's unit of force, newton where it names none.
    ///
    /// # Errors
    /// Where there is none, or the unit of force is none that is known.
    pub fn nominal_load(&self) -> Result<f64, Error> {
        let unit = self.entry("UNITS", "FORCE")?;
        let name = unit.map_or("newton", |entry| self.text[entry.value.clone()].trim_matches(['\'', '"', ' ']));
        let symbol = match &*name.to_ascii_lowercase() {
            "newton" | "n" => "N",
            "knewton" | "kilo_newton" | "kn" => "kN",
            "kilogram_force" | "kgf" => "kgf",
            _ => {
                let problem = format!("FORCE = '{name}': expected newton, knewton or kilogram_force");
                return Err(self.error(unit.map(|entry| entry.line), problem));
            }
        };
        let load = self.number("VERTICAL", "FNOMIN", POSITIVE)?;
        let newton = load.zip(Unit::parse(symbol)).map(|(load, unit)| unit.to_si(load));
        newton.ok_or_else(|| self.error(None, "[VERTICAL]: expected the nominal load, FNOMIN, found none"))
    }

    /// The bytes of the file with numbers set and a comment of these lines at the head of a section. A number that the
    /// file does not have is added to its section, and so is the section.
    ///
    /// # Errors
    /// Where a number stands twice or in another section.
    pub fn with(&self, section: &str, numbers: &[(&str, f64)], comment: &[String]) -> Result<Vec<u8>, Error> {
        let end_of_line = if self.text.contains("\r\n") { "\r\n" } else { "\n" };
        let head = self.sections.iter().find(|found| found.name == section);
        let place = head.map_or(self.text.len(), |head| head.end);
        let mut added = String::new();
        if place > 0 && !self.text[..place].ends_with('\n') {
            added += end_of_line;
        }
        if head.is_none() {
            added += &format!("[{section}]{end_of_line}");
        }
        added.extend(comment.iter().map(|line| format!("$ {}{end_of_line}", in_ascii(line))));
        let mut edits = Vec::new();
        for &(key, number) in numbers {
            match self.entry(section, key)? {
                Some(entry) => edits.push((entry.value.clone(), format!("{number}"))),
                None => added += &format!("{key} = {number}{end_of_line}"),
            }
        }
        edits.push((place..place, added));
        edits.sort_by_key(|(place, _)| place.start);
        let mut text = self.text.clone();
        edits.iter().rev().for_each(|(place, new)| text.replace_range(place.clone(), new));
        Ok(text.chars().map(|character| character as u8).collect())
    }

    /// What is wrong in the file.
    pub(super) fn error(&self, line: Option<usize>, problem: impl std::fmt::Display) -> Error {
        Error::in_file(&self.file, line, problem)
    }
}

/// The length of a line up to its comment, which does not begin within quotation marks.
fn without_comment(line: &str) -> usize {
    let mut within = false;
    let begins = |character: char| {
        within ^= character == '\'';
        !within && matches!(character, '$' | '!')
    };
    line.find(begins).unwrap_or(line.len())
}

/// A part of a text without the blanks about it.
fn trimmed(text: &str, part: Range<usize>) -> Range<usize> {
    let of = &text[part.clone()];
    let start = part.start + (of.len() - of.trim_start().len());
    start..start + of.trim().len()
}

/// A line as any reader of such files takes it.
fn in_ascii(line: &str) -> String {
    line.replace('°', "deg")
        .chars()
        .map(|character| if matches!(character, ' '..='~') { character } else { '?' })
        .collect()
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests may fail")]
mod tests {
    use super::*;

    const SECTION: &str = "SCALING_COEFFICIENTS";
    /// In Latin-1, with ends of lines of two bytes, blanks of all kinds, names in either case.
    const FILE: &[u8] =
        b"$--- caf\xe9 LMUX = 5\r\n[MDI_HEADER]\r\nFILE_TYPE='tir' ! LMUX = 6\r\n[units]\r\n FORCE = 'kN'\r\n\
        {radial width}\r\n1.0 0.4\r\n[VERTICAL]\r\nFNOMIN=2.75\t$nominal\r\n[Scaling_Coefficients]  $ here\r\n\
        lmux\t=  1.0E+00   $Scale\r\nLMUY = +.5$ 'half'\r\nLKX = 1\r\n$LKY = 7";

    fn parse(bytes: &[u8]) -> Result<PropertyFile, Error> {
        PropertyFile::parse(bytes, Path::new("base.tir"))
    }

    fn replaced(from: &str, to: &str) -> String {
        let text: String = FILE.iter().map(|&byte| char::from(byte)).collect();
        assert!(text.contains(from), "{from}");
        text.replacen(from, to, 1)
    }

    #[test]
    fn numbers_are_read_and_set_and_the_rest_stays() {
        let file = parse(FILE).unwrap();
        assert_eq!(file.nominal_load().unwrap(), 2750.0);
        let number = |key: &str| file.number(SECTION, key, POSITIVE).unwrap();
        assert_eq!(["LMUX", "LMUY", "LKX", "LKY"].map(number), [Some(1.0), Some(0.5), Some(1.0), None]);
        let set = file.with(SECTION, &[("LMUX", 0.8), ("LMUY", 0.25)], &["µ".into()]).unwrap();
        let mut expected = replaced("1.0E+00", "0.8").replacen("+.5", "0.25", 1);
        expected = expected.replacen("$ here\r\n", "$ here\r\n$ ?\r\n", 1);
        assert_eq!(set.iter().map(|&byte| char::from(byte)).collect::<String>(), expected);
        // With nothing to set all stays.
        assert_eq!(file.with(SECTION, &[], &[]).unwrap(), FILE);
    }

    #[test]
    fn what_is_missing_is_added_to_its_section() {
        let added = parse(FILE).unwrap().with(SECTION, &[("LKY", 1.25)], &[]).unwrap();
        let expected = replaced("$ here\r\n", "$ here\r\nLKY = 1.25\r\n");
        assert_eq!(added.iter().map(|&byte| char::from(byte)).collect::<String>(), expected);
        for (text, expected) in [
            ("[VERTICAL]\nFNOMIN = 1", "[VERTICAL]\nFNOMIN = 1\n[SCALING_COEFFICIENTS]\n$ c\nLKX = 2\n"),
            ("[SCALING_COEFFICIENTS]", "[SCALING_COEFFICIENTS]\n$ c\nLKX = 2\n"),
        ] {
            let file = parse(text.as_bytes()).unwrap();
            assert_eq!(file.with(SECTION, &[("LKX", 2.0)], &["c".into()]).unwrap(), expected.as_bytes());
        }
    }

    #[test]
    fn what_is_wrong_is_refused_where_it_is() {
        let said = |text: &str| {
            let bytes: Vec<u8> = text.chars().map(|character| character as u8).collect();
            let tried = parse(&bytes).and_then(|file| {
                file.nominal_load()?;
                file.number(SECTION, "LMUX", POSITIVE)
            });
            tried.unwrap_err().to_string()
        };
        for (from, to, expected) in [
            ("1.0E+00", "1,0", "base.tir:11: LMUX = 1,0: expected a number from"),
            ("1.0E+00", "0", "base.tir:11: LMUX = 0: expected a number from"),
            ("1.0E+00", "nan", "base.tir:11: LMUX = nan: expected a number from"),
            ("LKX", "LMUX", "base.tir:13: LMUX: expected once, found in line 11 too"),
            (
                "[VERTICAL]",
                "[Scaling_coefficients]",
                "base.tir:10: [SCALING_COEFFICIENTS]: expected once, found in line 8",
            ),
            ("[VERTICAL]", "[VERTICAL", "base.tir:8: [VERTICAL: expected a section, [NAME]"),
            ("[VERTICAL]", "[TIRE]", "base.tir:9: FNOMIN: expected in [VERTICAL], found in [TIRE]"),
            ("FNOMIN", "FZ", "base.tir: [VERTICAL]: expected the nominal load, FNOMIN, found none"),
            ("'kN'", "'stone'", "base.tir:5: FORCE = 'stone': expected newton"),
            ("caf", "\0", "base.tir: expected a text of one byte a character"),
        ] {
            let told = said(&replaced(from, to));
            assert!(told.starts_with(expected), "{told}\n{expected}");
        }
    }
}
