//! The formulas of a shaft's motion, by the angle that they start from.

use crate::mechanics::double_angle::DoubleAngle;
use crate::mechanics::joint;
use crate::number::float::Real;
use crate::number::trig::Angle;

/// The formulas of a shaft's motion, from sine and cosine of an angle.
pub(crate) trait MotionFormula<T: Real>: Copy {
    /// Whether the formulas serve moderate bends, and whether they serve steep ones.
    const MODERATE: bool;
    const STEEP: bool;

    /// Numerator and positive denominator of the tangent of the angle error.
    fn error_tangent(&self, s: T, c: T) -> (T, T);

    /// Speed ratio and acceleration ratio.
    fn rates(&self, s: T, c: T) -> (T, T);

    /// The same, by a quotient with fewer roundings at the steepest bends.
    fn steep_error_tangent(&self, s: T, c: T) -> (T, T);

    /// Speed ratio.
    #[inline(always)]
    fn speed_ratio(&self, s: T, c: T) -> T {
        self.rates(s, c).0
    }

    /// Acceleration ratio.
    #[inline(always)]
    fn acceleration_ratio(&self, s: T, c: T) -> T {
        self.rates(s, c).1
    }

    /// Jerk ratio.
    fn jerk_ratio(&self, s: T, c: T) -> T;

    /// Tangent of the angle error, and rates.
    fn motion(&self, s: T, c: T) -> (T, (T, T));
}

/// From sine and cosine of the joint's input angle, up to a common factor.
impl<T: Angle> MotionFormula<T> for joint::JointConstants<T> {
    const MODERATE: bool = !T::PRECISION.costs().double_angle;
    const STEEP: bool = true;

    #[inline(always)]
    fn error_tangent(&self, s: T, c: T) -> (T, T) {
        joint::error_tangent(self, s, c)
    }

    #[inline(always)]
    fn steep_error_tangent(&self, s: T, c: T) -> (T, T) {
        joint::steep_error_tangent(self, s, c)
    }

    #[inline(always)]
    fn rates(&self, s: T, c: T) -> (T, T) {
        joint::rates(self, s, c)
    }

    #[inline(always)]
    fn speed_ratio(&self, s: T, c: T) -> T {
        joint::speed_ratio(self, s, c)
    }

    #[inline(always)]
    fn jerk_ratio(&self, s: T, c: T) -> T {
        joint::jerk_ratio(self, s, c)
    }

    #[inline(always)]
    fn motion(&self, s: T, c: T) -> (T, (T, T)) {
        joint::motion(self, s, c)
    }
}

/// From sine and cosine of twice the drive angle.
impl<T: Angle, const PARTS: usize> MotionFormula<T> for DoubleAngle<T, PARTS> {
    const MODERATE: bool = true;
    const STEEP: bool = false;

    #[inline(always)]
    fn error_tangent(&self, s: T, c: T) -> (T, T) {
        let terms = self.terms(s, c);
        (terms.neg_im, terms.one_minus_re)
    }

    #[inline(always)]
    fn steep_error_tangent(&self, s: T, c: T) -> (T, T) {
        self.error_tangent(s, c)
    }

    #[inline(always)]
    fn rates(&self, s: T, c: T) -> (T, T) {
        self.terms(s, c).rates()
    }

    #[inline(always)]
    fn jerk_ratio(&self, s: T, c: T) -> T {
        self.terms(s, c).jerk_ratio()
    }

    #[inline(always)]
    fn motion(&self, s: T, c: T) -> (T, (T, T)) {
        let terms = self.terms(s, c);
        (terms.neg_im / terms.one_minus_re, terms.rates())
    }
}
