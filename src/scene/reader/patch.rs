//! From TOML text to a [`PatchFile`].

use std::f64::consts::PI;
use std::path::Path as FilePath;
use std::sync::Arc;

use super::table::{Entry, Result, Source, TableReader};
use super::{read_input, read_name, surface};
use crate::scene::file_values::{FileValues, Setting};
use crate::scene::keys::{Form, PATCH_ROOT, ShapeKind};
use crate::scene::patch_file::{
    Backing, FaceHeat, FaceShape, Grid, MAX_ELEMENTS, PatchFile, PatchGroup, TableExtrapolation,
};
use crate::scene::{CanonicalFiles, FileFormats, FmuOptions, SceneError, read_file, read_text};
use crate::tables::{ContentError, Dimension, FileKind, GivenColumns, Others, POSITIVE, ReadingNote, Role};

const POINT_ROLES: [Role; 4] = [
    Role::new("x", "position x, x position", Dimension::Length),
    Role::new("y", "position y, y position", Dimension::Length),
    Role::new("z", "position z, z position", Dimension::Length),
    Role::new("area", "nominal area, fläche", Dimension::Area).within(POSITIVE),
];
/// The file of the points of a face.
pub const POINTS: FileKind =
    FileKind { others: Others::Refused, by_position: false, ..FileKind::new("points", &POINT_ROLES, "x,y,z,area") };

impl PatchFile {
    /// Reads the patch file at `path` and the file of points that it names; the table is not read.
    ///
    /// # Errors
    /// [`SceneError`] with the file, the line, the key, what was given and what is allowed.
    pub fn load(path: &FilePath) -> Result<Self> {
        let text = read_text(path).map_err(|error| SceneError::unreadable(path, &error))?;
        Self::parse(&text, path)
    }

    /// Reads a patch from `text` as if it were the content of `file`; the files that it names are looked for in the
    /// same folder.
    ///
    /// # Errors
    /// As for [`load`](Self::load).
    pub fn parse(text: &str, file: &FilePath) -> Result<Self> {
        Self::parse_with(text, file, &CanonicalFiles, &[])
    }

    /// As [`parse`](Self::parse), with the file of points in one of `formats`, and with keys set to other values.
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
        values.set_own(settings, "patch file")?;
        let mut root = TableReader::root(Source { values: &values, form: Form::Direct, keys: PATCH_ROOT })?;
        let name = read_name(&root.required("name")?)?;
        let table_entry = root.required("table")?;
        let mut table = table_entry.open()?;
        table.check_keys()?;
        let temperature = table.entry("temperature");
        let nominal_area = table.entry("nominal_area");
        let path = surface::read_path(&table.required("path")?)?;
        let table_columns = surface::read_roles(&mut table)?;
        let table_extrapolation = table.optional_choice("extrapolation")?.unwrap_or(TableExtrapolation::Hold);
        table.finish()?;
        let face = read_face(&root.required("patch")?)?;
        let input_rule = root.optional_table("input", read_input)?.unwrap_or_default();
        let refine = root.optional_table("solver", |table| table.optional_whole("refine"))?.flatten().unwrap_or(1);
        let fmu = root.optional_table("fmu", |table| Ok((read_outputs(table)?, super::read_fmu_options(table)?)))?;
        let (outputs, fmu) = fmu.unwrap_or_else(|| (default_outputs(), FmuOptions::default()));
        root.finish()?;
        Ok(Self {
            name,
            table: path,
            table_columns,
            temperature: temperature.map(|entry| entry.number()).transpose()?,
            table_extrapolation,
            nominal_area: nominal_area.map(|entry| entry.number()).transpose()?,
            shape: face.shape,
            transport: face.transport,
            offset: face.offset,
            backing: face.backing,
            damping: face.damping,
            heat: face.heat,
            input_rule,
            refine: u32::try_from(refine).unwrap_or(1),
            outputs,
            fmu,
            notes: face.notes,
            values: Arc::new(values),
        })
    }
}

/// What `[patch]` says.
struct FaceKeys {
    shape: FaceShape,
    transport: bool,
    offset: [f64; 3],
    backing: Option<Backing>,
    damping: f64,
    heat: Option<FaceHeat>,
    notes: Vec<ReadingNote>,
}

