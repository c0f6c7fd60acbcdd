//! Balances of forces, and what must not matter: how far the carrier has gone.

use asperity::scene::Path;
use asperity::simulation::{Motion, Start};

use crate::common::random::Random;
use crate::common::runs::even_times;
use crate::common::scenes::SceneText;
use crate::common::{difference, largest};
use crate::physics::exact::run::{REST, Run, mean, rate, sine, steps};

const MASSES: usize = 4;
const SPACING: f64 = 1.0 / 8192.0;
/// A power of two, so that far positions are multiples of it to the last digit.
const PERIOD: f64 = 1.0 / 2048.0;
const POINTS: usize = 32;

/// A rough profile of one period, and a layer that is pressed on it by 10 µm.
fn scene() -> SceneText {
    let mut random = Random::new(11);
    let x: Vec<f64> = (0..=POINTS).map(|i| PERIOD * i as f64 / POINTS as f64).collect();
    let mut z: Vec<f64> = (0..=POINTS).map(|_| random.between(-1.0e-6, 1.0e-6)).collect();
    z[POINTS] = z[0];
    let roughness: Vec<f64> = (0..MASSES).map(|_| random.between(-1.0e-6, 1.0e-6)).collect();
    SceneText::new(MASSES, SPACING, 1e-7)
        .roughness(&roughness)
        .vertical((2.0e3, 4.0e-3, [(1.0e3, 1.0e-4)]))
        .horizontal((2.0e3, 4.0e-3, [(600.0, 2.0e-5)]))
        .lateral_x((500.0, 2.0e-3))
        .lateral_z((300.0, 1.0e-3, [(200.0, 3.0e-5)]))
        .points(&x, &z, true)
        .coulomb(0.1)
        .set("friction.shear_force", 5e-4)
        .tolerances(1e-9, 1e-15)
}

const NAMES: [&str; 8] = [
    "F_x",
    "F_z",
    "contact.F_x",
    "contact.F_z",
    "friction.F_hysteresis",
    "friction.F_adhesion",
    "dissipation.E_friction",
    "element[1].x",
];

/// Pressed, slid, vibrated and slid back from u = `from`; the columns of NAMES.
fn travel(from: f64, motions: &[(f64, Path, Path)]) -> Vec<Vec<f64>> {
    let mut run = Run::new(&scene(), Start { u: from, w: -4.0e-6, ..Start::default() });
    let mut columns = vec![Vec::new(); NAMES.len()];
    for (duration, u, w) in motions {
        let times = even_times(*duration, 40);
        let motion = Motion { duration: *duration, u: *u, w: *w, ..Motion::default() };
        for (column, more) in columns.iter_mut().zip(run.sample(&motion, &times, &NAMES)) {
            column.extend(more);
        }
    }
    let events = run.events();
    assert!(events.len() > 10, "masses come, go, slip and stick");
    columns
}

/// Motions whose u is exact: rates and durations are powers of two, and each ends at a multiple of 2^-20 m.
fn exact_motions() -> Vec<(f64, Path, Path)> {
    let duration = 1.0 / 8192.0;
    let motions = [(0.25, -0.02), (1.0, 0.0), (-1.0, 0.01), (-0.125, -0.02), (0.5, 0.02)];
    motions.map(|(u, w)| (duration, rate(u), rate(w))).to_vec()
}

/// Motions that end anywhere.
fn other_motions() -> Vec<(f64, Path, Path)> {
    vec![(1.0e-4, rate(0.3), rate(-0.03)), (2.0e-4, sine(3.0e-5, 7.0e3), REST), (1.0e-4, rate(-0.7), rate(0.01))]
}

/// What the surface does to the layer splits into the normal forces on the slopes and the friction, F_x of the contacts
/// = -Σ F_N s/q - Σ F_T/q.
#[test]
fn the_contact_force_is_hysteresis_and_adhesion() {
    let columns = travel(0.0, &other_motions());
    let sum: Vec<f64> =
        columns[4].iter().zip(&columns[5]).map(|(hysteresis, adhesion)| hysteresis + adhesion).collect();
    assert!(difference(&sum, &columns[2]) <= 1e-15 * largest(&columns[2]));
    assert!(largest(&columns[4]) > 0.01 * largest(&columns[2]), "slopes count");
}

