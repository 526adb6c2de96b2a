//! Work lent to threads that may come late.
//!
//! A thread of a pool begins tens of microseconds after it is asked, and sometimes after the work is
//! done. A scope would wait for it all the same. Here it finds the loan closed and goes, so that the
//! lender waits only for those who have begun.

use std::any::Any;
use std::hint::spin_loop;
use std::mem::transmute;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};

/// How often the lender looks whether the last borrower has finished, before it sleeps: some
/// microseconds, less than a thread needs to wake up.
const LOOKS: usize = 200;

/// Admission to work that is lent, for one thread or for several.
#[derive(Clone)]
pub struct Ticket(Arc<Loan>);

struct Loan {
    terms: Mutex<Terms>,
    borrowers: AtomicUsize,
    finished: Condvar,
}

struct Terms {
    /// None once the loan is closed.
    work: Option<&'static (dyn Fn() + Sync)>,
    panic: Option<Box<dyn Any + Send>>,
}

impl Loan {
    fn terms(&self) -> MutexGuard<'_, Terms> {
        self.terms.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Ticket {
    /// Whether the work is still lent.
    pub fn is_open(&self) -> bool {
        self.0.terms().work.is_some()
    }

    /// Does the work, unless the loan is closed. Returns whether it did. A panic of the work reaches the
    /// lender.
    pub fn work(&self) -> bool {
        let Self(loan) = self;
        let terms = loan.terms();
        let Some(work) = terms.work else { return false };
        // Under the lock, so that the lender either sees this borrower or has closed the loan before.
        loan.borrowers.fetch_add(1, Ordering::Relaxed);
        drop(terms);
        if let Err(panic) = catch_unwind(AssertUnwindSafe(work)) {
            loan.terms().panic.get_or_insert(panic);
        }
        if loan.borrowers.fetch_sub(1, Ordering::Release) == 1 {
            // The lender holds the lock from its last look until it sleeps.
            drop(loan.terms());
            loan.finished.notify_one();
        }
        true
    }
}

/// Lends `work` while `body` runs. Tickets may outlive the loan. It is closed when `body` returns or
/// unwinds, and this function returns when everyone who began to work has finished.
///
/// # Panics
/// If the work panics in another thread.
pub fn lend<R>(work: &(dyn Fn() + Sync), body: impl FnOnce(&Ticket) -> R) -> R {
    struct Closing<'a>(&'a Loan);
    impl Drop for Closing<'_> {
        fn drop(&mut self) {
            let Self(loan) = *self;
            loan.terms().work = None;
            let works = || loan.borrowers.load(Ordering::Acquire) > 0;
            for _ in 0..LOOKS {
                if !works() {
                    return;
                }
                spin_loop();
            }
            let mut terms = loan.terms();
            while works() {
                terms = loan.finished.wait(terms).unwrap_or_else(PoisonError::into_inner);
            }
        }
    }
    // SAFETY: only borrowers copy the reference out of the loan, and each has returned from the work
    // before it is counted off. `Closing` removes the reference and then waits until all are counted
    // off, before this function returns or unwinds, while the work is still borrowed.
    #[expect(unsafe_code, reason = "threads of a pool outlive what they are lent")]
    let work = unsafe { transmute::<&(dyn Fn() + Sync), &'static (dyn Fn() + Sync)>(work) };
    let terms = Mutex::new(Terms { work: Some(work), panic: None });
    let ticket =
        Ticket(Arc::new(Loan { terms, borrowers: AtomicUsize::new(0), finished: Condvar::new() }));
    let closing = Closing(&ticket.0);
    let result = body(&ticket);
    drop(closing);
    let panic = ticket.0.terms().panic.take();
    if let Some(panic) = panic {
        resume_unwind(panic);
    }
    result
}

#[cfg(test)]
mod tests {
    use std::thread;
    use std::time::Duration;

    use super::*;

    fn counting(count: &AtomicUsize) -> impl Fn() + Sync {
        || _ = count.fetch_add(1, Ordering::Relaxed)
    }

    #[test]
    fn whoever_comes_in_time_works() {
        let count = AtomicUsize::new(0);
        lend(&counting(&count), |ticket| {
            let helpers = [(); 3].map(|()| {
                let ticket = ticket.clone();
                thread::spawn(move || ticket.work())
            });
            assert!(helpers.map(|helper| helper.join().unwrap()).iter().all(|&works| works));
        });
        assert_eq!(count.into_inner(), 3);
    }

    #[test]
    fn whoever_comes_late_finds_the_loan_closed() {
        let count = AtomicUsize::new(0);
        let ticket = lend(&counting(&count), Ticket::clone);
        assert!(!ticket.is_open());
        assert!(!thread::spawn(move || ticket.work()).join().unwrap());
        assert_eq!(count.into_inner(), 0);
    }

    #[test]
    fn the_lender_waits_for_whoever_has_begun() {
        for pause in [0, 20] {
            let [begun, done] = [(); 2].map(|()| AtomicUsize::new(0));
            let work = || {
                begun.store(1, Ordering::Relaxed);
                thread::sleep(Duration::from_millis(pause));
                done.store(1, Ordering::Relaxed);
            };
            let helper = lend(&work, |ticket| {
                let ticket = ticket.clone();
                let helper = thread::spawn(move || ticket.work());
                while begun.load(Ordering::Relaxed) == 0 {
                    spin_loop();
                }
                helper
            });
            assert_eq!(done.into_inner(), 1);
            assert!(helper.join().unwrap());
        }
    }

    #[test]
    fn a_panic_of_either_side_ends_the_loan_first() {
        let helped = |ticket: &Ticket| {
            let ticket = ticket.clone();
            thread::spawn(move || ticket.work()).join().unwrap()
        };
        let of_work = catch_unwind(|| lend(&|| panic!("of the work"), helped)).unwrap_err();
        assert_eq!(of_work.downcast_ref(), Some(&"of the work"));
        let kept = Mutex::new(None);
        let of_body = catch_unwind(AssertUnwindSafe(|| {
            lend(&|| (), |ticket| {
                *kept.lock().unwrap() = Some(ticket.clone());
                panic!("of the body");
            })
        }));
        assert_eq!(of_body.unwrap_err().downcast_ref(), Some(&"of the body"));
        assert!(!kept.into_inner().unwrap().unwrap().is_open());
    }
}
