//! Samples of a sweep near the extremes of a row, which determine its smallest and largest values.

use std::f64::consts::{FRAC_PI_2, PI};
use std::ops::Range;

use crate::input::sweep::Sweep;
use crate::mechanics::extremes::ExtremaLocator;
use crate::plan::output::Output;
use crate::plan::steps::ShaftStep;

/// The outputs whose extremes [`ExtremaLocator::angles`] returns, in its order.
const LOCATED: [Output; 4] =
    [Output::AngleError, Output::SpeedRatio, Output::AccelerationRatio, Output::JerkRatio];

/// The samples of a sweep next to the extremes of the shafts, and both end samples. `None` if they
/// are too many to save time: each of them needs its own sine and cosine, which a whole row can
/// share.
pub(crate) fn samples_near_extrema<'a>(
    sweep: &Sweep,
    samples: Range<usize>,
    shafts: impl Iterator<Item = (&'a ShaftStep, ExtremaLocator)>,
) -> Option<Vec<f64>> {
    const SAMPLES_PER_CANDIDATE: usize = 64;
    let [first, last] = [samples.start, samples.end - 1].map(|i| sweep.angle(i as f64).value());
    let half_turns = ((last - first).abs() / PI) as usize + 2;
    let mut candidates = vec![samples.start as f64, (samples.end - 1) as f64];
    if candidates.len() * SAMPLES_PER_CANDIDATE > samples.len() {
        return None;
    }
    // Half turns do not matter, and the remainder is more exact than a large angle.
    let (remainder, quadrant) = sweep.reduction().of(samples.start as f64);
    let first = remainder.value() + (quadrant & 1) as f64 * FRAC_PI_2;
    for (step, extrema_locator) in shafts {
        let needed = LOCATED.map(|output| step.planes.get(output).is_some());
        let extremes = if needed[3] { 10 } else { 6 };
        if (half_turns * extremes * 2 + candidates.len()) * SAMPLES_PER_CANDIDATE > samples.len() {
            return None;
        }
        for angle in extrema_locator.angles(needed) {
            // The first extreme at or after the start, in the direction of the sweep.
            let width = sweep.step() / PI;
            let offset = (angle - first) / PI;
            let turns = if width > 0.0 { offset - offset.floor() } else { offset - offset.ceil() };
            for half_turn in 0..half_turns {
                let ahead = turns + (half_turn as f64).copysign(width);
                let index = samples.start as f64 + (ahead / width).floor();
                let inside = |&i: &f64| i >= samples.start as f64 && i < samples.end as f64;
                candidates.extend([index, index + 1.0].into_iter().filter(inside));
            }
        }
    }
    Some(candidates)
}
