//! Judgement by limits, and the machines that are judged.

use cardan::design::tube::Round;
use cardan::judge::{
    CaseLoads, Cases, Change, Figure, Kind, Limit, LimitOf, Machine, Parts, Scope, Search, Side,
    SlidingShaft, Variable,
};
use cardan::{End, Execution, check_length};
use numpy::{IntoPyArray, PyArray1};
use pyo3::prelude::*;
use pyo3::pybacked::PyBackedStr;

use crate::convert::{Input, OrRaise, slice};
use crate::lines::Lines;
use crate::watch::threads;

/// The ranks of figures beside their limits and maxima: 0 not judged, 1 within, 2 tolerable, 3
/// beyond. The size of what is judged counts for limits that are nearer to 0.
#[pyfunction]
pub(crate) fn ranks<'py>(
    py: Python<'py>,
    values: Input<'py>,
    limits: Input<'py>,
    maxima: Input<'py>,
    most: bool,
    size: f64,
) -> PyResult<Bound<'py, PyArray1<i64>>> {
    let [values, limits, maxima] =
        [slice("values", &values)?, slice("limits", &limits)?, slice("maxima", &maxima)?];
    check_length("limits", limits.len(), values.len(), 1).or_raise()?;
    check_length("maxima", maxima.len(), values.len(), 1).or_raise()?;
    let side = if most { Side::Most } else { Side::Least };
    let rank = |((&value, &limit), &maximum): ((&f64, &f64), &f64)| {
        Limit { limit, maximum, side, size }.rank(value) as i64
    };
    let found: Vec<i64> = values.iter().zip(limits).zip(maxima).map(rank).collect();
    Ok(found.into_pyarray(py))
}

/// The figures that a machine is judged by: name, unit, of what each is, whether its limit is the
/// most, and whether it has values in states, in states and steps, or one.
#[pyfunction]
pub(crate) fn kinds() -> Vec<(&'static str, &'static str, Option<&'static str>, bool, &'static str)>
{
    let of = |kind: Kind| {
        let row = kind.row();
        let scope = match row.scope {
            Scope::States => "states",
            Scope::Cases => "cases",
            Scope::Once => "once",
        };
        let per = row.per.map(cardan::Per::name);
        (row.name, row.unit, per, row.side == Side::Most, scope)
    };
    Kind::ALL.into_iter().map(of).collect()
}

/// The end at which the torque is given, torque, acceleration, and pairs of a shaft and its
/// inertia, in each case.
type LoadArrays<'py> = (PyBackedStr, Vec<f64>, Vec<f64>, Vec<(usize, Vec<f64>)>);

/// Drivelines, the speed in each, and the load.
type CaseArrays<'py> = (Bound<'py, Lines>, Vec<f64>, Option<LoadArrays<'py>>);

/// A shaft; engaged length and length left to push in, both in the drawing, friction and radius.
type SplineNumbers = (usize, [f64; 4]);

/// Kind, item, values, ranks, limit, maximum and the place of the worst value.
type FigureFields<'py> = (
    &'static str,
    Option<usize>,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<i64>>,
    [f64; 2],
    Option<usize>,
);

/// Variable, item, axis, what it is and what it becomes, share, worst rank and worst figure.
type ChangeFields<'py> =
    (&'static str, usize, Option<usize>, [f64; 2], f64, i64, Option<FigureFields<'py>>);

/// A machine with its limits.
#[pyclass(frozen, name = "Machine", module = "cardan._core")]
pub(crate) struct NativeMachine(Machine);

