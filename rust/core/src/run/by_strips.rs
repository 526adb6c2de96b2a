//! The rotation of one shaft and its rates, or in single precision its rates or the moment vector of a
//! joint, strip by strip.
//!
//! One loop for everything holds so many results that a core overlaps few of its iterations, and one
//! over both angles and single-precision numbers uses half of each register. The pins of a strip, its
//! tangents and rates, its angle errors and its words therefore come from separate short loops. A
//! strip stays in the nearest cache from loop to loop, and results leave it in whole cache lines.
#![allow(clippy::needless_range_loop, reason = "an iterator hides that its count is constant")]

use std::any::Any;

use cardan_memory::ask;

use crate::mechanics::joint::{self, JointConstants};
use crate::mechanics::moment::{Pose, parts_of_reduced};
use crate::number::atan::AtanRange;
use crate::number::float::Float;
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
#[allow(clippy::too_many_lines, reason = "each loop of a strip is a function")]
pub(crate) fn run_shaft<T: Number, W: Float, const N: usize>(
    step: &ShaftStep,
    range: AtanRange,
    (joint, turn): (JointConstants<T>, [T; 2]),
    angles: &[f64],
    outputs: &mut Outputs<'_, '_, W>,
) -> bool {
    let turn = (step.shaft > 1).then_some(turn);
    let (past_caches, asks) = (outputs.bypass_caches(), outputs.asks());
    let in_numbers = size_of::<W>() == size_of::<T::Float>();
    // Where registers are narrow, the loop of angle errors converts them as well.
    let is_direct = !in_numbers && !outputs.has_wide_registers();
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
    let (mut tangents, mut strips) = (strip(zero), [strip(W::default()); 3]);
    let (mut near, mut near_words) = (strip(zero.value()), strip(W::default()));
    for first in (0..angles.len()).step_by(N) {
        // The last strip computes some samples of the one before it again.
        let first = first.min(last);
        let angles: &[f64; N] = angles[first..].first_chunk().expect("a whole strip");
        if past_caches {
            ask_ahead(angles);
        } else if asks {
            ask_for::<W, N>(&mut planes, first + N);
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
        let drive = (in_numbers && is_angle).then_some(in_words_of(angles, &mut near.0));
        let [rotates, has_ratio, has_acceleration] = needed;
        {
            let ratio = as_numbers(ratio, &mut ratios.0);
            let acceleration = as_numbers(acceleration, &mut accelerations.0);
            let moderate = range.is_moderate();
            match needed {
                [true, _, true] => {
                    find_motion(&joint, pins, &mut tangents.0, ratio, acceleration);
                    if !is_direct {
                        let rotation = as_numbers(rotation, &mut rotations.0);
                        find_errors(range, drive, &tangents.0, rotation);
                    }
                }
                [true, _, false] => {
                    if moderate && !alone {
                        find_tangents(&joint, pins, &mut tangents.0);
                    }
                    let rotation = as_numbers(rotation, &mut rotations.0);
                    match (is_direct, moderate) {
                        (true, _) => {}
                        (_, true) => find_errors(range, drive, &tangents.0, rotation),
                        _ => find_steep_errors(range, drive, &joint, pins, rotation),
                    }
                    if has_ratio {
                        find_ratios(&joint, pins, ratio);
                    }
                }
                [false, _, true] => find_rates(&joint, pins, ratio, acceleration),
                [false, _, false] => find_ratios(&joint, pins, ratio),
            }
        }
        if rotates && is_direct {
            let drive = is_angle.then_some(in_words_of(angles, &mut near_words.0));
            find_errors(range, drive, &tangents.0, rotation);
        }
        if !in_numbers {
            if rotates && !is_direct {
                convert(is_angle.then_some(angles), &rotations.0, rotation);
            }
            if has_ratio {
                convert(None, &ratios.0, ratio);
            }
            if has_acceleration {
                convert(None, &accelerations.0, acceleration);
            }
        }
        if past_caches {
            put_strips(&mut planes, first, &strips);
        }
    }
    too_large.none()
}

/// The moment vector of the joint that the drive turns, for one torque at all samples, from at least
/// `N` angles; its components are those of the pose, in these planes. Returns whether they
/// are valid: not if an angle is too large for turn fractions.
#[inline(always)]
pub(crate) fn run_moment<const PLANAR: bool, T: Number, W: Float, const N: usize>(
    pose: &Pose<T>,
    torque: T,
    angles: &[f64],
    planes: [usize; 3],
    outputs: &mut Outputs<'_, '_, W>,
) -> bool {
    let (past_caches, asks) = (outputs.bypass_caches(), outputs.asks());
    let mut planes = outputs.chosen(planes.map(Some));
    let mut too_large = LargeFractionFlag::default();
    let (zero, last) = (T::from_f64(0.0), angles.len() - N);
    let mut parts: [Strip<T, N>; 2] = [strip(zero); 2];
    let mut strips = [strip(W::default()); 3];
    for first in (0..angles.len()).step_by(N) {
        let first = first.min(last);
        let angles: &[f64; N] = angles[first..].first_chunk().expect("a whole strip");
        if past_caches {
            ask_ahead(angles);
        } else if asks {
            ask_for::<W, N>(&mut planes, first + N);
        }
        let [Strip(square), Strip(product)] = &mut parts;
        find_phases(angles, square, &mut too_large);
        for i in 0..N {
            [square[i], product[i]] = parts_of_reduced(T::from_turn_fraction(square[i].bits()));
        }
        let parts = (&*square, &*product);
        let [x, y, z] = &mut planes;
        let [own_x, own_y, own_z] = &mut strips;
        let x = words_of(x, first, past_caches, own_x);
        let y = words_of(y, first, past_caches, own_y);
        let z = words_of(z, first, past_caches, own_z);
        find_component::<PLANAR, 0, T, W, N>(pose, torque, parts, x);
        find_component::<PLANAR, 1, T, W, N>(pose, torque, parts, y);
        find_component::<PLANAR, 2, T, W, N>(pose, torque, parts, z);
        if past_caches {
            put_strips(&mut planes, first, &strips);
        }
    }
    !too_large.any()
}

/// A component of the moment vectors of a strip. One loop per component converts its words at once.
#[inline(always)]
fn find_component<const PLANAR: bool, const I: usize, T: Number, W: Float, const N: usize>(
    pose: &Pose<T>,
    torque: T,
    (square, product): (&[T; N], &[T; N]),
    words: &mut [W; N],
) {
    for i in 0..N {
        let along = pose.along::<PLANAR, I>(torque, [square[i], product[i]]);
        words[i] = W::near(along.value().into());
    }
}

/// Requests angles that are read some strips later.
#[inline(always)]
fn ask_ahead<const N: usize>(angles: &[f64; N]) {
    for line in (0..N).step_by(8) {
        ask(angles, AHEAD + line);
    }
}

/// Requests the memory of results from `first` on.
#[inline(always)]
fn ask_for<W: Float, const N: usize>(planes: &mut [Option<Words<'_, W>>; 3], first: usize) {
    for plane in planes.iter_mut().flatten() {
        plane.ask(first, N);
    }
}

/// Stores strips in the planes that there are.
#[inline(always)]
fn put_strips<W: Float, const N: usize>(
    planes: &mut [Option<Words<'_, W>>; 3],
    first: usize,
    strips: &[Strip<W, N>; 3],
) {
    for (plane, strip) in planes.iter_mut().zip(strips) {
        if let Some(plane) = plane {
            plane.put_words(first, &strip.0);
        }
    }
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

/// The angles themselves, if they have the type of words, else words near to them.
#[inline(always)]
fn in_words_of<'a, W: Float, const N: usize>(
    angles: &'a [f64; N],
    near: &'a mut [W; N],
) -> &'a [W; N] {
    if let Some(angles) = (angles as &dyn Any).downcast_ref() {
        return angles;
    }
    for i in 0..N {
        near[i] = W::near(angles[i]);
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
        find_phases(angles, cosine, &mut too_large.fractions);
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

/// The fractions of a turn of the angles of a strip.
#[inline(always)]
fn find_phases<T: Number, const N: usize>(
    angles: &[f64; N],
    phases: &mut [T; N],
    too_large: &mut LargeFractionFlag,
) {
    for i in 0..N {
        let phase = reduction::turn_fraction_q30(angles[i]);
        too_large.accumulate(phase);
        phases[i] = T::of_bits(phase);
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

/// Tangents of the angle error at moderate bends.
#[inline(always)]
fn find_tangents<T: Number, const N: usize>(
    joint: &JointConstants<T>,
    (sine, cosine): StripPins<'_, T, N>,
    tangents: &mut [T; N],
) {
    for i in 0..N {
        let (y, x) = joint::error_tangent(joint, sine[i], cosine[i]);
        tangents[i] = y / x;
    }
}

/// Angle errors at steep bends, added to drive angles if these are given.
#[inline(always)]
fn find_steep_errors<T: Number, W: Float, const N: usize>(
    range: AtanRange,
    drive: Option<&[W; N]>,
    joint: &JointConstants<T>,
    (sine, cosine): StripPins<'_, T, N>,
    rotations: &mut [W; N],
) {
    if range == AtanRange::Any {
        store_errors(
            drive,
            rotations,
            #[inline(always)]
            |i| {
                let (y, x) = joint::steep_error_tangent(joint, sine[i], cosine[i]);
                T::atan_any(y, x)
            },
        );
    } else {
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
}

/// Angle errors at moderate bends from their tangents, added to drive angles if these are given.
#[inline(always)]
fn find_errors<T: Number, W: Float, const N: usize>(
    range: AtanRange,
    drive: Option<&[W; N]>,
    tangents: &[T; N],
    rotations: &mut [W; N],
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

/// Stores angle errors, added to drive angles if these are given. A sum of two words in double
/// precision, rounded to a word, is their sum. The error at a zero is positive, so that the sum has the
/// bits of one with an error term.
#[inline(always)]
fn store_errors<T: Number, W: Float, const N: usize>(
    drive: Option<&[W; N]>,
    rotations: &mut [W; N],
    error: impl Fn(usize) -> T,
) {
    if let Some(drive) = drive {
        for i in 0..N {
            rotations[i] = W::near(drive[i].into() + error(i).value().into());
        }
    } else {
        for i in 0..N {
            rotations[i] = W::near(error(i).value().into());
        }
    }
}

#[inline(always)]
fn strip<T: Copy, const N: usize>(number: T) -> Strip<T, N> {
    Strip([number; N])
}
