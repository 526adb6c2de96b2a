//! The search for the orbit at one speed: starts and refinement of the mesh.

use std::f64::consts::{PI, TAU};

use crate::dynamics::motion_equation::MotionEquation;
use crate::dynamics::orbit::{Failure, NewtonStep, Orbit};
use crate::dynamics::periodic::{FourierSeries, roots_of_unity};
use crate::dynamics::system::TorsionalSystem;
use crate::number::elementary::norm;
use crate::number::trig;

/// The fewest and the most intervals of half a turn.
const FEWEST: usize = 8;
const MOST: usize = 1024;

/// The most steps of Newton's method from one start.
const STEPS: usize = 20;

/// Newton's method ends when its next step would be smaller than this, relative to the twist of the
/// shafts and to the permitted error.
const MARGIN: f64 = 0.01;

/// Permitted error relative to the twist on the mesh from which the refinement begins.
pub(super) const COARSE: f64 = 1e-6;

/// A change of an unknown in rad that is rounding.
const ROUNDING: f64 = 1e-14;

/// The accuracy that an orbit must have, and what is found with it.
#[derive(Clone, Copy, Debug)]
pub(super) struct OrbitGoal {
    /// Permitted error relative to the largest value.
    pub(super) tolerance: f64,
    /// The highest order of the drive's rotation that the mesh must resolve.
    pub(super) order: usize,
    /// Whether the multipliers count.
    pub(super) stability: bool,
}