#[pymethods]
impl NativeMachine {
    /// A machine in its states and in the steps of its duty cycle with their shares of the time.
    /// Data of its joints are empty or one for each: ratings, the four numbers of friction, play.
    /// Tubes are pairs of a shaft and six dimensions, `drawn` the driveline of the drawing,
    /// limits a kind, an item, a limit and a maximum.
    #[new]
    #[allow(clippy::too_many_arguments, reason = "flat arguments of one call")]
    fn new<'py>(
        states: CaseArrays<'py>,
        steps: Option<CaseArrays<'py>>,
        shares: Vec<f64>,
        ratings: Vec<f64>,
        friction: Vec<[f64; 4]>,
        tubes: Vec<(usize, [f64; 6])>,
        spline: Option<SplineNumbers>,
        centres: Vec<f64>,
        drawn: CaseArrays<'py>,
        play: Vec<f64>,
        limits: Vec<(PyBackedStr, Option<usize>, f64, f64)>,
    ) -> PyResult<Self> {
        let tube = |(shaft, dimensions)| {
            let [diameter, wall, length, shear_modulus, elastic_modulus, density] = dimensions;
            (shaft, Round { diameter, wall, length, shear_modulus, elastic_modulus, density })
        };
        let sliding = |(shaft, [engaged, push_in, friction, radius]): SplineNumbers| SlidingShaft {
            shaft,
            engaged,
            push_in,
            friction,
            radius,
        };
        let parts = Parts {
            shares,
            ratings,
            friction,
            tubes: tubes.into_iter().map(tube).collect(),
            spline: spline.map(sliding),
            centres,
            drawn: Some(cases(drawn)?),
            play,
        };
        let limit = |(name, item, limit, maximum): (PyBackedStr, _, _, _)| {
            Ok(LimitOf { kind: Kind::named(&name)?, item, limit, maximum })
        };
        let limits: Vec<LimitOf> =
            limits.into_iter().map(limit).collect::<cardan::Result<_>>().or_raise()?;
        let lines = states.0.get().batch();
        let (joints, bearings) = (lines.joints(), lines.bearings.clone().unwrap_or_default());
        let steps = steps.map(cases).transpose()?;
        Machine::new(joints, &bearings, cases(states)?, steps, parts, &limits).or_raise().map(Self)
    }

    /// Every figure of the machine.
    fn figures<'py>(
        &self,
        py: Python<'py>,
        workers: Option<usize>,
    ) -> PyResult<Vec<FigureFields<'py>>> {
        let execution = Execution { workers: threads(workers), ..Execution::default() };
        let found = py.detach(|| self.0.figures(execution)).or_raise()?;
        Ok(found.into_iter().map(|figure| fields(py, figure)).collect())
    }

    /// The smallest single changes that bring everything within its limits, or the nearest one.
    fn suggest<'py>(
        &self,
        py: Python<'py>,
        reach: f64,
        teeth: Vec<usize>,
        ratings: Vec<f64>,
        workers: Option<usize>,
    ) -> PyResult<Vec<ChangeFields<'py>>> {
        let execution = Execution { workers: threads(workers), ..Execution::default() };
        let search = Search { reach, teeth, ratings };
        let found = py.detach(|| self.0.suggest(&search, execution)).or_raise()?;
        let change = |change: Change| {
            let (name, item, axis) = match change.variable {
                Variable::Point { point, axis } => ("point", point, Some(axis)),
                Variable::Phase(shaft) => ("phase", shaft, None),
                Variable::Bearing(bearing) => ("bearing", bearing, None),
                Variable::Engaged(shaft) => ("engaged", shaft, None),
                Variable::Rating(joint) => ("rating", joint, None),
            };
            let worst = change.worst.map(|figure| fields(py, figure));
            let ends = [change.from, change.to];
            (name, item, axis, ends, change.share, change.verdict as i64, worst)
        };
        Ok(found.into_iter().map(change).collect())
    }
}

fn cases((lines, speeds, load): CaseArrays<'_>) -> PyResult<Cases> {
    let load = match load {
        Some((end, torque, acceleration, inertias)) => {
            let end = End::named(&end).or_raise()?;
            Some(CaseLoads { end, torque, acceleration, inertias })
        }
        None => None,
    };
    let own = lines.get();
    own.with(lines.py(), |arrays| Cases::new(own.batch(), &arrays, &speeds, load).or_raise())
}

fn fields(py: Python<'_>, figure: Figure) -> FigureFields<'_> {
    let Figure { kind, item, values, limit, ranks, worst } = figure;
    let ranks: Vec<i64> = ranks.into_iter().map(|rank| rank as i64).collect();
    (
        kind.row().name,
        item,
        values.into_pyarray(py),
        ranks.into_pyarray(py),
        [limit.limit, limit.maximum],
        worst,
    )
}
