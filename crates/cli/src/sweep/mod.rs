//! `asperity sweep`: the friction coefficient over speed, load and temperature, as a table and a plot.

mod printed;
mod seal;

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use asperity::element::{OperatingPoint, some_of};
use asperity::scene::{Scene, Wlf};
use asperity::table::{Cell, Column, Header, Table, TableError};
use asperity::tables::Dimension;
use asperity_study::Error;
use asperity_study::calibration::uncertain_scene;
use asperity_study::files::ColumnOptions;
use asperity_study::friction_map::Maps;
use asperity_study::progress::Stop;
use asperity_study::stribeck::StribeckOptions;
use asperity_study::sweep::{
    Gaps, Over, SlidingOptions, SweepHeader, SweepOptions, SweepPlan, SweepRow, SweepTable, master_picture,
    matters_picture, over_ways, sweep_picture, verdict,
};
use asperity_study::uncertainty::SampleOptions;
use asperity_study::values::Values;
use clap::{ArgGroup, Args};

use super::cli::values::{self, Set, count, example};
use super::files::{
    self, check_outputs, default_output, load_without_run, named, picture_beside, print_beside, read, write,
};
use super::interrupt::Farewell;
use super::output::is_stream;
use super::picture;
use super::table_file::TableFile;
use super::terminal::{self, LabelledLine, lines, note, warn};
use seal::SealSweep;

/// Options of a sweep that --merge does not take.
const OF_A_SCENE: [&str; 19] = [
    "gaps",
    "sealed",
    "speeds",
    "pressures",
    "forces",
    "temperatures",
    "method",
    "way",
    "points",
    "friction_error",
    "distance",
    "shard",
    "master",
    "converged",
    "samples",
    "seed",
    "refit",
    "keep",
    "set",
];

/// Options of a sweep that --seal does not take.
const NOT_OF_A_SEAL: [&str; 20] = [
    "gaps",
    "pressures",
    "forces",
    "method",
    "way",
    "points",
    "friction_error",
    "distance",
    "over",
    "data",
    "columns",
    "master",
    "ways",
    "samples",
    "seed",
    "refit",
    "keep",
    "shard",
    "merge",
    "converged",
];

