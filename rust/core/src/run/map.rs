//! The loops over a chunk, in three shapes, and the computations in them.
//!
//! Each shape is a plain branch-free loop over the samples, which the compiler vectorises for the
//! instruction set of its caller. All loops are inlined into the functions that
//! [`crate::run::block`] calls for an instruction set. The slices fit in the first-level cache, so
//! one loop per output costs no more than one loop for all, and each can be skipped.
//!
//! `at(i)` returns the constants: one value for the whole chunk, or one per sample.
//!
//! All slices of a loop are first cut to one length, and the loop counts instead of iterating. A
//! remaining bounds check costs more than itself, because the last vectors of every chunk would
//! then be computed one number at a time. Closures are marked `#[inline(always)]`: a closure
//! compiled separately would not use the instruction set of its loop.
#![allow(clippy::needless_range_loop, reason = "an iterator hides that its count is in range")]

use crate::mechanics::moment::{self, Pose, TorsionParts};
use crate::number::Number;
use crate::number::atan::AtanRange;
use crate::number::double_double::DoubleDouble;
use crate::number::float::{Float, Real};
use crate::number::storage::{View, ViewMut};
use crate::run::formula::MotionFormula;
use crate::run::sink::Sink;
use crate::sincos::array::{DriveAngles, SinCos, SinCosBlock, SinCosBlocks, sample_number};

/// A value for each sample, from its index, sine and cosine.
#[inline(always)]
pub(crate) fn over_sin_cos<T: Real, V>(
    sin_cos: impl SinCosBlocks<T>,
    mut out: impl Sink<V>,
    value: impl Fn(usize, T, T) -> V,
) {
    for (start, block) in sin_cos.parts() {
        let length = block.len();
        let mut out = out.slice(start, length);
        for i in 0..length {
            let (s, c) = block.get(i);
            out.store(i, value(start + i, s, c));
        }
    }
}

/// The value of a formula for each sample.
#[inline(always)]
pub(crate) fn formula<T: Real, C, V>(
    formula: impl Fn(&C, T, T) -> V,
    at: impl Fn(usize) -> C,
    sin_cos: impl SinCosBlocks<T>,
    out: impl Sink<V>,
) {
    over_sin_cos(
        sin_cos,
        out,
        #[inline(always)]
        |i, s, c| formula(&at(i), s, c),
    );
}

/// A value for each sample, from its index.
#[inline(always)]
pub(crate) fn over_samples<V>(length: usize, mut out: impl Sink<V>, value: impl Fn(usize) -> V) {
    let mut out = out.slice(0, length);
    for i in 0..length {
        out.store(i, value(i));
    }
}

/// Replaces each number of a column.
#[inline(always)]
fn update<T: Real>(column: ViewMut<'_, T>, value: impl Fn(usize, T) -> T) {
    let length = column.len();
    let mut column = column.cut(length);
    for i in 0..length {
        column.set(i, value(i, column.get(i)));
    }
}

/// Angle error of a shaft whose tangent stays within `range`.
#[inline(always)]
pub(crate) fn angle_error<T: Number, S: MotionFormula<T>>(
    range: AtanRange,
    at: impl Fn(usize) -> S,
    sin_cos: impl SinCosBlocks<T>,
    out: impl Sink<T>,
) {
    macro_rules! by {
        ($tangent:expr, $atan:expr) => {
            over_sin_cos(
                sin_cos,
                out,
                #[inline(always)]
                |i, s, c| {
                    let (y, x) = $tangent(&at(i), s, c);
                    $atan(y, x)
                },
            )
        };
    }
    if S::MODERATE && range.is_moderate() {
        match range {
            AtanRange::Hundredth => by!(S::error_tangent, T::atan_hundredth),
            AtanRange::Tenth => by!(S::error_tangent, T::atan_tenth),
            _ => by!(S::error_tangent, T::atan_third),
        }
    } else if S::STEEP {
        match range {
            // In double-double arithmetic the infinite inverse exsecant of a straight joint would
            // give NaN.
            AtanRange::Any if T::LOW => by!(S::error_tangent, T::atan_any),
            AtanRange::Any => by!(S::steep_error_tangent, T::atan_any),
            _ => by!(S::error_tangent, T::atan_one),
        }
    }
}

