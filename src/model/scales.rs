//! The stiffness and frequency scales of a layer: what tolerances, event limits and first steps are derived from.
//!
//! All start from the glassy stiffness c + Σ c_j of each kind of link ([`Model::glassy`]), with every dashpot at rest.

use super::{LinkKind, LinkLaw, MaxwellRow, Model};
use crate::scene::{Axis, ByLink, MaxwellElement, complex_stiffness};

impl Model {
    /// Stiffness of all links on one mass while the dashpots are at rest, N/m, lateral links counted twice: along x or
    /// along z, whichever is larger.
    pub fn mass_stiffness(&self) -> f64 {
        on_mass(self.glassy)
    }

    /// Stiffness of the links on one mass that are no [rods](Self::is_rod), N/m, with the dashpots at rest: it relates
    /// an error of a position to one of the forces.
    pub fn mass_stiffness_without_rods(&self) -> f64 {
        let largest = ROD_FREQUENCY * ROD_FREQUENCY * self.reference_stiffness();
        on_mass(self.glassy.map(|stiffness| if stiffness > largest { 0.0 } else { stiffness }))
    }

    /// Whether the links of `kind` work as rods: their springs are so much stiffer, or their dampers so much stronger,
    /// than the other springs that the other forces determine theirs. Positions and velocities within their tolerances
    /// do not.
    pub fn is_rod(&self, kind: LinkKind) -> bool {
        let reference = self.reference_stiffness();
        let (stiffness, damping) = (self.glassy[kind], self.links[kind].damping);
        reference > 0.0
            && (stiffness > ROD_FREQUENCY * ROD_FREQUENCY * reference
                || damping > ROD_FREQUENCY * (reference * self.mass).sqrt())
    }

    /// Long-term stiffness of the vertical links, or the stiffness of the softest other links where that is larger,
    /// N/m; `None` unless the vertical Maxwell elements are far stiffer than that. Where they are and have relaxed, a
    /// position within its tolerance does not determine the force that presses a mass on.
    pub fn long_term_stiffness(&self) -> Option<f64> {
        let elements: f64 = self.rows_of(LinkKind::Vertical).map(|row| row.stiffness).sum();
        let long_term = self.links[LinkKind::Vertical].stiffness.max(self.softest_other_link());
        (long_term > 0.0 && elements > ROD_FREQUENCY * ROD_FREQUENCY * long_term).then_some(long_term)
    }

    /// The largest stiffness by which the rounding of a position becomes a force, N/m. Vertical Maxwell elements far
    /// stiffer than the long-term stiffness do not count: each integrates its own elongation.
    pub fn rounding_stiffness(&self) -> f64 {
        let mut stiffness = self.glassy;
        if self.long_term_stiffness().is_some() {
            stiffness[LinkKind::Vertical] = self.links[LinkKind::Vertical].stiffness;
        }
        on_mass(stiffness)
    }

    /// c + Σ c_j of the links of `kind` as they are in this model, N/m: replaced Maxwell elements count as what they
    /// are replaced by.
    pub fn instantaneous_stiffness(&self, kind: LinkKind) -> f64 {
        self.links[kind].stiffness + self.rows_of(kind).map(|row| row.stiffness).sum::<f64>()
    }

    /// The stiffness that the others are compared with, N/m: that of the vertical links, whose elongation is
    /// prescribed, or of the softest others where these are stiffer.
    fn reference_stiffness(&self) -> f64 {
        self.glassy[LinkKind::Vertical].max(self.softest_other_link())
    }

    /// Of the links that are not vertical, N/m; 0 where there are none.
    fn softest_other_link(&self) -> f64 {
        let [_, others @ ..] = self.glassy.0;
        others.into_iter().filter(|&stiffness| stiffness > 0.0).reduce(f64::min).unwrap_or(0.0)
    }

    /// The highest frequency of one mass, rad/s; the largest damping rate, 1/s, where the layer has no springs, and 1
    /// where it has no dampers either.
    pub fn stiffest_frequency(&self) -> f64 {
        self.frequency_of(self.mass_stiffness())
    }

