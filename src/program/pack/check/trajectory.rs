//! From stick to slip, back, and on again: what the element makes of it and what the layer does.

use std::path::PathBuf;

use asperity::element::PointContact;
use asperity::outputs::{Output, Variable, variable};
use asperity::scene::{Initial, MaterialParameter, OutputGroup, Parameter, Path, Scene, Value};
use asperity::simulation::{Motion, Simulation, Start};

use super::cells::{Check, element};
use crate::program::error::ProgramError;
use crate::program::excitation::Carrier;
use crate::program::result_file::ResultWriter;
use crate::program::text::Row;

/// Rows of each leg.
const ROWS: u32 = 200;
/// The ways of the legs, in the ways over which the spring sticks.
const LEGS: [f64; 3] = [10.0, -20.0, 20.0];

/// What both do, row by row.
struct Rows {
    carriers: Vec<Carrier>,
    layer: Vec<[f64; 4]>,
    element: Vec<[f64; 4]>,
}

/// Follows both from rest at the height of `check`, at its speed, and writes them as result files.
pub(super) fn run(
    contact: &PointContact,
    scene: &Scene,
    check: &Check,
    files: &[PathBuf; 2],
) -> Result<Vec<Row>, ProgramError> {
    let Ok(layer) = &check.layer else { return Ok(Vec::new()) };
    let outputs = [Output::ForceX, Output::ForceZ, Output::DissipatedPower, Output::DissipatedEnergy];
    let variables: Vec<Variable> = outputs.into_iter().filter_map(variable).collect();
    match follow(contact, scene, (check, layer.w), &variables) {
        Ok(rows) => {
            write(&files[0], &variables, &rows.carriers, &rows.layer)?;
            write(&files[1], &variables, &rows.carriers, &rows.element)?;
            Ok(texts(&rows, &variables, check))
        }
        Err(status) => Ok(vec![("", format!("to and fro at {:.3e} m/s: {status}", check.cell.speed))]),
    }
}

fn follow(
    contact: &PointContact,
    scene: &Scene,
    (check, w): (&Check, f64),
    variables: &[Variable],
) -> Result<Rows, String> {
    let start = Start { w, ..Start::default() };
    let mut element = element(contact, &check.cell, &start)?;
    let mut layer = Simulation::new(&prepared(scene, check.cell.temperature)?, &start).map_err(|e| e.to_string())?;
    let carrier = |u: f64, time: f64| Carrier { time, u, w };
    let mut rows = Rows { carriers: vec![carrier(0.0, 0.0)], layer: vec![[0.0; 4]], element: vec![[0.0; 4]] };
    layer.evaluate(variables, &mut rows.layer[0]);
    element.evaluate(variables, &mut rows.element[0]);
    let speed = check.cell.speed;
    let way = element.slip_way();
    if way <= 0.0 {
        return Err("no contact, or no friction".into());
    }
    for leg in LEGS {
        let (duration, rate) = ((leg * way).abs() / speed, leg.signum() * speed);
        let step = duration / f64::from(ROWS);
        let motion = Motion { duration: step, u: Path { rate, ..Path::default() }, w: Path::default() };
        for _ in 0..ROWS {
            layer.advance(&motion).map_err(|e| e.to_string())?;
            element.advance(step, (rate, 0.0)).map_err(|e| e.to_string())?;
            let (mut a, mut b) = ([0.0; 4], [0.0; 4]);
            layer.evaluate(variables, &mut a);
            element.evaluate(variables, &mut b);
            rows.carriers.push(carrier(layer.carrier().0, layer.time()));
            rows.layer.push(a);
            rows.element.push(b);
        }
    }
    Ok(rows)
}

/// The scene with what is compared among its outputs, pressed long ago.
fn prepared(scene: &Scene, temperature: Option<f64>) -> Result<Scene, String> {
    let outputs = vec![OutputGroup::Forces, OutputGroup::Dissipation];
    let mut scene = Scene { outputs, excitation: Vec::new(), ..scene.clone() };
    scene.layer.initial = Initial::Relaxed;
    if let Some(kelvin) = temperature {
        let parameter = Parameter::Material(MaterialParameter::Temperature);
        scene.set_parameter(parameter, Value::Real(kelvin)).map_err(|error| error.to_string())?;
    }
    Ok(scene)
}

fn write(
    path: &std::path::Path,
    variables: &[Variable],
    carriers: &[Carrier],
    rows: &[[f64; 4]],
) -> Result<(), ProgramError> {
    let mut writer = ResultWriter::create(path, variables)?;
    carriers.iter().zip(rows).try_for_each(|(carrier, row)| writer.write(*carrier, row))?;
    Ok(writer.finish()?)
}

/// The largest and the root mean square differences over the largest value of the layer.
fn texts(rows: &Rows, variables: &[Variable], check: &Check) -> Vec<Row> {
    let way = rows.carriers.iter().fold(0.0_f64, |way, carrier| way.max(carrier.u.abs()));
    let head =
        format!("to and fro by {way:.3e} m at {:.3e} m/s, from rest, over the layer's largest value", check.cell.speed);
    let of = |(i, variable): (usize, &Variable)| {
        let largest = rows.layer.iter().fold(f64::MIN_POSITIVE, |largest, row| largest.max(row[i].abs()));
        let errors = rows.layer.iter().zip(&rows.element).map(|(a, b)| (a[i] - b[i]).abs() / largest);
        let (most, squares) = errors.fold((0.0_f64, 0.0), |(most, sum), error| (most.max(error), sum + error * error));
        let square = (squares / rows.layer.len() as f64).sqrt();
        let text = format!(
            "{}: off by at most {:.2} %, in root mean square {:.2} %",
            variable.name,
            100.0 * most,
            100.0 * square
        );
        ("", text)
    };
    std::iter::once(("", head)).chain(variables.iter().enumerate().map(of)).collect()
}
