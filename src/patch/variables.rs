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
    /// Share of the normal force that is borne beyond the table.
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

impl PatchVariable {
    fn real(group: PatchGroup, output: PatchOutput, name: &str, unit: Unit, description: &str) -> Self {
        Self { output, group, name: name.into(), unit, kind: OutputType::Real, description: description.into() }
    }

    fn count(group: PatchGroup, output: PatchOutput, name: &str, description: &str) -> Self {
        Self { kind: OutputType::Integer, ..Self::real(group, output, name, Unit::One, description) }
    }

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
        let is_warm = self.heat().is_some();
        match group {
            PatchGroup::Elements => (0..self.count()).flat_map(|i| fields(i, &self.element_name(i), is_warm)).collect(),
            _ => variables_of(group, self.has_tread(), is_warm),
        }
    }

    /// The name of an element, before its variables' own.
    pub(super) fn element_name(&self, i: usize) -> String {
        match self.rows() {
            Some(rows) => format!("element[{},{}]", i / rows + 1, i % rows + 1),
            None => format!("element[{}]", i + 1),
        }
    }
}

/// The unit of the output variable called `name`, whatever the patch; `None` for a name that no patch can have.
pub fn unit_of(name: &str) -> Option<Unit> {
    use PatchGroup::{Contact, Dissipation, Energy, Forces, Friction, Tangent};
    let groups = [Forces, Dissipation, Contact, Friction, Energy, Tangent];
    let of_element = name.split_once("].").map(|(_, field)| format!(".{field}"));
    let variables: Vec<_> = match of_element {
        Some(_) => fields(0, "", true),
        None => groups.into_iter().flat_map(|group| variables_of(group, true, true)).collect(),
    };
    let name = of_element.as_deref().unwrap_or(name);
    variables.into_iter().find(|variable| variable.name == name).map(|variable| variable.unit)
}

/// The variables of a group but that of the elements, with a tread and of elements that slip warms or not.
fn variables_of(group: PatchGroup, has_tread: bool, is_warm: bool) -> Vec<PatchVariable> {
    use Unit::{Joule, One, Watt};
    let real = |output, name, unit, description| PatchVariable::real(group, output, name, unit, description);
    match group {
        PatchGroup::Forces => loads(has_tread),
        PatchGroup::Dissipation => vec![
            real(PatchOutput::Power, "P_diss", Watt, "Dissipated power, mean over the last step"),
            real(PatchOutput::Energy, "E_diss", Joule, "Energy dissipated since the start"),
            real(PatchOutput::SlipEnergy, "dissipation.E_slip", Joule, "Energy dissipated by slip"),
            real(
                PatchOutput::ReleaseEnergy,
                "dissipation.E_release",
                Joule,
                "Energy lost with contacts that were released",
            ),
        ],
        PatchGroup::Contact => contact(is_warm),
        PatchGroup::Friction => vec![
            real(PatchOutput::Friction, "friction.coefficient", One, "Tangential force over force.z"),
            real(PatchOutput::Hysteresis, "friction.hysteresis", One, "Share of hysteresis in friction.coefficient"),
        ],
        PatchGroup::Energy => {
            vec![real(
                PatchOutput::ElasticEnergy,
                "energy.elastic",
                Joule,
                "Energy stored in the springs of the elements",
            )]
        }
        PatchGroup::Tangent => tangents(),
        PatchGroup::Elements => Vec::new(),
    }
}

