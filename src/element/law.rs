//! The contact law of an element: the table interpolated over temperature, speed and the carrier's approach.
//!
//! Along temperature and the logarithm of speed, the separation is interpolated by its differences from one pressure to
//! the next: these stay positive, so that at every speed and temperature the carrier is closer where it presses harder.
//! All other quantities are interpolated directly. Along the pressure p, everything is a function of its logarithm y =
//! ln p, and y of the approach a = -separation. Beyond the pressures of the table, p_1 to p_n:
//!
//! - Below p_1 the pressure is a parabola, p = p_1 ((a - a_0)/(a_1 - a_0))², with the slope that it has at p_1; it is 0
//!   at a_0 = a_1 - 2 p_1/p_1', where the contact ends. Tangential stiffness and contact ratio are proportional to the
//!   pressure, the friction coefficient is constant.
//! - Above p_n the pressure follows its tangent; the coefficients, the tangential stiffness and the contact ratio are
//!   constant.
//!
//! Below the least speed of the table everything is as at the least, above the largest as at the largest.

use super::friction_table::{FrictionTable, Node};
use super::grid::Load;
use super::quantity::Quantity;
use crate::math::{Expansion, cubic, interval_of, monotone_slopes};

/// Largest change of y over one segment of the approach: over it the limit of the friction force is so close to a
/// polynomial that Gauss's formula of six points gives its integral to rounding.
const MAX_SEGMENT: f64 = 0.25;

/// Values along an axis with their slopes along it.
#[derive(Clone, Debug)]
struct Series {
    values: Vec<f64>,
    slopes: Vec<f64>,
}

impl Series {
    fn new(x: &[f64], values: Vec<f64>) -> Self {
        let mut slopes = vec![0.0; values.len()];
        monotone_slopes(x, &values, &mut slopes);
        Self { values, slopes }
    }

    /// The largest second derivative of the cubic over interval `i` of `x`: it is straight, largest at an end.
    fn bend(&self, x: &[f64], i: usize) -> f64 {
        let h = x[i + 1] - x[i];
        let secant = (self.values[i + 1] - self.values[i]) / h;
        let (before, after) = (self.slopes[i], self.slopes[i + 1]);
        (6.0 * secant - 4.0 * before - 2.0 * after).abs().max((6.0 * secant - 2.0 * before - 4.0 * after).abs()) / h
    }

    /// The smaller of the values at the ends of interval `i`.
    fn least(&self, i: usize) -> f64 {
        self.values[i].min(self.values[i + 1])
    }

    /// The value at `at`, between two of `x`, and how it changes there.
    fn at(&self, x: &[f64], i: usize, at: f64) -> Expansion {
        cubic(x, &self.values, &self.slopes, i, at)
    }
}

/// The law at one temperature.
#[derive(Clone, Debug)]
pub(crate) struct Law {
    /// A, m².
    pub(super) nominal_area: f64,
    /// Separation at w = 0, m.
    pub(super) rest_separation: f64,
    /// Temperatures, K.
    temperatures: Vec<f64>,
    /// By quantity, where the table has it, pressure and speed.
    over_temperature: [Option<Vec<Series>>; Quantity::ALL.len()],
    /// Logarithms of the speeds.
    log_speeds: Vec<f64>,
    /// The least and the largest speed, m/s.
    pub(super) speed_range: (f64, f64),
    /// Logarithms of the pressures.
    log_pressures: Vec<f64>,
    pub(super) load: Load,
    /// The largest pressure, Pa, or force, N.
    pub(super) largest_pressure: f64,
    /// Over the logarithm of speed at the present temperature: by quantity, where the table has it, and pressure.
    over_speed: [Option<Vec<Series>>; Quantity::ALL.len()],
}

