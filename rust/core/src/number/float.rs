//! The number types of the kernels: single precision, double precision and double-double.
//!
//! Each formula is written once, over [`Real`].

use std::fmt::Debug;
use std::ops::{Add, Div, Mul, Neg, Sub};

use cardan_memory::Word;

use crate::number::double_double::DoubleDouble;

/// An element of an array: `f64` or `f32`.
pub trait Float: Word + Debug + Default + PartialEq + Send + Sync + Into<f64> {
    /// The value of this type nearest to `x`.
    fn near(x: f64) -> Self;

    /// An angle plus a small angle, in this precision.
    fn sum(angle: DoubleDouble, small: f64) -> Self;
}

impl Float for f64 {
    #[inline(always)]
    fn near(x: f64) -> Self {
        x
    }

    #[inline(always)]
    fn sum(angle: DoubleDouble, small: f64) -> Self {
        angle.high + (angle.low + small)
    }
}

impl Float for f32 {
    #[inline(always)]
    fn near(x: f64) -> Self {
        x as Self
    }

    #[inline(always)]
    fn sum(angle: DoubleDouble, small: f64) -> Self {
        angle.high as Self + (angle.low as Self + small as Self)
    }
}

/// A number type of the kernels.
pub trait Real:
    Copy
    + Debug
    + PartialEq
    + Send
    + Sync
    + 'static
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// The word type of columns and planes; a number has one or two words.
    type Float: Float;

    /// Whether a number has a low word.
    const LOW: bool;

    /// The number with these words. Types without a low word ignore `low`.
    fn from_words(high: Self::Float, low: Self::Float) -> Self;

    /// The words of the number; the low one is zero for types without it.
    fn words(self) -> [Self::Float; 2];

    /// The number nearest to a double-double.
    fn from_double_double(pair: DoubleDouble) -> Self;

    /// The number rounded to one word.
    #[inline(always)]
    fn value(self) -> Self::Float {
        let [high, _] = self.words();
        high
    }

    /// The number nearest to a double.
    #[inline(always)]
    fn from_f64(x: f64) -> Self {
        Self::from_words(Self::Float::near(x), Self::Float::default())
    }

    /// `self · a + b`.
    #[must_use]
    fn mul_add(self, a: Self, b: Self) -> Self;

    /// `self + other` for `|self| ≥ |other|`.
    #[must_use]
    fn fast_add(self, other: Self) -> Self;

    /// `self · a`; a product of zero is positive.
    #[must_use]
    fn times(self, a: Self) -> Self;

    /// Multiplies by a power of two.
    #[must_use]
    fn scaled(self, power: f64) -> Self;

    /// `1/self`.
    #[must_use]
    fn recip(self) -> Self;

    /// `self/divisor`, given the divisor's reciprocal: within one rounding, in single precision
    /// within two.
    #[must_use]
    fn over(self, divisor: Self, inverse: Self) -> Self;

    /// The same by one division, if that costs less.
    #[must_use]
    #[inline(always)]
    fn quotient(self, divisor: Self) -> Self {
        self.over(divisor, divisor.recip())
    }

    /// [`Real::quotient`], with its bits, given the divisor's reciprocal.
    #[must_use]
    #[inline(always)]
    fn quotient_by(self, divisor: Self, inverse: Self) -> Self {
        self.over(divisor, inverse)
    }

    /// `a/divisor` and `b/divisor`.
    fn both_over(a: Self, b: Self, divisor: Self) -> [Self; 2];

    /// `√self`.
    #[must_use]
    fn sqrt(self) -> Self;

    /// `|self|`.
    #[must_use]
    fn abs(self) -> Self;

    /// The magnitude of `self` with the sign of `sign`.
    #[must_use]
    fn copysign(self, sign: Self) -> Self;

    /// Whether `self > other`.
    fn exceeds(self, other: Self) -> bool;

    /// `self²`.
    #[must_use]
    #[inline(always)]
    fn square(self) -> Self {
        self * self
    }
}

/// A power of two whose product with a positive `x` is near 1.
#[inline(always)]
pub(crate) fn inverse_power_of_two(x: f64) -> f64 {
    const EXPONENT: u64 = 0x7ff0_0000_0000_0000;
    // Below 2⁻¹⁰⁰⁰ the scale stays 2¹⁰⁰⁰, above 2¹⁰²² it stays the smallest normal number.
    let exponent = (x.to_bits() & EXPONENT).clamp(23 << 52, 2045 << 52);
    f64::from_bits((2046 << 52) - exponent)
}

