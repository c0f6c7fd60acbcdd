//! The output variables of an element and their derivatives.

use super::jenkins::Rates;
use super::law::Contact;
use super::run::Element;
use super::table::Table;
use super::table_format::Quantity;
use crate::math::Expansion;
use crate::outputs::{Dependencies, Output, Variable, variable};

/// The variables of an element, named as a layer's, in the order of the result files.
pub fn variables(table: &Table) -> Vec<Variable> {
    let outputs = [
        (Output::ForceX, None),
        (Output::ForceZ, None),
        (Output::DissipatedPower, None),
        (Output::DissipatedEnergy, None),
        (Output::DamperEnergy, Some(Quantity::DamperPower)),
        (Output::MaxwellEnergy, Some(Quantity::MaxwellPower)),
        (Output::FrictionEnergy, Some(Quantity::FrictionPower)),
        (Output::ImpactEnergy, Some(Quantity::ImpactPower)),
        (Output::Hysteresis, Some(Quantity::Hysteresis)),
        (Output::Adhesion, Some(Quantity::Hysteresis)),
        (Output::FrictionCoefficient, None),
        (Output::ContactRatio, Some(Quantity::ContactRatio)),
    ];
    let known = outputs.into_iter().filter(|(_, needs)| needs.is_none_or(|quantity| table.has(quantity)));
    known.filter_map(|(output, _)| variable(output)).collect()
}

/// What an output depends on directly, the slider's position held while the contact sticks: F_x on u through the
/// spring, everything that depends on the pressure on w.
pub fn dependencies(output: Output) -> Dependencies {
    match output {
        Output::ForceZ | Output::ContactRatio => Dependencies { on_u: false, on_w: true },
        Output::ForceX
        | Output::DissipatedPower
        | Output::Hysteresis
        | Output::Adhesion
        | Output::FrictionCoefficient => Dependencies { on_u: true, on_w: true },
        _ => Dependencies::default(),
    }
}

/// What the outputs are computed from, or how it changes.
#[derive(Clone, Copy, Debug, Default)]
struct Snapshot {
    /// G = -F_x, N.
    force: f64,
    /// F_z, N.
    normal: f64,
    /// W
    power: f64,
    /// The share of hysteresis in the friction coefficient.
    hysteresis: f64,
    ratio: f64,
}

impl Element {
    /// Writes the values of `variables`, in their order, into `values`.
    pub fn evaluate(&self, variables: &[Variable], values: &mut [f64]) {
        let (now, state) = (self.snapshot(&self.contact()), &self.state);
        for (variable, value) in variables.iter().zip(values) {
            *value = match variable.output {
                Output::ForceX => -now.force,
                Output::ForceZ => now.normal,
                Output::DissipatedPower => now.power,
                Output::DissipatedEnergy => state.lost,
                Output::DamperEnergy => state.lost_by_channel[0],
                Output::MaxwellEnergy => state.lost_by_channel[1],
                Output::FrictionEnergy => state.lost_by_channel[2],
                Output::ImpactEnergy => state.lost_by_channel[3],
                Output::Hysteresis => -now.force * now.hysteresis,
                Output::Adhesion => -now.force * (1.0 - now.hysteresis),
                Output::FrictionCoefficient if now.normal > 0.0 => now.force.abs() / now.normal,
                Output::ContactRatio => now.ratio,
                _ => 0.0,
            };
        }
    }

    fn snapshot(&self, contact: &Contact) -> Snapshot {
        Snapshot {
            force: self.spring.force,
            normal: contact.normal.value,
            power: self.power(contact),
            hysteresis: self.hysteresis_share(contact).value,
            ratio: self.contact_ratio(contact).value,
        }
    }

