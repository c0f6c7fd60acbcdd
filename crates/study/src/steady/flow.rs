//! What the gaps of a contact let through and carry along: the flow of a thin film between rubber and surface, after
//! Reynolds, on the points of the solver.
//!
//! On a map -∂x(g³ ∂x p) - ∂y(g³ ∂y p) = 0 by finite volumes around the points, with the harmonic mean of g³ on the faces
//! between them, for a mean gradient of 1; what a moving smooth side carries follows from the same p. A profile's ridges would
//! close every way along x; there the gaps stand for an isotropic roughness, by the effective medium of their heights (D. A. G.
//! Bruggeman; B. N. J. Persson, J. Phys.: Condens. Matter 22, 2010), whose ways close at the share of contact that rough
//! surfaces have (W. B. Dapp et al., Phys. Rev. Lett. 108, 2012).

use asperity::math::{bracketed_root, dot, sum};

use super::network::Network;
use super::transform::GridSize;

/// Lengths that tell how a fluid passes a contact. All tend to the mean gap where nothing touches, and are 0 where every
/// way is closed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlowGaps {
    /// The leak gap, m: two smooth plates at this distance let as much through, along the sliding, under the same gradient
    /// of pressure: q = -(h³/12η) dp/dx.
    pub leak: f64,
    /// The drag gap, m: two smooth plates at this distance carry as much between a standing rough side and a smooth one that
    /// moves at V: q = V h/2.
    pub drag: f64,
    /// The leak gap across the sliding, m; `None` of the effective medium.
    pub leak_across: Option<f64>,
}

/// The share of contact at which ways close.
const CLOSES_AT: f64 = 0.42;
/// A leak gap whose cube is this part of that of the gap's root mean square is closed.
const CLOSED: f64 = 1e-10;
/// A gap below this part of its root mean square is closed: its cube is a hundredth of that.
const TOUCHES: f64 = 1e-4;

impl FlowGaps {
    const ZERO: Self = Self { leak: 0.0, drag: 0.0, leak_across: None };

    /// Those of the effective medium of `gaps` (m), 0 where the surfaces touch, as if they were isotropic.
    pub fn of_medium(gaps: &[f64]) -> Self {
        let largest = gaps.iter().copied().fold(0.0, f64::max);
        let touching = gaps.iter().filter(|gap| **gap <= 0.0).count();
        if largest <= 0.0 || touching as f64 >= CLOSES_AT * gaps.len() as f64 {
            return Self::ZERO;
        }
        let factor = CLOSES_AT / (1.0 - CLOSES_AT);
        let conductances: Vec<f64> = gaps.iter().map(|gap| (gap / largest).powi(3)).collect();
        // Falls as ln s rises: above 0 where s tends to 0, below at s = 1.
        let excess = |logarithm: f64| {
            let s = logarithm.exp();
            conductances.iter().map(|a| (a - s) / (a + factor * s)).sum::<f64>()
        };
        let mut lower = -1.0;
        while excess(lower) < 0.0 {
            lower *= 2.0;
        }
        let s = bracketed_root(excess, (lower, 0.0), 1e-14).exp();
        let weights: Vec<f64> = conductances.iter().map(|a| 1.0 / (a + factor * s)).collect();
        Self { leak: largest * s.cbrt(), drag: dot(gaps, &weights) / sum(&weights), leak_across: None }
    }

    /// Solves for the flow through `gaps` (m), 0 where the surfaces touch, at points `spacing` (m) apart along and across the
    /// sliding, period in both directions.
    pub fn of_map(gaps: &[f64], size: GridSize, spacing: [f64; 2]) -> Self {
        Self::solve(gaps, size, spacing).0
    }

