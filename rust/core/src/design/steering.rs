//! Steering columns: the ratio straight ahead, its slope there, and symmetry of left and right.

use std::f64::consts::{FRAC_PI_2, PI};

use crate::design::records::fill_records;
use crate::input::Drivelines;
use crate::mechanics::geometry::Vector;
use crate::mechanics::transmission::Ideal;
use crate::number::elementary::{asin, atan2};
use crate::number::trig;
use crate::run::execution::Execution;

/// Where the ratio differs by less from left to right, no driver feels on which side of symmetry
/// straight ahead is.
const NOTICED: f64 = 1e-3;

/// Behaviour of a steering column about straight ahead.
///
/// The last shaft follows the column as the driven shaft of one joint. Its ratio is even about
/// every multiple of a quarter turn of that joint's input angle and about no other angle, so left
/// and right are symmetric if and only if straight ahead is at such a multiple.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Steering {
    /// Speed of the last shaft over that of the column, straight ahead.
    pub ratio: f64,
    /// Derivative of the ratio by the angle of the column there, per rad.
    pub slope: f64,
    /// Angle in rad by which straight ahead is beyond the nearest symmetric position, in
    /// `[−π/4, π/4]`.
    pub offset: f64,
    /// Whether that position is one of the largest ratio.
    pub quick: bool,
    /// By how much to turn the driving yoke of joint 0 on the column, in rad in `[−π/2, π/2]`, so
    /// that the ratio is largest straight ahead.
    pub turn_to_quick: f64,
    /// The same for the least ratio.
    pub turn_to_slow: f64,
    /// Largest difference of the ratio after equal turns to the left and to the right.
    pub difference: f64,
    /// The offset, or 0 where no driver notices it, as the difference is less than 0.1 %.
    pub noticed: f64,
}

impl Steering {
    /// The number of fields.
    pub const COUNT: usize = 8;

    /// From `n` bends, `n − 1` twists and `n − 1` phases, and the angle of the column straight
    /// ahead, in rad.
    pub fn of_chain(bends: &[f64], twists: &[f64], phases: &[f64], centre: f64) -> Self {
        let ideal = Ideal::of_chain(bends, twists, phases);
        let motion = ideal.motion(centre);
        let at = centre + ideal.equivalent().angle_offset();
        let quarters = (at / FRAC_PI_2).round_ties_even();
        let within_quarter = |angle: f64| angle - PI * (angle / PI).round_ties_even();
        let offset = at - FRAC_PI_2 * quarters;
        let difference = difference(ideal.equivalent().joint.k, at);
        Self {
            ratio: motion.speed_ratio,
            slope: motion.acceleration_ratio,
            offset,
            quick: quarters % 2.0 == 0.0,
            turn_to_quick: within_quarter(-at),
            turn_to_slow: within_quarter(FRAC_PI_2 - at),
            difference,
            noticed: if difference < NOTICED { 0.0 } else { offset },
        }
    }
}

/// The drive angle of a yoke on a column, where the yoke stands at `centre` on another one: each is
/// the direction of shaft 0 and the normal of the first bend plane, from which drive angles count.
///
/// A column that tilts carries its yoke along by the smallest rotation from one direction to the
/// other, `x − (a + b)·x (a + b)/(1 + a·b) + 2 a·x b`. The pin is square to `a`, so that the last
/// term vanishes.
pub fn carried([a, normal]: [Vector; 2], [b, normal_there]: [Vector; 2], centre: f64) -> f64 {
    let (sine, cosine) = trig::sin_cos(centre);
    let pin = cosine * normal.cross(&a) + sine * normal;
    let both = a + b;
    let there = pin - both.dot(&pin) / (1.0 + a.dot(&b)) * both;
    atan2(there.dot(&normal_there), there.dot(&normal_there.cross(&b)))
}

/// The largest difference of the ratio after equal turns to the left and to the right of an input
/// angle of the equivalent joint.
///
/// Let `A = 1 + k²`, `B = 2k`, `c` and `s` be cosine and sine of twice that angle, and `u` the cosine
/// of twice the turn. With the ratio `(1 − k²)/(A − B cos 2t)` both sides differ by
/// `2 (1 − k²) B s √(1 − u²)/((A − B c u)² − B² s² (1 − u²))`. This is largest at the root between
/// −1 and 1 of `B² u³ − (A² + B² (2 − s²)) u + 2 A B c`; one of the others is below and one above
/// (derived here).
fn difference(k: f64, at: f64) -> f64 {
    if k == 0.0 {
        return 0.0;
    }
    let (s, c) = trig::sin_cos(2.0 * at);
    let (a, b) = (1.0 + k * k, 2.0 * k);
    let linear = (a * a + b * b * (2.0 - s * s)) / (b * b);
    let reach = (linear / 3.0).sqrt();
    // At its end rounding leaves the sine of a right angle.
    let sine = (a * c / (b * reach * reach * reach)).clamp(-1.0, 1.0);
    let u = 2.0 * reach * trig::sin_cos(asin(sine) / 3.0).0;
    let rest = (1.0 - u * u).max(0.0);
    let (near, far) = (a - b * c * u, b * s);
    2.0 * (1.0 - k * k) * (far * rest.sqrt()).abs() / (near * near - far * far * rest)
}

