//! Orbits followed from the straight driveline while its bends grow.
//!
//! Without bends the equations are linear, and with damping they have one orbit. From it a curve of
//! orbits leads to the driveline as built, since damping bounds every orbit (Leray and Schauder).
//! The curve may turn back at folds, so it is followed by its own length, in the states at drive
//! angle 0 and the share of every bend.

use nalgebra::DVector;

use crate::dynamics::motion_equation::MotionEquation;
use crate::dynamics::orbit::{Along, Orbit};
use crate::dynamics::search::{COARSE, Found, converged};
use crate::dynamics::system::TorsionalSystem;

/// The intervals of half a turn at first, and the most.
const INTERVALS: [usize; 2] = [32, 256];

/// The shortest and the longest step, in rad, in slopes and in the share of the bends.
const LENGTHS: [f64; 2] = [1e-5, 0.25];

/// The most steps.
const STEPS: usize = 1000;

/// The change of the share with which the derivatives by it are found.
const ASIDE: f64 = 1e-6;

/// A point of the curve.
#[derive(Clone)]
struct Point {
    orbit: Orbit,
    /// Of every bend.
    share: f64,
}

impl Point {
    /// The difference of two points: the state at drive angle 0, then the share.
    fn minus(&self, other: &Self) -> DVector<f64> {
        let state = self.orbit.first_state_minus(&other.orbit);
        DVector::from_iterator(state.len() + 1, state.into_iter().chain([self.share - other.share]))
    }
}

impl TorsionalSystem {
    /// The first orbit of the driveline on the curve at the speed of its equations.
    pub(super) fn followed(&self, equation: &mut MotionEquation<'_>) -> Option<Found> {
        let straight = self.bent(0.0);
        let mut without = MotionEquation::new(&straight, equation.speed);
        let [first, most] = INTERVALS;
        let rigid =
            Orbit::start(self.unknowns(), first, |angle, state| without.rigid(angle, state));
        let mut here =
            Point { orbit: converged(rigid, &mut without, COARSE, None)?.orbit, share: 0.0 };
        // At first only the bends change: orbits depend on their squares.
        let mut direction = DVector::zeros(2 * self.unknowns() + 1);
        direction[2 * self.unknowns()] = 1.0;
        let [shortest, longest] = LENGTHS;
        let mut length = longest;
        for _ in 0..STEPS {
            match self.ahead(&here, &direction, length, equation.speed) {
                Some(next) if next.share < 0.0 => return None,
                Some(next) if next.share < 1.0 => {
                    direction = next.minus(&here).normalize();
                    here = next;
                    length = (1.5 * length).min(longest);
                    continue;
                }
                Some(next) => {
                    let part = (1.0 - here.share) / (next.share - here.share);
                    let close = here.orbit.towards(&next.orbit, part);
                    if let Some(found) = converged(close, equation, COARSE, None) {
                        return Some(found);
                    }
                }
                None => {}
            }
            length *= 0.25;
            if length < shortest {
                if 2 * here.orbit.intervals > most {
                    return None;
                }
                (here.orbit, length) = (here.orbit.halved(), longest);
            }
        }
        None
    }

    /// The point of the curve that is this far ahead in a direction: one step of Newton's method
    /// along the tangent, then others across the direction, which must stay small.
    fn ahead(
        &self,
        from: &Point,
        direction: &DVector<f64>,
        length: f64,
        speed: f64,
    ) -> Option<Point> {
        const MOST: usize = 8;
        const ENOUGH: f64 = 1e-7;
        let mut point = from.clone();
        let mut tangent: Option<Point> = None;
        for _ in 0..MOST {
            let systems = [0.0, ASIDE].map(|aside| self.bent(point.share + aside));
            let [mut equation, mut nearby] =
                systems.each_ref().map(|system| MotionEquation::new(system, speed));
            let along = Along {
                nearby: &mut nearby,
                by: ASIDE,
                direction: direction.as_slice(),
                length: if tangent.is_none() { length } else { 0.0 },
            };
            let step = point.orbit.improve(&mut equation, Some(along))?;
            point.share += step.parameter;
            let first = tangent.get_or_insert_with(|| point.clone());
            if point.minus(first).norm() > 0.5 * length {
                return None;
            }
            if step.change.max(step.parameter.abs()) < ENOUGH {
                return Some(point);
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dynamics::system::ShaftEnds;

    /// Two joints of 50° at a resonance; the flywheel's shaft twists by more than a radian.
    #[test]
    fn a_curve_is_followed_around_its_folds() {
        let shafts = ShaftEnds {
            inertias: &[0.0, 0.0, 0.0, 0.02, 0.02, 0.1],
            stiffnesses: &[f64::INFINITY, 4000.0, f64::INFINITY],
            dampings: &[0.0, 0.4, 0.0],
        };
        let system =
            TorsionalSystem::new(&[0.87, 0.87], &[0.0], &[0.4], shafts, [0.0, 0.0]).unwrap();
        let speed = 0.5 * system.natural_frequencies()[0];
        let mut equation = MotionEquation::new(&system, speed);
        assert!(system.followed(&mut equation).is_some());
    }
}
