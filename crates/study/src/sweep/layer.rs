//! A layer that slides at constant speed, block by block, and its tangential stiffness as it is set in motion; and the
//! scenes of it.

use asperity::element::{Load, OperatingPoint};
use asperity::model::{EvenSliding, Model};
use asperity::outputs::{Output, Variable, variables};
use asperity::scene::{Initial, LARGEST, OutputGroup, Path, Phase, Scene};
use asperity::simulation::{Interrupt, Motion, Simulation, SimulationError, Start};

use super::load_search::{LoadSearch, ends};

/// A block is the whole period of a periodic profile, where that is not longer than so many layers.
const LONGEST_PERIOD: f64 = 20.0;
/// Samples of a block, at least and at most; between, as many as the block has data points of the profile.
const SAMPLES: (f64, f64) = (128.0, 2048.0);

/// Sampled at evenly spaced times of a block.
const SAMPLED: [Output; 6] =
    [Output::ForceZ, Output::Hysteresis, Output::Adhesion, Output::ContactRatio, Output::FineForce, Output::RealArea];
/// Integrated by the run itself: a block's mean is the difference over its duration.
const INTEGRATED: [Output; 5] =
    [Output::InputEnergy, Output::DamperEnergy, Output::MaxwellEnergy, Output::FrictionEnergy, Output::ImpactEnergy];

/// Distance over which the tangential stiffness is taken, m, ...
const STIFFNESS_DISTANCE: f64 = 1e-6;
/// ... or this share of a block, where that is shorter: a fine profile has fine contacts.
const STIFFNESS_SHARE: f64 = 1e-3;
/// Samples on that distance.
const STIFFNESS_SAMPLES: u32 = 16;
/// F_z at rest is the load within this share of it.
const LOAD_AT_REST: f64 = 1e-3;
/// Displacements w that are tried for that.
const TRIES: usize = 12;
/// Time to come to rest, in periods of a mass over 2π.
const REST: f64 = 100.0;
/// How often that and a relaxation of the dashpots are repeated.
const RELAXATIONS: usize = 3;

/// The scene without what a sweep does not depend on, and with the outputs that it reads.
pub fn relevant(scene: Scene) -> Scene {
    use OutputGroup::{Contact, Dissipation, Energy, Forces, Friction};
    let outputs = vec![Forces, Dissipation, Friction, Contact, Energy];
    let mut scene = Scene { outputs, excitation: Vec::new(), description: None, ..scene };
    scene.layer.initial = Initial::Relaxed;
    scene
}

/// The scene of one point, its loads being of this kind. `solver.reduce` depends on the speed and on the duration of its
/// excitation: as steady motion has no end, no Maxwell element becomes a spring. Contacts that are to slide evenly do so at
/// that point.
pub(super) fn scene_at(scene: &Scene, point: &OperatingPoint, load: Load) -> Scene {
    let mut scene = scene.with_temperature(point.temperature);
    let u = Path { rate: point.speed, ..Path::default() };
    scene.excitation = vec![Phase {
        duration: LARGEST,
        u,
        w: Path::default(),
        until_force: None,
        until_pressure: None,
        ..Phase::default()
    }];
    if scene.memory_follows() {
        scene.default_memory = EvenSliding::default_memory([even_sliding(&scene, point, load)]);
    }
    scene
}

/// What even sliding takes at a point whose scene this is.
pub(super) fn even_sliding(scene: &Scene, point: &OperatingPoint, load: Load) -> EvenSliding {
    let mean = load.force(point.load) / scene.layer.masses as f64;
    EvenSliding::at(scene, &Model::new(scene), point.speed, mean)
}

