//! The group `tangent`: the change of the forces at the end of a motion with the carrier's target in that motion,
//! against a difference quotient by rollback.

use asperity::outputs::{Variable, variables};
use asperity::scene::{Force, Kinematics, Path, Scene};
use asperity::simulation::{Motion, Simulation, Start};

use crate::common::runs::straight;
use crate::common::scenes::SceneText;

/// Six masses, rough on rough, Maxwell elements in all links.
fn scene(friction: &str) -> Scene {
    SceneText::new(6, 1e-4, 1e-7)
        .roughness(&[1e-6, -2e-6, 5e-7, 2e-6, -1e-6, 0.0])
        .vertical((2e3, 8e-3, [(1e3, 1e-4), (5e2, 1e-6)]))
        .horizontal((1e3, 5e-3, [(6e2, 1e-4)]))
        .lateral_x((5e2, 2e-3, [(2e2, 1e-5)]))
        .lateral_z((3e2, 2e-3))
        .sinusoid(3e-6, 3.3e-4)
        .with(friction)
        .relative(1e-10)
        .outputs(&["forces", "contact", "tangent", "solver"])
        .scene()
}

/// The same with links along z in spatial measure.
fn in_spatial_measure(mut scene: Scene) -> Scene {
    scene.layer.kinematics = Some(Kinematics::Spatial);
    scene
}

struct Run {
    simulation: Simulation,
    variables: Vec<Variable>,
}

impl Run {
    fn new(scene: &Scene, motions: &[Motion]) -> Self {
        let mut simulation = Simulation::new(scene, &Start::default()).unwrap();
        for motion in motions {
            simulation.advance(motion).unwrap();
        }
        Self { simulation, variables: variables(scene) }
    }

    /// The values of the variables with these names after `motion`; the run itself stays where it is.
    fn after<const N: usize>(&self, motion: &Motion, names: [&str; N]) -> [f64; N] {
        let mut simulation = self.simulation.clone();
        simulation.advance(motion).unwrap();
        let mut values = vec![0.0; self.variables.len()];
        simulation.evaluate(&self.variables, &mut values);
        names.map(|name| values[self.variables.iter().position(|variable| variable.name == name).unwrap()])
    }

    /// The tangents after `motion` against the central difference quotient; no mode changes on the way.
    fn check(&self, motion: &Motion) {
        let names = ["tangent.dF_x_du", "tangent.dF_z_du", "tangent.dF_x_dw", "tangent.dF_z_dw"];
        let tangents = self.after(motion, names);
        let moved = 1e-9;
        for (axis, pair) in tangents.chunks(2).enumerate() {
            let shifted = |by: f64| {
                let mut motion = *motion;
                [&mut motion.u, &mut motion.w][axis].rate += by / motion.duration;
                self.after(&motion, ["F_x", "F_z", "solver.events"])
            };
            let (up, down) = (shifted(moved), shifted(-moved));
            assert_eq!(up[2], down[2], "a mode has changed");
            for force in 0..2 {
                let quotient = (up[force] - down[force]) / (2.0 * moved);
                let scale = tangents.iter().fold(0.0_f64, |largest, t| largest.max(t.abs()));
                // The quotient's own error: curvature over 1e-9 m of a profile that bends over 1e-4 m, and the runs'
                // tolerance of 1e-10 of some 1e-5 m over 2e-9 m.
                assert!((pair[force] - quotient).abs() < 2e-5 * scale, "{axis} {force}: {} {quotient}", pair[force]);
            }
        }
    }
}

const COULOMB: &str = "friction.coulomb = 0.3";
const BOTH: &str = "friction = { coulomb = 0.2, shear_force = 1e-3 }";
/// Masses that slip at 0.3 m/s do so where the shear strength falls with the speed, or where it rises.
const FALLING: &str =
    "friction.coulomb = 0.2\nfriction.rate_shear = { force = 4e-3, reference_speed = 6e-2, sharpness = 1.0 }";
/// Contacts that follow their speed over some slips as long as the layer's waves, or at once.
const REMEMBERING: &str = "friction = { coulomb = 0.2, memory = 2e-5, rate_shear = { force = 4e-3, reference_speed = 6e-2, \
                           sharpness = 1.0 } }";
const RISING: &str = "friction.rate_shear = { force = 4e-3, reference_speed = 10.0, sharpness = 0.4 }";

#[test]
fn without_contact() {
    let run = Run::new(&scene(COULOMB), &[straight(1e-4, 0.01, 0.1)]);
    for duration in [1e-8, 1e-6, 1e-4] {
        run.check(&straight(duration, 0.05, 0.02));
    }
}

#[test]
fn sticking() {
    for scene in [scene(COULOMB), in_spatial_measure(scene(COULOMB))] {
        let run = Run::new(&scene, &[straight(4e-4, 0.0, -0.05), straight(1e-3, 0.0, 0.0)]);
        for duration in [1e-8, 1e-6, 1e-5] {
            run.check(&straight(duration, 1e-4, -1e-4));
        }
    }
}

