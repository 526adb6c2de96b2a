//! The rotation of one shaft and its rates, or its rates in single precision, strip by strip.
//!
//! One loop for everything holds so many results that a core overlaps few of its iterations, and one
//! over both angles and single-precision numbers uses half of each register. The pins of a strip, its
//! tangents and rates, its angle errors and its words therefore come from separate short loops. A
//! strip stays in the nearest cache from loop to loop, and results leave it in whole cache lines.
#![allow(clippy::needless_range_loop, reason = "an iterator hides that its count is constant")]

use std::any::Any;

use cardan_memory::ask;

use crate::mechanics::joint::{self, JointConstants};
use crate::number::atan::AtanRange;
use crate::number::float::{Float, Real};
use crate::number::reduction::{self, LargeAngleFlag, LargeFractionFlag};
use crate::number::{Number, Precision};
use crate::plan::output::Output;
use crate::plan::steps::ShaftStep;
use crate::run::sink::{Outputs, Words};
use crate::sincos::array::{PinLine, SinCosKind, turned_pin};

/// The samples of a strip, and the fewest of a chunk. In single precision, the loops of strips of 32
/// samples wait for one another, and strips of 128 do not stay in registers. Those of doubles do not
/// in either case, and what a strip costs beside its loops is a smaller part of a longer one.
pub(crate) const fn strip_length(precision: Precision) -> usize {
    match precision {
        Precision::Single => 64,
        _ => 128,
    }
}

/// How many samples ahead angles are requested: half a page of memory. Requests in the page that
/// follows the present one made a copy of angles to such results a fifth slower.
const AHEAD: usize = 256;

/// Numbers of a strip, on cache lines.
#[derive(Clone, Copy)]
#[repr(align(64))]
struct Strip<T, const N: usize>([T; N]);

/// Outputs of the only shaft that needs pins, from at least `N` angles. Returns whether
/// they are valid: not if an angle is too large for its reduction.
#[inline(always)]
pub(crate) fn run_shaft<T: Number, W: Float, const N: usize>(
    step: &ShaftStep,
    range: AtanRange,
    (joint, turn): (JointConstants<T>, [T; 2]),
    angles: &[f64],
    outputs: &mut Outputs<'_, '_, W>,
) -> bool {
    let turn = (step.shaft > 1).then_some(turn);
    let past_caches = outputs.bypass_caches();
    let plane = |output| step.planes.get(output);
    let is_angle = plane(Output::Angle).is_some();
    let mut planes = outputs.chosen([
        plane(Output::Angle).or(plane(Output::AngleError)),
        plane(Output::SpeedRatio),
        plane(Output::AccelerationRatio),
    ]);
    let needed = planes.each_ref().map(Option::is_some);
    let mut too_large = TooLarge {
        fractions: LargeFractionFlag::default(),
        angles: LargeAngleFlag::for_quadrants(),
    };
    let (zero, last) = (T::from_f64(0.0), angles.len() - N);
    let (mut pins, mut numbers) = ([strip(zero); 2], [strip(zero.value()); 3]);
    let (mut near, mut tangents, mut strips) = (strip(zero), strip(zero), [strip(W::default()); 3]);
    for first in (0..angles.len()).step_by(N) {
        // The last strip computes some samples of the one before it again.
        let first = first.min(last);
        let angles: &[f64; N] = angles[first..].first_chunk().expect("a whole strip");
        if past_caches {
            for line in (0..N).step_by(8) {
                ask(angles, AHEAD + line);
            }
        }
        // An angle alone leaves room for its pins in the loop of its tangents.
        let alone = needed == [true, false, false]
            && range.is_moderate()
            && T::PRECISION == Precision::Double;
        if alone {
            for i in 0..N {
                let (s, c) = fresh_pin(angles[i], turn, &mut too_large);
                let (y, x) = joint::error_tangent(&joint, s, c);
                tangents.0[i] = y / x;
            }
        } else {
            find_pins(angles, turn, &mut pins, &mut too_large);
        }
        let [Strip(sine), Strip(cosine)] = &pins;
        let pins = (sine, cosine);
        let [rotations, ratios, accelerations] = &mut numbers;
        let [rotation, ratio, acceleration] = &mut planes;
        let [own, own_ratios, own_accelerations] = &mut strips;
        let rotation = words_of(rotation, first, past_caches, own);
        let ratio = words_of(ratio, first, past_caches, own_ratios);
        let acceleration = words_of(acceleration, first, past_caches, own_accelerations);
        let in_numbers = size_of::<W>() == size_of::<T::Float>();
        {
            let drive = (in_numbers && is_angle).then_some(in_numbers_of(angles, &mut near.0));
            let rotation = as_numbers(rotation, &mut rotations.0);
            let ratio = as_numbers(ratio, &mut ratios.0);
            let acceleration = as_numbers(acceleration, &mut accelerations.0);
            match needed {
                [true, _, true] => {
                    find_motion(&joint, pins, &mut tangents.0, ratio, acceleration);
                    find_errors(range, drive, &tangents.0, rotation);
                }
                _ if alone => find_errors(range, drive, &tangents.0, rotation),
                [true, has_ratio, false] => {
                    find_rotations(range, drive, &joint, pins, &mut tangents.0, rotation);
                    if has_ratio {
                        find_ratios(&joint, pins, ratio);
                    }
                }
                [false, _, true] => find_rates(&joint, pins, ratio, acceleration),
                [false, _, false] => find_ratios(&joint, pins, ratio),
            }
        }
        if !in_numbers {
            let drive = is_angle.then_some(angles);
            let [rotates, has_ratio, has_acceleration] = needed;
            if rotates {
                convert(drive, &rotations.0, rotation);
            }
            if has_ratio {
                convert(None, &ratios.0, ratio);
            }
            if has_acceleration {
                convert(None, &accelerations.0, acceleration);
            }
        }
        if past_caches {
            for (plane, strip) in planes.iter_mut().zip(&strips) {
                if let Some(plane) = plane {
                    plane.put_words(first, &strip.0);
                }
            }
        }
    }
    too_large.none()
}

