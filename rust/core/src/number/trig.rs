//! Branch-free sine, cosine and tangent for each number type.
//!
//! Loops over these functions vectorise for every instruction set. Every step is an exactly rounded
//! operation, `mul_add` included, so the bits do not depend on the instruction set.
//!
//! The polynomials are minimax fits in `z = r²` to the stated relative error of the function itself
//! (Remez exchange in 50-digit arithmetic). The tests check them against an independent evaluation.

use crate::number::Precision;
use crate::number::double_double::DoubleDouble;
use crate::number::float::{Float, Real};
use crate::number::reduction::{self, LargeAngleFlag};

/// `sin r = r − r z/6 + r z² P(z)` for `|r| ≤ 0.7862`, relative error 2⁻⁶⁸.
const SINE: [f64; 6] = [
    0.008_333_333_333_333_33,
    -0.000_198_412_698_412_608_75,
    2.755_731_921_669_286e-6,
    -2.505_210_547_038_130_6e-8,
    1.605_842_905_201_138_6e-10,
    -7.581_457_627_714_003e-13,
];

/// `cos r = 1 − z/2 + z²/24 + z³ P(z)` for `|r| ≤ 0.7862`, relative error 2⁻⁶³.
const COSINE: [f64; 5] = [
    -0.001_388_888_888_888_389_1,
    2.480_158_729_476_398e-5,
    -2.755_731_570_261_458e-7,
    2.087_588_833_417_471_7e-9,
    -1.136_742_930_407_458_1e-11,
];

const SIXTH: DoubleDouble = DoubleDouble::new(0.166_666_666_666_666_66, 9.251_858_538_542_97e-18);
const TWENTY_FOURTH: DoubleDouble =
    DoubleDouble::new(0.041_666_666_666_666_664, 2.312_964_634_635_743e-18);

/// `tan r = r (1 + z P(z))/(1 + z Q(z))` for `|r| ≤ 0.7862`.
struct Tangent<const P: usize, const Q: usize, Float> {
    numerator: [Float; P],
    denominator: [Float; Q],
}

impl<const P: usize, const Q: usize, T: Real> Tangent<P, Q, T> {
    #[inline(always)]
    fn of(&self, r: T) -> (T, T) {
        let z = r * r;
        let numerator = (r * z).mul_add(polynomial(z, &self.numerator), r);
        (numerator, z.mul_add(polynomial(z, &self.denominator), T::from_f64(1.0)))
    }
}

/// Relative error 2⁻⁵⁵·⁴.
const TANGENT: Tangent<3, 3, f64> = Tangent {
    numerator: [-0.128_282_632_120_567_1, 0.002_805_824_821_214_388_8, -7.482_729_016_475_043e-6],
    denominator: [
        -0.461_615_965_453_898_44,
        0.023_344_479_972_454_618,
        -0.000_208_434_626_985_413_96,
    ],
};

/// Relative error 2⁻²⁵·².
const TANGENT_SINGLE: Tangent<1, 2, f32> =
    Tangent { numerator: [-0.095_781_24], denominator: [-0.429_115_06, 0.009_709_465] };

/// Relative error 2⁻⁶². [`TANGENT_LOW`] is the error term of the numerator's first coefficient; the
/// denominator's is exact.
const TANGENT_DOUBLE_DOUBLE: Tangent<4, 3, f64> = Tangent {
    numerator: [
        -0.130_995_154_759_405_24,
        0.003_118_480_826_837_571,
        -1.115_777_944_833_528e-5,
        -1.789_702_604_099_158_7e-8,
    ],
    denominator: [
        -0.464_328_488_092_738_6,
        0.024_561_310_191_083_863,
        -0.000_256_050_065_699_765_5,
    ],
};
const TANGENT_LOW: f64 = -6.724_355_705_919_375e-18;

/// Horner's rule, lowest coefficient first.
#[inline(always)]
pub(crate) fn polynomial<T: Real>(z: T, coefficients: &[T]) -> T {
    let (&last, rest) = coefficients.split_last().expect("a polynomial has a coefficient");
    rest.iter().rev().fold(last, |sum, &coefficient| sum.mul_add(z, coefficient))
}

/// The operations on angles that a number type adds to [`Real`].
pub trait Angle: Real {
    /// The remainder of an angle to the nearest multiple of π/2, and the low bits of that multiple,
    /// for angles up to about 1.7e12.
    fn reduce(angle: f64) -> (Self, u64);

    /// Numerator and denominator of the rational approximation to the tangent of a remainder.
    fn tangent(remainder: Self) -> (Self, Self);

    /// The arithmetic that uses this number type.
    const PRECISION: Precision;

