//! Loops over slices, one per output.
//!
//! Each is a plain scalar loop without branches that the compiler vectorises for whichever
//! instruction set the caller was compiled for; all are inlined into [`crate::batch`]'s one
//! dispatched function. The slices are a chunk of the angles, small enough for the first-level
//! cache, so a loop per output costs no more than one loop for all and keeps each skippable.
//!
//! Constants come through `at(i)`: one value for the whole chunk, or one per sample.

use crate::chain::Equivalent;
use crate::joint::{self, Joint};
use crate::moment::{self, PinAngle, Pose};
use crate::trig::{self, AtanRange};

/// Sine and cosine of each angle up to a common factor, by the exact path where an angle is too far
/// for the fast one.
#[inline(always)]
pub(crate) fn pins(angle: &[f64], sine: &mut [f64], cosine: &mut [f64]) {
    pins_by(trig::pin, angle, sine, cosine);
}

/// The same up to a positive factor.
#[inline(always)]
pub(crate) fn sensed_pins(angle: &[f64], sine: &mut [f64], cosine: &mut [f64]) {
    pins_by(trig::sensed_pin, angle, sine, cosine);
}

#[inline(always)]
fn pins_by(
    pin: impl Fn(trig::Reduced) -> (f64, f64),
    angle: &[f64],
    sine: &mut [f64],
    cosine: &mut [f64],
) {
    let mut far = trig::Far::default();
    for ((&x, s), c) in angle.iter().zip(sine.iter_mut()).zip(cosine.iter_mut()) {
        let reduced = trig::reduce(x);
        far.watch(reduced);
        (*s, *c) = pin(reduced);
    }
    if far.any() {
        for ((&x, s), c) in angle.iter().zip(sine).zip(cosine) {
            (*s, *c) = pin(trig::reduce_any(x));
        }
    }
}

/// Sine and cosine of the equivalent joint's driving angle `α + φ`.
#[inline(always)]
pub(crate) fn turn(
    at: impl Fn(usize) -> Equivalent,
    sine: &[f64],
    cosine: &[f64],
    turned_sine: &mut [f64],
    turned_cosine: &mut [f64],
) {
    let input = sine.iter().zip(cosine);
    let output = turned_sine.iter_mut().zip(turned_cosine);
    for (i, ((&s, &c), (turned_s, turned_c))) in input.zip(output).enumerate() {
        let Equivalent { turn_cos, turn_sin, .. } = at(i);
        *turned_s = s.mul_add(turn_cos, c * turn_sin);
        *turned_c = c.mul_add(turn_cos, -(s * turn_sin));
    }
}

/// Angle error of a joint whose tangents stay within `range`.
#[inline(always)]
pub(crate) fn angle_error(
    range: AtanRange,
    at: impl Fn(usize) -> Equivalent,
    sine: &[f64],
    cosine: &[f64],
    out: &mut [f64],
) {
    rotation::<false>(range, at, [sine, sine, cosine], out);
}

/// Drive angle plus angle error of a joint whose tangents stay within `range`.
#[inline(always)]
pub(crate) fn angle(
    range: AtanRange,
    at: impl Fn(usize) -> Equivalent,
    drive: &[f64],
    sine: &[f64],
    cosine: &[f64],
    out: &mut [f64],
) {
    rotation::<true>(range, at, [drive, sine, cosine], out);
}

#[inline(always)]
fn rotation<const ADD: bool>(
    range: AtanRange,
    at: impl Fn(usize) -> Equivalent,
    input: [&[f64]; 3],
    out: &mut [f64],
) {
    let tangent = joint::error_tangent;
    match range {
        AtanRange::Hundredth => by::<ADD>(tangent, trig::atan_hundredth, at, input, out),
        AtanRange::Tenth => by::<ADD>(tangent, trig::atan_tenth, at, input, out),
        AtanRange::Third => by::<ADD>(tangent, trig::atan_third, at, input, out),
        AtanRange::One => by::<ADD>(tangent, trig::atan_one, at, input, out),
        AtanRange::Any => by::<ADD>(joint::steep_error_tangent, trig::atan_any, at, input, out),
    }
}

#[inline(always)]
fn by<const ADD: bool>(
    tangent: impl Fn(&Joint, f64, f64) -> (f64, f64),
    atan: impl Fn(f64, f64) -> f64,
    at: impl Fn(usize) -> Equivalent,
    [drive, sine, cosine]: [&[f64]; 3],
    out: &mut [f64],
) {
    let input = drive.iter().zip(sine).zip(cosine);
    for (i, (((&drive, &s), &c), angle)) in input.zip(out).enumerate() {
        let (y, x) = tangent(&at(i).joint, s, c);
        let error = atan(y, x);
        *angle = if ADD { drive + error } else { error };
    }
}

/// Element by element `a + b`.
#[inline(always)]
pub(crate) fn sum(a: &[f64], b: &[f64], out: &mut [f64]) {
    for ((&a, &b), sum) in a.iter().zip(b).zip(out) {
        *sum = a + b;
    }
}

