//! Points and files that are no profile.

use crate::{Folder, PATH, assert_refusals, with_line};

#[test]
fn points_that_are_no_profile() {
    assert_refusals(
        "points",
        &[
            (
                15,
                "kind = 'points'\nx = [0]\nz = [0]",
                16,
                "surface.x = [1 numbers]: expected at least 2 points for a profile",
            ),
            (
                15,
                "kind = 'points'\nx = [0, 1]\nz = [0]",
                17,
                "surface.z = [1 numbers]: expected 2 heights, as many as places in x",
            ),
            (
                15,
                "kind = 'points'\nx = [0, 2, 1]\nz = [0, 1, 2]",
                16,
                "surface.x[3] = 1: expected a number > 2.0, the x of the point before, for x must rise",
            ),
            (
                15,
                "kind = 'points'\nx = [0, 2, 2]\nz = [0, 1, 2]",
                16,
                "surface.x[3] = 2: expected each x once, but the point before has x = 2.0 too",
            ),
            (
                15,
                "kind = 'points'\nx = [0, 1]\nz = [0, 0]\nperiodic = true",
                16,
                "surface.x = [2 numbers]: expected at least 3 points for a periodic profile",
            ),
            (
                15,
                "kind = 'points'\nx = [0, 1, 2]\nz = [0.5, 1, 0.6]\nperiodic = true",
                17,
                "surface.z[3] = 0.6: expected 0.5, the first height, for a periodic profile \
                 ends at the height it starts from",
            ),
            (
                15,
                "kind = 'points'\nx = [0, 1e-320, 1]\nz = [0, 1, 0]",
                14,
                "surface = [surface]: expected points with a spline of slopes up to 1e12 and curvatures up to 1e30 1/m",
            ),
            (
                15,
                "kind = 'points'\nx = [0, 1e-20, 1]\nz = [0, 1, 0]",
                14,
                "surface = [surface]: expected points with a spline of slopes up to 1e12 and curvatures up to 1e30 1/m",
            ),
        ],
    );
}

#[test]
fn roughness_that_does_not_fit_the_masses() {
    assert_refusals(
        "roughness",
        &[
            (
                7,
                "roughness = { kind = 'points', z = [0, 1] }",
                7,
                "layer.roughness.z = [2 numbers]: expected 3 heights, one a mass (layer.masses)",
            ),
            (
                7,
                "roughness = { kind = 'points' }",
                7,
                "layer.roughness.z: missing; expected 3 heights, one a mass (layer.masses)",
            ),
            (
                7,
                "roughness = { kind = 'points', z = [0, nan, 1] }",
                7,
                "layer.roughness.z[2] = nan: expected a number from -1e30 to 1e30",
            ),
            (
                7,
                "roughness = { kind = 'points', z = [0, 1, 0], periodic = true }",
                7,
                "layer.roughness.periodic = true: expected no such key for heights at the masses, which have no x",
            ),
            (7, "roughness = [0, 1, 2]", 7, "layer.roughness = [0, 1, 2]: expected a table"),
            (7, "roughness = { kind = 'flat', z = [] }", 7, "layer.roughness.z: unknown; allowed: kind"),
        ],
    );
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
        ("x,z\n0,1\n1,high\n", false, "3: z = \"high\": expected a number from -1e30 to 1e30"),
        ("x,z\n0,1\n1,nan\n", false, "3: z = \"nan\": expected a number from -1e30 to 1e30"),
        (
            "x,z\n0,1\n1,2,3\n",
            false,
            "3: columns = 3 in `1,2,3`: expected two, x and z, separated by comma, semicolon, tab or blanks",
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
            "3: z = 3.0: expected 1.0, the first height, for a periodic profile ends at the height it starts from",
        ),
    ];
    for (profile, periodic, message) in cases {
        folder.write("profile.csv", profile);
        let expected = format!("profile.csv:{message} (file named by surface.path, scene.toml:16)");
        assert_eq!(folder.refusal(&with_profile("profile.csv", periodic)), expected);
    }
}
