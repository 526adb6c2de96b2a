//! Chains of joints: folding a driveline into its equivalent joint.
//!
//! Let `w = e^{iα}` for the drive angle `α`. A joint maps `w → w − k w̄` with `k = tan²(β/2)`, a
//! shaft between two joints `w → e^{ip} w` with `p = δ − τ + 90°`. So every shaft of every chain
//! follows `w → A w + B w̄`, and `|A|² − |B|² = Π (1 − k_j²)` is known without cancellation.
//!
//! All of this is computed with error terms, so the constants of a chain are as accurate as those
//! of one joint.

use std::ops::{Mul, Sub};

use crate::mechanics::double_angle::DoubleAngle;
use crate::mechanics::joint::Joint;
use crate::number::atan::Atan;
use crate::number::double_double::DoubleDouble;
use crate::number::elementary::atan2;
use crate::number::float::{Real, inverse_power_of_two};
use crate::number::reduction::{self, HALF_PI, ROUNDING};
use crate::number::{series, trig};

/// A complex number.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Complex {
    pub(crate) re: DoubleDouble,
    pub(crate) im: DoubleDouble,
}

impl Complex {
    #[inline(always)]
    pub(crate) fn new(re: DoubleDouble, im: DoubleDouble) -> Self {
        Self { re, im }
    }

    #[inline(always)]
    pub(crate) fn conj(self) -> Self {
        Self { re: self.re, im: -self.im }
    }

    /// The same number in words that do not overlap, which products require. They overlap after a
    /// sum that cancels.
    #[inline(always)]
    fn renormalized(self) -> Self {
        Self { re: self.re.renormalized(), im: self.im.renormalized() }
    }

    #[inline(always)]
    fn times(self, factor: DoubleDouble) -> Self {
        Self { re: self.re * factor, im: self.im * factor }
    }

    /// Multiplies by a power of two, exactly.
    #[inline(always)]
    fn scaled(self, power: f64) -> Self {
        Self { re: self.re.scaled(power), im: self.im.scaled(power) }
    }

    #[inline(always)]
    fn norm_squared(self) -> DoubleDouble {
        self.re.square() + self.im.square()
    }
}

impl Sub for Complex {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self { re: self.re - other.re, im: self.im - other.im }
    }
}

impl Mul for Complex {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self {
            re: self.re * other.re - self.im * other.im,
            im: self.re * other.im + self.im * other.re,
        }
    }
}

/// The map `w → A w + B w̄` of a chain up to some shaft.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Transfer {
    pub(crate) a: Complex,
    pub(crate) b: Complex,
    /// `|A|² − |B|²`.
    pub(crate) complement: DoubleDouble,
}

impl Default for Transfer {
    fn default() -> Self {
        let a = Complex::new(DoubleDouble::ONE, DoubleDouble::default());
        Self { a, b: Complex::default(), complement: DoubleDouble::ONE }
    }
}

impl Transfer {
    /// The map from the first shaft of a chain to its last.
    fn of_chain(bends: &[f64], twists: &[f64], phases: &[f64]) -> Self {
        let mut transfer = Self::default();
        for (j, &bend) in bends.iter().enumerate() {
            if j > 0 {
                transfer.pass_shaft(shaft_turn(phases[j - 1], twists[j - 1]));
            }
            transfer.pass_joint(&Joint::with_error_terms(bend));
        }
        transfer
    }

    /// Appends an intermediate shaft, given its turn.
    #[inline(always)]
    pub(crate) fn pass_shaft(&mut self, turn: Complex) {
        self.a = self.a * turn;
        self.b = self.b * turn;
    }

    /// Appends a joint: `(A, B) → (A − k B̄, B − k Ā)`. A straight joint changes nothing.
    #[inline(always)]
    pub(crate) fn pass_joint(&mut self, joint: &Joint<DoubleDouble>) {
        self.pass(joint.k, joint.complement());
    }

    /// The same, given `k` and `1 − k²`.
    #[inline(always)]
    pub(crate) fn pass(&mut self, k: DoubleDouble, complement: DoubleDouble) {
        let (a, b) = (self.a, self.b);
        self.a = a - b.conj().times(k);
        self.b = b - a.conj().times(k);
        self.complement = self.complement * complement;
    }

    /// The same map in words that do not overlap. Without this, steep joints magnify what the
    /// products drop.
    #[inline(always)]
    pub(crate) fn renormalized(self) -> Self {
        Self { a: self.a.renormalized(), b: self.b.renormalized(), complement: self.complement }
    }

