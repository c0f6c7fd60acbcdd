//! A seal file as data: a lip with a film, the table of its contact, the fluid.

use std::path::PathBuf;
use std::sync::Arc;

use super::error::{Problem, SceneError};
use super::patch_file::TableExtrapolation;
use super::values::Word;
use super::{FileValues, FmuOptions, InputRule};
use crate::tables::ReadingNote;

/// The content of a seal file, and of the file of pressures that it names.
#[derive(Clone, Debug, PartialEq)]
pub struct SealFile {
    /// Name of the seal.
    pub name: String,
    /// Path of the table of the contact, relative to the folder of the seal file.
    pub table: PathBuf,
    /// Columns of a table of measured friction whose names do not say what they are.
    pub table_columns: Vec<(String, String)>,
    /// Temperature at the start, K.
    pub temperature: Option<f64>,
    /// What happens where the table, or the sets of pressures, end.
    pub table_extrapolation: TableExtrapolation,
    /// Path of the pressures, likewise.
    pub pressure: PathBuf,
    /// The total pressure on the lip.
    pub sets: Vec<LipSet>,
    /// Length along the lip, m.
    pub length: f64,
    /// The side that is the table's rough surface.
    pub rough: RoughSide,
    /// Stiffness of the lip along the motion, N/m; `None` of a rigid one.
    pub stiffness: Option<f64>,
    /// How much the pressure falls as the lip is lifted, Pa/m; without it there is no input w.
    pub approach_stiffness: Option<f64>,
    /// Cells over the width.
    pub cells: usize,
    /// The fluid's viscosity.
    pub viscosity: Viscosity,
    /// What comes back from the air.
    pub air: Air,
    /// The gap to which the sealed side is flooded, m.
    pub supply: f64,
    /// The content at the start, m; `None`: what is there after a long rest.
    pub start: Option<f64>,
    /// How inputs go on when a master gives no rates.
    pub input_rule: InputRule,
    /// Admissible error of a step, over the contents.
    pub relative_tolerance: f64,
    /// Groups of outputs, in the order of the variables.
    pub outputs: Vec<SealGroup>,
    /// What its FMU's description says for simple importers.
    pub fmu: FmuOptions,
    /// How the files were read.
    pub notes: Vec<ReadingNote>,
    /// The values that it was read from.
    pub values: Arc<FileValues>,
}

/// The total pressure over the width of a lip at a sealed pressure.
#[derive(Clone, Debug, PartialEq)]
pub struct LipSet {
    /// The sealed pressure, Pa.
    pub sealed: f64,
    /// Places from the sealed side, m, from 0, rising.
    pub x: Vec<f64>,
    /// The total pressure there, Pa.
    pub pressures: Vec<f64>,
}

/// The side of a contact that is rough.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RoughSide {
    /// That of the rod.
    Moving,
    /// That of the lip.
    Standing,
}

impl Word for RoughSide {
    const WORDS: &'static [(&'static str, Self)] = &[("moving", Self::Moving), ("standing", Self::Standing)];
}

/// What comes back from the air on the rod.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Air {
    /// The film that left.
    #[default]
    Returns,
    /// Nothing.
    Dry,
    /// As much as the lip takes.
    Flooded,
}

impl Word for Air {
    const WORDS: &'static [(&'static str, Self)] =
        &[("returns", Self::Returns), ("dry", Self::Dry), ("flooded", Self::Flooded)];
}

impl Air {
    /// The word for it in a seal file.
    pub fn word(self) -> &'static str {
        self.as_word()
    }
}

/// The groups of variables that a seal may be asked for, in the order of the variables.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum SealGroup {
    /// The forces.
    Forces,
    /// Dissipated power and energy.
    Dissipation,
    /// Leak, thickness, pressure.
    Film,
    /// What contacts bear and rub.
    Contact,
    /// Change of forces and leak with the target of u.
    Tangent,
    /// Content and pressures of each cell.
    Cells,
}

impl Word for SealGroup {
    const WORDS: &'static [(&'static str, Self)] = &[
        ("forces", Self::Forces),
        ("dissipation", Self::Dissipation),
        ("film", Self::Film),
        ("contact", Self::Contact),
        ("tangent", Self::Tangent),
        ("cells", Self::Cells),
    ];
}

impl SealGroup {
    /// The group's name in a seal file.
    pub fn word(self) -> &'static str {
        self.as_word()
    }
}

/// A fluid's viscosity over temperature: one value, two by Andrade's law, ln η straight over 1/T, three by Vogel's, ln η =
/// A + B/(T - C).
#[derive(Clone, Debug, PartialEq)]
pub struct Viscosity {
    /// Temperatures, K, rising, and viscosities, Pa s.
    points: Vec<(f64, f64)>,
}

