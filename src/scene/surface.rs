//! Reading of `[surface]` and of what else is given like one.

use std::f64::consts::TAU;
use std::path::{Component, Path, PathBuf};

use super::allowed::{self, SurfaceKind};
use super::points::{self, Axis};
use super::profile::{self, Extract, Failure, ProfileOptions, Tilt};
use super::table::{Entry, TableReader, read_table};
use super::{Problem, SceneError, Surface, self_affine};
use crate::math::Spline;

/// The key that says where the heights come from.
pub(super) const KIND: &str = "kind";

impl Surface {
    /// The cubic spline through the data points.
    pub fn spline(&self) -> Spline {
        if self.periodic { Spline::periodic(&self.x, &self.z) } else { Spline::natural(&self.x, &self.z) }
    }
}

/// What comes up on the way through a scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Found {
    pub(super) files: Vec<PathBuf>,
    pub(super) extracts: Vec<Extract>,
    pub(super) warnings: Vec<String>,
}

impl Found {
    /// Notes a file that the scene reads, each once.
    pub(super) fn add_file(&mut self, path: PathBuf) {
        if !self.files.contains(&path) {
            self.files.push(path);
        }
    }
}

/// The surface given by the table `entry`; the file that it names, if any, is added to those `found`.
pub(super) fn read_surface(entry: &Entry<'_>, found: &mut Found) -> Result<Surface, SceneError> {
    let surface =
        read_table(entry, |table| match table.required(KIND, allowed::SURFACE)?.choice(&allowed::SURFACE)? {
            SurfaceKind::Flat => read_flat(table),
            SurfaceKind::Sinusoid => read_sinusoid(table),
            SurfaceKind::SelfAffine => self_affine::read(table),
            SurfaceKind::Points => read_points(table),
            SurfaceKind::File => read_file(table, found),
        })?;
    let spline = surface.spline();
    let bounds = spline.bounds();
    let finite = surface.x.iter().all(|&x| spline.evaluate(x).2.is_finite());
    if finite && bounds.slope_max_abs <= STEEPEST && bounds.curvature_max_abs <= allowed::LARGEST {
        Ok(surface)
    } else {
        let limits = format!("slopes up to {STEEPEST:e} and curvatures up to {:e} 1/m", allowed::LARGEST);
        Err(entry.refuse(format_args!("points with a spline of {limits}")))
    }
}

/// The largest slope of a profile: a step of a metre from one atom to the next has less, and its square times that of
/// the largest speed is a number.
const STEEPEST: f64 = 1e12;

fn read_flat(table: &TableReader<'_>) -> Result<Surface, SceneError> {
    table.allow(&[KIND])?;
    Ok(Surface { x: vec![0.0, 1.0], z: vec![0.0, 0.0], periodic: false })
}

fn read_sinusoid(table: &mut TableReader<'_>) -> Result<Surface, SceneError> {
    table.allow(&[KIND, "amplitude", "wavelength", "points_per_wavelength"])?;
    let amplitude = table.number("amplitude", &allowed::AMPLITUDE)?;
    let wavelength = table.number("wavelength", &allowed::WAVELENGTH)?;
    let points = table.optional_whole("points_per_wavelength", &allowed::POINTS_PER_WAVELENGTH)?.unwrap_or(64);
    Ok(sinusoid(amplitude, wavelength, points))
}

fn sinusoid(amplitude: f64, wavelength: f64, points: i64) -> Surface {
    let phase = |i| i as f64 / points as f64;
    let x = (0..=points).map(|i| wavelength * phase(i)).collect();
    // The last point is the first one again: without the rounding of sin 2π.
    let z = (0..=points).map(|i| amplitude * (TAU * phase(i % points)).sin()).collect();
    Surface { x, z, periodic: true }
}

