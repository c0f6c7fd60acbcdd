//! Figures of several charts: a run over time, a profile and its spectrum, curves over a logarithmic axis.

use asperity::outputs::{Output, Snapshot, Variable, variables};
use asperity::scene::{OutputGroup, Scene};

use super::axis::{Axis, Fit, is_loggable};
use super::chart::{Chart, Curve, Legend, Stroke, Symbol};
use super::{Backend, Canvas, DrawResult, FINE, Figure};

#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Panel {
    /// In [`Stacked`] the title of the vertical axis, in [`SideBySide`] that of the chart.
    pub(crate) title: String,
    /// In the order of the legend.
    pub(crate) curves: Vec<Curve>,
}

fn points<'a>(panels: impl IntoIterator<Item = &'a Panel>) -> impl Iterator<Item = (f64, f64)> {
    panels.into_iter().flat_map(|panel| &panel.curves).flat_map(|curve| curve.points.iter().copied())
}

/// Charts below each other with the same horizontal axis; each has a legend and a vertical axis of its own. All axes
/// are logarithmic.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Stacked {
    pub(crate) title: String,
    /// The title of the horizontal axes.
    pub(crate) x_title: String,
    pub(crate) panels: Vec<Panel>,
}

impl Figure for Stacked {
    fn size(&self) -> (u32, u32) {
        (900, 380 * self.panels.len() as u32)
    }

    fn title(&self) -> &str {
        &self.title
    }

    fn draw<B: Backend>(&self, canvas: &Canvas<B>) -> DrawResult {
        // A point that the vertical axis cannot show does not widen the horizontal one, and the other way round.
        let x = points(&self.panels).filter(|point| is_loggable(point.1)).map(|point| point.0);
        let x = Axis::logarithmic(&self.x_title, x);
        let canvases = canvas.split_evenly((self.panels.len(), 1));
        self.panels.iter().zip(&canvases).try_for_each(|(panel, canvas)| {
            let y = points([panel]).filter(|point| is_loggable(point.0)).map(|point| point.1);
            let (y, curves) = (Axis::logarithmic(&panel.title, y), panel.curves.clone());
            Chart { title: String::new(), x: x.clone(), y, curves }.draw_with_legend(canvas)
        })
    }
}

/// Charts side by side with the same axes, a logarithmic horizontal and a linear vertical one, and one legend. There, a
/// solid line stands for its colour, other strokes for those curves in any colour.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct SideBySide {
    /// The title of the horizontal axes.
    pub(crate) x_title: String,
    /// The title of the vertical axes.
    pub(crate) y_title: String,
    pub(crate) panels: Vec<Panel>,
}

impl Figure for SideBySide {
    fn size(&self) -> (u32, u32) {
        (self.width(), 480 + self.legend().height() / FINE)
    }

    fn draw<B: Backend>(&self, canvas: &Canvas<B>) -> DrawResult {
        let x = Axis::logarithmic(&self.x_title, points(&self.panels).map(|point| point.0));
        let y = Axis::linear(&self.y_title, "", points(&self.panels).map(|point| point.1), Fit::Round);
        let legend = self.legend();
        let (above, below) = canvas.split_vertically(legend.height());
        legend.draw(&above)?;
        let canvases = below.split_evenly((1, self.panels.len()));
        self.panels.iter().zip(&canvases).try_for_each(|(panel, canvas)| {
            let Panel { title, curves } = panel.clone();
            Chart { title, x: x.clone(), y: y.clone(), curves }.draw(canvas)
        })
    }
}

impl SideBySide {
    fn width(&self) -> u32 {
        if self.panels.len() == 1 { 800 } else { 460 * self.panels.len() as u32 }
    }

    /// Solid lines first.
    fn legend(&self) -> Legend {
        let curves = |solid: bool| {
            let all = self.panels.iter().flat_map(|panel| &panel.curves);
            all.filter(move |curve| (curve.stroke == Stroke::Line) == solid)
        };
        let solid = curves(true).map(|curve| (curve.name.as_str(), Symbol::for_curve(curve)));
        let others = curves(false).map(|curve| (curve.name.as_str(), Symbol::for_stroke(curve.stroke)));
        Legend::new(solid.chain(others), self.width() * FINE)
    }
}

/// A figure, with its title, and another one below it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Below<A, B>(pub(crate) A, pub(crate) B);

impl<A: Figure, B: Figure> Figure for Below<A, B> {
    fn size(&self) -> (u32, u32) {
        let (upper, lower) = (self.0.size(), self.1.size());
        (upper.0.max(lower.0), upper.1 + lower.1)
    }

    fn title(&self) -> &str {
        self.0.title()
    }

    fn draw<C: Backend>(&self, canvas: &Canvas<C>) -> DrawResult {
        // What the title leaves of the height is the upper figure's.
        let (upper, lower) = canvas.split_vertically(canvas.dim_in_pixel().1 - self.1.size().1 * FINE);
        self.0.draw(&upper)?;
        self.1.draw(&lower)
    }
}

