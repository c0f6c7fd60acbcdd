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

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use catalogue::Case;
use judge::{Verdict, Way, judge};

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

/// Findings that are known, rule by rule.
fn known() -> Known {
    let file = catalogue::table(&common::root().join("tests/extreme/data/known.toml"));
    let entries = file.get("finding").and_then(|list| list.as_array()).cloned().unwrap_or_default();
    let text = |entry: &toml::Value, key: &str| entry[key].as_str().unwrap().to_owned();
    let rules = |entry: &toml::Value| {
        let (case, way, rules) = (text(entry, "scene"), text(entry, "way"), text(entry, "rules"));
        rules.split(' ').map(|rule| (case.clone(), way.clone(), rule.to_owned())).collect::<Vec<_>>()
    };
    entries.iter().flat_map(rules).collect()
}

/// What a run is listed with as known not to hold: case, way, rule.
type Known = BTreeSet<(String, String, String)>;

/// What does not hold and is not listed, and what is listed and holds.
fn compare(verdicts: &[Verdict], known: &Known) -> Vec<String> {
    let (mut unknown, mut seen) = (Vec::new(), Known::new());
    for verdict in verdicts {
        for finding in &verdict.findings {
            let line = format!("{} [{}]: {}: {}", verdict.case, verdict.way.name(), finding.rule, finding.text);
            let key = (verdict.case.clone(), verdict.way.name().to_owned(), finding.rule.to_owned());
            if known.contains(&key) {
                println!("known: {line}")
            } else {
                unknown.push(line)
            }
            seen.insert(key);
        }
    }
    let run: BTreeSet<&str> = verdicts.iter().map(|verdict| verdict.case.as_str()).collect();
    let all = std::env::var_os("EXTREME").is_none();
    let stale = known.difference(&seen).filter(|(case, ..)| all || run.contains(case.as_str()));
    let stale = stale.map(|(case, way, rule)| format!("{case} [{way}]: {rule} is listed as known and holds"));
    unknown.extend(stale);
    unknown
}

#[test]
fn every_scene_keeps_what_must_hold() {
    let cases = asked();
    let verdicts = judge_all(&cases);
    report::write(&verdicts);
    report::write_scenes(&cases, &verdicts);
    report::write_findings(&verdicts);
    report::print_counts(&cases, &verdicts);
    report::print_ratios(&verdicts);
    let wrong = compare(&verdicts, &known());
    assert!(wrong.is_empty(), "{} findings:\n{}", wrong.len(), wrong.join("\n"));
    let chatter = verdicts.iter().filter(|verdict| verdict.item == "10⁴ changes" && verdict.way == Way::Event);
    chatter.for_each(|verdict| assert!(verdict.events >= 1e4, "{}: {} mode changes", verdict.case, verdict.events));
    if std::env::var_os("EXTREME").is_none() {
        report::check_honesty(&verdicts);
    }
}

/// The scenes that the catalogue has to hold at least, and of each phrase and of each item in it.
const LEAST: [usize; 3] = [200, 5, 3];

#[test]
fn the_catalogue_has_enough_of_everything() {
    let cases = catalogue::read();
    let file = catalogue::table(&common::root().join("tests/extreme/data/phrases.toml"));
    let phrases = file["phrase"].as_array().unwrap();
    let names = |phrase: &toml::Value| {
        let name = phrase["name"].as_str().unwrap().to_owned();
        let items = phrase["items"].as_array().unwrap().iter();
        items.map(|item| (name.clone(), item.as_str().unwrap().to_owned())).collect::<Vec<_>>()
    };
    let wanted: BTreeSet<(String, String)> = phrases.iter().flat_map(names).collect();
    let found: BTreeSet<_> = cases.iter().map(|case| (case.phrase.clone(), case.item.clone())).collect();
    assert_eq!(found, wanted);
    let [all, of_phrase, of_item] = LEAST;
    assert!(cases.len() >= all, "{} scenes", cases.len());
    for (phrase, item) in &wanted {
        let count = |of: &dyn Fn(&Case) -> bool| cases.iter().filter(|case| case.phrase == *phrase && of(case)).count();
        assert!(count(&|_| true) >= of_phrase, "{} scenes of {phrase}", count(&|_| true));
        let of = |case: &Case| case.item == *item;
        assert!(count(&of) >= of_item, "{} scenes of {phrase}: {item}", count(&of));
    }
    let library = cases.iter().filter(|case| case.script.is_none());
    let (fmu, all) = library.fold((0, 0), |(fmu, all), case| (fmu + usize::from(case.fmu_steps.is_some()), all + 1));
    assert!(10 * fmu >= all, "{fmu} of {all} scenes are run through the C interface too");
}
