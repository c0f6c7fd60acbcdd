//! `[carrier]`, and the phases of `[[excitation]]`, whose keys depend on it.

use super::surface::Findings;
use super::table::{Result, TableReader};
use crate::scene::keys::At;
use crate::scene::motion_file;
use crate::scene::{Axis, CarrierBodies, CarrierBody, Force, Path, Phase, Scene, Wlf};

pub(super) fn read(table: &mut TableReader<'_>, scene: &mut Scene) -> Result<()> {
    for axis in Axis::ALL {
        table.optional_table(axis.name(), |table| {
            scene.carrier[axis] = Some(CarrierBody::default());
            table.fill(scene, At::axis(axis))?;
            match table.entry("start").filter(|_| table.has("initial")) {
                Some(entry) => Err(entry.refuse("no such key beside initial")),
                None => Ok(()),
            }
        })?;
    }
    Ok(())
}

/// The keys of a phase that move the carrier along an axis.
struct PhaseKeys {
    axis: Axis,
    rate: &'static str,
    sine: &'static str,
}

const U: PhaseKeys = PhaseKeys { axis: Axis::X, rate: "u_rate", sine: "u_sine" };
const W: PhaseKeys = PhaseKeys { axis: Axis::Z, rate: "w_rate", sine: "w_sine" };

/// The keys of a force in a phase.
struct ForceKeys {
    axis: Axis,
    start: &'static str,
    rate: &'static str,
    sine: &'static str,
}

impl ForceKeys {
    fn all(&self) -> [&'static str; 3] {
        [self.start, self.rate, self.sine]
    }
}

const LOAD: ForceKeys = ForceKeys { axis: Axis::Z, start: "load", rate: "load_rate", sine: "load_sine" };
const PULL: ForceKeys = ForceKeys { axis: Axis::X, start: "pull", rate: "pull_rate", sine: "pull_sine" };
const PRESSURE: ForceKeys =
    ForceKeys { axis: Axis::Z, start: "pressure", rate: "pressure_rate", sine: "pressure_sine" };

/// The phases of a table of the excitation: itself, or those between the rows of the file that it names.
pub(super) fn read_phases(
    table: &mut TableReader<'_>,
    carrier: &CarrierBodies,
    temperature: TemperatureInput<'_>,
    found: &mut Findings,
) -> Result<Vec<Phase>> {
    let Some(entry) = table.entry("file") else { return Ok(vec![read_phase(table, carrier, temperature)?]) };
    let phases = found.read_table(
        &entry,
        |formats, bytes, columns| formats.table(bytes, &motion_file::MOTION, columns),
        |table| motion_file::phases(table, carrier),
    )?;
    match phases.iter().find_map(|phase| motion_file::obstacle(phase, carrier, temperature)) {
        Some(expected) => Err(entry.refuse(format_args!("a file with {expected}"))),
        None => Ok(phases),
    }
}

/// One phase of the motion of a carrier that is a body along the axes of `carrier`.
fn read_phase(
    table: &mut TableReader<'_>,
    carrier: &CarrierBodies,
    temperature: TemperatureInput<'_>,
) -> Result<Phase> {
    let has_pressure = PRESSURE.all().into_iter().any(|key| table.has(key));
    if has_pressure && let Some(entry) = LOAD.all().into_iter().find_map(|key| table.entry(key)) {
        return Err(entry.refuse("no such key beside pressure, pressure_rate and pressure_sine"));
    }
    let pressure = if table.is_material() { read_force(table, &PRESSURE, carrier)? } else { None };
    Ok(Phase {
        duration: table.number("duration")?,
        u: read_motion(table, &U, carrier)?,
        w: read_motion(table, &W, carrier)?,
        load: read_force(table, &LOAD, carrier)?,
        pull: read_force(table, &PULL, carrier)?,
        pressure,
        temperature: read_temperature(table, temperature)?,
        until_force: table.optional_number("until_force")?,
        until_pressure: table.optional_number("until_pressure")?,
        is_row: false,
    })
}

/// `material.wlf` where the temperature is an input.
pub(super) type TemperatureInput<'a> = Option<&'a Wlf>;

fn read_temperature(table: &mut TableReader<'_>, input: TemperatureInput<'_>) -> Result<Option<f64>> {
    let Some(entry) = table.entry("temperature") else { return Ok(None) };
    let Some(wlf) = input else {
        return Err(entry.refuse("no such key without temperature = true in [input]"));
    };
    let temperature = entry.number()?;
    let checked = Wlf { temperature, ..*wlf }.check();
    checked.map_err(|error| entry.error(error.problem().clone())).map(|()| Some(temperature))
}

fn read_motion(table: &mut TableReader<'_>, keys: &PhaseKeys, carrier: &CarrierBodies) -> Result<Path> {
    if carrier[keys.axis].as_ref().is_some_and(|body| !body.has_drive()) {
        for key in [keys.rate, keys.sine] {
            let name = keys.axis.name();
            let reason =
                format_args!("no such key with [carrier.{name}] without stiffness and damping: it has no drive");
            refuse(table, key, reason)?;
        }
    }
    read_change(table, keys.rate, keys.sine)
}

/// A force; `None` where the phase names none of its keys.
fn read_force(table: &mut TableReader<'_>, keys: &ForceKeys, carrier: &CarrierBodies) -> Result<Option<Force>> {
    if carrier[keys.axis].as_ref().is_none() {
        for key in keys.all() {
            let name = keys.axis.name();
            refuse(table, key, format_args!("no such key without [carrier.{name}]: the displacement is prescribed"))?;
        }
    }
    let named = keys.all().into_iter().any(|key| table.has(key));
    let force = Force { start: table.optional_number(keys.start)?, change: read_change(table, keys.rate, keys.sine)? };
    Ok(named.then_some(force))
}

fn refuse(table: &mut TableReader<'_>, key: &'static str, expected: impl ToString) -> Result<()> {
    table.entry(key).map_or(Ok(()), |entry| Err(entry.refuse(expected)))
}

fn read_change(table: &mut TableReader<'_>, rate: &'static str, sine: &'static str) -> Result<Path> {
    let rate = table.optional_number(rate)?.unwrap_or(0.0);
    let sine = table.optional_table(sine, |table| {
        Ok(Path { rate, amplitude: table.number("amplitude")?, frequency: table.number("frequency")? })
    })?;
    Ok(sine.unwrap_or(Path { rate, ..Path::default() }))
}
