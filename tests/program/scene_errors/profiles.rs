//! Points and files that are no profile.

use crate::program::scene_errors::{BASE, Folder, PATH, assert_refusals, with_line};

#[test]
fn points_that_are_no_profile() {
    assert_refusals("points that are no profile", &BASE);
}

#[test]
fn roughness_that_does_not_fit_the_masses() {
    assert_refusals("roughness that does not fit", &BASE);
}

fn with_profile(path: &str, periodic: bool) -> String {
    with_line(15, &format!("kind = 'file'\npath = '{path}'\nperiodic = {periodic}"))
}

#[test]
fn profiles_that_cannot_be_found() {
    let folder = Folder::new("no-profile");
    let missing = folder.refusal(&with_profile("missing.csv", false));
    assert!(
        missing.starts_with("scene.toml:16: surface.path = 'missing.csv': cannot be read: No such file"),
        "{missing}"
    );
    for path in ["/etc/profile.csv", "../profile.csv", "a/../b.csv", "", ".", "a\\b.csv"] {
        let expected = format!("scene.toml:16: surface.path = '{path}': expected {PATH}");
        assert_eq!(folder.refusal(&with_profile(path, false)), expected);
    }
}

#[test]
fn profiles_that_are_none() {
    let folder = Folder::new("bad-profile");
    let cases = [
        ("", false, "1: points = 0: expected at least 2 points for a profile"),
        ("x,z\n0,1\n", false, "2: points = 1: expected at least 2 points for a profile"),
        (
            "x,z\n0,1\n1,high\n",
            false,
            "3: z = \"high\": expected a number from -1e30 to 1e30, or missing = \"fill\" where heights are missing",
        ),
        (
            "x,z\n0,1\n1,nan\n",
            false,
            "3: z = \"nan\": expected a number from -1e30 to 1e30, or missing = \"fill\" where heights are missing",
        ),
        (
            "x,z\n0,1\n1,2,3\n",
            false,
            "3: columns = 3 in \"1,2,3\": expected two, x and z, separated by comma, semicolon, tab or blanks; \
             third_column says what a third one means",
        ),
        (
            "0;1\r\n2;2\r\n1;3\r\n",
            false,
            "3: x = 1.0: expected a number > 2.0, the x of the point before, for x must rise",
        ),
        ("0 1\n1 2\n1 3\n", false, "3: x = 1.0: expected each x once, but the point before has x = 1.0 too"),
        ("0 1\n1 1\n", true, "2: points = 2: expected at least 3 points for a periodic profile"),
        (
            "0 1\n1 2\n2 3\n",
            true,
            "3: z = 3.0: expected 1.0, the first height, for a periodic profile ends at the height it starts from; \
             asperity surface --mirror makes a period of one that ends",
        ),
    ];
    for (profile, periodic, message) in cases {
        folder.write("profile.csv", profile);
        let expected = format!("profile.csv:{message} (file named by surface.path, scene.toml:16)");
        assert_eq!(folder.refusal(&with_profile("profile.csv", periodic)), expected);
    }
}

/// A self-affine surface without fault, one of its keys changed.
fn self_affine(key: &str, value: &str) -> String {
    let keys = [
        ("length", "0.1"),
        ("points", "2000"),
        ("hurst", "0.8"),
        ("rms", "2e-5"),
        ("roll_off_wavelength", "5e-3"),
        ("cut_off_wavelength", "1e-4"),
        ("seed", "7"),
    ];
    let lines = keys.map(|(name, usual)| format!("{name} = {}", if name == key { value } else { usual }));
    with_line(15, &format!("kind = 'self_affine'\n{}", lines.join("\n")))
}

