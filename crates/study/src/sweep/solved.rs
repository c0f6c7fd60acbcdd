//! Points of a sweep by the solver of steady sliding, and new points of one that is there as a table, by the method that
//! it was swept with.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use asperity::element::{FrictionTable, Load, OperatingPoint, PointStatus, Quantity};
use asperity::scene::Scene;

use super::layer::relevant;
use super::options::{Gaps, Method, SlidingOptions, SweepMethod};
use super::point::{steady_sliding, steady_sliding_at};
use super::search::{NotSteady, SteadySliding, StopBounds};
use super::table::{SweepHeader, SweepRow};
use crate::Error;
use crate::decimals::short;
use crate::steady::{FlowGaps, SlidingRubber, SteadySlide, SteadySolver, SurfaceGrid};

/// The solver of the points of a sweep, on all threads.
#[derive(Debug)]
pub struct SolvedPoints {
    solvers: Arc<Solvers>,
    /// The way that rubber as warm as a point has slid, m.
    way: Option<f64>,
    /// The rubber at each temperature.
    rubbers: Vec<(Option<f64>, SlidingRubber)>,
    /// The area of the layer, m².
    area: f64,
    /// How a fluid passes the gaps, where that is asked for.
    gaps: Option<Gaps>,
}

/// Solvers for one surface.
#[derive(Debug)]
struct Solvers {
    surface: SurfaceGrid,
    /// Those that no thread uses now: what they find does not depend on what they found before.
    idle: Mutex<Vec<SteadySolver>>,
    /// How many of them are kept.
    most_idle: AtomicUsize,
    /// How many points they have solved for.
    solutions: AtomicUsize,
}

impl Solvers {
    fn new(surface: SurfaceGrid) -> Self {
        let (idle, most_idle, solutions) = (Mutex::new(Vec::new()), usize::MAX.into(), 0.into());
        Self { surface, idle, most_idle, solutions }
    }

    fn solve(&self, of: impl FnOnce(&mut SteadySolver) -> SteadySlide) -> SteadySlide {
        let idle = self.idle.lock().unwrap_or_else(PoisonError::into_inner).pop();
        let mut solver = idle.unwrap_or_else(|| SteadySolver::new(self.surface.clone()));
        let slide = of(&mut solver);
        self.solutions.fetch_add(1, Ordering::Relaxed);
        let mut idle = self.idle.lock().unwrap_or_else(PoisonError::into_inner);
        if idle.len() < self.most_idle.load(Ordering::Relaxed) {
            idle.push(solver);
        }
        slide
    }
}

/// Pressures alternate from point to point where E''/E' is beyond this at the shortest wave.
const ALTERNATES: f64 = 3.0;
/// With fewer points in contact friction and area are chance.
const FEW: f64 = 20.0;

impl SolvedPoints {
    pub(super) fn new(
        scene: &Scene,
        temperatures: &[f64],
        surface: SurfaceGrid,
        way: Option<f64>,
    ) -> Result<Self, Error> {
        let temperatures: Vec<Option<f64>> =
            if temperatures.is_empty() { vec![None] } else { temperatures.iter().copied().map(Some).collect() };
        let rubber =
            |temperature: Option<f64>| Some((temperature, SlidingRubber::new(&scene.with_temperature(temperature))?));
        let rubbers = temperatures.into_iter().map(rubber).collect::<Option<Vec<_>>>().ok_or_else(no_area)?;
        let area = scene.layer.area().ok_or_else(no_area)?;
        Ok(Self { solvers: Arc::new(Solvers::new(surface)), way, rubbers, area, gaps: None })
    }

    /// The same with rows that have how a fluid passes the gaps.
    pub(super) fn with_gaps(self, gaps: Option<Gaps>) -> Self {
        Self { gaps, ..self }
    }

