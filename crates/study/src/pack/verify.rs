//! Whether an FMU is what this program packs: its own resources are packed once more, for the same FMU has the same bytes.
//!
//! Its shared library is read, never loaded: it is a whole file with the functions of FMI 2.0, and may be the one that the
//! program has beside itself. The result is compared with what the program's own engine gets along the experiment.

use std::collections::BTreeMap;
use std::fs;
use std::io::{Cursor, Read as _};
use std::path::{Path, PathBuf};

use asperity::element::{FrictionTable, PointContact};
use asperity::patch::Patch;
use asperity::scene::Scene;
use asperity::seal::Seal;
use asperity::tables::fields;
use asperity_fmi::{Definition, PATCH_FILE, SCENE_FILE, SEAL_FILE, TABLE_FILE, VariableTable};
use zip::ZipArchive;
use zip::result::ZipError;

use super::archive::{ArchiveEntry, Library, LibraryFile, Platform};
use super::experiment::{EXPERIMENT, FOLDER, LEFT_OUT_FILE, MANIFEST, RESULT};
use super::fmu::{Fmu, FmuOptions};
use crate::decimals::short;
use crate::error::Error;
use crate::files::bytes;
use crate::summary::LabelledLine;

/// What was found of an FMU.
#[derive(Clone, Debug, PartialEq)]
pub struct Verified {
    /// What was looked at, in lines.
    pub facts: Vec<LabelledLine>,
    /// What is not as it was packed.
    pub problems: Vec<String>,
    /// Whether a library of it is one that the program has beside itself: what another one computes is not shown.
    pub has_own_library: bool,
    /// What it carries to show that it runs as it should; why it carries nothing.
    pub carried: Result<Carried, String>,
}

impl Verified {
    /// Whether all of it is as it was packed, and its result was shown.
    pub fn is_as_packed(&self) -> bool {
        self.problems.is_empty() && self.carried.is_ok()
    }
}

/// The experiment of an FMU and its result, whose times are the same.
#[derive(Clone, Debug, PartialEq)]
pub struct Carried {
    /// The time and inputs.
    pub experiment: NumberColumns,
    /// The time and outputs.
    pub result: NumberColumns,
    /// What the result is, in a sentence.
    pub description: String,
}

/// Columns by their names.
pub type NumberColumns = Vec<(String, Vec<f64>)>;

/// The files of an archive by their names.
type Files = BTreeMap<String, Vec<u8>>;

/// Bytes, unpacked: pack writes tables of 0.1 MB, and libraries of three platforms have some 30 MB.
const LARGEST: u64 = 1 << 30;
const LARGEST_TABLE: u64 = 1 << 24;
/// What is written for people, from more than the resources.
const FOR_PEOPLE: [&str; 3] = ["documentation/index.html", "model.png", "terminalsAndIcons/icon.png"];
const DESCRIPTION: &str = "modelDescription.xml";
/// Most lines of a file whose differences are told.
const MOST_LINES: usize = 4;
/// Where a result may differ that another processor rounds, over the largest of its unit, of models without a tolerance.
const ROUNDING: f64 = 1e-6;

/// Verifies the FMU at a path; `own` are the shared libraries of the program itself.
///
/// # Errors
/// Where it is no FMU that can be read whole, its library is not whole, or what it carries is no experiment and its result, by
/// file and row.
pub fn verify(fmu: &Path, own: &[LibraryFile]) -> Result<Verified, Error> {
    let refused = |problem: String| Error::in_file(fmu, None, problem);
    let files = unpacked(fmu)?;
    let folder = tempfile::tempdir().map_err(Error::io("write", Path::new("a folder of its own")))?;
    let (definition, path) = resources(&files, folder.path())
        .map_err(|error| refused(error.to_string().replace(&format!("{}/", folder.path().display()), "resources/")))?;
    let identifier = definition.identifier();
    let of_platform =
        |platform: Platform| Some(Library { platform, bytes: files.get(&place(platform, &identifier))?.clone() });
    let libraries: Vec<Library> = Platform::ALL.into_iter().filter_map(of_platform).collect();
    for library in &libraries {
        let name = place(library.platform, &identifier);
        library.check().map_err(|problem| refused(format!("{name}: {problem}")))?;
    }
    let description = files.get(DESCRIPTION).map(|bytes| String::from_utf8_lossy(bytes)).unwrap_or_default();
    let options = FmuOptions {
        flat_names: description.contains("variableNamingConvention=\"flat\""),
        references: files.contains_key(MANIFEST),
    };
    let picture = files.contains_key("model.png").then(Vec::new);
    let packed = Fmu { definition: &definition, path: &path, libraries: &libraries, summary: &[], picture, options };
    let (variables, entries) = (packed.variables()?, packed.entries()?.0);
    let carried = carried(&files, &variables).map_err(|problem| refused(problem.to_string()))?;
    let mut verified = Verified { facts: Vec::new(), problems: Vec::new(), has_own_library: false, carried };
    verified.facts.push(("FMU", format!("{}, by {}", definition.name(), attribute(&description, "generationTool"))));
    verified.look_at_libraries(&libraries, own, files.keys());
    match attribute(&description, "generationTool") {
        tool if tool == concat!("asperity ", env!("CARGO_PKG_VERSION")) => {
            verified.compare_files(&files, &entries);
            verified.compare_results(&definition, &variables, &files, &entries);
        }
        tool => {
            let this = env!("CARGO_PKG_VERSION");
            let expected = "only the version that packed it can tell more";
            verified.problems.push(format!("{DESCRIPTION}: generationTool = \"{tool}\", this is {this}: {expected}"));
        }
    }
    Ok(verified)
}

