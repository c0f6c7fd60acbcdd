//! How steady sliding is found: by solving for it, or by letting the layer slide until it is steady.

use asperity::element::Basis;
use asperity::math::{NotEnoughMemory, check_memory};
use asperity::scene::{FoundationKind, HeightMap, Scene};
use asperity::simulation::Simulation;

use super::never_steady::{NeverSteady, check_can_be_steady};
use super::not_possible::NotPossible;
use super::search::StopBounds;
use crate::steady::{GridSize, SurfaceGrid};

/// A method that is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SweepMethod {
    /// Solves for steady sliding over one period of the surface.
    Steady,
    /// Lets the layer slide until its means are steady.
    Layer,
}

/// The method of a sweep.
#[derive(Clone, Debug)]
pub enum Method {
    /// Steady sliding is solved for on this surface.
    Steady(SurfaceGrid),
    /// The layer slides.
    Layer,
}

/// The scene or an option does not go with the method.
#[derive(Debug, thiserror::Error)]
#[expect(missing_docs, reason = "the messages say what they are")]
pub enum MethodError {
    #[error(
        "steady sliding cannot be solved for: {0}; only the layer can slide (`method` layer of sweep, converge and calibrate)"
    )]
    Lacks(&'static str),
    #[error(
        "`{0}`: expected none with `method` steady, whose points have no scatter and no transient; give `method` layer"
    )]
    OfTheLayer(&'static str),
    #[error(
        "`way`: expected none where the layer slides ({0}): it is what `method` steady warms over; a layer with material.heat \
         warms as it is simulated"
    )]
    WayOfTheLayer(&'static str),
    #[error("`way`: the scene has no material.heat, so friction does not depend on the way")]
    NoHeat,
    #[error(transparent)]
    Range(#[from] NotPossible),
    #[error("`points`: expected none with `method` layer, whose points are its masses")]
    OfTheSolver,
    #[error("surface: {0}; give `method` layer for the line of it that the layer slides on")]
    NoMap(String),
    #[error("surface: expected a map solved on at least {least} points along x and y, found {found:?}")]
    SmallMap { least: usize, found: [usize; 2] },
    #[error("`points`: expected at least {least}, found {found}")]
    FewPoints { least: usize, found: usize },
    #[error(transparent)]
    Memory(#[from] NotEnoughMemory),
}

/// How steady sliding is to be found; without any of it as the scene allows.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SlidingOptions {
    /// By solving for it, or by letting the layer slide; `None`: solved for where the scene can be.
    pub method: Option<SweepMethod>,
    /// The way (m) that rubber as warm as the scene has slid, where it is solved for; `None`: its surface is as warm.
    pub way: Option<f64>,
    /// Points of a period along x, where it is solved for; `None`: the surface's own, or of a profile 8 to its shortest
    /// wave where they are uneven or fewer.
    pub points: Option<u32>,
    /// Standard error of a sliding layer's friction coefficient over it; `None`: 5e-3.
    pub error: Option<f64>,
    /// Longest distance that a layer slides, m; `None`: 100 blocks.
    pub distance: Option<f64>,
}

/// The unit of the way in a table's header.
const METRES: &str = " m";

/// The way of a table, m, by its header; `None` without one.
pub fn way_of(basis: &Basis) -> Option<f64> {
    basis.way.as_ref()?.strip_suffix(METRES)?.parse().ok()
}

/// A way (m) as headers have it.
pub(super) fn in_header(way: f64) -> String {
    format!("{way:?}{METRES}")
}

/// Standard error of the layer's friction coefficient over it where none is given.
const LAYER_ERROR: f64 = 5e-3;

impl SlidingOptions {
    /// When the layer's runs end.
    pub fn bounds(&self) -> StopBounds {
        StopBounds { error: self.error.unwrap_or(LAYER_ERROR), distance: self.distance }
    }

    /// What a table was asked for with these lines of its header; `None` where a layer slid.
    pub(super) fn of_table(basis: &Basis) -> Option<Self> {
        let mut numbers = basis.method.as_ref()?.strip_prefix("steady")?.split(|c: char| !c.is_ascii_digit());
        let points = numbers.find_map(|number| number.parse().ok());
        Some(Self { method: Some(SweepMethod::Steady), points, way: way_of(basis), ..Self::default() })
    }

    /// Whether steady sliding of `scene` is solved for, without the layer.
    pub fn solves(self, scene: &Scene) -> bool {
        self.method.map_or_else(|| why_layer(scene).is_none(), |method| method == SweepMethod::Steady)
    }

    /// The method of a sweep of `scene`, and what the table's header says of it.
    ///
    /// # Errors
    /// Where the scene or another option does not go with the method that is asked for.
    pub fn choose(self, scene: &Scene) -> Result<(Method, String), MethodError> {
        self.check_way(scene, self.way)?;
        let reason = (self.method == Some(SweepMethod::Layer)).then_some("as asked for").or_else(|| why_layer(scene));
        match (self.method, reason) {
            (Some(SweepMethod::Steady), _) | (None, None) => self.steady(scene),
            (_, reason) if self.points.is_none() => {
                Ok((Method::Layer, format!("layer: {}", reason.unwrap_or_default())))
            }
            _ => Err(MethodError::OfTheSolver),
        }
    }

    /// Refuses a way (m) of a scene whose contacts do not warm, or slide as a layer.
    ///
    /// # Errors
    /// Where a way is given.
    pub fn check_way(self, scene: &Scene, way: Option<f64>) -> Result<(), MethodError> {
        let Some(way) = way else { return Ok(()) };
        NotPossible::check("way", "m", &[way])?;
        if scene.material.as_ref().is_none_or(|material| material.heat.is_none()) {
            return Err(MethodError::NoHeat);
        }
        if self.solves(scene) {
            return Ok(());
        }
        Err(MethodError::WayOfTheLayer(why_layer(scene).unwrap_or("as asked for")))
    }

    fn steady(self, scene: &Scene) -> Result<(Method, String), MethodError> {
        let lacks = why_layer(scene)
            .or_else(|| (!scene.layer.roughness.is_empty()).then_some("layer.roughness moves with the rubber"))
            .or_else(|| scene.carrier.z.map(|_| "[carrier.z] is a body that moves under its load"));
        if let Some(lacks) = lacks {
            return Err(MethodError::Lacks(lacks));
        }
        let of_the_layer = [(self.error.is_some(), "friction_error"), (self.distance.is_some(), "distance")];
        if let Some((_, option)) = of_the_layer.into_iter().find(|(is_given, _)| *is_given) {
            return Err(MethodError::OfTheLayer(option));
        }
        let surface = &scene.surface;
        if let Some(problem) = surface.map_error() {
            return Err(MethodError::NoMap(problem.to_string()));
        }
        if let Some(map) = surface.map() {
            return self.steady_on_map(scene, map);
        }
        let (own, usual) = (surface.x().len() - 1, SurfaceGrid::points_of_profile(surface));
        let points = self.points.map_or(usual, |points| points as usize);
        if points < SurfaceGrid::FEWEST {
            return Err(MethodError::FewPoints { least: SurfaceGrid::FEWEST, found: points });
        }
        check_points([points, 1])?;
        let which = match self.points {
            Some(_) => "as asked for".to_owned(),
            None if points == own => "the profile's own".to_owned(),
            None => format!("8 or more to its shortest wave; the profile has {own}"),
        };
        let header = format!("steady, on {points} points to a period of the profile ({which})");
        Ok((Method::Steady(SurfaceGrid::of_profile(surface, points)), header))
    }

    fn steady_on_map(self, scene: &Scene, map: &HeightMap) -> Result<(Method, String), MethodError> {
        let (own, least) = (GridSize { nx: map.nx(), ny: map.ny() }, SurfaceGrid::FEWEST);
        let size = self.points.map_or(own, |points| {
            let share = f64::from(points) / own.nx as f64;
            GridSize { nx: points as usize, ny: (share * own.ny as f64).round() as usize }
        });
        if size.nx.min(size.ny) < least {
            return Err(MethodError::SmallMap { least, found: [size.nx, size.ny] });
        }
        check_points([size.nx, size.ny])?;
        if scene.material.as_ref().is_some_and(|material| material.equilibrium_modulus == 0.0) {
            return Err(MethodError::Lacks(
                "material.equilibrium_modulus = 0 leaves waves across the sliding no stiffness",
            ));
        }
        let surface = SurfaceGrid::of_map(map);
        if size == own {
            return Ok((Method::Steady(surface), format!("steady, on the map's own {} x {} points", own.nx, own.ny)));
        }
        let header = format!(
            "steady, on {} x {} points by the waves of the map, which has {} x {}",
            size.nx, size.ny, own.nx, own.ny
        );
        Ok((Method::Steady(surface.resampled(size)), header))
    }
}

impl Method {
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

/// What of the settings of a sweep its points depend on: where they are solved for, the surface.
pub(super) fn settings(
    surface: Option<&SurfaceGrid>,
    sliding: &SlidingOptions,
    of_layer: impl FnOnce() -> String,
) -> String {
    let way = sliding.way.map_or_else(String::new, |way| format!(" after {way:?} m"));
    match surface {
        // A scene knows the profile, not the map that it is a line of.
        Some(surface) if surface.size.ny > 1 => format!("steady on slopes, map {surface:?}{way}"),
        Some(surface) => format!("steady on slopes, {}x{}{way}", surface.size.nx, surface.size.ny),
        None => of_layer(),
    }
}

impl Method {
    /// What of the settings of a sweep its points depend on.
    pub fn settings(&self, sliding: &SlidingOptions, of_layer: impl FnOnce() -> String) -> String {
        settings(self.surface(), sliding, of_layer)
    }

    /// The surface that steady sliding is solved on; `None` where a layer slides.
    fn surface(&self) -> Option<&SurfaceGrid> {
        match self {
            Self::Steady(surface) => Some(surface),
            Self::Layer => None,
        }
    }

    /// Refuses a scene that could never be steady.
    ///
    /// # Errors
    /// Where no slide of the layer could become steady.
    pub fn check(&self, scene: &Scene) -> Result<(), NeverSteady> {
        match self {
            Self::Steady(_) => Ok(()),
            Self::Layer => check_can_be_steady(scene),
        }
    }
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
        let asked = |method: &str, points: Option<u32>| {
            let basis = Basis { method: Some(method.to_owned()), way: Some(in_header(0.02)), ..Basis::default() };
            let asked = SlidingOptions::of_table(&basis).map(|asked| (asked.method, asked.points, asked.way));
            assert_eq!(asked, Some((Some(SweepMethod::Steady), points, Some(0.02))), "{method}");
        };
        // Points of each thread, and masses of it.
        let (steady, _) = SlidingOptions::default().choose(&scene).unwrap();
        assert_eq!(
            (steady.memory(&scene), Method::Layer.memory(&scene)),
            (16 * 400, Simulation::memory(&scene) as u64)
        );
        assert!(steady.check_threads(&scene, 1_000_000).is_ok());
        for points in [None, Some(24)] {
            let ours = SlidingOptions { points, ..SlidingOptions::default() };
            let (_, header) = ours.choose(&scene).unwrap();
            asked(&header, Some(points.unwrap_or(16)));
        }
        asked("steady, on the map's own 128 x 64 points", Some(128));
        asked("steady, on 256 x 128 points by the waves of the map, which has 128 x 64", Some(256));
        let of_layer = Basis { method: Some("layer: as asked for".into()), ..Basis::default() };
        assert!([of_layer, Basis::default()].iter().all(|basis| SlidingOptions::of_table(basis).is_none()));
    }
}
