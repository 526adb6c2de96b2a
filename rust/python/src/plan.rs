//! Plans: what to compute, prepared once for given drivelines, and running them over samples.

use std::borrow::Cow;
use std::ffi::c_int;
use std::iter::once;
use std::sync::atomic::AtomicBool;

use cardan::{
    Angles, Axes, Call, Drivelines, End, Execution, FoldedDriveline, Load, Output, Plan, Planes,
    Precision, Reduction, Request, Rows, Samples, Sought, Source, Sweep, Turns, drive_angles,
    level, strides, uses_threads,
};
use numpy::npyffi::npy_intp;
use numpy::{
    Element, IntoPyArray, PY_ARRAY_API, PyArray1, PyArrayDescrMethods, PyArrayDyn, PyArrayMethods,
    PyReadonlyArrayDyn, PyReadwriteArray1, PyUntypedArray, PyUntypedArrayMethods,
};
use pyo3::prelude::*;
use pyo3::pybacked::PyBackedStr;
use pyo3::types::{PyDict, PyList, PyString, PyTuple};

use crate::convert::{OrRaise, argument_error, count, not_contiguous, slice_mut};
use crate::lines::Lines;
use crate::turns::run_rows;
use crate::watch::{check_memory, no_memory, run_interruptible, run_released, threads};

/// The fewest samples for which releasing the interpreter saves time.
const MIN_DETACHED: usize = 1000;

/// The fewest numbers, results and folded joints together, for which a run is interruptible. They
/// take some milliseconds, and less than half a second on the slowest instruction set.
const MIN_INTERRUPTIBLE: usize = 1 << 21;

/// Name of the shape of the batch in messages.
const BATCH: &str = "the driveline's batch";

/// An array that is broadcast to the samples.
type Spread = Py<PyArrayDyn<f64>>;

/// An array with its strides over the samples.
type Strided<'py> = (PyReadonlyArrayDyn<'py, f64>, Cow<'static, [usize]>);

/// The shape of an output's array besides that of the samples: how many items it has, if there is an
/// axis for them, and whether it is a vector.
struct OutputShape {
    name: Py<PyString>,
    items: Option<usize>,
    is_vector: bool,
}

/// The end at which the torque is given, torque, speed, acceleration, and pairs of a shaft and its
/// inertia.
type LoadArrays = (PyBackedStr, Spread, Spread, Spread, Vec<(usize, Spread)>);

/// The drive angles of a run.
enum AngleArgument<'py> {
    Array(PyReadonlyArrayDyn<'py, f64>),
    /// With their error terms.
    Sums(PyReadonlyArrayDyn<'py, f64>, PyReadonlyArrayDyn<'py, f64>),
    Sweep(Sweep),
}

impl<'py> AngleArgument<'py> {
    /// An array, a pair of arrays or a sweep.
    fn new(angle: &Bound<'py, PyAny>) -> PyResult<Self> {
        if let Ok(array) = angle.extract() {
            Ok(Self::Array(array))
        } else if let Ok((angle, error_terms)) = angle.extract() {
            Ok(Self::Sums(angle, error_terms))
        } else {
            Ok(Self::Sweep(angle.cast::<DriveSweep>()?.get().0))
        }
    }

    /// The shape of the angles; that of a sweep is its length.
    fn shape(&self) -> Vec<usize> {
        match self {
            Self::Array(angle) | Self::Sums(angle, _) => angle.shape().to_vec(),
            Self::Sweep(sweep) => vec![sweep.count()],
        }
    }

    /// The angles with these strides over the samples, unless they are not aligned and in C order.
    fn angles<'a>(&'a self, strides: &'a [usize]) -> Option<Angles<'a>> {
        let source = |array| Some(Source { data: elements(array)?, strides });
        Some(match self {
            Self::Array(angle) => Angles::Array(source(angle)?),
            Self::Sums(angle, error_terms) => Angles::Sums(source(angle)?, elements(error_terms)?),
            Self::Sweep(sweep) => Angles::Sweep(*sweep),
        })
    }
}

/// Drive angles at equal steps.
#[pyclass(frozen, name = "Sweep", module = "cardan._core")]
pub(crate) struct DriveSweep(Sweep);

impl DriveSweep {
    pub(crate) fn sweep(&self) -> Sweep {
        self.0
    }
}

#[pymethods]
impl DriveSweep {
    /// The largest number of samples.
    #[classattr]
    const LONGEST: usize = Sweep::LONGEST;

