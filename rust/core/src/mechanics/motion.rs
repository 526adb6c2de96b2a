//! The motion of a shaft at one drive angle.

use nalgebra::Complex;

use crate::mechanics::joint::{self, Joint, JointConstants};
use crate::number::elementary::atan2;

/// The motion of a shaft at one drive angle. Derivatives are with respect to the drive angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// Angle of the shaft minus the drive angle in rad, mean zero over a turn.
    pub angle_error: f64,
    /// First derivative of the shaft's angle.
    pub speed_ratio: f64,
    /// Second derivative.
    pub acceleration_ratio: f64,
    /// Third derivative.
    pub jerk_ratio: f64,
}

/// The derivatives of the motion with respect to `q`: a change `dq` changes each quantity by the
/// real part of `derivative · dq`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotionGradient {
    /// Derivative of the angle error.
    pub angle_error: Complex<f64>,
    /// Derivative of the speed ratio.
    pub speed_ratio: Complex<f64>,
    /// Derivative of the acceleration ratio.
    pub acceleration_ratio: Complex<f64>,
    /// Derivative of the jerk ratio.
    pub jerk_ratio: Complex<f64>,
}

impl Motion {
    /// The motion of a shaft behind one with the motion `before`, by the chain rule.
    pub(super) fn compose(&self, before: &Self) -> Self {
        let (r, a, j) = (before.speed_ratio, before.acceleration_ratio, before.jerk_ratio);
        let Self { angle_error, speed_ratio, acceleration_ratio, jerk_ratio } = *self;
        Self {
            angle_error: before.angle_error + angle_error,
            speed_ratio: speed_ratio * r,
            acceleration_ratio: acceleration_ratio * r * r + speed_ratio * a,
            jerk_ratio: jerk_ratio * r.powi(3) + 3.0 * acceleration_ratio * r * a + speed_ratio * j,
        }
    }
}

/// The motion behind one joint, from sine and cosine of its input angle.
pub(super) fn joint_motion(joint: &Joint, s: f64, c: f64) -> Motion {
    let constants = JointConstants::of_doubles(joint);
    let (y, x) = joint::error_tangent(&constants, s, c);
    let (speed_ratio, acceleration_ratio) = joint::rates(&constants, s, c);
    let jerk_ratio = joint::jerk_ratio(&constants, s, c);
    Motion { angle_error: atan2(y, x), speed_ratio, acceleration_ratio, jerk_ratio }
}
