//! The output variables of a patch: names, units and values.

use super::definition::Patch;
use super::element_sums::ElementSums;
use super::run::PatchRun;
use crate::outputs::OutputType;
use crate::scene::{PatchGroup, Unit};

/// The quantity behind a variable of a patch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PatchOutput {
    /// Force along x, y or z, N.
    Force(usize),
    /// Moment about x, y or z, N m.
    Moment(usize),
    /// Force on the tread, N.
    TransportForce,
    /// Dissipated power, mean over the last step, W.
    Power,
    /// Dissipated energy, J.
    Energy,
    /// Of that, by slip, J.
    SlipEnergy,
    /// Of that, by release, J.
    ReleaseEnergy,
    /// Of that, by dampers, J.
    DamperEnergy,
    /// Elements that bear.
    Count,
    /// Elements that stick.
    Sticking,
    /// Area of the elements that bear, m².
    NominalArea,
    /// Real area of contact, m².
    RealArea,
    /// The largest pressure, Pa.
    Pressure,
    /// Share of the normal force that is borne outside the table's pressures or above its speeds.
    Beyond,
    /// The temperature of the warmest element that bears, K.
    LargestTemperature,
    /// The mean temperature of the elements that bear, by their areas, K.
    MeanTemperature,
    /// Tangential over normal force.
    Friction,
    /// Share of hysteresis in it.
    Hysteresis,
    /// Energy stored in the springs, J.
    ElasticEnergy,
    /// Change of a component of the wrench with the target of a coordinate.
    Tangent(usize, usize),
    /// Pressure of an element, Pa.
    ElementPressure(usize),
    /// Traction on an element along x or y, Pa.
    ElementTraction(usize, usize),
    /// Mode of an element: 0 free, 1 slips, 2 sticks.
    ElementMode(usize),
    /// Temperature of an element, K.
    ElementTemperature(usize),
}

/// An output variable of a patch: a column of the result file, a variable of the FMU.
#[derive(Clone, Debug, PartialEq)]
pub struct PatchVariable {
    /// The quantity.
    pub output: PatchOutput,
    /// The group that it belongs to.
    pub group: PatchGroup,
    /// The variable's name.
    pub name: String,
    /// The unit of its values.
    pub unit: Unit,
    /// Real or Integer.
    pub kind: OutputType,
    /// What it is, in a few words.
    pub description: String,
}

/// The names of the coordinates of a pose, in the order of the inputs.
pub const COORDINATES: [&str; 6] = ["x", "y", "z", "roll", "pitch", "yaw"];
const AXES: [&str; 3] = ["x", "y", "z"];

/// The patches that have an output.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PatchKind {
    /// All.
    All,
    /// Those with a tread that runs through.
    Tread,
    /// Those whose slip warms the elements.
    Warm,
    /// Those with dampers.
    Damped,
}

/// The output of the element of an index.
type OfElement = fn(usize) -> PatchOutput;

/// An output of a patch, or of each of its elements: what stands for it is `O`.
struct PatchOutputRow<O> {
    group: PatchGroup,
    output: O,
    /// Its name; of an element the part behind the element's.
    name: &'static str,
    unit: Unit,
    kind: OutputType,
    /// What it is; of an element the element's name follows.
    description: &'static str,
    of: PatchKind,
}

