//! Plans: what to compute, prepared once; and running them over samples.

use cardan::{
    Drivelines, End, Execution, Level, Load, Output as Quantity, Plan as CorePlan, Request,
    Samples, Source, level,
};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::convert::{Input, Output, slice, slice_mut, value_error};

/// A flat array and its strides over the samples.
type Broadcast<'py> = (Input<'py>, Vec<usize>);

/// Torque, speed, acceleration, and the inertias with their shafts.
type LoadArrays<'py> =
    (Broadcast<'py>, Broadcast<'py>, Broadcast<'py>, Vec<(usize, Input<'py>, Vec<usize>)>);

/// The steps for one set of outputs.
#[pyclass(frozen, module = "cardan._core")]
pub(crate) struct Plan {
    plan: CorePlan,
}

#[pymethods]
impl Plan {
    /// `load` is `None`, `"drive"` or `"output"`: where the load's torque is given.
    #[new]
    #[pyo3(signature = (joints, outputs, shaft_items, joint_items, load, inertias))]
    fn new(
        joints: usize,
        outputs: Vec<String>,
        shaft_items: Vec<usize>,
        joint_items: Vec<usize>,
        load: Option<&str>,
        inertias: Vec<usize>,
    ) -> PyResult<Self> {
        let outputs = outputs.iter().map(|name| quantity(name)).collect::<PyResult<Vec<_>>>()?;
        let load = match load {
            None => None,
            Some("drive") => Some(End::Drive),
            Some("output") => Some(End::Output),
            Some(other) => {
                return Err(PyValueError::new_err(format!("load is {other:?}")));
            }
        };
        let request = Request {
            joint_count: joints,
            outputs: &outputs,
            shafts: &shaft_items,
            joints: &joint_items,
            load,
            inertias: &inertias,
        };
        let plan = CorePlan::new(&request).map_err(|error| value_error(&error))?;
        Ok(Self { plan })
    }

    /// Fills `out`, one flat array per output, each holding its planes one after another.
    ///
    /// `geometry` is bends, twists, phases, directions and normals; `lines` and the strides say
    /// which driveline and which element each sample of the given shape sees.
    #[allow(clippy::too_many_arguments, reason = "flat arrays of one call, named by the caller")]
    #[pyo3(signature = (shape, geometry, lines, angle, load, out, workers, level))]
    fn run(
        &self,
        py: Python<'_>,
        shape: Vec<usize>,
        geometry: [Input<'_>; 5],
        lines: Vec<usize>,
        angle: Broadcast<'_>,
        load: Option<LoadArrays<'_>>,
        mut out: Vec<Output<'_>>,
        workers: Option<usize>,
        level: Option<&str>,
    ) -> PyResult<()> {
        let [bends, twists, phases, directions, normals] = &geometry;
        let samples = Samples {
            shape: &shape,
            lines: Drivelines {
                bends: slice("bends", bends)?,
                twists: slice("twists", twists)?,
                phases: slice("phases", phases)?,
                directions: slice("directions", directions)?,
                normals: slice("normals", normals)?,
            },
            line_strides: &lines,
            angle: source("angle", &angle)?,
            load: load.as_ref().map(borrow_load).transpose()?,
        };
        let total = shape.iter().product::<usize>().max(1);
        let mut planes = Vec::with_capacity(self.plan.planes());
        for array in &mut out {
            planes.extend(slice_mut("out", array)?.chunks_mut(total));
        }
        let execution = Execution { level: level.map(named_level).transpose()?, workers };
        if shape.contains(&0) {
            return Ok(());
        }
        py.detach(|| self.plan.run(&samples, &mut planes, execution))
            .map_err(|error| value_error(&error))
    }
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
