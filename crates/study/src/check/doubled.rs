//! The patch beside one of twice as many elements along and across, in the poses and along the motions of the check;
//! with a tread also rolling, where cells enter and leave.

use asperity::patch::{Patch, PatchOutput, PatchVariable};
use asperity::scene::{NotDoubled, PatchGroup};

use super::measure::{COMPONENTS, SLIDING_DISTANCE, Wrench, WrenchSeries, along, percentages};
use super::patch::{Drag, PatchCheck, table};
use super::tilt::TiltedFace;
use crate::decimals::real;
use crate::error::Error;
use crate::progress::{Counter, Watch};

/// The outputs of [`COMPONENTS`].
const OUTPUTS: [PatchOutput; COMPONENTS.len()] = [
    PatchOutput::Force(0),
    PatchOutput::Force(2),
    PatchOutput::Moment(0),
    PatchOutput::Moment(1),
    PatchOutput::Moment(2),
];

/// The speed of a rolling tread over that of its slip.
const ROLLING: f64 = 10.0;
/// Rows of rolling, and how often the tread passes the contact in them.
const ROLLING_ROWS: u32 = 200;
const PASSAGES: f64 = 2.0;

/// The finer patch and the patch.
#[derive(Debug)]
pub struct Doubled {
    /// Elements of the finer one along and across.
    grid: (usize, usize),
    /// In steady sliding, by speed.
    pub steady: WrenchSeries,
    to_and_fro: WrenchSeries,
    /// Without a tread, empty.
    rolling: WrenchSeries,
}

impl Doubled {
    /// Drags both; says why there is no finer patch.
    ///
    /// # Errors
    /// Where a patch cannot be moved, or `watch` stops it.
    pub fn run(check: &PatchCheck, watch: &Watch<'_>) -> Result<Result<Self, NotDoubled>, Error> {
        let finer = match check.patch.doubled() {
            Ok(finer) => finer,
            Err(reason) => return Ok(Err(reason)),
        };
        let rolling = if finer.has_tread() { ROLLING_ROWS as usize } else { 0 };
        let steps = 2 * (check.faces.len() + check.motion.steps().count() + rolling);
        let counter = Counter::new(watch, "of the patch with nx, ny doubled", steps);
        let grid = finer.grid().unwrap_or_default();
        let fine = WrenchCourse::run(check, &finer, &counter)?;
        let coarse = WrenchCourse::run(check, &check.patch, &counter)?;
        let pair = |fine: Vec<Wrench>, coarse| {
            let sizes = fine.clone();
            WrenchSeries::new(fine, coarse, &sizes, check.lever)
        };
        Ok(Ok(Self {
            grid,
            steady: pair(fine.steady, coarse.steady),
            to_and_fro: pair(fine.to_and_fro, coarse.to_and_fro),
            rolling: pair(fine.rolling, coarse.rolling),
        }))
    }

    /// By how much the wrench changes.
    pub fn summary(&self, check: &PatchCheck) -> Vec<String> {
        let (nx, ny) = self.grid;
        let shares = self.steady.shares();
        let line =
            |(face, share): (&TiltedFace, Wrench)| format!("at {} m/s: {}", real(face.speed), percentages(share));
        let mut texts = vec![format!("the whole patch beside one of {nx} by {ny} elements, over its largest values")];
        texts.extend(check.faces.iter().zip(shares).map(line));
        if check.motion.length > 0.0 {
            texts.extend(along("to and fro", &self.to_and_fro));
        }
        if !self.rolling.reference.is_empty() {
            let speed = check.middle().speed;
            let rolling = format!("rolling at {} m/s, slipping at {} m/s", real(ROLLING * speed), real(speed));
            texts.extend(along(&rolling, &self.rolling));
        }
        texts
    }

    /// The tables of the finer patch and of the patch along the motion to and fro.
    pub fn tables(&self, check: &PatchCheck) -> [String; 2] {
        [&self.to_and_fro.reference, &self.to_and_fro.other].map(|rows| table(check.motion, rows))
    }
}

/// The wrench of a patch.
struct WrenchCourse {
    /// By speed.
    steady: Vec<Wrench>,
    /// Row by row.
    to_and_fro: Vec<Wrench>,
    /// Row by row.
    rolling: Vec<Wrench>,
}

impl WrenchCourse {
    fn run(check: &PatchCheck, patch: &Patch, counter: &Counter<'_>) -> Result<Self, Error> {
        let patch = patch.with_groups(vec![PatchGroup::Forces]);
        let slide = |face: &TiltedFace| {
            let step = (SLIDING_DISTANCE / face.speed, face.speed);
            let rows = rows(&patch, Drag::new(&patch, face, face.speed)?, std::iter::once(step), counter)?;
            Ok(rows[rows.len() - 1])
        };
        let steady = check.faces.iter().map(slide).collect::<Result<_, Error>>()?;
        let face = check.middle();
        let to_and_fro = rows(&patch, Drag::new(&patch, face, 0.0)?, check.motion.steps(), counter)?;
        let rolling = if patch.has_tread() { roll(&patch, face, length(&check.patch), counter)? } else { Vec::new() };
        Ok(Self { steady, to_and_fro, rolling })
    }
}

/// The wrench as a tread rolls through a contact of some `length` (m) and slips at the speed of a face.
fn roll(patch: &Patch, face: &TiltedFace, length: f64, counter: &Counter<'_>) -> Result<Vec<Wrench>, Error> {
    let (speed, tread) = ((1.0 + ROLLING) * face.speed, ROLLING * face.speed);
    let duration = PASSAGES * length / tread / f64::from(ROLLING_ROWS);
    rows(patch, Drag::rolling(patch, face, speed, tread)?, (0..ROLLING_ROWS).map(|_| (duration, speed)), counter)
}

/// The wrench at the start and after each step.
fn rows(
    patch: &Patch,
    mut drag: Drag,
    steps: impl Iterator<Item = (f64, f64)>,
    counter: &Counter<'_>,
) -> Result<Vec<Wrench>, Error> {
    let variables = chosen(patch);
    let mut rows = vec![values(&mut drag, &variables)];
    for step in steps {
        drag.advance(step)?;
        rows.push(values(&mut drag, &variables));
        counter.step()?;
    }
    Ok(rows)
}

/// From the first element to the last along x, m.
fn length(patch: &Patch) -> f64 {
    let x = || patch.elements().map(|element| element.place[0]);
    x().fold(f64::NEG_INFINITY, f64::max) - x().fold(f64::INFINITY, f64::min)
}

fn chosen(patch: &Patch) -> Vec<PatchVariable> {
    let all = patch.variables();
    OUTPUTS.iter().filter_map(|output| all.iter().find(|variable| variable.output == *output).cloned()).collect()
}

fn values(drag: &mut Drag, variables: &[PatchVariable]) -> Wrench {
    let mut values = [0.0; COMPONENTS.len()];
    drag.run.evaluate(variables, &mut values);
    values
}
