//! The motion of a measured drive.

use cardan::measured::{Integral, derivatives};
use cardan::{Level, check_length};
use numpy::{IntoPyArray, PyArray1};
use pyo3::prelude::*;

use crate::convert::{Input, OrRaise, argument_error, slice};
use crate::watch::reserve;

/// The integral of a signal over time by the trapezoidal rule, which is exact for a ramp.
///
/// It takes samples in pieces, and its bits are the same for any pieces: the sum of the steps has an
/// error term. Missing samples are bridged.
#[pyclass(name = "Integral", module = "cardan._core")]
pub(crate) struct NativeIntegral(Integral);

#[pymethods]
impl NativeIntegral {
    #[new]
    fn new(start: f64) -> Self {
        Self(Integral::new(start))
    }

    /// Return the integral at the samples of the next piece, `(samples,)`.
    ///
    /// It is NaN where a sample is missing: where its time or its value is NaN.
    fn at<'py>(
        &mut self,
        py: Python<'py>,
        time: Input<'py>,
        values: Input<'py>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let (time, values) = (slice("time", &time)?, slice("values", &values)?);
        check_length("values", values.len(), time.len(), 1).or_raise()?;
        let mut integral = zeros(time.len())?;
        py.detach(|| self.0.extend(time, values, &mut integral));
        Ok(integral.into_pyarray(py))
    }
}

/// First and second derivative of a signal over time at the rows from `begin` to `end`.
#[pyfunction]
#[allow(clippy::type_complexity, reason = "a pair of arrays")]
pub(crate) fn derivatives_at<'py>(
    py: Python<'py>,
    time: Input<'py>,
    values: Input<'py>,
    reach: usize,
    begin: usize,
    end: usize,
) -> PyResult<(Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>)> {
    let (time, values) = (slice("time", &time)?, slice("values", &values)?);
    check_length("values", values.len(), time.len(), 1).or_raise()?;
    if begin > end || end > time.len() {
        return Err(argument_error("end", "is not a row of the signal"));
    }
    let (mut first, mut second) = (zeros(end - begin)?, zeros(end - begin)?);
    py.detach(|| {
        derivatives(Level::new(), time, values, reach, begin..end, [&mut first, &mut second]);
    });
    Ok((first.into_pyarray(py), second.into_pyarray(py)))
}

fn zeros(length: usize) -> PyResult<Vec<f64>> {
    let mut numbers = vec![];
    reserve(&mut numbers, length)?;
    numbers.resize(length, 0.0);
    Ok(numbers)
}
