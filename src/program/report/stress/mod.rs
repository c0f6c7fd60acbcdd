//! The scene under stress: stiffness, mass, relaxation times, speed and communication step scaled by powers of ten, one
//! by one and in pairs, and what becomes of each run.

mod cell;
mod drive;
mod quantity;

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicU64, Ordering};

use asperity::scene::Scene;
use rayon::prelude::*;

use super::reference::{DISPLACEMENT, Reference};
use crate::program::progress;
use cell::Runner;

pub(super) use super::runs::Counts;
pub(super) use cell::{Cell, Check, Difference, Fate, NOTABLE, Status, TIGHTER, WITHIN, WRONG};
pub(super) use drive::{COMMUNICATION_STEPS, MOST_COMMUNICATION_STEPS, SHORT_STEPS};
pub(super) use quantity::{Place, Quantity};

/// A run is too expensive where it takes so many times the steps of the scene as it is.
pub(super) const TOO_EXPENSIVE: u64 = 20;
/// Whatever the scene, so many steps are not.
const CHEAP: u64 = 1000;
/// The tight runs of what is scaled by itself may take so many times what those of the pairs may.
const PATIENCE: u64 = 3;
/// The powers of ten of the pairs are so many that this share of the cells is likely to be run.
const MOST_OF_THEM: f64 = 0.8;
/// What a run that was too expensive would have taken is not known; likely so many times its bound.
const BEYOND: f64 = 2.0;

/// The scene under stress.
#[derive(Debug)]
pub(super) struct Stress {
    /// What the scene has of what is scaled.
    pub(super) quantities: Vec<Quantity>,
    /// Powers of ten each way.
    pub(super) powers: i32,
    /// Every so many of them in pairs.
    pub(super) stride: i32,
    /// The relative tolerance of the runs.
    pub(super) tolerance: f64,
    /// The most work of a run.
    pub(super) bound: u64,
    /// The largest power of the communication step that makes a difference: one step for each phase.
    longest: i32,
    cells: BTreeMap<Place, Cell>,
}

/// Runs the scene of `reference` under stress by so many powers of ten each way; the pairs may take about `seconds`.
pub(super) fn run(reference: &Reference, powers: u32, points: u32, seconds: f64) -> Stress {
    let scene = &reference.scene;
    let unbounded = Runner { scene, points, bound: scene.solver.max_steps, patience: PATIENCE };
    let unstressed = unbounded.run(Place::default());
    let work = unstressed.counts().unwrap_or(&reference.measured.counts).work();
    let bound = TOO_EXPENSIVE * work.max(CHEAP / TOO_EXPENSIVE);
    let mut stress = Stress {
        quantities: Quantity::of(scene),
        powers: powers as i32,
        stride: 0,
        tolerance: scene.solver.relative_tolerance,
        bound,
        longest: longest(scene),
        cells: BTreeMap::from([(Place::default(), unstressed)]),
    };
    let runner = Runner { bound, ..unbounded };
    let singles = stress.missing(stress.quantities.iter().flat_map(|&quantity| stress.line(quantity)));
    stress.run_all(runner, singles, f64::INFINITY, "stress, one by one");
    stress.run_pairs(Runner { patience: 1, ..runner }, seconds);
    stress
}

/// The power of ten from which on a communication step takes a whole phase.
fn longest(scene: &Scene) -> i32 {
    let phase = scene.excitation.iter().map(|phase| phase.duration).fold(0.0, f64::max);
    (phase * COMMUNICATION_STEPS / scene.duration()).log10().ceil() as i32
}

impl Stress {
    /// The cell at a place; of one that was not tried, that it was not.
    pub(super) fn cell(&self, place: Place) -> &Cell {
        self.cells.get(&self.same(place)).unwrap_or(&Cell::LEFT_OUT)
    }

    /// The scene as it is.
    pub(super) fn unstressed(&self) -> &Cell {
        self.cell(Place::default())
    }

    /// All cells that were planned.
    pub(super) fn cells(&self) -> impl Iterator<Item = (&Place, &Cell)> {
        self.cells.iter()
    }

    /// A cell at a glance.
    pub(super) fn status(&self, cell: &Cell) -> Status {
        cell.status(self.tolerance)
    }

    /// The steps of a cell's run, rejected ones included, over those of the scene as it is and one for each
    /// communication step.
    pub(super) fn times_the_steps(&self, cell: &Cell) -> Option<f64> {
        let Fate::Ended { counts, communication_steps, .. } = &cell.fate else { return None };
        let due = self.unstressed().counts()?.work() + communication_steps;
        Some(counts.work() as f64 / due as f64)
    }

    /// What became of a cell's run, in words.
    pub(super) fn reason(&self, cell: &Cell) -> String {
        match &cell.fate {
            Fate::Ended { check: Check::Error(error), .. } => self.error(error),
            Fate::Ended { check: Check::Sensitive { error, moved }, .. } => {
                let error = self.error(error);
                format!("sensitive: {error}, but a start moved by {DISPLACEMENT:e} m changes {moved:.1e}")
            }
            Fate::Ended { check: Check::Unknown(reason), .. } => format!("no tight run to compare with: {reason}"),
            Fate::Stopped(reason) => reason.clone(),
            Fate::TooExpensive(time) => format!("more than {} steps, used up at t = {time:.3e} s", self.bound),
            Fate::LeftOut => "not tried: dearer than there was time for".into(),
        }
    }

