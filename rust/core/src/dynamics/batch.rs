//! Many systems and speeds: every sample is independent of all others, so results do not depend on
//! the threads.

use std::f64::consts::PI;

use nalgebra::Complex;

use crate::dynamics::motion_equation::MotionEquation;
use crate::dynamics::orbit::{Failure, Orbit};
use crate::dynamics::periodic::{FourierSeries, roots_of_unity};
use crate::dynamics::search::OrbitGoal;
use crate::dynamics::system::{PieceState, TorsionalSystem};
use crate::mechanics::phasing::is_set;
use crate::number::elementary::norm;
use crate::run::execution::Execution;
use crate::run::queue::work_off;

/// The fewest samples for which threads are worth waking.
const MIN_PARALLEL_SAMPLES: usize = 4;

/// Which system runs at which speed.
#[derive(Clone, Copy, Debug)]
pub struct Runs<'a> {
    /// The systems, all with the same number of shafts and of compliant shafts.
    pub systems: &'a [TorsionalSystem],
    /// The system of each run.
    pub system: &'a [usize],
    /// The speed of the drive in each run, in rad/s.
    pub speed: &'a [f64],
    /// Permitted error relative to the largest value.
    pub tolerance: f64,
}

impl Runs<'_> {
    /// Fills one record of `results` per run. Runs without an orbit get NaN and their failure.
    pub(super) fn each(
        &self,
        results: &mut [f64],
        record: usize,
        failures: &mut [Option<Failure>],
        execution: Execution<'_>,
        work: impl Fn(&TorsionalSystem, f64, &mut [f64]) -> Result<(), Failure> + Sync,
    ) {
        let Execution { workers, stop, .. } = execution;
        let threads = if workers == Some(1) || self.speed.len() < MIN_PARALLEL_SAMPLES {
            1
        } else {
            let pool = rayon::current_num_threads();
            workers.map_or(pool, |workers| pool.min(workers))
        };
        let runs = self.system.iter().zip(self.speed);
        let items = results.chunks_mut(record).zip(failures).zip(runs);
        work_off(
            items,
            threads,
            || (),
            |(), ((out, failure), (&system, &speed))| {
                if is_set(stop) {
                    return;
                }
                *failure = work(&self.systems[system], speed, out).err();
                if failure.is_some() {
                    out.fill(f64::NAN);
                }
            },
        );
    }
}

/// The steady state of each run. A record holds, for `m` compliant shafts and `n + 1` shafts: mean
/// (`m`), least (`m`) and largest torque (`m`) of the compliant shafts in N m, the complex orders
/// of these torques (`m`, orders, 2) and those of the angles of all shaft ends in rad (`n + 1`, 2,
/// orders, 2).
///
/// The torque is `mean + Re Σ X_o e^{ioα}` with the drive angle `α`; the angles likewise.
pub fn steady_of_batch(
    runs: &Runs<'_>,
    orders: &[usize],
    results: &mut [f64],
    failures: &mut [Option<Failure>],
    execution: Execution<'_>,
) {
    let Some(first) = runs.systems.first() else { return };
    let (m, ends) = (first.unknowns(), 2 * first.shafts());
    let record = 3 * m + 2 * orders.len() * (m + ends);
    let order = orders.iter().copied().max().unwrap_or(0);
    let goal = OrbitGoal { tolerance: runs.tolerance, order, stability: false };
    runs.each(results, record, failures, execution, |system, speed, out| {
        let orbit = system.search(speed, goal)?;
        let mut equation = MotionEquation::new(system, speed);
        let roots = roots_of_unity(orbit.intervals);
        let (torques, rest) = out.split_at_mut(3 * m);
        let mut places = rest.chunks_exact_mut(2);
        let mut put = |series: &FourierSeries| {
            for (&order, place) in orders.iter().zip(&mut places) {
                let Complex { re, im } = series.order(order);
                place.copy_from_slice(&[re, im]);
            }
        };
        for (s, samples) in orbit.torques(&mut equation).iter().enumerate() {
            let series = FourierSeries::through(|k| samples[k], &roots);
            let [least, most] = series.extremes();
            (torques[s], torques[m + s], torques[2 * m + s]) = (series.mean, least, most);
            put(&series);
        }
        for samples in end_angles(&orbit, &equation, ends) {
            put(&FourierSeries::through(|k| samples[k], &roots));
        }
        Ok(())
    });
}

