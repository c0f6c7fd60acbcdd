//! What a key is: its name, what it may hold, what it means, and where its value is in a scene.

use std::fmt;

use super::field::{At, Field};
use crate::scene::values::{NumberRange, Value, WholeRange, Word, words};
use crate::scene::{Scene, Unit};

#[derive(Clone, Copy, Debug)]
pub(in crate::scene) struct Key {
    pub(in crate::scene) name: &'static str,
    pub(in crate::scene) allowed: Allowed,
    /// The unit of a number; 1 for everything else.
    pub(in crate::scene) unit: Unit,
    /// What it means, in a few words: the description of a parameter.
    pub(in crate::scene) meaning: &'static str,
    /// The form of a scene that it belongs to; `None`: both.
    pub(in crate::scene) form: Option<Form>,
    pub(in crate::scene) absent: Absent,
    /// Where the value of a number or a word is in a scene; `None` where the reader does more than to write it there.
    pub(in crate::scene) field: Option<Field>,
    pub(in crate::scene) is_parameter: bool,
    /// What follows the meaning in the description of a parameter: of which of several equal tables it is.
    pub(in crate::scene) of: fn(At) -> String,
    /// Among the parameters it comes before the others of its table.
    pub(super) ahead: bool,
    /// Which of several equal tables it holds.
    pub(super) at: Option<At>,
}