    /// The same, and where it leaks along the sliding: at each point 12η|q|/G, m³, of the flow per width q under the mean
    /// gradient of pressure G. The mean of its part along the sliding is the leak gap's cube.
    pub fn of_map_with_leak(gaps: &[f64], size: GridSize, spacing: [f64; 2]) -> (Self, Vec<f64>) {
        let largest = gaps.iter().copied().fold(0.0, f64::max);
        match Self::solve(gaps, size, spacing) {
            (found, Some((faces, along))) if found.leak > 0.0 => {
                let size = |[x, y]: &[f64; 2]| largest.powi(3) * x.hypot(*y);
                (found, faces.flows(&along).iter().map(size).collect())
            }
            (found, _) => (found, vec![0.0; gaps.len()]),
        }
    }

    /// The same, and the faces with the pressures along the sliding, where there is a gap; in units of the largest.
    fn solve(gaps: &[f64], size: GridSize, spacing: [f64; 2]) -> (Self, Option<(Faces, Vec<f64>)>) {
        let largest = gaps.iter().copied().fold(0.0, f64::max);
        if largest <= 0.0 {
            return (Self { leak_across: Some(0.0), ..Self::ZERO }, None);
        }
        // In units of the largest gap, and of a length that makes faces of even gaps 1.
        let rms = (dot(gaps, gaps) / gaps.len() as f64).sqrt() / largest;
        let open = |gap: &f64| if gap / largest > TOUCHES * rms { gap / largest } else { 0.0 };
        let relative: Vec<f64> = gaps.iter().map(open).collect();
        let faces = Faces::new(&relative, size, spacing);
        let network = faces.network();
        let along = network.solve(&faces.sources(Direction::Along));
        let closed = CLOSED * rms.powi(3);
        let cube = |mean: f64| if mean > closed { mean } else { 0.0 };
        let leak = cube(faces.conductance(Direction::Along, &along)).cbrt();
        let across = network.solve(&faces.sources(Direction::Across));
        let leak_across = cube(faces.conductance(Direction::Across, &across)).cbrt();
        let drag = if leak > 0.0 { faces.mean_carried(&along) } else { 0.0 };
        let [leak, drag, across] = [leak, drag.max(0.0), leak_across].map(|gap| largest * gap);
        (Self { leak, drag, leak_across: Some(across) }, Some((faces, along)))
    }
}

/// A direction on the grid.
#[derive(Clone, Copy)]
enum Direction {
    Along,
    Across,
}

/// The faces between the points of a grid with a period in both directions.
struct Faces {
    size: GridSize,
    /// Of the face behind each point in each direction: the harmonic mean of g³.
    conductances: [Vec<f64>; 2],
    /// The harmonic mean of g on the faces behind along the sliding.
    carried: Vec<f64>,
    /// What a face of each direction counts in the network.
    weights: [f64; 2],
}

impl Faces {
    fn new(gaps: &[f64], size: GridSize, [dx, dy]: [f64; 2]) -> Self {
        let harmonic = |a: f64, b: f64| if a > 0.0 && b > 0.0 { 2.0 * a * b / (a + b) } else { 0.0 };
        let cubes: Vec<f64> = gaps.iter().map(|gap| gap.powi(3)).collect();
        let faces = |values: &[f64], direction| -> Vec<f64> {
            (0..values.len()).map(|i| harmonic(values[i], values[size.behind(i, direction)])).collect()
        };
        let conductances = [Direction::Along, Direction::Across].map(|direction| faces(&cubes, direction));
        let carried = faces(gaps, Direction::Along);
        Self { size, conductances, carried, weights: [dy / dx, dx / dy] }
    }

    fn network(&self) -> Network {
        let links = |direction: Direction| {
            let faces = self.conductances[direction as usize].iter().enumerate();
            faces.flat_map(move |(i, face)| {
                let (behind, link) = (self.size.behind(i, direction), self.weights[direction as usize] * face);
                [(i, behind, link), (behind, i, link)]
            })
        };
        Network::new(self.size.points(), links(Direction::Along).chain(links(Direction::Across)).collect())
    }

