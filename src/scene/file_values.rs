//! What a scene or a patch was read from, as values: with some of them changed it is read anew, by the same reader and
//! without its files.

use std::any::Any;
use std::collections::BTreeMap;
use std::fmt;
use std::io;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::sync::{Arc, OnceLock};

use toml::de::{DeTable, DeValue};
use toml::{Spanned, Table, Value};

use super::error::{Location, Problem, SceneError};
use super::values::{closest, similar_word};
use super::{CanonicalFiles, FileFormats, LoadedProfile, ProfileOptions, read_file};

type Result<T> = std::result::Result<T, SceneError>;

/// Longer values are cut in messages.
const GIVEN_LENGTH: usize = 60;

/// A key of a scene or a patch and the value that it is to have.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Setting {
    /// The path of the key, elements of lists counted from 1.
    pub key: String,
    /// The value, as a file has it.
    pub value: Value,
}

impl Setting {
    /// A key with a value.
    pub fn new(key: impl Into<String>, value: impl Into<Value>) -> Self {
        Self { key: key.into(), value: value.into() }
    }

    /// A key with the value that a text stands for. What is no value of TOML is a text, so that words need no quotation
    /// marks, or a number such as `.5`.
    pub fn parse(key: impl Into<String>, text: &str) -> Self {
        let is_digit_or_sign = |first: char| first.is_ascii_digit() || "+-.".contains(first);
        let number = || text.parse::<f64>().ok().filter(|_| text.starts_with(is_digit_or_sign));
        Self::new(key, text.parse().unwrap_or_else(|_| number().map_or_else(|| text.into(), Value::from)))
    }
}

/// Of `key=value`.
impl FromStr for Setting {
    type Err = String;

    fn from_str(text: &str) -> std::result::Result<Self, String> {
        match text.split_once('=') {
            Some((key, value)) if !key.trim().is_empty() => Ok(Self::parse(key.trim(), value.trim())),
            _ => Err("expected KEY=VALUE, such as solver.relative_tolerance=1e-9".to_owned()),
        }
    }
}

impl fmt::Display for Setting {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} = {}", self.key, self.value)
    }
}

/// The values of a scene file or of a patch file, and the files that it names.
#[derive(Clone)]
pub struct FileValues {
    file: PathBuf,
    /// The text of the file, for the places of its keys; nothing is read from it again. `None` once keys are set, as what
    /// is wrong then need not be wrong in the file.
    text: Option<Arc<str>>,
    pub(super) root: Table,
    pub(super) formats: &'static dyn FileFormats,
    pub(super) files: NamedFiles,
    /// What is read of them, once it was asked for.
    read: OnceLock<Arc<dyn Any + Send + Sync>>,
}

/// The files that a scene names, read once.
#[derive(Clone, Default)]
pub(super) struct NamedFiles {
    contents: BTreeMap<PathBuf, Arc<[u8]>>,
    pub(super) profiles: Vec<(PathBuf, ProfileOptions, Arc<LoadedProfile>)>,
}

impl NamedFiles {
    /// The bytes of the file at `path`.
    pub(super) fn bytes(&mut self, path: &Path) -> io::Result<Arc<[u8]>> {
        if let Some(bytes) = self.contents.get(path) {
            return Ok(bytes.clone());
        }
        let bytes: Arc<[u8]> = read_file(path)?.into();
        self.contents.insert(path.to_owned(), bytes.clone());
        Ok(bytes)
    }

    /// The file at `path` below a `folder`, or what an FMU carries in its place; and which of both was read.
    pub(super) fn read(&mut self, folder: &Path, path: &Path, carried_name: &Path) -> io::Result<(PathBuf, Arc<[u8]>)> {
        let (file, carried) = (folder.join(path), folder.join(carried_name));
        match self.bytes(&file) {
            Ok(bytes) => Ok((file, bytes)),
            Err(error) => self.bytes(&carried).map(|bytes| (carried, bytes)).map_err(|_| error),
        }
    }
}

/// Of what was made in code.
impl Default for FileValues {
    fn default() -> Self {
        let (file, root, files) = (PathBuf::new(), Table::new(), NamedFiles::default());
        Self { file, text: None, root, formats: &CanonicalFiles, files, read: OnceLock::new() }
    }
}

impl fmt::Debug for FileValues {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.file.display())
    }
}

/// What something was read from is no part of what it is.
impl PartialEq for FileValues {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

/// The values as the text of a file, without its comments.
impl fmt::Display for FileValues {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.root.fmt(f)
    }
}

