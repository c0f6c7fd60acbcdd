//! Wrenches of a dragged face, and the differences of two series of them.

use super::measure;
use crate::decimals::{decimal, rounded};

/// What is compared, and its unit; without force.y, which is 0 along x.
pub const COMPONENTS: [(&str, &str); 5] =
    [("force.x", "N"), ("force.z", "N"), ("moment.x", "N m"), ("moment.y", "N m"), ("moment.z", "N m")];
/// Share of force.z and of its longest arm below which a component is nothing but rounding.
const NOTHING: f64 = 1e-9;

/// The values of [`COMPONENTS`].
pub type Wrench = [f64; COMPONENTS.len()];

/// The wrench of forces (N) at their arms (m), and the sums of their magnitudes: moments may cancel.
pub(super) fn wrench(forces: impl IntoIterator<Item = ([f64; 3], [f64; 3])>) -> (Wrench, Wrench) {
    let (mut sum, mut size) = (Wrench::default(), Wrench::default());
    for ([x, y, z], [along, across, up]) in forces {
        let own = [along, up, y * up - z * across, z * along - x * up, x * across - y * along];
        sum.iter_mut().zip(own).for_each(|(sum, own)| *sum += own);
        size.iter_mut().zip(own).for_each(|(size, own)| *size += own.abs());
    }
    (sum, size)
}

/// Two series of wrenches, row by row.
#[derive(Clone, Debug, Default)]
pub struct WrenchSeries {
    /// What the other is measured by.
    pub reference: Vec<Wrench>,
    /// What is measured.
    pub other: Vec<Wrench>,
    /// What differences are shares of.
    scale: Wrench,
}

impl WrenchSeries {
    /// Differences are shares of the largest of `sizes`, by component; `lever` is the longest arm, m.
    pub(super) fn new(reference: Vec<Wrench>, other: Vec<Wrench>, sizes: &[Wrench], lever: f64) -> Self {
        let largest = |i: usize| sizes.iter().fold(f64::MIN_POSITIVE, |largest, row| largest.max(row[i].abs()));
        let least = |i: usize| NOTHING * largest(1) * if i < 2 { 1.0 } else { lever };
        Self { reference, other, scale: std::array::from_fn(|i| largest(i).max(least(i))) }
    }

    /// Magnitudes of the differences as shares.
    pub fn shares(&self) -> Vec<Wrench> {
        let share = |(a, b): (&Wrench, &Wrench)| std::array::from_fn(|i| (a[i] - b[i]).abs() / self.scale[i]);
        self.reference.iter().zip(&self.other).map(share).collect()
    }

    /// The largest of them, and their root mean squares.
    pub(super) fn extent(&self) -> (Wrench, Wrench) {
        let shares = self.shares();
        let over = |i: usize| measure::extent(shares.iter().map(|share| share[i]));
        (std::array::from_fn(|i| over(i).0), std::array::from_fn(|i| over(i).1))
    }
}

/// Shares in per cent.
pub(super) fn text(shares: Wrench) -> String {
    let one = |((name, _), share): (&(&str, &str), f64)| {
        format!("{name} {} %", decimal(rounded(100.0 * share, 2), 1e-3..1e5))
    };
    COMPONENTS.iter().zip(shares).map(one).collect::<Vec<_>>().join(", ")
}

/// The largest and the root mean square differences along a motion.
pub(super) fn extent(motion: &str, pair: &WrenchSeries) -> [String; 2] {
    let (largest, root) = pair.extent();
    [format!("{motion}, at most: {}", text(largest)), format!("  in root mean square: {}", text(root))]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_are_those_of_the_arms() {
        let forces = [([0.1, 0.2, -0.3], [-2.0, 0.0, 5.0]), ([0.0, -0.2, 0.0], [0.0, 1.0, 5.0])];
        // x: y F_z - z F_y, y: z F_x - x F_z, z: x F_y - y F_x.
        let expected = [-2.0, 10.0, 0.0, 0.6 - 0.5, 0.4];
        let (sum, size) = wrench(forces);
        assert!(sum.iter().zip(expected).all(|(found, expected)| (found - expected).abs() < 1e-15));
        let expected = [2.0, 10.0, 2.0, 0.1, 0.4];
        assert!(size.iter().zip(expected).all(|(found, expected)| (found - expected).abs() < 1e-15));
    }

    #[test]
    fn differences_are_shares_of_the_largest_value_and_rounding_is_none() {
        let reference = vec![[1.0, 10.0, 0.0, 4.0, 1e-15], [-2.0, 5.0, 0.0, 2.0, 0.0]];
        let other = vec![[1.1, 10.0, 0.0, 4.0, -1e-15], [-2.0, 4.0, 0.0, 3.0, 0.0]];
        let shares = WrenchSeries::new(reference.clone(), other, &reference, 0.1).shares();
        let expected = [[0.05, 0.0, 0.0, 0.0, 2e-6], [0.0, 0.1, 0.0, 0.25, 0.0]];
        for (found, expected) in shares.iter().flatten().zip(expected.iter().flatten()) {
            assert!((found - expected).abs() < 1e-12, "{shares:?}");
        }
    }
}
