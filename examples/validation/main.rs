//! The validation page: what asperity computes beside closed solutions and measured or published values.
//!
//! `cargo run --release --example validation` writes docs/validation.md, its pictures and the README's table;
//! with `--quick` it prints the comparisons that take no time, and writes nothing.

#![allow(
    missing_docs,
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::print_stdout,
    clippy::print_stderr,
    unreachable_pub,
    reason = "a comparison that cannot be made ends the command"
)]

mod common;
mod suite;

use std::fs;
use std::process::ExitCode;

use suite::{ALL, page, root};

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match arguments.iter().map(String::as_str).collect::<Vec<_>>().as_slice() {
        [] => write_page(),
        ["--quick"] => ALL.iter().filter(|entry| entry.quick).for_each(|entry| println!("{}", entry.section())),
        // For work on one of them.
        ["--only", part] => {
            let chosen = ALL.iter().filter(|entry| entry.file.contains(part) || entry.title.contains(part));
            chosen.for_each(|entry| println!("{}", entry.section()));
        }
        _ => {
            eprintln!("usage: cargo run --release --example validation [-- --quick | --only PART]");
            return ExitCode::FAILURE;
        }
    }
    ExitCode::SUCCESS
}

/// All comparisons, one after the other: each may use all cores itself.
fn write_page() {
    let folder = root().join("docs/validation");
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    let mut made = Vec::new();
    for entry in ALL {
        let begin = std::time::Instant::now();
        let comparison = (entry.compare)();
        for picture in &comparison.pictures {
            fs::write(folder.join(picture.file), picture.svg()).unwrap();
        }
        eprintln!("{:6.1} s  {}", begin.elapsed().as_secs_f64(), entry.title);
        made.push((entry, comparison));
    }
    fs::write(root().join("docs/validation.md"), page::page(&made)).unwrap();
    let readme = root().join("README.md");
    let text = fs::read_to_string(&readme).unwrap();
    fs::write(&readme, page::with_table(&text, &page::readme_table(&made))).unwrap();
}
