//! The loops that compute torsion parts.

use crate::mechanics::moment::{Pose, TorsionParts};
use crate::number::float::Real;
use crate::number::storage::{View, ViewMut};
use crate::number::strips::{Same, Strips};
use crate::run::map::over_sin_cos;
use crate::sincos::array::SinCosBlocks;

/// A joint's torsion multiplied by the squares and the product of its pin's sine and cosine.
#[inline(always)]
pub(crate) fn of_torsion<T: Real>(
    at: impl Strips<Value = Pose<T>>,
    pins: impl SinCosBlocks<T>,
    torsion: View<'_, T>,
    parts: [ViewMut<'_, T>; 3],
) {
    over_sin_cos(
        pins,
        (at, torsion),
        parts,
        #[inline(always)]
        |(pose, torsion), s, c| {
            let TorsionParts { sine2, cosine2, product } = pose.parts(torsion, s, c);
            [sine2, cosine2, product]
        },
    );
}

/// Support moments of its shafts that a joint adds, in axes that turn with these, from
/// cosine and sine of its driving shaft's phase.
#[inline(always)]
pub(crate) fn turning_supports<T: Real>(
    at: impl Strips<Value = (Pose<T>, [T; 2])>,
    pins: impl SinCosBlocks<T>,
    torsion: View<'_, T>,
    parts: [ViewMut<'_, T>; 3],
) {
    over_sin_cos(
        pins,
        (at, torsion),
        parts,
        #[inline(always)]
        |((pose, phase), torsion), s, c| pose.turning_supports(phase, torsion, s, c),
    );
}

/// The torsion parts of the drive shaft, if its torsion is the power divided by its speed.
#[inline(always)]
pub(crate) fn of_drive<T: Real>(
    pins: impl SinCosBlocks<T>,
    power: View<'_, T>,
    parts: [ViewMut<'_, T>; 3],
) {
    over_sin_cos(
        pins,
        power,
        parts,
        #[inline(always)]
        |power, s, c| {
            let TorsionParts { sine2, cosine2, product } = TorsionParts::new(power, s, c);
            [sine2, cosine2, product]
        },
    );
}

/// The inverse of each pin's squared length.
#[inline(always)]
pub(crate) fn inverse_squares<T: Real>(pins: impl SinCosBlocks<T>, out: ViewMut<'_, T>) {
    over_sin_cos(
        pins,
        Same(()),
        out,
        #[inline(always)]
        |(), s, c| s.mul_add(s, c.square()).recip(),
    );
}

/// The torsion parts of a joint, multiplied by the determinant of the map before it, from its power
/// and the inverse of each pin's squared length.
#[inline(always)]
pub(crate) fn of_power<T: Real>(
    at: impl Strips<Value = Pose<T>>,
    pins: impl SinCosBlocks<T>,
    inputs: (View<'_, T>, View<'_, T>),
    parts: [ViewMut<'_, T>; 3],
) {
    over_sin_cos(
        pins,
        (at, inputs),
        parts,
        #[inline(always)]
        |(pose, (power, inverse)), s, c| {
            let TorsionParts { sine2, cosine2, product } = pose.power_parts(power * inverse, s, c);
            [sine2, cosine2, product]
        },
    );
}
