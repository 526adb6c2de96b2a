//! Range reduction: an angle as a multiple of π/2 and a remainder.

use std::f64::consts::{FRAC_2_PI, FRAC_PI_2};

use crate::number::double_double::DoubleDouble;

/// π/2 as an unevaluated sum of three doubles.
pub(crate) const HALF_PI: [f64; 3] =
    [FRAC_PI_2, 6.123_233_995_736_766e-17, -1.497_384_904_859_169_8e-33];

/// Adding and subtracting 1.5·2⁵² rounds to the nearest integer and leaves it in the low bits.
pub(crate) const ROUNDING: f64 = 6_755_399_441_055_744.0;

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

/// The remainder of an angle to the nearest multiple of π/2, and the low bits of that multiple;
/// branch-free. NaN gives NaN. If [`LargeAngleFlag`] rejects the angle, both are meaningless.
///
/// `x − n·P1` is exact. The error of the three-part π/2 stays far below one rounding of the
/// remainder if `n` fits in 40 bits. Any remainder, however small, is within half an ulp.
#[inline(always)]
pub(crate) fn reduce(x: f64) -> (f64, u64) {
    let shifted = x.mul_add(FRAC_2_PI, ROUNDING);
    let n = shifted - ROUNDING;
    let r = (-n).mul_add(HALF_PI[0], x);
    let r = (-n).mul_add(HALF_PI[1], r);
    let r = (-n).mul_add(HALF_PI[2], r);
    (r, shifted.to_bits())
}

/// The same for an angle with an error term; the remainder has one too.
#[inline(always)]
pub(crate) fn reduce_double_double(x: DoubleDouble) -> (DoubleDouble, u64) {
    let shifted = x.high.mul_add(FRAC_2_PI, ROUNDING);
    let n = shifted - ROUNDING;
    let near = (-n).mul_add(HALF_PI[0], x.high);
    let product = DoubleDouble::two_product(n, HALF_PI[1]);
    let remainder = DoubleDouble::two_sum(near, -product.high);
    let low = (-n).mul_add(HALF_PI[2], remainder.low - product.low) + x.low;
    (DoubleDouble::fast_two_sum(remainder.high, low), shifted.to_bits())
}

/// Adding 1.5·2²² rounds to a multiple of 2⁻³⁰ and leaves it in the low bits.
const TURN_FRACTION_ROUNDING: f64 = 6_291_456.0;

/// An angle in units of 2⁻³⁰ quarter turns, in the low 32 bits, from one operation. The error of
/// 7e-10 is absolute and does not shrink with the remainder.
#[inline(always)]
pub(crate) fn turn_fraction_q30(x: f64) -> u64 {
    x.mul_add(FRAC_2_PI, TURN_FRACTION_ROUNDING).to_bits()
}

/// Remainder and quadrant of an angle in the units of [`turn_fraction_q30`].
#[inline(always)]
pub(crate) fn from_turn_fraction(phase: u32) -> (f32, u64) {
    const UNIT: f32 = (FRAC_PI_2 / (1_u64 << 32) as f64) as f32;
    let quadrant = phase.wrapping_add(1 << 29) >> 30;
    ((phase << 2) as i32 as f32 * UNIT, u64::from(quadrant))
}

/// Records whether any of a series of angles was too large for its reduction.
#[derive(Clone, Copy)]
pub(crate) struct LargeAngleFlag {
    least: u64,
    span: u64,
    accumulated: u64,
}

impl LargeAngleFlag {
    /// For [`reduce`]: angles from about 1.7e12 are too large.
    pub(crate) const fn for_quadrants() -> Self {
        Self { least: ROUNDING.to_bits() - (1 << 40), span: 1 << 41, accumulated: 0 }
    }

    /// Records one reduction, with two integer operations.
    #[inline(always)]
    pub(crate) fn accumulate(&mut self, bits: u64) {
        self.accumulated |= bits.wrapping_sub(self.least);
    }

    /// Whether any angle was too large or NaN.
    #[inline(always)]
    pub(crate) fn any(self) -> bool {
        self.accumulated >= self.span
    }
}

/// The same for [`turn_fraction_q30`]: angles from about 3.2e6 are too large.
#[derive(Clone, Copy, Default)]
pub(crate) struct LargeFractionFlag {
    accumulated: u64,
}

impl LargeFractionFlag {
    /// Records one turn fraction. Those of other angles have the exponent of the constant that
    /// rounds them, so that one operation suffices.
    #[inline(always)]
    pub(crate) fn accumulate(&mut self, fraction: u64) {
        self.accumulated |= fraction ^ TURN_FRACTION_ROUNDING.to_bits();
    }

    /// Whether any angle was too large or NaN.
    #[inline(always)]
    pub(crate) fn any(self) -> bool {
        self.accumulated >= 1 << 52
    }
}

/// [`reduce_double_double`] for any angle; infinite angles and NaN give NaN.
pub(crate) fn reduce_any(x: f64) -> (DoubleDouble, u64) {
    let near = reduce_double_double(DoubleDouble::exact(x));
    let mut too_large = LargeAngleFlag::for_quadrants();
    too_large.accumulate(near.1);
    if !too_large.any() || x.is_nan() {
        near
    } else if x.is_infinite() {
        (DoubleDouble::exact(f64::NAN), 0)
    } else {
        let (r, n) = reduce_exactly(x.abs());
        if x > 0.0 { (r, n) } else { (-r, n.wrapping_neg()) }
    }
}

