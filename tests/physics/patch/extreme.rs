//! Extreme patches on extreme motions: each follows its motion or refuses it with a reason, and what must hold holds.

use std::fs;
use std::sync::atomic::{AtomicUsize, Ordering};

use asperity::patch::{MotionError, Patch, PatchMotion, PatchOutput, PatchRun, PatchStart, Pose};

use crate::common::{root, scratch};

/// How a step may end.
#[derive(Clone, Copy, Debug, PartialEq)]
enum End {
    Done,
    TooManyParts,
    OutOfRange,
}

/// A motion: where it begins, and its steps: s, m/s and rad/s, m/s.
struct Motion {
    name: &'static str,
    pose: [f64; 6],
    steps: Vec<(f64, [f64; 6], f64)>,
    end: End,
}

const PRESSED: [f64; 6] = [0.0, 0.0, 5e-6, 0.0, 0.0, 0.0];

fn motion(name: &'static str, pose: [f64; 6], steps: &[(f64, [f64; 6], f64)], end: End) -> Motion {
    Motion { name, pose, steps: steps.to_vec(), end }
}

fn motions() -> Vec<Motion> {
    let slide = [0.02, 0.01, 0.0, 0.0, 0.0, 0.0];
    let turn = |yaw: f64| [0.0, 0.0, 0.0, 0.0, 0.0, yaw];
    let far = [1e15, -1e12, 5e-6, 0.0, 0.0, 0.0];
    let turned = [0.0, 0.0, 5e-6, 0.0, 0.0, 1e6];
    let mut motions = vec![
        motion("stands still", PRESSED, &[(1e-3, [0.0; 6], 0.0), (1e3, [0.0; 6], 0.0)], End::Done),
        motion("far away", far, &[(1e-3, [1e15, 0.0, 0.0, 0.0, 0.0, 0.0], 0.0)], End::Done),
        motion("turned a million times", turned, &[(1e-3, slide, 0.0); 3], End::Done),
        motion("a leap by a turn", PRESSED, &[(1e-3, turn(6283.185307179586), 0.0); 2], End::Done),
        motion("a turn too far", PRESSED, &[(1.0, turn(1e5), 0.0)], End::TooManyParts),
        motion("high above", [0.0, 0.0, 1e20, 0.0, 0.0, 0.0], &[(1e-3, slide, 0.0)], End::Done),
        motion("deep below", [0.0, 0.0, -1e3, 0.0, 0.0, 0.0], &[(1e-3, slide, 0.0); 3], End::Done),
        motion("upside down", [0.0, 0.0, 5e-6, 3.0, 0.0, 0.0], &[(1e-3, slide, 0.0); 3], End::Done),
        motion("beyond all speeds", PRESSED, &[(1e-3, [1e31, 0.0, 0.0, 0.0, 0.0, 0.0], 0.0)], End::OutOfRange),
        motion("no number", PRESSED, &[(1e-3, [f64::NAN, 0.0, 0.0, 0.0, 0.0, 0.0], 0.0)], End::OutOfRange),
        motion("backwards in time", PRESSED, &[(-1e-3, slide, 0.0)], End::OutOfRange),
        motion("no time", PRESSED, &[(0.0, slide, 0.0)], End::Done),
        // Down through the whole table and out again: one part, cut for itself.
        motion(
            "bounces",
            [0.0, 0.0, 1e-4, 0.0, 0.0, 0.0],
            &[
                (1e-3, [1.0, 0.0, -0.11, 0.0, 0.0, 0.0], 0.0),
                (1e-3, [1.0, 0.0, 0.11, 0.0, 0.0, 0.0], 0.0),
                (1e-9, [0.0, 0.0, -1.1e5, 0.0, 0.0, 0.0], 0.0),
                (1e-9, [0.0, 0.0, 1.1e5, 0.0, 0.0, 0.0], 0.0),
            ],
            End::Done,
        ),
        motion("a tread at a kilometre a second", PRESSED, &[(1e-6, slide, 1e3), (1e-6, slide, -1e3)], End::Done),
        motion("a tread for long", PRESSED, &[(1e3, slide, 1e3)], End::TooManyParts),
        motion("whole cells", PRESSED, &[(1e-3, slide, 0.25), (1e-3, slide, 0.25), (1e-3, slide, -0.25)], End::Done),
    ];
    for (name, duration, speed) in [
        ("a nanosecond at a kilometre a second", 1e-9, 1e3),
        ("a nanosecond at a nanometre a second", 1e-9, 1e-9),
        ("a quarter of an hour at a nanometre a second", 1e3, 1e-9),
        ("a quarter of an hour at a kilometre a second", 1e3, 1e3),
    ] {
        let rates = [speed, -0.3 * speed, 0.0, 0.0, 0.0, 0.0];
        let back = [-0.2 * speed, speed, 0.0, 0.0, 0.0, 0.0];
        motions.push(motion(
            name,
            PRESSED,
            &[(duration, rates, 0.0), (duration, back, 0.0), (duration, rates, 0.0)],
            End::Done,
        ));
    }
    motions
}

