//! The seams of a periodic surface: whether its ends meet as neighbours within it do.

use super::HeightMap;

/// A seam whose differences are, in the root mean square, more than so many times those inside is worth a word.
const ROUGH: f64 = 2.5;
/// A seam with a difference of more than so many times the largest inside is none of a periodic surface.
const STEEPEST: f64 = 10.0;
/// What makes a period of a surface whose ends do not meet.
const WAYS: &str =
    "asperity surface --mirror makes a period of a surface that ends; tilt = \"remove\" takes out the tilt of a map";
/// Differences that are rounding beside the heights: this part of what lies between the highest and the lowest.
const ROUNDING: f64 = 1e-9;

/// What the ends of a surface along one axis are, taken as neighbours.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Seam {
    axis: &'static str,
    /// The largest difference over the seam, and the largest inside: slopes of a profile, heights of a map.
    largest: [f64; 2],
}

/// Differences of neighbours: how many, their squares, the largest.
#[derive(Clone, Copy, Debug, Default)]
struct Differences {
    count: usize,
    squares: f64,
    largest: f64,
}

impl Differences {
    fn of(differences: impl Iterator<Item = f64>) -> Self {
        differences.fold(Self::default(), |sum, difference| Self {
            count: sum.count + 1,
            squares: sum.squares + difference * difference,
            largest: sum.largest.max(difference.abs()),
        })
    }

    fn rms(&self) -> f64 {
        (self.squares / self.count.max(1) as f64).sqrt()
    }
}

impl Seam {
    /// The seams of a map, along x and along y, that are rougher than what lies inside.
    pub(super) fn of_map(map: &HeightMap) -> Vec<Self> {
        let along_x = Self::of_lines("x", map);
        along_x.into_iter().chain(Self::of_lines("y", &map.transposed())).collect()
    }

    fn of_lines(axis: &'static str, map: &HeightMap) -> Option<Self> {
        let rounding = ROUNDING * super::peak_to_valley(map.heights());
        let lines = || (0..map.ny()).map(|j| map.line(j));
        let over = || lines().map(|line| line[0] - line[line.len() - 1]);
        let inside = || lines().flat_map(|line| line.windows(2).map(|pair| pair[1] - pair[0]));
        Self::found(axis, over, inside, rounding)
    }

    /// The seam of a profile whose last point is the first one again, where it is rougher than what lies inside: slopes,
    /// since its points need not be even.
    pub(super) fn of_profile(x: &[f64], z: &[f64]) -> Option<Self> {
        let slope = |i: usize| (z[i + 1] - z[i]) / (x[i + 1] - x[i]);
        let last = x.len().checked_sub(2)?;
        let rounding = ROUNDING * super::peak_to_valley(z) / (x[last + 1] - x[0]);
        Self::found("x", || std::iter::once(slope(last)), || (0..last).map(slope), rounding)
    }

    /// Differences as large are common within a surface of steps, whose edges may lie at its ends.
    fn found<S: Iterator<Item = f64>, I: Iterator<Item = f64>>(
        axis: &'static str,
        over: impl Fn() -> S,
        inside: impl Fn() -> I,
        rounding: f64,
    ) -> Option<Self> {
        let [seam, within] = [Differences::of(over()), Differences::of(inside())];
        let rms = seam.rms();
        let as_large = inside().filter(|difference| difference.abs() >= rms).count();
        let is_rough = rms > ROUGH * within.rms() && 2 * as_large < seam.count && seam.largest > rounding;
        (is_rough && within.count > 1).then_some(Self { axis, largest: [seam.largest, within.largest] })
    }

    /// Warnings of seams, unless one is too large for any surface that is periodic.
    ///
    /// # Errors
    /// What is expected in place of `periodic = true`.
    pub(super) fn check(seams: &[Self]) -> Result<Vec<String>, String> {
        match seams.iter().find(|seam| seam.is_too_large()) {
            Some(seam) => Err(format!("false, for {}: {WAYS}", seam.text())),
            None => Ok(seams.iter().map(|seam| format!("{}; {WAYS}", seam.text())).collect()),
        }
    }

    fn is_too_large(&self) -> bool {
        self.largest[0] > STEEPEST * self.largest[1]
    }

    /// What is wrong with it.
    fn text(&self) -> String {
        let [over, inside] = self.largest;
        let times = if inside > 0.0 { over / inside } else { f64::INFINITY };
        format!(
            "the ends do not meet along {}: taken as periodic, they differ by {times:.1} times the largest difference of \
             neighbours inside",
            self.axis
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn map(nx: usize, ny: usize, height: impl Fn(f64, f64) -> f64) -> HeightMap {
        HeightMap::new(nx, [1.0; 2], (0..nx * ny).map(|at| height((at % nx) as f64, (at / nx) as f64)).collect())
    }

    fn axes(map: &HeightMap) -> Vec<(&'static str, bool)> {
        Seam::of_map(map).iter().map(|seam| (seam.axis, seam.is_too_large())).collect()
    }

    /// Whole waves meet, also where the seam lies at the steepest place, and so do grooves whose edges are there.
    #[test]
    fn ends_of_whole_waves_and_of_steps_meet() {
        let wave = |phase: f64| std::f64::consts::TAU * phase;
        assert_eq!(axes(&map(32, 16, |x, y| wave(x / 32.0).sin() + wave(y / 8.0 + 0.1).sin())), []);
        assert_eq!(axes(&map(32, 16, |x, _| if x < 12.0 { 0.0 } else { 1.0 })), []);
        assert_eq!(axes(&map(32, 16, |_, _| 3.0)), []);
    }

    #[test]
    fn ends_of_a_cut_out_and_of_a_tilt_do_not_meet() {
        let wave = |phase: f64| std::f64::consts::TAU * phase;
        let cut = |x: f64, y: f64| wave(x / 64.0).cos() * wave(y / 16.0).cos();
        assert_eq!(axes(&map(32, 16, cut)), [("x", true)]);
        assert_eq!(axes(&map(16, 32, |x, y| cut(y, x) + 0.1 * wave(x / 16.0 + 0.1).sin())), [("y", true)]);
        assert_eq!(axes(&map(8, 8, |x, y| 0.1 * x + wave(y / 8.0).sin())), [("x", false)]);
    }

    #[test]
    fn a_profile_is_judged_by_its_slopes() {
        let found = |x: &[f64], z: &[f64]| Seam::of_profile(x, z).map(|seam| seam.is_too_large());
        // A long last step is no jump; a ramp that falls back at once is.
        assert_eq!(found(&[0.0, 1.0, 2.0, 3.0, 13.0], &[0.0, 1.0, 2.0, 2.5, 0.0]), None);
        let x: Vec<f64> = (0..=20).map(f64::from).collect();
        let ramp: Vec<f64> = x.iter().map(|x| if *x < 20.0 { *x } else { 0.0 }).collect();
        assert_eq!((found(&x, &ramp), found(&x[..6], &[0.0, 1.0, 2.0, 3.0, 4.0, 0.0])), (Some(true), Some(false)));
    }
}
