//! A patch file as data: which table, which elements on which face, which outputs.

use std::path::PathBuf;
use std::sync::Arc;

use super::error::{Problem, SceneError};
use super::values::Word;
use super::{FileValues, FmuOptions, InputRule};
use crate::tables::ReadingNote;

/// The most elements of a patch.
pub(super) const MAX_ELEMENTS: i64 = 1_000_000;

/// The content of a patch file, and of the file of points that it names.
#[derive(Clone, Debug, PartialEq)]
pub struct PatchFile {
    /// Name of the patch.
    pub name: String,
    /// Path of the table, relative to the folder of the patch file.
    pub table: PathBuf,
    /// Columns of a table of measured friction whose names do not say what they are.
    pub table_columns: Vec<(String, String)>,
    /// Temperature at the start, K.
    pub temperature: Option<f64>,
    /// What elements do where the table ends.
    pub table_extrapolation: TableExtrapolation,
    /// The area that a layer of the table stands for, m², where the table is one of forces.
    pub nominal_area: Option<f64>,
    /// The face.
    pub shape: FaceShape,
    /// Whether a tread runs through.
    pub transport: bool,
    /// The face's origin in the body's axes, m.
    pub offset: [f64; 3],
    /// What stands behind every element, if that gives way.
    pub backing: Option<Backing>,
    /// τ of the dampers beside the springs along the plane and beside the backing, s.
    pub damping: f64,
    /// How slip heats every element, if it does.
    pub heat: Option<FaceHeat>,
    /// How the body moves when a master gives no rates.
    pub input_rule: InputRule,
    /// How many times finer a step is cut than it needs to be.
    pub refine: u32,
    /// Groups of outputs, in the order of the variables.
    pub outputs: Vec<PatchGroup>,
    /// What its FMU's description says for simple importers.
    pub fmu: FmuOptions,
    /// How the files were read.
    pub notes: Vec<ReadingNote>,
    /// The values that it was read from.
    pub values: Arc<FileValues>,
}

/// The elements of a face.
#[derive(Clone, Debug, PartialEq)]
pub enum FaceShape {
    /// A grid in the plane z = 0 of the face.
    Flat(Grid),
    /// A grid on a cylinder about the y axis.
    Cylinder {
        /// Radius of the cylinder, m.
        radius: f64,
        /// Along the arc and the axis.
        grid: Grid,
    },
    /// Single elements.
    Points {
        /// The file, relative to the folder of the patch file.
        path: PathBuf,
        /// x, y, z (m) and area (m²) of each.
        points: Vec<[f64; 4]>,
    },
}

/// What stands behind the elements of a patch and gives way in series with their contacts, such as the height of a
/// tread block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Backing {
    /// Stiffness along the normal per area, Pa/m.
    pub normal: f64,
    /// Stiffness in shear per area, Pa/m.
    pub shear: f64,
}

impl Backing {
    /// A block of rubber of a height (m) and a modulus (Pa), its sides free: E/H, and G/H with G = E/3.
    pub fn block(height: f64, modulus: f64) -> Self {
        Self { normal: modulus / height, shear: modulus / (3.0 * height) }
    }
}

/// What the heat of slip meets behind the surface of a face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FaceHeat {
    /// Heat conductivity, W/(m K).
    pub conductivity: f64,
    /// Specific heat capacity, J/(kg K).
    pub capacity: f64,
    /// Density, kg/m³.
    pub density: f64,
    /// The part of what slip loses that heats the elements, 1; the ground takes the rest.
    pub share: f64,
}

/// A grid of elements about the middle of a face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// Along x, m.
    pub length: f64,
    /// Along y, m.
    pub width: f64,
    /// Elements along x.
    pub nx: usize,
    /// Elements along y.
    pub ny: usize,
}

/// What elements do beyond the pressures and speeds of their table.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TableExtrapolation {
    /// They go on: the pressure along its tangent, all else as at the table's end.
    #[default]
    Hold,
    /// The step is refused.
    Refuse,
}

impl Word for TableExtrapolation {
    const WORDS: &'static [(&'static str, Self)] = &[("refuse", Self::Refuse), ("hold", Self::Hold)];
}

