//! All orbits at one speed that are found from many starts.

use crate::dynamics::batch::{Runs, multipliers};
use crate::dynamics::motion_equation::MotionEquation;
use crate::dynamics::orbit::{Failure, Orbit};
use crate::dynamics::periodic::{FourierSeries, roots_of_unity};
use crate::dynamics::search::{OrbitGoal, refined};
use crate::dynamics::system::TorsionalSystem;
use crate::run::execution::Execution;

/// Orbits are different if their states at drive angle 0 differ by more than this, in rad and
/// relative to the drive's speed. One state has one motion.
const DIFFERENT: f64 = 1e-4;

/// A record of [`coexisting_of_batch`], per orbit, for `m` compliant shafts: mean, least and largest
/// torque of each, and the real and imaginary parts of the multipliers.
pub fn coexisting_record(compliant: usize) -> usize {
    7 * compliant
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
    let m = first.unknowns();
    let each = coexisting_record(m);
    let goal = OrbitGoal { tolerance: runs.tolerance, order: 0, stability: true };
    runs.each(results, 1 + most * each, failures, execution, |system, speed, out| {
        let orbits = system.search_all(speed, goal)?;
        let mut equation = MotionEquation::new(system, speed);
        let mut records: Vec<(f64, Vec<f64>)> = orbits
            .iter()
            .map(|orbit| {
                let roots = roots_of_unity(orbit.intervals);
                let mut record = vec![0.0; 3 * m];
                let mut peak = 0.0_f64;
                for (s, samples) in orbit.torques(&mut equation).iter().enumerate() {
                    let series = FourierSeries::through(|k| samples[k], &roots);
                    let [least, largest] = series.extremes();
                    (record[s], record[m + s], record[2 * m + s]) = (series.mean, least, largest);
                    peak = peak.max(largest.abs()).max(least.abs());
                }
                record.extend(multipliers(orbit).iter().flat_map(|x| [x.re, x.im]));
                (peak, record)
            })
            .collect();
        records[1..].sort_by(|(x, _), (y, _)| x.total_cmp(y));
        out.fill(f64::NAN);
        out[0] = records.len() as f64;
        for ((_, record), place) in records.iter().zip(out[1..].chunks_exact_mut(each)) {
            place.copy_from_slice(record);
        }
        Ok(())
    });
}

impl TorsionalSystem {
    /// The orbit that `search` finds, and all others from the straight driveline and the starts of
    /// `oscillations`.
    fn search_all(&self, speed: f64, goal: OrbitGoal) -> Result<Vec<Orbit>, Failure> {
        let mut orbits = vec![self.search(speed, goal)?];
        let mut equation = MotionEquation::new(self, speed);
        let mut found: Vec<_> = self.followed(&mut equation).into_iter().collect();
        found.extend(self.oscillations(&mut equation));
        for coarse in found {
            let known = |orbit: &Orbit| !orbit.differs(&coarse.orbit, DIFFERENT);
            if orbits.iter().any(known) {
                continue;
            }
            if let Ok(fine) = refined(coarse, &mut equation, goal)
                && orbits.iter().all(|orbit| orbit.differs(&fine, DIFFERENT))
            {
                orbits.push(fine);
            }
        }
        Ok(orbits)
    }
}
