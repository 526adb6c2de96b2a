//! The pins of a chunk: sines and cosines of its drive angles, by the reduction that serves them.
#![allow(clippy::needless_range_loop, reason = "an iterator hides that its count is in range")]

use std::iter::once;

use crate::input::sweep::{AngleReduction, Sweep};
use crate::number::double_double::DoubleDouble;
use crate::number::float::Real;
use crate::number::reduction::{self, LargeAngleFlag};
use crate::number::storage::{View, ViewMut};
use crate::number::trig::{self, Angle};

/// The drive angles of a chunk.
#[derive(Clone, Copy)]
pub(crate) enum Drive<'a> {
    /// Doubles.
    Array(&'a [f64]),
    /// Those of a sweep from this sample on.
    Sweep(&'a Sweep, usize),
    /// Those of a sweep at these samples.
    Picked(&'a Sweep, &'a [f64]),
}

/// The number of a sweep's sample as a double: a sum, because few machines convert long integers
/// in vectors.
#[inline(always)]
pub(crate) fn number(first: usize, i: usize) -> f64 {
    first as f64 + f64::from(i as u32)
}

/// Sines and cosines of a chunk: of the drive angle, up to a common factor, or of twice the angle.
#[derive(Clone, Copy)]
pub(crate) struct SinCos<'a, T: Real> {
    pub(crate) sine: View<'a, T>,
    pub(crate) cosine: View<'a, T>,
}

impl<T: Real> SinCos<'_, T> {
    #[inline(always)]
    pub(crate) fn len(&self) -> usize {
        self.sine.len()
    }

    #[inline(always)]
    pub(crate) fn get(&self, i: usize) -> (T, T) {
        (self.sine.get(i), self.cosine.get(i))
    }
}

/// Where a loop takes sines and cosines from: from parts of the chunk, one after the other.
pub(crate) trait SinCosBlocks<T>: Copy {
    type SinCosBlock: SinCosBlock<T>;

    /// Whether they are those of a sweep by groups of samples.
    const SWEPT: bool = false;

    /// The turns of whole steps of such a sweep, as many as a part may take.
    fn turns(&self) -> View<'_, DoubleDouble> {
        View::EMPTY
    }

    /// Each part and the sample that it begins with.
    fn parts(self) -> impl Iterator<Item = (usize, Self::SinCosBlock)>;
}

/// Sines and cosines of samples side by side.
pub(crate) trait SinCosBlock<T> {
    fn len(&self) -> usize;

    fn get(&self, i: usize) -> (T, T);
}

impl<T: Real> SinCosBlocks<T> for SinCos<'_, T> {
    type SinCosBlock = Self;

    #[inline(always)]
    fn parts(self) -> impl Iterator<Item = (usize, Self)> {
        once((0, self))
    }
}

impl<T: Real> SinCosBlock<T> for SinCos<'_, T> {
    #[inline(always)]
    fn len(&self) -> usize {
        self.len()
    }

    #[inline(always)]
    fn get(&self, i: usize) -> (T, T) {
        self.get(i)
    }
}

/// Which sines and cosines to find.
pub(crate) trait SinCosKind {
    /// Whether they are of twice the drive angle.
    const TWICE: bool = false;

    /// Sine and cosine of a reduced angle.
    fn find<T: Angle>(reduced: (T, u64)) -> (T, T);
}

/// Pins as lines: a common factor of sine and cosine does not matter.
pub(crate) struct Line;

impl SinCosKind for Line {
    #[inline(always)]
    fn find<T: Angle>(reduced: (T, u64)) -> (T, T) {
        trig::pin(reduced)
    }
}

/// Pins with their sense: a positive factor does not matter.
pub(crate) struct Sense;

impl SinCosKind for Sense {
    #[inline(always)]
    fn find<T: Angle>(reduced: (T, u64)) -> (T, T) {
        trig::sensed_pin(reduced)
    }
}

/// Sine and cosine themselves, of twice the angle.
pub(crate) struct Twice;

impl SinCosKind for Twice {
    const TWICE: bool = true;

    #[inline(always)]
    fn find<T: Angle>(reduced: (T, u64)) -> (T, T) {
        trig::turned(reduced)
    }
}