fn read_face(entry: &Entry<'_>) -> Result<FaceKeys> {
    let mut table = entry.open()?;
    let kind = table.required("shape")?.choice::<ShapeKind>()?;
    table.use_keys(kind)?;
    let mut notes = Vec::new();
    let shape = match kind {
        ShapeKind::Flat => FaceShape::Flat(read_grid(&mut table)?),
        ShapeKind::Cylinder => read_cylinder(&mut table)?,
        ShapeKind::Points => read_points(&table.required("path")?, &surface::read_roles(&mut table)?, &mut notes)?,
    };
    let transport = kind != ShapeKind::Points && table.flag("transport")?;
    let offset = table.entry("offset").map(|entry| read_offset(&entry)).transpose()?.unwrap_or_default();
    let backing = table.optional_table("backing", read_backing)?;
    let damping = table.optional_number("damping")?.unwrap_or(0.0);
    let heat = table.optional_table("heat", read_heat)?;
    table.finish()?;
    Ok(FaceKeys { shape, transport, offset, backing, damping, heat, notes })
}

fn read_heat(table: &mut TableReader<'_>) -> Result<FaceHeat> {
    Ok(FaceHeat {
        conductivity: table.number("conductivity")?,
        capacity: table.number("capacity")?,
        density: table.number("density")?,
        share: table.number("share")?,
    })
}

/// By its stiffnesses, or by its height and modulus.
fn read_backing(table: &mut TableReader<'_>) -> Result<Backing> {
    if table.has("height") || table.has("modulus") {
        return Ok(Backing::block(table.number("height")?, table.number("modulus")?));
    }
    Ok(Backing { normal: table.number("normal")?, shear: table.number("shear")? })
}

fn read_grid(table: &mut TableReader<'_>) -> Result<Grid> {
    let (length, width) = (table.number("length")?, table.number("width")?);
    let (nx, ny) = (table.whole("nx")?, table.required("ny")?);
    let rows = ny.whole()?;
    if nx * rows > MAX_ELEMENTS {
        return Err(ny.refuse(format_args!("nx ny up to {MAX_ELEMENTS}; nx = {nx}")));
    }
    let count = |number: i64| usize::try_from(number).unwrap_or(1);
    Ok(Grid { length, width, nx: count(nx), ny: count(rows) })
}

fn read_cylinder(table: &mut TableReader<'_>) -> Result<FaceShape> {
    let radius = table.number("radius")?;
    let length = table.required("length")?;
    let grid = read_grid(table)?;
    if grid.length >= PI * radius {
        return Err(length.refuse(format_args!("a number < {:?}, half its circumference", PI * radius)));
    }
    Ok(FaceShape::Cylinder { radius, grid })
}

fn read_offset(entry: &Entry<'_>) -> Result<[f64; 3]> {
    let numbers = entry.numbers()?;
    let count = numbers.len();
    numbers.try_into().map_err(|_| entry.refuse_count(count, "three numbers"))
}

fn read_points(entry: &Entry<'_>, columns: &GivenColumns, notes: &mut Vec<ReadingNote>) -> Result<FaceShape> {
    let (path, source) = (surface::read_path(entry)?, entry.source());
    let (file, bytes) = read_file(&source.values.folder().join(&path))
        .map(|bytes| (source.values.folder().join(&path), bytes))
        .map_err(|error| entry.unreadable(&error))?;
    let points = parse_points(&bytes, source.values.formats, columns);
    let (points, read) = points.map_err(|error| error.in_file(file).named_by(entry.location(), entry.path()))?;
    notes.extend(read.into_iter().map(|note| note.of(&path)));
    Ok(FaceShape::Points { path, points })
}

fn parse_points(
    bytes: &[u8],
    formats: &dyn FileFormats,
    columns: &GivenColumns,
) -> std::result::Result<(Vec<[f64; 4]>, Vec<ReadingNote>), ContentError> {
    let table = formats.table(bytes, &POINTS, columns)?;
    let rows = table.lines.len();
    if rows as i64 > MAX_ELEMENTS {
        let expected = format!("1 to {MAX_ELEMENTS}, one an element");
        return Err(ContentError::value(table.line, "rows", &rows.to_string(), &expected));
    }
    let columns = ["x", "y", "z", "area"].map(|key| table.values(key));
    let points = (0..rows).map(|row| columns.map(|column| column[row])).collect();
    Ok((points, table.notes))
}

fn default_outputs() -> Vec<PatchGroup> {
    vec![PatchGroup::Forces, PatchGroup::Dissipation]
}

fn read_outputs(table: &mut TableReader<'_>) -> Result<Vec<PatchGroup>> {
    table.entry("outputs").map_or_else(|| Ok(default_outputs()), |entry| super::read_groups(&entry))
}
