//! The scenes of benches/peers and the way they go to the peers; the peers themselves need packages that are not here.

use std::fs::{self, File};
use std::path::Path;
use std::process::{Command, Output};

use crate::common::{asperity, root, run, scratch};
use asperity::scene::Scene;

fn python(script: &str) -> Command {
    let mut command = Command::new("python3");
    command.arg("-B").arg(root().join("benches/peers").join(script));
    command
}

/// What flatten.py makes of a scene.
fn flatten(scene: &Path) -> Output {
    let json = scene.with_extension("json");
    fs::write(&json, run(asperity().arg("describe").arg(scene).arg("--json"))).unwrap();
    python("flatten.py").stdin(File::open(json).unwrap()).output().unwrap()
}

#[test]
fn the_benchmark_s_scenes_are_made_the_same_everywhere() {
    let folder = scratch("peers-scenes");
    run(python("scenes.py").arg(&folder));
    let load = |name: &str| Scene::load(&folder.join(name).with_extension("toml")).unwrap();
    // Heights from the generator of numpy, rounded to 1e-13 m.
    for (name, masses, points, second) in [
        ("tread-block-50", 50, 2001, -6.0428208e-6),
        ("tread-block-200", 200, 2001, -6.0428208e-6),
        ("tread-block-200-rough", 200, 2001, -1.06333967e-5),
        ("tread-block-800", 800, 8001, -1.71984189e-5),
    ] {
        let scene = load(name);
        assert_eq!((scene.layer.masses, scene.surface.z().len()), (masses, points), "{name}");
        assert!((scene.surface.z()[1] - second).abs() < 1e-13, "{name}: {}", scene.surface.z()[1]);
        assert_eq!(scene.warnings, [""; 0], "{name}");
    }
    let chain = load("smooth-chain-1000");
    assert_eq!((chain.layer.masses, chain.surface.z().len()), (1000, 10001));
    assert_eq!(chain.warnings, [""; 0]);
}

#[test]
fn the_peers_get_every_number_of_a_scene_or_refuse_it() {
    let folder = scratch("peers-flatten");
    let text = fs::read_to_string(root().join("tests/reference/free-chain.toml")).unwrap();
    let scene = folder.join("scene.toml");
    fs::write(&scene, &text).unwrap();
    let flat = String::from_utf8(flatten(&scene).stdout).unwrap();
    assert!(flat.starts_with("mass 1e-07 relaxed 1\nvertical 2000.0 0.005 2 1000.0 0.0001 500.0 1e-05\n"), "{flat}");
    assert!(flat.contains("masses 5\n0.0 0.001\n0.0001 0.001003\n"), "{flat}");
    assert!(flat.ends_with("phases 1\n0.002 0.0 1e-05 2000.0 0.0 5e-06 3500.0\n"), "{flat}");
    fs::write(&scene, text + "until_force = 1.0\n").unwrap();
    let refused = flatten(&scene);
    assert!(!refused.status.success());
    assert!(String::from_utf8(refused.stderr).unwrap().contains("until_force"));
}

/// Rungs at tolerances 1e-1 to 1e-4: the second has a small error by chance, which the third does not confirm.
#[test]
fn a_rung_counts_with_the_largest_error_of_it_and_of_all_tighter_ones() {
    let script = "
from ladder import Rung, counting_errors, time_at
rungs = [Rung(0, {'F_x': error, 'F_z': 0.0}, 0, 0, 9.0, [2 * time, time])
         for error, time in ((1e-1, 1.0), (1e-5, 2.0), (1e-2, 3.0), (1e-4, 12.0))]
print(counting_errors(rungs), *(f'{time_at(rungs, error):.3f}' for error in (1.0, 1e-2, 1e-3)), time_at(rungs, 1e-5))
";
    let folder = root().join("benches/peers");
    let said = run(Command::new("python3").args(["-B", "-c", script]).env("PYTHONPATH", folder));
    // Between 1e-2 in 2 s and 1e-4 in 12 s, in logarithms, lies 1e-3 in √24 s.
    assert_eq!(said.trim(), "[0.1, 0.01, 0.01, 0.0001] 1.000 2.000 4.899 None");
}
