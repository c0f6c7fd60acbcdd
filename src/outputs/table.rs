//! The table of the outputs: one row each.
//!
//! To add an output, add a variant to [`Output`] and a row here.
//!
//! # Direct dependencies
//!
//! Which outputs depend directly on the inputs, with the states frozen? The states are the positions and velocities of
//! the masses, the dashpots' y_j and the contact modes, all in the inertial frame. The inputs u and w then enter
//! through the elongations ξ_i - u of the horizontal and ζ_i - w of the vertical links alone; rates of the inputs are
//! no inputs. So:
//!
//! - F = c e + d ė + Σ c_j (e - y_j) of a carrier link, and with it F_x or F_z, depends on its input where the link has
//!   a spring or Maxwell elements. A damper alone gives no dependency: ė is a rate.
//! - F_N = (m κ ẋ² - f_z + s f_x)/q of a mass in contact depends on w through f_z and, on a slope, on u through f_x;
//!   F_T depends on μ F_N while it slips and on f·t = (f_x + s f_z)/q while it sticks. So do the sums of the contact
//!   forces.
//! - P_maxwell = Σ c_j τ_j ẏ_j² with ẏ_j = (e - y_j)/τ_j depends on each input whose link has Maxwell elements;
//!   P_friction = Σ F_T v_t depends on F_N where there is Coulomb friction (a shear force is constant while the mass
//!   slips, and where it sticks v_t = 0); P_damper has no dependency.
//! - V depends on each input whose link has a spring or Maxwell elements, and with V `energy.residual`.
//! - T, all that is integrated and all that is counted are states or functions of states alone.

use std::mem::discriminant;

use super::carrier_shift::{CarrierShift, ContactChange};
use super::snapshot::Evaluation;
use crate::model::Mode;
use crate::scene::{Axis, CarrierBody, Input, Link, LinkKind, OutputGroup, Scene, Unit};

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

/// All that is particular to one output.
#[derive(Debug)]
pub(super) struct OutputRow {
    pub group: OutputGroup,
    /// Of the variable; of a quantity of single masses the part behind `element[i].`.
    pub name: &'static str,
    pub kind: OutputType,
    pub unit: Unit,
    pub description: &'static str,
    /// Whether a scene has it: a channel of dissipation, say, that the scene cannot have is no variable.
    pub exists: fn(&Scene) -> bool,
    /// The inputs on which it depends directly.
    pub dependencies: fn(&Scene) -> Dependencies,
    pub scope: Scope,
}

/// What an output belongs to, its value, and its derivative as the carrier is shifted; `None` if it has no direct
/// dependency.
#[derive(Debug)]
pub(super) enum Scope {
    /// A quantity of the whole layer.
    Layer {
        output: Output,
        value: fn(&Evaluation<'_, '_>) -> f64,
        derivative: Option<fn(&Evaluation<'_, '_>, &CarrierShift) -> f64>,
    },
    /// A quantity of each mass i (from 0).
    Mass {
        output: fn(usize) -> Output,
        value: fn(&Evaluation<'_, '_>, usize) -> f64,
        derivative: Option<fn(&Evaluation<'_, '_>, usize, &CarrierShift) -> f64>,
    },
}

/// Each row of the table is equal to itself alone.
impl PartialEq for OutputRow {
    fn eq(&self, other: &Self) -> bool {
        std::ptr::eq(self, other)
    }
}

impl OutputRow {
    /// The output, if it is one of the whole layer.
    pub(super) fn layer_output(&self) -> Option<Output> {
        match self.scope {
            Scope::Layer { output, .. } => Some(output),
            Scope::Mass { .. } => None,
        }
    }

    /// The output of mass `i` (from 0), if it is one of single masses.
    pub(super) fn mass_output(&self, i: usize) -> Option<Output> {
        match self.scope {
            Scope::Layer { .. } => None,
            Scope::Mass { output, .. } => Some(output(i)),
        }
    }

