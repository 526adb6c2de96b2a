//! Conversions between `numpy` arrays and slices, and from the core's errors to Python's.

use cardan::{Error, Problem, Vector};
use numpy::{Element, PyReadonlyArray1, PyReadwriteArray1};
use pyo3::exceptions::PyMemoryError;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyTuple, PyType};

/// A flat read-only array of doubles.
pub(crate) type Input<'py> = PyReadonlyArray1<'py, f64>;

/// The elements of a contiguous array.
pub(crate) fn slice<'a, N: Element>(
    name: &'static str,
    array: &'a PyReadonlyArray1<'_, N>,
) -> PyResult<&'a [N]> {
    array.as_slice().map_err(|_| not_contiguous(name))
}

/// The elements of a contiguous array, for writing.
pub(crate) fn slice_mut<'a, W: Element>(
    name: &'static str,
    array: &'a mut PyReadwriteArray1<'_, W>,
) -> PyResult<&'a mut [W]> {
    array.as_slice_mut().map_err(|_| not_contiguous(name))
}

pub(crate) fn not_contiguous(name: &'static str) -> PyErr {
    argument_error(name, "must be contiguous and aligned")
}

/// The exception for an argument that breaks a rule.
pub(crate) fn argument_error(argument: &'static str, problem: impl Into<Problem>) -> PyErr {
    value_error(&Error::new(argument, &[], problem))
}

/// A core error as `cardan.ArgumentValueError`, which has the same fields.
pub(crate) fn value_error(error: &Error) -> PyErr {
    static CLASS: PyOnceLock<Py<PyType>> = PyOnceLock::new();
    Python::attach(|py| {
        let class = CLASS.import(py, "cardan", "ArgumentValueError")?;
        let place = PyTuple::new(py, &error.place.0)?.unbind();
        let (value, unit, rule) = match error.problem {
            Problem::Value { value, rule } => (Some(value), rule.unit, rule.text),
            Problem::Words(_) => (None, "", ""),
        };
        let fields = (error.argument, error.problem.to_string(), place, value, unit, rule);
        Ok(PyErr::from_type(class.clone(), fields))
    })
    .unwrap_or_else(|error| error)
}

/// The result of the core with its error as an exception.
pub(crate) trait OrRaise<T> {
    fn or_raise(self) -> PyResult<T>;
}

impl<T> OrRaise<T> for cardan::Result<T> {
    fn or_raise(self) -> PyResult<T> {
        self.map_err(|error| value_error(&error))
    }
}

/// The number of elements of a shape.
pub(crate) fn count(shape: &[usize]) -> PyResult<usize> {
    let product = shape.iter().try_fold(1_usize, |count, &length| count.checked_mul(length));
    product.ok_or_else(|| PyMemoryError::new_err(format!("{shape:?} is more than can be counted")))
}

/// Vectors from triples of components.
pub(crate) fn vectors(flat: &[f64]) -> Vec<Vector> {
    flat.chunks_exact(3).map(Vector::from_column_slice).collect()
}