    /// The highest frequency of one mass without the springs of [rods](Self::is_rod), rad/s; without any, as
    /// [`stiffest_frequency`](Self::stiffest_frequency).
    pub fn frequency_without_rods(&self) -> f64 {
        self.frequency_of(self.mass_stiffness_without_rods())
    }

    /// The stiffness that makes [`frequency_without_rods`](Self::frequency_without_rods), N/m: of the links on one mass
    /// without rods, or what the damping rate stands for.
    pub fn effective_stiffness(&self) -> f64 {
        self.mass_stiffness_without_rods().max(self.mass * self.frequency_without_rods().powi(2))
    }

    /// The frequency, 1/s, of a mass on its horizontal link, and the damping of the link at that frequency, N s/m.
    ///
    /// m ω² = c + Σ c_j ω²τ_j²/(1 + ω²τ_j²), and the damping is d + Σ c_j τ_j/(1 + ω²τ_j²).
    pub fn horizontal_oscillation(&self) -> (f64, f64) {
        let kind = LinkKind::Horizontal;
        let link = &self.links[kind];
        // From above, where all dashpots are at rest, the frequency falls to the largest solution.
        let mut square = self.instantaneous_stiffness(kind) / self.mass;
        let mut damping = link.damping;
        for _ in 0..MAX_ITERATIONS {
            let (before, mut stiffness) = (square, link.stiffness);
            damping = link.damping;
            for row in self.rows_of(kind) {
                let tau = row.relaxation_time;
                let share = 1.0 / (1.0 + before * tau * tau);
                stiffness += row.stiffness * (1.0 - share);
                damping += row.stiffness * tau * share;
            }
            square = stiffness / self.mass;
            if square >= 0.99 * before {
                break;
            }
        }
        (square.sqrt(), damping)
    }

    /// |K*(iω)| of a link of `kind` at the frequency ω (rad/s), N/m: K* = c + iωd + Σ c_j iωτ_j/(1 + iωτ_j).
    pub fn dynamic_stiffness(&self, kind: LinkKind, frequency: f64) -> f64 {
        let LinkLaw { stiffness, damping } = self.links[kind];
        let element =
            |row: &MaxwellRow| MaxwellElement { stiffness: row.stiffness, relaxation_time: row.relaxation_time };
        let (storage, loss) = complex_stiffness(stiffness, damping, self.rows_of(kind).map(element), frequency);
        storage.hypot(loss)
    }

    /// The frequency of the body along `axis` on the glassy springs of the layer and on its drive, rad/s; the rate of
    /// its dampers, 1/s, where there are no springs, and that of a mass where there are no dampers either; 1 without a
    /// body.
    pub fn body_frequency(&self, axis: Axis) -> f64 {
        let Some(body) = &self.bodies[axis] else { return 1.0 };
        let (kind, masses) = (axis.link(), self.masses() as f64);
        let frequency = ((masses * self.glassy[kind] + body.stiffness) / body.mass).sqrt();
        let damping = (masses * self.links[kind].damping).max(body.damping) / body.mass;
        let own = [frequency, damping].into_iter().find(|&rate| rate > 0.0);
        own.unwrap_or_else(|| self.frequency_without_rods())
    }

    fn frequency_of(&self, stiffness: f64) -> f64 {
        let frequency = (stiffness / self.mass).sqrt();
        let damping = self.links.iter().map(|link| link.damping).fold(0.0, f64::max) / self.mass;
        [frequency, damping].into_iter().find(|&rate| rate > 0.0).unwrap_or(1.0)
    }
}

fn on_mass(ByLink([vertical, horizontal, lateral_x, lateral_z]): ByLink<f64>) -> f64 {
    (horizontal + 2.0 * lateral_x).max(vertical + 2.0 * lateral_z)
}

/// The frequency of a mass on a rod is at least this many times that on the other springs.
///
/// Recommended 30 to 1000. A layer of a material has (H/Δx)², some thousands at most, between the stiffness of its
/// lateral links and that of those to the carrier; its dampers are critical or weaker.
const ROD_FREQUENCY: f64 = 100.0;

/// Iterations for the frequency of the horizontal oscillation: each excludes the elements that have relaxed at the
/// frequency so far.
const MAX_ITERATIONS: usize = 30;
