//! The geometry of batches of drivelines, and their equivalent joints.

use std::sync::atomic::Ordering;

use cardan::{
    Execution, FIGURES, General, Geometry, Vector, check_length, check_shaft, equivalents_of_batch,
    frames_of_batch, lengths, unravel,
};
use numpy::{IntoPyArray, PyArray1};
use pyo3::prelude::*;

use crate::convert::{Input, OrRaise, argument_error, count, slice, vectors};
use crate::lines::Lines;
use crate::watch::{check_memory, reserve, run_interruptible, run_released};

/// Bends, twists, directions and normals, each flat.
type Flat<'py> = (
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<f64>>,
);

/// The number of drivelines between two checks of the stop flag.
const PIECE: usize = 64;

/// The fewest drivelines whose construction takes long enough to be interruptible.
const MIN_INTERRUPTIBLE: usize = 1 << 14;

/// Calls `each` with the number of every driveline, with the interpreter released.
fn for_each_line(
    py: Python<'_>,
    lines: usize,
    each: &mut (dyn FnMut(usize) -> cardan::Result<()> + Send),
) -> PyResult<()> {
    if lines < MIN_INTERRUPTIBLE {
        return py.detach(|| (0..lines).try_for_each(each)).or_raise();
    }
    run_interruptible(py, Some(1), &mut |stop| {
        let go_on = |line: &usize| !line.is_multiple_of(PIECE) || !stop.load(Ordering::Relaxed);
        (0..lines).take_while(go_on).try_for_each(&mut *each)
    })
}

/// Empty arrays with room for the bends, twists, directions and normals of a batch.
fn room(joints: usize, shape: &[usize]) -> PyResult<[Vec<f64>; 4]> {
    let lines = count(shape)?;
    // Memory for one driveline at a time.
    check_memory(joints.saturating_mul(512))?;
    let shafts = joints.saturating_add(1);
    let (of_shafts, of_joints) = (shafts.saturating_mul(3), joints.saturating_mul(3));
    let sizes = [joints, joints.saturating_sub(1), of_shafts, of_joints];
    let mut flat = [const { Vec::<f64>::new() }; 4];
    for (array, size) in flat.iter_mut().zip(sizes) {
        reserve(array, lines.saturating_mul(size))?;
    }
    Ok(flat)
}

/// The arrays for Python.
fn flat(py: Python<'_>, [bends, twists, directions, normals]: [Vec<f64>; 4]) -> Flat<'_> {
    (
        bends.into_pyarray(py),
        twists.into_pyarray(py),
        directions.into_pyarray(py),
        normals.into_pyarray(py),
    )
}

/// Computes the geometry of each driveline of a batch and collects the flat arrays.
fn lay_out<'py>(
    py: Python<'py>,
    joints: usize,
    shape: &[usize],
    each: impl Fn(usize) -> cardan::Result<Geometry> + Sync,
) -> PyResult<Flat<'py>> {
    let [mut bends, mut twists, mut directions, mut normals] = room(joints, shape)?;
    for_each_line(py, count(shape)?, &mut |line| {
        let geometry = each(line).map_err(|error| error.within(&unravel(line, shape)))?;
        bends.extend(&geometry.bends);
        twists.extend(&geometry.twists);
        directions.extend(geometry.directions.iter().flat_map(|v| v.iter()));
        normals.extend(geometry.normals.iter().flat_map(|v| v.iter()));
        Ok(())
    })?;
    Ok(flat(py, [bends, twists, directions, normals]))
}

/// The number of drivelines with these bends.
pub(crate) fn count_of(bends: &[f64], joints: usize) -> PyResult<usize> {
    let none = || argument_error("joints", "is 0; a driveline has at least one");
    bends.len().checked_div(joints).ok_or_else(none)
}

/// The part of a flat array for one driveline.
fn part(flat: &[f64], line: usize, each: usize) -> &[f64] {
    let first = line.saturating_mul(each);
    flat.get(first..first.saturating_add(each)).unwrap_or(&[])
}

/// Drivelines from bends `(…, n)`, twists and phases `(…, n − 1)` in rad, which the caller may have
/// been given in degrees.
#[pyfunction]
#[pyo3(signature = (joints, shape, bends, twists, phases, degrees=false))]
pub(crate) fn from_bends<'py>(
    py: Python<'py>,
    joints: usize,
    shape: Vec<usize>,
    bends: Input<'py>,
    twists: Input<'py>,
    phases: Input<'py>,
    degrees: bool,
) -> PyResult<Flat<'py>> {
    let bends = slice("bends", &bends)?;
    let twists = slice("twists", &twists)?;
    let phases = slice("phases", &phases)?;
    let [mut own_bends, mut own_twists, directions, normals] = room(joints, &shape)?;
    let mut frames = [directions, normals];
    let given = [bends, twists, phases];
    let lines = count(&shape)?;
    let mut found = Ok(());
    run_released(py, lines < MIN_INTERRUPTIBLE, Some(1), &mut |workers, stop| {
        let execution = Execution { workers, stop, ..Execution::default() };
        found = frames_of_batch(joints, &shape, given, &mut frames, execution);
    })?;
    found.map_err(|error| if degrees { error.in_degrees() } else { error }).or_raise()?;
    own_bends.extend_from_slice(part(bends, 0, lines.saturating_mul(joints)));
    own_twists.extend_from_slice(part(twists, 0, lines.saturating_mul(joints.saturating_sub(1))));
    let [directions, normals] = frames;
    Ok(flat(py, [own_bends, own_twists, directions, normals]))
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
    from_vectors(py, joints, &shape, &directions, &phases, 1, Geometry::from_directions)
}

