//! Derivatives of outputs and of transmissions by the parameters of drivelines.

use std::sync::atomic::AtomicBool;

use cardan::{
    Axes, Differentiated, End, Execution, Output, Parameters, Spread, SpreadAngles, SpreadLoad,
    Wanted, level, q_derivatives,
};
use numpy::{Complex64, IntoPyArray, PyArray1, PyReadonlyArray1};
use pyo3::exceptions::PyIndexError;
use pyo3::prelude::*;
use pyo3::pybacked::PyBackedStr;

use crate::convert::{OrRaise, argument_error, slice};
use crate::lines::Lines;
use crate::plan::DriveSweep;
use crate::watch::{reserve, run_released, threads};

/// The fewest joints in all whose derivatives are interruptible.
const MIN_INTERRUPTIBLE: usize = 1 << 14;

/// The fewest samples of a motion in all that are interruptible, which take a millisecond.
const MIN_INTERRUPTIBLE_MOTIONS: usize = 1 << 19;

/// The derivatives of `q` of a shaft by all `"bends"`, `"twists"`, `"phases"` or `"points"` of each
/// driveline, one driveline after another.
#[pyfunction]
pub(crate) fn dq<'py>(
    py: Python<'py>,
    lines: &Lines,
    shaft: usize,
    by: &str,
    workers: Option<usize>,
) -> PyResult<Bound<'py, PyArray1<Complex64>>> {
    let joints = lines.batch().joints();
    if shaft > joints {
        let problem = format!("shaft is {shaft}; there are {}", joints + 1);
        return Err(PyIndexError::new_err(problem));
    }
    let by = parameters(by)?;
    lines.batch().check_ideal("q and its derivatives are").or_raise()?;
    lines.with(py, |lines| {
        let count = lines.bends.len() / joints;
        if by == Parameters::Points && lines.lengths.len() != count * (joints + 1) {
            return Err(argument_error("by", "is \"points\"; the shafts have no lengths"));
        }
        let mut out = vec![];
        reserve(&mut out, count.saturating_mul(by.count(joints)))?;
        out.resize(count * by.count(joints), Complex64::default());
        let brief = lines.bends.len() < MIN_INTERRUPTIBLE;
        run_released(py, brief, workers, &mut |workers, stop| {
            let execution = Execution { workers, stop, ..Execution::default() };
            q_derivatives(joints, shaft, by, &lines, &mut out, execution);
        })?;
        Ok(out.into_pyarray(py))
    })
}

fn parameters(name: &str) -> PyResult<Parameters> {
    match name {
        "bends" => Ok(Parameters::Bends),
        "twists" => Ok(Parameters::Twists),
        "phases" => Ok(Parameters::Phases),
        "points" => Ok(Parameters::Points),
        other => Err(argument_error("by", format!("is {other:?}, which is unknown"))),
    }
}

/// A flat array with its steps from one driveline and from one sample to the next.
type Stepped<'py> = (PyReadonlyArray1<'py, f64>, usize, usize);

/// The end of the torque, the torque, speed and acceleration, and the inertias by shaft.
type SteppedLoad<'py> =
    (PyBackedStr, Stepped<'py>, Stepped<'py>, Stepped<'py>, Vec<(usize, Stepped<'py>)>);

