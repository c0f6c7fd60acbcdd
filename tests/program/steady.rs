//! `asperity sweep --method steady` and `asperity contact`: tables, what they say, and what is refused.

use std::fs;
use std::io::Read as _;
use std::path::{Path, PathBuf};
use std::process::Output;

use crate::common::{Table, asperity, assert_names, ended, root, run, scratch};

fn reference(name: &str) -> PathBuf {
    root().join("tests/reference").join(name)
}

fn sweep(scene: &Path, table: &Path, options: &[&str]) -> String {
    run(asperity().arg("sweep").arg(scene).arg("-o").arg(table).args(options));
    fs::read_to_string(table).unwrap()
}

/// What a command that fails says.
fn refused(arguments: &[&str]) -> String {
    let (status, _, message) = ended(asperity().args(arguments));
    assert_ne!(status, 0, "{arguments:?} should fail");
    message
}

const POINTS: [&str; 4] = ["--speeds", "1e-3,0.1,10", "--pressures", "5e4,3e5,1e6"];

/// A profile of even points that are enough is solved for on them, without being asked: the table is the reference's, and its
/// columns go together.
#[test]
fn a_table_is_that_of_an_independent_program() {
    let folder = scratch("steady-table");
    let table = folder.join("table.csv");
    let text = sweep(&reference("steady/steady-ridges.toml"), &table, &POINTS);
    assert_names(text, "# method = steady, on 2048 points | the profile's own");
    let (found, expected) = (Table::read(&table), Table::read(&reference("steady/steady-ridges.csv")));
    assert_eq!(found.len(), expected.len());
    let area = 2048.0 * 3.90625e-6 * 1e-2;
    for row in 0..found.len() {
        let value = |name: &str| found.number(row, name);
        let at = (value("pressure"), value("speed"));
        let same = |i: &usize| (expected.number(*i, "pressure [Pa]"), expected.number(*i, "speed [m/s]")) == at;
        let other = (0..expected.len()).find(same).unwrap();
        assert_eq!(found.text(row, "status"), "steady");
        let friction = expected.number(other, "friction [1]");
        assert!((value("friction") / friction - 1.0).abs() < 1e-3, "{at:?}");
        assert_eq!((value("mean_pressure"), value("friction_standard_error")), (at.0, 0.0));
        // All that is lost is the rubber's: no friction in the contacts, no viscosity.
        let power = value("friction") * at.0 * at.1 * area;
        assert!((value("P_maxwell") / power - 1.0).abs() < 1e-12);
        assert!(value("tangential_stiffness") > 0.0 && value("separation") > 0.0);
        let empty = ["P_damper", "P_friction", "P_impact", "w", "runs", "time", "area_real", "flash_mean"];
        assert!(empty.iter().all(|name| found.text(row, name).is_empty()));
    }
}

/// A profile with too few points for its waves is refined, and the table says to how many; full contact has no stiffness.
#[test]
fn a_coarse_profile_is_refined_and_full_contact_is_said() {
    let folder = scratch("steady-refined");
    let sine = |points: u32| {
        format!(
            "surface={{ kind = 'sinusoid', amplitude = 5e-6, wavelength = 1e-3, points_per_wavelength = {points} }}"
        )
    };
    let scene = reference("half-plane/sine.toml");
    let scene = scene.to_str().unwrap();
    let table = folder.join("table.csv");
    let loads = ["sweep", scene, "--speeds", "1", "--pressures", "2e4,2.8e5", "--set", &sine(6)];
    // Full contact is a result, but no law that an element could use.
    let (status, printed, warning) = ended(asperity().args(loads).arg("-o").arg(&table));
    assert_eq!(status, 0);
    assert_names(&printed, "full contact | no stiffness");
    assert_names(&warning, "20 points");
    let text = fs::read_to_string(&table).unwrap();
    assert_names(text, "# method = steady, on 16 points | the profile has 6");
    let rows = Table::read(&table);
    assert_eq!(rows.text(1, "status"), "full contact");
    assert!(rows.text(1, "tangential_stiffness").is_empty() && rows.number(1, "separation") == 0.0);
}