/// Drivelines from points `(…, n + 2, 3)` and phases `(…, n − 1)`, and the lengths of their shafts.
#[pyfunction]
pub(crate) fn from_points<'py>(
    py: Python<'py>,
    joints: usize,
    shape: Vec<usize>,
    points: Input<'py>,
    phases: Input<'py>,
) -> PyResult<[Bound<'py, PyArray1<f64>>; 5]> {
    let (bends, twists, directions, normals) =
        from_vectors(py, joints, &shape, &points, &phases, 2, Geometry::from_points)?;
    let each = joints.saturating_add(2).saturating_mul(3);
    let points = slice("points", &points)?;
    let mut all = vec![];
    reserve(&mut all, points.len() / 3)?;
    points.chunks_exact(each).for_each(|line| all.extend(lengths(&vectors(line))));
    Ok([bends, twists, directions, normals, all.into_pyarray(py)])
}

fn from_vectors<'py>(
    py: Python<'py>,
    joints: usize,
    shape: &[usize],
    flat: &Input<'py>,
    phases: &Input<'py>,
    more: usize,
    make: fn(&[Vector], &[f64]) -> cardan::Result<Geometry>,
) -> PyResult<Flat<'py>> {
    let flat = slice("vectors", flat)?;
    let phases = slice("phases", phases)?;
    let each = joints.saturating_add(more).saturating_mul(3);
    lay_out(py, joints, shape, |line| {
        let between = part(phases, line, joints.saturating_sub(1));
        make(&vectors(part(flat, line, each)), between)
    })
}

/// Checks that every joint turns, from bends `(…, n)` and deviations `(…, n, 3)` in rad.
#[pyfunction]
pub(crate) fn check_deviations(
    py: Python<'_>,
    joints: usize,
    shape: Vec<usize>,
    bends: Input<'_>,
    deviations: Input<'_>,
) -> PyResult<()> {
    let (bends, deviations) = (slice("bends", &bends)?, slice("deviations", &deviations)?);
    let lines = count(&shape)?;
    check_length("bends", bends.len(), lines, joints).or_raise()?;
    check_length("deviations", deviations.len(), lines, joints.saturating_mul(3)).or_raise()?;
    for_each_line(py, lines, &mut |line| {
        let own = part(deviations, line, joints.saturating_mul(3));
        cardan::check_deviations(part(bends, line, joints), own)
            .map_err(|error| error.within(&unravel(line, &shape)))
    })
}

/// Checks that bearings lie between the ends of their shafts, from lengths `(…, n + 1)` and
/// positions `(…, bearings)`.
#[pyfunction]
pub(crate) fn check_bearings(
    joints: usize,
    shape: Vec<usize>,
    bearings: Vec<usize>,
    lengths: Input<'_>,
    positions: Input<'_>,
) -> PyResult<()> {
    let (lengths, positions) = (slice("lengths", &lengths)?, slice("positions", &positions)?);
    count(&shape)?;
    cardan::check_bearings(joints, &shape, &bearings, lengths, positions).or_raise()
}

/// The mean over a turn by which a shaft is ahead of the drive in each driveline, in rad.
#[pyfunction]
pub(crate) fn mean_leads<'py>(
    py: Python<'py>,
    lines: &Lines,
    shaft: usize,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let joints = lines.batch().joints();
    check_shaft(joints, shaft).or_raise()?;
    let mut leads = vec![];
    let between = shaft.saturating_sub(1);
    lines.with(py, |lines| {
        let count = lines.bends.len() / joints;
        reserve(&mut leads, count)?;
        if lines.deviations.is_empty() {
            leads.resize(count, 0.0);
            return Ok(());
        }
        for_each_line(py, count, &mut |line| {
            let general = General::as_built(
                &part(lines.bends, line, joints)[..shaft],
                &part(lines.twists, line, joints - 1)[..between],
                &part(lines.phases, line, joints - 1)[..between],
                &part(lines.deviations, line, 3 * joints)[..3 * shaft],
            )?;
            leads.push(general.mean_lead());
            Ok(())
        })
    })?;
    Ok(leads.into_pyarray(py))
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
) -> PyResult<[Bound<'py, PyArray1<f64>>; FIGURES]> {
    check_shaft(joints, shaft).or_raise()?;
    let bends = slice("bends", &bends)?;
    let twists = slice("twists", &twists)?;
    let phases = slice("phases", &phases)?;
    let lines = count_of(bends, joints)?;
    check_length("bends", bends.len(), lines, joints).or_raise()?;
    check_length("twists", twists.len(), lines, joints - 1).or_raise()?;
    check_length("phases", phases.len(), lines, joints - 1).or_raise()?;
    let mut columns = [const { Vec::<f64>::new() }; FIGURES];
    for column in &mut columns {
        reserve(column, lines)?;
    }
    run_released(py, lines < MIN_INTERRUPTIBLE, Some(1), &mut |workers, stop| {
        let execution = Execution { workers, stop, ..Execution::default() };
        equivalents_of_batch(joints, shaft, [bends, twists, phases], &mut columns, execution);
    })?;
    Ok(columns.map(|column| column.into_pyarray(py)))
}
