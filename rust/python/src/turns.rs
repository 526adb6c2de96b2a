//! Drivelines over a turn of the drive.

use std::borrow::Cow;

use cardan::{
    End, Execution, FreeDrive, Load, Rows, Source, Wear, check_length, free_drives as drives,
    least_drive_inertias as least_inertias, pin_means as means, strides,
};
use numpy::{
    IntoPyArray, PyArray1, PyArrayDyn, PyArrayMethods, PyReadonlyArrayDyn, PyUntypedArrayMethods,
};
use pyo3::prelude::*;
use pyo3::pybacked::PyBackedStr;

use crate::convert::{Input, OrRaise, count, not_contiguous, slice};
use crate::lines::Lines;
use crate::plan::elements;
use crate::watch::{check_memory, reserve, run_interruptible, threads};

/// An array that is broadcast to the rows.
type Spread<'py> = Bound<'py, PyArrayDyn<f64>>;

/// The end at which the torque is given, torque, speed, acceleration, and pairs of a shaft and its
/// inertia.
type LoadArrays<'py> =
    (PyBackedStr, Spread<'py>, Spread<'py>, Spread<'py>, Vec<(usize, Spread<'py>)>);

/// The fewest rows for which a run is interruptible: some milliseconds of work.
const MIN_INTERRUPTIBLE: usize = 256;

/// Calls `body` with the interpreter released, interruptibly if there are many rows.
pub(crate) fn run_rows<R: Send>(
    py: Python<'_>,
    rows: usize,
    workers: Option<usize>,
    body: impl Fn(Execution<'_>) -> cardan::Result<R> + Sync,
) -> PyResult<R> {
    if rows < MIN_INTERRUPTIBLE {
        let alone = Execution { workers: Some(1), ..Execution::default() };
        return py.detach(|| body(alone)).or_raise();
    }
    let (workers, mut found) = (threads(workers), None);
    run_interruptible(py, workers, &mut |stop| {
        found = Some(body(Execution { workers, stop: Some(stop), ..Execution::default() })?);
        Ok(())
    })?;
    Ok(found.expect("work that has no error has a result"))
}

/// Means over a turn of what wears the pins, those of each row one after another. `wear` is
/// `"friction"` or `"fatigue"`. Drivelines and load broadcast to `shape`.
#[pyfunction]
pub(crate) fn pin_means<'py>(
    py: Python<'py>,
    lines: &Lines,
    shape: Vec<usize>,
    load: LoadArrays<'py>,
    wear: &str,
    workers: Option<usize>,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let wear = Wear::named(wear).or_raise()?;
    let (given, torque, speed, acceleration, inertias) = load;
    let end = End::named(&given).or_raise()?;
    let torque = Broadcast::new(end.torque_name(), &torque, &shape)?;
    let speed = Broadcast::new("speed", &speed, &shape)?;
    let acceleration = Broadcast::new("acceleration", &acceleration, &shape)?;
    let of_shaft = |(shaft, array): &(usize, Spread<'py>)| {
        Ok((*shaft, Broadcast::new("inertias", array, &shape)?))
    };
    let inertias = inertias.iter().map(of_shaft).collect::<PyResult<Vec<_>>>()?;
    let line_strides = strides("the driveline's batch", &lines.batch().shape, &shape).or_raise()?;
    let rows = count(&shape)?;
    let total = rows.saturating_mul(wear.count(lines.batch().joints()));
    check_memory(total.saturating_mul(size_of::<f64>()))?;
    if rows == 0 {
        return Ok(vec![].into_pyarray(py));
    }
    let out = lines.with(py, |arrays| {
        let load = Load {
            torque: torque.source()?,
            speed: speed.source()?,
            acceleration: acceleration.source()?,
            inertias: inertias
                .iter()
                .map(|(shaft, array)| Ok((*shaft, array.source()?)))
                .collect::<PyResult<_>>()?,
        };
        let turned =
            Rows { shape: &shape, lines: arrays, line_strides: &line_strides, load: Some(load) };
        run_rows(py, rows, workers, |execution| {
            let mut out = vec![0.0; total];
            means(&turned, &lines.batch().largest_bends, end, wear, &mut out, execution)?;
            Ok(out)
        })
    })?;
    Ok(out.into_pyarray(py))
}

