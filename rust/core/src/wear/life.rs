//! The life of a joint, by the catalogue's law and by the exact load of its pins.
//!
//! The law is `L = 1.5·10⁶/(β n) (T_c/T)^(10/3)` in hours, with the bend `β` in degrees and the speed
//! `n` in rpm. The rating `T_c` is the torque that gives 5000 hours at 3 degrees and 100 rpm. Bends
//! below 3 degrees count as 3, because the law does not hold there.
//!
//! The law takes the torque for the load of all pins. Over a turn the load of a pin is the joint's
//! moment, which is larger than the torque, and what counts is the way over which it acts. The
//! equivalent moment of the pins in one yoke is therefore the mean of `|M|^(10/3)` over the way that
//! they turn in their bearings, to the power of 3/10. The lives of both yokes combine by the Weibull
//! slope 9/8 of roller bearings under line contact (derived here).

use crate::number::elementary::{cbrt, pow};

/// The bend in rad below which bends count as this one: 3 degrees.
pub const SMALLEST_BEND: f64 = 3.0 * DEGREE;

const DEGREE: f64 = std::f64::consts::PI / 180.0;
const SLOPE: f64 = 9.0 / 8.0;
/// Hours, degrees and rpm of the law: 5000 h at 3 degrees and 100 rpm.
const HOURS: f64 = 1.5e6;

/// `x^(10/3)`, the exponent of roller bearings.
#[inline]
pub(crate) fn harm(x: f64) -> f64 {
    x * x * x * cbrt(x)
}

/// The life of one joint in hours, by the load of its pins and by the law.
///
/// `means` are those of [`crate::Wear::Fatigue`], `bend` the joint's in rad, `rpm` the speed of the
/// drive, `rating` the joint's in N·m.
///
/// ```
/// let bend = 3_f64.to_radians();
/// let means = [500.0, 0.0, 0.0, 0.0, 0.0];
/// let [_, law] = cardan::hours(means, bend, 100.0, 500.0);
/// assert!((law - 5000.0).abs() < 1e-9);
/// ```
pub fn hours(means: [f64; 5], bend: f64, rpm: f64, rating: f64) -> [f64; 2] {
    let [torque, driving, driven, way_driving, way_driven] = means;
    let turning = HOURS / (bend.max(SMALLEST_BEND) / DEGREE * rpm);
    // Pins of a straight joint stand still and bear the torque alone.
    let of = |harmed: f64, way: f64| if way > 0.0 { harmed / way } else { harm(torque) };
    let yokes = [of(driving, way_driving), of(driven, way_driven)];
    let both = pow(0.5 * (pow(yokes[0], SLOPE) + pow(yokes[1], SLOPE)), 1.0 / SLOPE);
    [turning * harm(rating) / both, turning * harm(rating / torque)]
}

/// The life in a duty cycle of steps, from the share of each in the time and the life in it alone:
/// each step uses its share of the time over its life (Miner's rule).
pub fn miner(steps: impl Iterator<Item = (f64, f64)>) -> f64 {
    1.0 / steps.map(|(share, hours)| share / hours).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn damages_add_up() {
        let hours = miner([(0.25, 1000.0), (0.75, 3000.0)].into_iter());
        assert!((hours - 2000.0).abs() < 1e-9);
        assert_eq!(miner([(1.0, f64::INFINITY)].into_iter()), f64::INFINITY);
    }

    #[test]
    fn a_straight_joint_bears_the_torque_alone() {
        let [exact, law] = hours([200.0, 0.0, 0.0, 0.0, 0.0], 0.0, 1500.0, 300.0);
        assert!((exact / law - 1.0).abs() < 1e-14);
        assert!((law - 1.5e6 / (3.0 * 1500.0) * 1.5_f64.powf(10.0 / 3.0)).abs() < 1e-9);
    }

    #[test]
    fn no_torque_gives_no_end_of_life() {
        assert_eq!(hours([0.0, 0.0, 0.0, 0.1, 0.1], 0.2, 1500.0, 300.0), [f64::INFINITY; 2]);
    }
}
