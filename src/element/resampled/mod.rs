//! The law of an element, per unit area and precomputed along the speed: for many elements of different speeds.
//!
//! Between two speeds of the table ln v is divided into even cells. At three speeds of each the law is a
//! [`LawAtSpeed`]; the coefficients of its cubics over the approach and over ln p are interpolated by parabolas of ln
//! v. So an evaluation takes one logarithm, one exponential and polynomials, no division; with a backing what that takes
//! besides. Cells are computed when they are first needed at a temperature.
//!
//! Where each element has a temperature of its own, the law is kept at several temperatures, planes, and its
//! coefficients are linear between two of them. Cells of a plane are computed when they are first met.

mod speed_grid;
#[cfg(test)]
mod tests;

pub use speed_grid::SpeedRange;

use super::backing::{SeriesBacking, SeriesIntervals};
use super::friction_table::FrictionTable;
use super::law::{Law, LawAtSpeed};
use super::law_points::{COEFFICIENTS, ElementLaw, FRICTION, Intervals, LOG_PRESSURE, LawPoints, START, STIFFNESS};
use super::limits::TableLimits;
use super::quantity::Quantity;
use crate::math::Number;
use crate::scene::Backing;
use speed_grid::{Planes, SpeedCell, SpeedGrid};

/// Width of a cell, in ln v, at most.
///
/// So p, μ p and κ are met to 1e-9 where the table is smooth, and to 1e-6 of their largest values elsewhere:
/// slopes along the pressure have a corner where they leave 0.
const MAX_WIDTH: f64 = 0.006;
/// Where there are several planes, between which the law is met to 1e-3, ten times that: each plane takes memory, and
/// time when it is met.
const MAX_WIDTH_OF_PLANES: f64 = 0.06;

/// Speeds of a cell at which the law is taken.
const SAMPLES: usize = 3;

/// Approaches that are compared at once.
const WIDTH: usize = 4;

/// Where a speed and a temperature lie in the law.
#[derive(Clone, Copy, Debug)]
pub struct LawPlace<T> {
    /// ln v, v in m/s, limited to the speeds of the table.
    log_speed: T,
    cell: SpeedCell,
    /// Where there are planes: the fraction of the way from that of the cell to the next.
    way: T,
}

impl<T: Number> LawPlace<T> {
    /// The slowest speed and the lowest temperature, as a beginning.
    #[inline(always)]
    pub fn first() -> Self {
        Self { log_speed: T::constant(0.0), cell: SpeedCell::default(), way: T::constant(0.0) }
    }

    /// The fraction of the speed's cell.
    #[inline(always)]
    fn fraction(&self) -> T {
        (self.log_speed - T::constant(self.cell.start)).times(self.cell.density)
    }
}

impl LawPlace<f64> {
    /// The same place for numbers with derivatives, all of them 0.
    pub fn constant<T: Number>(&self) -> LawPlace<T> {
        LawPlace { log_speed: T::constant(self.log_speed), cell: self.cell, way: T::constant(self.way) }
    }
}

/// The coefficients of [`Intervals`] in an interval between two pressures of the table, by power of the fraction of the
/// speed's cell.
type LawCoefficients = [[f64; COEFFICIENTS]; SAMPLES];

/// How many coefficients hysteresis and contact ratio have over ln p in such an interval: four each.
const SHARE_COEFFICIENTS: usize = 8;
/// The place among them of the first of hysteresis.
const HYSTERESIS: usize = 0;
/// That of the first of the contact ratio.
const CONTACT_RATIO: usize = 4;

/// The coefficients of hysteresis and contact ratio.
type ShareCoefficients = [[f64; SHARE_COEFFICIENTS]; SAMPLES];

/// Approaches (m) at which intervals of the pressure begin, as straight functions of the fraction of a cell: where it
/// begins, and by how much they grow. Those without an interval are never reached.
#[derive(Clone, Copy, Debug)]
struct IntervalStarts {
    start: [f64; WIDTH],
    growth: [f64; WIDTH],
}

impl IntervalStarts {
    const NONE: Self = Self { start: [f64::INFINITY; WIDTH], growth: [0.0; WIDTH] };
}

