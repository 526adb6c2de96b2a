//! Lateral systems of a batch of drivelines.

use cardan::dynamics::lateral::{
    Described, LateralRuns, LateralSystem, Numbers, TorqueStiffness, Yokes, largest_lengths,
};
use cardan::{Execution, Vector, check_length, unravel};
use numpy::{Complex64, IntoPyArray, PyArray1, PyReadonlyArray1};
use pyo3::exceptions::PyIndexError;
use pyo3::prelude::*;

use crate::convert::{Input, OrRaise, argument_error, slice, vectors};
use crate::watch::{check_memory, run_interruptible, threads};

/// The fewest runs that take long enough to be interruptible.
const MIN_INTERRUPTIBLE: usize = 64;

/// Shafts of what is attached to them, and numbers of each in every system.
type Items<'py> = (Vec<usize>, Input<'py>);

/// Vectors and powers, flat.
type Response<'py> = (Bound<'py, PyArray1<Complex64>>, Bound<'py, PyArray1<f64>>);

/// The largest length over the turn of vectors of these orders, `(vectors, orders, 3)`.
#[pyfunction]
pub(crate) fn largest_over_turn<'py>(
    py: Python<'py>,
    amplitudes: PyReadonlyArray1<'py, Complex64>,
    orders: Vec<f64>,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let amplitudes = slice("amplitudes", &amplitudes)?;
    let found = py.detach(|| largest_lengths(amplitudes, &orders)).or_raise()?;
    Ok(found.into_pyarray(py))
}

/// Lateral systems, all of the same shafts, with the same number of bearings.
#[pyclass(frozen, name = "Lateral", module = "cardan._core")]
pub(crate) struct NativeLateral {
    systems: Vec<LateralSystem>,
    /// The first normal of each driveline, and its phases.
    yokes: Vec<(Vector, Vec<f64>)>,
}