    /// From `start` to `stop` if these are given, otherwise `count` steps of `per_turn` to a turn.
    #[new]
    fn new(ends: Option<(f64, f64)>, count: usize, per_turn: usize) -> PyResult<Self> {
        let sweep = match ends {
            Some((start, stop)) => Sweep::new(start, stop, count),
            None => Sweep::of_turns(count, per_turn),
        };
        sweep.map(Self).or_raise()
    }

    /// The angles from `first` on, each rounded to a double.
    fn fill(&self, first: usize, mut out: PyReadwriteArray1<'_, f64>) -> PyResult<()> {
        for (i, angle) in slice_mut("out", &mut out)?.iter_mut().enumerate() {
            *angle = self.0.at(first + i);
        }
        Ok(())
    }
}

/// The steps for one set of outputs and the drivelines that they evaluate.
#[pyclass(frozen, name = "Plan", module = "cardan._core")]
pub(crate) struct NativePlan {
    steps: Plan,
    precision: Precision,
    reduction: Option<Reduction>,
    /// Whether results are in single precision.
    single: bool,
    /// The number of planes of the results.
    results: usize,
    lines: Py<Lines>,
    /// The outputs, in the order of their planes.
    shapes: Vec<OutputShape>,
    /// The arrays of the load with their names in messages: torque, speed, acceleration, and the
    /// inertias of the shafts in `inertias`.
    load: Vec<(&'static str, Spread)>,
    inertias: Vec<usize>,
    /// The folded constants of a single driveline.
    constants: Option<FoldedDriveline>,
}

#[pymethods]
impl NativePlan {
    /// The highest order of an output over a turn.
    #[classattr]
    const HIGHEST_ORDER: usize = Turns::HIGHEST_ORDER;

    /// `shapes` give for each output its number of items, if it has an axis for them, and whether it
    /// is a vector. The end of the load is `"drive"` or `"output"`; its arrays are read
    /// when the plan runs. Without a tolerance the arithmetic is that of the results, single or
    /// double precision, unless the driveline is too steep for it.
    #[new]
    #[allow(clippy::too_many_arguments, reason = "flat arguments of one call, named by the caller")]
    fn new(
        lines: Bound<'_, Lines>,
        outputs: Bound<'_, PyTuple>,
        shapes: Vec<(Option<usize>, bool)>,
        shaft_items: Bound<'_, PyList>,
        joint_items: Bound<'_, PyList>,
        load: Option<LoadArrays>,
        tolerance: Option<f64>,
        single: bool,
        reduction: Option<&str>,
        axes: &str,
    ) -> PyResult<Self> {
        let [shaft_items, joint_items] =
            [numbers(shaft_items.iter())?, numbers(joint_items.iter())?];
        let (mut end, mut load_arrays, mut inertias) = (None, vec![], vec![]);
        if let Some((given, torque, speed, acceleration, of_shafts)) = load {
            let of = End::named(&given).or_raise()?;
            end = Some(of);
            load_arrays =
                vec![(of.torque_name(), torque), ("speed", speed), ("acceleration", acceleration)];
            for (shaft, array) in of_shafts {
                inertias.push(shaft);
                load_arrays.push(("inertias", array));
            }
        }
        let items = shaft_items.len().saturating_add(joint_items.len());
        check_memory(lines.get().batch().joints().saturating_add(items).saturating_mul(2048))?;
        let shape = |(name, (items, is_vector)): (Bound<'_, PyAny>, _)| {
            Ok(OutputShape { name: name.cast_into::<PyString>()?.unbind(), items, is_vector })
        };
        let shapes = outputs.iter().zip(shapes).map(shape).collect::<PyResult<_>>()?;
        let outputs =
            outputs.iter().map(|name| Output::named(&name.extract::<PyBackedStr>()?).or_raise());
        let outputs = outputs.collect::<PyResult<Vec<_>>>()?;
        let batch = lines.get().batch();
        let request = Request {
            largest_bends: &batch.largest_bends,
            outputs: &outputs,
            shafts: &shaft_items,
            joints: &joint_items,
            load: end,
            inertias: &inertias,
            bearings: batch.bearings.as_deref(),
            as_built: batch.as_built,
            axes: Axes::named(axes).or_raise()?,
        };
        let plan = Plan::new(&request).or_raise()?;
        let precision = plan.precision(tolerance, single);
        let reduction = reduction.map(Reduction::named).transpose().or_raise()?;
        let results = reduction.map_or(plan.planes(), |reduction| reduction.results(&plan));
        let constants = if lines.get().is_one() {
            let fold = |arrays: Drivelines<'_>| plan.fold(&arrays, precision).or_raise();
            Some(lines.get().with(lines.py(), fold)?)
        } else {
            None
        };
        Ok(Self {
            steps: plan,
            precision,
            reduction,
            single,
            results,
            lines: lines.unbind(),
            shapes,
            load: load_arrays,
            inertias,
            constants,
        })
    }