    /// What flows into each point under an even gradient of 1.
    fn sources(&self, direction: Direction) -> Vec<f64> {
        let faces = &self.conductances[direction as usize];
        let flow = |face: usize| self.weights[direction as usize] * faces[face];
        (0..faces.len()).map(|i| flow(self.size.before(i, direction)) - flow(i)).collect()
    }

    /// The fall of the pressure over a face in a mean gradient of 1, in that over the same face where all are alike.
    fn fall(&self, pressures: &[f64], i: usize, direction: Direction) -> f64 {
        1.0 + pressures[i] - pressures[self.size.behind(i, direction)]
    }

    /// The mean flux in a mean gradient of 1, by its power, whose error is the square of that of the pressures.
    fn conductance(&self, direction: Direction, pressures: &[f64]) -> f64 {
        let faces = &self.conductances[direction as usize];
        let mut power: f64 =
            faces.iter().enumerate().map(|(i, face)| face * self.fall(pressures, i, direction).powi(2)).sum();
        let other = match direction {
            Direction::Along => Direction::Across,
            Direction::Across => Direction::Along,
        };
        let share = self.weights[other as usize] / self.weights[direction as usize];
        if share > 0.0 {
            let faces = &self.conductances[other as usize];
            let fall = |i: usize| pressures[i] - pressures[self.size.behind(i, other)];
            power += share * faces.iter().enumerate().map(|(i, face)| face * fall(i).powi(2)).sum::<f64>();
        }
        power / faces.len() as f64
    }

    /// The flow at each point along and across the sliding, under a mean gradient of 1 along it: the mean of what passes the
    /// faces before and behind.
    fn flows(&self, pressures: &[f64]) -> Vec<[f64; 2]> {
        // Pressures are in units of the fall from point to point along the sliding.
        let share = self.weights[Direction::Across as usize];
        let through = |face: usize, direction: Direction| {
            let conductance = self.conductances[direction as usize][face];
            match direction {
                Direction::Along => conductance * self.fall(pressures, face, direction),
                Direction::Across => {
                    share * conductance * (pressures[face] - pressures[self.size.behind(face, direction)])
                }
            }
        };
        let at = |i: usize| {
            [Direction::Along, Direction::Across]
                .map(|direction| 0.5 * (through(self.size.before(i, direction), direction) + through(i, direction)))
        };
        (0..pressures.len()).map(at).collect()
    }

    /// The mean of what the moving side carries less what pressures hold back, from those under a mean gradient of 1 along the
    /// sliding: as the network is symmetric, what a face carries counts by its fall of the pressure in that flow.
    fn mean_carried(&self, along: &[f64]) -> f64 {
        let carried = |(i, face): (usize, &f64)| face * self.fall(along, i, Direction::Along);
        self.carried.iter().enumerate().map(carried).sum::<f64>() / self.carried.len() as f64
    }
}

impl GridSize {
    /// The point behind one in a direction.
    fn behind(self, i: usize, direction: Direction) -> usize {
        let points = self.points();
        match direction {
            Direction::Along if i % self.nx + 1 == self.nx => i + 1 - self.nx,
            Direction::Along => i + 1,
            Direction::Across => (i + self.nx) % points,
        }
    }

