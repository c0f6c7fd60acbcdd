//! The study: its runs, and what they come to.
//!
//! Friction and area of a run.

use std::ops::ControlFlow;
use std::path::Path;

use asperity::element::{Load, OperatingPoint, PointStatus};
use asperity::scene::{LinkKind, Scene};
use asperity::table::Table;
use cpu_time::ThreadTime;
use rayon::prelude::*;

use super::plan::{Next, Pair, Plan, Study, Verdict};
use super::table::{Measured, RunRow, StudyHeader};
use super::variants::{Parts, Template, Variant};
use crate::Error;
use crate::contact::SteadyState;
use crate::steady::persson::{Roughness, Theory};
use crate::steady::{SlidingRubber, SteadySolver};
use crate::sweep::{Method, NotSteady, SlidingOptions, StopBounds, SweepMethod, fingerprint, relevant, steady_sliding};
use crate::values::{count, share};
use clap::Args;
use serde::Deserialize;

// What a study is asked for. Not a doc comment: that would be the description of the command.
#[expect(missing_docs, reason = "clap would print it")]
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Args)]
pub struct ConvergenceOptions {
    #[command(flatten)]
    #[serde(flatten)]
    pub at: SteadyState,
    /// Admissible change of friction and area, as a share of them, with the spacing halved, the length doubled or
    /// another seed.
    #[arg(long, value_name = "SHARE", default_value_t = 0.05, value_parser = share)]
    pub error: f64,
    /// Number of seeds of a self-affine surface or roughness, the scene's own included. Default: 4.
    #[arg(long, value_name = "N", value_parser = seeds)]
    pub seeds: Option<u32>,
    #[command(flatten)]
    #[serde(flatten)]
    pub sliding: SlidingOptions,
    /// Most masses, or points of the whole surface with --method steady, that the halved spacing may come to; with twice
    /// the length there are twice as many. Default: 4096 masses, 2097152 points.
    #[arg(long, value_name = "N", visible_alias = "most-masses", value_parser = count)]
    pub most_points: Option<u32>,
}

fn seeds(text: &str) -> Result<u32, String> {
    let number = text.trim().parse().ok().filter(|number| (2..=1000).contains(number));
    number.ok_or_else(|| "expected a whole number from 2 to 1000".into())
}

impl ConvergenceOptions {
    fn state(&self) -> State {
        State { pressure: self.at.pressure, speed: self.at.speed, way: self.sliding.way }
    }
}

/// Seeds where none are asked for.
const SEEDS: u32 = 4;
/// What a halved spacing may come to where nothing is asked for: masses of a layer, points of a surface.
const MOST: (u32, u32) = (4096, 1 << 21);
/// Standard error of a run over the error that its changes may have.
const RUN_ERROR: f64 = 0.1;

/// The study of a scene, its runs not made yet.
#[derive(Debug)]
pub struct ConvergenceStudy {
    template: Template,
    plan: Plan,
    options: ConvergenceOptions,
    header: StudyHeader,
    warning: Option<String>,
}

/// Runs that are made now.
#[derive(Clone, Debug, PartialEq)]
pub struct Round {
    /// Number of runs that are done.
    pub done: usize,
    /// Number of all runs, those that follow these at least included.
    pub all: usize,
    /// Masses or points along x of these.
    pub counts: Vec<u64>,
}

/// What the runs come to.
#[derive(Debug)]
pub struct Findings {
    /// All runs, halvings first.
    pub runs: Vec<RunRow>,
    /// What they leave open.
    pub verdict: Verdict,
    /// Number of runs of the ladder of halved spacings that are steady.
    steady: usize,
}

/// Why a study ended before it was done.
#[derive(Debug)]
pub enum Ended<B> {
    /// A variant of the scene was refused.
    Refused(Error),
    /// The callback broke off.
    Stopped(B),
}

