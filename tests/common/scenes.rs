//! Scenes made in parts: what a test does not name is as in a scene file that does not name it.

use std::fs;
use std::path::{Path, PathBuf};

use asperity::scene::{LinkKind, Scene};

/// The text of a scene: keys with their values, each on a line, and phases of motion. On a flat surface and without
/// friction if nothing else is said.
#[derive(Clone, Debug)]
pub struct SceneText {
    keys: Vec<(String, String)>,
    phases: Vec<String>,
}

impl SceneText {
    /// As many point masses, so far apart (m), of this mass each (kg).
    pub fn new(masses: usize, spacing: f64, mass: f64) -> Self {
        Self::of_keys(masses, spacing).set("layer.mass", mass)
    }

    /// As many pieces of rubber, so long, thick and wide (m), with a Poisson's ratio of 0.49 and 1100 kg/m³; its links
    /// are springs.
    pub fn rubber(masses: usize, spacing: f64, thickness: f64, width: f64) -> Self {
        let layer = Self::of_keys(masses, spacing).set("layer.thickness", thickness).set("layer.width", width);
        let layer = layer.set("layer.foundation", "springs");
        layer.set("material.density", 1100.0).set("material.poisson_ratio", 0.49)
    }

    fn of_keys(masses: usize, spacing: f64) -> Self {
        let empty = Self { keys: Vec::new(), phases: Vec::new() };
        empty.set("name", "scene").set("layer.masses", masses).set("layer.spacing", spacing)
    }

    /// Gives a key, such as `friction.coulomb`, a value, in place of the one that it has.
    pub fn set(self, key: &str, value: impl TomlValue) -> Self {
        self.set_toml(key, value.toml())
    }

    fn set_toml(mut self, key: &str, value: String) -> Self {
        self.keys.retain(|(other, _)| other != key);
        self.keys.push((key.to_owned(), value));
        self
    }

    /// Sets each line's `key = value` as in a scene file, such as `friction = { coulomb = 0.3 }`.
    pub fn with(self, lines: &str) -> Self {
        lines.lines().filter(|line| !line.trim().is_empty()).fold(self, |scene, line| {
            let (key, value) = line.split_once('=').unwrap();
            scene.without(key.trim()).set_toml(key.trim(), value.trim().to_owned())
        })
    }

    /// Without a key, or the keys of a table.
    pub fn without(mut self, key: &str) -> Self {
        self.keys.retain(|(other, _)| !is_of(other, key));
        self
    }

    /// From carrier to mass, along z.
    pub fn vertical(self, law: impl Into<Law>) -> Self {
        self.link(LinkKind::Vertical, law)
    }

    /// From carrier to mass, along x.
    pub fn horizontal(self, law: impl Into<Law>) -> Self {
        self.link(LinkKind::Horizontal, law)
    }

    /// From mass to mass, along x.
    pub fn lateral_x(self, law: impl Into<Law>) -> Self {
        self.link(LinkKind::LateralX, law)
    }

    /// From mass to mass, along z.
    pub fn lateral_z(self, law: impl Into<Law>) -> Self {
        self.link(LinkKind::LateralZ, law)
    }

    pub fn link(self, kind: LinkKind, law: impl Into<Law>) -> Self {
        self.set_toml(&format!("layer.{}", kind.name()), law.into().toml())
    }

    /// The Maxwell elements of a link: stiffness (N/m), relaxation time (s).
    pub fn maxwell(self, kind: LinkKind, elements: &[(f64, f64)]) -> Self {
        self.set_toml(&format!("layer.{}.maxwell", kind.name()), self::elements("stiffness", elements))
    }

    /// The numbers of a table that are there.
    pub fn numbers(self, table: &str, numbers: &[(&str, Option<f64>)]) -> Self {
        let given = numbers.iter().filter_map(|(key, value)| Some((key, (*value)?)));
        given.fold(self, |scene, (key, value)| scene.set(&format!("{table}.{key}"), value))
    }

    /// Maxwell elements of the material: modulus (Pa), relaxation time (s).
    pub fn prony(self, terms: &[(f64, f64)]) -> Self {
        let terms = elements("modulus", terms);
        self.set_toml("material.prony", terms)
    }

    /// The shift with temperature of Williams, Landel and Ferry, its constants c1, c2 (K) and reference temperature (K).
    pub fn wlf(self, [c1, c2, reference]: [f64; 3], temperature: f64) -> Self {
        self.with(&format!(
            "material.wlf = {{ c1 = {c1:?}, c2 = {c2:?}, reference_temperature = {reference:?}, temperature = {temperature:?} }}"
        ))
    }

    /// A surface of that amplitude and wavelength, m.
    pub fn sinusoid(self, amplitude: f64, wavelength: f64) -> Self {
        let surface = self.without("surface").set("surface.kind", "sinusoid");
        surface.set("surface.amplitude", amplitude).set("surface.wavelength", wavelength)
    }

    /// A surface through these points, m.
    pub fn points(self, x: &[f64], z: &[f64], periodic: bool) -> Self {
        let surface = self.without("surface").set("surface.kind", "points").set("surface.periodic", periodic);
        surface.set("surface.x", x).set("surface.z", z)
    }

    /// Heights of the masses, m.
    pub fn roughness(self, z: &[f64]) -> Self {
        self.with(&format!("layer.roughness = {{ kind = 'points', z = {z:?} }}"))
    }

    pub fn coulomb(self, coefficient: f64) -> Self {
        self.set("friction.coulomb", coefficient)
    }