/// [`reduce_any`] for an angle with an error term.
pub(crate) fn reduce_any_sum(x: DoubleDouble) -> (DoubleDouble, u64) {
    let near = reduce_double_double(x);
    let mut too_large = LargeAngleFlag::for_quadrants();
    too_large.accumulate(near.1);
    if !too_large.any() {
        return near;
    }
    let ((high, quadrant), (low, quadrants)) = (reduce_any(x.high), reduce_any(x.low));
    let (sum, more) = reduce_double_double((high + low).renormalized());
    (sum, quadrant.wrapping_add(quadrants).wrapping_add(more))
}

/// Reduces twice the angle, given the reduced angle.
pub(crate) fn double_angle((remainder, quadrant): (DoubleDouble, u64)) -> (DoubleDouble, u64) {
    let (double, quadrants) = (remainder.scaled(2.0), quadrant.wrapping_mul(2));
    let quarter = DoubleDouble::fast_two_sum(HALF_PI[0], HALF_PI[1]);
    if double.high > 0.5 * HALF_PI[0] {
        (double - quarter, quadrants.wrapping_add(1))
    } else if double.high < -0.5 * HALF_PI[0] {
        (double + quarter, quadrants.wrapping_sub(1))
    } else {
        (double, quadrants)
    }
}

/// The remainder of a large finite `x` to the nearest multiple of π/2, and the low bits of
/// that multiple (M. Payne and R. Hanek, 1983).
///
/// `x = m·2ᵉ`, so only a window of the digits of 2/π matters: digits before it give whole turns,
/// digits after it less than 2⁻²⁰⁰.
fn reduce_exactly(x: f64) -> (DoubleDouble, u64) {
    let bits = x.to_bits();
    let exponent = ((bits >> 52) as i64) - 1075;
    let mantissa = u128::from((bits & ((1 << 52) - 1)) | (1 << 52));

    // 256 digits of 2/π, the first of weight 2^(1 − exponent): 2^-254 · m · window ≡ x·2/π mod 4.
    // The first digit after the point has index 1; a leading zero word represents the earlier ones.
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
    let rest = low.mul_add(HALF_PI[0], high.mul_add(HALF_PI[1], error));
    (DoubleDouble::fast_two_sum(product, rest), quadrant + u64::from(round_up))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::number::float::Real;
    use crate::number::trig;

    /// Doubles near multiples of π/2: `m 2ᵉ`, the multiple modulo 4, and the remainder in two
    /// words, from continued fractions with 2600 binary digits.
    #[test]
    fn the_hardest_angles_keep_their_remainders() {
        for (m, e, quadrant, high, low) in [
            (
                6_081_371_451_248_382.0,
                2,
                3,
                -1.204_793_787_448_257_4e-16,
                -8.235_138_092_891_066e-33,
            ),
            (
                6_617_649_673_795_284.0,
                21,
                0,
                -3.282_049_487_355_787_7e-16,
                1.205_278_970_206_192e-32,
            ),
            (
                7_564_982_981_241_832.0,
                66,
                0,
                1.031_686_394_783_722_8e-15,
                5.372_248_432_549_067e-32,
            ),
            (
                5_916_243_447_979_695.0,
                79,
                3,
                -1.820_856_637_738_217_2e-18,
                -5.685_995_758_625_758e-35,
            ),
            (
                4_595_526_034_082_901.0,
                130,
                3,
                -8.383_097_382_872_87e-18,
                6.498_635_602_182_723_6e-34,
            ),
            (
                6_814_427_304_870_727.0,
                337,
                1,
                1.314_044_716_300_057_7e-16,
                -4.994_089_016_214_096_4e-33,
            ),
            (
                6_381_956_970_095_103.0,
                797,
                1,
                4.687_165_924_254_628e-19,
                -4.372_055_742_938_273_3e-36,
            ),
            (
                6_381_956_970_095_103.0,
                798,
                2,
                9.374_331_848_509_255e-19,
                -8.744_111_485_876_547e-36,
            ),
            (
                8_444_920_710_073_313.0,
                939,
                1,
                -2.014_938_667_495_223_8e-18,
                -1.102_722_809_638_444_6e-34,
            ),
            (
                5_466_744_517_559_360.0,
                962,
                0,
                -1.641_208_296_909_437_4e-15,
                1.354_496_404_218_008_2e-33,
            ),
        ] {
            let x: f64 = m * 2_f64.powi(e);
            for (x, quadrant, sense) in [(x, quadrant, 1.0), (-x, 4 - quadrant, -1.0)] {
                let (r, n) = reduce_any(x);
                let error = (r.scaled(sense) - DoubleDouble::new(high, low)).value() / high;
                assert!(error.abs() < 2_f64.powi(-100), "{x:e}: {error:e}");
                assert_eq!(n & 3, quadrant & 3, "{x:e}");
            }
        }
        for (m, e, quadrant, nearest) in [
            (6_411_027_962_775_774.0, -47, 1, 6.189_806_365_883_577e-19),
            (7_763_785_107_565_477.0, -29, 3, -1.698_503_829_898_600_4e-18),
        ] {
            let (r, n) = reduce(m * 2_f64.powi(e));
            assert_eq!((r, n & 3), (nearest, quadrant));
        }
    }

    #[test]
    fn twice_an_angle_has_its_double_sine() {
        for x in (-40..=40).flat_map(|i| [0.1, 1e14, 7e200].map(|step| f64::from(i) * step)) {
            let (r, n) = double_angle(reduce_any(x));
            assert!(r.high.abs() <= 0.5 * HALF_PI[0], "{x:e}");
            let (sine, cosine) = trig::sin_cos_double_double(reduce_any(x));
            let (double_sine, double_cosine) = trig::sin_cos_double_double((r, n));
            let errors = [
                double_sine - (sine * cosine).scaled(2.0),
                double_cosine - (cosine.square() - sine.square()),
            ];
            assert!(errors.iter().all(|error| error.value().abs() < 2_f64.powi(-60)), "{x:e}");
        }
    }
}
