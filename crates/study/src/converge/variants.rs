//! Variants of a scene: another spacing, length or seed. Its values are replaced, so roughness is sampled and links are
//! fitted as for any scene.

use std::path::Path;

use asperity::scene::{Scene, SceneError, Setting};

use crate::error::Error;
use crate::steady::{GridSize, SurfaceGrid};

/// What a run differs in from the scene.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Variant {
    /// How often the spacing is halved, at the same length.
    pub halvings: u32,
    /// Whether layer and self-affine surface are twice as long.
    pub doubled: bool,
    /// What is added to the seeds.
    pub seed_shift: u32,
    /// Whether the profile has waves down to half the wavelength at which those that it lacks begin in the scene.
    pub split: bool,
}

impl Variant {
    /// With the spacing halved so often.
    pub fn halved(halvings: u32) -> Self {
        Self { halvings, ..Self::default() }
    }

    /// Whether nothing but the spacing differs.
    pub fn is_of_ladder(self) -> bool {
        !self.doubled && !self.split && self.seed_shift == 0
    }

    /// The one that its values are compared with: twice the spacing, or the same one.
    pub fn reference(self) -> Option<Self> {
        if self.is_of_ladder() {
            Some(Self::halved(self.halvings.checked_sub(1)?))
        } else {
            Some(Self::halved(self.halvings))
        }
    }

    /// The place in a table: halvings, then lengths, then the other split, then seeds.
    pub fn place(self) -> (bool, bool, bool, u32, u32) {
        (self.seed_shift > 0, self.split, self.doubled, self.halvings, self.seed_shift)
    }
}

/// What is halved, and a part of which is a contact.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Parts {
    /// The masses of the layer.
    Masses,
    /// The points of a period of the surface along x, with so many rows of them in the scene itself.
    Points {
        /// The rows.
        rows: u64,
    },
}

impl Parts {
    /// As the table's columns call them.
    pub fn name(self) -> &'static str {
        match self {
            Self::Masses => "masses",
            Self::Points { .. } => "points",
        }
    }
}

/// The layer or the period of the surface in a run, and its seed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dimensions {
    /// Number of masses k, or of points along x.
    pub count: u64,
    /// Δx, m.
    pub spacing: f64,
    /// The seed of the surface, else that of the layer's roughness; `None`: neither has one.
    pub seed: Option<u64>,
    /// The wavelength at which the profile ends and the waves that it lacks begin, m; `None` where it cannot move.
    pub split: Option<f64>,
}

impl Dimensions {
    /// Length kΔx, m.
    pub fn length(&self) -> f64 {
        self.count as f64 * self.spacing
    }
}

/// The numbers of a self-affine surface that change.
#[derive(Clone, Debug, PartialEq)]
struct SelfAffineNumbers {
    /// The path of its table.
    table: &'static str,
    length: f64,
    points: u64,
    seed: u64,
}

/// The number at which the profile ends and the waves that it lacks begin.
#[derive(Clone, Debug, PartialEq)]
struct Split {
    key: &'static str,
    /// The wavelength, m.
    wavelength: f64,
    /// Whether the points of a self-affine surface follow its shortest wave.
    has_points: bool,
}

/// A scene in the material form of which variants are made.
#[derive(Clone, Debug)]
pub(super) struct Template {
    scene: Scene,
    /// The surface, then the roughness of the layer.
    self_affine: Vec<SelfAffineNumbers>,
    split: Option<Split>,
    /// The dimensions of the scene itself.
    own: Dimensions,
    parts: Parts,
}

impl Template {
    /// Of a `scene` that was read from the file at `path`.
    pub(super) fn new(scene: &Scene, path: &Path) -> Result<Self, Error> {
        let has = |key: &str| scene.values.get(key).is_some();
        if has("layer.roughness.z") && !has("layer.roughness.x") {
            let problem = "layer.roughness has one height for each mass, and none for the masses between at half the spacing: \
                           give x too, or another kind";
            return Err(Error::scene(format!("{}: {problem}", path.display())));
        }
        let tables = ["surface", "layer.roughness"];
        let self_affine: Vec<_> = tables.into_iter().filter_map(|table| SelfAffineNumbers::new(scene, table)).collect();
        let split = Split::new(scene);
        let own = Dimensions {
            count: scene.layer.masses as u64,
            spacing: scene.layer.spacing,
            seed: self_affine.first().map(|surface| surface.seed),
            split: split.as_ref().map(|split| split.wavelength),
        };
        Ok(Self { scene: scene.clone(), self_affine, split, own, parts: Parts::Masses })
    }

