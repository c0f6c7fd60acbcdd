//! The keys of a scene file.

use super::definition::{Allowed, Key, PATH, TABLE_FILE, key, number, table, whole, word};
use super::field::{At, FieldValue, field};
use super::surface::SURFACE;
use crate::scene::values::{ANY, LOOSEST_TOLERANCE, NOT_NEGATIVE, POSITIVE, words};
use crate::scene::{
    Axis, CarrierInitial, DependencyList, Extrapolation, FoundationKind, Initial, IntegerType, Kinematics, LinkKind,
    Method, OutputGroup, Scene, Unit,
};

pub(in crate::scene) const ROOT: &[Key] = &[
    key("name", Allowed::Text("a text"), "Name of the scene").required(),
    key(
        "description",
        Allowed::Text("a text without control characters but line breaks and tabs"),
        "What the scene is",
    ),
    table("layer", LAYER).required(),
    table("material", MATERIAL),
    key("surface", SURFACE, "Rigid surface below the layer").required(),
    table("carrier", CARRIER),
    table("friction", FRICTION),
    table("solver", SOLVER),
    table("input", INPUT),
    table("fmu", FMU),
    key("excitation", Allowed::Tables(PHASE, TABLES), "Motion of the carrier in runs without a master"),
    table("uncertainty", UNCERTAINTY),
];

const TABLES: &str = "an array of tables";

const LAYER: &[Key] = &[
    whole("masses", 1, 10_000_000, "Number of point masses").required().reads(field!(|scene, _| scene.layer.masses)),
    number("spacing", POSITIVE, Unit::Meter, "Distance of the masses at rest")
        .required()
        .reads(field!(|scene, _| scene.layer.spacing)),
    number("origin", ANY, Unit::Meter, "Position of the first mass at rest")
        .default("0")
        .reads(field!(|scene, _| scene.layer.origin)),
    number("clearance", ANY, Unit::Meter, "Rest height of the layer above the profile's datum at w = 0")
        .default("0")
        .parameter(field!(|scene, _| scene.layer.clearance))
        .ahead(),
    word::<Initial>("initial", "How the dashpots start: relaxed or undeformed")
        .default("\"relaxed\"")
        .parameter(field!(|scene, _| scene.layer.initial)),
    key("roughness", SURFACE, "Roughness of the layer"),
    number("mass", POSITIVE, Unit::Kilogram, "Mass of one point mass")
        .required()
        .direct()
        .parameter(field!(|scene, _| scene.layer.mass))
        .ahead(),
    table("vertical", LINK).direct().place(At::link(LinkKind::Vertical)),
    table("horizontal", LINK).direct().place(At::link(LinkKind::Horizontal)),
    table("lateral_x", LINK).direct().place(At::link(LinkKind::LateralX)),
    table("lateral_z", LINK).direct().place(At::link(LinkKind::LateralZ)),
    number("thickness", POSITIVE, Unit::Meter, "Thickness of the layer")
        .follows("required but of a half-space")
        .material()
        .parameter(field!(|scene, _| scene.layer.thickness).then(Scene::refit)),
    number("width", POSITIVE, Unit::Meter, "Width of the layer")
        .required()
        .material()
        .reads(field!(|scene, _| scene.layer.width)),
    word::<FoundationKind>("foundation", "What the links stand for: springs, half_space or layer")
        .default("\"layer\"")
        .material(),
    word::<Kinematics>(
        "kinematics",
        "By what spacing the links along z are measured: material, that at rest, or spatial",
    )
    .follows("spatial with foundation = \"half_space\", else material"),
];

const LINK: &[Key] = &[
    number("stiffness", NOT_NEGATIVE, Unit::NewtonPerMeter, "Stiffness")
        .default("0")
        .parameter(field!(|scene, at| scene.layer.links[at.link]?.stiffness))
        .of(of_link),
    number("damping", NOT_NEGATIVE, Unit::NewtonSecondPerMeter, "Damping")
        .default("0")
        .parameter(field!(|scene, at| scene.layer.links[at.link]?.damping))
        .of(of_link),
    key("maxwell", Allowed::Tables(MAXWELL, TABLES), "Maxwell elements"),
];

fn of_link(at: At) -> String {
    format!(" of the {}", at.link.description())
}