impl ConvergenceStudy {
    /// The study of a `scene`, which was read from the file at `path`.
    ///
    /// # Errors
    /// Where the scene does not go with the options, or has nothing that could be varied.
    pub fn new(scene: &Scene, path: &Path, options: ConvergenceOptions) -> Result<Self, Error> {
        if options.sliding.friction_error.is_some() {
            return Err(Error::value("`friction_error`: expected none, since runs are known to a tenth of `error`"));
        }
        if scene.material.is_none() {
            let problem = "the scene is in the direct form: its masses and links do not follow the spacing, so nothing could \
                           converge; give [material], layer.width and layer.foundation";
            return Err(Error::scene(format!("{}: {problem}", path.display())));
        }
        let template = Template::new(scene, path)?;
        let (method, of_method) = options.sliding.choose(scene)?;
        let template = match &method {
            Method::Steady(surface) => template.on_grid(surface),
            Method::Layer => template,
        };
        let plan = plan(&options, &template)?;
        let warning = scene.hard_pressure("`pressure`", options.at.pressure, matches!(method, Method::Layer));
        method.check(scene)?;
        let ConvergenceOptions { at: SteadyState { pressure, speed }, error, .. } = options;
        let SlidingOptions { way, distance, .. } = options.sliding;
        let asked = format!("converge {pressure:?} {speed:?} {error:?} {distance:?}");
        let header = StudyHeader {
            scene: scene.name.clone(),
            fingerprint: fingerprint(&relevant(scene.clone()), options.sliding, method.surface(), &asked)?,
            method: of_method,
            parts: template.parts(),
            pressure,
            speed,
            way,
            error,
        };
        Ok(Self { template, plan, options, header, warning })
    }

    /// The header of the table.
    pub fn header(&self) -> &StudyHeader {
        &self.header
    }

    /// The whole table: the runs, with the verdict and the changes of the values, which rows that were added do not have.
    pub fn table(&self, findings: &Findings) -> Table {
        let mut table = self.header.table(Some(&findings.verdict.sentence()));
        findings.changes().iter().for_each(|(run, change)| table.push(run.cells(*change)));
        table
    }

    /// What to look at before the runs are made: a pressure that presses the rubber too hard.
    pub fn warning(&self) -> Option<&str> {
        self.warning.as_deref()
    }

    /// What is counted in a run.
    pub fn parts(&self) -> Parts {
        self.template.parts()
    }

    /// Whether the length is doubled; it is not where the solver has one period of a surface, of which there is no more.
    pub fn has_length(&self) -> bool {
        self.plan.has_length
    }

    /// Number of seeds, the scene's own included; `None` where it has none.
    pub fn seeds(&self) -> Option<u32> {
        self.plan.seeds
    }

    /// Makes the runs that are missing beside `runs`, those that do not depend on each other on all cores: `begun` is
    /// called as such a round begins, `made` for each run.
    ///
    /// # Errors
    /// Where `made` breaks off, or a variant of the scene is refused.
    pub fn run<B: Send>(
        &self,
        mut runs: Vec<RunRow>,
        begun: impl Fn(&Round),
        made: impl Fn(&RunRow) -> ControlFlow<B> + Sync,
    ) -> Result<Findings, Ended<B>> {
        loop {
            let outcome = |variant| runs.iter().find(|run| run.variant == variant).map(RunRow::mean);
            let missing = match self.plan.next(outcome) {
                Next::Done(study) => return Ok(self.findings(runs, &study)),
                Next::Runs(missing) => missing,
            };
            begun(&self.round(runs.len(), &missing));
            let make = |&variant: &Variant| {
                let run = self.make(variant).map_err(Ended::Refused)?;
                match made(&run) {
                    ControlFlow::Continue(()) => Ok(run),
                    ControlFlow::Break(answer) => Err(Ended::Stopped(answer)),
                }
            };
            let made: Result<Vec<RunRow>, Ended<B>> = missing.par_iter().with_max_len(1).map(make).collect();
            runs.extend(made?);
        }
    }

    fn round(&self, done: usize, missing: &[Variant]) -> Round {
        let counts = missing.iter().map(|&variant| self.template.dimensions(variant).count);
        Round { done, all: done + missing.len() + self.plan.following(missing), counts: counts.collect() }
    }

    fn make(&self, variant: Variant) -> Result<RunRow, Error> {
        let (scene, state) = (self.template.scene(variant)?, self.options.state());
        let clock = ThreadTime::now();
        let dimensions = self.template.dimensions(variant);
        let is_of_layer = self.parts() == Parts::Masses;
        let measured = if is_of_layer {
            slide(
                &scene,
                state,
                StopBounds { error: RUN_ERROR * self.options.error, distance: self.options.sliding.distance },
            )
        } else {
            solve(&scene, state, dimensions.count)
        };
        let run_time = clock.elapsed().as_secs_f64();
        let theories = [Roughness::Ridges, Roughness::Isotropic]
            .map(|roughness| Theory::new(&scene, state.pressure, state.speed, roughness).unwrap_or_default());
        let fit_rms = is_of_layer.then(|| scene.quality(LinkKind::Vertical).map_or(0.0, |quality| quality.rms));
        let status = PointStatus::new(measured.as_ref().err());
        Ok(RunRow { variant, dimensions, fit_rms, status, measured: measured.ok(), theories, run_time })
    }

