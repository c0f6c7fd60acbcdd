//! Pairs of scenes: one without a feature, one with it at zero.

use std::path::Path as FilePath;

use asperity::scene::{OutputGroup, Path, Scene};
use asperity::simulation::{Motion, Simulation, Start};

/// Two scenes that must behave alike.
pub struct Pair {
    pub feature: &'static str,
    pub without: Scene,
    pub with: Scene,
    /// Beginnings or ends of the names of the variables that only the second has.
    pub variables: &'static [&'static str],
}

/// The parts of a scene.
#[derive(Clone)]
struct Parts {
    masses: usize,
    /// Vertical, horizontal, lateral_x, lateral_z: spring, damper, Maxwell elements.
    links: [Option<Link>; 4],
    roughness: bool,
    friction: Option<&'static str>,
    outputs: Vec<OutputGroup>,
}

#[derive(Clone, Copy)]
struct Link {
    stiffness: f64,
    damping: Option<f64>,
    maxwell: Option<f64>,
}

const NAMES: [&str; 4] = ["vertical", "horizontal", "lateral_x", "lateral_z"];

/// A pair for each feature, of so many masses.
pub fn pairs(masses: usize) -> Vec<Pair> {
    let link =
        |stiffness: f64| Some(Link { stiffness, damping: Some(4e-6 * stiffness), maxwell: Some(0.5 * stiffness) });
    let whole = Parts {
        masses,
        links: [link(2e3), link(1e3), link(5e2), link(3e2)],
        roughness: false,
        friction: Some("coulomb = 0.3, shear_force = 1e-4"),
        outputs: vec![OutputGroup::Forces],
    };
    let mut pairs = links(&whole);
    pairs.extend(parts_of_links(&whole));
    pairs.extend(friction(&whole));
    let rough = Parts { roughness: true, ..whole.clone() };
    pairs.push(pair("elastic roughness", &whole, &rough, &[]));
    pairs.extend(outputs(&whole));
    pairs
}

