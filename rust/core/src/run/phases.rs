//! The phases closest to constant velocity for a batch of drivelines, on several threads.

use std::sync::atomic::AtomicBool;

use crate::mechanics::phasing::{is_set, search_phases, search_phases_inlined};
use crate::run::execution::Execution;
use crate::run::level::{Level, compiled_up_to_avx2};
use crate::run::queue::{threads, work_off};

/// The number of drivelines in a piece of work for one thread, and the fewest pieces that use
/// threads.
const PIECE: usize = 64;
const MIN_PARALLEL_PIECES: usize = 16;

/// [`crate::mechanics::phasing::optimal_phases`] for a batch of drivelines with `joints` joints
/// each, `bends` `(…, joints)` and `twists` and `phases` `(…, joints − 1)` in rad. The results
/// replace the phases.
pub fn optimal_phases_of_batch(
    joints: usize,
    bends: &[f64],
    twists: &[f64],
    phases: &mut [f64],
    execution: Execution<'_>,
) {
    let between = joints.saturating_sub(1);
    if between == 0 {
        return;
    }
    let Execution { level, workers, stop, .. } = execution;
    let level = level.unwrap_or_else(Level::new);
    let run = |(): &mut (), (i, phases): (usize, &mut [f64])| {
        let lines = phases.chunks_mut(between).zip(twists.chunks(between).skip(i * PIECE));
        for ((phases, twists), bends) in lines.zip(bends.chunks(joints).skip(i * PIECE)) {
            if !is_set(stop) {
                phases.copy_from_slice(&search(level, bends, twists, phases, stop));
            }
        }
    };
    let size = PIECE.saturating_mul(between);
    let pieces = phases.len().div_ceil(size);
    let threads = threads(pieces >= MIN_PARALLEL_PIECES, workers);
    work_off(phases.chunks_mut(size).enumerate(), threads, || (), run);
}

/// The phases of one driveline.
#[inline(never)]
fn search(
    level: Level,
    bends: &[f64],
    twists: &[f64],
    phases: &[f64],
    stop: Option<&AtomicBool>,
) -> Vec<f64> {
    compiled_up_to_avx2!(level, (compact, _stores) => if compact {
        search_phases(bends, twists, phases, stop)
    } else {
        search_phases_inlined(bends, twists, phases, stop, false)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    use crate::mechanics::phasing::optimal_phases;

    #[test]
    fn threads_share_a_batch() {
        let all = |each: usize, step: f64| -> Vec<f64> {
            (0..2500 * each).map(|i| 0.1 + step * i as f64).collect()
        };
        let (bends, twists) = (all(3, 1e-4), all(2, -3e-4));
        let given = all(2, 2e-4);
        let run = |workers: Option<usize>, stop: Option<&AtomicBool>| {
            let mut phases = given.clone();
            let execution = Execution { workers, stop, ..Execution::default() };
            optimal_phases_of_batch(3, &bends, &twists, &mut phases, execution);
            phases
        };
        let alone = run(Some(1), None);
        assert_eq!(alone[4998..], optimal_phases(&bends[7497..], &twists[4998..], &given[4998..]));
        assert_eq!(alone, run(None, None));
        assert_eq!(alone, run(Some(2), Some(&AtomicBool::new(false))));
        assert_eq!(given, run(None, Some(&AtomicBool::new(true))));
    }
}
