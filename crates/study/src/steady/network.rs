//! Pressures in a network of conductances of any contrast: what flows into each point flows out through its links.
//!
//! Points with few links, of which the last ways through a nearly closed gap consist, are eliminated exactly. What is left
//! is solved by conjugate gradients, preconditioned by a multigrid cycle on aggregates of strongly linked points (Y. Notay,
//! Electron. Trans. Numer. Anal. 37, 2010; O. E. Livne and A. Brandt, SIAM J. Sci. Comput. 34, 2012): a lake behind narrow
//! straits becomes one point of a coarser network, where its pressure is found at once. Links are added alone and flows told
//! by differences of pressures, so that nothing is lost where links differ by many orders.

use asperity::math::{add_weighted_sum, dot};

/// A link between two points, told from either side: from, to, conductance.
pub(super) type Link = (usize, usize, f64);

/// A network, finest first, and its aggregates down to single points.
pub(super) struct Network {
    levels: Vec<Level>,
}

/// A network after elimination, and the aggregate of each point.
struct Level {
    /// In the order of elimination.
    eliminated: Vec<Eliminated>,
    links: Links,
    aggregates: Vec<usize>,
    aggregate_count: usize,
}

/// A point, and its neighbours with the share of its flow that goes to each.
struct Eliminated {
    point: usize,
    shares: Vec<(usize, f64)>,
    whole: f64,
}

/// The links of each point, those of eliminated points none.
struct Links {
    /// Where the links of each point begin, and where the last end.
    offsets: Vec<usize>,
    links: Vec<(usize, f64)>,
    /// The sum of the links of each point.
    whole: Vec<f64>,
}

/// Points with more links are not eliminated: those of a grid have four (Livne and Brandt).
const MOST_LINKS: usize = 4;
/// A link of at least this part of a point's strongest is strong (Notay, p. 132).
const STRONG: f64 = 0.25;
/// The residual over that of the start, in the norm of the cycle, and the most iterations.
const RESIDUAL: f64 = 1e-12;
const MOST_ITERATIONS: usize = 1000;

impl Network {
    /// That of `count` points. Links of the same two points add up.
    pub(super) fn new(count: usize, links: Vec<Link>) -> Self {
        let mut levels = vec![Level::new(count, links)];
        while let Some(finest) = levels.last().filter(|level| !level.links.links.is_empty()) {
            let coarser = Level::new(finest.aggregate_count, finest.links.between(&finest.aggregates));
            levels.push(coarser);
        }
        Self { levels }
    }

    /// The pressures under which `sources` flow out of each point, up to a constant in each part of the network; sources of
    /// a part add up to 0.
    pub(super) fn solve(&self, sources: &[f64]) -> Vec<f64> {
        let finest = &self.levels[0];
        let mut residual = sources.to_vec();
        finest.eliminate(&mut residual);
        let left = residual.clone();
        let mut pressures = vec![0.0; sources.len()];
        let mut direction = self.cycle(0, &residual);
        let mut norm = dot(&residual, &direction);
        let enough = RESIDUAL * RESIDUAL * norm;
        for _ in 0..MOST_ITERATIONS {
            if norm <= enough {
                break;
            }
            let image = finest.links.flows(&direction);
            let step = norm / dot(&direction, &image);
            add_weighted_sum(&mut pressures, [(step, &direction[..])]);
            add_weighted_sum(&mut residual, [(-step, &image[..])]);
            let corrected = self.cycle(0, &residual);
            let next = dot(&residual, &corrected);
            let share = next / norm;
            direction.iter_mut().zip(&corrected).for_each(|(direction, new)| *direction = new + share * *direction);
            norm = next;
        }
        finest.substitute(&left, &mut pressures);
        pressures
    }

    /// An approximation of the pressures under `sources`, symmetric and linear in them.
    fn cycle(&self, depth: usize, sources: &[f64]) -> Vec<f64> {
        let level = &self.levels[depth];
        let links = &level.links;
        let mut pressures = vec![0.0; sources.len()];
        if links.links.is_empty() {
            return pressures;
        }
        (0..sources.len()).for_each(|i| links.balance(i, sources, &mut pressures));
        let mut left = sources.to_vec();
        add_weighted_sum(&mut left, [(-1.0, &links.flows(&pressures)[..])]);
        let mut restricted = vec![0.0; level.aggregate_count];
        level.aggregates.iter().zip(&left).for_each(|(&aggregate, left)| restricted[aggregate] += left);
        // Twice on the coarser level, whose links are too strong where pressures vary within aggregates.
        let coarser = &self.levels[depth + 1];
        coarser.eliminate(&mut restricted);
        let left = restricted.clone();
        let mut correction = self.cycle(depth + 1, &restricted);
        add_weighted_sum(&mut restricted, [(-1.0, &coarser.links.flows(&correction)[..])]);
        add_weighted_sum(&mut correction, [(1.0, &self.cycle(depth + 1, &restricted)[..])]);
        coarser.substitute(&left, &mut correction);
        pressures.iter_mut().zip(&level.aggregates).for_each(|(p, &aggregate)| *p += correction[aggregate]);
        (0..sources.len()).rev().for_each(|i| links.balance(i, sources, &mut pressures));
        pressures
    }
}

