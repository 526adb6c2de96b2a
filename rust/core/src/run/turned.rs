//! Shafts and joints with separate sines, which carry error terms.
//!
//! Sine and cosine of a chain's input angle could be rotated from those of the drive. Next to
//! their zeros the rotation cancels, and a steep chain is fast there. The sum of the drive angle and
//! the chain's offset is reduced instead. The few samples whose sum cancels as well are computed
//! with as many digits as it takes.

use crate::mechanics::chain::Offset;
use crate::mechanics::exact::{Chains, ExactSamples, To};
use crate::mechanics::turning::{TurnMatrix, Turning};
use crate::number::Number;
use crate::number::atan::Atan;
use crate::number::double_double::DoubleDouble;
use crate::number::float::{Float, Real};
use crate::number::series;
use crate::number::storage::{Column, ViewMut, views_mut};
use crate::number::strips::{At, Same, Strips};
use crate::plan::route::Route;
use crate::run::constants::{FoldedShaft, GeometryIndex, run_for_geometry, with_constants};
use crate::run::level::{Compiled, Level};
use crate::sincos::array::{self, DoubleAngleSinCos, DriveAngles, PinLine, SinCos};

/// The drivelines of a chunk, in the batch.
#[derive(Clone, Copy)]
pub(crate) struct ChunkLines<'a> {
    pub(crate) chains: Chains<'a>,
    /// The number of each folded driveline.
    pub(crate) numbers: &'a [usize],
    pub(crate) geometry: GeometryIndex,
}

impl<'a> ChunkLines<'a> {
    fn of(self, i: usize) -> usize {
        self.numbers[self.place(i)]
    }

    /// The place of a sample's driveline among the folded ones.
    fn place(self, i: usize) -> usize {
        match self.geometry {
            GeometryIndex::Shared(index) => index,
            GeometryIndex::PerSample => i,
        }
    }

    fn samples(self, to: To) -> ExactSamples<'a> {
        ExactSamples::new(self.chains, to)
    }
}

/// Sine and cosine of a shaft's equivalent input angle, or of twice that angle.
#[allow(clippy::too_many_arguments, reason = "inputs and outputs of one chunk")]
pub(crate) fn find_own_pins<T: Number + Compiled>(
    level: Level,
    shaft: &FoldedShaft<T>,
    number: usize,
    route: Route,
    lines: ChunkLines<'_>,
    drive: DriveAngles<'_>,
    pins: &mut [Column<T>; 2],
    size: usize,
) {
    let (geometry, steep) = (lines.geometry, route == Route::Tangent);
    let offsets = shaft.offsets(geometry, size);
    let near = run_for_geometry::<T, _>(
        level,
        geometry,
        #[inline(always)]
        |geometry, compact, _| {
            with_constants!(compact, geometry, offsets, at => {
                let [sine, cosine] = views_mut(pins, 0, size);
                if steep {
                    array::fill_turned::<PinLine, T>(at, drive, sine, cosine)
                } else {
                    array::fill_turned::<DoubleAngleSinCos, T>(at, drive, sine, cosine)
                }
            })
        },
    );
    if near {
        let at = |i: usize| offsets.at(lines.place(i));
        let [sine, cosine] = views_mut(pins, 0, size);
        mend_pins(lines, number, steep, at, drive, sine, cosine);
    }
}

#[cold]
#[inline(never)]
fn mend_pins<T: Number>(
    lines: ChunkLines<'_>,
    shaft: usize,
    steep: bool,
    at: impl Fn(usize) -> Offset,
    drive: DriveAngles<'_>,
    mut sine: ViewMut<'_, T>,
    mut cosine: ViewMut<'_, T>,
) {
    let mut samples = lines.samples(To::Shaft(shaft));
    for i in 0..sine.len() {
        let offset = at(i);
        if offset.loses_digits(offset.after(drive.reduced(i), !steep)) {
            let (line, angle) = (lines.of(i), drive.exact(i));
            let [c, s] =
                if steep { samples.pin(line, angle) } else { samples.double_angle(line, angle) };
            sine.set(i, T::from_double_double(s));
            cosine.set(i, T::from_double_double(c));
        }
    }
}

/// The part of an angle error below which the shaft's angle has lost digits: it is the difference
/// of drive angle and error.
const SMALL_ANGLE: f64 = 0.25;

/// The part of a turn below which that angle needs more digits than a double-double has.
const SMALLEST_ANGLE: f64 = 1.0 / (1_u64 << 36) as f64;