/// The layer is taken where there is nothing to solve for, and the table says why; what does not go with a method is refused.
#[test]
fn each_method_says_what_it_is_for() {
    let folder = scratch("steady-refused");
    let file = |name: &str| folder.join(name).to_str().unwrap().to_owned();
    let (scene, table) = (reference("half-plane/sine.toml"), file("table.csv"));
    let scene = scene.to_str().unwrap();
    let sweep = |options: &[&str]| {
        let point = ["sweep", scene, "--speeds", "1", "--pressures", "2e4", "-o", &table];
        refused(&[&point[..], options].concat())
    };
    for (options, named) in [
        (&["--method", "layer", "--points", "64"][..], "--points: expected none | --method layer"),
        (&["--friction-error", "0.01"], "--friction-error: expected none | --method steady"),
        (&["--distance", "1"], "--distance: expected none | --method steady"),
        (&["--points", "4"], "--points: | 16 | found 4"),
        (&["--set", "carrier.z={ mass = 1.0 }"], "[carrier.z]"),
        (&["--method", "steady", "--set", "surface={ kind = 'flat' }"], "surface is flat"),
    ] {
        assert_names(sweep(options), named);
    }
    let flat = ["sweep", scene, "--speeds", "1", "--pressures", "2e4", "--set", "surface={ kind = 'flat' }"];
    run(asperity().args(flat).args(["--set", "friction={ coulomb = 0.3 }", "-o", &table]));
    let text = fs::read_to_string(&table).unwrap();
    assert!(text.contains("# method = layer: the surface is flat"), "{text}");
}

fn converge(scene: &Path, table: &Path, options: &[&str]) -> Output {
    asperity().arg("converge").arg(scene).arg("-o").arg(table).args(["--speed", "0.1"]).args(options).output().unwrap()
}

/// The grid is halved until area and friction stay, along both directions of a map; a file that is one period is not doubled, a
/// self-affine map is along the sliding, and has other seeds. A second call has nothing left to do.
#[test]
fn the_grid_is_refined_until_nothing_changes() {
    let folder = scratch("steady-converge");
    let table = folder.join("study.csv");
    let options = ["--pressure", "3e5", "--error", "0.03"];
    let output = converge(&reference("steady/steady-map.toml"), &table, &options);
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.status.success(), "{output:?}");
    assert!(said.starts_with("points  spacing, m") && !said.contains("std. error"), "{said}");
    assert!(!said.contains("twice the length") && !said.contains("seeds"), "{said}");
    let text = fs::read_to_string(&table).unwrap();
    assert!(text.contains("\n# method = steady, on the map's own 128 x 128 points\n"), "{text}");
    let rows = Table::read(&table);
    assert_eq!(rows.texts("points")[..2], ["128", "256"]);
    assert!(rows.texts("fit_rms").iter().all(|fit| fit.is_empty()));
    // The first is the point of the reference's grid.
    let expected = Table::read(&reference("steady/steady-map.csv"));
    let at = |row: usize| (expected.number(row, "pressure [Pa]"), expected.number(row, "speed [m/s]"));
    let row = (0..expected.len()).find(|&row| at(row) == (3e5, 0.1)).unwrap();
    assert!((rows.number(0, "friction") / expected.number(row, "friction [1]") - 1.0).abs() < 1e-3);
    assert_eq!(converge(&reference("steady/steady-map.toml"), &table, &options).stdout, output.stdout);
    assert_eq!(fs::read_to_string(&table).unwrap(), text);

    let isotropic = "surface={ kind = 'self_affine', isotropic = true, length = 2e-3, size_y = 1e-3, points = 64, hurst = 0.8, \
                     rms = 5e-6, roll_off_wavelength = 1e-3, cut_off_wavelength = 2e-4, seed = 5 }";
    let options = ["--pressure", "2e5", "--error", "0.5", "--seeds", "3", "--force", "--set", isotropic];
    let output = converge(&reference("half-plane/sine.toml"), &table, &options);
    assert!(output.status.success(), "{output:?}");
    let rows = Table::read(&table);
    assert_eq!(rows.texts("points"), ["64", "128", "256", "128", "128"]);
    assert_eq!(rows.column("length"), [2e-3, 2e-3, 4e-3, 2e-3, 2e-3]);
    assert_eq!(rows.texts("seed"), ["5", "5", "5", "6", "7"]);
    let refused = |options: &[&str], expected: &str| {
        let output = converge(&reference("half-plane/sine.toml"), &table, &[&["--pressure", "2e5"], options].concat());
        assert_names(String::from_utf8_lossy(&output.stderr), expected);
        assert!(!output.status.success(), "{options:?}");
    };
    refused(&["--distance", "1"], "--distance: expected none | --method steady");
    refused(&["--seeds", "3"], "nothing depends on a seed");
    refused(&["--points", "64", "--most-points", "100"], "--most-points: | 128");
}

