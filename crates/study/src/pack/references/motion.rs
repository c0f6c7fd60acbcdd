//! How the inputs of an FMU go in its experiment: of a layer along the excitation, of an element or a patch pressed and
//! slid to and fro within its table.

use asperity::element::{Node, PointContact, Quantity, Table};
use asperity::patch::Patch;
use asperity::scene::{Input, Phase, Scene, Value};
use asperity_fmi::{Definition, Inputs, VariableRef};

use crate::robustness::Budget;
use crate::runner::{InputSample, Rows, Runner, start};

/// Even intervals of an experiment.
const INTERVALS: u32 = 200;
/// Most rows: those of an excitation of many phases are thinned.
const MOST_ROWS: usize = 250;

/// Values of the inputs, in their order, at times: straight from row to row.
#[derive(Debug)]
pub(super) struct InputMotion {
    /// s, rising.
    pub(super) times: Vec<f64>,
    /// In the inputs' own units.
    pub(super) values: Vec<Vec<f64>>,
}

impl InputMotion {
    /// That of a definition; `None` where there is none, as of a scene without an excitation.
    pub(super) fn new(definition: &Definition, budget: Budget) -> Option<Self> {
        let inputs = definition.inputs();
        let motion = match definition {
            Definition::Layer(scene) => Self::of_layer(scene, budget),
            Definition::Element(contact) => Self::of_element(contact, &inputs),
            Definition::Patch(patch) => Self::of_patch(patch, &inputs),
        };
        motion.filter(|motion| motion.times.len() > 1)
    }

    /// Every `every`th row, the first and the last.
    pub(super) fn thinned(self, every: usize) -> Self {
        let last = self.times.len() - 1;
        let is_kept = |i: usize| i.is_multiple_of(every.max(1)) || i == last;
        let kept = |i: &usize| is_kept(*i);
        Self {
            times: (0..=last).filter(kept).map(|i| self.times[i]).collect(),
            values: (0..=last).filter(kept).map(|i| self.values[i].clone()).collect(),
        }
    }

    /// Sets the inputs in these slots to row `i` and their rates to the next.
    pub(super) fn set(&self, inputs: &mut Inputs, slots: &[usize], i: usize) {
        let next = (i + 1).min(self.times.len() - 1);
        let duration = self.times[next] - self.times[i];
        for (column, &slot) in slots.iter().enumerate() {
            let (here, there) = (self.values[i][column], self.values[next][column]);
            inputs.set(slot, here);
            inputs.set_rate(slot, if next > i { (there - here) / duration } else { 0.0 });
        }
    }

    fn of_layer(scene: &Scene, budget: Budget) -> Option<Self> {
        let durations = durations(scene, budget)?;
        let total: f64 = durations.iter().sum();
        let rows = Rows::Within { longest: total / f64::from(INTERVALS), parts: 1 };
        let start = start(scene, 0.0);
        let temperature = start.temperature.unwrap_or(scene.input_start(Input::Temperature));
        let mut carrier = InputSample { load: start.load, pull: start.pull, temperature, ..InputSample::default() };
        let mut samples = vec![carrier];
        for (phase, duration) in scene.excitation.iter().zip(durations) {
            let motion = phase.motion(scene.layer.area());
            samples.extend(rows.times(duration).map(|s| carrier.after(&motion, s)));
            carrier = carrier.after(&motion, duration);
        }
        let inputs = scene.inputs();
        let values = |sample: &InputSample| inputs.iter().map(|&input| sample.input(input)).collect();
        let motion = Self {
            times: samples.iter().map(|sample| sample.time).collect(),
            values: samples.iter().map(values).collect(),
        };
        let every = motion.times.len().div_ceil(MOST_ROWS);
        Some(motion.thinned(every))
    }

    fn of_element(contact: &PointContact, inputs: &[VariableRef]) -> Option<Self> {
        let press = Press::new(contact.table())?;
        let [u, w] = [Input::U, Input::W].map(Input::name);
        Some(press.motion(inputs, u, (w, press.depth)))
    }

    fn of_patch(patch: &Patch, inputs: &[VariableRef]) -> Option<Self> {
        let press = Press::new(patch.table())?;
        Some(press.motion(inputs, "x", ("z", press.depth)))
    }
}

/// The durations of the phases, s; those that a force ends are found by a run within a budget, whose phases up to there
/// count.
fn durations(scene: &Scene, budget: Budget) -> Option<Vec<f64>> {
    let is_open = |phase: &Phase| phase.until_force.is_some() || phase.until_pressure.is_some();
    if !scene.excitation.iter().any(is_open) {
        return Some(scene.excitation.iter().map(|phase| phase.duration).collect());
    }
    let mut runner = Runner::new(&budget.limit(scene), Rows::PerPhase(1), 0.0).ok()?;
    let run = |phase: &Phase| runner.run_phase(phase, |_, _| std::ops::ControlFlow::Continue(())).ok();
    Some(scene.excitation.iter().map_while(run).collect())
}

/// A short press to the middle of a table, and a slide to and fro there.
struct Press {
    /// How far it is pressed from just above the touch, m: negative.
    depth: f64,
    /// Speed of the slide, m/s.
    speed: f64,
    /// The time in which what sticks passes the way to slip, s.
    stick_time: f64,
}

/// The rows of each part, and its duration over the time to slip.
const PRESS: (u32, f64) = (40, 20.0);
const SLIDE: (u32, f64) = (60, 10.0);

impl Press {
    fn new(table: &Table) -> Option<Self> {
        let grid = &table.grid;
        let middle = |axis: &[f64]| axis.len() / 2;
        let node = Node {
            temperature: middle(&grid.temperatures),
            load: middle(&grid.loads).min(grid.loads.len().checked_sub(2)?),
            speed: middle(&grid.speeds),
        };
        let clear = PointContact::new(table.clone()).clear_displacement();
        let depth = table.value(Quantity::Separation, node) - table.rest_separation - clear;
        let speed = *grid.speeds.get(node.speed)?;
        let stick_time = table.stick_time_at(node)?;
        (depth < 0.0).then_some(Self { depth, speed, stick_time })
    }

    /// All inputs at their start values but these two.
    fn motion(&self, inputs: &[VariableRef], along: &str, (down, depth): (&str, f64)) -> InputMotion {
        let mut motion = InputMotion { times: Vec::new(), values: Vec::new() };
        let (mut time, mut u) = (0.0, 0.0);
        let mut row = |time: f64, u: f64, z: f64| {
            let value = |input: &VariableRef| {
                let start = if let Some(Value::Real(start)) = input.start { start } else { 0.0 };
                match input.name.as_str() {
                    name if name == along => start + u,
                    name if name == down => start + z,
                    _ => start,
                }
            };
            motion.times.push(time);
            motion.values.push(inputs.iter().map(value).collect());
        };
        row(time, u, 0.0);
        let step = |(rows, times): (u32, f64)| times * self.stick_time / f64::from(rows);
        for i in 1..=PRESS.0 {
            time += step(PRESS);
            row(time, u, depth * f64::from(i) / f64::from(PRESS.0));
        }
        for direction in [1.0, -1.0] {
            for _ in 0..SLIDE.0 {
                time += step(SLIDE);
                u += direction * self.speed * step(SLIDE);
                row(time, u, depth);
            }
        }
        motion
    }
}
