//! The inverse tangent, for each number type and each range of tangents.
//!
//! The bend bounds the tangent of the angle error: `|tan Δ| ≤ (1 − cos β)/(2 √cos β)`. Bends that
//! occur in practice therefore need only short polynomials. `atan t = t + t z P(z)` with `z = t²`;
//! the polynomials are minimax fits to the stated relative error (Remez exchange in 50-digit
//! arithmetic).

use crate::number::double_double::DoubleDouble;
use crate::number::float::Real;
use crate::number::reduction::HALF_PI;
use crate::number::trig::polynomial;

/// `atan t = t + t z P(z)` for `|t| ≤ 0.008`, relative error 2⁻⁶⁵.
const ATAN_0_008: [f64; 3] =
    [-0.333_333_333_333_328, 0.199_999_999_499_293_9, -0.142_843_484_338_361_83];

/// The same for `|t| ≤ 0.1004`, relative error 2⁻⁶³.
const ATAN_0_1: [f64; 6] = [
    -0.333_333_333_333_332_76,
    0.199_999_999_998_917_32,
    -0.142_857_142_160_903_95,
    0.111_110_905_147_083_09,
    -0.090_878_249_155_555_37,
    0.074_644_156_949_698_89,
];

/// The same for `|t| ≤ 0.32`, relative error 2⁻⁶⁷.
const ATAN_0_32: [f64; 11] = [
    -0.333_333_333_333_333_3,
    0.199_999_999_999_996_15,
    -0.142_857_142_856_382_82,
    0.111_111_111_035_975_82,
    -0.090_909_086_586_278_48,
    0.076_922_920_143_674_88,
    -0.066_662_927_399_842_8,
    0.058_763_851_579_678_59,
    -0.051_996_911_335_385_15,
    0.043_250_673_264_477_3,
    -0.025_280_703_822_841_21,
];

/// The same for `|t| ≤ 0.4143`, relative error 2⁻⁶⁴.
const ATAN_0_41: [f64; 12] = [
    -0.333_333_333_333_333_26,
    0.199_999_999_999_976_42,
    -0.142_857_142_853_847_62,
    0.111_111_110_879_944_3,
    -0.090_909_081_385_212_45,
    0.076_922_826_351_231_95,
    -0.066_662_250_959_204_62,
    0.058_770_069_642_556_585,
    -0.052_183_172_545_158_724,
    0.045_032_259_437_675_03,
    -0.033_467_579_649_908_84,
    0.015_188_775_812_444_587,
];

/// The same in single precision, relative errors 2⁻³³, 2⁻²⁷, 2⁻²⁹ and 2⁻³⁰.
const SINGLE_0_008: [f32; 1] = [-0.333_322_73];
const SINGLE_0_1: [f32; 2] = [-0.333_327_15, 0.198_012_57];
const SINGLE_0_32: [f32; 4] = [-0.333_332_77, 0.199_946_05, -0.141_227_83, 0.091_270_92];
const SINGLE_0_41: [f32; 5] =
    [-0.333_333_15, 0.199_984_69, -0.142_434_87, 0.105_934_516, -0.060_772_586];

/// `tan 22.5°` and `tan 67.5°`.
const TAN_EIGHTH: f64 = 0.414_213_562_373_095_03;
const TAN_THREE_EIGHTHS: f64 = 2.414_213_562_373_095;

/// The range of the inverse tangent of an angle error, chosen once from the largest tangent.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum AtanRange {
    /// Tangents up to 0.008 (one joint: bends to 10.2°).
    Hundredth,
    /// Tangents up to 0.1004 (bends to 35°).
    Tenth,
    /// Tangents up to 0.32 (bends to 57°).
    Third,
    /// Tangents up to 1 (bends to 80°): the polynomial for 22.5° and a rotation by 45°.
    One,
    /// Any tangent: the same polynomial and a rotation by 45° or 90°.
    Any,
}

impl AtanRange {
    /// The smallest range that contains tangents up to `largest`.
    pub fn holding(largest: f64) -> Self {
        Self::holding_squares(largest * largest, 1.0)
    }

    /// The smallest range that contains tangents up to `√(square/divisor)`, without a root or a
    /// division.
    #[inline(always)]
    pub(crate) fn holding_squares(square: f64, divisor: f64) -> Self {
        let holds = |tangent: f64| square <= tangent * tangent * divisor;
        if holds(0.008) {
            Self::Hundredth
        } else if holds(0.1004) {
            Self::Tenth
        } else if holds(0.32) {
            Self::Third
        } else if holds(1.0) {
            Self::One
        } else {
            Self::Any
        }
    }

    /// Whether the bends are moderate: sharing squares among all formulas then costs no accuracy.
    /// Steeper bends use separate formulas with fewer roundings.
    pub(crate) fn is_moderate(self) -> bool {
        self <= Self::Third
    }

    /// The number of polynomial terms in single precision, in double precision and with error
    /// terms.
    pub(crate) fn terms(self) -> [usize; 3] {
        match self {
            Self::Hundredth => [SINGLE_0_008.len(), ATAN_0_008.len(), ATAN_0_008.len()],
            Self::Tenth => [SINGLE_0_1.len(), ATAN_0_1.len(), ATAN_0_1.len()],
            Self::Third => [SINGLE_0_32.len(), ATAN_0_32.len(), ATAN_0_32.len()],
            Self::One | Self::Any => [SINGLE_0_41.len(), ATAN_0_41.len(), ATAN_0_41.len()],
        }
    }
}

