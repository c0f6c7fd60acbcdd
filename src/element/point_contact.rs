//! The definition of an element: its table, its parameters and its outputs.

use std::iter;
use std::sync::Arc;

use super::friction_table::FrictionTable;
use super::law::{Law, LawAtSpeed};
use super::quantity::Quantity;
use crate::outputs::{Dependencies, Output, Variable, variable};
use crate::scene::{InputRule, Parameter, ParameterError, Problem, TableExtrapolation, Value};

/// The definition of an element, as a [`Scene`](crate::scene::Scene) is that of a layer: a table and the parameters
/// that a master may set.
#[derive(Clone, Debug, PartialEq)]
pub struct PointContact {
    table: Arc<FrictionTable>,
    clearance: Clearance,
    /// The temperature, K; 0 where the table has none.
    temperature: f64,
    table_extrapolation: TableExtrapolation,
    /// τ of the damper beside the spring, s.
    damping: f64,
    /// How the carrier moves on when a master gives no rates.
    pub input_rule: InputRule,
}

impl PointContact {
    /// An element of `table` at the middle one of its temperatures; motions beyond the table are refused.
    pub fn new(table: FrictionTable) -> Self {
        let temperatures = &table.grid.temperatures;
        let temperature = temperatures.get(temperatures.len() / 2).copied().unwrap_or(0.0);
        Self {
            temperature,
            clearance: Clearance::new(&table),
            table: Arc::new(table),
            table_extrapolation: TableExtrapolation::Refuse,
            damping: 0.0,
            input_rule: InputRule::default(),
        }
    }

    /// The table.
    pub fn table(&self) -> &FrictionTable {
        &self.table
    }

    /// The temperature, K; 0 where the table has none.
    pub fn temperature(&self) -> f64 {
        self.temperature
    }

    /// A displacement w (m) just above the first touch at any speed and temperature of the table.
    pub fn clear_displacement(&self) -> f64 {
        self.clearance.displacement(self.table.rest_separation)
    }

    /// What a motion beyond the table does.
    pub fn table_extrapolation(&self) -> TableExtrapolation {
        self.table_extrapolation
    }

    /// τ of the damper beside the spring, s.
    pub(super) fn damping(&self) -> f64 {
        self.damping
    }

    /// The model's name.
    pub fn name(&self) -> String {
        format!("{} element", self.table.scene())
    }

    /// What it is, in a sentence.
    pub fn description(&self) -> String {
        format!("Point-contact element from {} points {}", self.table.grid.count(), self.table.origin())
    }

    /// Its output variables.
    pub fn variables(&self) -> Vec<Variable> {
        variables(&self.table)
    }

    /// Its parameters.
    pub fn parameters(&self) -> Vec<Parameter> {
        let temperature = (self.table.grid.temperatures.len() > 1).then_some(Parameter::TEMPERATURE);
        temperature
            .into_iter()
            .chain([Parameter::TABLE_EXTRAPOLATION, Parameter::EXTRAPOLATION, Parameter::INTERVAL, Parameter::DAMPING])
            .collect()
    }

    /// The value of a parameter.
    pub fn parameter(&self, parameter: Parameter) -> Value {
        match parameter {
            Parameter::TEMPERATURE => Value::Real(self.temperature),
            Parameter::DAMPING => Value::Real(self.damping),
            _ => {
                let word = || Value::Text(self.table_extrapolation.word().into());
                self.input_rule.parameter(parameter).unwrap_or_else(word)
            }
        }
    }

    /// Gives a parameter a value.
    ///
    /// # Errors
    /// [`ParameterError`] where the value is none of those allowed; the element is then as it was.
    pub fn set_parameter(&mut self, parameter: Parameter, value: Value) -> Result<(), ParameterError> {
        let refuse = |expected: String| {
            Err(ParameterError::new(parameter.name(), Problem::Value { given: value.to_string(), expected }))
        };
        if self.input_rule.set_parameter(parameter, &value)?
            || self.table_extrapolation.set_parameter(parameter, &value)?
        {
            return Ok(());
        }
        match (parameter, &value) {
            (Parameter::DAMPING, &Value::Real(damping)) => self.damping = parameter.check_number(damping)?,
            (Parameter::TEMPERATURE, &Value::Real(temperature)) => {
                let temperatures = &self.table.grid.temperatures;
                let (low, high) = (temperatures.first(), temperatures.last());
                match (low, high) {
                    (Some(low), Some(high)) if (low..=high).contains(&&temperature) => self.temperature = temperature,
                    (Some(low), Some(high)) => {
                        return refuse(format!("a number from {low:?} to {high:?}, the temperatures of the table"));
                    }
                    _ => return refuse("none: the table has no temperatures".into()),
                }
            }
            _ => return refuse(format!("a parameter of the element: {}", self.names().join(", "))),
        }
        Ok(())
    }

    fn names(&self) -> Vec<String> {
        self.parameters().into_iter().map(Parameter::name).collect()
    }
}

