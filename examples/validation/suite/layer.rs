//! Single contacts by the layer of a simulation and an FMU, beside solutions for a half-plane.

use std::f64::consts::PI;

use asperity::scene::{Force, Path, Scene};
use asperity::simulation::{Motion, Start};
use asperity_study::decimals::short;

use super::row::{Claim, Comparison, Entry, Row};
use super::scenes::{begin, even_times, parse, sample, straight};

const FILE: &str = "examples/validation/suite/layer.rs";

/// M_∞ and the cylinder's radius, Pa and m.
const MODULUS: f64 = 2e6;
const RADIUS: f64 = 5e-3;
const MASSES: usize = 512;
/// Of the layer and of the profile's period, and the layer's width, m.
const LENGTH: f64 = 2.56e-3;
const WIDTH: f64 = 1e-2;
/// Of friction.
const COULOMB: f64 = 0.5;

/// A rigid cylinder, once in the length of a layer with links fitted to a half-space; `rest` adds to the scene, `prony` to
/// the rubber.
fn scene(prony: &str, rest: &str) -> Scene {
    let points = 1024;
    let x: Vec<f64> = (0..=points).map(|i| LENGTH * f64::from(i) / f64::from(points)).collect();
    let height = |x: &f64| -(x - 0.5 * LENGTH).abs().min(1.2e-3).powi(2) / (2.0 * RADIUS);
    let z: Vec<f64> = x.iter().map(height).collect();
    parse(&format!(
        "name = 'cylinder'\nlayer = {{ foundation = 'half_space', masses = {MASSES}, spacing = {}, width = {WIDTH}, \
         initial = 'undeformed' }}\nmaterial = {{ density = 1100.0, poisson_ratio = 0.5, viscosity = 50.0, \
         equilibrium_modulus = {}, prony = [{prony}] }}\nsurface = {{ kind = 'points', x = {x:?}, z = {z:?}, periodic = true }}\n\
         solver = {{ method = 'step', relative_tolerance = 1e-4 }}\nfmu = {{ outputs = ['forces', 'contact'] }}\n{rest}",
        LENGTH / MASSES as f64,
        0.75 * MODULUS
    ))
}

/// The half-width (m) of as many masses in contact.
fn half_width(count: f64) -> f64 {
    0.5 * LENGTH * count / MASSES as f64
}

/// Hertz's half-width (m) under a force per width (N/m) on rubber of this compliance, 1/Pa.
fn hertz(force: f64, compliance: f64) -> f64 {
    (4.0 * force * RADIUS * compliance / PI).sqrt()
}

pub const CATTANEO: Entry = Entry {
    title: "A pressed cylinder under a tangential force, by the layer",
    reference: "Hertz 1882, Cattaneo 1938, Mindlin 1949",
    source: "C. Cattaneo, Rend. Accad. Naz. Lincei 27, 1938, 342; R. D. Mindlin, J. Appl. Mech. 16, 1949, 259; K. L. Johnson, \
             Contact Mechanics, 1985, 7.2",
    file: FILE,
    quick: false,
    compare: cattaneo,
};

/// What the layer is pressed by, m.
const PRESSED: [f64; 2] = [6e-6, 24e-6];

