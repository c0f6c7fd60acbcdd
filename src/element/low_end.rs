//! The low end of a table: what lies below its least load, where the law goes on as a parabola.

use super::friction_table::FrictionTable;
use super::law::{Law, LawAtSpeed};

/// What lies below the least load of a table at a speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LowEnd {
    /// How much farther away than where it bears the least load a layer touches, m.
    pub reach: f64,
    /// The share of the load that is borne below the least one, of many layers whose separations are spread evenly from
    /// the touch to that of the largest load, as those of an oblique face are.
    pub share: f64,
}

impl FrictionTable {
    /// The low end at a speed (m/s) and a temperature (K), which counts where the table has temperatures.
    pub fn low_end(&self, speed: f64, temperature: f64) -> LowEnd {
        let curve = LawAtSpeed::new(&Law::new(self, temperature), speed);
        let ends = curve.ends();
        // Simpson's rule is exact on the parabola; on the other segments, over which the pressure changes by a quarter,
        // it errs by 1e-6.
        let loads = ends.windows(2).map(|segment| {
            let at = |fraction: f64| curve.at(segment[0] + fraction * (segment[1] - segment[0])).normal.value;
            (segment[1] - segment[0]) * (at(0.0) + 4.0 * at(0.5) + at(1.0)) / 6.0
        });
        let loads: Vec<f64> = loads.collect();
        LowEnd { reach: ends[1] - ends[0], share: loads[0] / loads.iter().sum::<f64>() }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use std::path::Path;

    use super::*;

    /// Two loads a factor e apart in separations 1 µm apart: ln p is straight, so the parabola touches 2 µm beyond the
    /// lower one and bears p_1 2/3 µm, and all between bears p_1 (e - 1) µm.
    #[test]
    fn of_an_exponential_law() {
        let columns =
            "speed [m/s],pressure [Pa],temperature [K],status,friction [1],separation [m],tangential_stiffness [N/m]";
        let rows = format!("1,1e4,,steady,0.5,3e-6,1\n1,{},,steady,0.5,2e-6,1\n", 1e4 * std::f64::consts::E);
        let text =
            format!("# asperity sweep = 1\n# nominal_area = 1e-6 m2\n# rest_separation = 0 m\n{columns}\n{rows}");
        let low_end = FrictionTable::parse(&text, Path::new("t.csv")).unwrap().low_end(1.0, 0.0);
        assert!((low_end.reach - 2e-6).abs() < 1e-15, "{low_end:?}");
        let share = 2.0 / 3.0 / (2.0 / 3.0 + std::f64::consts::E - 1.0);
        assert!((low_end.share - share).abs() < 1e-6, "{low_end:?} {share}");
    }
}
