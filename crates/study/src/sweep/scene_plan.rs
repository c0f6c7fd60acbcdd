//! What a sweep of one scene computes: the points over speed, load and temperature, and the row of each.

use std::f64::consts::PI;

use asperity::element::{Load, OperatingPoint, Quantity, SWEEP, SweepGrid};
use asperity::math::check_memory;
use asperity::model::EvenSliding;
use asperity::scene::{FineRoughness, Material, ParameterError, Scene, Surface, Wlf};
use asperity::simulation::Interrupt;
use asperity::table::Header;

use super::layer::{even_sliding, relevant, scene_at};
use super::load_search::separation_at_rest;
use super::options::{Gaps, Method, SlidingOptions, SweepMethod, SweepOptions, check_possible, fingerprint};
use super::point;
use super::search::StopBounds;
use super::solved::{SolvedPoints, no_area};
use super::table::{GAPS, SweepHeader, SweepRow};
use crate::Error;
use crate::decimals::short;
use crate::error::Context as _;
use crate::implausible::{FoundFriction, at, implausible, misfitted, strained};
use crate::values::Values;

/// A sweep of a scene, its points not found yet.
#[derive(Debug)]
pub(super) struct ScenePlan {
    scene: Scene,
    /// The header of its table.
    pub(super) header: SweepHeader,
    bounds: StopBounds,
    /// Where steady sliding is solved for; else the layer slides.
    solved: Option<SolvedPoints>,
    /// What to look at before the points are found: a load that presses the rubber too hard, and temperatures that are
    /// probably meant in °C.
    pub(super) warnings: Vec<String>,
}

impl ScenePlan {
    /// The sweep of a `scene`, of which a study of convergence found what `convergence` says.
    ///
    /// # Errors
    /// Where the scene does not go with the options, or could never slide steadily.
    pub(super) fn new(scene: Scene, options: &SweepOptions, convergence: Option<String>) -> Result<Self, Error> {
        if scene.carrier.x.is_some() {
            return Err(Error::scene("the scene has [carrier.x]; expected none, since a sweep prescribes the speed"));
        }
        let (load, grid) = grid(options, &scene)?;
        let (method, in_words) = options.sliding.choose(&scene)?;
        let pressed = hard_pressure(&scene, load, &grid.loads, matches!(method, Method::Layer));
        let cold = options.temperatures.as_ref().and_then(|values| Wlf::meant_in_celsius(&values.0));
        let cold = cold.map(|cold| format!("`temperatures`: {cold}"));
        let warnings = pressed.into_iter().chain(cold).collect();
        method.check(&scene)?;
        method.check_threads(&scene, grid.count())?;
        let scene = relevant(scene);
        // Which sweep it is says who asks for it: of many samples nobody does.
        let keys = Header::new(SWEEP).with("scene", &scene.name).with("fingerprint", "").with("method", &in_words);
        let keys = options.sliding.settled(method.surface()).in_header(keys);
        let keys = keys.with_some(GAPS, options.gaps.map(Gaps::word));
        let is_even = matches!(method, Method::Layer) && scene.memory_follows();
        let keys = rests_on(keys, &scene, convergence).with_some("memory", is_even.then_some(DEFAULT_MEMORY));
        let header = SweepHeader::new(keys, load, separation_at_rest(&scene), grid);
        let solved = match method {
            Method::Steady(surface) => {
                let points = SolvedPoints::new(&scene, &header.grid.temperatures, surface, options.sliding.way)?;
                Some(points.with_gaps(options.gaps))
            }
            Method::Layer if options.gaps.is_some() => {
                return Err(Error::scene(format!(
                    "`gaps`: expected none where the layer slides ({in_words}): they are those that `method` steady finds"
                )));
            }
            Method::Layer => None,
        };
        Ok(Self { scene, header, bounds: options.sliding.bounds(), solved, warnings })
    }

    /// Tells this sweep from others.
    pub(super) fn fingerprint(&self, sliding: SlidingOptions) -> Result<String, Error> {
        let surface = self.solved.as_ref().map(SolvedPoints::surface);
        // The same for all temperatures: each point has its own.
        let gaps = self.header.keys.text_of(GAPS).map(|gaps| format!(" {GAPS} {gaps}")).unwrap_or_default();
        let asked = format!("{}{gaps}", self.header.load.name());
        fingerprint(&self.scene.with_temperature(0.0), sliding, surface, &asked)
    }

