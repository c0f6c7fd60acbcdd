//! Reading of surfaces: `[surface]` and the layer's roughness, in the scene or from a file.

use std::path::{Component, Path as FilePath, PathBuf};
use std::sync::Arc;

use super::table::{Entry, Result, TableReader};
use crate::scene::file_values::NamedFiles;
use crate::scene::files::{NamedTable, with_seams};
use crate::scene::height_map::Seam;
use crate::scene::keys::{PATH, SurfaceKind, TABLE};
use crate::scene::surface::{Coordinate, check_points};
use crate::scene::values::POSITIVE;
use crate::scene::{
    FileFormats, Layer, LoadedProfile, MOST_HEIGHTS, ProfileOptions, SceneFile, SelfAffine, Surface, line_note,
    warnings,
};
use crate::tables::{ContentError, GivenColumns, ReadTable, ReadingNote};

/// A number of points that is whole but for rounding is that number.
const ROUNDING: f64 = 1.0e-9;

/// What reading finds beside the values of the scene.
#[derive(Default)]
pub(super) struct Findings {
    pub(super) named: NamedFiles,
    pub(super) files: Vec<SceneFile>,
    pub(super) warnings: Vec<String>,
    pub(super) notes: Vec<ReadingNote>,
}

impl Findings {
    /// Adds how the file at `path` was read.
    pub(super) fn add_notes(&mut self, path: &FilePath, notes: Vec<ReadingNote>) {
        for note in notes.into_iter().map(|note| note.of(path)) {
            if !self.notes.contains(&note) {
                self.notes.push(note);
            }
        }
    }

    /// What `make` makes of the table in the file that `entry` names, which `read` reads by the formats of the scene, and
    /// what it says of it.
    pub(super) fn read_table<T>(
        &mut self,
        entry: &Entry<'_>,
        read: impl Fn(&dyn FileFormats, &[u8], &GivenColumns) -> std::result::Result<ReadTable, ContentError>,
        make: impl Fn(&ReadTable) -> std::result::Result<(T, Vec<ReadingNote>), ContentError>,
    ) -> Result<T> {
        let (named, values) = (read_named(entry)?, entry.source().values);
        let carried = NamedTable::carried_name(&named.path, &named.columns);
        let (file, bytes) =
            self.named.read(values.folder(), &named.path, &carried).map_err(|error| entry.unreadable(&error))?;
        let made = read(values.formats, &bytes, &named.columns)
            .and_then(|table| make(&table).map(|(content, notes)| (table, content, notes)));
        let refused = |error: ContentError| error.in_file(file).named_by(entry.location(), entry.path());
        let (mut table, content, notes) = made.map_err(refused)?;
        self.add_notes(&named.path, std::mem::take(&mut table.notes));
        self.add_notes(&named.path, notes);
        self.add_file(SceneFile::of_table(named, table));
        Ok(content)
    }

    /// The profile at `path`, which `entry` names: as it was read before, if it was.
    fn profile(&mut self, entry: &Entry<'_>, path: &FilePath, options: &ProfileOptions) -> Result<Arc<LoadedProfile>> {
        let is_it = |(file, read, _): &&(PathBuf, ProfileOptions, _)| file == path && read == options;
        if let Some((.., profile)) = self.named.profiles.iter().find(is_it) {
            return Ok(profile.clone());
        }
        let values = entry.source().values;
        let carried = options.carried_name(path);
        let (file, bytes) =
            self.named.read(values.folder(), path, &carried).map_err(|error| entry.unreadable(&error))?;
        let read = values.formats.surface(&bytes, options).and_then(|read| with_seams(read, options));
        let read = read.map_err(|error| error.in_file(file).named_by(entry.location(), entry.path()))?;
        let profile = Arc::new(read);
        self.named.profiles.push((path.to_owned(), options.clone(), profile.clone()));
        Ok(profile)
    }

    /// Adds a file that the scene reads, each once.
    pub(super) fn add_file(&mut self, file: SceneFile) {
        if self.files.iter().all(|other| other.carried_name != file.carried_name) {
            self.files.push(file);
        }
    }
}

