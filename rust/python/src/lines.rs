//! The flat arrays of a batch of drivelines, which plans read.

use cardan::Drivelines;
use numpy::{PyArray1, PyArrayMethods};
use pyo3::prelude::*;

use crate::convert::{argument_error, check_length, count, slice};
use crate::watch::check_memory;

/// Bends, twists, phases, directions and normals.
enum Arrays {
    /// The values of one driveline, copied.
    One([Vec<f64>; 5]),
    /// The arrays of a batch, which never change.
    Batch([Py<PyArray1<f64>>; 5]),
}

/// A driveline or a batch of drivelines.
#[pyclass(frozen, module = "cardan._core")]
pub(crate) struct Lines {
    arrays: Arrays,
    shape: Vec<usize>,
    largest_bends: Vec<f64>,
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
        arrays: [Bound<'_, PyArray1<f64>>; 5],
    ) -> PyResult<Self> {
        if joints == 0 {
            return Err(argument_error("joints", &[], "is 0; a driveline has at least one"));
        }
        // The memory for the copies and the largest bends.
        check_memory(joints.saturating_mul(96))?;
        let count = count(&shape)?;
        let batch = Arrays::Batch(arrays.map(Bound::unbind));
        let batch = Self { arrays: batch, shape, largest_bends: vec![] };
        let (one, largest_bends) = batch.with(py, |lines| {
            check_length("bends", lines.bends.len(), count, joints)?;
            check_length("twists", lines.twists.len(), count, joints - 1)?;
            check_length("phases", lines.phases.len(), count, joints - 1)?;
            check_length("directions", lines.directions.len(), count, 3 * joints + 3)?;
            check_length("normals", lines.normals.len(), count, 3 * joints)?;
            let own = [lines.bends, lines.twists, lines.phases, lines.directions, lines.normals];
            let one = count == 1;
            Ok((one.then(|| own.map(<[f64]>::to_vec)), lines.largest_bends(joints)))
        })?;
        let arrays = one.map_or(batch.arrays, Arrays::One);
        Ok(Self { arrays, shape: batch.shape, largest_bends })
    }
}

impl Lines {
    pub(crate) fn largest_bends(&self) -> &[f64] {
        &self.largest_bends
    }

    /// The shape of the batch; empty for one driveline.
    pub(crate) fn shape(&self) -> &[usize] {
        &self.shape
    }

    pub(crate) fn is_one(&self) -> bool {
        matches!(self.arrays, Arrays::One(_))
    }

    /// The number of joints of each driveline.
    pub(crate) fn joints(&self) -> usize {
        self.largest_bends.len()
    }

    /// Runs `body` with the arrays.
    pub(crate) fn with<R>(
        &self,
        py: Python<'_>,
        body: impl FnOnce(Drivelines<'_>) -> PyResult<R>,
    ) -> PyResult<R> {
        match &self.arrays {
            Arrays::One([bends, twists, phases, directions, normals]) => {
                body(Drivelines { bends, twists, phases, directions, normals })
            }
            Arrays::Batch(arrays) => {
                let [bends, twists, phases, directions, normals] =
                    arrays.each_ref().map(|array| array.bind(py).try_readonly());
                let (bends, twists, phases) = (bends?, twists?, phases?);
                let (directions, normals) = (directions?, normals?);
                body(Drivelines {
                    bends: slice("bends", &bends)?,
                    twists: slice("twists", &twists)?,
                    phases: slice("phases", &phases)?,
                    directions: slice("directions", &directions)?,
                    normals: slice("normals", &normals)?,
                })
            }
        }
    }
}
