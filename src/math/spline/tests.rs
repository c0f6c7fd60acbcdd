#![allow(clippy::expect_used)]

use std::f64::consts::PI;

use nalgebra::{DMatrix, DVector};

use super::{BLOCK, Spline, floor};
use crate::in_tests::assert_within;

const UNEVEN: [f64; 9] = [-1.0, -0.97, -0.2, -0.19, 0.4, 1.3, 1.31, 1.7, 3.0];
const HEIGHTS: [f64; 9] = [0.3, 0.1, -0.4, -0.38, 0.9, 0.2, 0.25, -0.7, 0.3];

fn even(from: f64, to: f64, intervals: usize) -> Vec<f64> {
    (0..=intervals).map(|i| from + (to - from) * i as f64 / intervals as f64).collect()
}

fn both() -> [Spline; 2] {
    [Spline::natural(&UNEVEN, &HEIGHTS), Spline::periodic(&UNEVEN, &HEIGHTS)]
}

/// M_i from the dense equations, as an independent solution.
fn dense_curvatures(x: &[f64], z: &[f64], periodic: bool) -> Vec<f64> {
    let n = x.len();
    let (mut matrix, mut right) = (DMatrix::zeros(n, n), DVector::zeros(n));
    let mut equation = |row: usize, [a, b, c]: [usize; 3], h: [f64; 2], rise: [f64; 2]| {
        matrix[(row, a)] += h[0] / 6.0;
        matrix[(row, b)] += (h[0] + h[1]) / 3.0;
        matrix[(row, c)] += h[1] / 6.0;
        right[row] = rise[1] / h[1] - rise[0] / h[0];
    };
    let h = |i: usize| x[i + 1] - x[i];
    let rise = |i: usize| z[i + 1] - z[i];
    (1..n - 1).for_each(|i| equation(i, [i - 1, i, i + 1], [h(i - 1), h(i)], [rise(i - 1), rise(i)]));
    if periodic {
        equation(0, [n - 2, 0, 1], [h(n - 2), h(0)], [rise(n - 2), rise(0)]);
        matrix[(n - 1, 0)] = 1.0;
        matrix[(n - 1, n - 1)] = -1.0;
    } else {
        matrix[(0, 0)] = 1.0;
        matrix[(n - 1, n - 1)] = 1.0;
    }
    matrix.lu().solve(&right).expect("regular").iter().copied().collect()
}

#[test]
fn passes_through_its_points() {
    for spline in both() {
        for (&x, &z) in UNEVEN.iter().zip(&HEIGHTS) {
            assert_within(spline.evaluate(x).0, z, 1e-13);
        }
    }
}

#[test]
fn curvatures_agree_with_a_dense_solution() {
    for points in 3..=UNEVEN.len() {
        let x = &UNEVEN[..points];
        let mut z = HEIGHTS[..points].to_vec();
        z[points - 1] = z[0];
        for (spline, periodic) in [(Spline::natural(x, &z), false), (Spline::periodic(x, &z), true)] {
            let expected = dense_curvatures(x, &z, periodic);
            let scale = expected.iter().fold(1.0_f64, |most, value| most.max(value.abs()));
            for (&x, &curvature) in x.iter().zip(&expected) {
                assert_within(spline.evaluate(x).2, curvature, 1e-12 * scale);
            }
        }
    }
}

#[test]
fn is_twice_continuously_differentiable_at_the_points() {
    for spline in both() {
        for pair in spline.pieces.windows(2) {
            assert_joined(&spline, pair[0].evaluate(pair[0].end), pair[1].evaluate(pair[1].start));
        }
    }
}

fn assert_joined(spline: &Spline, left: (f64, f64, f64, f64), right: (f64, f64, f64, f64)) {
    let bounds = spline.bounds();
    assert_within(left.0, right.0, 1e-13);
    assert_within(left.1, right.1, 1e-13 * bounds.slope_max_abs);
    assert_within(left.2, right.2, 1e-13 * bounds.curvature_max_abs);
}

#[test]
fn is_twice_continuously_differentiable_at_the_periodic_seam() {
    let spline = Spline::periodic(&UNEVEN, &HEIGHTS);
    let (first, last) = (spline.pieces[0], spline.pieces[spline.pieces.len() - 1]);
    assert_joined(&spline, last.evaluate(last.end), first.evaluate(first.start));
}

#[test]
fn derivatives_agree_with_differences() {
    let step = 1e-5;
    for spline in both() {
        for x in [-3.3, -0.5, 0.1, 1.0, 2.2, 7.7] {
            let (before, here, after) = (spline.evaluate(x - step), spline.evaluate(x), spline.evaluate(x + step));
            assert_within((after.0 - before.0) / (2.0 * step), here.1, 1e-7);
            assert_within((after.1 - before.1) / (2.0 * step), here.2, 1e-7);
            assert_within((after.2 - before.2) / (2.0 * step), here.3, 1e-7);
        }
    }
}