    /// The same with the points of a surface in place of the masses.
    pub(super) fn on_grid(self, surface: &SurfaceGrid) -> Self {
        let GridSize { nx, ny } = surface.size;
        let own = Dimensions { count: nx as u64, spacing: surface.length / nx as f64, ..self.own };
        Self { own, parts: Parts::Points { rows: ny as u64 }, ..self }
    }

    pub(super) fn parts(&self) -> Parts {
        self.parts
    }

    /// Whether there is more of the surface with twice the length, or the layer slides over more of it.
    pub(super) fn has_length(&self) -> bool {
        self.parts == Parts::Masses || self.has_seed()
    }

    /// Whether there are other seeds.
    pub(super) fn has_seed(&self) -> bool {
        self.own.seed.is_some()
    }

    /// Whether the profile may end elsewhere, and the waves that it lacks begin there.
    pub(super) fn has_split(&self) -> bool {
        self.split.is_some()
    }

    /// Number of masses, or of points of the whole surface, with the spacing halved so often.
    pub(super) fn contacts(&self, halvings: u32) -> u64 {
        let rows = if let Parts::Points { rows: rows @ 2.. } = self.parts { rows << halvings } else { 1 };
        (self.own.count << halvings) * rows
    }

    pub(super) fn dimensions(&self, variant: Variant) -> Dimensions {
        Dimensions {
            count: (self.own.count << variant.halvings) << u32::from(variant.doubled),
            spacing: self.own.spacing / f64::from(variant.halvings).exp2(),
            seed: self.own.seed.map(|seed| shifted(seed, variant.seed_shift)),
            split: self.own.split.map(|split| if variant.split { 0.5 * split } else { split }),
        }
    }

    /// The scene of a variant; with points in place of masses the layer has as many masses.
    pub(super) fn scene(&self, variant: Variant) -> Result<Scene, SceneError> {
        self.scene.with_all(&self.settings(variant))
    }

    /// The numbers of a variant that are others than those of the scene.
    fn settings(&self, variant: Variant) -> Vec<Setting> {
        let Dimensions { count, spacing, .. } = self.dimensions(variant);
        let mut settings = Vec::new();
        if count != self.scene.layer.masses as u64 {
            settings.push(Setting::new("layer.masses", count as i64));
        }
        if spacing != self.scene.layer.spacing {
            settings.push(Setting::new("layer.spacing", spacing));
        }
        let split = self.split.as_ref().filter(|_| variant.split);
        settings.extend(split.map(|split| Setting::new(split.key, 0.5 * split.wavelength)));
        for &SelfAffineNumbers { table, length, points, seed } in &self.self_affine {
            let is_split = table == "surface" && split.is_some_and(|split| split.has_points);
            let mut set =
                |name: &str, value: toml::Value| settings.push(Setting::new(format!("{table}.{name}"), value));
            if variant.doubled {
                set("length", (2.0 * length).into());
            }
            if variant.doubled || is_split {
                set("points", ((points << u32::from(variant.doubled)) << u32::from(is_split)).cast_signed().into());
            }
            if variant.seed_shift > 0 {
                set("seed", shifted(seed, variant.seed_shift).cast_signed().into());
            }
        }
        settings
    }
}

/// A seed so much further on, within what TOML can write.
fn shifted(seed: u64, shift: u32) -> u64 {
    seed.wrapping_add(u64::from(shift)) & i64::MAX.unsigned_abs()
}

impl SelfAffineNumbers {
    /// That of a table of a surface; `None` for every other kind.
    fn new(scene: &Scene, table: &'static str) -> Option<Self> {
        if scene.values.get(&format!("{table}.kind"))?.as_str() != Some("self_affine") {
            return None;
        }
        let whole = |name: &str| Some(scene.values.get(&format!("{table}.{name}"))?.as_integer()?.unsigned_abs());
        let length = scene.number(&format!("{table}.length"))?;
        Some(Self { table, length, points: whole("points")?, seed: whole("seed")? })
    }
}

