//! What an FMU simulates: one of the three models, with the parameters set; its GUID.

use std::collections::BTreeMap;
use std::ops::{Deref, DerefMut};
use std::path::Path;
use std::sync::Arc;
use std::{fs, io};

use uuid::Uuid;

use super::error::{Error, check_memory};
use super::model::FmuModel;
use super::resources::{self, PATCH_FILE, Resource, SCENE_FILE, SEAL_FILE, TABLE_FILE};
use super::variables::VariableTable;
use asperity::element::{FrictionTable, PointContact};
use asperity::model::EvenSliding;
use asperity::patch::Patch;
use asperity::scene::{Parameter, ParameterError, Scene, Value};
use asperity::seal::Seal;

/// What an FMU simulates, as its resources define it.
#[derive(Clone, Debug)]
pub enum Definition {
    /// The layer of a scene.
    Layer(Arc<Scene>),
    /// A point-contact element.
    Element(PointContact),
    /// A contact patch.
    Patch(Box<Patch>),
    /// A lip with a film.
    Seal(Box<Seal>),
}

impl From<Scene> for Definition {
    fn from(scene: Scene) -> Self {
        Self::Layer(Arc::new(scene))
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

impl From<Seal> for Definition {
    fn from(seal: Seal) -> Self {
        Self::Seal(Box::new(seal))
    }
}

impl Deref for Definition {
    type Target = dyn FmuModel;

    fn deref(&self) -> &Self::Target {
        match self {
            Self::Layer(scene) => scene,
            Self::Element(contact) => contact,
            Self::Patch(patch) => &**patch,
            Self::Seal(seal) => &**seal,
        }
    }
}

impl DerefMut for Definition {
    fn deref_mut(&mut self) -> &mut Self::Target {
        match self {
            Self::Layer(scene) => scene,
            Self::Element(contact) => contact,
            Self::Patch(patch) => &mut **patch,
            Self::Seal(seal) => &mut **seal,
        }
    }
}

impl Definition {
    /// Reads the definition in the resources at `location`, or beside the `library`; also returns its file.
    pub(super) fn find(location: &str, library: Option<&Path>) -> Result<(Self, Resource), Error> {
        // The table of a patch may have any name.
        let found = resources::find(location, library, &[SCENE_FILE, PATCH_FILE, SEAL_FILE, TABLE_FILE])?;
        let path = &found.path;
        check_memory(
            "reading the resources",
            READING.saturating_mul(size_of_files_beside(path)).saturating_add(DERIVED),
        )?;
        let definition = if path.ends_with(TABLE_FILE) {
            PointContact::new(FrictionTable::load(path)?).into()
        } else if path.ends_with(PATCH_FILE) {
            Patch::load(path)?.into()
        } else if path.ends_with(SEAL_FILE) {
            Seal::load(path)?.into()
        } else {
            let mut scene = Scene::load(path)?;
            EvenSliding::settle(&mut scene);
            scene.into()
        };
        Ok((definition, found))
    }
}

/// Memory for what a scene derives of no file, the spectra and kernels of roughness and layer above all.
const DERIVED: usize = 8 << 20;

/// Memory for each byte of a file that is read: its text, the numbers in it, what is computed from them.
const READING: usize = 16;

fn size_of_files_beside(path: &Path) -> usize {
    let folder = path.parent().and_then(|folder| fs::read_dir(folder).ok());
    let sizes = folder.into_iter().flatten().filter_map(|file| file.ok()?.metadata().ok()).map(|file| file.len());
    sizes.sum::<u64>().try_into().unwrap_or(usize::MAX)
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

    /// The parameter called `name`.
    pub(super) fn named(&self, name: &str) -> Option<Parameter> {
        self.definition.parameters().into_iter().find(|parameter| parameter.name() == name)
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

/// The content of the files that a definition is read from, as an FMU carries them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sources {
    /// Its own file, then every file that it reads, in the scene's order.
    files: Vec<Vec<u8>>,
}

impl Sources {
    /// Reads the file at `path` and what else `definition`, which was loaded from it, reads.
    ///
    /// # Errors
    /// Where a file cannot be read.
    pub fn new(path: &Path, definition: &dyn FmuModel) -> io::Result<Self> {
        let folder = path.parent().unwrap_or(Path::new(""));
        let mut files = vec![fs::read(path)?];
        let carried = definition.carried(folder).map_err(|(_, error)| error)?;
        files.extend(carried.into_iter().map(|(_, content)| content));
        Ok(Self { files })
    }

    pub(super) fn read_from(path: &Path, definition: &dyn FmuModel) -> Result<Self, Error> {
        Self::new(path, definition).map_err(|source| Error::Unreadable { path: path.into(), source })
    }
}

/// The GUID of the FMU made from `sources`: a UUID of version 5 over the program's version, the bytes of every source
/// and the list of variables. It is the same on every build and another one for anything that would run differently.
pub fn guid(sources: &Sources, variables: &VariableTable) -> String {
    let mut content = Vec::new();
    append(&mut content, env!("CARGO_PKG_VERSION").as_bytes());
    for file in &sources.files {
        append(&mut content, file);
    }
    for (reference, entry) in variables.entries() {
        append(&mut content, format!("{reference} {} {}", entry.name, entry.kind).as_bytes());
    }
    let namespace = Uuid::new_v5(&Uuid::NAMESPACE_URL, b"asperity");
    format!("{{{}}}", Uuid::new_v5(&namespace, &content))
}

/// Appends the length, too: two files must not look like two others with the same bytes in a row.
fn append(content: &mut Vec<u8>, bytes: &[u8]) {
    content.extend((bytes.len() as u64).to_le_bytes());
    content.extend(bytes);
}
