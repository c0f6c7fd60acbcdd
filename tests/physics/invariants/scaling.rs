//! No unit is special: a scene in other units gives the same.

use asperity::scene::{CarrierBody, Force, Link, Path, Surface, Unit};
use asperity::simulation::{Motion, Start};
use proptest::prelude::*;

use crate::physics::invariants::case::Case;
use crate::physics::invariants::check::check;
use crate::physics::invariants::random::{cases, cases_with_bodies};

/// Below this, in any unit, a number is what is left of a decay.
const TINY: f64 = 1e-250;

/// Powers of two by which lengths, masses and times are multiplied.
#[derive(Clone, Copy, Debug)]
struct Powers {
    length: i32,
    mass: i32,
    time: i32,
}

impl Powers {
    /// 2 to the power of a quantity whose dimension has these exponents of length, mass and time.
    fn of(self, length: i32, mass: i32, time: i32) -> f64 {
        2.0_f64.powi(self.length * length + self.mass * mass + self.time * time)
    }

    fn of_unit(self, unit: Unit) -> f64 {
        match unit {
            Unit::One => 1.0,
            Unit::Meter => self.of(1, 0, 0),
            Unit::MeterPerSecond => self.of(1, 0, -1),
            Unit::Second => self.of(0, 0, 1),
            Unit::Newton => self.of(1, 1, -2),
            Unit::Joule => self.of(2, 1, -2),
            Unit::Watt => self.of(2, 1, -3),
            Unit::NewtonPerMeter => self.of(0, 1, -2),
            other => panic!("no output has the unit {other:?}"),
        }
    }

    fn link(self, link: &mut Link) {
        let (stiffness, damping) = (self.of(0, 1, -2), self.of(0, 1, -1));
        link.stiffness.iter_mut().for_each(|c| *c *= stiffness);
        link.damping.iter_mut().for_each(|d| *d *= damping);
        for element in &mut link.maxwell {
            element.stiffness *= stiffness;
            element.relaxation_time *= self.of(0, 0, 1);
        }
    }

    fn path(self, path: Path) -> Path {
        let Path { rate, amplitude, frequency } = path;
        Path {
            rate: rate * self.of(1, 0, -1),
            amplitude: amplitude * self.of(1, 0, 0),
            frequency: frequency * self.of(0, 0, -1),
        }
    }

    fn force(self, force: Force) -> Force {
        let (size, Path { rate, amplitude, frequency }) = (self.of(1, 1, -2), force.change);
        let change = Path {
            rate: rate * size * self.of(0, 0, -1),
            amplitude: amplitude * size,
            frequency: frequency * self.of(0, 0, -1),
        };
        Force { start: force.start.map(|start| start * size), change }
    }

    fn body(self, body: &mut CarrierBody) {
        body.mass *= self.of(0, 1, 0);
        body.stiffness.iter_mut().for_each(|stiffness| *stiffness *= self.of(0, 1, -2));
        body.damping.iter_mut().for_each(|damping| *damping *= self.of(0, 1, -1));
        body.start_rate.iter_mut().for_each(|rate| *rate *= self.of(1, 0, -1));
    }

    /// Every quantity of the case times the power of its dimension.
    fn case(self, case: &Case) -> Case {
        let (length, mass, time, speed) = (self.of(1, 0, 0), self.of(0, 1, 0), self.of(0, 0, 1), self.of(1, 0, -1));
        let mut scaled = case.clone();
        let scene = &mut scaled.scene;
        let layer = &mut scene.layer;
        for value in
            [&mut layer.spacing, &mut layer.origin, &mut layer.clearance].into_iter().chain(&mut layer.roughness)
        {
            *value *= length;
        }
        layer.mass.iter_mut().for_each(|each| *each *= mass);
        layer.links.iter_mut().flatten().for_each(|link| self.link(link));
        scene.carrier.x.iter_mut().chain(&mut scene.carrier.z).for_each(|body| self.body(body));
        let [x, z] =
            [scene.surface.x(), scene.surface.z()].map(|points| points.iter().map(|value| value * length).collect());
        scene.surface = Surface::new(x, z, scene.surface.is_periodic());
        let memory = scene.friction.iter_mut().flat_map(|friction| &mut friction.memory);
        memory.for_each(|way| *way *= length);
        let shear = scene.friction.iter_mut().flat_map(|friction| &mut friction.shear_force);
        shear.for_each(|force| *force *= self.of(1, 1, -2));
        for law in scene.friction.iter_mut().flat_map(|friction| &mut friction.rate_shear) {
            law.force.iter_mut().for_each(|force| *force *= self.of(1, 1, -2));
            law.reference_speed *= speed;
            law.creep_speed.iter_mut().for_each(|creep| *creep *= speed);
        }
        scene.solver.absolute_tolerance.iter_mut().for_each(|tolerance| *tolerance *= length);
        let Start { time: t, u, w, u_rate, w_rate, .. } = case.start;
        scaled.start = Start {
            time: t * time,
            u: u * length,
            w: w * length,
            u_rate: u_rate * speed,
            w_rate: w_rate * speed,
            ..Start::default()
        };
        for motion in &mut scaled.motions {
            let Motion { duration, u, w, .. } = *motion;
            let (load, pull) = (self.force(motion.load), self.force(motion.pull));
            *motion =
                Motion { duration: duration * time, u: self.path(u), w: self.path(w), load, pull, ..Motion::REST };
        }
        scaled
    }
}

fn powers() -> impl Strategy<Value = Powers> {
    (-20..=20, -20..=20, -20..=20).prop_map(|(length, mass, time)| Powers { length, mass, time })
}

/// The tolerances are a share of lengths and of what the scene's own stiffest frequency makes of them, so nothing is
/// left that has a unit; and a product with a power of two has no rounding. So every number is scaled to its last bit.
/// But for a scene without any spring or damper: it has no time of its own, and its speeds' tolerance counts in
/// seconds.
#[test]
fn a_scene_in_other_units_is_the_same_to_the_last_bit() {
    check("other units", 150, (cases(), powers()), is_the_same_in_other_units);
}

/// The same under a carrier that is a body.
#[test]
fn a_body_in_other_units_is_the_same_to_the_last_bit() {
    check("a body in other units", 100, (cases_with_bodies(), powers()), is_the_same_in_other_units);
}

fn is_the_same_in_other_units((case, powers): (Case, Powers)) -> Result<(), TestCaseError> {
    let scaled = powers.case(&case);
    prop_assume!(case.has_a_time_of_its_own());
    let run = |case: &Case| case.run(4).map_err(|error| TestCaseError::fail(format!("{error}")));
    let (one, other) = (run(&case)?, run(&scaled)?);
    for (column, variable) in one.variables.iter().enumerate() {
        let factor = powers.of_unit(variable.unit);
        for (row, (a, b)) in one.rows.iter().zip(&other.rows).enumerate() {
            let (a, b) = (factor * a[column], b[column]);
            // Numbers near the smallest that there are lose digits: no force or energy is meant by these.
            let nothing = a.abs().max(b.abs()) < TINY;
            prop_assert!(a == b || nothing, "{} in row {row}: {a:e} {b:e}", variable.name);
        }
    }
    Ok(())
}
