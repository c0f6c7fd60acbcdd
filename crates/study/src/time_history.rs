//! A run over time as a picture: forces, the speed of a carrier that is a body, contacts and energy lost, collected row by
//! row.

use asperity::outputs::{Output, Snapshot, Variable, variables};
use asperity::scene::{OutputGroup, Scene};

use crate::picture::{Axis, Fit, Mark, Panel, Picture, ys};

/// What is collected of a run.
#[derive(Debug)]
pub struct TimeHistory {
    scene: Scene,
    variables: Vec<Variable>,
    times: Vec<f64>,
    rows: Vec<Vec<f64>>,
}

/// A panel of a run: the quantity, its unit, and which outputs it shows.
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
    /// That of a run of a scene, without rows.
    pub fn new(scene: &Scene) -> Self {
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

    /// The scene, with the output groups that the picture needs.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Adds a row at a time (s).
    pub fn add(&mut self, time: f64, snapshot: &Snapshot<'_>) {
        let mut values = vec![0.0; self.variables.len()];
        snapshot.evaluate(&self.variables, &mut values);
        self.times.push(time);
        self.rows.push(values);
    }

    /// A panel for each quantity that there is: none of the speed of a carrier that is prescribed.
    pub fn picture(&self) -> Picture {
        let panel = |&(quantity, unit, shows): &RunPanel| {
            let shown = self.variables.iter().enumerate().filter(|(_, variable)| shows(&variable.output));
            // Without the group: `E_damper` of `dissipation.E_damper`.
            let shown = shown.map(|(i, variable)| (i, variable.name.rsplit('.').next().unwrap_or_default()));
            over_time((quantity, unit), &self.times, &self.rows, shown)
        };
        let panels = RUN_PANELS.iter().map(panel).filter(|panel| !panel.marks.is_empty());
        Picture::of(panels.map(Into::into).collect()).titled(&self.scene.name)
    }
}

/// The panel of a quantity and its unit over the `times` (s) of rows: the columns `shown`, with their names.
pub(crate) fn over_time<'a>(
    of: (&str, &str),
    times: &[f64],
    rows: &[Vec<f64>],
    shown: impl Iterator<Item = (usize, &'a str)>,
) -> Panel {
    let line = |(look, (i, name)): (usize, (usize, &str))| {
        Mark::line(name, look, times.iter().zip(rows).map(|(&time, row)| [time, row[i]]).collect())
    };
    let marks: Vec<Mark> = shown.enumerate().map(line).collect();
    let y = Axis::linear(of, ys(&marks), Fit::Round);
    Panel::new(Axis::linear(("time", "s"), times.iter().copied(), Fit::Tight), y, marks).sized(894.0, 264.0)
}

/// The rows nearest to the ends of even parts of the time from the first to the last of them.
pub(crate) fn ends_of_parts(times: &[f64], parts: usize) -> Vec<usize> {
    let (Some(first), Some(last)) = (times.first(), times.last()) else { return Vec::new() };
    let end = |part: usize| first + (last - first) * part as f64 / parts as f64;
    let nearest = |time: f64| {
        let after = times.partition_point(|&other| other < time).min(times.len() - 1);
        let before = after.saturating_sub(1);
        if time - times[before] < times[after] - time { before } else { after }
    };
    let mut rows: Vec<usize> = (1..=parts).map(|part| nearest(end(part))).collect();
    rows.dedup();
    rows
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_of_parts_are_the_rows_nearest_to_even_parts_of_the_time() {
        let times: Vec<f64> = (0..=100).map(|i| 2.0 + 0.01 * f64::from(i)).collect();
        assert_eq!(ends_of_parts(&times, 5), [20, 40, 60, 80, 100]);
        assert_eq!(ends_of_parts(&[0.0, 0.39, 0.62, 1.0], 5), [1, 2, 3]);
        assert_eq!((ends_of_parts(&[0.0], 5), ends_of_parts(&[], 5)), (vec![0], vec![]));
    }
}
