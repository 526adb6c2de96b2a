//! Conversions between `numpy` arrays and slices, and from the core's errors to Python's.

use cardan::{Error, Vector};
use numpy::{Element, PyReadonlyArray1, PyReadwriteArray1};
use pyo3::exceptions::PyMemoryError;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyTuple, PyType};

/// A flat read-only array of doubles.
pub(crate) type Input<'py> = PyReadonlyArray1<'py, f64>;

/// The elements of a contiguous array.
pub(crate) fn slice<'a, N: Element>(
    name: &str,
    array: &'a PyReadonlyArray1<'_, N>,
) -> PyResult<&'a [N]> {
    array.as_slice().map_err(|_| not_contiguous(name))
}

/// The elements of a contiguous array, for writing.
pub(crate) fn slice_mut<'a, W: Element>(
    name: &str,
    array: &'a mut PyReadwriteArray1<'_, W>,
) -> PyResult<&'a mut [W]> {
    array.as_slice_mut().map_err(|_| not_contiguous(name))
}

pub(crate) fn not_contiguous(name: &str) -> PyErr {
    argument_error(name, &[], "must be contiguous and aligned")
}

/// The exception for an argument that breaks a rule. The Python class has the same fields as the
/// core's error.
pub(crate) fn argument_error(argument: &str, place: &[usize], problem: impl Into<String>) -> PyErr {
    static CLASS: PyOnceLock<Py<PyType>> = PyOnceLock::new();
    Python::attach(|py| {
        let class = CLASS.import(py, "cardan.errors", "ArgumentValueError")?;
        let place = PyTuple::new(py, place)?.unbind();
        Ok(PyErr::from_type(class.clone(), (argument.to_owned(), problem.into(), place)))
    })
    .unwrap_or_else(|error| error)
}

/// A core error as `cardan.ArgumentValueError`.
pub(crate) fn value_error(error: &Error) -> PyErr {
    argument_error(error.argument, &error.place.0, error.problem.as_str())
}

/// The number of elements of a shape.
pub(crate) fn count(shape: &[usize]) -> PyResult<usize> {
    let product = shape.iter().try_fold(1_usize, |count, &length| count.checked_mul(length));
    product.ok_or_else(|| PyMemoryError::new_err(format!("{shape:?} is more than can be counted")))
}

/// Checks that a flat array holds `each` values for each of `count` drivelines.
pub(crate) fn check_length(name: &str, found: usize, lines: usize, each: usize) -> PyResult<()> {
    if lines.checked_mul(each) == Some(found) {
        return Ok(());
    }
    let problem = format!("has {found} values; {lines} drivelines need {each} each");
    Err(argument_error(name, &[], problem))
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

/// Vectors from triples of components.
pub(crate) fn vectors(flat: &[f64]) -> Vec<Vector> {
    flat.chunks_exact(3).map(Vector::from_column_slice).collect()
}
