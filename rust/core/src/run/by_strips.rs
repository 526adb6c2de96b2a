//! The motion of one shaft in single precision at moderate bends, strip by strip.
//!
//! A register holds twice as many single-precision numbers as angles, and a loop over both uses
//! half of it. The pins of a strip, its results, and their words with the drive angles therefore
//! come from separate loops. A strip is so short that it stays in registers from loop to loop, or
//! in the nearest cache, and results leave it in whole cache lines.
#![allow(clippy::needless_range_loop, reason = "an iterator hides that its count is constant")]

use cardan_memory::ask;

use crate::mechanics::joint::{self, JointConstants};
use crate::number::Number;
use crate::number::atan::AtanRange;
use crate::number::float::Float;
use crate::number::reduction::{self, LargeFractionFlag};
use crate::plan::output::Output;
use crate::plan::steps::ShaftStep;
use crate::run::sink::{Outputs, Words};
use crate::sincos::array::{PinLine, SinCosKind, turned_pin};

/// The samples of a strip, and the fewest of a chunk. The loops of strips of 32 samples wait for
/// one another, and strips of 128 do not stay in registers.
pub(crate) const PIN_STRIP: usize = 64;

/// How many samples ahead angles are requested: half a page of memory. Requests in the page that
/// follows the present one made a copy of angles to such results a fifth slower.
const AHEAD: usize = 256;

/// Numbers of a strip.
type Numbers<T> = [T; PIN_STRIP];

/// Outputs of the only shaft that needs pins, from at least [`PIN_STRIP`] angles. Returns whether
/// they are valid: not if an angle is too large for turn fractions.
#[inline(always)]
pub(crate) fn run_shaft<T: Number, W: Float>(
    step: &ShaftStep,
    range: AtanRange,
    (joint, turn): (JointConstants<T>, [T; 2]),
    angles: &[f64],
    outputs: &mut Outputs<'_, '_, W>,
) -> bool {
    let turn = (step.shaft > 1).then_some(turn);
    let asks = outputs.bypass_caches();
    let plane = |output| step.planes.get(output);
    // Drive angles are added in the precision of the words.
    let is_angle = plane(Output::Angle).is_some();
    let in_numbers = size_of::<W>() == size_of::<T::Float>();
    let [mut rotation, mut ratio, mut acceleration] = outputs.chosen([
        plane(Output::Angle).or(plane(Output::AngleError)),
        plane(Output::SpeedRatio),
        plane(Output::AccelerationRatio),
    ]);
    let needed = [&rotation, &ratio, &acceleration].map(Option::is_some);
    let mut too_large = LargeFractionFlag::default();
    let last = angles.len() - PIN_STRIP;
    for first in (0..angles.len()).step_by(PIN_STRIP) {
        // The last strip computes some samples of the one before it again.
        let first = first.min(last);
        let angles = &angles[first..first + PIN_STRIP];
        if asks {
            for line in (0..PIN_STRIP).step_by(8) {
                ask(angles, AHEAD + line);
            }
        }
        let (mut pins, mut drive, mut motion) = ([zeros(); 2], zeros(), [zeros(); 3]);
        find_pins(angles, turn, &mut pins, &mut too_large);
        if in_numbers && is_angle {
            for i in 0..PIN_STRIP {
                drive[i] = T::from_f64(angles[i]);
            }
        }
        let drive = in_numbers.then_some(&drive);
        find_motion(&joint, range, &pins, drive, needed, &mut motion);
        let [rotations, ratios, accelerations] = &motion;
        match &mut rotation {
            Some(rotation) if !in_numbers && is_angle => {
                let mut words = [W::default(); PIN_STRIP];
                for i in 0..PIN_STRIP {
                    words[i] = W::near(angles[i] + rotations[i].value().into());
                }
                rotation.put_words(first, &words);
            }
            rotation => put(rotation, first, rotations),
        }
        put(&mut ratio, first, ratios);
        put(&mut acceleration, first, accelerations);
    }
    !too_large.any()
}

/// Sine and cosine of the input angles of a strip, up to a common factor.
#[inline(always)]
fn find_pins<T: Number>(
    angles: &[f64],
    turn: Option<[T; 2]>,
    [sine, cosine]: &mut [Numbers<T>; 2],
    too_large: &mut LargeFractionFlag,
) {
    for i in 0..PIN_STRIP {
        let phase = reduction::turn_fraction_q30(angles[i]);
        too_large.accumulate(phase);
        cosine[i] = T::of_bits(phase);
    }
    for i in 0..PIN_STRIP {
        (sine[i], cosine[i]) = PinLine::sin_cos(T::from_turn_fraction(cosine[i].bits()));
    }
    if let Some(turn) = turn {
        for i in 0..PIN_STRIP {
            (sine[i], cosine[i]) = turned_pin((sine[i], cosine[i]), turn);
        }
    }
}

/// Angle error, speed ratio and acceleration ratio of a strip, as far as they are needed. The errors
/// are added to `drive` if it is given.
#[inline(always)]
fn find_motion<T: Number>(
    joint: &JointConstants<T>,
    range: AtanRange,
    [sine, cosine]: &[Numbers<T>; 2],
    drive: Option<&Numbers<T>>,
    [rotation, ratio, acceleration]: [bool; 3],
    [rotations, ratios, accelerations]: &mut [Numbers<T>; 3],
) {
    macro_rules! by {
        ($atan:expr) => {
            if acceleration {
                for i in 0..PIN_STRIP {
                    let ((y, x), rates) = joint::motion(joint, sine[i], cosine[i]);
                    rotations[i] = after(drive, i, $atan(y, x));
                    (ratios[i], accelerations[i]) = rates;
                }
            } else {
                for i in 0..PIN_STRIP {
                    let (y, x) = joint::error_tangent(joint, sine[i], cosine[i]);
                    rotations[i] = after(drive, i, $atan(y, x));
                }
            }
        };
    }
    if rotation {
        match range {
            AtanRange::Hundredth => by!(T::atan_hundredth),
            AtanRange::Tenth => by!(T::atan_tenth),
            _ => by!(T::atan_third),
        }
    }
    if acceleration && !rotation {
        for i in 0..PIN_STRIP {
            (ratios[i], accelerations[i]) = joint::rates(joint, sine[i], cosine[i]);
        }
    } else if ratio && !acceleration {
        for i in 0..PIN_STRIP {
            (ratios[i], _) = joint::rates(joint, sine[i], cosine[i]);
        }
    }
}

/// The drive angle of a sample plus an angle error, or the error alone.
#[inline(always)]
fn after<T: Number>(drive: Option<&Numbers<T>>, i: usize, error: T) -> T {
    if let Some(drive) = drive { drive[i] + error } else { error }
}

/// Stores the numbers of a strip as words, if there is a plane for them.
#[inline(always)]
fn put<T: Number, W: Float>(plane: &mut Option<Words<'_, W>>, first: usize, numbers: &Numbers<T>) {
    if let Some(plane) = plane {
        let mut words = [W::default(); PIN_STRIP];
        for i in 0..PIN_STRIP {
            words[i] = W::near(numbers[i].value().into());
        }
        plane.put_words(first, &words);
    }
}

#[inline(always)]
fn zeros<T: Number>() -> Numbers<T> {
    [T::from_f64(0.0); PIN_STRIP]
}
