//! The keys of a surface and of the roughness below its profile.

use super::definition::{Allowed, Key, Kinds, PATH, TABLE_FILE, key, kinds, number, numbers, table, whole, word};
use super::field::{Field, FieldValue, field};
use crate::scene::fine_roughness::Convention;
use crate::scene::values::{ANY, NOT_NEGATIVE, POSITIVE, Word};
use crate::scene::{Depth, FineRoughness, FineWaves, LengthUnit, Missing, Softening, ThirdColumn, Tilt, Unit};

/// Where the heights of a surface come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::scene) enum SurfaceKind {
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

impl Kinds for SurfaceKind {
    fn keys(self) -> &'static [Key] {
        match self {
            Self::Flat => FLAT,
            Self::Sinusoid => SINUSOID,
            Self::SelfAffine => SELF_AFFINE,
            Self::Points => POINTS,
            Self::File => FILE,
        }
    }
}

pub(super) const SURFACE: Allowed = Allowed::Kinds(FLAT, kinds::<SurfaceKind>);

const KIND: Key = word::<SurfaceKind>("kind", "Where the heights come from").required();

const FINE: Key = table("fine", FINE_ROUGHNESS).material();

/// The field of a number that waves of some kinds have.
macro_rules! wave_field {
    ($name:ident of $($kind:ident),+) => {
        Field::new(
            |scene, _| match &scene.fine.as_ref()?.waves {
                $(FineWaves::$kind { $name, .. })|+ => $name.value(),
                _ => None,
            },
            |scene, _, value| match &mut scene.fine.as_mut()?.waves {
                $(FineWaves::$kind { $name, .. })|+ => $name.set(value),
                _ => None,
            },
        )
    };
}

const SOFTENING: Field = Field::new(
    |scene, _| match scene.fine.as_ref()? {
        FineRoughness { waves: FineWaves::Modulus { .. }, .. } => None,
        FineRoughness { softening: Softening::Factor(factor), .. } => factor.value(),
        FineRoughness { softening: Softening::Table(_), .. } => None,
    },
    |scene, _, value| match &mut scene.fine.as_mut()?.softening {
        Softening::Factor(factor) => factor.set(value),
        Softening::Table(_) => None,
    },
);

const FINE_ROUGHNESS: &[Key] = &[
    number("hurst", POSITIVE.up_to(1.0), Unit::One, "Hurst exponent of the roughness that the profile lacks")
        .parameter(wave_field!(hurst of SelfAffine)),
    number("rms_slope", NOT_NEGATIVE, Unit::One, "Root mean square gradient of the roughness that the profile lacks")
        .parameter(wave_field!(rms_slope of SelfAffine, Modulus)),
    number("longest", POSITIVE, Unit::Meter, "Longest wavelength of the roughness that the profile lacks")
        .parameter(wave_field!(longest of SelfAffine, Table)),
    number("shortest", POSITIVE, Unit::Meter, "Shortest wavelength of the roughness that the profile lacks")
        .parameter(wave_field!(shortest of SelfAffine, Table, Split, Continued)),
    key("spectrum", Allowed::Text(TABLE_FILE), "File of the spectrum of the roughness that the profile lacks"),
    word::<Convention>("convention", "How that spectrum is normalised").default("\"persson\""),
    number(
        "split",
        POSITIVE,
        Unit::Meter,
        "Wavelength at which the measured line is split into profile and fine roughness",
    ),
    number("modulus", POSITIVE, Unit::Pascal, "Plane modulus at which that roughness is pressed flat, at every speed")
        .parameter(wave_field!(modulus of Modulus)),
    number("creep_speed", POSITIVE, Unit::MeterPerSecond, "Speed below which that roughness rubs as at this one")
        .follows("that of `friction.rate_shear`, else 1e-6")
        .parameter(
            field!(|scene, _| scene.fine?.creep_speed).counting_as(|scene, _| scene.own_fine_creep_speed()?.value()),
        ),
    key("hysteresis", Allowed::Flag, "Whether that roughness rubs by hysteresis").default("true"),
    number("softening", POSITIVE.up_to(1.0), Unit::One, "Factor on the moduli in that roughness")
        .default("1")
        .parameter(SOFTENING),
];

/// The keys that a surface of every kind has.
const FLAT: &[Key] = &[KIND, FINE];

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
    number("rms", POSITIVE, Unit::Meter, "Root mean square height of the points").follows("required without `rq`"),
    number("rq", POSITIVE, Unit::Meter, "The same, by its name on drawings").follows("required without `rms`"),
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
    word::<Depth>("depth", "Whether heights of the file grow up or down").follows("the name of their column, else up"),
    word::<ThirdColumn>("third_column", "What a third column means"),
    key("columns", Allowed::Text(COLUMNS), "Columns of x and z, by their names or numbers"),
    numbers("spacing", POSITIVE, Unit::Meter, "Distance of points of a file without x"),
    LINE,
];

/// What `columns` holds.
const COLUMNS: &str = "{ x = \"…\", z = \"…\" }, the names or the numbers of columns as texts; or [\"x\", \"z\"], or [\"z\"] beside spacing";