    /// Sine and cosine of a remainder.
    fn sin_cos(remainder: Self) -> (Self, Self);

    /// The number, negated if the lowest bit is one.
    #[must_use]
    fn turned_if(self, bit: u64) -> Self;

    /// Remainder and quadrant of a turn fraction (`reduction::turn_fraction_q30`).
    fn from_turn_fraction(phase: u64) -> (Self, u64);

    /// Stores the lowest bits of a quadrant or turn fraction as a number.
    fn of_bits(bits: u64) -> Self;

    /// The bits stored by [`Angle::of_bits`].
    fn bits(self) -> u64;

    /// The drive angle plus `self`, an angle error.
    fn after<W: Float>(self, drive: DoubleDouble) -> W;

    /// `tan(a + b)` as numerator and denominator, from both tangents with their error terms, for
    /// `|a + b| < 1.2`.
    fn tangent_of_sum(a: [Self::Float; 2], b: [Self::Float; 2]) -> (Self, Self);
}

macro_rules! plain {
    ($($float:ident $precision:ident $bits:ident $tangent:ident)*) => {$(
        impl Angle for $float {
            #[inline(always)]
            fn reduce(angle: f64) -> (Self, u64) {
                let (remainder, quadrant) = reduction::reduce(angle);
                (remainder as Self, quadrant)
            }

            #[inline(always)]
            fn tangent(r: Self) -> (Self, Self) {
                $tangent.of(r)
            }

            const PRECISION: Precision = Precision::$precision;

            #[inline(always)]
            fn sin_cos(remainder: Self) -> (Self, Self) {
                let (sine, cosine) = sin_cos_of_double(remainder.into());
                (sine as Self, cosine as Self)
            }

            #[inline(always)]
            fn turned_if(self, bit: u64) -> Self {
                Self::from_bits(self.to_bits() ^ (bit as $bits) << ($bits::BITS - 1))
            }

            #[inline(always)]
            fn from_turn_fraction(phase: u64) -> (Self, u64) {
                let (remainder, quadrant) = reduction::from_turn_fraction(phase as u32);
                (Self::from(remainder), quadrant)
            }

            #[inline(always)]
            fn of_bits(bits: u64) -> Self {
                Self::from_bits(bits as $bits)
            }

            #[inline(always)]
            fn bits(self) -> u64 {
                u64::from(self.to_bits())
            }

            #[inline(always)]
            fn after<W: Float>(self, drive: DoubleDouble) -> W {
                W::sum(drive, self.into())
            }

            // The first sum is exact where it cancels.
            #[inline(always)]
            fn tangent_of_sum([a, a_low]: [Self; 2], [b, b_low]: [Self; 2]) -> (Self, Self) {
                ((a + b) + (a_low + b_low), (-a).mul_add(b, 1.0))
            }
        }
    )*};
}

plain!(f32 Single u32 TANGENT_SINGLE f64 Double u64 TANGENT);

impl Angle for DoubleDouble {
    #[inline(always)]
    fn reduce(angle: f64) -> (Self, u64) {
        reduction::reduce_double_double(Self::exact(angle))
    }

    // Only the leading terms need error terms, because the others are small compared with them.
    #[inline(always)]
    fn tangent(r: Self) -> (Self, Self) {
        let [first, tail @ ..] = &TANGENT_DOUBLE_DOUBLE.numerator;
        let Self { high: z, low } = Self::two_product(r.high, r.high);
        let z_low = (r.high + r.high).mul_add(r.low, low);
        let times_z = |sum: Self| {
            let Self { high, low } = Self::two_product(z, sum.high);
            Self { high, low: low + z.mul_add(sum.low, z_low * sum.high) }
        };
        let mut sum = Self::fast_two_sum(*first, z * polynomial(z, tail));
        sum.low += TANGENT_LOW;
        let part = times_z(sum);
        let step = Self::two_product(r.high, part.high);
        let low = step.low + r.high.mul_add(part.low, r.low.mul_add(part.high, r.low));
        let Self { high, low: rounding } = Self::fast_two_sum(r.high, step.high);
        let numerator = Self { high, low: rounding + low };

        let [first, tail @ ..] = &TANGENT_DOUBLE_DOUBLE.denominator;
        let part = times_z(Self::fast_two_sum(*first, z * polynomial(z, tail)));
        let Self { high, low } = Self::fast_two_sum(1.0, part.high);
        (numerator, Self { high, low: low + part.low })
    }

    const PRECISION: Precision = Precision::DoubleDouble;

