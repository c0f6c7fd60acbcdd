//! The outputs of a run: which variables a scene has (`Variable`), and their values, directional derivatives and direct
//! dependencies at one instant of the run (`Snapshot`). All that differs from output to output stands in one table.

mod accounts;
mod carrier_shift;
mod snapshot;
mod table;

pub use accounts::{Accounts, Counters, Energies, Monitored};
pub use snapshot::{LayerView, Snapshot};

use crate::scene::{Input, OutputGroup, Scene, Unit};
use table::{OutputRow, TABLE};

/// The quantity behind an output variable; its row in the table says more.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Output {
    /// F_x = Σ F_x,i, N.
    ForceX,
    /// F_z = Σ F_z,i, N.
    ForceZ,
    /// u of a body, m.
    CarrierU,
    /// w of a body, m.
    CarrierW,
    /// u̇ of a body, m/s.
    CarrierURate,
    /// ẇ of a body, m/s.
    CarrierWRate,
    /// R_x, the drive's force on a body, N.
    DriveX,
    /// R_z, the drive's force on a body, N.
    DriveZ,
    /// Power dissipated in dampers, Maxwell elements and friction, W.
    DissipatedPower,
    /// Energy dissipated since the start through all channels, J.
    DissipatedEnergy,
    /// Energy dissipated in dampers, J.
    DamperEnergy,
    /// Energy dissipated in Maxwell elements, J.
    MaxwellEnergy,
    /// Energy dissipated in friction, J.
    FrictionEnergy,
    /// The part of it against Coulomb's friction, J.
    CoulombEnergy,
    /// The part of it against the shear force, J.
    ShearEnergy,
    /// The part of it by hysteresis of the waves that the profile lacks, J.
    FineEnergy,
    /// Energy dissipated in impacts, J.
    ImpactEnergy,
    /// Σ -(F_N s + μ_h F_N)/q, N.
    Hysteresis,
    /// The part of it by the waves that the profile lacks, N.
    FineForce,
    /// Σ -F_T/q, N.
    Adhesion,
    /// The part of it by Coulomb's friction, N.
    CoulombForce,
    /// The part of it by the shear force, N.
    ShearForce,
    /// |F_x|/F_z, 0 where F_z ≤ 0.
    FrictionCoefficient,
    /// Number of masses in contact.
    ContactCount,
    /// Number of masses that stick.
    StickingCount,
    /// Masses in contact over all masses.
    ContactRatio,
    /// Area of the masses in contact, m².
    ContactArea,
    /// Area that touches below the profile's resolution, m².
    RealArea,
    /// The largest flash temperature of all masses, K.
    FlashLargest,
    /// The mean one of the masses in contact, K.
    FlashMean,
    /// Sum of the contact forces on the masses along x, N.
    ContactForceX,
    /// Sum of the contact forces on the masses along z, N.
    ContactForceZ,
    /// Work of the carrier since the start, J.
    InputEnergy,
    /// T, J.
    KineticEnergy,
    /// V, J.
    ElasticEnergy,
    /// Heat that the rubber has taken from friction since the start, J.
    HeatEnergy,
    /// T_c, J.
    CarrierKineticEnergy,
    /// V_c, J.
    CarrierElasticEnergy,
    /// E_c, J.
    CarrierDamperEnergy,
    /// Residual of the energy balance, J.
    EnergyResidual,
    /// Derivative of a quantity at the end of a step by the target of an input in that step.
    Tangent(Tangent, Input),
    /// Accepted steps since the start.
    Steps,
    /// Mode changes since the start.
    Events,
    /// Rejected steps since the start.
    Rejected,
    /// Communication steps done again since the start, to the values that came in place of those extrapolated.
    Repeated,
    /// The larger of the estimated accumulated errors of F_x and F_z, each over its largest value so far.
    ForceError,
    /// Estimated accumulated error of E_diss over its largest value so far.
    DissipationError,
    /// Processor time since the start, s.
    RunTime,
    /// Position of mass `.0` (from 0) along x, m.
    ElementX(usize),
    /// Height of mass `.0` (from 0), m.
    ElementZ(usize),
    /// Normal force on mass `.0` (from 0), N.
    ElementNormalForce(usize),
    /// Friction force on mass `.0` (from 0), against v_t, N.
    ElementFrictionForce(usize),
    /// Mode of mass `.0` (from 0): 0 free, 1 or -1 slipping, 2 sticking.
    ElementMode(usize),
    /// The flash temperature of mass `.0` (from 0), K.
    ElementFlash(usize),
    /// The speed of slip that the contact of mass `.0` (from 0) remembers, m/s.
    ElementSpeedRemembered(usize),
}

/// A quantity whose derivatives by the targets of the inputs are outputs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tangent {
    /// F_x.
    ForceX,
    /// F_z.
    ForceZ,
    /// u of a body.
    U,
    /// u̇ of a body.
    URate,
    /// w of a body.
    W,
    /// ẇ of a body.
    WRate,
}