impl Law {
    /// The table at `temperature` (K), where it has temperatures.
    pub(crate) fn new(table: &FrictionTable, temperature: f64) -> Self {
        let grid = &table.grid;
        let (speeds, loads) = (grid.speeds.len(), grid.loads.len());
        let cell = |quantity, index: usize| {
            let node = Node { temperature: 0, load: index / speeds, speed: index % speeds };
            along_temperature(table, quantity, node)
        };
        let cells = Quantity::ALL
            .map(|quantity| table.has(quantity).then(|| (0..loads * speeds).map(|i| cell(quantity, i)).collect()));
        let row = Series { values: vec![0.0; speeds], slopes: vec![0.0; speeds] };
        let mut law = Self {
            nominal_area: table.load.area(),
            rest_separation: table.rest_separation,
            temperatures: grid.temperatures.clone(),
            over_speed: Quantity::ALL.map(|quantity| table.has(quantity).then(|| vec![row.clone(); loads])),
            over_temperature: cells,
            speed_range: (grid.speeds[0], grid.speeds[speeds - 1]),
            log_speeds: grid.speeds.iter().map(|speed| speed.ln()).collect(),
            log_pressures: grid.loads.iter().map(|pressure| pressure.ln()).collect(),
            load: table.load,
            largest_pressure: grid.loads[loads - 1],
        };
        law.set_temperature(temperature);
        law
    }

    /// Changes the temperature, K; allocates nothing.
    pub(crate) fn set_temperature(&mut self, kelvin: f64) {
        let (log_speeds, temperatures) = (&self.log_speeds, &self.temperatures);
        let at = |cell: &Series| match temperatures.len() {
            0 | 1 => cell.values[0],
            _ => cell.at(temperatures, interval_of(temperatures, kelvin), kelvin).value,
        };
        for (rows, cells) in self.over_speed.iter_mut().zip(&self.over_temperature) {
            let (Some(rows), Some(cells)) = (rows, cells) else { continue };
            for (row, cells) in rows.iter_mut().zip(cells.chunks(log_speeds.len())) {
                row.values.iter_mut().zip(cells).for_each(|(value, cell)| *value = at(cell));
                monotone_slopes(log_speeds, &row.values, &mut row.slopes);
            }
        }
    }

    /// The largest second derivative with the temperature of ln p at a separation, or of ln μ, at the table's points,
    /// 1/K²; 0 where it has one temperature. The separation is that of a face with a backing, whose p/k_n at the pressures
    /// are given (m), none without one.
    pub(super) fn bend_over_temperature(&self, indentations: &[f64]) -> f64 {
        let (temperatures, speeds) = (&self.temperatures, self.log_speeds.len());
        let cells = |quantity: Quantity| self.over_temperature[quantity as usize].as_deref().unwrap_or_default();
        let (friction, differences) = (cells(Quantity::Friction), cells(Quantity::Separation));
        let mut largest = 0.0_f64;
        for i in 0..temperatures.len().saturating_sub(1) {
            let of_friction = friction.iter().map(|cell| cell.bend(temperatures, i) / cell.least(i).abs());
            largest = of_friction.filter(|bend| bend.is_finite()).fold(largest, f64::max);
            for speed in 0..speeds {
                // From the largest pressure, where the separation is a value, down its differences add up.
                let mut bend_of_separation = 0.0;
                for load in (0..self.log_pressures.len()).rev() {
                    bend_of_separation += differences[load * speeds + speed].bend(temperatures, i);
                    let from = load.min(self.log_pressures.len() - 2);
                    let behind = indentations.get(from..from + 2).map_or(0.0, |ends| ends[1] - ends[0]);
                    let slope = (self.log_pressures[from + 1] - self.log_pressures[from])
                        / (differences[from * speeds + speed].least(i) + behind);
                    largest = largest.max(slope * bend_of_separation);
                }
            }
        }
        largest
    }

    /// Approaches (m) at which there is no contact at any speed reach up to here.
    pub(super) fn earliest_touch(&self) -> f64 {
        let Some(rows) = &self.over_speed[Quantity::Separation as usize] else { return f64::NEG_INFINITY };
        let step = self.log_pressures[1] - self.log_pressures[0];
        // Between two speeds a difference of separations is no larger than at one of them.
        let touch = |j: usize| {
            let larger = |row: &Series| row.values[j].max(row.values[(j + 1).min(self.log_speeds.len() - 1)]);
            let widest = 2.0 * larger(&rows[0]) / (MIN_END_SLOPE * step);
            -rows.iter().map(larger).sum::<f64>() - widest
        };
        (0..self.log_speeds.len()).map(touch).fold(f64::INFINITY, f64::min)
    }

