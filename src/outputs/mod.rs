//! The outputs of a run: which variables a scene has (`Variable`), and their values, directional derivatives and direct
//! dependencies at one instant of the run (`Snapshot`). All that differs from output to output stands in one table.

mod accounts;
mod carrier_shift;
mod snapshot;
mod table;

pub use accounts::{Accounts, Counters, Energies, Monitored};
pub use snapshot::{LayerView, Snapshot};
pub use table::{Dependencies, Output, OutputType, Tangent};

use crate::scene::{OutputGroup, Scene, Unit};
use carrier_shift::CarrierShift;
use snapshot::Evaluation;
use table::{OutputRow, TABLE};

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

impl Snapshot<'_> {
    /// Writes the values of `variables`, in their order, into `values`; Integers as whole numbers. What no variable
    /// asks for is not computed.
    pub fn evaluate(&self, variables: &[Variable], values: &mut [f64]) {
        let now = Evaluation::new(self);
        for (variable, value) in variables.iter().zip(values) {
            *value = variable.row.value(&now, variable.mass);
        }
    }

    /// Writes into `values` the derivatives of `variables`, in their order, with the carrier shifted along x and z by
    /// `direction` (m per unit) and all states frozen.
    pub fn differentiate(&self, variables: &[Variable], direction: (f64, f64), values: &mut [f64]) {
        let (now, shift) = (Evaluation::new(self), CarrierShift::new(self.model, direction));
        for (variable, value) in variables.iter().zip(values) {
            *value = variable.row.derivative(&now, variable.mass, &shift);
        }
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

/// The inputs on which `output` depends directly in `scene`.
pub fn dependencies(scene: &Scene, output: Output) -> Dependencies {
    let of_row = |row: &OutputRow| (row.dependencies)(scene);
    TABLE.iter().find(|row| row.is(output)).map_or_else(Dependencies::default, of_row)
}
