//! Where a carrier stands that is clear of the ground, just above the touch.

use std::iter;

use super::law::{Law, LawAtSpeed};
use super::table::Table;

/// What is added to the first touch, as a share of the way from there to the closest of the table: between the points at
/// which the touch was found it may be that much earlier.
const MARGIN: f64 = 0.01;

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
    pub fn new(table: &Table) -> Self {
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
        let way = closest - touch;
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
            let table = Table::load(&folder.join(name)).unwrap();
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