    /// The row of a point.
    pub(super) fn row(&self, point: OperatingPoint, header: &SweepHeader) -> SweepRow {
        let pressure = self.pressure(&point, header.load);
        match self.slide(&point, pressure) {
            Ok(slide) => self.written(point, pressure, &slide),
            Err(problem) => SweepRow::new(point, PointStatus::new(Some(problem))),
        }
    }

    /// The surface.
    pub(super) fn surface(&self) -> &SurfaceGrid {
        &self.solvers.surface
    }

    /// Of many scenes: takes the solvers of another one with the same surface, or keeps none of its own, whose memory grows
    /// with the scenes.
    pub(super) fn share(&mut self, other: &Self) {
        if self.surface() == other.surface() {
            self.solvers = Arc::clone(&other.solvers);
        } else {
            self.solvers.most_idle.store(0, Ordering::Relaxed);
        }
    }

    /// How many points were solved for so far, those of scenes that share the solvers included.
    #[cfg(test)]
    pub(super) fn solutions(&self) -> usize {
        self.solvers.solutions.load(Ordering::Relaxed)
    }

    /// The area of the layer, m².
    pub(super) fn area(&self) -> f64 {
        self.area
    }

    /// Root mean square height of the surface, m.
    pub(super) fn rms_height(&self) -> f64 {
        self.surface().rms_height()
    }

    /// The mean pressure of a point, Pa.
    pub(super) fn pressure(&self, point: &OperatingPoint, load: Load) -> f64 {
        load.force(point.load) / self.area
    }

    /// Steady sliding at the speed and the temperature of a point under a pressure (Pa); its values may not be relied on.
    fn slide(&self, point: &OperatingPoint, pressure: f64) -> Result<SteadySlide, NotSteady> {
        let rubber = self.rubbers.iter().find(|(temperature, _)| *temperature == point.temperature);
        let (_, rubber) = rubber.ok_or_else(|| NotSteady("no such temperature".to_owned()))?;
        Ok(self.solvers.solve(|solver| solver.slide_over(rubber, point.speed, pressure, self.way)))
    }

    /// Steady sliding as [`slide`](Self::slide) finds it, if its values can be relied on.
    pub(super) fn steady(&self, point: &OperatingPoint, pressure: f64) -> Result<SteadySlide, NotSteady> {
        let slide = self.slide(point, pressure)?;
        slide.problem().map_or(Ok(slide), |problem| Err(problem.into()))
    }

    fn written(&self, point: OperatingPoint, pressure: f64, slide: &SteadySlide) -> SweepRow {
        let mut row = SweepRow::new(point, PointStatus::new(slide.problem()));
        if !slide.is_found() {
            return row;
        }
        let power = |friction: f64| friction * pressure * self.area * point.speed;
        let viscous = slide.viscous_share.map(|share| share * power(slide.profile_hysteresis).max(0.0));
        let values = [
            (Quantity::Friction, slide.friction().map(|friction| friction.max(0.0))),
            (Quantity::FrictionStandardError, Some(0.0)),
            (Quantity::Hysteresis, slide.hysteresis),
            (Quantity::FineHysteresis, slide.fine_hysteresis),
            (Quantity::Adhesion, slide.adhesion),
            (Quantity::MeanLoad, Some(point.load)),
            (Quantity::ContactRatio, Some(slide.area)),
            (Quantity::RealArea, slide.real_area),
            (Quantity::FlashMean, slide.flash_mean),
            (Quantity::SurfaceRise, slide.surface_rise),
            (Quantity::DamperPower, viscous),
            (Quantity::MaxwellPower, Some(power(slide.profile_hysteresis).max(0.0) - viscous.unwrap_or(0.0))),
            (Quantity::FrictionPower, slide.of_contacts().filter(|_| slide.has_friction).map(power)),
            (Quantity::Separation, Some(slide.contact.separation)),
            (Quantity::Stiffness, slide.tangential_stiffness.map(|stiffness| stiffness * self.area)),
        ];
        values.into_iter().for_each(|(quantity, value)| row.set(quantity, value));
        if let Some(gaps) = self.gaps {
            self.set_gaps(&mut row, gaps, &slide.contact.gaps);
        }
        row
    }

