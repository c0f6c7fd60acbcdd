//! `asperity report`: what the runs of scenes cost and how accurate they are, as tables, pictures and a summary.

use std::path::{Path, PathBuf};

use asperity::scene::Scene;
use asperity::table::Table;
use asperity_study::benchmark::{
    Benchmark, CommunicationRow, Errors, Judgement, MasterInputs, Peers, QUANTITIES, Ratios, Reference, RunFigures,
    Stress, ToleranceRow, Trial, WINDOWS, communication_picture, communication_table, errors_table, judgement_picture,
    judgements_table, read_peers, stress_picture, stress_table, tolerance_picture,
};
use asperity_study::decimals::short;
use asperity_study::picture::{Picture, power_of_ten};
use asperity_study::robustness::{DISPLACEMENT, KEPT, ScaledQuantity, Verdict};
use asperity_study::{Context as _, Error};

use super::cli::Report;
use super::files::{check_output, load, print, write};
use super::picture;
use super::terminal::{Bars, LabelledLine, labelled, lines, warn};

/// The tables and the pictures, without their endings.
const ERRORS: &str = "error-run-time";
const JUDGEMENTS: &str = "tolerance-estimate";
const COMMUNICATION: &str = "error-communication-step";
const STRESS: &str = "stress";

/// Runs the scenes in every way and writes the results: of one scene into the folder, of several into folders within
/// it, with what is judged of all of them.
pub(crate) fn report(command: &Report) -> Result<(), Error> {
    let [path] = command.scenes.as_slice() else { return report_all(command) };
    Task::new(command, path, &command.output)?.run().map(drop)
}

fn report_all(command: &Report) -> Result<(), Error> {
    let names: Vec<String> = command.scenes.iter().map(|scene| stem(scene)).collect();
    let tasks = command.scenes.iter().zip(&names).enumerate().map(|(i, (scene, name))| {
        let folder = command.output.join(name);
        if names[..i].contains(name) {
            return Err(Error::value(format!("two scenes have the same folder: {}", folder.display())));
        }
        Task::new(command, scene, &folder)
    });
    let tasks = tasks.collect::<Result<Vec<_>, _>>()?;
    let taken: Vec<PathBuf> = tasks.iter().flat_map(Task::sources).collect();
    let folder = Folder::new(&command.output, &taken)?;
    let judgements = tasks.iter().map(Task::run).collect::<Result<Vec<_>, _>>()?;
    let scenes = names.iter().zip(&judgements).map(|(name, runs)| (name.as_str(), runs.as_slice()));
    let picture = judgement_picture(judgements.iter().flatten());
    folder.write(JUDGEMENTS, &judgements_table(scenes), &picture)?;
    let mut rows = vec![("All scenes", names.join(", "))];
    rows.extend(judged(judgements.iter().flatten()));
    rows.push(("Written", folder.0.join(JUDGEMENTS).with_extension("csv").display().to_string()));
    print(&lines(&rows))
}

/// The name of a file without folder and ending.
fn stem(path: &Path) -> String {
    path.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}

/// A folder that tables and pictures are written to.
#[derive(Debug)]
struct Folder(PathBuf);

impl Folder {
    /// Checks that no file written takes the place of one of `taken`.
    fn new(path: &Path, taken: &[PathBuf]) -> Result<Self, Error> {
        let files = [ERRORS, JUDGEMENTS, COMMUNICATION, STRESS].map(|name| path.join(name));
        let mut files = files.iter().flat_map(|file| ["csv", "svg", "png"].map(|ending| file.with_extension(ending)));
        files.try_for_each(|file| check_output(&file, taken))?;
        Ok(Self(path.to_owned()))
    }

    /// Writes a table and a picture, as SVG and as PNG, into the folder, which is created if it does not exist.
    fn write(&self, name: &str, table: &Table, drawn: &Picture) -> Result<(), Error> {
        std::fs::create_dir_all(&self.0).map_err(Error::io("create", &self.0))?;
        let file = self.0.join(name);
        write(&file.with_extension("csv"), table.text())?;
        ["svg", "png"].iter().try_for_each(|ending| picture::write(drawn, &file.with_extension(ending)))
    }
}

/// A scene that can be run, its folder and its peers.
#[derive(Debug)]
struct Task<'a> {
    command: &'a Report,
    path: &'a Path,
    scene: Scene,
    folder: Folder,
    peers: Peers,
}

impl<'a> Task<'a> {
    /// Reads what is needed and checks it, before anything is run or written.
    fn new(command: &'a Report, path: &'a Path, folder: &Path) -> Result<Self, Error> {
        let scene = load(path, &command.set)?;
        Benchmark::check(&scene, &command.options).context(path.display())?;
        let taken: Vec<PathBuf> = scene.sources(path).into_iter().chain(command.peers.clone()).collect();
        let folder = Folder::new(folder, &taken)?;
        let peers = peers_of(command, path, &scene)?;
        Ok(Self { command, path, scene, folder, peers })
    }

