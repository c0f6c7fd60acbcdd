//! `asperity pack`: packs a scene, or the table of a sweep, and the shared library as one FMU.

use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};

use asperity::element::{FrictionTable, PointContact};
use asperity::patch::Patch;
use asperity_fmi::Definition;
use asperity_study::Error;
use asperity_study::calibration::uncertain_scene;
use asperity_study::check::{Doubled, Dragged, ElementCheck, PatchCheck, Sliding};
use asperity_study::files::text;
use asperity_study::pack::{
    self, Fmu, FmuOptions, Library, LibraryFile, element_icon, flat_names, layer_icon, not_converged,
};
use asperity_study::progress::Stop;
use asperity_study::summary::missing_backing;
use asperity_study::sweep::{SweepTable, quantile_table};
use clap::{ArgGroup, Args};
use tempfile::TempDir;

use super::cli::values::{count, example, probability};
use super::files::{self, check_outputs, load_without_run, name_of, named, print, write};
use super::picture;
use super::terminal::{Bars, LabelledLine, labelled, lines, note, warn};

#[derive(Debug, Args)]
#[command(
    override_usage = "asperity pack [OPTIONS] --output <OUT.fmu>\n       <SCENE.toml|--table <TABLE.csv>|--patch <PATCH.toml>|\n        --seal <SEAL.toml>>"
)]
#[command(group(ArgGroup::new("input").required(true).multiple(true)))]
#[command(after_help = example!("asperity pack scenes/tread-block/tread-block.toml -o block.fmu"))]
pub(crate) struct Pack {
    /// The scene file; with --quantile the one that was swept.
    #[arg(value_name = "SCENE.toml", group = "input")]
    pub(crate) scene: Option<PathBuf>,
    /// A sweep table: packs a point-contact element, which interpolates the table instead of simulating the layer.
    #[arg(long, value_name = "TABLE.csv", group = "input")]
    #[arg(conflicts_with = "patch")]
    pub(crate) table: Option<PathBuf>,
    /// A patch file: packs a contact patch of many point-contact elements in three dimensions.
    #[arg(long, value_name = "PATCH.toml", group = "input")]
    pub(crate) patch: Option<PathBuf>,
    /// A seal file: packs a lip with a film.
    #[arg(long, value_name = "SEAL.toml", group = "input")]
    #[arg(conflicts_with_all = ["scene", "table", "patch", "quantile", "check"])]
    pub(crate) seal: Option<PathBuf>,
    /// Of a table with samples, or of a patch with such a table: packs the sample whose mean friction over the table is this
    /// quantile, from 0 to 1. It is drawn from the scene and swept again.
    #[arg(long, value_name = "SHARE", value_parser = probability, requires = "scene", conflicts_with = "check")]
    pub(crate) quantile: Option<f64>,
    /// The scene that was swept: compares the element with its layer between the table's points, or elements of the
    /// patch, tilted over the table's pressures, at three speeds; along a to-and-fro motion; and the patch with one of
    /// twice as many elements along and across. Writes tables and plots to a folder beside the FMU.
    #[arg(long, value_name = "SCENE.toml", conflicts_with = "scene")]
    pub(crate) check: Option<PathBuf>,
    /// Maximum number of points, or of elements of a patch, that --check compares with the layer.
    #[arg(long, value_name = "N", default_value_t = 12, value_parser = count, requires = "check")]
    #[arg(conflicts_with = "scene")]
    pub(crate) check_points: u32,
    /// The FMU to write.
    #[arg(short, long, value_name = "OUT.fmu")]
    pub(crate) output: PathBuf,
    #[command(flatten)]
    pub(crate) options: FmuOptions,
    /// A shared library; for this platform unless linux64, win64, darwin64, aarch64-linux or aarch64-darwin is given, as in
    /// win64=PATH. May be repeated. Default: the library beside this program.
    #[arg(long, value_name = "[PLATFORM=]PATH")]
    pub(crate) library: Vec<OsString>,
}

/// Writes the FMU; prints what its libraries need and, of an element, a patch or a seal, its table and errors.
pub(crate) fn pack(command: &Pack) -> Result<(), Error> {
    check_inputs(command)?;
    let sample = command.quantile.map(|share| Sample::new(command, share)).transpose()?;
    let (table, patch) =
        sample.as_ref().map_or((&command.table, &command.patch), |sample| (&sample.table, &sample.patch));
    let (definition, path) = load(command, table.as_ref(), patch.as_ref())?;
    let libraries = libraries(command);
    let mut taken = definition.sources(&path);
    taken.extend(libraries.iter().map(|library| library.path().to_owned()));
    taken.extend(
        [&command.check, &command.scene, &command.table, &command.patch, &command.seal].into_iter().flatten().cloned(),
    );
    check_outputs([&command.output], taken)?;
    let libraries = Library::read_all(&libraries).map_err(|error| with_way_to_build(error, &libraries))?;
    pack::warnings(&definition, &path).iter().for_each(|warning| warn(warning));
    let names = command.options.flat_names.then(|| flat_names(&definition)).flatten();
    let needs = labelled("Needs", libraries.iter().filter_map(Library::needs));
    let summary = summary(command, &definition)?;
    let picture = Some(model_picture(&definition)?);
    let fmu = Fmu {
        definition: &definition,
        path: &path,
        libraries: &libraries,
        summary: &summary,
        picture,
        options: command.options,
    };
    let (archive, left_out) = fmu.pack()?;
    write(&command.output, archive)?;
    left_out.iter().for_each(|text| warn(text));
    let needs = [names.into_iter().collect(), needs].concat();
    let shown = if matches!(definition, Definition::Layer(_)) { needs } else { [summary, needs].concat() };
    print(&lines(&shown))?;
    note(&format!("{} is written", named(&command.output)));
    Ok(())
}

