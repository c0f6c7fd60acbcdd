//! The keys of a scene file: the one table of their names, of what they may hold and of what they mean. The reader
//! checks scenes against it, and the parameters of an FMU take their ranges, units and descriptions from it.

mod patch;

use std::fmt;

use super::values::{ANY, LOOSEST_TOLERANCE, NOT_NEGATIVE, NumberRange, POSITIVE, WholeRange, Word, words};
use super::{
    CarrierInitial, Convention, DependencyList, Extrapolation, FoundationKind, Initial, IntegerType, LengthUnit,
    Method, Missing, OutputGroup, ThirdColumn, Tilt, Unit,
};

pub(super) use patch::{
    BACKING_NORMAL, BACKING_SHEAR, HEAT_CAPACITY, HEAT_CONDUCTIVITY, HEAT_DENSITY, HEAT_SHARE, PATCH_ROOT, REFINE,
    ShapeKind, TABLE_EXTRAPOLATION,
};

#[derive(Clone, Copy, Debug)]
pub(super) struct Key {
    pub(super) name: &'static str,
    pub(super) allowed: Allowed,
    /// The unit of a number; 1 for everything else.
    pub(super) unit: Unit,
    /// What it means, in a few words: the description of a parameter.
    pub(super) meaning: &'static str,
    /// The form of a scene that it belongs to; `None`: both.
    pub(super) form: Option<Form>,
    pub(super) absent: Absent,
}

