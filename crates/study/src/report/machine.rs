//! The machine and the build whose run times a report shows.

use std::env::consts::{ARCH, OS};
use std::fs;
use std::thread::available_parallelism;

/// What run times depend on.
#[derive(Clone, Debug, PartialEq)]
pub struct Machine {
    /// The model of the processor.
    pub cpu: String,
    /// How many cores this program may use; a timed run uses one.
    pub cores: usize,
    /// The operating system with its kernel.
    pub system: String,
}

impl Machine {
    /// The machine that this program runs on; where it does not say what it is, its architecture and system.
    pub fn here() -> Self {
        let cpu = value("/proc/cpuinfo", "model name", ':').unwrap_or_else(|| ARCH.into());
        let system = value("/etc/os-release", "PRETTY_NAME", '=').unwrap_or_else(|| OS.into());
        let kernel = fs::read_to_string("/proc/sys/kernel/osrelease").unwrap_or_default();
        let system = [system.as_str(), kernel.trim()].join(" ").trim().to_owned();
        Self { cpu, cores: available_parallelism().map_or(1, usize::from), system }
    }

    /// In words.
    pub fn in_words(&self) -> String {
        let cores = if self.cores == 1 { "1 core".into() } else { format!("{} cores", self.cores) };
        format!("{}, {cores}, {}", self.cpu, self.system)
    }
}

/// The program with its version and kind of build.
pub fn build() -> String {
    let kind = if cfg!(debug_assertions) { "development" } else { "release" };
    format!("asperity {}, {kind} build", env!("CARGO_PKG_VERSION"))
}

/// The first value of a key in a file of lines "key: value".
fn value(path: &str, key: &str, separator: char) -> Option<String> {
    find(&fs::read_to_string(path).ok()?, key, separator)
}

fn find(text: &str, key: &str, separator: char) -> Option<String> {
    let pairs = text.lines().filter_map(|line| line.split_once(separator));
    let mut values = pairs.filter(|(name, _)| name.trim() == key).map(|(_, value)| value.trim().trim_matches('"'));
    values.find(|value| !value.is_empty()).map(str::to_owned)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_machine_is_what_its_files_say() {
        let cpu = "processor\t: 0\nmodel name\t: Some CPU @ 2.0: fast\nprocessor\t: 1\nmodel name\t: Another";
        assert_eq!(find(cpu, "model name", ':').as_deref(), Some("Some CPU @ 2.0: fast"));
        assert_eq!(find("ID=some\nPRETTY_NAME=\"Some OS 1\"", "PRETTY_NAME", '=').as_deref(), Some("Some OS 1"));
        assert_eq!(find("processor\t: 0", "model name", ':'), None);
    }
}
