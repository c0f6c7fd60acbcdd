//! Periodic lines at more or fewer points, by their waves.

use realfft::RealFftPlanner;
use realfft::num_complex::Complex;

/// Lines of `from` even points over a period at `to` points: waves are added that are 0, or the shortest are left out.
///
/// The wave of two points stands for a pair of opposite ones, of half its size each.
pub(super) fn lines(values: &[f64], from: usize, to: usize) -> Vec<f64> {
    if from == to {
        return values.to_vec();
    }
    let mut planner = RealFftPlanner::new();
    let (forward, backward) = (planner.plan_fft_forward(from), planner.plan_fft_inverse(to));
    let mut spectrum = vec![Complex::from(0.0); from.max(to) / 2 + 1];
    let (mut line, mut resampled) = (vec![0.0; from], vec![0.0; values.len() / from * to]);
    let shortest = from.min(to);
    for (values, resampled) in values.chunks_exact(from).zip(resampled.chunks_exact_mut(to)) {
        line.copy_from_slice(values);
        spectrum.fill(Complex::from(0.0));
        // The lengths are those of the plans.
        let _ = forward.process(&mut line, &mut spectrum[..from / 2 + 1]);
        spectrum[shortest / 2 + 1..].fill(Complex::from(0.0));
        if shortest.is_multiple_of(2) {
            let wave = &mut spectrum[shortest / 2];
            *wave = Complex::from(wave.re * if to > from { 0.5 } else { 2.0 });
        }
        let _ = backward.process(&mut spectrum[..to / 2 + 1], resampled);
        resampled.iter_mut().for_each(|value| *value /= from as f64);
    }
    resampled
}

/// Lines of `nx` values as lines of the others.
pub(super) fn transposed(values: &[f64], nx: usize) -> Vec<f64> {
    (0..nx).flat_map(|i| values.iter().skip(i).step_by(nx).copied()).collect()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    /// Waves that both grids hold are the same function at other places, of even and odd numbers of points; a shorter one
    /// is left out, and the one of two points is a cosine.
    #[test]
    fn waves_stay_where_they_are() {
        let line = |count: usize, shortest: f64| -> Vec<f64> {
            let phase = |i: usize, m: f64| TAU * m * i as f64 / count as f64;
            (0..count).map(|i| 0.3 + (phase(i, 2.0) + 0.4).cos() + shortest * phase(i, 6.0).cos()).collect()
        };
        for (from, to, before, after) in
            [(12, 30, 0.7, 0.7), (13, 15, 0.7, 0.7), (30, 12, 0.7, 0.7), (30, 11, 0.7, 0.0), (14, 14, 0.7, 0.7)]
        {
            let found = lines(&line(from, before).repeat(2), from, to);
            for (found, exact) in found.iter().zip(line(to, after).repeat(2)) {
                // Roundings of a sum of some ten terms.
                assert!((found - exact).abs() < 1e-14, "{from} to {to}: {found} for {exact}");
            }
        }
    }
}
