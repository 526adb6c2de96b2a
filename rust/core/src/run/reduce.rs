//! Reducing a row of samples while it is computed, without storing it, or from those samples of a
//! sweep that are near its extremes.

use std::f64::consts::{FRAC_PI_2, PI};
use std::ops::Range;

use crate::input::sweep::Sweep;
use crate::mechanics::extremes::ExtremaLocator;
use crate::number::double_double::DoubleDouble;
use crate::number::float::Float;
use crate::plan::output::Output;
use crate::plan::reduction::Reduction;
use crate::plan::steps::ShaftStep;

/// The number of running results that are computed in parallel.
const LANES: usize = 16;

impl Reduction {
    /// The initial value for a row.
    pub(crate) fn start(self) -> DoubleDouble {
        DoubleDouble::exact(match self {
            Self::Min => f64::INFINITY,
            Self::Max => f64::NEG_INFINITY,
            Self::Mean | Self::Rms | Self::Peak => 0.0,
        })
    }

    /// Includes the first `length` numbers of a plane, or of the three planes of a vector.
    #[inline(always)]
    pub(crate) fn take<W: Float>(
        self,
        partial: &mut DoubleDouble,
        planes: &[Vec<W>],
        length: usize,
    ) {
        let words = |plane: usize| &planes[plane][..length];
        let first = words(0);
        let one = |i: usize| -> f64 { first[i].into() };
        match self {
            Self::Min => {
                let value = fold(length, f64::INFINITY, one, smaller);
                partial.high = smaller(partial.high, value);
            }
            Self::Max => {
                let value = fold(length, f64::NEG_INFINITY, one, larger);
                partial.high = larger(partial.high, value);
            }
            Self::Peak => {
                let value = if planes.len() == 3 {
                    let (y, z) = (words(1), words(2));
                    let square = |i: usize| {
                        let [x, y, z]: [f64; 3] = [first[i].into(), y[i].into(), z[i].into()];
                        x.mul_add(x, y.mul_add(y, z * z))
                    };
                    fold(length, 0.0, square, larger).sqrt()
                } else {
                    fold(length, 0.0, |i| one(i).abs(), larger)
                };
                partial.high = larger(partial.high, value);
            }
            Self::Mean => *partial = *partial + DoubleDouble::exact(fold(length, 0.0, one, plus)),
            Self::Rms => {
                let square = |i: usize| one(i) * one(i);
                *partial = *partial + DoubleDouble::exact(fold(length, 0.0, square, plus));
            }
        }
    }

    /// The partial result after repeating its samples `times` times.
    pub(crate) fn repeat(self, partial: &mut DoubleDouble, times: usize) {
        if !self.is_extreme() {
            *partial = *partial * DoubleDouble::exact(times as f64);
        }
    }

    /// The result for a row of `length` samples, from the partial results of its parts.
    pub(crate) fn finish(self, parts: impl Iterator<Item = DoubleDouble>, length: usize) -> f64 {
        let count = length as f64;
        match self {
            Self::Min => parts.fold(f64::INFINITY, |least, part| smaller(least, part.high)),
            Self::Max => parts.fold(f64::NEG_INFINITY, |most, part| larger(most, part.high)),
            Self::Peak => parts.fold(0.0, |most, part| larger(most, part.high)),
            Self::Mean => {
                parts.fold(DoubleDouble::default(), |sum, part| sum + part).value() / count
            }
            Self::Rms => {
                let sum = parts.fold(DoubleDouble::default(), |sum, part| sum + part).value();
                (sum / count).sqrt()
            }
        }
    }
}

#[inline(always)]
fn plus(a: f64, b: f64) -> f64 {
    a + b
}

/// The smaller number; NaN if either is NaN.
#[inline(always)]
fn smaller(a: f64, b: f64) -> f64 {
    if b < a || b.is_nan() { b } else { a }
}

/// The larger number; NaN if either is NaN.
#[inline(always)]
fn larger(a: f64, b: f64) -> f64 {
    if b > a || b.is_nan() { b } else { a }
}

/// Folds numbers in a number of lanes that vectors of every width divide, so that sums have the
/// same bits for each.
#[inline(always)]
fn fold(
    length: usize,
    start: f64,
    number: impl Fn(usize) -> f64,
    join: impl Fn(f64, f64) -> f64,
) -> f64 {
    let mut lanes = [start; LANES];
    let whole = length - length % LANES;
    for first in (0..whole).step_by(LANES) {
        for (lane, running) in lanes.iter_mut().enumerate() {
            *running = join(*running, number(first + lane));
        }
    }
    let rest = (whole..length).fold(start, |running, i| join(running, number(i)));
    lanes.into_iter().fold(rest, join)
}

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
