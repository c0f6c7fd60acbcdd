//! The output variables of a seal: names, units and values.

use super::definition::Seal;
use super::run::SealRun;
use crate::scene::{SealGroup, Unit};

/// The quantity behind a variable of a seal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SealOutput {
    /// Force on the rod along x, N.
    ForceX,
    /// Load on the lip, N.
    ForceZ,
    /// Dissipated power, mean over the last step, W.
    Power,
    /// Dissipated energy, J.
    Energy,
    /// What leaked to the air, net, m³.
    Leak,
    /// What leaks, net, m³/s.
    LeakRate,
    /// Mean content, weighted with the total pressure, m.
    Thickness,
    /// Least content, m.
    LeastThickness,
    /// Largest pressure of the fluid, Pa.
    LargestPressure,
    /// Volume of the film on the rod, m³.
    OnRod,
    /// Share of the load that contacts bear, 1.
    ContactShare,
    /// Limit of friction by contacts, N.
    SolidForce,
    /// Limit of friction by the fluid's shear, N.
    ViscousForce,
    /// Change of F_x with the target of u, N/m.
    TangentForce,
    /// Change of the leak with the target of u, m².
    TangentLeak,
    /// Content of a cell, m.
    Content(usize),
    /// Pressure of the fluid in a cell, Pa.
    Pressure(usize),
    /// Pressure that contacts bear in a cell, Pa.
    Contact(usize),
}

/// An output variable of a seal: a column of the result file, a variable of the FMU.
#[derive(Clone, Debug, PartialEq)]
pub struct SealVariable {
    /// The quantity.
    pub output: SealOutput,
    /// The group that it belongs to.
    pub group: SealGroup,
    /// The variable's name.
    pub name: String,
    /// The unit of its values.
    pub unit: Unit,
    /// What it is, in a few words.
    pub description: String,
}

/// A row of the table of outputs: group, output, name, unit, what it is.
type Row = (SealGroup, SealOutput, &'static str, Unit, &'static str);

#[rustfmt::skip]
const TABLE: &[Row] = {
    use SealGroup::{Contact, Dissipation, Film, Forces, Tangent};
    use Unit::{CubicMeter, CubicMeterPerSecond, Joule, Meter, Newton, NewtonPerMeter, One, Pascal, SquareMeter, Watt};
    &[
        (Forces, SealOutput::ForceX, "F_x", Newton, "Force on the rod, below 0 as it moves to the air"),
        (Forces, SealOutput::ForceZ, "F_z", Newton, "Load on the lip"),
        (Dissipation, SealOutput::Power, "P_diss", Watt, "Dissipated power, mean over the last step"),
        (Dissipation, SealOutput::Energy, "E_diss", Joule, "Energy dissipated since the start"),
        (Film, SealOutput::Leak, "film.leak", CubicMeter, "Volume that leaked to the air since the start, net"),
        (Film, SealOutput::LeakRate, "film.leak_rate", CubicMeterPerSecond, "Flow to the air"),
        (Film, SealOutput::Thickness, "film.thickness", Meter, "Mean content, weighted with the total pressure"),
        (Film, SealOutput::LeastThickness, "film.thickness_least", Meter, "Least content"),
        (Film, SealOutput::LargestPressure, "film.pressure_largest", Pascal, "Largest pressure of the fluid"),
        (Film, SealOutput::OnRod, "film.on_rod", CubicMeter, "Volume of the film on the rod"),
        (Contact, SealOutput::ContactShare, "contact.share", One, "Share of the load that contacts bear"),
        (Contact, SealOutput::SolidForce, "contact.F_solid", Newton, "Friction of contacts where the lip slips"),
        (Contact, SealOutput::ViscousForce, "contact.F_viscous", Newton, "Friction by the fluid's shear where the lip slips"),
        (Tangent, SealOutput::TangentForce, "tangent.F_x.u", NewtonPerMeter, "Change of F_x at the end of a step with the target of u in it"),
        (Tangent, SealOutput::TangentLeak, "tangent.film.leak.u", SquareMeter, "Change of film.leak at the end of a step with the target of u in it"),
    ]
};

/// A field of the cells: its output, the part of its name behind the cell's, unit, what it is.
type Field = (fn(usize) -> SealOutput, &'static str, Unit, &'static str);

const FIELDS: &[Field] = &[
    (SealOutput::Content, "content", Unit::Meter, "Content of"),
    (SealOutput::Pressure, "pressure", Unit::Pascal, "Pressure of the fluid in"),
    (SealOutput::Contact, "contact", Unit::Pascal, "Pressure that contacts bear in"),
];