/// The surface given by the table `entry`, without the roughness below it; the file that it names, if any, is added to
/// those `found`.
pub(super) fn read(entry: &Entry<'_>, found: &mut Findings) -> Result<Surface> {
    let mut table = entry.open()?;
    let kind = table.required("kind")?.choice::<SurfaceKind>()?;
    table.use_keys(kind)?;
    let surface = match kind {
        SurfaceKind::Flat => Surface::flat(),
        SurfaceKind::Sinusoid => read_sinusoid(&mut table)?,
        SurfaceKind::SelfAffine => read_self_affine(&mut table, found)?,
        SurfaceKind::Points => read_points(&mut table, found)?,
        SurfaceKind::File => read_file(&mut table, found)?,
    };
    // Read once the surface is known.
    table.entry("fine");
    table.finish()?;
    surface.check_slopes().map_err(|expected| entry.refuse(expected))?;
    Ok(surface)
}

fn read_sinusoid(table: &mut TableReader<'_>) -> Result<Surface> {
    let amplitude = table.number("amplitude")?;
    let wavelength = table.number("wavelength")?;
    let points = table.optional_whole("points_per_wavelength")?.unwrap_or(64);
    Ok(Surface::sinusoid(amplitude, wavelength, points))
}

fn read_self_affine(table: &mut TableReader<'_>, found: &mut Findings) -> Result<Surface> {
    let length = table.number("length")?;
    let points = table.required("points")?;
    let count = points.whole()?;
    let (hurst, rms) = (table.number("hurst")?, read_rms_height(table)?);
    let roll_off_entry = table.required("roll_off_wavelength")?;
    let roll_off = roll_off_entry.number()?;
    let cut_off_entry = table.required("cut_off_wavelength")?;
    let cut_off = cut_off_entry.number()?;
    let seed = table.whole("seed")?;
    if roll_off > length {
        return Err(roll_off_entry.refuse(format_args!("a number up to {length:?}, the length")));
    }
    if cut_off >= roll_off {
        return Err(cut_off_entry.refuse(format_args!("a number < {roll_off:?}, the roll_off_wavelength")));
    }
    let least = (2.0 * length / cut_off * (1.0 - ROUNDING)).ceil();
    if (count as f64) < least {
        return Err(points.refuse(format_args!("at least {least}: two points for each cut_off_wavelength")));
    }
    let point_count = usize::try_from(count).unwrap_or(usize::MAX);
    let (seed, size_y) = (seed.unsigned_abs(), read_size_y(table, length)?);
    let law = SelfAffine { length, points: point_count, hurst, rms, roll_off, cut_off, seed, size_y };
    let Some(size_y) = size_y else { return Ok(law.surface(None)) };

    // A map: as fine along y, and no larger than there is memory for.
    let lines = law.lines(size_y);
    if point_count.saturating_mul(lines) > MOST_HEIGHTS {
        return Err(points.refuse(format_args!("up to {MOST_HEIGHTS} points of a map; it has {lines} lines")));
    }
    if ((lines as f64) / size_y) * cut_off < 2.0 * (1.0 - ROUNDING) {
        return Err(points.refuse("two lines of the map along y too for each cut_off_wavelength"));
    }
    let chosen = table.entry("line");
    let line = chosen.as_ref().map(|entry| entry.whole()).transpose()?.and_then(|line| usize::try_from(line).ok());
    match chosen.filter(|_| line.is_some_and(|line| line > lines)) {
        Some(entry) => Err(entry.refuse(format_args!("a whole number from 1 to {lines}"))),
        None => {
            let taken = line.unwrap_or(lines.div_ceil(2));
            found.notes.push(line_note("an isotropic surface", taken, lines, line.is_some()));
            Ok(law.surface(line))
        }
    }
}

/// The root mean square height, m, by one of its names.
fn read_rms_height(table: &mut TableReader<'_>) -> Result<f64> {
    match [table.entry("rms"), table.entry("rq")] {
        [Some(_), Some(rq)] => {
            Err(rq.refuse("no such key beside rms: both are the root mean square height, of which one is given"))
        }
        [Some(entry), None] | [None, Some(entry)] => entry.number(),
        [None, None] => Err(table.missing("rms", format_args!("{POSITIVE} m, or rq in its place"))),
    }
}