    /// The joint that moves the shaft exactly as the whole chain does; branch-free.
    #[inline(always)]
    pub(crate) fn equivalent(&self) -> Equivalent<DoubleDouble> {
        // −q/|q| = e^{−2iφ} for q = B/A, up to a positive factor.
        let z = (Complex::default() - self.b * self.a.conj()).renormalized();
        // Scales by a power of two, so that squares of small numbers do not underflow.
        let largest = z.re.high.abs().max(z.im.high.abs());
        let straight = largest == 0.0;
        let scale = inverse_power_of_two(largest);
        let z = z.scaled(scale);
        let size = z.norm_squared().sqrt();
        let a2 = self.a.norm_squared();
        let k = (size / a2).scaled(1.0 / scale);
        let joint = Joint::from_k(k, self.complement / a2);
        let inverse = size.recip();
        let (turn_cos, turn_sin) = half_turn(z.re * inverse, -z.im * inverse);
        if straight { Equivalent::STRAIGHT } else { Equivalent { joint, turn_cos, turn_sin } }
    }

    /// `q = B/A`, rounded.
    pub(crate) fn q(&self) -> nalgebra::Complex<f64> {
        let [a, b] = [self.a, self.b].map(|z| nalgebra::Complex::new(z.re.value(), z.im.value()));
        b * a.conj() / a.norm_sqr()
    }

    /// The constants of the shaft's motion in twice the drive angle.
    #[inline(always)]
    pub(crate) fn double_angle(&self) -> DoubleAngle<DoubleDouble> {
        let a2 = self.a.norm_squared();
        let inverse = a2.recip();
        let q = (self.b * self.a.conj()).renormalized().times(-inverse);
        DoubleAngle::new([q.re, q.im], q.norm_squared(), self.complement * inverse)
    }

    /// Whether cancellation left too few digits of the map, given the sum of `tan²(β/2)` of its
    /// joints and the product of `1 + tan²(β/2)`, or bounds on them.
    #[inline(always)]
    pub(crate) fn loses_digits(&self, sum: f64, product: f64) -> bool {
        let part = |size: f64, x: Complex| {
            // Squares of small numbers would underflow.
            let scale = inverse_power_of_two(size);
            x.scaled(scale).norm_squared().high < (Self::LEAST * size * scale).powi(2)
        };
        sum > 0.0 && (part(product, self.a) || part(product * sum.min(1.0), self.b))
    }

    /// Whether cancellation left too few digits of a row of the matrix, given the product of
    /// `1 + tan²(β/2)` of the joints or a bound on it.
    #[inline(always)]
    pub(crate) fn row_loses_digits(&self, product: f64) -> bool {
        let [cc, cs, sc, ss] = self.matrix().map(|x| x.high.abs());
        cc.max(cs).min(sc.max(ss)) < Self::LEAST * product
    }

    /// The part of the terms of a sum that cancellation may leave.
    const LEAST: f64 = 1.0 / (1_u64 << 16) as f64;

    /// `w → A w + B w̄` as a matrix on `(cos α, sin α)`. The rows give cosine and sine of the
    /// joint's input angle, multiplied by the same positive length.
    pub(crate) fn matrix(&self) -> [DoubleDouble; 4] {
        let (a, b) = (self.a, self.b);
        [a.re + b.re, b.im - a.im, a.im + b.im, a.re - b.re].map(DoubleDouble::renormalized)
    }
}

/// `e^{ip}` of an intermediate shaft, `p = δ − τ + 90°`.
pub(crate) fn shaft_turn(phase: f64, twist: f64) -> Complex {
    if trig::any_too_large([phase, twist].into_iter()) {
        return far_shaft_turn(phase, twist, trig::sin_cos_double_double);
    }
    near_shaft_turn(phase, twist)
}

/// The same for any angles, as a product of the turns by phase and twist.
fn far_shaft_turn(
    phase: f64,
    twist: f64,
    sin_cos: impl Fn((DoubleDouble, u64)) -> (DoubleDouble, DoubleDouble),
) -> Complex {
    let turn = |angle: f64| {
        let (sine, cosine) = sin_cos(reduction::reduce_any(angle));
        Complex::new(cosine, sine)
    };
    let Complex { re, im } = turn(phase) * turn(-twist);
    Complex::new(-im, re)
}

