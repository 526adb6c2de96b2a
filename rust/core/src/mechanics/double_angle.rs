//! The motion behind moderate bends, from twice the drive angle.
//!
//! A shaft behind any chain of joints has the angle `α + arg(1 − q e^{−2iα})` with `q = −B/A` of
//! the chain's map ([`crate::mechanics::chain`]) and `|q| = k`. For one joint on the drive shaft
//! `q = tan²(β/2)`. With `p = q e^{−2iα}`:
//!
//! `tan Δ = −Im p/(1 − Re p)`, speed ratio `r = (1 − k²)/(1 + k² − 2 Re p)`, acceleration ratio
//! `4 Im p r/(1 + k² − 2 Re p)`, or `4 Im p r²/(1 − k²)`.
//!
//! Except for `Im p`, each term is 1 plus a small number, and the roundings of that number are
//! small. For steep bends `1 + k² − 2 Re p` nearly vanishes; they use the formulas of
//! [`crate::mechanics::joint`].

use crate::mechanics::joint::Joint;
use crate::number::atan::AtanRange;
use crate::number::double_double::DoubleDouble;
use crate::number::float::Real;
use crate::number::trig::Angle;

/// The constants of a shaft's motion in twice the drive angle. `PARTS` is the number of parts of
/// `q` left to multiply by: both in general, the real part for the shaft behind the first joint,
/// and none where the sine and cosine already contain `q`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct DoubleAngle<T, const PARTS: usize = 2> {
    /// Real and imaginary part of `q`.
    pub(crate) q: [T; 2],
    /// `(1 + k²)/2`.
    pub(crate) mean: T,
    /// `(1 − k²)/2`.
    pub(crate) complement: T,
    /// `−4/(1 − k²)`.
    pub(crate) gain: T,
}

impl DoubleAngle<DoubleDouble> {
    /// The constants for `q`, given `|q|²` and `1 − |q|²`.
    #[inline(always)]
    pub(crate) fn new(
        q: [DoubleDouble; 2],
        square: DoubleDouble,
        complement: DoubleDouble,
    ) -> Self {
        Self {
            q,
            mean: DoubleDouble::exact(0.5).fast_add(square.scaled(0.5)),
            complement: complement.scaled(0.5),
            gain: DoubleDouble::exact(-4.0) / complement,
        }
    }

    /// The constants of an equivalent joint, for its input angle.
    #[inline(always)]
    pub(crate) fn of_equivalent(joint: &Joint<DoubleDouble>) -> Self {
        Self::new([joint.k, DoubleDouble::exact(0.0)], joint.k.square(), joint.complement())
    }

    /// The constants for a joint on the drive shaft.
    #[inline(always)]
    pub(crate) fn of_joint(bend: f64) -> Self {
        let (numerator, denominator) = DoubleDouble::tangent(DoubleDouble::exact(0.5 * bend));
        let k = (numerator / denominator).square();
        let square = k.square();
        Self::new([k, DoubleDouble::exact(0.0)], square, DoubleDouble::ONE.fast_add(-square))
    }
}

impl<T: Real> DoubleAngle<T> {
    /// The constants rounded to a kernel's number type.
    #[inline(always)]
    pub(crate) fn nearest(double_angle: &DoubleAngle<DoubleDouble>) -> Self {
        Self {
            q: double_angle.q.map(T::from_double_double),
            mean: T::from_double_double(double_angle.mean),
            complement: T::from_double_double(double_angle.complement),
            gain: T::from_double_double(double_angle.gain),
        }
    }

    /// The range of the inverse tangent for the angle error, at most `asin k`.
    #[inline(always)]
    pub(crate) fn range(&self) -> AtanRange {
        let [re, im] = self.q.map(|x| x.value().into());
        let complement: f64 = self.complement.value().into();
        AtanRange::holding_squares(re * re + im * im, 2.0 * complement)
    }

    /// The same constants with `PARTS` parts of `q` left to multiply by.
    #[inline(always)]
    pub(crate) fn with_parts<const PARTS: usize>(self) -> DoubleAngle<T, PARTS> {
        let Self { q, mean, complement, gain } = self;
        DoubleAngle { q, mean, complement, gain }
    }
}

/// The terms of the motion at one sample.
#[derive(Clone, Copy)]
pub(crate) struct DoubleAngleTerms<T> {
    /// `−Im p`.
    pub(crate) neg_im: T,
    /// `1 − Re p`.
    pub(crate) one_minus_re: T,
    /// `Re p`.
    re: T,
    /// `(1 + k²)/2 − Re p`.
    mean_minus_re: T,
    /// `(1 − k²)/2`.
    complement: T,
    /// `−4/(1 − k²)`.
    gain: T,
}

impl<T: Angle, const PARTS: usize> DoubleAngle<T, PARTS> {
    /// The terms from sine and cosine of `2α`, or from `−Im p` and `Re p` if `PARTS` is 0.
    #[inline(always)]
    pub(crate) fn terms(&self, s: T, c: T) -> DoubleAngleTerms<T> {
        let [re, im] = self.q;
        let (neg_im, p) = match PARTS {
            0 => (s, c),
            1 => (re.times(s), re * c),
            _ => (re.mul_add(s, -(im * c)), re.mul_add(c, im * s)),
        };
        DoubleAngleTerms {
            neg_im,
            re: p,
            one_minus_re: T::from_f64(1.0).fast_add(-p),
            mean_minus_re: self.mean.fast_add(-p),
            complement: self.complement,
            gain: self.gain,
        }
    }
}

impl<T: Angle> DoubleAngleTerms<T> {
    /// Speed ratio and acceleration ratio.
    #[inline(always)]
    pub(crate) fn rates(&self) -> (T, T) {
        if T::PRECISION.costs().double_angle {
            // With one reciprocal, two quotients cost less than one quotient and products.
            let [ratio, swing] = T::both_over(self.complement, self.neg_im, self.mean_minus_re);
            return (ratio, swing.scaled(-2.0).times(ratio));
        }
        let ratio = self.complement / self.mean_minus_re;
        (ratio, (self.neg_im * ratio).times(self.gain * ratio))
    }

    /// Jerk ratio, `4 r (2 (Im p)² − Re p · across)/across²` with `across = (1 + k²)/2 − Re p`.
    #[inline(always)]
    pub(crate) fn jerk_ratio(&self) -> T {
        let across = self.mean_minus_re;
        let [ratio, swing] = T::both_over(self.complement, self.neg_im, across);
        let real = self.re / across;
        ratio.times((swing.square().scaled(2.0) - real).scaled(4.0))
    }
}