impl Viscosity {
    /// That of these temperatures (K, of a single value not used) and viscosities (Pa s), falling as it is warmer.
    ///
    /// # Errors
    /// Says what was expected.
    pub fn new(mut points: Vec<(f64, f64)>) -> Result<Self, &'static str> {
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        if !(1..=3).contains(&points.len()) {
            return Err("one viscosity, or those at two or three temperatures");
        }
        if points.windows(2).any(|pair| pair[0].0 >= pair[1].0 || pair[0].1 <= pair[1].1) {
            return Err("viscosities that fall as temperatures rise");
        }
        let new = Self { points };
        if new.points.len() == 3 && !new.vogel().is_some_and(|[_, b, c]| b > 0.0 && c >= 0.0 && c < new.points[0].0) {
            return Err(
                "three viscosities that Vogel's law ln η = A + B/(T - C) has, with 0 <= C below the least temperature",
            );
        }
        Ok(new)
    }

    /// Whether it depends on the temperature.
    pub fn depends_on_temperature(&self) -> bool {
        self.points.len() > 1
    }

    /// The temperatures that it was given at, K.
    pub fn temperatures(&self) -> impl Iterator<Item = f64> {
        self.points.iter().map(|point| point.0).filter(|_| self.depends_on_temperature())
    }

    /// Pa s at a temperature, K.
    pub fn at(&self, kelvin: f64) -> f64 {
        let log = |i: usize| self.points[i].1.ln();
        match self.points.len() {
            1 => self.points[0].1,
            2 => {
                let [a, b] = [0, 1].map(|i: usize| 1.0 / self.points[i].0);
                (log(0) + (log(1) - log(0)) * (1.0 / kelvin - a) / (b - a)).exp()
            }
            _ => self.vogel().map_or(self.points[0].1, |[a, b, c]| (a + b / (kelvin - c)).exp()),
        }
    }

    /// A, B (K) and C (K) of Vogel's law through three points; `None` where there are none.
    fn vogel(&self) -> Option<[f64; 3]> {
        let [(t1, n1), (t2, n2), (t3, n3)] = <[(f64, f64); 3]>::try_from(&self.points[..]).ok()?;
        let (l12, l13) = ((n1 / n2).ln(), (n1 / n3).ln());
        // (t2 - t1)(t3 - c)/((t3 - t1)(t2 - c)) = l12/l13.
        let ratio = l12 / l13 * (t3 - t1) / (t2 - t1);
        let c = (t3 - ratio * t2) / (1.0 - ratio);
        let b = l12 * (t1 - c) * (t2 - c) / (t2 - t1);
        let found = [n1.ln() - b / (t1 - c), b, c];
        found.iter().all(|number| number.is_finite()).then_some(found)
    }
}

impl SealFile {
    /// The error of a key that only the table can judge.
    pub fn refuse(&self, key: &str, given: String, expected: String) -> SceneError {
        SceneError::new(self.values.location(key), key, Problem::Value { given, expected })
    }

    /// Paths of the files that it reads, relative to its folder.
    pub fn files(&self) -> [&PathBuf; 2] {
        [&self.table, &self.pressure]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Through the points given, by the laws between.
    #[test]
    fn viscosities_follow_andrade_and_vogel() {
        let close = |found: f64, exact: f64| assert!((found / exact - 1.0).abs() < 1e-12, "{found} {exact}");
        let one = Viscosity::new(vec![(0.0, 0.05)]).unwrap();
        close(one.at(400.0), 0.05);
        let andrade = |t: f64| (-12.0 + 2700.0 / t).exp();
        let two = Viscosity::new([293.0, 373.0].map(|t| (t, andrade(t))).to_vec()).unwrap();
        [280.0, 320.0, 400.0].iter().for_each(|&t| close(two.at(t), andrade(t)));
        let vogel = |t: f64| (-9.0 + 900.0 / (t - 160.0)).exp();
        let three = Viscosity::new([373.0, 293.0, 313.0].map(|t| (t, vogel(t))).to_vec()).unwrap();
        [280.0, 340.0, 400.0].iter().for_each(|&t| close(three.at(t), vogel(t)));
        assert!(Viscosity::new(vec![(293.0, 0.01), (313.0, 0.02)]).is_err());
        assert!(Viscosity::new(vec![(293.0, 0.1), (313.0, 0.099), (333.0, 1e-6)]).is_err());
        assert!(Viscosity::new(Vec::new()).is_err());
    }
}
