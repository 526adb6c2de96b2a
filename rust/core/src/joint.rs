//! One universal joint: the constants of its bend and its extremes in closed form.
//!
//! The formulas per angle take the sine and cosine of the joint's driving angle and stand here as
//! plain scalar functions; the kernel runs them over slices.

use crate::trig;

/// The constants of one joint with a given bend.
///
/// Each is computed from its own well-conditioned formula, so that all keep full relative accuracy
/// from the smallest bend to the last one below 90°.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Joint {
    /// `cos β`, the smallest speed ratio.
    pub cos: f64,
    /// `sin β`.
    pub sin: f64,
    /// `sin² β`.
    pub sin2: f64,
    /// `1 − cos β`.
    pub versine: f64,
    /// `cos β/(1 − cos β)`, the inverse of the exsecant; infinite for a straight joint.
    pub inverse_exsecant: f64,
    /// `k = tan²(β/2)`.
    pub k: f64,
}

impl Joint {
    /// The straight joint, which passes its rotation on unchanged.
    pub const STRAIGHT: Self = Self {
        cos: 1.0,
        sin: 0.0,
        sin2: 0.0,
        versine: 0.0,
        inverse_exsecant: f64::INFINITY,
        k: 0.0,
    };

    /// The joint with a bend in `[0, π/2)`, in radians. Sine, cosine and the squares are within
    /// 0.8 ulp: their errors go into every sample.
    pub fn new(bend: f64) -> Self {
        let (sine, [cos, cos_low]) = trig::sin_cos_in_two(bend);
        let (half_sine, _) = trig::sin_cos_in_two(0.5 * bend);
        let [sin2, _] = square(sine);
        let [versine, versine_low] = square(half_sine).map(|half| 2.0 * half);
        let quotient = cos / versine;
        let remainder = (-quotient).mul_add(versine, cos) + cos_low - quotient * versine_low;
        let inverse_exsecant = if versine > f64::MIN_POSITIVE {
            quotient + remainder / versine
        } else {
            f64::INFINITY
        };
        Self { cos, sin: sine[0], sin2, versine, inverse_exsecant, k: versine / (1.0 + cos) }
    }

    /// The joint with the given `k = tan²(β/2)` and `1 − k²`, the latter known without
    /// cancellation.
    pub fn from_k(k: f64, complement: f64) -> Self {
        let one_plus = 1.0 + k;
        let cos = complement / (one_plus * one_plus);
        let versine = 2.0 * k / one_plus;
        Self {
            cos,
            sin: 2.0 * k.sqrt() / one_plus,
            sin2: 4.0 * k / (one_plus * one_plus),
            versine,
            inverse_exsecant: cos / versine,
            k,
        }
    }

    /// `1 − k²`.
    pub fn complement(&self) -> f64 {
        let one_plus = 1.0 + self.k;
        self.cos * one_plus * one_plus
    }

    /// The bend `β` in radians.
    pub fn bend(&self) -> f64 {
        self.sin.atan2(self.cos)
    }

    /// Non-uniformity `U = 1/cos β − cos β = tan β sin β` (catalogue, single joint, Bild 13).
    pub fn non_uniformity(&self) -> f64 {
        self.sin2 / self.cos
    }

    /// The largest tangent of the angle error, `(1 − cos β)/(2 √cos β)` (catalogue, Bild 12).
    pub fn max_error_tangent(&self) -> f64 {
        self.versine / (2.0 * self.cos.sqrt())
    }

    /// The largest angle error `asin k`, in radians, at `tan² α = cos β`.
    pub fn max_angle_error(&self) -> f64 {
        self.max_error_tangent().atan()
    }

    /// The largest speed ratio, `1/cos β`.
    pub fn max_speed_ratio(&self) -> f64 {
        1.0 / self.cos
    }

    /// The largest acceleration ratio, at `cos 2α = (−p + √(p² + 8))/2` with
    /// `p = (2 − sin² β)/sin² β`.
    ///
    /// That cosine and its distance from 1 are both written without a difference of near-equals:
    /// the first vanishes for small bends, the second for bends near 90°.
    pub fn max_acceleration_ratio(&self) -> f64 {
        let sin2 = self.sin2;
        let cos2 = self.cos * self.cos;
        let p_sin2 = 1.0 + cos2;
        let cos_2a = 4.0 * sin2 / (p_sin2 + (p_sin2 * p_sin2 + 8.0 * sin2 * sin2).sqrt());
        let one_minus = 2.0 * cos2 / (sin2 * (cos_2a + 1.0) + p_sin2);
        let c2 = 0.5 * (1.0 + cos_2a);
        let s2 = 0.5 * one_minus;
        let (_, acceleration) = rates(self, -s2.sqrt(), c2.sqrt());
        acceleration
    }
}

/// The square of a double with an error term, as such.
fn square([high, low]: [f64; 2]) -> [f64; 2] {
    let product = high * high;
    trig::in_two(product, (2.0 * high).mul_add(low, high.mul_add(high, -product)))
}

/// Numerator and (positive) denominator of the tangent of the angle error,
/// `(1 − cos β) s c` over `c² cos β + s²`; a common length of sine and cosine drops out.
#[inline(always)]
pub(crate) fn error_tangent(joint: &Joint, s: f64, c: f64) -> (f64, f64) {
    (joint.versine * (s * c), (c * c).mul_add(joint.cos, s * s))
}

/// The same fraction divided through by `1 − cos β`: `s c` over `a (s² + c²) + s²` with the inverse
/// exsecant `a`. For bends that are far from straight it has two roundings fewer where they matter
/// most, where the shaft turns many times as far as the drive.
#[inline(always)]
pub(crate) fn steep_error_tangent(joint: &Joint, s: f64, c: f64) -> (f64, f64) {
    let s2 = s * s;
    (s * c, joint.inverse_exsecant.mul_add(c.mul_add(c, s2), s2))
}

/// Speed ratio `cos β (s² + c²)/(c² cos² β + s²)` and acceleration ratio
/// `−2 cos β sin² β s c (s² + c²)/(c² cos² β + s²)²`.
///
/// The sum of the squares stays in: sine and cosine come times a common length. The denominator
/// is right to the last bend below 90°, where `1 − sin² β cos² α` is not.
#[inline(always)]
pub(crate) fn rates(joint: &Joint, s: f64, c: f64) -> (f64, f64) {
    let s2 = s * s;
    let c_cos = c * joint.cos;
    let inverse = 1.0 / c_cos.mul_add(c_cos, s2);
    let turning = joint.cos * c.mul_add(c, s2) * inverse;
    // Exactly 1 where the joint is straight, and still NaN for an angle that is none.
    let ratio = if joint.cos == 1.0 { s.mul_add(0.0, 1.0) } else { turning };
    (ratio, -2.0 * joint.sin2 * (s * c * inverse) * ratio)
}
