//! One point of a sweep: pressed to its load, slid until its means are steady, averaged.
//!
//! A point starts relaxed and at full speed, at the w at which the layer's vertical springs alone would bear the load.
//! It is then searched block by block: after each block, w moves by the [`LoadSearch`], and the dashpots along z move
//! to where the block's means say that they will be ([`Simulation::relax_dashpots`]), as a compound has elements that
//! would take minutes. Once a block bears the load and its dashpots nothing, w is held and nothing is changed any more:
//! these blocks are the window, judged as in [`steady`](super::steady). Where the mean of F_z differs from the load, w
//! moves again, and a new window begins.
//!
//! Where the carrier is a body along z, its load is constant in place of w: it starts at equilibrium, nothing is
//! searched, and after each block the dashpots move as before and the carrier with them. A window counts once the
//! carrier's inertia bears next to nothing of the load in its mean.
//!
//! A point is independent of the others, so a table is the same in whatever order and on however many machines it is
//! computed.
//!
//! [`Simulation::relax_dashpots`]: asperity::simulation::Simulation::relax_dashpots

use asperity::element::{Load, OperatingPoint, Quantity, STEADY, TableHeader, TableRow};
use asperity::model::{LinkKind, Model};
use asperity::scene::{CarrierBodies, CarrierBody, CarrierInitial, Scene};
use asperity::simulation::{Interrupt, SimulationError};

use super::load_search::LoadSearch;
use super::scenes::{relevant, scene_at};
use super::slide::{BlockMeans, Blocks, Slide, tangential_stiffness};
use super::window::{MIN_WINDOW, Window, window};

/// The mean of F_z over the window is the load within this share of it.
const LOAD: f64 = 1e-3;
/// Standard error of that mean, and its trend, as shares of the load: small enough for a correction of w to reach
/// [`LOAD`].
const LOAD_ERROR: f64 = 5e-4;
/// The search ends with a block whose F_z is as close as this to the load, and the force of its dashpots to 0, ...
const NEAR: f64 = 5e-4;
/// ... or after so many blocks: the windows correct the rest.
const SEARCHES: usize = 12;
/// Fraction of a block over which w is changed, and fraction over which the effect of that decays.
const RAMP: f64 = 0.125;
const CALM: f64 = 0.125;
/// Blocks of the shortest slide on which means can be judged: pressed, then averaged.
pub(super) const MIN_BLOCKS: f64 = RAMP + CALM + MIN_WINDOW as f64;
/// A window of so many blocks whose load has a trend is abandoned: the dashpots are not yet at rest.
const ABANDONED: usize = 6;
/// The relative error of a friction coefficient smaller than this is taken relative to this.
pub const SMALL_FRICTION: f64 = 1e-2;
/// Longest distance in blocks where none is given.
const BLOCKS: f64 = 100.0;

/// When a point ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StopBounds {
    /// Standard error of the friction coefficient over its mean.
    pub error: f64,
    /// Longest distance, m; `None`: 100 blocks.
    pub distance: Option<f64>,
}

/// What a layer does in steady sliding.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SteadySliding {
    /// Displacement of the carrier, m.
    pub w: f64,
    /// Mean F_z, N.
    pub force_z: f64,
    /// Friction coefficient and its parts, 1.
    friction: FrictionParts,
    /// Standard error of the friction coefficient, 1.
    pub friction_error: f64,
    /// Masses in contact over all masses, 1.
    pub contact_ratio: f64,
    /// Area that touches with the waves that the profile lacks over the layer's, 1; `None` without them.
    real_area: Option<f64>,
    /// Standard error of the contact ratio, 1.
    pub contact_error: f64,
    /// Power lost in dampers, Maxwell elements, friction and impacts, W; `None` for a channel that the scene cannot
    /// have.
    channels: [Option<f64>; 4],
    /// Number of displacements w that were tried.
    runs: u32,
    /// Time of the last run, s.
    time: f64,
}

impl SteadySliding {
    /// Friction coefficient, 1.
    pub fn friction(&self) -> f64 {
        self.friction.whole
    }

    /// The part of the friction coefficient that is hysteresis, 1.
    pub fn hysteresis(&self) -> f64 {
        self.friction.hysteresis
    }

    /// The part of that by the waves that the profile lacks, 1.
    pub fn fine(&self) -> f64 {
        self.friction.fine.unwrap_or(0.0)
    }

    /// Mean force against the motion, N.
    pub fn drag(&self) -> f64 {
        self.friction.whole * self.force_z
    }