/// The same, branch-free, for angles below the limit of [`trig::any_too_large`].
#[inline(always)]
pub(crate) fn near_shaft_turn(phase: f64, twist: f64) -> Complex {
    let reduced = reduction::reduce_double_double(DoubleDouble::two_sum(phase, -twist));
    let (sine, cosine) = trig::sin_cos_double_double(reduced);
    Complex::new(-sine, cosine)
}

/// The same with nearly all digits of a double-double.
pub(crate) fn wide_shaft_turn(phase: f64, twist: f64) -> Complex {
    if trig::any_too_large([phase, twist].into_iter()) {
        return far_shaft_turn(phase, twist, series::sin_cos);
    }
    near_wide_shaft_turn(phase, twist)
}

/// The same, branch-free, for angles below the limit of [`trig::any_too_large`].
#[inline(always)]
pub(crate) fn near_wide_shaft_turn(phase: f64, twist: f64) -> Complex {
    let DoubleDouble { high, low } = DoubleDouble::two_sum(phase, -twist);
    let (remainder, quadrant) = reduction::reduce_double_double(DoubleDouble::exact(high));
    // The error term of a large difference may exceed the remainder.
    let remainder = (remainder + DoubleDouble::exact(low)).renormalized();
    let (sine, cosine) = series::sin_cos((remainder, quadrant));
    Complex::new(-sine, cosine)
}

/// Cosine and sine of `φ` in `(−90°, 90°]` from cosine and sine of `2φ`.
#[inline(always)]
fn half_turn(cos_2: DoubleDouble, sin_2: DoubleDouble) -> (DoubleDouble, DoubleDouble) {
    let half = (DoubleDouble::ONE + cos_2.abs()).scaled(0.5);
    let large = half.sqrt();
    let small = sin_2.abs().scaled(0.5) / large;
    if cos_2.high >= 0.0 { (large, small.copysign(sin_2)) } else { (small, large.copysign(sin_2)) }
}

/// An angle in `(−90°, 90°]` as a multiple of a quarter turn and a remainder.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Offset {
    pub(crate) remainder: DoubleDouble,
    /// −1, 0 or 1.
    pub(crate) quarters: f64,
}

impl Default for Offset {
    fn default() -> Self {
        Self { remainder: DoubleDouble::default(), quarters: 0.0 }
    }
}

impl Offset {
    /// A reduced angle so near to a multiple of a quarter turn that its error terms do not suffice.
    const NEAR: f64 = 1.0 / (1_u64 << 24) as f64;

    /// Whether the sum with this angle has lost digits that its sine or cosine needs.
    #[inline(always)]
    pub(crate) fn loses_digits(self, (remainder, _): (DoubleDouble, u64)) -> bool {
        remainder.high.abs() < Self::NEAR && self.remainder.high != 0.0
    }

    /// The angle with this cosine, which is not negative, and sine; branch-free.
    #[inline(always)]
    fn new(cosine: DoubleDouble, sine: DoubleDouble) -> Self {
        let quarters = if sine.abs().exceeds(cosine) { 1_f64.copysign(sine.high) } else { 0.0 };
        let turned = DoubleDouble::exact(quarters);
        let (y, x) =
            if quarters == 0.0 { (sine, cosine) } else { (-(cosine * turned), sine * turned) };
        // One step of Newton's method doubles the digits.
        let near = DoubleDouble::exact(f64::atan_one(y.high, x.high));
        let (s, c) = series::sin_cos_of_remainder(near);
        let remainder = (near + (y * c - x * s).renormalized()).renormalized();
        Self { remainder, quarters }
    }

    /// The sum of a reduced angle and this one, multiplied by 2 if `double`, reduced again.
    #[inline(always)]
    pub(crate) fn after(
        self,
        (remainder, quadrant): (DoubleDouble, u64),
        double: bool,
    ) -> (DoubleDouble, u64) {
        let sum = (remainder + self.remainder).renormalized();
        let quadrant = quadrant.wrapping_add((self.quarters + ROUNDING).to_bits());
        let (sum, quadrant) =
            if double { (sum.scaled(2.0), quadrant.wrapping_mul(2)) } else { (sum, quadrant) };
        let (remainder, more) = reduction::reduce_double_double(sum);
        (remainder, quadrant.wrapping_add(more))
    }

    /// The angle in rad.
    pub(crate) fn value(self) -> f64 {
        self.quarters.mul_add(HALF_PI[0], self.remainder.value())
    }
}

/// A joint whose input angle is the drive angle plus an offset `φ`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Equivalent<T = f64> {
    /// The joint with the equivalent bend.
    pub joint: Joint<T>,
    /// `cos φ`.
    pub turn_cos: T,
    /// `sin φ`; exactly zero where the offset is zero.
    pub turn_sin: T,
}

