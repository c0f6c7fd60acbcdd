//! Steady rolling of a tread at a load: the height at which it bears that, the speed at which it rolls freely, and means
//! of forces over the time in which a cell passes.
//!
//! A tread is renewed as it passes: after one passage its forces repeat themselves from cell to cell. Their means over the
//! next two cells say whether they do.

use asperity::math::root_between;
use asperity::patch::{Patch, PatchMotion, PatchOutput, PatchRun, PatchStart, PatchVariable, Pose};
use asperity::scene::{FaceShape, PatchGroup};

use crate::error::Error;
use crate::progress::{Stop, Stopped};

/// Steps in which a cell passes: always as many, since what a cell has behind it depends on them in second order.
const STEPS: u32 = 4;
/// Passages after which what still changes is not steady.
const MOST_PASSAGES: usize = 4;
/// Most that means may change from one cell to the next, over the load and what it makes with length and speed.
const STEADY: f64 = 1e-4;
/// Most that the warmest element may warm meanwhile, K: beyond its table friction no longer tells.
const WARMED: f64 = 1e-2;
/// How near a load is found, over itself.
const LOAD: f64 = 1e-7;
/// How far below the touch a height is looked for first, m.
const FIRST_DEPTH: f64 = 1e-6;
/// Doublings of that twice over: down to kilometres.
const MOST_DEPTHS: usize = 16;
/// Between these speeds of the tread over that of travel it rolls freely.
const FREE: (f64, f64) = (0.5, 2.0);

/// The means of a tread that rolls steadily. Axes are those of ISO 8855 and, as the wheel stands upright, of ISO-W.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rolling {
    /// The height of the pose's point over the ground, m.
    pub height: f64,
    /// The speed of the tread, m/s.
    pub transport_speed: f64,
    /// Forces of the ground on the tread along x, y and z, N.
    pub force: [f64; 3],
    /// The aligning moment, about z, N m.
    pub moment_z: f64,
    /// Share of the elements in contact that slip.
    pub sliding: f64,
    /// What friction turns into heat, W.
    pub power: f64,
    /// Share of the load that elements bear beyond the pressures of the table.
    pub beyond: f64,
    /// The nominal area of contact over the width of the tread, m.
    pub contact_length: f64,
    /// The temperature of the warmest element, K, of a patch with heat.
    pub warmest: Option<f64>,
}

impl Rolling {
    /// The force along the ground over the load.
    pub fn friction(&self) -> f64 {
        let [x, y, z] = self.force;
        x.hypot(y) / z
    }
}

/// How a wheel moves: its axle along x and y, m/s, the tread, m/s, and the temperature, K.
#[derive(Clone, Copy, Debug)]
pub(super) struct Motion {
    pub(super) velocity: [f64; 2],
    pub(super) transport_speed: f64,
    pub(super) temperature: f64,
}

/// Rolls a tread.
#[derive(Debug)]
pub(super) struct Roller<'a> {
    patch: Patch,
    variables: Vec<PatchVariable>,
    length: f64,
    width: f64,
    cells: usize,
    /// Whether the arc has to be longer than the contact.
    is_cylinder: bool,
    stop: &'a Stop,
}

/// What is read of a run.
const OUTPUTS: [PatchOutput; 10] = [
    PatchOutput::Force(0),
    PatchOutput::Force(1),
    PatchOutput::Force(2),
    PatchOutput::Moment(2),
    PatchOutput::Power,
    PatchOutput::Count,
    PatchOutput::Sticking,
    PatchOutput::Beyond,
    PatchOutput::NominalArea,
    PatchOutput::LargestTemperature,
];

impl<'a> Roller<'a> {
    /// Of a patch with a tread.
    ///
    /// # Errors
    /// Where it has none.
    pub(super) fn new(patch: &Patch, stop: &'a Stop) -> Result<Self, Error> {
        let (FaceShape::Flat(grid) | FaceShape::Cylinder { grid, .. }) = patch.shape() else { return Err(no_tread()) };
        if !patch.has_tread() {
            return Err(no_tread());
        }
        let patch = patch.with_groups(vec![PatchGroup::Forces, PatchGroup::Dissipation, PatchGroup::Contact]);
        let variables = patch.variables();
        let variables =
            OUTPUTS.iter().filter_map(|&output| variables.iter().find(|variable| variable.output == output));
        Ok(Self {
            length: grid.length,
            width: grid.width,
            cells: grid.nx,
            is_cylinder: matches!(patch.shape(), FaceShape::Cylinder { .. }),
            variables: variables.cloned().collect(),
            stop,
            patch,
        })
    }

