//! What an FMU simulates: a scene's layer or a point-contact element, with its parameters, its variables by value
//! reference and its GUID.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::{fmt, fs, io};

use uuid::Uuid;

use super::error::Error;
use super::patch_inputs::PatchInput;
use super::resources::{self, PATCH_FILE, SCENE_FILE, TABLE_FILE};
use crate::element::{self, PointContact, Table};
use crate::outputs::{self, Dependencies, Output, Variable};
use crate::patch::{Patch, PatchVariable};
pub use crate::scene::Input;
use crate::scene::{self, Extrapolation, Parameter, ParameterError, Scene, Value};

/// What an FMU simulates, as its resources define it.
#[derive(Clone, Debug)]
pub enum Definition {
    /// The layer of a scene.
    Layer(Box<Scene>),
    /// A point-contact element.
    Element(PointContact),
    /// A contact patch.
    Patch(Box<Patch>),
}

impl From<Scene> for Definition {
    fn from(scene: Scene) -> Self {
        Self::Layer(Box::new(scene))
    }
}

impl From<PointContact> for Definition {
    fn from(contact: PointContact) -> Self {
        Self::Element(contact)
    }
}

impl From<Patch> for Definition {
    fn from(patch: Patch) -> Self {
        Self::Patch(Box::new(patch))
    }
}

impl Definition {
    /// Reads the definition in the resources at `location`; also returns its file.
    pub(super) fn find(location: &str) -> Result<(Self, PathBuf), Error> {
        // The table of a patch may have any name.
        let path = resources::find(location, &[SCENE_FILE, PATCH_FILE, TABLE_FILE])?;
        let definition = if path.ends_with(TABLE_FILE) {
            PointContact::new(Table::load(&path)?).into()
        } else if path.ends_with(PATCH_FILE) {
            Patch::load(&path)?.into()
        } else {
            Scene::load(&path)?.into()
        };
        Ok((definition, path))
    }

    /// The model's name.
    pub fn name(&self) -> String {
        match self {
            Self::Layer(scene) => scene.name.clone(),
            Self::Element(contact) => contact.name(),
            Self::Patch(patch) => patch.name().to_owned(),
        }
    }

    /// A description in a sentence; may be empty.
    pub fn description(&self) -> String {
        match self {
            Self::Layer(scene) => scene.description.clone().unwrap_or_default(),
            Self::Element(contact) => contact.description(),
            Self::Patch(patch) => patch.description(),
        }
    }

    /// The name as a C identifier.
    pub fn model_identifier(&self) -> String {
        scene::identifier(&self.name())
    }

    /// Paths of the files that it reads besides its own, relative to that one's folder.
    pub fn files(&self) -> &[PathBuf] {
        match self {
            Self::Layer(scene) => &scene.files,
            Self::Element(_) => &[],
            Self::Patch(patch) => patch.files(),
        }
    }

    /// The content of one of its [`files`](Self::files) as it is packed into an FMU; `folder` is that of its own file.
    ///
    /// # Errors
    /// Where the file cannot be read.
    pub fn carried(&self, folder: &Path, file: &Path) -> io::Result<Vec<u8>> {
        match self {
            Self::Layer(scene) => scene.carried(folder, file),
            Self::Element(_) | Self::Patch(_) => fs::read(folder.join(file)),
        }
    }