/// A name on the path of a key, and which element of its list, from 0.
#[derive(Clone, Copy, Debug)]
struct PathPart<'a> {
    name: &'a str,
    element: Option<usize>,
}

/// The parts of a path, whose names may be in quotation marks; `None` where it is none.
fn parts(path: &str) -> Option<Vec<PathPart<'_>>> {
    let is_name = |name: &str| !name.is_empty() && name.chars().all(|c| c.is_alphanumeric() || c == '_' || c == '-');
    let (mut parts, mut rest) = (Vec::new(), Some(path));
    while let Some(path) = rest {
        let (name, behind) = match path.strip_prefix('"') {
            Some(quoted) => quoted.split_once('"')?,
            None => path.split_at(path.find(['.', '[']).unwrap_or(path.len())),
        };
        let (element, behind) = match behind.strip_prefix('[') {
            Some(list) => list.split_once(']').map(|(number, behind)| (Some(number), behind))?,
            None => (None, behind),
        };
        let element = match element {
            Some(number) => Some(number.parse::<usize>().ok()?.checked_sub(1)?),
            None => None,
        };
        if !is_name(name) && !path.starts_with('"') {
            return None;
        }
        parts.push(PathPart { name, element });
        rest = if behind.is_empty() { None } else { Some(behind.strip_prefix('.')?) };
    }
    Some(parts)
}

/// How deep tables and lists may lie within each other: scenes need half of it, and each level takes stack to read.
const DEEPEST: usize = 16;

/// Where a text goes deeper than that, by brackets and the dots of keys.
fn too_deep(text: &str) -> Option<usize> {
    let (mut open, mut depth, mut dots) = (Vec::new(), 0, 0);
    let mut next = 0;
    while let Some(letter) = text[next..].chars().next() {
        let place = next;
        let skip = match letter {
            '#' => text[place..].find('\n').unwrap_or(text.len() - place),
            '"' | '\'' => quoted_length(&text[place..], letter),
            _ => 0,
        };
        next += skip.max(letter.len_utf8());
        match letter {
            '[' | '{' => {
                open.push(1 + dots);
                depth += 1 + std::mem::take(&mut dots);
            }
            ']' | '}' => depth -= open.pop().unwrap_or(0),
            '.' => dots += 1,
            ',' | '=' | '\n' => dots = 0,
            _ => (),
        }
        if depth + dots > DEEPEST {
            return Some(place);
        }
    }
    None
}

/// The length of the string that a text begins with, quotation marks included.
fn quoted_length(text: &str, mark: char) -> usize {
    let marks = if text[1..].starts_with([mark; 2].iter().collect::<String>().as_str()) { 3 } else { 1 };
    let (mut escaped, mut row) = (false, 0);
    for (place, letter) in text.char_indices().skip(marks) {
        row = if letter == mark && !escaped { row + 1 } else { 0 };
        escaped = letter == '\\' && mark == '"' && !escaped;
        if row == marks || (marks == 1 && letter == '\n') {
            return place + 1;
        }
    }
    text.len()
}

/// Why a key cannot be set: what stands on its way.
enum Obstacle {
    /// A list that is the name of a file.
    NamedList(String),
    Other(String),
}

