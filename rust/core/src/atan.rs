//! The inverse tangent, by number type and by the range that an angle error needs.
//!
//! `|tan Δ| ≤ (1 − cos β)/(2 √cos β)` is known before the first angle, and short polynomials do for
//! the bends that occur in practice: `atan t = t + t z P(z)`, `z = t²`, minimax fits to the stated
//! relative error (Remez exchange in 50-digit arithmetic).

use crate::joint::Joint;
use crate::pair::Pair;
use crate::real::Real;
use crate::reduce::HALF_PI;
use crate::trig::polynomial;

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

/// The same for `|t| ≤ 1`, relative error 2⁻⁵⁷·⁶.
const ATAN_1: [f64; 20] = [
    -0.333_333_333_333_330_7,
    0.199_999_999_999_514_62,
    -0.142_857_142_825_751_38,
    0.111_111_110_070_267_36,
    -0.090_909_070_029_974_73,
    0.076_922_798_393_240_47,
    -0.066_664_040_575_802_22,
    0.058_805_278_135_378_954,
    -0.052_535_185_446_520_895,
    0.047_223_221_807_003_25,
    -0.042_191_788_456_041_38,
    0.036_641_908_439_225_115,
    -0.029_903_854_296_613_068,
    0.021_984_847_982_474_087,
    -0.013_900_554_950_758_369,
    0.007_196_499_560_716_875,
    -0.002_884_916_624_583_154,
    0.000_831_321_220_797_866_1,
    -0.000_152_160_734_867_644_17,
    1.322_506_307_323_098e-5,
];

/// `atan t = t − t z/3 + t z² P(z)` for `|t| ≤ 1`, relative error 2⁻⁶²·⁶.
const ATAN_1_TAIL: [f64; 21] = [
    0.199_999_999_999_994_07,
    -0.142_857_142_856_422_45,
    0.111_111_111_075_685_53,
    -0.090_909_089_940_131_61,
    0.076_923_059_975_652_81,
    -0.066_666_461_414_627_15,
    0.058_821_716_990_137_1,
    -0.052_619_483_194_783_385,
    0.047_556_411_592_639_465,
    -0.043_221_524_567_954_42,
    0.039_153_908_760_867_134,
    -0.034_766_101_399_244_8,
    0.029_461_534_900_591_103,
    -0.023_007_390_230_748_735,
    0.015_915_657_981_989_198,
    -0.009_357_221_807_205_973,
    0.004_474_049_000_484_649_6,
    -0.001_651_841_353_455_212_6,
    0.000_438_370_319_275_465_65,
    -7.401_729_130_382_833e-5,
    5.950_189_342_648_446e-6,
];
const THIRD: Pair = Pair::new(0.333_333_333_333_333_3, 1.850_371_707_708_594e-17);

/// The same in single precision, relative errors 2⁻³³, 2⁻²⁷, 2⁻²⁹ and 2⁻²⁸.
const SINGLE_0_008: [f32; 1] = [-0.333_322_73];
const SINGLE_0_1: [f32; 2] = [-0.333_327_15, 0.198_012_57];
const SINGLE_0_32: [f32; 4] = [-0.333_332_77, 0.199_946_05, -0.141_227_83, 0.091_270_92];
const SINGLE_1: [f32; 9] = [
    -0.333_332_99,
    0.199_985_48,
    -0.142_642_42,
    0.109_521_88,
    -0.084_034_56,
    0.057_957_688,
    -0.031_177_932,
    0.010_914_648,
    -0.001_793_630_3,
];

/// The inverse tangent that an angle error needs, chosen once from the largest tangent in reach.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum AtanRange {
    /// Tangents up to 0.008 (one joint: bends to 10.2°).
    Hundredth,
    /// Tangents up to 0.1004 (bends to 35°).
    Tenth,
    /// Tangents up to 0.32 (bends to 57°).
    Third,
    /// Tangents up to 1 (bends to 80°).
    One,
    /// Any tangent: the same and an exchange of the sides.
    Any,
}

impl AtanRange {
    /// The shortest range that holds tangents up to `largest`.
    pub fn holding(largest: f64) -> Self {
        if largest <= 0.008 {
            Self::Hundredth
        } else if largest <= 0.1004 {
            Self::Tenth
        } else if largest <= 0.32 {
            Self::Third
        } else if largest <= 1.0 {
            Self::One
        } else {
            Self::Any
        }
    }