    /// The name of its own file in the resources.
    pub fn file_name(&self) -> &'static str {
        match self {
            Self::Layer(_) => SCENE_FILE,
            Self::Element(_) => TABLE_FILE,
            Self::Patch(_) => PATCH_FILE,
        }
    }

    /// Paths of all files that it was read from; `path` is that of its own.
    pub fn sources(&self, path: &Path) -> Vec<PathBuf> {
        let folder = path.parent().unwrap_or(Path::new(""));
        let extracts = match self {
            Self::Layer(scene) => scene.extracts.iter(),
            Self::Element(_) | Self::Patch(_) => [].iter(),
        };
        let files = self.files().iter().chain(extracts.map(|extract| &extract.source));
        std::iter::once(path.to_owned()).chain(files.map(|file| folder.join(file))).collect()
    }

    /// Warnings about the definition.
    pub fn warnings(&self) -> &[String] {
        match self {
            Self::Layer(scene) => &scene.warnings,
            Self::Element(_) | Self::Patch(_) => &[],
        }
    }

    /// The inputs, in the order of their value references.
    pub fn inputs(&self) -> Vec<Input> {
        match self {
            Self::Layer(scene) => scene.inputs(),
            Self::Element(_) => vec![Input::U, Input::W],
            Self::Patch(_) => Vec::new(),
        }
    }

    /// The start value of an input.
    pub fn input_start(&self, input: Input) -> f64 {
        match self {
            Self::Layer(scene) => scene.input_start(input),
            Self::Element(_) | Self::Patch(_) => 0.0,
        }
    }

    /// The temperature that a run starts from, K, where it is an input.
    pub(super) fn temperature(&self) -> Option<f64> {
        let is_input = self.inputs().contains(&Input::Temperature);
        is_input.then(|| self.input_start(Input::Temperature))
    }

    /// The output variables of a layer or an element; a patch has [its own](Patch::variables).
    pub fn variables(&self) -> Vec<Variable> {
        match self {
            Self::Layer(scene) => outputs::variables(scene),
            Self::Element(contact) => contact.variables(),
            Self::Patch(_) => Vec::new(),
        }
    }

    /// The inputs that an output depends on directly.
    pub fn dependencies(&self, output: Output) -> Dependencies {
        match self {
            Self::Layer(scene) => outputs::dependencies(scene, output),
            Self::Element(_) => element::dependencies(output),
            Self::Patch(_) => Dependencies::default(),
        }
    }

    /// The parameters.
    pub fn parameters(&self) -> Vec<Parameter> {
        match self {
            Self::Layer(scene) => scene.parameters(),
            Self::Element(contact) => contact.parameters(),
            Self::Patch(patch) => patch.parameters(),
        }
    }

    /// The value of a parameter.
    pub fn parameter(&self, parameter: Parameter) -> Value {
        match self {
            Self::Layer(scene) => scene.parameter(parameter),
            Self::Element(contact) => contact.parameter(parameter),
            Self::Patch(patch) => patch.parameter(parameter),
        }
    }

    /// The parameter called `name`.
    pub fn parameter_named(&self, name: &str) -> Option<Parameter> {
        self.parameters().into_iter().find(|parameter| parameter.name() == name)
    }

    pub(super) fn set_parameter(&mut self, parameter: Parameter, value: Value) -> Result<(), ParameterError> {
        match self {
            Self::Layer(scene) => scene.set_parameter(parameter, value),
            Self::Element(contact) => contact.set_parameter(parameter, value),
            Self::Patch(patch) => patch.set_parameter(parameter, value),
        }
    }

    /// The patch, if it is one.
    pub(super) fn patch(&self) -> Option<&Patch> {
        if let Self::Patch(patch) = self { Some(patch) } else { None }
    }

    /// How inputs are extrapolated where the master gives no derivatives.
    pub(super) fn extrapolation(&self) -> Extrapolation {
        match self {
            Self::Layer(scene) => scene.extrapolation,
            Self::Element(contact) => contact.extrapolation,
            Self::Patch(patch) => patch.extrapolation,
        }
    }
}

/// A definition with the parameters that the master has set.
#[derive(Clone, Debug)]
pub(super) struct Parameters {
    definition: Definition,
    /// The parameters set, by name. They are kept since the value of a parameter does not show whether it was set: some
    /// follow others until they are.
    set: BTreeMap<String, Value>,
}

impl Parameters {
    pub(super) fn new(definition: Definition) -> Self {
        Self { definition, set: BTreeMap::new() }
    }

    /// The definition with these parameters.
    pub(super) fn definition(&self) -> &Definition {
        &self.definition
    }

    pub(super) fn values_set(&self) -> &BTreeMap<String, Value> {
        &self.set
    }

    pub(super) fn set(&mut self, parameter: Parameter, value: Value) -> Result<(), ParameterError> {
        self.definition.set_parameter(parameter, value.clone())?;
        self.set.insert(parameter.name(), value);
        Ok(())
    }
}

