//! Long work with the interpreter released. Signals such as Ctrl-C are checked meanwhile, and
//! memory is checked before the core allocates it.

use std::hint::black_box;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::thread;
use std::time::Duration;

use cardan::Result;
use pyo3::exceptions::PyMemoryError;
use pyo3::prelude::*;

use crate::convert::OrRaise;

/// The interval between checks for signals.
const SIGNAL_INTERVAL: Duration = Duration::from_millis(50);

/// Allocations up to this size are not checked; they come from memory that the process already has.
const SMALL: usize = 1 << 20;

/// The most threads to use; one if the thread pool cannot be created.
pub(crate) fn threads(workers: Option<usize>) -> Option<usize> {
    static POOL: OnceLock<bool> = OnceLock::new();
    let made = || rayon::ThreadPoolBuilder::new().build_global().is_ok();
    if workers == Some(1) || *POOL.get_or_init(made) { workers } else { Some(1) }
}

/// Runs work of some milliseconds or more on other threads. This thread, on which Python handles
/// signals, waits for them and checks for signals. If a signal handler raises, the work's stop flag
/// is set, and the exception is raised after the work has ended.
pub(crate) fn run_interruptible(
    py: Python<'_>,
    workers: Option<usize>,
    work: &mut (dyn FnMut(&AtomicBool) -> Result<()> + Send),
) -> PyResult<()> {
    let stop = AtomicBool::new(false);
    let (result, raised) = py.detach(|| {
        let mut result = None;
        let (ended, end) = mpsc::channel::<()>();
        #[expect(clippy::redundant_closure_for_method_calls, reason = "not for every lifetime")]
        let wait = || {
            let mut raised = None;
            while end.recv_timeout(SIGNAL_INTERVAL) == Err(RecvTimeoutError::Timeout) {
                if raised.is_none()
                    && let Some(Err(error)) = Python::try_attach(|py| py.check_signals())
                {
                    stop.store(true, Ordering::Relaxed);
                    raised = Some(error);
                }
            }
            raised
        };
        let job = || {
            // Dropped when the work ends, even by a panic.
            let _ended = ended;
            result = Some(work(&stop));
        };
        let raised = if workers == Some(1) {
            // This avoids the pool, which a forked process does not have.
            thread::scope(|scope| {
                thread::Builder::new().spawn_scoped(scope, job).ok().and_then(|_| wait())
            })
        } else {
            rayon::in_place_scope(|scope| {
                scope.spawn(|_| job());
                wait()
            })
        };
        // If no other thread could be created, this one does the work.
        (result.unwrap_or_else(|| work(&stop)), raised)
    });
    match raised {
        Some(error) => Err(error),
        None => result.or_raise(),
    }
}

/// Runs work with the interpreter released, `brief` work on this thread and other work as
/// [`run_interruptible`] does. `work` is given the most threads to use and the flag that stops it.
pub(crate) fn run_released(
    py: Python<'_>,
    brief: bool,
    workers: Option<usize>,
    work: &mut (dyn FnMut(Option<usize>, Option<&AtomicBool>) + Send),
) -> PyResult<()> {
    if brief {
        py.detach(|| work(Some(1), None));
        return Ok(());
    }
    let workers = threads(workers);
    run_interruptible(py, workers, &mut |stop| {
        work(workers, Some(stop));
        Ok(())
    })
}

/// Allocates memory and frees it. Rust aborts the process if an allocation fails; this check raises
/// an exception first.
pub(crate) fn check_memory(bytes: usize) -> PyResult<()> {
    if bytes < SMALL {
        return Ok(());
    }
    let mut memory = Vec::<u8>::new();
    let found = memory.try_reserve_exact(bytes);
    // Otherwise the compiler could remove the unused allocation.
    black_box(&memory);
    found.map_err(|_| no_memory(bytes))
}

/// Reserves memory for `count` elements.
pub(crate) fn reserve<N>(array: &mut Vec<N>, count: usize) -> PyResult<()> {
    let bytes = count.saturating_mul(size_of::<N>());
    array.try_reserve_exact(count).map_err(|_| no_memory(bytes))
}

pub(crate) fn no_memory(bytes: usize) -> PyErr {
    PyMemoryError::new_err(format!("there is no room for {bytes} bytes"))
}
