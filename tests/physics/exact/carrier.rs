//! The carrier as a body: creep, free vibration, Coulomb's oscillator, free fall, a carrier that is hung on its drive.

use asperity::scene::Force;
use asperity::simulation::{Motion, Start};
use nalgebra::{DMatrix, DVector};

use super::run::{Run, rate};
use crate::common::runs::even_times;
use crate::common::scenes::SceneText;

fn load(value: f64) -> Force {
    Force { start: Some(value), ..Force::default() }
}

/// Masses on a flat profile, the load jumps to N: M ẅ + D ẇ + K w + k (c w + d ẇ + Σ c_j (w - y_j)) = -N, ẏ_j = (w - y_j)/τ_j,
/// by the matrix exponential.
#[test]
fn creep_under_a_load_that_jumps() {
    let (mass, stiffness, damping, count, c, d) = (2e-3, 300.0, 0.4, 5.0, 2e3, 0.02);
    let elements = [(1e3, 2e-3), (4e2, 3e-2)];
    let text = SceneText::new(5, 1e-4, 1e-7)
        .vertical((c, d, elements))
        .with(&format!("carrier.z = {{ mass = {mass:?}, stiffness = {stiffness:?}, damping = {damping:?} }}"))
        .tolerances(1e-9, 1e-16);
    let force = 0.05;
    let states = 4;
    let mut a = DMatrix::zeros(states, states);
    let glassy = count * (c + elements.iter().map(|(c, _)| c).sum::<f64>());
    a[(0, 1)] = 1.0;
    a[(1, 0)] = -(stiffness + glassy) / mass;
    a[(1, 1)] = -(damping + count * d) / mass;
    for (j, (c, tau)) in elements.into_iter().enumerate() {
        a[(1, 2 + j)] = count * c / mass;
        (a[(2 + j, 0)], a[(2 + j, 2 + j)]) = (1.0 / tau, -1.0 / tau);
    }
    let driven = DVector::from_fn(states, |i, _| if i == 1 { -force / mass } else { 0.0 });
    let rest = a.clone().lu().solve(&-driven).unwrap();
    let mut run = Run::new(&text, Start::default());
    let (end, count_of_rows) = (0.1, 40);
    let rows = even_times(end, count_of_rows);
    let motion = Motion { duration: end, load: load(force), ..Motion::REST };
    let found = run.sample(&motion, &rows, &["carrier.w", "carrier.w_rate", "F_z"]);
    let (way, speed) = (rest[0].abs(), rest[0].abs() * (glassy / mass).sqrt());
    for (i, &t) in rows.iter().enumerate() {
        let state = &rest - (&a * t).exp() * &rest;
        let (w, rate) = (state[0], state[1]);
        let of_elements: f64 = elements.iter().enumerate().map(|(j, (c, _))| c * (w - state[2 + j])).sum();
        let force_z = -count * (c * w + d * rate + of_elements);
        // Ten tolerances.
        assert!((found[0][i] - w).abs() < 1e-8 * way, "w at {t}: {} {w}", found[0][i]);
        assert!((found[1][i] - rate).abs() < 1e-8 * speed, "rate at {t}: {} {rate}", found[1][i]);
        assert!((found[2][i] - force_z).abs() < 1e-8 * force, "F_z at {t}: {} {force_z}", found[2][i]);
    }
    // At rest F_z = N + K (w - w_d).
    run.follow(&Motion { duration: 10.0, ..Motion::REST });
    let (force_z, w) = (run.get("F_z"), run.get("carrier.w"));
    assert!((force_z - (force + stiffness * w)).abs() < 1e-8 * force, "{force_z} {w}");
}

/// A body on a stuck layer and its drive: ω = √((k c + K)/M), by all methods.
#[test]
fn free_vibration_along_both_axes() {
    let (mass, stiffness, count, c) = (1e-3, 2e3, 4.0_f64, 5e2);
    for method in ["event", "step", "auto"] {
        let body = format!("mass = {mass:?}, stiffness = {stiffness:?}, start_rate = 1e-3");
        let text = SceneText::new(4, 1e-4, 1e-8)
            .vertical(c)
            .horizontal(c)
            .coulomb(100.0)
            .with(&format!("carrier.x = {{ {body} }}\ncarrier.z = {{ {body}, load = 0.1, initial = 'equilibrium' }}"))
            .method(method)
            .tolerances(1e-6, 1e-13);
        let omega = ((count * c + stiffness) / mass).sqrt();
        let mut run = Run::new(&text, Start::default());
        let w = run.get("carrier.w");
        let (end, amplitude) = (20.0 / omega, 1e-3 / omega);
        let rows = even_times(end, 50);
        let found = run.sample(&Motion { duration: end, ..Motion::REST }, &rows, &["carrier.u", "carrier.w"]);
        // Twenty radians add up the local errors, which are some tolerances each.
        let bound = 1e-4 * amplitude;
        for (i, &t) in rows.iter().enumerate() {
            let expected = amplitude * (omega * t).sin();
            assert!((found[0][i] - expected).abs() < bound, "{method}: u at {t}: {} {expected}", found[0][i]);
            assert!((found[1][i] - w - expected).abs() < bound, "{method}: w at {t}: {} {expected}", found[1][i] - w);
        }
    }
}