/// Angle or angle error, speed ratio and acceleration ratio in one loop, for moderate bends.
/// Steeper bends use separate formulas with fewer roundings.
#[inline(always)]
pub(crate) fn motion<T: Number, S: MotionFormula<T>>(
    range: AtanRange,
    at: impl Fn(usize) -> S,
    sin_cos: impl SinCosBlocks<T>,
    rotations: impl Sink<T>,
    rates: (impl Sink<T>, impl Sink<T>),
) {
    macro_rules! by {
        ($atan:expr) => {
            over_sin_cos(
                sin_cos,
                (rotations, rates),
                #[inline(always)]
                |i, s, c| {
                    let ((y, x), rates) = at(i).motion(s, c);
                    ($atan(y, x), rates)
                },
            )
        };
    }
    match range {
        AtanRange::Hundredth => by!(T::atan_hundredth),
        AtanRange::Tenth => by!(T::atan_tenth),
        _ => by!(T::atan_third),
    }
}

/// Copies a column.
#[inline(always)]
pub(crate) fn copy<T: Real>(column: View<'_, T>, out: impl Sink<T>) {
    over_samples(
        column.len(),
        out,
        #[inline(always)]
        |i| column.get(i),
    );
}

/// Adds the power that a shaft's inertia absorbs, multiplied by `sign`, to the running power.
#[inline(always)]
pub(crate) fn absorb<T: Real>(
    sign: f64,
    [inertia, speed, acceleration]: [&[f64]; 3],
    ratio: View<'_, T>,
    acceleration_ratio: View<'_, T>,
    power: ViewMut<'_, T>,
) {
    let length = power.len();
    let (ratio, acceleration_ratio) = (ratio.cut(length), acceleration_ratio.cut(length));
    let (inertia, speed) = (&inertia[..length], &speed[..length]);
    let acceleration = &acceleration[..length];
    update(
        power,
        #[inline(always)]
        |i, power| {
            let inertia = T::from_f64(sign * inertia[i]);
            let (speed, acceleration) = (T::from_f64(speed[i]), T::from_f64(acceleration[i]));
            let (r, a) = (ratio.get(i), acceleration_ratio.get(i));
            power + moment::absorbed_power(inertia, speed, acceleration, r, a)
        },
    );
}

/// `a / b`, element by element.
#[inline(always)]
pub(crate) fn divide<T: Real>(a: View<'_, T>, b: View<'_, T>, out: impl Sink<T>) {
    let b = b.cut(a.len());
    over_samples(
        a.len(),
        out,
        #[inline(always)]
        |i| a.get(i) / b.get(i),
    );
}

/// A column of doubles, multiplied by another column if there is one.
#[inline(always)]
pub(crate) fn from_doubles<T: Real>(a: &[f64], b: Option<View<'_, T>>, out: ViewMut<'_, T>) {
    match b {
        Some(b) => {
            let b = b.cut(a.len());
            over_samples(
                a.len(),
                out,
                #[inline(always)]
                |i| T::from_f64(a[i]) * b.get(i),
            );
        }
        None => over_samples(
            a.len(),
            out,
            #[inline(always)]
            |i| T::from_f64(a[i]),
        ),
    }
}

