//! Torsional systems of a batch of drivelines.

use std::sync::atomic::AtomicBool;

use cardan::dynamics::{
    self, AtDrive, Coupling, CriticalSpeeds, Drive, Failure, Instant, Mode, Runs, ShaftEnds,
    TorqueHarmonic,
};
use cardan::{Execution, TorsionalSystem, check_length, unravel};
use numpy::{IntoPyArray, PyArray1, PyReadonlyArray1};
use pyo3::exceptions::PyIndexError;
use pyo3::prelude::*;

use crate::convert::{Input, OrRaise, argument_error, slice};
use crate::lines::Lines;
use crate::watch::{check_memory, reserve, run_interruptible, threads};

/// The fewest runs that take long enough to be interruptible.
const MIN_INTERRUPTIBLE: usize = 64;

/// Results, flat, with one record per run, and one number per run: 0 if there is an orbit, else
/// the number of its failure.
type Records<'py> = (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<u8>>);

/// The slope of a free drive; end, order, cosine and sine of harmonic torques; couplings.
type Engine = (Option<f64>, Vec<(usize, f64, f64, f64)>, Vec<CouplingFields>);

/// The fields of [`Coupling`] in order.
type CouplingFields = (usize, Option<f64>, Vec<[f64; 2]>, f64, bool, f64, Vec<[f64; 2]>);

/// The fields of [`Mode`] in order.
type ModeFields = (f64, Vec<f64>, Vec<f64>, usize);

/// The fields of the critical speeds of natural frequencies in rad/s and of orders, each excited or
/// not, beside a range of drive speeds in rad/s.
#[pyfunction]
pub(crate) fn critical_speeds(
    frequencies: Vec<f64>,
    orders: Vec<(f64, bool)>,
    range: [f64; 2],
) -> (Vec<f64>, Vec<f64>, Option<usize>) {
    let CriticalSpeeds { speeds, away, nearest } =
        CriticalSpeeds::new(&frequencies, &orders, range);
    (speeds, away, nearest)
}

/// Torsional systems, all with the same shafts compliant.
#[pyclass(frozen, name = "Torsion", module = "cardan._core")]
pub(crate) struct NativeTorsion(Vec<TorsionalSystem>);

