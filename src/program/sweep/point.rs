//! One point of a sweep: pressed to its load, slid until its means are steady, averaged.
//!
//! A point starts at full speed and at the w at which the layer's vertical springs alone would bear the load, pressed
//! long ago, so that nothing rings for long. It is then searched block by block: after each, w moves by the secant, and
//! the dashpots along z go where the block's means say that they will be ([`Simulation::relax_dashpots`]), for a
//! compound has elements that would take minutes. Once a block bears the load and its dashpots nothing, w is held and
//! nothing is touched any more: these blocks are the window, judged as in [`steady`](super::steady). Where its mean is
//! off the load, w moves by what is missing, and a new window begins.
//!
//! A point knows nothing of the others, so a table is the same in whatever order and on however many machines it is
//! made.
//!
//! [`Simulation::relax_dashpots`]: asperity::simulation::Simulation::relax_dashpots

use asperity::model::{LinkKind, Model};
use asperity::scene::Scene;
use asperity::simulation::SimulationError;

use super::estimate::{self, Bars};
use super::secant::Secant;
use super::slide::{Means, Slide, Way};
use super::steady::{FEWEST, Window, window};
use super::stiffness::tangential_stiffness;
use super::table::{Row, STEADY};

/// The mean of F_z over the window is the load within this share of it.
const LOAD: f64 = 1e-3;
/// Standard error of that mean, and its trend: so well known, a correction of w reaches [`LOAD`].
const LOAD_ERROR: f64 = 5e-4;
/// The search ends with a block as close as this to the load, its dashpots to none ...
const NEAR: f64 = 5e-4;
/// ... or after so many: what is left, the windows find.
const SEARCHES: usize = 12;
/// A part of a block over which w is changed, and one over which that dies away.
const RAMP: f64 = 0.125;
const CALM: f64 = 0.125;
/// A window of so many blocks whose load has a trend is given up: dashpots are not yet where they will be.
const GIVEN_UP: usize = 6;
/// A friction coefficient smaller than this is known well enough with the error of this one.
const SMALL: f64 = 1e-2;
/// Blocks that a point may take where no distance is given.
pub(super) const BLOCKS: f64 = 100.0;

/// What a point is judged by.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Bounds {
    /// Standard error of the friction coefficient over its mean.
    pub(super) error: f64,
    /// How far a point may be slid, m; none for [`BLOCKS`] blocks.
    pub(super) distance: Option<f64>,
}

/// Blocks at one w, and what they say.
#[derive(Clone, Debug, PartialEq)]
struct Average {
    means: Means,
    friction: Window,
    load: Window,
    steady: bool,
    /// F_z grows or falls for good.
    drifts: bool,
}

/// A layer on its way to a load and to steady means.
#[derive(Debug)]
struct Search<'a> {
    scene: &'a Scene,
    way: Way,
    error: f64,
    distance: f64,
    slide: Slide,
    secant: Secant,
    runs: u32,
    /// How far all that started anew went before, m.
    gone: f64,
}

/// What the layer of `scene` does at `speed` (m/s) under the force `load` (N).
pub(super) fn find(scene: &Scene, speed: f64, load: f64, bounds: Bounds) -> Row {
    let failed = |error: SimulationError| Row { status: error.to_string(), ..Row::default() };
    let model = Model::new(scene);
    let secant = Secant::new(load, Bars::new(&model, &estimate::heights(scene, &model)).displacement(load));
    let way = estimate::way(scene, speed);
    let row = Search::new(scene, way, bounds, secant).and_then(Search::finish).unwrap_or_else(failed);
    if row.friction.is_none() {
        return row;
    }
    let stiffness = model.links[LinkKind::Vertical as usize].stiffness;
    let frequency = if stiffness > 0.0 { (stiffness / model.mass).sqrt() } else { model.stiffest_frequency() };
    match tangential_stiffness(scene, way, secant, frequency) {
        Ok(tangential_stiffness) => Row { tangential_stiffness, ..row },
        Err(error) if row.status == STEADY => Row { status: format!("tangential stiffness: {error}"), ..row },
        Err(_) => row,
    }
}

impl<'a> Search<'a> {
    fn new(scene: &'a Scene, way: Way, bounds: Bounds, secant: Secant) -> Result<Self, SimulationError> {
        let distance = bounds.distance.unwrap_or(BLOCKS * way.block);
        let slide = Slide::new(scene, way, secant.w)?;
        Ok(Self { scene, way, error: bounds.error, distance, slide, secant, runs: 1, gone: 0.0 })
    }

    /// Presses, then averages at one w after the other until a window is steady and has the load.
    fn finish(mut self) -> Result<Row, SimulationError> {
        self.slide.press(RAMP + CALM, 0.0)?;
        let mut first = self.press()?;
        loop {
            let Some(average) = self.average(first.take())? else {
                let status = format!("not steady: no room for {FEWEST} blocks of {} m", self.way.block);
                return Ok(Row { status, ..Row::default() });
            };
            let off = average.load.mean / self.secant.load - 1.0;
            let pressed = average.steady && off.abs() <= LOAD;
            if pressed || !self.has_room(RAMP + CALM + FEWEST as f64) {
                return Ok(self.row(&average));
            }
            let borne = if average.drifts { self.slide.relax() } else { 0.0 };
            self.correct(average.load.mean, borne)?;
        }
    }

