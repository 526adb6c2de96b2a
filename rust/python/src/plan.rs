//! Plans: what to compute, prepared once for its drivelines; and running them over samples.

use cardan::{
    Angles, Call, Constants, Drivelines, End, Execution, Level, Load, Output as Quantity,
    Plan as CorePlan, Planes, Precision, Reduction, Request, Samples, Source, Sweep, level,
};
use numpy::{
    Element, PyArrayDyn, PyArrayMethods, PyReadonlyArrayDyn, PyReadwriteArray1,
    PyUntypedArrayMethods,
};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::pybacked::PyBackedStr;

use crate::convert::{Input, slice, slice_mut, value_error};
use crate::lines::Lines;

/// Samples that are done before it is worth giving the interpreter away.
const BRIEF: usize = 1000;

/// A flat array and its strides over the samples.
type Broadcast<'py> = (Input<'py>, Vec<usize>);

/// Torque, speed, acceleration, and the inertias with their shafts.
type LoadArrays<'py> =
    (Broadcast<'py>, Broadcast<'py>, Broadcast<'py>, Vec<(usize, Input<'py>, Vec<usize>)>);

/// Arrays to fill, each holding planes one after another.
#[derive(FromPyObject)]
enum Out<'py> {
    Double(Vec<PyReadwriteArray1<'py, f64>>),
    Single(Vec<PyReadwriteArray1<'py, f32>>),
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
        outputs: Vec<PyBackedStr>,
        shaft_items: Vec<usize>,
        joint_items: Vec<usize>,
        load: Option<&str>,
        inertias: Vec<usize>,
        tolerance: Option<f64>,
        single: bool,
        reduction: Option<&str>,
    ) -> PyResult<Self> {
        let outputs = outputs.iter().map(|name| quantity(name)).collect::<PyResult<Vec<_>>>()?;
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
        out: Vec<Bound<'_, PyArrayDyn<f64>>>,
        workers: Option<usize>,
    ) -> PyResult<bool> {
        let c_order = angle.is_c_contiguous();
        let Some(angle) = angle.as_slice().ok().filter(|_| c_order) else { return Ok(false) };
        let total = angle.len();
        let Ok(mut out) =
            out.iter().map(PyArrayMethods::try_readwrite).collect::<Result<Vec<_>, _>>()
        else {
            return Ok(false);
        };
        let mut planes: Vec<&mut [f64]> = vec![];
        for array in &mut out {
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
            let execution = Execution { level: None, workers };
            let mut run = || {
                let (constants, planes) = (self.constants.as_ref(), Planes::Double(&mut planes));
                self.steps.run(&samples, constants, self.precision, planes, execution)
            };
            let result = if total < BRIEF { run() } else { py.detach(run) };
            result.map_err(|error| value_error(&error))
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
        let execution = Execution { level: level.map(named_level).transpose()?, workers };
        let total = match self.reduction {
            Some(_) => shape[..shape.len() - 1].iter().product::<usize>().max(1),
            None => shape.iter().product::<usize>().max(1),
        };
        if shape.contains(&0) {
            return Ok(());
        }
        let load = load.as_ref().map(borrow_load).transpose()?;
        let angle = match (&sweep, &angle) {
            (Some(sweep), _) => Angles::Sweep(sweep.get().0),
            (None, Some(array)) => Angles::Array(source("angle", array)?),
            (None, None) => return Err(PyValueError::new_err("angle is missing")),
        };
        self.lines.get().with(py, |lines| {
            let samples =
                Samples { shape: &shape, lines, line_strides: &line_strides, angle, load };
            let (plan, precision) = (&self.steps, self.precision);
            let constants = self.constants.as_ref();
            let run = |planes: Planes<'_, '_>| {
                let result = py.detach(|| match (self.reduction, planes) {
                    (Some(reduction), Planes::Double(planes)) => {
                        plan.reduce(&samples, constants, precision, reduction, planes, execution)
                    }
                    (_, planes) => plan.run(&samples, constants, precision, planes, execution),
                });
                result.map_err(|error| value_error(&error))
            };
            match out {
                Out::Double(mut out) => run(Planes::Double(&mut planes_of(&mut out, total)?)),
                Out::Single(mut out) => run(Planes::Single(&mut planes_of(&mut out, total)?)),
            }
        })
    }
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
