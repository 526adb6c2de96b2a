//! The moment vector that a joint transmits, and the torques of a loaded driveline.
//!
//! A frictionless, massless cross transmits only a moment normal to both pins (D. Thoma 1920). With
//! the torsion `D` of the driving shaft and the joint's input angle `α`:
//!
//! `M = D [u_in + tan β sin α (sin α e_in − cos α m)]`, `e_in = m × u_in`.
//!
//! Its component perpendicular to the driving shaft is the bracket without `u_in`. Its component
//! perpendicular to the driven shaft is `−D [sin β cos² α e_out + tan β sin α cos α m]` with
//! `e_out = cos β e_in − sin β u_in`. Neither is a difference of large numbers.
//!
//! The power `P = D · (speed ratio)` is the same on both sides of a joint, so torques along a chain
//! are running sums of the power that the inertias absorb.

use crate::mechanics::chain::Transfer;
use crate::mechanics::frame::Frame;
use crate::mechanics::joint::Joint;
use crate::mechanics::turning::TurnMatrix;
use crate::number::double_double::DoubleDouble;
use crate::number::float::Real;
use crate::number::trig::Angle;

/// One joint of a driveline in space, and the map from the drive angle to its input angle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pose<T> {
    /// The map from the drive to this joint's input angle.
    pub(crate) matrix: TurnMatrix<T>,
    /// `sin β`.
    sine: T,
    /// `cos β`.
    pub(super) cosine: T,
    /// `tan β`.
    tangent: T,
    /// `u_in`.
    pub(crate) shaft_axis: [T; 3],
    /// `tan β e_in`.
    pub(crate) in_plane: [T; 3],
    /// `−tan β m`.
    pub(crate) plane_normal: [T; 3],
    /// `sin β e_out`.
    pub(crate) out_plane: [T; 3],
}

/// A torsion `D` multiplied by the squares and the product of sine and cosine of the joint's own
/// input angle. Every moment at the joint is a combination of these.
#[derive(Clone, Copy)]
pub(crate) struct TorsionParts<T> {
    /// `D sin² α`.
    pub(crate) sine2: T,
    /// `D cos² α`.
    pub(crate) cosine2: T,
    /// `D sin α cos α`.
    pub(crate) product: T,
}

impl<T: Real> TorsionParts<T> {
    /// The parts of a torsion, from sine and cosine of the input angle multiplied by a common length.
    #[inline(always)]
    pub(crate) fn new(torsion: T, sine: T, cosine: T) -> Self {
        let scale = torsion * (sine.square() + cosine.square()).recip();
        Self::scaled(scale, sine, cosine)
    }

    #[inline(always)]
    fn scaled(scale: T, sine: T, cosine: T) -> Self {
        let (sine2, cosine2) = (sine.square(), cosine.square());
        Self { sine2: sine2 * scale, cosine2: cosine2 * scale, product: sine * cosine * scale }
    }
}

/// `sin² α` and `sin α cos α` of a reduced angle `α`. A quarter turn exchanges the squares and changes
/// the sign of the product, which is positive if zero.
#[inline(always)]
pub(crate) fn parts_of_reduced<T: Angle>((remainder, quadrant): (T, u64)) -> [T; 2] {
    let (s, c) = T::tangent(remainder);
    let (sine2, cosine2, odd) = (s.square(), c.square(), quadrant & 1);
    let scale = (sine2 + cosine2).recip();
    let square = if odd == 1 { cosine2 } else { sine2 };
    [square * scale, s.turned_if(odd).times(c) * scale]
}

impl<T: Real> Pose<T> {
    /// If the joint's normal is parallel to an axis of space: the two axes of the plane of both
    /// shafts, then the axis of the normal.
    pub(crate) fn plane_axes(&self) -> Option<[usize; 3]> {
        let zero = |x: T| x == T::from_f64(0.0);
        [[1, 2, 0], [2, 0, 1], [0, 1, 2]].into_iter().find(|&[a, b, normal]| {
            zero(self.plane_normal[a])
                && zero(self.plane_normal[b])
                && [self.shaft_axis, self.in_plane, self.out_plane].iter().all(|v| zero(v[normal]))
        })
    }

