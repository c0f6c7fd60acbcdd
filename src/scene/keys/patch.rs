//! The keys of a patch file.

use super::definition::{Allowed, Key, Kinds, PATH, ROLES, key, kinds, number, numbers, table, whole, word};
use super::scene_file::{DEPENDENCIES, INTEGERS, INTERVAL};
use crate::scene::patch_file::{MAX_ELEMENTS, PatchGroup, TableExtrapolation};
use crate::scene::values::{ANY, NOT_NEGATIVE, NumberRange, POSITIVE, Word, words};
use crate::scene::{Extrapolation, Unit};

pub(in crate::scene) const PATCH_ROOT: &[Key] = &[
    key("name", Allowed::Text("a text"), "Name of the patch").required(),
    table("table", TABLE).required(),
    key("patch", Allowed::Kinds(&[SHAPE], kinds::<ShapeKind>), "").required(),
    table("input", &[EXTRAPOLATION, INTERVAL]),
    table("solver", SOLVER),
    table("fmu", FMU),
];

const TABLE: &[Key] = &[
    key("path", Allowed::Text(PATH), "Table of a sweep, or of measured friction").required(),
    TABLE_COLUMNS,
    number("temperature", POSITIVE, Unit::Kelvin, "Temperature").follows("the middle one of the table's"),
    TABLE_EXTRAPOLATION.default("\"hold\""),
    number("nominal_area", POSITIVE, Unit::SquareMeter, "Area that one layer stands for"),
];

pub(super) const TABLE_COLUMNS: Key = key(
    "columns",
    Allowed::Text(ROLES),
    "Columns of a table of measured friction by what they hold, where their names do not say it",
);

/// A parameter of an element, too.
pub(in crate::scene) const TABLE_EXTRAPOLATION: Key = word::<TableExtrapolation>(
    "extrapolation",
    "What happens beyond the table's pressures and speeds: refuse, or hold its ends' friction coefficients and stiffnesses",
);

pub(super) const EXTRAPOLATION: Key =
    word::<Extrapolation>("extrapolation", "How the pose goes on when no rates are given: linear or hold")
        .default("\"linear\"");

/// What a face is like.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::scene) enum ShapeKind {
    Flat,
    Cylinder,
    Points,
}

impl Word for ShapeKind {
    const WORDS: &'static [(&'static str, Self)] =
        &[("flat", Self::Flat), ("cylinder", Self::Cylinder), ("points", Self::Points)];
}

impl Kinds for ShapeKind {
    fn keys(self) -> &'static [Key] {
        match self {
            Self::Flat => FLAT,
            Self::Cylinder => CYLINDER,
            Self::Points => POINTS,
        }
    }
}

const SHAPE: Key = word::<ShapeKind>("shape", "Shape of the face").required();
const LENGTH: Key = number("length", POSITIVE, Unit::Meter, "Length along x").required();
const WIDTH: Key = number("width", POSITIVE, Unit::Meter, "Width along y").required();
const NX: Key = whole("nx", 1, MAX_ELEMENTS, "Elements along x").required();
const NY: Key = whole("ny", 1, MAX_ELEMENTS, "Elements along y").required();
const TRANSPORT: Key = key("transport", Allowed::Flag, "Whether a tread runs through").default("false");
const OFFSET: Key = numbers("offset", ANY, Unit::Meter, "The face's origin in the body's axes").default("[0, 0, 0]");

const BACKING: Key = table(
    "backing",
    &[
        BACKING_NORMAL,
        BACKING_SHEAR,
        number("height", BLOCK, Unit::Meter, "Height of the block behind the contacts"),
        number("modulus", BLOCK, Unit::Pascal, "Young's modulus of the block behind the contacts"),
    ],
);
/// So that the stiffnesses of the block are positive numbers too.
const BLOCK: NumberRange = POSITIVE.down_to(1e-9).up_to(1e20);
pub(in crate::scene) const BACKING_NORMAL: Key =
    number("normal", POSITIVE, Unit::PascalPerMeter, "Stiffness per area of what is behind the contacts");
pub(in crate::scene) const BACKING_SHEAR: Key =
    number("shear", POSITIVE, Unit::PascalPerMeter, "Stiffness in shear per area of what is behind the contacts");

const HEAT: Key = table("heat", &[HEAT_CONDUCTIVITY, HEAT_CAPACITY, HEAT_DENSITY, HEAT_SHARE]);
pub(in crate::scene) const HEAT_CONDUCTIVITY: Key =
    number("conductivity", CONDUCTION, Unit::WattPerMeterKelvin, "Heat conductivity behind the surface").required();
pub(in crate::scene) const HEAT_CAPACITY: Key =
    number("capacity", CONDUCTION, Unit::JoulePerKilogramKelvin, "Specific heat capacity behind the surface")
        .required();
pub(in crate::scene) const HEAT_DENSITY: Key =
    number("density", CONDUCTION, Unit::KilogramPerCubicMeter, "Density behind the surface").required();
pub(in crate::scene) const HEAT_SHARE: Key =
    number("share", POSITIVE.up_to(1.0), Unit::One, "Part of what slip loses that heats the elements").required();
/// So that their products and quotients are positive numbers too.
const CONDUCTION: NumberRange = POSITIVE.down_to(1e-9).up_to(1e20);

/// A parameter of an element, too. Rubber's loss factor is below 2, and bodies on it swing at 1 Hz and more.
const DAMPING: Key = number(
    "damping",
    NOT_NEGATIVE.up_to(1.0),
    Unit::Second,
    "Loss of the springs along the plane and of the backing: their force is that of a spring and τ times its rate",
)
.default("0");

const FLAT: &[Key] = &[SHAPE, LENGTH, WIDTH, NX, NY, TRANSPORT, OFFSET, BACKING, DAMPING, HEAT];
const CYLINDER: &[Key] = &[
    SHAPE,
    number("radius", POSITIVE, Unit::Meter, "Radius").required(),
    LENGTH,
    WIDTH,
    NX,
    NY,
    TRANSPORT,
    OFFSET,
    BACKING,
    DAMPING,
    HEAT,
];
const POINTS: &[Key] = &[
    SHAPE,
    key("path", Allowed::Text(PATH), "File of the points").required(),
    key("columns", Allowed::Text(ROLES), "Columns by what they hold, where their names do not say it"),
    OFFSET,
    BACKING,
    DAMPING,
    HEAT,
];

pub(in crate::scene) const REFINE: Key =
    whole("refine", 1, 1000, "How many times finer a step is cut than it needs to be").default("1");

const SOLVER: &[Key] = &[REFINE];

const FMU: &[Key] = &[
    key("outputs", Allowed::Words(words::<PatchGroup>), "Groups of output variables")
        .default("[\"forces\", \"dissipation\"]"),
    INTEGERS,
    DEPENDENCIES,
];