    /// The largest magnitudes of the outputs over a turn, or with `least` the least ones, of each
    /// shaft, joint or bearing in each row of this shape, and the drive angles at which each occurs.
    fn peaks(
        &self,
        py: Python<'_>,
        shape: Vec<usize>,
        least: bool,
        workers: Option<usize>,
    ) -> PyResult<Vec<(f64, Vec<f64>)>> {
        let sought = if least { Sought::Least } else { Sought::Largest };
        let peaks =
            self.turned(py, &shape, workers, |turns, execution| turns.peaks(sought, execution))?;
        Ok(peaks.into_iter().map(|peak| (peak.value, peak.places)).collect())
    }

    /// Mean, bound on the error and complex amplitudes of every plane over a turn, in each row of
    /// this shape: over the drive angle, or if `driven` over the angle of the last shaft.
    #[allow(clippy::too_many_arguments, reason = "flat arguments of one call")]
    fn orders<'py>(
        &self,
        py: Python<'py>,
        shape: Vec<usize>,
        orders: Vec<usize>,
        driven: bool,
        tolerance: f64,
        workers: Option<usize>,
    ) -> PyResult<[Bound<'py, PyArray1<f64>>; 3]> {
        let found = self.turned(py, &shape, workers, |turns, execution| {
            turns.orders(&orders, driven, tolerance, execution)
        })?;
        let amplitudes = found.amplitudes.into_flattened();
        Ok([found.mean, found.error, amplitudes].map(|array| array.into_pyarray(py)))
    }

    /// A description of the steps taken and skipped, for samples of a shape to which the drivelines
    /// and the angles broadcast. The angles are those of `sweep` if it is given.
    fn explain(
        &self,
        py: Python<'_>,
        shape: Vec<usize>,
        sweep: Option<&DriveSweep>,
    ) -> PyResult<String> {
        let lines = self.lines.get();
        let line_strides = strides(BATCH, &lines.batch().shape, &shape).or_raise()?;
        let still = vec![0; shape.len()];
        let angle = match sweep {
            Some(sweep) => Angles::Sweep(sweep.0),
            None => Angles::Array(Source { data: &[0.0], strides: &still }),
        };
        let load = self.read_load(py, &shape)?;
        let load = self.load_of(&load)?;
        let (precision, reduction, single) = (self.precision, self.reduction, self.single);
        let call = Call { precision, reduction, single };
        lines.with(py, |lines| {
            let (shape, line_strides) = (&shape, &line_strides);
            let samples = Samples { shape, lines, line_strides, angle, load };
            self.steps.explain(&samples, call).or_raise()
        })
    }