#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct BlockMeans {
    /// |F_x|, positive against the motion: the carrier's work over the distance, N.
    pub(super) drag: f64,
    /// F_z, N.
    pub(super) load: f64,
    /// Tangential force by hysteresis: the tangential part of the normal contact forces on the slopes, against the
    /// motion, N.
    pub(super) hysteresis: f64,
    /// Tangential force by adhesion: the tangential part of the friction forces in the contacts, against the motion, N.
    pub(super) adhesion: f64,
    /// Masses in contact over all masses, 1.
    pub(super) contact: f64,
    /// The part of the hysteresis by the waves that the profile lacks, N; `None` where it lacks none that rub.
    pub(super) fine: Option<f64>,
    /// Area that touches with those waves, m²; `None` without them.
    pub(super) real_area: Option<f64>,
    /// Power lost in dampers, Maxwell elements, friction and impacts, W; none for a channel that the scene cannot have.
    pub(super) power: [Option<f64>; 4],
    /// Displacement of the carrier, m.
    pub(super) w: f64,
    /// Change of the carrier's speed along z over the time, m/s².
    pub(super) acceleration: f64,
}

impl BlockMeans {
    /// Over several blocks, at least one.
    pub(super) fn mean(blocks: &[Self]) -> Self {
        let share = 1.0 / blocks.len() as f64;
        let of = |value: &dyn Fn(&Self) -> f64| share * blocks.iter().map(value).sum::<f64>();
        // What the scene has the first block has.
        let of_some =
            |value: &dyn Fn(&Self) -> Option<f64>| value(&blocks[0]).map(|_| of(&|means| value(means).unwrap_or(0.0)));
        let power = |i: usize| of_some(&|means| means.power[i]);
        Self {
            drag: of(&|means| means.drag),
            load: of(&|means| means.load),
            hysteresis: of(&|means| means.hysteresis),
            adhesion: of(&|means| means.adhesion),
            contact: of(&|means| means.contact),
            fine: of_some(&|means| means.fine),
            real_area: of_some(&|means| means.real_area),
            power: [0, 1, 2, 3].map(power),
            w: of(&|means| means.w),
            acceleration: of(&|means| means.acceleration),
        }
    }
}

/// The blocks in which a layer slides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Blocks {
    /// Speed of the carrier along x, m/s.
    pub(super) speed: f64,
    /// Length of a block, m.
    pub(super) length: f64,
    /// Samples of a block.
    samples: u32,
    /// u at the start, m.
    start: f64,
    /// Longest distance from there, m; infinite on a periodic profile.
    pub(super) longest: f64,
}

impl Blocks {
    /// Those of a layer over the profile of `scene` at `speed` (m/s).
    pub(super) fn new(scene: &Scene, speed: f64) -> Self {
        let (first, last) = ends(scene);
        let layer = scene.layer.spacing * scene.layer.masses as f64;
        let flat = scene.surface.z().iter().all(|z| *z == scene.surface.z()[0]);
        let period = last - first;
        let whole = scene.surface.is_periodic() && !flat && period <= LONGEST_PERIOD * layer;
        let block = if whole { period } else { layer };
        let points = block / period * scene.surface.x().len() as f64;
        let samples = points.clamp(SAMPLES.0, SAMPLES.1) as u32;
        if flat || scene.surface.is_periodic() {
            return Self { speed, length: block, samples, start: 0.0, longest: f64::INFINITY };
        }
        let longest = (period - layer + scene.layer.spacing).max(0.0);
        Self { speed, length: block, samples, start: first - scene.layer.origin, longest }
    }
}

impl Blocks {
    /// Whether the profile is long enough for so many of them.
    pub(super) fn has_room(&self, blocks: f64) -> bool {
        blocks * self.length <= self.longest
    }
}

/// A layer that is to slide.
#[derive(Clone, Copy, Debug)]
pub(super) struct Layer<'a> {
    pub(super) scene: &'a Scene,
    pub(super) blocks: Blocks,
    /// What may stop its runs.
    pub(super) interrupt: Option<&'a Interrupt>,
}

impl Layer<'_> {
    fn simulation(&self, start: &Start) -> Result<Simulation, SimulationError> {
        let mut simulation = Simulation::new(self.scene, start)?;
        simulation.set_interrupt(self.interrupt.cloned());
        Ok(simulation)
    }
}

#[derive(Debug)]
pub(super) struct Slide {
    simulation: Simulation,
    blocks: Blocks,
    sampled: Vec<Variable>,
    integrated: Vec<Variable>,
    /// Times of the samples within a block, s.
    times: Vec<f64>,
    /// Mean elongations of the Maxwell springs over the last block, m.
    elongations: Vec<f64>,
    /// Blocks slid, fractions included.
    slid: f64,
}

