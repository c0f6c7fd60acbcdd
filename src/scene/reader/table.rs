//! Typed reading of tables of values, checked against the table of keys; every value knows its key's path, by which an
//! error finds it in the file.

use toml::{Table, Value as TomlValue};

use crate::scene::error::{Location, Problem, SceneError};
use crate::scene::file_values::FileValues;
use crate::scene::keys::{self, Absent, Allowed, At, Field, Form, Key, Kinds};
use crate::scene::values::{NumberRange, Value, Word, closest, words};
use crate::scene::{Scene, Unit};
use crate::tables::POSITIVE;

pub(super) type Result<T> = std::result::Result<T, SceneError>;

/// What is read: the values of a file and what kind of file it is.
#[derive(Clone, Copy, Debug)]
pub(super) struct Source<'a> {
    pub(super) values: &'a FileValues,
    pub(super) form: Form,
    /// The keys that such a file has.
    pub(super) keys: &'static [Key],
}

/// A value, its key and the key's full path.
#[derive(Clone, Debug)]
pub(super) struct Entry<'a> {
    source: Source<'a>,
    path: String,
    key: &'static Key,
    value: &'a TomlValue,
}

/// A table that hands out its values and remembers which keys were asked for.
#[derive(Debug)]
pub(super) struct TableReader<'a> {
    source: Source<'a>,
    path: String,
    table: &'a Table,
    keys: &'static [Key],
    asked: Vec<&'static str>,
}

impl<'a> Entry<'a> {
    pub(super) fn path(&self) -> &str {
        &self.path
    }

    pub(super) fn location(&self) -> Location {
        self.source.values.location(&self.path)
    }

