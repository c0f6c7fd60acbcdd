//! Scenes that random cases found something in, as ordinary tests.

use asperity::outputs::Output;
use asperity::simulation::{Simulation, Start};

use crate::common::scenes::SceneText;
use crate::physics::invariants::case::Case;
use crate::physics::invariants::trust::{Units, largest_energy};

/// One heavy mass off the end of a fine profile, flung into it: it touches at 6 m/s on bends of some 10 µm, and what
/// the rest of the step did to its speed was counted twice, a tenth of all energy.
#[test]
fn a_mass_flung_into_a_fine_profile() {
    let text = SceneText::new(1, 1.4e-4, 3.19e-6)
        .set("layer.initial", "undeformed")
        .with("layer.vertical = { maxwell = [{ stiffness = 139.0, relaxation_time = 7.2 }] }")
        .horizontal(3.6)
        .points(
            &[-4.0e-5, -2.6e-5, -1.55e-5, -6.0e-7, 8.0e-6, 2.0e-5, 4.2e-5],
            &[-4.6e-6, 2.6e-6, -1.6e-6, -5.2e-6, 5.8e-6, -3.2e-6, -3.1e-6],
            false,
        )
        .method("step")
        .tolerances(1e-5, 3e-10)
        .outputs(&["forces", "dissipation", "friction", "contact", "energy", "solver", "elements"])
        .phase("duration = 2e-4, w_rate = -1e-3");
    for i in 0..20 {
        let start = Start { u: 6e-5 + 1e-6 * f64::from(i), w: 2e-5, u_rate: -4.5, w_rate: -2.0, ..Start::default() };
        let case = Case::from_text(&text, start);
        let record = case.run(6).unwrap();
        let unit = Units::of(&case).energy(largest_energy(&case, &record));
        let missed = record.largest(Output::EnergyResidual) / unit;
        // As the property has it, for some hundred steps.
        let allowed = (0.1 * record.largest(Output::Steps)).max(10.0);
        assert!(missed <= allowed, "start {i}: {missed} units, allowed {allowed}");
    }
}

/// A mass that lifts leaves the profile under it behind, in one of two rooms: what is saved must not show in which.
#[test]
fn a_restored_run_is_saved_as_the_one_that_went_on() {
    let text = SceneText::new(1, 1e-3, 1e-5)
        .with("layer.horizontal = { maxwell = [{ stiffness = 10.0, relaxation_time = 6.3e-3 }] }")
        .points(
            &[-8.4e-3, -6.9e-3, -5.1e-3, -3.6e-3, -2.5e-3, -1.6e-3, 7.8e-4],
            &[8.0e-5, -1.1e-4, 5.8e-5, -1.3e-4, -1.2e-4, -1.1e-4, 1.2e-4],
            false,
        )
        .coulomb(0.18)
        .method("step")
        .tolerances(2.5e-5, 2.3e-9)
        .phase("duration = 1.4e-2, u_rate = -1.6e-2, u_sine = { amplitude = 5e-5, frequency = 143.0 }, w_rate = 8.9e-4")
        .phase("duration = 3.3e-3, u_rate = -1.6e-2, w_rate = 8.9e-4");
    let start = Start { u: 1.37e-2, w: -2.9e-5, u_rate: -1.7e-3, ..Start::default() };
    let case = Case::from_text(&text, start);
    let mut run = case.started();
    for motion in &case.motions {
        let mut restored = Simulation::restore(&case.scene, &run.state()).unwrap();
        run.advance(motion).unwrap();
        restored.advance(motion).unwrap();
        assert_eq!(run.state(), restored.state());
    }
}