    /// The same pose with the components of its vectors in the order of these axes.
    #[inline(always)]
    pub(crate) fn with_axes(self, [a, b, c]: [usize; 3]) -> Self {
        let order = |v: [T; 3]| [v[a], v[b], v[c]];
        Self {
            shaft_axis: order(self.shaft_axis),
            in_plane: order(self.in_plane),
            plane_normal: order(self.plane_normal),
            out_plane: order(self.out_plane),
            ..self
        }
    }

    /// The same pose for the pins of the joint itself.
    #[inline(always)]
    pub(crate) fn by_own_pins(self) -> Self {
        Self { matrix: TurnMatrix::identity(), ..self }
    }

    /// The moment vector on the driven shaft for a torsion. The normal of a `PLANAR` pose is along
    /// the last axis.
    #[inline(always)]
    pub(crate) fn moment<const PLANAR: bool>(&self, torsion: T, s: T, c: T) -> [T; 3] {
        let TorsionParts { sine2, product, .. } = self.unit_parts(s, c);
        self.of_parts::<PLANAR>(torsion, [sine2, product])
    }

    /// The same from `sin² α` and `sin α cos α`.
    #[inline(always)]
    pub(crate) fn of_parts<const PLANAR: bool>(&self, torsion: T, parts: [T; 2]) -> [T; 3] {
        [
            self.along::<PLANAR, 0>(torsion, parts),
            self.along::<PLANAR, 1>(torsion, parts),
            self.along::<PLANAR, 2>(torsion, parts),
        ]
    }

    /// Component `I` of that moment vector.
    #[inline(always)]
    pub(crate) fn along<const PLANAR: bool, const I: usize>(
        &self,
        torsion: T,
        [sine2, product]: [T; 2],
    ) -> T {
        // The factors of a torsion that all samples share are products that they share as well.
        let normal = self.plane_normal[I] * torsion;
        if PLANAR && I == 2 {
            return normal * product;
        }
        let in_plane = (self.in_plane[I] * torsion).mul_add(sine2, self.shaft_axis[I] * torsion);
        if PLANAR { in_plane } else { normal.mul_add(product, in_plane) }
    }

    /// Component `I` of the moment that the bearings exert on the driving or the driven shaft. It
    /// balances the perpendicular component of the joint's moment or of its reaction. The sum
    /// starts with `previous`, if given.
    #[inline(always)]
    pub(crate) fn support<const PLANAR: bool, const I: usize>(
        &self,
        driving: bool,
        [square, product]: [T; 2],
        previous: Option<T>,
    ) -> T {
        let (in_plane, across) = if driving {
            (self.in_plane[I], self.plane_normal[I])
        } else {
            (self.out_plane[I], -self.plane_normal[I])
        };
        let term = |factor: T, number: T, previous: Option<T>| match previous {
            Some(previous) => factor.mul_add(number, previous),
            None => factor * number,
        };
        match (PLANAR, I) {
            (true, 0 | 1) => term(in_plane, square, previous),
            (true, _) => term(across, product, previous),
            (false, _) => term(across, product, Some(term(in_plane, square, previous))),
        }
    }

    /// The pose of a joint that `transfer` drives, in the frame of its driving shaft. Vectors
    /// perpendicular to the driven shaft are computed from the bend, because that shaft's direction
    /// may be rounded.
    pub(crate) fn new(
        transfer: &Transfer,
        joint: &Joint<DoubleDouble>,
        Frame { shaft, in_plane, normal }: Frame,
    ) -> Self {
        let tangent = joint.sin / joint.cos;
        let sin_cos = joint.sin * joint.cos;
        let out_plane = |i: usize| in_plane[i] * sin_cos - joint.sin2 * shaft[i];
        let times = |vector: [DoubleDouble; 3], factor: DoubleDouble| {
            vector.map(|x| T::from_double_double(x * factor))
        };
        Self {
            matrix: TurnMatrix::new(transfer.matrix()),
            sine: T::from_double_double(joint.sin),
            cosine: T::from_double_double(joint.cos),
            tangent: T::from_double_double(tangent),
            shaft_axis: shaft.map(T::from_double_double),
            in_plane: times(in_plane, tangent),
            plane_normal: times(normal, -tangent),
            out_plane: [out_plane(0), out_plane(1), out_plane(2)].map(T::from_double_double),
        }
    }

