//! Transmissions: the motion of one shaft at one drive angle, and its derivatives.
//!
//! Behind ideal joints the motion of a shaft depends on the drive angle and on one complex number,
//! `q = B/A` of the map `w → A w + B w̄` ([`crate::mechanics::chain`]). With `u = e^{−2iα}` and
//! `g = 1/(1 + q u)` the angle error is `arg(1 + q u)`, the speed ratio `Re((1 − q u) g)`, the
//! acceleration ratio `Re(4 i q u g²)` and the jerk ratio `Re(8 q u (1 − q u) g³)`.

use nalgebra::Complex;

use crate::mechanics::chain::Equivalent;
use crate::mechanics::general::General;
use crate::mechanics::joint::Joint;
use crate::mechanics::motion::{Motion, MotionGradient, joint_motion};
use crate::number::trig;

/// How one shaft follows the drive.
#[derive(Clone, Debug)]
pub enum Transmission {
    /// A chain of ideal joints, which act as one joint.
    Ideal(Ideal),
    /// A chain that is evaluated joint by joint.
    General(General),
}

impl Transmission {
    /// The motion at a drive angle in rad; NaN if it is not finite.
    pub fn motion(&self, angle: f64) -> Motion {
        match self {
            Self::Ideal(ideal) => ideal.motion(angle),
            Self::General(general) => general.motion(angle),
        }
    }
}

/// A chain of ideal joints, evaluated by its equivalent joint.
#[derive(Clone, Copy, Debug)]
pub struct Ideal {
    equivalent: Equivalent,
}

impl Ideal {
    /// The transmission to the output of the last of `n` joints, from `n` bends, `n − 1` twists and
    /// `n − 1` phases in rad.
    ///
    /// ```
    /// use cardan::Ideal;
    ///
    /// let joint = Ideal::of_chain(&[0.5], &[], &[]);
    /// assert!((joint.q().re + (0.25_f64).tan().powi(2)).abs() < 1e-16);
    /// assert!((joint.motion(0.0).speed_ratio - 1.0 / 0.5_f64.cos()).abs() < 1e-15);
    /// ```
    pub fn of_chain(bends: &[f64], twists: &[f64], phases: &[f64]) -> Self {
        Self { equivalent: Equivalent::of_chain(bends, twists, phases) }
    }

    /// The joint that moves the last shaft as the chain does.
    pub(crate) fn equivalent(&self) -> &Equivalent {
        &self.equivalent
    }

    /// `q = B/A`; `|q| = tan²(β/2)` of the equivalent bend `β`.
    pub fn q(&self) -> Complex<f64> {
        let Equivalent { joint, turn_cos, turn_sin } = self.equivalent;
        let turn = Complex::new(turn_cos, -turn_sin);
        turn * turn * -joint.k
    }

    /// Sine and cosine of the equivalent joint's input angle.
    fn sin_cos(&self, angle: f64) -> (f64, f64) {
        let (s, c) = trig::sin_cos(angle);
        let Equivalent { turn_cos, turn_sin, .. } = self.equivalent;
        (s.mul_add(turn_cos, c * turn_sin), c.mul_add(turn_cos, -(s * turn_sin)))
    }

    /// The motion at a drive angle in rad; NaN if it is not finite.
    pub fn motion(&self, angle: f64) -> Motion {
        let (s, c) = self.sin_cos(angle);
        joint_motion(&self.equivalent.joint, s, c)
    }