#[derive(Debug, Args)]
#[command(
    override_usage = "asperity sweep [OPTIONS] --speeds <VALUES> <SCENE.toml>\n       asperity sweep [OPTIONS] --output <TABLE.csv> --merge <TABLE.csv>...\n       asperity sweep [OPTIONS] --seal <SEAL.toml>"
)]
#[command(group(ArgGroup::new("input").required(true)))]
#[command(group(ArgGroup::new("speeds_or_merge").required(true).multiple(true).args(["speeds", "merge", "seal"])))]
#[command(after_help = example!(
    "asperity sweep scenes/road/road.toml --speeds 1e-4..10/11 --pressures 3bar \\\n      --temperatures 5°C,20°C,40°C -o friction.csv"
))]
pub(crate) struct Sweep {
    /// The scene file; its excitation and outputs are not used.
    #[arg(value_name = "SCENE.toml", group = "input")]
    pub(crate) scene: Option<PathBuf>,
    /// A seal file: the Stribeck curve of a lip with a film. Friction, film, share of contacts and leak rate in steady motion
    /// to the air and back, over speed (default: the table's), sealed pressure and temperature, and the net leak of a stroke.
    #[arg(long, value_name = "SEAL.toml", group = "input", conflicts_with_all = NOT_OF_A_SEAL)]
    pub(crate) seal: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) stribeck: StribeckOptions,
    #[command(flatten)]
    pub(crate) options: SweepOptions,
    /// Also computes how a fluid passes the gaps of the contact, with --method steady: leak_gap and drag_gap, m, the distances
    /// at which smooth plates let as much through and carry as much along; solved for on a map, with leak_gap_across, and by
    /// the effective medium of a profile. "medium" has that of a map beside.
    #[arg(long, value_name = "GAPS", value_enum, num_args = 0..=1, default_missing_value = "solved")]
    pub(crate) gaps: Option<Gaps>,
    /// The table to write, - for standard output; an existing table of the same sweep is continued. Default: the
    /// scene's file name with .sweep.csv.
    #[arg(short, long, value_name = "TABLE.csv")]
    pub(crate) output: Option<PathBuf>,
    /// The plot to write, as SVG or PNG according to the file name. Points that are not steady, or not converged, are
    /// hollow. Default: the table's name with .svg.
    #[arg(long, value_name = "OUT.svg", value_parser = values::picture(), conflicts_with = "shard")]
    pub(crate) plot: Option<PathBuf>,
    /// Plots a map in place of curves: friction in colours over two of speed, pressure (or force) and temperature, x and y
    /// in this order, a map for each value of the third, with contour lines and where along x friction is largest.
    #[arg(long, value_name = "X,Y", value_parser = Over::parse, conflicts_with_all = ["shard", "ways"])]
    pub(crate) over: Option<Over>,
    /// Measured friction, as for asperity calibrate, drawn in the same colours into the maps of --over.
    #[arg(long, value_name = "MEASURED.csv", requires = "over")]
    pub(crate) data: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) columns: ColumnOptions,
    /// Also plots the master curve: friction over a_T v, the speed at the reference temperature of material.wlf.
    #[arg(long, value_name = "OUT.svg", value_parser = values::picture(), conflicts_with = "shard")]
    pub(crate) master: Option<PathBuf>,
    /// Several ways in m, in the format of --speeds: the table has a column way [m], and friction is plotted over the way. It
    /// is not to be packed or continued.
    #[arg(long, value_name = "VALUES", value_parser = Values::of(Dimension::Length))]
    #[arg(conflicts_with_all = ["way", "shard", "merge", "master", "converged"])]
    pub(crate) ways: Option<Values>,
    /// Also computes each point for N scenes drawn from what the scene's section [uncertainty] says is not known: quantiles
    /// of friction, hysteresis and area are columns of the table, friction's bands of 50 and 90 % are plotted, and what
    /// matters is written beside the table with .matters.csv and .matters.svg.
    #[arg(long, value_name = "N", value_parser = count, conflicts_with = "ways")]
    pub(crate) samples: Option<u32>,
    /// What scrambles the points of the samples: another seed draws others.
    #[arg(long, value_name = "N", default_value_t = 1, requires = "samples")]
    pub(crate) seed: u64,
    /// Fits the numbers of the covariance in [uncertainty] anew in each sample, by the measurements that asperity calibrate
    /// stored with it, before they vary: so bands hold what was measured where other things vary beside it (surface.spectrum,
    /// surface = "seed", material.prony).
    #[arg(long, requires = "samples")]
    pub(crate) refit: bool,
    /// Also writes friction, hysteresis and area of every sample at every point, with what was drawn for it.
    #[arg(long, value_name = "SAMPLES.csv", requires = "samples", conflicts_with = "shard")]
    pub(crate) keep: Option<PathBuf>,
    /// Computes only share I of N of the points, I from 1 to N.
    #[arg(long, value_name = "I/N", value_parser = Shard::parse)]
    pub(crate) shard: Option<Shard>,
    /// Merges the tables of shards, and the one at --output if it is of the same sweep.
    #[arg(long, value_name = "TABLE.csv", num_args = 1.., group = "input", requires = "output")]
    #[arg(conflicts_with_all = OF_A_SCENE)]
    pub(crate) merge: Vec<PathBuf>,
    /// The table of an asperity converge of the scene: what it found goes into the header. Default: the scene's file
    /// name with .converge.csv, if there is such a file.
    #[arg(long, value_name = "STUDY.csv")]
    pub(crate) converged: Option<PathBuf>,
    /// Replaces an existing table instead of continuing it.
    #[arg(long)]
    pub(crate) force: bool,
    #[command(flatten)]
    pub(crate) set: Set,
}

impl Sweep {
    /// What is asked of the sweep.
    fn options(&self) -> SweepOptions {
        SweepOptions { gaps: self.gaps, ..self.options.clone() }
    }
}

/// Shares of a sweep.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Shard {
    /// Counted from 1.
    index: usize,
    count: usize,
}

impl Shard {
    /// `I/N`, I from 1 to N.
    fn parse(text: &str) -> Result<Self, String> {
        let parts = text.split_once('/').and_then(|(index, count)| Some((index.parse().ok()?, count.parse().ok()?)));
        match parts {
            Some((index, count)) if (1..=count).contains(&index) => Ok(Self { index, count }),
            _ => Err(format!("expected I/N with I from 1 to N, such as 3/8, found {text:?}")),
        }
    }

