//! Typed reading of TOML tables that know their place in the file, so that every refusal can name it.

use std::ops;
use std::path::Path;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::allowed::{Choices, Range, WholeRange};
use super::error::Place;
use super::{Problem, SceneError};

type Result<T> = std::result::Result<T, SceneError>;

/// Longer values are cut in messages.
const GIVEN_LENGTH: usize = 60;

/// The scene file: its name for messages, and its text.
#[derive(Clone, Copy, Debug)]
pub(super) struct Source<'a> {
    pub(super) file: &'a Path,
    pub(super) text: &'a str,
}

/// A value and the full path of its key.
#[derive(Clone, Debug)]
pub(super) struct Entry<'a> {
    source: Source<'a>,
    key: String,
    value: &'a DeValue<'a>,
    /// Where the value stands.
    span: ops::Range<usize>,
    /// Where to look for it: the start of the value, or of a table's name.
    offset: usize,
}

/// A table that hands out its values and remembers which keys were asked for.
#[derive(Debug)]
pub(super) struct TableReader<'a> {
    source: Source<'a>,
    path: String,
    offset: usize,
    table: &'a DeTable<'a>,
    asked: Vec<&'static str>,
}

impl<'a> Source<'a> {
    fn place(&self, offset: usize) -> Place {
        let before = self.text.as_bytes().iter().take(offset);
        Place { file: self.file.to_owned(), line: Some(1 + before.filter(|&&byte| byte == b'\n').count()) }
    }

    /// The document's syntax tree.
    pub(super) fn parse(&self) -> Result<Spanned<DeTable<'a>>> {
        DeTable::parse(self.text).map_err(|error| {
            let place = self.place(error.span().map_or(0, |span| span.start));
            SceneError::new(place, "", Problem::Syntax { reason: error.message().trim().replace('\n', "; ") })
        })
    }

    /// The folder of the scene file.
    pub(super) fn folder(&self) -> &'a Path {
        self.file.parent().unwrap_or(Path::new(""))
    }
}

impl<'a> Entry<'a> {
    pub(super) fn key(&self) -> &str {
        &self.key
    }

    pub(super) fn place(&self) -> Place {
        self.source.place(self.offset)
    }

    pub(super) fn source(&self) -> Source<'a> {
        self.source
    }

    /// The value as it stands in the file, on one line and cut where it is long.
    pub(super) fn given(&self) -> String {
        let text = self.source.text.get(self.span.clone()).unwrap_or_default();
        let line = text.split_whitespace().collect::<Vec<_>>().join(" ");
        match line.char_indices().nth(GIVEN_LENGTH) {
            Some((end, _)) => format!("{}...", &line[..end]),
            None => line,
        }
    }

    pub(super) fn problem(&self, problem: Problem) -> SceneError {
        SceneError::new(self.place(), &self.key, problem)
    }

    /// Refuses the value for not being what was `expected`.
    pub(super) fn refuse(&self, expected: impl ToString) -> SceneError {
        self.problem(Problem::Value { given: self.given(), expected: expected.to_string() })
    }

    pub(super) fn number(&self, range: &Range) -> Result<f64> {
        number(self.value).filter(|&number| range.holds(number)).ok_or_else(|| self.refuse(range))
    }

    pub(super) fn whole(&self, range: &WholeRange) -> Result<i64> {
        whole(self.value).filter(|&number| range.holds(number)).ok_or_else(|| self.refuse(range))
    }

    pub(super) fn flag(&self) -> Result<bool> {
        self.value.as_bool().ok_or_else(|| self.refuse("true or false"))
    }

    pub(super) fn text(&self, expected: &str) -> Result<&'a str> {
        self.value.as_str().ok_or_else(|| self.refuse(expected))
    }

    pub(super) fn choice<T: Copy + PartialEq>(&self, choices: &Choices<T>) -> Result<T> {
        let word = self.text(&choices.to_string())?;
        choices.find(word, &self.given()).map_err(|problem| self.problem(problem))
    }

    pub(super) fn numbers(&self, range: &Range) -> Result<Vec<f64>> {
        let values = self.value.as_array().ok_or_else(|| self.refuse(format_args!("an array, each {range}")))?;
        let read = |(i, value): (usize, &Spanned<DeValue<'_>>)| {
            number(value.get_ref()).filter(|&number| range.holds(number)).ok_or(i)
        };
        let numbers: std::result::Result<_, usize> = values.iter().enumerate().map(read).collect();
        numbers.map_err(|i| self.element(i).unwrap_or_else(|| self.clone()).refuse(range))
    }

    /// The elements of an array, their keys counted from 1.
    pub(super) fn elements(&self, expected: &str) -> Result<Vec<Self>> {
        let count = self.value.as_array().ok_or_else(|| self.refuse(expected))?.len();
        Ok((0..count).filter_map(|i| self.element(i)).collect())
    }

    /// Element `i` of an array, counted from 0.
    pub(super) fn element(&self, i: usize) -> Option<Self> {
        let value = self.value.get(i)?;
        let key = format!("{}[{}]", self.key, i + 1);
        let span = value.span();
        Some(Self { source: self.source, key, value: value.get_ref(), offset: span.start, span })
    }

    pub(super) fn table(&self) -> Result<TableReader<'a>> {
        let table = self.value.as_table().ok_or_else(|| self.refuse("a table"))?;
        Ok(TableReader { source: self.source, path: self.key.clone(), offset: self.offset, table, asked: Vec::new() })
    }
}

