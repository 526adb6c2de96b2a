//! The angles at which a shaft's motion is extreme, in closed form.
//!
//! Between two extremes every output of the motion is monotonic, so the smallest and the largest of
//! a row of samples lie next to an extreme or at an end. A reduction needs no other samples. With
//! `a` the equivalent joint's input angle and `k = tan²(β/2)`, the extremes are at:
//!
//! * speed ratio: `cos 2a = ±1` (catalogue, Bild 13)
//! * angle error: `cos 2a = k`, which is `tan² a = cos β` (catalogue, Bild 12)
//! * acceleration ratio: `2k cos² 2a + (1 + k²) cos 2a = 4k`, which is [`crate::Joint::steepest`]
//! * jerk ratio: `cos 2a = ±1`, and where it has a solution
//!   `4k² cos² 2a + 8k (1 + k²) cos 2a = 24k² − (1 + k²)²` (derived here, by differentiating
//!   `(1 − k²)/(1 + k² − 2k cos 2a)` three times)

use std::f64::consts::PI;

use crate::number::elementary::acos;

/// The constants of a shaft's motion that determine its extremes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ExtremaLocator {
    /// `2φ`: the equivalent joint's input angle is `α + φ`.
    pub(crate) double_offset: f64,
    /// `k`.
    pub(crate) k: f64,
}

impl ExtremaLocator {
    /// The drive angles in rad, modulo half a turn, of the extremes of the selected outputs: angle
    /// error, speed ratio, acceleration ratio and jerk ratio.
    pub(crate) fn angles(self, selected: [bool; 4]) -> impl Iterator<Item = f64> {
        let k = self.k;
        let error_extreme = acos(k.min(1.0));
        let square = k * k;
        let sum = 1.0 + square;
        let acceleration_extreme =
            acos((8.0 * k / (sum + (sum * sum + 32.0 * square).sqrt())).min(1.0));
        let jerk_extreme = 24.0 * square - sum * sum;
        let jerk_extreme =
            jerk_extreme / (2.0 * k * (2.0 * sum + (3.0 * sum * sum + 24.0 * square).sqrt()));
        // At shallow bends the inner extremes of the jerk ratio coincide with the one at 90°.
        let jerk_extreme = acos(jerk_extreme.clamp(-1.0, 1.0));
        let [error, ratio, acceleration, jerk] = selected;
        [
            (error, error_extreme),
            (error, -error_extreme),
            (ratio, 0.0),
            (ratio, PI),
            (acceleration, acceleration_extreme),
            (acceleration, -acceleration_extreme),
            (jerk, 0.0),
            (jerk, PI),
            (jerk, jerk_extreme),
            (jerk, -jerk_extreme),
        ]
        .into_iter()
        .filter_map(move |(selected, double_angle)| {
            selected.then_some(0.5 * (double_angle - self.double_offset))
        })
    }
}
