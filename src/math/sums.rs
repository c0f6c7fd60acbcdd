//! Weighted sums of arrays, such as the terms of a Runge-Kutta stage from the stages before.

/// Terms that one pass over the memory takes.
const MAX_TERMS: usize = 8;

/// Numbers taken together, so that the compiler uses vector instructions.
const LANES: usize = 8;
/// Pairs of arrays whose products are summed together: as many as there are registers for. [`dots`] has a case for each
/// smaller number.
const PAIRS_IN_A_PASS: usize = 4;

/// out_i = Σ_t weight_t term_t,i. Terms may be longer than `out`.
///
/// # Panics
/// Where a term is shorter than `out`.
pub fn weighted_sum<'a>(out: &mut [f64], terms: impl IntoIterator<Item = (f64, &'a [f64])>) {
    sum_in_batches(out, false, terms);
}

/// out_i += Σ_t weight_t term_t,i. Terms may be longer than `out`.
///
/// # Panics
/// Where a term is shorter than `out`.
pub fn add_weighted_sum<'a>(out: &mut [f64], terms: impl IntoIterator<Item = (f64, &'a [f64])>) {
    sum_in_batches(out, true, terms);
}

/// Sums up [`MAX_TERMS`] terms at a time; `add`s the first of them to what is there.
#[inline]
fn sum_in_batches<'a>(out: &mut [f64], add: bool, terms: impl IntoIterator<Item = (f64, &'a [f64])>) {
    let mut batch = [(0.0, &[][..]); MAX_TERMS];
    let (mut filled, mut add) = (0, add);
    // Chained iterators are faster where they drive the loop.
    terms.into_iter().for_each(|term| {
        if filled == MAX_TERMS {
            sum_up(out, add, &batch);
            (filled, add) = (0, true);
        }
        batch[filled] = term;
        filled += 1;
    });
    sum_up(out, add, &batch[..filled]);
}

fn sum_up(out: &mut [f64], add: bool, terms: &[(f64, &[f64])]) {
    if add { sum_of_terms::<true>(out, terms) } else { sum_of_terms::<false>(out, terms) }
}

fn sum_of_terms<const ADD: bool>(out: &mut [f64], terms: &[(f64, &[f64])]) {
    with_widest_vectors(
        #[inline(always)]
        || match *terms {
            [] if ADD => (),
            [] => out.fill(0.0),
            [a] => pass::<ADD, 1>(out, [a]),
            [a, b] => pass::<ADD, 2>(out, [a, b]),
            [a, b, c] => pass::<ADD, 3>(out, [a, b, c]),
            [a, b, c, d] => pass::<ADD, 4>(out, [a, b, c, d]),
            [a, b, c, d, e] => pass::<ADD, 5>(out, [a, b, c, d, e]),
            [a, b, c, d, e, f] => pass::<ADD, 6>(out, [a, b, c, d, e, f]),
            [a, b, c, d, e, f, g] => pass::<ADD, 7>(out, [a, b, c, d, e, f, g]),
            [a, b, c, d, e, f, g, h, ..] => pass::<ADD, 8>(out, [a, b, c, d, e, f, g, h]),
        },
    )
}

#[inline(always)]
fn pass<const ADD: bool, const N: usize>(out: &mut [f64], terms: [(f64, &[f64]); N]) {
    let weights = terms.map(|(weight, _)| weight);
    let terms = terms.map(|(_, term)| &term[..out.len()]);
    for i in 0..out.len() {
        let first = weights[0] * terms[0][i];
        let mut sum = if ADD { out[i] + first } else { first };
        for t in 1..N {
            sum += weights[t] * terms[t][i];
        }
        out[i] = sum;
    }
}

/// Σ_i a_i.
pub fn sum(values: &[f64]) -> f64 {
    sum_of_pairs(values, values, |value, _| value)
}

/// Σ_i a_i b_i over the shorter of both.
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    sum_of_pairs(a, b, |a, b| a * b)
}

/// Σ_i term(a_i, b_i) over the shorter of both, in `LANES` partial sums.
#[inline]
pub fn sum_of_pairs(a: &[f64], b: &[f64], term: impl Fn(f64, f64) -> f64) -> f64 {
    let n = a.len().min(b.len());
    let ((a, a_rest), (b, b_rest)) = (a[..n].as_chunks::<LANES>(), b[..n].as_chunks::<LANES>());
    with_widest_vectors(
        #[inline(always)]
        || {
            let mut sums = [0.0; LANES];
            for (a, b) in a.iter().zip(b) {
                for lane in 0..LANES {
                    sums[lane] += term(a[lane], b[lane]);
                }
            }
            let rest: f64 = a_rest.iter().zip(b_rest).map(|(&a, &b)| term(a, b)).sum();
            sums.iter().sum::<f64>() + rest
        },
    )
}

