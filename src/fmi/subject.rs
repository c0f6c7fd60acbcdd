//! What an FMU simulates, as its resources give it: a scene's layer, or an element that looks the forces up in a table.

use std::path::{Path, PathBuf};
use std::{fs, io};

use super::fault::Fault;
use super::plant::{Plant, Saved};
use super::resources::{self, SCENE_FILE, TABLE_FILE};
use super::serial::Misfit;
use crate::element::{self, Element, PointContact, Table};
use crate::outputs::{self, Dependencies, Output, Variable};
use crate::scene::{self, Extrapolation, Parameter, ParameterError, Scene, Value};
use crate::simulation::{Simulation, Start};

/// What an FMU simulates, with its parameters.
#[derive(Clone, Debug)]
pub enum Subject {
    /// The layer of a scene.
    Layer(Box<Scene>),
    /// A point-contact element.
    Element(PointContact),
}

impl From<Scene> for Subject {
    fn from(scene: Scene) -> Self {
        Self::Layer(Box::new(scene))
    }
}

impl From<PointContact> for Subject {
    fn from(contact: PointContact) -> Self {
        Self::Element(contact)
    }
}

impl Subject {
    /// Reads what is in the resources at `location`, and tells from which file.
    pub(super) fn find(location: &str) -> Result<(Self, PathBuf), Fault> {
        let path = resources::find(location, &[SCENE_FILE, TABLE_FILE])?;
        let subject = if path.ends_with(TABLE_FILE) {
            PointContact::new(Table::load(&path)?).into()
        } else {
            Scene::load(&path)?.into()
        };
        Ok((subject, path))
    }

    /// The model's name.
    pub fn name(&self) -> String {
        match self {
            Self::Layer(scene) => scene.name.clone(),
            Self::Element(contact) => contact.name(),
        }
    }

    /// What it is, in a sentence; empty where that is not told.
    pub fn description(&self) -> String {
        match self {
            Self::Layer(scene) => scene.description.clone().unwrap_or_default(),
            Self::Element(contact) => contact.description(),
        }
    }

    /// The name as a C identifier.
    pub fn model_identifier(&self) -> String {
        scene::identifier(&self.name())
    }

    /// The files that an FMU carries beside its own, relative to that.
    pub fn files(&self) -> &[PathBuf] {
        match self {
            Self::Layer(scene) => &scene.files,
            Self::Element(_) => &[],
        }
    }

    /// The bytes of one of its [`files`](Self::files) as an FMU carries them; `folder` is that of its own.
    ///
    /// # Errors
    /// Where the file cannot be read.
    pub fn carried(&self, folder: &Path, file: &Path) -> io::Result<Vec<u8>> {
        match self {
            Self::Layer(scene) => scene.carried(folder, file),
            Self::Element(_) => fs::read(folder.join(file)),
        }
    }

    /// Its own file's name in the resources.
    pub fn file_name(&self) -> &'static str {
        match self {
            Self::Layer(_) => SCENE_FILE,
            Self::Element(_) => TABLE_FILE,
        }
    }

    /// The files that it was read from, its own being `path`.
    pub fn sources(&self, path: &Path) -> Vec<PathBuf> {
        let folder = path.parent().unwrap_or(Path::new(""));
        let extracts = match self {
            Self::Layer(scene) => scene.extracts.iter(),
            Self::Element(_) => [].iter(),
        };
        let files = self.files().iter().chain(extracts.map(|extract| &extract.source));
        std::iter::once(path.to_owned()).chain(files.map(|file| folder.join(file))).collect()
    }

    /// What is worth telling though nothing is wrong.
    pub fn warnings(&self) -> &[String] {
        match self {
            Self::Layer(scene) => &scene.warnings,
            Self::Element(_) => &[],
        }
    }

    /// The output variables.
    pub fn variables(&self) -> Vec<Variable> {
        match self {
            Self::Layer(scene) => outputs::variables(scene),
            Self::Element(contact) => contact.variables(),
        }
    }

    /// What an output depends on directly.
    pub fn dependencies(&self, output: Output) -> Dependencies {
        match self {
            Self::Layer(scene) => outputs::dependencies(scene, output),
            Self::Element(_) => element::dependencies(output),
        }
    }

    /// The parameters.
    pub fn parameters(&self) -> Vec<Parameter> {
        match self {
            Self::Layer(scene) => scene.parameters(),
            Self::Element(contact) => contact.parameters(),
        }
    }

    /// The value of a parameter.
    pub fn parameter(&self, parameter: Parameter) -> Value {
        match self {
            Self::Layer(scene) => scene.parameter(parameter),
            Self::Element(contact) => contact.parameter(parameter),
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
        }
    }

    /// How the carrier moves on when no rates are given.
    pub(super) fn extrapolation(&self) -> Extrapolation {
        match self {
            Self::Layer(scene) => scene.extrapolation,
            Self::Element(contact) => contact.extrapolation,
        }
    }

    /// A run from its start.
    pub(super) fn start(&self, start: &Start) -> Result<Plant, Fault> {
        Ok(match self {
            Self::Layer(scene) => Plant::Layer(Box::new(Simulation::new(scene, start)?)),
            Self::Element(contact) => Plant::Element(Box::new(Element::new(contact, start)?)),
        })
    }

    /// A run that goes on from what was saved.
    pub(super) fn restore(&self, saved: &Saved) -> Result<Plant, Misfit> {
        match (self, saved) {
            (Self::Layer(scene), Saved::Layer(saved)) => Ok(Plant::Layer(Box::new(Simulation::restore(scene, saved)?))),
            (Self::Element(contact), Saved::Element(saved)) => {
                Ok(Plant::Element(Box::new(Element::restore(contact, saved)?)))
            }
            _ => Err(Misfit::Unsound("its run is of something else")),
        }
    }
}
