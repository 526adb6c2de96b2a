//! Loops over slices, one per output.
//!
//! Each is a plain loop without branches over one sample after the other, which the compiler
//! vectorises for whichever instruction set the caller was compiled for; all are inlined into the
//! functions that [`crate::run::block`] calls for the instruction set. The slices are a chunk of the angles, small enough
//! for the first-level cache, so a loop per output costs no more than one loop for all and keeps
//! each skippable.
//!
//! Constants come through `at(i)`: one value for the whole chunk, or one per sample.
//!
//! Whatever a loop touches is first cut to one length, and it counts instead of iterating: a check
//! that is left in it costs more than itself, because the last vectors of every chunk would then be
//! computed number by number.
#![allow(clippy::needless_range_loop, reason = "an iterator hides that its count is in range")]

use crate::mechanics::joint;
use crate::mechanics::moment::{self, Pose, TorsionParts};
use crate::mechanics::transmission::Ideal;
use crate::number::Number;
use crate::number::atan::AtanRange;
use crate::number::double_double::DoubleDouble;
use crate::number::float::{Float, Real};
use crate::number::storage::{View, ViewMut};
use crate::number::trig::Angle;
use crate::run::sink::Sink;
use crate::sincos::array::{Drive, SinCos, SinCosBlock, SinCosBlocks, number};

/// The drive angle plus an angle error.
#[inline(always)]
pub(crate) fn add_drive<T: Number, W: Float>(drive: Drive<'_>, errors: View<'_, T>, out: &mut [W]) {
    let errors = errors.cut(out.len());
    add_drive_to(drive, |i| errors.get(i), out);
}

#[inline(always)]
fn add_drive_to<T: Number, W: Float>(drive: Drive<'_>, error: impl Fn(usize) -> T, out: &mut [W]) {
    let length = out.len();
    match drive {
        Drive::Array(angle) => {
            let angle = &angle[..length];
            for i in 0..length {
                // Not the bare angle: an infinite one is none.
                out[i] = error(i).after(DoubleDouble::exact(angle[i].mul_add(0.0, angle[i])));
            }
        }
        Drive::Sweep(sweep, first) if sweep.starts_at_zero() => {
            for i in 0..length {
                out[i] = error(i).after(sweep.turned(number(first, i)));
            }
        }
        Drive::Sweep(sweep, first) => {
            for i in 0..length {
                out[i] = error(i).after(sweep.angle(number(first, i)));
            }
        }
        Drive::Picked(sweep, samples) => {
            let samples = &samples[..length];
            for i in 0..length {
                out[i] = error(i).after(sweep.angle(samples[i]));
            }
        }
    }
}

/// How a shaft moves, from sine and cosine of an angle: its own way for steep bends and for others.
pub(crate) trait MotionFormula<T: Real>: Copy {
    /// Whether it serves moderate bends, and whether it serves others.
    const MODERATE: bool;
    const STEEP: bool;

    /// Numerator and positive denominator of the tangent of the angle error.
    fn error_tangent(&self, s: T, c: T) -> (T, T);

    /// Speed ratio and acceleration ratio.
    fn rates(&self, s: T, c: T) -> (T, T);

    /// The same by a quotient with fewer roundings where bends are the steepest.
    fn steep_error_tangent(&self, s: T, c: T) -> (T, T);

    /// Jerk ratio.
    fn jerk_ratio(&self, s: T, c: T) -> T;

    /// Tangent and rates.
    fn motion(&self, s: T, c: T) -> ((T, T), (T, T));
}

/// From the pins of the joint's driving angle.
impl<T: Angle> MotionFormula<T> for joint::JointConstants<T> {
    const MODERATE: bool = !T::PRECISION.costs().double_angle;
    const STEEP: bool = true;

    #[inline(always)]
    fn error_tangent(&self, s: T, c: T) -> (T, T) {
        joint::error_tangent(self, s, c)
    }

    #[inline(always)]
    fn steep_error_tangent(&self, s: T, c: T) -> (T, T) {
        joint::steep_error_tangent(self, s, c)
    }

    #[inline(always)]
    fn rates(&self, s: T, c: T) -> (T, T) {
        joint::rates(self, s, c)
    }

    #[inline(always)]
    fn jerk_ratio(&self, s: T, c: T) -> T {
        joint::jerk_ratio(self, s, c)
    }

    #[inline(always)]
    fn motion(&self, s: T, c: T) -> ((T, T), (T, T)) {
        joint::motion(self, s, c)
    }
}