/// Charts below each other over the same linear axis; each has a legend and a vertical axis of its own.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct LinearStack {
    /// The quantity of the horizontal axes and its unit.
    pub(crate) x: (&'static str, &'static str),
    pub(crate) panels: Vec<LinearPanel>,
}

#[derive(Clone, Debug, PartialEq)]
pub(crate) struct LinearPanel {
    /// Of the vertical axis.
    pub(crate) quantity: &'static str,
    pub(crate) unit: &'static str,
    /// In the order of the legend.
    pub(crate) curves: Vec<Curve>,
}

impl Figure for LinearStack {
    fn size(&self) -> (u32, u32) {
        (1000, 260 * self.panels.len() as u32)
    }

    fn draw<B: Backend>(&self, canvas: &Canvas<B>) -> DrawResult {
        let canvases = canvas.split_evenly((self.panels.len(), 1));
        self.panels.iter().zip(&canvases).try_for_each(|(panel, canvas)| panel.chart(self.x).draw_with_legend(canvas))
    }
}

impl LinearPanel {
    fn chart(&self, (quantity, unit): (&str, &str)) -> Chart {
        let points = || self.curves.iter().flat_map(|curve| &curve.points);
        Chart {
            title: String::new(),
            x: Axis::linear(quantity, unit, points().map(|point| point.0), Fit::Tight),
            y: Axis::linear(self.quantity, self.unit, points().map(|point| point.1), Fit::Round),
            curves: self.curves.clone(),
        }
    }
}

/// A run over time: forces, the speed of a carrier that is a body, contacts and energy lost, collected row by row.
#[derive(Debug)]
pub(crate) struct TimeHistory {
    scene: Scene,
    variables: Vec<Variable>,
    times: Vec<f64>,
    rows: Vec<Vec<f64>>,
}

/// A chart of a run: the quantity, its unit, and which outputs it shows.
type RunPanel = (&'static str, &'static str, fn(&Output) -> bool);

const RUN_PANELS: [RunPanel; 4] = [
    ("force on the carrier", "N", |output| {
        matches!(output, Output::ForceX | Output::ForceZ | Output::DriveX | Output::DriveZ)
    }),
    ("speed of the carrier", "m/s", |output| matches!(output, Output::CarrierURate | Output::CarrierWRate)),
    ("masses", "", |output| matches!(output, Output::ContactCount | Output::StickingCount)),
    ("energy lost", "J", |output| {
        use Output::{DamperEnergy, DissipatedEnergy, FrictionEnergy, ImpactEnergy, MaxwellEnergy};
        matches!(output, DissipatedEnergy | DamperEnergy | MaxwellEnergy | FrictionEnergy | ImpactEnergy)
    }),
];

impl TimeHistory {
    pub(crate) fn new(scene: &Scene) -> Self {
        let shows = |group: &OutputGroup| {
            matches!(group, OutputGroup::Forces | OutputGroup::Contact | OutputGroup::Dissipation)
                || (*group == OutputGroup::Carrier && scene.carrier.any())
                || scene.outputs.contains(group)
        };
        let scene = Scene { outputs: OutputGroup::ALL.into_iter().filter(shows).collect(), ..scene.clone() };
        let is_drawn = |variable: &Variable| RUN_PANELS.iter().any(|(_, _, shows)| shows(&variable.output));
        let variables = variables(&scene).into_iter().filter(is_drawn).collect();
        Self { scene, variables, times: Vec::new(), rows: Vec::new() }
    }

    /// The scene, with the output groups that the figure needs.
    pub(crate) fn scene(&self) -> &Scene {
        &self.scene
    }

    pub(crate) fn add(&mut self, time: f64, snapshot: &Snapshot<'_>) {
        let mut values = vec![0.0; self.variables.len()];
        snapshot.evaluate(&self.variables, &mut values);
        self.times.push(time);
        self.rows.push(values);
    }

    /// The panels that have something to show: no carrier that is prescribed.
    fn panels(&self) -> impl Iterator<Item = &'static RunPanel> {
        RUN_PANELS.iter().filter(|(_, _, shows)| self.variables.iter().any(|variable| shows(&variable.output)))
    }

    fn chart(&self, &(quantity, unit, shows): &RunPanel) -> Chart {
        let shown = self.variables.iter().enumerate().filter(|(_, variable)| shows(&variable.output));
        // Without the group: `E_damper` of `dissipation.E_damper`.
        let shown = shown.map(|(i, variable)| (i, variable.name.rsplit('.').next().unwrap_or_default()));
        over_time((quantity, unit), &self.times, &self.rows, shown)
    }
}