    fn error(&self, error: &Difference) -> String {
        let Difference { share, of, time } = error;
        format!(
            "error {share:.1e} of {of} at t = {time:.3e} s, {} times the tolerance",
            two_digits(share / self.tolerance)
        )
    }

    /// The powers of ten, every so many.
    pub(super) fn powers(&self, stride: i32) -> impl Iterator<Item = i32> + use<> {
        let most = self.powers / stride;
        (-most..=most).map(move |step| step * stride)
    }

    /// The place that has the same run: a communication step longer than every phase is as long as the phases.
    fn same(&self, place: Place) -> Place {
        match place.power(Quantity::CommunicationStep) {
            Some(power) if power > self.longest => place.with(Quantity::CommunicationStep, self.longest),
            _ => place,
        }
    }

    /// The cells of one quantity.
    fn line(&self, quantity: Quantity) -> impl Iterator<Item = Place> {
        self.powers(1).map(move |power| Place::default().with(quantity, power))
    }

    /// The cells of all pairs at every so many powers.
    fn pairs(&self, stride: i32) -> Vec<Place> {
        let pairs = self.quantities.iter().enumerate();
        let pairs = pairs.flat_map(|(i, &a)| self.quantities[i + 1..].iter().map(move |&b| (a, b)));
        let grid = pairs.flat_map(|(a, b)| {
            let row = move |power| self.powers(stride).map(move |other| Place::default().with(a, power).with(b, other));
            self.powers(stride).flat_map(row)
        });
        self.missing(grid)
    }

    /// Those of the places that are not run yet, each once.
    fn missing(&self, places: impl Iterator<Item = Place>) -> Vec<Place> {
        let mut places: Vec<Place> = places.map(|place| self.same(place)).collect();
        places.sort_unstable();
        places.dedup();
        places.retain(|place| !self.cells.contains_key(place));
        places
    }

    /// Runs the pairs, the cheap ones first, at as many powers as there is time for.
    fn run_pairs(&mut self, runner: Runner<'_>, seconds: f64) {
        let time = seconds * rayon::current_num_threads() as f64;
        let strides: Vec<i32> = (1..=self.powers).filter(|stride| self.powers % stride == 0).collect();
        let fits = |stride: i32| {
            let places = self.cheap_first(stride);
            let spent = places.iter().scan(0.0, |spent, &place| {
                *spent += self.expected_cost(place);
                Some(*spent)
            });
            spent.filter(|&spent| spent <= time).count() as f64 >= MOST_OF_THEM * places.len() as f64
        };
        self.stride = strides.iter().copied().find(|&stride| fits(stride)).unwrap_or(self.powers);
        self.run_all(runner, self.cheap_first(self.stride), time, "stress, in pairs");
    }

    /// The cells of all pairs, those first that are likely to be cheap.
    fn cheap_first(&self, stride: i32) -> Vec<Place> {
        let mut places = self.pairs(stride);
        places.sort_by(|&a, &b| self.expected_cost(a).total_cmp(&self.expected_cost(b)));
        places
    }

    /// Runs the cells at `places` until they have taken `time` (s).
    fn run_all(&mut self, runner: Runner<'_>, places: Vec<Place>, time: f64, message: &'static str) {
        let bar = progress::bar(places.len() as u64);
        bar.set_message(message);
        let spent = Clock::default();
        let run = |place: Place| {
            let cell = if spent.seconds() < time { runner.run(place) } else { Cell::LEFT_OUT };
            spent.add(cell.cost);
            bar.inc(1);
            (place, cell)
        };
        // In their order: the first are to be run before time is up.
        let cells: Vec<(Place, Cell)> = places.into_iter().par_bridge().map(run).collect();
        bar.finish_and_clear();
        self.cells.extend(cells);
    }

    /// What a cell is likely to take, s: what the quantities do one by one, together.
    fn expected_cost(&self, place: Place) -> f64 {
        let base = self.unstressed().cost;
        let alone = |quantity: Quantity| {
            let power = place.power(quantity)?;
            let cell = self.cells.get(&self.same(Place::default().with(quantity, power)))?;
            let beyond = if matches!(cell.fate, Fate::TooExpensive(_)) { BEYOND } else { 1.0 };
            Some(beyond * cell.cost / base)
        };
        base * self.quantities.iter().filter_map(|&quantity| alone(quantity)).product::<f64>()
    }
}

/// A number with two digits, as far as it has so few.
fn two_digits(value: f64) -> String {
    match value {
        value if value >= 1e4 => format!("{value:.1e}"),
        value if value >= 9.95 => format!("{value:.0}"),
        value if value >= 0.095 || value == 0.0 => format!("{value:.1}"),
        _ => format!("{value:.0e}"),
    }
}

/// Processor time of all threads together.
#[derive(Debug, Default)]
struct Clock {
    nanoseconds: AtomicU64,
}

impl Clock {
    fn add(&self, seconds: f64) {
        self.nanoseconds.fetch_add((1e9 * seconds) as u64, Ordering::Relaxed);
    }

    fn seconds(&self) -> f64 {
        1e-9 * self.nanoseconds.load(Ordering::Relaxed) as f64
    }
}
