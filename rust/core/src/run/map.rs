//! The loops over a chunk, in two shapes, and the computations in them.
//!
//! Each shape is a plain branch-free loop over the samples, which the compiler vectorises for the
//! instruction set of its caller. Where results bypass the caches, they leave by strips: a loop with
//! a constant count stores them in local arrays, which the compiler keeps in vector registers until
//! the sink stores whole cache lines.
//!
//! All loops are inlined into the functions that [`crate::run::block`] calls for an instruction set.
//! The slices fit in the first-level cache, so one loop per output costs no more than one loop for
//! all, and each can be skipped.
//!
//! `at` gives the constants: one value for the whole chunk, or one per sample. All slices of a loop
//! are first cut to one length, and the loop counts instead of iterating. A remaining bounds check
//! costs more than itself, because the last vectors of every chunk would then be computed one number
//! at a time. Closures are marked `#[inline(always)]`: a closure compiled separately would not use
//! the instruction set of its loop.
#![allow(clippy::needless_range_loop, reason = "an iterator hides that its count is constant")]

use crate::mechanics::moment::{self, Pose};
use crate::number::Number;
use crate::number::atan::AtanRange;
use crate::number::double_double::DoubleDouble;
use crate::number::float::{Float, Real};
use crate::number::storage::{View, ViewMut};
use crate::number::strips::{At, Same, Strips};
use crate::run::formula::MotionFormula;
use crate::run::sink::{PlainSink, STRIP, Sink, SinkStrip};
use crate::sincos::array::{DriveAngles, SinCosBlock, SinCosBlocks, sample_number};

/// A value for each sample, from its inputs, sine and cosine.
#[inline(always)]
pub(crate) fn over_sin_cos<T: Real, S: SinCosBlocks<T>, I: Strips, V>(
    sin_cos: S,
    inputs: I,
    mut out: impl Sink<V>,
    value: impl Fn(I::Value, T, T) -> V,
) {
    for (start, block) in sin_cos.parts() {
        let length = block.len();
        // The groups of a sweep begin anywhere.
        let by_strips = !S::FROM_SWEEP && !I::ONE_BY_ONE && out.takes_strips();
        let strips = if by_strips { length / STRIP } else { 0 };
        for strip in 0..strips {
            let first = strip * STRIP;
            let (block, inputs) = (block.part(first, STRIP), inputs.strip(first, STRIP));
            let mut results = out.strip(first);
            if S::FRESH {
                block.ask(0, STRIP);
            } else {
                out.request_angles(first);
            }
            for i in 0..STRIP {
                let (s, c) = block.get(i);
                results.set(i, value(inputs.at(i), s, c));
            }
            out.put(first, &results);
        }
        let (first, length) = (strips * STRIP, length - strips * STRIP);
        if length > 0 {
            let block = block.part(first, length);
            let inputs = inputs.strip(start + first, length);
            let mut out = out.plain(start + first, length);
            for i in 0..length {
                let (s, c) = block.get(i);
                out.store(i, value(inputs.at(i), s, c));
            }
        }
    }
}

/// The value of a formula for each sample.
#[inline(always)]
pub(crate) fn formula<T: Real, C: Strips, V>(
    formula: impl Fn(&C::Value, T, T) -> V,
    at: C,
    sin_cos: impl SinCosBlocks<T>,
    out: impl Sink<V>,
) {
    over_sin_cos(
        sin_cos,
        at,
        out,
        #[inline(always)]
        |constants, s, c| formula(&constants, s, c),
    );
}

/// The same of a formula that needs a number of the sample as well.
#[inline(always)]
pub(crate) fn formula_of<T: Real, C: Strips, V>(
    formula: impl Fn(&C::Value, T, T, T) -> V,
    at: C,
    numbers: View<'_, T>,
    sin_cos: impl SinCosBlocks<T>,
    out: impl Sink<V>,
) {
    over_sin_cos(
        sin_cos,
        (at, numbers),
        out,
        #[inline(always)]
        |(constants, number), s, c| formula(&constants, number, s, c),
    );
}