    // Within 2⁻⁵⁸: each polynomial is small compared with the term before it.
    #[inline(always)]
    fn sin_cos(r: Self) -> (Self, Self) {
        let Self { high: z, low } = Self::two_product(r.high, r.high);
        let z_low = (r.high + r.high).mul_add(r.low, low);

        let half = (-0.5_f64).mul_add(z, 1.0);
        let low = (-0.5_f64).mul_add(z, 1.0 - half);
        let rest = z.mul_add(polynomial(z, &COSINE), TWENTY_FOURTH.high);
        let low = (z * z).mul_add(rest, low);
        let cosine = Self::fast_two_sum(half, (-0.5_f64).mul_add(z_low, low));

        let sum = Self::fast_two_sum(-SIXTH.high, z * polynomial(z, &SINE));
        let part = Self::two_product(z, sum.high);
        let part_low = z_low.mul_add(sum.high, z.mul_add(sum.low - SIXTH.low, part.low));
        let step = Self::two_product(r.high, part.high);
        let low = r.low.mul_add(part.high, r.low) + r.high.mul_add(part_low, step.low);
        let Self { high, low: rounding } = Self::fast_two_sum(r.high, step.high);
        (Self { high, low: rounding + low }, cosine)
    }

    #[inline(always)]
    fn turned_if(self, bit: u64) -> Self {
        Self { high: self.high.turned_if(bit), low: self.low.turned_if(bit) }
    }

    #[inline(always)]
    fn from_turn_fraction(phase: u64) -> (Self, u64) {
        let (remainder, quadrant) = f64::from_turn_fraction(phase);
        (Self::exact(remainder), quadrant)
    }

    #[inline(always)]
    fn of_bits(bits: u64) -> Self {
        Self::exact(f64::from_bits(bits))
    }

    #[inline(always)]
    fn bits(self) -> u64 {
        self.high.to_bits()
    }

    #[inline(always)]
    fn after<W: Float>(self, drive: DoubleDouble) -> W {
        W::near((drive + self).value())
    }

    #[inline(always)]
    fn tangent_of_sum([a, a_low]: [f64; 2], [b, b_low]: [f64; 2]) -> (Self, Self) {
        let (a, b) = (Self::new(a, a_low), Self::new(b, b_low));
        let product = a * b;
        let Self { high, low } = Self::fast_two_sum(1.0, -product.high);
        // Where the sum cancels, its error term is large, and the inverse tangent would lose part
        // of it.
        ((a + b).rounded(), Self { high, low: low - product.low })
    }
}

/// A vector parallel or antiparallel to `(sin x, cos x)`, of a length between 0.9 and 1.1.
///
/// It suffices for quantities such as a tangent or a ratio of squares, which depend neither on its
/// length nor on its sense. A rational tangent costs half as much as a sine and a cosine.
#[inline(always)]
pub(crate) fn pin<T: Angle>((remainder, quadrant): (T, u64)) -> (T, T) {
    let (s, c) = T::tangent(remainder);
    let odd = quadrant & 1;
    let (s, c) = if odd == 1 { (c, s) } else { (s, c) };
    (s, c.turned_if(odd))
}

/// A vector parallel to `(sin x, cos x)`, for quantities that depend on the sense of a pin.
#[inline(always)]
pub(crate) fn directed_pin<T: Angle>(reduced: (T, u64)) -> (T, T) {
    let (s, c) = pin(reduced);
    let against = reduced.1 >> 1 & 1;
    (s.turned_if(against), c.turned_if(against))
}

/// Sine and cosine of a reduced angle.
#[inline(always)]
pub(crate) fn sin_cos_reduced<T: Angle>((remainder, quadrant): (T, u64)) -> (T, T) {
    let (s, c) = T::sin_cos(remainder);
    let (odd, half) = (quadrant & 1, quadrant >> 1 & 1);
    let (s, c) = if odd == 1 { (c, s) } else { (s, c) };
    (s.turned_if(half), c.turned_if(half ^ odd))
}

/// Sine and cosine of any angle, each within 0.51 ulp; infinite angles and NaN give NaN.
///
/// ```
/// let (sine, cosine) = cardan::number::trig::sin_cos(1e300);
/// assert!((sine + 0.8178819121159085).abs() < 1e-15);
/// assert!((cosine + 0.5753861119575491).abs() < 1e-15);
/// ```
pub fn sin_cos(x: f64) -> (f64, f64) {
    let (sine, cosine) = sin_cos_double_double(reduction::reduce_any(x));
    (sine.value(), cosine.value())
}

/// The same as part of a function for some instruction set.
#[inline(always)]
pub(crate) fn inlined_sin_cos(x: f64) -> (f64, f64) {
    let reduced = DoubleDouble::reduce(x);
    let mut too_large = LargeAngleFlag::for_quadrants();
    too_large.accumulate(reduced.1);
    if too_large.any() {
        return sin_cos(x);
    }
    let (sine, cosine) = sin_cos_double_double(reduced);
    (sine.value(), cosine.value())
}

