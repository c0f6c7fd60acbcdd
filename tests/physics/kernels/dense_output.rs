//! The dense output of the method of seven stages, against exact solutions.

use asperity::internals::integrator::{DenseWorkspace, LayerStep, LayerSums, Polynomials, TimeSpan};
use asperity::model::{ByAxis, Forces, State};
use nalgebra::Vector2;

use crate::common::random::Random;
use crate::physics::kernels::convergence::{Exact, PATHS, chain, differences, displaced, slider, sliding};
use crate::physics::kernels::equations::{random_layer, random_state};
use crate::physics::kernels::layer::{Layer, Method, SEVEN_STAGES, Stepper, at_rate, last_order, link, one_mass};

const THETAS: [f64; 6] = [0.0, 0.13, 0.37, 0.5, 0.81, 1.0];

/// The largest difference of positions, velocities and Maxwell elongations within one step of length `h`.
fn worst(stepper: &mut Stepper, h: f64, exact: impl Fn(f64) -> State) -> [f64; 3] {
    stepper.attempt(h);
    let mut worst = [0.0_f64; 3];
    for theta in THETAS {
        let differences = differences(&stepper.within(h, theta), &exact(theta * h));
        worst = std::array::from_fn(|part| worst[part].max(differences[part]));
    }
    worst
}

/// The dense output of one step of a free chain: positions and Maxwell elongations miss O(h⁶), velocities O(h⁵).
#[test]
fn the_inside_of_a_free_step_has_its_order() {
    let layer = chain();
    let start = displaced(&layer.model());
    let exact = Exact::new(&layer);
    let mut stepper = Stepper::new(layer.model(), PATHS, start.clone(), 1e-12);
    let errors = [1e-2, 5e-3, 2.5e-3].map(|h| worst(&mut stepper, h, |time| exact.at(&start, time)));
    for (part, expected) in [6.0, 5.0, 6.0].into_iter().enumerate() {
        let order = last_order(&errors.map(|error| error[part]));
        assert!(order > expected - 0.4, "part {part}: {order} from {errors:?}");
    }
}

/// In four stages: velocities miss O(h³), positions and Maxwell elongations, which follow the velocities, O(h⁴).
#[test]
fn the_inside_of_a_free_step_of_four_stages_has_its_order() {
    let layer = chain();
    let start = displaced(&layer.model());
    let exact = Exact::new(&layer);
    let mut stepper = Stepper::new(layer.model(), PATHS, start.clone(), 1e-12).by_four_stages();
    let errors = [1e-2, 5e-3, 2.5e-3].map(|h| worst(&mut stepper, h, |time| exact.at(&start, time)));
    for (part, expected) in [4.0, 3.0, 4.0].into_iter().enumerate() {
        let order = last_order(&errors.map(|error| error[part]));
        assert!(order > expected - 0.4, "part {part}: {order} from {errors:?}");
    }
}

/// The same for a slipping mass, against steps so short that their error does not count: its height follows the profile
/// at its position, its z velocity the slope there. What depends on the motion, as its Maxwell elements do, misses
/// O(h⁵).
#[test]
fn the_inside_of_a_slipping_step_has_its_order() {
    let layer = slider();
    let start = sliding(&layer.model(), 2.0, 0.0);
    let paths = (at_rate(1.0), at_rate(0.0));
    let exact = |time: f64| {
        let mut fine = Stepper::new(layer.model(), paths, start.clone(), 1e-14);
        if time > 0.0 {
            fine.run(time, 40);
        }
        fine.start.state
    };
    let mut stepper = Stepper::new(layer.model(), paths, start.clone(), 1e-14);
    let errors = [1e-1, 5e-2, 2.5e-2].map(|h| worst(&mut stepper, h, exact));
    for (part, expected) in [6.0, 5.0, 5.0].into_iter().enumerate() {
        let order = last_order(&errors.map(|error| error[part]));
        assert!(order > expected - 0.4, "part {part}: {order} from {errors:?}");
    }
}

/// At its ends the dense output gives the states there.
#[test]
fn the_ends_of_a_step_are_the_states_there() {
    for (layer, paths) in [(chain(), PATHS), (slider(), (at_rate(0.5), at_rate(0.0)))] {
        let start = if layer.masses == 1 { sliding(&layer.model(), 2.0, 0.0) } else { displaced(&layer.model()) };
        let mut stepper = Stepper::new(layer.model(), paths, start, 1e-13);
        stepper.attempt(0.01);
        for (theta, expected) in [(0.0, &stepper.start.state), (1.0, stepper.integrator.end())] {
            // Roundings of positions up to 0.3 m, over the step's length where a velocity is their difference.
            let [position, velocity, maxwell] = differences(&stepper.within(0.01, theta), expected);
            assert!(position < 2e-16 && velocity < 1e-13 && maxwell < 1e-15, "{position:e} {velocity:e} {maxwell:e}");
        }
    }
}