    /// The pose of a joint from sine and cosine of its bend. It serves sine and cosine of the joint's
    /// input angle, and outputs that are not vectors.
    pub(crate) fn of_bend(sine: T, cosine: T) -> Self {
        let none = [T::from_f64(0.0); 3];
        Self {
            matrix: TurnMatrix::identity(),
            sine,
            cosine,
            tangent: sine / cosine,
            shaft_axis: none,
            in_plane: none,
            plane_normal: none,
            out_plane: none,
        }
    }

    /// The pose of a joint as built: unit vectors, whose factors [`JointAsBuilt::moments`] gives.
    ///
    /// [`JointAsBuilt::moments`]: crate::mechanics::as_built::JointAsBuilt::moments
    pub(crate) fn of_unit_vectors(
        joint: &Joint<DoubleDouble>,
        Frame { shaft, in_plane, normal }: Frame,
    ) -> Self {
        let out_plane = |i: usize| in_plane[i] * joint.cos - joint.sin * shaft[i];
        let near = |vector: [DoubleDouble; 3]| vector.map(T::from_double_double);
        let one = T::from_f64(1.0);
        Self {
            matrix: TurnMatrix::identity(),
            sine: one,
            cosine: one,
            tangent: one,
            shaft_axis: near(shaft),
            in_plane: near(in_plane),
            plane_normal: near(normal.map(|x| -x)),
            out_plane: near([out_plane(0), out_plane(1), out_plane(2)]),
        }
    }

    /// The moment vector on the driven shaft, from a torsion and the factors of the other axes.
    #[inline(always)]
    pub(crate) fn with_parts(&self, torsion: T, in_plane: T, normal: T) -> [T; 3] {
        let part = |i: usize| {
            let along = self.in_plane[i].mul_add(in_plane, self.shaft_axis[i] * torsion);
            self.plane_normal[i].mul_add(normal, along)
        };
        [part(0), part(1), part(2)]
    }

    /// Sine and cosine of the joint's input angle, multiplied by a common length, from sine
    /// and cosine of the drive angle.
    #[inline(always)]
    fn turn(&self, s: T, c: T) -> (T, T) {
        self.matrix.turn(s, c)
    }

    /// The parts of a torsion, from unnormalised sine and cosine of the drive angle.
    #[inline(always)]
    pub(crate) fn parts(&self, torsion: T, s: T, c: T) -> TorsionParts<T> {
        let (sine, cosine) = self.turn(s, c);
        TorsionParts::new(torsion, sine, cosine)
    }

    /// The parts of a torsion of 1.
    #[inline(always)]
    fn unit_parts(&self, s: T, c: T) -> TorsionParts<T> {
        let (sine, cosine) = self.turn(s, c);
        TorsionParts::scaled((sine.square() + cosine.square()).recip(), sine, cosine)
    }

    /// The parts of the torsion that this power gives, multiplied by the determinant of the map, from
    /// sine and cosine of the drive angle. If these have the squared length `l`, the power is to be
    /// divided by it.
    #[inline(always)]
    pub(crate) fn power_parts(&self, power: T, s: T, c: T) -> TorsionParts<T> {
        let (sine, cosine) = self.turn(s, c);
        TorsionParts::scaled(power, sine, cosine)
    }

    /// Magnitude of the bending moment in the driving shaft, `D tan β |sin α|` (Grossmann (6)).
    #[inline(always)]
    pub(crate) fn bending_driving(&self, torsion: T, s: T, c: T) -> T {
        let (sine, cosine) = self.turn(s, c);
        let length = (sine.square() + cosine.square()).sqrt();
        torsion.abs() * self.tangent * (sine.abs() / length)
    }

    /// Magnitude of the whole moment, `|D| sec ψ₁ = |D| √(1 + tan² β sin² α)`.
    #[inline(always)]
    pub(crate) fn pin_moment(&self, torsion: T, s: T, c: T) -> T {
        torsion.abs() * self.stretch(s, c).1.sqrt()
    }

