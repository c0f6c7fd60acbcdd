//! New points of a sweep that is there as a table, by the method that it was swept with.

use asperity::element::{Load, OperatingPoint, Table};
use asperity::scene::Scene;

use super::error::SweepError;
use super::method::{Method, SlidingOptions};
use super::not_steady::NotSteady;
use super::point::{steady_sliding, steady_sliding_at};
use super::scenes::relevant;
use super::search::StopBounds;
use super::sliding::SteadySliding;
use super::solved::SolvedPoints;
use crate::steady::SteadySlide;

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
    pub fn of_table(scene: &Scene, table: &Table, temperatures: &[f64]) -> Result<Self, SweepError> {
        let Some(asked) = SlidingOptions::of_table(&table.basis) else { return Ok(Self::Layer) };
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
        Err(NotSteady::NoPressure(separation))
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