/// The precomputed law of a table at one temperature, or at all that elements of their own temperatures may have.
#[derive(Clone, Debug)]
pub struct ResampledLaw {
    /// At the temperature of the cell computed last, or at that set.
    law: Law,
    curve: LawAtSpeed,
    temperature: f64,
    /// Where elements have temperatures of their own.
    planes: Option<Planes>,
    /// The area that a layer stands for, m².
    area: f64,
    /// ln p at the pressures, p in Pa.
    log_pressures: Vec<f64>,
    /// The speeds of the table and the cells between them, in one plane.
    speeds: SpeedGrid,
    /// By cell those of all pressures but the first.
    interval_starts: Vec<IntervalStarts>,
    /// By cell and pressure.
    coefficients: Vec<LawCoefficients>,
    /// By cell and pressure.
    shares: Vec<ShareCoefficients>,
    /// By cell the temperature's number for which it was computed.
    computed: Vec<u64>,
    /// The number of the present temperature: how many there have been.
    temperature_number: u64,
    /// Up to this approach there is no contact at any speed, m.
    earliest_touch: f64,
    /// What stands behind the contact, if that gives way.
    backing: Option<SeriesBacking>,
}

impl ResampledLaw {
    /// The law of `table` at `temperature` (K), of a layer that stands for `area` (m²), in series with a backing.
    pub fn new(table: &FrictionTable, area: f64, temperature: f64, backing: Option<Backing>) -> Self {
        Self::with_planes(table, area, temperature, backing, false)
    }

    /// As [`new`](Self::new), of a table of several temperatures and of elements that are warmer than `temperature`.
    pub fn of_warm_elements(table: &FrictionTable, area: f64, temperature: f64, backing: Option<Backing>) -> Self {
        Self::with_planes(table, area, temperature, backing, true)
    }

    fn with_planes(
        table: &FrictionTable,
        area: f64,
        temperature: f64,
        backing: Option<Backing>,
        has_planes: bool,
    ) -> Self {
        let mut law = Law::new(table, temperature);
        let curve = LawAtSpeed::new(&law, 0.0);
        let log_pressures = log_pressures(table, area);
        let backing = backing.map(|backing| SeriesBacking::new(backing, &log_pressures));
        let width = if has_planes { MAX_WIDTH_OF_PLANES } else { MAX_WIDTH };
        let (speeds, pressures) = (SpeedGrid::new(law.log_speeds().to_vec(), width), table.grid.loads.len());
        let cells_of_plane = speeds.cells();
        let planes = if has_planes { Planes::new(table, &law, cells_of_plane, indentations(&backing)) } else { None };
        let cells = cells_of_plane * planes.map_or(1, |planes| planes.count);
        let earliest_touch = match planes {
            Some(planes) => planes.earliest_touch(&mut law),
            None => law.earliest_touch(),
        };
        Self {
            temperature,
            area,
            backing,
            log_pressures,
            speeds,
            interval_starts: vec![IntervalStarts::NONE; cells * starts_of(pressures)],
            coefficients: vec![[[0.0; COEFFICIENTS]; SAMPLES]; cells * pressures],
            shares: vec![[[0.0; SHARE_COEFFICIENTS]; SAMPLES]; cells * pressures],
            computed: vec![0; cells],
            temperature_number: 1,
            earliest_touch,
            planes,
            law,
            curve,
        }
    }

    /// Memory in bytes that the law of `table` takes, of a layer that stands for `area` (m²), in series with a backing, of
    /// elements that are warmer or not.
    pub fn memory(table: &FrictionTable, area: f64, backing: Option<Backing>, is_warm: bool) -> usize {
        let speeds = table.grid.speeds.iter().map(|speed| speed.ln()).collect();
        let width = if is_warm { MAX_WIDTH_OF_PLANES } else { MAX_WIDTH };
        let cells = SpeedGrid::new(speeds, width).cells();
        let backing = backing.map(|backing| SeriesBacking::new(backing, &log_pressures(table, area)));
        let law = is_warm.then(|| Law::new(table, 0.0));
        let planes = law.and_then(|law| Planes::new(table, &law, cells, indentations(&backing)));
        let cells = cells * planes.map_or(1, |planes| planes.count);
        let pressures = table.grid.loads.len();
        let at_pressure = size_of::<LawCoefficients>() + size_of::<ShareCoefficients>();
        let starts = starts_of(pressures) * size_of::<IntervalStarts>();
        cells * (pressures * at_pressure + starts + size_of::<u64>())
    }

