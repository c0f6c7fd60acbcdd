//! What is computed: a sweep of each scene as it stands, and of each of its samples.

use std::path::{Path, PathBuf};

use asperity::element::{Load, OperatingPoint, Quantity};
use asperity::scene::Scene;
use clap::Args;
use serde::{Deserialize, Serialize};

use super::ranking::{Frictions, Mean, Ranking};
use super::weights::Weights;
use crate::Error;
use crate::calibration::uncertain_scene;
use crate::files::{ColumnOptions, name_of};
use crate::progress::{Stop, Stopped};
use crate::sweep::{Problems, SweepOptions, SweepPlan, SweepTable};
use crate::uncertainty::{Drawn, Refused, SampleOptions, Sampler, UncertainScene, Uncertainty, covariance_file};
use crate::values::count;

/// Friction of a scene at all points, or why it cannot be swept.
type Found = Result<Vec<Option<f64>>, Error>;

// At which points scenes are ranked, and by what. Not a doc comment: that would be the description of the command.
#[expect(missing_docs, reason = "clap would print it")]
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Args)]
pub struct RankOptions {
    #[command(flatten)]
    #[serde(flatten)]
    pub sweep: SweepOptions,
    /// The weights of the points in the mean: a table with a column weight and those of speed, pressure and temperature that it
    /// depends on. Default: all the same.
    #[arg(long, value_name = "WEIGHTS.csv")]
    pub weights: Option<PathBuf>,
    /// Number of samples of what is not known of the scenes, uncertainty, drawn with common numbers.
    #[arg(long, value_name = "N", default_value_t = 128, value_parser = count)]
    pub samples: u32,
    /// The seed of the samples.
    #[arg(long, value_name = "SEED", default_value_t = 1)]
    pub seed: u64,
    /// Fits the numbers of a scene's covariance anew in each sample, by the measurements that are stored with it: for what
    /// else varies beside it (surface, seed, series), as asperity sweep --samples --refit does.
    #[arg(long)]
    #[serde(default)]
    pub refit: bool,
    /// The mean over the points.
    #[arg(long, value_name = "MEAN", value_enum, default_value_t)]
    #[serde(default)]
    pub mean: Mean,
    /// Measured friction, as for asperity calibrate, with a column scene of the scenes' names or file names: it is compared
    /// beside, and the order by Kendall's rank correlation.
    #[arg(long, value_name = "MEASURED.csv")]
    pub data: Option<PathBuf>,
    #[command(flatten)]
    #[serde(flatten)]
    pub columns: ColumnOptions,
}

/// A scene to rank.
#[derive(Clone, Debug)]
pub struct RankScene {
    /// As it was read.
    pub scene: Scene,
    /// Its file.
    pub file: PathBuf,
}

/// Scenes to be ranked, nothing of it computed yet.
#[derive(Debug)]
pub struct RankPlan {
    entries: Vec<Entry>,
    options: SweepOptions,
    weights: Weights,
    mean: Mean,
    sampler: Option<Sampler>,
    /// Why samples have no result.
    problems: Problems,
}

#[derive(Debug)]
struct Entry {
    label: String,
    file: PathBuf,
    plan: SweepPlan,
    uncertain: Option<UncertainScene>,
}

/// The ranking, and the tables of the scenes as they stand, in the order that they were given in.
#[derive(Clone, Debug)]
pub struct RankFound {
    /// The ranking.
    pub ranking: Ranking,
    /// The tables.
    pub tables: Vec<SweepTable>,
}

