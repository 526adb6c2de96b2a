//! Numbers of two doubles, for the oracle.
//!
//! The algorithms with proven bounds of Joldes, Muller and Popescu, Tight and rigorous error bounds
//! for basic building blocks of double-word arithmetic, ACM TOMS 44, 2017: each is within a few
//! 2⁻¹⁰⁶ of the exact result, and its words do not overlap.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// An unevaluated sum of two doubles.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Wide {
    pub(crate) high: f64,
    pub(crate) low: f64,
}

/// The exact sum of two doubles.
#[inline]
pub(crate) fn two_sum(a: f64, b: f64) -> Wide {
    let high = a + b;
    let a_part = high - b;
    let b_part = high - a_part;
    Wide { high, low: (a - a_part) + (b - b_part) }
}

/// The same where `a` is not the smaller one.
#[inline]
fn fast_two_sum(a: f64, b: f64) -> Wide {
    let high = a + b;
    Wide { high, low: b - (high - a) }
}

/// The exact product of two doubles.
#[inline]
fn two_product(a: f64, b: f64) -> Wide {
    let high = a * b;
    Wide { high, low: a.mul_add(b, -high) }
}

/// A double in the digits that it has.
pub(crate) fn hex(x: f64) -> String {
    let bits = x.to_bits();
    let (exponent, digits) = ((bits >> 52 & 0x7ff) as i64, bits & ((1 << 52) - 1));
    let sign = if x < 0.0 { "-" } else { "" };
    let (lead, power) = if exponent == 0 { (0, -1022) } else { (1, exponent - 1023) };
    format!("{sign}0x{lead}.{digits:013x}p{power:+}")
}

impl Wide {
    /// Its digits, as two doubles.
    pub(crate) fn hex(self) -> String {
        format!("{} {}", hex(self.high), hex(self.low))
    }

    pub(crate) const ZERO: Self = Self { high: 0.0, low: 0.0 };
    pub(crate) const ONE: Self = Self { high: 1.0, low: 0.0 };

    pub(crate) fn new(high: f64, low: f64) -> Self {
        Self { high, low }
    }

    pub(crate) fn square(self) -> Self {
        self * self
    }

    /// Times a power of two.
    pub(crate) fn scaled(self, power: f64) -> Self {
        Self { high: self.high * power, low: self.low * power }
    }

    pub(crate) fn abs(self) -> Self {
        if self.high < 0.0 { -self } else { self }
    }

    pub(crate) fn sqrt(self) -> Self {
        if self.high <= 0.0 {
            return Self::ZERO;
        }
        let root = self.high.sqrt();
        let rest = (-root).mul_add(root, self.high) + self.low;
        fast_two_sum(root, rest / (2.0 * root))
    }

    /// The spacing of the doubles at the number.
    pub(crate) fn ulp(self) -> f64 {
        const LEAST: f64 = 5e-324;
        let size = self.high.abs();
        if size < f64::MIN_POSITIVE {
            return LEAST;
        }
        let power = f64::from_bits(size.to_bits() & (0x7ff << 52));
        // Just below a power of two the nearest double already has the wider spacing.
        let below = size == power && (self.low < 0.0) == (self.high > 0.0) && self.low != 0.0;
        let ulp = power * f64::EPSILON;
        if below { (0.5 * ulp).max(LEAST) } else { ulp }
    }

    /// How far a double is from the number.
    pub(crate) fn distance(self, got: f64) -> f64 {
        ((got - self.high) - self.low).abs()
    }
}

impl From<f64> for Wide {
    fn from(high: f64) -> Self {
        Self { high, low: 0.0 }
    }
}

impl Neg for Wide {
    type Output = Self;

    fn neg(self) -> Self {
        Self { high: -self.high, low: -self.low }
    }
}

impl Add for Wide {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        let high = two_sum(self.high, other.high);
        let low = two_sum(self.low, other.low);
        let sum = fast_two_sum(high.high, high.low + low.high);
        fast_two_sum(sum.high, low.low + sum.low)
    }
}

impl Sub for Wide {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Wide {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        let high = two_product(self.high, other.high);
        let cross = self.high.mul_add(other.low, self.low * other.low);
        fast_two_sum(high.high, high.low + self.low.mul_add(other.high, cross))
    }
}

impl Mul<f64> for Wide {
    type Output = Self;

    fn mul(self, factor: f64) -> Self {
        let high = two_product(self.high, factor);
        fast_two_sum(high.high, self.low.mul_add(factor, high.low))
    }
}

impl Div for Wide {
    type Output = Self;

    fn div(self, divisor: Self) -> Self {
        let first = self.high / divisor.high;
        let rest = self - divisor * first;
        let second = rest.high / divisor.high;
        let rest = rest - divisor * second;
        let quotient = fast_two_sum(first, second);
        quotient + Self::from(rest.high / divisor.high)
    }
}

/// A complex number of wide ones.
#[derive(Clone, Copy, Debug)]
pub(crate) struct WideComplex {
    pub(crate) re: Wide,
    pub(crate) im: Wide,
}

impl WideComplex {
    pub(crate) fn conj(self) -> Self {
        Self { re: self.re, im: -self.im }
    }

    pub(crate) fn times(self, factor: Wide) -> Self {
        Self { re: self.re * factor, im: self.im * factor }
    }

    pub(crate) fn norm_squared(self) -> Wide {
        self.re.square() + self.im.square()
    }
}

impl Add for WideComplex {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self { re: self.re + other.re, im: self.im + other.im }
    }
}

impl Sub for WideComplex {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self { re: self.re - other.re, im: self.im - other.im }
    }
}

impl Mul for WideComplex {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        Self {
            re: self.re * other.re - self.im * other.im,
            im: self.re * other.im + self.im * other.re,
        }
    }
}