/// From twice the drive angle.
impl<T: Angle, const PARTS: usize> MotionFormula<T> for Ideal<T, PARTS> {
    const MODERATE: bool = true;
    const STEEP: bool = false;

    #[inline(always)]
    fn error_tangent(&self, s: T, c: T) -> (T, T) {
        let terms = self.terms(s, c);
        (terms.neg_im, terms.one_minus_re)
    }

    #[inline(always)]
    fn steep_error_tangent(&self, s: T, c: T) -> (T, T) {
        self.error_tangent(s, c)
    }

    #[inline(always)]
    fn rates(&self, s: T, c: T) -> (T, T) {
        self.terms(s, c).rates()
    }

    #[inline(always)]
    fn jerk_ratio(&self, s: T, c: T) -> T {
        self.terms(s, c).jerk_ratio()
    }

    #[inline(always)]
    fn motion(&self, s: T, c: T) -> ((T, T), (T, T)) {
        let terms = self.terms(s, c);
        ((terms.neg_im, terms.one_minus_re), terms.rates())
    }
}

/// Angle error of a shaft whose tangents stay within `range`.
#[inline(always)]
pub(crate) fn angle_error<T: Number, S: MotionFormula<T>>(
    range: AtanRange,
    at: impl Fn(usize) -> S,
    pins: impl SinCosBlocks<T>,
    out: impl Sink<T>,
) {
    let tangent = S::error_tangent;
    if S::MODERATE && range.is_moderate() {
        match range {
            AtanRange::Hundredth => error_by(tangent, T::atan_hundredth, at, pins, out),
            AtanRange::Tenth => error_by(tangent, T::atan_tenth, at, pins, out),
            _ => error_by(tangent, T::atan_third, at, pins, out),
        }
    } else if S::STEEP {
        match range {
            // With error terms the infinite inverse exsecant of a straight joint would be no number.
            AtanRange::Any if T::LOW => error_by(tangent, T::atan_any, at, pins, out),
            AtanRange::Any => error_by(S::steep_error_tangent, T::atan_any, at, pins, out),
            _ => error_by(tangent, T::atan_one, at, pins, out),
        }
    }
}

#[inline(always)]
fn error_by<T: Number, S: MotionFormula<T>>(
    tangent: impl Fn(&S, T, T) -> (T, T),
    atan: impl Fn(T, T) -> T,
    at: impl Fn(usize) -> S,
    pins: impl SinCosBlocks<T>,
    mut out: impl Sink<T>,
) {
    for (start, pins) in pins.parts() {
        let mut out = out.slice(start, pins.len());
        for i in 0..pins.len() {
            let (s, c) = pins.get(i);
            let (y, x) = tangent(&at(start + i), s, c);
            out.store(i, atan(y, x));
        }
    }
}

/// Angle or angle error, speed ratio and acceleration ratio together, for moderate bends: steeper
/// ones have formulas with fewer roundings each.
#[inline(always)]
pub(crate) fn motion<T: Number, S: MotionFormula<T>>(
    range: AtanRange,
    at: impl Fn(usize) -> S,
    pins: impl SinCosBlocks<T>,
    rotations: impl Sink<T>,
    rates: [impl Sink<T>; 2],
) {
    match range {
        AtanRange::Hundredth => motion_by(T::atan_hundredth, at, pins, rotations, rates),
        AtanRange::Tenth => motion_by(T::atan_tenth, at, pins, rotations, rates),
        _ => motion_by(T::atan_third, at, pins, rotations, rates),
    }
}

#[inline(always)]
fn motion_by<T: Number, S: MotionFormula<T>>(
    atan: impl Fn(T, T) -> T,
    at: impl Fn(usize) -> S,
    pins: impl SinCosBlocks<T>,
    mut rotations: impl Sink<T>,
    [mut ratios, mut accelerations]: [impl Sink<T>; 2],
) {
    for (start, pins) in pins.parts() {
        let length = pins.len();
        let mut rotations = rotations.slice(start, length);
        let mut ratios = ratios.slice(start, length);
        let mut accelerations = accelerations.slice(start, length);
        for i in 0..length {
            let (s, c) = pins.get(i);
            let ((y, x), (ratio, acceleration)) = at(start + i).motion(s, c);
            rotations.store(i, atan(y, x));
            ratios.store(i, ratio);
            accelerations.store(i, acceleration);
        }
    }
}