const MAXWELL: &[Key] = &[
    number("stiffness", NOT_NEGATIVE, Unit::NewtonPerMeter, "Stiffness")
        .required()
        .parameter(field!(|scene, at| scene.layer.links[at.link]?.maxwell[at.index]?.stiffness))
        .of(of_element),
    number("relaxation_time", POSITIVE, Unit::Second, "Relaxation time")
        .required()
        .parameter(field!(|scene, at| scene.layer.links[at.link]?.maxwell[at.index]?.relaxation_time))
        .of(of_element),
];

fn of_element(at: At) -> String {
    format!(" of Maxwell element {} of the {}", at.index + 1, at.link.description())
}

const MATERIAL: &[Key] = &[
    number("density", POSITIVE, Unit::KilogramPerCubicMeter, "Density of the layer's material")
        .required()
        .parameter(field!(|scene, _| scene.material?.density)),
    number("poisson_ratio", NOT_NEGATIVE.up_to(0.5), Unit::One, "Poisson's ratio of the layer's material")
        .required()
        .parameter(field!(|scene, _| scene.material?.poisson_ratio).then(Scene::refit)),
    number("equilibrium_modulus", NOT_NEGATIVE, Unit::Pascal, "Modulus of the layer's material after all relaxation")
        .required()
        .parameter(field!(|scene, _| scene.material?.equilibrium_modulus)),
    number(
        "viscosity",
        NOT_NEGATIVE,
        Unit::PascalSecond,
        "Kelvin-Voigt viscosity of the layer's material at the reference temperature",
    )
    .default("0")
    .parameter(field!(|scene, _| scene.material?.viscosity)),
    key(
        "prony",
        Allowed::Tables(
            PRONY_TERM,
            "an array of tables, or the path of a file beside the scene with relaxation_time and modulus; or { path, columns }",
        ),
        "Prony series",
    )
    .required(),
    table("wlf", WLF),
    table("heat", HEAT),
];

const PRONY_TERM: &[Key] = &[
    number("modulus", NOT_NEGATIVE, Unit::Pascal, "Modulus")
        .required()
        .parameter(field!(|scene, at| scene.material?.prony[at.index]?.modulus))
        .of(of_term),
    number("relaxation_time", POSITIVE, Unit::Second, "Relaxation time")
        .required()
        .parameter(field!(|scene, at| scene.material?.prony[at.index]?.relaxation_time))
        .of(|at| format!("{} at the reference temperature", of_term(at))),
];

fn of_term(at: At) -> String {
    format!(" of term {} of the Prony series", at.index + 1)
}

const HEAT: &[Key] = &[
    number("conductivity", POSITIVE, Unit::WattPerMeterKelvin, "Heat conductivity of the layer's material")
        .required()
        .parameter(field!(|scene, _| scene.material?.heat?.conductivity)),
    number("capacity", POSITIVE, Unit::JoulePerKilogramKelvin, "Specific heat capacity of the layer's material")
        .required()
        .parameter(field!(|scene, _| scene.material?.heat?.capacity)),
    number("share", POSITIVE.up_to(1.0), Unit::One, "Part of the friction power that the layer takes")
        .default("1")
        .parameter(field!(|scene, _| scene.material?.heat?.share)),
];

const WLF: &[Key] = &[
    number("c1", NOT_NEGATIVE, Unit::One, "C_1 of Williams, Landel and Ferry")
        .required()
        .parameter(field!(|scene, _| scene.material?.wlf?.c1)),
    number("c2", POSITIVE, Unit::Kelvin, "C_2 of Williams, Landel and Ferry")
        .required()
        .parameter(field!(|scene, _| scene.material?.wlf?.c2)),
    number("reference_temperature", POSITIVE, Unit::Kelvin, "Temperature at which the material's times are given")
        .required()
        .parameter(field!(|scene, _| scene.material?.wlf?.reference_temperature)),
    number("temperature", POSITIVE, Unit::Kelvin, "Temperature of the layer")
        .required()
        .parameter(field!(|scene, _| scene.material?.wlf?.temperature)),
];

