//! Double-double numbers: the unevaluated sum of a double and its error term, about 106 bits.
//!
//! Products and quotients compute their error with a fused multiply-add, sums with Knuth's two-sum.
//! Errors of errors are dropped (M. Lange and S. M. Rump, Faithfully rounded floating-point
//! computations, ACM TOMS 46, 2020). The error term may exceed half an ulp of the double;
//! [`DoubleDouble::value`] rounds.

use std::ops::{Add, Div, Mul, Neg, Sub};

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
    pub(crate) fn divided(self, divisor: Self, inverse: f64) -> Self {
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