/// Speed ratio.
#[inline(always)]
pub(crate) fn speed_ratio<T: Real, S: MotionFormula<T>>(
    at: impl Fn(usize) -> S,
    pins: impl SinCosBlocks<T>,
    mut out: impl Sink<T>,
) {
    for (start, pins) in pins.parts() {
        let mut out = out.slice(start, pins.len());
        for i in 0..pins.len() {
            let (s, c) = pins.get(i);
            out.store(i, at(start + i).rates(s, c).0);
        }
    }
}

/// Acceleration ratio.
#[inline(always)]
pub(crate) fn acceleration_ratio<T: Real, S: MotionFormula<T>>(
    at: impl Fn(usize) -> S,
    pins: impl SinCosBlocks<T>,
    mut out: impl Sink<T>,
) {
    for (start, pins) in pins.parts() {
        let mut out = out.slice(start, pins.len());
        for i in 0..pins.len() {
            let (s, c) = pins.get(i);
            out.store(i, at(start + i).rates(s, c).1);
        }
    }
}

/// Jerk ratio.
#[inline(always)]
pub(crate) fn jerk_ratio<T: Real, S: MotionFormula<T>>(
    at: impl Fn(usize) -> S,
    pins: impl SinCosBlocks<T>,
    mut out: impl Sink<T>,
) {
    for (start, pins) in pins.parts() {
        let mut out = out.slice(start, pins.len());
        for i in 0..pins.len() {
            let (s, c) = pins.get(i);
            out.store(i, at(start + i).jerk_ratio(s, c));
        }
    }
}

/// Speed ratio and acceleration ratio, which share a division.
#[inline(always)]
pub(crate) fn rates<T: Real, S: MotionFormula<T>>(
    at: impl Fn(usize) -> S,
    pins: impl SinCosBlocks<T>,
    mut ratios: impl Sink<T>,
    mut accelerations: impl Sink<T>,
) {
    for (start, pins) in pins.parts() {
        let mut ratios = ratios.slice(start, pins.len());
        let mut accelerations = accelerations.slice(start, pins.len());
        for i in 0..pins.len() {
            let (s, c) = pins.get(i);
            let (ratio, acceleration) = at(start + i).rates(s, c);
            ratios.store(i, ratio);
            accelerations.store(i, acceleration);
        }
    }
}

/// A column to where it is wanted.
#[inline(always)]
pub(crate) fn copy<T: Real>(column: View<'_, T>, mut out: impl Sink<T>) {
    let mut out = out.slice(0, column.len());
    for i in 0..column.len() {
        out.store(i, column.get(i));
    }
}

/// The power that a shaft's inertia takes, added to the running power times `sign`.
#[inline(always)]
pub(crate) fn absorb<T: Real>(
    sign: f64,
    [inertia, speed, acceleration]: [&[f64]; 3],
    ratio: View<'_, T>,
    acceleration_ratio: View<'_, T>,
    power: ViewMut<'_, T>,
) {
    let length = power.len();
    let mut power = power.cut(length);
    let (ratio, acceleration_ratio) = (ratio.cut(length), acceleration_ratio.cut(length));
    let (inertia, speed) = (&inertia[..length], &speed[..length]);
    let acceleration = &acceleration[..length];
    for i in 0..length {
        let inertia = T::from_f64(sign * inertia[i]);
        let (speed, acceleration) = (T::from_f64(speed[i]), T::from_f64(acceleration[i]));
        let (r, a) = (ratio.get(i), acceleration_ratio.get(i));
        let taken = moment::absorbed_power(inertia, speed, acceleration, r, a);
        power.set(i, power.get(i) + taken);
    }
}

/// Element by element `a / b`.
#[inline(always)]
pub(crate) fn divide<T: Real>(a: View<'_, T>, b: View<'_, T>, mut out: impl Sink<T>) {
    let length = a.len();
    let (b, mut out) = (b.cut(length), out.slice(0, length));
    for i in 0..length {
        out.store(i, a.get(i) / b.get(i));
    }
}

/// A column of doubles, times another column if there is one.
#[inline(always)]
pub(crate) fn spread<T: Real>(a: &[f64], b: Option<View<'_, T>>, out: ViewMut<'_, T>) {
    let mut out = out.cut(a.len());
    match b {
        Some(b) => {
            let b = b.cut(a.len());
            for i in 0..a.len() {
                out.set(i, T::from_f64(a[i]) * b.get(i));
            }
        }
        None => {
            for i in 0..a.len() {
                out.set(i, T::from_f64(a[i]));
            }
        }
    }
}

