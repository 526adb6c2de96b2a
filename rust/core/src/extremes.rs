//! Where a shaft's motion is extreme, in closed form.
//!
//! Between two extremes every output of the motion rises or falls all the way, so the smallest and
//! the largest of a row of samples stand beside an extreme or at an end: a reduction looks at no
//! others. With `a` the equivalent joint's driving angle and `k = tan²(β/2)`:
//!
//! * speed ratio: `cos 2a = ±1` (catalogue, Bild 13)
//! * angle error: `cos 2a = k`, which is `tan² a = cos β` (catalogue, Bild 12)
//! * acceleration ratio: `2k cos² 2a + (1 + k²) cos 2a = 4k`, which is [`crate::Joint::steepest`]

use std::f64::consts::{FRAC_PI_2, PI};
use std::ops::Range;

use crate::plan::ShaftStep;
use crate::sweep::Sweep;

/// The swing of a shaft as far as its extremes go.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Crest {
    /// `2φ`: the equivalent joint's driving angle is `α + φ`.
    pub(crate) twice_offset: f64,
    /// `k`.
    pub(crate) k: f64,
}

impl Crest {
    /// The drive angles of the extremes of what is wanted of the shaft, but for half turns.
    fn angles(self, step: &ShaftStep) -> impl Iterator<Item = f64> {
        let k = self.k;
        let farthest = k.min(1.0).acos();
        let square = k * k;
        let sum = 1.0 + square;
        let steepest = (8.0 * k / (sum + (sum * sum + 32.0 * square).sqrt())).min(1.0).acos();
        let error = step.angle_error.is_some();
        let ratio = step.speed_ratio.is_some();
        let acceleration = step.acceleration_ratio.is_some();
        [
            (error, farthest),
            (error, -farthest),
            (ratio, 0.0),
            (ratio, PI),
            (acceleration, steepest),
            (acceleration, -steepest),
        ]
        .into_iter()
        .filter_map(move |(wanted, twice)| wanted.then_some(0.5 * (twice - self.twice_offset)))
    }
}

/// The samples of a sweep beside the extremes of the shafts, and both ends; `None` if there are too
/// many to repay it: each finds its own sine and cosine, which rows have in common otherwise.
pub(crate) fn beside<'a>(
    sweep: &Sweep,
    samples: Range<usize>,
    shafts: impl Iterator<Item = (&'a ShaftStep, Crest)>,
) -> Option<Vec<f64>> {
    const EXTREMES: usize = 6;
    const REPAID: usize = 64;
    let [first, last] = [samples.start, samples.end - 1].map(|i| sweep.angle(i as f64).value());
    let half_turns = ((last - first).abs() / PI) as usize + 2;
    let mut found = vec![samples.start as f64, (samples.end - 1) as f64];
    if found.len() * REPAID > samples.len() {
        return None;
    }
    // Half turns do not matter, and the remainder has more digits than a far angle.
    let (remainder, quadrant) = sweep.reduction().of(samples.start as f64);
    let first = remainder.value() + (quadrant & 1) as f64 * FRAC_PI_2;
    for (step, crest) in shafts {
        if (half_turns * EXTREMES * 2 + found.len()) * REPAID > samples.len() {
            return None;
        }
        for angle in crest.angles(step) {
            // The first one at or after the start, in the sense of the sweep.
            let width = sweep.step() / PI;
            let offset = (angle - first) / PI;
            let turns = if width > 0.0 { offset - offset.floor() } else { offset - offset.ceil() };
            for half_turn in 0..half_turns {
                let ahead = turns + (half_turn as f64).copysign(width);
                let beside = samples.start as f64 + (ahead / width).floor();
                let inside = |&i: &f64| i >= samples.start as f64 && i < samples.end as f64;
                found.extend([beside, beside + 1.0].into_iter().filter(inside));
            }
        }
    }
    Some(found)
}