/// Sine and cosine for each angle, by the exact path where one is too far for the fast one.
///
/// `coarse` pins are as good as short numbers are beside 1, not relative to themselves: they do for
/// moderate bends.
#[inline(always)]
pub(crate) fn find<K: SinCosKind, T: Angle>(
    drive: Drive<'_>,
    coarse: bool,
    sine: ViewMut<'_, T>,
    cosine: ViewMut<'_, T>,
) {
    let length = sine.len();
    let (mut sine, mut cosine) = (sine.cut(length), cosine.cut(length));
    match drive {
        Drive::Array(angle) => {
            let angle = &angle[..length];
            if T::PRECISION.costs().turn_fractions
                && coarse
                && coarse_sin_cos::<K, T>(angle, sine.again(), cosine.again())
            {
                return;
            }
            let mut far = LargeAngleFlag::for_quadrants();
            for i in 0..length {
                let x = angle[i];
                let reduced = T::reduce(if K::TWICE { x + x } else { x });
                far.accumulate(reduced.1);
                set_reduced::<K, T>(&mut sine, &mut cosine, i, reduced);
            }
            if far.any() {
                for i in 0..length {
                    let reduced = reduction::reduce_any(angle[i]);
                    let (r, quadrant) = if K::TWICE { reduction::twice(reduced) } else { reduced };
                    set_reduced::<K, T>(
                        &mut sine,
                        &mut cosine,
                        i,
                        (T::from_double_double(r), quadrant),
                    );
                }
            }
        }
        Drive::Sweep(sweep, first) => {
            let sweep = if K::TWICE { sweep.twice() } else { *sweep };
            match sweep.reduction() {
                AngleReduction::OfTurns { per_turn, inverse, quarter } => {
                    for i in 0..length {
                        let i_th = number(first, i);
                        let (r, quadrant) =
                            AngleReduction::of_turns(per_turn, inverse, quarter, i_th);
                        let reduced = (T::from_double_double(r), quadrant);
                        set_reduced::<K, T>(&mut sine, &mut cosine, i, reduced);
                    }
                }
                AngleReduction::OfAngles(sweep) => {
                    for i in 0..length {
                        let (r, quadrant) = AngleReduction::of_angles(&sweep, number(first, i));
                        let reduced = (T::from_double_double(r), quadrant);
                        set_reduced::<K, T>(&mut sine, &mut cosine, i, reduced);
                    }
                }
            }
        }
        Drive::Picked(sweep, samples) => {
            let reduction = if K::TWICE { sweep.twice() } else { *sweep }.reduction();
            let samples = &samples[..length];
            for i in 0..length {
                let (r, quadrant) = reduction.of(samples[i]);
                set_reduced::<K, T>(
                    &mut sine,
                    &mut cosine,
                    i,
                    (T::from_double_double(r), quadrant),
                );
            }
        }
    }
    if T::PRECISION.costs().separate_reduction {
        for i in 0..length {
            let reduced = (sine.get(i), cosine.get_high(i).bits());
            set_pin::<K, T>(&mut sine, &mut cosine, i, reduced);
        }
    }
}

/// Sine and cosine by phases, unless an angle is too far for these.
#[inline(always)]
fn coarse_sin_cos<K: SinCosKind, T: Angle>(
    angle: &[f64],
    sine: ViewMut<'_, T>,
    cosine: ViewMut<'_, T>,
) -> bool {
    let length = angle.len();
    let (mut sine, mut cosine) = (sine.cut(length), cosine.cut(length));
    let mut far = LargeAngleFlag::for_turn_fractions();
    for i in 0..length {
        let phase = reduction::turn_fraction_q30(angle[i]);
        far.accumulate(phase);
        cosine.set_high(i, T::of_bits(phase));
    }
    if far.any() {
        return false;
    }
    for i in 0..length {
        let reduced = T::from_turn_fraction(cosine.get_high(i).bits());
        set_pin::<K, T>(&mut sine, &mut cosine, i, reduced);
    }
    true
}

/// Angles are reduced as doubles, of which a vector holds half as many as of short numbers: those
/// find their pins in a loop of their own.
#[inline(always)]
fn set_reduced<K: SinCosKind, T: Angle>(
    sine: &mut ViewMut<'_, T>,
    cosine: &mut ViewMut<'_, T>,
    i: usize,
    (remainder, quadrant): (T, u64),
) {
    if T::PRECISION.costs().separate_reduction {
        sine.set(i, remainder);
        cosine.set_high(i, T::of_bits(quadrant));
    } else {
        set_pin::<K, T>(sine, cosine, i, (remainder, quadrant));
    }
}

#[inline(always)]
fn set_pin<K: SinCosKind, T: Angle>(
    sine: &mut ViewMut<'_, T>,
    cosine: &mut ViewMut<'_, T>,
    i: usize,
    reduced: (T, u64),
) {
    let (s, c) = K::find(reduced);
    sine.set(i, s);
    cosine.set(i, c);
}

/// Sine and cosine of the equivalent joint's driving angle `α + φ`, given those of `φ`.
#[inline(always)]
pub(crate) fn turn<T: Real>(
    at: impl Fn(usize) -> [T; 2],
    pins: SinCos<'_, T>,
    sine: ViewMut<'_, T>,
    cosine: ViewMut<'_, T>,
) {
    let length = pins.len();
    let (mut sine, mut cosine) = (sine.cut(length), cosine.cut(length));
    for i in 0..length {
        let (s, c) = pins.get(i);
        let [turn_cos, turn_sin] = at(i);
        sine.set(i, s.mul_add(turn_cos, c * turn_sin));
        cosine.set(i, c.mul_add(turn_cos, -(s * turn_sin)));
    }
}
