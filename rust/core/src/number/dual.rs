//! Dual numbers: a number and its derivatives by several parameters.

use std::ops::{Add, Div, Mul, Neg, Sub};

use crate::number::double_double::DoubleDouble;
use crate::number::elementary::atan2;
use crate::number::float::Real;
use crate::number::trig;

/// A number with its derivatives by `N` parameters. Comparisons are those of the numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Dual<const N: usize> {
    pub(crate) value: f64,
    pub(crate) by: [f64; N],
}

impl<const N: usize> Dual<N> {
    /// A number that depends on no parameter.
    pub(crate) fn constant(value: f64) -> Self {
        Self { value, by: [0.0; N] }
    }

    /// A function of this number with a value and a slope.
    fn map(self, value: f64, slope: f64) -> Self {
        Self { value, by: self.by.map(|by| slope * by) }
    }

    /// A function of two numbers with a value and a slope by each.
    fn zip(self, other: Self, value: f64, [own, others]: [f64; 2]) -> Self {
        let by = |i: usize| own.mul_add(self.by[i], others * other.by[i]);
        Self { value, by: std::array::from_fn(by) }
    }

    pub(crate) fn sin_cos(self) -> (Self, Self) {
        let (s, c) = trig::sin_cos(self.value);
        (self.map(s, c), self.map(c, -s))
    }

    /// The angle of a point that is not the origin.
    pub(crate) fn atan2(y: Self, x: Self) -> Self {
        let square = y.value.mul_add(y.value, x.value * x.value);
        y.zip(x, atan2(y.value, x.value), [x.value / square, -y.value / square])
    }
}

impl<const N: usize> Add for Dual<N> {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        self.zip(other, self.value + other.value, [1.0, 1.0])
    }
}

impl<const N: usize> Sub for Dual<N> {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self.zip(other, self.value - other.value, [1.0, -1.0])
    }
}

impl<const N: usize> Mul for Dual<N> {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        self.zip(other, self.value * other.value, [other.value, self.value])
    }
}

impl<const N: usize> Div for Dual<N> {
    type Output = Self;

    fn div(self, other: Self) -> Self {
        let quotient = self.value / other.value;
        self.zip(other, quotient, [1.0 / other.value, -quotient / other.value])
    }
}

impl<const N: usize> Neg for Dual<N> {
    type Output = Self;

    fn neg(self) -> Self {
        self.map(-self.value, -1.0)
    }
}

impl<const N: usize> Real for Dual<N> {
    type Float = f64;

    const LOW: bool = false;

    fn from_words(high: f64, _: f64) -> Self {
        Self::constant(high)
    }

    fn words(self) -> [f64; 2] {
        [self.value, 0.0]
    }

    fn from_double_double(pair: DoubleDouble) -> Self {
        Self::constant(pair.value())
    }

    fn mul_add(self, a: Self, b: Self) -> Self {
        let product = self * a;
        let sum = product + b;
        Self { value: self.value.mul_add(a.value, b.value), ..sum }
    }

    fn fast_add(self, other: Self) -> Self {
        self + other
    }

    fn times(self, a: Self) -> Self {
        self * a
    }

    fn scaled(self, power: f64) -> Self {
        self.map(self.value * power, power)
    }

    fn recip(self) -> Self {
        let inverse = 1.0 / self.value;
        self.map(inverse, -inverse * inverse)
    }

    fn over(self, divisor: Self, _: Self) -> Self {
        self / divisor
    }

    fn both_over(a: Self, b: Self, divisor: Self) -> [Self; 2] {
        [a / divisor, b / divisor]
    }

    /// Where the number is 0, its slope is taken as 0, the mean of both sides of a magnitude.
    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        self.map(root, if root == 0.0 { 0.0 } else { 0.5 / root })
    }

    /// Where the number is 0, its slope is taken as 0.
    fn abs(self) -> Self {
        let slope = if self.value == 0.0 { 0.0 } else { self.value.signum() };
        self.map(self.value.abs(), slope)
    }

    fn copysign(self, sign: Self) -> Self {
        if self.value.is_sign_negative() == sign.value.is_sign_negative() { self } else { -self }
    }

    fn exceeds(self, other: Self) -> bool {
        self.value > other.value
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_are_differences() {
        const STEP: f64 = 1e-5;
        let function = |x: Dual<2>, y: Dual<2>| {
            let (s, c) = (x * y).sin_cos();
            let angle = Dual::atan2(s + y, c.mul_add(x, y.square()).abs() + x);
            (angle / x.recip()).over(y, y.recip()) - (x.scaled(4.0).sqrt()).copysign(-y)
        };
        let at = |x: f64, y: f64| function(Dual::constant(x), Dual::constant(y)).value;
        for (x, y) in [(0.7, 1.3), (2.1, -0.4)] {
            let found =
                function(Dual { value: x, by: [1.0, 0.0] }, Dual { value: y, by: [0.0, 1.0] });
            let by_x = (at(x + STEP, y) - at(x - STEP, y)) / (2.0 * STEP);
            let by_y = (at(x, y + STEP) - at(x, y - STEP)) / (2.0 * STEP);
            assert!((found.by[0] - by_x).abs() < 1e-8, "{found:?} {by_x}");
            assert!((found.by[1] - by_y).abs() < 1e-8, "{found:?} {by_y}");
        }
    }

    #[test]
    fn magnitudes_have_no_slope_at_zero() {
        let zero = Dual { value: 0.0, by: [1.0] };
        assert_eq!([zero.abs().by, zero.square().sqrt().by], [[0.0], [0.0]]);
    }
}
