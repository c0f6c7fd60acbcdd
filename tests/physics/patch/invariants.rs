//! What must hold of every patch and every motion: random ones.

use std::f64::consts::{PI, TAU};
use std::fs;
use std::sync::atomic::{AtomicUsize, Ordering};

use asperity::patch::{Patch, PatchMotion, PatchOutput, PatchRun, PatchStart, PatchVariable, Pose};
use proptest::collection::vec;
use proptest::option;
use proptest::prelude::*;

use crate::common::{root, scratch};
use crate::physics::invariants::check::check;

/// Points of a random patch: x, y, z (m) and area (m²).
type Points = Vec<[f64; 4]>;

/// The elements of a random patch.
#[derive(Clone, Debug)]
enum Elements {
    Single(Points),
    /// On a cylinder or flat, columns and rows, with a tread or not.
    Grid {
        radius: Option<f64>,
        columns: usize,
        rows: usize,
        transport: bool,
        /// Whether it stands on what gives way.
        backing: bool,
    },
}

#[derive(Clone, Copy, Debug)]
struct Step {
    duration: f64,
    rates: [f64; 6],
    speed: f64,
}

#[derive(Clone, Debug)]
struct Case {
    elements: Elements,
    pose: [f64; 6],
    rates: [f64; 6],
    steps: Vec<Step>,
}

fn signed(powers: std::ops::Range<f64>) -> impl Strategy<Value = f64> + Clone {
    (powers, any::<bool>()).prop_map(|(power, negative)| if negative { -1.0 } else { 1.0 } * 10.0_f64.powf(power))
}

/// Some millimetres apart, up to 10 µm high, as the table's profile is.
fn points() -> impl Strategy<Value = Points> {
    let point = (-5e-3..5e-3, -5e-3..5e-3, -5e-6..5e-6, -8.0..-5.0_f64);
    vec(point.prop_map(|(x, y, z, area)| [x, y, z, 10.0_f64.powf(area)]), 1..6)
}

fn elements() -> impl Strategy<Value = Elements> {
    let radius = option::of(prop_oneof![Just(0.02), Just(0.3)]);
    let grid = (radius, 1..5_usize, 1..4_usize, any::<[bool; 2]>());
    prop_oneof![
        points().prop_map(Elements::Single),
        grid.prop_map(|(radius, columns, rows, [transport, backing])| Elements::Grid {
            radius,
            columns,
            rows,
            transport,
            backing
        }),
    ]
}

/// Of a body that slides, tilts, turns and lifts.
fn rates() -> impl Strategy<Value = [f64; 6]> {
    (signed(-3.0..1.0), signed(-3.0..1.0), -2e-3..2e-3, -0.2..0.2, -0.2..0.2, -6.0..6.0)
        .prop_map(|(x, y, z, roll, pitch, yaw)| [x, y, z, roll, pitch, yaw])
}

fn pose() -> impl Strategy<Value = [f64; 6]> {
    (-4e-6..1.5e-5, -1e-3..1e-3, -1e-3..1e-3, -PI..PI).prop_map(|(z, roll, pitch, yaw)| [0.0, 0.0, z, roll, pitch, yaw])
}

fn cases() -> impl Strategy<Value = Case> {
    let step = (-5.0..-2.3_f64, rates(), -0.2..0.2).prop_map(|(power, rates, speed)| Step {
        duration: 10.0_f64.powf(power),
        rates,
        speed,
    });
    (elements(), pose(), rates(), vec(step, 1..6)).prop_map(|(elements, pose, rates, steps)| Case {
        elements,
        pose,
        rates,
        steps,
    })
}

