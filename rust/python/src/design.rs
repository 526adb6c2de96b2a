//! Closed forms of design over batches. Each result has one column per figure, one after another.

use cardan::design::tube::{Round, Tube};
use cardan::design::{excitations_of_batch, splines_of_batch, steering_of_batch};
use cardan::{Excitations, Execution, Spline, Steering, check_length};
use numpy::{IntoPyArray, PyArray1, PyReadonlyArray1};
use pyo3::exceptions::PyIndexError;
use pyo3::prelude::*;

use crate::convert::{Input, OrRaise, slice};
use crate::lines::Lines;
use crate::watch::{reserve, run_released};

/// The fewest records that take long enough to be interruptible.
const MIN_INTERRUPTIBLE: usize = 1 << 12;

type Columns<'py> = Bound<'py, PyArray1<f64>>;

/// Equivalent bend, torsional excitation and inertia excitation, driving and coasting, of each
/// driveline.
#[pyfunction]
#[pyo3(signature = (lines, workers))]
pub(crate) fn excitations<'py>(
    py: Python<'py>,
    lines: &Lines,
    workers: Option<usize>,
) -> PyResult<Columns<'py>> {
    let (joints, batch) = (lines.batch().joints(), lines.batch());
    batch.check_ideal("excitations are").or_raise()?;
    lines.with(py, |lines| {
        let count = lines.bends.len() / joints;
        records(py, count, Excitations::COUNT, workers, &mut |out, execution| {
            excitations_of_batch(joints, &lines, out, execution);
        })
    })
}

/// The fields of `cardan.Steering` of the drivelines with these numbers at these angles straight
/// ahead. If another driveline is given, the angles are those on its column.
#[pyfunction]
#[pyo3(signature = (lines, numbers, centres, drawn, workers))]
pub(crate) fn steering<'py>(
    py: Python<'py>,
    lines: &Lines,
    numbers: PyReadonlyArray1<'py, i64>,
    centres: Input<'py>,
    drawn: Option<&Lines>,
    workers: Option<usize>,
) -> PyResult<Columns<'py>> {
    lines.batch().check_ideal("steering is").or_raise()?;
    let joints = lines.batch().joints();
    let centres = slice("centres", &centres)?;
    let of = |drawn: &Lines| drawn.with(py, |lines| Ok(lines.column(drawn.batch().joints(), 0)));
    let drawn = drawn.map(of).transpose()?;
    lines.with(py, |lines| {
        let numbers = known(slice("numbers", &numbers)?, lines.bends.len() / joints)?;
        check_length("centres", centres.len(), numbers.len(), 1).or_raise()?;
        records(py, numbers.len(), Steering::COUNT, workers, &mut |out, execution| {
            steering_of_batch(joints, &lines, &numbers, (centres, drawn), out, execution);
        })
    })
}

/// The force of a spline on a shaft of the drivelines with these numbers under these torques, with
/// these frictions and radii: the fields of the core's `SplineForce` and the forces of the bearings;
/// and why these are not determinate, if they are not.
#[pyfunction]
#[pyo3(signature = (lines, shaft, numbers, loads, workers))]
pub(crate) fn spline_forces<'py>(
    py: Python<'py>,
    lines: &Lines,
    shaft: usize,
    numbers: PyReadonlyArray1<'py, i64>,
    loads: [Input<'py>; 3],
    workers: Option<usize>,
) -> PyResult<(Columns<'py>, Option<String>)> {
    let joints = lines.batch().joints();
    let bearings = lines.batch().bearings.as_deref().unwrap_or_default();
    let spline = Spline::new(joints, shaft, bearings).or_raise()?;
    let [torque, friction, radius] = &loads;
    let loads = [slice("torque", torque)?, slice("friction", friction)?, slice("radius", radius)?];
    let found = lines.with(py, |lines| {
        let numbers = known(slice("numbers", &numbers)?, lines.bends.len() / joints)?;
        for (name, load) in ["torque", "friction", "radius"].into_iter().zip(loads) {
            check_length(name, load.len(), numbers.len(), 1).or_raise()?;
        }
        records(py, numbers.len(), spline.record(), workers, &mut |out, execution| {
            splines_of_batch(&spline, &lines, &numbers, loads, out, execution);
        })
    })?;
    Ok((found, spline.undetermined().map(str::to_owned)))
}

/// The figures of round shafts, from outer diameters, walls, lengths, shear moduli, elastic moduli
/// and densities.
#[pyfunction]
pub(crate) fn tubes<'py>(py: Python<'py>, dimensions: [Input<'py>; 6]) -> PyResult<Columns<'py>> {
    const NAMES: [&str; 6] =
        ["outer_diameter", "wall", "length", "shear_modulus", "elastic_modulus", "density"];
    let mut columns = [&[][..]; 6];
    for ((column, array), name) in columns.iter_mut().zip(&dimensions).zip(NAMES) {
        *column = slice(name, array)?;
    }
    let count = columns[0].len();
    for (column, name) in columns.into_iter().zip(NAMES) {
        check_length(name, column.len(), count, 1).or_raise()?;
    }
    records(py, count, Tube::<f64>::COUNT, Some(1), &mut |out, _| {
        for (i, record) in out.chunks_mut(Tube::<f64>::COUNT).enumerate() {
            let [diameter, wall, length, shear_modulus, elastic_modulus, density] =
                columns.map(|column| column[i]);
            let of = Round { diameter, wall, length, shear_modulus, elastic_modulus, density };
            record.copy_from_slice(&Tube::new(of).fields());
        }
    })
}

/// The numbers of drivelines, all of which exist.
fn known(numbers: &[i64], count: usize) -> PyResult<Vec<usize>> {
    let known = |&number: &i64| {
        let known = usize::try_from(number).ok().filter(|&number| number < count);
        known.ok_or_else(|| PyIndexError::new_err(format!("there is no driveline {number}")))
    };
    numbers.iter().map(known).collect()
}

/// Fills records of `size` numbers and returns their columns.
fn records<'py>(
    py: Python<'py>,
    count: usize,
    size: usize,
    workers: Option<usize>,
    fill: &mut (dyn FnMut(&mut [f64], Execution<'_>) + Send),
) -> PyResult<Columns<'py>> {
    let total = count.saturating_mul(size);
    let mut records = vec![];
    reserve(&mut records, total)?;
    records.resize(total, 0.0);
    run_released(py, count < MIN_INTERRUPTIBLE, workers, &mut |workers, stop| {
        fill(&mut records, Execution { workers, stop, ..Execution::default() });
    })?;
    if count != 1 {
        let mut columns = vec![];
        reserve(&mut columns, total)?;
        for figure in 0..size {
            columns.extend(records[figure.min(total)..].iter().step_by(size));
        }
        records = columns;
    }
    Ok(records.into_pyarray(py))
}
