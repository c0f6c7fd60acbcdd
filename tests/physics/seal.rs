//! A lip with a film: cases that an independent program solved, closed forms, what must hold of every run.

use std::fs;

use asperity::scene::CanonicalFiles;
use asperity::seal::{Seal, SealMotion, SealRun, SealStart};

use crate::common::{Table, root, scratch};

/// A case, and what an independent program found: 128 cells or more of the width, BDF at 1e-7.
struct Case {
    seal: Seal,
    motion: Table,
    expected: Table,
}

fn case(name: &str, cells: usize) -> Case {
    let folder = root().join("tests/reference/film");
    let path = folder.join(format!("{name}.toml"));
    let text = fs::read_to_string(&path).unwrap().replace("cells = 96", &format!("cells = {cells}"));
    let table = |end: &str| Table::read(&folder.join(format!("{name}{end}.csv")));
    Case {
        seal: Seal::parse_with(&text, &path, &CanonicalFiles, &[]).unwrap(),
        motion: table(".motion"),
        expected: table(""),
    }
}

/// Follows a motion: time, u, sealed pressure; `row` sees the run at its start and after each step.
fn follow(seal: &Seal, motion: [&[f64]; 3], mut row: impl FnMut(usize, &SealRun)) -> SealRun {
    let [time, u, sealed] = motion;
    let start = SealStart { time: time[0], u: u[0], sealed_pressure: sealed[0], ..SealStart::default() };
    let mut run = SealRun::new(seal, &start).unwrap();
    row(0, &run);
    for i in 1..time.len() {
        let duration = time[i] - time[i - 1];
        let rate = |of: &[f64]| (of[i] - of[i - 1]) / duration;
        let motion = SealMotion { duration, u_rate: rate(u), pressure_rate: rate(sealed), ..SealMotion::default() };
        run.advance(&motion).unwrap();
        row(i, &run);
    }
    run
}

/// The largest difference of each column of a case, over the largest of the column.
fn differences(name: &str, cells: usize) -> Vec<(String, f64)> {
    let Case { seal, motion, expected } = case(name, cells);
    let variables = seal.all_variables();
    let known: Vec<_> = variables.iter().filter(|variable| expected.get(&variable.name).is_some()).collect();
    let columns: Vec<Vec<f64>> = known.iter().map(|variable| expected.column(&variable.name)).collect();
    let mut worst = vec![0.0_f64; known.len()];
    let [time, u, sealed] = ["time [s]", "u [m]", "sealed_pressure [Pa]"].map(|name| motion.column(name));
    follow(&seal, [&time, &u, &sealed], |i, run| {
        for (k, variable) in known.iter().enumerate() {
            let largest = columns[k].iter().map(|value| value.abs()).fold(1e-300, f64::max);
            worst[k] = worst[k].max((run.value(variable.output) - columns[k][i]).abs() / largest);
        }
    });
    known.iter().zip(worst).map(|(variable, worst)| (variable.name.clone(), worst)).collect()
}

/// Forces, loss and film on the cells of the files; on 64 cells forces and loss a little less near.
#[test]
fn cases_come_out_as_an_independent_program_has_them() {
    for name in ["film-speeds", "film-strokes", "film-rest", "film-pressure", "film-starved"] {
        for (column, found) in differences(name, 96) {
            let allowed = match (name, column.as_str()) {
                // The film that comes back: what is on the rod follows from the distance slid alone, and theirs drifts from
                // that by a tenth on the last of the way.
                ("film-strokes", "film.leak_rate") => 0.08,
                ("film-strokes", "F_x") => 6e-3,
                // The inlet where the fluid is drawn in, and the front of a dry rod, are a cell or two wide.
                ("film-strokes", "film.thickness" | "film.thickness_least") => 0.04,
                ("film-starved", "film.thickness_least" | "film.pressure_largest") => 0.06,
                // Half a cell of the inlet, all at the start.
                ("film-speeds", "E_diss") => 3.3e-3,
                // A peak within a step as the lip breaks away; steps as long as the tolerance allows.
                ("film-rest", "film.leak_rate") => 0.05,
                ("film-pressure", "film.leak_rate") => 0.02,
                (_, column) if column.starts_with("film") || column.starts_with("contact") => 1e-2,
                _ => 3e-3,
            };
            assert!(found <= allowed, "{name}: {column} differs by {found:.2e}");
        }
        for (column, found) in differences(name, 64) {
            let is_force = ["F_x", "F_z", "E_diss"].contains(&column.as_str());
            assert!(!is_force || found <= 1e-2, "{name}, 64 cells: {column} differs by {found:.2e}");
        }
    }
}

