//! Plans: what to compute, prepared once for its drivelines; and running them over samples.

use std::sync::atomic::AtomicBool;

use cardan::{
    Angles, Call, Constants, Drivelines, End, Execution, Level, Load, Output as Quantity,
    Plan as CorePlan, Planes, Precision, Reduction, Request, Samples, Source, Sweep, level,
};
use numpy::{
    BorrowError, Element, PyArray1, PyArrayDyn, PyArrayMethods, PyReadonlyArrayDyn,
    PyReadwriteArray1, PyUntypedArrayMethods,
};
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use pyo3::pybacked::PyBackedStr;
use pyo3::types::{PyList, PyTuple};

use crate::convert::{Input, count, slice, slice_mut, value_error};
use crate::lines::Lines;
use crate::watch::{room, threads, watched};

/// Samples that are done before it is worth giving the interpreter away.
const BRIEF: usize = 1000;

/// Samples from which the core may use its threads, or fewer.
const POOLED: usize = 1 << 16;

/// Numbers, of results and of the folding, that take some milliseconds, on the slowest instruction
/// set less than half a second: shorter runs need no watch.
const WATCHED: usize = 1 << 21;

/// A flat array and its strides over the samples.
type Broadcast<'py> = (Input<'py>, Vec<usize>);

/// Torque, speed, acceleration, and the inertias with their shafts.
type LoadArrays<'py> =
    (Broadcast<'py>, Broadcast<'py>, Broadcast<'py>, Vec<(usize, Input<'py>, Vec<usize>)>);

