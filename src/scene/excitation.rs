//! Reading of `[[excitation]]`.

use super::allowed;
use super::form::{Form, FormKeys};
use super::table::TableReader;
use super::{Path, Phase, SceneError};

const KEYS: [&str; 5] = ["duration", "u_rate", "w_rate", "u_sine", "w_sine"];
const OF_FORM: FormKeys = FormKeys { direct: &["until_force"], material: &["until_pressure"] };

pub(super) fn read_phase(table: &mut TableReader<'_>, form: Form) -> Result<Phase, SceneError> {
    form.allow(table, &KEYS, &OF_FORM)?;
    Ok(Phase {
        duration: table.number("duration", &allowed::DURATION)?,
        u: read_path(table, "u_rate", "u_sine")?,
        w: read_path(table, "w_rate", "w_sine")?,
        until_force: table.optional_number("until_force", &allowed::FORCE)?,
        until_pressure: table.optional_number("until_pressure", &allowed::PRESSURE)?,
    })
}

fn read_path(table: &mut TableReader<'_>, rate: &'static str, sine: &'static str) -> Result<Path, SceneError> {
    let rate = table.optional_number(rate, &allowed::RATE)?.unwrap_or(0.0);
    let (amplitude, frequency) = table.optional_table(sine, read_sine)?.unwrap_or((0.0, 0.0));
    Ok(Path { rate, amplitude, frequency })
}

fn read_sine(table: &mut TableReader<'_>) -> Result<(f64, f64), SceneError> {
    table.allow(&["amplitude", "frequency"])?;
    Ok((table.number("amplitude", &allowed::AMPLITUDE)?, table.number("frequency", &allowed::FREQUENCY)?))
}