/// Corrects angles of a shaft that are small because drive angle and angle error cancel.
#[inline(always)]
pub(crate) fn mend_angles<T: Number, W: Float>(
    shaft: &FoldedShaft<T>,
    number: usize,
    route: Route,
    lines: ChunkLines<'_>,
    drive: DriveAngles<'_>,
    out: &mut [W],
) {
    let is_small = |i: usize, angle: W| {
        let (drive, angle): (f64, f64) = (drive.angle(i).abs(), angle.into());
        angle.abs() < SMALL_ANGLE * drive && drive < 2.1
    };
    let mut any = false;
    for (i, &angle) in out.iter().enumerate() {
        any |= is_small(i, angle);
    }
    if any {
        mend_small_angles(shaft, number, route, lines, drive, is_small, out);
    }
}

#[cold]
#[inline(never)]
fn mend_small_angles<T: Number, W: Float>(
    shaft: &FoldedShaft<T>,
    number: usize,
    route: Route,
    lines: ChunkLines<'_>,
    drive: DriveAngles<'_>,
    is_small: impl Fn(usize, W) -> bool,
    out: &mut [W],
) {
    let size = out.len();
    let mut samples = lines.samples(To::Shaft(number));
    let offsets = shaft.offsets(lines.geometry, size);
    for (i, angle) in out.iter_mut().enumerate().filter(|(i, angle)| is_small(*i, **angle)) {
        let index = lines.place(i);
        let k = shaft.k(route == Route::Tangent, lines.geometry, index, size);
        let (offset, reduced) = (offsets.at(index), drive.reduced(i));
        // The shaft's angle is that of w − k e^{−2iφ} w̄.
        let (s, c) = series::sin_cos(reduced);
        let (r, quadrant) = offset.after(reduced, false);
        let (other_s, other_c) = series::sin_cos(offset.after((r, quadrant), false));
        let y = (s + k * other_s).renormalized();
        let x = (c - k * other_c).renormalized();
        let [x, y] = if y.high.abs() < SMALLEST_ANGLE {
            samples.shaft_angle(lines.of(i), drive.exact(i))
        } else {
            [x, y]
        };
        *angle = W::near(DoubleDouble::atan_any(y, x).value());
    }
}

/// Sine and cosine of a joint's input angle, multiplied by a positive length, from the pins of the
/// drive and the joint's map.
pub(crate) fn find_turned<T: Number + Compiled>(
    level: Level,
    at: impl Strips<Value = TurnMatrix<T>>,
    joint: usize,
    lines: ChunkLines<'_>,
    drive: DriveAngles<'_>,
    pins: SinCos<'_, T>,
    turned: &mut [Column<T>; 2],
) {
    let size = pins.len();
    let near = run_for_geometry::<T, _>(
        level,
        lines.geometry,
        #[inline(always)]
        |geometry, compact, _| {
            with_constants!(compact, geometry, at, at => {
                let [sine, cosine] = views_mut(turned, 0, size);
                array::turn(at, pins, sine, cosine)
            })
        },
    );
    if near {
        mend_turned(at, joint, lines, drive, pins, views_mut(turned, 0, size));
    }
}

#[cold]
#[inline(never)]
fn mend_turned<T: Number>(
    at: impl At<Value = TurnMatrix<T>>,
    joint: usize,
    lines: ChunkLines<'_>,
    drive: DriveAngles<'_>,
    pins: SinCos<'_, T>,
    [mut sine, mut cosine]: [ViewMut<'_, T>; 2],
) {
    let mut samples = lines.samples(To::Joint(joint));
    for i in 0..pins.len() {
        let (s, c) = pins.get(i);
        let matrix = at.at(lines.place(i));
        let near = matrix.turn(s, c);
        if matrix.loses_digits(near) {
            let [x, y] = samples.turned(lines.of(i), drive.exact(i));
            // Forces read the length as well, which has its digits.
            let square = near.0.square() + near.1.square();
            let length = (DoubleDouble::of(square) / (x.square() + y.square())).sqrt();
            let length = if length.high > 0.0 { length } else { DoubleDouble::ONE };
            sine.set(i, T::from_double_double(y * length));
            cosine.set(i, T::from_double_double(x * length));
        }
    }
}

/// Corrects acceleration ratios of a shaft beside their zeros, where their terms cancel.
pub(crate) fn mend_accelerations<T: Number>(
    at: &[Turning<T>],
    shaft: usize,
    lines: ChunkLines<'_>,
    drive: DriveAngles<'_>,
    [ratio, acceleration]: &mut [Column<T>; 2],
    size: usize,
) {
    let (ratio, mut acceleration) = (ratio.view(size), acceleration.view_mut(size));
    let mut samples = lines.samples(To::Shaft(shaft));
    for i in 0..size {
        let turning = &at[lines.place(i)];
        if turning.loses_digits(ratio.get(i), acceleration.get(i)) {
            let [_, sine] = samples.double_angle(lines.of(i), drive.exact(i));
            acceleration.set(i, turning.acceleration(ratio.get(i), sine));
        }
    }
}