impl RankPlan {
    /// The ranking of `scenes` at the points of the `options`, by so many samples of what is not known of them; `stop` ends
    /// the fits of these.
    ///
    /// # Errors
    /// Where a scene does not go with the options, or with the others, or the weights cannot be read.
    pub fn new(scenes: Vec<RankScene>, options: &RankOptions, stop: &Stop) -> Result<Self, Error> {
        if scenes.len() < 2 {
            return Err(Error::value(format!("expected at least 2 scenes to rank, found {}", scenes.len())));
        }
        let labels = labels(&scenes);
        let samples = SampleOptions { count: options.samples as usize, seed: options.seed };
        let weights = options.weights.as_deref().map(Weights::read).transpose()?.unwrap_or_default();
        let RankOptions { mean, refit, .. } = *options;
        if refit && scenes.iter().all(|scene| covariance_file(&scene.scene).is_none()) {
            return Err(Error::scene(
                "`refit`: expected covariance = \"...\" in [uncertainty] of one of the scenes at least",
            ));
        }
        let options = options.sweep.clone();
        if options.temperatures.is_none() {
            check_temperatures(&scenes, &labels)?;
        }
        let entry = |(scene, label): (RankScene, String)| -> Result<Entry, Error> {
            let RankScene { scene, file } = scene;
            let refused = |error: Error| error.context(&label);
            let plan = SweepPlan::new(scene.clone(), &options, None).map_err(refused)?;
            let is_known = Uncertainty::of(&scene)?.0.is_empty();
            let refit = refit && covariance_file(&scene).is_some();
            let uncertain = (!is_known).then(|| uncertain_scene(scene, refit, stop)).transpose()?;
            Ok(Entry { label, file, plan, uncertain })
        };
        let entries = scenes.into_iter().zip(labels).map(entry).collect::<Result<Vec<_>, _>>()?;
        let uncertain = || entries.iter().filter_map(|entry| entry.uncertain.as_ref());
        let axes = uncertain().flat_map(UncertainScene::axes).collect();
        let sampler = uncertain().next().is_some().then(|| Sampler::new(axes, samples)).transpose()?;
        Ok(Self { entries, options, weights, mean, sampler, problems: Problems::default() })
    }

    /// The mean over the points.
    pub fn mean(&self) -> Mean {
        self.mean
    }

    /// The scenes' names, in the order that they were given in.
    pub fn labels(&self) -> Vec<String> {
        self.entries.iter().map(|entry| entry.label.clone()).collect()
    }

    /// The files of the scenes.
    pub fn files(&self) -> Vec<&Path> {
        self.entries.iter().map(|entry| entry.file.as_path()).collect()
    }

    /// The scenes of which everything is known, where others are not.
    pub fn known(&self) -> Vec<&str> {
        self.entries.iter().filter(|entry| entry.uncertain.is_none()).map(|entry| entry.label.as_str()).collect()
    }

    /// Whether samples are drawn.
    pub fn has_samples(&self) -> bool {
        self.sampler.is_some()
    }

    /// What to look at before anything is computed.
    pub fn warnings(&self) -> Vec<String> {
        let of = |entry: &Entry| {
            let named = |warning: &String| format!("{}: {warning}", entry.label);
            let twice = entry.uncertain.as_ref().and_then(UncertainScene::counted_twice);
            entry.plan.first_warnings().iter().chain(&twice).map(named).collect::<Vec<_>>()
        };
        self.entries.iter().flat_map(of).collect()
    }

    /// The points, which are the same of all scenes.
    pub fn points(&self) -> Vec<OperatingPoint> {
        self.entries.first().map(|entry| entry.plan.header().grid.points().collect()).unwrap_or_default()
    }

    /// What presses; a force where one of the scenes has no area.
    pub fn load(&self) -> Load {
        self.entries.first().map_or(Load::Force, |entry| entry.plan.header().load)
    }

    /// How many sweeps are made.
    pub fn sweeps(&self) -> usize {
        let samples = self.sampler.as_ref().map_or(0, |sampler| sampler.options().count);
        self.entries.len() + samples * self.entries.iter().filter(|entry| entry.uncertain.is_some()).count()
    }

    /// Makes the sweeps, telling `done` after each, and ranks the scenes.
    ///
    /// # Errors
    /// Where it is stopped, there is nothing to rank by, or more than one of ten draws is no scene.
    pub fn find(&self, stop: &Stop, done: &(dyn Fn() + Sync)) -> Result<RankFound, Error> {
        let points = self.points();
        let weights = self.weights.of(&points, self.load())?;
        let mut tables = Vec::new();
        for entry in &self.entries {
            tables.push(swept(&entry.plan, stop)?);
            done();
        }
        let own: Frictions = tables.iter().map(frictions).collect();
        let (samples, redrawn) = self.samples(&own, stop, done)?;
        let weighted: Vec<(OperatingPoint, f64)> = points.into_iter().zip(weights).collect();
        let ranking = Ranking::new(self.labels(), (self.load(), &weighted, self.mean), &own, &samples)?;
        Ok(RankFound { ranking: Ranking { redrawn, problems: self.problems.in_words(), ..ranking }, tables })
    }