    /// The derivatives of the motion with respect to `q` at a drive angle in rad.
    ///
    /// With `a` the equivalent joint's input angle, `1 + q u` equals
    /// `2 (cos β cos² a + sin² a + i (1 − cos β) sin a cos a)/(1 + cos β)`. Neither part cancels
    /// for steep bends.
    pub fn gradient(&self, angle: f64) -> MotionGradient {
        let (s, c) = self.sin_cos(angle);
        let Joint { cos, versine, k, .. } = self.equivalent.joint;
        let inverse = Complex::new((cos * c).mul_add(c, s * s), versine * s * c);
        let g = Complex::new(0.5 * (1.0 + cos), 0.0) / inverse;
        // q u = −k e^{−2ia}.
        let half = Complex::new(c, -s);
        let z = half * half * -k;
        let (sine, cosine) = trig::sin_cos(angle);
        let u = Complex::new(cosine, -sine).powu(2);
        let i = Complex::new(0.0, 1.0);
        let one = Complex::new(1.0, 0.0);
        MotionGradient {
            angle_error: -i * u * g,
            speed_ratio: u * g * g * -2.0,
            acceleration_ratio: i * u * (one - z) * g * g * g * 4.0,
            jerk_ratio: u * (one - z * g * g * 6.0) * g * g * 8.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CHAINS: [(&[f64], &[f64], &[f64]); 5] = [
        (&[0.5], &[], &[]),
        (&[0.3, 0.2], &[0.4], &[-1.1]),
        (&[0.17, 0.0, 0.4, 0.3], &[0.3, 2.0, -0.7], &[1.0, 0.2, 0.9]),
        (&[1.3, 0.9], &[-0.5], &[0.8]),
        (&[1.45, 0.2, 0.1], &[0.2, 0.3], &[0.5, -4.0]),
    ];

    fn numbers(motion: Motion) -> [f64; 4] {
        let Motion { angle_error, speed_ratio, acceleration_ratio, jerk_ratio } = motion;
        [angle_error, speed_ratio, acceleration_ratio, jerk_ratio]
    }

    /// The motion from `q` by the formulas in the module's documentation.
    fn reference(q: Complex<f64>, angle: f64) -> [f64; 4] {
        let z = q * Complex::from_polar(1.0, -2.0 * angle);
        let one = Complex::new(1.0, 0.0);
        let g = one / (one + z);
        let i = Complex::new(0.0, 1.0);
        [
            (one + z).arg(),
            ((one - z) * g).re,
            (i * z * g * g * 4.0).re,
            (z * (one - z) * g.powu(3) * 8.0).re,
        ]
    }

    #[test]
    fn joint_by_joint_is_as_the_equivalent_joint() {
        for (bends, twists, phases) in CHAINS {
            let ideal = Transmission::Ideal(Ideal::of_chain(bends, twists, phases));
            let general = Transmission::General(General::of_chain(bends, twists, phases));
            for i in 0..100 {
                let angle = 0.1 * f64::from(i) - 3.0;
                let [one, other] =
                    [&ideal, &general].map(|transmission| numbers(transmission.motion(angle)));
                for (x, y) in one.into_iter().zip(other) {
                    assert!((x - y).abs() < 1e-12 * (1.0 + x.abs()), "{bends:?} {angle}: {x} {y}");
                }
            }
        }
    }

    #[test]
    fn motion_is_that_of_q() {
        for (bends, twists, phases) in CHAINS {
            let ideal = Ideal::of_chain(bends, twists, phases);
            for i in 0..50 {
                let angle = 0.13 * f64::from(i);
                let expected = reference(ideal.q(), angle);
                for (x, y) in numbers(ideal.motion(angle)).into_iter().zip(expected) {
                    assert!((x - y).abs() < 2e-11 * (1.0 + y.abs()), "{bends:?} {angle}: {x} {y}");
                }
            }
        }
    }

    #[test]
    fn gradients_are_the_differences_by_q() {
        const STEP: f64 = 1e-5;
        for (bends, twists, phases) in CHAINS {
            let ideal = Ideal::of_chain(bends, twists, phases);
            let q = ideal.q();
            for i in 0..30 {
                let angle = 0.21 * f64::from(i);
                let gradient = ideal.gradient(angle);
                let derivatives = [
                    gradient.angle_error,
                    gradient.speed_ratio,
                    gradient.acceleration_ratio,
                    gradient.jerk_ratio,
                ];
                for direction in [Complex::new(1.0, 0.0), Complex::new(0.0, 1.0)] {
                    let at = |steps: f64| reference(q + direction * (steps * STEP), angle);
                    let (far, near) = ([at(2.0), at(-2.0)], [at(1.0), at(-1.0)]);
                    for (n, derivative) in derivatives.into_iter().enumerate() {
                        // Five-point differences: the error is of the fourth order in the step.
                        let wide = far[0][n] - far[1][n];
                        let slope = (8.0 * (near[0][n] - near[1][n]) - wide) / (12.0 * STEP);
                        let computed = (derivative * direction).re;
                        let scale = 1.0 + derivative.norm();
                        assert!(
                            (computed - slope).abs() < 1e-6 * scale,
                            "{bends:?} {angle} {n}: {computed} {slope}"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn no_angle_has_no_motion() {
        let ideal = Ideal::of_chain(&[0.5], &[], &[]);
        assert!(numbers(ideal.motion(f64::INFINITY)).into_iter().all(f64::is_nan));
        assert!(numbers(ideal.motion(f64::NAN)).into_iter().all(f64::is_nan));
    }
}
