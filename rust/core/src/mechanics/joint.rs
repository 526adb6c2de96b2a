//! One universal joint: the constants of its bend, its extremes in closed form, and its motion.
//!
//! The functions for one angle take sine and cosine of the joint's input angle; the kernels call
//! them in loops.

use crate::number::atan::AtanRange;
use crate::number::double_double::DoubleDouble;
use crate::number::elementary;
use crate::number::float::Real;
use crate::number::reduction::HALF_PI;
use crate::number::series;
use crate::number::trig;

/// The constants of one joint with a given bend.
///
/// Each is computed from its own well-conditioned formula with error terms. All are therefore the
/// nearest numbers, from the smallest bend to the largest double below 90°.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Joint<T = f64> {
    /// `cos β`, the smallest speed ratio.
    pub cos: T,
    /// `cos² β`.
    pub cos2: T,
    /// `sin β`.
    pub sin: T,
    /// `sin² β`.
    pub sin2: T,
    /// `1 − cos β`.
    pub versine: T,
    /// `cos β/(1 − cos β)`, the reciprocal of the exsecant; infinite for a straight joint.
    pub inverse_exsecant: T,
    /// `k = tan²(β/2)`.
    pub k: T,
}

impl Joint<DoubleDouble> {
    /// The straight joint, which does not change the rotation.
    pub const STRAIGHT: Self = Self {
        cos: DoubleDouble::ONE,
        cos2: DoubleDouble::ONE,
        sin: DoubleDouble::exact(0.0),
        sin2: DoubleDouble::exact(0.0),
        versine: DoubleDouble::exact(0.0),
        inverse_exsecant: DoubleDouble::exact(f64::INFINITY),
        k: DoubleDouble::exact(0.0),
    };

    /// The joint with a bend in `[0, π/2)`, in rad.
    #[inline(always)]
    pub fn with_error_terms(bend: f64) -> Self {
        Self::by(bend, 0.0, trig::sin_cos_of_remainder)
    }

    /// The same with nearly all digits of a double-double, for the map of a chain.
    #[inline(always)]
    pub(crate) fn of_chain(bend: f64) -> Self {
        Self::by(bend, HALF_PI[2], series::sin_cos_of_remainder)
    }

    #[inline(always)]
    fn by(
        bend: f64,
        third: f64,
        sin_cos: impl Fn(DoubleDouble) -> (DoubleDouble, DoubleDouble),
    ) -> Self {
        let steep = bend > 0.5 * HALF_PI[0];
        // The difference is exact: the bend is more than half of π/2.
        let mut complement = DoubleDouble::fast_two_sum(HALF_PI[0] - bend, HALF_PI[1]);
        complement.low += third;
        let (s, c) = sin_cos(if steep { complement } else { DoubleDouble::exact(bend) });
        let (sin, cos) = if steep { (c, s) } else { (s, c) };
        let (half_sine, _) = sin_cos(DoubleDouble::exact(0.5 * bend));
        let versine = half_sine.square().scaled(2.0);
        Self {
            cos,
            cos2: cos.square(),
            sin,
            sin2: sin.square(),
            versine,
            inverse_exsecant: inverse_exsecant(cos, versine),
            k: versine / DoubleDouble::ONE.fast_add(cos),
        }
    }

    /// The joint with the given `k = tan²(β/2)` and with `1 − k²`, which the caller knows without
    /// cancellation.
    #[inline(always)]
    pub(crate) fn from_k(k: DoubleDouble, complement: DoubleDouble) -> Self {
        let one_plus = DoubleDouble::ONE.fast_add(k);
        let square = one_plus.square();
        let cos = complement / square;
        let versine = k.scaled(2.0) / one_plus;
        Self {
            cos,
            cos2: cos.square(),
            sin: k.sqrt().scaled(2.0) / one_plus,
            sin2: k.scaled(4.0) / square,
            versine,
            inverse_exsecant: inverse_exsecant(cos, versine),
            k,
        }
    }
}

