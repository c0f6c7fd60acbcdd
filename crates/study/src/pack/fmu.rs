//! What goes into an FMU.

use std::io;
use std::path::{Component, Path};

use asperity::table::Header;
use asperity_fmi::{Definition, Sources, VariableTable, guid};
use clap::{ArgAction, Args};
use serde::{Deserialize, Serialize};

use super::archive::{ArchiveEntry, Library, zip};
use super::description::{FIXED_FILES, Nominals, description, documentation};
use super::{experiment, terminals};
use crate::decimals::short;
use crate::error::Error;
use crate::files::bytes;
use crate::summary::{LabelledLine, patch_rows, scene_rows, seal_rows, table_rows};
use crate::sweep::is_converged;

// What of an FMU is to choose. Not a doc comment: that would be the description of the command.
#[expect(missing_docs, reason = "clap would print it")]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Args)]
pub struct FmuOptions {
    /// Gives variables names without structure, as transport_speed for transport.speed, for tools that make buses or
    /// folders of points and brackets in names.
    #[arg(long)]
    pub flat_names: bool,
    /// Leaves out what shows that the FMU runs as it should, for which its experiment is run: inputs, result and the list of
    /// the files that it carries (FMI-LS-REF).
    #[arg(long = "no-references", action = ArgAction::SetFalse)]
    pub references: bool,
}

/// An FMU before it is packed.
#[derive(Debug)]
pub struct Fmu<'a> {
    /// What it computes.
    pub definition: &'a Definition,
    /// The file that this was read from.
    pub path: &'a Path,
    /// What computes it, one a platform.
    pub libraries: &'a [Library],
    /// What its documentation says of it, as [`summary`] does, or more.
    pub summary: &'a [LabelledLine],
    /// model.png, a picture of it as a PNG file; without one it has none.
    pub picture: Option<Vec<u8>>,
    /// What of it is to choose.
    pub options: FmuOptions,
}

impl Fmu<'_> {
    /// The archive, and what it leaves out of what shows that the FMU runs as it should, and why: the same FMU has the same
    /// bytes.
    ///
    /// # Errors
    /// Where a file cannot be read, or does not lie where an FMU can carry it; where a patch is too large to be done in a step.
    pub fn pack(&self) -> Result<(Vec<u8>, Vec<String>), Error> {
        let (entries, left_out) = self.entries()?;
        let archive = zip(entries).map_err(|error| Error::value(format!("cannot pack: {error}")))?;
        Ok((archive, left_out.iter().map(|text| format!("the FMU has {text}")).collect()))
    }

    /// The files of the archive, and what it leaves out.
    pub(super) fn entries(&self) -> Result<(Vec<ArchiveEntry>, Vec<String>), Error> {
        check_size(self.definition)?;
        let identifier = self.definition.identifier();
        let binary = |library: &Library| ArchiveEntry::executable(library.place(&identifier), library.bytes.clone());
        let mut entries: Vec<ArchiveEntry> = self.libraries.iter().map(binary).collect();
        let resources = self.resources()?;
        let variables = self.variables()?;
        let (mut left_out, mut nominals) = (Vec::new(), Nominals::new());
        if self.options.references {
            let names: Vec<&str> = resources.iter().map(ArchiveEntry::name).collect();
            let references = experiment::entries(self.definition, &variables, (&names, self.picture.is_some()));
            let references = references.map_err(document("the references"))?;
            entries.extend(references.entries);
            (left_out, nominals) = (references.left_out, references.nominals);
        }
        entries.extend(resources);
        entries.extend(self.documents((&variables, &nominals))?);
        let terminals = terminals::entries(self.definition, &variables, self.picture.as_deref());
        entries.extend(terminals.map_err(document("terminalsAndIcons.xml"))?);
        entries.extend(self.picture.clone().map(|picture| ArchiveEntry::new("model.png", picture)));
        Ok((entries, left_out))
    }

    /// The scene or the table, under a fixed name, and the files that a scene reads.
    fn resources(&self) -> Result<Vec<ArchiveEntry>, Error> {
        let Self { definition, path, .. } = *self;
        let folder = path.parent().unwrap_or(Path::new(""));
        let mut entries = vec![ArchiveEntry::new(format!("resources/{}", definition.file_name()), bytes(path)?)];
        let carried = definition.carried(folder).map_err(|(path, error)| Error::io("read", &path)(error))?;
        for (file, content) in carried {
            entries.push(ArchiveEntry::new(format!("resources/{}", archive_path(&file)?), content));
        }
        Ok(entries)
    }

    /// The variables, as they are called in the FMU.
    pub(super) fn variables(&self) -> Result<VariableTable, Error> {
        let variables = self.definition.variables();
        if !self.options.flat_names {
            return Ok(variables);
        }
        let same = |[first, second]: [String; 2]| format!("`flat-names`: {first} and {second} would have one name");
        variables.flat().map_err(|names| Error::value(same(names)))
    }

    /// The description of the model and the documentation.
    fn documents(&self, (variables, nominals): (&VariableTable, &Nominals)) -> Result<Vec<ArchiveEntry>, Error> {
        let Self { definition, path, .. } = *self;
        let guid = guid(&Sources::new(path, &**definition).map_err(Error::io("read", path))?, &definition.variables());
        let naming = if self.options.flat_names { "flat" } else { "structured" };
        let description = description(&**definition, (variables, nominals), (&guid, naming));
        let description = description.map_err(document("modelDescription.xml"))?;
        let index = documentation(definition, variables, self.summary);
        let index = index.map_err(document("documentation/index.html"))?;
        let written = [("modelDescription.xml", description), ("documentation/index.html", index)];
        let fixed = FIXED_FILES.iter().map(|&(name, text)| ArchiveEntry::new(name, text));
        Ok(written.into_iter().map(|(name, bytes)| ArchiveEntry::new(name, bytes)).chain(fixed).collect())
    }
}