    /// Sets how a fluid passes: solved for on a map, else by the effective medium.
    fn set_gaps(&self, row: &mut SweepRow, asked: Gaps, gaps: &[f64]) {
        let surface = self.surface();
        let is_map = surface.size.ny > 1;
        let medium = (!is_map || asked == Gaps::Medium).then(|| FlowGaps::of_medium(gaps));
        let solved = is_map.then(|| FlowGaps::of_map(gaps, surface.size, surface.spacing()));
        let found = solved.or(medium);
        let beside = medium.filter(|_| is_map);
        let values = [
            (Quantity::LeakGap, found.map(|gaps| gaps.leak)),
            (Quantity::DragGap, found.map(|gaps| gaps.drag)),
            (Quantity::LeakGapAcross, found.and_then(|gaps| gaps.leak_across)),
            (Quantity::LeakGapMedium, beside.map(|gaps| gaps.leak)),
            (Quantity::DragGapMedium, beside.map(|gaps| gaps.drag)),
        ];
        values.into_iter().for_each(|(quantity, value)| row.set(quantity, value));
    }

    /// The warning where loss is far above storage at the surface's shortest wave, 1.
    pub(super) fn alternating(&self, rows: &[SweepRow], header: &SweepHeader) -> Option<String> {
        let shortest = std::f64::consts::PI / self.surface().spacing()[0];
        let loss = |row: &SweepRow| {
            let (_, rubber) = self.rubbers.iter().find(|(temperature, _)| *temperature == row.point.temperature)?;
            Some(rubber.loss_factor(shortest * row.point.speed)).filter(|factor| *factor > ALTERNATES)
        };
        let found: Vec<(&SweepRow, f64)> = rows.iter().filter_map(|row| Some((row, loss(row)?))).collect();
        let (first, factor) = found.first()?;
        Some(format!(
            "E''/E' is beyond {ALTERNATES} at the shortest wave of the surface at {} of the points of the table, {} at {}: \
             pressures alternate from point to point there, and the contact ratio follows the spacing of the points",
            found.len(),
            short(*factor, 2),
            first.point.describe(header.load)
        ))
    }

    /// The warning where some of the rows have few points in contact.
    pub(super) fn few_points(&self, rows: &[SweepRow], header: &SweepHeader) -> Option<String> {
        let points = self.surface().size.points() as f64;
        let in_contact = |row: &SweepRow| row.value(Quantity::ContactRatio).map(|ratio| (ratio * points).round());
        let few: Vec<(&SweepRow, f64)> =
            rows.iter().filter_map(|row| Some((row, in_contact(row)?))).filter(|(_, count)| *count < FEW).collect();
        let (first, count) = few.first()?;
        Some(format!(
            "fewer than {FEW} points of the surface are in contact at {} of the points of the table, {count} at {}: give more \
             `points`",
            few.len(),
            first.point.describe(header.load)
        ))
    }
}

/// Why a scene has no pressures.
pub(super) fn no_area() -> Error {
    Error::scene(
        "`pressures`: the scene is in the direct form, which has no width and so no area: give `forces`, F_z of the whole \
         layer in N",
    )
}

/// What a table was swept with.
#[derive(Debug)]
pub enum Swept {
    /// The layer slid.
    Layer,
    /// Steady sliding was solved for.
    Solved {
        /// The solver of points.
        points: Box<SolvedPoints>,
        /// The separation at w = 0, m.
        rest_separation: f64,
    },
}

/// Steady sliding at a point.
#[derive(Clone, Copy, Debug)]
pub struct SweptPoint {
    /// Displacement of the carrier, m.
    pub w: f64,
    /// Mean F_z, N.
    pub force_z: f64,
    /// Mean force against the motion, N.
    pub drag: f64,
    /// Power lost, W.
    pub power: f64,
}

