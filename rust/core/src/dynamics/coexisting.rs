//! All orbits at one speed that are found from many starts.

use crate::dynamics::batch::{Done, Runs, multipliers, put_torques};
use crate::dynamics::orbit::{Failure, Orbit};
use crate::dynamics::pool::Pool;
use crate::dynamics::search::{Found, OrbitGoal, Search};
use crate::dynamics::system::TorsionalSystem;
use crate::run::execution::Execution;

/// Orbits are different if their states at drive angle 0 differ by more than this, in rad and
/// relative to the drive's speed. One state has one motion.
const DIFFERENT: f64 = 1e-4;

/// A record of [`coexisting_of_batch`], per orbit: mean, least and largest torque of each compliant
/// shaft, the real and imaginary parts of the multipliers, and the one that belongs to the speed.
pub fn coexisting_record(compliant: usize, multipliers: usize) -> usize {
    3 * compliant + 2 * multipliers + 1
}

/// Up to `most` orbits of each run: their number, which may be larger, then the records of
/// [`coexisting_record`]. The first is the orbit of the steady state; the others follow by their
/// largest torque. What is missing is NaN.
///
/// In systems with loss factors, the others and all multipliers are those with viscous dampings that
/// take as much from the orbit of the steady state.
pub fn coexisting_of_batch(
    runs: &Runs<'_>,
    most: usize,
    results: &mut [f64],
    failures: &mut [Option<Failure>],
    execution: Execution<'_>,
) {
    let Some(first) = runs.systems.first() else { return };
    let each = coexisting_record(first.compliant(), first.multipliers());
    let lossy = runs.systems.iter().any(TorsionalSystem::has_loss_factors);
    let goal = OrbitGoal { tolerance: runs.tolerance, order: 0.0, stability: true };
    let of_steady = OrbitGoal { stability: !lossy, ..goal };
    let record = 1 + most * each;
    runs.each(of_steady, (results, record), failures, execution, |pool, done| {
        for Done { system, speed, found, out } in done {
            let records = if lossy {
                system.records_in_time(found, speed, goal, pool)
            } else {
                system.records(found, speed, goal, pool)
            };
            out.fill(f64::NAN);
            out[0] = records.len() as f64;
            for (record, place) in records.iter().zip(out[1..].chunks_exact_mut(each)) {
                place[..record.len()].copy_from_slice(record);
            }
        }
    });
}

impl TorsionalSystem {
    /// The records of the steady state and of the other orbits.
    fn records(
        &self,
        steady: Found,
        speed: f64,
        goal: OrbitGoal,
        pool: &mut Pool<'_>,
    ) -> Vec<Vec<f64>> {
        let mut records: Vec<(f64, Vec<f64>)> = vec![];
        for found in self.search_all(steady, speed, goal, pool) {
            let (Found { orbit, drive, .. }, mut record) = self.with_torques(found, speed, pool);
            let peak =
                record[self.compliant()..].iter().fold(0.0, |most: f64, x| most.max(x.abs()));
            let known = multipliers(self, speed, &orbit);
            record.extend(known.iter().flat_map(|x| [x.re, x.im]));
            let slope = match drive.torque_slope {
                None if self.is_free() => pool.torque_slopes(&[(self, speed)], &[&orbit])[0],
                known => known.unwrap_or(f64::NAN),
            };
            record.push(self.speed_multiplier(speed, slope, &known));
            records.push((peak, record));
        }
        records[1..].sort_by(|(x, _), (y, _)| x.total_cmp(y));
        records.into_iter().map(|(_, record)| record).collect()
    }

    /// The same of a system with loss factors. No multipliers are known if the orbit with the viscous
    /// dampings is not found.
    fn records_in_time(
        &self,
        steady: Found,
        speed: f64,
        goal: OrbitGoal,
        pool: &mut Pool<'_>,
    ) -> Vec<Vec<f64>> {
        let viscous = self.viscous_on_orbit(speed, &steady.torques);
        let (_, torques) = self.with_torques(steady, speed, pool);
        let found = pool.run(vec![Search::at(&viscous, speed, goal)]).remove(0);
        let Ok(mut found) = found else { return vec![torques] };
        found.drive.torque_slope = self.torque_slope(speed, goal, pool);
        let mut records = viscous.records(found, speed, goal, pool);
        records[0][..torques.len()].copy_from_slice(&torques);
        records
    }

    /// An orbit with the mean, least and largest torque of each compliant shaft.
    fn with_torques(&self, found: Found, speed: f64, pool: &mut Pool<'_>) -> (Found, Vec<f64>) {
        let m = self.compliant();
        let mut torques = vec![0.0; 3 * m];
        let mut lane = [Done { system: self, speed, found, out: &mut torques }];
        for shaft in 0..m {
            put_torques(pool, &mut lane, shaft, m);
        }
        let [Done { found, .. }] = lane;
        (found, torques)
    }

    /// The orbit of the steady state, and all others from the straight driveline and from
    /// oscillations.
    fn search_all(
        &self,
        steady: Found,
        speed: f64,
        goal: OrbitGoal,
        pool: &mut Pool<'_>,
    ) -> Vec<Found> {
        let differs = |orbit: &Orbit, known: &[Found]| {
            known.iter().all(|known| known.orbit.differs(orbit, DIFFERENT))
        };
        let mut orbits = vec![steady];
        let mut add = |coarse: &Orbit, fine: &mut dyn FnMut() -> Option<Found>| {
            if differs(coarse, &orbits)
                && let Some(fine) = fine()
                && differs(&fine.orbit, &orbits)
            {
                orbits.push(fine);
            }
        };
        if self.has_kinks() {
            for coarse in self.shot_nearby(speed, pool) {
                add(&coarse, &mut || self.shoot_from(&coarse, speed, goal, pool).ok());
            }
            return orbits;
        }
        let starts = self.oscillations().map(|start| Search::near(self, speed, start)).collect();
        let followed = self.followed(speed, pool);
        let started = pool.run(starts).into_iter().flatten();
        for coarse in followed.into_iter().chain(started) {
            let orbit = coarse.orbit.clone();
            let mut coarse = Some(coarse);
            add(&orbit, &mut || {
                let search = Search::refining(self, speed, goal, coarse.take()?);
                pool.run(vec![search]).pop()?.ok()
            });
        }
        orbits
    }
}
