//! Orbits followed from the straight driveline while its bends grow.
//!
//! Without bends the equations are linear, and with damping they have one orbit. From it a curve of
//! orbits leads to the driveline as built, since damping bounds every orbit (Leray and Schauder).
//! The curve may turn back at folds, so it is followed by its own length, in the states at drive
//! angle 0 and the share of every bend.

use nalgebra::DVector;

use crate::dynamics::orbit::Orbit;
use crate::dynamics::pool::{Parameter, Pool};
use crate::dynamics::search::{Found, Search};
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
    /// Share of every bend and harmonic torque.
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
    /// The first orbit of the driveline on the curve at a speed.
    pub(super) fn followed(&self, speed: f64, pool: &mut Pool<'_>) -> Option<Found> {
        let straight = self.bent(0.0);
        let [first, most] = INTERVALS;
        let rigid = Search::near_rigid(&straight, speed, first);
        let mut here = Point { orbit: pool.run(vec![rigid]).pop()?.ok()?.orbit, share: 0.0 };
        // At first only the bends change: orbits depend on their squares.
        let mut direction = DVector::zeros(2 * self.unknowns() + 1);
        direction[2 * self.unknowns()] = 1.0;
        let [shortest, longest] = LENGTHS;
        let mut length = longest;
        for _ in 0..STEPS {
            match self.ahead(&here, &direction, length, (speed, pool)) {
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
                    let search = Search::near(self, speed, close);
                    if let Some(Ok(found)) = pool.run(vec![search]).pop() {
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
                (here.orbit, length) = (pool.halved(&here.orbit), longest);
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
        (speed, pool): (f64, &mut Pool<'_>),
    ) -> Option<Point> {
        const MOST: usize = 8;
        const ENOUGH: f64 = 1e-7;
        let mut point = from.clone();
        let mut tangent: Option<Point> = None;
        for _ in 0..MOST {
            let [system, nearby] = [0.0, ASIDE].map(|aside| self.bent(point.share + aside));
            let parameter = Parameter {
                nearby: &nearby,
                by: ASIDE,
                direction: direction.as_slice(),
                length: if tangent.is_none() { length } else { 0.0 },
            };
            let step = pool.improve_along(&mut point.orbit, (&system, speed), &parameter)?;
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
    use crate::run::level::Level;

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
        let mut pool = Pool::new(Level::new(), None);
        assert!(system.followed(speed, &mut pool).is_some());
    }
}