    /// The logarithms of the speeds.
    pub(super) fn log_speeds(&self) -> &[f64] {
        &self.log_speeds
    }

    /// The speed that the law has at `speed` (m/s): the table's that is nearest.
    fn speed_in_table(&self, speed: f64) -> f64 {
        speed.abs().clamp(self.speed_range.0, self.speed_range.1)
    }

    /// Writes the values of a quantity at all pressures straight between the logarithms of the speeds, where the table has it.
    pub(crate) fn straight_at_speed(&self, quantity: Quantity, speed: f64, values: &mut [f64]) {
        let Some(rows) = &self.over_speed[quantity as usize] else { return };
        let (x, logs) = (self.speed_in_table(speed).ln(), &self.log_speeds);
        let (j, next) = (interval_of(logs, x), logs.len().min(2) - 1);
        let share = if next == 0 { 0.0 } else { (x - logs[j]) / (logs[j + 1] - logs[j]) };
        for (value, row) in values.iter_mut().zip(rows) {
            *value = row.values[j] + share * (row.values[j + next] - row.values[j]);
        }
    }

    /// Writes the values of a quantity at all pressures, at a speed between those of the table.
    fn at_speed(&self, rows: &[Series], speed: f64, values: &mut [f64]) {
        if self.log_speeds.len() == 1 {
            return values.iter_mut().zip(rows).for_each(|(value, row)| *value = row.values[0]);
        }
        let x = speed.ln();
        let j = interval_of(&self.log_speeds, x);
        values.iter_mut().zip(rows).for_each(|(value, row)| *value = row.at(&self.log_speeds, j, x).value);
    }
}

/// What is interpolated: the value of a quantity; for the separation, its difference to the next pressure.
fn interpolated(table: &FrictionTable, quantity: Quantity, node: Node) -> f64 {
    let here = table.value(quantity, node);
    if quantity == Quantity::Separation && node.load + 1 < table.grid.loads.len() {
        here - table.value(quantity, Node { load: node.load + 1, ..node })
    } else {
        here
    }
}

/// What is interpolated at all temperatures of the table, whatever that of `node` is.
fn along_temperature(table: &FrictionTable, quantity: Quantity, node: Node) -> Series {
    let temperatures = &table.grid.temperatures;
    let of = |temperature| interpolated(table, quantity, Node { temperature, ..node });
    Series::new(temperatures, (0..temperatures.len().max(1)).map(of).collect())
}

/// The law at one speed, over the approach.
#[derive(Clone, Debug)]
pub(crate) struct LawAtSpeed {
    /// The speed, between the least and the largest of the table, m/s.
    speed: f64,
    /// y = ln p at the pressures.
    log_pressures: Vec<f64>,
    /// The approaches at the pressures, m, rising.
    approaches: Vec<f64>,
    /// dy/da there, 1/m.
    slopes: Vec<f64>,
    /// a_0, m: where the contact begins.
    pub(super) touch: f64,
    /// By quantity, where the table has it, over y.
    over_pressure: [Option<Series>; Quantity::ALL.len()],
    /// The ends of the segments into which the approach is divided, m, rising.
    ends: Vec<f64>,
    nominal_area: f64,
}

impl LawAtSpeed {
    /// The law at `speed` (m/s).
    pub(crate) fn new(law: &Law, speed: f64) -> Self {
        let n = law.log_pressures.len();
        let column =
            |rows: &Option<Vec<Series>>| rows.as_ref().map(|_| Series { values: vec![0.0; n], slopes: vec![0.0; n] });
        let mut curve = Self {
            speed: f64::NAN,
            log_pressures: law.log_pressures.clone(),
            approaches: vec![0.0; n],
            slopes: vec![0.0; n],
            touch: 0.0,
            over_pressure: std::array::from_fn(|quantity| column(&law.over_speed[quantity])),
            ends: Vec::with_capacity(
                1 + law.log_pressures.windows(2).map(|y| 1 + segment_count(y[0], y[1])).sum::<usize>(),
            ),
            nominal_area: law.nominal_area,
        };
        curve.set_speed(law, speed);
        curve
    }

