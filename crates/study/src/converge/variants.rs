//! Variants of a scene: another spacing, length or seed. Values of its text are replaced and it is read anew, so
//! roughness is sampled and links are fitted as for any scene.

use std::ops::Range;
use std::path::{Path, PathBuf};

use asperity::scene::Scene;
use asperity_formats::Instruments;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::error::ConvergeError;
use crate::error::Error;
use crate::settings::{self, Overridden, Setting};
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

/// A number of the scene's text.
#[derive(Clone, Debug, PartialEq)]
struct Number {
    span: Range<usize>,
    value: NumberValue,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum NumberValue {
    Whole(u64),
    Real(f64),
}

/// The numbers of a self-affine surface that change.
#[derive(Clone, Debug, PartialEq)]
struct SelfAffineNumbers {
    length: Number,
    points: Number,
    seed: Number,
}

/// The number at which the profile ends and the waves that it lacks begin.
#[derive(Clone, Debug, PartialEq)]
struct SplitNumber {
    /// The wavelength, m.
    wavelength: Number,
    /// The points of a self-affine surface, which follow its shortest wave.
    points: Option<Number>,
}

/// A scene in the material form of which variants are made.
#[derive(Clone, Debug)]
pub(super) struct Template {
    path: PathBuf,
    text: String,
    /// What is set in files that the scene names.
    in_named_files: Vec<Setting>,
    masses: Number,
    spacing: Number,
    /// The surface, then the roughness of the layer.
    self_affine: Vec<SelfAffineNumbers>,
    split: Option<SplitNumber>,
    /// The dimensions of the scene itself.
    own: Dimensions,
    parts: Parts,
}

impl Template {
    /// Of the `text` of the scene file at `path`, its keys set to other values.
    pub(super) fn read(text: &str, path: &Path, set: &[Setting]) -> Result<Self, ConvergeError> {
        Self::new(path, settings::overridden(text, set).map_err(Error::from)?)
    }

    fn new(path: &Path, overridden: Overridden) -> Result<Self, ConvergeError> {
        let Overridden { text, in_named_files } = overridden;
        let unclear = || ConvergeError::Unclear { path: path.to_owned() };
        let document = DeTable::parse(&text).map_err(|_| unclear())?;
        let document = document.get_ref();
        let layer = table(document, "layer").ok_or_else(unclear)?;
        let surfaces = [table(document, "surface"), table(layer, "roughness")];
        if surfaces[1].is_some_and(|roughness| roughness.contains_key("z") && !roughness.contains_key("x")) {
            return Err(ConvergeError::HeightsAtMasses { path: path.to_owned() });
        }
        let self_affine: Vec<SelfAffineNumbers> =
            surfaces.into_iter().flatten().filter_map(SelfAffineNumbers::new).collect();
        let (masses, spacing) = (number(layer, "masses"), number(layer, "spacing"));
        let (masses, spacing) = masses.zip(spacing).ok_or_else(unclear)?;
        let seed = self_affine.first().map(|surface| surface.seed.value.whole());
        let split = table(document, "surface").and_then(SplitNumber::new);
        let longest = split.as_ref().map(|split| split.wavelength.value.real());
        let (masses_of_scene, spacing_of_scene) = (masses.value.whole(), spacing.value.real());
        let own = Dimensions { count: masses_of_scene, spacing: spacing_of_scene, seed, split: longest };
        let parts = Parts::Masses;
        Ok(Self { path: path.to_owned(), text, in_named_files, masses, spacing, self_affine, split, own, parts })
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
    pub(super) fn scene(&self, variant: Variant) -> Result<Scene, Error> {
        let mut scene = Scene::parse_with(&self.text_of(variant), &self.path, &Instruments)?;
        settings::set_in_named_files(&mut scene, &self.in_named_files)?;
        Ok(scene)
    }

    /// The scene's text with the numbers of a variant.
    fn text_of(&self, variant: Variant) -> String {
        let Dimensions { count, spacing, .. } = self.dimensions(variant);
        let factor = 1_u32 << u32::from(variant.doubled);
        let mut changes = vec![(&self.masses, NumberValue::Whole(count)), (&self.spacing, NumberValue::Real(spacing))];
        for SelfAffineNumbers { length, points, seed } in &self.self_affine {
            changes.push((length, NumberValue::Real(f64::from(factor) * length.value.real())));
            changes.push((points, NumberValue::Whole(u64::from(factor) * points.value.whole())));
            changes.push((seed, NumberValue::Whole(shifted(seed.value.whole(), variant.seed_shift))));
        }
        if let Some(SplitNumber { wavelength, points }) = self.split.as_ref().filter(|_| variant.split) {
            changes.push((wavelength, NumberValue::Real(0.5 * wavelength.value.real())));
            changes.retain(|(number, _)| Some(*number) != points.as_ref());
            changes.extend(
                points.iter().map(|points| (points, NumberValue::Whole(2 * u64::from(factor) * points.value.whole()))),
            );
        }
        changes.retain(|(number, value)| number.value != *value);
        // From the end, so that those before stay where they are.
        changes.sort_by_key(|(number, _)| std::cmp::Reverse(number.span.start));
        let mut text = self.text.clone();
        changes.into_iter().for_each(|(number, value)| text.replace_range(number.span.clone(), &value.text()));
        text
    }
}

/// A seed so much further on, within what TOML can write.
fn shifted(seed: u64, shift: u32) -> u64 {
    seed.wrapping_add(u64::from(shift)) & i64::MAX.unsigned_abs()
}

impl SelfAffineNumbers {
    /// That of a table of a surface; `None` for every other kind.
    fn new(surface: &DeTable<'_>) -> Option<Self> {
        if surface.get("kind")?.get_ref().as_str() != Some("self_affine") {
            return None;
        }
        Some(Self {
            length: number(surface, "length")?,
            points: number(surface, "points")?,
            seed: number(surface, "seed")?,
        })
    }
}

impl SplitNumber {
    /// That of a table of a surface: of a self-affine one whose law goes on below its cut-off, or of a measured line that
    /// is split; `None` for every other one.
    fn new(surface: &DeTable<'_>) -> Option<Self> {
        let fine = table(surface, "fine")?;
        if fine.contains_key("split") {
            return Some(Self { wavelength: number(fine, "split")?, points: None });
        }
        let continued = fine.contains_key("shortest") && !fine.contains_key("longest");
        let wavelength = number(surface, "cut_off_wavelength").filter(|_| continued)?;
        Some(Self { wavelength, points: number(surface, "points") })
    }
}

fn table<'a>(table: &'a DeTable<'a>, key: &str) -> Option<&'a DeTable<'a>> {
    table.get(key)?.get_ref().as_table()
}

fn number(table: &DeTable<'_>, key: &str) -> Option<Number> {
    let entry: &Spanned<DeValue<'_>> = table.get(key)?;
    let value = match entry.get_ref() {
        DeValue::Float(float) => NumberValue::Real(float.as_str().parse().ok()?),
        other => {
            let whole = other.as_integer()?;
            NumberValue::Whole(u64::from_str_radix(whole.as_str(), whole.radix()).ok()?)
        }
    };
    Some(Number { span: entry.span(), value })
}

impl NumberValue {
    fn whole(self) -> u64 {
        match self {
            Self::Whole(number) => number,
            Self::Real(number) => number as u64,
        }
    }

