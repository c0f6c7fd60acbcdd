//! Starting values that fill the bounds.

use asperity::math::SplitMix64;

/// `count` places in the unit cube of `dimensions`: along each axis one in every `count`th part (M. D. McKay, R. J.
/// Beckman, W. J. Conover, Technometrics 21, 1979, 239).
pub(super) fn latin_hypercube(count: usize, dimensions: usize, seed: u64) -> Vec<Vec<f64>> {
    let mut random = SplitMix64::new(seed);
    let mut places = vec![vec![0.0; dimensions]; count];
    for axis in 0..dimensions {
        let mut order: Vec<usize> = (0..count).collect();
        for last in (1..count).rev() {
            order.swap(last, (random.unit() * (last + 1) as f64) as usize);
        }
        for (place, part) in places.iter_mut().zip(order) {
            place[axis] = (part as f64 + random.unit()) / count as f64;
        }
    }
    places
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_part_of_every_axis_has_one_place() {
        let places = latin_hypercube(12, 5, 3);
        for axis in 0..5 {
            let mut parts: Vec<usize> = places.iter().map(|place| (12.0 * place[axis]) as usize).collect();
            parts.sort_unstable();
            assert_eq!(parts, (0..12).collect::<Vec<_>>());
        }
        assert_ne!(places, latin_hypercube(12, 5, 4));
    }
}