/// A scene beside a table or a patch is there for `--quantile`, which needs one of them.
fn check_inputs(command: &Pack) -> Result<(), Error> {
    let has_table = command.table.is_some() || command.patch.is_some();
    match (command.scene.is_some() && has_table, command.quantile.is_some()) {
        (true, false) => {
            Err(Error::value("expected a scene, --table or --patch; a scene beside one of these only with --quantile"))
        }
        (false, true) => Err(Error::value("--quantile: expected --table or --patch, whose table has the samples")),
        _ => Ok(()),
    }
}

/// The libraries that `--library` names; by default the one beside this program.
fn libraries(command: &Pack) -> Vec<LibraryFile> {
    if command.library.is_empty() {
        return vec![LibraryFile::beside(&std::env::current_exe().unwrap_or_default())];
    }
    command.library.iter().map(|text| LibraryFile::named(text)).collect()
}

/// The error of libraries; where one is missing, with how it is made.
fn with_way_to_build(error: Error, libraries: &[LibraryFile]) -> Error {
    if libraries.iter().all(|library| library.path().is_file()) {
        return error;
    }
    Error::value(format!(
        "{error}: build it with `cargo build --release -p asperity-fmu` and name it with --library, or use build-fmu.sh, \
         which does both"
    ))
}

/// What is packed, and the file that it is read from.
fn load(command: &Pack, table: Option<&PathBuf>, patch: Option<&PathBuf>) -> Result<(Definition, PathBuf), Error> {
    match (patch, table) {
        _ if command.seal.is_some() => {
            let path = command.seal.clone().unwrap_or_default();
            let seal = files::load_seal(&path, &[])?;
            not_converged(&seal.table().header).iter().for_each(|warning| warn(warning));
            Ok((seal.into(), path))
        }
        (Some(path), _) => {
            let patch = files::load_patch(path, &[])?;
            let warnings = not_converged(&patch.table().header).into_iter().chain(missing_backing(&patch));
            warnings.for_each(|warning| warn(&warning));
            Ok((patch.into(), path.clone()))
        }
        (None, Some(path)) => {
            let table = FrictionTable::load(path)?;
            not_converged(&table.header).iter().for_each(|warning| warn(warning));
            Ok((PointContact::new(table).into(), path.clone()))
        }
        (None, None) => {
            let path = command.scene.clone().unwrap_or_default();
            Ok((files::load(&path, &[])?.into(), path))
        }
    }
}

/// What there is in the scene or in the table, and the errors of an element or a patch.
fn summary(command: &Pack, definition: &Definition) -> Result<Vec<LabelledLine>, Error> {
    let mut rows = pack::summary(definition);
    match (definition, &command.check) {
        (Definition::Element(contact), Some(scene)) => rows.extend(check_element(command, contact, scene)?),
        (Definition::Patch(patch), Some(scene)) => rows.extend(check_patch(command, patch, scene)?),
        _ => (),
    }
    Ok(rows)
}

/// model.png.
fn model_picture(definition: &Definition) -> Result<Vec<u8>, Error> {
    let picture = match definition {
        Definition::Layer(scene) => layer_icon(scene),
        Definition::Element(contact) => element_icon(contact.table()),
        Definition::Patch(patch) => element_icon(patch.table()),
        Definition::Seal(seal) => element_icon(seal.table()),
    };
    picture::icon(&picture).map_err(|error| files::not_drawn(Path::new("model.png"), error))
}

/// Compares the layer and the element, writes the results beside the FMU and summarises them.
fn check_element(command: &Pack, contact: &PointContact, scene: &Path) -> Result<Vec<LabelledLine>, Error> {
    let check = ElementCheck::new(contact, load_without_run(scene, &[], |_| true)?)?;
    let folder = folder_beside(&command.output)?;
    let points = check.points(command.check_points as usize, &Bars::new().watch())?;
    write(&folder.join("points.csv"), points.table())?;
    picture::write(&points.picture(), &folder.join("errors.svg"))?;
    let mut lines = points.lines();
    match check.to_and_fro(&points) {
        Some((_, Ok(rows))) => {
            write_pair(&folder, ["loop-layer", "loop-element"], rows.tables())?;
            picture::write(&rows.picture(), &folder.join("loop.svg"))?;
            lines.extend(rows.lines());
        }
        Some((point, Err(status))) => lines.push(("", format!("to and fro at {:.3e} m/s: {status}", point.speed))),
        None => (),
    }
    lines.push(("", format!("in {}", folder.display())));
    Ok(lines)
}