/// The type of a variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// fmi2Real
    Real,
    /// fmi2Integer
    Integer,
    /// fmi2Boolean; no variable is one
    Boolean,
    /// fmi2String
    Text,
}

impl Kind {
    fn new(kind: outputs::Kind) -> Self {
        match kind {
            outputs::Kind::Real => Self::Real,
            outputs::Kind::Integer => Self::Integer,
        }
    }

    fn name(self) -> &'static str {
        match self {
            Self::Real => "Real",
            Self::Integer => "Integer",
            Self::Boolean => "Boolean",
            Self::Text => "String",
        }
    }
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// The variable behind a value reference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Entry<'a> {
    /// An input, a Real.
    Input(Input),
    /// An output or, in the group elements, a local variable: its index in [`Catalogue::outputs`] and the variable.
    Output(usize, &'a Variable),
    /// An input of a patch, a Real.
    PatchInput(PatchInput),
    /// The same as `Output`, of a patch.
    PatchOutput(usize, &'a PatchVariable),
    /// A fixed parameter and its type.
    Parameter(Parameter, Kind),
}

impl Entry<'_> {
    /// The variable's name.
    pub fn name(&self) -> String {
        match self {
            Self::Input(input) => input.name().into(),
            Self::Output(_, variable) => variable.name.clone(),
            Self::PatchInput(input) => input.name().into(),
            Self::PatchOutput(_, variable) => variable.name.clone(),
            Self::Parameter(parameter, _) => parameter.name(),
        }
    }

    /// The variable's type.
    pub fn kind(&self) -> Kind {
        match self {
            Self::Input(_) | Self::PatchInput(_) => Kind::Real,
            Self::Output(_, variable) => Kind::new(variable.kind),
            Self::PatchOutput(_, variable) => Kind::new(variable.kind),
            Self::Parameter(_, kind) => *kind,
        }
    }
}

/// The variables of an FMU by value reference: the inputs, then the outputs, then the parameters, numbered from 0.
#[derive(Clone, Debug, PartialEq)]
pub struct Catalogue {
    inputs: Vec<Input>,
    outputs: Vec<Variable>,
    patch: Option<PatchCatalogue>,
    parameters: Vec<(Parameter, Kind)>,
}

/// Inputs and outputs of a patch.
#[derive(Clone, Debug, PartialEq)]
struct PatchCatalogue {
    inputs: Vec<PatchInput>,
    outputs: Vec<PatchVariable>,
}

impl PatchCatalogue {
    fn of(definition: &Definition) -> Option<Self> {
        let Definition::Patch(patch) = definition else { return None };
        Some(Self { inputs: PatchInput::of(patch), outputs: patch.variables() })
    }

    /// The variable with this index, or the index after them.
    fn entry(&self, index: usize) -> Result<Entry<'_>, usize> {
        if let Some(&input) = self.inputs.get(index) {
            return Ok(Entry::PatchInput(input));
        }
        let index = index - self.inputs.len();
        let output = self.outputs.get(index).map(|variable| Entry::PatchOutput(index, variable));
        output.ok_or(index - self.outputs.len().min(index))
    }
}

impl Catalogue {
    /// The variables of a scene's layer.
    pub fn new(scene: &Scene) -> Self {
        Self::of(&scene.clone().into())
    }

    /// The variables of a definition.
    pub fn of(definition: &Definition) -> Self {
        let kind = |parameter| match definition.parameter(parameter) {
            Value::Real(_) => Kind::Real,
            Value::Integer(_) => Kind::Integer,
            Value::Text(_) => Kind::Text,
        };
        let parameters = definition.parameters().into_iter().map(|parameter| (parameter, kind(parameter))).collect();
        let (inputs, outputs) = (definition.inputs(), definition.variables());
        Self { inputs, outputs, patch: PatchCatalogue::of(definition), parameters }
    }