/// What the absence of a key stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Absent {
    /// An error, wherever its table stands: but heights at the masses, as `layer.roughness` may give them, have no x.
    Refused,
    /// A value, as it would be written in the file.
    Value(&'static str),
    /// What follows from elsewhere, in a few words.
    Follows(&'static str),
    /// There is none, or the other keys of the table say whether there must be.
    None,
}

#[derive(Clone, Copy, Debug)]
pub(in crate::scene) enum Allowed {
    Number(NumberRange),
    Numbers(NumberRange),
    Whole(WholeRange),
    Flag,
    /// A text, and what it is.
    Text(&'static str),
    /// A word; the words to choose from.
    Word(fn() -> String),
    Words(fn() -> String),
    Table(&'static [Key]),
    /// An array of tables, and what it is.
    Tables(&'static [Key], &'static str),
    /// A table whose keys depend on one of them: those by which that is read, and those of each kind.
    Kinds(&'static [Key], fn() -> Vec<KindKeys>),
}

/// The word for a kind of table, and its keys.
pub(super) type KindKeys = (&'static str, &'static [Key]);

/// What a table may be, by the word of one of its keys.
pub(in crate::scene) trait Kinds: Word {
    /// The keys of a table of this kind.
    fn keys(self) -> &'static [Key];
}

pub(super) fn kinds<T: Kinds>() -> Vec<KindKeys> {
    T::WORDS.iter().map(|(name, kind)| (*name, kind.keys())).collect()
}

/// The two forms of a scene, of which it has exactly one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::scene) enum Form {
    /// By the mass and the constants of the links.
    Direct,
    /// By `[material]`, thickness and width.
    Material,
}

pub(super) const fn key(name: &'static str, allowed: Allowed, meaning: &'static str) -> Key {
    Key {
        name,
        allowed,
        unit: Unit::One,
        meaning,
        form: None,
        absent: Absent::None,
        field: None,
        is_parameter: false,
        of: |_| String::new(),
        ahead: false,
        at: None,
    }
}

pub(super) const fn number(name: &'static str, range: NumberRange, unit: Unit, meaning: &'static str) -> Key {
    Key { unit, ..key(name, Allowed::Number(range), meaning) }
}

pub(super) const fn numbers(name: &'static str, range: NumberRange, unit: Unit, meaning: &'static str) -> Key {
    Key { unit, ..key(name, Allowed::Numbers(range), meaning) }
}

pub(super) const fn whole(name: &'static str, low: i64, high: i64, meaning: &'static str) -> Key {
    key(name, Allowed::Whole(WholeRange { low, high }), meaning)
}

pub(super) const fn word<T: Word>(name: &'static str, meaning: &'static str) -> Key {
    key(name, Allowed::Word(words::<T>), meaning)
}

pub(super) const fn table(name: &'static str, keys: &'static [Key]) -> Key {
    key(name, Allowed::Table(keys), "")
}

impl Key {
    pub(super) const fn direct(self) -> Self {
        Self { form: Some(Form::Direct), ..self }
    }

    pub(super) const fn material(self) -> Self {
        Self { form: Some(Form::Material), ..self }
    }

    pub(super) const fn required(self) -> Self {
        Self { absent: Absent::Refused, ..self }
    }

    pub(super) const fn default(self, value: &'static str) -> Self {
        Self { absent: Absent::Value(value), ..self }
    }

    pub(super) const fn follows(self, what: &'static str) -> Self {
        Self { absent: Absent::Follows(what), ..self }
    }

    /// Its value in a file is that of a field of the scene.
    pub(super) const fn reads(self, field: Field) -> Self {
        Self { field: Some(field), ..self }
    }

    /// As [`reads`](Self::reads), and a run may have another value than the file.
    pub(super) const fn parameter(self, field: Field) -> Self {
        Self { is_parameter: true, ..self.reads(field) }
    }

    pub(super) const fn of(self, of: fn(At) -> String) -> Self {
        Self { of, ..self }
    }

    pub(super) const fn ahead(self) -> Self {
        Self { ahead: true, ..self }
    }

    pub(super) const fn place(self, at: At) -> Self {
        Self { at: Some(at), ..self }
    }

    /// Whether a number is in the range; a word may still be none of those to choose from.
    pub(in crate::scene) fn allows(&self, value: &Value) -> bool {
        match (self.allowed, value) {
            (Allowed::Number(range), Value::Real(number)) => range.holds(*number),
            (Allowed::Whole(range), Value::Integer(number)) => range.holds((*number).into()),
            (Allowed::Word(_), Value::Text(_)) => true,
            _ => false,
        }
    }

    /// What a text stands for; `None` where it is no number and the key's is one.
    pub(in crate::scene) fn parse(&self, text: &str) -> Option<Value> {
        match self.allowed {
            Allowed::Number(_) => text.parse().ok().map(Value::Real),
            Allowed::Whole(_) => text.parse().ok().map(Value::Integer),
            _ => Some(Value::Text(text.to_owned())),
        }
    }

    /// Writes what its absence stands for into the field of a scene that always has a value.
    pub(in crate::scene) fn set_default(&self, scene: &mut Scene, at: At) {
        let (Some(field), Absent::Value(text)) = (self.field, self.absent) else { return };
        let value = self.parse(text.trim_matches('"')).filter(|_| (field.get)(scene, at).is_some());
        value.and_then(|value| (field.set)(scene, at, &value));
    }

    /// The range of a number; `None` for everything else.
    pub(in crate::scene) fn range(&self) -> Option<NumberRange> {
        if let Allowed::Number(range) = self.allowed { Some(range) } else { None }
    }

    /// The keys of the table, or of the tables, that it holds.
    pub(in crate::scene) fn keys(&self) -> &'static [Self] {
        match self.allowed {
            Allowed::Table(keys) | Allowed::Tables(keys, _) | Allowed::Kinds(keys, _) => keys,
            _ => &[],
        }
    }
}

/// The path of a file that can go into the FMU with the scene.
pub(in crate::scene) const PATH: &str =
    "a relative path of a file beside or below the scene file, without `..` and backslashes";

/// The path of such a file, or a table of it.
pub(in crate::scene) const TABLE_FILE: &str =
    "a relative path of a file beside or below the scene file, without `..` and backslashes; or { path, columns }";

/// The keys of a table in a file whose columns are said.
pub(in crate::scene) const TABLE: &[Key] = &[
    key("path", Allowed::Text(PATH), "File of the table").required(),
    key("columns", Allowed::Text(ROLES), "Columns by what they hold, where their names do not say it"),
];

/// What `columns` of a table holds.
pub(in crate::scene) const ROLES: &str =
    "{ role = \"…\" }, the names or the numbers of columns as texts, by what they hold";

/// What the reader gets for a key that is not in the table; it accepts no value.
pub(in crate::scene) const NONE: Key = key("", Allowed::Text("no such key"), "");

impl fmt::Display for Allowed {
    /// What a missing key, or one with another type of value, should hold.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(range) => range.fmt(f),
            Self::Whole(range) => range.fmt(f),
            Self::Flag => f.write_str("true or false"),
            Self::Numbers(range) => write!(f, "an array, each {range}"),
            Self::Text(expected) | Self::Tables(_, expected) => f.write_str(expected),
            Self::Word(words) => f.write_str(&words()),
            Self::Words(words) => write!(f, "an array, each {}", words()),
            Self::Table(_) | Self::Kinds(..) => f.write_str("a table"),
        }
    }
}
