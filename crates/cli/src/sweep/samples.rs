//! The samples of a sweep: what is drawn, what is written and said of them.

use std::path::{Path, PathBuf};

use asperity::scene::Scene;
use asperity_study::Error;
use asperity_study::decimals::rounded;
use asperity_study::sweep::{Matters, Sampled, SweepPlan, SweepRow, SweepTable, matters_picture};
use asperity_study::uncertainty::{SampleOptions, UncertainScene};

use crate::cli::Sweep;
use crate::files::write as write_file;
use crate::output::is_stream;
use crate::picture;
use crate::terminal::{LabelledLine, labelled};

/// The sweep of a scene, with samples where they are asked for.
pub(super) fn plan(command: &Sweep, scene: Scene, convergence: Option<String>) -> Result<SweepPlan, Error> {
    let options = &command.options;
    let Some(count) = command.samples else { return SweepPlan::new(scene, options, convergence) };
    let uncertain = UncertainScene::new(scene)?;
    let samples = SampleOptions { count: count as usize, seed: command.seed };
    SweepPlan::with_samples(&uncertain, options, convergence, samples)
}

/// The files that are written beside the table: what matters, as a table and as a picture, and all samples. Of a shard none,
/// which has not all points.
pub(super) fn files(command: &Sweep, output: &Path) -> Vec<PathBuf> {
    if command.samples.is_none() || command.shard.is_some() {
        return Vec::new();
    }
    let beside = ["matters.csv", "matters.svg"].map(|extension| output.with_extension(extension));
    let beside = beside.into_iter().filter(|_| !is_stream(output));
    beside.chain(command.keep.clone()).collect()
}

/// Writes these [files] and says what there is in the samples.
pub(super) fn write(
    command: &Sweep,
    plan: &SweepPlan,
    table: &SweepTable,
    files: &[PathBuf],
) -> Result<Vec<LabelledLine>, Error> {
    let Some(matters) = plan.matters(&table.rows).filter(|_| command.shard.is_none()) else { return Ok(Vec::new()) };
    for file in files {
        match file.extension().and_then(|extension| extension.to_str()) {
            _ if command.keep.as_ref() == Some(file) => write_file(file, plan.samples_table(&table.rows).text())?,
            Some("svg") => picture::write(&matters_picture(table, &matters), file)?,
            _ => write_file(file, matters.table(table.header.load).text())?,
        }
    }
    let mut said = Vec::from_iter(table.header.samples.map(|samples| {
        let anew = if samples.redrawn == 0 { String::new() } else { format!(", {} drawn anew", samples.redrawn) };
        ("Samples", format!("{} of seed {}{anew}; friction's quantiles are in the table", samples.count, samples.seed))
    }));
    said.extend(widest(table));
    said.extend(lines(&matters));
    Ok(said)
}

/// The band of friction where it is widest over its median.
fn widest(table: &SweepTable) -> Option<LabelledLine> {
    let band = |row: &SweepRow| {
        let [low, median, high] = [0.05, 0.5, 0.95].map(|p| row.samples.as_ref()?.quantile(Sampled::Friction, p));
        let (low, median, high) = (low?, median?, high?);
        Some(((high - low) / median.max(f64::MIN_POSITIVE), [low, median, high], row.point))
    };
    let (_, [low, median, high], point) =
        table.rows.iter().filter_map(band).max_by(|one, other| one.0.total_cmp(&other.0))?;
    let [low, median, high] = [low, median, high].map(|friction| rounded(friction, 3));
    let at = point.describe(table.header.load);
    Some(("Widest", format!("{low} to {high} in 90 % of the samples, median {median}, at {at}")))
}

/// Letters of the longest bar.
const LONGEST: f64 = 30.0;

/// A line with a bar for each key and what is left.
fn lines(matters: &Matters) -> Vec<LabelledLine> {
    let Some(mean) = &matters.mean else {
        return vec![("Matters", "not known: more samples are needed than there are numbers to draw".to_owned())];
    };
    let largest = matters.largest();
    let width =
        largest.iter().map(|(name, _)| name.chars().count()).chain([matters.rest.len()]).max().unwrap_or_default();
    let bar = |share: f64| "\u{2588}".repeat((LONGEST * share.min(1.0)).round() as usize);
    let of_key = largest.iter().map(|(name, index)| {
        format!("{name:<width$}  {:>4.0} % ± {:<3.0} {}", 100.0 * index.share, 100.0 * index.error, bar(index.share))
    });
    let rest = format!("{:<width$}  {:>4.0} %       {}", matters.rest, 100.0 * mean.rest, bar(mean.rest));
    labelled("Matters", of_key.chain([rest]).map(|line| line.trim_end().to_owned()))
}
