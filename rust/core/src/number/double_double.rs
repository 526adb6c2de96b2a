//! Double-double numbers: the unevaluated sum of a double and its error term, about 106 bits.
//!
//! Products and quotients compute their error with a fused multiply-add, sums with Knuth's two-sum.
//! Errors of errors are dropped (M. Lange and S. M. Rump, Faithfully rounded floating-point
//! computations, ACM TOMS 46, 2020). The error term may exceed half an ulp of the double;
//! [`DoubleDouble::value`] rounds.

use std::ops::{Add, Div, Mul, Neg, Sub};

use crate::number::float::Real;

/// The unevaluated sum of a double and a much smaller one.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DoubleDouble {
    /// The double.
    pub high: f64,
    /// Its error term.
    pub low: f64,
}

impl DoubleDouble {
    /// One.
    pub const ONE: Self = Self::exact(1.0);

    /// A double and its error term.
    #[inline(always)]
    pub const fn new(high: f64, low: f64) -> Self {
        Self { high, low }
    }

    /// An exact double. Its error term is -0.0, whose addition compilers can remove: -0.0 + 0.0 is
    /// not -0.0.
    #[inline(always)]
    pub const fn exact(high: f64) -> Self {
        Self { high, low: -0.0 }
    }

    /// The same number with an error term.
    #[inline(always)]
    pub(crate) fn of<T: Real>(number: T) -> Self {
        let [high, low] = number.words();
        Self { high: high.into(), low: low.into() }
    }

    /// The nearest double.
    #[inline(always)]
    pub fn value(self) -> f64 {
        self.high + self.low
    }

    /// The exact sum of two doubles.
    #[inline(always)]
    pub fn two_sum(a: f64, b: f64) -> Self {
        let high = a + b;
        let part = high - a;
        Self { high, low: (a - (high - part)) + (b - part) }
    }

    /// The exact sum of two doubles with `|large| ≥ |small|` (Dekker).
    #[inline(always)]
    pub fn fast_two_sum(large: f64, small: f64) -> Self {
        let high = large + small;
        Self { high, low: small - (high - large) }
    }

    /// The exact product of two doubles.
    #[inline(always)]
    pub fn two_product(a: f64, b: f64) -> Self {
        let high = a * b;
        Self { high, low: a.mul_add(b, -high) }
    }

    /// The same number, with the nearest double as its high word.
    #[inline(always)]
    #[must_use]
    pub fn rounded(self) -> Self {
        Self::fast_two_sum(self.high, self.low)
    }

    /// The same after a sum that cancels, whose error term may exceed its high word. Products drop
    /// the product of the error terms, which is small only if the words do not overlap.
    #[inline(always)]
    #[must_use]
    pub fn renormalized(self) -> Self {
        Self::two_sum(self.high, self.low)
    }

    /// Multiplies by a power of two, exactly.
    #[inline(always)]
    #[must_use]
    pub fn scaled(self, power: f64) -> Self {
        Self { high: self.high * power, low: self.low * power }
    }

    /// `self/divisor`, given the reciprocal of the divisor's high word.
    #[inline(always)]
    fn divided(self, divisor: Self, inverse: f64) -> Self {
        let high = self.high * inverse;
        let rest = (-high).mul_add(divisor.high, self.high) + self.low;
        Self { high, low: (-high).mul_add(divisor.low, rest) * inverse }
    }

    /// `self + other` for `|self| ≥ |other|`.
    #[inline(always)]
    #[must_use]
    pub fn fast_add(self, other: Self) -> Self {
        let Self { high, low } = Self::fast_two_sum(self.high, other.high);
        Self { high, low: low + (self.low + other.low) }
    }
}

impl Add for DoubleDouble {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        let Self { high, low } = Self::two_sum(self.high, other.high);
        Self { high, low: low + (self.low + other.low) }
    }
}

impl Neg for DoubleDouble {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self { high: -self.high, low: -self.low }
    }
}

impl Sub for DoubleDouble {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for DoubleDouble {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        let Self { high, low } = Self::two_product(self.high, other.high);
        Self { high, low: self.high.mul_add(other.low, self.low.mul_add(other.high, low)) }
    }
}

impl Div for DoubleDouble {
    type Output = Self;

    #[inline(always)]
    fn div(self, divisor: Self) -> Self {
        self.divided(divisor, 1.0 / divisor.high)
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
