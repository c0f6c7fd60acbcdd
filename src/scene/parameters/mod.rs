//! The parameters of a scene by name: what an FMU or `--set` may change before a run.
//!
//! Which there are, and where their values are in a scene, says the table of keys.

mod key_path;
#[cfg(test)]
mod tests;

use super::error::{ParameterError, Problem};
use super::keys::{self, At, Key, KeyRow};
use super::values::{Value, Word, is_similar};
use super::{Foundation, InputRule, Scene, TableExtrapolation, Unit};
use key_path::KeyPath;

/// One settable number or word of a scene, an element or a patch.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Parameter {
    /// The path of its key, `[]` behind a list.
    key: KeyPath,
    /// The element of the list, counted from 0.
    index: usize,
}

impl Parameter {
    /// Steps that a communication step or a phase may take.
    pub const MAX_STEPS: Self = Self::new("solver.max_steps");
    /// How the dashpots start.
    pub const INITIAL: Self = Self::new("layer.initial");
    /// The layer's temperature.
    pub const TEMPERATURE: Self = Self::new("material.wlf.temperature");
    /// The method of integration.
    pub const METHOD: Self = Self::new("solver.method");
    /// The relative tolerance of the local error.
    pub const RELATIVE_TOLERANCE: Self = Self::new("solver.relative_tolerance");
    /// How what moves goes on when a master gives no rates.
    pub const EXTRAPOLATION: Self = Self::new("input.extrapolation");
    /// How far apart new values of inputs come.
    pub const INTERVAL: Self = Self::new("input.interval");
    /// What happens beyond the table of an element or a patch.
    pub const TABLE_EXTRAPOLATION: Self = Self::new("table.extrapolation");
    /// The loss of the springs of an element or a patch.
    pub const DAMPING: Self = Self::new("patch.damping");
    /// How many times finer a step of a patch is cut.
    pub const REFINE: Self = Self::new("solver.refine");

    /// The parameter whose key has this path, which is in no list.
    pub(crate) const fn new(key: &'static str) -> Self {
        Self { key: KeyPath::new(key), index: 0 }
    }

    /// The path of its key, `[]` behind a list: `layer.vertical.maxwell[].stiffness`.
    pub fn path(&self) -> &str {
        self.key.as_str()
    }

    /// The path of its key, elements of lists counted from 1: `layer.vertical.maxwell[1].stiffness`.
    pub fn name(self) -> String {
        self.path().replace("[]", &format!("[{}]", self.index + 1))
    }

    /// Its key, and which of several equal tables this is in: of scenes, of patches and elements, or of seals.
    fn found(self) -> (&'static Key, At) {
        let of_scenes = keys::find(keys::ROOT, self.path()).filter(|(key, _)| key.is_parameter && key.field.is_some());
        let found = of_scenes
            .or_else(|| keys::find(keys::PATCH_ROOT, self.path()))
            .or_else(|| keys::find(keys::SEAL_ROOT, self.path()));
        found.unwrap_or((&keys::NONE, At::FIRST))
    }

    fn key(self) -> &'static Key {
        self.found().0
    }

    fn at(self) -> At {
        self.found().1.element(self.index)
    }

    /// What it may hold, in words.
    pub fn allowed(self) -> String {
        self.key().allowed.to_string()
    }

    /// The unit of a Real parameter; 1 for the others.
    pub fn unit(self) -> Unit {
        self.key().unit
    }

    /// What it is, in a few words.
    pub fn description(self) -> String {
        format!("{}{}", self.key().meaning, (self.key().of)(self.at()))
    }

    /// `number`, if the parameter may have it.
    pub(crate) fn check_number(self, number: f64) -> Result<f64, ParameterError> {
        self.check(&Value::Real(number)).map(|()| number)
    }

    fn check(self, value: &Value) -> Result<(), ParameterError> {
        if self.key().allows(value) { Ok(()) } else { Err(self.refuse(value)) }
    }

    /// What a text stands for, if the parameter may have it.
    fn check_word<T: Word>(self, text: &str) -> Result<T, ParameterError> {
        T::parse(text).ok_or_else(|| self.refuse(Value::Text(text.to_owned())))
    }

    fn refuse(self, given: impl ToString) -> ParameterError {
        ParameterError::new(self.name(), Problem::value(given, self.key().allowed))
    }
}

impl InputRule {
    /// The value of one of its parameters; `None` of another.
    pub(crate) fn parameter(&self, parameter: Parameter) -> Option<Value> {
        match parameter {
            Parameter::EXTRAPOLATION => Some(Value::Text(self.extrapolation.word().into())),
            Parameter::INTERVAL => Some(Value::Real(self.interval)),
            _ => None,
        }
    }

    /// Gives one of its parameters a value; false where it is none of them, or not of its type.
    pub(crate) fn set_parameter(&mut self, parameter: Parameter, value: &Value) -> Result<bool, ParameterError> {
        match (parameter, value) {
            (Parameter::EXTRAPOLATION, Value::Text(word)) => self.extrapolation = parameter.check_word(word)?,
            (Parameter::INTERVAL, &Value::Real(interval)) => self.interval = parameter.check_number(interval)?,
            _ => return Ok(false),
        }
        Ok(true)
    }
}

impl TableExtrapolation {
    /// Takes the word of its parameter; false where it is another, or no word.
    pub(crate) fn set_parameter(&mut self, parameter: Parameter, value: &Value) -> Result<bool, ParameterError> {
        let (Parameter::TABLE_EXTRAPOLATION, Value::Text(word)) = (parameter, value) else { return Ok(false) };
        *self = parameter.check_word(word)?;
        Ok(true)
    }
}