    /// Slides on until F_z is near the load and the slow dashpots are where they will be. Returns the last block, if
    /// that is so.
    fn press(&mut self) -> Result<Option<Means>, SimulationError> {
        for _ in 0..SEARCHES {
            if !self.has_room(1.0) || !self.slide.has_room(1.0) {
                break;
            }
            let means = self.slide.block()?;
            let borne = self.slide.relax();
            let near = |force: f64| force.abs() <= NEAR * self.secant.load;
            if near(means.load - self.secant.load) && near(borne) {
                return Ok(Some(means));
            }
            self.correct(means.load, borne)?;
        }
        Ok(None)
    }

    /// Changes w where F_z was `force`, of which the Maxwell elements bore `borne` (N). On a profile that ends, a new
    /// run begins where no room is left.
    fn correct(&mut self, force: f64, borne: f64) -> Result<(), SimulationError> {
        let change = self.secant.change(force, borne);
        self.runs += 1;
        if !self.slide.has_room(RAMP + CALM + FEWEST as f64) {
            return self.start_anew();
        }
        self.slide.press(RAMP, change)?;
        self.slide.press(CALM, 0.0)
    }

    /// A new run from the start of a profile that ends.
    fn start_anew(&mut self) -> Result<(), SimulationError> {
        self.gone += self.slide.distance();
        self.slide = Slide::new(self.scene, self.way, self.secant.w)?;
        self.slide.press(RAMP + CALM, 0.0)
    }

    fn has_room(&self, blocks: f64) -> bool {
        self.gone + self.slide.distance() + blocks * self.way.block <= self.distance
    }

    /// Blocks with w held, after a `first` one, until their means are steady or there is no room for more; `None` where
    /// there is not even room for a window.
    fn average(&mut self, first: Option<Means>) -> Result<Option<Average>, SimulationError> {
        let mut blocks: Vec<Means> = first.into_iter().collect();
        if !self.slide.has_room(FEWEST as f64) {
            blocks.clear();
            self.start_anew()?;
        }
        while self.has_room(1.0) && self.slide.has_room(1.0) {
            blocks.push(self.slide.block()?);
            if blocks.len() >= FEWEST {
                let average = self.judge(&blocks);
                if average.steady || (blocks.len().is_multiple_of(GIVEN_UP) && average.drifts) {
                    return Ok(Some(average));
                }
            }
        }
        Ok((blocks.len() >= FEWEST).then(|| self.judge(&blocks)))
    }

    fn judge(&self, blocks: &[Means]) -> Average {
        let used = &blocks[window(blocks.len())..];
        let of = |value: fn(&Means) -> f64| Window::new(&used.iter().map(value).collect::<Vec<_>>());
        let (friction, load) = (of(|means| means.drag / means.load), of(|means| means.load));
        let steady = friction.is_steady(self.error * friction.mean.abs().max(SMALL))
            && load.is_steady(LOAD_ERROR * self.secant.load);
        let drifts = load.has_trend(LOAD_ERROR * self.secant.load);
        Average { means: Means::mean(used), friction, load, steady, drifts }
    }

    fn row(&self, average: &Average) -> Row {
        let means = &average.means;
        let [damper, maxwell, friction, impact] = means.power;
        let channels = [damper, maxwell, friction, Some(impact.unwrap_or(0.0))];
        Row {
            status: self.status(average),
            friction: Some(parts(means, average.friction.error)),
            force: Some(means.load),
            contact: Some(means.contact),
            power: channels,
            tangential_stiffness: None,
            w: Some(self.secant.w),
            runs: Some(self.runs),
            time: Some(self.slide.time()),
        }
    }

    fn status(&self, average: &Average) -> String {
        let off = average.load.mean / self.secant.load - 1.0;
        let way = self.gone + self.slide.distance();
        if !average.steady {
            let error = average.friction.error / average.friction.mean.abs().max(SMALL);
            format!(
                "not steady after {way:.4} m: standard error of the friction coefficient {:.2} % of it",
                100.0 * error
            )
        } else if off.abs() > LOAD {
            format!("not pressed after {way:.4} m: mean F_z is off by {:.2} %", 100.0 * off)
        } else {
            STEADY.to_owned()
        }
    }
}

/// The friction coefficient, its standard error, its hysteresis and its adhesion part. The whole is the carrier's work,
/// which is exact; the parts are sampled and miss the impulses of impacts, so what they lack is shared out as they are.
fn parts(means: &Means, error: f64) -> [f64; 4] {
    let [whole, hysteresis, adhesion] = [means.drag, means.hysteresis, means.adhesion].map(|force| force / means.load);
    let size = hysteresis.abs() + adhesion.abs();
    let share = if size > 0.0 { hysteresis.abs() / size } else { 1.0 };
    let hysteresis = hysteresis + share * (whole - hysteresis - adhesion);
    [whole, error, hysteresis, whole - hysteresis]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The parts add up, and one that is not there stays so.
    #[test]
    fn parts_add_up() {
        let of = |drag, hysteresis, adhesion| {
            let means = Means { drag, load: 2.0, hysteresis, adhesion, ..Means::default() };
            parts(&means, 0.0)
        };
        assert_eq!(of(1.0, 0.0, 0.98), [0.5, 0.0, 0.0, 0.5]);
        assert_eq!(of(1.0, 0.98, 0.0), [0.5, 0.0, 0.5, 0.0]);
        let [whole, _, hysteresis, adhesion] = of(1.0, 0.6, 0.2);
        assert!((hysteresis + adhesion - whole).abs() < 1e-15 && (hysteresis / adhesion - 3.0).abs() < 1e-12);
        // Nothing sampled: all that there is are slopes.
        assert_eq!(of(0.0, 0.0, 0.0), [0.0; 4]);
    }
}
