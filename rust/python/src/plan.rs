//! Plans: what to compute, prepared once for its drivelines; and running them over samples.

use cardan::{
    Angles, Call, Constants, Drivelines, End, Execution, Level, Load, Output as Quantity,
    Plan as CorePlan, Planes, Precision, Reduction, Request, Samples, Source, Sweep, level,
};
use numpy::{Element, PyArray1, PyArrayMethods, PyReadwriteArray1};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::pybacked::PyBackedStr;

use crate::convert::{Input, slice, slice_mut, value_error};

/// A flat array and its strides over the samples.
type Broadcast<'py> = (Input<'py>, Vec<usize>);

/// Torque, speed, acceleration, and the inertias with their shafts.
type LoadArrays<'py> =
    (Broadcast<'py>, Broadcast<'py>, Broadcast<'py>, Vec<(usize, Input<'py>, Vec<usize>)>);

/// Bends, twists, phases, directions and normals of the drivelines.
enum Geometry {
    /// One driveline, folded.
    One([Vec<f64>; 5], Constants),
    /// A batch, whose arrays never change.
    Batch([Py<PyArray1<f64>>; 5]),
}

impl Geometry {
    /// Runs `body` with the drivelines, and what is folded of them.
    fn with<R>(
        &self,
        py: Python<'_>,
        body: impl FnOnce(Drivelines<'_>, Option<&Constants>) -> PyResult<R>,
    ) -> PyResult<R> {
        match self {
            Self::One([bends, twists, phases, directions, normals], constants) => {
                let lines = Drivelines { bends, twists, phases, directions, normals };
                body(lines, Some(constants))
            }
            Self::Batch(arrays) => {
                let [bends, twists, phases, directions, normals] =
                    arrays.each_ref().map(|array| array.bind(py).try_readonly());
                let (bends, twists, phases) = (bends?, twists?, phases?);
                let (directions, normals) = (directions?, normals?);
                let lines = Drivelines {
                    bends: slice("bends", &bends)?,
                    twists: slice("twists", &twists)?,
                    phases: slice("phases", &phases)?,
                    directions: slice("directions", &directions)?,
                    normals: slice("normals", &normals)?,
                };
                body(lines, None)
            }
        }
    }
}

/// The drive angles of a call.
#[derive(FromPyObject)]
enum Drive<'py> {
    Sweep(Bound<'py, DriveSweep>),
    Array(Broadcast<'py>),
}

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
    plan: CorePlan,
    precision: Precision,
    reduction: Option<Reduction>,
    geometry: Geometry,
}

#[pymethods]
impl Plan {
    /// `load` is `None`, `"drive"` or `"output"`: where the load's torque is given. `geometry` is
    /// bends, twists, phases, directions and normals of the drivelines, flat.
    #[new]
    #[allow(clippy::too_many_arguments, reason = "flat arguments of one call, named by the caller")]
    fn new(
        joints: usize,
        outputs: Vec<PyBackedStr>,
        shaft_items: Vec<usize>,
        joint_items: Vec<usize>,
        load: Option<&str>,
        inertias: Vec<usize>,
        geometry: [Bound<'_, PyArray1<f64>>; 5],
        precision: &str,
        reduction: Option<&str>,
    ) -> PyResult<Self> {
        let outputs = outputs.iter().map(|name| quantity(name)).collect::<PyResult<Vec<_>>>()?;
        let load = load.map(end).transpose()?;
        let precision = self::precision(precision)?;
        let reduction = reduction.map(self::reduction).transpose()?;
        let arrays = geometry.each_ref().map(|array| array.try_readonly());
        let [bends, twists, phases, directions, normals] = arrays;
        let (bends, twists, phases) = (bends?, twists?, phases?);
        let (directions, normals) = (directions?, normals?);
        let lines = Drivelines {
            bends: slice("bends", &bends)?,
            twists: slice("twists", &twists)?,
            phases: slice("phases", &phases)?,
            directions: slice("directions", &directions)?,
            normals: slice("normals", &normals)?,
        };
        let request = Request {
            largest_bends: &lines.largest_bends(joints),
            outputs: &outputs,
            shafts: &shaft_items,
            joints: &joint_items,
            load,
            inertias: &inertias,
        };
        let plan = CorePlan::new(&request).map_err(|error| value_error(&error))?;
        let geometry = if lines.bends.len() == joints {
            let own = [lines.bends, lines.twists, lines.phases, lines.directions, lines.normals];
            let constants = plan.fold(&lines, precision).map_err(|error| value_error(&error))?;
            Geometry::One(own.map(<[f64]>::to_vec), constants)
        } else {
            Geometry::Batch(geometry.map(Bound::unbind))
        };
        Ok(Self { plan, precision, reduction, geometry })
    }

    /// Number of planes of a result.
    fn planes(&self) -> usize {
        self.reduction.map_or(self.plan.planes(), |reduction| reduction.results(&self.plan))
    }

    /// The steps taken and skipped, in words.
    fn explain(&self, py: Python<'_>, sweep: bool, single: bool) -> PyResult<String> {
        let call = Call { precision: self.precision, reduction: self.reduction, sweep, single };
        self.geometry.with(py, |lines, _| Ok(self.plan.explain(&lines, &call)))
    }

    /// Fills `out`, flat arrays that hold the planes one after another.
    ///
    /// The strides say which driveline and which element each sample of the given shape
    /// sees.
    #[allow(clippy::too_many_arguments, reason = "flat arrays of one call, named by the caller")]
    fn run(
        &self,
        py: Python<'_>,
        shape: Vec<usize>,
        line_strides: Vec<usize>,
        angle: Drive<'_>,
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
        let angle = match &angle {
            Drive::Sweep(sweep) => Angles::Sweep(sweep.get().0),
            Drive::Array(array) => Angles::Array(source("angle", array)?),
        };
        self.geometry.with(py, |lines, constants| {
            let samples =
                Samples { shape: &shape, lines, line_strides: &line_strides, angle, load };
            let (plan, precision) = (&self.plan, self.precision);
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

fn precision(name: &str) -> PyResult<Precision> {
    match name {
        "single" => Ok(Precision::Single),
        "double" => Ok(Precision::Double),
        "two" => Ok(Precision::InTwo),
        other => Err(PyValueError::new_err(format!("precision is {other:?}"))),
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
