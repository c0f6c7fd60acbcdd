//! Figures of several charts: a run over time, a profile and its spectrum, curves over a logarithmic axis.

use asperity::outputs::{Output, Snapshot, Variable, variables};
use asperity::scene::{OutputGroup, Scene};

use super::axis::{Axis, Fit, is_loggable};
use super::caption::{Way, draw_caption, exaggeration};
use super::chart::{Chart, Curve, LEGEND_LINE, Legend, Stroke, Symbol};
use super::raster::Raster;
use super::{Backend, Canvas, DrawResult, FINE, Figure};

/// The height of a title, pixels.
const TITLE: u32 = 36;

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

/// Rows of charts side by side, all with the same logarithmic horizontal axis, the charts of a row with the same linear
/// vertical one, and one legend. There, solid lines and markers stand for their colours, other strokes for those curves
/// in any colour.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct SideBySide {
    pub(crate) title: String,
    /// The title of the horizontal axes.
    pub(crate) x_title: String,
    /// From top to bottom, with as many panels each.
    pub(crate) rows: Vec<PanelRow>,
}

/// Charts side by side, with the same axes.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct PanelRow {
    /// The title of the vertical axes.
    pub(crate) y_title: String,
    /// Titles are shown in the first row alone.
    pub(crate) panels: Vec<Panel>,
}

/// The heights of the first row of charts, alone and with others below it, and of each of these, pixels.
const ALONE: u32 = 480;
const FIRST: u32 = 420;
const OTHER: u32 = 280;

impl Figure for SideBySide {
    fn size(&self) -> (u32, u32) {
        let title = if self.title.is_empty() { 0 } else { TITLE };
        let rows = if self.rows.len() == 1 { ALONE } else { FIRST + OTHER * (self.rows.len() as u32 - 1) };
        (self.width(), title + rows + self.legend().height() / FINE)
    }

    fn title(&self) -> &str {
        &self.title
    }

    fn draw<B: Backend>(&self, canvas: &Canvas<B>) -> DrawResult {
        let all = self.rows.iter().flat_map(|row| &row.panels);
        let x = Axis::logarithmic(&self.x_title, points(all).map(|point| point.0));
        let legend = self.legend();
        let (above, mut below) = canvas.split_vertically(legend.height());
        legend.draw(&above)?;
        for (i, row) in self.rows.iter().enumerate() {
            let left = (self.rows.len() - 1 - i) as u32;
            let (own, others) = below.split_vertically(below.dim_in_pixel().1 - left * OTHER * FINE);
            row.draw(&own, &x, i == 0)?;
            below = others;
        }
        Ok(())
    }
}

impl PanelRow {
    fn draw<B: Backend>(&self, canvas: &Canvas<B>, x: &Axis, is_first: bool) -> DrawResult {
        let y = Axis::linear(&self.y_title, "", points(&self.panels).map(|point| point.1), Fit::Round);
        let canvases = canvas.split_evenly((1, self.panels.len()));
        self.panels.iter().zip(&canvases).try_for_each(|(panel, canvas)| {
            let Panel { title, curves } = panel.clone();
            let title = if is_first { title } else { String::new() };
            Chart { title, x: x.clone(), y: y.clone(), curves }.draw(canvas)
        })
    }
}

impl SideBySide {
    fn width(&self) -> u32 {
        let panels = self.rows.iter().map(|row| row.panels.len()).max().unwrap_or_default();
        if panels == 1 { 800 } else { 460 * panels as u32 }
    }

