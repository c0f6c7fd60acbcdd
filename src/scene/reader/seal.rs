//! From TOML text to a [`SealFile`].

use std::path::Path as FilePath;
use std::sync::Arc;

use super::table::{Entry, Result, Source, TableReader};
use super::{read_groups, read_input, read_name, surface};
use crate::scene::file_values::{FileValues, Setting};
use crate::scene::keys::{Form, SEAL_ROOT};
use crate::scene::patch_file::TableExtrapolation;
use crate::scene::seal_file::{LipSet, SealFile, SealGroup, Viscosity};
use crate::scene::{CanonicalFiles, FileFormats, FmuOptions, SceneError, read_file, read_text};
use crate::tables::{ContentError, Dimension, FileKind, GivenColumns, NOT_NEGATIVE, Others, ReadingNote, Role};

const LIP_ROLES: [Role; 3] = [
    Role::new("sealed_pressure", "sealed pressure, p_s", Dimension::Pressure).within(NOT_NEGATIVE),
    Role::new("x", "position, place", Dimension::Length).within(NOT_NEGATIVE),
    Role::new("pressure", "total pressure, contact pressure, p", Dimension::Pressure).within(NOT_NEGATIVE),
];
/// The file of the pressures of a lip.
pub const LIP_PRESSURES: FileKind = FileKind {
    others: Others::Refused,
    by_position: false,
    least: 2,
    ..FileKind::new("pressures", &LIP_ROLES, "sealed_pressure,x,pressure")
};

impl SealFile {
    /// Reads the seal file at `path` and the file of pressures that it names; the table is not read.
    ///
    /// # Errors
    /// [`SceneError`] with the file, the line, the key, what was given and what is allowed.
    pub fn load(path: &FilePath) -> Result<Self> {
        let text = read_text(path).map_err(|error| SceneError::unreadable(path, &error))?;
        Self::parse_with(&text, path, &CanonicalFiles, &[])
    }

    /// Reads a seal from `text` as if it were the content of `file`, with the file of pressures in one of `formats`, and with
    /// keys set to other values.
    ///
    /// # Errors
    /// As for [`load`](Self::load); without file and line where it comes of a key that is set.
    pub fn parse_with(
        text: &str,
        file: &FilePath,
        formats: &'static dyn FileFormats,
        settings: &[Setting],
    ) -> Result<Self> {
        FileValues::parse(text, file, formats)?.with(settings, Self::of_values)
    }

    fn of_values(mut values: FileValues, settings: &[Setting]) -> Result<Self> {
        values.set_own(settings, "seal file")?;
        let mut root = TableReader::root(Source { values: &values, form: Form::Direct, keys: SEAL_ROOT })?;
        let name = read_name(&root.required("name")?)?;
        let ((table, table_columns), temperature, table_extrapolation) = root.required("table")?.table(|table| {
            let extrapolation = table.optional_choice("extrapolation")?.unwrap_or(TableExtrapolation::Hold);
            let file = (surface::read_path(&table.required("path")?)?, surface::read_roles(table)?);
            Ok((file, table.optional_number("temperature")?, extrapolation))
        })?;
        let mut notes = Vec::new();
        let mut seal = root.required("seal")?.open()?;
        seal.check_keys()?;
        let entry = seal.required("pressure")?;
        let sets = read_sets(&entry, &surface::read_roles(&mut seal)?, &mut notes)?;
        let (length, rough) = (seal.number("length")?, seal.required("rough")?.choice()?);
        let (stiffness, approach_stiffness) =
            (seal.optional_number("stiffness")?, seal.optional_number("approach_stiffness")?);
        let cells = seal.optional_whole("cells")?.and_then(|cells| usize::try_from(cells).ok()).unwrap_or(64);
        seal.finish()?;
        let (viscosity, air, supply, start) = root.required("fluid")?.table(|table| {
            let (air, supply) = (table.optional_choice("air")?, table.optional_number("supply")?);
            Ok((read_viscosity(&table.required("viscosity")?)?, air, supply, table.optional_number("start")?))
        })?;
        let input_rule = root.optional_table("input", read_input)?.unwrap_or_default();
        let tolerance = root.optional_table("solver", |table| table.optional_number("relative_tolerance"))?.flatten();
        let fmu = root.optional_table("fmu", |table| Ok((read_outputs(table)?, super::read_fmu_options(table)?)))?;
        let (outputs, fmu) = fmu.unwrap_or_else(|| (default_outputs(), FmuOptions::default()));
        root.finish()?;
        let pressure = surface::read_path(&entry)?;
        Ok(Self {
            name,
            table,
            table_columns,
            temperature,
            table_extrapolation,
            pressure,
            sets,
            length,
            rough,
            stiffness,
            approach_stiffness,
            cells,
            viscosity,
            air: air.unwrap_or_default(),
            supply: supply.unwrap_or(1e-4),
            start,
            input_rule,
            relative_tolerance: tolerance.unwrap_or(1e-3),
            outputs,
            fmu,
            notes,
            values: Arc::new(values),
        })
    }
}

