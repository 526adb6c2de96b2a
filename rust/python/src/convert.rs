//! Between `numpy` arrays and slices, and from the core's errors to Python's.

use cardan::{Error, Vector};
use numpy::{Element, PyReadonlyArray1, PyReadwriteArray1};
use pyo3::exceptions::{PyMemoryError, PyValueError};
use pyo3::prelude::*;

/// A flat array of doubles to read.
pub(crate) type Input<'py> = PyReadonlyArray1<'py, f64>;

/// The elements of a contiguous array.
pub(crate) fn slice<'a, N: Element>(
    name: &str,
    array: &'a PyReadonlyArray1<'_, N>,
) -> PyResult<&'a [N]> {
    array.as_slice().map_err(|_| not_contiguous(name))
}

/// The elements of a contiguous array, to fill.
pub(crate) fn slice_mut<'a, W: Element>(
    name: &str,
    array: &'a mut PyReadwriteArray1<'_, W>,
) -> PyResult<&'a mut [W]> {
    array.as_slice_mut().map_err(|_| not_contiguous(name))
}

pub(crate) fn not_contiguous(name: &str) -> PyErr {
    PyValueError::new_err(format!("{name} must be contiguous and aligned"))
}

/// A core error as `ValueError`.
pub(crate) fn value_error(error: &Error) -> PyErr {
    PyValueError::new_err(error.to_string())
}

/// The number of elements of a shape.
pub(crate) fn count(shape: &[usize]) -> PyResult<usize> {
    let product = shape.iter().try_fold(1_usize, |count, &length| count.checked_mul(length));
    product.ok_or_else(|| PyMemoryError::new_err(format!("{shape:?} is more than can be counted")))
}

/// Refuses a flat array that does not hold `each` values for each of so many drivelines.
pub(crate) fn check_length(name: &str, found: usize, lines: usize, each: usize) -> PyResult<()> {
    if lines.checked_mul(each) == Some(found) {
        return Ok(());
    }
    let problem = format!("{name} has {found} values; {lines} drivelines need {each} each");
    Err(PyValueError::new_err(problem))
}

/// The index of one driveline in a batch of the given shape.
pub(crate) fn unravel(mut flat: usize, shape: &[usize]) -> Vec<usize> {
    let mut index = vec![0; shape.len()];
    for (place, &length) in index.iter_mut().zip(shape).rev() {
        *place = flat % length.max(1);
        flat /= length.max(1);
    }
    index
}

/// Triples of components as vectors.
pub(crate) fn vectors(flat: &[f64]) -> Vec<Vector> {
    flat.chunks_exact(3).map(Vector::from_column_slice).collect()
}
