//! Records of numbers, one for each of many drivelines.

use std::sync::atomic::Ordering;

use crate::run::execution::Execution;
use crate::run::queue::{threads, work_off};

/// The number of records in a piece of work for one thread, and the fewest pieces that use threads.
const PIECE: usize = 256;
const MIN_PARALLEL_PIECES: usize = 8;

/// Calls `fill` with the number and the memory of every record of `size` numbers.
pub(crate) fn fill_records(
    size: usize,
    out: &mut [f64],
    execution: Execution<'_>,
    fill: impl Fn(usize, &mut [f64]) + Sync,
) {
    if size == 0 {
        return;
    }
    let Execution { workers, stop, .. } = execution;
    let run = |(): &mut (), (piece, records): (usize, &mut [f64])| {
        if stop.is_some_and(|stop| stop.load(Ordering::Relaxed)) {
            return;
        }
        for (i, record) in records.chunks_mut(size).enumerate() {
            fill(piece * PIECE + i, record);
        }
    };
    let piece = PIECE.saturating_mul(size);
    let threads = threads(out.len().div_ceil(piece) >= MIN_PARALLEL_PIECES, workers);
    work_off(out.chunks_mut(piece).enumerate(), threads, || (), run);
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::AtomicBool;

    use super::*;

    #[test]
    fn every_record_is_filled_with_its_number() {
        for (count, workers) in [(0, None), (1, Some(1)), (5000, None), (5000, Some(2))] {
            let mut out = vec![f64::NAN; 3 * count];
            let execution = Execution { workers, ..Execution::default() };
            fill_records(3, &mut out, execution, |i, record| {
                for (j, x) in record.iter_mut().enumerate() {
                    *x = (3 * i + j) as f64;
                }
            });
            assert!(out.iter().enumerate().all(|(i, &x)| x == i as f64));
        }
        fill_records(0, &mut [], Execution::default(), |_, _| unreachable!());
    }

    #[test]
    fn nothing_is_filled_after_a_stop() {
        let (mut out, stop) = (vec![0.0; 5000], AtomicBool::new(true));
        let execution = Execution { stop: Some(&stop), ..Execution::default() };
        fill_records(1, &mut out, execution, |_, record| record[0] = 1.0);
        assert!(out.iter().all(|&x| x == 0.0));
    }
}
