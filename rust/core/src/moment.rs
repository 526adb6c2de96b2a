//! The moment vector that a joint passes on, and the torques of a loaded driveline.
//!
//! A frictionless, massless cross passes on only a moment normal to both pins (D. Thoma 1920).
//! With the torsion `D` of the driving shaft and the joint's own driving angle `α`:
//!
//! `M = D [u_in + tan β sin α (sin α e_in − cos α m)]`, `e_in = m × u_in`.
//!
//! Its part across the driving shaft is the bracket without `u_in`; its part across the driven
//! shaft, with `e_out = m × u_out`, is `−D [sin β cos² α e_out + tan β sin α cos α m]`. Neither is a
//! difference of large numbers.
//!
//! The power `P = D · (speed ratio)` is the same on both sides of a joint, so torques along a
//! chain are running sums of what the inertias take.

use crate::chain::Transfer;
use crate::geometry::Vector;
use crate::joint::Joint;
use crate::trig;

/// One joint of a driveline in space, and how the drive turns it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pose {
    /// `(cos α, sin α)` of the drive to the same of this joint's driving angle, times a positive
    /// length.
    matrix: [f64; 4],
    joint: Joint,
    /// `u_in`.
    along: Vector,
    /// `tan β e_in`.
    in_plane: Vector,
    /// `−tan β m`.
    across: Vector,
    /// `sin β e_out`.
    out_plane: Vector,
}

/// The joint's own driving angle `α` at one sample.
#[derive(Clone, Copy)]
pub(crate) struct PinAngle {
    /// `sin² α`.
    sine2: f64,
    /// `cos² α`.
    cosine2: f64,
    /// `sin α cos α`.
    product: f64,
}

impl Pose {
    /// The pose of a joint that `transfer` drives, between the shafts along `u_in` and `u_out`.
    pub(crate) fn new(
        transfer: &Transfer,
        joint: Joint,
        u_in: Vector,
        u_out: Vector,
        normal: Vector,
    ) -> Self {
        let tangent = joint.sin / joint.cos;
        Self {
            matrix: transfer.matrix(),
            joint,
            along: u_in,
            in_plane: normal.cross(&u_in) * tangent,
            across: normal * -tangent,
            out_plane: normal.cross(&u_out) * joint.sin,
        }
    }

    /// Sine and cosine of the joint's own driving angle, times a common length, from those of the
    /// drive angle.
    #[inline(always)]
    fn turn(&self, s: f64, c: f64) -> (f64, f64) {
        let [cc, cs, sc, ss] = self.matrix;
        (sc.mul_add(c, ss * s), cc.mul_add(c, cs * s))
    }

    /// The joint's own driving angle from a pin of the drive.
    #[inline(always)]
    pub(crate) fn angle(&self, s: f64, c: f64) -> PinAngle {
        let (sine, cosine) = self.turn(s, c);
        let scale = 1.0 / sine.mul_add(sine, cosine * cosine);
        PinAngle {
            sine2: sine * sine * scale,
            cosine2: cosine * cosine * scale,
            product: sine * cosine * scale,
        }
    }

    /// Component `i` of the moment on the driven shaft, per unit torsion.
    #[inline(always)]
    pub(crate) fn moment(&self, i: usize, pin: PinAngle) -> f64 {
        self.along[i] + self.bending_driving_vector(i, pin)
    }

    /// Component `i` of the same moment's part across the driving shaft: what its bearings must
    /// give against the reaction.
    #[inline(always)]
    pub(crate) fn bending_driving_vector(&self, i: usize, pin: PinAngle) -> f64 {
        self.in_plane[i].mul_add(pin.sine2, self.across[i] * pin.product)
    }

    /// Component `i` of what the bearings of the driven shaft must give against its part across
    /// that shaft, per unit torsion.
    #[inline(always)]
    pub(crate) fn support_driven(&self, i: usize, pin: PinAngle) -> f64 {
        self.out_plane[i].mul_add(pin.cosine2, -(self.across[i] * pin.product))
    }

    /// Size of the bending moment in the driving shaft per unit torsion, `tan β |sin α|`
    /// (Grossmann (6)).
    #[inline(always)]
    pub(crate) fn bending_driving(&self, pin: PinAngle) -> f64 {
        self.joint.sin / self.joint.cos * pin.sine2.sqrt()
    }

    /// The same in the driven shaft, `sin β |cos α| √(1 + tan² β sin² α)` (Grossmann (8)).
    #[inline(always)]
    pub(crate) fn bending_driven(&self, pin: PinAngle) -> f64 {
        let tangent = self.joint.sin / self.joint.cos;
        let stretch = (tangent * tangent).mul_add(pin.sine2, 1.0);
        self.joint.sin * (pin.cosine2 * stretch).sqrt()
    }

    /// Tilt `ψ₁` of the cross against the driving shaft, `tan ψ₁ = tan β sin α` (Grossmann (3)).
    #[inline(always)]
    pub(crate) fn tilt_driving(&self, s: f64, c: f64) -> f64 {
        let (sine, cosine) = self.turn(s, c);
        let length = sine.mul_add(sine, cosine * cosine).sqrt();
        trig::atan_any(self.joint.sin * sine, self.joint.cos * length)
    }

    /// Tilt `ψ₂` against the driven shaft, `sin ψ₂ = sin β cos α` (Grossmann (5)); its cosine is
    /// `√(sin² α + cos² β cos² α)`.
    #[inline(always)]
    pub(crate) fn tilt_driven(&self, s: f64, c: f64) -> f64 {
        let (sine, cosine) = self.turn(s, c);
        let across = self.joint.cos * cosine;
        let along = across.mul_add(across, sine * sine).sqrt();
        trig::atan_any(self.joint.sin * cosine, along)
    }
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
