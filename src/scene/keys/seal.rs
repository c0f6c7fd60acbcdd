//! The keys of a seal file.

use super::definition::{Allowed, Key, PATH, ROLES, key, number, table, whole, word};
use super::patch::{EXTRAPOLATION, TABLE_COLUMNS, TABLE_EXTRAPOLATION};
use super::scene_file::{DEPENDENCIES, INTEGERS, INTERVAL};
use crate::scene::Unit;
use crate::scene::seal_file::{Air, RoughSide, SealGroup};
use crate::scene::values::{POSITIVE, words};

pub(in crate::scene) const SEAL_ROOT: &[Key] = &[
    key("name", Allowed::Text("a text"), "Name of the seal").required(),
    table("table", TABLE).required(),
    table("seal", SEAL).required(),
    table("fluid", FLUID).required(),
    table("input", &[EXTRAPOLATION, INTERVAL]),
    table("solver", &[TOLERANCE]),
    table("fmu", FMU),
];

const TABLE: &[Key] = &[
    key("path", Allowed::Text(PATH), "Table of a sweep with gaps, or of measured friction").required(),
    TABLE_COLUMNS,
    number("temperature", POSITIVE, Unit::Kelvin, "Temperature").follows("the middle one of the table's"),
    TABLE_EXTRAPOLATION.default("\"hold\""),
];

const SEAL: &[Key] = &[
    key("pressure", Allowed::Text(PATH), "File of the total pressure over the width of the lip").required(),
    key("columns", Allowed::Text(ROLES), "Columns by what they hold, where their names do not say it"),
    number("length", POSITIVE, Unit::Meter, "Length along the lip").required(),
    word::<RoughSide>("rough", "The side that is the table's rough surface: moving, the rod, or standing, the lip")
        .required(),
    number("stiffness", POSITIVE, Unit::NewtonPerMeter, "Stiffness of the lip along the motion"),
    number("approach_stiffness", POSITIVE, Unit::PascalPerMeter, "How much the pressure falls as the lip is lifted"),
    whole("cells", 8, 4096, "Cells over the width").default("64"),
];

const FLUID: &[Key] = &[
    key("viscosity", Allowed::Text(VISCOSITY), "Viscosity").required(),
    word::<Air>("air", "What comes back on the rod: returns, the film that left, dry, or flooded")
        .default("\"returns\""),
    number("supply", POSITIVE, Unit::Meter, "The gap to which the sealed side is flooded").default("1e-4"),
    number("start", POSITIVE, Unit::Meter, "Content at the start").follows("what is there after a long rest"),
];

/// What a viscosity may be.
pub(in crate::scene) const VISCOSITY: &str =
    "a number > 0 in Pa s, or two or three at their temperatures, such as { \"20 °C\" = 0.12, \"40 °C\" = 0.046 }";

const TOLERANCE: Key =
    number("relative_tolerance", POSITIVE.up_to(0.1), Unit::One, "Admissible error of a step, over the film")
        .default("1e-3");

const FMU: &[Key] = &[
    key("outputs", Allowed::Words(words::<SealGroup>), "Groups of output variables")
        .default("[\"forces\", \"dissipation\", \"film\"]"),
    INTEGERS,
    DEPENDENCIES,
];
