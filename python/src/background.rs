//! Work without the interpreter's lock, which Ctrl-C ends.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::Duration;

use asperity_study::progress::Stop;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

/// How often signals are looked at, and progress is told.
const POLL: Duration = Duration::from_millis(100);

/// What work shares with who waits for it.
#[derive(Clone, Debug, Default)]
pub(crate) struct Task {
    stop: Arc<AtomicBool>,
    /// The fraction that is done, as bits.
    done: Arc<AtomicU64>,
}

impl Task {
    /// Whether nobody waits any more.
    pub(crate) fn is_stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    /// Stops the work once nobody waits.
    pub(crate) fn stop(&self) -> Stop {
        let task = self.clone();
        Stop::new(move || if task.is_stopped() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) })
    }

    /// Tells the fraction that is done, 0 to 1.
    pub(crate) fn report(&self, done: f64) {
        self.done.store(done.to_bits(), Ordering::Relaxed);
    }

    fn done(&self) -> f64 {
        f64::from_bits(self.done.load(Ordering::Relaxed))
    }
}

/// Does `work` in a thread of its own and waits for it; `progress`, if there is one, is called with the fraction done.
/// An exception, of Ctrl-C or of `progress`, is raised at once: the work is told to stop, and what it finds is dropped.
pub(crate) fn in_background<T: Send + 'static>(
    py: Python<'_>,
    progress: Option<Py<PyAny>>,
    work: impl FnOnce(&Task) -> T + Send + 'static,
) -> PyResult<T> {
    let task = Task::default();
    let (sender, receiver) = mpsc::channel();
    let of_work = task.clone();
    thread::Builder::new().spawn(move || {
        // Nobody may wait any more.
        let _ = sender.send(work(&of_work));
    })?;
    let receiver = Mutex::new(receiver);
    let wait = || receiver.lock().unwrap_or_else(PoisonError::into_inner).recv_timeout(POLL);
    let look = || {
        py.check_signals()?;
        progress.as_ref().map_or(Ok(()), |progress| progress.call1(py, (task.done(),)).map(drop))
    };
    loop {
        match py.detach(wait) {
            Ok(found) => return Ok(found),
            Err(RecvTimeoutError::Timeout) => look().inspect_err(|_| task.stop.store(true, Ordering::Relaxed))?,
            Err(RecvTimeoutError::Disconnected) => {
                return Err(PyRuntimeError::new_err("internal error: the computation ended without a result"));
            }
        }
    }
}