    /// Whether the point of this index is in it: every `count`th is, so that all shards have slow and quick points.
    fn has(self, index: usize) -> bool {
        index % self.count == self.index - 1
    }
}

/// Computes a table or merges several.
pub(crate) fn sweep(command: &Sweep) -> Result<(), Error> {
    if let Some(path) = &command.seal {
        return seal::sweep(&SealSweep {
            path,
            set: &command.set,
            output: command.output.as_ref(),
            plot: command.plot.as_ref(),
            force: command.force,
            speeds: command.options.speeds.as_ref(),
            temperatures: command.options.temperatures.as_ref(),
            options: &command.stribeck,
        });
    }
    match (&command.scene, &command.output) {
        (Some(scene), _) => compute(command, scene),
        (_, Some(output)) => merge(command, output),
        // clap requires a scene, or tables and an output.
        _ => Ok(()),
    }
}

/// Merges the tables of shards with the one of the same sweep at `output`, unless that is to be replaced.
fn merge(command: &Sweep, output: &PathBuf) -> Result<(), Error> {
    let picture = picture(command, output);
    let taken = command.merge.iter().chain(&command.data).cloned().collect();
    check_outputs([output].into_iter().chain(&picture), taken)?;
    let tables = command.merge.iter().map(|path| SweepTable::read(path)).collect::<Result<Vec<_>, _>>()?;
    let (header, first) = (&tables[0].header, command.merge[0].display());
    if let Some((path, table)) = command.merge.iter().zip(&tables).find(|(_, table)| table.header != *header) {
        let found = [header, &table.header].map(SweepHeader::fingerprint);
        let difference = if found[0] == found[1] {
            "they have different points".to_owned()
        } else {
            format!("fingerprint {} and {}", found[0], found[1])
        };
        return Err(Error::value(format!(
            "--merge: {first} and {} are of different sweeps: {difference}",
            path.display()
        )));
    }
    let (file, own) = TableFile::open(output, &header.table(), command.force, |table| rows(table, header))?;
    let of_table =
        |(path, table): (&PathBuf, SweepTable)| table.rows.into_iter().map(|row| (path.clone(), row)).collect();
    let header = header.clone();
    let all: Vec<Vec<(PathBuf, SweepRow)>> = command.merge.iter().zip(tables).map(of_table).collect();
    let all = all.into_iter().flatten().chain(own.into_iter().map(|row| (output.clone(), row)));
    let table = SweepTable::new(header.clone(), merged(&header, all.collect())?);
    file.finish(&table.table())?;
    let (found, total) = (table.rows.len(), header.grid.count());
    if found < total {
        let is_missing = |point: &OperatingPoint| table.rows.iter().all(|row| row.point != *point);
        let missing = header.grid.points().filter(is_missing).map(|point| point.describe(header.load));
        return Err(Error::value(format!(
            "{} of {total} points are missing: {}; {} has the others, and `asperity sweep` with this -o continues it",
            total - found,
            some_of(&missing.collect::<Vec<_>>()),
            output.display()
        )));
    }
    let maps = maps(command, &table.header, output)?;
    finish(output, &table, &Pictures { friction: picture.as_deref(), maps, master: None }, (&[], &[]))
}

/// The row of each point, which is the same in all tables that have it.
fn merged(header: &SweepHeader, all: Vec<(PathBuf, SweepRow)>) -> Result<Vec<SweepRow>, Error> {
    let mut found: Vec<Option<(PathBuf, SweepRow)>> = vec![None; header.grid.count()];
    for (path, row) in all {
        let Some(place) = header.grid.index(&row.point) else { continue };
        match &found[place] {
            Some((first, other)) if *other != row => {
                let (first, other, point) = (first.display(), path.display(), row.point.describe(header.load));
                return Err(Error::value(format!("--merge: {first} and {other} differ at {point}")));
            }
            Some(_) => (),
            None => found[place] = Some((path, row)),
        }
    }
    Ok(found.into_iter().flatten().map(|(_, row)| row).collect())
}