const FRICTION: &[Key] = &[
    number("coulomb", NOT_NEGATIVE, Unit::One, "Coulomb's friction coefficient")
        .default("0")
        .parameter(field!(|scene, _| scene.friction?.coulomb))
        .ahead(),
    number(
        "memory",
        NOT_NEGATIVE,
        Unit::Meter,
        "Way of slip over which contacts are renewed, so that friction follows the speed; 0: at once",
    )
    .follows("50e-6 of a material, or 1.2 times what even sliding takes if that is more; 0 in the direct form")
    .parameter(field!(|scene, _| scene.friction?.memory).counting_as(|scene, _| {
        let friction = scene.friction.as_ref().filter(|_| scene.friction_depends_on_speed());
        friction.and_then(|_| scene.memory_way().value())
    })),
    table("rate_shear", RATE_SHEAR),
    number("shear_force", NOT_NEGATIVE, Unit::Newton, "Adhesive shear force of one mass in contact")
        .default("0")
        .direct()
        .parameter(field!(|scene, _| scene.friction?.shear_force))
        .ahead(),
    number("shear_strength", NOT_NEGATIVE, Unit::Pascal, "Adhesive shear strength of the contact")
        .default("0")
        .material()
        .parameter(field!(|scene, _| scene.friction?.shear_strength))
        .ahead(),
];

const CARRIER: &[Key] =
    &[table("x", CARRIER_X).place(At::axis(Axis::X)), table("z", CARRIER_Z).place(At::axis(Axis::Z))];

const CARRIER_MASS: Key = number("mass", POSITIVE, Unit::Kilogram, "Mass of the carrier")
    .required()
    .parameter(field!(|scene, at| scene.carrier[at.axis]?.mass))
    .of(along);
const CARRIER_STIFFNESS: Key =
    number("stiffness", NOT_NEGATIVE, Unit::NewtonPerMeter, "Stiffness of the spring from the carrier to its drive")
        .default("0")
        .parameter(field!(|scene, at| scene.carrier[at.axis]?.stiffness))
        .of(along);
const CARRIER_DAMPING: Key =
    number("damping", NOT_NEGATIVE, Unit::NewtonSecondPerMeter, "Damping of the damper from the carrier to its drive")
        .default("0")
        .parameter(field!(|scene, at| scene.carrier[at.axis]?.damping))
        .of(along);
const CARRIER_START: Key = number("start", ANY, Unit::Meter, "Displacement of the carrier at the start")
    .follows("that of its drive")
    .parameter(field!(|scene, at| scene.carrier[at.axis]?.start))
    .of(along);
const CARRIER_START_RATE: Key = number("start_rate", ANY, Unit::MeterPerSecond, "Speed of the carrier at the start")
    .default("0")
    .parameter(field!(|scene, at| scene.carrier[at.axis]?.start_rate))
    .of(along);

fn along(at: At) -> String {
    format!(", along {}", at.axis.name())
}

const CARRIER_X: &[Key] = &[
    CARRIER_MASS,
    CARRIER_STIFFNESS,
    CARRIER_DAMPING,
    number("pull", ANY, Unit::Newton, "Constant part of the tangential force on the carrier")
        .default("0")
        .parameter(field!(|scene, _| scene.carrier.x?.pull)),
    CARRIER_START,
    CARRIER_START_RATE,
];

const CARRIER_Z: &[Key] = &[
    CARRIER_MASS,
    CARRIER_STIFFNESS,
    CARRIER_DAMPING,
    number("load", ANY, Unit::Newton, "Constant part of the normal load on the carrier")
        .default("0")
        .parameter(field!(|scene, _| scene.carrier.z?.load)),
    CARRIER_START,
    CARRIER_START_RATE,
    word::<CarrierInitial>(
        "initial",
        "Where the carrier starts along z: start, or equilibrium, where the springs bear the load",
    )
    .default("\"start\"")
    .parameter(field!(|scene, _| scene.carrier.z?.initial)),
];

