//! `asperity pack --table TABLE.csv --check SCENE.toml`: the element against what was swept, in steady sliding between the
//! points of the table and along a motion to and fro. Of a table that was solved for the points are solved for too; to and
//! fro there is the layer alone, another model, of which the friction under the same load is compared.

use std::path::Path;

use asperity::element::{Element, Load, OperatingPoint, PointContact, SweepGrid};
use asperity::outputs::{Output, Variable, variable};
use asperity::scene::{Input, Parameter, Scene, Value};
use asperity::simulation::Start;
use rayon::prelude::*;

use super::drag::ToAndFro;
use super::{CheckError, ERROR, SLIDING_DISTANCE, deviation, folder_beside, scene_of, selected};
use crate::cli::Pack;
use crate::figure::{Curve, Figure as _, Ladder, LadderPanel, Ladders, LinearPanel, LinearStack, Rung, Stroke};
use crate::files::FileError;
use crate::result_file::{CsvWriter, ResultWriter};
use crate::terminal::{self, LabelledLine, labelled};
use asperity_study::csv::Head;
use asperity_study::decimals::real;
use asperity_study::runner::InputSample;
use asperity_study::sweep::{Method, StopBounds, Swept, SweptPoint};

/// What is compared in steady sliding.
const COMPARED: [&str; 3] = ["F_x", "F_z", "P_diss"];
/// What is compared along the motion to and fro.
const LOOP_OUTPUTS: [Output; 4] = [Output::ForceX, Output::ForceZ, Output::DissipatedPower, Output::DissipatedEnergy];

/// Compares the layer and the element, writes the results beside the FMU and summarises them.
pub(in crate::pack) fn check(
    command: &Pack,
    contact: &PointContact,
    scene: &Path,
) -> Result<Vec<LabelledLine>, CheckError> {
    let scene = scene_of(contact.table(), scene)?;
    let load = contact.table().load;
    let between = centres(&contact.table().grid);
    let swept = Swept::of_table(&scene, contact.table(), &between.temperatures)?;
    let folder = folder_beside(&command.output)?;
    let checks = check_points(
        contact,
        &scene,
        &swept,
        &selected(&between.points().collect::<Vec<_>>(), command.points as usize),
    );
    write_points(&folder.join("points.csv"), load, swept.name(), &checks)?;
    errors_plot(&checks, load).write(&folder.join("errors.svg"))?;
    let mut lines = summary(&checks);
    let compared: Vec<_> = checks.iter().filter(|check| check.errors().is_some()).collect();
    if let Some(middle) = compared.get(compared.len() / 2) {
        lines.extend(to_and_fro(contact, &scene, &swept, middle, &folder)?);
    }
    lines.push(("", format!("in {}", folder.display())));
    Ok(lines)
}

/// What was swept and the element at a point between those of the table.
#[derive(Debug)]
struct PointCheck {
    point: OperatingPoint,
    /// The status where it was not steady, after what it was.
    swept: Result<SweptPoint, String>,
    /// |F_x|, F_z and P_diss of the element at the same w.
    element: Option<Result<[f64; 3], String>>,
}

fn check_points(contact: &PointContact, scene: &Scene, swept: &Swept, points: &[OperatingPoint]) -> Vec<PointCheck> {
    let bar = terminal::bar(points.len() as u64);
    let check = |&point: &OperatingPoint| {
        let found = swept.sliding(scene, &point, contact.table().load, StopBounds { error: ERROR, distance: None });
        let element = found.as_ref().ok().map(|found| element_sliding(contact, &point, found.w));
        bar.inc(1);
        PointCheck { point, swept: found.map_err(|status| format!("{} {status}", swept.name())), element }
    };
    let checks = points.par_iter().with_max_len(1).map(check).collect();
    bar.finish_and_clear();
    checks
}

/// The grid of the centres of the cells of a grid; an axis of one value keeps it.
fn centres(grid: &SweepGrid) -> SweepGrid {
    let centres = |axis: &[f64], mean: fn(f64, f64) -> f64| match axis {
        [one] => vec![*one],
        _ => axis.windows(2).map(|ends| mean(ends[0], ends[1])).collect::<Vec<_>>(),
    };
    let geometric: fn(f64, f64) -> f64 = |a, b| (a * b).sqrt();
    SweepGrid {
        speeds: centres(&grid.speeds, geometric),
        loads: centres(&grid.loads, geometric),
        temperatures: centres(&grid.temperatures, f64::midpoint),
    }
}

/// The element at the temperature of a point.
pub(super) fn element_at(contact: &PointContact, point: &OperatingPoint, start: &Start) -> Result<Element, String> {
    let mut contact = contact.clone();
    if let (Some(kelvin), true) = (point.temperature, contact.table().grid.temperatures.len() > 1) {
        let parameter = Parameter::Temperature;
        contact.set_parameter(parameter, Value::Real(kelvin)).map_err(|error| error.to_string())?;
    }
    Element::new(&contact, start).map_err(|error| error.to_string())
}