/// Pressed by a displacement, then moved along x: what sticks is √(1 - Q/μP) of the contact.
fn cattaneo() -> Comparison {
    let scene = scene("", &format!("friction = {{ coulomb = {COULOMB} }}"));
    let names = ["F_x", "F_z", "contact.count", "contact.sticking"];
    let (press, slide) = (0.02, 0.2);
    let of_depth = |depth: f64| {
        let mut simulation = begin(&scene, &Start::default());
        let pressed = sample(&mut simulation, &scene, &straight(press, 0.0, -depth / press), &[press], &names);
        let moved = sample(&mut simulation, &scene, &straight(slide, 1e-4, 0.0), &even_times(slide, 4000), &names);
        let widths = [hertz(pressed[0][1] / WIDTH, 1.0 / MODULUS), half_width(pressed[0][2])];
        let place = format!("pressed by {} µm", short(1e6 * depth, 2));
        let share = |part: f64| {
            let row = moved.iter().find(|row| row[0].abs() >= part * COULOMB * row[1]).unwrap();
            let name = format!("part that sticks at Q = {part} μP, {place}");
            Row::new(name, [(1.0 - part).sqrt(), row[3] / row[2]], "", Claim::Share(5e-2))
        };
        let width = Row::new(format!("half-width, {place}"), widths.map(|width| 1e6 * width), "µm", Claim::Share(5e-2));
        [width].into_iter().chain([0.1, 0.4, 0.8, 0.95].map(share)).collect::<Vec<_>>()
    };
    Comparison {
        about: format!(
            "A rigid cylinder of 5 mm radius on elastic rubber, {MASSES} masses in a period of 2.56 mm: pressed, then moved along \
             the surface under Coulomb's friction of {COULOMB}."
        ),
        rows: PRESSED.into_iter().flat_map(of_depth).collect(),
        remark: "The layer's links are fitted to the waves of its profile, most of them longer than this contact, and against \
                 shorter ones they are too soft: the contact comes out too wide, and runs and sweeps warn of it \
                 ([foundation.md](foundation.md)). The share that sticks suffers less. The solver of steady sliding has no links."
            .into(),
        ..Comparison::default()
    }
}

pub const RADOK: Entry = Entry {
    title: "A cylinder pressed on viscoelastic rubber, by the layer",
    reference: "Lee and Radok 1960",
    source: "E. H. Lee, J. R. M. Radok, J. Appl. Mech. 27, 1960, 438; K. L. Johnson, Contact Mechanics, 1985, 6.5",
    file: FILE,
    quick: false,
    compare: radok,
};

/// The relaxation time, s, and the glass over the rubber at rest.
const TIME: f64 = 0.1;
const GLASS: f64 = 5.0;

/// Under a load that is held a half-plane's contact is Hertz's by the compliance in creep.
fn radok() -> Comparison {
    let term = format!("{{ modulus = {}, relaxation_time = {TIME} }}", 0.75 * MODULUS * (GLASS - 1.0));
    let scene = scene(&term, "carrier = { z = { mass = 1e-5 } }");
    let mut simulation = begin(&scene, &Start::default());
    let (force, ramp, creep) = (10.0, 1e-3, GLASS * TIME);
    let load = |start: Option<f64>, rate: f64| Force { start, change: Path { rate, ..Path::default() } };
    let motion = |duration: f64, load: Force| Motion { load, ..straight(duration, 0.0, 0.0) };
    sample(&mut simulation, &scene, &motion(ramp, load(Some(0.0), force * WIDTH / ramp)), &[ramp], &[]);
    let parts = [0.03, 0.3, 1.0, 3.0];
    let times = parts.map(|part| part * creep);
    let held = sample(&mut simulation, &scene, &motion(times[3], load(None, 0.0)), &times, &["contact.count"]);
    let row = |((part, time), row): ((f64, f64), &Vec<f64>)| {
        let compliance = (1.0 - (1.0 - 1.0 / GLASS) * (-(time + 0.5 * ramp) / creep).exp()) / MODULUS;
        let widths = [hertz(force, compliance), half_width(row[0])].map(|width| 1e6 * width);
        Row::new(format!("half-width after {} of the time of creep", short(part, 2)), widths, "µm", Claim::Share(5e-2))
    };
    Comparison {
        about: format!(
            "The cylinder of the comparison before under {force} N/m of width, held, on rubber of one relaxation time whose \
             glass is {GLASS} times as stiff."
        ),
        rows: parts.into_iter().zip(times).zip(&held).map(row).collect(),
        remark: "Too wide for the same reason, at every stage of the creep.".into(),
        ..Comparison::default()
    }
}
