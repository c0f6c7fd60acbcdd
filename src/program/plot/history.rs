//! The picture of a run: forces, contacts and dissipation over time.

use std::path::Path;

use asperity::outputs::{Output, Variable, variables};
use asperity::scene::{OutputGroup, Scene};
use asperity::simulation::Simulation;

use super::axis::Axis;
use super::chart::Chart;
use super::curve::{Curve, Stroke};
use super::linear::Fit;
use super::picture::write;
use crate::program::files::FileError;

const SIZE: (u32, u32) = (1000, 1080);

/// What the picture of a run shows, kept row by row.
#[derive(Debug)]
pub(crate) struct History {
    scene: Scene,
    variables: Vec<Variable>,
    times: Vec<f64>,
    rows: Vec<Vec<f64>>,
}

/// One chart of the picture: its quantity, its unit, which outputs it shows.
type Panel = (&'static str, &'static str, fn(&Output) -> bool);

const PANELS: [Panel; 3] = [
    ("force on the carrier", "N", |output| matches!(output, Output::ForceX | Output::ForceZ)),
    ("masses", "", |output| matches!(output, Output::ContactCount | Output::StickingCount)),
    ("energy lost", "J", |output| {
        use Output::{DamperEnergy, DissipatedEnergy, FrictionEnergy, ImpactEnergy, MaxwellEnergy};
        matches!(output, DissipatedEnergy | DamperEnergy | MaxwellEnergy | FrictionEnergy | ImpactEnergy)
    }),
];

impl History {
    /// Nothing seen yet.
    pub(crate) fn new(scene: &Scene) -> Self {
        let scene = with_groups(scene);
        let shown = |variable: &Variable| PANELS.iter().any(|(_, _, shows)| shows(&variable.output));
        let variables = variables(&scene).into_iter().filter(shown).collect();
        Self { scene, variables, times: Vec::new(), rows: Vec::new() }
    }

    /// The scene with the output groups that the picture needs.
    pub(crate) fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Keeps a row.
    pub(crate) fn add(&mut self, time: f64, simulation: &mut Simulation) {
        let mut values = vec![0.0; self.variables.len()];
        simulation.evaluate(&self.variables, &mut values);
        self.times.push(time);
        self.rows.push(values);
    }

    /// Draws the picture.
    pub(crate) fn draw(&self, path: &Path, name: &str) -> Result<(), FileError> {
        write(path, SIZE, Some(name), |canvas| {
            let canvases = canvas.split_evenly((PANELS.len(), 1));
            PANELS.iter().zip(&canvases).try_for_each(|(panel, canvas)| self.chart(panel).draw_with_legend(canvas))
        })
    }

    fn chart(&self, &(quantity, unit, shows): &Panel) -> Chart {
        let shown = self.variables.iter().enumerate().filter(|(_, variable)| shows(&variable.output));
        let curve = |(look, (i, variable)): (usize, (usize, &Variable))| Curve {
            name: short_name(&variable.name).to_owned(),
            look,
            stroke: Stroke::Line,
            points: self.times.iter().zip(&self.rows).map(|(&time, row)| (time, row[i])).collect(),
        };
        let curves: Vec<Curve> = shown.enumerate().map(curve).collect();
        let values = curves.iter().flat_map(|curve| &curve.points).map(|point| point.1);
        Chart {
            title: String::new(),
            x: Axis::linear("time", "s", self.times.iter().copied(), Fit::Tight),
            y: Axis::linear(quantity, unit, values, Fit::Round),
            curves,
        }
    }
}

/// Without the group, which the chart's axis tells: `E_damper` of `dissipation.E_damper`.
fn short_name(name: &str) -> &str {
    name.rsplit_once('.').map_or(name, |(_, field)| field)
}

fn with_groups(scene: &Scene) -> Scene {
    let needed = |group: &OutputGroup| {
        matches!(group, OutputGroup::Forces | OutputGroup::Contact | OutputGroup::Dissipation)
            || scene.outputs.contains(group)
    };
    Scene { outputs: OutputGroup::ALL.into_iter().filter(needed).collect(), ..scene.clone() }
}