impl Equivalent<DoubleDouble> {
    /// `φ`.
    #[inline(always)]
    pub(crate) fn offset(&self) -> Offset {
        Offset::new(self.turn_cos, self.turn_sin)
    }

    pub(crate) const STRAIGHT: Self = Self {
        joint: Joint::STRAIGHT,
        turn_cos: DoubleDouble::ONE,
        turn_sin: DoubleDouble::exact(0.0),
    };

    /// A joint on the drive shaft, without an offset.
    #[inline(always)]
    pub(crate) fn of_joint(joint: Joint<DoubleDouble>) -> Self {
        Self { joint, ..Self::STRAIGHT }
    }
}

impl Equivalent {
    /// The joint that moves the last shaft of a chain exactly as its `n` joints do, from `n` bends,
    /// `n − 1` twists and `n − 1` phases in rad.
    ///
    /// ```
    /// let [bend, no_twist] = [0.3, 0.0];
    /// let one = cardan::Equivalent::of_chain(&[bend, 0.0], &[no_twist], &[0.7]);
    /// assert!((one.joint.bend() - bend).abs() < 1e-15);
    /// ```
    pub fn of_chain(bends: &[f64], twists: &[f64], phases: &[f64]) -> Self {
        Self::of_transfer(&Transfer::of_chain(bends, twists, phases), bends)
    }

    /// The same from the map of the chain with these bends.
    pub(crate) fn of_transfer(transfer: &Transfer, bends: &[f64]) -> Self {
        let equivalent = transfer.equivalent();
        let mut bent = bends.iter().filter(|&&bend| bend != 0.0);
        match (bent.next(), bent.next()) {
            // The joint's own constants hold where tan²(β/2) is too small for a double.
            (Some(&bend), None) => {
                let joint = Joint::with_error_terms(bend);
                Self::nearest(&Equivalent { joint, ..equivalent })
            }
            _ => Self::nearest(&equivalent),
        }
    }
}

impl Equivalent {
    pub(crate) fn nearest(equivalent: &Equivalent<DoubleDouble>) -> Self {
        Self {
            joint: Joint::nearest(&equivalent.joint),
            turn_cos: equivalent.turn_cos.value(),
            turn_sin: equivalent.turn_sin.value(),
        }
    }

    /// `φ` in rad, in `(−π/2, π/2]`: the joint's input angle is `α + φ`.
    pub fn angle_offset(&self) -> f64 {
        atan2(self.turn_sin, self.turn_cos)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folding_keeps_the_area() {
        let (bends, twists, phases) = ([0.3, 1.2, 0.7], [0.4, -2.0], [1.1, 3e13]);
        let transfer = Transfer::of_chain(&bends, &twists, &phases);
        let [cc, cs, sc, ss] = transfer.matrix();
        let determinant = (cc * ss - cs * sc).value();
        assert!((determinant - transfer.complement.value()).abs() < 1e-30);
    }

    #[test]
    fn far_shafts_turn_by_the_difference() {
        for (phase, twist) in [(3e13, 0.25), (0.25, 3e13), (-7e15, 5e14)] {
            let turn = shaft_turn(phase, twist);
            let ((sine, cosine), (other_sine, other_cosine)) = (phase.sin_cos(), twist.sin_cos());
            // A quarter turn ahead of the difference.
            let difference = sine * other_cosine - cosine * other_sine;
            assert!((turn.re.value() + difference).abs() < 1e-15);
            let difference = cosine * other_cosine + sine * other_sine;
            assert!((turn.im.value() - difference).abs() < 1e-15);
        }
    }

    #[test]
    fn the_smallest_bends_keep_their_digits() {
        let same = |found: f64, expected: f64| (found / expected - 1.0).abs() < 4.0 * f64::EPSILON;
        // Two small bends in line add their squares.
        for bend in [1e-60, 1e-100, 1e-140] {
            let two = Equivalent::of_chain(&[bend; 2], &[0.0], &[-std::f64::consts::FRAC_PI_2]);
            assert!(same(two.joint.bend(), bend * 2_f64.sqrt()));
        }
        for bend in [1e-100, 1e-200, 1e-300] {
            let one = Equivalent::of_chain(&[0.0, bend, 0.0], &[0.3, 0.1], &[0.7, -0.2]);
            assert!(same(one.joint.bend(), bend));
        }
    }
}