/// A lip on a surface so smooth that contacts bear next to nothing, in `folder`: x and total pressure, further keys.
fn smooth(name: &str, lip: &[[f64; 2]], keys: &str) -> Seal {
    let folder = scratch(name);
    let mut table = "# asperity sweep = 1\n# scene = smooth\n# fingerprint = 00\n# nominal_area = 1e-4 m2\n\
                     # rest_separation = 0 m\nspeed [m/s],pressure [Pa],temperature [K],status,friction [1],contact_ratio [1],\
                     separation [m],leak_gap [m],drag_gap [m],tangential_stiffness [N/m]\n"
        .to_owned();
    for i in 0..32 {
        let (pressure, gap) = (10.0 * 2.0_f64.powi(i), 1e-9 * f64::from(40 - i));
        table += &format!("1,{pressure},,steady,0.1,0,{gap},{gap},{gap},1e6\n");
    }
    fs::write(folder.join("smooth.csv"), table).unwrap();
    let rows: String = lip.iter().map(|[x, pressure]| format!("0,{x},{pressure}\n")).collect();
    fs::write(folder.join("lip.csv"), format!("sealed_pressure [Pa],x [m],pressure [Pa]\n{rows}")).unwrap();
    let text = format!(
        "name = 's'\ntable = {{ path = 'smooth.csv' }}\n\
         seal = {{ pressure = 'lip.csv', length = 0.1, rough = 'standing', cells = 64 }}\n{keys}\n"
    );
    Seal::parse_with(&text, &folder.join("s.toml"), &CanonicalFiles, &[]).unwrap()
}

/// In full film the steepest gradient w of the inlet leaves √(8ηV/9w) on the rod: inverse theory, half of which leaves.
#[test]
fn a_full_film_is_that_of_the_inverse_theory() {
    let (viscosity, speed, steepest) = (0.05, 0.1, 1.5e10);
    // The pressure rises by a smooth step of 2 MPa whose steepest gradient is w, and falls likewise.
    let (height, width) = (2e6, 4e-4);
    let half = 1.5 * height / steepest;
    let step = |t: f64| if t >= 1.0 { 1.0 } else { t * t * (3.0 - 2.0 * t) };
    let lip: Vec<[f64; 2]> = (0..=400)
        .map(|i| {
            let x = width * f64::from(i) / 400.0;
            [x, height * step(x / half).min(step((width - x) / half))]
        })
        .collect();
    let fluid = format!("fluid = {{ viscosity = {viscosity}, air = 'dry', start = 1e-6 }}");
    let seal = smooth("seal-inlet", &lip, &fluid);
    let mut run = SealRun::new(&seal, &SealStart::default()).unwrap();
    for _ in 0..100 {
        run.advance(&SealMotion { duration: 1e-3, u_rate: speed, ..SealMotion::default() }).unwrap();
    }
    // What leaves with the rod is V h/2 at the steepest place, times 2/3 of its film there.
    let thickness = (8.0 * viscosity * speed / (9.0 * steepest)).sqrt();
    let found = 2.0 * run.leak_rate() / (0.1 * speed);
    assert!((found / thickness - 1.0).abs() < 0.02, "{found} {thickness}");
}

/// Squeezed by a parabola of pressure: m⁻² grows by P t/(3 η a²), everywhere the same.
#[test]
fn a_parabola_squeezes_a_film_evenly() {
    let (viscosity, peak, half, start) = (0.05, 1e6, 2e-4, 5e-6_f64);
    let lip: Vec<[f64; 2]> = (0..=200)
        .map(|i| {
            let x = 2.0 * half * f64::from(i) / 200.0;
            [x, peak * (1.0 - ((x - half) / half).powi(2)).max(0.0)]
        })
        .collect();
    let fluid = format!("fluid = {{ viscosity = {viscosity}, air = 'dry', start = {start} }}");
    let seal = smooth("seal-squeeze", &lip, &fluid);
    let mut run = SealRun::new(&seal, &SealStart::default()).unwrap();
    let duration = 2e-3;
    run.advance(&SealMotion { duration, ..SealMotion::default() }).unwrap();
    let exact = (start.powi(-2) + peak * duration / (3.0 * viscosity * half * half)).powf(-0.5);
    for (i, content) in run.contents().iter().enumerate() {
        // Cells of a 64th, the last half cell by a straight line.
        assert!((content / exact - 1.0).abs() < 5e-3, "{i}: {content} {exact}");
    }
    assert!(exact < 0.5 * start);
}

/// What came in less what left is what is there; a state goes on bit for bit.
#[test]
fn fluid_is_kept_and_states_go_on_as_they_were() {
    let Case { seal, motion, .. } = case("film-strokes", 32);
    let [time, u, sealed] = ["time [s]", "u [m]", "sealed_pressure [Pa]"].map(|name| motion.column(name));
    let volume = |run: &SealRun| {
        let area = seal.file().length * seal.width() / seal.cells() as f64;
        area * run.contents().iter().sum::<f64>()
    };
    let (mut first, mut saved) = (0.0, None);
    let run = follow(&seal, [&time[..90], &u[..90], &sealed[..90]], |i, run| {
        if i == 0 {
            first = volume(run);
        }
        if i == 50 {
            saved = Some(run.save());
        }
    });
    let gained = volume(&run) - first;
    let flowed = run.drawn() - run.leak();
    assert!((gained - flowed).abs() <= 1e-9 * first, "{gained} {flowed}");
    let mut again = SealRun::restore(&seal, &saved.unwrap()).unwrap();
    for i in 51..90 {
        let duration = time[i] - time[i - 1];
        let u_rate = (u[i] - u[i - 1]) / duration;
        let pressure_rate = (sealed[i] - sealed[i - 1]) / duration;
        again.advance(&SealMotion { duration, u_rate, pressure_rate, ..SealMotion::default() }).unwrap();
    }
    assert_eq!(again.save(), run.save());
    assert_eq!((again.force(), again.leak_rate()), (run.force(), run.leak_rate()));
}