/// The rows of a table that was begun, which a sweep with this header goes on with.
fn rows(table: &Table, header: &SweepHeader) -> Result<Vec<Result<SweepRow, TableError>>, TableError> {
    let own = SweepHeader::of_table(table)?;
    let mut is_there = vec![false; own.grid.count()];
    let row = |row| {
        let found = SweepRow::of_table(table, row, &own)?;
        match own.grid.index(&found.point).map(|place| std::mem::replace(&mut is_there[place], true)) {
            Some(true) => Err(table.error_in(row, "the same point as in a row above")),
            _ => Ok(found),
        }
    };
    let rows: Vec<_> = (0..table.len()).map(row).collect();
    match rows.iter().flatten().find(|row| header.grid.index(&row.point).is_none()) {
        Some(row) => Err(table.error(format!(
            "has points that this sweep does not have, the first at {}: include their values",
            row.point.describe(header.load)
        ))),
        None => Ok(rows),
    }
}

fn compute(command: &Sweep, path: &Path) -> Result<(), Error> {
    let scene = load_without_run(path, &command.set, |scene| !command.options.sliding.solves(scene))?;
    let output = command
        .output
        .clone()
        .unwrap_or_else(|| default_output(path, if command.ways.is_some() { "ways.csv" } else { "sweep.csv" }));
    let picture = picture(command, &output);
    let study = study_file(command.converged.as_ref(), path);
    let taken = scene.sources(path).into_iter().chain(study.clone()).chain(command.data.clone()).collect();
    let beside = files_of_samples(command, &output);
    check_outputs([&output].into_iter().chain(&picture).chain(&command.master).chain(&beside), taken)?;
    let no_master =
        || Error::value("--master: the scene has no material.wlf, by whose factors speeds would be shifted");
    let master = match &command.master {
        Some(path) => Some((path.as_path(), wlf(&scene).ok_or_else(no_master)?)),
        None => None,
    };
    if let Some(ways) = &command.ways {
        return compute_ways(command, &scene, (&ways.0, &output, picture.as_deref()));
    }
    let convergence = study_verdict(study.as_deref(), &scene.name)?;
    let plan = plan(command, scene, convergence)?;
    plan.first_warnings().iter().for_each(|warning| warn(warning));
    let maps = maps(command, plan.header(), &output)?;
    let header = plan.header();
    let (file, done) = TableFile::open(&output, &header.table(), command.force, |table| rows(table, header))?;
    let table = SweepTable::new(header.clone(), run(command, &plan, (&file, done), &output)?);
    plan.warnings(&table.rows).iter().for_each(|warning| warn(warning));
    file.finish(&table.table())?;
    let said = write_samples(command, &plan, &table, &beside)?;
    finish(&output, &table, &Pictures { friction: picture.as_deref(), maps, master }, (&said, &beside))
}

/// Sweeps over several ways.
fn compute_ways(
    command: &Sweep,
    scene: &Scene,
    (ways, output, picture): (&[f64], &PathBuf, Option<&Path>),
) -> Result<(), Error> {
    if output.exists() && !command.force {
        return Err(Error::value(format!(
            "{}: is there, and a table over --ways is not continued: name another -o, or give --force to replace it",
            output.display()
        )));
    }
    let [total, failed] = sweep_ways(scene, &command.options(), ways, (output, picture))?;
    let files = [output.as_path()].into_iter().chain(picture).map(named).collect::<Vec<_>>().join(", ");
    print_beside([output], &lines(&[("Points", format!("{total}, at {} ways", ways.len())), ("Written", files)]))?;
    check_steady([total, failed], output)
}

/// Refuses a table with points that are not steady or failed.
fn check_steady([total, failed]: [usize; 2], output: &Path) -> Result<(), Error> {
    if failed == 0 {
        return Ok(());
    }
    let table = named(output);
    Err(Error::run(format!(
        "{failed} of {total} points are not steady or failed: the column status in {table} says why"
    )))
}

/// The table of the study named, or of the one that `asperity converge` has written for the scene; `None` without one.
fn study_file(named: Option<&PathBuf>, scene_file: &Path) -> Option<PathBuf> {
    let usual = default_output(scene_file, "converge.csv");
    named.cloned().or(Some(usual).filter(|usual| usual.exists()))
}

/// The verdict of the study at `path` on `scene`.
fn study_verdict(path: Option<&Path>, scene: &str) -> Result<Option<String>, Error> {
    let Some(path) = path else { return Ok(None) };
    verdict(&String::from_utf8_lossy(&read(path)?), path, scene).map(Some)
}

