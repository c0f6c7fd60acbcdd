//! What is found for other programs: property files of tyres (`asperity tir`), laws of friction (`asperity slip --fit`).

use std::fs;
use std::path::Path;

use crate::common::{Table, asperity, assert_names, ended, root, run, scratch};

/// A table of slip curves over slips up to 0.3, a brush's of this friction and slope over the load.
fn write_slips(path: &Path, friction: f64, slope: f64) {
    let columns = "speed [m/s],load [N],slip,slip_angle [rad],F_x [N],F_y [N],F_z [N],M_z [N m],friction,sliding,P_diss [W],\
                   beyond,contact_length [m],temperature_largest [K],height [m],transport_speed [m/s],free_rolling,status";
    let mut text = format!("# asperity slip = 1\n# patch = tread\ntemperature [K],{columns}\n");
    for load in [3000.0, 5000.0] {
        for i in -20..=20 {
            let slip = 0.015 * f64::from(i);
            let part = (slope * slip / (3.0 * friction)).clamp(-1.0, 1.0);
            let force = 3.0 * friction * load * part * (1.0 - part.abs() + part * part / 3.0);
            text += &format!("293.15,10,{load},{slip},0,{force},0,{load},0,0,0,0,0,0.1,,0.3,10,1,steady\n");
        }
    }
    fs::write(path, text).unwrap();
}

#[test]
fn a_property_file_is_scaled() {
    let folder = scratch("tir");
    write_slips(&folder.join("dry.csv"), 1.0, 20.0);
    write_slips(&folder.join("wet.csv"), 0.7, 16.0);
    let base = root().join("scenes/slip/tread.tir");
    let mut tir = asperity();
    tir.current_dir(&folder).arg("tir").arg(&base).args(["--from", "dry.csv", "--to", "wet.csv", "-o", "wet.tir"]);
    let told = run(&mut tir);
    let line = "LMUX 1 -> 0.7: peak of F_x 4000 N -> 2800 N, times 0.7";
    assert_names(
        &told,
        &format!("from dry.csv (tread, 10 m/s, 20 °C) to wet.csv | at FNOMIN, 4000 N | {line} | LKX 1 -> 0.8"),
    );
    let [before, after] = [&base, &folder.join("wet.tir")].map(|path| fs::read_to_string(path).unwrap());
    let kept = |text: &str| -> Vec<String> {
        let others = text.lines().filter(|line| !["LMUX ", "LKX ", "$ "].iter().any(|start| line.starts_with(start)));
        others.map(str::to_owned).collect()
    };
    assert_eq!(kept(&before), kept(&after));
    assert_names(&after, &format!("\n$ {line}\n | \nLMUX                     = 0.7                $Peak"));
    // LMUY and LKY stay, which is said; a file is not written over.
    let (status, _, told) = ended(&mut tir);
    assert_eq!(status, 0);
    assert_names(&told, "LMUY and LKY stay: dry.csv has no F_y from zero slip angle on");
    let over = ["--from", "dry.csv", "--to", "wet.csv", "-o", "wet.csv"];
    let (status, _, told) = ended(asperity().current_dir(&folder).arg("tir").arg(&base).args(over));
    assert_eq!(status, 1);
    assert_names(&told, "will not write wet.csv");
}

/// The lip of scenes/rod-seal without its bottom: K 1.5, 1/v_s 20 s/m, f 40 N s/m, preload 10 N, 4e-6 N/Pa.
#[test]
fn a_lip_has_the_numbers_of_a_cylinder() {
    let folder = scratch("friction-law");
    let mut text =
        String::from("# asperity stribeck = 1\n# seal = rod\nsealed_pressure [Pa],speed [m/s],F_x [N],stroke,status\n");
    for pressure in [0.0, 5e6] {
        for speed in [1e-4, 1e-3, 1e-2, 3e-2, 0.1, 0.3, 1.0] {
            let force = (10.0 + 4e-6 * pressure) * (1.0 + 0.5 * f64::exp(-20.0 * speed)) + 40.0 * speed;
            text += &format!("{pressure},{speed},{},out,steady\n{pressure},{speed},{force},in,steady\n", -force);
        }
    }
    text += "0,2,1,out,not steady\n";
    fs::write(folder.join("lip.csv"), text).unwrap();
    let fit = |law: &str| ended(asperity().current_dir(&folder).args(["slip", "--fit", law, "lip.csv"]));
    let (status, told, notes) = fit("stribeck");
    assert_eq!(status, 0, "{notes}");
    assert_names(&notes, "1 rows without steady friction");
    assert_names(&told, "lip.csv, 28 rows | preload                 10 ± | breakaway_increase      1.5 ±");
    let numbers = Table::read(&folder.join("lip.stribeck.csv"));
    for (found, expected) in numbers.column("value").into_iter().zip([10.0, 4e-6, 1.5, 20.0, 40.0]) {
        // Data of the formula itself.
        assert!((found / expected - 1.0).abs() < 1e-6, "{found}, expected {expected}");
    }
    let (_, told, notes) = fit("lugre");
    assert_names(&told, "sigma_0                 not determined | stribeck_speed");
    assert_names(&notes, "sigma_0 and sigma_1 show in no steady motion");
    let (status, _, told) = ended(asperity().current_dir(&folder).args(["slip", "--fit", "mf", "lip.csv"]));
    assert_eq!(status, 2);
    assert_names(&told, "--loads");
}
