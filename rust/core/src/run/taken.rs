//! The routes that runs have taken, recorded for tests.

use std::cell::RefCell;
use std::collections::BTreeSet;

use crate::number::atan::AtanRange;
use crate::plan::route::Route;

thread_local! {
    static TAKEN: RefCell<BTreeSet<(usize, Route, AtanRange)>> =
        const { RefCell::new(BTreeSet::new()) };
}

/// Records the route of a shaft in a chunk.
pub(crate) fn note(shaft: usize, route: Route, range: AtanRange) {
    TAKEN.with_borrow_mut(|taken| taken.insert((shaft, route, range)));
}

/// The routes recorded on this thread since the last call.
pub(crate) fn take() -> Vec<(usize, Route, AtanRange)> {
    TAKEN.take().into_iter().collect()
}