    /// Magnitude of the bending moment in the driven shaft, `D sin β |cos α| √(1 + tan² β sin² α)`
    /// (Grossmann (8)).
    #[inline(always)]
    pub(crate) fn bending_driven(&self, torsion: T, s: T, c: T) -> T {
        let (part, stretch) = self.stretch(s, c);
        torsion.abs() * self.sine * (part.cosine2 * stretch).sqrt()
    }

    /// The moment vector on the driven shaft, in axes that turn with that shaft: `(T, 0, T tan ψ₂)`,
    /// because it is normal to the driven pin (Thoma 5, Grossmann 5). The torque that enters the
    /// shaft is `T = D (cos β + sin β tan β sin² α)`, and the last component is the bending moment
    /// with the sign of `cos α`.
    #[inline(always)]
    pub(crate) fn turning_moment(&self, torsion: T, s: T, c: T) -> [T; 3] {
        let ((_, cosine), (part, stretch)) = (self.turn(s, c), self.stretch(s, c));
        let torque = torsion * (self.sine * self.tangent).mul_add(part.sine2, self.cosine);
        let root = (part.cosine2 * stretch).sqrt().copysign(cosine);
        let (bending, zero) = (torsion * self.sine * root, T::from_f64(0.0));
        // Where the angle is NaN, so is what is zero elsewhere.
        [torque, zero.mul_add(bending, zero), bending]
    }

    /// Moments that the joint adds to those of the bearings on its shafts, in axes that turn with
    /// these: to the driving shaft along y and z, and to the driven shaft along z.
    ///
    /// The driven shaft needs `−T tan ψ₂`. The driving shaft needs `−D tan ψ₁` across the joint's own
    /// pin, with `tan ψ₁ = tan β sin α` (Grossmann 3). The shaft's phase, given by its cosine and
    /// sine, is the angle from its input-side pin to that pin.
    #[inline(always)]
    pub(crate) fn turning_supports(&self, phase: [T; 2], torsion: T, s: T, c: T) -> [T; 3] {
        let (sine, cosine) = self.turn(s, c);
        let length = (sine.square() + cosine.square()).sqrt();
        let driving = torsion * self.tangent * (sine / length);
        let [.., driven] = self.turning_moment(torsion, s, c);
        [phase[1] * driving, -(phase[0] * driving), -driven]
    }

    /// The parts of a torsion of 1, and `sec² ψ₁ = 1 + tan² β sin² α`.
    #[inline(always)]
    fn stretch(&self, s: T, c: T) -> (TorsionParts<T>, T) {
        let part = self.unit_parts(s, c);
        (part, self.tangent.square().mul_add(part.sine2, T::from_f64(1.0)))
    }
}

/// The power that the inertia of a shaft absorbs, divided by the drive's speed:
/// `I (ω₀² r′ + ω̇₀ r) r` with the shaft's speed ratio `r` and acceleration ratio `r′`.
#[inline(always)]
pub(crate) fn absorbed_power<T: Real>(
    inertia: T,
    speed: T,
    acceleration: T,
    ratio: T,
    acceleration_ratio: T,
) -> T {
    let turning = speed.square().mul_add(acceleration_ratio, acceleration * ratio);
    inertia * turning * ratio
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::number::trig;

    /// The parts of each angle have the bits of those from its pin.
    fn parts<T: Angle>() {
        let pose = Pose::<T>::of_bend(T::from_f64(0.5), T::from_f64(0.75));
        for i in -400..400 {
            let reduced = T::reduce(f64::from(i) * 0.1);
            let (s, c) = trig::pin(reduced);
            let TorsionParts { sine2, product, .. } = pose.unit_parts(s, c);
            let words = [sine2, product].map(|part| part.value().into().to_bits());
            assert_eq!(parts_of_reduced(reduced).map(|part| part.value().into().to_bits()), words);
        }
    }

    #[test]
    fn parts_of_reduced_angles_are_those_of_pins() {
        parts::<f32>();
        parts::<f64>();
    }
}
