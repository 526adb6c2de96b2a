//! One joint as built: its yokes lean and its cross is not square.
//!
//! With `u` and `v` along driving and driven shaft, `p` the driving pin and `q` the driven one, the
//! deviations are `p·u = sin e₁` (driving yoke), `p·q = sin e₂` (cross) and `q·v = sin e₃` (driven
//! yoke). The joint is a general spherical four-bar linkage. In the frames of the bend plane
//!
//! `p = cos e₁ (t₁ u + cos α e_in + sin α m)`, `q = cos e₃ (−sin ψ e_out + cos ψ m + t₃ v)`
//!
//! with `t = tan e`. Divided by `cos e₁ cos e₃`, `p·q = sin e₂` is `a cos ψ + b sin ψ = C` with
//!
//! `a = sin α`, `b = μ − cos β cos α`, `C = κ − λ cos α`, `μ = t₁ sin β`, `λ = t₃ sin β`,
//! `κ = sin e₂/(cos e₁ cos e₃) − t₁ t₃ cos β`.
//!
//! With `V = a² + b²` and `D = √(V − C²)` the driven angle is `sin ψ = (b C + a D)/V`,
//! `cos ψ = (a C − b D)/V`. As a function of `cos α`, `D²` is a parabola that opens downwards, so
//! its least value is at `cos α = ±1`: the joint turns if `|κ ∓ λ| < cos β ∓ μ` for both signs.
//!
//! The angle error is `arg[(Y + i X)(D − i C)]` with `X = sin α ((1 − cos β) cos α + μ)` and
//! `Y = cos β cos² α + sin² α − μ cos α`. Derived for this library.

use crate::error::{Error, Result, shown_in_degrees};
use crate::mechanics::joint::Joint;
use crate::number::Number;
use crate::number::atan::AtanRange;
use crate::number::double_double::DoubleDouble;
use crate::number::elementary;
use crate::number::float::Real;
use crate::number::reduction;
use crate::number::series;

/// The number of deviations of a joint: driving yoke, cross, driven yoke.
pub const DEVIATIONS: usize = 3;

/// The constants of a joint as built.
#[derive(Clone, Copy, Debug)]
pub(crate) struct JointAsBuilt<T = f64> {
    /// `cos β`, `sin β`, `sin² β` and `1 − cos β`.
    cos: T,
    sin: T,
    sin2: T,
    versine: T,
    /// `μ`, `λ` and `κ`.
    driving: T,
    driven: T,
    cross: T,
    /// `D` and `V` at a right angle: `√(1 + μ² − κ²)` and `1 + μ²`.
    root: T,
    square: T,
    /// `D² = root² + linear cos α − curved cos² α`.
    linear: T,
    curved: T,
    /// `t₁` and `t₃`, and both times `cos β`.
    leans: [T; 2],
    along: [T; 2],
    /// Terms subtracted by the tilts of the cross: `sin e₁ sin e₂/cos e₃` and `sin e₂ sin e₃/cos e₁`.
    tilt_offsets: [T; 2],
    /// `cos e₁` and `cos e₃`.
    cosines: [T; 2],
}

impl JointAsBuilt<DoubleDouble> {
    /// A joint with a bend and deviations in rad.
    pub(crate) fn with_error_terms(bend: f64, deviations: [f64; DEVIATIONS]) -> Self {
        let Joint { cos, sin, versine, .. } = Joint::of_chain(bend);
        let sin_cos = |e| series::sin_cos(reduction::reduce_any(e));
        Self::of_parts([cos, sin, versine], deviations.map(sin_cos))
    }

    /// Whether the joint turns: `|C| < √V` at every angle.
    pub(crate) fn turns(&self) -> bool {
        let Self { cos, driving, driven, cross, .. } = *self;
        [1.0, -1.0].iter().all(|&side| {
            let signed = |x: DoubleDouble| x.scaled(side);
            let room = (cos - signed(driving)) - (cross - signed(driven)).abs();
            room.value() > 0.0
        })
    }
}

/// Checks that each joint of a driveline turns, from bends and deviations `(…, 3)` in rad.
///
/// # Errors
/// A joint that blocks, with the rule.
pub fn check_deviations(bends: &[f64], deviations: &[f64]) -> Result<()> {
    for (joint, (&bend, own)) in bends.iter().zip(deviations.as_chunks().0).enumerate() {
        if !JointAsBuilt::with_error_terms(bend, *own).turns() {
            let [driving, cross, driven] = own.map(shown_in_degrees);
            let bend = shown_in_degrees(bend);
            let problem = format!(
                "are {driving} deg (driving yoke), {cross} deg (cross) and {driven} deg (driven \
                 yoke) at a bend of {bend} deg, with which the joint cannot turn; it turns if \
                 |driving| + |cross| + |driven| < 90 deg - bend"
            );
            return Err(Error::new("deviations", &[joint], problem));
        }
    }
    Ok(())
}