/// Refuses a patch whose shortest step takes more than a call of a master may.
fn check_size(definition: &Definition) -> Result<(), Error> {
    let Definition::Patch(patch) = definition else { return Ok(()) };
    let share = patch.share_of_call();
    if share <= 1.0 {
        return Ok(());
    }
    Err(Error::value(format!(
        "the patch is too large for an FMU: expected elements whose shortest step takes what one call may, about a second; \
         that of its {} takes {} times as much; take fewer elements or a smaller solver.refine, or leave out tangents, heat or \
         the backing",
        patch.count(),
        short(share, 2)
    )))
}

/// For `map_err`: a document cannot be written.
fn document(document: &'static str) -> impl FnOnce(io::Error) -> Error {
    move |error| Error::value(format!("cannot write {document}: {error}"))
}

/// `file` with forward slashes. It must lie below the scene's folder: the FMU is unpacked elsewhere.
fn archive_path(file: &Path) -> Result<String, Error> {
    let parts = file.components().filter(|part| *part != Component::CurDir).map(|part| match part {
        Component::Normal(name) => Ok(name.to_string_lossy()),
        _ => Err(Error::value(format!(
            "the scene reads {}, which is not below the scene's folder: an FMU carries only what is",
            file.display()
        ))),
    });
    Ok(parts.collect::<Result<Vec<_>, _>>()?.join("/"))
}

/// The line that says what flat names are, by one of them.
pub fn flat_names(definition: &Definition) -> Option<LabelledLine> {
    let variables = definition.variables();
    let flat = variables.flat().ok()?;
    let mut pairs = variables.entries().zip(flat.entries()).map(|((_, own), (_, flat))| (&own.name, &flat.name));
    let (own, flat) = pairs.find(|(own, flat)| own != flat)?;
    Some(("Names", format!("flat, such as {flat} for {own}; messages keep {own}")))
}

/// What there is in the scene, in the table, in the patch or in the seal.
pub fn summary(definition: &Definition) -> Vec<LabelledLine> {
    match definition {
        Definition::Layer(scene) => scene_rows(scene),
        Definition::Element(contact) => table_rows(contact.table()),
        Definition::Patch(patch) => [patch_rows(patch), table_rows(patch.table())].concat(),
        Definition::Seal(seal) => [seal_rows(seal), table_rows(seal.table())].concat(),
    }
}

/// What is to be looked at in an FMU of what was read from the file at `path`: start values that do not initialise, and files
/// that links lead to outside of its folder.
pub fn warnings(definition: &Definition, path: &Path) -> Vec<String> {
    let folder = path.parent().filter(|folder| *folder != Path::new("")).unwrap_or(Path::new("."));
    let folder = folder.canonicalize().unwrap_or_else(|_| folder.to_owned());
    let linked = definition.sources(path).into_iter().filter(|file| file != path).filter_map(|file| {
        let place = file.canonicalize().ok().filter(|place| !place.starts_with(&folder))?;
        let (file, place) = (file.display(), place.display());
        Some(format!("{file} is a link out of its folder, to {place}: the FMU carries what that file holds"))
    });
    no_start(definition).into_iter().chain(linked).collect()
}