    /// The drive angles at angles of the last shaft, and their error terms: two planes in the shape
    /// of the samples. `None` if the angles are not aligned and in C order.
    fn drive_angles<'py>(
        &self,
        py: Python<'py>,
        shape: Vec<usize>,
        angle: Bound<'py, PyAny>,
        workers: Option<usize>,
        level: Option<&str>,
    ) -> PyResult<Option<Bound<'py, PyAny>>> {
        let level = level.map(level::named).transpose().or_raise()?;
        let (angle, batch) = (AngleArgument::new(&angle)?, self.lines.get().batch());
        let angle_strides = strides("angle", &angle.shape(), &shape).or_raise()?;
        let line_strides = strides(BATCH, &batch.shape, &shape).or_raise()?;
        let Some(angle) = angle.angles(&angle_strides) else { return Ok(None) };
        let brief = count(&shape)? < MIN_INTERRUPTIBLE;
        self.lines.get().with(py, |lines| {
            let (shape, line_strides) = (&shape, &line_strides);
            let samples = Samples { shape, lines, line_strides, angle, load: None };
            filled(py, 2, shape, |planes: &mut [&mut [f64]]| {
                let Ok([angles, error_terms]) = planes.get_disjoint_mut([0, 1]) else {
                    return Ok(());
                };
                let mut done = Ok(());
                run_released(py, brief, workers, &mut |workers, stop| {
                    let execution = Execution { level, workers, stop, new_memory: true };
                    let out = [&mut **angles, &mut **error_terms];
                    done = drive_angles(batch.joints(), &samples, out, execution);
                })?;
                done.or_raise()
            })
            .map(Some)
        })
    }

    /// Fills a new array, the arrays of a list, which hold the planes one after another, or those
    /// of a dictionary by output, and returns what it has filled, a dictionary in the order of the
    /// outputs. Returns `None` if the angles or an array of `out` are not aligned and in C order,
    /// each component of a vector by itself, if an array of `out` is read-only or borrowed by
    /// another call or as an input of this one, and if a dictionary does not have exactly the
    /// outputs with their shapes and word.
    ///
    /// Without a shape, the samples have the shape of the angles, and only the angle changes among
    /// them.
    fn run<'py>(
        &self,
        py: Python<'py>,
        shape: Option<Bound<'py, PyTuple>>,
        angle: Bound<'py, PyAny>,
        out: Option<Bound<'py, PyAny>>,
        workers: Option<usize>,
        level: Option<&str>,
    ) -> PyResult<Option<Bound<'py, PyAny>>> {
        let level = level.map(level::named).transpose().or_raise()?;
        let angle = AngleArgument::new(&angle)?;
        let own = angle.shape();
        let count: usize = own.iter().product();
        let shape = shape.map(|shape| numbers(shape.iter())).transpose()?;
        // If only the angle changes, the samples are one row, whatever the shape of the angles.
        let (own, shape, rows) = match &shape {
            Some(shape) => (own.as_slice(), shape.as_slice(), shape.as_slice()),
            None => (&[count][..], &[count][..], own.as_slice()),
        };
        let lines = self.lines.get();
        let line_strides = strides(BATCH, &lines.batch().shape, shape).or_raise()?;
        let angle_strides = strides("angle", own, shape).or_raise()?;
        let load = self.read_load(py, shape)?;
        let rows = match (self.reduction, shape.split_last()) {
            (Some(_), Some((1.., rows))) => rows,
            (Some(_), _) => return Err(argument_error("shape", "has no samples to reduce")),
            (None, _) => rows,
        };
        let Some(angle) = angle.angles(&angle_strides) else { return Ok(None) };
        let load = self.load_of(&load)?;
        let execution = Execution { level, workers, stop: None, new_memory: out.is_none() };
        lines.with(py, |lines| {
            let line_strides = &line_strides;
            let samples = Samples { shape, lines, line_strides, angle, load };
            let run = |planes: Planes<'_, '_>| {
                if shape.contains(&0) {
                    return Ok(());
                }
                self.execute(py, &samples, planes, execution)
            };
            let double = |planes: &mut [&mut [f64]]| run(Planes::Double(planes));
            let single = |planes: &mut [&mut [f32]]| run(Planes::Single(planes));
            match (out, self.single && self.reduction.is_none()) {
                (None, false) => filled(py, self.results, rows, double).map(Some),
                (None, true) => filled(py, self.results, rows, single).map(Some),
                (Some(out), false) => self.fill(out, rows, double),
                (Some(out), true) => self.fill(out, rows, single),
            }
        })
    }
}

impl NativePlan {
    /// Runs `body` with the drivelines and the load broadcast to rows of this shape, which are turned
    /// once each, and with how to use the machine.
    pub(crate) fn turned<R: Send>(
        &self,
        py: Python<'_>,
        shape: &[usize],
        workers: Option<usize>,
        body: impl Fn(&Turns<'_>, Execution<'_>) -> cardan::Result<R> + Sync,
    ) -> PyResult<R> {
        let lines = self.lines.get();
        let line_strides =
            strides("the driveline's batch", &lines.batch().shape, shape).or_raise()?;
        let load = self.read_load(py, shape)?;
        let load = self.load_of(&load)?;
        lines.with(py, |lines| {
            let rows = Rows { shape, lines, line_strides: &line_strides, load };
            let turns = Turns { plan: &self.steps, rows: &rows, precision: self.precision };
            run_rows(py, rows.count(), workers, |execution| body(&turns, execution))
        })
    }

