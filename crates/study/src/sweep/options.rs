//! What is asked of a sweep: its points, and how steady sliding is found - by solving for it, or by letting the layer
//! slide until it is steady.

use asperity::math::{NotEnoughMemory, check_memory};
use asperity::scene::{FoundationKind, HeightMap, Scene};
use asperity::simulation::Simulation;
use asperity::table::{Header, TableError};
use asperity::tables::{Dimension, POSITIVE};
use clap::{Args, ValueEnum};
use serde::{Deserialize, Serialize};
use uuid::Uuid;

use super::layer::Blocks;
use super::search::{MIN_BLOCKS, StopBounds};
use super::table::GAPS;
use crate::Error;
use crate::steady::{GridSize, SurfaceGrid};
use crate::values::{Values, count, length, share};

/// A method that is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum SweepMethod {
    /// Solves for steady sliding over one period of the surface
    Steady,
    /// Lets the layer slide until its means are steady
    Layer,
}

impl SweepMethod {
    fn word(self) -> &'static str {
        match self {
            Self::Steady => "steady",
            Self::Layer => "layer",
        }
    }
}

// How steady sliding is to be found; without any of it as the scene allows. Not a doc comment: that would be the
// description of the commands that have it.
#[expect(missing_docs, reason = "clap would print it")]
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, Args)]
#[serde(default)]
pub struct SlidingOptions {
    /// How steady sliding is found: by solving for it, or by letting the layer slide until it is. Default: steady where the
    /// foundation is "half_space" or "layer" and the surface periodic and not flat; else layer.
    #[arg(long, value_name = "METHOD", value_enum)]
    pub method: Option<SweepMethod>,
    /// The way slid so far, in m: the scene's temperature is that of the rubber before it slid, not that of the surface around
    /// its contacts. With --method steady, of a scene with material.heat.
    #[arg(long, value_name = "LENGTH", value_parser = length, allow_negative_numbers = true)]
    pub way: Option<f64>,
    /// Points of a period along x, with --method steady; of a map with those along y in proportion. Default: the surface's
    /// own, or of a profile 8 to its shortest wave where they are uneven or fewer.
    #[arg(long, value_name = "N", value_parser = count)]
    pub points: Option<u32>,
    /// Admissible standard error of the friction coefficient, relative to it, with --method layer. Default: 5e-3.
    #[arg(long, value_name = "SHARE", value_parser = share)]
    pub friction_error: Option<f64>,
    /// Maximum sliding distance in m for a point to become steady, with --method layer. Default: 100 blocks; a block is a
    /// whole number of profile periods or layer lengths.
    #[arg(long, value_name = "LENGTH", value_parser = length, allow_negative_numbers = true)]
    pub distance: Option<f64>,
}

// What a sweep goes over, and how its points are found.
#[expect(missing_docs, reason = "clap would print it")]
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, Args)]
#[serde(default)]
pub struct SweepOptions {
    /// Speeds in m/s: a..b/n for n values evenly spaced in the logarithm, a list, or both, separated by commas.
    #[arg(long, value_name = "VALUES", value_parser = Values::of(Dimension::Speed))]
    pub speeds: Option<Values>,
    /// Mean pressures in Pa, in the format of --speeds. Requires a scene in the material form.
    #[arg(long, value_name = "VALUES", value_parser = Values::of(Dimension::Pressure), conflicts_with = "forces")]
    pub pressures: Option<Values>,
    /// Mean normal forces F_z of the whole layer in N, in place of pressures. Works with either form of scene.
    #[arg(long, value_name = "VALUES", value_parser = Values::of(Dimension::Force))]
    pub forces: Option<Values>,
    /// Temperatures in K: a..b/n for n evenly spaced values. Default: the scene's temperature.
    #[arg(long, value_name = "VALUES", value_parser = Values::of(Dimension::Temperature))]
    #[arg(allow_hyphen_values = true)]
    pub temperatures: Option<Values>,
    /// Whether the rows have how a fluid passes the gaps, and how that is found.
    #[arg(skip)]
    pub gaps: Option<Gaps>,
    #[command(flatten)]
    #[serde(flatten)]
    pub sliding: SlidingOptions,
}

