//! `asperity compare`: the curves of a sweep beside measured friction.

use std::path::{Path, PathBuf};

use asperity_study::Error;
use asperity_study::calibration::chi_square_per_degree;
use asperity_study::comparison::{CompareOptions, Comparison, off_in_words};
use asperity_study::decimals::rounded;
use asperity_study::sweep::SweepTable;
use clap::Args;

use super::cli::values::{self, example};
use super::files::{self, check_outputs, name_of, named, print_beside};
use super::picture;
use super::terminal::{labelled, lines, warn};

#[derive(Debug, Args)]
#[command(after_help = example!("asperity compare friction.csv --data docs/guide/measured.csv"))]
pub(crate) struct Compare {
    /// The table of asperity sweep, over pressures.
    #[arg(value_name = "TABLE.csv")]
    pub(crate) table: PathBuf,
    #[command(flatten)]
    pub(crate) options: CompareOptions,
    /// The plot to write, as SVG or PNG according to the file name. Default: the table's name with .compare.svg.
    #[arg(short, long, value_name = "OUT.svg", value_parser = values::picture())]
    pub(crate) output: Option<PathBuf>,
}

/// Measurements that are off the most are named up to this many.
const WORST: usize = 5;

/// Draws the curves and the points, and says how far these are off.
pub(crate) fn compare(command: &Compare) -> Result<(), Error> {
    let path = command.output.clone().unwrap_or_else(|| command.table.with_extension("compare.svg"));
    check_outputs([&path], vec![command.table.clone(), command.options.data.clone()])?;
    let table = SweepTable::read(&command.table)?;
    let comparison = Comparison::new(&table, &command.table, &command.options)?;
    files::tell(&comparison.notes);
    comparison.left_out_in_words().iter().for_each(|text| warn(text));
    comparison.check(&command.options.data)?;
    picture::write(&comparison.picture(table.header.scene()), &path)?;
    print_beside([&path], &summary(command, &comparison, &path))
}

fn summary(command: &Compare, comparison: &Comparison, picture: &Path) -> String {
    let (within, chi_square) = (&comparison.within, comparison.chi_square());
    let assumed = within.iter().any(|(row, _)| row.sigma.is_none());
    let note = if assumed { ", standard deviations assumed: 5 % and 0.01" } else { "" };
    let per_measurement = rounded(chi_square_per_degree(chi_square, within.len()), 4);
    let mut rows = vec![
        ("Table", name_of(&command.table)),
        ("Data", format!("{}: {} measurements{note}", name_of(&command.options.data), within.len())),
        ("Chi square", format!("{}, {per_measurement} per measurement", rounded(chi_square, 4))),
    ];
    let worst = comparison.worst_first();
    let worst = worst.iter().take(WORST).map(|(row, friction, deviations)| off_in_words(row, *friction, *deviations));
    rows.extend(labelled("Worst", worst));
    rows.push(("Written", named(picture)));
    lines(&rows)
}