/// The words of a plane from `first` on, or those of a strip if the plane's bypass the caches.
#[inline(always)]
fn words_of<'a, W: Float, const N: usize>(
    plane: &'a mut Option<Words<'_, W>>,
    first: usize,
    past_caches: bool,
    own: &'a mut Strip<W, N>,
) -> &'a mut [W; N] {
    match plane {
        Some(plane) if !past_caches => {
            plane.words()[first..].first_chunk_mut().expect("a whole strip")
        }
        _ => &mut own.0,
    }
}

/// The words themselves, if they have the type of numbers, else numbers that are converted to them.
#[inline(always)]
fn as_numbers<'a, W: Float, F: Float, const N: usize>(
    words: &'a mut [W; N],
    numbers: &'a mut [F; N],
) -> &'a mut [F; N] {
    (words as &mut dyn Any).downcast_mut().unwrap_or(numbers)
}

/// The angles themselves, if they have the type of numbers, else numbers near to them.
#[inline(always)]
fn in_numbers_of<'a, T: Real, const N: usize>(
    angles: &'a [f64; N],
    near: &'a mut [T; N],
) -> &'a [T; N] {
    if let Some(angles) = (angles as &dyn Any).downcast_ref() {
        return angles;
    }
    for i in 0..N {
        near[i] = T::from_f64(angles[i]);
    }
    near
}

/// Converts numbers to words, and adds the drive angles if they are given.
#[inline(always)]
fn convert<F: Float, W: Float, const N: usize>(
    drive: Option<&[f64; N]>,
    numbers: &[F; N],
    words: &mut [W; N],
) {
    if let Some(drive) = drive {
        for i in 0..N {
            words[i] = W::near(drive[i] + numbers[i].into());
        }
    } else {
        for i in 0..N {
            words[i] = W::near(numbers[i].into());
        }
    }
}

/// Records whether any angle was too large for its reduction.
struct TooLarge {
    fractions: LargeFractionFlag,
    angles: LargeAngleFlag,
}

impl TooLarge {
    #[inline(always)]
    fn none(&self) -> bool {
        !self.fractions.any() && !self.angles.any()
    }
}

/// Sine and cosine of the input angles of a strip, up to a common factor.
#[inline(always)]
fn find_pins<T: Number, const N: usize>(
    angles: &[f64; N],
    turn: Option<[T; 2]>,
    [Strip(sine), Strip(cosine)]: &mut [Strip<T, N>; 2],
    too_large: &mut TooLarge,
) {
    if T::PRECISION.costs().turn_fractions {
        for i in 0..N {
            let phase = reduction::turn_fraction_q30(angles[i]);
            too_large.fractions.accumulate(phase);
            cosine[i] = T::of_bits(phase);
        }
        for i in 0..N {
            (sine[i], cosine[i]) = PinLine::sin_cos(T::from_turn_fraction(cosine[i].bits()));
        }
    } else {
        for i in 0..N {
            (sine[i], cosine[i]) = fresh_pin(angles[i], turn, too_large);
        }
        return;
    }
    if let Some(turn) = turn {
        for i in 0..N {
            (sine[i], cosine[i]) = turned_pin((sine[i], cosine[i]), turn);
        }
    }
}

