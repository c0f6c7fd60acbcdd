//! The output variables of a scene: names, units, order.

use crate::scene::{Link, LinkKind, OutputGroup, Scene, Unit};

/// The quantity behind an output variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Output {
    /// F_x = Σ F_x,i, N.
    ForceX,
    /// F_z = Σ F_z,i, N.
    ForceZ,
    /// Power lost now, W: dampers, Maxwell elements and friction.
    DissipatedPower,
    /// Energy lost since the start through all channels, J.
    DissipatedEnergy,
    /// Energy lost in dampers, J.
    DamperEnergy,
    /// Energy lost in Maxwell elements, J.
    MaxwellEnergy,
    /// Energy lost in friction, J.
    FrictionEnergy,
    /// Energy lost in impacts, J.
    ImpactEnergy,
    /// Σ -F_N s/q, N.
    Hysteresis,
    /// Σ -F_T/q, N.
    Adhesion,
    /// |F_x|/F_z, 0 where F_z ≤ 0.
    FrictionCoefficient,
    /// Masses in contact.
    ContactCount,
    /// Masses that stick.
    StickingCount,
    /// Masses in contact over all masses.
    ContactRatio,
    /// Area of the masses in contact, m².
    ContactArea,
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
    /// What the energy balance misses, J.
    EnergyResidual,
    /// Change of F_x at the end of a step with the target of û in that step, N/m.
    TangentXU,
    /// Change of F_x with the target of ŵ, N/m.
    TangentXW,
    /// Change of F_z with the target of û, N/m.
    TangentZU,
    /// Change of F_z with the target of ŵ, N/m.
    TangentZW,
    /// Accepted steps since the start.
    Steps,
    /// Mode changes since the start.
    Events,
    /// Rejected steps since the start.
    Rejected,
    /// Estimated accumulated error of F_z over its largest value so far.
    EstimatedError,
    /// Processor time since the start, s.
    RunTime,
    /// Place of mass `.0` (from 0) along x, m.
    ElementX(usize),
    /// Height of mass `.0` (from 0), m.
    ElementZ(usize),
    /// Normal force on mass `.0` (from 0), N.
    ElementNormalForce(usize),
    /// Friction force on mass `.0` (from 0), against v_t, N.
    ElementFrictionForce(usize),
    /// Mode of mass `.0` (from 0): 0 free, 1 or -1 slipping, 2 sticking.
    ElementMode(usize),
}

/// The type of a variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A Real, continuous.
    Real,
    /// An Integer, discrete.
    Integer,
}

/// An output variable as a master or a result file names it.
#[derive(Clone, Debug, PartialEq)]
pub struct Variable {
    /// The quantity.
    pub output: Output,
    /// The group that asked for it.
    pub group: OutputGroup,
    /// The variable's name.
    pub name: String,
    /// The unit of its values.
    pub unit: Unit,
    /// Real or Integer.
    pub kind: Kind,
    /// What it is, in a few words.
    pub description: String,
}

impl Variable {
    /// Whether it is an output of the FMU; the fields of the elements are local.
    pub fn is_output(&self) -> bool {
        self.group != OutputGroup::Elements
    }
}

/// The output variables of `scene`, in the order of the result files.
pub fn variables(scene: &Scene) -> Vec<Variable> {
    scene.outputs.iter().flat_map(|&group| group_variables(scene, group)).collect()
}

fn group_variables(scene: &Scene, group: OutputGroup) -> Vec<Variable> {
    if group == OutputGroup::Elements {
        return (0..scene.layer.masses).flat_map(element_variables).collect();
    }
    TABLE.iter().filter(|row| row.1 == group && can_have(scene, row.0)).map(of_row).collect()
}

/// The variable of an output, whatever the scene; `None` for those of single elements.
pub fn variable(output: Output) -> Option<Variable> {
    TABLE.iter().find(|row| row.0 == output).map(of_row)
}

fn of_row(&(output, group, name, kind, unit, description): &Row) -> Variable {
    Variable { output, group, name: name.into(), unit, kind, description: description.into() }
}

/// A channel of dissipation that the scene cannot have is no variable, nor is an area that it does not give.
fn can_have(scene: &Scene, output: Output) -> bool {
    let any =
        |test: fn(&Link) -> bool| LinkKind::ALL.into_iter().any(|kind| scene.link(kind).as_ref().is_some_and(test));
    match output {
        // A Maxwell element may be replaced by a damper.
        Output::DamperEnergy => {
            any(|link| link.damping.is_some()) || (scene.solver.reduce > 0.0 && any(|link| !link.maxwell.is_empty()))
        }
        Output::MaxwellEnergy => any(|link| !link.maxwell.is_empty()),
        Output::FrictionEnergy => scene.friction.is_some(),
        Output::ContactArea => scene.layer.element_area().is_some(),
        _ => true,
    }
}

type Row = (Output, OutputGroup, &'static str, Kind, Unit, &'static str);

