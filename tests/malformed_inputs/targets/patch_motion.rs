//! Motions of small patches: any poses, rates, durations, speeds of the tread and temperatures, numbers or not.

use std::sync::OnceLock;

use arbitrary::{Arbitrary, Unstructured};
use asperity::patch::{Patch, PatchMotion, PatchRun, PatchStart, Pose};

use super::fmu::show;
use super::number::Number;
use super::patches::{Judged, PATCHES, folder, text};

/// Steps of a case.
const MAX_STEPS: usize = 12;
/// Cells of the patches with a tread, m; their durations and speeds go over simple parts of one. And their `refine`.
const CELLS: [f64; 4] = [1.0, 1e-4, 1e-4, 1e-3];
const REFINES: [f64; 4] = [1.0, 2.0, 1.0, 1.0];
/// s and K.
const DURATION: f64 = 1e-3;
const KELVIN: f64 = 295.0;

/// A number of the size that a run goes on with, or any.
#[derive(Clone, Copy, Debug, Arbitrary)]
enum Amount {
    Zero,
    Usual(i8),
    Fine(i8),
    Any(Number),
}

impl Amount {
    /// Around `middle`, in parts of `unit`.
    fn around(self, middle: f64, unit: f64) -> f64 {
        match self {
            Self::Zero => middle,
            Self::Usual(i) => middle + f64::from(i) * unit,
            Self::Fine(i) => middle + f64::from(i) * unit * 1e-6,
            Self::Any(number) => number.value(),
        }
    }
}

#[derive(Debug, Arbitrary)]
struct Case {
    patch: u8,
    start: [Amount; 6],
    rates: Option<[Amount; 6]>,
    speed: Amount,
    kelvin: Option<Amount>,
    steps: Vec<Step>,
}

#[derive(Debug, Arbitrary)]
struct Step {
    /// A part of [`DURATION`], or any number.
    duration: Option<Amount>,
    along: [Amount; 3],
    turn: Option<[Amount; 3]>,
    speed: Option<Amount>,
    kelvin: Option<Amount>,
}

fn patches() -> &'static [Patch] {
    static READ: OnceLock<Vec<Patch>> = OnceLock::new();
    READ.get_or_init(|| {
        let file = folder("motion").join("patch.toml");
        (0..PATCHES.len()).map(|i| Patch::parse(&text(i), &file).unwrap()).collect()
    })
}

/// Places a patch and moves it.
pub fn run(bytes: &[u8]) {
    let Ok(case) = Case::arbitrary_take_rest(Unstructured::new(bytes)) else { return };
    show(&case);
    let number = usize::from(case.patch) % PATCHES.len();
    let (patch, cell) = (&patches()[number], CELLS[number]);
    let kelvin = |amount: Option<Amount>| match (amount, patch.has_temperatures()) {
        (Some(amount), true) => amount.around(KELVIN, 0.1),
        _ => patch.temperature(),
    };
    // A quarter of a cell over the usual duration.
    let speed = |amount: Amount| if patch.has_tread() { amount.around(0.0, 0.25 * cell / DURATION) } else { 0.0 };
    let rates = case.rates.map_or([0.0; 6], |rates| rates.map(|rate| rate.around(0.0, 1e-3)));
    let start = PatchStart {
        time: 0.0,
        pose: Pose::from_coordinates(std::array::from_fn(|i| {
            case.start[i].around(0.0, if i < 3 { 1e-7 } else { 1e-5 })
        })),
        rates,
        transport_speed: speed(case.speed),
        temperature: kelvin(case.kelvin),
    };
    let Ok(run) = PatchRun::new(patch, &start) else { return };
    let mut judged = Judged::new(patch, run);
    for step in case.steps.iter().take(MAX_STEPS) {
        let turn = step.turn.map_or([0.0; 3], |turn| turn.map(|rate| rate.around(0.0, 0.02)));
        let [x, y, z] = step.along;
        let [x, y, z] = [x.around(0.0, 1e-3), y.around(0.0, 1e-2), z.around(0.0, 1e-4)];
        let motion = PatchMotion {
            duration: step.duration.map_or(DURATION, |amount| amount.around(DURATION, DURATION / 64.0)),
            rates: [x, y, z, turn[0], turn[1], turn[2]],
            transport_speed: step.speed.map_or(judged.run.transport_speed(), speed),
            temperature: kelvin(step.kelvin),
        };
        if judged.has_time_for(&motion, cell, REFINES[number]) {
            let _ = judged.advance(&motion);
        }
    }
}