    /// Whether elements have temperatures of their own.
    pub fn has_planes(&self) -> bool {
        self.planes.is_some()
    }

    /// The temperature, K.
    pub fn temperature(&self) -> f64 {
        self.temperature
    }

    /// Changes the temperature, K; allocates nothing.
    pub fn set_temperature(&mut self, kelvin: f64) {
        if kelvin == self.temperature {
            return;
        }
        self.temperature = kelvin;
        if self.planes.is_some() {
            return;
        }
        self.law.set_temperature(kelvin);
        self.curve.invalidate_speed();
        self.temperature_number += 1;
        self.earliest_touch = self.law.earliest_touch();
    }

    /// Up to this approach (m) there is no contact at any speed.
    pub fn earliest_touch(&self) -> f64 {
        self.earliest_touch
    }

    /// Up to where elements are within the table.
    pub fn limits(&self) -> TableLimits {
        TableLimits::new((self.least_pressure(), self.largest_pressure()), self.law.speed_range.1)
    }

    /// The least pressure of the table, Pa.
    pub fn least_pressure(&self) -> f64 {
        self.log_pressures[0].exp()
    }

    /// The largest pressure of the table, Pa.
    fn largest_pressure(&self) -> f64 {
        self.log_pressures.last().map_or(0.0, |y| y.exp())
    }

    /// The speeds of the table.
    #[inline(always)]
    pub fn range(&self) -> SpeedRange {
        self.speeds.range(self.law.speed_range)
    }

    /// The place of a [logarithm of a speed](SpeedRange::logarithm) in the law, of an element that is warmer by `rise` (K);
    /// its cells are computed if they were not yet.
    #[inline(always)]
    pub fn place<T: Number>(&mut self, log_speed: T, rise: T) -> LawPlace<T> {
        let mut place = LawPlace { log_speed, cell: self.speeds.cell(log_speed.value()), way: T::constant(0.0) };
        if let Some(Planes { first, distance, count, cells }) = self.planes {
            let from_first = (rise + T::constant(self.temperature - first)).times(1.0 / distance);
            // Beyond the temperatures of the table the law is that of its end.
            let from_first = from_first.larger(T::constant(0.0)).smaller(T::constant((count - 1) as f64));
            let plane = (from_first.value() as u32 as usize).min(count - 2);
            place.cell.index += plane * cells;
            place.way = from_first - T::constant(plane as f64);
            self.compute_once(&SpeedCell { index: place.cell.index + cells, ..place.cell });
        }
        self.compute_once(&place.cell);
        place
    }

    #[inline(always)]
    fn compute_once(&mut self, cell: &SpeedCell) {
        if self.computed[cell.index] != self.temperature_number {
            self.compute(*cell);
        }
    }

    /// Computes the coefficients of a cell.
    #[cold]
    fn compute(&mut self, cell: SpeedCell) {
        if let Some(planes) = self.planes {
            self.law.set_temperature(planes.temperature(cell.index / planes.cells));
            self.curve.invalidate_speed();
        }
        let width = if cell.density > 0.0 { 1.0 / cell.density } else { 0.0 };
        let pressures = self.log_pressures.len();
        let rows = cell.index * pressures..(cell.index + 1) * pressures;
        self.coefficients[rows.clone()].fill([[0.0; COEFFICIENTS]; SAMPLES]);
        self.shares[rows].fill([[0.0; SHARE_COEFFICIENTS]; SAMPLES]);
        for (sample, weights) in LAGRANGE.iter().enumerate() {
            self.curve.set_speed(&self.law, (cell.start + width * sample as f64 / (SAMPLES - 1) as f64).exp());
            (0..pressures).for_each(|i| self.add_sample(cell.index * pressures + i, i, weights));
            self.record_starts(cell.index, sample);
        }
        self.computed[cell.index] = self.temperature_number;
    }

