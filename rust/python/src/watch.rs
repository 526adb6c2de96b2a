//! Long work with the interpreter released: signals such as Ctrl-C are looked for meanwhile, and
//! memory is asked for before the core takes it.

use std::hint::black_box;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::thread;
use std::time::Duration;

use cardan::Result;
use pyo3::exceptions::PyMemoryError;
use pyo3::prelude::*;

use crate::convert::value_error;

/// How often signals are looked for.
const GLANCE: Duration = Duration::from_millis(50);

/// Memory that is there without asking: allocations of this size come from what the process has.
const SMALL: usize = 1 << 20;

/// At most so many threads: one where the pool cannot be made.
pub(crate) fn threads(workers: Option<usize>) -> Option<usize> {
    static POOL: OnceLock<bool> = OnceLock::new();
    let made = || rayon::ThreadPoolBuilder::new().build_global().is_ok();
    if workers == Some(1) || *POOL.get_or_init(made) { workers } else { Some(1) }
}

/// Runs work of some milliseconds or more on other threads, while this one, on which Python handles
/// signals, waits for it and for them. A signal whose handler raises sets the flag that the work
/// gets, and is raised when the work has ended.
pub(crate) fn watched(
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
            while end.recv_timeout(GLANCE) == Err(RecvTimeoutError::Timeout) {
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
            // Dropped at the end, however it comes.
            let _ended = ended;
            result = Some(work(&stop));
        };
        let raised = if workers == Some(1) {
            // Without the pool, which a forked process does not have.
            thread::scope(|scope| {
                thread::Builder::new().spawn_scoped(scope, job).ok().and_then(|_| wait())
            })
        } else {
            rayon::in_place_scope(|scope| {
                scope.spawn(|_| job());
                wait()
            })
        };
        // On this thread where there is no other.
        (result.unwrap_or_else(|| work(&stop)), raised)
    });
    match raised {
        Some(error) => Err(error),
        None => result.map_err(|error| value_error(&error)),
    }
}

/// Asks for memory and gives it back. Rust ends the process where there is none; this is how a call
/// finds out before.
pub(crate) fn room(bytes: usize) -> PyResult<()> {
    if bytes < SMALL {
        return Ok(());
    }
    let mut memory = Vec::<u8>::new();
    let found = memory.try_reserve_exact(bytes);
    // What nobody looks at the compiler would not ask for.
    black_box(&memory);
    found.map_err(|_| no_memory(bytes))
}

/// Makes room for so many elements.
pub(crate) fn reserve<N>(array: &mut Vec<N>, count: usize) -> PyResult<()> {
    let bytes = count.saturating_mul(size_of::<N>());
    array.try_reserve_exact(count).map_err(|_| no_memory(bytes))
}

pub(crate) fn no_memory(bytes: usize) -> PyErr {
    PyMemoryError::new_err(format!("there is no room for {bytes} bytes"))
}