#[rustfmt::skip]
const TABLE: &[PatchOutputRow<PatchOutput>] = {
    use OutputType::{Integer, Real};
    use PatchGroup::{Contact, Dissipation, Energy, Forces, Friction};
    use PatchKind::{All, Damped, Tread, Warm};
    use Unit::{Joule, Kelvin, Newton, NewtonMeter, One, Pascal, SquareMeter, Watt};
    &[
        row(Forces, PatchOutput::Force(0), "force.x", Newton, Real, "Force on the body along x", All),
        row(Forces, PatchOutput::Force(1), "force.y", Newton, Real, "Force on the body along y", All),
        row(Forces, PatchOutput::Force(2), "force.z", Newton, Real, "Force on the body along z", All),
        row(Forces, PatchOutput::Moment(0), "moment.x", NewtonMeter, Real, "Moment on the body about the pose's point along x", All),
        row(Forces, PatchOutput::Moment(1), "moment.y", NewtonMeter, Real, "Moment on the body about the pose's point along y", All),
        row(Forces, PatchOutput::Moment(2), "moment.z", NewtonMeter, Real, "Moment on the body about the pose's point along z", All),
        row(Forces, PatchOutput::TransportForce, "transport.force", Newton, Real, "Force on the tread, positive where the ground drives it to the rear", Tread),
        row(Dissipation, PatchOutput::Power, "P_diss", Watt, Real, "Dissipated power, mean over the last step", All),
        row(Dissipation, PatchOutput::Energy, "E_diss", Joule, Real, "Energy dissipated since the start", All),
        row(Dissipation, PatchOutput::SlipEnergy, "dissipation.E_slip", Joule, Real, "Energy dissipated by slip", All),
        row(Dissipation, PatchOutput::ReleaseEnergy, "dissipation.E_release", Joule, Real, "Energy lost with contacts that were released", All),
        row(Dissipation, PatchOutput::DamperEnergy, "dissipation.E_damping", Joule, Real, "Energy dissipated by damping", Damped),
        row(Contact, PatchOutput::Count, "contact.count", One, Integer, "Elements that bear", All),
        row(Contact, PatchOutput::Sticking, "contact.sticking", One, Integer, "Elements that stick", All),
        row(Contact, PatchOutput::NominalArea, "contact.nominal_area", SquareMeter, Real, "Area of the elements that bear", All),
        row(Contact, PatchOutput::RealArea, "contact.area", SquareMeter, Real, "Real area of contact by the table's contact ratio", All),
        row(Contact, PatchOutput::Pressure, "contact.pressure", Pascal, Real, "Largest pressure on an element", All),
        row(Contact, PatchOutput::Beyond, "contact.beyond", One, Real, "Share of force.z that is borne outside the table: below its least pressure, above its largest, above its speeds", All),
        row(Contact, PatchOutput::LargestTemperature, "contact.temperature_largest", Kelvin, Real, "Temperature of the warmest element that bears", Warm),
        row(Contact, PatchOutput::MeanTemperature, "contact.temperature_mean", Kelvin, Real, "Mean temperature of the elements that bear", Warm),
        row(Friction, PatchOutput::Friction, "friction.coefficient", One, Real, "Tangential force over force.z", All),
        row(Friction, PatchOutput::Hysteresis, "friction.hysteresis", One, Real, "Share of hysteresis in friction.coefficient", All),
        row(Energy, PatchOutput::ElasticEnergy, "energy.elastic", Joule, Real, "Energy stored in the springs of the elements", All),
    ]
};

#[rustfmt::skip]
const ELEMENT_FIELDS: &[PatchOutputRow<OfElement>] = {
    use OutputType::{Integer, Real};
    use PatchGroup::Elements;
    use PatchKind::{All, Warm};
    use Unit::{Kelvin, One, Pascal};
    &[
        row(Elements, PatchOutput::ElementPressure, "pressure", Pascal, Real, "Pressure on", All),
        row(Elements, |i| PatchOutput::ElementTraction(i, 0), "traction.x", Pascal, Real, "Traction along x on", All),
        row(Elements, |i| PatchOutput::ElementTraction(i, 1), "traction.y", Pascal, Real, "Traction along y on", All),
        row(Elements, PatchOutput::ElementMode, "mode", One, Integer, "Mode (0 free, 1 slipping, 2 sticking) of", All),
        row(Elements, PatchOutput::ElementTemperature, "temperature", Kelvin, Real, "Temperature of", Warm),
    ]
};

const fn row<O: Copy>(
    group: PatchGroup,
    output: O,
    name: &'static str,
    unit: Unit,
    kind: OutputType,
    description: &'static str,
    of: PatchKind,
) -> PatchOutputRow<O> {
    PatchOutputRow { group, output, name, unit, kind, description, of }
}

