//! The flat arrays of a batch of drivelines, which plans read.

use cardan::{Batch, Drivelines};
use numpy::{PyArray1, PyArrayMethods};
use pyo3::prelude::*;

use crate::convert::{OrRaise, argument_error, count, slice};
use crate::watch::check_memory;

/// Bends, twists, phases, directions, normals, lengths of shafts, positions of bearings and
/// deviations.
enum Arrays {
    /// The values of one driveline, copied.
    One([Vec<f64>; 8]),
    /// The arrays of a batch, which never change.
    Batch([Py<PyArray1<f64>>; 8]),
}

/// A driveline or a batch of drivelines.
#[pyclass(frozen, module = "cardan._core")]
pub(crate) struct Lines {
    arrays: Arrays,
    batch: Batch,
}

#[pymethods]
impl Lines {
    /// Drivelines with `joints` joints, one or a batch of the given shape, from flat arrays. A
    /// batch keeps references to its arrays.
    #[new]
    fn new(
        py: Python<'_>,
        joints: usize,
        shape: Vec<usize>,
        arrays: [Bound<'_, PyArray1<f64>>; 8],
        bearings: Vec<usize>,
    ) -> PyResult<Self> {
        // The memory for the copies and the largest bends.
        check_memory(joints.saturating_mul(96))?;
        let one = count(&shape)? == 1;
        let arrays = Arrays::Batch(arrays.map(Bound::unbind));
        let (batch, copies) = arrays.with(py, |lines| {
            let batch = Batch::new(joints, &shape, &bearings, &lines).or_raise()?;
            Ok((batch, one.then(|| lines.arrays().map(<[f64]>::to_vec))))
        })?;
        Ok(Self { arrays: copies.map_or(arrays, Arrays::One), batch })
    }
}

impl Lines {
    /// Batch of drivelines for plans.
    pub(crate) fn batch(&self) -> &Batch {
        &self.batch
    }

    pub(crate) fn is_one(&self) -> bool {
        matches!(self.arrays, Arrays::One(_))
    }

    /// Runs `body` with the arrays.
    pub(crate) fn with<R>(
        &self,
        py: Python<'_>,
        body: impl FnOnce(Drivelines<'_>) -> PyResult<R>,
    ) -> PyResult<R> {
        self.arrays.with(py, body)
    }
}

impl Arrays {
    fn with<R>(
        &self,
        py: Python<'_>,
        body: impl FnOnce(Drivelines<'_>) -> PyResult<R>,
    ) -> PyResult<R> {
        match self {
            Self::One(own) => body(Drivelines::from_arrays(own.each_ref().map(Vec::as_slice))),
            Self::Batch(arrays) => {
                let borrowed = arrays.each_ref().map(|array| array.bind(py).try_readonly());
                let mut views = [&[][..]; 8];
                for ((view, name), array) in views.iter_mut().zip(Drivelines::NAMES).zip(&borrowed)
                {
                    let array = array.as_ref();
                    let array = array.map_err(|error| argument_error(name, error.to_string()))?;
                    *view = slice(name, array)?;
                }
                body(Drivelines::from_arrays(views))
            }
        }
    }
}