impl Slide {
    /// Starts at the displacement `w` (m), relaxed and at full speed.
    pub(super) fn new(layer: Layer<'_>, w: f64) -> Result<Self, SimulationError> {
        let Layer { scene, blocks, .. } = layer;
        let simulation = layer.simulation(&Start { u: blocks.start, u_rate: blocks.speed, w, ..Start::default() })?;
        let duration = blocks.length / blocks.speed;
        Ok(Self {
            elongations: vec![0.0; simulation.maxwell_elongations().len()],
            simulation,
            blocks,
            sampled: chosen(scene, &SAMPLED),
            integrated: chosen(scene, &INTEGRATED),
            times: (1..=blocks.samples).map(|i| duration * (f64::from(i) / f64::from(blocks.samples))).collect(),
            slid: 0.0,
        })
    }

    /// Time since the start, s.
    pub(super) fn time(&self) -> f64 {
        self.simulation.time()
    }

    /// Distance slid, m.
    pub(super) fn distance(&self) -> f64 {
        self.slid * self.blocks.length
    }

    /// Whether the profile is long enough for so many more blocks.
    pub(super) fn has_room(&self, blocks: f64) -> bool {
        self.blocks.has_room(self.slid + blocks)
    }

    /// Slides over a fraction of a block while w changes by `dw` (m).
    pub(super) fn press(&mut self, fraction: f64, dw: f64) -> Result<(), SimulationError> {
        let duration = fraction * self.blocks.length / self.blocks.speed;
        self.slid += fraction;
        self.simulation.advance(&Motion {
            duration,
            u: rate(self.blocks.speed),
            w: rate(dw / duration),
            ..Motion::default()
        })
    }

    /// Slides over one block with w held, or the load on the carrier.
    pub(super) fn block(&mut self) -> Result<BlockMeans, SimulationError> {
        let duration = self.blocks.length / self.blocks.speed;
        let motion = Motion { duration, u: rate(self.blocks.speed), w: Path::default(), ..Motion::default() };
        let (mut values, mut sums) = (vec![0.0; self.sampled.len()], vec![0.0; self.sampled.len()]);
        self.elongations.fill(0.0);
        let (before, rate_before) = (self.energies(), self.simulation.snapshot().carrier.z.speed);
        let (mut w, mut w_rate) = (0.0, 0.0);
        let (sampled, elongations) = (&self.sampled, &mut self.elongations);
        self.simulation.advance_observed(&motion, None, &self.times, |_, snapshot| {
            snapshot.evaluate(sampled, &mut values);
            add(&mut sums, &values);
            add(elongations, &snapshot.state().maxwell);
            w += snapshot.displacement.z;
            w_rate = snapshot.carrier.z.speed;
        })?;
        self.slid += 1.0;
        let share = 1.0 / f64::from(self.blocks.samples);
        self.elongations.iter_mut().chain(&mut sums).for_each(|sum| *sum *= share);
        let means = SAMPLED.map(|output| value_of(output, sampled, &sums));
        let gain = self.energies();
        let mean = |i: usize| Some((gain[i]? - before[i]?) / duration);
        let [load, hysteresis, adhesion, contact] = [0, 1, 2, 3].map(|i| means[i].unwrap_or(0.0));
        let (drag, power) = (mean(0).unwrap_or(0.0) / self.blocks.speed, [1, 2, 3, 4].map(mean));
        Ok(BlockMeans {
            drag,
            load,
            hysteresis: -hysteresis,
            adhesion: -adhesion,
            contact,
            fine: means[4].map(|force| -force),
            real_area: means[5],
            power,
            w: share * w,
            acceleration: (w_rate - rate_before) / duration,
        })
    }

    /// Moves the slow dashpots to where they will be in steady motion, by the means of the last block. Returns what the
    /// vertical ones bore of F_z, N.
    pub(super) fn relax(&mut self) -> f64 {
        self.simulation.relax_dashpots(&self.elongations, self.blocks.length / self.blocks.speed)
    }