/// Terms that all formulas share at one input angle.
#[derive(Clone, Copy)]
struct Position<T> {
    /// `b`, `C`, `V` and `D`.
    b: T,
    c_term: T,
    square: T,
    root: T,
}

impl<T: Real> JointAsBuilt<T> {
    /// A joint from cosine, sine and versine of its bend, and sines and cosines of its deviations.
    pub(crate) fn of_parts(
        [cos, sin, versine]: [T; 3],
        [(s1, c1), (s2, _), (s3, c3)]: [(T, T); DEVIATIONS],
    ) -> Self {
        let (lean, lean_driven) = (s1 / c1, s3 / c3);
        let (driving, driven) = (lean * sin, lean_driven * sin);
        let cross = s2 / (c1 * c3) - lean * lean_driven * cos;
        let square = T::from_f64(1.0) + driving.square();
        let sin2 = sin.square();
        Self {
            cos,
            sin,
            sin2,
            versine,
            driving,
            driven,
            cross,
            root: (square - cross.square()).sqrt(),
            square,
            linear: (cross * driven - driving * cos).scaled(2.0),
            curved: sin2 + driven.square(),
            leans: [lean, lean_driven],
            along: [lean * cos, lean_driven * cos],
            tilt_offsets: [s1 * s2 / c3, s2 * s3 / c1],
            cosines: [c1, c3],
        }
    }

    /// The constants rounded to a number type.
    pub(crate) fn nearest(joint: &JointAsBuilt<DoubleDouble>) -> Self {
        let near = T::from_double_double;
        Self {
            cos: near(joint.cos),
            sin: near(joint.sin),
            sin2: near(joint.sin2),
            versine: near(joint.versine),
            driving: near(joint.driving),
            driven: near(joint.driven),
            cross: near(joint.cross),
            root: near(joint.root),
            square: near(joint.square),
            linear: near(joint.linear),
            curved: near(joint.curved),
            leans: joint.leans.map(near),
            along: joint.along.map(near),
            tilt_offsets: joint.tilt_offsets.map(near),
            cosines: joint.cosines.map(near),
        }
    }

    #[inline(always)]
    fn position(&self, s: T, c: T) -> Position<T> {
        let b = (-self.cos).mul_add(c, self.driving);
        let c_term = (-self.driven).mul_add(c, self.cross);
        let s2 = s.square();
        let square = b.mul_add(b, s2);
        let root = (b - c_term).mul_add(b + c_term, s2).sqrt();
        Position { b, c_term, square, root }
    }

    /// Numerator and positive denominator of the tangent of the angle error, from sine and cosine
    /// of the input angle.
    #[inline(always)]
    pub(crate) fn error_tangent(&self, s: T, c: T) -> (T, T) {
        let [(x, y), (across, along)] = self.error_tangents(s, c);
        (x.mul_add(along, y * across), y.mul_add(along, -(x * across)))
    }

    /// The same of the two angles whose sum the angle error is: of the share of bend and driving
    /// yoke, and of that of `C`. The error is without its value at a right angle,
    /// `−asin(κ/√(1 + μ²))`, which most of the mean is: numbers that differ little are not
    /// subtracted.
    #[inline(always)]
    fn error_tangents(&self, s: T, c: T) -> [(T, T); 2] {
        let Position { c_term, root, .. } = self.position(s, c);
        let x = s * self.versine.mul_add(c, self.driving);
        let y = self.cos.mul_add(c, -self.driving).mul_add(c, s.square());
        // (D − iC) turned forwards by that value, times √(1 + μ²) (D + D₀).
        let sum = root + self.root;
        let along = root.mul_add(self.root, c_term * self.cross) * sum;
        let change = (-self.curved).mul_add(c, self.linear);
        let across = c * self.cross.mul_add(change, self.driven * self.root * sum);
        [(x, y), (across, along)]
    }

    /// Sine and cosine of the driven angle.
    #[inline(always)]
    pub(crate) fn driven(&self, s: T, c: T) -> (T, T) {
        let Position { b, c_term, square, root } = self.position(s, c);
        let inverse = square.recip();
        (b.mul_add(c_term, s * root) * inverse, s.mul_add(c_term, -(b * root)) * inverse)
    }