/// How a fluid passes the gaps of a contact.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum Gaps {
    /// Solved for on maps, the effective medium of profiles
    Solved,
    /// The effective medium of maps beside it
    Medium,
}

impl Gaps {
    /// Those of a table by its header; `None` without.
    pub(super) fn of_table(header: &Header) -> Option<Self> {
        let word = header.text_of(GAPS)?;
        Some(if word == Self::Medium.word() { Self::Medium } else { Self::Solved })
    }

    /// As the header of a table has it.
    pub(super) fn word(self) -> &'static str {
        match self {
            Self::Solved => "solved",
            Self::Medium => "medium",
        }
    }
}

/// Checks numbers of an option, which a state of sliding has.
///
/// # Errors
/// Where one of them is out of range.
pub fn check_possible(option: &str, unit: &str, values: &[f64]) -> Result<(), Error> {
    match values.iter().find(|value| !POSITIVE.holds(**value)) {
        Some(found) => Err(Error::scene(format!("`{option}`: expected {POSITIVE} in {unit}, found {found:?}"))),
        None => Ok(()),
    }
}

/// The method of a sweep.
#[derive(Clone, Debug)]
pub enum Method {
    /// Steady sliding is solved for on this surface.
    Steady(SurfaceGrid),
    /// The layer slides.
    Layer,
}

/// Standard error of the layer's friction coefficient over it where none is given.
const LAYER_ERROR: f64 = 5e-3;

/// The keys of these options in the header of a table.
const SLIDING: &str = "sliding";
const POINTS: &str = "points";
const WAY: &str = "way";
const FRICTION_ERROR: &str = "friction_error";
const DISTANCE: &str = "distance";

/// The way of a table, m, by its header; `None` without one.
pub fn way_of(header: &Header) -> Option<f64> {
    header.number(WAY, "m").ok()
}

impl SlidingOptions {
    /// When the layer's runs end.
    pub fn bounds(&self) -> StopBounds {
        StopBounds { error: self.friction_error.unwrap_or(LAYER_ERROR), distance: self.distance }
    }

    /// What is to be asked for to find the same points on the `surface` of the method that was [chosen](Self::choose).
    pub fn settled(self, surface: Option<&SurfaceGrid>) -> Self {
        match surface {
            Some(surface) => {
                let points = u32::try_from(surface.size.nx).ok();
                Self { method: Some(SweepMethod::Steady), points, ..self }
            }
            None => Self { method: Some(SweepMethod::Layer), friction_error: Some(self.bounds().error), ..self },
        }
    }

    /// The header with these options.
    pub(crate) fn in_header(self, mut header: Header) -> Header {
        header = header.with_some(SLIDING, self.method.map(SweepMethod::word));
        if let Some(points) = self.points {
            header = header.with_whole(POINTS, points.into());
        }
        let numbers = [(WAY, self.way, "m"), (FRICTION_ERROR, self.friction_error, ""), (DISTANCE, self.distance, "m")];
        for (key, value, unit) in numbers {
            if let Some(value) = value {
                header = header.with_number(key, value, unit);
            }
        }
        header
    }

    /// What a table was asked for by its header; where that does not say, a layer slid.
    ///
    /// # Errors
    /// Where points were solved for, and it does not say on how many.
    pub fn of_table(header: &Header) -> Result<Self, TableError> {
        let is_solved = match header.text_of(SLIDING) {
            Some(word) => word == SweepMethod::Steady.word(),
            // Tables of before say it in words alone.
            None => header.text_of("method").is_some_and(|text| text.starts_with(SweepMethod::Steady.word())),
        };
        let method = Some(if is_solved { SweepMethod::Steady } else { SweepMethod::Layer });
        let points = if is_solved { u32::try_from(header.whole(POINTS)?).ok() } else { None };
        let metres = |key| header.optional(key, |header, key| header.number(key, "m"));
        let friction_error = header.optional(FRICTION_ERROR, |header, key| header.number(key, ""))?;
        Ok(Self { method, way: metres(WAY)?, points, friction_error, distance: metres(DISTANCE)? })
    }