    /// Adds a sample of the law at a speed of a cell to the coefficients `row`, those of the interval from pressure `i`
    /// on.
    fn add_sample(&mut self, row: usize, i: usize, weights: &[f64; SAMPLES]) {
        // ln p over the approach, then μ and κ over ln p.
        let [_, approaches, slopes] = self.curve.points();
        let along = |quantity| cubic_over(&self.log_pressures, self.curve.series(quantity), i);
        let mut now = [0.0; COEFFICIENTS];
        now[..FRICTION].copy_from_slice(&cubic_over(approaches, Some([&self.log_pressures, slopes]), i));
        // Where an interval begins ln p is that of the table.
        now[START] = approaches[i];
        now[FRICTION..STIFFNESS].copy_from_slice(&along(Quantity::Friction));
        now[STIFFNESS..].copy_from_slice(&along(Quantity::Stiffness).map(|k| k / self.area));
        let shares = [along(Quantity::Hysteresis), along(Quantity::ContactRatio)];
        for (power, weight) in weights.iter().enumerate() {
            let kept = &mut self.coefficients[row][power];
            kept.iter_mut().zip(now).for_each(|(sum, value)| *sum += weight * value);
            let kept = &mut self.shares[row][power];
            kept.iter_mut().zip(shares.as_flattened()).for_each(|(sum, value)| *sum += weight * value);
        }
    }

    /// p/k_n of the backing at pressure `i` of the table, m; 0 without a backing.
    #[inline(always)]
    fn indentation(&self, i: usize) -> f64 {
        self.backing.as_ref().map_or(0.0, |backing| backing.indentations[i])
    }

    /// Takes the starts of a cell's intervals from its first and its last sample.
    fn record_starts(&mut self, cell: usize, sample: usize) {
        let indentations = self.backing.as_ref().map(|backing| &backing.indentations);
        let [_, approaches, _] = self.curve.points();
        let count = starts_of(approaches.len());
        let kept = &mut self.interval_starts[cell * count..(cell + 1) * count];
        for (i, contact) in approaches[1..].iter().enumerate() {
            let approach = contact + indentations.map_or(0.0, |indentations| indentations[i + 1]);
            let IntervalStarts { start, growth } = &mut kept[i / WIDTH];
            if sample == 0 {
                start[i % WIDTH] = approach;
            } else {
                growth[i % WIDTH] = approach - start[i % WIDTH];
            }
        }
    }

    /// From a cell to that of the next plane; 0 where there are none.
    #[inline(always)]
    fn to_next_plane(&self) -> usize {
        self.planes.map_or(0, |planes| planes.cells)
    }

    /// The index of the interval of the pressure at an approach: near the ends of intervals one or the other, which
    /// agree there.
    #[inline(always)]
    fn pressure_interval<T: Number>(&self, place: &LawPlace<T>, approach: f64) -> usize {
        let (fraction, way) = (place.fraction().value(), place.way.value());
        let (cell, count) = (place.cell.index, starts_of(self.log_pressures.len()));
        let starts_in = |cell: usize| &self.interval_starts[cell * count..(cell + 1) * count];
        let mut passed = [0_u64; WIDTH];
        for (below, above) in starts_in(cell).iter().zip(starts_in(cell + self.to_next_plane())) {
            for i in 0..WIDTH {
                let here = below.start[i] + fraction * below.growth[i];
                let next = above.start[i] + fraction * above.growth[i];
                passed[i] += u64::from(approach >= here + way * (next - here));
            }
        }
        passed.iter().sum::<u64>() as usize
    }

    /// The coefficients of an interval of the pressure at a place.
    #[inline(always)]
    fn coefficients_at<T: Number>(&self, place: &LawPlace<T>, interval: usize) -> [T; COEFFICIENTS] {
        let mut coefficients = self.coefficients_in(place.cell.index, place.fraction(), interval);
        if let Some(planes) = self.planes {
            let next = self.coefficients_in(place.cell.index + planes.cells, place.fraction(), interval);
            for k in 0..COEFFICIENTS {
                coefficients[k] = coefficients[k] + (next[k] - coefficients[k]) * place.way;
            }
        }
        coefficients
    }