/// Heat has no steady state in a layer: its sweep and its study name the method that has one, which is theirs by default.
#[test]
fn a_layer_that_heats_is_never_steady() {
    let folder = scratch("steady-heat");
    let scene = reference("steady/steady-road.toml");
    let table = folder.join("table.csv");
    let point = [scene.to_str().unwrap(), "-o", table.to_str().unwrap(), "--method", "layer"];
    let sweep = refused(&[&["sweep", "--speeds", "0.1", "--pressures", "3e5"], &point[..]].concat());
    let study = refused(&[&["converge", "--speed", "0.1", "--pressure", "3e5"], &point[..]].concat());
    for message in [sweep, study] {
        assert_names(message, "material.heat: expected none | --method steady");
    }
}

/// A map at other points is the same map by its waves.
#[test]
fn a_map_is_solved_on_as_many_points_as_are_asked_for() {
    let folder = scratch("steady-map-points");
    let point = ["--speeds", "0.1", "--pressures", "2e5", "--points"];
    let scene = reference("steady/steady-map.toml");
    let row = |points: &str| {
        let table = folder.join(format!("{points}.csv"));
        let text = sweep(&scene, &table, &[&point[..], &[points]].concat());
        let rows = Table::read(&table);
        (text, rows.number(0, "friction"), rows.number(0, "contact_ratio"))
    };
    let (own, fine, coarse) = (row("128"), row("256"), row("100"));
    assert_names(&own.0, "# method = steady, on the map's own 128 x 128 points");
    assert_names(&fine.0, "# method = steady, on 256 x 256 points | 128 x 128");
    // What half the spacing changes, and what is left out at fewer points.
    for (other, allowed) in [(fine, 0.02), (coarse, 0.05)] {
        assert!((other.1 / own.1 - 1.0).abs() < allowed && (other.2 / own.2 - 1.0).abs() < 2.5 * allowed);
    }
    let few =
        ["sweep", scene.to_str().unwrap(), "-o", "none.csv", "--speeds", "1", "--pressures", "2e5", "--points", "8"];
    let few = refused(&few);
    assert_names(&few, "16 points | [8, 8]");
}

/// The maps of a contact are drawn, of a long one below each other; numpy's arrays are the table's columns.
#[test]
fn a_contact_of_a_map_is_drawn_as_maps() {
    let folder = scratch("steady-contact-map");
    let scene = reference("steady/steady-map.toml");
    let file = |name: &str| folder.join(name);
    let contact = |options: &[&str], picture: &str, data: &str| {
        let mut command = asperity();
        command.arg("contact").arg(&scene).args(["--pressure", "3e5", "--speed", "0.1"]).args(options);
        run(command.arg("-o").arg(file(picture)).arg("--write").arg(file(data)))
    };
    let _ = contact(&[], "contact.svg", "contact.csv");
    let _ = contact(&[], "contact.png", "contact.npz");
    let svg = fs::read_to_string(file("contact.svg")).unwrap();
    assert_eq!(svg.matches("<image ").count(), 3);
    for text in
        ["pressure in MPa", "gap in µm", "height in µm", "contact, 14.9 % of the area", "x in mm", "the rubber slides"]
    {
        assert!(svg.contains(text), "{text}");
    }
    assert!(fs::read(file("contact.png")).unwrap().starts_with(b"\x89PNG"));
    let rows = Table::read(&file("contact.csv"));
    let mut archive = zip::ZipArchive::new(fs::File::open(file("contact.npz")).unwrap()).unwrap();
    for (name, column, shape) in [
        ("height", "height [m]", "(128,128,)"),
        ("pressure", "pressure [Pa]", "(128,128,)"),
        ("gap", "gap [m]", "(128,128,)"),
    ] {
        let mut bytes = Vec::new();
        archive.by_name(&format!("{name}.npy")).unwrap().read_to_end(&mut bytes).unwrap();
        assert!(bytes.starts_with(b"\x93NUMPY\x01\x00"), "{name}");
        let start = 10 + usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
        assert_eq!(start % 64, 0);
        let header = String::from_utf8_lossy(&bytes[10..start]).into_owned();
        assert!(header.contains(&format!("'shape': {shape}")) && header.ends_with('\n'), "{header}");
        let values = bytes[start..].chunks_exact(8).map(|bytes| f64::from_le_bytes(bytes.try_into().unwrap()));
        assert_eq!(values.collect::<Vec<_>>(), rows.column(column), "{name}");
    }
    let long = "surface={ kind = 'self_affine', isotropic = true, length = 4e-3, size_y = 1e-3, points = 128, hurst = 0.8, \
                rms = 5e-6, roll_off_wavelength = 1e-3, cut_off_wavelength = 2.5e-4, seed = 5 }";
    let _ = contact(&["--set", long], "long.svg", "long.csv");
    let svg = fs::read_to_string(file("long.svg")).unwrap();
    let edge = |name: &str| -> Vec<u32> {
        let images = svg.split("<image ").skip(1);
        images
            .map(|image| {
                image.split(&format!(" {name}=\"")).nth(1).unwrap().split('"').next().unwrap().parse().unwrap()
            })
            .collect()
    };
    let (height, top) = (edge("height"), edge("y"));
    assert_eq!(edge("width")[0], 4 * height[0]);
    assert!(top[1] > top[0] + height[0] && top[2] > top[1] + height[1]);
}