impl Split {
    /// That of a self-affine surface whose law goes on below its cut-off, or of a measured line that is split; `None` for
    /// every other one.
    fn new(scene: &Scene) -> Option<Self> {
        let of = |key, has_points| Some(Self { key, wavelength: scene.number(key)?, has_points });
        let has = |key: &str| scene.values.get(key).is_some();
        if has("surface.fine.split") {
            return of("surface.fine.split", false);
        }
        let continued = has("surface.fine.shortest") && !has("surface.fine.longest");
        of("surface.cut_off_wavelength", true).filter(|_| continued)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "name = 'v' # 16 masses\n\
        layer = { masses = 0x10, spacing = 1e-4, thickness = 1e-3, width = 1e-2, \
        roughness = { kind = 'self_affine', seed = 9223372036854775807, length = 1.0, points = 1_000, hurst = 0.8, \
        rms = 1e-7, roll_off_wavelength = 0.5, cut_off_wavelength = 0.01 } }\n\
        material = { density = 1e3, poisson_ratio = 0.49, equilibrium_modulus = 1e6, prony = [] }\n\
        [surface]\nkind = 'self_affine'\nlength = 1.6e-3\npoints = 64\nhurst = 0.8\nrms = 1e-6\n\
        roll_off_wavelength = 1e-3\ncut_off_wavelength = 2e-4\nseed = 5\n[solver]\nabsolute_tolerance = 1e-4\n";

    fn template(text: &str) -> Result<Template, Error> {
        Template::new(&Scene::parse(text, "scene.toml".as_ref()).unwrap(), "scene.toml".as_ref())
    }

    #[test]
    fn variants_change_spacing_length_and_seeds_alone() {
        let template = template(TEXT).unwrap();
        assert_eq!(template.settings(Variant::default()), []);
        let variant = Variant { halvings: 2, doubled: true, seed_shift: 3, split: false };
        let expected = TEXT
            .replace("0x10, spacing = 1e-4", "128, spacing = 2.5e-5")
            .replace("9223372036854775807, length = 1.0, points = 1_000", "2, length = 2.0, points = 2000")
            .replace("length = 1.6e-3\npoints = 64", "length = 0.0032\npoints = 128")
            .replace("seed = 5", "seed = 8");
        let scene = template.scene(variant).unwrap();
        assert_eq!(scene, Scene::parse(&expected, "scene.toml".as_ref()).unwrap());
        assert_eq!((scene.layer.masses, scene.layer.roughness.len(), scene.surface.x().len()), (128, 128, 129));
        let dimensions = Dimensions { count: 128, spacing: 2.5e-5, seed: Some(8), split: None };
        assert_eq!(template.dimensions(variant), dimensions);
        assert!(scene.layer.roughness.iter().any(|height| *height != 0.0));
    }

    /// The profile gets the waves that it lacked, down to half the wavelength, and points for them.
    #[test]
    fn the_split_moves_with_the_profile() {
        let text = TEXT.replace("[solver]", "fine = { shortest = 1e-6 }\n[solver]");
        let split = Variant { split: true, ..Variant::default() };
        let template = template(&text).unwrap();
        let wanted = [Setting::new("surface.cut_off_wavelength", 1e-4), Setting::new("surface.points", 128)];
        assert_eq!((template.settings(split), template.has_split()), (wanted.to_vec(), true));
        let scenes = [Variant::default(), split].map(|variant| template.scene(variant).unwrap());
        // One octave of more than seven.
        let bands = scenes.each_ref().map(|scene| scene.fine_gradient().powi(2));
        assert!(bands[1] < 0.97 * bands[0], "{bands:?}");
    }

    #[test]
    fn heights_at_the_masses_have_no_variants() {
        let points = "{ kind = 'points', z = [0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0] }";
        let roughness = TEXT.find("{ kind = 'self_affine', seed").unwrap()..TEXT.find(" }\n").unwrap();
        let mut text = TEXT.to_owned();
        text.replace_range(roughness, points);
        assert!(template(&text).unwrap_err().to_string().contains("one height for each mass"));
    }
}