fn read_points(table: &mut TableReader<'_>) -> Result<Surface, SceneError> {
    table.allow(&[KIND, "x", "z", "periodic"])?;
    let periodic = table.optional_flag("periodic")?.unwrap_or(false);
    let x_entry = table.required("x", "an array of places")?;
    let z_entry = table.required("z", "an array of heights")?;
    let (x, mut z) = (x_entry.numbers(&allowed::PLACE)?, z_entry.numbers(&allowed::HEIGHT)?);
    if z.len() != x.len() {
        return Err(z_entry.refuse_count(z.len(), &format!("{} heights, as many as places in x", x.len())));
    }
    points::check(&x, &mut z, periodic).map_err(|refusal| {
        let entry = if refusal.axis == Axis::X { &x_entry } else { &z_entry };
        let element = refusal.index.and_then(|i| entry.element(i));
        match element {
            Some(element) => element.refuse(refusal.expected),
            None => entry.refuse_count(x.len(), &refusal.expected),
        }
    })?;
    Ok(Surface { x, z, periodic })
}

fn read_file(table: &mut TableReader<'_>, found: &mut Found) -> Result<Surface, SceneError> {
    let keys = ["path", "periodic", "unit", "x_unit", "z_unit", "missing", "tilt", "third_column", "line"];
    table.allow(&[&[KIND][..], &keys].concat())?;
    let options = read_options(table)?;
    let entry = table.required("path", PATH_EXPECTED)?;
    let path = read_path(&entry)?;
    let profile = profile::read(entry.source().folder(), &path, &options).map_err(|failure| match failure {
        Failure::Unreadable(error) => {
            entry.problem(Problem::Unreadable { given: entry.given(), reason: error.to_string() })
        }
        Failure::Refused(error) => error.named_by(entry.place(), entry.key()),
    })?;
    let told = profile.warnings.iter().map(|warning| format!("{}: {warning}", path.display()));
    found.warnings.extend(told);
    if !found.files.contains(&profile.file) {
        let name = profile.file.clone();
        found.extracts.extend(profile.extract.map(|text| Extract { source: path, name, text }));
    }
    found.add_file(profile.file);
    Ok(profile.surface)
}

fn read_options(table: &mut TableReader<'_>) -> Result<ProfileOptions, SceneError> {
    let unit = table.optional_choice("unit", &allowed::LENGTH_UNIT)?;
    let options = ProfileOptions {
        x_unit: table.optional_choice("x_unit", &allowed::LENGTH_UNIT)?.or(unit),
        z_unit: table.optional_choice("z_unit", &allowed::LENGTH_UNIT)?.or(unit),
        missing: table.optional_choice("missing", &allowed::MISSING)?.unwrap_or_default(),
        tilt: table.optional_choice("tilt", &allowed::TILT)?.unwrap_or_default(),
        third_column: table.optional_choice("third_column", &allowed::THIRD_COLUMN)?,
        line: table.optional_whole("line", &allowed::LINE)?.and_then(|line| usize::try_from(line).ok()),
        periodic: table.optional_flag("periodic")?.unwrap_or(false),
    };
    match table.entry("tilt").filter(|_| options.periodic && options.tilt == Tilt::Remove) {
        Some(entry) => Err(entry.refuse("\"keep\" for a periodic profile, whose ends meet as they are")),
        None => Ok(options),
    }
}

const PATH_EXPECTED: &str = "a relative path of a file beside or below the scene file, without `..` and backslashes";

/// Only files beside or below the scene can go into the archive with it.
pub(super) fn read_path(entry: &Entry<'_>) -> Result<PathBuf, SceneError> {
    let path = entry.text(PATH_EXPECTED)?;
    let below = |part: &Component<'_>| matches!(part, Component::Normal(_) | Component::CurDir);
    let normal: PathBuf = Path::new(path).components().filter(|part| matches!(part, Component::Normal(_))).collect();
    let legal = Path::new(path).components().all(|part| below(&part)) && !path.contains(['\\', '\0']);
    if legal && normal.file_name().is_some() { Ok(normal) } else { Err(entry.refuse(PATH_EXPECTED)) }
}

impl Entry<'_> {
    /// Refuses an array for its number of elements.
    pub(super) fn refuse_count(&self, count: usize, expected: &str) -> SceneError {
        self.problem(Problem::Value { given: format!("[{count} numbers]"), expected: expected.to_owned() })
    }
}