    /// [Relaxes](Self::relax) the dashpots under a carrier whose load is held: it moves to where springs of this
    /// `stiffness` (N/m) bear that force in their place.
    pub(super) fn relax_under_load(&mut self, stiffness: f64) -> f64 {
        let borne = self.relax();
        if stiffness > 0.0 {
            self.simulation.lower_carrier(borne / stiffness);
        }
        borne
    }

    fn energies(&mut self) -> [Option<f64>; INTEGRATED.len()] {
        let mut values = vec![0.0; self.integrated.len()];
        self.simulation.evaluate(&self.integrated, &mut values);
        INTEGRATED.map(|output| value_of(output, &self.integrated, &values))
    }
}

fn rate(rate: f64) -> Path {
    Path { rate, ..Path::default() }
}

/// The variables of the scene that give these outputs, in this order; a channel that the scene cannot have has none.
fn chosen(scene: &Scene, outputs: &[Output]) -> Vec<Variable> {
    let all = variables(scene);
    outputs.iter().filter_map(|output| all.iter().find(|variable| variable.output == *output).cloned()).collect()
}

/// The value of an output among those of `variables`; `None` where they lack it.
fn value_of(output: Output, variables: &[Variable], values: &[f64]) -> Option<f64> {
    variables.iter().position(|variable| variable.output == output).map(|i| values[i])
}

fn add(sums: &mut [f64], values: &[f64]) {
    sums.iter_mut().zip(values).for_each(|(sum, value)| *sum += value);
}

/// The tangential stiffness: slope of |F_x| over u as the relaxed layer is set in motion from stick, N/m; `None` where
/// there is no friction, or where the layer does not come to its load.
pub(super) fn tangential_stiffness(
    layer: Layer<'_>,
    mut search: LoadSearch,
    frequency: f64,
) -> Result<Option<f64>, SimulationError> {
    if layer.scene.friction.is_none() {
        return Ok(None);
    }
    let forces = chosen(layer.scene, &[Output::ForceX, Output::ForceZ]);
    for _ in 0..TRIES {
        let mut simulation = at_rest(layer, search.w, REST / frequency)?;
        let mut values = [0.0; 2];
        simulation.evaluate(&forces, &mut values);
        let [before, load] = values;
        if (load / search.target - 1.0).abs() <= LOAD_AT_REST {
            return slope(&mut simulation, layer.blocks, &forces, before).map(Some);
        }
        let _ = search.change(load, 0.0);
    }
    Ok(None)
}

/// The layer at rest at w (m) after some time (s), its dashpots relaxed.
fn at_rest(layer: Layer<'_>, w: f64, duration: f64) -> Result<Simulation, SimulationError> {
    let mut simulation = layer.simulation(&Start { u: layer.blocks.start, w, ..Start::default() })?;
    for _ in 0..RELAXATIONS {
        simulation.advance(&Motion { duration, u: Path::default(), w: Path::default(), ..Motion::default() })?;
        let elongations = simulation.maxwell_elongations().to_vec();
        simulation.relax_dashpots(&elongations, 0.0);
    }
    simulation.advance(&Motion { duration, u: Path::default(), w: Path::default(), ..Motion::default() })?;
    Ok(simulation)
}

/// Slope of the straight line from F_x = `before` (N) that fits -F_x, the first of `forces`, best, N/m.
fn slope(
    simulation: &mut Simulation,
    blocks: Blocks,
    forces: &[Variable],
    before: f64,
) -> Result<f64, SimulationError> {
    let duration = STIFFNESS_DISTANCE.min(STIFFNESS_SHARE * blocks.length) / blocks.speed;
    let samples = STIFFNESS_SAMPLES;
    let share = |i: u32| if i == samples { 1.0 } else { f64::from(i) / f64::from(samples) };
    let times: Vec<f64> = (1..=samples).map(|i| duration * share(i)).collect();
    let (mut products, mut squares, mut values) = (0.0, 0.0, [0.0; 2]);
    let motion = Motion { duration, u: rate(blocks.speed), w: Path::default(), ..Motion::default() };
    simulation.advance_observed(&motion, None, &times, |time, now| {
        now.evaluate(forces, &mut values);
        let u = blocks.speed * time;
        products += u * (before - values[0]);
        squares += u * u;
    })?;
    Ok(products / squares)
}
