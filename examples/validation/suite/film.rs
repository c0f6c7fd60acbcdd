//! How a fluid passes the gaps of a contact: ridges of one wave, and rough surfaces pressed on elastic rubber.

use std::f64::consts::TAU;

use asperity::math::{dot, sum};
use asperity_study::steady::{FlowGaps, GridSize, SlidingRubber, SteadySolver};

use super::rough::{GRADIENT, scaled, self_affine, waves};
use super::row::{Claim, Comparison, Entry, Row};
use super::scenes::rubber;

const FILE: &str = "examples/validation/suite/film.rs";

pub const RIDGES: Entry = Entry {
    title: "Leak and drag over ridges of one wave",
    reference: "Reynolds 1886",
    source: "O. Reynolds, Phil. Trans. R. Soc. 177, 1886, 157: his equation over g = 1 + ε cos qx, whose flow along the \
             ridges is the mean of g³ and over them that of g⁻³ inverted",
    file: FILE,
    quick: true,
    compare: ridges,
};

/// Points of the wave.
const POINTS: usize = 512;

/// The gaps 1 + ε cos along x, the sliding over the ridges.
fn gaps_over(amplitude: f64) -> FlowGaps {
    let gap = |i: usize| 1.0 + amplitude * (TAU * (i % POINTS) as f64 / POINTS as f64).cos();
    let gaps: Vec<f64> = (0..4 * POINTS).map(gap).collect();
    FlowGaps::of_map(&gaps, GridSize { nx: POINTS, ny: 4 }, [1.0 / POINTS as f64, 0.25])
}

/// With s = 1 - ε²: mean g³ = 1 + 3ε²/2, mean g⁻² = s^-3/2, mean g⁻³ = (1 + ε²/2) s^-5/2.
fn ridges() -> Comparison {
    let mut rows = Vec::new();
    for amplitude in [0.3, 0.6, 0.9] {
        let (found, square) = (gaps_over(amplitude), f64::powi(amplitude, 2));
        let (along, over) = (1.0 + 1.5 * square, (1.0 - square).powf(2.5) / (1.0 + 0.5 * square));
        let carried = (1.0 - square).powf(-1.5) * over;
        let mut add = |what: &str, expected, found, claim| {
            rows.push(Row::new(format!("{what}, ε = {amplitude}"), [expected, found], "", Claim::Share(claim)));
        };
        add("h_l³ along the ridges", along, found.leak_across.unwrap().powi(3), 1e-9);
        add("h_l³ over them", over, found.leak.powi(3), 1e-9);
        add("h_d over them", carried, found.drag, 3e-4);
    }
    Comparison {
        about: "Gaps of 1 + ε cos qx, 512 points to the wave: the leak gap's cube is 1+3ε²/2 along the ridges, \
                (1-ε²)^(5/2)/(1+ε²/2) over them, the drag gap over them the mean of g⁻² over that of g⁻³."
            .into(),
        rows,
        remark:
            "What flows is as exact as the sum over the points of a wave. What is carried has the harmonic mean of the \
                 gap on the faces between points beside that of its cube, which is of second order in their distance."
                .into(),
        ..Comparison::default()
    }
}

pub const ROUGH: Entry = Entry {
    title: "Leak through a rough contact",
    reference: "an independent program",
    source: "a program of its own for contact and flow, the mean of eight maps of its own",
    file: FILE,
    quick: false,
    compare: rough,
};

/// p/(M h'), and what eight other maps have in the mean: share of contact, h_l³/h_rms³, mean gap over h_rms.
const REFERENCE: [(f64, [f64; 3]); 3] =
    [(0.02, [0.049, 1.49, 1.374]), (0.05, [0.114, 0.315, 0.948]), (0.10, [0.215, 0.034, 0.620])];
const SEEDS: u64 = 8;

/// Contact, leak gap's cube and mean gap, in units of the rms height, of a map at these pressures.
fn of_map(seed: u64) -> Vec<[f64; 3]> {
    let waves = waves(4.0, 32).into_iter().filter(|(m, k, _)| m * m + k * k >= 16).collect();
    let surface = self_affine(&scaled(waves), 8, seed);
    let points = surface.size.points() as f64;
    let height = (dot(&surface.heights, &surface.heights) / points).sqrt();
    let rubber = SlidingRubber::new(&rubber(5e6, 0.49, &[])).unwrap();
    let mut solver = SteadySolver::new(surface);
    let mut at = |pressure: f64| {
        let found = solver.slide(&rubber, 1.0, pressure * GRADIENT * 5e6 / (1.0 - 0.49 * 0.49));
        let (gaps, surface) = (&found.contact.gaps, solver.surface());
        let leak = FlowGaps::of_map(gaps, surface.size, surface.spacing()).leak;
        [found.area, (leak / height).powi(3), sum(gaps) / points / height]
    };
    REFERENCE.map(|(pressure, _)| at(pressure)).into()
}

fn rough() -> Comparison {
    let maps: Vec<Vec<[f64; 3]>> = (1..=SEEDS).map(of_map).collect();
    let mut rows = Vec::new();
    for (i, (pressure, expected)) in REFERENCE.into_iter().enumerate() {
        for (j, what) in ["contact", "h_l³/h_rms³", "mean gap/h_rms"].into_iter().enumerate() {
            let mean = maps.iter().map(|map| map[i][j]).sum::<f64>() / SEEDS as f64;
            let quantity = format!("{what}, p = {pressure} M h'");
            rows.push(Row::new(quantity, [expected[j], mean], "", Claim::Share(0.15)));
        }
    }
    Comparison {
        about: "Isotropic self-affine maps of 4 to 32 waves to the period and no longer ones, H = 0.8, on 256² points, pressed on elastic \
                rubber; the mean of eight. h' is the rms gradient."
            .into(),
        rows,
        ..Comparison::default()
    }
}
