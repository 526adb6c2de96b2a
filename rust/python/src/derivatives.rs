//! Derivatives of the transmissions of a batch of drivelines.

use std::sync::atomic::AtomicBool;

use cardan::{Execution, Parameters, q_derivatives};
use numpy::{Complex64, IntoPyArray, PyArray1};
use pyo3::exceptions::PyIndexError;
use pyo3::prelude::*;

use crate::convert::argument_error;
use crate::lines::Lines;
use crate::watch::{reserve, run_interruptible, threads};

/// The fewest joints in all that are interruptible.
const MIN_INTERRUPTIBLE: usize = 1 << 14;

/// The derivatives of `q` of a shaft by all `"bends"`, `"twists"`, `"phases"` or `"points"` of each
/// driveline, one driveline after another.
#[pyfunction]
pub(crate) fn dq<'py>(
    py: Python<'py>,
    lines: &Lines,
    shaft: usize,
    by: &str,
    workers: Option<usize>,
) -> PyResult<Bound<'py, PyArray1<Complex64>>> {
    let joints = lines.joints();
    if shaft > joints {
        let problem = format!("shaft is {shaft}; there are {}", joints + 1);
        return Err(PyIndexError::new_err(problem));
    }
    let by = parameters(by)?;
    lines.with(py, |lines| {
        let count = lines.bends.len() / joints;
        if by == Parameters::Points && lines.lengths.len() != count * (joints + 1) {
            return Err(argument_error("by", &[], "is \"points\"; the shafts have no lengths"));
        }
        let mut out = vec![];
        reserve(&mut out, count.saturating_mul(by.count(joints)))?;
        out.resize(count * by.count(joints), Complex64::default());
        let brief = lines.bends.len() < MIN_INTERRUPTIBLE;
        let workers = if brief { Some(1) } else { threads(workers) };
        let mut run = |stop: Option<&AtomicBool>| {
            let execution = Execution { workers, stop, ..Execution::default() };
            q_derivatives(joints, shaft, by, &lines, &mut out, execution);
        };
        if brief {
            py.detach(|| run(None));
        } else {
            run_interruptible(py, workers, &mut |stop| {
                run(Some(stop));
                Ok(())
            })?;
        }
        Ok(out.into_pyarray(py))
    })
}

fn parameters(name: &str) -> PyResult<Parameters> {
    match name {
        "bends" => Ok(Parameters::Bends),
        "twists" => Ok(Parameters::Twists),
        "phases" => Ok(Parameters::Phases),
        "points" => Ok(Parameters::Points),
        other => Err(argument_error("by", &[], format!("is {other:?}, which is unknown"))),
    }
}