impl Level {
    fn new(count: usize, links: Vec<Link>) -> Self {
        let mut of = vec![Vec::new(); count];
        for (i, j, link) in merged(links) {
            of[i].push((j, link));
        }
        let eliminated = eliminated(&mut of);
        let links = Links::new(
            of.iter().enumerate().flat_map(|(i, links)| links.iter().map(move |&(j, link)| (i, j, link))),
            count,
        );
        // Twice in pairs a level: coarser by four or more, so that two visits of a coarser level cost as much as half a one.
        let (mut aggregates, count) = links.pairs();
        let of_pairs = Links::new(merged(links.between(&aggregates)).into_iter(), count);
        let (of_aggregates, aggregate_count) = of_pairs.pairs();
        aggregates.iter_mut().for_each(|aggregate| *aggregate = of_aggregates[*aggregate]);
        Self { eliminated, links, aggregates, aggregate_count }
    }

    /// Passes the sources of eliminated points on to their neighbours.
    fn eliminate(&self, sources: &mut [f64]) {
        for point in &self.eliminated {
            let source = sources[point.point];
            point.shares.iter().for_each(|&(j, share)| sources[j] += share * source);
        }
    }

    /// The pressures of eliminated points, from `sources` as they were passed on.
    fn substitute(&self, sources: &[f64], pressures: &mut [f64]) {
        for point in self.eliminated.iter().rev() {
            let around: f64 = point.shares.iter().map(|&(j, share)| share * pressures[j]).sum();
            pressures[point.point] = sources[point.point] / point.whole + around;
        }
    }
}

/// Sorted by their points, with what is between the same two added up.
fn merged(mut links: Vec<Link>) -> Vec<Link> {
    links.retain(|&(i, j, link)| i != j && link > 0.0);
    links.sort_unstable_by_key(|&(i, j, _)| (i, j));
    links.dedup_by(|next, kept| {
        let is_same = (next.0, next.1) == (kept.0, kept.1);
        kept.2 += if is_same { next.2 } else { 0.0 };
        is_same
    });
    links
}

/// Takes points with few links out of a network, one after the other: their neighbours are linked in their place, as a star
/// is replaced by a mesh.
fn eliminated(of: &mut [Vec<(usize, f64)>]) -> Vec<Eliminated> {
    let mut eliminated = Vec::new();
    let mut waiting: Vec<usize> = (0..of.len()).collect();
    while let Some(point) = waiting.pop() {
        if !(1..=MOST_LINKS).contains(&of[point].len()) {
            continue;
        }
        let links = std::mem::take(&mut of[point]);
        let whole: f64 = links.iter().map(|link| link.1).sum();
        for &(j, _) in &links {
            of[j].retain(|(k, _)| *k != point);
            waiting.push(j);
        }
        for (from, first) in &links {
            for (to, second) in links.iter().filter(|(to, _)| to != from) {
                let link = first * second / whole;
                match of[*from].iter_mut().find(|(k, _)| k == to) {
                    Some((_, between)) => *between += link,
                    None => of[*from].push((*to, link)),
                }
            }
        }
        eliminated.push(Eliminated {
            point,
            shares: links.iter().map(|&(j, link)| (j, link / whole)).collect(),
            whole,
        });
    }
    eliminated
}

impl Links {
    /// Those of `count` points, in the order of the points.
    fn new(links: impl Iterator<Item = Link>, count: usize) -> Self {
        let (mut offsets, mut whole, mut of) = (vec![0; count + 1], vec![0.0; count], Vec::new());
        for (i, j, link) in links {
            offsets[i + 1] += 1;
            whole[i] += link;
            of.push((j, link));
        }
        (0..count).for_each(|i| offsets[i + 1] += offsets[i]);
        Self { offsets, links: of, whole }
    }

    fn of(&self, i: usize) -> &[(usize, f64)] {
        &self.links[self.offsets[i]..self.offsets[i + 1]]
    }

    /// Joins each point with the strongest of its strong neighbours that is not joined yet, failing that with the aggregate
    /// of its strongest, so that there are at most half as many; and how many. Points without links share one.
    fn pairs(&self) -> (Vec<usize>, usize) {
        let mut aggregates: Vec<Option<usize>> = vec![None; self.whole.len()];
        let mut count = 1;
        for i in 0..aggregates.len() {
            let strongest = |is: &dyn Fn(usize) -> bool| {
                self.of(i).iter().copied().filter(|&(j, _)| is(j)).reduce(|a, b| if b.1 > a.1 { b } else { a })
            };
            let Some((first, most)) = strongest(&|_| true).filter(|_| aggregates[i].is_none()) else { continue };
            let free = strongest(&|j| aggregates[j].is_none()).filter(|(_, link)| *link >= STRONG * most);
            match (free, aggregates[first]) {
                (None, Some(joined)) => aggregates[i] = Some(joined),
                (free, _) => {
                    let partner = free.map_or(first, |(j, _)| j);
                    (aggregates[i], aggregates[partner]) = (Some(count), Some(count));
                    count += 1;
                }
            }
        }
        (aggregates.into_iter().map(Option::unwrap_or_default).collect(), count)
    }

