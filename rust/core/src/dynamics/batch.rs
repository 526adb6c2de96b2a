//! Many systems and speeds: every sample is independent of all others, so results do not depend on
//! the threads.

use std::f64::consts::PI;

use nalgebra::{Complex, DMatrix};

use crate::dynamics::lanes::LANES;
use crate::dynamics::motion_equation::MotionEquation;
use crate::dynamics::orbit::{Failure, Orbit};
use crate::dynamics::periodic::{FourierSeries, roots_of_unity};
use crate::dynamics::pool::Pool;
use crate::dynamics::search::{Found, OrbitGoal, Search};
use crate::dynamics::system::{PieceState, TorsionalSystem};
use crate::mechanics::phasing::is_set;
use crate::number::elementary::norm;
use crate::run::execution::Execution;
use crate::run::level::Level;
use crate::run::queue::{threads, work_off};

/// The runs whose searches are computed together in one thread, at least and at most.
const BLOCK: (usize, usize) = (LANES, 64);

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

/// A run whose orbit was found, and where its record goes.
pub(super) struct Done<'a, 'b> {
    pub(super) system: &'a TorsionalSystem,
    pub(super) speed: f64,
    pub(super) found: Found,
    pub(super) out: &'b mut [f64],
}

impl Runs<'_> {
    /// Fills one record of `results` per run. Runs without an orbit get NaN and their failure.
    pub(super) fn each(
        &self,
        goal: OrbitGoal,
        (results, record): (&mut [f64], usize),
        failures: &mut [Option<Failure>],
        execution: Execution<'_>,
        work: impl Fn(&mut Pool<'_>, Vec<Done<'_, '_>>) + Sync,
    ) {
        let Execution { workers, stop, level, .. } = execution;
        let level = level.unwrap_or_else(Level::new);
        let count = self.speed.len();
        let threads = threads(count > BLOCK.0, workers);
        // Several blocks for each thread, so that threads end together.
        let block = (count / (4 * threads)).clamp(BLOCK.0, BLOCK.1);
        let runs = self.system.chunks(block).zip(self.speed.chunks(block));
        let items = results.chunks_mut(record * block).zip(failures.chunks_mut(block)).zip(runs);
        work_off(
            items,
            threads,
            || Pool::new(level, stop),
            |pool, ((out, failures), (systems, speeds))| {
                if is_set(stop) {
                    return;
                }
                let runs = systems.iter().zip(speeds).map(|(&i, &speed)| (&self.systems[i], speed));
                let runs: Vec<_> = runs.collect();
                let searches =
                    runs.iter().map(|&(system, speed)| Search::at(system, speed, goal)).collect();
                let mut done = vec![];
                let found = pool.run(searches).into_iter().zip(runs);
                let places = out.chunks_mut(record).zip(failures);
                for ((found, (system, speed)), (out, failure)) in found.zip(places) {
                    match found {
                        Ok(found) => done.push(Done { system, speed, found, out }),
                        Err(reason) => {
                            *failure = Some(reason);
                            out.fill(f64::NAN);
                        }
                    }
                }
                work(pool, done);
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
    runs.each(goal, (results, record), failures, execution, |pool, mut done| {
        done.sort_by_key(|run| run.found.orbit.intervals);
        let alike =
            |x: &Done<'_, '_>, y: &Done<'_, '_>| x.found.orbit.intervals == y.found.orbit.intervals;
        for lanes in done.chunk_by_mut(alike).flat_map(|alike| alike.chunks_mut(LANES)) {
            for s in 0..m {
                put_torques(pool, lanes, s, m);
            }
            let (mut systems, mut orbits, mut outs) = (vec![], vec![], vec![]);
            for Done { system, speed, found, out } in lanes {
                let (torques, angles) = out[3 * m..].split_at_mut(2 * m * orders.len());
                let places = torques.chunks_exact_mut(2);
                let series =
                    found.torques.iter().flat_map(|of| orders.iter().map(|&o| of.order(o)));
                for (place, Complex { re, im }) in places.zip(series) {
                    place.copy_from_slice(&[re, im]);
                }
                systems.push((*system, *speed));
                orbits.push(&found.orbit);
                outs.push(angles);
            }
            pool.angle_orders(&systems, &orbits, orders, |l, end, o, Complex { re, im }| {
                outs[l][2 * (end * orders.len() + o)..][..2].copy_from_slice(&[re, im]);
            });
        }
    });
}

/// Mean, least and largest torque of a compliant shaft of runs on meshes of the same size, for
/// records of `m` compliant shafts.
pub(super) fn put_torques(pool: &mut Pool<'_>, lanes: &mut [Done<'_, '_>], shaft: usize, m: usize) {
    let series: Vec<&FourierSeries> = lanes.iter().map(|run| &run.found.torques[shaft]).collect();
    let [least, most] = pool.extremes(&series);
    for (l, run) in lanes.iter_mut().enumerate() {
        run.out[shaft] = run.found.torques[shaft].mean;
        (run.out[m + shaft], run.out[2 * m + shaft]) = (least[l], most[l]);
    }
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
    runs.each(goal, (results, record), failures, execution, |_, done| {
        for Done { found, out, .. } in done {
            for (place, x) in out.chunks_exact_mut(2).zip(multipliers(&found.orbit)) {
                place.copy_from_slice(&[x.re, x.im]);
            }
        }
    });
}

/// The Floquet multipliers about an orbit, largest modulus first.
pub(super) fn multipliers(orbit: &Orbit) -> Vec<Complex<f64>> {
    let size = 2 * orbit.unknowns;
    let mut found: Vec<Complex<f64>> =
        DMatrix::from_row_slice(size, size, &orbit.monodromy).complex_eigenvalues().data.into();
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
    let record = samples * (3 * ends + m + 1);
    runs.each(goal, (results, record), failures, execution, |_, done| {
        for run in done {
            put_samples(run, samples);
        }
    });
}

/// The record of one run.
fn put_samples(Done { system, speed, found, out }: Done<'_, '_>, samples: usize) {
    let (m, ends, orbit) = (system.unknowns(), 2 * system.shafts(), found.orbit);
    let mut equation = MotionEquation::new(system, speed);
    let roots = roots_of_unity(orbit.intervals);
    let through = |of: &dyn Fn(usize) -> f64| FourierSeries::through(of, &roots);
    let positions: Vec<FourierSeries> = (0..m).map(|u| through(&|k| orbit.state(k).0[u])).collect();
    let slopes: Vec<FourierSeries> = (0..m).map(|u| through(&|k| orbit.state(k).1[u])).collect();
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
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dynamics::system::ShaftEnds;
    use crate::run::level;

    /// Two joints, of which the second is bent more in each system.
    fn systems() -> Vec<TorsionalSystem> {
        let shafts = ShaftEnds {
            inertias: &[0.0, 0.0, 0.01, 0.02, 0.02, 0.1],
            stiffnesses: &[f64::INFINITY, 4000.0, 9000.0],
            dampings: &[0.0, 0.4, 0.8],
        };
        let bends = |i: usize| [0.3, 0.2 + 0.1 * i as f64];
        let system =
            |i| TorsionalSystem::new(&bends(i), &[0.1], &[0.4], shafts, [50.0, 0.1]).unwrap();
        (0..7).map(system).collect()
    }

    fn bits(which: &[usize], speed: &[f64], execution: Execution<'_>) -> Vec<u64> {
        let systems = systems();
        let runs = Runs { systems: &systems, system: which, speed, tolerance: 1e-9 };
        let orders = [1, 2, 4];
        let count = which.len();
        let record = 6 + 2 * 3 * (2 + 6);
        let mut steady = vec![0.0; count * record];
        let mut multipliers = vec![0.0; count * 8];
        let (mut failures, mut others) = (vec![None; count], vec![None; count]);
        steady_of_batch(&runs, &orders, &mut steady, &mut failures, execution);
        multipliers_of_batch(&runs, &mut multipliers, &mut others, execution);
        let records = steady.chunks(record).zip(multipliers.chunks(8));
        records.flat_map(|(x, y)| x.iter().chain(y)).map(|x| x.to_bits()).collect()
    }

    /// Orbits on meshes of many sizes, some of which are followed from the straight driveline, and
    /// speeds that have none.
    #[test]
    fn bits_depend_neither_on_neighbours_nor_on_threads_nor_on_levels() {
        let count = 90;
        let which: Vec<usize> = (0..count).map(|i| i * 5 % 7).collect();
        let speed: Vec<f64> = (0..count).map(|i| 12.0 * (i * 31 % 90) as f64).collect();
        let alone = Execution { workers: Some(1), ..Execution::default() };
        let expected = bits(&which, &speed, alone);
        let each = expected.len() / count;
        for (_, level) in level::available() {
            for workers in [1, 2, 3] {
                let execution = Execution { level: Some(level), workers: Some(workers), ..alone };
                assert!(bits(&which, &speed, execution) == expected, "{level:?} {workers}");
            }
            for i in 0..count {
                let execution = Execution { level: Some(level), ..alone };
                let found = bits(&which[i..=i], &speed[i..=i], execution);
                assert!(found == expected[i * each..][..each], "{level:?}: run {i}");
            }
        }
    }
}