/// A joint's torsion times squares and product of its pin's sine and cosine.
#[inline(always)]
pub(crate) fn parts<T: Real>(
    at: impl Fn(usize) -> Pose<T>,
    pins: SinCos<'_, T>,
    torsion: View<'_, T>,
    parts: [ViewMut<'_, T>; 3],
) {
    let length = pins.len();
    let torsion = torsion.cut(length);
    let [sine2, cosine2, product] = parts;
    let (mut sine2, mut cosine2) = (sine2.cut(length), cosine2.cut(length));
    let mut product = product.cut(length);
    for i in 0..length {
        let (s, c) = pins.get(i);
        let TorsionParts { sine2: ss, cosine2: cc, product: sc } =
            at(i).parts(torsion.get(i), s, c);
        sine2.set(i, ss);
        cosine2.set(i, cc);
        product.set(i, sc);
    }
}

/// The moment that a joint passes on.
#[inline(always)]
pub(crate) fn moment<const PLANAR: bool, T: Real>(
    at: impl Fn(usize) -> Pose<T>,
    pins: SinCos<'_, T>,
    torsion: View<'_, T>,
    [mut x, mut y, mut z]: [impl Sink<T>; 3],
) {
    let length = pins.len();
    let torsion = torsion.cut(length);
    let (mut x, mut y, mut z) = (x.slice(0, length), y.slice(0, length), z.slice(0, length));
    for i in 0..length {
        let (s, c) = pins.get(i);
        let [along_x, along_y, along_z] = at(i).moment::<PLANAR>(torsion.get(i), s, c);
        x.store(i, along_x);
        y.store(i, along_y);
        z.store(i, along_z);
    }
}

/// A joint's part of a component of the support moment of one of its shafts, after what `before` begins
/// with.
#[inline(always)]
pub(crate) fn support<const PLANAR: bool, const COMPONENT: usize, T: Real>(
    at: impl Fn(usize) -> Pose<T>,
    driving: bool,
    [square, product]: [View<'_, T>; 2],
    before: impl Fn(usize) -> Option<T>,
    mut out: impl Sink<T>,
) {
    let length = square.len();
    let (product, mut out) = (product.cut(length), out.slice(0, length));
    for i in 0..length {
        let numbers = [square.get(i), product.get(i)];
        out.store(i, at(i).support::<PLANAR, COMPONENT>(driving, numbers, before(i)));
    }
}

/// A number per sample that the pose gives for its torsion.
#[inline(always)]
pub(crate) fn size<T: Real>(
    at: impl Fn(usize) -> Pose<T>,
    size_of: impl Fn(&Pose<T>, T, T, T) -> T,
    pins: SinCos<'_, T>,
    torsion: View<'_, T>,
    mut out: impl Sink<T>,
) {
    let (torsion, mut out) = (torsion.cut(pins.len()), out.slice(0, pins.len()));
    for i in 0..pins.len() {
        let (s, c) = pins.get(i);
        out.store(i, size_of(&at(i), torsion.get(i), s, c));
    }
}

/// A tilt of the cross, from pins whose sense is right.
#[inline(always)]
pub(crate) fn tilt<T: Real>(
    at: impl Fn(usize) -> Pose<T>,
    tilt_of: impl Fn(&Pose<T>, T, T) -> T,
    pins: SinCos<'_, T>,
    mut out: impl Sink<T>,
) {
    let mut out = out.slice(0, pins.len());
    for i in 0..pins.len() {
        let (s, c) = pins.get(i);
        out.store(i, tilt_of(&at(i), s, c));
    }
}

/// The drive shaft turns with the drive: its angle, NaN where that is not finite.
#[inline(always)]
pub(crate) fn drive_angle<T: Number, W: Float>(drive: Drive<'_>, out: &mut [W]) {
    let zero = T::from_f64(0.0);
    add_drive_to(drive, |_| zero, out);
}

/// A constant, NaN where the angle is not finite.
#[inline(always)]
pub(crate) fn constant<T: Number>(value: f64, drive: Drive<'_>, mut out: impl Sink<T>) {
    let length = out.length();
    let mut out = out.slice(0, length);
    match drive {
        Drive::Array(angle) => {
            let angle = &angle[..length];
            for i in 0..length {
                out.store(i, T::from_f64(angle[i].mul_add(0.0, value)));
            }
        }
        Drive::Sweep(..) | Drive::Picked(..) => {
            for i in 0..length {
                out.store(i, T::from_f64(value));
            }
        }
    }
}