    /// The speed of the tread over that of travel (m/s) straight ahead at which F_x is 0, and a height (m) near to that there.
    ///
    /// # Errors
    /// Where there is none, the load is not borne, or it is stopped.
    pub(super) fn free(&self, load: f64, speed: f64, temperature: f64) -> Result<(f64, f64), Error> {
        let mut height = None;
        let mut force = |ratio: f64| -> Result<f64, Error> {
            let motion = Motion { velocity: [speed, 0.0], transport_speed: ratio * speed, temperature };
            let rolling = self.at_load(&motion, load, height)?;
            height = Some(rolling.height);
            Ok(above(rolling.force[0] / load, LOAD))
        };
        let ends = [(FREE.0, force(FREE.0)?), (FREE.1, force(FREE.1)?)];
        if ends[0].1 * ends[1].1 > 0.0 {
            let problem = "rolls freely at no speed: F_x has one sign at half and at twice that of travel";
            return Err(Error::run(format!("the tread {problem}")));
        }
        let ratio = root(force, ends, 1e-9)?;
        Ok((ratio, height.unwrap_or_default()))
    }

    /// The wheel at the height at which it bears a load (N); `guess` is one near to it, m.
    ///
    /// # Errors
    /// Where no height bears that, rolling is not steady there, or it is stopped.
    pub(super) fn at_load(&self, motion: &Motion, load: f64, guess: Option<f64>) -> Result<Rolling, Error> {
        let top = self.patch.clear_height();
        let off = |height: f64| Ok(above(self.load(motion, height)? / load - 1.0, LOAD));
        let start = guess.unwrap_or(top - FIRST_DEPTH);
        let mut step = if guess.is_some() { 1e-3 * (top - start) } else { top - start };
        let mut ends = [(start, off(start)?); 2];
        for _ in 0..MOST_DEPTHS {
            if ends[1].1 == 0.0 || ends[0].1 * ends[1].1 < 0.0 {
                break;
            }
            let height = ends[1].0 + step.copysign(ends[1].1);
            ends = [ends[1], (height, off(height)?)];
            step *= 4.0;
        }
        if ends[0].1 * ends[1].1 > 0.0 {
            return Err(Error::run(format!("the tread bears {load} N at no height")));
        }
        let height = root(off, ends, 1e-7 * (top - ends[1].0).abs())?;
        let rolling = self.steady(motion, height)?;
        match self.patch.heat() {
            // The search has left them out.
            None if (rolling.force[2] / load - 1.0).abs() > STEADY => Err(not_steady()),
            _ => Ok(rolling),
        }
    }

    /// The load (N) at a height (m). It depends on the way before only by heat.
    fn load(&self, motion: &Motion, height: f64) -> Result<f64, Error> {
        if self.patch.heat().is_some() {
            return Ok(self.steady(motion, height)?.force[2]);
        }
        let mut run = self.run(motion, height)?;
        self.pass(&mut run, motion, 1)?;
        Ok(self.mean(&mut run, motion)?.force[2])
    }

    /// Rolls at a height (m) until means no longer change.
    fn steady(&self, motion: &Motion, height: f64) -> Result<Rolling, Error> {
        let mut run = self.run(motion, height)?;
        self.pass(&mut run, motion, self.cells + 1)?;
        let mut before = self.mean(&mut run, motion)?;
        for _ in 0..MOST_PASSAGES {
            let now = self.mean(&mut run, motion)?;
            if self.is_like(&before, &now, motion) {
                let is_short = self.is_cylinder && now.contact_length > (1.0 - 1e-9) * self.length;
                let problem = "the contact reaches both ends of the arc: expected a longer one";
                return if is_short { Err(Error::run(problem)) } else { Ok(now) };
            }
            self.pass(&mut run, motion, self.cells)?;
            before = self.mean(&mut run, motion)?;
        }
        Err(not_steady())
    }