/// What the absence of a key stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Absent {
    /// An error, wherever its table stands: but heights at the masses, as `layer.roughness` may give them, have no x.
    Refused,
    /// A value, as it would be written in the file.
    Value(&'static str),
    /// What follows from elsewhere, in a few words.
    Follows(&'static str),
    /// There is none, or the other keys of the table say whether there must be.
    None,
}

#[derive(Clone, Copy, Debug)]
pub(super) enum Allowed {
    Number(NumberRange),
    Numbers(NumberRange),
    Whole(WholeRange),
    Flag,
    /// A text, and what it is.
    Text(&'static str),
    /// A word; the words to choose from.
    Word(fn() -> String),
    Words(fn() -> String),
    Table(&'static [Key]),
    /// An array of tables, and what it is.
    Tables(&'static [Key], &'static str),
    /// A table whose keys depend on its `kind`.
    Surface,
}

/// The two forms of a scene, of which it has exactly one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Form {
    /// By the mass and the constants of the links.
    Direct,
    /// By `[material]`, thickness and width.
    Material,
}

const fn key(name: &'static str, allowed: Allowed, meaning: &'static str) -> Key {
    Key { name, allowed, unit: Unit::One, meaning, form: None, absent: Absent::None }
}

const fn number(name: &'static str, range: NumberRange, unit: Unit, meaning: &'static str) -> Key {
    Key { unit, ..key(name, Allowed::Number(range), meaning) }
}

const fn numbers(name: &'static str, range: NumberRange, unit: Unit, meaning: &'static str) -> Key {
    Key { unit, ..key(name, Allowed::Numbers(range), meaning) }
}

const fn whole(name: &'static str, low: i64, high: i64, meaning: &'static str) -> Key {
    key(name, Allowed::Whole(WholeRange { low, high }), meaning)
}

const fn word<T: Word>(name: &'static str, meaning: &'static str) -> Key {
    key(name, Allowed::Word(words::<T>), meaning)
}

const fn table(name: &'static str, keys: &'static [Key]) -> Key {
    key(name, Allowed::Table(keys), "")
}

impl Key {
    const fn direct(self) -> Self {
        Self { form: Some(Form::Direct), ..self }
    }

    const fn material(self) -> Self {
        Self { form: Some(Form::Material), ..self }
    }

    const fn required(self) -> Self {
        Self { absent: Absent::Refused, ..self }
    }

    const fn default(self, value: &'static str) -> Self {
        Self { absent: Absent::Value(value), ..self }
    }

    const fn follows(self, what: &'static str) -> Self {
        Self { absent: Absent::Follows(what), ..self }
    }

    /// The range of a number; `None` for everything else.
    pub(super) fn range(&self) -> Option<NumberRange> {
        if let Allowed::Number(range) = self.allowed { Some(range) } else { None }
    }

    /// The keys of the table, or of the tables, that it holds.
    pub(super) fn keys(&self) -> &'static [Self] {
        match self.allowed {
            Allowed::Table(keys) | Allowed::Tables(keys, _) => keys,
            Allowed::Surface => SURFACE,
            _ => &[],
        }
    }
}

pub(super) const ROOT: &[Key] = &[
    key("name", Allowed::Text("a text"), "Name of the scene").required(),
    key(
        "description",
        Allowed::Text("a text without control characters but line breaks and tabs"),
        "What the scene is",
    ),
    table("layer", LAYER).required(),
    table("material", MATERIAL),
    key("surface", Allowed::Surface, "Rigid surface below the layer").required(),
    table("carrier", CARRIER),
    table("friction", FRICTION),
    table("solver", SOLVER),
    table("input", INPUT),
    table("fmu", FMU),
    key("excitation", Allowed::Tables(PHASE, TABLES), "Motion of the carrier in runs without a master"),
];

const TABLES: &str = "an array of tables";

const LAYER: &[Key] = &[
    whole("masses", 1, 10_000_000, "Number of point masses").required(),
    number("spacing", POSITIVE, Unit::Meter, "Distance of the masses at rest").required(),
    number("origin", ANY, Unit::Meter, "Position of the first mass at rest").default("0"),
    number("clearance", ANY, Unit::Meter, "Rest height of the layer above the profile's datum at w = 0").default("0"),
    word::<Initial>("initial", "How the dashpots start: relaxed or undeformed").default("\"relaxed\""),
    key("roughness", Allowed::Surface, "Roughness of the layer"),
    number("mass", POSITIVE, Unit::Kilogram, "Mass of one point mass").required().direct(),
    table("vertical", LINK).direct(),
    table("horizontal", LINK).direct(),
    table("lateral_x", LINK).direct(),
    table("lateral_z", LINK).direct(),
    number("thickness", POSITIVE, Unit::Meter, "Thickness of the layer")
        .follows("required but of a half-space")
        .material(),
    number("width", POSITIVE, Unit::Meter, "Width of the layer").required().material(),
    word::<FoundationKind>("foundation", "What the links stand for: springs, half_space or layer")
        .default("\"springs\"")
        .material(),
];

const LINK: &[Key] = &[
    number("stiffness", NOT_NEGATIVE, Unit::NewtonPerMeter, "Stiffness").default("0"),
    number("damping", NOT_NEGATIVE, Unit::NewtonSecondPerMeter, "Damping").default("0"),
    key("maxwell", Allowed::Tables(MAXWELL, TABLES), "Maxwell elements"),
];

const MAXWELL: &[Key] = &[
    number("stiffness", NOT_NEGATIVE, Unit::NewtonPerMeter, "Stiffness").required(),
    number("relaxation_time", POSITIVE, Unit::Second, "Relaxation time").required(),
];

const MATERIAL: &[Key] = &[
    number("density", POSITIVE, Unit::KilogramPerCubicMeter, "Density of the layer's material").required(),
    number("poisson_ratio", NOT_NEGATIVE.up_to(0.5), Unit::One, "Poisson's ratio of the layer's material").required(),
    number("equilibrium_modulus", NOT_NEGATIVE, Unit::Pascal, "Modulus of the layer's material after all relaxation")
        .required(),
    number(
        "viscosity",
        NOT_NEGATIVE,
        Unit::PascalSecond,
        "Kelvin-Voigt viscosity of the layer's material at the reference temperature",
    )
    .default("0"),
    key(
        "prony",
        Allowed::Tables(
            PRONY_TERM,
            "an array of tables, or the path of a CSV file beside the scene with relaxation_time (s) and modulus (Pa)",
        ),
        "Prony series",
    )
    .required(),
    table("wlf", WLF),
    table("heat", HEAT),
];

const PRONY_TERM: &[Key] = &[
    number("modulus", NOT_NEGATIVE, Unit::Pascal, "Modulus").required(),
    number("relaxation_time", POSITIVE, Unit::Second, "Relaxation time").required(),
];

const HEAT: &[Key] = &[
    number("conductivity", POSITIVE, Unit::WattPerMeterKelvin, "Heat conductivity of the layer's material").required(),
    number("capacity", POSITIVE, Unit::JoulePerKilogramKelvin, "Specific heat capacity of the layer's material")
        .required(),
    number("share", POSITIVE.up_to(1.0), Unit::One, "Part of the friction power that the layer takes").default("1"),
];

const WLF: &[Key] = &[
    number("c1", NOT_NEGATIVE, Unit::One, "C_1 of Williams, Landel and Ferry").required(),
    number("c2", POSITIVE, Unit::Kelvin, "C_2 of Williams, Landel and Ferry").required(),
    number("reference_temperature", POSITIVE, Unit::Kelvin, "Temperature at which the material's times are given")
        .required(),
    number("temperature", POSITIVE, Unit::Kelvin, "Temperature of the layer").required(),
];

/// Where the heights of a surface come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum SurfaceKind {
    Flat,
    Sinusoid,
    SelfAffine,
    Points,
    File,
}