    /// Whether this is the row of `output`, of whichever mass.
    pub(super) fn is(&self, output: Output) -> bool {
        match self.scope {
            Scope::Layer { output: own, .. } => own == output,
            Scope::Mass { output: own, .. } => discriminant(&own(0)) == discriminant(&output),
        }
    }

    /// The value in `now`; of mass `i` if it is a quantity of single masses.
    pub(super) fn value(&self, now: &Evaluation<'_, '_>, i: usize) -> f64 {
        match self.scope {
            Scope::Layer { value, .. } => value(now),
            Scope::Mass { value, .. } => value(now, i),
        }
    }

    /// The derivative in `now` as the carrier is shifted; of mass `i` if it is a quantity of single masses.
    pub(super) fn derivative(&self, now: &Evaluation<'_, '_>, i: usize, shift: &CarrierShift) -> f64 {
        match self.scope {
            Scope::Layer { derivative, .. } => derivative.map_or(0.0, |derivative| derivative(now, shift)),
            Scope::Mass { derivative, .. } => derivative.map_or(0.0, |derivative| derivative(now, i, shift)),
        }
    }

    /// The row of a quantity that not every scene has.
    const fn only_where(mut self, exists: fn(&Scene) -> bool) -> Self {
        self.exists = exists;
        self
    }

    /// The row of a quantity of the layer that depends directly on inputs.
    const fn depending(
        mut self,
        dependencies: fn(&Scene) -> Dependencies,
        change: fn(&Evaluation<'_, '_>, &CarrierShift) -> f64,
    ) -> Self {
        self.dependencies = dependencies;
        if let Scope::Layer { derivative, .. } = &mut self.scope {
            *derivative = Some(change);
        }
        self
    }

    /// The row of a quantity of single masses that depends directly on inputs.
    const fn each_depending(
        mut self,
        dependencies: fn(&Scene) -> Dependencies,
        change: fn(&Evaluation<'_, '_>, usize, &CarrierShift) -> f64,
    ) -> Self {
        self.dependencies = dependencies;
        if let Scope::Mass { derivative, .. } = &mut self.scope {
            *derivative = Some(change);
        }
        self
    }
}

/// The row of a quantity of the whole layer.
const fn layer(
    output: Output,
    group: OutputGroup,
    name: &'static str,
    kind: OutputType,
    unit: Unit,
    description: &'static str,
    value: fn(&Evaluation<'_, '_>) -> f64,
) -> OutputRow {
    let scope = Scope::Layer { output, value, derivative: None };
    OutputRow { group, name, kind, unit, description, exists: always, dependencies: none, scope }
}

/// The row of a quantity of each mass.
const fn mass(
    output: fn(usize) -> Output,
    name: &'static str,
    kind: OutputType,
    unit: Unit,
    description: &'static str,
    value: fn(&Evaluation<'_, '_>, usize) -> f64,
) -> OutputRow {
    let group = OutputGroup::Elements;
    let scope = Scope::Mass { output, value, derivative: None };
    OutputRow { group, name, kind, unit, description, exists: always, dependencies: none, scope }
}

/// The row of the derivative of a quantity by an input, both at the end of a communication step: the quantity and its
/// name in the variable, the input and its name, the unit, the quantity in words, where its value is, and the axis of
/// the body that has it.
#[rustfmt::skip]
macro_rules! tangent {
    ($tangent:ident, $name:literal, $input:ident, $by:literal, $unit:ident, $words:literal,
     $part:ident . $field:tt $([$order:literal])? $(, on carrier.$axis:ident)?) => {
        layer(Output::Tangent(Tangent::$tangent, Input::$input), Tangents, concat!("tangent.d", $name, "_d", $by), Real, $unit,
            concat!("Derivative of ", $words, " at the end of a communication step with respect to ", $by, " there"),
            |now| now.at.tangents.by(Input::$input).$part.$field$([$order])?)
            .only_where(|scene| scene.inputs().contains(&Input::$input) $(&& scene.carrier.$axis.is_some())?)
    };
}

