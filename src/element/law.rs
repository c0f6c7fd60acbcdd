//! The table at one temperature, and at one speed: what the contact does as the carrier comes closer.
//!
//! Along temperature and the logarithm of speed the quantities are interpolated as they are, but the separation by its
//! differences from one pressure to the next: these are positive and stay so, so that at every speed and temperature
//! the carrier is closer where it presses harder. Along the pressure everything follows its logarithm y = ln p, and y
//! follows the approach a = -separation. Beyond the pressures of the table, with A the nominal area and p_1 and p_n the
//! least and the largest pressure:
//!
//! - Below p_1 the pressure falls as a parabola, p = p_1 ((a - a_0)/(a_1 - a_0))², with the slope that it has at p_1,
//!   so to 0 at a_0 = a_1 - 2 p_1/p_1'; there the contact ends. Tangential stiffness and contact ratio fall with the
//!   pressure, the friction coefficient stays.
//! - Above p_n it goes on along its tangent; the coefficients, the tangential stiffness and the contact ratio stay.
//!
//! Below the least speed of the table everything is as at the least, above the largest as at the largest.

use super::table::{Load, Quantity, Table};
use crate::math::{Expansion, cubic, interval_of, monotone_slopes};

/// The most that y changes over one piece of the approach. Over it the limit of the friction force is so near to a
/// polynomial that Gauss's formula of six points gives its integral to rounding.
const LONGEST_PIECE: f64 = 0.25;

/// A quantity at the speeds of one pressure, with its slopes along the logarithm of speed.
#[derive(Clone, Debug)]
struct Row {
    values: Vec<f64>,
    slopes: Vec<f64>,
}

/// The table at one temperature.
#[derive(Clone, Debug)]
pub(super) struct Law {
    /// A, m².
    pub(super) nominal_area: f64,
    /// m
    pub(super) rest_separation: f64,
    /// The speeds' logarithms.
    speeds: Vec<f64>,
    /// The least and the largest speed, m/s.
    pub(super) speed_range: (f64, f64),
    /// The pressures' logarithms.
    pressures: Vec<f64>,
    /// What the loads are.
    pub(super) load: Load,
    /// The largest pressure, Pa, or force, N.
    pub(super) largest_pressure: f64,
    /// By quantity, where the table knows it, and pressure.
    rows: [Option<Vec<Row>>; Quantity::ALL.len()],
}

impl Law {
    /// The table at `temperature` (K), where it has temperatures.
    pub(super) fn new(table: &Table, temperature: f64) -> Self {
        let speeds: Vec<f64> = table.speeds.iter().map(|speed| speed.ln()).collect();
        let rows = Quantity::ALL.map(|quantity| {
            let row = |i| {
                let values: Vec<f64> =
                    (0..speeds.len()).map(|j| at_temperature(table, quantity, (i, j), temperature)).collect();
                let mut slopes = vec![0.0; values.len()];
                monotone_slopes(&speeds, &values, &mut slopes);
                Row { values, slopes }
            };
            table.has(quantity).then(|| (0..table.pressures.len()).map(row).collect())
        });
        Self {
            nominal_area: table.nominal_area,
            rest_separation: table.rest_separation,
            speed_range: (table.speeds[0], table.speeds[table.speeds.len() - 1]),
            speeds,
            pressures: table.pressures.iter().map(|pressure| pressure.ln()).collect(),
            load: table.load,
            largest_pressure: table.pressures[table.pressures.len() - 1],
            rows,
        }
    }

    /// Writes the values of a quantity at all pressures, at a speed between those of the table.
    fn at_speed(&self, rows: &[Row], speed: f64, values: &mut [f64]) {
        if self.speeds.len() == 1 {
            return values.iter_mut().zip(rows).for_each(|(value, row)| *value = row.values[0]);
        }
        let x = speed.ln();
        let j = interval_of(&self.speeds, x);
        for (value, row) in values.iter_mut().zip(rows) {
            let point = |j: usize| (self.speeds[j], row.values[j], row.slopes[j]);
            *value = cubic(point(j), point(j + 1), x).value;
        }
    }
}

/// What is interpolated of a quantity at a pressure and a speed: of the separation its difference to the next pressure.
fn node(table: &Table, quantity: Quantity, (temperature, pressure, speed): (usize, usize, usize)) -> f64 {
    let here = table.value(quantity, (temperature, pressure, speed));
    if quantity == Quantity::Separation && pressure + 1 < table.pressures.len() {
        here - table.value(quantity, (temperature, pressure + 1, speed))
    } else {
        here
    }
}

