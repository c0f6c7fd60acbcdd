//! Tables of contacts that do not give way, in full contact or because friction alone was measured, behind a backing.

use std::fmt::Write as _;
use std::fs;

use super::exact::{folder, go, run_at, value, wrench};
use asperity::patch::{Patch, PatchError, PatchOutput};

const FLAT: &str = "shape = \"flat\"\nlength = 0.02\nwidth = 0.01\nnx = 5\nny = 3";
/// The area of that face, m².
const AREA: f64 = 2e-4;
/// Stiffnesses of the backing per area, Pa/m.
const NORMAL: f64 = 7.5e8;
const SHEAR: f64 = 2.5e8;

/// A patch on the table of this text, with a backing or none.
fn parse(name: &str, table: &str, face: &str, backing: bool) -> Result<Patch, PatchError> {
    let folder = folder(&format!("full-contact-{name}"));
    fs::write(folder.join("table.csv"), table).unwrap();
    let backing =
        if backing { format!("backing = {{ normal = {NORMAL:e}, shear = {SHEAR:e} }}") } else { String::new() };
    let text = format!(
        "name = \"{name}\"\n[table]\npath = \"table.csv\"\n[patch]\n{face}\n{backing}\n[fmu]\n\
         outputs = [\"forces\", \"contact\", \"friction\", \"energy\", \"elements\"]\n"
    );
    Patch::parse(&text, &folder.join("patch.toml"))
}

const SPEEDS: [f64; 3] = [1e-3, 0.1, 2.0];
const PRESSURES: [f64; 3] = [5e4, 2e5, 6e5];

/// A measured friction coefficient at the points of the table.
fn friction(speed: f64, pressure: f64) -> f64 {
    0.8 + 0.05 * speed.ln() / 3.0 - 1e-7 * pressure
}

fn measured() -> String {
    let mut text = "pressure [Pa],speed [m/s],friction [1]\n".to_owned();
    for speed in SPEEDS {
        for pressure in PRESSURES {
            writeln!(text, "{pressure:?},{speed:?},{:?}", friction(speed, pressure)).unwrap();
        }
    }
    text
}

/// Pressed by Δ a face of measured friction bears k_n Δ: below, between and beyond the pressures measured; what it stores is
/// the work of that.
#[test]
fn measured_friction_is_pressed_as_its_backing() {
    let patch = parse("normal", &measured(), FLAT, true).unwrap();
    for depth in [1e-9, 1e-6, 4e-5, 2e-4, 5e-4, 2e-3] {
        let mut run = run_at(&patch, [0.0, 0.0, -depth, 0.0, 0.0, 0.0], [0.0; 6], 0.0);
        let normal = wrench(&mut run, &patch)[2];
        // The contact gives way by 1e-15 m from row to row, 1e-11 of the least of its pressures over k_n; the start of the
        // parabola below that, 1e-15 m wide, is 1e-6 of the least depth.
        let allowed = 1e-10 + 3e-15 / depth;
        assert!((normal / (AREA * NORMAL * depth) - 1.0).abs() < allowed, "{depth}: {normal}");
        let energy = value(&mut run, &patch, PatchOutput::ElasticEnergy);
        // Over pieces of one law each Gauss's rule is exact for a straight pressure.
        let expected = 0.5 * AREA * NORMAL * depth * depth;
        assert!((energy / expected - 1.0).abs() < 1e-9 + 1e-14 / depth, "{depth}: {energy} {expected}");
    }
}