/// The place of a library in the archive.
fn place(platform: Platform, identifier: &str) -> String {
    Library { platform, bytes: Vec::new() }.place(identifier)
}

/// The files of the archive at a path.
fn unpacked(fmu: &Path) -> Result<Files, Error> {
    let refused = |problem: String| Error::in_file(fmu, None, problem);
    let no_archive = |error: ZipError| refused(format!("expected an FMU, a whole zip archive: {error}"));
    let mut archive = ZipArchive::new(Cursor::new(bytes(fmu)?)).map_err(no_archive)?;
    let (mut files, mut left) = (Files::new(), LARGEST);
    for index in 0..archive.len() {
        let file = archive.by_index(index).map_err(no_archive)?;
        let name = file.name().map_err(no_archive)?.into_owned();
        if name.starts_with('/') || name.contains(['\\', ':']) || name.split('/').any(|part| part == "..") {
            return Err(refused(format!("{name}: expected a name within the archive, with forward slashes")));
        }
        let most = if name.starts_with(FOLDER) { LARGEST_TABLE.min(left) } else { left };
        let mut content = Vec::new();
        let read = file.take(most + 1).read_to_end(&mut content);
        read.map_err(|error| refused(format!("{name}: expected a whole file: {error}")))?;
        left = left.saturating_sub(content.len() as u64);
        if content.len() as u64 > most {
            return Err(refused(format!("{name}: expected at most {most} bytes when unpacked")));
        }
        if !name.ends_with('/') {
            files.insert(name, content);
        }
    }
    if !files.contains_key(DESCRIPTION) {
        return Err(refused(format!("expected an FMU, with a {DESCRIPTION}")));
    }
    Ok(files)
}

/// What the resources define, as the FMU's library reads them, written to a folder; and its own file.
fn resources(files: &Files, folder: &Path) -> Result<(Definition, PathBuf), Error> {
    for (name, content) in files.iter().filter_map(|(name, content)| Some((name.strip_prefix("resources/")?, content)))
    {
        let path = folder.join(name);
        let written = path.parent().map_or(Ok(()), fs::create_dir_all).and_then(|()| fs::write(&path, content));
        written.map_err(Error::io("write", &path))?;
    }
    let [scene, patch, seal, table] = [SCENE_FILE, PATCH_FILE, SEAL_FILE, TABLE_FILE].map(|name| folder.join(name));
    if scene.is_file() {
        Ok((Scene::load(&scene)?.into(), scene))
    } else if patch.is_file() {
        Ok((Patch::load(&patch)?.into(), patch))
    } else if seal.is_file() {
        Ok((Seal::load(&seal)?.into(), seal))
    } else if table.is_file() {
        Ok((PointContact::new(FrictionTable::load(&table)?).into(), table))
    } else {
        let expected = format!("expected {SCENE_FILE}, {PATCH_FILE}, {SEAL_FILE} or {TABLE_FILE} in resources");
        Err(Error::value(format!("{expected}: only FMUs of asperity can be verified")))
    }
}

/// The value of an attribute of a document, its first; empty without.
fn attribute(xml: &str, name: &str) -> String {
    let value = xml.split_once(&format!("{name}=\"")).and_then(|(_, rest)| rest.split_once('"'));
    value.map(|(value, _)| value.to_owned()).unwrap_or_default()
}

