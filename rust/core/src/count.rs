//! Numbers that count the operations on them: what [`crate::plan::Plan::explain`] reports is what
//! runs.

use std::cell::Cell;
use std::ops::{Add, Div, Mul, Neg, Sub};

use crate::atan::{Atan, AtanRange};
use crate::pair::Pair;
use crate::real::{Real, Word};
use crate::reduce;
use crate::trig::Angle;

thread_local! {
    static OPERATIONS: Cell<usize> = const { Cell::new(0) };
}

/// The operations that `run` performs on [`Counted`] numbers.
pub(crate) fn operations(run: impl FnOnce()) -> usize {
    OPERATIONS.set(0);
    run();
    OPERATIONS.get()
}

/// A double that counts as the number type in this place: single, double, double with error term.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Counted<const TYPE: usize>(f64);

impl<const TYPE: usize> Counted<TYPE> {
    /// The result of so many operations on doubles or singles, by type.
    fn after_operations(value: f64, by_type: [usize; 3]) -> Self {
        OPERATIONS.set(OPERATIONS.get() + by_type[TYPE]);
        Self(value)
    }

    /// An inverse tangent: a division and a polynomial.
    fn atan_in(range: AtanRange, y: Self, x: Self) -> Self {
        let terms = range.terms();
        let [single, double, in_two] = terms.map(|terms| terms + 3);
        let in_two = in_two + 6;
        Self::after_operations(y.0.atan2(x.0), [single, double, in_two])
    }
}

/// `[1, 1, in_two]` operations.
macro_rules! operator {
    ($($operator:ident $name:ident $in_two:literal)*) => {$(
        impl<const TYPE: usize> $operator for Counted<TYPE> {
            type Output = Self;

            fn $name(self, other: Self) -> Self {
                Self::after_operations(self.0.$name(other.0), [1, 1, $in_two])
            }
        }
    )*};
}

operator! { Add add 8 Sub sub 8 Mul mul 4 Div div 6 }

impl<const TYPE: usize> Neg for Counted<TYPE> {
    type Output = Self;

    // A sign goes into the next operation.
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

impl<const TYPE: usize> Real for Counted<TYPE> {
    type Word = f64;

    const LOW: bool = false;

    fn from_words(high: f64, _: f64) -> Self {
        Self(high)
    }

    fn words(self) -> [f64; 2] {
        [self.0, 0.0]
    }

    fn from_pair(pair: Pair) -> Self {
        Self(pair.value())
    }

    fn value(self) -> f64 {
        Self::after_operations(self.0, [0, 0, 1]).0
    }

    fn mul_add(self, a: Self, b: Self) -> Self {
        Self::after_operations(self.0.mul_add(a.0, b.0), [1, 1, 12])
    }

    fn plus_smaller(self, other: Self) -> Self {
        Self::after_operations(self.0 + other.0, [1, 1, 5])
    }

    fn scaled(self, power: f64) -> Self {
        Self::after_operations(self.0 * power, [1, 1, 2])
    }

    fn recip(self) -> Self {
        Self::after_operations(1.0 / self.0, [1, 1, 4])
    }

    fn over(self, divisor: Self, _: Self) -> Self {
        Self::after_operations(self.0 / divisor.0, [3, 3, 4])
    }

    fn both_over(a: Self, b: Self, divisor: Self) -> [Self; 2] {
        [Self::after_operations(a.0 / divisor.0, [2, 2, 11]), Self(b.0 / divisor.0)]
    }

    fn sqrt(self) -> Self {
        Self::after_operations(self.0.sqrt(), [1, 1, 5])
    }

    fn abs(self) -> Self {
        Self::after_operations(self.0.abs(), [1, 1, 2])
    }

    fn copysign(self, sign: Self) -> Self {
        Self::after_operations(self.0.copysign(sign.0), [1, 1, 2])
    }

    fn exceeds(self, other: Self) -> bool {
        Self::after_operations(0.0, [1; 3]);
        self.0 > other.0
    }
}

impl<const TYPE: usize> Angle for Counted<TYPE> {
    const SHORT: bool = false;
    const APART: bool = false;

    fn reduce(angle: f64) -> (Self, u64) {
        let (remainder, quadrant) = reduce::reduce(angle);
        (Self::after_operations(remainder, [6, 5, 18]), quadrant)
    }

    fn tangent(remainder: Self) -> (Self, Self) {
        let tangent = Self::after_operations(remainder.0.tan(), [5, 8, 45]);
        (tangent, Self(1.0))
    }

    const DOUBLED: bool = TYPE == 2;

    fn sin_cos(remainder: Self) -> (Self, Self) {
        let (sine, cosine) = remainder.0.sin_cos();
        (Self::after_operations(sine, [0, 0, 40]), Self(cosine))
    }

    fn turned_if(self, bit: u64) -> Self {
        Self(if bit == 1 { -self.0 } else { self.0 })
    }

    fn of_phase(phase: u64) -> (Self, u64) {
        let (remainder, quadrant) = f64::of_phase(phase);
        (Self(remainder), quadrant)
    }

    fn of_bits(bits: u64) -> Self {
        Self(f64::from_bits(bits))
    }

    fn bits(self) -> u64 {
        self.0.to_bits()
    }

    fn after<W: Word>(self, drive: Pair) -> W {
        W::near(Self::after_operations(drive.value() + self.0, [3, 1, 9]).0)
    }

    fn tangent_of_sum([a, _]: [f64; 2], [b, _]: [f64; 2]) -> (Self, Self) {
        let sum = Self::after_operations(a + b, [4, 4, 19]);
        (sum, Self(1.0 - a * b))
    }
}

impl<const TYPE: usize> Atan for Counted<TYPE> {
    fn atan_hundredth(y: Self, x: Self) -> Self {
        Self::atan_in(AtanRange::Hundredth, y, x)
    }

    fn atan_tenth(y: Self, x: Self) -> Self {
        Self::atan_in(AtanRange::Tenth, y, x)
    }

    fn atan_third(y: Self, x: Self) -> Self {
        Self::atan_in(AtanRange::Third, y, x)
    }

    fn atan_eighth_turn(y: Self, x: Self) -> Self {
        Self::atan_in(AtanRange::One, y, x)
    }

    fn after_eighths(self, eighths: f64) -> Self {
        Self::after_operations(self.0 + eighths * std::f64::consts::FRAC_PI_4, [2, 2, 10])
    }
}
