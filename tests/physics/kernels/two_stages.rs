//! The method of two stages: its coefficients, order, error estimate and dense output, and stiff problems.

use asperity::internals::integrator::SDIRK2;
use asperity::model::State;

use crate::physics::kernels::convergence::{Exact, PATHS, chain, differences, displaced, slipping_errors};
use crate::physics::kernels::layer::{Layer, Stepper, last_order};
use crate::physics::kernels::stiff::{falls_onto_its_slow_manifold, never_gains_energy, stops_within_a_step};

fn stepper(layer: &Layer, start: &State) -> Stepper {
    Stepper::new(layer.model(), PATHS, start.clone(), 1e-12).by_two_stages()
}

/// b = the last row of A; Σ b = 1, Σ b c = ½, A 1 = c; and L-stable: the stability function
/// (1 + (1 - 2γ) z)/(1 - γz)² falls to 0 and is at most 1 along the imaginary axis.
#[test]
fn the_coefficients_are_of_order_two_and_l_stable() {
    let (c, a) = (SDIRK2.c, SDIRK2.a);
    let b = a[2];
    for i in 0..3 {
        assert!((a[i].iter().sum::<f64>() - c[i]).abs() < 1e-15);
    }
    assert!((b.iter().sum::<f64>() - 1.0).abs() < 1e-15);
    assert!((b.iter().zip(c).map(|(b, c)| b * c).sum::<f64>() - 0.5).abs() < 1e-15);
    let gamma = b[2];
    assert_eq!(a[1][1], gamma);
    for y in [0.1, 1.0, 10.0, 1e3, 1e6] {
        let size = (1.0 + (1.0 - 2.0 * gamma).powi(2) * y * y).sqrt() / (1.0 + gamma * gamma * y * y);
        assert!(size <= 1.0 + 1e-15, "{y}: {size}");
    }
}

/// Places, velocities and Maxwell elongations of a free chain, against the matrix exponential.
#[test]
fn a_free_chain_converges_with_order_two() {
    let layer = chain();
    let start = displaced(&layer.model());
    let expected = Exact::new(&layer).at(&start, 1.0);
    let errors = [100, 200, 400].map(|steps| {
        let mut stepper = stepper(&layer, &start);
        stepper.run(1.0, steps);
        differences(&stepper.start.state, &expected)
    });
    for part in 0..3 {
        let order = last_order(&errors.map(|error| error[part]));
        assert!((1.9..2.1).contains(&order), "part {part}: {order} from {errors:?}");
    }
}

/// A slipping mass with friction over a curved profile, against an explicit method on the dense equations.
#[test]
fn a_slipping_mass_converges_with_order_two() {
    for (_, errors) in slipping_errors([20, 40, 80], 1e-13, Stepper::by_two_stages) {
        for part in 0..3 {
            let order = last_order(&errors.map(|error| error[part]));
            assert!((1.85..2.15).contains(&order), "part {part}: {order} from {errors:?}");
        }
    }
}

/// The estimate is that of a method of order 1: the global error, of order 2, falls as it does.
#[test]
fn the_error_estimate_falls_with_the_square() {
    let layer = chain();
    let mut stepper = stepper(&layer, &displaced(&layer.model()));
    let tolerance = &mut stepper.tolerance;
    (tolerance.relative, tolerance.position, tolerance.velocity) = (1e-9, 1e-9, 1e-9);
    let attempts = [4e-3, 2e-3, 1e-3].map(|h| stepper.attempt(h));
    let order = last_order(&attempts.map(|attempt| attempt.error));
    assert!((1.9..2.1).contains(&order), "{order}");
}

/// The dense output of a step misses O(h³) of positions and O(h²) of velocities and Maxwell elongations; at its ends it
/// gives the states there.
#[test]
fn the_inside_of_a_step_has_its_order() {
    let layer = chain();
    let start = displaced(&layer.model());
    let exact = Exact::new(&layer);
    let mut stepper = stepper(&layer, &start);
    let errors = [1e-2, 5e-3, 2.5e-3].map(|h| {
        stepper.attempt(h);
        let mut worst = [0.0_f64; 3];
        for theta in [0.0, 0.13, 0.29, 0.5, 0.81, 1.0] {
            let within = stepper.within(h, theta);
            let found = differences(&within, &exact.at(&start, theta * h));
            worst = std::array::from_fn(|part| worst[part].max(found[part]));
            let ends = [(0.0, &start), (1.0, stepper.integrator.end())];
            if let Some((_, end)) = ends.into_iter().find(|(at, _)| *at == theta) {
                // Roundings of sums of numbers of size 1.
                assert!(differences(&within, end).into_iter().all(|difference| difference < 1e-14));
            }
        }
        worst
    });
    for (part, expected) in [3.0, 2.0, 2.0].into_iter().enumerate() {
        let order = last_order(&errors.map(|error| error[part]));
        assert!(order > expected - 0.2, "part {part}: {order} from {errors:?}");
    }
}

/// A Maxwell element far from its slow manifold, a = τ ė, is there after one step but for some τ/h of the way.
#[test]
fn a_maxwell_element_falls_onto_its_slow_manifold() {
    // The factor that the stability function falls with, (1 - 2γ)/γ².
    falls_onto_its_slow_manifold(Stepper::by_two_stages, 10.0);
}

/// A damper so strong that h d/m is 1e3 to 1e13 holds a mass within a step.
#[test]
fn a_strong_damper_stops_the_mass_within_a_step() {
    // Roundings of numbers of size 1.
    stops_within_a_step(Stepper::by_two_stages, 10.0, |_, _| 1e-15);
}

/// The energy of an undamped oscillator never grows, however long the steps are against its period.
#[test]
fn an_undamped_oscillator_never_gains_energy() {
    never_gains_energy(Stepper::by_two_stages);
}
