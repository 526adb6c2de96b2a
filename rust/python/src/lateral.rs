//! Lateral systems of a batch of drivelines.

use cardan::dynamics::lateral::{
    Attached, BendingShaft, ElasticBearing, LateralRuns, LateralShaft, LateralSystem, PointMass,
    RigidShaft, TorqueStiffness, Unbalance, Yokes, largest_lengths,
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
        let (kinds, numbers) = &shafts;
        let n = kinds.len();
        let [directions, lengths, normals, phases] = &geometry;
        let directions = part("directions", directions, count, 3 * n)?;
        let lengths = part("lengths", lengths, count, n)?;
        let normals = part("normals", normals, count, 3)?;
        let phases = part("phases", phases, count, n.saturating_sub(2))?;
        let numbers = part("shafts", numbers, count, 5 * n)?;
        let [bearings, masses, unbalances] = &attached;
        let of_bearings = part("bearings", &bearings.1, count, 10 * bearings.0.len())?;
        let of_masses = part("masses", &masses.1, count, 4 * masses.0.len())?;
        let of_unbalances = part("unbalance", &unbalances.1, count, 5 * unbalances.0.len())?;
        let make = |i: usize| {
            let shafts: Vec<LateralShaft> =
                kinds.iter().zip(numbers(i).chunks_exact(5)).map(shaft_of).collect();
            let attached = Attached {
                bearings: items(&bearings.0, of_bearings(i), bearing_of),
                masses: items(&masses.0, of_masses(i), mass_of),
                unbalances: items(&unbalances.0, of_unbalances(i), unbalance_of),
            };
            let directions = vectors(directions(i));
            let sliding = sliding.as_deref();
            LateralSystem::new(&directions, lengths(i), &shafts, attached, sliding).map_err(
                |error| {
                    let place = if shape.is_empty() { vec![] } else { unravel(i, &shape) };
                    error.within(&place)
                },
            )
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
    /// What a drive torque of 1 N m does in each system.
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

fn items<T>(shafts: &[usize], numbers: &[f64], make: impl Fn(usize, &[f64]) -> T) -> Vec<T> {
    let each = numbers.len() / shafts.len().max(1);
    shafts.iter().enumerate().map(|(i, &shaft)| make(shaft, &numbers[i * each..][..each])).collect()
}

fn shaft_of((kind, numbers): (&usize, &[f64])) -> LateralShaft {
    let &[a, b, c, d, e] = numbers else { return LateralShaft::Held };
    match kind {
        0 => LateralShaft::Held,
        1 => LateralShaft::Rigid(RigidShaft { mass: a, centre: b, across: c, along: d }),
        _ => LateralShaft::Bending(BendingShaft {
            stiffness: a,
            mass: b,
            shear_stiffness: c,
            rotary_inertia: d,
            loss_factor: e,
        }),
    }
}

fn bearing_of(shaft: usize, numbers: &[f64]) -> ElasticBearing {
    let axis = Vector::from_column_slice(&numbers[3..6]);
    ElasticBearing {
        shaft,
        position: numbers[0],
        stiffness: [numbers[1], numbers[2]],
        // None is given as one that is no number.
        axis: (!axis[0].is_nan()).then_some(axis),
        loss_factor: [numbers[6], numbers[7]],
        damping: [numbers[8], numbers[9]],
    }
}

fn mass_of(shaft: usize, numbers: &[f64]) -> PointMass {
    let [position, mass, across, along] = [numbers[0], numbers[1], numbers[2], numbers[3]];
    PointMass { shaft, position, mass, across, along }
}

fn unbalance_of(shaft: usize, numbers: &[f64]) -> Unbalance {
    let direction = Vector::from_column_slice(&numbers[2..5]);
    Unbalance { shaft, position: numbers[0], mass_arm: numbers[1], direction }
}