/// Least, largest and variation of the speed of a drive that runs freely, over its mean, and the mean
/// over the turn of the root of the inertia that it feels, in each row of this shape. `inertias` has
/// one for each shaft of each row.
#[pyfunction]
pub(crate) fn free_drives<'py>(
    py: Python<'py>,
    lines: &Lines,
    shape: Vec<usize>,
    inertias: Input<'py>,
    workers: Option<usize>,
) -> PyResult<[Bound<'py, PyArray1<f64>>; 4]> {
    let inertias = slice("inertias", &inertias)?;
    let found = run_unloaded(py, lines, &shape, workers, |rows, execution| {
        drives(rows, &lines.batch().largest_bends, inertias, execution)
    })?;
    let column =
        |of: fn(&FreeDrive) -> f64| found.iter().map(of).collect::<Vec<f64>>().into_pyarray(py);
    Ok([
        column(|drive| drive.least),
        column(|drive| drive.largest),
        column(|drive| drive.variation),
        column(|drive| drive.root),
    ])
}

/// The least inertia of the drive for a variation of its speed, in each row of this shape. `inertias`
/// has one for each shaft of each row, and 0 for the drive.
#[pyfunction]
pub(crate) fn least_drive_inertias<'py>(
    py: Python<'py>,
    lines: &Lines,
    shape: Vec<usize>,
    inertias: Input<'py>,
    variations: Input<'py>,
    workers: Option<usize>,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let [inertias, variations] = [slice("inertias", &inertias)?, slice("variations", &variations)?];
    let found = run_unloaded(py, lines, &shape, workers, |rows, execution| {
        least_inertias(rows, &lines.batch().largest_bends, inertias, variations, execution)
    })?;
    Ok(found.into_pyarray(py))
}

/// Runs `body` with the drivelines broadcast to rows of this shape without a load.
fn run_unloaded<R: Send>(
    py: Python<'_>,
    lines: &Lines,
    shape: &[usize],
    workers: Option<usize>,
    body: impl Fn(&Rows<'_>, Execution<'_>) -> cardan::Result<R> + Sync,
) -> PyResult<R> {
    let line_strides = strides("the driveline's batch", &lines.batch().shape, shape).or_raise()?;
    let count = count(shape)?;
    check_memory(count.saturating_mul(size_of::<FreeDrive>()))?;
    lines.with(py, |arrays| {
        let rows = Rows { shape, lines: arrays, line_strides: &line_strides, load: None };
        run_rows(py, count, workers, |execution| body(&rows, execution))
    })
}

/// An array with its strides over the rows.
struct Broadcast<'py> {
    name: &'static str,
    array: PyReadonlyArrayDyn<'py, f64>,
    strides: Cow<'static, [usize]>,
}

impl<'py> Broadcast<'py> {
    fn new(name: &'static str, array: &Spread<'py>, shape: &[usize]) -> PyResult<Self> {
        let array = array.try_readonly()?;
        let strides = strides(name, array.shape(), shape).or_raise()?;
        Ok(Self { name, array, strides })
    }

    fn source(&self) -> PyResult<Source<'_>> {
        let data = elements(&self.array).ok_or_else(|| not_contiguous(self.name))?;
        Ok(Source { data, strides: &self.strides })
    }
}

/// The life of each joint in hours, by the load of its pins and by the catalogue's law. `means` has
/// five numbers for each joint, the other arrays one.
#[pyfunction]
pub(crate) fn hours<'py>(
    py: Python<'py>,
    means: Input<'py>,
    bends: Input<'py>,
    rpm: Input<'py>,
    rating: Input<'py>,
) -> PyResult<[Bound<'py, PyArray1<f64>>; 2]> {
    let means = slice("means", &means)?;
    let bends = slice("bends", &bends)?;
    let joints = bends.len();
    let [rpm, rating] = [slice("rpm", &rpm)?, slice("rating", &rating)?];
    check_length("means", means.len(), joints, 5).or_raise()?;
    check_length("rpm", rpm.len(), joints, 1).or_raise()?;
    check_length("rating", rating.len(), joints, 1).or_raise()?;
    let mut columns = [const { Vec::<f64>::new() }; 2];
    for column in &mut columns {
        reserve(column, joints)?;
    }
    let (means, _) = means.as_chunks::<5>();
    for (joint, &means) in means.iter().enumerate() {
        let [exact, law] = cardan::hours(means, bends[joint], rpm[joint], rating[joint]);
        columns[0].push(exact);
        columns[1].push(law);
    }
    Ok(columns.map(|column| column.into_pyarray(py)))
}
