//! Where a shaft's motion is extreme, in closed form.
//!
//! Between two extremes every output of the motion rises or falls all the way, so the smallest and
//! the largest of a row of samples stand beside an extreme or at an end: a reduction looks at no
//! others. With `a` the equivalent joint's driving angle and `k = tan²(β/2)`:
//!
//! * speed ratio: `cos 2a = ±1` (catalogue, Bild 13)
//! * angle error: `cos 2a = k`, which is `tan² a = cos β` (catalogue, Bild 12)
//! * acceleration ratio: `2k cos² 2a + (1 + k²) cos 2a = 4k`, which is [`crate::Joint::steepest`]
//! * jerk ratio: `cos 2a = ±1`, and `4k² cos² 2a + 8k (1 + k²) cos 2a = 24k² − (1 + k²)²` where it has a
//!   solution (derived here, by differentiating `(1 − k²)/(1 + k² − 2k cos 2a)` three times)

use std::f64::consts::PI;

/// The swing of a shaft as far as its extremes go.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ExtremaLocator {
    /// `2φ`: the equivalent joint's driving angle is `α + φ`.
    pub(crate) twice_offset: f64,
    /// `k`.
    pub(crate) k: f64,
}

impl ExtremaLocator {
    /// The drive angles of the extremes of angle error, speed ratio, acceleration ratio and jerk ratio,
    /// those of them that are wanted, but for half turns.
    pub(crate) fn angles(self, wanted: [bool; 4]) -> impl Iterator<Item = f64> {
        let k = self.k;
        let farthest = k.min(1.0).acos();
        let square = k * k;
        let sum = 1.0 + square;
        let steepest = (8.0 * k / (sum + (sum * sum + 32.0 * square).sqrt())).min(1.0).acos();
        let inner = 24.0 * square - sum * sum;
        let inner = inner / (2.0 * k * (2.0 * sum + (3.0 * sum * sum + 24.0 * square).sqrt()));
        // Shallow bends have no inner extreme: both coincide with that of half a turn.
        let inner = inner.clamp(-1.0, 1.0).acos();
        let [error, ratio, acceleration, jerk] = wanted;
        [
            (error, farthest),
            (error, -farthest),
            (ratio, 0.0),
            (ratio, PI),
            (acceleration, steepest),
            (acceleration, -steepest),
            (jerk, 0.0),
            (jerk, PI),
            (jerk, inner),
            (jerk, -inner),
        ]
        .into_iter()
        .filter_map(move |(wanted, twice)| wanted.then_some(0.5 * (twice - self.twice_offset)))
    }
}