impl TableExtrapolation {
    /// The word for it in a patch file.
    pub fn word(self) -> &'static str {
        self.as_word()
    }
}

/// The groups of variables that a patch may be asked for, in the order of the variables.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum PatchGroup {
    /// The wrench, and the force on the tread.
    Forces,
    /// Dissipated power and energy.
    Dissipation,
    /// Counts, areas, pressure.
    Contact,
    /// The friction coefficient of the wrench.
    Friction,
    /// The energy stored.
    Energy,
    /// Change of the wrench with the targets of the pose.
    Tangent,
    /// Pressure, traction and mode of each element.
    Elements,
}

impl Word for PatchGroup {
    const WORDS: &'static [(&'static str, Self)] = &[
        ("forces", Self::Forces),
        ("dissipation", Self::Dissipation),
        ("contact", Self::Contact),
        ("friction", Self::Friction),
        ("energy", Self::Energy),
        ("tangent", Self::Tangent),
        ("elements", Self::Elements),
    ];
}

impl PatchGroup {
    /// The group's name in a patch file.
    pub fn word(self) -> &'static str {
        self.as_word()
    }
}

/// Why the elements of a face cannot be doubled along and across it.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NotDoubled {
    /// They are no grid.
    #[error("the face is a list of points, whose number cannot be doubled here")]
    Points,
    /// There would be too many.
    #[error("{nx} by {ny} would be more than {MAX_ELEMENTS} elements")]
    TooMany {
        /// Elements along x that it would have.
        nx: usize,
        /// Elements along y.
        ny: usize,
    },
}

impl PatchFile {
    /// The same face with twice as many elements along x and along y.
    ///
    /// # Errors
    /// [`NotDoubled`] where the face is no grid or there would be too many elements.
    pub fn doubled(&self) -> Result<Self, NotDoubled> {
        let double = |grid: &Grid| {
            let (nx, ny) = (2 * grid.nx, 2 * grid.ny);
            let allowed = i64::try_from(nx * ny).is_ok_and(|count| count <= MAX_ELEMENTS);
            if allowed { Ok(Grid { nx, ny, ..*grid }) } else { Err(NotDoubled::TooMany { nx, ny }) }
        };
        let shape = match &self.shape {
            FaceShape::Flat(grid) => FaceShape::Flat(double(grid)?),
            FaceShape::Cylinder { radius, grid } => FaceShape::Cylinder { radius: *radius, grid: double(grid)? },
            FaceShape::Points { .. } => return Err(NotDoubled::Points),
        };
        Ok(Self { shape, ..self.clone() })
    }

    /// The error of a key that only the table can judge.
    fn refuse(&self, key: &str, problem: Problem) -> SceneError {
        SceneError::new(self.values.location(key), key, problem)
    }

    /// The error of a temperature that the table does not reach.
    pub fn refuse_temperature(&self, expected: String) -> SceneError {
        let given = self.temperature.map_or_else(String::new, |kelvin| format!("{kelvin:?}"));
        self.refuse("table.temperature", Problem::Value { given, expected })
    }

    /// The error of heat with a table that does not have several temperatures.
    pub fn refuse_heat(&self, found: usize) -> SceneError {
        let given = if found == 0 { "a table without temperatures".to_owned() } else { format!("a table of {found}") };
        let expected = "a table of two temperatures or more: friction follows what slip heats".to_owned();
        self.refuse("patch.heat", Problem::Value { given, expected })
    }

    /// The error of a nominal area that is given with a table of pressures, or is missing with one of forces.
    pub fn refuse_nominal_area(&self, expected: &str) -> SceneError {
        let problem = match self.nominal_area {
            Some(area) => Problem::value(format_args!("{area:?}"), expected),
            None => Problem::Missing { expected: expected.to_owned() },
        };
        self.refuse("table.nominal_area", problem)
    }

    /// Paths of the files that it reads, relative to its folder.
    pub fn files(&self) -> Vec<PathBuf> {
        let points = if let FaceShape::Points { path, .. } = &self.shape { Some(path.clone()) } else { None };
        std::iter::once(self.table.clone()).chain(points.filter(|path| *path != self.table)).collect()
    }
}