    /// Checks that a scene that was drawn has the temperatures of the points, which are `warmer` (K) there.
    pub(super) fn check_temperatures(&self, drawn: &Scene, warmer: f64) -> Result<(), ParameterError> {
        let temperatures = &self.header.grid.temperatures;
        temperatures.iter().try_for_each(|kelvin| drawn.with_temperature(kelvin + warmer).check())
    }

    /// The row of a point; `interrupt` may stop a layer as it slides.
    pub(super) fn row(&self, point: &OperatingPoint, interrupt: &Interrupt) -> SweepRow {
        match &self.solved {
            Some(solved) => solved.row(*point, &self.header),
            None => {
                let scene = scene_at(&self.scene, point, self.header.load);
                point::row(&scene, *point, &self.header, self.bounds, interrupt)
            }
        }
    }

    /// The sweep of a `scene` that was drawn from what is not known of this one's, at temperatures that are `warmer` (K), on
    /// as many points; where it has the same surface, that is there once.
    ///
    /// # Errors
    /// As for [`new`](Self::new).
    pub(super) fn drawn(&self, scene: Scene, options: &SweepOptions, warmer: f64) -> Result<Self, Error> {
        let own = &self.header.grid.temperatures;
        let temperatures = (!own.is_empty()).then(|| Values(own.iter().map(|kelvin| kelvin + warmer).collect()));
        let mut sliding = SlidingOptions { method: Some(SweepMethod::Layer), ..options.sliding };
        if let Some(solved) = &self.solved {
            let points = u32::try_from(solved.surface().size.nx).ok();
            sliding = SlidingOptions { method: Some(SweepMethod::Steady), points, ..sliding };
        }
        let mut drawn = Self::new(scene, &SweepOptions { temperatures, sliding, ..options.clone() }, None)?;
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

    /// What to look at in the rows: few points of the surface in contact, pressures that alternate, friction that no rubber has.
    pub(super) fn warnings(&self, rows: &[SweepRow]) -> Vec<String> {
        let few = self.solved.as_ref().and_then(|solved| solved.few_points(rows, &self.header));
        let found: Vec<_> = rows.iter().filter_map(|row| found_friction(row, self.header.load)).collect();
        let of_layer = if self.solved.is_none() { self.of_layer(rows, &found) } else { Vec::new() };
        let alternating = self.solved.as_ref().and_then(|solved| solved.alternating(rows, &self.header));
        few.into_iter().chain(alternating).chain(implausible(&self.scene, found)).chain(of_layer).collect()
    }

    /// Where the layer makes friction and contacts that the rubber has not.
    fn of_layer(&self, rows: &[SweepRow], found: &[FoundFriction]) -> Vec<String> {
        let touching = |row: &SweepRow| {
            let share = row.value(Quantity::ContactRatio).filter(|_| row.is_result())?;
            Some((at(&row.point, self.header.load), share))
        };
        let strained = strained(&self.scene, found.iter().cloned());
        let misfitted = misfitted(&self.scene, rows.iter().filter_map(touching));
        strained.into_iter().chain(misfitted).chain(self.uneven(rows)).collect()
    }

    /// The warning where a layer does not slide evenly at some of the rows.
    fn uneven(&self, rows: &[SweepRow]) -> Option<String> {
        if !self.scene.friction_depends_on_speed() || self.scene.memory_follows() {
            return None;
        }
        let load = self.header.load;
        let at = |row: &SweepRow| even_sliding(&scene_at(&self.scene, &row.point, load), &row.point, load);
        EvenSliding::warning_among(&self.scene, rows.iter().map(at))
    }
}

/// The way over which contacts are renewed where the scene does not say it.
const DEFAULT_MEMORY: &str = "5e-5 m, or 1.2 times what even sliding takes at a point";

/// What is in the row of a point that has a result.
fn found_friction(row: &SweepRow, load: Load) -> Option<FoundFriction> {
    let friction = row.value(Quantity::Friction).filter(|_| row.is_result())?;
    let area = row.value(Quantity::RealArea).or(row.value(Quantity::ContactRatio));
    let rise = row.value(Quantity::FlashMean).map(|flash| flash + row.value(Quantity::SurfaceRise).unwrap_or(0.0));
    Some(FoundFriction { place: at(&row.point, load), friction, area, rise })
}

/// The points over which a scene is swept, and what their loads are: states of sliding, and no more of them than the
/// memory holds rows.
fn grid(options: &SweepOptions, scene: &Scene) -> Result<(Load, SweepGrid), Error> {
    /// Of a row.
    const BYTES: u64 = 1024;
    let speeds = options.speeds.as_ref().map_or(&[][..], |values| &values.0);
    check_possible("speeds", "m/s", speeds)?;
    let (load, loads) = match (&options.pressures, &options.forces) {
        (Some(pressures), None) => {
            check_possible("pressures", "Pa", &pressures.0)?;
            (Load::Pressure { area: scene.layer.area().ok_or_else(no_area)? }, &pressures.0)
        }
        (None, Some(forces)) => {
            check_possible("forces", "N", &forces.0)?;
            (Load::Force, &forces.0)
        }
        _ => return Err(Error::value("expected `pressures` or `forces`, the loads to sweep over")),
    };
    let temperatures = temperatures(options.temperatures.as_ref().map(|values| &values.0[..]), scene)?;
    let grid = SweepGrid { speeds: speeds.to_vec(), loads: loads.clone(), temperatures };
    let bytes = (grid.count() as u64).saturating_mul(BYTES);
    check_memory(bytes, || format!("{} points of the sweep", grid.count()))?;
    Ok((load, grid))
}

/// The `damping` of an element or a patch that loses as the compound does at 10 Hz, where a body of some 100 kg swings on a
/// tread.
fn suggested_damping(material: &Material) -> Option<String> {
    const HERTZ: f64 = 10.0;
    let omega = 2.0 * PI * HERTZ;
    let (storage, loss) = material.complex_modulus(omega);
    let seconds = loss / (storage * omega);
    let temperature = material.wlf.map_or(String::new(), |wlf| format!(" and {} K", wlf.temperature));
    (seconds > 0.0).then(|| format!("{} s is E''/(ω E') of the compound at {HERTZ} Hz{temperature}", short(seconds, 2)))
}

/// The header with what the table rests on, for those who use it.
fn rests_on(keys: Header, scene: &Scene, convergence: Option<String>) -> Header {
    keys.with_some("foundation", scene.layer.foundation.map(|kind| kind.word()))
        .with_some("fine", scene.fine.as_ref().map(FineRoughness::describe))
        .with_some("convergence", convergence)
        .with_some("damping", scene.material.as_ref().and_then(suggested_damping))
        .with_some("held", scene.carrier.z.map(|body| format!("load, on a carrier of {} kg", body.mass)))
}

/// The warning where the largest of `loads` presses the rubber too hard.
fn hard_pressure(scene: &Scene, load: Load, loads: &[f64], layer_slides: bool) -> Option<String> {
    let largest = loads.iter().copied().fold(0.0, f64::max);
    let (name, pressure) = match load {
        Load::Pressure { .. } => ("the largest of `pressures`", largest),
        Load::Force => ("the largest of `forces` over the area", largest / scene.layer.area()?),
    };
    scene.hard_pressure(name, pressure, layer_slides)
}

/// Those asked for, or the scene's own; none where it has none.
fn temperatures(asked: Option<&[f64]>, scene: &Scene) -> Result<Vec<f64>, Error> {
    let Some(own) = scene.temperature() else {
        return match asked {
            Some(_) => Err(Error::scene(
                "`temperatures`: the scene has no material.wlf, so nothing in it depends on the temperature",
            )),
            None => Ok(Vec::new()),
        };
    };
    let values = asked.map_or_else(|| vec![own], <[f64]>::to_vec);
    for &temperature in &values {
        scene.with_temperature(temperature).check().context("`temperatures`")?;
    }
    Ok(values)
}