    /// Friction of all samples of all scenes, those of which everything is known as they stand.
    fn samples(
        &self,
        own: &Frictions,
        stop: &Stop,
        done: &(dyn Fn() + Sync),
    ) -> Result<(Vec<Frictions>, usize), Error> {
        let Some(sampler) = &self.sampler else { return Ok((Vec::new(), 0)) };
        let uncertain: Vec<&UncertainScene> =
            self.entries.iter().filter_map(|entry| entry.uncertain.as_ref()).collect();
        let draws = UncertainScene::draw_together(&uncertain, sampler, |drawn| {
            let of_one = |(drawn, scene): (Drawn, &&UncertainScene)| {
                let found = self.sample(scene, drawn.scene, stop);
                done();
                found
            };
            drawn.into_iter().zip(&uncertain).map(of_one).collect::<Result<Vec<_>, _>>()
        });
        stopped(stop)?;
        let draws = draws?;
        let whole = |(sample, drawn): (usize, Vec<Found>)| {
            let failed = |error: Error| error.context(format!("sample {}", sample + 1));
            let drawn = drawn.into_iter().collect::<Result<Frictions, _>>().map_err(failed)?;
            let mut drawn = drawn.into_iter();
            let of = |(entry, own): (&Entry, &Vec<Option<f64>>)| match entry.uncertain {
                Some(_) => drawn.next().unwrap_or_default(),
                None => own.clone(),
            };
            Ok(self.entries.iter().zip(own).map(of).collect())
        };
        let samples = draws.made.into_iter().enumerate().map(whole).collect::<Result<_, Error>>()?;
        Ok((samples, draws.redrawn))
    }

    /// Friction of a scene that was `drawn` about another one; refused where it has not the temperatures of the points.
    fn sample(&self, scene: &UncertainScene, drawn: Scene, stop: &Stop) -> Result<Found, Refused> {
        let shift = scene.warmer(&drawn);
        // How far off the temperature of the scene may be that of each point may be, too.
        let mut options = self.options.clone();
        for kelvin in options.temperatures.iter_mut().flat_map(|values| &mut values.0) {
            *kelvin += shift;
            drawn.with_temperature(*kelvin).check()?;
        }
        Ok(SweepPlan::new(drawn, &options, None).map(|plan| {
            // Where it is stopped nobody wants the ranking.
            let nothing = |_| vec![None; plan.header().grid.count()];
            let table = swept(&plan, stop);
            table.iter().flat_map(|table| &table.rows).for_each(|row| self.problems.count(row));
            table.map(|table| frictions(&table)).unwrap_or_else(nothing)
        }))
    }
}

fn stopped(stop: &Stop) -> Result<(), Stopped> {
    if stop.go_on().is_break() { Err(Stopped) } else { Ok(()) }
}

/// All points of a plan.
fn swept(plan: &SweepPlan, stop: &Stop) -> Result<SweepTable, Stopped> {
    let table = plan.table(stop, || ());
    stopped(stop).map(|()| table)
}

/// Friction of a whole table, in the order of the points.
fn frictions(table: &SweepTable) -> Vec<Option<f64>> {
    table.rows.iter().map(|row| row.value(Quantity::Friction).filter(|_| row.is_result())).collect()
}

/// Names of the scenes, each another one: their own, else those of their files, else these with their folders.
fn labels(scenes: &[RankScene]) -> Vec<String> {
    let names: [fn(&RankScene) -> String; 3] =
        [|scene| scene.scene.name.clone(), |scene| name_of(&scene.file), |scene| scene.file.display().to_string()];
    let all = names.map(|name| scenes.iter().map(name).collect::<Vec<String>>());
    let differ = |names: &&Vec<String>| (0..names.len()).all(|i| !names[..i].contains(&names[i]));
    let numbered = || all[0].iter().zip(1..).map(|(name, number): (_, usize)| format!("{name} ({number})")).collect();
    all.iter().find(differ).cloned().unwrap_or_else(numbered)
}

