//! The flat arrays of a batch of drivelines, which plans read.

use cardan::Drivelines;
use numpy::{PyArray1, PyArrayMethods};
use pyo3::prelude::*;

use crate::convert::{argument_error, check_length, count, slice};
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
    shape: Vec<usize>,
    largest_bends: Vec<f64>,
    /// The shaft of each bearing, if the lengths of the shafts are known.
    bearings: Option<Vec<usize>>,
    /// Whether the joints have deviations.
    as_built: bool,
}

#[pymethods]
impl Lines {
    /// Drivelines with `joints` joints, one or a batch of the given shape, from flat arrays. A
    /// batch keeps references to its arrays. Each bearing is on one of the shafts; lengths may be
    /// empty if there are no bearings, and deviations if all joints are ideal.
    #[new]
    fn new(
        py: Python<'_>,
        joints: usize,
        shape: Vec<usize>,
        arrays: [Bound<'_, PyArray1<f64>>; 8],
        bearings: Vec<usize>,
    ) -> PyResult<Self> {
        if joints == 0 {
            return Err(argument_error("joints", &[], "is 0; a driveline has at least one"));
        }
        // The memory for the copies and the largest bends.
        check_memory(joints.saturating_mul(96))?;
        let count = count(&shape)?;
        let batch = Arrays::Batch(arrays.map(Bound::unbind));
        let batch =
            Self { arrays: batch, shape, largest_bends: vec![], bearings: None, as_built: false };
        let (one, largest_bends, known, as_built) = batch.with(py, |lines| {
            check_length("bends", lines.bends.len(), count, joints)?;
            check_length("twists", lines.twists.len(), count, joints - 1)?;
            check_length("phases", lines.phases.len(), count, joints - 1)?;
            check_length("directions", lines.directions.len(), count, 3 * joints + 3)?;
            check_length("normals", lines.normals.len(), count, 3 * joints)?;
            let known = count == 0 || !lines.lengths.is_empty();
            if known || !bearings.is_empty() {
                check_length("lengths", lines.lengths.len(), count, joints + 1)?;
            }
            check_length("positions", lines.positions.len(), count, bearings.len())?;
            let as_built = !lines.deviations.is_empty();
            if as_built {
                check_length("deviations", lines.deviations.len(), count, 3 * joints)?;
            }
            let one = count == 1;
            let kept = one.then(|| lines.arrays().map(<[f64]>::to_vec));
            Ok((kept, lines.largest_bends(joints), known, as_built))
        })?;
        if let Some(place) = bearings.iter().position(|&shaft| shaft > joints) {
            let problem = format!("is on shaft {}; there are {}", bearings[place], joints + 1);
            return Err(argument_error("bearings", &[place], problem));
        }
        let arrays = one.map_or(batch.arrays, Arrays::One);
        let bearings = known.then_some(bearings);
        Ok(Self { arrays, shape: batch.shape, largest_bends, bearings, as_built })
    }
}

impl Lines {
    pub(crate) fn largest_bends(&self) -> &[f64] {
        &self.largest_bends
    }

    /// The shaft of each bearing, if the lengths of the shafts are known.
    pub(crate) fn bearings(&self) -> Option<&[usize]> {
        self.bearings.as_deref()
    }

    /// Whether the joints have deviations, so that drivelines are evaluated joint by joint.
    pub(crate) fn is_as_built(&self) -> bool {
        self.as_built
    }

    /// Refuses joints with deviations.
    pub(crate) fn check_ideal(&self, what: &str) -> PyResult<()> {
        if !self.as_built {
            return Ok(());
        }
        let problem = format!("has joints with deviations; {what} for ideal joints only");
        Err(argument_error("driveline", &[], problem))
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
            Arrays::One(own) => body(Drivelines::from_arrays(own.each_ref().map(Vec::as_slice))),
            Arrays::Batch(arrays) => {
                let borrowed = arrays.each_ref().map(|array| array.bind(py).try_readonly());
                let mut views = [&[][..]; 8];
                for ((view, name), array) in views.iter_mut().zip(Drivelines::NAMES).zip(&borrowed)
                {
                    let array = array.as_ref();
                    let array =
                        array.map_err(|error| argument_error(name, &[], error.to_string()))?;
                    *view = slice(name, array)?;
                }
                body(Drivelines::from_arrays(views))
            }
        }
    }
}