impl Word for SurfaceKind {
    const WORDS: &'static [(&'static str, Self)] = &[
        ("flat", Self::Flat),
        ("sinusoid", Self::Sinusoid),
        ("self_affine", Self::SelfAffine),
        ("points", Self::Points),
        ("file", Self::File),
    ];
}

impl SurfaceKind {
    /// The keys of a surface of this kind.
    pub(super) fn keys(self) -> &'static [Key] {
        match self {
            Self::Flat => SURFACE,
            Self::Sinusoid => SINUSOID,
            Self::SelfAffine => SELF_AFFINE,
            Self::Points => POINTS,
            Self::File => FILE,
        }
    }
}

const KIND: Key = word::<SurfaceKind>("kind", "Where the heights come from").required();

const FINE: Key = table("fine", FINE_ROUGHNESS).material();

const FINE_ROUGHNESS: &[Key] = &[
    number("hurst", POSITIVE.up_to(1.0), Unit::One, "Hurst exponent of the roughness that the profile lacks"),
    number("rms_slope", NOT_NEGATIVE, Unit::One, "Root mean square gradient of the roughness that the profile lacks"),
    number("longest", POSITIVE, Unit::Meter, "Longest wavelength of the roughness that the profile lacks"),
    number("shortest", POSITIVE, Unit::Meter, "Shortest wavelength of the roughness that the profile lacks"),
    key("spectrum", Allowed::Text(PATH), "File of the spectrum of the roughness that the profile lacks"),
    word::<Convention>("convention", "How that spectrum is normalised").default("\"persson\""),
    number(
        "split",
        POSITIVE,
        Unit::Meter,
        "Wavelength at which the measured line is split into profile and fine roughness",
    ),
    number("modulus", POSITIVE, Unit::Pascal, "Plane modulus at which that roughness is pressed flat, at every speed"),
    number("creep_speed", POSITIVE, Unit::MeterPerSecond, "Speed below which that roughness rubs as at this one")
        .follows("that of `friction.rate_shear`, else 1e-6"),
    key("hysteresis", Allowed::Flag, "Whether that roughness rubs by hysteresis").default("true"),
    number("softening", POSITIVE.up_to(1.0), Unit::One, "Factor on the moduli in that roughness").default("1"),
];

const SURFACE: &[Key] = &[KIND, FINE];

const SINUSOID: &[Key] = &[
    KIND,
    FINE,
    number("amplitude", ANY, Unit::Meter, "Amplitude").required(),
    number("wavelength", POSITIVE, Unit::Meter, "Wavelength").required(),
    whole("points_per_wavelength", 4, 10_000_000, "Data points of one wavelength").default("64"),
];