    fn real(self) -> f64 {
        match self {
            Self::Whole(number) => number as f64,
            Self::Real(number) => number,
        }
    }

    fn text(self) -> String {
        match self {
            Self::Whole(number) => number.to_string(),
            Self::Real(number) => format!("{number:?}"),
        }
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

    fn template(text: &str) -> Result<Template, ConvergeError> {
        Template::new("scene.toml".as_ref(), settings::overridden(text, &[]).unwrap())
    }

    #[test]
    fn nothing_changed_is_the_same_text() {
        assert_eq!(template(TEXT).unwrap().text_of(Variant::default()), TEXT);
    }

    #[test]
    fn variants_change_spacing_length_and_seeds_alone() {
        let template = template(TEXT).unwrap();
        let variant = Variant { halvings: 2, doubled: true, seed_shift: 3, split: false };
        let expected = TEXT
            .replace("0x10, spacing = 1e-4", "128, spacing = 2.5e-5")
            .replace("9223372036854775807, length = 1.0, points = 1_000", "2, length = 2.0, points = 2000")
            .replace("length = 1.6e-3\npoints = 64", "length = 0.0032\npoints = 128")
            .replace("seed = 5", "seed = 8");
        assert_eq!(template.text_of(variant), expected);
        let scene = template.scene(variant).unwrap();
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
        let expected = text.replace("points = 64", "points = 128").replace("= 2e-4", "= 0.0001");
        assert_eq!((template.text_of(split), template.has_split()), (expected, true));
        let scenes = [Variant::default(), split].map(|variant| template.scene(variant).unwrap());
        // One octave of more than seven.
        let bands = scenes.each_ref().map(|scene| scene.fine_gradient().powi(2));
        assert!(bands[1] < 0.97 * bands[0], "{bands:?}");
    }

    #[test]
    fn heights_at_the_masses_have_no_variants() {
        let text = TEXT.replace("kind = 'self_affine', seed", "kind = 'points', z = [0.0], seed");
        assert!(matches!(template(&text), Err(ConvergeError::HeightsAtMasses { .. })));
    }
}