/// Tables of two pressures at one speed, without temperatures and with two.
const SMALL: [(&str, &str); 2] = [
    ("one-speed.csv", "1e-2,1e5,,steady,0.8,9e-6,2e4\n1e-2,4e5,,steady,0.7,1e-6,3e4\n"),
    (
        "two-temperatures.csv",
        "1e-2,1e5,290,steady,0.8,9e-6,2e4\n1e-2,4e5,290,steady,0.7,1e-6,3e4\n\
         1e-2,1e5,300,steady,0.6,8e-6,1e4\n1e-2,4e5,300,steady,0.5,0,2e4\n",
    ),
];

const HEAD: &str = "# asperity sweep = 1\n# scene = small\n# nominal_area = 2e-5 m2\n# rest_separation = 1e-5 m\n\
    speed [m/s],pressure [Pa],temperature [K],status,friction [1],separation [m],tangential_stiffness [N/m]\n";

/// Faces and their tables; the pose's point is on the face.
fn faces() -> Vec<(&'static str, &'static str, String)> {
    let grid = |shape: &str, length: f64, nx: usize, ny: usize, transport: bool| {
        format!("shape = {shape}\nlength = {length:e}\nwidth = 1e-2\nnx = {nx}\nny = {ny}\ntransport = {transport}")
    };
    let cylinder = |radius: f64| format!("'cylinder'\nradius = {radius:e}\noffset = [0, 0, {radius:e}]");
    let block = "block.table.csv";
    let flat = "'flat'";
    vec![
        ("one element", block, grid(flat, 1e-2, 1, 1, false)),
        ("one cell of a tread", block, grid(flat, 2.5e-4, 1, 1, true)),
        ("a small wheel", block, grid(&cylinder(1e-4), 3e-4, 8, 2, true)),
        ("a wheel as large as the earth", block, grid(&cylinder(6e6), 1e-2, 8, 2, true)),
        ("a tiny face", block, grid(flat, 1e-9, 2, 1, false)),
        ("a large face", block, grid(flat, 1e5, 2, 2, false)),
        ("one speed", "one-speed.csv", grid(flat, 1e-2, 2, 2, true)),
        ("two temperatures", "two-temperatures.csv", grid(flat, 1e-2, 2, 2, false)),
        ("areas of all sizes", block, "shape = 'points'\npath = 'points.csv'".into()),
    ]
}

fn patch(table: &str, face: &str, rest: &str) -> Patch {
    static COUNT: AtomicUsize = AtomicUsize::new(0);
    let folder = scratch(&format!("patch-extreme-{}", COUNT.fetch_add(1, Ordering::Relaxed)));
    fs::copy(root().join("tests/reference/patch/block.table.csv"), folder.join("block.table.csv")).unwrap();
    SMALL.iter().for_each(|(name, rows)| fs::write(folder.join(name), format!("{HEAD}{rows}")).unwrap());
    fs::write(folder.join("points.csv"), "x,y,z,area\n0,0,0,1e-12\n1e-3,0,1e-6,1e-6\n0,1e-3,0,1e3\n").unwrap();
    let text = format!("name = 'extreme'\ntable = {{ path = '{table}' }}\n{rest}\n[patch]\n{face}\n");
    Patch::parse(&text, &folder.join("patch.toml")).unwrap()
}

/// What a step must keep.
struct Judge {
    patch: Patch,
    run: PatchRun,
    /// Slip and release, J.
    lost: [f64; 2],
}

impl Judge {
    fn new(patch: &Patch, pose: [f64; 6]) -> Self {
        let start = PatchStart {
            pose: Pose::from_coordinates(pose),
            temperature: patch.temperature(),
            ..PatchStart::default()
        };
        let run = PatchRun::new(patch, &start).unwrap();
        Self { patch: patch.clone(), run, lost: [0.0; 2] }
    }

    fn step(&mut self, (duration, rates, speed): (f64, [f64; 6], f64)) -> (End, String) {
        let transport_speed = if self.patch.has_tread() { speed } else { 0.0 };
        let temperature = self.patch.temperature();
        let before = self.run.save();
        let result = self.run.advance(&PatchMotion { duration, rates, transport_speed, temperature });
        if result.is_err() && self.run.save() != before {
            return (End::Done, "a refused step changed the run".into());
        }
        match result {
            Ok(()) => (End::Done, self.fault()),
            Err(MotionError::TooManySubsteps { .. }) => (End::TooManyParts, String::new()),
            Err(MotionError::OutOfRange { .. }) => (End::OutOfRange, String::new()),
            Err(error) => (End::Done, error.to_string()),
        }
    }

