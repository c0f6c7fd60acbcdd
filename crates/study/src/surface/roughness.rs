//! What drawings say of a surface, by ISO 21920: Ra, Rq, Rz and Rmr of the waves between two Gaussian filters.

use asperity::math::bracketed_root;
use asperity::scene::{Surface, remove_tilt};
use serde::Serialize;

use crate::steady::{Convolution, GridSize};

/// Parameters of roughness of ISO 21920-2, in SI units: means over evaluation lengths, one behind the other along each line
/// of a map along x.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Roughness {
    /// Ra: the mean absolute height, m.
    pub ra: f64,
    /// Rq: the root mean square height, m.
    pub rq: f64,
    /// Rz: the mean of the heights from the lowest to the highest point of the five sections of an evaluation length, m.
    pub rz: f64,
    /// Rmr(p, dc), 1: the share of the length that is material at a depth of Rz/4 below the height at which the share is 5 %,
    /// as makers of seals take it.
    pub rmr: f64,
    /// That depth, m.
    pub rmr_depth: f64,
    /// λc, m: the Gaussian filter (ISO 16610-21) that halves this wave takes longer ones away.
    pub cut_off: f64,
    /// How that was chosen.
    pub chosen: CutOff,
    /// λs, m: the one that halves this wave takes shorter ones away.
    pub shortest: f64,
    /// Distance of the points, m: waves of less than two of them are not in it.
    pub spacing: f64,
    /// Five sections of λc, m; of a period that is shorter than one section, five periods.
    pub evaluation_length: f64,
    /// Of how many evaluation lengths these are the means.
    pub evaluations: usize,
}

/// Which cut-off of the default table of ISO 21920-3 was taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum CutOff {
    /// The one that the table has for this Rz.
    Default,
    /// The longest of which five sections fit; for this Rz the table has a longer one.
    LongestThatFits,
    /// The shortest of which a section has enough points; for this Rz the table has a shorter one.
    ShortestResolved,
}

/// A row of the default table of ISO 21920-3.
#[derive(Clone, Copy, Debug)]
struct Setting {
    /// The largest Rz, m.
    most: f64,
    /// λc, m.
    cut_off: f64,
    /// λs, m.
    shortest: f64,
}

const SETTINGS: [Setting; 5] = [
    Setting { most: 0.16e-6, cut_off: 0.08e-3, shortest: 2.5e-6 },
    Setting { most: 0.8e-6, cut_off: 0.25e-3, shortest: 2.5e-6 },
    Setting { most: 16e-6, cut_off: 0.8e-3, shortest: 2.5e-6 },
    Setting { most: 80e-6, cut_off: 2.5e-3, shortest: 8e-6 },
    Setting { most: f64::INFINITY, cut_off: 8e-3, shortest: 25e-6 },
];

/// Sections of an evaluation length.
const SECTIONS: usize = 5;
/// The fewest points of a section, for it to have a highest and a lowest.
const LEAST_POINTS: f64 = 8.0;
/// The share of material at the height from which the depth of Rmr counts, and that depth over Rz.
const REFERENCE: f64 = 0.05;
const DEPTH: f64 = 0.25;
/// A relative difference of lengths that counts as rounding.
const ROUNDING: f64 = 1e-9;

impl Roughness {
    /// Of a profile, or of all lines of the map that it is a line of; `None` where no cut-off of the table has five sections
    /// in it, with enough points each.
    pub(super) fn of(surface: &Surface) -> Option<Self> {
        let lines = Lines::of(surface);
        let mut longer: Option<Self> = None;
        for (row, setting) in SETTINGS.iter().enumerate().rev().filter(|(_, setting)| lines.hold(setting)) {
            let found = lines.roughness(setting);
            let is_above = row == 0 || found.rz > SETTINGS[row - 1].most;
            let is_below = found.rz <= setting.most;
            match longer {
                None if !is_below => return Some(Self { chosen: CutOff::LongestThatFits, ..found }),
                // Where two have their Rz, the shorter one is right (ISO 4288, 7.2).
                Some(right) if right.chosen == CutOff::Default => {
                    return Some(if is_above && is_below { found } else { right });
                }
                _ if is_above => longer = Some(found),
                _ => longer = Some(Self { chosen: CutOff::ShortestResolved, ..found }),
            }
        }
        longer
    }
}