/// A value for each sample, from its inputs.
#[inline(always)]
pub(crate) fn over_samples<I: Strips, V>(
    length: usize,
    inputs: I,
    mut out: impl Sink<V>,
    value: impl Fn(I::Value) -> V,
) {
    let by_strips = !I::ONE_BY_ONE && out.takes_strips();
    let strips = if by_strips { length / STRIP } else { 0 };
    for strip in 0..strips {
        let first = strip * STRIP;
        let (inputs, mut results) = (inputs.strip(first, STRIP), out.strip(first));
        out.request_angles(first);
        for i in 0..STRIP {
            results.set(i, value(inputs.at(i)));
        }
        out.put(first, &results);
    }
    let (first, length) = (strips * STRIP, length - strips * STRIP);
    if length > 0 {
        let inputs = inputs.strip(first, length);
        let mut out = out.plain(first, length);
        for i in 0..length {
            out.store(i, value(inputs.at(i)));
        }
    }
}

/// Replaces each number of a column.
#[inline(always)]
fn update<T: Real, I: Strips>(column: ViewMut<'_, T>, inputs: I, value: impl Fn(I::Value, T) -> T) {
    let length = column.len();
    let (mut column, inputs) = (column.cut(length), inputs.strip(0, length));
    for i in 0..length {
        column.set(i, value(inputs.at(i), column.get(i)));
    }
}

/// Angle error of a shaft whose tangent stays within `range`.
#[inline(always)]
pub(crate) fn angle_error<T: Number, C: Strips<Value: MotionFormula<T>>>(
    range: AtanRange,
    at: C,
    sin_cos: impl SinCosBlocks<T>,
    out: impl Sink<T>,
) {
    macro_rules! by {
        ($tangent:ident, |$y:ident, $x:ident| $atan:expr) => {
            over_sin_cos(
                sin_cos,
                at,
                out,
                #[inline(always)]
                |constants, s, c| {
                    let ($y, $x) = constants.$tangent(s, c);
                    $atan
                },
            )
        };
    }
    if C::Value::MODERATE && range.is_moderate() {
        match range {
            AtanRange::Hundredth => by!(error_tangent, |y, x| (y / x).atan_hundredth()),
            AtanRange::Tenth => by!(error_tangent, |y, x| (y / x).atan_tenth()),
            _ => by!(error_tangent, |y, x| (y / x).atan_third()),
        }
    } else if C::Value::STEEP {
        match range {
            // In double-double arithmetic the infinite inverse exsecant of a straight joint would
            // give NaN.
            AtanRange::Any if T::LOW => by!(error_tangent, |y, x| T::atan_any(y, x)),
            AtanRange::Any => by!(steep_error_tangent, |y, x| T::atan_any(y, x)),
            _ => by!(error_tangent, |y, x| T::atan_one(y, x)),
        }
    }
}