impl FileValues {
    /// The formats of the files that it names.
    pub fn formats(&self) -> &'static dyn FileFormats {
        self.formats
    }

    /// The values of a `text` as if it were the content of `file`.
    pub(super) fn parse(text: &str, file: &Path, formats: &'static dyn FileFormats) -> Result<Self> {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let values = Self { file: file.to_owned(), text: Some(text.into()), formats, ..Self::default() };
        if let Some(place) = too_deep(text) {
            let reason = format!("tables and lists within each other, more than {DEEPEST} deep");
            return Err(SceneError::new(values.place(place), "", Problem::Syntax { reason }));
        }
        let root = text.parse().map_err(|error: toml::de::Error| {
            let location = values.place(error.span().map_or(0, |span| span.start));
            SceneError::new(location, "", Problem::Syntax { reason: error.message().trim().replace('\n', "; ") })
        })?;
        Ok(Self { root, ..values })
    }

    /// What `read` makes of them as they are, found once; `None` where nothing can be read of them, as of what was made in
    /// code.
    pub(super) fn as_read<T: Any + Send + Sync>(&self, read: impl FnOnce(Self) -> Result<T>) -> Option<Arc<T>> {
        if let Some(found) = self.read.get() {
            return found.clone().downcast().ok();
        }
        let found = Arc::new(read(self.clone()).ok()?);
        let _ = self.read.set(found.clone());
        Some(found)
    }

    /// The path of the file.
    pub fn file(&self) -> &Path {
        &self.file
    }

    /// Its folder, where the files are that it names.
    pub(super) fn folder(&self) -> &Path {
        self.file.parent().unwrap_or(Path::new(""))
    }

    /// What stands at a key, elements of lists counted from 1; `None` where nothing does.
    pub fn get(&self, key: &str) -> Option<&Value> {
        let mut parts = parts(key)?.into_iter();
        let first = parts.next()?;
        parts.try_fold(at(&self.root, first)?, |value, part| at(value.as_table()?, part))
    }

    /// What `read` makes of the values with keys set. What is wrong in the file without them is told as it is there.
    ///
    /// # Errors
    /// Those of `read`, without a place where they come of what is set.
    pub(super) fn with<T>(self, settings: &[Setting], read: impl Fn(Self, &[Setting]) -> Result<T>) -> Result<T> {
        read(self.clone(), settings).map_err(|error| {
            let is_set = settings.iter().any(|setting| is_below(error.key(), &setting.key));
            let own = if is_set || settings.is_empty() { None } else { read(self, &[]).err() };
            own.filter(|own| own.key() == error.key()).unwrap_or(error)
        })
    }

    /// Gives keys values, those in lists that are files left out: these lists with the settings in them.
    ///
    /// # Errors
    /// Where a key leads nowhere.
    pub(super) fn set_all(&mut self, settings: &[Setting]) -> Result<Vec<(String, Setting)>> {
        let mut in_files = Vec::new();
        self.text = self.text.take().filter(|_| settings.is_empty());
        self.read = OnceLock::new();
        for setting in settings {
            let Setting { key, value } = setting;
            let refused = |expected: String| SceneError::new(Location::default(), key, Problem::value(value, expected));
            let expected =
                "the path of a key, such as solver.relative_tolerance or layer.vertical.maxwell[1].stiffness";
            let parts = parts(key).ok_or_else(|| refused(expected.to_owned()))?;
            match set_below(&mut self.root, "", &parts, value) {
                Ok(()) => (),
                Err(Obstacle::NamedList(list)) => in_files.push((list, setting.clone())),
                Err(Obstacle::Other(expected)) => return Err(refused(expected)),
            }
        }
        Ok(in_files)
    }

    /// Sets keys of a file that has no lists read from other files.
    ///
    /// # Errors
    /// Where a key is none of the `file`, or leads nowhere.
    pub(super) fn set_own(&mut self, settings: &[Setting], file: &str) -> Result<()> {
        match self.set_all(settings)?.into_iter().next() {
            Some((_, Setting { key, value })) => {
                let problem = Problem::value(value, format_args!("a key of the {file}"));
                Err(SceneError::new(Location::default(), key, problem))
            }
            None => Ok(()),
        }
    }

    /// The error of what is at a path.
    pub fn error(&self, path: &str, problem: Problem) -> SceneError {
        SceneError::new(self.location(path), path, problem)
    }

    /// Refuses the value at a path for not being what was `expected`; of words in quotation marks, one that looks like it is
    /// named.
    pub fn refuse(&self, path: &str, expected: impl ToString) -> SceneError {
        let (expected, value) = (expected.to_string(), self.get(path));
        let meant = value.and_then(Value::as_str).and_then(|given| similar_word(given, &expected));
        let hint = meant.map(|word| format!("; did you mean \"{word}\"?")).unwrap_or_default();
        let given = value.map(|value| self.given(path, value)).unwrap_or_default();
        self.error(path, Problem::value(given, expected + &hint))
    }

    /// Refuses the key at a path, of a table that has those `allowed` alone.
    pub fn unknown(&self, path: &str, allowed: &[&str]) -> SceneError {
        let name = path.rsplit('.').next().unwrap_or_default();
        let allowed: Vec<String> = allowed.iter().map(|name| (*name).to_owned()).collect();
        let similar = closest(name, allowed.iter().cloned());
        self.error(path, Problem::Unknown { allowed, similar })
    }

    /// Where the value at a path stands in the file, or the name of a table; where it is not there, what is around it. None
    /// where keys are set.
    pub(super) fn location(&self, path: &str) -> Location {
        self.place(self.span(path).offset)
    }

    fn place(&self, offset: usize) -> Location {
        let Some(text) = &self.text else { return Location::default() };
        let before = text.as_bytes().iter().take(offset);
        Location { file: self.file.clone(), line: Some(1 + before.filter(|&&byte| byte == b'\n').count()) }
    }

    /// Where something is in the text, to name the first of several.
    pub(super) fn offset(&self, path: &str) -> usize {
        self.span(path).offset
    }

    /// The value at a path as it was written, on one line and cut where it is long.
    pub(super) fn given(&self, path: &str, value: &Value) -> String {
        let written = self.text.as_ref().and_then(|text| text.get(self.span(path).whole?));
        let text = written.map_or_else(|| value.to_string(), str::to_owned);
        let line = text.split_whitespace().collect::<Vec<_>>().join(" ");
        match line.char_indices().nth(GIVEN_LENGTH) {
            Some((end, _)) => format!("{}...", &line[..end]),
            None => line,
        }
    }

    fn span(&self, path: &str) -> Span {
        let mut span = Span::default();
        let document = self.text.as_ref().and_then(|text| DeTable::parse(text).ok());
        let (Some(document), Some(parts)) = (document, parts(path)) else { return span };
        let mut table = Some(document.get_ref());
        for part in parts {
            let found = table.and_then(|table| table.get_key_value(part.name));
            let Some((name, value)) = found else { return Span { whole: None, ..span } };
            span = Span::of(value, name.span().start);
            let element = part.element.map_or(Some(value), |element| value.get_ref().get(element));
            let Some(value) = element else { return Span { whole: None, ..span } };
            if part.element.is_some() {
                span = Span::of(value, value.span().start);
            }
            table = value.get_ref().as_table();
        }
        span
    }
}