/// Lines at even points, each closed to a period: of a natural one by its mirror image (ISO 16610-28), without its tilt.
struct Lines {
    /// Distance of the points, m.
    spacing: f64,
    /// Points of a line as it was given.
    points: usize,
    periodic: bool,
    /// Points of a period.
    period: usize,
    /// Heights of the periods, m.
    heights: Vec<f64>,
}

impl Lines {
    fn of(surface: &Surface) -> Self {
        let periodic = surface.is_periodic();
        if let Some(map) = surface.map() {
            return Self::new(map.spacing()[0], periodic, (0..map.ny()).map(|j| map.line(j).to_vec()));
        }
        let x = surface.x();
        let intervals = x.len() - 1;
        let (length, spline) = (x[intervals] - x[0], surface.spline());
        let height = |i: usize| spline.evaluate(x[0] + length * (i as f64 / intervals as f64)).0;
        let points = if periodic { intervals } else { x.len() };
        Self::new(length / intervals as f64, periodic, [(0..points).map(height).collect()].into_iter())
    }

    fn new(spacing: f64, periodic: bool, lines: impl Iterator<Item = Vec<f64>>) -> Self {
        let closed = |mut line: Vec<f64>| {
            if !periodic {
                let x: Vec<f64> = (0..line.len()).map(|i| spacing * i as f64).collect();
                remove_tilt(&x, &mut line);
                line.extend((1..x.len() - 1).rev().map(|i| line[i]).collect::<Vec<_>>());
            }
            line
        };
        let lines: Vec<Vec<f64>> = lines.map(closed).collect();
        let period = lines[0].len();
        let points = if periodic { period } else { period / 2 + 1 };
        Self { spacing, points, periodic, period, heights: lines.concat() }
    }

    /// Whether five sections fit, with enough points each. What is periodic goes on without end.
    fn hold(&self, setting: &Setting) -> bool {
        let length = self.spacing * (self.points - 1) as f64 * (1.0 + ROUNDING);
        let fits = self.periodic || SECTIONS as f64 * setting.cut_off <= length;
        fits && setting.cut_off * (1.0 + ROUNDING) >= LEAST_POINTS * self.spacing
    }

    fn roughness(&self, setting: &Setting) -> Roughness {
        // A period that is shorter than a section is the same in all of them.
        let section = (setting.cut_off / self.spacing).min(if self.periodic { self.points as f64 } else { f64::MAX });
        let evaluation = SECTIONS as f64 * section;
        // Where there is room, ends of half a cut-off are left out.
        let room = if self.periodic { self.points as f64 } else { (self.points - 1) as f64 - section };
        let of_line = ((room / evaluation + ROUNDING).floor() as usize).max(1);
        let middle = if self.periodic { 0.0 } else { 0.5 * ((self.points - 1) as f64 - of_line as f64 * evaluation) };
        let starts: Vec<f64> = (0..of_line).map(|i| middle + i as f64 * evaluation).collect();
        let mut sums = [0.0; 4];
        for line in self.filtered(setting).chunks_exact(self.period) {
            for values in starts.iter().map(|start| of_evaluation(line, *start, section)) {
                sums.iter_mut().zip(values).for_each(|(sum, value)| *sum += value);
            }
        }
        let evaluations = self.heights.len() / self.period * of_line;
        let [ra, rq, rz, rmr] = sums.map(|sum| sum / evaluations as f64);
        Roughness {
            ra,
            rq,
            rz,
            rmr,
            rmr_depth: DEPTH * rz,
            cut_off: setting.cut_off,
            chosen: CutOff::Default,
            shortest: setting.shortest,
            spacing: self.spacing,
            evaluation_length: evaluation * self.spacing,
            evaluations,
        }
    }