/// The period of an isotropic surface along y, m: as given, or the length; `None` of one that is not isotropic.
fn read_size_y(table: &mut TableReader<'_>, length: f64) -> Result<Option<f64>> {
    if !table.flag("isotropic")? {
        return match (table.entry("size_y"), table.entry("line")) {
            (Some(entry), _) | (None, Some(entry)) => {
                Err(entry.refuse("no such key without isotropic = true: the surface is the same all along y"))
            }
            (None, None) => Ok(None),
        };
    }
    Ok(Some(table.optional_number("size_y")?.unwrap_or(length)))
}

fn read_points(table: &mut TableReader<'_>, found: &mut Findings) -> Result<Surface> {
    let periodic = table.flag("periodic")?;
    let (x_entry, z_entry) = (table.required("x")?, table.required("z")?);
    let (x, mut z) = (x_entry.numbers()?, z_entry.numbers()?);
    if z.len() != x.len() {
        return Err(z_entry.refuse_count(z.len(), &format!("{} heights, as many as numbers in x", x.len())));
    }
    check_points(&x, &mut z, periodic).map_err(|error| {
        let entry = if error.coordinate == Coordinate::X { &x_entry } else { &z_entry };
        match error.index.and_then(|i| entry.element(i)) {
            Some(element) => element.refuse(error.expected),
            None => entry.refuse_count(x.len(), &error.expected),
        }
    })?;
    let seams = Vec::from_iter(Seam::of_profile(&x, &z).filter(|_| periodic));
    match (Seam::check(&seams), table.entry("periodic")) {
        (Err(expected), Some(entry)) => return Err(entry.refuse(expected)),
        (warnings, _) => found.warnings.extend(warnings.unwrap_or_default()),
    }
    Ok(Surface::new(x, z, periodic))
}

fn read_file(table: &mut TableReader<'_>, found: &mut Findings) -> Result<Surface> {
    let options = read_options(table)?;
    let entry = table.required("path")?;
    let path = read_path(&entry)?;
    let profile = found.profile(&entry, &path, &options)?;
    found.warnings.extend(profile.warnings.iter().map(|warning| format!("{}: {warning}", path.display())));
    found.add_notes(&path, profile.notes.clone());
    found.add_file(SceneFile::of_surface(path, &options, &profile.surface));
    Ok(profile.surface.clone())
}

fn read_options(table: &mut TableReader<'_>) -> Result<ProfileOptions> {
    let unit = table.optional_choice("unit")?;
    Ok(ProfileOptions {
        x_unit: table.optional_choice("x_unit")?.or(unit),
        z_unit: table.optional_choice("z_unit")?.or(unit),
        missing: table.optional_choice("missing")?.unwrap_or_default(),
        tilt: table.optional_choice("tilt")?.unwrap_or_default(),
        depth: table.optional_choice("depth")?,
        third_column: table.optional_choice("third_column")?,
        columns: read_columns(table)?,
        spacing: read_spacing(table)?,
        line: table.optional_whole("line")?.and_then(|line| usize::try_from(line).ok()),
        periodic: table.flag("periodic")?,
    })
}

/// The columns by their axes, `{ x = "…", z = "…" }`; or their names in a list, x and z, or z alone.
fn read_columns(table: &mut TableReader<'_>) -> Result<Vec<(String, String)>> {
    let Some(entry) = table.entry("columns") else { return Ok(Vec::new()) };
    if let Some(columns) = entry.texts_by_name() {
        let is_axis = |(key, _): &(String, String)| ["x", "y", "z"].contains(&key.as_str());
        let is_axes = !columns.is_empty() && columns.iter().all(is_axis);
        return if is_axes {
            Ok(columns)
        } else {
            Err(entry.refuse("columns by their axes: { x = \"…\", z = \"…\" }"))
        };
    }
    let elements = entry.elements()?;
    let names = elements.iter().map(|element| element.text().map(str::to_owned)).collect::<Result<Vec<_>>>();
    match names.unwrap_or_default() {
        names if (1..=2).contains(&names.len()) => Ok(ProfileOptions::axes(&names)),
        _ => Err(entry.refuse_type()),
    }
}