/// Pressures of the data have the mean that was asked for and stand where the gap is 0.
#[test]
fn a_contact_is_drawn_and_written() {
    let folder = scratch("steady-contact");
    let (picture, data) = (folder.join("contact.png"), folder.join("contact.csv"));
    let said = run(asperity()
        .arg("contact")
        .arg(reference("steady/steady-ridges.toml"))
        .args(["--pressure", "3e5", "--speed", "0.1", "-o"])
        .arg(&picture)
        .arg("--write")
        .arg(&data));
    assert!(said.contains("Contact     0.1636 of the area"), "{said}");
    assert!(fs::read(&picture).unwrap().starts_with(b"\x89PNG"));
    let rows = Table::read(&data);
    let [pressures, gaps] = ["pressure [Pa]", "gap [m]"].map(|name| rows.column(name));
    assert_eq!(pressures.len(), 2048);
    // The sum of 2048 roundings.
    assert!((pressures.iter().sum::<f64>() / 2048.0 / 3e5 - 1.0).abs() < 1e-12);
    assert!(pressures.iter().zip(&gaps).all(|(p, gap)| (*p > 0.0) == (*gap == 0.0)));
}

/// A table that was solved for is checked with solutions between its points, and to and fro with a layer that bears the same
/// load, which is another model; a patch with solutions at its separations.
#[test]
fn an_element_of_solutions_is_checked_with_solutions() {
    let folder = scratch("steady-check");
    let (scene, table) = (reference("half-plane/sine.toml"), folder.join("table.csv"));
    let options = ["--speeds", "0.1..1/4", "--pressures", "5e3..4e4/4", "--points", "512"];
    let _ = sweep(&scene, &table, &options);
    // A library that nothing loads.
    let library = root().join("Cargo.toml");
    let pack = |options: &[&str], name: &str| {
        let mut command = asperity();
        command.arg("pack").args(options).arg("-o").arg(folder.join(name)).arg("--library").arg(&library);
        run(command.arg("--check").arg(&scene).args(["--check-points", "4"]))
    };
    let said = pack(&["--table", table.to_str().unwrap()], "sine.fmu");
    assert_names(&said, "4 of 4 points | another model");
    let points = Table::read(&folder.join("sine-check/points.csv"));
    for name in ["F_x error", "F_z error", "P_diss error"] {
        // In the middles of cells as wide as a factor of two.
        assert!(points.column(name).iter().all(|error| error.abs() < 0.05), "{name}: {points:?}");
    }
    // The load is the point's.
    let area = 128.0 * 3.125e-5 * 1e-2;
    let loads = points.column("F_z solution").into_iter().zip(points.column("pressure [Pa]"));
    assert!(loads.into_iter().all(|(force, pressure)| (force / (pressure * area) - 1.0).abs() < 1e-12));

    let patch = folder.join("patch.toml");
    let text = "name = 'p'\n[table]\npath = 'table.csv'\n\
                [patch]\nshape = 'flat'\nlength = 0.1\nwidth = 0.05\nnx = 8\nny = 4\n";
    fs::write(&patch, text).unwrap();
    let said = pack(&["--patch", patch.to_str().unwrap()], "patch.fmu");
    assert_names(&said, "12 of 12 elements");
    assert_names(&said, "to and fro: not done");
    let points = Table::read(&folder.join("patch-check/points.csv"));
    // Solutions found at the separations of elements, between the table's pressures.
    assert!(points.column("force.z error").iter().all(|error| error.abs() < 0.05), "{points:?}");
}

