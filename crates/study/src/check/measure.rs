//! How points are chosen, how well they are known, and how large their errors are.

/// Standard error of the layer's friction coefficient, relative to it.
pub(super) const ERROR: f64 = 0.01;
/// Distance over which elements slide, m: far more than they stick.
pub(super) const SLIDING_DISTANCE: f64 = 1.0;

/// `count` of `all`, evenly, or all of them where there are fewer.
pub(super) fn selected<T: Copy>(all: &[T], count: usize) -> Vec<T> {
    let count = count.min(all.len());
    (0..count).map(|i| all[(2 * i + 1) * all.len() / (2 * count)]).collect()
}

/// The largest and the root mean square of relative errors.
pub(super) fn deviation(name: &str, errors: impl ExactSizeIterator<Item = f64>) -> String {
    let (largest, root) = extent(errors);
    format!("{name}: off by at most {:.2} %, in root mean square {:.2} %", 100.0 * largest, 100.0 * root)
}

/// The largest magnitude and the root mean square.
pub(super) fn extent(errors: impl ExactSizeIterator<Item = f64>) -> (f64, f64) {
    let count = errors.len() as f64;
    let (largest, squares) =
        errors.fold((0.0_f64, 0.0), |(largest, sum), error| (largest.max(error.abs()), sum + error * error));
    (largest, (squares / count).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_are_selected_evenly_and_each_once() {
        let points: Vec<u32> = (0..10).collect();
        assert_eq!(selected(&points, 2), [2, 7]);
        assert_eq!(selected(&points, 99), points);
    }
}