    /// Whether steady sliding of `scene` is solved for, without the layer.
    pub fn solves(self, scene: &Scene) -> bool {
        self.method.map_or_else(|| why_layer(scene).is_none(), |method| method == SweepMethod::Steady)
    }

    /// The method of a sweep of `scene`, and what the table's header says of it to people.
    ///
    /// # Errors
    /// Where the scene or another option does not go with the method that is asked for.
    pub fn choose(self, scene: &Scene) -> Result<(Method, String), Error> {
        self.check_way(scene, self.way)?;
        let reason = (self.method == Some(SweepMethod::Layer)).then_some("as asked for").or_else(|| why_layer(scene));
        match (self.method, reason) {
            (Some(SweepMethod::Steady), _) | (None, None) => self.steady(scene),
            (_, reason) if self.points.is_none() => {
                Ok((Method::Layer, format!("layer: {}", reason.unwrap_or_default())))
            }
            _ => Err(Error::scene("`points`: expected none with `method` layer, whose points are its masses")),
        }
    }

    /// The surface that steady sliding of a `scene` is solved on.
    ///
    /// # Errors
    /// As for [`choose`](Self::choose), and where a layer would slide.
    pub(crate) fn grid(self, scene: &Scene) -> Result<SurfaceGrid, Error> {
        match self.choose(scene)? {
            (Method::Steady(grid), _) => Ok(grid),
            (Method::Layer, of_method) => Err(Error::value(of_method)),
        }
    }

    /// Refuses a way (m) of a scene whose contacts do not warm, or slide as a layer.
    ///
    /// # Errors
    /// Where a way is given.
    pub fn check_way(self, scene: &Scene, way: Option<f64>) -> Result<(), Error> {
        let Some(way) = way else { return Ok(()) };
        check_possible("way", "m", &[way])?;
        if scene.material.as_ref().is_none_or(|material| material.heat.is_none()) {
            return Err(Error::scene("`way`: the scene has no material.heat, so friction does not depend on the way"));
        }
        if self.solves(scene) {
            return Ok(());
        }
        Err(Error::scene(format!(
            "`way`: expected none where the layer slides ({}): it is what `method` steady warms over; a layer with \
             material.heat warms as it is simulated",
            why_layer(scene).unwrap_or("as asked for")
        )))
    }

    fn steady(self, scene: &Scene) -> Result<(Method, String), Error> {
        let lacks = why_layer(scene)
            .or_else(|| (!scene.layer.roughness.is_empty()).then_some("layer.roughness moves with the rubber"))
            .or_else(|| scene.carrier.z.map(|_| "[carrier.z] is a body that moves under its load"));
        if let Some(lacks) = lacks {
            return Err(cannot_be_solved(lacks));
        }
        let of_the_layer = [(self.friction_error.is_some(), FRICTION_ERROR), (self.distance.is_some(), DISTANCE)];
        if let Some((_, option)) = of_the_layer.into_iter().find(|(is_given, _)| *is_given) {
            return Err(Error::scene(format!(
                "`{option}`: expected none with `method` steady, whose points have no scatter and no transient; give \
                 `method` layer"
            )));
        }
        let surface = &scene.surface;
        if let Some(problem) = surface.map_error() {
            return Err(Error::scene(format!(
                "surface: {problem}; give `method` layer for the line of it that the layer slides on"
            )));
        }
        if let Some(map) = surface.map() {
            return self.steady_on_map(scene, map);
        }
        let (own, usual) = (surface.x().len() - 1, SurfaceGrid::points_of_profile(surface));
        let points = self.points.map_or(usual, |points| points as usize);
        if points < SurfaceGrid::FEWEST {
            return Err(Error::scene(format!("`points`: expected at least {}, found {points}", SurfaceGrid::FEWEST)));
        }
        check_points([points, 1])?;
        let which = match self.points {
            Some(_) => "as asked for".to_owned(),
            None if points == own => "the profile's own".to_owned(),
            None => format!("8 or more to its shortest wave; the profile has {own}"),
        };
        let said = format!("steady, on {points} points to a period of the profile ({which})");
        Ok((Method::Steady(SurfaceGrid::of_profile(surface, points)), said))
    }