    /// What does not hold; nothing where all does.
    fn fault(&mut self) -> String {
        let variables = self.patch.all_variables();
        let mut values = vec![f64::NAN; variables.len()];
        self.run.evaluate(&variables, &mut values);
        let mut faults = String::new();
        for (variable, value) in variables.iter().zip(&values).filter(|(_, value)| !value.is_finite()) {
            faults += &format!("{} = {value}; ", variable.name);
        }
        let of = |output| {
            variables
                .iter()
                .zip(&values)
                .find(|(variable, _)| variable.output == output)
                .map_or(0.0, |(_, value)| *value)
        };
        let lost = [PatchOutput::SlipEnergy, PatchOutput::ReleaseEnergy].map(of);
        if lost[0] < self.lost[0] || lost[1] < self.lost[1] || of(PatchOutput::ElasticEnergy) < 0.0 {
            faults += &format!("energies {lost:?} after {:?}; ", self.lost);
        }
        self.lost = lost;
        // Refused where a spring is beyond its limit.
        if let Err(error) = PatchRun::restore(&self.patch, &self.run.save()) {
            faults += &error.to_string();
        }
        faults
    }
}

#[test]
fn every_patch_follows_or_refuses_every_motion() {
    let mut findings = Vec::new();
    for (face_name, table, face) in faces() {
        let patch = patch(table, &face, "");
        for Motion { name, pose, steps, end } in motions() {
            // A tread that stands has no parts too many.
            let expected = if name == "a tread for long" && !patch.has_tread() { End::Done } else { end };
            let mut judge = Judge::new(&patch, pose);
            for (i, step) in steps.into_iter().enumerate() {
                let (found, fault) = judge.step(step);
                if !fault.is_empty() || found != expected {
                    findings.push(format!("{face_name}, {name}, step {i}: {found:?}, expected {expected:?} {fault}"));
                }
            }
        }
    }
    assert!(findings.is_empty(), "{} findings:\n{}", findings.len(), findings.join("\n"));
}

/// The finest parts change a step by what its own are of second order.
#[test]
fn the_finest_parts_are_as_the_coarsest() {
    let [coarse, fine] = [1, 1000].map(|refine| {
        let patch = patch(
            "block.table.csv",
            "shape = 'flat'\nlength = 1e-2\nwidth = 1e-2\nnx = 2\nny = 2",
            &format!("solver = {{ refine = {refine} }}"),
        );
        let mut judge = Judge::new(&patch, PRESSED);
        (0..20).for_each(|_| {
            assert_eq!(judge.step((1e-4, [0.02, 0.01, -1e-3, 0.0, 0.0, 3.0], 0.0)), (End::Done, String::new()))
        });
        let variables = patch.variables();
        let mut values = vec![f64::NAN; variables.len()];
        judge.run.evaluate(&variables, &mut values);
        values
    });
    for (coarse, fine) in coarse.iter().zip(&fine).take(3) {
        assert!((coarse - fine).abs() < 1e-3 * fine.abs(), "{coarse} {fine}");
    }
}

/// Steps over whole cells, but for rounding: those at the ends of the face are there by next to nothing, or not.
#[test]
fn a_tread_over_whole_cells_goes_on() {
    for (nx, cells) in [(1, 1.0), (3, 2.0), (7, 1.0), (7, 3.0), (24, 3.0), (24, 7.0)] {
        let face = format!("shape = 'flat'\nlength = 0.0144\nwidth = 1e-2\nnx = {nx}\nny = 1\ntransport = true");
        let (patch, speed) = (patch("block.table.csv", &face, ""), 1.7);
        let mut judge = Judge::new(&patch, PRESSED);
        let slide = [1.1 * speed, 0.1, 0.0, 0.0, 0.0, 0.0];
        let h = cells * 0.0144 / f64::from(nx) / speed;
        for step in 0..24 {
            let speed = if step < 16 { speed } else { -speed };
            assert_eq!(judge.step((h, slide, speed)), (End::Done, String::new()), "{nx} {cells} step {step}");
        }
    }
}

/// The largest patch there may be, in one step.
#[test]
fn a_million_elements_do_a_step() {
    let patch = patch("block.table.csv", "shape = 'flat'\nlength = 1.0\nwidth = 1.0\nnx = 1000\nny = 1000", "");
    let mut judge = Judge::new(&patch, PRESSED);
    assert_eq!(judge.step((1e-3, [0.02, 0.01, -1e-3, 0.0, 0.0, 0.0], 0.0)), (End::Done, String::new()));
}