/// Sine and cosine of a reduced angle with their error terms.
#[inline(always)]
pub(crate) fn sin_cos_double_double(
    (remainder, quadrant): (DoubleDouble, u64),
) -> (DoubleDouble, DoubleDouble) {
    let (s, c) = sin_cos_of_remainder(remainder);
    let (odd, half) = (quadrant & 1, quadrant >> 1 & 1);
    let (s, c) = if odd == 1 { (c, s) } else { (s, c) };
    (s.turned_if(half), c.turned_if(half ^ odd))
}

/// `(sin r − r)/(r z)` for `|r| ≤ 0.7862` and `z = r²`.
#[inline(always)]
pub(crate) fn sine_tail(z: f64) -> f64 {
    z.mul_add(polynomial(z, &SINE), -SIXTH.high)
}

/// Sine and cosine of a remainder, with relative errors below 2⁻⁶².
#[inline(always)]
pub(crate) fn sin_cos_of_remainder(r: DoubleDouble) -> (DoubleDouble, DoubleDouble) {
    let z = r.square();
    let sixths = SIXTH.fast_add(DoubleDouble::exact(-(z.high * polynomial(z.high, &SINE))));
    let sine = r.fast_add(-(r * (z * sixths)));
    let rest = TWENTY_FOURTH.fast_add(DoubleDouble::exact(z.high * polynomial(z.high, &COSINE)));
    let head = DoubleDouble::ONE.fast_add(-z.scaled(0.5));
    (sine, head.fast_add(z.square() * rest))
}

/// Sine and cosine of a remainder, each within one ulp.
#[inline(always)]
fn sin_cos_of_double(r: f64) -> (f64, f64) {
    let z = r * r;
    let half = (-0.5_f64).mul_add(z, 1.0);
    let low = (-0.5_f64).mul_add(z, 1.0 - half);
    let rest = z.mul_add(polynomial(z, &COSINE), TWENTY_FOURTH.high);
    ((r * z).mul_add(sine_tail(z), r), half + (z * z).mul_add(rest, low))
}

/// Whether any of the angles is too large for [`Angle::reduce`].
pub(crate) fn any_too_large(angles: impl Iterator<Item = f64>) -> bool {
    let mut too_large = LargeAngleFlag::for_quadrants();
    angles.for_each(|x| too_large.accumulate(reduction::reduce(x).1));
    too_large.any()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Remainders with error terms of half an ulp, and their sines and cosines.
    fn remainders() -> impl Iterator<Item = (DoubleDouble, DoubleDouble, DoubleDouble)> {
        (-392..=392).map(|i| {
            let high = f64::from(i) * 0.002;
            let remainder = DoubleDouble::new(high, high * 2_f64.powi(-54));
            let (sine, cosine) = sin_cos_of_remainder(remainder);
            (remainder, sine, cosine)
        })
    }

    #[test]
    fn error_terms_are_worth_their_words() {
        for (remainder, sine, cosine) in remainders() {
            let ones = sine.square() + cosine.square() - DoubleDouble::ONE;
            assert!(ones.value().abs() < 2_f64.powi(-60), "{remainder:?}");
            let (other_sine, other_cosine) = DoubleDouble::sin_cos(remainder);
            let close =
                |error: DoubleDouble| error.value().abs() <= 2_f64.powi(-57) * sine.value().abs();
            assert!(close(other_sine - sine), "{remainder:?}");
            assert!((other_cosine - cosine).value().abs() < 2_f64.powi(-57), "{remainder:?}");
            let (numerator, denominator) = DoubleDouble::tangent(remainder);
            assert!(close(numerator * cosine - denominator * sine), "{remainder:?}");
        }
    }

    #[test]
    fn tangents_of_sums_are_those_of_turned_pins() {
        let tangent = |sine: DoubleDouble, cosine: DoubleDouble| {
            let quotient = sine / cosine;
            [quotient.high, quotient.low]
        };
        let (_, by_sine, by_cosine) = remainders().nth(500).unwrap();
        for (_, sine, cosine) in remainders() {
            let (y, x) =
                DoubleDouble::tangent_of_sum(tangent(sine, cosine), tangent(by_sine, by_cosine));
            let (turned_sine, turned_cosine) =
                (sine * by_cosine + cosine * by_sine, cosine * by_cosine - sine * by_sine);
            let error = (y * turned_cosine - x * turned_sine).value();
            assert!(error.abs() < 2_f64.powi(-58), "{error:e}");
            assert!(y.value().hypot(x.value()) > 0.5);
            assert_eq!(y.rounded().high, y.high);
        }
    }
}