    /// Writes into `values` how `variables` change as the carrier moves along x and z by `direction` (m per unit), the
    /// modes held.
    ///
    /// A sticking spring follows u with its stiffness; where w lets the stiffness fall, its force falls alike, else it
    /// stays.
    pub fn directional_derivative(&self, variables: &[Variable], direction: (f64, f64), values: &mut [f64]) {
        let contact = self.contact();
        let (now, change) = (self.snapshot(&contact), self.change(&contact, direction.0, direction.1));
        for (variable, value) in variables.iter().zip(values) {
            *value = match variable.output {
                Output::ForceX => -change.force,
                Output::ForceZ => change.normal,
                Output::DissipatedPower => change.power,
                Output::Hysteresis => -change.force * now.hysteresis - now.force * change.hysteresis,
                Output::Adhesion => -change.force * (1.0 - now.hysteresis) + now.force * change.hysteresis,
                Output::FrictionCoefficient if now.normal > 0.0 => {
                    let along = if now.force == 0.0 { 0.0 } else { now.force.signum() * change.force };
                    (along - now.force.abs() * change.normal / now.normal) / now.normal
                }
                Output::ContactRatio => change.ratio,
                _ => 0.0,
            };
        }
    }

    /// Ḟ_x and Ḟ_z, N/s, at the rates of the last motion.
    pub fn force_rates(&self) -> (f64, f64) {
        let Rates { u, approach } = self.rates();
        let change = self.change(&self.contact(), u, -approach);
        (-change.force, change.normal)
    }

    fn change(&self, contact: &Contact, du: f64, dw: f64) -> Snapshot {
        let da = -dw;
        let force = self.force_change(contact, du, da);
        Snapshot {
            force,
            normal: contact.normal.slope * da,
            power: self.power_change(contact, force, da),
            hysteresis: self.hysteresis_share(contact).slope * da,
            ratio: self.contact_ratio(contact).slope * da,
        }
    }

    fn force_change(&self, contact: &Contact, du: f64, da: f64) -> f64 {
        let k = contact.stiffness;
        if k.value <= 0.0 {
            0.0
        } else if self.spring.mode.slips() {
            self.spring.mode.direction() * contact.limit.slope * da
        } else {
            k.value * du + self.spring.force * (k.slope * da / k.value).min(0.0)
        }
    }

    /// Power lost, W: G u̇ - V̇ with V = G²/(2K), so ½ (G/K)² |K̇| while the spring sticks.
    fn power(&self, contact: &Contact) -> f64 {
        let (k, l, rates, force) = (contact.stiffness, contact.limit, self.rates(), self.spring.force);
        if k.value <= 0.0 {
            0.0
        } else if self.spring.mode.slips() {
            let stored = (l.slope - l.value * k.slope / (2.0 * k.value)) * l.value / k.value;
            force.signum() * l.value * rates.u - stored * rates.approach
        } else {
            (force / k.value).powi(2) / 2.0 * (k.slope * rates.approach).abs()
        }
    }

    fn power_change(&self, contact: &Contact, force_change: f64, da: f64) -> f64 {
        let (k, l, rates, force) = (contact.stiffness, contact.limit, self.rates(), self.spring.force);
        if k.value <= 0.0 {
            0.0
        } else if self.spring.mode.slips() {
            let (share, k_share) = (l.value / k.value, k.slope / k.value);
            let stored = (l.slope * l.slope + l.value * l.curvature) / k.value - 2.0 * share * l.slope * k_share
                + share * share * (k_share * k.slope - k.curvature / 2.0);
            (force.signum() * l.slope * rates.u - stored * rates.approach) * da
        } else {
            let q = force / k.value;
            let speed = rates.approach.abs();
            let by_force = q / k.value * force_change * k.slope.abs();
            let by_stiffness = k.slope.signum() * k.curvature / 2.0 - k.slope.abs() * k.slope / k.value;
            speed * (by_force + q * q * by_stiffness * da)
        }
    }

    /// Hysteresis over friction coefficient; 0 where there is no friction.
    fn hysteresis_share(&self, contact: &Contact) -> Expansion {
        let [part, whole] =
            [Quantity::Hysteresis, Quantity::Friction].map(|quantity| self.curve.other(quantity, contact));
        if whole.value <= 0.0 {
            return Expansion::default();
        }
        let value = part.value / whole.value;
        Expansion { value, slope: (part.slope - value * whole.slope) / whole.value, curvature: 0.0 }
    }

    fn contact_ratio(&self, contact: &Contact) -> Expansion {
        let at_table = self.curve.other(Quantity::ContactRatio, contact);
        at_table.times(self.curve.share_of_least(contact))
    }
}