    pub fn method(self, method: &str) -> Self {
        self.set("solver.method", method)
    }

    /// Relative tolerance.
    pub fn relative(self, tolerance: f64) -> Self {
        self.set("solver.relative_tolerance", tolerance)
    }

    /// Relative tolerance, and absolute one (m).
    pub fn tolerances(self, relative: f64, absolute: f64) -> Self {
        self.relative(relative).set("solver.absolute_tolerance", absolute)
    }

    pub fn outputs(self, groups: &[&str]) -> Self {
        let groups: Vec<String> = groups.iter().map(TomlValue::toml).collect();
        self.set_toml("fmu.outputs", format!("[{}]", groups.join(", ")))
    }

    /// Adds a phase of the excitation, such as `duration = 1e-3, w_rate = -0.1`.
    pub fn phase(mut self, keys: &str) -> Self {
        self.phases.push(format!("{{ {keys} }}"));
        self
    }

    /// The same with its keys in another order.
    pub fn shuffled(mut self, order: &[usize]) -> Self {
        self.keys = order.iter().filter_map(|&i| self.keys.get(i).cloned()).collect();
        self
    }

    /// Whether a key, or one of a table, is given.
    pub fn has(&self, key: &str) -> bool {
        self.keys.iter().any(|(other, _)| is_of(other, key))
    }

    /// The scene file.
    pub fn text(&self) -> String {
        let mut text: String = self.keys.iter().map(|(key, value)| format!("{key} = {value}\n")).collect();
        if !self.has("surface") {
            text += "surface.kind = 'flat'\n";
        }
        if !self.phases.is_empty() {
            text += &format!("excitation = [{}]\n", self.phases.join(", "));
        }
        text
    }

    /// The scene that the file gives.
    #[track_caller]
    pub fn scene(&self) -> Scene {
        let text = self.text();
        Scene::parse(&text, Path::new("scene.toml")).unwrap_or_else(|error| panic!("{error}\n{text}"))
    }

    /// Writes the file `scene.toml`.
    pub fn write(&self, folder: &Path) -> PathBuf {
        let path = folder.join("scene.toml");
        fs::write(&path, self.text()).unwrap();
        path
    }
}

/// Whether `other` is the key `key` or one of that table.
fn is_of(other: &str, key: &str) -> bool {
    other.strip_prefix(key).is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
}

/// What a key can be given.
pub trait TomlValue {
    fn toml(&self) -> String;
}

macro_rules! toml_values {
    ($($type:ty),*) => { $(impl TomlValue for $type {
        fn toml(&self) -> String {
            // Numbers and strings look alike in TOML and in Rust.
            format!("{self:?}")
        }
    })* };
}
toml_values!(f64, usize, u32, i32, bool, &str, String, &[f64], Vec<f64>);

/// The constants of a link.
#[derive(Clone, Debug, Default)]
pub struct Law {
    /// c, N/m.
    pub stiffness: f64,
    /// d, N s/m; 0 is left out.
    pub damping: f64,
    /// Maxwell elements: c_j (N/m), τ_j (s).
    pub maxwell: Vec<(f64, f64)>,
}

impl Law {
    /// A spring and a damper.
    pub fn new(stiffness: f64, damping: f64) -> Self {
        Self { stiffness, damping, maxwell: Vec::new() }
    }

    /// With Maxwell elements (c_j, τ_j).
    pub fn with_maxwell(stiffness: f64, damping: f64, maxwell: &[(f64, f64)]) -> Self {
        Self { stiffness, damping, maxwell: maxwell.to_vec() }
    }

    /// K*(ω) = c + iωd + Σ_j c_j iωτ_j/(1 + iωτ_j): its real and its imaginary part.
    pub fn complex_stiffness(&self, omega: f64) -> (f64, f64) {
        let element = |&(c, tau): &(f64, f64)| {
            let x = omega * tau;
            (c * x * x / (1.0 + x * x), c * x / (1.0 + x * x))
        };
        let add = |sum: (f64, f64), part: (f64, f64)| (sum.0 + part.0, sum.1 + part.1);
        self.maxwell.iter().map(element).fold((self.stiffness, omega * self.damping), add)
    }

    fn toml(&self) -> String {
        let damping = if self.damping == 0.0 { String::new() } else { format!(", damping = {:?}", self.damping) };
        let maxwell = elements("stiffness", &self.maxwell);
        format!("{{ stiffness = {:?}{damping}, maxwell = {maxwell} }}", self.stiffness)
    }
}

fn elements(size: &str, elements: &[(f64, f64)]) -> String {
    let element = |(value, tau): &(f64, f64)| format!("{{ {size} = {value:?}, relaxation_time = {tau:?} }}");
    format!("[{}]", elements.iter().map(element).collect::<Vec<_>>().join(", "))
}

/// A spring.
impl From<f64> for Law {
    fn from(stiffness: f64) -> Self {
        Self::new(stiffness, 0.0)
    }
}

/// A spring and a damper.
impl From<(f64, f64)> for Law {
    fn from((stiffness, damping): (f64, f64)) -> Self {
        Self::new(stiffness, damping)
    }
}

/// A spring, a damper and Maxwell elements.
impl<const N: usize> From<(f64, f64, [(f64, f64); N])> for Law {
    fn from((stiffness, damping, maxwell): (f64, f64, [(f64, f64); N])) -> Self {
        Self::with_maxwell(stiffness, damping, &maxwell)
    }
}

impl From<&Law> for Law {
    fn from(law: &Law) -> Self {
        law.clone()
    }
}