fn element_sliding(contact: &PointContact, point: &OperatingPoint, w: f64) -> Result<[f64; 3], String> {
    let mut element = element_at(contact, point, &Start { w, u_rate: point.speed, ..Start::default() })?;
    element.advance(SLIDING_DISTANCE / point.speed, point.speed, 0.0).map_err(|error| error.to_string())?;
    let variables = LOOP_OUTPUTS[..3].iter().copied().filter_map(variable).collect::<Vec<_>>();
    let mut values = [0.0; 3];
    element.evaluate(&variables, &mut values);
    let [x, z, power] = values;
    Ok([-x, z, power])
}

impl PointCheck {
    /// Errors of the element relative to what was swept; `None` where one of them has no values.
    fn errors(&self) -> Option<[f64; 3]> {
        let (swept, element) = (self.swept_values()?, self.element.as_ref()?.as_ref().ok()?);
        Some(std::array::from_fn(|i| element[i] / swept[i] - 1.0))
    }

    fn swept_values(&self) -> Option<[f64; 3]> {
        self.swept.as_ref().ok().map(|swept| [swept.drag, swept.force_z, swept.power])
    }

    fn status(&self) -> String {
        match (&self.swept, &self.element) {
            (Err(status), _) => status.clone(),
            (_, Some(Err(status))) => format!("element: {status}"),
            _ => "compared".into(),
        }
    }

    fn fields(&self) -> Vec<String> {
        let text = |value: Option<f64>| value.map(real).unwrap_or_default();
        let point = self.point;
        let w = self.swept.as_ref().ok().map(|swept| swept.w);
        let mut fields = vec![real(point.speed), real(point.load), text(point.temperature), self.status(), text(w)];
        let element = self.element.as_ref().and_then(|element| element.as_ref().ok());
        for i in 0..COMPARED.len() {
            fields.push(text(self.swept_values().map(|values| values[i])));
            fields.push(text(element.map(|values| values[i])));
            fields.push(text(self.errors().map(|errors| errors[i])));
        }
        fields
    }
}

/// The largest and the root mean square errors, and what could not be compared.
fn summary(checks: &[PointCheck]) -> Vec<LabelledLine> {
    let errors: Vec<[f64; 3]> = checks.iter().filter_map(PointCheck::errors).collect();
    let mut texts = vec![format!("{} of {} points between the table's, in steady sliding", errors.len(), checks.len())];
    for (i, name) in COMPARED.iter().enumerate().filter(|_| !errors.is_empty()) {
        texts.push(deviation(name, errors.iter().map(|error| error[i])));
    }
    let failed = checks.iter().filter(|check| check.errors().is_none());
    texts.extend(
        failed.map(|check| format!("{:.3e} m/s, {:.3e}: {}", check.point.speed, check.point.load, check.status())),
    );
    labelled("Checked", texts)
}

fn write_points(path: &Path, load: Load, swept: &str, checks: &[PointCheck]) -> Result<(), FileError> {
    let mut head = vec!["speed [m/s]".to_owned(), format!("{} [{}]", load.name(), load.unit())];
    head.extend(["temperature [K]", "status", "w [m]"].map(String::from));
    head.extend(COMPARED.iter().flat_map(|name| [swept, "element", "error"].map(|of| format!("{name} {of}"))));
    let mut writer = CsvWriter::create(path, head.iter().map(String::as_str))?;
    checks.iter().try_for_each(|check| writer.write(check.fields()))?;
    writer.finish()
}

/// Errors over speed, one line for each load.
fn errors_plot(checks: &[PointCheck], load: Load) -> Ladders {
    let mut loads: Vec<f64> = checks.iter().map(|check| check.point.load).collect();
    loads.sort_by(f64::total_cmp);
    loads.dedup();
    let ladder = |look: usize, of: f64, i: usize| {
        let own = checks.iter().filter(|check| check.point.load == of);
        let rung =
            |check: &PointCheck| Some(Rung { x: check.point.speed, y: check.errors()?[i].abs(), label: String::new() });
        let name = format!("{of:.3e} {}", load.unit());
        Ladder { name, stroke: Stroke::Line, look, rungs: own.filter_map(rung).collect() }
    };
    let panel = |(i, name): (usize, &&str)| LadderPanel {
        title: format!("error of {name}, as a share of it"),
        floor: None,
        lines: Vec::new(),
        ladders: loads.iter().enumerate().map(|(look, &of)| ladder(look, of, i)).collect(),
    };
    Ladders { x_title: "speed in m/s".into(), panels: COMPARED.iter().enumerate().map(panel).collect() }
}

/// The layer and the element along the motion to and fro, row by row.
struct Loop {
    motion: ToAndFro,
    carriers: Vec<InputSample>,
    layer: Vec<[f64; LOOP_OUTPUTS.len()]>,
    element: Vec<[f64; LOOP_OUTPUTS.len()]>,
}