#[derive(FromPyObject)]
pub(crate) enum AngleInput<'py> {
    Sweep(PyRef<'py, DriveSweep>),
    Array(Stepped<'py>),
}

/// The derivatives of outputs of each driveline, which has so many samples.
///
/// With weights, which are one plane per item and component of an output, the weighted sums over
/// the samples; without, those of each plane, driveline and sample. The last axis of the flat result
/// has what is wanted, in the order of the core. `modes` are the axes of moments, and whether the derivatives are those at angles of the last shaft.
#[pyfunction]
#[allow(clippy::too_many_arguments, reason = "a call has all its arrays")]
pub(crate) fn differentiate<'py>(
    py: Python<'py>,
    lines: &Lines,
    outputs: Vec<(PyBackedStr, Vec<usize>)>,
    samples: usize,
    angle: AngleInput<'py>,
    load: Option<SteppedLoad<'py>>,
    weights: Option<Vec<PyReadonlyArray1<'py, f64>>>,
    wanted: Vec<PyBackedStr>,
    modes: (PyBackedStr, bool),
    workers: Option<usize>,
    level: Option<&str>,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let joints = lines.batch().joints();
    let wanted = self::wanted(&wanted)?;
    let level = level.map(level::named).transpose().or_raise()?;
    let (axes, driven) = (Axes::named(&modes.0).or_raise()?, modes.1);
    let bearings = lines.batch().bearings.as_deref().unwrap_or_default();
    let name =
        |(name, items): (PyBackedStr, Vec<usize>)| Ok((Output::named(&name).or_raise()?, items));
    let outputs = outputs.into_iter().map(name).collect::<PyResult<Vec<_>>>()?;
    let angle = match &angle {
        AngleInput::Sweep(sweep) => SpreadAngles::Sweep(sweep.sweep()),
        AngleInput::Array(stepped) => SpreadAngles::Array(spread("angle", stepped)?),
    };
    let load = load.as_ref().map(|load| spread_load(load, joints)).transpose()?;
    let weights = match &weights {
        Some(planes) => {
            let planes = planes.iter().map(|plane| slice("weights", plane));
            Some(planes.collect::<PyResult<Vec<_>>>()?)
        }
        None => None,
    };
    if wanted.points {
        lines.batch().check_ideal("derivatives by points are").or_raise()?;
    }
    if wanted.deviations || lines.batch().as_built {
        check_as_built(axes, driven)?;
        if let Some((output, _)) = outputs.iter().find(|(output, _)| output.is_ideal()) {
            let name = output.row().name;
            let problem = format!("have {name:?}, which has no derivatives by deviations");
            return Err(argument_error("outputs", problem));
        }
    }
    lines.with(py, |lines| {
        let task =
            Differentiated { joints, lines, bearings, samples, outputs, axes, angle, driven, load };
        let total = task.line_count().saturating_mul(samples);
        let misfit = |name: &'static str| argument_error(name, "does not fit the samples");
        if !task.is_complete() {
            return Err(misfit("angle"));
        }
        if (wanted.points || wanted.lengths)
            && lines.lengths.len() != task.line_count() * (joints + 1)
        {
            return Err(argument_error("by", "needs lengths, which are unknown"));
        }
        if let Some(weights) = &weights
            && (weights.len() != task.planes() || weights.iter().any(|x| x.len() != total))
        {
            return Err(misfit("weights"));
        }
        let rows = match weights {
            Some(_) => task.line_count(),
            None => total.saturating_mul(task.planes()),
        };
        let count = rows.saturating_mul(wanted.count(task.counts()));
        let mut out = vec![];
        reserve(&mut out, count)?;
        out.resize(count, 0.0);
        let mut run = |workers: Option<usize>, stop: Option<&AtomicBool>| {
            let execution = Execution { level, workers, stop, ..Execution::default() };
            match &weights {
                Some(weights) => task.gradient(weights, wanted, &mut out, execution),
                None => task.derivatives(wanted, &mut out, execution),
            }
        };
        let sums_of_motions = weights.is_some() && task.only_motion() && !driven;
        let few = lines.bends.len() < MIN_INTERRUPTIBLE;
        if sums_of_motions && few && total.saturating_mul(task.planes()) < MIN_INTERRUPTIBLE_MOTIONS
        {
            // The pool is not made for what one thread does.
            let workers = if task.is_parallel() { threads(workers) } else { Some(1) };
            py.detach(|| run(workers, None));
        } else {
            let brief = total.saturating_mul(joints) < MIN_INTERRUPTIBLE;
            run_released(py, brief, workers, &mut run)?;
        }
        Ok(out.into_pyarray(py))
    })
}

/// Refuses axes of shafts and given driven angles, by which joints as built have no derivatives.
fn check_as_built(axes: Axes, driven: bool) -> PyResult<()> {
    let problem = if axes == Axes::Shaft {
        "have deviations; their moments are differentiated in the axes of space".to_owned()
    } else if driven {
        "have deviations; derivatives are those at drive angles".to_owned()
    } else {
        return Ok(());
    };
    Err(argument_error("joints", problem))
}

fn spread<'a>(
    name: &'static str,
    (array, per_line, per_sample): &'a Stepped<'_>,
) -> PyResult<Spread<'a>> {
    let data = slice(name, array)?;
    Ok(Spread { data, per_line: *per_line, per_sample: *per_sample })
}

fn spread_load<'a>(load: &'a SteppedLoad<'_>, joints: usize) -> PyResult<SpreadLoad<'a>> {
    let (given, torque, speed, acceleration, of_shafts) = load;
    let mut inertias = vec![None; joints + 1];
    for (shaft, stepped) in of_shafts {
        let Some(inertia) = inertias.get_mut(*shaft) else {
            let problem = format!("are of shaft {shaft}; there are {}", joints + 1);
            return Err(argument_error("inertias", problem));
        };
        *inertia = Some(spread("inertias", stepped)?);
    }
    Ok(SpreadLoad {
        end: End::named(given).or_raise()?,
        torque: spread("torque", torque)?,
        speed: spread("speed", speed)?,
        acceleration: spread("acceleration", acceleration)?,
        inertias,
    })
}

fn wanted(names: &[PyBackedStr]) -> PyResult<Wanted> {
    let mut wanted = Wanted::default();
    for name in names {
        let place = match &**name {
            "value" => &mut wanted.value,
            "bends" => &mut wanted.bends,
            "twists" => &mut wanted.twists,
            "phases" => &mut wanted.phases,
            "points" => &mut wanted.points,
            "angle" => &mut wanted.angle,
            "torque" => &mut wanted.torque,
            "inertias" => &mut wanted.inertias,
            "lengths" => &mut wanted.lengths,
            "positions" => &mut wanted.positions,
            "deviations" => &mut wanted.deviations,
            other => {
                return Err(argument_error("by", format!("is {other:?}, which is unknown")));
            }
        };
        *place = true;
    }
    Ok(wanted)
}
