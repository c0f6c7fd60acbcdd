//! What a point of the steady solver costs, by ratios: to bare pairs of Fourier transforms of its size, and to the same point
//! by the layer: `cargo bench --bench steady`.

#![allow(missing_docs, clippy::unwrap_used, clippy::print_stdout, reason = "like a test")]

#[allow(dead_code, unreachable_pub, reason = "shared with the other benchmarks")]
mod common;

use std::hint::black_box;
use std::path::Path;
use std::time::Duration;

use asperity::scene::Scene;
use asperity_study::steady::{Convolution, GridSize, SlidingRubber, SteadySolver, SurfaceGrid};
use common::side_by_side;

const BUDGET: Duration = Duration::from_secs(2);

fn main() {
    println!("{:<34} {:>10} {:>10} {:>8} {:>8}", "point", "ms", "bare pair", "ratio", "pairs");
    for (case, pressure) in [("half-plane/rough", 1e5), ("half-plane/rough", 4e5), ("half-plane/steep", 5e5)] {
        let path =
            Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join(format!("tests/reference/{case}.toml"));
        let scene = Scene::parse(&std::fs::read_to_string(&path).unwrap(), &path).unwrap();
        let rubber = SlidingRubber::new(&scene).unwrap();
        point(
            &format!("{case}, 8192, {pressure:e} Pa"),
            &rubber,
            SurfaceGrid::of_profile(&scene.surface, 8192),
            pressure,
        );
        // Two directions of ridges across each other.
        let ridges = SurfaceGrid::of_profile(&scene.surface, 512);
        let heights = (0..512 * 512).map(|i| ridges.heights[i % 512] + ridges.heights[i / 512]).collect();
        let map = SurfaceGrid::new(GridSize { nx: 512, ny: 512 }, ridges.length, ridges.length, heights);
        point(&format!("{case}, 512 x 512, {pressure:e} Pa"), &rubber, map, pressure);
    }
}

/// A point at 0.1 m/s over a pair of transforms of its grid.
fn point(name: &str, rubber: &SlidingRubber, surface: SurfaceGrid, pressure: f64) {
    let (size, mut field) = (surface.size, surface.heights.clone());
    let (mut convolution, mut solver) = (Convolution::new(size), SteadySolver::new(surface));
    let kernel = vec![1.0 / size.points() as f64; size.columns() * size.ny];
    let before = solver.pairs();
    black_box(solver.slide(rubber, 0.1, pressure));
    let pairs = solver.pairs() - before;
    let times = side_by_side(
        [&mut || drop(black_box(solver.slide(rubber, 0.1, pressure))), &mut || {
            convolution.apply(black_box(&mut field), &kernel)
        }],
        BUDGET,
    );
    let [point, pair] = times.shortest.map(|seconds| 1e3 * seconds);
    println!("{name:<34} {point:>10.3} {pair:>10.4} {:>8.0} {pairs:>8.0}", times.ratio);
}