/// The constants of a joint that the functions for one angle use.
#[derive(Clone, Copy, Debug)]
pub(crate) struct JointConstants<T> {
    pub(crate) cos: T,
    pub(crate) cos2: T,
    pub(crate) sin2: T,
    pub(crate) versine: T,
    pub(crate) inverse_exsecant: T,
}

impl<T: Real> JointConstants<T> {
    /// The constants rounded to a kernel's number type.
    #[inline(always)]
    pub(crate) fn nearest(joint: &Joint<DoubleDouble>) -> Self {
        let [cos, cos2, sin2, versine, inverse_exsecant] =
            [joint.cos, joint.cos2, joint.sin2, joint.versine, joint.inverse_exsecant]
                .map(T::from_double_double);
        Self { cos, cos2, sin2, versine, inverse_exsecant }
    }

    /// The constants of a moderate bend, each within 0.6 ulp, for a geometry that changes with the
    /// angle and needs them at every sample. The inverse exsecant is not needed and is left at
    /// zero.
    ///
    /// All of them follow from `1 − cos β = 2 sin² (β/2)`. In `sin h = h + c` the second part is
    /// small, so `sin² h = h² + 2hc + c²` gives more digits than a double from a `c` in one double.
    #[inline(always)]
    pub(crate) fn of_moderate_bend(bend: f64) -> Self {
        let half = 0.5 * bend;
        let DoubleDouble { high: square, low } = DoubleDouble::two_product(half, half);
        let rest = half * square * trig::sine_tail(square);
        let rest = bend.mul_add(rest, rest.mul_add(rest, low));
        let versine = DoubleDouble::fast_two_sum(square, rest).scaled(2.0);
        let cos = DoubleDouble::ONE.fast_add(-versine).rounded();
        let sin2 = versine * DoubleDouble::exact(2.0).fast_add(-versine);
        let [cos2, sin2] = [cos.square(), sin2].map(T::from_double_double);
        let inverse_exsecant = T::from_f64(0.0);
        Self {
            cos: T::from_double_double(cos),
            cos2,
            sin2,
            versine: T::from_double_double(versine),
            inverse_exsecant,
        }
    }

    /// The range of the inverse tangent for the joint's angle error.
    #[inline(always)]
    pub(crate) fn range(&self) -> AtanRange {
        let (versine, cos): (f64, f64) = (self.versine.value().into(), self.cos.value().into());
        AtanRange::holding_squares(versine * versine, 4.0 * cos)
    }
}

impl JointConstants<f64> {
    /// The constants of a joint in double precision.
    #[inline(always)]
    pub(crate) fn of_doubles(joint: &Joint) -> Self {
        let Joint { cos, cos2, sin2, versine, inverse_exsecant, .. } = *joint;
        Self { cos, cos2, sin2, versine, inverse_exsecant }
    }
}

#[inline(always)]
fn inverse_exsecant(cos: DoubleDouble, versine: DoubleDouble) -> DoubleDouble {
    let quotient = cos / versine;
    let finite = versine.high > f64::MIN_POSITIVE;
    if finite { quotient } else { DoubleDouble::exact(f64::INFINITY) }
}

impl<T: Real> Joint<T> {
    /// `1 − k²`.
    #[inline(always)]
    pub(crate) fn complement(&self) -> T {
        self.cos * (T::from_f64(1.0) + self.k).square()
    }
}

impl Joint {
    /// The joint with a bend in `[0, π/2)`, in rad.
    ///
    /// ```
    /// let joint = cardan::Joint::new(30_f64.to_radians());
    /// assert!((joint.max_angle_error().to_degrees() - 4.1172).abs() < 1e-4);
    /// assert!((joint.non_uniformity() - 0.288_675).abs() < 1e-6);
    /// ```
    pub fn new(bend: f64) -> Self {
        Self::nearest(&Joint::with_error_terms(bend))
    }

