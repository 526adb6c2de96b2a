//! The routes that runs of a test have taken.

use std::cell::RefCell;
use std::collections::BTreeSet;

use crate::number::atan::AtanRange;
use crate::plan::route::Route;

thread_local! {
    static TAKEN: RefCell<BTreeSet<(usize, Route, AtanRange)>> = const { RefCell::new(BTreeSet::new()) };
}

/// Notes the route of a shaft at a chunk.
pub(crate) fn note(shaft: usize, route: Route, range: AtanRange) {
    TAKEN.with_borrow_mut(|taken| taken.insert((shaft, route, range)));
}

/// The routes noted on this thread since the last call.
pub(crate) fn take() -> Vec<(usize, Route, AtanRange)> {
    TAKEN.take().into_iter().collect()
}
