//! The methods `step` and `auto`: accuracy on the reference cases, what holds at the ends of steps, extremes, and that
//! a run goes on bit for bit wherever it is taken up.

use asperity::outputs::Snapshot;
use asperity::scene::{OutputGroup, Path, Phase, Scene};
use asperity::simulation::{Simulation, Start};

use crate::common::runs::{along_excitation, bits, straight, value, values};
use crate::common::scenes::SceneText;
use crate::common::{Table, difference, largest, root};

/// The cases of tests/reference.
const CASES: [&str; 9] = [
    "free-chain",
    "sinusoid",
    "rattle",
    "stuck-pair",
    "rough-coulomb",
    "rough-shear",
    "figure-7-low",
    "figure-7-middle",
    "figure-7-high",
];

fn reference(name: &str, method: &str, tolerance: &str) -> (Scene, Table) {
    let file = |extension: &str| root().join(format!("tests/reference/{name}.{extension}"));
    let mut scene = Scene::load(&file("toml")).unwrap();
    scene.set_by_name("solver.method", method).unwrap();
    scene.set_by_name("solver.relative_tolerance", tolerance).unwrap();
    (scene, Table::read(&file("csv")))
}

/// The outputs in the rows that the reference files have.
fn run(scene: &Scene) -> Table {
    along_excitation(scene, 50)
}

/// The largest difference to the reference over its largest value, of F_x, F_z and E_diss, and the residual of the
/// energy balance over the largest energy.
fn errors(scene: &Scene, wanted: &Table) -> [f64; 4] {
    let run = run(scene);
    let error = |name: &str| {
        let wanted = wanted.column(name);
        difference(&run.column(name), &wanted) / largest(&wanted).max(f64::MIN_POSITIVE)
    };
    let energies = ["E_diss", "energy.input", "energy.kinetic", "energy.elastic"];
    let scale = energies.iter().map(|name| largest(&run.column(name))).fold(0.0, f64::max);
    [error("F_x"), error("F_z"), error("E_diss"), largest(&run.column("energy.residual")) / scale]
}

/// The errors follow the tolerance: forces within five, energies within two times it, the balance as the energies.
///
/// Five for the rows at which a force jumps or a light contact has just closed; the rest stays below three.
#[test]
fn errors_on_the_reference_cases_follow_the_tolerance() {
    for name in CASES {
        for tolerance in ["1e-2", "1e-3", "1e-4", "1e-5", "1e-6"] {
            let (scene, wanted) = reference(name, "step", tolerance);
            let [f_x, f_z, losses, residual] = errors(&scene, &wanted);
            let allowed: f64 = tolerance.parse().unwrap();
            let errors = format!("{name} at {tolerance}: F_x {f_x:.1e} F_z {f_z:.1e} E {losses:.1e} {residual:.1e}");
            // The reference of this case is itself only good to some 4e-6.
            let own = if name == "rattle" { 1e-5 } else { 1e-7 };
            assert!(f_x.max(f_z) <= 5.0 * allowed + own, "{errors}");
            assert!(losses.max(residual) <= 2.0 * allowed + own, "{errors}");
        }
    }
}