    /// Whether it is the law at `speed` (m/s).
    pub(crate) fn is_at(&self, law: &Law, speed: f64) -> bool {
        law.speed_in_table(speed) == self.speed
    }

    /// Changes the speed, m/s.
    pub(crate) fn set_speed(&mut self, law: &Law, speed: f64) {
        let speed = law.speed_in_table(speed);
        if speed == self.speed {
            return;
        }
        self.speed = speed;
        for (column, rows) in self.over_pressure.iter_mut().zip(&law.over_speed) {
            let (Some(column), Some(rows)) = (column, rows) else { continue };
            law.at_speed(rows, speed, &mut column.values);
            monotone_slopes(&self.log_pressures, &column.values, &mut column.slopes);
        }
        self.find_approaches();
        self.divide();
    }

    /// The law has changed: the speed set next is computed even if it is the present one.
    pub(crate) fn invalidate_speed(&mut self) {
        self.speed = f64::NAN;
    }

    fn find_approaches(&mut self) {
        let Some(differences) = &self.over_pressure[Quantity::Separation as usize] else { return };
        let mut separation = 0.0;
        for (approach, difference) in self.approaches.iter_mut().zip(&differences.values).rev() {
            separation += difference;
            *approach = -separation;
        }
        monotone_slopes(&self.approaches, &self.log_pressures, &mut self.slopes);
        // The force is extrapolated with the slopes at the ends, so they may not vanish.
        let last = self.slopes.len() - 1;
        let secant = |i: usize| {
            (self.log_pressures[i + 1] - self.log_pressures[i]) / (self.approaches[i + 1] - self.approaches[i])
        };
        self.slopes[0] = self.slopes[0].max(MIN_END_SLOPE * secant(0));
        self.slopes[last] = self.slopes[last].max(MIN_END_SLOPE * secant(last - 1));
        self.touch = self.approaches[0] - 2.0 / self.slopes[0];
    }

    /// Divides the approaches between two pressures into even segments, the same wherever a step begins.
    fn divide(&mut self) {
        self.ends.clear();
        self.ends.push(self.touch);
        for (y, a) in self.log_pressures.windows(2).zip(self.approaches.windows(2)) {
            let count = segment_count(y[0], y[1]);
            self.ends.extend((0..count).map(|i| a[0] + (a[1] - a[0]) * i as f64 / count as f64));
        }
        self.ends.push(self.approaches[self.approaches.len() - 1]);
    }

    /// The ends of the segments of the approach, m, rising: the first begins where the contact does and ends at the
    /// least pressure, the last ends at the largest.
    pub(super) fn ends(&self) -> &[f64] {
        &self.ends
    }

    /// The end of the segment that the carrier enters as it moves from `approach` towards `target` (m); infinite where
    /// there is none.
    pub(super) fn end_of_segment(&self, approach: f64, target: f64) -> f64 {
        if target > approach {
            let next = self.ends.partition_point(|&end| end <= approach);
            self.ends.get(next).copied().unwrap_or(f64::INFINITY)
        } else {
            let next = self.ends.partition_point(|&end| end < approach);
            if next == 0 { f64::NEG_INFINITY } else { self.ends[next - 1] }
        }
    }

    /// y = ln p at the pressures, the approaches (m) there and dy/da (1/m).
    pub(crate) fn points(&self) -> [&[f64]; 3] {
        [&self.log_pressures, &self.approaches, &self.slopes]
    }

    /// The values of a quantity at the pressures and its slopes over y, where the table has it.
    pub(crate) fn series(&self, quantity: Quantity) -> Option<[&[f64]; 2]> {
        self.over_pressure[quantity as usize].as_ref().map(|column| [&column.values[..], &column.slopes])
    }

    /// The approach at the largest pressure of the table, m.
    pub(super) fn closest(&self) -> f64 {
        self.approaches[self.approaches.len() - 1]
    }

    /// The contact at an approach, m.
    pub(super) fn at(&self, approach: f64) -> ElementContact {
        let last = self.approaches.len() - 1;
        if approach <= self.touch {
            return ElementContact { y: Expansion::constant(self.log_pressures[0]), ..ElementContact::default() };
        }
        if approach < self.approaches[0] {
            self.below(approach)
        } else if approach > self.approaches[last] {
            self.above(approach)
        } else {
            self.inside(approach)
        }
    }

