//! `asperity pack`: a scene and the shared library as one FMU.

mod archive;
mod documentation;
mod libraries;
mod model_description;
mod parts;
mod picture;
mod units;
mod variables;

use std::fs;
use std::path::{Component, Path};

use asperity::fmi::{Catalogue, SCENE_FILE, Sources, guid};
use asperity::scene::Scene;

use super::arguments::Pack;
use super::error::ProgramError;
use archive::Entry;
use parts::PARTS;

/// Writes the FMU.
pub(crate) fn pack(command: &Pack) -> Result<(), ProgramError> {
    let scene = super::load(&command.scene)?;
    super::check_output(&command.output, &super::sources(&command.scene, &scene))?;
    let mut entries = libraries::binaries(&scene, &command.library)?;
    entries.extend(resources(&scene, &command.scene)?);
    entries.extend(documents(&scene, &command.scene)?);
    let bytes = archive::zip(entries)?;
    fs::write(&command.output, bytes).map_err(ProgramError::file("write", &command.output))
}

/// The scene, under a fixed name, and what it reads.
fn resources(scene: &Scene, path: &Path) -> Result<Vec<Entry>, ProgramError> {
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut entries = vec![Entry::new(format!("resources/{SCENE_FILE}"), read(path)?)];
    for file in &scene.files {
        entries.push(Entry::new(format!("resources/{}", archive_path(file)?), read(&folder.join(file))?));
    }
    Ok(entries)
}

/// `file` with forward slashes; an FMU is unpacked anywhere, so nothing outside the scene's folder can go with it.
fn archive_path(file: &Path) -> Result<String, ProgramError> {
    let parts = file.components().filter(|part| *part != Component::CurDir).map(|part| match part {
        Component::Normal(name) => Ok(name.to_string_lossy()),
        _ => Err(ProgramError::Outside { path: file.to_owned() }),
    });
    Ok(parts.collect::<Result<Vec<_>, _>>()?.join("/"))
}

fn documents(scene: &Scene, path: &Path) -> Result<Vec<Entry>, ProgramError> {
    let document = |document, source| ProgramError::Document { document, source };
    let catalogue = Catalogue::new(scene);
    let guid = guid(&Sources::read(path, scene).map_err(ProgramError::file("read", path))?, &catalogue);
    let description = model_description::write(scene, &catalogue, &guid);
    let description = description.map_err(|error| document("modelDescription.xml", error))?;
    let index = documentation::write(scene, &catalogue);
    let index = index.map_err(|error| document("documentation/index.html", error))?;
    let picture = picture::png(scene).map_err(|error| document("model.png", error.into()))?;
    let parts = PARTS.iter().map(|(name, text)| Entry::new((*name).into(), text.as_bytes().to_vec()));
    let written = [("modelDescription.xml", description), ("documentation/index.html", index), ("model.png", picture)];
    Ok(written.into_iter().map(|(name, bytes)| Entry::new(name.into(), bytes)).chain(parts).collect())
}

fn read(path: &Path) -> Result<Vec<u8>, ProgramError> {
    fs::read(path).map_err(ProgramError::file("read", path))
}