/// Counts, areas and pressure; of elements that slip warms temperatures, too.
fn contact(is_warm: bool) -> Vec<PatchVariable> {
    use Unit::{Kelvin, One, Pascal, SquareMeter};
    let group = PatchGroup::Contact;
    let real = |output, name, unit, description| PatchVariable::real(group, output, name, unit, description);
    let count = |output, name, description| PatchVariable::count(group, output, name, description);
    let mut variables = vec![
        count(PatchOutput::Count, "contact.count", "Elements that bear"),
        count(PatchOutput::Sticking, "contact.sticking", "Elements that stick"),
        real(PatchOutput::NominalArea, "contact.nominal_area", SquareMeter, "Area of the elements that bear"),
        real(PatchOutput::RealArea, "contact.area", SquareMeter, "Real area of contact by the table's contact ratio"),
        real(PatchOutput::Pressure, "contact.pressure", Pascal, "Largest pressure on an element"),
        real(PatchOutput::Beyond, "contact.beyond", One, "Share of force.z that is borne beyond the table"),
    ];
    if is_warm {
        let (largest, mean) = (PatchOutput::LargestTemperature, PatchOutput::MeanTemperature);
        let (largest_is, mean_is) =
            ("Temperature of the warmest element that bears", "Mean temperature of the elements that bear");
        variables.push(real(largest, "contact.temperature_largest", Kelvin, largest_is));
        variables.push(real(mean, "contact.temperature_mean", Kelvin, mean_is));
    }
    variables
}

fn loads(has_tread: bool) -> Vec<PatchVariable> {
    let load = |output, kind: &str, axis: usize, unit, of: &str| {
        let (name, description) = (format!("{kind}.{}", AXES[axis]), format!("{of} {}", AXES[axis]));
        PatchVariable::real(PatchGroup::Forces, output, &name, unit, &description)
    };
    let force = |axis| load(PatchOutput::Force(axis), "force", axis, Unit::Newton, "Force on the body along");
    let about = "Moment on the body about the pose's point along";
    let moment = |axis| load(PatchOutput::Moment(axis), "moment", axis, Unit::NewtonMeter, about);
    let description = "Force on the tread, positive where the ground drives it to the rear";
    let transport = || {
        PatchVariable::real(
            PatchGroup::Forces,
            PatchOutput::TransportForce,
            "transport.force",
            Unit::Newton,
            description,
        )
    };
    (0..3).map(force).chain((0..3).map(moment)).chain(has_tread.then(transport)).collect()
}

/// The variables of an element, by its index and the name before theirs, which slip warms or not.
fn fields(i: usize, element: &str, is_warm: bool) -> Vec<PatchVariable> {
    let real = |output, field: &str, unit, what: &str| {
        let name = format!("{element}.{field}");
        PatchVariable::real(PatchGroup::Elements, output, &name, unit, &format!("{what} {element}"))
    };
    let traction = |axis: usize| {
        let (field, what) = (format!("traction.{}", AXES[axis]), format!("Traction along {} on", AXES[axis]));
        real(PatchOutput::ElementTraction(i, axis), &field, Unit::Pascal, &what)
    };
    let mode = real(PatchOutput::ElementMode(i), "mode", Unit::One, "Mode (0 free, 1 slipping, 2 sticking) of");
    let mut fields = vec![
        real(PatchOutput::ElementPressure(i), "pressure", Unit::Pascal, "Pressure on"),
        traction(0),
        traction(1),
        PatchVariable { kind: OutputType::Integer, ..mode },
    ];
    if is_warm {
        fields.push(real(PatchOutput::ElementTemperature(i), "temperature", Unit::Kelvin, "Temperature of"));
    }
    fields
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
        PatchVariable::real(PatchGroup::Tangent, PatchOutput::Tangent(row, column), &name, unit, &description)
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
            PatchOutput::Energy => totals.lost[0] + totals.lost[1],
            PatchOutput::SlipEnergy => totals.lost[0],
            PatchOutput::ReleaseEnergy => totals.lost[1],
            PatchOutput::Count => sums.count as f64,
            PatchOutput::Sticking => sums.sticking as f64,
            PatchOutput::NominalArea => sums.nominal_area,
            PatchOutput::RealArea => sums.real_area,
            PatchOutput::Pressure => sums.pressure,
            PatchOutput::Beyond => share(sums.beyond, sums.normal),
            PatchOutput::LargestTemperature => totals.temperature + sums.warmest,
            PatchOutput::MeanTemperature => totals.temperature + share(sums.warmth, sums.nominal_area),
            PatchOutput::Friction => share(totals.wrench[0].hypot(totals.wrench[1]), totals.wrench[2]),
            PatchOutput::Hysteresis => share(sums.hysteresis, sums.tangential),
            PatchOutput::ElasticEnergy => sums.elastic,
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