/// The angle of every shaft end relative to the drive at the start of every interval.
fn end_angles(orbit: &Orbit, equation: &MotionEquation<'_>, ends: usize) -> Vec<Vec<f64>> {
    let mut found = vec![Vec::with_capacity(orbit.intervals); ends];
    let mut pieces = vec![];
    let at_rest = vec![0.0; orbit.unknowns];
    for k in 0..orbit.intervals {
        let (y, v) = orbit.state(k);
        equation.pieces(orbit.width() * k as f64, [y, v, &at_rest], &mut pieces);
        equation.system.shaft_ends(&pieces, |end, [error, ..]| found[end].push(error));
    }
    found
}

/// The Floquet multipliers of half a turn of the drive about the orbit of each run. A record holds
/// the real and imaginary parts of two multipliers per compliant shaft, largest modulus first.
pub fn multipliers_of_batch(
    runs: &Runs<'_>,
    results: &mut [f64],
    failures: &mut [Option<Failure>],
    execution: Execution<'_>,
) {
    let Some(first) = runs.systems.first() else { return };
    let record = 4 * first.unknowns();
    let goal = OrbitGoal { tolerance: runs.tolerance, order: 0, stability: true };
    runs.each(results, record, failures, execution, |system, speed, out| {
        let orbit = system.search(speed, goal)?;
        for (place, x) in out.chunks_exact_mut(2).zip(multipliers(&orbit)) {
            place.copy_from_slice(&[x.re, x.im]);
        }
        Ok(())
    });
}

/// The Floquet multipliers about an orbit, largest modulus first.
pub(super) fn multipliers(orbit: &Orbit) -> Vec<Complex<f64>> {
    let mut found: Vec<Complex<f64>> =
        orbit.monodromy.complex_eigenvalues().iter().copied().collect();
    // Conjugates have equal moduli up to rounding; the sign orders them.
    let key = |x: &Complex<f64>| (norm(*x), x.re, x.im);
    found.sort_by(|x, y| {
        let ((a, b, c), (d, e, f)) = (key(x), key(y));
        let same = (a - d).abs() <= 1e-12 * a.max(d);
        let by_modulus = if same { std::cmp::Ordering::Equal } else { d.total_cmp(&a) };
        by_modulus.then(e.total_cmp(&b)).then(f.total_cmp(&c))
    });
    found
}

/// One period of each run at equally spaced drive angles over half a turn. A record holds, for
/// `n + 1` shafts, the angles of all shaft ends relative to the drive in rad (`n + 1`, 2, samples),
/// their speeds in rad/s and their accelerations in rad/s² (the same), the torques of the `m`
/// compliant shafts in N m (`m`, samples) and the torque of the drive in N m (samples).
pub fn orbits_of_batch(
    runs: &Runs<'_>,
    samples: usize,
    results: &mut [f64],
    failures: &mut [Option<Failure>],
    execution: Execution<'_>,
) {
    let Some(first) = runs.systems.first() else { return };
    let (m, ends) = (first.unknowns(), 2 * first.shafts());
    let goal = OrbitGoal { tolerance: runs.tolerance, order: 0, stability: false };
    runs.each(results, samples * (3 * ends + m + 1), failures, execution, |system, speed, out| {
        let orbit = system.search(speed, goal)?;
        let mut equation = MotionEquation::new(system, speed);
        let roots = roots_of_unity(orbit.intervals);
        let through = |of: &dyn Fn(usize) -> f64| FourierSeries::through(of, &roots);
        let positions: Vec<FourierSeries> =
            (0..m).map(|u| through(&|k| orbit.state(k).0[u])).collect();
        let slopes: Vec<FourierSeries> =
            (0..m).map(|u| through(&|k| orbit.state(k).1[u])).collect();
        let mut pieces: Vec<PieceState> = vec![];
        let mut accelerations = vec![0.0; m];
        for i in 0..samples {
            let angle = PI * i as f64 / samples as f64;
            let at = |series: &[FourierSeries]| -> Vec<f64> {
                series.iter().map(|series| series.at(angle)[0]).collect()
            };
            let (y, v) = (at(&positions), at(&slopes));
            equation.accelerations(angle, &y, &v, &mut accelerations);
            equation.pieces(angle, [&y, &v, &accelerations], &mut pieces);
            let mut put = |row: usize, value: f64| out[row * samples + i] = value;
            system.shaft_ends(&pieces, |end, [error, slope, curvature]| {
                put(end, error);
                put(ends + end, speed * slope);
                put(2 * ends + end, speed * speed * curvature);
            });
            for (s, torque) in equation.last_torques().iter().enumerate() {
                put(3 * ends + s, *torque);
            }
            put(3 * ends + m, equation.at_drive()[0]);
        }
        Ok(())
    });
}
