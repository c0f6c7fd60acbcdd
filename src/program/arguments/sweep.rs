//! The command line of `asperity sweep`.

use std::path::PathBuf;

use clap::{ArgGroup, Args};

use super::{key_and_value, number, picture, positive};
use crate::program::sweep::{Shard, Values};

/// What says how a scene is swept: of no use where tables are joined.
const OF_A_SCENE: [&str; 8] = ["speeds", "pressures", "forces", "temperatures", "distance", "shard", "force", "set"];

#[derive(Debug, Args)]
#[command(group(ArgGroup::new("subject").required(true)))]
pub(crate) struct Sweep {
    /// The scene file; its excitation and outputs do not matter.
    #[arg(value_name = "SCENE.toml", group = "subject")]
    pub(crate) scene: Option<PathBuf>,
    /// Speeds, m/s: a..b/n for n values evenly in the logarithm, a list, or both joined by commas.
    #[arg(long, value_name = "VALUES", value_parser = Values::in_logarithm, required_unless_present = "merge")]
    pub(crate) speeds: Option<Values>,
    /// Mean pressures, Pa, given as the speeds are; in the material form.
    #[arg(long, value_name = "VALUES", value_parser = Values::in_logarithm, conflicts_with = "forces")]
    pub(crate) pressures: Option<Values>,
    /// Mean F_z of the whole layer, N, in place of pressures; in either form.
    #[arg(long, value_name = "VALUES", value_parser = Values::in_logarithm)]
    pub(crate) forces: Option<Values>,
    /// Temperatures, K: a..b/n for n values evenly; default: the scene's own.
    #[arg(long, value_name = "VALUES", value_parser = Values::in_value)]
    pub(crate) temperatures: Option<Values>,
    /// The table to write, and to go on with where it is there; default: the scene's file name with .sweep.csv.
    #[arg(short, long, value_name = "TABLE.csv")]
    pub(crate) output: Option<PathBuf>,
    /// The picture to draw, SVG or PNG by its name; default: the table's name with .svg.
    #[arg(long, value_name = "OUT.svg", value_parser = picture())]
    pub(crate) plot: Option<PathBuf>,
    /// The standard error that the friction coefficient may have, as a share of it.
    #[arg(long, value_name = "SHARE", default_value_t = 5e-3, value_parser = share)]
    pub(crate) error: f64,
    /// How far a point may be slid until its means are steady, m; default: 100 blocks, periods of the profile or
    /// lengths of the layer.
    #[arg(long, value_name = "METRES", value_parser = positive, allow_negative_numbers = true)]
    pub(crate) distance: Option<f64>,
    /// Does one share of the points alone, I from 1 to N.
    #[arg(long, value_name = "I/N", value_parser = Shard::parse)]
    pub(crate) shard: Option<Shard>,
    /// Joins tables, of shards, into one.
    #[arg(long, value_name = "TABLE.csv", num_args = 1.., group = "subject", requires = "output")]
    #[arg(conflicts_with_all = OF_A_SCENE)]
    pub(crate) merge: Vec<PathBuf>,
    /// Replaces the table that is there.
    #[arg(long)]
    pub(crate) force: bool,
    /// Overrides a parameter by its name, such as friction.coulomb=0.5.
    #[arg(long, value_name = "KEY=VALUE", value_parser = key_and_value)]
    pub(crate) set: Vec<(String, String)>,
}

fn share(text: &str) -> Result<f64, String> {
    number(text, |share| *share > 0.0 && *share <= 1.0, "a share above 0, up to 1, such as 5e-3")
}