/// Right after a jump of the velocity a short-lived Maxwell element is not yet where ė drives it: a = τ ė (1 -
/// e^{-t/τ}). Inside the step the dense output follows it, from relaxation times as long as the step to a hundred
/// millionth of it, and adds nothing to what the step itself misses at its end.
#[test]
fn a_stiff_element_is_followed_after_a_jump_of_the_velocity() {
    let h = 1e-3;
    for exponent in 3..=11 {
        let tau = 10.0_f64.powi(-exponent);
        // So weak a link leaves the velocity as it is, 1 m/s, but for 1e-12 of it.
        let link = link(1e-6, 0.0, &[(1e-6, tau)]);
        let layer = Layer { links: [link, None, None, None], clearance: 10.0, ..Layer::default() };
        let mut state = one_mass(1);
        state.velocity_z[0] = 1.0;
        let mut stepper = Stepper::new(layer.model(), (at_rate(0.0), at_rate(0.0)), state, 1e-12);
        stepper.attempt(h);
        let exact = |theta: f64| -tau * (-theta * h / tau).exp_m1();
        let end = (stepper.integrator.end().maxwell[0] - exact(1.0)).abs() / tau;
        // |R(-h/τ)|, at most 0.11: the element starts off its slow manifold by τ ė.
        assert!(end < 0.15, "τ {tau:e}: {end:e}");
        for theta in [1e-9, 1e-6, 1e-3, 0.05, 0.3, 0.9, 1.0] {
            let error = (stepper.within(h, theta).maxwell[0] - exact(theta)).abs() / tau;
            assert!(error < theta * end + 1e-11, "τ {tau:e}, θ {theta:e}: {error:e}");
        }
    }
}

/// F_N and f·t of one mass within a step are those of the whole state there, whatever the modes of its neighbours.
#[test]
fn one_contact_within_a_step_is_that_of_the_whole_state() {
    let mut random = Random::new(7);
    for case in 0..200 {
        let layer = random_layer(&mut random, 1 + case % 5);
        let model = layer.model();
        let state = random_state(&mut random, &model, &Vector2::zeros());
        let mut stepper = Stepper::new(model, PATHS, state, 1e-12);
        stepper.attempt(1e-3);
        let theta = random.between(0.0, 1.0);
        let within = stepper.within(1e-3, theta);
        let mut forces = Forces::new(&stepper.model);
        forces.evaluate(&stepper.model, &within, &stepper.carrier.at(theta * 1e-3));
        let mut workspace = DenseWorkspace::new(&stepper.model);
        for i in (0..within.mode.len()).filter(|&i| within.mode[i].in_contact()) {
            let expected = forces.contact(&stepper.model, &within, i);
            let found = stepper.dense(1e-3).contact(i, theta, &mut workspace);
            // Sums of some twenty forces up to 1e3 N in another order.
            let error = (found.normal - expected.normal).abs().max((found.tangential - expected.tangential).abs());
            assert!(error < 1e-11, "case {case}, mass {i}: {found:?} {expected:?}");
        }
    }
}

/// F_x and F_z by sums are those of the whole state within the step: F_x for all methods, F_z where masses in contact
/// are put on the profile one by one.
#[test]
fn forces_on_the_carrier_by_sums_are_those_of_the_whole_state() {
    let mut random = Random::new(8);
    for case in 0..200 {
        let layer = random_layer(&mut random, 1 + case % 11);
        let model = layer.model();
        let state = random_state(&mut random, &model, &Vector2::zeros());
        let steppers: [Method; 3] = [SEVEN_STAGES, Stepper::by_four_stages, Stepper::by_two_stages];
        let mut stepper = steppers[case % 3](Stepper::new(model, PATHS, state, 1e-12));
        stepper.attempt(1e-3);
        for theta in [0.0, random.between(0.0, 1.0), 1.0] {
            let [found, expected] = stepper.on_carrier(1e-3, theta);
            // Sums of some hundred forces up to 1e3 N in another order.
            let along_z = if case % 3 == 0 || theta == 0.0 { (found.z - expected.z).abs() } else { 0.0 };
            let error = (found.x - expected.x).abs().max(along_z);
            assert!(error < 1e-10, "case {case}, {theta}: {found:?} {expected:?}");
        }
    }
}

/// In four and in two stages F_z by sums has the masses in contact not on the profile, but where ż at the stages has
/// brought them: it misses that of the whole state by the order of velocities within the step.
#[test]
fn the_interpolated_heights_of_contacts_have_the_order_of_the_method() {
    let layer = slider();
    let start = sliding(&layer.model(), 2.0, 0.0);
    let methods: [(Method, f64); 2] = [(Stepper::by_four_stages, 3.0), (Stepper::by_two_stages, 2.0)];
    for (by_stages, expected) in methods {
        let paths = (at_rate(1.0), at_rate(0.0));
        let mut stepper = by_stages(Stepper::new(layer.model(), paths, start.clone(), 1e-14));
        let errors = [1e-2, 5e-3, 2.5e-3].map(|h| {
            stepper.attempt(h);
            let missed = |theta: f64| {
                let [by_sums, of_state] = stepper.on_carrier(h, theta);
                (by_sums.z - of_state.z).abs()
            };
            THETAS.map(missed).into_iter().fold(0.0, f64::max)
        });
        let order = last_order(&errors);
        assert!(order > expected - 0.4, "{order} for {expected} from {errors:?}");
    }
}