/// A joint's torsion multiplied by the squares and the product of its pin's sine and cosine.
#[inline(always)]
pub(crate) fn parts<T: Real>(
    at: impl Fn(usize) -> Pose<T>,
    pins: SinCos<'_, T>,
    torsion: View<'_, T>,
    parts: [ViewMut<'_, T>; 3],
) {
    let torsion = torsion.cut(pins.len());
    over_sin_cos(
        pins,
        parts,
        #[inline(always)]
        |i, s, c| {
            let TorsionParts { sine2, cosine2, product } = at(i).parts(torsion.get(i), s, c);
            [sine2, cosine2, product]
        },
    );
}

/// The moment vector that a joint transmits.
#[inline(always)]
pub(crate) fn moment<const PLANAR: bool, T: Real>(
    at: impl Fn(usize) -> Pose<T>,
    pins: SinCos<'_, T>,
    torsion: View<'_, T>,
    out: [impl Sink<T>; 3],
) {
    let torsion = torsion.cut(pins.len());
    over_sin_cos(
        pins,
        out,
        #[inline(always)]
        |i, s, c| at(i).moment::<PLANAR>(torsion.get(i), s, c),
    );
}

/// A joint's contribution to a component of the support moment of one of its shafts, added to
/// `previous`.
#[inline(always)]
pub(crate) fn support<const PLANAR: bool, const COMPONENT: usize, T: Real>(
    at: impl Fn(usize) -> Pose<T>,
    driving: bool,
    [square, product]: [View<'_, T>; 2],
    previous: impl Fn(usize) -> Option<T>,
    out: impl Sink<T>,
) {
    let product = product.cut(square.len());
    over_samples(
        square.len(),
        out,
        #[inline(always)]
        |i| {
            let numbers = [square.get(i), product.get(i)];
            at(i).support::<PLANAR, COMPONENT>(driving, numbers, previous(i))
        },
    );
}

/// A scalar per sample, from the pose and the torsion.
#[inline(always)]
pub(crate) fn magnitude<T: Real>(
    at: impl Fn(usize) -> Pose<T>,
    formula: impl Fn(&Pose<T>, T, T, T) -> T,
    pins: SinCos<'_, T>,
    torsion: View<'_, T>,
    out: impl Sink<T>,
) {
    let torsion = torsion.cut(pins.len());
    over_sin_cos(
        pins,
        out,
        #[inline(always)]
        |i, s, c| formula(&at(i), torsion.get(i), s, c),
    );
}

/// Fills a slice from the indices of its words.
#[inline(always)]
fn fill<W>(out: &mut [W], word: impl Fn(usize) -> W) {
    for i in 0..out.len() {
        out[i] = word(i);
    }
}

/// The drive angle plus an angle error; NaN where the drive angle is not finite.
#[inline(always)]
fn add_drive_to<T: Number, W: Float>(
    drive: DriveAngles<'_>,
    error: impl Fn(usize) -> T,
    out: &mut [W],
) {
    let length = out.len();
    match drive {
        DriveAngles::Array(angle) => {
            let angle = &angle[..length];
            fill(
                out,
                #[inline(always)]
                |i| error(i).after(DoubleDouble::exact(angle[i].mul_add(0.0, angle[i]))),
            );
        }
        DriveAngles::Sweep(sweep, first) if sweep.starts_at_zero() => fill(
            out,
            #[inline(always)]
            |i| error(i).after(sweep.turn_after(sample_number(first, i))),
        ),
        DriveAngles::Sweep(sweep, first) => fill(
            out,
            #[inline(always)]
            |i| error(i).after(sweep.angle(sample_number(first, i))),
        ),
        DriveAngles::Selected(sweep, samples) => {
            let samples = &samples[..length];
            fill(
                out,
                #[inline(always)]
                |i| error(i).after(sweep.angle(samples[i])),
            );
        }
    }
}

/// The drive angle plus a column of angle errors.
#[inline(always)]
pub(crate) fn add_drive<T: Number, W: Float>(
    drive: DriveAngles<'_>,
    errors: View<'_, T>,
    out: &mut [W],
) {
    let errors = errors.cut(out.len());
    add_drive_to(
        drive,
        #[inline(always)]
        |i| errors.get(i),
        out,
    );
}

/// The angle of a shaft that turns with the drive.
#[inline(always)]
pub(crate) fn drive_angle<T: Number, W: Float>(drive: DriveAngles<'_>, out: &mut [W]) {
    let zero = T::from_f64(0.0);
    add_drive_to(
        drive,
        #[inline(always)]
        |_| zero,
        out,
    );
}

/// A constant; NaN where the angle is not finite.
#[inline(always)]
pub(crate) fn constant<T: Number>(value: f64, drive: DriveAngles<'_>, out: impl Sink<T>) {
    let length = out.length();
    match drive {
        DriveAngles::Array(angle) => {
            let angle = &angle[..length];
            over_samples(
                length,
                out,
                #[inline(always)]
                |i| T::from_f64(angle[i].mul_add(0.0, value)),
            );
        }
        DriveAngles::Sweep(..) | DriveAngles::Selected(..) => over_samples(
            length,
            out,
            #[inline(always)]
            |_| T::from_f64(value),
        ),
    }
}
