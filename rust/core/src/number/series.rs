//! Sine and cosine to the last digits of a double-double, from their power series.
//!
//! A steep joint magnifies the errors of the joints and shafts before it by the reciprocal of its
//! cosine. The constants of a chain therefore need more digits than its results.

use crate::number::double_double::DoubleDouble;
use crate::number::float::Real;
use crate::number::trig::{Angle, polynomial};

/// Coefficients of a power series, lowest first: the large ones with their error terms.
struct PowerSeries {
    head: [(f64, f64); 8],
    tail: [f64; 6],
}

impl PowerSeries {
    #[inline(always)]
    fn of(&self, z: DoubleDouble) -> DoubleDouble {
        let mut sum = DoubleDouble::exact(polynomial(z.high, &self.tail));
        // A closure of this size would be compiled without the instruction set of its caller.
        for &(high, low) in self.head.iter().rev() {
            sum = DoubleDouble::new(high, low).fast_add(sum * z).rounded();
        }
        sum
    }
}

/// `sin r = r + r z P(z)` with `z = r²`.
const SINE: PowerSeries = PowerSeries {
    head: [
        (-0.166_666_666_666_666_66, -9.251_858_538_542_97e-18),
        (0.008_333_333_333_333_333, 1.156_482_317_317_871_4e-19),
        (-0.000_198_412_698_412_698_4, -1.720_955_829_342_070_5e-22),
        (2.755_731_922_398_589_3e-6, -1.858_393_274_046_472e-22),
        (-2.505_210_838_544_172e-8, 1.448_814_070_935_912e-24),
        (1.605_904_383_682_161_3e-10, 1.258_529_458_875_209_8e-26),
        (-7.647_163_731_819_816e-13, -7.038_728_777_334_53e-30),
        (2.811_457_254_345_520_6e-15, 1.650_884_273_086_143_3e-31),
    ],
    tail: [
        -8.220_635_246_624_33e-18,
        1.957_294_106_339_126_3e-20,
        -3.868_170_170_630_684e-23,
        6.446_950_284_384_474e-26,
        -9.183_689_863_795_546e-29,
        1.130_996_288_644_771_6e-31,
    ],
};

/// `cos r = 1 + z P(z)`.
const COSINE: PowerSeries = PowerSeries {
    head: [
        (-0.5, 0.0),
        (0.041_666_666_666_666_664, 2.312_964_634_635_742_7e-18),
        (-0.001_388_888_888_888_889, 5.300_543_954_373_577e-20),
        (2.480_158_730_158_73e-5, 2.151_194_786_677_588_2e-23),
        (-2.755_731_922_398_589e-7, -2.376_771_462_225_029_7e-23),
        (2.087_675_698_786_81e-9, -1.207_345_059_113_26e-25),
        (-1.147_074_559_772_972_5e-11, -2.065_551_275_283_074_5e-28),
        (4.779_477_332_387_385e-14, 4.399_205_485_834_081e-31),
    ],
    tail: [
        -1.561_920_696_858_622_5e-16,
        4.110_317_623_312_165e-19,
        -8.896_791_392_450_574e-22,
        1.611_737_571_096_118_4e-24,
        -2.479_596_263_224_797_6e-27,
        3.279_889_237_069_838e-30,
    ],
};

/// Sine and cosine of a remainder up to 0.79, with relative errors below 2⁻¹⁰⁰.
#[inline(always)]
pub(crate) fn sin_cos_of_remainder(r: DoubleDouble) -> (DoubleDouble, DoubleDouble) {
    let z = r.square().rounded();
    let sine = r.fast_add((r * z).rounded() * SINE.of(z)).rounded();
    (sine, DoubleDouble::ONE.fast_add(z * COSINE.of(z)).rounded())
}

/// Sine and cosine of a reduced angle.
#[inline(always)]
pub(crate) fn sin_cos((remainder, quadrant): (DoubleDouble, u64)) -> (DoubleDouble, DoubleDouble) {
    let (s, c) = sin_cos_of_remainder(remainder);
    let (odd, half) = (quadrant & 1, quadrant >> 1 & 1);
    let (s, c) = if odd == 1 { (c, s) } else { (s, c) };
    (s.turned_if(half), c.turned_if(half ^ odd))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn squares_add_to_one_and_angles_double() {
        for i in -200..=200 {
            let high = f64::from(i) * 0.0019;
            let r = DoubleDouble::new(high, high * 2_f64.powi(-54));
            let (sine, cosine) = sin_cos_of_remainder(r);
            let ones = sine.square() + cosine.square() - DoubleDouble::ONE;
            assert!(ones.value().abs() < 2_f64.powi(-100), "{high}");
            let (double, _) = sin_cos_of_remainder(r.scaled(2.0));
            let error = double - (sine * cosine).scaled(2.0);
            assert!(error.value().abs() <= 2_f64.powi(-99) * high.abs(), "{high}");
        }
    }
}
