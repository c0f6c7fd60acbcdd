//! What a layer does in steady sliding.

use asperity::element::{Quantity, TableHeader, TableRow};

use super::slide::BlockMeans;

/// The relative error of a friction coefficient smaller than this is taken relative to this.
pub const SMALL_FRICTION: f64 = 1e-2;
/// What a layer does in steady sliding.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SteadySliding {
    /// Displacement of the carrier, m.
    pub w: f64,
    /// Mean F_z, N.
    pub force_z: f64,
    /// Friction coefficient and its parts, 1.
    pub(super) friction: FrictionShares,
    /// Standard error of the friction coefficient, 1.
    pub friction_error: f64,
    /// Masses in contact over all masses, 1.
    pub contact_ratio: f64,
    /// Area that touches with the waves that the profile lacks over the layer's, 1; `None` without them.
    pub real_area: Option<f64>,
    /// Standard error of the contact ratio, 1.
    pub contact_error: f64,
    /// Power lost in dampers, Maxwell elements, friction and impacts, W; `None` for a channel that the scene cannot
    /// have.
    pub(super) channels: [Option<f64>; 4],
    /// Number of displacements w that were tried.
    pub(super) runs: u32,
    /// Time of the last run, s.
    pub(super) time: f64,
}

impl SteadySliding {
    /// Friction coefficient, 1.
    pub fn friction(&self) -> f64 {
        self.friction.whole
    }

    /// The part of the friction coefficient that is hysteresis, 1.
    pub fn hysteresis(&self) -> f64 {
        self.friction.hysteresis
    }

    /// The part of that by the waves that the profile lacks, 1.
    pub fn fine(&self) -> f64 {
        self.friction.fine.unwrap_or(0.0)
    }

    /// Mean force against the motion, N.
    pub fn drag(&self) -> f64 {
        self.friction.whole * self.force_z
    }

    /// Power lost, W.
    pub fn power(&self) -> f64 {
        self.channels.iter().flatten().sum()
    }

    /// Sets the values of a row of a table.
    pub(super) fn fill(&self, row: &mut TableRow, header: &TableHeader) {
        let values = [
            (Quantity::Friction, self.friction.whole),
            (Quantity::FrictionStandardError, self.friction_error),
            (Quantity::Hysteresis, self.friction.hysteresis),
            (Quantity::Adhesion, self.friction.adhesion),
            (Quantity::MeanLoad, header.load.at_force(self.force_z)),
            (Quantity::ContactRatio, self.contact_ratio),
            (Quantity::Separation, header.rest_separation + self.w),
            (Quantity::Displacement, self.w),
            (Quantity::Runs, f64::from(self.runs)),
            (Quantity::Time, self.time),
        ];
        values.into_iter().for_each(|(quantity, value)| row.set(quantity, Some(value)));
        row.set(Quantity::FineHysteresis, self.friction.fine);
        row.set(Quantity::RealArea, self.real_area);
        Quantity::CHANNELS.into_iter().zip(self.channels).for_each(|(channel, power)| row.set(channel, power));
    }
}

/// The friction coefficient and its parts, 1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct FrictionShares {
    whole: f64,
    hysteresis: f64,
    /// The part of the hysteresis by the waves that the profile lacks; `None` where it lacks none that rub.
    fine: Option<f64>,
    adhesion: f64,
}

impl FrictionShares {
    /// The whole is the carrier's work, which is exact; the parts are sampled and miss the impulses of impacts, so what
    /// they lack is divided in proportion to them.
    pub(super) fn new(means: &BlockMeans) -> Self {
        let [whole, hysteresis, adhesion] =
            [means.drag, means.hysteresis, means.adhesion].map(|force| force / means.load);
        let size = hysteresis.abs() + adhesion.abs();
        let share = if size > 0.0 { hysteresis.abs() / size } else { 1.0 };
        let sampled = hysteresis;
        let hysteresis = sampled + share * (whole - sampled - adhesion);
        let scale = if sampled == 0.0 { 1.0 } else { hysteresis / sampled };
        let fine = means.fine.map(|force| scale * force / means.load);
        Self { whole, hysteresis, fine, adhesion: whole - hysteresis }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The parts add up, and one that is absent stays absent.
    #[test]
    fn parts_add_up() {
        let of = |drag, hysteresis, adhesion| {
            FrictionShares::new(&BlockMeans { drag, load: 2.0, hysteresis, adhesion, ..BlockMeans::default() })
        };
        let parts = |whole, hysteresis, adhesion| FrictionShares { whole, hysteresis, fine: None, adhesion };
        assert_eq!(of(1.0, 0.0, 0.98), parts(0.5, 0.0, 0.5));
        assert_eq!(of(1.0, 0.98, 0.0), parts(0.5, 0.5, 0.0));
        let FrictionShares { whole, hysteresis, adhesion, .. } = of(1.0, 0.6, 0.2);
        assert!((hysteresis + adhesion - whole).abs() < 1e-15 && (hysteresis / adhesion - 3.0).abs() < 1e-12);
        // Of hysteresis that lacks a fifth in its sample the fine waves keep their share.
        let means = BlockMeans { drag: 1.0, load: 2.0, hysteresis: 0.8, fine: Some(0.4), ..BlockMeans::default() };
        let fine = FrictionShares::new(&means).fine.unwrap();
        assert!((fine - 0.25).abs() < 1e-15, "{fine}");
        // Nothing sampled: all that there is are slopes.
        assert_eq!(of(0.0, 0.0, 0.0), FrictionShares::default());
    }
}