/// Σ_i a_i b_i of several pairs of arrays of one length.
pub fn dots<const N: usize>(pairs: [(&[f64], &[f64]); N]) -> [f64; N] {
    let mut sums = [0.0; N];
    let (fours, rest) = pairs.as_chunks::<PAIRS_IN_A_PASS>();
    let (sums_of_fours, sums_of_rest) = sums.as_chunks_mut::<PAIRS_IN_A_PASS>();
    sums_of_fours.iter_mut().zip(fours).for_each(|(sums, pairs)| *sums = dots_in_a_pass(*pairs));
    match *rest {
        [a] => sums_of_rest.copy_from_slice(&dots_in_a_pass([a])),
        [a, b] => sums_of_rest.copy_from_slice(&dots_in_a_pass([a, b])),
        [a, b, c] => sums_of_rest.copy_from_slice(&dots_in_a_pass([a, b, c])),
        _ => (),
    }
    sums
}

/// The dot products of at most [`PAIRS_IN_A_PASS`] pairs, in one pass over them.
fn dots_in_a_pass<const N: usize>(pairs: [(&[f64], &[f64]); N]) -> [f64; N] {
    let n = pairs.iter().map(|(a, b)| a.len().min(b.len())).min().unwrap_or(0);
    let whole = n - n % LANES;
    let sums = with_widest_vectors(
        #[inline(always)]
        || {
            let chunks = pairs.map(|(a, b)| (chunks_of(&a[..whole]), chunks_of(&b[..whole])));
            let mut sums = [[0.0; LANES]; N];
            for i in 0..whole / LANES {
                for (sums, (a, b)) in sums.iter_mut().zip(chunks) {
                    for lane in 0..LANES {
                        sums[lane] += a[i][lane] * b[i][lane];
                    }
                }
            }
            sums
        },
    );
    std::array::from_fn(|pair| {
        let (a, b) = pairs[pair];
        let rest: f64 = a[whole..n].iter().zip(&b[whole..n]).map(|(a, b)| a * b).sum();
        sums[pair].iter().sum::<f64>() + rest
    })
}

/// Σ_i a_i², and Σ_i a_i b_i of several `b` of its length or longer. Faster than [`dots`]: what all pairs share is
/// loaded once.
///
/// # Panics
/// Where one is shorter than `a`.
pub fn square_and_dots<const N: usize>(a: &[f64], others: [&[f64]; N]) -> (f64, [f64; N]) {
    let others = others.map(|b| b[..a.len()].as_chunks::<LANES>());
    let (a, a_rest) = a.as_chunks::<LANES>();
    let (square, sums) = with_widest_vectors(
        #[inline(always)]
        || {
            let (mut square, mut sums) = ([0.0; LANES], [[0.0; LANES]; N]);
            let others = others.map(|(b, _)| &b[..a.len()]);
            for i in 0..a.len() {
                for lane in 0..LANES {
                    square[lane] += a[i][lane] * a[i][lane];
                }
                for (sums, b) in sums.iter_mut().zip(others) {
                    for lane in 0..LANES {
                        sums[lane] += a[i][lane] * b[i][lane];
                    }
                }
            }
            (square, sums)
        },
    );
    let with_rest = |sums: [f64; LANES], b_rest: &[f64]| {
        sums.iter().sum::<f64>() + a_rest.iter().zip(b_rest).map(|(a, b)| a * b).sum::<f64>()
    };
    (with_rest(square, a_rest), std::array::from_fn(|other| with_rest(sums[other], others[other].1)))
}

#[inline(always)]
fn chunks_of(values: &[f64]) -> &[[f64; LANES]] {
    values.as_chunks().0
}

/// Σ_i term(a_i, b_i, c_i) over the shortest of the three, in `LANES` partial sums.
#[inline]
pub fn sum_of_triples(a: &[f64], b: &[f64], c: &[f64], term: impl Fn(f64, f64, f64) -> f64) -> f64 {
    let n = a.len().min(b.len()).min(c.len());
    let (a, a_rest) = a[..n].as_chunks::<LANES>();
    let (b, b_rest) = b[..n].as_chunks::<LANES>();
    let (c, c_rest) = c[..n].as_chunks::<LANES>();
    with_widest_vectors(
        #[inline(always)]
        || {
            let mut sums = [0.0; LANES];
            for ((a, b), c) in a.iter().zip(b).zip(c) {
                for lane in 0..LANES {
                    sums[lane] += term(a[lane], b[lane], c[lane]);
                }
            }
            let rest: f64 = a_rest.iter().zip(b_rest).zip(c_rest).map(|((&a, &b), &c)| term(a, b, c)).sum();
            sums.iter().sum::<f64>() + rest
        },
    )
}

/// Σ_i term(i) for i = 0 … n-1, in `LANES` partial sums.
#[inline]
pub fn sum_of(n: usize, term: impl Fn(usize) -> f64) -> f64 {
    let mut sums = [0.0; LANES];
    let whole = n - n % LANES;
    for start in (0..whole).step_by(LANES) {
        for (lane, sum) in sums.iter_mut().enumerate() {
            *sum += term(start + lane);
        }
    }
    sums.iter().sum::<f64>() + (whole..n).map(term).sum::<f64>()
}

