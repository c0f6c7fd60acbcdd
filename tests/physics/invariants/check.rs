//! How a property is put to the test: how many random cases, from which seed, and what is said of them.

use std::cell::Cell;
use std::env;

use proptest::strategy::Strategy;
use proptest::test_runner::{Config, RngSeed, TestCaseError, TestCaseResult, TestError, TestRunner};

/// The seed of every property, so that two runs of the tests see the same scenes; PROPTEST_RNG_SEED sets another.
const SEED: u64 = 1;

/// The most that proptest tries to make a failing scene simpler: runs of scenes take milliseconds each.
const MAX_SHRINKING: u32 = 2000;

/// Puts `property` to the test with `cases` values of `strategy`, or as many as PROPTEST_CASES says. Nothing is kept in
/// files: a scene that failed belongs into an ordinary test.
pub(crate) fn check<S: Strategy>(name: &str, cases: u32, strategy: S, property: impl Fn(S::Value) -> TestCaseResult) {
    let number = |name: &str| env::var(name).ok().and_then(|text| text.parse::<u64>().ok());
    let cases = number("PROPTEST_CASES").map_or(cases, |given| u32::try_from(given).unwrap_or(u32::MAX));
    let seed = number("PROPTEST_RNG_SEED").unwrap_or(SEED);
    let mut runner = TestRunner::new(Config {
        cases,
        rng_seed: RngSeed::Fixed(seed),
        failure_persistence: None,
        max_shrink_iters: MAX_SHRINKING,
        ..Config::default()
    });
    let (ran, failed) = (Cell::new(0_u32), Cell::new(false));
    let counted = |value| {
        let result = property(value);
        failed.set(failed.get() || matches!(result, Err(TestCaseError::Fail(_))));
        ran.set(ran.get() + u32::from(result.is_ok() && !failed.get()));
        result
    };
    match runner.run(&strategy, counted) {
        Ok(()) => println!("{name}: {} cases, seed {seed}", ran.get()),
        Err(TestError::Fail(why, value)) => {
            panic!("{name}, after {} good cases, seed {seed}:\n{why}\n{value:#?}", ran.get())
        }
        Err(error) => panic!("{name}, seed {seed}: {error}"),
    }
}
