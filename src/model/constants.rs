//! What a model is made of: links, bodies of the carrier, the profile at a point.

use std::ops::Range;

use serde::{Deserialize, Serialize};

use super::reduction::{Reduction, Replacement};
use crate::math::Spline;
use crate::scene::{Axis, ByAxis, ByLink, Initial, Link, LinkKind, MaxwellElement, Scene};

/// The law of a link of one kind: a spring and a damper in parallel. Its Maxwell elements add their own forces
/// (`Model::element_force`).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LinkLaw {
    /// Stiffness c, N/m, that of the Maxwell elements replaced by springs included.
    pub stiffness: f64,
    /// Damping d, N s/m, that of the Maxwell elements replaced by dampers included.
    pub damping: f64,
}

impl LinkLaw {
    /// c e + d ė, N, for an elongation (m) and its rate (m/s).
    #[inline(always)]
    pub fn force(&self, elongation: f64, rate: f64) -> f64 {
        self.stiffness * elongation + self.damping * rate
    }

    /// The force by a velocity that lasts for the time `beta` (s), βc + d, N s/m.
    #[inline(always)]
    pub fn by_velocity(&self, beta: f64) -> f64 {
        beta * self.stiffness + self.damping
    }
}

/// The laws of the links of a scene, and the part of their stiffness that belongs to replaced Maxwell elements whose
/// dashpots are frozen at the elongation of the start, N/m.
pub(super) fn link_laws(scene: &Scene, reduction: Option<&Reduction>) -> (ByLink<LinkLaw>, ByLink<f64>) {
    let mut frozen = ByLink::default();
    let mut laws = ByLink::from_fn(|kind| {
        let link = scene.link(kind).unwrap_or_default();
        let (stiffness, damping) = (link.stiffness.unwrap_or(0.0), link.damping.unwrap_or(0.0));
        LinkLaw { stiffness, damping }
    });
    for one in reduction.map_or(&[][..], |reduction| &reduction.replaced) {
        let (law, MaxwellElement { stiffness, relaxation_time }) = (&mut laws[one.kind], one.element);
        // At the start the links along x are not elongated, and in an undeformed layer no dashpot is.
        let elongated = scene.layer.initial == Initial::Relaxed && one.kind.axis() == Axis::Z;
        match one.by {
            Replacement::Damper => law.damping += stiffness * relaxation_time,
            Replacement::Spring => {
                law.stiffness += stiffness;
                frozen[one.kind] += if elongated { stiffness } else { 0.0 };
            }
        }
    }
    (laws, frozen)
}

/// One Maxwell element of every link of a kind: its constants, and the indices of the elongations a_j = e - y_j of its
/// springs in `State::maxwell`.
#[derive(Clone, Debug, PartialEq)]
pub struct MaxwellRow {
    /// The kind of link.
    pub kind: LinkKind,
    /// Stiffness c_j, N/m.
    pub stiffness: f64,
    /// Relaxation time τ_j, s.
    pub relaxation_time: f64,
    /// Its index in `Model::relaxation_times`.
    pub time_index: usize,
    /// Indices in `State::maxwell`, link by link.
    pub range: Range<usize>,
}

impl MaxwellRow {
    /// What is left in the spring of an element of a `way` (m) that its dashpot has `time` (s) to follow: τ/(τ +
    /// `time`) of it, m.
    pub fn left_of(&self, way: f64, time: f64) -> f64 {
        way * self.relaxation_time / (self.relaxation_time + time)
    }
}

/// The rows of the elements that are not replaced, and their relaxation times, each once.
pub(super) fn maxwell_rows(scene: &Scene, reduction: Option<&Reduction>) -> (Vec<MaxwellRow>, Vec<f64>) {
    let kept = |kind: LinkKind, index: usize| reduction.is_none_or(|all| all.replacement(kind, index).is_none());
    let (mut rows, mut times) = (Vec::new(), Vec::new());
    let mut start = 0;
    for kind in LinkKind::ALL {
        let elements = scene.link(kind).map_or_else(Vec::new, |link| link.maxwell);
        for (_, element) in elements.iter().enumerate().filter(|&(index, _)| kept(kind, index)) {
            let end = start + kind.count(scene.layer.masses);
            let tau = element.relaxation_time;
            let time_index = times.iter().position(|&known| known == tau).unwrap_or_else(|| {
                times.push(tau);
                times.len() - 1
            });
            rows.push(MaxwellRow {
                kind,
                stiffness: element.stiffness,
                relaxation_time: tau,
                time_index,
                range: start..end,
            });
            start = end;
        }
    }
    (rows, times)
}

/// c + Σ c_j, N/m.
pub(super) fn glassy(link: &Link) -> f64 {
    let maxwell: f64 = link.maxwell.iter().map(|element| element.stiffness).sum();
    link.stiffness.unwrap_or(0.0) + maxwell
}

/// The carrier as a body along one axis: what does not change through a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DrivenBody {
    /// Mass M, kg.
    pub mass: f64,
    /// Stiffness K of the spring to the drive, N/m.
    pub stiffness: f64,
    /// Damping D of the damper to the drive, N s/m.
    pub damping: f64,
    /// Constant part of the tangential force P or of the load N, N.
    pub force: f64,
}

impl DrivenBody {
    /// The bodies of `scene` along x and z.
    pub(super) fn along_axes(scene: &Scene) -> ByAxis<Option<Self>> {
        ByAxis::from_fn(|axis| {
            let body = scene.carrier[axis].as_ref()?;
            let force = match axis {
                Axis::X => body.pull,
                Axis::Z => body.load,
            };
            let or_zero = |value: Option<f64>| value.unwrap_or(0.0);
            let (stiffness, damping) = (or_zero(body.stiffness), or_zero(body.damping));
            Some(Self { mass: body.mass, stiffness, damping, force: or_zero(force) })
        })
    }
}

/// The profile at one position.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SurfacePoint {
    /// z_r, m.
    pub height: f64,
    /// s = z_r', 1.
    pub slope: f64,
    /// κ = z_r'', 1/m.
    pub curvature: f64,
    /// z_r''', 1/m²: constant between two data points.
    pub third: f64,
}

impl SurfacePoint {
    /// The `profile` at the position `x`, m.
    #[inline(always)]
    pub fn on(profile: &Spline, x: f64) -> Self {
        let (height, slope, curvature, third) = profile.evaluate(x);
        Self { height, slope, curvature, third }
    }
}

impl From<[f64; 4]> for SurfacePoint {
    #[inline(always)]
    fn from([height, slope, curvature, third]: [f64; 4]) -> Self {
        Self { height, slope, curvature, third }
    }
}

impl From<SurfacePoint> for [f64; 4] {
    #[inline(always)]
    fn from(point: SurfacePoint) -> Self {
        [point.height, point.slope, point.curvature, point.third]
    }
}
