//! A file with a profile or with a Prony series, read as a scene reads it: refused with a place and a reason, or a spline,
//! or a material.

use std::path::PathBuf;
use std::sync::OnceLock;
use std::{env, fs, process};

use asperity::scene::{Friction, Link, Method, Scene};

use super::scene::run_scene;

/// Longer ones are no other profiles.
const MOST_BYTES: usize = 4096;

/// Writes the bytes behind the first into a file, and reads a scene that names it: a profile, periodic where the first is
/// odd; a Prony series where the first has the bit 4.
pub fn run(bytes: &[u8]) {
    let Some((flags, text)) = bytes.split_first().filter(|(_, text)| text.len() <= MOST_BYTES) else { return };
    let scene_file = folder().join("scene.toml");
    fs::write(folder().join("profile.csv"), text).unwrap();
    let periodic = flags & 1 == 1;
    let is_series = flags & 4 == 4;
    let read = if is_series { rubber() } else { scene(periodic) };
    match Scene::parse(&read, &scene_file) {
        Ok(scene) if is_series => run_scene(scene),
        Ok(scene) => {
            check(&scene, periodic);
            run_scene(with_links(scene, if flags & 2 == 2 { Method::Step } else { Method::Event }));
        }
        Err(error) => {
            let message = error.to_string();
            assert!(message.contains("scene.toml"), "{message}");
            assert!(!message.contains('\n'), "{message}");
        }
    }
}

fn folder() -> &'static PathBuf {
    static FOLDER: OnceLock<PathBuf> = OnceLock::new();
    FOLDER.get_or_init(|| {
        let folder = env::temp_dir().join(format!("asperity-profile-{}", process::id()));
        fs::create_dir_all(&folder).unwrap();
        folder
    })
}

/// As short as can be: the rest is added later.
fn scene(periodic: bool) -> String {
    format!(
        "name='p'\nlayer={{masses=2,spacing=1e-4,mass=1e-7}}\n\
         surface={{kind='file',path='profile.csv',periodic={periodic}}}"
    )
}

/// One mass whose material is in the file.
fn rubber() -> String {
    "name='r'\nlayer={masses=1,spacing=1e-4,thickness=1e-3,width=1e-2}\n\
     material={density=1e3,poisson_ratio=0.49,equilibrium_modulus=2e6,prony='profile.csv'}\n\
     surface={kind='flat'}"
        .into()
}

fn with_links(mut scene: Scene, method: Method) -> Scene {
    let link = Link { stiffness: Some(2e3), damping: Some(8e-3), maxwell: Vec::new() };
    (scene.layer.vertical, scene.layer.horizontal) = (Some(link.clone()), Some(link));
    scene.friction = Some(Friction { coulomb: Some(0.3), ..Friction::default() });
    scene.solver.method = method;
    scene
}

/// What every profile keeps to.
fn check(scene: &Scene, periodic: bool) {
    let (x, z) = (&scene.surface.x, &scene.surface.z);
    assert!(x.len() == z.len() && x.len() >= if periodic { 3 } else { 2 });
    assert!(x.windows(2).all(|pair| pair[0] < pair[1]));
    assert!(!periodic || z[0] == z[z.len() - 1]);
    let spline = scene.surface.spline();
    for place in x.windows(2).flat_map(|pair| [pair[0], 0.5 * pair[0] + 0.5 * pair[1]]) {
        let (height, slope, curvature, third) = spline.evaluate(place);
        assert!([height, slope, curvature, third].iter().all(|value| value.is_finite()), "at {place}");
    }
}