    fn is_like(&self, before: &Rolling, now: &Rolling, motion: &Motion) -> bool {
        let load = now.force[2].abs();
        let speed = motion.velocity[0].hypot(motion.velocity[1]);
        let warmed = now.warmest.zip(before.warmest).map_or(0.0, |(new, old)| (new - old).abs());
        let forces = before.force.into_iter().zip(now.force).all(|(old, new)| (old - new).abs() <= STEADY * load);
        forces
            && warmed <= WARMED
            && (before.moment_z - now.moment_z).abs() <= STEADY * load * self.length
            && (before.power - now.power).abs() <= STEADY * load * speed
    }

    fn run(&self, motion: &Motion, height: f64) -> Result<PatchRun, Error> {
        let start = PatchStart {
            pose: Pose { place: [0.0, 0.0, height], ..Pose::default() },
            rates: rates(motion),
            transport_speed: motion.transport_speed,
            temperature: motion.temperature,
            ..PatchStart::default()
        };
        let mut run = PatchRun::new(&self.patch, &start)?;
        // So that no step ends just where a cell begins to enter, on either side of it by rounding.
        self.go(&mut run, motion, 0.5)?;
        Ok(run)
    }

    /// The time in which a cell passes, s; of a tread that stands that in which the wheel goes on by its contact.
    fn cell_time(&self, motion: &Motion) -> f64 {
        match motion.transport_speed.abs() {
            0.0 => self.length / motion.velocity[0].hypot(motion.velocity[1]),
            speed => self.length / self.cells as f64 / speed,
        }
    }

    /// Lets so many cells pass, one at least; of a tread that stands, one time.
    fn pass(&self, run: &mut PatchRun, motion: &Motion, cells: usize) -> Result<(), Error> {
        let steps = STEPS as usize * if motion.transport_speed == 0.0 { 1 } else { cells };
        (0..steps).try_for_each(|_| self.go(run, motion, 1.0))
    }

    /// Takes a step, or a share of it.
    fn go(&self, run: &mut PatchRun, motion: &Motion, share: f64) -> Result<(), Error> {
        if self.stop.go_on().is_break() {
            return Err(Stopped.into());
        }
        let Motion { transport_speed, temperature, .. } = *motion;
        let duration = share * self.cell_time(motion) / f64::from(STEPS);
        Ok(run.advance(&PatchMotion { duration, rates: rates(motion), transport_speed, temperature })?)
    }

    /// Means over the time of a cell.
    fn mean(&self, run: &mut PatchRun, motion: &Motion) -> Result<Rolling, Error> {
        let (mut sums, mut values) = ([0.0; OUTPUTS.len()], [0.0; OUTPUTS.len()]);
        for _ in 0..STEPS {
            self.go(run, motion, 1.0)?;
            run.evaluate(&self.variables, &mut values[..self.variables.len()]);
            sums.iter_mut().zip(values).for_each(|(sum, value)| *sum += value / f64::from(STEPS));
        }
        let [x, y, z, moment_z, power, count, sticking, beyond, area, warmest] = sums;
        Ok(Rolling {
            height: run.pose().place[2],
            transport_speed: motion.transport_speed,
            force: [x, y, z],
            moment_z,
            sliding: if count > 0.0 { 1.0 - sticking / count } else { 0.0 },
            power,
            beyond,
            contact_length: area / self.width,
            warmest: self.patch.heat().map(|_| warmest),
        })
    }
}

fn rates(motion: &Motion) -> [f64; 6] {
    let [x, y] = motion.velocity;
    [x, y, 0.0, 0.0, 0.0, 0.0]
}

fn no_tread() -> Error {
    Error::scene("expected a patch with transport = true, whose tread runs through the contact")
}

fn not_steady() -> Error {
    Error::run("not steady")
}

/// The number, or 0 where it is no larger than a tolerance.
fn above(number: f64, tolerance: f64) -> f64 {
    if number.abs() <= tolerance { 0.0 } else { number }
}

/// A root between two ends of a function that may fail.
fn root(mut f: impl FnMut(f64) -> Result<f64, Error>, ends: [(f64, f64); 2], tolerance: f64) -> Result<f64, Error> {
    if let Some((place, _)) = ends.into_iter().find(|(_, value)| *value == 0.0) {
        return Ok(place);
    }
    let mut failed = None;
    let value = |place: f64| {
        f(place).unwrap_or_else(|error| {
            failed = Some(error);
            // A root ends the search.
            0.0
        })
    };
    let place = root_between(value, ends, tolerance);
    failed.map_or(Ok(place), Err)
}