/// The inverse tangent, one method per range: of a number within a third or so, beyond that of `y/x`
/// with `x > 0`.
pub trait Atan: Real {
    /// Arc tangent of a number up to 0.008.
    #[must_use]
    fn atan_hundredth(self) -> Self;
    /// Arc tangent of a number up to 0.1004.
    #[must_use]
    fn atan_tenth(self) -> Self;
    /// Arc tangent of a number up to 0.32.
    #[must_use]
    fn atan_third(self) -> Self;
    /// Arc tangent of a number up to 0.4143.
    #[must_use]
    fn atan_eighth_turn(self) -> Self;
    /// `self` plus `eighths` times 45°.
    #[must_use]
    fn after_eighths(self, eighths: f64) -> Self;

    /// `|y| ≤ x`; angles above 22.5° are rotated back by 45°.
    #[inline(always)]
    fn atan_one(y: Self, x: Self) -> Self {
        let size = y.abs();
        let steep = size.exceeds(x * Self::from_f64(TAN_EIGHTH));
        let (numerator, denominator) = if steep { (size - x, size + x) } else { (size, x) };
        let a = (numerator / denominator).atan_eighth_turn();
        a.after_eighths(if steep { 1.0 } else { 0.0 }).copysign(y)
    }

    /// Any `y`; angles above 22.5° are rotated back by 45°, angles above 67.5° by 90°.
    #[inline(always)]
    fn atan_any(y: Self, x: Self) -> Self {
        let size = y.abs();
        let steep = size.exceeds(x * Self::from_f64(TAN_EIGHTH));
        let steepest = size.exceeds(x * Self::from_f64(TAN_THREE_EIGHTHS));
        let (numerator, denominator) = if steep { (size - x, size + x) } else { (size, x) };
        let (numerator, denominator) = if steepest { (-x, size) } else { (numerator, denominator) };
        let eighths = if steep { 1.0 } else { 0.0 };
        let eighths = if steepest { 2.0 } else { eighths };
        let a = (numerator / denominator).atan_eighth_turn();
        a.after_eighths(eighths).copysign(y)
    }
}

macro_rules! plain {
    ($($float:ident $hundredth:ident $tenth:ident $third:ident $one:ident)*) => {$(
        impl Atan for $float {
            #[inline(always)]
            fn atan_hundredth(self) -> Self {
                atan_polynomial(self, &$hundredth)
            }

            #[inline(always)]
            fn atan_tenth(self) -> Self {
                atan_polynomial(self, &$tenth)
            }

            #[inline(always)]
            fn atan_third(self) -> Self {
                atan_polynomial(self, &$third)
            }

            #[inline(always)]
            fn atan_eighth_turn(self) -> Self {
                atan_polynomial(self, &$one)
            }

            #[inline(always)]
            fn after_eighths(self, eighths: f64) -> Self {
                let high = (0.5 * HALF_PI[0]) as Self;
                let low = (0.5 * HALF_PI[0] - f64::from(high) + 0.5 * HALF_PI[1]) as Self;
                let eighths = eighths as Self;
                $float::mul_add(eighths, high, $float::mul_add(eighths, low, self))
            }
        }
    )*};
}

plain!(
    f32 SINGLE_0_008 SINGLE_0_1 SINGLE_0_32 SINGLE_0_41
    f64 ATAN_0_008 ATAN_0_1 ATAN_0_32 ATAN_0_41
);

#[inline(always)]
fn atan_polynomial<T: Real>(t: T, coefficients: &[T]) -> T {
    let z = t * t;
    (t * z).mul_add(polynomial(z, coefficients), t)
}

/// The polynomial is small compared with the tangent, so only the tangent needs its error term. The
/// derivative of the inverse tangent, `1/(1 + t²)`, scales that term.
#[inline(always)]
fn atan_with_error_term(t: DoubleDouble, coefficients: &[f64]) -> DoubleDouble {
    let z = t.high * t.high;
    let low = (-z).mul_add(t.low, t.low);
    DoubleDouble { high: t.high, low: (t.high * z).mul_add(polynomial(z, coefficients), low) }
}

impl Atan for DoubleDouble {
    #[inline(always)]
    fn atan_hundredth(self) -> Self {
        atan_with_error_term(self, &ATAN_0_008)
    }

    #[inline(always)]
    fn atan_tenth(self) -> Self {
        atan_with_error_term(self, &ATAN_0_1)
    }

    #[inline(always)]
    fn atan_third(self) -> Self {
        atan_with_error_term(self, &ATAN_0_32)
    }

    #[inline(always)]
    fn atan_eighth_turn(self) -> Self {
        atan_with_error_term(self, &ATAN_0_41)
    }

    #[inline(always)]
    fn after_eighths(self, eighths: f64) -> Self {
        Self::new(0.5 * HALF_PI[0] * eighths, 0.5 * HALF_PI[1] * eighths) + self
    }
}
