//! A block on a spring that sticks and slips.

use std::f64::consts::PI;

use asperity::scene::Scene;
use asperity::simulation::Start;

use super::row::{Claim, Comparison, Curve, Entry, Picture, Row};
use super::scenes::{begin, even_times, parse, sample, straight};

pub const BLOCK: Entry = Entry {
    title: "A block on a spring sticks and slips",
    reference: "closed form, of Popp and Rudolph's oscillators",
    source: "K. Popp, M. Rudolph, J. Vib. Control 10, 2004, 1585 (the oscillator; its limit cycle and its damping in \
             closed form)",
    file: "examples/validation/suite/oscillator.rs",
    quick: true,
    compare: block,
};

/// Of the block: mass, kg, spring, N/m, and load, N.
const MASS: f64 = 1e-3;
const SPRING: f64 = 400.0;
const LOAD: f64 = 1.0;
/// Friction while it slips over the load, and what more holds it, N.
const SLIPS: f64 = 0.2;
const MORE: f64 = 0.15;

/// One mass on flat ground under the load; the carrier is the far end of its spring.
fn scene(shear: &str, damping: f64) -> Scene {
    parse(&format!(
        "name = 'block'\n[layer]\nmasses = 1\nspacing = 1e-3\nmass = {MASS}\nvertical = {{ stiffness = 1e4 }}\n\
         horizontal = {{ stiffness = {SPRING}, damping = {damping} }}\n[surface]\nkind = 'flat'\n\
         [friction]\ncoulomb = {SLIPS}\nrate_shear = {{ {shear} }}\n\
         [solver]\nmethod = 'event'\nrelative_tolerance = 1e-9\n[fmu]\noutputs = ['forces', 'contact', 'elements']\n"
    ))
}

fn block() -> Comparison {
    let shear = format!("force = {MORE}, reference_speed = 1e-9, creep_speed = 1e-9, sharpness = 50.0");
    let scene = scene(&shear, 0.0);
    let (omega, jump) = ((SPRING / MASS).sqrt(), MORE / SPRING);
    let mut rows = Vec::new();
    let mut picture = Vec::new();
    for speed in [0.01, 0.05, 0.2] {
        // Slip ends where V(1 - cos θ) + Δω sin θ is 0, and the spring has then been let go by 2Δ.
        let slipping = 2.0 * (PI - (jump * omega / speed).atan()) / omega;
        let period = slipping + 2.0 * jump / speed;
        let duration = (SLIPS * LOAD + MORE) / SPRING / speed + 12.5 * period;
        let times = even_times(duration, 200_000);
        let start = Start { w: -LOAD / 1e4, u_rate: speed, ..Start::default() };
        let motion = straight(duration, speed, 0.0);
        let found = sample(&mut begin(&scene, &start), &scene, &motion, &times, &["element[1].x", "contact.sticking"]);
        let sticks: Vec<bool> = found.iter().map(|row| row[1] > 0.5).collect();
        let breaks: Vec<usize> = (1..times.len()).filter(|&i| sticks[i - 1] && !sticks[i]).collect();
        let stops: Vec<usize> = (1..times.len()).filter(|&i| !sticks[i - 1] && sticks[i]).collect();
        let (first, last) = (breaks[1], breaks[breaks.len() - 1]);
        let cycles = (breaks.len() - 2) as f64;
        let time = (times[last] - times[first]) / cycles;
        let after = stops.iter().copied().filter(|&stop| stop > first).map(|stop| found[stop][0]).collect::<Vec<_>>();
        let slip = after[0] - found[first - 1][0];
        let what = |quantity: &str| format!("{quantity} at {} mm/s", 1e3 * speed);
        rows.push(Row::new(what("period"), [period, time].map(|t| 1e3 * t), "ms", Claim::Share(1e-3)));
        rows.push(Row::new(
            what("displacement of a slip"),
            [speed * period, slip].map(|x| 1e3 * x),
            "mm",
            Claim::Share(1e-3),
        ));
        if speed == 0.05 {
            let end = (SLIPS * LOAD + MORE) / SPRING / speed + 3.2 * period;
            let rows = times.iter().zip(&found).step_by(100).take_while(|(t, _)| **t < end);
            picture = rows.map(|(t, row)| (1e3 * t, SPRING * (speed * t - row[0]))).collect();
        }
    }
    rows.extend([1.3, 2.0].map(decay));
    let (most, least) = (SLIPS * LOAD + MORE, SLIPS * LOAD - MORE);
    Comparison {
        about: "1 g on a spring of 0.4 N/mm under 1 N: friction 0.35 N at rest, 0.2 N in slip (a shear that falls \
                within 10⁻⁹ m/s). With Δ the difference over the spring's stiffness, a slip lasts 2(π - \
                atan(Δω/V))/ω and lets go 2Δ. The last rows: where friction falls over the speed, damping beyond s = \
                -dT/dv makes the block slide evenly, and swings die out at (d - s)/2m."
            .into(),
        rows,
        pictures: vec![Picture {
            file: "stick-slip.svg",
            caption: "Force of the spring over time at 50 mm/s, between the two forces of the closed form",
            x: "time in ms",
            y: "force of the spring in N",
            is_logarithmic: false,
            curves: vec![
                Curve::line("force at break", vec![(0.0, most), (picture.last().unwrap().0, most)]),
                Curve::line("force at stop", vec![(0.0, least), (picture.last().unwrap().0, least)]),
                Curve::line("asperity", picture),
            ],
        }],
        remark: "Popp and Rudolph's measured curves are not compared: their friction characteristic is of other \
                 materials."
            .into(),
    }
}

/// How fast swings about even sliding at 1 m/s, small from the start, die out with `ratio` times the damping that
/// friction's fall needs.
fn decay(ratio: f64) -> Row {
    let (reference, speed, sharpness) = (1e-2_f64, 1.0_f64, 0.5);
    let decades = (speed / reference).log10();
    let fall =
        MORE * (-sharpness * decades * decades).exp() * 2.0 * sharpness * decades / (speed * std::f64::consts::LN_10);
    let damping = ratio * fall;
    let shear =
        format!("force = {MORE}, reference_speed = {reference}, creep_speed = {reference}, sharpness = {sharpness}");
    let scene = scene(&shear, damping);
    let rate = (damping - fall) / (2.0 * MASS);
    let omega = (SPRING / MASS - rate * rate).sqrt();
    let start = Start { w: -LOAD / 1e4, u_rate: speed, ..Start::default() };
    let mut run = begin(&scene, &start);
    // Until swings are of 1e-4 of the speed.
    run.advance(&straight(9.0 / rate, speed, 0.0)).unwrap();
    let duration = 8.0 * PI / omega;
    let times = even_times(duration, 80_000);
    let found = sample(&mut run, &scene, &straight(duration, speed, 0.0), &times, &["element[1].x"]);
    let place = |i: usize| found[i][0] - speed * times[i];
    let turns = (1..times.len() - 1).filter(|&i| (place(i) - place(i - 1)) * (place(i + 1) - place(i)) < 0.0);
    let turns: Vec<usize> = turns.collect();
    let swing = |i: usize| (place(turns[i + 1]) - place(turns[i])).abs();
    let measured = (swing(0) / swing(4)).ln() / (times[turns[4]] - times[turns[0]]);
    Row::new(format!("decay of swings with a damping of {ratio} s"), [rate, measured], "1/s", Claim::Share(1e-2))
}
