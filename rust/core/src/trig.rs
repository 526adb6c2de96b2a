//! Sine, cosine and inverse tangent as branch-free arithmetic on plain `f64`.
//!
//! Loops over these functions vectorise at every instruction set, and because every step is an
//! exactly rounded operation (`mul_add` included) the bits are the same at every one of them.
//!
//! The polynomials are minimax fits in `z = r²` to the stated relative error of the function
//! itself (Remez exchange in 60-digit arithmetic); the tests check them against an independent
//! evaluation.

use std::f64::consts::{FRAC_2_PI, FRAC_PI_2};

/// π/2 as an unevaluated sum of three doubles.
const HALF_PI: [f64; 3] = [FRAC_PI_2, 6.123_233_995_736_766e-17, -1.497_384_904_859_169_8e-33];

/// Adding and subtracting 1.5·2⁵² rounds to the nearest integer and leaves it in the low bits.
const ROUNDING: f64 = 6_755_399_441_055_744.0;

/// `sin r = r + r z P(z)` for `|r| ≤ 0.7862`, relative error 2⁻⁵⁸.
const SINE: [f64; 6] = [
    -0.166_666_666_666_666_3,
    0.008_333_333_333_322_004,
    -0.000_198_412_698_294_934_9,
    2.755_731_358_689_876e-6,
    -2.505_074_219_158_179e-8,
    1.589_589_781_063_074_5e-10,
];

/// `cos r = 1 − z/2 + z² P(z)` for `|r| ≤ 0.7862`, relative error 2⁻⁶³.
const COSINE: [f64; 6] = [
    0.041_666_666_666_666_595,
    -0.001_388_888_888_887_289,
    2.480_158_728_874_602_8e-5,
    -2.755_731_414_798_439e-7,
    2.087_569_648_366_902_2e-9,
    -1.135_830_578_459_391_1e-11,
];

/// `tan r = r (1 + z P(z))/(1 + z Q(z))` for `|r| ≤ 0.7862`, relative error 2⁻⁵⁵·⁴: this is `P`.
const TANGENT_NUMERATOR: [f64; 3] =
    [-0.128_282_632_120_567_1, 0.002_805_824_821_214_388_8, -7.482_729_016_475_043e-6];

/// The `Q` to it.
const TANGENT_DENOMINATOR: [f64; 3] =
    [-0.461_615_965_453_898_44, 0.023_344_479_972_454_618, -0.000_208_434_626_985_413_96];

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

/// The binary digits of 2/π after the point, enough for the largest double.
const TWO_OVER_PI: [u64; 21] = [
    0xa2f9_836e_4e44_1529,
    0xfc27_57d1_f534_ddc0,
    0xdb62_9599_3c43_9041,
    0xfe51_63ab_debb_c561,
    0xb724_6e3a_424d_d2e0,
    0x0649_2eea_09d1_921c,
    0xfe1d_eb1c_b129_a73e,
    0xe882_35f5_2ebb_4484,
    0xe99c_7026_b45f_7e41,
    0x3991_d639_8353_39f4,
    0x9c84_5f8b_bdf9_283b,
    0x1ff8_97ff_de05_980f,
    0xef2f_118b_5a0a_6d1f,
    0x6d36_7ecf_27cb_09b7,
    0x4f46_3f66_9e5f_ea2d,
    0x7527_bac7_ebe5_f17b,
    0x3d07_39f7_8a52_92ea,
    0x6bfb_5fb1_1f8d_5d08,
    0x5603_3046_fc7b_6bab,
    0xf0cf_bc20_9af4_361d,
    0xa9e3_9161_5ee6_1b08,
];

/// Horner's rule, lowest coefficient first.
#[inline(always)]
fn polynomial<const N: usize>(z: f64, coefficients: &[f64; N]) -> f64 {
    let mut sum = coefficients[N - 1];
    for &coefficient in coefficients[..N - 1].iter().rev() {
        sum = sum.mul_add(z, coefficient);
    }
    sum
}