    /// The files that are read.
    fn sources(&self) -> Vec<PathBuf> {
        self.scene.sources(self.path).into_iter().chain(self.command.peers.clone()).collect()
    }

    /// Runs the scene, writes its tables and pictures, and says what they show. Returns how its runs keep what they promise.
    fn run(&self) -> Result<Vec<Judgement>, Error> {
        let results = Benchmark::run(&self.scene, &self.command.options, &Bars::new().watch());
        let results = results.context(self.path.display())?;
        results.reference.warnings.iter().for_each(|warning| warn(warning));
        let Benchmark { reference, tolerances, communication, stress, judgements } = &results;
        let (folder, name) = (&self.folder, self.scene.name.as_str());
        let picture = tolerance_picture(reference, tolerances, &self.peers.runs);
        folder.write(ERRORS, &errors_table(name, reference, tolerances), &picture)?;
        let table = judgements_table([(name, judgements.as_slice())]);
        folder.write(JUDGEMENTS, &table, &judgement_picture(judgements.iter()))?;
        let picture = communication_picture(reference, communication);
        folder.write(COMMUNICATION, &communication_table(name, reference, communication), &picture)?;
        if let Some(stress) = stress {
            folder.write(STRESS, &stress_table(name, stress), &stress_picture(stress))?;
        }
        print(&lines(&self.summary(&results)))?;
        Ok(results.judgements)
    }

    fn summary(&self, results: &Benchmark) -> Vec<LabelledLine> {
        let mut rows = vec![("Scene", self.scene.name.clone())];
        rows.extend(labelled("Reference", reference_lines(&results.reference)));
        rows.extend(labelled("Quickest", quickest(&results.tolerances)));
        if cfg!(debug_assertions) {
            rows.push(("", "this program was built without optimisation (no --release): run times mean little".into()));
        }
        rows.extend(judged(results.judgements.iter()));
        rows.extend(labelled("Master", by_steps(&results.communication)));
        if let Some(stress) = &results.stress {
            let ranges = stress.quantities().into_iter().map(|quantity| range(stress, quantity));
            rows.extend(labelled("Stress", ranges));
        }
        let names = [ERRORS, JUDGEMENTS, COMMUNICATION].into_iter().chain(results.stress.is_some().then_some(STRESS));
        let written = names.collect::<Vec<_>>().join(", ");
        rows.push(("Written", format!("{}: {written}, each as .csv, .svg and .png", self.folder.0.display())));
        rows
    }
}

/// The peers' runs of this scene; warns where the file has none.
fn peers_of(command: &Report, scene_path: &Path, scene: &Scene) -> Result<Peers, Error> {
    let Some(path) = &command.peers else { return Ok(Peers::default()) };
    let peers = read_peers(path, &[&scene.name, &stem(scene_path)])?;
    if peers.runs.is_empty() {
        let there = peers.scenes.join(", ");
        warn(&format!("{}: no lines of the scene {}; there are {there}", path.display(), scene.name));
    }
    Ok(peers)
}

fn reference_lines(reference: &Reference) -> [String; 2] {
    let reduced = if reference.scene.solver.reduce > 0.0 { ", with all Maxwell elements" } else { "" };
    let own = match reference.check {
        Some(check) => format!("from a run at {check:e} it differs by {}", in_words(&reference.own)),
        None => "no other run came to its end, so its own error is not known".into(),
    };
    let found = &reference.sensitivity;
    let moved = format!("a start moved by {DISPLACEMENT:e} m changes {}", in_words(&found.differences));
    let comparison = if reference.comparison.is_of_means() {
        format!(
            "the motion is sensitive: {moved}, more than {:.0e}; compared are means over {WINDOWS} windows of each phase",
            found.limit
        )
    } else {
        format!("{moved}: runs are compared row by row, over the largest value")
    };
    [format!("method event, tolerance {:e}{reduced}; {own}", reference.tolerance), comparison]
}

/// "2e-8 (F_x), 1e-9 (F_z)".
fn in_words(errors: &Errors) -> String {
    let named = QUANTITIES.iter().zip(errors).filter_map(|(name, error)| Some(format!("{:.0e} ({name})", (*error)?)));
    let named: Vec<String> = named.collect();
    if named.is_empty() { "nothing".into() } else { named.join(", ") }
}

