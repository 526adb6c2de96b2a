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

use crate::error::{Error, Result};
use crate::mechanics::joint::Joint;
use crate::number::double_double::DoubleDouble;
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
    /// `D` at a right angle, `√(1 + μ² − κ²)`.
    root: T,
    /// `D² = root² + linear cos α − curved cos² α`.
    linear: T,
    curved: T,
}

impl JointAsBuilt<DoubleDouble> {
    /// A joint with a bend and deviations in rad.
    pub(crate) fn with_error_terms(bend: f64, deviations: [f64; DEVIATIONS]) -> Self {
        let Joint { cos, sin, sin2, versine, .. } = Joint::of_chain(bend);
        let [(s1, c1), (s2, _), (s3, c3)] =
            deviations.map(|e| series::sin_cos(reduction::reduce_any(e)));
        let (lean, lean_driven) = (s1 / c1, s3 / c3);
        let (driving, driven) = (lean * sin, lean_driven * sin);
        let cross = s2 / (c1 * c3) - lean * lean_driven * cos;
        Self {
            cos,
            sin,
            sin2,
            versine,
            driving,
            driven,
            cross,
            root: (DoubleDouble::ONE + driving.square() - cross.square()).sqrt(),
            linear: (cross * driven - driving * cos).scaled(2.0),
            curved: sin2 + driven.square(),
        }
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
            let [driving, cross, driven] = own.map(f64::to_degrees);
            let problem = format!(
                "are {driving} deg (driving yoke), {cross} deg (cross) and {driven} deg (driven \
                 yoke) at a bend of {} deg, with which the joint cannot turn; it turns if \
                 |C| < R at every angle, for which |driving| + |cross| + |driven| < 90 deg - bend \
                 is enough",
                bend.to_degrees()
            );
            return Err(Error::new("deviations", &[joint], problem));
        }
    }
    Ok(())
}

/// What all formulas share at one input angle.
#[derive(Clone, Copy)]
struct Position<T> {
    /// `b`, `C`, `V` and `D`.
    b: T,
    c_term: T,
    square: T,
    root: T,
}

impl<T: Real> JointAsBuilt<T> {
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
            linear: near(joint.linear),
            curved: near(joint.curved),
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
    /// of the input angle. The error is without its value at a right angle, `−asin(κ/√(1 + μ²))`,
    /// which most of the mean is: numbers that differ little are not subtracted.
    #[inline(always)]
    pub(crate) fn error_tangent(&self, s: T, c: T) -> (T, T) {
        let Position { c_term, root, .. } = self.position(s, c);
        let x = s * self.versine.mul_add(c, self.driving);
        let y = self.cos.mul_add(c, -self.driving).mul_add(c, s.square());
        // (D − iC) turned forwards by that value, times √(1 + μ²) (D + D₀).
        let sum = root + self.root;
        let along = root.mul_add(self.root, c_term * self.cross) * sum;
        let change = (-self.curved).mul_add(c, self.linear);
        let across = c * self.cross.mul_add(change, self.driven * self.root * sum);
        (x.mul_add(along, y * across), y.mul_add(along, -(x * across)))
    }

    /// Sine and cosine of the driven angle.
    #[inline(always)]
    pub(crate) fn driven(&self, s: T, c: T) -> (T, T) {
        let Position { b, c_term, square, root } = self.position(s, c);
        let inverse = square.recip();
        (b.mul_add(c_term, s * root) * inverse, s.mul_add(c_term, -(b * root)) * inverse)
    }

    /// Speed ratio `r`, acceleration ratio and jerk ratio.
    ///
    /// `r = G + E/D` with `G = Q/V`, `F = P/V` and `E = C F − C′`. The derivative of `1/D` is
    /// `−L/D` with `L = (P − C C′)/D²`.
    #[inline(always)]
    pub(crate) fn rates(&self, s: T, c: T) -> [T; 3] {
        let Position { c_term, square, root, .. } = self.position(s, c);
        let two = T::from_f64(2.0);
        let both = (square * root).recip();
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
}

impl JointAsBuilt {
    /// What the driven angle is behind a right angle of the drive, `asin(κ/√(1 + μ²))`, apart from
    /// the share of the driving yoke.
    pub(crate) fn lag_at_right_angle(&self) -> f64 {
        self.cross.atan2(self.root)
    }
}