/// The states, forces and energies of two parts make those of the layer, whose masses are joined to the carrier alone.
#[test]
fn parts_of_a_step_make_the_whole() {
    let (mut random, mut compared) = (Random::new(9), 0);
    for case in 0..100 {
        let layer = random_layer(&mut random, 2 + case % 10);
        let [vertical, horizontal, ..] = layer.links;
        let model = Layer { links: [vertical, horizontal, None, None], ..layer }.model();
        let state = random_state(&mut random, &model, &Vector2::zeros());
        let stepper = Stepper::new(model, PATHS, state, 1e-12);
        let mut stepper = if case % 2 == 0 { stepper } else { stepper.by_four_stages() }.with_energies();
        let (h, theta) = (1e-3, random.between(0.0, 1.0));
        stepper.attempt(h);
        let (state, on_carrier) = (stepper.within(h, theta), stepper.on_carrier(h, theta)[0]);
        let Stepper { model, carrier, start, integrator, .. } = &mut stepper;
        let (start, span) = (&start.state, TimeSpan { start: 0.0, length: h });
        let energies = integrator.energies((model, carrier, start), span, theta);
        let power = integrator.dissipated_power((model, carrier, start), span, 1.0);

        let mut workspace = DenseWorkspace::new(model);
        let mut step = LayerStep { dense: integrator.dense(model, carrier, start, span), workspace: &mut workspace };
        let mut joined = State::new(model);
        let (mut sums, mut powers) = ([0.0; 7], Vec::new());
        let middle = 1 + case % (model.masses() - 1);
        for masses in [0..middle, middle..model.masses()] {
            let mut part = model.part(masses.len());
            part.move_part(model, masses.start);
            let mut of_part = LayerSums::new(&part, 0);
            of_part.begin_part(&mut step, &part, masses.start);
            let mut state = State::new(&part);
            let (dense, workspace) = step.restricted_to(&masses);
            dense.state_at(theta, workspace, &mut state);
            state.write_part((&part, model), &mut joined, masses.start);
            let ByAxis { x: f_x, z: f_z } = of_part.on_carrier(&mut step, &part, theta);
            let e = of_part.energies(&step.dense, theta);
            let values = [f_x, f_z, e.damper, e.maxwell, e.friction, e.shear, e.input];
            sums.iter_mut().zip(values).for_each(|(sum, value)| *sum += value);
            powers.push(of_part.dissipated_power(&step.dense, 1.0));
        }
        assert_eq!(joined, state, "case {case}");
        let e = energies;
        let whole = [on_carrier.x, on_carrier.z, e.damper, e.maxwell, e.friction, e.shear, e.input];
        for (i, (sum, whole)) in sums.into_iter().zip(whole).enumerate() {
            // Sums of some hundred forces up to 1e3 N, and of their powers over 1e-3 s, in another order.
            assert!((sum - whole).abs() < 1e-10, "case {case}, {i}: {sum} {whole}");
        }
        // Friction in a direction against the modes, as random states have it, may make a power below 0, which is cut
        // off.
        if power > 0.0 && powers.iter().all(|power| *power > 0.0) {
            let sum: f64 = powers.iter().sum();
            assert!((sum - power).abs() < 1e-10 * power, "case {case}: {sum} {power}");
            compared += 1;
        }
    }
    assert!(compared > 50, "{compared}");
}

/// The polynomials of a free mass are its motion within the step, and its speeds bound them.
#[test]
fn motions_are_those_of_the_state_within_the_step() {
    let layer = chain();
    let start = displaced(&layer.model());
    let mut stepper = Stepper::new(layer.model(), PATHS, start, 1e-12);
    let h = 1e-3;
    stepper.attempt(h);
    let (dense, rest) = (stepper.dense(h), (&stepper.model.rest_x, &stepper.model.rest_z));
    let motions = Polynomials::new(&dense);
    for theta in THETAS {
        let (within, at) = (stepper.within(h, theta), stepper.carrier.at(theta * h));
        for i in 0..within.mode.len() {
            let x = rest.0[i] + stepper.carrier.profile_position + at.x.position + within.elongation_x[i];
            let z = rest.1[i] + stepper.carrier.start.z + at.z.position + within.elongation_z[i];
            let found = (motions.position(i).evaluate(theta).position, motions.height(i).evaluate(theta).position);
            // Some roundings of positions of the size of 1 m.
            assert!((found.0 - x).abs() < 1e-14 && (found.1 - z).abs() < 1e-14, "{theta}, mass {i}: {found:?} {x} {z}");
            let (low, high) = motions.position_bounds(i);
            assert!(low <= x && x <= high && motions.min_height(i) <= z, "{theta}, mass {i}: {low} {high} {x} {z}");
        }
    }
}
