//! Maxwell elements that act like a spring or like a damper on the time scales of a scene, and are replaced by one
//! (`solver.reduce`).
//!
//! **Long relaxation times.** For an element that starts with its dashpot at y(0), let b = e - y(0) and z = y - y(0): ż
//! = (b - z)/τ and z(0) = 0, so |z(t)| ≤ (1 - e^{-t/τ}) max|b|. Its force c_j (b - z) is that of a spring at rest at
//! y(0), and through a run of length T the two differ by at most
//!
//!   c_j (1 - e^{-T/τ}) max|b|     (≈ T/τ of the spring's own force where τ ≫ T)
//!
//! whatever the motion, impacts included. In a run longer than T the error may exceed the bound in proportion.
//!
//! **Short relaxation times.** Let δ = a - τ ė: δ̇ = -δ/τ - τ ë, so |δ(t)| ≤ |δ(0)| e^{-t/τ} + τ² max|ë|. The element's
//! force c_j a and that of a damper c_j τ_j differ by c_j δ: in motion up to the frequency ω, where |ë| ≤ ω² |e|, by at
//! most
//!
//!   c_j (ωτ)² max|e|
//!
//! A jump of ė, by an impact or a kink of the carrier's motion, excites all frequencies, and no bound of this kind
//! holds right after it: it adds c_j τ_j |Δė|, which decays as e^{-t/τ} and is an impulse of c_j τ_j² |Δė|. An element
//! that starts undeformed under a mass lifted onto the profile has the force c_j e, an impulse of c_j τ_j e that no
//! damper has; so in a layer that starts undeformed no element becomes a damper, nor in one under a body that is free
//! along x, whose speed is not known. The frequency ω is the largest of: the carrier's sines, 2πf; the passage along
//! the profile, v q, with the carrier's largest speed v and the profile's shortest waves, q = max|z_r'''|/max|z_r''|
//! (exact for a sine; at most half a wave between two data points); and the layer's own.
//!
//! **The layer's own frequency** is the largest ω at which the links balance a mass's inertia, m ω² = |K*(ω)|, with
//! K* = K*_carrier + 4 K*_lateral: neighbours move against each other, the chain's highest mode. It is not glassy:
//! elements with much shorter relaxation times have relaxed. The curvature of the profile under load is not counted.
//!
//! **Selection.** Link by link, smallest bounds first, as long as their sum is at most `reduce` times the link's
//! storage stiffness at the run's slowest frequency, K' = c + Σ_j c_j (τ_j/T)²/(1 + (τ_j/T)²). It is below |K*(ω)| for
//! every ω from 1/T on: the smallest force of the link for a unit of motion. So `reduce` bounds the error of each
//! link's force, for the same motion, as a share of that force. The effect on the layer's motion is not bounded, as for
//! any other parameter. The glassy stiffness would be a poor reference: that of rubber is a thousand times the
//! stiffness that the link has in the run.
//!
//! Without an `[[excitation]]` neither the run's length nor the carrier's motion is known: then no element counts as
//! long (T is infinite), and ω is the layer's own.

use std::f64::consts::{PI, TAU};

use super::{ByLink, LinkKind};
use crate::math::Spline;
use crate::scene::{Axis, Initial, MaxwellElement, Phase, Scene};

/// The elements that are replaced, and the quantities that this was decided by.
#[derive(Clone, Debug, PartialEq)]
pub struct Reduction {
    /// The elements replaced, link by link in the order of the scene.
    pub replaced: Vec<Replaced>,
    /// Length T of the run, s; infinite where the scene has no excitation.
    pub run: f64,
    /// The highest frequency considered ω, rad/s.
    pub frequency: f64,
    /// Storage stiffness of the links at 1/T, N/m: the bounds refer to it.
    pub stiffness: ByLink<f64>,
}

/// An element of all links of a kind that is replaced.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Replaced {
    /// The kind of link.
    pub kind: LinkKind,
    /// Which of its elements, from 0.
    pub index: usize,
    /// The element.
    pub element: MaxwellElement,
    /// Its replacement.
    pub by: Replacement,
    /// Bound of the error of its force over its link's elongation, N/m.
    pub bound: f64,
}

/// The replacement of a Maxwell element.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Replacement {
    /// A spring c_j: τ is long compared with the run.
    Spring,
    /// A damper c_j τ_j: τ is short compared with the shortest period.
    Damper,
}

impl Reduction {
    /// The elements of `scene` that `solver.reduce` replaces; `None` if it is 0.
    pub fn new(scene: &Scene) -> Option<Self> {
        (scene.solver.reduce > 0.0).then(|| Self::chosen(scene))
    }

    fn chosen(scene: &Scene) -> Self {
        let run = if scene.excitation.is_empty() { f64::INFINITY } else { scene.duration() };
        let frequencies = [carrier_frequency, passage_frequency, own_frequency, body_frequency].map(|of| of(scene));
        let frequency = frequencies.into_iter().fold(0.0, f64::max);
        let links = ByLink::from_fn(|kind| scene.link(kind).unwrap_or_default());
        let stiffness = ByLink::from_fn(|kind| links[kind].complex_stiffness(1.0 / run).0);
        let mut replaced = Vec::new();
        for kind in LinkKind::ALL {
            let allowed = scene.solver.reduce * stiffness[kind];
            let elements = &links[kind].maxwell;
            let relaxed = scene.layer.initial == Initial::Relaxed && scene.carrier.x.is_none();
            let candidates = elements.iter().enumerate().filter_map(|(index, &element)| {
                let (by, bound) = better(&element, run, relaxed.then_some(frequency))?;
                Some(Replaced { kind, index, element, by, bound })
            });
            replaced.extend(smallest(candidates.collect(), allowed));
        }
        Self { replaced, run, frequency, stiffness }
    }