/// Does `work` with the widest vectors of the processor (SSE2, AVX2, AVX-512); numbers are the same with all.
///
/// Only what is inlined into `work` takes part: it and the functions that it calls are to be `#[inline(always)]`.
#[inline]
pub fn with_widest_vectors<R>(work: impl FnOnce() -> R) -> R {
    pulp::Arch::new().dispatch(work)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whole numbers, so that no rounding hides a term left out or taken twice.
    #[test]
    fn every_term_counts_once() {
        for terms in 0..20 {
            for n in [0, 1, 3, 4, 9] {
                let arrays: Vec<Vec<f64>> =
                    (0..terms).map(|t| (0..n + 2).map(|i| (100 * t + i) as f64).collect()).collect();
                let weighted: Vec<(f64, &[f64])> =
                    arrays.iter().enumerate().map(|(t, array)| ((t + 1) as f64, &array[..])).collect();
                let expected = |i: usize| (0..terms).map(|t| ((t + 1) * (100 * t + i)) as f64).sum::<f64>();
                let mut out = vec![7.0; n];
                weighted_sum(&mut out, weighted.iter().copied());
                assert!((0..n).all(|i| out[i] == expected(i)), "{terms} terms, {n} numbers: {out:?}");
                add_weighted_sum(&mut out, weighted.iter().copied());
                assert!((0..n).all(|i| out[i] == 2.0 * expected(i)), "{terms} terms, {n} numbers: {out:?}");
            }
        }
    }

    /// Fewer pairs than are summed in a pass, as many, and several passes with a rest; bit for bit as one at a time.
    #[test]
    fn several_dots_are_those_of_each_pair() {
        fn check<const N: usize>(n: usize) {
            let arrays: [Vec<f64>; N] =
                std::array::from_fn(|pair| (0..n).map(|i| ((i + 1) as f64 * (pair + 2) as f64).sqrt()).collect());
            let pairs: [(&[f64], &[f64]); N] =
                std::array::from_fn(|pair| (&arrays[pair][..], &arrays[(pair + 1) % N][..]));
            let expected = pairs.map(|pair| dots([pair])[0]);
            assert_eq!(dots(pairs), expected, "{N} pairs of {n}");
            for ((a, b), sum) in pairs.into_iter().zip(expected) {
                // The two add in different orders.
                assert!((sum - dot(a, b)).abs() <= 1e-14 * sum, "{sum} {}", dot(a, b));
            }
        }
        for n in 0..14 {
            check::<1>(n);
            check::<2>(n);
            check::<3>(n);
            check::<4>(n);
            check::<5>(n);
            check::<7>(n);
            check::<8>(n);
        }
    }

    #[test]
    fn a_square_and_dots_are_those_of_each_pair() {
        for n in 0..11 {
            let arrays: [Vec<f64>; 3] =
                std::array::from_fn(|array| (0..n + array).map(|i| (i * (array + 2) + 1) as f64).collect());
            let (square, others) = square_and_dots(&arrays[0], [&arrays[1][..], &arrays[2]]);
            assert_eq!(
                (square, others),
                (dot(&arrays[0], &arrays[0]), [1, 2].map(|other| dot(&arrays[0], &arrays[other])))
            );
        }
    }

    #[test]
    fn sums_are_those_of_whole_numbers() {
        for n in 0..11 {
            let a: Vec<f64> = (0..n).map(|i| (i + 1) as f64).collect();
            let b: Vec<f64> = (0..n + 1).map(|i| (3 * i) as f64).collect();
            let expected: f64 = (0..n).map(|i| ((i + 1) * 3 * i) as f64).sum();
            assert_eq!(dot(&a, &b), expected);
            assert_eq!(sum_of_pairs(&a, &b, |a, b| a * b), expected);
            assert_eq!(sum_of(n, |i| a[i] * b[i]), expected);
            assert_eq!(sum_of_triples(&a, &b, &a, |a, b, c| a * b + c), expected + a.iter().sum::<f64>());
        }
    }

    /// Numbers whose products and sums are rounded, against the same operations one by one.
    #[test]
    fn vectors_change_no_bits() {
        let array = |seed: usize| -> Vec<f64> { (0..37).map(|i| ((i * seed) as f64).sin()).collect() };
        let (a, b, c) = (array(1), array(2), array(3));
        let mut out = vec![0.0; 37];
        weighted_sum(&mut out, [(0.1, &a[..]), (0.7, &b), (1e-3, &c)]);
        assert!((0..37).all(|i| out[i] == 0.1 * a[i] + 0.7 * b[i] + 1e-3 * c[i]));
        let mut sums = [0.0; LANES];
        (0..32).for_each(|i| sums[i % LANES] += a[i] * b[i]);
        let rest: f64 = (32..37).map(|i| a[i] * b[i]).sum();
        assert_eq!(dot(&a, &b), sums.iter().sum::<f64>() + rest);
    }
}