impl SealVariable {
    /// The variable of an output, without its name.
    pub(super) fn of(output: SealOutput) -> Self {
        Self { output, group: SealGroup::Forces, name: String::new(), unit: Unit::One, description: String::new() }
    }

    /// Whether it is an output of the FMU; the fields of the cells are local variables.
    pub fn is_output(&self) -> bool {
        self.group != SealGroup::Cells
    }
}

/// Name, unit, group and description of the outputs of seals but the fields of the cells, whose names are those of one cell.
pub fn catalogue() -> Vec<(String, Unit, SealGroup, String)> {
    let outputs =
        TABLE.iter().map(|(group, _, name, unit, text)| ((*name).to_owned(), *unit, *group, (*text).to_owned()));
    let field = |(_, name, unit, text): &Field| {
        (format!("cell[i].{name}"), *unit, SealGroup::Cells, format!("{text} the cell, from 1 at the sealed side"))
    };
    outputs.chain(FIELDS.iter().map(field)).collect()
}

/// The unit of the output variable called `name`, whatever the seal; `None` for a name that no seal can have.
pub fn unit_of(name: &str) -> Option<Unit> {
    if let Some((_, field)) = name.strip_prefix("cell[").and_then(|rest| rest.split_once("].")) {
        return FIELDS.iter().find(|known| known.1 == field).map(|known| known.2);
    }
    TABLE.iter().find(|row| row.2 == name).map(|row| row.3)
}

impl Seal {
    /// The output variables of the groups asked for, in their order.
    pub fn variables(&self) -> Vec<SealVariable> {
        self.groups().iter().flat_map(|&group| self.variables_of(group)).collect()
    }

    /// The variables that the seal would have with every group but those of the cells and the tangents.
    pub fn all_variables(&self) -> Vec<SealVariable> {
        use SealGroup::{Contact, Dissipation, Film, Forces};
        [Forces, Dissipation, Film, Contact].into_iter().flat_map(|group| self.variables_of(group)).collect()
    }

    fn variables_of(&self, group: SealGroup) -> Vec<SealVariable> {
        if group == SealGroup::Cells {
            return (0..self.cells()).flat_map(fields).collect();
        }
        let rows = TABLE.iter().filter(|row| row.0 == group);
        let variable = |(group, output, name, unit, description): &Row| SealVariable {
            output: *output,
            group: *group,
            name: (*name).to_owned(),
            unit: *unit,
            description: (*description).to_owned(),
        };
        rows.map(variable).collect()
    }
}

fn fields(i: usize) -> impl Iterator<Item = SealVariable> {
    let cell = format!("cell[{}]", i + 1);
    FIELDS.iter().map(move |(output, name, unit, text)| SealVariable {
        output: output(i),
        group: SealGroup::Cells,
        name: format!("{cell}.{name}"),
        unit: *unit,
        description: format!("{text} {cell}"),
    })
}

impl SealRun {
    /// Writes the values of `variables`, in their order, into `values`.
    pub fn evaluate(&self, variables: &[SealVariable], values: &mut [f64]) {
        for (variable, value) in variables.iter().zip(values) {
            *value = self.value(variable.output);
        }
    }

    /// The value of an output.
    pub fn value(&self, output: SealOutput) -> f64 {
        match output {
            SealOutput::ForceX => self.force(),
            SealOutput::ForceZ => self.load(),
            SealOutput::Power => self.state.totals.power,
            SealOutput::Energy => self.state.totals.lost,
            SealOutput::Leak => self.leak(),
            SealOutput::LeakRate => self.leak_rate(),
            SealOutput::Thickness => self.thickness(),
            SealOutput::LeastThickness => self.contents().iter().copied().fold(f64::INFINITY, f64::min),
            SealOutput::LargestPressure => self.largest_pressure(),
            SealOutput::OnRod => self.on_rod(),
            SealOutput::ContactShare => self.contact_share(),
            SealOutput::SolidForce => self.limit.solid,
            SealOutput::ViscousForce => self.limit.viscous,
            SealOutput::TangentForce => self.tangents[0],
            SealOutput::TangentLeak => self.tangents[1],
            SealOutput::Content(i) => self.contents()[i],
            SealOutput::Pressure(i) => self.film.pressure(i),
            SealOutput::Contact(i) => self.film.totals[i] - self.film.pressure(i),
        }
    }
}