fn read_viscosity(entry: &Entry<'_>) -> Result<Viscosity> {
    let points = entry.numbers_at(crate::scene::Unit::Kelvin, crate::scene::Unit::PascalSecond);
    let points = points.ok_or_else(|| entry.refuse_type())?;
    Viscosity::new(points).map_err(|expected| entry.refuse(expected))
}

fn read_sets(entry: &Entry<'_>, columns: &GivenColumns, notes: &mut Vec<ReadingNote>) -> Result<Vec<LipSet>> {
    let (path, values) = (surface::read_path(entry)?, entry.source().values);
    let file = values.folder().join(&path);
    let bytes = read_file(&file).map_err(|error| entry.unreadable(&error))?;
    let sets = parse_sets(&bytes, values.formats, columns);
    let (sets, read) = sets.map_err(|error| error.in_file(file).named_by(entry.location(), entry.path()))?;
    notes.extend(read.into_iter().map(|note| note.of(&path)));
    Ok(sets)
}

/// The sets by rising sealed pressure, each from x = 0 over the same width.
fn parse_sets(
    bytes: &[u8],
    formats: &dyn FileFormats,
    columns: &GivenColumns,
) -> std::result::Result<(Vec<LipSet>, Vec<ReadingNote>), ContentError> {
    let table = formats.table(bytes, &LIP_PRESSURES, columns)?;
    let [sealed, x, pressures] = ["sealed_pressure", "x", "pressure"].map(|key| table.values(key));
    let mut sets: Vec<LipSet> = Vec::new();
    for row in 0..table.lines.len() {
        let refused = |key: &str, found: f64, expected: &str| {
            Err(ContentError::value(table.lines.get(row).copied(), key, &format!("{found:?}"), expected))
        };
        let is_next = sets.last().is_some_and(|set| set.sealed == sealed[row]);
        if let Some(set) = sets.last_mut().filter(|_| is_next) {
            if set.x.last().is_some_and(|last| *last >= x[row]) {
                return refused("x", x[row], "places that rise within a sealed pressure");
            }
            set.x.push(x[row]);
            set.pressures.push(pressures[row]);
        } else if sets.iter().any(|set| set.sealed == sealed[row]) {
            return refused("sealed_pressure", sealed[row], "the rows of a sealed pressure one after the other");
        } else if x[row] != 0.0 {
            return refused("x", x[row], "0, the sealed side, at the first row of a sealed pressure");
        } else {
            sets.push(LipSet { sealed: sealed[row], x: vec![x[row]], pressures: vec![pressures[row]] });
        }
    }
    sets.sort_by(|a, b| a.sealed.total_cmp(&b.sealed));
    let width = |set: &LipSet| set.x.last().copied().unwrap_or_default();
    let found = sets.iter().map(width).find(|own| *own == 0.0 || (own / width(&sets[0]) - 1.0).abs() > SAME_WIDTH);
    match found {
        Some(found) => {
            let expected = "sets over one width, each from x = 0 to the air side";
            Err(ContentError::value(None, "x", &format!("a set that ends at {found:?}"), expected))
        }
        None => Ok((sets, table.notes)),
    }
}

/// Widths that differ by this part are the same.
const SAME_WIDTH: f64 = 1e-6;

fn default_outputs() -> Vec<SealGroup> {
    vec![SealGroup::Forces, SealGroup::Dissipation, SealGroup::Film]
}

fn read_outputs(table: &mut TableReader<'_>) -> Result<Vec<SealGroup>> {
    table.entry("outputs").map_or_else(|| Ok(default_outputs()), |entry| read_groups(&entry))
}