#[pymethods]
impl NativeTorsion {
    /// Systems of the given shape, each of the driveline with the given number, from flat arrays.
    #[new]
    fn new(
        py: Python<'_>,
        lines: &Lines,
        shape: Vec<usize>,
        line: PyReadonlyArray1<'_, i64>,
        shafts: [Input<'_>; 3],
        load: [Input<'_>; 2],
        engine: Engine,
    ) -> PyResult<Self> {
        let (drive, harmonics, couplings) = engine;
        let drive = drive.map_or(Drive::Held, |slope| Drive::Free { slope });
        let harmonic = |&(end, order, cos, sin): &_| TorqueHarmonic { end, order, cos, sin };
        let harmonics: Vec<_> = harmonics.iter().map(harmonic).collect();
        let couplings: Vec<_> = couplings.into_iter().map(coupling).collect();
        let n = lines.batch().joints();
        let line = slice("line", &line)?;
        let [inertias, stiffnesses, dampings] = &shafts;
        let inertias = slice("inertias", inertias)?;
        let stiffnesses = slice("stiffnesses", stiffnesses)?;
        let dampings = slice("dampings", dampings)?;
        let (torques, viscous) =
            (slice("load_torque", &load[0])?, slice("load_damping", &load[1])?);
        for (name, array, each) in [
            ("inertias", inertias, 2 * (n + 1)),
            ("stiffnesses", stiffnesses, n + 1),
            ("dampings", dampings, n + 1),
            ("load_torque", torques, 1),
            ("load_damping", viscous, 1),
        ] {
            check_length(name, array.len(), line.len(), each).or_raise()?;
        }
        let mut systems = vec![];
        reserve(&mut systems, line.len())?;
        lines.batch().check_ideal("torsional systems are").or_raise()?;
        lines.with(py, |lines| {
            let part = |array: &[f64], each: usize, at: usize| {
                array.get(at * each..(at + 1) * each).map(<[f64]>::to_vec)
            };
            for (i, &line) in line.iter().enumerate() {
                let number = usize::try_from(line).ok();
                let found = number.and_then(|at| {
                    let between = n - 1;
                    let bends = part(lines.bends, n, at)?;
                    Some((
                        bends,
                        part(lines.twists, between, at)?,
                        part(lines.phases, between, at)?,
                    ))
                });
                let Some((bends, twists, phases)) = found else {
                    return Err(PyIndexError::new_err(format!("there is no driveline {line}")));
                };
                let of_shafts = ShaftEnds {
                    inertias: &inertias[i * 2 * (n + 1)..][..2 * (n + 1)],
                    stiffnesses: &stiffnesses[i * (n + 1)..][..=n],
                    dampings: &dampings[i * (n + 1)..][..=n],
                };
                let load = [torques[i], viscous[i]];
                let system = TorsionalSystem::new(&bends, &twists, &phases, of_shafts, load)
                    .and_then(|system| system.with_drive(drive))
                    .and_then(|system| system.with_harmonics(&harmonics))
                    .and_then(|system| system.with_couplings(&couplings))
                    .map_err(|error| match error.argument {
                        // Those of the whole batch.
                        "drive_slope" | "harmonics" | "couplings" => error,
                        _ => error.within(&unravel(i, &shape)),
                    })
                    .or_raise()?;
                systems.push(system);
            }
            Ok(())
        })?;
        Ok(Self(systems))
    }

    /// The natural frequencies of every system in rad/s, flat.
    fn natural_frequencies<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        let found: Vec<f64> =
            py.detach(|| self.0.iter().flat_map(TorsionalSystem::natural_frequencies).collect());
        found.into_pyarray(py)
    }

    /// The modes of the only system.
    fn modes(&self) -> PyResult<Vec<ModeFields>> {
        let fields = |Mode { frequency, shape, shares, shaft }| (frequency, shape, shares, shaft);
        Ok(self.only()?.modes().into_iter().map(fields).collect())
    }

    /// The turns of the drive in a period.
    fn period_turns(&self) -> f64 {
        self.0.first().map_or(0.5, TorsionalSystem::period_turns)
    }

    /// Mean, least and largest torques, mean torque and least and largest speed of the drive, orders
    /// of the torques and of the angles of shaft ends.
    fn steady<'py>(
        &self,
        py: Python<'py>,
        system: PyReadonlyArray1<'py, i64>,
        speed: Input<'py>,
        orders: Vec<f64>,
        tolerance: f64,
        workers: Option<usize>,
    ) -> PyResult<Records<'py>> {
        let record =
            self.size(|m, ends| 3 * m + dynamics::OF_DRIVE + 2 * orders.len() * (m + ends));
        let input = (system, speed, tolerance);
        self.records(py, &input, record, workers, |runs, out, failures, execution| {
            dynamics::steady_of_batch(runs, &orders, out, failures, execution);
        })
    }

    /// Floquet multipliers, the slope of the mean drive torque and the multiplier of the speed.
    fn multipliers<'py>(
        &self,
        py: Python<'py>,
        system: PyReadonlyArray1<'py, i64>,
        speed: Input<'py>,
        tolerance: f64,
        workers: Option<usize>,
    ) -> PyResult<Records<'py>> {
        let record = self.0.first().map_or(0, |system| 2 * system.multipliers() + 2);
        let input = (system, speed, tolerance);
        self.records(py, &input, record, workers, dynamics::multipliers_of_batch)
    }

    /// Angles, speeds and accelerations of all shaft ends and torques over one period.
    fn orbits<'py>(
        &self,
        py: Python<'py>,
        system: PyReadonlyArray1<'py, i64>,
        speed: Input<'py>,
        samples: usize,
        tolerance: f64,
        workers: Option<usize>,
    ) -> PyResult<Records<'py>> {
        let record = self.size(|m, ends| samples.saturating_mul(3 * ends + m + 1));
        let input = (system, speed, tolerance);
        self.records(py, &input, record, workers, |runs, out, failures, execution| {
            dynamics::orbits_of_batch(runs, samples, out, failures, execution);
        })
    }

    /// The number of orbits, and torques and multipliers of up to `most` of them.
    fn coexisting<'py>(
        &self,
        py: Python<'py>,
        system: PyReadonlyArray1<'py, i64>,
        speed: Input<'py>,
        most: usize,
        tolerance: f64,
        workers: Option<usize>,
    ) -> PyResult<Records<'py>> {
        let multipliers = self.0.first().map_or(0, TorsionalSystem::multipliers);
        let each = |m: usize| dynamics::coexisting_record(m, multipliers).saturating_mul(most);
        let record = self.size(|m, _| each(m).saturating_add(1));
        let input = (system, speed, tolerance);
        self.records(py, &input, record, workers, |runs, out, failures, execution| {
            dynamics::coexisting_of_batch(runs, most, out, failures, execution);
        })
    }

    /// The time derivatives of angles and speeds of the output ends of the compliant shafts of the
    /// only system, the torque that keeps the drive's speed, and the inertia at the drive. The
    /// state holds these angles relative to the drive and the offsets, then the speeds.
    fn slopes<'py>(
        &self,
        py: Python<'py>,
        drive_and_load: [f64; 3],
        state: Input<'py>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let [drive_angle, drive_speed, load_torque] = drive_and_load;
        let system = self.only()?;
        let m = system.compliant();
        let state = slice("state", &state)?;
        check_length("state", state.len(), 1, 2 * m).or_raise()?;
        let (errors, speeds) = state.split_at(m);
        let mut out: Vec<f64> = speeds.iter().map(|speed| speed - drive_speed).collect();
        out.resize(2 * m + 2, 0.0);
        let instant = Instant { drive_angle, drive_speed, load_torque, errors, speeds };
        let AtDrive { torque, inertia } = system.accelerations(instant, &mut out[m..2 * m]);
        out[2 * m..].copy_from_slice(&[torque, inertia]);
        Ok(out.into_pyarray(py))
    }

    /// The state of shafts of the only system that move as if they were rigid, at drive angle 0.
    fn rigid<'py>(
        &self,
        py: Python<'py>,
        drive_and_load: [f64; 2],
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let [drive_speed, load_torque] = drive_and_load;
        let system = self.only()?;
        let mut state = vec![0.0; 2 * system.compliant()];
        let (errors, speeds) = state.split_at_mut(system.compliant());
        system.rigid_state(drive_speed, load_torque, errors, speeds);
        Ok(state.into_pyarray(py))
    }

    /// Angles and speeds of all shaft ends and torques of the compliant shafts of the only system,
    /// flat, one record per instant, from rows of drive angle, drive speed and state.
    fn motion<'py>(
        &self,
        py: Python<'py>,
        rows: Input<'py>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let system = self.only()?;
        let m = system.compliant();
        let rows = slice("rows", &rows)?;
        let count = rows.len() / (2 * m + 2);
        check_length("rows", rows.len(), count, 2 * m + 2).or_raise()?;
        let record = 4 * system.shafts() + m;
        check_memory(count.saturating_mul(record).saturating_mul(8))?;
        let mut out = vec![0.0; count * record];
        py.detach(|| {
            for (row, out) in rows.chunks_exact(2 * m + 2).zip(out.chunks_exact_mut(record)) {
                let (errors, speeds) = row[2..].split_at(m);
                let (drive_angle, drive_speed) = (row[0], row[1]);
                let instant =
                    Instant { drive_angle, drive_speed, load_torque: 0.0, errors, speeds };
                system.motion(instant, out);
            }
        });
        Ok(out.into_pyarray(py))
    }
}