/// Masses on a plateau that is pressed, and two that come down beside it: F_z = n (c e + d v) with n masses in contact, pressed
/// in by e. Rows between a touch and the end of its step show it, which the step as tried does not.
#[test]
fn rows_show_touches_before_the_end_of_their_step() {
    let (low, v, c, d) = (1e-6, 1e-2, 2e3, 1e-2);
    let x: Vec<f64> = (-10..=190).map(|i| 1e-4 * f64::from(i)).collect();
    // Ten points from the edge to the nearest mass the spline's ripples are 2e-6 of the edge.
    let z: Vec<f64> = x.iter().map(|&x| if x < 1.5e-2 { 0.0 } else { -low }).collect();
    let scene = SceneText::new(10, 2e-3, 1e-7)
        .vertical((c, d))
        .points(&x, &z, false)
        .method("step")
        .tolerances(0.1, 1e-6)
        .outputs(&["forces", "solver"])
        .scene();
    let mut simulation = Simulation::new(&scene, &Start { w_rate: -v, ..Start::default() }).unwrap();
    let (touch, times) = (low / v, (1..300).map(|i| 1e-6 * (f64::from(i) + 0.5)).collect::<Vec<f64>>());
    let mut rows = Vec::new();
    let row = |time: f64, now: &Snapshot<'_>| {
        rows.push((time, value(&scene, now, "F_z"), value(&scene, now, "solver.steps")));
    };
    simulation.advance_observed(&straight(3e-4, 0.0, -v), None, &times, row).unwrap();
    let steps_at = |time: f64| rows.iter().find(|row| row.0 > time).unwrap().2;
    assert_eq!(steps_at(touch - 1e-6), steps_at(touch + 2e-6), "rows in the step in which masses touch");
    for (time, f_z, _) in rows {
        let force = |depth: f64| if depth < 0.0 { 0.0 } else { c * depth + d * v };
        let exact = 8.0 * force(v * time) + 2.0 * force(v * (time - touch));
        // The ripples' force, 2e-6 · 1e-6 m · 2e3 N/m, by two.
        assert!((f_z - exact).abs() < 1e-8, "{time}: {f_z} {exact}");
    }
}

/// F_z of a rough slide in many rows: near the ends of steps, where masses have passed the profile that are lifted onto it
/// there, no worse than elsewhere.
#[test]
fn rows_of_a_rough_slide_are_as_good_as_the_ends_of_steps() {
    let rows = |method: &str, tolerance: f64| {
        let mut scene = rough(100, method, "");
        scene.solver.relative_tolerance = tolerance;
        let mut simulation = pressed(&scene);
        let times: Vec<f64> = (1..1000).map(|i| 1e-6 * f64::from(i)).collect();
        let mut rows = Vec::new();
        let row = |_: f64, now: &Snapshot<'_>| rows.push(value(&scene, now, "F_z"));
        simulation.advance_observed(&straight(1e-3, 1.0, 0.0), None, &times, row).unwrap();
        rows
    };
    let (found, exact) = (rows("step", 1e-2), rows("event", 1e-7));
    let error = difference(&found, &exact) / largest(&exact);
    // 1.5e-3; 4.4e-3 without these forces.
    assert!(error < 3e-3, "{error:e}");
}

/// Few steps do at a percent: less than two hundred and fifty for the rough cases, whatever changes its mode.
#[test]
fn a_percent_takes_few_steps() {
    for name in ["rough-coulomb", "rough-shear", "figure-7-low", "figure-7-middle", "figure-7-high", "stuck-pair"] {
        let (scene, _) = reference(name, "step", "1e-2");
        let run = run(&scene);
        let steps = run.last("solver.steps") + run.last("solver.rejected");
        assert!(steps < 250.0, "{name}: {steps}");
    }
}

/// The mean friction coefficient and the mode changes of a tread block in rubber over 0.25 mm of a slow slide, after
/// as much to settle.
fn slow_slide(method: &str, tolerance: &str) -> (f64, f64) {
    let mut scene = Scene::load(&root().join("tests/physics/scenes/block/block.toml")).unwrap();
    scene.set_by_name("solver.method", method).unwrap();
    scene.set_by_name("solver.relative_tolerance", tolerance).unwrap();
    scene.outputs.push(OutputGroup::Solver);
    let phase = |duration: f64, u: f64, w: f64| {
        let path = |rate: f64| Path { rate, ..Path::default() };
        Phase { duration, u: path(u), w: path(w), until_force: None, until_pressure: None, ..Phase::default() }
    };
    scene.excitation = vec![phase(2e-3, 0.0, -0.05), phase(0.025, 0.01, 0.0), phase(0.025, 0.01, 0.0)];
    let run = run(&scene);
    let mean = |name: &str| run.column(name).iter().rev().take(50).sum::<f64>();
    (-mean("F_x") / mean("F_z"), run.last("solver.events"))
}

