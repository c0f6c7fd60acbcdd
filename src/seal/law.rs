//! What contacts bear, let through and rub with at a gap: the rows of a sweep with gaps, at one speed and temperature.

use crate::element::{FrictionTable, Law, LawAtSpeed, Quantity};

/// A number and its derivative by the gap.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Slope {
    pub(super) value: f64,
    /// Per m of the gap.
    pub(super) slope: f64,
}

/// What a contact does at a mean gap.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct GapPoint {
    /// The pressure that contacts bear, Pa.
    pub(super) pressure: Slope,
    /// The leak gap, m.
    pub(super) leak: Slope,
    /// The drag gap, m.
    pub(super) drag: Slope,
}

/// The law of a table over the mean gap u, which is its separation: ln p, the leak and the drag gap are linear in u between
/// its rows. Beyond them ln p goes on along the last piece, and both gaps grow with u.
#[derive(Clone, Debug)]
pub(super) struct GapLaw {
    law: Law,
    at_speed: LawAtSpeed,
    temperature: f64,
    speed: f64,
    /// The mean gaps, m, rising, and at each ln p, the leak and the drag gap (m), the share of the area that touches, and
    /// the friction coefficient.
    gaps: Vec<f64>,
    rows: [Vec<f64>; 5],
    /// The least pressure of the table, Pa.
    least_pressure: f64,
    /// Whether contacts bear all and leave no gap: friction that was measured, whatever was between the surfaces.
    is_closed: bool,
}

/// The columns of [`GapLaw::rows`].
const LOG_PRESSURE: usize = 0;
const LEAK: usize = 1;
const DRAG: usize = 2;
const CONTACT: usize = 3;
const FRICTION: usize = 4;

/// Pressures below this part of the table's least count as that.
const LEAST_SHARE: f64 = 1e-6;
/// Gaps below this count as this where something is divided by them, m.
const LEAST_GAP: f64 = 1e-9;
/// The largest ln p that is taken.
const LARGEST_LOG: f64 = 60.0;

impl GapLaw {
    /// The law of a table at a temperature (K, 0 where it has none) and a speed (m/s).
    pub(super) fn new(table: &FrictionTable, temperature: f64, speed: f64) -> Self {
        let law = Law::new(table, temperature);
        let at_speed = LawAtSpeed::new(&law, speed);
        let count = table.grid.loads.len();
        let (gaps, rows, least_pressure) = (vec![0.0; count], [const { Vec::new() }; 5], table.grid.loads[0]);
        let is_closed = table.is_measured();
        let mut new = Self { law, at_speed, temperature, speed, gaps, rows, least_pressure, is_closed };
        new.rows.iter_mut().for_each(|row| row.resize(count, 0.0));
        new.fill();
        new
    }

    /// Changes temperature (K) and speed (m/s).
    pub(super) fn set(&mut self, kelvin: f64, speed: f64) {
        if kelvin == self.temperature && speed == self.speed {
            return;
        }
        if kelvin != self.temperature {
            self.law.set_temperature(kelvin);
            self.at_speed.invalidate_speed();
        }
        (self.temperature, self.speed) = (kelvin, speed);
        self.at_speed.set_speed(&self.law, speed);
        self.fill();
    }

    /// The rows by rising gap.
    fn fill(&mut self) {
        let [log_pressures, approaches, _] = self.at_speed.points();
        let rising = |values: &[f64], row: &mut [f64]| {
            row.iter_mut().zip(values.iter().rev()).for_each(|(row, value)| *row = *value);
        };
        rising(log_pressures, &mut self.rows[LOG_PRESSURE]);
        self.gaps.iter_mut().zip(approaches.iter().rev()).for_each(|(gap, approach)| *gap = -approach);
        let columns = [(LEAK, Quantity::LeakGap), (DRAG, Quantity::DragGap), (CONTACT, Quantity::ContactRatio)];
        for (row, quantity) in columns {
            if let Some([values, _]) = self.at_speed.series(quantity) {
                rising(values, &mut self.rows[row]);
            }
        }
        // Unlike an element's: a film's friction is straight between all rows.
        self.law.straight_at_speed(Quantity::Friction, self.speed, &mut self.rows[FRICTION]);
        self.rows[FRICTION].reverse();
    }

