//! Elementary functions with the same bits on every machine.
//!
//! Those of the standard library are the platform's, and two platforms differ by an ulp. What is
//! needed here is the crate `libm`'s, compiled with the core, and an inverse tangent with error
//! terms. `clippy.toml` keeps the others out.

use nalgebra::Complex;

use crate::number::atan::Atan;
use crate::number::double_double::DoubleDouble;
use crate::number::float::inverse_power_of_two;
use crate::number::reduction::HALF_PI;
use crate::number::trig;

pub(crate) use libm::{acos, asin, cbrt, hypot, log as ln, log1p as ln_1p, log10, pow, sinh, tan};

/// The angle of the point `(x, y)` in `[−π, π]`, with the signs and the limits of [`f64::atan2`].
///
/// Within 0.55 ulp: the error terms leave out the rounding of the polynomial, which is at most a
/// twentieth of the tangent.
#[inline]
pub(crate) fn atan2(y: f64, x: f64) -> f64 {
    let (height, width) = (y.abs(), x.abs());
    if height == 0.0 || height.is_infinite() || width == 0.0 || width.is_infinite() {
        return at_the_limits(y, x);
    }
    finite_atan2(y, x)
}

/// The same for finite coordinates of which `x` is not zero or positive zero, and not both zero;
/// branch-free.
#[inline(always)]
pub(crate) fn finite_atan2(y: f64, x: f64) -> f64 {
    let (height, width) = (y.abs(), x.abs());
    // A power of two keeps quotients and their error terms in range. NaN passes through.
    let scale = inverse_power_of_two(height.max(width));
    let [height, width] = [height, width].map(|side| DoubleDouble::exact(side * scale));
    let angle = DoubleDouble::atan_any(height, width);
    let angle =
        if x < 0.0 { DoubleDouble::new(2.0 * HALF_PI[0], 2.0 * HALF_PI[1]) - angle } else { angle };
    angle.value().copysign(y)
}

/// The same where a coordinate is zero or infinite.
#[cold]
fn at_the_limits(y: f64, x: f64) -> f64 {
    if y.is_nan() || x.is_nan() {
        return f64::NAN;
    }
    let eighths = if y == 0.0 {
        0.0
    } else if x == 0.0 || x.is_finite() && y.is_infinite() {
        2.0
    } else {
        f64::from(u8::from(y.is_infinite()))
    };
    let eighths = if x.is_sign_negative() { 4.0 - eighths } else { eighths };
    (eighths * (0.5 * HALF_PI[0])).copysign(y)
}

/// The inverse tangent.
#[inline]
pub(crate) fn atan(x: f64) -> f64 {
    atan2(x, 1.0)
}

/// The absolute value of a complex number.
#[inline]
pub(crate) fn norm(z: Complex<f64>) -> f64 {
    hypot(z.re, z.im)
}

/// `eⁱˣ`.
pub(crate) fn turn(x: f64) -> Complex<f64> {
    let (sine, cosine) = trig::sin_cos(x);
    Complex::new(cosine, sine)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

    use super::*;
    use crate::number::series;

    /// The angle before it is rounded lies on the ray to the point.
    #[test]
    fn the_angle_points_at_the_point() {
        for i in 0..4000 {
            let x = 10_f64.powi(i % 40 - 20) * (f64::from(i) * 0.7).sin();
            let y = 10_f64.powi(i / 40 % 40 - 20) * (f64::from(i) * 1.3).cos();
            let angle = atan2(y, x);
            let (s, c) = series::sin_cos(crate::number::reduction::reduce_any(angle));
            let off =
                (s * DoubleDouble::exact(x) - c * DoubleDouble::exact(y)).value() / x.hypot(y);
            let ulp = angle.abs().next_up() - angle.abs();
            assert!(off.abs() <= 0.55 * ulp, "atan2({y:e}, {x:e}): {:.3} ulp", off.abs() / ulp);
            assert!((angle - y.atan2(x)).abs() <= ulp, "{y:e} {x:e}");
        }
    }

    #[test]
    fn zeros_and_infinities_are_those_of_the_standard_library() {
        let values = [0.0, 1.0, f64::INFINITY, f64::MAX, f64::MIN_POSITIVE, 5e-324, 1e-310];
        for &y in &values {
            for &x in &values {
                for (y, x) in [(y, x), (-y, x), (y, -x), (-y, -x)] {
                    assert_eq!(atan2(y, x).to_bits(), y.atan2(x).to_bits(), "atan2({y:e}, {x:e})");
                }
            }
        }
        assert!(atan2(f64::NAN, 1.0).is_nan() && atan2(0.0, f64::NAN).is_nan());
    }

    #[test]
    fn known_angles_are_exact() {
        assert_eq!(atan2(1.0, 1.0), FRAC_PI_4);
        assert_eq!(atan2(3e-200, -3e-200), 3.0 * FRAC_PI_4);
        assert_eq!(atan2(-2.0, 0.0), -FRAC_PI_2);
        assert_eq!(atan2(0.0, -1.0), PI);
        assert_eq!(norm(Complex::new(3.0, -4.0)), 5.0);
        assert_eq!(turn(0.0), Complex::new(1.0, 0.0));
    }
}