/// The pressure is found to where the separation is known to this part of the rms height, ...
const ACCURACY: f64 = 1e-6;
/// ... by no more solutions than this, each under a pressure at most so many times another.
const MOST_SOLUTIONS: usize = 20;
const LARGEST_CHANGE: f64 = 4.0;

impl Swept {
    /// That of the `table` of a `scene`, for points at `temperatures` (K).
    ///
    /// # Errors
    /// Where the scene does not go with the method of the table.
    pub fn of_table(scene: &Scene, table: &FrictionTable, temperatures: &[f64]) -> Result<Self, Error> {
        let asked = SlidingOptions::of_table(&table.header)?;
        if asked.method == Some(SweepMethod::Layer) {
            return Ok(Self::Layer);
        }
        let (Method::Steady(surface), _) = asked.choose(scene)? else { return Ok(Self::Layer) };
        let points = Box::new(SolvedPoints::new(&relevant(scene.clone()), temperatures, surface, asked.way)?);
        Ok(Self::Solved { points, rest_separation: table.rest_separation })
    }

    /// What is compared with, in a word.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Layer => "layer",
            Self::Solved { .. } => "solution",
        }
    }

    /// Steady sliding at a point, a layer known to `bounds`.
    ///
    /// # Errors
    /// Where there is none.
    pub fn sliding(
        &self,
        scene: &Scene,
        point: &OperatingPoint,
        load: Load,
        bounds: StopBounds,
    ) -> Result<SweptPoint, NotSteady> {
        let Self::Solved { points, rest_separation } = self else {
            return steady_sliding(scene, point, load, bounds).map(SweptPoint::of_layer);
        };
        let pressure = points.pressure(point, load);
        let slide = points.steady(point, pressure)?;
        Ok(SweptPoint::solved(&slide, pressure * points.area(), point.speed, *rest_separation))
    }

    /// Steady sliding with the carrier held at `w` (m), where the load is near that of the point.
    ///
    /// # Errors
    /// As for [`sliding`](Self::sliding).
    pub fn sliding_at(
        &self,
        scene: &Scene,
        point: &OperatingPoint,
        w: f64,
        load: Load,
        bounds: StopBounds,
    ) -> Result<SweptPoint, NotSteady> {
        let Self::Solved { points, rest_separation } = self else {
            return steady_sliding_at(scene, point, w, load, bounds).map(SweptPoint::of_layer);
        };
        let (separation, mut pressure) = (w + rest_separation, points.pressure(point, load));
        let accuracy = ACCURACY * points.rms_height();
        for _ in 0..MOST_SOLUTIONS {
            let slide = points.steady(point, pressure)?;
            let off = slide.contact.separation - separation;
            if off.abs() <= accuracy {
                return Ok(SweptPoint::solved(&slide, pressure * points.area(), point.speed, *rest_separation));
            }
            // Newton's step of ln p: the pressure falls about exponentially with the separation.
            let step = slide.normal_stiffness.unwrap_or_default() * off / pressure;
            pressure *= step.exp().clamp(1.0 / LARGEST_CHANGE, LARGEST_CHANGE);
        }
        Err(NotSteady(format!("no pressure found at the separation {separation:.4e} m")))
    }
}

impl SweptPoint {
    fn of_layer(layer: SteadySliding) -> Self {
        Self { w: layer.w, force_z: layer.force_z, drag: layer.drag(), power: layer.power() }
    }

    fn solved(slide: &SteadySlide, force_z: f64, speed: f64, rest_separation: f64) -> Self {
        let drag = slide.friction().unwrap_or_default().max(0.0) * force_z;
        Self { w: slide.contact.separation - rest_separation, force_z, drag, power: drag * speed }
    }
}