    /// Straight through the rows at either end of interval `i`.
    fn straight(&self, row: usize, i: usize, gap: f64) -> Slope {
        let (row, gaps) = (&self.rows[row], &self.gaps);
        let slope = (row[i + 1] - row[i]) / (gaps[i + 1] - gaps[i]);
        Slope { value: row[i] + slope * (gap - gaps[i]), slope }
    }

    /// The interval between the rows in which a mean gap (m) lies, or which is nearest; `near` is likely to be next to it.
    pub(super) fn interval(&self, gap: f64, near: usize) -> usize {
        let (gaps, last) = (&self.gaps, self.gaps.len() - 2);
        let mut i = near.min(last);
        while i < last && gap >= gaps[i + 1] {
            i += 1;
        }
        while i > 0 && gap < gaps[i] {
            i -= 1;
        }
        i
    }

    /// What contacts do at a mean gap (m) in its interval.
    pub(super) fn at(&self, gap: f64, i: usize) -> GapPoint {
        let last = self.gaps.len() - 1;
        let logarithm = self.straight(LOG_PRESSURE, i, gap);
        let pressure = logarithm.value.min(LARGEST_LOG).exp();
        let length = |row: usize| {
            let found = self.straight(row, i, gap);
            if gap > self.gaps[last] {
                return Slope { value: self.rows[row][last] + (gap - self.gaps[last]), slope: 1.0 };
            }
            if found.value > 0.0 { found } else { Slope::default() }
        };
        GapPoint {
            pressure: Slope { value: pressure, slope: pressure * logarithm.slope },
            leak: length(LEAK),
            drag: length(DRAG),
        }
    }

    /// The interval of the rows in which ln p lies, or which is nearest, and how far through it is.
    fn place(&self, log: f64) -> (usize, f64) {
        let logs = &self.rows[LOG_PRESSURE];
        let i = logs.partition_point(|&at| at >= log).clamp(1, logs.len() - 1) - 1;
        (i, (log - logs[i]) / (logs[i + 1] - logs[i]))
    }

    /// Whether contacts bear all and leave no gap, so that nothing flows.
    pub(super) fn is_closed(&self) -> bool {
        self.is_closed
    }

    /// The mean gap (m) at which contacts bear a pressure (Pa): 0 at the least.
    pub(super) fn gap_at(&self, pressure: f64) -> f64 {
        if self.is_closed {
            return 0.0;
        }
        let (i, share) = self.place(pressure.max(LEAST_SHARE * self.least_pressure).ln());
        (self.gaps[i] + share * (self.gaps[i + 1] - self.gaps[i])).max(0.0)
    }

    /// The friction coefficient of contacts that bear a pressure, Pa: straight over ln p, that of the table's ends beyond.
    pub(super) fn friction_at(&self, pressure: f64) -> f64 {
        let (i, share) = self.place(pressure.max(f64::MIN_POSITIVE).ln());
        let row = &self.rows[FRICTION];
        row[i] + share.clamp(0.0, 1.0) * (row[i + 1] - row[i])
    }

    /// The share of the area that does not touch over the mean gap (1/m), and the friction coefficient, at a gap (m) in its
    /// interval: straight, which is over ln p too, and those of the table's ends beyond. Below the least gap the share that
    /// is open goes to 0 with it.
    pub(super) fn open_and_friction(&self, gap: f64, i: usize) -> (Slope, f64) {
        let (low, high) = (self.gaps[i], self.gaps[i + 1]);
        let friction = self.straight(FRICTION, i, gap.clamp(low, high)).value;
        if self.is_closed {
            return (Slope::default(), friction);
        }
        let least = low.max(LEAST_GAP);
        let touches = self.straight(CONTACT, i, gap.max(least).min(high));
        let value = (1.0 - touches.value) / gap.max(least);
        let slope = if gap > high { 0.0 } else { touches.slope };
        let slope = if gap < least { 0.0 } else { -(value + slope) / gap };
        (Slope { value, slope }, friction)
    }
}