    fn findings(&self, mut runs: Vec<RunRow>, study: &Study) -> Findings {
        runs.sort_by_key(|run| run.variant.place());
        Findings { runs, verdict: Verdict::new(study, self.options.error), steady: study.ladder.len() }
    }
}

fn plan(options: &ConvergenceOptions, template: &Template) -> Result<Plan, Error> {
    let parts = template.parts();
    let most = options.most_points.unwrap_or(if parts == Parts::Masses { MOST.0 } else { MOST.1 });
    let within = |halvings: &u32| template.contacts(*halvings) <= u64::from(most);
    let max_halvings = (1..u32::BITS).take_while(within).count() as u32;
    if max_halvings == 0 {
        let [own, least] = [0, 1].map(|halvings| template.contacts(halvings));
        let (parts, halved) = (parts.name(), "and its spacing is halved at least once");
        let expected = format!("`most_{parts}`: expected at least {least}");
        return Err(Error::scene(format!("{expected}: the scene has {own} {parts}, {halved}")));
    }
    if options.seeds.is_some() && !template.has_seed() {
        let problem = "neither the scene's surface nor its roughness is self_affine, so nothing depends on a seed";
        return Err(Error::scene(format!("`seeds`: {problem}")));
    }
    let seeds = template.has_seed().then_some(options.seeds.unwrap_or(SEEDS));
    let (has_length, has_split) = (template.has_length(), template.has_split());
    Ok(Plan { error: options.error, max_halvings, has_length, seeds, has_split })
}

impl Findings {
    /// The runs, each with the change of its values from those of the run that it is compared with.
    pub fn changes(&self) -> Vec<(&RunRow, Option<Pair>)> {
        self.runs.iter().map(|run| (run, self.change(run))).collect()
    }

    fn change(&self, run: &RunRow) -> Option<Pair> {
        let reference = run.variant.reference()?;
        let before = self.runs.iter().find(|run| run.variant == reference)?;
        Some(run.mean()?.change_from(&before.mean()?))
    }

    /// The steady runs with the length and the seed of the scene, from its own spacing to the finest.
    pub fn ladder(&self) -> Vec<&RunRow> {
        self.runs.iter().filter(|run| run.variant.is_of_ladder()).take(self.steady).collect()
    }
}

/// A state of steady sliding.
#[derive(Clone, Copy, Debug)]
pub(super) struct State {
    /// Mean pressure, Pa.
    pub(super) pressure: f64,
    /// Sliding speed, m/s.
    pub(super) speed: f64,
    /// The way that rubber as warm as the scene has slid, m; `None`: its surface is as warm.
    pub(super) way: Option<f64>,
}

fn not_solved() -> Error {
    Error::value("not to be solved for")
}

/// Friction and area in steady sliding, solved for on so many points along x.
pub(super) fn solve(scene: &Scene, state: State, points: u64) -> Result<Measured, Error> {
    let few = u32::try_from(points).map_err(|_| Error::value(format!("{points} points are too many")))?;
    let asked = SlidingOptions { method: Some(SweepMethod::Steady), points: Some(few), ..SlidingOptions::default() };
    let (Method::Steady(surface), _) = asked.choose(scene)? else { return Err(not_solved()) };
    let rubber = SlidingRubber::new(scene).ok_or_else(not_solved)?;
    let slide = SteadySolver::new(surface).slide_over(&rubber, state.speed, state.pressure, state.way);
    if let Some(problem) = slide.problem().filter(|problem| !problem.is_result()) {
        return Err(Error::value(NotSteady::from(problem)));
    }
    // It does not jam.
    let friction = slide.friction().unwrap_or_default();
    Ok(Measured {
        mean: Pair { friction, area: slide.area },
        error: Pair { friction: 0.0, area: 0.0 },
        hysteresis: slide.hysteresis.unwrap_or_default(),
    })
}

/// Friction and area of the layer in steady sliding, known to `bounds`.
pub(super) fn slide(scene: &Scene, state: State, bounds: StopBounds) -> Result<Measured, Error> {
    let area = scene.layer.area().ok_or_else(|| Error::value("the layer has no width"))?;
    let point = OperatingPoint { speed: state.speed, load: state.pressure, temperature: None, way: None };
    let sliding = steady_sliding(scene, &point, Load::Pressure { area }, bounds).map_err(Error::value)?;
    Ok(Measured {
        mean: Pair { friction: sliding.friction(), area: sliding.contact_ratio },
        error: Pair { friction: sliding.friction_error, area: sliding.contact_error },
        hysteresis: sliding.hysteresis(),
    })
}
