//! One setting of the yokes for the states of each driveline of a batch, on several threads.

use crate::mechanics::common_phases::States;
use crate::mechanics::phasing::is_set;
use crate::run::execution::Execution;
use crate::run::queue::{threads, work_off};

/// One setting for the states of each driveline of a batch, in rad, `(…, joints − 1)`: the one that
/// minimises the weighted mean of `|q|²` over the states. Of settings that are as good it is the one
/// that turns the yokes least from the present phases of the first state.
///
/// ```
/// let states = cardan::States {
///     joints: 3,
///     bends: &[0.2, 0.15, 0.1, 0.25, 0.2, 0.1],
///     twists: &[0.0; 4],
///     phases: &[0.0; 4],
///     weights: &[0.5, 0.5],
///     held: &[false, false],
///     teeth: &[16, 16],
/// };
/// let phases = cardan::common_phases_of_batch(&states, cardan::Execution::default());
/// let teeth = phases.iter().map(|phase| phase * 16.0 / std::f64::consts::TAU);
/// assert!(teeth.map(|teeth| (teeth - teeth.round()).abs()).all(|off| off < 1e-12));
/// ```
pub fn common_phases_of_batch(states: &States<'_>, execution: Execution<'_>) -> Vec<f64> {
    let between = states.between();
    let of_line = states.weights.len() * between;
    if of_line == 0 {
        return vec![];
    }
    let lines = states.phases.len() / of_line;
    let mut found = vec![0.0; lines * between];
    let Execution { workers, stop, .. } = execution;
    let run = |(): &mut (), (line, out): (usize, &mut [f64])| {
        if !is_set(stop) {
            out.copy_from_slice(&states.of_line(line).search(stop));
        }
    };
    let threads = threads(lines > 1, workers);
    work_off(found.chunks_mut(between).enumerate(), threads, || (), run);
    found
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::AtomicBool;

    use super::*;

    #[test]
    fn threads_share_a_batch() {
        let all = |each: usize, step: f64| -> Vec<f64> {
            (0..10 * each).map(|i| 0.1 + step * i as f64).collect()
        };
        let (bends, twists, phases) = (all(6, 3e-3), all(4, -0.3), all(4, 0.2));
        let states = States {
            joints: 3,
            bends: &bends,
            twists: &twists,
            phases: &phases,
            weights: &[0.3, 0.7],
            held: &[false; 2],
            teeth: &[],
        };
        let run = |workers: Option<usize>, stop: Option<&AtomicBool>| {
            common_phases_of_batch(&states, Execution { workers, stop, ..Execution::default() })
        };
        let alone = run(Some(1), None);
        assert_eq!(alone[18..], states.of_line(9).search(None));
        assert_eq!(alone, run(None, None));
        assert_eq!(alone, run(Some(2), Some(&AtomicBool::new(false))));
        assert_eq!(vec![0.0; 20], run(None, Some(&AtomicBool::new(true))));
        let one_joint = States { joints: 1, twists: &[], phases: &[], held: &[], ..states };
        assert!(common_phases_of_batch(&one_joint, Execution::default()).is_empty());
    }
}