    /// Those at a fraction of a cell of one plane.
    #[inline(always)]
    fn coefficients_in<T: Number>(&self, cell: usize, fraction: T, interval: usize) -> [T; COEFFICIENTS] {
        let [a, b, c] = &self.coefficients[cell * self.log_pressures.len() + interval];
        let mut coefficients = [T::constant(0.0); COEFFICIENTS];
        for k in 0..COEFFICIENTS {
            coefficients[k] = T::constant(a[k]) + fraction * (T::constant(b[k]) + fraction.times(c[k]));
        }
        coefficients
    }

    /// The law of elements at their places and approaches (m): of the first `count` of N.
    #[inline(always)]
    pub fn points<T: Number, const N: usize>(
        &self,
        count: usize,
        places: &[LawPlace<T>; N],
        approaches: &[T; N],
    ) -> LawPoints<T, N> {
        let count = count.min(N);
        let mut intervals = [0; N];
        for i in 0..count {
            intervals[i] = self.pressure_interval(&places[i], approaches[i].value());
        }
        self.points_in(count, &intervals, places, approaches)
    }

    /// As [`points`](Self::points), the intervals of the pressure being known.
    #[inline(always)]
    fn points_in<T: Number, const N: usize>(
        &self,
        count: usize,
        intervals: &[usize; N],
        places: &[LawPlace<T>; N],
        approaches: &[T; N],
    ) -> LawPoints<T, N> {
        let mut laws = Intervals::new(count);
        for i in 0..count {
            let (interval, is_last) = (intervals[i], intervals[i] + 1 == self.log_pressures.len());
            laws.set(i, self.coefficients_at(&places[i], interval), self.log_pressures[interval], is_last);
        }
        let Some(backing) = &self.backing else { return laws.points(&laws.beyond_start(approaches)) };
        let mut series = SeriesIntervals::new(&laws);
        for i in 0..count {
            let next = (intervals[i] + 1).min(self.log_pressures.len() - 1);
            series.set(i, backing, (intervals[i], next), self.start(&places[i], next));
        }
        let mut points = laws.points(&series.contacts_beyond_start(approaches));
        for i in 0..count {
            points.stiffness[i] = backing.in_series(points.stiffness[i]);
        }
        points
    }

    /// The law at a place and an approach (m).
    #[inline(always)]
    pub fn at_place<T: Number>(&self, place: &LawPlace<T>, approach: T) -> ElementLaw<T> {
        let LawPoints { log_pressure: [log_pressure], factor: [factor], friction: [friction], stiffness: [stiffness] } =
            self.points(1, &[*place], &[approach]);
        ElementLaw { pressure: log_pressure.exp() * factor, friction, stiffness }
    }

    /// Where interval `i` starts without a backing, m.
    #[inline(always)]
    fn start<T: Number>(&self, place: &LawPlace<T>, i: usize) -> f64 {
        let (fraction, pressures) = (place.fraction().value(), self.log_pressures.len());
        let in_cell = |cell: usize| {
            let [a, b, c] = &self.coefficients[cell * pressures + i];
            a[START] + fraction * (b[START] + fraction * c[START])
        };
        let here = in_cell(place.cell.index);
        here + place.way.value() * (in_cell(place.cell.index + self.to_next_plane()) - here)
    }

    /// The approaches (m) at a place where the contact begins and where it reaches the least pressure of the table.
    pub fn beginning<T: Number>(&self, place: &LawPlace<T>) -> (T, T) {
        let c = self.coefficients_at(place, 0);
        (c[START] - T::constant(2.0) / c[LOG_PRESSURE[0]], c[START] + T::constant(self.indentation(0)))
    }

