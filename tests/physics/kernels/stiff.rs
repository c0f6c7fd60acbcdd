//! What the method does where a step is far longer than a relaxation time.

use asperity::model::{State, elastic_energy, kinetic_energy};

use crate::physics::kernels::convergence::{Exact, PATHS, differences, slider, sliding};
use crate::physics::kernels::layer::{Layer, Method, SEVEN_STAGES, Stepper, at_rate, link, one_mass};

/// One mass with a spring and one Maxwell element along either axis.
pub fn oscillator(relaxation_time: f64) -> Layer {
    let link = || link(100.0, 0.5, &[(100.0, relaxation_time)]);
    Layer { links: [link(), link(), None, None], clearance: 10.0, ..Layer::default() }
}

/// Away from rest, every Maxwell element on its slow manifold: a = τ ė, but for O(τ²).
pub fn on_slow_manifold(relaxation_time: f64) -> State {
    let mut state = one_mass(2);
    (state.elongation_x[0], state.elongation_z[0]) = (0.1, -0.2);
    (state.velocity_x[0], state.velocity_z[0]) = (1.0, 0.5);
    let (u_rate, w_rate) = (PATHS.0.at(0.0).speed, PATHS.1.at(0.0).speed);
    // The rows stand vertical first.
    state.maxwell.copy_from_slice(&[relaxation_time * (0.5 - w_rate), relaxation_time * (1.0 - u_rate)]);
    state
}

/// The error of one step of 0.05 s, a third of the mass's radian, for relaxation times from 1e-3 s down to 1e-13 s:
/// no larger than without any Maxwell element, so no order is lost to their stiffness.
#[test]
fn the_error_of_a_step_does_not_depend_on_short_relaxation_times() {
    let h = 0.05;
    let plain = Layer { links: [link(100.0, 0.5, &[]), link(100.0, 0.5, &[]), None, None], ..oscillator(1.0) };
    let error = |layer: &Layer, start: &State, reference: &State| {
        let mut stepper = Stepper::new(layer.model(), PATHS, start.clone(), 1e-12);
        stepper.step(h);
        differences(&stepper.start.state, reference)
    };
    let free = State { maxwell: Vec::new(), ..on_slow_manifold(0.0) };
    let unforced = Exact::new(&plain).at(&free, h);
    let base = error(&plain, &free, &unforced);
    for exponent in 3..=13 {
        let tau = 10.0_f64.powi(-exponent);
        let (layer, start) = (oscillator(tau), on_slow_manifold(tau));
        // The matrix exponential of A h loses some ε h/τ. Below, the element is a damper of c_j τ, which is next to
        // nothing.
        let reference = if tau > 1e-9 {
            Exact::new(&layer).at(&start, h)
        } else {
            let (v_x, v_z) =
                (unforced.velocity_x[0] - PATHS.0.at(h).speed, unforced.velocity_z[0] - PATHS.1.at(h).speed);
            State { maxwell: vec![tau * v_z, tau * v_x], ..unforced.clone() }
        };
        let errors = error(&layer, &start, &reference);
        // An element of 1e-3 s is not yet a mere damper of 1e-3 of the spring.
        assert!(errors[0] < 1.1 * base[0] && errors[1] < 1.3 * base[1], "{tau:e}: {errors:?}, not {base:?}");
        // a = τ ė with the error of ė; and the start misses the slow manifold by some τ² ë.
        assert!(errors[2] < 1.1 * base[1] * tau + 4.0 * tau * tau, "{tau:e}: {errors:?}");
    }
}

/// A Maxwell element far from its slow manifold, a = τ ė, is there after one step but for some τ/h of the way.
#[test]
fn a_maxwell_element_falls_onto_its_slow_manifold() {
    // The factor that the stability function falls with, some tens.
    falls_onto_its_slow_manifold(SEVEN_STAGES, 100.0);
}

