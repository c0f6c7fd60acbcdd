//! From TOML text to a [`PatchFile`].

use std::f64::consts::PI;
use std::path::Path as FilePath;

use super::table::{Entry, Result, Source, TableReader};
use super::{read_input, read_name, surface};
use crate::scene::error::{ContentError, Location};
use crate::scene::keys::{AREA, COORDINATE, Form, Key, PATCH_ROOT, ShapeKind};
use crate::scene::patch_file::{
    Backing, FaceHeat, FaceShape, Grid, MAX_ELEMENTS, PatchFile, PatchGroup, TableExtrapolation,
};
use crate::scene::{FmuOptions, SceneError, TextAlone, read_file, read_text};
use crate::tables::{self, Dimension, Heading, Row, Unit, Words, decode};

/// The columns of a file of points.
const COLUMNS: [Words<usize>; 4] = [
    Words::new(0, Dimension::Length, &["x"], &[]),
    Words::new(1, Dimension::Length, &["y"], &[]),
    Words::new(2, Dimension::Length, &["z"], &[]),
    Words::new(3, Dimension::Area, &["area"], &[]),
];

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
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let source = Source { file, text, form: Form::Direct, formats: &TextAlone };
        let document = source.parse()?;
        let mut root = TableReader::root(source, document.get_ref(), PATCH_ROOT)?;
        let name = read_name(&root.required("name")?)?;
        let table_entry = root.required("table")?;
        let mut table = table_entry.open()?;
        table.check_keys()?;
        let temperature = table.entry("temperature");
        let nominal_area = table.entry("nominal_area");
        let place = |entry: &Option<Entry<'_>>| entry.as_ref().unwrap_or(&table_entry).location();
        let (temperature_place, area_place) = (place(&temperature), place(&nominal_area));
        let path = surface::read_path(&table.required("path")?)?;
        let table_extrapolation = table.optional_choice("extrapolation")?.unwrap_or(TableExtrapolation::Hold);
        table.finish()?;
        let face = read_face(&root.required("patch")?)?;
        let extrapolation = root.optional_table("input", read_input)?.unwrap_or_default();
        let refine = root.optional_table("solver", |table| table.optional_whole("refine"))?.flatten().unwrap_or(1);
        let fmu = root.optional_table("fmu", |table| Ok((read_outputs(table)?, super::read_fmu_options(table)?)))?;
        let (outputs, fmu) = fmu.unwrap_or_else(|| (default_outputs(), FmuOptions::default()));
        root.finish()?;
        Ok(Self {
            name,
            table: path,
            temperature: temperature.map(|entry| entry.number()).transpose()?,
            table_extrapolation,
            nominal_area: nominal_area.map(|entry| entry.number()).transpose()?,
            shape: face.shape,
            transport: face.transport,
            offset: face.offset,
            backing: face.backing,
            heat: face.heat,
            extrapolation,
            refine: u32::try_from(refine).unwrap_or(1),
            outputs,
            fmu,
            places: [temperature_place, area_place, face.heat_place],
        })
    }
}

/// What `[patch]` says.
struct FaceKeys {
    shape: FaceShape,
    transport: bool,
    offset: [f64; 3],
    backing: Option<Backing>,
    heat: Option<FaceHeat>,
    /// Where `heat` is, or the table.
    heat_place: Location,
}