    /// The arrays of the load with their strides over samples of this shape.
    fn read_load<'py>(&self, py: Python<'py>, shape: &[usize]) -> PyResult<Vec<Strided<'py>>> {
        let read = |(name, array): &(&'static str, Spread)| {
            let array = array.bind(py).try_readonly()?;
            let strides = strides(name, array.shape(), shape).or_raise()?;
            Ok((array, strides))
        };
        self.load.iter().map(read).collect()
    }

    /// The load from these arrays, if there is one.
    fn load_of<'a>(&self, arrays: &'a [Strided<'_>]) -> PyResult<Option<Load<'a>>> {
        if arrays.is_empty() {
            return Ok(None);
        }
        let source = |i: usize| -> PyResult<_> {
            let (array, strides) = &arrays[i];
            let data = elements(array).ok_or_else(|| not_contiguous(self.load[i].0))?;
            Ok(Source { data, strides })
        };
        let inertia = |(i, &shaft)| Ok((shaft, source(3 + i)?));
        Ok(Some(Load {
            torque: source(0)?,
            speed: source(1)?,
            acceleration: source(2)?,
            inertias: self.inertias.iter().enumerate().map(inertia).collect::<PyResult<_>>()?,
        }))
    }

    /// Runs `body` with the planes of the arrays in `out`, as [`NativePlan::run`] says.
    fn fill<'py, W: Element>(
        &self,
        out: Bound<'py, PyAny>,
        rows: &[usize],
        body: impl FnOnce(&mut [&mut [W]]) -> PyResult<()>,
    ) -> PyResult<Option<Bound<'py, PyAny>>> {
        let (arrays, filled) = if let Ok(out) = out.cast_exact::<PyDict>() {
            let filled = PyDict::new(out.py());
            if out.len() != self.shapes.len() {
                return Ok(None);
            }
            let mut arrays = Vec::with_capacity(out.len());
            for shape in &self.shapes {
                let Some(array) = out.get_item(&shape.name)? else { return Ok(None) };
                let Some(planes) = shape.planes_of::<W>(&array, rows)? else { return Ok(None) };
                arrays.push(planes);
                filled.set_item(&shape.name, array)?;
            }
            (arrays, filled.into_any())
        } else {
            let list = out.cast_into::<PyList>()?;
            let arrays = list.iter().map(|array| Ok(array.cast_into::<PyArrayDyn<W>>()?));
            (arrays.collect::<PyResult<_>>()?, list.into_any())
        };
        Ok(fill(arrays, rows, body)?.then_some(filled))
    }

    /// Runs or reduces: directly if the run is brief, interruptibly if it is long.
    fn execute(
        &self,
        py: Python<'_>,
        samples: &Samples<'_>,
        mut planes: Planes<'_, '_>,
        execution: Execution<'_>,
    ) -> PyResult<()> {
        let (total, workers) = (count(samples.shape)?, execution.workers);
        let parallel = uses_threads(total);
        let workers = if parallel { threads(workers) } else { workers };
        let (plan, precision, constants) = (&self.steps, self.precision, self.constants.as_ref());
        // This does not query the pool, which may not exist.
        let alone = !parallel || workers == Some(1);
        let threads = if alone { 1 } else { rayon::current_num_threads() };
        check_memory(plan.scratch_bytes(samples, constants.is_some(), self.reduction, threads))?;
        let mut run = |stop: Option<&AtomicBool>| {
            let execution = Execution { workers, stop, ..execution };
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
        let joints = if constants.is_some() { 0 } else { self.lines.get().batch().joints() };
        let result = if total.saturating_mul(plan.planes() + joints) >= MIN_INTERRUPTIBLE {
            return run_interruptible(py, workers, &mut |stop| run(Some(stop)));
        } else if total < MIN_DETACHED {
            run(None)
        } else {
            py.detach(|| run(None))
        };
        result.or_raise()
    }
}

impl OutputShape {
    /// The output's array plane by plane, a vector's components before the samples. `None` if it
    /// does not have the shape of the output over these rows, or another word.
    fn planes_of<'py, W: Element>(
        &self,
        array: &Bound<'py, PyAny>,
        rows: &[usize],
    ) -> PyResult<Option<Bound<'py, PyArrayDyn<W>>>> {
        let exact = array.cast_exact::<PyUntypedArray>().ok();
        let Some(array) = exact.and_then(|_| array.cast::<PyArrayDyn<W>>().ok()) else {
            return Ok(None);
        };
        let components = self.is_vector.then_some(&3);
        if !array.shape().iter().eq(self.items.iter().chain(rows).chain(components)) {
            return Ok(None);
        }
        if !self.is_vector {
            return Ok(Some(array.clone()));
        }
        let (items, last) = (usize::from(self.items.is_some()), array.ndim() - 1);
        let axes = (0..items).chain(once(last)).chain(items..last).collect::<Vec<_>>();
        array.permute(Some(axes)).map(Some)
    }
}