/// Steps far longer than the time in which a mass stops: masses that went back until their ends would vibrate, and
/// change their modes a hundred times as often.
#[test]
fn a_slow_slide_does_not_vibrate_at_a_percent() {
    let (friction, changes) = slow_slide("step", "1e-2");
    let (exact, located) = slow_slide("event", "1e-4");
    // A third of the tolerance: errors of single masses cancel in the mean.
    assert!((friction / exact - 1.0).abs() < 3e-3, "{friction}, exact {exact}");
    assert!(changes < 2.0 * located, "{changes} mode changes, {located} located");
}

/// Forces by auto are as near to the event-driven ones as the tolerance of both lets them.
#[test]
fn auto_agrees_with_event() {
    for name in CASES {
        for tolerance in ["1e-4", "1e-6"] {
            let (scene, wanted) = reference(name, "auto", tolerance);
            let found = errors(&scene, &wanted);
            let (scene, wanted) = reference(name, "event", tolerance);
            let event = errors(&scene, &wanted);
            let allowed: f64 = tolerance.parse().unwrap();
            for (found, event) in found.into_iter().zip(event) {
                assert!(found <= 1.5 * event + 7.0 * allowed, "{name} at {tolerance}: {found:e}, event {event:e}");
            }
        }
    }
}

/// `masses` masses slid fast over a profile so rough that most of them touch and lift all the time.
fn rough(masses: usize, method: &str, more: &str) -> Scene {
    let points = 600;
    let x: Vec<f64> = (0..=points).map(|i| 1e-5 * f64::from(i)).collect();
    let mut z: Vec<f64> =
        x.iter().enumerate().map(|(i, x)| 2e-6 * (x * 9e3).sin() + 1e-6 * ((7 * i * i % 31) as f64 / 31.0)).collect();
    z[points as usize] = z[0];
    SceneText::new(masses, 5e-5, 1e-7)
        .vertical((2e3, 8e-3, [(3e3, 1e-6)]))
        .horizontal((1e3, 6e-3, [(8e2, 1e-4)]))
        .lateral_x((5e2, 4e-3, [(2e2, 1e-5)]))
        .lateral_z((3e2, 3e-3))
        .points(&x, &z, true)
        .with("friction = { coulomb = 0.3, shear_force = 1e-4 }")
        .method(method)
        .relative(1e-2)
        .with(more)
        .outputs(&["forces", "dissipation", "friction", "contact", "energy", "solver", "elements", "tangent"])
        .scene()
}

const PRESS: (f64, f64, f64) = (2e-4, 0.0, -0.01);

fn pressed(scene: &Scene) -> Simulation {
    let mut simulation = Simulation::new(scene, &Start::default()).unwrap();
    simulation.advance(&straight(PRESS.0, PRESS.1, PRESS.2)).unwrap();
    simulation
}

/// Many more mode changes than steps, and each step has its end in order: every mass in contact pressed on the profile,
/// every friction force within its limit, every free mass above the profile but for the tolerance.
#[test]
fn the_end_of_every_step_is_consistent_however_many_modes_change() {
    let scene = rough(300, "step", "solver.absolute_tolerance = 1e-6");
    let profile = scene.surface.spline();
    let mut simulation = pressed(&scene);
    // Steps as long as the motions: their ends are those of steps.
    for _ in 0..60 {
        simulation.advance(&straight(5e-6, 1.0, 0.0)).unwrap();
        let values = values(&scene, &simulation.snapshot());
        let get = |name: String| values.iter().find(|(other, _)| *other == name).unwrap().1;
        for i in 1..=300 {
            let of = |part: &str| get(format!("element[{i}].{part}"));
            let (x, z, normal, friction, mode) = (of("x"), of("z"), of("F_N"), of("F_T"), of("mode"));
            let gap = z - profile.evaluate(x).0;
            if mode == 0.0 {
                // A rounding of places of a tenth of a metre at most.
                assert!(gap >= -1e-16, "mass {i} is {gap:e} above the profile");
            } else {
                assert!(gap.abs() < 1e-15 && normal >= 0.0, "mass {i}: gap {gap:e}, F_N {normal:e}");
                let limit = 0.3 * normal + 1e-4;
                assert!(friction.abs() <= limit * (1.0 + 1e-9), "mass {i}: F_T {friction:e}, T {limit:e}");
            }
        }
    }
    let (events, steps) = (
        value(&scene, &simulation.snapshot(), "solver.events"),
        value(&scene, &simulation.snapshot(), "solver.steps")
            + value(&scene, &simulation.snapshot(), "solver.rejected"),
    );
    assert!(events > 1000.0 && events > 10.0 * steps, "{events} mode changes in {steps} steps");
}

