//! Reading of `[[excitation]]`.

use super::allowed;
use super::table::TableReader;
use super::{Path, Phase, SceneError};

const KEYS: [&str; 6] = ["duration", "u_rate", "w_rate", "u_sine", "w_sine", "until_force"];
const LATER: [&str; 1] = ["until_pressure"];

pub(super) fn read_phase(table: &mut TableReader<'_>) -> Result<Phase, SceneError> {
    table.allow(&KEYS, &LATER)?;
    Ok(Phase {
        duration: table.number("duration", &allowed::DURATION)?,
        u: read_path(table, "u_rate", "u_sine")?,
        w: read_path(table, "w_rate", "w_sine")?,
        until_force: table.optional_number("until_force", &allowed::FORCE)?,
    })
}

fn read_path(table: &mut TableReader<'_>, rate: &'static str, sine: &'static str) -> Result<Path, SceneError> {
    let rate = table.optional_number(rate, &allowed::RATE)?.unwrap_or(0.0);
    let (amplitude, frequency) = table.optional_table(sine, read_sine)?.unwrap_or((0.0, 0.0));
    Ok(Path { rate, amplitude, frequency })
}

fn read_sine(table: &mut TableReader<'_>) -> Result<(f64, f64), SceneError> {
    table.allow(&["amplitude", "frequency"], &[])?;
    Ok((table.number("amplitude", &allowed::AMPLITUDE)?, table.number("frequency", &allowed::FREQUENCY)?))
}