/// The chart of a `quantity` in its unit over the `times` (s) of rows: the columns `shown`, with their names.
pub(super) fn over_time<'a>(
    (quantity, unit): (&'static str, &'static str),
    times: &[f64],
    rows: &[Vec<f64>],
    shown: impl Iterator<Item = (usize, &'a str)>,
) -> Chart {
    let curve = |(look, (i, name)): (usize, (usize, &str))| Curve {
        name: name.to_owned(),
        look,
        stroke: Stroke::Line,
        points: times.iter().zip(rows).map(|(&time, row)| (time, row[i])).collect(),
    };
    let curves: Vec<Curve> = shown.enumerate().map(curve).collect();
    let values = curves.iter().flat_map(|curve| &curve.points).map(|point| point.1);
    let y = Axis::linear(quantity, unit, values, Fit::Round);
    let x = Axis::linear("time", "s", times.iter().copied(), Fit::Tight);
    Chart { title: String::new(), x, y, curves }
}

impl Figure for TimeHistory {
    fn size(&self) -> (u32, u32) {
        (1000, 360 * self.panels().count() as u32)
    }

    fn title(&self) -> &str {
        &self.scene.name
    }

    fn draw<B: Backend>(&self, canvas: &Canvas<B>) -> DrawResult {
        let canvases = canvas.split_evenly((self.panels().count(), 1));
        self.panels().zip(&canvases).try_for_each(|(panel, canvas)| self.chart(panel).draw_with_legend(canvas))
    }
}

/// A profile: its heights above, its power spectrum below.
#[derive(Clone, Debug)]
pub(crate) struct ProfilePicture {
    pub(crate) title: String,
    /// x and z, m.
    pub(crate) heights: Vec<(f64, f64)>,
    /// Wave numbers (rad/m) and densities (m³).
    pub(crate) spectrum: Vec<(f64, f64)>,
    /// Wave numbers (rad/m) and densities (m³) of the fitted power law; empty for none.
    pub(crate) law: Vec<(f64, f64)>,
}

/// The bottom of the profile's chart, subpixels from the top.
const SPLIT: u32 = 330 * FINE;
/// Intervals along the figure; of a profile with many points the highest and the lowest of each are drawn.
const COLUMNS: usize = 1500;

impl Figure for ProfilePicture {
    fn size(&self) -> (u32, u32) {
        (1000, 860)
    }

    fn title(&self) -> &str {
        &self.title
    }

    fn draw<B: Backend>(&self, canvas: &Canvas<B>) -> DrawResult {
        let (above, below) = canvas.split_vertically(SPLIT);
        self.profile().draw_with_legend(&above)?;
        self.power_spectrum().draw_with_legend(&below)
    }
}

impl ProfilePicture {
    fn profile(&self) -> Chart {
        let points = outline(&self.heights);
        Chart {
            title: String::new(),
            x: Axis::linear("x", "m", points.iter().map(|point| point.0), Fit::Tight),
            y: Axis::linear("z", "m", points.iter().map(|point| point.1), Fit::Round),
            curves: vec![Curve { name: "profile".into(), look: 0, stroke: Stroke::Line, points }],
        }
    }

    fn power_spectrum(&self) -> Chart {
        // Beyond a cut-off there are rounding errors alone, which are not drawn.
        let largest = self.spectrum.iter().map(|point| point.1).fold(0.0, f64::max);
        let spectrum = self.spectrum.iter().copied().filter(|point| point.1 > 1e-16 * largest).collect::<Vec<_>>();
        let all = || spectrum.iter().chain(&self.law);
        Chart {
            title: String::new(),
            x: Axis::logarithmic("wave number in rad/m", all().map(|point| point.0)),
            y: Axis::logarithmic("power spectrum in m³", all().map(|point| point.1)),
            curves: vec![
                Curve { name: "spectrum".into(), look: 0, stroke: Stroke::Line, points: spectrum },
                Curve { name: "power law".into(), look: 1, stroke: Stroke::Dashed, points: self.law.clone() },
            ],
        }
    }
}

/// Points that look like all of `points`: of many, the highest and the lowest of each interval.
fn outline(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    if points.len() <= 2 * COLUMNS {
        return points.to_vec();
    }
    let ends = |part: &[(f64, f64)]| -> [(f64, f64); 2] {
        let first = part[0];
        let low = part.iter().copied().fold(first, |low, point| if point.1 < low.1 { point } else { low });
        let high = part.iter().copied().fold(first, |high, point| if point.1 > high.1 { point } else { high });
        if low.0 < high.0 { [low, high] } else { [high, low] }
    };
    points.chunks(points.len().div_ceil(COLUMNS)).flat_map(ends).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_outline_keeps_the_extremes_and_the_order() {
        let points: Vec<(f64, f64)> = (0..100_000).map(|i| (f64::from(i), f64::from(i * 7919 % 1009))).collect();
        let drawn = outline(&points);
        assert!(drawn.len() <= 2 * COLUMNS && drawn.windows(2).all(|pair| pair[0].0 <= pair[1].0));
        let heights = || drawn.iter().map(|point| point.1);
        assert_eq!((heights().fold(f64::MAX, f64::min), heights().fold(f64::MIN, f64::max)), (0.0, 1008.0));
    }
}