impl Elements {
    fn patch(&self) -> Patch {
        static COUNT: AtomicUsize = AtomicUsize::new(0);
        let folder = scratch(&format!("patch-invariants-{}", COUNT.fetch_add(1, Ordering::Relaxed)));
        fs::copy(root().join("tests/reference/patch/block.table.csv"), folder.join("block.table.csv")).unwrap();
        let face = match self {
            Self::Single(points) => {
                let line = |[x, y, z, area]: &[f64; 4]| format!("{x:?},{y:?},{z:?},{area:?}\n");
                let text: String = points.iter().map(line).collect();
                fs::write(folder.join("points.csv"), format!("x,y,z,area\n{text}")).unwrap();
                "shape = 'points'\npath = 'points.csv'".to_owned()
            }
            Self::Grid { radius, columns, rows, transport, backing } => {
                // The pose's point is on the face, whatever the radius.
                let shape =
                    radius.map_or("'flat'".into(), |r| format!("'cylinder'\nradius = {r}\noffset = [0, 0, {r}]"));
                let backing = if *backing { "backing = { normal = 7.5e9, shear = 2.5e9 }" } else { "" };
                format!(
                    "shape = {shape}\nlength = 1e-3\nwidth = 2e-3\nnx = {columns}\nny = {rows}\ntransport = \
                     {transport}\n{backing}"
                )
            }
        };
        let text = format!(
            "name = 'random'\ntable = {{ path = 'block.table.csv' }}\n\
             fmu = {{ outputs = ['forces', 'dissipation', 'energy', 'elements'] }}\n[patch]\n{face}\n"
        );
        let patch = Patch::parse(&text, &folder.join("patch.toml")).unwrap();
        fs::remove_dir_all(folder).unwrap();
        patch
    }
}

/// What a run gives after each step: the wrench, and the energy lost.
type Loads = Vec<[f64; 7]>;

/// A run and its outputs.
struct Probe {
    patch: Patch,
    run: PatchRun,
    variables: Vec<PatchVariable>,
    values: Vec<f64>,
}

impl Probe {
    fn new(patch: Patch, pose: [f64; 6], rates: [f64; 6]) -> Self {
        let (pose, temperature) = (Pose::from_coordinates(pose), patch.temperature());
        let start = PatchStart { time: 0.0, pose, rates, transport_speed: 0.0, temperature };
        let (run, variables) = (PatchRun::new(&patch, &start).unwrap(), patch.variables());
        let mut probe = Self { run, patch, values: vec![f64::NAN; variables.len()], variables };
        probe.run.evaluate(&probe.variables, &mut probe.values);
        probe
    }

    fn advance(&mut self, step: &Step) {
        let Step { duration, rates, speed } = *step;
        let transport_speed = if self.patch.has_tread() { speed } else { 0.0 };
        let temperature = self.patch.temperature();
        self.run.advance(&PatchMotion { duration, rates, transport_speed, temperature }).unwrap();
        self.run.evaluate(&self.variables, &mut self.values);
    }

    fn value(&self, output: PatchOutput) -> f64 {
        self.values[self.variables.iter().position(|variable| variable.output == output).unwrap()]
    }

    fn loads(&self) -> [f64; 7] {
        std::array::from_fn(|i| match i {
            0..3 => self.value(PatchOutput::Force(i)),
            3..6 => self.value(PatchOutput::Moment(i - 3)),
            _ => self.value(PatchOutput::Energy),
        })
    }
}

impl Case {
    fn run(&self) -> Loads {
        let mut probe = Probe::new(self.elements.patch(), self.pose, self.rates);
        let follow = |step: &Step| {
            probe.advance(step);
            probe.loads()
        };
        self.steps.iter().map(follow).collect()
    }

    /// The same with other poses and velocities.
    fn with(&self, pose: impl Fn([f64; 6]) -> [f64; 6], rates: impl Fn([f64; 6]) -> [f64; 6]) -> Self {
        let steps = self.steps.iter().map(|step| Step { rates: rates(step.rates), ..*step }).collect();
        Self { elements: self.elements.clone(), pose: pose(self.pose), rates: rates(self.rates), steps }
    }
}

/// Forces and moments, all in the size of the largest force, and energies in that of the largest.
fn same(name: &str, found: &Loads, expected: &Loads, tolerance: f64) -> Result<(), TestCaseError> {
    let largest = |from: usize, to: usize| {
        let all = expected.iter().flat_map(|loads| &loads[from..to]);
        all.fold(0.0_f64, |most, load| most.max(load.abs()))
    };
    let force = largest(0, 3);
    // A moment at an arm of a millimetre, an energy over a nanometre.
    let (moment, energy) = (largest(3, 6).max(1e-3 * force), largest(6, 7).max(1e-9 * force));
    for (found, expected) in found.iter().zip(expected) {
        for i in 0..7 {
            let scale = [force, moment, energy][i / 3];
            let difference = (found[i] - expected[i]).abs();
            prop_assert!(difference <= tolerance * scale, "{}: {}: {:?} {:?}", name, i, found, expected);
        }
    }
    Ok(())
}