fn read_face(entry: &Entry<'_>) -> Result<FaceKeys> {
    let mut table = entry.open()?;
    let kind = table.required("shape")?.choice::<ShapeKind>()?;
    table.use_keys(kind)?;
    let shape = match kind {
        ShapeKind::Flat => FaceShape::Flat(read_grid(&mut table)?),
        ShapeKind::Cylinder => read_cylinder(&mut table)?,
        ShapeKind::Points => read_points(&table.required("path")?)?,
    };
    let transport = kind != ShapeKind::Points && table.flag("transport")?;
    let offset = table.entry("offset").map(|entry| read_offset(&entry)).transpose()?.unwrap_or_default();
    let backing = table.optional_table("backing", read_backing)?;
    let heat_entry = table.entry("heat");
    let heat_place = heat_entry.as_ref().unwrap_or(entry).location();
    let heat = heat_entry.map(|entry| entry.table(read_heat)).transpose()?;
    table.finish()?;
    Ok(FaceKeys { shape, transport, offset, backing, heat, heat_place })
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

fn read_points(entry: &Entry<'_>) -> Result<FaceShape> {
    let path = surface::read_path(entry)?;
    let file = entry.source().folder().join(&path);
    let bytes = read_file(&file).map_err(|error| entry.unreadable(&error))?;
    let points = parse_points(&bytes);
    let points = points.map_err(|error| error.in_file(file).named_by(entry.location(), entry.path()))?;
    Ok(FaceShape::Points { path, points })
}

fn parse_points(bytes: &[u8]) -> std::result::Result<Vec<[f64; 4]>, ContentError> {
    let text = decode(bytes).map_err(|error| ContentError::new(Some(1), "", error))?;
    let mut rows = tables::rows(&text, Some(','));
    let header = rows.next();
    let line = header.as_ref().map(|row| row.line);
    let columns = header.as_ref().and_then(|row| columns(row));
    let Some(columns) = columns else {
        let given = header.map_or_else(String::new, |row| row.fields.join(","));
        return Err(ContentError::value(line, "columns", &given, "x,y,z,area"));
    };
    let points: Vec<[f64; 4]> = rows.map(|row| point(&row, &columns)).collect::<std::result::Result<_, _>>()?;
    if points.is_empty() || points.len() as i64 > MAX_ELEMENTS {
        let expected = format!("1 to {MAX_ELEMENTS}, one an element");
        return Err(ContentError::value(line, "rows", &points.len().to_string(), &expected));
    }
    Ok(points)
}

/// The places of x, y, z and the area in a row, and their units; each column once, and no others.
fn columns(header: &Row<'_>) -> Option<[(usize, Unit); 4]> {
    let headings: Vec<Heading<usize>> =
        header.fields.iter().map(|name| Heading::parse(name, &COLUMNS)).collect::<Option<_>>()?;
    if headings.len() != COLUMNS.len() {
        return None;
    }
    let mut found = [(0, Unit::ONE); 4];
    for (place, entry) in found.iter_mut().enumerate() {
        let index = headings.iter().position(|heading| heading.quantity == place)?;
        *entry = (index, headings[index].unit.known().ok()?.unwrap_or(Unit::ONE));
    }
    Some(found)
}

fn point(row: &Row<'_>, columns: &[(usize, Unit); 4]) -> std::result::Result<[f64; 4], ContentError> {
    if row.fields.len() != COLUMNS.len() {
        let given = row.fields.len().to_string();
        return Err(ContentError::value(Some(row.line), "columns", &given, "four numbers"));
    }
    let mut numbers = [0.0; 4];
    for (i, (number, (index, unit))) in numbers.iter_mut().zip(columns).enumerate() {
        let key: &Key = if i == 3 { &AREA } else { &COORDINATE };
        let (range, field) = (key.range(), &row.fields[*index]);
        let read = field.parse().ok().map(|written| unit.to_si(written));
        let read = read.filter(|&value| range.is_some_and(|range| range.holds(value)));
        let expected = || range.map_or_else(String::new, |range| range.to_string());
        let given = || format!("\"{}\"", field.chars().take(60).collect::<String>());
        let name = COLUMNS[i].key_words[0];
        *number = read.ok_or_else(|| ContentError::value(Some(row.line), name, &given(), &expected()))?;
    }
    Ok(numbers)
}

fn default_outputs() -> Vec<PatchGroup> {
    vec![PatchGroup::Forces, PatchGroup::Dissipation]
}

fn read_outputs(table: &mut TableReader<'_>) -> Result<Vec<PatchGroup>> {
    table.entry("outputs").map_or_else(|| Ok(default_outputs()), |entry| super::read_groups(&entry))
}
