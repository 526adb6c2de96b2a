//! Sines and cosines of the drive angles of a chunk.
#![allow(clippy::needless_range_loop, reason = "an iterator hides that its count is in range")]

use std::iter::once;

use crate::input::sweep::{AngleReduction, Sweep};
use crate::mechanics::chain::Offset;
use crate::mechanics::exact::ExactAngle;
use crate::mechanics::turning::TurnMatrix;
use crate::number::double_double::DoubleDouble;
use crate::number::float::Real;
use crate::number::reduction::{self, LargeAngleFlag, LargeFractionFlag};
use crate::number::series;
use crate::number::storage::{View, ViewMut};
use crate::number::strips::At;
use crate::number::trig::{self, Angle};

/// The drive angles of a chunk.
#[derive(Clone, Copy)]
pub(crate) enum DriveAngles<'a> {
    /// An array of angles.
    Array(&'a [f64]),
    /// An array of angles and one of their error terms.
    Sums(&'a [f64], &'a [f64]),
    /// The angles of a sweep from this sample on.
    Sweep(&'a Sweep, usize),
    /// The angles of a sweep at these samples.
    Selected(&'a Sweep, &'a [f64]),
}

/// The number of a sweep's sample as a double. It is a sum because few machines convert 64-bit
/// integers in vectors.
#[inline(always)]
pub(crate) fn sample_number(first: usize, i: usize) -> f64 {
    first as f64 + f64::from(i as u32)
}

/// Sines and cosines of a chunk: of the drive angle, up to a common factor, or of twice the drive
/// angle.
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

/// The source of a loop's sines and cosines, in consecutive blocks of samples.
pub(crate) trait SinCosBlocks<T>: Copy {
    type SinCosBlock: SinCosBlock<T>;

    /// The same source, perhaps without the signs of sines and cosines.
    type Unsigned: SinCosBlocks<T>;

    /// Whether they are computed by rotations of a sweep's groups.
    const FROM_SWEEP: bool = false;

    /// Whether the loop finds them itself.
    const FRESH: bool = false;

    /// The same sines and cosines for formulas in their squares, which need no signs.
    fn unsigned(self) -> Self::Unsigned;

    /// The angles of whole steps of such a sweep, as many as the longest block.
    fn turns(&self) -> View<'_, DoubleDouble> {
        View::EMPTY
    }

    /// Each block and the number of its first sample.
    fn parts(self) -> impl Iterator<Item = (usize, Self::SinCosBlock)>;
}

/// Sines and cosines of consecutive samples.
pub(crate) trait SinCosBlock<T>: Copy {
    fn len(&self) -> usize;

    /// A part of the block.
    fn part(&self, start: usize, length: usize) -> Self;

    fn get(&self, i: usize) -> (T, T);

    /// Requests the memory of samples from `i` on, which may lie behind the block, and is read in a
    /// while.
    #[inline(always)]
    fn ask(&self, _: usize, _: usize) {}
}

impl<T: Real> SinCosBlocks<T> for SinCos<'_, T> {
    type SinCosBlock = Self;
    type Unsigned = Self;

    #[inline(always)]
    fn unsigned(self) -> Self {
        self
    }

    #[inline(always)]
    fn parts(self) -> impl Iterator<Item = (usize, Self)> {
        once((0, self))
    }
}

impl<T: Real> SinCosBlock<T> for SinCos<'_, T> {
    #[inline(always)]
    fn part(&self, start: usize, length: usize) -> Self {
        Self { sine: self.sine.part(start, length), cosine: self.cosine.part(start, length) }
    }

    #[inline(always)]
    fn len(&self) -> usize {
        self.len()
    }

    #[inline(always)]
    fn get(&self, i: usize) -> (T, T) {
        self.get(i)
    }
}

/// Which sines and cosines to compute.
pub(crate) trait SinCosKind {
    /// Whether they are of twice the drive angle.
    const DOUBLE_ANGLE: bool = false;

    /// Sine and cosine of a reduced angle.
    fn sin_cos<T: Angle>(reduced: (T, u64)) -> (T, T);
}

/// Pins as lines: sine and cosine up to a common factor.
pub(crate) struct PinLine;

impl SinCosKind for PinLine {
    #[inline(always)]
    fn sin_cos<T: Angle>(reduced: (T, u64)) -> (T, T) {
        trig::pin(reduced)
    }
}

/// Pins with their sense: sine and cosine up to a common positive factor.
pub(crate) struct PinSense;

impl SinCosKind for PinSense {
    #[inline(always)]
    fn sin_cos<T: Angle>(reduced: (T, u64)) -> (T, T) {
        trig::directed_pin(reduced)
    }
}

/// Sine and cosine with nearly all digits of a double-double.
pub(crate) struct WideSinCos;