/// Computes the points that are not done yet, on all cores, and adds their rows to the file and to those that are.
fn run(
    command: &Sweep,
    plan: &SweepPlan,
    (file, done): (&TableFile, Vec<SweepRow>),
    output: &Path,
) -> Result<Vec<SweepRow>, Error> {
    let in_shard = |index: usize| command.shard.is_none_or(|shard| shard.has(index));
    let points = plan.header().grid.points().enumerate().filter(|(index, _)| in_shard(*index)).map(|(_, point)| point);
    let points: Vec<OperatingPoint> = points.collect();
    let is_done = |point: &OperatingPoint| done.iter().any(|row| row.point == *point);
    let left: Vec<OperatingPoint> = points.iter().filter(|point| !is_done(point)).copied().collect();
    let bar = terminal::bar(points.len() as u64);
    bar.set_position((points.len() - left.len()) as u64);
    bar.reset_eta();
    bar.set_message(format!("of {} points", points.len()));
    bar.enable_steady_tick(std::time::Duration::from_secs(1));
    let counted = bar.clone();
    let _farewell = Farewell::new(output, move || {
        let (points, all) = (counted.position(), counted.length().unwrap_or_default());
        counted.finish_and_clear();
        format!("{points} of {all} points are done")
    });
    let rows = Mutex::new(done);
    let work = plan.find(&left, &Stop::default(), |row| {
        if let Err(error) = file.add(&row.cells(plan.header())) {
            return ControlFlow::Break(error);
        }
        rows.lock().unwrap_or_else(PoisonError::into_inner).push(row);
        bar.inc(1);
        ControlFlow::Continue(())
    });
    bar.finish_and_clear();
    work.break_value().map_or_else(|| Ok(rows.into_inner().unwrap_or_else(PoisonError::into_inner)), Err)
}

/// The picture to draw; none of a shard.
fn picture(command: &Sweep, output: &Path) -> Option<PathBuf> {
    if command.shard.is_some() { None } else { picture_beside(output, command.plot.as_ref()) }
}

/// The maps that are asked for, if any are, of the table at `output`.
fn maps(command: &Sweep, header: &SweepHeader, output: &Path) -> Result<Option<Maps>, Error> {
    let Some(over) = command.over else { return Ok(None) };
    if picture(command, output).is_none() {
        return Err(Error::value(format!(
            "--over {over}: the table goes to {}, beside which no picture belongs: name one by --plot",
            named(output)
        )));
    }
    let data = command.data.as_deref().map(|data| (data, &command.columns.columns[..]));
    let maps = Maps::new(over, header, output, data)?;
    files::tell(&maps.notes);
    Ok(Some(maps))
}

/// What is drawn of a table.
struct Pictures<'a> {
    /// Friction over speed, ...
    friction: Option<&'a Path>,
    /// ... or, in its place, maps.
    maps: Option<Maps>,
    /// The master curve, with the compound's shift.
    master: Option<(&'a Path, Wlf)>,
}

/// Draws the pictures; prints friction and what lies at the low end; counts the points that are not steady.
fn finish(
    output: &PathBuf,
    table: &SweepTable,
    pictures: &Pictures<'_>,
    (said, beside): (&[LabelledLine], &[PathBuf]),
) -> Result<(), Error> {
    let Pictures { friction, maps, master } = pictures;
    friction.map_or(Ok(()), |path| match maps {
        Some(maps) => {
            let (picture, left_out) = maps.picture(table);
            left_out.iter().for_each(|text| warn(text));
            picture::write(&picture, path)
        }
        None => picture::write(&sweep_picture(table), path),
    })?;
    master.map_or(Ok(()), |(path, wlf)| picture::write(&master_picture(table, &wlf), path))?;
    let mut summary = printed::lines(table);
    summary.extend(table.header.keys.text_of("low_end").map(|low_end| ("Low end", low_end.to_owned())));
    summary.extend(maps.iter().filter_map(|_| Some(("No result", Maps::empty(table)?))));
    summary.extend_from_slice(said);
    let files = [output.as_path()].into_iter().chain(*friction).chain(master.map(|(path, _)| path));
    let files = files.chain(beside.iter().map(PathBuf::as_path)).map(named);
    summary.push(("Written", files.collect::<Vec<_>>().join(", ")));
    print_beside([output], &lines(&summary))?;
    check_steady([table.rows.len(), table.rows.iter().filter(|row| !row.is_result()).count()], output)
}

/// The shift of the compound with temperature.
fn wlf(scene: &Scene) -> Option<Wlf> {
    scene.material.as_ref().and_then(|material| material.wlf)
}