    /// Speed ratio, with the bits that it has beside the other rates.
    #[inline(always)]
    pub(crate) fn speed_ratio(&self, s: T, c: T) -> T {
        let [ratio, ..] = self.rates::<false>(s, c);
        ratio
    }

    /// Speed ratio `r`, acceleration ratio and, if `JERK`, jerk ratio; otherwise the last is 0.
    ///
    /// `r = G + E/D` with `G = Q/V`, `F = P/V` and `E = C F − C′`, where `P = V′/2` and
    /// `Q = a b′ − b a′`. The derivative of `1/D` is `−L/D` with `L = (P − C C′)/D²`.
    #[inline(always)]
    pub(crate) fn rates<const JERK: bool>(&self, s: T, c: T) -> [T; 3] {
        let Position { c_term, square, root, .. } = self.position(s, c);
        let both = (square * root).recip();
        let two = T::from_f64(2.0);
        let (of_square, of_root) = (root * both, square * both);
        let of_root2 = of_root.square();
        let swing = self.cos * self.driving;
        let (sine, cosine) = (self.driven * s, self.driven * c);
        let p = s * self.sin2.mul_add(c, swing);
        let p1 = self.sin2.mul_add((c - s) * (c + s), swing * c);
        let q = (-self.driving).mul_add(c, self.cos);
        let q1 = self.driving * s;
        let f = p * of_square;
        let f1 = p1.mul_add(of_square, -(two * f * f));
        let g = q * of_square;
        let g1 = q1.mul_add(of_square, -(two * g * f));
        let e = c_term.mul_add(f, -sine);
        let e1 = sine.mul_add(f, c_term.mul_add(f1, -cosine));
        let l = (-c_term).mul_add(sine, p) * of_root2;
        let k = (-e).mul_add(l, e1);
        let ratio = e.mul_add(of_root, g);
        let acceleration = k.mul_add(of_root, g1);
        if !JERK {
            return [ratio, acceleration, T::from_f64(0.0)];
        }
        let p2 = -(s * (self.sin2 * c).mul_add(T::from_f64(4.0), swing));
        let q2 = self.driving * c;
        let f2 = of_square * (-(two * f)).mul_add(p1, p2) - T::from_f64(4.0) * f * f1;
        let g2 = of_square * (-(two * f)).mul_add(q1, q2) - two * g1.mul_add(f, g * f1);
        let e2 = cosine.mul_add(f, two * sine * f1) + c_term.mul_add(f2, sine);
        let l1 = of_root2 * (p1 - sine.mul_add(sine, c_term * cosine)) - two * l * l;
        let k1 = e2 - e1.mul_add(l, e * l1);
        let jerk = (-k).mul_add(l, k1).mul_add(of_root, g2);
        [ratio, acceleration, jerk]
    }

    /// The moment on the joint's driven shaft for a torsion of 1 in the driving shaft is
    /// `u + M₁ e_in − M₃ m`; its part across the driven shaft is `−M₂ e_out − M₃ m`. Returns `M₁`,
    /// `M₂` and `M₃`.
    ///
    /// The moment is normal to both pins: `p × q` divided by its component along `u`.
    #[inline(always)]
    pub(crate) fn moments(&self, s: T, c: T) -> [T; 3] {
        let LeaningPins { sine, cosine, across, square, along_driving } = self.pins(s, c);
        let inverse = along_driving.recip();
        let [lean, lean_driven] = self.leans;
        let driven_along_u = self.sin.mul_add(sine, self.along[1] * square);
        let driving_along_v = self.sin.mul_add(c, self.along[0]);
        let in_plane = s.mul_add(driven_along_u, -(lean * cosine));
        let out_plane = (s * lean_driven).mul_add(square, -(driving_along_v * cosine));
        let normal = lean.mul_add(across, -(c * driven_along_u));
        [in_plane * inverse, -(out_plane * inverse), -(normal * inverse)]
    }

    /// Numerator and denominator of the tangent of [`JointAsBuilt::tilt_driving`].
    #[inline(always)]
    pub(crate) fn tilt_driving_tangent(&self, s: T, c: T) -> (T, T) {
        let LeaningPins { sine, square, along_driving, .. } = self.pins(s, c);
        let offset = self.along[1] - self.tilt_offsets[0];
        (self.sin.mul_add(sine, offset * square), self.cosines[0] * along_driving)
    }