/// Angle or angle error, speed ratio and acceleration ratio in one loop, for moderate bends.
/// Steeper bends use separate formulas with fewer roundings.
#[inline(always)]
pub(crate) fn motion<T: Number, C: Strips<Value: MotionFormula<T>>>(
    range: AtanRange,
    at: C,
    sin_cos: impl SinCosBlocks<T>,
    rotations: impl Sink<T>,
    rates: (impl Sink<T>, impl Sink<T>),
) {
    macro_rules! by {
        ($atan:expr) => {
            over_sin_cos(
                sin_cos,
                at,
                (rotations, rates),
                #[inline(always)]
                |constants, s, c| {
                    let (tangent, rates) = constants.motion(s, c);
                    ($atan(tangent), rates)
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
        column,
        out,
        #[inline(always)]
        |number| number,
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
    update(
        power,
        (inertia, speed, acceleration, ratio, acceleration_ratio),
        #[inline(always)]
        |(inertia, speed, acceleration, r, a), power| {
            let inertia = T::from_f64(sign * inertia);
            let (speed, acceleration) = (T::from_f64(speed), T::from_f64(acceleration));
            power + moment::absorbed_power(inertia, speed, acceleration, r, a)
        },
    );
}

/// `a / b`, element by element.
#[inline(always)]
pub(crate) fn divide<T: Real>(a: View<'_, T>, b: View<'_, T>, out: impl Sink<T>) {
    over_samples(
        a.len(),
        (a, b),
        out,
        #[inline(always)]
        |(a, b)| a / b,
    );
}

/// A column of doubles, multiplied by another column if there is one.
#[inline(always)]
pub(crate) fn from_doubles<T: Real>(a: &[f64], b: Option<View<'_, T>>, out: ViewMut<'_, T>) {
    match b {
        Some(b) => over_samples(
            a.len(),
            (a, b),
            out,
            #[inline(always)]
            |(a, b)| T::from_f64(a) * b,
        ),
        None => over_samples(
            a.len(),
            a,
            out,
            #[inline(always)]
            |a| T::from_f64(a),
        ),
    }
}

/// The moment vector that a joint transmits.
#[inline(always)]
pub(crate) fn moment<const PLANAR: bool, T: Real>(
    at: impl Strips<Value = Pose<T>>,
    pins: impl SinCosBlocks<T>,
    torsion: impl Strips<Value = T>,
    out: [impl Sink<T>; 3],
) {
    over_sin_cos(
        pins,
        (at, torsion),
        out,
        #[inline(always)]
        |(pose, torsion), s, c| pose.moment::<PLANAR>(torsion, s, c),
    );
}

/// The same of the joint that the drive turns, from its reduced angles and one torque.
#[inline(always)]
pub(crate) fn drive_moment<const PLANAR: bool, T: Number>(
    pose: Pose<T>,
    torque: T,
    (angles, length): (impl Strips<Value = (T, u64)>, usize),
    out: [impl Sink<T>; 3],
) {
    over_samples(
        length,
        (Same((pose, torque)), angles),
        out,
        #[inline(always)]
        |((pose, torque), reduced)| {
            pose.of_parts::<PLANAR>(torque, moment::parts_of_reduced(reduced))
        },
    );
}

/// The same in axes that turn with the driven shaft.
#[inline(always)]
pub(crate) fn turning_moment<T: Real>(
    at: impl Strips<Value = Pose<T>>,
    pins: impl SinCosBlocks<T>,
    torsion: View<'_, T>,
    out: [impl Sink<T>; 3],
) {
    over_sin_cos(
        pins,
        (at, torsion),
        out,
        #[inline(always)]
        |(pose, torsion), s, c| pose.turning_moment(torsion, s, c),
    );
}

/// A joint's contribution to a component of the support moment of one of its shafts, added to
/// `previous` if there is one.
#[inline(always)]
pub(crate) fn support<const PLANAR: bool, const COMPONENT: usize, T: Real>(
    at: impl Strips<Value = Pose<T>>,
    driving: bool,
    [square, product]: [View<'_, T>; 2],
    previous: impl Strips<Value = Option<T>>,
    out: impl Sink<T>,
) {
    over_samples(
        square.len(),
        (at, (square, product), previous),
        out,
        #[inline(always)]
        |(pose, (square, product), previous)| {
            pose.support::<PLANAR, COMPONENT>(driving, [square, product], previous)
        },
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
        DriveAngles::Sums(angle, rest) => {
            let (angle, rest) = (&angle[..length], &rest[..length]);
            fill(
                out,
                #[inline(always)]
                |i| error(i).after(DoubleDouble::new(angle[i].mul_add(0.0, angle[i]), rest[i])),
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
        DriveAngles::Array(angle) | DriveAngles::Sums(angle, _) => over_samples(
            length,
            angle,
            out,
            #[inline(always)]
            |angle| T::from_f64(angle.mul_add(0.0, value)),
        ),
        DriveAngles::Sweep(..) | DriveAngles::Selected(..) => over_samples(
            length,
            Same(T::from_f64(value)),
            out,
            #[inline(always)]
            |value| value,
        ),
    }
}
