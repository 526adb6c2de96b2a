//! The search for the orbit at one speed: starts, refinement of the mesh, continuation in speed.

use crate::dynamics::motion_equation::MotionEquation;
use crate::dynamics::orbit::{Failure, Orbit};
use crate::dynamics::periodic::{Series, roots_of_unity};
use crate::dynamics::system::TorsionalSystem;

/// The fewest and the most intervals of half a turn.
const FEWEST: usize = 8;
const MOST: usize = 1024;

/// The most steps of Newton's method from one start.
const STEPS: usize = 20;

/// An orbit is found when Newton's step is smaller than this, relative to the twist of the shafts:
/// the step converges quadratically, so the next one would be near rounding.
const CLOSE: f64 = 1e-6;

/// A change of an unknown in rad that is rounding.
const ROUNDING: f64 = 1e-14;

/// Which accuracy is wanted of an orbit.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wanted {
    /// Permitted error relative to the largest value.
    pub(super) tolerance: f64,
    /// The highest order of the drive's rotation that the mesh must resolve.
    pub(super) order: usize,
    /// Whether the multipliers count.
    pub(super) stability: bool,
}

impl TorsionalSystem {
    /// The periodic orbit at a speed of the drive in rad/s.
    pub(super) fn search(&self, speed: f64, wanted: Wanted) -> Result<Orbit, Failure> {
        if !(speed > 0.0 && speed < f64::INFINITY) {
            return Err(Failure::Speed);
        }
        let mut equation = MotionEquation::new(self, speed);
        let coarse = self.coarse(&mut equation).or_else(|| self.continued(speed));
        refined(coarse.ok_or(Failure::NotFound)?, &mut equation, wanted)
    }

    /// An orbit on the coarsest mesh on which Newton's method converges, from rigid shafts, or from
    /// uniform rotation behind every compliant shaft.
    fn coarse(&self, equation: &mut MotionEquation<'_>) -> Option<Orbit> {
        let size = self.unknowns();
        [FEWEST, 4 * FEWEST].into_iter().find_map(|intervals| {
            let rigid = Orbit::start(size, intervals, |angle, state| equation.rigid(angle, state));
            converged(rigid, equation, CLOSE).or_else(|| {
                let uniform = Orbit::start(size, intervals, |_, _| {});
                converged(uniform, equation, CLOSE)
            })
        })
    }

    /// An orbit by continuation from a speed above all resonances, where the masses turn uniformly.
    fn continued(&self, speed: f64) -> Option<Orbit> {
        const RATIO: f64 = 1.25;
        const SMALLEST: f64 = 1.0 + 1e-4;
        let highest = self.natural_frequencies().last().copied()?;
        let mut reached = 4.0 * highest.max(speed);
        let size = self.unknowns();
        let start = Orbit::start(size, 4 * FEWEST, |_, _| {});
        let mut orbit = converged(start, &mut MotionEquation::new(self, reached), CLOSE)?;
        let mut ratio = RATIO;
        while reached > speed {
            let next = (reached / ratio).max(speed);
            if let Some(found) =
                converged(orbit.clone(), &mut MotionEquation::new(self, next), CLOSE)
            {
                (orbit, reached) = (found, next);
                ratio = (ratio * ratio).min(RATIO);
            } else if ratio > SMALLEST {
                ratio = ratio.sqrt();
            } else {
                return None;
            }
        }
        Some(orbit)
    }
}

/// The orbit to which Newton's method converges.
fn converged(mut orbit: Orbit, equation: &mut MotionEquation<'_>, close: f64) -> Option<Orbit> {
    for _ in 0..STEPS {
        let change = orbit.improve(equation)?;
        if change <= ROUNDING.max(close * twist(&orbit, equation)) {
            return Some(orbit);
        }
    }
    None
}

/// The largest twist of the compliant shaft that twists least, in rad: the unit of errors.
fn twist(orbit: &Orbit, equation: &mut MotionEquation<'_>) -> f64 {
    let mut largest = vec![0.0_f64; orbit.unknowns];
    for k in 0..orbit.intervals {
        let (y, v) = orbit.state(k);
        let torques = equation.torques(orbit.width() * k as f64, y, v);
        for (most, torque) in largest.iter_mut().zip(torques) {
            *most = most.max(torque.abs());
        }
    }
    let springs = equation.system.springs.iter();
    springs
        .zip(largest)
        .fold(f64::INFINITY, |least, (spring, torque)| least.min(torque / spring.stiffness))
}

/// Halves the intervals until the orbit, its harmonics and its multipliers no longer change.
fn refined(
    mut orbit: Orbit,
    equation: &mut MotionEquation<'_>,
    wanted: Wanted,
) -> Result<Orbit, Failure> {
    // Halving reduces the error at least so much, far more once the mesh resolves the motion.
    const GAIN: f64 = 16.0;
    let close = if wanted.stability { 1e-9 } else { CLOSE };
    while 2 * orbit.intervals <= MOST {
        let fine = converged(orbit.halved(), equation, close).ok_or(Failure::NotFound)?;
        let permitted = (GAIN * wanted.tolerance * twist(&fine, equation)).max(10.0 * ROUNDING);
        let same = difference(&orbit, &fine) <= permitted;
        let steady = !wanted.stability || {
            let change = (&fine.monodromy - &orbit.monodromy).amax();
            change <= GAIN * wanted.tolerance * fine.monodromy.amax().max(1.0)
        };
        orbit = fine;
        if same && steady && orbit.intervals > wanted.order && resolved(&orbit, equation, wanted) {
            return Ok(orbit);
        }
    }
    Err(Failure::NotResolved)
}

/// The largest difference of unknowns at the points that both meshes share, in rad.
fn difference(coarse: &Orbit, fine: &Orbit) -> f64 {
    (0..coarse.intervals).fold(0.0, |most: f64, k| {
        let pairs = coarse.state(k).0.iter().zip(fine.state(2 * k).0);
        pairs.fold(most, |most, (x, y)| most.max((x - y).abs()))
    })
}

/// Whether the torques at the ends of the intervals resolve their own harmonics.
fn resolved(orbit: &Orbit, equation: &mut MotionEquation<'_>, wanted: Wanted) -> bool {
    let roots = roots_of_unity(orbit.intervals);
    let torques = orbit.torques(equation);
    equation.system.springs.iter().zip(&torques).all(|(spring, torques)| {
        let series = Series::through(|k| torques[k], &roots);
        let largest = series.amplitudes.iter().fold(series.mean.abs(), |x, y| x.max(y.norm()));
        let permitted = wanted.tolerance * largest;
        series.tail() <= permitted.max(10.0 * ROUNDING * spring.stiffness)
    })
}

impl Orbit {
    /// The torque of every compliant shaft at the start of every interval.
    pub(super) fn torques(&self, equation: &mut MotionEquation<'_>) -> Vec<Vec<f64>> {
        let mut found = vec![Vec::with_capacity(self.intervals); self.unknowns];
        for k in 0..self.intervals {
            let (y, v) = self.state(k);
            let torques = equation.torques(self.width() * k as f64, y, v);
            for (column, torque) in found.iter_mut().zip(torques) {
                column.push(*torque);
            }
        }
        found
    }
}