/// A number of a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KeyNumber {
    /// Its value, in SI units.
    pub value: f64,
    /// Its unit.
    pub unit: Unit,
}

/// The element of the list in a path, from 0; 0 without one.
fn element_of(path: &str) -> Option<usize> {
    let Some((_, rest)) = path.split_once('[') else { return Some(At::FIRST.index) };
    rest.split_once(']')?.0.parse::<usize>().ok()?.checked_sub(1)
}

impl Scene {
    /// The parameters that this scene has, in the order of the scene's keys.
    pub fn parameters(&self) -> Vec<Parameter> {
        let mut parameters = Vec::new();
        // Each list has one element here.
        let mut of_scenes = keys::fields();
        of_scenes.retain(|row| row.key.is_parameter);
        let list = |row: &KeyRow| row.path.split_once("[]").map(|(list, _)| list.to_owned());
        for rows in of_scenes.chunk_by(|one, next| list(one).is_some() && list(one) == list(next)) {
            let in_list = rows.first().and_then(list).is_some();
            for index in 0.. {
                let has = |row: &&KeyRow| {
                    row.key.field.is_some_and(|field| (field.get)(self, row.at.element(index)).is_some())
                };
                let before = parameters.len();
                parameters.extend(rows.iter().filter(has).map(|row| Parameter { key: KeyPath::new(&row.path), index }));
                if !in_list || parameters.len() == before {
                    break;
                }
            }
        }
        // As an input it is none.
        parameters.retain(|&parameter| parameter != Parameter::TEMPERATURE || !self.temperature_input);
        parameters
    }

    /// The parameter called `name`.
    pub fn parameter_named(&self, name: &str) -> Option<Parameter> {
        self.parameters().into_iter().find(|parameter| parameter.name() == name)
    }

    /// The value of `parameter`; 0 of one that the scene does not have.
    pub fn parameter(&self, parameter: Parameter) -> Value {
        self.value(parameter).unwrap_or(Value::Real(0.0))
    }

    fn value(&self, parameter: Parameter) -> Option<Value> {
        (parameter.key().field?.get)(self, parameter.at())
    }

    /// Gives `parameter` a value. Call [`check`](Self::check) once all are set: some values must agree with others.
    ///
    /// # Errors
    /// [`ParameterError`] where the value is of the wrong type or out of range, or where the scene has no such
    /// parameter; the scene is then unchanged.
    pub fn set_parameter(&mut self, parameter: Parameter, value: Value) -> Result<(), ParameterError> {
        parameter.check(&value)?;
        let field = parameter.key().field.filter(|field| (field.get)(self, parameter.at()).is_some());
        let Some(field) = field else { return Err(self.unknown(&parameter.name())) };
        (field.set)(self, parameter.at(), &value).ok_or_else(|| parameter.refuse(value))?;
        (field.then)(self);
        Ok(())
    }

    /// Fits the links to the body anew, for it has changed.
    pub(super) fn refit(&mut self) {
        let refitted = |foundation: &Foundation| foundation.refitted(&self.layer, self.material.as_ref()?);
        self.foundation = self.foundation.as_ref().and_then(refitted);
    }

    /// Gives the parameter called `name` the value that `text` writes.
    ///
    /// # Errors
    /// [`ParameterError`] as for [`set_parameter`](Self::set_parameter), and for an unknown name, with the parameters
    /// whose names are similar or, failing these, all that the scene has.
    pub fn set_by_name(&mut self, name: &str, text: &str) -> Result<(), ParameterError> {
        let parameter = self.parameter_named(name).ok_or_else(|| self.unknown(name))?;
        let value = parameter.key().parse(text.trim()).ok_or_else(|| parameter.refuse(text))?;
        self.set_parameter(parameter, value)
    }

    /// Whether a path is that of a table of a scene file.
    pub fn is_table(path: &str) -> bool {
        keys::find(keys::ROOT, path).is_some_and(|(key, _)| !key.keys().is_empty())
    }

    /// The number at the path of a key, elements of lists counted from 1: as the file has it, or as it follows.
    ///
    /// # Errors
    /// Where there is no such key, or the scene has no number there.
    pub fn number_or_following(&self, path: &str) -> Result<KeyNumber, ParameterError> {
        let refused = |expected: &str| ParameterError::new(path, Problem::value(path, expected));
        let Some((key, at)) = keys::find(keys::ROOT, path) else {
            return Err(match keys::similar_keys(path).first() {
                Some(similar) => refused(&format!("the key of a number of the scene; did you mean {similar}?")),
                None => refused("the key of a number of the scene, as friction.rate_shear.strength"),
            });
        };
        let Some(range) = key.range() else {
            return Err(refused("the key of a number that may have any value in a range"));
        };
        let in_file = self.number(path).filter(|number| range.holds(*number));
        let following = || match (key.field?.get)(self, at.element(element_of(path)?))? {
            Value::Real(number) => Some(number),
            _ => None,
        };
        let value = in_file.or_else(following).ok_or_else(|| refused("the key of a number that the scene has"))?;
        Ok(KeyNumber { value, unit: key.unit })
    }

    fn unknown(&self, name: &str) -> ParameterError {
        let names: Vec<String> = self.parameters().into_iter().map(Parameter::name).collect();
        let similar: Vec<String> = names.iter().filter(|other| is_similar(name, other)).cloned().collect();
        let allowed = if similar.is_empty() { names } else { similar };
        ParameterError::new(name, Problem::Unknown { allowed, similar: Vec::new() })
    }
}
