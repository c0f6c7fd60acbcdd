//! The shared library as a master sees it.

use std::collections::BTreeSet;
use std::process::Command;

use crate::common::{library, run};
use crate::lifecycle::TABLE;

/// The functions that need no state to be allowed.
const OTHERS: [&str; 4] = ["fmi2GetTypesPlatform", "fmi2GetVersion", "fmi2Instantiate", "fmi2FreeInstance"];

#[test]
#[cfg(target_os = "linux")]
fn the_34_functions_are_exported_and_nothing_else() {
    let text = run(Command::new("nm").args(["-D", "--defined-only"]).arg(library()));
    let exported: Vec<_> = text.lines().filter_map(|line| line.split_whitespace().last()).collect();
    let expected: BTreeSet<_> = TABLE.iter().map(|row| row.0).chain(OTHERS).collect();
    assert_eq!((exported.len(), expected.len()), (34, 34), "{exported:?}");
    assert_eq!(BTreeSet::from_iter(exported), expected);
}