    /// The shortest range for the angle error of a joint.
    #[inline(always)]
    pub(crate) fn of<T: Real>(joint: &Joint<T>) -> Self {
        let (versine, cos): (f64, f64) = (joint.versine.value().into(), joint.cos.value().into());
        Self::holding(versine / (2.0 * cos.sqrt()))
    }

    /// Its terms in single precision, in double, and in double with error terms.
    pub(crate) fn terms(self) -> [usize; 3] {
        match self {
            Self::Hundredth => [SINGLE_0_008.len(), ATAN_0_008.len(), ATAN_0_008.len()],
            Self::Tenth => [SINGLE_0_1.len(), ATAN_0_1.len(), ATAN_0_1.len()],
            Self::Third => [SINGLE_0_32.len(), ATAN_0_32.len(), ATAN_0_32.len()],
            Self::One | Self::Any => [SINGLE_1.len(), ATAN_1.len(), ATAN_1_TAIL.len() + 1],
        }
    }
}

/// `atan(y/x)` for `x > 0`, by the range that holds `|y/x|`.
pub trait Atan: Real {
    /// `|y| ≤ 0.008 x`.
    fn atan_hundredth(y: Self, x: Self) -> Self;
    /// `|y| ≤ 0.1004 x`.
    fn atan_tenth(y: Self, x: Self) -> Self;
    /// `|y| ≤ 0.32 x`.
    fn atan_third(y: Self, x: Self) -> Self;
    /// `|y| ≤ x`.
    fn atan_one(y: Self, x: Self) -> Self;

    /// Any `y`.
    #[inline(always)]
    fn atan_any(y: Self, x: Self) -> Self {
        let size = y.abs();
        let steep = size.exceeds(x);
        let (small, large) = if steep { (x, size) } else { (size, x) };
        let a = Self::atan_one(small, large);
        let a = if steep { Self::quarter_less(a) } else { a };
        a.copysign(y)
    }

    /// `π/2 − a`.
    fn quarter_less(a: Self) -> Self;
}

macro_rules! plain {
    ($($float:ident $hundredth:ident $tenth:ident $third:ident $one:ident)*) => {$(
        impl Atan for $float {
            #[inline(always)]
            fn atan_hundredth(y: Self, x: Self) -> Self {
                by_polynomial(y / x, &$hundredth)
            }

            #[inline(always)]
            fn atan_tenth(y: Self, x: Self) -> Self {
                by_polynomial(y / x, &$tenth)
            }

            #[inline(always)]
            fn atan_third(y: Self, x: Self) -> Self {
                by_polynomial(y / x, &$third)
            }

            #[inline(always)]
            fn atan_one(y: Self, x: Self) -> Self {
                by_polynomial(y / x, &$one)
            }

            #[inline(always)]
            fn quarter_less(a: Self) -> Self {
                let high = HALF_PI[0] as Self;
                high - (a - (HALF_PI[0] - f64::from(high) + HALF_PI[1]) as Self)
            }
        }
    )*};
}

plain!(
    f32 SINGLE_0_008 SINGLE_0_1 SINGLE_0_32 SINGLE_1
    f64 ATAN_0_008 ATAN_0_1 ATAN_0_32 ATAN_1
);

#[inline(always)]
fn by_polynomial<T: Real>(t: T, coefficients: &[T]) -> T {
    let z = t * t;
    (t * z).mul_add(polynomial(z, coefficients), t)
}

/// The polynomial is small beside the tangent: only the latter needs its error term.
#[inline(always)]
fn beside_tangent(t: Pair, coefficients: &[f64]) -> Pair {
    let z = t.high * t.high;
    Pair { high: t.high, low: (t.high * z).mul_add(polynomial(z, coefficients), t.low) }
}

impl Atan for Pair {
    #[inline(always)]
    fn atan_hundredth(y: Self, x: Self) -> Self {
        beside_tangent(y / x, &ATAN_0_008)
    }

    #[inline(always)]
    fn atan_tenth(y: Self, x: Self) -> Self {
        beside_tangent(y / x, &ATAN_0_1)
    }

    #[inline(always)]
    fn atan_third(y: Self, x: Self) -> Self {
        beside_tangent(y / x, &ATAN_0_32)
    }

    #[inline(always)]
    fn atan_one(y: Self, x: Self) -> Self {
        let t = y / x;
        let z = t.square();
        let sum = THIRD.plus_smaller(Self::exact(-(z.high * polynomial(z.high, &ATAN_1_TAIL))));
        t.plus_smaller(-(t * (z * sum)))
    }

    #[inline(always)]
    fn quarter_less(a: Self) -> Self {
        Self::new(HALF_PI[0], HALF_PI[1]).plus_smaller(-a)
    }
}