    /// The energy of the normal springs over their area at a place and an approach (m), J/m²: ∫ p over the approaches of the
    /// face from the touch on, so that of the contact and that of its backing.
    pub fn normal_energy(&self, place: &LawPlace<f64>, approach: f64) -> f64 {
        /// Points and weights of Gauss's rule of four points from -1 to 1, each on both sides (M. Abramowitz, I. A. Stegun,
        /// 25.4.30).
        const GAUSS: [(f64, f64); 2] =
            [(0.339_981_043_584_856, 0.652_145_154_862_546), (0.861_136_311_594_053, 0.347_854_845_137_454)];
        let (mut energy, mut from) = (0.0, self.beginning(place).0);
        let starts = (0..self.log_pressures.len()).map(|i| self.start(place, i) + self.indentation(i));
        for end in starts.chain([f64::INFINITY]) {
            // Up to where the next interval of the pressure begins, before which p is smooth.
            let to = end.min(approach);
            if to <= from {
                continue;
            }
            let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
            let pressure = |x: f64| self.at_place(place, middle + half * x).pressure;
            energy += half * GAUSS.iter().map(|(x, weight)| weight * (pressure(-x) + pressure(*x))).sum::<f64>();
            from = to;
        }
        energy
    }

    /// The share of hysteresis in the friction coefficient, and the contact ratio, at a place and an approach (m).
    pub fn shares(&self, place: &LawPlace<f64>, approach: f64) -> (f64, f64) {
        let (fraction, i) = (place.fraction(), self.pressure_interval(place, approach));
        let points = self.points_in(1, &[i], &[*place], &[approach]);
        let t = points.log_pressure[0] - self.log_pressures[i];
        let along = |first: usize| {
            let in_cell = |cell: usize| {
                let powers = &self.shares[cell * self.log_pressures.len() + i];
                let at = |k: usize| (0..SAMPLES).rev().fold(0.0, |sum, power| sum * fraction + powers[power][k]);
                (0..4).rev().fold(0.0, |sum, k| sum * t + at(first + k))
            };
            let here = in_cell(place.cell.index);
            here + place.way * (in_cell(place.cell.index + self.to_next_plane()) - here)
        };
        let (hysteresis, ratio) = (along(HYSTERESIS), along(CONTACT_RATIO) * points.factor[0].min(1.0));
        (if points.friction[0] > 0.0 { hysteresis / points.friction[0] } else { 0.0 }, ratio)
    }
}

/// The polynomials that are 1 at one of 0, 1/2 and 1, and 0 at the others, by power.
const LAGRANGE: [[f64; SAMPLES]; SAMPLES] = [[1.0, -3.0, 2.0], [0.0, 4.0, -4.0], [0.0, -1.0, 2.0]];

/// ln p at the pressures of a table, p in Pa, of a layer that stands for `area` (m²).
fn log_pressures(table: &FrictionTable, area: f64) -> Vec<f64> {
    let shift = (table.load.area() / area).ln();
    table.grid.loads.iter().map(|load| load.ln() + shift).collect()
}

/// p/k_n at the pressures of a table, m; none without a backing.
fn indentations(backing: &Option<SeriesBacking>) -> &[f64] {
    backing.as_ref().map_or(&[], |backing| &backing.indentations)
}

/// How many [`IntervalStarts`] hold those of all pressures but the first.
const fn starts_of(pressures: usize) -> usize {
    (pressures - 1).div_ceil(WIDTH)
}

/// The coefficients of the cubic that follows point `i` of a column over `x`, from there; after the last point its
/// value and its slope. 0 where there is no column.
fn cubic_over(x: &[f64], column: Option<[&[f64]; 2]>, i: usize) -> [f64; 4] {
    let Some([values, slopes]) = column else { return [0.0; 4] };
    if i + 1 == x.len() {
        return [values[i], slopes[i], 0.0, 0.0];
    }
    let h = x[i + 1] - x[i];
    let secant = (values[i + 1] - values[i]) / h;
    let quadratic = (3.0 * secant - 2.0 * slopes[i] - slopes[i + 1]) / h;
    [values[i], slopes[i], quadratic, (slopes[i] + slopes[i + 1] - 2.0 * secant) / (h * h)]
}