    /// Power lost, W.
    pub fn power(&self) -> f64 {
        self.channels.iter().flatten().sum()
    }
}

/// The friction coefficient and its parts, 1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct FrictionParts {
    whole: f64,
    hysteresis: f64,
    /// The part of the hysteresis by the waves that the profile lacks; `None` where it lacks none that rub.
    fine: Option<f64>,
    adhesion: f64,
}

/// What was found at a point.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct PointResult {
    /// [`STEADY`], or what is wrong.
    pub(super) status: String,
    /// `None` where a run failed or there was no room for a window.
    pub(super) sliding: Option<SteadySliding>,
    /// Stiffness of all springs along x, N/m.
    tangential_stiffness: Option<f64>,
}

impl PointResult {
    fn failed(status: String) -> Self {
        Self { status, sliding: None, tangential_stiffness: None }
    }

    /// The result with the tangential stiffness found, N/m. A force that falls as motion starts is none: the masses at
    /// rest do not hold what the load asks of them, and an element could not use the point.
    fn with_stiffness(self, found: Option<f64>) -> Self {
        match found {
            Some(falling) if falling <= 0.0 && self.status == STEADY => {
                let status =
                    format!("tangential stiffness: {falling:.4e} N/m, expected a number above 0: refine the layer");
                Self { status, ..self }
            }
            tangential_stiffness => Self { tangential_stiffness, ..self },
        }
    }

    pub(super) fn row(&self, point: OperatingPoint, header: &TableHeader) -> TableRow {
        let mut row = TableRow::new(point, self.status.clone());
        row.set(Quantity::Stiffness, self.tangential_stiffness);
        let Some(sliding) = &self.sliding else { return row };
        let values = [
            (Quantity::Friction, sliding.friction.whole),
            (Quantity::FrictionStandardError, sliding.friction_error),
            (Quantity::Hysteresis, sliding.friction.hysteresis),
            (Quantity::Adhesion, sliding.friction.adhesion),
            (Quantity::MeanLoad, header.load.at_force(sliding.force_z)),
            (Quantity::ContactRatio, sliding.contact_ratio),
            (Quantity::Separation, header.rest_separation + sliding.w),
            (Quantity::Displacement, sliding.w),
            (Quantity::Runs, f64::from(sliding.runs)),
            (Quantity::Time, sliding.time),
        ];
        values.into_iter().for_each(|(quantity, value)| row.set(quantity, Some(value)));
        row.set(Quantity::FineHysteresis, sliding.friction.fine);
        row.set(Quantity::RealArea, sliding.real_area);
        Quantity::CHANNELS.into_iter().zip(sliding.channels).for_each(|(channel, power)| row.set(channel, power));
        row
    }
}

/// Blocks at one w, averaged.
#[derive(Clone, Debug, PartialEq)]
struct Average {
    means: BlockMeans,
    friction: Window,
    load: Window,
    contact: Window,
    steady: bool,
    /// F_z has a trend.
    drifts: bool,
}

/// What is held while a layer slides.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Held {
    /// w, which is searched until it bears the load.
    Searched,
    /// The load, by a carrier of this mass, kg.
    Load(f64),
    /// w, whatever it bears.
    Given,
}

/// The search for steady sliding under a load, or for steady sliding at a displacement that is given.
#[derive(Debug)]
struct Search<'a> {
    scene: &'a Scene,
    blocks: Blocks,
    error: f64,
    distance: f64,
    slide: Slide,
    load: LoadSearch,
    held: Held,
    /// Stiffness of all vertical springs in the long term, N/m.
    stiffness: f64,
    runs: u32,
    /// What may stop the runs.
    interrupt: Option<&'a Interrupt>,
    /// Distance of the slides before the present one, m.
    distance_before: f64,
}

/// Steady sliding of the layer of `scene` at `speed` (m/s) under the force `load` (N).
pub(super) fn sliding(
    scene: &Scene,
    speed: f64,
    load: f64,
    bounds: StopBounds,
    interrupt: Option<&Interrupt>,
) -> PointResult {
    let loaded = under_load(scene, load);
    let scene = &loaded;
    let load = LoadSearch::estimated(load, scene, &Model::new(scene));
    let held = scene.carrier.z.map_or(Held::Searched, |body| Held::Load(body.mass));
    search((scene, speed), bounds, load, held, interrupt)
}

