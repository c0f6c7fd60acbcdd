//! Links: a spring, a damper and Maxwell elements in parallel.

use std::ops::Range;

use super::reduction::{Reduction, Replacement};
use crate::scene::{Initial, Link, LinkKind, Scene};

/// The spring and the damper of one kind of link.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LinkLaw {
    /// Whether the scene has the link at all; an absent one has no forces, no energy and no work.
    pub present: bool,
    /// Stiffness c, N/m, with that of the Maxwell elements replaced by springs.
    pub stiffness: f64,
    /// Damping d, N s/m, with that of the Maxwell elements replaced by dampers.
    pub damping: f64,
    /// Of the stiffness the part whose springs hang on dashpots that stand still where they stood at the start, N/m.
    pub frozen: f64,
}

impl LinkLaw {
    pub(super) fn new(scene: &Scene, kind: LinkKind, reduction: Option<&Reduction>) -> Self {
        let Some(link) = scene.link(kind) else { return Self::default() };
        let mut law = Self {
            present: true,
            stiffness: link.stiffness.unwrap_or(0.0),
            damping: link.damping.unwrap_or(0.0),
            frozen: 0.0,
        };
        // Along x every link is at rest at the start; undeformed, every dashpot.
        let stands = scene.layer.initial == Initial::Relaxed && !kind.is_along_x();
        let replaced = reduction.map_or(&[][..], |reduction| &reduction.replaced);
        for one in replaced.iter().filter(|one| one.kind == kind) {
            match one.by {
                Replacement::Spring => law.stiffness += one.element.stiffness,
                Replacement::Damper => law.damping += one.element.stiffness * one.element.relaxation_time,
            }
            if one.by == Replacement::Spring && stands {
                law.frozen += one.element.stiffness;
            }
        }
        law
    }
}

/// One Maxwell element of every link of a kind: its constants, and where the elongations a_j = e - y_j of its springs
/// stand in [`State::maxwell`](super::State::maxwell).
#[derive(Clone, Debug, PartialEq)]
pub struct MaxwellRow {
    /// The kind of link.
    pub kind: LinkKind,
    /// Stiffness c_j, N/m.
    pub stiffness: f64,
    /// Relaxation time τ_j, s.
    pub relaxation_time: f64,
    /// Where that stands in [`Model::relaxation_times`](super::Model::relaxation_times).
    pub time_index: usize,
    /// The elements of the row, link by link.
    pub range: Range<usize>,
}

/// c + Σ c_j, N/m.
pub(super) fn glassy_stiffness(link: &Link) -> f64 {
    let maxwell: f64 = link.maxwell.iter().map(|element| element.stiffness).sum();
    link.stiffness.unwrap_or(0.0) + maxwell
}

/// The rows of the elements that stay, and their relaxation times, each once.
pub(super) fn maxwell_rows(scene: &Scene, reduction: Option<&Reduction>) -> (Vec<MaxwellRow>, Vec<f64>) {
    let stays = |kind: LinkKind, index: usize| reduction.is_none_or(|all| all.replacement(kind, index).is_none());
    let (mut rows, mut times) = (Vec::new(), Vec::new());
    let mut start = 0;
    for kind in LinkKind::ALL {
        let elements = scene.link(kind).map_or_else(Vec::new, |link| link.maxwell);
        for (_, element) in elements.iter().enumerate().filter(|&(index, _)| stays(kind, index)) {
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
