//! Geometry of batches of drivelines, and their equivalent joints.

use cardan::phasing::optimal_phases_of_batch;
use cardan::{Equivalent, Error, Geometry, Vector};
use numpy::{IntoPyArray, PyArray1};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::convert::{Input, slice, unravel, value_error, vectors};

/// Bends, twists, directions and normals, each flat.
type Flat<'py> = (
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<f64>>,
);

/// Lays out each driveline of a batch and collects the flat arrays.
fn lay_out<'py>(
    py: Python<'py>,
    shape: &[usize],
    each: impl Fn(usize) -> cardan::Result<Geometry> + Sync,
) -> PyResult<Flat<'py>> {
    let count = shape.iter().product();
    let laid_out = py.detach(|| {
        let mut flat = [const { Vec::<f64>::new() }; 4];
        for line in 0..count {
            let geometry = each(line).map_err(|error| placed(error, line, shape))?;
            flat[0].extend(&geometry.bends);
            flat[1].extend(&geometry.twists);
            flat[2].extend(geometry.directions.iter().flat_map(|v| v.iter()));
            flat[3].extend(geometry.normals.iter().flat_map(|v| v.iter()));
        }
        Ok(flat)
    });
    let [bends, twists, directions, normals] = laid_out.map_err(|e: Error| value_error(&e))?;
    Ok((
        bends.into_pyarray(py),
        twists.into_pyarray(py),
        directions.into_pyarray(py),
        normals.into_pyarray(py),
    ))
}

/// The error with the driveline's place in the batch.
fn placed(error: Error, line: usize, shape: &[usize]) -> Error {
    error.within(&unravel(line, shape))
}

/// The part of a flat array that belongs to one driveline.
fn part(flat: &[f64], line: usize, each: usize) -> &[f64] {
    flat.get(line * each..(line + 1) * each).unwrap_or(&[])
}

/// Drivelines from bends `(…, n)`, twists and phases `(…, n − 1)` in radians.
#[pyfunction]
pub(crate) fn from_bends<'py>(
    py: Python<'py>,
    joints: usize,
    shape: Vec<usize>,
    bends: Input<'py>,
    twists: Input<'py>,
    phases: Input<'py>,
) -> PyResult<Flat<'py>> {
    let bends = slice("bends", &bends)?;
    let twists = slice("twists", &twists)?;
    let phases = slice("phases", &phases)?;
    let between = joints.saturating_sub(1);
    lay_out(py, &shape, |line| {
        Geometry::from_bends(
            part(bends, line, joints),
            part(twists, line, between),
            part(phases, line, between),
        )
    })
}

/// Drivelines from directions `(…, n + 1, 3)` and phases `(…, n − 1)`.
#[pyfunction]
pub(crate) fn from_directions<'py>(
    py: Python<'py>,
    joints: usize,
    shape: Vec<usize>,
    directions: Input<'py>,
    phases: Input<'py>,
) -> PyResult<Flat<'py>> {
    from_vectors(py, joints, &shape, &directions, &phases, joints + 1, Geometry::from_directions)
}

/// Drivelines from points `(…, n + 2, 3)` and phases `(…, n − 1)`.
#[pyfunction]
pub(crate) fn from_points<'py>(
    py: Python<'py>,
    joints: usize,
    shape: Vec<usize>,
    points: Input<'py>,
    phases: Input<'py>,
) -> PyResult<Flat<'py>> {
    from_vectors(py, joints, &shape, &points, &phases, joints + 2, Geometry::from_points)
}

fn from_vectors<'py>(
    py: Python<'py>,
    joints: usize,
    shape: &[usize],
    flat: &Input<'py>,
    phases: &Input<'py>,
    each: usize,
    make: fn(&[Vector], &[f64]) -> cardan::Result<Geometry>,
) -> PyResult<Flat<'py>> {
    let flat = slice("vectors", flat)?;
    let phases = slice("phases", phases)?;
    lay_out(py, shape, |line| {
        let between = part(phases, line, joints.saturating_sub(1));
        make(&vectors(part(flat, line, 3 * each)), between)
    })
}

/// The joint equivalent to the first `shaft` joints of each driveline: eight arrays, in the order
/// of the fields of `cardan.EquivalentJoint`.
#[pyfunction]
pub(crate) fn equivalent<'py>(
    py: Python<'py>,
    joints: usize,
    shaft: usize,
    bends: Input<'py>,
    twists: Input<'py>,
    phases: Input<'py>,
) -> PyResult<[Bound<'py, PyArray1<f64>>; 8]> {
    if joints == 0 || shaft > joints {
        return Err(PyValueError::new_err(format!("shaft is {shaft}; there are {}", joints + 1)));
    }
    let bends = slice("bends", &bends)?;
    let twists = slice("twists", &twists)?;
    let phases = slice("phases", &phases)?;
    let columns = py.detach(|| {
        let count = bends.len() / joints;
        let mut columns: [Vec<f64>; 8] = std::array::from_fn(|_| Vec::with_capacity(count));
        for line in 0..count {
            let between = shaft.saturating_sub(1);
            let equivalent = Equivalent::of_chain(
                &part(bends, line, joints)[..shaft],
                &part(twists, line, joints - 1)[..between],
                &part(phases, line, joints - 1)[..between],
            );
            let joint = equivalent.joint;
            let values = [
                joint.bend(),
                equivalent.angle_offset(),
                joint.k,
                joint.non_uniformity(),
                joint.max_angle_error(),
                joint.cos,
                joint.max_speed_ratio(),
                joint.max_acceleration_ratio(),
            ];
            for (column, value) in columns.iter_mut().zip(values) {
                column.push(value);
            }
        }
        columns
    });
    Ok(columns.map(|column| column.into_pyarray(py)))
}

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
    let bends = slice("bends", &bends)?;
    let twists = slice("twists", &twists)?;
    let mut best = slice("phases", &phases)?.to_vec();
    py.detach(|| optimal_phases_of_batch(joints, bends, twists, &mut best, workers));
    Ok(best.into_pyarray(py))
}
