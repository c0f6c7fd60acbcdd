//! The output variables of an element and their derivatives.

use super::jenkins::Rates;
use super::law::Contact;
use super::run::{Element, ElementState};
use super::table::Table;
use super::table_format::Quantity;
use crate::math::Expansion;
use crate::outputs::{Dependencies, Output, Variable, variable};

/// What the outputs are computed from, or how it changes.
#[derive(Clone, Copy, Debug, Default)]
struct Terms {
    /// G = -F_x, N.
    force: f64,
    /// F_z, N.
    normal: f64,
    /// Power lost, W.
    power: f64,
    /// Share of hysteresis in the friction coefficient, 1.
    hysteresis: f64,
    /// Masses in contact over all masses, 1.
    contact_ratio: f64,
}

/// All about one output of an element.
struct Row {
    output: Output,
    /// The quantity that the table must have.
    needs: Option<Quantity>,
    /// With the slider's position held while the contact sticks: on u through the spring, on w through the pressure.
    dependencies: Dependencies,
    value: fn(Terms, &ElementState) -> f64,
    /// Change where the terms have the second value and change by the first.
    change: fn(Terms, Terms) -> f64,
}

const NONE: Dependencies = Dependencies { on_u: false, on_w: false };
const ON_W: Dependencies = Dependencies { on_u: false, on_w: true };
const ON_BOTH: Dependencies = Dependencies { on_u: true, on_w: true };

/// In the order of the result files.
#[rustfmt::skip]
const ROWS: [Row; 12] = [
    Row { output: Output::ForceX, needs: None, dependencies: ON_BOTH,
          value: |now, _| -now.force, change: |change, _| -change.force },
    Row { output: Output::ForceZ, needs: None, dependencies: ON_W,
          value: |now, _| now.normal, change: |change, _| change.normal },
    Row { output: Output::DissipatedPower, needs: None, dependencies: ON_BOTH,
          value: |now, _| now.power, change: |change, _| change.power },
    Row { output: Output::DissipatedEnergy, needs: None, dependencies: NONE,
          value: |_, state| state.lost, change: |_, _| 0.0 },
    Row { output: Output::DamperEnergy, needs: Some(Quantity::DamperPower), dependencies: NONE,
          value: |_, state| state.lost_by_channel[0], change: |_, _| 0.0 },
    Row { output: Output::MaxwellEnergy, needs: Some(Quantity::MaxwellPower), dependencies: NONE,
          value: |_, state| state.lost_by_channel[1], change: |_, _| 0.0 },
    Row { output: Output::FrictionEnergy, needs: Some(Quantity::FrictionPower), dependencies: NONE,
          value: |_, state| state.lost_by_channel[2], change: |_, _| 0.0 },
    Row { output: Output::ImpactEnergy, needs: Some(Quantity::ImpactPower), dependencies: NONE,
          value: |_, state| state.lost_by_channel[3], change: |_, _| 0.0 },
    Row { output: Output::Hysteresis, needs: Some(Quantity::Hysteresis), dependencies: ON_BOTH,
          value: |now, _| -now.force * now.hysteresis,
          change: |change, now| -change.force * now.hysteresis - now.force * change.hysteresis },
    Row { output: Output::Adhesion, needs: Some(Quantity::Hysteresis), dependencies: ON_BOTH,
          value: |now, _| -now.force * (1.0 - now.hysteresis),
          change: |change, now| -change.force * (1.0 - now.hysteresis) + now.force * change.hysteresis },
    Row { output: Output::FrictionCoefficient, needs: None, dependencies: ON_BOTH,
          value: |now, _| if now.normal > 0.0 { now.force.abs() / now.normal } else { 0.0 },
          change: change_of_coefficient },
    Row { output: Output::ContactRatio, needs: Some(Quantity::ContactRatio), dependencies: ON_W,
          value: |now, _| now.contact_ratio, change: |change, _| change.contact_ratio },
];

fn change_of_coefficient(change: Terms, now: Terms) -> f64 {
    if now.normal > 0.0 {
        let along = if now.force == 0.0 { 0.0 } else { now.force.signum() * change.force };
        (along - now.force.abs() * change.normal / now.normal) / now.normal
    } else {
        0.0
    }
}

fn row(output: Output) -> Option<&'static Row> {
    ROWS.iter().find(|row| row.output == output)
}

/// The variables of an element, named as a layer's, in the order of the result files.
pub fn variables(table: &Table) -> Vec<Variable> {
    let known = ROWS.iter().filter(|row| row.needs.is_none_or(|quantity| table.has(quantity)));
    known.filter_map(|row| variable(row.output)).collect()
}

/// What an output depends on directly.
pub fn dependencies(output: Output) -> Dependencies {
    row(output).map_or(NONE, |row| row.dependencies)
}

impl Element {
    /// Writes the values of `variables`, in their order, into `values`; 0 for one that an element does not have.
    pub fn evaluate(&self, variables: &[Variable], values: &mut [f64]) {
        let now = self.terms(&self.contact());
        for (variable, value) in variables.iter().zip(values) {
            *value = row(variable.output).map_or(0.0, |row| (row.value)(now, &self.state));
        }
    }

    fn terms(&self, contact: &Contact) -> Terms {
        Terms {
            force: self.spring.force,
            normal: contact.normal.value,
            power: self.power(contact),
            hysteresis: self.hysteresis_share(contact).value,
            contact_ratio: self.contact_ratio(contact).value,
        }
    }

    /// Writes into `values` how `variables` change as the carrier moves along x and z by `direction` (m per unit), the
    /// modes held.
    ///
    /// The force of a sticking spring follows u with the stiffness. Where w decreases the stiffness, the force decreases
    /// in proportion, else it stays.
    pub fn directional_derivative(&self, variables: &[Variable], direction: (f64, f64), values: &mut [f64]) {
        let contact = self.contact();
        let (now, change) = (self.terms(&contact), self.change(&contact, direction.0, direction.1));
        for (variable, value) in variables.iter().zip(values) {
            *value = row(variable.output).map_or(0.0, |row| (row.change)(change, now));
        }
    }

    /// Ḟ_x and Ḟ_z, N/s, at the rates of the last motion.
    pub fn force_rates(&self) -> (f64, f64) {
        let Rates { u, approach } = self.rates();
        let change = self.change(&self.contact(), u, -approach);
        (-change.force, change.normal)
    }

    fn change(&self, contact: &Contact, du: f64, dw: f64) -> Terms {
        let da = -dw;
        let force = self.force_change(contact, du, da);
        Terms {
            force,
            normal: contact.normal.slope * da,
            power: self.power_change(contact, force, da),
            hysteresis: self.hysteresis_share(contact).slope * da,
            contact_ratio: self.contact_ratio(contact).slope * da,
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
