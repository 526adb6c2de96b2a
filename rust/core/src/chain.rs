//! Any chain of joints is one joint: folding a driveline into its equivalent joint.
//!
//! Write `w = e^{iα}` for the drive angle. A joint acts as `w → w − k w̄` with `k = tan²(β/2)`, a
//! shaft between two joints as `w → e^{ip} w` with `p = δ − τ + 90°`. So every shaft of every
//! chain is `w → A w + B w̄`, and `|A|² − |B|² = Π (1 − k_j²)` is known without cancellation.

use nalgebra::Complex;

use crate::joint::Joint;
use crate::trig;

/// The map `w → A w + B w̄` of a chain so far.
#[derive(Clone, Copy, Debug)]
pub struct Transfer {
    a: Complex<f64>,
    b: Complex<f64>,
    /// `|A|² − |B|²`.
    complement: f64,
    /// The joint that made the map, while there is only one: its constants need no folding.
    single: Option<Joint>,
}

impl Default for Transfer {
    fn default() -> Self {
        Self { a: Complex::new(1.0, 0.0), b: Complex::new(0.0, 0.0), complement: 1.0, single: None }
    }
}

impl Transfer {
    /// The map at the output of the last of `joints` when its first shaft drives.
    pub fn of_chain(bends: &[f64], twists: &[f64], phases: &[f64]) -> Self {
        let mut transfer = Self::default();
        for (j, &bend) in bends.iter().enumerate() {
            if j > 0 {
                transfer.pass_shaft(phases[j - 1], twists[j - 1]);
            }
            transfer.pass_joint(Joint::new(bend));
        }
        transfer
    }

    /// Follows an intermediate shaft: a turn by `p = δ − τ + 90°`.
    pub fn pass_shaft(&mut self, phase: f64, twist: f64) {
        let (sine, cosine) = trig::sin_cos(phase - twist);
        let turn = Complex::new(-sine, cosine);
        self.a *= turn;
        self.b *= turn;
    }

    /// Follows a joint: `(A, B) → (A − k B̄, B − k Ā)`. A straight joint changes nothing.
    pub fn pass_joint(&mut self, joint: Joint) {
        if joint.k == 0.0 {
            return;
        }
        self.single = (self.b == Complex::new(0.0, 0.0)).then_some(joint);
        let (a, b) = (self.a, self.b);
        self.a = a - b.conj() * joint.k;
        self.b = b - a.conj() * joint.k;
        self.complement *= joint.complement();
    }

    /// The one joint that moves the shaft exactly as the whole chain does.
    pub fn equivalent(&self) -> Equivalent {
        // −q/|q| = e^{−2iφ} for q = B/A, up to a positive factor.
        let z = -self.b * self.a.conj();
        let size = z.norm();
        if size == 0.0 {
            return Equivalent { joint: Joint::STRAIGHT, turn_cos: 1.0, turn_sin: 0.0 };
        }
        let joint = self.single.unwrap_or_else(|| {
            let a2 = self.a.norm_sqr();
            Joint::from_k(size / a2, self.complement / a2)
        });
        let (turn_cos, turn_sin) = half_turn(z.re / size, -z.im / size);
        Equivalent { joint, turn_cos, turn_sin }
    }

    /// `w → A w + B w̄` as a matrix on `(cos α, sin α)`: the rows give the cosine and the sine of
    /// the joint's own driving angle, both times the same positive length.
    pub fn matrix(&self) -> [f64; 4] {
        let (a, b) = (self.a, self.b);
        [a.re + b.re, b.im - a.im, a.im + b.im, a.re - b.re]
    }
}

/// Cosine and sine of `φ` in `(−90°, 90°]` from those of `2φ`.
fn half_turn(cos_2: f64, sin_2: f64) -> (f64, f64) {
    if cos_2 >= 0.0 {
        let c = (0.5 * (1.0 + cos_2)).sqrt();
        (c, 0.5 * sin_2 / c)
    } else {
        let s = (0.5 * (1.0 - cos_2)).sqrt().copysign(sin_2);
        (0.5 * sin_2 / s, s)
    }
}

/// A joint whose driving angle is the drive angle turned by `φ`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Equivalent {
    /// The joint with the equivalent bend.
    pub joint: Joint,
    /// `cos φ`.
    pub turn_cos: f64,
    /// `sin φ`; exactly zero where the joint needs no turning.
    pub turn_sin: f64,
}

impl Equivalent {
    /// `φ` in radians, in `(−π/2, π/2]`: the joint's driving angle is `α + φ`.
    pub fn angle_offset(&self) -> f64 {
        self.turn_sin.atan2(self.turn_cos)
    }
}
