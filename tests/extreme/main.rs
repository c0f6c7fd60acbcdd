//! Extreme scenes: every run keeps what must hold, or stops with a clear reason and the last good state.
#![allow(missing_docs, unsafe_code, unreachable_pub, missing_debug_implementations)]
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout, reason = "tests may fail")]

mod catalogue;
#[allow(dead_code, reason = "shared by several tests")]
#[path = "../common/mod.rs"]
mod common;
mod fmu;
#[allow(dead_code, reason = "the program's own")]
mod judge;
#[allow(dead_code, reason = "shared by several tests")]
#[path = "../common/master.rs"]
mod master;
mod report;
mod rules;
mod run;

use catalogue::Case;
use judge::{Judged, Way, judge};
use rayon::prelude::*;
use rules::Finding;

/// All cases, or those whose names contain the environment variable EXTREME.
fn asked() -> Vec<Case> {
    let cases = catalogue::read();
    let part = std::env::var("EXTREME").unwrap_or_default();
    cases.into_iter().filter(|case| case.name.contains(&part)).collect()
}

/// Judges all cases on all cores. The runs are in the order of the catalogue.
fn judge_all(cases: &[Case]) -> Vec<Judged> {
    cases.par_iter().with_max_len(1).flat_map_iter(judge_or_panic).collect()
}

/// A run that panics is a finding like any other.
fn judge_or_panic(case: &Case) -> Vec<Judged> {
    let result = std::panic::catch_unwind(|| judge(case));
    result.unwrap_or_else(|panic| {
        let text = panic
            .downcast_ref::<String>()
            .cloned()
            .or_else(|| panic.downcast_ref::<&str>().map(|text| (*text).to_owned()));
        vec![Judged::panicked(case, text.unwrap_or_default())]
    })
}

#[test]
fn every_scene_keeps_what_must_hold() {
    let cases = asked();
    let runs = judge_all(&cases);
    report::write(&runs);
    report::write_scenes(&cases, &runs);
    report::print_counts(&cases, &runs);
    report::print_errors(&runs);
    report::print_ratios(&runs);
    let line = |run: &Judged, finding: &Finding| {
        format!("{} [{}]: {}: {}", run.case, run.way.name(), finding.rule, finding.text)
    };
    let findings = runs.iter().flat_map(|run| run.findings.iter().map(move |finding| line(run, finding)));
    let findings: Vec<String> = findings.collect();
    assert!(findings.is_empty(), "{} findings:\n{}", findings.len(), findings.join("\n"));
    let chatter = runs.iter().filter(|run| run.item == "10⁴ changes" && run.way == Way::Event);
    chatter.for_each(|run| assert!(run.events >= 1e4, "{}: {} mode changes", run.case, run.events));
    if std::env::var_os("EXTREME").is_none() {
        report::check_errors(&runs);
        report::check_estimates(&runs);
    }
}