/// All outputs, in the order of the result files within their groups.
#[rustfmt::skip]
pub(super) static TABLE: [OutputRow; 78] = {
    use OutputType::{Integer, Real};
    use OutputGroup::{Carrier, Contact, Dissipation, Energy, Forces, Friction, Solver, Tangent as Tangents};
    use Unit::{
        Joule, Kelvin, Meter, MeterPerNewton, MeterPerNewtonSecond, MeterPerSecond, Newton, NewtonPerMeter, One, PerSecond, Second,
        SquareMeter, Watt,
    };
    [
        layer(Output::ForceX, Forces, "F_x", Real, Newton, "Force of the layer on the carrier along x",
            |now| now.at.on_carrier.x)
            .depending(elastic_x, |now, shift| now.at.force_changes(shift).x),
        layer(Output::ForceZ, Forces, "F_z", Real, Newton, "Force of the layer on the carrier along z, positive when compressed",
            |now| now.at.on_carrier.z)
            .depending(elastic_z, |now, shift| now.at.force_changes(shift).z),
        layer(Output::CarrierU, Carrier, "carrier.u", Real, Meter, "Displacement of the carrier along x",
            |now| now.at.displacement.x)
            .only_where(|scene| scene.carrier.x.is_some()),
        layer(Output::CarrierW, Carrier, "carrier.w", Real, Meter, "Displacement of the carrier along z",
            |now| now.at.displacement.z)
            .only_where(|scene| scene.carrier.z.is_some()),
        layer(Output::CarrierURate, Carrier, "carrier.u_rate", Real, MeterPerSecond, "Speed of the carrier along x",
            |now| now.at.carrier.x.speed)
            .only_where(|scene| scene.carrier.x.is_some()),
        layer(Output::CarrierWRate, Carrier, "carrier.w_rate", Real, MeterPerSecond, "Speed of the carrier along z",
            |now| now.at.carrier.z.speed)
            .only_where(|scene| scene.carrier.z.is_some()),
        layer(Output::DriveX, Carrier, "carrier.drive_x", Real, Newton, "Force of the drive on the carrier along x",
            |now| now.at.drive_force(Axis::X))
            .depending(drive_x, |now, shift| now.at.drive_force_change(Axis::X, shift))
            .only_where(|scene| has_drive(scene, Axis::X)),
        layer(Output::DriveZ, Carrier, "carrier.drive_z", Real, Newton, "Force of the drive on the carrier along z",
            |now| now.at.drive_force(Axis::Z))
            .depending(drive_z, |now, shift| now.at.drive_force_change(Axis::Z, shift))
            .only_where(|scene| has_drive(scene, Axis::Z)),
        layer(Output::DissipatedPower, Dissipation, "P_diss", Real, Watt, "Power dissipated at present",
            |now| now.at.dissipated_power())
            .depending(dissipated_power, |now, shift| now.at.maxwell_power_change(shift) + now.at.friction_power_change(shift)),
        layer(Output::DissipatedEnergy, Dissipation, "E_diss", Real, Joule, "Energy dissipated since the start, all channels",
            |now| now.at.energies.dissipated()),
        layer(Output::DamperEnergy, Dissipation, "dissipation.E_damper", Real, Joule, "Energy dissipated in dampers",
            |now| now.at.energies.channels.damper)
            .only_where(has_dampers),
        layer(Output::MaxwellEnergy, Dissipation, "dissipation.E_maxwell", Real, Joule, "Energy dissipated in Maxwell elements",
            |now| now.at.energies.channels.maxwell)
            .only_where(has_maxwell_elements),
        layer(Output::FrictionEnergy, Dissipation, "dissipation.E_friction", Real, Joule, "Energy dissipated in friction",
            |now| now.at.energies.channels.friction)
            .only_where(Scene::has_friction),
        layer(Output::CoulombEnergy, Dissipation, "dissipation.E_coulomb", Real, Joule, "Energy dissipated in friction: the part of Coulomb's law",
            |now| now.at.energies.channels.friction - now.at.energies.channels.shear - now.at.energies.channels.fine)
            .only_where(|scene| scene.has_coulomb() && scene.has_friction_parts()),
        layer(Output::ShearEnergy, Dissipation, "dissipation.E_shear", Real, Joule, "Energy dissipated in friction: the part of the shear strength",
            |now| now.at.energies.channels.shear)
            .only_where(|scene| scene.has_shear() && scene.has_friction_parts()),
        layer(Output::FineEnergy, Dissipation, "dissipation.E_fine", Real, Joule, "Energy dissipated in friction: hysteresis of the waves that the profile lacks",
            |now| now.at.energies.channels.fine)
            .only_where(Scene::has_fine_hysteresis),
        layer(Output::ImpactEnergy, Dissipation, "dissipation.E_impact", Real, Joule, "Energy dissipated in impacts",
            |now| now.at.energies.impact),
        layer(Output::Hysteresis, Friction, "friction.F_hysteresis", Real, Newton, "Tangential force by hysteresis: the tangential part of the normal contact forces on the slopes, and F_fine",
            |now| now.contact_sums().hysteresis)
            .depending(elastic, |now, shift| now.at.contact_sum(shift, ContactChange::hysteresis)),
        layer(Output::FineForce, Friction, "friction.F_fine", Real, Newton, "Tangential force by hysteresis: the part of the waves that the profile lacks",
            |now| now.contact_sums().fine)
            .depending(elastic, |now, shift| now.at.contact_sum(shift, ContactChange::fine))
            .only_where(Scene::has_fine_hysteresis),
        layer(Output::Adhesion, Friction, "friction.F_adhesion", Real, Newton, "Tangential force by adhesion: the tangential part of the friction forces in the contacts",
            |now| now.contact_sums().adhesion)
            .depending(elastic_friction, |now, shift| now.at.contact_sum(shift, ContactChange::adhesion)),
        layer(Output::CoulombForce, Friction, "friction.F_coulomb", Real, Newton, "Tangential force by adhesion: the part of Coulomb's law",
            |now| now.contact_sums().adhesion - now.contact_sums().shear)
            .depending(elastic, |now, shift| now.at.contact_sum(shift, ContactChange::coulomb))
            .only_where(|scene| scene.has_coulomb() && scene.has_shear()),
        layer(Output::ShearForce, Friction, "friction.F_shear", Real, Newton, "Tangential force by adhesion: the part of the shear strength",
            |now| now.contact_sums().shear)
            .depending(elastic, |now, shift| now.at.contact_sum(shift, ContactChange::shear))
            .only_where(|scene| scene.has_coulomb() && scene.has_shear()),
        layer(Output::FrictionCoefficient, Friction, "friction.coefficient", Real, One, "|F_x|/F_z, 0 where F_z <= 0",
            |now| now.at.friction_coefficient())
            .depending(elastic, |now, shift| now.at.friction_coefficient_change(shift)),
        layer(Output::ContactCount, Contact, "contact.count", Integer, One, "Masses in contact",
            |now| now.at.count(Mode::in_contact)),
        layer(Output::StickingCount, Contact, "contact.sticking", Integer, One, "Masses that stick",
            |now| now.at.count(|mode| mode == Mode::Stick)),
        layer(Output::ContactRatio, Contact, "contact.ratio", Real, One, "Masses in contact over all masses",
            |now| now.at.count(Mode::in_contact) / now.at.model.masses() as f64),
        layer(Output::ContactArea, Contact, "contact.area", Real, SquareMeter, "Area of the masses in contact",
            |now| now.at.count(Mode::in_contact) * now.at.model.element_area)
            .only_where(|scene| scene.layer.element_area().is_some()),
        layer(Output::RealArea, Contact, "contact.area_real", Real, SquareMeter, "Area that touches, with the roughness below the profile's",
            |now| now.contact_sums().real_area)
            .depending(elastic, |now, shift| now.at.contact_sum(shift, ContactChange::real_area))
            .only_where(|scene| scene.fine.is_some()),
        layer(Output::FlashLargest, Contact, "contact.flash_largest", Real, Kelvin, "Largest flash temperature of all masses: by how much their contacts are warmer than the layer",
            |now| now.at.flash_largest())
            .only_where(Scene::has_heat),
        layer(Output::FlashMean, Contact, "contact.flash_mean", Real, Kelvin, "Mean flash temperature of the masses in contact",
            |now| now.at.flash_mean())
            .only_where(Scene::has_heat),
        layer(Output::ContactForceX, Contact, "contact.F_x", Real, Newton, "Sum of the contact forces on the masses along x",
            |now| now.contact_sums().hysteresis + now.contact_sums().adhesion)
            .depending(elastic, |now, shift| now.at.contact_sum(shift, ContactChange::force_x)),
        layer(Output::ContactForceZ, Contact, "contact.F_z", Real, Newton, "Sum of the contact forces on the masses along z",
            |now| now.contact_sums().force_z)
            .depending(elastic, |now, shift| now.at.contact_sum(shift, ContactChange::force_z)),
        layer(Output::InputEnergy, Energy, "energy.input", Real, Joule, "Work of the carrier on the layer since the start",
            |now| now.at.energies.channels.input),
        layer(Output::KineticEnergy, Energy, "energy.kinetic", Real, Joule, "Kinetic energy of the masses",
            |now| now.kinetic_energy()),
        layer(Output::ElasticEnergy, Energy, "energy.elastic", Real, Joule, "Elastic energy of the links",
            |now| now.elastic_energy())
            .depending(elastic, |now, shift| now.at.elastic_energy_change(shift)),
        layer(Output::HeatEnergy, Energy, "energy.heat", Real, Joule, "Heat that the rubber has taken from friction since the start",
            |now| now.at.heat())
            .only_where(Scene::has_heat),
        layer(Output::CarrierKineticEnergy, Energy, "energy.carrier_kinetic", Real, Joule, "Kinetic energy of the carrier",
            |now| now.at.body_energy().kinetic)
            .only_where(|scene| scene.carrier.any()),
        layer(Output::CarrierElasticEnergy, Energy, "energy.carrier_elastic", Real, Joule, "Elastic energy of the springs from the carrier to its drives",
            |now| now.at.body_energy().elastic)
            .depending(drive_springs, |now, shift| now.at.drive_energy_change(shift))
            .only_where(|scene| any_body(scene, |body| body.stiffness.is_some())),
        layer(Output::CarrierDamperEnergy, Energy, "energy.carrier_damper", Real, Joule, "Energy dissipated in the dampers from the carrier to its drives, no part of E_diss",
            |now| now.at.energies.channels.carrier)
            .only_where(|scene| any_body(scene, |body| body.damping.is_some())),
        layer(Output::EnergyResidual, Energy, "energy.residual", Real, Joule, "Residual of the energy balance: the numerical error of the run",
            |now| now.energy_residual())
            .depending(springs, |now, shift| -(now.at.elastic_energy_change(shift) + now.at.drive_energy_change(shift))),
        tangent!(ForceX, "F_x", U, "u", NewtonPerMeter, "F_x", force.x),
        tangent!(ForceX, "F_x", W, "w", NewtonPerMeter, "F_x", force.x),
        tangent!(ForceX, "F_x", Load, "load", One, "F_x", force.x),
        tangent!(ForceX, "F_x", Pull, "pull", One, "F_x", force.x),
        tangent!(ForceZ, "F_z", U, "u", NewtonPerMeter, "F_z", force.z),
        tangent!(ForceZ, "F_z", W, "w", NewtonPerMeter, "F_z", force.z),
        tangent!(ForceZ, "F_z", Load, "load", One, "F_z", force.z),
        tangent!(ForceZ, "F_z", Pull, "pull", One, "F_z", force.z),
        tangent!(U, "carrier_u", U, "u", One, "the carrier's u", body.x[0], on carrier.x),
        tangent!(U, "carrier_u", W, "w", One, "the carrier's u", body.x[0], on carrier.x),
        tangent!(U, "carrier_u", Load, "load", MeterPerNewton, "the carrier's u", body.x[0], on carrier.x),
        tangent!(U, "carrier_u", Pull, "pull", MeterPerNewton, "the carrier's u", body.x[0], on carrier.x),
        tangent!(URate, "carrier_u_rate", U, "u", PerSecond, "the carrier's speed along x", body.x[1], on carrier.x),
        tangent!(URate, "carrier_u_rate", W, "w", PerSecond, "the carrier's speed along x", body.x[1], on carrier.x),
        tangent!(URate, "carrier_u_rate", Load, "load", MeterPerNewtonSecond, "the carrier's speed along x", body.x[1], on carrier.x),
        tangent!(URate, "carrier_u_rate", Pull, "pull", MeterPerNewtonSecond, "the carrier's speed along x", body.x[1], on carrier.x),
        tangent!(W, "carrier_w", U, "u", One, "the carrier's w", body.z[0], on carrier.z),
        tangent!(W, "carrier_w", W, "w", One, "the carrier's w", body.z[0], on carrier.z),
        tangent!(W, "carrier_w", Load, "load", MeterPerNewton, "the carrier's w", body.z[0], on carrier.z),
        tangent!(W, "carrier_w", Pull, "pull", MeterPerNewton, "the carrier's w", body.z[0], on carrier.z),
        tangent!(WRate, "carrier_w_rate", U, "u", PerSecond, "the carrier's speed along z", body.z[1], on carrier.z),
        tangent!(WRate, "carrier_w_rate", W, "w", PerSecond, "the carrier's speed along z", body.z[1], on carrier.z),
        tangent!(WRate, "carrier_w_rate", Load, "load", MeterPerNewtonSecond, "the carrier's speed along z", body.z[1], on carrier.z),
        tangent!(WRate, "carrier_w_rate", Pull, "pull", MeterPerNewtonSecond, "the carrier's speed along z", body.z[1], on carrier.z),
        layer(Output::Steps, Solver, "solver.steps", Integer, One, "Accepted steps since the start",
            |now| as_integer(now.at.counters.steps)),
        layer(Output::Events, Solver, "solver.events", Integer, One, "Mode changes since the start",
            |now| as_integer(now.at.counters.events)),
        layer(Output::Rejected, Solver, "solver.rejected", Integer, One, "Rejected steps since the start",
            |now| as_integer(now.at.counters.rejected)),
        layer(Output::Repeated, Solver, "solver.repeated", Integer, One, "Communication steps done again since the start, to the values that came",
            |now| as_integer(now.at.counters.repeated)),
        layer(Output::ForceError, Solver, "solver.error", Real, One, "Estimated accumulated error: the larger of those of F_x and F_z, each over its largest value so far",
            |now| now.at.counters.force_error()),
        layer(Output::DissipationError, Solver, "solver.error_E_diss", Real, One, "Estimated accumulated error of E_diss over its largest value so far",
            |now| now.at.counters.dissipation_error())
            .only_where(|scene| scene.outputs.contains(&Dissipation)),
        layer(Output::RunTime, Solver, "solver.run_time", Real, Second, "Processor time since the start",
            |now| now.at.run_time),
        mass(Output::ElementX, "x", Real, Meter, "Position along x of mass",
            |now, i| now.at.position(i).0),
        mass(Output::ElementZ, "z", Real, Meter, "Height of mass",
            |now, i| now.at.position(i).1),
        mass(Output::ElementNormalForce, "F_N", Real, Newton, "Normal force on mass",
            |now, i| now.at.normal_force(i))
            .each_depending(elastic, |now, i, shift| now.at.contact_change(i, shift).normal),
        mass(Output::ElementFrictionForce, "F_T", Real, Newton, "Friction force, against its velocity, on mass",
            |now, i| now.at.friction_force(i))
            .each_depending(elastic_friction, |now, i, shift| now.at.contact_change(i, shift).friction),
        mass(Output::ElementMode, "mode", Integer, One, "Mode (0 free, 1 or -1 slipping, 2 sticking) of mass",
            |now, i| f64::from(now.at.mode(i).number())),
        mass(Output::ElementFlash, "flash", Real, Kelvin, "Flash temperature of mass",
            |now, i| now.at.flash(i))
            .only_where(Scene::has_heat),
        mass(Output::ElementSpeedRemembered, "speed_remembered", Real, MeterPerSecond, "Speed of slip that friction follows of mass",
            |now, i| now.at.remembered_speed(i))
            .only_where(Scene::has_memory),
    ]
};