/// Runs `body` with the planes, which are stored in arrays one after another. Returns whether it
/// did: no array may be borrowed by another call or not in C order.
fn fill<W: Element>(
    out: Vec<Bound<'_, PyArrayDyn<W>>>,
    rows: &[usize],
    body: impl FnOnce(&mut [&mut [W]]) -> PyResult<()>,
) -> PyResult<bool> {
    let length = count(rows)?;
    let mut arrays = Vec::with_capacity(out.len());
    for array in out {
        let Ok(array) = array.try_readwrite() else { return Ok(false) };
        arrays.push(array);
    }
    let mut planes = vec![];
    for array in &mut arrays {
        let c_order = array.is_c_contiguous();
        let Some(words) = array.as_slice_mut().ok().filter(|_| c_order) else { return Ok(false) };
        planes.extend(words.chunks_mut(length.max(1)));
    }
    body(&mut planes)?;
    Ok(true)
}

/// A new array of `planes` planes, each of the given shape, filled by `body`.
#[expect(unsafe_code, reason = "NumPy's allocator; a new array needs no look whether it is in use")]
fn filled<'py, W: Element>(
    py: Python<'py>,
    planes: usize,
    rows: &[usize],
    body: impl FnOnce(&mut [&mut [W]]) -> PyResult<()>,
) -> PyResult<Bound<'py, PyAny>> {
    let length = count(rows)?;
    let bytes = length.saturating_mul(planes.max(1)).saturating_mul(size_of::<W>());
    if isize::try_from(bytes).is_err() {
        return Err(no_memory(bytes));
    }
    let lengths = once(&planes).chain(rows).map(|&length| npy_intp::try_from(length));
    let mut axes = lengths.collect::<Result<Vec<_>, _>>()?;
    let (count, word) = (c_int::try_from(axes.len())?, numpy::dtype::<W>(py).into_dtype_ptr());
    // SAFETY: `axes` has `count` lengths. NumPy takes over the reference to `word`. The pointer is
    // a new reference, or null with an exception set.
    let array = unsafe {
        let array = PY_ARRAY_API.PyArray_Empty(py, count, axes.as_mut_ptr(), word, 0);
        Bound::from_owned_ptr_or_err(py, array)?.cast_into::<PyArrayDyn<W>>()?
    };
    // SAFETY: no one else has a reference to the array. Its words are initialised to whatever
    // NumPy's allocator returned, as in an array from `numpy.empty` that a caller passes as `out`;
    // they are written before they are read.
    let words = unsafe { array.as_slice_mut()? };
    body(&mut words.chunks_mut(length.max(1)).collect::<Vec<_>>())?;
    Ok(array.into_any())
}

/// The elements of an array, if it is aligned and in C order.
pub(crate) fn elements<'a>(array: &'a PyReadonlyArrayDyn<'_, f64>) -> Option<&'a [f64]> {
    let c_order = array.is_c_contiguous();
    array.as_slice().ok().filter(|_| c_order)
}

/// Extracts integers; items of lists and tuples are faster to read than those of a general
/// sequence.
fn numbers<'py>(items: impl Iterator<Item = Bound<'py, PyAny>>) -> PyResult<Vec<usize>> {
    items.map(|item| item.extract()).collect()
}

/// The instruction sets that the kernels can use on this machine, strongest first.
#[pyfunction]
pub(crate) fn levels() -> Vec<&'static str> {
    level::available().into_iter().map(|(name, _)| name).collect()
}

/// An output: name, `"shaft"`, `"joint"` or `"bearing"`, unit, meaning, equation, axes of a vector, whether
/// it needs a load, and whether only ideal joints have it.
type OutputRow = (
    &'static str,
    &'static str,
    &'static str,
    &'static str,
    &'static str,
    Vec<&'static str>,
    bool,
    bool,
);

/// The table of outputs.
#[pyfunction]
pub(crate) fn outputs() -> Vec<OutputRow> {
    let row = |output: Output| {
        let row = output.row();
        let axes = row.components.iter().copied().filter(|axis| !axis.is_empty()).collect();
        let per = row.per.name();
        let (meaning, source) = (output.meaning(), output.source());
        let of = (output.needs_load(), output.is_ideal());
        (row.name, per, row.unit, meaning, source, axes, of.0, of.1)
    };
    Output::ALL.into_iter().map(row).collect()
}
