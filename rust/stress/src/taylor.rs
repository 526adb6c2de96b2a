//! Power series, for derivatives of what has no formula.

use std::array::from_fn;
use std::ops::{Add, Div, Mul, Neg, Sub};

use crate::wide::Wide;

/// Coefficients of a power series of the drive angle, up to the third order.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TaylorSeries(pub(crate) [Wide; 4]);

impl TaylorSeries {
    pub(crate) fn constant(x: Wide) -> Self {
        Self([x, Wide::ZERO, Wide::ZERO, Wide::ZERO])
    }

    /// The derivative; its last coefficient is unknown and left zero.
    pub(crate) fn slope(self) -> Self {
        let [_, one, two, three] = self.0;
        Self([one, two * 2.0, three * 3.0, Wide::ZERO])
    }
}

impl Add for TaylorSeries {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self(from_fn(|i| self.0[i] + other.0[i]))
    }
}

impl Neg for TaylorSeries {
    type Output = Self;

    fn neg(self) -> Self {
        Self(self.0.map(|x| -x))
    }
}

impl Sub for TaylorSeries {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for TaylorSeries {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        let sum = |i: usize| (0..=i).fold(Wide::ZERO, |sum, j| sum + self.0[j] * other.0[i - j]);
        Self(from_fn(sum))
    }
}

impl Mul<Wide> for TaylorSeries {
    type Output = Self;

    fn mul(self, factor: Wide) -> Self {
        Self(self.0.map(|x| x * factor))
    }
}

impl Div for TaylorSeries {
    type Output = Self;

    fn div(self, divisor: Self) -> Self {
        let inverse = Wide::ONE / divisor.0[0];
        let mut quotient = [Wide::ZERO; 4];
        for i in 0..4 {
            let known = (0..i).fold(Wide::ZERO, |sum, j| sum + quotient[j] * divisor.0[i - j]);
            quotient[i] = (self.0[i] - known) * inverse;
        }
        Self(quotient)
    }
}
