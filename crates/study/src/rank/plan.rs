//! What is computed: a sweep of each scene as it stands, and of each of its samples.

use std::path::{Path, PathBuf};

use asperity::element::{Load, OperatingPoint, Quantity};
use asperity::scene::Scene;

use super::ranking::{Frictions, Ranking};
use super::weights::Weights;
use crate::Error;
use crate::files::name_of;
use crate::progress::{Stop, Stopped};
use crate::sweep::{SweepOptions, SweepPlan, SweepTable};
use crate::uncertainty::{Drawn, Refused, SampleOptions, Sampler, UncertainScene, Uncertainty};

/// Friction of a scene at all points, or why it cannot be swept.
type Found = Result<Vec<Option<f64>>, Error>;

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
    sampler: Option<Sampler>,
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
    /// The ranking of `scenes` at the points of the `options`, by so many samples of what is not known of them.
    ///
    /// # Errors
    /// Where a scene does not go with the options, or with the others.
    pub fn new(scenes: Vec<RankScene>, options: SweepOptions, samples: SampleOptions) -> Result<Self, Error> {
        if scenes.len() < 2 {
            return Err(Error::value(format!("expected at least 2 scenes to rank, found {}", scenes.len())));
        }
        let labels = labels(&scenes);
        if options.temperatures.is_none() {
            check_temperatures(&scenes, &labels)?;
        }
        let entry = |(scene, label): (RankScene, String)| -> Result<Entry, Error> {
            let RankScene { scene, file } = scene;
            let refused = |error: Error| error.context(&label);
            let plan = SweepPlan::new(scene.clone(), &options, None).map_err(refused)?;
            let is_known = Uncertainty::of(&scene)?.0.is_empty();
            let uncertain = (!is_known).then(|| UncertainScene::new(scene)).transpose()?;
            Ok(Entry { label, file, plan, uncertain })
        };
        let entries = scenes.into_iter().zip(labels).map(entry).collect::<Result<Vec<_>, _>>()?;
        let uncertain = || entries.iter().filter_map(|entry| entry.uncertain.as_ref());
        let axes = uncertain().flat_map(UncertainScene::axes).collect();
        let sampler = uncertain().next().is_some().then(|| Sampler::new(axes, samples)).transpose()?;
        Ok(Self { entries, options, sampler })
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
        let of = |entry: &Entry| Some(format!("{}: {}", entry.label, entry.plan.warning()?));
        self.entries.iter().filter_map(of).collect()
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
    pub fn find(&self, weights: &Weights, stop: &Stop, done: &(dyn Fn() + Sync)) -> Result<RankFound, Error> {
        let points = self.points();
        let weights = weights.of(&points, self.load())?;
        let mut tables = Vec::new();
        for entry in &self.entries {
            tables.push(swept(&entry.plan, stop)?);
            done();
        }
        let own: Frictions = tables.iter().map(frictions).collect();
        let (samples, redrawn) = self.samples(&own, stop, done)?;
        let weighted: Vec<(OperatingPoint, f64)> = points.into_iter().zip(weights).collect();
        let ranking = Ranking::new(self.labels(), (self.load(), &weighted), &own, &samples)?;
        Ok(RankFound { ranking: Ranking { redrawn, ..ranking }, tables })
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
            swept(&plan, stop).map(|table| frictions(&table)).unwrap_or_else(nothing)
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
