//! Reading of `[friction]`, `[solver]`, `[input]` and `[fmu]`.

use super::allowed;
use super::form::{Form, FormKeys};
use super::table::{Entry, TableReader};
use super::{Extrapolation, Friction, Method, OutputGroup, RateShear, SceneError, Solver};

impl Default for Solver {
    /// The settings of a scene without `[solver]`.
    fn default() -> Self {
        Self {
            method: Method::Event,
            relative_tolerance: 1.0e-6,
            absolute_tolerance: None,
            max_steps: 10_000_000,
            reduce: 0.0,
        }
    }
}

pub(super) fn default_outputs() -> Vec<OutputGroup> {
    vec![OutputGroup::Forces, OutputGroup::Dissipation]
}

const FRICTION_OF_FORM: FormKeys = FormKeys { direct: &["shear_force"], material: &["shear_strength"] };
const RATE_SHEAR_OF_FORM: FormKeys = FormKeys { direct: &["force"], material: &["strength"] };

pub(super) fn read_friction(table: &mut TableReader<'_>, form: Form) -> Result<Friction, SceneError> {
    form.allow(table, &["coulomb", "rate_shear"], &FRICTION_OF_FORM)?;
    Ok(Friction {
        coulomb: table.optional_number("coulomb", &allowed::FRICTION_COEFFICIENT)?,
        shear_force: table.optional_number("shear_force", &allowed::SHEAR_FORCE)?,
        shear_strength: table.optional_number("shear_strength", &allowed::SHEAR_STRENGTH)?,
        rate_shear: table.optional_table("rate_shear", |table| read_rate_shear(table, form))?,
    })
}

fn read_rate_shear(table: &mut TableReader<'_>, form: Form) -> Result<RateShear, SceneError> {
    form.allow(table, &["reference_speed", "sharpness", "creep_speed"], &RATE_SHEAR_OF_FORM)?;
    Ok(RateShear {
        force: form.number(Form::Direct, table, "force", &allowed::SHEAR_FORCE)?,
        strength: form.number(Form::Material, table, "strength", &allowed::SHEAR_STRENGTH)?,
        reference_speed: table.number("reference_speed", &allowed::SPEED)?,
        sharpness: table.number("sharpness", &allowed::SHARPNESS)?,
        creep_speed: table.optional_number("creep_speed", &allowed::SPEED)?,
    })
}

pub(super) fn read_solver(table: &mut TableReader<'_>) -> Result<Solver, SceneError> {
    table.allow(&["method", "relative_tolerance", "absolute_tolerance", "max_steps", "reduce"])?;
    let defaults = Solver::default();
    let relative_tolerance = table.optional_number("relative_tolerance", &allowed::RELATIVE_TOLERANCE)?;
    let max_steps = table.optional_whole("max_steps", &allowed::MAX_STEPS)?;
    Ok(Solver {
        method: table.optional_choice("method", &allowed::METHOD)?.unwrap_or(defaults.method),
        relative_tolerance: relative_tolerance.unwrap_or(defaults.relative_tolerance),
        absolute_tolerance: table.optional_number("absolute_tolerance", &allowed::ABSOLUTE_TOLERANCE)?,
        max_steps: max_steps.map_or(defaults.max_steps, i64::unsigned_abs),
        reduce: table.optional_number("reduce", &allowed::REDUCE)?.unwrap_or(defaults.reduce),
    })
}

pub(super) fn read_input(table: &mut TableReader<'_>) -> Result<Extrapolation, SceneError> {
    table.allow(&["extrapolation"])?;
    Ok(table.optional_choice("extrapolation", &allowed::EXTRAPOLATION)?.unwrap_or_default())
}

pub(super) fn read_fmu(table: &mut TableReader<'_>) -> Result<Vec<OutputGroup>, SceneError> {
    table.allow(&["outputs"])?;
    table.entry("outputs").map_or_else(|| Ok(default_outputs()), |entry| read_outputs(&entry))
}

/// The groups in the order of the variables, whatever their order in the scene.
fn read_outputs(entry: &Entry<'_>) -> Result<Vec<OutputGroup>, SceneError> {
    let mut groups: Vec<OutputGroup> = Vec::new();
    for element in entry.elements(&format!("an array, each {}", allowed::OUTPUTS))? {
        let group = element.choice(&allowed::OUTPUTS)?;
        if groups.contains(&group) {
            return Err(element.refuse("each group once"));
        }
        groups.push(group);
    }
    groups.sort_unstable();
    Ok(groups)
}