    fn steady_on_map(self, scene: &Scene, map: &HeightMap) -> Result<(Method, String), Error> {
        let (own, least) = (GridSize { nx: map.nx(), ny: map.ny() }, SurfaceGrid::FEWEST);
        let size = self.points.map_or(own, |points| {
            let share = f64::from(points) / own.nx as f64;
            GridSize { nx: points as usize, ny: (share * own.ny as f64).round() as usize }
        });
        if size.nx.min(size.ny) < least {
            let found = [size.nx, size.ny];
            return Err(Error::scene(format!(
                "surface: expected a map solved on at least {least} points along x and y, found {found:?}"
            )));
        }
        check_points([size.nx, size.ny])?;
        if scene.material.as_ref().is_some_and(|material| material.equilibrium_modulus == 0.0) {
            return Err(cannot_be_solved(
                "material.equilibrium_modulus = 0 leaves waves across the sliding no stiffness",
            ));
        }
        let surface = SurfaceGrid::of_map(map);
        if size == own {
            return Ok((Method::Steady(surface), format!("steady, on the map's own {} x {} points", own.nx, own.ny)));
        }
        let said = format!(
            "steady, on {} x {} points by the waves of the map, which has {} x {}",
            size.nx, size.ny, own.nx, own.ny
        );
        Ok((Method::Steady(surface.resampled(size)), said))
    }
}

fn cannot_be_solved(lacks: &str) -> Error {
    Error::scene(format!(
        "steady sliding cannot be solved for: {lacks}; only the layer can slide (`method` layer of sweep, converge and \
         calibrate)"
    ))
}

/// Why a scene cannot be solved for, and the layer has to slide; `None` where it need not.
fn why_layer(scene: &Scene) -> Option<&'static str> {
    let heights = scene.surface.z();
    match scene.layer.foundation {
        None => Some("the scene is in the direct form"),
        Some(FoundationKind::Springs) => Some("the foundation is \"springs\""),
        _ if heights.iter().all(|height| *height == heights[0]) => Some("the surface is flat"),
        _ if !scene.surface.is_periodic() => Some("the surface is not periodic"),
        _ => None,
    }
}

impl Method {
    /// The surface that steady sliding is solved on; `None` where a layer slides.
    pub fn surface(&self) -> Option<&SurfaceGrid> {
        match self {
            Self::Steady(surface) => Some(surface),
            Self::Layer => None,
        }
    }

    /// Refuses a scene that could never be steady.
    ///
    /// # Errors
    /// Where no slide of the layer could become steady.
    pub fn check(&self, scene: &Scene) -> Result<(), Error> {
        if matches!(self, Self::Steady(_)) {
            return Ok(());
        }
        if scene.material.as_ref().is_some_and(|material| material.heat.is_some()) {
            return Err(Error::scene(
                "material.heat: expected none for steady sliding of the layer, since contacts that slide on warm without \
                 end; leave it out and vary material.wlf.temperature, or give `method` steady, which has the temperature \
                 above the surface's mean",
            ));
        }
        let blocks = Blocks::new(scene, 1.0);
        if blocks.has_room(MIN_BLOCKS) {
            return Ok(());
        }
        Err(Error::scene(format!(
            "the profile ends {:.4e} m from where the layer starts, and steady sliding takes {:.4e} m or more: make it \
             periodic, as `asperity surface --mirror --write` does, or `taper`, and give periodic = true in [surface]",
            blocks.longest,
            MIN_BLOCKS * blocks.length
        )))
    }

    /// Checks that as many of `count` points of a sweep can be found at once as there are threads.
    pub(super) fn check_threads(&self, scene: &Scene, count: usize) -> Result<(), NotEnoughMemory> {
        let threads = rayon::current_num_threads().min(count);
        check_memory(self.memory(scene).saturating_mul(threads as u64), || {
            let of_each = match self {
                Self::Steady(surface) => format!("`points`: {} x {} points", surface.size.nx, surface.size.ny),
                Self::Layer => format!("layer.masses = {}", scene.layer.masses),
            };
            format!("{of_each} on each of {threads} threads")
        })
    }