#[rustfmt::skip]
const TABLE: [Row; 30] = {
    use Kind::{Integer, Real};
    use OutputGroup::{Contact, Dissipation, Energy, Forces, Friction, Solver, Tangent};
    use Unit::{Joule, Newton, NewtonPerMeter, One, Second, SquareMeter, Watt};
    [
        (Output::ForceX, Forces, "F_x", Real, Newton, "Force of the layer on the carrier along x"),
        (Output::ForceZ, Forces, "F_z", Real, Newton, "Force of the layer on the carrier along z, positive when compressed"),
        (Output::DissipatedPower, Dissipation, "P_diss", Real, Watt, "Power lost now"),
        (Output::DissipatedEnergy, Dissipation, "E_diss", Real, Joule, "Energy lost since the start, all channels"),
        (Output::DamperEnergy, Dissipation, "dissipation.E_damper", Real, Joule, "Energy lost in dampers"),
        (Output::MaxwellEnergy, Dissipation, "dissipation.E_maxwell", Real, Joule, "Energy lost in Maxwell elements"),
        (Output::FrictionEnergy, Dissipation, "dissipation.E_friction", Real, Joule, "Energy lost in friction"),
        (Output::ImpactEnergy, Dissipation, "dissipation.E_impact", Real, Joule, "Energy lost in impacts"),
        (Output::Hysteresis, Friction, "friction.F_hysteresis", Real, Newton, "Tangential force of the normal forces on the slopes"),
        (Output::Adhesion, Friction, "friction.F_adhesion", Real, Newton, "Tangential force of the friction in the contacts"),
        (Output::FrictionCoefficient, Friction, "friction.coefficient", Real, One, "|F_x|/F_z, 0 where F_z <= 0"),
        (Output::ContactCount, Contact, "contact.count", Integer, One, "Masses in contact"),
        (Output::StickingCount, Contact, "contact.sticking", Integer, One, "Masses that stick"),
        (Output::ContactRatio, Contact, "contact.ratio", Real, One, "Masses in contact over all masses"),
        (Output::ContactArea, Contact, "contact.area", Real, SquareMeter, "Area that the masses in contact stand for"),
        (Output::ContactForceX, Contact, "contact.F_x", Real, Newton, "Sum of the contact forces on the masses along x"),
        (Output::ContactForceZ, Contact, "contact.F_z", Real, Newton, "Sum of the contact forces on the masses along z"),
        (Output::InputEnergy, Energy, "energy.input", Real, Joule, "Work of the carrier on the layer since the start"),
        (Output::KineticEnergy, Energy, "energy.kinetic", Real, Joule, "Kinetic energy of the masses"),
        (Output::ElasticEnergy, Energy, "energy.elastic", Real, Joule, "Elastic energy of the links"),
        (Output::EnergyResidual, Energy, "energy.residual", Real, Joule, "What the energy balance misses: the run's numerical error"),
        (Output::TangentXU, Tangent, "tangent.dF_x_du", Real, NewtonPerMeter, "Change of F_x at the end of a step with the target of u in that step"),
        (Output::TangentXW, Tangent, "tangent.dF_x_dw", Real, NewtonPerMeter, "Change of F_x at the end of a step with the target of w in that step"),
        (Output::TangentZU, Tangent, "tangent.dF_z_du", Real, NewtonPerMeter, "Change of F_z at the end of a step with the target of u in that step"),
        (Output::TangentZW, Tangent, "tangent.dF_z_dw", Real, NewtonPerMeter, "Change of F_z at the end of a step with the target of w in that step"),
        (Output::Steps, Solver, "solver.steps", Integer, One, "Accepted steps since the start"),
        (Output::Events, Solver, "solver.events", Integer, One, "Mode changes since the start"),
        (Output::Rejected, Solver, "solver.rejected", Integer, One, "Rejected steps since the start"),
        (Output::EstimatedError, Solver, "solver.error", Real, One, "Estimated accumulated error of F_z over its largest value so far"),
        (Output::RunTime, Solver, "solver.run_time", Real, Second, "Processor time since the start"),
    ]
};

fn element_variables(i: usize) -> [Variable; 5] {
    let variable = |output, field: &str, kind, unit, description: &str| Variable {
        output,
        group: OutputGroup::Elements,
        name: format!("element[{}].{field}", i + 1),
        unit,
        kind,
        description: format!("{description} {}", i + 1),
    };
    [
        variable(Output::ElementX(i), "x", Kind::Real, Unit::Meter, "Place along x of mass"),
        variable(Output::ElementZ(i), "z", Kind::Real, Unit::Meter, "Height of mass"),
        variable(Output::ElementNormalForce(i), "F_N", Kind::Real, Unit::Newton, "Normal force on mass"),
        variable(
            Output::ElementFrictionForce(i),
            "F_T",
            Kind::Real,
            Unit::Newton,
            "Friction force, against its velocity, on mass",
        ),
        variable(
            Output::ElementMode(i),
            "mode",
            Kind::Integer,
            Unit::One,
            "Mode (0 free, 1 or -1 slipping, 2 sticking) of mass",
        ),
    ]
}

/// The unit of the output variable called `name`, whatever the scene; `None` for a name that no scene can have.
pub fn unit_of(name: &str) -> Option<Unit> {
    match name.split_once("].") {
        Some((_, field)) => {
            let same = |variable: &Variable| variable.name == format!("element[1].{field}");
            element_variables(0).into_iter().find(same).map(|variable| variable.unit)
        }
        None => TABLE.iter().find(|row| row.2 == name).map(|row| row.4),
    }
}