/// One distance, or two of a matrix.
fn read_spacing(table: &mut TableReader<'_>) -> Result<Vec<f64>> {
    let Some(entry) = table.entry("spacing") else { return Ok(Vec::new()) };
    let numbers = entry.number_or_numbers()?;
    let expected = "a number, of a column of heights, or two along x and y, of a matrix of heights";
    if (1..=2).contains(&numbers.len()) { Ok(numbers) } else { Err(entry.refuse_count(numbers.len(), expected)) }
}

/// The table that a key names: by the path of its file, or with columns whose names do not say what they are,
/// `{ path = "…", columns = { … } }`.
pub(super) fn read_named(entry: &Entry<'_>) -> Result<NamedTable> {
    if !entry.is_table() {
        return Ok(NamedTable { path: read_path(entry)?, columns: Vec::new() });
    }
    let mut table = entry.open_with(TABLE)?;
    table.check_keys()?;
    let path = read_path(&table.required("path")?)?;
    let columns = read_roles(&mut table)?;
    table.finish()?;
    Ok(NamedTable { path, columns })
}

/// The columns of a table by what they hold.
pub(super) fn read_roles(table: &mut TableReader<'_>) -> Result<Vec<(String, String)>> {
    let Some(entry) = table.entry("columns") else { return Ok(Vec::new()) };
    entry.texts_by_name().ok_or_else(|| entry.refuse_type())
}

/// Only files beside or below the scene can go into the FMU with it.
pub(super) fn read_path(entry: &Entry<'_>) -> Result<PathBuf> {
    let text = entry.text().map_err(|_| entry.refuse(PATH))?;
    let path = FilePath::new(text);
    let below = |part: Component<'_>| matches!(part, Component::Normal(_) | Component::CurDir);
    let normal: PathBuf = path.components().filter(|part| matches!(part, Component::Normal(_))).collect();
    let legal = path.components().all(below) && !text.contains(['\\', '\0']);
    if legal && normal.file_name().is_some() { Ok(normal) } else { Err(entry.refuse(PATH)) }
}

/// The roughness at the masses: given there, or a surface sampled at the masses' positions. A flat one is none.
pub(super) fn read_roughness(entry: &Entry<'_>, layer: &Layer, found: &mut Findings) -> Result<Vec<f64>> {
    let mut table = entry.open()?;
    let kind = table.required("kind")?.choice::<SurfaceKind>()?;
    match (kind, table.has("x")) {
        (SurfaceKind::Flat, _) => read_alone(entry, found).map(|_| Vec::new()),
        (SurfaceKind::Points, false) => read_heights(&mut table, layer.masses),
        _ => sample(entry, layer, found),
    }
}

/// A surface without roughness below it: only the scene's has that.
fn read_alone(entry: &Entry<'_>, found: &mut Findings) -> Result<Surface> {
    match entry.open()?.entry("fine") {
        Some(fine) => Err(fine.refuse("no such key here: surface has it")),
        None => read(entry, found),
    }
}

/// `z` without `x`: one height for each mass.
fn read_heights(table: &mut TableReader<'_>, masses: usize) -> Result<Vec<f64>> {
    table.use_keys(SurfaceKind::Points)?;
    if let Some(entry) = table.entry("periodic") {
        return Err(entry.refuse("no such key for heights at the masses, which have no x"));
    }
    let expected = format!("{masses} heights, one for each mass (layer.masses)");
    let entry = table.entry("z").ok_or_else(|| table.missing("z", &expected))?;
    let heights = entry.numbers()?;
    if heights.len() == masses { Ok(heights) } else { Err(entry.refuse_count(heights.len(), &expected)) }
}

fn sample(entry: &Entry<'_>, layer: &Layer, found: &mut Findings) -> Result<Vec<f64>> {
    let surface = read_alone(entry, found)?;
    found.warnings.extend(warnings::short_roughness(layer, &surface));
    let spline = surface.spline();
    let heights: Vec<f64> = (0..layer.masses).map(|i| spline.evaluate(layer.rest_position(i)).0).collect();
    let finite = heights.iter().all(|height| height.is_finite());
    if finite { Ok(heights) } else { Err(entry.refuse("finite heights at the masses")) }
}