/// Where a value is in the text.
#[derive(Default)]
struct Span {
    /// Where to look for it: its start, or that of a table's name.
    offset: usize,
    /// `None` of what is not there.
    whole: Option<Range<usize>>,
}

impl Span {
    fn of(value: &Spanned<DeValue<'_>>, name: usize) -> Self {
        let whole = value.span();
        Self { offset: if value.get_ref().is_table() { name } else { whole.start }, whole: Some(whole) }
    }
}

/// Whether a path is that of a `key` or below it.
fn is_below(path: &str, key: &str) -> bool {
    path.strip_prefix(key).is_some_and(|rest| rest.is_empty() || rest.starts_with(['.', '[']))
}

fn at<'a>(table: &'a Table, part: PathPart<'_>) -> Option<&'a Value> {
    let value = table.get(part.name)?;
    part.element.map_or(Some(value), |element| value.get(element))
}

/// Sets what is at the path below a table, whose name is `start` with a dot behind it.
fn set_below(
    table: &mut Table,
    start: &str,
    path: &[PathPart<'_>],
    value: &Value,
) -> std::result::Result<(), Obstacle> {
    let [part, rest @ ..] = path else { return Ok(()) };
    let name = format!("{start}{}", part.name);
    let nothing_below = |found: &str| Obstacle::Other(format!("a key that the file can have; {name} is {found} there"));
    let place = match part.element {
        None if rest.is_empty() => {
            table.insert(part.name.to_owned(), value.clone());
            return Ok(());
        }
        None => table.entry(part.name).or_insert_with(|| Table::new().into()),
        Some(_) => table.get_mut(part.name).ok_or_else(|| nothing_below("not"))?,
    };
    let (place, name) = match (part.element, place) {
        (None, place) => (place, name.clone()),
        (Some(_), Value::String(_)) if !rest.is_empty() => return Err(Obstacle::NamedList(name)),
        (Some(element), Value::Array(list)) => {
            let count = list.len();
            let outside = || Obstacle::Other(format!("one of the {count} elements of {name}, counted from 1"));
            (list.get_mut(element).ok_or_else(outside)?, format!("{name}[{}]", element + 1))
        }
        (Some(_), place) => return Err(nothing_below(kind(place))),
    };
    if rest.is_empty() {
        *place = value.clone();
        return Ok(());
    }
    match place {
        Value::Table(table) => set_below(table, &format!("{name}."), rest, value),
        place => Err(nothing_below(kind(place))),
    }
}

fn kind(value: &Value) -> &'static str {
    match value {
        Value::Table(_) => "a table",
        Value::Array(_) => "a list",
        Value::String(_) => "a text",
        Value::Boolean(_) => "true or false",
        _ => "a number",
    }
}