const LINE: Key =
    whole("line", 1, 1_000_000_000, "Line of a map along x that a layer slides over").follows("the middle one");

const SELF_AFFINE: &[Key] = &[
    KIND,
    FINE,
    number("length", POSITIVE, Unit::Meter, "Period").required(),
    whole("points", 4, 4_000_000, "Data points of one period").required(),
    number("hurst", POSITIVE.up_to(1.0), Unit::One, "Hurst exponent").required(),
    number("rms", POSITIVE, Unit::Meter, "Root mean square height").required(),
    number("roll_off_wavelength", POSITIVE, Unit::Meter, "Wavelength above which the spectrum is constant").required(),
    number("cut_off_wavelength", POSITIVE, Unit::Meter, "Shortest wavelength").required(),
    whole("seed", 0, i64::MAX, "Seed of the random phases").required(),
    key("isotropic", Allowed::Flag, "Whether the surface is a map, the same along all directions").default("false"),
    number("size_y", POSITIVE, Unit::Meter, "Period of the map along y").follows("`length`"),
    LINE,
];

const POINTS: &[Key] = &[
    KIND,
    FINE,
    numbers("x", ANY, Unit::Meter, "Positions of the data points").required(),
    numbers("z", ANY, Unit::Meter, "Heights of the data points").required(),
    PERIODIC,
];

const PERIODIC: Key = key("periodic", Allowed::Flag, "Whether the profile is repeated without end").default("false");

const FILE: &[Key] = &[
    KIND,
    FINE,
    key("path", Allowed::Text(PATH), "File of the profile").required(),
    PERIODIC,
    word::<LengthUnit>("unit", "Unit of both columns").follows("the file's, else m"),
    word::<LengthUnit>("x_unit", "Unit of x").follows("`unit`"),
    word::<LengthUnit>("z_unit", "Unit of z").follows("`unit`"),
    word::<Missing>("missing", "What becomes of points without a height").default("\"refuse\""),
    word::<Tilt>("tilt", "What becomes of the profile's tilt").default("\"keep\""),
    word::<ThirdColumn>("third_column", "What a third column means"),
    key("columns", Allowed::Text(COLUMNS), "Columns of x and z, by their names or numbers"),
    numbers("spacing", POSITIVE, Unit::Meter, "Distance of points of a file without x"),
    LINE,
];

/// What `columns` holds.
const COLUMNS: &str = "[\"x\", \"z\"], the names or the numbers of the columns as texts, or [\"z\"] beside spacing";

/// The path of a file that can go into the FMU with the scene.
pub(super) const PATH: &str = "a relative path of a file beside or below the scene file, without `..` and backslashes";

const FRICTION: &[Key] = &[
    number("coulomb", NOT_NEGATIVE, Unit::One, "Coulomb's friction coefficient").default("0"),
    table("rate_shear", RATE_SHEAR),
    table("real_area", REAL_AREA).material(),
    number("shear_force", NOT_NEGATIVE, Unit::Newton, "Adhesive shear force of one mass in contact")
        .default("0")
        .direct(),
    number("shear_strength", NOT_NEGATIVE, Unit::Pascal, "Adhesive shear strength of the contact")
        .default("0")
        .material(),
];

const CARRIER: &[Key] = &[table("x", CARRIER_X), table("z", CARRIER_Z)];

const CARRIER_MASS: Key = number("mass", POSITIVE, Unit::Kilogram, "Mass of the carrier").required();
const CARRIER_STIFFNESS: Key =
    number("stiffness", NOT_NEGATIVE, Unit::NewtonPerMeter, "Stiffness of the spring from the carrier to its drive")
        .default("0");
const CARRIER_DAMPING: Key =
    number("damping", NOT_NEGATIVE, Unit::NewtonSecondPerMeter, "Damping of the damper from the carrier to its drive")
        .default("0");
const CARRIER_START: Key =
    number("start", ANY, Unit::Meter, "Displacement of the carrier at the start").follows("that of its drive");