/// Sine and cosine of one input angle, up to a common factor.
#[inline(always)]
fn fresh_pin<T: Number>(angle: f64, turn: Option<[T; 2]>, too_large: &mut TooLarge) -> (T, T) {
    let reduced = T::reduce(angle);
    too_large.angles.accumulate(reduced.1);
    let pin = PinLine::sin_cos(reduced);
    if let Some(turn) = turn { turned_pin(pin, turn) } else { pin }
}

/// Sines and cosines of a strip.
type StripPins<'a, T, const N: usize> = (&'a [T; N], &'a [T; N]);

/// Tangents of the angle error at moderate bends, and both rates.
#[inline(always)]
fn find_motion<T: Number, const N: usize>(
    joint: &JointConstants<T>,
    (sine, cosine): StripPins<'_, T, N>,
    tangents: &mut [T; N],
    ratios: &mut [T::Float; N],
    accelerations: &mut [T::Float; N],
) {
    for i in 0..N {
        let (tangent, (ratio, acceleration)) = joint::motion(joint, sine[i], cosine[i]);
        tangents[i] = tangent;
        ratios[i] = ratio.value();
        accelerations[i] = acceleration.value();
    }
}

/// Angle errors, added to drive angles if these are given.
#[inline(always)]
fn find_rotations<T: Number, const N: usize>(
    range: AtanRange,
    drive: Option<&[T; N]>,
    joint: &JointConstants<T>,
    (sine, cosine): StripPins<'_, T, N>,
    tangents: &mut [T; N],
    rotations: &mut [T::Float; N],
) {
    match range {
        AtanRange::Any => {
            store_errors(
                drive,
                rotations,
                #[inline(always)]
                |i| {
                    let (y, x) = joint::steep_error_tangent(joint, sine[i], cosine[i]);
                    T::atan_any(y, x)
                },
            );
        }
        AtanRange::One => {
            store_errors(
                drive,
                rotations,
                #[inline(always)]
                |i| {
                    let (y, x) = joint::error_tangent(joint, sine[i], cosine[i]);
                    T::atan_one(y, x)
                },
            );
        }
        _ => {
            for i in 0..N {
                let (y, x) = joint::error_tangent(joint, sine[i], cosine[i]);
                tangents[i] = y / x;
            }
            find_errors(range, drive, tangents, rotations);
        }
    }
}

/// Angle errors at moderate bends from their tangents, added to drive angles if these are given.
#[inline(always)]
fn find_errors<T: Number, const N: usize>(
    range: AtanRange,
    drive: Option<&[T; N]>,
    tangents: &[T; N],
    rotations: &mut [T::Float; N],
) {
    macro_rules! by {
        ($atan:ident) => {
            store_errors(
                drive,
                rotations,
                #[inline(always)]
                |i| tangents[i].$atan(),
            )
        };
    }
    match range {
        AtanRange::Hundredth => by!(atan_hundredth),
        AtanRange::Tenth => by!(atan_tenth),
        _ => by!(atan_third),
    }
}

#[inline(always)]
fn find_rates<T: Number, const N: usize>(
    joint: &JointConstants<T>,
    (sine, cosine): StripPins<'_, T, N>,
    ratios: &mut [T::Float; N],
    accelerations: &mut [T::Float; N],
) {
    for i in 0..N {
        let (ratio, acceleration) = joint::rates(joint, sine[i], cosine[i]);
        ratios[i] = ratio.value();
        accelerations[i] = acceleration.value();
    }
}

#[inline(always)]
fn find_ratios<T: Number, const N: usize>(
    joint: &JointConstants<T>,
    (sine, cosine): StripPins<'_, T, N>,
    ratios: &mut [T::Float; N],
) {
    for i in 0..N {
        ratios[i] = joint::speed_ratio(joint, sine[i], cosine[i]).value();
    }
}

/// Stores angle errors, added to drive angles if these are given. The error at a zero is positive, so
/// that the sum has the bits of one with an error term.
#[inline(always)]
fn store_errors<T: Number, const N: usize>(
    drive: Option<&[T; N]>,
    rotations: &mut [T::Float; N],
    error: impl Fn(usize) -> T,
) {
    if let Some(drive) = drive {
        for i in 0..N {
            rotations[i] = (drive[i] + error(i)).value();
        }
    } else {
        for i in 0..N {
            rotations[i] = error(i).value();
        }
    }
}

#[inline(always)]
fn strip<T: Copy, const N: usize>(number: T) -> Strip<T, N> {
    Strip([number; N])
}