impl Verified {
    /// Which libraries there are, and which of them the program has beside itself.
    fn look_at_libraries<'n>(
        &mut self,
        libraries: &[Library],
        own: &[LibraryFile],
        names: impl Iterator<Item = &'n String>,
    ) {
        if libraries.is_empty() {
            let found: Vec<&str> = names.map(String::as_str).filter(|name| name.starts_with("binaries/")).collect();
            self.problems.push(format!("no library of its name in binaries, found {}", found.join(", ")));
        }
        for library in libraries {
            let ours = own.iter().find(|file| file.platform() == library.platform);
            let is_ours = ours.is_some_and(|file| bytes(file.path()).is_ok_and(|ours| ours == library.bytes));
            self.has_own_library |= is_ours;
            let looked = if library.platform == Platform::LINUX {
                "a whole library with the functions of FMI 2.0"
            } else {
                "not looked into, it is for another system"
            };
            let said = match is_ours {
                true => "byte for byte the one beside this program",
                false => "another one than beside this program: what it computes is not shown",
            };
            self.facts.push(("Library", format!("{}: {looked}; {said}", library.platform.folder)));
        }
    }

    /// Compares the files of an archive with those that this program packs of its resources.
    fn compare_files(&mut self, files: &Files, entries: &[ArchiveEntry]) {
        let is_compared = |name: &str| !FOR_PEOPLE.contains(&name) && name != RESULT;
        for entry in entries.iter().filter(|entry| is_compared(entry.name())) {
            match files.get(entry.name()) {
                Some(found) if found == entry.bytes() => (),
                Some(found) => self.problems.extend(differences(entry.name(), found, entry.bytes())),
                None => self.problems.push(format!("{} is not there", entry.name())),
            }
        }
        let compared = entries.iter().filter(|entry| is_compared(entry.name())).count();
        let is_packed = |name: &str| entries.iter().any(|entry| entry.name() == name);
        let besides: Vec<&str> = files.keys().map(String::as_str).filter(|name| !is_packed(name)).collect();
        if self.problems.is_empty() {
            let text = format!("{DESCRIPTION} and {} others as this program packs them of its resources", compared - 1);
            self.facts.push(("Files", text));
        }
        if !besides.is_empty() {
            self.facts.push(("Besides", format!("{}, which no FMU of asperity has", besides.join(", "))));
        }
    }

    /// Compares the result with what this program gets along the experiment.
    fn compare_results(
        &mut self,
        definition: &Definition,
        variables: &VariableTable,
        files: &Files,
        entries: &[ArchiveEntry],
    ) {
        let Ok(Carried { result, .. }) = &self.carried else { return };
        let (found, own) = (files.get(RESULT), entries.iter().find(|entry| entry.name() == RESULT));
        let expected = own.and_then(|own| number_columns(RESULT, own.bytes()).ok());
        let Some((own, expected)) = own.zip(expected).filter(|(_, expected)| is_alike(result, expected)) else {
            self.problems.push(format!("{RESULT}: other columns or rows than this program gets along the experiment"));
            return;
        };
        let rows = format!("the engine of this program gets {} rows", result.first().map_or(0, |(_, rows)| rows.len()));
        if found.is_some_and(|found| found == own.bytes()) {
            self.facts.push(("Result", format!("{rows} of {} outputs to the last digit", result.len() - 1)));
            return;
        }
        let tolerance = definition.default_experiment().and_then(|experiment| experiment.tolerance).unwrap_or(ROUNDING);
        let (name, difference) = largest_difference(result, &expected, variables);
        let text = format!("{} of the largest of its unit off, {name} most", short(difference, 2));
        if difference <= tolerance {
            self.facts.push(("Result", format!("{rows}, {text}: within the tolerance {tolerance:e}")));
        } else {
            self.problems.push(format!("{RESULT}: {text}, against what this program gets, tolerance {tolerance:e}"));
        }
    }
}

/// The first lines in which a file differs from what was packed.
fn differences(name: &str, found: &[u8], expected: &[u8]) -> Vec<String> {
    let [found, expected] = [found, expected].map(String::from_utf8_lossy);
    let (mut found, mut expected) = (found.lines(), expected.lines());
    let mut told = Vec::new();
    for line in 1.. {
        let pair = (found.next(), expected.next());
        if told.len() == MOST_LINES || pair == (None, None) {
            break;
        }
        if pair.0 != pair.1 {
            let [found, expected] = [pair.0, pair.1].map(|line| line.unwrap_or("the end").trim());
            told.push(format!("{name}, line {line}: {found}: packed was {expected}"));
        }
    }
    if told.is_empty() { vec![format!("{name}: its ends of lines differ")] } else { told }
}

/// Whether two tables have the same columns and times.
fn is_alike(one: &NumberColumns, other: &NumberColumns) -> bool {
    let names = |columns: &NumberColumns| columns.iter().map(|(name, _)| name.clone()).collect::<Vec<_>>();
    names(one) == names(other) && one.first() == other.first()
}