#[test]
fn natural_ends_are_straight_and_go_on_along_their_tangents() {
    let spline = Spline::natural(&UNEVEN, &HEIGHTS);
    for (end, outside) in [(-1.0, -4.0), (3.0, 8.0)] {
        let (z, slope, curvature, _) = spline.evaluate(end);
        assert_within(curvature, 0.0, 1e-12);
        assert_eq!(spline.evaluate(outside), (z + slope * (outside - end), slope, 0.0, 0.0));
    }
    assert_eq!((spline.period(), spline.reduce(8.0)), (None, 8.0));
}

#[test]
fn reproduces_a_straight_line() {
    for points in [2, 3, 4, 10] {
        let x = &UNEVEN[..points.min(9)];
        let z: Vec<f64> = x.iter().map(|x| 0.5 - 0.25 * x).collect();
        let spline = Spline::natural(x, &z);
        for place in [-5.0, -0.99, -0.6, 0.5, 2.0, 11.0] {
            let (z, slope, curvature, third) = spline.evaluate(place);
            assert_within(z, 0.5 - 0.25 * place, 1e-13);
            assert_within(slope, -0.25, 1e-13);
            assert_within(curvature, 0.0, 1e-11);
            assert_within(third, 0.0, 1e-8);
        }
    }
}

#[test]
fn two_points_make_a_line_or_a_level() {
    assert_eq!(Spline::natural(&[1.0, 2.0], &[0.0, 3.0]).evaluate(3.0), (6.0, 3.0, 0.0, 0.0));
    assert_eq!(Spline::periodic(&[1.0, 2.0], &[3.0, 3.0]).evaluate(-7.3), (3.0, 0.0, 0.0, 0.0));
}

fn largest_error_on_a_sine(intervals: usize) -> f64 {
    let x = even(0.0, 1.0, intervals);
    let mut z: Vec<f64> = x.iter().map(|x| (2.0 * PI * x).sin()).collect();
    z[intervals] = z[0];
    let spline = Spline::periodic(&x, &z);
    even(0.0, 1.0, 1000).iter().map(|&x| (spline.evaluate(x).0 - (2.0 * PI * x).sin()).abs()).fold(0.0, f64::max)
}

#[test]
fn heights_converge_with_order_four() {
    for intervals in [16, 32, 64] {
        let order = (largest_error_on_a_sine(intervals) / largest_error_on_a_sine(2 * intervals)).log2();
        assert!((order - 4.0).abs() < 0.1, "order {order} from {intervals} intervals");
    }
}

#[test]
fn repeats_far_away() {
    let spline = Spline::periodic(&UNEVEN, &HEIGHTS);
    assert_eq!(spline.period(), Some(4.0));
    for x in [-0.98, 0.0, 1.305, 2.5] {
        for periods in [-1e9_f64, -3.0, -1.0, 1.0, 2.0, 1e6, 1e9] {
            assert_within(spline.reduce(x + 4.0 * periods), x, 1e-15 * (4.0 * periods).abs().max(10.0));
            assert_within(spline.evaluate(x + 4.0 * periods).0, spline.evaluate(x).0, 1e-14 * periods.abs());
        }
        assert_eq!(spline.reduce(x), x);
    }
}

#[test]
fn a_place_is_reduced_into_the_period_even_at_its_ends() {
    let spline = Spline::periodic(&[0.1, 0.2, 0.4], &[0.0, 1.0, 0.0]);
    for count in -1000..1000 {
        for x in [0.1 + 0.3 * f64::from(count), (0.1 + 0.3 * f64::from(count)).next_down()] {
            let place = spline.reduce(x);
            assert!((0.1..0.4).contains(&place), "{x} reduced to {place}");
        }
    }
}

/// Where the rounding of the place is some metres.
#[test]
fn however_far_away_a_height_is_the_profiles() {
    let spline = Spline::periodic(&[0.1, 0.2, 0.4], &[0.0, 1.0, 0.0]);
    for power in 10..30 {
        for x in [3.3, -7.7].map(|factor| factor * 10_f64.powi(power)) {
            let place = spline.reduce(x);
            assert!((0.1..0.4).contains(&place), "{x} reduced to {place}");
        }
    }
}

#[test]
fn finds_every_interval() {
    let nearly_even: Vec<f64> = (0..50).map(|i| f64::from(i) + 0.2 * f64::from(i % 3 - 1)).collect();
    let clustered: Vec<f64> = (0..200).map(|i| 1.1_f64.powi(i)).collect();
    for x in [UNEVEN.to_vec(), nearly_even, clustered, even(0.0, 0.3, 77)] {
        let spline = Spline::natural(&x, &vec![0.0; x.len()]);
        for (i, pair) in x.windows(2).enumerate() {
            for place in [pair[0], 0.5 * (pair[0] + pair[1]), pair[1].next_down()] {
                assert_eq!(spline.grid.interval(&spline.pieces, place), i, "{place} in {pair:?}");
            }
        }
    }
}