const CARRIER_START_RATE: Key =
    number("start_rate", ANY, Unit::MeterPerSecond, "Speed of the carrier at the start").default("0");

const CARRIER_X: &[Key] = &[
    CARRIER_MASS,
    CARRIER_STIFFNESS,
    CARRIER_DAMPING,
    number("pull", ANY, Unit::Newton, "Constant part of the tangential force on the carrier").default("0"),
    CARRIER_START,
    CARRIER_START_RATE,
];

const CARRIER_Z: &[Key] = &[
    CARRIER_MASS,
    CARRIER_STIFFNESS,
    CARRIER_DAMPING,
    number("load", ANY, Unit::Newton, "Constant part of the normal load on the carrier").default("0"),
    CARRIER_START,
    CARRIER_START_RATE,
    word::<CarrierInitial>(
        "initial",
        "Where the carrier starts along z: start, or equilibrium, where the springs bear the load",
    )
    .default("\"start\""),
];

/// An old key, which the reader refuses with what says the same in `surface.fine`.
pub(super) const RETIRED: &str = "friction.real_area";

const REAL_AREA: &[Key] = &[
    number("rms_slope", NOT_NEGATIVE, Unit::One, "In its place: surface.fine"),
    number("wavelength", POSITIVE, Unit::Meter, "In its place: surface.fine"),
    number("modulus", POSITIVE, Unit::Pascal, "In its place: surface.fine"),
    number("cut_off_wavelength", POSITIVE, Unit::Meter, "In its place: surface.fine"),
];

const RATE_SHEAR: &[Key] = &[
    number(
        "reference_speed",
        POSITIVE,
        Unit::MeterPerSecond,
        "Speed at which the rate-dependent shear force is largest",
    )
    .required(),
    number(
        "sharpness",
        NOT_NEGATIVE,
        Unit::One,
        "Coefficient c in exp(-c log10(v/v0)^2), the fall of the rate-dependent shear force about its maximum",
    )
    .required(),
    number(
        "creep_speed",
        POSITIVE,
        Unit::MeterPerSecond,
        "Speed below which the rate-dependent shear force is constant; follows the reference speed until it is set itself",
    ).follows("1e-6 of `reference_speed`"),
    number("force", NOT_NEGATIVE, Unit::Newton, "Largest rate-dependent shear force of one mass in contact")
        .required()
        .direct(),
    number("strength", NOT_NEGATIVE, Unit::Pascal, "Largest rate-dependent shear strength of the contact")
        .required()
        .material(),
];

const SOLVER: &[Key] = &[
    word::<Method>(
        "method",
        "event: locate each mode change; step: correct touches and lifts at the end of each step; auto: switch between \
         the two",
    )
    .default("\"event\""),
    number("relative_tolerance", POSITIVE.up_to(LOOSEST_TOLERANCE), Unit::One, "Relative tolerance of the local error")
        .default("1e-6"),
    number(
        "absolute_tolerance",
        POSITIVE,
        Unit::Meter,
        "Absolute tolerance of positions; follows the relative one until it is set itself",
    )
    .follows("`relative_tolerance` times the scene's height"),
    // An Integer of FMI has 32 bits.
    whole("max_steps", 1, i32::MAX as i64, "Steps that one communication step or one phase may take")
        .follows("10000000; a step of a master is bounded by its work"),
    number("reduce", NOT_NEGATIVE.up_to(0.1), Unit::One, "Error bound for leaving Maxwell elements out").default("0"),
];

const INPUT: &[Key] = &[
    word::<Extrapolation>("extrapolation", "How the carrier moves when no rates are given: linear or hold")
        .default("\"linear\""),
    key("temperature", Allowed::Flag, "Whether the layer's temperature is an input").default("false").material(),
];

const FMU: &[Key] = &[
    key("outputs", Allowed::Words(words::<OutputGroup>), "Groups of output variables")
        .default("[\"forces\", \"dissipation\"]"),
    INTEGERS,
    DEPENDENCIES,
];

