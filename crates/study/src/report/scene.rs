//! The report of a scene: its runs in every way.

use asperity::math::{NotEnoughMemory, check_memory};
use asperity::scene::{Parameter, Scene};

use super::communication::{CommunicationLadder, CommunicationRow};
use super::judgement::Judgement;
use super::reference::Reference;
use super::robustness::Robustness;
use super::scenes::watched;
use super::tolerances::{ToleranceLadder, ToleranceRow};
use super::trace::QUANTITIES;
use super::weighed::WeighedRuns;
use crate::progress::{Stopped, Watch};
use crate::robustness::RunFailure;
use crate::runner::Rows;

/// What is run.
#[derive(Clone, Debug)]
pub struct ReportOptions {
    /// Relative tolerances, from loose to tight, one at least.
    pub tolerances: Vec<f64>,
    /// Rows of a phase.
    pub points: u32,
    /// How often each run is timed at most.
    pub repeat: u32,
    /// Powers of ten each way by which quantities are scaled; 0: none are.
    pub stress: u32,
    /// What the runs with two quantities scaled may take, about, s.
    pub stress_time: f64,
}

/// There is nothing to report on.
#[derive(Debug, thiserror::Error)]
#[expect(missing_docs, reason = "the messages say what they are")]
pub enum ReportError {
    #[error("the scene has no [[excitation]]: the carrier rests, and there is no run to report on")]
    NoExcitation,
    #[error("the scene takes no time: every phase of its [[excitation]] ends at once")]
    NoDuration,
    #[error("no reference: not even the loosest tolerance comes to its end: {0}")]
    NoReference(RunFailure),
    #[error(transparent)]
    Memory(#[from] NotEnoughMemory),
    #[error(transparent)]
    Stopped(#[from] Stopped),
}

/// What the runs of a scene cost and how accurate they are.
#[derive(Debug)]
pub struct SceneReport {
    /// What they are compared with.
    pub reference: Reference,
    /// The runs of both methods over the tolerances.
    pub tolerances: Vec<ToleranceRow>,
    /// The runs over communication steps of a master.
    pub communication: Vec<CommunicationRow>,
    /// Where it was asked for.
    pub robustness: Option<Robustness>,
    /// How the runs keep what they promise.
    pub judgements: Vec<Judgement>,
}

impl SceneReport {
    /// Refuses a scene that cannot be run, and more rows than the memory holds of all runs.
    ///
    /// # Errors
    /// Where it has no excitation, or [`NotEnoughMemory`].
    pub fn check(scene: &Scene, options: &ReportOptions) -> Result<(), ReportError> {
        /// Of a row of a run: a time and what runs are compared by.
        const BYTES: u64 = 8 * (1 + QUANTITIES.len() as u64);
        /// Runs beside those of the tolerances by both methods and those of the threads.
        const MORE: usize = 8;
        if scene.excitation.is_empty() {
            return Err(ReportError::NoExcitation);
        }
        let rows = Rows::PerPhase(options.points).count(scene);
        let runs = 2 * options.tolerances.len() + rayon::current_num_threads() + MORE;
        check_memory(rows.saturating_mul(BYTES).saturating_mul(runs as u64), || {
            format!("`rows`: {rows} rows of each of {runs} runs")
        })?;
        Ok(())
    }

    /// Runs the scene in every way.
    ///
    /// # Errors
    /// Where it cannot be run, or `watch` stops it.
    pub fn run(scene: &Scene, options: &ReportOptions, watch: &Watch<'_>) -> Result<Self, ReportError> {
        Self::check(scene, options)?;
        let scene = watched(scene);
        let ReportOptions { tolerances, points, repeat, stress, stress_time } = options;
        let ladder = ToleranceLadder { tolerances, points: *points, repeat: *repeat };
        let tightest = tolerances.last().copied().unwrap_or_default();
        let by_steps = CommunicationLadder::weight(tightest / 10.0, scene.solver.relative_tolerance);
        let total = Reference::weight(tightest) + ladder.weight() + by_steps;
        let progress = WeighedRuns::new(watch, "report", total);
        let reference = Reference::find(&scene, tolerances, *points, &progress);
        progress.finish()?;
        let reference = reference.map_err(ReportError::NoReference)?;
        if reference.scene.excitation.iter().all(|phase| phase.duration <= 0.0) {
            return Err(ReportError::NoDuration);
        }
        let mut tolerances = ladder.run(&reference, &progress);
        let communication = CommunicationLadder::new(&reference, &progress).run();
        progress.finish()?;
        ladder.time(&reference, &mut tolerances, watch)?;
        let robustness = match stress {
            0 => None,
            &powers => Some(Robustness::run(&reference, powers, *points, *stress_time, watch)?),
        };
        let mut judgements: Vec<Judgement> = Judgement::from_tolerances(&reference, &tolerances).collect();
        let method = method(&scene);
        judgements.extend(robustness.iter().flat_map(|all| Judgement::from_perturbations(all, &method)));
        Ok(Self { reference, tolerances, communication, robustness, judgements })
    }
}

/// The method in a word of the scene file.
pub fn method(scene: &Scene) -> String {
    scene.parameter(Parameter::METHOD).to_string().replace('"', "")
}