/// A warning of start values that do not initialise, which masters begin with that set none.
fn no_start(definition: &Definition) -> Option<String> {
    let problem = definition.start_problem()?;
    Some(format!("the FMU does not initialise at its start values: {problem}; set others before initialisation ends"))
}

/// A warning of a table of links that stand for a material, where it does not say that its numbers no longer depend on
/// the spacing.
pub fn not_converged(header: &Header) -> Option<String> {
    let foundation = header.text_of("foundation").filter(|_| is_converged(header) != Some(true))?;
    let found = header.text_of("convergence").unwrap_or("no study of it: see asperity converge");
    Some(format!("the table (foundation {foundation}) is not known to be converged: {found}"))
}

#[cfg(all(test, unix))]
mod tests {
    use asperity::patch::Patch;

    use super::*;
    use crate::files::load_scene;

    /// The library, which does not know what is not known of a scene, finds the same files and so the same GUID.
    #[test]
    fn a_covariance_is_not_carried() {
        let folder = std::env::temp_dir().join(format!("asperity-carried-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let scene = folder.join("s.toml");
        let text = "name = 's'\nlayer = { masses = 2, spacing = 1e-4, mass = 1e-6, vertical = { stiffness = 2e3 }, \
                    horizontal = { stiffness = 1e3 } }\nfriction = { coulomb = 0.3 }\nsurface = { kind = 'flat' }\n\
                    uncertainty = { covariance = 'c.csv' }\n";
        std::fs::write(&scene, text).unwrap();
        std::fs::write(folder.join("c.csv"), "key,value,scale,friction.coulomb\nfriction.coulomb,0.3,log,0.01\n")
            .unwrap();
        let own = Sources::new(&scene, &*Definition::from(load_scene(&scene, &[]).unwrap())).unwrap();
        let of_library =
            Sources::new(&scene, &*Definition::from(asperity::scene::Scene::load(&scene).unwrap())).unwrap();
        assert_eq!(own, of_library);
        std::fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn a_patch_whose_shortest_step_takes_too_long_is_refused() {
        let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join("tests/reference/patch");
        let packed = |n: u32, outputs: &str| {
            let text = format!(
                "name = 'pad'\ntable = {{ path = 'block.table.csv' }}\npatch = {{ shape = 'flat', length = 0.01, \
                 width = 0.01, nx = {n}, ny = {n} }}\nfmu = {{ outputs = [{outputs}] }}"
            );
            check_size(&Patch::parse(&text, &folder.join("patch.toml")).unwrap().into())
                .map_err(|error| error.to_string())
        };
        assert_eq!(packed(1000, "'forces'"), Ok(()));
        assert_eq!(packed(100, "'forces', 'tangent'"), Ok(()));
        let refused = packed(1000, "'forces', 'tangent'").unwrap_err();
        assert!(refused.contains("too large for an FMU") && refused.contains("1000000 takes 1.2 times"), "{refused}");
    }

    #[test]
    fn files_that_links_lead_to_outside_of_the_folder_are_named() {
        let all = std::env::temp_dir().join(format!("asperity-links-{}", std::process::id()));
        let [folder, other] = ["scene", "secret"].map(|name| all.join(name));
        [&folder, &other].into_iter().for_each(|path| std::fs::create_dir_all(path).unwrap());
        let points = "x [m],z [m]\n0,0\n1e-4,1e-6\n2e-4,0\n";
        std::fs::write(other.join("private.csv"), points).unwrap();
        std::fs::write(folder.join("beside.csv"), points).unwrap();
        let scene = folder.join("s.toml");
        let text = "name = 's'\nlayer = { masses = 2, spacing = 1e-4, mass = 1e-6, vertical = { stiffness = 2e3 }, \
                    horizontal = { stiffness = 1e3 } }\nfriction = { coulomb = 0.3 }\n\
                    surface = { kind = 'file', path = 'road.csv' }\n";
        std::fs::write(&scene, text).unwrap();
        let said = |target: &Path| {
            drop(std::fs::remove_file(folder.join("road.csv")));
            std::os::unix::fs::symlink(target, folder.join("road.csv")).unwrap();
            warnings(&load_scene(&scene, &[]).unwrap().into(), &scene)
        };
        let found = said(&other.join("private.csv"));
        assert!(found.iter().any(|text| text.contains("road.csv") && text.contains("private.csv")), "{found:?}");
        let found = said(&folder.join("beside.csv"));
        assert!(!found.iter().any(|text| text.contains("link")), "{found:?}");
        std::fs::remove_dir_all(all).unwrap();
    }
}