fn at_temperature(table: &Table, quantity: Quantity, (i, j): (usize, usize), temperature: f64) -> f64 {
    let temperatures = &table.temperatures;
    if temperatures.len() < 2 {
        return node(table, quantity, (0, i, j));
    }
    let values: Vec<f64> = (0..temperatures.len()).map(|k| node(table, quantity, (k, i, j))).collect();
    let mut slopes = vec![0.0; values.len()];
    monotone_slopes(temperatures, &values, &mut slopes);
    let k = interval_of(temperatures, temperature);
    let point = |k: usize| (temperatures[k], values[k], slopes[k]);
    cubic(point(k), point(k + 1), temperature).value
}

/// A quantity at the pressures, with its slopes along y.
#[derive(Clone, Debug)]
struct Column {
    values: Vec<f64>,
    slopes: Vec<f64>,
}

/// The law at one speed.
#[derive(Clone, Debug)]
pub(super) struct Curve {
    /// The speed, between the least and the largest of the table, m/s.
    speed: f64,
    /// y = ln p at the pressures.
    pressures: Vec<f64>,
    /// The approaches at the pressures, m, rising.
    approaches: Vec<f64>,
    /// dy/da there, 1/m.
    slopes: Vec<f64>,
    /// a_0, m: where the contact begins.
    pub(super) touch: f64,
    columns: [Option<Column>; Quantity::ALL.len()],
    /// The ends of the pieces that the approach is taken in, m, rising.
    ends: Vec<f64>,
    nominal_area: f64,
}

impl Curve {
    /// The law at `speed` (m/s).
    pub(super) fn new(law: &Law, speed: f64) -> Self {
        let n = law.pressures.len();
        let column =
            |rows: &Option<Vec<Row>>| rows.as_ref().map(|_| Column { values: vec![0.0; n], slopes: vec![0.0; n] });
        let mut curve = Self {
            speed: f64::NAN,
            pressures: law.pressures.clone(),
            approaches: vec![0.0; n],
            slopes: vec![0.0; n],
            touch: 0.0,
            columns: std::array::from_fn(|quantity| column(&law.rows[quantity])),
            ends: Vec::with_capacity(1 + law.pressures.windows(2).map(|y| 1 + pieces(y[0], y[1])).sum::<usize>()),
            nominal_area: law.nominal_area,
        };
        curve.set_speed(law, speed);
        curve
    }

    /// Goes over to another speed, m/s.
    pub(super) fn set_speed(&mut self, law: &Law, speed: f64) {
        let speed = speed.abs().clamp(law.speed_range.0, law.speed_range.1);
        if speed == self.speed {
            return;
        }
        self.speed = speed;
        for (column, rows) in self.columns.iter_mut().zip(&law.rows) {
            let (Some(column), Some(rows)) = (column, rows) else { continue };
            law.at_speed(rows, speed, &mut column.values);
            monotone_slopes(&self.pressures, &column.values, &mut column.slopes);
        }
        self.find_approaches();
        self.divide();
    }

    /// From the separations' differences.
    fn find_approaches(&mut self) {
        let Some(differences) = &self.columns[Quantity::Separation as usize] else { return };
        let mut separation = 0.0;
        for (approach, difference) in self.approaches.iter_mut().zip(&differences.values).rev() {
            separation += difference;
            *approach = -separation;
        }
        monotone_slopes(&self.approaches, &self.pressures, &mut self.slopes);
        // The force goes on from the ends with these, so they may not vanish.
        let last = self.slopes.len() - 1;
        let secant =
            |i: usize| (self.pressures[i + 1] - self.pressures[i]) / (self.approaches[i + 1] - self.approaches[i]);
        self.slopes[0] = self.slopes[0].max(LEAST_END_SLOPE * secant(0));
        self.slopes[last] = self.slopes[last].max(LEAST_END_SLOPE * secant(last - 1));
        self.touch = self.approaches[0] - 2.0 / self.slopes[0];
    }

    /// Between two pressures into even pieces: the same wherever a step begins.
    fn divide(&mut self) {
        self.ends.clear();
        self.ends.push(self.touch);
        for (y, a) in self.pressures.windows(2).zip(self.approaches.windows(2)) {
            let count = pieces(y[0], y[1]);
            self.ends.extend((0..count).map(|i| a[0] + (a[1] - a[0]) * i as f64 / count as f64));
        }
        self.ends.push(self.approaches[self.approaches.len() - 1]);
    }

    /// The end of the piece that the carrier goes through as it leaves `approach` to come closer, or to go; infinite
    /// where there is none.
    pub(super) fn end_of_piece(&self, approach: f64, closer: bool) -> f64 {
        if closer {
            let next = self.ends.partition_point(|&end| end <= approach);
            self.ends.get(next).copied().unwrap_or(f64::INFINITY)
        } else {
            let next = self.ends.partition_point(|&end| end < approach);
            if next == 0 { f64::NEG_INFINITY } else { self.ends[next - 1] }
        }
    }

    /// The approach at the largest pressure of the table, m.
    pub(super) fn closest(&self) -> f64 {
        self.approaches[self.approaches.len() - 1]
    }

