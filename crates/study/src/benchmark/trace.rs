//! What runs are compared by: the forces on the carrier, the energy lost and the motion of a carrier that is a body,
//! row by row.

use crate::robustness::{ForceHistory, larger};

/// The quantities whose errors are shown, by the names of their variables.
pub const QUANTITIES: [&str; COUNT] = ["F_x", "F_z", "E_diss", "u", "w"];

const COUNT: usize = 5;

/// The errors of F_x, F_z and E_diss, and of u and w of bodies, over the largest value of each, of u and w from the
/// start; `None` for a quantity that a scene does not have.
pub type Errors = [Option<f64>; COUNT];

/// The values of the [`QUANTITIES`] in a row.
pub type TraceRow = [f64; COUNT];

/// Windows of a phase over which means are taken.
pub const WINDOWS: u32 = 20;

/// A force that stays below this share of the other one is rounding.
const ROUNDING: f64 = 1e-12;

/// F_x, F_z (N), E_diss (J) and the distances of bodies from their start (m) at the rows of a run: the start, and even
/// intervals of each phase.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Trace {
    times: Vec<f64>,
    rows: Vec<TraceRow>,
    /// The number of intervals of each phase that took time.
    intervals: Vec<usize>,
}

impl Trace {
    /// Adds a row at a time, s.
    pub fn push(&mut self, time: f64, row: TraceRow) {
        self.times.push(time);
        self.rows.push(row);
    }

    /// The phase under way ends with the last row; a phase without rows took no time.
    pub fn end_phase(&mut self) {
        let count = self.rows.len() - 1 - self.intervals.iter().sum::<usize>();
        self.intervals.extend((count > 0).then_some(count));
    }

    /// Time of the last row, s.
    pub fn end(&self) -> f64 {
        self.times.last().copied().unwrap_or_default()
    }

    /// The forces alone.
    pub fn forces(&self) -> ForceHistory {
        ForceHistory { times: self.times.clone(), rows: self.rows.iter().map(|row| [row[0], row[1]]).collect() }
    }

    /// Every `step`th row, a divisor of every phase's intervals.
    pub fn every(&self, step: usize) -> Self {
        Self {
            times: self.times.iter().copied().step_by(step).collect(),
            rows: self.rows.iter().copied().step_by(step).collect(),
            intervals: self.intervals.iter().map(|count| count / step).collect(),
        }
    }

    /// The largest difference from `reference`, which has the same rows.
    pub fn largest(&self, reference: &Self) -> Errors {
        self.errors(reference, |differences| differences.fold(0.0, larger))
    }

    /// The root of the mean square of the differences.
    pub fn mean_square(&self, reference: &Self) -> Errors {
        let count = self.rows.len() as f64;
        self.errors(reference, |differences| (differences.map(|d| d * d).sum::<f64>() / count).sqrt())
    }

    fn errors(&self, reference: &Self, measure: impl Fn(&mut dyn Iterator<Item = f64>) -> f64) -> Errors {
        let scales = reference.scales();
        std::array::from_fn(|i| {
            let pairs = self.rows.iter().zip(&reference.rows);
            let error = measure(&mut pairs.map(|(row, wanted)| (row[i] - wanted[i]).abs()));
            scales[i].map(|scale| error / scale)
        })
    }

    /// The largest difference of the forces' means over windows of a phase, over the largest mean; of the energy lost,
    /// whose rows are sums already, as it is. `reference` may have other rows.
    pub fn means(&self, reference: &Self) -> Errors {
        let (own, wanted) = (self.window_means(), reference.window_means());
        let scales = reference.scales();
        std::array::from_fn(|i| {
            scales[i]?;
            let largest = wanted.iter().fold(0.0, |largest, mean| larger(largest, mean[i].abs()));
            let error = own.iter().zip(&wanted).fold(0.0, |error, (a, b)| larger(error, (a[i] - b[i]).abs()));
            (largest > 0.0).then_some(error / largest)
        })
    }

    /// The means over the windows of each phase; of the energy lost, its value at their ends.
    fn window_means(&self) -> Vec<TraceRow> {
        let mut start = 0;
        let mut means = Vec::new();
        for &count in &self.intervals {
            let rows = &self.rows[start..=start + count];
            let sums = running_sums(rows);
            let bound = |window: u32| f64::from(window) / f64::from(WINDOWS) * count as f64;
            means.extend((0..WINDOWS).map(|window| {
                let (from, to) = (bound(window), bound(window + 1));
                let (low, high) = (sum_to(rows, &sums, from), sum_to(rows, &sums, to));
                let mean = |i: usize| (high[i] - low[i]) / (to - from);
                [mean(0), mean(1), value_at(rows, to)[2], mean(3), mean(4)]
            }));
            start += count;
        }
        means
    }

    /// The largest values; `None` for a force that is rounding alone.
    fn scales(&self) -> Errors {
        let largest = |i: usize| self.rows.iter().fold(0.0, |largest, row| larger(largest, row[i].abs()));
        let scales: TraceRow = std::array::from_fn(largest);
        let least = ROUNDING * scales[0].max(scales[1]);
        std::array::from_fn(|i| Some(scales[i]).filter(|&scale| scale > if i < 2 { least } else { 0.0 }))
    }
}