/// Half a swing takes a to b by ½ K (a² - b²) = μN (a + b - 2 x_s), x_s = μN/(k c_h); the first one, from unstrained links,
/// by ½ x_s in place of x_s.
#[test]
fn coulombs_oscillator_loses_a_step_each_swing() {
    let (mass, stiffness, normal, mu) = (1e-3, 1e3_f64, 1.0, 0.2);
    let (count, c, m) = (4.0, 2e5, 1e-7);
    // k c_h/K = 800, k m/M = 4e-4; d damps a mass on its link within a small part of a swing.
    let text = SceneText::new(4, 1e-4, m)
        .vertical((1e5, 0.05))
        .horizontal((c, 0.1))
        .coulomb(mu)
        .with(&format!("carrier.x = {{ mass = {mass:?}, stiffness = {stiffness:?}, start = 4e-3 }}"))
        .with(&format!("carrier.z = {{ mass = 1e-3, damping = 5.0, load = {normal:?}, initial = 'equilibrium' }}"))
        .tolerances(1e-8, 1e-14);
    let (limit, stuck) = (mu * normal, mu * normal / (count * c));
    // b from ½ K (a² - b²) = μN (a + b - share · 2 x_s).
    let next = |a: f64, share: f64| {
        let q = a * a - 2.0 * limit / stiffness * (a - 2.0 * share * stuck);
        -limit / stiffness + ((limit / stiffness).powi(2) + q).sqrt()
    };
    let mut run = Run::new(&text, Start { u: 0.0, ..Start::default() });
    let half = std::f64::consts::PI * (mass / stiffness).sqrt();
    let rows = even_times(6.0 * half, 60_000);
    let found = run.sample(&Motion { duration: 6.0 * half, ..Motion::REST }, &rows, &["carrier.u"]);
    let (mut expected, step) = (4e-3, 4.0 * limit / stiffness);
    for swing in 0..5 {
        expected = next(expected, if swing == 0 { 0.5 } else { 1.0 });
        let (from, to) = ((10_000 * swing) + 5_000, (10_000 * swing) + 15_000);
        let sign = if swing % 2 == 0 { -1.0 } else { 1.0 };
        let turn = found[0][from..to].iter().fold(0.0, |most: f64, u| most.max(sign * u));
        // The masses' inertia, k m/M = 4e-4, and the rows beside the turn.
        assert!((turn - expected).abs() < 4e-4 * step, "swing {swing}: {turn} {expected}");
    }
}

/// A layer in flight under a body that the load pulls: every link hangs slack, so w = ½ N/M t² exactly, whatever the method.
#[test]
fn a_carrier_in_flight_follows_its_load() {
    for method in ["event", "step"] {
        let text = SceneText::new(3, 1e-4, 1e-7)
            .set("layer.clearance", 1.0)
            .vertical(1e3)
            .with("carrier.z = { mass = 1e-3, load = -2e-3 }")
            .method(method)
            .relative(1e-9);
        let mut run = Run::new(&text, Start::default());
        run.follow(&Motion { duration: 5e-3, ..Motion::REST });
        // The masses are pulled along: N/(M + k m), with their vibration about it, of the share k m/M of w and less.
        let expected = 0.5 * 2e-3 / (1e-3 + 3e-7) * 5e-3 * 5e-3;
        let w = run.get("carrier.w");
        assert!((w - expected).abs() < 1e-3 * expected, "{method}: {w} {expected}");
        let residual = run.get("energy.residual") / run.get("energy.input");
        assert!(residual.abs() < 1e-8, "{method}: {residual}");
    }
}

/// A very heavy body that starts at a speed moves as a carrier whose displacement is prescribed, and one on a very stiff
/// drive as the drive.
#[test]
fn a_heavy_body_and_one_on_a_stiff_drive_move_as_prescribed() {
    let layer = SceneText::new(6, 1e-4, 1e-7)
        .vertical((2e3, 0.01))
        .horizontal((1e3, 0.01))
        .sinusoid(2e-6, 3e-4)
        .set("surface.points_per_wavelength", 32)
        .coulomb(0.3)
        .tolerances(1e-8, 1e-15);
    let motion = Motion { duration: 1e-3, u: rate(0.1), w: rate(-2e-3), ..Motion::REST };
    let start = Start { w: -1e-6, u_rate: 0.1, w_rate: -2e-3, ..Start::default() };
    let forces = |run: &mut Run, motion: &Motion| run.sample(motion, &even_times(1e-3, 20), &["F_x", "F_z"]);
    let prescribed = forces(&mut Run::new(&layer, start), &motion);
    let bodies = |keys: &str| {
        format!(
            "carrier.x = {{ {keys}, start_rate = 0.1 }}\ncarrier.z = {{ {keys}, start = -1e-6, start_rate = -2e-3 }}"
        )
    };
    let (heavy, on_drive) = (bodies("mass = 1e7"), bodies("mass = 1e-3, stiffness = 1e12"));
    for (body, motion, bound) in [(heavy, Motion { duration: 1e-3, ..Motion::REST }, 1e-7), (on_drive, motion, 1e-6)] {
        let found = forces(&mut Run::new(&layer.clone().with(&body), start), &motion);
        for (found, wanted) in found.iter().zip(&prescribed) {
            let largest = wanted.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
            for (found, wanted) in found.iter().zip(wanted) {
                assert!((found - wanted).abs() < bound * largest, "{found} {wanted}");
            }
        }
    }
}