/// Sine and cosine of `high + low`, `|high| ≤ π/4`, each as a double and its error term, together
/// within 2⁻⁵⁶ of themselves.
fn sin_cos_of_remainder([high, low]: [f64; 2]) -> ([f64; 2], [f64; 2]) {
    let z = high * high;
    let sine = (high * z) * polynomial(z, &SINE);
    // 1 − z/2 is rounded once; what the rounding and the square lost goes to the small terms.
    let half = 0.5 * z;
    let head = 1.0 - half;
    let lost = ((1.0 - head) - half) - 0.5 * high.mul_add(high, -z);
    let cosine = (z * z).mul_add(polynomial(z, &COSINE), lost);
    (in_two(high, low.mul_add(head, sine)), in_two(head, cosine - low * high))
}

/// The sum of a double and a smaller one as the nearest double and its error.
pub(crate) fn in_two(large: f64, small: f64) -> [f64; 2] {
    let sum = large + small;
    [sum, small - (sum - large)]
}

/// Numerator and denominator of the rational tangent of `r`, `|r| ≤ π/4`.
#[inline(always)]
fn tangent_of_remainder(r: f64) -> (f64, f64) {
    let z = r * r;
    let numerator = (r * z).mul_add(polynomial(z, &TANGENT_NUMERATOR), r);
    (numerator, z.mul_add(polynomial(z, &TANGENT_DENOMINATOR), 1.0))
}

/// An angle as a multiple of π/2 and a remainder.
#[derive(Clone, Copy)]
pub(crate) struct Reduced {
    /// Within half an ulp, however small it is.
    remainder: f64,
    /// The multiple, in the low bits.
    quadrant: u64,
}

/// Reduces an angle, branch-free. NaN gives NaN; an angle that does not pass [`Far`] gives numbers
/// without meaning.
///
/// `x − n·P1` is exact and the error of the three-part π/2 stays far below one rounding of the
/// remainder as long as `n` fits in 40 bits.
#[inline(always)]
pub(crate) fn reduce(x: f64) -> Reduced {
    let shifted = x.mul_add(FRAC_2_PI, ROUNDING);
    let n = shifted - ROUNDING;
    let r = (-n).mul_add(HALF_PI[0], x);
    let r = (-n).mul_add(HALF_PI[1], r);
    let r = (-n).mul_add(HALF_PI[2], r);
    Reduced { remainder: r, quadrant: shifted.to_bits() }
}

/// Watches a run of reductions for angles that are too far for [`reduce`]: from about 1.7e12.
#[derive(Clone, Copy, Default)]
pub(crate) struct Far(u64);

impl Far {
    const LIMIT: u64 = 1 << 40;

    /// Takes note of one reduction: two integer operations.
    #[inline(always)]
    pub(crate) fn watch(&mut self, reduced: Reduced) {
        let least = ROUNDING.to_bits() - Self::LIMIT;
        self.0 |= reduced.quadrant.wrapping_sub(least);
    }

    /// Whether any angle was too far, or not a number.
    #[inline(always)]
    pub(crate) fn any(self) -> bool {
        self.0 >= 2 * Self::LIMIT
    }
}

/// A vector along `(sin x, cos x)` or against it, of a length between 0.9 and 1.1.
///
/// What depends on a pin as a line, such as a tangent or a ratio of squares, sees neither the
/// length nor the sense, and a rational tangent costs half of a sine and a cosine.
#[inline(always)]
pub(crate) fn pin(reduced: Reduced) -> (f64, f64) {
    let (s, c) = tangent_of_remainder(reduced.remainder);
    let odd = reduced.quadrant & 1;
    let (s, c) = if odd == 1 { (c, s) } else { (s, c) };
    (s, f64::from_bits(c.to_bits() ^ odd << 63))
}

/// The same along `(sin x, cos x)`, for what depends on the sense of a pin.
#[inline(always)]
pub(crate) fn sensed_pin(reduced: Reduced) -> (f64, f64) {
    let (s, c) = pin(reduced);
    let against = (reduced.quadrant & 2) << 62;
    (f64::from_bits(s.to_bits() ^ against), f64::from_bits(c.to_bits() ^ against))
}