/// The steering of drivelines of a batch with `joints` joints each, given by their numbers, at
/// these angles straight ahead, as records of [`Steering::COUNT`] numbers in the order of the
/// fields; `quick` is 1 or 0.
pub fn steering_of_batch(
    joints: usize,
    lines: &Drivelines<'_>,
    numbers: &[usize],
    (centres, drawn): (&[f64], Option<[Vector; 2]>),
    out: &mut [f64],
    execution: Execution<'_>,
) {
    fill_records(Steering::COUNT, out, execution, |i, record| {
        let (bends, twists, phases) = lines.chain(joints, numbers[i]);
        let centre = drawn.map_or(centres[i], |drawn| {
            carried(drawn, lines.column(joints, numbers[i]), centres[i])
        });
        let found = Steering::of_chain(bends, twists, phases, centre);
        let quick = f64::from(u8::from(found.quick));
        let Steering { ratio, slope, offset, turn_to_quick, turn_to_slow, .. } = found;
        let fields = [ratio, slope, offset, quick, turn_to_quick, turn_to_slow];
        record[..6].copy_from_slice(&fields);
        record[6..].copy_from_slice(&[found.difference, found.noticed]);
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turned_yokes_make_left_and_right_alike() {
        let (bends, twists, phases) = ([0.4, 0.3], [0.8], [-0.2]);
        let ideal = Ideal::of_chain(&bends, &twists, &phases);
        let found = Steering::of_chain(&bends, &twists, &phases, 0.7);
        for (turn, quick) in [(found.turn_to_quick, true), (found.turn_to_slow, false)] {
            assert!(turn.abs() <= FRAC_PI_2);
            let turned = Steering::of_chain(&bends, &twists, &phases, 0.7 + turn);
            assert!(turned.slope.abs() < 1e-14 && turned.offset.abs() < 1e-14);
            assert_eq!(turned.quick, quick);
            for side in [0.1, 0.5, 1.2] {
                let [left, right] = [side, -side].map(|by| ideal.motion(0.7 + turn + by));
                assert!((left.speed_ratio - right.speed_ratio).abs() < 1e-14);
                assert_eq!(left.speed_ratio < turned.ratio, quick);
            }
        }
    }

    #[test]
    fn the_difference_of_left_and_right_is_the_largest() {
        for (bends, twists, phases) in [
            (&[0.4, 0.3][..], &[0.8][..], &[-0.2][..]),
            (&[1.2], &[], &[]),
            (&[1e-4], &[], &[]),
            (&[0.3, 0.3], &[0.0], &[0.0]),
        ] {
            let ideal = Ideal::of_chain(bends, twists, phases);
            for centre in [0.0, 0.1, 0.7, -1.3, 2.0] {
                let found = Steering::of_chain(bends, twists, phases, centre).difference;
                let apart = |i: i32| {
                    let by = f64::from(i) * 1e-3;
                    let [left, right] = [by, -by].map(|by| ideal.motion(centre + by).speed_ratio);
                    (left - right).abs()
                };
                let largest = (0..3142).map(apart).fold(0.0, f64::max);
                let least = largest * (1.0 - 1e-5) - 1e-15;
                assert!(
                    found >= least && found <= largest * (1.0 + 1e-5) + 1e-15,
                    "{bends:?} {centre}"
                );
            }
        }
    }

    #[test]
    fn straight_ahead_has_the_motion_there() {
        let found = Steering::of_chain(&[0.5], &[], &[], 0.2);
        let step = 1e-5;
        let ratio = |angle: f64| Ideal::of_chain(&[0.5], &[], &[]).motion(angle).speed_ratio;
        assert_eq!(found.ratio, ratio(0.2));
        let slope = (ratio(0.2 + step) - ratio(0.2 - step)) / (2.0 * step);
        assert!((found.slope - slope).abs() < 1e-9);
        assert!(found.quick && (found.offset - 0.2).abs() < 1e-15);
    }
}
