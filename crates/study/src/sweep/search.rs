//! The search for steady sliding: block by block, until a window of them is steady and has the load.

use asperity::element::Quantity;
use asperity::model::LinkKind;
use asperity::simulation::SimulationError;

use super::layer::{BlockMeans, Layer, Slide};
use super::load_search::LoadSearch;
use super::table::{SweepHeader, SweepRow};
use crate::steady::SlideProblem;

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

/// Why there is no steady sliding at a point, or its values cannot be relied on.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct NotSteady(pub(super) String);

impl From<SimulationError> for NotSteady {
    fn from(error: SimulationError) -> Self {
        Self(error.to_string())
    }
}

impl From<SlideProblem> for NotSteady {
    fn from(problem: SlideProblem) -> Self {
        Self(problem.to_string())
    }
}

/// The relative error of a friction coefficient smaller than this is taken relative to this.
pub const SMALL_FRICTION: f64 = 1e-2;
/// What a layer does in steady sliding.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SteadySliding {
    /// Displacement of the carrier, m.
    pub w: f64,
    /// Mean F_z, N.
    pub force_z: f64,
    /// Friction coefficient and its parts, 1.
    pub(super) friction: FrictionShares,
    /// Standard error of the friction coefficient, 1.
    pub friction_error: f64,
    /// Masses in contact over all masses, 1.
    pub contact_ratio: f64,
    /// Area that touches with the waves that the profile lacks over the layer's, 1; `None` without them.
    pub real_area: Option<f64>,
    /// Standard error of the contact ratio, 1.
    pub contact_error: f64,
    /// Power lost in dampers, Maxwell elements, friction and impacts, W; `None` for a channel that the scene cannot
    /// have.
    pub(super) channels: [Option<f64>; 4],
    /// Number of displacements w that were tried.
    pub(super) runs: u32,
    /// Time of the last run, s.
    pub(super) time: f64,
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

    /// Sets the values of a row of a table.
    pub(super) fn fill(&self, row: &mut SweepRow, header: &SweepHeader) {
        let values = [
            (Quantity::Friction, self.friction.whole),
            (Quantity::FrictionStandardError, self.friction_error),
            (Quantity::Hysteresis, self.friction.hysteresis),
            (Quantity::Adhesion, self.friction.adhesion),
            (Quantity::MeanLoad, header.load.at_force(self.force_z)),
            (Quantity::ContactRatio, self.contact_ratio),
            (Quantity::Separation, header.rest_separation + self.w),
            (Quantity::Displacement, self.w),
            (Quantity::Runs, f64::from(self.runs)),
            (Quantity::Time, self.time),
        ];
        values.into_iter().for_each(|(quantity, value)| row.set(quantity, Some(value)));
        row.set(Quantity::FineHysteresis, self.friction.fine);
        row.set(Quantity::RealArea, self.real_area);
        Quantity::CHANNELS.into_iter().zip(self.channels).for_each(|(channel, power)| row.set(channel, power));
    }
}

/// The friction coefficient and its parts, 1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct FrictionShares {
    whole: f64,
    hysteresis: f64,
    /// The part of the hysteresis by the waves that the profile lacks; `None` where it lacks none that rub.
    fine: Option<f64>,
    adhesion: f64,
}

impl FrictionShares {
    /// The whole is the carrier's work, which is exact; the parts are sampled and miss the impulses of impacts, so what
    /// they lack is divided in proportion to them.
    pub(super) fn new(means: &BlockMeans) -> Self {
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

/// What a layer does once no more blocks are needed, or there is no room for more.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Slid {
    pub(super) sliding: SteadySliding,
    /// Why that is no steady sliding under the load; `None` where it is.
    pub(super) problem: Option<NotSteady>,
}

impl Slid {
    pub(super) fn steady(self) -> Result<SteadySliding, NotSteady> {
        self.problem.map_or(Ok(self.sliding), Err)
    }
}

/// What is held while a layer slides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Held {
    /// w, which is searched until it bears the load.
    Searched,
    /// The load, by a carrier of this mass, kg.
    Load(f64),
    /// w, whatever it bears.
    Given,
}

/// The search for steady sliding under a load, or for steady sliding at a displacement that is given.
#[derive(Debug)]
pub(super) struct Search<'a> {
    layer: Layer<'a>,
    error: f64,
    distance: f64,
    slide: Slide,
    load: LoadSearch,
    held: Held,
    /// Stiffness of all vertical springs in the long term, N/m.
    stiffness: f64,
    runs: u32,
    /// Distance of the slides before the present one, m.
    distance_before: f64,
}