/// Arrays to fill, each holding planes one after another.
#[derive(FromPyObject)]
enum Out<'py> {
    Double(Vec<Bound<'py, PyArray1<f64>>>),
    Single(Vec<Bound<'py, PyArray1<f32>>>),
}

/// Drive angles at equal steps.
#[pyclass(frozen, name = "Sweep", module = "cardan._core")]
pub(crate) struct DriveSweep(Sweep);

#[pymethods]
impl DriveSweep {
    /// The largest number of samples.
    #[classattr]
    const LONGEST: usize = Sweep::LONGEST;

    /// From `start` to `stop` if these are given, else `count` steps of `per_turn` to a turn.
    #[new]
    fn new(ends: Option<(f64, f64)>, count: usize, per_turn: usize) -> PyResult<Self> {
        let sweep = match ends {
            Some((start, stop)) => Sweep::new(start, stop, count),
            None => Sweep::of_turns(count, per_turn),
        };
        sweep.map(Self).map_err(|error| value_error(&error))
    }

    /// The angles from `first` on, each the nearest double.
    fn fill(&self, first: usize, mut out: PyReadwriteArray1<'_, f64>) -> PyResult<()> {
        for (i, angle) in slice_mut("out", &mut out)?.iter_mut().enumerate() {
            *angle = self.0.at(first + i);
        }
        Ok(())
    }
}

/// The steps for one set of outputs, and the drivelines they are for.
#[pyclass(frozen, module = "cardan._core")]
pub(crate) struct Plan {
    steps: CorePlan,
    precision: Precision,
    reduction: Option<Reduction>,
    lines: Py<Lines>,
    /// What is folded of the only driveline.
    constants: Option<Constants>,
}

#[pymethods]
impl Plan {
    /// `load` is `None`, `"drive"` or `"output"`: where the load's torque is given. Without a
    /// tolerance the arithmetic is that of the results, `single` or double.
    #[new]
    #[allow(clippy::too_many_arguments, reason = "flat arguments of one call, named by the caller")]
    fn new(
        lines: Bound<'_, Lines>,
        outputs: Bound<'_, PyTuple>,
        shaft_items: Bound<'_, PyList>,
        joint_items: Bound<'_, PyList>,
        load: Option<&str>,
        inertias: Bound<'_, PyList>,
        tolerance: Option<f64>,
        single: bool,
        reduction: Option<&str>,
    ) -> PyResult<Self> {
        let [shaft_items, joint_items, inertias] =
            [numbers(&shaft_items)?, numbers(&joint_items)?, numbers(&inertias)?];
        let items = shaft_items.len().saturating_add(joint_items.len());
        room(lines.get().joints().saturating_add(items).saturating_mul(1024))?;
        let outputs = outputs.iter().map(|name| quantity(&name.extract::<PyBackedStr>()?));
        let outputs = outputs.collect::<PyResult<Vec<_>>>()?;
        let request = Request {
            largest_bends: lines.get().largest_bends(),
            outputs: &outputs,
            shafts: &shaft_items,
            joints: &joint_items,
            load: load.map(end).transpose()?,
            inertias: &inertias,
        };
        let plan = CorePlan::new(&request).map_err(|error| value_error(&error))?;
        let precision = match tolerance {
            Some(tolerance) => plan.precision(tolerance),
            None if single => Precision::Single,
            None => Precision::Double,
        };
        let reduction = reduction.map(self::reduction).transpose()?;
        let constants = if lines.get().is_one() {
            let fold = |arrays: Drivelines<'_>| {
                plan.fold(&arrays, precision).map_err(|error| value_error(&error))
            };
            Some(lines.get().with(lines.py(), fold)?)
        } else {
            None
        };
        Ok(Self { steps: plan, precision, reduction, lines: lines.unbind(), constants })
    }

    /// The steps taken and skipped, in words.
    fn explain(&self, py: Python<'_>, sweep: bool, single: bool) -> PyResult<String> {
        let (precision, reduction) = (self.precision, self.reduction);
        let call = Call { precision, reduction, sweep, single };
        self.lines
            .get()
            .with(py, |lines| self.steps.explain(&lines, call).map_err(|error| value_error(&error)))
    }

    /// Fills the planes in the arrays of `out`, one after another, for one driveline without a load,
    /// if all arrays are such as `run` takes; otherwise returns false.
    fn fill(
        &self,
        py: Python<'_>,
        angle: PyReadonlyArrayDyn<'_, f64>,
        out: Bound<'_, PyList>,
        workers: Option<usize>,
    ) -> PyResult<bool> {
        let c_order = angle.is_c_contiguous();
        let Some(angle) = angle.as_slice().ok().filter(|_| c_order) else { return Ok(false) };
        let total = angle.len();
        let mut borrowed = Vec::with_capacity(out.len());
        for array in &out {
            let Ok(array) = array.cast_into::<PyArrayDyn<f64>>()?.try_readwrite() else {
                return Ok(false);
            };
            borrowed.push(array);
        }
        let mut planes: Vec<&mut [f64]> = Vec::with_capacity(self.steps.planes());
        for array in &mut borrowed {
            let c_order = array.is_c_contiguous();
            let Some(words) = array.as_slice_mut().ok().filter(|_| c_order) else {
                return Ok(false);
            };
            planes.extend(words.chunks_exact_mut(total.max(1)));
        }
        if total == 0 || planes.len() != self.steps.planes() {
            return Ok(total == 0);
        }
        self.lines.get().with(py, |lines| {
            let samples = Samples {
                shape: &[total],
                lines,
                line_strides: &[0],
                angle: Angles::Array(Source { data: angle, strides: &[1] }),
                load: None,
            };
            self.execute(py, &samples, Planes::Double(&mut planes), None, workers)
        })?;
        Ok(true)
    }

    /// Fills `out`, flat arrays that hold the planes one after another.
    ///
    /// Either `sweep` or `angle` is given; the strides say which driveline and which element each
    /// sample of the given shape sees.
    #[allow(clippy::too_many_arguments, reason = "flat arrays of one call, named by the caller")]
    fn run(
        &self,
        py: Python<'_>,
        shape: Vec<usize>,
        line_strides: Vec<usize>,
        sweep: Option<Bound<'_, DriveSweep>>,
        angle: Option<Broadcast<'_>>,
        load: Option<LoadArrays<'_>>,
        out: Out<'_>,
        workers: Option<usize>,
        level: Option<&str>,
    ) -> PyResult<()> {
        let level = level.map(named_level).transpose()?;
        if shape.contains(&0) {
            return Ok(());
        }
        let kept = match (self.reduction, shape.split_last()) {
            (Some(_), Some((_, rows))) => rows,
            (Some(_), None) => return Err(PyValueError::new_err("shape has no axis to reduce")),
            (None, _) => &shape,
        };
        let total = count(kept)?;
        let load = load.as_ref().map(borrow_load).transpose()?;
        let angle = match (&sweep, &angle) {
            (Some(sweep), _) => Angles::Sweep(sweep.get().0),
            (None, Some(array)) => Angles::Array(source("angle", array)?),
            (None, None) => return Err(PyValueError::new_err("angle is missing")),
        };
        self.lines.get().with(py, |lines| {
            let samples =
                Samples { shape: &shape, lines, line_strides: &line_strides, angle, load };
            match out {
                Out::Double(out) => {
                    let mut out = borrow_out(&out)?;
                    let planes = &mut planes_of(&mut out, total)?;
                    self.execute(py, &samples, Planes::Double(planes), level, workers)
                }
                Out::Single(out) => {
                    let mut out = borrow_out(&out)?;
                    let planes = &mut planes_of(&mut out, total)?;
                    self.execute(py, &samples, Planes::Single(planes), level, workers)
                }
            }
        })
    }
}

impl Plan {
    /// Runs or reduces: at once if it is brief, watched if it is long.
    fn execute(
        &self,
        py: Python<'_>,
        samples: &Samples<'_>,
        mut planes: Planes<'_, '_>,
        level: Option<Level>,
        workers: Option<usize>,
    ) -> PyResult<()> {
        let total = count(samples.shape)?;
        let workers = if total < POOLED { workers } else { threads(workers) };
        room(self.scratch(samples, total, workers))?;
        let (plan, precision, constants) = (&self.steps, self.precision, self.constants.as_ref());
        let mut run = |stop: Option<&AtomicBool>| {
            let execution = Execution { level, workers, stop };
            match (self.reduction, &mut planes) {
                (Some(reduction), Planes::Double(planes)) => {
                    plan.reduce(samples, constants, precision, reduction, planes, execution)
                }
                (_, Planes::Double(planes)) => {
                    plan.run(samples, constants, precision, Planes::Double(planes), execution)
                }
                (_, Planes::Single(planes)) => {
                    plan.run(samples, constants, precision, Planes::Single(planes), execution)
                }
            }
        };
        let joints = if constants.is_some() { 0 } else { self.lines.get().joints() };
        let result = if total.saturating_mul(plan.planes() + joints) >= WATCHED {
            return watched(py, workers, &mut |stop| run(Some(stop)));
        } else if total < BRIEF {
            run(None)
        } else {
            py.detach(|| run(None))
        };
        result.map_err(|error| value_error(&error))
    }

