//! Derivatives of the outputs, against difference quotients.

use std::collections::BTreeSet;

use super::context::RunContext;
use super::tests::{
    WAVE, scene, scene_in_spatial_measure, scene_with_heat, scene_with_memory, scene_with_rate_shear,
    scene_with_real_area,
};
use crate::model::{ByAxis, Mode};
use crate::outputs::{Output, dependencies, variables};
use crate::scene::{LinkKind, Path, Scene};
use crate::simulation::{Motion, Simulation, Start};

/// Runs of `scene` at rest, and with masses free, slipping and sticking, relaxed or not.
fn runs(scene: &Scene) -> Vec<Simulation> {
    let mut started = Simulation::new(scene, &Start { w: -2e-6, u_rate: 0.1, ..Start::default() }).unwrap();
    let rest = started.clone();
    started.advance(&WAVE).unwrap();
    let wave = started.clone();
    let drag =
        Motion { duration: 1e-4, u: Path { rate: -0.3, ..Path::default() }, w: Path::default(), ..Motion::default() };
    started.advance(&drag).unwrap();
    let dragged = started.clone();
    let still =
        Motion { duration: 2e-4, u: Path::default(), w: Path { rate: 1e-4, ..Path::default() }, ..Motion::default() };
    started.advance(&still).unwrap();
    let pressed = Simulation::new(scene, &Start { w: -8e-6, u_rate: 0.1, ..Start::default() }).unwrap();
    let runs = vec![rest, wave, dragged, started, pressed];
    let modes: Vec<Mode> = runs.iter().flat_map(|run| run.run.context.state.layer.state.mode.clone()).collect();
    for mode in [Mode::Free, Mode::Forward, Mode::Backward, Mode::Stick] {
        assert!(modes.contains(&mode), "{mode:?} in {modes:?}");
    }
    runs
}

/// The same run with the carrier moved and every state held.
fn moved(simulation: &Simulation, (du, dw): (f64, f64)) -> Simulation {
    let mut simulation = simulation.clone();
    let RunContext { model, state, .. } = &mut *simulation.run.context;
    (state.carrier.start.x, state.carrier.start.z) = (state.carrier.start.x + du, state.carrier.start.z + dw);
    let layer = &mut state.layer.state;
    layer.elongation_x.iter_mut().for_each(|e| *e -= du);
    layer.elongation_z.iter_mut().for_each(|e| *e -= dw);
    for row in &model.rows {
        let by = match row.kind {
            LinkKind::Horizontal => du,
            LinkKind::Vertical => dw,
            LinkKind::LateralX | LinkKind::LateralZ => 0.0,
        };
        layer.maxwell[row.range.clone()].iter_mut().for_each(|a| *a -= by);
    }
    simulation
}

/// Central: exact for all but the friction coefficient, being squares at most. That one has a kink at F_x = 0.
#[test]
fn directional_derivatives_are_those_of_a_difference_quotient() {
    let scenes = [scene(), scene_with_rate_shear(), scene_with_memory(), scene_with_real_area(), scene_with_heat()];
    scenes.iter().for_each(directional_derivatives_are_quotients);
    directional_derivatives_are_quotients(&scene_in_spatial_measure());
}

fn directional_derivatives_are_quotients(scene: &Scene) {
    let variables = variables(scene);
    let values = |mut simulation: Simulation| {
        let mut values = vec![0.0; variables.len()];
        simulation.evaluate(&variables, &mut values);
        values
    };
    for mut simulation in runs(scene) {
        for direction in [(1.0, 0.0), (0.0, 1.0), (-0.6, 0.8)] {
            let mut found = vec![f64::NAN; variables.len()];
            simulation.directional_derivative(&variables, direction, &mut found);
            let step = 1e-10;
            let by = |sign: f64| moved(&simulation, (sign * step * direction.0, sign * step * direction.1));
            let (up, down) = (values(by(1.0)), values(by(-1.0)));
            for (i, variable) in variables.iter().enumerate() {
                let quotient = (up[i] - down[i]) / (2.0 * step);
                if variable.output == Output::FrictionCoefficient && up[0] * down[0] <= 0.0 {
                    continue;
                }
                // Roundings of values of the size of these, some ten times in a sum of forces, over the step.
                let allowed = 1e-6 * quotient.abs() + 4e-15 * (up[i].abs() + 1e-9) / step;
                let error = (found[i] - quotient).abs();
                assert!(error <= allowed, "{} {direction:?}: {} {quotient}", variable.name, found[i]);
            }
        }
    }
}

/// The table of dependencies says exactly which derivatives there are.
#[test]
fn there_is_a_derivative_where_there_is_a_dependency_and_nowhere_else() {
    let scene = scene();
    let variables = variables(&scene);
    for (name, direction) in [("u", (1.0, 0.0)), ("w", (0.0, 1.0))] {
        let mut found = BTreeSet::new();
        for mut simulation in runs(&scene) {
            let mut values = vec![0.0; variables.len()];
            simulation.directional_derivative(&variables, direction, &mut values);
            let with = variables.iter().zip(values).filter(|(_, value)| *value != 0.0);
            found.extend(with.map(|(variable, _)| variable.name.clone()));
        }
        let listed = variables.iter().filter(|variable| {
            let (on_u, on_w) = dependencies(&scene, variable.output).part_of(direction);
            on_u + on_w != 0.0
        });
        assert_eq!(found, listed.map(|variable| variable.name.clone()).collect(), "on {name}");
    }
}

/// Against the backward quotient of second order at the end of a motion, straight or not.
#[test]
fn force_rates_are_those_of_a_difference_quotient() {
    for scene in [scene(), scene_in_spatial_measure()] {
        force_rates_are_quotients(&scene);
    }
}

fn force_rates_are_quotients(scene: &Scene) {
    let straight = Motion { duration: 4e-5, u: Path { rate: 0.3, ..Path::default() }, w: WAVE.w, ..Motion::default() };
    for start in runs(scene) {
        for motion in [WAVE, straight] {
            let after = |by: f64| {
                let mut simulation = start.clone();
                simulation.advance(&Motion { duration: motion.duration - by, ..motion }).unwrap();
                simulation
            };
            let force = |by: f64| {
                let mut values = [0.0; 2];
                after(by).evaluate(&variables(scene)[..2], &mut values);
                values
            };
            let found = after(0.0).force_rates();
            let h = 2e-9;
            let (now, before, earlier) = (force(0.0), force(h), force(2.0 * h));
            for (i, found) in [found.x, found.z].into_iter().enumerate() {
                let quotient = (3.0 * now[i] - 4.0 * before[i] + earlier[i]) / (2.0 * h);
                assert!((found - quotient).abs() < 1e-4 * quotient.abs() + 1e-2, "{i}: {found} {quotient}");
            }
        }
    }
}

/// Before the first motion: ė = -ẇ of masses on a flat surface that the carrier comes down on, and a relaxed layer.
#[test]
fn force_rates_at_the_start_are_those_of_the_starting_velocity() {
    let text = "name = 'a'\nlayer = { masses = 2, spacing = 1.0, mass = 1.0, vertical = { stiffness = 3.0, \
                maxwell = [{ stiffness = 2.0, relaxation_time = 1.0 }] } }\nsurface = { kind = 'flat' }";
    let scene = Scene::parse(text, std::path::Path::new("a.toml")).unwrap();
    let mut simulation = Simulation::new(&scene, &Start { w: -0.1, w_rate: -0.5, ..Start::default() }).unwrap();
    assert_eq!(simulation.force_rates(), ByAxis { x: 0.0, z: 2.0 * (3.0 + 2.0) * 0.5 });
}
