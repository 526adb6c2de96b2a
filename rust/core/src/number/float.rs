//! The number types that the kernels compute in: double, single, and a double with its error term.
//!
//! Formulas are written once over [`Real`] and mean the same in each; [`crate::number::double_double`] holds the third.

use std::fmt::Debug;
use std::ops::{Add, Div, Mul, Neg, Sub};

use crate::number::double_double::DoubleDouble;

/// What arrays hold: doubles or singles.
pub trait Float: Copy + Debug + Default + PartialEq + Send + Sync + Into<f64> + 'static {
    /// The nearest one.
    fn near(x: f64) -> Self;

    /// An angle plus a small one, in this precision.
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

/// A number of a kernel.
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
    /// What columns and planes hold: one word to a number, or two.
    type Float: Float;

    /// Whether a number has a low word.
    const LOW: bool;

    /// The number with these words; without a low word, the high one alone.
    fn from_words(high: Self::Float, low: Self::Float) -> Self;

    /// Its words; the low one is zero where there is none.
    fn words(self) -> [Self::Float; 2];

    /// The nearest number to a double with its error term.
    fn from_double_double(pair: DoubleDouble) -> Self;

    /// The nearest word.
    #[inline(always)]
    fn value(self) -> Self::Float {
        let [high, _] = self.words();
        high
    }

    /// A double, rounded where the number is shorter.
    #[inline(always)]
    fn from_f64(x: f64) -> Self {
        Self::from_words(Self::Float::near(x), Self::Float::default())
    }

    /// `self · a + b`.
    #[must_use]
    fn mul_add(self, a: Self, b: Self) -> Self;

    /// `self + other` where `self` is not the smaller one.
    #[must_use]
    fn fast_add(self, other: Self) -> Self;

    /// Times a power of two.
    #[must_use]
    fn scaled(self, power: f64) -> Self;

    /// `1/self`.
    #[must_use]
    fn recip(self) -> Self;

    /// `self/divisor` by way of the divisor's inverse: within one rounding, of short numbers two.
    #[must_use]
    fn over(self, divisor: Self, inverse: Self) -> Self;

    /// `a/divisor` and `b/divisor`.
    fn both_over(a: Self, b: Self, divisor: Self) -> [Self; 2];

    /// `√self`.
    #[must_use]
    fn sqrt(self) -> Self;

    /// `|self|`.
    #[must_use]
    fn abs(self) -> Self;

    /// The size of `self` with the sign of `sign`.
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