fn number(value: &DeValue<'_>) -> Option<f64> {
    match value {
        DeValue::Float(float) => float.as_str().parse().ok(),
        _ => whole(value).map(|number| number as f64),
    }
}

fn whole(value: &DeValue<'_>) -> Option<i64> {
    let integer = value.as_integer()?;
    i64::from_str_radix(integer.as_str(), integer.radix()).ok()
}

impl<'a> TableReader<'a> {
    pub(super) fn root(source: Source<'a>, table: &'a DeTable<'a>) -> Self {
        Self { source, path: String::new(), offset: 0, table, asked: Vec::new() }
    }

    /// Refuses any key that is not `allowed`, naming the first one in the file.
    ///
    /// Done before the values are read: a misspelt key is a clearer message than the missing one that it causes.
    pub(super) fn allow(&self, allowed: &[&'static str]) -> Result<()> {
        let strange = |key: &&Spanned<_>| !allowed.contains(&name(key));
        match self.table.keys().filter(strange).min_by_key(|key| key.span().start) {
            Some(key) => Err(self.strange_key(key, allowed)),
            None => Ok(()),
        }
    }

    fn strange_key(&self, key: &DeKey<'_>, allowed: &[&'static str]) -> SceneError {
        let problem = Problem::Unknown { allowed: allowed.iter().copied().map(String::from).collect() };
        SceneError::new(self.source.place(key.span().start), self.full(name(key)), problem)
    }

    /// Refuses the keys that nobody asked for: what is not read must not stand in a scene.
    pub(super) fn finish(self) -> Result<()> {
        self.allow(&self.asked)
    }

    /// The full path of one of the table's keys.
    pub(super) fn full(&self, key: &str) -> String {
        if self.path.is_empty() { key.to_owned() } else { format!("{}.{key}", self.path) }
    }

    pub(super) fn missing(&self, key: &str, expected: impl ToString) -> SceneError {
        let problem = Problem::Missing { expected: expected.to_string() };
        SceneError::new(self.source.place(self.offset), self.full(key), problem)
    }

    pub(super) fn entry(&mut self, key: &'static str) -> Option<Entry<'a>> {
        self.asked.push(key);
        let (found, value) = self.table.get_key_value(key)?;
        let span = value.span();
        let offset = if value.get_ref().is_table() { found.span().start } else { span.start };
        Some(Entry { source: self.source, key: self.full(key), value: value.get_ref(), span, offset })
    }

    pub(super) fn required(&mut self, key: &'static str, expected: impl ToString) -> Result<Entry<'a>> {
        self.entry(key).ok_or_else(|| self.missing(key, expected))
    }

    pub(super) fn number(&mut self, key: &'static str, range: &Range) -> Result<f64> {
        self.required(key, range)?.number(range)
    }

    pub(super) fn optional_number(&mut self, key: &'static str, range: &Range) -> Result<Option<f64>> {
        self.entry(key).map(|entry| entry.number(range)).transpose()
    }

    pub(super) fn optional_whole(&mut self, key: &'static str, range: &WholeRange) -> Result<Option<i64>> {
        self.entry(key).map(|entry| entry.whole(range)).transpose()
    }

    pub(super) fn optional_flag(&mut self, key: &'static str) -> Result<Option<bool>> {
        self.entry(key).map(|entry| entry.flag()).transpose()
    }

    pub(super) fn optional_choice<T: Copy + PartialEq>(
        &mut self,
        key: &'static str,
        choices: &Choices<T>,
    ) -> Result<Option<T>> {
        self.entry(key).map(|entry| entry.choice(choices)).transpose()
    }

    /// What `read` makes of the table `key`, all of whose keys must have been asked for in the end.
    pub(super) fn optional_table<T>(
        &mut self,
        key: &'static str,
        read: impl FnOnce(&mut TableReader<'a>) -> Result<T>,
    ) -> Result<Option<T>> {
        self.entry(key).map(|entry| read_table(&entry, read)).transpose()
    }

    /// What `read` makes of each table of the array `key`; nothing where it is left out.
    pub(super) fn tables<T>(
        &mut self,
        key: &'static str,
        read: impl Fn(&mut TableReader<'a>) -> Result<T>,
    ) -> Result<Vec<T>> {
        match self.entry(key) {
            Some(entry) => entry.elements("an array of tables")?.iter().map(|entry| read_table(entry, &read)).collect(),
            None => Ok(Vec::new()),
        }
    }
}

type DeKey<'a> = Spanned<std::borrow::Cow<'a, str>>;

fn name<'k>(key: &'k DeKey<'_>) -> &'k str {
    key.get_ref()
}

/// What `read` makes of the table `entry`, all of whose keys must have been asked for in the end.
pub(super) fn read_table<'a, T>(entry: &Entry<'a>, read: impl FnOnce(&mut TableReader<'a>) -> Result<T>) -> Result<T> {
    let mut table = entry.table()?;
    let read = read(&mut table)?;
    table.finish()?;
    Ok(read)
}
