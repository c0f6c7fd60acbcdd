//! Links: a spring, a damper and Maxwell elements in parallel.

use std::ops::Range;

use crate::scene::{Layer, Link, LinkKind};

/// The spring and the damper of one kind of link.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LinkLaw {
    /// Whether the scene has the link at all; an absent one has no forces, no energy and no work.
    pub present: bool,
    /// Stiffness c, N/m.
    pub stiffness: f64,
    /// Damping d, N s/m.
    pub damping: f64,
}

impl LinkLaw {
    pub(super) fn new(link: Option<&Link>) -> Self {
        link.map_or_else(Self::default, |link| Self {
            present: true,
            stiffness: link.stiffness.unwrap_or(0.0),
            damping: link.damping.unwrap_or(0.0),
        })
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

/// The rows of a layer, and their relaxation times, each once.
pub(super) fn maxwell_rows(layer: &Layer) -> (Vec<MaxwellRow>, Vec<f64>) {
    let (mut rows, mut times) = (Vec::new(), Vec::new());
    let mut start = 0;
    for kind in LinkKind::ALL {
        for element in layer.link(kind).iter().flat_map(|link| &link.maxwell) {
            let end = start + kind.count(layer.masses);
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