/// A coupling from its fields.
fn coupling(fields: CouplingFields) -> Coupling {
    let (shaft, stiffness, twist_torque, play, contact_damping, loss_factor, stiffness_by_mean) =
        fields;
    Coupling {
        shaft,
        stiffness,
        twist_torque,
        play,
        contact_damping,
        loss_factor,
        stiffness_by_mean,
    }
}

impl NativeTorsion {
    /// The system, if there is only one.
    fn only(&self) -> PyResult<&TorsionalSystem> {
        match &self.0[..] {
            [system] => Ok(system),
            _ => Err(PyIndexError::new_err(format!("there are {} systems", self.0.len()))),
        }
    }

    /// A size of all systems from the numbers of compliant shafts and of shaft ends.
    fn size(&self, of: impl Fn(usize, usize) -> usize) -> usize {
        self.0.first().map_or(0, |system| of(system.compliant(), 2 * system.shafts()))
    }

    fn records<'py>(
        &self,
        py: Python<'py>,
        (system, speed, tolerance): &(PyReadonlyArray1<'py, i64>, Input<'py>, f64),
        record: usize,
        workers: Option<usize>,
        run: impl Fn(&Runs<'_>, &mut [f64], &mut [Option<Failure>], Execution<'_>) + Sync,
    ) -> PyResult<Records<'py>> {
        let (system, speed) = (slice("system", system)?, slice("speed", speed)?);
        if system.len() != speed.len() {
            let problem = format!("has {} values for {} systems", speed.len(), system.len());
            return Err(argument_error("speed", problem));
        }
        let count = speed.len();
        check_memory(count.saturating_mul(record.saturating_add(4)).saturating_mul(8))?;
        let mut numbers = vec![];
        for &number in system {
            let known = usize::try_from(number).ok().filter(|&number| number < self.0.len());
            let missing = || PyIndexError::new_err(format!("there is no system {number}"));
            numbers.push(known.ok_or_else(missing)?);
        }
        let mut results = vec![f64::NAN; count * record];
        let mut failures = vec![None; count];
        let tolerance = *tolerance;
        let runs = Runs { systems: &self.0, system: &numbers, speed, tolerance };
        let mut work = |stop: Option<&AtomicBool>, workers: Option<usize>| {
            if record > 0 {
                let execution = Execution { workers, stop, ..Execution::default() };
                run(&runs, &mut results, &mut failures, execution);
            }
        };
        if count < MIN_INTERRUPTIBLE {
            py.detach(|| work(None, Some(1)));
        } else {
            let workers = threads(workers);
            run_interruptible(py, workers, &mut |stop| {
                work(Some(stop), workers);
                Ok(())
            })?;
        }
        let number = |failure: &Option<Failure>| match failure {
            None => 0_u8,
            Some(Failure::Speed) => 1,
            Some(Failure::NotFound) => 2,
            Some(Failure::NotResolved) => 3,
        };
        let failures: Vec<u8> = failures.iter().map(number).collect();
        Ok((results.into_pyarray(py), failures.into_pyarray(py)))
    }
}
