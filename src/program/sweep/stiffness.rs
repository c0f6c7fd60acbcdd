//! The tangential stiffness: the slope of |F_x| over u as the layer, pressed long ago, is set in motion from stick.

use asperity::outputs::Output;
use asperity::scene::{Path, Scene};
use asperity::simulation::{Motion, Simulation, SimulationError, Start};

use super::secant::Secant;
use super::slide::{Way, chosen, rate};

/// The way over which the slope is taken, m ...
const WAY: f64 = 1e-6;
/// ... or this share of a block, where that is shorter: a fine profile has fine contacts.
const OF_BLOCK: f64 = 1e-3;
/// Samples on it.
const SAMPLES: u32 = 16;
/// How near to the load the layer is pressed before, as a share, and how often that is tried.
const LOAD: f64 = 1e-3;
const TRIES: usize = 12;
/// The layer comes to rest in so many of the times in which a mass swings by a radian, after which its dashpots are
/// relaxed, as often as that.
const REST: f64 = 100.0;
const RELAXED: usize = 3;

/// The stiffness, N/m; `None` where there is no friction to stick by, or where the layer does not come to its load.
pub(super) fn tangential_stiffness(
    scene: &Scene,
    way: Way,
    mut secant: Secant,
    frequency: f64,
) -> Result<Option<f64>, SimulationError> {
    if scene.friction.is_none() {
        return Ok(None);
    }
    let forces = chosen(scene, &[Output::ForceX, Output::ForceZ]);
    let read = |simulation: &mut Simulation| {
        let mut values = [0.0; 2];
        simulation.evaluate(&forces, &mut values);
        values
    };
    for _ in 0..TRIES {
        let mut simulation = at_rest(scene, way, secant.w, REST / frequency)?;
        let [before, load] = read(&mut simulation);
        if (load / secant.load - 1.0).abs() <= LOAD {
            return slope(&mut simulation, way, before, |simulation| read(simulation)[0]).map(Some);
        }
        let _ = secant.change(load, 0.0);
    }
    Ok(None)
}

/// The layer at rest at w, its dashpots relaxed.
fn at_rest(scene: &Scene, way: Way, w: f64, duration: f64) -> Result<Simulation, SimulationError> {
    let mut simulation = Simulation::new(scene, &Start { u: way.start, w, ..Start::default() })?;
    for _ in 0..RELAXED {
        simulation.advance(&Motion { duration, u: Path::default(), w: Path::default() })?;
        let elongations = simulation.maxwell_elongations().to_vec();
        simulation.relax_dashpots(&elongations, 0.0);
    }
    simulation.advance(&Motion { duration, u: Path::default(), w: Path::default() })?;
    Ok(simulation)
}

/// That of the straight line from `before` (N) that fits -F_x best, N/m.
fn slope(
    simulation: &mut Simulation,
    way: Way,
    before: f64,
    mut force: impl FnMut(&mut Simulation) -> f64,
) -> Result<f64, SimulationError> {
    let duration = WAY.min(OF_BLOCK * way.block) / way.speed;
    let share = |i: u32| if i == SAMPLES { 1.0 } else { f64::from(i) / f64::from(SAMPLES) };
    let times: Vec<f64> = (1..=SAMPLES).map(|i| duration * share(i)).collect();
    let (mut products, mut squares) = (0.0, 0.0);
    let motion = Motion { duration, u: rate(way.speed), w: Path::default() };
    simulation.advance_observed(&motion, &times, |time, simulation| {
        let u = way.speed * time;
        products += u * (before - force(simulation));
        squares += u * u;
    })?;
    Ok(products / squares)
}