    /// Numerator and denominator of the tangent of [`JointAsBuilt::tilt_driven`].
    #[inline(always)]
    pub(crate) fn tilt_driven_tangent(&self, s: T, c: T) -> (T, T) {
        let along = self.sin.mul_add(c, self.along[0]) - self.tilt_offsets[1];
        (along, self.cosines[1] * self.position(s, c).root)
    }

    /// The driven pin and its product with the driving one, without a division.
    #[inline(always)]
    fn pins(&self, s: T, c: T) -> LeaningPins<T> {
        let Position { b, c_term, square, root } = self.position(s, c);
        let sine = b.mul_add(c_term, s * root);
        let cosine = s.mul_add(c_term, -(b * root));
        let across = (-self.cos).mul_add(sine, self.driven * square);
        let along_driving = (-s).mul_add(across, c * cosine);
        LeaningPins { sine, cosine, across, square, along_driving }
    }
}

/// The driven pin and the component of the normal of both pins along the driving shaft, each
/// multiplied by `V`.
#[derive(Clone, Copy)]
struct LeaningPins<T> {
    /// `sin ψ` and `cos ψ`.
    sine: T,
    cosine: T,
    /// `λ − cos β sin ψ`, the component of the driven pin along `e_in`.
    across: T,
    /// `V` itself.
    square: T,
    along_driving: T,
}

impl<T: Number> JointAsBuilt<T> {
    /// The angle error within a third, without its value at a right angle, speed ratio and
    /// acceleration ratio, with the bits that each has alone.
    #[inline(always)]
    pub(crate) fn motion(&self, s: T, c: T) -> [T; 3] {
        let [ratio, acceleration, _] = self.rates::<false>(s, c);
        [self.angle_error(AtanRange::Third, s, c), ratio, acceleration]
    }

    /// The angle error within a range of tangents, without its value at a right angle. The widest
    /// range adds the shares of bend and deviations: their sum may exceed a right angle.
    #[inline(always)]
    pub(crate) fn angle_error(&self, range: AtanRange, s: T, c: T) -> T {
        let one = |atan: fn(T) -> T| {
            let (y, x) = self.error_tangent(s, c);
            atan(y / x)
        };
        match range {
            AtanRange::Hundredth | AtanRange::Tenth => one(T::atan_tenth),
            AtanRange::Third => one(T::atan_third),
            AtanRange::One | AtanRange::Any => {
                let [(x, y), (across, along)] = self.error_tangents(s, c);
                T::atan_any(x, y) + T::atan_any(across, along)
            }
        }
    }

    /// Tilt of the cross against the driving shaft in rad: its angle about the driving pin, from
    /// where the driven pin is normal to the driving shaft.
    #[inline(always)]
    pub(crate) fn tilt_driving(&self, s: T, c: T) -> T {
        let (y, x) = self.tilt_driving_tangent(s, c);
        T::atan_any(y, x)
    }

    /// Tilt of the cross against the driven shaft in rad: its angle about the driven pin, from
    /// where the driving pin is normal to the driven shaft.
    #[inline(always)]
    pub(crate) fn tilt_driven(&self, s: T, c: T) -> T {
        let (y, x) = self.tilt_driven_tangent(s, c);
        T::atan_any(y, x)
    }
}

impl JointAsBuilt {
    /// Lag of the driven angle behind a right angle of the drive, `asin(κ/√(1 + μ²))`, apart from
    /// the share of the driving yoke.
    pub(crate) fn lag_at_right_angle(&self) -> f64 {
        elementary::atan2(self.cross, self.root)
    }
}

impl JointAsBuilt<DoubleDouble> {
    /// A range that contains the tangents of the angle error.
    ///
    /// The error is at most the ideal joint's, `asin tan²(β/2)`, and the shares of the driving yoke,
    /// `asin(tan e₁ tan β)`, and of `C`.
    pub(crate) fn range(&self) -> AtanRange {
        let [cos, versine, driving, driven, cross, root] =
            [self.cos, self.versine, self.driving, self.driven, self.cross, self.root]
                .map(DoubleDouble::value);
        let least = cos - driving.abs();
        let sines = [
            versine / (1.0 + cos),
            driving.abs() / cos,
            (cross.abs() + driven.abs()) / least,
            cross.abs() / elementary::hypot(cross, root),
        ];
        let sum: f64 = sines.map(elementary::asin).iter().sum();
        // A NaN means that no bound was found.
        if sum < 0.75 {
            AtanRange::holding(elementary::tan(sum) * (1.0 + 1e-9))
        } else {
            AtanRange::Any
        }
    }
}