const INTEGERS: Key =
    word::<IntegerType>("integers", "Type of the outputs that are whole numbers").default("\"integer\"");
const DEPENDENCIES: Key =
    word::<DependencyList>("dependencies", "Dependencies of outputs on inputs that are listed").default("\"direct\"");

const PHASE: &[Key] = &[
    key("file", Allowed::Text(PATH), "File of the motion, with columns time, u and w, in place of the other keys"),
    number("duration", POSITIVE, Unit::Second, "Duration").follows("required but of a file"),
    number("u_rate", ANY, Unit::MeterPerSecond, "Rate of u").default("0"),
    number("w_rate", ANY, Unit::MeterPerSecond, "Rate of w").default("0"),
    table("u_sine", SINE),
    table("w_sine", SINE),
    number("load", ANY, Unit::Newton, "Load at the start of the phase").follows("what it has reached, 0 at first"),
    number("load_rate", ANY, Unit::NewtonPerSecond, "Rate of the load").default("0"),
    table("load_sine", FORCE_SINE),
    number("pull", ANY, Unit::Newton, "Tangential force at the start of the phase")
        .follows("what it has reached, 0 at first"),
    number("pull_rate", ANY, Unit::NewtonPerSecond, "Rate of the tangential force").default("0"),
    table("pull_sine", FORCE_SINE),
    number("pressure", ANY, Unit::Pascal, "Load over the layer's area at the start of the phase")
        .follows("what it has reached, 0 at first")
        .material(),
    number("pressure_rate", ANY, Unit::PascalPerSecond, "Rate of the load over the layer's area")
        .default("0")
        .material(),
    table("pressure_sine", PRESSURE_SINE).material(),
    number("temperature", POSITIVE, Unit::Kelvin, "Temperature of the layer from the phase's start on")
        .follows("as before")
        .material(),
    number("until_force", ANY, Unit::Newton, "F_z that ends the phase").direct(),
    number("until_pressure", ANY, Unit::Pascal, "Mean pressure that ends the phase").material(),
];

const SINE: &[Key] = &[
    number("amplitude", ANY, Unit::Meter, "Amplitude").required(),
    number("frequency", NOT_NEGATIVE, Unit::Hertz, "Frequency").required(),
];

const FORCE_SINE: &[Key] = &[
    number("amplitude", ANY, Unit::Newton, "Amplitude").required(),
    number("frequency", NOT_NEGATIVE, Unit::Hertz, "Frequency").required(),
];

const PRESSURE_SINE: &[Key] = &[
    number("amplitude", ANY, Unit::Pascal, "Amplitude").required(),
    number("frequency", NOT_NEGATIVE, Unit::Hertz, "Frequency").required(),
];

/// What the reader gets for a key that is not in the table; it accepts no value.
pub(super) const NONE: Key = key("", Allowed::Text("no such key"), "");

/// The key at the end of a path such as `layer.vertical.maxwell[1].stiffness`.
pub(super) fn at(path: &str) -> Option<&'static Key> {
    let (mut keys, mut found) = (ROOT, None);
    for part in path.split('.') {
        let name = part.split_once('[').map_or(part, |(name, _)| name);
        let key = keys.iter().find(|key| key.name == name)?;
        (keys, found) = (key.keys(), Some(key));
    }
    found
}

/// The paths of other keys of a scene and of a patch that look like `given`, or end with it; elements of lists as
/// `[1]`.
pub fn similar_keys(given: &str) -> Vec<String> {
    let all = entries("", ROOT).into_iter().chain(patch_keys()).map(|key| key.path.replace("[]", "[1]"));
    let mut similar: Vec<String> = all.filter(|path| path != given && is_similar(given, path)).collect();
    similar.sort_unstable();
    similar.dedup();
    similar
}

/// Whether a few letters differ, or only the end of the path is given.
pub(super) fn is_similar(given: &str, name: &str) -> bool {
    let end_of_path = name.strip_suffix(given).is_some_and(|start| start.ends_with('.'));
    end_of_path || strsim::levenshtein(given, name) <= 1 + given.chars().count() / 8
}