impl<O> PatchOutputRow<O> {
    fn variable(&self, output: PatchOutput, name: String, description: String) -> PatchVariable {
        PatchVariable { output, group: self.group, name, unit: self.unit, kind: self.kind, description }
    }

    fn entry(&self, description: String) -> PatchOutputEntry {
        PatchOutputEntry { group: self.group, name: self.name.into(), units: vec![self.unit], description, of: self.of }
    }
}

/// An output that a patch may have, for a list of all.
#[derive(Clone, Debug, PartialEq)]
pub struct PatchOutputEntry {
    /// The output group that it belongs to.
    pub group: PatchGroup,
    /// Its name; of a field of the elements the part behind `element[i].`, of the tangents one name for all.
    pub name: String,
    /// The units of its values.
    pub units: Vec<Unit>,
    /// What it is, in a few words.
    pub description: String,
    /// The patches that have it.
    pub of: PatchKind,
}

/// All outputs of patches, in the order of the variables.
pub fn catalogue() -> Vec<PatchOutputEntry> {
    let tangents = PatchOutputEntry {
        group: PatchGroup::Tangent,
        name: "tangent.LOAD.COORDINATE".into(),
        units: vec![Unit::NewtonPerMeter, Unit::NewtonPerRadian, Unit::Newton, Unit::NewtonMeterPerRadian],
        description: "Change of force.x to moment.z at the end of a step with the targets of x to yaw in it".into(),
        of: PatchKind::All,
    };
    let outputs = TABLE.iter().map(|row| row.entry(row.description.into()));
    let fields = ELEMENT_FIELDS.iter().map(|row| row.entry(format!("{} the element", row.description)));
    outputs.chain([tangents]).chain(fields).collect()
}

/// The unit of the output variable called `name`, whatever the patch; `None` for a name that no patch can have.
pub fn unit_of(name: &str) -> Option<Unit> {
    if let Some((_, field)) = name.split_once("].") {
        return ELEMENT_FIELDS.iter().find(|known| known.name == field).map(|known| known.unit);
    }
    let row = TABLE.iter().find(|row| row.name == name).map(|row| row.unit);
    row.or_else(|| tangents().into_iter().find(|tangent| tangent.name == name).map(|tangent| tangent.unit))
}

impl PatchVariable {
    /// Whether it is an output of the FMU; the fields of the elements are local variables.
    pub fn is_output(&self) -> bool {
        self.group != PatchGroup::Elements
    }
}

impl Patch {
    /// The output variables of the groups asked for, in their order.
    pub fn variables(&self) -> Vec<PatchVariable> {
        self.groups().iter().flat_map(|&group| self.variables_of(group)).collect()
    }

    /// The variables that the patch would have with every group but that of the elements and the tangents.
    pub fn all_variables(&self) -> Vec<PatchVariable> {
        use PatchGroup::{Contact, Dissipation, Energy, Forces, Friction};
        [Forces, Dissipation, Contact, Friction, Energy]
            .into_iter()
            .flat_map(|group| self.variables_of(group))
            .collect()
    }

    fn variables_of(&self, group: PatchGroup) -> Vec<PatchVariable> {
        match group {
            PatchGroup::Tangent => tangents(),
            PatchGroup::Elements => (0..self.count()).flat_map(|i| self.fields(i)).collect(),
            _ => {
                let rows = TABLE.iter().filter(|row| row.group == group && self.has(row.of));
                rows.map(|row| row.variable(row.output, row.name.into(), row.description.into())).collect()
            }
        }
    }

    fn has(&self, of: PatchKind) -> bool {
        match of {
            PatchKind::All => true,
            PatchKind::Tread => self.has_tread(),
            PatchKind::Warm => self.heat().is_some(),
            PatchKind::Damped => self.damping() > 0.0,
        }
    }

    /// The name of an element, before its variables' own.
    pub(super) fn element_name(&self, i: usize) -> String {
        match self.rows() {
            Some(rows) => format!("element[{},{}]", i / rows + 1, i % rows + 1),
            None => format!("element[{}]", i + 1),
        }
    }