    /// At most so many bytes are taken by a run, beside its results: by each thread for the folded
    /// drivelines and a chunk of each result, and by what the blocks give to be reduced.
    fn scratch(&self, samples: &Samples<'_>, total: usize, workers: Option<usize>) -> usize {
        const CHUNK: usize = 1024;
        const BLOCK: usize = 16 * CHUNK;
        let joints = self.lines.get().joints();
        let lanes = match samples.line_strides.last() {
            _ if self.constants.is_some() => 1,
            Some(0) => 64,
            _ => CHUNK,
        };
        let threads = match workers {
            Some(1) => 1,
            _ if total < POOLED => 1,
            _ => rayon::current_num_threads(),
        };
        let of_joint = 512 * lanes + if samples.load.is_some() { 64 * CHUNK } else { 0 };
        let planes = self.steps.planes();
        let of_thread = (joints + 1).saturating_mul(of_joint).saturating_add(16 * CHUNK * planes);
        let parts = match (self.reduction, samples.shape.split_last()) {
            (Some(_), Some((&length, _))) => {
                (total / length).saturating_mul(length.div_ceil(BLOCK))
            }
            _ => total.div_ceil(BLOCK),
        };
        let of_parts = parts.saturating_mul(24 * planes);
        of_thread.saturating_mul(threads).saturating_add(of_parts)
    }
}

/// The arrays to fill, of which no other call may read or write any meanwhile.
fn borrow_out<'py, W: Element>(
    arrays: &[Bound<'py, PyArray1<W>>],
) -> PyResult<Vec<PyReadwriteArray1<'py, W>>> {
    let borrow = |array: &Bound<'py, PyArray1<W>>| {
        array.try_readwrite().map_err(|error| match error {
            BorrowError::AlreadyBorrowed => {
                PyRuntimeError::new_err("out is in use by another call")
            }
            error => PyValueError::new_err(format!("out: {error}")),
        })
    };
    arrays.iter().map(borrow).collect()
}

/// The planes that lie in flat arrays one after another.
fn planes_of<'a, W: Element>(
    arrays: &'a mut [PyReadwriteArray1<'_, W>],
    length: usize,
) -> PyResult<Vec<&'a mut [W]>> {
    let mut planes = vec![];
    for array in arrays {
        planes.extend(slice_mut("out", array)?.chunks_mut(length));
    }
    Ok(planes)
}

fn borrow_load<'a>(load: &'a LoadArrays<'_>) -> PyResult<Load<'a>> {
    let (torque, speed, acceleration, inertias) = load;
    Ok(Load {
        torque: source("torque", torque)?,
        speed: source("speed", speed)?,
        acceleration: source("acceleration", acceleration)?,
        inertias: inertias
            .iter()
            .map(|(shaft, data, strides)| {
                Ok((*shaft, Source { data: slice("inertias", data)?, strides }))
            })
            .collect::<PyResult<_>>()?,
    })
}

fn source<'a>(name: &str, (data, strides): &'a Broadcast<'_>) -> PyResult<Source<'a>> {
    Ok(Source { data: slice(name, data)?, strides })
}

/// What is read from lists is read faster than what is read from any sequence.
fn numbers(list: &Bound<'_, PyList>) -> PyResult<Vec<usize>> {
    list.iter().map(|item| item.extract()).collect()
}

fn end(name: &str) -> PyResult<End> {
    match name {
        "drive" => Ok(End::Drive),
        "output" => Ok(End::Output),
        other => Err(PyValueError::new_err(format!("load is {other:?}"))),
    }
}

fn reduction(name: &str) -> PyResult<Reduction> {
    Reduction::ALL
        .into_iter()
        .find(|reduction| reduction.name() == name)
        .ok_or_else(|| PyValueError::new_err(format!("reduce is {name:?}, which is unknown")))
}

fn quantity(name: &str) -> PyResult<Quantity> {
    Quantity::ALL
        .into_iter()
        .find(|output| output.name() == name)
        .ok_or_else(|| PyValueError::new_err(format!("outputs holds {name:?}, which is unknown")))
}

fn named_level(name: &str) -> PyResult<Level> {
    level::available()
        .into_iter()
        .find(|(known, _)| *known == name)
        .map(|(_, level)| level)
        .ok_or_else(|| PyValueError::new_err(format!("level {name:?} is not available here")))
}

/// The instruction sets that the kernels can use on this machine, strongest first.
#[pyfunction]
pub(crate) fn levels() -> Vec<&'static str> {
    level::available().into_iter().map(|(name, _)| name).collect()
}