    /// The links between aggregates.
    fn between(&self, aggregates: &[usize]) -> Vec<Link> {
        let of = |i: usize| self.of(i).iter().map(move |&(j, link)| (aggregates[i], aggregates[j], link));
        (0..self.whole.len()).flat_map(of).collect()
    }

    /// What flows out of each point.
    fn flows(&self, pressures: &[f64]) -> Vec<f64> {
        let flow = |i: usize| self.of(i).iter().map(|&(j, link)| link * (pressures[i] - pressures[j])).sum();
        (0..pressures.len()).map(flow).collect()
    }

    /// Sets the pressure at a point so that its source flows out, as the others are (Gauss and Seidel).
    fn balance(&self, i: usize, sources: &[f64], pressures: &mut [f64]) {
        if self.whole[i] > 0.0 {
            let flow: f64 = self.of(i).iter().map(|&(j, link)| link * pressures[j]).sum();
            pressures[i] = (sources[i] + flow) / self.whole[i];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// Both sides of each link.
    fn both(links: &[Link]) -> Vec<Link> {
        links.iter().flat_map(|&(i, j, link)| [(i, j, link), (j, i, link)]).collect()
    }

    /// The links of a grid with periods, as strong as told of both points.
    fn grid(side: usize, strength: impl Fn(usize, usize) -> f64) -> Vec<Link> {
        let beside = |i: usize| [i / side * side + (i + 1) % side, (i + side) % (side * side)];
        let links: Vec<Link> = (0..side * side).flat_map(|i| beside(i).map(|j| (i, j, strength(i, j)))).collect();
        both(&links)
    }

    /// One wave on an even grid: its eigenvalue is 2 - 2 cos(2π/n) in each direction.
    #[test]
    fn a_wave_on_an_even_grid_has_its_eigenvalue() {
        let side = 48;
        let wave = |i: usize| (TAU * (2 * (i % side) + 3 * (i / side)) as f64 / side as f64).cos();
        let value = |waves: f64| 2.0 - 2.0 * (TAU * waves / side as f64).cos();
        let sources: Vec<f64> = (0..side * side).map(wave).collect();
        let pressures = Network::new(side * side, grid(side, |_, _| 1.0)).solve(&sources);
        for (i, pressure) in pressures.iter().enumerate() {
            let exact = wave(i) / (value(2.0) + value(3.0));
            assert!((pressure - pressures[0] - (exact - 1.0 / (value(2.0) + value(3.0)))).abs() < 1e-9, "{i}");
        }
    }

    /// Two lakes of strong links between straits of 1e-12 and 2e-12 of them, around a point of its own and a pool: what is
    /// poured into one flows off through both straits in parallel.
    #[test]
    fn lakes_behind_straits_have_the_pressure_that_drives_what_is_poured_in() {
        let lake = grid(20, |i, j| 1.0 + ((i * 7 + j * 13) % 5) as f64);
        let other = lake.iter().map(|&(i, j, link)| (i + 400, j + 400, link));
        let pool = both(&[(801, 802, 3.0), (802, 803, 1e-9)]);
        let links = lake.iter().copied().chain(other).chain(both(&[(7, 411, 1e-12), (233, 700, 2e-12)])).chain(pool);
        let mut sources = vec![0.0; 804];
        (sources[100], sources[500]) = (1e-12, -1e-12);
        let pressures = Network::new(804, links.collect()).solve(&sources);
        // Within a lake they differ by some 1e-12.
        assert!((pressures[100] - pressures[500] - 1.0 / 3.0).abs() < 1e-10);
        assert_eq!(pressures[800..], [0.0; 4]);
    }

    /// What is poured in flows out of every point of a grid whose links span twelve orders, many of them 0.
    #[test]
    fn flows_are_in_balance_whatever_the_contrast() {
        let mut random = asperity::math::SplitMix64::new(5);
        let strengths: Vec<f64> = (0..900).map(|_| random.unit()).collect();
        let strength = |i: usize, j: usize| {
            let smaller = strengths[i].min(strengths[j]);
            if smaller < 0.2 { 0.0 } else { 10f64.powf(-12.0 * (1.0 - smaller)) }
        };
        let links = grid(30, strength);
        let through = links.iter().find(|link| link.2 > 1e-3).copied().unwrap();
        let mut sources = vec![0.0; 900];
        (sources[through.0], sources[through.1]) = (1.0, -1.0);
        let network = Network::new(900, links.clone());
        let pressures = network.solve(&sources);
        let mut left = sources;
        links.iter().for_each(|&(i, j, link)| left[i] -= link * (pressures[i] - pressures[j]));
        assert!(left.iter().all(|left| left.abs() < 1e-9), "{:?}", left.iter().copied().fold(0.0, f64::max));
    }
}