    pub(super) fn source(&self) -> Source<'a> {
        self.source
    }

    /// The value as it stands in the file, on one line and cut where it is long.
    pub(super) fn given(&self) -> String {
        self.source.values.given(&self.path, self.value)
    }

    pub(super) fn error(&self, problem: Problem) -> SceneError {
        self.source.values.error(&self.path, problem)
    }

    /// Refuses the value for not being what was `expected`; of words in quotation marks, one that looks like it is named.
    pub(super) fn refuse(&self, expected: impl ToString) -> SceneError {
        self.source.values.refuse(&self.path, expected)
    }

    pub(super) fn refuse_count(&self, count: usize, expected: &str) -> SceneError {
        self.error(Problem::value(format_args!("[{count} numbers]"), expected))
    }

    /// Refuses the value for not being what its key may hold.
    pub(super) fn refuse_type(&self) -> SceneError {
        self.refuse(self.key.allowed)
    }

    /// The file that it names cannot be read.
    pub(super) fn unreadable(&self, error: &std::io::Error) -> SceneError {
        self.error(Problem::Unreadable { given: self.given(), reason: error.to_string() })
    }

    pub(super) fn number(&self) -> Result<f64> {
        let Allowed::Number(range) = self.key.allowed else { return Err(self.refuse_type()) };
        self.number_of(self.value).filter(|&number| range.holds(number)).ok_or_else(|| self.refuse_number(range))
    }

    /// A number, in SI units or with a unit behind it: a text.
    fn number_of(&self, value: &TomlValue) -> Option<f64> {
        number_of(value, self.key.unit)
    }

    /// Refuses the value for not being a number of the range; of a text that begins as one the units are named, too.
    fn refuse_number(&self, range: NumberRange) -> SceneError {
        let units = self.key.unit.readable();
        let is_like_a_number =
            |text: &str| text.trim_start().starts_with(|c: char| c.is_ascii_digit() || "+-.".contains(c));
        match self.value.as_str().is_some_and(is_like_a_number) && !units.is_empty() {
            true => self.refuse(format_args!("{range}, in SI units or as a text with its unit, one of {units}")),
            false => self.refuse(range),
        }
    }

    pub(super) fn whole(&self) -> Result<i64> {
        let Allowed::Whole(range) = self.key.allowed else { return Err(self.refuse_type()) };
        self.value.as_integer().filter(|&number| range.holds(number)).ok_or_else(|| self.refuse(range))
    }

    /// The number or the word that its key holds.
    fn value(&self) -> Result<Value> {
        match self.key.allowed {
            Allowed::Number(_) => self.number().map(Value::Real),
            Allowed::Whole(_) => Ok(Value::Integer(i32::try_from(self.whole()?).unwrap_or(i32::MAX))),
            _ => self.text().map(|word| Value::Text(word.to_owned())),
        }
    }

    pub(super) fn flag(&self) -> Result<bool> {
        self.value.as_bool().ok_or_else(|| self.refuse_type())
    }

    pub(super) fn text(&self) -> Result<&'a str> {
        self.value.as_str().ok_or_else(|| self.refuse_type())
    }

    /// The texts of a table by their keys; `None` of anything else.
    pub(super) fn texts_by_name(&self) -> Option<Vec<(String, String)>> {
        let table = self.value.as_table()?;
        let text = |(key, value): (&String, &TomlValue)| Some((key.clone(), value.as_str()?.to_owned()));
        table.iter().map(text).collect()
    }

    /// A number above 0 in `unit`, at no place (0); or such numbers at places, numbers in the unit of `at` that stand as keys.
    /// `None` of anything else.
    pub(super) fn numbers_at(&self, at: Unit, unit: Unit) -> Option<Vec<(f64, f64)>> {
        let number = |value: &TomlValue| number_of(value, unit).filter(|number| POSITIVE.holds(*number));
        let Some(table) = self.value.as_table() else { return Some(vec![(0.0, number(self.value)?)]) };
        let place = |key: &str| key.parse().ok().or_else(|| at.read(key)).filter(|place| POSITIVE.holds(*place));
        table.iter().map(|(key, value)| Some((place(key)?, number(value)?))).collect()
    }

    pub(super) fn is_text(&self) -> bool {
        self.value.is_str()
    }

    pub(super) fn is_table(&self) -> bool {
        self.value.is_table()
    }

    /// Whether it names a file: by its path, or in a table.
    pub(super) fn is_file(&self) -> bool {
        self.is_text() || self.is_table()
    }

    pub(super) fn choice<T: Word>(&self) -> Result<T> {
        self.value.as_str().and_then(T::parse).ok_or_else(|| self.refuse(words::<T>()))
    }

    pub(super) fn numbers(&self) -> Result<Vec<f64>> {
        let Allowed::Numbers(range) = self.key.allowed else { return Err(self.refuse_type()) };
        let values = self.value.as_array().ok_or_else(|| self.refuse_type())?;
        let read =
            |(i, value): (usize, &TomlValue)| self.number_of(value).filter(|&number| range.holds(number)).ok_or(i);
        let numbers: std::result::Result<_, usize> = values.iter().enumerate().map(read).collect();
        numbers.map_err(|i| self.element(i).unwrap_or_else(|| self.clone()).refuse_number(range))
    }

    /// The numbers of an array, or a single number without one.
    pub(super) fn number_or_numbers(&self) -> Result<Vec<f64>> {
        let Allowed::Numbers(range) = self.key.allowed else { return Err(self.refuse_type()) };
        match self.number_of(self.value) {
            Some(number) if range.holds(number) => Ok(vec![number]),
            None if !self.is_text() => self.numbers(),
            _ => Err(self.refuse_number(range)),
        }
    }

    /// The elements of an array, their keys counted from 1.
    pub(super) fn elements(&self) -> Result<Vec<Self>> {
        let count = self.value.as_array().ok_or_else(|| self.refuse_type())?.len();
        Ok((0..count).filter_map(|i| self.element(i)).collect())
    }

    /// Element `i` of an array, counted from 0.
    pub(super) fn element(&self, i: usize) -> Option<Self> {
        let value = self.value.get(i)?;
        Some(Self { path: format!("{}[{}]", self.path, i + 1), value, ..*self })
    }

    /// The table that it is; its keys are not checked before [`check_keys`](TableReader::check_keys).
    pub(super) fn open(&self) -> Result<TableReader<'a>> {
        self.open_with(self.key.keys())
    }

    /// The table that it is, which has these keys.
    pub(super) fn open_with(&self, keys: &'static [Key]) -> Result<TableReader<'a>> {
        let table = self.value.as_table().ok_or_else(|| self.refuse("a table"))?;
        let (source, path) = (self.source, self.path.clone());
        Ok(TableReader { source, path, table, keys, asked: Vec::new() })
    }

    /// What `read` makes of the table, all of whose keys are allowed and asked for.
    pub(super) fn table<T>(&self, read: impl FnOnce(&mut TableReader<'a>) -> Result<T>) -> Result<T> {
        let mut table = self.open()?;
        table.check_keys()?;
        let value = read(&mut table)?;
        table.finish()?;
        Ok(value)
    }

    /// What `read` makes of each table of the array.
    pub(super) fn tables<T>(&self, mut read: impl FnMut(&mut TableReader<'a>) -> Result<T>) -> Result<Vec<T>> {
        self.elements()?.iter().map(|entry| entry.table(&mut read)).collect()
    }
}

/// A number, in SI units or with a unit behind it: a text.
pub(super) fn number_of(value: &TomlValue, unit: Unit) -> Option<f64> {
    number(value).or_else(|| unit.read(value.as_str()?))
}

pub(in crate::scene) fn number(value: &TomlValue) -> Option<f64> {
    value.as_float().or_else(|| value.as_integer().map(|number| number as f64))
}

impl<'a> TableReader<'a> {
    /// The table of a whole file; its keys are checked.
    pub(super) fn root(source: Source<'a>) -> Result<Self> {
        let (path, table, keys) = (String::new(), &source.values.root, source.keys);
        let root = Self { source, path, table, keys, asked: Vec::new() };
        root.check_keys()?;
        Ok(root)
    }

    /// Whether the scene has a material.
    pub(super) fn is_material(&self) -> bool {
        self.source.form == Form::Material
    }

    /// From now on the table has the keys of its kind; they are checked.
    pub(super) fn use_keys(&mut self, kind: impl Kinds) -> Result<()> {
        self.keys = kind.keys();
        self.check_keys()
    }

    /// Refuses a key of the other form of a scene, then any unknown key, naming the first one in the file.
    ///
    /// Done before the values are read: a misspelt key is a clearer message than the missing one that it causes.
    pub(super) fn check_keys(&self) -> Result<()> {
        let form = self.source.form;
        let foreign = self.keys.iter().filter(|key| key.form.is_some_and(|other| other != form));
        if let Some(entry) = foreign.into_iter().find_map(|key| self.find(key)) {
            let own = self.keys.iter().filter(|key| key.form == Some(form)).map(|key| key.name);
            let own: Vec<&str> = own.collect();
            let instead = if own.is_empty() { String::new() } else { format!("; instead: {}", own.join(", ")) };
            let with = if form == Form::Direct { "without" } else { "beside" };
            return Err(entry.refuse(format_args!("no such key {with} [material]{instead}")));
        }
        let own = self.keys.iter().filter(|key| key.form.is_none_or(|own| own == form));
        self.allow(&own.map(|key| key.name).collect::<Vec<_>>())
    }

    /// Refuses the keys that the reader did not ask for: what is not read must not stand in a scene.
    pub(super) fn finish(self) -> Result<()> {
        self.allow(&self.asked)
    }

    fn allow(&self, allowed: &[&'static str]) -> Result<()> {
        let unknown = self.table.keys().filter(|name| !allowed.contains(&name.as_str()));
        match unknown.min_by_key(|name| self.source.values.offset(&self.full(name))) {
            Some(name) => {
                let allowed: Vec<String> = allowed.iter().copied().map(String::from).collect();
                let problem = Problem::Unknown { similar: self.similar(name, &allowed), allowed };
                Err(SceneError::new(self.source.values.location(&self.full(name)), self.full(name), problem))
            }
            None => Ok(()),
        }
    }

    /// The paths of keys that an unknown one may stand for: in this table, else in another one of the file.
    fn similar(&self, name: &str, allowed: &[String]) -> Vec<String> {
        let given = self.full(name);
        // Names of a letter or two are like too many.
        let is_long = |other: &&String| name.len().min(other.len()) > 2;
        let here = closest(&given, allowed.iter().filter(is_long).map(|name| self.full(name)));
        if here.is_empty() { keys::elsewhere(self.source.keys, self.source.form, &given) } else { here }
    }

    fn full(&self, name: &str) -> String {
        if self.path.is_empty() { name.to_owned() } else { format!("{}.{name}", self.path) }
    }

    fn key(&self, name: &str) -> &'static Key {
        self.keys.iter().find(|key| key.name == name).unwrap_or(&keys::NONE)
    }

    fn find(&self, key: &'static Key) -> Option<Entry<'a>> {
        Some(Entry { source: self.source, path: self.full(key.name), key, value: self.table.get(key.name)? })
    }

    /// Writes what the table says of the keys that have a field into `scene`, which has the tables around them.
    pub(super) fn fill(&mut self, scene: &mut Scene, at: At) -> Result<()> {
        let form = self.source.form;
        for key in self.keys.iter().filter(|key| key.form.is_none_or(|own| own == form)) {
            let Some(Field { set, .. }) = key.field else { continue };
            match self.entry(key.name) {
                Some(entry) => set(scene, at, &entry.value()?).ok_or_else(|| entry.refuse_type())?,
                None if key.absent == Absent::Refused => return Err(self.missing(key.name, key.allowed)),
                None => key.set_default(scene, at),
            }
        }
        Ok(())
    }

    /// The entry of a key, if the table has it.
    pub(super) fn entry(&mut self, name: &'static str) -> Option<Entry<'a>> {
        self.asked.push(name);
        self.find(self.key(name))
    }

    /// Whether the table has a key, known or not.
    pub(super) fn has(&self, name: &str) -> bool {
        self.table.contains_key(name)
    }

    /// The entry of a key that must be there.
    pub(super) fn required(&mut self, name: &'static str) -> Result<Entry<'a>> {
        let expected = self.key(name).allowed;
        self.entry(name).ok_or_else(|| self.missing(name, expected))
    }

    pub(super) fn missing(&self, name: &str, expected: impl ToString) -> SceneError {
        let problem = Problem::Missing { expected: expected.to_string() };
        SceneError::new(self.source.values.location(&self.path), self.full(name), problem)
    }

    pub(super) fn number(&mut self, name: &'static str) -> Result<f64> {
        self.required(name)?.number()
    }

    pub(super) fn optional_number(&mut self, name: &'static str) -> Result<Option<f64>> {
        self.entry(name).map(|entry| entry.number()).transpose()
    }

    pub(super) fn whole(&mut self, name: &'static str) -> Result<i64> {
        self.required(name)?.whole()
    }

    pub(super) fn optional_whole(&mut self, name: &'static str) -> Result<Option<i64>> {
        self.entry(name).map(|entry| entry.whole()).transpose()
    }

    /// A flag; `false` where it is not given.
    pub(super) fn flag(&mut self, name: &'static str) -> Result<bool> {
        self.entry(name).map_or(Ok(false), |entry| entry.flag())
    }

    pub(super) fn optional_choice<T: Word>(&mut self, name: &'static str) -> Result<Option<T>> {
        self.entry(name).map(|entry| entry.choice()).transpose()
    }

    /// What `read` makes of the table `name`, if it is there.
    pub(super) fn optional_table<T>(
        &mut self,
        name: &'static str,
        read: impl FnOnce(&mut TableReader<'a>) -> Result<T>,
    ) -> Result<Option<T>> {
        self.entry(name).map(|entry| entry.table(read)).transpose()
    }

    /// What `read` makes of each table of the array `name`; nothing where it is left out.
    pub(super) fn tables<T>(
        &mut self,
        name: &'static str,
        read: impl FnMut(&mut TableReader<'a>) -> Result<T>,
    ) -> Result<Vec<T>> {
        self.entry(name).map_or_else(|| Ok(Vec::new()), |entry| entry.tables(read))
    }
}