/// Steady sliding of the layer of `scene` at `speed` (m/s) with the carrier held at `w` (m), where F_z is near `load`
/// (N).
pub(super) fn sliding_at(scene: &Scene, speed: f64, w: f64, load: f64, bounds: StopBounds) -> PointResult {
    let scene = &Scene { carrier: CarrierBodies::default(), ..scene.clone() };
    let mut load = LoadSearch::estimated(load, scene, &Model::new(scene));
    load.w = w;
    search((scene, speed), bounds, load, Held::Given, None)
}

/// Steady sliding at one point, known to `bounds`.
///
/// # Errors
/// The status of the point, where the layer does not become steady.
pub fn steady_sliding(
    scene: &Scene,
    point: &OperatingPoint,
    load: Load,
    bounds: StopBounds,
) -> Result<SteadySliding, String> {
    let scene = scene_at(&relevant(scene.clone()), point);
    steady(sliding(&scene, point.speed, load.force(point.load), bounds, None))
}

/// Steady sliding at one point with the carrier held at `w` (m), where the load is near that of the point.
pub(super) fn steady_sliding_at(
    scene: &Scene,
    point: &OperatingPoint,
    w: f64,
    load: Load,
    bounds: StopBounds,
) -> Result<SteadySliding, String> {
    let scene = scene_at(&relevant(scene.clone()), point);
    steady(sliding_at(&scene, point.speed, w, load.force(point.load), bounds))
}

fn steady(result: PointResult) -> Result<SteadySliding, String> {
    match result.sliding {
        Some(sliding) if result.status == STEADY => Ok(sliding),
        _ => Err(result.status),
    }
}

fn search(
    (scene, speed): (&Scene, f64),
    bounds: StopBounds,
    load: LoadSearch,
    held: Held,
    interrupt: Option<&Interrupt>,
) -> PointResult {
    let search = Search::new((scene, Blocks::new(scene, speed)), bounds, load, held, interrupt);
    search.and_then(Search::finish).unwrap_or_else(|error| PointResult::failed(error.to_string()))
}

/// The scene with the force `load` (N) as the constant load of a carrier that is a body, from equilibrium.
fn under_load(scene: &Scene, load: f64) -> Scene {
    let mut scene = scene.clone();
    if let Some(body) = &mut scene.carrier.z {
        *body = CarrierBody { load: Some(load), start: None, initial: CarrierInitial::Equilibrium, ..*body };
    }
    scene
}

/// Steady sliding, and the tangential stiffness at its start, w held.
pub(super) fn find(
    scene: &Scene,
    speed: f64,
    load: f64,
    bounds: StopBounds,
    interrupt: Option<&Interrupt>,
) -> PointResult {
    let result = sliding(scene, speed, load, bounds, interrupt);
    if result.sliding.is_none() {
        return result;
    }
    let scene = &Scene { carrier: CarrierBodies::default(), ..scene.clone() };
    let model = Model::new(scene);
    let (load, blocks) = (LoadSearch::estimated(load, scene, &model), Blocks::new(scene, speed));
    let stiffness = model.links[LinkKind::Vertical].stiffness;
    let frequency = if stiffness > 0.0 { (stiffness / model.mass).sqrt() } else { model.stiffest_frequency() };
    match tangential_stiffness(scene, blocks, load, frequency, interrupt) {
        Ok(found) => result.with_stiffness(found),
        Err(error) if result.status == STEADY => {
            PointResult { status: format!("tangential stiffness: {error}"), ..result }
        }
        Err(_) => result,
    }
}

impl Held {
    /// w at the start, m: a carrier under its load finds its own.
    fn start(self, load: &LoadSearch) -> f64 {
        if matches!(self, Self::Load(_)) { 0.0 } else { load.w }
    }
}