/// Rounding of heights of 0.3 m to the micrometres over which pressures change, and of angles of some turns.
const ROUNDING: f64 = 1e-8;

fn turned(angle: f64, [x, y]: [f64; 2]) -> [f64; 2] {
    [angle.cos() * x - angle.sin() * y, angle.sin() * x + angle.cos() * y]
}

#[test]
fn turned_about_z_the_wrench_turns() {
    check("turned about z", 300, (cases(), -PI..PI), |(case, angle)| {
        let turn = |mut all: [f64; 6]| {
            [all[0], all[1]] = turned(angle, [all[0], all[1]]);
            all
        };
        let there = case
            .with(
                |pose| {
                    let mut pose = turn(pose);
                    pose[5] += angle;
                    pose
                },
                turn,
            )
            .run();
        let expected: Loads = case
            .run()
            .into_iter()
            .map(|[x, y, z, m_x, m_y, m_z, lost]| {
                let ([x, y], [m_x, m_y]) = (turned(angle, [x, y]), turned(angle, [m_x, m_y]));
                [x, y, z, m_x, m_y, m_z, lost]
            })
            .collect();
        same("turned", &there, &expected, ROUNDING)
    });
}

/// Mirrored at the plane y = 0, and, a tread and its speed too, at x = 0.
#[test]
fn a_mirrored_motion_gives_the_mirrored_wrench() {
    let across = ([1.0, -1.0, 1.0, -1.0, 1.0, -1.0], 1.0, [1.0, -1.0]);
    let along = ([-1.0, 1.0, 1.0, 1.0, -1.0, -1.0], -1.0, [-1.0, 1.0]);
    check("mirrored", 300, (cases(), any::<bool>()), |(case, is_across)| {
        let (signs, tread, place) = if is_across { across } else { along };
        let mirror = |all: [f64; 6]| std::array::from_fn(|i| signs[i] * all[i]);
        let mut there = case.with(mirror, mirror);
        there.steps.iter_mut().for_each(|step| step.speed *= tread);
        if let Elements::Single(points) = &mut there.elements {
            points.iter_mut().for_each(|point| (point[0], point[1]) = (place[0] * point[0], place[1] * point[1]));
        }
        let mirrored = |loads: [f64; 7]| std::array::from_fn(|i| if i < 6 { signs[i] * loads[i] } else { loads[i] });
        let expected: Loads = case.run().into_iter().map(mirrored).collect();
        same("mirrored", &there.run(), &expected, ROUNDING)
    });
}

/// The ground has no places, and a turn is where it began.
#[test]
fn places_and_whole_turns_do_not_matter() {
    check("moved", 200, (cases(), -1.0..1.0, -1.0..1.0, -3..4_i32), |(case, x, y, turns)| {
        let moved = |mut pose: [f64; 6]| {
            pose[0] += x;
            pose[1] += y;
            pose[5] += f64::from(turns) * TAU;
            pose
        };
        same("moved", &case.with(moved, |rates| rates).run(), &case.run(), ROUNDING)
    });
}

/// Elements do not feel each other, and an element is as many as its area says.
#[test]
fn elements_add_up_and_areas_scale() {
    check("elements add up", 200, (cases(), points(), points()), |(case, one, other)| {
        let of = |points: Points| Case { elements: Elements::Single(points), ..case.clone() }.run();
        let all: Points = other.iter().chain(&one).copied().collect();
        let sums = of(one.clone()).into_iter().zip(of(other));
        let sum: Loads = sums.map(|(a, b)| std::array::from_fn(|i| a[i] + b[i])).collect();
        same("a sum", &of(all), &sum, ROUNDING)?;
        let larger = of(one.iter().map(|[x, y, z, area]| [*x, *y, *z, 8.0 * area]).collect());
        let expected: Loads = of(one).into_iter().map(|loads| loads.map(|load| 8.0 * load)).collect();
        same("a larger area", &larger, &expected, ROUNDING)
    });
}