impl SinCosKind for WideSinCos {
    #[inline(always)]
    fn sin_cos<T: Angle>((remainder, quadrant): (T, u64)) -> (T, T) {
        let [high, low] = remainder.words();
        let remainder = DoubleDouble::new(high.into(), low.into());
        let (sine, cosine) = series::sin_cos((remainder, quadrant));
        (T::from_double_double(sine), T::from_double_double(cosine))
    }
}

/// Sine and cosine.
pub(crate) struct PlainSinCos;

impl SinCosKind for PlainSinCos {
    #[inline(always)]
    fn sin_cos<T: Angle>(reduced: (T, u64)) -> (T, T) {
        trig::sin_cos_reduced(reduced)
    }
}

/// Sine and cosine of twice the drive angle.
pub(crate) struct DoubleAngleSinCos;

impl SinCosKind for DoubleAngleSinCos {
    const DOUBLE_ANGLE: bool = true;

    #[inline(always)]
    fn sin_cos<T: Angle>(reduced: (T, u64)) -> (T, T) {
        trig::sin_cos_reduced(reduced)
    }
}

/// Computes sine and cosine of each angle. Angles that are too large for the fast reduction take the
/// exact one; others beside them keep their bits.
///
/// `coarse` pins have an absolute and not a relative error of one rounding, which suffices for
/// moderate bends.
#[inline(always)]
pub(crate) fn fill_sin_cos<K: SinCosKind, T: Angle>(
    drive: DriveAngles<'_>,
    coarse: bool,
    sine: ViewMut<'_, T>,
    cosine: ViewMut<'_, T>,
) {
    let length = sine.len();
    let (mut sine, mut cosine) = (sine.cut(length), cosine.cut(length));
    match drive {
        DriveAngles::Array(angle) => {
            let angle = &angle[..length];
            if T::PRECISION.costs().turn_fractions && coarse {
                return coarse_sin_cos::<K, T>(angle, sine, cosine);
            }
            let mut too_large = LargeAngleFlag::for_quadrants();
            for i in 0..length {
                let reduced = T::reduce(multiple::<K>(angle[i]));
                too_large.accumulate(reduced.1);
                set_reduced::<K, T>(&mut sine, &mut cosine, i, reduced);
            }
            if too_large.any() {
                let set = set_reduced::<K, T>;
                replace_large::<K, T>(angle, sine.reborrow(), cosine.reborrow(), set);
            }
        }
        DriveAngles::Sums(angle, rest) => {
            let (angle, rest) = (&angle[..length], &rest[..length]);
            let multiple = if K::DOUBLE_ANGLE { 2.0 } else { 1.0 };
            let mut too_large = LargeAngleFlag::for_quadrants();
            for i in 0..length {
                let sum = DoubleDouble::new(angle[i], rest[i]).scaled(multiple);
                let (r, quadrant) = reduction::reduce_double_double(sum);
                too_large.accumulate(quadrant);
                let reduced = (T::from_double_double(r), quadrant);
                set_reduced::<K, T>(&mut sine, &mut cosine, i, reduced);
            }
            if too_large.any() {
                for i in 0..length {
                    let sum = DoubleDouble::new(angle[i], rest[i]).scaled(multiple);
                    let (r, quadrant) = reduction::reduce_any_sum(sum);
                    let reduced = (T::from_double_double(r), quadrant);
                    set_reduced::<K, T>(&mut sine, &mut cosine, i, reduced);
                }
            }
        }
        DriveAngles::Sweep(sweep, first) => {
            let sweep = if K::DOUBLE_ANGLE { sweep.double_angle() } else { *sweep };
            match sweep.reduction() {
                AngleReduction::OfTurns { per_turn, inverse, quarter } => {
                    for i in 0..length {
                        let i_th = sample_number(first, i);
                        let (r, quadrant) =
                            AngleReduction::of_turns(per_turn, inverse, quarter, i_th);
                        let reduced = (T::from_double_double(r), quadrant);
                        set_reduced::<K, T>(&mut sine, &mut cosine, i, reduced);
                    }
                }
                AngleReduction::OfAngles(sweep) => {
                    for i in 0..length {
                        let (r, quadrant) =
                            AngleReduction::of_angles(&sweep, sample_number(first, i));
                        let reduced = (T::from_double_double(r), quadrant);
                        set_reduced::<K, T>(&mut sine, &mut cosine, i, reduced);
                    }
                }
            }
        }
        DriveAngles::Selected(sweep, samples) => {
            let reduction = if K::DOUBLE_ANGLE { sweep.double_angle() } else { *sweep }.reduction();
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

/// Sine and cosine of the sum of each drive angle and an offset, whose relative error stays small
/// next to their zeros. Returns whether any sum lost too many digits for that.
#[inline(always)]
pub(crate) fn fill_turned<K: SinCosKind, T: Angle>(
    at: impl At<Value = Offset>,
    drive: DriveAngles<'_>,
    sine: ViewMut<'_, T>,
    cosine: ViewMut<'_, T>,
) -> bool {
    let length = sine.len();
    let (mut sine, mut cosine) = (sine.cut(length), cosine.cut(length));
    let mut near = false;
    match drive {
        DriveAngles::Array(angle) => {
            let angle = &angle[..length];
            let mut too_large = LargeAngleFlag::for_quadrants();
            for i in 0..length {
                let reduced = reduction::reduce_double_double(DoubleDouble::exact(angle[i]));
                too_large.accumulate(reduced.1);
                let (s, c, lost) = turned::<K, T>(at.at(i), reduced);
                near |= lost;
                sine.set(i, s);
                cosine.set(i, c);
            }
            if too_large.any() {
                for i in 0..length {
                    let (s, c, lost) = turned::<K, T>(at.at(i), reduction::reduce_any(angle[i]));
                    near |= lost;
                    sine.set(i, s);
                    cosine.set(i, c);
                }
            }
        }
        DriveAngles::Sums(angle, rest) => {
            let (angle, rest) = (&angle[..length], &rest[..length]);
            let mut too_large = LargeAngleFlag::for_quadrants();
            for i in 0..length {
                let sum = DoubleDouble::new(angle[i], rest[i]);
                let reduced = reduction::reduce_double_double(sum);
                too_large.accumulate(reduced.1);
                let (s, c, lost) = turned::<K, T>(at.at(i), reduced);
                near |= lost;
                sine.set(i, s);
                cosine.set(i, c);
            }
            if too_large.any() {
                for i in 0..length {
                    let sum = DoubleDouble::new(angle[i], rest[i]);
                    let (s, c, lost) = turned::<K, T>(at.at(i), reduction::reduce_any_sum(sum));
                    near |= lost;
                    sine.set(i, s);
                    cosine.set(i, c);
                }
            }
        }
        DriveAngles::Sweep(sweep, first) => {
            let reduction = sweep.reduction();
            for i in 0..length {
                let (s, c, lost) = turned::<K, T>(at.at(i), reduction.of(sample_number(first, i)));
                near |= lost;
                sine.set(i, s);
                cosine.set(i, c);
            }
        }
        DriveAngles::Selected(sweep, samples) => {
            let (reduction, samples) = (sweep.reduction(), &samples[..length]);
            for i in 0..length {
                let (s, c, lost) = turned::<K, T>(at.at(i), reduction.of(samples[i]));
                near |= lost;
                sine.set(i, s);
                cosine.set(i, c);
            }
        }
    }
    near
}

/// Sine and cosine of the sum of a reduced angle and an offset, and whether it has lost digits. As
/// a closure of the loops it would be compiled without their instruction set.
#[inline(always)]
fn turned<K: SinCosKind, T: Angle>(offset: Offset, reduced: (DoubleDouble, u64)) -> (T, T, bool) {
    let (r, quadrant) = offset.after(reduced, K::DOUBLE_ANGLE);
    let (s, c) = K::sin_cos((T::from_double_double(r), quadrant));
    (s, c, offset.loses_digits((r, quadrant)))
}

impl DriveAngles<'_> {
    /// The angle of a sample, reduced.
    pub(crate) fn reduced(&self, i: usize) -> (DoubleDouble, u64) {
        match self {
            Self::Array(angle) => reduction::reduce_any(angle[i]),
            Self::Sums(angle, rest) => {
                reduction::reduce_any_sum(DoubleDouble::new(angle[i], rest[i]))
            }
            Self::Sweep(sweep, first) => sweep.reduction().of(sample_number(*first, i)),
            Self::Selected(sweep, samples) => sweep.reduction().of(samples[i]),
        }
    }

    /// The angle of a sample in rad; NaN if it is not finite.
    #[inline(always)]
    pub(crate) fn angle(&self, i: usize) -> f64 {
        match self {
            Self::Array(angle) | Self::Sums(angle, _) => angle[i].mul_add(0.0, angle[i]),
            Self::Sweep(sweep, first) => sweep.angle(sample_number(*first, i)).value(),
            Self::Selected(sweep, samples) => sweep.angle(samples[i]).value(),
        }
    }

    /// The angle of a sample with all its digits.
    pub(crate) fn exact(&self, i: usize) -> ExactAngle {
        match self {
            Self::Array(angle) => ExactAngle { parts: [angle[i], 0.0], quarters: 0 },
            Self::Sums(angle, rest) => ExactAngle { parts: [angle[i], rest[i]], quarters: 0 },
            Self::Sweep(..) | Self::Selected(..) => {
                let (DoubleDouble { high, low }, quarters) = self.reduced(i);
                ExactAngle { parts: [high, low], quarters }
            }
        }
    }
}

/// The multiple of an angle that is reduced.
#[inline(always)]
fn multiple<K: SinCosKind>(angle: f64) -> f64 {
    if K::DOUBLE_ANGLE { angle + angle } else { angle }
}

/// Sine and cosine from turn fractions; of angles that are too large for these, from remainders.
#[inline(always)]
fn coarse_sin_cos<K: SinCosKind, T: Angle>(
    angle: &[f64],
    sine: ViewMut<'_, T>,
    cosine: ViewMut<'_, T>,
) {
    let length = angle.len();
    let (mut sine, mut cosine) = (sine.cut(length), cosine.cut(length));
    let mut too_large = LargeFractionFlag::default();
    for i in 0..length {
        let phase = reduction::turn_fraction_q30(angle[i]);
        too_large.accumulate(phase);
        cosine.set_high(i, T::of_bits(phase));
    }
    for i in 0..length {
        let reduced = T::from_turn_fraction(cosine.get_high(i).bits());
        set_pin::<K, T>(&mut sine, &mut cosine, i, reduced);
    }
    if !too_large.any() {
        return;
    }
    let mut beyond = LargeAngleFlag::for_quadrants();
    for i in 0..length {
        let mut too_large = LargeFractionFlag::default();
        too_large.accumulate(reduction::turn_fraction_q30(angle[i]));
        let reduced = T::reduce(multiple::<K>(angle[i]));
        beyond.accumulate(reduced.1);
        let (s, c) = K::sin_cos(reduced);
        // Stores without a condition keep the loop in vectors.
        let (coarse_s, coarse_c) = (sine.get(i), cosine.get(i));
        sine.set(i, if too_large.any() { s } else { coarse_s });
        cosine.set(i, if too_large.any() { c } else { coarse_c });
    }
    if beyond.any() {
        replace_large::<K, T>(angle, sine, cosine, set_pin::<K, T>);
    }
}

/// Sets the sines and cosines of angles that are too large for the fast reduction.
fn replace_large<K: SinCosKind, T: Angle>(
    angle: &[f64],
    mut sine: ViewMut<'_, T>,
    mut cosine: ViewMut<'_, T>,
    set: impl Fn(&mut ViewMut<'_, T>, &mut ViewMut<'_, T>, usize, (T, u64)),
) {
    for (i, &x) in angle.iter().enumerate() {
        let mut too_large = LargeAngleFlag::for_quadrants();
        too_large.accumulate(reduction::reduce(multiple::<K>(x)).1);
        if too_large.any() {
            let reduced = reduction::reduce_any(x);
            let (r, quadrant) =
                if K::DOUBLE_ANGLE { reduction::double_angle(reduced) } else { reduced };
            set(&mut sine, &mut cosine, i, (T::from_double_double(r), quadrant));
        }
    }
}

/// Stores a reduced angle, or its pin. Angles are reduced as doubles, and a vector holds half as
/// many doubles as single-precision numbers, so some types compute pins in a second loop.
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
    let (s, c) = K::sin_cos(reduced);
    sine.set(i, s);
    cosine.set(i, c);
}

/// Sine and cosine of the equivalent joint's input angle `α + φ`, given cosine and sine of `φ`.
#[inline(always)]
pub(crate) fn rotate<T: Real>(
    at: impl At<Value = [T; 2]>,
    pins: SinCos<'_, T>,
    sine: ViewMut<'_, T>,
    cosine: ViewMut<'_, T>,
) {
    let length = pins.len();
    let (mut sine, mut cosine) = (sine.cut(length), cosine.cut(length));
    for i in 0..length {
        let (s, c) = turned_pin(pins.get(i), at.at(i));
        sine.set(i, s);
        cosine.set(i, c);
    }
}

/// Sine and cosine of a joint's input angle, multiplied by a positive length, from the pins of the
/// drive. Returns whether any have lost digits.
#[inline(always)]
pub(crate) fn turn<T: Real>(
    at: impl At<Value = TurnMatrix<T>>,
    pins: SinCos<'_, T>,
    sine: ViewMut<'_, T>,
    cosine: ViewMut<'_, T>,
) -> bool {
    let length = pins.len();
    let (mut sine, mut cosine) = (sine.cut(length), cosine.cut(length));
    let mut near = false;
    for i in 0..length {
        let ((s, c), matrix) = (pins.get(i), at.at(i));
        let turned = matrix.turn(s, c);
        near |= matrix.loses_digits(turned);
        sine.set(i, turned.0);
        cosine.set(i, turned.1);
    }
    near
}

/// A pin turned by the angle with this cosine and sine.
#[inline(always)]
pub(crate) fn turned_pin<T: Real>((s, c): (T, T), [turn_cos, turn_sin]: [T; 2]) -> (T, T) {
    (s.mul_add(turn_cos, c * turn_sin), c.mul_add(turn_cos, -(s * turn_sin)))
}
