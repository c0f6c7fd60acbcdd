//! A file with a profile, a Prony series, a spectrum or a table of softening, as a scene reads it: an error with a
//! position and a reason, or a valid spline, material or roughness.

use std::io::{Cursor, Write as _};
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use std::{env, fs, process};

use asperity::scene::{Friction, Link, LinkKind, Method, Scene};
use zip::ZipWriter;
use zip::write::SimpleFileOptions;

use super::scene::run_scene;

/// Maximum length of a file, bytes; longer ones test nothing new.
const MAX_BYTES: usize = 4096;

/// Writes all bytes but the first two into a file and reads a scene that names it, as a profile with the keys that the
/// bits of those two select, or where the highest bit is set as another file of a scene of rubber.
pub fn run(bytes: &[u8]) {
    let Some(([first, second], text)) = bytes.split_first_chunk().filter(|(_, text)| text.len() <= MAX_BYTES) else {
        return;
    };
    let bit = |byte: u8, i: u32| byte >> i & 1 == 1;
    let scene_file = folder().join("scene.toml");
    let file = if bit(*first, 2) { archive(text) } else { text.to_vec() };
    fs::write(folder().join("profile.csv"), file).unwrap();
    let periodic = bit(*first, 0);
    let of_rubber = bit(*first, 7);
    let read = if of_rubber { rubber(*second) } else { scene(periodic, &keys(*first, *second)) };
    match Scene::parse_with(&read, &scene_file, &asperity_formats::Instruments, &[]) {
        Ok(scene) if of_rubber => {
            check_fine(&scene);
            run_scene(scene);
        }
        Ok(scene) => {
            check(&scene, periodic);
            check_carried(&scene, &scene_file, &keys(*first, *second));
            run_scene(with_links(scene, if bit(*first, 1) { Method::Step } else { Method::Event }));
        }
        Err(error) => {
            let message = error.to_string();
            assert!(message.contains("scene.toml"), "{message}");
            assert!(!message.contains('\n'), "{message}");
        }
    }
}

/// The keys of the scene's surface that the bits select.
fn keys(first: u8, second: u8) -> String {
    let choice = |byte: u8, shift: u32, words: &[&'static str]| words.get(usize::from(byte >> shift) % 4).copied();
    let missing = choice(first, 3, &["missing='fill'", "missing='refuse'"]);
    let tilt = choice(first, 5, &["tilt='remove'"]);
    let line = choice(second, 0, &["line=1", "line=2", "line=3"]);
    let third = choice(second, 2, &["third_column='invalid'", "third_column='valid'", "third_column='ignore'"]);
    let unit = choice(second, 4, &["unit='um'", "x_unit='mm'", "z_unit='nm'"]);
    let columns = choice(second, 6, &["columns=['1','2']", "spacing=1e-5", "spacing=[1e-5,1e-5]"]);
    let keys = [missing, tilt, line, third, unit, columns].into_iter().flatten();
    keys.map(|key| format!(",{key}")).collect()
}

/// An X3P file: its document and, after a zero byte, the points, whose first bits are the mask, too.
fn archive(bytes: &[u8]) -> Vec<u8> {
    let zero = bytes.iter().position(|&byte| byte == 0).unwrap_or(bytes.len());
    let (document, points) = bytes.split_at(zero);
    let points = points.get(1..).unwrap_or_default();
    let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, bytes) in
        [("a/main.xml", document), ("a/data.bin", points), ("a/valid.bin", &points[..points.len().min(1)])]
    {
        writer.start_file(name, SimpleFileOptions::default()).unwrap();
        writer.write_all(bytes).unwrap();
    }
    writer.finish().unwrap().into_inner()
}

/// Checks that what an FMU carries in place of the file is the same profile, bit for bit.
fn check_carried(scene: &Scene, scene_file: &Path, keys: &str) {
    let Some(file) = scene.files.first() else { return };
    let (name, content) = (folder().join(&file.carried_name), file.carried().unwrap());
    fs::remove_file(folder().join("profile.csv")).unwrap();
    fs::write(&name, content).unwrap();
    let carried = Scene::parse(&self::scene(scene.surface.is_periodic(), keys), scene_file).unwrap();
    fs::remove_file(name).unwrap();
    assert_eq!((&carried.surface, &carried.files), (&scene.surface, &scene.files));
}

fn folder() -> &'static PathBuf {
    static FOLDER: OnceLock<PathBuf> = OnceLock::new();
    FOLDER.get_or_init(|| {
        let folder = env::temp_dir().join(format!("asperity-profile-{}", process::id()));
        fs::create_dir_all(&folder).unwrap();
        folder
    })
}

/// A minimal scene; links are added later.
fn scene(periodic: bool, keys: &str) -> String {
    format!(
        "name='p'\nlayer={{masses=2,spacing=1e-4,mass=1e-7}}\n\
         surface={{kind='file',path='profile.csv',periodic={periodic}{keys}}}"
    )
}

/// One mass of which the file holds what the bits select.
fn rubber(second: u8) -> String {
    let (prony, surface) = match second % 4 {
        3 => ("'profile.csv'", "kind='flat'"),
        1 => (TERM, "kind='flat',fine={spectrum='profile.csv',longest=1e-3,shortest=1e-5}"),
        2 => (TERM, "kind='flat',fine={hurst=0.8,rms_slope=1,longest=1e-3,shortest=1e-5,softening='profile.csv'}"),
        _ => (TERM, "kind='file',path='profile.csv',fine={split=1e-4,shortest=1e-6}"),
    };
    format!(
        "name='r'\nlayer={{masses=1,spacing=1e-4,thickness=1e-3,width=1e-2}}\n\
         material={{density=1e3,poisson_ratio=0.49,equilibrium_modulus=2e6,prony={prony}}}\n\
         surface={{{surface}}}"
    )
}

const TERM: &str = "[{modulus=5e6,relaxation_time=1e-5}]";

/// The bands are numbers.
fn check_fine(scene: &Scene) {
    for band in scene.fine_bands() {
        let numbers = [band.wave_number, band.gradient_square, band.factors.storage, band.factors.loss];
        assert!(numbers.iter().all(|number| number.is_finite() && *number >= 0.0), "{band:?}");
    }
}

fn with_links(mut scene: Scene, method: Method) -> Scene {
    let link = Link { stiffness: Some(2e3), damping: Some(8e-3), maxwell: Vec::new() };
    for kind in [LinkKind::Vertical, LinkKind::Horizontal] {
        scene.layer.links[kind] = Some(link.clone());
    }
    scene.friction = Some(Friction { coulomb: Some(0.3), ..Friction::default() });
    scene.solver.method = method;
    scene
}

/// The properties of every profile.
fn check(scene: &Scene, periodic: bool) {
    let (x, z) = (scene.surface.x(), scene.surface.z());
    assert!(x.len() == z.len() && x.len() >= if periodic { 3 } else { 2 });
    assert!(x.windows(2).all(|pair| pair[0] < pair[1]));
    assert!(!periodic || z[0] == z[z.len() - 1]);
    let spline = scene.surface.spline();
    for place in x.windows(2).flat_map(|pair| [pair[0], 0.5 * pair[0] + 0.5 * pair[1]]) {
        let (height, slope, curvature, third) = spline.evaluate(place);
        assert!([height, slope, curvature, third].iter().all(|value| value.is_finite()), "at {place}");
    }
}