    fn fields(&self, i: usize) -> impl Iterator<Item = PatchVariable> + use<'_> {
        let element = self.element_name(i);
        ELEMENT_FIELDS.iter().filter(|row| self.has(row.of)).map(move |row| {
            let (name, description) = (format!("{element}.{}", row.name), format!("{} {element}", row.description));
            row.variable((row.output)(i), name, description)
        })
    }
}

fn tangents() -> Vec<PatchVariable> {
    let variable = |i: usize| {
        let (row, column) = (i / 6, i % 6);
        let load = format!("{}.{}", if row < 3 { "force" } else { "moment" }, AXES[row % 3]);
        let coordinate = COORDINATES[column];
        let unit = match (row < 3, column < 3) {
            (true, true) => Unit::NewtonPerMeter,
            (true, false) => Unit::NewtonPerRadian,
            (false, true) => Unit::Newton,
            (false, false) => Unit::NewtonMeterPerRadian,
        };
        let description = format!("Change of {load} at the end of a step with the target of {coordinate} in it");
        let name = format!("tangent.{load}.{coordinate}");
        let (group, output) = (PatchGroup::Tangent, PatchOutput::Tangent(row, column));
        PatchVariable { output, group, name, unit, kind: OutputType::Real, description }
    };
    (0..36).map(variable).collect()
}

impl PatchRun {
    /// Writes the values of `variables`, in their order, into `values`; allocates nothing.
    pub fn evaluate(&mut self, variables: &[PatchVariable], values: &mut [f64]) {
        let of_all = |group| matches!(group, PatchGroup::Contact | PatchGroup::Friction | PatchGroup::Energy);
        let sums = if variables.iter().any(|variable| of_all(variable.group)) {
            self.element_sums()
        } else {
            ElementSums::default()
        };
        for (variable, value) in variables.iter().zip(values) {
            *value = self.value(variable.output, &sums);
        }
    }

    fn value(&mut self, output: PatchOutput, sums: &ElementSums) -> f64 {
        let totals = &self.totals;
        match output {
            PatchOutput::Force(axis) => totals.wrench[axis],
            PatchOutput::Moment(axis) => totals.wrench[3 + axis],
            PatchOutput::TransportForce => totals.transport_force,
            PatchOutput::Power => totals.power,
            PatchOutput::Energy => totals.slip_energy + totals.release_energy + totals.damper_energy,
            PatchOutput::SlipEnergy => totals.slip_energy,
            PatchOutput::ReleaseEnergy => totals.release_energy,
            PatchOutput::DamperEnergy => totals.damper_energy,
            PatchOutput::Count => sums.count as f64,
            PatchOutput::Sticking => sums.sticking as f64,
            PatchOutput::NominalArea => sums.nominal_area,
            PatchOutput::RealArea => sums.real_area,
            PatchOutput::Pressure => sums.pressure,
            PatchOutput::Beyond => share(sums.outside, sums.normal),
            PatchOutput::LargestTemperature => totals.temperature + sums.warmest,
            PatchOutput::MeanTemperature => totals.temperature + share(sums.warmth, sums.nominal_area),
            PatchOutput::Friction => share(totals.wrench[0].hypot(totals.wrench[1]), totals.wrench[2]),
            PatchOutput::Hysteresis => share(sums.hysteresis, sums.tangential),
            PatchOutput::ElasticEnergy => sums.elastic + self.normal_energy(),
            PatchOutput::Tangent(row, column) => self.tangents.as_ref().map_or(0.0, |rows| rows[row][column]),
            PatchOutput::ElementPressure(i) => self.pressure_on(i),
            PatchOutput::ElementTraction(i, axis) => self.traction_on(i, axis),
            PatchOutput::ElementMode(i) => f64::from(self.springs.mode[i]),
            PatchOutput::ElementTemperature(i) => totals.temperature + self.springs.rise(i),
        }
    }
}

fn share(part: f64, whole: f64) -> f64 {
    if whole > 0.0 { part / whole } else { 0.0 }
}