fn pair(feature: &'static str, without: &Parts, with: &Parts, variables: &'static [&'static str]) -> Pair {
    Pair { feature, without: without.scene(), with: with.scene(), variables }
}

/// A kind of link left out, or there without stiffness.
fn links(whole: &Parts) -> Vec<Pair> {
    let names = [
        ("link vertical", &["layer.vertical.stiffness"] as &[_]),
        ("link horizontal", &["layer.horizontal.stiffness"]),
        ("link lateral_x", &["layer.lateral_x.stiffness"]),
        ("link lateral_z", &["layer.lateral_z.stiffness"]),
    ];
    let nothing = Link { stiffness: 0.0, damping: None, maxwell: None };
    let of = |(kind, (feature, variables)): (usize, (&'static str, &'static [&'static str]))| {
        let (mut without, mut with) = (whole.clone(), whole.clone());
        without.links[kind] = None;
        with.links[kind] = Some(nothing);
        pair(feature, &without, &with, variables)
    };
    names.into_iter().enumerate().map(of).collect()
}

fn parts_of_links(whole: &Parts) -> [Pair; 2] {
    let changed = |change: fn(&mut Link)| {
        let mut parts = whole.clone();
        parts.links.iter_mut().flatten().for_each(change);
        parts
    };
    let (no_maxwell, zero_maxwell) = (changed(|link| link.maxwell = None), changed(|link| link.maxwell = Some(0.0)));
    let (no_damping, zero_damping) = (changed(|link| link.damping = None), changed(|link| link.damping = Some(0.0)));
    [
        pair("Maxwell elements", &no_maxwell, &zero_maxwell, &["].stiffness", "].relaxation_time"]),
        pair("damping", &no_damping, &zero_damping, &[".damping"]),
    ]
}

fn friction(whole: &Parts) -> [Pair; 4] {
    let of = |friction| Parts { friction, ..whole.clone() };
    let coulomb: &[_] = &["friction.coulomb"];
    let shear: &[_] = &["friction.shear_force"];
    let rate_shear = "coulomb = 0.3, rate_shear = { force = 0.0, reference_speed = 1e-2, sharpness = 0.1 }";
    [
        pair("friction", &of(None), &of(Some("coulomb = 0.0, shear_force = 0.0")), &["friction."]),
        pair("Coulomb", &of(Some("shear_force = 1e-4")), &of(Some("coulomb = 0.0, shear_force = 1e-4")), coulomb),
        pair("shear", &of(Some("coulomb = 0.3")), &of(Some("coulomb = 0.3, shear_force = 0.0")), shear),
        pair(
            "rate shear",
            &of(Some("coulomb = 0.3")),
            &of(Some(rate_shear)),
            &["friction.rate_shear.", "friction.memory"],
        ),
    ]
}

/// A group of outputs not asked for, or asked for.
fn outputs(whole: &Parts) -> Vec<Pair> {
    use OutputGroup::{Contact, Dissipation, Elements, Energy, Forces, Friction, Solver, Tangent};
    let groups = [
        ("forces", Forces, &["F_x", "F_z"] as &'static [&'static str]),
        ("dissipation, energy accounting", Dissipation, &["P_diss", "E_diss", "dissipation."]),
        ("friction outputs", Friction, &["friction."]),
        ("contact", Contact, &["contact."]),
        ("energy, energy accounting", Energy, &["energy."]),
        ("tangent", Tangent, &["tangent."]),
        ("solver", Solver, &["solver."]),
        ("elements", Elements, &["element["]),
    ];
    let of = |(feature, group, variables)| {
        // Contact is left to compare by where forces are the group in question.
        let rest = if group == Forces { Contact } else { Forces };
        let without = Parts { outputs: vec![rest], ..whole.clone() };
        let with = Parts { outputs: vec![rest, group], ..whole.clone() };
        pair(feature, &without, &with, variables)
    };
    groups.into_iter().map(of).collect()
}

impl Parts {
    fn scene(&self) -> Scene {
        let links: String = NAMES.iter().zip(&self.links).map(|(name, link)| link_text(name, link.as_ref())).collect();
        let zeros = vec!["0.0"; self.masses].join(", ");
        let roughness =
            if self.roughness { format!("roughness = {{ kind = 'points', z = [{zeros}] }}\n") } else { String::new() };
        let friction = self.friction.map_or_else(String::new, |parts| format!("friction = {{ {parts} }}\n"));
        let groups: Vec<_> = self.outputs.iter().map(|group| format!("'{}'", group.word())).collect();
        let text = format!(
            "name = 'pair'\n{friction}fmu = {{ outputs = [{}] }}\n\
             surface = {{ kind = 'sinusoid', amplitude = 1e-5, wavelength = 9.3e-4 }}\n\
             [layer]\nmasses = {}\nspacing = 1e-4\nmass = 1e-6\n{roughness}{links}",
            groups.join(", "),
            self.masses
        );
        Scene::parse(&text, FilePath::new("pair.toml")).unwrap()
    }
}

fn link_text(name: &str, link: Option<&Link>) -> String {
    let Some(link) = link else { return String::new() };
    let damping = link.damping.map_or_else(String::new, |damping| format!(", damping = {damping:?}"));
    let element = |stiffness: f64, relaxation_time: f64| {
        format!("{{ stiffness = {stiffness:?}, relaxation_time = {relaxation_time:?} }}")
    };
    let maxwell = link.maxwell.map_or_else(String::new, |stiffness| {
        let elements = [1e-5, 1e-4, 1e-3].map(|relaxation_time| element(stiffness, relaxation_time));
        format!(", maxwell = [{}]", elements.join(", "))
    });
    format!("{name} = {{ stiffness = {:?}{damping}{maxwell} }}\n", link.stiffness)
}

/// Sixteen elements a link, those of a measured compound, with and without those that act like springs and dampers on
/// the scene's time scales.
pub fn reduced(masses: usize) -> Pair {
    const MODULI: [f64; 16] =
        [1538.0, 888.0, 824.0, 495.0, 201.0, 76.3, 31.9, 14.8, 8.12, 4.65, 3.16, 2.26, 1.67, 1.42, 0.969, 1.26];
    let link = |(name, geometry): (&str, f64)| {
        let element = |(j, modulus): (usize, &f64)| {
            let relaxation_time = 10_f64.powi(j as i32 - 13);
            format!("{{ stiffness = {:?}, relaxation_time = {relaxation_time:?} }}", geometry * modulus)
        };
        let elements: Vec<_> = MODULI.iter().enumerate().map(element).collect();
        format!("{name} = {{ stiffness = {:?}, maxwell = [{}] }}\n", 4.44 * geometry, elements.join(", "))
    };
    let links =
        [("vertical", 1e3), ("horizontal", 340.0), ("lateral_x", 200.0), ("lateral_z", 100.0)].map(link).concat();
    let scene = |reduce: f64| {
        let text = format!(
            "name = 'compound'\nsurface = {{ kind = 'sinusoid', amplitude = 1e-5, wavelength = 9.3e-4 }}\n\
             friction = {{ coulomb = 0.3 }}\nsolver = {{ reduce = {reduce:?} }}\n\
             [layer]\nmasses = {masses}\nspacing = 1e-4\nmass = 1.1e-6\n{links}\
             [[excitation]]\nduration = 6e-4\nu_rate = 0.5\nw_sine = {{ amplitude = 2e-6, frequency = 3000.0 }}\n"
        );
        Scene::parse(&text, FilePath::new("compound.toml")).unwrap()
    };
    Pair { feature: "reduce = 1e-3 of 16 elements", without: scene(1e-3), with: scene(0.0), variables: &[] }
}

/// A run of one of the scenes: pressed on the wave, slid along it by a third of its length.
pub fn started(scene: &Scene) -> Simulation {
    Simulation::new(scene, &Start { w: -2e-6, u_rate: 0.5, ..Start::default() }).unwrap()
}

/// One of the pieces of the carrier's motion, alike; after each the outputs are compared.
pub fn piece() -> Motion {
    let w = Path { amplitude: 2e-6, frequency: 3000.0, ..Path::default() };
    Motion { duration: 6e-5, u: Path { rate: 0.5, ..Path::default() }, w, ..Motion::default() }
}

/// Pieces of a run.
pub const PIECES: usize = 10;