/// In full slip the friction is that of the table at its points, and that of the least pressure below; at the start of motion
/// a face is as stiff as its backing.
#[test]
fn measured_friction_is_that_of_its_rows() {
    let patch = parse("friction", &measured(), FLAT, true).unwrap();
    for speed in SPEEDS {
        for (pressure, of) in PRESSURES.map(|pressure| (pressure, pressure)).into_iter().chain([(1e3, PRESSURES[0])]) {
            let rates = [speed, 0.0, 0.0, 0.0, 0.0, 0.0];
            let mut run = run_at(&patch, [0.0, 0.0, -pressure / NORMAL, 0.0, 0.0, 0.0], rates, 0.0);
            let way = 1e-3 * pressure / SHEAR;
            go(&mut run, &patch, way / speed, rates, 0.0);
            let stuck = -wrench(&mut run, &patch)[0] / way;
            // A contact of 1e20 Pa/m is in series, and what the start of motion rounds off.
            assert!((stuck / (AREA * SHEAR) - 1.0).abs() < 1e-9, "{speed} {pressure}: {stuck}");
            go(&mut run, &patch, 5.0 * pressure / SHEAR / speed, rates, 0.0);
            let found = value(&mut run, &patch, PatchOutput::Friction);
            // The law is interpolated through the rows; rounding of the depth is left.
            assert!((found / friction(speed, of) - 1.0).abs() < 1e-9, "{speed} {pressure}: {found}");
        }
    }
}

/// A tread that runs through without slip is sheared by the creep σ: k_t σ a²/2 per width.
#[test]
fn the_creep_stiffness_of_measured_friction_is_that_of_its_backing() {
    let (length, width, creep, speed) = (0.1, 0.2, 1e-4, 10.0);
    let face = format!("shape = \"flat\"\nlength = {length}\nwidth = {width}\nnx = 200\nny = 1\ntransport = true");
    let patch = parse("creep", &measured(), &face, true).unwrap();
    let rates = [speed * (1.0 + creep), 0.0, 0.0, 0.0, 0.0, 0.0];
    let mut run = run_at(&patch, [0.0, 0.0, -4e-4, 0.0, 0.0, 0.0], rates, speed);
    (0..60).for_each(|_| go(&mut run, &patch, 2e-4, rates, speed));
    let (force, expected) = (-wrench(&mut run, &patch)[0], SHEAR * creep * length * length / 2.0 * width);
    // Two hundred cells along the contact.
    assert!((force / expected - 1.0).abs() < 1e-3, "{force} {expected}");
}

/// The pressure from which a sweep is in full contact at a speed, Pa.
fn full_from(speed: f64) -> f64 {
    1e6 * (speed / 1e-2).sqrt()
}

/// A contact's separation is this times ln(p_f/p), m.
const DEPTH: f64 = 1e-7;

/// A sweep that is in full contact at low speeds: ln p straight over the separation up to it.
fn swept() -> String {
    let mut text =
        "# asperity sweep = 1\n# nominal_area = 1e-4 m2\n# rest_separation = 0 m\nspeed [m/s],pressure [Pa],\
                    temperature [K],status,friction [1],contact_ratio [1],separation [m],tangential_stiffness [N/m]\n"
            .to_owned();
    for speed in [1e-4, 1e-3, 1e-2, 0.1, 1.0] {
        for pressure in [5e4, 2e5, 6e5, 1.5e6, 4e6] {
            let share = pressure / full_from(speed);
            if share >= 1.0 {
                writeln!(text, "{speed:?},{pressure:?},,full contact,0.5,1,0,").unwrap();
            } else {
                let (separation, stiffness) = (DEPTH * (1.0 / share).ln(), 1e-4 * pressure / DEPTH);
                writeln!(text, "{speed:?},{pressure:?},,steady,0.7,{share},{separation:?},{stiffness:?}").unwrap();
            }
        }
    }
    text
}