#[pymethods]
impl NativeLateral {
    /// Systems of the given shape from flat arrays: directions, lengths, first normals and phases
    /// of drivelines; whether each shaft is held, rigid or bends, with its numbers; bearings, masses
    /// and unbalances; the shafts that slide.
    #[new]
    fn new(
        shape: Vec<usize>,
        geometry: [Input<'_>; 4],
        shafts: Items<'_>,
        attached: [Items<'_>; 3],
        sliding: Option<Vec<usize>>,
    ) -> PyResult<Self> {
        let count: usize = shape.iter().product();
        let n = shafts.0.len();
        let [directions, lengths, normals, phases] = &geometry;
        let directions = part("directions", directions, count, 3 * n)?;
        let lengths = part("lengths", lengths, count, n)?;
        let normals = part("normals", normals, count, 3)?;
        let phases = part("phases", phases, count, n.saturating_sub(2))?;
        let mut parts = vec![];
        let names = ["shafts", "bearings", "masses", "unbalance"];
        let each = Numbers::COUNTS.into_iter().zip(names);
        for ((whole, fields), (size, name)) in std::iter::once(&shafts).chain(&attached).zip(each) {
            parts.push((whole, part(name, fields, count, size * whole.len())?));
        }
        let make = |i: usize| {
            let numbers = |part: usize| {
                let (whole, fields) = &parts[part];
                Numbers { whole, fields: fields(i) }
            };
            let [shafts, bearings, masses, unbalances] = [0, 1, 2, 3].map(numbers);
            let described = Described { shafts, bearings, masses, unbalances };
            let system = described.system(&vectors(directions(i)), lengths(i), sliding.as_deref());
            system.map_err(|error| {
                let place = if shape.is_empty() { vec![] } else { unravel(i, &shape) };
                error.within(&place)
            })
        };
        let systems: cardan::Result<Vec<_>> = (0..count).map(make).collect();
        let yokes = |i| (Vector::from_column_slice(normals(i)), phases(i).to_vec());
        Ok(Self { systems: systems.or_raise()?, yokes: (0..count).map(yokes).collect() })
    }

    /// For each joint the shaft that slides.
    fn sliding(&self) -> Vec<usize> {
        self.systems.first().map_or(vec![], |system| system.sliding().to_vec())
    }

    /// Up to `count` natural frequencies of every system in rad/s and displacements of probes, flat;
    /// infinite where there are fewer.
    fn modes<'py>(
        &self,
        py: Python<'py>,
        count: usize,
        probes: Vec<(usize, f64)>,
    ) -> PyResult<[Bound<'py, PyArray1<f64>>; 2]> {
        let size = self.systems.len().saturating_mul(count);
        check_memory(size.saturating_mul(8 * (1 + 3 * probes.len())))?;
        let (mut frequencies, mut displacements) = (vec![], vec![]);
        let mut work = || -> cardan::Result<()> {
            for system in &self.systems {
                let modes = system.modes(count, &probes)?;
                let missing = count - modes.len();
                for mode in modes {
                    frequencies.push(mode.frequency);
                    displacements.extend(mode.displacements.into_iter().flatten());
                }
                frequencies.extend(std::iter::repeat_n(f64::INFINITY, missing));
                let absent = missing * probes.len() * 3;
                displacements.extend(std::iter::repeat_n(f64::NAN, absent));
            }
            Ok(())
        };
        py.detach(&mut work).or_raise()?;
        Ok([frequencies.into_pyarray(py), displacements.into_pyarray(py)])
    }

    /// Vectors `(runs, orders, vectors, 3)` and powers `(runs, orders, powers)`, flat.
    fn responses<'py>(
        &self,
        py: Python<'py>,
        runs: (PyReadonlyArray1<'py, i64>, Input<'py>),
        orders: Vec<f64>,
        moments: PyReadonlyArray1<'py, Complex64>,
        probes: Vec<(usize, f64)>,
        workers: Option<usize>,
    ) -> PyResult<Response<'py>> {
        let (speed, moments) = (slice("speed", &runs.1)?, slice("moments", &moments)?);
        let system = self.numbers(slice("system", &runs.0)?)?;
        let joints = self.systems.first().map_or(0, LateralSystem::joints);
        let runs = LateralRuns {
            systems: &self.systems,
            system: &system,
            speed,
            orders: &orders,
            moments,
            probes: &probes,
        };
        check_length("moments", moments.len(), speed.len() * orders.len(), 3 * joints)
            .or_raise()?;
        if system.len() != speed.len() {
            let problem = format!("has {} values for {} systems", speed.len(), system.len());
            return Err(argument_error("speed", problem));
        }
        let each = speed.len().saturating_mul(orders.len());
        check_memory(each.saturating_mul(48 * runs.vectors() + 8 * runs.powers()))?;
        let mut vectors = vec![Complex64::default(); each * 3 * runs.vectors()];
        let mut powers = vec![0.0; each * runs.powers()];
        if speed.len() < MIN_INTERRUPTIBLE {
            let execution = Execution { workers: Some(1), ..Execution::default() };
            py.detach(|| runs.responses(&mut vectors, &mut powers, execution)).or_raise()?;
        } else {
            let workers = threads(workers);
            run_interruptible(py, workers, &mut |stop| {
                let stop = Some(stop);
                let execution = Execution { workers, stop, ..Execution::default() };
                runs.responses(&mut vectors, &mut powers, execution)
            })?;
        }
        Ok((vectors.into_pyarray(py), powers.into_pyarray(py)))
    }

    /// Turning and mean part of the torque's own stiffness of every system at 1 N m, flat, by rows.
    fn torque_stiffness<'py>(&self, py: Python<'py>) -> PyResult<Response<'py>> {
        let found = py.detach(|| self.stiffnesses()).or_raise()?;
        let rows = |own: &TorqueStiffness| own.mean.transpose().data.as_vec().clone();
        let mean: Vec<f64> = found.iter().flat_map(rows).collect();
        let rows = |own: &TorqueStiffness| own.turning.transpose().data.as_vec().clone();
        let turning: Vec<Complex64> = found.iter().flat_map(rows).collect();
        Ok((turning.into_pyarray(py), mean.into_pyarray(py)))
    }

    /// The largest drive torque in N m in each run at which a vibration does not maintain itself.
    fn largest_stable_torque<'py>(
        &self,
        py: Python<'py>,
        system: PyReadonlyArray1<'py, i64>,
        speed: Input<'py>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let (system, speed) = (self.numbers(slice("system", &system)?)?, slice("speed", &speed)?);
        let work = || -> cardan::Result<Vec<f64>> {
            let stiffnesses = self.stiffnesses()?;
            let one = |(&i, &speed): (&usize, &f64)| {
                self.systems[i].largest_stable_torque(&stiffnesses[i], speed)
            };
            Ok(system.iter().zip(speed).map(one).collect())
        };
        Ok(py.detach(work).or_raise()?.into_pyarray(py))
    }
}

impl NativeLateral {
    /// Effect of a drive torque of 1 N m in each system.
    fn stiffnesses(&self) -> cardan::Result<Vec<TorqueStiffness>> {
        let one = |(system, (normal, phases)): (&LateralSystem, &(Vector, Vec<f64>))| {
            system.torque_stiffness(Yokes { normal: *normal, phases })
        };
        self.systems.iter().zip(&self.yokes).map(one).collect()
    }

    /// The numbers of systems that exist.
    fn numbers(&self, given: &[i64]) -> PyResult<Vec<usize>> {
        let known = |number: &i64| {
            let found = usize::try_from(*number).ok().filter(|&number| number < self.systems.len());
            found.ok_or_else(|| PyIndexError::new_err(format!("there is no system {number}")))
        };
        given.iter().map(known).collect()
    }
}

/// The numbers of each system, of so many each.
fn part<'a>(
    name: &'static str,
    array: &'a Input<'_>,
    count: usize,
    each: usize,
) -> PyResult<impl Fn(usize) -> &'a [f64]> {
    let flat = slice(name, array)?;
    check_length(name, flat.len(), count, each).or_raise()?;
    Ok(move |i: usize| &flat[i * each..][..each])
}