    /// The constants rounded to doubles.
    pub(crate) fn nearest(joint: &Joint<DoubleDouble>) -> Self {
        Self {
            cos: joint.cos.value(),
            cos2: joint.cos2.value(),
            sin: joint.sin.value(),
            sin2: joint.sin2.value(),
            versine: joint.versine.value(),
            inverse_exsecant: joint.inverse_exsecant.value(),
            k: joint.k.value(),
        }
    }

    /// The bend `β` in rad.
    pub fn bend(&self) -> f64 {
        elementary::atan2(self.sin, self.cos)
    }

    /// Non-uniformity `U = 1/cos β − cos β = tan β sin β` (catalogue, single joint, Bild 13).
    #[inline(always)]
    pub fn non_uniformity(&self) -> f64 {
        self.sin2 / self.cos
    }

    /// The largest tangent of the angle error, `(1 − cos β)/(2 √cos β)` (catalogue, Bild 12).
    #[inline(always)]
    pub fn max_error_tangent(&self) -> f64 {
        self.versine / (2.0 * self.cos.sqrt())
    }

    /// The largest angle error `asin k` in rad, reached at `tan² α = cos β` (catalogue, Bild 12).
    pub fn max_angle_error(&self) -> f64 {
        elementary::atan(self.max_error_tangent())
    }

    /// The largest speed ratio, `1/cos β`.
    #[inline(always)]
    pub fn max_speed_ratio(&self) -> f64 {
        1.0 / self.cos
    }

    /// Cosine and sine of the input angle with the largest acceleration ratio, from
    /// `cos 2α = (−p + √(p² + 8))/2` with `p = (2 − sin² β)/sin² β`.
    ///
    /// That cosine vanishes for small bends, its distance from 1 for bends near 90°. Both are
    /// computed without subtracting nearly equal numbers.
    #[inline(always)]
    pub fn steepest(&self) -> (f64, f64) {
        let sin2 = self.sin2;
        let cos2 = self.cos * self.cos;
        let p_sin2 = 1.0 + cos2;
        let cos_2a = 4.0 * sin2 / (p_sin2 + (p_sin2 * p_sin2 + 8.0 * sin2 * sin2).sqrt());
        let one_minus = 2.0 * cos2 / (sin2 * (cos_2a + 1.0) + p_sin2);
        ((0.5 * (1.0 + cos_2a)).sqrt(), -(0.5 * one_minus).sqrt())
    }

    /// The largest acceleration ratio, at the angle of [`Joint::steepest`].
    #[inline(always)]
    pub fn max_acceleration_ratio(&self) -> f64 {
        let (c, s) = self.steepest();
        let (_, acceleration) = rates(&JointConstants::of_doubles(self), s, c);
        acceleration
    }
}

/// Numerator and positive denominator of the tangent of the angle error, `(1 − cos β) s c` over
/// `c² cos β + s²`. A common factor of sine and cosine cancels.
#[inline(always)]
pub(crate) fn error_tangent<T: Real>(joint: &JointConstants<T>, s: T, c: T) -> (T, T) {
    (joint.versine.times(s * c), c.square().mul_add(joint.cos, s.square()))
}

/// The same fraction divided by `1 − cos β`: `s c` over `a (s² + c²) + s²` with the inverse
/// exsecant `a`. At large bends it has two roundings fewer where the shaft turns many times as fast
/// as the drive.
#[inline(always)]
pub(crate) fn steep_error_tangent<T: Real>(joint: &JointConstants<T>, s: T, c: T) -> (T, T) {
    let s2 = s.square();
    (s * c, joint.inverse_exsecant.mul_add(c.mul_add(c, s2), s2))
}