/// A key of a file, for a list of all keys.
#[derive(Clone, Debug, PartialEq)]
pub struct KeyEntry {
    /// Its name with those of the tables around it; `[]` behind a table that may be repeated.
    pub path: String,
    /// What it may hold.
    pub allowed: String,
    /// The unit of a number.
    pub unit: Unit,
    /// What it means; empty of a table.
    pub meaning: &'static str,
    /// What its absence stands for.
    pub absent: Absent,
    /// The kinds of its table that have it; empty where all have.
    pub kinds: Vec<&'static str>,
    /// Whether it belongs to scenes with a material alone (`Some(true)`), or to those without (`Some(false)`).
    pub of_material: Option<bool>,
}

/// All keys of a scene; those of its surface are the layer's roughness's too. A retired key is left out.
pub fn scene_keys() -> Vec<KeyEntry> {
    let left_out = ["layer.roughness.", RETIRED];
    entries("", ROOT).into_iter().filter(|key| !left_out.iter().any(|path| key.path.starts_with(path))).collect()
}

/// All keys of a patch.
pub fn patch_keys() -> Vec<KeyEntry> {
    let mut keys = entries("", PATCH_ROOT);
    let faces = of_kinds("patch.", ShapeKind::WORDS, ShapeKind::keys);
    let at = keys.iter().position(|key| key.path == "patch.shape").map_or(keys.len(), |at| at + 1);
    keys.splice(at..at, faces.into_iter().filter(|key| key.path != "patch.shape"));
    keys
}

fn entries(start: &str, keys: &[Key]) -> Vec<KeyEntry> {
    let with_those_below = |key: &Key| {
        let path = format!("{start}{}", key.name);
        let of_material = key.form.map(|form| form == Form::Material);
        let own = KeyEntry {
            path: path.clone(),
            allowed: key.allowed.to_string(),
            unit: key.unit,
            meaning: key.meaning,
            absent: key.absent,
            kinds: Vec::new(),
            of_material,
        };
        let below = match key.allowed {
            Allowed::Table(keys) => entries(&format!("{path}."), keys),
            Allowed::Tables(keys, _) => entries(&format!("{path}[]."), keys),
            Allowed::Surface => of_kinds(&format!("{path}."), SurfaceKind::WORDS, SurfaceKind::keys),
            _ => Vec::new(),
        };
        std::iter::once(own).chain(below)
    };
    keys.iter().flat_map(with_those_below).collect()
}

/// The keys of a table of several kinds, each once.
fn of_kinds<K: Copy>(start: &str, kinds: &[(&'static str, K)], keys_of: impl Fn(K) -> &'static [Key]) -> Vec<KeyEntry> {
    let mut all: Vec<KeyEntry> = Vec::new();
    for &(name, kind) in kinds {
        for key in entries(start, keys_of(kind)) {
            match all.iter_mut().find(|known| known.path == key.path) {
                Some(known) => known.kinds.push(name),
                None => all.push(KeyEntry { kinds: vec![name], ..key }),
            }
        }
    }
    all.iter_mut().filter(|key| key.kinds.len() == kinds.len()).for_each(|key| key.kinds.clear());
    all
}

/// The range of the number at a path; positive numbers where there is none.
pub(super) fn range_of(path: &str) -> NumberRange {
    at(path).and_then(Key::range).unwrap_or(POSITIVE)
}

impl fmt::Display for Allowed {
    /// What a missing key, or one with another type of value, should hold.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(range) => range.fmt(f),
            Self::Whole(range) => range.fmt(f),
            Self::Flag => f.write_str("true or false"),
            Self::Numbers(range) => write!(f, "an array, each {range}"),
            Self::Text(expected) | Self::Tables(_, expected) => f.write_str(expected),
            Self::Word(words) => f.write_str(&words()),
            Self::Words(words) => write!(f, "an array, each {}", words()),
            Self::Table(_) | Self::Surface => f.write_str("a table"),
        }
    }
}