/// A straight motion at constant height, at any tilt, however it is cut; from springs loaded in any direction.
#[test]
fn a_straight_path_may_be_cut_anyhow() {
    let cuts = vec(0.01..1.0_f64, 2..6);
    check("straight paths", 300, (cases(), cuts), |(case, cuts)| {
        let mut case = case;
        if let Elements::Grid { transport, .. } = &mut case.elements {
            *transport = false;
        }
        let level = |[x, y, ..]: [f64; 6]| [x, y, 0.0, 0.0, 0.0, 0.0];
        let whole = case.with(|pose| pose, level);
        let sum: f64 = cuts.iter().sum();
        let pieces =
            |step: &Step| cuts.iter().map(|cut| Step { duration: step.duration * cut / sum, ..*step }).collect();
        let mut cut = whole.clone();
        cut.steps = whole.steps.iter().flat_map(|step| -> Vec<Step> { pieces(step) }).collect();
        let ends: Loads = cut.run().into_iter().skip(cuts.len() - 1).step_by(cuts.len()).collect();
        same("a path in pieces", &ends, &whole.run(), ROUNDING)
    });
}

/// Where a point of the body is along the plane.
fn place([x, y, _, roll, pitch, yaw]: [f64; 6], r: [f64; 4]) -> [f64; 2] {
    let [a, b, c] = [r[0], r[1], r[2]];
    let (b, c) = (roll.cos() * b - roll.sin() * c, roll.sin() * b + roll.cos() * c);
    let a = pitch.cos() * a + pitch.sin() * c;
    let [a, b] = turned(yaw, [a, b]);
    [x + a, y + b]
}

/// What the springs' forces do along the plane is stored or lost: ∫ ΣG·v dt over a smooth motion in so many steps,
/// what is stored and lost at its end, and the largest of all.
fn work(points: &Points, pose: [f64; 6], swing: [f64; 6], steps: i32) -> [f64; 3] {
    let mut probe = Probe::new(Elements::Single(points.clone()).patch(), pose, [0.0; 6]);
    let h = 0.02 / f64::from(steps);
    let at = |step: i32| -> [f64; 6] {
        let phase = TAU * f64::from(step) / f64::from(steps);
        std::array::from_fn(|i| pose[i] + swing[i] * (phase * (1 + i % 3) as f64).sin())
    };
    let pulls = |probe: &Probe| -> Vec<[f64; 2]> {
        let pull = |i: usize| [0, 1].map(|axis| -points[i][3] * probe.value(PatchOutput::ElementTraction(i, axis)));
        (0..points.len()).map(pull).collect()
    };
    let (mut work, mut before, mut largest, mut rates) = (0.0, pulls(&probe), 0.0_f64, [0.0; 6]);
    for step in 0..steps {
        let (from, to) = (at(step), at(step + 1));
        rates = std::array::from_fn(|i| (to[i] - from[i]) / h);
        probe.advance(&Step { duration: h, rates, speed: 0.0 });
        let after = pulls(&probe);
        for (i, point) in points.iter().enumerate() {
            let (start, end) = (place(from, *point), place(to, *point));
            for axis in 0..2 {
                work += 0.5 * (before[i][axis] + after[i][axis]) * (end[axis] - start[axis]);
            }
        }
        largest = largest.max(work.abs());
        before = after;
    }
    // What the normal springs hold, at the speed of the last step, is all of a patch that begins there.
    let normal =
        Probe::new(Elements::Single(points.clone()).patch(), at(steps), rates).value(PatchOutput::ElasticEnergy);
    let kept = probe.value(PatchOutput::ElasticEnergy) - normal + probe.value(PatchOutput::Energy);
    [work, kept, largest]
}

#[test]
fn what_springs_do_is_stored_or_lost() {
    let swing = (signed(-5.0..-3.5), signed(-5.0..-3.5), -5e-6..5e-6, -1e-4..1e-4, -1e-4..1e-4, -0.02..0.02)
        .prop_map(|(x, y, z, roll, pitch, yaw)| [x, y, z, roll, pitch, yaw]);
    check("power balance", 40, (points(), pose(), swing), |(points, pose, swing)| {
        let residual = |steps: i32| {
            let [work, kept, largest] = work(&points, pose, swing, steps);
            ((work - kept).abs(), largest)
        };
        let (fine, largest) = residual(1000);
        // Of second order: the trapezium rule over steps in which elements begin to slip.
        prop_assert!(
            fine <= 1e-3 * largest,
            "{:e} of {:e}, in half as many steps {:e}",
            fine,
            largest,
            residual(500).0
        );
        Ok(())
    });
}
