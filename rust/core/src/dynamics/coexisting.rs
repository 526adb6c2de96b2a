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
/// shaft, and the real and imaginary parts of the multipliers.
pub fn coexisting_record(compliant: usize, multipliers: usize) -> usize {
    3 * compliant + 2 * multipliers
}

/// Up to `most` orbits of each run: their number, which may be larger, then the records of
/// [`coexisting_record`]. The first is the orbit of the steady state; the others follow by their
/// largest torque. What is missing is NaN.
pub fn coexisting_of_batch(
    runs: &Runs<'_>,
    most: usize,
    results: &mut [f64],
    failures: &mut [Option<Failure>],
    execution: Execution<'_>,
) {
    let Some(first) = runs.systems.first() else { return };
    let m = first.compliant();
    let each = coexisting_record(m, first.multipliers());
    let goal = OrbitGoal { tolerance: runs.tolerance, order: 0.0, stability: true };
    let record = 1 + most * each;
    runs.each(goal, (results, record), failures, execution, |pool, done| {
        for Done { system, speed, found, out } in done {
            let orbits = system.search_all(found, speed, goal, pool);
            let mut records: Vec<(f64, Vec<f64>)> = vec![];
            for found in orbits {
                let mut record = vec![0.0; 3 * m];
                let mut lane = [Done { system, speed, found, out: &mut record }];
                for s in 0..m {
                    put_torques(pool, &mut lane, s, m);
                }
                let [Done { found, .. }] = lane;
                let peak = record[m..].iter().fold(0.0, |most: f64, x| most.max(x.abs()));
                record.extend(
                    multipliers(system, speed, &found.orbit).iter().flat_map(|x| [x.re, x.im]),
                );
                records.push((peak, record));
            }
            records[1..].sort_by(|(x, _), (y, _)| x.total_cmp(y));
            out.fill(f64::NAN);
            out[0] = records.len() as f64;
            for ((_, record), place) in records.iter().zip(out[1..].chunks_exact_mut(each)) {
                place.copy_from_slice(record);
            }
        }
    });
}

impl TorsionalSystem {
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