    /// The variable with the value reference `reference`.
    pub fn entry(&self, reference: u32) -> Option<Entry<'_>> {
        let index = usize::try_from(reference).ok()?;
        match self.variable(index) {
            Ok(entry) => Some(entry),
            Err(index) => self.parameters.get(index).map(|&(parameter, kind)| Entry::Parameter(parameter, kind)),
        }
    }

    /// The input or output with this index, or the index after them.
    fn variable(&self, index: usize) -> Result<Entry<'_>, usize> {
        if let Some(patch) = &self.patch {
            return patch.entry(index);
        }
        if let Some(&input) = self.inputs.get(index) {
            return Ok(Entry::Input(input));
        }
        let index = index - self.inputs.len();
        let output = self.outputs.get(index).map(|variable| Entry::Output(index, variable));
        output.ok_or(index - self.outputs.len().min(index))
    }

    /// The variable with the value reference `reference`, of the type `asked` for.
    pub(super) fn find(&self, reference: u32, asked: Kind) -> Result<Entry<'_>, Error> {
        let entry = self.entry(reference).ok_or(Error::UnknownReference(reference))?;
        match entry.kind() {
            kind if kind == asked => Ok(entry),
            actual => {
                Err(Error::WrongType { reference, name: entry.name(), actual: actual.name(), asked: asked.name() })
            }
        }
    }

    /// All variables with their value references, in rising order.
    pub fn entries(&self) -> impl Iterator<Item = (u32, Entry<'_>)> {
        (0..).map_while(|reference| Some((reference, self.entry(reference)?)))
    }

    /// The inputs in the order of their value references.
    pub fn inputs(&self) -> &[Input] {
        &self.inputs
    }

    /// The outputs of a layer or an element in the order of their value references.
    pub fn outputs(&self) -> &[Variable] {
        &self.outputs
    }

    /// The outputs of a patch in the order of their value references.
    pub fn patch_outputs(&self) -> &[PatchVariable] {
        self.patch.as_ref().map_or(&[], |patch| &patch.outputs)
    }

    /// The number of outputs.
    pub(super) fn output_count(&self) -> usize {
        self.outputs.len() + self.patch_outputs().len()
    }
}

/// The content of the files that a definition is read from, as an FMU carries them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sources {
    /// Its own file, then every file that it reads, in the scene's order.
    files: Vec<Vec<u8>>,
}

impl Sources {
    /// Reads the scene file at `path` and the files of `scene`, which was loaded from it.
    ///
    /// # Errors
    /// Where a file cannot be read.
    pub fn read(path: &Path, scene: &Scene) -> io::Result<Self> {
        Self::of(path, &scene.clone().into())
    }

    /// Reads the file at `path` and what else `definition`, which was loaded from it, reads.
    ///
    /// # Errors
    /// Where a file cannot be read.
    pub fn of(path: &Path, definition: &Definition) -> io::Result<Self> {
        let folder = path.parent().unwrap_or(Path::new(""));
        let mut files = vec![fs::read(path)?];
        for file in definition.files() {
            files.push(definition.carried(folder, file)?);
        }
        Ok(Self { files })
    }

    pub(super) fn read_from(path: &Path, definition: &Definition) -> Result<Self, Error> {
        Self::of(path, definition).map_err(|source| Error::Unreadable { path: path.into(), source })
    }
}

/// The GUID of the FMU made from `sources`: a UUID of version 5 over the program's version, the bytes of every source
/// and the list of variables. It is the same on every build and another one for anything that would run differently.
pub fn guid(sources: &Sources, catalogue: &Catalogue) -> String {
    let mut content = Vec::new();
    append(&mut content, env!("CARGO_PKG_VERSION").as_bytes());
    for file in &sources.files {
        append(&mut content, file);
    }
    for (reference, entry) in catalogue.entries() {
        append(&mut content, format!("{reference} {} {}", entry.name(), entry.kind()).as_bytes());
    }
    let namespace = Uuid::new_v5(&Uuid::NAMESPACE_URL, env!("CARGO_PKG_NAME").as_bytes());
    format!("{{{}}}", Uuid::new_v5(&namespace, &content))
}

/// Appends the length, too: two files must not look like two others with the same bytes in a row.
fn append(content: &mut Vec<u8>, bytes: &[u8]) {
    content.extend((bytes.len() as u64).to_le_bytes());
    content.extend(bytes);
}