/// The output that differs most, and by which part of the largest value of its unit.
fn largest_difference(found: &NumberColumns, expected: &NumberColumns, variables: &VariableTable) -> (String, f64) {
    let unit = |name: &str| variables.entries().find(|(_, one)| one.name == name).map(|(_, variable)| variable.unit);
    let size = |values: &[f64]| values.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
    let scale = |name: &str| {
        let alike = expected.iter().filter(|(other, _)| unit(other) == unit(name));
        alike.map(|(_, values)| size(values)).fold(0.0, f64::max)
    };
    let all = found.iter().zip(expected).skip(1).map(|((name, found), (_, expected))| {
        let differences: Vec<f64> = found.iter().zip(expected).map(|(found, expected)| found - expected).collect();
        let (most, scale) = (size(&differences), scale(name));
        (name.clone(), if scale > 0.0 { most / scale } else { most })
    });
    all.max_by(|one, other| one.1.total_cmp(&other.1)).unwrap_or_default()
}

/// The experiment and its result in an archive; why it carries none.
fn carried(files: &Files, variables: &VariableTable) -> Result<Result<Carried, String>, Problem> {
    let Some((experiment, result)) = files.get(EXPERIMENT).zip(files.get(RESULT)) else {
        let left_out = files.get(LEFT_OUT_FILE).map(|bytes| String::from_utf8_lossy(bytes).trim().to_owned());
        let usual = "an FMU of asperity pack has them, unless it was packed with --no-references";
        let why = left_out.map_or_else(|| usual.to_owned(), |left_out| format!("it has {left_out}"));
        return Ok(Err(format!("expected an experiment and its result in {FOLDER}: {why}")));
    };
    let (experiment, result) = (number_columns(EXPERIMENT, experiment)?, number_columns(RESULT, result)?);
    let is_output = |name: &str| variables.entries().any(|(_, one)| one.name == name && one.is_calculated());
    let names: Vec<&str> = result.iter().map(|(name, _)| name.as_str()).collect();
    let unknown: Vec<&str> = names.iter().skip(1).copied().filter(|name| !is_output(name)).collect();
    if names.len() < 2
        || !unknown.is_empty()
        || names[0] != TIME
        || experiment.first().is_none_or(|(name, _)| name != TIME)
    {
        let unknown = if unknown.is_empty() { "none".to_owned() } else { unknown.join(", ") };
        return Err(format!("{RESULT}, row 1: expected columns time and outputs of the FMU, found {unknown}").into());
    }
    let (times, own) = (&experiment[0].1, &result[0].1);
    if own.len() != times.len() {
        let (expected, found) = (times.len(), own.len());
        return Err(
            format!("{RESULT}: expected {expected} rows, as the experiment {EXPERIMENT} has, found {found}").into()
        );
    }
    if let Some(row) = (0..own.len()).find(|&row| own[row] != times[row]) {
        let (expected, found) = (times[row], own[row]);
        let expected = format!("expected time = {expected}, as in the experiment {EXPERIMENT}, found {found}");
        return Err(format!("{RESULT}, row {}: {expected}", row + 2).into());
    }
    let manifest = files.get(MANIFEST).map(|bytes| String::from_utf8_lossy(bytes)).unwrap_or_default();
    let described = manifest.split_once("role=\"result\"").map_or("", |(_, rest)| rest);
    Ok(Ok(Carried { experiment, result, description: attribute(described, "description") }))
}

/// What is wrong with a table, with its name and row.
type Problem = Box<str>;

/// The column of times, the first.
const TIME: &str = "time";

/// A table of finite numbers under their names.
fn number_columns(name: &str, bytes: &[u8]) -> Result<NumberColumns, Problem> {
    let text = std::str::from_utf8(bytes).map_err(|error| format!("{name}: expected a table in UTF-8: {error}"))?;
    let mut lines = text.lines();
    let head = lines.next().into_iter().flat_map(|line| fields(line, ','));
    let mut columns: NumberColumns = head.map(|name| (name.into_owned(), Vec::new())).collect();
    for (line, row) in lines.zip(2..) {
        let fields: Vec<_> = fields(line, ',').collect();
        if fields.len() != columns.len() {
            let (expected, found) = (columns.len(), fields.len());
            let expected = format!("expected {expected} numbers, one for each column, found {found}");
            return Err(format!("{name}, row {row}: {expected}").into());
        }
        for ((column, values), field) in columns.iter_mut().zip(fields) {
            let number = field.parse().ok().filter(|number: &f64| number.is_finite());
            let field: String = field.chars().take(40).collect();
            let refused = || format!("{name}, row {row}: {column} = '{field}': expected a number");
            values.push(number.ok_or_else(refused)?);
        }
    }
    Ok(columns)
}