    /// The speed as far as the table goes, m/s.
    pub(super) fn speed(&self) -> f64 {
        self.speed
    }

    /// The contact at an approach, m.
    pub(super) fn at(&self, approach: f64) -> Contact {
        let last = self.approaches.len() - 1;
        if approach <= self.touch {
            return Contact { y: Expansion::constant(self.pressures[0]), ..Contact::default() };
        }
        if approach < self.approaches[0] {
            self.below(approach)
        } else if approach > self.approaches[last] {
            self.above(approach)
        } else {
            self.inside(approach)
        }
    }

    fn inside(&self, approach: f64) -> Contact {
        let i = interval_of(&self.approaches, approach);
        let point = |i: usize| (self.approaches[i], self.pressures[i], self.slopes[i]);
        let y = cubic(point(i), point(i + 1), approach);
        let friction = self.along_pressure(Quantity::Friction, i, y.value).of(y);
        let normal = y.exp().times(Expansion::constant(self.nominal_area));
        Contact {
            y,
            normal,
            limit: friction.times(normal),
            stiffness: self.along_pressure(Quantity::Stiffness, i, y.value).of(y),
        }
    }

    fn below(&self, approach: f64) -> Contact {
        let width = self.approaches[0] - self.touch;
        let share = (approach - self.touch) / width;
        let parabola = Expansion { value: share * share, slope: 2.0 * share / width, curvature: 2.0 / (width * width) };
        let of = |value| parabola.times(Expansion::constant(value));
        let force = self.nominal_area * self.pressures[0].exp();
        Contact {
            y: Expansion::constant(self.pressures[0]),
            normal: of(force),
            limit: of(self.end(Quantity::Friction, 0) * force),
            stiffness: of(self.end(Quantity::Stiffness, 0)),
        }
    }

    fn above(&self, approach: f64) -> Contact {
        let last = self.approaches.len() - 1;
        let force = self.nominal_area * self.pressures[last].exp();
        let slope = self.slopes[last] * force;
        let value = force + slope * (approach - self.approaches[last]);
        let normal = Expansion { value, slope, curvature: 0.0 };
        Contact {
            y: Expansion::constant(self.pressures[last]),
            normal,
            limit: normal.times(Expansion::constant(self.end(Quantity::Friction, last))),
            stiffness: Expansion::constant(self.end(Quantity::Stiffness, last)),
        }
    }

    /// A quantity over y in the interval `i` of the pressures.
    fn along_pressure(&self, quantity: Quantity, i: usize, y: f64) -> Expansion {
        let Some(column) = &self.columns[quantity as usize] else { return Expansion::default() };
        let point = |i: usize| (self.pressures[i], column.values[i], column.slopes[i]);
        cubic(point(i), point(i + 1), y)
    }

    /// A quantity at the pressure `i`.
    fn end(&self, quantity: Quantity, i: usize) -> f64 {
        self.columns[quantity as usize].as_ref().map_or(0.0, |column| column.values[i])
    }

    /// A quantity at a pressure, Pa, as far as the table goes.
    pub(super) fn at_pressure(&self, quantity: Quantity, pressure: f64) -> f64 {
        let last = self.pressures.len() - 1;
        let y = pressure.ln().clamp(self.pressures[0], self.pressures[last]);
        self.along_pressure(quantity, interval_of(&self.pressures, y), y).value
    }

    /// The pressure over the least of the table, at most 1: what else falls with it below.
    pub(super) fn share_of_least(&self, contact: &Contact) -> Expansion {
        let force = self.nominal_area * self.pressures[0].exp();
        if contact.normal.value >= force {
            return Expansion::constant(1.0);
        }
        contact.normal.times(Expansion::constant(1.0 / force))
    }

    /// Another quantity where the contact is `contact`, along the approach; 0 where the table does not know it.
    pub(super) fn other(&self, quantity: Quantity, contact: &Contact) -> Expansion {
        let i = interval_of(&self.pressures, contact.y.value);
        self.along_pressure(quantity, i, contact.y.value).of(contact.y)
    }
}

/// The least slope of y at the ends, as a share of the secant beside them.
const LEAST_END_SLOPE: f64 = 0.5;

/// Into how many pieces the approaches between two pressures are divided.
fn pieces(from: f64, to: f64) -> usize {
    ((to - from) / LONGEST_PIECE).ceil().max(1.0) as usize
}

/// What the contact bears at one approach and speed, along the approach a.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Contact {
    /// y = ln p as far as the table goes.
    y: Expansion,
    /// F_z = A p, N.
    pub(super) normal: Expansion,
    /// μ F_z, N.
    pub(super) limit: Expansion,
    /// Tangential stiffness, N/m; 0 without contact.
    pub(super) stiffness: Expansion,
}