/// The whole of a run by step and by auto: it is cloned and saved amid mode changes, and all go on with the same bits.
#[test]
fn a_run_goes_on_bit_for_bit_wherever_it_is_taken_up() {
    for method in ["step", "auto"] {
        let scene = rough(40, method, "");
        let mut first = pressed(&scene);
        let mut to_time_stepping = first.is_time_stepping();
        for i in 0..40 {
            let motion = straight(3e-6, if i < 30 { 1.0 } else { 0.0 }, 0.0);
            let (mut clone, mut restored) = (first.clone(), Simulation::restore(&scene, &first.state()).unwrap());
            assert_eq!(restored.is_time_stepping(), first.is_time_stepping());
            for simulation in [&mut first, &mut clone, &mut restored] {
                simulation.advance(&motion).unwrap();
            }
            let expected = bits(&scene, &first.snapshot());
            let same = [&mut clone, &mut restored].map(|run| bits(&scene, &run.snapshot()) == expected);
            assert_eq!(same, [true; 2], "{method}, motion {i}");
            assert_eq!(clone.state(), first.state());
            assert_eq!(restored.force_rates(), first.force_rates());
            to_time_stepping |= first.is_time_stepping();
        }
        assert!(to_time_stepping);
    }
}

/// What an observer asks within a motion does not change the run; and a motion that fails leaves no trace.
#[test]
fn neither_rows_nor_failures_leave_a_trace() {
    let scene = rough(40, "step", "solver.max_steps = 300");
    let mut plain = pressed(&scene);
    let mut observed = plain.clone();
    let motion = straight(1e-4, 1.0, 0.0);
    let times: Vec<f64> = (0..=100).map(|i| 1e-6 * f64::from(i)).collect();
    let mut rows = 0;
    assert!(observed.advance(&straight(1.0, 1.0, 0.0)).is_err());
    observed
        .advance_observed(&motion, None, &times, |_, now| {
            let residual = value(&scene, now, "energy.residual");
            assert!(residual.is_finite());
            rows += 1;
        })
        .unwrap();
    plain.advance(&motion).unwrap();
    // The errors are those of the rows, as many as there are.
    let lasting = |snapshot: &Snapshot<'_>| {
        let mut values = values(&scene, snapshot);
        values.retain(|(name, _)| !name.starts_with("solver.error"));
        values
    };
    assert_eq!((rows, lasting(&plain.snapshot())), (101, lasting(&observed.snapshot())));
}

/// F_z reaches the force asked for, at a time that the event-driven run agrees with.
#[test]
fn a_motion_ends_where_the_force_is_reached() {
    let reached = ["step", "auto", "event"].map(|method| {
        let scene = rough(40, method, "solver.absolute_tolerance = 1e-9");
        let mut simulation = Simulation::new(&scene, &Start::default()).unwrap();
        let time =
            simulation.advance_observed(&straight(1e-3, 0.0, -0.01), Some(0.2), &[], |_, _| ()).unwrap().unwrap();
        let force = value(&scene, &simulation.snapshot(), "F_z");
        // A percent is the tolerance.
        assert!((force - 0.2).abs() < 2e-3, "{method}: {force}");
        assert_eq!(simulation.time(), time);
        time
    });
    assert!(reached.iter().all(|time| (time / reached[2] - 1.0).abs() < 1e-2), "{reached:?}");
}