/// Sine and cosine of any angle, each within 0.7 ulp; infinite angles and NaN give NaN.
///
/// ```
/// let (sine, cosine) = cardan::trig::sin_cos(1e300);
/// assert!((sine + 0.8178819121159085).abs() < 1e-15);
/// assert!((cosine + 0.5753861119575491).abs() < 1e-15);
/// ```
pub fn sin_cos(x: f64) -> (f64, f64) {
    let ([sine, _], [cosine, _]) = sin_cos_in_two(x);
    (sine, cosine)
}

/// Sine and cosine of any angle, each as a double and its error term.
pub(crate) fn sin_cos_in_two(x: f64) -> ([f64; 2], [f64; 2]) {
    let (remainder, n) = reduce_in_two(x);
    let (s, c) = sin_cos_of_remainder(remainder);
    let (s, c) = if n & 1 == 1 { (c, s) } else { (s, c) };
    let signed = |pair: [f64; 2], n: u64| if n & 2 == 0 { pair } else { pair.map(|x| -x) };
    (signed(s, n), signed(c, n.wrapping_add(1)))
}

/// The remainder of any angle as a double and its error term, and the multiple of π/2.
fn reduce_in_two(x: f64) -> ([f64; 2], u64) {
    let Reduced { remainder, quadrant } = reduce(x);
    let mut far = Far::default();
    far.watch(Reduced { remainder, quadrant });
    if far.any() {
        let Reduced { remainder, quadrant } = reduce_any(x);
        return ([remainder, 0.0], quadrant);
    }
    let n = x.mul_add(FRAC_2_PI, ROUNDING) - ROUNDING;
    let near = (-n).mul_add(HALF_PI[0], x);
    let product = n * HALF_PI[1];
    let high = near - product;
    let back = near - high;
    let lost = (back - product) + (near - (high + back));
    let low = (-n).mul_add(HALF_PI[2], lost - n.mul_add(HALF_PI[1], -product));
    ([high, low], quadrant)
}

/// [`reduce`] for any angle; infinite angles and NaN give NaN.
pub(crate) fn reduce_any(x: f64) -> Reduced {
    let reduced = reduce(x);
    let mut far = Far::default();
    far.watch(reduced);
    if !far.any() || x.is_nan() {
        reduced
    } else if x.is_infinite() {
        Reduced { remainder: f64::NAN, quadrant: 0 }
    } else {
        let (r, n) = reduce_exactly(x.abs());
        let (remainder, quadrant) = if x > 0.0 { (r, n) } else { (-r, n.wrapping_neg()) };
        Reduced { remainder, quadrant }
    }
}