    /// The periods without waves that are longer than λc or shorter than λs.
    fn filtered(&self, setting: &Setting) -> Vec<f64> {
        let size = GridSize { nx: self.period, ny: 1 };
        let length = self.spacing * self.period as f64;
        let factor = |wave: usize| {
            let frequency = wave as f64 / length;
            let kept = kept(setting.shortest * frequency) * (1.0 - kept(setting.cut_off * frequency));
            kept / self.period as f64
        };
        let kernel: Vec<f64> = (0..size.columns()).map(factor).collect();
        let (mut convolution, mut heights) = (Convolution::new(size), self.heights.clone());
        heights.chunks_exact_mut(self.period).for_each(|line| convolution.apply(line, &kernel));
        heights
    }
}

/// What the Gaussian filter keeps of a wave, of so many to its cut-off: e^(-π (α u)²) with α = √(ln 2/π) = 0.4697
/// (ISO 16610-21).
fn kept(waves: f64) -> f64 {
    (-waves * waves).exp2()
}

/// Ra, Rq, Rz and Rmr over five sections of so many points of a period.
fn of_evaluation(period: &[f64], start: f64, section: f64) -> [f64; 4] {
    let bounds: Vec<usize> =
        (0..=SECTIONS).map(|i| (start + i as f64 * section - ROUNDING * section).ceil().max(0.0) as usize).collect();
    let heights: Vec<f64> = (bounds[0]..bounds[SECTIONS]).map(|i| period[i % period.len()]).collect();
    let mean = |value: &dyn Fn(f64) -> f64| heights.iter().map(|z| value(*z)).sum::<f64>() / heights.len() as f64;
    let (ra, rq) = (mean(&f64::abs), mean(&|z| z * z).sqrt());
    let within = |ends: &[usize]| {
        let [lowest, highest] = ends_of(&heights[ends[0] - bounds[0]..ends[1] - bounds[0]]);
        highest - lowest
    };
    let rz = bounds.windows(2).map(within).sum::<f64>() / SECTIONS as f64;
    [ra, rq, rz, material_ratio(&heights, material_height(&heights, REFERENCE) - DEPTH * rz)]
}

fn ends_of(heights: &[f64]) -> [f64; 2] {
    heights.iter().fold([f64::MAX, f64::MIN], |[low, high], z| [low.min(*z), high.max(*z)])
}

/// The share of the length at which straight lines between the heights are at this one or above.
fn material_ratio(heights: &[f64], at: f64) -> f64 {
    let above = |ends: &[f64]| {
        let (low, high) = (ends[0].min(ends[1]), ends[0].max(ends[1]));
        if low >= at { 1.0 } else { ((high - at) / (high - low)).max(0.0) }
    };
    heights.windows(2).map(above).sum::<f64>() / (heights.len() - 1) as f64
}

