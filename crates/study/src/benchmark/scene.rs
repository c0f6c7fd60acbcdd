//! The benchmark of a scene: its runs in every way.

use asperity::math::check_memory;
use asperity::scene::Scene;
use clap::Args;
use serde::{Deserialize, Serialize};

use super::communication::{CommunicationLadder, CommunicationRow};
use super::judgement::Judgement;
use super::reference::Reference;
use super::run::{WeighedRuns, watched};
use super::stress::Stress;
use super::tolerances::{ToleranceLadder, ToleranceRow};
use super::trace::QUANTITIES;
use crate::Error;
use crate::decimals::tenth;
use crate::progress::Watch;
use crate::runner::Rows;
use crate::values::count;

// What is run. Not a doc comment: that would be the description of the command that has it.
#[expect(missing_docs, reason = "clap would print it")]
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Args)]
pub struct BenchmarkOptions {
    /// Range of relative tolerances to run at; each is a tenth of the previous one.
    #[arg(long, value_name = "LOOSEST..TIGHTEST", default_value = "1e-2..1e-10", value_parser = Tolerances::parse)]
    pub tolerances: Tolerances,
    /// Number of rows for each phase of the excitation at which runs are compared.
    #[arg(long, value_name = "N", default_value_t = 50, value_parser = count)]
    pub rows: u32,
    /// Most timings of each run, done for short runs; long ones are timed three times. The least and the spread are
    /// reported.
    #[arg(long, value_name = "N", default_value_t = 25, value_parser = count)]
    pub repeat: u32,
    /// Robustness test: varies the scene's quantities, one by one, by up to N powers of ten either way. 0 skips the
    /// test.
    #[arg(long, value_name = "N", default_value_t = 6, value_parser = powers)]
    pub stress: u32,
}

/// Relative tolerances, from loose to tight, one at least.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Tolerances(pub Vec<f64>);

impl Tolerances {
    /// The largest tolerance that a scene may have.
    const LOOSEST: f64 = 0.1;
    /// Rounding hides any smaller one.
    const TIGHTEST: f64 = 1e-14;

    fn parse(text: &str) -> Result<Self, String> {
        /// Relative rounding error of a tolerance.
        const ROUNDING: f64 = 1e-9;
        let inside = |(loosest, tightest): &(f64, f64)| {
            *loosest <= Self::LOOSEST && tightest <= loosest && *tightest >= Self::TIGHTEST
        };
        let number = |text: &str| text.trim().parse().ok();
        let ends = text.split_once("..").and_then(|(first, last)| Some((number(first)?, number(last)?)));
        let Some((loosest, tightest)) = ends.filter(inside) else {
            return Err("expected LOOSEST..TIGHTEST, such as 1e-2..1e-10, from at most 0.1 to at least 1e-14".into());
        };
        let ladder = std::iter::successors(Some(loosest), |&tolerance| Some(tenth(tolerance)));
        Ok(Self(ladder.take_while(|&tolerance| tolerance >= tightest * (1.0 - ROUNDING)).collect()))
    }
}

/// Powers of ten.
fn powers(text: &str) -> Result<u32, String> {
    text.trim().parse().ok().filter(|&powers| powers <= 12).ok_or_else(|| "expected a whole number from 0 to 12".into())
}

/// What the runs of a scene cost and how accurate they are.
#[derive(Debug)]
pub struct Benchmark {
    /// What they are compared with.
    pub reference: Reference,
    /// The runs of both methods over the tolerances.
    pub tolerances: Vec<ToleranceRow>,
    /// The runs over communication steps of a master.
    pub communication: Vec<CommunicationRow>,
    /// The runs with quantities scaled, where they were asked for.
    pub stress: Option<Stress>,
    /// How the runs keep what they promise.
    pub judgements: Vec<Judgement>,
}

impl Benchmark {
    /// Refuses a scene that cannot be run, and more rows than the memory holds of all runs.
    ///
    /// # Errors
    /// Where it has no excitation, or needs too much memory.
    pub fn check(scene: &Scene, options: &BenchmarkOptions) -> Result<(), Error> {
        /// Of a row of a run: a time and what runs are compared by.
        const BYTES: u64 = 8 * (1 + QUANTITIES.len() as u64);
        /// Runs beside those of the tolerances by both methods and those of the threads.
        const MORE: usize = 8;
        if scene.excitation.is_empty() {
            return Err(Error::scene(
                "the scene has no [[excitation]]: the carrier rests, and there is no run to report on",
            ));
        }
        let rows = Rows::PerPhase(options.rows).count(scene);
        let runs = 2 * options.tolerances.0.len() + rayon::current_num_threads() + MORE;
        check_memory(rows.saturating_mul(BYTES).saturating_mul(runs as u64), || {
            format!("`rows`: {rows} rows of each of {runs} runs")
        })?;
        Ok(())
    }

    /// Runs the scene in every way.
    ///
    /// # Errors
    /// Where it cannot be run, or `watch` stops it.
    pub fn run(scene: &Scene, options: &BenchmarkOptions, watch: &Watch<'_>) -> Result<Self, Error> {
        Self::check(scene, options)?;
        let scene = watched(scene);
        let BenchmarkOptions { tolerances: Tolerances(tolerances), rows, repeat, stress } = options;
        let ladder = ToleranceLadder { tolerances, points: *rows, repeat: *repeat };
        let tightest = tolerances.last().copied().unwrap_or_default();
        let by_steps = CommunicationLadder::weight(tightest / 10.0, scene.solver.relative_tolerance);
        let total = Reference::weight(tightest) + ladder.weight() + by_steps;
        let progress = WeighedRuns::new(watch, "runs", total);
        let reference = Reference::find(&scene, tolerances, *rows, &progress);
        progress.finish()?;
        let reference = reference.map_err(|failure| {
            Error::run(format!("no reference: not even the loosest tolerance comes to its end: {failure}"))
        })?;
        if reference.scene.excitation.iter().all(|phase| phase.duration <= 0.0) {
            return Err(Error::scene("the scene takes no time: every phase of its [[excitation]] ends at once"));
        }
        let mut tolerances = ladder.run(&reference, &progress);
        let communication = CommunicationLadder::new(&reference, &progress).run();
        progress.finish()?;
        ladder.time(&reference, &mut tolerances, watch)?;
        let stress = match stress {
            0 => None,
            &powers => Some(Stress::run(&reference, powers, *rows, watch)?),
        };
        let mut judgements: Vec<Judgement> = Judgement::from_tolerances(&reference, &tolerances).collect();
        judgements.extend(stress.iter().flat_map(Judgement::from_stress));
        Ok(Self { reference, tolerances, communication, stress, judgements })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tolerances_are_decimal_tenths() {
        let ladder = Tolerances::parse("1e-2..1e-10").unwrap().0;
        assert_eq!(ladder, [1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10]);
        assert_eq!(Tolerances::parse("0.05..1e-3").unwrap().0, [0.05, 0.005]);
        assert_eq!(Tolerances::parse("1e-3..1e-3").unwrap().0, [1e-3]);
        for wrong in ["1e-3", "1e-10..1e-2", "1..1e-2", "1e-2..0", "1e-2..NaN", "a..b"] {
            assert!(Tolerances::parse(wrong).unwrap_err().contains("1e-2..1e-10"), "{wrong}");
        }
    }
}