/// Tangent of the angle error, speed ratio and acceleration ratio at moderate bends, with shared
/// squares and product. The reciprocal of the product of both denominators replaces two divisions, and
/// each quotient is corrected for its error.
#[inline(always)]
pub(crate) fn motion<T: Real>(joint: &JointConstants<T>, s: T, c: T) -> (T, (T, T)) {
    let (s2, c2, product) = (s.square(), c.square(), s * c);
    let along = c2.mul_add(joint.cos, s2);
    let across = c2.mul_add(joint.cos2, s2);
    let both = (along * across).recip();
    let (inverse, inverse_along) = (along * both, across * both);
    let tangent = joint.versine.times(product).over(along, inverse_along);
    let ratio = (joint.cos * (c2 + s2)).over(across, inverse);
    let swing = product.over(across, inverse);
    (tangent, (ratio, (T::from_f64(-2.0) * joint.sin2 * swing).times(ratio)))
}

/// Speed ratio `cos β (s² + c²)/(c² cos² β + s²)` and acceleration ratio
/// `−2 cos β sin² β s c (s² + c²)/(c² cos² β + s²)²`.
///
/// The sum of the squares remains, because sine and cosine have a common factor. The denominator is
/// accurate up to the largest bend below 90°, where `1 − sin² β cos² α` is not. A straight joint
/// gives exactly 1, as the quotient of a number by itself.
#[inline(always)]
pub(crate) fn rates<T: Real>(joint: &JointConstants<T>, s: T, c: T) -> (T, T) {
    let s2 = s.square();
    let c_cos = c * joint.cos;
    let denominator = c_cos.mul_add(c_cos, s2);
    let inverse = denominator.recip();
    let ratio = (joint.cos * c.mul_add(c, s2)).quotient_by(denominator, inverse);
    (ratio, (T::from_f64(-2.0) * joint.sin2 * (s * c * inverse)).times(ratio))
}

/// The speed ratio of [`rates`] alone.
#[inline(always)]
pub(crate) fn speed_ratio<T: Real>(joint: &JointConstants<T>, s: T, c: T) -> T {
    let c_cos = c * joint.cos;
    let s2 = s.square();
    (joint.cos * c.mul_add(c, s2)).quotient(c_cos.mul_add(c_cos, s2))
}

/// Jerk ratio, the derivative of the acceleration ratio with respect to the drive angle (derived
/// here from the speed ratio):
///
/// `2 cos β sin² β (s⁴ + 3 sin² β s² c² − cos² β c⁴) (s² + c²)/(c² cos² β + s²)³`.
///
/// It vanishes where both parts of the bracket are equal. The cube triples the rounding errors of
/// the denominator and of its reciprocal, and the difference retains those of the squares. Fused
/// multiply-adds compute these errors, and the result is corrected for them. The remaining error is
/// four times the rounding of the tangent `s/c`.
#[inline(always)]
pub(crate) fn jerk_ratio<T: Real>(joint: &JointConstants<T>, s: T, c: T) -> T {
    let (s2, c2) = (s.square(), c.square());
    let across = joint.cos2.mul_add(c2, s2);
    let inverse = across.recip();
    let driven = joint.cos2 * c2;
    let sum = s2 * (T::from_f64(3.0) * joint.sin2).mul_add(c2, s2);
    let mut bracket = (-driven).mul_add(c2, sum);
    let mut length = c.mul_add(c, s2) * inverse;
    if !T::LOW {
        let (s2_low, c2_low) = (s.mul_add(s, -s2), c.mul_add(c, -c2));
        bracket = bracket + s2.mul_add(s2_low, -(driven * c2_low)).scaled(2.0);
        let missing = joint.cos2.mul_add(c2, s2 - across) + joint.cos2.mul_add(c2_low, s2_low);
        let off = (-across).mul_add(inverse, T::from_f64(1.0)) - missing * inverse;
        // Before the product, which single precision may not hold.
        length = length.mul_add(T::from_f64(3.0) * off, length);
    }
    ((joint.cos * joint.sin2).scaled(2.0) * (bracket * inverse * inverse)).times(length)
}
