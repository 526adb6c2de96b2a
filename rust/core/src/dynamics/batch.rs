//! Many systems and speeds: every sample is independent of all others, so results do not depend on
//! the threads.

use std::borrow::Cow;
use std::f64::consts::PI;

use nalgebra::{Complex, DMatrix, DVector};

use crate::dynamics::lanes::{LANES, ZERO, all};
use crate::dynamics::motion_equation::MotionEquation;
use crate::dynamics::orbit::{Failure, Orbit};
use crate::dynamics::periodic::{FourierSeries, roots_of_unity};
use crate::dynamics::pool::Pool;
use crate::dynamics::search::{Found, OrbitGoal, Search};
use crate::dynamics::system::{Drive, PieceState, TorsionalSystem};
use crate::mechanics::phasing::is_set;
use crate::number::elementary::{ln, norm};
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
                let (systems, found) = settled(pool, runs, goal);
                let mut done = vec![];
                let places = out.chunks_mut(record).zip(failures).zip(speeds);
                for ((found, system), ((out, failure), &speed)) in
                    found.into_iter().zip(&systems).zip(places)
                {
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

/// The orbits of runs, of which each kind of law needs its own method.
fn orbits(
    pool: &mut Pool<'_>,
    runs: &[(&TorsionalSystem, f64)],
    goal: OrbitGoal,
) -> Vec<Result<Found, Failure>> {
    if runs.iter().any(|(system, _)| system.has_kinks()) {
        runs.iter().map(|(system, speed)| system.shoot(*speed, goal, pool)).collect()
    } else if runs.iter().any(|(system, _)| system.has_loss_factors()) {
        runs.iter().map(|(system, speed)| system.balance(*speed, goal, pool)).collect()
    } else {
        pool.run(runs.iter().map(|(system, speed)| Search::at(system, *speed, goal)).collect())
    }
}

/// The orbits of runs, and the systems with the stiffnesses that belong to the mean torques of the
/// orbits, which hardly depend on the stiffnesses.
///
/// A constant loss factor has no law in time, about which an orbit could be stable: where that is
/// the goal, the systems have viscous dampings in its place.
fn settled<'a>(
    pool: &mut Pool<'_>,
    runs: impl Iterator<Item = (&'a TorsionalSystem, f64)>,
    goal: OrbitGoal,
) -> (Vec<Cow<'a, TorsionalSystem>>, Vec<Result<Found, Failure>>) {
    const ROUNDS: usize = 12;
    let (mut systems, mut speeds) = (vec![], vec![]);
    for (system, speed) in runs {
        let load = std::iter::repeat(system.static_load(speed));
        systems.push(system.at_means(load).map_or(Cow::Borrowed(system), Cow::Owned));
        speeds.push(speed);
    }
    let in_time = |system: &TorsionalSystem, speed| {
        (goal.stability && system.has_loss_factors()).then(|| system.viscous(speed))
    };
    let mut found: Vec<Result<Found, Failure>> = vec![];
    let mut changed: Vec<usize> = (0..systems.len()).collect();
    for round in 0..=ROUNDS {
        let viscous: Vec<_> = changed.iter().map(|&i| in_time(&systems[i], speeds[i])).collect();
        let runs = changed.iter().zip(&viscous);
        let runs = runs.map(|(&i, own)| (own.as_ref().unwrap_or(&*systems[i]), speeds[i]));
        let results = orbits(pool, &runs.collect::<Vec<_>>(), goal);
        if round == 0 {
            found = results;
        } else {
            for (&i, result) in changed.iter().zip(results) {
                found[i] = result;
            }
        }
        changed.retain(|&i| {
            let Ok(of) = &found[i] else { return false };
            let other = systems[i].at_means(of.torques.iter().map(|series| series.mean));
            let differs = other.is_some();
            if let Some(other) = other {
                systems[i] = Cow::Owned(other);
            }
            differs
        });
        if changed.is_empty() {
            break;
        }
    }
    for i in changed {
        found[i] = Err(Failure::NotFound);
    }
    for ((system, found), speed) in systems.iter_mut().zip(&mut found).zip(speeds) {
        if let Some(viscous) = in_time(system, speed) {
            if let Ok(found) = found {
                found.drive.torque_slope = system.torque_slope(speed, goal, pool);
            }
            *system = Cow::Owned(viscous);
        }
    }
    (systems, found)
}

/// The numbers of a record of [`steady_of_batch`] that describe the drive.
pub const OF_DRIVE: usize = 3;

/// The steady state of each run. A record holds, for `m` compliant shafts and `n + 1` shafts: mean
/// (`m`), least (`m`) and largest torque (`m`) of the compliant shafts in N m, the mean torque of the
/// drive in N m, its least and its largest speed in rad/s, the complex orders of the torques (`m`, orders, 2) and those of the angles of all shaft ends in rad (`n + 1`, 2,
/// orders, 2).
///
/// The torque is `mean + Re Σ X_o e^{ioα}` with the drive angle `α`; the angles likewise.
pub fn steady_of_batch(
    runs: &Runs<'_>,
    orders: &[f64],
    results: &mut [f64],
    failures: &mut [Option<Failure>],
    execution: Execution<'_>,
) {
    let Some(first) = runs.systems.first() else { return };
    let (m, ends) = (first.compliant(), 2 * first.shafts());
    let record = 3 * m + OF_DRIVE + 2 * orders.len() * (m + ends);
    let order = orders.iter().fold(0.0, |most: f64, order| order.max(most));
    let goal = OrbitGoal { tolerance: runs.tolerance, order, stability: false };
    runs.each(goal, (results, record), failures, execution, |pool, mut done| {
        done.sort_by_key(|run| run.found.orbit.intervals);
        let alike =
            |x: &Done<'_, '_>, y: &Done<'_, '_>| x.found.orbit.intervals == y.found.orbit.intervals;
        for lanes in done.chunk_by_mut(alike).flat_map(|alike| alike.chunks_mut(LANES)) {
            for s in 0..m {
                put_torques(pool, lanes, s, m);
            }
            put_drive(pool, lanes, m);
            let (mut systems, mut orbits, mut outs) = (vec![], vec![], vec![]);
            for Done { system, speed, found, out } in lanes {
                let (torques, angles) = out[3 * m + OF_DRIVE..].split_at_mut(2 * m * orders.len());
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
            pool.angle_orders(&systems, &orbits, orders, &mut |l, end, o, Complex { re, im }| {
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
        let [least, most] = run.found.extremes.as_ref().map_or([least[l], most[l]], |of| of[shaft]);
        (run.out[m + shaft], run.out[2 * m + shaft]) = (least, most);
    }
}

/// Mean torque, least and largest speed of the drive of runs on meshes of the same size.
fn put_drive(pool: &mut Pool<'_>, lanes: &mut [Done<'_, '_>], m: usize) {
    let slopes: Option<Vec<&FourierSeries>> =
        lanes.iter().map(|run| run.found.drive.slope.as_ref()).collect();
    let [least, most] = slopes.map_or([ZERO; 2], |slopes| pool.extremes(&slopes));
    for (l, run) in lanes.iter_mut().enumerate() {
        let extremes = run.found.extremes.as_ref().and_then(|of| of.get(m).copied());
        let speeds = extremes.unwrap_or([least[l], most[l]]).map(|slope| run.speed * (1.0 + slope));
        run.out[3 * m..][..OF_DRIVE].copy_from_slice(&[
            run.found.drive.torque,
            speeds[0],
            speeds[1],
        ]);
    }
}

/// The stability of each run. A record holds the real and imaginary parts of the Floquet multipliers
/// of a period about the orbit, largest modulus first, without the one of a free drive that is 1
/// because its orbit may begin at any time; then, NaN if the drive is held, the derivative of the
/// mean drive torque by the mean speed in N m s/rad and the multiplier that belongs to the speed.
pub fn multipliers_of_batch(
    runs: &Runs<'_>,
    results: &mut [f64],
    failures: &mut [Option<Failure>],
    execution: Execution<'_>,
) {
    let Some(first) = runs.systems.first() else { return };
    let record = 2 * first.multipliers() + 2;
    let goal = OrbitGoal { tolerance: runs.tolerance, order: 0.0, stability: true };
    runs.each(goal, (results, record), failures, execution, |pool, mut done| {
        done.sort_by_key(|run| run.found.orbit.intervals);
        let alike =
            |x: &Done<'_, '_>, y: &Done<'_, '_>| x.found.orbit.intervals == y.found.orbit.intervals;
        for lanes in done.chunk_by_mut(alike).flat_map(|alike| alike.chunks_mut(LANES)) {
            let mut slopes = all(f64::NAN);
            if lanes[0].system.is_free() {
                let runs: Vec<_> = lanes.iter().map(|run| (run.system, run.speed)).collect();
                let orbits: Vec<_> = lanes.iter().map(|run| &run.found.orbit).collect();
                let known = |run: &Done<'_, '_>| run.found.drive.torque_slope;
                if !lanes.iter().all(|run| known(run).is_some()) {
                    slopes = pool.torque_slopes(&runs, &orbits);
                }
                for (l, run) in lanes.iter().enumerate() {
                    slopes[l] = known(run).unwrap_or(slopes[l]);
                }
            }
            for (l, Done { system, speed, found, out }) in lanes.iter_mut().enumerate() {
                let known = multipliers(system, *speed, &found.orbit);
                for (place, x) in out.chunks_exact_mut(2).zip(&known) {
                    place.copy_from_slice(&[x.re, x.im]);
                }
                out[record - 2] = slopes[l];
                out[record - 1] = system.speed_multiplier(*speed, slopes[l], &known);
            }
        }
    });
}

/// The Floquet multipliers about an orbit, largest modulus first.
pub(super) fn multipliers(
    system: &TorsionalSystem,
    speed: f64,
    orbit: &Orbit,
) -> Vec<Complex<f64>> {
    let size = 2 * orbit.unknowns;
    let mut map = DMatrix::from_row_slice(size, size, &orbit.monodromy);
    if system.is_free() {
        // A shift in time is no disturbance: the map leaves the slopes of the state as they are. In
        // axes of which that is the first the others are apart (Householder's reflection).
        let (y, v) = orbit.state(0);
        let mut slopes =
            DVector::from_iterator(size, v.iter().map(|v| 1.0 + v).chain(v.iter().copied()));
        let mut equation = MotionEquation::new(system, speed, orbit.mean_torque);
        equation.accelerations(0.0, y, v, &mut slopes.as_mut_slice()[orbit.unknowns..]);
        let mut normal = slopes;
        normal[0] += normal.norm().copysign(normal[0]);
        normal.normalize_mut();
        let reflection = DMatrix::identity(size, size) - 2.0 * &normal * normal.transpose();
        map = (&reflection * map * &reflection).view((1, 1), (size - 1, size - 1)).into_owned();
    }
    let mut found: Vec<Complex<f64>> = map.complex_eigenvalues().data.into();
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

impl TorsionalSystem {
    /// How many multipliers a period has.
    pub fn multipliers(&self) -> usize {
        2 * self.unknowns() - usize::from(self.is_free())
    }

    /// The real multiplier that is nearest to the one with which the speed of the whole driveline
    /// returns: the load and the losses, less the slope of the drive, brake its mean inertia.
    pub(super) fn speed_multiplier(
        &self,
        speed: f64,
        torque_slope: f64,
        among: &[Complex<f64>],
    ) -> f64 {
        let Drive::Free { slope } = self.drive else { return f64::NAN };
        let period = PI * self.half_turns as f64 / speed;
        let expected = -(slope + torque_slope) * period / self.total_inertia();
        let real = among.iter().filter(|x| x.im == 0.0 && x.re > 0.0).map(|x| x.re);
        let apart = |x: &f64| (ln(*x) - expected).abs();
        real.min_by(|x, y| apart(x).total_cmp(&apart(y))).unwrap_or(f64::NAN)
    }
}

/// One period of each run at equally spaced drive angles. A record holds, for
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
    let (m, ends) = (first.compliant(), 2 * first.shafts());
    let goal = OrbitGoal { tolerance: runs.tolerance, order: 0.0, stability: false };
    let record = samples * (3 * ends + m + 1);
    runs.each(goal, (results, record), failures, execution, |pool, done| {
        for run in done {
            put_samples(run, samples, pool);
        }
    });
}

/// Unknowns and slopes at equally spaced drive angles by the series through those of the mesh.
fn by_series(orbit: &Orbit, samples: usize) -> Vec<f64> {
    let roots = roots_of_unity(orbit.intervals);
    let size = 2 * orbit.unknowns;
    let through =
        |i: usize| FourierSeries::through(orbit.half_turns, |k| orbit.states[k * size + i], &roots);
    let series: Vec<FourierSeries> = (0..size).map(through).collect();
    let width = PI * orbit.half_turns as f64 / samples as f64;
    let at = |i: usize| series.iter().map(move |series| series.at(width * i as f64)[0]);
    (0..samples).flat_map(at).collect()
}

/// The record of one run.
fn put_samples(
    Done { system, speed, found, out }: Done<'_, '_>,
    samples: usize,
    pool: &mut Pool<'_>,
) {
    let (m, ends, orbit) = (system.compliant(), 2 * system.shafts(), found.orbit);
    let mut equation = MotionEquation::new(system, speed, orbit.mean_torque);
    let states = if system.has_kinks() {
        system.sampled(&orbit, speed, samples, pool)
    } else {
        by_series(&orbit, samples)
    };
    let added = system.hysteretic_torques(speed, &found.torques);
    let mut pieces: Vec<PieceState> = vec![];
    let mut accelerations = vec![0.0; orbit.unknowns];
    for i in 0..samples {
        let angle = PI * system.half_turns as f64 * i as f64 / samples as f64;
        let (y, v) =
            states[2 * i * orbit.unknowns..][..2 * orbit.unknowns].split_at(orbit.unknowns);
        equation.added = added.iter().map(|series| series.at(angle)[0]).collect();
        equation.accelerations(angle, y, v, &mut accelerations);
        equation.pieces(angle, [y, v, &accelerations], &mut pieces);
        let mut put = |row: usize, value: f64| out[row * samples + i] = value;
        system.shaft_ends(&pieces, |end, [error, slope, curvature]| {
            put(end, error);
            put(ends + end, speed * slope);
            put(2 * ends + end, speed * speed * curvature);
        });
        for (s, torque) in equation.last_torques().iter().enumerate() {
            put(3 * ends + s, *torque);
        }
        let PieceState { slope, curvature, .. } = pieces[0];
        put(3 * ends + m, equation.at_drive(slope, curvature)[0]);
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
        let orders = [1.0, 2.0, 4.0];
        let count = which.len();
        let record = 6 + OF_DRIVE + 2 * 3 * (2 + 6);
        let mut steady = vec![0.0; count * record];
        let mut multipliers = vec![0.0; count * 10];
        let (mut failures, mut others) = (vec![None; count], vec![None; count]);
        steady_of_batch(&runs, &orders, &mut steady, &mut failures, execution);
        multipliers_of_batch(&runs, &mut multipliers, &mut others, execution);
        let records = steady.chunks(record).zip(multipliers.chunks(10));
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
