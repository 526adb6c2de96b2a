//! A queue of work that the calling thread and threads of rayon's pool empty together.

use std::sync::{Mutex, PoisonError};

#[cfg(feature = "threads")]
use cardan_memory::{Ticket, lend};

/// How many threads share the work: one unless it `is_enough` for several, otherwise those of the
/// pool, of which at most `workers`. The pool, which may not exist, is not queried for one thread.
pub(crate) fn threads(is_enough: bool, workers: Option<usize>) -> usize {
    if !is_enough || workers == Some(1) {
        return 1;
    }
    #[cfg(feature = "threads")]
    let pool = rayon::current_num_threads();
    #[cfg(not(feature = "threads"))]
    let pool = 1;
    workers.map_or(pool, |workers| pool.min(workers.max(1)))
}

/// Calls `work` with every item and a state of the thread that runs it. The calling thread takes
/// part, so that it does not sleep while the pool wakes up, and at most `threads − 1` threads of
/// the pool help. Items are begun in order.
pub(crate) fn work_off<I, S>(
    items: I,
    threads: usize,
    state: impl Fn() -> S + Sync,
    work: impl Fn(&mut S, I::Item) + Sync,
) where
    I: Iterator + Send,
{
    let queue = Mutex::new(items);
    // Each item is taken in a statement of its own, which returns the lock before the work begins.
    let take = || queue.lock().unwrap_or_else(PoisonError::into_inner).next();
    let run = || {
        let Some(first) = take() else { return };
        let mut own = state();
        work(&mut own, first);
        while let Some(item) = take() {
            work(&mut own, item);
        }
    };
    #[cfg(feature = "threads")]
    if threads > 1 {
        lend(&run, |ticket| {
            call_for_help(ticket, threads - 1);
            run();
        });
        return;
    }
    // This does not touch the pool, which may not exist.
    let _ = threads;
    run();
}

/// Asks so many threads of the pool to help. Each of them wakes half of those that are left, so that
/// the time until the last one begins grows with the logarithm of their number. Nobody waits for one
/// that comes after the queue is empty.
#[cfg(feature = "threads")]
fn call_for_help(ticket: &Ticket, helpers: usize) {
    let mut left = helpers;
    while left > 0 {
        let others = left / 2;
        let ticket = ticket.clone();
        rayon::spawn(move || {
            if ticket.is_open() {
                call_for_help(&ticket, others);
                ticket.work();
            }
        });
        left -= 1 + others;
    }
}

#[cfg(all(test, feature = "threads"))]
mod tests {
    use std::panic::{AssertUnwindSafe, catch_unwind};
    use std::sync::atomic::{AtomicUsize, Ordering};

    use super::*;

    /// How often each of 1000 items was run, and by how many threads.
    fn counts(threads: usize) -> (Vec<usize>, usize) {
        let mut items = vec![0; 1000];
        let states = AtomicUsize::new(0);
        let state = || {
            states.fetch_add(1, Ordering::Relaxed);
        };
        work_off(items.iter_mut(), threads, state, |(), item| *item += 1);
        (items, states.into_inner())
    }

    #[test]
    fn every_item_is_run_once_by_at_most_so_many_threads() {
        for threads in [0, 1, 2, 3, 4, 7, 16] {
            let (items, states) = counts(threads);
            assert_eq!(items, vec![1; 1000]);
            assert!((1..=threads.max(1)).contains(&states), "{states} of {threads}");
        }
    }

    #[test]
    fn all_helpers_come() {
        // Each item waits for all others: only as many threads as items can run them.
        let pool = rayon::ThreadPoolBuilder::new().num_threads(6).build().unwrap();
        pool.install(|| {
            let ready = std::sync::Barrier::new(6);
            work_off(0..6, 6, || (), |(), _| _ = ready.wait());
        });
    }

    #[test]
    fn a_job_of_the_pool_may_ask_for_help() {
        let jobs = || rayon::scope(|_| rayon::join(|| counts(3).0, || counts(3).0));
        let results: Vec<_> = std::thread::scope(|scope| {
            let callers: Vec<_> = (0..4).map(|_| scope.spawn(jobs)).collect();
            callers.into_iter().map(|caller| caller.join().unwrap()).collect()
        });
        assert!(results.iter().all(|(one, other)| one == other && one.iter().all(|&n| n == 1)));
    }

    #[test]
    fn items_are_begun_in_order() {
        let last = AtomicUsize::new(0);
        work_off(
            (0..1000).inspect(|&i| assert_eq!(last.swap(i, Ordering::Relaxed), i.max(1) - 1)),
            3,
            || (),
            |(), _| (),
        );
    }

    #[test]
    fn a_panic_reaches_the_caller() {
        for threads in [1, 3] {
            let run = AtomicUsize::new(0);
            let work = |(): &mut (), i: usize| {
                assert_ne!(i, 500);
                run.fetch_add(1, Ordering::Relaxed);
            };
            let caught = catch_unwind(AssertUnwindSafe(|| work_off(0..1000, threads, || (), work)));
            assert!(caught.is_err());
            // What was taken before was run.
            assert!(run.into_inner() >= 500);
        }
    }
}