    /// Bytes that finding a point of a sweep takes.
    fn memory(&self, scene: &Scene) -> u64 {
        match self {
            Self::Steady(surface) => memory_of_points([surface.size.nx, surface.size.ny]),
            Self::Layer => Simulation::memory(scene) as u64,
        }
    }
}

/// Bytes of a surface of so many points, in the solver and what it finds.
fn memory_of_points([nx, ny]: [usize; 2]) -> u64 {
    /// Of a point.
    const BYTES: u64 = 400;
    (nx as u64).saturating_mul(ny as u64).saturating_mul(BYTES)
}

/// Checks that a surface of so many points can be solved for.
fn check_points([nx, ny]: [usize; 2]) -> Result<(), NotEnoughMemory> {
    check_memory(memory_of_points([nx, ny]), || match ny {
        1 => format!("`points`: {nx} points"),
        _ => format!("`points`: {nx} x {ny} points"),
    })
}

/// Tells what is computed of a scene from all else: depends on everything in the scene that steady sliding depends on, on
/// the [settled](SlidingOptions::settled) options and what else is asked for.
///
/// # Errors
/// Where it cannot be written as JSON.
pub fn fingerprint(
    scene: &Scene,
    sliding: SlidingOptions,
    surface: Option<&SurfaceGrid>,
    asked: &str,
) -> Result<String, Error> {
    // A scene knows the profile, not the map that it is a line of.
    let map = surface.filter(|surface| surface.size.ny > 1).map(|surface| format!("{surface:?}"));
    let what = (env!("CARGO_PKG_VERSION"), asked, sliding.settled(surface), map, scene);
    Ok(fingerprint_of(&serde_json::to_string(&what)?))
}

/// Tells one text from another.
pub(super) fn fingerprint_of(text: &str) -> String {
    Uuid::new_v5(&Uuid::NAMESPACE_OID, text.as_bytes()).simple().to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The headers that are written say what is to be asked for to have the same points again.
    #[test]
    fn a_header_says_how_many_points_there_were() {
        let text = "name = 'sine'\nlayer = { foundation = 'half_space', masses = 32, spacing = 1e-4, width = 1e-2 }\n\
                    material = { density = 1e3, poisson_ratio = 0.5, equilibrium_modulus = 1e6, prony = [] }\n\
                    surface = { kind = 'sinusoid', amplitude = 1e-5, wavelength = 1e-3, points_per_wavelength = 6 }";
        let scene = Scene::parse(text, "sine.toml".as_ref()).unwrap();
        let (steady, _) = SlidingOptions::default().choose(&scene).unwrap();
        // Points of each thread, and masses of it.
        assert_eq!(
            (steady.memory(&scene), Method::Layer.memory(&scene)),
            (16 * 400, Simulation::memory(&scene) as u64)
        );
        assert!(steady.check_threads(&scene, 1_000_000).is_ok());
        let way = Some(0.02);
        for points in [None, Some(24)] {
            let ours = SlidingOptions { points, way, ..SlidingOptions::default() };
            let (method, _) = SlidingOptions { way: None, ..ours }.choose(&scene).unwrap();
            let settled = ours.settled(method.surface());
            assert_eq!((settled.points, settled.way), (points.or(Some(16)), way));
            assert_eq!(SlidingOptions::of_table(&settled.in_header(Header::default())), Ok(settled));
        }
        let layer = SlidingOptions { distance: Some(1.0), ..SlidingOptions::default() }.settled(None);
        assert_eq!(SlidingOptions::of_table(&layer.in_header(Header::default())), Ok(layer));
        // Of before: in words alone.
        let old = Header::default().with("method", "steady, on 16 points");
        assert!(SlidingOptions::of_table(&old).unwrap_err().to_string().contains("# points = "));
        assert_eq!(SlidingOptions::of_table(&Header::default()).unwrap().method, Some(SweepMethod::Layer));
    }
}