/// The remainder of a large finite `x` to the nearest multiple of π/2, and the low bits of
/// that multiple (M. Payne and R. Hanek, 1983).
///
/// `x = m·2ᵉ`, so of the digits of 2/π only a window matters: those before it give whole turns,
/// those behind it less than 2⁻²⁰⁰.
fn reduce_exactly(x: f64) -> (f64, u64) {
    let bits = x.to_bits();
    let exponent = ((bits >> 52) as i64) - 1075;
    let mantissa = u128::from((bits & ((1 << 52) - 1)) | (1 << 52));

    // 256 digits of 2/π, the first of weight 2^(1 − exponent): 2^-254 · m · window ≡ x·2/π mod 4.
    // The first digit behind the point has index 1; a leading word of zeros stands for the others.
    let first = exponent - 1 + 63;
    let (word, shift) = ((first / 64) as usize, (first % 64) as u32);
    let digit_word = |i: usize| if i == 0 { 0 } else { TWO_OVER_PI[i - 1] };
    let mut product = [0_u64; 4]; // low word first
    let mut carry = 0_u128;
    for (i, place) in product.iter_mut().enumerate() {
        let high = word + 3 - i;
        let window = if shift == 0 {
            digit_word(high)
        } else {
            digit_word(high) << shift | digit_word(high + 1) >> (64 - shift)
        };
        let sum = mantissa * u128::from(window) + carry;
        *place = sum as u64;
        carry = sum >> 64;
    }
    let top = u128::from(product[3]) << 64 | u128::from(product[2]);
    let quadrant = (top >> 126) as u64;
    // The fraction of a quadrant, in units of 2⁻²⁵⁶ of four quadrants, as a signed distance.
    let mut fraction_high = top << 2 | u128::from(product[1] >> 62);
    let mut fraction_low = product[1] << 2 | product[0] >> 62;
    let round_up = fraction_high >> 127 == 1;
    if round_up {
        fraction_low = fraction_low.wrapping_neg();
        fraction_high = (!fraction_high).wrapping_add(u128::from(fraction_low == 0));
    }
    let zeros = fraction_high.leading_zeros();
    let aligned = if zeros == 0 {
        fraction_high
    } else {
        fraction_high << zeros | u128::from(fraction_low) << 64 >> (128 - zeros.min(64))
    };
    let scale = 0.5_f64.powi(64 + zeros as i32);
    let head = (aligned >> 75 << 11) as u64;
    let high = head as f64 * scale;
    let low = ((aligned >> 11) as u64) as f64 * scale * 0.5_f64.powi(53);
    let (high, low) = if round_up { (-high, -low) } else { (high, low) };
    let product = high * HALF_PI[0];
    let error = high.mul_add(HALF_PI[0], -product);
    let r = product + low.mul_add(HALF_PI[0], high.mul_add(HALF_PI[1], error));
    (r, quadrant + u64::from(round_up))
}

/// The inverse tangent that an angle error needs, chosen once from the largest tangent in reach.
///
/// `|tan Δ| ≤ (1 − cos β)/(2 √cos β)` is known before the first angle, and short polynomials do
/// for the bends that occur in practice.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum AtanRange {
    /// Tangents up to 0.008 (one joint: bends to 10.2°), 3 terms.
    Hundredth,
    /// Tangents up to 0.1004 (bends to 35°), 6 terms.
    Tenth,
    /// Tangents up to 0.32 (bends to 57°), 11 terms.
    Third,
    /// Tangents up to 1 (bends to 80°), 20 terms.
    One,
    /// Any tangent: 20 terms and an exchange of the sides.
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
}

#[inline(always)]
fn atan_polynomial<const N: usize>(y: f64, x: f64, coefficients: &[f64; N]) -> f64 {
    let t = y / x;
    let z = t * t;
    (t * z).mul_add(polynomial(z, coefficients), t)
}

/// `atan(y/x)` for `x > 0` and `|y| ≤ 0.008 x`.
#[inline(always)]
pub fn atan_hundredth(y: f64, x: f64) -> f64 {
    atan_polynomial(y, x, &ATAN_0_008)
}

/// `atan(y/x)` for `x > 0` and `|y| ≤ 0.1004 x`.
#[inline(always)]
pub fn atan_tenth(y: f64, x: f64) -> f64 {
    atan_polynomial(y, x, &ATAN_0_1)
}

/// `atan(y/x)` for `x > 0` and `|y| ≤ 0.32 x`.
#[inline(always)]
pub fn atan_third(y: f64, x: f64) -> f64 {
    atan_polynomial(y, x, &ATAN_0_32)
}

/// `atan(y/x)` for `x > 0` and `|y| ≤ x`.
#[inline(always)]
pub fn atan_one(y: f64, x: f64) -> f64 {
    atan_polynomial(y, x, &ATAN_1)
}

/// `atan(y/x)` for `x > 0`.
#[inline(always)]
pub fn atan_any(y: f64, x: f64) -> f64 {
    let size = y.abs();
    let steep = size > x;
    let (small, large) = if steep { (x, size) } else { (size, x) };
    let a = atan_polynomial(small, large, &ATAN_1);
    let a = if steep { HALF_PI[0] - (a - HALF_PI[1]) } else { a };
    a.copysign(y)
}