#[test]
fn self_affine_surfaces_that_cannot_be() {
    let folder = Folder::new("self-affine");
    folder.write("scene.toml", &self_affine("seed", "8"));
    asperity::scene::Scene::load(&folder.0.join("scene.toml")).unwrap();
    let cases = [
        ("length", "0", "16: surface.length = 0: expected a number from 1e-30 to 1e30"),
        ("points", "3", "17: surface.points = 3: expected a whole number from 4 to 4000000"),
        ("points", "1999", "17: surface.points = 1999: expected at least 2000: two points for each cut_off_wavelength"),
        ("hurst", "0", "18: surface.hurst = 0: expected a number from 1e-30 to 1.0"),
        ("hurst", "1.1", "18: surface.hurst = 1.1: expected a number from 1e-30 to 1.0"),
        ("rms", "-1e-6", "19: surface.rms = -1e-6: expected a number from 1e-30 to 1e30"),
        (
            "roll_off_wavelength",
            "0.2",
            "20: surface.roll_off_wavelength = 0.2: expected a number up to 0.1, the length",
        ),
        (
            "cut_off_wavelength",
            "5e-3",
            "21: surface.cut_off_wavelength = 5e-3: expected a number < 0.005, the roll_off_wavelength",
        ),
        ("seed", "-1", "22: surface.seed = -1: expected a whole number from 0 to 9223372036854775807"),
        ("seed", "0.5", "22: surface.seed = 0.5: expected a whole number from 0 to 9223372036854775807"),
    ];
    for (key, value, message) in cases {
        assert_eq!(folder.refusal(&self_affine(key, value)), format!("scene.toml:{message}"));
    }
    let missing = folder.refusal(&with_line(15, "kind = 'self_affine'\nlength = 1"));
    assert_eq!(missing, "scene.toml:14: surface.points: missing; expected a whole number from 4 to 4000000");
}

/// As many lines along y as are as far apart as the points along x.
#[test]
fn isotropic_surfaces_that_cannot_be() {
    let folder = Folder::new("isotropic");
    let with = |keys: &str| self_affine("seed", &format!("7\n{keys}"));
    folder.write("scene.toml", &with("isotropic = true\nsize_y = 0.05\nline = 1000"));
    let scene = asperity::scene::Scene::load(&folder.0.join("scene.toml")).unwrap();
    let map = scene.surface.map().unwrap();
    assert_eq!((map.nx(), map.ny(), map.line(999)), (2000, 1000, &scene.surface.z()[..2000]));
    let alone = "expected no such key without isotropic = true: the surface is the same all along y";
    let cases = [
        ("size_y = 0.05", format!("surface.size_y = 0.05: {alone}")),
        ("isotropic = false\nline = 1", format!("surface.line = 1: {alone}")),
        ("isotropic = 1", "surface.isotropic = 1: expected true or false".into()),
        ("isotropic = true\nsize_y = 0", "surface.size_y = 0: expected a number from 1e-30 to 1e30".into()),
        (
            "isotropic = true\nsize_y = 1",
            "surface.points = 2000: expected up to 16777216 points of a map; it has".into(),
        ),
        (
            "isotropic = true\nsize_y = 0.05\nline = 1001",
            "surface.line = 1001: expected a whole number from 1 to 1000".into(),
        ),
    ];
    for (keys, message) in cases {
        let refusal = folder.refusal(&with(keys));
        assert!(refusal.contains(&message), "{refusal}\n{message}");
    }
}

#[test]
fn options_of_files_that_cannot_be() {
    let folder = Folder::new("file-options");
    folder.write("profile.csv", "0 1\n1 2\n2 1\n");
    let units = r#"expected one of "m", "mm", "um", "µm", "nm", "cm", "Å", "in", "mil", "ft""#;
    let cases = [
        ("unit = 'km'", format!("surface.unit = 'km': {units}")),
        ("x_unit = 1", format!("surface.x_unit = 1: {units}")),
        ("missing = true", r#"surface.missing = true: expected one of "refuse", "fill""#.into()),
        ("tilt = 'level'", r#"surface.tilt = 'level': expected one of "keep", "remove""#.into()),
        ("third_column = 'z'", r#"surface.third_column = 'z': expected one of "invalid", "valid", "ignore""#.into()),
        ("line = 0", "surface.line = 0: expected a whole number from 1 to 1000000000".into()),
    ];
    for (option, message) in cases {
        let refusal = folder.refusal(&with_line(15, &format!("kind = 'file'\npath = 'profile.csv'\n{option}")));
        assert_eq!(refusal, format!("scene.toml:17: {message}"));
    }
    let refusal = folder.refusal(&with_line(15, "kind = 'file'\npath = 'profile.csv'\nline = 1"));
    let expected = "line = 1: expected no such number for a profile: it chooses the line of an areal measurement";
    assert_eq!(refusal, format!("profile.csv: {expected} (file named by surface.path, scene.toml:16)"));
    let periodic = "kind = 'file'\npath = 'profile.csv'\ntilt = 'remove'\nperiodic = true";
    let expected = "tilt = \"remove\": expected \"keep\" for a periodic profile, whose ends meet as they are";
    let refusal = folder.refusal(&with_line(15, periodic));
    assert_eq!(refusal, format!("profile.csv: {expected} (file named by surface.path, scene.toml:16)"));
}
