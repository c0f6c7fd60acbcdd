//! The FMU states that an instance has handed out.

use std::collections::BTreeMap;

use super::fault::Fault;
use super::run::Run;

/// FMU states by handle. The handle is the state's address, unique among all that live; it is looked up and never
/// followed, so a stale or foreign one is refused.
#[derive(Debug, Default)]
pub(super) struct Memory {
    states: BTreeMap<usize, Box<Run>>,
}

impl Memory {
    /// Keeps a copy of `run`: in the place of the state `handle`, or in a new one where `handle` is 0. Gives its
    /// handle.
    pub(super) fn keep(&mut self, handle: usize, run: &Run) -> Result<usize, Fault> {
        if handle == 0 {
            return Ok(self.keep_new(run.clone()));
        }
        let place = self.states.get_mut(&handle).ok_or(Fault::UnknownState("what FMUstate points to"))?;
        **place = run.clone();
        Ok(handle)
    }

    /// Keeps `run` in a new state. Gives its handle.
    pub(super) fn keep_new(&mut self, run: Run) -> usize {
        let state = Box::new(run);
        let handle = (&raw const *state).addr();
        self.states.insert(handle, state);
        handle
    }

    /// The state `handle`.
    pub(super) fn recall(&self, handle: usize) -> Result<&Run, Fault> {
        self.states.get(&handle).map(|state| &**state).ok_or(Fault::UnknownState("FMUstate"))
    }

    /// Frees the state `handle`; 0 is none.
    pub(super) fn forget(&mut self, handle: usize) -> Result<(), Fault> {
        match (handle, self.states.remove(&handle)) {
            (0, _) | (_, Some(_)) => Ok(()),
            (_, None) => Err(Fault::UnknownState("what FMUstate points to")),
        }
    }
}