impl TorsionalSystem {
    /// The periodic orbit at a speed of the drive in rad/s.
    pub(super) fn search(&self, speed: f64, goal: OrbitGoal) -> Result<Orbit, Failure> {
        if !(speed > 0.0 && speed < f64::INFINITY) {
            return Err(Failure::Speed);
        }
        let mut equation = MotionEquation::new(self, speed);
        let ways: [fn(&Self, &mut MotionEquation<'_>) -> Option<Found>; 2] =
            [Self::coarse, Self::followed];
        let mut failure = Failure::NotFound;
        for way in ways {
            match way(self, &mut equation).map(|found| refined(found, &mut equation, goal)) {
                Some(Ok(orbit)) => return Ok(orbit),
                Some(Err(reason)) => failure = reason,
                None => {}
            }
        }
        Err(failure)
    }

    /// An orbit on the coarsest mesh on which Newton's method converges, from rigid shafts, or from
    /// uniform rotation behind every compliant shaft.
    fn coarse(&self, equation: &mut MotionEquation<'_>) -> Option<Found> {
        let size = self.unknowns();
        [FEWEST, 4 * FEWEST].into_iter().find_map(|intervals| {
            let rigid = Orbit::start(size, intervals, |angle, state| equation.rigid(angle, state));
            converged(rigid, equation, COARSE, None).or_else(|| {
                let uniform = Orbit::start(size, intervals, |_, _| {});
                converged(uniform, equation, COARSE, None)
            })
        })
    }

    /// The orbits to which Newton's method converges from oscillations of the second order of
    /// several amplitudes and phases, of all unknowns from each one on.
    pub(super) fn oscillations(
        &self,
        equation: &mut MotionEquation<'_>,
    ) -> impl Iterator<Item = Found> {
        let starts = oscillation_starts(self.unknowns());
        starts.into_iter().filter_map(move |start| self.started_at(equation, start))
    }

    fn started_at(
        &self,
        equation: &mut MotionEquation<'_>,
        Oscillation { size, phase, from }: Oscillation,
    ) -> Option<Found> {
        let start = Orbit::start(self.unknowns(), 8 * FEWEST, |angle, [y, v, a]| {
            let (sine, cosine) = trig::sin_cos(2.0 * angle + phase);
            for (values, value) in [(y, sine), (v, 2.0 * cosine), (a, -4.0 * sine)] {
                values[..from].fill(0.0);
                values[from..].fill(size * value);
            }
        });
        converged(start, equation, COARSE, None)
    }
}

/// An oscillation of the second order.
#[derive(Clone, Copy, Debug)]
struct Oscillation {
    /// Amplitude in rad.
    size: f64,
    phase: f64,
    /// The first unknown that oscillates.
    from: usize,
}

/// Oscillations of several amplitudes and phases, largest first, of so many shapes.
fn oscillation_starts(shapes: usize) -> Vec<Oscillation> {
    const AMPLITUDES: [f64; 4] = [2.0, 1.0, 0.5, 0.25];
    const PHASES: u32 = 8;
    let each = |(from, size): (usize, f64)| {
        (0..PHASES).map(move |i| {
            let phase = TAU * f64::from(i) / f64::from(PHASES);
            Oscillation { size, phase, from }
        })
    };
    let shapes = (0..shapes).flat_map(|from| AMPLITUDES.map(|size| (from, size)));
    shapes.flat_map(each).collect()
}

/// An orbit to which Newton's method has converged.
pub(super) struct Found {
    pub(super) orbit: Orbit,
    /// The last step of Newton's method divided by the square of the one before it, per rad.
    contraction: f64,
    /// The unit of errors in rad.
    twist: f64,
}

/// The orbit to which Newton's method converges, with a permitted error relative to the twist. The
/// contraction, if it is known, saves the step that would only confirm the one before.
pub(super) fn converged(
    mut orbit: Orbit,
    equation: &mut MotionEquation<'_>,
    tolerance: f64,
    mut contraction: Option<f64>,
) -> Option<Found> {
    const SAFETY: f64 = 10.0;
    let mut before: Option<f64> = None;
    for _ in 0..STEPS {
        let NewtonStep { change, twist, .. } = orbit.improve(equation, None)?;
        if let Some(before) = before {
            contraction = Some(change / (before * before));
        }
        let next = contraction.map_or(f64::INFINITY, |factor| SAFETY * factor * change * change);
        if change <= ROUNDING || next <= MARGIN * tolerance * twist {
            let contraction = contraction.unwrap_or_default();
            return Some(Found { orbit, contraction, twist });
        }
        before = Some(change);
    }
    None
}

/// Halves the intervals until the orbit, its slopes, its harmonics and its multipliers no longer
/// change. A fast free vibration shows in the slopes, multiplied by its order, before it shows in the
/// orbit.
pub(super) fn refined(
    found: Found,
    equation: &mut MotionEquation<'_>,
    goal: OrbitGoal,
) -> Result<Orbit, Failure> {
    // Halving divides the error at least by the first. It divides it by the second if that was
    // observed and no free vibration is too fast for the intervals: what they leave of one decreases
    // later, when it may be all that is left.
    const GAINS: (f64, f64) = (16.0, 128.0);
    let Found { mut orbit, mut contraction, .. } = found;
    let mut before = [f64::NAN; 3];
    while 2 * orbit.intervals <= MOST {
        let fine = converged(orbit.halved(), equation, goal.tolerance, Some(contraction))
            .ok_or(Failure::NotFound)?;
        let scales = [fine.twist, fine.orbit.largest_slope(), fine.orbit.monodromy.amax().max(1.0)];
        let [angles, slopes] = differences(&orbit, &fine.orbit);
        let maps = if goal.stability { maps_differ(&orbit, &fine.orbit) } else { 0.0 };
        let change = [angles, slopes, maps];
        let settled_by = |most: f64| {
            (0..3).all(|i| {
                // NaN, at first, counts as no gain.
                let gain = (before[i] / change[i]).max(GAINS.0).min(most);
                change[i] <= (gain * goal.tolerance * scales[i]).max(10.0 * ROUNDING)
            })
        };
        let settled = settled_by(GAINS.0)
            || settled_by(GAINS.1) && follows_free_vibrations(&fine.orbit, equation);
        (orbit, contraction, before) = (fine.orbit, fine.contraction, change);
        if settled && orbit.intervals > goal.order && resolved(&orbit, equation, goal) {
            return Ok(orbit);
        }
    }
    Err(Failure::NotResolved)
}

/// Whether the intervals are shorter than half a period of every free vibration.
fn follows_free_vibrations(orbit: &Orbit, equation: &MotionEquation<'_>) -> bool {
    let highest = equation.system.natural_frequencies().last().copied();
    highest.is_some_and(|highest| orbit.width() * highest <= PI * equation.speed)
}

/// The largest difference of the maps of half a turn.
fn maps_differ(coarse: &Orbit, fine: &Orbit) -> f64 {
    (&fine.monodromy - &coarse.monodromy).amax()
}

/// The largest differences of unknowns, in rad, and of slopes at the points that both meshes share.
fn differences(coarse: &Orbit, fine: &Orbit) -> [f64; 2] {
    let largest = |x: &[f64], y: &[f64]| -> f64 {
        x.iter().zip(y).fold(0.0, |most, (x, y)| most.max((x - y).abs()))
    };
    (0..coarse.intervals).fold([0.0, 0.0], |[angles, slopes]: [f64; 2], k| {
        let (near, exact) = (coarse.state(k), fine.state(2 * k));
        [angles.max(largest(near.0, exact.0)), slopes.max(largest(near.1, exact.1))]
    })
}

/// Whether the torques at the ends of the intervals resolve their own harmonics.
fn resolved(orbit: &Orbit, equation: &mut MotionEquation<'_>, goal: OrbitGoal) -> bool {
    let roots = roots_of_unity(orbit.intervals);
    let torques = orbit.torques(equation);
    equation.system.springs.iter().zip(&torques).all(|(spring, torques)| {
        let series = FourierSeries::through(|k| torques[k], &roots);
        let largest = series.amplitudes.iter().fold(series.mean.abs(), |x, y| x.max(norm(*y)));
        let permitted = goal.tolerance * largest;
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