/// At the speeds in full contact a face is pressed as its backing; between those and others a face is never farther from its
/// backing alone than a contact's whole separation.
#[test]
fn in_full_contact_the_backing_alone_gives_way() {
    let patch = parse("swept", &swept(), FLAT, true).unwrap();
    let pressure = |depth: f64, speed: f64| {
        let mut run = run_at(&patch, [0.0, 0.0, -depth, 0.0, 0.0, 0.0], [speed, 0.0, 0.0, 0.0, 0.0, 0.0], 0.0);
        value(&mut run, &patch, PatchOutput::ElementPressure(0))
    };
    for speed in [1e-4, 3e-5] {
        // From 2 bar on.
        for depth in [3e-4, 1e-3, 3e-3, 8e-3] {
            let slope = (pressure(depth + 1e-6, speed) - pressure(depth - 1e-6, speed)) / 2e-6;
            // A contact gives way by a thousandth of 1.4e-7 m from row to row, where the backing does by 2e-4 m and more.
            assert!((slope / NORMAL - 1.0).abs() < 2e-6, "{speed} {depth}: {slope}");
        }
    }
    // From the least separation to that at 1e-4 of the least pressure, at the largest speed.
    let (farthest, closest) = (DEPTH * (full_from(1.0) / 5.0).ln(), 6.0 * 1e-3 * DEPTH * 4.0);
    for i in 0..=800 {
        let speed = 10.0_f64.powf(-4.5 + 5.0 * f64::from(i) / 800.0);
        let mut before = 0.0;
        // Up to the table's largest pressure, 4 MPa: beyond it contacts come closer along their tangent.
        for j in 1..=53 {
            let depth = 1e-4 * f64::from(j);
            let found = pressure(depth, speed);
            let range = (depth - closest) * NORMAL..(depth + farthest) * NORMAL;
            assert!(range.contains(&found) && found > before, "{speed} {depth}: {found} {range:?}");
            before = found;
        }
    }
}

/// Without a backing it is refused with that word; separations that are equal elsewhere are refused, and a point that is less
/// than in full contact where a lower pressure is.
#[test]
fn full_contact_takes_a_backing() {
    let refused = |name: &str, table: &str, backing: bool| parse(name, table, FLAT, backing).unwrap_err().to_string();
    let alone = refused("alone", &swept(), false);
    assert!(
        alone.contains("full contact")
            && alone.contains("at 0.0001 m/s, 200000 Pa")
            && alone.contains("[patch] backing"),
        "{alone}"
    );
    let alone = refused("alone-measured", &measured(), false);
    assert!(
        alone.contains("full contact") && alone.contains("measured") && alone.contains("[patch] backing"),
        "{alone}"
    );
    let rows = |statuses: [&str; 2], separations: [f64; 2]| {
        let head = swept().lines().take(4).collect::<Vec<_>>().join("\n");
        let row = |i: usize| format!("1,{}e5,,{},0.5,1,{:e},1e6", 1 + i, statuses[i], separations[i]);
        format!("{head}\n{}\n{}\n", row(0), row(1))
    };
    assert!(parse("both", &rows(["full contact"; 2], [0.0; 2]), FLAT, true).is_ok());
    for (i, (statuses, separations)) in [
        (["steady"; 2], [1e-7; 2]),
        (["steady", "full contact"], [0.0; 2]),
        (["full contact", "steady"], [0.0, -1e-7]),
        (["full contact"; 2], [0.0, 1e-9]),
    ]
    .into_iter()
    .enumerate()
    {
        let crossing = refused(&format!("crossing-{i}"), &rows(statuses, separations), true);
        assert!(crossing.contains("expected a smaller one"), "{i}: {crossing}");
    }
}

/// What is not speed, pressure, friction and temperature is refused, as are points that are missing, with where and what.
#[test]
fn a_table_of_measured_friction_has_nothing_else() {
    let refused = |name: &str, table: &str| parse(name, table, FLAT, true).unwrap_err().to_string();
    let more = measured().replacen("friction [1]\n", "friction [1],separation [m]\n", 1);
    assert!(refused("more", &more).contains("asperity sweep = 1"), "{}", refused("more", &more));
    let lines: Vec<String> = measured().lines().map(str::to_owned).collect();
    let missing = refused("missing", &format!("{}\n", lines[..9].join("\n")));
    assert!(missing.contains("no row of 2 m/s, 600000 Pa"), "{missing}");
    let twice = refused("twice", &format!("{}{}\n", measured(), lines[9]));
    assert!(twice.contains(":11: a second row of 2 m/s, 600000 Pa"), "{twice}");
}
