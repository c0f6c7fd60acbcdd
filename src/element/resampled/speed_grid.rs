//! The cells into which the speeds of a table are divided, and the cell of a speed without a search; and the temperatures at
//! which a law is kept where elements have temperatures of their own.

use crate::element::friction_table::FrictionTable;
use crate::element::law::Law;
use crate::math::Number;

/// Cells between two speeds of a table, at least.
const MIN_CELLS: f64 = 8.0;
/// Most bins in which the place of a speed among those of the table is looked up.
const MAX_BINS: f64 = 1e5;

/// The cell in which a speed lies; the fraction of it is a straight function of ln v.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SpeedCell {
    pub(super) index: usize,
    /// ln v where the cell begins.
    pub(super) start: f64,
    /// Cells per unit of ln v.
    pub(super) density: f64,
}

/// Between two speeds of the table, as logarithms.
#[derive(Clone, Copy, Debug)]
struct SpeedSpan {
    start: f64,
    end: f64,
    /// Cells per unit.
    density: f64,
    /// The width of a cell.
    width: f64,
    /// The index of its first cell.
    first: usize,
    /// How many cells it has.
    count: usize,
}

impl SpeedSpan {
    /// The spans of a table, with cells of this width at most; a table of one speed has one without width.
    fn new(speeds: &[f64], max_width: f64) -> Vec<Self> {
        let mut first = 0;
        let mut span = |start: f64, end: f64| {
            let count = ((end - start) / max_width).ceil().max(MIN_CELLS);
            let width = (end - start) / count;
            let density = if width > 0.0 { 1.0 / width } else { 0.0 };
            let count = count as usize;
            first += count;
            Self { start, end, density, width, first: first - count, count }
        };
        match speeds {
            [one] => vec![span(*one, *one)],
            _ => speeds.windows(2).map(|pair| span(pair[0], pair[1])).collect(),
        }
    }
}

/// The speeds of a table.
#[derive(Clone, Copy, Debug)]
pub struct SpeedRange {
    /// The least, m/s.
    least: f64,
    /// The largest, m/s.
    largest: f64,
    /// ln v of the least.
    first: f64,
    /// ln v of the largest.
    last: f64,
}

impl SpeedRange {
    /// ln v of a speed (m/s), limited to those of the table.
    #[inline(always)]
    pub fn logarithm<T: Number>(&self, speed: T) -> T {
        let speed = speed.larger(T::constant(self.least)).smaller(T::constant(self.largest));
        // Rounding may lead out again.
        speed.ln().larger(T::constant(self.first)).smaller(T::constant(self.last))
    }
}

/// The speeds of a table, as logarithms, and the cells between them.
#[derive(Clone, Debug)]
pub(super) struct SpeedGrid {
    log_speeds: Vec<f64>,
    spans: Vec<SpeedSpan>,
    /// Even bins of ln v: the last speed of the table at or below where each begins; seldom more than one lies in it.
    bins: Vec<u32>,
    bin_density: f64,
}

impl SpeedGrid {
    /// Cells between these logarithms of speeds, of `max_width` at most.
    pub(super) fn new(log_speeds: Vec<f64>, max_width: f64) -> Self {
        let (bins, bin_density) = bins(&log_speeds);
        Self { spans: SpeedSpan::new(&log_speeds, max_width), log_speeds, bins, bin_density }
    }

    /// How many cells there are.
    pub(super) fn cells(&self) -> usize {
        self.spans.iter().map(|span| span.count).sum()
    }

    /// The range of the speeds, of which the least and the largest are given, m/s.
    #[inline(always)]
    pub(super) fn range(&self, (least, largest): (f64, f64)) -> SpeedRange {
        let log_speeds = &self.log_speeds;
        SpeedRange { least, largest, first: log_speeds[0], last: log_speeds[log_speeds.len() - 1] }
    }

    /// The cell of a logarithm of a speed.
    #[inline(always)]
    pub(super) fn cell(&self, log_speed: f64) -> SpeedCell {
        let bin = ((log_speed - self.log_speeds[0]) * self.bin_density) as u32 as usize;
        let mut below = self.bins[bin.min(self.bins.len() - 1)] as usize;
        while log_speed >= self.spans[below].end && below + 1 < self.spans.len() {
            below += 1;
        }
        let SpeedSpan { start, density, width, first, count, .. } = self.spans[below];
        let i = (((log_speed - start) * density) as u32 as usize).min(count - 1);
        SpeedCell { index: first + i, start: start + i as f64 * width, density }
    }
}

/// Bins over the logarithms of the speeds, none wider than the narrowest step, and how many there are per unit.
fn bins(speeds: &[f64]) -> (Vec<u32>, f64) {
    let range = speeds[speeds.len() - 1] - speeds[0];
    if range <= 0.0 {
        return (vec![0], 0.0);
    }
    let narrowest = speeds.windows(2).map(|pair| pair[1] - pair[0]).fold(f64::INFINITY, f64::min);
    let count = (range / narrowest).ceil().min(MAX_BINS);
    let start = |bin: usize| speeds[0] + range * bin as f64 / count;
    let below = |bin: usize| speeds.partition_point(|&speed| speed <= start(bin)).clamp(1, speeds.len() - 1) - 1;
    ((0..count as usize).map(|bin| below(bin) as u32).collect(), count / range)
}

/// Distance of planes, K, at most; closer where the table bends with the temperature so that p and μp would err by more
/// than their tolerance at the table's points; and how many there are at most.
const MAX_DISTANCE: f64 = 2.0;
const PLANE_TOLERANCE: f64 = 1e-3;
const MAX_PLANES: f64 = 400.0;

/// Temperatures at which a law is kept, evenly from the first of its table to the last.
#[derive(Clone, Copy, Debug)]
pub(super) struct Planes {
    /// The least, K.
    pub(super) first: f64,
    /// From one to the next, K.
    pub(super) distance: f64,
    pub(super) count: usize,
    /// Cells of a plane.
    pub(super) cells: usize,
}

impl Planes {
    /// Those of a table of several temperatures, with so many cells each, and p/k_n of a backing (m) at its pressures.
    pub(super) fn new(table: &FrictionTable, law: &Law, cells: usize, indentations: &[f64]) -> Option<Self> {
        let [first, .., last] = *table.grid.temperatures.as_slice() else { return None };
        // A straight line over a parabola is off by its second derivative times the distance² over 8.
        let distance = (8.0 * PLANE_TOLERANCE / law.bend_over_temperature(indentations)).sqrt().min(MAX_DISTANCE);
        let steps = ((last - first) / distance).ceil().clamp(1.0, MAX_PLANES - 1.0);
        Some(Self { first, distance: (last - first) / steps, count: steps as usize + 1, cells })
    }

    pub(super) fn temperature(&self, plane: usize) -> f64 {
        self.first + self.distance * plane as f64
    }

    /// Up to this approach (m) there is no contact at any speed and any plane's temperature.
    pub(super) fn earliest_touch(&self, law: &mut Law) -> f64 {
        let touch = |plane: usize| {
            law.set_temperature(self.temperature(plane));
            law.earliest_touch()
        };
        (0..self.count).map(touch).fold(f64::INFINITY, f64::min)
    }
}
