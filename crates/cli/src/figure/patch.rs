//! The figure of a contact patch: its wrench over time, and its face at the moment of the largest force and at some
//! others.

use asperity::patch::{Patch, PatchOutput, PatchRun, PatchVariable};

use super::chart::Chart;
use super::maps::{Maps, STRIP};
use super::moment::Moment;
use super::panels::over_time;
use super::{Backend, Canvas, DrawResult, FINE, Figure};

/// A run of a patch: force, moment and energy lost, collected row by row, and its face at some of the rows.
#[derive(Debug)]
pub(crate) struct PatchHistory {
    title: String,
    variables: Vec<PatchVariable>,
    times: Vec<f64>,
    rows: Vec<Vec<f64>>,
    maps: Maps,
    /// The indices of the rows whose faces are drawn in the strip.
    in_strip: Vec<usize>,
    strip: Vec<Moment>,
    /// The moment of the largest force so far.
    largest: Option<Moment>,
}

/// The height of a chart, pixels.
const CHART: u32 = 360;

/// A chart of a run: the quantity, its unit, and which outputs it shows.
type RunPanel = (&'static str, &'static str, fn(&PatchOutput) -> bool);

const RUN_PANELS: [RunPanel; 3] = [
    ("force", "N", |output| matches!(output, PatchOutput::Force(_) | PatchOutput::TransportForce)),
    ("moment", "N m", |output| matches!(output, PatchOutput::Moment(_))),
    ("energy lost", "J", |output| {
        matches!(output, PatchOutput::Energy | PatchOutput::SlipEnergy | PatchOutput::ReleaseEnergy)
    }),
];

impl PatchHistory {
    /// For a run with rows at `times` (s).
    pub(crate) fn new(patch: &Patch, times: &[f64]) -> Self {
        let mut variables = patch.all_variables();
        variables.retain(|variable| RUN_PANELS.iter().any(|(_, _, shows)| shows(&variable.output)));
        Self {
            title: patch.name().to_owned(),
            variables,
            times: Vec::new(),
            rows: Vec::new(),
            maps: Maps::new(patch.layout()),
            in_strip: ends_of_parts(times),
            strip: Vec::new(),
            largest: None,
        }
    }

    pub(crate) fn add(&mut self, run: &mut PatchRun) {
        let mut values = vec![0.0; self.variables.len()];
        run.evaluate(&self.variables, &mut values);
        self.add_moments(run, force(&self.variables, &values));
        self.times.push(run.time());
        self.rows.push(values);
    }

    fn add_moments(&mut self, run: &mut PatchRun, force: f64) {
        let (plan, [large, small]) = (self.maps.plan(), self.maps.details());
        if self.largest.as_ref().is_none_or(|largest| force > largest.force) {
            self.largest = Some(Moment::new(run, plan, large, force));
        }
        if self.in_strip.contains(&self.rows.len()) {
            self.strip.push(Moment::new(run, plan, small, force));
        }
    }

    fn chart(&self, &(quantity, unit, shows): &RunPanel) -> Chart {
        let shown = self.variables.iter().enumerate().filter(|(_, variable)| shows(&variable.output));
        let shown = shown.map(|(i, variable)| (i, variable.name.as_str()));
        over_time((quantity, unit), &self.times, &self.rows, shown)
    }
}

/// The rows nearest to the ends of even parts of the time from the first to the last of them.
fn ends_of_parts(times: &[f64]) -> Vec<usize> {
    let (Some(first), Some(last)) = (times.first(), times.last()) else { return Vec::new() };
    let end = |part: usize| first + (last - first) * part as f64 / STRIP as f64;
    let nearest = |time: f64| {
        let after = times.partition_point(|&other| other < time).min(times.len() - 1);
        let before = after.saturating_sub(1);
        if time - times[before] < times[after] - time { before } else { after }
    };
    let mut rows: Vec<usize> = (1..=STRIP).map(|part| nearest(end(part))).collect();
    rows.dedup();
    rows
}

/// The absolute value of the force, N.
fn force(variables: &[PatchVariable], values: &[f64]) -> f64 {
    let parts = variables.iter().zip(values).filter(|(variable, _)| matches!(variable.output, PatchOutput::Force(_)));
    parts.map(|(_, force)| force * force).sum::<f64>().sqrt()
}

impl Figure for PatchHistory {
    fn size(&self) -> (u32, u32) {
        (1000, CHART * RUN_PANELS.len() as u32 + self.maps.height())
    }

    fn title(&self) -> &str {
        &self.title
    }

    fn draw<B: Backend>(&self, canvas: &Canvas<B>) -> DrawResult {
        let (charts, maps) = canvas.split_vertically(canvas.dim_in_pixel().1 - self.maps.height() * FINE);
        let canvases = charts.split_evenly((RUN_PANELS.len(), 1));
        RUN_PANELS.iter().zip(&canvases).try_for_each(|(panel, canvas)| self.chart(panel).draw_with_legend(canvas))?;
        self.largest.iter().try_for_each(|largest| self.maps.draw(&maps, largest, &self.strip))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_strip_has_the_rows_nearest_to_even_parts_of_the_time() {
        let times: Vec<f64> = (0..=100).map(|i| 2.0 + 0.01 * f64::from(i)).collect();
        assert_eq!(ends_of_parts(&times), [20, 40, 60, 80, 100]);
        assert_eq!(ends_of_parts(&[0.0, 0.39, 0.62, 1.0]), [1, 2, 3]);
        assert_eq!((ends_of_parts(&[0.0]), ends_of_parts(&[])), (vec![0], vec![]));
    }
}
