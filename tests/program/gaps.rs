//! How a fluid passes the gaps of a contact, by `asperity sweep --gaps`.

use std::fs;

use crate::common::near::assert_relative;
use crate::common::{Table, asperity, root, run, scratch};

/// The cases of an independent program on the same grid: a map, solved and by the effective medium, and ridges.
#[test]
fn gaps_are_those_of_an_independent_program() {
    for (name, across) in [("steady-ridges", false), ("steady-map", true)] {
        let folder = root().join("tests/reference/film/gaps");
        let expected = Table::read(&folder.join(format!("{name}.gaps.csv")));
        let mut pressures = expected.column("pressure [Pa]");
        pressures.dedup();
        let pressures: Vec<String> = pressures.iter().map(f64::to_string).collect();
        let table = scratch(&format!("gaps-{name}")).join("table.csv");
        let mut command = asperity();
        command.arg("sweep").arg(folder.join(format!("{name}.toml"))).arg("-o").arg(&table);
        command.args(["--speeds", "0.001,0.1,10", "--gaps", "medium", "--pressures", &pressures.join(",")]);
        assert!(command.output().unwrap().status.success());
        let found = Table::read(&table);
        let mut columns = vec!["separation [m]", "leak_gap [m]", "drag_gap [m]"];
        if across {
            columns.extend(["leak_gap_across [m]", "leak_gap_medium [m]", "drag_gap_medium [m]"]);
        }
        let separations = expected.column("separation [m]");
        for column in columns {
            for (i, wanted) in expected.column(column).into_iter().enumerate() {
                let at = |name: &str, table: &Table, row: usize| table.number(row, name);
                let same = |row: &usize| {
                    ["pressure [Pa]", "speed [m/s]"].iter().all(|name| at(name, &found, *row) == at(name, &expected, i))
                };
                let row = (0..found.len()).find(same).unwrap();
                let value = found.number(row, column);
                // Where ways all but close one constriction decides; else both programs solve to their last digits.
                let allowed = if wanted > 0.01 * separations[i] { 1e-3 * wanted } else { 1e-3 * separations[i] };
                assert!((value - wanted).abs() <= allowed, "{name}, {column}, row {i}: {value} for {wanted}");
            }
        }
    }
}

/// Where a layer slides nothing is known of the gaps.
#[test]
fn gaps_of_a_sliding_layer_are_refused() {
    let scene = root().join("scenes/road/road.toml");
    let points = ["--speeds", "0.1", "--pressures", "3e5", "--method", "layer", "--gaps"];
    let table = scratch("gaps-layer").join("table.csv");
    let output = asperity().arg("sweep").arg(scene).arg("-o").arg(&table).args(points).output().unwrap();
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.code() == Some(1) && said.contains("gaps"), "{said}");
    assert!(!table.exists());
}

/// On a map the flow that is drawn and written leaks as much as the sweep's gap says; of a profile there are its gaps alone.
#[test]
fn a_contact_shows_where_it_leaks() {
    for (name, is_map) in [("steady-map", true), ("steady-ridges", false)] {
        let folder = scratch(&format!("gaps-contact-{name}"));
        let scene = root().join(format!("tests/reference/film/gaps/{name}.toml"));
        let [picture, points, table] = ["contact.svg", "contact.csv", "table.csv"].map(|file| folder.join(file));
        let state = ["--pressure", "2e5", "--speed", "0.1"];
        let mut command = asperity();
        command
            .arg("contact")
            .arg(&scene)
            .args(state)
            .arg("-o")
            .arg(&picture)
            .arg("--write")
            .arg(&points)
            .arg("--flow");
        let said = run(&mut command);
        let swept = ["--speeds", "0.1", "--pressures", "2e5", "--gaps"];
        run(asperity().arg("sweep").arg(&scene).arg("-o").arg(&table).args(swept));
        let leak_gap = Table::read(&table).number(0, "leak_gap [m]");
        assert!(leak_gap > 0.0, "{name}: nothing leaks, so nothing is tested");
        // Both are printed with four digits.
        let printed = |label: &str| {
            let value = said.split_once(label).expect(label).1.split_whitespace().next().unwrap();
            value.parse::<f64>().unwrap()
        };
        assert_relative("leak gap", printed("leak gap "), leak_gap, 1e-3);
        assert_relative("drag gap", printed("drag gap "), Table::read(&table).number(0, "drag_gap [m]"), 1e-3);
        let drawn = fs::read_to_string(&picture).unwrap();
        assert_eq!((said.contains("effective medium"), drawn.contains("leak")), (!is_map, is_map), "{said}");
        let written = Table::read(&points);
        if is_map {
            let (leak, gap) = (written.column("leak [m^3]"), written.column("gap [m]"));
            // |q| is at least its part along the sliding, whose mean is the gap's cube, and 0 where it touches.
            let mean = leak.iter().sum::<f64>() / leak.len() as f64;
            assert!((1.0..3.0).contains(&(mean / leak_gap.powi(3))), "{mean} {leak_gap}");
            assert!(leak.iter().zip(&gap).all(|(leak, gap)| *gap > 0.0 || *leak == 0.0));
        } else {
            assert!(!fs::read_to_string(&points).unwrap().contains("leak"));
        }
    }
}