/// Compares elements with their layers and the patch with a finer one, writes the results beside the FMU and summarises
/// them.
fn check_patch(command: &Pack, patch: &Patch, scene: &Path) -> Result<Vec<LabelledLine>, Error> {
    let check = PatchCheck::new(patch, load_without_run(scene, &[], |_| true)?, command.check_points as usize)?;
    let folder = folder_beside(&command.output)?;
    let bars = Bars::new();
    let sliding = Sliding::run(&check, &bars.watch())?;
    write(&folder.join("points.csv"), sliding.table())?;
    picture::write(&sliding.errors_of_elements(), &folder.join("elements.svg"))?;
    let mut texts = sliding.summary();
    match Dragged::run(&check, &bars.watch())? {
        Ok(dragged) => {
            write_pair(&folder, ["loop-layers", "loop-elements"], dragged.tables())?;
            picture::write(&dragged.picture(), &folder.join("loop.svg"))?;
            texts.extend(dragged.summary());
        }
        Err(status) => texts.push(format!("to and fro: {status}")),
    }
    let steady = sliding.pair();
    let name = format!("elements beside their {}s", check.swept());
    let mut pairs = vec![(name.as_str(), &steady)];
    let doubled = Doubled::run(&check, &bars.watch())?;
    match &doubled {
        Ok(doubled) => {
            write_pair(&folder, ["loop-doubled", "loop-patch"], doubled.tables(&check))?;
            texts.extend(doubled.summary(&check));
            pairs.push(("nx, ny doubled", &doubled.steady));
        }
        Err(reason) => texts.push(format!("nx, ny doubled: not done, {reason}")),
    }
    picture::write(&check.differences(&pairs), &folder.join("errors.svg"))?;
    texts.push(format!("in {}", folder.display()));
    Ok(labelled("Checked", texts))
}

fn folder_beside(output: &Path) -> Result<PathBuf, Error> {
    let stem = output.file_stem().map_or_else(|| "element".into(), |stem| stem.to_string_lossy());
    let path = output.with_file_name(format!("{stem}-check"));
    fs::create_dir_all(&path).map_err(Error::io("create", &path))?;
    Ok(path)
}

fn write_pair(folder: &Path, names: [&str; 2], tables: [String; 2]) -> Result<(), Error> {
    names.iter().zip(tables).try_for_each(|(name, table)| write(&folder.join(format!("{name}.csv")), table))
}

/// A table of one sample, or a patch with such a table, in a folder of their own.
#[derive(Debug)]
struct Sample {
    table: Option<PathBuf>,
    patch: Option<PathBuf>,
    _folder: TempDir,
}

impl Sample {
    /// The sample at the quantile `share` of the table that is packed, drawn from the scene and swept again.
    fn new(command: &Pack, share: f64) -> Result<Self, Error> {
        let folder = tempfile::tempdir().map_err(Error::io("write", Path::new("a folder of its own")))?;
        let scene = command.scene.clone().unwrap_or_default();
        let read = load_without_run(&scene, &[], |_| true)?;
        let packed = |table: &Path| {
            let (table, stop) = (SweepTable::read(table)?, Stop::default());
            let uncertain = uncertain_scene(read.clone(), table.header.is_refitted(), &stop)?;
            let sample = quantile_table(&uncertain, &table, share, &stop)?;
            sample.header.keys.text_of("sample").iter().for_each(|sample| note(&format!("sample {sample}")));
            Ok::<_, Error>(sample.text())
        };
        let place = |name: &Path| folder.path().join(name);
        if let Some(path) = &command.patch {
            let patch = files::load_patch(path, &[])?;
            let own = path.parent().unwrap_or(Path::new(""));
            for file in patch.files() {
                let content = fs::read(own.join(file)).map_err(Error::io("read", file))?;
                place_file(&place(file), &content)?;
            }
            place_file(&place(patch.table_file()), packed(&own.join(patch.table_file()))?.as_bytes())?;
            let file = place(Path::new(&name_of(path)));
            place_file(&file, text(path)?.as_bytes())?;
            return Ok(Self { table: None, patch: Some(file), _folder: folder });
        }
        let table = command.table.clone().unwrap_or_default();
        let file = place(Path::new(&name_of(&table)));
        place_file(&file, packed(&table)?.as_bytes())?;
        Ok(Self { table: Some(file), patch: None, _folder: folder })
    }
}

/// Writes a file and the folders that it is in.
fn place_file(path: &Path, content: &[u8]) -> Result<(), Error> {
    let folder = path.parent().map_or(Ok(()), fs::create_dir_all);
    folder.and_then(|()| fs::write(path, content)).map_err(Error::io("write", path))
}