/// Drags both to and fro from rest at the height and the speed of `check`, the layer under the same load where something
/// else was swept; writes them as result files and plots them.
fn to_and_fro(
    contact: &PointContact,
    scene: &Scene,
    swept: &Swept,
    check: &PointCheck,
    folder: &Path,
) -> Result<Vec<LabelledLine>, CheckError> {
    let Ok(found) = &check.swept else { return Ok(Vec::new()) };
    let variables: Vec<Variable> = LOOP_OUTPUTS.into_iter().filter_map(variable).collect();
    let files = ["loop-layer.csv", "loop-element.csv"].map(|name| folder.join(name));
    let rows = height_of_layer(contact, scene, swept, check, found)
        .and_then(|of_layer| Loop::run(contact, scene, &check.point, [found.w, of_layer], &variables));
    let rows = match rows {
        Ok(rows) => rows,
        Err(status) => return Ok(vec![("", format!("to and fro at {:.3e} m/s: {status}", check.point.speed))]),
    };
    rows.write(&files[0], &variables, &rows.layer)?;
    rows.write(&files[1], &variables, &rows.element)?;
    rows.plot().write(&folder.join("loop.svg"))?;
    Ok(match swept {
        Swept::Layer => rows.summary("over the layer's largest value", &variables),
        Swept::Solved { .. } => {
            let head =
                "friction alone, beside the layer under the same load, which is another model; over its largest value";
            rows.summary(head, &variables[..1])
        }
    })
}

/// The displacement of the carrier (m) at which the layer bears what the element does at that of `found`.
fn height_of_layer(
    contact: &PointContact,
    scene: &Scene,
    swept: &Swept,
    check: &PointCheck,
    found: &SweptPoint,
) -> Result<f64, String> {
    if matches!(swept, Swept::Layer) {
        return Ok(found.w);
    }
    Method::Layer.check(scene).map_err(|error| error.to_string())?;
    let bounds = StopBounds { error: ERROR, distance: None };
    let layer = Swept::Layer.sliding(scene, &check.point, contact.table().load, bounds);
    layer.map(|layer| layer.w).map_err(|status| format!("layer {status}"))
}

impl Loop {
    /// The element and the layer with their carriers held at these w, m.
    fn run(
        contact: &PointContact,
        scene: &Scene,
        point: &OperatingPoint,
        [w, of_layer]: [f64; 2],
        variables: &[Variable],
    ) -> Result<Self, String> {
        let mut element = element_at(contact, point, &Start { w, ..Start::default() })?;
        let motion = ToAndFro { speed: point.speed, length: element.stick_length() };
        if motion.length <= 0.0 {
            return Err("no contact, or no friction".into());
        }
        let values = |element: &Element| {
            let mut values = [0.0; LOOP_OUTPUTS.len()];
            element.evaluate(variables, &mut values);
            values
        };
        let mut rows = vec![values(&element)];
        for (duration, rate) in motion.steps() {
            element.advance(duration, rate, 0.0).map_err(|error| error.to_string())?;
            rows.push(values(&element));
        }
        let layer = motion.layer(scene, point.temperature, of_layer, variables)?;
        Ok(Self { motion, carriers: motion.carriers(w), layer, element: rows })
    }

    fn write(&self, path: &Path, variables: &[Variable], rows: &[[f64; LOOP_OUTPUTS.len()]]) -> Result<(), FileError> {
        let mut writer = ResultWriter::create(path, &[Input::U, Input::W], variables, Head::Name)?;
        self.carriers.iter().zip(rows).try_for_each(|(carrier, row)| writer.write(*carrier, row))?;
        writer.finish()
    }

    /// -F_x, the first of the [`LOOP_OUTPUTS`], over u.
    fn plot(&self) -> LinearStack {
        let of = |(look, (name, rows)): (usize, (&str, &Vec<[f64; LOOP_OUTPUTS.len()]>))| Curve {
            name: name.to_owned(),
            look,
            stroke: Stroke::Line,
            points: self.carriers.iter().zip(rows).map(|(carrier, row)| (carrier.u, -row[0])).collect(),
        };
        let curves = [("layer", &self.layer), ("element", &self.element)].into_iter().enumerate().map(of).collect();
        LinearStack { x: ("u", "m"), panels: vec![LinearPanel { quantity: "-F_x", unit: "N", curves }] }
    }

    /// The largest and the root mean square differences of the `variables`, the first of the rows', over the largest value
    /// of the layer, and after the motion `what` they are.
    fn summary(&self, what: &str, variables: &[Variable]) -> Vec<LabelledLine> {
        let head = format!("{}, {what}", self.motion.describe());
        let of = |(i, variable): (usize, &Variable)| {
            let largest = self.layer.iter().fold(f64::MIN_POSITIVE, |largest, row| largest.max(row[i].abs()));
            let errors = self.layer.iter().zip(&self.element).map(|(a, b)| (a[i] - b[i]).abs() / largest);
            ("", deviation(&variable.name, errors))
        };
        std::iter::once(("", head)).chain(variables.iter().enumerate().map(of)).collect()
    }
}