/// The height at which the share of material is this.
fn material_height(heights: &[f64], ratio: f64) -> f64 {
    let [lowest, highest] = ends_of(heights);
    bracketed_root(|at| material_ratio(heights, at) - ratio, (lowest, highest), 1e-9 * (highest - lowest))
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use asperity::scene::HeightMap;
    use std::f64::consts::PI;

    /// a sin(2πx/λ) at `points` to the wave, `waves` of them.
    fn sine(amplitude: f64, wavelength: f64, points: usize, waves: usize, periodic: bool) -> Surface {
        let place = |i: usize| i as f64 / points as f64;
        let x = (0..=points * waves).map(|i| wavelength * place(i)).collect();
        let z = (0..=points * waves).map(|i| amplitude * (2.0 * PI * (i % points) as f64 / points as f64).sin());
        Surface::new(x, z.collect(), periodic)
    }

    fn near(found: f64, exact: f64, tolerance: f64) {
        assert!((found / exact - 1.0).abs() < tolerance, "{found:e} for {exact:e}");
    }

    /// Ra = 2a/π, Rq = a/√2, Rz = 2a, and the share of material by the arc cosine.
    #[test]
    fn a_sine_well_below_the_cut_off_has_its_known_numbers() {
        let amplitude = 2e-6;
        for periodic in [true, false] {
            let found = Roughness::of(&sine(amplitude, 50e-6, 100, 100, periodic)).unwrap();
            assert_eq!((found.cut_off, found.chosen, found.evaluations), (0.8e-3, CutOff::Default, 1), "{periodic}");
            near(found.evaluation_length, 4e-3, 1e-12);
            // The filters keep 1 - 2^-256 and 2^-(1/400) of the wave; 100 points to it are summed to 1e-3 of a corner.
            let kept = 0.5_f64.powf(1.0 / 400.0);
            near(found.ra, kept * 2.0 * amplitude / PI, 5e-4);
            near(found.rq, kept * amplitude / 2_f64.sqrt(), 5e-4);
            near(found.rz, kept * 2.0 * amplitude, 5e-4);
            // 5 % of the length lie above a cos 0.05π, a quarter of 2a below which is a (cos 0.05π - ½).
            near(found.rmr, ((0.05 * PI).cos() - 0.5).acos() / PI, 1e-3);
            near(found.rmr_depth, 0.25 * found.rz, 1e-15);
        }
    }

    /// The wave of λc loses half, by the filter of α = 0.4697; half of a wave is material at its mean line.
    #[test]
    fn the_filter_halves_the_wave_of_the_cut_off() {
        near((2_f64.ln() / PI).sqrt(), 0.4697, 1e-4);
        let weight = |u: f64| (-PI * (0.4697_f64 * u).powi(2)).exp();
        [0.3, 1.0, 2.0].iter().for_each(|u| near(kept(*u), weight(*u), 1e-3));
        let lines = Lines::of(&sine(1e-6, 0.8e-3, 400, 10, true));
        let filtered = lines.filtered(&SETTINGS[2]);
        // λs keeps 2^-1e-5 of that wave; a point lies at the crest.
        near(ends_of(&filtered)[1], 0.5e-6, 1e-5);
        // Whole waves, of whose 4000 points the last lacks its neighbour.
        near(material_ratio(&filtered, 0.0), 0.5, 1e-3);
    }

    /// Waves of 0.1 mm of 40 µm take λc = 2.5 mm, five of which are 12.5 mm; shorter profiles take what fits.
    #[test]
    fn a_profile_too_short_for_the_default_takes_the_longest_that_fits() {
        let found = |waves| Roughness::of(&sine(20e-6, 1e-4, 20, waves, false));
        let chosen = |waves| found(waves).map(|found| (found.cut_off, found.chosen));
        assert_eq!(chosen(125), Some((2.5e-3, CutOff::Default)));
        assert_eq!(chosen(124), Some((0.8e-3, CutOff::LongestThatFits)));
        // 0.4 mm are the least.
        assert_eq!((chosen(4), chosen(3)), (Some((0.08e-3, CutOff::LongestThatFits)), None));
        // Three evaluation lengths of 12.5 mm, and half a cut-off at each end.
        assert_eq!(found(401).unwrap().evaluations, 3);
        // Of 20 nm λc is 0.08 mm, in which there is no point of those 0.1 mm apart; in 0.8 mm there are eight.
        let coarse = Roughness::of(&sine(2e-8, 1e-2, 100, 10, true)).unwrap();
        assert_eq!((coarse.cut_off, coarse.chosen), (0.8e-3, CutOff::ShortestResolved));
        assert_eq!(Roughness::of(&Surface::new(vec![0.0, 1.0], vec![0.0, 0.0], false)), None);
    }

    /// Lines along x with other heights: the mean. A short period is repeated without end.
    #[test]
    fn a_map_has_the_mean_of_its_lines() {
        let lines = [1e-6, 3e-6].map(|amplitude| sine(amplitude, 50e-6, 100, 2, true).z()[..200].to_vec());
        let map = HeightMap::new(200, [0.5e-6, 1e-5], lines.concat());
        let found = Roughness::of(&Surface::of_map(map, true)).unwrap();
        assert_eq!((found.cut_off, found.evaluations), (0.8e-3, 2));
        near(found.rz, 0.5_f64.powf(1.0 / 400.0) * 4e-6, 5e-4);
        near(found.rq, 0.5_f64.powf(1.0 / 400.0) * 2e-6 / 2_f64.sqrt(), 1e-12);
        near(found.evaluation_length, 5e-4, 1e-12);
    }

    /// A level line is material all through.
    #[test]
    fn a_level_profile_has_no_roughness() {
        let found = Roughness::of(&sine(0.0, 1e-4, 50, 50, false)).unwrap();
        assert_eq!((found.ra, found.rq, found.rz, found.rmr), (0.0, 0.0, 0.0, 1.0));
    }
}