/// A counter as an Integer of FMI: 2³¹ - 1 at most.
fn as_integer(count: u64) -> f64 {
    count.min(i32::MAX as u64) as f64
}

fn always(_: &Scene) -> bool {
    true
}

fn any_link(scene: &Scene, test: fn(&Link) -> bool) -> bool {
    LinkKind::ALL.into_iter().any(|kind| scene.link(kind).as_ref().is_some_and(test))
}

fn has_maxwell_elements(scene: &Scene) -> bool {
    any_link(scene, |link| !link.maxwell.is_empty())
}

/// `solver.reduce` may replace a Maxwell element by a damper.
fn has_dampers(scene: &Scene) -> bool {
    any_link(scene, |link| link.damping.is_some()) || (scene.solver.reduce > 0.0 && has_maxwell_elements(scene))
}

fn has_drive(scene: &Scene, axis: Axis) -> bool {
    scene.carrier[axis].as_ref().is_some_and(CarrierBody::has_drive)
}

fn any_body(scene: &Scene, test: fn(&CarrierBody) -> bool) -> bool {
    Axis::ALL.into_iter().any(|axis| scene.carrier[axis].as_ref().is_some_and(test))
}

fn none(_: &Scene) -> Dependencies {
    Dependencies::default()
}

/// Springs and Maxwell elements of the links to the carrier.
fn elastic(scene: &Scene) -> Dependencies {
    carrier_links(scene, |link| link.stiffness.is_some() || !link.maxwell.is_empty())
}

