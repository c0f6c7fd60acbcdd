//! Memory of the machine: what is asked for is reckoned before it is taken, since Rust ends the process where an
//! allocation fails, and Linux ends it later where too much was promised.

use std::{fs, hint};

/// Something needs more memory than the machine has.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{what}: expected less, for it takes about {} MB of memory, and the machine has {} MB free", .needed >> 20, .free >> 20)]
pub struct NotEnoughMemory {
    /// What needs it.
    pub what: String,
    /// Bytes that it needs.
    pub needed: u64,
    /// Bytes that are free.
    pub free: u64,
}

/// What is small is not looked up.
const SMALL: u64 = 1 << 26;

/// Checks that the machine has so many bytes for `what`.
///
/// # Errors
/// [`NotEnoughMemory`].
pub fn check_memory(needed: u64, what: impl FnOnce() -> String) -> Result<(), NotEnoughMemory> {
    if needed <= SMALL {
        return Ok(());
    }
    let free = free_memory().unwrap_or(u64::MAX);
    if needed > free {
        return Err(NotEnoughMemory { what: what(), needed, free });
    }
    if usize::try_from(needed).is_ok_and(can_allocate) {
        return Ok(());
    }
    Err(NotEnoughMemory { what: what(), needed, free: needed.min(free) - 1 })
}

/// Whether the system promises so many bytes at once.
pub fn can_allocate(bytes: usize) -> bool {
    let mut probe: Vec<u8> = Vec::new();
    let is_promised = probe.try_reserve_exact(bytes).is_ok();
    // An allocation that nothing looks at may be left out.
    hint::black_box(&mut probe);
    is_promised
}

/// Bytes that the machine, or the group of processes that this one is in, has free; `None` where the system does not say.
fn free_memory() -> Option<u64> {
    let number = |path: &str| fs::read_to_string(path).ok()?.trim().parse::<u64>().ok();
    let text = fs::read_to_string("/proc/meminfo").ok()?;
    let kibibytes = |key: &str| {
        let line = text.lines().find_map(|line| line.strip_prefix(key))?;
        line.trim_start_matches(':').trim().trim_end_matches("kB").trim().parse::<u64>().ok()
    };
    let of_machine = 1024 * (kibibytes("MemAvailable")? + kibibytes("SwapFree").unwrap_or(0));
    let of_group = number("/sys/fs/cgroup/memory.max")
        .map(|most| most.saturating_sub(number("/sys/fs/cgroup/memory.current").unwrap_or(0)));
    Some(of_group.map_or(of_machine, |group| group.min(of_machine)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_no_machine_has_is_refused() {
        assert!(check_memory(1 << 20, String::new).is_ok());
        for needed in [1 << 60, u64::MAX] {
            let error = check_memory(needed, || "layer.masses = 9".to_owned()).unwrap_err();
            assert!(error.free < needed && error.to_string().starts_with("layer.masses = 9: expected less"), "{error}");
        }
    }
}