impl Held {
    /// w at the start, m: a carrier under its load finds its own.
    fn start(self, load: &LoadSearch) -> f64 {
        if matches!(self, Self::Load(_)) { 0.0 } else { load.w }
    }
}

impl<'a> Search<'a> {
    pub(super) fn new(
        layer: Layer<'a>,
        bounds: StopBounds,
        load: LoadSearch,
        held: Held,
    ) -> Result<Self, SimulationError> {
        let vertical = layer.scene.link(LinkKind::Vertical).and_then(|link| link.stiffness).unwrap_or(0.0);
        Ok(Self {
            layer,
            error: bounds.error,
            distance: bounds.distance.unwrap_or(BLOCKS * layer.blocks.length),
            slide: Slide::new(layer, held.start(&load))?,
            load,
            held,
            stiffness: layer.scene.layer.masses as f64 * vertical,
            runs: 1,
            distance_before: 0.0,
        })
    }

    /// Presses, then averages at one w after the other until a window is steady and has the load.
    ///
    /// # Errors
    /// Where a run fails, or there is no room for a window.
    pub(super) fn finish(mut self) -> Result<Slid, NotSteady> {
        self.slide.press(RAMP + CALM, 0.0)?;
        let mut first = self.press()?;
        loop {
            let Some(average) = self.average(first.take())? else {
                let (length, distance) = (self.layer.blocks.length, self.distance);
                return Err(NotSteady(format!(
                    "not steady: no room for {MIN_WINDOW} blocks of {length} m within {distance} m"
                )));
            };
            let pressed = average.steady && self.deviation(&average.means).abs() <= LOAD;
            if pressed || !self.has_room(MIN_BLOCKS) {
                return Ok(Slid { sliding: self.sliding(&average), problem: self.problem(&average) });
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
        self.slide = Slide::new(self.layer, self.held.start(&self.load))?;
        self.slide.press(RAMP + CALM, 0.0)
    }

    fn has_room(&self, blocks: f64) -> bool {
        self.distance_before + self.slide.distance() + blocks * self.layer.blocks.length <= self.distance
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

    fn sliding(&self, average: &Average) -> SteadySliding {
        let means = &average.means;
        let [damper, maxwell, friction, impact] = means.power;
        SteadySliding {
            w: if matches!(self.held, Held::Load(_)) { means.w } else { self.load.w },
            force_z: means.load,
            friction: FrictionShares::new(means),
            friction_error: average.friction.error,
            contact_ratio: means.contact,
            real_area: means.real_area.zip(self.layer.scene.layer.area()).map(|(real, area)| real / area),
            contact_error: average.contact.error,
            channels: [damper, maxwell, friction, Some(impact.unwrap_or(0.0))],
            runs: self.runs,
            time: self.slide.time(),
        }
    }

    fn problem(&self, average: &Average) -> Option<NotSteady> {
        let deviation = self.deviation(&average.means);
        let distance = self.distance_before + self.slide.distance();
        if !average.steady {
            let error = 100.0 * average.friction.error / average.friction.mean.abs().max(SMALL_FRICTION);
            return Some(NotSteady(format!(
                "not steady after {distance:.4} m: standard error of the friction coefficient {error:.2} % of it"
            )));
        }
        (deviation.abs() > LOAD).then(|| {
            let off = 100.0 * deviation;
            NotSteady(format!("not pressed after {distance:.4} m: mean F_z is off by {off:.2} %"))
        })
    }
}

/// The fewest blocks of a window.
pub(super) const MIN_WINDOW: usize = 3;
/// The fewest blocks, joined ones, whose scatter or correlation is used.
const MIN_JOINED: usize = 8;
/// The largest correlation of a block with the next that is used.
const CORRELATED: f64 = 0.95;

/// A quantity over the blocks of a window, which says whether the means of a run are steady.
///
/// The run is divided into blocks of equal length, of which only the means of a quantity are used. The latter half of
/// the blocks, at least [`MIN_WINDOW`], is the window; those before are left to the transient. The window is steady
/// where
///
/// - the standard error of its mean is at most the tolerance. Successive blocks may be correlated, which would make a
///   mean seem better known than it is. So s/√n is multiplied by √((1+r)/(1-r)), r being the correlation of a block
///   with the next; and neighbours are joined in pairs, and pairs again, as long as [`MIN_JOINED`] are left: the
///   largest standard error of all these is taken (Flyvbjerg and Petersen, J. Chem. Phys. 91, 1989);
/// - it has no trend: the change along the straight line of least squares from the first block to the last is at most
///   the tolerance, or no more than twice what scatter alone would make of it.
///
/// On a periodic profile a block is a whole number of periods: in steady motion the means of all blocks are then the
/// same, and [`MIN_WINDOW`] blocks are enough.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Window {
    pub(super) mean: f64,
    /// Its standard error.
    pub(super) error: f64,
    /// The change from the first block to the last.
    pub(super) trend: f64,
    /// The standard error of that.
    trend_error: f64,
}

/// The first block of the window of `count` blocks.
pub(super) fn window(count: usize) -> usize {
    count - count.div_ceil(2).max(MIN_WINDOW).min(count)
}

impl Window {
    /// From the means of the blocks, at least two.
    pub(super) fn new(blocks: &[f64]) -> Self {
        let mean = mean(blocks);
        let (trend, trend_error) = trend(blocks, mean);
        Self { mean, error: standard_error(blocks), trend, trend_error }
    }

    /// Whether the mean is known to `tolerance` and has no trend.
    pub(super) fn is_steady(&self, tolerance: f64) -> bool {
        self.error <= tolerance && !self.has_trend(tolerance)
    }

    /// Whether the change from the first block to the last is above `tolerance` and twice what scatter makes of it.
    pub(super) fn has_trend(&self, tolerance: f64) -> bool {
        self.trend.abs() > tolerance.max(2.0 * self.trend_error)
    }
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// The largest standard error of the mean of the blocks, of pairs of them, of pairs of pairs and so on.
fn standard_error(blocks: &[f64]) -> f64 {
    let mut joined = blocks.to_vec();
    let r = correlation(blocks);
    let mut error = error_of_mean(&joined) * ((1.0 + r) / (1.0 - r)).sqrt();
    while joined.len() / 2 >= MIN_JOINED {
        joined = joined.chunks_exact(2).map(|pair| 0.5 * (pair[0] + pair[1])).collect();
        error = error.max(error_of_mean(&joined));
    }
    error
}

/// s/√n, the standard error of independent blocks.
fn error_of_mean(blocks: &[f64]) -> f64 {
    let n = blocks.len() as f64;
    let mean = mean(blocks);
    let squares: f64 = blocks.iter().map(|block| (block - mean).powi(2)).sum();
    (squares / (n * (n - 1.0).max(1.0))).sqrt()
}

/// Correlation of a block with the next, 0 where it is not distinct from scatter. Few blocks make it seem smaller than
/// it is, by (1 + 3r)/n.
fn correlation(blocks: &[f64]) -> f64 {
    let n = blocks.len() as f64;
    let mean = mean(blocks);
    let squares: f64 = blocks.iter().map(|block| (block - mean).powi(2)).sum();
    if blocks.len() < MIN_JOINED || squares <= 0.0 {
        return 0.0;
    }
    let products: f64 = blocks.windows(2).map(|pair| (pair[0] - mean) * (pair[1] - mean)).sum();
    let r = products / squares;
    let corrected = if r > n.sqrt().recip() { r + (1.0 + 3.0 * r) / n } else { r };
    corrected.clamp(0.0, CORRELATED)
}

/// The change along the line of least squares and its standard error from the scatter about the line.
fn trend(blocks: &[f64], mean: f64) -> (f64, f64) {
    let n = blocks.len() as f64;
    let position = |i: usize| i as f64 - 0.5 * (n - 1.0);
    let squares = n * (n * n - 1.0) / 12.0;
    let slope = blocks.iter().enumerate().map(|(i, block)| position(i) * (block - mean)).sum::<f64>() / squares;
    let rest = |(i, block): (usize, &f64)| (block - mean - slope * position(i)).powi(2);
    let scatter: f64 = blocks.iter().enumerate().map(rest).sum();
    let variance = scatter / (n - 2.0).max(1.0) / squares;
    ((n - 1.0) * slope, (n - 1.0) * variance.sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The parts add up, and one that is absent stays absent.
    #[test]
    fn parts_add_up() {
        let of = |drag, hysteresis, adhesion| {
            FrictionShares::new(&BlockMeans { drag, load: 2.0, hysteresis, adhesion, ..BlockMeans::default() })
        };
        let parts = |whole, hysteresis, adhesion| FrictionShares { whole, hysteresis, fine: None, adhesion };
        assert_eq!(of(1.0, 0.0, 0.98), parts(0.5, 0.0, 0.5));
        assert_eq!(of(1.0, 0.98, 0.0), parts(0.5, 0.5, 0.0));
        let FrictionShares { whole, hysteresis, adhesion, .. } = of(1.0, 0.6, 0.2);
        assert!((hysteresis + adhesion - whole).abs() < 1e-15 && (hysteresis / adhesion - 3.0).abs() < 1e-12);
        // Of hysteresis that lacks a fifth in its sample the fine waves keep their share.
        let means = BlockMeans { drag: 1.0, load: 2.0, hysteresis: 0.8, fine: Some(0.4), ..BlockMeans::default() };
        let fine = FrictionShares::new(&means).fine.unwrap();
        assert!((fine - 0.25).abs() < 1e-15, "{fine}");
        // Nothing sampled: all that there is are slopes.
        assert_eq!(of(0.0, 0.0, 0.0), FrictionShares::default());
    }

    /// Even numbers between 0 and 1 (Knuth's generator).
    fn even(state: &mut u64) -> f64 {
        *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((*state >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
    }

    /// A series x = φ x + ε with mean 0 and the variance of ε 1; and the true standard error of its mean.
    fn series(phi: f64, count: usize, state: &mut u64) -> (Vec<f64>, f64) {
        let mut normal = || (-2.0 * even(state).ln()).sqrt() * (std::f64::consts::TAU * even(state)).cos();
        let variance = 1.0 / (1.0 - phi * phi);
        let mut x = normal() * variance.sqrt();
        let blocks = (0..count).map(|_| {
            x = phi * x + normal();
            x
        });
        let blocks = blocks.collect();
        let n = count as f64;
        let lags: f64 = (1..count).map(|lag| (1.0 - lag as f64 / n) * phi.powi(lag as i32)).sum();
        (blocks, (variance / n * (1.0 + 2.0 * lags)).sqrt())
    }

    /// The standard error of correlated noise is right within a quarter on average, and the true mean lies within two
    /// of it nearly as often as it should (95 % where the error itself is known well).
    #[test]
    fn the_error_of_correlated_noise_is_right() {
        const SERIES: usize = 400;
        let mut state = 7;
        for (phi, count, least) in
            [(0.0, 16, 0.92), (0.0, 512, 0.94), (0.5, 64, 0.9), (0.5, 512, 0.93), (0.8, 64, 0.82), (0.8, 512, 0.92)]
        {
            let (mut sum, mut inside) = (0.0, 0);
            for _ in 0..SERIES {
                let (blocks, truth) = series(phi, count, &mut state);
                let window = Window::new(&blocks);
                sum += window.error / truth;
                inside += usize::from(window.mean.abs() <= 2.0 * window.error);
            }
            let (ratio, share) = (sum / SERIES as f64, inside as f64 / SERIES as f64);
            assert!((0.85..1.25).contains(&ratio), "φ = {phi}, {count} blocks: error over the true one {ratio}");
            assert!(share >= least, "φ = {phi}, {count} blocks: mean within two errors in {share}");
        }
    }

    #[test]
    fn a_trend_is_not_steady_and_what_follows_it_is() {
        let line: Vec<f64> = (0..10).map(|i| 1.0 + 0.01 * f64::from(i)).collect();
        let window = Window::new(&line);
        // The line rises by 0.09, and nothing scatters about it.
        assert!((window.trend - 0.09).abs() < 1e-12 && !window.is_steady(0.05) && window.is_steady(0.1));
        // A transient that dies away: steady once the window, the latter half, begins at the fifth block, e^(-8) <
        // 1e-3.
        let decay: Vec<f64> = (0..12).map(|i| 1.0 + (-2.0 * f64::from(i)).exp()).collect();
        let steady = |count: usize| Window::new(&decay[super::window(count)..count]).is_steady(1e-3);
        assert_eq!((3..=12).find(|&count| steady(count)), Some(8));
    }

    #[test]
    fn the_window_is_the_latter_half_and_at_least_three_blocks() {
        assert_eq!([2, 3, 4, 6, 7, 20].map(window), [0, 0, 1, 3, 3, 10]);
    }

    /// Whole periods of steady motion: all alike, and known at once.
    #[test]
    fn equal_blocks_are_steady() {
        let window = Window::new(&[0.3; MIN_WINDOW]);
        assert_eq!((window.mean, window.error, window.is_steady(1e-12)), (0.3, 0.0, true));
    }
}