/// Speed ratio.
#[inline(always)]
pub(crate) fn speed_ratio(
    at: impl Fn(usize) -> Equivalent,
    sine: &[f64],
    cosine: &[f64],
    out: &mut [f64],
) {
    for (i, ((&s, &c), ratio)) in sine.iter().zip(cosine).zip(out).enumerate() {
        (*ratio, _) = joint::rates(&at(i).joint, s, c);
    }
}

/// Acceleration ratio.
#[inline(always)]
pub(crate) fn acceleration_ratio(
    at: impl Fn(usize) -> Equivalent,
    sine: &[f64],
    cosine: &[f64],
    out: &mut [f64],
) {
    for (i, ((&s, &c), acceleration)) in sine.iter().zip(cosine).zip(out).enumerate() {
        (_, *acceleration) = joint::rates(&at(i).joint, s, c);
    }
}

/// Speed ratio and acceleration ratio, which share a division.
#[inline(always)]
pub(crate) fn rates(
    at: impl Fn(usize) -> Equivalent,
    sine: &[f64],
    cosine: &[f64],
    speed_ratio: &mut [f64],
    acceleration_ratio: &mut [f64],
) {
    let output = speed_ratio.iter_mut().zip(acceleration_ratio);
    for (i, ((&s, &c), (ratio, acceleration))) in sine.iter().zip(cosine).zip(output).enumerate() {
        (*ratio, *acceleration) = joint::rates(&at(i).joint, s, c);
    }
}

/// The power that a shaft's inertia takes, added to the running power times `sign`.
#[inline(always)]
pub(crate) fn absorb(
    sign: f64,
    [inertia, speed, acceleration]: [&[f64]; 3],
    ratio: &[f64],
    acceleration_ratio: &[f64],
    power: &mut [f64],
) {
    let drive = inertia.iter().zip(speed).zip(acceleration);
    let shaft = ratio.iter().zip(acceleration_ratio);
    for (((&i, &w), &e), ((&r, &a), p)) in drive.zip(shaft.zip(power)) {
        *p += moment::absorbed_power(sign * i, w, e, r, a);
    }
}

/// Element by element `a / b`.
#[inline(always)]
pub(crate) fn divide(a: &[f64], b: &[f64], out: &mut [f64]) {
    for ((&a, &b), quotient) in a.iter().zip(b).zip(out) {
        *quotient = a / b;
    }
}

/// Element by element `a · b`.
#[inline(always)]
pub(crate) fn multiply(a: &[f64], b: &[f64], out: &mut [f64]) {
    for ((&a, &b), product) in a.iter().zip(b).zip(out) {
        *product = a * b;
    }
}

/// A vector per sample, one slice per component: the torsion times what the pose gives per unit of
/// it, added to what is there if `ADD`.
#[inline(always)]
pub(crate) fn vector<const ADD: bool>(
    at: impl Fn(usize) -> Pose,
    per_torsion: impl Fn(&Pose, usize, PinAngle) -> f64,
    [sine, cosine, torsion]: [&[f64]; 3],
    [x, y, z]: [&mut [f64]; 3],
) {
    let input = sine.iter().zip(cosine).zip(torsion);
    let output = x.iter_mut().zip(y).zip(z);
    for (i, (((&s, &c), &d), ((x, y), z))) in input.zip(output).enumerate() {
        let pose = at(i);
        let pin = pose.angle(s, c);
        for (component, value) in [x, y, z].into_iter().enumerate() {
            let moment = d * per_torsion(&pose, component, pin);
            *value = if ADD { *value + moment } else { moment };
        }
    }
}

/// The size of a moment per sample: the size of the torsion times what the pose gives per unit.
#[inline(always)]
pub(crate) fn size(
    at: impl Fn(usize) -> Pose,
    per_torsion: impl Fn(&Pose, PinAngle) -> f64,
    [sine, cosine, torsion]: [&[f64]; 3],
    out: &mut [f64],
) {
    for (i, (((&s, &c), &d), size)) in sine.iter().zip(cosine).zip(torsion).zip(out).enumerate() {
        let pose = at(i);
        *size = d.abs() * per_torsion(&pose, pose.angle(s, c));
    }
}

/// A tilt of the cross, from pins whose sense is right.
#[inline(always)]
pub(crate) fn tilt(
    at: impl Fn(usize) -> Pose,
    tilt_of: impl Fn(&Pose, f64, f64) -> f64,
    sine: &[f64],
    cosine: &[f64],
    out: &mut [f64],
) {
    for (i, ((&s, &c), tilt)) in sine.iter().zip(cosine).zip(out).enumerate() {
        *tilt = tilt_of(&at(i), s, c);
    }
}

/// The drive shaft turns with the drive: its angle, NaN where that is not finite.
#[inline(always)]
pub(crate) fn drive_angle(angle: &[f64], out: &mut [f64]) {
    for (&x, turned) in angle.iter().zip(out) {
        *turned = x.mul_add(0.0, x);
    }
}

/// A constant of the drive shaft, NaN where the angle is not finite.
#[inline(always)]
pub(crate) fn drive_constant(value: f64, angle: &[f64], out: &mut [f64]) {
    for (&x, constant) in angle.iter().zip(out) {
        *constant = x.mul_add(0.0, value);
    }
}