impl<'a> Search<'a> {
    fn new(
        (scene, blocks): (&'a Scene, Blocks),
        bounds: StopBounds,
        load: LoadSearch,
        held: Held,
        interrupt: Option<&'a Interrupt>,
    ) -> Result<Self, SimulationError> {
        let distance = bounds.distance.unwrap_or(BLOCKS * blocks.length);
        let vertical = scene.link(LinkKind::Vertical).and_then(|link| link.stiffness).unwrap_or(0.0);
        let stiffness = scene.layer.masses as f64 * vertical;
        let slide = Slide::new(scene, blocks, held.start(&load), interrupt)?;
        Ok(Self {
            scene,
            blocks,
            error: bounds.error,
            distance,
            slide,
            load,
            held,
            stiffness,
            runs: 1,
            interrupt,
            distance_before: 0.0,
        })
    }

    /// Presses, then averages at one w after the other until a window is steady and has the load.
    fn finish(mut self) -> Result<PointResult, SimulationError> {
        self.slide.press(RAMP + CALM, 0.0)?;
        let mut first = self.press()?;
        loop {
            let Some(average) = self.average(first.take())? else {
                let Blocks { length, .. } = self.blocks;
                let status =
                    format!("not steady: no room for {MIN_WINDOW} blocks of {length} m within {} m", self.distance);
                return Ok(PointResult::failed(status));
            };
            let pressed = average.steady && self.deviation(&average.means).abs() <= LOAD;
            if pressed || !self.has_room(MIN_BLOCKS) {
                return Ok(self.result(&average));
            }
            let maxwell = if average.drifts { self.relax(&average.means) } else { 0.0 };
            self.correct(average.load.mean, maxwell)?;
        }
    }

    /// Slides until F_z is near the load and the slow dashpots are at rest. Returns the last block if they are.
    fn press(&mut self) -> Result<Option<BlockMeans>, SimulationError> {
        for _ in 0..SEARCHES {
            if !self.has_room(1.0) || !self.slide.has_room(1.0) {
                break;
            }
            let means = self.slide.block()?;
            let maxwell = self.relax(&means);
            if self.deviation(&means).abs() <= NEAR && maxwell.abs() <= NEAR * self.load.target {
                return Ok(Some(means));
            }
            self.correct(means.load, maxwell)?;
        }
        Ok(None)
    }

    /// Relaxes the dashpots by the `means` of the last blocks; returns what the vertical ones bore of F_z, N.
    fn relax(&mut self, means: &BlockMeans) -> f64 {
        match self.held {
            // Of the masses that bear in the mean: at one instant there may be none.
            Held::Load(_) => self.slide.relax_under_load(means.contact * self.stiffness),
            Held::Searched | Held::Given => self.slide.relax(),
        }
    }

    /// How far F_z is from the load in the mean, as a share of it: where that is held, what the carrier's inertia
    /// bears.
    fn deviation(&self, means: &BlockMeans) -> f64 {
        match self.held {
            Held::Load(mass) => mass * means.acceleration / self.load.target,
            Held::Searched => means.load / self.load.target - 1.0,
            Held::Given => 0.0,
        }
    }

    /// Changes w where F_z was `force`, of which the Maxwell elements bore `maxwell` (N), or lets a carrier under its
    /// load, or a layer at its w, come to rest. On a profile that ends, a new slide begins where no room is left.
    fn correct(&mut self, force: f64, maxwell: f64) -> Result<(), SimulationError> {
        let searched = self.held == Held::Searched;
        let change = if searched { self.load.change(force, maxwell) } else { 0.0 };
        self.runs += u32::from(searched);
        if !self.slide.has_room(MIN_BLOCKS) {
            return self.restart();
        }
        self.slide.press(RAMP, change)?;
        self.slide.press(CALM, 0.0)
    }

    /// A new slide from the start of a profile that ends.
    fn restart(&mut self) -> Result<(), SimulationError> {
        self.distance_before += self.slide.distance();
        self.slide = Slide::new(self.scene, self.blocks, self.held.start(&self.load), self.interrupt)?;
        self.slide.press(RAMP + CALM, 0.0)
    }

    fn has_room(&self, blocks: f64) -> bool {
        self.distance_before + self.slide.distance() + blocks * self.blocks.length <= self.distance
    }

    /// Blocks with w held, after a `first` one, until their means are steady or there is no room for more; `None` where
    /// there is no room for a window.
    fn average(&mut self, first: Option<BlockMeans>) -> Result<Option<Average>, SimulationError> {
        let mut blocks: Vec<BlockMeans> = first.into_iter().collect();
        if !self.slide.has_room(MIN_WINDOW as f64) {
            blocks.clear();
            self.restart()?;
        }
        while self.has_room(1.0) && self.slide.has_room(1.0) {
            blocks.push(self.slide.block()?);
            if blocks.len() >= MIN_WINDOW {
                let average = self.judge(&blocks);
                if average.steady || (blocks.len().is_multiple_of(ABANDONED) && average.drifts) {
                    return Ok(Some(average));
                }
            }
        }
        Ok((blocks.len() >= MIN_WINDOW).then(|| self.judge(&blocks)))
    }

    fn judge(&self, blocks: &[BlockMeans]) -> Average {
        let used = &blocks[window(blocks.len())..];
        let of = |value: fn(&BlockMeans) -> f64| Window::new(&used.iter().map(value).collect::<Vec<_>>());
        let (friction, load) = (of(|means| means.drag / means.load), of(|means| means.load));
        let contact = of(|means| means.contact);
        let steady = friction.is_steady(self.error * friction.mean.abs().max(SMALL_FRICTION))
            && load.is_steady(LOAD_ERROR * self.load.target);
        let drifts = load.has_trend(LOAD_ERROR * self.load.target);
        Average { means: BlockMeans::mean(used), friction, load, contact, steady, drifts }
    }

    fn result(&self, average: &Average) -> PointResult {
        let means = &average.means;
        let [damper, maxwell, friction, impact] = means.power;
        let sliding = SteadySliding {
            w: if matches!(self.held, Held::Load(_)) { means.w } else { self.load.w },
            force_z: means.load,
            friction: FrictionParts::new(means),
            friction_error: average.friction.error,
            contact_ratio: means.contact,
            real_area: means.real_area.zip(self.scene.layer.area()).map(|(real, area)| real / area),
            contact_error: average.contact.error,
            channels: [damper, maxwell, friction, Some(impact.unwrap_or(0.0))],
            runs: self.runs,
            time: self.slide.time(),
        };
        PointResult { status: self.status(average), sliding: Some(sliding), tangential_stiffness: None }
    }

    fn status(&self, average: &Average) -> String {
        let deviation = self.deviation(&average.means);
        let distance = self.distance_before + self.slide.distance();
        if !average.steady {
            let error = average.friction.error / average.friction.mean.abs().max(SMALL_FRICTION);
            format!(
                "not steady after {distance:.4} m: standard error of the friction coefficient {:.2} % of it",
                100.0 * error
            )
        } else if deviation.abs() > LOAD {
            format!("not pressed after {distance:.4} m: mean F_z is off by {:.2} %", 100.0 * deviation)
        } else {
            STEADY.to_owned()
        }
    }
}

impl FrictionParts {
    /// The whole is the carrier's work, which is exact; the parts are sampled and miss the impulses of impacts, so what
    /// they lack is divided in proportion to them.
    fn new(means: &BlockMeans) -> Self {
        let [whole, hysteresis, adhesion] =
            [means.drag, means.hysteresis, means.adhesion].map(|force| force / means.load);
        let size = hysteresis.abs() + adhesion.abs();
        let share = if size > 0.0 { hysteresis.abs() / size } else { 1.0 };
        let sampled = hysteresis;
        let hysteresis = sampled + share * (whole - sampled - adhesion);
        let scale = if sampled == 0.0 { 1.0 } else { hysteresis / sampled };
        let fine = means.fine.map(|force| scale * force / means.load);
        Self { whole, hysteresis, fine, adhesion: whole - hysteresis }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_force_that_falls_as_motion_starts_is_no_stiffness() {
        let steady = || PointResult { status: STEADY.into(), sliding: None, tangential_stiffness: None };
        assert_eq!(steady().with_stiffness(Some(2e4)).tangential_stiffness, Some(2e4));
        let marked = steady().with_stiffness(Some(-2.8e4));
        assert_eq!(marked.tangential_stiffness, None);
        assert!(marked.status.starts_with("tangential stiffness: -2.8000e4 N/m"), "{}", marked.status);
    }

    /// The parts add up, and one that is absent stays absent.
    #[test]
    fn parts_add_up() {
        let of = |drag, hysteresis, adhesion| {
            FrictionParts::new(&BlockMeans { drag, load: 2.0, hysteresis, adhesion, ..BlockMeans::default() })
        };
        let parts = |whole, hysteresis, adhesion| FrictionParts { whole, hysteresis, fine: None, adhesion };
        assert_eq!(of(1.0, 0.0, 0.98), parts(0.5, 0.0, 0.5));
        assert_eq!(of(1.0, 0.98, 0.0), parts(0.5, 0.5, 0.0));
        let FrictionParts { whole, hysteresis, adhesion, .. } = of(1.0, 0.6, 0.2);
        assert!((hysteresis + adhesion - whole).abs() < 1e-15 && (hysteresis / adhesion - 3.0).abs() < 1e-12);
        // Of hysteresis that lacks a fifth in its sample the fine waves keep their share.
        let means = BlockMeans { drag: 1.0, load: 2.0, hysteresis: 0.8, fine: Some(0.4), ..BlockMeans::default() };
        let fine = FrictionParts::new(&means).fine.unwrap();
        assert!((fine - 0.25).abs() < 1e-15, "{fine}");
        // Nothing sampled: all that there is are slopes.
        assert_eq!(of(0.0, 0.0, 0.0), FrictionParts::default());
    }
}
