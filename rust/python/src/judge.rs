//! What is within its limits.

use cardan::check_length;
use cardan::judge::{Limit, Side};
use numpy::{IntoPyArray, PyArray1};
use pyo3::prelude::*;

use crate::convert::{Input, OrRaise, slice};

/// The ranks of figures beside their limits and maxima: 0 not judged, 1 within, 2 tolerable, 3 beyond.
/// The size of what is judged counts for limits that are nearer to 0.
#[pyfunction]
pub(crate) fn ranks<'py>(
    py: Python<'py>,
    values: Input<'py>,
    limits: Input<'py>,
    maxima: Input<'py>,
    most: bool,
    size: f64,
) -> PyResult<Bound<'py, PyArray1<i64>>> {
    let [values, limits, maxima] =
        [slice("values", &values)?, slice("limits", &limits)?, slice("maxima", &maxima)?];
    check_length("limits", limits.len(), values.len(), 1).or_raise()?;
    check_length("maxima", maxima.len(), values.len(), 1).or_raise()?;
    let side = if most { Side::Most } else { Side::Least };
    let rank = |((&value, &limit), &maximum): ((&f64, &f64), &f64)| {
        Limit { limit, maximum, side, size }.rank(value) as i64
    };
    let found: Vec<i64> = values.iter().zip(limits).zip(maxima).map(rank).collect();
    Ok(found.into_pyarray(py))
}
