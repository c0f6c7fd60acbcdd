//! Reading of `[material]`, its Prony series inline or from a file.

use super::surface::{Found, read_path};
use super::table::{Entry, TableReader, read_table};
use super::{Material, PronyTerm, SceneError, Wlf, allowed, prony_file};

const KEYS: [&str; 6] = ["density", "poisson_ratio", "equilibrium_modulus", "viscosity", "prony", "wlf"];
const PRONY: &str =
    "an array of tables, or the path of a CSV file beside the scene with relaxation_time (s) and modulus (Pa)";

pub(super) fn read_material(entry: &Entry<'_>, found: &mut Found) -> Result<Material, SceneError> {
    read_table(entry, |table| {
        table.allow(&KEYS)?;
        Ok(Material {
            density: table.number("density", &allowed::DENSITY)?,
            poisson_ratio: table.number("poisson_ratio", &allowed::POISSON_RATIO)?,
            equilibrium_modulus: table.number("equilibrium_modulus", &allowed::MODULUS)?,
            viscosity: table.optional_number("viscosity", &allowed::VISCOSITY)?,
            prony: read_prony(&table.required("prony", PRONY)?, found)?,
            wlf: table.optional_table("wlf", read_wlf)?,
        })
    })
}

fn read_prony(entry: &Entry<'_>, found: &mut Found) -> Result<Vec<PronyTerm>, SceneError> {
    if entry.text(PRONY).is_err() {
        return entry.elements(PRONY)?.iter().map(|entry| read_table(entry, read_term)).collect();
    }
    let path = read_path(entry)?;
    let terms = prony_file::read(entry, &path)?;
    found.add_file(path);
    Ok(terms)
}

fn read_term(table: &mut TableReader<'_>) -> Result<PronyTerm, SceneError> {
    table.allow(&["modulus", "relaxation_time"])?;
    Ok(PronyTerm {
        modulus: table.number("modulus", &allowed::MODULUS)?,
        relaxation_time: table.number("relaxation_time", &allowed::RELAXATION_TIME)?,
    })
}

fn read_wlf(table: &mut TableReader<'_>) -> Result<Wlf, SceneError> {
    table.allow(&["c1", "c2", "reference_temperature", "temperature"])?;
    let temperature = table.required("temperature", allowed::TEMPERATURE)?;
    let wlf = Wlf {
        c1: table.number("c1", &allowed::WLF_C1)?,
        c2: table.number("c2", &allowed::WLF_C2)?,
        reference_temperature: table.number("reference_temperature", &allowed::TEMPERATURE)?,
        temperature: temperature.number(&allowed::TEMPERATURE)?,
    };
    wlf.check().map_err(|error| temperature.problem(error.problem().clone()))?;
    Ok(wlf)
}
