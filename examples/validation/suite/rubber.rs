//! The rubber of a layer alone: creep, relaxation and ramps of a standard linear solid.

use asperity::simulation::Start;

use super::row::{Claim, Comparison, Entry, Row};
use super::scenes::{begin, even_times, loaded, parse, sample, straight};

pub const SOLID: Entry = Entry {
    title: "Creep, relaxation and ramps of a standard linear solid",
    reference: "closed form",
    source: "J. D. Ferry, Viscoelastic Properties of Polymers, 1980, chapter 1",
    file: "examples/validation/suite/rubber.rs",
    quick: true,
    compare: solid,
};

/// c and c_1, N/m, and τ, s.
const SOFT: f64 = 2e3;
const ELEMENT: f64 = 3e3;
const TIME: f64 = 2e-3;
/// Displacement, m, speed, m/s, and load, N.
const PRESSED: f64 = 1e-5;
const SPEED: f64 = 1e-2;
const LOAD: f64 = 0.05;
/// The carrier that creeps: mass, kg, and damping, N s/m.
const MASS: f64 = 1e-4;
const DAMPING: f64 = 8.0;

/// The scene of one mass on flat ground, with more keys.
fn scene(more: &str) -> asperity::scene::Scene {
    parse(&format!(
        "name = 'solid'\n[layer]\nmasses = 1\nspacing = 1e-4\nmass = 1e-6\ninitial = 'undeformed'\n\
         vertical = {{ stiffness = {SOFT}, maxwell = [{{ stiffness = {ELEMENT}, relaxation_time = {TIME} }}] }}\n\
         horizontal = {{ stiffness = 1e3 }}\n[surface]\nkind = 'flat'\n[friction]\ncoulomb = 1.0\n\
         [solver]\nmethod = 'event'\nrelative_tolerance = 1e-12\nabsolute_tolerance = 1e-18\n\
         {more}"
    ))
}

fn solid() -> Comparison {
    let times = even_times(5.0 * TIME, 40);
    let plain = scene("[fmu]\noutputs = ['forces']\n");
    let force = |start: Start, w_rate: f64| -> Vec<f64> {
        let rows = sample(&mut begin(&plain, &start), &plain, &straight(5.0 * TIME, 0.0, w_rate), &times, &["F_z"]);
        rows.into_iter().map(|row| row[0]).collect()
    };
    let relaxed = force(Start { w: -PRESSED, ..Start::default() }, 0.0);
    let ramped = force(Start { w_rate: -SPEED, ..Start::default() }, -SPEED);
    let crept =
        scene(&format!("[carrier.z]\nmass = {MASS}\ndamping = {DAMPING}\nload = 0.0\n[fmu]\noutputs = ['carrier']\n"));
    let mut run = begin(&crept, &Start::default());
    let crept = sample(&mut run, &crept, &loaded(5.0 * TIME, LOAD), &times, &["carrier.w"]);
    let crept: Vec<f64> = crept.into_iter().map(|row| -row[0]).collect();

    let relaxation = |t: f64| PRESSED * (SOFT + ELEMENT * (-t / TIME).exp());
    let ramp = |t: f64| SPEED * (SOFT * t + ELEMENT * TIME * (1.0 - (-t / TIME).exp()));
    let creep = creep();
    let mut rows = Vec::new();
    let mut add = |what: &str, found: &[f64], exact: &dyn Fn(f64) -> f64, unit, scale: f64| {
        let whole = times.iter().map(|t| exact(*t).abs()).fold(0.0, f64::max);
        for (part, i) in [(0.25, 1), (1.0, 7), (5.0, 39)] {
            let values = [exact(times[i]), found[i]].map(|value| scale * value);
            rows.push(Row::new(format!("{what} after {part} τ"), values, unit, Claim::Of(scale * whole, 1e-9)));
        }
    };
    add("relaxation, F_z", &relaxed, &relaxation, "mN", 1e3);
    add("ramp, F_z", &ramped, &ramp, "mN", 1e3);
    add("creep, w", &crept, &creep, "µm", 1e6);
    Comparison {
        about: "One mass on flat ground, c = 2 N/mm with a Maxwell element of 3 N/mm and τ = 2 ms: pressed by 10 µm \
                and held; pressed at 10 mm/s; under a carrier of 0.1 g with a damper on which a load of 50 mN comes \
                at once; `relative_tolerance = 1e-12`."
            .into(),
        rows,
        ..Comparison::default()
    }
}

/// (m s² + D s + c)(1 + sτ) + c_1 sτ has three real roots s_i, and w = N/c + Σ N (1 + s_i τ) e^(s_i t)/(s_i P'(s_i)).
fn creep() -> impl Fn(f64) -> f64 {
    let coefficients = [SOFT, DAMPING + (SOFT + ELEMENT) * TIME, MASS + DAMPING * TIME, MASS * TIME];
    let value = |s: f64| coefficients.iter().rev().fold(0.0, |sum, c| sum * s + c);
    let slope = move |s: f64| coefficients[1] + s * (2.0 * coefficients[2] + s * 3.0 * coefficients[3]);
    let mut roots = Vec::new();
    let place = |i: i32| -10.0_f64.powf(f64::from(i) / 100.0);
    for i in 0..700 {
        let (mut near, mut far) = (place(i), place(i + 1));
        if value(near).signum() != value(far).signum() {
            for _ in 0..200 {
                let middle = 0.5 * (near + far);
                *(if value(middle).signum() == value(near).signum() { &mut near } else { &mut far }) = middle;
            }
            roots.push(near);
        }
    }
    assert_eq!(roots.len(), 3);
    move |t| {
        let part = |s: &f64| LOAD * (1.0 + s * TIME) / (s * slope(*s)) * (s * t).exp();
        LOAD / SOFT + roots.iter().map(part).sum::<f64>()
    }
}
