//! Where the cross of a joint stands: its tilts in both yokes, its pins in space, and how it swings.
//!
//! With the joint's input angle `α` the pin of the driving yoke is `a = cos α e_in + sin α m`. That of
//! the driven yoke is perpendicular to it and to the driven shaft, `u_out × a` over its length
//! `√(sin² α + cos² β cos² α)`, and `u_out × a = cos β cos α m − sin α e_out`.
//!
//! The tilts change with the input angle by `dψ₁ = sin ψ₂ r dα` and `dψ₂ = −sin ψ₁ dα`, where `r` is
//! the speed ratio of the joint (Grossmann (3) and (5), differentiated).

use crate::mechanics::chain::Transfer;
use crate::mechanics::frame::Frame;
use crate::mechanics::joint::Joint;
use crate::mechanics::turning::TurnMatrix;
use crate::number::atan::Atan;
use crate::number::double_double::DoubleDouble;
use crate::number::float::Real;

/// The cross of one joint of a driveline in space, and the map from the drive angle to the joint's
/// input angle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cross<T> {
    /// The map from the drive to this joint's input angle.
    pub(crate) matrix: TurnMatrix<T>,
    /// `sin β`.
    sine: T,
    /// `cos β`.
    cosine: T,
    /// `e_in`.
    inward: [T; 3],
    /// `e_out`.
    outward: [T; 3],
    /// `m`.
    normal: [T; 3],
}

impl<T: Real> Cross<T> {
    /// The cross of a joint that `transfer` drives, in the frame of its driving shaft.
    pub(crate) fn new(
        transfer: &Transfer,
        joint: &Joint<DoubleDouble>,
        Frame { shaft, in_plane, normal }: Frame,
    ) -> Self {
        let outward = |i: usize| in_plane[i] * joint.cos - joint.sin * shaft[i];
        let near = |vector: [DoubleDouble; 3]| vector.map(T::from_double_double);
        Self {
            matrix: TurnMatrix::new(transfer.matrix()),
            sine: T::from_double_double(joint.sin),
            cosine: T::from_double_double(joint.cos),
            inward: near(in_plane),
            outward: near([outward(0), outward(1), outward(2)]),
            normal: near(normal),
        }
    }

    /// The cross by sine and cosine of the bend, for sine and cosine of the joint's input angle and for
    /// what is no vector.
    pub(crate) fn of_bend(sine: T, cosine: T) -> Self {
        let (matrix, none) = (TurnMatrix::identity(), [T::from_f64(0.0); 3]);
        Self { matrix, sine, cosine, inward: none, outward: none, normal: none }
    }

    /// The cross for sine and cosine of the joint's input angle.
    #[inline(always)]
    pub(crate) fn by_own_pins(self) -> Self {
        Self { matrix: TurnMatrix::identity(), ..self }
    }

    /// Sine and cosine of the joint's input angle, multiplied by a common length, and the square of
    /// that length multiplied by `sin² α + cos² β cos² α`.
    #[inline(always)]
    fn turn(&self, s: T, c: T) -> (T, T, T) {
        let (sine, cosine) = self.matrix.turn(s, c);
        let across = self.cosine * cosine;
        (sine, cosine, across.mul_add(across, sine.square()))
    }

    /// Rate of the cross in the driving yoke per radian of the drive, `r_{j+1} sin ψ₂`, from the speed
    /// ratio `r_j` of the driving shaft.
    #[inline(always)]
    pub(crate) fn swing_driving(&self, ratio: T, s: T, c: T) -> T {
        let (sine, cosine, square) = self.turn(s, c);
        let length = (sine.square() + cosine.square()).sqrt();
        ratio * (self.cosine * self.sine * cosine * length / square)
    }

    /// Rate of the cross in the driven yoke per radian of the drive, `−r_j sin ψ₁`.
    #[inline(always)]
    pub(crate) fn swing_driven(&self, ratio: T, s: T, c: T) -> T {
        let (sine, _, square) = self.turn(s, c);
        -(ratio * (self.sine * sine / square.sqrt()))
    }

    /// The unit vector along the pin of the driving yoke.
    #[inline(always)]
    pub(crate) fn driving_pin(&self, s: T, c: T) -> [T; 3] {
        let (sine, cosine, _) = self.turn(s, c);
        let length = (sine.square() + cosine.square()).sqrt();
        let [sine, cosine] = T::both_over(sine, cosine, length);
        [0, 1, 2].map(|i| self.inward[i].mul_add(cosine, self.normal[i] * sine))
    }

    /// The unit vector along the pin of the driven yoke.
    #[inline(always)]
    pub(crate) fn driven_pin(&self, s: T, c: T) -> [T; 3] {
        let (sine, cosine, square) = self.turn(s, c);
        let [sine, cosine] = T::both_over(sine, self.cosine * cosine, square.sqrt());
        [0, 1, 2].map(|i| self.normal[i].mul_add(cosine, -(self.outward[i] * sine)))
    }
}

impl<T: Real> Cross<T> {
    /// Axes at rest of which the pin of the driving or the driven yoke turns in the plane of the last
    /// two: the shaft, then `e_in` or `e_out`, then `m`; and how it turns there.
    #[inline(always)]
    pub(crate) fn turning_pin(&self, driving: bool) -> ([[T; 3]; 3], TurningPin<T>) {
        let (e, m) = (if driving { self.inward } else { self.outward }, self.normal);
        let shaft = [(1, 2), (2, 0), (0, 1)].map(|(j, k)| e[j].mul_add(m[k], -(e[k] * m[j])));
        let TurnMatrix([cc, cs, sc, ss]) = self.matrix;
        let driven = || TurnMatrix([-sc, -ss, self.cosine * cc, self.cosine * cs]);
        ([shaft, e, m], TurningPin(if driving { self.matrix } else { driven() }))
    }
}

/// The map from `(cos α, sin α)` of the drive to the components of a pin in the plane in which it
/// turns, multiplied by a positive length.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TurningPin<T>(TurnMatrix<T>);

impl<T: Real> TurningPin<T> {
    /// A vector with components along the shaft and the axes of that plane, along the shaft, the pin
    /// and across both.
    #[inline(always)]
    pub(crate) fn components(&self, [x, y, z]: [T; 3], s: T, c: T) -> [T; 3] {
        let (b, a) = self.0.turn(s, c);
        let inverse = (a.square() + b.square()).sqrt().recip();
        [x, a.mul_add(y, b * z) * inverse, a.mul_add(z, -(b * y)) * inverse]
    }
}

impl<T: Atan> Cross<T> {
    /// Tilt `ψ₁` of the cross relative to the driving shaft in rad, `tan ψ₁ = tan β sin α`
    /// (Grossmann (3)).
    #[inline(always)]
    pub(crate) fn tilt_driving(&self, s: T, c: T) -> T {
        let (sine, cosine) = self.matrix.turn(s, c);
        let length = (sine.square() + cosine.square()).sqrt();
        T::atan_any(self.sine * sine, self.cosine * length)
    }

    /// Tilt `ψ₂` of the cross relative to the driven shaft in rad, `sin ψ₂ = sin β cos α`
    /// (Grossmann (5)); its cosine is `√(sin² α + cos² β cos² α)`.
    #[inline(always)]
    pub(crate) fn tilt_driven(&self, s: T, c: T) -> T {
        let (_, cosine, square) = self.turn(s, c);
        T::atan_any(self.sine * cosine, square.sqrt())
    }
}
