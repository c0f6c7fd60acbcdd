//! What a sweep of one scene computes: the points over speed, load and temperature, and the row of each.

use asperity::element::{Basis, Load, OperatingPoint, SweepGrid, TableHeader, TableRow};
use asperity::math::check_memory;
use asperity::model::{EvenSliding, Model};
use asperity::scene::{FineRoughness, Scene, Surface, Wlf};
use asperity::simulation::Interrupt;

use super::error::SweepError;
use super::load_search::separation_at_rest;
use super::method::{self, Method, SlidingOptions, SweepMethod, in_header};
use super::not_possible::NotPossible;
use super::point;
use super::scenes::{relevant, scene_at};
use super::search::StopBounds;
use super::solved::SolvedPoints;
use super::table;
use crate::implausible::{FoundFriction, implausible};
use crate::steady::SurfaceGrid;

/// Mean loads to sweep over, rising.
#[derive(Clone, Debug, PartialEq)]
pub enum Loads {
    /// Mean pressures, Pa; of a scene in the material form.
    Pressures(Vec<f64>),
    /// Mean normal forces F_z of the whole layer, N.
    Forces(Vec<f64>),
}

/// What a sweep goes over, and how its points are found.
#[derive(Clone, Debug)]
pub struct SweepOptions {
    /// Speeds, m/s, rising.
    pub speeds: Vec<f64>,
    /// Loads.
    pub loads: Loads,
    /// Temperatures, K, rising; `None`: the scene's own.
    pub temperatures: Option<Vec<f64>>,
    /// How steady sliding is found.
    pub sliding: SlidingOptions,
}

/// A sweep of a scene, its points not found yet.
#[derive(Debug)]
pub(super) struct ScenePlan {
    scene: Scene,
    /// The header of its table.
    pub(super) header: TableHeader,
    bounds: StopBounds,
    /// Where steady sliding is solved for; else the layer slides.
    solved: Option<SolvedPoints>,
    /// What to look at before the points are found: a load that presses the layer harder than its links stand for, or
    /// temperatures that are probably meant in °C.
    pub(super) warning: Option<String>,
}

impl ScenePlan {
    /// The sweep of a `scene`, of which a study of convergence found what `convergence` says.
    ///
    /// # Errors
    /// Where the scene does not go with the options, or could never slide steadily.
    pub(super) fn new(scene: Scene, options: &SweepOptions, convergence: Option<String>) -> Result<Self, SweepError> {
        let mut plan = Self::without_fingerprint(scene, options, convergence)?;
        let surface = plan.solved.as_ref().map(SolvedPoints::surface);
        plan.header.fingerprint = fingerprint(&plan.scene, &options.sliding, plan.header.load, surface)?;
        Ok(plan)
    }

    fn without_fingerprint(
        scene: Scene,
        options: &SweepOptions,
        convergence: Option<String>,
    ) -> Result<Self, SweepError> {
        if scene.carrier.x.is_some() {
            return Err(SweepError::BodyAlongX);
        }
        check(options)?;
        let (load, loads) = loads(&options.loads, &scene)?;
        let (method, of_method) = options.sliding.choose(&scene)?;
        let pressed = if matches!(method, Method::Layer) { hard_pressure(&scene, load, &loads) } else { None };
        let cold = options.temperatures.as_deref().and_then(Wlf::meant_in_celsius);
        let warning = pressed.or_else(|| cold.map(|cold| format!("`temperatures`: {cold}")));
        let temperatures = temperatures(options.temperatures.as_deref(), &scene)?;
        let grid = SweepGrid { speeds: options.speeds.clone(), loads, temperatures };
        method.check(&scene)?;
        method.check_threads(&scene, grid.points().count())?;
        let scene = relevant(scene);
        let bounds = options.sliding.bounds();
        let header = TableHeader {
            fingerprint: String::new(),
            scene: scene.name.clone(),
            load,
            rest_separation: separation_at_rest(&scene),
            basis: Basis {
                method: Some(of_method),
                way: options.sliding.way.map(in_header),
                ..basis(&scene, convergence)
            },
            samples: None,
            grid,
            low_end: None,
            ranking: Vec::new(),
        };
        let solved = match method {
            Method::Steady(surface) => {
                Some(SolvedPoints::new(&scene, &header.grid.temperatures, surface, options.sliding.way)?)
            }
            Method::Layer => None,
        };
        Ok(Self { scene, header, bounds, solved, warning })
    }

    /// The row of a point; `interrupt` may stop a layer as it slides.
    pub(super) fn row(&self, point: &OperatingPoint, interrupt: &Interrupt) -> TableRow {
        match &self.solved {
            Some(solved) => solved.row(*point, &self.header),
            None => {
                let scene = scene_at(&self.scene, point);
                point::row(&scene, *point, &self.header, self.bounds, interrupt)
            }
        }
    }

    /// The sweep of a `scene` that was drawn from what is not known of this one's, at temperatures that are `warmer` (K), on
    /// as many points; where it has the same surface, that is there once.
    ///
    /// # Errors
    /// As for [`new`](Self::new).
    pub(super) fn drawn(&self, scene: Scene, options: &SweepOptions, warmer: f64) -> Result<Self, SweepError> {
        let own = &self.header.grid.temperatures;
        let temperatures = (!own.is_empty()).then(|| own.iter().map(|kelvin| kelvin + warmer).collect());
        let mut sliding = SlidingOptions { method: Some(SweepMethod::Layer), ..options.sliding };
        if let Some(solved) = &self.solved {
            let points = u32::try_from(solved.surface().size.nx).ok();
            sliding = SlidingOptions { method: Some(SweepMethod::Steady), points, ..sliding };
        }
        let mut drawn =
            Self::without_fingerprint(scene, &SweepOptions { temperatures, sliding, ..options.clone() }, None)?;
        if let (Some(solved), Some(own)) = (&mut drawn.solved, &self.solved) {
            solved.share(own);
            // All of it is on the grid.
            drawn.scene.surface = Surface::new(vec![0.0, 1.0], vec![0.0; 2], false);
        }
        Ok(drawn)
    }

