//! The command line program `asperity`; its commands are in [`program`].

mod program;

use std::hint::black_box;
use std::process::ExitCode;

use clap::Parser;

use program::{Arguments, run};

/// Blocks of memory up to this size are kept for others when they are freed.
const KEPT_BLOCKS: usize = 16 << 20;

#[expect(clippy::print_stderr, reason = "the one place where the program prints the error that ended it")]
fn main() -> ExitCode {
    keep_freed_memory();
    match run(Arguments::parse()) {
        Ok(status) => status,
        Err(error) => {
            eprintln!("asperity: {error}");
            ExitCode::FAILURE
        }
    }
}

/// The GNU C library gives blocks from 128 KiB on back to the system when they are freed, and the pages of the next one are new
/// again, which costs more than to fill them. Freeing a larger block raises that bound to its size (`man 3 mallopt`,
/// `M_MMAP_THRESHOLD`). Nothing is written to the block, so it takes no memory.
fn keep_freed_memory() {
    drop(black_box(Vec::<u8>::with_capacity(KEPT_BLOCKS)));
}