/// What the outputs are computed from, or how it changes.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct OutputTerms {
    /// The force on the ground along x, -F_x, N.
    pub(super) force: f64,
    /// The normal force F_z, N.
    pub(super) normal: f64,
    /// Power lost, W.
    pub(super) power: f64,
    /// Share of hysteresis in the friction coefficient, 1.
    pub(super) hysteresis: f64,
    /// Masses in contact over all masses, 1.
    pub(super) contact_ratio: f64,
    /// Energy lost since the start, J.
    pub(super) lost: f64,
    /// Energy lost since the start by channel, J.
    pub(super) lost_by_channel: [f64; 4],
}

/// All about an output of an element.
pub(super) struct ElementOutput {
    output: Output,
    /// The quantity that the table must have.
    needs: Option<Quantity>,
    /// With the slider's position held while the contact sticks: on u through the spring, on w through the pressure.
    dependencies: Dependencies,
    /// The output's value, from those of the terms.
    pub(super) value: fn(OutputTerms) -> f64,
    /// The output's change, from the change of the terms and their values.
    pub(super) change: fn(OutputTerms, OutputTerms) -> f64,
}

const NONE: Dependencies = Dependencies { on_u: false, on_w: false };
const ON_W: Dependencies = Dependencies { on_u: false, on_w: true };
const ON_BOTH: Dependencies = Dependencies { on_u: true, on_w: true };

/// In the order of the result files.
#[rustfmt::skip]
const OUTPUTS: [ElementOutput; 12] = [
    ElementOutput { output: Output::ForceX, needs: None, dependencies: ON_BOTH,
          value: |now| -now.force, change: |change, _| -change.force },
    ElementOutput { output: Output::ForceZ, needs: None, dependencies: ON_W,
          value: |now| now.normal, change: |change, _| change.normal },
    ElementOutput { output: Output::DissipatedPower, needs: None, dependencies: ON_BOTH,
          value: |now| now.power, change: |change, _| change.power },
    ElementOutput { output: Output::DissipatedEnergy, needs: None, dependencies: NONE,
          value: |now| now.lost, change: |change, _| change.lost },
    ElementOutput { output: Output::DamperEnergy, needs: Some(Quantity::DamperPower), dependencies: NONE,
          value: |now| now.lost_by_channel[0], change: |change, _| change.lost_by_channel[0] },
    ElementOutput { output: Output::MaxwellEnergy, needs: Some(Quantity::MaxwellPower), dependencies: NONE,
          value: |now| now.lost_by_channel[1], change: |change, _| change.lost_by_channel[1] },
    ElementOutput { output: Output::FrictionEnergy, needs: Some(Quantity::FrictionPower), dependencies: NONE,
          value: |now| now.lost_by_channel[2], change: |change, _| change.lost_by_channel[2] },
    ElementOutput { output: Output::ImpactEnergy, needs: Some(Quantity::ImpactPower), dependencies: NONE,
          value: |now| now.lost_by_channel[3], change: |change, _| change.lost_by_channel[3] },
    ElementOutput { output: Output::Hysteresis, needs: Some(Quantity::Hysteresis), dependencies: ON_BOTH,
          value: |now| -now.force * now.hysteresis,
          change: |change, now| -change.force * now.hysteresis - now.force * change.hysteresis },
    ElementOutput { output: Output::Adhesion, needs: Some(Quantity::Hysteresis), dependencies: ON_BOTH,
          value: |now| -now.force * (1.0 - now.hysteresis),
          change: |change, now| -change.force * (1.0 - now.hysteresis) + now.force * change.hysteresis },
    ElementOutput { output: Output::FrictionCoefficient, needs: None, dependencies: ON_BOTH,
          value: |now| if now.normal > 0.0 { now.force.abs() / now.normal } else { 0.0 },
          change: change_of_coefficient },
    ElementOutput { output: Output::ContactRatio, needs: Some(Quantity::ContactRatio), dependencies: ON_W,
          value: |now| now.contact_ratio, change: |change, _| change.contact_ratio },
];

fn change_of_coefficient(change: OutputTerms, now: OutputTerms) -> f64 {
    if now.normal > 0.0 {
        let along = if now.force == 0.0 { 0.0 } else { now.force.signum() * change.force };
        (along - now.force.abs() * change.normal / now.normal) / now.normal
    } else {
        0.0
    }
}

pub(super) fn element_output(output: Output) -> Option<&'static ElementOutput> {
    OUTPUTS.iter().find(|known| known.output == output)
}

/// The variables of an element, named as a layer's, in the order of the result files.
pub fn variables(table: &FrictionTable) -> Vec<Variable> {
    let known = OUTPUTS.iter().filter(|known| known.needs.is_none_or(|quantity| table.has(quantity)));
    known.filter_map(|known| variable(known.output)).collect()
}