/// Scenes that are compared at their own temperatures must have the same.
fn check_temperatures(scenes: &[RankScene], labels: &[String]) -> Result<(), Error> {
    let own: Vec<Option<f64>> = scenes.iter().map(|scene| scene.scene.temperature()).collect();
    if own.windows(2).all(|pair| pair[0] == pair[1]) {
        return Ok(());
    }
    let named = |(label, own): (&String, &Option<f64>)| {
        format!("{label} {}", own.map_or_else(|| "none".to_owned(), |kelvin| format!("{kelvin} K")))
    };
    let named = labels.iter().zip(&own).map(named).collect::<Vec<_>>().join(", ");
    let problem = "the scenes have other temperatures of their own";
    Err(Error::scene(format!("{problem}: {named}; expected `temperatures`, at which all are compared")))
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::csv::Csv;
    use crate::files::parse_scene;
    use crate::rank::{Pair, measured_ranking, table};
    use crate::values::Values;

    /// An elastic sine on which all friction is a shear strength over a constant real area, and a coefficient.
    fn scene(name: &str, strength: f64, uncertain: &str) -> RankScene {
        let text = format!(
            "name = '{name}'\nlayer = {{ foundation = 'half_space', masses = 16, spacing = 6.25e-5, width = 1e-2 }}\n\
             material = {{ density = 1e3, poisson_ratio = 0.5, equilibrium_modulus = 3e6, prony = [] }}\n\
             [surface]\nkind = 'sinusoid'\namplitude = 1e-5\nwavelength = 1e-3\npoints_per_wavelength = 64\n\
             fine = {{ rms_slope = 1.0, modulus = 4e7 }}\n[friction]\nshear_strength = {strength}\n{uncertain}"
        );
        let file = std::path::PathBuf::from(format!("{name}.toml"));
        let scene = parse_scene(&text, &file, &[]).unwrap_or_else(|error| panic!("{error}"));
        RankScene { scene, file }
    }

    const TEN_PER_CENT: &str = "[uncertainty]\n'friction.shear_strength' = { relative = 0.1 }\n";

    fn of(sweep: SweepOptions) -> RankOptions {
        RankOptions {
            sweep,
            weights: None,
            samples: 64,
            seed: 1,
            refit: false,
            mean: Mean::Arithmetic,
            data: None,
            columns: ColumnOptions::default(),
        }
    }

    fn plan(scenes: Vec<RankScene>) -> RankPlan {
        let options = SweepOptions {
            speeds: Some(Values(vec![0.1, 1.0])),
            pressures: Some(Values(vec![2e4, 4e4])),
            ..SweepOptions::default()
        };
        RankPlan::new(scenes, &of(options), &Stop::default()).unwrap()
    }

    fn found(plan: &RankPlan) -> RankFound {
        plan.find(&Stop::default(), &|| ()).unwrap()
    }

    fn ranked(scenes: Vec<RankScene>) -> Ranking {
        found(&plan(scenes)).ranking
    }

    #[test]
    fn two_equal_scenes_are_above_each_other_with_a_half_exactly() {
        let ranking = ranked(vec![scene("a", 6.5e6, TEN_PER_CENT), scene("b", 6.5e6, TEN_PER_CENT)]);
        assert_eq!(ranking.pairs, [Pair { scenes: [0, 1], above: 0.5, ties: 1.0 }]);
        assert_eq!((ranking.samples, ranking.is_sure()), (64, false));
        assert!(ranking.points.iter().all(|point| point.largest == [0.5, 0.5]));
    }

    /// Each is known to 10 %, and they differ by 1 %: as their strengths err together they are told apart.
    #[test]
    fn what_scenes_share_drops_out() {
        let ranking = ranked(vec![scene("a", 6.5e6, TEN_PER_CENT), scene("b", 6.565e6, TEN_PER_CENT)]);
        let ([first, _], above) = ranking.first_two().unwrap();
        assert_eq!((first.label.as_str(), above, ranking.is_sure()), ("b", 1.0, true));
        // Friction is proportional to the strength.
        let band = first.index_band.unwrap();
        assert!(band.iter().all(|index| (index - 101.0).abs() < 0.01), "{band:?}");
        let friction = first.friction_band.unwrap();
        // Quantiles of a log-normal 3.29 deviations apart, within those of 64 points.
        assert!(((friction[4] / friction[0]).ln() / 0.329 - 1.0).abs() < 0.1, "{friction:?}");
        // Of keys of different names nothing is shared: 1 % is little beside 10 % of either.
        let other = "[uncertainty]\n'surface.fine.modulus' = { relative = 0.1 }\n";
        let ranking = ranked(vec![scene("a", 6.5e6, TEN_PER_CENT), scene("b", 6.565e6, other)]);
        let (_, above) = ranking.first_two().unwrap();
        assert!(!ranking.is_sure() && above < 0.7, "{above}");
    }

    /// One of which everything is known takes part with its own numbers, and without any uncertainty there is no band.
    #[test]
    fn known_scenes_take_part() {
        let plan_of = |uncertain| plan(vec![scene("a", 6.5e6, uncertain), scene("b", 7e6, "")]);
        let mixed = plan_of(TEN_PER_CENT);
        assert_eq!((mixed.known(), mixed.sweeps(), mixed.has_samples()), (vec!["b"], 66, true));
        let ranking = found(&mixed).ranking;
        let (_, above) = ranking.first_two().unwrap();
        // ln(7/6.5) is 0.74 deviations: Φ(0.74) = 0.771.
        assert!((above - 0.771).abs() < 0.03, "{above}");
        let known = plan_of("");
        let ranking = found(&known).ranking;
        assert_eq!((known.has_samples(), ranking.first_two(), ranking.order.clone()), (false, None, vec![1, 0]));
        assert_eq!((ranking.scenes[1].index_band, ranking.pairs.len()), (None, 0));
    }

    #[test]
    fn a_table_has_a_row_for_each_point_and_scene() {
        let ranking = ranked(vec![scene("a", 6.5e6, TEN_PER_CENT), scene("b", 7e6, "")]);
        let csv = Csv::parse(&table(&ranking), None).unwrap();
        assert_eq!((csv.rows.len(), csv.names.len()), (8, 12));
        let column = |name: &str| csv.column(name).unwrap();
        let row = &csv.rows[1].fields;
        assert_eq!([&*row[0], &*row[column("weight")], &*row[column("largest")]][..2], ["b", "0.25"]);
        assert_eq!(row[column("friction")], row[column("friction_0.95")], "everything is known of b");
    }

    #[test]
    fn measured_friction_is_ranked_beside() {
        let folder = std::env::temp_dir().join(format!("asperity-rank-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let path = folder.join("measured.csv");
        let plan = plan(vec![scene("a", 6.5e6, ""), scene("b", 7e6, ""), scene("c", 6e6, "")]);
        let found = found(&plan);
        let write = |rows: &str| std::fs::write(&path, format!("scene;speed [mm/s];pressure [Pa];mu\n{rows}")).unwrap();
        // b above a above c is computed.
        write("# comment\na;100;3e4;0,5\nb.toml;100;3e4;0,6\nc;100;3e4;0,55\nb;100;3e4;0,7\na;1e5;3e4;0,1\n");
        let ranking = measured_ranking(&plan, &found, &path, &[]).unwrap();
        assert_eq!((ranking.points, ranking.tau), (1, Some(1.0 / 3.0)));
        assert!((ranking.scenes[1].measured - 0.65).abs() < 1e-12, "{ranking:?}");
        let computed = ranking.scenes[1].computed / ranking.scenes[0].computed;
        assert!((computed / (7.0 / 6.5) - 1.0).abs() < 1e-3, "{computed}");
        assert!(ranking.notes.iter().any(|note| note.contains("line 7 (100 m/s, 30000 Pa)")), "{:?}", ranking.notes);
        write("a;100;3e4;0,5\nx;100;3e4;0,6\n");
        let error = measured_ranking(&plan, &found, &path, &[]).unwrap_err().to_string();
        assert!(error.contains("line 3: scene = \"x\": expected one of a, b, c, or its file"), "{error}");
        write("a;100;3e4;0,5\nb;500;3e4;0,6\n");
        let error = measured_ranking(&plan, &found, &path, &[]).unwrap_err().to_string();
        assert!(error.contains("at which at least two"), "{error}");
        std::fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn what_cannot_be_ranked_is_refused() {
        let options = SweepOptions {
            speeds: Some(Values(vec![0.1])),
            pressures: Some(Values(vec![2e4])),
            temperatures: Some(Values(vec![293.15])),
            ..SweepOptions::default()
        };
        let options = of(options);
        let new = |scenes: Vec<RankScene>| RankPlan::new(scenes, &options, &Stop::default()).unwrap_err().to_string();
        assert!(new(vec![scene("a", 1e6, "")]).contains("at least 2 scenes"));
        assert!(new(vec![scene("a", 1e6, ""), scene("b", 1e6, "")]).starts_with("a: `temperatures`: the scene has no"));
    }
}
