//! Extreme scenes: every run keeps what must hold, or stops with a clear reason and the last good state.
#![allow(missing_docs, unsafe_code, unreachable_pub, missing_debug_implementations)]
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout, reason = "tests may fail")]

mod catalogue;
#[allow(dead_code, reason = "shared by several tests")]
#[path = "../common/mod.rs"]
mod common;
mod device;
mod generated;
mod holds;
#[allow(dead_code, reason = "the program's own")]
#[path = "../../src/program/html.rs"]
mod html;
mod judge;
#[allow(dead_code, reason = "shared by several tests")]
#[path = "../fmi_interface/master.rs"]
mod master;
mod report;
mod run;

use std::collections::BTreeMap;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use catalogue::Case;
use judge::{Verdict, judge};

/// The cases named by an environment variable while one is looked for; all otherwise.
fn asked() -> Vec<Case> {
    let cases = catalogue::read();
    let part = std::env::var("EXTREME").unwrap_or_default();
    cases.into_iter().filter(|case| case.name.contains(&part)).collect()
}

/// Every case, the cores sharing them: the verdicts in the catalogue's order.
fn judge_all(cases: &[Case]) -> Vec<Verdict> {
    let next = AtomicUsize::new(0);
    let verdicts = Mutex::new(BTreeMap::new());
    let workers = std::thread::available_parallelism().map_or(1, usize::from);
    std::thread::scope(|scope| {
        for _ in 0..workers {
            scope.spawn(|| {
                let take = || {
                    let place = next.fetch_add(1, Ordering::Relaxed);
                    Some((place, cases.get(place)?))
                };
                while let Some((place, case)) = take() {
                    let found = judge_or_panic(case);
                    verdicts.lock().unwrap().insert(place, found);
                }
            });
        }
    });
    verdicts.into_inner().unwrap().into_values().flatten().collect()
}

/// A run that panics is a finding like any other.
fn judge_or_panic(case: &Case) -> Vec<Verdict> {
    let result = std::panic::catch_unwind(|| judge(case));
    result.unwrap_or_else(|panic| {
        let text = panic
            .downcast_ref::<String>()
            .cloned()
            .or_else(|| panic.downcast_ref::<&str>().map(|text| (*text).to_owned()));
        vec![Verdict::panicked(case, text.unwrap_or_default())]
    })
}

/// Findings that are known, by case and way of running.
fn known() -> BTreeMap<(String, String), String> {
    let file = catalogue::table(&common::root().join("tests/extreme/data/known.toml"));
    let entries = file.get("finding").and_then(|list| list.as_array()).cloned().unwrap_or_default();
    let text = |entry: &toml::Value, key: &str| entry[key].as_str().unwrap().to_owned();
    let entry = |entry: &toml::Value| ((text(entry, "scene"), text(entry, "way")), text(entry, "rules"));
    entries.iter().map(entry).collect()
}

#[test]
fn every_scene_keeps_what_must_hold() {
    let cases = asked();
    let verdicts = judge_all(&cases);
    report::write(&verdicts);
    report::write_scenes(&cases, &verdicts);
    report::print_counts(&cases, &verdicts);
    report::print_ratios(&verdicts);
    let known = known();
    let mut unknown = Vec::new();
    for verdict in &verdicts {
        let rules = known.get(&(verdict.case.clone(), verdict.way.name().to_owned()));
        for finding in &verdict.findings {
            let listed = rules.is_some_and(|rules| rules.split(' ').any(|rule| rule == finding.rule));
            let line = format!("{} [{}]: {}: {}", verdict.case, verdict.way.name(), finding.rule, finding.text);
            if listed { println!("known: {line}") } else { unknown.push(line) }
        }
    }
    assert!(unknown.is_empty(), "{} findings:\n{}", unknown.len(), unknown.join("\n"));
}
