//! Links that work as rods: their forces are as good as those of the others, or the run stops.

use asperity::model::{LinkKind, Model};
use asperity::outputs::variables;
use asperity::scene::Scene;
use asperity::simulation::{Motion, Simulation, SimulationError, Start};

use crate::common::scenes::SceneText;

/// Eight masses pressed onto waves and drawn over them; `changes` are lines of the scene's links.
fn scene(changes: &[(&str, &str)]) -> Scene {
    let mut scene = SceneText::new(8, 1e-4, 1e-7)
        .vertical((2e3, 8e-3, [(1e3, 1e-4)]))
        .horizontal((1e3, 8e-3))
        .lateral_x((5e2, 2e-3))
        .lateral_z((5e2, 2e-3))
        .sinusoid(5e-6, 2.3e-4)
        .coulomb(0.3)
        .phase("duration = 2e-4, w_rate = -0.1")
        .phase("duration = 3e-4, u_rate = 0.2")
        .outputs(&["forces", "energy", "solver", "elements"])
        .scene();
    for (name, value) in changes {
        scene.set_by_name(name, value).unwrap();
    }
    scene
}

/// What a run shows.
#[derive(Debug)]
struct Shown {
    /// At the end, N.
    force: (f64, f64),
    /// The least F_N of all masses at all rows, N.
    least_normal: f64,
    residual: f64,
    steps: f64,
}

fn run(scene: &Scene) -> Result<Shown, SimulationError> {
    let start = Start { w_rate: -0.1, ..Start::default() };
    let mut simulation = Simulation::new(scene, &start)?;
    let variables = variables(scene);
    let mut values = vec![0.0; variables.len()];
    let mut least_normal = 0.0_f64;
    for phase in &scene.excitation {
        let motion = Motion { duration: phase.duration, u: phase.u, w: phase.w, ..Motion::default() };
        let times: Vec<f64> = (1..=100).map(|i| phase.duration * f64::from(i) / 100.0).collect();
        simulation.advance_observed(&motion, None, &times, |_, now| {
            now.evaluate(&variables, &mut values);
            for (_, value) in variables.iter().zip(&values).filter(|(one, _)| one.name.ends_with("F_N")) {
                least_normal = least_normal.min(*value);
            }
        })?;
    }
    let value = |name: &str| values[variables.iter().position(|one| one.name == name).unwrap()];
    let force = (value("F_x"), value("F_z"));
    Ok(Shown { force, least_normal, residual: value("energy.residual"), steps: value("solver.steps") })
}

/// F_x and F_z at the end where the masses keep their distances along x, N: CVODE's with either rod below, at 1e-6.
const TIED: (f64, f64) = (-0.103_705_3, 0.334_727_6);

/// Twice the relative tolerance for two solutions, and what is left of the rods' own swing.
fn is_tied(shown: &Shown) -> bool {
    (shown.force.0 - TIED.0).abs() < 1e-5 * TIED.1 && (shown.force.1 - TIED.1).abs() < 1e-5 * TIED.1
}

/// Dampers a million times critical between the masses: few steps, no chatter, no forces out of roundings.
#[test]
fn contacts_between_strong_dampers_slip_as_one() {
    for (method, most_steps) in [("event", 500.0), ("step", 20_000.0)] {
        let shown = run(&scene(&[("layer.lateral_x.damping", "3e4"), ("solver.method", method)])).unwrap();
        assert!(is_tied(&shown), "{method}: {shown:?}");
        // A limit of a force is passed by the tolerance of positions, 1e-11 m, times the stiffness that is felt, 4000
        // N/m.
        assert!(shown.least_normal > -1e-7, "{method}: {shown:?}");
        // Ten tolerances of the 1e-5 J put in.
        assert!(shown.residual.abs() < 1e-10, "{method}: {shown:?}");
        assert!(shown.steps < most_steps, "{method}: {shown:?}");
    }
}

/// Springs of a hundred thousand times the stiffness of the others swing after every event, and that is followed.
#[test]
fn contacts_between_stiff_springs_slip_as_one() {
    let shown = run(&scene(&[("layer.lateral_x.stiffness", "5e8")])).unwrap();
    assert!(is_tied(&shown), "{shown:?}");
    assert!(shown.least_normal > -1e-7, "{shown:?}");
    assert!(shown.residual.abs() < 1e-10, "{shown:?}");
}

/// A contact is never held beyond its limit by a force within the tolerance of positions times a rod's stiffness: such
/// a run ends right or says that it can't.
#[test]
fn contacts_between_the_stiffest_springs_slip_or_the_run_stops() {
    let rods = scene(&[("layer.lateral_x.stiffness", "5e14"), ("solver.max_steps", "5000")]);
    match run(&rods) {
        Ok(shown) => assert!(is_tied(&shown), "{shown:?}"),
        Err(error) => assert!(matches!(error, SimulationError::TooManySteps { .. }), "{error}"),
    }
}

#[test]
fn rods_are_links_far_beyond_the_others() {
    let rods = |changes: &[(&str, &str)]| -> Vec<LinkKind> {
        let model = Model::new(&scene(changes));
        LinkKind::ALL.into_iter().filter(|&kind| model.is_rod(kind)).collect()
    };
    assert_eq!(rods(&[]), []);
    assert_eq!(rods(&[("layer.lateral_x.stiffness", "5e8")]), [LinkKind::LateralX]);
    assert_eq!(rods(&[("layer.horizontal.damping", "3e4")]), [LinkKind::Horizontal]);
    // Soft links make no rods of the others; nor is the layer's own compression one.
    assert_eq!(rods(&[("layer.horizontal.stiffness", "2e-9")]), []);
    assert_eq!(rods(&[("layer.vertical.stiffness", "5e14")]), []);
}

/// Where no link is a rod, every spring is felt.
#[test]
fn without_rods_all_springs_are_felt() {
    for changes in [&[][..], &[("layer.lateral_z.stiffness", "1e6")]] {
        let model = Model::new(&scene(changes));
        assert_eq!(model.mass_stiffness_without_rods(), model.mass_stiffness());
        assert_eq!(model.frequency_without_rods(), model.stiffest_frequency());
    }
    let rod = Model::new(&scene(&[("layer.lateral_x.stiffness", "5e14")]));
    assert_eq!(rod.mass_stiffness_without_rods(), Model::new(&scene(&[])).glassy[LinkKind::Vertical] + 2.0 * 500.0);
}