    /// Those that stand for their colours first.
    fn legend(&self) -> Legend {
        let curves = |coloured: bool| {
            let all = self.rows.iter().flat_map(|row| &row.panels).flat_map(|panel| &panel.curves);
            all.filter(move |curve| matches!(curve.stroke, Stroke::Line | Stroke::Marked) == coloured)
        };
        let coloured = curves(true).map(|curve| (curve.name.as_str(), Symbol::for_curve(curve)));
        let others = curves(false).map(|curve| (curve.name.as_str(), Symbol::for_stroke(curve.stroke)));
        Legend::new(coloured.chain(others), self.width() * FINE)
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

    fn images(&self) -> Vec<Raster> {
        let lower = self.1.images().into_iter().map(|image| image.below(self.0.size().1 * FINE));
        self.0.images().into_iter().chain(lower).collect()
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
        (1000, if let [_] = self.panels[..] { 620 } else { 260 * self.panels.len() as u32 })
    }

    fn draw<B: Backend>(&self, canvas: &Canvas<B>) -> DrawResult {
        let canvases = canvas.split_evenly((self.panels.len(), 1));
        self.panels.iter().zip(&canvases).try_for_each(|(panel, canvas)| panel.chart(self.x).draw_with_legend(canvas))
    }
}

/// The rubber above a profile that it slides on, and below it what is given over the same axis.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ContactCurves(pub(crate) LinearStack);

impl Figure for ContactCurves {
    fn size(&self) -> (u32, u32) {
        let (width, height) = self.0.size();
        (width, height + LEGEND_LINE / FINE)
    }

    fn draw<B: Backend>(&self, canvas: &Canvas<B>) -> DrawResult {
        let (above, below) = canvas.split_vertically(LEGEND_LINE);
        if let (Some(heights), Some(panel)) =
            (self.0.panels.first(), below.split_evenly((self.0.panels.len(), 1)).first())
        {
            let chart = heights.chart(self.0.x);
            let (_, panel) = panel.split_vertically(chart.legend(panel).height());
            draw_caption(&above, exaggeration(&panel, &chart.x, &chart.y), Some(Way::Right))?;
        }
        self.0.draw(&below)
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
    /// As it was read; `None` where that is what is used.
    pub(crate) read: Option<ProfileCurves>,
    pub(crate) used: ProfileCurves,
    /// Wave numbers (rad/m) and densities (m³) of the fitted power law; empty for none.
    pub(crate) law: Vec<(f64, f64)>,
}

#[derive(Clone, Debug)]
pub(crate) struct ProfileCurves {
    /// x and z, m.
    pub(crate) heights: Vec<(f64, f64)>,
    /// Wave numbers (rad/m) and densities (m³).
    pub(crate) spectrum: Vec<(f64, f64)>,
}

/// The bottom of the profile's chart, subpixels from the top.
const SPLIT: u32 = 330 * FINE;

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
    /// What was read, which what is used is drawn over, and that.
    fn curves(&self, of: impl Fn(&ProfileCurves) -> Vec<(f64, f64)>) -> Vec<Curve> {
        let curve = |name: &str, look: usize, stroke: Stroke, curves: &ProfileCurves| Curve {
            name: name.into(),
            look,
            stroke,
            points: of(curves),
        };
        let read = self.read.iter().map(|read| curve("as read", READ, Stroke::Dots, read));
        let name = if self.read.is_some() { "smoothed" } else { "profile" };
        read.chain([curve(name, 0, Stroke::Line, &self.used)]).collect()
    }

    fn profile(&self) -> Chart {
        let curves = self.curves(|curves| curves.heights.clone());
        let points = || curves.iter().flat_map(|curve| &curve.points);
        Chart {
            title: String::new(),
            x: Axis::linear("x", "m", points().map(|point| point.0), Fit::Tight),
            y: Axis::linear("z", "m", points().map(|point| point.1), Fit::Round),
            curves,
        }
    }

    fn power_spectrum(&self) -> Chart {
        let mut curves = self.curves(|curves| {
            // Beyond a cut-off there are rounding errors alone, which are not drawn.
            let largest = curves.spectrum.iter().map(|point| point.1).fold(0.0, f64::max);
            curves.spectrum.iter().copied().filter(|point| point.1 > 1e-16 * largest).collect()
        });
        curves.push(Curve { name: "power law".into(), look: 1, stroke: Stroke::Dashed, points: self.law.clone() });
        let points = || curves.iter().flat_map(|curve| &curve.points);
        Chart {
            title: String::new(),
            x: Axis::logarithmic("wave number in rad/m", points().map(|point| point.0)),
            y: Axis::logarithmic("power spectrum in m³", points().map(|point| point.1)),
            curves,
        }
    }
}

/// The colour of what was read.
const READ: usize = 4;
