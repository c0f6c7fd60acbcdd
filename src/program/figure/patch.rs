//! Figures of a contact patch: its wrench over time.

use asperity::patch::{Patch, PatchOutput, PatchRun, PatchVariable};

use super::chart::Chart;
use super::panels::over_time;
use super::{Backend, Canvas, DrawResult, Figure};

/// A run of a patch over time: force, moment and energy lost, collected row by row.
#[derive(Debug)]
pub(crate) struct PatchHistory {
    title: String,
    variables: Vec<PatchVariable>,
    times: Vec<f64>,
    rows: Vec<Vec<f64>>,
}

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
    pub(crate) fn new(patch: &Patch) -> Self {
        let mut variables = patch.all_variables();
        variables.retain(|variable| RUN_PANELS.iter().any(|(_, _, shows)| shows(&variable.output)));
        Self { title: patch.name().to_owned(), variables, times: Vec::new(), rows: Vec::new() }
    }

    pub(crate) fn add(&mut self, run: &mut PatchRun) {
        let mut values = vec![0.0; self.variables.len()];
        run.evaluate(&self.variables, &mut values);
        self.times.push(run.time());
        self.rows.push(values);
    }

    fn chart(&self, &(quantity, unit, shows): &RunPanel) -> Chart {
        let shown = self.variables.iter().enumerate().filter(|(_, variable)| shows(&variable.output));
        let shown = shown.map(|(i, variable)| (i, variable.name.as_str()));
        over_time((quantity, unit), &self.times, &self.rows, shown)
    }
}

impl Figure for PatchHistory {
    fn size(&self) -> (u32, u32) {
        (1000, 1080)
    }

    fn title(&self) -> &str {
        &self.title
    }

    fn draw<B: Backend>(&self, canvas: &Canvas<B>) -> DrawResult {
        let canvases = canvas.split_evenly((RUN_PANELS.len(), 1));
        RUN_PANELS.iter().zip(&canvases).try_for_each(|(panel, canvas)| self.chart(panel).draw_with_legend(canvas))
    }
}