macro_rules! plain {
    ($($float:ident, short: $short:literal;)*) => {$(
        impl Real for $float {
            type Float = Self;

            const LOW: bool = false;

            #[inline(always)]
            fn from_words(high: Self, _: Self) -> Self {
                high
            }

            #[inline(always)]
            fn words(self) -> [Self; 2] {
                [self, 0.0]
            }

            #[inline(always)]
            fn from_double_double(pair: DoubleDouble) -> Self {
                pair.value() as Self
            }

            #[inline(always)]
            fn mul_add(self, a: Self, b: Self) -> Self {
                $float::mul_add(self, a, b)
            }

            #[inline(always)]
            fn times(self, a: Self) -> Self {
                $float::mul_add(self, a, 0.0)
            }

            #[inline(always)]
            fn fast_add(self, other: Self) -> Self {
                self + other
            }

            #[inline(always)]
            fn scaled(self, power: f64) -> Self {
                self * power as Self
            }

            #[inline(always)]
            fn recip(self) -> Self {
                1.0 / self
            }

            #[inline(always)]
            fn over(self, divisor: Self, inverse: Self) -> Self {
                let quotient = self * inverse;
                if $short {
                    return quotient;
                }
                $float::mul_add($float::mul_add(-quotient, divisor, self), inverse, quotient)
            }

            #[inline(always)]
            fn quotient(self, divisor: Self) -> Self {
                if $short { self.over(divisor, divisor.recip()) } else { self / divisor }
            }

            // A quotient within one unit in the last place becomes the nearest by one correction with
            // the nearest reciprocal (P. W. Markstein, IBM J. Res. Dev. 34, 1990, p. 111).
            #[inline(always)]
            fn quotient_by(self, divisor: Self, inverse: Self) -> Self {
                let near = self.over(divisor, inverse);
                if $short {
                    return near;
                }
                $float::mul_add($float::mul_add(-near, divisor, self), inverse, near)
            }

            #[inline(always)]
            fn both_over(a: Self, b: Self, divisor: Self) -> [Self; 2] {
                [a / divisor, b / divisor]
            }

            #[inline(always)]
            fn sqrt(self) -> Self {
                $float::sqrt(self)
            }

            #[inline(always)]
            fn abs(self) -> Self {
                $float::abs(self)
            }

            #[inline(always)]
            fn copysign(self, sign: Self) -> Self {
                $float::copysign(self, sign)
            }

            #[inline(always)]
            fn exceeds(self, other: Self) -> bool {
                self > other
            }
        }
    )*};
}

plain! {
    f32, short: true;
    f64, short: false;
}

impl DoubleDouble {
    /// The same number with an error term.
    #[inline(always)]
    pub(crate) fn of<T: Real>(number: T) -> Self {
        let [high, low] = number.words();
        Self { high: high.into(), low: low.into() }
    }
}

impl Real for DoubleDouble {
    type Float = f64;

    const LOW: bool = true;

    #[inline(always)]
    fn from_words(high: f64, low: f64) -> Self {
        Self { high, low }
    }

    #[inline(always)]
    fn words(self) -> [f64; 2] {
        [self.high, self.low]
    }

    #[inline(always)]
    fn from_double_double(pair: Self) -> Self {
        pair
    }

    #[inline(always)]
    fn value(self) -> f64 {
        Self::value(self)
    }

    #[inline(always)]
    fn mul_add(self, a: Self, b: Self) -> Self {
        self * a + b
    }

    #[inline(always)]
    fn times(self, a: Self) -> Self {
        let Self { high, low } = self * a;
        Self { high: high + 0.0, low }
    }

    #[inline(always)]
    fn fast_add(self, other: Self) -> Self {
        Self::fast_add(self, other)
    }

    #[inline(always)]
    fn scaled(self, power: f64) -> Self {
        Self::scaled(self, power)
    }

    #[inline(always)]
    fn recip(self) -> Self {
        let high = 1.0 / self.high;
        let rest = (-high).mul_add(self.low, (-high).mul_add(self.high, 1.0));
        Self { high, low: rest * high }
    }

    #[inline(always)]
    fn over(self, _: Self, inverse: Self) -> Self {
        self * inverse
    }

    #[inline(always)]
    fn both_over(a: Self, b: Self, divisor: Self) -> [Self; 2] {
        let inverse = 1.0 / divisor.high;
        [a.divided(divisor, inverse), b.divided(divisor, inverse)]
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        let high = self.high.sqrt();
        let rest = (-high).mul_add(high, self.high) + self.low;
        // The root of zero has no error.
        Self { high, low: if high > 0.0 { rest / (high + high) } else { 0.0 } }
    }

    #[inline(always)]
    fn abs(self) -> Self {
        if self.high < 0.0 { -self } else { self }
    }

    #[inline(always)]
    fn copysign(self, sign: Self) -> Self {
        let opposite = self.high.is_sign_negative() != sign.high.is_sign_negative();
        if opposite { -self } else { self }
    }

    #[inline(always)]
    fn exceeds(self, other: Self) -> bool {
        self.high > other.high
    }
}