/// The integrals of the straight lines between the rows, from the first row to each; an interval counts as 1.
fn running_sums(rows: &[TraceRow]) -> Vec<TraceRow> {
    let mut sums = vec![[0.0; COUNT]];
    for (i, pair) in rows.windows(2).enumerate() {
        sums.push(std::array::from_fn(|j| sums[i][j] + 0.5 * (pair[0][j] + pair[1][j])));
    }
    sums
}

/// The integral from the first row to `position`, which counts rows.
fn sum_to(rows: &[TraceRow], sums: &[TraceRow], position: f64) -> TraceRow {
    let (i, part) = interval(rows, position);
    let here = value_at(rows, position);
    std::array::from_fn(|j| sums[i][j] + 0.5 * part * (rows[i][j] + here[j]))
}

fn value_at(rows: &[TraceRow], position: f64) -> TraceRow {
    let (i, part) = interval(rows, position);
    std::array::from_fn(|j| rows[i][j] + part * (rows[i + 1][j] - rows[i][j]))
}

/// The interval in which `position` lies, and the part of it before `position`.
fn interval(rows: &[TraceRow], position: f64) -> (usize, f64) {
    let i = (position as usize).min(rows.len() - 2);
    (i, position - i as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two phases, of 4 and of 2 intervals.
    fn trace(values: [f64; 7]) -> Trace {
        from_rows(values.map(|value| [value, 2.0 * value, 0.0, 0.0, 0.0]).into(), &[4, 2])
    }

    fn from_rows(rows: Vec<TraceRow>, intervals: &[usize]) -> Trace {
        Trace { times: (0..rows.len()).map(|i| i as f64).collect(), rows, intervals: intervals.to_vec() }
    }

    #[test]
    fn errors_are_shares_of_the_largest_value() {
        let reference = trace([0.0, 1.0, 2.0, 3.0, 4.0, 2.0, 0.0]);
        let other = trace([0.0, 1.0, 2.0, 3.0, 4.0, 2.0, 1.0]);
        assert_eq!(other.largest(&reference), [Some(0.25), Some(0.25), None, None, None]);
        let mean_square = other.mean_square(&reference)[0].unwrap();
        assert!((mean_square - 0.25 / 7.0_f64.sqrt()).abs() < 1e-15, "{mean_square}");
        assert_eq!(trace([f64::NAN; 7]).largest(&reference)[0], Some(f64::INFINITY));
    }

    #[test]
    fn rounding_is_no_force() {
        let rows = vec![[1e-13, 1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0, 0.0]];
        let trace = from_rows(rows, &[1]);
        assert_eq!(trace.largest(&trace), [None, Some(0.0), None, None, None]);
    }

    /// Straight lines have the means of their windows' middles, with any rows.
    #[test]
    fn means_do_not_depend_on_how_fine_the_rows_are() {
        let line = |count: usize| {
            let rows = (0..=count).map(|i| [i as f64 / count as f64; COUNT]).collect();
            from_rows(rows, &[count])
        };
        let means = line(3).window_means();
        assert_eq!(means.len(), WINDOWS as usize);
        for (i, mean) in means.iter().enumerate() {
            let middle = (i as f64 + 0.5) / f64::from(WINDOWS);
            assert!((mean[0] - middle).abs() < 1e-14 && (mean[2] - middle).abs() < 0.03, "{i}: {mean:?}");
        }
        let errors = line(7).means(&line(64));
        assert!(errors.iter().flatten().all(|&error| error < 1e-14), "{errors:?}");
    }

    #[test]
    fn a_difference_that_comes_and_goes_within_a_window_is_none_of_the_means() {
        let wave = |sign: f64| {
            from_rows(
                (0..=80).map(|i| [1.0 + sign * f64::from([0, 1, 0, -1][i % 4]), 1.0, 1.0, 1.0, 1.0]).collect(),
                &[80],
            )
        };
        assert_eq!(wave(1.0).means(&wave(-1.0)), [Some(0.0); COUNT]);
        assert_eq!(wave(1.0).largest(&wave(-1.0))[0], Some(1.0));
    }

    #[test]
    fn fewer_rows_are_every_so_many() {
        let reference = trace([0.0, 1.0, 2.0, 3.0, 4.0, 2.0, 0.0]).every(2);
        assert_eq!((reference.times, reference.intervals), (vec![0.0, 2.0, 4.0, 6.0], vec![2, 1]));
    }

    #[test]
    fn a_phase_without_rows_has_no_intervals() {
        let mut trace = Trace::default();
        trace.push(0.0, [0.0; COUNT]);
        trace.end_phase();
        trace.push(1.0, [0.0; COUNT]);
        trace.push(2.0, [0.0; COUNT]);
        trace.end_phase();
        trace.end_phase();
        assert_eq!(trace.intervals, [2]);
    }
}
