//! The phases closest to constant velocity: of each driveline, and one setting for several states.

use cardan::{
    Error, Execution, States, check_length, common_phases_of_batch, optimal_phases_of_batch,
};
use numpy::{IntoPyArray, PyArray1};
use pyo3::prelude::*;

use crate::convert::{Input, OrRaise, argument_error, slice, value_error};
use crate::driveline::count_of;
use crate::watch::{check_memory, reserve, run_released};

/// The fewest joints in all for which the search for phases is interruptible, of each driveline
/// alone and for states together: some milliseconds of work.
const MIN_INTERRUPTIBLE: usize = 1 << 10;
const MIN_INTERRUPTIBLE_STATES: usize = 1 << 5;

/// The phases that bring each driveline's last shaft closest to constant velocity.
#[pyfunction]
#[pyo3(signature = (joints, bends, twists, phases, workers))]
pub(crate) fn optimal_phases<'py>(
    py: Python<'py>,
    joints: usize,
    bends: Input<'py>,
    twists: Input<'py>,
    phases: Input<'py>,
    workers: Option<usize>,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let [bends, twists, phases] = geometry(joints, &bends, &twists, &phases)?;
    let mut best = vec![];
    reserve(&mut best, phases.len())?;
    best.extend_from_slice(phases);
    let brief = bends.len() < MIN_INTERRUPTIBLE;
    run_released(py, brief, workers, &mut |workers, stop| {
        let execution = Execution { workers, stop, ..Execution::default() };
        optimal_phases_of_batch(joints, bends, twists, &mut best, execution);
    })?;
    Ok(best.into_pyarray(py))
}

/// One setting for the states of each driveline of a batch. The states of a driveline follow one
/// another, and there is one weight for each; `held` and `teeth`, unless it is empty, have one
/// value for each intermediate shaft.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "those of the method and three arrays")]
pub(crate) fn common_phases<'py>(
    py: Python<'py>,
    joints: usize,
    bends: Input<'py>,
    twists: Input<'py>,
    phases: Input<'py>,
    weights: Input<'py>,
    held: Vec<bool>,
    teeth: Vec<u64>,
    workers: Option<usize>,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let [bends, twists, phases] = geometry(joints, &bends, &twists, &phases)?;
    let weights = slice("weights", &weights)?;
    let Some(lines) = (bends.len() / joints).checked_div(weights.len()) else {
        return Err(argument_error("weights", "is empty; there is at least one state"));
    };
    check_length("bends", bends.len(), lines * weights.len(), joints).or_raise()?;
    check_length("held", held.len(), 1, joints - 1).or_raise()?;
    if !teeth.is_empty() {
        check_length("teeth", teeth.len(), 1, joints - 1).or_raise()?;
    }
    if let Some(place) = teeth.iter().position(|&teeth| teeth == 0) {
        let problem = "is 0; a spline has at least 1 tooth";
        return Err(value_error(&Error::new("teeth", &[place], problem)));
    }
    // The result and, on each thread, some matrices of second derivatives.
    check_memory(lines.saturating_mul(joints).saturating_mul(size_of::<f64>()))?;
    check_memory(joints.saturating_mul(joints).saturating_mul(8 * size_of::<f64>()))?;
    let states = States { joints, bends, twists, phases, weights, held: &held, teeth: &teeth };
    let (mut found, brief) = (vec![], bends.len() < MIN_INTERRUPTIBLE_STATES);
    run_released(py, brief, workers, &mut |workers, stop| {
        let execution = Execution { workers, stop, ..Execution::default() };
        found = common_phases_of_batch(&states, execution);
    })?;
    Ok(found.into_pyarray(py))
}

/// Bends, twists and phases, of which each driveline has as many as its joints need.
fn geometry<'a>(
    joints: usize,
    bends: &'a Input<'_>,
    twists: &'a Input<'_>,
    phases: &'a Input<'_>,
) -> PyResult<[&'a [f64]; 3]> {
    let bends = slice("bends", bends)?;
    let twists = slice("twists", twists)?;
    let phases = slice("phases", phases)?;
    let lines = count_of(bends, joints)?;
    check_length("bends", bends.len(), lines, joints).or_raise()?;
    check_length("twists", twists.len(), lines, joints - 1).or_raise()?;
    check_length("phases", phases.len(), lines, joints - 1).or_raise()?;
    Ok([bends, twists, phases])
}