/// auto goes over to time-stepping in the rough slide and back at rest, and says when.
#[test]
fn auto_hands_over_where_mode_changes_crowd_and_back() {
    let scene = rough(100, "auto", "");
    let mut simulation = Simulation::new(&scene, &Start::default()).unwrap();
    simulation.record_method_switches(true);
    // At rest steps grow long: the pieces of the motion keep them short.
    let slide = [straight(2e-4, 0.0, -0.01), straight(3e-4, 1.0, 0.0)];
    for motion in slide.into_iter().chain([straight(1e-5, 0.0, 0.0); 200]) {
        simulation.advance(&motion).unwrap();
    }
    let switches = simulation.take_method_switches();
    let to_and_fro: Vec<bool> = switches.iter().map(|switch| switch.to_time_stepping).collect();
    assert!(to_and_fro.len() >= 2 && to_and_fro.len().is_multiple_of(2), "{switches:?}");
    assert!(
        to_and_fro.iter().enumerate().all(|(i, to_time_stepping)| *to_time_stepping == (i % 2 == 0)),
        "{switches:?}"
    );
    assert!(!simulation.is_time_stepping() && switches[1].time > 5e-4, "{switches:?}");
    assert!(switches[0].to_string().contains("time-stepping from here on"));
    let lively = |method: &str| {
        let mut simulation = pressed(&rough(100, method, ""));
        simulation.record_method_switches(true);
        simulation.advance(&straight(3e-4, 1.0, 0.0)).unwrap();
        simulation.take_method_switches().len()
    };
    assert_eq!((lively("step"), lively("event")), (0, 0));
}

/// ∂F/∂u and ∂F/∂w at the end of a motion against a difference quotient by rollback; no mode changes on the way.
#[test]
fn tangents_are_those_of_a_difference_quotient() {
    let mut scene = rough(6, "step", "solver.absolute_tolerance = 1e-12");
    scene.solver.relative_tolerance = 3e-5;
    let start = Simulation::new(&scene, &Start { w: -8e-6, u_rate: 0.5, ..Start::default() }).unwrap();
    let after = |u: f64, w: f64| {
        let mut simulation = start.clone();
        let duration = 1e-6;
        simulation.advance(&straight(duration, 0.5 + u / duration, w / duration)).unwrap();
        ["F_x", "F_z", "solver.events", "tangent.dF_x_du", "tangent.dF_z_du", "tangent.dF_x_dw", "tangent.dF_z_dw"]
            .map(|name| value(&scene, &simulation.snapshot(), name))
    };
    let tangents = after(0.0, 0.0);
    let moved = 1e-11;
    for (axis, (u, w)) in [(moved, 0.0), (0.0, moved)].into_iter().enumerate() {
        let (up, down) = (after(u, w), after(-u, -w));
        assert_eq!(up[2], down[2], "a mode has changed");
        for force in 0..2 {
            let (found, quotient) = (tangents[3 + 2 * axis + force], (up[force] - down[force]) / (2.0 * moved));
            // Steps are chosen anew for every run, and with them the error, which the quotient magnifies: by less than
            // 1e-2 N/m at this tolerance, by 3e-2 at three times it.
            assert!((found - quotient).abs() < 1e-2, "{axis} {force}: {found} {quotient}");
        }
    }
}

/// A mass that comes down fast on a bend goes on along it with the speed that its impact left: from the touch to the
/// end of the step the bend is counted once.
#[test]
fn a_mass_that_touches_on_a_bend_keeps_its_speed() {
    let scene = SceneText::new(1, 1e-4, 1e-7)
        .vertical(10.0)
        .sinusoid(4e-6, 4e-5)
        .method("step")
        .relative(1e-4)
        .outputs(&["energy", "dissipation", "contact", "solver"])
        .scene();
    for i in 0..10 {
        // Nothing holds the mass along x, so it flies at the speed that it started with.
        let start = Start { u: 4e-6 * f64::from(i), w: 6e-6, u_rate: 5.0, w_rate: -1.0, ..Start::default() };
        let mut simulation = Simulation::new(&scene, &start).unwrap();
        let kinetic = value(&scene, &simulation.snapshot(), "energy.kinetic");
        simulation.advance(&straight(2e-4, 0.0, 0.0)).unwrap();
        assert!(value(&scene, &simulation.snapshot(), "dissipation.E_impact") > 0.0, "it touches");
        let residual = value(&scene, &simulation.snapshot(), "energy.residual");
        // The tolerance.
        assert!(residual.abs() <= 1e-4 * kinetic, "start {i}: {residual:e} J of {kinetic:e} J");
    }
}
