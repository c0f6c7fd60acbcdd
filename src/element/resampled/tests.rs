#![allow(clippy::unwrap_used)]

use std::path::Path;

use super::*;

fn table(name: &str) -> FrictionTable {
    FrictionTable::load(&Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/reference/patch").join(name)).unwrap()
}

/// Where more of its speeds lie together than there are bins for.
#[test]
fn close_speeds_of_a_table_are_told_apart() {
    let mut text = "# asperity sweep = 1\n# scene = close\n# nominal_area = 1 m2\n# rest_separation = 0 m\n\
                    speed [m/s],pressure [Pa],temperature [K],status,friction [1],separation [m],\
                    tangential_stiffness [N/m]\n"
        .to_owned();
    let speeds = [1e-3, 1.000_001e-3, 1.000_002e-3, 10.0];
    for (j, speed) in speeds.iter().enumerate() {
        for (pressure, separation) in [(1e5, 2e-5), (2e5, 1e-5)] {
            let friction = 0.5 + 0.1 * j as f64;
            text += &format!("{speed},{pressure},,steady,{friction},{separation},1e9\n");
        }
    }
    let path = std::env::temp_dir().join(format!("asperity-close-{}.csv", std::process::id()));
    std::fs::write(&path, text).unwrap();
    let table = FrictionTable::load(&path).unwrap();
    std::fs::remove_file(&path).unwrap();
    let mut law = ResampledLaw::new(&table, 1.0, 0.0, None);
    for (j, speed) in speeds.iter().enumerate() {
        let place = law.place(law.range().logarithm(*speed), 0.0);
        let friction = law.at_place(&place, -1.5e-5).friction;
        assert!((friction - 0.5 - 0.1 * j as f64).abs() < 1e-6, "{speed}: {friction}");
    }
}

/// p and μp of elements of any temperature, within 1e-3 of those of the table at that temperature.
#[test]
fn between_planes_it_is_the_law_of_the_table() {
    let table = table("block.table.csv");
    let area = table.load.area();
    let mut found = ResampledLaw::of_warm_elements(&table, area, 284.0, None);
    for rise in [-5.0, 0.0, 3.7, 9.9, 14.2, 30.0] {
        let law = Law::new(&table, (284.0_f64 + rise).clamp(283.15, 303.15));
        for step in 0..150 {
            let speed = (1e-4_f64.ln() + 0.1 * f64::from(step)).exp();
            let curve = LawAtSpeed::new(&law, speed);
            let place = found.place(found.range().logarithm(speed), rise);
            for i in 1..40 {
                let approach = curve.touch + (curve.closest() - curve.touch) * f64::from(i) / 36.0;
                let exact = curve.at(approach);
                let point = found.at_place(&place, approach);
                let (normal, limit) = (point.pressure * area, point.pressure * point.friction * area);
                // Below the least pressure in shares of that.
                let scale = |value: f64| 1e-3 * value.max(table.load.force(table.grid.loads[0]));
                assert!((normal - exact.normal.value).abs() < scale(exact.normal.value), "{rise} {speed} {i}");
                assert!((limit - exact.limit.value).abs() < scale(exact.limit.value), "{rise} {speed} {i}");
            }
        }
    }
}

/// p, μ and κ at speeds and approaches all over the table and beyond, at temperatures between its own.
#[test]
fn it_is_the_law_of_the_table() {
    for (name, temperatures) in [("block.table.csv", [285.0, 299.0]), ("winkler.table.csv", [0.0, 0.0])] {
        let table = table(name);
        let area = table.load.area();
        let mut found = ResampledLaw::new(&table, area, temperatures[0], None);
        for temperature in temperatures {
            found.set_temperature(temperature);
            let law = Law::new(&table, temperature);
            for step in 0..1500 {
                let speed = (1e-5_f64.ln() + 0.0137 * f64::from(step)).exp();
                let curve = LawAtSpeed::new(&law, speed);
                let (from, to) = (curve.touch, curve.closest());
                let end = curve.at(to);
                for i in -2..40 {
                    let approach = from + (to - from) * f64::from(i) / 36.0;
                    let exact = curve.at(approach);
                    let place = found.place(found.range().logarithm(speed), 0.0);
                    let point = found.at_place(&place, approach);
                    // As shares of the largest values of the table.
                    let largest = found.largest_pressure() * area;
                    let close = |value: f64, expected: f64, scale: f64| {
                        assert!((value - expected).abs() <= 1e-6 * scale, "{value} {expected}");
                    };
                    close(point.pressure * area, exact.normal.value, largest);
                    close(point.pressure * point.friction * area, exact.limit.value, largest);
                    close(point.stiffness * area, exact.stiffness.value, end.stiffness.value);
                }
            }
        }
    }
}
