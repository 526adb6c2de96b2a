//! The moment vector that a joint passes on, and the torques of a loaded driveline.
//!
//! A frictionless, massless cross passes on only a moment normal to both pins (D. Thoma 1920).
//! With the torsion `D` of the driving shaft and the joint's own driving angle `α`:
//!
//! `M = D [u_in + tan β sin α (sin α e_in − cos α m)]`, `e_in = m × u_in`.
//!
//! The power `P = D · (speed ratio)` is the same on both sides of a joint, so torques along a
//! chain are running sums of what the inertias take.

use crate::chain::Transfer;
use crate::geometry::Vector;
use crate::joint::Joint;

/// What a joint's moment needs besides torsion and drive angle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pose {
    /// `(cos α, sin α)` of the drive to the same of this joint's driving angle, times a positive
    /// length.
    pub(crate) matrix: [f64; 4],
    /// `u_in`.
    pub(crate) along: Vector,
    /// `tan β e_in`.
    pub(crate) in_plane: Vector,
    /// `−tan β m`.
    pub(crate) across: Vector,
}

impl Pose {
    /// The pose of a joint that `transfer` drives.
    pub(crate) fn new(transfer: &Transfer, joint: &Joint, along: Vector, normal: Vector) -> Self {
        let tangent = joint.sin / joint.cos;
        Self {
            matrix: transfer.matrix(),
            along,
            in_plane: normal.cross(&along) * tangent,
            across: normal * -tangent,
        }
    }

    /// `sin² α_j` and `sin α_j cos α_j` of the joint's own driving angle `α_j` from sine and
    /// cosine of the drive angle.
    #[inline(always)]
    pub(crate) fn squares(&self, s: f64, c: f64) -> (f64, f64) {
        let [cc, cs, sc, ss] = self.matrix;
        let cosine = cc.mul_add(c, cs * s);
        let sine = sc.mul_add(c, ss * s);
        let scale = 1.0 / sine.mul_add(sine, cosine * cosine);
        (sine * sine * scale, sine * cosine * scale)
    }
}

/// Component `i` of the moment per unit torsion.
#[inline(always)]
pub(crate) fn component(pose: &Pose, i: usize, sine2: f64, sine_cosine: f64) -> f64 {
    pose.in_plane[i].mul_add(sine2, pose.across[i].mul_add(sine_cosine, pose.along[i]))
}

/// What the inertia of a shaft takes from the power that enters it,
/// `I (ω₀² r′ + ω̇₀ r) r` with the shaft's speed ratio `r` and acceleration ratio `r′`.
#[inline(always)]
pub(crate) fn absorbed_power(
    inertia: f64,
    speed: f64,
    acceleration: f64,
    ratio: f64,
    acceleration_ratio: f64,
) -> f64 {
    let turning = (speed * speed).mul_add(acceleration_ratio, acceleration * ratio);
    inertia * turning * ratio
}