const RATE_SHEAR: &[Key] = &[
    number(
        "reference_speed",
        POSITIVE,
        Unit::MeterPerSecond,
        "Speed at which the rate-dependent shear force is largest",
    )
    .required()
    .parameter(field!(|scene, _| scene.friction?.rate_shear?.reference_speed)),
    number(
        "sharpness",
        NOT_NEGATIVE,
        Unit::One,
        "Coefficient c in exp(-c log10(v/v0)^2), the fall of the rate-dependent shear force about its maximum",
    )
    .required()
    .parameter(field!(|scene, _| scene.friction?.rate_shear?.sharpness)),
    number(
        "creep_speed",
        POSITIVE,
        Unit::MeterPerSecond,
        "Speed below which the rate-dependent shear force is constant; follows the reference speed until it is set itself",
    )
    .follows("1e-6 of `reference_speed`")
    .parameter(
        field!(|scene, _| scene.friction?.rate_shear?.creep_speed)
            .counting_as(|scene, _| scene.friction.as_ref()?.rate_shear?.creep_speed().value()),
    ),
    number("force", NOT_NEGATIVE, Unit::Newton, "Largest rate-dependent shear force of one mass in contact")
        .required()
        .direct()
        .parameter(field!(|scene, _| scene.friction?.rate_shear?.force))
        .ahead(),
    number("strength", NOT_NEGATIVE, Unit::Pascal, "Largest rate-dependent shear strength of the contact")
        .required()
        .material()
        .parameter(field!(|scene, _| scene.friction?.rate_shear?.strength))
        .ahead(),
];

const SOLVER: &[Key] = &[
    word::<Method>(
        "method",
        "event: locate each mode change; step: correct touches and lifts at the end of each step; auto: switch between \
         the two",
    )
    .default("\"event\"")
    .parameter(field!(|scene, _| scene.solver.method)),
    number("relative_tolerance", POSITIVE.up_to(LOOSEST_TOLERANCE), Unit::One, "Relative tolerance of the local error")
        .default("1e-6")
        .parameter(field!(|scene, _| scene.solver.relative_tolerance)),
    number(
        "absolute_tolerance",
        POSITIVE,
        Unit::Meter,
        "Absolute tolerance of positions; follows the relative one until it is set itself",
    )
    .follows("`relative_tolerance` times the scene's height")
    .parameter(
        field!(|scene, _| scene.solver.absolute_tolerance).counting_as(|scene, _| scene.absolute_tolerance().value()),
    ),
    // An Integer of FMI has 32 bits.
    whole("max_steps", 1, i32::MAX as i64, "Steps that one communication step or one phase may take")
        .follows("10000000; in an FMU 500000 over the masses and ten more, steps of fewer masses counting less")
        .parameter(field!(|scene, _| scene.solver.max_steps).counting_as(|scene, _| scene.solver.max_steps().value())),
    number("reduce", NOT_NEGATIVE.up_to(0.1), Unit::One, "Error bound for leaving Maxwell elements out")
        .default("0")
        .reads(field!(|scene, _| scene.solver.reduce)),
];

const INPUT: &[Key] = &[
    word::<Extrapolation>("extrapolation", "How the carrier moves when no rates are given: linear or hold")
        .default("\"linear\"")
        .parameter(field!(|scene, _| scene.input_rule.extrapolation)),
    INTERVAL.parameter(field!(|scene, _| scene.input_rule.interval)),
    key("temperature", Allowed::Flag, "Whether the layer's temperature is an input").default("false").material(),
];

/// A parameter of elements and patches, too.
pub(super) const INTERVAL: Key = number(
    "interval",
    NOT_NEGATIVE,
    Unit::Second,
    "Time between new values of inputs without rates, over which each is gone to, late by it; 0: in every step",
)
.default("0");

/// Beside them any number of the scene by its path: they are read by what draws samples.
const UNCERTAINTY: &[Key] =
    &[key("covariance", Allowed::Text(PATH), "File of numbers that were fitted together, as calibrate writes it")];

const FMU: &[Key] = &[
    key("outputs", Allowed::Words(words::<OutputGroup>), "Groups of output variables")
        .default("[\"forces\", \"dissipation\"]"),
    INTEGERS,
    DEPENDENCIES,
];

pub(super) const INTEGERS: Key =
    word::<IntegerType>("integers", "Type of the outputs that are whole numbers").default("\"integer\"");
pub(super) const DEPENDENCIES: Key =
    word::<DependencyList>("dependencies", "Dependencies of outputs on inputs that are listed").default("\"direct\"");

const PHASE: &[Key] = &[
    key(
        "file",
        Allowed::Text(TABLE_FILE),
        "File of the motion, with columns time, u and w, of which one that rests may be missing, in place of others",
    ),
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