fn elastic_x(scene: &Scene) -> Dependencies {
    Dependencies { on_w: false, ..elastic(scene) }
}

fn elastic_z(scene: &Scene) -> Dependencies {
    Dependencies { on_u: false, ..elastic(scene) }
}

fn elastic_friction(scene: &Scene) -> Dependencies {
    elastic(scene).only_if(scene.has_friction())
}

fn dissipated_power(scene: &Scene) -> Dependencies {
    let by_normal = scene.has_coulomb() || scene.fine.is_some();
    carrier_links(scene, |link| !link.maxwell.is_empty()).or(elastic(scene).only_if(by_normal))
}

/// The inputs whose links to the carrier pass `test`: u elongates the horizontal ones, w the vertical ones. A body's u
/// and w are states.
fn carrier_links(scene: &Scene, test: fn(&Link) -> bool) -> Dependencies {
    let along =
        |axis: Axis| scene.carrier[axis].as_ref().is_none() && scene.link(axis.link()).as_ref().is_some_and(test);
    Dependencies { on_u: along(Axis::X), on_w: along(Axis::Z) }
}

/// The inputs that move drives with springs to bodies.
fn drive_springs(scene: &Scene) -> Dependencies {
    let along =
        |axis: Axis| scene.carrier[axis].as_ref().is_some_and(|body| body.stiffness.is_some() && body.has_drive());
    Dependencies { on_u: along(Axis::X), on_w: along(Axis::Z) }
}

fn drive_x(scene: &Scene) -> Dependencies {
    Dependencies { on_w: false, ..drive_springs(scene) }
}

fn drive_z(scene: &Scene) -> Dependencies {
    Dependencies { on_u: false, ..drive_springs(scene) }
}

fn springs(scene: &Scene) -> Dependencies {
    elastic(scene).or(drive_springs(scene))
}