/// The type of a variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OutputType {
    /// A Real, continuous.
    Real,
    /// An Integer, discrete.
    Integer,
}

/// An output variable of a scene: a column of the result file, a variable of the FMU.
#[derive(Clone, Debug, PartialEq)]
pub struct Variable {
    /// The quantity.
    pub output: Output,
    /// The output group that it belongs to.
    pub group: OutputGroup,
    /// The variable's name.
    pub name: String,
    /// The unit of its values.
    pub unit: Unit,
    /// Real or Integer.
    pub kind: OutputType,
    /// What it is, in a few words.
    pub description: String,
    row: &'static OutputRow,
    /// Which mass (from 0) it belongs to, if to a single one; else 0.
    mass: usize,
}

impl Variable {
    /// Whether it is an output of the FMU; the fields of the elements are local variables.
    pub fn is_output(&self) -> bool {
        self.group != OutputGroup::Elements
    }

    /// The variable of a quantity of the whole layer.
    fn for_layer(row: &'static OutputRow, output: Output) -> Self {
        Self::named(row, output, 0, row.name.into(), row.description.into())
    }

    /// The variable of mass `i` (from 0).
    fn for_mass(row: &'static OutputRow, output: Output, i: usize) -> Self {
        let name = format!("element[{}].{}", i + 1, row.name);
        Self::named(row, output, i, name, format!("{} {}", row.description, i + 1))
    }

    fn named(row: &'static OutputRow, output: Output, mass: usize, name: String, description: String) -> Self {
        Self { output, group: row.group, name, unit: row.unit, kind: row.kind, description, row, mass }
    }
}

/// The output variables of `scene`, in the order of the result files.
pub fn variables(scene: &Scene) -> Vec<Variable> {
    scene.outputs.iter().flat_map(|&group| group_variables(scene, group)).collect()
}

fn group_variables(scene: &Scene, group: OutputGroup) -> Vec<Variable> {
    let rows = TABLE.iter().filter(|row| row.group == group && (row.exists)(scene));
    let (of_layer, of_masses): (Vec<_>, Vec<_>) = rows.partition(|row| row.layer_output().is_some());
    let of_layer = of_layer.iter().filter_map(|row| row.layer_output().map(|output| Variable::for_layer(row, output)));
    let named = |row: &'static OutputRow, i| row.mass_output(i).map(|output| Variable::for_mass(row, output, i));
    let of_mass = |i| of_masses.iter().filter_map(move |row| named(row, i));
    of_layer.chain((0..scene.layer.masses).flat_map(of_mass)).collect()
}

/// The variable of an output, whatever the scene; `None` for those of single masses.
pub fn variable(output: Output) -> Option<Variable> {
    let row = TABLE.iter().find(|row| row.is(output))?;
    row.layer_output().map(|output| Variable::for_layer(row, output))
}

/// An output that a scene can have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OutputEntry {
    /// The output group that it belongs to.
    pub group: OutputGroup,
    /// Its name; of a quantity of single masses the part behind `element[i].`.
    pub name: &'static str,
    /// The unit of its values.
    pub unit: Unit,
    /// What it is, in a few words.
    pub description: &'static str,
}

/// All outputs, in the order of the result files.
pub fn catalogue() -> impl Iterator<Item = OutputEntry> {
    TABLE.iter().map(|row| {
        let OutputRow { group, name, unit, description, .. } = *row;
        OutputEntry { group, name, unit, description }
    })
}

/// The unit of the output variable called `name`, whatever the scene; `None` for a name that no scene can have.
pub fn unit_of(name: &str) -> Option<Unit> {
    let (name, of_mass) = name.split_once("].").map_or((name, false), |(_, field)| (field, true));
    let named = |row: &&OutputRow| row.name == name && row.layer_output().is_none() == of_mass;
    TABLE.iter().find(named).map(|row| row.unit)
}

/// The inputs on which something depends directly: with all states frozen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Dependencies {
    /// On u.
    pub on_u: bool,
    /// On w.
    pub on_w: bool,
}

impl Dependencies {
    /// The components of a direction (along u, along w) that count.
    pub fn part_of(self, (du, dw): (f64, f64)) -> (f64, f64) {
        (if self.on_u { du } else { 0.0 }, if self.on_w { dw } else { 0.0 })
    }

    fn or(self, other: Self) -> Self {
        Self { on_u: self.on_u || other.on_u, on_w: self.on_w || other.on_w }
    }

    fn only_if(self, condition: bool) -> Self {
        if condition { self } else { Self::default() }
    }
}

/// The inputs on which `output` depends directly in `scene`.
pub fn dependencies(scene: &Scene, output: Output) -> Dependencies {
    let of_row = |row: &OutputRow| (row.dependencies)(scene);
    TABLE.iter().find(|row| row.is(output)).map_or_else(Dependencies::default, of_row)
}