/// What an output depends on directly.
pub fn dependencies(output: Output) -> Dependencies {
    element_output(output).map_or(NONE, |known| known.dependencies)
}

/// What is added to the first touch, as a share of the way from there to the closest of the table: between the points at
/// which the touch was found it may be that much earlier.
const MARGIN: f64 = 0.01;

/// The least way that counts, m.
const LEAST_WAY: f64 = 1e-9;

/// The separation at which the contacts of a table begin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clearance {
    /// No contact reaches up to here, whatever its speed and its temperature, m.
    separation: f64,
    /// The way from the first touch to the closest separation of the table, m.
    way: f64,
}

impl Clearance {
    /// The first touch at any speed and temperature of `table`.
    pub fn new(table: &FrictionTable) -> Self {
        let temperatures = with_middles(&table.grid.temperatures, |low, high| 0.5 * (low + high));
        let speeds = with_middles(&table.grid.speeds, |low, high| (low * high).sqrt());
        let first = temperatures.first().copied().unwrap_or_default();
        let mut law = Law::new(table, first);
        let mut curve = LawAtSpeed::new(&law, speeds[0]);
        let (mut touch, mut closest) = (f64::INFINITY, f64::NEG_INFINITY);
        for kelvin in iter::once(first).chain(temperatures.into_iter().skip(1)) {
            law.set_temperature(kelvin);
            curve.invalidate_speed();
            for &speed in &speeds {
                curve.set_speed(&law, speed);
                (touch, closest) = (curve.touch.min(touch), curve.closest().max(closest));
            }
        }
        // A contact that does not give way has none.
        let way = (closest - touch).max(LEAST_WAY);
        Self { separation: MARGIN * way - touch, way }
    }

    /// The displacement (m) of a carrier that stands at `place` (m) above the plane where it is not displaced, just
    /// above the touch: a round number, higher by less than a tenth of the way that the table covers.
    pub fn displacement(&self, place: f64) -> f64 {
        round_up(self.separation - place, 0.1 * self.way)
    }
}

/// The values and the middle of each two of them.
fn with_middles(values: &[f64], middle: impl Fn(f64, f64) -> f64) -> Vec<f64> {
    let between = values.windows(2).map(|pair| middle(pair[0], pair[1]));
    values
        .iter()
        .copied()
        .zip(between.map(Some).chain(iter::once(None)))
        .flat_map(|(at, next)| iter::once(at).chain(next))
        .collect()
}

/// The next number above `value` with no digits beyond the decade of `step`, which is easier to read; `value` itself
/// where there is none.
fn round_up(value: f64, step: f64) -> f64 {
    let decade = step.log10().floor();
    let digits = (value / 10.0_f64.powf(decade)).floor() + 1.0;
    let rounded = format!("{digits}e{decade}").parse();
    rounded.ok().filter(|rounded: &f64| *rounded >= value && *rounded - value <= step).unwrap_or(value)
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::math::SplitMix64;

    /// At any speed and temperature of a table, those between its points, too; a tenth of the table's way lower some touch.
    #[test]
    fn nothing_touches_there_and_a_little_lower_something_does() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/reference/patch");
        for name in ["block.table.csv", "winkler.table.csv"] {
            let table = FrictionTable::load(&folder.join(name)).unwrap();
            let clearance = Clearance::new(&table);
            let mut random = SplitMix64::new(7);
            let mut between = |values: &[f64]| match values {
                [] => 0.0,
                values => values[0] + (values[values.len() - 1] - values[0]) * random.unit(),
            };
            let logarithms: Vec<f64> = table.grid.speeds.iter().map(|speed| speed.ln()).collect();
            let mut earliest = f64::INFINITY;
            for _ in 0..20_000 {
                let law = Law::new(&table, between(&table.grid.temperatures));
                let curve = LawAtSpeed::new(&law, between(&logarithms).exp());
                earliest = earliest.min(curve.touch);
            }
            // The carrier's own way down is from where its middle plane touches.
            for place in [0.0, 1e-4, -0.3] {
                let approach = -(clearance.displacement(place) + place);
                let lower = 0.15 * clearance.way;
                assert!(approach <= earliest && approach + lower > earliest, "{name}: {approach} {earliest}");
            }
        }
    }

    #[test]
    fn numbers_are_rounded_up_to_the_decade_of_a_step() {
        for (value, step, rounded) in
            [(1.234e-4, 2e-6, 1.24e-4), (-1.234e-4, 2e-6, -1.23e-4), (3.5e-4, 1e-4, 4e-4), (-1e-6, 2e-5, 0.0)]
        {
            assert_eq!(round_up(value, step), rounded, "{value}, {step}");
        }
        // Where a number has no such digits, or the step is none, it stays.
        for (value, step) in [(0.3, 1e-20), (0.3, 5e-324), (-0.3, 0.0), (0.3, f64::NAN), (f64::MAX, 1.0)] {
            assert_eq!(round_up(value, step), value, "{value}, {step}");
        }
    }
}