    /// The bytes of a surface on the grid; 0 of a layer.
    pub(super) fn surface_memory(&self) -> u64 {
        self.solved.as_ref().map_or(0, |solved| 8 * solved.surface().size.points() as u64)
    }

    /// How many points were solved for so far.
    #[cfg(test)]
    pub(super) fn solutions(&self) -> usize {
        self.solved.as_ref().map_or(0, SolvedPoints::solutions)
    }

    /// What to look at in the rows: few points of the surface in contact, and friction that no rubber has.
    pub(super) fn warnings<'a>(&self, rows: impl Iterator<Item = &'a TableRow> + Clone) -> Vec<String> {
        let few = self.solved.as_ref().and_then(|solved| solved.few_points(rows.clone(), &self.header));
        let found = rows.clone().filter_map(|row| FoundFriction::of_row(row, self.header.load));
        let uneven = self.uneven(rows.clone());
        few.into_iter().chain(implausible(&self.scene, found)).chain(uneven).collect()
    }

    /// The warning where a layer does not slide evenly at some of the rows.
    fn uneven<'a>(&self, rows: impl Iterator<Item = &'a TableRow>) -> Option<String> {
        if self.solved.is_some() || !self.scene.friction_depends_on_speed() {
            return None;
        }
        let masses = self.scene.layer.masses as f64;
        let at = |row: &TableRow| {
            let (scene, point) = (scene_at(&self.scene, &row.point), &row.point);
            let whole = match self.header.load {
                Load::Pressure { area } => point.load * area,
                Load::Force => point.load,
            };
            EvenSliding::at(&scene, &Model::new(&scene), point.speed, whole / masses)
        };
        EvenSliding::warning_among(&self.scene, rows.map(at))
    }
}

/// Checks that there are such states of sliding, and no more of them than the memory holds rows.
fn check(options: &SweepOptions) -> Result<(), SweepError> {
    /// Of a row.
    const BYTES: u64 = 1024;
    NotPossible::check("speeds", "m/s", &options.speeds)?;
    let loads = match &options.loads {
        Loads::Pressures(pressures) => NotPossible::check("pressures", "Pa", pressures).map(|()| pressures.len()),
        Loads::Forces(forces) => NotPossible::check("forces", "N", forces).map(|()| forces.len()),
    }?;
    let temperatures = options.temperatures.as_deref().unwrap_or(&[0.0]).len();
    let points = [options.speeds.len(), loads, temperatures].map(|count| count as u64);
    let points = points.into_iter().fold(1, u64::saturating_mul);
    Ok(check_memory(points.saturating_mul(BYTES), || format!("{points} points of the sweep"))?)
}

/// What the table rests on, for those who use it.
fn basis(scene: &Scene, convergence: Option<String>) -> Basis {
    let foundation = scene.layer.foundation.map(|kind| kind.word().to_owned());
    let fine = scene.fine.as_ref().map(FineRoughness::describe);
    let held = scene.carrier.z.map(|body| format!("load, on a carrier of {} kg", body.mass));
    Basis { foundation, fine, convergence, held, ..Basis::default() }
}

fn loads(loads: &Loads, scene: &Scene) -> Result<(Load, Vec<f64>), SweepError> {
    match loads {
        Loads::Forces(forces) => Ok((Load::Force, forces.clone())),
        Loads::Pressures(pressures) => {
            let area = scene.layer.area().ok_or(SweepError::NoArea)?;
            Ok((Load::Pressure { area }, pressures.clone()))
        }
    }
}

/// The warning where the largest of `loads` presses the layer harder than its links stand for.
fn hard_pressure(scene: &Scene, load: Load, loads: &[f64]) -> Option<String> {
    let largest = loads.iter().copied().fold(0.0, f64::max);
    match load {
        Load::Pressure { .. } => scene.hard_pressure("the largest of `pressures`", largest),
        Load::Force => scene.hard_pressure("the largest of `forces` over the area", largest / scene.layer.area()?),
    }
}

/// Those asked for, or the scene's own; none where it has none.
fn temperatures(asked: Option<&[f64]>, scene: &Scene) -> Result<Vec<f64>, SweepError> {
    let Some(own) = scene.temperature() else {
        return if asked.is_some() { Err(SweepError::NoWlf) } else { Ok(Vec::new()) };
    };
    let values = asked.map_or_else(|| vec![own], <[f64]>::to_vec);
    for &temperature in &values {
        scene.with_temperature(temperature).check().map_err(SweepError::Temperature)?;
    }
    Ok(values)
}

fn fingerprint(
    scene: &Scene,
    sliding: &SlidingOptions,
    load: Load,
    surface: Option<&SurfaceGrid>,
) -> Result<String, serde_json::Error> {
    // The same for all temperatures: each point has its own.
    let scene = scene.with_temperature(0.0);
    let StopBounds { error, distance } = sliding.bounds();
    let settings = method::settings(surface, sliding, || format!("{error:?} {distance:?}"));
    table::fingerprint(&scene, &format!("{} {settings}", load.name()))
}