/// In a steady slide all comes again after a wavelength, the layer's momentum too: so on the mean the contacts' forces
/// are those on the carrier, along x and along z.
#[test]
fn contact_forces_are_the_carriers_on_the_mean() {
    let scene = SceneText::new(2, 1.3e-4, 1e-7)
        .vertical((2.0e3, 4.0e-3, [(1.0e3, 2.0e-5)]))
        .horizontal((2.0e3, 8.0e-3))
        .lateral_z((300.0, 1.0e-3))
        .sinusoid(2e-6, 4e-4)
        .set("surface.points_per_wavelength", 256)
        .coulomb(0.1)
        .set("friction.shear_force", 1e-3)
        .tolerances(1e-9, 1e-15);
    let (v, period) = (0.5, 8.0e-4);
    let mut run = Run::new(&scene, Start { w: -1.0e-5, u_rate: v, ..Start::default() });
    let motion = Motion { duration: 6.0 * period, u: rate(v), w: REST, ..Motion::default() };
    let times = steps((4.0 * period, 5.0 * period), 512);
    let columns = run.sample(&motion, &times, &NAMES);
    assert!(run.get("contact.count") == 2.0 && run.get("contact.sticking") == 0.0);
    for (on_carrier, contact) in [(0, 2), (1, 3)] {
        let (mean_carrier, mean_contact) = (mean(&columns[on_carrier]), mean(&columns[contact]));
        let error = (mean_carrier - mean_contact).abs() / largest(&columns[contact]);
        // As good as the dense output at the samples.
        assert!(error <= 1e-7, "{}: {error:e}", NAMES[contact]);
        let swing = difference(&columns[on_carrier], &columns[contact]);
        assert!(swing > 1e-4 * largest(&columns[contact]), "inertia makes them differ at most times");
    }
}

/// The largest differences of two travels, over the largest values: of forces, energy, and the position of the first mass
/// less where the carrier started (m).
fn apart(near: &[Vec<f64>], far: &[Vec<f64>], offset: f64) -> (f64, f64) {
    let forces = (0..7).map(|column| difference(&near[column], &far[column]) / largest(&near[column]));
    let positions: Vec<f64> = far[7].iter().map(|x| x - offset).collect();
    (forces.fold(0.0, f64::max), difference(&near[7], &positions))
}

/// Over a periodic profile a carrier that starts 2^20 m away, 2^31 periods, sees the same. Where u comes to exact
/// values at the ends of the motions nothing is lost at all; only the positions, as outputs, are rounded, twice by up to
/// 2^-33 m.
#[test]
fn a_far_carrier_loses_nothing_where_u_is_exact() {
    let offset = 2.0_f64.powi(20);
    let (near, far) = (travel(0.0, &exact_motions()), travel(offset, &exact_motions()));
    let (forces, positions) = apart(&near, &far, offset);
    assert_eq!(forces, 0.0);
    assert!(positions <= 2.0_f64.powi(-32), "{positions:e}");
}

/// Elsewhere u itself is rounded at the end of each motion: by up to 2^-33 m = 1.2e-10 m at 2^20 m, 2^-43 m at 2^10 m.
/// On slopes of 0.1 that moves springs of 3 kN/m by 3e-8 N of some 1e-2 N, 1e-5 of the force with three motions, and
/// what friction and events make of it. The positions are rounded five times.
#[test]
fn a_far_carrier_loses_what_rounding_takes_from_u() {
    let near = travel(0.0, &other_motions());
    for (power, allowed) in [(20, 1e-4), (10, 1e-4 / 1024.0)] {
        let offset = 2.0_f64.powi(power);
        let (forces, positions) = apart(&near, &travel(offset, &other_motions()), offset);
        assert!(forces <= allowed, "2^{power} m: {forces:e}");
        assert!(positions <= 8.0 * 2.0_f64.powi(power - 53), "2^{power} m: {positions:e}");
    }
}