#[test]
fn slipping() {
    for friction in ["", COULOMB, BOTH, FALLING, REMEMBERING, RISING] {
        for scene in [scene(friction), in_spatial_measure(scene(friction))] {
            let run = Run::new(&scene, &[straight(4e-4, 0.0, -0.05), straight(1.01e-3, 0.3, 0.0)]);
            for duration in [1e-8, 1e-6, 1e-5] {
                run.check(&straight(duration, 0.3, 0.0));
            }
        }
    }
}

#[test]
fn zero_before_the_first_motion_and_held_after_it() {
    let run = Run::new(&scene(COULOMB), &[]);
    let mut simulation = run.simulation.clone();
    let mut values = vec![1.0; run.variables.len()];
    simulation.evaluate(&run.variables, &mut values);
    for (variable, value) in run.variables.iter().zip(&values) {
        assert!(!variable.name.starts_with("tangent.") || *value == 0.0, "{}", variable.name);
    }
}

/// Over a motion short against all its times, a sticking layer answers as its springs, Maxwell springs and, over the
/// duration, its dampers do: ∂F_x/∂u = -k (c + Σ c_j + d/h).
#[test]
fn a_short_motion_meets_the_glassy_stiffness_and_the_damper_over_the_step() {
    let run = Run::new(&scene(COULOMB), &[straight(4e-4, 0.0, -0.05), straight(1e-3, 0.0, 0.0)]);
    let h = 1e-10;
    let [x, z, count] = run.after(&straight(h, 0.0, 0.0), ["tangent.dF_x_du", "tangent.dF_z_dw", "contact.sticking"]);
    assert_eq!(count, 6.0, "all masses stick");
    // The relaxation over 1e-10 s against 1e-6 s leaves 1e-4 of a part of the stiffness.
    assert!((x / (-6.0 * (1.6e3 + 5e-3 / h)) - 1.0).abs() < 1e-4);
    assert!((z / (-6.0 * (3.5e3 + 8e-3 / h)) - 1.0).abs() < 1e-4);
}

/// The same for a carrier that is a body along both axes: by every input, of the forces and of its own motion.
#[test]
fn by_every_input_of_a_body() {
    let material = SceneText::new(5, 1e-4, 1e-7)
        .vertical((2e3, 8e-3, [(1e3, 1e-4)]))
        .horizontal((1e3, 5e-3))
        .lateral_x((5e2, 2e-3))
        .lateral_z(3e2)
        .sinusoid(2e-6, 3.3e-4)
        .coulomb(0.3)
        .with("carrier.x = { mass = 1e-4, stiffness = 800.0, damping = 0.02 }")
        .with("carrier.z = { mass = 2e-4, stiffness = 300.0, damping = 0.2, load = 0.05, initial = 'equilibrium' }")
        .relative(1e-10)
        .outputs(&["forces", "carrier", "tangent", "solver"])
        .scene();
    for scene in [in_spatial_measure(material.clone()), material] {
        every_input_of_a_body(&scene);
    }
}

fn every_input_of_a_body(scene: &Scene) {
    let force = |rate| Force { start: None, change: Path { rate, ..Path::default() } };
    let names = ["F_x", "F_z", "carrier.u", "carrier.u_rate", "carrier.w", "carrier.w_rate", "solver.events"];
    let tangents = |by: &str| {
        ["F_x", "F_z", "carrier_u", "carrier_u_rate", "carrier_w", "carrier_w_rate"]
            .map(|of| format!("tangent.d{of}_d{by}"))
    };
    // Sticking, then slipping: with the drive far ahead.
    for (ahead, some_free) in [(1e-5, false), (3e-4, false), (3e-4, true)] {
        let lift = if some_free { -0.045 } else { 0.0 };
        let run = Run::new(
            scene,
            &[straight(1e-3, ahead / 1e-3, 0.0), Motion { load: force(lift / 1e-4), ..straight(1e-4, 0.02, 0.0) }],
        );
        for duration in [1e-7, 1e-5] {
            let motion = straight(duration, 0.02, 1e-3);
            for (by, moved) in [("u", 1e-9), ("w", 1e-9), ("load", 1e-6), ("pull", 1e-6)] {
                let tangents = tangents(by);
                let found = run.after(&motion, [0, 1, 2, 3, 4, 5].map(|i| tangents[i].as_str()));
                let shifted = |sign: f64| {
                    let mut motion = motion;
                    let rate = sign * moved / duration;
                    match by {
                        "u" => motion.u.rate += rate,
                        "w" => motion.w.rate += rate,
                        "load" => motion.load = force(rate),
                        _ => motion.pull = force(rate),
                    }
                    run.after(&motion, names)
                };
                let (up, down) = (shifted(1.0), shifted(-1.0));
                assert_eq!(up[6], down[6], "a mode has changed");
                for (i, found) in found.into_iter().enumerate() {
                    let quotient = (up[i] - down[i]) / (2.0 * moved);
                    // The runs' tolerance of 1e-10 of their values over what the input is changed by; a profile that bends.
                    let allowed = 1e-4 * quotient.abs() + 1e-9 * up[i].abs() / moved;
                    assert!((found - quotient).abs() <= allowed, "{} by {by}: {found} {quotient}", names[i]);
                }
            }
        }
    }
}