/// Sweeps a scene over `ways` (m), writes table and picture, and returns how many points there are, and have no result.
fn sweep_ways(
    scene: &Scene,
    options: &SweepOptions,
    ways: &[f64],
    (output, picture): (&Path, Option<&Path>),
) -> Result<[usize; 2], Error> {
    let plan = |&way: &f64| {
        let sliding = SlidingOptions { way: Some(way), ..options.sliding };
        SweepPlan::new(scene.clone(), &SweepOptions { sliding, ..options.clone() }, None)
    };
    let plans = ways.iter().map(plan).collect::<Result<Vec<_>, _>>()?;
    plans.iter().take(1).flat_map(SweepPlan::first_warnings).for_each(|warning| warn(warning));
    let bar = terminal::bar((plans.len() * plans.first().map_or(0, |plan| plan.header().grid.count())) as u64);
    let tables: Vec<SweepTable> = plans.iter().map(|plan| plan.table(&Stop::default(), || bar.inc(1))).collect();
    bar.finish_and_clear();
    for (plan, table) in plans.iter().zip(&tables) {
        plan.warnings(&table.rows).iter().for_each(|warning| warn(warning));
    }
    write(output, whole(ways, &tables).text())?;
    if let Some(path) = picture {
        picture::write(&over_ways(ways, &tables), path)?;
    }
    let rows = || tables.iter().flat_map(|table| &table.rows);
    Ok([rows().count(), rows().filter(|row| !row.is_result()).count()])
}

/// The rows of all ways as one table.
fn whole(ways: &[f64], tables: &[SweepTable]) -> Table {
    let own = tables.first().map(|table| table.header.table().columns().to_vec()).unwrap_or_default();
    let mut whole = Table::new(Header::default(), [Column::numbers("way", "m")].into_iter().chain(own));
    for (way, table) in ways.iter().zip(tables) {
        table.rows.iter().for_each(|row| whole.push([Cell::from(*way)].into_iter().chain(row.cells(&table.header))));
    }
    whole
}

/// The sweep of a scene, with samples where they are asked for.
fn plan(command: &Sweep, scene: Scene, convergence: Option<String>) -> Result<SweepPlan, Error> {
    let options = &command.options();
    let Some(count) = command.samples else { return SweepPlan::new(scene, options, convergence) };
    let uncertain = uncertain_scene(scene, command.refit, &Stop::default())?;
    if command.refit {
        note(&format!("the covariance's numbers are fitted anew in {count} samples"));
    }
    let samples = SampleOptions { count: count as usize, seed: command.seed };
    SweepPlan::with_samples(&uncertain, options, convergence, samples)
}

/// The files that are written beside the table: what matters, as a table and as a picture, and all samples. Of a shard none,
/// which has not all points.
fn files_of_samples(command: &Sweep, output: &Path) -> Vec<PathBuf> {
    if command.samples.is_none() || command.shard.is_some() {
        return Vec::new();
    }
    let beside = ["matters.csv", "matters.svg"].map(|extension| output.with_extension(extension));
    let beside = beside.into_iter().filter(|_| !is_stream(output));
    beside.chain(command.keep.clone()).collect()
}

/// Writes these [files](files_of_samples) and says what there is in the samples.
fn write_samples(
    command: &Sweep,
    plan: &SweepPlan,
    table: &SweepTable,
    files: &[PathBuf],
) -> Result<Vec<LabelledLine>, Error> {
    let Some(matters) = plan.matters(&table.rows).filter(|_| command.shard.is_none()) else { return Ok(Vec::new()) };
    for file in files {
        match file.extension().and_then(|extension| extension.to_str()) {
            _ if command.keep.as_ref() == Some(file) => write(file, plan.samples_table(&table.rows).text())?,
            Some("svg") => picture::write(&matters_picture(table, &matters), file)?,
            _ => write(file, matters.table(table.header.load).text())?,
        }
    }
    Ok(printed::samples(table, &matters))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shards_share_all_points() {
        let shards: Vec<Shard> = ["1/3", "2/3", "3/3"].map(|text| Shard::parse(text).unwrap()).into();
        assert!((0..10).all(|number| shards.iter().filter(|shard| shard.has(number)).count() == 1));
        assert!(["0/3", "4/3", "1", "a/2", "1/0"].iter().all(|text| Shard::parse(text).is_err()));
    }
}