/// `most` is the share of τ/h that may be left.
pub fn falls_onto_its_slow_manifold(method: Method, most: f64) {
    let h = 0.05;
    for exponent in 4..=13 {
        let tau = 10.0_f64.powi(-exponent);
        let mut state = on_slow_manifold(tau);
        state.maxwell.fill(0.3);
        let mut stepper = method(Stepper::new(oscillator(tau).model(), PATHS, state, 1e-12));
        stepper.step(h);
        let carrier = stepper.carrier.at(h);
        let rates =
            [stepper.start.state.velocity_z[0] - carrier.z.speed, stepper.start.state.velocity_x[0] - carrier.x.speed];
        for (a, rate) in stepper.start.state.maxwell.iter().zip(rates) {
            let off = (a - tau * rate).abs();
            assert!(off < most * tau / h, "{tau:e}: {off:e}");
        }
    }
}

/// A damper so strong that h d/m is 1e3 to 1e13: a mass that moves against the carrier is held after one step and
/// has gone no further than m v/d. Free, and slipping over a curved profile.
#[test]
fn a_strong_damper_stops_the_mass_within_a_step() {
    // A rounding of h ẍ, some h d/m of v, on which Newton's single iteration starts.
    stops_within_a_step(SEVEN_STAGES, 100.0, |h_squared, damping| 1e-16 * h_squared * damping);
}

/// `most` is the share of m/(h d) that may be left of the speed, as for the Maxwell element; `rounding` the way beyond
/// m v/d.
pub fn stops_within_a_step(method: Method, most: f64, rounding: impl Fn(f64, f64) -> f64) {
    let h = 0.01;
    for exponent in 5..=15 {
        let damping = 10.0_f64.powi(exponent);
        let link = || link(100.0, damping, &[(100.0, 0.1)]);
        let links = [link(), link(), None, None];
        let free = Layer { links: links.clone(), ..oscillator(1.0) };
        let slipping = Layer { links, ..slider() };
        let mut state = one_mass(2);
        (state.velocity_x[0], state.velocity_z[0]) = (1.0, 1.0);
        for (layer, start) in [(&free, state), (&slipping, sliding(&slipping.model(), 1.0, 0.0))] {
            let paths = (at_rate(0.0), at_rate(0.0));
            let mut stepper = method(Stepper::new(layer.model(), paths, start.clone(), 1e-12));
            stepper.step(h);
            let moved = differences(&stepper.start.state, &start)[0];
            let speed = stepper.start.state.velocity_x[0].abs().max(stepper.start.state.velocity_z[0].abs());
            // m = 1 kg at most.
            assert!(speed < most / (h * damping), "{damping:e}: {speed:e}");
            assert!(moved < 1.1 / damping + rounding(h * h, damping), "{damping:e}: {moved:e}");
        }
    }
}

/// The energy of an undamped oscillator never grows through 10 000 steps, however long they are against its period.
#[test]
fn an_undamped_oscillator_never_gains_energy() {
    never_gains_energy(SEVEN_STAGES);
}

pub fn never_gains_energy(method: Method) {
    for phase in [1e-3, 0.03, 0.3, 1.0, 3.0, 30.0, 1e4] {
        let link = || link(100.0, 0.0, &[]);
        let layer = Layer { links: [link(), link(), None, None], ..Layer::default() };
        let mut state = one_mass(0);
        (state.elongation_x[0], state.velocity_z[0]) = (0.1, 1.0);
        let mut stepper = method(Stepper::new(layer.model(), (at_rate(0.0), at_rate(0.0)), state, 1e-12));
        let first = energy(&stepper);
        let mut highest = 0.0_f64;
        for _ in 0..10_000 {
            stepper.step(0.1 * phase);
            highest = highest.max(energy(&stepper) / first);
        }
        // The roundings of 10 000 steps, which add up like a random walk at most.
        assert!(highest < 1.0 + 1e-13, "hω = {phase}: {highest}");
    }
}

fn energy(stepper: &Stepper) -> f64 {
    kinetic_energy(&stepper.model, &stepper.start.state) + elastic_energy(&stepper.model, &stepper.start.state)
}