    /// The point before one in a direction.
    fn before(self, i: usize, direction: Direction) -> usize {
        match direction {
            Direction::Along if i.is_multiple_of(self.nx) => i + self.nx - 1,
            Direction::Along => i - 1,
            Direction::Across => (i + self.points() - self.nx) % self.points(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// Ridges g = 1 + ε cos, as a map of `points` to the wave along or across the sliding.
    fn ridges(points: usize, amplitude: f64, across: bool) -> FlowGaps {
        let wave = |i: usize| 1.0 + amplitude * (TAU * i as f64 / points as f64).cos();
        let (size, spacing) = (GridSize { nx: points, ny: 4 }, [1.0 / points as f64, 0.3]);
        let (size, spacing) =
            if across { (GridSize { nx: 4, ny: points }, [0.3, spacing[0]]) } else { (size, spacing) };
        let gaps: Vec<f64> = (0..size.points()).map(|i| wave(if across { i / 4 } else { i % points })).collect();
        FlowGaps::of_map(&gaps, size, spacing)
    }

    /// Closed forms of one wave: 1 + 3/2 ε² along ridges, the harmonic mean of g³ over them, and what is carried over them.
    #[test]
    fn ridges_let_through_what_the_closed_forms_say() {
        let amplitude = 0.6;
        let square: f64 = amplitude * amplitude;
        let (along, over) = (1.0 + 1.5 * square, (1.0 - square).powf(2.5) / (1.0 + 0.5 * square));
        // mean(1/g²) over mean(1/g³).
        let drag = (1.0 - square).powf(-1.5) / ((1.0 + 0.5 * square) * (1.0 - square).powf(-2.5));
        let errors = [64, 128, 512].map(|points| {
            let (crossed, followed) = (ridges(points, amplitude, false), ridges(points, amplitude, true));
            let close = |found: f64, exact: f64| (found / exact - 1.0).abs();
            let across = |gaps: FlowGaps| gaps.leak_across.unwrap().powi(3);
            // Ways along ridges hold everything: as exact as the sum over the points is, and that to rounding.
            assert!(close(across(crossed), along) < 1e-12 && close(followed.leak.powi(3), along) < 1e-12);
            assert!(close(followed.drag, 1.0) < 1e-12);
            assert!(close(across(followed), crossed.leak.powi(3)) < 1e-10);
            // So does the flow over them: the mean of 1/g³ over the points of a wave.
            assert!(close(crossed.leak.powi(3), over) < 1e-12);
            close(crossed.drag, drag)
        });
        // The faces are of second order.
        assert!((3.5..4.5).contains(&(errors[0] / errors[1])) && errors[2] < 1e-3, "{errors:?}");
    }

    /// What flows through each column of a rough gap, with closed places, is what its power says.
    #[test]
    fn as_much_flows_through_every_column() {
        let size = GridSize { nx: 48, ny: 40 };
        let mut random = asperity::math::SplitMix64::new(3);
        let phases: Vec<[f64; 3]> = (0..12).map(|_| [0, 1, 2].map(|_| random.unit())).collect();
        let height = |i: usize| -> f64 {
            let (x, y) = ((i % size.nx) as f64 / size.nx as f64, (i / size.nx) as f64 / size.ny as f64);
            let wave = |[a, b, c]: &[f64; 3]| (TAU * ((a * 4.0).round() * x + (b * 4.0).round() * y + c)).cos();
            0.6 + phases.iter().map(wave).sum::<f64>() * 0.3
        };
        let gaps: Vec<f64> = (0..size.points()).map(|i| height(i).max(0.0)).collect();
        let faces = Faces::new(&gaps, size, [1.0, 0.7]);
        let pressures = faces.network().solve(&faces.sources(Direction::Along));
        let mean = faces.conductance(Direction::Along, &pressures);
        assert!(mean > 1e-3 && gaps.iter().filter(|gap| **gap == 0.0).count() > 100, "{mean}");
        for column in 0..size.nx {
            let flow = |row: usize| {
                let i = row * size.nx + column;
                faces.conductances[0][i] * faces.fall(&pressures, i, Direction::Along)
            };
            let through = (0..size.ny).map(flow).sum::<f64>() / size.ny as f64;
            assert!((through / mean - 1.0).abs() < 1e-9, "{column}: {through} {mean}");
        }
        // So is the mean of what flows at the points, none of it where it touches.
        let flows = faces.flows(&pressures);
        let along = flows.iter().map(|flow| flow[0]).sum::<f64>() / gaps.len() as f64;
        assert!((along / mean - 1.0).abs() < 1e-9, "{along} {mean}");
        assert!(flows.iter().zip(&gaps).all(|(flow, gap)| *gap > 0.0 || *flow == [0.0; 2]));
    }

    /// A channel along the sliding, and beside it a pool whose gaps have a thousandfold of sizes: as without the pool.
    #[test]
    fn what_is_enclosed_carries_nothing() {
        let size = GridSize { nx: 16, ny: 8 };
        let gap = |i: usize, has_pool: bool| match (i % size.nx, i / size.nx) {
            (column, 0) => 1e-6 + 5e-7 * (column as f64).sin(),
            (column @ 4..=9, 3..=5) if has_pool => 1e-6 * 10.0_f64.powi(4 - column as i32).max(1e-3),
            _ => 0.0,
        };
        let found = [true, false].map(|has_pool| {
            let gaps: Vec<f64> = (0..size.points()).map(|i| gap(i, has_pool)).collect();
            FlowGaps::of_map(&gaps, size, [1e-5, 1e-5])
        });
        assert!((found[0].leak / found[1].leak - 1.0).abs() < 1e-9, "{found:?}");
        assert!(found[1].drag > 0.0 && (found[0].drag / found[1].drag - 1.0).abs() < 1e-9, "{found:?}");
        assert_eq!(found.map(|gaps| gaps.leak_across), [Some(0.0); 2]);
    }

    #[test]
    fn the_flow_at_a_point_has_its_size_in_both_directions() {
        // Even gaps: all of it along, h³, whatever the distances of the points.
        let (even, leak) = FlowGaps::of_map_with_leak(&[2e-6; 12], GridSize { nx: 4, ny: 3 }, [1e-5, 3e-6]);
        assert!((even.leak / 2e-6 - 1.0).abs() < 1e-12);
        assert!(leak.iter().all(|flow| (flow / 8e-18 - 1.0).abs() < 1e-12), "{leak:?}");
        // A channel a point wide that winds up like stairs: as much flows through its legs, per width of a point.
        let is_open = |i: usize| matches!((i % 8, i / 8), (0..=3, 0) | (3, 0..=4) | (3..=7, 4) | (7, 4..=7) | (7, 0));
        let gaps: Vec<f64> = (0..64).map(|i| if is_open(i) { 1e-6 } else { 0.0 }).collect();
        let [dx, dy] = [1e-5, 4e-6];
        let (_, leak) = FlowGaps::of_map_with_leak(&gaps, GridSize { nx: 8, ny: 8 }, [dx, dy]);
        let ([along, other], across) = ([leak[1], leak[4 * 8 + 5]], leak[2 * 8 + 3]);
        // The residual of the pressures is 1e-12 of what drives them.
        assert!(along > 0.0 && (other / along - 1.0).abs() < 1e-9, "{along} {other}");
        assert!((across * dx / (along * dy) - 1.0).abs() < 1e-9, "{along} {across}");
    }

    /// Of even gaps both lengths are the gap; from the share of contact at which ways close on there are none.
    #[test]
    fn the_effective_medium_of_even_gaps_is_the_gap_and_closes() {
        let even = FlowGaps::of_medium(&[2e-6; 10]);
        assert!((even.leak / 2e-6 - 1.0).abs() < 1e-9 && (even.drag / 2e-6 - 1.0).abs() < 1e-9, "{even:?}");
        let touching = |share: usize| {
            let gaps: Vec<f64> = (0..100).map(|i| if i < share { 0.0 } else { 1e-6 }).collect();
            FlowGaps::of_medium(&gaps)
        };
        assert!(touching(41).leak > 0.0 && touching(41).drag > 0.0);
        assert_eq!(touching(42), FlowGaps::ZERO);
        assert_eq!(FlowGaps::of_medium(&[0.0; 4]), FlowGaps::ZERO);
    }
}