/// With measured friction contacts bear all, and nothing flows: ∫ μ(V, p_0) p_0 against the motion, on a rigid lip and on one
/// that has slid a long way on its spring.
#[test]
fn a_lip_of_measured_friction_is_without_a_film() {
    let folder = scratch("seal-measured");
    let table = "speed [m/s],pressure [Pa],friction [1]\n0.01,1e5,0.5\n0.01,1e6,0.3\n1,1e5,0.7\n1,1e6,0.4\n";
    fs::write(folder.join("tester.csv"), table).unwrap();
    // Half of the lip under 1e5 Pa, half under 1e6 Pa.
    let lip = "0,0,1e5\n0,1e-4,1e5\n0,1.000001e-4,1e6\n0,2e-4,1e6\n";
    fs::write(folder.join("lip.csv"), format!("sealed_pressure [Pa],x [m],pressure [Pa]\n{lip}")).unwrap();
    let (length, area) = (0.1, 1e-5);
    for (keys, ways) in [("", 1), (", stiffness = 2e5", 4)] {
        let text = format!(
            "name = 's'\ntable = {{ path = 'tester.csv' }}\n\
             seal = {{ pressure = 'lip.csv', length = {length}, rough = 'moving', cells = 64{keys} }}\n\
             fluid = {{ viscosity = 0.05, start = 1e-6, air = 'flooded' }}\n"
        );
        let seal = Seal::parse_with(&text, &folder.join("s.toml"), &CanonicalFiles, &[]).unwrap();
        assert!(seal.description().contains("without a film") && seal.description().contains("measured"));
        for (speed, [low, high]) in [(0.01, [0.5, 0.3]), (1.0, [0.7, 0.4]), (0.1, [0.6, 0.35])] {
            for direction in [1.0, -1.0] {
                let mut run = SealRun::new(&seal, &SealStart::default()).unwrap();
                let motion = SealMotion { duration: 2e-5 / speed, u_rate: direction * speed, ..SealMotion::default() };
                (0..ways).for_each(|_| run.advance(&motion).unwrap());
                let expected = -direction * area * (low * 1e5 + high * 1e6);
                // The spring is at its limit to the tolerance of a step.
                assert!((run.force() / expected - 1.0).abs() < 1e-6, "{keys} {speed}: {} {expected}", run.force());
                assert!(
                    run.leak() == 0.0 && run.drawn() == 0.0 && run.contents().iter().all(|content| *content == 0.0)
                );
                assert!((run.load() / (area * 1.1e6) - 1.0).abs() < 1e-9, "{}", run.load());
            }
        }
    }
}

/// After a long rest contacts are closed over most of the lip: it breaks away, slides, turns and breaks away again, at any
/// tolerance, with the fluid kept.
#[test]
fn a_closed_lip_breaks_away() {
    let path = root().join("scenes/rod-seal/seal.toml");
    let text = fs::read_to_string(&path).unwrap();
    let stroke = |tolerance: f64| {
        let mut seal = Seal::parse_with(&text, &path, &CanonicalFiles, &[]).unwrap();
        seal.relative_tolerance = tolerance;
        let temperature = seal.temperature();
        let start = SealStart { sealed_pressure: 5e6, temperature, ..SealStart::default() };
        let mut run = SealRun::new(&seal, &start).unwrap();
        assert!(run.contents().iter().filter(|content| **content == 0.0).count() > seal.cells() / 2);
        let cell = seal.width() / seal.cells() as f64 * seal.file().length;
        let volume = |run: &SealRun| cell * run.contents().iter().sum::<f64>();
        let (begun, mut forces) = (volume(&run), Vec::new());
        for i in 0..200 {
            let u_rate = if i < 100 { 0.01 } else { -0.01 };
            run.advance(&SealMotion { duration: 2e-3, u_rate, temperature, ..SealMotion::default() }).unwrap();
            forces.push(run.force());
        }
        let (kept, moved) = (volume(&run) - begun, run.drawn() - run.leak());
        assert!((kept - moved).abs() <= 1e-9 * (run.drawn() + volume(&run)), "{kept} {moved}");
        forces
    };
    let (coarse, fine) = (stroke(1e-3), stroke(1e-5));
    let largest = fine.iter().fold(0.0_f64, |largest, force| largest.max(force.abs()));
    let slides = fine[99].abs();
    assert!(largest > 20.0 * slides, "{largest} {slides}");
    // film.md 4 allows 3e-3 of the largest beside another program; this is its own error of time, 2.2e-3.
    coarse
        .iter()
        .zip(&fine)
        .enumerate()
        .for_each(|(i, (a, b))| assert!((a - b).abs() < 5e-3 * largest, "{i}: {a} {b}"));
}
