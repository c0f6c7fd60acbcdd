//! A layer that slides at constant speed, block by block.

use asperity::outputs::{Output, Variable, variables};
use asperity::scene::{Path, Scene};
use asperity::simulation::{Motion, Simulation, SimulationError, Start};

/// What is sampled at even times of a block; its mean is exact up to the frequency of the samples.
const SAMPLED: [Output; 4] = [Output::ForceZ, Output::Hysteresis, Output::Adhesion, Output::ContactRatio];
/// What the run itself adds up; a block's mean is the difference over its duration.
const ADDED: [Output; 5] =
    [Output::InputEnergy, Output::DamperEnergy, Output::MaxwellEnergy, Output::FrictionEnergy, Output::ImpactEnergy];

/// Means over one block.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Means {
    /// |F_x|, counted positive against the motion: the carrier's work over the way, N.
    pub(super) drag: f64,
    /// F_z, N.
    pub(super) load: f64,
    /// Tangential force of the normal forces on the slopes, against the motion, N.
    pub(super) hysteresis: f64,
    /// Tangential force of the friction in the contacts, against the motion, N.
    pub(super) adhesion: f64,
    /// Masses in contact over all masses, 1.
    pub(super) contact: f64,
    /// Power lost in dampers, Maxwell elements, friction and impacts, W; none for a channel that the scene cannot have.
    pub(super) power: [Option<f64>; 4],
}

impl Means {
    /// Over several blocks, at least one.
    pub(super) fn mean(blocks: &[Self]) -> Self {
        let share = 1.0 / blocks.len() as f64;
        let of = |value: &dyn Fn(&Self) -> f64| share * blocks.iter().map(value).sum::<f64>();
        let power = |i: usize| blocks[0].power[i].map(|_| of(&|means| means.power[i].unwrap_or(0.0)));
        Self {
            drag: of(&|means| means.drag),
            load: of(&|means| means.load),
            hysteresis: of(&|means| means.hysteresis),
            adhesion: of(&|means| means.adhesion),
            contact: of(&|means| means.contact),
            power: [0, 1, 2, 3].map(power),
        }
    }
}

/// How a layer is slid: what all its blocks have in common.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Way {
    /// Of the carrier along x, m/s.
    pub(super) speed: f64,
    /// Length of a block, m.
    pub(super) block: f64,
    /// Samples a block.
    pub(super) samples: u32,
    /// Where the carrier starts, m.
    pub(super) start: f64,
    /// How far it may go from there, m; infinite on a periodic profile.
    pub(super) end: f64,
}

/// A layer that slides.
#[derive(Debug)]
pub(super) struct Slide {
    simulation: Simulation,
    way: Way,
    sampled: Vec<Variable>,
    added: Vec<Variable>,
    times: Vec<f64>,
    /// Mean elongations of the Maxwell springs over the last block, m.
    elongations: Vec<f64>,
    /// Blocks gone, parts of one included.
    gone: f64,
}

impl Slide {
    /// Starts at the displacement `w` (m), pressed long ago, at full speed.
    pub(super) fn new(scene: &Scene, way: Way, w: f64) -> Result<Self, SimulationError> {
        let start = Start { u: way.start, u_rate: way.speed, w, ..Start::default() };
        let simulation = Simulation::new(scene, &start)?;
        let duration = way.block / way.speed;
        Ok(Self {
            elongations: vec![0.0; simulation.maxwell_elongations().len()],
            simulation,
            way,
            sampled: chosen(scene, &SAMPLED),
            added: chosen(scene, &ADDED),
            times: (1..=way.samples).map(|i| duration * (f64::from(i) / f64::from(way.samples))).collect(),
            gone: 0.0,
        })
    }

    /// Time since the start, s.
    pub(super) fn time(&self) -> f64 {
        self.simulation.time()
    }

    /// How far the carrier has gone, m.
    pub(super) fn distance(&self) -> f64 {
        self.gone * self.way.block
    }

    /// Whether there is room for so many more blocks.
    pub(super) fn has_room(&self, blocks: f64) -> bool {
        (self.gone + blocks) * self.way.block <= self.way.end
    }

    /// Slides on over a part of a block while w goes on by `dw` (m).
    pub(super) fn press(&mut self, part: f64, dw: f64) -> Result<(), SimulationError> {
        let duration = part * self.way.block / self.way.speed;
        self.gone += part;
        self.simulation.advance(&Motion { duration, u: rate(self.way.speed), w: rate(dw / duration) })
    }

    /// Slides over one block with w held.
    pub(super) fn block(&mut self) -> Result<Means, SimulationError> {
        let duration = self.way.block / self.way.speed;
        let motion = Motion { duration, u: rate(self.way.speed), w: Path::default() };
        let (mut values, mut sums) = (vec![0.0; self.sampled.len()], vec![0.0; self.sampled.len()]);
        self.elongations.fill(0.0);
        let before = self.energies();
        let (sampled, elongations) = (&self.sampled, &mut self.elongations);
        self.simulation.advance_observed(&motion, &self.times, |_, simulation| {
            simulation.evaluate(sampled, &mut values);
            add(&mut sums, &values);
            add(elongations, simulation.maxwell_elongations());
        })?;
        self.gone += 1.0;
        let share = 1.0 / f64::from(self.way.samples);
        self.elongations.iter_mut().chain(&mut sums).for_each(|sum| *sum *= share);
        let gain = self.energies();
        let mean = |i: usize| Some((gain[i]? - before[i]?) / duration);
        let [load, hysteresis, adhesion, contact] = [0, 1, 2, 3].map(|i| sums[i]);
        let (drag, power) = (mean(0).unwrap_or(0.0) / self.way.speed, [1, 2, 3, 4].map(mean));
        Ok(Means { drag, load, hysteresis: -hysteresis, adhesion: -adhesion, contact, power })
    }

    /// Brings the slow dashpots to where the last block says that they will be. Returns what they bore of F_z, N.
    pub(super) fn relax(&mut self) -> f64 {
        self.simulation.relax_dashpots(&self.elongations, self.way.block / self.way.speed)
    }

    fn energies(&mut self) -> [Option<f64>; ADDED.len()] {
        let mut values = vec![0.0; self.added.len()];
        self.simulation.evaluate(&self.added, &mut values);
        let of = |output| self.added.iter().position(|variable| variable.output == output).map(|i| values[i]);
        ADDED.map(of)
    }
}

/// A displacement at constant rate, m/s.
pub(super) fn rate(rate: f64) -> Path {
    Path { rate, ..Path::default() }
}

/// The variables of the scene that give these outputs, in this order; a channel that the scene cannot have has none.
pub(super) fn chosen(scene: &Scene, outputs: &[Output]) -> Vec<Variable> {
    let all = variables(scene);
    outputs.iter().filter_map(|output| all.iter().find(|variable| variable.output == *output).cloned()).collect()
}

fn add(sums: &mut [f64], values: &[f64]) {
    sums.iter_mut().zip(values).for_each(|(sum, value)| *sum += value);
}