/// Inside and outside of the points, at them, periods away, and where nothing is.
#[test]
fn a_block_has_the_bits_of_single_places() {
    let x = even(0.1, 0.7, 50);
    let z: Vec<f64> = x.iter().map(|x| (2.0 * PI * x / 0.6).sin()).collect();
    let evenly = [Spline::natural(&x, &z), Spline::periodic(&x, &z)];
    let edges = [-1.0, 3.0, 3.0_f64.next_down(), 0.1, 0.7, 7.0, -9.0, 1e9, -1e300, 1e300, f64::INFINITY, f64::NAN];
    let places: Vec<f64> = edges.into_iter().chain(UNEVEN).chain(x).chain(even(-1.2, 3.2, 1000)).collect();
    for spline in both().iter().chain(&evenly) {
        for together in [1, 3, BLOCK] {
            for places in places.chunks(together) {
                let mut values = [[0.0; 4]; BLOCK];
                spline.evaluate_block(places, &mut values[..places.len()]);
                for (&x, found) in places.iter().zip(values) {
                    let expected: [f64; 4] = spline.evaluate(x).into();
                    assert_eq!(found.map(f64::to_bits), expected.map(f64::to_bits), "at {x}: {found:?} {expected:?}");
                }
            }
        }
    }
}

#[test]
fn evenly_spaced_points_need_no_table() {
    assert!(Spline::natural(&even(0.1, 0.7, 1000), &[0.0; 1001]).grid.starts_before.is_empty());
    assert!(!Spline::natural(&UNEVEN, &HEIGHTS).grid.starts_before.is_empty());
}

/// The extremes over a fine sample, which true bounds exceed by next to nothing.
fn sampled(spline: &Spline, low: f64, high: f64) -> [f64; 3] {
    even(low, high, 20_000).iter().map(|&x| spline.evaluate(x)).fold([f64::NEG_INFINITY, 0.0, 0.0], |most, at| {
        [most[0].max(at.0), most[1].max(at.1.abs()), most[2].max(at.2.abs())]
    })
}

fn assert_bounds(spline: &Spline, bounds: super::SplineBounds, low: f64, high: f64) {
    let scale = spline.bounds();
    let [z, slope, curvature] = sampled(spline, low, high);
    assert_within(bounds.z_max, z, 1e-5);
    assert_within(bounds.slope_max_abs, slope, 1e-3 * scale.slope_max_abs);
    assert_within(bounds.curvature_max_abs, curvature, 1e-3 * scale.curvature_max_abs);
    assert!(bounds.z_max >= z - 1e-12 && bounds.slope_max_abs >= slope - 1e-12);
}

#[test]
fn bounds_are_the_true_extremes() {
    let spline = Spline::periodic(&UNEVEN, &HEIGHTS);
    assert_bounds(&spline, spline.bounds(), -1.0, 3.0);
    for (low, high) in [(0.3, 0.5), (0.5, 0.6), (1.0, 1.0), (-0.99, 2.9), (2.0, 3.5), (-7.0, -6.0), (41.0, 41.01)] {
        assert_bounds(&spline, spline.local_bounds(low, high), low, high);
        // A range beyond the end of a period may end a rounding below the interval that it starts in.
        assert!(spline.top_near(low, high) >= spline.local_bounds(low, high).z_max - 1e-15);
    }
    // Of the intervals that a range meets, and not of others.
    assert!(spline.top_near(1.5, 1.6) < spline.bounds().z_max);
}

#[test]
fn a_natural_end_that_rises_outwards_has_no_highest_place() {
    let rising = Spline::natural(&UNEVEN, &HEIGHTS);
    assert!(rising.evaluate(3.0).1 > 0.0);
    assert_eq!(rising.bounds().z_max, f64::INFINITY);
    let falling = Spline::natural(&[0.0, 1.0, 2.0], &[0.0, 1.0, 0.0]);
    assert_bounds(&falling, falling.bounds(), -1.0, 3.0);
    for (low, high) in [(-9.0, -8.0), (-8.0, 0.0), (2.0, 5.0), (-2.0, 5.0), (3.5, 5.0), (0.2, 0.3)] {
        assert_bounds(&falling, falling.local_bounds(low, high), low, high);
        assert_bounds(&rising, rising.local_bounds(low, high), low, high);
        assert!(rising.top_near(low, high) >= rising.local_bounds(low, high).z_max);
    }
}

#[test]
fn a_range_over_many_intervals_falls_back_to_all_of_them() {
    let x = even(0.0, 1.0, 100);
    let z: Vec<f64> = x.iter().map(|x| (2.0 * PI * x).sin().powi(2)).collect();
    let spline = Spline::natural(&x, &z);
    let everywhere = spline.local_bounds(0.4, 0.8);
    assert!(everywhere.z_max >= 1.0 - 1e-12 && everywhere.z_max < 1.1);
    assert!(spline.local_bounds(0.45, 0.55).z_max < 0.2);
}

#[test]
fn the_floor_is_that_of_the_standard_library() {
    let edges =
        [0.0, 0.5, 1.0, 1.0 - f64::EPSILON, 4_503_599_627_370_495.5, 4_503_599_627_370_496.0, 1e300, f64::INFINITY];
    for x in edges.into_iter().flat_map(|x| [x, -x]).chain((-1000..1000).map(|i| 0.137 * f64::from(i))) {
        assert_eq!(floor(x), x.floor(), "{x}");
    }
    assert!(floor(f64::NAN).is_nan());
}
