//! Work for each row, on several threads if there are many.

use std::sync::OnceLock;
use std::sync::atomic::Ordering;

use crate::error::{Error, Result};
use crate::run::execution::Execution;
use crate::run::queue::work_off;

/// The rows of a piece of work for one thread, and the fewest pieces that use threads.
pub(crate) const PIECE: usize = 32;
const MIN_PARALLEL_PIECES: usize = 4;

/// Calls `work` with the first row of every piece and the piece's part of `out`, which has `each`
/// elements for each row. The first error ends nothing but is returned.
pub(crate) fn each_piece<N: Send>(
    out: &mut [N],
    each: usize,
    execution: Execution<'_>,
    work: impl Fn(usize, &mut [N]) -> Result<()> + Sync,
) -> Result<()> {
    let failed = OnceLock::new();
    let pieces = out.chunks_mut((PIECE * each).max(1)).enumerate();
    let run = |(): &mut (), (piece, out): (usize, &mut [N])| {
        if execution.stop.is_none_or(|stop| !stop.load(Ordering::Relaxed))
            && let Err(error) = work(piece * PIECE, out)
        {
            failed.get_or_init(|| error);
        }
    };
    // The pool, which may not exist, is not queried for one thread.
    let alone = execution.workers == Some(1) || pieces.len() < MIN_PARALLEL_PIECES;
    let pool = if alone { 1 } else { rayon::current_num_threads() };
    let threads = execution.workers.map_or(pool, |workers| pool.min(workers));
    work_off(pieces, threads, || (), run);
    failed.into_inner().map_or(Ok(()), Err::<(), Error>)
}

/// The same row by row.
pub(crate) fn each_row<N: Send>(
    out: &mut [N],
    each: usize,
    execution: Execution<'_>,
    work: impl Fn(usize, &mut [N]) -> Result<()> + Sync,
) -> Result<()> {
    each_piece(out, each, execution, |first, out| {
        out.chunks_mut(each.max(1)).enumerate().try_for_each(|(i, out)| work(first + i, out))
    })
}
