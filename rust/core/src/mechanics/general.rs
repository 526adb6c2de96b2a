//! Chains of joints that are evaluated joint by joint.

use std::f64::consts::{FRAC_PI_2, PI};

use crate::mechanics::joint::Joint;
use crate::mechanics::motion::{Motion, joint_motion};
use crate::number::trig;

/// A chain that is evaluated joint by joint. It serves joints that no single `q` describes.
#[derive(Clone, Debug)]
pub struct General {
    /// Each joint with the turn of the shaft before it.
    stages: Vec<(f64, Joint)>,
    /// The mean of the sum of the joints' own angle errors.
    mean: f64,
}

impl General {
    /// The transmission to the output of the last of `n` joints, from `n` bends, `n − 1` twists and
    /// `n − 1` phases in rad.
    pub fn of_chain(bends: &[f64], twists: &[f64], phases: &[f64]) -> Self {
        let turns = phases.iter().zip(twists).map(|(phase, twist)| phase - twist + FRAC_PI_2);
        let turns = std::iter::once(0.0).chain(turns);
        let stages = turns.zip(bends.iter().map(|&bend| Joint::new(bend))).collect();
        let mut general = Self { stages, mean: 0.0 };
        general.mean = general.mean_error();
        general
    }

    /// The mean over half a turn by the trapezoidal rule, whose error decreases geometrically.
    fn mean_error(&self) -> f64 {
        const MOST: u32 = 1 << 16;
        let mut count = 16;
        let mut sum: f64 = (0..count).map(|i| self.error_at(i, count)).sum();
        loop {
            let before = sum / f64::from(count);
            // Adds the samples halfway between the previous ones.
            count *= 2;
            sum += (1..count).step_by(2).map(|i| self.error_at(i, count)).sum::<f64>();
            let mean = sum / f64::from(count);
            if (mean - before).abs() <= 1e-16 || count >= MOST {
                return mean;
            }
        }
    }

    fn error_at(&self, i: u32, count: u32) -> f64 {
        self.motion(PI * f64::from(i) / f64::from(count)).angle_error
    }

    /// The motion at a drive angle in rad; NaN if it is not finite.
    pub fn motion(&self, angle: f64) -> Motion {
        let (mut s, mut c) = trig::sin_cos(angle);
        let mut total = Motion {
            angle_error: -self.mean,
            speed_ratio: 1.0,
            acceleration_ratio: 0.0,
            jerk_ratio: 0.0,
        };
        for (turn, joint) in &self.stages {
            (s, c) = turned((s, c), trig::sin_cos(*turn));
            let own = joint_motion(joint, s, c);
            (s, c) = turned((s, c), trig::sin_cos(own.angle_error));
            total = own.compose(&total);
        }
        total
    }
}

/// Sine and cosine of a sum of angles.
fn turned((s, c): (f64, f64), (by_s, by_c): (f64, f64)) -> (f64, f64) {
    (s * by_c + c * by_s, c * by_c - s * by_s)
}