    /// The replacement of element `index` (from 0) of a kind of link, if it is replaced.
    pub fn replacement(&self, kind: LinkKind, index: usize) -> Option<Replacement> {
        self.replaced.iter().find(|one| (one.kind, one.index) == (kind, index)).map(|one| one.by)
    }
}

/// The replacement with the smaller bound, and the bound, N/m: a spring if the run's length is known, a damper if a
/// highest `frequency` is given.
fn better(element: &MaxwellElement, run: f64, frequency: Option<f64>) -> Option<(Replacement, f64)> {
    let tau = element.relaxation_time;
    let spring = run.is_finite().then(|| (Replacement::Spring, element.stiffness * -(-run / tau).exp_m1()));
    let damper = frequency.map(|omega| (Replacement::Damper, element.stiffness * (omega * tau).powi(2)));
    spring.into_iter().chain(damper).min_by(|a, b| a.1.total_cmp(&b.1))
}

/// Those with the smallest bounds whose sum is at most `allowed`, in their original order.
fn smallest(mut candidates: Vec<Replaced>, allowed: f64) -> Vec<Replaced> {
    candidates.sort_by(|a, b| a.bound.total_cmp(&b.bound));
    let mut sum = 0.0;
    let fits = |one: &Replaced| {
        sum += one.bound;
        sum <= allowed
    };
    let mut chosen: Vec<Replaced> = candidates.into_iter().take_while(fits).collect();
    chosen.sort_by_key(|one| one.index);
    chosen
}

/// The highest frequency of the carrier's sines, rad/s.
fn carrier_frequency(scene: &Scene) -> f64 {
    let area = scene.layer.area();
    let of_phase = |phase: &Phase| [phase.u, phase.w, phase.load(area).change, phase.pull().change];
    let paths = scene.excitation.iter().flat_map(of_phase);
    paths.map(|path| TAU / path.period()).fold(0.0, f64::max)
}

/// The highest frequency of the passage of the profile's shortest waves under a mass that moves with the carrier,
/// rad/s.
fn passage_frequency(scene: &Scene) -> f64 {
    let speeds =
        scene.excitation.iter().map(|phase| phase.u.rate.abs() + phase.u.amplitude.abs() * TAU / phase.u.period());
    let speed = speeds.fold(0.0, f64::max);
    if speed > 0.0 { speed * shortest_wave(scene.surface.x(), scene.surface.spline()) } else { 0.0 }
}

/// q of the profile's shortest waves, rad/m.
fn shortest_wave(x: &[f64], profile: &Spline) -> f64 {
    let (mut curvature, mut third, mut interval) = (0.0_f64, 0.0_f64, f64::INFINITY);
    for pair in x.windows(2) {
        let (_, _, middle, change) = profile.evaluate(0.5 * (pair[0] + pair[1]));
        let half = 0.5 * (pair[1] - pair[0]);
        curvature = curvature.max(middle.abs() + half * change.abs());
        third = third.max(change.abs());
        interval = interval.min(2.0 * half);
    }
    if curvature > 0.0 { (third / curvature).min(PI / interval) } else { 0.0 }
}

/// The largest ω at which M ω² = |k K*(ω)| + K for a body on the layer and its drive, rad/s; 0 without a body.
fn body_frequency(scene: &Scene) -> f64 {
    let along = |axis: Axis| {
        let body = scene.carrier[axis].as_ref()?;
        let (link, masses) = (scene.link(axis.link()).unwrap_or_default(), scene.layer.masses as f64);
        let stiffness = |omega: f64| {
            let (storage, loss) = link.complex_stiffness(omega);
            masses * storage.hypot(loss) + body.stiffness.unwrap_or(0.0)
        };
        Some(largest_balance(body.mass, stiffness))
    };
    Axis::ALL.into_iter().filter_map(along).fold(0.0, f64::max)
}

/// The largest ω at which m ω² = |K*(ω)|, rad/s, from above.
fn own_frequency(scene: &Scene) -> f64 {
    let along = |to_carrier: LinkKind, lateral: LinkKind| {
        let links = [to_carrier, lateral].map(|kind| scene.link(kind).unwrap_or_default());
        let stiffness = |omega: f64| {
            let [carrier, lateral] = links.each_ref().map(|link| link.complex_stiffness(omega));
            (carrier.0 + 4.0 * lateral.0).hypot(carrier.1 + 4.0 * lateral.1)
        };
        largest_balance(scene.mass(), stiffness)
    };
    along(LinkKind::Horizontal, LinkKind::LateralX).max(along(LinkKind::Vertical, LinkKind::LateralZ))
}

/// The largest ω with m ω² = |K(ω)|, by ω ← √(|K(ω)|/m) from above: |K| grows with ω, but not faster than ω, so the
/// sequence decreases towards it.
fn largest_balance(mass: f64, stiffness: impl Fn(f64) -> f64) -> f64 {
    let balanced = |omega: f64| (stiffness(omega) / mass).sqrt();
    let mut omega = 1.0;
    while balanced(omega) > omega {
        omega *= 2.0;
    }
    for _ in 0..MAX_ITERATIONS {
        omega = balanced(omega);
    }
    omega
}

/// Each iteration at least halves the distance on a logarithmic scale: to 1e-12 from any start.
const MAX_ITERATIONS: usize = 60;