/// What a layer's spacing would spoil is not said where the layer is not used.
#[test]
fn the_layers_spacing_is_no_matter_of_the_solver() {
    let folder = scratch("steady-spacing");
    let (scene, table) = (reference("steady/steady-layer.toml"), folder.join("table.csv"));
    let is_warned_of = |arguments: &[&str]| {
        let coarse = ["--set", "layer.spacing=3.125e-5", "--set", "layer.masses=64"];
        let output = asperity().args(arguments).arg(&scene).args(coarse).output().unwrap();
        String::from_utf8_lossy(&output.stderr).contains("spacing too coarse")
    };
    let sweep = ["sweep", "--force", "--speeds", "1e-2", "--pressures", "2e5", "-o", table.to_str().unwrap()];
    assert!(is_warned_of(&["describe"]));
    assert!(!is_warned_of(&sweep));
    assert!(is_warned_of(
        &[&sweep[..], &["--method", "layer", "--friction-error", "0.5", "--distance", "1e-5"]].concat()
    ));
}

/// A scene with heat on a map, on few points of it.
fn of_road() -> [String; 3] {
    [reference("steady/steady-road.toml").display().to_string(), "--points".into(), "32".into()]
}

/// The way is in the header and in the fingerprint, the rise in the rows; several ways make one table, and a picture.
#[test]
fn rubber_warms_over_a_way() {
    let folder = scratch("steady-way");
    let [scene, points @ ..] = of_road();
    let options = ["--speeds", "0.1,1", "--pressures", "3e5", &points[0], &points[1]];
    let table = folder.join("way.csv");
    let text = sweep(scene.as_ref(), &table, &[&options[..], &["--way", "0.02"]].concat());
    assert!(text.contains("# way = 0.02 m\n"), "{text}");
    let rows = Table::read(&table);
    assert!(rows.number(1, "surface_rise") > rows.number(0, "surface_rise") && rows.number(0, "surface_rise") > 1.0);
    let other =
        refused(&[&["sweep", &scene, "-o", table.to_str().unwrap(), "--way", "0.03"][..], &options[..]].concat());
    assert_names(&other, "another sweep");

    let (ways, picture) = (folder.join("ways.csv"), folder.join("ways.svg"));
    let given = ["--ways", "1mm..20mm/3", "--plot", picture.to_str().unwrap()];
    let text = sweep(scene.as_ref(), &ways, &[&options[..], &given].concat());
    assert!(text.starts_with("way [m],speed [m/s],"), "{text}");
    let all = Table::read(&ways);
    assert_eq!(all.len(), 6);
    assert_eq!((all.number(5, "way"), all.number(5, "friction")), (0.02, rows.number(1, "friction")));
    assert!(fs::read_to_string(&picture).unwrap().contains("way in m"));
}

#[test]
fn a_way_is_refused_of_the_layer_and_without_heat() {
    let [scene, ..] = of_road();
    let at = ["--speeds", "1", "--pressures", "3e5", "--way", "0.02"];
    let of_layer = refused(&[&["sweep", &scene, "--method", "layer"][..], &at].concat());
    assert_names(&of_layer, "--way: expected none");
    let cold = refused(&[&["sweep", reference("steady/steady-map.toml").to_str().unwrap()][..], &at].concat());
    assert_names(&cold, "--way: | material.heat");
}

/// Coulomb's friction of 3 jams on slopes above a third; the area is there all the same.
#[test]
fn a_table_says_where_it_jams() {
    let folder = scratch("steady-jams");
    let table = folder.join("table.csv");
    let output = asperity()
        .args(["sweep", reference("steady/steady-ridges.toml").to_str().unwrap(), "-o", table.to_str().unwrap()])
        .args(["--speeds", "0.1", "--pressures", "3e5", "--set", "friction.coulomb=3"])
        .output()
        .unwrap();
    assert!(!output.status.success());
    let rows = Table::read(&table);
    assert!(rows.text(0, "status").starts_with("jams at "), "{}", rows.text(0, "status"));
    assert!(["friction", "friction_adhesion", "P_friction"].iter().all(|name| rows.text(0, name).is_empty()));
    assert!(rows.number(0, "contact_ratio") > 0.1 && rows.number(0, "friction_hysteresis") > 0.0);
}