/// For each error that a user may settle for the quickest run that keeps all errors within it.
fn quickest(rows: &[ToleranceRow]) -> impl Iterator<Item = String> {
    const BOUNDS: [f64; 6] = [1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6];
    let within = move |bound: f64| {
        let runs = rows.iter().filter_map(|row| Some((row, row.result.as_ref().ok()?)));
        let good = runs.filter(|(_, figures)| figures.error().is_some_and(|error| error <= bound));
        good.filter_map(|(row, figures)| Some((row, figures, figures.time()?))).min_by(|a, b| a.2.total_cmp(&b.2))
    };
    BOUNDS.into_iter().map(move |bound| match within(bound) {
        Some((row, figures, time)) => {
            let found = setting(row, figures);
            format!("all errors at most {bound:e}: {found}, {} s", short(time, 3))
        }
        None => format!("all errors at most {bound:e}: no run"),
    })
}

fn setting(row: &ToleranceRow, figures: &RunFigures) -> String {
    let error = figures.error().unwrap_or_default();
    format!("{} at {:e}, error {error:.1e}, {} steps", row.method, row.tolerance, figures.counts.steps)
}

/// For each method how its errors are to the tolerances asked for, and its estimates to the errors.
fn judged<'a>(runs: impl Iterator<Item = &'a Judgement>) -> Vec<LabelledLine> {
    let line = |(name, runs): (String, Vec<&Judgement>)| {
        let left_out = runs.iter().filter(|run| !run.counts()).count();
        let left_out = if left_out > 0 { format!(", {left_out} left out") } else { String::new() };
        let ratios =
            [("error over it", Ratios::from_errors(&runs)), ("estimate over error", Ratios::from_estimates(&runs))];
        let ratios = ratios.map(|(of, ratios)| format!("{of} {}", ratios.map_or_else(|| "unknown".into(), ratio)));
        format!("{name}: {} runs{left_out}; {}", runs.len(), ratios.join("; "))
    };
    labelled("Tolerance", Judgement::groups(runs).into_iter().map(line))
}

fn ratio(Ratios { median, within, worst, of }: Ratios<'_>) -> String {
    let [median, worst] = [median, worst].map(|ratio| short(ratio, 2));
    let of = match of.scaled {
        Some((quantity, power)) => format!("{} times {}", quantity.name(), power_of_ten(power)),
        None => format!("{:e}", of.tolerance),
    };
    format!("{median} in the median, {:.0} % within {KEPT} times, worst {worst} ({of})", 100.0 * within)
}

/// For each that a master may give the errors at the longest and the shortest communication step.
fn by_steps(rows: &[CommunicationRow]) -> Vec<String> {
    let error = |row: &CommunicationRow| match &row.result {
        Ok((figures, _)) => figures.error().map_or_else(|| "no error".into(), |error| format!("error {error:.1e}")),
        Err(failure) => failure.to_string(),
    };
    let at = |row: &CommunicationRow| match row.step {
        Some(step) => format!("{} at {step:.1e} s", error(row)),
        None => error(row),
    };
    let all = [MasterInputs::Rates, MasterInputs::Values, MasterInputs::None].into_iter().filter_map(|given| {
        let runs: Vec<&CommunicationRow> = rows.iter().filter(|row| row.given == given).collect();
        let ends: Vec<String> = match runs.as_slice() {
            [] => return None,
            [only] => vec![at(only)],
            [first, .., last] => vec![at(first), at(last)],
        };
        Some(format!("{}: {}", given.name(), ends.join(", ")))
    });
    all.collect()
}

/// How far a quantity can be scaled until an error is more than [`KEPT`] tolerances, and what becomes of the nearest run on
/// each side that is wrong or does not come to its end.
fn range(stress: &Stress, quantity: ScaledQuantity) -> String {
    let runs = stress.of(quantity);
    let (below, above) = runs.split_at(runs.partition_point(|(power, _)| *power < 0));
    let is_kept = |(_, trial): &&(i32, &Trial)| stress.verdict(trial) == Verdict::Kept;
    let is_bad = |(_, trial): &&(i32, &Trial)| {
        matches!(stress.verdict(trial), Verdict::Stopped | Verdict::OverBudget | Verdict::Wrong)
    };
    let kept = match above.iter().take_while(is_kept).last() {
        Some((high, _)) => {
            let low = below.iter().rev().take_while(is_kept).last().map_or(0, |(power, _)| *power);
            format!("kept from {} to {} times", power_of_ten(low), power_of_ten(*high))
        }
        None => "not kept as it is".into(),
    };
    let bad = [below.iter().rev().find(is_bad), above.iter().find(is_bad)].into_iter().flatten();
    let bad = bad.map(|(power, trial)| format!("; {} times: {}", power_of_ten(*power), stress.reason(trial)));
    format!("{}: {kept}{}", quantity.name(), bad.collect::<String>())
}