    fn inside(&self, approach: f64) -> ElementContact {
        let i = interval_of(&self.approaches, approach);
        let y = cubic(&self.approaches, &self.log_pressures, &self.slopes, i, approach);
        let friction = self.along_pressure(Quantity::Friction, i, y.value).compose(y);
        let normal = y.exp().times(Expansion::constant(self.nominal_area));
        ElementContact {
            y,
            normal,
            limit: friction.times(normal),
            stiffness: self.along_pressure(Quantity::Stiffness, i, y.value).compose(y),
        }
    }

    fn below(&self, approach: f64) -> ElementContact {
        let width = self.approaches[0] - self.touch;
        let share = (approach - self.touch) / width;
        let parabola = Expansion { value: share * share, slope: 2.0 * share / width, curvature: 2.0 / (width * width) };
        let of = |value| parabola.times(Expansion::constant(value));
        let force = self.nominal_area * self.log_pressures[0].exp();
        ElementContact {
            y: Expansion::constant(self.log_pressures[0]),
            normal: of(force),
            limit: of(self.end(Quantity::Friction, 0) * force),
            stiffness: of(self.end(Quantity::Stiffness, 0)),
        }
    }

    fn above(&self, approach: f64) -> ElementContact {
        let last = self.approaches.len() - 1;
        let force = self.nominal_area * self.log_pressures[last].exp();
        let slope = self.slopes[last] * force;
        let value = force + slope * (approach - self.approaches[last]);
        let normal = Expansion { value, slope, curvature: 0.0 };
        ElementContact {
            y: Expansion::constant(self.log_pressures[last]),
            normal,
            limit: normal.times(Expansion::constant(self.end(Quantity::Friction, last))),
            stiffness: Expansion::constant(self.end(Quantity::Stiffness, last)),
        }
    }

    /// A quantity over y in the interval `i` of the pressures.
    fn along_pressure(&self, quantity: Quantity, i: usize, y: f64) -> Expansion {
        self.over_pressure[quantity as usize]
            .as_ref()
            .map_or_else(Expansion::default, |column| column.at(&self.log_pressures, i, y))
    }

    /// A quantity at the pressure `i`.
    fn end(&self, quantity: Quantity, i: usize) -> f64 {
        self.over_pressure[quantity as usize].as_ref().map_or(0.0, |column| column.values[i])
    }

    /// A quantity at a pressure (Pa), limited to those of the table.
    pub(crate) fn at_pressure(&self, quantity: Quantity, pressure: f64) -> f64 {
        let last = self.log_pressures.len() - 1;
        let y = pressure.ln().clamp(self.log_pressures[0], self.log_pressures[last]);
        self.along_pressure(quantity, interval_of(&self.log_pressures, y), y).value
    }

    /// The pressure over the least of the table, at most 1.
    pub(super) fn share_of_least(&self, contact: &ElementContact) -> Expansion {
        let force = self.nominal_area * self.log_pressures[0].exp();
        if contact.normal.value >= force {
            return Expansion::constant(1.0);
        }
        contact.normal.times(Expansion::constant(1.0 / force))
    }

    /// A quantity at `contact`, along the approach; 0 where the table does not have it.
    pub(super) fn other(&self, quantity: Quantity, contact: &ElementContact) -> Expansion {
        let i = interval_of(&self.log_pressures, contact.y.value);
        self.along_pressure(quantity, i, contact.y.value).compose(contact.y)
    }
}

/// Least slope of y at the ends, as a share of the secant beside them.
const MIN_END_SLOPE: f64 = 0.5;

/// Number of segments between two pressures, given by their logarithms.
fn segment_count(from: f64, to: f64) -> usize {
    ((to - from) / MAX_SEGMENT).ceil().max(1.0) as usize
}

/// The contact at one approach and speed, and its derivatives with respect to the approach.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ElementContact {
    /// y = ln p, limited to the pressures of the table.
    y: Expansion,
    /// F_z = A p, N.
    pub(super) normal: Expansion,
    /// μ F_z, N.
    pub(super) limit: Expansion,
    /// Tangential stiffness, N/m; 0 without contact.
    pub(super) stiffness: Expansion,
}
